#include <string>

#include "messages/inputs/moves.h"

namespace irsig {
namespace {

using Points = google::protobuf::RepeatedPtrField<schema::SpectralPoint>;

// Returns the value of a spectral table at a wavelength, linear between its points; the plain value
// if there is no table.
double value_at(double value, const Points& table, double lambda_um) {
  if (table.empty()) return value;
  if (lambda_um <= table[0].lambda_um()) return table[0].value();
  for (int i = 1; i < table.size(); ++i) {
    if (lambda_um > table[i].lambda_um()) continue;
    const double share =
        (lambda_um - table[i - 1].lambda_um()) / (table[i].lambda_um() - table[i - 1].lambda_um());
    return (1 - share) * table[i - 1].value() + share * table[i].value();
  }
  return table[table.size() - 1].value();
}

// Raises the emissivity of a material that states its reflectance: the reflectance falls by the
// same amount.
void move_reflectance(Mover& mover, Points& table, double value, auto set) {
  for (schema::SpectralPoint& p : table) p.set_value(1 - mover.moved(1 - p.value(), 0, 1));
  if (table.empty()) set(1 - mover.moved(1 - value, 0, 1));
}

}  // namespace

bool move_emissivity(Mover& mover, schema::Material& m) {
  const std::string& kind = m.kind();
  if (m.has_thermal_emissivity())
    m.set_thermal_emissivity(mover.moved(m.thermal_emissivity(), 0, 1));
  if (kind == "prisse" ||
      (kind == "lambert" && (m.has_reflectance() || !m.reflectance_table().empty()))) {
    move_reflectance(mover, *m.mutable_reflectance_table(), m.reflectance(),
                     [&](double v) { m.set_reflectance(v); });
    return true;
  }
  if (kind == "lambert" || kind == "sandford_robertson") {
    // The emissivity is at most 1 less the diffuse reflectance.
    const auto most = [&](double lambda_um) {
      return kind == "lambert"
                 ? 1.0
                 : 1 - value_at(m.diffuse_reflectance(), m.diffuse_reflectance_table(), lambda_um);
    };
    for (schema::SpectralPoint& p : *m.mutable_emissivity_table())
      p.set_value(mover.moved(p.value(), 0, most(p.lambda_um())));
    if (m.emissivity_table().empty()) {
      double limit = most(0);
      for (const schema::SpectralPoint& p : m.diffuse_reflectance_table())
        limit = std::min(limit, most(p.lambda_um()));
      m.set_emissivity(mover.moved(m.emissivity(), 0, limit));
    }
    return true;
  }
  if (kind == "cook_torrance" && m.has_normal_emissivity()) {
    m.set_normal_emissivity(mover.moved(m.normal_emissivity(), 0, 0.999999));
    return true;
  }
  return false;
}

}  // namespace irsig
