#include "core/environment/fit/linear_basis_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace irsig {
namespace {

// Solves a symmetric tridiagonal system, periodic if the last corner is given: rows of a dense
// inverse, for systems of some ten unknowns with hundreds of right-hand sides.
std::vector<std::vector<double>> inverse(std::vector<std::vector<double>> m) {
  const std::size_t n = m.size();
  std::vector<std::vector<double>> out(n, std::vector<double>(n, 0.0));
  for (std::size_t i = 0; i < n; ++i) out[i][i] = 1;
  for (std::size_t i = 0; i < n; ++i) {  // diagonally dominant: no pivoting
    const double pivot = m[i][i];
    for (std::size_t k = 0; k < n; ++k) {
      m[i][k] /= pivot;
      out[i][k] /= pivot;
    }
    for (std::size_t j = 0; j < n; ++j) {
      const double f = m[j][i];
      if (j == i || f == 0) continue;
      for (std::size_t k = 0; k < n; ++k) {
        m[j][k] -= f * m[i][k];
        out[j][k] -= f * out[i][k];
      }
    }
  }
  return out;
}

// Returns the inverse of means over hats of linear functions: rings.
std::vector<std::vector<double>> inverse_up(const std::vector<double>& sine) {
  const std::size_t rings = sine.size();
  std::vector<std::vector<double>> up(rings, std::vector<double>(rings, 0.0));
  for (std::size_t r = 0; r < rings; ++r) {
    const double below = r > 0 ? sine[r] - sine[r - 1] : 0;
    const double above = r + 1 < rings ? sine[r + 1] - sine[r] : 0;
    up[r][r] = 2.0 / 3;
    if (r > 0) up[r][r - 1] = below / (below + above) / 3;
    if (r + 1 < rings) up[r][r + 1] = above / (below + above) / 3;
  }
  return inverse(std::move(up));
}

// And azimuths.
std::vector<std::vector<double>> inverse_around(std::uint32_t azimuths) {
  std::vector<std::vector<double>> around(azimuths, std::vector<double>(azimuths, 0.0));
  for (std::uint32_t a = 0; a < azimuths; ++a) {
    around[a][a] += 2.0 / 3;
    around[a][(a + 1) % azimuths] += 1.0 / 6;
    around[a][(a + azimuths - 1) % azimuths] += 1.0 / 6;
  }
  return inverse(std::move(around));
}

// A node's value is an integral of what is fitted times a function that is linear between the
// nodes and 1 in the integral: that of its positive part. value: at the nodes.
double positive_part(const std::vector<double>& step, const std::vector<double>& value) {
  double sum = 0;
  for (std::size_t k = 0; k < step.size(); ++k) {
    const double a = value[k], b = value[(k + 1) % value.size()];
    const double high = std::max(a, b), low = std::min(a, b);
    if (high <= 0) continue;
    sum += 0.5 * step[k] * (low >= 0 ? high + low : high * high / (high - low));
  }
  return sum;
}

}  // namespace

double fit_overshoot(const std::vector<double>& sine, std::uint32_t azimuths) {
  const std::vector<std::vector<double>> up = inverse_up(sine), around = inverse_around(azimuths);
  std::vector<double> step, hat(sine.size(), 0.0);
  for (std::size_t r = 0; r + 1 < sine.size(); ++r) {
    step.push_back(sine[r + 1] - sine[r]);
    hat[r] += 0.5 * step[r];
    hat[r + 1] += 0.5 * step[r];
  }
  double largest_up = 1;
  for (const std::vector<double>& row : up) {
    std::vector<double> value = row;
    for (std::size_t k = 0; k < hat.size(); ++k) value[k] /= hat[k];
    largest_up = std::max(largest_up, positive_part(step, value));
  }
  const double largest_around =
      std::max(1.0, positive_part(std::vector<double>(azimuths, 1.0), around[0]));
  // Both positive or both negative.
  return largest_up * largest_around + (largest_up - 1) * (largest_around - 1);
}

void fit_to_hats(std::vector<AirSpectrum>& node, const std::vector<double>& sine,
                 std::uint32_t azimuths) {
  const std::size_t rings = sine.size();
  const std::vector<std::vector<double>> up = inverse_up(sine), around = inverse_around(azimuths);
  std::vector<AirSpectrum> half(node.size(), AirSpectrum(kAirBandCount, 0.0)), whole = half;
  const auto add = [](AirSpectrum& to, double f, const AirSpectrum& from) {
    if (std::abs(f) < 1e-9) return;
    for (std::size_t b = 0; b < kAirBandCount; ++b) to[b] += f * from[b];
  };
  for (std::size_t r = 0; r < rings; ++r) {
    for (std::uint32_t a = 0; a < azimuths; ++a) {
      for (std::uint32_t k = 0; k < azimuths; ++k) {
        add(half[r * azimuths + a], around[a][k], node[r * azimuths + k]);
      }
    }
  }
  for (std::size_t r = 0; r < rings; ++r) {
    for (std::size_t k = 0; k < rings; ++k) {
      for (std::uint32_t a = 0; a < azimuths; ++a) {
        add(whole[r * azimuths + a], up[r][k], half[k * azimuths + a]);
      }
    }
  }
  node = std::move(whole);
}

void keep_positive(std::vector<AirSpectrum>& node, const std::vector<AirSpectrum>& mean) {
  constexpr double kLeast = 0.25;
  AirSpectrum part(kAirBandCount, 0.0);  // of the means
  for (std::size_t n = 0; n < node.size(); ++n)
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      const double lacks = kLeast * mean[n][b] - node[n][b];
      if (lacks > 0) part[b] = std::max(part[b], lacks / (mean[n][b] - node[n][b]));
    }
  for (std::size_t n = 0; n < node.size(); ++n)
    for (std::size_t b = 0; b < kAirBandCount; ++b)
      node[n][b] += part[b] * (mean[n][b] - node[n][b]);
}

}  // namespace irsig
