#include "core/atmosphere/refine_streams.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace irsig {
namespace {

// Gauss's cosines and weights of one hemisphere.
constexpr std::array kCosine = {0.06943184420297371, 0.33000947820757187, 0.6699905217924281,
                                0.9305681557970263};
constexpr std::array kWeight = {0.17392742256872692, 0.32607257743127307, 0.32607257743127307,
                                0.17392742256872692};

constexpr int kTimes = 2;

double second_legendre(double x) { return 0.5 * (3 * x * x - 1); }

// Returns Henyey and Greenstein's phase function, the mean over azimuths, from one zenith angle's
// cosine to another's; its mean over all directions is 1.
double mean_phase(double asymmetry, double a, double b) {
  constexpr int kOrders = 8;
  double before_a = 1, at_a = a, before_b = 1, at_b = b, power = asymmetry;
  double sum = 1 + 3 * power * a * b;
  for (int l = 2; l < kOrders; ++l) {
    const double next_a = ((2 * l - 1) * a * at_a - (l - 1) * before_a) / l,
                 next_b = ((2 * l - 1) * b * at_b - (l - 1) * before_b) / l;
    before_a = at_a;
    before_b = at_b;
    at_a = next_a;
    at_b = next_b;
    power *= asymmetry;
    sum += (2 * l + 1) * power * at_a * at_b;
  }
  return sum;
}

// One integration along all directions.
class Sweep {
 public:
  Sweep(std::span<const StreamLight> light, std::span<const StreamLayer> layers,
        const StreamBoundaries& boundaries)
      : light_(light), layer_(layers), boundary_(boundaries) {
    beam_.push_back(boundaries.sun_irradiance);
    for (const StreamLayer& l : layers)
      beam_.push_back(beam_.back() * std::exp(-l.depth / boundaries.sun_cosine));
  }

  [[nodiscard]] std::vector<StreamLight> result() {
    const std::size_t n = layer_.size();
    out_.assign(n + 1, StreamLight{0, 0});
    double down = 0;  // mean over the hemisphere, weighted with the cosine
    for (std::size_t j = 0; j < kCosine.size(); ++j) {
      double radiance = boundary_.down_radiance;
      for (std::size_t l = 0; l <= n; ++l) {
        add(l, j, -kCosine[j], radiance);
        if (l < n) radiance = through(l, l, l + 1, -kCosine[j], radiance);
      }
      down += 2 * kWeight[j] * kCosine[j] * radiance;
    }
    const double up =
        boundary_.up_radiance +
        boundary_.surface_albedo * (down + beam_[n] * boundary_.sun_cosine / std::numbers::pi);
    for (std::size_t j = 0; j < kCosine.size(); ++j) {
      double radiance = up;
      for (std::size_t l = n + 1; l-- > 0;) {
        add(l, j, kCosine[j], radiance);
        if (l > 0) radiance = through(l - 1, l, l - 1, kCosine[j], radiance);
      }
    }
    return std::move(out_);
  }

 private:
  void add(std::size_t boundary, std::size_t j, double cosine, double radiance) {
    const double part = 0.5 * kWeight[j] * radiance;
    out_[boundary].mean += part;
    out_[boundary].slope += 3 * part * cosine;
    out_[boundary].second += part * second_legendre(cosine);
  }

  // Returns the source at one of a layer's boundaries, without the beam's.
  [[nodiscard]] double source(std::size_t layer, std::size_t at, double cosine) const {
    const StreamLayer& l = layer_[layer];
    return (1 - l.albedo) * (at == layer ? l.planck_top : l.planck_bottom) +
           l.albedo * (light_[at].mean + l.asymmetry * light_[at].slope * cosine);
  }

  // Returns the radiance behind a layer that light crosses between two of the boundaries.
  [[nodiscard]] double through(std::size_t layer, std::size_t from, std::size_t to, double cosine,
                               double radiance) const {
    const StreamLayer& l = layer_[layer];
    const double depth = l.depth / std::abs(cosine), passed = std::exp(-depth);
    // A source that is linear in depth: its ends' weights.
    const double mean = depth > 1e-4 ? -std::expm1(-depth) / depth : 1 - 0.5 * depth;
    const double out = radiance * passed + source(layer, to, cosine) * (1 - mean) +
                       source(layer, from, cosine) * (mean - passed);
    if (boundary_.sun_irradiance <= 0) return out;
    // The beam weakens along light that falls, and grows along light that rises, seen backwards.
    const double decay = 1 + cosine / boundary_.sun_cosine, x = decay * depth;
    const double lit = std::abs(x) > 1e-6 ? -std::expm1(-x) / decay : depth;
    return out + l.albedo * mean_phase(l.asymmetry, cosine, -boundary_.sun_cosine) /
                     (4 * std::numbers::pi) * beam_[to] * lit;
  }

  std::span<const StreamLight> light_;
  std::span<const StreamLayer> layer_;
  const StreamBoundaries& boundary_;
  std::vector<double> beam_;  // at the boundaries, normal to it
  std::vector<StreamLight> out_;
};

}  // namespace

std::vector<StreamLight> refined_light(std::vector<StreamLight> light,
                                       std::span<const StreamLayer> layers,
                                       const StreamBoundaries& boundaries) {
  for (int i = 0; i < kTimes; ++i) light = Sweep(light, layers, boundaries).result();
  return light;
}

}  // namespace irsig
