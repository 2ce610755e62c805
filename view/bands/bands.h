#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "core/detector/detector.h"
#include "view/bands/band_population.h"
#include "view/bands/merit.h"

namespace irsig {

// Finds the part of a stored band in which a detector sees a target best, or the two best parts.
// (docs/reference/bands.md)

// A passband of a detector: a window between two of the search's edges, or a filter.
struct Passband {
  std::size_t first = 0, last = 0;
  bool operator==(const Passband&) const = default;
};

// Ways of pairing passbands 1 and 2. S is the signal of a row (of a target, or the difference of
// two targets), V the variance of noise and, if rows have clutter, of clutter. W is the covariance
// of the clutter in both passbands (0 without clutter):
//
//   kNone        s = |S| / sqrt(V)
//   kDifference  s = |S1 - g S2| / sqrt(V1 + g^2 V2 - 2 g W),  g = sqrt(<B1^2> / <B2^2>): the gain
//                that makes the population's backgrounds B equal in both, so that they cancel
//   kMatched     s = sqrt((S1, S2) (V1 W; W V2)^-1 (S1, S2)^T): the best weighted sum of both, for
//                each row separately [fukunaga1990, 4.2]
//   kRatio       s = |angle between a and b| / sqrt(1 / |a|^2 + 1 / |b|^2),  a = (S1 / sqrt(V1),
//                S2 / sqrt(V2)) of the target, b of the other one: for a small difference of the
//                ratios S1 / S2, this is the difference over its noise, without division by a
//                signal that may be 0. With clutter, signals are taken in axes in which noise and
//                clutter are equal and independent
enum class Pairing { kNone, kDifference, kRatio, kMatched };

struct Candidate {
  Passband one;
  std::optional<Passband> other{};
  double gain = 0;  // of a difference
  double merit = 0;
};

[[nodiscard]] inline bool better(const Candidate& a, const Candidate& b) {
  return a.merit > b.merit;
}

// Returns whether candidate a stands before b in a list: by merit, the greater first; of equal
// merits, by their limits.
[[nodiscard]] bool precedes(const Candidate& a, const Candidate& b);

// Candidates that a search lists.
enum class Listed {
  kDifferent,  // the best, then each time the best of those that differ from all listed ones
  kAll         // the best, however alike: neighbours differ by one stored bin
};
// Two windows are alike if they share more than this fraction of what both cover together. Two
// pairs are alike if their lower windows are, and their upper ones.
constexpr double kSharedByAlike = 0.5;

struct CandidateMerit {
  Candidate of;
  // One sigma of the merit: from samples; with bounds and undersampled light; with models and
  // inputs. The mean offset from errors is included: |S| of a small S is as large as its error.
  double samples_stderr, numerical_error, total_error;
  // Probability of being the best candidate, and of being at least as good as the first one: by
  // numerical errors, and by all errors.
  double best_numerical, best, as_good_numerical, as_good;
  // Merit that these errors alone would give, without any contrast.
  double errors_alone = 0;
  // True if the merit is at least three times errors_alone (for a range: the range for errors three
  // times as large); otherwise the contrast is unknown.
  bool known = true;
  // Factor on the samples that would distinguish the candidate from the first one (at two sigma).
  // 0: it is distinguished, or is the first; infinite: no number of samples suffices, because
  // bounds and models remain.
  double samples_to_tell = 0;
  // True if a range lies beyond the ranges that it is derived from. Its errors are infinite; if the
  // first candidate's range does, the results of the comparison with it are NaN.
  bool extrapolated = false;
};
struct WindowChoice {
  std::vector<CandidateMerit> candidate;  // compared with each other, the best first
};

struct NamedFilter {
  std::string name;
  ResponseTable transmittance;  // times the detector's response
};

class BandSearch {
 public:
  // Prepares a search. An empty response is 1 over the whole band. INVALID_ARGUMENT: the response
  // extends beyond the stored band, a filter transmits nothing, a ratio has no other target, or a
  // difference has a population without background.
  static absl::StatusOr<BandSearch> make(BandPopulation population, const Detector& detector,
                                         Pairing pairing = Pairing::kNone,
                                         std::span<const NamedFilter> filters = {});

  // Checks that the population supports a merit. INVALID_ARGUMENT: it does not, or the merit is a
  // range and the rows have one range only.
  [[nodiscard]] absl::Status check(const MeritOf& merit) const;

  // Returns the limits of windows: those of the stored bins, and of the band.
  [[nodiscard]] std::span<const double> edges_um() const {
    return std::span(limit_um_).first(edges_);
  }
  [[nodiscard]] double step_um() const { return step_um_; }
  [[nodiscard]] Passband filter(std::size_t index) const { return {0, edges_ + index}; }

  [[nodiscard]] double lambda_min_um(Passband p) const;
  [[nodiscard]] double lambda_max_um(Passband p) const;
  // Returns the name of a filter; empty for a window.
  [[nodiscard]] std::string_view name(Passband p) const;
  // Returns the detector's response within a passband.
  [[nodiscard]] ResponseTable response(Passband p) const;

  // Returns the candidate with its gain and merit.
  [[nodiscard]] Candidate candidate(const MeritOf& merit, Passband one,
                                    std::optional<Passband> other = {}) const;

  // Returns whether two candidates without filters are alike (kSharedByAlike).
  [[nodiscard]] bool alike(const Candidate& a, const Candidate& b) const;

  // Result of a search over every window between two edges that has at least a given width; with a
  // pairing, over every two such windows that do not overlap. If these are too many, edges are
  // taken at a stride, and the best windows are moved edge by edge as long as that improves them.
  // Listed candidates that differ do not depend on held_pairs, the number of pairs that are held
  // for choosing them: where these do not suffice, pairs are judged again.
  struct Found {
    std::vector<Candidate> best;  // at most `most`, the best first
    std::vector<Candidate> map;   // of each window the best that it is part of
    std::size_t judged = 0, stride = 1;
  };
  [[nodiscard]] Found search(const MeritOf& merit, double least_width_um, std::size_t most,
                             Listed listed = Listed::kDifferent,
                             std::size_t held_pairs = kHeldPairs) const;

  [[nodiscard]] std::vector<double> snr(const Candidate& c) const;  // [row]
  // Returns the merit of the rows at one range of the population.
  [[nodiscard]] double merit_at(const MeritOf& merit, const Candidate& c, double range_m) const;
  // Returns the fraction of the variance of noise and clutter that is clutter, mean over rows: in
  // one passband, in the difference of two, or in their best weighted sum. 0: rows without clutter.
  [[nodiscard]] double clutter_fraction(const Candidate& c) const;
  // Returns the standard error of the mean's merit that results from samples, to first order; for
  // candidates of one passband only.
  [[nodiscard]] double mean_stderr(Passband p) const;
  // Returns the rms over rows of the fraction of the first passband's background that remains in
  // the difference.
  [[nodiscard]] double background_left(const Candidate& c) const;

  // Compares candidates by drawing their errors:
  //   samples   by mode, the same draw for all rows of a view (they share its paths)
  //   clutter   the standard error of its standard deviation, one draw for all rows of a view,
  //             whose windows show the same pixels; a numerical error
  //   bounds    uniform within them; models and inputs normal. One draw for all rows, distributed
  //             over wavelengths as |contrast|; half of the variance is a level and half a slope.
  //             For two targets, bounds have opposite signs, and models are independent
  [[nodiscard]] WindowChoice compare(const MeritOf& merit,
                                     std::span<const Candidate> candidates) const;

  // Range at which a row's s falls to the threshold, between the ranges of the population, by
  // linear interpolation of log s over log R. 0: below the threshold everywhere; infinite: above it
  // everywhere.
  struct Detection {
    std::size_t row;  // the first of its place
    double weight;    // of all rows of the place
    double range_m;
  };
  [[nodiscard]] std::vector<Detection> detection(const Candidate& c, double threshold) const;
  // Returns true if the merit is a range beyond the ranges from which it is derived.
  [[nodiscard]] bool extrapolated(const MeritOf& merit, const Candidate& c) const;

  [[nodiscard]] const BandPopulation& population() const { return population_; }
  [[nodiscard]] Pairing pairing() const { return pairing_; }

  // 60 MB.
  static constexpr std::size_t kHeldPairs = std::size_t{1} << 20;

 private:
  // Integrals of a target's rows from the band's first edge to each edge, and of each filter: the
  // integral over a passband is [last] - [first]. All values per R^2.
  using ByLimit = std::vector<std::vector<double>>;  // [limit][row]
  struct Cumulated {
    ByLimit signal, rest, shape, slope;
    std::vector<std::vector<std::vector<double>>> mode;  // [row][mode][limit]
    std::vector<double> whole_shape;                     // [row], of all windows
  };
  struct Errors {  // of the signals of both targets in both passbands
    std::array<double, 2> target{}, against{};
    double log_clutter = 0;  // of the clutter's standard deviation
    Errors operator*(double factor) const {
      return {{target[0] * factor, target[1] * factor},
              {against[0] * factor, against[1] * factor},
              log_clutter * factor};
    }
  };
  static double of(const ByLimit& by_limit, Passband p, std::size_t row) {
    return by_limit[p.last][row] - by_limit[p.first][row];
  }
  // Variances V1 and V2 in a candidate's passbands and the covariance W of both.
  struct Variances {
    double one = 0, other = 0, both = 0;
  };
  // Returns the variances of clutter alone.
  [[nodiscard]] Variances clutter_of(const Candidate& c, std::size_t row) const;
  // Returns the variances of noise and clutter together. larger: factor on the clutter's standard
  // deviation.
  [[nodiscard]] Variances variances(const Candidate& c, std::size_t row, double larger = 1) const;
  // One row at all its ranges, the nearest first.
  struct Place {
    std::size_t first_row;
    double weight;
    std::vector<std::pair<double, std::size_t>> row;  // range, row
  };
  // Returns the range [m] at which the SNR falls to the threshold. Beyond the ranges of the place,
  // the SNR follows the last or first line, but falls at least as 1 / R^2.
  [[nodiscard]] static double range_reached(const Place& place, double threshold,
                                            std::span<const double> snr);
  [[nodiscard]] double merit_of_rows(const MeritOf& merit, std::span<const double> snr) const;
  // Returns the SNR of one row with errors added. signals: factor on the signals; 0 leaves the
  // errors alone.
  [[nodiscard]] double of_row(const Candidate& c, std::size_t row, const Errors& error,
                              double signals = 1) const;
  struct Draws;
  [[nodiscard]] std::size_t most_modes() const;  // of a row
  [[nodiscard]] std::vector<Draws> draw_errors(const MeritOf& merit,
                                               std::span<const Candidate> candidates) const;
  [[nodiscard]] double gain(Passband one, Passband other) const;
  // Returns whether two windows share more than kSharedByAlike of what both cover.
  [[nodiscard]] bool share(Passband a, Passband b) const;
  [[nodiscard]] bool differs(const Candidate& c, std::span<const Candidate> from) const;
  // Appends candidates of a list in its order that differ from all in `out`, up to `most`.
  void append_different(std::span<const Candidate> list, std::size_t most,
                        std::vector<Candidate>& out) const;
  // Returns the first `most` of all candidates, or of those that differ.
  [[nodiscard]] std::vector<Candidate> first_of(std::vector<Candidate> all, std::size_t most,
                                                Listed listed) const;
  // Calls take(pair, number of its first window, of its second) for each two windows that do not
  // overlap, if wanted(pair).
  void each_pair(const MeritOf& merit, std::span<const Passband> window,
                 const std::function<bool(const Candidate&)>& wanted,
                 const std::function<void(const Candidate&, std::size_t, std::size_t)>& take) const;
  void search_pairs(const MeritOf& merit, double least_width_um, std::size_t most, Listed listed,
                    std::size_t held_pairs, Found& out) const;
  void climb(const MeritOf& merit, double least_width_um, std::size_t most, Listed listed,
             Found& out) const;

  BandPopulation population_;
  std::vector<double> weight_;  // [row]
  std::vector<Place> place_;
  DetectorIntegrals detector_;
  Detector whole_;
  Pairing pairing_ = Pairing::kNone;
  std::vector<NamedFilter> filter_;
  std::vector<double> limit_um_;  // edges
  std::size_t edges_ = 0;
  double step_um_ = 0,
         ratio_ = 1;  // the most that the detector's signal has of the band's response
  Cumulated target_, against_;
  // Clutter as signals, per R^2 [row][mode][limit], and the remainder without modes.
  std::vector<std::vector<std::vector<double>>> clutter_mode_;
  ByLimit clutter_rest_;
  ByLimit photons_, background_;
  std::vector<std::vector<double>> gram_;  // [limit][limit] <B B>
};

}  // namespace irsig
