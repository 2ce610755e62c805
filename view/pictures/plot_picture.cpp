#include "view/pictures/plot_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/accuracy/image_layers.h"
#include "core/base/status_macros.h"
#include "view/pictures/band_quadrature.h"
#include "view/pictures/masks.h"
#include "view/pictures/sheet_layout.h"
#include "view/pictures/thumbnail.h"
#include "view/plot/plot_frame.h"

namespace irsig {
namespace {

absl::StatusOr<BandQuadrature> band_of(StoreReader& reader, const StoredSignature& s) {
  ASSIGN_OR_RETURN(const auto sweep, reader.sweep(s.sweep, SweepFiles::kNone));
  for (const schema::Band& b : sweep.resolved.sweep().band()) {
    if (b.name() == s.band) return band_quadrature(b);
  }
  return absl::FailedPreconditionError(
      fmt::format("row {} is of band {}, which its sweep no longer has", s.row, s.band));
}

// Row by row from the top left. [W/(m2 sr)]; NaN: nothing of the target.
struct Pixels {
  std::uint32_t width_px = 0, height_px = 0;
  std::vector<float> radiance_w_m2_sr;
};

// Means over squares of `side` x `side` pixels; beyond the edges is nothing.
std::vector<double> coarser(const std::vector<float>& fine, std::uint32_t width_px,
                            std::uint32_t height_px, std::uint32_t side) {
  const std::uint32_t columns = (width_px + side - 1) / side;
  std::vector<double> out(std::size_t{columns} * ((height_px + side - 1) / side), 0.0);
  for (std::uint32_t y = 0; y < height_px; ++y)
    for (std::uint32_t x = 0; x < width_px; ++x)
      out[std::size_t{y / side} * columns + x / side] +=
          static_cast<double>(fine[std::size_t{y} * width_px + x]) /
          (static_cast<double>(side) * side);
  return out;
}

// Quantity of a picture's numbers.
enum class Shows : std::uint8_t {
  kTarget,  // radiance times the fraction of the pixel that the target fills
  kTargetAndGas,
  kOfTarget,  // a mean over what the pixel shows of the target
  kAll,       // whatever stands there
  kLand       // a mean over land, 0 where there is none
};

Shows what_is_shown(const std::string& layer, bool gas) {
  if (layer.empty()) return gas ? Shows::kTargetAndGas : Shows::kTarget;
  const auto known = image_layer_of(layer);
  if (!known || *known == ImageLayer::kAtSensor || *known == ImageLayer::kBackground ||
      *known == ImageLayer::kPath || is_of_gas(*known) ||
      (is_of_land(*known) && is_radiance(*known)))
    return Shows::kAll;
  if (*known == ImageLayer::kLandTemperature) return Shows::kLand;
  return is_mean_of_target(*known) ? Shows::kOfTarget : Shows::kTarget;
}

// The target's own radiance where it fills at least half of a pixel; of a target that does so
// nowhere, wherever it is seen. Before and behind gas: what is sent, by target and gas together.
Pixels shown(const PictureAnswer& stored, const StoredSilhouette& silhouette, Shows what,
             std::uint32_t side) {
  Pixels out{(stored.width_px + side - 1) / side, (stored.height_px + side - 1) / side, {}};
  std::vector<float> numbers = stored.pixel;
  const std::vector<float> fraction = filled_fractions(silhouette);
  if (what == Shows::kOfTarget)
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] *= fraction[i];
  const std::vector<double> sent = coarser(numbers, stored.width_px, stored.height_px, side);
  const std::vector<double> filled = coarser(fraction, stored.width_px, stored.height_px, side);
  const double most = *std::max_element(filled.begin(), filled.end());
  const double least = most < 0.5 ? std::numeric_limits<double>::min() : 0.5 - 1e-9;
  for (std::size_t i = 0; i < sent.size(); ++i) {
    const bool own = what == Shows::kTarget || what == Shows::kOfTarget;
    const double value = own ? sent[i] / filled[i] : sent[i];
    const bool seen = own ? filled[i] >= least : what == Shows::kAll || sent[i] != 0;
    out.radiance_w_m2_sr.push_back(seen ? static_cast<float>(value)
                                        : std::numeric_limits<float>::quiet_NaN());
  }
  return out;
}

// A row with the stored image that it shall show.
struct StoredImage {
  StoredSignature signature;
  std::string exr;
  std::uint32_t width_px = 0, height_px = 0;
  StoredSilhouette silhouette;
};

absl::StatusOr<StoredImage> image_of(StoreReader& reader, const std::vector<QueryRow>& row,
                                     const std::string& layer) {
  ASSIGN_OR_RETURN(auto thumbnail, stored_thumbnail(reader, row));
  const StoredSignature& s = row.front().signature;
  auto silhouette = reader.silhouette(s.signature_id);
  if (silhouette.ok() && !silhouette->has_value())
    silhouette = absl::DataLossError("it has no silhouette");
  if (absl::IsDataLoss(silhouette.status()))
    return absl::DataLossError(fmt::format("the stored image of row {} is damaged: {}", s.row,
                                           std::string(silhouette.status().message())));
  if (!silhouette.ok()) return silhouette.status();
  StoredImage out{s, std::move(*thumbnail.mutable_exr()), thumbnail.width_px(),
                  thumbnail.height_px(), **std::move(silhouette)};
  if (!layer.empty()) {
    ASSIGN_OR_RETURN(auto stored, stored_layer(reader, s, layer));
    out.exr = std::move(*stored.mutable_exr());
  }
  return out;
}

//   long_side_px  absent: as it is stored
absl::StatusOr<std::vector<Pixels>> pixels_of(StoreReader& reader,
                                              const std::vector<StoredImage>& images,
                                              const std::string& layer,
                                              const std::optional<std::uint32_t>& long_side_px,
                                              const ReadPictures& read) {
  std::vector<PictureTask> tasks;
  for (const StoredImage& image : images) {
    ASSIGN_OR_RETURN(const auto most_px, most_px_of(reader, image.signature));
    tasks.push_back({.exr = image.exr, .most_px = most_px, .paint = false, .pixels = true});
  }
  ASSIGN_OR_RETURN(const auto answers, read(tasks));
  if (answers.size() != images.size())
    return absl::InternalError(
        fmt::format("{} of {} images were read", answers.size(), images.size()));
  std::vector<Pixels> out;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const StoredSignature& s = images[i].signature;
    const PictureAnswer& stored = answers[i];
    const StoredSilhouette& silhouette = images[i].silhouette;
    if (stored.damage.empty() &&
        (silhouette.width_px != stored.width_px || silhouette.height_px != stored.height_px))
      return absl::DataLossError(
          fmt::format("the silhouette of row {} is of another size than its image", s.row));
    if (!stored.damage.empty())
      return absl::DataLossError(
          fmt::format("the stored image of row {} is damaged: {}", s.row, stored.damage));
    const std::uint32_t longest = std::max(stored.width_px, stored.height_px);
    if (long_side_px && *long_side_px > longest)
      return absl::InvalidArgumentError(
          fmt::format("--pixels {}: the stored image has {}", *long_side_px, longest));
    const std::uint32_t side = long_side_px ? (longest + *long_side_px - 1) / *long_side_px : 1;
    out.push_back(shown(stored, silhouette, what_is_shown(layer, !std::isnan(s.plume_w_sr)), side));
  }
  return out;
}

// From the first to the 99th percentile, so that few hot pixels leave the others their colours; of
// pixels that are alike, from the smallest to the largest.
absl::StatusOr<ColorRange> range_of_most(const std::vector<float>& values) {
  std::vector<float> sorted;
  for (const float v : values)
    if (!std::isnan(v)) sorted.push_back(v);
  std::sort(sorted.begin(), sorted.end());
  const std::size_t tail = sorted.size() / 100;
  if (tail == 0 || !(sorted[tail] < sorted[sorted.size() - 1 - tail])) return range_of(values);
  return ColorRange{static_cast<double>(sorted[tail]),
                    static_cast<double>(sorted[sorted.size() - 1 - tail])};
}

// Returns the title of the axis for a layer that is no radiance.
std::string axis_title(ImageLayer layer) {
  switch (layer) {
    case ImageLayer::kTemperature:
    case ImageLayer::kLandTemperature:
      return "Temperature in K";
    case ImageLayer::kRange:
      return "Distance from the sensor in m";
    case ImageLayer::kSunlit:
      return "Fraction in the sun";
    default:
      return "Component of the normal";
  }
}

// Counts are numbers of the camera's own pixels.
absl::Status check_counts_pixels(const std::optional<std::uint32_t>& long_side_px) {
  return long_side_px ? absl::InvalidArgumentError(
                            "--pixels: a picture of counts has the pixels of the sweep's imager; "
                            "state --no-imager for stored radiance")
                      : absl::OkStatus();
}

Pixels pixels_of(const CountsImage& counts) {
  Pixels out{counts.width_px, counts.height_px, {}};
  out.radiance_w_m2_sr.assign(counts.counts.begin(), counts.counts.end());
  return out;
}

// Colours of counts; beside them the in-band radiance at the sensor.
absl::Status finish_counts(const SweepImager& imager, const ImagerInBand& figures,
                           const std::optional<ColorRange>& range, FalseColorPicture& picture) {
  ASSIGN_OR_RETURN(const auto own, range_of_most(picture.value));
  picture.range = range.value_or(own);
  picture.subtitle = fmt::format(
      "Counts of {}, {} bits. Colours from the 1st to the 99th percentile unless stated",
      imager.name, imager.imager.bits);
  picture.axis = bar_axis("Counts", picture.range);
  const auto radiance = [&](double counts) {
    return (counts - figures.offset_counts) / figures.counts_per_w_m2_sr;
  };
  BarAxis other = bar_axis("In-band radiance at the sensor in W/(m\u00b2 sr)",
                           {radiance(picture.range.low), radiance(picture.range.high)});
  for (double& at : other.at) at = figures.counts_per_w_m2_sr * at + figures.offset_counts;
  picture.other = std::move(other);
  return absl::OkStatus();
}

// Title, colours and axes of a picture whose pixels are there.
absl::Status finish(StoreReader& reader, const StoredSignature& s, const std::string& layer,
                    const std::optional<ColorRange>& range, FalseColorPicture& picture) {
  ASSIGN_OR_RETURN(const auto own, range_of_most(picture.value));
  picture.range = range.value_or(own);
  if (const auto known = image_layer_of(layer); known && !is_radiance(*known)) {
    picture.axis = bar_axis(axis_title(*known), picture.range);
    return absl::OkStatus();
  }
  ASSIGN_OR_RETURN(const auto band, band_of(reader, s));
  picture.axis = bar_axis("In-band radiance in W/(m\u00b2 sr)", picture.range);
  picture.other = temperature_axis(band, picture.range);
  return absl::OkStatus();
}

std::string aspect_title(const StoredSignature& s) {
  return fmt::format("azimuth {:.1f}\u00b0, elevation {:.1f}\u00b0", s.aspect_azimuth_deg,
                     s.aspect_elevation_deg);
}

std::string subtitle_of(const std::string& layer) {
  const auto known = image_layer_of(layer);
  std::string what = known ? kImageLayers[static_cast<std::size_t>(*known)].what
                           : "radiance at the target, without the air";
  what[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(what[0])));
  what += ". Colours from the 1st to the 99th percentile unless stated";
  if (what_is_shown(layer, false) == Shows::kLand)
    what += ". Grey: no land";
  else if (what_is_shown(layer, false) != Shows::kAll)
    what +=
        ". Grey: less than half of the pixel is target, or nothing of a small one or of its gas";
  return what;
}

// Pictures in a sheet, and its pixels: those of 200 images of 512 x 512.
constexpr std::size_t kMostInSheet = 200;
constexpr std::size_t kMostPixelsInSheet = 200 * 512 * 512;

}  // namespace

absl::StatusOr<FalseColorPicture> radiance_picture(StoreReader& reader, const Query& query,
                                                   const std::optional<ColorRange>& range,
                                                   const std::optional<std::uint32_t>& long_side_px,
                                                   const ReadPictures& read,
                                                   const std::string& layer,
                                                   const std::optional<SweepImager>& imager) {
  Query asked = query;
  if (asked.aspect && !asked.nearest && !asked.within_deg && !asked.interpolate) asked.nearest = 1;
  ASSIGN_OR_RETURN(const auto rows, run_query(reader, asked));
  ASSIGN_OR_RETURN(auto image, image_of(reader, rows, layer));
  const StoredSignature s = image.signature;
  std::vector<Pixels> pixels;
  std::optional<ImagerInBand> figures;
  if (imager) {
    RETURN_IF_ERROR(check_counts_pixels(long_side_px));
    ASSIGN_OR_RETURN(const auto recorded, counts_of_row(reader, *imager, s, read));
    pixels.push_back(pixels_of(recorded.counts));
    figures = recorded.figures;
  } else {
    std::vector<StoredImage> images;
    images.push_back(std::move(image));
    ASSIGN_OR_RETURN(pixels, pixels_of(reader, images, layer, long_side_px, read));
  }
  FalseColorPicture out;
  out.title = fmt::format("{}, {} {}, {}, {}, {}", s.sweep, s.season, s.time_utc, band_title(s),
                          aspect_title(s), range_title(s.range_m));
  out.subtitle = subtitle_of(layer);
  out.width_px = pixels[0].width_px;
  out.height_px = pixels[0].height_px;
  out.value = std::move(pixels[0].radiance_w_m2_sr);
  RETURN_IF_ERROR(figures ? finish_counts(*imager, *figures, range, out)
                          : finish(reader, s, layer, range, out));
  return out;
}

absl::StatusOr<FalseColorPicture> sheet_picture(StoreReader& reader, const Query& query,
                                                const std::optional<ColorRange>& range,
                                                const std::optional<std::uint32_t>& long_side_px,
                                                const ReadPictures& read, const std::string& layer,
                                                const std::optional<SweepImager>& imager) {
  if (query.interpolate)
    return absl::InvalidArgumentError("--kind sheet: images are not interpolated, use --nearest");
  ASSIGN_OR_RETURN(const auto rows, run_query(reader, query));
  if (rows.empty()) return absl::NotFoundError("nothing to draw: no signature matches the filters");
  if (rows.size() > kMostInSheet)
    return absl::InvalidArgumentError(
        fmt::format("a sheet of {} images: expected at most {}: choose some with --season, --time, "
                    "--nearest or --within-deg",
                    rows.size(), kMostInSheet));
  const StoredSignature& first = rows.front().signature;
  bool one_season = true, one_time = true, one_place = true, one_range = true;
  std::size_t stored_px = 0;
  std::map<std::string, std::string> time_of;  // of a season, if it has one
  std::vector<StoredImage> images;
  for (const QueryRow& row : rows) {
    const StoredSignature& s = row.signature;
    if (s.sweep != first.sweep || s.band != first.band)
      return absl::InvalidArgumentError(
          "a sheet has images of one sweep and band: choose them with --sweep and --band");
    one_season &= s.season == first.season;
    one_time &= time_of.emplace(s.season, s.time_utc).first->second == s.time_utc;
    one_range &= s.range_m == first.range_m;
    one_place &= s.aspect_azimuth_deg == first.aspect_azimuth_deg &&
                 s.aspect_elevation_deg == first.aspect_elevation_deg;
    ASSIGN_OR_RETURN(auto image, image_of(reader, {row}, layer));
    stored_px += std::size_t{image.width_px} * image.height_px;
    if (stored_px > kMostPixelsInSheet)
      return absl::InvalidArgumentError(
          fmt::format("a sheet of {} such large images: expected at most {} pixels in all: choose "
                      "fewer with --season, --time, --nearest or --within-deg",
                      rows.size(), kMostPixelsInSheet));
    images.push_back(std::move(image));
  }
  std::vector<Pixels> pixels;
  std::optional<ImagerInBand> figures;
  if (imager) {
    RETURN_IF_ERROR(check_counts_pixels(long_side_px));
    for (const StoredImage& image : images) {
      ASSIGN_OR_RETURN(const auto recorded, counts_of_row(reader, *imager, image.signature, read));
      pixels.push_back(pixels_of(recorded.counts));
      figures = recorded.figures;
    }
  } else {
    ASSIGN_OR_RETURN(pixels, pixels_of(reader, images, layer, long_side_px, read));
  }
  std::vector<SheetCell> cells;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const StoredSignature& s = images[i].signature;
    std::string text;
    const auto add = [&](bool same, const std::string& what) {
      if (!same) text += (text.empty() ? "" : ", ") + what;
    };
    add(one_season, s.season);
    add(one_time, s.time_utc);
    add(one_place,
        fmt::format("{:.0f}\u00b0, {:.0f}\u00b0", s.aspect_azimuth_deg, s.aspect_elevation_deg));
    add(one_range, range_title(s.range_m));
    cells.push_back({pixels[i].width_px, pixels[i].height_px, std::move(pixels[i].radiance_w_m2_sr),
                     std::move(text)});
  }
  FalseColorPicture out = lay_out_sheet(cells);
  out.title = fmt::format("{}, {}", first.sweep, band_title(first));
  if (one_range) out.title += ", " + range_title(first.range_m);
  if (one_season) out.title += ", " + first.season;
  if (one_season && one_time) out.title += " " + first.time_utc;
  if (one_place) out.title += ", " + aspect_title(first);
  out.subtitle = subtitle_of(layer);
  RETURN_IF_ERROR(figures ? finish_counts(*imager, *figures, range, out)
                          : finish(reader, first, layer, range, out));
  return out;
}

}  // namespace irsig
