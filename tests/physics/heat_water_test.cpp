// Rationale: latent heat is one more term of a face's balance. Expected: a face that exchanges
// nothing but heat and vapour with the air settles where both are in balance, found here by
// bisection; what evaporates less, or at an infinite resistance, is warmer as the balance says; dew
// warms; no step, wind or wall makes the iteration fail, and heat is conserved; elements without
// water keep their bits beside wet ones. Source: the balance itself, [allen1998, eq. 3].
#include <cmath>
#include <limits>

#include "core/base/constants.h"
#include "core/thermal/clear_sky.h"
#include "core/thermal/evaporation.h"
#include "tests/physics/wall_run.h"

namespace irsig {
namespace {

using namespace wall;

constexpr Layer kThinSheet{0.001, 50, 7800, 500};

struct Damp {
  Weather weather;
  double vapour_pa = 0, pressure_pa = 101325, stomatal_w_m2_k = 0;
};

void set_damp(const FaceExposure& face, std::size_t i, const Damp& damp) {
  set(face, i, damp.weather);
  if (face.vapour_pa.empty()) return;
  face.vapour_pa[i] = damp.vapour_pa;
  face.inverse_gamma_k_pa[i] = inverse_gamma_k_pa(damp.weather.fluid_k, damp.pressure_pa);
  face.stomatal_w_m2_k[i] = damp.stomatal_w_m2_k;
}

ExposureOf always(const std::vector<Damp>& damp) {
  return [damp](std::size_t, std::span<const std::uint32_t> element, const Exposure& out) {
    for (std::size_t i = 0; i < element.size(); ++i) {
      set_damp(out.outer_begin, i, damp[element[i]]);
      set_damp(out.outer_end, i, damp[element[i]]);
    }
  };
}

HeatRequest sheet(std::vector<FaceProperties> outer, double start_k, double length_s = 36000) {
  std::vector<double> knot;
  for (int k = 0; k <= 20; ++k) knot.push_back(length_s / 20 * k);
  HeatRequest request = request_of({kThinSheet}, InnerSide::kAdiabatic, start_k, knot, {});
  request.outer = std::move(outer);
  return request;
}

// Returns the temperature at which a face's balance of heat vanishes.
double settled_k(const FaceProperties& face, const Damp& damp) {
  const auto heat = [&](double kelvin) {
    const Weather& w = damp.weather;
    const double above = kelvin - w.fluid_k;
    const Convection& c = face.convection;
    const double n = (above > 0 ? c.natural_warm : c.natural_cold) * std::cbrt(std::abs(above));
    const double f = w.forced_h_w_m2_k, h = std::sqrt(n * n + f * f + 2 * c.mixing * n * f),
                 hv = h * std::pow(0.85, -2.0 / 3);
    const double over = vapour_pressure_pa(kelvin) - damp.vapour_pa, g = damp.stomatal_w_m2_k;
    const double latent =
        0.622 * (2.501e6 - 2361 * (w.fluid_k - 273.15)) / (1005 * damp.pressure_pa) * over *
        (over > 0 ? face.evaporation.bare * hv +
                        face.evaporation.cover * (g > 0 ? 1 / (1 / hv + 1 / g) : 0)
                  : hv);
    return w.absorbed_w_m2 +
           face.emissivity * (w.incoming_w_m2 - kStefanBoltzmannWM2K4 * std::pow(kelvin, 4)) -
           h * above - latent;
  };
  double low = 200, high = 400;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (heat(middle) > 0 ? low : high) = middle;
  }
  return low;
}

TEST(HeatWater, SettlesWhereTheBalanceDoes) {
  const SurfaceWater wet{1, {}}, moist{0.4, {}}, leaves{0, Canopy{3, 100}},
      both{0.5, Canopy{1.5, 80}};
  std::vector<FaceProperties> face;
  std::vector<Damp> damp;
  for (const SurfaceWater& water : {wet, moist, leaves, both})
    for (const double air_k : {263.0, 283.0, 303.0})
      for (const double humidity : {0.2, 0.7, 0.999})
        for (const double sun : {0.0, 700.0})
          for (const double wind : {0.0, 3.0, 40.0}) {
            face.push_back({0.95, tarp_natural(1), evaporation_of(water)});
            damp.push_back({{sun, 0.85 * kStefanBoltzmannWM2K4 * std::pow(air_k, 4), air_k, wind},
                            humidity * vapour_pressure_pa(air_k),
                            90000,
                            water.canopy ? stomatal_w_m2_k(*water.canopy, sun, air_k, 90000) : 0});
          }
  HeatRequest request = sheet(face, 290);
  const HeatResult result = solved(request, always(damp));
  double worst_k = 0;
  for (std::size_t e = 0; e < face.size(); ++e) {
    const double kelvin = result.temperature_k[result.at(request.output_knot.back(), 0, e)];
    worst_k = std::max(worst_k, std::abs(kelvin - settled_k(face[e], damp[e])));
    EXPECT_LT(result.closure_w_m2[e], 1e-5);
  }
  std::printf("%zu faces, at most %.2g K from their balance\n", face.size(), worst_k);
  EXPECT_LT(worst_k, 1e-3);
}

TEST(HeatWater, APsychrometerShowsTheHumidity) {
  // No radiation: the wet bulb. With Le = 0.85 its constant is Le^(2/3) gamma.
  const FaceProperties face{0, kForcedOnly, evaporation_of({1, {}})};
  const Damp damp{{0, 0, 298.15, 50}, 1500};
  HeatRequest request = sheet({face}, 298.15);
  const HeatResult result = solved(request, always({damp}));
  const double bulb_k = result.temperature_k.back();
  const double psychrometer_pa_k = std::pow(0.85, 2.0 / 3) / inverse_gamma_k_pa(298.15, 101325);
  EXPECT_NEAR(vapour_pressure_pa(bulb_k) - psychrometer_pa_k * (298.15 - bulb_k), 1500, 0.05);
  EXPECT_NEAR(1 / inverse_gamma_k_pa(293.15, 101325), 66.7, 0.5);  // [allen1998, table 2.2]
}

TEST(HeatWater, DewWarmsAndDrynessDoesNot) {
  const Damp clear_night{{0, 230, 285, 5}, 0.98 * vapour_pressure_pa(285)};
  const FaceProperties dry{0.95, tarp_natural(1)},
      asleep{0.95, tarp_natural(1), evaporation_of({0, Canopy{3, 100}})};
  HeatRequest request = sheet({dry, asleep}, 285);
  const HeatResult result = solved(request, always({clear_night, clear_night}));
  const std::size_t last = request.output_knot.back();
  const double dry_k = result.temperature_k[result.at(last, 0, 0)],
               dewy_k = result.temperature_k[result.at(last, 0, 1)];
  EXPECT_LT(dry_k, dewy_k - 1);
  EXPECT_LT(dewy_k, 285);
  // Above the dew point nothing happens to what is dry.
  Damp noon{{600, 380, 295, 5}, 900};
  const HeatResult day = solved(request, always({noon, noon}));
  EXPECT_EQ(day.temperature_k[day.at(last, 0, 0)], day.temperature_k[day.at(last, 0, 1)]);
}

TEST(HeatWater, ElementsWithoutWaterKeepTheirBits) {
  const FaceProperties dry{0.9, tarp_natural(0.3)},
      wet{0.9, tarp_natural(0.3), evaporation_of({1, {}})};
  const Damp damp{{300, 320, 290, 7}, 800};
  const HeatResult alone = solved(sheet({dry}, 285), always({damp})),
                   beside = solved(sheet({wet, dry}, 285), always({damp, damp}));
  for (std::size_t k = 0; k <= 20; ++k)
    EXPECT_EQ(alone.temperature_k[alone.at(k, 0, 0)], beside.temperature_k[beside.at(k, 0, 1)]);
}

TEST(HeatWater, NothingMakesItFail) {
  // Foils and thick walls, calm and storm, steps of a second and of ten hours, from far away.
  for (const Layer& layer : {Layer{1e-9, 50, 7800, 500}, Layer{1, 1, 2000, 1000}})
    for (const double length_s : {20.0, 3.6e6})
      for (const double start_k : {150.0, 280.0, 700.0}) {
        std::vector<FaceProperties> face;
        std::vector<Damp> damp;
        for (const double wind : {0.0, 1e-3, 500.0})
          for (const double vapour_pa : {0.0, 600.0, 6000.0})
            for (const double sun : {0.0, 1e4}) {
              face.push_back({0.9, tarp_natural(1), evaporation_of({1, Canopy{3, 40}})});
              damp.push_back({{sun, 250, 275, wind}, vapour_pa, 101325, 30});
            }
        HeatRequest request = sheet(face, start_k, length_s);
        request.layers = {layer};
        request.accuracy.max_level = 2;
        const HeatResult result = solved(request, always(damp));
        for (const double kelvin : result.temperature_k) {
          ASSERT_GT(kelvin, 100);
          ASSERT_LT(kelvin, 800);
        }
        for (const double closure : result.closure_w_m2) EXPECT_LT(closure, 0.01);
      }
}

TEST(HeatWater, WhatIsWrongIsNamed) {
  EXPECT_FALSE(check_water({1.5, {}}).ok());
  EXPECT_FALSE(check_water({0, Canopy{0, 100}}).ok());
  EXPECT_FALSE(check_water({0, Canopy{3, 1}}).ok());
  EXPECT_FALSE(check_water({std::numeric_limits<double>::quiet_NaN(), {}}).ok());
  EXPECT_TRUE(check_water({1, Canopy{3, 100}}).ok());
  HeatRequest request = sheet({{0.9, kForcedOnly, evaporation_of({1, {}})}}, 290);
  Damp damp{{0, 300, 290, 5}, -1};
  const auto negative = solve_heat(request, always({damp}));
  ASSERT_FALSE(negative.ok());
  EXPECT_NE(negative.status().message().find("outer begin: vapour_pa"), std::string::npos);
  request.inner_side = InnerSide::kOpen;
  request.inner = request.outer;
  EXPECT_FALSE(solve_heat(request, always({damp})).ok());
}

}  // namespace
}  // namespace irsig
