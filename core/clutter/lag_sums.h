#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace irsig {

// Values on a grid, row by row.
struct PixelGrid {
  std::size_t columns = 0, rows = 0;
  std::vector<double> value;
};

// Autocovariance of values whose mean is 0, at lags of at most half of the grid.
class LagSums {
 public:
  // Computes those of two grids of one size, by one Fourier transform there and back.
  static std::pair<LagSums, LagSums> of(const PixelGrid& a, const PixelGrid& b);

  // Returns the mean of products over the pairs of pixels that are (dx, dy) apart. |dx| <= columns
  // / 2, |dy| <= rows / 2.
  [[nodiscard]] double covariance(std::int64_t dx, std::int64_t dy) const;

  // First lags along rows and columns at which the covariance is not above 0; at least 1, at most
  // half of the grid.
  struct Ellipse {
    double x = 1, y = 1;
    [[nodiscard]] bool contains(std::int64_t dx, std::int64_t dy) const;
  };
  [[nodiscard]] Ellipse first_zeros() const;

  // Sum of the covariance over the lags inside, and how many lags these are.
  struct Integral {
    double sum = 0;
    std::size_t lags = 0;
  };
  [[nodiscard]] Integral integral(const Ellipse& inside) const;

  // Returns the standard error of the mean of the values, which counts correlated ones:
  // sqrt(integral of the covariance / values).
  [[nodiscard]] double stderr_of_mean() const;

 private:
  std::size_t columns_ = 1, rows_ = 1, padded_columns_ = 1, padded_rows_ = 1;
  std::vector<double> sum_;  // [padded row][padded column], lags modulo the size
};

// Sums of the values over the lags inside an ellipse around each pixel; 0 beyond the grid.
[[nodiscard]] PixelGrid sums_around(const PixelGrid& grid, const LagSums::Ellipse& inside);

}  // namespace irsig
