#include "core/signature/effect_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/spectral/planck.h"
#include "core/spectral/solar.h"

namespace irsig {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kSigmas = 4;

RowBounds::Bound& at(RowBounds& row, Effect effect) {
  return row.effect[static_cast<std::size_t>(effect)];
}

// In-band integral of a spectrum on all nodes, as it is and behind the line of sight.
struct BandIntegral {
  double source, apparent;
};
class BandOf {
 public:
  BandOf(const BandOnAxis& band, const std::vector<double>& transmittance)
      : grid_(band.grid), offset_(band.first_node), transmittance_(transmittance) {}
  [[nodiscard]] BandIntegral operator()(const std::vector<double>& spectrum) const {
    BandIntegral sum{0, 0};
    for (std::size_t i = 0; i < grid_.node_um.size(); ++i) {
      const double w = grid_.band_weight[i] * spectrum[offset_ + i];
      sum.source += w;
      sum.apparent += w * transmittance_[offset_ + i];
    }
    return sum;
  }
  [[nodiscard]] BandIntegral blackbody(double temperature_k) const {
    BandIntegral sum{0, 0};
    for (std::size_t i = 0; i < grid_.node_um.size(); ++i) {
      const double w =
          grid_.band_weight[i] * planck_radiance_w_m2_sr_um(grid_.node_um[i], temperature_k);
      sum.source += w;
      sum.apparent += w * transmittance_[offset_ + i];
    }
    return sum;
  }

 private:
  const BandGrid& grid_;
  std::size_t offset_;
  const std::vector<double>& transmittance_;
};

double hottest_k(const ConditionSpec& condition) {
  return *std::max_element(condition.part_temperature_k.begin(),
                           condition.part_temperature_k.end());
}

// Limits of the target's materials for light that comes from anywhere.
struct SurfaceLimits {
  double gathered = 1;     // light on a facet, that from other facets included / from outside
  double matt_per_sr = 0;  // the largest DHR / pi
  double least_dhr = 1;
};
SurfaceLimits surface_limits(const PreparedScene& scene) {
  const Target& target = scene.target;
  SurfaceLimits out;
  double most = 0;
  std::vector<bool> seen(scene.carried_material().size(), false);
  for (const PartSpec& part : target.part) {
    if (seen[part.material]) continue;
    seen[part.material] = true;
    const Material& m = scene.carried_material()[part.material];
    double dhr = 0;
    for (int k = 1; k <= 64; ++k) {
      const double here = m.dhr_max(static_cast<float>(k) / 64);
      dhr = std::max(dhr, here);
      out.least_dhr = std::min(out.least_dhr, here);
    }
    most = std::max(most, dhr);
  }
  out.matt_per_sr = most / std::numbers::pi;
  // Radiances of facets that light each other obey L <= f E + DHR L.
  if (!target.convex) out.gathered = most < 1 ? 1 / (1 - most) : kInfinite;
  return out;
}

RowBounds::Bound times(double factor, const BandIntegral& b) {
  // Nothing times a bound that is not known is nothing.
  const auto product = [&](double x) { return factor == 0 || x == 0 ? 0 : factor * x; };
  return {false, product(b.source), product(b.apparent), product(b.apparent)};
}

// The most of a bound on sunlight at the target that arrives. What the air has taken out of it on
// its way down is in the bound as a band's mean, and lines that are gone already are not absorbed
// again: only sunlight outside the air, a smooth spectrum, may be multiplied by mean transmittance.
std::vector<double> arriving_sunlight(const LightBounds& light, bool atmosphere,
                                      const std::vector<double>& node_um) {
  if (!atmosphere) return light.transmittance;
  std::vector<double> out(node_um.size(), 1.0);
  for (std::size_t i = 0; i < out.size(); ++i)
    if (light.sun[i] > 0)
      out[i] = std::min(1.0, kNearestSun * solar_irradiance_w_m2_um(node_um[i]) *
                                 light.transmittance[i] / light.sun[i]);
  return out;
}

RowBounds::Bound smaller(const RowBounds::Bound& a, const RowBounds::Bound& b) {
  return {false, std::min(a.source, b.source), std::min(a.apparent, b.apparent),
          std::min(a.contrast, b.contrast)};
}

RowBounds::Bound together(const RowBounds::Bound& a, const RowBounds::Bound& b) {
  return {false, a.source + b.source, a.apparent + b.apparent, a.contrast + b.contrast};
}

bool dark(const std::vector<double>& spectrum) {
  return std::all_of(spectrum.begin(), spectrum.end(), [](double x) { return x == 0; });
}

// Properties of a target and its view that bound the light: surfaces, areas, facets.
struct OfTarget {
  const PreparedScene& scene;
  const SurfaceLimits& surface;
  const UndersampledSources* lit;  // null: facets as if they were matt and turned to the sun
  double q0, area_m2;
};

// Bounds of the sunlight that a row has by way of the target; `by_parts` of that which meets it
// more than once.
struct SunByTarget {
  RowBounds::Bound direct, diffuse, mirrored, by_parts;
};
SunByTarget sun_by_target(const OfTarget& of, const UndersampledSources::Sun& facets,
                          const BandOf& sunlight, const LightBounds& light, const RowBounds& row) {
  const bool convex = of.scene.target.convex;
  const auto bound_of = [&row](Effect e) { return row.effect[static_cast<std::size_t>(e)]; };
  SunByTarget out{bound_of(Effect::kDirectSun),
                  bound_of(Effect::kDiffuseSun),
                  bound_of(Effect::kMirroredSun),
                  {}};
  // Without light from the target itself sunlight that comes by way of it is gone too.
  if (!out.direct.absent) {
    const double first = of.lit != nullptr
                             ? std::min(facets.first.sum(), of.area_m2 * facets.first.brightest())
                             : of.area_m2 * of.surface.matt_per_sr;
    const double later =
        convex ? 0 : of.q0 * (of.lit != nullptr ? facets.brightest_per_sr : of.surface.matt_per_sr);
    out.direct = times(first + later, sunlight(light.sun));
    out.by_parts = times(later, sunlight(light.sun));
  }
  const double shown = of.lit ? of.lit->shown_m2_per_sr() : 0,
               edge_on = of.lit ? of.lit->edge_on_m2() : 0, any = of.lit ? of.lit->any_per_sr() : 0;
  const auto from_around = [&](RowBounds::Bound& bound, const std::vector<double>& radiance,
                               const std::vector<double>& irradiance) {
    if (bound.absent) return;
    if (dark(radiance)) {
      bound = {true, 0, 0, 0};
      return;
    }
    const RowBounds::Bound all = times(of.q0, sunlight(radiance));
    const RowBounds::Bound later =
        convex ? RowBounds::Bound{}
               : smaller(all, times(of.q0 > 0 ? of.q0 * any * of.surface.gathered : 0,
                                    sunlight(irradiance)));
    bound = smaller(all, together(together(times(shown, sunlight(irradiance)),
                                           times(edge_on, sunlight(radiance))),
                                  later));
    out.by_parts = together(out.by_parts, later);
  };
  from_around(out.diffuse, light.diffuse_sun, light.diffuse_sun_w_m2_um);
  from_around(out.mirrored, light.mirrored_sun, light.mirrored_sun_w_m2_um);
  return out;
}

RowBounds::Bound weighted(double weight, const RowBounds::Bound& b) {
  return {false, weight * b.source, weight * b.apparent, weight * b.contrast};
}

// Sets the bound of a condition's cloud: under either sky light is between nothing and the larger
// of both bounds, by way of the target, in the line of sight and behind the target.
void set_cloud(const OfTarget& of, const UndersampledSources::Sun& facets, const CloudBounds& cloud,
               const BandOnAxis& on_axis, bool atmosphere, RowBounds& row) {
  const BandOf band(on_axis, cloud.most.transmittance);
  const std::vector<double> arrives =
      arriving_sunlight(cloud.most, atmosphere, of.scene.axis.node_um());
  const SunByTarget sun = sun_by_target(of, facets, BandOf(on_axis, arrives), cloud.most, row);
  RowBounds::Bound reflected = times(of.q0, band(cloud.most.thermal));
  for (const RowBounds::Bound& b : {sun.direct, sun.diffuse, sun.mirrored})
    reflected = together(reflected, b);
  const double line =
      of.area_m2 * (band(cloud.path_surroundings).source + band(cloud.most.path_sun).source);
  const double behind =
      of.area_m2 * (band(cloud.most.thermal).apparent + band(cloud.most.background_sun).source);
  row.cloud_unreflected = weighted(cloud.weight, {false, 0, line, behind});
  at(row, Effect::kCloud) = together(row.cloud_unreflected, weighted(cloud.weight, reflected));
}

// Returns bounds of 0 for effects that nothing in the scene causes; all other bounds are unknown.
RowBounds known_absences(const PreparedScene& scene, const ViewRequest& request, std::size_t c) {
  RowBounds row;
  row.effect.fill({false, kInfinite, kInfinite, kInfinite});
  row.cloud_unreflected = at(row, Effect::kCloud);
  const bool sun = sun_shines(request.condition[c]), air = request.environment != nullptr;
  // In twilight the air scatters sunlight, though the disk has set.
  const bool scattered = air && request.condition[c].sun && request.condition[c].sun_scale > 0 &&
                         request.environment->sun_seen(static_cast<std::uint32_t>(c)).lights_air;
  const bool homogeneous = !air && request.air.model != AirModel::kVacuum;
  bool hot = false;
  for (const PartSpec& part : scene.target.part) hot |= part.hot;
  const auto absent = [&](Effect effect, bool is) {
    if (is) at(row, effect) = {true, 0, 0, 0};
  };
  absent(Effect::kDirectSun, !sun);
  absent(Effect::kSunDisk, !sun);
  absent(Effect::kDiffuseSun, !scattered);
  absent(Effect::kMirroredSun, !sun || !(request.condition[c].sea_wind_m_s > 0));
  absent(Effect::kPathSun, !scattered);
  absent(Effect::kBackgroundSun, !scattered);
  absent(Effect::kInterReflection, scene.target.convex);
  absent(Effect::kHotPartsReflected, !hot || scene.target.convex);
  absent(Effect::kTransmission, !air && !homogeneous);
  absent(Effect::kPathRadiance, !air && !(homogeneous && request.air.path_emission));
  absent(Effect::kJoinedLines, !air);
  absent(Effect::kAirToHorizon, !air);
  absent(Effect::kRefraction, !air);
  absent(Effect::kCloud, !air || !request.environment->cloudy(static_cast<std::uint32_t>(c)));
  bool spectral = false;
  for (const Material& m : scene.carried_material()) spectral |= !m.grey();
  absent(Effect::kSpectralVariation, !spectral);
  return row;
}

}  // namespace

std::vector<double> absolute_floors(const PreparedScene& scene, const ViewRequest& request,
                                    ViewSurroundings& surroundings) {
  std::vector<double> out;
  const double kelvin = request.accuracy.absolute_error_k;
  if (!(kelvin > 0)) return out;
  for (std::uint32_t c = 0; c < request.condition.size(); ++c) {
    const LightBounds& light = surroundings.bounds(c);
    for (std::size_t b = 0; b < scene.axis.bands(); ++b) {
      const BandOf band(scene.axis.band(b), light.transmittance);
      const double t =
          radiance_temperature_k(scene.band[b], scene.axis.grids()[b], band(light.thermal).source);
      out.push_back(t > 0 ? kelvin * (band.blackbody(t + 1).source - band.blackbody(t).source) : 0);
    }
  }
  return out;
}

std::vector<RowBounds> effects_without_bounds(const PreparedScene& scene,
                                              const ViewRequest& request) {
  std::vector<RowBounds> out;
  for (std::size_t c = 0; c < request.condition.size(); ++c)
    for (std::size_t b = 0; b < scene.axis.bands(); ++b)
      out.push_back(known_absences(scene, request, c));
  return out;
}

PilotLimits limits_of(const MeasuredView& pilot) {
  PilotLimits out;
  const Estimate area = pilot.row.front().estimate.projected_area_m2;
  out.area_m2 = area.value + kSigmas * area.stderr_;
  out.beyond_m2 = beyond_limit_m2(pilot, 0);
  const auto least = [](const Estimate& e) { return std::max(0.0, e.value - kSigmas * e.stderr_); };
  for (const Row& row : pilot.row)
    out.row.push_back({least(row.estimate.cause[static_cast<std::size_t>(Cause::kEmitted)]),
                       least(row.estimate.apparent), absolute_floor_w_sr(pilot, row)});
  return out;
}

PilotLimits best_case(const PreparedScene& scene, const ViewRequest& request, const ViewPlan& plan,
                      ViewSurroundings& surroundings, std::uint64_t samples) {
  PilotLimits out;
  out.area_m2 = 1;
  out.beyond_m2 = surface_limits(scene).least_dhr + kNoneSeen / static_cast<double>(samples);
  for (std::uint32_t c = 0; c < request.condition.size(); ++c) {
    const LightBounds& light = surroundings.bounds(c);
    for (std::size_t b = 0; b < scene.axis.bands(); ++b) {
      const BandOf band(scene.axis.band(b), light.transmittance);
      const double hottest = band.blackbody(hottest_k(request.condition[c])).source;
      const std::size_t row = out.row.size();
      out.row.push_back(
          {hottest, std::max(hottest, band(light.thermal).source),
           plan.absolute_floor_w_m2_sr.empty() ? 0 : plan.absolute_floor_w_m2_sr[row]});
    }
  }
  return out;
}

std::vector<RowBounds> effect_bounds(const PreparedScene& scene, const ViewRequest& request,
                                     const PilotLimits& pilot, const UndersampledSources* lit,
                                     ViewSurroundings& surroundings) {
  const std::size_t bands = scene.axis.bands();
  const SurfaceLimits surface = surface_limits(scene);
  const double q0 = pilot.beyond_m2, area_m2 = pilot.area_m2;
  const OfTarget of{scene, surface, lit, q0, area_m2};
  const UndersampledSources::Sun dark_facets;
  std::vector<RowBounds> out;
  for (std::uint32_t c = 0; c < request.condition.size(); ++c) {
    const ConditionSpec& condition = request.condition[c];
    const LightBounds& light = surroundings.bounds(c);
    const std::vector<double> sun_arrives =
        arriving_sunlight(light, request.environment != nullptr, scene.axis.node_um());
    const UndersampledSources::Sun& facets =
        lit != nullptr && sun_shines(condition)
            ? lit->of({condition.sun_direction,
                       condition.sun_angular_radius_deg * std::numbers::pi / 180, 0, 0})
            : dark_facets;
    const std::optional<CloudBounds> cloud = surroundings.cloud_bounds(c);
    for (std::size_t b = 0; b < bands; ++b) {
      const BandOf band(scene.axis.band(b), light.transmittance);
      const BandOf sunlight(scene.axis.band(b), sun_arrives);
      RowBounds row = known_absences(scene, request, c);
      const PilotLimits::Row& known = pilot.row[c * bands + b];
      row.goal_w_sr =
          std::max(request.accuracy.relative_error * known.emitted, known.absolute_floor);
      double arrives = 0, width = 0;
      const BandOnAxis on_axis = scene.axis.band(b);
      for (std::size_t i = 0; i < on_axis.nodes(); ++i) {
        const double weight = on_axis.grid.band_weight[i];
        width += weight;
        arrives += weight * light.transmittance[on_axis.first_node + i];
      }
      row.aperture_goal_w_sr = std::max(request.accuracy.relative_error * known.apparent,
                                        known.absolute_floor * arrives / width);

      // Light of any source that is not the sun's, reflected once or more: Q0 x the brightest.
      const BandIntegral thermal = band(light.thermal);
      const BandIntegral part = band.blackbody(hottest_k(condition));
      const bool convex = scene.target.convex;
      const BandIntegral brightest{std::max(thermal.source, convex ? 0 : part.source),
                                   std::max(thermal.apparent, convex ? 0 : part.apparent)};
      row.reflected = times(q0, brightest);
      at(row, Effect::kSkyReflected) = at(row, Effect::kLowerReflected) = times(q0, thermal);
      if (dark(light.thermal))
        at(row, Effect::kSkyReflected) = at(row, Effect::kLowerReflected) = {true, 0, 0, 0};
      const SunByTarget sun = sun_by_target(of, facets, sunlight, light, row);
      at(row, Effect::kDirectSun) = sun.direct;
      at(row, Effect::kDiffuseSun) = sun.diffuse;
      at(row, Effect::kMirroredSun) = sun.mirrored;
      if (!convex) at(row, Effect::kInterReflection) = together(row.reflected, sun.by_parts);
      if (RowBounds::Bound& bound = at(row, Effect::kJoinedLines); !bound.absent) {
        // Transmittances lie between 0 and 1: all of it, until the rings are known.
        const double all =
            at(row, Effect::kSkyReflected).source + at(row, Effect::kDiffuseSun).source;
        bound = {false, 0, all, all};
      }
      if (RowBounds::Bound& bound = at(row, Effect::kPathSun); !bound.absent)
        bound = {false, 0, area_m2 * band(light.path_sun).source, 0};
      if (RowBounds::Bound& bound = at(row, Effect::kBackgroundSun); !bound.absent)
        bound = {false, 0, 0, area_m2 * band(light.background_sun).source};
      if (cloud) set_cloud(of, facets, *cloud, on_axis, request.environment != nullptr, row);
      out.push_back(row);
    }
  }
  return out;
}

}  // namespace irsig
