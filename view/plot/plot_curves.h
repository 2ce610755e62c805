#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "view/draw/axis.h"

namespace irsig {

struct Curve {
  std::string name;          // in the legend; curves of the same place have the same colour
  std::vector<double> x, y;  // as long as each other
  std::vector<double> low{}, high{};   // of a shaded band around it; empty: none
  std::optional<std::size_t> place{};  // default: its own in the panel
  bool marks = false;                  // a dot at each value
  // Limits of a second, lighter band without edges; empty: none. Points with a limit that is not
  // finite have no band.
  std::vector<double> far_low{}, far_high{};
};

// One pair of axes. Without a range, the y axis covers the curves and their bands; without an x
// axis, the x axis covers them.
struct CurvePanel {
  std::string title, x_label, y_label;
  std::vector<Curve> curve;
  double y_low = 0, y_high = 0;
  std::optional<Axis> x{};
};

// Panels side by side, `columns` in a row, as a complete SVG document. Values that are not finite
// interrupt their curve.
[[nodiscard]] std::string plot_curves(std::string_view title, std::string_view subtitle,
                                      const std::vector<CurvePanel>& panels, std::size_t columns);

}  // namespace irsig
