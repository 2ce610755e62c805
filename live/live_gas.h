#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/hot_gas/column_spectra.h"
#include "core/hot_gas/column_tests.h"
#include "core/plume/plume_field.h"
#include "core/signature/view/prepared_scene.h"
#include "core/sources/condition_sources.h"

namespace irsig {

// Returns the step sizes for rays of frames. They are longer than those of view_steps(), and errors
// of LiveGas include the difference.
[[nodiscard]] SegmentSteps frame_steps();

// Kinds of light behind hot gas. Each has a spectrum of its own, and so loses another fraction.
enum class BehindGas : std::uint8_t { kEmitted, kSun, kBackground };
inline constexpr std::size_t kBehindGas = 3;

// In-band light of one column of hot gas at the sensor.
struct GasOnRay {
  float emitted_w_m2_sr = 0;
  std::array<float, kBehindGas> absorbed{};  // [BehindGas] fraction
};

// Hot gas of one condition in one band. The light of any column is a weighted sum of a few grey
// test gases. The weights are fitted to columns of the field, whose spectra are computed in full
// once, behind the air of each place of the sensor. Immutable and thread-safe.
class LiveGas {
 public:
  // Computes the columns and chooses the test gases.
  //   centre           of the target
  //   light            of the condition at any place of the sensor
  //   background_node  node of ViewEnvironment::background_apparent behind the target
  // NOT_FOUND: no ray of any direction meets gas. INVALID_ARGUMENT: imported air, gas outside its
  // tables.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<const LiveGas>> make(
      const PreparedScene& scene, std::shared_ptr<const PlumeField> field,
      const ConditionSources& light, std::uint32_t band, std::size_t background_node);

  // Returns the numbers of one place, in which the light of columns is linear: weights and relative
  // errors. Errors: those of make().
  [[nodiscard]] absl::StatusOr<std::vector<float>> weights(const ConditionSources& light,
                                                           std::size_t background_node) const;
  // Returns the light of a column.
  //   weights  of a place, or a mean of places
  [[nodiscard]] GasOnRay light_of(const GasColumn& column, const std::vector<float>& weights) const;

  // Return the relative errors of light_of() that nine columns in ten keep, from columns that the
  // weights were not fitted to.
  [[nodiscard]] float emitted_error(const std::vector<float>& weights) const {
    return weights[weights.size() - 2];
  }
  [[nodiscard]] float absorbed_error(const std::vector<float>& weights) const {
    return weights.back();
  }
  [[nodiscard]] const PlumeField& field() const { return *field_; }

 private:
  LiveGas(const PreparedScene& scene, std::shared_ptr<const PlumeField> field, std::uint32_t band);
  // One ray's gas, by the steps of the estimator at rest and by those of frames.
  struct Columns {
    std::vector<GasColumn> full, frame;
  };
  [[nodiscard]] Columns columns_around() const;
  [[nodiscard]] absl::Status compute(const Columns& columns);
  // In-band light of a column: emission, then the absorbed fractions.
  using InBand = std::array<double, 1 + kBehindGas>;
  [[nodiscard]] std::array<std::span<const double>, kBehindGas> spectra_behind(
      const ConditionSources& light, std::size_t background_node) const;
  // Sums a column's spectrum.
  //   transmittance  of the air before it, which its emission lacks; empty: none
  [[nodiscard]] InBand in_band(const ColumnLight& column, std::span<const double> transmittance,
                               const std::array<std::span<const double>, kBehindGas>& behind) const;
  // Computes the light of each column behind the air of a place.
  [[nodiscard]] absl::StatusOr<std::vector<InBand>> behind(const ConditionSources& light,
                                                           std::size_t background_node) const;
  // Chooses the test gases that the fits of all columns need.
  void choose(const std::vector<InBand>& of_column);
  // Fits weights of the tests in `use` to one quantity of InBand.
  [[nodiscard]] std::vector<double> fit(const std::vector<InBand>& of_column, std::size_t quantity,
                                        const std::vector<std::size_t>& use) const;
  [[nodiscard]] std::vector<std::size_t> chosen_tests(std::size_t quantity) const;
  [[nodiscard]] float error_of(const std::vector<InBand>& of_column, std::size_t quantity,
                               const std::vector<std::size_t>& use,
                               const std::vector<double>& weight) const;

  const PreparedScene& scene_;
  std::shared_ptr<const PlumeField> field_;
  std::uint32_t band_;
  std::size_t first_node_ = 0;
  std::size_t stride_ = 1;  // between columns of one use: fits, errors
  std::unique_ptr<const GasWavelengths> wavelengths_;
  std::unique_ptr<const ColumnTests> tests_;
  std::vector<std::vector<double>> tested_;  // [column][test]
  std::vector<HotColumn> column_;
  std::vector<ColumnLight> here_;   // of the columns, before any air
  std::vector<std::uint32_t> gas_;  // test gases that are used, increasing
};

}  // namespace irsig
