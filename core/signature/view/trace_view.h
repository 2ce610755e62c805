#pragma once

#include <cstdint>
#include <vector>

#include "core/effects/effect_set.h"
#include "core/signature/view/prepared_scene.h"
#include "core/signature/view/request.h"
#include "core/transport/path_tracer.h"

namespace irsig {

// Returns how a view's paths are traced.
//   seed  of the view and of the stage together
[[nodiscard]] PathSettings path_settings(const AccuracySpec& accuracy, const EffectSet& effects,
                                         std::uint64_t seed, std::uint64_t samples);

// Result of one tracing of a view.
struct TracedView {
  std::vector<PathWeights> weights;  // [replicate]
  PathCounts counts;
  TracedPictures pictures;  // empty without pictures
};

// Traces the paths of all replicates of a view: pilots, the stored run, hot gas and moved inputs
// alike.
//   pictures  empty: none
[[nodiscard]] TracedView trace_view(const PreparedScene& scene, const AimedView& view,
                                    const SourceGeometry& sources, const PathSettings& settings,
                                    const ImagePlan& pictures = {});

}  // namespace irsig
