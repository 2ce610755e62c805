#include "core/land/land_kinds.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace irsig {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
// Tilt of the slopes of a ground, steeper than nearly all land, and of roofs.
constexpr double kSlopeSine = 0.5, kRoofSine = std::numbers::sqrt2 / 2;
constexpr std::uint32_t kSlopes = 4, kRoofs = 8, kWalls = 16;

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

double LandHorizon::seen_of_disk(double azimuth_rad, double disk_rad, double radius_rad) const {
  const auto above = [&](double edge) {
    return std::clamp(0.5 + 0.5 * (disk_rad - edge) / radius_rad, 0.0, 1.0);
  };
  const std::uint32_t near = nearest(azimuth_rad);
  const auto low = static_cast<double>(lid_low_rad[near]),
             high = static_cast<double>(lid_high_rad[near]);
  return std::max(0.0, above(at(azimuth_rad)) - (high > low ? above(low) - above(high) : 0.0));
}

std::uint32_t LandHorizon::nearest(double azimuth_rad) {
  const double turned = azimuth_rad / kTurn;
  return static_cast<std::uint32_t>((turned - std::floor(turned)) * kHorizonAzimuths + 0.5) %
         kHorizonAzimuths;
}

void LandKinds::index_kinds() {
  kind.clear();
  first_object_.clear();
  const std::size_t horizons = horizon.size();
  first_ground_.assign(materials * horizons, 0);
  const auto next = [this] { return static_cast<std::uint32_t>(kind.size()); };
  const auto add_ring = [this](LandKind like, double sine, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
      like.normal = tilted(sine, i, count);
      kind.push_back(like);
    }
  };
  for (std::uint32_t m = 0; m < materials; ++m) {
    const auto first = first_ground_.begin() + static_cast<std::ptrdiff_t>(m * horizons);
    if (!computed[m]) {
      std::fill_n(first, horizons, next());
      first_object_.push_back(next());
      kind.push_back({m});
      continue;
    }
    const auto stands_for = [&](std::size_t h) {
      return stand_in.empty() ? h : std::size_t{stand_in[m * horizons + h]};
    };
    for (std::uint32_t h = 0; h < horizons; ++h) {
      if (stands_for(h) != h) continue;
      first[h] = next();
      kind.push_back({m, h});
      add_ring({m, h}, kSlopeSine, kSlopes);
    }
    for (std::uint32_t h = 0; h < horizons; ++h)
      first[h] = first[static_cast<std::ptrdiff_t>(stands_for(h))];
    first_object_.push_back(next());
    if (!on_objects[m]) continue;
    kind.push_back({m, 0, true});
    add_ring({m, 0, true}, kRoofSine, kRoofs);
    add_ring({m, 0, true}, 1, kWalls);
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
  if (!computed[material]) return add(first_object_[material], 1);
  const double sine = std::hypot(normal.x, normal.y);
  const std::uint32_t level =
      object ? first_object_[material] : first_ground_[material * horizon.size() + of_horizon];
  if (!(sine > 1e-9)) return add(level, 1);
  const double azimuth = azimuth_of(normal);
  // Slopes whose horizontal parts add up to so much of that of the normal; returns what is left.
  const auto slopes = [&](double times, double part) {
    const BesideAzimuth of = beside(azimuth, object ? kRoofs : kSlopes);
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
    add(level + 1 + kRoofs + of.first, steep * of.of_first / sum);
    add(level + 1 + kRoofs + of.second, steep * of.of_second / sum);
  }
}

void LandKinds::at(double x_m, double y_m, Vec<Enu> normal, bool object,
                   std::span<const float> fraction, std::vector<KindShare>& out) const {
  const std::uint32_t here = object ? 0 : horizon_at(x_m, y_m);
  for (std::uint32_t m = 0; m < fraction.size(); ++m) at(m, here, normal, object, fraction[m], out);
}

}  // namespace irsig
