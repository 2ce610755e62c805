#include "core/materials/lobe_mixture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace irsig {
namespace {

constexpr double kLeastProbability = 0.02;

double sin_of(double cos_theta) {
  return std::sqrt(std::max(0.0, (1 - cos_theta) * (1 + cos_theta)));
}

// The direction w_o mirrored at h = (hx, hy, hz) / length, hz > 0.
BrdfModel::Drawn mirrored(double cos_o, double sin_o, double hx, double hy, double hz) {
  const double inverse = 1 / std::sqrt(hx * hx + hy * hy + hz * hz);
  const double x = hx * inverse, y = hy * inverse, cos_h = hz * inverse;
  const double cos_d = sin_o * x + cos_o * cos_h;
  BrdfModel::Drawn out{2 * cos_d * x - sin_o, 2 * cos_d * y, 2 * cos_d * cos_h - cos_o, {}, 0};
  out.at = {std::min(out.z, 1.0), cos_o, cos_h, x * x + y * y, std::min(cos_d, 1.0)};
  return out;
}

BrdfModel::Drawn along(double cos_o, double sin_o, double x, double y, double z) {
  const double hx = x + sin_o, hz = z + cos_o, h2 = hx * hx + y * y + hz * hz;
  const double h = std::sqrt(h2);
  return {x, y, z, {z, cos_o, hz / h, (hx * hx + y * y) / h2, std::min(0.5 * h, 1.0)}, 0};
}

BrdfModel::Drawn draw(const SamplingLobe& lobe, double cos_o, double u, double cos_phi,
                      double sin_phi) {
  const double sin_o = sin_of(cos_o);
  switch (lobe.kind) {
    case SamplingLobe::Kind::kCosine: {
      const double r = std::sqrt(u);
      return along(cos_o, sin_o, r * cos_phi, r * sin_phi, std::sqrt(1 - u));
    }
    case SamplingLobe::Kind::kUniform: {
      const double z = 1 - u, r = sin_of(z);
      return along(cos_o, sin_o, r * cos_phi, r * sin_phi, z);
    }
    case SamplingLobe::Kind::kHalfVectors: {
      const double tan_h = std::sqrt(slope2_at(lobe.slopes, u));
      return mirrored(cos_o, sin_o, tan_h * cos_phi, tan_h * sin_phi, 1);
    }
    case SamplingLobe::Kind::kVisibleHalfVectors: {
      // The ellipsoid stretched to a sphere; a point of its projection along w_o. [heitz2018]
      const double w = lobe.slopes.width;
      const double length = std::sqrt(w * w * sin_o * sin_o + cos_o * cos_o);
      const double vx = w * sin_o / length, vz = cos_o / length;
      const double r = std::sqrt(u), t1 = r * cos_phi, half = 0.5 * (1 + vz);
      const double t2 = (1 - half) * std::sqrt(std::max(0.0, 1 - t1 * t1)) + half * r * sin_phi;
      const double t3 = std::sqrt(std::max(0.0, 1 - t1 * t1 - t2 * t2));
      const double nx = -vz * t2 + vx * t3, nz = vx * t2 + vz * t3;
      return mirrored(cos_o, sin_o, w * nx, w * t1, std::max(nz, 1e-12));
    }
  }
  return {};
}

double density(const SamplingLobe& lobe, const ReflectionGeometry& g) {
  switch (lobe.kind) {
    case SamplingLobe::Kind::kCosine:
      return g.cos_i / std::numbers::pi;
    case SamplingLobe::Kind::kUniform:
      return 0.5 / std::numbers::pi;
    case SamplingLobe::Kind::kHalfVectors:
      return half_vector_density(lobe.slopes, g.cos_h, g.sin2_h) / (4 * g.cos_d);
    case SamplingLobe::Kind::kVisibleHalfVectors: {
      const double w2 = lobe.slopes.width * lobe.slopes.width, sin_o = sin_of(g.cos_o);
      const double sigma = 0.5 * (g.cos_o + std::sqrt(g.cos_o * g.cos_o + w2 * sin_o * sin_o));
      return half_vector_density(lobe.slopes, g.cos_h, g.sin2_h) / (4 * sigma * g.cos_h);
    }
  }
  return 0;
}

}  // namespace

LobeMixture::LobeMixture(std::vector<SamplingLobe> lobes,
                         const std::function<void(double, std::span<double>)>& strength)
    : lobe_(std::move(lobes)) {
  const std::size_t n = lobe_.size();
  std::vector<double> row(n), largest(n, 0.0);
  for (int cell = 0; cell <= kCells; ++cell) {
    const double x = static_cast<double>(cell) / kCells;
    strength(std::max(x * x, 1e-8), row);
    for (std::size_t i = 0; i < n; ++i) largest[i] = std::max(largest[i], row[i]);
    probability_.insert(probability_.end(), row.begin(), row.end());
  }
  // A material that reflects nothing has no use for its directions.
  if (*std::max_element(largest.begin(), largest.end()) <= 0) largest.assign(n, 1.0);
  for (int cell = 0; cell <= kCells; ++cell) {
    double* p = probability_.data() + static_cast<std::size_t>(cell) * n;
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += p[i];
    double total = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double share = sum > 0 ? p[i] / sum : 1.0;
      p[i] = largest[i] > 0 ? std::max(share, kLeastProbability) : 0.0;
      total += p[i];
    }
    for (std::size_t i = 0; i < n; ++i) p[i] /= total;
  }
}

double LobeMixture::probability(std::size_t lobe, double cos_o) const {
  const double position = std::sqrt(cos_o) * kCells;
  const auto cell =
      std::min(static_cast<std::size_t>(position), static_cast<std::size_t>(kCells) - 1);
  const double t = position - static_cast<double>(cell);
  const double* p = probability_.data() + cell * lobe_.size() + lobe;
  return p[0] + t * (p[lobe_.size()] - p[0]);
}

double LobeMixture::density_per_sr(const ReflectionGeometry& g) const {
  if (lobe_.size() == 1) return density(lobe_[0], g);
  double sum = 0;
  for (std::size_t i = 0; i < lobe_.size(); ++i) {
    const double p = probability(i, g.cos_o);
    if (p > 0) sum += p * density(lobe_[i], g);
  }
  return sum;
}

BrdfModel::Drawn LobeMixture::sample(double cos_o, double u_lobe, double u, double cos_phi,
                                     double sin_phi) const {
  std::size_t chosen = 0;
  double sum = 0;
  for (std::size_t i = 0; i < lobe_.size() && lobe_.size() > 1; ++i) {
    const double p = probability(i, cos_o);
    if (p <= 0) continue;
    chosen = i;
    sum += p;
    if (u_lobe < sum) break;
  }
  BrdfModel::Drawn out = draw(lobe_[chosen], cos_o, u, cos_phi, sin_phi);
  if (out.z > 0 && out.at.cos_d > 0) out.density_per_sr = density_per_sr(out.at);
  return out;
}

}  // namespace irsig
