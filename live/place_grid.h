#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>

#include "absl/status/statusor.h"
#include "live/place_light.h"

namespace irsig {

// Light at the nodes of a grid of places around the target, by azimuth, elevation and range of the
// sensor. A node is made when it is first requested, and stored; between nodes every number is
// linear in each of the three. Thread-safe.
class PlaceGrid {
 public:
  // Creates an empty grid. lights: must outlive the grid.
  explicit PlaceGrid(const PlaceLights& lights) : lights_(lights) {}

  struct Seen {
    PlaceLight light;
    double horizon_z = 0;
  };
  // Returns the light of a place between the nodes around it. Computes at most one table, so that a
  // frame at a new place does not wait for eight. A single missing node is made. If more are
  // missing, or the target cannot be seen from one, the light is computed at the place itself.
  // Errors: those of PlaceLights::at.
  [[nodiscard]] absl::StatusOr<Seen> at(const Viewpoint& viewpoint);
  // Makes one missing node around a place; returns false if there was none.
  [[nodiscard]] bool make_one(const Viewpoint& viewpoint);
  // Returns the number of nodes around a place that are not made yet.
  [[nodiscard]] int missing(const Viewpoint& viewpoint) const;
  // Returns the number of nodes that are stored now.
  [[nodiscard]] std::size_t nodes() const;

 private:
  struct Key {
    std::int32_t azimuth, elevation, range;
    auto operator<=>(const Key&) const = default;
  };
  struct Corner {
    Key key;
    float weight;
  };
  struct Corners {
    std::array<Corner, 8> corner;
    int count = 0;
  };
  [[nodiscard]] Corners corners_of(const Viewpoint& viewpoint) const;
  [[nodiscard]] Viewpoint place_of(const Key& key) const;
  // Returns a node; makes it if it is not stored. Null: the target cannot be seen from the node.
  [[nodiscard]] std::shared_ptr<const PlaceLight> node(const Key& key);

  const PlaceLights& lights_;
  mutable std::mutex mutex_;
  std::map<Key, std::shared_ptr<const PlaceLight>> node_;
};

}  // namespace irsig
