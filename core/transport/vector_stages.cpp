#include "core/transport/vector_stages.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/base/clones.h"
#include "core/base/sobol.h"

namespace irsig {

IRSIG_CLONES void draw_pairs(SampleList& list) {
  const std::uint32_t* index = list.index.data();
  const std::uint32_t* seed_x = list.seed_x.data();
  const std::uint32_t* seed_y = list.seed_y.data();
  float* x = list.x.data();
  float* y = list.y.data();
  const std::uint32_t size = list.size;
#pragma GCC ivdep
  for (std::uint32_t i = 0; i < size; ++i) {
    x[i] = unit_float(reverse_bits(scramble_reversed(index[i], seed_x[i])));
    y[i] = unit_float(
        reverse_bits(scramble_reversed(second_coordinate_reversed(index[i]), seed_y[i])));
  }
}

IRSIG_CLONES void draw_pairs_shuffled(SampleList& list) {
  const std::uint32_t* index = list.index.data();
  const std::uint32_t* seed_x = list.seed_x.data();
  const std::uint32_t* seed_y = list.seed_y.data();
  const std::uint32_t* shuffle = list.seed_shuffle.data();
  float* x = list.x.data();
  float* y = list.y.data();
  const std::uint32_t size = list.size;
#pragma GCC ivdep
  for (std::uint32_t i = 0; i < size; ++i) {
    const std::uint32_t k = reverse_bits(scramble_reversed(reverse_bits(index[i]), shuffle[i]));
    x[i] = unit_float(reverse_bits(scramble_reversed(k, seed_x[i])));
    y[i] = unit_float(reverse_bits(scramble_reversed(second_coordinate_reversed(k), seed_y[i])));
  }
}

namespace {

// A 32-bit finaliser without measurable bias. [wellons2018]
__attribute__((always_inline)) inline std::uint32_t hash32(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ (x >> 16);
}

}  // namespace

IRSIG_CLONES void draw_pairs_random(SampleList& list) {
  const std::uint32_t* index = list.index.data();
  const std::uint32_t* seed_x = list.seed_x.data();
  const std::uint32_t* seed_y = list.seed_y.data();
  float* x = list.x.data();
  float* y = list.y.data();
  const std::uint32_t size = list.size;
#pragma GCC ivdep
  for (std::uint32_t i = 0; i < size; ++i) {
    // A stride of its own for each pair of dimensions: no two run through the same counters.
    x[i] = unit_float(hash32(hash32(index[i] * (seed_y[i] | 1u) + seed_x[i]) + seed_y[i]));
    y[i] = unit_float(hash32(hash32(index[i] * (seed_x[i] | 1u) + seed_y[i]) ^ seed_x[i]));
  }
}

IRSIG_CLONES void turn(SampleList& list) {
  const float* y = list.y.data();
  float* cos_y = list.cos_y.data();
  float* sin_y = list.sin_y.data();
  const std::uint32_t size = list.size;
  // sin(2 pi t) for |t| <= 1/4: Taylor's series to x^11 (the next term is below 6e-8).
  const auto sine = [](float t) {
    const float x = 6.28318530718f * t, x2 = x * x;
    return x * (1.0f +
                x2 * (-1.0f / 6 +
                      x2 * (1.0f / 120 +
                            x2 * (-1.0f / 5040 + x2 * (1.0f / 362880 + x2 * (-1.0f / 39916800))))));
  };
#pragma GCC ivdep
  for (std::uint32_t i = 0; i < size; ++i) {
    const float a = y[i] - 0.5f;  // the angle less half a turn
    const float b = std::abs(a);
    const float folded = std::min(b, 0.5f - b);
    cos_y[i] = -sine(0.25f - b);
    sin_y[i] = -std::copysign(sine(folded), a);
  }
}

IRSIG_CLONES void aim(const ImagePlane& plane, const float* x_m, const float* y_m,
                      std::uint32_t size, RayPacket* packet, float* weight, float* inverse_length) {
  const ImagePlane p = plane;
  for (std::uint32_t first = 0; first < size; first += RayPacket::kSize) {
    RayPacket& rays = packet[first / RayPacket::kSize];
#pragma GCC ivdep
    for (std::uint32_t lane = 0; lane < RayPacket::kSize;
         ++lane) {  // the arrays are padded to whole packets
      const float x = x_m[first + lane], y = y_m[first + lane];
      const float u = x * p.inverse_plane_per_m, v = y * p.inverse_plane_per_m;
      const float inverse = 1.0f / std::sqrt(1.0f + u * u + v * v);
      rays.org_x[lane] = p.origin.x + x * p.right.x + y * p.up.x;
      rays.org_y[lane] = p.origin.y + x * p.right.y + y * p.up.y;
      rays.org_z[lane] = p.origin.z + x * p.right.z + y * p.up.z;
      rays.dir_x[lane] = p.forward.x + u * p.right.x + v * p.up.x;
      rays.dir_y[lane] = p.forward.y + u * p.right.y + v * p.up.y;
      rays.dir_z[lane] = p.forward.z + u * p.right.z + v * p.up.z;
      weight[first + lane] = p.scale * inverse * inverse * inverse;
      inverse_length[first + lane] = inverse;
    }
  }
}

namespace {

// exp(-x) for x >= 0, Schraudolph's, within 6 %; 0 below 1e-38. [schraudolph1999]
__attribute__((always_inline)) inline float bell_of(float x) {
  // 2^(-x / ln 2), the mantissa's piece by a straight line
  const float exponent = std::max(126.94f - x * 1.44269504f, 0.0f);
  return std::bit_cast<float>(static_cast<std::int32_t>(exponent * 8388608.0f));
}

// The largest brdf x pi, but for a factor of 2 or so, that such a lobe has towards any point of a
// disk about wi of this radius (small angles). wi + wo is short where wi is nearly -wo (grazing):
// the half vector then turns through many times the disk's radius.
__attribute__((always_inline)) inline float disk_lobe_pi(float nx, float ny, float nz, float ox,
                                                         float oy, float oz, float ix, float iy,
                                                         float iz, float cos_i, float cos_o,
                                                         float m2, float radius) {
  const float hx = ox + ix, hy = oy + iy, hz = oz + iz;
  const float length2 = hx * hx + hy * hy + hz * hz + 1e-12f;
  const float inverse = 1.0f / std::sqrt(length2), turn = radius * inverse;
  const float along = (nx * hx + ny * hy + nz * hz) * inverse;
  const float cos_h = std::min(std::max(along, 0.0f) + turn, 1.0f);
  const float sin_h = std::max(std::sqrt(std::max(1.0f - along * along, 0.0f)) - turn, 0.0f);
  const float cos_d = std::max(0.5f * (length2 * inverse - radius), 1e-3f);
  const float cos2 = std::max(cos_h * cos_h, 1e-6f);
  const float bell = bell_of(sin_h * sin_h / (cos2 * m2));
  const float smaller = std::min(cos_i, cos_o), larger = std::max(cos_i, cos_o);
  const float groove = std::min(2.0f * cos_h / (cos_d * larger), 1.0f / (smaller * larger));
  const float centre2 = std::max(along * along, 1e-6f);
  return 0.25f * bell / (m2 * centre2 * centre2) * groove;
}

// brdf x pi of a Beckmann lobe of slope variance m2 without its reflectance, V-groove masked, for
// unit vectors to the light (wi) and the sensor (wo).
__attribute__((always_inline)) inline float lobe_pi(float nx, float ny, float nz, float ox,
                                                    float oy, float oz, float ix, float iy,
                                                    float iz, float cos_i, float cos_o, float m2) {
  const float hx = ox + ix, hy = oy + iy, hz = oz + iz;
  const float inverse = 1.0f / std::sqrt(hx * hx + hy * hy + hz * hz + 1e-12f);
  const float cos_h = std::max((nx * hx + ny * hy + nz * hz) * inverse, 1e-3f);
  const float cos_d = std::max((ox * hx + oy * hy + oz * hz) * inverse, 1e-3f);
  const float cos2 = cos_h * cos_h;
  const float bell = bell_of((1.0f - cos2) / (cos2 * m2));
  const float smaller = std::min(cos_i, cos_o), larger = std::max(cos_i, cos_o);
  const float groove = std::min(2.0f * cos_h / (cos_d * larger), 1.0f / (smaller * larger));
  return 0.25f * bell / (m2 * cos2 * cos2) * groove;
}

}  // namespace

IRSIG_CLONES void sun_probability(VertexList& vertices, Float3 sun, float inverse_distance_per_m,
                                  float sin_radius, float faint, float* keep) {
  const float* px = vertices.px.data();
  const float* py = vertices.py.data();
  const float* pz = vertices.pz.data();
  const float* nx = vertices.nx.data();
  const float* ny = vertices.ny.data();
  const float* nz = vertices.nz.data();
  const float* ox = vertices.ox.data();
  const float* oy = vertices.oy.data();
  const float* oz = vertices.oz.data();
  const float* cos_o_of = vertices.cos_o.data();
  const float* m2_of = vertices.roughness2.data();
  const std::uint32_t size = vertices.size;
#pragma GCC ivdep
  for (std::uint32_t i = 0; i < size; ++i) {
    const float x = sun.x - px[i] * inverse_distance_per_m;
    const float y = sun.y - py[i] * inverse_distance_per_m;
    const float z = sun.z - pz[i] * inverse_distance_per_m;
    const float nearness = 1.0f / std::sqrt(x * x + y * y + z * z);
    const float ix = x * nearness, iy = y * nearness, iz = z * nearness;
    const float radius = sin_radius * nearness;
    const float towards = nx[i] * ix + ny[i] * iy + nz[i] * iz;
    const float cos_i = std::max(towards, 1e-3f);
    const float m2 = std::max(m2_of[i], 1e-12f);
    const float lobe = disk_lobe_pi(nx[i], ny[i], nz[i], ox[i], oy[i], oz[i], ix, iy, iz, cos_i,
                                    cos_o_of[i], m2, radius);
    const float relative = m2_of[i] > 0.0f ? lobe / faint : 1.0f;
    keep[i] = towards > -radius ? std::min(relative, 1.0f) : 0.0f;
  }
}

IRSIG_CLONES void hot_rate(const VertexList& vertices, Float3 centre, float radius_m, float area_m2,
                           float faint, float* rate) {
  const float* px = vertices.px.data();
  const float* py = vertices.py.data();
  const float* pz = vertices.pz.data();
  const float* nx = vertices.nx.data();
  const float* ny = vertices.ny.data();
  const float* nz = vertices.nz.data();
  const float* ox = vertices.ox.data();
  const float* oy = vertices.oy.data();
  const float* oz = vertices.oz.data();
  const float* cos_o_of = vertices.cos_o.data();
  const float* m2_of = vertices.roughness2.data();
  const std::uint32_t size = vertices.size;
  const float radius2 = radius_m * radius_m, inverse_faint = 1.0f / faint;
  const float area_pi = area_m2 * 0.318309886f;
#pragma GCC ivdep
  for (std::uint32_t i = 0; i < size; ++i) {
    const float x = centre.x - px[i], y = centre.y - py[i], z = centre.z - pz[i];
    const float distance2 = x * x + y * y + z * z + 1e-20f;
    const float inverse = 1.0f / std::sqrt(distance2);
    const float ix = x * inverse, iy = y * inverse, iz = z * inverse;
    // The bounding sphere's half angle; a right angle from within.
    const float sin2 = std::min(radius2 * inverse * inverse, 1.0f), sine = std::sqrt(sin2);
    const float gap = std::max(distance2 * inverse - radius_m, 1e-6f * radius_m);
    // Solid angle / pi: the sphere's, or what its triangles can fill of it.
    const float angle = std::min(2.0f * (1.0f - std::sqrt(1.0f - sin2)), area_pi / (gap * gap));
    const float towards = nx[i] * ix + ny[i] * iy + nz[i] * iz;
    const float cos_i = std::min(std::max(towards + sine, 1e-3f), 1.0f);
    const float m2 = std::max(m2_of[i] + sin2, 1e-12f);
    const float lobe =
        lobe_pi(nx[i], ny[i], nz[i], ox[i], oy[i], oz[i], ix, iy, iz, cos_i, cos_o_of[i], m2);
    const float share = angle * cos_i * inverse_faint * (m2_of[i] > 0.0f ? lobe : 1.0f);
    rate[i] = towards + sine > 0.0f ? std::min(share, 1.0f) : 0.0f;
  }
}

}  // namespace irsig
