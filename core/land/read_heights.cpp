#include "core/land/read_heights.h"

#include <cmath>
#include <cstring>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "core/base/printable.h"
#include "core/base/run_subprocess.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

constexpr std::string_view kRaster = "irsig heights 1\n", kRefused = "irsig none 1\n";

struct RasterHead {
  double x0, y0, x_step, y_step;
  std::uint32_t columns, rows;
  std::uint32_t epsg, unused;  // 0: local metres
};

std::uint32_t epsg_of(const MapSystem& system) {
  if (std::holds_alternative<GeographicDegrees>(system)) return 4326;
  const UtmZone* zone = std::get_if<UtmZone>(&system);
  return zone == nullptr ? 0 : (zone->south ? 32700U : 32600U) + static_cast<unsigned>(zone->zone);
}

absl::StatusOr<HeightRaster> read_geotiff_subprocess(std::string_view bytes) {
  ASSIGN_OR_RETURN(const std::string reply,
                   run_subprocess(program_beside("irsig-heights"), {std::to_string(bytes.size())},
                                  bytes, apart_limits(bytes.size())));
  auto raster = decode_raster(reply);
  if (absl::IsDataLoss(raster.status()))
    return absl::InternalError("irsig-heights gave no complete answer");
  return raster;
}

}  // namespace

std::string encode_raster(const absl::StatusOr<HeightRaster>& raster) {
  if (!raster.ok()) return std::string(kRefused) + std::string(raster.status().message());
  const RasterHead head{raster->x0,      raster->y0,   raster->x_step,          raster->y_step,
                        raster->columns, raster->rows, epsg_of(raster->system), 0};
  const std::size_t bytes = raster->height_m.size() * sizeof(float);
  std::string out;
  out.reserve(kRaster.size() + sizeof head + bytes);
  out.append(kRaster);
  out.append(reinterpret_cast<const char*>(&head), sizeof head);
  out.append(reinterpret_cast<const char*>(raster->height_m.data()), bytes);
  return out;
}

absl::StatusOr<HeightRaster> decode_raster(std::string_view bytes) {
  const absl::Status broken = absl::DataLossError("no complete raster");
  if (bytes.starts_with(kRefused))
    return absl::InvalidArgumentError(std::string(bytes.substr(kRefused.size())));
  RasterHead head{};
  if (!bytes.starts_with(kRaster) || bytes.size() < kRaster.size() + sizeof head) return broken;
  std::memcpy(&head, bytes.data() + kRaster.size(), sizeof head);
  bytes.remove_prefix(kRaster.size() + sizeof head);
  const std::uint64_t samples = std::uint64_t{head.columns} * head.rows;
  if (bytes.size() % sizeof(float) != 0 || bytes.size() / sizeof(float) != samples) return broken;
  HeightRaster out{LocalMetres{}, head.x0,      head.y0,   head.x_step,
                   head.y_step,   head.columns, head.rows, {}};
  if (head.epsg != 0) {
    ASSIGN_OR_RETURN(out.system, map_system(head.epsg));
  }
  out.height_m.resize(samples);
  if (samples > 0) std::memcpy(out.height_m.data(), bytes.data(), bytes.size());
  return out;
}

absl::StatusOr<HeightRaster> read_heights(std::string_view bytes, const std::string& file,
                                          const std::optional<MapSystem>& system) {
  const std::string name = absl::AsciiStrToLower(file);
  if (name.ends_with(".hgt")) return read_hgt(bytes, file);
  if (name.ends_with(".asc")) return read_asc(bytes, file, system.value_or(LocalMetres{}));
  if (!name.ends_with(".tif") && !name.ends_with(".tiff"))
    return absl::InvalidArgumentError(
        absl::StrCat(one_line(file),
                     ": the name does not end as a file of heights; expected .hgt, "
                     ".asc, .tif or .tiff (gdalwarp -t_srs EPSG:4326 makes a .tif of others)"));
  auto raster = read_geotiff_subprocess(bytes);
  if (raster.ok()) return raster;
  return absl::Status(raster.status().code(),
                      absl::StrCat(one_line(file), ": ", std::string(raster.status().message())));
}

}  // namespace irsig
