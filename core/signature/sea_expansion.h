#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/environment/sea/sea_texture.h"
#include "core/geo/frames.h"

namespace irsig {

// A rough sea seen along one line: x lies towards the sensor, y to the right of it.
struct SeaSight {
  Vec<Body> to_sensor, x, y;
  double sine;                 // of the sensor's elevation; > 0
  double wind_m_s, deviation;  // of one slope

  SeaSight(Vec<Body> towards, double wind);
  // Returns the upward normal of a facet, divided by its upward component; slopes in standard
  // deviations.
  [[nodiscard]] Vec<Body> steep_normal(double slope_x, double slope_y) const;
  // Averages over a square of the picture, which is longer on the sea.
  [[nodiscard]] SlopeAverages averages(const SlopeCorrelation& sea, double side_m) const;
};

// The radiance of a rough sea as a sum of terms of its slopes. What a pixel shows is a mean over
// the facets in it by their projected areas w, so that facets count with (L - mean) w / mean w.
class SlopeExpansion {
 public:
  using Numbers = std::vector<double>;  // radiances, as many for each facet
  // Light of the facets of one slope: its mean over the sea, the slopes in standard deviations, and
  // their variance by the size of the sun's disk.
  struct Glint {
    Numbers mean;
    double x, y, disk_variance;
  };
  // A facet without the glint: how often it occurs, and what it adds to the mean.
  struct Facet {
    double frequency;
    Numbers excess;
  };

  //   of_facet  radiance of a facet by its upward unit normal
  SlopeExpansion(const SeaSight& sight, const std::function<Numbers(Vec<Body> normal)>& of_facet,
                 std::optional<Glint> glint);

  [[nodiscard]] const Numbers& mean() const { return mean_; }
  [[nodiscard]] const std::vector<Facet>& facets() const { return facet_; }
  [[nodiscard]] const std::optional<Glint>& glint() const { return glint_; }
  // Coefficients of slope_terms() with the glint's part in them, and the glint itself: sources that
  // vary independently.
  [[nodiscard]] std::vector<Numbers> sources() const;
  // Returns the variance of each source's mean over a rectangle, in squares of its numbers. The
  // last is the part of the glint that no term holds. [source]
  [[nodiscard]] std::vector<double> variances(const SlopeAverages& averages) const;

 private:
  Numbers mean_;
  std::vector<Numbers> term_;
  std::vector<Facet> facet_;
  std::optional<Glint> glint_;
};

}  // namespace irsig
