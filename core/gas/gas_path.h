#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/atmosphere/absorber_amounts.h"
#include "core/gas/gas_spectrum.h"
#include "core/gas/gas_state.h"

namespace irsig {

struct HotLineBand;

// One gas in one band, whose lines are given by points that are the cold air's as well.
struct JointLines {
  std::size_t gas, band;  // band: beyond the first of the range
  std::size_t first;      // of its points among all of the range
  const HotLineBand* lines;
};
[[nodiscard]] std::vector<JointLines> joint_lines(GasBands bands);

// The air between the eye and gas, prepared once for any number of paths of gas.
class ForegroundAir {
 public:
  // Prepares the air. INVALID_ARGUMENT for bands that the air has not.
  [[nodiscard]] static absl::StatusOr<ForegroundAir> make(const AbsorberAmounts& air,
                                                          GasBands bands);

 private:
  friend class GasPath;
  void add_water(std::size_t band, const AbsorberAmounts& air);
  void add_lines(const AbsorberAmounts& air);

  GasBands bands_;
  std::vector<double> others_, water_;  // [band] factors: all but water and joint lines; water
  std::vector<double> thin_air_;        // [band] of water's spread
  std::vector<double> transmittance_;   // [band]
  std::vector<double> joint_;           // [point of joint lines] weight times transmittance
  // Points of the hot water's absorption, by rising depth of the cold: kGasLanes k a band.
  std::vector<std::size_t> point_begin_;  // [band]
  std::vector<std::int32_t> place_;
  std::vector<double> on_, inverse_weight_, weight_, air_;
};

// A path's layers in neighbouring bands, with all of them that does not depend on the air before
// it: 33 kB a layer for 3-5 and 8-12 um, and half as much again for HotColumn's coarser path.
// Formulas: gas_spectrum.h.
class GasPath {
 public:
  // Prepares a path. Errors: those of check_gas, with the segment's number (from 1);
  // INVALID_ARGUMENT for bands that do not exist.
  [[nodiscard]] static absl::StatusOr<GasPath> make(std::span<const GasLayer> path, GasBands bands);

  [[nodiscard]] const GasSpectrum& alone() const { return alone_; }
  // Returns the path's light behind air of the same bands.
  [[nodiscard]] GasThroughAir through(const ForegroundAir& of) const;

 private:
  // Stored quantities of a layer, per band. Without joint lines: a factor of the remaining light
  // (soot, gases with lines of their own); water alone.
  enum Of { kFrom, kBy, kSootFrom, kWaterFrom, kWaterBy, kEmitted, kWeak, kShape, kKinds };
  void compute(std::span<const GasLayer> path);
  [[nodiscard]] double* of(std::size_t layer, Of what) {
    return of_band_.data() + (layer * kKinds + what) * bands_.size();
  }
  [[nodiscard]] const double* of(std::size_t layer, Of what) const {
    return of_band_.data() + (layer * kKinds + what) * bands_.size();
  }

  GasBands bands_;
  std::vector<JointLines> joint_;
  std::size_t layers_ = 0, points_ = 0;
  std::vector<double> of_band_;                // [layer][Of][band]
  std::vector<double> decay_;                  // [layer][point of joint lines], line_decay
  std::vector<double> independence_, spread_;  // [layer]
  std::vector<double> through_;  // [band] of soot and gases with lines of their own; at last
  std::vector<double> water_through_;
  GasSpectrum alone_;
};

}  // namespace irsig
