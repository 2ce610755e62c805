#include "core/materials/direction_check.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/materials/gauss_legendre.h"

namespace irsig {
namespace {

constexpr int kAzimuths = 16, kPanels = 4;

// Edges of the rings, in the half vector's angle to the normal.
std::vector<double> ring_edges(double narrowest_slope) {
  std::vector<double> edges{0};
  if (std::isfinite(narrowest_slope))
    for (const double s : {0.35, 0.6, 0.8, 1.0, 1.2, 1.5, 1.9, 2.4, 4.0, 8.0, 20.0, 60.0, 200.0})
      if (const double angle = std::atan(s * narrowest_slope); angle < 0.15) edges.push_back(angle);
  for (const double angle : {0.2, 0.35, 0.5, 0.65, 0.8, 1.0, 1.2, 0.5 * std::numbers::pi})
    edges.push_back(angle);
  return edges;
}

}  // namespace

double chi_square_p_value(double statistic, int degrees_of_freedom) {
  const double a = 0.5 * degrees_of_freedom, x = 0.5 * statistic;
  if (x <= 0) return 1;
  const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1) {  // 1 - P by its series
    double term = 1 / a, sum = term;
    for (int n = 1; n < 10000 && term > 1e-17 * sum; ++n) sum += term *= x / (a + n);
    return std::max(0.0, 1 - front * sum);
  }
  // Q by its continued fraction, evaluated from the front.
  double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
  for (int n = 1; n < 10000; ++n) {
    const double an = -n * (n - a);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    h *= c * d;
    if (std::abs(c * d - 1) < 1e-15) break;
  }
  return front * h;
}

DirectionCheck check_directions(const Material& drawn_from, const Material& stated, double cos_o,
                                std::uint32_t samples, std::uint64_t seed) {
  static const QuadratureRule rule = gauss_legendre(8);
  cos_o = static_cast<double>(static_cast<float>(cos_o));  // as the material sees it
  const std::vector<double> edge = ring_edges(static_cast<double>(stated.narrowest_slope()));
  const std::size_t rings = edge.size() - 1;
  const double sin_o = std::sqrt((1 - cos_o) * (1 + cos_o));

  // Along one azimuth of h the mirrored direction is above the surface up to the angle 45 deg + psi
  // / 2, tan psi = tan theta_o cos(azimuth).
  std::vector<double> expected(rings * kAzimuths + 1, 0.0);
  double integral = 0;
  for (std::size_t ring = 0; ring < rings; ++ring)
    for (int azimuth = 0; azimuth < kAzimuths; ++azimuth) {
      double sum = 0;
      for (int i = 0; i < kPanels * 8; ++i) {
        const double phi = (azimuth + (i / 8 + rule.x[static_cast<std::size_t>(i % 8)]) / kPanels) *
                               2 * std::numbers::pi / kAzimuths -
                           std::numbers::pi;
        const double last =
            0.25 * std::numbers::pi + 0.5 * std::atan2(sin_o * std::cos(phi), cos_o);
        const double a = std::min(edge[ring], last), width = std::min(edge[ring + 1], last) - a;
        for (int j = 0; j < kPanels * 8 && width > 0; ++j) {
          const double theta =
              a + width * (j / 8 + rule.x[static_cast<std::size_t>(j % 8)]) / kPanels;
          const double sin_h = std::sin(theta), cos_h = std::cos(theta);
          const double cos_d = sin_o * sin_h * std::cos(phi) + cos_o * cos_h;
          const double cos_i = 2 * cos_d * cos_h - cos_o;
          if (cos_i <= 0 || cos_d <= 0) continue;
          const Reflection at{static_cast<float>(std::min(cos_i, 1.0)), static_cast<float>(cos_o),
                              static_cast<float>(cos_h), static_cast<float>(sin_h * sin_h),
                              static_cast<float>(std::min(cos_d, 1.0))};
          sum += rule.w[static_cast<std::size_t>(i % 8)] * rule.w[static_cast<std::size_t>(j % 8)] *
                 width * 4 * cos_d * sin_h * static_cast<double>(stated.density_per_sr(at));
        }
      }
      sum *= 2 * std::numbers::pi / (kAzimuths * kPanels * kPanels);
      expected[ring * kAzimuths + static_cast<std::size_t>(azimuth)] = sum * samples;
      integral += sum;
    }
  expected.back() = std::max(0.0, 1 - integral) * samples;

  std::vector<double> counted(expected.size(), 0.0);
  std::uint32_t above = 0;
  UniformNumbers random(mix64(seed));
  for (std::uint32_t n = 0; n < samples; ++n) {
    const float u_lobe = random.next(), u = random.next();
    const float angle = 2 * std::numbers::pi_v<float> * random.next();
    const Material::Sampled s =
        drawn_from.sample(static_cast<float>(cos_o), u_lobe, u, std::cos(angle), std::sin(angle));
    if (!(s.z > 0)) {
      ++counted.back();
      continue;
    }
    ++above;
    const double hx = static_cast<double>(s.x) + sin_o, hy = s.y,
                 hz = static_cast<double>(s.z) + cos_o;
    const double theta =
        std::atan2(std::sqrt(static_cast<double>(s.at.sin2_h)), static_cast<double>(s.at.cos_h));
    // Lambert does not fill in its half vector.
    const double of_direction = std::atan2(std::sqrt(hx * hx + hy * hy), hz);
    const double used = s.at.sin2_h > 0 ? theta : of_direction;
    const auto ring = std::min<std::size_t>(
        static_cast<std::size_t>(std::upper_bound(edge.begin(), edge.end(), used) - edge.begin()) -
            1,
        rings - 1);
    const double turn = (std::atan2(hy, hx) + std::numbers::pi) / (2 * std::numbers::pi);
    const int azimuth = std::clamp(static_cast<int>(turn * kAzimuths), 0, kAzimuths - 1);
    ++counted[ring * kAzimuths + static_cast<std::size_t>(azimuth)];
  }

  // Neighbouring bins are joined until 10 directions are expected.
  double statistic = 0, e = 0, c = 0;
  int bins = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    e += expected[i];
    c += counted[i];
    if (e < 10 && i + 1 < expected.size()) continue;
    // A last bin with too small an expectation joins the slack of the last test: its expectation is
    // below 10 only if all the rest is.
    if (e < 10 && bins > 0) {
      statistic += (c - e) * (c - e) / std::max(e, 10.0);
      break;
    }
    statistic += (c - e) * (c - e) / e;
    ++bins;
    e = c = 0;
  }
  return {bins > 1 ? chi_square_p_value(statistic, bins - 1) : 1, bins, integral,
          static_cast<double>(above) / samples};
}

}  // namespace irsig
