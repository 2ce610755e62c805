#include "live/place_grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/status_macros.h"

namespace irsig {
namespace {

// Elevations of the nodes, likewise below the horizontal: the air of lines of sight changes fastest
// close to it. [deg]
constexpr std::array kElevationDeg = {0.0,  0.5,  1.0,  2.0,  3.5,  5.5,  8.0,  11.0,
                                      15.0, 20.0, 26.0, 33.0, 42.0, 55.0, 70.0, 90.0};
constexpr double kRangeStep = 1.3;  // of nodes
constexpr double kNearestM = 1;     // range of node 0
constexpr int kAzimuths = 12;
// Nodes are no longer kept than there are so many: each takes up to 0.5 MB.
constexpr std::size_t kMostNodes = 512;

double elevation_of(std::int32_t i) {
  const double deg = kElevationDeg[static_cast<std::size_t>(std::abs(i))];
  return i < 0 ? -deg : deg;
}

}  // namespace

std::size_t PlaceGrid::nodes() const {
  const std::lock_guard lock(mutex_);
  return node_.size();
}

Viewpoint PlaceGrid::place_of(const Key& key) const {
  Viewpoint out{key.azimuth * 360.0 / kAzimuths, elevation_of(key.elevation),
                kNearestM * std::pow(kRangeStep, key.range)};
  // Stands for the places above the surface on its side of the cell.
  const double least = lights_.least_elevation_deg(out.range_m);
  out.aspect_elevation_deg = std::max(out.aspect_elevation_deg, least);
  return out;
}

PlaceGrid::Corners PlaceGrid::corners_of(const Viewpoint& v) const {
  struct Pair {
    std::int32_t low, high;
    float f;
  };
  Pair azimuth{0, 0, 0}, elevation{0, 0, 0}, range{0, 0, 0};
  if (lights_.depends_on_azimuth()) {
    const double position = v.aspect_azimuth_deg / 360 * kAzimuths, low = std::floor(position);
    azimuth = {static_cast<std::int32_t>(low) % kAzimuths,
               (static_cast<std::int32_t>(low) + 1) % kAzimuths,
               static_cast<float>(position - low)};
  }
  if (lights_.depends_on_place()) {
    constexpr int kLast = static_cast<int>(kElevationDeg.size()) - 1;
    std::int32_t low = -kLast;
    while (low + 2 <= kLast && elevation_of(low + 1) <= v.aspect_elevation_deg) ++low;
    const double from = elevation_of(low), to = elevation_of(low + 1);
    elevation = {
        low, low + 1,
        static_cast<float>(std::clamp((v.aspect_elevation_deg - from) / (to - from), 0.0, 1.0))};
    const double position =
                     std::log(std::max(v.range_m, kNearestM) / kNearestM) / std::log(kRangeStep),
                 first = std::floor(position), from_m = std::pow(kRangeStep, first),
                 to_m = from_m * kRangeStep;
    range = {static_cast<std::int32_t>(first), static_cast<std::int32_t>(first) + 1,
             static_cast<float>(
                 std::clamp((v.range_m / kNearestM - from_m) / (to_m - from_m), 0.0, 1.0))};
  }
  Corners out;
  for (int a = 0; a < 2; ++a)
    for (int e = 0; e < 2; ++e)
      for (int r = 0; r < 2; ++r) {
        const float weight = (a == 0 ? 1 - azimuth.f : azimuth.f) *
                             (e == 0 ? 1 - elevation.f : elevation.f) *
                             (r == 0 ? 1 - range.f : range.f);
        if (!(weight > 0)) continue;
        out.corner[static_cast<std::size_t>(out.count++)] = {
            {a == 0 ? azimuth.low : azimuth.high, e == 0 ? elevation.low : elevation.high,
             r == 0 ? range.low : range.high},
            weight};
      }
  return out;
}

std::shared_ptr<const PlaceLight> PlaceGrid::node(const Key& key) {
  {
    const std::lock_guard lock(mutex_);
    if (const auto known = node_.find(key); known != node_.end()) return known->second;
  }
  auto made = lights_.at(place_of(key));
  std::shared_ptr<const PlaceLight> out;
  if (made.ok()) out = std::make_shared<const PlaceLight>(*std::move(made));
  const std::lock_guard lock(mutex_);
  if (node_.size() >= kMostNodes) node_.clear();
  return node_.try_emplace(key, std::move(out)).first->second;
}

bool PlaceGrid::make_one(const Viewpoint& viewpoint) {
  const Corners corners = corners_of(viewpoint);
  for (int k = 0; k < corners.count; ++k) {
    const Key& key = corners.corner[static_cast<std::size_t>(k)].key;
    {
      const std::lock_guard lock(mutex_);
      if (node_.contains(key)) continue;
    }
    (void)node(key);
    return true;
  }
  return false;
}

int PlaceGrid::missing(const Viewpoint& viewpoint) const {
  const Corners corners = corners_of(viewpoint);
  const std::lock_guard lock(mutex_);
  int out = 0;
  for (int k = 0; k < corners.count; ++k)
    out += node_.contains(corners.corner[static_cast<std::size_t>(k)].key) ? 0 : 1;
  return out;
}

absl::StatusOr<PlaceGrid::Seen> PlaceGrid::at(const Viewpoint& viewpoint) {
  Seen out;
  ASSIGN_OR_RETURN(out.horizon_z, lights_.horizon_z(viewpoint));
  if (missing(viewpoint) > 1) {
    ASSIGN_OR_RETURN(out.light, lights_.at(viewpoint));
    return out;
  }
  const Corners corners = corners_of(viewpoint);
  for (int k = 0; k < corners.count; ++k) {
    const Corner& corner = corners.corner[static_cast<std::size_t>(k)];
    const auto light = node(corner.key);
    if (light == nullptr) {
      ASSIGN_OR_RETURN(out.light, lights_.at(viewpoint));
      return out;
    }
    out.light.add(corner.weight, *light);
  }
  return out;
}

}  // namespace irsig
