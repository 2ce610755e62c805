#include "core/atmosphere/cloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

#include "absl/strings/str_format.h"
#include "core/atmosphere/embedded.h"
#include "core/base/table.h"

namespace irsig {
namespace {

// Positions of levels inside a cloud: at some optical depths from its boundaries, within which
// light changes, and in the middle. A level of a deeper cloud begins there, so that light has no
// jump where there is one level more.
std::vector<double> level_positions(double depth) {
  constexpr std::array kDepths = {0.3, 1.0, 2.5, 5.0, 9.0};
  constexpr double kApart = 1e-3;
  std::vector<double> out{0, 0.5, 1};
  for (const double d : kDepths) {
    if (d > (0.5 - kApart) * depth) break;
    out.push_back(d / depth);
    out.push_back(1 - d / depth);
  }
  std::sort(out.begin(), out.end());
  return out;
}

// The air below and above a cloud keeps its own humidity so close to it. [m]
constexpr double kEdgeM = 1;

// Mass coefficients of one phase, on the air's bands.
struct ParticleOptics {
  std::vector<double> ln_radius;
  std::vector<AirSpectrum> ln_extinction, ln_absorption, asymmetry;  // [radius]
};

ParticleOptics read_particles(std::string_view phase) {
  struct Curve {
    std::vector<double> lambda_um, extinction, absorption, asymmetry;
  };
  std::map<double, Curve> curves;
  for (const auto& row : csv_rows(embedded_cloud_optics())) {
    if (row[0] != phase) continue;
    Curve& curve = curves[std::log(number(row[1]))];
    curve.lambda_um.push_back(number(row[2]));
    curve.extinction.push_back(std::log(number(row[3])));
    curve.absorption.push_back(std::log(number(row[4])));
    curve.asymmetry.push_back(number(row[5]));
  }
  ParticleOptics out;
  for (const auto& [ln_radius, curve] : curves) {
    out.ln_radius.push_back(ln_radius);
    AirSpectrum extinction, absorption, asymmetry;
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      const TablePosition at = locate(curve.lambda_um, air_band_lambda_um(b));
      extinction.push_back(interpolate(curve.extinction, at));
      absorption.push_back(interpolate(curve.absorption, at));
      asymmetry.push_back(interpolate(curve.asymmetry, at));
    }
    out.ln_extinction.push_back(std::move(extinction));
    out.ln_absorption.push_back(std::move(absorption));
    out.asymmetry.push_back(std::move(asymmetry));
  }
  return out;
}

const ParticleOptics& particles(CloudPhase phase) {
  static const ParticleOptics water = read_particles("water"), ice = read_particles("ice");
  return phase == CloudPhase::kWater ? water : ice;
}

// Over a plane of ice, -65 to 0 C.  [sonntag1990]
double saturation_pressure_over_ice_pa(double temperature_k) {
  const double t = temperature_k;
  return 100 * std::exp(-6024.5282 / t + 24.7219 + 1.0613868e-2 * t - 1.3198825e-5 * t * t -
                        0.49382577 * std::log(t));
}

void saturate(AirLevel& level, CloudPhase phase) {
  const double t = level.temperature_k;
  const bool ice = phase == CloudPhase::kIce && t < 273.16;
  const double vapour_pa = ice ? saturation_pressure_over_ice_pa(t) : saturation_pressure_pa(t);
  // The vapour pressure of hot, thin air that never saturates would exceed the air's.
  level.gas.h2o_ppmv = 1e6 * std::min(vapour_pa / level.pressure_pa, 0.5);
}

absl::Status outside(const char* what, double value, double low, double high) {
  return absl::InvalidArgumentError(
      absl::StrFormat("cloud %s %g: expected %g to %g", what, value, low, high));
}

}  // namespace

absl::Status check_cloud(const CloudSpec& spec) {
  const bool water = spec.phase == CloudPhase::kWater;
  const double low = water ? kSmallestDropUm : kSmallestCrystalUm,
               high = water ? kLargestDropUm : kLargestCrystalUm;
  if (!(spec.base_m >= 0 && spec.base_m <= kHighestCloudM))
    return outside("base_m", spec.base_m, 0, kHighestCloudM);
  if (!(spec.top_m >= spec.base_m + kThinnestCloudM && spec.top_m <= kHighestCloudM))
    return outside("top_m", spec.top_m, spec.base_m + kThinnestCloudM, kHighestCloudM);
  if (!(spec.water_path_kg_m2 >= 0 && spec.water_path_kg_m2 <= kLargestWaterPathKgM2))
    return outside("water_path_kg_m2", spec.water_path_kg_m2, 0, kLargestWaterPathKgM2);
  if (!(spec.effective_radius_um >= low && spec.effective_radius_um <= high))
    return outside("effective_radius_um", spec.effective_radius_um, low, high);
  if (spec.base_k && !(*spec.base_k >= kColdestBaseK && *spec.base_k <= kWarmestBaseK))
    return outside("base_k", *spec.base_k, kColdestBaseK, kWarmestBaseK);
  return absl::OkStatus();
}

CloudOptics cloud_optics(const CloudSpec& spec, ForwardPeak peak) {
  const ParticleOptics& of = particles(spec.phase);
  const TablePosition at = locate(
      of.ln_radius,
      std::clamp(std::log(spec.effective_radius_um), of.ln_radius.front(), of.ln_radius.back()));
  CloudOptics out;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    const auto between = [&](const std::vector<AirSpectrum>& curve) {
      return std::lerp(curve[at.index][b], curve[at.index + 1][b], at.fraction);
    };
    const double extinction = spec.water_path_kg_m2 * std::exp(between(of.ln_extinction));
    const double absorption =
        std::min(extinction, spec.water_path_kg_m2 * std::exp(between(of.ln_absorption)));
    double scattering = extinction - absorption, asymmetry = between(of.asymmetry);
    if (peak == ForwardPeak::kDiffuse) {
      scattering *= 1 - asymmetry * asymmetry;
      asymmetry /= 1 + asymmetry;
    }
    out.absorption.push_back(absorption);
    out.scattering.push_back(scattering);
    out.asymmetry.push_back(asymmetry);
  }
  return out;
}

std::vector<double> cloud_levels_m(const AirProfile& profile, const CloudSpec& spec) {
  const double ground_m = profile.level.front().height_m;
  std::vector<double> out;
  // The formula is that of particles much larger than the wavelength.
  constexpr double kWaterKgM3 = 1000;
  const double depth = 1.5 * spec.water_path_kg_m2 / (kWaterKgM3 * 1e-6 * spec.effective_radius_um);
  for (const double f : level_positions(depth))
    out.push_back(ground_m + std::lerp(spec.base_m, spec.top_m, f));
  return out;
}

AirProfile with_cloud(const AirProfile& profile, const CloudSpec& spec) {
  const std::vector<double> inside = cloud_levels_m(profile, spec);
  AirProfile out;
  for (const AirLevel& level : profile.level) {
    if (level.height_m < inside.front() - kEdgeM || level.height_m > inside.back() + kEdgeM)
      out.level.push_back(level);
  }
  const double warmer_k =
      spec.base_k ? *spec.base_k - air_at(profile, inside.front()).temperature_k : 0;
  const auto add = [&](double height_m, bool wet) {
    AirLevel level = air_at(profile, height_m);
    level.height_m = height_m;
    if (wet) {
      level.temperature_k += warmer_k;
      saturate(level, spec.phase);
    }
    out.level.push_back(level);
  };
  const double ground_m = profile.level.front().height_m;
  if (inside.front() - kEdgeM >= ground_m) add(inside.front() - kEdgeM, false);
  for (const double height_m : inside) add(height_m, true);
  add(inside.back() + kEdgeM, false);
  // A cloud on the ground, or less than an edge above it, begins there.
  if (inside.front() > ground_m && inside.front() - kEdgeM < ground_m) add(ground_m, true);
  // Levels of the profile inside the cloud: temperatures bend there.
  for (const AirLevel& level : profile.level) {
    const bool known = std::any_of(inside.begin(), inside.end(),
                                   [&](double h) { return std::abs(h - level.height_m) < 1e-6; });
    if (level.height_m > inside.front() && level.height_m < inside.back() && !known)
      add(level.height_m, true);
  }
  std::sort(out.level.begin(), out.level.end(),
            [](const AirLevel& a, const AirLevel& b) { return a.height_m < b.height_m; });
  return out;
}

}  // namespace irsig
