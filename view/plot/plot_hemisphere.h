#pragma once

#include <string>
#include <vector>

namespace irsig {

// A quantity over the hemisphere of views: value[zenith][azimuth], row by row.
struct HemisphereValues {
  std::vector<double> zenith_deg, azimuth_deg;  // increasing
  std::vector<double> value;
};

// Plots values over a hemisphere seen from above: zenith angle outwards, azimuth 0 up, clockwise.
// Each view has a cell of one colour; a colour bar covers the smallest to the largest value. A
// cross marks the source. Returns a complete SVG document.
[[nodiscard]] std::string plot_hemisphere(const std::string& title, const std::string& quantity,
                                          const HemisphereValues& values, double source_zenith_deg);

}  // namespace irsig
