#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include "core/base/sobol.h"
#include "core/environment/air.h"
#include "core/scene/trace/reference_tracer.h"
#include "core/sources/land.h"
#include "verify/reference/reference_brdf.h"
#include "verify/reference/reference_light.h"
#include "verify/reference/reference_view.h"

// Shared parts of making a reference (reference_view.cpp) and following its paths
// (reference_paths.cpp).
namespace irsig {
namespace reference_view {

inline constexpr double kPi = std::numbers::pi;
inline constexpr int kStrata = 6;  // wavelengths of a path in a band
// Lobes narrower than this reflect the sun onto other surfaces; their light is followed from the
// sun.
inline constexpr double kMirrorSlope = 0.15;

using Body3 = Vec<Body>;

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(mix64(seed)) {}
  double operator()() {
    state_ += 0x9e3779b97f4a7c15ULL;
    return static_cast<double>(mix64(state_) >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

inline constexpr std::array kBase{2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37};
enum Dimension {
  kFacet,
  kPointU,
  kPointV,
  kLobe,
  kDrawU,
  kDrawV,
  kSunU,
  kSunV,
  kHotF,
  kHotU,
  kHotV,
  kWave
};

inline Point3 point(Body3 v) { return {v.x, v.y, v.z}; }

struct Facet {
  Body3 a, ab, ac, normal;
  double area_m2;
  std::uint32_t part;
};

// Picks in proportion to weights; which: at a number in [0, 1).
struct Choice {
  std::vector<std::uint32_t> item;
  std::vector<double> until;  // running
  void add(std::uint32_t i, double weight) {
    if (!(weight > 0)) return;
    item.push_back(i);
    until.push_back((until.empty() ? 0 : until.back()) + weight);
  }
  void finish() {
    for (double& u : until) u /= until.back();
  }
  [[nodiscard]] std::size_t pick(double u) const {
    return std::min(
        static_cast<std::size_t>(std::upper_bound(until.begin(), until.end(), u) - until.begin()),
        until.size() - 1);
  }
  [[nodiscard]] double share(std::size_t k) const { return until[k] - (k == 0 ? 0 : until[k - 1]); }
};

}  // namespace reference_view

struct ReferenceView::Parts {
  SceneSpec scene;
  ConditionSpec condition;
  Air air;
  Viewpoint viewpoint;
  reference_view::Body3 sensor;
  std::vector<reference_view::Facet> facet;
  std::unique_ptr<ReferenceTracer> tracer;
  std::vector<ReferenceBrdf> brdf;  // [material]
  bool grey = true, surface = false, sun = false;
  double size_m = 0, cos_sun = 1, sun_solid_angle = 0;
  PlainLight light{};
  reference_view::Choice primary, hot;
  reference_view::Choice
      mirrors;  // by area that faces the sun; empty where no light is followed from it
  std::vector<double> hot_density;    // [facet]: per area; 0: not a light
  std::vector<WavelengthDraw> waves;  // [band]
  // [band]: of grey scenes.
  std::vector<std::vector<double>> part_in_band;
  std::vector<double> sky_in_band, lower_in_band, sun_in_band, air_in_band;

  // Land in place of the surface, of grey materials; null: none.
  std::shared_ptr<const Land> land;
  std::vector<double> land_emissivity;            // [material]
  std::vector<std::vector<double>> land_in_band;  // [band][material] Planck's function

  struct Path;
  [[nodiscard]] std::uint64_t channels() const {
    return grey ? scene.band.size() : scene.band.size() * reference_view::kStrata;
  }
  [[nodiscard]] bool meets_earth(reference_view::Body3 from, reference_view::Body3 v,
                                 double end) const;
  [[nodiscard]] bool blocked(reference_view::Body3 from, reference_view::Body3 towards,
                             std::uint32_t own, double t_max, std::uint64_t& rays) const;
  [[nodiscard]] ReferenceTracer::Hit meet(reference_view::Body3 from, reference_view::Body3 towards,
                                          std::uint32_t own, double t_max) const;
  // Returns true if the surface covers a point, or lies between it and a sensor.
  [[nodiscard]] bool buried(reference_view::Body3 x) const;
  [[nodiscard]] bool hidden(reference_view::Body3 x, reference_view::Body3 towards,
                            double distance_m) const;
  // Sets the radiance of land where a ray meets it, in each channel, and returns the distance.
  // nullopt: the ray meets no land. shaded: true if the target's shadow counts.
  [[nodiscard]] std::optional<double> see_land(Path& path, reference_view::Body3 from,
                                               reference_view::Body3 towards, bool shaded,
                                               std::vector<double>& radiance) const;
  void trace(Path& path) const;
  void trace_from_sun(Path& path) const;
  // Returns the extinction by Bouguer's law: density x mass coefficient. [1/m]
  [[nodiscard]] double extinction_per_m() const {
    return air.model == AirModel::kVacuum
               ? 0
               : air.absorption_m2_kg * air.pressure_pa /
                     (air.gas_constant_j_kg_k * condition.air_temperature_k);
  }
  [[nodiscard]] bool is_mirror(std::uint32_t part) const {
    return brdf[scene.part[part].material].narrowest_slope() < reference_view::kMirrorSlope;
  }
};

// One path and its working data.
struct ReferenceView::Parts::Path {
  reference_view::Random& random;
  std::array<double, reference_view::kBase.size()> u;  // of the first vertex
  std::uint64_t rays = 0;
  // [channel]
  std::vector<double> lambda_um, weight, through, sum, source, factor, end_factor;
  std::vector<std::vector<double>> part;  // Planck's, made when needed
  std::vector<double> sky, lower, sunlight, land;
  // Results of the last path. [band]
  std::vector<double> total, apparent, contrast;
  double area_m2 = 0;

  [[nodiscard]] double first(reference_view::Dimension d, int depth) {
    return depth == 0 ? u[static_cast<std::size_t>(d)] : random();
  }
  // Computes weight x cos / density of a drawn direction, in each channel.
  void weigh(const ReferenceBrdf& f, const ReferenceBrdf::Drawn& drawn,
             std::vector<double>& out) const {
    if (!(drawn.density_per_sr > 0)) {
      std::fill(out.begin(), out.end(), 0.0);
      return;
    }
    f.brdf_per_sr(drawn.at, lambda_um, out);
    for (double& v : out) v *= drawn.at.cos_i / drawn.density_per_sr;
  }
};

}  // namespace irsig
