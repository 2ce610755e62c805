#include "core/thermal/scene/scene_heat.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/thermal/scene/heat_bounds.h"
#include "core/thermal/scene/scene_exposure.h"
#include "core/thermal/scene/scene_walls.h"

namespace irsig {
namespace {

// Root mean square over a facet, as a fraction of the slope's step from its middle to its
// neighbour's. For the two halves of a square, along a side; it is less in other directions and
// shapes.
constexpr double kOfStep = 0.7072;

// Error of a temperature by rounding to float and by Newton's method. [K]
constexpr double kRoundingK = 3e-5;

// Returns for each vertex the first one at the same place: some files repeat vertices for each
// facet.
std::vector<std::uint32_t> first_at_place(const Target& target) {
  std::vector<std::uint32_t> order(target.vertex.size() / 3), out(order.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto place = [&](std::uint32_t v) {
    const float* at = target.vertex.data() + 3 * static_cast<std::size_t>(v);
    return std::array{at[0], at[1], at[2]};
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair{place(a), a} < std::pair{place(b), b};
  });
  for (std::size_t i = 0; i < order.size(); ++i)
    out[order[i]] = i > 0 && place(order[i]) == place(order[i - 1]) ? out[order[i - 1]] : order[i];
  return out;
}

// [facet] The largest difference to a neighbour over an edge in the same plane and part; edges are
// the same if their ends are at the same places.
class PlaneNeighbours {
 public:
  explicit PlaneNeighbours(const Target& target) {
    const std::vector<std::uint32_t> first = first_at_place(target);
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> at_edge;
    for (std::uint32_t f = 0; f < target.facet.size(); ++f)
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t a = first[target.triangle[3 * f + c]],
                            b = first[target.triangle[3 * f + (c + 1) % 3]];
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

// Most faces x knots of one computation; two are held at once, some 50 bytes each.
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
  if (!(request.convection_factor >= 0 && request.convection_factor <= 10))
    return wrong(
        absl::StrCat("convection_factor ", request.convection_factor, ", expected 0 to 10"));
  const std::vector<double>& ground_k = request.beneath.temperature_at_k;
  if (!ground_k.empty() &&
      (request.beneath.water || ground_k.size() != request.knot_s.size() ||
       !std::ranges::all_of(ground_k, [](double k) { return k > 0 && std::isfinite(k); })))
    return wrong("beneath.temperature_at_k: of ground, a temperature for each knot");
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
  for (const HeatPart& part : request.part)
    if (part.build_up && request.build_up[*part.build_up].water &&
        request.build_up[*part.build_up].water->canopy && !(part.solar_absorptance > 0))
      return wrong(absl::StrCat("build_up \"", request.build_up[*part.build_up].name,
                                "\": its canopy answers to sunlight, and a part made of it absorbs "
                                "none, expected a solar absorptance above 0"));
  for (const WallBuildUp& wall : request.build_up) {
    const std::string name = absl::StrCat("build_up \"", wall.name, "\": ");
    if (wall.water) {
      if (const absl::Status status = check_water(*wall.water); !status.ok())
        return wrong(absl::StrCat(name, status.message()));
      if (wall.inner_side == InnerSide::kOpen)
        return wrong(absl::StrCat(name,
                                  "a sheet whose back is open has no latent heat, expected "
                                  "another inside"));
      for (const HeatWeather& weather : request.weather)
        if (!weather.humid)
          return wrong(absl::StrCat(name,
                                    "latent heat needs the humidity and pressure of the "
                                    "weather at every knot"));
    }
    if (wall.inner_at.empty()) continue;
    if (wall.inner_side == InnerSide::kAdiabatic || wall.inner_side == InnerSide::kOpen)
      return wrong(absl::StrCat(name, "nothing changes inside that is adiabatic or open"));
    if (wall.inner_at.size() != request.knot_s.size())
      return wrong(absl::StrCat(name, "inside: one value for each knot"));
  }
  return absl::OkStatus();
}

// First steps of the walls, of all knots.
double shortest_step_s(const SceneExposure& exposure, const SceneHeatRequest& request) {
  double out = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k < exposure.knots(); ++k) {
    bool smooth = exposure.is_smooth(k - 1);
    for (const WallBuildUp& wall : request.build_up)
      smooth = smooth && !wall.jumps_at(exposure.of_request(k - 1));
    out = std::min(out, first_step_s(exposure.knot_s(k) - exposure.knot_s(k - 1), smooth));
  }
  return out;
}

// Returns the largest change of each face's temperature by cells and steps twice as long. [face]
std::vector<float> largest_differences(const std::vector<float>& a, const std::vector<float>& b,
                                       std::size_t faces) {
  std::vector<float> out(faces, 0.0f);
  for (std::size_t i = 0; i < a.size(); ++i)
    out[i % faces] = std::max(out[i % faces], std::abs(a[i] - b[i]));
  return out;
}

// Returns the temperature that views take for a facet, whichever side they see: for a sheet the
// mean of both.
float facet_kelvin(const SceneWalls& walls, const ThermalFaces& faces, std::size_t knot,
                   std::uint32_t f) {
  const std::uint32_t back = faces.back_of_facet[f];
  const float front_k = walls.kelvin(knot, f);
  return back == ThermalFaces::kNone ? front_k : 0.5f * (front_k + walls.kelvin(knot, back));
}

absl::Status check(const Target& target, const ThermalFaces& faces,
                   const SceneHeatRequest& request) {
  RETURN_IF_ERROR(check(target, request));
  if (faces.size() > kMostFaceKnots / request.knot_s.size())
    return absl::InvalidArgumentError(absl::StrCat(
        faces.size(), " faces at ", request.knot_s.size(), " times are more than ", kMostFaceKnots,
        " together, which do not fit into memory: expected a coarser mesh or larger "
        "element_size_m, "
        "a longer step_minutes or fewer history_days"));
  for (std::size_t k = 1; k < request.knot_s.size(); ++k)
    if (!(request.knot_s[k] > request.knot_s[k - 1]))
      return absl::InvalidArgumentError("knot_s: increasing");
  return absl::OkStatus();
}

// Knots within 12 h of a knot, or of the nearest time that far from the first and the last.
std::vector<std::size_t> knots_of_day_around(const SceneExposure& exposure, std::size_t knot) {
  constexpr double kHalfDayS = 43200;
  const double first_s = exposure.knot_s(0), last_s = exposure.knot_s(exposure.knots() - 1);
  const double middle_s = std::min(std::max(exposure.knot_s(knot), first_s + kHalfDayS),
                                   std::max(last_s - kHalfDayS, first_s + kHalfDayS));
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < exposure.knots(); ++k)
    if (std::abs(exposure.knot_s(k) - middle_s) <= kHalfDayS) out.push_back(k);
  return out;
}

// Compute again with half the rays and other points.
SceneKnots every_second_knot(const SceneHeatRequest& request) {
  SceneKnots half{{},
                  request.day_knots / 2,
                  std::max(request.rays / 2, 1u),
                  std::max(request.sun_points / 2, 1u),
                  request.seed + 0x5bd1e995u};
  for (std::size_t k = 0; k < request.knot_s.size(); k += 2) half.of_request.push_back(k);
  return half;
}

// Bounds of both effects, and the sum of those that are left out.
//   left_out_k  [facet]
absl::Status add_effect_bounds(const Target& target, const SceneHeatRequest& request,
                               const SceneExposure& exposure, const HeatBounds& bounds,
                               SceneHeatResult& out, std::vector<double>& left_out_k) {
  const auto add = [&](const char* name, bool on, const std::vector<double>& bound_k,
                       std::vector<float>& to) {
    for (std::size_t f = 0; f < bound_k.size(); ++f) {
      const std::uint32_t part = target.facet[f].part;
      const bool computed =
          request.part[part].build_up.has_value() && !exposure.dark(static_cast<std::uint32_t>(f));
      to.push_back(computed ? static_cast<float>(bound_k[f]) : NAN);
      if (on || !computed) continue;
      if (!std::isfinite(bound_k[f]))
        return absl::InvalidArgumentError(absl::StrCat(
            name, " cannot be left out: facet ", f, " of part \"", target.part[part].name,
            "\" loses so little heat by itself that nothing says how much it changes"));
      left_out_k[f] += bound_k[f];
    }
    return absl::OkStatus();
  };
  RETURN_IF_ERROR(add("heat_exchange", request.exchange, bounds.exchange_k, out.exchange_bound_k));
  return add("heat_diffuse_sun", request.diffuse_sun, bounds.diffuse_sun_k,
             out.diffuse_sun_bound_k);
}

}  // namespace

absl::StatusOr<SceneHeatResult> solve_scene_heat(const Target& target,
                                                 const SceneHeatRequest& request) {
  const ThermalFaces faces = make_thermal_faces(target);
  RETURN_IF_ERROR(check(target, faces, request));
  SceneKnots all{{}, request.day_knots, request.rays, request.sun_points, request.seed};
  all.keep_hits = true;
  for (std::size_t k = 0; k < request.knot_s.size(); ++k) all.of_request.push_back(k);
  SceneExposure fine_exposure(target, faces, request, std::move(all)),
      coarse_exposure(target, faces, request, every_second_knot(request));
  SceneExposure::fraction_dark(fine_exposure, coarse_exposure);
  // Both share one grid, so that the one goes on from where the other's day begins.
  const double shortest_s =
      std::min(shortest_step_s(fine_exposure, request), shortest_step_s(coarse_exposure, request));
  SceneWalls fine(fine_exposure, request, shortest_s), coarse(coarse_exposure, request, shortest_s);
  RETURN_IF_ERROR(fine.check());
  RETURN_IF_ERROR(coarse.settle());
  const std::vector<float> roughly = coarse.kelvin();
  coarse.refine();
  RETURN_IF_ERROR(coarse.settle());
  const std::vector<float> off_k = largest_differences(roughly, coarse.kelvin(), faces.size());
  fine.start_from(coarse);
  RETURN_IF_ERROR(fine.settle());
  // Both have the same cells and steps: their difference is not conduction's.
  const std::vector<float> fine_k = fine.kelvin();
  RETURN_IF_ERROR(fine.sharpen(off_k));

  SceneHeatResult out;
  std::vector<double> left_out_k(faces.fronts, 0.0);
  if (request.effect_bounds || !request.exchange || !request.diffuse_sun)
    RETURN_IF_ERROR(add_effect_bounds(target, request, fine_exposure,
                                      heat_bounds(request, fine_exposure, fine), out, left_out_k));
  out.exchange_rounds = coarse.passes() + fine.passes();
  out.exchange_left_k = fine.left_k();
  out.closure_w_m2 = std::max(fine.closure_w_m2(), coarse.closure_w_m2());
  // The difference of the two computations, at a time or as the root mean square of the hours
  // around it: at one time they may agree by luck.
  const auto of_face_k = [&](std::uint32_t f, std::size_t at) {
    constexpr double kHoursAround = 3;
    double square = 0, count = 0;
    for (std::size_t k = 0; k < request.knot_s.size(); k += 2) {
      if (std::abs(request.knot_s[k] - request.knot_s[at]) > 3600 * kHoursAround) continue;
      const double d = static_cast<double>(fine_k[k * faces.size() + f] - coarse.kelvin(k / 2, f));
      square += d * d;
      ++count;
    }
    return std::max(
        std::abs(static_cast<double>(fine_k[at * faces.size() + f] - coarse.kelvin(at / 2, f))),
        std::sqrt(square / count));
  };
  const auto difference_k = [&](std::uint32_t f, std::size_t at) {
    const std::uint32_t back = faces.back_of_facet[f];
    return std::max(of_face_k(f, at), back == ThermalFaces::kNone ? 0 : of_face_k(back, at));
  };
  const PlaneNeighbours neighbours(target);
  const auto facets = static_cast<std::uint32_t>(faces.fronts);
  const std::size_t outputs = request.output_knot.size();
  out.kelvin.assign(outputs, std::vector<float>(facets, NAN));
  out.error_k.assign(outputs, std::vector<float>(facets, NAN));
  std::vector<std::vector<float>> step_k;
  std::vector<float> of_facet(request.knot_s.size());
  const auto has_temperature = [&](std::uint32_t f) {
    return fine_exposure.part_of(f).build_up && faces.area_m2[f] > 0 && !fine_exposure.dark(f);
  };
  for (std::size_t o = 0; o < outputs; ++o) {
    for (std::uint32_t f = 0; f < facets; ++f)
      if (has_temperature(f))
        out.kelvin[o][f] = facet_kelvin(fine, faces, request.output_knot[o], f);
    step_k.push_back(neighbours.largest_difference(out.kelvin[o]));
  }
  for (std::uint32_t f = 0; f < facets; ++f) {
    if (!has_temperature(f)) continue;
    for (std::size_t k = 0; k < of_facet.size(); ++k) of_facet[k] = fine.kelvin(k, f);
    const std::vector<double> uneven_k = fine_exposure.uneven_k(f, of_facet),
                              of_rays_k =
                                  fine_exposure.by_rays_k(f, fine_k, fine.incoming(), of_facet);
    for (std::size_t o = 0; o < outputs; ++o) {
      const std::size_t k = request.output_knot[o];
      const double by_rays_k = std::hypot(
          fine_exposure.aimed_k(k, f, static_cast<double>(out.kelvin[o][f])), of_rays_k[k]);
      double conduction_k = fine.error_k(f), faces_k = 0;
      if (const std::uint32_t back = faces.back_of_facet[f]; back != ThermalFaces::kNone) {
        conduction_k = std::max(conduction_k, fine.error_k(back));
        faces_k = 0.5 * std::abs(static_cast<double>(fine.kelvin(k, f) - fine.kelvin(k, back)));
      }
      const double error = kRoundingK + left_out_k[f] + conduction_k + fine.left_k() +
                           std::max(difference_k(f, k), by_rays_k) +
                           std::max(uneven_k[k], kOfStep * static_cast<double>(step_k[o][f])) +
                           faces_k;
      out.error_k[o][f] = static_cast<float>(error);
    }
  }
  return out;
}

absl::StatusOr<std::vector<TemperatureChange>> solve_scene_heat_changes(
    const Target& target, const SceneHeatRequest& request,
    std::span<const SceneHeatRequest> moved) {
  const ThermalFaces faces = make_thermal_faces(target);
  // The rest that passes and days leave has to be small against the effect of one input.
  constexpr double kFiner = 0.2;
  const auto finer = [](SceneHeatRequest r) {
    r.tolerance_k *= kFiner;
    r.exchange_tolerance_k *= kFiner;
    return r;
  };
  const SceneHeatRequest base_request = finer(request);
  RETURN_IF_ERROR(check(target, faces, base_request));
  SceneExposure exposure(target, faces, base_request, every_second_knot(request));
  // Without halving, both sides take the same steps, whose errors are the same.
  const double shortest_s = shortest_step_s(exposure, base_request);
  SceneWalls base(exposure, base_request, shortest_s);
  RETURN_IF_ERROR(base.check());
  RETURN_IF_ERROR(base.settle());
  std::vector<TemperatureChange> out;
  for (const SceneHeatRequest& each : moved) {
    const SceneHeatRequest moved_request = finer(each);
    RETURN_IF_ERROR(check(target, faces, moved_request));
    if (each.knot_s != request.knot_s || each.output_knot != request.output_knot)
      return absl::InvalidArgumentError("a moved input has other knots than the temperatures");
    SceneExposure changed_exposure(target, faces, moved_request, every_second_knot(request),
                                   &exposure);
    SceneWalls changed(changed_exposure, moved_request, shortest_s);
    RETURN_IF_ERROR(changed.check());
    changed.start_near(base);
    RETURN_IF_ERROR(changed.settle());
    TemperatureChange& change = out.emplace_back();
    const auto change_k = [&](std::size_t k, std::uint32_t f) {
      return facet_kelvin(changed, faces, k, f) - facet_kelvin(base, faces, k, f);
    };
    for (const std::size_t knot : request.output_knot) {
      std::vector<float>& kelvin = change.emplace_back(faces.fronts, NAN);
      const std::vector<std::size_t> day =
          each.of_model ? knots_of_day_around(exposure, knot / 2) : std::vector<std::size_t>();
      for (std::uint32_t f = 0; f < faces.fronts; ++f) {
        if (!exposure.part_of(f).build_up || faces.area_m2[f] <= 0 || exposure.dark(f)) continue;
        kelvin[f] = change_k(knot / 2, f);
        float squares = 0;
        for (const std::size_t k : day) squares += change_k(k, f) * change_k(k, f);
        if (!day.empty())
          kelvin[f] = std::copysign(
              std::max(std::abs(kelvin[f]), std::sqrt(squares / static_cast<float>(day.size()))),
              kelvin[f]);
      }
    }
  }
  return out;
}

}  // namespace irsig
