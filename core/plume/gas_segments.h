#pragma once

#include <array>
#include <vector>

#include "core/plume/plume_field.h"

namespace irsig {

// The gas at one place of a ray, with what its temperature and composition are there. Neighbouring
// steps share it.
struct GasPoint {
  GasSums sums;
  bool holds_gas = false;
  // Meaningful where there is gas.
  double temperature_k = 0;
  std::array<double, kPlumeSpecies> share{};  // of a species in the weight

  GasPoint() = default;
  explicit GasPoint(const GasSums& at) : sums(at), holds_gas(at.weight > 0) {
    if (!holds_gas) return;
    const double per_weight = 1 / at.weight;
    temperature_k = at.weight_temperature * per_weight;
    for (std::size_t k = 0; k < kPlumeSpecies; ++k)
      share[k] = at.amount[k] * kWeightOfAmount[k] * per_weight;
  }

  static constexpr std::array<double, kPlumeSpecies> kWeightOfAmount = {1, 1, 1, kSootMolPerM3};
  static_assert(kSoot == 3);
};

// A piece of a ray in hot gas: what is left of the ray once it was traced. Any number of bands and
// conditions can be shaded from it (docs/decisions/0001): absorption from temperature, pressure,
// amounts and length; emission from the temperature's mean, change and spread.
//
// Temperatures are weighted by the amount of gas (GasSums::weight). Merging two pieces keeps
// amounts, length, mean, change, spread and skew of the temperature exactly.
struct GasSegment {
  double start_m = 0, end_m = 0;  // along the ray
  // CO2, H2O, CO [mol/m2]; soot: volume fraction times length [m].
  std::array<double, kPlumeSpecies> amount{};
  double weight = 0;         // moles that temperature and pressure are weighted with [mol/m2]
  double temperature_k = 0;  // mean
  double temperature_change_k = 0;  // of the best straight line in amount, far end less near end
  double temperature_spread_k = 0;  // standard deviation, the line's included
  double temperature_skew_k3 = 0;   // third central moment: on which side a jump is
  double pressure_pa = 0;           // mean

  [[nodiscard]] double length_m() const { return end_m - start_m; }
  // Returns the mole fraction of CO2, H2O or CO for the gas model: with temperature, pressure and
  // length, mole fraction x pressure x length / (R T) is the amount.
  [[nodiscard]] double mole_fraction(std::size_t species) const;
};

// A grey gas, for steps and silhouettes: absorption cross sections of CO2, H2O, CO [m2/mol], and of
// soot [1/m for volume fraction 1].
struct GreyAbsorption {
  std::array<double, kPlumeSpecies> per_amount{};
  [[nodiscard]] double optical_depth(const GasSegment& segment) const;
};

// Criteria by which pieces of a ray are one segment.
struct SegmentSteps {
  // The ratio of the largest to the smallest temperature of a segment, less 1; where its grey
  // optical depth exceeds optical_depth_step, so many times less; a quarter of it where the
  // temperature rises and falls. Cells of the grid in which it is exceeded are halved, at most 8
  // times.
  double temperature_step = 0.02;
  double optical_depth_step = 0.25;
  GreyAbsorption grey{};  // 0: temperature alone decides
  // Most change of a species' share of the weight where the temperature changes by its whole step;
  // where it changes less, so many times more: what absorbs is then as hot as the rest.
  double composition_step = 0.01;
  double pressure_step = 0.02;  // most relative change of pressure

  // Returns true if a piece with this range of temperature, grey optical depth and change of
  // composition is fine enough.
  [[nodiscard]] bool allow(double temperature_range, double optical_depth,
                           double composition_change) const;
};

// A piece of a ray as sums, to which further gas is appended without a division, and the extremes
// of its temperature and of the shares of species in its weight.
struct GasPiece {
  double start_m = 0, end_m = 0;
  double from_k = 0;  // temperatures are counted from it
  GasSums sums;       // times length
  // Integrals over the weight of the temperature, its square, its cube, and of it times the weight
  // in front.
  double first = 0, square = 0, cube = 0, ordered = 0;
  double least_k = 0, most_k = 0;
  std::array<double, kPlumeSpecies> least_fraction{}, most_fraction{};

  // Returns the gas between a and b, known there and in the middle: by Simpson's rule, exact where
  // amounts are cubic in the distance. Without gas its weight is 0.
  [[nodiscard]] static GasPiece between(double a, const GasPoint& at_a, const GasPoint& at_middle,
                                        double b, const GasPoint& at_b);
  // Appends a piece that lies behind this one.
  void append(const GasPiece& next);
  [[nodiscard]] double pressure_pa() const { return sums.weight_pressure / sums.weight; }
  [[nodiscard]] GasSegment segment() const;
  [[nodiscard]] bool is_fine(const SegmentSteps& steps) const;
};

// Puts the pieces of one ray together, from near to far.
class SegmentBuilder {
 public:
  explicit SegmentBuilder(const SegmentSteps& steps) : steps_(steps) {}
  void add(const GasPiece& piece);
  [[nodiscard]] std::vector<GasSegment> take();

 private:
  [[nodiscard]] bool continues(const GasPiece& next) const;

  const SegmentSteps& steps_;
  std::vector<GasSegment> out_;
  GasPiece open_;
  double first_pressure_pa_ = 0;
  bool is_open_ = false;
};

// A segment's temperature as two layers, which reproduces the first-order effect of the order of
// its parts. To first order in the temperature, the difference between one layer and these two
// equals the difference between these two and a straight line, or a jump, of the same mean, change,
// spread and skew.
struct TemperatureCourse {
  double first = 0.5;      // share of the nearer layer
  double half_step_k = 0;  // the farther less the nearer
  bool is_flat = false;
  bool is_known = true;  // not where it rises and falls
};
[[nodiscard]] TemperatureCourse course_of(const GasSegment& segment);

// Merges two segments; b lies behind a.
[[nodiscard]] GasSegment merged(const GasSegment& a, const GasSegment& b);

// Returns segments with steps twice as large: neighbours are merged two by two, and a remaining one
// loses its change and spread. The change of the light estimates the error of the finite steps
// (step_error in gas_light.h). Neighbours whose temperatures lie on no common line are not merged:
// a jump or a peak of the field is no step.
struct CoarseStep {
  GasSegment segment;
  std::size_t count = 1;  // of segments that it stands for
};
[[nodiscard]] std::vector<CoarseStep> coarser(const std::vector<GasSegment>& segments);

}  // namespace irsig
