#include "view/pictures/region_hours.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/accuracy/image_layers.h"
#include "core/base/status_macros.h"
#include "schema/store/check/check_picture.h"
#include "view/base/progress.h"
#include "view/base/table.h"
#include "view/pictures/masks.h"
#include "view/pictures/shown_image.h"

namespace irsig {
namespace {

constexpr const char* kRemedy =
    "add layers = [\"at_sensor\", \"temperature\"] to [image] of the sweep file and run it again";

absl::Status missing_layer(StoreReader& reader, const StoredSignature& row,
                           const std::string& name) {
  ASSIGN_OR_RETURN(const auto layers, reader.image_layers(row.signature_id));
  std::string names;
  for (const schema::ImageLayer& one : layers) names += (names.empty() ? "" : ", ") + one.name();
  if (!names.empty())
    return absl::NotFoundError(
        fmt::format("the image of row {} has no layer {}, it has {}: choose one with --layer, or "
                    "add {} to layers of [image] of the sweep file and run it again",
                    row.row, name, names, name));
  ASSIGN_OR_RETURN(const auto thumbnail, reader.thumbnail(row.signature_id));
  return absl::NotFoundError(fmt::format("row {} was computed without {}: {}", row.row,
                                         thumbnail ? "layers of its image" : "image", kRemedy));
}

absl::Status damaged_image(const StoredSignature& row, std::string_view what) {
  return absl::DataLossError(
      fmt::format("the stored image of row {} is damaged: {}", row.row, what));
}

absl::StatusOr<StoredSilhouette> silhouette_of(StoreReader& reader, const StoredSignature& row) {
  auto silhouette = reader.silhouette(row.signature_id);
  if (absl::IsDataLoss(silhouette.status()))
    return damaged_image(row, std::string(silhouette.status().message()));
  if (!silhouette.ok()) return silhouette.status();
  if (!silhouette->has_value()) return damaged_image(row, "it has no silhouette");
  return **std::move(silhouette);
}

// Layers of an image that the means are made of.
struct LayerPixels {
  RadianceImage value, stderr_, temperature, land_temperature;  // without pixels: not stored
};

absl::StatusOr<LayerPixels> layer_pixels(StoreReader& reader, const StoredSignature& row,
                                         const std::string& name, std::uint32_t most_px,
                                         const ReadPictures& read) {
  ASSIGN_OR_RETURN(const auto layer, reader.image_layer(row.signature_id, name));
  if (!layer) return missing_layer(reader, row, name);
  ASSIGN_OR_RETURN(const auto temperature,
                   reader.image_layer(row.signature_id, name_of(ImageLayer::kTemperature)));
  ASSIGN_OR_RETURN(const auto land_temperature,
                   reader.image_layer(row.signature_id, name_of(ImageLayer::kLandTemperature)));
  LayerPixels out;
  std::vector<ShownImage> files = {{layer->exr(), most_px}};
  std::vector<RadianceImage*> into = {&out.value};
  if (!layer->stderr_exr().empty()) {
    files.push_back({layer->stderr_exr(), most_px});
    into.push_back(&out.stderr_);
  }
  if (temperature) {
    files.push_back({temperature->exr(), most_px});
    into.push_back(&out.temperature);
  }
  if (land_temperature) {
    files.push_back({land_temperature->exr(), most_px});
    into.push_back(&out.land_temperature);
  }
  RETURN_IF_ERROR(
      visit_images(files, read, [&](std::size_t i, absl::StatusOr<RadianceImage> image) {
        if (!image.ok()) return damaged_image(row, std::string(image.status().message()));
        *into[i] = *std::move(image);
        return absl::OkStatus();
      }));
  return out;
}

bool fits(const RadianceImage& image, const StoredSilhouette& silhouette) {
  return image.radiance_w_m2_sr.empty() ||
         (image.width_px == silhouette.width_px && image.height_px == silhouette.height_px);
}

absl::Status check_layer(const std::string& layer) {
  const auto known = image_layer_of(layer);
  if (known && is_radiance(*known)) return absl::OkStatus();
  std::string names;
  for (std::size_t i = 0; i < kImageLayers.size(); ++i)
    if (is_radiance(static_cast<ImageLayer>(i)))
      names += (names.empty() ? "" : ", ") + std::string(kImageLayers[i].name);
  return absl::InvalidArgumentError(
      fmt::format("--layer {}: --kind regions draws a radiance, expected one of {}; temperatures "
                  "are drawn beside it where they are stored",
                  layer, names));
}

void sort_in_order(std::vector<RegionValue>& values) {
  const auto order = [](std::vector<std::string>& known, const std::string& name) {
    const auto found = std::find(known.begin(), known.end(), name);
    const auto at = found - known.begin();
    if (found == known.end()) known.push_back(name);
    return at;
  };
  using Key = std::tuple<std::ptrdiff_t, std::ptrdiff_t, std::ptrdiff_t, double>;
  std::vector<std::string> day, band, region;
  std::vector<std::pair<Key, RegionValue>> keyed;
  for (RegionValue& v : values) {
    const Key key{order(day, v.at.day), order(band, v.row.band), order(region, v.region),
                  v.at.hour};
    keyed.emplace_back(key, std::move(v));
  }
  std::stable_sort(keyed.begin(), keyed.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < keyed.size(); ++i) values[i] = std::move(keyed[i].second);
}

}  // namespace

absl::StatusOr<RegionHours> region_hours(StoreReader& reader, const Query& query,
                                         const std::vector<ImageRectangle>& rectangles,
                                         const std::string& layer, const ReadPictures& read) {
  RETURN_IF_ERROR(check_layer(layer));
  if (query.interpolate)
    return absl::InvalidArgumentError(
        "--kind regions: images are not interpolated, choose the nearest viewpoint with --aspect "
        "alone");
  Query asked = query;
  if (asked.aspect && !asked.nearest && !asked.within_deg) asked.nearest = 1;
  ASSIGN_OR_RETURN(const auto rows, run_query(reader, asked));
  if (rows.empty()) return absl::NotFoundError("nothing to plot: no signature matches the filters");
  RETURN_IF_ERROR(check_one_viewpoint(rows, "--aspect (the nearest)"));
  RegionHours out{rows.front().signature.sweep, layer, std::nullopt, {}};
  ASSIGN_OR_RETURN(const auto stored, reader.sweep(out.sweep, SweepFiles::kNone));
  const schema::Sweep& sweep = stored.resolved.sweep();
  out.solar_offset_h = solar_offset_h(sweep);
  Days days(out.solar_offset_h.value_or(0));
  for (const QueryRow& r : rows)
    RETURN_IF_ERROR(days.add(r.signature.season, r.signature.time_utc));
  std::vector<HourOfDay> hours;
  for (const QueryRow& r : rows)
    hours.push_back(days.place(r.signature.season, r.signature.time_utc));
  RETURN_IF_ERROR(check_two_times(hours));

  LoopProgress progress("images read", rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const StoredSignature& row = rows[i].signature;
    ASSIGN_OR_RETURN(
        const auto pixels,
        layer_pixels(reader, row, layer, row.superseded ? kMostPixels : most_px_of(sweep), read));
    ASSIGN_OR_RETURN(const auto silhouette, silhouette_of(reader, row));
    for (const RadianceImage* image :
         {&pixels.value, &pixels.stderr_, &pixels.temperature, &pixels.land_temperature})
      if (!fits(*image, silhouette))
        return damaged_image(row, "the silhouette is of another size than the image");
    auto regions = rectangle_regions(rectangles, silhouette.width_px, silhouette.height_px);
    if (!regions.ok()) return regions.status();
    if (rectangles.empty()) *regions = part_regions(silhouette);
    const std::vector<float> filled = filled_fractions(silhouette);
    const ImageNumbers numbers{pixels.value.radiance_w_m2_sr,
                               pixels.stderr_.radiance_w_m2_sr,
                               pixels.temperature.radiance_w_m2_sr,
                               pixels.land_temperature.radiance_w_m2_sr,
                               filled,
                               sweep.has_land() && !sweep.has_heat()};
    for (const ImageRegion& region : *regions)
      out.value.push_back(
          {hours[i], row, region.name, region.pixel.size(), region_mean(region, numbers)});
    progress.step(1);
  }
  sort_in_order(out.value);
  return out;
}

absl::Status write_region_hours(const RegionHours& hours, std::string_view format,
                                std::ostream& out) {
  const std::vector<Column> columns = {{"sweep"},
                                       {"day"},
                                       {"season"},
                                       {"time_utc"},
                                       {hours.solar_offset_h ? "solar_time_h" : "utc_h"},
                                       {"band"},
                                       {"aspect_azimuth_deg"},
                                       {"aspect_elevation_deg"},
                                       {"range_m"},
                                       {"row"},
                                       {"layer"},
                                       {"region"},
                                       {"region_px"},
                                       {"radiance_w_m2_sr"},
                                       {"radiance_stderr_w_m2_sr"},
                                       {"target_fraction"},
                                       {"temperature_k"}};
  ASSIGN_OR_RETURN(const auto table, make_table_writer(format, columns, out));
  const auto known = [](double value) { return std::isnan(value) ? Cell() : Cell(value); };
  for (const RegionValue& v : hours.value)
    table->row({v.row.sweep, v.at.day, v.row.season, v.row.time_utc, v.at.hour, v.row.band,
                v.row.aspect_azimuth_deg, v.row.aspect_elevation_deg, v.row.range_m, v.row.row,
                hours.layer, v.region, v.pixels, v.mean.radiance_w_m2_sr,
                known(v.mean.stderr_w_m2_sr), v.mean.target_fraction, known(v.mean.temperature_k)});
  return table->finish();
}

}  // namespace irsig
