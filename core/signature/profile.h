#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/accuracy/replicates.h"
#include "core/signature/view/prepared_scene.h"
#include "core/signature/view/request.h"
#include "core/transport/path_tracer.h"

namespace irsig {

// Places at which a sensor measures radiance: points at which it aims, one after the other, and the
// small rectangle across each line of sight over which it averages.
struct ProfileSpec {
  std::vector<Vec<Body>> point;  // on the target, or where the line of sight is to pass
  double width_m = 0, height_m = 0;
  // Increasing. What is measured when a path may be reflected no more than this often: after the
  // last reflection the surface that is met still emits, nothing more.
  std::vector<std::uint32_t> reflections;
  // Exactly one is positive: primary rays of one point, all replicates; or the standard error of
  // its source radiance temperature under any condition and in any band, which a pilot turns into
  // rays.
  double samples = 0;
  double source_radiance_temperature_stderr_k = 0;
};

// Mean radiance over the footprint, in-band: of the target where the sensor sees it, of the sky or
// what lies below the horizon behind it. Standard errors allow for what no sample met.
//                                                                                   [W/(m2 sr)]
struct ProfileRow {
  std::uint32_t point = 0, condition = 0, band = 0, reflections = 0;
  Estimate radiance_w_m2_sr;           // at the target: no air
  Estimate apparent_radiance_w_m2_sr;  // at the sensor
  // Bounds of further reflections, and of the integral over wavelength.
  double truncation_bound_w_m2_sr = 0, quadrature_bound_w_m2_sr = 0;
  // The blackbody's with the same in-band radiance_w_m2_sr; NaN if there is none.
  Estimate source_radiance_temperature_k;
  double target_fraction = 0;  // of the footprint
};

struct ProfileResult {
  // points x selected conditions x selected bands x numbers of reflections, the last fastest.
  std::vector<ProfileRow> row;
  std::vector<std::uint64_t> samples;  // of each point, all replicates, as stored
  PathCounts counts;                   // of everything traced, pilots included in rays only
};

// Computes a profile. All numbers of reflections come from the same paths, whose weights are kept
// apart by the number of reflections. Each point has its own seed, made of the scene's and the
// viewpoint's hash, the
// user's seed and the point itself; pilot and stored run use different ones.
//
// Replicates and selection as in the request; accuracy, max_reflections and thumbnail_px of the
// request are not used. Errors: INVALID_ARGUMENT for a specification that makes no sense.
[[nodiscard]] absl::StatusOr<ProfileResult> simulate_profile(const PreparedScene& scene,
                                                             const ViewRequest& request,
                                                             const ProfileSpec& profile);

}  // namespace irsig
