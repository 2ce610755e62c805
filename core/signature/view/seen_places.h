#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/environment/environment.h"
#include "core/materials/material.h"
#include "core/sources/source_geometry.h"
#include "core/transport/primary_rays.h"

namespace irsig {

// Returns three places about a target. Air thins out upwards, so that the air in front of any place
// of the target lies between that of the first and that of the last.
//   [0]  the nearest range, the greatest height
//   [1]  the nearest range, the least height
//   [2]  the farthest range, the least height
//   sensor  from the target's reference point, body frame [m]
[[nodiscard]] std::array<Environment::Line::End, 3> target_ends(const Target& target,
                                                                Vec<Body> sensor);

// Mean place at which the light that reaches the sensor leaves the target: from the farthest range
// (0) to the nearest (1), and from the least height (0) to the greatest (1).
struct MeanPlace {
  struct Interval {
    double low = 0, high = 1;
  };
  Interval near, high;
};

// SeenPlaces measures where the seen light of a target leaves it, by a fixed set of primary rays
// that depends on the view's geometry alone. Each ray counts by the emissivity or the reflectance
// of the facet that it meets. [docs/explanation/methods.md, "One line of sight"]
//
// Accuracy: a mean over n rays is widened by three standard errors of independent rays; the rays
// are stratified and err by less. A mean over fewer than 16 rays is all of [0, 1].
// Limits: all means are all of [0, 1] where the target is deeper than a twentieth of its range,
// since the air then bends between the ends.
class SeenPlaces {
 public:
  //   plane  of the sea or ground that hides what is below it
  SeenPlaces(const Target& target, std::span<const Material> material, const AimedView& view,
             const Emitters& emitters, const std::optional<Plane>& plane);

  // Returns the place of the light that an emitter of one temperature sends straight to the sensor.
  [[nodiscard]] MeanPlace emitted(std::uint32_t emitter) const { return emitted_[emitter]; }
  // Places of all emission of the target together, and of all light that the target reflects. A
  // source of a part of this light may leave elsewhere: the mean is widened by the standard
  // deviation of the places. Weighted over all sources, the mean square distance of a source's mean
  // from that of all light is at most the variance.
  [[nodiscard]] MeanPlace any_emitted() const { return any_emitted_; }
  [[nodiscard]] MeanPlace reflected() const { return reflected_; }

 private:
  std::vector<MeanPlace> emitted_;  // [emitter]
  MeanPlace any_emitted_, reflected_;
};

}  // namespace irsig
