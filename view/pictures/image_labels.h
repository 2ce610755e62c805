#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/image/image.h"
#include "schema/store/reader.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// Which columns labels.csv has, the same for all of its lines (docs/reference/export.md).
struct LabelColumns {
  bool mask = false, split = false, imager = false;
  bool band = false;   // of a cube
  bool scale = false;  // of grey
  std::vector<std::string> part;
};

// ImageLabel is a line of labels.csv.
struct ImageLabel {
  std::string image, mask, split;  // the last two: where there are such columns
  const StoredSignature& signature;
  ImageContent target;  // pixels of the exported image that show any of it
  double target_in_frame_px = 0;
  std::uint32_t width_px = 0, height_px = 0;
  double pixel_rad = 0;
  struct Scale {
    double black_w_m2_sr, white_w_m2_sr;
  };
  std::optional<std::size_t> band = std::nullopt;  // of the cube, the first is 1
  std::optional<Scale> scale = std::nullopt;
  struct Counts {  // of an imager instead
    std::string imager;
    double counts_per_w_m2_sr, offset_counts, noise_w_m2_sr;
    std::uint64_t saturated_px;
  };
  std::optional<Counts> counts = std::nullopt;
};

// Writes the heading and a line for each label, with the contribution of each part of its row.
[[nodiscard]] absl::Status write_labels(StoreReader& reader, const LabelColumns& columns,
                                        const std::vector<ImageLabel>& labels, std::ostream& out);

}  // namespace irsig
