#pragma once

#include <string>
#include <vector>

namespace irsig {

// A quantity over the hemisphere of views: value[zenith][azimuth], row by row.
struct HemisphereValues {
  std::vector<double> zenith_deg, azimuth_deg;  // increasing
  std::vector<double> value;
};

// Seen from above: zenith outwards, azimuth 0 up, clockwise. A cell of one colour around each view,
// with a colour bar from the smallest to the largest value; a cross where the source stands. A
// complete SVG document.
[[nodiscard]] std::string plot_hemisphere(const std::string& title, const std::string& quantity,
                                          const HemisphereValues& values, double source_zenith_deg);

}  // namespace irsig
