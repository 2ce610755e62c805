#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "core/environment/sea/sea_glint.h"
#include "core/materials/material.h"
#include "core/scene/trace/target.h"
#include "core/scene/trace/target_facets.h"
#include "core/sources/source_geometry.h"
#include "core/transport/primary_rays.h"

namespace irsig {

// Places that may shine more brightly than what is around them, and that samples may fail to meet:
// each at most this bright, and seen over at most this area. What is in the way is not looked at.
class SmallBrightSources {
 public:
  void add(double radiance, double seen_m2);

  // Error allowance for all of them together, if every sample stands for sample_m2. Sources above a
  // threshold are bounded by the sum of radiance x area. The others get a standard error of 2 x
  // sample_m2 x the brightest of them, as if two hits of it had been missed. The threshold is the
  // one with the smallest error. In the unit of the radiances x m2.
  struct Allowance {
    double bound = 0, stderr_ = 0;
  };
  [[nodiscard]] Allowance allowance(double sample_m2) const;
  // Returns the sum of radiance x area, and the brightest radiance.
  [[nodiscard]] double sum() const;
  [[nodiscard]] double brightest() const;

 private:
  struct Places {  // whose radiances differ by less than a quarter of an octave
    double brightest = 0, sum = 0;
  };
  [[nodiscard]] Places& places_of(int key);
  // By quarter octaves of radiance, increasing, without gaps; those without a place are 0. A tree
  // took a tenth of the time of a view under many suns.
  std::vector<Places> places_;
  int lowest_ = 0;  // key of the first
};

// Sources in a view that could be bright without being met, from geometry and materials alone: no
// ray, no temperature. Per unit irradiance of a sun [1/sr], and for light from anywhere as a
// fraction of its radiance. Any number of threads may ask; the target and the materials outlive it.
class UndersampledSources {
 public:
  // facets: of the target.
  UndersampledSources(const Target& target, std::shared_ptr<const TargetFacets> facets,
                      const std::vector<Material>& materials, const ViewFrame& frame);
  ~UndersampledSources();

  struct Sun {
    // Mirrored by what the sensor sees: each facet's largest brdf x cos_i over the sun's disk, for
    // all directions in which its corners see sensor and sun (Material::cos_brdf_limit_per_sr; at
    // most its largest DHR x the disk's radiance).
    SmallBrightSources first;
    // Thrown onto other facets before: at most as bright as any lit facet is to anyone; all of the
    // light that it throws, shown by the facet that shows most (1 / pi, or the peak of its lobe, x
    // DHR) and gathered by facets that throw it at each other: an estimate, no bound, where light
    // falls on gloss at grazing angles.
    SmallBrightSources later;
    // The largest radiance of any lit facet, to whoever looks, light from other facets included; at
    // most the disk's.
    double brightest_per_sr = 0;
  };
  // Made when it is asked for first; sea and horizon play no part.
  [[nodiscard]] const Sun& of(const SunDirection& sun) const;

  // Sources for the facets of one stratum of a view each, and light from other parts for facets
  // that have such parts above their plane: where no hot part is, their reflection is weaker.
  struct Stratum {
    std::vector<SmallBrightSources> first, later;  // [sun]
    SmallBrightSources reflected;                  // of sky, sea, glitter
    struct Parts {
      std::vector<bool> seen;  // [part]
      SmallBrightSources reflected;
    };
    std::vector<Parts> parts;
  };
  // Returns the sources of each stratum. suns: all whose light is wanted. [stratum]
  [[nodiscard]] std::vector<Stratum> by_stratum(const AimedView& view,
                                                std::span<const SunDirection> suns) const;
  // Returns the largest radiance that each part sends to anyone, with the light of parts above its
  // facets that it reflects.
  //   emitted  [part], sent without reflection
  [[nodiscard]] std::vector<double> with_reflected(const std::vector<double>& emitted) const;

  // Possible brightness of a facet for the sensor; a guess to choose by, no bound.
  struct Facet {
    std::uint32_t facet;
    double seen_m2;
    double first, later;  // per unit irradiance of the sun
    double reflected;     // its DHR
    std::size_t parts;    // above it: index into parts_above()
  };
  // Returns the facets that the sensor may see.
  //   later  includes light that this facet shows and that exceeds `least_m2_per_sr` of the sun's
  //          irradiance
  [[nodiscard]] std::vector<Facet> facets(const SunDirection* sun, double least_m2_per_sr) const;
  [[nodiscard]] const std::vector<std::vector<bool>>& parts_above() const { return above().sets; }

  // Light from anywhere, reflected by what the sensor sees: the facets' DHR towards it.
  [[nodiscard]] const SmallBrightSources& reflected() const { return reflected_; }
  // Returns upper bounds on the light seen after one reflection, for an irradiance from any
  // direction. shown_m2_per_sr() sums area x cos_o x largest brdf x cos_i over facets [m2/sr].
  // Facets seen nearly edge on, whose brdf may be very large, count in edge_on_m2() instead:
  // projected area x DHR, per radiance [m2]. any_per_sr() is the largest brdf x cos_i of any
  // direction, which most glossy models do not limit [1/sr].
  [[nodiscard]] double shown_m2_per_sr() const { return shown_m2_per_sr_; }
  [[nodiscard]] double edge_on_m2() const { return edge_on_m2_; }
  [[nodiscard]] double any_per_sr() const { return any_per_sr_; }

 private:
  struct Patch;
  struct Thrown;
  // Calls visit(patch, radiance, m2) for each lit side that the sensor may see.
  template <typename Visit>
  void for_each_shown(const SunDirection& sun, const std::vector<Patch>& patches,
                      Visit&& visit) const;
  // Calls visit(surface, Thrown) for each lit side of some surfaces, or of the target's own.
  template <typename Surface, typename Visit>
  void for_each_thrown(const SunDirection& sun, const std::vector<Surface>& surfaces,
                       Visit&& visit) const;
  template <typename Visit>
  void for_each_thrown(const SunDirection& sun, Visit&& visit) const;
  // Facets that face nearly the same way, of one material and one kind, as one: what is at most
  // true of them all.
  [[nodiscard]] std::vector<Patch> gathered(
      const std::function<std::uint32_t(const Patch&)>& kind) const;
  [[nodiscard]] Sun make(const SunDirection& sun) const;
  // Parts with places above facets.
  struct Above {
    std::vector<std::vector<bool>> sets;   // that occur
    std::vector<std::uint32_t> of_patch;   // for who looks from the sensor's side
    std::vector<std::vector<bool>> parts;  // [part][part]: above any of its facets, on either side
  };
  [[nodiscard]] const Above& above() const;

  const Target& target_;
  std::shared_ptr<const TargetFacets> facets_;
  const std::vector<Material>& materials_;
  bool convex_;
  std::vector<Patch> patch_;
  // [material]: the largest over angles, and the mean of all light in a hemisphere.
  std::vector<double> dhr_, mean_dhr_;
  double largest_dhr_ = 0, gathered_ = 1, gathered_mean_ = 1;
  double shown_per_sr_ = 0, passed_on_ = 0;
  SmallBrightSources reflected_;
  double shown_m2_per_sr_ = 0, edge_on_m2_ = 0, any_per_sr_ = 0;
  mutable std::mutex mutex_;
  mutable std::vector<Patch> gathered_patch_;  // made with the first sun
  mutable std::deque<std::pair<SunDirection, Sun>> sun_;
  mutable std::unique_ptr<const Above> above_;
};

// Returns the brightest glitter of a sea that mirrors a sun, over all directions: along the sun's
// vertical circle, sampled every half degree, plus 5 %. Empty without wind.
[[nodiscard]] std::vector<SeaGlint> brightest_glitter(const SunDirection& sun);

// Upper 95 % limit of the expected number of events of which a pilot met none.
inline constexpr double kNoneSeen = 3.0;

}  // namespace irsig
