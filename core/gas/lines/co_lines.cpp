#include "core/gas/lines/co_lines.h"

#include <cmath>

namespace irsig {
namespace {

// Equilibrium constants [cm-1] of 12C16O; those of others scale with the reduced mass.
constexpr double kOmega = 2169.8136, kOmegaX = 13.28831, kOmegaY = 0.010511;
constexpr double kB = 1.931281, kAlpha = 0.0175044, kGammaB = 5.4e-7, kD = 6.1215e-6,
                 kDv = -1.15e-9;
constexpr double kStrength = 9.9e-18, kReferenceK = 296;

struct Isotopologue {
  double abundance, mass_ratio;  // square root of reduced masses, 12C16O over this
};
constexpr Isotopologue kIsotopologues[] = {{0.98654, 1}, {0.01108, 0.977767}, {0.00198, 0.975908}};

struct Molecule {
  double r;
  [[nodiscard]] double vibration(int v) const {
    const double x = v + 0.5;
    return r * kOmega * x - r * r * kOmegaX * x * x + r * r * r * kOmegaY * x * x * x;
  }
  [[nodiscard]] double level(int v, int j) const {
    const double x = v + 0.5, jj = j * (j + 1.0);
    const double b = r * r * (kB - r * kAlpha * x + r * r * kGammaB * x * x);
    const double d = std::pow(r, 4) * (kD + kDv * x);
    return vibration(v) - vibration(0) + b * jj - d * jj * jj;
  }
};

}  // namespace

std::vector<SpectralLine> co_lines(double temperature_k, double weakest) {
  std::vector<SpectralLine> out;
  for (const Isotopologue& of : kIsotopologues) {
    const Molecule molecule{of.mass_ratio};
    const auto state_sum = [&](double t) {
      double sum = 0;
      for (int v = 0; v < 14; ++v) {
        for (int j = 0; j < 150; ++j)
          sum += (2 * j + 1) * std::exp(-kC2CmK * molecule.level(v, j) / t);
      }
      return sum;
    };
    const double fundamental = molecule.vibration(1) - molecule.vibration(0);
    // So that the fundamental has its strength at the reference temperature, where v = 0 alone is
    // filled.
    const double scale =
        kStrength * of.abundance / (1 - std::exp(-kC2CmK * fundamental / kReferenceK));
    const double sum = state_sum(temperature_k);
    for (int v = 0; v < 10; ++v) {
      for (int j = 0; j < 120; ++j) {
        for (const int m : {j + 1, -j}) {
          if (m == 0) continue;
          const double low = molecule.level(v, j),
                       nu = molecule.level(v + 1, m > 0 ? j + 1 : j - 1) - low;
          const double herman_wallis = std::pow(1 + 1.2e-4 * m, 2);
          const double s = scale * (v + 1) * std::abs(m) / sum * nu / fundamental *
                           std::exp(-kC2CmK * low / temperature_k) * herman_wallis *
                           (1 - std::exp(-kC2CmK * nu / temperature_k));
          if (s < weakest) continue;
          out.push_back({nu, s, 0.045 + 0.035 * std::exp(-(std::abs(m) - 1) / 9.0)});
        }
      }
    }
  }
  return out;
}

}  // namespace irsig
