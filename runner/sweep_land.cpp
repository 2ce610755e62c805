#include "runner/sweep_land.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/constants.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/land/choose_map.h"
#include "core/land/map_edge.h"
#include "core/land/place_heights.h"
#include "core/land/read_heights.h"
#include "core/signature/background_window.h"
#include "core/signature/view/in_sight.h"
#include "core/sources/land.h"
#include "messages/environment/weather_from_message.h"
#include "runner/sweep_land_objects.h"

namespace irsig {
namespace {

// The sweep's author can mend it, at a key of the file.
absl::Status land_error(const std::string& key, const absl::Status& status) {
  return absl::IsInvalidArgument(status) ? at_key(key, status) : status;
}

absl::StatusOr<HeightRaster> raster_of(const schema::LandFile& file, std::optional<unsigned> epsg,
                                       const Assets& assets, const std::string& key) {
  std::optional<MapSystem> system;
  if (epsg) {
    auto known = map_system(*epsg);
    if (!known.ok()) return land_error(key, known.status());
    system = *known;
  }
  auto raster = read_heights(asset(assets, file.sha256()), file.file_name(), system);
  if (!raster.ok()) return land_error(key, raster.status());
  return raster;
}

std::optional<unsigned> stated(bool has, unsigned value) {
  return has ? std::optional(value) : std::nullopt;
}

absl::StatusOr<HeightGrid> placed(const HeightRaster& raster, const absl::StatusOr<LandMap>& map,
                                  const std::string& key) {
  if (!map.ok()) return land_error(key, map.status());
  auto grid = place_heights(raster, *map);
  if (!grid.ok()) return land_error(key, grid.status());
  return grid;
}

absl::StatusOr<HeightField> height_field_of(const schema::ResolvedSweep& sweep,
                                            const Assets& assets, const MapChoice& choice) {
  const schema::Land& land = sweep.sweep().land();
  const std::string key = "land.heights";
  ASSIGN_OR_RETURN(const auto raster, raster_of(sweep.land().heights(),
                                                stated(land.has_epsg(), land.epsg()), assets, key));
  ASSIGN_OR_RETURN(auto outer, placed(raster, choose_map(raster, choice), key));
  if (!sweep.land().has_inset()) {
    auto field = HeightField::create(std::move(outer));
    return field.ok() ? std::move(field) : land_error(key, field.status());
  }
  const std::string inset_key = "land.inset";
  ASSIGN_OR_RETURN(const auto finer,
                   raster_of(sweep.land().inset(), stated(land.has_inset_epsg(), land.inset_epsg()),
                             assets, inset_key));
  ASSIGN_OR_RETURN(auto inset, placed(finer, choose_inset(finer, choice, outer), inset_key));
  auto field = HeightField::create(std::move(outer), std::move(inset));
  return field.ok() ? std::move(field) : land_error(inset_key, field.status());
}

absl::StatusOr<LandCover> cover_of(const schema::ResolvedSweep& sweep, const Assets& assets,
                                   const HeightField& field, const GeodeticPosition& origin) {
  const schema::Land& land = sweep.sweep().land();
  std::vector<CoverLayer> layers;
  for (int i = 0; i < land.material_size(); ++i) {
    const schema::LandMaterial& material = land.material(i);
    CoverLayer& layer = layers.emplace_back();
    layer.objects_only = material.objects_only();
    layer.key = absl::StrCat("land.material[", i, "].fraction_file");
    if (i >= sweep.land().fraction_size() || sweep.land().fraction(i).sha256().empty()) continue;
    ASSIGN_OR_RETURN(layer.fraction,
                     raster_of(sweep.land().fraction(i),
                               stated(material.has_fraction_epsg(), material.fraction_epsg()),
                               assets, layer.key));
  }
  return LandCover::create(layers, field, origin);
}

}  // namespace

absl::StatusOr<std::shared_ptr<const LandScene>> land_from_sweep(
    const schema::ResolvedSweep& sweep, const Assets& assets,
    std::shared_ptr<const LandKinds> kinds) {
  if (!sweep.sweep().has_land()) return nullptr;
  const schema::Land& land = sweep.sweep().land();
  const schema::Place& place = sweep.sweep().place();
  MapChoice choice;
  choice.origin = {place.latitude_deg(), place.longitude_deg(), place.height_m()};
  choice.geoid_m = land.geoid_m();
  if (land.has_fill_m()) choice.fill_m = land.fill_m();
  if (land.has_spacing_m()) choice.spacing_m = land.spacing_m();
  if (land.has_width_m()) choice.width_m = land.width_m();
  ASSIGN_OR_RETURN(auto field, height_field_of(sweep, assets, choice));
  auto out = std::make_shared<LandScene>();
  const auto surface_m = field.z_m(0, 0);
  if (!surface_m)
    return keyed_problem(
        "land.heights",
        "the target lies at the edge of the map, outside the rectangle around its middle that has "
        "heights everywhere; use a map that reaches farther, or state a width_m");
  out->surface_m = *surface_m;
  if (land.edge_fade_m() > 0) {
    auto faded = fade_edge(std::move(field), choice.origin, land.edge_fade_m());
    if (!faded.ok()) return land_error("land.edge_fade_m", faded.status());
    field = *std::move(faded);
  }
  ASSIGN_OR_RETURN(out->edge_step, edge_steps(field, choice.origin));
  ASSIGN_OR_RETURN(out->cover, cover_of(sweep, assets, field, choice.origin));
  ASSIGN_OR_RETURN(out->objects, land_objects_from_sweep(sweep, assets, field, out->cover));
  out->field = std::make_shared<const HeightField>(std::move(field));
  out->kinds = std::move(kinds);
  out->heading_deg = place.heading_deg();
  return out;
}

namespace {

// Air and sky begin at the height of [place].
std::optional<Problem> other_height(const schema::ResolvedSweep& sweep, const LandScene& land) {
  constexpr double kMostDifferenceM = 10;
  if (std::abs(land.surface_m) <= kMostDifferenceM) return std::nullopt;
  const double height_m = sweep.sweep().place().height_m();
  return Problem{
      "", "place.height_m",
      absl::StrFormat("place.height_m = %.1f, but the map's height at the target is %.1f m "
                      "above the ellipsoid: air and sky are those of %.1f m; write height_m = %.1f",
                      height_m, height_m + land.surface_m, height_m, height_m + land.surface_m)};
}

// The line of sight through the target's reference point, or through a point that high above the
// land, decides for a viewpoint.
std::optional<Problem> ground_behind(const schema::ResolvedSweep& sweep, const LandScene& scene) {
  constexpr double kLeastAboveM = 1;
  const double above_m = std::max(kLeastAboveM, above_surface_m(sweep, sweep.condition(0)));
  // Not owned: the land outlives this call.
  const Land land(std::shared_ptr<const LandScene>(std::shared_ptr<void>(), &scene), above_m,
                  {0, 0, 0}, {});
  const double dip = std::sqrt(2 * above_m / kEarthRadiusM);
  LandMix mix;
  int beyond = 0;
  const schema::Viewpoint* first = nullptr;
  double leaves_m = 0;
  for (const schema::Viewpoint& v : sweep.viewpoint()) {
    const Vec<Body> behind =
        -1.0 * body_from_aspect(v.aspect_azimuth_deg(), v.aspect_elevation_deg());
    if (behind.z <= dip || land.meet({0, 0, 0}, behind, mix)) continue;
    ++beyond;
    if (first == nullptr) {
      first = &v;
      leaves_m = land.leaves_map_m({0, 0, 0}, behind);
    }
  }
  if (first == nullptr) return std::nullopt;
  return Problem{
      "", "land.heights",
      absl::StrFormat("%d of %d viewpoints look past the edge of the map, where the ground of "
                      "[surroundings] goes on: that of azimuth %g, elevation %g deg leaves it %.0f "
                      "m behind the target; use a map that reaches farther",
                      beyond, sweep.viewpoint_size(), first->aspect_azimuth_deg(),
                      first->aspect_elevation_deg(), leaves_m)};
}

// Half of the sides of the square around the target that rows and their pictures show. [m]
double half_of_window_m(const schema::Image& image, const Target& target, double range_m) {
  const double row_m = kClutterDiameters * target.radius_m;
  if (image.kind() != "camera") return std::max(row_m, (1 + 2 * image.margin()) * target.radius_m);
  const double aspect = image.pixels_size() == 2 ? double(image.pixels(1)) / image.pixels(0) : 1.0;
  double aside_m = 0;
  for (const double x_m : image.look_at_m()) aside_m = std::hypot(aside_m, x_m);
  return std::max(row_m, aside_m + range_m * std::max(1.0, aspect) *
                                       std::tan(0.5 * image.field_of_view_deg() * kRadPerDeg));
}

}  // namespace

absl::Status check_land_edge(const schema::ResolvedSweep& sweep, const Target& target,
                             const Environment* environment, const LandScene* land) {
  if (land == nullptr || land->edge_step.empty()) return absl::OkStatus();
  const double above_m = above_surface_m(sweep, sweep.condition(0));
  int count = 0;
  const schema::Viewpoint* first = nullptr;
  EdgeStep at;
  for (const schema::Viewpoint& v : sweep.viewpoint()) {
    const auto step = edge_in_sight(target, *land, environment, above_m,
                                    {v.aspect_azimuth_deg(), v.aspect_elevation_deg(), v.range_m()},
                                    half_of_window_m(sweep.sweep().image(), target, v.range_m()));
    if (!step || count++ > 0) continue;
    first = &v;
    at = *step;
  }
  if (first == nullptr) return absl::OkStatus();
  const double step_m = at.land_z_m - at.ground_z_m;
  return keyed_problem(
      "land.heights",
      absl::StrFormat("%d of %d viewpoints see a cliff at the edge of the map: from azimuth %g, "
                      "elevation %g deg, range %g m, the land ends %.1f m %s the ground beyond, "
                      "which lies as high as the land below the target, at x = %.0f, y = %.0f m "
                      "from there; use a map that reaches farther, or state land.edge_fade_m, a "
                      "width over which heights become that of the ground",
                      count, sweep.viewpoint_size(), first->aspect_azimuth_deg(),
                      first->aspect_elevation_deg(), first->range_m(), std::abs(step_m),
                      step_m > 0 ? "above" : "below", at.x_m, at.y_m));
}

std::vector<Problem> land_warnings(const schema::ResolvedSweep& sweep, const LandScene* land) {
  std::vector<Problem> out;
  if (land == nullptr) return out;
  for (auto& problem : {other_height(sweep, *land), ground_behind(sweep, *land)})
    if (problem) out.push_back(*problem);
  return out;
}

std::size_t bytes_of(const LandScene* land) {
  if (land == nullptr) return 0;
  return land->field->memory_bytes() + land->cover.memory_bytes() +
         (land->objects == nullptr ? 0 : land->objects->memory_bytes());
}

}  // namespace irsig
