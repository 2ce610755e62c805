#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "absl/status/statusor.h"
#include "view/moved/sight_line.h"

namespace irsig {

// Relative error bound of a reflected radiance of 1 in each bin when it is moved: the transmittance
// of its directions from one range to the other, against that of the mean. [side][bin], sky and sea
using ReflectedSpread = std::array<SightLine::Values, 2>;
[[nodiscard]] ReflectedSpread spread_of(const SightLine& from, const SightLine& to);

// Transmitted light of sky and sea that a target reflects, from a stored range and from another
// one, for any elevation of the sensor, interpolated from lines of sight at a few elevations. Most
// of the time of a line goes into the light around the target. The arriving part depends on the
// line's elevation and range alone, not on its azimuth, and varies smoothly over the transmittance.
// Cubic between elevations; the difference to straight lines is added to the spread, and exceeds
// the error: tests/unit/arriving_reflected_test.cpp.
class ArrivingTable {
 public:
  // Whole lines of sight for some conditions from one elevation and range.
  using Lines = std::function<absl::StatusOr<std::vector<SightLine>>(
      double elevation_deg, double range_m, const std::vector<std::uint32_t>& conditions)>;

  // Both sides at one elevation, each over the transmittance there.
  struct Node {
    using Values = std::vector<float>;  // [bin]; rounded, 6e-8 of them
    struct Side {
      Values from_bin, from_band, to_bin, to_band, spread;  // spread: over that of the other range
    };
    std::array<Side, 2> side;
  };
  // Returns the size of a table with all elevations, for so many conditions and ranges and stored
  // wavelengths. [bytes]
  [[nodiscard]] static double bytes(std::size_t conditions, std::size_t ranges, std::size_t bins);
  // One elevation from one stored range: to be made by compute(), each by one thread.
  struct Task {
    std::size_t node;
    double from_m;
    std::vector<double> to_m;
    std::vector<std::uint32_t> condition;
    std::vector<std::optional<Node>*> out;  // [condition x range]
  };
  // Returns the tasks that lines from this elevation lack and that were not returned before. All of
  // them must be computed before at() is called.
  [[nodiscard]] std::vector<Task> lacking(double elevation_deg, double from_m,
                                          const std::vector<double>& to_m,
                                          const std::vector<std::uint32_t>& conditions);
  // Computes a task. Lines that do not exist leave it without values.
  static void compute(const Task& task, const Lines& lines);

  // Completes lines of sight, of which all but what is reflected is known. Nothing: not between
  // elevations from which there are lines.
  [[nodiscard]] std::optional<ReflectedSpread> complete(double elevation_deg, double from_m,
                                                        double to_m, std::uint32_t condition,
                                                        SightLine& from, SightLine& to) const;

 private:
  using Key = std::tuple<double, double, std::uint32_t, std::size_t>;  // from, to, condition, node
  std::map<Key, std::optional<Node>> known_;
};

}  // namespace irsig
