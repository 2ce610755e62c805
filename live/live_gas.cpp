#include "live/live_gas.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/base/status_macros.h"
#include "core/hot_gas/gas_on_view.h"
#include "core/plume/march.h"

namespace irsig {
namespace {

constexpr std::size_t kOfGas = ColumnTests::kLambdas + 1;
// Columns that are computed in full: the fits use the even ones, the odd ones measure the error.
constexpr std::size_t kColumns = 32;
// Fits end at this error of every column, or with this number of tests.
constexpr double kFitError = 2e-3;
constexpr std::size_t kMostTests = 8;
// Least relative error that is stated: weights are interpolated between places, and the steps of
// columns are finite.
constexpr float kLeastGasError = 0.01f;

// Returns directions that cover the sphere evenly.
Vec<Body> direction_of(std::size_t i, std::size_t count) {
  const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(count),
               across = std::sqrt(1 - z * z),
               turn = std::numbers::pi * (3 - std::sqrt(5.0)) * static_cast<double>(i);
  return {across * std::cos(turn), across * std::sin(turn), z};
}

}  // namespace

SegmentSteps frame_steps() {
  SegmentSteps steps;
  steps.temperature_step = 0.2;
  steps.composition_step = 0.05;
  return steps;
}

LiveGas::LiveGas(const PreparedScene& scene, std::shared_ptr<const PlumeField> field,
                 std::uint32_t band)
    : scene_(scene), field_(std::move(field)), band_(band) {}

absl::StatusOr<std::unique_ptr<const LiveGas>> LiveGas::make(
    const PreparedScene& scene, std::shared_ptr<const PlumeField> field,
    const ConditionSources& light, std::uint32_t band, std::size_t background_node) {
  std::unique_ptr<LiveGas> out(new LiveGas(scene, std::move(field), band));
  const Columns columns = out->columns_around();
  if (columns.full.empty()) return absl::NotFoundError("no ray meets hot gas");
  RETURN_IF_ERROR(out->compute(columns));
  ASSIGN_OR_RETURN(const auto in_band, out->behind(light, background_node));
  out->choose(in_band);
  return out;
}

// Marches rays of all directions, each through a point of the gas. Neighbours in the order of
// points are close together, so that columns alternate between points and directions.
LiveGas::Columns LiveGas::columns_around() const {
  const std::vector<PlumePoint>& points = field_->points();
  Columns out;
  if (points.empty()) return out;
  constexpr double kFarM = 1e5;
  for (std::size_t i = 0; i < kColumns; ++i) {
    const Vec<Body> d = direction_of((i * 13) % kColumns, kColumns);
    const Vec<Body> at = points[i * points.size() / kColumns].at;
    const PlumeRay ray{at - kFarM * d, d, 0, 2 * kFarM};
    GasColumn full = march(*field_, ray, view_steps());
    if (full.empty()) continue;
    out.full.push_back(std::move(full));
    out.frame.push_back(march(*field_, ray, frame_steps()));
  }
  return out;
}

absl::Status LiveGas::compute(const Columns& columns) {
  const BandOnAxis band = scene_.axis.band(band_);
  first_node_ = band.first_node;
  ASSIGN_OR_RETURN(auto wavelengths, GasWavelengths::make(band.grid.node_um));
  wavelengths_ = std::make_unique<const GasWavelengths>(std::move(wavelengths));
  tests_ = std::make_unique<const ColumnTests>(ColumnTests::of(columns.full));
  stride_ = columns.full.size() > 1 ? 2 : 1;
  for (std::size_t m = 0; m < columns.full.size(); ++m) {
    tests_->test(columns.frame[m], tested_.emplace_back(ColumnTests::kCount));
    ASSIGN_OR_RETURN(auto made, HotColumn::make(columns.full[m], *wavelengths_));
    here_.push_back(made.at_near_end());
    column_.push_back(std::move(made));
  }
  return absl::OkStatus();
}

// Returns the spectra of the light that gas absorbs: of surfaces, of the sun, of the background.
std::array<std::span<const double>, kBehindGas> LiveGas::spectra_behind(
    const ConditionSources& light, std::size_t background_node) const {
  const SourceLayout& layout = light.layout();
  const auto surfaces = light.apparent(layout.seen(0));
  return {surfaces,
          light.suns().empty() ? surfaces : light.apparent(layout.sun(light.suns().front().index)),
          light.environment().background_apparent[background_node]};
}

LiveGas::InBand LiveGas::in_band(
    const ColumnLight& column, std::span<const double> transmittance,
    const std::array<std::span<const double>, kBehindGas>& behind) const {
  const std::vector<double>& weight = scene_.axis.band(band_).grid.band_weight;
  InBand out{};
  for (std::size_t i = 0; i < weight.size(); ++i)
    out[0] += weight[i] * (transmittance.empty() ? 1 : transmittance[first_node_ + i]) *
              column.emitted_w_m2_sr_um[i];
  for (std::size_t k = 0; k < kBehindGas; ++k) {
    double all = 0, taken = 0;
    for (std::size_t i = 0; i < weight.size(); ++i) {
      const double here = weight[i] * behind[k][first_node_ + i];
      all += here;
      taken += here * column.absorbed[i];
    }
    out[1 + k] = all > 0 ? taken / all : 0;
  }
  return out;
}

absl::StatusOr<std::vector<LiveGas::InBand>> LiveGas::behind(const ConditionSources& light,
                                                             std::size_t background_node) const {
  const ViewEnvironment& environment = light.environment();
  std::optional<AirBeforeColumns> air, overcast;
  if (environment.air != nullptr) {
    ASSIGN_OR_RETURN(air, AirBeforeColumns::make(*environment.air, *wavelengths_));
  }
  if (environment.overcast_air != nullptr) {
    ASSIGN_OR_RETURN(overcast, AirBeforeColumns::make(*environment.overcast_air, *wavelengths_));
  }
  const auto spectra = spectra_behind(light, background_node);
  // The air before columns has attenuated their emission.
  const std::span<const double> transmittance =
      air ? std::span<const double>{} : std::span<const double>(environment.transmittance);
  std::vector<InBand> out;
  for (std::size_t m = 0; m < column_.size(); ++m) {
    ColumnLight seen = air ? column_[m].behind(*air) : here_[m];
    if (air && overcast)
      seen = mixed(seen, column_[m].behind(*overcast), environment.overcast_fraction);
    out.push_back(in_band(seen, transmittance, spectra));
  }
  return out;
}

std::vector<std::size_t> LiveGas::chosen_tests(std::size_t quantity) const {
  std::vector<std::size_t> out;
  for (const std::uint32_t gas : gas_) {
    if (quantity == 0)
      for (std::size_t l = 0; l < ColumnTests::kLambdas; ++l) out.push_back(gas * kOfGas + l);
    else
      out.push_back(gas * kOfGas + ColumnTests::kLambdas);
  }
  return out;
}

std::vector<double> LiveGas::fit(const std::vector<InBand>& of_column, std::size_t quantity,
                                 const std::vector<std::size_t>& use) const {
  std::vector<std::vector<double>> of_test(use.size());
  std::vector<double> sums;
  for (std::size_t m = 0; m < of_column.size(); m += stride_) {
    sums.push_back(of_column[m][quantity]);
    for (std::size_t t = 0; t < use.size(); ++t) of_test[t].push_back(tested_[m][use[t]]);
  }
  return column_weights(of_test, sums, kFitError, kMostTests);
}

void LiveGas::choose(const std::vector<InBand>& of_column) {
  std::vector<std::uint32_t> used;
  gas_.resize(ColumnTests::kGases);
  std::iota(gas_.begin(), gas_.end(), 0u);
  for (std::size_t q = 0; q < 1 + kBehindGas; ++q) {
    const std::vector<std::size_t> use = chosen_tests(q);
    const std::vector<double> weight = fit(of_column, q, use);
    for (std::size_t t = 0; t < use.size(); ++t)
      if (weight[t] > 0) used.push_back(static_cast<std::uint32_t>(use[t] / kOfGas));
  }
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  gas_ = std::move(used);
}

// Returns the error that nine in ten of the columns keep that no fit has used, if there is one.
float LiveGas::error_of(const std::vector<InBand>& of_column, std::size_t quantity,
                        const std::vector<std::size_t>& use,
                        const std::vector<double>& weight) const {
  std::vector<float> off;
  for (std::size_t m = stride_ - 1; m < of_column.size(); m += stride_) {
    double is = 0;
    for (std::size_t t = 0; t < use.size(); ++t) is += weight[t] * tested_[m][use[t]];
    if (of_column[m][quantity] > 0)
      off.push_back(static_cast<float>(std::abs(is / of_column[m][quantity] - 1)));
  }
  if (off.empty()) return kLeastGasError;
  const auto at = off.begin() + static_cast<std::ptrdiff_t>(9 * (off.size() - 1) / 10);
  std::nth_element(off.begin(), at, off.end());
  return std::max(kLeastGasError, *at);
}

absl::StatusOr<std::vector<float>> LiveGas::weights(const ConditionSources& light,
                                                    std::size_t background_node) const {
  ASSIGN_OR_RETURN(const auto of_column, behind(light, background_node));
  std::vector<float> out;
  std::array<float, 1 + kBehindGas> error{};
  for (std::size_t q = 0; q < error.size(); ++q) {
    const std::vector<std::size_t> use = chosen_tests(q);
    const std::vector<double> weight = fit(of_column, q, use);
    for (const double w : weight) out.push_back(static_cast<float>(w));
    error[q] = error_of(of_column, q, use, weight);
  }
  out.push_back(error[0]);
  out.push_back(*std::max_element(error.begin() + 1, error.end()));
  return out;
}

GasOnRay LiveGas::light_of(const GasColumn& column, const std::vector<float>& weights) const {
  std::array<double, ColumnTests::kCount> test;
  tests_->test(column, gas_, {test.data(), gas_.size() * kOfGas});
  GasOnRay out;
  const float* emitted = weights.data();
  const float* absorbed = emitted + gas_.size() * ColumnTests::kLambdas;
  for (std::size_t g = 0; g < gas_.size(); ++g) {
    const double* of_gas = test.data() + g * kOfGas;
    for (std::size_t l = 0; l < ColumnTests::kLambdas; ++l)
      out.emitted_w_m2_sr += emitted[g * ColumnTests::kLambdas + l] * static_cast<float>(of_gas[l]);
    for (std::size_t k = 0; k < kBehindGas; ++k)
      out.absorbed[k] +=
          absorbed[k * gas_.size() + g] * static_cast<float>(of_gas[ColumnTests::kLambdas]);
  }
  for (float& a : out.absorbed) a = std::clamp(a, 0.0f, 1.0f);
  return out;
}

}  // namespace irsig
