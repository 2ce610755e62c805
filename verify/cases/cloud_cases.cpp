#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/atmosphere/atmosphere.h"
#include "core/atmosphere/two_stream.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/environment/environment.h"
#include "verify/cases/groups.h"

// Clouds: what is exact for a layer of particles, at the edges of what a layer can be.
namespace irsig {
namespace {

constexpr double kDropUm = 8;

AtmosphereSpec air_spec() {
  AtmosphereSpec spec{afgl_profile(AfglProfile::kMidlatitudeSummer), {}};
  spec.aerosol.kind = AerosolKind::kRural;
  spec.aerosol.visibility_m = 23e3;
  return spec;
}

// A layer whose extinction at 10 um is `depth`, straight up.
CloudSpec layer_of(double base_m, double top_m, double depth) {
  CloudSpec out{CloudPhase::kWater, base_m, top_m, 1, kDropUm};
  const CloudOptics one = cloud_optics(out, ForwardPeak::kBeam);
  const std::size_t band = *air_band(10);
  out.water_path_kg_m2 = depth / (one.absorption[band] + one.scattering[band]);
  return out;
}

// Length of a chord in a layer, from a height and with a zenith angle: straight rays above a
// sphere.
double length_in(const CloudSpec& layer, double from_m, double to_m, double range_m) {
  const double r = kEarthRadiusM + from_m, far = kEarthRadiusM + to_m;
  const double cosine = (far * far - r * r - range_m * range_m) / (2 * r * range_m);
  // Where the ray is at a height: it rises all the way.
  const auto at = [&](double height_m) {
    const double h = std::clamp(height_m, from_m, to_m), d = h - from_m;
    const double c = -d * (2 * r + d), b = r * cosine;
    return -c / (b + std::sqrt(std::max(0.0, b * b - c)));
  };
  return at(layer.top_m) - at(layer.base_m);
}

absl::StatusOr<Finding> particles_obey_bouguer(Effort) {
  Worst worst(1e-3);
  for (const auto& [base_m, top_m] :
       {std::pair{0.0, 200.0}, {0.5, 100.0}, {330.0, 331.0}, {330.0, 1000.0}, {24e3, 25e3}}) {
    for (const double depth : {1e-6, 1e-3, 1.0, 100.0}) {
      const CloudSpec layer = layer_of(base_m, top_m, depth);
      AtmosphereSpec cloudy = air_spec(), wet = air_spec();
      wet.profile = with_cloud(wet.profile, layer);
      cloudy.cloud = layer;
      cloudy.forward_peak = ForwardPeak::kBeam;
      ASSIGN_OR_RETURN(const Atmosphere with, Atmosphere::make(cloudy));
      ASSIGN_OR_RETURN(const Atmosphere without, Atmosphere::make(wet));
      for (const double from_m : {0.0, base_m + 0.3 * (top_m - base_m), 10.0}) {
        for (const double to_m : {base_m + 0.7 * (top_m - base_m), top_m + 1, 30e3}) {
          if (to_m <= from_m) continue;
          for (const double slant : {1.0, 1.7, 20.0}) {
            const double range_m = slant * (to_m - from_m);
            if (range_m > 60e3) continue;  // paths of 500 km end within centimetres
            const auto path = look_between(with.profile(), from_m, to_m, range_m, false);
            if (!path.ok()) continue;
            const auto depth_of = [&](const Atmosphere& air) {
              const AbsorberAmounts amounts = air.amounts(*path);
              double sum = 0;
              for (const AirSpectrum& of : amounts.optical_depth) sum += of[*air_band(10)];
              return sum;
            };
            const double per_m = depth / (top_m - base_m) * slant;
            const double expected =
                depth / (top_m - base_m) * length_in(layer, from_m, to_m, range_m);
            const double found = depth_of(with) - depth_of(without);
            worst.see(std::abs(found - expected) / per_m, [&] {
              return absl::StrCat("layer ", base_m, " to ", top_m, " m, depth ", depth, ", from ",
                                  from_m, " to ", to_m, " m, ", range_m, " m");
            });
          }
        }
      }
    }
  }
  return worst.finding();
}

absl::StatusOr<Finding> edges_have_no_jump(Effort) {
  Worst worst(2e-6);
  for (const auto& [base_m, top_m] : {std::pair{0.5, 3.0}, {330.0, 331.0}, {1000.0, 2000.0}}) {
    AtmosphereSpec spec = air_spec();
    spec.cloud = layer_of(base_m, top_m, 0.3);
    spec.forward_peak = ForwardPeak::kDiffuse;
    ASSIGN_OR_RETURN(const Atmosphere air, Atmosphere::make(spec));
    const std::size_t band = *air_band(10);
    for (const double edge_m : {base_m, top_m}) {
      double last = 1;
      for (const double off_m : {-1.0, -0.5, -0.1, -1e-3, -1e-6, -1e-9, 0.0, 1e-9, 1e-6, 1e-3, 0.1,
                                 0.5, 1.0, 1.001, 1.1, 1.5, 2.0}) {
        const double height_m = edge_m + off_m;
        if (height_m <= 0) continue;
        const auto path = look_between(air.profile(), height_m, 0, 2 * height_m, true);
        if (!path.ok()) return path.status();
        const double t = transmittance(air.amounts(*path))[band];
        worst.see(std::max(0.0, t - last), [&] {
          return absl::StrCat("rise ", off_m, " m from the edge at ", edge_m, " m");
        });
        last = t;
      }
    }
  }
  return worst.finding();
}

absl::StatusOr<Finding> streams_stay_possible(Effort) {
  Worst worst(1e-9);
  for (const double depth : {0.0, 1e-12, 1e-6, 1.0, 1e4, 1e9}) {
    for (const double albedo : {0.0, 0.5, 1 - 1e-6, 1.0}) {
      for (const double asymmetry : {0.0, 0.46, 0.9}) {
        for (const double ground : {0.0, 0.5, 1.0}) {
          const auto where = [&] {
            return absl::StrCat("depth ", depth, ", albedo ", albedo, ", asymmetry ", asymmetry,
                                ", ground ", ground);
          };
          // A column, its ground and the light above of one temperature: a black body.
          const std::vector<StreamLayer> layer = {{depth, albedo, asymmetry, 3, 3},
                                                  {depth, albedo, asymmetry, 3, 3}};
          for (const StreamLight& x : diffuse_light(
                   layer,
                   {.down_radiance = 3, .up_radiance = 3 * (1 - ground), .surface_albedo = ground}))
            worst.see(std::abs(x.mean / 3 - 1), where);
          for (const double cosine : {0.02, 0.5773502691896258, 1.0}) {
            const std::vector<StreamLayer> cold = {{depth, albedo, asymmetry, 0, 0}};
            const std::vector<StreamLight> light = diffuse_light(
                cold, {.surface_albedo = ground, .sun_irradiance = 1, .sun_cosine = cosine});
            // The light that leaves the top is a part of the sunlight that falls on it; no light
            // comes from above.
            const double leaves = 2 * std::numbers::pi * light.front().mean;
            worst.require(leaves >= 0 && leaves <= cosine * (1 + 1e-5), where);
            worst.require(std::isfinite(light.back().mean) && light.back().mean >= 0, where);
          }
        }
      }
    }
  }
  return worst.finding();
}

struct Sky {
  const char* name;
  CloudSpec layer;
  double zenith_deg, range_m, elevation_deg;
  double cover = 1;
};

WeatherSpec weather_of(const Sky& sky, double cover) {
  WeatherSpec out{air_spec(), true, {SurfaceBoundary::Kind::kFlatSea, 293, 1, 0}, nullptr};
  out.cloud_cover = cover;
  out.cloud = sky.layer;
  return out;
}

absl::StatusOr<ViewEnvironment> seen_under(const Sky& sky, double cover, bool sun) {
  const double z = sky.zenith_deg * kRadPerDeg;
  ASSIGN_OR_RETURN(
      const auto environment,
      Environment::make({weather_of(sky, cover)}, {{0, sun, {std::sin(z), 0, -std::cos(z)}, 1}}, 10,
                        {3.7, 4.7, 10.0}));
  const SensorLine line{sky.range_m, sky.elevation_deg, body_from_aspect(30, sky.elevation_deg),
                        BackgroundDirections({0.1f, 0.6f})};
  const std::uint32_t first = 0;
  ASSIGN_OR_RETURN(std::vector<ViewEnvironment> seen, environment->view(line, {&first, 1}));
  return seen.front();
}

std::vector<double> light_of(const ViewEnvironment& v) {
  std::vector<double> out;
  const auto add = [&](const std::vector<double>& s) { out.insert(out.end(), s.begin(), s.end()); };
  for (const auto* s : {&v.transmittance, &v.path_radiance, &v.sun, &v.sun_apparent}) add(*s);
  for (std::uint32_t n = 0; n < v.around.count(); n += 5) {
    add(v.around.radiance(n));
    add(v.around.apparent(n));
  }
  for (const auto& s : v.background_apparent) add(s);
  return out;
}

absl::StatusOr<Finding> mixtures_are_linear(Effort) {
  Worst worst(1e-12);
  for (const Sky& sky :
       {Sky{"base on the ground, sensor above it", layer_of(0, 300, 3), 45, 3000, 12, 0.5},
        Sky{"almost nothing, sun on the horizon", layer_of(330, 1000, 1e-6), 90.2, 3000, 5, 1e-9},
        Sky{"opaque, sun on the horizon", layer_of(330, 1000, 1e4), 90, 3000, 5, 1e-9}}) {
    ASSIGN_OR_RETURN(const ViewEnvironment clear, seen_under(sky, 0, true));
    ASSIGN_OR_RETURN(const ViewEnvironment overcast, seen_under(sky, 1, true));
    const std::vector<double> a = light_of(clear), b = light_of(overcast);
    for (const double x : b)
      worst.require(x >= 0 && x < 400, [&] { return absl::StrCat(sky.name, ": ", x); });
    ASSIGN_OR_RETURN(const ViewEnvironment broken, seen_under(sky, sky.cover, true));
    const std::vector<double> mean = light_of(broken);
    for (std::size_t i = 0; i < mean.size(); ++i) {
      const double expected = (1 - sky.cover) * a[i] + sky.cover * b[i];
      if (expected <= 0) continue;
      worst.see(std::abs(mean[i] / expected - 1), [&] { return std::string(sky.name); });
    }
  }
  return worst.finding();
}

absl::StatusOr<Finding> opaque_decks_hide_the_sun(Effort) {
  Worst worst(1e-12);
  for (const double zenith_deg : {0.0, 60.0, 90.0}) {
    const Sky sky{"deck", layer_of(330, 1000, 1e4), zenith_deg, 500, 5};
    ASSIGN_OR_RETURN(const ViewEnvironment day, seen_under(sky, 1, true));
    ASSIGN_OR_RETURN(const ViewEnvironment night, seen_under(sky, 1, false));
    const std::uint32_t azimuths = day.around.count() / night.around.count();
    for (std::uint32_t n = 0; n < day.around.count(); ++n) {
      const std::vector<double> lit = day.around.radiance(n),
                                dark = night.around.radiance(n / azimuths);
      for (std::size_t i = 0; i < lit.size(); ++i)
        worst.see(std::abs(lit[i] / dark[i] - 1), [&] {
          return absl::StrCat("sun ", zenith_deg, " deg from the zenith, node ", n);
        });
    }
  }
  return worst.finding();
}

}  // namespace

std::vector<HardCase> cloud_cases() {
  return {
      {"cloud", "bouguer",
       "layers 1 m to 1 km thick, depth 1e-6 to 100, from below and inside, to inside and above: "
       "depth of the particles on a straight ray, as a height [m]",
       "a path of some km ends within a millimetre of its target", particles_obey_bouguer},
      {"cloud", "edges", "a sensor that rises through a base and a top: rise of a transmittance",
       "more height absorbs more; levels are crossed within 1e-7 of a step, 50 um of air",
       edges_have_no_jump},
      {"cloud", "two_streams",
       "depth 0 to 1e9, nothing or all scattered: against a black body; more than came in",
       "one temperature is a black body in any column; conserved to the cut of the albedo, 1e-9",
       streams_stay_possible},
      {"cloud", "cover",
       "cover 1e-9 and 0.5; base on the ground, sensor above it, depth 1e-6 and 1e4, sun on "
       "the horizon: against the mean of both skies, relative; negative or infinite light",
       "mixed after the products: rounding of two terms", mixtures_are_linear},
      {"cloud", "opaque_deck",
       "depth 1e4, sun from the zenith to the horizon: sky and sea by day against by night",
       "sunlight that arrives is less than the smallest number", opaque_decks_hide_the_sun},
  };
}

}  // namespace irsig
