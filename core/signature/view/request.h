#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/effects/effects.h"
#include "core/environment/air.h"
#include "core/environment/environment.h"
#include "core/geo/viewpoint.h"
#include "core/land/land_scene.h"
#include "core/signature/view/image_spec.h"
#include "core/sources/condition.h"
#include "core/sources/source_geometry.h"

namespace irsig {

struct AccuracySpec {
  // Exactly one is positive.
  double relative_error = 0;  // of the in-band intensity of every row of the sweep
  // Additional floor for the error: an error of projected area x dL/dT x this, at the temperature
  // around the target, is small enough. 0: none.
  double absolute_error_k = 0;
  double target_paths = 0;  // primary rays that meet the target, all replicates
  std::uint64_t samples_per_replicate = 0;
  std::uint32_t replicates = 32;
  std::uint64_t max_samples_per_replicate = 1u << 22;
};

// One viewpoint. All conditions and bands of the sweep are stated, because the pilot that fixes the
// number of samples looks at all of them; only the selected rows are computed, and their bits do
// not depend on the selection.
struct ViewRequest {
  Viewpoint viewpoint;
  std::vector<ConditionSpec> condition;
  // Emitters whose temperatures the conditions state. Null: the parts.
  std::shared_ptr<const Emitters> emitters = nullptr;
  Air air;
  // The embedded atmosphere, for the same conditions in the same order: takes the place of `air`
  // and of the conditions' surroundings but for their kind, and of sun_scale. Null: none.
  std::shared_ptr<const Environment> environment;
  // Land around the target, instead of the ground as far as its map reaches: needs surroundings of
  // kind kGround. Null: none.
  std::shared_ptr<const LandScene> land = nullptr;
  std::vector<std::uint32_t> selected_condition, selected_band;
  AccuracySpec accuracy;
  EffectChoice effects;
  // A view of which a pilot sees more of the silhouette from behind gets no more samples: nobody
  // waits for what is refused.
  double accepted_backface_fraction = 1;
  std::uint32_t max_reflections = 3;
  std::uint64_t seed = 1;
  // Images: of thumbnail_px pixels along the long side of the target, or as `image` has it. The
  // rays of images with an error of their own are chosen for the selected rows.
  std::uint32_t thumbnail_px = 0;  // 0: none
  std::optional<ImageSpec> image = std::nullopt;
  // Least in-band optical depth at which the projected area of hot gas is counted.
  double plume_area_optical_depth = 0.1;
};

}  // namespace irsig
