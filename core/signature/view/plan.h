#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/effects/effect_set.h"
#include "core/effects/plan.h"
#include "core/transport/primary_rays.h"

namespace irsig {

// Settings that are fixed before a view is measured, by pilots over every row of the sweep. A
// value: the plan of a view can be written down, compared and measured again.
struct ViewPlan {
  std::uint64_t samples_per_replicate = 0;
  bool limited = false;  // more would have been needed than the request allows
  std::uint64_t pilot_rays = 0;
  EffectSet effects;
  // All that follows: [condition x band of the scene].
  std::vector<double> absolute_floor_w_m2_sr;  // what AccuracySpec::absolute_error_k is worth
  std::vector<RowBounds::Bound> omitted;       // reflections after max_reflections are not in it
  // Remaining room for the omission of hot gas's effects. Empty: nothing by itself.
  std::vector<EffectPlanner::Room> room;
  std::vector<std::vector<LedgerEntry>> ledger;  // [..][kEffects, and a cloud's]
  BrightFacets bright;                           // what rays of their own are aimed at

  // Numbers that are unknown in both plans are equal.
  bool operator==(const ViewPlan&) const = default;
};

// Formats a plan as lines of text, with numbers to the last bit.
[[nodiscard]] std::string to_string(const ViewPlan& plan);

}  // namespace irsig
