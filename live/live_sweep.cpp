#include "live/live_sweep.h"

#include <utility>

#include "core/base/status_macros.h"

namespace irsig {

absl::StatusOr<std::shared_ptr<const LiveSweep>> LiveSweep::make(schema::ResolvedSweep resolved,
                                                                 const Assets& assets,
                                                                 const HeatOutputs& heat) {
  std::shared_ptr<LiveSweep> out(new LiveSweep);
  ASSIGN_OR_RETURN(auto scene, scene_from_sweep(resolved, assets, heat));
  ASSIGN_OR_RETURN(auto simulator, Simulator::create(scene));
  out->simulator_ = std::move(simulator);
  out->own_parts_ = std::make_shared<const OwnParts>(
      OwnParts::make(out->simulator_->target(), scene.temperatures.emitters.get()));
  ASSIGN_OR_RETURN(out->environment_,
                   environment_from_sweep(resolved, out->simulator_->band_grids()));
  ASSIGN_OR_RETURN(out->plumes_, plumes_from_sweep(resolved, assets));
  out->temperatures_ = scene.temperatures;
  out->scene_ = std::make_shared<const SweepScene>(std::move(scene));
  out->resolved_ = std::move(resolved);
  return out;
}

absl::StatusOr<std::shared_ptr<const LiveSweep>> LiveSweep::with_conditions(
    schema::ResolvedSweep resolved, const Assets& assets, const HeatOutputs& heat) const {
  std::shared_ptr<LiveSweep> out(new LiveSweep);
  out->scene_ = scene_;
  out->simulator_ = simulator_;
  out->own_parts_ = own_parts_;
  ASSIGN_OR_RETURN(out->environment_,
                   environment_from_sweep(resolved, out->simulator_->band_grids()));
  ASSIGN_OR_RETURN(out->plumes_, plumes_from_sweep(resolved, assets));
  ASSIGN_OR_RETURN(out->temperatures_,
                   temperatures_from_sweep(resolved, assets, heat, scene_->mesh, scene_->part));
  out->resolved_ = std::move(resolved);
  return out;
}

absl::StatusOr<ViewRequest> LiveSweep::request(std::uint32_t condition, std::uint32_t band,
                                               const LiveCamera& camera) const {
  schema::ViewJob job;
  job.set_viewpoint_index(0);
  job.add_condition_index(condition);
  job.add_band_index(band);
  ASSIGN_OR_RETURN(auto request, request_from_job(resolved_, job, environment_, temperatures_,
                                                  scene_->land, plumes_));
  request.viewpoint = camera.viewpoint();
  request.image = camera.image();
  request.thumbnail_px = request.image->width_px;
  return request;
}

}  // namespace irsig
