#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/signature/view/plan.h"
#include "core/signature/view/prepared_scene.h"
#include "core/signature/view/prepared_view.h"
#include "core/signature/view/request.h"
#include "core/signature/view/row.h"
#include "core/signature/view/unseen.h"
#include "core/sources/view_sources.h"

namespace irsig {

// The rows that are computed: these conditions of the request in each of these bands of the scene.
struct RowKeys {
  std::vector<std::uint32_t> condition, band;
};

// ViewSetup holds what all rows of a view share before a path is traced.
struct ViewSetup {
  //   plan  effects and bounds; its number of samples is not used
  //   view  with the light of the conditions
  // The scene outlives the setup; of the request nothing is referred to.
  ViewSetup(const PreparedScene& scene, const ViewRequest& request, const ViewPlan& plan,
            std::shared_ptr<const PreparedView> view, RowKeys keys, std::uint64_t seed);
  ViewSetup(const ViewSetup&) = delete;  // rows refer to its light
  ViewSetup& operator=(const ViewSetup&) = delete;

  const PreparedScene& scene;
  AccuracySpec accuracy;
  std::uint32_t allowed_reflections;
  ViewPlan plan;
  std::shared_ptr<const PreparedView> view;
  RowKeys keys;
  std::uint64_t seed;
  ViewSources sources;
  std::shared_ptr<const UndersampledSources> undersampled;
  std::vector<UndersampledSources::Stratum> strata;  // empty unless the view aims at bright facets
  std::vector<std::vector<bool>> part_in_stratum;    // [stratum][part], likewise
  std::vector<std::vector<SeaGlint>> glitter;        // [sun of the geometry]
  std::vector<TurnedArea> turned;                    // [part]

  [[nodiscard]] const AimedView& aimed() const { return *view->aimed; }
  [[nodiscard]] std::size_t parts() const { return scene.target.part.size(); }
  // Returns true if rays that leave a part may meet another part.
  [[nodiscard]] bool parts_reflected() const {
    return plan.effects.parts && !plan.effects.skip_self_intersection;
  }
  // Returns the area [m2] for which one of so many samples a replicate of a stratum stands, over
  // all replicates.
  [[nodiscard]] double sample_m2(std::uint32_t stratum, std::uint64_t samples) const;
};

// Returns the rows of a view with all that follows from the view alone: conditions x bands.
//   request  of the setup
[[nodiscard]] std::vector<Row> rows_of(const ViewSetup& setup, const ViewRequest& request);

}  // namespace irsig
