#include "core/land/land_kinds.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace irsig {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
// Tilt of the slopes of a ground, steeper than nearly all land, and of roofs.
constexpr double kSlopeSine = 0.5, kRoofSine = std::numbers::sqrt2 / 2;
constexpr std::uint32_t kSlopes = 8, kWalls = 16;
constexpr std::uint32_t kGroundKinds = 1 + kSlopes, kObjectKinds = 1 + kSlopes + kWalls;

Vec<Enu> tilted(double sine, std::uint32_t i, std::uint32_t count) {
  const double azimuth = kTurn * i / count;
  return {sine * std::sin(azimuth), sine * std::cos(azimuth), std::sqrt(1 - sine * sine)};
}

double azimuth_of(Vec<Enu> v) {
  const double azimuth = std::atan2(v.x, v.y);
  return azimuth < 0 ? azimuth + kTurn : azimuth;
}

// Two directions of a ring beside an azimuth, and the factors with which they add up to it.
struct BesideAzimuth {
  std::uint32_t first, second;
  double of_first, of_second;
};
BesideAzimuth beside(double azimuth, std::uint32_t count) {
  const double step = kTurn / count, turned = azimuth / step;
  const auto below = static_cast<std::uint32_t>(turned);
  const double angle = (turned - below) * step;
  return {below % count, (below + 1) % count, std::sin(step - angle) / std::sin(step),
          std::sin(angle) / std::sin(step)};
}

}  // namespace

double LandHorizon::at(double azimuth_rad) const {
  double turned = azimuth_rad / kTurn;
  turned = (turned - std::floor(turned)) * kHorizonAzimuths;
  const auto below = static_cast<std::uint32_t>(turned);
  const double share = turned - below;
  return (1 - share) * static_cast<double>(elevation_rad[below % kHorizonAzimuths]) +
         share * static_cast<double>(elevation_rad[(below + 1) % kHorizonAzimuths]);
}

void LandKinds::index_kinds() {
  kind.clear();
  first_ground_.clear();
  first_object_.clear();
  for (std::uint32_t m = 0; m < materials; ++m) {
    first_ground_.push_back(static_cast<std::uint32_t>(kind.size()));
    if (!computed[m]) {
      kind.push_back({m});
      first_object_.push_back(first_ground_.back());
      continue;
    }
    for (std::uint32_t h = 0; h < horizon.size(); ++h) {
      kind.push_back({m, h});
      for (std::uint32_t i = 0; i < kSlopes; ++i)
        kind.push_back({m, h, false, tilted(kSlopeSine, i, kSlopes)});
    }
    first_object_.push_back(static_cast<std::uint32_t>(kind.size()));
    if (!on_objects[m]) continue;
    kind.push_back({m, 0, true});
    for (std::uint32_t i = 0; i < kSlopes; ++i)
      kind.push_back({m, 0, true, tilted(kRoofSine, i, kSlopes)});
    for (std::uint32_t i = 0; i < kWalls; ++i) kind.push_back({m, 0, true, tilted(1, i, kWalls)});
  }
}

std::uint32_t LandKinds::horizon_at(double x_m, double y_m) const {
  for (std::size_t s = 0; s < square.size(); ++s) {
    const Square& at = square[s];
    const double half_m = 0.5 * at.cells * at.cell_m;
    if (s + 1 < square.size() && std::max(std::abs(x_m), std::abs(y_m)) >= half_m) continue;
    const auto cell = [&](double along_m) {
      return static_cast<std::size_t>(
          std::clamp((along_m + half_m) / at.cell_m, 0.0, at.cells - 1.0));
    };
    return at.horizon[cell(y_m) * at.cells + cell(x_m)];
  }
  return 0;
}

void LandKinds::at(std::uint32_t material, std::uint32_t of_horizon, Vec<Enu> normal, bool object,
                   float share, std::vector<KindShare>& out) const {
  if (!(share > 0)) return;
  const auto add = [&](std::uint32_t which, double part) {
    if (part > 0) out.push_back({which, static_cast<float>(part) * share});
  };
  if (!computed[material]) return add(first_ground_[material], 1);
  const double sine = std::hypot(normal.x, normal.y);
  const std::uint32_t level =
      object ? first_object_[material] : first_ground_[material] + of_horizon * kGroundKinds;
  if (!(sine > 1e-9)) return add(level, 1);
  const double azimuth = azimuth_of(normal);
  // Slopes whose horizontal parts add up to so much of that of the normal; returns what is left.
  const auto slopes = [&](double times, double part) {
    const BesideAzimuth of = beside(azimuth, kSlopes);
    const double first = times * of.of_first, second = times * of.of_second,
                 most = std::max(1.0, first + second);
    add(level + 1 + of.first, part * first / most);
    add(level + 1 + of.second, part * second / most);
    return part * (1 - (first + second) / most);
  };
  const double steep =
      !object ? 0 : (normal.z < 0 ? 1 : std::clamp((sine - kRoofSine) / (1 - kRoofSine), 0.0, 1.0));
  add(level, slopes(sine / (object ? kRoofSine : kSlopeSine), 1 - steep));
  if (steep > 0) {
    const BesideAzimuth of = beside(azimuth, kWalls);
    const double sum = of.of_first + of.of_second;
    add(level + 1 + kSlopes + of.first, steep * of.of_first / sum);
    add(level + 1 + kSlopes + of.second, steep * of.of_second / sum);
  }
}

void LandKinds::at(double x_m, double y_m, Vec<Enu> normal, bool object,
                   std::span<const float> fraction, std::vector<KindShare>& out) const {
  const std::uint32_t here = object ? 0 : horizon_at(x_m, y_m);
  for (std::uint32_t m = 0; m < fraction.size(); ++m) at(m, here, normal, object, fraction[m], out);
}

}  // namespace irsig
