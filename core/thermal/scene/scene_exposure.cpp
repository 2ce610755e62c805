#include "core/thermal/scene/scene_exposure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/constants.h"
#include "core/thermal/clear_sky.h"
#include "core/thermal/scene/sun_visibility.h"

namespace irsig {
namespace {

// Natural convection of water at large faces, Nu = 0.13 Ra^(1/3) at 15 deg C: expansion 1.5e-4 / K,
// viscosity 1.19e-6, diffusivity 1.4e-7 m2/s, 0.6 W/(m K).
constexpr Convection kStillWater{160, 160, 1};

double power4(double t) { return t * t * t * t; }

// Returns the heat capacity of a wall from its outer face, as deep as heat diffuses in a time; an
// insulation ends it.
double heat_capacity_reached(const std::vector<Layer>& layers, double time_s) {
  double left = std::sqrt(time_s / std::numbers::pi), out = 0;  // depth over root of diffusivity
  for (const Layer& layer : layers) {
    const double capacity = layer.density_kg_m3 * layer.specific_heat_j_kg_k;
    if (layer.conductivity_w_m_k == 0) break;
    if (capacity == 0) continue;
    const double per_m = std::sqrt(capacity / layer.conductivity_w_m_k),
                 depth = std::min(layer.thickness_m, left / per_m);
    out += capacity * depth;
    left -= depth * per_m;
    if (left <= 0) break;
  }
  return std::max(out, 1.0);
}

std::vector<bool> covered_faces(const Target& target, const ThermalFaces& faces, double surface_z_m,
                                double touching_m) {
  std::vector<bool> out;
  for (std::uint32_t face = 0; face < faces.size(); ++face) {
    // A body that stands on the surface is covered from below; a layer that lies on it, like a
    // road, is not.
    const double below_m = faces.centroid_z_m[face] - surface_z_m;
    out.push_back(below_m > touching_m ||
                  (below_m > -touching_m && normal_of(target, faces, face).z > 0.5f));
  }
  return out;
}

double cosine_between(FaceNormal n, Vec<Body> direction) {
  return static_cast<double>(n.x) * direction.x + static_cast<double>(n.y) * direction.y +
         static_cast<double>(n.z) * direction.z;
}

// Returns the root mean square deviation over a face of which some places have all and the others
// nothing.
double root_of_parts(double mean, double all) {
  return std::sqrt(std::max(0.0, mean * (all - mean)));
}

std::uint64_t mix(std::uint64_t seed, std::size_t knot) {
  return seed * 0x9e3779b97f4a7c15ULL + knot + 1;
}

std::vector<double> emissivities(const SceneHeatRequest& request, const Target& target,
                                 const ThermalFaces& faces, const std::vector<bool>& covered) {
  std::vector<double> out;
  // Under a surface nothing shines; ground there is as warm as the ground.
  for (std::uint32_t face = 0; face < faces.size(); ++face)
    out.push_back(covered[face] && request.beneath.water
                      ? 0.0
                      : request.part[target.facet[faces.facet[face]].part].emissivity);
  return out;
}

// Returns the largest difference between the radiation of a face and that of air, as far as it is
// stated: by the face's own temperature, or by what is behind its wall. [face]
std::vector<double> beyond_air(const SceneHeatRequest& request, const Target& target,
                               const ThermalFaces& faces, std::span<const double> emissivity) {
  const auto [coldest, warmest] =
      std::minmax_element(request.weather.begin(), request.weather.end(),
                          [](const auto& a, const auto& b) { return a.air_k < b.air_k; });
  const auto beyond_w_m2 = [&](double kelvin) {
    const double w_m2 = power4(kelvin);
    return kStefanBoltzmannWM2K4 * std::max(std::abs(w_m2 - power4(coldest->air_k)),
                                            std::abs(w_m2 - power4(warmest->air_k)));
  };
  const auto background_w_m2 = [&](const WallBuildUp& wall) {
    if (wall.inner_side == InnerSide::kAdiabatic || wall.inner_side == InnerSide::kOpen) return 0.0;
    const bool heat_flux = wall.inner_side == InnerSide::kHeatFlux;
    // Only a fraction of an inner temperature reaches the outer face, against some convection and
    // radiation.
    constexpr double kOutsideWM2K = 10;
    double m2_k_w = wall.inner_side == InnerSide::kAir ? 1 / wall.inner_h_w_m2_k : 0;
    for (const Layer& layer : wall.layers) m2_k_w += layer.thickness_m / layer.conductivity_w_m_k;
    const double reaches = 1 / (1 + kOutsideWM2K * m2_k_w);
    const auto of = [&](double value) {
      return heat_flux ? std::abs(value) : reaches * beyond_w_m2(value);
    };
    if (wall.inner_at.empty()) return of(heat_flux ? wall.inner_flux_w_m2 : wall.inner_k);
    double most = 0;
    for (const ScheduleAtKnot& at : wall.inner_at)
      most = std::max({most, of(at.before), of(at.after)});
    return most;
  };
  std::vector<double> of_part, out;
  for (const HeatPart& part : request.part)
    of_part.push_back(part.build_up ? background_w_m2(request.build_up[*part.build_up])
                                    : beyond_w_m2(part.stated_k));
  for (std::uint32_t face = 0; face < faces.size(); ++face)
    out.push_back(emissivity[face] * of_part[target.facet[faces.facet[face]].part]);
  return out;
}

}  // namespace

double SceneExposure::touching_m() const { return 1e-5 * target_.radius_m; }
double SceneExposure::surface_z_m() const { return request_.beneath.surface_z_m + touching_m(); }

SceneExposure::SceneExposure(const Target& target, const ThermalFaces& faces,
                             const SceneHeatRequest& request, SceneKnots knots,
                             const SceneExposure* near)
    : target_(target),
      faces_(faces),
      request_(request),
      knots_(std::move(knots)),
      covered_(covered_faces(target, faces, request.beneath.surface_z_m, touching_m())),
      emissivity_(emissivities(request, target, faces, covered_)),
      factors_(near != nullptr
                   ? near->factors_
                   : std::make_shared<const ExchangeFactors>(exchange_factors(
                         target, faces,
                         {.rays = knots_.rays,
                          .seed = knots_.seed,
                          .surface_z_m = surface_z_m(),
                          .beyond_w_m2 = beyond_air(request, target, faces, emissivity_),
                          .keep_hits = knots_.keep_hits}))),
      long_wave_(*factors_, emissivity_, covered_),
      own_(faces.size()),
      emitted_(faces.size()) {
  for (std::size_t k = 0; k < this->knots(); ++k) {
    const auto forced_w_m2_k = [&](WindSide side) {
      return request_.convection_factor * mowitt_forced_w_m2_k(weather(k).wind_m_s, side);
    };
    windward_w_m2_k_.push_back(forced_w_m2_k(WindSide::kWindward));
    leeward_w_m2_k_.push_back(forced_w_m2_k(WindSide::kLeeward));
  }
  const GroundBoundary& b = request_.beneath;
  if (b.water)
    in_water_w_m2_k_ =
        plate_in_flow_w_m2_k(sea_water(b.temperature_k), b.flow_m_s, 2 * target_.radius_m);
  dark_.resize(faces_.fronts);
  for (std::uint32_t f = 0; f < faces_.fronts; ++f) {
    const std::uint32_t back = faces_.back_of_facet[f];
    dark_[f] =
        factors_->exposed[f] <= 0 && (back == ThermalFaces::kNone || factors_->exposed[back] <= 0);
  }
  light();
  respond_to_sky();
}

void SceneExposure::fraction_dark(SceneExposure& a, SceneExposure& b) {
  for (std::size_t f = 0; f < a.dark_.size(); ++f)
    a.dark_[f] = b.dark_[f] = a.dark_[f] || b.dark_[f];
}

// Long-wave radiation is linear in what the sky sends, so that a jump of it is known at both sides
// of a knot once what it brings is.
void SceneExposure::respond_to_sky() {
  const std::size_t faces = faces_.size();
  const double below = 1 - request_.beneath.emissivity;
  std::vector<double> own(faces), nothing(faces), total(faces);
  for (std::size_t i = 0; i < faces; ++i)
    own[i] = covered_[i] ? 0
                         : static_cast<double>(factors_->sky[i]) +
                               static_cast<double>(factors_->lower[i]) * below;
  of_sky_alone_.assign(own.begin(), own.end());
  total = own;
  long_wave_.solve(own, nothing, 1e-6, total);
  of_sky_exchanged_.assign(total.begin(), total.end());
  of_sky_ = exchanges() ? of_sky_exchanged_ : of_sky_alone_;
}

// Sunlight absorbed per direct normal irradiance at every knot, and per diffuse horizontal one at
// any; what faces reflect to each other included.
void SceneExposure::light() {
  const std::size_t faces = faces_.size();
  direct_.assign(knots() * faces, 0.0f);
  uneven_.assign(knots() * faces, 0.0f);
  std::vector<float> lit(faces);
  std::vector<double> own(faces), total(faces), kept(faces), nothing(faces);
  for (std::uint32_t i = 0; i < faces; ++i) kept[i] = part_of(i).solar_absorptance;
  Radiosity sunlight(*factors_, kept, covered_);
  const auto from_below = [&](std::size_t i) {
    return request_.beneath.solar_albedo * static_cast<double>(factors_->lower[i]);
  };
  const auto gathered = [&](const auto& store) {
    total = own;
    sunlight.solve(own, nothing, 1e-6, total);
    for (std::size_t i = 0; i < faces; ++i) store(i, static_cast<float>(kept[i] * total[i]));
  };
  // A face that is not exposed is not lit.
  const auto of_exposed = [&](std::size_t i) {
    return factors_->exposed[i] > 0
               ? static_cast<double>(std::min(lit[i] / factors_->exposed[i], 1.0f))
               : 0.0;
  };
  for (std::size_t i = 0; i < faces; ++i)
    own[i] = covered_[i] ? 0 : static_cast<double>(factors_->sky[i]) + from_below(i);
  diffuse_.resize(faces);
  gathered([&](std::size_t i, float value) { diffuse_[i] = value; });
  for (std::size_t k = 0; k < knots(); ++k) {
    const HeatWeather& w = weather(k);
    if (w.sun.z >= 0 || std::max(w.before.direct_normal_w_m2, w.after.direct_normal_w_m2) <= 0)
      continue;
    sun_visibility(target_, faces_, {w.sun, w.sun_radius_rad},
                   {.points = knots_.sun_points,
                    .seed = mix(knots_.seed, of_request(k)),
                    .surface_z_m = surface_z_m()},
                   lit);
    for (std::size_t i = 0; i < faces; ++i) {
      own[i] = covered_[i] ? 0 : of_exposed(i) - w.sun.z * from_below(i);
      if (lit[i] > 0 && !covered_[i])
        uneven_[k * faces + i] = static_cast<float>(
            kept[i] *
            root_of_parts(
                of_exposed(i),
                cosine_between(normal_of(target_, faces_, static_cast<std::uint32_t>(i)), w.sun)));
    }
    gathered([&](std::size_t i, float value) { direct_[k * faces + i] = value; });
  }
}

void SceneExposure::send_around(std::size_t k) {
  const GroundBoundary& b = request_.beneath;
  const double sky = 0.5 * (weather(k).before.sky_w_m2 + weather(k).after.sky_w_m2),
               ground = kStefanBoltzmannWM2K4 * power4(b.kelvin_at(of_request(k))),
               below = b.emissivity * ground + (1 - b.emissivity) * sky;
  for (std::size_t i = 0; i < faces_.size(); ++i)
    own_[i] = covered_[i] ? (b.water ? 0 : ground)
                          : static_cast<double>(factors_->sky[i]) * sky +
                                static_cast<double>(factors_->lower[i]) * below;
}

void SceneExposure::long_wave(std::size_t k, std::span<const float> kelvin, double tolerance_w_m2,
                              std::span<double> incoming_w_m2) {
  if (request_.exchange)
    long_wave_of_faces(k, kelvin, tolerance_w_m2, incoming_w_m2);
  else
    long_wave_of_air(k, incoming_w_m2);
}

void SceneExposure::long_wave_of_faces(std::size_t k, std::span<const float> kelvin,
                                       double tolerance_w_m2, std::span<double> incoming_w_m2) {
  send_around(k);
  for (std::size_t i = 0; i < faces_.size(); ++i)
    emitted_[i] = emissivity_[i] * kStefanBoltzmannWM2K4 * power4(static_cast<double>(kelvin[i]));
  long_wave_.solve(own_, emitted_, tolerance_w_m2, incoming_w_m2);
}

void SceneExposure::long_wave_of_air(std::size_t k, std::span<double> incoming_w_m2) {
  send_around(k);
  const double air_w_m2 = kStefanBoltzmannWM2K4 * power4(weather(k).air_k);
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const double seen =
        static_cast<double>(factors_->sky[i]) + static_cast<double>(factors_->lower[i]);
    incoming_w_m2[i] = own_[i] + (covered_[i] ? 0 : std::max(0.0, 1 - seen) * air_w_m2);
  }
}

void SceneExposure::arriving(std::span<const double> emitted_w_m2, double tolerance_w_m2,
                             std::span<double> incoming_w_m2) {
  std::ranges::fill(own_, 0.0);
  long_wave_.solve(own_, emitted_w_m2, tolerance_w_m2, incoming_w_m2);
}

FaceProperties SceneExposure::properties(std::uint32_t face) const {
  if (covered_[face])
    return {emissivity_[face], request_.beneath.water ? kStillWater : kForcedOnly};
  Convection air =
      tarp_natural(-static_cast<double>(normal_of(target_, faces_, face).z));  // z is down
  air.natural_warm *= request_.convection_factor;
  air.natural_cold *= request_.convection_factor;
  air.mixing = 0;  // with forced parts by MoWiTT: root of the sum of squares, as in DOE-2
  FaceProperties out{emissivity_[face], air};
  const HeatPart& part = part_of(face);
  if (face < faces_.fronts && part.build_up && request_.build_up[*part.build_up].water)
    out.evaporation = evaporation_of(*request_.build_up[*part.build_up].water);
  return out;
}

void SceneExposure::expose_water(std::size_t k, const HeatRadiation& light, std::uint32_t face,
                                 std::size_t at, const FaceExposure& to) const {
  const HeatWeather& w = weather(k);
  const HeatPart& part = part_of(face);
  const std::optional<SurfaceWater>& water = request_.build_up[*part.build_up].water;
  to.vapour_pa[at] = vapour_pressure_pa(w.humid->dew_point_k);
  to.inverse_gamma_k_pa[at] = inverse_gamma_k_pa(w.air_k, w.humid->pressure_pa);
  to.stomatal_w_m2_k[at] = 0;
  if (!water->canopy) return;
  // Leaves see all sunlight, whatever is left out of what warms them.
  const double absorbed_w_m2 =
      light.direct_normal_w_m2 * static_cast<double>(direct_[k * faces_.size() + face]) +
      light.diffuse_horizontal_w_m2 * static_cast<double>(diffuse_[face]);
  to.stomatal_w_m2_k[at] = stomatal_w_m2_k(*water->canopy, absorbed_w_m2 / part.solar_absorptance,
                                           w.air_k, w.humid->pressure_pa);
}

void SceneExposure::expose(std::size_t k, Side side, std::span<const std::uint32_t> face,
                           const FaceExposure& to) const {
  const HeatWeather& w = weather(k);
  const HeatRadiation& light = side == Side::kAfter ? w.after : w.before;
  const float* direct = direct_.data() + k * faces_.size();
  for (std::size_t at = 0; at < face.size(); ++at) {
    const std::uint32_t f = face[at];
    to.absorbed_w_m2[at] =
        light.direct_normal_w_m2 * static_cast<double>(direct[f]) +
        (request_.diffuse_sun ? light.diffuse_horizontal_w_m2 * static_cast<double>(diffuse_[f])
                              : 0);
    if (covered_[f]) {
      to.fluid_k[at] = request_.beneath.kelvin_at(of_request(k));
      to.forced_h_w_m2_k[at] = in_water_w_m2_k_;
      if (!to.vapour_pa.empty())
        to.vapour_pa[at] = to.inverse_gamma_k_pa[at] = to.stomatal_w_m2_k[at] = 0;
      continue;
    }
    if (!to.vapour_pa.empty()) expose_water(k, light, f, at, to);
    to.fluid_k[at] = w.air_k;
    const FaceNormal n = normal_of(target_, faces_, f);
    const double towards =
        static_cast<double>(n.x) * w.wind_from.x + static_cast<double>(n.y) * w.wind_from.y;
    to.forced_h_w_m2_k[at] = towards > -1e-6 ? windward_w_m2_k_[k] : leeward_w_m2_k_[k];
  }
}

double SceneExposure::loss_w_m2_k(std::size_t k, std::uint32_t face, double kelvin) const {
  return std::max(1.0,
                  std::min(windward_w_m2_k_[k], leeward_w_m2_k_[k]) +
                      4 * emissivity_[face] * kStefanBoltzmannWM2K4 * kelvin * kelvin * kelvin);
}

double SceneExposure::aimed_k(std::size_t k, std::uint32_t facet, double kelvin) const {
  if (!request_.exchange) return 0;
  const auto arriving_w_m2 = [&](std::uint32_t face) {
    return emissivity_[face] * static_cast<double>(factors_->aimed_stderr_w_m2[face]);
  };
  const std::uint32_t back = faces_.back_of_facet[facet];
  return (arriving_w_m2(facet) + (back == ThermalFaces::kNone ? 0 : arriving_w_m2(back))) /
         loss_w_m2_k(k, facet, kelvin);
}

double SceneExposure::ray_stderr_w_m2(std::size_t k, std::uint32_t face,
                                      std::span<const float> kelvin,
                                      std::span<const float> incoming) const {
  const ExchangeFactors& f = *factors_;
  constexpr std::size_t kBlocks = ExchangeFactors::kBlocks;
  const std::size_t at = face * kBlocks, n = faces_.size();
  double rays = 0;
  for (std::size_t b = 0; b < kBlocks; ++b) rays += f.all_hits[at + b];
  if (rays == 0 || covered_[face]) return 0;
  const HeatWeather& w = weather(k);
  const auto bright = [](double before, double after) { return std::max(before, after); };
  const double sky = 0.5 * (w.before.sky_w_m2 + w.after.sky_w_m2),
               air = kStefanBoltzmannWM2K4 * power4(w.air_k),
               diffuse = bright(w.before.diffuse_horizontal_w_m2, w.after.diffuse_horizontal_w_m2),
               direct = bright(w.before.direct_normal_w_m2, w.after.direct_normal_w_m2),
               e_below = request_.beneath.emissivity,
               below = e_below * kStefanBoltzmannWM2K4 *
                           power4(request_.beneath.kelvin_at(of_request(k))) +
                       (1 - e_below) * sky,
               lit = request_.diffuse_sun ? diffuse : 0;
  const double absorbs = part_of(face).solar_absorptance, emits = emissivity_[face];
  const double of_sky = emits * sky + absorbs * lit,
               of_below = emits * below + absorbs * request_.beneath.solar_albedo *
                                              (lit + direct * std::max(0.0, -w.sun.z));
  const auto of_face = [&](std::uint32_t j) {
    if (j == ThermalFaces::kNone) return emits * air;
    const double thermal = request_.exchange
                               ? emissivity_[j] * kStefanBoltzmannWM2K4 *
                                         power4(static_cast<double>(kelvin[k * n + j])) +
                                     (1 - emissivity_[j]) * static_cast<double>(incoming[k * n + j])
                               : air;
    const double kept = part_of(j).solar_absorptance;
    const double sun = kept > 0 ? (1 - kept) / kept *
                                      (direct * static_cast<double>(direct_[k * n + j]) +
                                       lit * static_cast<double>(diffuse_[j]))
                                : 0;
    return emits * thermal + absorbs * sun;
  };
  std::array<double, kBlocks> sum{};
  for (std::size_t b = 0; b < kBlocks; ++b)
    sum[b] = of_sky * f.sky_hits[at + b] + of_below * f.lower_hits[at + b];
  for (std::size_t h = f.first_hit[face]; h < f.first_hit[face + 1]; ++h)
    sum[f.hit[h].block] += f.hit[h].count * of_face(f.hit[h].to);
  double mean = 0, square = 0, blocks = 0;
  for (std::size_t b = 0; b < kBlocks; ++b) mean += sum[b] / rays;
  for (std::size_t b = 0; b < kBlocks; ++b) {
    if (f.all_hits[at + b] == 0) continue;
    const double off = sum[b] / f.all_hits[at + b] - mean;
    square += off * off;
    ++blocks;
  }
  // No ray may meet a thing that lies between two rays.
  const double unmet = emits * std::abs(sky - air) / rays;
  return std::hypot(blocks > 1 ? std::sqrt(square / (blocks * (blocks - 1))) : mean, unmet);
}

std::vector<double> SceneExposure::by_rays_k(std::uint32_t facet, std::span<const float> kelvin,
                                             std::span<const float> incoming,
                                             std::span<const float> front_kelvin) const {
  constexpr double kEveryS = 3600;
  const std::uint32_t back = faces_.back_of_facet[facet];
  std::vector<double> heat(knots());
  double last_s = -1e300;
  bool any = false;
  for (std::size_t k = 0; k < knots(); ++k) {
    if (k > 0 && knot_s(k) < last_s + kEveryS) {
      heat[k] = heat[k - 1];
      continue;
    }
    last_s = knot_s(k);
    heat[k] = ray_stderr_w_m2(k, facet, kelvin, incoming);
    if (back != ThermalFaces::kNone)
      heat[k] = std::hypot(heat[k], ray_stderr_w_m2(k, back, kelvin, incoming));
    any |= heat[k] > 0;
  }
  return any ? warms_k(facet, heat, front_kelvin) : heat;
}

std::vector<double> SceneExposure::uneven_k(std::uint32_t facet,
                                            std::span<const float> kelvin) const {
  std::vector<double> heat;
  const std::uint32_t back = faces_.back_of_facet[facet];
  const auto heat_w_m2 = [&](std::size_t k) {
    const HeatWeather& w = weather(k);
    const double sun = std::max(w.before.direct_normal_w_m2, w.after.direct_normal_w_m2),
                 air = kStefanBoltzmannWM2K4 * power4(w.air_k),
                 sky =
                     std::max(std::abs(w.before.sky_w_m2 - air), std::abs(w.after.sky_w_m2 - air)),
                 below = std::abs(kStefanBoltzmannWM2K4 *
                                      power4(request_.beneath.kelvin_at(of_request(k))) -
                                  air);
    const auto of = [&](std::uint32_t face) {
      const ExchangeFactors& f = *factors_;
      const double around = static_cast<double>(f.uneven_aims_w_m2[face]) +
                            sky * static_cast<double>(f.uneven_sky[face]) +
                            below * static_cast<double>(f.uneven_lower[face]);
      return sun * static_cast<double>(uneven_[k * faces_.size() + face]) +
             (request_.exchange && !covered_[face] ? emissivity_[face] * around : 0);
    };
    return of(facet) + (back == ThermalFaces::kNone ? 0 : of(back));
  };
  bool any = false;
  for (std::size_t k = 0; k < knots(); ++k) any |= heat.emplace_back(heat_w_m2(k)) > 0;
  return any ? warms_k(facet, heat, kelvin) : heat;
}

std::vector<double> SceneExposure::warms_k(std::uint32_t facet, std::span<const double> heat_w_m2,
                                           std::span<const float> kelvin) const {
  std::vector<double> out(knots(), 0.0);
  const WallBuildUp& wall = request_.build_up[*part_of(facet).build_up];
  for (const double reach_s : {3600.0, 86400.0}) {
    const double stored_j_m2_k = heat_capacity_reached(wall.layers, reach_s);
    double now_k = 0;
    const auto go_on = [&](std::size_t k) {
      const double loss = loss_w_m2_k(k, facet, static_cast<double>(kelvin[k]));
      const double fades = std::exp(-(knot_s(k) - knot_s(k - 1)) * loss / stored_j_m2_k);
      now_k = fades * now_k + (1 - fades) * std::max(heat_w_m2[k], heat_w_m2[k - 1]) / loss;
    };
    // A day that has repeated for ever, by its second time.
    for (std::size_t k = 1; k <= knots_.day_intervals; ++k) go_on(k);
    out[0] = std::max(out[0], now_k);
    for (std::size_t k = 1; k < knots(); ++k) {
      go_on(k);
      out[k] = std::max(out[k], now_k);
    }
  }
  return out;
}

bool SceneExposure::is_smooth(std::size_t k) const {
  constexpr double kJumpWM2 = 1;
  const auto near = [](double a, double b) { return std::abs(a - b) < kJumpWM2; };
  const HeatRadiation &before = weather(k).before, &after = weather(k).after;
  return k > 0 && near(before.direct_normal_w_m2, after.direct_normal_w_m2) &&
         near(before.diffuse_horizontal_w_m2, after.diffuse_horizontal_w_m2) &&
         near(before.sky_w_m2, after.sky_w_m2);
}

}  // namespace irsig
