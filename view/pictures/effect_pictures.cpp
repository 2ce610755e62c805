#include "view/pictures/effect_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>

#include "core/accuracy/image_layers.h"
#include "core/base/status_macros.h"
#include "view/base/table.h"
#include "view/pictures/sheet_layout.h"
#include "view/pictures/shown_image.h"
#include "view/plot/plot_curves.h"
#include "view/plot/plot_frame.h"

namespace irsig {
namespace {

// Layers that the pictures are made of.
constexpr std::array kNeeded = {ImageLayer::kAtSensor, ImageLayer::kSun,
                                ImageLayer::kSky,      ImageLayer::kLandSun,
                                ImageLayer::kLandSky,  ImageLayer::kWithoutAir};

absl::StatusOr<std::array<RadianceImage, kNeeded.size()>> needed_layers(StoreReader& reader,
                                                                        const StoredSignature& row,
                                                                        const ReadPictures& read) {
  std::string missing, wanted;
  std::vector<schema::ImageLayer> stored;
  for (const ImageLayer layer : kNeeded) {
    const std::string name = name_of(layer);
    ASSIGN_OR_RETURN(auto one, reader.image_layer(row.signature_id, name));
    wanted += (wanted.empty() ? "\"" : ", \"") + name + "\"";
    if (!one) missing += (missing.empty() ? "" : ", ") + name;
    if (one) stored.push_back(*std::move(one));
  }
  if (!missing.empty())
    return absl::NotFoundError(
        fmt::format("the image of row {} lacks the layers {}: add layers = [{}] to [image] of a "
                    "sweep file with [land] and run it again",
                    row.row, missing, wanted));
  ASSIGN_OR_RETURN(const auto most_px, most_px_of(reader, row));
  std::vector<ShownImage> files;
  for (const schema::ImageLayer& one : stored) files.push_back({one.exr(), most_px});
  std::array<RadianceImage, kNeeded.size()> out;
  RETURN_IF_ERROR(
      visit_images(files, read, [&](std::size_t i, absl::StatusOr<RadianceImage> image) {
        if (!image.ok())
          return absl::DataLossError(fmt::format("the stored image of row {} is damaged: {}",
                                                 row.row, std::string(image.status().message())));
        out[i] = *std::move(image);
        return absl::OkStatus();
      }));
  for (const RadianceImage& image : out)
    if (image.width_px != out[0].width_px || image.height_px != out[0].height_px)
      return absl::DataLossError(
          fmt::format("the stored image of row {} is damaged: its layers differ in size", row.row));
  return out;
}

// Pixels from the top left to the bottom right corner, as many as along the long side.
std::vector<std::size_t> diagonal(const EffectPictures& of) {
  const std::size_t width = of.width_px, height = of.height_px, count = std::max(width, height);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < count; ++i)
    out.push_back((2 * i + 1) * height / (2 * count) * width + (2 * i + 1) * width / (2 * count));
  return out;
}

std::string effects_title(const StoredSignature& s) {
  return fmt::format("{}, {}, {}", s.sweep, s.time_utc, band_title(s));
}

}  // namespace

absl::StatusOr<EffectPictures> effect_pictures(StoreReader& reader, const Query& query,
                                               const ReadPictures& read) {
  Query asked = query;
  if (asked.aspect && !asked.nearest && !asked.within_deg && !asked.interpolate) asked.nearest = 1;
  ASSIGN_OR_RETURN(const auto rows, run_query(reader, asked));
  RETURN_IF_ERROR(stored_thumbnail(reader, rows).status());
  EffectPictures out{rows.front().signature, 0, 0, {}};
  ASSIGN_OR_RETURN(const auto layers, needed_layers(reader, out.row, read));
  const auto& [all, sun, sky, land_sun, land_sky, without_air] = layers;
  out.width_px = all.width_px;
  out.height_px = all.height_px;
  for (std::size_t i = 0; i < all.radiance_w_m2_sr.size(); ++i) {
    const auto at = [i](const RadianceImage& image) {
      return static_cast<double>(image.radiance_w_m2_sr[i]);
    };
    const double of_sun = at(sun) + at(land_sun), of_sky = at(sky) + at(land_sky),
                 emitted = at(all) - of_sun - of_sky;
    const std::array<double, 5> value = {at(without_air), emitted, emitted + of_sky,
                                         emitted + of_sun, at(all)};
    for (std::size_t k = 0; k < value.size(); ++k)
      out.w_m2_sr[k].push_back(static_cast<float>(value[k]));
  }
  return out;
}

absl::StatusOr<FalseColorPicture> effects_sheet(const EffectPictures& pictures,
                                                const std::optional<ColorRange>& range) {
  std::vector<SheetCell> cells;
  for (std::size_t k = 0; k < pictures.w_m2_sr.size(); ++k)
    cells.push_back(
        {pictures.width_px, pictures.height_px, pictures.w_m2_sr[k], EffectPictures::kName[k]});
  FalseColorPicture out = lay_out_sheet(cells);
  out.title = effects_title(pictures.row);
  out.subtitle = "One image with and without the effects that its light meets; e = c + d \u2212 b";
  ASSIGN_OR_RETURN(const auto own, range_of(out.value));
  out.range = range.value_or(own);
  out.axis = bar_axis("In-band radiance in W/(m\u00b2 sr)", out.range);
  return out;
}

std::string plot_diagonal(const EffectPictures& pictures) {
  const std::vector<std::size_t> pixel = diagonal(pictures);
  CurvePanel panel{
      "", "Pixel along the diagonal, from the top left", "Radiance in W/(m\u00b2 sr)", {}, 0, 0,
      {}};
  for (std::size_t k = 0; k < pictures.w_m2_sr.size(); ++k) {
    Curve& curve = panel.curve.emplace_back();
    curve.name = EffectPictures::kName[k];
    for (std::size_t i = 0; i < pixel.size(); ++i) {
      curve.x.push_back(static_cast<double>(i));
      curve.y.push_back(static_cast<double>(pictures.w_m2_sr[k][pixel[i]]));
    }
  }
  return plot_curves(effects_title(pictures.row), "Radiance along the diagonal, by effects", {panel}, 1);
}

absl::Status write_diagonal(const EffectPictures& pictures, std::string_view format,
                            std::ostream& out) {
  const StoredSignature& s = pictures.row;
  ASSIGN_OR_RETURN(const auto table, make_table_writer(format,
                                                       {{"sweep"},
                                                        {"row"},
                                                        {"season"},
                                                        {"time_utc"},
                                                        {"band"},
                                                        {"diagonal_px"},
                                                        {"x_px"},
                                                        {"y_px"},
                                                        {"without_air_w_m2_sr"},
                                                        {"emitted_w_m2_sr"},
                                                        {"with_sky_w_m2_sr"},
                                                        {"with_sun_w_m2_sr"},
                                                        {"all_w_m2_sr"}},
                                                       out));
  const std::vector<std::size_t> pixel = diagonal(pictures);
  for (std::size_t i = 0; i < pixel.size(); ++i) {
    const auto at = [&](std::size_t k) {
      return static_cast<double>(pictures.w_m2_sr[k][pixel[i]]);
    };
    table->row({s.sweep, s.row, s.season, s.time_utc, s.band, std::uint64_t{i},
                std::uint64_t{pixel[i] % pictures.width_px},
                std::uint64_t{pixel[i] / pictures.width_px}, at(0), at(1), at(2), at(3), at(4)});
  }
  return table->finish();
}

}  // namespace irsig
