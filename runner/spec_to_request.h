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
// Makes the scene of a sweep. assets: files of the sweep. heat: outputs of its heat runs, or empty
// for a scene without views.
[[nodiscard]] absl::StatusOr<SweepScene> scene_from_sweep(const schema::ResolvedSweep& sweep,
                                                          const Assets& assets,
                                                          const HeatOutputs& heat);

// Copies the materials of the sweep's land from scene.material to scene.land_material, in the order
// of [land]. Numbers of materials remain: one that no part has becomes a blackbody, so that paths
// need not carry its spectrum.
[[nodiscard]] absl::Status take_land_materials(const schema::Sweep& sweep, SceneSpec& scene);

// Checks that each material conserves energy in the sweep's bands, unless it declares
// allow_energy_gain = true. materials: those of the scene above, prepared. INVALID_ARGUMENT: lists
// each material that creates energy.
[[nodiscard]] absl::Status check_energy(const schema::Sweep& sweep,
                                        const std::vector<Material>& materials);

// Makes the air of a sweep with the embedded atmosphere, shared by all its jobs, at the scene's
// wavelengths. Null: other sweeps. OUT_OF_RANGE: the table of the air does not cover the
// wavelengths.
[[nodiscard]] absl::StatusOr<std::shared_ptr<const Environment>> environment_from_sweep(
    const schema::ResolvedSweep& sweep, const std::vector<BandGrid>& grids);

// Makes the request of one view's job, without the scene; computes the sun's position.
//   environment         from environment_from_sweep
//   temperatures, land  of the job's scene; FAILED_PRECONDITION: they are awaited
//   plumes              from plumes_from_sweep; empty: hot gas is left out, or the sweep has none
[[nodiscard]] absl::StatusOr<ViewRequest> request_from_job(
    const schema::ResolvedSweep& sweep, const schema::ViewJob& job,
    std::shared_ptr<const Environment> environment, const SweepTemperatures& temperatures,
    std::shared_ptr<const LandScene> land, const SweepPlumes& plumes);

}  // namespace irsig
