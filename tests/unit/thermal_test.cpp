// Tests the refusals of core/thermal, and its helpers against arithmetic written down independently
// (numpy, printed here).
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "core/base/constants.h"
#include "core/thermal/clear_sky.h"
#include "core/thermal/condensation.h"
#include "tests/physics/wall_run.h"

namespace irsig {
namespace {

using namespace wall;
using ::testing::HasSubstr;

const Layer kSteel{0.01, 50, 7850, 460};
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::string message_of(const absl::Status& status) {
  return status.code() == absl::StatusCode::kInvalidArgument ? std::string(status.message())
                                                             : "not InvalidArgument";
}

TEST(Layers, NameTheLayerAndTheNumber) {
  EXPECT_TRUE(check_layers(std::vector{kSteel}).ok());
  EXPECT_TRUE(check_layers(std::vector{Layer{0.1, 0, 30, 1400}, Layer{0.1, 1, 0, 0}}).ok());
  EXPECT_THAT(message_of(check_layers({})), HasSubstr("at least one"));
  const auto second = [](Layer layer) {
    return message_of(check_layers(std::vector{kSteel, layer}));
  };
  EXPECT_EQ(second({0, 1, 1, 1}), "layer 1: thickness_m = 0, expected 1e-09 to 1e+06");
  EXPECT_EQ(second({1, -2, 1, 1}),
            "layer 1: conductivity_w_m_k = -2, expected 0 or 1e-09 to 1e+12");
  EXPECT_THAT(second({1, 1, kNan, 1}), HasSubstr("density_kg_m3 = nan"));
  EXPECT_THAT(second({1, 1, 1, INFINITY}), HasSubstr("specific_heat_j_kg_k = inf"));
  EXPECT_THAT(second({1, 0, 0, 1}), HasSubstr("nothing determines its temperature"));
}

class Refused : public ::testing::Test {
 protected:
  std::string refusal() {
    const auto result =
        solve_heat(request_, continuous(request_.knot_s, constant(outer_), constant(inner_)));
    return result.ok() ? "accepted" : message_of(result.status());
  }
  HeatRequest request_ =
      request_of({kSteel}, InnerSide::kAir, 290, {0, 3600, 7200}, HeatAccuracy{0.01, 3});
  Weather outer_{0, 300, 290, 5}, inner_{kNan, kNan, 290, 8};
};

TEST_F(Refused, Requests) {
  EXPECT_EQ(refusal(), "accepted");
  const HeatRequest good = request_;
  const auto with = [&](auto change) {
    request_ = good;
    change(request_);
    return refusal();
  };
  EXPECT_THAT(with([](auto& r) { r.layers[0].thickness_m = -1; }), HasSubstr("layer 0"));
  EXPECT_THAT(with([](auto& r) { r.knot_s = {0}; }), HasSubstr("number of knots = 1"));
  EXPECT_THAT(with([](auto& r) { r.knot_s = {0, 2, 2}; }), HasSubstr("knot_s[2] = 2"));
  EXPECT_THAT(with([](auto& r) { r.knot_s = {0, 1, 2e9}; }), HasSubstr("knot_s[2] = 2e+09"));
  EXPECT_THAT(with([](auto& r) { r.outer[0].emissivity = 1.1; }),
              HasSubstr("outer face of element 0: emissivity = 1.1"));
  EXPECT_THAT(with([](auto& r) { r.outer[0].convection.natural_cold = -1; }),
              HasSubstr("natural = -1"));
  EXPECT_THAT(with([](auto& r) { r.outer[0].convection.mixing = 2; }), HasSubstr("mixing = 2"));
  EXPECT_THAT(with([](auto& r) { r.inner = r.outer; }),
              HasSubstr("number of inner faces = 1, expected 0"));
  EXPECT_THAT(with([](auto& r) { r.inner_side = InnerSide::kOpen; }),
              HasSubstr("number of inner faces = 0, expected 1"));
  EXPECT_THAT(with([](auto& r) { r.start = StatedStart{{0}, 0}; }), HasSubstr("temperature_k = 0"));
  EXPECT_THAT(with([](auto& r) {
                r.start = StatedStart{{290, 290}, 0};
              }),
              HasSubstr("number of temperatures = 2"));
  EXPECT_THAT(with([](auto& r) {
                r.start = StatedStart{{290}, kNan};
              }),
              HasSubstr("uncertainty_k"));
  EXPECT_THAT(with([](auto& r) {
                r.start = PeriodicStart{290, 3, 0.01, 20};
              }),
              HasSubstr("intervals = 3"));
  EXPECT_THAT(with([](auto& r) {
                r.start = PeriodicStart{290, 1, 0, 20};
              }),
              HasSubstr("tolerance_k = 0"));
  EXPECT_THAT(with([](auto& r) {
                r.start = PeriodicStart{290, 1, 0.01, 1};
              }),
              HasSubstr("max_days = 1"));
  EXPECT_THAT(with([](auto& r) { r.output_knot = {0, 3}; }), HasSubstr("output_knot[1] = 3"));
  EXPECT_THAT(with([](auto& r) { r.output_boundary = {2}; }), HasSubstr("output_boundary = 2"));
  EXPECT_THAT(with([](auto& r) { r.accuracy.tolerance_k = 0; }), HasSubstr("tolerance_k = 0"));
  EXPECT_THAT(with([](auto& r) { r.accuracy.max_level = 11; }), HasSubstr("max_level = 11"));
  EXPECT_THAT(with([](auto& r) { r.layers[0].density_kg_m3 = 0; }),
              HasSubstr("emissivity of element 0"));
}

TEST_F(Refused, Exposures) {
  outer_.fluid_k = 0;
  EXPECT_EQ(refusal(), "interval 0, element 0, outer begin: fluid_k = 0, expected 1e-09 to 100000");
  outer_.fluid_k = kNan;
  EXPECT_THAT(refusal(), HasSubstr("fluid_k = nan"));
  outer_ = {0, 300, 290, -1};
  EXPECT_THAT(refusal(), HasSubstr("forced_h_w_m2_k = -1"));
  outer_ = {0, 300, 290, 5};
  inner_.forced_h_w_m2_k = kNan;
  EXPECT_THAT(refusal(), HasSubstr("inner begin: forced_h_w_m2_k = nan"));
}

TEST(Convection, Correlations) {
  EXPECT_NEAR(mowitt_forced_w_m2_k(5, WindSide::kWindward), 13.655289250364518, 1e-12);
  EXPECT_NEAR(mowitt_forced_w_m2_k(5, WindSide::kLeeward), 9.582809301132167, 1e-12);
  EXPECT_NEAR(tarp_natural(0).natural_warm, 1.31, 2e-3);
  EXPECT_NEAR(tarp_natural(0).natural_cold, 1.31, 2e-3);
  EXPECT_NEAR(tarp_natural(1).natural_warm, 9.482 / 6.238, 1e-12);
  EXPECT_NEAR(tarp_natural(1).natural_cold, 1.810 / 2.382, 1e-12);
  EXPECT_EQ(tarp_natural(-1).natural_cold, tarp_natural(1).natural_warm);
  EXPECT_NEAR(tarp_forced_w_m2_k(4, 40, 100, 1.67, WindSide::kWindward), 5.359162547129915, 1e-12);
  EXPECT_NEAR(tarp_forced_w_m2_k(4, 40, 100, 1.67, WindSide::kLeeward), 2.6795812735649574, 1e-12);
  const Fluid sea = sea_water(283.15);
  EXPECT_NEAR(sea.kinematic_viscosity_m2_s, 1.354e-6, 0.01e-6);  // 26th ITTC, 7.5-02-01-03
  EXPECT_NEAR(sea.prandtl, 9.5, 0.2);
  EXPECT_EQ(plate_in_flow_w_m2_k(sea, 0, 100), 0);
  const Fluid air{0.0263, 1.589e-5, 0.707};
  EXPECT_NEAR(plate_in_flow_w_m2_k(air, 5, 1), 8.726766437284805, 1e-9);    // Re 3.1e5
  EXPECT_NEAR(plate_in_flow_w_m2_k(air, 5, 10), 11.644169145422927, 1e-9);  // Re 3.1e6
}

TEST(ClearSky, BirdAndHulstrom) {
  struct Row {
    ClearSkyInput in;
    double direct, diffuse;
  };
  for (const Row& row :
       {Row{{30, 1361, 101325, 0.3, 1.5, 0.15, 0.1, 0.2}, 919.4632102575256, 116.91354303726871},
        Row{{60, 1367, 84000, 0.35, 0.5, 0.35, 0.27, 0.2}, 675.7242938555574, 149.21239585882034},
        Row{{84, 1400, 101325, 0.3, 3, 0.2, 0.15, 0.06}, 246.69955994079396, 34.30021716529008}}) {
    const ClearSkyIrradiance out = clear_sky_irradiance(row.in);
    EXPECT_NEAR(out.direct_normal_w_m2, row.direct, 1e-9);
    EXPECT_NEAR(out.diffuse_horizontal_w_m2, row.diffuse, 1e-9);
    EXPECT_FALSE(out.low_sun);
  }
  ClearSkyInput low{89.9, 1361, 101325, 0.3, 1.5, 0.15, 0.1, 0.2};
  EXPECT_TRUE(clear_sky_irradiance(low).low_sun);
  EXPECT_GT(clear_sky_irradiance(low).direct_normal_w_m2, 0);
  low.sun_zenith_deg = 120;
  EXPECT_EQ(clear_sky_irradiance(low).direct_normal_w_m2, 0);
  EXPECT_EQ(clear_sky_irradiance(low).diffuse_horizontal_w_m2, 0);
  EXPECT_NEAR(extraterrestrial_w_m2(3), 1361 * 1.0351, 0.3);    // perihelion
  EXPECT_NEAR(extraterrestrial_w_m2(185), 1361 * 0.9666, 0.3);  // aphelion
}

TEST(ClearSky, EmissivityAndVapour) {
  EXPECT_NEAR(vapour_pressure_pa(293.15), 2332.5960220978072, 1e-9);
  EXPECT_NEAR(vapour_pressure_pa(263.15), 287.0310312013222, 1e-9);
  for (const double t : {240.0, 273.15, 300.0}) {
    EXPECT_NEAR(dew_point_k(vapour_pressure_pa(t)), t, 1e-9);
  }
  EXPECT_NEAR(sky_emissivity_prata(293.15, 1200), 0.790463551381135, 1e-12);
  EXPECT_NEAR(sky_emissivity_berdahl_martin(283.15, 12, 101325),
              0.711 + 0.056 + 0.0073 - 0.013 + 0.00159, 1e-9);
  // Second opinions on the same sky: within 0.03 of each other.
  EXPECT_NEAR(sky_emissivity_prata(288.15, vapour_pressure_pa(280)),
              sky_emissivity_berdahl_martin(280, 6, 100000), 0.03);
  // Saturated air condenses where it is; dry air high up. [bolton1980]
  EXPECT_NEAR(condensation_level_m(288.15, 100), 0, 1e-9);
  EXPECT_NEAR(condensation_temperature_k(288.15, 60), 278.9, 0.3);
  EXPECT_NEAR(condensation_level_m(288.15, 60), 950, 40);
  // Rising air keeps cp T + g z + L r, r the mixing ratio, which above the level of condensation is
  // that of saturation. The sum is itself an approximation: 0.2 K in 2.5 km.
  EXPECT_NEAR(risen_air_k(288.15, 60, 1e5, 500), 288.15 - 4.88, 1e-9);
  for (const auto& [air_k, percent, surface_pa] : {std::tuple{288.15, 100.0, 1e5},
                                                   {268.15, 100.0, 1e5},
                                                   {300.15, 80.0, 1e5},
                                                   {261.05, 67.7, 77000.0}}) {
    constexpr double kTopM = 2500, kGravity = 9.80665, kCp = 1005, kHeat = 2.501e6;
    const double top_k = risen_air_k(air_k, percent, surface_pa, kTopM);
    const double top_pa =
        surface_pa * std::exp(-kGravity * kTopM / (287.04 * 0.5 * (air_k + top_k)));
    const auto mixing = [](double vapour_pa, double pressure_pa) {
      return 0.622 * vapour_pa / (pressure_pa - vapour_pa);
    };
    const double lost_k = air_k - top_k - kGravity * kTopM / kCp +
                          kHeat / kCp *
                              (mixing(percent / 100 * vapour_pressure_pa(air_k), surface_pa) -
                               mixing(vapour_pressure_pa(top_k), top_pa));
    EXPECT_NEAR(lost_k, 0, 0.2) << air_k << " " << percent;
  }
  EXPECT_NEAR(risen_air_k(288.15, 60, 1e5, condensation_level_m(288.15, 60)),
              condensation_temperature_k(288.15, 60), 1e-9);
}

// Rationale: a cloud of unknown type has no measured base, so that its default must be the middle
// of those that are observed. Expected: medians of ceilings in classes of the level of condensation
// scatter around the default on both sides at two stations, one continental at 1650 m and one at
// the sea, and are above the level of condensation itself in all classes.
// Source: ceilings, temperatures and humidities of hours with 10 tenths of opaque cover in the
// typical years of Denver (first) and San Francisco [wilcox2008].
TEST(Condensation, CeilingsOfOvercastSkiesAreTwiceAsHigh) {
  struct Class {
    int hours;
    double level_m, ceiling_m;  // medians
  };
  const std::vector<std::vector<Class>> stations = {
      {{340, 76, 183},
       {311, 211, 366},
       {168, 406, 762},
       {130, 620, 1676},
       {104, 949, 2286},
       {185, 1863, 3048}},
      {{311, 80, 488}, {406, 224, 457}, {354, 398, 518}, {120, 566, 914}, {42, 957, 2743}}};
  const auto within = [](double height_m) {
    return std::clamp(height_m, kLowestCondensationM, kHighestCondensationM);
  };
  // Relative humidity of air of 280 K with a level of condensation.
  const auto percent_at = [](double level_m) {
    double dry = 1, moist = 100;
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (dry + moist);
      (condensation_level_m(280, middle) > level_m ? dry : moist) = middle;
    }
    return moist;
  };
  for (const std::vector<Class>& station : stations) {
    double hours = 0, mean = 0;
    for (const Class& c : station) {
      EXPECT_GT(c.ceiling_m, c.level_m);
      const double base_m = condensed_base_m(280, percent_at(c.level_m));
      const double log_ratio = std::log(within(c.ceiling_m) / base_m);
      EXPECT_LT(std::abs(log_ratio), std::log(1.7)) << c.level_m;
      mean += c.hours * log_ratio;
      hours += c.hours;
    }
    EXPECT_LT(std::abs(mean / hours), 0.15);
  }
}

}  // namespace
}  // namespace irsig
