#include "core/land/generate_terrain.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

constexpr int kOctaves = 8;
constexpr double kLongestWaveM = 6000, kGain = 0.45;
constexpr double kRiverHalfM = 20, kRiverFall = 0.0005, kValleyM = 700;
constexpr double kRoadHalfM = 3.5, kShoulderM = 40;
constexpr double kFieldLongM = 240, kFieldWideM = 120;
constexpr int kSubsamples = 4;  // along a side of a sample's square
constexpr double kMostSamples = 1e8;

double smooth_step(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

// A number in [0, 1) for each lattice point.
double lattice(std::uint64_t seed, std::int64_t i, std::int64_t j) {
  std::uint64_t h = seed * 0x9e3779b97f4a7c15ULL + static_cast<std::uint64_t>(i);
  for (const std::uint64_t next : {static_cast<std::uint64_t>(j), seed}) {  // splitmix64
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ULL;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebULL;
    h = (h ^ (h >> 31)) + next * 0x9e3779b97f4a7c15ULL;
  }
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ULL;
  return static_cast<double>(h >> 11) * 0x1p-53;
}

double value_noise(std::uint64_t seed, double x, double y) {
  const double i = std::floor(x), j = std::floor(y);
  const auto at = [&](int di, int dj) {
    return lattice(seed, static_cast<std::int64_t>(i) + di, static_cast<std::int64_t>(j) + dj);
  };
  const double u = smooth_step(x - i), v = smooth_step(y - j);
  return std::lerp(std::lerp(at(0, 0), at(1, 0), u), std::lerp(at(0, 1), at(1, 1), u), v);
}

class TerrainShape {
 public:
  explicit TerrainShape(const Terrain& terrain) : terrain_(terrain) {}

  [[nodiscard]] double height_m(double x, double y) const {
    const double to_river = std::abs(y - river_y(x)) - kRiverHalfM;
    const double to_road = std::abs(x - road_x(y)) - kRoadHalfM;
    // The road's bed has the two longest waves only.
    const double hill = to_road >= kShoulderM ? hills(x, y, kOctaves)
                                              : std::lerp(hills(x, y, 2), hills(x, y, kOctaves),
                                                          smooth_step(to_road / kShoulderM));
    return terrain_.relief_m * hill * smooth_step(to_river / kValleyM) - kRiverFall * x;
  }

  [[nodiscard]] std::string_view material(double x, double y) const {
    if (std::abs(y - river_y(x)) < kRiverHalfM) return "water";
    if (std::abs(x - road_x(y)) < kRoadHalfM) return "asphalt";
    const double row = std::floor(y / kFieldWideM);
    const double shift = lattice(terrain_.seed + 201, static_cast<std::int64_t>(row), 0);
    const double column = std::floor(x / kFieldLongM + shift);
    const double kind = lattice(terrain_.seed + 202, static_cast<std::int64_t>(column),
                                static_cast<std::int64_t>(row));
    return kind < 0.35 ? "wheat" : kind < 0.6 ? "bare_soil" : "grass";
  }

 private:
  // In [0, 1].
  [[nodiscard]] double hills(double x, double y, int octaves) const {
    double sum = 0, weight = 1, weights = 0, wave_m = kLongestWaveM;
    for (int octave = 0; octave < kOctaves; ++octave, weight *= kGain, wave_m /= 2) {
      weights += weight;
      if (octave < octaves)
        sum += weight * value_noise(terrain_.seed + static_cast<std::uint64_t>(octave), x / wave_m,
                                    y / wave_m);
    }
    return sum / weights;
  }
  [[nodiscard]] double river_y(double x) const {
    return 800 * (value_noise(terrain_.seed + 101, x / 2500, 0) - 0.5) +
           120 * (value_noise(terrain_.seed + 102, x / 400, 0) - 0.5);
  }
  [[nodiscard]] double road_x(double y) const {
    return 1000 * (value_noise(terrain_.seed + 103, 0, y / 3000) - 0.5);
  }
  const Terrain& terrain_;
};

// The fraction of a sample's square of this material.
double fraction_of(const TerrainShape& shape, std::string_view material, double x, double y,
                   double spacing_m) {
  int covered = 0;
  for (int j = 0; j < kSubsamples; ++j)
    for (int i = 0; i < kSubsamples; ++i) {
      const auto offset = [&](int k) { return ((k + 0.5) / kSubsamples - 0.5) * spacing_m; };
      covered += shape.material(x + offset(i), y + offset(j)) == material ? 1 : 0;
    }
  return covered / double(kSubsamples * kSubsamples);
}

absl::Status check_terrain(const Terrain& terrain, std::string_view layer) {
  const auto within = [](const char* name, double value, double low, double high) -> absl::Status {
    if (value >= low && value <= high) return absl::OkStatus();
    return absl::InvalidArgumentError(
        absl::StrCat(name, " is ", value, "; expected ", low, " to ", high));
  };
  RETURN_IF_ERROR(within("width_m", terrain.width_m, 100, 4e5));
  RETURN_IF_ERROR(within("spacing_m", terrain.spacing_m, 0.1, terrain.width_m / 2));
  RETURN_IF_ERROR(within("relief_m", terrain.relief_m, 0, 5000));
  const double side = std::floor(terrain.width_m / terrain.spacing_m) + 1;
  if (side * side > kMostSamples)
    return absl::InvalidArgumentError(absl::StrCat("a terrain of ", side, " x ", side,
                                                   " samples is above the limit of ", kMostSamples,
                                                   "; use a larger spacing or a smaller width"));
  const auto& known = terrain_layers();
  if (std::find(known.begin(), known.end(), layer) == known.end())
    return absl::InvalidArgumentError(
        absl::StrCat("layer \"", std::string(layer), "\", expected one of ",
                     absl::StrJoin(known, ", ", [](auto* out, auto name) { out->append(name); })));
  return absl::OkStatus();
}

}  // namespace

const std::vector<std::string_view>& terrain_layers() {
  static const std::vector<std::string_view> layers{"heights", "asphalt", "bare_soil",
                                                    "grass",   "water",   "wheat"};
  return layers;
}

absl::StatusOr<HeightRaster> generate_terrain(const Terrain& terrain, std::string_view layer) {
  RETURN_IF_ERROR(check_terrain(terrain, layer));
  const auto side = static_cast<std::uint32_t>(std::floor(terrain.width_m / terrain.spacing_m)) + 1;
  const double half_m = 0.5 * (side - 1) * terrain.spacing_m;
  HeightRaster out{LocalMetres{},      -half_m, half_m, terrain.spacing_m,
                   -terrain.spacing_m, side,    side,   {}};
  out.height_m.reserve(std::size_t{side} * side);
  const TerrainShape shape(terrain);
  for (std::uint32_t row = 0; row < side; ++row)
    for (std::uint32_t column = 0; column < side; ++column) {
      const double x = out.x0 + column * out.x_step, y = out.y0 + row * out.y_step;
      const double value = layer == "heights" ? shape.height_m(x, y)
                                              : fraction_of(shape, layer, x, y, terrain.spacing_m);
      out.height_m.push_back(static_cast<float>(value));
    }
  return out;
}

}  // namespace irsig
