#include "view/pictures/thumbnail.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"
#include "core/base/status_macros.h"
#include "schema/store/check/check_picture.h"
#include "view/base/atomic_file.h"
#include "view/base/progress.h"
#include "view/draw/png.h"

namespace irsig {
namespace {

constexpr std::size_t kListed = 12;

std::string listed_rows(const std::vector<QueryRow>& rows) {
  std::string out;
  for (std::size_t i = 0; i < std::min(rows.size(), kListed); ++i) {
    const StoredSignature& s = rows[i].signature;
    out +=
        fmt::format("\n  --row {}: {}, {}, {}, aspect {:.2f},{:.2f} deg, {:g} m", s.row, s.season,
                    s.time_utc, s.band, s.aspect_azimuth_deg, s.aspect_elevation_deg, s.range_m);
  }
  if (rows.size() > kListed) out += fmt::format("\n  and {} more", rows.size() - kListed);
  return out;
}

struct ThumbnailScale {
  float black_w_m2_sr = 0, white_w_m2_sr = 1;
};
absl::StatusOr<ThumbnailScale> parse_thumbnail_scale(const std::string& scale) {
  const std::vector<std::string> ends = absl::StrSplit(scale, ',');
  double black = 0, white = 0;
  if (scale == "common") return ThumbnailScale{};
  if (ends.size() == 2 && absl::SimpleAtod(ends[0], &black) && absl::SimpleAtod(ends[1], &white) &&
      black < white && std::isfinite(black) && std::isfinite(white))
    return ThumbnailScale{static_cast<float>(black), static_cast<float>(white)};
  return absl::InvalidArgumentError(fmt::format(
      "thumbnail scale {}: expected common, or BLACK,WHITE in W/(m2 sr) as 0,12.5", scale));
}

// As many as one call of the program gets: images of 20 kB, 10 MB.
constexpr std::size_t kThumbnailsAtOnce = 500;

// The hottest pixel of all images of a sweep in a band.
absl::StatusOr<float> hottest_like(StoreReader& reader, const StoredSignature& like,
                                   std::uint32_t most_px, const ReadPictures& read) {
  SignatureFilter filter;
  filter.sweep = like.sweep;
  filter.band = like.band;
  ASSIGN_OR_RETURN(const auto rows, reader.find(filter));
  LoopProgress progress("images compared", rows.size());
  float hottest = 0;
  std::vector<PictureTask> tasks;
  const auto look = [&]() -> absl::Status {
    ASSIGN_OR_RETURN(const auto answers, read(tasks));
    for (const PictureAnswer& answer : answers) {
      if (!answer.damage.empty())
        return absl::DataLossError(
            fmt::format("of the images that share the scale one cannot be read (irsig export "
                        "--thumbnails says which): {}",
                        answer.damage));
      hottest = std::max(hottest, answer.hottest_w_m2_sr);
    }
    progress.step(tasks.size());
    tasks.clear();
    return absl::OkStatus();
  };
  for (const StoredSignature& s : rows) {
    ASSIGN_OR_RETURN(auto thumbnail, reader.thumbnail(s.signature_id));
    if (!thumbnail.has_value()) continue;
    tasks.push_back({.exr = std::move(*thumbnail->mutable_exr()),
                     .most_px = s.superseded ? kMostPixels : most_px});
    if (tasks.size() < kThumbnailsAtOnce) continue;
    RETURN_IF_ERROR(look());
  }
  if (!tasks.empty()) RETURN_IF_ERROR(look());
  return hottest;
}

}  // namespace

absl::StatusOr<schema::Thumbnail> stored_thumbnail(StoreReader& reader,
                                                   const std::vector<QueryRow>& rows) {
  if (rows.empty()) return absl::InvalidArgumentError("thumbnail: no signature matches");
  if (rows.size() > 1) {
    return absl::InvalidArgumentError(fmt::format("thumbnail: {} signatures match, choose one:{}",
                                                  rows.size(), listed_rows(rows)));
  }
  if (rows.front().interpolation) {
    return absl::InvalidArgumentError("thumbnail: images are not interpolated, use nearest");
  }
  ASSIGN_OR_RETURN(auto thumbnail, reader.thumbnail(rows.front().signature.signature_id));
  if (!thumbnail.has_value()) {
    return absl::NotFoundError(fmt::format(
        "row {} was computed without image (output.thumbnail_px = 0)", rows.front().signature.row));
  }
  return *std::move(thumbnail);
}

absl::StatusOr<schema::ImageLayer> stored_layer(StoreReader& reader, const StoredSignature& row,
                                                const std::string& name) {
  ASSIGN_OR_RETURN(auto layer, reader.image_layer(row.signature_id, name));
  if (layer) return *std::move(layer);
  ASSIGN_OR_RETURN(const auto layers, reader.image_layers(row.signature_id));
  std::string names;
  for (const schema::ImageLayer& one : layers) names += (names.empty() ? "" : ", ") + one.name();
  return absl::NotFoundError(
      fmt::format("the image of row {} has no layer {}: {}", row.row, name,
                  names.empty() ? "it has none; the sweep asks for them with [image] layers"
                                : "it has " + names));
}

std::uint32_t most_px_of(const schema::Sweep& sweep) {
  const schema::Output& output = sweep.output();
  return output.has_thumbnail_px() ? std::min(output.thumbnail_px(), kMostPixels) : kMostPixels;
}

absl::StatusOr<std::uint32_t> most_px_of(StoreReader& reader, const StoredSignature& row) {
  if (row.superseded) return kMostPixels;
  ASSIGN_OR_RETURN(const auto sweep, reader.sweep(row.sweep));
  return most_px_of(sweep.resolved.sweep());
}

absl::Status write_thumbnail(StoreReader& reader, const std::vector<QueryRow>& rows,
                             const std::string& path, const std::string& scale,
                             const ReadPictures& read) {
  const bool png = path.ends_with(".png");
  if (!png && !path.ends_with(".exr")) {
    return absl::InvalidArgumentError(
        fmt::format("thumbnail {}: expected a name that ends in .png or .exr", path));
  }
  if (!png && !scale.empty())
    return absl::InvalidArgumentError("thumbnail scale: .exr files hold radiance, without a scale");
  ThumbnailScale grey;
  if (!scale.empty()) {
    ASSIGN_OR_RETURN(grey, parse_thumbnail_scale(scale));
  }
  ASSIGN_OR_RETURN(auto thumbnail, stored_thumbnail(reader, rows));
  const StoredSignature& row = rows.front().signature;
  const auto damaged = [&](std::string_view what) {
    return absl::DataLossError(
        fmt::format("the stored image of row {} is damaged: {}", row.row, what));
  };
  if (png && scale.empty()) {
    const std::string defect = png_defect(thumbnail.png());
    return defect.empty() ? replace_file(path, thumbnail.png()) : damaged(defect);
  }
  if (!read) return replace_file(path, thumbnail.exr());
  // Try pixels that no checksum guards.
  ASSIGN_OR_RETURN(const auto most_px, most_px_of(reader, row));
  std::vector<PictureTask> task = {{.exr = thumbnail.exr(), .most_px = most_px}};
  const auto answer = [&]() -> absl::StatusOr<PictureAnswer> {
    ASSIGN_OR_RETURN(auto answers, read(task));
    if (answers.size() != 1) return absl::InternalError("one image was asked for");
    if (const std::string& damage = answers[0].damage; !damage.empty()) return damaged(damage);
    return std::move(answers[0]);
  };
  if (const auto tried = answer(); !tried.ok()) return tried.status();
  if (!png) return replace_file(path, thumbnail.exr());
  if (scale == "common") {
    ASSIGN_OR_RETURN(const auto hottest, hottest_like(reader, row, most_px, read));
    grey = {0, hottest};
  }
  task[0].paint = true;
  task[0].black_w_m2_sr = grey.black_w_m2_sr;
  task[0].white_w_m2_sr = grey.white_w_m2_sr;
  ASSIGN_OR_RETURN(const auto painted, answer());
  return replace_file(path, painted.png);
}

}  // namespace irsig
