#include "core/atmosphere/two_stream.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace irsig {
namespace {

// Without absorption the equations have a double root.
constexpr double kLargestAlbedo = 1 - 1e-9;

// Response of a layer to diffuse fluxes, and its own emission.
struct Response {
  double reflectance, transmittance;
  double up, down;  // emitted, and scattered out of the sun's beam
};

// Homogeneous solutions exp(+-decay depth): the weaker stream is `ratio` of the stronger.
struct Homogeneous {
  double decay, ratio, fade;
  Homogeneous(double gamma1, double gamma2, double depth)
      : decay(std::sqrt(std::max(0.0, (gamma1 - gamma2) * (gamma1 + gamma2)))),
        ratio(gamma2 / (gamma1 + decay)),
        fade(std::exp(-decay * depth)) {}
  [[nodiscard]] double determinant() const { return 1 - ratio * ratio * fade * fade; }
  [[nodiscard]] double reflectance() const { return ratio * (1 - fade * fade) / determinant(); }
  [[nodiscard]] double transmittance() const { return fade * (1 - ratio * ratio) / determinant(); }
};

// A particular solution at a layer's top and bottom.
struct Particular {
  double up_top, up_bottom, down_top, down_bottom;
};

// Nothing comes in: the homogeneous solutions cancel the particular one where light would enter.
void add_source(Response& layer, const Particular& p) {
  layer.up += p.up_top - layer.reflectance * p.down_top - layer.transmittance * p.up_bottom;
  layer.down += p.down_bottom - layer.reflectance * p.up_bottom - layer.transmittance * p.down_top;
}

Response thermal_response(const StreamLayer& l) {
  const double albedo = std::min(l.albedo, kLargestAlbedo);
  const double gamma1 = 2 - albedo * (1 + l.asymmetry), gamma2 = albedo * (1 - l.asymmetry);
  const Homogeneous h(gamma1, gamma2, l.depth);
  Response out{h.reflectance(), h.transmittance(), 0, 0};
  if (l.depth <= 0) return out;
  const double bend = (l.planck_bottom - l.planck_top) / l.depth / (gamma1 + gamma2);
  const double pi = std::numbers::pi;
  add_source(out, {pi * (l.planck_top + bend), pi * (l.planck_bottom + bend),
                   pi * (l.planck_top - bend), pi * (l.planck_bottom - bend)});
  return out;
}

Response solar_response(const StreamLayer& l, double irradiance, double cosine) {
  const double albedo = std::min(l.albedo, kLargestAlbedo), g = l.asymmetry;
  const double gamma1 = (7 - albedo * (4 + 3 * g)) / 4, gamma2 = -(1 - albedo * (4 - 3 * g)) / 4;
  const Homogeneous h(gamma1, gamma2, l.depth);
  Response out{h.reflectance(), h.transmittance(), 0, 0};
  double slope = 1 / cosine;
  // Resonance of the beam with a solution: a neighbouring angle gives the limit.
  if (std::abs(slope * slope - h.decay * h.decay) < 1e-6 * slope * slope) slope *= 1 + 1e-5;
  const double gamma3 = (2 - 3 * g / slope) / 4, gamma4 = 1 - gamma3;
  const double scale = albedo * irradiance / (h.decay * h.decay - slope * slope);
  const double up = scale * ((gamma1 - slope) * gamma3 + gamma4 * gamma2),
               down = scale * ((gamma1 + slope) * gamma4 + gamma2 * gamma3);
  const double fade = std::exp(-l.depth * slope);
  add_source(out, {up, up * fade, down, down * fade});
  return out;
}

std::vector<StreamLight> joined(std::span<const Response> layer, double down_flux, double up_flux,
                                double surface_albedo) {
  // Below each boundary: albedo, and the flux that rises without light from above.
  const std::size_t n = layer.size();
  std::vector<double> albedo(n + 1), rising(n + 1);
  std::vector<StreamLight> out(n + 1);
  albedo[n] = surface_albedo;
  rising[n] = up_flux;
  for (std::size_t l = n; l-- > 0;) {
    const Response& r = layer[l];
    const double bounces = 1 / (1 - r.reflectance * albedo[l + 1]);
    const double down = (r.reflectance * rising[l + 1] + r.down) * bounces;
    albedo[l] = r.reflectance + r.transmittance * r.transmittance * albedo[l + 1] * bounces;
    rising[l] = r.up + r.transmittance * (rising[l + 1] + albedo[l + 1] * down);
  }
  double down = down_flux;
  for (std::size_t l = 0; l <= n; ++l) {
    const double up = albedo[l] * down + rising[l];
    out[l] = {std::max(0.0, (up + down) / (2 * std::numbers::pi)),
              3 * (up - down) / (4 * std::numbers::pi)};
    if (l == n) break;
    const Response& r = layer[l];
    down = (r.transmittance * down + r.reflectance * rising[l + 1] + r.down) /
           (1 - r.reflectance * albedo[l + 1]);
  }
  return out;
}

}  // namespace

std::vector<StreamLight> diffuse_light(std::span<const StreamLayer> layers,
                                       const StreamBoundaries& b) {
  std::vector<Response> response;
  double beam = b.sun_irradiance;
  for (const StreamLayer& l : layers) {
    if (b.sun_irradiance > 0) {
      response.push_back(solar_response(l, beam, b.sun_cosine));
      beam *= std::exp(-l.depth / b.sun_cosine);
    } else {
      response.push_back(thermal_response(l));
    }
  }
  const double pi = std::numbers::pi;
  const double reflected_beam = b.surface_albedo * beam * b.sun_cosine;
  return joined(response, pi * b.down_radiance, pi * b.up_radiance + reflected_beam,
                b.surface_albedo);
}

}  // namespace irsig
