#include "core/thermal/land/land_heat.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
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

// Number of places that share their knots: the solver computes as many side by side.
constexpr std::size_t kPlacesTogether = 32;

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

// A time between two knots: a share of the way from the first of them.
struct Instant {
  std::size_t knot;  // of the request
  double share;      // [0, 1)
};

// Light and heat that some places of one material receive. It has the knots of the request, and
// knots where an edge of a shadow begins and ends to cross the sun's disk.
class LandExposure {
 public:
  // every: of the request's knots
  LandExposure(const LandHeatRequest& request, const LandHeatMaterial& material,
               std::span<const Place> place, std::size_t every)
      : request_(request), material_(material), place_(place), every_(every) {
    for (const Place& at : place_) sky_.push_back(sky_fraction(at));
    for (const HeatWeather& w : request.weather) {
      sun_.push_back(enu_from_body(w.sun, request.heading_deg));
      wind_from_.push_back(enu_from_body(w.wind_from, request.heading_deg));
    }
    for (std::size_t k = 0; k + every < request.knot_s.size(); k += every) add_interval(k);
    own_knot_.push_back(instant_.size());
    instant_.push_back({request.knot_s.size() - 1, 0});
    find_direct_light();
  }

  // [request knot] Of level land around; empty: a level place has none.
  void set_around_k(std::span<const double> kelvin) { around_k_ = kelvin; }

  [[nodiscard]] HeatRequest heat_request(double tolerance_k) const {
    HeatRequest out;
    const WallBuildUp& wall = material_.wall;
    out.layers = wall.layers;
    out.inner_side = wall.inner_side;
    double mean_k = 0;
    for (const Instant& at : instant_) {
      const HeatWeather& w = request_.weather[at.knot];
      out.knot_s.push_back(time_s(at));
      out.smooth.push_back(at.share > 0 ||
                           (w.before.direct_normal_w_m2 == w.after.direct_normal_w_m2 &&
                            w.before.diffuse_horizontal_w_m2 == w.after.diffuse_horizontal_w_m2 &&
                            w.before.sky_w_m2 == w.after.sky_w_m2 && !wall.jumps_at(at.knot)));
      mean_k += w.air_k / static_cast<double>(instant_.size());
    }
    for (std::size_t k = 0; k < request_.knot_s.size(); k += 2)
      out.output_knot.push_back(own_knot_[k / every_]);
    for (const Place& at : place_) {
      Convection air = tarp_natural(at.normal.z);
      air.natural_warm *= request_.convection_factor;
      air.natural_cold *= request_.convection_factor;
      air.mixing = 0;  // as walls of a target have it
      FaceProperties& face = out.outer.emplace_back(FaceProperties{material_.emissivity, air});
      if (wall.water) face.evaporation = evaporation_of(*wall.water);
    }
    constexpr int kMostDays = 200;
    out.start =
        PeriodicStart{mean_k, own_knot_[request_.day_knots / every_], tolerance_k, kMostDays, {}};
    out.output_boundary = {0};
    out.accuracy.tolerance_k = tolerance_k;
    out.accuracy.max_level = kMostHalvings;
    return out;
  }

  void fill(std::size_t interval, std::span<const std::uint32_t> element,
            const Exposure& to) const {
    const Instant begin = instant_[interval], end = instant_[interval + 1];
    const Weather first = weather_at(begin.knot, begin.share),
                  last = weather_at(begin.knot, end.share > 0 ? end.share : 1);
    for (std::size_t at = 0; at < element.size(); ++at) {
      const std::uint32_t e = element[at];
      const DirectLight& direct = direct_[interval * place_.size() + e];
      face(first, e, direct.begin_w_m2, at, to.outer_begin);
      face(last, e, direct.end_w_m2, at, to.outer_end);
    }
    inside(begin.knot, begin.share, to.inner_begin);
    inside(begin.knot, end.share > 0 ? end.share : 1, to.inner_end);
  }

 private:
  // Returns the exposure at one instant, seen from one side of it.
  struct Weather {
    HeatRadiation light;
    double air_k, wind_m_s, on_level_w_m2, around_k;  // around_k: 0, there is none
    Vec<Enu> wind_from;
    double vapour_pa = 0, inverse_gamma_k_pa = 0, pressure_pa = 0;
  };
  struct DirectLight {
    double begin_w_m2, end_w_m2;  // of an interval
  };

  [[nodiscard]] double time_s(Instant at) const {
    if (at.share == 0) return request_.knot_s[at.knot];
    return std::lerp(request_.knot_s[at.knot], request_.knot_s[at.knot + every_], at.share);
  }
  [[nodiscard]] Vec<Enu> sun_at(std::size_t knot, double share) const {
    if (share == 0) return sun_[knot];
    return normalized((1 - share) * sun_[knot] + share * sun_[knot + every_]);
  }
  // Linear between two knots: just behind the first, just before the last.
  [[nodiscard]] Weather weather_at(std::size_t knot, double share) const {
    const HeatWeather &a = request_.weather[knot], &b = request_.weather[knot + every_];
    const auto between = [share](double first, double last) {
      return std::lerp(first, last, share);
    };
    Weather out{};
    out.light.direct_normal_w_m2 = between(a.after.direct_normal_w_m2, b.before.direct_normal_w_m2);
    out.light.diffuse_horizontal_w_m2 =
        between(a.after.diffuse_horizontal_w_m2, b.before.diffuse_horizontal_w_m2);
    out.light.sky_w_m2 = between(a.after.sky_w_m2, b.before.sky_w_m2);
    out.air_k = between(a.air_k, b.air_k);
    out.wind_m_s = between(a.wind_m_s, b.wind_m_s);
    out.wind_from = (1 - share) * wind_from_[knot] + share * wind_from_[knot + every_];
    out.on_level_w_m2 = out.light.direct_normal_w_m2 * std::max(0.0, sun_at(knot, share).z) +
                        out.light.diffuse_horizontal_w_m2;
    if (!around_k_.empty()) out.around_k = between(around_k_[knot], around_k_[knot + every_]);
    if (!a.humid || !b.humid) return out;
    const auto vapour = [](const HeatWeather& w) {
      return vapour_pressure_pa(w.humid->dew_point_k);
    };
    const auto inverse_gamma = [](const HeatWeather& w) {
      return inverse_gamma_k_pa(w.air_k, w.humid->pressure_pa);
    };
    out.vapour_pa = between(vapour(a), vapour(b));
    out.inverse_gamma_k_pa = between(inverse_gamma(a), inverse_gamma(b));
    out.pressure_pa = between(a.humid->pressure_pa, b.humid->pressure_pa);
    return out;
  }

  // Share of the sun's disk that a place sees.
  [[nodiscard]] static double seen_of_sun(const Place& at, Vec<Enu> sun, double radius_rad) {
    return at.horizon->seen_of_disk(std::atan2(sun.x, sun.y),
                                    std::asin(std::clamp(sun.z, -1.0, 1.0)), radius_rad);
  }

  // Appends the knot and the edges of shade behind it, up to the next one.
  void add_interval(std::size_t knot) {
    own_knot_.push_back(instant_.size());
    instant_.push_back({knot, 0});
    if (request_.weather[knot].after.direct_normal_w_m2 <= 0 &&
        request_.weather[knot + every_].before.direct_normal_w_m2 <= 0)
      return;
    std::vector<double> edge;  // shares of the interval
    const Place* before = nullptr;
    for (const Place& at : place_) {
      if (before == nullptr || before->horizon != at.horizon) add_edges(knot, at, edge);
      before = &at;
    }
    std::ranges::sort(edge);
    const double length_s = request_.knot_s[knot + every_] - request_.knot_s[knot],
                 apart = kApartS / length_s;
    double last = 0;
    for (const double t : edge) {
      const double share = std::min(std::max(t, last + apart), 1 - apart);
      if (share < last + 0.2 * apart) continue;
      instant_.push_back({knot, share});
      last = share;
    }
  }
  // Instants at which the sun begins and ceases to be seen in part. What lasts less than a
  // sixteenth of the interval may be missed.
  void add_edges(std::size_t knot, const Place& at, std::vector<double>& edge) const {
    constexpr int kInstants = 16, kHalvings = 10;
    const double radius_rad = request_.weather[knot].sun_radius_rad;
    enum class Seen : std::uint8_t { kNothing, kPart, kAll };
    const auto seen = [&](double share) {
      const double part = seen_of_sun(at, sun_at(knot, share), radius_rad);
      if (part <= 0) return Seen::kNothing;
      return part >= 1 ? Seen::kAll : Seen::kPart;
    };
    // Returns the time at which the sun ceases to be seen as at `inside`, on the way to `outside`.
    const auto end_of = [&](double inside, double outside) {
      const Seen is = seen(inside);
      for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (inside + outside);
        (seen(middle) == is ? inside : outside) = middle;
      }
      return inside;
    };
    Seen before = seen(0);
    for (int i = 1; i <= kInstants; ++i) {
      const double first = (i - 1.0) / kInstants, last = static_cast<double>(i) / kInstants;
      const Seen now = seen(last);
      if (now != before && before != Seen::kPart) edge.push_back(end_of(first, last));
      if (now != before && now != Seen::kPart) edge.push_back(end_of(last, first));
      before = now;
    }
  }
  void find_direct_light() {
    for (std::size_t i = 0; i + 1 < instant_.size(); ++i) {
      const std::size_t knot = instant_[i].knot;
      const auto light = [&](const Place& at, double share) {
        const double normal_w_m2 =
            std::lerp(request_.weather[knot].after.direct_normal_w_m2,
                      request_.weather[knot + every_].before.direct_normal_w_m2, share);
        const Vec<Enu> sun = sun_at(knot, share);
        const double cosine = dot(at.normal, sun);
        if (normal_w_m2 <= 0 || cosine <= 0) return 0.0;
        return normal_w_m2 * cosine * seen_of_sun(at, sun, request_.weather[knot].sun_radius_rad);
      };
      const double begin = instant_[i].share,
                   end = instant_[i + 1].share > 0 ? instant_[i + 1].share : 1;
      for (const Place& at : place_) direct_.push_back({light(at, begin), light(at, end)});
    }
  }

  void face(const Weather& w, std::uint32_t e, double direct_w_m2, std::size_t at,
            const FaceExposure& to) const {
    const double sky = sky_[e], land = 1 - sky, reflects = 1 - material_.solar_absorptance,
                 sunlight = direct_w_m2 + sky * w.light.diffuse_horizontal_w_m2 +
                            land * reflects * w.on_level_w_m2;
    to.absorbed_w_m2[at] = material_.solar_absorptance * sunlight;
    const double e_ir = material_.emissivity,
                 around = w.around_k > 0 ? e_ir * kStefanBoltzmannWM2K4 * power4(w.around_k) +
                                               (1 - e_ir) * w.light.sky_w_m2
                                         : w.light.sky_w_m2;
    to.incoming_w_m2[at] = sky * w.light.sky_w_m2 + land * around;
    to.fluid_k[at] = w.air_k;
    // Level land is windward, a wall in the lee leeward; slopes lie between, without a jump.
    const double lee = std::clamp(-dot(place_[e].normal, w.wind_from), 0.0, 1.0);
    to.forced_h_w_m2_k[at] = request_.convection_factor *
                             std::lerp(mowitt_forced_w_m2_k(w.wind_m_s, WindSide::kWindward),
                                       mowitt_forced_w_m2_k(w.wind_m_s, WindSide::kLeeward), lee);
    if (to.vapour_pa.empty()) return;
    to.vapour_pa[at] = w.vapour_pa;
    to.inverse_gamma_k_pa[at] = w.inverse_gamma_k_pa;
    const SurfaceWater& water = *material_.wall.water;
    to.stomatal_w_m2_k[at] = water.canopy ? stomatal_w_m2_k(*water.canopy, std::max(0.0, sunlight),
                                                            w.air_k, w.pressure_pa)
                                          : 0;
  }

  void inside(std::size_t knot, double share, const FaceExposure& to) const {
    const WallBuildUp& wall = material_.wall;
    const auto now = [&](double constant) {
      if (wall.inner_at.empty()) return constant;
      return std::lerp(wall.inner_at[knot].after, wall.inner_at[knot + every_].before, share);
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

  static constexpr double kApartS = 4;  // between own knots
  // The temperature just behind an edge of shade would need more, at four times the cost each; what
  // is left of its error there is below what kinds differ by from the places they stand for.
  static constexpr int kMostHalvings = 3;

  const LandHeatRequest& request_;
  const LandHeatMaterial& material_;
  std::span<const Place> place_;
  std::size_t every_;        // of the request's knots
  std::vector<double> sky_;  // [place]
  std::span<const double> around_k_;
  std::vector<Vec<Enu>> sun_, wind_from_;  // [knot of the request]
  std::vector<Instant> instant_;           // [own knot]
  std::vector<std::size_t> own_knot_;      // [request knot / every_]
  std::vector<DirectLight> direct_;        // [own interval x places + place]
};

// Temperatures of the places of one material at every second knot of the request.
struct PlaceTemperatures {
  std::size_t places = 0;
  std::vector<double> kelvin, error_k;  // [second knot x places + place]
};

// [second knot of the request x places + place] Solves groups of places: each group has the knots
// of all edges of shade that pass its places.
absl::StatusOr<PlaceTemperatures> solve(const LandHeatRequest& request,
                                        const LandHeatMaterial& material,
                                        std::span<const Place> place, std::size_t every,
                                        std::span<const double> around_k) {
  const std::size_t times = request.knot_s.size() / 2 + 1;
  PlaceTemperatures out{place.size(), std::vector<double>(times * place.size()), {}};
  out.error_k = out.kelvin;
  for (std::size_t first = 0; first < place.size();) {
    const std::size_t last = std::min(first + kPlacesTogether, place.size());
    LandExposure exposure(request, material, place.subspan(first, last - first), every);
    exposure.set_around_k(around_k);
    ASSIGN_OR_RETURN(const HeatResult part,
                     solve_heat(exposure.heat_request(request.tolerance_k),
                                [&](std::size_t interval, std::span<const std::uint32_t> element,
                                    const Exposure& to) { exposure.fill(interval, element, to); }));
    for (std::size_t t = 0; t < times; ++t)
      for (std::size_t p = first; p < last; ++p) {
        out.kelvin[t * place.size() + p] = part.temperature_k[part.at(t, 0, p - first)];
        out.error_k[t * place.size() + p] = part.error_k[part.at(t, 0, p - first)];
      }
    first = last;
  }
  return out;
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
  const Place level{{0, 0, 1}, &kFree};
  ASSIGN_OR_RETURN(const PlaceTemperatures around,
                   solve(request, material, std::span(&level, 1), 1, {}));
  const std::vector<double> around_k = at_all_knots(request, around.kelvin);
  ASSIGN_OR_RETURN(PlaceTemperatures out, solve(request, material, place, 1, around_k));
  ASSIGN_OR_RETURN(const PlaceTemperatures half, solve(request, material, place, 2, around_k));
  // The error is the largest difference of the two within the hour around a time, or its root mean
  // square over three hours around it: at one time they may agree by luck.
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
        const double d = out.kelvin[i * place.size() + p] - half.kelvin[i * place.size() + p];
        square += d * d;
        if (apart_s(i) <= kNearS) most = std::max(most, std::abs(d));
      }
      out.error_k[t * place.size() + p] +=
          std::max(most, std::sqrt(square / static_cast<double>(last - first + 1)));
    }
  }
  return out;
}

// The places of a material's kinds, and the index of each of these kinds.
struct KindPlaces {
  std::vector<Place> place;
  std::vector<std::size_t> kind;
};
KindPlaces places_of(const LandKinds& kinds, std::uint32_t material) {
  KindPlaces out;
  for (std::size_t k = 0; k < kinds.kind.size(); ++k) {
    if (kinds.kind[k].material != material) continue;
    out.place.push_back({kinds.kind[k].normal, &kinds.horizon[kinds.kind[k].horizon]});
    out.kind.push_back(k);
  }
  return out;
}

// [second knot x places + place] From every second knot alone, with a finer tolerance: what is left
// is to be small against what one input changes.
absl::StatusOr<PlaceTemperatures> coarse_temperatures(LandHeatRequest request,
                                                      const LandHeatMaterial& material,
                                                      const std::vector<Place>& place) {
  constexpr double kFiner = 0.2;
  request.tolerance_k *= kFiner;
  static const LandHorizon kFree{};
  const Place level{{0, 0, 1}, &kFree};
  ASSIGN_OR_RETURN(const PlaceTemperatures around,
                   solve(request, material, std::span(&level, 1), 2, {}));
  return solve(request, material, place, 2, at_all_knots(request, around.kelvin));
}

// Root mean square of the difference of two temperatures of a place over the 24 h around a time;
// at the ends of the course over the first or the last 24 h.
double day_rms_k(const LandHeatRequest& request, const PlaceTemperatures& a,
                 const PlaceTemperatures& b, std::size_t time, std::size_t place) {
  constexpr double kHalfDayS = 43200;
  const double first_s = request.knot_s.front() + kHalfDayS,
               last_s = std::max(request.knot_s.back() - kHalfDayS, first_s),
               middle_s = std::clamp(request.knot_s[2 * time], first_s, last_s);
  double square = 0, count = 0;
  for (std::size_t t = 0; 2 * t < request.knot_s.size(); ++t) {
    if (std::abs(request.knot_s[2 * t] - middle_s) > kHalfDayS) continue;
    const double d = a.kelvin[t * a.places + place] - b.kelvin[t * b.places + place];
    square += d * d;
    count += 1;
  }
  return std::sqrt(square / count);
}

absl::Status of_build_up(const LandHeatMaterial& material, const absl::Status& status) {
  return {status.code(), absl::StrCat("build_up \"", material.wall.name, "\": ", status.message())};
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
    if (!solved.ok()) return of_build_up(*request.material[m], solved.status());
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

absl::StatusOr<LandHeatChanges> solve_land_heat_changes(const LandKinds& kinds,
                                                        const LandHeatRequest& request,
                                                        std::span<const LandHeatRequest> moved) {
  RETURN_IF_ERROR(check(kinds, request));
  for (const LandHeatRequest& each : moved) {
    RETURN_IF_ERROR(check(kinds, each));
    if (each.knot_s != request.knot_s || each.output_knot != request.output_knot)
      return absl::InvalidArgumentError("a moved input has other knots than the temperatures");
    for (std::size_t m = 0; m < kinds.materials; ++m)
      if (each.material[m].has_value() != request.material[m].has_value())
        return absl::InvalidArgumentError("a moved input has other computed land");
  }
  const std::vector<std::vector<float>> zero(request.output_knot.size(),
                                             std::vector<float>(kinds.kind.size(), 0));
  LandHeatChanges out{zero, std::vector<LandTemperatureChange>(moved.size(), {zero, zero})};
  for (std::size_t k = 0; k < kinds.kind.size(); ++k)
    for (std::vector<float>& row : out.kelvin)
      row[k] = static_cast<float>(request.stated_k[kinds.kind[k].material]);
  for (std::uint32_t m = 0; m < kinds.materials; ++m) {
    if (!request.material[m]) continue;
    const KindPlaces of = places_of(kinds, m);
    auto base = coarse_temperatures(request, *request.material[m], of.place);
    if (!base.ok()) return of_build_up(*request.material[m], base.status());
    for (std::size_t o = 0; o < request.output_knot.size(); ++o)
      for (std::size_t p = 0; p < of.place.size(); ++p)
        out.kelvin[o][of.kind[p]] =
            static_cast<float>(base->kelvin[request.output_knot[o] / 2 * of.place.size() + p]);
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const LandHeatMaterial& material = *moved[i].material[m];
      auto changed = coarse_temperatures(moved[i], material, of.place);
      if (!changed.ok()) return of_build_up(material, changed.status());
      for (std::size_t o = 0; o < request.output_knot.size(); ++o) {
        const std::size_t time = request.output_knot[o] / 2;
        for (std::size_t p = 0; p < of.place.size(); ++p) {
          const std::size_t at = time * of.place.size() + p;
          double change_k = changed->kelvin[at] - base->kelvin[at];
          out.moved[i].difference_k[o][of.kind[p]] = static_cast<float>(change_k);
          if (moved[i].of_model)
            change_k = std::copysign(
                std::max(std::abs(change_k), day_rms_k(request, *changed, *base, time, p)),
                change_k);
          out.moved[i].change_k[o][of.kind[p]] = static_cast<float>(change_k);
        }
      }
    }
  }
  return out;
}

}  // namespace irsig
