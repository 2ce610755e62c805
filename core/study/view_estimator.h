#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/signature/simulator.h"
#include "core/sources/view_sources.h"
#include "core/transport/path_tracer.h"

namespace irsig {

// Options of an estimate. The defaults are those of a sweep with a relative error.
struct EstimatorOptions {
  std::uint32_t max_reflections = 16;
  std::uint32_t replicates = 32;
  bool pseudo_random = false;  // independent random numbers instead of scrambled Sobol points
  // Each stored wavelength (all nodes of its bin) is traced by itself, with numbers of its own.
  bool each_wavelength = false;
  bool hot_parts = true;  // off: no strata of hot parts, and they are found by chance
  // Off (with hot_parts off too): rays are aimed at the bounding rectangle of the target.
  bool coverage_mask = true;
  bool wide_roulette = true;  // off: survival with probability throughput x DHR, and no splitting
};

// Returns the options of the ship paper's reverse Monte Carlo, as far as the paper states it: every
// wavelength by itself, pseudo-random numbers, one path for each ray, absorbed or reflected by
// chance. Two properties that the paper does not have are kept, both to its advantage: directions
// are drawn from the lobe with the right density, and rays are aimed at the sun's disk (a random
// direction meets it 2e-5 times).
[[nodiscard]] EstimatorOptions plain_monte_carlo(std::uint32_t max_reflections);

struct ViewRow {
  std::uint32_t condition, band;  // of the request
};

// One row's result. spectral_w_sr_um: on the stored wavelengths.
struct RowValue {
  double intensity_w_sr = 0, emitted_w_sr = 0, projected_area_m2 = 0;
  std::vector<double> spectral_w_sr_um;
};
struct ViewValue {
  std::vector<RowValue> row;
  std::vector<Estimate> intensity_w_sr, emitted_w_sr, projected_area_m2;  // [row]
  std::vector<Estimate> apparent_intensity_w_sr;  // [row]; not where each wavelength is traced
  std::vector<std::vector<double>> spectral_stderr_w_sr_um;  // [row]
  std::uint64_t samples = 0, rays = 0;  // primary rays, all replicates; all rays
};

// One view of a scene, to be estimated in different ways. What does not depend on the way (sky and
// air as this view sees them) is made once. The simulator and the request must outlive it. Any
// number of threads may estimate.
class ViewEstimator {
 public:
  // Prepares an estimator. conditions: all that rows will name. INVALID_ARGUMENT as in
  // Environment::view().
  static absl::StatusOr<std::unique_ptr<ViewEstimator>> create(
      const Simulator& simulator, const ViewRequest& request,
      std::vector<std::uint32_t> conditions);

  // Estimates all rows from the same paths, traced once. stderr: from the replicates' spread; 0
  // where each wavelength is traced by itself, with one replicate only.
  [[nodiscard]] ViewValue estimate(const EstimatorOptions& knobs, std::span<const ViewRow> rows,
                                   std::uint64_t samples_per_replicate, std::uint64_t seed) const;

 private:
  ViewEstimator(const Simulator& simulator, const ViewRequest& request);
  // Returns the sources of the wanted conditions.
  [[nodiscard]] ViewSources sources_of(std::span<const std::uint32_t> conditions,
                                       bool contrast) const;
  [[nodiscard]] PathSettings settings(const EstimatorOptions& knobs) const;
  void trace_together(std::span<const ViewRow> rows, const PathSettings& settings,
                      const Target& target, const AimedView& view, ViewValue& out) const;
  void trace_each_wavelength(const ViewRow& row, PathSettings settings, const Target& target,
                             const AimedView& view, ViewValue& out) const;

  const Simulator& simulator_;
  const ViewRequest& request_;
  Target unmarked_;  // without hot parts
  AimedView whole_;  // of the latter: one stratum, the bounding rectangle
  std::shared_ptr<const ViewEnvironments> environments_;
};

}  // namespace irsig
