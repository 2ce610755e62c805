#include "messages/environment/gas_from_message.h"

#include "messages/environment/named.h"

namespace irsig {
namespace {

GridOrConstant quantity_from_message(const schema::GasQuantity& q, const char* fallback_unit) {
  GridOrConstant out;
  out.grid = q.grid();
  if (q.has_constant()) out.constant = q.constant();
  out.unit = q.has_unit() ? q.unit() : fallback_unit;
  return out;
}

}  // namespace

absl::StatusOr<PlumeGrids> grids_from_message(const schema::Plume& plume) {
  PlumeGrids out;
  if (plume.has_interpolation()) {
    const auto interpolation = named<PlumeInterpolation>(
        "plume.interpolation", plume.interpolation(),
        {{"linear", PlumeInterpolation::kLinear}, {"constant", PlumeInterpolation::kConstant}});
    if (!interpolation.ok()) return interpolation.status();
    out.interpolation = *interpolation;
  }
  // A number alone is a fraction; temperatures and pressures have no unit that goes without saying.
  out.temperature = quantity_from_message(plume.temperature(), "");
  out.pressure = quantity_from_message(plume.pressure(), "");
  out.co2 = quantity_from_message(plume.co2(), "1");
  out.h2o = quantity_from_message(plume.h2o(), "1");
  out.co = quantity_from_message(plume.co(), "1");
  out.soot = quantity_from_message(plume.soot(), "1");
  out.unit_m = plume.unit_m();
  out.forward_axis = plume.forward_axis();
  out.up_axis = plume.up_axis();
  out.position_m = position_of(plume);
  return out;
}

ExhaustSpec exhaust_from_message(const schema::Plume& plume) {
  ExhaustSpec out;
  out.hydrogen_per_carbon = plume.hydrogen_per_carbon();
  out.excess_air = plume.excess_air();
  out.carbon_as_co = plume.carbon_as_co();
  out.soot_g_per_kg = plume.soot_g_per_kg();
  return out;
}

Vec<Body> position_of(const schema::Plume& plume) {
  if (plume.position_m_size() != 3) return {};
  return {plume.position_m(0), plume.position_m(1), -plume.position_m(2)};
}

}  // namespace irsig
