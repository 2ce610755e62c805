#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/plume/gas_segments.h"

namespace irsig {

// The hot gas on one ray, from near to far.
using GasColumn = std::vector<GasSegment>;

// Grey test gases that stand for the spectra of a column: a spectrum is, at each wavelength, some
// function of the column, and all these functions are much alike: absorption coefficients of lines
// that are weak or strong, the same at all temperatures or rising with it. Test gases span them: of
// each species six optical depths, 0.1 to 10^4 over `most`, as lines from the ground state and as
// hot ones (T^4, T^8), each with what it emits as seen at 4.3 and at 10 um and what it absorbs.
class ColumnTests {
 public:
  // most: the largest amount of each species in any column; hottest_k likewise.
  ColumnTests(const std::array<double, kPlumeSpecies>& most, double hottest_k);
  // Returns the tests whose scales are the largest amounts and temperature of some columns.
  [[nodiscard]] static ColumnTests of(const std::vector<GasColumn>& columns);

  static constexpr std::size_t kDepths = 6, kRises = 3, kLambdas = 2;
  static constexpr std::size_t kGases = kPlumeSpecies * kDepths * kRises;
  static constexpr std::size_t kCount = kGases * (kLambdas + 1);
  // Returns the index of the optical depth of a gas.
  static std::size_t depth_of(std::size_t gas) { return gas / kRises % kDepths; }
  // Computes the tests of a column, [gas][emitted at each wavelength, absorbed]; 0 of absent
  // species.
  void test(const GasColumn& column, std::span<double> out) const;
  // Computes the tests of the listed gases alone, [gas of the list][emitted at each wavelength,
  // absorbed].
  //   gases  indices below kGases
  void test(const GasColumn& column, std::span<const std::uint32_t> gases,
            std::span<double> out) const;
  // Returns the absorbed fractions among the tests, in their order.
  [[nodiscard]] static std::array<double, kGases> absorbed(std::span<const double> tests);

 private:
  std::array<double, kPlumeSpecies> scale_{};
  double hottest_k_;
};

// Weights of columns that together have given tests: sum over columns of weight x tests = sums, in
// least squares of what each test is off relative to its sum. None is negative, few are not 0
// ([lawson1974], ch. 23): a quadrature rule for all functions that the tests stand for.
//   columns  [column][test]
// Ends where no test is off by more than tolerance of its sum, or `most` weights are not 0.
[[nodiscard]] std::vector<double> column_weights(const std::vector<std::vector<double>>& columns,
                                                 std::span<const double> sums, double tolerance,
                                                 std::size_t most);

// Returns the differences between the weighted sums of columns and the given sums. [test]
[[nodiscard]] std::vector<double> column_misfit(const std::vector<std::vector<double>>& columns,
                                                std::span<const double> weight,
                                                std::span<const double> sums);

}  // namespace irsig
