#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/hot_gas/column_tests.h"
#include "core/plume/plume_field.h"
#include "core/sources/source_geometry.h"

namespace irsig {

// Returns the step sizes for rays of a view. Half as many steps measure their error.
[[nodiscard]] SegmentSteps view_steps();

// Collects what rays meet and lets none go on. For one thread.
class ColumnCollector final : public RayMedium {
 public:
  ColumnCollector(std::shared_ptr<const PlumeField> field, Vec<Body> centre)
      : field_(std::move(field)), centre_(centre), steps_(view_steps()) {}
  [[nodiscard]] std::uint32_t measures() const override { return 0; }
  [[nodiscard]] std::uint32_t classes() const override { return 0; }
  [[nodiscard]] std::optional<double> cross(Vec<Body> from, Vec<Body> direction, double end_m,
                                            std::span<double> measure,
                                            std::span<float> share) const override;
  [[nodiscard]] const std::vector<GasColumn>& columns() const { return columns_; }

 private:
  std::shared_ptr<const PlumeField> field_;
  Vec<Body> centre_;
  SegmentSteps steps_;
  mutable std::vector<GasColumn> columns_;
};

// Bands in which gas is thick. In a band its mean absorption is the sum of weight x absorption of
// the test gases, and -ln(1 - that) is at least optical_depth.
struct ThickGas {
  double optical_depth = 0;
  std::vector<std::array<double, ColumnTests::kGases>> weight;  // [band]
};

// Hot gas as a view's rays measure it, by test gases, and by whether it is thick; what it takes of
// the light behind it as a sum of what a few columns take, its classes.
class GasOnView final : public RayMedium {
 public:
  using Absorbed = std::array<double, ColumnTests::kGases>;
  //   most     the largest that any column absorbs of each test gas
  //   classes  tests of those columns: none empty, at most kMostClasses
  //   thick    measures behind those of the tests: of each band 1 where the gas is thick, else 0
  GasOnView(std::shared_ptr<const PlumeField> field, Vec<Body> centre, const ColumnTests& tests,
            const Absorbed& most, const std::vector<std::vector<double>>& classes,
            ThickGas thick = {});
  static constexpr std::size_t kMostClasses = 8;
  [[nodiscard]] std::uint32_t measures() const override {
    return static_cast<std::uint32_t>(ColumnTests::kCount + thick_.weight.size());
  }
  [[nodiscard]] std::uint32_t classes() const override {
    return static_cast<std::uint32_t>(classes_.size());
  }
  [[nodiscard]] std::optional<double> cross(Vec<Body> from, Vec<Body> direction, double end_m,
                                            std::span<double> measure,
                                            std::span<float> share) const override;
  // Weights of the classes that represent a column, from its tests: the sum of classes whose
  // absorption of all test gases, each relative to the largest, is nearest in least squares.
  // unlike: root mean square of the residual.
  struct Shares {
    std::array<double, kMostClasses> of_class{};
    double unlike = 0;
  };
  [[nodiscard]] Shares shares(std::span<const double> tests) const;

 private:
  std::shared_ptr<const PlumeField> field_;
  Vec<Body> centre_;  // of the target
  SegmentSteps steps_;
  ColumnTests tests_;
  Absorbed scale_{};                // 1 / most
  std::vector<Absorbed> classes_;   // times scale_
  std::vector<Absorbed> fraction_of_;  // [class] Its share: the sum of this x what a column absorbs
  ThickGas thick_;
};

}  // namespace irsig
