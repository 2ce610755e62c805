#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geo/line_of_sight.h"
#include "core/land/height_field.h"
#include "core/land/height_raster.h"

namespace irsig {

// One material of a cover.
struct CoverLayer {
  std::string key;  // of the sweep file, for errors
  // Fractions from 0 to 1, in the place of heights. Absent: what the other materials leave.
  std::optional<HeightRaster> fraction = std::nullopt;
  bool objects_only = false;  // covers no ground, and has no raster
};

// Most bytes of a cover: one for each cell and material.
inline constexpr std::uint64_t kMostCoverBytes = 1ULL << 31;

// Which materials cover the land: the fraction of each at every place. Square cells in the local
// frame of the land, each with the fractions of its middle's nearest samples, in steps of 1/255.
//
// Accuracy: a boundary between materials is off by at most half a sample of its raster and half a
// cell, whose size is that of the finest raster; cells are the samples themselves where that raster
// has local metres. Memory: a byte for each cell and material. Immutable; copies share their cells;
// may be used by several threads at once.
class LandCover {
 public:
  // One material everywhere.
  LandCover() = default;

  // Places the rasters under the heights of `field`, whose local frame has its origin at `origin`.
  // Layers of the ground without a raster: at most one. INVALID_ARGUMENT with the layer's key, and
  // with row and column: a raster that does not cover the field's map, a missing sample, a fraction
  // beyond 0 to 1, fractions whose sum differs from 1 by more than 1/64 (more than 1, if a layer
  // takes what they leave), more than kMostCoverBytes.
  [[nodiscard]] static absl::StatusOr<LandCover> create(std::span<const CoverLayer> layer,
                                                        const HeightField& field,
                                                        const GeodeticPosition& origin);

  // Returns the number of layers, including those of objects.
  [[nodiscard]] std::uint32_t materials() const { return materials_; }

  // Computes the fractions of the materials at (x, y) of the land's local frame: those of the
  // nearest cell. They are not negative and add up to 1 within rounding.
  //   fraction  [materials()]
  void at(double x_m, double y_m, std::span<float> fraction) const {
    if (!cells_) {
      std::fill(fraction.begin(), fraction.end(), 0.0F);
      fraction[ground_.empty() ? 0 : ground_.front()] = 1;
      return;
    }
    const std::uint8_t* here = cells_->at(x_m, y_m);
    if (ground_.empty()) {
      for (std::size_t m = 0; m < cells_->materials; ++m) fraction[m] = (1 / 255.0F) * here[m];
      return;
    }
    std::fill(fraction.begin(), fraction.end(), 0.0F);
    for (std::size_t m = 0; m < cells_->materials; ++m)
      fraction[ground_[m]] = (1 / 255.0F) * here[m];
  }

  [[nodiscard]] std::size_t memory_bytes() const { return cells_ ? cells_->share.size() : 0; }

 private:
  // Row by row from the south; of each cell the materials in their order, in 1/255.
  struct Cells {
    double west_m = 0, south_m = 0, spacing_m = 1;
    std::uint32_t columns = 0, rows = 0, materials = 1;
    std::vector<std::uint8_t> share;

    [[nodiscard]] const std::uint8_t* at(double x_m, double y_m) const {
      const auto cell = [this](double from_m, std::uint32_t count) {
        return static_cast<std::size_t>(std::clamp(from_m / spacing_m, 0.0, count - 1.0));
      };
      return share.data() + (cell(y_m - south_m, rows) * columns + cell(x_m - west_m, columns)) *
                                std::size_t{materials};
    }
  };
  class Maker;
  std::shared_ptr<const Cells> cells_;  // null: one material covers all ground
  std::uint32_t materials_ = 1;
  std::vector<std::uint32_t> ground_;  // the layers of the ground; empty: all layers are
};

}  // namespace irsig
