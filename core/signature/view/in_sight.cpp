#include "core/signature/view/in_sight.h"

#include <algorithm>
#include <cstdint>
#include <optional>

#include "absl/strings/str_format.h"
#include "core/base/problems.h"
#include "core/environment/line_horizon.h"
#include "core/signature/view/prepared_view.h"
#include "core/sources/view_sources.h"

namespace irsig {
namespace {

std::string text_of(const Viewpoint& v) {
  return absl::StrFormat("the sensor at azimuth %.6g, elevation %.6g deg, range %.6g m",
                         v.aspect_azimuth_deg, v.aspect_elevation_deg, v.range_m);
}

Vec<Body> vertex(const Target& target, std::size_t i) {
  const float* v = target.vertex.data() + 3 * i;
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

// Returns true if some vertex is hidden (or, if asked for, is not).
bool any_vertex(bool hidden, const Target& target, const Plane& plane, Vec<Body> sensor) {
  for (std::size_t i = 0; i < target.vertex.size() / 3; ++i)
    if (hidden_by(plane, vertex(target, i), sensor) == hidden) return true;
  return false;
}

// Above the surface. [m]
double highest_m(const Target& target, const Plane& plane) {
  double out = -INFINITY;
  for (std::size_t i = 0; i < target.vertex.size() / 3; ++i)
    out = std::max(out, plane.z_m - vertex(target, i).z);
  return out;
}

// The scene is not owned: it outlives the result.
Land land_under(const Target& target, const LandScene& scene, double above_m,
                double bend_per_m = 0) {
  return {std::shared_ptr<const LandScene>(std::shared_ptr<void>(), &scene),
          above_m - target.centre.z,
          target.centre,
          {},
          bend_per_m};
}

absl::Status check_above_land(const Target& target, const LandScene& scene, double above_m,
                              double bend_per_m, Vec<Body> sensor, const Viewpoint& viewpoint) {
  const Land land = land_under(target, scene, above_m, bend_per_m);
  if (const auto object = land.object_around(sensor))
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s lies inside an object on the land (%s%s); move the object or the sensor",
        text_of(viewpoint), object->text, object->key));
  if (land.covers(sensor))
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s lies below the land there; raise it or take a shorter range", text_of(viewpoint)));
  // A vertex that touches the land is not below it, whatever its rounding.
  const auto offset_m = static_cast<double>(target.offset_m());
  for (std::size_t i = 0; i < target.vertex.size() / 3; ++i) {
    const Vec<Body> from = vertex(target, i) - Vec<Body>{0, 0, offset_m};
    if (!land.hides_from(sensor, from, 1)) return absl::OkStatus();
  }
  return absl::InvalidArgumentError(
      absl::StrFormat("%s has nothing of the target in sight: land hides all of it; take a higher "
                      "sensor or another "
                      "azimuth",
                      text_of(viewpoint)));
}

}  // namespace

absl::Status check_outside_objects(const Target& target, const LandScene& scene, double above_m) {
  const Land land = land_under(target, scene, above_m);
  for (std::size_t i = 0; i < target.vertex.size() / 3; ++i)
    if (const auto object = land.object_around(vertex(target, i)))
      return keyed_problem(
          object->key,
          object->text + "the object covers a part of the target; move it away from the target");
  return absl::OkStatus();
}

std::optional<EdgeStep> edge_in_sight(const Target& target, const LandScene& scene,
                                      const Environment* environment, double above_m,
                                      const Viewpoint& viewpoint, double half_m) {
  if (scene.edge_step.empty()) return std::nullopt;
  const Vec<Body> towards =
      body_from_aspect(viewpoint.aspect_azimuth_deg, viewpoint.aspect_elevation_deg);
  return land_under(target, scene, above_m, land_bend_per_m(environment, viewpoint, above_m))
      .step_in_sight(viewpoint.range_m * towards - target.centre, half_m);
}

absl::Status check_in_sight(const Target& target, std::span<const ConditionSpec> condition,
                            const Environment* environment, const LandScene* land,
                            const Viewpoint& viewpoint) {
  const auto [least, most] = std::minmax_element(
      condition.begin(), condition.end(), [](const ConditionSpec& a, const ConditionSpec& b) {
        return a.above_surface_m < b.above_surface_m;
      });
  const bool one_height = least->above_surface_m == most->above_surface_m;
  const Vec<Body> towards =
      body_from_aspect(viewpoint.aspect_azimuth_deg, viewpoint.aspect_elevation_deg);
  const Vec<Body> sensor = viewpoint.range_m * towards - target.centre;
  if (land != nullptr) {
    const double above_m = condition.front().above_surface_m;
    return check_above_land(target, *land, above_m,
                            land_bend_per_m(environment, viewpoint, above_m), sensor, viewpoint);
  }
  std::optional<double> known_m;
  for (std::uint32_t c = 0; c < condition.size(); ++c) {
    const double above_m = condition[c].above_surface_m;
    if (known_m == above_m && (one_height || environment == nullptr)) continue;
    known_m = above_m;
    const double surface_z_m = above_m - target.centre.z;
    Environment::Horizon horizon{};
    if (environment != nullptr) {
      const Environment::Line line = environment->line(viewpoint);
      horizon = one_height ? environment->horizon(line) : environment->horizon(line, c);
    } else {
      const GrazingRay straight;
      horizon = LineHorizon(straight, above_m,
                            {viewpoint.range_m, viewpoint.aspect_elevation_deg, towards, {}}, 0)
                    .horizon();
    }
    const std::optional<Plane> plane = plane_of(boundary_of(condition[c], surface_z_m, &horizon));
    if (!plane) return absl::OkStatus();
    if (!any_vertex(false, target, *plane, sensor)) {
      const double top_m = highest_m(target, *plane);
      if (top_m < 0)
        return absl::InvalidArgumentError(
            absl::StrFormat("%s has nothing of the target in sight: all of it lies below the "
                            "surface; raise the target",
                            text_of(viewpoint)));
      return absl::InvalidArgumentError(absl::StrFormat(
          "%s has nothing of the target in sight: the Earth hides what is lower than %.4g m there, "
          "and the target's highest point is %.4g m above the surface; take a shorter range or a "
          "higher sensor",
          text_of(viewpoint), horizon.hides_m, top_m));
    }
    if (!one_height && any_vertex(true, target, *plane, sensor))
      return absl::InvalidArgumentError(absl::StrFormat(
          "%s does not see all of the target at above_surface_m = %.6g, and conditions of several "
          "heights share their paths; put this height into a sweep of its own",
          text_of(viewpoint), above_m));
  }
  return absl::OkStatus();
}

}  // namespace irsig
