#include "core/clutter/lag_sums.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/base/check.h"

namespace irsig {
namespace {

using Complex = std::complex<double>;

// A discrete Fourier transform of a power of two, in place. [cooley1965]
class Transform {
 public:
  explicit Transform(std::size_t size) : size_(size), root_(size / 2) {
    for (std::size_t k = 0; k < root_.size(); ++k)
      root_[k] = std::polar(
          1.0, -2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(size));
  }

  void run(Complex* value, bool back) const {
    for (std::size_t i = 1, j = 0; i < size_; ++i) {
      std::size_t bit = size_ >> 1;
      for (; (j & bit) != 0; bit >>= 1) j ^= bit;
      j ^= bit;
      if (i < j) std::swap(value[i], value[j]);
    }
    for (std::size_t length = 2; length <= size_; length *= 2) {
      const std::size_t half = length / 2, stride = size_ / length;
      for (std::size_t first = 0; first < size_; first += length)
        for (std::size_t k = 0; k < half; ++k) {
          const Complex root = back ? std::conj(root_[k * stride]) : root_[k * stride];
          Complex &a = value[first + k], &b = value[first + k + half];
          // Products by hand: those of std::complex test for infinities.
          const Complex turned(b.real() * root.real() - b.imag() * root.imag(),
                               b.real() * root.imag() + b.imag() * root.real());
          b = a - turned;
          a += turned;
        }
    }
  }

 private:
  std::size_t size_;
  std::vector<Complex> root_;
};

// A grid of complex numbers with room for lags of half of the values' size.
class Padded {
 public:
  Padded(std::size_t columns, std::size_t rows)
      : columns_(std::bit_ceil(columns + columns / 2)),
        rows_(std::bit_ceil(rows + rows / 2)),
        value_(columns_ * rows_) {}

  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  Complex& at(std::size_t column, std::size_t row) { return value_[row * columns_ + column]; }
  // Returns the value at the same frequency with the other sign.
  [[nodiscard]] const Complex& opposite(std::size_t column, std::size_t row) const {
    return value_[(rows_ - row) % rows_ * columns_ + (columns_ - column) % columns_];
  }

  void transform(bool back) {
    const Transform along(columns_), across(rows_);
    for (std::size_t r = 0; r < rows_; ++r) {
      const auto row = value_.begin() + static_cast<std::ptrdiff_t>(r * columns_);
      // The padding's transform is 0.
      if (std::any_of(row, row + static_cast<std::ptrdiff_t>(columns_),
                      [](const Complex& v) { return v != Complex(); }))
        along.run(&*row, back);
    }
    // A cache line of columns at a time.
    constexpr std::size_t kColumns = 4;
    std::vector<Complex> column(kColumns * rows_);
    for (std::size_t first = 0; first < columns_; first += kColumns) {
      const std::size_t columns = std::min(kColumns, columns_ - first);
      for (std::size_t r = 0; r < rows_; ++r)
        for (std::size_t c = 0; c < columns; ++c) column[c * rows_ + r] = at(first + c, r);
      for (std::size_t c = 0; c < columns; ++c) across.run(&column[c * rows_], back);
      for (std::size_t r = 0; r < rows_; ++r)
        for (std::size_t c = 0; c < columns; ++c) at(first + c, r) = column[c * rows_ + r];
    }
    if (!back) return;
    for (Complex& v : value_) v /= static_cast<double>(value_.size());
  }

  // The spectra of two real grids of which one was put into the real parts, the other into the
  // imaginary ones, are replaced by a function of both.
  template <typename Function>
  void combine(const Function& function) {
    std::vector<Complex> out(value_.size());
    for (std::size_t r = 0; r < rows_; ++r)
      for (std::size_t c = 0; c < columns_; ++c) {
        const Complex here = at(c, r), there = std::conj(opposite(c, r));
        out[r * columns_ + c] = function(0.5 * (here + there), Complex(0, -0.5) * (here - there));
      }
    value_ = std::move(out);
  }

 private:
  std::size_t columns_, rows_;
  std::vector<Complex> value_;
};

}  // namespace

std::pair<LagSums, LagSums> LagSums::of(const PixelGrid& a, const PixelGrid& b) {
  IRSIG_CHECK(a.columns == b.columns);
  IRSIG_CHECK(a.rows == b.rows);
  Padded padded(a.columns, a.rows);
  for (std::size_t r = 0; r < a.rows; ++r)
    for (std::size_t c = 0; c < a.columns; ++c)
      padded.at(c, r) = {a.value[r * a.columns + c], b.value[r * a.columns + c]};
  padded.transform(false);
  padded.combine([](Complex x, Complex y) { return Complex(std::norm(x), std::norm(y)); });
  padded.transform(true);
  std::pair<LagSums, LagSums> out;
  for (LagSums* sums : {&out.first, &out.second}) {
    sums->columns_ = a.columns;
    sums->rows_ = a.rows;
    sums->padded_columns_ = padded.columns();
    sums->padded_rows_ = padded.rows();
  }
  for (std::size_t r = 0; r < padded.rows(); ++r)
    for (std::size_t c = 0; c < padded.columns(); ++c) {
      out.first.sum_.push_back(padded.at(c, r).real());
      out.second.sum_.push_back(padded.at(c, r).imag());
    }
  return out;
}

double LagSums::covariance(std::int64_t dx, std::int64_t dy) const {
  const auto place = [](std::int64_t lag, std::size_t size) {
    return static_cast<std::size_t>(lag < 0 ? lag + static_cast<std::int64_t>(size) : lag);
  };
  const double pairs = (static_cast<double>(columns_) - static_cast<double>(std::abs(dx))) *
                       (static_cast<double>(rows_) - static_cast<double>(std::abs(dy)));
  return sum_[place(dy, padded_rows_) * padded_columns_ + place(dx, padded_columns_)] / pairs;
}

bool LagSums::Ellipse::contains(std::int64_t dx, std::int64_t dy) const {
  const double u = static_cast<double>(dx) / x, v = static_cast<double>(dy) / y;
  return u * u + v * v < 1;
}

LagSums::Ellipse LagSums::first_zeros() const {
  // Transforms leave about 1e-16 of the variance where the covariance is 0.
  const double zero = 1e-9 * covariance(0, 0);
  const auto first = [&](std::size_t size, const auto& at) {
    const auto last = static_cast<std::int64_t>(size / 2);
    std::int64_t lag = 1;
    while (lag < last && at(lag) > zero) ++lag;
    return static_cast<double>(lag);
  };
  return {first(columns_, [&](std::int64_t lag) { return covariance(lag, 0); }),
          first(rows_, [&](std::int64_t lag) { return covariance(0, lag); })};
}

LagSums::Integral LagSums::integral(const Ellipse& inside) const {
  const auto x = static_cast<std::int64_t>(inside.x), y = static_cast<std::int64_t>(inside.y);
  Integral out;
  for (std::int64_t dy = -y; dy <= y; ++dy)
    for (std::int64_t dx = -x; dx <= x; ++dx)
      if (inside.contains(dx, dy)) {
        out.sum += covariance(dx, dy);
        ++out.lags;
      }
  return out;
}

double LagSums::stderr_of_mean() const {
  const double values = static_cast<double>(columns_) * static_cast<double>(rows_);
  // The area is at least that of independent pixels: an integral that is cut off may be too small.
  return std::sqrt(std::max(integral(first_zeros()).sum, covariance(0, 0)) / values);
}

PixelGrid sums_around(const PixelGrid& grid, const LagSums::Ellipse& inside) {
  Padded padded(grid.columns, grid.rows);
  for (std::size_t r = 0; r < grid.rows; ++r)
    for (std::size_t c = 0; c < grid.columns; ++c)
      padded.at(c, r) = grid.value[r * grid.columns + c];
  const auto x = static_cast<std::int64_t>(inside.x), y = static_cast<std::int64_t>(inside.y);
  const auto place = [](std::int64_t lag, std::size_t size) {
    return static_cast<std::size_t>(lag < 0 ? lag + static_cast<std::int64_t>(size) : lag);
  };
  for (std::int64_t dy = -y; dy <= y; ++dy)
    for (std::int64_t dx = -x; dx <= x; ++dx)
      if (inside.contains(dx, dy))
        padded.at(place(dx, padded.columns()), place(dy, padded.rows())) += Complex(0, 1);
  padded.transform(false);
  padded.combine([](Complex f, Complex mask) { return f * mask; });
  padded.transform(true);
  PixelGrid out{grid.columns, grid.rows, {}};
  for (std::size_t r = 0; r < grid.rows; ++r)
    for (std::size_t c = 0; c < grid.columns; ++c) out.value.push_back(padded.at(c, r).real());
  return out;
}

}  // namespace irsig
