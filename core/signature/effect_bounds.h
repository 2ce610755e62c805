#pragma once

#include <vector>

#include "core/effects/plan.h"
#include "core/signature/measured_view.h"

namespace irsig {

// Limits that a pilot gives with near certainty: values widened by 4 standard errors.
struct PilotLimits {
  double area_m2 = 0;          // at most
  double beyond_m2 = 0;        // throughput that is left after the first facet, at most
  struct Row {                 // [W/sr]
    double emitted, apparent;  // at least
    double absolute_floor;
  };
  std::vector<Row> row;  // [condition x band of the scene]
};
// Returns the limits of a pass over all conditions and bands.
[[nodiscard]] PilotLimits limits_of(const MeasuredView& pilot);
// Returns limits that no pilot of a view can improve, for 1 m2 of target: the hottest part behind
// the material that reflects least, `samples` in all. An effect whose bound does not fit even then
// needs no pilot.
[[nodiscard]] PilotLimits best_case(const PreparedScene& scene, const ViewRequest& request,
                                    const ViewPlan& plan, ViewSurroundings& surroundings,
                                    std::uint64_t samples);

// Returns upper bounds on the contribution of each effect to each row of a view, [condition x band
// of the simulator], and the errors that the request wants of the rows. The emission of surfaces is
// a lower limit of the seen light in any case. A: the area, Q0: the throughput left after the first
// facet.
//
//   reflected sky, sea, parts   Q0 x the brightest of them
//   direct sun                  what facets mirror at most (UndersampledSources), and Q0 x the
//   largest
//                               radiance of any lit facet
//   diffuse and mirrored sun    Q0 x their largest radiance, or the facets' largest BRDF x their
//                               irradiance
//   sun in path and background  A x radiance
//   cloud                       the weight of CloudBounds x (all of the above under either sky,
//                               Q0 x thermal radiance, and A x what the line scatters of it and
//                               what it has behind the target)
//
// At the aperture each is multiplied, wavelength by wavelength, by the line's transmittance: that
// is the most that arrives of light bounded by a smooth spectrum, lines or not. Of sunlight that is
// the one outside the air. `lit`: for the facets that reflect the sun; null: as if they were
// matt and turned to it.
[[nodiscard]] std::vector<RowBounds> effect_bounds(const PreparedScene& scene,
                                                   const ViewRequest& request,
                                                   const PilotLimits& pilot,
                                                   const UndersampledSources* lit,
                                                   ViewSurroundings& surroundings);

// Returns the effects without goals and bounds: absent effects only.
[[nodiscard]] std::vector<RowBounds> effects_without_bounds(const PreparedScene& scene,
                                                            const ViewRequest& request);

// Returns the request's absolute error as radiance per projected area, at the temperature of the
// warmest surroundings of the target: [condition x band of the scene], 0 where all surroundings are
// dark; empty if the request states none. [W/(m2 sr)]
[[nodiscard]] std::vector<double> absolute_floors(const PreparedScene& scene,
                                                  const ViewRequest& request,
                                                  ViewSurroundings& surroundings);

}  // namespace irsig
