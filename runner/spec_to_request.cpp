#include "runner/spec_to_request.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/spectral/solar.h"
#include "messages/environment/condition_sun.h"
#include "messages/environment/surroundings_from_message.h"
#include "messages/environment/sweep_environment.h"
#include "messages/scene/material_from_message.h"
#include "messages/scene/request_from_message.h"
#include "messages/scene/scene_from_message.h"
#include "runner/model_mesh.h"

namespace irsig {

absl::Status take_land_materials(const schema::Sweep& sweep, SceneSpec& scene) {
  ASSIGN_OR_RETURN(const auto numbers, land_materials_from_sweep(sweep));
  for (const std::uint32_t m : numbers) scene.land_material.push_back(scene.material[m]);
  for (const std::uint32_t m : numbers)
    if (std::none_of(scene.part.begin(), scene.part.end(),
                     [&](const PartSpec& part) { return part.material == m; }))
      scene.material[m].model = Lambert{{{0, 1}}};
  return absl::OkStatus();
}

absl::StatusOr<SweepScene> scene_from_sweep(const schema::ResolvedSweep& resolved,
                                            const Assets& assets, const HeatOutputs& heat) {
  const schema::Sweep& sweep = resolved.sweep();
  SweepScene scene;
  ASSIGN_OR_RETURN(auto mesh, model_mesh(resolved, assets));
  scene.mesh = std::move(mesh);
  for (int i = 0; i < sweep.material_size(); ++i) {
    auto material = material_from_message(sweep.material(i));
    if (!material.ok()) return at_key(absl::StrCat("material[", i, "]"), material.status());
    scene.material.push_back(*std::move(material));
  }
  ASSIGN_OR_RETURN(scene.part, parts_from_sweep(sweep));
  RETURN_IF_ERROR(take_land_materials(sweep, scene));
  scene.band = bands_from_sweep(sweep);
  scene.spectral_breaks_um = spectral_breaks_um(resolved);
  ASSIGN_OR_RETURN(auto temperatures,
                   temperatures_from_sweep(resolved, assets, heat, scene.mesh, scene.part));
  scene.temperatures = std::move(temperatures);
  for (int p = 0; p < sweep.part_size(); ++p)
    if (!sweep.part(p).has_hot() && scene.temperatures.emitters)
      scene.part[static_cast<std::size_t>(p)].hot =
          is_hot(resolved, scene.temperatures, static_cast<std::size_t>(p));
  ASSIGN_OR_RETURN(scene.land, land_from_sweep(resolved, assets, scene.temperatures.land.kinds));
  return scene;
}

absl::Status check_energy(const schema::Sweep& sweep, const std::vector<Material>& materials) {
  Problems wrong;
  for (int i = 0; i < sweep.material_size(); ++i) {
    const schema::Material& m = sweep.material(i);
    if (m.allow_energy_gain() || !materials[static_cast<std::size_t>(i)].creates_energy()) continue;
    wrong.add(keyed_problem(
        absl::StrCat("material[", i, "].allow_energy_gain"),
        absl::StrCat("is not true, but \"", m.name(), "\" (", m.kind(),
                     ") emits and reflects more than it receives in these bands, expected "
                     "allow_energy_gain = true or another material")));
  }
  return wrong.status();
}

absl::StatusOr<std::shared_ptr<const Environment>> environment_from_sweep(
    const schema::ResolvedSweep& sweep, const std::vector<BandGrid>& grids) {
  if (!has_atmosphere(sweep)) return nullptr;
  std::vector<double> node_um;
  for (const BandGrid& grid : grids)
    node_um.insert(node_um.end(), grid.node_um.begin(), grid.node_um.end());
  auto environment = environment_of(sweep, node_um);
  // Stored spectra are means over step_um: the outermost reach beyond their band.
  if (absl::IsOutOfRange(environment.status()))
    return at_key("band", absl::OutOfRangeError(absl::StrCat(
                              environment.status().message(),
                              ", to which the outermost means of a band's spectrum reach: expected "
                              "a smaller step_um")));
  if (!environment.ok()) return at_key("air.model", environment.status());
  return std::shared_ptr<const Environment>(*std::move(environment));
}

absl::StatusOr<ViewRequest> request_from_job(const schema::ResolvedSweep& resolved,
                                             const schema::ViewJob& job,
                                             std::shared_ptr<const Environment> environment,
                                             const SweepTemperatures& temperatures,
                                             std::shared_ptr<const LandScene> land,
                                             const SweepPlumes& plumes) {
  const schema::Sweep& sweep = resolved.sweep();
  if (temperatures.awaited)
    return absl::FailedPreconditionError(
        "a view of this sweep needs the temperatures that its heat jobs compute, and they are not "
        "given");
  if (job.viewpoint_index() >= static_cast<std::uint32_t>(resolved.viewpoint_size()))
    return absl::InvalidArgumentError(absl::StrCat(
        "a job asks for viewpoint ", job.viewpoint_index(), " of ", resolved.viewpoint_size()));
  ViewRequest request;
  const schema::Viewpoint& v = resolved.viewpoint(static_cast<int>(job.viewpoint_index()));
  request.viewpoint = {v.aspect_azimuth_deg(), v.aspect_elevation_deg(), v.range_m()};
  for (const schema::Condition& c : resolved.condition()) {
    ConditionSpec condition;
    condition.part_temperature_k.assign(c.part_temperature_k().begin(),
                                        c.part_temperature_k().end());
    if (temperatures.emitters) {
      const std::size_t index = request.condition.size();
      condition.emitter = temperatures.condition[index];
      for (std::size_t p = 0; p < condition.part_temperature_k.size(); ++p)
        condition.part_temperature_k[p] =
            std::max(condition.part_temperature_k[p], temperatures.part_k[index][p]);
    }
    ASSIGN_OR_RETURN(auto surroundings, surroundings_from_message(c.surroundings()));
    condition.surroundings = surroundings;
    condition.air_temperature_k = c.air_temperature_k();
    if (temperatures.land.kinds != nullptr) {
      condition.land_temperature_k = temperatures.land.kelvin[request.condition.size()];
      condition.land_temperature_error_k = temperatures.land.error_k[request.condition.size()];
    } else {
      condition.land_temperature_k.assign(c.land_temperature_k().begin(),
                                          c.land_temperature_k().end());
    }
    condition.above_surface_m = above_surface_m(resolved, c);
    if (c.has_plume() && !plumes.empty()) {
      if (c.plume() >= plumes.size())
        return absl::InvalidArgumentError(
            absl::StrCat("a condition has plume ", c.plume(), " of ", plumes.size()));
      condition.gas = plumes[c.plume()];
    }
    // A calm sea has slopes too (sea_slope_variance).
    constexpr double kCalmMS = 1e-6;
    if (c.has_weather() && is_rough_sea(c.surroundings()))
      condition.sea_wind_m_s = std::max(c.weather().wind_speed_m_s(), kCalmMS);
    if (sweep.transport().sun()) {
      ASSIGN_OR_RETURN(const auto sun, condition_sun(resolved, c));
      condition.sun = true;
      condition.sun_direction = body_from_enu(sun.direction, sweep.place().heading_deg());
      condition.sun_cos_zenith = std::cos(sun.zenith_deg * std::numbers::pi / 180);
      condition.sun_angular_radius_deg = sun.angular_radius_deg;
      condition.sun_scale = c.sun_irradiance_from_distance()
                                ? 1 / (sun.distance_au * sun.distance_au)
                                : c.sun_irradiance_w_m2() / kSolarConstantWM2;
      if (environment != nullptr) {
        const Environment::SunSeen& seen =
            environment->sun_seen(static_cast<std::uint32_t>(request.condition.size()));
        condition.sun_direction = seen.direction;
        condition.sun_cos_zenith = -seen.direction.z;
        condition.sun_horizon_z = seen.horizon_z;
      } else if (condition.surroundings.kind != SurroundingsKind::kNone) {
        condition.sun_horizon_z = sine_of_dip(condition.above_surface_m);
      }
    }
    request.condition.push_back(std::move(condition));
  }
  if (has_atmosphere(resolved) && environment == nullptr)
    return absl::InternalError("a job of a sweep with the embedded atmosphere has no environment");
  request.environment = std::move(environment);
  request.land = std::move(land);
  request.emitters = temperatures.emitters;
  ASSIGN_OR_RETURN(auto air, air_from_message(sweep.air()));
  request.air = std::move(air);
  request.selected_condition.assign(job.condition_index().begin(), job.condition_index().end());
  request.selected_band.assign(job.band_index().begin(), job.band_index().end());
  for (const auto& [what, asked, count] :
       {std::tuple{"condition", &request.selected_condition, resolved.condition_size()},
        {"band", &request.selected_band, sweep.band_size()}}) {
    for (const std::uint32_t i : *asked)
      if (i >= static_cast<std::uint32_t>(count))
        return absl::InvalidArgumentError(
            absl::StrCat("a job asks for ", what, " ", i, " of ", count));
  }
  ASSIGN_OR_RETURN(request.accuracy, accuracy_from_message(sweep.accuracy()));
  ASSIGN_OR_RETURN(auto effects, effects_from_message(sweep.effects()));
  request.effects = std::move(effects);
  request.max_reflections = sweep.transport().max_reflections();
  request.seed = sweep.seed();
  request.thumbnail_px = sweep.output().thumbnail_px();
  if (sweep.has_image() && request.thumbnail_px > 0) {
    ASSIGN_OR_RETURN(request.image, image_from_message(sweep.image()));
  }
  if (sweep.plume().has_area_optical_depth())  // older sweeps have none
    request.plume_area_optical_depth = sweep.plume().area_optical_depth();
  return request;
}

}  // namespace irsig
