#include "core/plume/plume_silhouette.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/check.h"

namespace irsig {

std::array<Vec<Body>, 8> gas_corners(const PlumeField& field) {
  const PlumeField::Box box = field.bounds();
  std::array<Vec<Body>, 8> out;
  for (unsigned n = 0; n < 8; ++n)
    out[n] = field.body_from_index({(n & 4) != 0 ? box.high[0] : box.low[0],
                                    (n & 2) != 0 ? box.high[1] : box.low[1],
                                    (n & 1) != 0 ? box.high[2] : box.low[2]});
  return out;
}

GasWindow gas_window(const PlumeField& field, Vec<Body> direction) {
  // Any axis that is not along the direction.
  const Vec<Body> aside = std::abs(direction.z) < 0.9 ? Vec<Body>{0, 0, 1} : Vec<Body>{1, 0, 0};
  GasWindow out;
  out.right = normalized(cross(aside, direction));
  out.up = cross(direction, out.right);
  const std::array<Vec<Body>, 8> corners = gas_corners(field);
  for (const Vec<Body>& corner : corners) out.center = out.center + 0.125 * corner;
  for (const Vec<Body>& corner : corners) {
    const Vec<Body> off = corner - out.center;
    out.half_width_m = std::max(out.half_width_m, std::abs(dot(off, out.right)));
    out.half_height_m = std::max(out.half_height_m, std::abs(dot(off, out.up)));
    out.front_m = std::min(out.front_m, dot(off, direction));
    out.back_m = std::max(out.back_m, dot(off, direction));
  }
  return out;
}

ProjectedGas projected_gas(const PlumeField& field, Vec<Body> direction, const GreyAbsorption& grey,
                           double threshold, int rays_across) {
  IRSIG_CHECK(rays_across > 0);
  const GasWindow window = gas_window(field, direction);
  SegmentSteps steps;
  steps.temperature_step = 1e9;  // amounts are all that counts
  const auto n = static_cast<std::size_t>(rays_across);
  const double du = 2 * window.half_width_m / rays_across,
               dv = 2 * window.half_height_m / rays_across;
  std::vector<bool> in(n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const Vec<Body> at =
          window.center +
          ((static_cast<double>(i) + 0.5) * du - window.half_width_m) * window.right +
          ((static_cast<double>(j) + 0.5) * dv - window.half_height_m) * window.up +
          window.front_m * direction;
      double depth = 0;
      for (const GasSegment& s :
           march(field, {at, direction, 0, window.back_m - window.front_m}, steps))
        depth += grey.optical_depth(s);
      in[i * n + j] = depth > threshold;
    }
  std::size_t inside = 0, edge = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const bool own = in[i * n + j];
      inside += own;
      // Outside of the window there is nothing.
      const auto differs = [&](bool there, std::size_t other) {
        return (there && in[other]) != own;
      };
      edge += differs(i > 0, (i - 1) * n + j) || differs(i + 1 < n, (i + 1) * n + j) ||
              differs(j > 0, i * n + j - 1) || differs(j + 1 < n, i * n + j + 1);
    }
  return {static_cast<double>(inside) * du * dv,
          std::sqrt(static_cast<double>(edge) / 12) * du * dv};
}

}  // namespace irsig
