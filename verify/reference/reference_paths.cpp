#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/constants.h"
#include "core/spectral/planck.h"
#include "verify/reference/reference_view_parts.h"

namespace irsig {

using namespace reference_view;

namespace {

// Roulette begins at a throughput below this.
constexpr double kThin = 0.5;
// Balance heuristic: the share of drawn directions in light that is aimed at as well. None where it
// would be below a hundredth: one path in 1e5 would carry it.
double drawn_fraction(double by_lobe, double aimed) {
  const double share = by_lobe / (by_lobe + aimed);
  return share < 0.01 ? 0 : share;
}

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

}  // namespace

// Returns true if the ray from + t v, 0 < t < end, goes through the sphere of the Earth that
// touches z = 0 at the reference point. To first order, twice the radius times the height above the
// sphere is
//   |p|^2 + 2 z_down (-R)  =  |p|^2 - 2 R z.
bool ReferenceView::Parts::meets_earth(Body3 from, Body3 v, double end) const {
  const double b = dot(from, v) - kEarthRadiusM * v.z, a = dot(v, v);
  const double lowest = -b / a;
  if (!(lowest > 0)) return false;
  const double t = std::min(lowest, end);
  const double height = dot(from, from) - 2 * kEarthRadiusM * from.z + 2 * t * b + t * t * a;
  return height < 0;
}

bool ReferenceView::Parts::buried(Body3 x) const {
  return land ? land->covers(x) : surface && x.z > 0;
}

bool ReferenceView::Parts::hidden(Body3 x, Body3 towards, double distance_m) const {
  if (!land) return surface && meets_earth(x, towards, distance_m);
  return land->hides(x - Body3{0, 0, 1e-9 * size_m}, towards, distance_m);
}

std::optional<double> ReferenceView::Parts::see_land(Path& p, Body3 from, Body3 towards,
                                                     bool shaded,
                                                     std::vector<double>& radiance) const {
  if (!land) return std::nullopt;
  LandMix mix;
  const std::optional<LandPoint> at = land->meet(from, towards, mix);
  if (!at) return std::nullopt;
  double sunlit = sun ? land->sun_cosine(*at, condition.sun_direction) : 0;
  const Body3 place = from + at->distance * towards;
  if (sunlit > 0 && shaded &&
      blocked(place, condition.sun_direction, std::numeric_limits<std::uint32_t>::max(), 1e30,
              p.rays))
    sunlit = 0;
  const double open = 0.5 * (1 + at->normal.z);
  for (std::size_t i = 0; i < channels(); ++i) {
    radiance[i] = 0;
    for (const KindShare& part : mix.kind) {
      const double e = land_emissivity[land->material_of(part.kind)],
                   black = grey ? land_in_band[i][part.kind]
                                : planck_radiance_w_m2_sr_um(
                                      p.lambda_um[i], condition.land_temperature_k[part.kind]);
      radiance[i] += static_cast<double>(part.share) *
                     (e * black + (1 - e) * (open * p.sky[i] + (1 - open) * black +
                                             sunlit * p.sunlight[i] / kPi));
    }
  }
  return at->distance;
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
  if (cos_o <= 0 || buried(x)) return;
  if (hidden(x, to_eye, distance_m)) return;
  if (blocked(x, to_eye, own, distance_m, p.rays)) return;
  const double range_m = viewpoint.range_m;
  const double w0 = cos_o * (range_m / distance_m) * (range_m / distance_m) * first.area_m2 /
                    primary.share(picked);
  p.area_m2 = w0;
  const Body3 look = -1.0 * to_eye, seen_at = x;

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
    // Light of the sun that mirrors send on to a matt surface is counted from the sun's side.
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
        const double share = at.cos_i * (1 - drawn_fraction(by_lobe, aimed)) / aimed;
        double most = 0;
        for (std::size_t i = 0; i < n; ++i) {
          p.source[i] *= p.through[i] * share * p.sunlight[i] / sun_solid_angle;
          most = std::max(most, p.source[i]);
        }
        if (most > 0 && !blocked(x, wi, own, 1e30, p.rays) && !(land && hidden(x, wi, 1e9)))
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
      if (target != own && cos_l > 0 && d > 1e-9 * size_m && !buried(y) && reflected(wi, at)) {
        const double aimed = hot_density[target] * d * d / cos_l;
        const double share = at.cos_i * (1 - drawn_fraction(f.density_per_sr(at), aimed)) / aimed;
        f.brdf_per_sr(at, p.lambda_um, p.source);
        const double most = *std::max_element(p.source.begin(), p.source.end());
        if (most > 0) {
          ++p.rays;
          const auto met = meet(x, wi, own, d * (1 - 1e-9));
          if (!met.met() || met.facet == target) {
            // The lamp's emission in this direction: 1 less the weight of a drawn direction.
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
    const std::optional<double> land_m = see_land(p, x, wi, true, p.land);
    if (land_m && (!hit.met() || *land_m < hit.t)) {
      for (std::size_t i = 0; i < n; ++i) p.sum[i] += p.through[i] * p.land[i];
      break;
    }
    if (!hit.met() || (!land && surface && next.z > 0)) {
      const std::vector<double>& beyond =
          wi.z < sine_of_dip(land ? condition.above_surface_m : 0) ? p.sky : p.lower;
      for (std::size_t i = 0; i < n; ++i) p.sum[i] += p.through[i] * beyond[i];
      if (of_sun && !hit.met() && !(surface && wi.z > 0) &&
          dot(wi, condition.sun_direction) > cos_sun && !(land && hidden(x, wi, 1e9))) {
        const double share = drawn_fraction(drawn.density_per_sr, 1 / sun_solid_angle);
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
      unaimed = drawn_fraction(drawn.density_per_sr, aimed);
    }
    own = hit.facet;
    x = next;
  }

  // At the sensor, through the air of this point's own distance.
  const std::optional<double> behind_m = see_land(p, seen_at, look, false, p.land);
  const double extinction = extinction_per_m();
  const double seen = std::exp(-extinction * distance_m),
               at_range = std::exp(-extinction * (behind_m ? distance_m + *behind_m : range_m));
  const Body3 above_ground = sensor - Body3{0, 0, land ? condition.above_surface_m : 0};
  const bool sea = surface || land ? meets_earth(above_ground, look, 1e30) : look.z > 0;
  const std::vector<double>& behind = behind_m ? p.land : sea ? p.lower : p.sky;
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
  if ((surface && from.z > 0) || buried(x)) return;
  std::uint32_t part = facet[own].part;
  Body3 normal = facet[own].normal;
  double cos_i = dot(normal, from);
  if (cos_i < 0 && scene.part[part].two_sided) {
    normal = -1.0 * normal;
    cos_i = -cos_i;
  }
  if (cos_i <= 0 || blocked(x, from, own, 1e30, p.rays) || (land && hidden(x, from, 1e9))) return;
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
      if (out[2] > 0 && !hidden(x, to_eye, distance_m) &&
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
    if (buried(x)) return;
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

}  // namespace irsig
