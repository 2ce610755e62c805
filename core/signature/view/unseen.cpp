#include "core/signature/view/unseen.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <type_traits>
#include <unordered_map>

#include "core/accuracy/replicates.h"
#include "core/base/next_large.h"
#include "core/base/sobol.h"
#include "core/base/work_counts.h"

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
//   bent  by how much normals may differ from the one given
ReflectionRange range_of(Vec<Body> normal, Vec<Body> to_light, const Cosines& cos_i,
                         Vec<Body> to_sensor, const Cosines& cos_o, double turns, double bent) {
  const double cos_d = 0.5 * (cos_i.least + cos_o.least);
  const Vec<Body> half = to_light + to_sensor;
  double tan2 = 0;
  if (const double size = length(half); size > 0 && cos_d > 0) {
    const double along = std::clamp(dot(normal, half) / size, -1.0, 1.0);
    const double angle = std::acos(along) - turns / (2 * cos_d) - bent;
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

// One facet of the target as double precision has it, or several that face one way.
struct UndersampledSources::Patch {
  Vec<Body> middle{}, normal, to_sensor{};
  double area_m2, reach_m;  // from the middle to the farthest corner
  bool two_sided;
  std::uint32_t material;
  Spread sight{};  // of to_sensor, from corner to corner
  std::uint32_t facet = 0;
  double shows = 0, seen_m2 = 0;  // its DHR towards the sensor; 0: it is not seen
  double bent = 0;                // by how much normals differ from `normal`
};

namespace {

// Facets of one kind whose normals and whose directions to the sensor fall into the same cells.
struct FacingKey {
  std::array<std::int32_t, 8> cell;
  bool operator==(const FacingKey&) const = default;
};
struct FacingHash {
  std::size_t operator()(const FacingKey& key) const {
    std::uint64_t h = 0;
    for (const std::int32_t c : key.cell) h = mix64(h ^ static_cast<std::uint32_t>(c));
    return h;
  }
};

}  // namespace

std::vector<UndersampledSources::Patch> UndersampledSources::gathered(
    const std::function<std::uint32_t(const Patch&)>& kind) const {
  std::unordered_map<FacingKey, std::uint32_t, FacingHash> known;
  std::vector<Patch> out;
  std::vector<std::uint32_t> place;
  place.reserve(patch_.size());
  for (const Patch& p : patch_) {
    const auto at = [&](double x) {
      return static_cast<std::int32_t>(std::lround(x / kFacingCell));
    };
    const FacingKey key{{at(p.normal.x), at(p.normal.y), at(p.normal.z), at(p.to_sensor.x),
                         at(p.to_sensor.y), at(p.to_sensor.z),
                         static_cast<std::int32_t>(2 * p.material + (p.two_sided ? 1 : 0)),
                         static_cast<std::int32_t>(kind(p))}};
    const auto [found, fresh] = known.try_emplace(key, static_cast<std::uint32_t>(out.size()));
    place.push_back(found->second);
    if (fresh) {
      Patch& first = out.emplace_back(p);
      first.area_m2 = first.seen_m2 = first.shows = 0;
      first.normal = first.to_sensor = {0, 0, 0};
    }
    Patch& here = out[found->second];
    here.area_m2 += p.area_m2;
    here.normal = here.normal + p.normal;
    here.to_sensor = here.to_sensor + p.to_sensor;
  }
  for (Patch& here : out) {
    here.normal = normalized(here.normal);
    here.to_sensor = normalized(here.to_sensor);
    here.sight.angle = 0;
  }
  for (std::size_t i = 0; i < patch_.size(); ++i) {
    const Patch& p = patch_[i];
    Patch& here = out[place[i]];
    here.bent = std::max(here.bent, angle_between(p.normal, here.normal));
    here.sight.angle =
        std::max(here.sight.angle, p.sight.angle + angle_between(p.to_sensor, here.to_sensor));
  }
  for (Patch& here : out) here.sight = spread_of(here.sight.angle);
  return out;
}

// Light of a sun that one side of a facet sends on.
struct UndersampledSources::Thrown {
  double to_anyone = 0, light = 0, irradiance = 0, cos_i = 0;

  // Calls visit(radiance, light) from bright to dark: by the fractions of the material's reflected
  // light, then for directions that these may have missed, as bright as they can be. Ends when
  // visit returns false.
  template <typename Visit>
  void for_each_share(const Material& material, Visit&& visit) const {
    if (!(to_anyone > 0)) return;
    const auto classes = material.thrown_light().of(cos_i);
    // Where no direction was met all of it may be that bright.
    visit(to_anyone, light * (classes.empty() ? 1 : ThrownLight::not_met()));
    for (const ThrownLight::Class& one : classes)
      if (!visit(std::min(to_anyone, irradiance * one.per_sr), light * one.share)) return;
  }
};

namespace {

// Returns the quarter octave of a radiance, > 0: its exponent and the two bits behind it.
int quarter_octave(double radiance) {
  if (radiance < std::numeric_limits<double>::min()) {
    int octave = 0;
    const double mantissa = std::frexp(radiance, &octave);
    return 4 * octave + static_cast<int>(8 * mantissa);
  }
  // The exponent counts from -1022, and the mantissa's two bits from 4, as frexp has both.
  return static_cast<int>(std::bit_cast<std::uint64_t>(radiance) >> 50) - 4 * 1022 + 4;
}

}  // namespace

SmallBrightSources::Places& SmallBrightSources::places_of(int key) {
  if (places_.empty()) lowest_ = key;
  if (key < lowest_) {
    places_.insert(places_.begin(), static_cast<std::size_t>(lowest_ - key), Places{});
    lowest_ = key;
  }
  const auto at = static_cast<std::size_t>(key - lowest_);
  if (at >= places_.size()) places_.resize(at + 1);
  return places_[at];
}

void SmallBrightSources::add(double radiance, double seen_m2) {
  if (!(radiance > 0 && seen_m2 > 0)) return;
  Places& here = places_of(quarter_octave(std::min(radiance, std::numeric_limits<double>::max())));
  here.brightest = std::max(here.brightest, radiance);
  here.sum += radiance * seen_m2;
}

double SmallBrightSources::sum() const {
  double sum = 0;
  for (auto here = places_.rbegin(); here != places_.rend(); ++here) sum += here->sum;
  return sum;
}

double SmallBrightSources::brightest() const {
  return places_.empty() ? 0 : places_.back().brightest;
}

SmallBrightSources::Allowance SmallBrightSources::allowance(double sample_m2) const {
  Allowance best;
  double least = std::numeric_limits<double>::infinity(), bound = 0;
  const auto consider = [&](double missed) {
    const double error = numerical_error(0, missed, bound);
    if (error >= least) return;
    least = error;
    best = {bound, missed};
  };
  for (auto here = places_.rbegin(); here != places_.rend(); ++here) {
    if (here->brightest == 0) continue;
    consider(2 * sample_m2 * here->brightest);
    bound += here->sum;
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

UndersampledSources::UndersampledSources(const Target& target,
                                         std::shared_ptr<const TargetFacets> facets,
                                         const std::vector<Material>& materials,
                                         const ViewFrame& frame)
    : target_(target),
      facets_(std::move(facets)),
      materials_(materials),
      convex_(target.convex),
      dhr_(materials.size(), 0.0),
      mean_dhr_(materials.size(), 0.0) {
  constexpr int kAngles = 64;
  for (std::size_t m = 0; m < materials.size(); ++m)
    for (int k = 1; k <= kAngles; ++k) {
      const double here = materials[m].dhr_max(static_cast<float>(k) / kAngles);
      dhr_[m] = std::max(dhr_[m], here);
      mean_dhr_[m] += here * (2 * k - 1) / (kAngles * kAngles);
    }
  double largest_mean_dhr = 0;
  patch_.reserve(target.facet.size());
  for (std::size_t t = 0; t < target.facet.size(); ++t) {
    const Target::Facet& facet = target.facet[t];
    const PartSpec& part = target.part[facet.part];
    const std::array<Vec<Body>, 3> corner = target.corners(t);
    Patch p{{}, {facet.nx, facet.ny, facet.nz}, {}, 0, 0, part.two_sided, part.material,
            {}, static_cast<std::uint32_t>(t)};
    for (const Vec<Body>& c : corner) p.middle = p.middle + (1.0 / 3) * c;
    p.area_m2 = 0.5 * length(cross(corner[1] - corner[0], corner[2] - corner[0]));
    if (!(p.area_m2 > 0)) continue;
    for (const Vec<Body>& c : corner) p.reach_m = std::max(p.reach_m, length(c - p.middle));
    const Vec<Body> line = frame.sensor - p.middle;
    const double distance = length(line), sine = std::min(1.0, p.reach_m / distance);
    p.to_sensor = (1 / distance) * line;
    p.sight = {std::asin(sine), std::sqrt(1 - sine * sine), sine};
    Patch& kept = patch_.emplace_back(p);

    largest_dhr_ = std::max(largest_dhr_, dhr_[p.material]);
    largest_mean_dhr = std::max(largest_mean_dhr, mean_dhr_[p.material]);
    const double cosine = dot(p.normal, p.to_sensor);
    const Cosines cos_o = cosines_about(p.two_sided ? std::abs(cosine) : cosine, p.sight);
    if (cos_o.most <= 0) continue;
    const Material& material = materials[p.material];
    const double shows = dhr_between(material, cos_o, dhr_[p.material]),
                 seen_m2 = p.area_m2 * cos_o.most;
    kept.shows = shows;
    kept.seen_m2 = seen_m2;
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

UndersampledSources::~UndersampledSources() = default;

const UndersampledSources::Sun& UndersampledSources::of(const SunDirection& sun) const {
  SunDirection alone = sun;
  alone.sea_wind_m_s = alone.horizon_z = 0;
  const std::lock_guard lock(mutex_);
  for (const auto& [direction, light] : sun_)
    if (direction == alone) return light;
  return sun_.emplace_back(alone, make(alone)).second;
}

namespace {

// A sun at a place.
struct LightAt {
  Vec<Body> to_sun;
  double irradiance;  // relative to that at the target's centre
  Spread spread;      // of to_sun: its disk and the place's reach
};
LightAt light_at(const SunDirection& sun, Vec<Body> middle, double reach_m) {
  if (!(sun.distance_m > 0)) return {sun.direction, 1, spread_of(sun.angular_radius_rad)};
  const Vec<Body> to_sun = sun.direction - (1 / sun.distance_m) * middle;
  return {normalized(to_sun), 1 / dot(to_sun, to_sun),
          spread_of(sun.angular_radius_rad + reach_m / sun.distance_m)};
}

double disk_per_sr(const SunDirection& sun) {
  return 1 / (kPi * std::pow(std::tan(sun.angular_radius_rad), 2));
}

Spread bent_by(const Spread& spread, double bent) {
  return bent > 0 ? spread_of(spread.angle + bent) : spread;
}

}  // namespace

// Both sides of a sheet may be seen, and lit, within the spreads of the directions.
template <typename Visit>
void UndersampledSources::for_each_shown(const SunDirection& sun, const std::vector<Patch>& patches,
                                         Visit&& visit) const {
  count_work(Work::kPatches, patches.size());
  const double of_disk = disk_per_sr(sun);
  const bool lamp = sun.distance_m > 0;
  LightAt light = light_at(sun, {}, 0);
  for (const Patch& p : patches) {
    const double towards = dot(p.normal, p.to_sensor);
    if (!p.two_sided && towards <= -p.sight.sine - p.bent) continue;
    if (lamp) light = light_at(sun, p.middle, p.reach_m);
    const Spread to_light = bent_by(light.spread, p.bent), sight = bent_by(p.sight, p.bent);
    for (const double side : {1.0, -1.0}) {
      if (side < 0 && !p.two_sided) break;
      const Vec<Body> n = side * p.normal;
      const Cosines cos_i = cosines_about(dot(n, light.to_sun), to_light),
                    cos_o = cosines_about(side * towards, sight);
      if (cos_i.most <= 0 || cos_o.most <= 0) continue;
      const ReflectionRange range = range_of(n, light.to_sun, cos_i, p.to_sensor, cos_o,
                                             light.spread.angle + p.sight.angle, p.bent);
      const double limit = materials_[p.material].cos_brdf_limit_per_sr(range);
      visit(p, light.irradiance * std::min(dhr_[p.material] * of_disk, limit),
            p.area_m2 * cos_o.most);
    }
  }
}

template <typename Surface, typename Visit>
void UndersampledSources::for_each_thrown(const SunDirection& sun,
                                          const std::vector<Surface>& surfaces,
                                          Visit&& visit) const {
  count_work(Work::kPatches, surfaces.size());
  const double of_disk = disk_per_sr(sun);
  LightAt light = light_at(sun, {}, 0);
  for (const Surface& s : surfaces) {
    if constexpr (std::is_same_v<Surface, Patch>)
      if (sun.distance_m > 0) light = light_at(sun, s.middle, s.reach_m);
    const Material& material = materials_[s.material];
    const double disk = dhr_[s.material] * of_disk;
    const Spread to_light = bent_by(light.spread, s.bent);
    for (const double side : {1.0, -1.0}) {
      if (side < 0 && !s.two_sided) break;
      const Cosines cos_i = cosines_about(side * dot(s.normal, light.to_sun), to_light);
      if (cos_i.most <= 0) continue;
      Thrown out;
      out.irradiance = light.irradiance;
      out.cos_i = 0.5 * (cos_i.least + cos_i.most);
      out.to_anyone = light.irradiance *
                      std::min(disk, material.limit_of_light_per_sr(cos_i.least, cos_i.most));
      if (!convex_ && out.to_anyone > 0)
        out.light = light.irradiance * s.area_m2 * cos_i.most *
                    dhr_between(material, cos_i, dhr_[s.material]);
      visit(s, out);
    }
  }
}

template <typename Visit>
void UndersampledSources::for_each_thrown(const SunDirection& sun, Visit&& visit) const {
  // Every facet has a direction of its own to a lamp.
  if (sun.distance_m > 0)
    for_each_thrown(sun, patch_, visit);
  else
    for_each_thrown(sun, facets_->facings(target_), visit);
}

UndersampledSources::Sun UndersampledSources::make(const SunDirection& sun) const {
  Sun out;
  const bool by_facet = sun.distance_m > 0;
  if (!by_facet && gathered_patch_.empty())
    gathered_patch_ = gathered([](const Patch&) { return 0u; });
  for_each_shown(sun, by_facet ? patch_ : gathered_patch_,
                 [&](const Patch&, double radiance, double m2) { out.first.add(radiance, m2); });
  double most_irradiance = 0;
  for_each_thrown(sun, [&](const auto& s, const Thrown& thrown) {
    out.brightest_per_sr = std::max(out.brightest_per_sr, thrown.to_anyone);
    most_irradiance = std::max(most_irradiance, thrown.irradiance);
    if (convex_) return;
    thrown.for_each_share(materials_[s.material], [&](double radiance, double light) {
      if (const double bright = radiance * passed_on_; bright > 0)
        out.later.add(bright, light * gathered_mean_ * shown_per_sr_ / bright);
      return true;
    });
  });
  out.brightest_per_sr = std::min(out.brightest_per_sr * (convex_ ? 1 : gathered_),
                                  most_irradiance * std::max(1.0, largest_dhr_) * disk_per_sr(sun));
  return out;
}

namespace {

// Returns the largest radiance of light thrown onto a facet, per thrown irradiance. [1/sr]
double shown_per_sr(const Material& material, double shows) {
  const double slope = material.narrowest_slope();
  return shows / kPi * std::max(1.0, 1 / (4 * slope * slope));
}

}  // namespace

std::vector<UndersampledSources::Stratum> UndersampledSources::by_stratum(
    const AimedView& view, std::span<const SunDirection> suns) const {
  const Above& above = this->above();
  std::vector<Stratum> out(view.stratum.size());
  std::vector<double> passed_on(out.size(), 0.0), shown(out.size(), 0.0), gathered(out.size(), 1.0);
  const auto stratum_of = [&](const Patch& p) {
    return view.stratum_of(p.facet, target_.facet[p.facet].part);
  };
  for (Stratum& s : out) {
    s.first.resize(suns.size());
    s.later.resize(suns.size());
  }
  std::vector<std::vector<std::size_t>> place(
      out.size(), std::vector<std::size_t>(above.sets.size(), SIZE_MAX));
  for (std::size_t i = 0; i < patch_.size(); ++i) {
    const Patch& p = patch_[i];
    if (!(p.seen_m2 > 0)) continue;
    const std::uint32_t s = stratum_of(p);
    const std::uint32_t set = above.of_patch[i];
    passed_on[s] = std::max(passed_on[s], p.shows);
    shown[s] = std::max(shown[s], shown_per_sr(materials_[p.material], p.shows));
    // Whatever light does elsewhere, it comes back to these facets only if they have thrown it.
    gathered[s] = std::max(gathered[s], 1 / (1 - std::min(mean_dhr_[p.material], 0.99)));
    out[s].reflected.add(p.shows, p.seen_m2);
    std::size_t& at = place[s][set];
    if (at == SIZE_MAX) {
      at = out[s].parts.size();
      out[s].parts.push_back({above.sets[set], {}});
    }
    out[s].parts[at].reflected.add(p.shows, p.seen_m2);
  }
  const std::vector<Patch> gathered_in =
      this->gathered([&](const Patch& p) { return stratum_of(p); });
  for (std::size_t j = 0; j < suns.size(); ++j) {
    for_each_shown(suns[j], suns[j].distance_m > 0 ? patch_ : gathered_in,
                   [&](const Patch& p, double radiance, double m2) {
                     out[stratum_of(p)].first[j].add(radiance, m2);
                   });
    if (convex_) continue;
    for_each_thrown(suns[j], [&](const auto& surface, const Thrown& thrown) {
      thrown.for_each_share(materials_[surface.material], [&](double radiance, double light) {
        for (std::size_t s = 0; s < out.size(); ++s)
          if (const double bright = radiance * passed_on[s]; bright > 0)
            out[s].later[j].add(bright, light * gathered[s] * shown[s] / bright);
        return true;
      });
    });
  }
  return out;
}

std::vector<double> UndersampledSources::with_reflected(const std::vector<double>& emitted) const {
  const Above& above = this->above();
  std::vector<double> out = emitted;
  // Emission and what is reflected of radiance R: at most B + DHR R, and at most the larger of
  // both.
  constexpr int kRounds = 64;
  for (int round = 0; round < kRounds; ++round) {
    bool changed = false;
    for (std::size_t p = 0; p < out.size(); ++p) {
      const double dhr = dhr_[target_.part[p].material];
      for (std::size_t q = 0; q < out.size(); ++q) {
        if (!above.parts[p][q]) continue;
        const double most = std::min(emitted[p] + dhr * out[q], std::max(emitted[p], out[q]));
        if (most <= (1 + 1e-9) * out[p]) continue;
        out[p] = most;
        changed = true;
      }
    }
    if (!changed) return out;
  }
  const double brightest = *std::max_element(emitted.begin(), emitted.end());
  return std::vector<double>(emitted.size(), brightest);
}

std::vector<UndersampledSources::Facet> UndersampledSources::facets(const SunDirection* sun,
                                                                    double least_m2_per_sr) const {
  const Above& above = this->above();
  std::vector<Facet> out;
  std::vector<std::size_t> at(patch_.size(), SIZE_MAX);
  for (std::size_t i = 0; i < patch_.size(); ++i) {
    if (!(patch_[i].seen_m2 > 0)) continue;
    at[i] = out.size();
    out.push_back({patch_[i].facet, patch_[i].seen_m2, 0, 0, patch_[i].shows, above.of_patch[i]});
  }
  if (sun == nullptr) return out;
  struct Thrower {
    const Patch* patch;
    double to_anyone, thrown;
  };
  std::vector<Thrower> thrower;
  for_each_shown(*sun, patch_, [&](const Patch& p, double radiance, double) {
    const std::size_t k = at[static_cast<std::size_t>(&p - patch_.data())];
    if (k != SIZE_MAX) out[k].first = std::max(out[k].first, radiance);
  });
  for_each_thrown(*sun, patch_, [&](const Patch& p, const Thrown& thrown) {
    // The light counts as bright as the part above the least that counts, whoever shows it.
    double bright = 0, all = 0;
    thrown.for_each_share(materials_[p.material], [&](double radiance, double light) {
      bright = radiance;
      all += light;
      return all * shown_per_sr_ < least_m2_per_sr;
    });
    if (thrown.light > 0) thrower.push_back({&p, bright, thrown.light});
  });
  std::stable_sort(thrower.begin(), thrower.end(),
                   [](const Thrower& a, const Thrower& b) { return a.to_anyone > b.to_anyone; });
  std::vector<double> thrown;
  for (const Thrower& t : thrower) thrown.push_back(t.thrown);
  const NextLarge strong(thrown);
  constexpr int kMostTried = 64;  // then the next is taken to be seen
  std::size_t all_tried = 0;
  for (std::size_t i = 0; i < patch_.size(); ++i) {
    if (at[i] == SIZE_MAX) continue;
    const Patch& p = patch_[i];
    const double shown = shown_per_sr(materials_[p.material], p.shows);
    int tried = 0;
    const auto enough = [&](double of) { return !(of * shown < least_m2_per_sr); };
    for (std::size_t k = strong.next(0, enough); k < thrower.size();
         k = strong.next(k + 1, enough)) {
      const Thrower& t = thrower[k];
      if (t.patch == &p) continue;
      const Vec<Body> between = t.patch->middle - p.middle;
      const double up = dot(p.normal, between), reach = t.patch->reach_m + p.reach_m;
      const bool faces = p.two_sided || up > -1e-6 * reach,
                 apart = std::abs(up) > 1e-6 * reach || length(between) < reach;
      if (++tried < kMostTried && !(faces && apart)) continue;
      out[at[i]].later = p.shows * t.to_anyone;
      break;
    }
    all_tried += static_cast<std::size_t>(tried);
  }
  count_work(Work::kThrowersTried, all_tried);
  return out;
}

const UndersampledSources::Above& UndersampledSources::above() const {
  const std::lock_guard lock(mutex_);
  if (above_ != nullptr) return *above_;
  const PartsAbove& all = facets_->parts_above(target_);
  auto made = std::make_unique<Above>();
  made->parts = all.of_part;
  std::map<std::vector<bool>, std::uint32_t> known;
  std::map<std::array<std::uint32_t, 2>, std::uint32_t> of_sides;  // seen: front, back
  for (const Patch& p : patch_) {
    const double to_sensor = dot(p.normal, p.to_sensor);
    std::array<std::uint32_t, 2> seen = all.of_facet[p.facet];
    if (!(to_sensor > -p.sight.sine)) seen[0] = 0;
    if (!(-to_sensor > -p.sight.sine)) seen[1] = 0;
    const auto [at, fresh] = of_sides.emplace(seen, 0);
    if (fresh) {
      std::vector<bool> set = all.set[seen[0]];
      for (std::size_t q = 0; q < set.size(); ++q)
        if (all.set[seen[1]][q]) set[q] = true;
      const auto [known_at, is_new] =
          known.emplace(set, static_cast<std::uint32_t>(made->sets.size()));
      if (is_new) made->sets.push_back(std::move(set));
      at->second = known_at->second;
    }
    made->of_patch.push_back(at->second);
  }
  above_ = std::move(made);
  return *above_;
}

}  // namespace irsig
