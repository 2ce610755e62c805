#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/accuracy/spectral_modes.h"
#include "core/detector/detector.h"
#include "view/band_sum.h"

namespace irsig {

// Which part of a stored band a detector sees a target best in. (docs/bands.md)

// One row of the population: what a sensor sees of the target, on the band's stored wavelengths.
struct BandCase {
  double weight;      // of all rows together: 1
  std::size_t view;   // rows of one view share their paths
  double range_m;     // of the sensor
  std::size_t place;  // the same row at another range has the same
  // At the aperture: the target less its background, or one target less another. [W/(sr um)]
  std::vector<double> contrast;
  std::vector<double> background_w_m2_sr_um;
  SpectralSet modes;  // of the contrast's errors, and what they leave over
  std::vector<double> rest;
  double bias_bound_w_sr, unseen_stderr_w_sr;  // of the whole band
  double model_error_w_sr;                     // one sigma, with that of uncertain inputs
};
struct BandPopulation {
  std::vector<double> lambda_um;
  ResponseTable own_response;  // of the stored band; empty: 1
  std::vector<BandCase> row;
  std::size_t without_modes = 0;
};

// How much each row counts: all alike, or each aspect as the solid angle of the directions that are
// nearest to it (between the lowest and the highest viewpoint).
enum class AspectWeight { kRows, kSolidAngle };

// Rows of one band, as run_query gives them. against: rows of another target at the same places,
// empty: none. INVALID_ARGUMENT: no rows, several bands, interpolated rows, rows that have no
// partner, other wavelengths.
[[nodiscard]] absl::StatusOr<BandPopulation> band_population(StoreReader& reader,
                                                             std::span<const QueryRow> rows,
                                                             StoreReader* other,
                                                             std::span<const QueryRow> against,
                                                             AspectWeight weight);

// Of the signal-to-noise ratios s of the rows, in one window.
enum class Merit {
  kMean,
  kPercentile,  // what all but `percentile` % of the population exceed
  kWorst,
  kAbove  // the share of the population with s >= threshold
};
struct MeritOf {
  Merit merit = Merit::kMean;
  double percentile = 10, threshold = 5;
};

struct WindowMerit {
  double lambda_min_um, lambda_max_um;
  double merit;
  // One sigma of the merit: of the samples; with bounds and unseen light; with models and inputs.
  double samples_stderr, numerical_error, total_error;
  double best_numerical, best;  // probability of being the best of those compared
  double as_good;               // of being at least as good as the first, all errors considered
};
struct BandChoice {
  std::vector<WindowMerit> window;  // compared with each other, the best first
  // How many times as many samples would tell the first from the second (at two sigma); 0: they are
  // told apart; infinite: no number of samples, what is left are bounds and models.
  double samples_to_tell = 0;
};

class BandSearch {
 public:
  // INVALID_ARGUMENT: a response outside the stored band. An empty one is 1 over the whole band.
  static absl::StatusOr<BandSearch> make(BandPopulation population, const Detector& detector);

  // Limits of windows: those of the stored bins, and of the band.
  [[nodiscard]] const std::vector<double>& edges_um() const { return edges_um_; }
  [[nodiscard]] double step_um() const { return step_um_; }

  // The merit of every window between two edges that is at least so wide. A row at range R has
  //   s = |integral of signal x contrast| / R^2 / sqrt(variance)
  struct Map {
    std::vector<std::size_t> first, last;  // edges
    std::vector<double> merit;
  };
  [[nodiscard]] Map map(const MeritOf& merit, double least_width_um) const;
  // Windows between edges, by the nearest edges; nullopt where both ends have the same.
  [[nodiscard]] double merit(const MeritOf& merit, std::size_t first, std::size_t last) const;
  [[nodiscard]] std::vector<double> snr(std::size_t first, std::size_t last) const;  // [row]
  // The standard error that samples leave of the mean's merit, to first order.
  [[nodiscard]] double mean_stderr(std::size_t first, std::size_t last) const;

  // The best of a map, at most so many, compared by drawing their errors:
  // samples   by mode, the same draw for all rows of a view (they share its paths);
  // bounds    uniform within them, models and inputs normal: one draw for all rows, spread over
  //           wavelengths as |contrast| is, half of the variance level and half a slope.
  [[nodiscard]] BandChoice compare(const MeritOf& merit, const Map& map, std::size_t most) const;

  // The range at which a row's s falls to the threshold, between the ranges of the population, on a
  // straight line of log s over log R; 0: below it everywhere, infinite: above it everywhere.
  // [place]
  [[nodiscard]] std::vector<double> detection_range_m(std::size_t first, std::size_t last,
                                                      double threshold) const;
  [[nodiscard]] const BandPopulation& population() const { return population_; }

 private:
  // Integrals of one row from the band's first edge to each edge.
  struct Cumulated {
    std::vector<double> signal, photons, rest, shape, slope;
    std::vector<std::vector<double>> mode;
  };
  [[nodiscard]] double of_row(std::size_t row, double error, std::size_t first,
                              std::size_t last) const;
  [[nodiscard]] double merit_of(const MeritOf& merit, std::vector<double>& snr) const;

  BandPopulation population_;
  DetectorIntegrals detector_;
  std::vector<double> edges_um_;
  double step_um_ = 0,
         ratio_ = 1;  // the most that the detector's signal has of the band's response
  std::vector<Cumulated> cumulated_;  // [row], already per R^2 where that belongs
};

}  // namespace irsig
