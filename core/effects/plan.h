#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/effects/effects.h"

namespace irsig {

// Fraction of an accuracy goal that the bounds of omitted effects may take as a standard error (a
// bias within +-b counts as b / sqrt(3)): 0.4 leaves 0.92 of the goal to the samples, which costs 9
// to 19 % of them.
inline constexpr double kOmittedShare = 0.4;

// Bounds of one row before it is traced. [W/sr]
struct RowBounds {
  // The errors that are wanted, of the source and at the aperture; 0: none is stated.
  double goal_w_sr = 0, aperture_goal_w_sr = 0;
  // The most that leaving an effect out can change. absent: nothing causes it. A bound that is not
  // finite: none is known.
  struct Bound {
    bool absent = false;
    double source = 0, apparent = 0, contrast = 0;
    bool operator==(const Bound&) const = default;
  };
  std::array<Bound, kPlannedEffects> effect;
  // Bound of all reflected light but the sun's.
  Bound reflected;
  // The part of the cloud's bound that no reflection brings: background and line of sight.
  Bound cloud_unreflected;
};

// Decides for one view what is simulated. Rows: [condition x band]. A condition's sunlight is
// decided by all its bands, and so is its cloud; the sky's, the sea's and the target's own light in
// reflections by all rows: paths are shared, and what is decided must not depend on which rows are
// computed.
class EffectPlanner {
 public:
  EffectPlanner(std::vector<RowBounds> rows, std::size_t bands, const EffectChoice& choice);

  // Leaves out what fits: first all reflections with the sun's light in them, or else all that they
  // bring from sky and sea; then sunlight by its ways, one after the other, and the cloud.
  // joined_lines stays as it is. To be called once, first.
  void decide();
  // Takes room for further omissions, [row], if there is enough in every row.
  bool take_room(const std::vector<RowBounds::Bound>& bounds);
  // Leaves one more effect out in all rows if these bounds, [row], fit into what is left.
  bool leave_out(Effect effect, const std::vector<RowBounds::Bound>& bounds);

  [[nodiscard]] bool on(Effect effect, std::size_t condition) const;
  [[nodiscard]] bool on_anywhere(Effect effect) const;
  // Returns true if any light is reflected.
  [[nodiscard]] bool reflections() const;
  // Returns the sum of the bounds of all omitted effects. All reflections together count once.
  // [row]
  [[nodiscard]] std::vector<RowBounds::Bound> omitted() const;
  struct Room {  // what omissions may still take
    double source = 0, aperture = 0;
    bool operator==(const Room&) const = default;
  };
  // Returns the room for omissions; empty: nothing may be left out. [row]
  [[nodiscard]] std::vector<Room> room() const;
  [[nodiscard]] static bool fits(const RowBounds::Bound& bound, const Room& room);
  // Returns the ledger, with fractions and times still open (NaN); a cloud's entry only where there
  // is one. [row][effect]
  [[nodiscard]] std::vector<std::vector<LedgerEntry>> ledger() const;

 private:
  static void take(const RowBounds::Bound& bound, Room& room);
  void leave_out_surroundings();
  void leave_out_sunlight();
  void leave_out_clouds();
  // Leaves an effect out under a condition if its bounds fit in all bands.
  void leave_out_under(std::size_t condition, Effect effect);
  [[nodiscard]] RowBounds::Bound all_reflected(std::size_t row) const;
  [[nodiscard]] bool has_goal(std::size_t row) const { return rows_[row].goal_w_sr > 0; }

  std::vector<RowBounds> rows_;
  std::size_t bands_;
  EffectChoice choice_;
  std::vector<Room> room_;
  std::vector<std::array<bool, kPlannedEffects>> off_;  // [condition]
  bool without_reflections_ = false, decided_ = false;
};

}  // namespace irsig
