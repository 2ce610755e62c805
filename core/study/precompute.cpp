#include "core/study/precompute.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

constexpr double kAny = std::numeric_limits<double>::max();

// A quantity of PrecomputeCase and the interval in which it is physical.
struct Requirement {
  const char* name;
  double PrecomputeCase::*value;
  double min, max;
  bool min_allowed;
};

constexpr Requirement kRequirements[] = {
    {"hot_area_m2", &PrecomputeCase::hot_area_m2, 0, kAny, true},
    {"hot_temperature_k", &PrecomputeCase::hot_temperature_k, 0, kPlanckTemperatureMaxK, true},
    {"ambient_area_m2", &PrecomputeCase::ambient_area_m2, 0, kAny, true},
    {"ambient_temperature_k", &PrecomputeCase::ambient_temperature_k, 0, kPlanckTemperatureMaxK,
     true},
    {"emissivity", &PrecomputeCase::emissivity, 0, 1, true},
    {"reflected_exitance_w_m2_um", &PrecomputeCase::reflected_exitance_w_m2_um, 0, kAny, true},
    {"absorption_m2_kg", &PrecomputeCase::absorption_m2_kg, 0, kAny, true},
    {"range_m", &PrecomputeCase::range_m, 0, kAny, true},
    {"pressure_pa", &PrecomputeCase::pressure_pa, 0, kAny, true},
    {"gas_constant_j_kg_k", &PrecomputeCase::gas_constant_j_kg_k, 0, kAny, false},
    {"air_temperature_k", &PrecomputeCase::air_temperature_k, 0, kAny, false},
};

absl::Status check(const PrecomputeCase& target, double lambda_min_um, double lambda_max_um,
                   double step_um) {
  std::string wrong;
  const auto refuse = [&](const std::string& line) {
    absl::StrAppend(&wrong, wrong.empty() ? "" : "\n", line);
  };
  for (const Requirement& rule : kRequirements) {
    const double value = target.*rule.value;
    if (value <= rule.max && (rule.min_allowed ? value >= rule.min : value > rule.min)) continue;
    refuse(absl::StrCat(rule.name, " = ", value, ": expected ",
                        rule.min_allowed ? "at least " : "more than ", rule.min,
                        rule.max == kAny ? "" : absl::StrCat(" and at most ", rule.max)));
  }
  if (!(lambda_min_um >= kPlanckLambdaMinUm && lambda_max_um <= kPlanckLambdaMaxUm &&
        lambda_min_um < lambda_max_um)) {
    refuse(absl::StrCat("wavelengths ", lambda_min_um, " to ", lambda_max_um,
                        " um: expected 0 < lambda_min_um < lambda_max_um"));
  }
  constexpr double kMostSteps = 1e6;
  const double width = lambda_max_um - lambda_min_um;
  if (!(step_um > 0 && step_um <= width * (1 + 1e-9) && width <= kMostSteps * step_um)) {
    refuse(absl::StrCat("step_um = ", step_um, ": expected at most ", width,
                        " (the interval) and at least a millionth of it"));
  }
  return wrong.empty() ? absl::OkStatus() : absl::InvalidArgumentError(wrong);
}

}  // namespace

double precompute_spectral_intensity_w_sr_um(const PrecomputeCase& target, double lambda_um) {
  const auto leaving = [&](double area_m2, double temperature_k) {
    const double emitted_w_m2_um =
        target.emissivity * std::numbers::pi * planck_radiance_w_m2_sr_um(lambda_um, temperature_k);
    const double reflected_w_m2_um = (1.0 - target.emissivity) * target.reflected_exitance_w_m2_um;
    return area_m2 / std::numbers::pi * (emitted_w_m2_um + reflected_w_m2_um);
  };
  const double air_density_kg_m3 =
      target.pressure_pa / (target.gas_constant_j_kg_k * target.air_temperature_k);
  const double optical_depth = target.absorption_m2_kg * target.range_m * air_density_kg_m3;
  return (leaving(target.hot_area_m2, target.hot_temperature_k) +
          leaving(target.ambient_area_m2, target.ambient_temperature_k)) *
         std::exp(-optical_depth);
}

absl::StatusOr<std::vector<SpectralPoint>> precompute_spectrum(const PrecomputeCase& target,
                                                               double lambda_min_um,
                                                               double lambda_max_um,
                                                               double step_um) {
  RETURN_IF_ERROR(check(target, lambda_min_um, lambda_max_um, step_um));
  const double steps = std::round((lambda_max_um - lambda_min_um) / step_um);
  std::vector<SpectralPoint> out;
  for (double k = 0; k <= steps; k += 1.0) {
    const double lambda_um = lambda_min_um + (lambda_max_um - lambda_min_um) * (k / steps);
    out.push_back({lambda_um, precompute_spectral_intensity_w_sr_um(target, lambda_um)});
  }
  return out;
}

}  // namespace irsig
