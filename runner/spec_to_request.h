#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/signature/simulator.h"
#include "runner/sweep_land.h"
#include "runner/sweep_plumes.h"
#include "runner/sweep_temperatures.h"
#include "schema/job.pb.h"

namespace irsig {

// Requests of a job to the core: its scene, air and view, made of converted messages (messages/)
// and of the sweep's files. Errors name the key's path in the sweep.

// Geometry, parts, materials, bands, the temperatures of facets, and the land around the target.
struct SweepScene : SceneSpec {
  SweepTemperatures temperatures;
  std::shared_ptr<const LandScene> land;  // null: none
};
// assets: its files; heat: of its heat runs, or nothing for a scene that no view is asked of.
[[nodiscard]] absl::StatusOr<SweepScene> scene_from_sweep(const schema::ResolvedSweep& sweep,
                                                          const Assets& assets,
                                                          const HeatOutputs& heat);

// Copies the materials of the sweep's land from scene.material to scene.land_material, in the order
// of [land]. Numbers of materials remain: one that no part has becomes a blackbody, so that paths
// need not carry its spectrum.
[[nodiscard]] absl::Status take_land_materials(const schema::Sweep& sweep, SceneSpec& scene);

// INVALID_ARGUMENT for each material that creates energy in the sweep's bands and is not declared
// with allow_energy_gain = true. `materials`: of the scene above, prepared.
[[nodiscard]] absl::Status check_energy(const schema::Sweep& sweep,
                                        const std::vector<Material>& materials);

// The air of a sweep with the embedded atmosphere, for all its jobs, at the wavelengths that the
// scene is computed at; null for other sweeps. OUT_OF_RANGE: the air's table does not cover them.
[[nodiscard]] absl::StatusOr<std::shared_ptr<const Environment>> environment_from_sweep(
    const schema::ResolvedSweep& sweep, const std::vector<BandGrid>& grids);

// Everything of one view's job but the scene: the sun's position is computed here. `environment`:
// of environment_from_sweep; `temperatures`, `land`: of its scene. FAILED_PRECONDITION: they are
// awaited.
// `plumes`: of plumes_from_sweep; or none, and hot gas is left out (of a sweep without it: none).
[[nodiscard]] absl::StatusOr<ViewRequest> request_from_job(
    const schema::ResolvedSweep& sweep, const schema::ViewJob& job,
    std::shared_ptr<const Environment> environment, const SweepTemperatures& temperatures,
    std::shared_ptr<const LandScene> land, const SweepPlumes& plumes);

}  // namespace irsig
