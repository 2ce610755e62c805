#include "core/land/land_cover.h"

#include <array>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/geo/map_coordinates.h"
#include "core/land/choose_map.h"
#include "core/land/raster_frame.h"

namespace irsig {
namespace {

// Sums may differ from 1 by so much: generate_terrain() has steps of 1/16, files of bytes of 1/255.
constexpr double kSumTolerance = 1 / 64.0;
constexpr double kFractionTolerance = 1e-5;
// Places on a raster are linear between points so far apart, to s^2 / (4 R) = 2.5 mm.
constexpr double kPlaceDistanceM = 250;

struct Sample {
  std::uint32_t column, row;
  [[nodiscard]] std::string text() const {
    return absl::StrCat("row ", row + 1, ", column ", column + 1);
  }
};

// The places of the cells' middles on one grid of samples.
class CellPlaces {
 public:
  struct Size {
    double west_m, south_m, spacing_m;  // of the first cell's middle
    std::uint32_t columns, rows;
  };

  CellPlaces(const HeightRaster& raster, const GeodeticPosition& origin, const Size& size,
             const HeightField& field)
      : frame_(raster, origin), size_(size) {
    stride_ = static_cast<std::uint32_t>(
        std::clamp(std::floor(kPlaceDistanceM / size.spacing_m), 1.0, 1e6));
    const HeightGrid& map = field.outer();
    const double east_m = map.west_m + map.columns * map.spacing_m;
    const double north_m = map.south_m + map.rows * map.spacing_m;
    across_ = (size.columns - 1) / stride_ + 2;
    const std::uint32_t up = (size.rows - 1) / stride_ + 2;
    for (std::uint32_t j = 0; j < up; ++j)
      for (std::uint32_t i = 0; i < across_; ++i) {
        const double x_m = size.west_m + 1.0 * i * stride_ * size.spacing_m;
        const double y_m = size.south_m + 1.0 * j * stride_ * size.spacing_m;
        const auto z_m =
            field.z_m(std::clamp(x_m, map.west_m, east_m), std::clamp(y_m, map.south_m, north_m));
        node_.push_back(
            frame_.place(x_m, y_m, geodetic_position(origin, {x_m, y_m, z_m.value_or(0)})));
      }
  }

  [[nodiscard]] const RasterFrame& frame() const { return frame_; }

  [[nodiscard]] RasterPlace place(std::uint32_t column, std::uint32_t row) const {
    const std::uint32_t i = column / stride_, j = row / stride_;
    const double u = (column - i * stride_) / double(stride_);
    const double v = (row - j * stride_) / double(stride_);
    const RasterPlace* south = node_.data() + std::size_t{j} * across_ + i;
    const RasterPlace* north = south + across_;
    const auto mean = [&](double a, double b, double c, double d) {
      return (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
    };
    return {mean(south[0].column, south[1].column, north[0].column, north[1].column),
            mean(south[0].row, south[1].row, north[0].row, north[1].row)};
  }

  // The nearest sample; nullopt: the cell's middle lies outside of all samples' squares.
  [[nodiscard]] std::optional<Sample> nearest(std::uint32_t column, std::uint32_t row) const {
    constexpr double kEdge = 0.5 + 1e-3;  // places have errors of millimetres
    const RasterPlace at = place(column, row);
    if (!(at.column >= -kEdge && at.column <= frame_.columns() - 1 + kEdge && at.row >= -kEdge &&
          at.row <= frame_.rows() - 1 + kEdge))
      return std::nullopt;
    const auto sample = [](double place, std::uint32_t count) {
      return static_cast<std::uint32_t>(std::clamp(std::floor(place + 0.5), 0.0, count - 1.0));
    };
    return Sample{sample(at.column, frame_.columns()), sample(at.row, frame_.rows())};
  }

 private:
  RasterFrame frame_;
  Size size_;
  std::uint32_t stride_ = 1, across_ = 2;
  std::vector<RasterPlace> node_;
};

// Fractions in 1/255 whose sum is 255: rounded down, and the largest rests rounded up.
void quantise(std::span<const double> fraction, std::uint8_t* out) {
  double sum = 0;
  for (const double f : fraction) sum += f;
  int left = 255;
  std::vector<std::pair<double, std::size_t>> rest;
  rest.reserve(fraction.size());
  for (std::size_t m = 0; m < fraction.size(); ++m) {
    const double exact = 255 * fraction[m] / sum;
    const double whole = std::min(255.0, std::floor(exact + 1e-9));
    out[m] = static_cast<std::uint8_t>(whole);
    left -= static_cast<int>(whole);
    rest.emplace_back(whole - exact, m);
  }
  std::stable_sort(rest.begin(), rest.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; left > 0; ++i, --left) ++out[rest[i % rest.size()].second];
}

}  // namespace

class LandCover::Maker {
 public:
  Maker(std::vector<const CoverLayer*> layer, const HeightField& field,
        const GeodeticPosition& origin)
      : layer_(std::move(layer)), field_(field), origin_(origin) {}

  absl::StatusOr<LandCover> make() {
    if (layer_.empty()) return absl::InvalidArgumentError("land needs a material of the ground");
    RETURN_IF_ERROR(find_remainder());
    LandCover out;
    if (layer_.size() == 1 && remainder_) return out;
    RETURN_IF_ERROR(choose_cells());
    for (const CoverLayer* layer : layer_) {
      std::size_t at = 0;
      while (layer->fraction && at < places_.size() &&
             !places_[at].frame().same_grid(*layer->fraction))
        ++at;
      places_of_.push_back(at);
      if (layer->fraction && at == places_.size())
        places_.emplace_back(*layer->fraction, origin_,
                             CellPlaces::Size{cells_.west_m + 0.5 * cells_.spacing_m,
                                              cells_.south_m + 0.5 * cells_.spacing_m,
                                              cells_.spacing_m, cells_.columns, cells_.rows},
                             field_);
    }
    cells_.share.resize(std::size_t{cells_.columns} * cells_.rows * cells_.materials);
    for (std::uint32_t row = 0; row < cells_.rows; ++row) RETURN_IF_ERROR(fill_row(row));
    out.cells_ = std::make_shared<const Cells>(std::move(cells_));
    return out;
  }

 private:
  absl::Status find_remainder() {
    for (std::size_t m = 0; m < layer_.size(); ++m) {
      if (const auto& raster = layer_[m]->fraction) {
        if (raster->columns < 1 || raster->rows < 1 ||
            raster->height_m.size() != std::size_t{raster->columns} * raster->rows)
          return keyed_problem(layer_[m]->key, "the map of fractions has no samples");
        continue;
      }
      if (remainder_)
        return keyed_problem(layer_[m]->key,
                             "two materials have no map of fractions; expected at most one, which "
                             "takes what the others leave");
      remainder_ = m;
    }
    return absl::OkStatus();
  }

  absl::Status choose_cells() {
    const CoverLayer* finest = nullptr;
    for (const CoverLayer* layer : layer_)
      if (layer->fraction &&
          (finest == nullptr || spacing_of(*layer->fraction) < spacing_of(*finest->fraction)))
        finest = layer;
    const HeightRaster& raster = *finest->fraction;
    const HeightGrid& map = field_.outer();
    const double spacing_m = spacing_of(raster);
    cells_.spacing_m = spacing_m;
    cells_.materials = static_cast<std::uint32_t>(layer_.size());
    cells_.west_m = map.west_m;
    cells_.south_m = map.south_m;
    if (std::holds_alternative<LocalMetres>(raster.system)) {
      // Middles of cells are samples.
      const auto edge = [&](double least_m, double sample_m) {
        const double from_m = sample_m - 0.5 * spacing_m;
        return from_m + std::floor((least_m - from_m) / spacing_m + 1e-9) * spacing_m;
      };
      cells_.west_m = edge(map.west_m, raster.x0);
      cells_.south_m = edge(map.south_m, raster.y0);
    }
    const auto count = [&](double from_m, double to_m) {
      return std::max(1.0, std::ceil((to_m - from_m) / spacing_m - 1e-9));
    };
    const double columns = count(cells_.west_m, map.west_m + map.columns * map.spacing_m);
    const double rows = count(cells_.south_m, map.south_m + map.rows * map.spacing_m);
    if (!(columns * rows * cells_.materials <= static_cast<double>(kMostCoverBytes)))
      return keyed_problem(
          finest->key,
          absl::StrCat("a map of ", columns, " x ", rows, " cells of ", spacing_m, " m with ",
                       cells_.materials, " materials is above the limit of ", kMostCoverBytes,
                       " bytes; use coarser fractions or a smaller map"));
    cells_.columns = static_cast<std::uint32_t>(columns);
    cells_.rows = static_cast<std::uint32_t>(rows);
    return absl::OkStatus();
  }

  [[nodiscard]] std::string point(std::uint32_t column, std::uint32_t row) const {
    const auto middle = [&](double from_m, std::uint32_t cell) {
      return absl::SixDigits(from_m + (cell + 0.5) * cells_.spacing_m);
    };
    return absl::StrCat("x = ", middle(cells_.west_m, column),
                        " m, y = ", middle(cells_.south_m, row), " m from the target");
  }

  absl::Status fill_row(std::uint32_t row) {
    std::vector<std::optional<Sample>> sample(places_.size());
    std::vector<double> fraction(layer_.size());
    for (std::uint32_t column = 0; column < cells_.columns; ++column) {
      for (std::size_t p = 0; p < places_.size(); ++p) sample[p] = places_[p].nearest(column, row);
      double sum = 0;
      for (std::size_t m = 0; m < layer_.size(); ++m) {
        fraction[m] = 0;
        if (!layer_[m]->fraction) continue;
        const auto& at = sample[places_of_[m]];
        if (!at)
          return keyed_problem(
              layer_[m]->key,
              absl::StrCat("the map of fractions ends before the map of heights: it has no sample ",
                           "at ", point(column, row),
                           "; use a map that covers the heights, or a smaller width_m"));
        RETURN_IF_ERROR(take(m, *at, fraction[m]));
        sum += fraction[m];
      }
      if (remainder_) {
        fraction[*remainder_] = std::max(0.0, 1 - sum);
        if (sum > 1 + kSumTolerance) return wrong_sum(column, row, sample, fraction, sum);
      } else if (!(std::abs(sum - 1) <= kSumTolerance)) {
        return wrong_sum(column, row, sample, fraction, sum);
      }
      quantise(fraction, cells_.share.data() +
                             (std::size_t{row} * cells_.columns + column) * cells_.materials);
    }
    return absl::OkStatus();
  }

  absl::Status take(std::size_t m, const Sample& at, double& fraction) const {
    const HeightRaster& raster = *layer_[m]->fraction;
    fraction = raster.height_m[std::size_t{at.row} * raster.columns + at.column];
    if (std::isnan(fraction))
      return keyed_problem(layer_[m]->key,
                           absl::StrCat("the sample in ", at.text(),
                                        " is missing; expected a fraction from 0 to 1"));
    if (!(fraction >= -kFractionTolerance && fraction <= 1 + kFractionTolerance))
      return keyed_problem(
          layer_[m]->key,
          absl::StrCat("the sample in ", at.text(), " is ", fraction,
                       ", expected a fraction from 0 to 1; bytes from 0 to 255 are converted by ",
                       "gdal_translate -ot Float32 -scale 0 255 0 1"));
    fraction = std::clamp(fraction, 0.0, 1.0);
    return absl::OkStatus();
  }

  [[nodiscard]] absl::Status wrong_sum(std::uint32_t column, std::uint32_t row,
                                       const std::vector<std::optional<Sample>>& sample,
                                       const std::vector<double>& fraction, double sum) const {
    std::size_t first = 0;
    while (!layer_[first]->fraction) ++first;
    std::string terms;
    for (std::size_t m = 0; m < layer_.size(); ++m)
      if (layer_[m]->fraction)
        absl::StrAppend(&terms, terms.empty() ? "" : " + ", absl::SixDigits(fraction[m]));
    return keyed_problem(
        layer_[first]->key,
        absl::StrCat("the fractions of all materials at ", sample[places_of_[first]]->text(), " (",
                     point(column, row), ") add up to ", terms, " = ", absl::SixDigits(sum),
                     remainder_ ? ", expected at most 1 + 1/64"
                                : ", expected 1 within 1/64; correct the maps, or leave out the "
                                  "file of one material, which then takes what the others leave"));
  }

  std::vector<const CoverLayer*> layer_;
  const HeightField& field_;
  GeodeticPosition origin_;
  std::optional<std::size_t> remainder_;
  Cells cells_;
  std::vector<CellPlaces> places_;
  std::vector<std::size_t> places_of_;  // [layer]
};

absl::StatusOr<LandCover> LandCover::create(std::span<const CoverLayer> layer,
                                            const HeightField& field,
                                            const GeodeticPosition& origin) {
  std::vector<const CoverLayer*> ground;
  std::vector<std::uint32_t> number;
  for (std::size_t m = 0; m < layer.size(); ++m) {
    if (layer[m].objects_only) continue;
    ground.push_back(&layer[m]);
    number.push_back(static_cast<std::uint32_t>(m));
  }
  const bool all = ground.size() == layer.size();
  ASSIGN_OR_RETURN(LandCover out, Maker(std::move(ground), field, origin).make());
  out.materials_ = static_cast<std::uint32_t>(layer.size());
  if (!all) out.ground_ = std::move(number);
  return out;
}

}  // namespace irsig
