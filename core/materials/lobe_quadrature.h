#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/materials/gauss_legendre.h"
#include "core/materials/reflection.h"
#include "core/materials/slope_law.h"

namespace irsig {

// Integrals over the reflections of one direction in a lobe of half vectors.
//
// Along the slope and along the azimuth the integrands of this folder have kinks at known places:
// where the mirrored direction sinks below the surface, and where V-groove masking or another
// minimum changes its form (cos_i = cos_o, 2 cos_h cos_o = cos_d, 2 cos_h cos_i = cos_d). Each
// piece between them gets its own Gauss points, spaced for square roots at its ends. 32 x 12 points
// per piece leave 2e-6 of the DHR of tests/physics/values/brdf_dhr.csv; points that ignore the
// kinks left 4e-4.
class LobeQuadrature {
  // A few numbers kept in increasing order.
  struct Edges {
    std::array<double, 8> at{};
    std::size_t size = 0;
    void add(double x) {
      std::size_t i = size++;
      for (; i > 0 && at[i - 1] > x; --i) at[i] = at[i - 1];
      at[i] = x;
    }
  };

 public:
  explicit LobeQuadrature(const SlopeLobe& lobe, int slopes = 32, int azimuths = 12)
      : lobe_(lobe),
        slope_(gauss_legendre_between_roots(slopes)),
        azimuth_(gauss_legendre_between_roots(azimuths)) {}

  // Calls visit(geometry, mean_weight, solid_angle_weight) at every point above the surface. The
  // sum of mean_weight X is the mean of X over the lobe's half vectors; the sum of
  // solid_angle_weight X is the integral of X over w_i.
  template <typename Visit>
  void visit(double cos_o, Visit&& visit) const {
    const double theta_o = std::acos(std::min(1.0, cos_o));
    const double sin_o = std::sqrt(std::max(0.0, (1 - cos_o) * (1 + cos_o)));
    constexpr double kRight = 0.5 * std::numbers::pi;
    // Where the kinks first touch the plane of incidence.
    const std::array<double, 6> touch = {0.5 * (kRight - theta_o), theta_o,
                                         kRight - theta_o,         (kRight + theta_o) / 3,
                                         (kRight - theta_o) / 3,   0.5 * (kRight + theta_o)};
    Edges edge;
    edge.add(0);
    for (const double angle : touch) {
      const double x = parameter(std::tan(std::clamp(angle, 0.0, kRight)));
      if (x > 1e-9 && x < last() * (1 - 1e-9)) edge.add(x);
    }
    edge.add(last());
    for (std::size_t e = 0; e + 1 < edge.size; ++e) {
      const double width = edge.at[e + 1] - edge.at[e];
      if (width <= 0) continue;
      for (std::size_t i = 0; i < slope_.x.size(); ++i) {
        const double x = edge.at[e] + width * slope_.x[i];
        double tan_h = 0, share = 0;
        slope(x, tan_h, share);
        visit_azimuths(cos_o, sin_o, tan_h, width * slope_.w[i] * share, visit);
      }
    }
  }

 private:
  // Returns the end of the integration variable x in [0, last()], the slope as a function of x, and
  // the fraction of half vectors in dx.
  [[nodiscard]] double last() const {
    switch (lobe_.law) {
      case SlopeLaw::kBeckmann:
        return 6.5;  // exp(-6.5^2) = 4e-19
      case SlopeLaw::kEllipsoid:
        return 0.5 * std::numbers::pi;
      case SlopeLaw::kCauchy:
        return 1;
    }
    return 0;
  }
  [[nodiscard]] double parameter(double tan_h) const {
    const double t = tan_h / lobe_.width;
    switch (lobe_.law) {
      case SlopeLaw::kBeckmann:
        return t;
      case SlopeLaw::kEllipsoid:
        return std::atan(t);
      case SlopeLaw::kCauchy: {
        const double w2 = lobe_.width * lobe_.width, sin2 = tan_h * tan_h / (1 + tan_h * tan_h);
        const double kappa = 1 - w2;
        return kappa < 1e-8 ? sin2 : std::log1p(kappa * sin2 / w2) / -std::log(w2);
      }
    }
    return 0;
  }
  void slope(double x, double& tan_h, double& share) const {
    switch (lobe_.law) {
      case SlopeLaw::kBeckmann:
        tan_h = lobe_.width * x;
        share = 2 * x * std::exp(-x * x);
        return;
      case SlopeLaw::kEllipsoid:
        tan_h = lobe_.width * std::tan(x);
        share = std::sin(2 * x);
        return;
      case SlopeLaw::kCauchy:
        tan_h = std::sqrt(slope2_at(lobe_, x));
        share = 1;
        return;
    }
  }

  template <typename Visit>
  void visit_azimuths(double cos_o, double sin_o, double tan_h, double share, Visit& visit) const {
    const double cos_h = 1 / std::sqrt(1 + tan_h * tan_h), sin_h = tan_h * cos_h;
    if (!(cos_h > 1e-8)) return;  // mirrored below the surface or along it
    const double p = half_vector_density(lobe_, cos_h, sin_h * sin_h);
    if (!(p > 0)) return;
    // cos_d = sin_o sin_h cos(phi) + cos_o cos_h falls from phi = 0 to pi; w_i is above the surface
    // while cos_d > cos_o / (2 cos_h).
    const double middle = cos_o * cos_h, amplitude = sin_o * sin_h;
    const std::array<double, 4> kink = {cos_o / (2 * cos_h), cos_o / cos_h, 2 * cos_o * cos_h,
                                        2 * cos_o / (4 * cos_h - 1 / cos_h)};
    Edges edge;
    edge.add(0);
    for (const double k : kink)
      if (std::abs(k - middle) < amplitude) edge.add(std::acos((k - middle) / amplitude));
    edge.add(std::numbers::pi);
    for (std::size_t e = 0; e + 1 < edge.size; ++e) {
      const double width = edge.at[e + 1] - edge.at[e];
      if (width <= 0) continue;
      {
        const double cos_d = amplitude * std::cos(edge.at[e] + 0.5 * width) + middle;
        if (2 * cos_d * cos_h - cos_o <= 0) break;  // all further pieces are below the surface
      }
      for (std::size_t j = 0; j < azimuth_.x.size(); ++j) {
        const double cos_d =
            std::min(1.0, amplitude * std::cos(edge.at[e] + width * azimuth_.x[j]) + middle);
        const double cos_i = std::min(1.0, 2 * cos_d * cos_h - cos_o);
        if (cos_d <= 0 || cos_i <= 0) continue;
        const double mean_weight = share * azimuth_.w[j] * width / std::numbers::pi;
        visit(ReflectionGeometry{cos_i, cos_o, cos_h, sin_h * sin_h, cos_d}, mean_weight,
              mean_weight * 4 * cos_d / p);
      }
    }
  }

  SlopeLobe lobe_;
  QuadratureRule slope_, azimuth_;
};

}  // namespace irsig
