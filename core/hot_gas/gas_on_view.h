#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "core/hot_gas/column_tests.h"
#include "core/plume/plume_field.h"
#include "core/sources/source_geometry.h"

namespace irsig {

// How finely rays of a view are cut: what this costs is measured with half as many steps.
[[nodiscard]] SegmentSteps view_steps();

// Collects what rays meet and lets none go on. For one thread.
class GasSurvey final : public GasOnRays {
 public:
  GasSurvey(std::shared_ptr<const PlumeField> field, Vec<Body> centre)
      : field_(std::move(field)), centre_(centre), steps_(view_steps()) {}
  [[nodiscard]] std::uint32_t measures() const override { return 0; }
  [[nodiscard]] std::uint32_t classes() const override { return 0; }
  [[nodiscard]] std::optional<Crossing> cross(Vec<Body> from, Vec<Body> direction, double end_m,
                                              std::span<double> measure) const override;
  [[nodiscard]] const std::vector<GasColumn>& columns() const { return columns_; }

 private:
  std::shared_ptr<const PlumeField> field_;
  Vec<Body> centre_;
  SegmentSteps steps_;
  mutable std::vector<GasColumn> columns_;
};

// Hot gas as a view's rays measure it, by test gases; what is behind it is told apart by which of a
// few columns takes most nearly the same of it.
class GasOnView final : public GasOnRays {
 public:
  //   like  tests of those columns: none empty
  GasOnView(std::shared_ptr<const PlumeField> field, Vec<Body> centre, const ColumnTests& tests,
            const std::vector<std::vector<double>>& like);
  [[nodiscard]] std::uint32_t measures() const override { return ColumnTests::kCount; }
  [[nodiscard]] std::uint32_t classes() const override {
    return static_cast<std::uint32_t>(like_.size());
  }
  [[nodiscard]] std::optional<Crossing> cross(Vec<Body> from, Vec<Body> direction, double end_m,
                                              std::span<double> measure) const override;
  // The class of a column, and by what its absorption is that of the class: from its tests.
  [[nodiscard]] std::pair<std::uint32_t, double> like(std::span<const double> tests) const;

 private:
  std::shared_ptr<const PlumeField> field_;
  Vec<Body> centre_;  // of the target
  SegmentSteps steps_;
  ColumnTests tests_;
  struct Absorption {
    std::array<double, ColumnTests::kGases> of_gas;
    double mean;
  };
  [[nodiscard]] static Absorption absorption(std::span<const double> tests);
  std::vector<Absorption> like_;
};

}  // namespace irsig
