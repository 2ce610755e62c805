#include "view/thumbnail.h"

#include <fmt/format.h>

#include <algorithm>

#include "view/atomic_file.h"

namespace irsig {
namespace {

constexpr std::size_t kListed = 12;

std::string listed(const std::vector<QueryRow>& rows) {
  std::string out;
  for (std::size_t i = 0; i < std::min(rows.size(), kListed); ++i) {
    const StoredSignature& s = rows[i].signature;
    out += fmt::format("\n  --row {}: {}, {}, {}, aspect {:.2f},{:.2f} deg", s.row, s.season,
                       s.time_utc, s.band, s.aspect_azimuth_deg, s.aspect_elevation_deg);
  }
  if (rows.size() > kListed) out += fmt::format("\n  and {} more", rows.size() - kListed);
  return out;
}

}  // namespace

absl::Status write_thumbnail(StoreReader& reader, const std::vector<QueryRow>& rows,
                             const std::string& path) {
  const bool png = path.ends_with(".png");
  if (!png && !path.ends_with(".exr")) {
    return absl::InvalidArgumentError(
        fmt::format("thumbnail {}: expected a name that ends in .png or .exr", path));
  }
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
  return replace_file(path, png ? (*thumbnail)->png() : (*thumbnail)->exr());
}

}  // namespace irsig
