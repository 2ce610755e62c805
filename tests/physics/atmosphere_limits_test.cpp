// Rationale: whatever the table says, band means must obey what is exact: the structure of lines
// inside a band survives only if legs are joined by amounts. Expected: equalities to rounding or to
// the stated quadrature, and the known failure of products of band means. Source: the definition of
// random overlap (every combination of one term per gas with the product of their weights),
// enumerated here term by term; Kirchhoff; Bouguer; Planck.
#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>

#include "core/atmosphere/atmosphere.h"
#include "core/atmosphere/gas_table.h"
#include "core/atmosphere/lane_math.h"
#include "core/atmosphere/path_layers.h"
#include "core/spectral/planck.h"
#include "core/spectral/solar.h"

namespace irsig {
namespace {

constexpr double kFarLimit = std::numeric_limits<double>::infinity();

Atmosphere clean_air(AfglProfile profile = AfglProfile::kMidlatitudeSummer) {
  return *Atmosphere::make({afgl_profile(profile), {}});
}

Atmosphere hazy_air() {
  AtmosphereSpec spec{afgl_profile(AfglProfile::kMidlatitudeSummer), {}};
  spec.aerosol.kind = AerosolKind::kMaritime;
  spec.aerosol.visibility_m = 10e3;
  return *Atmosphere::make(spec);
}

// Every combination of terms of one band: its weight and, per stretch of air, its optical depth.
struct Combination {
  double weight;
  std::vector<double> depth;
};

std::vector<Combination> combinations(const std::vector<AbsorberAmounts>& stretch,
                                      std::size_t band) {
  const GasTable& table = gas_table();
  std::vector<Combination> all = {{1, {}}};
  for (const AbsorberAmounts& s : stretch) {
    double grey = 0;
    for (const AirSpectrum& depth : s.optical_depth) grey += depth[band];
    all[0].depth.push_back(grey);
  }
  for (std::size_t e = 0; e < table.entry.size(); ++e) {
    if (table.entry[e].band != band) continue;
    std::vector<Combination> next;
    for (const Combination& c : all) {
      for (std::size_t i = table.entry[e].first_term;
           i < table.entry[e].first_term + table.entry[e].terms; ++i) {
        // Combinations of negligible weight cost time only.
        if (c.weight * table.weight[i] < 1e-9) continue;
        Combination n = {c.weight * table.weight[i], c.depth};
        for (std::size_t s = 0; s < stretch.size(); ++s) {
          n.depth[s] += table.k_scaled_m2_kg[i] * stretch[s].gas_scaled_kg_m2[e] +
                        table.k_plain_m2_kg[i] * stretch[s].gas_plain_kg_m2[e];
        }
        next.push_back(std::move(n));
      }
    }
    all = std::move(next);
  }
  return all;
}

// 3.5, 3.9, 4.6, 8.6 and 11 um.
constexpr double kCentresCm1[] = {2855, 2565, 2175, 1165, 905};

std::size_t limit_band_of(double centre_cm1) {
  return static_cast<std::size_t>((centre_cm1 - kAirFirstCm1) / kAirBandWidthCm1);
}

TEST(AtmosphereLimits, BandsThatAreLeftOutChangeNoOther) {
  const Atmosphere air = *Atmosphere::make(
      {afgl_profile(AfglProfile::kUsStandard1976), {AerosolKind::kMaritime, 23e3}});
  const LightPath path = look(air.profile(), 10, 40, kFarLimit);
  // Selections have every length, and lie all over the lanes of a vector.
  std::vector<unsigned char> wanted(kAirBandCount, 0);
  for (std::size_t first = 0, length = 1; first + length < kAirBandCount; ++length) {
    std::fill_n(wanted.begin() + static_cast<std::ptrdiff_t>(first), length, 1);
    first += length + 3;
  }
  const BandChoice some(wanted);
  const AbsorberAmounts whole = air.amounts(path), part = air.amounts(path, some);
  const AirSpectrum t = transmittance(whole), of_part = transmittance(part, some),
                    of_whole = transmittance(whole, some);
  const PathLayers layers(air, path, BandChoice()), fewer(air, path, some);
  AbsorberAmounts twice;
  set_sum(twice, part, part, some);
  const AirSpectrum t_twice = transmittance(whole + whole), of_twice = transmittance(twice, some);
  std::size_t opaque = 0;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    EXPECT_EQ(of_part[b], wanted[b] ? t[b] : 0) << b;
    EXPECT_EQ(of_whole[b], wanted[b] ? t[b] : 0) << b;
    EXPECT_EQ(of_twice[b], wanted[b] ? t_twice[b] : 0) << b;
    EXPECT_EQ(fewer.thermal_w_m2_sr_um[b], wanted[b] ? layers.thermal_w_m2_sr_um[b] : 0) << b;
    EXPECT_EQ(fewer.surroundings_fraction[b], wanted[b] ? layers.surroundings_fraction[b] : 0) << b;
    opaque += t[b] < 0.5 ? 1 : 0;
  }
  EXPECT_GT(opaque, 20U);
  EXPECT_LT(opaque, kAirBandCount - 20);
}

TEST(AtmosphereLimits, LanesComputeExpAndLn) {
  for (double x = -699.7; x < 700; x += 0.0137) {
    EXPECT_NEAR(exp_lane(x) / std::exp(x), 1, 4e-16 + 1e-16 * std::abs(x)) << x;
  }
  EXPECT_EQ(exp_lane(0), 1);
  EXPECT_EQ(exp_lane(-700.1), 0);
  for (double x = DBL_MIN; x < 1e300; x *= 1.0173) {
    EXPECT_NEAR(ln_lane(x), std::log(x), 3e-16 * std::abs(std::log(x))) << x;
  }
  for (double off = 1e-15; off < 0.5; off *= 1.07) {
    EXPECT_NEAR(ln_lane(1 + off), std::log(1 + off), 3e-16 * std::log(1 + off)) << off;
    EXPECT_NEAR(ln_lane(1 - off), std::log(1 - off), -3e-16 * std::log(1 - off)) << off;
  }
  for (double x = 1e-300; x < 699; x *= 1.0371) {
    for (const double y : {x, -x}) {
      EXPECT_NEAR(expm1_lane(y).exp_minus_1 / std::expm1(y), 1, 6e-16 + 1e-16 * x) << y;
      EXPECT_NEAR(expm1_lane(y).exp / std::exp(y), 1, 4e-16 + 1e-16 * x) << y;
    }
    EXPECT_NEAR(log1p_lane(x) / std::log1p(x), 1, 1e-15) << x;
    if (x < 0.999) {
      EXPECT_NEAR(log1p_lane(-x) / std::log1p(-x), 1, 1e-15) << x;
    }
  }
  EXPECT_EQ(expm1_lane(0).exp_minus_1, 0);
  EXPECT_EQ(expm1_lane(-1e12).exp_minus_1, -1);
  EXPECT_EQ(ln_lane(1), 0);
  EXPECT_EQ(ln_lane(0), ln_lane(DBL_MIN));
}

TEST(AtmosphereLimits, NothingIsTransparent) {
  const Atmosphere air = hazy_air();
  const PathRadiance none = air.radiance(*look_between(air.profile(), 10, 10, 0));
  const AirSpectrum empty = transmittance(AbsorberAmounts());
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    EXPECT_EQ(none.transmittance[b], 1);
    EXPECT_EQ(none.total_w_m2_sr_um[b], 0);
    EXPECT_EQ(empty[b], 1);
  }
}

TEST(AtmosphereLimits, ReflectedSunByAmountsIsTheOverlappedSum) {
  const Atmosphere air = clean_air();
  const AbsorberAmounts sun = *air.sun_amounts(0, 60), sensor = air.amounts(level_path(10, 5000));
  const AirSpectrum joined = air.sun_irradiance_w_m2_um(0, SunPlace{60, 0}, &sensor);
  const AirSpectrum t_sun = transmittance(sun), t_sensor = transmittance(sensor);
  double product_worst = 1;
  for (const double nu : kCentresCm1) {
    const std::size_t b = limit_band_of(nu);
    double exact = 0;
    for (const Combination& c : combinations({sun, sensor}, b)) {
      exact += c.weight * std::exp(-c.depth[0] - c.depth[1]);
    }
    const double e0 = solar_irradiance_w_m2_um(air_band_lambda_um(b));
    EXPECT_NEAR(joined[b] / (e0 * exact), 1, 1e-4) << nu;
    product_worst = std::min(product_worst, t_sun[b] * t_sensor[b] / exact);
  }
  EXPECT_LT(product_worst, 0.95);  // why products of band means will not do
}

TEST(AtmosphereLimits, SkyBehindAirIsTheOverlappedSum) {
  const Atmosphere air = clean_air();
  const LightPath up = look(air.profile(), 0, 60, kFarLimit);
  const AbsorberAmounts near = air.amounts(level_path(10, 5000));
  const PathRadiance ours = air.radiance(up, {}, &near);
  const PathRadiance alone = air.radiance(up);
  const AirSpectrum t_near = transmittance(near);

  // The stretches up to each node.
  std::vector<AbsorberAmounts> stretch = {near};
  for (std::size_t i = 0; i < up.step_m.size(); ++i) {
    LightPath step;
    step.node = {up.node[i], up.node[i + 1]};
    step.step_m = {up.step_m[i]};
    stretch.push_back(air.amounts(step));
  }
  double product_worst = 1;
  for (const double nu : kCentresCm1) {
    const std::size_t b = limit_band_of(nu);
    std::vector<double> planck;
    for (const auto& node : up.node) {
      planck.push_back(planck_radiance_w_m2_sr_um(
          air_band_lambda_um(b), air_at(air.profile(), node.height_m).temperature_k));
    }
    double exact = 0;
    for (const Combination& c : combinations(stretch, b)) {
      double t = std::exp(-c.depth[0]), sum = 0;
      for (std::size_t i = 0; i + 1 < planck.size(); ++i) {
        const double x = c.depth[i + 1], absorbed = -std::expm1(-x);
        const double tilt = x < 1e-3 ? x * (0.5 - x / 3) : absorbed / x - (1 - absorbed);
        sum += t * (planck[i] * absorbed + (planck[i + 1] - planck[i]) * tilt);
        t *= 1 - absorbed;
      }
      exact += c.weight * sum;
    }
    EXPECT_NEAR(ours.thermal_w_m2_sr_um[b] / exact, 1, 0.01) << nu;
    product_worst = std::max(product_worst, t_near[b] * alone.thermal_w_m2_sr_um[b] / exact);
  }
  EXPECT_GT(product_worst, 1.1);
}

TEST(AtmosphereLimits, BeerHoldsPerTermAndNotForTheMean) {
  const Atmosphere air = clean_air();
  const AbsorberAmounts once = air.amounts(level_path(0, 2000)), twice = once + once;
  const AirSpectrum t1 = transmittance(once), t2 = transmittance(twice);
  double largest = 0;
  for (const double nu : kCentresCm1) {
    const std::size_t b = limit_band_of(nu);
    double exact = 0;
    for (const Combination& c : combinations({once}, b)) {
      exact += c.weight * std::exp(-2 * c.depth[0]);
    }
    EXPECT_NEAR(t2[b], exact, 1e-5) << nu;
    EXPECT_GE(t2[b], t1[b] * t1[b] - 1e-12);  // a convex mean
    largest = std::max(largest, t2[b] - t1[b] * t1[b]);
  }
  EXPECT_GT(largest, 0.01);
}

TEST(AtmosphereLimits, BouguerForGreyAbsorbersAlone) {
  // Dry air without other gases but nitrogen: exponential in range over 12 decades of depth.
  AtmosphereSpec spec{afgl_profile(AfglProfile::kUsStandard1976), {}, 0, 0, 0};
  for (AirLevel& level : spec.profile.level) level.gas = GasMix{};
  const Atmosphere air = *Atmosphere::make(spec);
  const std::size_t b = limit_band_of(2335);
  const double per_m = air.amounts(level_path(0, 1)).grey(GreyAbsorber::kNitrogen)[b];
  EXPECT_GT(per_m, 1e-5);
  for (double range_m = 1e-7; range_m < 1e9; range_m *= 100) {
    const AbsorberAmounts amounts = air.amounts(level_path(0, range_m));
    double depth = 0;
    for (const AirSpectrum& d : amounts.optical_depth) depth += d[b];
    EXPECT_NEAR(depth,
                (per_m + amounts.grey(GreyAbsorber::kMolecularScattering)[b] / range_m) * range_m,
                1e-9 * depth);
    const double t = transmittance(amounts)[b];
    EXPECT_NEAR(t, depth < 700 ? std::exp(-depth) : 0, 1e-12 * (depth < 1 ? 1 : t));
  }
}

TEST(AtmosphereLimits, PiecesAddUp) {
  const Atmosphere air = hazy_air();
  for (const auto& [height_m, zenith_deg, range_m] :
       {std::array{0.0, 60.0, 30e3}, std::array{20e3, 130.0, 12e3},
        std::array{100.0, 90.0, 40e3}}) {
    const LightPath whole = look(air.profile(), height_m, zenith_deg, range_m);
    const LightPath first = look(air.profile(), height_m, zenith_deg, 0.37 * range_m);
    const LightPath::Node end = first.node.back();
    const LightPath second =
        look(air.profile(), end.height_m, end.zenith_deg, range_m - 0.37 * range_m);
    const AirSpectrum a = transmittance(air.amounts(whole));
    const AirSpectrum c = transmittance(air.amounts(first) + air.amounts(second));
    for (std::size_t b = 0; b < kAirBandCount; ++b) EXPECT_NEAR(a[b], c[b], 2e-4) << b;
  }
}

TEST(AtmosphereLimits, ReversedPathHasTheSameTransmittance) {
  const Atmosphere air = hazy_air();
  for (const auto& [h1, h2, range_m] :
       {std::array{10.0, 3000.0, 15e3}, std::array{20.0, 10.0, 20e3},
        std::array{0.0, 40e3, 200e3}}) {
    const AirSpectrum there =
        transmittance(air.amounts(*look_between(air.profile(), h1, h2, range_m)));
    const AirSpectrum back =
        transmittance(air.amounts(*look_between(air.profile(), h2, h1, range_m)));
    for (std::size_t b = 0; b < kAirBandCount; ++b) EXPECT_NEAR(there[b], back[b], 1e-3) << b;
  }
}

TEST(AtmosphereLimits, EmissivityIsOneMinusTransmittance) {
  const Atmosphere air = clean_air();
  const PathRadiance path = air.radiance(level_path(500, 3000));
  const double temperature_k = air_at(air.profile(), 500).temperature_k;
  const AirSpectrum scattering =
      scattering_optical_depth(air.amounts(level_path(500, 3000)));  // molecules', 1e-6 to 1e-4
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    const double planck = planck_radiance_w_m2_sr_um(air_band_lambda_um(b), temperature_k);
    EXPECT_NEAR(path.total_w_m2_sr_um[b] / planck, 1 - path.transmittance[b],
                scattering[b] + 1e-12);
  }
}

TEST(AtmosphereLimits, OpaquePathsRadiateLikeTheAirAtTheObserver) {
  const Atmosphere air = clean_air();
  const std::size_t b = limit_band_of(2345);  // 4.26 um, opaque within 100 m
  for (const double zenith_deg : {0.0, 60.0, 90.0, 150.0}) {
    const PathRadiance sky = air.sky_radiance(3000, zenith_deg);
    EXPECT_LT(sky.transmittance[b], 1e-6);
    EXPECT_NEAR(radiance_temperature_k(air_band_lambda_um(b) - 1e-3, air_band_lambda_um(b) + 1e-3,
                                       2e-3 * sky.total_w_m2_sr_um[b]),
                air_at(air.profile(), 3000).temperature_k, 0.6)
        << zenith_deg;
  }
}

TEST(AtmosphereLimits, ScatteringIntoAnIsothermalPathRestoresTheBlackbody) {
  const Atmosphere air = hazy_air();
  PathLight light;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    light.surroundings_w_m2_sr_um.push_back(
        planck_radiance_w_m2_sr_um(air_band_lambda_um(b), 294.2));
  }
  const PathRadiance path = air.radiance(level_path(0, 2000), light);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    EXPECT_NEAR(path.total_w_m2_sr_um[b] / light.surroundings_w_m2_sr_um[b],
                1 - path.transmittance[b], 1e-6)
        << b;
  }
}

TEST(AtmosphereLimits, ScatteredSunAgreesWithTheThinLimit) {
  // A thin level path: E0 T_sun depth p(angle).
  const Atmosphere air = hazy_air();
  PathLight light;
  light.sun = SunPlace{50, 30, 1.0};
  const LightPath path = level_path(50, 10);
  const PathRadiance ours = air.radiance(path, light);
  const AbsorberAmounts amounts = air.amounts(path);
  const AirSpectrum sun = air.sun_irradiance_w_m2_um(50, *light.sun);
  const AirLevel level = air_at(air.profile(), 50);
  const AerosolOptics optics =
      aerosol_optics(air.spec().aerosol, 50, relative_humidity_percent(level),
                     relative_humidity_percent(air.profile().level[0]));
  const double cosine = std::sin(50 * M_PI / 180) * std::cos(30 * M_PI / 180);
  for (const double nu : kCentresCm1) {
    const std::size_t b = limit_band_of(nu);
    const double g = optics.asymmetry[b];
    const double phase = (1 - g * g) / (4 * M_PI * std::pow(1 + g * g - 2 * g * cosine, 1.5));
    const double expected = sun[b] * (amounts.grey(GreyAbsorber::kAerosolScattering)[b] * phase +
                                      amounts.grey(GreyAbsorber::kMolecularScattering)[b] * 3 /
                                          (16 * M_PI) * (1 + cosine * cosine));
    // The air of the 10 m itself absorbs, most in strong lines.
    EXPECT_NEAR(ours.scattered_w_m2_sr_um[b] / expected, 1, 0.01) << nu;
  }
}

TEST(AtmosphereLimits, DiffuseIrradianceOfAnOpaqueSkyIsPi) {
  const Atmosphere air = clean_air();
  const AirSpectrum down = air.sky_irradiance_w_m2_um(0);
  const std::size_t b = limit_band_of(2345);
  EXPECT_NEAR(down[b] / planck_radiance_w_m2_sr_um(air_band_lambda_um(b), 294.2), M_PI,
              0.02 * M_PI);
  // In the window the mean over angles lies above the zenith's radiance; 8 and 16 nodes agree.
  const std::size_t w = limit_band_of(905);
  const double zenith = air.sky_radiance(0, 0).total_w_m2_sr_um[w];
  EXPECT_GT(down[w], M_PI * zenith);
  EXPECT_NEAR(air.sky_irradiance_w_m2_um(0, {}, 16)[w] / down[w], 1, 1e-3);
}

TEST(AtmosphereLimits, MoreCarbonDioxideAbsorbsMore) {
  AtmosphereSpec spec{afgl_profile(AfglProfile::kMidlatitudeSummer), {}, 330};
  const AirSpectrum less = transmittance(Atmosphere::make(spec)->amounts(level_path(0, 3000)));
  spec.co2_ppmv = 425;
  const AirSpectrum more = transmittance(Atmosphere::make(spec)->amounts(level_path(0, 3000)));
  EXPECT_LT(more[limit_band_of(2405)], less[limit_band_of(2405)] - 0.02);
  for (std::size_t b = 0; b < kAirBandCount; ++b) EXPECT_LE(more[b], less[b]);
}

}  // namespace
}  // namespace irsig
