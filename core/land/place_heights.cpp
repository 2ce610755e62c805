#include "core/land/place_heights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/land/raster_frame.h"

namespace irsig {
namespace {

constexpr double kMostOffsetM = 4e5;
constexpr double kMostLatitudeDeg = 89;
// Between four nodes z deviates from the bilinear surface by s^2 / (4 R): 2.5 mm.
constexpr double kNodeDistanceM = 250;

// The place of a point of the map on the raster, and its z.
struct Place {
  double column = 0, row = 0, z_m = 0;
  friend Place operator+(Place a, Place b) {
    return {a.column + b.column, a.row + b.row, a.z_m + b.z_m};
  }
  friend Place operator*(double s, Place a) { return {s * a.column, s * a.row, s * a.z_m}; }
};

// A point of the map at the raster's lowest and highest height; heights between them are linear.
struct Node {
  std::array<Place, 2> at;
  friend Node operator+(Node a, Node b) { return {{a.at[0] + b.at[0], a.at[1] + b.at[1]}}; }
  friend Node operator*(double s, Node a) { return {{s * a.at[0], s * a.at[1]}}; }
};

Node between(const Node& a, const Node& b, double w) { return (1 - w) * a + w * b; }

// The height at a place of the raster, NaN where a sample that counts is missing.
double sample(const HeightRaster& raster, double column, double row) {
  constexpr double kRounding = 1e-6;
  if (!(column >= -kRounding && column <= raster.columns - 1 + kRounding && row >= -kRounding &&
        row <= raster.rows - 1 + kRounding))
    return std::numeric_limits<double>::quiet_NaN();
  const auto along = [](double at, std::uint32_t samples) {
    return static_cast<std::size_t>(std::clamp(at, 0.0, samples - 2.0));
  };
  const std::size_t i = along(column, raster.columns), j = along(row, raster.rows);
  const double u = std::clamp(column - double(i), 0.0, 1.0);
  const double v = std::clamp(row - double(j), 0.0, 1.0);
  const float* near = raster.height_m.data() + j * raster.columns + i;
  const float* far = near + raster.columns;
  const auto weighted = [](double weight, float height) {
    return weight < 1e-9 ? 0.0 : weight * height;
  };
  return weighted((1 - u) * (1 - v), near[0]) + weighted(u * (1 - v), near[1]) +
         weighted((1 - u) * v, far[0]) + weighted(u * v, far[1]);
}

class HeightPlacer {
 public:
  HeightPlacer(const HeightRaster& raster, const LandMap& map)
      : raster_(raster), map_(map), frame_(raster, map.origin) {
    for (const float height : raster.height_m) {
      if (std::isnan(height)) continue;
      lowest_m_ = std::min(lowest_m_, double(height));
      highest_m_ = std::max(highest_m_, double(height));
    }
    if (map.fill_m) {
      lowest_m_ = std::min(lowest_m_, *map.fill_m);
      highest_m_ = std::max(highest_m_, *map.fill_m);
    }
    highest_m_ = std::max(highest_m_, lowest_m_ + 1);
  }

  absl::StatusOr<HeightGrid> place() {
    if (!(lowest_m_ < highest_m_)) return absl::InvalidArgumentError("no sample has a height");
    HeightGrid out{map_.west_m, map_.south_m, map_.spacing_m, map_.columns, map_.rows, {}};
    out.z_m.reserve((map_.columns + std::size_t{1}) * (map_.rows + std::size_t{1}));
    const auto stride = static_cast<std::uint32_t>(
        std::clamp(std::floor(kNodeDistanceM / map_.spacing_m), 1.0, 1e6));
    std::vector<Node> south = nodes(0, stride), north = nodes(stride, stride);
    std::uint32_t below = 0;  // row of the nodes in `south`
    for (std::uint32_t row = 0; row <= map_.rows; ++row) {
      if (row > below + stride) {
        below += stride;
        south.swap(north);
        north = nodes(below + stride, stride);
      }
      if (too_far_north_) break;
      add_row(out, south, north, (row - below) / double(stride), stride);
    }
    if (too_far_north_)
      return absl::InvalidArgumentError(
          "the map reaches beyond a latitude of 89 degrees, where maps of degrees and UTM end; "
          "move "
          "its origin");
    if (missing_ > 0)
      return absl::InvalidArgumentError(absl::StrCat(
          missing_, " of ", out.z_m.size(), " vertices have no height, the first at x = ",
          first_missing_.x, " m, y = ", first_missing_.y, " m from the origin (latitude ",
          map_.origin.latitude_deg, ", longitude ", map_.origin.longitude_deg,
          "); make the map smaller, or state a height that fills them"));
    return out;
  }

 private:
  [[nodiscard]] Place place_at(double x_m, double y_m, double height_m) {
    Place out{.z_m = height_m - map_.origin.height_m};
    GeodeticPosition at{};
    for (int round = 0; round < 5; ++round) {  // each gains a factor of 500, 400 km from the origin
      at = geodetic_position(map_.origin, {x_m, y_m, out.z_m});
      out.z_m += height_m - at.height_m;
    }
    too_far_north_ = too_far_north_ || std::abs(at.latitude_deg) > kMostLatitudeDeg;
    const RasterPlace place = frame_.place(x_m, y_m, at);
    out.column = place.column;
    out.row = place.row;
    return out;
  }

  std::vector<Node> nodes(std::uint32_t row, std::uint32_t stride) {
    std::vector<Node> out;
    const double y_m = map_.south_m + row * map_.spacing_m;
    for (std::uint32_t column = 0; column < map_.columns + stride; column += stride) {
      const double x_m = map_.west_m + column * map_.spacing_m;
      out.push_back({{place_at(x_m, y_m, lowest_m_ + map_.geoid_m),
                      place_at(x_m, y_m, highest_m_ + map_.geoid_m)}});
    }
    return out;
  }

  void add_row(HeightGrid& out, const std::vector<Node>& south, const std::vector<Node>& north,
               double up, std::uint32_t stride) {
    double height_m = lowest_m_;
    for (std::uint32_t column = 0; column <= map_.columns; ++column) {
      const std::size_t node = std::min<std::size_t>(column / stride, south.size() - 2);
      const double right = column / double(stride) - double(node);
      const Node here = between(between(south[node], south[node + 1], right),
                                between(north[node], north[node + 1], right), up);
      out.z_m.push_back(static_cast<float>(z_at(here, height_m)));
      if (std::isnan(out.z_m.back())) note_missing(out);
    }
  }

  // A vertex keeps its x and y: higher land stands over a point nearer to the origin. height_m is a
  // guess, and becomes the height that was found.
  double z_at(const Node& node, double& height_m) const {
    for (int round = 0; round < 20; ++round) {
      const Place place = at_height(node, height_m);
      double found_m = sample(raster_, place.column, place.row);
      if (std::isnan(found_m) && map_.fill_m) found_m = *map_.fill_m;
      if (std::isnan(found_m)) {
        height_m = lowest_m_;
        return found_m;
      }
      const double change_m = std::abs(found_m - height_m);
      height_m = found_m;
      if (change_m < 1e-4) break;
    }
    return at_height(node, height_m).z_m;
  }

  [[nodiscard]] Place at_height(const Node& node, double height_m) const {
    const double w = (height_m - lowest_m_) / (highest_m_ - lowest_m_);
    return (1 - w) * node.at[0] + w * node.at[1];
  }

  void note_missing(const HeightGrid& out) {
    const std::size_t vertex = out.z_m.size() - 1, width = map_.columns + std::size_t{1};
    if (missing_++ == 0)
      first_missing_ = {map_.west_m + double(vertex % width) * map_.spacing_m,
                        map_.south_m + double(vertex / width) * map_.spacing_m, 0};
  }

  const HeightRaster& raster_;
  const LandMap& map_;
  RasterFrame frame_;
  double lowest_m_ = std::numeric_limits<double>::infinity();
  double highest_m_ = -std::numeric_limits<double>::infinity();
  bool too_far_north_ = false;
  std::size_t missing_ = 0;
  Vec<Enu> first_missing_;
};

absl::Status check_map(const LandMap& map) {
  const double east_m = map.west_m + map.columns * map.spacing_m;
  const double north_m = map.south_m + map.rows * map.spacing_m;
  for (const double edge_m : {map.west_m, map.south_m, east_m, north_m})
    if (!(std::abs(edge_m) <= kMostOffsetM))
      return absl::InvalidArgumentError(
          absl::StrCat("the map's edge lies ", edge_m,
                       " m from its origin, more than 400 km; move the origin "
                       "into the map, or make the map smaller"));
  if (!(map.spacing_m > 0) || map.columns == 0 || map.rows == 0)
    return absl::InvalidArgumentError("a map needs at least 2 x 2 vertices and a spacing above 0");
  if ((map.columns + std::uint64_t{1}) > kMostLandVertices / (map.rows + std::uint64_t{1}))
    return absl::InvalidArgumentError(absl::StrCat(
        "a map of ", map.columns + std::uint64_t{1}, " x ", map.rows + std::uint64_t{1},
        " vertices is above the limit of ", kMostLandVertices,
        "; use a larger spacing, and an inset where detail matters"));
  if (!(std::abs(map.origin.latitude_deg) <= kMostLatitudeDeg) ||
      !std::isfinite(map.origin.longitude_deg) || !(std::abs(map.origin.height_m) < kMostHeightM))
    return absl::InvalidArgumentError(
        "the map's origin needs a latitude within 89 degrees, a longitude, and a height below 100 "
        "km");
  for (const double height_m : {map.geoid_m, map.fill_m.value_or(0)})
    if (!(std::abs(height_m) < kMostHeightM))
      return absl::InvalidArgumentError("a height of the map is not within 100 km");
  return absl::OkStatus();
}

absl::Status check_raster(const HeightRaster& raster) {
  for (const float height : raster.height_m)
    if (std::abs(height) > kMostHeightM)  // not NaN
      return absl::InvalidArgumentError(absl::StrCat(
          "a sample has a height of ", height, " m; state it as nodata_value if it means missing"));
  if (raster.columns < 2 || raster.rows < 2 ||
      raster.height_m.size() != std::size_t{raster.columns} * raster.rows)
    return absl::InvalidArgumentError("a raster needs at least 2 x 2 samples");
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<HeightGrid> place_heights(const HeightRaster& raster, const LandMap& map) {
  RETURN_IF_ERROR(check_map(map));
  RETURN_IF_ERROR(check_raster(raster));
  return HeightPlacer(raster, map).place();
}

}  // namespace irsig
