#include "core/hot_gas/gas_on_view.h"

#include "core/plume/march.h"

namespace irsig {

SegmentSteps view_steps() {
  SegmentSteps steps;
  steps.temperature_step = 0.06;
  return steps;
}

std::optional<GasOnRays::Crossing> GasSurvey::cross(Vec<Body> from, Vec<Body> direction,
                                                    double end_m,
                                                    std::span<double> /*measure*/) const {
  GasColumn column = march(*field_, {centre_ + from, direction, 0, end_m}, steps_);
  if (!column.empty()) columns_.push_back(std::move(column));
  return std::nullopt;
}

GasOnView::GasOnView(std::shared_ptr<const PlumeField> field, Vec<Body> centre,
                     const ColumnTests& tests, const std::vector<std::vector<double>>& like)
    : field_(std::move(field)), centre_(centre), steps_(view_steps()), tests_(tests) {
  for (const std::vector<double>& of_class : like) like_.push_back(absorption(of_class));
}

GasOnView::Absorption GasOnView::absorption(std::span<const double> tests) {
  Absorption out{ColumnTests::absorbed(tests), 0};
  for (const double a : out.of_gas) out.mean += a / ColumnTests::kGases;
  return out;
}

std::pair<std::uint32_t, double> GasOnView::like(std::span<const double> tests) const {
  const Absorption own = absorption(tests);
  std::pair<std::uint32_t, double> out{0, 0};
  double nearest = 1e300;
  for (std::uint32_t k = 0; k < like_.size(); ++k) {
    const double factor = own.mean / like_[k].mean;
    double off = 0;
    for (std::size_t g = 0; g < ColumnTests::kGases; ++g) {
      const double d = own.of_gas[g] - factor * like_[k].of_gas[g];
      off += d * d;
    }
    if (off < nearest) {
      nearest = off;
      out = {k, factor};
    }
  }
  return out;
}

std::optional<GasOnRays::Crossing> GasOnView::cross(Vec<Body> from, Vec<Body> direction,
                                                    double end_m, std::span<double> measure) const {
  const GasColumn column = march(*field_, {centre_ + from, direction, 0, end_m}, steps_);
  if (column.empty()) return std::nullopt;
  tests_.test(column, measure);
  const auto [like, factor] = this->like(measure);
  return Crossing{like, factor, 0.5 * (column.front().start_m + column.back().end_m),
                  factor * like_[like].mean};
}

}  // namespace irsig
