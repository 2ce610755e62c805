#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/materials/material.h"
#include "core/scene/trace/target.h"
#include "core/sources/source_geometry.h"
#include "core/sources/source_layout.h"
#include "core/sources/source_weights.h"
#include "core/transport/cell_order.h"
#include "core/transport/hot_lights.h"
#include "core/transport/primary_rays.h"
#include "core/transport/ray_batch.h"
#include "core/transport/traced_pictures.h"

namespace irsig {

// A hot light is aimed at with a probability of its share of what a vertex reflects / this (up to
// 1): aiming divides the variance that the light causes by about as much. Variance x CPU time of a
// 450 K sphere that fills 0.1 % of the hemisphere of a plate, by chance / with 0.3, 0.1, 0.03,
// 0.01: 7, 25, 58, 178 (diffuse); 18, 58, 157, 374 (hull). On the frigate, where the error is that
// of the places near the funnel, 0.1 and 0.03 are best, and CPU time is 1.15 and 1.25 times that
// without.
inline constexpr float kFaintHot = 0.03f;

// The sun's disk is found by drawn directions too where a lobe's rms slope m is below this many
// radii of the disk. Variance of a sphere in the sun by aimed rays alone / by both: 93, 3.5, 1.15,
// 1.00 at m = 3e-4, 1e-3, 3e-3, 0.01 (0.06, 0.2, 0.6, 2.2 radii); 0.8 and 0.7 at 0.02 and 0.03.
inline constexpr float kNarrowRadii = 2.0f;

// The pictures into which paths are accumulated: `images` in-band pictures of width x height pixels
// over a rectangle of the view's image plane. source[id * padded + i] is the contribution of a unit
// weight of a source to picture i: an in-band radiance for grey materials. With spectral materials
// it is source[(id * images + i) * nodes + node]: a weight at each node. Behind hot gas the table
// holds each class of the gas, one after another, and gas[i * measures + m] is the contribution of
// a unit of a measure: an in-band radiance.
struct ImagePlan {
  std::uint32_t width_px = 0, height_px = 0;
  std::uint32_t images = 0, padded = 0;  // padded: images rounded up to a multiple of 8
  PlaneRectangle rectangle;
  std::vector<float> source;
  std::vector<double> gas;
  // Kinds of light whose sums are kept apart: of each source which. Empty: all are one kind.
  std::uint32_t kinds = 1;
  std::vector<std::uint8_t> kind;  // [source]
  std::uint8_t gas_kind = 0;       // of what hot gas emits
  bool behind = false;             // whether sources behind the target are shown
  // Values to be averaged over what a pixel shows, with the distance: [emitter][value].
  bool first_hits = false;
  std::size_t values = 0;
  std::vector<float> of_emitter;
  // With them, if asked for: the unit normal on the side of the ray, and whether the target lets
  // light through from each of these directions towards a sun (body frame, unit vectors).
  bool normals = false;
  std::vector<Vec<Body>> towards_sun;
  // Numbers of a pixel's first hits: distance, values, normal, sunlit by each sun.
  [[nodiscard]] std::size_t first_numbers() const {
    return 1 + values + (normals ? 3 : 0) + towards_sun.size();
  }
  bool whole_parts = false;  // whether rays go on to the parts behind the first one
  bool empty() const { return images == 0 || width_px == 0; }
  [[nodiscard]] std::size_t pixels() const { return std::size_t{width_px} * height_px; }
  // Numbers of all pictures, [pixel][images].
  [[nodiscard]] std::size_t size() const { return empty() ? 0 : pixels() * images; }
};

struct PathSettings {
  std::uint32_t max_reflections = 3;
  std::uint64_t seed = 0;     // of the job; replicates derive theirs from it
  std::uint64_t samples = 0;  // primary samples of the main stratum, each replicate
  std::uint32_t replicates = 32;
  std::uint32_t split = 1;  // rays that go on from a first vertex of DHR 1 (a power of two)
  // A path goes on with probability min(1, roulette_survival_scale x throughput x DHR): above 1,
  // paths whose throughput is small are followed for longer (less scatter from roulette, more
  // rays).
  double roulette_survival_scale = 1;
  bool by_order = false;  // weights are kept apart by the number of reflections
  // PathWeights::last is kept also where there are fewer than two reflections, of which no series
  // can be made.
  bool always_last = false;
  // Primary rays that miss the target end in the sky or below the horizon, as a first "part" of
  // their own behind the target's parts.
  bool background = false;
  // Off: hot parts and the sun's disk are found as they were before lights were weighted against
  // drawn directions (hot parts by chance, the sun by aimed rays only). For comparisons.
  bool hot_lights = true, sun_disk_by_chance = true;
  // Independent random numbers instead of scrambled Sobol points. For comparisons.
  bool pseudo_random = false;
  // Primary samples of each pixel of the pictures, a power of two of at least 2,
  // stratified over the pixel; needs a view of one stratum (whole_view), one replicate and
  // pictures. 0: samples of the view's strata, and no pictures.
  std::uint32_t pixel_samples = 0;
  // The one stratum of the view to be traced; absent: all strata.
  std::optional<std::uint32_t> only_stratum = std::nullopt;
  // True if no ray that leaves the target can meet it again (Target::convex): none is traced.
  bool skip_self_intersection = false;
};

// The weights of one replicate: intensity = sum over first parts and sources of weight x the
// source's radiance. [m^2]
struct PathWeights {
  SourceWeights weight;
  std::vector<SourceWeights> of_order;  // with by_order instead, [0 .. max_reflections]
  // Contribution of paths of exactly max_reflections reflections: part of `weight`. Empty if that
  // is fewer than two, unless PathSettings::always_last.
  SourceWeights last;
  double projected_area_m2 = 0;
  // Beside it: of one-sided facets that primary rays met from behind, which send nothing.
  double background_area_m2 = 0;
  // Beside both: of the target where land or the Earth hides it.
  double hidden_area_m2 = 0;
  // Throughput that goes on after N - 2 s, N - s and N reflections (N = max_reflections, s =
  // beyond_spacing(N); 0 where there is no such number). The last is lost. Spectral: of each path
  // the largest spectral factor times the largest DHR, not less than the throughput at any node.
  std::array<double, 3> beyond_m2{};
  double truncated_m2 = 0;  // = beyond_m2[2]
  // Throughput beyond each number of reflections 0 .. N.
  std::vector<double> beyond_order_m2;
  // Through hot gas (HotGasMedium): the sums of its measures. Other rays then count nowhere, and
  // first "parts" are, by the class of the gas, what is behind it of the target (0 .. classes - 1)
  // and beyond (classes .. 2 classes - 1).
  // Gas around the target (HotGasAround): the sums of the measures of gas that is reflected by each
  // part seen first, [part][measure], and first "parts" are its classes, of light that came through
  // it; other paths count nowhere. What a path meets beyond the first gas emits nothing.
  std::vector<double> gas_m2;
  // Gas around the target: what `weight` is of one number for a path, this is of what it carries at
  // each node; both weighted with how much the gas shows. [part][node]; [part]
  std::vector<double> gas_nodes_m2, gas_seen_m2;
};

[[nodiscard]] constexpr std::uint32_t beyond_spacing(std::uint32_t max_reflections) {
  return max_reflections < 6 ? 1 : max_reflections / 3;
}

// Guarded events are numbers that should not occur; nothing of them enters the result.
struct PathCounts {
  std::uint64_t samples = 0, target_paths = 0, rays = 0;
  // Numbers of rays by kind: rays that look for a second hit (or would), and rays aimed at suns,
  // from the sea at suns, at hot parts. The remaining rays are primary.
  std::uint64_t reflected_rays = 0, sun_rays = 0, glint_rays = 0, hot_rays = 0;
  std::uint64_t guarded_backface_hits = 0;     // a one-sided facet met from behind
  std::uint64_t silhouette_backface_hits = 0;  // of these: by primary rays
  std::uint64_t guarded_nonfinite = 0;         // a weight that is NaN or infinite
  std::uint64_t guarded_negative = 0;          // a weight below zero
  std::uint64_t truncated_paths = 0;           // alive after max_reflections: ordinary
};

// Reverse Monte Carlo from one viewpoint: traced once, shaded for any number of conditions.
// (docs/explanation/methods.md)
//
//   I = sum over strata of  area / n * sum over rays of  (range / plane)^2 (1 + r^2 /
//   plane^2)^(-3/2) L
//
// (area: what the stratum's mask covers of the image plane; r: distance of the ray's point on it
// from the axis.)
//
// A path starts at the sensor, meets the target, and at each reflection goes on in one direction
// drawn from the material's lobe with probability dhr_max x throughput (Russian roulette,
// unbiased); from the first vertex in `split` directions. At each vertex the sun's disk and the hot
// parts are aimed at (next-event estimation); a faint contribution is itself played by roulette,
// unbiased, before its shadow ray is traced. A path that ends on a sea which mirrors a sun sends a
// shadow ray from there to the sun: glitter is smooth, so that drawn directions find it, and both
// of its legs are shadowed. Where a drawn direction could have found the same
// light - any hot part; the sun's disk from a facet with a lobe not much wider than it - the two
// are weighted by the balance heuristic [veach1995]. After reflection N = max_reflections the
// surface hit still emits, nothing more.
//
// Random numbers: pair 0 aims the primary ray; vertex k uses pairs 1+6k .. 6+6k (path_work.h). They
// depend on the seed, the replicate, the stratum and the sample alone: conditions, bands and suns
// share them, and no ray of a path depends on a sun.
class PathTracer {
 public:
  // target, materials and view outlive it.
  PathTracer(const Target& target, std::span<const Material> materials, const AimedView& view,
             SourceGeometry sources, PathSettings settings);

  // Layout of the weights by source.
  [[nodiscard]] const SourceLayout& layout() const { return layout_; }
  [[nodiscard]] bool spectral() const { return spectral_; }
  [[nodiscard]] std::size_t nodes() const { return nodes_; }  // columns of weights: 1 if grey
  // Returns the number of first parts in a table of weights: with PathSettings::background one more
  // than parts; behind gas see PathWeights::gas_m2.
  [[nodiscard]] std::uint32_t firsts() const {
    if (gas_ != nullptr) return 2 * gas_->classes();
    if (gas_around_ != nullptr) return gas_around_->classes();
    return parts_ + (settings_.background ? 1 : 0);
  }

  // Traces all replicates, side by side: rays of different replicates that are aimed at the same
  // small piece of the image share a packet.
  std::vector<PathWeights> trace(PathCounts& counts) const;
  // Traces into pictures, too (PathSettings::pixel_samples).
  std::vector<PathWeights> trace(const ImagePlan& plan, TracedPictures& pictures,
                                 PathCounts& counts) const;

 private:
  struct Work;
  template <bool kSpectral>
  void trace_stratum(Work& work, std::uint32_t stratum) const;
  template <bool kSpectral>
  void trace_batch(Work& work) const;
  template <bool kSpectral>
  void trace_pixels(Work& work, SeedPair aim) const;
  void close_pixels(Work& work, std::uint32_t end) const;
  template <bool kSpectral>
  void trace_listed(Work& work) const;
  // Returns the area of the image plane that one sample of a replicate stands for. [m2]
  [[nodiscard]] double sample_m2(const ImagePlan& plan, std::uint32_t stratum) const;
  void aim_batch(Work& work) const;
  void cross_gas(Work& work) const;
  template <bool kSpectral>
  void cross_gas_around(Work& work) const;
  [[nodiscard]] bool meets_gas_around(Work& work, Float3 from, Float3 direction, double end,
                                      PathState& path) const;
  [[nodiscard]] PathState background_gas_around(Work& work, RayBatch& batch, std::uint32_t i,
                                                double end) const;
  // Traces the rays of work.batch to their ends: its stages, in their order.
  template <bool kSpectral>
  void arrive(Work& work, std::uint32_t order) const;
  struct Arrivals;
  struct Ray;
  struct Hit;
  enum class Met : std::uint8_t { kTarget, kAbove, kBelow, kNothing };
  [[nodiscard]] Met find_hit(const Arrivals& all, Work& work, const Ray& ray, Hit& hit) const;
  template <bool kSpectral>
  void end_beyond(const Arrivals& all, Work& work, const Ray& ray, bool above) const;
  void begin_path(Work& work, const Ray& ray, const Hit& hit) const;
  [[nodiscard]] float unaimed_weight(const Work& work, const Ray& ray, const Hit& hit) const;
  template <bool kSpectral>
  void add_emission(const Arrivals& all, Work& work, const Ray& ray, const Hit& hit) const;
  void list_vertex(const Arrivals& all, Work& work, const Ray& ray, const Hit& hit) const;
  template <bool kSpectral>
  void depart(Work& work, std::uint32_t order) const;
  template <bool kSpectral>
  void aim_at_suns(Work& work, std::uint32_t order) const;
  template <bool kSpectral>
  void aim_at_hot_lights(Work& work, std::uint32_t order) const;
  template <bool kSpectral>
  void draw_directions(Work& work, std::uint32_t order) const;
  void draw_vertex_pairs(Work& work, std::uint32_t order, std::uint32_t pair,
                         std::span<const std::uint32_t> vertex) const;
  [[nodiscard]] const SeedPair* seeds_of(Work& work, std::uint32_t order) const;
  [[nodiscard]] bool hidden_by_sea(Float3 p, Float3 d, float inverse_length) const;
  [[nodiscard]] bool seen_past_land(Float3 p) const;
  [[nodiscard]] bool below_land(Float3 p) const;
  [[nodiscard]] bool shaded_by_land(RayBatch& batch, std::uint32_t ray, double clear_m) const;
  template <bool kSpectral>
  [[nodiscard]] bool end_on_land(Work& work, std::uint32_t order, const PathState& path,
                                 Float3 from, Float3 direction, const float* spectrum) const;
  template <bool kSpectral>
  void trace_land_suns(Work& work, std::uint32_t order) const;
  void find_mean_behind();
  template <typename Visit>
  void for_each_behind_target(Vec<Body> from, Vec<Body> direction, LandMix& mix,
                              Visit&& visit) const;
  void add_land_behind(Work& work, const PathState& path, Float3 from, Float3 direction) const;
  void add_mean_behind(Work& work) const;
  void add_behind(Work& work, const PathState& path, Float3 from, Float3 direction) const;
  void add_behind_to(Work& work, const PathState& path, SourceId source, float fraction) const;
  void add_behind_to_image(Work& work, const PathState& path, std::uint32_t first, SourceId source,
                           float weight) const;
  void meet_sea(Work& work, const PathState& path, Float3 from, Float3 direction,
                const float* spectrum) const;
  template <bool kSpectral>
  void trace_glint(Work& work, std::uint32_t order) const;
  [[nodiscard]] std::uint32_t pixel_of(const Work& work, const PathState& path) const;
  [[nodiscard]] static double* image_of(Work& work, const PathState& path, SourceId source);
  [[nodiscard]] static double* image_of(Work& work, const PathState& path, std::uint8_t kind);
  void add_first_hit(Work& work, const PathState& path, const Hit& hit) const;
  void light_first_hits(Work& work) const;
  void meet_parts_behind(Work& work) const;
  template <typename Visit>
  void for_each_first(const Work& work, const PathState& path, Visit&& visit) const;
  template <bool kSpectral>
  void add(Work& work, const PathState& path, std::uint32_t order, SourceId source, float weight,
           const float* spectrum) const;
  template <bool kSpectral>
  void add_to(Work& work, const PathState& path, std::uint32_t first, std::uint32_t order,
              SourceId source, float weight, const float* spectrum) const;
  template <bool kSpectral>
  void trace_shadows(Work& work, std::uint32_t order) const;

  const Target& target_;
  std::span<const Material> materials_;
  SourceGeometry sources_;
  std::optional<Plane> plane_;  // of sea or ground
  const Land* land_ = nullptr;  // of sources_.boundary
  // Land::clear_beyond_m of the sensor and of each sun.
  double clear_of_sensor_m_ = 0;
  std::vector<double> clear_of_sun_m_;
  // Sources that a mean ray meets behind the target, and their weights.
  std::vector<std::pair<SourceId, float>> mean_behind_;
  const RayMedium *gas_ = nullptr, *gas_around_ = nullptr;  // of sources_.medium
  PathSettings settings_;
  std::uint32_t parts_;
  SourceLayout layout_;
  bool spectral_ = false;
  bool any_narrow_ = false;  // a material with a lobe not much wider than some sun
  bool any_glint_ = false;   // a sun that the sea mirrors
  std::size_t nodes_ = 1;
  const AimedView& view_;
  HotLights hot_;
};

}  // namespace irsig
