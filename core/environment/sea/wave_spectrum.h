#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace irsig {

// Returns the spectrum S(k) of the elevation of a fully developed sea, all directions together: the
// variance of the elevation is the integral of S over k, that of the slopes the integral of k^2 S.
// [m^3]
//   k_rad_m  wave number, > 0
//   wind_speed_m_s  at 10 m, > 0
// [elfouhaily1997, eqs. 30 to 41 and 49], with the drag coefficient (0.8 + 0.065 wind) / 1000. Its
// significant height at 10 m/s is 2.6 m, that of Pierson and Moskowitz 2.1 to 2.5 m.
[[nodiscard]] double wave_spectrum_m3(double k_rad_m, double wind_speed_m_s);

// Two orthogonal slopes of an isotropic, Gaussian sea at two places: their correlations and their
// averages over rectangles. x lies along one side of the rectangles, y along the other.
class SlopeCorrelation {
 public:
  explicit SlopeCorrelation(double wind_speed_m_s);

  struct Pair {
    double x, y;  // correlation of the slopes along x, and of those along y; 1 at lag 0
  };
  // Returns the correlations of both slopes at a lag. The correlation of the slope along x with
  // that along y, which is 0 along both axes and at most 0.3 between them, is left out.
  [[nodiscard]] Pair at(double lag_x_m, double lag_y_m) const;

  // Returns the variance of the mean of one slope over a rectangle, over the variance of the slope.
  [[nodiscard]] Pair variance_of_mean(double side_x_m, double side_y_m) const;

 private:
  static constexpr std::size_t kLags = 161;  // 0.1 mm to 10 km, in equal ratios
  std::vector<double> k_, share_;          // wave numbers, and their shares of the slopes' variance
  std::array<double, kLags> m0_{}, m2_{};  // integrals of the shares x J0(k r), J2(k r)
};

}  // namespace irsig
