#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/atmosphere/atmosphere.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/spectral/planck.h"
#include "verify/cases/groups.h"

// The air: what is exact for any path through it, at the edges of what a path or a weather can be.
namespace irsig {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

double uniform(std::uint64_t stream, std::uint64_t k) {
  // Unrelated sequences are enough here: irrational steps.
  const double x = 0.6180339887498949 * static_cast<double>(k + 1) +
                   0.7548776662466927 * static_cast<double>(stream + 1);
  return x - std::floor(x);
}

absl::StatusOr<Atmosphere> air_of(AfglProfile profile, AerosolKind aerosol, double visibility_m) {
  AtmosphereSpec spec{afgl_profile(profile), {}};
  spec.aerosol.kind = aerosol;
  spec.aerosol.visibility_m = visibility_m;
  return Atmosphere::make(std::move(spec));
}

absl::StatusOr<Atmosphere> hazy_air() {
  return air_of(AfglProfile::kMidlatitudeSummer, AerosolKind::kMaritime, 10e3);
}

absl::StatusOr<Atmosphere> clean_air() {
  return air_of(AfglProfile::kUsStandard1976, AerosolKind::kNone, 0);
}

// Nitrogen alone, and what molecules scatter: one exponential a band, no lines.
absl::StatusOr<Atmosphere> grey_air() {
  AtmosphereSpec spec{afgl_profile(AfglProfile::kUsStandard1976), {}, 0, 0, 0};
  for (AirLevel& level : spec.profile.level) level.gas = GasMix{};
  return Atmosphere::make(std::move(spec));
}

double largest_difference(const AirSpectrum& a, const AirSpectrum& b) {
  double worst = 0;
  for (std::size_t i = 0; i < kAirBandCount; ++i) {
    // Written so that a NaN is kept.
    if (!(std::abs(a[i] - b[i]) <= worst)) worst = std::abs(a[i] - b[i]);
  }
  return worst;
}

double hottest_k(const AirProfile& profile) {
  double most = 0;
  for (const AirLevel& level : profile.level) most = std::max(most, level.temperature_k);
  return most;
}

// By how much the numbers of a path lie outside what is possible: transmittance in [0, 1], emission
// between nothing and what a blackbody of the hottest air gives, all finite.
double impossible(const PathRadiance& path, double hottest) {
  double worst = 0;
  const auto keep = [&](double excess) {
    if (!(excess <= worst)) worst = excess;
  };
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    const double t = path.transmittance[b];
    const double most = planck_radiance_w_m2_sr_um(air_band_lambda_um(b), hottest);
    keep(std::max(-t, t - 1));
    keep(-path.thermal_w_m2_sr_um[b] / most);
    keep(path.thermal_w_m2_sr_um[b] / most - (1 - t));
    keep(-path.scattered_w_m2_sr_um[b]);
    for (const double number :
         {path.total_w_m2_sr_um[b], path.scattered_w_m2_sr_um[b], path.model_error_transmittance[b],
          path.model_error_w_m2_sr_um[b]}) {
      if (!(number >= 0 && number < 1e6)) keep(kFar);
    }
  }
  return worst;
}

// ---- cases

absl::StatusOr<Finding> air_optical_depth(Effort) {
  ASSIGN_OR_RETURN(const auto air, grey_air());
  Worst worst(4e-15);
  const double temperature_k = air_at(air.profile(), 0).temperature_k;
  const AbsorberAmounts metre = air.amounts(level_path(0, 1));
  for (double range_m = 1e-7; range_m < 2e9; range_m *= 10) {
    const PathRadiance path = air.radiance(level_path(0, range_m));
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      const double absorbed = range_m * metre.grey(GreyAbsorber::kNitrogen)[b],
                   scattered = range_m * metre.grey(GreyAbsorber::kMolecularScattering)[b];
      const double depth = absorbed + scattered;
      if (absorbed < 1e-12) continue;
      const auto where = [&] { return absl::StrCat("depth ", depth); };
      const double expected = std::exp(-depth);
      // Rounding of the depth itself counts up to depth x 2^-52 of the value.
      worst.see(std::abs(path.transmittance[b] - expected) / std::max(1.0, depth), where);
      const double emitted = -std::expm1(-depth) * absorbed / depth;
      const double planck = planck_radiance_w_m2_sr_um(air_band_lambda_um(b), temperature_k);
      worst.see(std::abs(path.thermal_w_m2_sr_um[b] / planck - emitted), where);
    }
  }
  return worst.finding();
}

absl::StatusOr<Finding> every_path(Effort effort) {
  ASSIGN_OR_RETURN(const auto air, hazy_air());
  Worst worst(1e-14);
  const double hottest = hottest_k(air.profile());
  const std::vector<double> zeniths = {0,         1e-9, 60,  89.9,       90 - 1e-9, 90,
                                       90 + 1e-9, 90.1, 120, 180 - 1e-9, 180};
  const std::vector<double> heights =
      effort == Effort::kFull
          ? std::vector<double>{0, 1e-3, 1, 20, 1e3, 11e3, 60e3, 99e3, 120e3, 5e5, 36e6}
          : std::vector<double>{0, 20, 11e3, 99e3, 36e6};
  for (const double height_m : heights) {
    for (const double zenith_deg : zeniths) {
      for (const double range_m : {0.0, 1e-9, 1.0, 2e4, kFar}) {
        const LightPath path = look(air.profile(), height_m, zenith_deg, range_m);
        worst.see(impossible(air.radiance(path), hottest), [&] {
          return absl::StrCat(height_m, " m, zenith ", zenith_deg, " deg, ", range_m, " m");
        });
      }
    }
  }
  return worst.finding();
}

absl::StatusOr<Finding> around_the_horizon(Effort effort) {
  ASSIGN_OR_RETURN(const auto air, hazy_air());
  Worst worst(2e-4);
  // From 1 km the sea's horizon stands at 91 deg: all these rays end in space, or in air.
  const int steps = effort == Effort::kFull ? 200 : 40;
  for (const double range_m : {2e4, 1e5, kFar}) {
    AirSpectrum before;
    for (int i = 0; i <= steps; ++i) {
      const double zenith_deg = 89.9 + 0.2 * i / steps;
      const AirSpectrum t =
          transmittance(air.amounts(look(air.profile(), 1000, zenith_deg, range_m)));
      // Farther down the air is denser: no transmittance may rise.
      double rise = 0;
      for (std::size_t b = 0; b < kAirBandCount && !before.empty(); ++b) {
        if (!(t[b] - before[b] <= rise)) rise = t[b] - before[b];
      }
      worst.see(rise, [&] { return absl::StrCat("zenith ", zenith_deg, " deg, ", range_m, " m"); });
      before = t;
    }
  }
  return worst.finding();
}

absl::StatusOr<Finding> over_the_horizon(Effort) {
  Worst worst(1e-10);
  const AirProfile& air = afgl_profile(AfglProfile::kUsStandard1976);
  ASSIGN_OR_RETURN(const auto target, look_between(air, 10, 20, 20e3, false));
  // Law of cosines, in a form that does not cancel.
  const double r1 = kEarthRadiusM + 10;
  const double sine = (10.0 * (2 * kEarthRadiusM + 30) - 20e3 * 20e3) / (2 * r1 * 20e3);
  worst.see(std::abs(90 - target.node.front().zenith_deg - std::asin(sine) / kRadPerDeg), [&] {
    return absl::StrCat("the sensor stands at ", 90 - target.node.front().zenith_deg, " deg");
  });
  worst.require(std::abs(90 - target.node.front().zenith_deg + 0.0613) < 1e-4,
                [] { return "-0.06 deg"; });
  // Both horizons together, straight: 27.25 km.
  const double reach_m =
      std::sqrt(20 * (2 * kEarthRadiusM + 20)) + std::sqrt(10 * (2 * kEarthRadiusM + 10));
  for (const double share : {0.5, 0.9, 0.999, 1.001, 1.1, 1.3}) {
    const bool straight = look_between(air, 20, 10, share * reach_m, false).ok();
    worst.require(straight == (share < 1),
                  [&] { return absl::StrCat("straight, ", share, " of the reach"); });
    const bool bent = look_between(air, 20, 10, share * reach_m).ok();
    // Refraction carries the horizon 6 to 10 % farther (Bomford).
    worst.require(bent == (share < 1.05),
                  [&] { return absl::StrCat("refracted, ", share, " of the reach"); });
  }
  return worst.finding();
}

absl::StatusOr<Finding> tangents(Effort) {
  ASSIGN_OR_RETURN(const auto air, clean_air());
  Worst worst(4e-4);
  for (const double height_m : {10e3, 90e3, 300e3}) {
    for (const double tangent_m : {1.0, 100.0, 5e3, 9e3}) {
      const double zenith_deg =
          180 - std::asin((kEarthRadiusM + tangent_m) / (kEarthRadiusM + height_m)) / kRadPerDeg;
      const auto where = [&] { return absl::StrCat(tangent_m, " m from ", height_m, " m"); };
      const LightPath whole = look(air.profile(), height_m, zenith_deg, kFar, false);
      worst.require(whole.end == PathEnd::kSpace, where);
      // Twice the half that rises from the tangent point, less the part above the observer.
      const LightPath half = look(air.profile(), tangent_m, 90, kFar, false);
      const AbsorberAmounts rising = air.amounts(half);
      if (height_m >= 120e3) {
        worst.see(
            largest_difference(transmittance(air.amounts(whole)), transmittance(rising + rising)),
            where);
      } else {
        const LightPath above = look(air.profile(), height_m, 180 - zenith_deg, kFar, false);
        worst.see(largest_difference(transmittance(air.amounts(whole) + air.amounts(above)),
                                     transmittance(rising + rising)),
                  where);
      }
      // A metre lower than the surface is no path to space.
      const double lower_deg =
          180 - std::asin((kEarthRadiusM - 1) / (kEarthRadiusM + height_m)) / kRadPerDeg;
      worst.require(look(air.profile(), height_m, lower_deg, kFar, false).end == PathEnd::kSurface,
                    where);
    }
  }
  return worst.finding();
}

absl::StatusOr<Finding> neighbours(Effort) {
  ASSIGN_OR_RETURN(const auto air, hazy_air());
  Worst worst(1e-9);
  for (const double height_m : {0.0, 1e-3, 10.0, 1999.9, 11e3, 119e3}) {
    for (const double range_m : {1.0, 1e-3, 1e-6}) {
      ASSIGN_OR_RETURN(const auto path, look_between(air.profile(), height_m, height_m, range_m));
      const PathRadiance ours = air.radiance(path);
      const AirSpectrum level = transmittance(air.amounts(level_path(height_m, range_m)));
      // The chord of 1 m hangs 2e-8 m below the level.
      worst.see(largest_difference(ours.transmittance, level),
                [&] { return absl::StrCat(range_m, " m apart at ", height_m, " m"); });
      worst.see(impossible(ours, hottest_k(air.profile())),
                [&] { return absl::StrCat(range_m, " m apart at ", height_m, " m"); });
    }
    ASSIGN_OR_RETURN(const auto same, look_between(air.profile(), height_m, height_m, 0));
    for (const double t : air.radiance(same).transmittance) {
      worst.require(t == 1, [&] { return absl::StrCat("no range at ", height_m, " m"); });
    }
  }
  return worst.finding();
}

absl::StatusOr<Finding> reversal(Effort effort) {
  ASSIGN_OR_RETURN(const auto air, hazy_air());
  Worst worst(1e-3);
  const int lines = effort == Effort::kFull ? 200 : 30;
  for (int i = 0; i < lines; ++i) {
    const auto k = static_cast<std::uint64_t>(i);
    // From above and from below, log-uniform heights and ranges.
    const double low_m = std::pow(10.0, 4 * uniform(1, k)) - 1,
                 high_m = std::pow(10.0, 5 * uniform(2, k)) - 1;
    const double range_m = std::abs(high_m - low_m) + std::pow(10.0, 4.3 * uniform(3, k));
    const auto up = look_between(air.profile(), low_m, high_m, range_m),
               down = look_between(air.profile(), high_m, low_m, range_m);
    const auto where = [&] {
      return absl::StrCat(low_m, " m to ", high_m, " m over ", range_m, " m");
    };
    worst.require(up.ok() == down.ok(), where);
    if (!up.ok() || !down.ok()) continue;
    worst.see(
        largest_difference(transmittance(air.amounts(*up)), transmittance(air.amounts(*down))),
        where);
  }
  return worst.finding();
}

absl::StatusOr<Finding> pieces(Effort effort) {
  ASSIGN_OR_RETURN(const auto air, hazy_air());
  Worst worst(2e-4);
  const int lines = effort == Effort::kFull ? 200 : 30;
  for (int i = 0; i < lines; ++i) {
    const auto k = static_cast<std::uint64_t>(i);
    const double height_m = std::pow(10.0, 4.7 * uniform(4, k)) - 1;
    const double zenith_deg = 180 * uniform(5, k);
    const LightPath far = look(air.profile(), height_m, zenith_deg, 1e5);
    const double range_m = std::min(1e5, far.length_m);
    if (range_m < 1e-3) continue;
    const double cut_m = range_m * uniform(6, k);
    const LightPath whole = look(air.profile(), height_m, zenith_deg, range_m),
                    first = look(air.profile(), height_m, zenith_deg, cut_m);
    const LightPath::Node end = first.node.back();
    const LightPath second = look(air.profile(), end.height_m, end.zenith_deg, range_m - cut_m);
    worst.see(largest_difference(transmittance(air.amounts(whole)),
                                 transmittance(air.amounts(first) + air.amounts(second))),
              [&] {
                return absl::StrCat(height_m, " m, zenith ", zenith_deg, " deg, ", range_m,
                                    " m, cut at ", cut_m, " m");
              });
  }
  return worst.finding();
}

absl::StatusOr<Finding> range_is_monotone(Effort) {
  ASSIGN_OR_RETURN(const auto air, hazy_air());
  Worst worst(2e-4);
  for (const double zenith_deg : {0.0, 85.0, 90.0, 90.02, 110.0}) {
    AirSpectrum before(kAirBandCount, 1.0);
    for (double range_m = 1e-3; range_m < 2e6; range_m *= 3) {
      const AirSpectrum t =
          transmittance(air.amounts(look(air.profile(), 50, zenith_deg, range_m)));
      double rise = 0;
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        if (!(t[b] - before[b] <= rise)) rise = t[b] - before[b];
      }
      worst.see(rise, [&] { return absl::StrCat(range_m, " m at ", zenith_deg, " deg"); });
      before = t;
    }
  }
  return worst.finding();
}

absl::StatusOr<Finding> weather(Effort) {
  Worst worst(1e-12);
  for (const double temperature_k : {213.15, 273.15, 323.15}) {
    AirSpectrum drier;
    for (const double humidity : {0.0, 1e-6, 1.0, 50.0, 99.0, 100.0}) {
      const auto where = [&] { return absl::StrCat(temperature_k, " K, ", humidity, " %"); };
      ASSIGN_OR_RETURN(const auto bent, bend_to_surface(afgl_profile(AfglProfile::kUsStandard1976),
                                                        {temperature_k, humidity, 101325}));
      const auto air = Atmosphere::make({bent, {}});
      if (!air.ok()) return air.status();
      worst.see(impossible(air->sky_radiance(0, 85), hottest_k(bent)), where);
      const AbsorberAmounts surface = air->amounts(level_path(0, 5000));
      const AirSpectrum water = transmittance(surface, Gas::kH2o);
      AirSpectrum t(kAirBandCount);
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        t[b] = water[b] * std::exp(-surface.grey(GreyAbsorber::kWaterContinuum)[b]);
        if (humidity == 0) worst.see(std::abs(t[b] - 1), where);
      }
      // More water never lets more through.
      for (std::size_t b = 0; b < kAirBandCount && !drier.empty(); ++b) {
        worst.see(std::max(0.0, t[b] - drier[b]), where);
      }
      drier = t;
    }
  }
  return worst.finding();
}

constexpr std::array kThick = {AerosolKind::kAdvectionFog, AerosolKind::kRadiationFog,
                               AerosolKind::kRural, AerosolKind::kMaritime};

absl::StatusOr<Finding> fog(Effort) {
  Worst worst(1e-12);
  for (const AerosolKind kind : kThick) {
    ASSIGN_OR_RETURN(const auto air, air_of(AfglProfile::kUsStandard1976, kind, 200));
    const double temperature_k = air_at(air.profile(), 10).temperature_k;
    PathLight light;
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      light.surroundings_w_m2_sr_um.push_back(
          planck_radiance_w_m2_sr_um(air_band_lambda_um(b), temperature_k));
    }
    for (const double range_m : {1.0, 200.0, 1e4, 1e5, 1e7}) {
      const PathRadiance path = air.radiance(level_path(10, range_m), light);
      worst.see(impossible(path, hottest_k(air.profile())), [&] {
        return absl::StrCat("aerosol ", static_cast<int>(kind), ", ", range_m, " m");
      });
      worst.require(range_m < 1e3 || path.beyond_single_scattering(),
                    [] { return "scattering deeper than 0.3 is not flagged"; });
      // A path removes light. At least the particles' absorbed fraction of it is replaced by
      // emission. Emission and scattering from the surroundings together replace all of it: a
      // blackbody among blackbodies gives 1 - T.
      const AbsorberAmounts held = air.amounts(level_path(10, range_m));
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        const auto where = [&] {
          return absl::StrCat("aerosol ", static_cast<int>(kind), ", ", range_m, " m, band ", b);
        };
        const double absorbed = held.grey(GreyAbsorber::kAerosolAbsorption)[b],
                     scattered = held.grey(GreyAbsorber::kAerosolScattering)[b] +
                                 held.grey(GreyAbsorber::kMolecularScattering)[b];
        const double ended = 1 - path.transmittance[b];
        const double planck = light.surroundings_w_m2_sr_um[b];
        worst.see(std::max(0.0, ended * absorbed / (absorbed + scattered) -
                                    path.thermal_w_m2_sr_um[b] / planck),
                  where);
        worst.see(std::max(0.0, path.total_w_m2_sr_um[b] / planck - ended), where);
      }
    }
  }
  return worst.finding();
}

absl::StatusOr<Finding> visibility(Effort) {
  Worst worst(1.3e-3);
  const auto depth = [](const Atmosphere& air) {
    const AbsorberAmounts a = air.amounts(level_path(10, 100));
    AirSpectrum sum = a.grey(GreyAbsorber::kAerosolScattering);
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      sum[b] += a.grey(GreyAbsorber::kAerosolAbsorption)[b];
    }
    return sum;
  };
  for (const AerosolKind kind : kThick) {
    for (const double visibility_km : {0.2, 0.5, 1.0}) {
      ASSIGN_OR_RETURN(const auto less,
                       air_of(AfglProfile::kUsStandard1976, kind, 1e3 * visibility_km));
      ASSIGN_OR_RETURN(const auto more,
                       air_of(AfglProfile::kUsStandard1976, kind, 2e3 * visibility_km));
      const AirSpectrum thick = depth(less), thin = depth(more);
      // Koschmieder: 3.912 / visibility is the aerosol's extinction and 0.01159 / km of clean air.
      const double expected =
          (3.912 / visibility_km - 0.01159) / (3.912 / (2 * visibility_km) - 0.01159);
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        worst.see(std::abs(thick[b] / thin[b] / expected - 1), [&] {
          return absl::StrCat("aerosol ", static_cast<int>(kind), ", ", visibility_km, " km");
        });
      }
    }
  }
  return worst.finding();
}

absl::StatusOr<Finding> inversion(Effort) {
  // 12 K warmer 300 m up: the sky's emission is a mean of what lies on its way.
  constexpr const char* kSounding =
      "height_m,pressure_pa,temperature_k,relative_humidity_percent\n"
      "0,101325,276,95\n100,100100,280,80\n300,97700,288,50\n310,97580,288,50\n1000,89800,283,50\n"
      "3000,70000,270,30\n";
  ASSIGN_OR_RETURN(
      const auto profile,
      parse_profile_csv(kSounding, "inversion", afgl_profile(AfglProfile::kMidlatitudeWinter)));
  const auto air = Atmosphere::make({profile, {}});
  if (!air.ok()) return air.status();
  Worst worst(1e-12);
  for (const double zenith_deg : {0.0, 60.0, 89.0, 90.0}) {
    for (const double range_m : {50.0, 400.0, 3000.0}) {
      const LightPath path = look(profile, 0, zenith_deg, range_m);
      double low_k = 400, high_k = 0;
      for (const LightPath::Node& node : path.node) {
        const double t = air_at(profile, node.height_m).temperature_k;
        low_k = std::min(low_k, t);
        high_k = std::max(high_k, t);
      }
      const PathRadiance r = air->radiance(path);
      const AirSpectrum scattering = scattering_optical_depth(air->amounts(path));
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        const double lambda_um = air_band_lambda_um(b), opacity = 1 - r.transmittance[b];
        const double most = planck_radiance_w_m2_sr_um(lambda_um, high_k) * opacity,
                     least =
                         planck_radiance_w_m2_sr_um(lambda_um, low_k) * (opacity - scattering[b]);
        const auto where = [&] {
          return absl::StrCat("zenith ", zenith_deg, " deg, ", range_m, " m, band ", b);
        };
        worst.see(std::max(0.0, r.thermal_w_m2_sr_um[b] / most - 1), where);
        worst.see(std::max(0.0, (least - r.thermal_w_m2_sr_um[b]) / most), where);
      }
    }
  }
  return worst.finding();
}

absl::StatusOr<Finding> space(Effort) {
  ASSIGN_OR_RETURN(const auto air, hazy_air());
  Worst worst(1e-12);
  for (const double zenith_deg : {0.0, 60.0, 85.0, 90.0}) {
    const LightPath open = look(air.profile(), 10, zenith_deg, kFar);
    worst.require(open.end == PathEnd::kSpace && std::isinf(open.length_m), [&] {
      return absl::StrCat("zenith ", zenith_deg, " deg does not end in space");
    });
    const LightPath limited = look(air.profile(), 10, zenith_deg, 1e8);
    worst.see(
        largest_difference(transmittance(air.amounts(open)), transmittance(air.amounts(limited))),
        [&] { return absl::StrCat("zenith ", zenith_deg, " deg over 1e8 m"); });
  }
  // Above the air a path is that from its edge.
  const double top_m = air.profile().level.back().height_m;
  const AirSpectrum edge = transmittance(air.amounts(look(air.profile(), top_m, 180, kFar)));
  for (const double height_m : {2e5, 5e5, 36e6}) {
    worst.see(largest_difference(
                  edge, transmittance(air.amounts(look(air.profile(), height_m, 180, kFar)))),
              [&] { return absl::StrCat("nadir from ", height_m, " m"); });
    const PathRadiance nothing = air.radiance(look(air.profile(), height_m, 45, kFar));
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      worst.require(nothing.transmittance[b] == 1 && nothing.total_w_m2_sr_um[b] == 0,
                    [&] { return absl::StrCat("away from the Earth at ", height_m, " m"); });
    }
  }
  return worst.finding();
}

absl::StatusOr<Finding> polar_night(Effort) {
  ASSIGN_OR_RETURN(const auto air,
                   air_of(AfglProfile::kSubarcticWinter, AerosolKind::kMaritime, 23e3));
  Worst worst(0);
  const auto where = [](double zenith_deg) {
    return [=] { return absl::StrCat("sun at ", zenith_deg, " deg"); };
  };
  AirSpectrum higher;
  for (const double zenith_deg : {0.0, 60.0, 85.0, 89.0, 90.0, 90.3, 91.0, 95.0, 113.0, 180.0}) {
    const AirSpectrum sun = air.sun_irradiance_w_m2_um(0, SunPlace{zenith_deg, 0});
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      worst.require(std::isfinite(sun[b]) && sun[b] >= 0, where(zenith_deg));
      // Refraction lifts the sun by 0.6 deg at most.
      if (zenith_deg >= 91) worst.require(sun[b] == 0, where(zenith_deg));
      if (!higher.empty()) worst.require(sun[b] <= higher[b], where(zenith_deg));
    }
    higher = sun;
    PathLight light;
    light.sun = SunPlace{zenith_deg, 0};
    const PathRadiance level = air.radiance(level_path(10, 5000), light);
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      worst.require(std::isfinite(level.total_w_m2_sr_um[b]), where(zenith_deg));
      if (zenith_deg >= 95) worst.require(level.scattered_w_m2_sr_um[b] == 0, where(zenith_deg));
    }
  }
  return worst.finding();
}

}  // namespace

std::vector<HardCase> atmosphere_cases() {
  return {
      {"atmosphere", "optical_depth",
       "nitrogen alone, depth 1e-12 to 1e4: transmittance; emission in blackbodies, absolute",
       "Bouguer in doubles: 1 - T loses the last bit of 1 in each of two factors; the depth's own "
       "rounding grows with it and is divided out",
       air_optical_depth},
      {"atmosphere", "every_path",
       "0 m to 36000 km, zenith 0 to 180 deg, 0 m to space: beyond the possible, absolute",
       "transmittance in [0, 1]; emission of a mean of blackbodies at most (1 - T) of the hottest, "
       "after 60 steps' rounding of 2e-16",
       every_path},
      {"atmosphere", "around_the_horizon",
       "from 1 km, zenith 89.9 to 90.1 deg: rise of a transmittance as the ray sinks",
       "none but the numerics of a path, which claims 2e-4", around_the_horizon},
      {"atmosphere", "over_the_horizon",
       "10 m target, sensor 20 m up at 20 km: angle [deg]; visible to the sum of both horizons",
       "law of cosines in doubles over 6e6 m: 1e-9 m in 20 km is 3e-12 deg", over_the_horizon},
      {"atmosphere", "tangents",
       "tangent 1 m to 9 km up, from 10 to 300 km: against twice the half, transmittance",
       "two paths of 2e-4 each", tangents},
      {"atmosphere", "neighbours",
       "same height, 1 um to 1 m apart, 0 to 119 km: against a level path, transmittance",
       "the chord of 1 m hangs 2e-8 m lower, 1e-12 of the depth; nodes of 1e-9 m", neighbours},
      {"atmosphere", "reversal",
       "sensor above and below the target, 1 m to 100 km: change of transmittance",
       "five times what pieces may differ by: the steps end at other heights", reversal},
      {"atmosphere", "pieces", "lines cut at random: change of transmittance",
       "what atmosphere.h claims", pieces},
      {"atmosphere", "range", "1 mm to 1000 km in five directions: rise of a transmittance",
       "none but the numerics of a path, which claims 2e-4", range_is_monotone},
      {"atmosphere", "weather",
       "-60 to +50 C, humidity 0 to 100 %: water in dry air; rise with humidity; the impossible",
       "no water is 1 exactly; sums of exponentials fall term by term, rounding of 60 steps",
       weather},
      {"atmosphere", "fog",
       "visibility 0.2 km, 1 m to 10000 km: flag; emission less than what is absorbed, more than "
       "all",
       "a path among blackbodies of its own temperature is a blackbody, less than it lets through",
       fog},
      {"atmosphere", "visibility", "0.2 to 2 km: ratio of optical depths, relative",
       "amounts go with 3.912 / visibility - 0.01159 / km; the tables' third digit is 0.005 of "
       "1.94 / km at 2 km, half of which cancels",
       visibility},
      {"atmosphere", "inversion",
       "12 K warmer 300 m up: emission outside the blackbodies on its way, relative",
       "a mean with positive weights that add up to 1 - T; molecules scatter the rest", inversion},
      {"atmosphere", "space", "paths that end in space: against 1e8 m, and from above the air",
       "the same steps", space},
      {"atmosphere", "polar_night",
       "sun from the zenith to the nadir: light below the horizon, rises, numbers not finite",
       "refraction lifts the sun by less than 1 deg; each lower sun has more air before it",
       polar_night},
  };
}

}  // namespace irsig
