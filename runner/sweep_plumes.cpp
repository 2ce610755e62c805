#include "runner/sweep_plumes.h"

#include <algorithm>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/gas/gas_state.h"
#include "core/plume/generate_plume.h"
#include "core/plume/plume_silhouette.h"
#include "messages/environment/gas_from_message.h"

namespace irsig {
namespace {

using Field = std::shared_ptr<const PlumeField>;

// Returns an error that the sweep's author can mend at a key of the file; other errors stay as they
// are.
absl::Status plume_error(const std::string& path, const absl::Status& status) {
  if (!absl::IsInvalidArgument(status) && !absl::IsOutOfRange(status)) return status;
  return problem_status(problems_of(at_key(path, status)));
}

absl::StatusOr<GeneratedPlume> generated(const schema::ConditionPlume& p) {
  const schema::Plume& plume = p.plume();
  if (plume.kind() == "funnel") {
    FunnelPlume funnel;
    funnel.exit = {plume.diameter_m(), plume.velocity_m_s(), plume.temperature_k()};
    funnel.exhaust = exhaust_from_message(plume);
    funnel.air_temperature_k = p.air_temperature_k();
    funnel.air_pressure_pa = p.air_pressure_pa();
    funnel.wind_m_s = p.wind_speed_m_s();
    funnel.wind_from_deg = p.wind_from_deg();
    funnel.ship_speed_m_s = p.ship_speed_m_s();
    funnel.length_m = plume.length_m();
    funnel.voxel_m = plume.voxel_m();
    return generate_funnel_plume(funnel);
  }
  UniformPlume body;
  body.kind = plume.kind();
  body.length_m = plume.length_m();
  body.width_m = plume.width_m();
  body.height_m = plume.height_m();
  body.radius_m = plume.radius_m();
  body.temperature_k = plume.temperature_k();
  body.pressure_pa = plume.pressure_pa();
  body.co2 = plume.co2().constant();
  body.h2o = plume.h2o().constant();
  body.co = plume.co().constant();
  body.soot = plume.soot().constant();
  body.voxel_m = plume.voxel_m();
  return generate_uniform_plume(body);
}

absl::StatusOr<Field> field_of(const schema::ConditionPlume& p, const Assets& assets) {
  if (p.plume().kind() == "file") {
    ASSIGN_OR_RETURN(const auto grids, grids_from_message(p.plume()));
    auto field = import_plume(asset(assets, p.sha256()), "the file", grids);
    return field.ok() ? std::move(field) : plume_error("plume.file", field.status());
  }
  auto made = generated(p);
  if (!made.ok()) return plume_error("plume", made.status());
  made->grids.position_m = position_of(p.plume());
  auto field = plume_of(std::move(made->volume), made->grids);
  return field.ok() ? std::move(field) : plume_error("plume", field.status());
}

// Checks that the gas lies within the tables of hot gas.
absl::Status check_state(const PlumeReport& report, const std::string& path) {
  const auto outside = [](double least, double most, double low, double high) {
    return !(least >= low && most <= high);
  };
  if (outside(report.least_k, report.most_k, kGasTemperatureMinK, kGasTemperatureMaxK))
    return keyed_problem(
        path, absl::StrCat("gas of ", absl::SixDigits(report.least_k), " to ",
                           absl::SixDigits(report.most_k), " K, expected ", kGasTemperatureMinK,
                           " to ", kGasTemperatureMaxK, " K: the tables of hot gas end there"));
  if (outside(report.least_pa, report.most_pa, kGasPressureMinPa, kGasPressureMaxPa))
    return keyed_problem(
        path, absl::StrCat("gas of ", absl::SixDigits(report.least_pa), " to ",
                           absl::SixDigits(report.most_pa), " Pa, expected ", kGasPressureMinPa,
                           " to ", kGasPressureMaxPa, " Pa: the tables of hot gas end there"));
  if (report.most_soot > kGasSootMax)
    return keyed_problem(
        path, absl::StrCat("gas with ", report.most_soot, " of its volume soot, expected at most ",
                           kGasSootMax, ": the tables of hot gas end there"));
  return absl::OkStatus();
}

// A sensor stands outside of all gas, whatever way it looks.
absl::Status check_reach(const schema::ResolvedSweep& sweep, const PlumeField& field) {
  double reach_m = 0;
  for (const Vec<Body>& corner : gas_corners(field)) reach_m = std::max(reach_m, length(corner));
  for (const schema::Viewpoint& v : sweep.viewpoint())
    if (v.range_m() <= reach_m)
      return keyed_problem(
          "viewpoints.range_m",
          absl::StrCat("a sensor at ", v.range_m(), " m, but hot gas reaches as far as ",
                       absl::SixDigits(reach_m),
                       " m from the target's reference point, expected sensors farther away than "
                       "that"));
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<SweepPlumes> plumes_from_sweep(const schema::ResolvedSweep& sweep,
                                              const Assets& assets) {
  SweepPlumes out;
  for (const schema::ConditionPlume& p : sweep.plume()) {
    ASSIGN_OR_RETURN(auto field, field_of(p, assets));
    const std::string path = p.plume().kind() == "file" ? "plume.file" : "plume";
    RETURN_IF_ERROR(check_state(field->report(), path));
    RETURN_IF_ERROR(check_reach(sweep, *field));
    out.push_back(std::move(field));
  }
  return out;
}

std::size_t bytes_of(const SweepPlumes& plumes) {
  std::size_t sum = 0;
  for (const auto& field : plumes) {
    sum += field->bytes();
    if (const auto& half = field->at_half_resolution(); half.ok()) sum += (*half)->bytes();
  }
  return sum;
}

}  // namespace irsig
