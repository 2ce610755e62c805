#pragma once

#include "core/scene/trace/target.h"
#include "core/transport/ray_batch.h"

namespace irsig {

// The shadow of a target on what stands around it. Not for several threads.
class TargetShadow {
 public:
  // Keeps a reference to the target, which must outlive the shadow.
  explicit TargetShadow(const Target& target);

  // Returns true if the target blocks the ray from a place outside the target, given relative to
  // the target's centre [m], along a unit vector.
  [[nodiscard]] bool falls_on(Vec<Body> place, Vec<Body> direction);

 private:
  const Target& target_;
  RayBatch batch_;
};

}  // namespace irsig
