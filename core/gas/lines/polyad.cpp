#include "core/gas/lines/polyad.h"

#include <algorithm>
#include <cmath>

namespace irsig {
namespace {

// Harmonic and anharmonic constants without the Fermi resonance [cm-1].    [gordon1966]
constexpr double kOmega1 = 1354.07, kOmega2 = 672.95;
constexpr double kX11 = -3.10, kX12 = -5.37, kX13 = -19.27, kX22 = 1.59, kX23 = -12.51,
                 kX33 = -12.50, kXll = -1.01;
// The resonance that puts (10001), (10002) at 1388.18 and 1285.41 cm-1 and (10011), (10012) at
// 3714.78 and 3612.84 cm-1.                                                [rothman1981]
constexpr double kFermi = 51.23, kFermiV3 = -0.27;
// Rotation: B = kB - 0.0012 v1 + 0.00072 v2 - 0.003076 v3, D, and the splitting of pairs with l
// = 1.
constexpr double kPolyadB = 0.390219, kBv1 = -0.0012, kBv2 = 0.00072, kBv3 = -0.003076;
constexpr double kPolyadD = 1.3334e-7, kDv3 = -0.003e-7, kPair = 6.16e-4;

double vibration_cm1(const Co2Isotopologue& of, int v1, int v2, int l, int v3) {
  const double a = v1 + 0.5, b = v2 + 1, c = v3 + 0.5;
  // The stretch's constants scale with its frequency, as those of any oscillator.
  const double ratio = of.fundamental_cm1 / 2349.143;
  const double x13 = kX13 * ratio, x23 = kX23 * ratio, x33 = kX33 * ratio * ratio;
  const double omega3 = of.fundamental_cm1 - 0.5 * x13 - x23 - 2 * x33;
  return (kOmega1 + of.omega1_shift_cm1) * a + (kOmega2 + of.omega2_shift_cm1) * b + omega3 * c +
         kX11 * a * a + kX12 * a * b + x13 * a * c + kX22 * b * b + x23 * b * c + x33 * c * c +
         kXll * l * l;
}

// Eigenvalues and vectors of a symmetric tridiagonal matrix by Jacobi's rotations, in order.
void diagonalise(std::vector<std::vector<double>>& m, std::vector<std::vector<double>>& vectors) {
  const std::size_t n = m.size();
  for (int sweep = 0; sweep < 60; ++sweep) {
    double off = 0;
    for (std::size_t p = 0; p < n; ++p) {
      for (std::size_t q = p + 1; q < n; ++q) off = std::max(off, std::abs(m[p][q]));
    }
    if (off < 1e-9) break;
    for (std::size_t p = 0; p < n; ++p) {
      for (std::size_t q = p + 1; q < n; ++q) {
        if (std::abs(m[p][q]) < 1e-12) continue;
        const double theta = 0.5 * std::atan2(2 * m[p][q], m[q][q] - m[p][p]);
        const double c = std::cos(theta), s = std::sin(theta);
        for (std::size_t k = 0; k < n; ++k) {
          const double kp = m[k][p], kq = m[k][q];
          m[k][p] = c * kp - s * kq;
          m[k][q] = s * kp + c * kq;
        }
        for (std::size_t k = 0; k < n; ++k) {
          const double pk = m[p][k], qk = m[q][k];
          m[p][k] = c * pk - s * qk;
          m[q][k] = s * pk + c * qk;
        }
        for (std::size_t k = 0; k < n; ++k) {
          const double kp = vectors[k][p], kq = vectors[k][q];
          vectors[k][p] = c * kp - s * kq;
          vectors[k][q] = s * kp + c * kq;
        }
      }
    }
  }
}

}  // namespace

Polyad co2_polyad(const Co2Isotopologue& of, int quanta, int l, int v3, int j, bool upper) {
  const int states = (quanta - l) / 2 + 1;
  const double x = j * (j + 1.0) - l * l;
  const auto n = static_cast<std::size_t>(states);
  std::vector<std::vector<double>> m(n, std::vector<double>(n, 0)), vectors = m;
  for (int v1 = 0; v1 < states; ++v1) {
    const auto i = static_cast<std::size_t>(v1);
    const int v2 = quanta - 2 * v1;
    const double pair = l == 1 ? (upper ? 0.5 : -0.5) * kPair * (v2 + 1) / 2 : 0;
    const double b = (kPolyadB + kBv1 * v1 + kBv2 * v2 + kBv3 * v3 + pair) * of.rotation;
    m[i][i] = vibration_cm1(of, v1, v2, l, v3) - vibration_cm1(of, 0, 0, 0, 0) + b * x -
              (kPolyadD + kDv3 * v3) * of.rotation * of.rotation * x * x;
    if (v1 > 0) {
      m[i][i - 1] = m[i - 1][i] =
          0.5 * (kFermi + kFermiV3 * v3) * std::sqrt(v1 * ((v2 + 2.0) * (v2 + 2.0) - l * l));
    }
    vectors[i][i] = 1;
  }
  diagonalise(m, vectors);
  std::vector<std::size_t> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = i;
  std::ranges::sort(order, {}, [&](std::size_t i) { return m[i][i]; });
  Polyad out;
  for (const std::size_t i : order) {
    out.energy_cm1.push_back(m[i][i]);
    std::vector<double>& amplitude = out.amplitude.emplace_back();
    for (std::size_t k = 0; k < n; ++k) amplitude.push_back(vectors[k][i]);
  }
  return out;
}

}  // namespace irsig
