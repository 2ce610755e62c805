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

// How far a reflected radiance of 1 may be off in each bin when it is moved: its directions' way
// from one range to the other, against that of the mean. [side][bin], sky and sea
using ReflectedSpread = std::array<SightLine::Values, 2>;
[[nodiscard]] ReflectedSpread spread_of(const SightLine& from, const SightLine& to);

// What arrives of sky and sea that a target reflects, from a stored range and from another one, for
// any elevation of the sensor, from lines of sight at a few: most of the time of a line goes into
// the light around the target, and how much of it arrives depends on the line's elevation and range
// alone, not on its azimuth, and over the transmittance smoothly. Cubic between elevations; by how
// much straight lines between them would differ is added to the spread, and more than the error is:
// tests/unit/arriving_reflected_test.cpp.
class ArrivingTable {
 public:
  // Whole lines of sight for some conditions from one elevation and range.
  using Lines = std::function<absl::StatusOr<std::vector<SightLine>>(
      double elevation_deg, double range_m, const std::vector<std::uint32_t>& conditions)>;

  // Of both sides, at one elevation: each over the transmittance there.
  struct Node {
    using Values = std::vector<float>;  // [bin]; rounded, 6e-8 of them
    struct Side {
      Values from_bin, from_band, to_bin, to_band, spread;  // spread: over that of the other range
    };
    std::array<Side, 2> side;
  };
  // Of all elevations, for so many conditions and ranges and stored wavelengths.
  [[nodiscard]] static double bytes(std::size_t conditions, std::size_t ranges, std::size_t bins);
  // One elevation from one stored range: to be made by compute(), each by one thread.
  struct Task {
    std::size_t node;
    double from_m;
    std::vector<double> to_m;
    std::vector<std::uint32_t> condition;
    std::vector<std::optional<Node>*> out;  // [condition x range]
  };
  // What lines from this elevation lack, and nobody has been told of. Then all of it is to be
  // computed before at() is asked.
  [[nodiscard]] std::vector<Task> lacking(double elevation_deg, double from_m,
                                          const std::vector<double>& to_m,
                                          const std::vector<std::uint32_t>& conditions);
  // There need be no such line: then nothing is known of it.
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
