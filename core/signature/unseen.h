#pragma once

#include <vector>

#include "core/materials/material.h"
#include "core/scene/target.h"
#include "core/sources/source_geometry.h"
#include "core/transport/path_tracer.h"

namespace irsig {

// What sunlight on facets with narrow lobes could add without having been met yet, per unit
// irradiance [m2/sr]: such glints are rare and bright, and an estimate that has met none says
// nothing about them by its scatter.
struct UnseenSun {
  // Seen directly: sum over the facets of area x cos_o x the largest brdf x cos_i over the sun's
  // disk (at most the disk's own radiance), nothing in the way.
  double glint = 0;
  // Thrown onto facets without narrow lobes: all sunlight that the narrow ones can reflect x the
  // largest brdf x cos_o of those it may fall on (1/pi, or the peak 1/(4 pi m^2) of a lobe of
  // slope m, times their reflectance).
  double caustic = 0;
  // From narrow onto narrow: the radiance of the disk. Per m2 of projected area; what share of the
  // paths does that is known from counts only.
  double chain_per_sr = 0;
  // The largest radiance that any facet reflects, by the same measures. [1/sr]
  double brightest_per_sr = 0;
};
// One for each sun. `view`: from where the target is seen.
[[nodiscard]] std::vector<UnseenSun> unseen_sun(const Target& target,
                                                const std::vector<Material>& materials,
                                                const ViewFrame& frame, double range_m,
                                                const std::vector<SunDirection>& suns);

// Whether a material's lobe is narrow in this sense: as PathTracer counts it.
[[nodiscard]] bool is_bright(const Material& material, const SunDirection& sun);

// A rare event met this often shows in the scatter of the estimate: the relative error of its mean
// is below 1/4, known to a fifth.
inline constexpr std::uint64_t kSeenOften = 16;
// Upper 95 % limit of the expected number of events of which none was met.
inline constexpr double kNoneSeen = 3.0;

}  // namespace irsig
