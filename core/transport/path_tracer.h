#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/materials/material.h"
#include "core/scene/target.h"
#include "core/transport/cell_order.h"
#include "core/transport/primary_rays.h"
#include "core/transport/ray_batch.h"

namespace irsig {

// Where a path ends. The classes of one first-hit part f are stored side by side:
//   own            emitted by f itself (no reflection)
//   part(q)        emitted by part q, reflected towards the sensor (last of all) by f
//   sky, lower     from above and below the horizon
//   sun(j)         direct sun j, per unit irradiance normal to the beam
struct SourceClasses {
  std::uint32_t parts = 0, suns = 0;
  [[nodiscard]] std::uint32_t own() const { return 0; }
  [[nodiscard]] std::uint32_t part(std::uint32_t q) const { return 1 + q; }
  [[nodiscard]] std::uint32_t sky() const { return 1 + parts; }
  [[nodiscard]] std::uint32_t lower() const { return 2 + parts; }
  [[nodiscard]] std::uint32_t sun(std::uint32_t j) const { return 3 + parts + j; }
  [[nodiscard]] std::uint32_t count() const { return 3 + parts + suns; }
};

struct SunDirection {
  Vec<Body> direction;  // unit vector towards the sun's centre
  double angular_radius_rad;
};

// What the paths are accumulated into pictures with: `images` in-band pictures of width x height
// pixels over the view's bounding rectangle. source[(f * classes + c) * padded + i] is what a unit
// weight of class (f, c) adds to picture i: an in-band radiance for grey materials. With spectral
// materials it has a further index, the node: a weight at each node.
struct ImagePlan {
  std::uint32_t width_px = 0, height_px = 0;
  std::uint32_t images = 0, padded = 0;  // padded: images rounded up to a multiple of 8
  std::vector<float> source;
  bool empty() const { return images == 0 || width_px == 0; }
};

struct PathSettings {
  std::uint32_t max_reflections = 3;
  bool lower_is_sea = false;  // a point below z = 0 is under water: what is met there is the sea
  double sea_z_m = 0;         // the waterline in coordinates relative to the centre (body z, down)
  double earth_radius_m = 0;  // > 0: the sea's curvature hides what lies behind it (primary rays)
  std::uint64_t seed = 0;     // of the job; replicates derive theirs from it
  std::uint64_t samples = 0;  // primary samples of the main stratum, each replicate
  std::uint32_t replicates = 32;
  std::uint32_t split = 1;  // rays that go on from a first vertex of DHR 1 (a power of two)
};

// The weights of one replicate: intensity = sum over (f, c) of weight x source radiance of (f, c).
// [m^2] Grey: one number for each (f, c). Spectral: one for each (f, c, node).
struct PathWeights {
  std::vector<double> weight;
  double projected_area_m2 = 0;
  double truncated_m2 =
      0;  // throughput of the paths that were still alive after the last reflection
};

struct PathCounts {
  std::uint64_t samples = 0, target_paths = 0, rays = 0;
  std::uint64_t guarded_backface_hits = 0, guarded_nonfinite = 0, guarded_path_limit = 0;
};

// Reverse Monte Carlo from one viewpoint: traced once, shaded for any number of conditions.
// (docs/methods.md)
//
//   I = sum over strata of  area / n * sum over rays of  (range / plane)^2 (1 + r^2 /
//   plane^2)^(-3/2) L
//
// (area: what the stratum's mask covers of the image plane; r: distance of the ray's point on it
// from the axis.)
//
// A path starts at the sensor, meets the target, and at each reflection goes on in one direction
// drawn from the material's lobe with probability dhr_max x throughput (Russian roulette,
// unbiased); from the first vertex in `split` directions. At each vertex the sun's disk is sampled
// (next-event estimation); a faint contribution is itself played by roulette, unbiased, before its
// shadow ray is traced. After reflection N = max_reflections the surface hit still emits, nothing
// more.
//
// Random numbers: pair 0 aims the primary ray; vertex k uses pairs 1+3k (sun's disk), 2+3k
// (roulettes), 3+3k (direction). They depend on the seed, the replicate, the stratum and the sample
// alone: conditions, bands and suns share them.
class PathTracer {
 public:
  PathTracer(const Target& target, std::span<const Material> materials, const AimedView& view,
             std::vector<SunDirection> suns, PathSettings settings);

  [[nodiscard]] const SourceClasses& classes() const { return classes_; }
  [[nodiscard]] bool spectral() const { return spectral_; }
  [[nodiscard]] std::size_t nodes() const { return nodes_; }  // 1 if grey

  // Traces all replicates, side by side: rays of different replicates that are aimed at the same
  // small piece of the image share a packet. image (if the plan is not empty) has width x height x
  // padded floats, to which radiance x solid angle x range^2 [W/sr], summed over replicates, is
  // added.
  std::vector<PathWeights> trace(const ImagePlan& plan, std::vector<float>& image,
                                 PathCounts& counts) const;

 private:
  struct Work;
  [[nodiscard]] std::uint64_t stratum_samples(std::uint32_t stratum) const;
  template <bool kSpectral>
  void trace_stratum(Work& work, std::uint32_t stratum) const;
  template <bool kSpectral>
  void trace_batch(Work& work) const;
  void aim_batch(Work& work, const CoverageMask& mask) const;
  template <bool kSpectral>
  void arrive(Work& work, std::uint32_t order) const;
  template <bool kSpectral>
  void depart(Work& work, std::uint32_t order) const;
  [[nodiscard]] bool hidden_by_sea(Float3 p, Float3 d, float inverse_length) const;
  template <bool kSpectral>
  void add(Work& work, const PathState& path, std::uint32_t source_class, float weight,
           const float* spectrum) const;
  template <bool kSpectral>
  void trace_shadows(Work& work) const;

  const Target& target_;
  std::span<const Material> materials_;
  std::vector<SunDirection> suns_;
  PathSettings settings_;
  SourceClasses classes_;
  bool spectral_ = false;
  std::size_t nodes_ = 1;
  const AimedView& view_;
};

}  // namespace irsig
