#include "core/signature/unseen.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/accuracy/replicates.h"

namespace irsig {
namespace {

constexpr double kPi = std::numbers::pi;

// An angle by which directions may differ.
struct Spread {
  double angle, cosine, sine;
};
Spread spread_of(double angle) { return {angle, std::cos(angle), std::sin(angle)}; }

// The cosines of all angles within a spread of the one between two unit vectors.
struct Cosines {
  double least, most;  // least: not below 0
};
Cosines cosines_about(double cosine, const Spread& spread) {
  const double c = std::clamp(cosine, -1.0, 1.0), s = std::sqrt(1 - c * c);
  return {std::max(0.0, c * spread.cosine - s * spread.sine),
          c >= spread.cosine ? 1.0 : c * spread.cosine + s * spread.sine};
}

// All reflections of light between two directions within their spreads. Half vectors turn by at
// most the sum of both turns / (2 cos_d).
ReflectionRange range_of(Vec<Body> normal, Vec<Body> to_light, const Cosines& cos_i,
                         Vec<Body> to_sensor, const Cosines& cos_o, double turns) {
  const double cos_d = 0.5 * (cos_i.least + cos_o.least);
  const Vec<Body> half = to_light + to_sensor;
  double tan2 = 0;
  if (const double size = length(half); size > 0 && cos_d > 0) {
    const double along = std::clamp(dot(normal, half) / size, -1.0, 1.0);
    const double angle = std::acos(along) - turns / (2 * cos_d);
    if (angle > 0 && angle < kPi / 2) {
      const double slope = std::tan(angle);
      tan2 = slope * slope;
    }
  }
  return {cos_i.least, cos_o.least, tan2, cos_i.most, cos_o.most};
}

// The reflectance of a surface seen (or lit) under these cosines.
double dhr_between(const Material& material, const Cosines& cosines, double largest) {
  if (cosines.least < 0.02) return largest;
  return static_cast<double>(std::max(material.dhr_max(static_cast<float>(cosines.least)),
                                      material.dhr_max(static_cast<float>(cosines.most))));
}

}  // namespace

// One facet of the target as double precision has it.
struct UnseenLight::Patch {
  Vec<Body> middle{}, normal, to_sensor{};
  double area_m2, reach_m;  // from the middle to the farthest corner
  bool two_sided;
  std::uint32_t material;
  Spread sight{};  // of to_sensor, from corner to corner
};

void RareLight::add(double radiance, double seen_m2) {
  if (!(radiance > 0 && seen_m2 > 0)) return;
  int octave = 0;
  const double mantissa =
      std::frexp(std::min(radiance, std::numeric_limits<double>::max()), &octave);
  Places& here = places_[4 * octave + static_cast<int>(8 * mantissa)];
  here.brightest = std::max(here.brightest, radiance);
  here.sum += radiance * seen_m2;
}

double RareLight::sum() const {
  double sum = 0;
  for (const auto& [key, here] : places_) sum += here.sum;
  return sum;
}

double RareLight::brightest() const {
  return places_.empty() ? 0 : places_.begin()->second.brightest;
}

RareLight::Allowance RareLight::allowance(double sample_m2) const {
  Allowance best;
  double least = std::numeric_limits<double>::infinity(), bound = 0;
  const auto consider = [&](double missed) {
    const double error = numerical_error(0, missed, bound);
    if (error >= least) return;
    least = error;
    best = {bound, missed};
  };
  for (const auto& [key, here] : places_) {
    consider(2 * sample_m2 * here.brightest);
    bound += here.sum;
    if (numerical_error(0, 0, bound) >= least) return best;
  }
  consider(0);
  return best;
}

std::vector<SeaGlint> brightest_glitter(const SunDirection& sun) {
  std::vector<SeaGlint> out;
  if (!(sun.sea_wind_m_s > 0)) return out;
  const Vec<Body> s = sun.direction;
  const double across = std::hypot(s.x, s.y);
  const Vec<Body> away =
      across > 0 ? Vec<Body>{-s.x / across, -s.y / across, 0} : Vec<Body>{1, 0, 0};
  for (double deg = 0.25; deg < 180; deg += 0.5) {
    const double angle = deg * kPi / 180;
    SeaGlint glint =
        sea_glint(std::cos(angle) * away + Vec<Body>{0, 0, -std::sin(angle)}, s, sun.sea_wind_m_s);
    glint.per_sr *= 1.05f;
    if (glint.per_sr > 0) out.push_back(glint);
  }
  return out;
}

UnseenLight::UnseenLight(const Target& target, const std::vector<Material>& materials,
                         const ViewFrame& frame)
    : materials_(materials), convex_(target.convex), dhr_(materials.size(), 0.0) {
  // Of each material also the mean of all light in a hemisphere.
  std::vector<double> mean_dhr(materials.size(), 0.0);
  constexpr int kAngles = 64;
  for (std::size_t m = 0; m < materials.size(); ++m)
    for (int k = 1; k <= kAngles; ++k) {
      const double here = materials[m].dhr_max(static_cast<float>(k) / kAngles);
      dhr_[m] = std::max(dhr_[m], here);
      mean_dhr[m] += here * (2 * k - 1) / (kAngles * kAngles);
    }
  double largest_mean_dhr = 0;
  for (std::size_t t = 0; t < target.facet.size(); ++t) {
    const Target::Facet& facet = target.facet[t];
    const PartSpec& part = target.part[facet.part];
    Vec<Body> corner[3];
    Patch p{{}, {facet.nx, facet.ny, facet.nz}, {}, 0, 0, part.two_sided, part.material, {}};
    for (std::size_t k = 0; k < 3; ++k) {
      const float* v =
          target.vertex.data() + 3 * static_cast<std::size_t>(target.triangle[3 * t + k]);
      corner[k] = {v[0], v[1], v[2]};
      p.middle = p.middle + (1.0 / 3) * corner[k];
    }
    p.area_m2 = 0.5 * length(cross(corner[1] - corner[0], corner[2] - corner[0]));
    if (!(p.area_m2 > 0)) continue;
    for (const Vec<Body>& c : corner) p.reach_m = std::max(p.reach_m, length(c - p.middle));
    const Vec<Body> line = frame.sensor - p.middle;
    const double distance = length(line), sine = std::min(1.0, p.reach_m / distance);
    p.to_sensor = (1 / distance) * line;
    p.sight = {std::asin(sine), std::sqrt(1 - sine * sine), sine};
    patch_.push_back(p);

    largest_dhr_ = std::max(largest_dhr_, dhr_[p.material]);
    largest_mean_dhr = std::max(largest_mean_dhr, mean_dhr[p.material]);
    const double cosine = dot(p.normal, p.to_sensor);
    const Cosines cos_o = cosines_about(p.two_sided ? std::abs(cosine) : cosine, p.sight);
    if (cos_o.most <= 0) continue;
    const Material& material = materials[p.material];
    const double shows = dhr_between(material, cos_o, dhr_[p.material]),
                 seen_m2 = p.area_m2 * cos_o.most;
    reflected_.add(shows, seen_m2);
    passed_on_ = std::max(passed_on_, shows);
    any_per_sr_ = std::max(any_per_sr_, material.limit_seen_per_sr(0, 1));
    if (cos_o.least > 0.02)
      shown_m2_per_sr_ += seen_m2 * material.limit_seen_per_sr(cos_o.least, cos_o.most);
    else
      edge_on_m2_ += seen_m2 * shows;
    const double slope = material.narrowest_slope();
    shown_per_sr_ = std::max(shown_per_sr_, shows / kPi * std::max(1.0, 1 / (4 * slope * slope)));
  }
  // Light that facets throw at each other again and again: at most, and on average.
  gathered_ = largest_dhr_ < 1 ? 1 / (1 - largest_dhr_) : std::numeric_limits<double>::infinity();
  gathered_mean_ = 1 / (1 - std::min(largest_mean_dhr, 0.99));
}

UnseenLight::~UnseenLight() = default;

const UnseenLight::Sun& UnseenLight::of(const SunDirection& sun) const {
  SunDirection alone = sun;
  alone.sea_wind_m_s = alone.horizon_z = 0;
  const std::lock_guard lock(mutex_);
  for (const auto& [direction, light] : sun_)
    if (direction == alone) return light;
  return sun_.emplace_back(alone, make(alone)).second;
}

UnseenLight::Sun UnseenLight::make(const SunDirection& sun) const {
  Sun out;
  const double disk_per_sr = 1 / (kPi * std::pow(std::tan(sun.angular_radius_rad), 2));
  const Spread disk_spread = spread_of(sun.angular_radius_rad);
  double most_irradiance = 0;
  for (const Patch& p : patch_) {
    const Material& material = materials_[p.material];
    Vec<Body> to_sun = sun.direction;
    double irradiance = 1;
    Spread spread = disk_spread;
    if (sun.distance_m > 0) {
      to_sun = sun.direction - (1 / sun.distance_m) * p.middle;
      irradiance = 1 / dot(to_sun, to_sun);
      to_sun = normalized(to_sun);
      spread = spread_of(sun.angular_radius_rad + p.reach_m / sun.distance_m);
    }
    const double disk = dhr_[p.material] * disk_per_sr;
    // Both sides of a sheet may be seen, or lit, within those spreads.
    for (const double side : {1.0, -1.0}) {
      if (side < 0 && !p.two_sided) break;
      const Vec<Body> n = side * p.normal;
      const Cosines cos_i = cosines_about(dot(n, to_sun), spread),
                    cos_o = cosines_about(dot(n, p.to_sensor), p.sight);
      if (cos_i.most <= 0) continue;
      if (cos_o.most > 0) {
        const ReflectionRange range =
            range_of(n, to_sun, cos_i, p.to_sensor, cos_o, spread.angle + p.sight.angle);
        out.first.add(irradiance * std::min(disk, material.cos_brdf_limit_per_sr(range)),
                      p.area_m2 * cos_o.most);
      }
      const double to_anyone =
          irradiance * std::min(disk, material.limit_of_light_per_sr(cos_i.least, cos_i.most));
      out.brightest_per_sr = std::max(out.brightest_per_sr, to_anyone);
      most_irradiance = std::max(most_irradiance, irradiance);
      const double bright = to_anyone * passed_on_;
      if (convex_ || bright <= 0) continue;
      const double thrown = irradiance * p.area_m2 * cos_i.most *
                            dhr_between(material, cos_i, dhr_[p.material]) * gathered_mean_;
      out.later.add(bright, thrown * shown_per_sr_ / bright);
    }
  }
  out.brightest_per_sr = std::min(out.brightest_per_sr * (convex_ ? 1 : gathered_),
                                  most_irradiance * std::max(1.0, largest_dhr_) * disk_per_sr);
  return out;
}

}  // namespace irsig
