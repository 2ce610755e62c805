#pragma once

#include <vector>

#include "core/effects/plan.h"
#include "core/signature/pass.h"

namespace irsig {

// The most that each effect can contribute to each row of a view, [condition x band of the
// simulator], and the errors that the request wants of the rows.
//
// `emission`: a pass without reflections over all conditions and bands. It gives a lower limit of
// what is seen whatever else happens (the emission), the area, and the throughput Q0 that is left
// after the first facet, each widened by 4 standard errors. Then, with LightBounds:
//
//   reflected sky, sea, parts   Q0 x the brightest of them
//   direct sun                  area x largest BRDF x irradiance, x 1 / (1 - largest DHR) for what
//                               other facets send on; mirrors: UnseenSun's sums over facets
//   diffuse and mirrored sun    the same with their irradiance, or Q0 x their largest radiance;
//                               mirrors: the latter
//   sun in path and background  area x radiance
//
// At the aperture each is multiplied, wavelength by wavelength, by the line's transmittance: that
// is the most that arrives of light bounded by a smooth spectrum, lines or not.
[[nodiscard]] std::vector<RowBounds> effect_bounds(const Simulator& simulator,
                                                   const ViewRequest& request,
                                                   const AimedView& view,
                                                   ViewSurroundings& surroundings,
                                                   const Pass& emission,
                                                   const std::vector<std::size_t>& band_offset);

// The same without goals and bounds: what is absent only.
[[nodiscard]] std::vector<RowBounds> effects_without_bounds(const Simulator& simulator,
                                                            const ViewRequest& request);

// What an absolute error of `kelvin` is worth per projected area, at the temperature of the warmest
// of what surrounds the target; 0 if all of it is dark. [W/(m2 sr)]
[[nodiscard]] double absolute_floor_w_m2_sr(const Band& band, const BandGrid& grid,
                                            double around_w_m2_sr, double kelvin);

}  // namespace irsig
