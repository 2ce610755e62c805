#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/problems.h"
#include "messages/results/thumbnail_encoder.h"
#include "runner/job_memory.h"
#include "schema/assets.h"
#include "schema/job.pb.h"
#include "schema/result.pb.h"

namespace irsig {

// The largest share of the silhouette that may be facets seen from behind, unless the sweep accepts
// more (model.accepted_backface_fraction). 1 %: the accuracy that is the default for an intensity.
inline constexpr double kAcceptedBackfaceShare = 0.01;

struct RunnerScene;

// Keeps the scene of the last sweep that a process computed: mesh, ray tracer, air, sky and
// sunlight, temperatures. Sweeps that differ only in name, accuracy, viewpoints, profiles and size
// of jobs share the scene, and later runners do not build it again. A scene under which a job
// failed is not used again. Thread-safe.
class KeptScene {
 public:
  // Returns the scene with this key. Null: another scene was kept, and is discarded.
  [[nodiscard]] std::shared_ptr<const RunnerScene> of(const std::string& key);
  void keep(const std::string& key, std::shared_ptr<const RunnerScene> scene);
  // Returns the number of scenes that were built so far.
  [[nodiscard]] int scenes();

 private:
  std::mutex mutex_;
  std::string key_;
  std::shared_ptr<const RunnerScene> scene_;
  int scenes_ = 0;
};

// Runs jobs of one resolved sweep in this process, and keeps the scene between jobs. Immutable
// except for caches of data that do not depend on the job: several threads may call run().
class JobRunner {
 public:
  // Builds the scene. INVALID_ARGUMENT: lists every error in the scene that the sweep's author can
  // correct, with its key ("part[2].name: no group of the model matches \"funel\"").
  //   heat     outputs of the sweep's heat jobs, in their order. Without them the scene can be
  //            tried, and heat jobs can be run; run() refuses views with FAILED_PRECONDITION
  //   encoder  without it the scene can be tried, and jobs of a sweep without thumbnails can be
  //            run; run() refuses the others with FAILED_PRECONDITION
  //   kept     the scene is taken from here, if present, and left here. Results are the same with
  //            and without it
  static absl::StatusOr<std::unique_ptr<JobRunner>> create(
      const schema::ResolvedSweep& sweep, const Assets& assets, const HeatOutputs& heat,
      std::optional<ThumbnailEncoder> encoder = {}, KeptScene* kept = nullptr);
  virtual ~JobRunner() = default;

  // Computes a job. A sweep may have samples_per_replicate beside relative_error; pilots of `irsig
  // plan` set both, sweep files cannot. Such a job uses the effects and pilots that the error
  // needs, and that number of samples.
  [[nodiscard]] virtual absl::StatusOr<schema::JobResult> run(const schema::JobSpec& job) const = 0;
  // Warnings for people (model_warnings.h).
  [[nodiscard]] virtual std::vector<Problem> warnings() const { return {}; }
  // Returns the memory of a worker with this runner; zero for runners that compute nothing.
  [[nodiscard]] virtual JobMemory memory() const { return {}; }
  // Returns the total size of the outputs of the sweep's heat jobs. [bytes]
  [[nodiscard]] virtual std::size_t heat_bytes() const { return 0; }
};

// Returns the determinism class: build id, CPU vendor, the ray tracer's instruction set, libc, and
// a fingerprint of the actual results of libm and of the processor's approximate reciprocals. (libm
// chooses its code by the processor, with or without fused multiply-add.) Results are bit-equal
// within one class.
[[nodiscard]] std::string determinism_class();
[[nodiscard]] std::string build_id();
[[nodiscard]] int physics_version();

}  // namespace irsig
