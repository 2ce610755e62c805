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

// Bound on the relative error of a unit reflected radiance in each bin when it is moved: the
// transmittance of its directions between both ranges, relative to the mean. [side][bin], sky and
// sea
using ReflectedSpread = std::array<SightLine::Values, 2>;
[[nodiscard]] ReflectedSpread spread_of(const SightLine& from, const SightLine& to);

// Transmitted light of sky and sea that a target reflects, from a stored range and from another
// one, for any elevation of the sensor. It is interpolated from lines of sight at a few elevations,
// because most of the time of a line is spent on the light around the target. The arriving part
// depends on the line's elevation and range alone, not on its azimuth, and varies smoothly over the
// transmittance. The interpolation between elevations is cubic. The difference to linear
// interpolation is added to the spread, and exceeds the error:
// tests/unit/arriving_reflected_test.cpp.
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
  // Returns the size of a table with all elevations, for this number of conditions, ranges and
  // stored wavelengths. [bytes]
  [[nodiscard]] static double bytes(std::size_t conditions, std::size_t ranges, std::size_t bins);
  // One elevation from one stored range: to be made by compute(), each by one thread.
  struct Task {
    std::size_t node;
    double from_m;
    std::vector<double> to_m;
    std::vector<std::uint32_t> condition;
    std::vector<std::optional<Node>*> out;  // [condition x range]
  };
  // Returns the tasks that lines from this elevation need and that were not returned before. All of
  // them must be computed before at() is called.
  [[nodiscard]] std::vector<Task> lacking(double elevation_deg, double from_m,
                                          const std::vector<double>& to_m,
                                          const std::vector<std::uint32_t>& conditions);
  // Computes a task. Lines that do not exist leave it without values.
  static void compute(const Task& task, const Lines& lines);

  // Completes lines of sight in which only the reflected light is missing. nullopt: the elevation
  // is not between those of known lines.
  [[nodiscard]] std::optional<ReflectedSpread> complete(double elevation_deg, double from_m,
                                                        double to_m, std::uint32_t condition,
                                                        SightLine& from, SightLine& to) const;

 private:
  using Key = std::tuple<double, double, std::uint32_t, std::size_t>;  // from, to, condition, node
  std::map<Key, std::optional<Node>> known_;
};

}  // namespace irsig
