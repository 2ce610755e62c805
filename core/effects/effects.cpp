#include "core/effects/effects.h"

#include <algorithm>
#include <cmath>

namespace irsig {

const std::array<EffectInfo, kEffects>& effect_table() {
  static constexpr std::array<EffectInfo, kEffects> table{{
      {Effect::kSelfEmission, "self_emission", "what surfaces emit towards the sensor",
       "always: it is the lower bound that all others are compared with", "none needed",
       "the primary rays", false},
      {Effect::kDirectSun, "direct_sun", "sunlight reflected by the target",
       "mid-wave by day; long-wave where mirrors catch the sun",
       "irradiance outside the air x largest BRDF x projected area; mirrors: every facet by "
       "itself, nothing in the way",
       "one ray to the sun for each reflection that it could matter to", true},
      {Effect::kDiffuseSun, "diffuse_sun", "sunlight scattered by the sky, reflected by the target",
       "mid-wave by day",
       "what air scatters once is at most the irradiance outside it, on any facet; towards a "
       "mirror the largest phase function",
       "24 azimuths of the sky instead of one, at every view", true, 2.0e-3},
      {Effect::kMirroredSun, "mirrored_sun",
       "the sun that waves mirror towards the target, reflected by it",
       "mid-wave by day over a sea",
       "integral of the glitter over all directions of the sea, no air; towards a mirror its "
       "brightest direction",
       "one ray from the sea to the sun for each path that ends there", true},
      {Effect::kSkyReflected, "sky_reflected", "what the sky emits, reflected by the target",
       "unless the target is much brighter than its surroundings and hardly reflects",
       "what is reflected after the first facet (pilot, upper limit) x Planck's function at the "
       "warmest air",
       "all reflected rays; the sky behind the air of the line of sight", true, 0.4e-3},
      {Effect::kLowerReflected, "lower_reflected",
       "what sea or ground emit and reflect of the sky, reflected by the target",
       "as sky_reflected", "as sky_reflected, at the warmest of sea, ground and air",
       "all reflected rays; the sea behind the air of the line of sight", true, 0.4e-3},
      {Effect::kInterReflection, "inter_reflection",
       "light that meets the target more than once: reflections of its own parts, orders 2 to "
       "max_reflections",
       "cavities, corners, shiny parts beside hot ones",
       "0 for a convex target; else what is still reflected after each order (pilot, upper "
       "limit) x the brightest source",
       "rays of the second and later orders", true},
      {Effect::kHotPartsReflected, "hot_parts_reflected",
       "hot parts reflected by others, aimed at from every facet",
       "parts well above the rest of the target", "with inter_reflection: it is on or off with it",
       "one ray to a hot part for each reflection that it could matter to", false},
      {Effect::kTransmission, "transmission", "absorption between target and sensor", "always",
       "none needed", "one line of sight for each weather and view", false},
      {Effect::kPathRadiance, "path_radiance", "what the air between target and sensor emits",
       "long ranges, cold targets", "none needed", "part of transmission", false},
      {Effect::kPathSun, "path_sun",
       "sunlight that the air between target and sensor scatters towards the sensor",
       "mid-wave by day, haze, towards the sun; never left out unasked, as rows state path "
       "radiance",
       "irradiance outside the air x phase function at the angle of the line of sight x what the "
       "line scatters",
       "the sun's way to every layer of the line of sight", true, 0.1e-3},
      {Effect::kBackgroundSun, "background_sun",
       "sunlight in what would be seen in the target's place: bright sky, glitter",
       "contrast and background radiance by day; never left out unasked, as rows state that "
       "radiance",
       "irradiance outside the air x phase function or glitter in the direction of sight",
       "the sky and the sea under the sun", true, 0.1e-3},
      {Effect::kJoinedLines, "joined_lines",
       "the air's lines in reflected light, joined with those of the line of sight ring by ring "
       "of the sky",
       "the apparent intensity of reflecting targets at some range",
       "what is reflected of sky and sea x the range of the rings' ratios between those computed",
       "one line of sight for each of 16 rings of sky and sea; off: for 6", true, 0.4e-3},
      {Effect::kAirToHorizon, "air_to_horizon",
       "air between the target and the sea or ground that it reflects", "targets well above it",
       "none needed", "once for each weather", false},
      {Effect::kSunDisk, "sun_disk", "the sun's size: soft shadows, limits of glints",
       "mirrors in the sun", "none needed", "nothing", false},
      {Effect::kDirectionalEmissivity, "directional_emissivity",
       "emissivity by the angle of sight, 1 - DHR", "always", "none needed", "nothing", false},
      {Effect::kSpectralVariation, "spectral_variation",
       "materials that vary over the band's wavelengths", "spectral materials", "none needed",
       "weights at a few wavelengths instead of one along every path", false},
      {Effect::kPerspective, "perspective", "rays that leave one point at a finite range",
       "targets large against the range", "none needed", "nothing", false},
      {Effect::kRefraction, "refraction", "lines of sight bent by the air's density",
       "lines near the horizon", "none needed",
       "tracing of the ray, once for each weather and view", false},
  }};
  return table;
}

const std::array<EffectInfo, kCloudEffects>& cloud_effect_table() {
  static constexpr std::array<EffectInfo, kCloudEffects> table{{
      {Effect::kCloud, "cloud",
       "the layer of cloud in sky and sunlight; off: they are those of a clear sky, but for what "
       "stands behind the target",
       "unless the target is much brighter than sky and surface, and reflects hardly any sunlight",
       "the most that a clear and an overcast sky send, by the larger of the cover and the "
       "standard deviation of the choice between both; none where target or line of sight reach "
       "the cloud",
       "of a broken sky a second sky at every view", true, 2.4e-3},
  }};
  return table;
}

const std::array<EffectInfo, kHeatEffects>& heat_effect_table() {
  static constexpr std::array<EffectInfo, kHeatEffects> table{{
      {Effect::kHeatExchange, "heat_exchange",
       "long-wave radiation that facets send to each other; off: what a facet sees of others is "
       "black and as warm as the air",
       "corners, courtyards, decks below walls, clear nights",
       "what arrives instead x the emissivity, against the least convection and the emission of "
       "each face (maximum principle), with what other faces answer",
       "passes over the day until exchange and temperatures agree", true},
      {Effect::kHeatDiffuseSun, "heat_diffuse_sun",
       "sunlight that the sky scatters onto facets, with what they reflect of it; off: none warms",
       "by day; most of all in the shade", "what each face absorbs of it, against the same losses",
       "next to nothing", true},
  }};
  return table;
}

const std::array<EffectInfo, kPlumeEffects>& plume_effect_table() {
  static constexpr std::array<EffectInfo, kPlumeEffects> table{{
      {Effect::kPlume, "plume",
       "hot gas: what it sends, less what it takes of the light of target and background",
       "mid-wave, most of all at 4.2-4.6 um", "a measurement with few rays, and 4 standard errors",
       "rays of its own and some 50 spectra for each condition", true},
      {Effect::kPlumeOnHull, "plume_reflected",
       "what the target reflects of hot gas, less what the gas takes of other light that the "
       "target "
       "reflects",
       "bright or shiny surfaces near the gas", "as plume",
       "reflected rays of its own and some 50 spectra for each condition", true},
      {Effect::kHotLineCorrelation, "hot_line_correlation",
       "that hot gas sends on the lines on which cold air takes; off: what it sends x the air's "
       "transmittance",
       "4.2-4.6 um at any range, elsewhere wherever the air's lines are strong",
       "both, with the same columns", "nothing", true},
  }};
  return table;
}

const EffectInfo& info_of(Effect effect) {
  const auto index = static_cast<std::size_t>(effect);
  if (is_of_cloud(effect)) return cloud_effect_table()[index - kEffects];
  if (is_of_heat(effect)) return heat_effect_table()[index - kPlannedEffects];
  if (is_of_plume(effect)) return plume_effect_table()[index - kPlannedEffects - kHeatEffects];
  return effect_table()[index];
}

std::optional<Effect> effect_named(std::string_view name) {
  for (std::size_t i = 0; i < kEffectCount; ++i)
    if (const EffectInfo& e = info_of(static_cast<Effect>(i)); e.name == name) return e.effect;
  return std::nullopt;
}

std::string_view name_of(EffectState state) {
  switch (state) {
    case EffectState::kOn:
      return "on";
    case EffectState::kOff:
      return "off";
    case EffectState::kAbsent:
      return "absent";
  }
  return "?";
}

std::string_view name_of(EffectReason reason) {
  switch (reason) {
    case EffectReason::kAlways:
      return "always";
    case EffectReason::kAbsent:
      return "not_in_scene";
    case EffectReason::kWithinShare:
      return "within_fraction";
    case EffectReason::kAboveShare:
      return "above_fraction";
    case EffectReason::kOtherRow:
      return "other_row";
    case EffectReason::kNoGoal:
      return "no_goal";
    case EffectReason::kNotWorth:
      return "not_worth";
    case EffectReason::kUnbounded:
      return "unbounded";
    case EffectReason::kForced:
      return "forced";
    case EffectReason::kNotAsked:
      return "not_asked";
  }
  return "?";
}

bool LedgerEntry::operator==(const LedgerEntry& other) const {
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  return effect == other.effect && state == other.state && reason == other.reason &&
         same(bound_w_sr, other.bound_w_sr) &&
         same(apparent_bound_w_sr, other.apparent_bound_w_sr) &&
         same(contrast_bound_w_sr, other.contrast_bound_w_sr) &&
         same(fraction_w_sr, other.fraction_w_sr) && same(time_s, other.time_s);
}

}  // namespace irsig
