#include "core/materials/thrown_light.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "core/materials/material.h"

namespace irsig {
namespace {

constexpr int kThrown = 4096;

// The n-th point of a lattice of rank 1 in three dimensions (roots of x^4 = x + 1), in (0, 1).
double lattice(int n, double step) {
  const double x = 0.5 + step * n;
  return std::clamp(x - std::floor(x), 1e-9, 1 - 1e-9);
}

}  // namespace

ThrownLight::ThrownLight(const Material& material) {
  constexpr double kRoot = 1.2207440846057596;
  for (std::size_t cell = 0; cell < kCells; ++cell) {
    const double root = (static_cast<double>(cell) + 0.5) / kCells, cos_i = root * root;
    std::map<int, Class, std::greater<>> classes;  // by half octaves
    double all = 0;
    for (int n = 0; n < kThrown; ++n) {
      const double turn = 2 * std::numbers::pi * lattice(n, 1 / (kRoot * kRoot * kRoot));
      // By reciprocity a direction of a path stands for light the other way.
      const Material::Sampled to =
          material.sample(static_cast<float>(cos_i), static_cast<float>(lattice(n, 1 / kRoot)),
                          static_cast<float>(lattice(n, 1 / (kRoot * kRoot))),
                          static_cast<float>(std::cos(turn)), static_cast<float>(std::sin(turn)));
      const auto density = static_cast<double>(material.density_per_sr(to.at));
      const auto cos_o = static_cast<double>(to.at.cos_i), cos_h = static_cast<double>(to.at.cos_h);
      if (!(to.weight > 0 && density > 0 && cos_o > 0 && cos_h > 0)) continue;
      const double tan2_h = static_cast<double>(to.at.sin2_h) / (cos_h * cos_h),
                   per_sr = material.cos_brdf_limit_per_sr({cos_i, cos_o, tan2_h, cos_i, cos_o}),
                   flux = material.grey() ? static_cast<double>(to.weight)
                                          : per_sr / cos_i * cos_o / density;
      if (!(flux > 0 && std::isfinite(flux))) continue;
      Class& here = classes[static_cast<int>(std::floor(2 * std::log2(per_sr)))];
      here.per_sr = std::max(here.per_sr, per_sr);
      here.share += flux;
      all += flux;
    }
    std::vector<Class>& out = of_cell_.emplace_back();
    for (const auto& [key, one] : classes) out.push_back({one.per_sr, one.share / all});
  }
}

double ThrownLight::not_met() { return 3.0 / kThrown; }

std::span<const ThrownLight::Class> ThrownLight::of(double cos_i) const {
  if (of_cell_.empty()) return {};
  const double cell = std::sqrt(std::clamp(cos_i, 0.0, 1.0)) * kCells;
  return of_cell_[std::min(kCells - 1, static_cast<std::size_t>(cell))];
}

}  // namespace irsig
