#include "runner/heat_field.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/accuracy/quantities.h"
#include "core/base/hottest.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/effects/effects.h"
#include "core/geo/sun.h"
#include "core/thermal/scene/part_temperatures.h"
#include "core/thermal/scene/scene_heat.h"
#include "messages/environment/weather_from_message.h"
#include "messages/inputs/moved_sweep.h"
#include "messages/scene/scene_from_message.h"
#include "runner/heat_land.h"
#include "runner/heat_walls.h"
#include "runner/heat_weather.h"
#include "runner/model_mesh.h"
#include "runner/sweep_land.h"
#include "schema/heat_run.h"

namespace irsig {
namespace {

void add_parts(const std::vector<PartTemperature>& parts, schema::HeatJobResult& out) {
  for (const PartTemperature& part : parts) {
    schema::PartTemperature& row = *out.add_part();
    row.set_part_index(part.part);
    row.set_time_index(static_cast<std::uint32_t>(part.output));
    row.set_mean_k(part.mean_k);
    row.set_coldest_k(part.coldest_k);
    row.set_hottest_k(part.hottest_k);
    row.set_error_k(part.error_k);
  }
}

std::string bytes_of(const std::vector<std::vector<float>>& rows) {
  static_assert(std::endian::native == std::endian::little);
  std::string out;
  for (const std::vector<float>& row : rows)
    out.append(reinterpret_cast<const char*>(row.data()), sizeof(float) * row.size());
  return out;
}

// Facets are under water as a whole, where their middle is: what rises out of it is seen as warm as
// the water. Empty: none rises by more than a hundredth of its height.
std::string crossing_warning(const Target& target, const std::vector<HeatPart>& part,
                             double surface_z_m) {
  const SurfaceCrossing crossing = surface_crossing(target, part, surface_z_m);
  if (crossing.count == 0) return "";
  return absl::StrFormat(
      "heat: %d facets whose middle is under the surface rise above it, up to %.3g m, and have "
      "its temperature as a whole: element_size_m cuts them",
      crossing.count, crossing.highest_m);
}

// Facets that nothing from outside reaches have no temperature: how many, and where the first is.
std::string dark_warning(const schema::Sweep& sweep, const Target& target,
                         const std::vector<HeatPart>& part, const SceneHeatResult& heat) {
  const UnreachedFacets dark = unreached_facets(target, part, heat);
  if (dark.count == 0) return "";
  return absl::StrCat(
      "heat: ", dark.count, " of ", target.facet.size(),
      " facets stand inside other bodies (the first: facet ", dark.first, " of part \"",
      sweep.part(static_cast<int>(target.facet[dark.first].part)).name(),
      "\"): no ray from outside reaches them, and they are taken for as warm as the rest of "
      "their part");
}

// The request of one heat run, and for each requested time the index of its output.
struct Asked {
  SceneHeatRequest request;
  std::vector<std::size_t> output_of_time;
  std::vector<std::string> warning;
};
absl::StatusOr<Asked> asked_of(const schema::Sweep& sweep, const schema::HeatRun& heat,
                               const Target& target) {
  Asked out;
  SceneHeatRequest& request = out.request;
  ASSIGN_OR_RETURN(auto weather, heat_weather(sweep, heat));
  ASSIGN_OR_RETURN(request.build_up, walls_at_knots(sweep, weather.knot_s));
  for (int p = 0; p < sweep.part_size(); ++p) {
    const int m = static_cast<int>(target.part[static_cast<std::size_t>(p)].material);
    ASSIGN_OR_RETURN(
        const auto surface,
        heat_surface(sweep.material(m), absl::StrCat("material[", m, "]"), out.warning));
    HeatPart part{surface.solar_absorptance, surface.emissivity, std::nullopt,
                  heat.part_temperature_k(p)};
    for (std::uint32_t b = 0; b < request.build_up.size() && part.stated_k == 0; ++b)
      if (request.build_up[b].name == sweep.part(p).build_up()) part.build_up = b;
    request.part.push_back(part);
  }
  out.warning.insert(out.warning.end(), weather.warning.begin(), weather.warning.end());
  request.beneath = weather.beneath;
  if (std::string crossing =
          computes_parts(heat) ? crossing_warning(target, request.part, request.beneath.surface_z_m)
                               : "";
      !crossing.empty())
    out.warning.push_back(std::move(crossing));
  request.knot_s = weather.knot_s;
  request.weather = weather.at;
  if (heat.has_sky_factor())
    for (HeatWeather& at : request.weather)
      for (HeatRadiation* radiation : {&at.before, &at.after})
        radiation->sky_w_m2 *= heat.sky_factor();
  if (heat.has_convection_factor()) request.convection_factor = heat.convection_factor();
  request.day_knots = weather.day_knots;
  request.output_knot = weather.output_knot;
  request.rays = sweep.heat().rays();
  request.seed = sweep.seed();
  request.tolerance_k = sweep.heat().tolerance_k();
  for (const std::string& name : sweep.effects().without()) {
    const auto effect = effect_named(name);
    if (effect == Effect::kHeatExchange)
      request.exchange = false;
    else if (effect == Effect::kHeatDiffuseSun)
      request.diffuse_sun = false;
    else if (!effect || !is_of_plume(*effect))
      return keyed_problem("effects.without", absl::StrCat("\"", name,
                                                           "\" is no effect of computed "
                                                           "temperatures"));
  }
  out.output_of_time = weather.output_of_time;
  return out;
}

// Adds the bounds of all effects on temperatures if at least one of them is off.
void add_effects(const SceneHeatRequest& request, const SceneHeatResult& heat,
                 schema::HeatField& field) {
  if (request.exchange && request.diffuse_sun) return;
  const auto add = [&](Effect which, bool on, const std::vector<float>& bound_k) {
    schema::HeatEffect& effect = *field.add_effect();
    effect.set_effect(std::string(info_of(which).name));
    effect.set_off(!on);
    effect.set_bound_k(bytes_of({bound_k}));
  };
  add(Effect::kHeatExchange, request.exchange, heat.exchange_bound_k);
  add(Effect::kHeatDiffuseSun, request.diffuse_sun, heat.diffuse_sun_bound_k);
}

// Checks that the walls lead to temperatures that are possible.
absl::Status check_temperatures(const schema::Sweep& sweep, const schema::HeatRun& heat,
                                const Target& target, const SceneHeatResult& by_time) {
  for (std::size_t o = 0; o < by_time.kelvin.size(); ++o)
    for (std::size_t f = 0; f < by_time.kelvin[o].size(); ++f) {
      const float kelvin = by_time.kelvin[o][f];
      if (std::isnan(kelvin) || (kelvin > 0 && static_cast<double>(kelvin) <= kHottestK)) continue;
      const schema::Part& part = sweep.part(static_cast<int>(target.facet[f].part));
      return problem_status({{"", absl::StrCat("part[", target.facet[f].part, "].build_up"),
                              absl::StrCat("part \"", part.name(), "\" would be at ", kelvin,
                                           " K at ", heat.time_utc(static_cast<int>(o)),
                                           ": no weather makes up for what build_up \"",
                                           part.build_up(), "\" says of its inside")}});
    }
  return absl::OkStatus();
}

// The temperatures of facets at each time wanted; their parts' and warnings are added to `out` and
// `asked`. Of a run that computes land alone no facet has one.
absl::StatusOr<SceneHeatResult> solve_parts(const schema::Sweep& sweep, const schema::HeatRun& heat,
                                            const Mesh& mesh, const Target& target, Asked& asked,
                                            schema::HeatJobResult& out) {
  SceneHeatResult by_time;
  if (!computes_parts(heat)) {
    const std::vector<float> none(target.facet.size(), NAN);
    by_time.kelvin.assign(asked.output_of_time.size(), none);
    by_time.error_k = by_time.kelvin;
    by_time.exchange_bound_k = by_time.diffuse_sun_bound_k = none;
    return by_time;
  }
  auto solved = solve_scene_heat(target, asked.request);
  if (!solved.ok()) return at_key("heat", solved.status());
  by_time.exchange_bound_k = std::move(solved->exchange_bound_k);
  by_time.diffuse_sun_bound_k = std::move(solved->diffuse_sun_bound_k);
  // Times of several days may share a knot of the one that repeats.
  for (const std::size_t k : asked.output_of_time) {
    by_time.kelvin.push_back(solved->kelvin[k]);
    by_time.error_k.push_back(solved->error_k[k]);
  }
  RETURN_IF_ERROR(check_temperatures(sweep, heat, target, by_time));
  if (std::string dark = dark_warning(sweep, target, asked.request.part, by_time); !dark.empty())
    asked.warning.push_back(std::move(dark));
  const std::vector<PartTemperature> parts_k =
      part_temperatures(target, facet_areas_m2(mesh), by_time);
  add_parts(parts_k, out);
  fill_degenerate(target, asked.request.part, parts_k, by_time);
  return by_time;
}

// By how much each input of a run changes its temperatures.
//   ground_k  [input] what the target sees of land, at each knot; empty: it is not computed
absl::Status add_changes(const schema::ResolvedSweep& resolved, std::size_t run,
                         const Target& target, const Asked& asked,
                         const std::vector<std::vector<double>>& ground_k,
                         schema::HeatField& field) {
  const schema::HeatRun& heat = resolved.heat(static_cast<int>(run));
  schema::ResolvedSweep alone;  // what walls depend on
  *alone.mutable_sweep() = resolved.sweep();
  *alone.add_heat() = heat;
  std::vector<SceneHeatRequest> moved;
  std::vector<int> input_of;  // of `moved`
  for (int i = 0; i < heat.input_size(); ++i) {
    const schema::InputMove& input = heat.input(i);
    const MovedSweep sweep = moved_sweep(alone, {input.name(), input.sigma()}, input.move());
    const std::vector<double>* ground =
        ground_k.empty() ? nullptr : &ground_k[static_cast<std::size_t>(i)];
    const bool other_ground =
        ground != nullptr && *ground != asked.request.beneath.temperature_at_k;
    if (!computes_parts(heat) || !(other_ground || moves_parts(alone, sweep.sweep, 0))) continue;
    auto request = asked_of(sweep.sweep.sweep(), sweep.sweep.heat(0), target);
    if (!request.ok()) return at_key(absl::StrCat("uncertainty.", input.name()), request.status());
    request->request.of_model = is_of_heat_model(input.name());
    if (ground != nullptr) request->request.beneath.temperature_at_k = *ground;
    moved.push_back(std::move(request->request));
    input_of.push_back(i);
  }
  const std::vector<std::vector<float>> none(asked.output_of_time.size(),
                                             std::vector<float>(target.facet.size(), 0));
  for (int i = 0; i < heat.input_size(); ++i) field.add_change_k(bytes_of(none));
  if (moved.empty()) return absl::OkStatus();
  auto changes = solve_scene_heat_changes(target, asked.request, moved);
  if (!changes.ok()) return at_key("heat", changes.status());
  for (std::size_t i = 0; i < changes->size(); ++i) {
    TemperatureChange& change = (*changes)[i];
    for (std::vector<float>& row : change) fill_degenerate(target, asked.request.part, row);
    std::vector<std::vector<float>> by_time;
    for (const std::size_t k : asked.output_of_time) by_time.push_back(change[k]);
    field.set_change_k(input_of[i], bytes_of(by_time));
  }
  return absl::OkStatus();
}

// The land that a caller has read, else the sweep's own.
absl::StatusOr<std::shared_ptr<const LandScene>> land_of(const schema::ResolvedSweep& sweep,
                                                         const Assets& assets,
                                                         const LandScene* land) {
  if (land == nullptr) return land_from_sweep(sweep, assets);
  return std::shared_ptr<const LandScene>(std::shared_ptr<void>(), land);
}

// Empty: the surroundings' own surface stays, that of water or of no land on the map.
std::vector<double> ground_seen_k(const Asked& asked, const Mesh& mesh, const LandScene& land,
                                  const LandCourse& course,
                                  const std::vector<std::vector<float>>& difference_k) {
  const GroundBoundary& beneath = asked.request.beneath;
  if (beneath.water || !std::isfinite(beneath.surface_z_m)) return {};
  return ground_around_k(land, course, difference_k, mesh, beneath.surface_z_m,
                         asked.request.knot_s);
}

}  // namespace

absl::StatusOr<schema::HeatJobResult> compute_heat(const schema::ResolvedSweep& resolved,
                                                   const Assets& assets, std::size_t run,
                                                   const LandScene* land) {
  const schema::Sweep& sweep = resolved.sweep();
  if (run >= static_cast<std::size_t>(resolved.heat_size()))
    return absl::InvalidArgumentError(
        absl::StrCat("a job asks for temperatures ", run, " of ", resolved.heat_size()));
  const schema::HeatRun& heat = resolved.heat(static_cast<int>(run));
  ASSIGN_OR_RETURN(const auto mesh, model_mesh(resolved, assets));
  ASSIGN_OR_RETURN(auto parts, parts_from_sweep(sweep));
  ASSIGN_OR_RETURN(const auto target, make_target(mesh, std::move(parts), widest_isa()));

  ASSIGN_OR_RETURN(auto asked, asked_of(sweep, heat, target));
  schema::HeatJobResult out;
  schema::HeatField field;
  for (const std::string& time : heat.time_utc()) {
    ASSIGN_OR_RETURN(const auto utc, parse_rfc3339(time));
    field.add_unix_s(unix_seconds(utc));
  }
  field.set_facets(static_cast<std::uint32_t>(target.facet.size()));
  if (heat.input_size() > 0) {  // the run whose temperatures change has said what is odd
    std::vector<std::vector<double>> ground_k;
    if (changes_land(heat)) {
      ASSIGN_OR_RETURN(const auto scene, land_of(resolved, assets, land));
      ASSIGN_OR_RETURN(auto changes, compute_land_changes(resolved, heat, *scene));
      for (std::string& change : changes.change_k) field.add_land_change_k(std::move(change));
      const auto ground = [&](const std::vector<std::vector<float>>& difference_k) {
        return ground_seen_k(asked, mesh, *scene, changes.course, difference_k);
      };
      asked.request.beneath.temperature_at_k = ground({});
      for (const auto& difference_k : changes.difference_k)
        ground_k.push_back(ground(difference_k));
    }
    RETURN_IF_ERROR(add_changes(resolved, run, target, asked, ground_k, field));
    out.set_field(field.SerializeAsString());
    return out;
  }

  if (computes_land(heat)) {  // which the target sees
    ASSIGN_OR_RETURN(const auto scene, land_of(resolved, assets, land));
    LandCourse course;
    ASSIGN_OR_RETURN(*field.mutable_land(),
                     compute_land_heat(sweep, heat, *scene, asked.warning, course));
    asked.request.beneath.temperature_at_k = ground_seen_k(asked, mesh, *scene, course, {});
  }
  ASSIGN_OR_RETURN(const auto by_time, solve_parts(sweep, heat, mesh, target, asked, out));
  field.set_kelvin(bytes_of(by_time.kelvin));
  field.set_error_k(bytes_of(by_time.error_k));
  add_effects(asked.request, by_time, field);
  out.set_field(field.SerializeAsString());
  out.mutable_warning()->Assign(asked.warning.begin(), asked.warning.end());
  return out;
}

}  // namespace irsig
