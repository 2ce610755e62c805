#include "core/effects/plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace irsig {
namespace {

constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();

std::size_t index_of(Effect effect) { return static_cast<std::size_t>(effect); }

// Sunlight that reflections bring to the sensor.
constexpr std::array kReflectedSun{Effect::kDiffuseSun, Effect::kMirroredSun, Effect::kDirectSun};
void add(const RowBounds::Bound& b, RowBounds::Bound& sum) {
  sum.source += b.source;
  sum.apparent += b.apparent;
  sum.contrast += b.contrast;
}

// Returns the bound of sky and surface together: each path ends in one of them.
RowBounds::Bound around(const RowBounds& row) {
  const RowBounds::Bound &sky = row.effect[index_of(Effect::kSkyReflected)],
                         &lower = row.effect[index_of(Effect::kLowerReflected)];
  return {false, std::max(sky.source, lower.source), std::max(sky.apparent, lower.apparent),
          std::max(sky.contrast, lower.contrast)};
}

double finite_or_unknown(double bound) { return std::isfinite(bound) ? bound : kNotKnown; }

}  // namespace

EffectPlanner::EffectPlanner(std::vector<RowBounds> rows, std::size_t bands,
                             const EffectChoice& choice)
    : rows_(std::move(rows)), bands_(bands), choice_(choice) {
  for (const RowBounds& r : rows_)
    room_.push_back({kOmittedShare * std::numbers::sqrt3 * r.goal_w_sr,
                     kOmittedShare * std::numbers::sqrt3 * r.aperture_goal_w_sr});
  off_.resize(rows_.size() / bands_);
  for (auto& condition : off_) condition.fill(false);
}

bool EffectPlanner::fits(const RowBounds::Bound& bound, const Room& room) {
  // The condition is written so that NaN does not fit.
  return bound.source <= room.source && bound.apparent <= room.aperture &&
         bound.contrast <= room.aperture;
}

void EffectPlanner::take(const RowBounds::Bound& bound, Room& room) {
  room.source -= bound.source;
  room.aperture -= std::max(bound.apparent, bound.contrast);
}

RowBounds::Bound EffectPlanner::all_reflected(std::size_t row) const {
  RowBounds::Bound sum = rows_[row].reflected;
  for (const Effect e : kReflectedSun) {
    const RowBounds::Bound& b = rows_[row].effect[index_of(e)];
    if (!b.absent) add(b, sum);
  }
  return sum;
}

void EffectPlanner::decide() {
  decided_ = true;
  if (choice_.mode == EffectChoice::Mode::kAll) return;
  if (choice_.mode == EffectChoice::Mode::kOnly) {
    for (const EffectInfo& e : effect_table()) {
      const bool listed =
          std::find(choice_.only.begin(), choice_.only.end(), e.effect) != choice_.only.end();
      if (!e.switchable || listed) continue;
      for (auto& condition : off_) condition[index_of(e.effect)] = true;
    }
    for (auto& condition : off_) {
      condition[index_of(Effect::kHotPartsReflected)] =
          condition[index_of(Effect::kInterReflection)];
      // Sunlight that sky and sea scatter is part of their radiance.
      if (condition[index_of(Effect::kSkyReflected)] ||
          condition[index_of(Effect::kLowerReflected)])
        condition[index_of(Effect::kDiffuseSun)] = true;
    }
    without_reflections_ = std::all_of(off_.begin(), off_.end(), [&](const auto& condition) {
      return std::all_of(kReflectionEffects.begin(), kReflectionEffects.end(), [&](Effect e) {
        return e == Effect::kJoinedLines || condition[index_of(e)];
      });
    });
    return;
  }
  bool none_reflected = std::none_of(kReflectionEffects.begin(), kReflectionEffects.end(),
                                     [&](Effect e) { return choice_.keeps(e); });
  for (std::size_t row = 0; row < rows_.size(); ++row)
    none_reflected = none_reflected && has_goal(row) && fits(all_reflected(row), room_[row]);
  if (none_reflected) {
    without_reflections_ = true;
    for (std::size_t row = 0; row < rows_.size(); ++row) take(all_reflected(row), room_[row]);
    for (auto& condition : off_)
      for (const Effect e : kReflectionEffects) condition[index_of(e)] = true;
  } else {
    leave_out_surroundings();
  }
  leave_out_sunlight();
  leave_out_clouds();
}

void EffectPlanner::leave_out_under(std::size_t condition, Effect effect) {
  const std::size_t first = condition * bands_, last = first + bands_;
  bool all = true, needed = false;
  for (std::size_t row = first; row < last; ++row) {
    const RowBounds::Bound& b = rows_[row].effect[index_of(effect)];
    needed |= !b.absent;
    all = all && (b.absent || (has_goal(row) && fits(b, room_[row])));
  }
  if (!needed || !all) return;
  off_[condition][index_of(effect)] = true;
  for (std::size_t row = first; row < last; ++row)
    if (const RowBounds::Bound& b = rows_[row].effect[index_of(effect)]; !b.absent)
      take(b, room_[row]);
}

// Sunlight in the air and in the background stays: rows state radiances of both, of which a
// target's brightness hides nothing.
void EffectPlanner::leave_out_sunlight() {
  for (std::size_t c = 0; c < off_.size(); ++c)
    for (const Effect e : {Effect::kDiffuseSun, Effect::kMirroredSun, Effect::kDirectSun}) {
      if (off_[c][index_of(e)] || choice_.keeps(e)) continue;
      // The sun in the waves is the same light: paths to it need the sun.
      if (e == Effect::kDirectSun && !off_[c][index_of(Effect::kMirroredSun)] &&
          !rows_[c * bands_].effect[index_of(Effect::kMirroredSun)].absent)
        continue;
      leave_out_under(c, e);
    }
}

// Without reflections a cloud is in the background and in what the line of sight scatters.
void EffectPlanner::leave_out_clouds() {
  if (without_reflections_)
    for (RowBounds& row : rows_) {
      RowBounds::Bound& cloud = row.effect[index_of(Effect::kCloud)];
      if (!cloud.absent) cloud = row.cloud_unreflected;
    }
  if (choice_.keeps(Effect::kCloud)) return;
  for (std::size_t c = 0; c < off_.size(); ++c) leave_out_under(c, Effect::kCloud);
}

// Leaves out the reflected light of sky and sea, with the sunlight that they scatter, where the
// target's own light alone is worth following.
void EffectPlanner::leave_out_surroundings() {
  for (const Effect e : {Effect::kSkyReflected, Effect::kLowerReflected, Effect::kDiffuseSun})
    if (choice_.keeps(e)) return;
  std::vector<RowBounds::Bound> bounds;
  for (const RowBounds& row : rows_) {
    RowBounds::Bound sum = around(row);
    const RowBounds::Bound& diffuse = row.effect[index_of(Effect::kDiffuseSun)];
    if (!diffuse.absent) add(diffuse, sum);
    bounds.push_back(sum);
  }
  if (!take_room(bounds)) return;
  for (auto& condition : off_)
    for (const Effect e : {Effect::kSkyReflected, Effect::kLowerReflected, Effect::kDiffuseSun,
                           Effect::kJoinedLines})
      condition[index_of(e)] = true;
}

std::vector<EffectPlanner::Room> EffectPlanner::room() const {
  return choice_.mode == EffectChoice::Mode::kAuto ? room_ : std::vector<Room>();
}

bool EffectPlanner::take_room(const std::vector<RowBounds::Bound>& bounds) {
  bool all = choice_.mode == EffectChoice::Mode::kAuto;
  for (std::size_t row = 0; row < rows_.size(); ++row)
    all = all && has_goal(row) && fits(bounds[row], room_[row]);
  if (!all) return false;
  for (std::size_t row = 0; row < rows_.size(); ++row) take(bounds[row], room_[row]);
  return true;
}

bool EffectPlanner::leave_out(Effect effect, const std::vector<RowBounds::Bound>& bounds) {
  for (std::size_t row = 0; row < rows_.size(); ++row)
    rows_[row].effect[index_of(effect)] = bounds[row];
  if (!take_room(bounds)) return false;
  for (auto& condition : off_) condition[index_of(effect)] = true;
  return true;
}

bool EffectPlanner::on(Effect effect, std::size_t condition) const {
  return !off_[condition][index_of(effect)];
}

bool EffectPlanner::on_anywhere(Effect effect) const {
  return std::any_of(off_.begin(), off_.end(),
                     [&](const auto& condition) { return !condition[index_of(effect)]; });
}

bool EffectPlanner::reflections() const { return !without_reflections_; }

std::vector<RowBounds::Bound> EffectPlanner::omitted() const {
  std::vector<RowBounds::Bound> out;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    RowBounds::Bound sum;
    const std::size_t condition = row / bands_;
    const bool around_is_off =
        !on(Effect::kSkyReflected, condition) && !on(Effect::kLowerReflected, condition);
    if (without_reflections_)
      add(rows_[row].reflected, sum);
    else if (around_is_off)
      add(around(rows_[row]), sum);
    for (std::size_t i = 0; i < kPlannedEffects; ++i) {
      const EffectInfo& e = info_of(static_cast<Effect>(i));
      const RowBounds::Bound& b = rows_[row].effect[i];
      if (b.absent || on(e.effect, condition) || !e.switchable) continue;
      const bool of_around = e.effect == Effect::kSkyReflected ||
                             e.effect == Effect::kLowerReflected ||
                             e.effect == Effect::kJoinedLines;
      if (of_around && (without_reflections_ || around_is_off)) continue;
      if (e.effect == Effect::kInterReflection && without_reflections_) continue;
      add(b, sum);
    }
    out.push_back(sum);
  }
  return out;
}

std::vector<std::vector<LedgerEntry>> EffectPlanner::ledger() const {
  std::vector<std::vector<LedgerEntry>> out;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    std::vector<LedgerEntry>& entries = out.emplace_back();
    const Room whole{kOmittedShare * std::numbers::sqrt3 * rows_[row].goal_w_sr,
                     kOmittedShare * std::numbers::sqrt3 * rows_[row].aperture_goal_w_sr};
    for (std::size_t i = 0; i < kPlannedEffects; ++i) {
      const EffectInfo& e = info_of(static_cast<Effect>(i));
      const RowBounds::Bound& b = rows_[row].effect[i];
      if (is_of_cloud(e.effect) && b.absent) continue;
      LedgerEntry entry{e.effect,
                        EffectState::kOn,
                        EffectReason::kAlways,
                        finite_or_unknown(b.source),
                        finite_or_unknown(b.apparent),
                        finite_or_unknown(b.contrast),
                        kNotKnown,
                        kNotKnown};
      const bool off = !on(e.effect, row / bands_);
      const bool nothing_around =
          !on(Effect::kSkyReflected, row / bands_) && !on(Effect::kLowerReflected, row / bands_);
      if (nothing_around && e.effect == Effect::kJoinedLines)
        entry.bound_w_sr = entry.apparent_bound_w_sr = entry.contrast_bound_w_sr =
            0;  // of light that is left out as a whole
      if (b.absent) {
        entry.state = EffectState::kAbsent;
        entry.reason = EffectReason::kAbsent;
        entry.bound_w_sr = entry.apparent_bound_w_sr = entry.contrast_bound_w_sr = 0;
      } else if (e.switchable || off) {
        entry.state = off ? EffectState::kOff : EffectState::kOn;
        if (choice_.mode != EffectChoice::Mode::kAuto)
          entry.reason = EffectReason::kForced;
        else if (off)
          entry.reason = EffectReason::kWithinShare;
        else if (is_of_background(e.effect))
          entry.reason = EffectReason::kAlways;
        else if (!has_goal(row))
          entry.reason = EffectReason::kNoGoal;
        else if (!std::isfinite(b.source + b.apparent + b.contrast))
          entry.reason = EffectReason::kUnbounded;
        else if (!fits(b, whole))
          entry.reason = EffectReason::kAboveShare;
        else if (choice_.keeps(e.effect))
          entry.reason = EffectReason::kForced;
        else
          entry.reason = decided_ ? EffectReason::kOtherRow : EffectReason::kNotWorth;
      }
      entries.push_back(entry);
    }
  }
  return out;
}

}  // namespace irsig
