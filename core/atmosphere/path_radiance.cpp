#include <algorithm>
#include <cfloat>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/atmosphere/band_loops.h"
#include "core/atmosphere/gas_table.h"
#include "core/atmosphere/path_layers.h"
#include "core/atmosphere/path_sums.h"
#include "core/atmosphere/scattered_again.h"
#include "core/base/check.h"
#include "core/base/constants.h"
#include "core/spectral/planck.h"
#include "core/spectral/solar.h"

namespace irsig {
namespace {

// Nodes at which the sun's amounts are computed; between them they are interpolated in the node.
constexpr std::size_t kSunNodes = 9;

void interpolate_amounts(AbsorberAmounts& a, const AbsorberAmounts& b, double fraction) {
  for (std::size_t i = 0; i < a.gas_plain_kg_m2.size(); ++i) {
    a.gas_scaled_kg_m2[i] += fraction * (b.gas_scaled_kg_m2[i] - a.gas_scaled_kg_m2[i]);
    a.gas_plain_kg_m2[i] += fraction * (b.gas_plain_kg_m2[i] - a.gas_plain_kg_m2[i]);
  }
  for (std::size_t g = 0; g < kGreyAbsorberCount; ++g) {
    for (std::size_t i = 0; i < kAirBandCount; ++i) {
      a.optical_depth[g][i] += fraction * (b.optical_depth[g][i] - a.optical_depth[g][i]);
    }
  }
}

// Where between two heights a third lies, for amounts that thin out over 3 km (core/atmosphere/
// path_layers.cpp); between nodes of one height: `level`. Linear instead, sunlight scattered down
// to the sea would be 4 to 15 % too weak.
double decay_fraction(double from_m, double to_m, double at_m, double level) {
  constexpr double kScaleM = 3000;
  if (std::abs(to_m - from_m) < 1 || (at_m - from_m) * (at_m - to_m) > 0) return level;
  return std::expm1((from_m - at_m) / kScaleM) / std::expm1((from_m - to_m) / kScaleM);
}

}  // namespace

double logarithmic_mean(double a, double b) {
  if (!(a > 0 && b > 0)) return 0.5 * (a + b);
  const double ratio = b / a;
  if (std::abs(ratio - 1) < 1e-4) return 0.5 * (a + b);
  return (b - a) / std::log(ratio);
}

double mean_of_decay(double a, double b, double grey_depth) {
  if (!(a > 0)) return 0;
  if (!(b > 0)) return a / std::max(grey_depth, std::log(a) - std::log(DBL_MIN));
  return logarithmic_mean(a, b);
}

double mean_of_sunlight(double a, double b, double grey_depth) {
  if (a > 0 && b > 0) return mean_of_decay(a, b, grey_depth);
  // Half of the stretch is lit, if its air lets so much through.
  const double lit = std::max(a, b);
  return grey_depth > 1e-4 ? lit * std::min(0.5, -std::expm1(-grey_depth) / grey_depth) : 0.5 * lit;
}

double henyey_greenstein_per_sr(double g, double cosine) {
  const double d = 1 + g * g - 2 * g * cosine;
  return (1 - g * g) / (4 * std::numbers::pi * d * std::sqrt(d));
}

double rayleigh_per_sr(double cosine) {
  return 3 * (1 + cosine * cosine) / (16 * std::numbers::pi);
}

void planck_spectrum(AirSpectrum& out, double temperature_k, const BandChoice& bands) {
  const GasTable& table = gas_table();
  for (const BandChoice::Range& r : bands.ranges()) {
    planck_bands(r.size(), &table.lambda_um[r.first], &table.planck_scale[r.first], temperature_k,
                 &out[r.first]);
  }
}

void add_emission(AirSpectrum& out, const StepScattering& scattering, const AirSpectrum& t_near,
                  const AirSpectrum& t_far, const AirSpectrum& planck_near,
                  const AirSpectrum& planck_far, const BandChoice& bands) {
  for (const BandChoice::Range& r : bands.ranges()) {
    const std::size_t i = r.first;
    add_emission_bands(
        r.size(),
        {&scattering.aerosol_depth[i], &scattering.molecular_depth[i], &scattering.grey_depth[i]},
        &t_near[i], &t_far[i], &planck_near[i], &planck_far[i], &out[i]);
  }
}

void mean_of_decay(AirSpectrum& out, const AirSpectrum& a, const AirSpectrum& b,
                   const AirSpectrum& grey_depth, const BandChoice& bands) {
  for (const BandChoice::Range& r : bands.ranges()) {
    mean_of_decay_bands(r.size(), &a[r.first], &b[r.first], &grey_depth[r.first], &out[r.first]);
  }
}

void mean_of_sunlight(AirSpectrum& out, const AirSpectrum& a, const AirSpectrum& b,
                      const AirSpectrum& grey_depth, const BandChoice& bands) {
  mean_of_decay(out, a, b, grey_depth, bands);
  for (const BandChoice::Range& r : bands.ranges()) {
    for (std::size_t i = r.first; i < r.last; ++i) {
      if (!(a[i] > 0 && b[i] > 0)) out[i] = mean_of_sunlight(a[i], b[i], grey_depth[i]);
    }
  }
}

void add_surroundings(AirSpectrum& out, const StepScattering& scattering, const AirSpectrum& t_near,
                      const AirSpectrum& t_far, const BandChoice& bands) {
  AirSpectrum mean(kAirBandCount);
  mean_of_decay(mean, t_near, t_far, scattering.grey_depth, bands);
  for (const BandChoice::Range& r : bands.ranges()) {
    for (std::size_t i = r.first; i < r.last; ++i) {
      out[i] += (scattering.aerosol_depth[i] + scattering.molecular_depth[i]) * mean[i];
    }
  }
}

void add_cloud_source(AirSpectrum& planck_near, AirSpectrum& planck_far,
                      const StepScattering& scattering, const AirSpectrum& t_near,
                      const AirSpectrum& t_far, const AirSpectrum& mean_near,
                      const AirSpectrum& mean_far, const BandChoice& bands) {
  for (const BandChoice::Range& r : bands.ranges()) {
    for (std::size_t b = r.first; b < r.last; ++b) {
      const double cloud = scattering.cloud_depth[b];
      if (cloud <= 0) continue;
      // Fraction of the cloud's scattering in all that takes light away, but for scattering by air
      // and aerosol.
      const double others = scattering.aerosol_depth[b] + scattering.molecular_depth[b];
      const double whole = t_near[b] > 0 && t_far[b] > 0 ? std::log(t_near[b] / t_far[b]) : 0;
      const double rest = std::max(whole, scattering.grey_depth[b]) - others;
      const double of = cloud / std::max(cloud, rest);
      planck_near[b] += of * (mean_near[b] - planck_near[b]);
      planck_far[b] += of * (mean_far[b] - planck_far[b]);
    }
  }
}

void add_scattering(double& sum, double& mean_asymmetry, double depth, double asymmetry) {
  if (depth <= 0) return;
  sum += depth;
  mean_asymmetry += (asymmetry - mean_asymmetry) * depth / sum;
}

void merge(StepScattering& sum, const StepScattering& step, const BandChoice& bands) {
  if (!step.cloud_depth.empty()) {
    if (sum.cloud_depth.empty())
      sum.cloud_depth = sum.cloud_asymmetry = AirSpectrum(kAirBandCount, 0.0);
  }
  for (const BandChoice::Range& r : bands.ranges()) {
    for (std::size_t i = r.first; i < r.last; ++i) {
      sum.molecular_depth[i] += step.molecular_depth[i];
      sum.grey_depth[i] += step.grey_depth[i];
      if (!step.cloud_depth.empty()) {
        add_scattering(sum.cloud_depth[i], sum.cloud_asymmetry[i], step.cloud_depth[i],
                       step.cloud_asymmetry[i]);
      }
      add_scattering(sum.aerosol_depth[i], sum.asymmetry[i], step.aerosol_depth[i],
                     step.asymmetry[i]);
    }
  }
}

PathSums::PathSums(const Atmosphere& atmosphere, const LightPath& path, const PathLight& light,
                   const AbsorberAmounts* near)
    : atmosphere_(atmosphere), path_(path), light_(light), near_(near) {
  const AirSpectrum dark(kAirBandCount, 0.0);
  out_.thermal_w_m2_sr_um = out_.scattered_w_m2_sr_um = out_.total_w_m2_sr_um = dark;
  out_.model_error_transmittance = out_.model_error_w_m2_sr_um = dark;
  if (!light.surroundings_w_m2_sr_um.empty()) {
    IRSIG_CHECK(light.surroundings_w_m2_sr_um.size() == kAirBandCount);
  }
}

void PathSums::planck_at(AirSpectrum& out, std::size_t node) const {
  planck_spectrum(out, air_at(atmosphere_.profile(), path_.node[node].height_m).temperature_k,
                  BandChoice());
}

double PathSums::sun_zenith_deg(std::size_t node) const {
  const double z = light_.sun->zenith_deg * kRadPerDeg, a = light_.sun->azimuth_deg * kRadPerDeg;
  const double turn = path_.node[node].central_angle_deg * kRadPerDeg;
  const double cosine = std::sin(z) * std::cos(a) * std::sin(turn) + std::cos(z) * std::cos(turn);
  return std::acos(std::clamp(cosine, -1.0, 1.0)) / kRadPerDeg;
}

// Between the light's direction of travel and the direction to the observer.
double PathSums::cos_scattering(std::size_t step) const {
  const double z = light_.sun->zenith_deg * kRadPerDeg, a = light_.sun->azimuth_deg * kRadPerDeg;
  const LightPath::Node &p = path_.node[step], &q = path_.node[step + 1];
  const double look_zenith =
      0.5 * (p.zenith_deg + p.central_angle_deg + q.zenith_deg + q.central_angle_deg) * kRadPerDeg;
  return std::clamp(
      std::sin(z) * std::cos(a) * std::sin(look_zenith) + std::cos(z) * std::cos(look_zenith), -1.0,
      1.0);
}

void PathSums::prepare_sun() {
  if (!light_.sun.has_value() || path_.node.empty()) return;
  const std::size_t last = path_.node.size() - 1;
  const std::size_t count = std::min(kSunNodes, last + 1);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t node = count == 1 ? 0 : i * last / (count - 1);
    std::optional<AbsorberAmounts> amounts =
        atmosphere_.sun_amounts(path_.node[node].height_m, sun_zenith_deg(node));
    const bool lit = amounts.has_value();
    if (!sun_node_.empty() && sun_node_.back().lit != lit)
      add_edge_of_shadow(sun_node_.back().node, node, lit);
    if (sun_node_.empty() || sun_node_.back().node != node)
      sun_node_.push_back({node, lit, lit ? *std::move(amounts) : AbsorberAmounts()});
  }
}

void PathSums::add_edge_of_shadow(std::size_t first, std::size_t last, bool last_is_lit) {
  std::optional<AbsorberAmounts> of_lit;
  const auto is_lit = [&](std::size_t node) {
    of_lit = atmosphere_.sun_amounts(path_.node[node].height_m, sun_zenith_deg(node));
    return of_lit.has_value();
  };
  while (last - first > 1) {
    const std::size_t middle = (first + last) / 2;
    (is_lit(middle) == last_is_lit ? last : first) = middle;
  }
  for (const std::size_t node : {first, last}) {
    const bool lit = is_lit(node);
    if (node != sun_node_.back().node)
      sun_node_.push_back({node, lit, lit ? *std::move(of_lit) : AbsorberAmounts()});
  }
}

AirSpectrum PathSums::sunlight_by(std::size_t node, const AbsorberAmounts& to_node) const {
  std::size_t above = 1;
  while (above + 1 < sun_node_.size() && sun_node_[above].node < node) ++above;
  const SunNode& a = sun_node_[std::min(above, sun_node_.size()) - 1];
  const SunNode& b = sun_node_[std::min(above, sun_node_.size() - 1)];
  const double fraction =
      b.node == a.node
          ? 0
          : decay_fraction(
                path_.node[a.node].height_m, path_.node[b.node].height_m, path_.node[node].height_m,
                static_cast<double>(node - a.node) / static_cast<double>(b.node - a.node));
  // Where one of the neighbours is in shadow, the nearer decides.
  if (!(fraction < 0.5 ? a.lit : b.lit)) return AirSpectrum(kAirBandCount, 0.0);
  AbsorberAmounts amounts = a.lit ? a.amounts : b.amounts;
  if (a.lit && b.lit && fraction > 0) interpolate_amounts(amounts, b.amounts, fraction);
  amounts += to_node;
  AirSpectrum light = transmittance(amounts);
  const double au2 = light_.sun->distance_au * light_.sun->distance_au;
  for (std::size_t i = 0; i < kAirBandCount; ++i) {
    light[i] *= solar_irradiance_w_m2_um(air_band_lambda_um(i)) / au2;
  }
  return light;
}

void PathSums::add_scattered(std::size_t step, const AirSpectrum& source_near,
                             const AirSpectrum& source_far) {
  const double cosine = cos_scattering(step);
  const double rayleigh = rayleigh_per_sr(cosine);
  const StepScattering& s = scattering_[step];
  AirSpectrum light(kAirBandCount);
  mean_of_sunlight(light, source_near, source_far, s.grey_depth, BandChoice());
  for (std::size_t i = 0; i < kAirBandCount; ++i) {
    const double turned = s.aerosol_depth[i] * henyey_greenstein_per_sr(s.asymmetry[i], cosine) +
                          s.molecular_depth[i] * rayleigh;
    out_.scattered_w_m2_sr_um[i] += turned * light[i];
  }
}

namespace {

// One order of scattering knows no other particles.
void take_turbid_as_aerosol(StepScattering& step) {
  for (std::size_t b = 0; b < step.cloud_depth.size(); ++b) {
    add_scattering(step.aerosol_depth[b], step.asymmetry[b], step.cloud_depth[b],
                   step.cloud_asymmetry[b]);
  }
}

}  // namespace

PathRadiance PathSums::result() {
  const std::size_t steps = path_.step_m.size();
  scattering_.resize(steps);
  prepare_sun();
  AbsorberAmounts behind = near_ ? *near_ : AbsorberAmounts();
  AirSpectrum t_near = transmittance(behind);
  const BandChoice all;
  AirSpectrum planck_near(kAirBandCount), planck_far(kAirBandCount), sun_near;
  if (steps > 0) planck_at(planck_near, 0);
  if (!sun_node_.empty()) sun_near = sunlight_by(0, behind);
  for (std::size_t i = 0; i < steps; ++i) {
    add_step(behind, &scattering_[i], atmosphere_, path_, i);
    take_turbid_as_aerosol(scattering_[i]);
    AirSpectrum t_far = transmittance(behind);
    planck_at(planck_far, i + 1);
    add_emission(out_.thermal_w_m2_sr_um, scattering_[i], t_near, t_far, planck_near, planck_far,
                 all);
    if (!sun_node_.empty()) {
      AirSpectrum sun_far = sunlight_by(i + 1, behind);
      add_scattered(i, sun_near, sun_far);
      sun_near = std::move(sun_far);
    }
    if (!light_.surroundings_w_m2_sr_um.empty()) {
      AirSpectrum share(kAirBandCount, 0.0);
      add_surroundings(share, scattering_[i], t_near, t_far, all);
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        out_.scattered_w_m2_sr_um[b] += light_.surroundings_w_m2_sr_um[b] * share[b];
      }
    }
    t_near = std::move(t_far);
    std::swap(planck_near, planck_far);
  }
  if (near_) {
    for (std::size_t i = 0; i < steps; ++i) {
      add_step(sum_, nullptr, atmosphere_, path_, i);
    }
    out_.transmittance = transmittance(sum_);
  } else {
    sum_ = std::move(behind);
    out_.transmittance = std::move(t_near);
  }
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    out_.total_w_m2_sr_um[b] = out_.thermal_w_m2_sr_um[b] + out_.scattered_w_m2_sr_um[b];
  }
  add_model_error();
  return std::move(out_);
}

namespace {

double line_depth_error(std::size_t band) {
  const double centre_cm1 = air_band_centre_cm1(band);
  if (centre_cm1 < kEmptyBandCm1) return kLineDepthError;
  return centre_cm1 > kEmptyBandCm1 ? kCoarseLineDepthError : kEmptyBandDepthError;
}

double transmittance_error(const AbsorberAmounts& amounts, double t, std::size_t band) {
  if (t >= 1) return 0;
  if (t <= 0) return kDarkError;
  double continua = 0, aerosol = 0;
  for (std::size_t g = 0; g < kGreyAbsorberCount; ++g) {
    const auto absorber = static_cast<GreyAbsorber>(g);
    const bool particles = absorber == GreyAbsorber::kAerosolAbsorption ||
                           absorber == GreyAbsorber::kAerosolScattering;
    (particles ? aerosol : continua) += amounts.grey(absorber)[band];
  }
  const double depth = -std::log(t);
  const double lines = std::max(0.0, depth - continua - aerosol);
  const double error = std::hypot(line_depth_error(band) * lines, kContinuumDepthError * continua,
                                  kAerosolRelativeError * aerosol) /
                       depth;
  double out = 0.5 * (std::exp(-depth * std::exp(-error)) - std::exp(-depth * std::exp(error)));
  // Through a dark path far more can pass than half of both sides: the light that three sigma less
  // depth let through is three errors, too.
  for (const double sigmas : {2.0, 3.0})
    out = std::max(out, (std::exp(-depth * std::exp(-sigmas * error)) - t) / sigmas);
  return std::hypot(out, kDarkError * (1 - t));
}

}  // namespace

ModelError model_error(const AbsorberAmounts& amounts, const AirSpectrum& transmittance,
                       const AirSpectrum& scattered, double warmest_k, const BandChoice& bands,
                       const AirSpectrum* surroundings, double haze) {
  const AirSpectrum scattering = scattering_optical_depth(amounts);
  ModelError out{AirSpectrum(kAirBandCount, 0.0), AirSpectrum(kAirBandCount, 0.0)};
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (!chosen(bands, b)) continue;
    const double sigma = out.transmittance[b] = transmittance_error(amounts, transmittance[b], b);
    if (warmest_k <= 0) continue;
    const double planck = planck_radiance_w_m2_sr_um(air_band_lambda_um(b), warmest_k);
    double error = std::hypot(sigma, kEmissionError * (1 - transmittance[b])) * planck +
                   kAerosolRelativeError * scattered[b];
    if (scattering[b] > 0.3) {
      const double again =
          surroundings ? std::abs(planck - (*surroundings)[b]) * (1 - std::exp(-scattering[b]))
                       : planck * (1 - std::exp(-scattering[b])) + scattered[b] * scattering[b];
      error += haze > 0 ? std::lerp(1.0, kHazeThermalError, haze) * again : again;
    }
    out.radiance_w_m2_sr_um[b] = error;
  }
  return out;
}

void PathSums::add_model_error() {
  double warmest_k = 0;
  for (const LightPath::Node& node : path_.node) {
    if (node.height_m > kThermosphereM) continue;
    warmest_k = std::max(warmest_k, air_at(atmosphere_.profile(), node.height_m).temperature_k);
  }
  const AirSpectrum scattering = scattering_optical_depth(sum_);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    const double lambda_um = air_band_lambda_um(b);
    if (((lambda_um >= 3 && lambda_um <= 5) || (lambda_um >= 8 && lambda_um <= 12))) {
      out_.scattering_optical_depth = std::max(out_.scattering_optical_depth, scattering[b]);
    }
  }
  ModelError error = model_error(sum_, out_.transmittance, out_.scattered_w_m2_sr_um, warmest_k);
  out_.model_error_transmittance = std::move(error.transmittance);
  out_.model_error_w_m2_sr_um = std::move(error.radiance_w_m2_sr_um);
  if (sun_node_.empty()) return;
  const AirSpectrum again =
      scattered_again_relative(atmosphere_, path_.node.front().height_m, light_.sun->zenith_deg);
  const double low = low_sun_relative(light_.sun->zenith_deg);
  for (std::size_t b = 0; b < kAirBandCount; ++b)
    out_.model_error_w_m2_sr_um[b] += std::hypot(again[b], low) * out_.scattered_w_m2_sr_um[b];
}

AirSpectrum downward_irradiance_w_m2_um(const Atmosphere& atmosphere, double height_m,
                                        const PathLight& light, int zeniths) {
  IRSIG_CHECK(zeniths >= 1);
  IRSIG_CHECK(zeniths <= 64);
  const int azimuths = light.sun.has_value() ? 16 : 1;
  AirSpectrum sum(kAirBandCount, 0.0);
  for (int i = 0; i < zeniths; ++i) {
    // Legendre's node on [0, 1] by Newton's method from Tricomi's approximation.
    double x = std::cos(std::numbers::pi * (i + 0.75) / (zeniths + 0.5)), slope = 1;
    for (int n = 0; n < 100; ++n) {
      double p0 = 1, p1 = x;
      for (int k = 2; k <= zeniths; ++k) {
        const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      if (zeniths == 1) p0 = 1;
      slope = zeniths * (x * p1 - p0) / (x * x - 1);
      const double change = p1 / slope;
      x -= change;
      if (std::abs(change) < 1e-15) break;
    }
    const double cosine = 0.5 * (1 + x), weight = 1 / ((1 - x * x) * slope * slope);
    for (int j = 0; j < azimuths; ++j) {
      PathLight turned = light;
      if (turned.sun) turned.sun->azimuth_deg = 180.0 * (j + 0.5) / azimuths;
      const PathRadiance sky =
          atmosphere.sky_radiance(height_m, std::acos(cosine) / kRadPerDeg, turned);
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        sum[b] += 2 * std::numbers::pi * weight * cosine / azimuths * sky.total_w_m2_sr_um[b];
      }
    }
  }
  return sum;
}

}  // namespace irsig
