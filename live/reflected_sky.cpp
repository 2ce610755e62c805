#include "live/reflected_sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/constants.h"

namespace irsig {
namespace {

// A point of [0, 1) x [0, 1), evenly spread over a set of n.
struct UnitPoint {
  float x, y;
};
UnitPoint hammersley(std::uint32_t i, std::uint32_t n) {
  std::uint32_t bits = i;
  bits = (bits << 16) | (bits >> 16);
  bits = ((bits & 0x00ff00ffu) << 8) | ((bits & 0xff00ff00u) >> 8);
  bits = ((bits & 0x0f0f0f0fu) << 4) | ((bits & 0xf0f0f0f0u) >> 4);
  bits = ((bits & 0x33333333u) << 2) | ((bits & 0xccccccccu) >> 2);
  bits = ((bits & 0x55555555u) << 1) | ((bits & 0xaaaaaaaau) >> 1);
  return {(static_cast<float>(i) + 0.5f) / static_cast<float>(n),
          static_cast<float>(bits) * 0x1p-32f};
}

float cosine_of(std::uint32_t node, std::uint32_t nodes) {
  const float root = static_cast<float>(node) / static_cast<float>(nodes - 1);
  return std::max(root * root, 1e-3f);
}

}  // namespace

ReflectedSky::ReflectedSky(const PreparedScene& scene, const DirectionNodes& nodes)
    : rings_(nodes.count() / nodes.azimuths()),
      azimuths_(nodes.azimuths()),
      columns_(scene.path_basis() == nullptr ? 1 : scene.carried_material().front().nodes()) {
  for (const Material& material : scene.carried_material()) {
    Filter& filter = material_.emplace_back();
    filter.direction.reserve(std::size_t{kEntries} * kDirections);
    filter.column.reserve(std::size_t{kEntries} * kDirections * columns_);
    for (std::uint32_t t = 0; t < kTilts; ++t)
      for (std::uint32_t a = 0; a < kAzimuths; ++a)
        for (std::uint32_t c = 0; c < kCosines; ++c) {
          const double tilt = std::numbers::pi * t / (kTilts - 1),
                       azimuth = std::numbers::pi * a / (kAzimuths - 1);
          // z up here: the normal, uphill in the surface, and across.
          const Vec<Enu> n{std::sin(tilt), 0, std::cos(tilt)},
              u{-std::cos(tilt), 0, std::sin(tilt)}, v{0, 1, 0};
          const Vec<Enu> x = std::cos(azimuth) * u + std::sin(azimuth) * v, y = cross(n, x);
          const float cos_o = cosine_of(c, kCosines);
          for (std::uint32_t k = 0; k < kDirections; ++k) {
            const UnitPoint p = hammersley(k, kDirections);
            const float phi = 2 * std::numbers::pi_v<float> * p.y;
            const float lobe = std::fmod((static_cast<float>(k) + 0.5f) * 0.7548777f, 1.0f);
            const Material::Sampled s =
                material.sample(cos_o, lobe, p.x, std::cos(phi), std::sin(phi));
            Direction& d = filter.direction.emplace_back();
            d = {{0, 0}, {0, 0}};
            const std::size_t at = filter.column.size();
            filter.column.resize(at + columns_, 0.0f);
            if (!(s.weight > 0)) continue;
            const Vec<Enu> to = static_cast<double>(s.x) * x + static_cast<double>(s.y) * y +
                                static_cast<double>(s.z) * n;
            DirectionNodes::Share share[4];
            const int count = nodes.shares(static_cast<float>(to.x), static_cast<float>(to.y),
                                           static_cast<float>(-to.z), share);
            for (int i = 0; i < count; ++i) {
              const std::uint32_t ring = share[i].node / azimuths_;
              const int place = i == 0 || ring == d.ring[0] ? 0 : 1;
              d.ring[place] = ring;
              d.weight[place] += share[i].weight;
            }
            if (scene.path_basis() == nullptr)
              filter.column[at] = s.weight;
            else
              material.spectral_weight(s, filter.column.data() + at);
          }
        }
  }
}

std::vector<float> ReflectedSky::of(std::uint32_t material, std::span<const double> ring,
                                    std::size_t first_column, std::size_t columns) const {
  const Filter& filter = material_[material];
  std::vector<float> rings(ring.begin(), ring.end()), out(kEntries);
  const float* column = filter.column.data();
  const Direction* d = filter.direction.data();
  for (float& entry : out) {
    float sum = 0;
    for (std::uint32_t k = 0; k < kDirections; ++k, ++d, column += columns_) {
      const float *a = rings.data() + d->ring[0] * columns,
                  *b = rings.data() + d->ring[1] * columns;
      const float wa = d->weight[0], wb = d->weight[1];
      const float* w = column + first_column;
      for (std::size_t i = 0; i < columns; ++i) sum += w[i] * (wa * a[i] + wb * b[i]);
    }
    entry = sum / kDirections;
  }
  return out;
}

float ReflectedSky::look_up(const float* table, float up, float cos_o, float azimuth) {
  struct At {
    std::uint32_t low;
    float f;
  };
  const auto place = [](float x, std::uint32_t nodes) {
    const float position = std::clamp(x, 0.0f, 1.0f) * static_cast<float>(nodes - 1);
    const auto low = std::min(static_cast<std::uint32_t>(position), nodes - 2);
    return At{low, position - static_cast<float>(low)};
  };
  constexpr float kPi = std::numbers::pi_v<float>;
  const At t = place(std::acos(std::clamp(up, -1.0f, 1.0f)) / kPi, kTilts),
           a = place(azimuth / kPi, kAzimuths), c = place(std::sqrt(cos_o), kCosines);
  float sum = 0;
  for (std::uint32_t i = 0; i < 2; ++i)
    for (std::uint32_t j = 0; j < 2; ++j) {
      const float* row = table + ((t.low + i) * kAzimuths + a.low + j) * kCosines + c.low;
      sum +=
          (i == 0 ? 1 - t.f : t.f) * (j == 0 ? 1 - a.f : a.f) * (row[0] + c.f * (row[1] - row[0]));
    }
  return sum;
}

}  // namespace irsig
