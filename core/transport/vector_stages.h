#pragma once

#include <cstdint>
#include <vector>

#include "core/scene/trace/tracer.h"
#include "core/transport/ray_batch.h"

namespace irsig {

// The stages of the path tracer that are the same arithmetic on every ray: plain loops over arrays,
// compiled for several instruction sets. All operations are exactly rounded and never fused, so
// that the choice does not change a bit.

// Sample pairs for a list of paths.
struct SampleList {
  std::vector<std::uint32_t> index, seed_x, seed_y, seed_shuffle;
  std::vector<float> x, y;
  std::vector<float> cos_y, sin_y;  // of the angle 2 pi y
  std::uint32_t size = 0;
  void resize(std::uint32_t capacity) {
    for (auto* v : {&index, &seed_x, &seed_y, &seed_shuffle}) v->resize(capacity);
    x.resize(capacity);
    y.resize(capacity);
    cos_y.resize(capacity);
    sin_y.resize(capacity);
  }
};
void draw_pairs(SampleList& list);           // as sobol_pair
void draw_pairs_shuffled(SampleList& list);  // as sobol_pair_shuffled
// Draws independent numbers instead of either, hashed from the index and the seeds x and y.
// [wellons2018]
void draw_pairs_random(SampleList& list);
// Fills cos_y and sin_y; |error| < 3e-7 (tests/physics/sampling_test.cpp).
void turn(SampleList& list);

// Primary rays through points (x_m, y_m) of the image plane: writes packets, weights (scale (1 +
// u^2 + v^2)^(-3/2)) and inverse lengths of the directions.
struct ImagePlane {
  Float3 origin, right, up, forward;  // origin: the sensor's foot on the plane
  float inverse_plane_per_m, scale;
};
void aim(const ImagePlane& plane, const float* x_m, const float* y_m, std::uint32_t size,
         RayPacket* packet, float* weight, float* inverse_length);

// Vertices at which a path may go on: position (off the surface), normal, direction back to the
// sensor.
struct VertexList {
  std::vector<float> px, py, pz, nx, ny, nz, ox, oy, oz, cos_o, roughness2, survival;
  std::vector<std::uint32_t> path;  // index in the batch
  std::vector<std::uint32_t> material;
  std::uint32_t size = 0;
  void resize(std::uint32_t capacity) {
    for (auto* v : {&px, &py, &pz, &nx, &ny, &nz, &ox, &oy, &oz, &cos_o, &roughness2, &survival})
      v->resize(capacity);
    path.resize(capacity);
    material.resize(capacity);
  }
};

// Computes the probability with which a sun contribution is followed up: about brdf / (faint x
// diffuse brdf), at most 1; 0 where the sun's disk is below the facet's plane. Any positive value
// is unbiased; this one follows the point of the disk whose half vector is nearest to the normal,
// so that no point is much brighter than the probability implies, and it underflows to 0 only where
// the lobe does.
//   roughness2: m^2 of a Beckmann lobe, 0: diffuse.
//   inverse_distance_per_m: 0 for the sun, else of a lamp in that direction from the origin
void sun_probability(VertexList& vertices, Float3 sun, float inverse_distance_per_m,
                     float sin_radius, float faint, float* keep);

// Computes the expected number of rays aimed at a hot light within a bounding sphere: about the
// light's fraction of the vertex's reflection (brdf x solid angle x cos, as if it filled its sphere
// or all its area faced the vertex) / faint, at most 1; 0 only if the light is below the facet's
// plane or far outside a narrow lobe.
void hot_rate(const VertexList& vertices, Float3 centre, float radius_m, float area_m2, float faint,
              float* rate);

}  // namespace irsig
