#include "core/atmosphere/haze_column.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace irsig {
namespace {

constexpr std::size_t kStreams = kHazeCosines.size();
constexpr std::array kStreamWeight = {0.17392742256872692, 0.32607257743127307, 0.32607257743127307,
                                      0.17392742256872692};
constexpr int kHazeOrders = 4;
constexpr double kSphere = 4 * std::numbers::pi;

using Moments = std::array<double, HazeHarmonics::kCount>;

const std::array<HazeHarmonics, kStreams>& stream_harmonics() {
  static const std::array<HazeHarmonics, kStreams> of = {
      HazeHarmonics(kHazeCosines[0]), HazeHarmonics(kHazeCosines[1]),
      HazeHarmonics(kHazeCosines[2]), HazeHarmonics(kHazeCosines[3])};
  return of;
}

double power(double base, std::size_t exponent) {
  double out = 1;
  for (std::size_t i = 0; i < exponent; ++i) out *= base;
  return out;
}

// A layer whose phase function has lost the moments beyond kHazeMoments.
struct TruncatedLayer {
  double depth, albedo, planck_top, planck_bottom;
  std::array<double, kHazeMoments> moment;  // (2 l + 1) x that of the phase function
  // Along each stream: transmittance, its mean over the depth, and the integral of the beam's light
  // over its irradiance where the stream leaves the layer.
  std::array<double, kStreams> passed, mean, lit_down, lit_up;
};

TruncatedLayer truncated(const StreamLayer& layer) {
  const double g = layer.asymmetry, peak = power(g, kHazeMoments);
  TruncatedLayer out{};
  out.depth = layer.depth * (1 - layer.albedo * peak);
  out.albedo = layer.albedo * (1 - peak) / (1 - layer.albedo * peak);
  out.planck_top = layer.planck_top;
  out.planck_bottom = layer.planck_bottom;
  double of = 1;
  for (std::size_t l = 0; l < kHazeMoments; ++l, of *= g)
    out.moment[l] = static_cast<double>(2 * l + 1) * (of - peak) / (1 - peak);
  for (std::size_t j = 0; j < kStreams; ++j) {
    const double x = out.depth / kHazeCosines[j];
    out.passed[j] = std::exp(-x);
    out.mean[j] = x > 1e-4 ? -std::expm1(-x) / x : 1 - 0.5 * x;
  }
  return out;
}

// Returns the integral of exp(-x (1 + rise)) over x from 0 to a depth.
double lit_depth(double depth, double rise) {
  const double decay = 1 + rise, x = decay * depth;
  return std::abs(x) > 1e-6 ? -std::expm1(-x) / decay : depth;
}

// Sets the layer's integrals of a beam that has these irradiances above and below it.
void set_lit(TruncatedLayer& layer, double above, double below) {
  const bool both = above > 0 && below > 0 && layer.depth > 0;
  const double per_depth = both ? std::log(above / below) / layer.depth : 0;
  for (std::size_t j = 0; j < kStreams; ++j) {
    const double depth = layer.depth / kHazeCosines[j], slant = per_depth * kHazeCosines[j];
    // At the edge of the Earth's shadow half of the layer is lit.
    layer.lit_down[j] = both ? below * lit_depth(depth, -slant)
                             : 0.5 * std::max(above, below) * -std::expm1(-depth);
    layer.lit_up[j] = both ? above * lit_depth(depth, slant) : layer.lit_down[j];
  }
}

class HazeColumn {
 public:
  HazeColumn(std::span<const StreamLayer> layers, const HazeBoundaries& boundaries)
      : boundary_(boundaries), sun_(-boundaries.sun_cosine), moments_(layers.size() + 1) {
    for (const StreamLayer& l : layers) layer_.push_back(truncated(l));
    if (boundary_.beam.empty()) return;
    // Truncated particles leave more in the beam.
    double kept = 0;
    for (std::size_t k = 0; k <= layers.size(); ++k) {
      beam_.push_back(boundary_.beam[k] * std::exp(kept));
      if (k == layers.size()) break;
      kept += (layers[k].depth - layer_[k].depth) / boundary_.sun_cosine;
    }
    for (std::size_t k = 0; k < layer_.size(); ++k) set_lit(layer_[k], beam_[k], beam_[k + 1]);
  }

  // Begins with two streams' light. Their own truncation leaves more in the beam.
  void begin(std::span<const StreamLayer> layers) {
    std::vector<StreamLayer> without_peak;
    std::vector<double> beam = {boundary_.beam.empty() ? 0 : boundary_.beam.front()};
    for (StreamLayer l : layers) {
      const double peak = l.asymmetry * l.asymmetry;
      l.depth *= 1 - l.albedo * peak;
      l.albedo *= (1 - peak) / (1 - l.albedo * peak);
      l.asymmetry /= 1 + l.asymmetry;
      beam.push_back(beam.back() * std::exp(-l.depth / boundary_.sun_cosine));
      without_peak.push_back(l);
    }
    StreamBoundaries of;
    for (std::size_t j = 0; j < kStreams; ++j)
      of.down_radiance += 2 * kStreamWeight[j] * kHazeCosines[j] * boundary_.down_radiance[j];
    of.up_radiance = boundary_.up_radiance;
    of.surface_albedo = boundary_.surface_albedo;
    of.sun_irradiance = beam.front();
    of.sun_cosine = boundary_.sun_cosine;
    const std::vector<StreamLight> light = diffuse_light(without_peak, of);
    for (std::size_t k = 0; k < light.size(); ++k) {
      const double more = beam_.empty() ? 0 : std::max(0.0, beam[k] - beam_[k]) / kSphere;
      moments_[k][0] = light[k].mean + more;
      moments_[k][1] = light[k].slope / 3 + more * sun_[1];
    }
  }

  // Integrates one azimuth's term of the source along all streams.
  void integrate(std::size_t mode) {
    const std::size_t n = layer_.size(), first = HazeHarmonics::first(mode);
    set_sources(mode);
    for (Moments& m : moments_)
      std::fill_n(m.begin() + static_cast<std::ptrdiff_t>(first), kHazeMoments - mode, 0.0);
    double down = 0;  // mean over the hemisphere, weighted with the cosine
    for (std::size_t j = 0; j < kStreams; ++j) {
      double radiance = mode == 0 ? boundary_.down_radiance[j] : 0;
      for (std::size_t k = 0; k <= n; ++k) {
        add(mode, k, j, -1, radiance);
        if (k < n)
          radiance = through(k, j, source_[k][0].down[j], source_[k][1].down[j], radiance) +
                     beam_source_[k].down[j] * layer_[k].lit_down[j];
      }
      down += 2 * kStreamWeight[j] * kHazeCosines[j] * radiance;
    }
    double rising = 0;
    if (mode == 0) {
      const double beam =
          beam_.empty() ? 0 : beam_[n] * boundary_.sun_cosine * std::numbers::inv_pi;
      rising = boundary_.up_radiance + boundary_.surface_albedo * (down + beam);
    }
    for (std::size_t j = 0; j < kStreams; ++j) {
      double radiance = rising;
      for (std::size_t k = n + 1; k-- > 0;) {
        add(mode, k, j, 1, radiance);
        if (k > 0)
          radiance = through(k - 1, j, source_[k - 1][1].up[j], source_[k - 1][0].up[j], radiance) +
                     beam_source_[k - 1].up[j] * layer_[k - 1].lit_up[j];
      }
    }
  }

  // Returns the source of all diffuse light, that of the beam's kept peak included.
  [[nodiscard]] std::vector<HazeSource> sources(std::span<const StreamLayer> layers) const {
    std::vector<HazeSource> out(moments_.size());
    double scattering = 0;
    for (std::size_t k = 0; k < out.size(); ++k) {
      const std::size_t above = k > 0 ? k - 1 : 0, below = std::min(k, layers.size() - 1);
      const double g = 0.5 * (layers[above].asymmetry + layers[below].asymmetry);
      if (k > 0) scattering += layers[k - 1].depth * layers[k - 1].albedo;
      const double beam = beam_.empty() ? 0 : boundary_.beam[k],
                   kept = beam_.empty() ? 0 : (beam_[k] - beam) / kSphere;
      if (beam > 0) set_peak(out[k], g, scattering / boundary_.sun_cosine, beam);
      for (std::size_t m = 0; m < kHazeModes; ++m)
        for (std::size_t l = m; l < kHazeMoments; ++l) {
          const std::size_t i = HazeHarmonics::first(m) + l - m;
          const double around_sun = out[k].peak * power(out[k].peak_asymmetry, l) / kSphere;
          out[k].harmonic[i] =
              static_cast<double>(2 * l + 1) *
              (power(g, l) * (moments_[k][i] + kept * sun_[i]) - around_sun * sun_[i]);
        }
    }
    return out;
  }

 private:
  struct Streams {
    std::array<double, kStreams> up{}, down{};
  };

  // Sets the peak by two moments of light that was scattered along the beam.
  static void set_peak(HazeSource& out, double g, double depth, double beam) {
    constexpr std::size_t kFrom = 4;
    constexpr double kMostDepth = 500;
    const double low = power(g, kFrom), x = std::min(depth, kMostDepth);
    if (low <= 0 || x <= 0) return;
    const double at = low * std::expm1(x * low), next = low * g * std::expm1(x * low * g);
    out.peak_asymmetry = next / at;
    out.peak = beam * at / power(out.peak_asymmetry, kFrom);
  }

  void set_sources(std::size_t mode) {
    const std::size_t n = layer_.size(), first = HazeHarmonics::first(mode);
    source_.assign(n, {});
    beam_source_.assign(n, {});
    for (std::size_t k = 0; k < n; ++k) {
      const TruncatedLayer& layer = layer_[k];
      for (std::size_t end = 0; end < 2; ++end) {
        const double emitted =
            mode == 0 ? (1 - layer.albedo) * (end == 0 ? layer.planck_top : layer.planck_bottom)
                      : 0;
        set_streams(source_[k][end], mode, emitted, [&](std::size_t l) {
          return layer.albedo * layer.moment[l] * moments_[k + end][first + l - mode];
        });
      }
      if (beam_.empty()) continue;
      set_streams(beam_source_[k], mode, 0, [&](std::size_t l) {
        return layer.albedo * layer.moment[l] * sun_[first + l - mode] / kSphere;
      });
    }
  }

  // Sums a term over its functions, which are even or odd in the cosine.
  template <typename Of>
  static void set_streams(Streams& out, std::size_t mode, double emitted, const Of& of) {
    const std::size_t first = HazeHarmonics::first(mode);
    for (std::size_t j = 0; j < kStreams; ++j) {
      const HazeHarmonics& at = stream_harmonics()[j];
      double part[2] = {emitted, 0};
      for (std::size_t l = mode; l < kHazeMoments; ++l)
        part[(l - mode) % 2] += of(l) * at[first + l - mode];
      out.up[j] = part[0] + part[1];
      out.down[j] = part[0] - part[1];
    }
  }

  void add(std::size_t mode, std::size_t boundary, std::size_t j, double sign, double radiance) {
    const std::size_t first = HazeHarmonics::first(mode);
    const HazeHarmonics& at = stream_harmonics()[j];
    double part = 0.5 * kStreamWeight[j] * radiance;
    for (std::size_t l = mode; l < kHazeMoments; ++l, part *= sign)
      moments_[boundary][first + l - mode] += part * at[first + l - mode];
  }

  [[nodiscard]] double through(std::size_t layer, std::size_t j, double source_from,
                               double source_to, double radiance) const {
    const double passed = layer_[layer].passed[j], mean = layer_[layer].mean[j];
    return radiance * passed + source_to * (1 - mean) + source_from * (mean - passed);
  }

  const HazeBoundaries& boundary_;
  HazeHarmonics sun_;  // of the direction in which the beam travels
  std::vector<TruncatedLayer> layer_;
  std::vector<double> beam_;  // of truncated particles
  std::vector<Moments> moments_;
  std::vector<std::array<Streams, 2>> source_;  // [layer][top, bottom]
  std::vector<Streams> beam_source_;            // over the beam's irradiance
};

}  // namespace

HazeHarmonics::HazeHarmonics(double cosine) {
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  double diagonal = 1;  // l = m, without the sign of Condon and Shortley
  for (std::size_t m = 0; m < kHazeModes; ++m) {
    if (m > 0) {
      const auto of = static_cast<double>(m);
      diagonal *= sine * std::sqrt((2 * of - 1) / (2 * of));
    }
    double before = 0, at = diagonal;
    for (std::size_t l = m; l < kHazeMoments; ++l) {
      value_[first(m) + l - m] = at;
      const auto x = static_cast<double>(l), y = static_cast<double>(m);
      const double next = ((2 * x + 1) * cosine * at - std::sqrt(x * x - y * y) * before) /
                          std::sqrt((x + 1) * (x + 1) - y * y);
      before = at;
      at = next;
    }
  }
}

std::vector<HazeSource> haze_sources(std::span<const StreamLayer> layers,
                                     const HazeBoundaries& boundaries) {
  HazeColumn column(layers, boundaries);
  column.begin(layers);
  const std::size_t modes = boundaries.beam.empty() ? 1 : kHazeModes;
  for (std::size_t m = 0; m < modes; ++m)
    for (int i = 0; i < kHazeOrders; ++i) column.integrate(m);
  return column.sources(layers);
}

}  // namespace irsig
