#include "core/sources/condition_sources.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/base/check.h"
#include "core/base/constants.h"
#include "core/base/ordered_dot.h"
#include "core/environment/sea/sea_glint.h"
#include "core/environment/sea/sea_surface.h"
#include "core/spectral/planck.h"

namespace irsig {

double sine_of_dip(double height_m) {
  const double r = kEarthRadiusM + height_m;
  return std::sqrt(height_m * (kEarthRadiusM + r)) / r;
}

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
                                   const SourceGeometry& geometry, const LightLayout& layout,
                                   std::vector<LitSun> suns, const std::vector<double>& node_um,
                                   const EffectSet& effects,
                                   std::span<const std::vector<double>> land_emissivity)
    : layout_(layout),
      emitter_(condition.emitter),
      sun_(std::move(suns)),
      coldest_k_(1e9),
      hottest_k_(1),
      parts_(condition.part_temperature_k.size()),
      none_(node_um.size(), 0.0),
      around_(environment.around.only(effects.sky, effects.lower)),
      environment_(&environment) {
  const std::size_t nodes = node_um.size();
  std::map<double, std::uint32_t> known;  // by temperature
  const auto add_blackbody = [&](double kelvin) {
    const auto [at, fresh] = known.emplace(kelvin, static_cast<std::uint32_t>(emitted_.size()));
    blackbody_.push_back(at->second);
    if (!fresh) return;
    Spectrum& radiance = emitted_.emplace_back(nodes);
    Spectrum& seen = emitted_apparent_.emplace_back(nodes);
    for (std::size_t i = 0; i < nodes; ++i) {
      radiance[i] = planck_radiance_w_m2_sr_um(node_um[i], kelvin);
      seen[i] = radiance[i] * environment.transmittance[i];
    }
  };
  for (const double t : condition.part_temperature_k) {
    coldest_k_ = std::min(coldest_k_, t);
    hottest_k_ = std::max(hottest_k_, t);
    add_blackbody(t);
  }
  for (std::uint32_t k = 0; k < layout_.nodes.count(); ++k) add_blackbody(layout_.nodes.kelvin(k));
  if (emitter_ && emitter_->hottest_k > 0) {
    coldest_k_ = std::min(coldest_k_, emitter_->coldest_k);
    hottest_k_ = std::max(hottest_k_, emitter_->hottest_k);
    has_temperature_errors_ = std::any_of(emitter_->error_k.begin(), emitter_->error_k.end(),
                                          [](float e) { return e > 0; });
    has_unknown_temperatures_ = std::any_of(emitter_->error_k.begin(), emitter_->error_k.end(),
                                            [](float e) { return std::isinf(e); });
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
  // Land that a slope faces is level land of the same material, of emissivity 1.
  const Land* land = std::get_if<Land>(&geometry.boundary);
  const std::uint32_t kinds = land != nullptr ? land->kinds() : 0;
  if (land == nullptr) land_emissivity = {};
  for (const bool open : {true, false})
    for (std::uint32_t k = 0; k < (open ? kinds : land_emissivity.size()); ++k) {
      const std::uint32_t kind = open ? k : land->level_of(k);
      const std::vector<double>& emissivity = land_emissivity[land->material_of(kind)];
      const double kelvin = condition.land_temperature_k[kind];
      coldest_k_ = std::min(coldest_k_, kelvin);
      hottest_k_ = std::max(hottest_k_, kelvin);
      Spectrum& planck = land_.planck.emplace_back(nodes);
      for (std::size_t i = 0; i < nodes; ++i)
        planck[i] = planck_radiance_w_m2_sr_um(node_um[i], kelvin);
      land_.material.push_back(land->material_of(kind));
      if (condition.land_temperature_error_k.empty()) continue;
      const double hotter_k = kelvin + condition.land_temperature_error_k[kind];
      Spectrum& error = land_.error.emplace_back(nodes);
      for (std::size_t i = 0; i < nodes; ++i)
        error[i] = (open ? emissivity[i] : 1) *
                   (planck_radiance_w_m2_sr_um(node_um[i], hotter_k) - planck[i]);
    }
  land_.open = kinds;
  land_.emissivity.assign(land_emissivity.begin(), land_emissivity.end());
  for (std::size_t m = 0; m < land_emissivity.size(); ++m) {
    const auto add_sunlit = [&](const std::vector<LandAir>& air, std::vector<Spectrum>& sunlit) {
      for (const LandAir& at : air) {
        Spectrum& mirrored = sunlit.emplace_back(nodes);
        for (std::size_t i = 0; i < nodes; ++i)
          mirrored[i] = (1 - land_emissivity[m][i]) / std::numbers::pi * at.sun[i];
      }
    };
    add_sunlit(environment.land.at_target, land_.sun);
    add_sunlit(environment.land.apparent, land_.sun_apparent);
    add_sunlit(environment.land.behind, land_.behind_sun);
  }
  light_.reserve(layout_.light.count());
  for (const SourceId id : layout_.light.all())
    light_.push_back(light_of(id, geometry.emitters, effects));
}

ConditionSources::Light ConditionSources::light_of(SourceId id, const Emitters& emitters,
                                                   const EffectSet& effects) const {
  using Kind = SourceLayout::Kind;
  const SourceLayout::Place at = layout_.light.place_of(id);
  const Light dark{none_.data(), none_.data()}, land{nullptr, nullptr, true};
  const auto light = [&](const Spectrum& radiance, const Spectrum& apparent) {
    return Light{radiance.data(), apparent.data()};
  };
  const auto of_emitter = [&] {
    const std::uint32_t which = by_element() ? at.index : emitters.part_of(at.index);
    IRSIG_CHECK(which < blackbody_.size());
    return light(emitted_[blackbody_[which]], emitted_apparent_[blackbody_[which]]);
  };
  // Index among the suns that shine; a sun of another condition is behind the last.
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
    case Kind::kLower:
      return {nullptr, nullptr};
    case Kind::kSun:
      return lit < sun_.size() && sun_[lit].direct ? light(sun_[lit].irradiance, sun_[lit].apparent)
                                                   : dark;
    case Kind::kGlint:
      return lit < sun_.size() ? light(glint_[lit][at.second], glint_apparent_[lit][at.second])
                               : dark;
    // Without light from the environment (ViewSurroundings::without_light) land is dark.
    case Kind::kLand:
      return effects.lower && !environment_->land.at_target.empty() ? land : dark;
    case Kind::kLandSun:
      return effects.lower && !sun_.empty() && !environment_->land.at_target.empty()
                 ? light(land_.sun[at.second], land_.sun_apparent[at.second])
                 : dark;
    case Kind::kBehindLand:
      return environment_->land.behind.empty() ? dark : land;
    case Kind::kBehindLandSun:
      return !sun_.empty() && !environment_->land.behind.empty()
                 ? light(none_, land_.behind_sun[at.second])
                 : dark;
    case Kind::kBehind:
      return light(none_, environment_->background_apparent[at.index]);
  }
  return dark;
}

ConditionSources::Spectrum ConditionSources::land_through(std::uint32_t index,
                                                          const LandAir& air) const {
  const Spectrum &planck = land_.planck[index],
                 &emissivity = land_.emissivity[land_.material[index]];
  Spectrum out(planck.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = air.path_radiance[i] + (index < land_.open
                                         ? air.transmittance[i] * emissivity[i] * planck[i] +
                                               (1 - emissivity[i]) * air.sky[i]
                                         : air.transmittance[i] * planck[i]);
  return out;
}

void ConditionSources::make_land(SourceId id, Light& light) const {
  const SourceLayout::Place at = layout_.light.place_of(id);
  const LandLight& air = environment_->land;
  const auto make = [&](const std::vector<LandAir>& through) {
    const auto ranges = static_cast<std::uint32_t>(through.size());
    return land_.made.emplace_back(land_through(at.index / ranges, through[at.index % ranges]))
        .data();
  };
  if (at.kind == SourceLayout::Kind::kBehindLand) {
    light = {none_.data(), make(air.behind), true};
  } else {
    light.radiance = make(air.at_target);
    light.apparent = make(air.apparent);
  }
}

ConditionSources::EmitterShare ConditionSources::fraction_of(std::uint32_t emitter) const {
  if (!by_element()) return {emitter};
  if (!emitter_ || std::isnan(emitter_->kelvin[emitter])) return {emitter};
  const BlackbodyNodes::Share share =
      layout_.nodes.share(static_cast<double>(emitter_->kelvin[emitter]));
  return {static_cast<std::uint32_t>(parts_) + share.first, 4, share.weight};
}

std::optional<SourceId> ConditionSources::light_of_path(SourceId id) const {
  const SourceLayout &paths = layout_.paths, &light = layout_.light;
  const auto moved = [id](std::uint32_t from, std::uint32_t to) {
    return SourceId{index_of(id) - from + to};
  };
  const std::uint32_t i = index_of(id);
  if (i < paths.land_suns().first) return moved(paths.all_emitted().last, light.all_emitted().last);
  if (paths.behind_without_sun().contains(id))
    return moved(paths.behind().first, light.behind().first);
  for (const LitSun& sun : sun_) {
    if (paths.land_suns(sun.index).contains(id))
      return moved(paths.land_suns(sun.index).first, light.land_suns().first);
    if (paths.behind_land_suns(sun.index).contains(id))
      return moved(paths.behind_land_suns(sun.index).first, light.behind_without_sun().last);
  }
  return std::nullopt;
}

SourceWeights ConditionSources::lit(const SourceWeights& of_paths) const {
  const SourceLayout &paths = layout_.paths, &light = layout_.light;
  const std::size_t columns = of_paths.columns();
  SourceWeights out(of_paths.firsts(), light, columns);
  const auto add = [&](std::uint32_t first, SourceId to, double factor, const double* row) {
    double* at = out.row(first, to);
    for (std::size_t k = 0; k < columns; ++k) at[k] += factor * row[k];
  };
  for (std::uint32_t first = 0; first < of_paths.firsts(); ++first) {
    of_paths.for_each(first, paths.all_emitted(), [&](SourceId id, const double* row) {
      if (std::all_of(row, row + columns, [](double w) { return w == 0; })) return;
      const bool reflected = index_of(id) >= paths.emitters();
      const EmitterShare share = fraction_of(index_of(id) - (reflected ? paths.emitters() : 0));
      for (std::uint32_t k = 0; k < share.count; ++k)
        add(first, reflected ? light.reflected(share.first + k) : light.seen(share.first + k),
            share.weight[k], row);
    });
    std::vector<SourceRange> shining = {{paths.all_emitted().last, paths.land_suns().first},
                                        paths.behind_without_sun()};
    for (const LitSun& sun : sun_) {
      shining.push_back(paths.land_suns(sun.index));
      shining.push_back(paths.behind_land_suns(sun.index));
    }
    for (const SourceRange range : shining)
      of_paths.for_each(first, range, [&](SourceId id, const double* row) {
        add(first, *light_of_path(id), 1, row);
      });
  }
  return out;
}

std::optional<std::uint32_t> ConditionSources::unknown_emitter(const SourceWeights& of_paths,
                                                               std::size_t parts) const {
  std::optional<std::uint32_t> out;
  if (!has_unknown_temperatures_) return out;
  for (std::uint32_t first = 0; first < parts && !out; ++first)
    of_paths.for_each(first, layout_.paths.all_emitted(), [&](SourceId id, const double* row) {
      const bool reflected = index_of(id) >= layout_.paths.emitters();
      const std::uint32_t e = index_of(id) - (reflected ? layout_.paths.emitters() : 0);
      if (std::isinf(emitter_->error_k[e]) &&
          std::any_of(row, row + of_paths.columns(), [](double w) { return w != 0; }))
        out = e;
    });
  return out;
}

SummedWeights ConditionSources::temperature_errors(const SourceWeights& of_paths,
                                                   std::size_t parts) const {
  const SourceLayout &paths = layout_.paths, &light = layout_.light;
  const std::size_t columns = of_paths.columns();
  SummedWeights out{light.count(), columns, {}};
  out.value.assign(light.count() * columns, 0.0);
  const auto add = [&](std::uint32_t from, double kelvin, double sign, const double* row) {
    const BlackbodyNodes::Share share = layout_.nodes.share(kelvin);
    for (std::uint32_t n = 0; n < share.weight.size(); ++n) {
      double* to = out.value.data() + (from + share.first + n) * columns;
      for (std::size_t k = 0; k < columns; ++k) to[k] += sign * share.weight[n] * row[k];
    }
  };
  for (std::uint32_t first = 0; first < parts; ++first)
    of_paths.for_each(first, paths.all_emitted(), [&](SourceId id, const double* row) {
      const bool reflected = index_of(id) >= paths.emitters();
      const std::uint32_t e = index_of(id) - (reflected ? paths.emitters() : 0);
      const double kelvin = static_cast<double>(emitter_->kelvin[e]),
                   error_k = static_cast<double>(emitter_->error_k[e]);
      if (!(error_k > 0) || std::isinf(error_k)) return;
      const std::uint32_t from =
          (reflected ? light.emitters() : 0) + static_cast<std::uint32_t>(parts_);
      add(from, kelvin + error_k, 1, row);
      add(from, kelvin, -1, row);
    });
  return out;
}

ConditionSources::LandError ConditionSources::land_error_w_m2_sr(SourceId land,
                                                                 const BandOnAxis& band) const {
  const SourceLayout::Place at = layout_.light.place_of(land);
  const bool behind = at.kind == SourceLayout::Kind::kBehindLand;
  if (land_.error.empty() || (!behind && at.kind != SourceLayout::Kind::kLand)) return {};
  const std::uint32_t ranges = behind ? layout_.light.behind_ranges() : layout_.light.land_ranges();
  const Spectrum& error = land_.error[at.index / ranges];
  Spectrum arriving(error.size());
  const auto through = [&](const std::vector<LandAir>& air) {
    if (air.empty()) return 0.0;
    const Spectrum& t = air[at.index % ranges].transmittance;
    for (std::size_t i = 0; i < error.size(); ++i) arriving[i] = t[i] * error[i];
    return in_band(arriving, band);
  };
  const LandLight& land_light = environment_->land;
  if (behind) return {0, through(land_light.behind)};
  return {through(land_light.at_target), through(land_light.apparent)};
}

ConditionSources::LandParts ConditionSources::land_parts_w_m2_sr(SourceId behind,
                                                                 const BandOnAxis& band) const {
  const SourceLayout::Place at = layout_.light.place_of(behind);
  if (at.kind == SourceLayout::Kind::kBehindLandSun)
    return {.sun = in_band(apparent(behind), band)};
  if (at.kind != SourceLayout::Kind::kBehindLand || environment_->land.behind.empty()) return {};
  const std::uint32_t ranges = layout_.light.behind_ranges();
  const LandAir& air = environment_->land.behind[at.index % ranges];
  const std::uint32_t kind = at.index / ranges;
  Spectrum emission = land_.planck[kind];
  if (kind < land_.open)
    for (std::size_t i = 0; i < emission.size(); ++i)
      emission[i] *= land_.emissivity[land_.material[kind]][i];
  Spectrum emitted(emission.size()), sky(emission.size());
  const std::span<const double> seen = apparent(behind);
  for (std::size_t i = 0; i < emission.size(); ++i) {
    emitted[i] = air.transmittance[i] * emission[i];
    sky[i] = seen[i] - air.path_radiance[i] - emitted[i];
  }
  return {in_band(emission, band), in_band(emitted, band), in_band(sky, band)};
}

std::array<std::vector<SourceRange>, kCauses> ConditionSources::causes() const {
  std::vector<std::uint32_t> shining;
  for (const LitSun& sun : sun_) shining.push_back(sun.index);
  return layout_.light.causes(shining);
}

double ConditionSources::part_w_m2_sr(std::uint32_t part, const BandOnAxis& band) const {
  return in_band(emitted_[blackbody_[part]], band);
}

double ConditionSources::brightest_around_w_m2_sr(const BandOnAxis& band) const {
  double thermal = 0;
  const auto& around = environment_->around;
  for (const double node :
       around.integrals(band.first_node, band.grid.band_weight, nullptr, 1).source)
    thermal = std::max(thermal, node);
  return thermal;
}

double ConditionSources::brightest_thermal_w_m2_sr(const BandOnAxis& band) const {
  double thermal = brightest_around_w_m2_sr(band);
  for (std::uint32_t p = 0; p < parts_; ++p) thermal = std::max(thermal, part_w_m2_sr(p, band));
  return thermal;
}

double ConditionSources::brightest_w_m2_sr(const BandOnAxis& band, double brightest_thermal) const {
  double sum = brightest_thermal;
  for (const LitSun& sun : sun_) sum += in_band(sun.irradiance, band) / std::numbers::pi;
  return sum;
}

}  // namespace irsig
