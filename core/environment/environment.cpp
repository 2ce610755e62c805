#include "core/environment/environment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/check.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/environment/broken_cloud.h"
#include "core/environment/fit/lazy.h"
#include "core/environment/light_bounds.h"
#include "core/environment/line_horizon.h"
#include "core/environment/sensor_path.h"
#include "core/environment/sun_light.h"
#include "core/environment/thermal_surroundings.h"
#include "core/environment/view_light.h"
#include "core/spectral/planck.h"
#include "core/spectral/solar.h"

namespace irsig {
namespace {

// Sines of the elevation of the rings. Towards the horizon the air gets thick within a degree.
constexpr std::array kSkySines = {0.0f,   0.003f, 0.008f, 0.015f, 0.024f, 0.034f, 0.045f, 0.058f,
                                  0.072f, 0.088f, 0.106f, 0.126f, 0.148f, 0.173f, 0.2f,   0.23f,
                                  0.264f, 0.302f, 0.345f, 0.393f, 0.447f, 0.507f, 0.575f, 0.65f,
                                  0.735f, 0.82f,  0.9f,   0.96f,  1.0f};
// Below the horizon: from the dip at which the sea begins to the nadir, as shares of the way.
constexpr std::array kLowerSines = {0.0,   0.0006, 0.0015, 0.003, 0.006, 0.011, 0.02,
                                    0.033, 0.05,   0.07,   0.095, 0.13,  0.17,  0.22,
                                    0.28,  0.35,   0.43,   0.52,  0.65,  0.8,   1.0};
constexpr std::uint32_t kAzimuths = 24;

absl::Status check(const WeatherSpec& w) {
  const SurfaceBoundary& l = w.lower;
  if (!(w.cloud_cover >= 0 && w.cloud_cover <= 1)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("cloud_cover %g: expected 0 to 1", w.cloud_cover));
  }
  if (w.cloud_cover > 0 && !w.cloud) {
    return absl::InvalidArgumentError(
        absl::StrFormat("cloud_cover %g without a cloud: expected its layer", w.cloud_cover));
  }
  if (!(l.temperature_k >= 100 && l.temperature_k <= 400)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("surface temperature_k %g: expected 100 to 400", l.temperature_k));
  }
  const bool grey =
      l.kind == SurfaceBoundary::Kind::kGreySea || l.kind == SurfaceBoundary::Kind::kGround;
  if (grey && !(l.emissivity >= 0 && l.emissivity <= 1)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("surface emissivity %g: expected 0 to 1", l.emissivity));
  }
  constexpr double kMostWindMS = 150;  // more than any storm
  if (l.kind == SurfaceBoundary::Kind::kRoughSea &&
      !(l.wind_speed_m_s >= 0 && l.wind_speed_m_s <= kMostWindMS)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("wind_speed_m_s %g: expected 0 to %g", l.wind_speed_m_s, kMostWindMS));
  }
  return absl::OkStatus();
}

// Rings between the horizontal and the horizon of targets in the air, where rays that leave the
// target fall and yet miss the surface: sines of their depression, increasing. How many there are
// depends on the heights alone, so that moved inputs have as many.
//   dip  sine of the largest dip, by height
std::vector<float> limb_rings(const std::map<double, double>& dip) {
  // A few of many heights stand for all: the error of interpolating between rings is measured.
  constexpr std::size_t kMostHeights = 6;
  constexpr std::array kOfDip = {0.35, 0.65, 0.85, 0.95, 0.999};
  std::vector<float> out;
  if (dip.empty()) return out;
  const std::vector<std::pair<double, double>> of(dip.begin(), dip.end());
  const std::size_t count = std::min(of.size(), kMostHeights);
  out.push_back(0);
  for (std::size_t i = 0; i < count; ++i) {
    const double sine = of[count > 1 ? i * (of.size() - 1) / (count - 1) : 0].second;
    for (const double share : kOfDip) out.push_back(static_cast<float>(share * sine));
  }
  std::sort(out.begin(), out.end());
  for (std::size_t i = 1; i < out.size(); ++i)
    out[i] = std::max(out[i], std::nextafter(out[i - 1], 1.0f));
  return out;
}

// The rest of a unit vector where its z is another.
Vec<Body> with_elevation(Vec<Body> v, double elevation_rad) {
  const double level = std::hypot(v.x, v.y), c = std::cos(elevation_rad);
  return {level > 0 ? c * v.x / level : c, level > 0 ? c * v.y / level : 0,
          -std::sin(elevation_rad)};
}

// How far below the horizon the sun lights no air that matters: below 1 % of the light that is
// scattered with the sun 1 deg up (tests/physics/twilight_test.cpp).
constexpr double kTwilightRad = 6 * kRadPerDeg;

// A ray that arrives at an elevation a left the sun at a - bending(a).
Environment::SunSeen sun_from(const AirProfile& air, const GrazingRay& ray, double height_m,
                              const ConditionEnvironment& c, bool refraction) {
  const double true_rad = std::asin(std::clamp(-c.sun_direction.z, -1.0, 1.0));
  const double dip = ray.dip_rad(height_m);
  const double radius =
      std::asin(std::min(1.0, kSolarRadiusM / (kAstronomicalUnitM * c.sun_distance_au)));
  const auto bending = [&](double elevation_rad) {
    const double zenith_deg = 90 - elevation_rad / kRadPerDeg;
    return look(air, height_m, std::clamp(zenith_deg, 0.0, 180.0),
                std::numeric_limits<double>::infinity(), true)
               .bending_deg *
           kRadPerDeg;
  };
  double seen_rad = true_rad;
  if (refraction && !ray.straight()) {
    // A hair above the ray that touches the surface.
    const double lowest = -dip + 1e-6, at_horizon = bending(lowest);
    if (true_rad <= lowest - at_horizon) {
      seen_rad = true_rad + at_horizon;
    } else {
      double low = std::max(lowest, true_rad), high = low + at_horizon + 1e-6;
      for (int i = 0; i < 24; ++i) {  // to 1e-9
        const double middle = std::min(0.5 * (low + high), 0.5 * std::numbers::pi);
        (middle - bending(middle) < true_rad ? low : high) = middle;
      }
      seen_rad = 0.5 * (low + high);
    }
  }
  Environment::SunSeen out;
  out.direction = refraction ? with_elevation(c.sun_direction, seen_rad) : c.sun_direction;
  out.horizon_z = std::sin(dip);
  // The segment of a circle above a line, and the middle of it.
  const double cut = std::clamp((-dip - seen_rad) / radius, -1.0, 1.0);
  const double chord = std::sqrt(1 - cut * cut), area = std::acos(cut) - cut * chord;
  out.visible = area / std::numbers::pi;
  out.lights_air = out.visible > 0 || true_rad > -dip - kTwilightRad;
  const double above = area > 0 ? 2 * chord * chord * chord / (3 * area) : 1;
  out.middle = above > 0 ? with_elevation(out.direction, seen_rad + radius * above) : out.direction;
  return out;
}

}  // namespace

// What does not depend on the view is computed once, by whoever asks first; what it is does not
// depend on who asked.
//
// A weather under broken cloud is two of the weathers below, one clear and one overcast, and each
// of its conditions two conditions: their light is mixed in the end.
struct Environment::Parts {
  struct Weather {
    WeatherSpec spec;
    // turbid_beam: for what arrives sharply; only of air with cloud or fog other than `atmosphere`
    std::optional<Atmosphere> atmosphere, turbid_beam;
    [[nodiscard]] const Atmosphere& beam() const {
      return turbid_beam ? *turbid_beam : *atmosphere;
    }
    double height_m = 0;     // of the target, as the profile counts
    double reference_m = 0;  // of its reference point, above the surface
    GrazingRay ray;
    Lazy<std::unique_ptr<const ThermalSurroundings>> light;
    Lazy<std::unique_ptr<const WeatherBounds>> bounds;
    Lazy<bool> hazy;                 // haze's light is scattered more than once
    int suns = 0;                    // conditions under which a sun lights the air
    const Weather* clear = nullptr;  // the same without its cloud, where that covers a part
  };
  struct Condition {
    ConditionEnvironment spec;
    Lazy<std::unique_ptr<const SunLight>> sun;
    Lazy<std::unique_ptr<const ConditionBounds>> bounds;
    SunSeen seen{};
  };

  // Parts of a weather or condition of the environment, by index: one, or a clear and an overcast
  // one.
  struct Mix {
    struct Part {
      std::uint32_t index;
      double fraction;
    };
    std::vector<Part> part;
    // Index of the same without its cloud, where it has one: the first part, or no part.
    std::optional<std::uint32_t> clear;
    [[nodiscard]] std::uint32_t first() const { return part.front().index; }
  };

  std::deque<Weather> weather;
  std::deque<Condition> condition;
  std::vector<Mix> of_weather, of_condition;
  mutable std::deque<Lazy<AirSpectrum>> surroundings;  // [weather of the environment]
  NodeWavelengths wavelengths;
  DirectionNodes nodes, rings;  // rings: the same with one azimuth
  double point_above_m = 0;     // the point that stands for the target, above its reference point

  [[nodiscard]] const ThermalSurroundings& light_of(const Weather& w) const {
    return *w.light.get([&] {
      return std::make_unique<ThermalSurroundings>(w.spec, *w.atmosphere, w.height_m, nodes,
                                                   wavelengths.bands, w.suns,
                                                   w.clear ? &light_of(*w.clear) : nullptr);
    });
  }
  [[nodiscard]] const CloudLight* cloud_of(const Weather& w) const {
    return w.turbid_beam ? light_of(w).cloud() : nullptr;
  }
  [[nodiscard]] const HazeLight* haze_of(const Weather& w) const {
    return is_hazy(w) ? light_of(w).haze() : nullptr;
  }
  [[nodiscard]] bool is_hazy(const Weather& w) const {
    return w.hazy.get([&] { return haze_fraction(*w.atmosphere) > 0; });
  }
  [[nodiscard]] const SunLight& sun_of(const Condition& c) const {
    const Weather& w = weather[c.spec.weather];
    return *c.sun.get([&] {
      return std::make_unique<SunLight>(c.spec, c.seen, light_of(w), w.spec.lower, *w.atmosphere,
                                        w.beam(), w.height_m, nodes, wavelengths);
    });
  }
  [[nodiscard]] const ConditionBounds& bounds_of(const Condition& c) const {
    const Weather& w = weather[c.spec.weather];
    return *c.bounds.get([&] {
      const WeatherBounds& of_weather = *w.bounds.get([&] {
        return std::make_unique<WeatherBounds>(w.spec, *w.atmosphere, w.height_m, nodes,
                                               wavelengths.bands);
      });
      return std::make_unique<ConditionBounds>(c.spec, c.seen, of_weather);
    });
  }
};

// Parts of the view that are computed so far.
struct Environment::SightLine::Parts {
  const Environment::Parts& of;
  Line line;
  struct Weather {
    SensorRay path;
    std::optional<LineHorizon> horizon;
    std::unique_ptr<const SensorPath> leg;
    FurtherPaths further;
    std::unique_ptr<ViewLight> light;
  };
  std::map<std::uint32_t, Weather> weather;
  std::map<std::uint32_t, LightBounds> bounds;

  [[nodiscard]] absl::Status add(std::uint32_t index) {
    if (weather.contains(index)) return absl::OkStatus();
    const Environment::Parts::Weather& w = of.weather[index];
    if (line.land && w.spec.imported) {
      return absl::InvalidArgumentError(
          "[land] needs the embedded atmosphere: imported air holds for one range, and land is "
          "seen at many; leave out the imported file or [land]");
    }
    ASSIGN_OR_RETURN(SensorRay path,
                     sensor_ray(w.spec, *w.atmosphere, w.height_m, line, of.wavelengths.bands));
    Weather& here = weather[index];
    here.path = std::move(path);
    here.horizon.emplace(w.ray, w.height_m, line, here.path.lift_rad);
    return absl::OkStatus();
  }
  //   index      of the condition's part
  //   condition  of the environment, as the effects count
  [[nodiscard]] absl::StatusOr<ViewEnvironment> evaluate(std::uint32_t index,
                                                         std::uint32_t condition,
                                                         const EffectSet& effects,
                                                         bool with_azimuths);
  [[nodiscard]] LightBounds bounds_of(std::uint32_t index);
  // Returns true if target and line of sight end below a weather's cloud, wherever its base may be.
  [[nodiscard]] bool below_cloud(std::uint32_t index);
  [[nodiscard]] const SensorPath& sensor_path_of(std::uint32_t index) {
    Weather& here = weather.at(index);
    const Environment::Parts::Weather& w = of.weather[index];
    if (!here.leg) {
      here.leg = std::make_unique<SensorPath>(here.path, w.beam(), w.height_m, of.wavelengths,
                                              of.cloud_of(w), of.haze_of(w));
    }
    return *here.leg;
  }
  [[nodiscard]] ViewLight& light_of(std::uint32_t index) {
    Weather& here = weather.at(index);
    if (!here.light) {
      const Environment::Parts::Weather& w = of.weather[index];
      for (Line::End end : line.end) {
        end.height_m += w.reference_m;
        here.further.end.emplace_back(end_path(w.spec, *w.atmosphere, w.height_m, here.path, end),
                                      w.beam(), w.height_m, of.wavelengths, of.cloud_of(w),
                                      of.haze_of(w));
      }
      for (const double range_m : line.land_range_m) {
        const SensorRay ray =
            land_path(w.spec, *w.atmosphere, w.height_m, here.path, line, range_m);
        here.further.land.emplace_back(ray, w.beam(), w.height_m, of.wavelengths, of.cloud_of(w),
                                       of.haze_of(w));
      }
      here.light = std::make_unique<ViewLight>(sensor_path_of(index), of.light_of(w), line,
                                               *here.horizon, of.wavelengths, here.further);
    }
    return *here.light;
  }
};

Environment::Environment(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Environment::~Environment() = default;
Environment::SightLine::SightLine(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Environment::SightLine::SightLine(SightLine&&) noexcept = default;
Environment::SightLine& Environment::SightLine::operator=(SightLine&&) noexcept = default;
Environment::SightLine::~SightLine() = default;

const AirSpectrum& Environment::surroundings_w_m2_sr_um(std::uint32_t weather) const {
  const Parts::Mix& mix = parts_->of_weather[weather];
  const auto of = [&](const Parts::Mix::Part& part) -> const AirSpectrum& {
    return parts_->light_of(parts_->weather[part.index]).surroundings;
  };
  if (mix.part.size() == 1) return of(mix.part.front());
  return parts_->surroundings[weather].get([&] {
    AirSpectrum sum(kAirBandCount, 0.0);
    for (const Parts::Mix::Part& part : mix.part)
      for (std::size_t b = 0; b < kAirBandCount; ++b) sum[b] += part.fraction * of(part)[b];
    return sum;
  });
}

const DirectionNodes& Environment::nodes() const { return parts_->nodes; }
const DirectionNodes& Environment::nodes(bool with_azimuths) const {
  return with_azimuths ? parts_->nodes : parts_->rings;
}
Environment::Line Environment::line(const Viewpoint& v) const {
  const double elevation = v.aspect_elevation_deg * kRadPerDeg;
  const double up_m = v.range_m * std::sin(elevation) - parts_->point_above_m;
  const double along_m = v.range_m * std::cos(elevation);
  return {std::hypot(up_m, along_m), std::atan2(up_m, along_m) / kRadPerDeg,
          body_from_aspect(v.aspect_azimuth_deg, v.aspect_elevation_deg), BackgroundDirections()};
}

Environment::Horizon Environment::horizon(const Line& line) const {
  Horizon sum{0, 0, 0, 0};
  for (std::uint32_t c = 0; c < conditions(); ++c) {
    const Horizon h = horizon(line, c);
    sum.z += h.z;
    sum.earth_radius_m += 1 / h.earth_radius_m;
    sum.lift_rad += h.lift_rad;
    sum.hides_m += h.hides_m;
  }
  const auto n = static_cast<double>(conditions());
  return {sum.z / n, n / sum.earth_radius_m, sum.lift_rad / n, sum.hides_m / n};
}

Environment::Horizon Environment::horizon(const Line& line, std::uint32_t condition) const {
  IRSIG_CHECK(condition < conditions());
  const Parts::Condition& c = parts_->condition[parts_->of_condition[condition].first()];
  const Parts::Weather& w = parts_->weather[c.spec.weather];
  return LineHorizon(w.ray, w.height_m, line, 0).horizon();
}

std::vector<float> Environment::horizons_z(const Line& line) const {
  std::vector<float> out;
  for (const Parts::Mix& mix : parts_->of_weather) {
    const Parts::Weather& w = parts_->weather[mix.first()];
    out.push_back(LineHorizon(w.ray, w.height_m, line, 0).z());
  }
  return out;
}

const SurfaceBoundary& Environment::surface(std::uint32_t condition) const {
  IRSIG_CHECK(condition < conditions());
  const Parts::Condition& c = parts_->condition[parts_->of_condition[condition].first()];
  return parts_->weather[c.spec.weather].spec.lower;
}

const Environment::SunSeen& Environment::sun_seen(std::uint32_t condition) const {
  IRSIG_CHECK(condition < conditions());
  return parts_->condition[parts_->of_condition[condition].first()].seen;
}
bool Environment::cloudy(std::uint32_t condition) const {
  IRSIG_CHECK(condition < conditions());
  return parts_->of_condition[condition].clear.has_value();
}
std::size_t Environment::conditions() const { return parts_->of_condition.size(); }

absl::StatusOr<std::unique_ptr<const Environment>> Environment::make(
    std::vector<WeatherSpec> weather, std::vector<ConditionEnvironment> condition,
    double target_height_m, std::vector<double> node_um) {
  if (weather.empty() || condition.empty() || node_um.empty()) {
    return absl::InvalidArgumentError("an environment needs a weather, a condition, a wavelength");
  }
  if (!(target_height_m > 0 && target_height_m <= 100e3)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("target_height_m %g: expected above 0, to 100000", target_height_m));
  }
  auto parts = std::make_unique<Parts>();
  ASSIGN_OR_RETURN(NodeWavelengths wavelengths, node_wavelengths(node_um));
  parts->wavelengths = std::move(wavelengths);
  const double raised_m = weather.front().above_surface_m;
  parts->point_above_m =
      raised_m > 0 ? std::max(0.0, kLowestAirPointM - raised_m) : target_height_m;

  double dip = 0;
  std::map<double, double> dip_of_height;
  for (std::size_t i = 0; i < weather.size(); ++i) {
    const auto named = [i](const absl::Status& s) {
      return absl::Status(s.code(), absl::StrCat("weather ", i, ": ", s.message()));
    };
    if (const absl::Status s = check(weather[i]); !s.ok()) return named(s);
    WeatherSpec& spec = weather[i];
    spec.air.cloud.reset();
    absl::StatusOr<Atmosphere> clear = Atmosphere::make(spec.air);
    if (!clear.ok()) return named(clear.status());
    const AirProfile& profile = clear->profile();
    const double reference_m = spec.above_surface_m;
    if (!(reference_m >= 0 && reference_m <= 100e3)) {
      return named(absl::InvalidArgumentError(
          absl::StrFormat("above_surface_m %g: expected 0 to 100000", reference_m)));
    }
    if ((reference_m > 0) != (raised_m > 0)) {
      return named(absl::InvalidArgumentError(
          "above_surface_m: expected it in all weathers or in none of them"));
    }
    const double height_m =
        profile.level.front().height_m +
        (reference_m > 0 ? std::max(reference_m, kLowestAirPointM) : target_height_m);
    const GrazingRay ray(profile, spec.refraction);
    const double own_dip = sin_of_dip(profile, height_m, spec.refraction);
    dip = std::max(dip, own_dip);
    if (reference_m > 0) {
      double& of_height = dip_of_height[reference_m];
      of_height = std::max(of_height, own_dip);
    }
    Parts::Mix& mix = parts->of_weather.emplace_back();
    parts->surroundings.emplace_back();
    const auto add = [&](double fraction) -> Parts::Weather& {
      mix.part.push_back({static_cast<std::uint32_t>(parts->weather.size()), fraction});
      Parts::Weather& w = parts->weather.emplace_back();
      w.spec = spec;
      w.height_m = height_m;
      w.reference_m = reference_m;
      w.ray = ray;
      return w;
    };
    const auto set_clear = [&](Parts::Weather& holes) -> absl::Status {
      if (is_fog(spec.air.aerosol.kind)) {
        holes.turbid_beam.emplace(*std::move(clear));
        ASSIGN_OR_RETURN(clear, turbid_atmosphere(spec, ForwardPeak::kDiffuse, false));
      }
      holes.atmosphere.emplace(*std::move(clear));
      return absl::OkStatus();
    };
    if (spec.cloud_cover < 1) {
      RETURN_IF_ERROR(set_clear(add(1 - spec.cloud_cover)));
      if (spec.cloud_cover > 0) mix.clear = mix.first();
    }
    if (spec.cloud_cover > 0) {
      absl::StatusOr<Atmosphere> diffuse = turbid_atmosphere(spec, ForwardPeak::kDiffuse, true);
      if (!diffuse.ok()) return named(diffuse.status());
      absl::StatusOr<Atmosphere> beam = turbid_atmosphere(spec, ForwardPeak::kBeam, true);
      if (!beam.ok()) return named(beam.status());
      const Parts::Weather* of_holes = spec.cloud_cover < 1 ? &parts->weather.back() : nullptr;
      Parts::Weather& overcast = add(spec.cloud_cover);
      overcast.clear = of_holes;
      overcast.atmosphere.emplace(*std::move(diffuse));
      overcast.turbid_beam.emplace(*std::move(beam));
      if (!of_holes) {
        mix.clear = static_cast<std::uint32_t>(parts->weather.size());
        RETURN_IF_ERROR(set_clear(add(0)));
        mix.part.pop_back();
      }
    }
  }
  bool sun = false;
  for (std::size_t i = 0; i < condition.size(); ++i) {
    const ConditionEnvironment& c = condition[i];
    if (c.weather >= parts->of_weather.size()) {
      return absl::InvalidArgumentError(
          absl::StrFormat("condition %d: there is no weather %d", i, c.weather));
    }
    if (c.sun && !(std::abs(length(c.sun_direction) - 1) < 1e-6 && c.sun_distance_au > 0)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("condition %d: the sun needs a unit vector and a distance", i));
    }
    Parts::Mix& mix = parts->of_condition.emplace_back();
    SunSeen seen{};
    const Parts::Mix& of_weather = parts->of_weather[c.weather];
    if (c.sun) {
      const Parts::Weather& w = parts->weather[of_weather.first()];
      // Lines of sight and the sun's place are those of clear air: one geometry for both skies.
      const AirProfile& clear = w.turbid_beam ? w.spec.air.profile : w.atmosphere->profile();
      seen = sun_from(clear, w.ray, w.height_m, c, w.spec.refraction);
    }
    const auto add = [&](std::uint32_t weather_index) {
      Parts::Condition& here = parts->condition.emplace_back();
      here.spec = c;
      here.spec.weather = weather_index;
      here.seen = seen;
      if (here.seen.lights_air) ++parts->weather[weather_index].suns;
      sun = sun || here.seen.lights_air;
    };
    for (const Parts::Mix::Part& part : of_weather.part) {
      mix.part.push_back({static_cast<std::uint32_t>(parts->condition.size()), part.fraction});
      add(part.index);
    }
    if (of_weather.clear) {
      const bool a_part = *of_weather.clear == of_weather.first();
      mix.clear = a_part ? mix.first() : static_cast<std::uint32_t>(parts->condition.size());
      if (!a_part) add(*of_weather.clear);
    }
  }
  // The first ring below the horizon lies safely on the sea.
  const double first = dip * 1.001 + 1e-5;
  std::vector<float> lower = limb_rings(dip_of_height);
  for (const double share : kLowerSines) {
    lower.push_back(static_cast<float>(first + share * (1 - first)));
  }
  lower.back() = 1.0f;
  const std::vector<float> upper(kSkySines.begin(), kSkySines.end());
  parts->rings = DirectionNodes(upper, lower, 1);
  parts->nodes = DirectionNodes(upper, std::move(lower), sun ? kAzimuths : 1);
  return std::unique_ptr<const Environment>(new Environment(std::move(parts)));
}

double Environment::bytes_per_condition() const {
  // Bytes of the sun's light at the nodes, kept from view to view, of its ratios behind the line's
  // air, and of the background with its errors, in as many directions as a ship has that ends at
  // the horizon.
  constexpr double kBehind = 40;
  const DirectionNodes& nodes = parts_->nodes;
  const auto bands = static_cast<double>(parts_->wavelengths.used.size());
  const auto wavelengths = static_cast<double>(parts_->wavelengths.um.size());
  const bool sun = nodes.azimuths() > 1;
  const double kept = sun ? (nodes.sky() + 2.0 * nodes.lower()) * bands : 0;
  const double rings = sun ? static_cast<double>(kSkySines.size() + 2 * kLowerSines.size()) : 0;
  const bool hazy = std::any_of(parts_->weather.begin(), parts_->weather.end(),
                                [&](const Parts::Weather& w) { return parts_->is_hazy(w); });
  const double haze = sun && hazy ? HazeSunlight::kBytesPerBand * bands : 0;
  std::size_t parts = 1;
  for (const Parts::Mix& mix : parts_->of_condition) parts = std::max(parts, mix.part.size());
  return static_cast<double>(parts) *
         (kept * sizeof(float) + (rings * bands + 3 * kBehind * wavelengths) * sizeof(double) +
          haze);
}

absl::StatusOr<Environment::SightLine> Environment::sight_line(const Line& line) const {
  auto parts = std::unique_ptr<SightLine::Parts>(new SightLine::Parts{*parts_, line, {}, {}});
  for (const Parts::Mix& mix : parts_->of_condition)
    for (const Parts::Mix::Part& part : mix.part)
      RETURN_IF_ERROR(parts->add(parts_->condition[part.index].spec.weather));
  return SightLine(std::move(parts));
}

absl::StatusOr<std::vector<ViewEnvironment>> Environment::view(
    const Line& line, std::span<const std::uint32_t> conditions, bool around) const {
  // A line that another condition's weather does not cover is none of this view's business.
  auto parts = std::unique_ptr<SightLine::Parts>(new SightLine::Parts{*parts_, line, {}, {}});
  for (const std::uint32_t c : conditions) {
    if (c >= this->conditions()) {
      return absl::InvalidArgumentError(absl::StrCat("there is no condition ", c));
    }
    for (const Parts::Mix::Part& part : parts_->of_condition[c].part)
      RETURN_IF_ERROR(parts->add(parts_->condition[part.index].spec.weather));
  }
  SightLine look(std::move(parts));
  EffectSet wanted = EffectSet::everything(this->conditions(), 1);
  wanted.sky = wanted.lower = around;
  std::vector<ViewEnvironment> out;
  for (const std::uint32_t c : conditions) {
    ASSIGN_OR_RETURN(ViewEnvironment seen, look.evaluate(c, wanted, true));
    out.push_back(std::move(seen));
  }
  return out;
}

absl::StatusOr<ViewEnvironment> Environment::SightLine::evaluate(std::uint32_t condition,
                                                                 const EffectSet& effects,
                                                                 bool with_azimuths) {
  const Environment::Parts& of = parts_->of;
  if (condition >= of.of_condition.size()) {
    return absl::InvalidArgumentError(absl::StrCat("there is no condition ", condition));
  }
  if (effects.sun.size() != of.of_condition.size()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "effects of ", effects.sun.size(), " conditions, expected ", of.of_condition.size()));
  }
  const Environment::Parts::Mix& mix = of.of_condition[condition];
  if (mix.clear && !effects.has_cloud(condition)) {
    RETURN_IF_ERROR(parts_->add(of.condition[*mix.clear].spec.weather));
    ASSIGN_OR_RETURN(ViewEnvironment out,
                     parts_->evaluate(*mix.clear, condition, effects, with_azimuths));
    // The background is a number of its own, of which a target's brightness hides nothing.
    EffectSet behind = effects;
    behind.cloud.clear();
    behind.sky = behind.lower = false;
    behind.max_reflections = 0;
    ASSIGN_OR_RETURN(ViewEnvironment seen, evaluate(condition, behind, with_azimuths));
    // It is net of the air between target and sensor, which here is that of the clear sky.
    for (ViewEnvironment::Spectrum& node : seen.background_apparent)
      for (std::size_t i = 0; i < node.size(); ++i)
        node[i] += seen.path_radiance[i] - out.path_radiance[i];
    out.background_apparent = std::move(seen.background_apparent);
    out.background_interpolation = std::move(seen.background_interpolation);
    out.background_model_error = std::move(seen.background_model_error);
    return out;
  }
  ASSIGN_OR_RETURN(ViewEnvironment out,
                   parts_->evaluate(mix.first(), condition, effects, with_azimuths));
  if (mix.part.size() == 1) return out;
  ASSIGN_OR_RETURN(ViewEnvironment overcast,
                   parts_->evaluate(mix.part[1].index, condition, effects, with_azimuths));
  return under_broken_cloud(std::move(out), std::move(overcast), mix.part[1].fraction);
}

absl::StatusOr<ViewEnvironment> Environment::SightLine::Parts::evaluate(std::uint32_t index,
                                                                        std::uint32_t condition,
                                                                        const EffectSet& effects,
                                                                        bool with_azimuths) {
  const Environment::Parts::Condition& c = of.condition[index];
  const bool diffuse_sun = effects.scattered_sun(condition);
  if (c.seen.lights_air && diffuse_sun && !with_azimuths) {
    return absl::InvalidArgumentError(absl::StrCat(
        "condition ", condition, ": scattered sunlight is reflected, but nodes have no azimuths"));
  }
  const bool any_sun = effects.follows_sun(condition) || diffuse_sun ||
                       effects.sun[condition].path || effects.sun[condition].background;
  const SunLight* sun = c.seen.lights_air && any_sun ? &of.sun_of(c) : nullptr;
  return light_of(c.spec.weather)
      .seen_under(sun, effects, condition, with_azimuths ? of.nodes : of.rings);
}

LightBounds Environment::SightLine::Parts::bounds_of(std::uint32_t index) {
  const Environment::Parts::Condition& c = of.condition[index];
  return light_bounds(of.bounds_of(c), sensor_path_of(c.spec.weather), line,
                      *weather.at(c.spec.weather).horizon);
}

const LightBounds& Environment::SightLine::bounds(std::uint32_t condition) {
  const auto known = parts_->bounds.find(condition);
  if (known != parts_->bounds.end()) return known->second;
  const Environment::Parts& of = parts_->of;
  IRSIG_CHECK(condition < of.of_condition.size());
  const Environment::Parts::Mix& mix = of.of_condition[condition];
  LightBounds out = parts_->bounds_of(mix.first());
  if (mix.part.size() > 1)
    out = under_broken_cloud(out, parts_->bounds_of(mix.part[1].index), mix.part[1].fraction);
  return parts_->bounds[condition] = std::move(out);
}

bool Environment::SightLine::Parts::below_cloud(std::uint32_t index) {
  const Environment::Parts::Weather& w = of.weather[index];
  double base_m = w.spec.cloud->base_m;
  if (w.spec.cloud_base_range_m) base_m = std::min(base_m, w.spec.cloud_base_range_m->front());
  base_m += w.atmosphere->profile().level.front().height_m;
  double highest_m = std::max(w.height_m, sensor_path_of(index).highest_m);
  for (const Line::End& end : line.end)
    highest_m = std::max(highest_m, end.height_m + w.reference_m);
  return highest_m < base_m;
}

std::optional<CloudBounds> Environment::SightLine::cloud_bounds(std::uint32_t condition) {
  const Environment::Parts& of = parts_->of;
  IRSIG_CHECK(condition < of.of_condition.size());
  const Environment::Parts::Mix& mix = of.of_condition[condition];
  if (!mix.clear) return std::nullopt;
  const std::uint32_t overcast = mix.part.back().index,
                      weather = of.condition[overcast].spec.weather;
  if (!parts_->below_cloud(weather)) return std::nullopt;
  if (!parts_->add(of.condition[*mix.clear].spec.weather).ok()) return std::nullopt;
  CloudBounds out;
  out.most = larger_of(parts_->bounds_of(*mix.clear), parts_->bounds_of(overcast));
  const SensorPath& path = parts_->sensor_path_of(weather);
  AirSpectrum scattered = path.layers.surroundings_fraction;
  const AirSpectrum& brightest = of.bounds_of(of.condition[overcast]).weather.thermal;
  for (std::size_t b = 0; b < kAirBandCount; ++b) scattered[b] *= brightest[b];
  out.path_surroundings = path.spread_thermal(scattered);
  const double cover = mix.part.back().fraction;
  out.weight = std::max(cover, std::sqrt(cover * (1 - cover)));
  return out;
}

std::vector<double> air_band_edges_um(double lambda_min_um, double lambda_max_um) {
  std::vector<double> edge;
  for (std::size_t i = 0; i <= kAirBandCount; ++i) {
    const double um = 1e4 / (kAirLastCm1 - kAirBandWidthCm1 * static_cast<double>(i));
    if (um > lambda_min_um && um < lambda_max_um) edge.push_back(um);
  }
  return edge;
}

}  // namespace irsig
