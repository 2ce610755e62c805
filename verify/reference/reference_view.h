#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/accuracy/replicates.h"
#include "core/signature/view/prepared_scene.h"
#include "core/signature/view/request.h"

namespace irsig {

// The reference of `irsig selftest --search`: computes a view's numbers by independent means.
//
//   I = sum over facets of  integral of V(x) cos(theta) (R / d)^2 L(x, towards the sensor) dA
//   L = B(T) + integral of f cos_i (L_in - B(T)) dw                        [kajiya1986; Kirchhoff]
//
// V: whether x sees the sensor; d: its distance, R: the range. Points are drawn on the facets
// themselves, in proportion to projected area and radiance, so that there is no image plane, no
// mask and no rim, and a small hot part is sampled wherever it is. BRDFs are formulas in double
// (reference_brdf.h), reflections are not limited, the sun's disk and hot facets are aimed at and
// drawn (balance heuristic [veach1995]). In-band integrals: grey scenes by 4000 midpoints a band
// between the response's corners; others at wavelengths drawn for each path. Rays: exact arithmetic
// (core/scene/trace/reference_tracer.h). Sampler: Halton points, shifted at random for each batch,
// for the first vertex; pseudo-random numbers after it. The air (vacuum or homogeneous) is that of
// each point's own distance. The background of a primary ray is the sea where the ray meets the
// sphere of the Earth.
//
// Sunlight that mirrors (lobes of slopes below 0.15) send on to matt surfaces is followed from the
// sun, and joined to the sensor wherever it arrives; no path from the sensor counts it.
//
// Land: that of the program's own walker (core/land, judged by itself), whose light is summed here
// again; of grey, diffuse materials (others: UNIMPLEMENTED).
//
// Limits: one condition; no embedded atmosphere (UNIMPLEMENTED).
class ReferenceView {
 public:
  // Prepares one condition of a view. condition: index into the request's conditions.
  [[nodiscard]] static absl::StatusOr<ReferenceView> make(const SceneSpec& scene,
                                                          const ViewRequest& request,
                                                          std::uint32_t condition);
  ~ReferenceView();
  ReferenceView(ReferenceView&&) noexcept;
  ReferenceView& operator=(ReferenceView&&) noexcept;

  struct Row {                           // of a band; means over batches and their standard errors
    Estimate total, apparent, contrast;  // [W/sr]
    Estimate projected_area_m2;
    // Sum of the absolute values of all contributions to the total [W/sr]: the scale of rounding
    // errors.
    double gross_w_sr = 0;
  };
  struct Result {
    std::vector<Row> row;    // [band]
    std::uint64_t rays = 0;  // of all kinds: the cost
  };
  static constexpr std::uint32_t kBatches = 32;
  // Runs all batches. samples: number of points on facets in each batch.
  [[nodiscard]] Result run(std::uint64_t samples, std::uint64_t seed) const;

 private:
  struct Parts;
  explicit ReferenceView(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace irsig
