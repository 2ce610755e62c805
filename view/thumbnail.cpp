#include "view/thumbnail.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"
#include "view/atomic_file.h"
#include "view/png.h"
#include "view/progress.h"

namespace irsig {
namespace {

constexpr std::size_t kListed = 12;

std::string listed(const std::vector<QueryRow>& rows) {
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

absl::Status check_scale(const std::string& scale) {
  const std::vector<std::string> ends = absl::StrSplit(scale, ',');
  double black = 0, white = 0;
  if (scale == "common" ||
      (ends.size() == 2 && absl::SimpleAtod(ends[0], &black) && absl::SimpleAtod(ends[1], &white) &&
       black < white && std::isfinite(black) && std::isfinite(white)))
    return absl::OkStatus();
  return absl::InvalidArgumentError(fmt::format(
      "thumbnail scale {}: expected common, or BLACK,WHITE in W/(m2 sr) as 0,12.5", scale));
}

// The images of a sweep in a band, one after the other.
absl::StatusOr<NextExr> images_like(StoreReader& reader, const StoredSignature& like) {
  SignatureFilter filter;
  filter.sweep = like.sweep;
  filter.band = like.band;
  auto rows = reader.find(filter);
  if (!rows.ok()) return rows.status();
  const auto progress = std::make_shared<LoopProgress>("images compared", rows->size());
  return NextExr([&reader, progress, rows = *std::move(rows),
                  next = std::size_t{0}]() mutable -> absl::StatusOr<std::string> {
    while (next < rows.size()) {
      progress->step();
      const auto thumbnail = reader.thumbnail(rows[next++].signature_id);
      if (!thumbnail.ok()) return thumbnail.status();
      if (thumbnail->has_value()) return (*thumbnail)->exr();
    }
    return std::string();
  });
}

}  // namespace

absl::StatusOr<schema::Thumbnail> stored_thumbnail(StoreReader& reader,
                                                   const std::vector<QueryRow>& rows) {
  if (rows.empty()) return absl::InvalidArgumentError("thumbnail: no signature matches");
  if (rows.size() > 1) {
    return absl::InvalidArgumentError(
        fmt::format("thumbnail: {} signatures match, choose one:{}", rows.size(), listed(rows)));
  }
  if (rows.front().interpolation) {
    return absl::InvalidArgumentError("thumbnail: images are not interpolated, use nearest");
  }
  auto thumbnail = reader.thumbnail(rows.front().signature.signature_id);
  if (!thumbnail.ok()) return thumbnail.status();
  if (!thumbnail->has_value()) {
    return absl::NotFoundError(fmt::format(
        "row {} was computed without image (output.thumbnail_px = 0)", rows.front().signature.row));
  }
  return **std::move(thumbnail);
}

absl::Status write_thumbnail(StoreReader& reader, const std::vector<QueryRow>& rows,
                             const std::string& path, const std::string& scale,
                             const PaintPng& paint) {
  const bool png = path.ends_with(".png");
  if (!png && !path.ends_with(".exr")) {
    return absl::InvalidArgumentError(
        fmt::format("thumbnail {}: expected a name that ends in .png or .exr", path));
  }
  if (!png && !scale.empty())
    return absl::InvalidArgumentError("thumbnail scale: .exr files hold radiance, without a scale");
  if (!scale.empty())
    if (absl::Status status = check_scale(scale); !status.ok()) return status;
  const auto thumbnail = stored_thumbnail(reader, rows);
  if (!thumbnail.ok()) return thumbnail.status();
  const auto damaged = [&](std::string_view what) {
    return absl::DataLossError(
        fmt::format("the stored image of row {} is damaged: {}", rows.front().signature.row, what));
  };
  const NextExr none = [] { return std::string(); };
  if (!png || !scale.empty())  // what no checksum guards is tried
    if (const auto tried = paint ? paint(thumbnail->exr(), "0,1", none) : ""; !tried.ok())
      return absl::IsDataLoss(tried.status()) ? damaged(std::string(tried.status().message()))
                                              : tried.status();
  if (!png) return replace_file(path, thumbnail->exr());
  if (scale.empty()) {
    const std::string defect = png_defect(thumbnail->png());
    return defect.empty() ? replace_file(path, thumbnail->png()) : damaged(defect);
  }
  NextExr others = none;
  if (scale == "common") {
    auto all = images_like(reader, rows.front().signature);
    if (!all.ok()) return all.status();
    others = *std::move(all);
  }
  const auto bytes = paint(thumbnail->exr(), scale, others);
  if (!bytes.ok()) return bytes.status();
  return replace_file(path, *bytes);
}

}  // namespace irsig
