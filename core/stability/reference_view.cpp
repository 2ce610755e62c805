#include "core/stability/reference_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/sobol.h"
#include "core/environment/air.h"
#include "core/scene/reference_tracer.h"
#include "core/spectral/planck.h"
#include "core/stability/reference_brdf.h"
#include "core/stability/reference_light.h"

namespace irsig {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kStrata = 6;  // wavelengths of a path in a band
constexpr double kHotterK = 20;
// Roulette begins at a throughput below this.
constexpr double kThin = 0.5;
// Lobes narrower than this throw the sun onto other surfaces: followed from the sun.
constexpr double kMirrorSlope = 0.15;

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

constexpr std::array kBase{2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37};
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

double radical_inverse(std::uint64_t i, int base) {
  double out = 0, digit = 1.0 / base;
  for (; i > 0; i /= static_cast<std::uint64_t>(base), digit /= base)
    out += digit * static_cast<double>(i % static_cast<std::uint64_t>(base));
  return out;
}

// Balance heuristic: the share of drawn directions in light that is aimed at as well. None where it
// would be below a hundredth: one path in 1e5 would carry it.
double drawn_share(double by_lobe, double aimed) {
  const double share = by_lobe / (by_lobe + aimed);
  return share < 0.01 ? 0 : share;
}

Point3 point(Body3 v) { return {v.x, v.y, v.z}; }

struct Facet {
  Body3 a, ab, ac, normal;
  double area_m2;
  std::uint32_t part;
};

// x y z of the local frame with z = normal and the direction towards the eye in the plane of x.
struct Frame {
  Body3 x, y, z;
  Frame(Body3 normal, Body3 towards) : z(normal) {
    Body3 t = towards - dot(towards, z) * z;
    if (length(t) < 1e-12)
      t = std::abs(z.x) < 0.9 ? Body3{1, 0, 0} - z.x * z : Body3{0, 1, 0} - z.y * z;
    x = normalized(t);
    y = cross(z, x);
  }
  [[nodiscard]] Body3 out(double a, double b, double c) const { return a * x + b * y + c * z; }
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

}  // namespace

struct ReferenceView::Parts {
  SceneSpec scene;
  ConditionSpec condition;
  Air air;
  Viewpoint viewpoint;
  Body3 sensor;
  std::vector<Facet> facet;
  std::unique_ptr<ReferenceTracer> tracer;
  std::vector<ReferenceBrdf> brdf;  // [material]
  bool grey = true, surface = false, sun = false;
  double size_m = 0, cos_sun = 1, sun_solid_angle = 0;
  PlainLight light{};
  Choice primary, hot;
  Choice mirrors;  // by area that faces the sun; empty where no light is followed from it
  std::vector<double> hot_density;    // [facet]: per area; 0: not a light
  std::vector<WavelengthDraw> waves;  // [band]
  // [band]: of grey scenes.
  std::vector<std::vector<double>> part_in_band;
  std::vector<double> sky_in_band, lower_in_band, sun_in_band, air_in_band;

  struct Path;
  [[nodiscard]] std::uint64_t channels() const {
    return grey ? scene.band.size() : scene.band.size() * kStrata;
  }
  [[nodiscard]] bool meets_earth(Body3 from, Body3 v, double end) const;
  [[nodiscard]] bool blocked(Body3 from, Body3 towards, std::uint32_t own, double t_max,
                             std::uint64_t& rays) const;
  [[nodiscard]] ReferenceTracer::Hit meet(Body3 from, Body3 towards, std::uint32_t own,
                                          double t_max) const;
  void trace(Path& path) const;
  void trace_from_sun(Path& path) const;
  // Bouguer's law: density x mass coefficient.
  [[nodiscard]] double extinction_per_m() const {
    return air.model == AirModel::kVacuum
               ? 0
               : air.absorption_m2_kg * air.pressure_pa /
                     (air.gas_constant_j_kg_k * condition.air_temperature_k);
  }
  [[nodiscard]] bool is_mirror(std::uint32_t part) const {
    return brdf[scene.part[part].material].narrowest_slope() < kMirrorSlope;
  }
};

// Whether the ray from + t v, 0 < t < end, goes through the sphere of the Earth that touches z = 0
// at the reference point. Twice the radius times the height above it, to first order, is
//   |p|^2 + 2 z_down (-R)  =  |p|^2 - 2 R z.
bool ReferenceView::Parts::meets_earth(Body3 from, Body3 v, double end) const {
  const double b = dot(from, v) - kEarthRadiusM * v.z, a = dot(v, v);
  const double lowest = -b / a;
  if (!(lowest > 0)) return false;
  const double t = std::min(lowest, end);
  const double height = dot(from, from) - 2 * kEarthRadiusM * from.z + 2 * t * b + t * t * a;
  return height < 0;
}

ReferenceTracer::Hit ReferenceView::Parts::meet(Body3 from, Body3 towards, std::uint32_t own,
                                                double t_max) const {
  double t_min = 1e-9 * size_m;
  for (;;) {
    const auto hit = tracer->nearest(point(from), point(towards), t_min, t_max);
    if (!hit.met() || hit.facet != own) return hit;
    t_min = hit.t + 1e-9 * size_m;
  }
}

bool ReferenceView::Parts::blocked(Body3 from, Body3 towards, std::uint32_t own, double t_max,
                                   std::uint64_t& rays) const {
  ++rays;
  return meet(from, towards, own, t_max).met();
}

// One path and what it needs.
struct ReferenceView::Parts::Path {
  Random& random;
  std::array<double, kBase.size()> u;  // of the first vertex
  std::uint64_t rays = 0;
  // [channel]
  std::vector<double> lambda_um, weight, through, sum, source, factor, end_factor;
  std::vector<std::vector<double>> part;  // Planck's, made when needed
  std::vector<double> sky, lower, sunlight;
  // Of the last path. [band]
  std::vector<double> total, apparent, contrast;
  double area_m2 = 0;

  [[nodiscard]] double first(Dimension d, int depth) {
    return depth == 0 ? u[static_cast<std::size_t>(d)] : random();
  }
  // weight x cos / density of a drawn direction, in each channel.
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

void ReferenceView::Parts::trace(Path& p) const {
  const std::size_t bands = scene.band.size(), n = channels();
  p.area_m2 = 0;
  std::fill(p.total.begin(), p.total.end(), 0.0);
  std::fill(p.apparent.begin(), p.apparent.end(), 0.0);
  std::fill(p.contrast.begin(), p.contrast.end(), 0.0);

  const std::size_t picked = primary.pick(p.u[kFacet]);
  std::uint32_t own = primary.item[picked];
  const Facet& first = facet[own];
  const double root = std::sqrt(p.u[kPointU]);
  Body3 x = first.a + (root * (1 - p.u[kPointV])) * first.ab + (root * p.u[kPointV]) * first.ac;
  Body3 to_eye = sensor - x;
  const double distance_m = length(to_eye);
  to_eye = (1 / distance_m) * to_eye;
  Body3 normal = first.normal;
  double cos_o = dot(normal, to_eye);
  if (cos_o < 0 && scene.part[first.part].two_sided) {
    normal = -1.0 * normal;
    cos_o = -cos_o;
  }
  if (cos_o <= 0 || (surface && x.z > 0)) return;
  if (surface && meets_earth(x, to_eye, distance_m)) return;
  if (blocked(x, to_eye, own, distance_m, p.rays)) return;
  const double range_m = viewpoint.range_m;
  const double w0 = cos_o * (range_m / distance_m) * (range_m / distance_m) * first.area_m2 /
                    primary.share(picked);
  p.area_m2 = w0;
  const Body3 look = -1.0 * to_eye;

  if (!grey) {
    for (std::size_t b = 0; b < bands; ++b)
      waves[b].draw(p.u[kWave], p.lambda_um.data() + b * kStrata, p.weight.data() + b * kStrata);
    for (auto& q : p.part) q.clear();
    for (std::size_t i = 0; i < n; ++i) {
      p.sky[i] = light.sky(p.lambda_um[i]);
      p.lower[i] = light.lower(p.lambda_um[i]);
      p.sunlight[i] = light.sunlight(p.lambda_um[i]);
    }
  }
  const auto planck = [&](std::uint32_t part) -> const std::vector<double>& {
    std::vector<double>& out = p.part[part];
    if (grey || !out.empty()) return out;
    for (std::size_t i = 0; i < n; ++i)
      out.push_back(planck_radiance_w_m2_sr_um(p.lambda_um[i], condition.part_temperature_k[part]));
    return out;
  };
  std::fill(p.through.begin(), p.through.end(), 1.0);
  std::fill(p.sum.begin(), p.sum.end(), 0.0);

  std::uint32_t part = first.part;
  double unaimed = 1;  // the share of drawn directions in what is met
  bool matt_before = false;
  for (int depth = 0; depth < 10000; ++depth) {
    const ReferenceBrdf& f = brdf[scene.part[part].material];
    const Frame frame(normal, to_eye);
    const auto drawn =
        f.draw(cos_o, p.first(kLobe, depth), p.first(kDrawU, depth), p.first(kDrawV, depth));
    p.weigh(f, drawn, p.factor);
    const std::vector<double>& emitted = planck(part);
    for (std::size_t i = 0; i < n; ++i)
      p.sum[i] += p.through[i] * unaimed * (1 - p.factor[i]) * emitted[i];

    const auto reflected = [&](Body3 wi, ReflectionGeometry& at) {
      const double in[3] = {dot(wi, frame.x), dot(wi, frame.y), dot(wi, frame.z)};
      const double out[3] = {std::sqrt(std::max(0.0, 1 - cos_o * cos_o)), 0, cos_o};
      if (in[2] <= 0) return false;
      at = geometry_between(in, out);
      return true;
    };
    // What mirrors send on to anything matt comes from the sun's side.
    const bool mirror = !mirrors.item.empty() && is_mirror(part);
    const bool of_sun = sun && !(mirror && matt_before);
    matt_before = matt_before || !mirror;
    if (of_sun) {
      const double c = 1 - p.first(kSunU, depth) * (1 - cos_sun);
      const double s = std::sqrt(std::max(0.0, 1 - c * c)), turn = 2 * kPi * p.first(kSunV, depth);
      const Frame about(condition.sun_direction, {0.3, 0.5, 0.8});
      const Body3 wi = about.out(s * std::cos(turn), s * std::sin(turn), c);
      ReflectionGeometry at{};
      if (!(surface && wi.z > 0) && reflected(wi, at)) {
        const double by_lobe = f.density_per_sr(at), aimed = 1 / sun_solid_angle;
        f.brdf_per_sr(at, p.lambda_um, p.source);
        const double share = at.cos_i * (1 - drawn_share(by_lobe, aimed)) / aimed;
        double most = 0;
        for (std::size_t i = 0; i < n; ++i) {
          p.source[i] *= p.through[i] * share * p.sunlight[i] / sun_solid_angle;
          most = std::max(most, p.source[i]);
        }
        if (most > 0 && !blocked(x, wi, own, 1e30, p.rays))
          for (std::size_t i = 0; i < n; ++i) p.sum[i] += p.source[i];
      }
    }
    if (!hot.item.empty()) {
      const std::size_t k = hot.pick(p.first(kHotF, depth));
      const std::uint32_t target = hot.item[k];
      const Facet& lamp = facet[target];
      const double r = std::sqrt(p.first(kHotU, depth)), v = p.first(kHotV, depth);
      const Body3 y = lamp.a + (r * (1 - v)) * lamp.ab + (r * v) * lamp.ac;
      Body3 wi = y - x;
      const double d = length(wi);
      wi = (1 / d) * wi;
      double cos_l = -dot(lamp.normal, wi);
      Body3 lamp_normal = lamp.normal;
      if (cos_l < 0 && scene.part[lamp.part].two_sided) {
        cos_l = -cos_l;
        lamp_normal = -1.0 * lamp_normal;
      }
      ReflectionGeometry at{};
      if (target != own && cos_l > 0 && d > 1e-9 * size_m && !(surface && y.z > 0) &&
          reflected(wi, at)) {
        const double aimed = hot_density[target] * d * d / cos_l;
        const double share = at.cos_i * (1 - drawn_share(f.density_per_sr(at), aimed)) / aimed;
        f.brdf_per_sr(at, p.lambda_um, p.source);
        const double most = *std::max_element(p.source.begin(), p.source.end());
        if (most > 0) {
          ++p.rays;
          const auto met = meet(x, wi, own, d * (1 - 1e-9));
          if (!met.met() || met.facet == target) {
            // What it emits this way: 1 less a drawn direction's weight.
            const ReferenceBrdf& g = brdf[scene.part[lamp.part].material];
            p.weigh(g, g.draw(std::min(cos_l, 1.0), p.random(), p.random(), p.random()),
                    p.end_factor);
            const std::vector<double>& b = planck(lamp.part);
            for (std::size_t i = 0; i < n; ++i)
              p.sum[i] += p.through[i] * p.source[i] * share * (1 - p.end_factor[i]) * b[i];
          }
        }
      }
    }

    double most = 0;
    for (std::size_t i = 0; i < n; ++i) {
      p.through[i] *= p.factor[i];
      most = std::max(most, p.through[i]);
    }
    if (!(most > 0)) break;
    if (most < kThin) {
      // At the first vertex everybody survives: nearly all reflected light is of the first order.
      const double survival = depth == 0 ? 1.0 : std::max(most, 0.02) / kThin;
      if (p.random() >= survival) break;
      for (double& t : p.through) t /= survival;
    }
    const Body3 wi = frame.out(drawn.x, drawn.y, drawn.z);
    ++p.rays;
    const auto hit = meet(x, wi, own, 1e30);
    const Body3 next = hit.met() ? x + hit.t * wi : Body3{};
    if (!hit.met() || (surface && next.z > 0)) {
      const std::vector<double>& beyond = wi.z < 0 ? p.sky : p.lower;
      for (std::size_t i = 0; i < n; ++i) p.sum[i] += p.through[i] * beyond[i];
      if (of_sun && !hit.met() && !(surface && wi.z > 0) &&
          dot(wi, condition.sun_direction) > cos_sun) {
        const double share = drawn_share(drawn.density_per_sr, 1 / sun_solid_angle);
        for (std::size_t i = 0; i < n; ++i)
          p.sum[i] += p.through[i] * share * p.sunlight[i] / sun_solid_angle;
      }
      break;
    }
    const Facet& met = facet[hit.facet];
    part = met.part;
    normal = met.normal;
    to_eye = -1.0 * wi;
    cos_o = dot(normal, to_eye);
    if (cos_o < 0 && scene.part[part].two_sided) {
      normal = -1.0 * normal;
      cos_o = -cos_o;
    }
    if (cos_o <= 0) break;  // a back: nothing comes from there
    cos_o = std::min(cos_o, 1.0);
    unaimed = 1;
    if (hot_density[hit.facet] > 0 && hit.facet != own) {
      const double aimed = hot_density[hit.facet] * hit.t * hit.t / cos_o;
      unaimed = drawn_share(drawn.density_per_sr, aimed);
    }
    own = hit.facet;
    x = next;
  }

  // At the sensor, through the air of this point's own distance.
  const double extinction = extinction_per_m();
  const double seen = std::exp(-extinction * distance_m),
               at_range = std::exp(-extinction * range_m);
  const bool sea = surface ? meets_earth(sensor, look, 1e30) : look.z > 0;
  const std::vector<double>& behind = sea ? p.lower : p.sky;
  for (std::size_t b = 0; b < bands; ++b) {
    double radiance = 0, background = 0, column = 0;
    if (grey) {
      radiance = p.sum[b];
      background = behind[b];
      column = air_in_band[b];
    } else {
      for (std::size_t i = b * kStrata; i < (b + 1) * kStrata; ++i) {
        radiance += p.weight[i] * p.sum[i];
        background += p.weight[i] * behind[i];
      }
      column = air_in_band[b];
    }
    p.total[b] = w0 * radiance;
    const double front = air.path_emission ? (1 - seen) * column : 0;
    const double whole = air.path_emission ? (1 - at_range) * column : 0;
    p.apparent[b] = w0 * (seen * radiance + front);
    p.contrast[b] = p.apparent[b] - w0 * (at_range * background + whole);
  }
}

// Light that reaches a matt surface from the sun by way of mirrors alone, followed on from there;
// at each place from the first matt one on, what of it goes to the sensor.
void ReferenceView::Parts::trace_from_sun(Path& p) const {
  const std::size_t bands = scene.band.size(), n = channels();
  std::fill(p.total.begin(), p.total.end(), 0.0);
  std::fill(p.apparent.begin(), p.apparent.end(), 0.0);
  const std::size_t picked = mirrors.pick(p.u[kFacet]);
  std::uint32_t own = mirrors.item[picked];
  const double root = std::sqrt(p.u[kPointU]);
  Body3 x = facet[own].a + (root * (1 - p.u[kPointV])) * facet[own].ab +
            (root * p.u[kPointV]) * facet[own].ac;
  const double c = 1 - p.u[kSunU] * (1 - cos_sun), s = std::sqrt(std::max(0.0, 1 - c * c)),
               turn = 2 * kPi * p.u[kSunV];
  const Frame about(condition.sun_direction, {0.3, 0.5, 0.8});
  Body3 from = about.out(s * std::cos(turn), s * std::sin(turn), c);
  if (surface && (from.z > 0 || x.z > 0)) return;
  std::uint32_t part = facet[own].part;
  Body3 normal = facet[own].normal;
  double cos_i = dot(normal, from);
  if (cos_i < 0 && scene.part[part].two_sided) {
    normal = -1.0 * normal;
    cos_i = -cos_i;
  }
  if (cos_i <= 0 || blocked(x, from, own, 1e30, p.rays)) return;
  if (!grey) {
    for (std::size_t b = 0; b < bands; ++b)
      waves[b].draw(p.u[kWave], p.lambda_um.data() + b * kStrata, p.weight.data() + b * kStrata);
    for (std::size_t i = 0; i < n; ++i) p.sunlight[i] = light.sunlight(p.lambda_um[i]);
  }
  const double flux = cos_i * facet[own].area_m2 / mirrors.share(picked);
  std::fill(p.through.begin(), p.through.end(), 1.0);
  const double extinction = extinction_per_m();
  bool matt = false;
  for (int depth = 0; depth < 10000; ++depth) {
    const ReferenceBrdf& f = brdf[scene.part[part].material];
    const Frame frame(normal, from);
    const double in[3] = {std::sqrt(std::max(0.0, 1 - cos_i * cos_i)), 0, cos_i};
    matt = matt || !is_mirror(part);
    if (matt) {
      Body3 to_eye = sensor - x;
      const double distance_m = length(to_eye);
      to_eye = (1 / distance_m) * to_eye;
      const double out[3] = {dot(to_eye, frame.x), dot(to_eye, frame.y), dot(to_eye, frame.z)};
      if (out[2] > 0 && !(surface && meets_earth(x, to_eye, distance_m)) &&
          !blocked(x, to_eye, own, distance_m, p.rays)) {
        f.brdf_per_sr(geometry_between(in, out), p.lambda_um, p.source);
        const double ratio = viewpoint.range_m / distance_m;
        const double weight = flux * out[2] * ratio * ratio;
        const double seen = std::exp(-extinction * distance_m);
        for (std::size_t i = 0; i < n; ++i) {
          const double value =
              weight * p.through[i] * p.source[i] * p.sunlight[i] * (grey ? 1 : p.weight[i]);
          const std::size_t b = grey ? i : i / kStrata;
          p.total[b] += value;
          p.apparent[b] += seen * value;
        }
      }
    }
    const auto drawn =
        f.draw(cos_i, p.first(kLobe, depth), p.first(kDrawU, depth), p.first(kDrawV, depth));
    p.weigh(f, drawn, p.factor);
    double most = 0;
    for (std::size_t i = 0; i < n; ++i) {
      p.through[i] *= p.factor[i];
      most = std::max(most, p.through[i]);
    }
    if (!(most > 0)) return;
    if (most < kThin && matt) {
      const double survival = std::max(most, 0.02) / kThin;
      if (p.random() >= survival) return;
      for (double& t : p.through) t /= survival;
    }
    const Body3 wi = frame.out(drawn.x, drawn.y, drawn.z);
    ++p.rays;
    const auto hit = meet(x, wi, own, 1e30);
    if (!hit.met()) return;
    x = x + hit.t * wi;
    if (surface && x.z > 0) return;
    own = hit.facet;
    part = facet[own].part;
    normal = facet[own].normal;
    from = -1.0 * wi;
    cos_i = dot(normal, from);
    if (cos_i < 0 && scene.part[part].two_sided) {
      normal = -1.0 * normal;
      cos_i = -cos_i;
    }
    if (cos_i <= 0) return;
    cos_i = std::min(cos_i, 1.0);
  }
}

absl::StatusOr<ReferenceView> ReferenceView::make(const SceneSpec& scene,
                                                  const ViewRequest& request,
                                                  std::uint32_t condition) {
  if (request.environment) return absl::UnimplementedError("the embedded atmosphere");
  auto parts = std::make_unique<Parts>();
  Parts& p = *parts;
  p.scene = scene;
  p.condition = request.condition.at(condition);
  p.air = request.air;
  p.viewpoint = request.viewpoint;
  p.sensor = request.viewpoint.range_m * body_from_aspect(request.viewpoint.aspect_azimuth_deg,
                                                          request.viewpoint.aspect_elevation_deg);
  p.surface = p.condition.surroundings.kind != SurroundingsKind::kNone;
  double least_um = 1e300, most_um = 0;
  for (const Band& b : scene.band) {
    least_um = std::min(least_um, b.lambda_min_um);
    most_um = std::max(most_um, b.lambda_max_um);
  }
  for (const MaterialSpec& m : scene.material) {
    auto brdf = ReferenceBrdf::make(m, least_um, most_um);
    if (!brdf.ok()) return brdf.status();
    p.grey = p.grey && brdf->grey();
    p.brdf.push_back(*std::move(brdf));
  }

  std::vector<Point3> corner;
  for (const Vec<Body>& v : scene.mesh.vertex) corner.push_back(point(v));
  std::vector<std::uint32_t> triangle;
  std::vector<std::uint32_t> part_of_group(scene.mesh.group.size());
  for (std::size_t g = 0; g < scene.mesh.group.size(); ++g)
    for (std::uint32_t i = 0; i < scene.part.size(); ++i) {
      std::vector<std::string> match = scene.part[i].match;
      if (match.empty()) match.push_back(scene.part[i].name);
      for (const std::string& pattern : match)
        if (group_matches(scene.mesh.group[g], pattern)) part_of_group[g] = i;
    }
  Body3 low = scene.mesh.vertex.front(), high = low;
  for (std::size_t t = 0; t < scene.mesh.triangle.size(); ++t) {
    const auto& index = scene.mesh.triangle[t];
    triangle.insert(triangle.end(), index.begin(), index.end());
    const Body3 a = scene.mesh.vertex[index[0]], b = scene.mesh.vertex[index[1]],
                c = scene.mesh.vertex[index[2]];
    for (const Body3 v : {a, b, c}) {
      low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
      high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
    }
    const Body3 across = cross(b - a, c - a);
    const double twice = length(across);
    p.facet.push_back({a, b - a, c - a, twice > 0 ? (1 / twice) * across : Body3{}, 0.5 * twice,
                       part_of_group[scene.mesh.triangle_group[t]]});
  }
  p.size_m = 0.5 * length(high - low);
  p.tracer = std::make_unique<ReferenceTracer>(std::move(corner), std::move(triangle));

  const ConditionSpec& c = p.condition;
  const double radius = c.sun_angular_radius_deg * kRadPerDeg;
  p.sun = c.sun && c.sun_scale > 0 && c.sun_cos_zenith > -std::sin(radius);
  p.light = {&p.condition, p.sun};
  p.cos_sun = std::cos(radius);
  // Irradiance of a disk of radiance 1 at normal incidence: pi sin^2; drawn evenly in solid angle.
  p.sun_solid_angle = 2 * kPi * 2 * std::pow(std::sin(radius / 2), 2);

  double coldest_k = 1e300;
  for (const double t : c.part_temperature_k) coldest_k = std::min(coldest_k, t);
  const auto of_temperature = [](double t) {
    return [t](double l) { return planck_radiance_w_m2_sr_um(l, t); };
  };
  for (const Band& b : scene.band) {
    std::vector<double>& of_band = p.part_in_band.emplace_back();
    std::vector<std::function<double(double)>> spectra;
    for (const double t : c.part_temperature_k) {
      of_band.push_back(integral_in_band(b, of_temperature(t)));
      spectra.push_back(of_temperature(t));
    }
    const auto sky = [&](double l) { return p.light.sky(l); };
    const auto lower = [&](double l) { return p.light.lower(l); };
    const auto sunlight = [&](double l) { return p.light.sunlight(l); };
    p.sky_in_band.push_back(integral_in_band(b, sky));
    p.lower_in_band.push_back(integral_in_band(b, lower));
    p.sun_in_band.push_back(integral_in_band(b, sunlight));
    p.air_in_band.push_back(integral_in_band(b, of_temperature(c.air_temperature_k)));
    spectra.insert(spectra.end(), {sky, lower, sunlight});
    p.waves.emplace_back(b, spectra, kStrata);
  }

  // Where points are drawn: projected area x (a tenth of the brightest + the part's own), in all
  // bands; a tenth goes to parts in equal shares.
  const std::size_t parts_count = scene.part.size();
  std::vector<double> bright(parts_count, 0.1), projected(p.facet.size(), 0.0),
      of_part(parts_count, 0.0);
  for (std::size_t b = 0; b < scene.band.size(); ++b) {
    double most = 0;
    for (const double l : p.part_in_band[b]) most = std::max(most, l);
    most = std::max(most, p.sky_in_band[b]);
    if (!(most > 0)) continue;
    for (std::size_t i = 0; i < parts_count; ++i) bright[i] += p.part_in_band[b][i] / most;
  }
  double sum = 0;
  for (std::size_t t = 0; t < p.facet.size(); ++t) {
    const Facet& f = p.facet[t];
    double cosine = 0;
    for (const Body3 at : {f.a, f.a + f.ab, f.a + f.ac}) {
      const double one = dot(f.normal, normalized(p.sensor - at));
      cosine = std::max(cosine, scene.part[f.part].two_sided ? std::abs(one) : one);
    }
    projected[t] = std::max(cosine, 0.0) * f.area_m2;
    of_part[f.part] += projected[t];
    sum += projected[t] * bright[f.part];
  }
  if (!(sum > 0)) return absl::InvalidArgumentError("no facet faces the sensor");
  for (std::uint32_t t = 0; t < p.facet.size(); ++t) {
    const std::uint32_t part = p.facet[t].part;
    if (projected[t] > 0)
      p.primary.add(t, 0.9 * projected[t] * bright[part] / sum +
                           0.1 * projected[t] / (of_part[part] * static_cast<double>(parts_count)));
  }
  p.primary.finish();

  bool any_matt = false;
  for (std::uint32_t i = 0; i < parts_count; ++i) any_matt = any_matt || !p.is_mirror(i);
  for (std::uint32_t t = 0; p.sun && any_matt && t < p.facet.size(); ++t) {
    const Facet& f = p.facet[t];
    if (!p.is_mirror(f.part)) continue;
    const double cosine = dot(f.normal, c.sun_direction);
    // Facets along the beam meet a part of the disk.
    const double facing = scene.part[f.part].two_sided ? std::abs(cosine) : cosine;
    p.mirrors.add(t, f.area_m2 * std::max(0.0, facing + std::sin(radius)));
  }
  if (!p.mirrors.item.empty()) p.mirrors.finish();

  p.hot_density.assign(p.facet.size(), 0.0);
  std::vector<double> power(p.facet.size(), 0.0);
  double all = 0;
  for (std::size_t t = 0; t < p.facet.size(); ++t) {
    const Facet& f = p.facet[t];
    if (!(c.part_temperature_k[f.part] >= coldest_k + kHotterK)) continue;
    for (std::size_t b = 0; b < scene.band.size(); ++b) {
      double most = 0;
      for (const double l : p.part_in_band[b]) most = std::max(most, l);
      if (most > 0) power[t] += f.area_m2 * p.part_in_band[b][f.part] / most;
    }
    all += power[t];
  }
  for (std::uint32_t t = 0; t < p.facet.size(); ++t) {
    if (!(power[t] > 0)) continue;
    p.hot.add(t, power[t]);
    p.hot_density[t] = power[t] / all / p.facet[t].area_m2;
  }
  if (!p.hot.item.empty()) p.hot.finish();
  return ReferenceView(std::move(parts));
}

ReferenceView::Result ReferenceView::run(std::uint64_t samples, std::uint64_t seed) const {
  const Parts& all = *parts_;
  const std::size_t bands = all.scene.band.size(), n = all.channels();
  Result out;
  out.row.resize(bands);
  ReplicateStatistics statistics(4 * bands);
  for (std::uint32_t batch = 0; batch < kBatches; ++batch) {
    Random random(mix64(seed) + batch);
    Parts::Path path{random, {}, 0, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}};
    for (auto* v : {&path.lambda_um, &path.weight, &path.through, &path.sum, &path.source,
                    &path.factor, &path.end_factor, &path.sky, &path.lower, &path.sunlight})
      v->assign(n, 1.0);
    for (auto* v : {&path.total, &path.apparent, &path.contrast}) v->assign(bands, 0.0);
    path.part.resize(all.scene.part.size());
    if (all.grey) {
      for (std::size_t q = 0; q < path.part.size(); ++q)
        for (std::size_t b = 0; b < bands; ++b) path.part[q].push_back(all.part_in_band[b][q]);
      path.sky = all.sky_in_band;
      path.lower = all.lower_in_band;
      path.sunlight = all.sun_in_band;
    }
    std::array<double, kBase.size()> shift{};
    for (double& s : shift) s = random();
    std::vector<double> value(4 * bands, 0.0), gross(bands, 0.0);
    for (std::uint64_t i = 0; i < samples; ++i) {
      for (std::size_t d = 0; d < kBase.size(); ++d) {
        const double x = radical_inverse(i + 1, kBase[d]) + shift[d];
        path.u[d] = x - std::floor(x);
      }
      all.trace(path);
      for (std::size_t b = 0; b < bands; ++b) {
        value[4 * b] += path.total[b];
        value[4 * b + 1] += path.apparent[b];
        value[4 * b + 2] += path.contrast[b];
        value[4 * b + 3] += path.area_m2;
        gross[b] += std::abs(path.total[b]);
      }
      if (all.mirrors.item.empty()) continue;
      all.trace_from_sun(path);
      for (std::size_t b = 0; b < bands; ++b) {
        value[4 * b] += path.total[b];
        value[4 * b + 1] += path.apparent[b];
        value[4 * b + 2] += path.apparent[b];
        gross[b] += path.total[b];
      }
    }
    for (double& v : value) v /= static_cast<double>(samples);
    statistics.add(value);
    for (std::size_t b = 0; b < bands; ++b)
      out.row[b].gross_w_sr += gross[b] / static_cast<double>(samples) / kBatches;
    out.rays += path.rays;
  }
  for (std::size_t b = 0; b < bands; ++b) {
    Row& r = out.row[b];
    r.total = statistics.estimate(4 * b);
    r.apparent = statistics.estimate(4 * b + 1);
    r.contrast = statistics.estimate(4 * b + 2);
    r.projected_area_m2 = statistics.estimate(4 * b + 3);
  }
  return out;
}

ReferenceView::ReferenceView(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
ReferenceView::~ReferenceView() = default;
ReferenceView::ReferenceView(ReferenceView&&) noexcept = default;
ReferenceView& ReferenceView::operator=(ReferenceView&&) noexcept = default;

}  // namespace irsig
