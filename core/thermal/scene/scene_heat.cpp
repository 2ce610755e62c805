#include "core/thermal/scene/scene_heat.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/thermal/scene/exchange_factors.h"
#include "core/thermal/scene/sun_visibility.h"

namespace irsig {
namespace {

constexpr int kMostRounds = 60;
constexpr double kSlowest = 0.999;  // changes may fall by, from round to round
constexpr int kMostDays = 60;       // that are repeated until one returns to where it began
constexpr int kMostLevels = 3;  // of conduction (HeatAccuracy): one more takes four times as long

// Natural convection of water at large faces, Nu = 0.13 Ra^(1/3) at 15 deg C: expansion 1.5e-4 / K,
// viscosity 1.19e-6, diffusivity 1.4e-7 m2/s, 0.6 W/(m K).
constexpr Convection kStillWater{160, 160, 1};

double power4(double t) { return t * t * t * t; }

// Of a wall from its outer face, as deep as heat diffuses in a time; an insulation ends it.
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

// Of one computation.
struct Knots {
  std::vector<std::size_t> of_request;
  std::size_t day_intervals;
  std::uint32_t rays, sun_points;
  std::uint64_t seed;
};

// All faces under all knots, [knot x faces + face].
class Computation {
 public:
  Computation(const Target& target, const ThermalFaces& faces, const SceneHeatRequest& request,
              Knots knots)
      : target_(target), faces_(faces), request_(request), knots_(std::move(knots)) {
    for (std::uint32_t face = 0; face < faces_.size(); ++face) {
      // What stands on the surface is covered from below; what lies on it, like a road, is not.
      const double below_m = faces_.centroid_z_m[face] - request_.beneath.surface_z_m;
      const bool under = below_m > touching_m() ||
                         (below_m > -touching_m() && normal_of(target_, faces_, face).z > 0.5f);
      covered_.push_back(under);
      const HeatPart& part = part_of(face);
      // Under a surface nothing shines; ground there is as warm as the ground.
      emissivity_.push_back(under && request_.beneath.water ? 0.0 : part.emissivity);
    }
    for (std::size_t k = 0; k < count(); ++k) {
      knot_s_.push_back(request_.knot_s[knot(k)]);
      windward_w_m2_k_.push_back(mowitt_forced_w_m2_k(weather(k).wind_m_s, WindSide::kWindward));
      leeward_w_m2_k_.push_back(mowitt_forced_w_m2_k(weather(k).wind_m_s, WindSide::kLeeward));
    }
  }

  absl::Status solve() {
    factors_ = exchange_factors(target_, faces_,
                                {.rays = knots_.rays,
                                 .seed = knots_.seed,
                                 .surface_z_m = request_.beneath.surface_z_m + touching_m()});
    light();
    kelvin_.resize(count() * faces_.size());
    error_k_.assign(count() * faces_.size(), 0.0f);
    incoming_.resize(count() * faces_.size());
    for (std::size_t k = 0; k < count(); ++k)
      for (std::uint32_t i = 0; i < faces_.size(); ++i)
        kelvin_[k * faces_.size() + i] =
            static_cast<float>(part_of(i).build_up ? weather(k).air_k : part_of(i).stated_k);
    if (factors_.to.empty()) {
      rounds_ = 1;
      exchange();
      return conduct(kMostLevels).status();
    }
    // Until the exchange is settled, once over all is enough. Changes fall by the same factor from
    // round to round, which takes three to be seen.
    double before_k = INFINITY, falls = 1;
    for (rounds_ = 1; rounds_ < kMostRounds; ++rounds_) {
      exchange();
      const auto change_k = conduct(0);
      if (!change_k.ok()) return change_k.status();
      falls = std::min(*change_k / before_k, kSlowest);
      left_k_ = *change_k * falls / (1 - falls);
      before_k = *change_k;
      if (rounds_ >= 3 && left_k_ <= 0.5 * request_.exchange_tolerance_k) break;
    }
    exchange();
    const auto change_k = conduct(kMostLevels);
    if (!change_k.ok()) return change_k.status();
    // What finer steps have changed goes round, too.
    left_k_ = std::max(left_k_, *change_k * falls / (1 - falls));
    return absl::OkStatus();
  }

  [[nodiscard]] float kelvin(std::size_t k, std::uint32_t face) const {
    return kelvin_[k * faces_.size() + face];
  }
  [[nodiscard]] float error_k(std::size_t k, std::uint32_t face) const {
    return error_k_[k * faces_.size() + face];
  }
  [[nodiscard]] const HeatPart& part_of(std::uint32_t face) const {
    return request_.part[target_.facet[faces_.facet[face]].part];
  }
  // How much places of a facet differ from its temperature because the sun does not reach all of
  // them, root mean square, at every knot: what their sunlight differs by warms as much of the wall
  // as an hour reaches, or as a day does, whichever says more, against convection and radiation of
  // its face alone. An estimate from above. [knot]
  [[nodiscard]] std::vector<double> uneven_k(std::uint32_t facet) const {
    std::vector<double> out(count(), 0.0);
    const std::uint32_t back = faces_.back_of_facet[facet];
    const auto heat_w_m2 = [&](std::size_t k) {
      const auto of = [&](std::uint32_t face) {
        return static_cast<double>(uneven_[k * faces_.size() + face]);
      };
      return std::max(weather(k).before.direct_normal_w_m2, weather(k).after.direct_normal_w_m2) *
             (of(facet) + (back == ThermalFaces::kNone ? 0 : of(back)));
    };
    bool any = false;
    for (std::size_t k = 0; k < count(); ++k) any |= heat_w_m2(k) > 0;
    if (!any) return out;
    const WallBuildUp& wall = request_.build_up[*part_of(facet).build_up];
    for (const double reach_s : {3600.0, 86400.0}) {
      const double stored_j_m2_k = heat_capacity_reached(wall.layers, reach_s);
      double now_k = 0;
      const auto go_on = [&](std::size_t k) {
        const double t = static_cast<double>(kelvin(k, facet)),
                     loss_w_m2_k = std::max(
                         1.0, std::min(windward_w_m2_k_[k], leeward_w_m2_k_[k]) +
                                  4 * emissivity_[facet] * kStefanBoltzmannWM2K4 * t * t * t);
        const double fades = std::exp(-(knot_s_[k] - knot_s_[k - 1]) * loss_w_m2_k / stored_j_m2_k);
        now_k =
            fades * now_k + (1 - fades) * std::max(heat_w_m2(k), heat_w_m2(k - 1)) / loss_w_m2_k;
      };
      // A day that has repeated for ever, by its second time.
      for (std::size_t k = 1; k <= knots_.day_intervals; ++k) go_on(k);
      out[0] = std::max(out[0], now_k);
      for (std::size_t k = 1; k < count(); ++k) {
        go_on(k);
        out[k] = std::max(out[k], now_k);
      }
    }
    return out;
  }
  [[nodiscard]] int rounds() const { return rounds_; }
  [[nodiscard]] double left_k() const { return left_k_; }
  [[nodiscard]] double closure_w_m2() const { return closure_w_m2_; }

 private:
  [[nodiscard]] std::size_t count() const { return knots_.of_request.size(); }
  // Coordinates are known to a part of the target's size.
  [[nodiscard]] double touching_m() const { return 1e-5 * target_.radius_m; }
  [[nodiscard]] std::size_t knot(std::size_t k) const { return knots_.of_request[k]; }
  [[nodiscard]] const HeatWeather& weather(std::size_t k) const {
    return request_.weather[knot(k)];
  }

  // Sunlight absorbed per direct normal irradiance at every knot, and per diffuse horizontal one at
  // any; what faces reflect to each other included.
  void light() {
    const std::size_t faces = faces_.size();
    direct_.assign(count() * faces, 0.0f);
    uneven_.assign(count() * faces, 0.0f);
    std::vector<float> lit(faces);
    std::vector<double> own(faces), total(faces), kept(faces);
    for (std::uint32_t i = 0; i < faces; ++i) kept[i] = part_of(i).solar_absorptance;
    const auto from_below = [&](std::size_t i) {
      return request_.beneath.solar_albedo * static_cast<double>(factors_.lower[i]);
    };
    const auto gathered = [&](const auto& store) {
      total = own;
      gather(own, kept, {}, 1e-6, total);
      for (std::size_t i = 0; i < faces; ++i) store(i, static_cast<float>(kept[i] * total[i]));
    };
    // What is not exposed is not lit.
    const auto of_exposed = [&](std::size_t i) {
      return factors_.exposed[i] > 0
                 ? static_cast<double>(std::min(lit[i] / factors_.exposed[i], 1.0f))
                 : 0.0;
    };
    for (std::size_t i = 0; i < faces; ++i)
      own[i] = covered_[i] ? 0 : static_cast<double>(factors_.sky[i]) + from_below(i);
    diffuse_.resize(faces);
    gathered([&](std::size_t i, float value) { diffuse_[i] = value; });
    for (std::size_t k = 0; k < count(); ++k) {
      const HeatWeather& w = weather(k);
      if (w.sun.z >= 0 || std::max(w.before.direct_normal_w_m2, w.after.direct_normal_w_m2) <= 0)
        continue;
      sun_visibility(target_, faces_, {w.sun, w.sun_radius_rad},
                     {.points = knots_.sun_points,
                      .seed = mix(knots_.seed, knot(k)),
                      .surface_z_m = request_.beneath.surface_z_m + touching_m()},
                     lit);
      for (std::size_t i = 0; i < faces; ++i) {
        own[i] = covered_[i] ? 0 : of_exposed(i) - w.sun.z * from_below(i);
        if (lit[i] > 0 && !covered_[i])
          uneven_[k * faces + i] = static_cast<float>(
              kept[i] *
              root_of_parts(of_exposed(i), cosine_to(w.sun, static_cast<std::uint32_t>(i))));
      }
      gathered([&](std::size_t i, float value) { direct_[k * faces + i] = value; });
    }
  }

  [[nodiscard]] double cosine_to(Vec<Body> direction, std::uint32_t face) const {
    const FaceNormal n = normal_of(target_, faces_, face);
    return static_cast<double>(n.x) * direction.x + static_cast<double>(n.y) * direction.y +
           static_cast<double>(n.z) * direction.z;
  }
  // Of a face of which some places have all and the others nothing.
  static double root_of_parts(double mean, double all) {
    return std::sqrt(std::max(0.0, mean * (all - mean)));
  }

  // Long-wave irradiance of every face at every knot, from the temperatures of the last round.
  void exchange() {
    std::vector<double> own(faces_.size()), total(faces_.size()), emitted(faces_.size());
    const Beneath& b = request_.beneath;
    for (std::size_t k = 0; k < count(); ++k) {
      const double sky = 0.5 * (weather(k).before.sky_w_m2 + weather(k).after.sky_w_m2),
                   ground = kStefanBoltzmannWM2K4 * power4(b.temperature_k),
                   below = b.emissivity * ground + (1 - b.emissivity) * sky;
      for (std::size_t i = 0; i < faces_.size(); ++i) {
        own[i] = covered_[i] ? (b.water ? 0 : ground)
                             : static_cast<double>(factors_.sky[i]) * sky +
                                   static_cast<double>(factors_.lower[i]) * below;
        emitted[i] = emissivity_[i] * kStefanBoltzmannWM2K4 *
                     power4(static_cast<double>(kelvin_[k * faces_.size() + i]));
      }
      if (k == 0) total = own;
      gather(own, emissivity_, emitted, 1e-4, total);
      for (std::size_t i = 0; i < faces_.size(); ++i)
        incoming_[k * faces_.size() + i] = static_cast<float>(total[i]);
    }
  }

  // total_i = own_i + sum_j F_ij (emitted_j + (1 - kept_j) total_j), by Gauss and Seidel from what
  // `total` has. What is absorbed somewhere is a part of what others send: it converges.
  void gather(const std::vector<double>& own, const std::vector<double>& kept,
              const std::vector<double>& emitted, double tolerance,
              std::vector<double>& total) const {
    if (factors_.to.empty()) {
      total = own;
      return;
    }
    for (int round = 0; round < 2000; ++round) {
      double change = 0;
      for (std::size_t i = 0; i < faces_.size(); ++i) {
        if (covered_[i]) {
          total[i] = own[i];
          continue;
        }
        double sum = own[i];
        for (std::size_t e = factors_.first[i]; e < factors_.first[i + 1]; ++e) {
          const std::uint32_t j = factors_.to[e];
          sum += static_cast<double>(factors_.share[e]) *
                 ((emitted.empty() ? 0 : emitted[j]) + (1 - kept[j]) * total[j]);
        }
        change = std::max(change, std::abs(sum - total[i]));
        total[i] = sum;
      }
      if (change < tolerance) return;
    }
  }

  // The walls of each build-up; the largest change of a temperature.
  absl::StatusOr<double> conduct(int levels) {
    double change_k = 0;
    for (std::uint32_t b = 0; b < request_.build_up.size(); ++b) {
      std::vector<std::uint32_t> wall;  // front faces
      for (std::uint32_t i = 0; i < faces_.fronts; ++i)
        if (part_of(i).build_up == b && faces_.area_m2[i] > 0) wall.push_back(i);
      if (wall.empty()) continue;
      const auto changed = conduct(b, wall, levels);
      if (!changed.ok())
        return absl::Status(changed.status().code(),
                            absl::StrCat("build_up \"", request_.build_up[b].name,
                                         "\": ", changed.status().message()));
      change_k = std::max(change_k, *changed);
    }
    return change_k;
  }

  [[nodiscard]] FaceProperties properties(std::uint32_t face) const {
    if (covered_[face])
      return {emissivity_[face], request_.beneath.water ? kStillWater : kForcedOnly};
    Convection air =
        tarp_natural(-static_cast<double>(normal_of(target_, faces_, face).z));  // z is down
    air.mixing = 0;  // with forced parts by MoWiTT: root of the sum of squares, as in DOE-2
    return {emissivity_[face], air};
  }

  // At the begin of the interval after a knot, or at the end of the one before.
  enum class Side { kAfter, kBefore };
  void expose(std::size_t k, Side side, std::uint32_t face, const FaceExposure& to,
              std::size_t at) const {
    const HeatRadiation& light = side == Side::kAfter ? weather(k).after : weather(k).before;
    to.absorbed_w_m2[at] =
        light.direct_normal_w_m2 * static_cast<double>(direct_[k * faces_.size() + face]) +
        light.diffuse_horizontal_w_m2 * static_cast<double>(diffuse_[face]);
    to.incoming_w_m2[at] = static_cast<double>(incoming_[k * faces_.size() + face]);
    if (covered_[face]) {
      const Beneath& b = request_.beneath;
      to.fluid_k[at] = b.temperature_k;
      to.forced_h_w_m2_k[at] = b.water ? plate_in_flow_w_m2_k(sea_water(b.temperature_k),
                                                              b.flow_m_s, 2 * target_.radius_m)
                                       : 0;
      return;
    }
    const HeatWeather& w = weather(k);
    to.fluid_k[at] = w.air_k;
    const FaceNormal n = normal_of(target_, faces_, face);
    const double towards =
        static_cast<double>(n.x) * w.wind_from.x + static_cast<double>(n.y) * w.wind_from.y;
    to.forced_h_w_m2_k[at] = towards > -1e-6 ? windward_w_m2_k_[k] : leeward_w_m2_k_[k];
  }

  absl::StatusOr<double> conduct(std::uint32_t which, const std::vector<std::uint32_t>& wall,
                                 int levels) {
    const WallBuildUp& build_up = request_.build_up[which];
    HeatRequest ask;
    ask.layers = build_up.layers;
    ask.inner_side = build_up.inner_side;
    ask.knot_s = knot_s_;
    const bool open = build_up.inner_side == InnerSide::kOpen;
    double mean_k = 0;
    for (std::size_t k = 0; k < count(); ++k)
      mean_k += weather(k).air_k / static_cast<double>(count());
    for (const std::uint32_t face : wall) {
      ask.outer.push_back(properties(face));
      if (!open) continue;
      const std::uint32_t back = faces_.back_of_facet[faces_.facet[face]];
      if (back == ThermalFaces::kNone)
        return absl::InvalidArgumentError(
            "its inside is open, and a part made of it is not two_sided");
      ask.inner.push_back(properties(back));
    }
    for (std::size_t k = 0; k < count(); ++k) ask.smooth.push_back(is_smooth(k));
    begin_k_.resize(request_.build_up.size());
    ask.start = PeriodicStart{mean_k, knots_.day_intervals, request_.tolerance_k, kMostDays,
                              std::move(begin_k_[which])};
    for (std::size_t k = 0; k < count(); ++k) ask.output_knot.push_back(k);
    ask.output_boundary = {0};
    if (open) ask.output_boundary.push_back(build_up.layers.size());
    ask.accuracy = {request_.tolerance_k, levels};
    const auto exposure = [&](std::size_t interval, std::span<const std::uint32_t> element,
                              const Exposure& to) {
      for (std::size_t at = 0; at < element.size(); ++at) {
        const std::uint32_t face = wall[element[at]];
        expose(interval, Side::kAfter, face, to.outer_begin, at);
        expose(interval + 1, Side::kBefore, face, to.outer_end, at);
        inside(build_up, interval, Side::kAfter, face, to.inner_begin, at);
        inside(build_up, interval + 1, Side::kBefore, face, to.inner_end, at);
      }
    };
    auto result = solve_heat(ask, exposure);
    if (!result.ok()) return result.status();
    begin_k_[which] = std::move(result->begin_k);
    double change_k = 0;
    const auto take = [&](std::size_t boundary, std::size_t element, std::uint32_t face) {
      for (std::size_t k = 0; k < count(); ++k) {
        float& kelvin = kelvin_[k * faces_.size() + face];
        const std::size_t at = result->at(k, boundary, element);
        const auto now = static_cast<float>(result->temperature_k[at]);
        change_k = std::max(change_k, std::abs(static_cast<double>(now - kelvin)));
        kelvin = now;
        error_k_[k * faces_.size() + face] = static_cast<float>(result->error_k[at]);
      }
    };
    for (std::size_t e = 0; e < wall.size(); ++e) {
      take(0, e, wall[e]);
      if (open) take(1, e, faces_.back_of_facet[faces_.facet[wall[e]]]);
      closure_w_m2_ = std::max(closure_w_m2_, result->closure_w_m2[e]);
      // A single wall of two faces that are not both its own (a closed plate of which one side is
      // modelled) has the back's temperature of its front.
      const std::uint32_t back = faces_.back_of_facet[faces_.facet[wall[e]]];
      if (!open && back != ThermalFaces::kNone) take(0, e, back);
    }
    return change_k;
  }

  void inside(const WallBuildUp& build_up, std::size_t k, Side side, std::uint32_t face,
              const FaceExposure& to, std::size_t at) const {
    switch (build_up.inner_side) {
      case InnerSide::kAdiabatic:
        return;
      case InnerSide::kHeatFlux:
        to.absorbed_w_m2[at] = build_up.inner_flux_w_m2;
        return;
      case InnerSide::kAir:
        to.forced_h_w_m2_k[at] = build_up.inner_h_w_m2_k;
        to.fluid_k[at] = build_up.inner_k;
        return;
      case InnerSide::kFixedTemperature:
        to.fluid_k[at] = build_up.inner_k;
        return;
      case InnerSide::kOpen:
        expose(k, side, faces_.back_of_facet[faces_.facet[face]], to, at);
        return;
    }
  }

  // Whether the radiation after a knot goes on from that before.
  [[nodiscard]] bool is_smooth(std::size_t k) const {
    constexpr double kJumpWM2 = 1;
    const auto near = [](double a, double b) { return std::abs(a - b) < kJumpWM2; };
    const HeatRadiation &before = weather(k).before, &after = weather(k).after;
    return k > 0 && near(before.direct_normal_w_m2, after.direct_normal_w_m2) &&
           near(before.diffuse_horizontal_w_m2, after.diffuse_horizontal_w_m2) &&
           near(before.sky_w_m2, after.sky_w_m2);
  }

  static std::uint64_t mix(std::uint64_t seed, std::size_t knot) {
    return seed * 0x9e3779b97f4a7c15ULL + knot + 1;
  }

  const Target& target_;
  const ThermalFaces& faces_;
  const SceneHeatRequest& request_;
  Knots knots_;
  std::vector<double> knot_s_, windward_w_m2_k_, leeward_w_m2_k_;  // [knot]
  std::vector<bool> covered_;                                      // [face] under water or ground
  std::vector<double> emissivity_;                                 // [face]
  ExchangeFactors factors_;
  std::vector<float> direct_, diffuse_;  // [knot x faces + face], [face]
  // [knot x faces + face] Of direct_: the root mean square over the face of what a place differs
  // by.
  std::vector<float> uneven_;
  std::vector<float> incoming_, kelvin_, error_k_;
  std::vector<std::vector<double>> begin_k_;  // [build-up] HeatResult::begin_k of the last round
  int rounds_ = 0;
  double left_k_ = 0, closure_w_m2_ = 0;
};

// Of a slope's step from a facet's middle to its neighbour's: its root mean square over the facet.
// Of the two halves of a square, along a side; less in other directions and shapes.
constexpr double kOfStep = 0.7072;

// [facet] The largest difference to a neighbour over an edge in the same plane and part.
class PlaneNeighbours {
 public:
  explicit PlaneNeighbours(const Target& target) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> at_edge;
    for (std::uint32_t f = 0; f < target.facet.size(); ++f)
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t a = target.triangle[3 * f + c],
                            b = target.triangle[3 * f + (c + 1) % 3];
        at_edge[std::minmax(a, b)].push_back(f);
      }
    for (const auto& [edge, facets] : at_edge)
      for (std::size_t i = 0; i < facets.size(); ++i)
        for (std::size_t j = i + 1; j < facets.size(); ++j) {
          const Target::Facet &a = target.facet[facets[i]], &b = target.facet[facets[j]];
          if (a.part == b.part && a.nx * b.nx + a.ny * b.ny + a.nz * b.nz > 0.999f)
            pair_.emplace_back(facets[i], facets[j]);
        }
  }
  [[nodiscard]] std::vector<float> largest_difference(const std::vector<float>& kelvin) const {
    std::vector<float> out(kelvin.size(), 0.0f);
    for (const auto& [a, b] : pair_) {
      const float difference = std::abs(kelvin[a] - kelvin[b]);
      if (std::isnan(difference)) continue;
      out[a] = std::max(out[a], difference);
      out[b] = std::max(out[b], difference);
    }
    return out;
  }

 private:
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pair_;
};

// Of one computation; two are held at once. Some 50 bytes each.
constexpr std::size_t kMostFaceKnots = 120'000'000;

absl::Status check(const Target& target, const SceneHeatRequest& request) {
  const auto wrong = [](const std::string& what) { return absl::InvalidArgumentError(what); };
  if (request.part.size() != target.part.size())
    return wrong("parts: one for each of the target's");
  if (request.knot_s.size() < 3 || request.knot_s.size() % 2 == 0 ||
      request.weather.size() != request.knot_s.size())
    return wrong("knots: an odd number of three or more, with weather for each");
  if (request.day_knots == 0 || request.day_knots % 2 != 0 ||
      request.day_knots >= request.knot_s.size())
    return wrong("day_knots: even, of the knots' intervals");
  for (const std::size_t k : request.output_knot)
    if (k % 2 != 0 || k >= request.knot_s.size()) return wrong("output_knot: even, of the knots");
  for (std::size_t p = 0; p < request.part.size(); ++p) {
    const HeatPart& part = request.part[p];
    const std::string name = absl::StrCat("part \"", target.part[p].name, "\": ");
    if (!(part.solar_absorptance >= 0 && part.solar_absorptance <= 1))
      return wrong(
          absl::StrCat(name, "solar absorptance ", part.solar_absorptance, ", expected 0 to 1"));
    if (!(part.emissivity >= 0 && part.emissivity <= 1))
      return wrong(absl::StrCat(name, "emissivity ", part.emissivity, ", expected 0 to 1"));
    if (part.build_up && *part.build_up >= request.build_up.size())
      return wrong(absl::StrCat(name, "no such build-up"));
    if (!part.build_up && !(part.stated_k > 0))
      return wrong(absl::StrCat(name, "neither build-up nor temperature"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<SceneHeatResult> solve_scene_heat(const Target& target,
                                                 const SceneHeatRequest& request) {
  if (const absl::Status status = check(target, request); !status.ok()) return status;
  const ThermalFaces faces = make_thermal_faces(target);
  if (faces.size() > kMostFaceKnots / request.knot_s.size())
    return absl::InvalidArgumentError(absl::StrCat(
        faces.size(), " faces at ", request.knot_s.size(), " times are more than ", kMostFaceKnots,
        " together, which do not fit into memory: expected a coarser mesh or larger "
        "element_size_m, "
        "a longer step_minutes or fewer history_days"));
  Knots all{{}, request.day_knots, request.rays, request.sun_points, request.seed};
  Knots half{{},
             request.day_knots / 2,
             std::max(request.rays / 2, 1u),
             std::max(request.sun_points / 2, 1u),
             request.seed + 0x5bd1e995u};
  for (std::size_t k = 0; k < request.knot_s.size(); ++k) {
    all.of_request.push_back(k);
    if (k % 2 == 0) half.of_request.push_back(k);
  }
  Computation fine(target, faces, request, std::move(all));
  Computation coarse(target, faces, request, std::move(half));
  for (Computation* each : {&fine, &coarse})
    if (const absl::Status status = each->solve(); !status.ok()) return status;

  SceneHeatResult out;
  out.exchange_rounds = fine.rounds();
  out.exchange_left_k = fine.left_k();
  out.closure_w_m2 = std::max(fine.closure_w_m2(), coarse.closure_w_m2());
  // What the two computations differ by, at a time or in the root mean square of the hours around
  // it: at one time they may agree by luck.
  const auto difference_k = [&](std::uint32_t f, std::size_t at) {
    constexpr double kHoursAround = 3;
    double square = 0, count = 0;
    for (std::size_t k = 0; k < request.knot_s.size(); k += 2) {
      if (std::abs(request.knot_s[k] - request.knot_s[at]) > 3600 * kHoursAround) continue;
      const double d = static_cast<double>(fine.kelvin(k, f) - coarse.kelvin(k / 2, f));
      square += d * d;
      ++count;
    }
    return std::max(std::abs(static_cast<double>(fine.kelvin(at, f) - coarse.kelvin(at / 2, f))),
                    std::sqrt(square / count));
  };
  const PlaneNeighbours neighbours(target);
  const auto facets = static_cast<std::uint32_t>(faces.fronts);
  const std::size_t outputs = request.output_knot.size();
  out.kelvin.assign(outputs, std::vector<float>(facets, NAN));
  out.error_k.assign(outputs, std::vector<float>(facets, NAN));
  std::vector<std::vector<float>> step_k;
  for (std::size_t o = 0; o < outputs; ++o) {
    for (std::uint32_t f = 0; f < facets; ++f)
      if (fine.part_of(f).build_up && faces.area_m2[f] > 0)
        out.kelvin[o][f] = fine.kelvin(request.output_knot[o], f);
    step_k.push_back(neighbours.largest_difference(out.kelvin[o]));
  }
  for (std::uint32_t f = 0; f < facets; ++f) {
    if (!fine.part_of(f).build_up || faces.area_m2[f] <= 0) continue;
    const std::vector<double> uneven_k = fine.uneven_k(f);
    for (std::size_t o = 0; o < outputs; ++o) {
      const std::size_t k = request.output_knot[o];
      double error = static_cast<double>(fine.error_k(k, f)) + fine.left_k() + difference_k(f, k) +
                     std::max(uneven_k[k], kOfStep * static_cast<double>(step_k[o][f]));
      if (const std::uint32_t back = faces.back_of_facet[f]; back != ThermalFaces::kNone)
        error += 0.5 * std::abs(static_cast<double>(out.kelvin[o][f] - fine.kelvin(k, back)));
      out.error_k[o][f] = static_cast<float>(error);
    }
  }
  return out;
}

}  // namespace irsig
