#pragma once

// The working memory of PathTracer::trace, shared by its two sources.

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "core/environment/sea/sea_glint.h"
#include "core/transport/hot_lights.h"
#include "core/transport/path_tracer.h"
#include "core/transport/vector_stages.h"

namespace irsig {

// Pairs of random numbers at each vertex, by what they are for.
enum VertexPair : std::uint32_t {
  kSunPoint,   // on the sun's disk
  kRoulettes,  // x: whether the path goes on, y: whether the sun is followed up, 1 - y: whether
               // a hot light is, which one and which of its clusters
  kDirection,
  kLobe,         // x: which lobe the direction is drawn from
  kHotPoint,     // on a hot triangle
  kHotTriangle,  // x: which one
  kPairsPerVertex
};

inline Float3 to_float(Vec<Body> v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// Computes an orthonormal pair across a unit vector. [duff2017]
inline void orthonormal_basis(Float3 n, Float3& b1, Float3& b2) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z);
  const float b = n.x * n.y * a;
  b1 = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
  b2 = {b, sign + n.y * n.y * a, -n.y};
}

// A sun (or lamp) as a flat disk across the line from the target's centre.
struct Sun {
  Float3 direction, tangent1, tangent2;  // tangents scaled by the disk's radius
  float sin_radius, tan2_radius;
  float inverse_distance_per_m;  // 0: at infinity
  float inverse_area_per_sr;     // 1 / (pi tan^2 radius)
  // Lobes this narrow (rms slope) find the disk by drawn directions too.
  float narrow_slope;
  float horizon_z;  // directions that fall more steeply have set

  // Towards a point of the disk, (a, b) in the unit circle, or where a direction meets the disk.
  struct Light {
    Float3 direction;
    float irradiance;      // relative to that at the target's centre
    float density_per_sr;  // of this direction among those towards uniform points of the disk
  };
  [[nodiscard]] Light towards(Float3 from, float a, float b) const {
    const Float3 d{direction.x + a * tangent1.x + b * tangent2.x - from.x * inverse_distance_per_m,
                   direction.y + a * tangent1.y + b * tangent2.y - from.y * inverse_distance_per_m,
                   direction.z + a * tangent1.z + b * tangent2.z - from.z * inverse_distance_per_m};
    const float inverse2 = 1.0f / dot(d, d), inverse = std::sqrt(inverse2);
    const Float3 wi{d.x * inverse, d.y * inverse, d.z * inverse};
    const float along = std::abs(dot(wi, direction));
    return {wi, inverse_distance_per_m > 0 ? inverse2 : 1.0f,
            inverse_area_per_sr / (inverse2 * along)};
  }
  // Returns true if a ray meets the disk (if nothing is in between).
  [[nodiscard]] bool met_by(Float3 from, Float3 wi, Light& light) const {
    const float along = dot(wi, direction);
    if (along <= 0) return false;
    const Float3 o{from.x * inverse_distance_per_m, from.y * inverse_distance_per_m,
                   from.z * inverse_distance_per_m};
    const float t = (1.0f - dot(o, direction)) / along;
    if (t <= 0) return false;
    const Float3 q{o.x + t * wi.x - direction.x, o.y + t * wi.y - direction.y,
                   o.z + t * wi.z - direction.z};
    if (dot(q, q) > tan2_radius) return false;
    light = {wi, inverse_distance_per_m > 0 ? 1.0f / (t * t) : 1.0f,
             inverse_area_per_sr * t * t / along};
    return true;
  }
};

// Computes half vector and cosines of a reflection from wi to wo, unit vectors, at a facet of
// normal n. cos_d is half the length of wi + wo: a product with wo would cancel where wi is nearly
// -wo (grazing).
inline Reflection reflection(Float3 n, Float3 wi, Float3 wo, float cos_i, float cos_o) {
  const Float3 h{wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
  const float length2 = std::max(dot(h, h), 1e-12f);
  const float inverse2 = 1.0f / length2, inverse = std::sqrt(inverse2);
  const float along = dot(n, h);
  const Float3 tangential{h.x - along * n.x, h.y - along * n.y, h.z - along * n.z};
  return {std::min(cos_i, 1.0f), cos_o, along * inverse, dot(tangential, tangential) * inverse2,
          std::min(0.5f * std::sqrt(length2), 1.0f)};
}

// Returns the seeds of one pixel. Without seeds of their own, pixels whose numbers differ by a
// power of two would have nearly the same points, and their errors would not be independent: an
// edge along a column of 64 x 64 pixels was off by as much in each of them.
[[nodiscard]] inline SeedPair of_pixel(SeedPair seed, std::uint32_t pixel) {
  const std::uint64_t a = mix64(pixel);
  const auto low = static_cast<std::uint32_t>(a), high = static_cast<std::uint32_t>(a >> 32);
  return {seed.x ^ low, seed.y ^ high, seed.shuffle ^ (low * 0x9e3779b1u + high)};
}

// Rows of pictures are traced from below and stored from above.
inline std::size_t stored_pixel(const ImagePlan& plan, std::size_t traced) {
  return (plan.height_px - 1 - traced / plan.width_px) * plan.width_px + traced % plan.width_px;
}

// Samples of one pixel and part become one entry; in order.
void join_met(std::vector<TracedPictures::Met>& met);

struct PathTracer::Work {
  const ImagePlan* plan;
  TracedPictures* pictures;
  PathCounts* counts;
  // Pictures: of the pixels whose samples are being traced, in the order of tracing.
  std::uint32_t first_pixel = 0;
  std::vector<double> group_sum;         // [pixel][group][kind][ImagePlan::padded]
  std::vector<double> sum_of_group;      // [group] of the pixel and picture being closed
  std::vector<double> part_of_group;     // [group] likewise of one kind of light
  std::vector<TracedPictures::Met> met;  // one for each sample of the batch that met the target
  // First hits of the batch that may be in the sun: the pixel as stored, and where shadow rays
  // start.
  struct FirstHit {
    std::size_t pixel;
    Float3 from, normal;
  };
  std::vector<FirstHit> first_hit;
  std::vector<std::size_t> first_shadow_pixel;
  RayBatch first_shadow;
  // Rays that go on behind what they have met.
  struct Through {
    std::uint32_t ray, triangle;  // of the batch; met last
    float step_m;
  };
  std::vector<Through> through;
  RayBatch through_batch;
  std::vector<std::uint64_t> met_parts;  // [ray of the batch][part / 64], a bit for each
  std::map<std::vector<std::uint32_t>, std::uint32_t> place_of_set;
  std::vector<Sun> sun;
  std::uint32_t capacity = 0;           // primary rays of a batch
  std::uint32_t most = 0;               // after splitting
  std::uint32_t orders = 1;             // tables of weights of one replicate
  std::vector<SourceWeights> weight;    // [replicate][order], of the current stratum
  std::vector<SourceWeights> last;      // [replicate]: those of the last order alone
  std::vector<double> area;             // [replicate]
  std::vector<double> background_area;  // [replicate]
  std::vector<double> hidden_area;      // [replicate]
  // Weights of primary rays for which the mean of what is behind the target stands in, and how many
  // samples of each replicate have what they meet themselves.
  std::vector<double> mean_behind;  // [replicate][part]
  std::uint32_t behind_samples = 0;
  float behind_scale = 1;                   // what such a sample stands for
  std::vector<double> beyond;               // [replicate][order]: PathWeights::beyond_order_m2
  std::vector<double> gas;                  // [replicate][..]: PathWeights::gas_m2
  std::vector<double> gas_nodes, gas_seen;  // [replicate][..]: of the same names
  std::vector<double> gas_measure;          // [measure]
  // Absorbed fraction of the light behind the gas: [primary ray of the batch][class]; for gas
  // around the target [ray that has met some][class].
  std::vector<float> gas_fraction;
  std::size_t gas_fractions = 0;  // of gas around the target: so many are kept
  float area_per_sample = 0;  // m2 on the image plane: the inverse of the stratum's sample density
  std::vector<std::uint64_t> stratum_seed;  // [replicate]
  std::vector<SeedPair> seeds;              // [order < kSeedOrders][replicate][pair]
  std::vector<SeedPair> late_seeds;         // [replicate][pair], of one later order
  std::uint32_t stratum = 0;
  RayBatch batch, next;
  std::vector<RayBatch> shadow;      // one for each sun
  RayBatch hot_shadow;               // to the hot lights
  std::vector<SourceId> hot_source;  // of which emitters
  RayBatch glint_shadow;             // from the sea to suns that it mirrors
  std::vector<std::uint32_t> glint_sun;
  std::vector<GlintShare> glint_at;
  // Land: what it is where the last ray met it; and rays to suns from there, with
  // the sun, the range and the fractions of each, [ray][material].
  LandMix land_mix;
  RayBatch land_shadow;
  std::vector<std::uint32_t> land_sun;
  std::vector<Land::RangeShare> land_range;
  std::vector<float> land_fractions;
  std::vector<float> row;  // a spectrum being made
  SampleList list;         // random numbers being drawn
  std::vector<std::uint32_t> replicate_of_list, pixel_of_list;
  std::vector<float> x_m, y_m, ray_weight, density_factor, inverse_length;
  VertexList vertex;
  std::vector<float> roulette_x, roulette_y, lobe;
  std::vector<float> sun_keep;             // [sun][vertex]: how often it is followed up
  std::vector<float> hot_rate;             // [light][vertex]: how often it is aimed at
  std::vector<float> hot_total, hot_pick;  // [vertex]
  std::vector<std::uint32_t> hot_light;
  std::vector<std::uint32_t> child_sample;
  std::vector<float> ones;  // a spectrum
  std::vector<std::uint32_t> chosen;
};

// Returns the pixel of a path, in the order of tracing.
inline std::uint32_t PathTracer::pixel_of(const Work& work, const PathState& path) const {
  return work.first_pixel + path.pixel_group / pixel_groups(settings_.pixel_samples);
}

// Where pictures add up a source's light of a path: a number for each picture.
inline double* PathTracer::image_of(Work& work, const PathState& path, SourceId source) {
  const ImagePlan& plan = *work.plan;
  return image_of(work, path, plan.kind.empty() ? std::uint8_t{0} : plan.kind[index_of(source)]);
}
inline double* PathTracer::image_of(Work& work, const PathState& path, std::uint8_t kind) {
  const ImagePlan& plan = *work.plan;
  return work.group_sum.data() +
         (static_cast<std::size_t>(path.pixel_group) * plan.kinds + kind) * plan.padded;
}

// visit(first part of the tables of weights, share of the path's weight)
template <typename Visit>
inline void PathTracer::for_each_first(const Work& work, const PathState& path,
                                       Visit&& visit) const {
  if (gas_ == nullptr && gas_around_ == nullptr) return visit(path.first, 1.0f);
  // Around the target what has met no gas does not count.
  if (gas_ == nullptr && path.first < parts_) return;
  const std::uint32_t classes = (gas_ != nullptr ? gas_ : gas_around_)->classes();
  const std::uint32_t ray = gas_ != nullptr ? path.first >> 1 : path.first - parts_,
                      beyond = gas_ != nullptr ? (path.first & 1) * classes : 0;
  const float* share = work.gas_fraction.data() + static_cast<std::size_t>(ray) * classes;
  for (std::uint32_t k = 0; k < classes; ++k)
    if (share[k] != 0) visit(beyond + k, share[k]);
}

template <bool kSpectral>
inline void PathTracer::add(Work& work, const PathState& path, std::uint32_t order, SourceId source,
                            float weight, const float* spectrum) const {
  for_each_first(work, path, [&](std::uint32_t first, float share) {
    add_to<kSpectral>(work, path, first, order, source, share * weight, spectrum);
  });
}

template <bool kSpectral>
inline void PathTracer::add_to(Work& work, const PathState& path, std::uint32_t first,
                               std::uint32_t order, SourceId source, float weight,
                               const float* spectrum) const {
  const ImagePlan& plan = *work.plan;
  double* out = work.weight[path.replicate * work.orders + (settings_.by_order ? order : 0)].row(
      first, source);
  const bool is_last = order == settings_.max_reflections && !work.last.empty();
  double* image = plan.empty() ? nullptr : image_of(work, path, source);
  const std::size_t place =
      index_of(source) + (gas_ != nullptr ? static_cast<std::size_t>(first) * layout_.count() : 0);
  if constexpr (kSpectral) {
    for (std::size_t i = 0; i < nodes_; ++i) out[i] += static_cast<double>(weight * spectrum[i]);
    if (is_last) {
      double* last = work.last[path.replicate].row(first, source);
      for (std::size_t i = 0; i < nodes_; ++i) last[i] += static_cast<double>(weight * spectrum[i]);
    }
    if (image == nullptr) return;
    const float* shown = plan.source.data() + place * plan.images * nodes_;
    for (std::uint32_t k = 0; k < plan.images; ++k, shown += nodes_) {
      float sum = 0;
      for (std::size_t i = 0; i < nodes_; ++i) sum += spectrum[i] * shown[i];
      image[k] += static_cast<double>(work.area_per_sample * weight * sum);
    }
  } else {
    *out += static_cast<double>(weight);
    if (is_last) *work.last[path.replicate].row(first, source) += static_cast<double>(weight);
    if (image == nullptr) return;
    const float* shown = plan.source.data() + place * plan.padded;
    const float w = work.area_per_sample * weight;
    for (std::uint32_t k = 0; k < plan.padded; ++k) image[k] += static_cast<double>(w * shown[k]);
  }
}

}  // namespace irsig
