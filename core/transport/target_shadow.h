#pragma once

#include "core/scene/trace/target.h"
#include "core/transport/ray_batch.h"

namespace irsig {

// The shadow of a target on what stands around it. Not for several threads.
class TargetShadow {
 public:
  // target: outlives the shadow.
  explicit TargetShadow(const Target& target);

  // Returns true if the target hides a direction, a unit vector, from a place outside it, relative
  // to its centre.
  [[nodiscard]] bool falls_on(Vec<Body> place, Vec<Body> direction);

 private:
  const Target& target_;
  RayBatch batch_;
};

}  // namespace irsig
