#include "live/place_light.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/signature/view/prepared_view.h"
#include "core/signature/view/shading.h"

namespace irsig {
namespace {

// Returns the cosine of a node of tables by cosine; 0 would have no direction.
float node_cosine(std::uint32_t c) {
  const float root = static_cast<float>(c) / (kEmissionCosines - 1);
  return std::max(root * root, 1e-5f);
}

// Ranges of land, from the nearest that a camera comes to.
constexpr double kNearestLandM = 20, kLandRangeStep = 1.4;
constexpr std::size_t kMostLandRanges = 28;

std::vector<double> land_ranges_of(const LandScene& land, double farthest_m) {
  const HeightGrid& map = land.field->outer();
  const double across_m =
      std::hypot(map.columns * map.spacing_m, map.rows * map.spacing_m) + farthest_m;
  const double steps = std::min(std::log(across_m / kNearestLandM) / std::log(kLandRangeStep),
                                static_cast<double>(kMostLandRanges - 1));
  std::vector<double> out{1};
  for (int i = 0; i <= static_cast<int>(std::ceil(steps)); ++i)
    out.push_back(kNearestLandM *
                  std::pow(across_m / kNearestLandM, i / std::ceil(std::max(steps, 1.0))));
  return out;
}

// z of the directions on one side of a horizon, from it on.
double side_z(double horizon_z, bool above, std::uint32_t node) {
  const double f = static_cast<double>(node) / (kSideNodes - 1), end = above ? -1 : 1;
  return horizon_z + f * f * (end - horizon_z);
}

EffectSet effect_set(const ViewRequest& request, const LiveEffects& on) {
  EffectSet out = EffectSet::everything(request.condition.size(),
                                        std::max(request.max_reflections, std::uint32_t{1}));
  out.sky = out.lower = on.sky;
  out.parts = on.parts;
  if (!on.sun)
    std::fill(out.sun.begin(), out.sun.end(), EffectSet::Sun{false, false, false, false, false});
  return out;
}

void add_to(float weight, const std::vector<float>& from, std::vector<float>& to) {
  if (to.empty()) to.assign(from.size(), 0.0f);
  for (std::size_t i = 0; i < from.size(); ++i) to[i] += weight * from[i];
}

bool is_on(Effect effect, const LiveEffects& on) {
  switch (effect) {
    case Effect::kDirectSun:
    case Effect::kDiffuseSun:
    case Effect::kMirroredSun:
    case Effect::kPathSun:
    case Effect::kBackgroundSun:
      return on.sun;
    case Effect::kSkyReflected:
    case Effect::kLowerReflected:
      return on.sky;
    case Effect::kInterReflection:
      return on.parts;
    default:
      return true;
  }
}

std::vector<Effect> effects_on(const LiveEffects& on) {
  std::vector<Effect> out;
  for (const EffectInfo& info : effect_table())
    if (info.switchable && is_on(info.effect, on)) out.push_back(info.effect);
  return out;
}

}  // namespace

EffectChoice live_effects(const LiveEffects& on, EffectChoice otherwise) {
  if (on == LiveEffects{}) return otherwise;
  otherwise.mode = EffectChoice::Mode::kOnly;
  otherwise.only = effects_on(on);
  return otherwise;
}

std::vector<std::string> names_of(const LiveEffects& on) {
  std::vector<std::string> out;
  for (const Effect effect : effects_on(on)) out.emplace_back(info_of(effect).name);
  return out;
}

void PlaceLight::add(float weight, const PlaceLight& other) {
  add_to(weight, other.emitted, emitted);
  add_to(weight, other.blackbody, blackbody);
  add_to(weight, other.reflected, reflected);
  add_to(weight, other.sun, sun);
  add_to(weight, other.sun_reflected, sun_reflected);
  sun_total += weight * other.sun_total;
  add_to(weight, other.background, background);
  add_to(weight, other.land, land);
  add_to(weight, other.land_sun, land_sun);
  add_to(weight, other.land_error, land_error);
  add_to(weight, other.gas, gas);
  path += weight * other.path;
}

// The view's own light as the core has it.
struct PlaceLights::Made {
  ViewRequest request;
  std::shared_ptr<const ViewEnvironments> environments;
  std::unique_ptr<const ViewSources> sources;
};

absl::StatusOr<double> PlaceLights::horizon_z(const Viewpoint& viewpoint) const {
  if (const Environment* environment = sweep_->environment())
    return environment->horizon(environment->line(viewpoint)).z;
  ASSIGN_OR_RETURN(const auto made, this->made(viewpoint));
  return made.environments->horizon ? made.environments->horizon->z : 0;
}

absl::StatusOr<PlaceLights::Made> PlaceLights::made(const Viewpoint& viewpoint) const {
  LiveCamera camera;
  camera.azimuth_deg = viewpoint.aspect_azimuth_deg;
  camera.elevation_deg = viewpoint.aspect_elevation_deg;
  camera.range_m = viewpoint.range_m;
  ASSIGN_OR_RETURN(auto request, sweep_->request(choice_.condition, choice_.band, camera));
  request.image.reset();
  const PreparedScene& scene = sweep_->simulator().scene();
  std::optional<BackgroundDirections> directions;
  if (const Environment* environment = sweep_->environment()) {
    const double horizon = environment->horizon(environment->line(viewpoint)).z;
    std::vector<float> z;
    for (std::uint32_t k = kSideNodes; k-- > 0;)
      z.push_back(static_cast<float>(side_z(horizon, true, k)));
    for (std::uint32_t k = 0; k < kSideNodes; ++k)
      z.push_back(static_cast<float>(side_z(horizon, false, k)));
    const Vec<Body> towards =
        body_from_aspect(viewpoint.aspect_azimuth_deg, viewpoint.aspect_elevation_deg);
    directions.emplace(std::move(z), std::atan2(-towards.y, -towards.x));
  }
  ASSIGN_OR_RETURN(
      auto surroundings,
      ViewSurroundings::make(request, scene.target, viewpoint.range_m, scene.axis.node_um(),
                             directions ? &*directions : nullptr,
                             request.land != nullptr ? &frame_.land_range_m : nullptr));
  const EffectSet effects = effect_set(request, choice_.effects);
  const std::vector<std::uint32_t> wanted{choice_.condition};
  ASSIGN_OR_RETURN(auto environments, surroundings.evaluate(wanted, effects));
  Made out;
  out.environments = std::make_shared<const ViewEnvironments>(std::move(environments));
  out.sources = std::make_unique<const ViewSources>(source_request(scene, request, wanted), effects,
                                                    out.environments, scene.axis.node_um());
  out.request = std::move(request);
  return out;
}

absl::StatusOr<std::unique_ptr<const PlaceLights>> PlaceLights::make(
    std::shared_ptr<const LiveSweep> sweep, std::shared_ptr<const ReflectedSky> reflected,
    const LiveChoice& choice, const Viewpoint& viewpoint) {
  std::unique_ptr<PlaceLights> out(new PlaceLights);
  out->sweep_ = std::move(sweep);
  out->choice_ = choice;
  const PreparedScene& scene = out->sweep_->simulator().scene();
  if (const LandScene* land = out->sweep_->land()) {
    constexpr double kFarthestM = 2e5;
    out->frame_.land_range_m = land_ranges_of(*land, kFarthestM);
  }
  ASSIGN_OR_RETURN(const auto first, out->made(viewpoint));
  out->reflected_ = reflected != nullptr ? std::move(reflected)
                                         : std::make_shared<const ReflectedSky>(
                                               scene, first.environments->directions);
  const ConditionSources& light = first.sources->wanted(0);
  const SpectralBasis* basis = scene.path_basis();
  LightFrame& f = out->frame_;
  f.materials = static_cast<std::uint32_t>(scene.material.size());
  f.lights = light.layout().emitted().size();
  const BandOnAxis band = scene.axis.band(choice.band);
  if (basis != nullptr && basis->identity()) {
    f.first_column = band.first_node;
    f.columns = static_cast<std::uint32_t>(band.nodes());
  } else if (basis != nullptr) {
    f.columns = static_cast<std::uint32_t>(basis->columns());
  }
  const ConditionSpec& condition = first.request.condition[choice.condition];
  f.sun = condition.sun_direction;
  f.sun_shines = choice.effects.sun && sun_shines(condition) && !light.suns().empty();
  const std::size_t parts = scene.target.part.size();
  const Emitters& emitters = first.sources->geometry().emitters;
  for (std::uint32_t e = 0; e < emitters.count(parts); ++e) {
    f.emitter.push_back(light.fraction_of(e));
    float kelvin = condition.emitter != nullptr ? condition.emitter->kelvin[e] : NAN;
    if (std::isnan(kelvin))
      kelvin = static_cast<float>(condition.part_temperature_k[emitters.part_of(e)]);
    f.kelvin.push_back(kelvin);
  }
  if (const LandScene* land = out->sweep_->land()) {
    f.land_materials = land->cover.materials();
    f.kinds = std::get<Land>(first.sources->geometry().boundary).kinds();
  }
  if (condition.surroundings.kind != SurroundingsKind::kNone)
    out->above_surface_m_ = condition.above_surface_m;
  out->has_air_ = first.request.air.model != AirModel::kVacuum;
  if (condition.gas != nullptr) {
    auto gas = LiveGas::make(scene, condition.gas, light, choice.band,
                             out->background_node(viewpoint, *first.environments));
    // Without a table, pixels that may show gas are flagged.
    if (gas.ok()) out->gas_ = *std::move(gas);
  }
  if (f.sun_shines && choice.effects.parts) {
    ASSIGN_OR_RETURN(const auto here, out->at(viewpoint));
    f.own_sun = out->sweep_->own_parts().sunlight(
        scene.target, f.sun, [&](std::uint32_t material, float cosine) {
          return at_cosine(here.sun_reflected.data() + material * kEmissionCosines, cosine) /
                 here.sun_total;
        });
  }
  return out;
}

double PlaceLights::least_elevation_deg(double range_m) const {
  constexpr double kLeastHeightM = 2;
  if (std::isinf(above_surface_m_)) return -90;
  return std::asin(std::clamp((kLeastHeightM - above_surface_m_) / range_m, -1.0, 1.0)) /
         kRadPerDeg;
}

double PlaceLights::land_bend_per_m(const Viewpoint& viewpoint) const {
  return irsig::land_bend_per_m(sweep_->environment(), viewpoint,
                                std::isinf(above_surface_m_) ? 0 : above_surface_m_);
}

bool PlaceLights::depends_on_azimuth() const {
  return sweep_->environment() != nullptr && choice_.effects.sun &&
         sweep_->environment()->sun_seen(choice_.condition).visible > 0;
}

// Rings of what is around the target, as columns want them. Over land the rings below the horizon
// are the land at the target's feet.
std::vector<double> PlaceLights::around_rings(const ViewSources& sources,
                                              const SourceTable& table) const {
  const ConditionSources& light = sources.wanted(0);
  const SourceLayout& layout = light.layout();
  const std::size_t columns = table.columns;
  const std::uint32_t azimuths = sources.geometry().directions.azimuths(),
                      rings = layout.around().size() / azimuths,
                      sky_rings = layout.sky().size() / azimuths;
  std::vector<double> out(rings * columns, 0.0);
  for (std::uint32_t r = 0; r < rings; ++r)
    for (std::uint32_t a = 0; a < azimuths; ++a)
      for (std::size_t k = 0; k < columns; ++k)
        out[r * columns + k] +=
            table.apparent[(layout.around().first + r * azimuths + a) * columns + k] / azimuths;
  const Land* land = std::get_if<Land>(&sources.geometry().boundary);
  if (land == nullptr) return out;
  const PreparedScene& scene = sweep_->simulator().scene();
  LandMix mix;
  const Vec<Body> above{0, 0, -2 * scene.target.radius_m};
  const auto at = land->meet(above, {0, 0, 1}, mix);
  if (!at) return out;
  std::vector<double> below(columns, 0.0);
  const auto add = [&](SourceId id, double weight) {
    for (std::size_t k = 0; k < columns; ++k)
      below[k] += weight * table.apparent[index_of(id) * columns + k];
  };
  const SourceLayout paths(scene.target.part.size(), sources.geometry());
  const auto add_path = [&](SourceId of_paths, double weight) {
    if (const auto id = light.light_of_path(of_paths)) add(*id, weight);
  };
  const Land::RangeShare range = Land::around(2 * scene.target.radius_m);
  for (const KindShare& part : mix.kind)
    add_path(paths.land(part.kind, range.node), static_cast<double>(part.share));
  for (std::uint32_t j = 0; j < sources.geometry().sun.size(); ++j)
    if (const double cosine = land->sun_cosine(*at, sources.geometry().sun[j].direction);
        cosine > 0)
      for (std::uint32_t m = 0; m < mix.fraction.size(); ++m)
        add_path(paths.land_sun(j, m, range.node), cosine * static_cast<double>(mix.fraction[m]));
  for (std::uint32_t r = sky_rings; r < rings; ++r)
    std::copy(below.begin(), below.end(), out.begin() + static_cast<std::ptrdiff_t>(r * columns));
  return out;
}

void PlaceLights::fill_land(const ViewSources& sources, PlaceLight& out) const {
  const ConditionSources& light = sources.wanted(0);
  const PreparedScene& scene = sweep_->simulator().scene();
  const BandOnAxis band = scene.axis.band(choice_.band);
  const SourceLayout paths(scene.target.part.size(), sources.geometry());
  const auto ranges = static_cast<std::uint32_t>(frame_.land_range_m.size());
  const auto seen = [&](SourceId of_paths) {
    const auto id = light.light_of_path(of_paths);
    return id ? static_cast<float>(irsig::in_band(light.apparent(*id), band)) : 0.0f;
  };
  for (std::uint32_t k = 0; k < frame_.kinds + frame_.land_materials; ++k)
    for (std::uint32_t r = 0; r < ranges; ++r) {
      const SourceId id = paths.behind_land(k, r);
      out.land.push_back(seen(id));
      const auto of_light = light.light_of_path(id);
      out.land_error.push_back(
          of_light ? static_cast<float>(light.land_error_w_m2_sr(*of_light, band).apparent) : 0.0f);
    }
  for (std::uint32_t m = 0; m < frame_.land_materials; ++m)
    for (std::uint32_t r = 0; r < ranges; ++r)
      out.land_sun.push_back(sources.geometry().sun.empty() ? 0.0f
                                                            : seen(paths.behind_land_sun(0, m, r)));
}

// Returns the node of the background that is seen behind the target.
std::size_t PlaceLights::background_node(const Viewpoint& viewpoint,
                                         const ViewEnvironments& environments) const {
  const double z =
      -body_from_aspect(viewpoint.aspect_azimuth_deg, viewpoint.aspect_elevation_deg).z;
  if (sweep_->environment() == nullptr || !environments.horizon)
    return z < 0 ? 0 : environments.condition[choice_.condition].background_apparent.size() - 1;
  const double horizon = environments.horizon->z;
  const bool above = z < horizon;
  std::uint32_t nearest = 0;
  for (std::uint32_t k = 1; k < kSideNodes; ++k)
    if (std::abs(side_z(horizon, above, k) - z) < std::abs(side_z(horizon, above, nearest) - z))
      nearest = k;
  return above ? kSideNodes - 1 - nearest : kSideNodes + nearest;
}

absl::StatusOr<PlaceLight> PlaceLights::at(const Viewpoint& viewpoint) const {
  ASSIGN_OR_RETURN(const auto made, this->made(viewpoint));
  const PreparedScene& scene = sweep_->simulator().scene();
  const ConditionSources& light = made.sources->wanted(0);
  const BandOnAxis band = scene.axis.band(choice_.band);
  const SpectralBasis* basis = scene.path_basis();
  const SourceTable table = source_table(light, basis, band.first_node, band.grid.band_weight);
  const std::size_t columns = table.columns;
  PlaceLight out;
  out.path = static_cast<float>(irsig::in_band(light.environment().path_radiance, band));
  std::vector<float> emissivity(basis == nullptr ? 1 : scene.carried_material().front().nodes());
  // Light of a source's row that a material takes, which is what it emits of a blackbody's.
  const auto absorbed = [&](const Material& material, float cosine, const double* row) {
    if (basis == nullptr)
      emissivity[0] = material.emissivity(cosine);
    else
      material.spectral_emissivity(cosine, emissivity.data());
    double sum = 0;
    for (std::size_t k = 0; k < columns; ++k)
      sum += static_cast<double>(emissivity[frame_.first_column + k]) * row[k];
    return static_cast<float>(sum);
  };
  for (const Material& material : scene.carried_material())
    for (std::uint32_t s = 0; s < frame_.lights; ++s) {
      const double* row = table.apparent.data() + index_of(light.layout().seen(s)) * columns;
      for (std::uint32_t c = 0; c < kEmissionCosines; ++c)
        out.emitted.push_back(absorbed(material, node_cosine(c), row));
    }
  for (std::uint32_t s = 0; s < frame_.lights; ++s)
    out.blackbody.push_back(
        static_cast<float>(irsig::in_band(light.apparent(light.layout().seen(s)), band)));
  std::vector<double> rings = around_rings(*made.sources, table);
  rings.resize(std::max<std::size_t>(rings.size(), reflected_->rings() * columns), 0.0);
  for (std::uint32_t m = 0; m < frame_.materials; ++m) {
    const std::vector<float> of = reflected_->of(m, rings, frame_.first_column, columns);
    out.reflected.insert(out.reflected.end(), of.begin(), of.end());
  }
  if (frame_.sun_shines) {
    const SourceId sun = light.layout().sun(light.suns().front().index);
    const double* row = table.apparent.data() + index_of(sun) * columns;
    for (std::size_t k = 0; k < columns; ++k) out.sun.push_back(static_cast<float>(row[k]));
    out.sun_total = static_cast<float>(irsig::in_band(light.apparent(sun), band));
    for (const Material& material : scene.carried_material())
      for (std::uint32_t c = 0; c < kEmissionCosines; ++c)
        out.sun_reflected.push_back(out.sun_total - absorbed(material, node_cosine(c), row));
  }
  const auto& background = light.environment().background_apparent;
  if (sweep_->environment() != nullptr) {
    for (std::uint32_t k = 0; k < kSideNodes; ++k)
      out.background.push_back(
          static_cast<float>(irsig::in_band(background[kSideNodes - 1 - k], band)));
    for (std::uint32_t k = 0; k < kSideNodes; ++k)
      out.background.push_back(
          static_cast<float>(irsig::in_band(background[kSideNodes + k], band)));
  } else {
    for (const std::size_t side : {std::size_t{0}, background.size() - 1})
      out.background.insert(out.background.end(), kSideNodes,
                            static_cast<float>(irsig::in_band(background[side], band)));
  }
  if (gas_ != nullptr) {
    ASSIGN_OR_RETURN(out.gas, gas_->weights(light, background_node(viewpoint, *made.environments)));
  }
  if (frame_.kinds > 0) fill_land(*made.sources, out);
  return out;
}

}  // namespace irsig
