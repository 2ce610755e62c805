#pragma once

#include <cstdint>
#include <memory>

#include "absl/status/statusor.h"
#include "core/signature/simulator.h"
#include "live/camera.h"
#include "live/own_parts.h"
#include "runner/spec_to_request.h"
#include "runner/sweep_plumes.h"
#include "schema/assets.h"
#include "schema/job.pb.h"

namespace irsig {

// A resolved sweep prepared for viewing: its scene, air and temperatures. Immutable and
// thread-safe.
class LiveSweep {
 public:
  // Makes the live view's scene of a sweep. heat: outputs of the sweep's heat jobs.
  // INVALID_ARGUMENT: errors of the scene and of its hot gas, with their keys.
  [[nodiscard]] static absl::StatusOr<std::shared_ptr<const LiveSweep>> make(
      schema::ResolvedSweep resolved, const Assets& assets, const HeatOutputs& heat);
  // Returns the same scene under the conditions of another resolved sweep, which differs only in
  // its conditions and air. Errors: those of make().
  [[nodiscard]] absl::StatusOr<std::shared_ptr<const LiveSweep>> with_conditions(
      schema::ResolvedSweep resolved, const Assets& assets, const HeatOutputs& heat) const;

  [[nodiscard]] const schema::ResolvedSweep& resolved() const { return resolved_; }
  [[nodiscard]] const Simulator& simulator() const { return *simulator_; }
  [[nodiscard]] const LandScene* land() const { return scene_->land.get(); }
  [[nodiscard]] const OwnParts& own_parts() const { return *own_parts_; }
  [[nodiscard]] const Environment* environment() const { return environment_.get(); }

  // Returns the request of a job for the view from the camera, with this condition and band.
  [[nodiscard]] absl::StatusOr<ViewRequest> request(std::uint32_t condition, std::uint32_t band,
                                                    const LiveCamera& camera) const;

 private:
  LiveSweep() = default;

  schema::ResolvedSweep resolved_;
  std::shared_ptr<const SweepScene> scene_;
  std::shared_ptr<const Simulator> simulator_;
  std::shared_ptr<const OwnParts> own_parts_;
  std::shared_ptr<const Environment> environment_;
  SweepTemperatures temperatures_;
  SweepPlumes plumes_;
};

}  // namespace irsig
