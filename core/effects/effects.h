#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace irsig {

// Contributions to a signature. The table below states for each what it is, when it matters, how
// its contribution is bounded without simulation, and its cost.
enum class Effect : std::uint8_t {
  kSelfEmission,
  kDirectSun,
  kDiffuseSun,
  kMirroredSun,
  kSkyReflected,
  kLowerReflected,
  kInterReflection,
  kHotPartsReflected,
  kTransmission,
  kPathRadiance,
  kPathSun,
  kBackgroundSun,
  kJoinedLines,
  kAirToHorizon,
  kSunDisk,
  kDirectionalEmissivity,
  kSpectralVariation,
  kPerspective,
  kRefraction,
  // Effects of the sky: in ledgers of rows whose condition has a cloud.
  kCloud,
  // Effects on computed temperatures: chosen for a whole sweep by its author, not for a row by its
  // bound.
  kHeatExchange,
  kHeatDiffuseSun,
  // Effects of hot gas: in ledgers of rows that have some.
  kPlume,
  kPlumeOnHull,
  kHotLineCorrelation,
};
inline constexpr std::size_t kEffects = 19;  // of rows: those that every ledger has
inline constexpr std::size_t kCloudEffects = 1, kHeatEffects = 2, kPlumeEffects = 3;
// Effects that a view decides by bounds known before it is traced.
inline constexpr std::size_t kPlannedEffects = kEffects + kCloudEffects;
inline constexpr std::size_t kEffectCount = kPlannedEffects + kHeatEffects + kPlumeEffects;

struct EffectInfo {
  Effect effect;
  std::string_view name;  // in files and on the command line
  std::string_view what;
  std::string_view when;   // it matters
  std::string_view bound;  // of leaving it out
  std::string_view cost;
  // True if the effect can be left out. An effect that is not optional costs no time that leaving
  // it out would save.
  bool switchable;
  // Time on one processor, for each view and condition under the embedded atmosphere, without rays.
  // [s]
  // As measured where docs/evidence/performance.md says, with 481 wavelengths: for estimates only.
  double view_s = 0;
};
// A ray and what is done where it ends: likewise.                                             [s]
inline constexpr double kRaySeconds = 3e-7;

[[nodiscard]] const std::array<EffectInfo, kEffects>& effect_table();
[[nodiscard]] const std::array<EffectInfo, kCloudEffects>& cloud_effect_table();
// Effects on computed temperatures; their omission is bounded in kelvin.
[[nodiscard]] const std::array<EffectInfo, kHeatEffects>& heat_effect_table();
[[nodiscard]] const std::array<EffectInfo, kPlumeEffects>& plume_effect_table();
[[nodiscard]] constexpr bool is_of_cloud(Effect effect) { return effect == Effect::kCloud; }
// Returns whether an effect is in the background radiance that rows state.
[[nodiscard]] constexpr bool is_of_background(Effect effect) {
  return effect == Effect::kPathSun || effect == Effect::kBackgroundSun;
}
[[nodiscard]] constexpr bool is_of_heat(Effect effect) {
  return effect == Effect::kHeatExchange || effect == Effect::kHeatDiffuseSun;
}
[[nodiscard]] constexpr bool is_of_plume(Effect effect) {
  return effect == Effect::kPlume || effect == Effect::kPlumeOnHull ||
         effect == Effect::kHotLineCorrelation;
}
[[nodiscard]] const EffectInfo& info_of(Effect effect);  // of any table
[[nodiscard]] std::optional<Effect> effect_named(std::string_view name);

// All that ends with the last reflection.
inline constexpr std::array kReflectionEffects{Effect::kDirectSun,         Effect::kDiffuseSun,
                                               Effect::kMirroredSun,       Effect::kSkyReflected,
                                               Effect::kLowerReflected,    Effect::kInterReflection,
                                               Effect::kHotPartsReflected, Effect::kJoinedLines};

// The user's choice of effects. kAuto: the effects that the requested accuracy needs.
struct EffectChoice {
  enum class Mode : std::uint8_t { kAuto, kAll, kOnly };
  Mode mode = Mode::kAll;
  std::vector<Effect> only;  // kOnly: of the switchable effects these are on, all others off
  std::vector<Effect> without_plume = {};  // of hot gas, in any mode: these are off
  // kAuto: never left out. An uncertain input moves what they bring, and a bound for the stated
  // value says nothing of the moved one.
  std::vector<Effect> kept = {};

  [[nodiscard]] bool without(Effect of_plume) const {
    return std::find(without_plume.begin(), without_plume.end(), of_plume) != without_plume.end();
  }
  [[nodiscard]] bool keeps(Effect effect) const {
    return std::find(kept.begin(), kept.end(), effect) != kept.end();
  }
};

enum class EffectState : std::uint8_t {
  kOn,
  kOff,     // left out: its bound is part of the numerical error
  kAbsent,  // nothing in this scene and condition causes it
};
enum class EffectReason : std::uint8_t {
  kAlways,       // never left out unless the user's word does
  kAbsent,       // nothing causes it
  kWithinShare,  // off: the bound fits into the share of the error that omissions may take
  kAboveShare,   // on: it does not
  kOtherRow,     // on: it would fit here, but another row of the view needs it
  kNoGoal,       // on: no relative error is asked for, so that nothing says what is small
  kNotWorth,     // on: so little else could be left out that it would not pay for finding out
  kUnbounded,    // on: no finite bound is known
  kForced,       // the user's word: also on, because an uncertain input moves it
  kNotAsked,     // on: left out only by the user's word
};
[[nodiscard]] std::string_view name_of(EffectState state);
[[nodiscard]] std::string_view name_of(EffectReason reason);

// One effect in one row. NaN: not known. Bounds: the most by which leaving the effect out can
// change the quantity.                                                                     [W/sr]
struct LedgerEntry {
  Effect effect;
  EffectState state;
  EffectReason reason;
  double bound_w_sr, apparent_bound_w_sr, contrast_bound_w_sr;
  double fraction_w_sr;  // measured: what it contributes to the intensity at the target
  // Time on one processor, for the whole view, estimated from counts: spent (on) or saved (off).
  // [s]
  double time_s;

  // Numbers that are not known are equal.
  bool operator==(const LedgerEntry& other) const;
};

}  // namespace irsig
