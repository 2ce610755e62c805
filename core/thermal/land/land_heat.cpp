#include "core/thermal/land/land_heat.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/geo/frames.h"
#include "core/thermal/clear_sky.h"
#include "core/thermal/heat_solver.h"

namespace irsig {
namespace {

double power4(double t) { return t * t * t * t; }

// A place of one material.
struct Place {
  Vec<Enu> normal;
  const LandHorizon* horizon;
};

// Radiation falls on a place through the part of its hemisphere that is sky; the rest is land.
double sky_fraction(const Place& at) {
  constexpr int kElevations = 45, kAzimuths = 64;
  double sky = 0, all = 0;
  for (int a = 0; a < kAzimuths; ++a) {
    const double azimuth = 2 * std::numbers::pi * (a + 0.5) / kAzimuths,
                 horizon = at.horizon->at(azimuth);
    const std::uint32_t near = LandHorizon::nearest(azimuth);
    const auto lid_low = static_cast<double>(at.horizon->lid_low_rad[near]),
               lid_high = static_cast<double>(at.horizon->lid_high_rad[near]);
    const double along = at.normal.x * std::sin(azimuth) + at.normal.y * std::cos(azimuth);
    for (int e = -kElevations; e < kElevations; ++e) {
      const double elevation = 0.5 * std::numbers::pi * (e + 0.5) / kElevations,
                   cosine = along * std::cos(elevation) + at.normal.z * std::sin(elevation);
      if (cosine <= 0) continue;
      const double weight = cosine * std::cos(elevation);
      all += weight;
      // A cell of elevations that the horizon cuts counts in part.
      const double cell = 0.5 * std::numbers::pi / kElevations,
                   lowest = std::max(horizon, 0.0) - (elevation - 0.5 * cell);
      if (elevation < lid_low || elevation >= lid_high)
        sky += weight * std::clamp(1 - lowest / cell, 0.0, 1.0);
    }
  }
  return sky / all;
}

// What sends light and heat to the places of one material.
class LandExposure {
 public:
  LandExposure(const LandHeatRequest& request, const LandHeatMaterial& material,
               std::vector<Place> place, std::size_t every)
      : request_(request), material_(material), place_(std::move(place)), every_(every) {
    for (const Place& at : place_) sky_.push_back(sky_fraction(at));
    for (const HeatWeather& w : request.weather) {
      sun_.push_back(enu_from_body(w.sun, request.heading_deg));
      wind_from_.push_back(enu_from_body(w.wind_from, request.heading_deg));
    }
  }

  // [request knot] Of level land around; empty: a level place has none.
  void set_around_k(std::vector<double> kelvin) { around_k_ = std::move(kelvin); }

  [[nodiscard]] std::size_t knots() const { return (request_.knot_s.size() - 1) / every_ + 1; }
  [[nodiscard]] double knot_s(std::size_t k) const { return request_.knot_s[k * every_]; }

  [[nodiscard]] HeatRequest heat_request(double tolerance_k) const {
    HeatRequest out;
    const WallBuildUp& wall = material_.wall;
    out.layers = wall.layers;
    out.inner_side = wall.inner_side;
    double mean_k = 0;
    for (std::size_t k = 0; k < knots(); ++k) {
      const HeatWeather& w = request_.weather[k * every_];
      out.knot_s.push_back(knot_s(k));
      out.smooth.push_back(w.before.direct_normal_w_m2 == w.after.direct_normal_w_m2 &&
                           w.before.diffuse_horizontal_w_m2 == w.after.diffuse_horizontal_w_m2 &&
                           w.before.sky_w_m2 == w.after.sky_w_m2 && !wall.jumps_at(k * every_));
      mean_k += w.air_k / static_cast<double>(knots());
      if (every_ > 1 || k % 2 == 0) out.output_knot.push_back(k);
    }
    for (const Place& at : place_) {
      Convection air = tarp_natural(at.normal.z);
      air.natural_warm *= request_.convection_factor;
      air.natural_cold *= request_.convection_factor;
      air.mixing = 0;  // as walls of a target have it
      FaceProperties& face = out.outer.emplace_back(FaceProperties{material_.emissivity, air});
      if (wall.water) face.evaporation = evaporation_of(*wall.water);
    }
    constexpr int kMostDays = 200;
    out.start = PeriodicStart{mean_k, request_.day_knots / every_, tolerance_k, kMostDays, {}};
    out.output_boundary = {0};
    out.accuracy.tolerance_k = tolerance_k;
    return out;
  }

  void fill(std::size_t interval, std::span<const std::uint32_t> element,
            const Exposure& to) const {
    const std::size_t begin = interval * every_, end = begin + every_;
    for (std::size_t at = 0; at < element.size(); ++at) {
      const std::uint32_t e = element[at];
      const Sunlit lit = direct_w_m2(begin, end, place_[e]);
      face(begin, true, e, lit.begin_w_m2, at, to.outer_begin);
      face(end, false, e, lit.end_w_m2, at, to.outer_end);
    }
    inside(begin, true, to.inner_begin);
    inside(end, false, to.inner_end);
  }

  // Returns the error of a temperature at a knot of the request because an edge of a shadow that
  // has just passed is a line. The surface answers to what the line misses as a half-space does, at
  // most as a sheet without capacity.
  [[nodiscard]] double edge_k(std::size_t k, std::uint32_t e, double kelvin) const {
    if (k == 0) return 0;
    const auto edge = edge_between(k - 1, k, place_[e]);
    if (!edge) return 0;
    double effusivity = std::numeric_limits<double>::infinity();  // [W s^(1/2) m^-2 K^-1]
    for (const Layer& layer : material_.wall.layers)
      effusivity = std::min(effusivity, std::sqrt(layer.conductivity_w_m_k * layer.density_kg_m3 *
                                                  layer.specific_heat_j_kg_k));
    const HeatWeather& w = request_.weather[k];
    const double loss_w_m2_k =
        request_.convection_factor *
            std::min(mowitt_forced_w_m2_k(w.wind_m_s, WindSide::kWindward),
                     mowitt_forced_w_m2_k(w.wind_m_s, WindSide::kLeeward)) +
        4 * material_.emissivity * kStefanBoltzmannWM2K4 * kelvin * kelvin * kelvin;
    const double length_s = request_.knot_s[k] - request_.knot_s[k - 1];
    double sum = 0, absolute = 0,
           most = std::abs(w.before.direct_normal_w_m2 * reaching_at(k, place_[e]) -
                           edge->line.end_w_m2);
    for (int i = 0; i < kInstants; ++i) {
      const double begin = static_cast<double>(i) / kInstants, end = (i + 1.0) / kInstants;
      const double missed =
          edge->w_m2[static_cast<std::size_t>(i)] -
          std::lerp(edge->line.begin_w_m2, edge->line.end_w_m2, 0.5 * (begin + end));
      const double answer = 2 / effusivity * std::sqrt(length_s / std::numbers::pi) *
                            (std::sqrt(1 - begin) - std::sqrt(1 - end));
      sum += missed * answer;
      absolute += std::abs(missed) * answer;
      most = std::max(most, std::abs(missed));
    }
    return material_.solar_absorptance *
           std::min(std::max(std::abs(sum), 0.5 * absolute), most / std::max(loss_w_m2_k, 1.0));
  }

 private:
  // Share of the sun's disk above the horizon of a place, times the cosine of its incidence.
  [[nodiscard]] static double reaching(const Place& at, Vec<Enu> sun, double radius_rad) {
    const double cosine = dot(at.normal, sun);
    if (cosine <= 0) return 0;
    const double elevation = std::asin(std::clamp(sun.z, -1.0, 1.0)),
                 azimuth = std::atan2(sun.x, sun.y), above = elevation - at.horizon->at(azimuth);
    const std::uint32_t near = LandHorizon::nearest(azimuth);
    if (elevation > static_cast<double>(at.horizon->lid_low_rad[near]) &&
        elevation < static_cast<double>(at.horizon->lid_high_rad[near]))
      return 0;
    return cosine * std::clamp(0.5 + 0.5 * above / radius_rad, 0.0, 1.0);
  }

  // Irradiance at both ends of an interval between two knots. Where an edge of a shadow passes, the
  // line between them that is nearest to many instants, with their mean and their centre of time:
  // it may be below 0 at one end.
  struct Sunlit {
    double begin_w_m2, end_w_m2;
  };
  [[nodiscard]] Sunlit direct_w_m2(std::size_t begin, std::size_t end, const Place& at) const {
    if (const auto edge = edge_between(begin, end, at)) return edge->line;
    return {request_.weather[begin].after.direct_normal_w_m2 * reaching_at(begin, at),
            request_.weather[end].before.direct_normal_w_m2 * reaching_at(end, at)};
  }
  [[nodiscard]] double reaching_at(std::size_t k, const Place& at) const {
    return reaching(at, sun_[k], request_.weather[k].sun_radius_rad);
  }

  // Irradiance at instants of an interval that an edge of a shadow passes, and its line.
  static constexpr int kInstants = 16;
  struct Edge {
    std::array<double, kInstants> w_m2;
    Sunlit line;
  };
  [[nodiscard]] std::optional<Edge> edge_between(std::size_t begin, std::size_t end,
                                                 const Place& at) const {
    const double first = request_.weather[begin].after.direct_normal_w_m2,
                 last = request_.weather[end].before.direct_normal_w_m2;
    if (first <= 0 && last <= 0) return std::nullopt;
    Edge out{};
    double mean = 0, slope = 0;
    bool lit = false, unlit = false;
    const auto see = [&](Vec<Enu> sun, double share) {
      (share >= std::max(0.0, dot(at.normal, sun)) ? lit : unlit) = true;
    };
    see(sun_[begin], reaching_at(begin, at));
    see(sun_[end], reaching_at(end, at));
    for (int i = 0; i < kInstants; ++i) {
      const double t = (i + 0.5) / kInstants;
      const Vec<Enu> sun = normalized((1 - t) * sun_[begin] + t * sun_[end]);
      const double share = reaching(at, sun, request_.weather[begin].sun_radius_rad);
      out.w_m2[static_cast<std::size_t>(i)] = std::lerp(first, last, t) * share;
      mean += out.w_m2[static_cast<std::size_t>(i)] / kInstants;
      slope += 12 * (t - 0.5) * out.w_m2[static_cast<std::size_t>(i)] / kInstants;
      see(sun, share);
    }
    if (!lit || !unlit) return std::nullopt;
    out.line = {mean - 0.5 * slope, mean + 0.5 * slope};
    return out;
  }

  void face(std::size_t k, bool after, std::uint32_t e, double direct_w_m2, std::size_t at,
            const FaceExposure& to) const {
    const HeatWeather& w = request_.weather[k];
    const HeatRadiation& light = after ? w.after : w.before;
    const double sky = sky_[e], land = 1 - sky, reflects = 1 - material_.solar_absorptance,
                 on_level = light.direct_normal_w_m2 * std::max(0.0, sun_[k].z) +
                            light.diffuse_horizontal_w_m2,
                 sunlight =
                     direct_w_m2 + sky * light.diffuse_horizontal_w_m2 + land * reflects * on_level;
    to.absorbed_w_m2[at] = material_.solar_absorptance * sunlight;
    const double e_ir = material_.emissivity,
                 around = around_k_.empty() ? light.sky_w_m2
                                            : e_ir * kStefanBoltzmannWM2K4 * power4(around_k_[k]) +
                                                  (1 - e_ir) * light.sky_w_m2;
    to.incoming_w_m2[at] = sky * light.sky_w_m2 + land * around;
    to.fluid_k[at] = w.air_k;
    // Level land is windward, a wall in the lee leeward; slopes lie between, without a jump.
    const double lee = std::clamp(-dot(place_[e].normal, wind_from_[k]), 0.0, 1.0);
    to.forced_h_w_m2_k[at] = request_.convection_factor *
                             std::lerp(mowitt_forced_w_m2_k(w.wind_m_s, WindSide::kWindward),
                                       mowitt_forced_w_m2_k(w.wind_m_s, WindSide::kLeeward), lee);
    if (to.vapour_pa.empty()) return;
    to.vapour_pa[at] = vapour_pressure_pa(w.humid->dew_point_k);
    to.inverse_gamma_k_pa[at] = inverse_gamma_k_pa(w.air_k, w.humid->pressure_pa);
    const SurfaceWater& water = *material_.wall.water;
    to.stomatal_w_m2_k[at] = water.canopy ? stomatal_w_m2_k(*water.canopy, std::max(0.0, sunlight),
                                                            w.air_k, w.humid->pressure_pa)
                                          : 0;
  }

  void inside(std::size_t k, bool after, const FaceExposure& to) const {
    const WallBuildUp& wall = material_.wall;
    const auto now = [&](double constant) {
      if (wall.inner_at.empty()) return constant;
      return after ? wall.inner_at[k].after : wall.inner_at[k].before;
    };
    if (wall.inner_side == InnerSide::kHeatFlux)
      std::ranges::fill(to.absorbed_w_m2, now(wall.inner_flux_w_m2));
    if (wall.inner_side == InnerSide::kAir) {
      std::ranges::fill(to.forced_h_w_m2_k, wall.inner_h_w_m2_k);
      std::ranges::fill(to.fluid_k, now(wall.inner_k));
    }
    if (wall.inner_side == InnerSide::kFixedTemperature)
      std::ranges::fill(to.fluid_k, now(wall.inner_k));
  }

  const LandHeatRequest& request_;
  const LandHeatMaterial& material_;
  std::vector<Place> place_;
  std::size_t every_;  // of the request's knots
  std::vector<double> sky_, around_k_;
  std::vector<Vec<Enu>> sun_, wind_from_;  // [knot of the request]
};

// Temperatures of the places of one material at every second knot of the request.
struct PlaceTemperatures {
  std::size_t places = 0;
  std::vector<double> kelvin, error_k;  // [second knot x places + place]
};

absl::StatusOr<HeatResult> solve(const LandExposure& exposure, double tolerance_k) {
  return solve_heat(exposure.heat_request(tolerance_k),
                    [&](std::size_t interval, std::span<const std::uint32_t> element,
                        const Exposure& to) { exposure.fill(interval, element, to); });
}

// Linear between every second knot, which alone are known.
std::vector<double> at_all_knots(const LandHeatRequest& request, const std::vector<double>& even) {
  std::vector<double> out(request.knot_s.size());
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (k % 2 == 0) {
      out[k] = even[k / 2];
      continue;
    }
    const double share = (request.knot_s[k] - request.knot_s[k - 1]) /
                         (request.knot_s[k + 1] - request.knot_s[k - 1]);
    out[k] = (1 - share) * even[k / 2] + share * even[k / 2 + 1];
  }
  return out;
}

absl::StatusOr<PlaceTemperatures> place_temperatures(const LandHeatRequest& request,
                                                     const LandHeatMaterial& material,
                                                     const std::vector<Place>& place) {
  // Level land under a free horizon, which the others see.
  static const LandHorizon kFree{};
  LandExposure level(request, material, {{{0, 0, 1}, &kFree}}, 1);
  ASSIGN_OR_RETURN(const HeatResult around, solve(level, request.tolerance_k));
  const std::vector<double> around_k = at_all_knots(request, around.temperature_k);
  LandExposure fine(request, material, place, 1), coarse(request, material, place, 2);
  fine.set_around_k(around_k);
  coarse.set_around_k(around_k);
  ASSIGN_OR_RETURN(const HeatResult all, solve(fine, request.tolerance_k));
  ASSIGN_OR_RETURN(const HeatResult half, solve(coarse, request.tolerance_k));
  PlaceTemperatures out{place.size(), all.temperature_k, all.error_k};
  // What the two differ by at most within the hour around a time, or in the root mean square of
  // three hours around it: at one time they may agree by luck.
  constexpr double kHoursAround = 3, kNearS = 3600;
  const std::size_t times = request.knot_s.size() / 2 + 1;
  for (std::size_t t = 0; t < times; ++t) {
    std::size_t first = t, last = t;
    const auto apart_s = [&](std::size_t other) {
      return std::abs(request.knot_s[2 * other] - request.knot_s[2 * t]);
    };
    while (first > 0 && apart_s(first - 1) <= 3600 * kHoursAround) --first;
    while (last + 1 < times && apart_s(last + 1) <= 3600 * kHoursAround) ++last;
    for (std::size_t p = 0; p < place.size(); ++p) {
      double square = 0, most = 0;
      for (std::size_t i = first; i <= last; ++i) {
        const double d =
            all.temperature_k[i * place.size() + p] - half.temperature_k[i * place.size() + p];
        square += d * d;
        if (apart_s(i) <= kNearS) most = std::max(most, std::abs(d));
      }
      const std::size_t at = t * place.size() + p;
      out.error_k[at] += std::max(most, std::sqrt(square / static_cast<double>(last - first + 1))) +
                         fine.edge_k(2 * t, static_cast<std::uint32_t>(p), all.temperature_k[at]);
    }
  }
  return out;
}

// Temperature of a mixture in a band where radiance goes with a power of it.
double mixed_k(const PlaceTemperatures& of, std::size_t time, std::span<const KindShare> mix,
               std::span<const std::size_t> place_of_kind, double power) {
  double sum = 0;
  for (const KindShare& part : mix)
    sum += static_cast<double>(part.share) *
           std::pow(of.kelvin[time * of.places + place_of_kind[part.kind]], power);
  return std::pow(sum, 1 / power);
}

absl::Status check(const LandKinds& kinds, const LandHeatRequest& request) {
  const auto wrong = [](const std::string& what) { return absl::InvalidArgumentError(what); };
  if (request.material.size() != kinds.materials || request.stated_k.size() != kinds.materials)
    return wrong("land: one material and one temperature for each material of the kinds");
  const std::size_t knots = request.knot_s.size();
  if (knots < 3 || knots % 2 == 0 || request.weather.size() != knots)
    return wrong("land: an odd number of knots, and weather at each");
  if (request.day_knots < 2 || request.day_knots % 2 != 0 || request.day_knots >= knots)
    return wrong("land: a day of an even number of intervals");
  for (const std::size_t k : request.output_knot)
    if (k % 2 != 0 || k >= knots) return wrong("land: output at even knots");
  for (std::size_t m = 0; m < kinds.materials; ++m) {
    if (!request.material[m]) continue;
    const LandHeatMaterial& material = *request.material[m];
    const std::string name = absl::StrCat("build_up \"", material.wall.name, "\": ");
    if (!kinds.computed[m]) return wrong(absl::StrCat(name, "its material has one kind"));
    if (material.wall.inner_side == InnerSide::kOpen)
      return wrong(absl::StrCat(name, "land has no open inside, expected another"));
    if (const absl::Status s = check_layers(material.wall.layers); !s.ok())
      return wrong(absl::StrCat(name, s.message()));
    if (!(material.solar_absorptance >= 0 && material.solar_absorptance <= 1) ||
        !(material.emissivity >= 0 && material.emissivity <= 1))
      return wrong(absl::StrCat(name, "absorptance and emissivity of 0 to 1"));
    if (!material.wall.inner_at.empty() && material.wall.inner_at.size() != knots)
      return wrong(absl::StrCat(name, "inside: one value for each knot"));
    if (!material.wall.water) continue;
    if (const absl::Status s = check_water(*material.wall.water); !s.ok())
      return wrong(absl::StrCat(name, s.message()));
    for (const HeatWeather& weather : request.weather)
      if (!weather.humid)
        return wrong(absl::StrCat(name, "latent heat needs the humidity of the weather"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<LandHeatResult> solve_land_heat(const LandKinds& kinds,
                                               const LandHeatRequest& request) {
  RETURN_IF_ERROR(check(kinds, request));
  const std::size_t outputs = request.output_knot.size();
  LandHeatResult out;
  out.kelvin.assign(outputs, std::vector<float>(kinds.kind.size(), 0));
  out.error_k = out.kelvin;
  out.interpolation_k.assign(
      outputs, std::vector<float>(kinds.materials, std::numeric_limits<float>::quiet_NaN()));
  for (std::uint32_t m = 0; m < kinds.materials; ++m) {
    std::vector<Place> place;
    std::vector<std::size_t> place_of_kind(kinds.kind.size());
    for (std::size_t k = 0; k < kinds.kind.size(); ++k) {
      if (kinds.kind[k].material != m) continue;
      place_of_kind[k] = place.size();
      place.push_back({kinds.kind[k].normal, &kinds.horizon[kinds.kind[k].horizon]});
      if (request.material[m]) continue;
      for (std::size_t o = 0; o < outputs; ++o)
        out.kelvin[o][k] = static_cast<float>(request.stated_k[m]);
    }
    if (!request.material[m]) continue;
    const std::size_t first_held_out = place.size();
    std::vector<const HeldOutPlace*> held_out;
    for (const HeldOutPlace& at : kinds.held_out) {
      if (at.material != m) continue;
      held_out.push_back(&at);
      place.push_back({at.normal, &at.horizon});
    }
    auto solved = place_temperatures(request, *request.material[m], place);
    if (!solved.ok())
      return absl::Status(solved.status().code(),
                          absl::StrCat("build_up \"", request.material[m]->wall.name,
                                       "\": ", solved.status().message()));
    for (std::size_t o = 0; o < outputs; ++o) {
      const std::size_t time = request.output_knot[o] / 2;
      // Radiance in 3-5 and 8-12 um goes with about these powers of the temperature.
      double square[2] = {0, 0}, count[2] = {0, 0};
      for (std::size_t i = 0; i < held_out.size(); ++i) {
        const double own_k = solved->kelvin[time * solved->places + first_held_out + i];
        double off_k = 0;
        for (const double power : {12.0, 5.0})
          off_k = std::max(
              off_k,
              std::abs(mixed_k(*solved, time, held_out[i]->mix, place_of_kind, power) - own_k));
        square[held_out[i]->object] += off_k * off_k;
        count[held_out[i]->object] += 1;
      }
      const auto rms_k = [&](bool object) {
        return count[object] > 0 ? std::sqrt(square[object] / count[object]) : 0.0;
      };
      if (count[0] + count[1] > 0)
        out.interpolation_k[o][m] =
            static_cast<float>(std::sqrt((square[0] + square[1]) / (count[0] + count[1])));
      for (std::size_t k = 0; k < kinds.kind.size(); ++k) {
        if (kinds.kind[k].material != m) continue;
        const std::size_t at = time * solved->places + place_of_kind[k];
        out.kelvin[o][k] = static_cast<float>(solved->kelvin[at]);
        out.error_k[o][k] = static_cast<float>(solved->error_k[at] + rms_k(kinds.kind[k].object));
      }
    }
  }
  return out;
}

}  // namespace irsig
