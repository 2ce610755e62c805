// The profile of exhaust gas across a plume, from a section that is uniform.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/plume/generate_plume.h"

namespace irsig {
namespace {

// Share of the centre at which the profile ends: as much of the exhaust is left out where it is
// Gaussian, less where it is flat.
constexpr double kCut = 1e-3;
// Steeper than any voxel: a top hat.
constexpr double kSteepest = 100;

// Integrals over y dy of q and q y^2, q = rho f / rho_a with f = f0 exp(-y^m), up to the cut;
// their square and quotient is what flux and second moment fix: 2 in a uniform section of q = 1.
struct Moments {
  double zeroth = 0, second = 0;
  [[nodiscard]] double flux() const { return 2 * zeroth * zeroth / second; }
};

// exp(-y^m) at the steps from 0 to the cut.
constexpr int kSteps = 400;
struct Shape {
  double end = 0;
  std::array<double, kSteps + 1> value{};
};
Shape shape_of(double m) {
  Shape out;
  out.end = std::pow(-std::log(kCut), 1 / m);
  for (int i = 0; i <= kSteps; ++i) {
    const double y = out.end * i / kSteps;
    out.value[static_cast<std::size_t>(i)] = std::exp(-std::pow(y, m));
  }
  return out;
}

Moments moments(double f0, const Shape& shape, double hotter) {  // hotter: (T_0 - T_a) / T_a
  const double end = shape.end;
  Moments out;
  for (int i = 0; i <= kSteps; ++i) {
    const double y = end * i / kSteps, f = f0 * shape.value[static_cast<std::size_t>(i)];
    const double simpson = (i == 0 || i == kSteps ? 1 : i % 2 == 1 ? 4 : 2) * end / kSteps / 3;
    const double q = f / (1 + f * hotter);
    out.zeroth += simpson * q * y;
    out.second += simpson * q * y * y * y;
  }
  return out;
}

}  // namespace

double PlumeProfile::at(double radius_m) const {
  return radius_m > cut_m ? 0 : f0 * std::exp(-std::pow(radius_m / b_m, m));
}

PlumeProfile plume_profile(const PlumeStation& station, const PlumeExit& exit,
                           double air_temperature_k) {
  const double hotter = (exit.temperature_k - air_temperature_k) / air_temperature_k;
  // Twice the exhaust's part of the section's density, over the air's.
  const double wanted = 2 * station.share / (1 + station.share * hotter);
  const auto flux = [&](double f0, const Shape& shape) {
    return moments(f0, shape, hotter).flux();
  };
  static const Shape gaussian = shape_of(2);
  PlumeProfile out;
  double low = 0, high = 1;
  if (flux(1, gaussian) >= wanted) {
    for (int i = 0; i < 50; ++i) {
      out.f0 = 0.5 * (low + high);
      (flux(out.f0, gaussian) < wanted ? low : high) = out.f0;
    }
  } else {
    low = 2, high = kSteepest;
    for (int i = 0; i < 50; ++i) {
      out.m = 0.5 * (low + high);
      (flux(1, shape_of(out.m)) < wanted ? low : high) = out.m;
    }
  }
  const Moments at = moments(out.f0, shape_of(out.m), hotter);
  // The second moment of the uniform section is R^2 / 2.
  out.b_m = station.radius_m * std::sqrt(0.5 * at.zeroth / at.second);
  out.cut_m = out.b_m * std::pow(-std::log(kCut), 1 / out.m);
  return out;
}

}  // namespace irsig
