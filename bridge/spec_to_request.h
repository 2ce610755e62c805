#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "bridge/sweep_plumes.h"
#include "bridge/sweep_temperatures.h"
#include "core/signature/simulator.h"
#include "schema/job.pb.h"

namespace irsig {

// Messages -> core: with result_to_proto (and bridge/environment for the air) the only bridge
// between the two. Errors name the key's path in the sweep.

// Geometry, parts, materials, bands, and the temperatures of facets.
struct SweepScene : SceneSpec {
  SweepTemperatures temperatures;
};
// [part], with their materials by number.
[[nodiscard]] absl::StatusOr<std::vector<PartSpec>> parts_from_sweep(const schema::Sweep& sweep);

// assets: its files; heat: of its heat runs, or nothing for a scene that no view is asked of.
[[nodiscard]] absl::StatusOr<SweepScene> scene_from_sweep(const schema::ResolvedSweep& sweep,
                                                          const Assets& assets,
                                                          const HeatOutputs& heat);

// INVALID_ARGUMENT for each material that creates energy in the sweep's bands and is not declared
// with allow_energy_gain = true. `materials`: of the scene above, prepared.
[[nodiscard]] absl::Status check_energy(const schema::Sweep& sweep,
                                        const std::vector<Material>& materials);

// The air of a sweep with the embedded atmosphere, for all its jobs, at the wavelengths that the
// scene is computed at; null for other sweeps. OUT_OF_RANGE: the air's table does not cover them.
[[nodiscard]] absl::StatusOr<std::shared_ptr<const Environment>> environment_from_sweep(
    const schema::ResolvedSweep& sweep, const std::vector<BandGrid>& grids);

// Everything of one view's job but the scene: the sun's position is computed here. `environment`:
// of environment_from_sweep; `temperatures`: of its scene. FAILED_PRECONDITION: they are awaited.
// `plumes`: of plumes_from_sweep; or none, and hot gas is left out (of a sweep without it: none).
[[nodiscard]] absl::StatusOr<ViewRequest> request_from_job(
    const schema::ResolvedSweep& sweep, const schema::ViewJob& job,
    std::shared_ptr<const Environment> environment, const SweepTemperatures& temperatures,
    const SweepPlumes& plumes);

// Position of the sun in one condition.
struct SunAngles {
  double azimuth_deg, zenith_deg;
};
[[nodiscard]] absl::StatusOr<SunAngles> sun_angles(const schema::ResolvedSweep& sweep,
                                                   const schema::Condition& condition);

}  // namespace irsig
