#include "core/sources/condition_sources.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/check.h"
#include "core/base/ordered_dot.h"
#include "core/environment/sea_glint.h"
#include "core/environment/sea_surface.h"
#include "core/spectral/planck.h"

namespace irsig {

bool sun_shines(const ConditionSpec& condition) {
  return condition.sun && condition.sun_scale > 0 &&
         condition.sun_cos_zenith >
             -std::sin(condition.sun_angular_radius_deg * std::numbers::pi / 180 +
                       std::asin(condition.sun_horizon_z));
}

double in_band(std::span<const double> spectrum, const BandOnAxis& band) {
  return ordered_dot(band.grid.band_weight.data(), spectrum.data() + band.first_node, band.nodes());
}

ConditionSources::ConditionSources(const ConditionSpec& condition,
                                   const ViewEnvironment& environment,
                                   const SourceGeometry& geometry, const SourceLayout& layout,
                                   std::vector<LitSun> suns, const std::vector<double>& node_um,
                                   const EffectSet& effects)
    : layout_(layout),
      sun_(std::move(suns)),
      coldest_k_(1e9),
      hottest_k_(1),
      none_(node_um.size(), 0.0),
      environment_(&environment) {
  const std::size_t nodes = node_um.size();
  for (const double t : condition.part_temperature_k) {
    coldest_k_ = std::min(coldest_k_, t);
    hottest_k_ = std::max(hottest_k_, t);
    Spectrum& radiance = part_.emplace_back(nodes);
    Spectrum& seen = part_apparent_.emplace_back(nodes);
    for (std::size_t i = 0; i < nodes; ++i) {
      radiance[i] = planck_radiance_w_m2_sr_um(node_um[i], t);
      seen[i] = radiance[i] * environment.transmittance[i];
    }
  }
  coldest_k_ = std::clamp(coldest_k_, 1.0, hottest_k_);
  if (geometry.glitters())
    for (const LitSun& sun : sun_) {
      std::vector<Spectrum>& of_sun = glint_.emplace_back();
      std::vector<Spectrum>& of_sun_apparent = glint_apparent_.emplace_back();
      for (const float cosine : kGlintCosines) {
        Spectrum& radiance = of_sun.emplace_back(nodes);
        Spectrum& seen = of_sun_apparent.emplace_back(nodes);
        for (std::size_t i = 0; i < nodes; ++i) {
          const double reflectance =
              water_reflectance(sea_water_index(node_um[i]), static_cast<double>(cosine));
          radiance[i] = reflectance * sun.irradiance[i];
          seen[i] = reflectance * sun.apparent[i];
        }
      }
    }
  light_.reserve(layout.count());
  for (const SourceId id : layout.all()) light_.push_back(light_of(id, geometry.emitters, effects));
}

ConditionSources::Light ConditionSources::light_of(SourceId id, const Emitters& emitters,
                                                   const EffectSet& effects) const {
  using Kind = SourceLayout::Kind;
  const SourceLayout::Place at = layout_.place_of(id);
  const Light dark{none_.data(), none_.data(), none_.data()};
  const auto light = [&](const Spectrum& radiance, const Spectrum& apparent) {
    return Light{radiance.data(), apparent.data(), none_.data()};
  };
  const auto of_node = [&] {
    Light node = light(environment_->node[at.index], environment_->node_apparent[at.index]);
    if (!environment_->node_interpolation.empty())
      node.interpolation = environment_->node_interpolation[at.index].data();
    return node;
  };
  const auto of_emitter = [&] {
    const std::uint32_t part = emitters.part_of(at.index);
    IRSIG_CHECK(part < part_.size());
    return light(part_[part], part_apparent_[part]);
  };
  // Which of those that shine; another condition's: behind the last.
  const auto lit = static_cast<std::size_t>(
      std::find_if(sun_.begin(), sun_.end(),
                   [&](const LitSun& sun) { return sun.index == at.index; }) -
      sun_.begin());
  switch (at.kind) {
    case Kind::kSeen:
      return of_emitter();
    case Kind::kReflected:
      return effects.parts ? of_emitter() : dark;
    case Kind::kSky:
      return effects.sky ? of_node() : dark;
    case Kind::kLower:
      return effects.lower ? of_node() : dark;
    case Kind::kSun:
      return lit < sun_.size() && sun_[lit].direct ? light(sun_[lit].irradiance, sun_[lit].apparent)
                                                   : dark;
    case Kind::kGlint:
      return lit < sun_.size() ? light(glint_[lit][at.glint], glint_apparent_[lit][at.glint])
                               : dark;
    case Kind::kBehind:
      return light(none_, environment_->behind_apparent[at.index]);
  }
  return dark;
}

std::array<std::vector<SourceRange>, kCauses> ConditionSources::causes() const {
  std::vector<std::uint32_t> shining;
  for (const LitSun& sun : sun_) shining.push_back(sun.index);
  return layout_.causes(shining);
}

double ConditionSources::part_w_m2_sr(std::uint32_t part, const BandOnAxis& band) const {
  return in_band(part_[part], band);
}

double ConditionSources::brightest_thermal_w_m2_sr(const BandOnAxis& band) const {
  double thermal = 0;
  for (const Spectrum& node : environment_->node) thermal = std::max(thermal, in_band(node, band));
  for (const Spectrum& p : part_) thermal = std::max(thermal, in_band(p, band));
  return thermal;
}

double ConditionSources::brightest_w_m2_sr(const BandOnAxis& band) const {
  double sum = brightest_thermal_w_m2_sr(band);
  for (const LitSun& sun : sun_) sum += in_band(sun.irradiance, band) / std::numbers::pi;
  return sum;
}

}  // namespace irsig
