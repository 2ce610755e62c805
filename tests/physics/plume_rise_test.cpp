// Rationale: an integral model lives by its conserved fluxes and by its limits; a sign or a factor
// in entrainment, buoyancy or wind shows there and nowhere else. Expected: Morton, Taylor and
// Turner's plume in calm air and the two-thirds law in wind to the order of what they leave out;
// fluxes of CO2 and of heat through the voxels' cross-sections constant. Source: morton1956,
// briggs1984; balance of atoms by hand.
#include <gmock/gmock.h>

#include <numbers>

#include "core/plume/generate_plume.h"
#include "tests/physics/plume_fixture.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;
using namespace plume_fixture;
constexpr double kG = 9.80665;

std::vector<PlumeStation> plume(const PlumeExit& exit, const PlumeAir& air, double length_m,
                                double step = 0.02) {
  auto out = bent_plume(exit, air, length_m, step);
  if (!out.ok()) throw std::runtime_error(std::string(out.status().message()));
  return *std::move(out);
}

// Starts from a pure plume: R = 6/5 alpha z', w = 5/(6 alpha) (9/10 alpha F)^(1/3) z'^(-1/3), F per
// pi. Slightly warm gas: the closed form is Boussinesq's.
TEST(PlumeRise, CalmAirIsMortonTaylorTurner) {
  const double alpha = kEntrainmentAlong, diameter = 1, start = diameter / 2 / (1.2 * alpha);
  PlumeAir air;
  PlumeExit exit{diameter, 0, air.temperature_k + 1.0};
  // w at the start, with F = g w R^2 dT / T: a fixed point.
  double w = 1;
  for (int i = 0; i < 200; ++i) {
    exit.velocity_m_s = w;
    const double f = buoyancy_flux_m4_s3(exit, air);
    w = 5 / (6 * alpha) * std::cbrt(0.9 * alpha * f) / std::cbrt(start);
  }
  exit.velocity_m_s = w;
  const double f = buoyancy_flux_m4_s3(exit, air);
  const auto stations = plume(exit, air, 200);
  for (const PlumeStation& s : stations) {
    const double z = start + s.height_m;
    EXPECT_NEAR(s.radius_m, 1.2 * alpha * z, 0.005 * s.radius_m);
    EXPECT_NEAR(s.velocity_m_s, 5 / (6 * alpha) * std::cbrt(0.9 * alpha * f / z),
                0.005 * s.velocity_m_s);
    EXPECT_NEAR(s.angle_rad, std::numbers::pi / 2, 1e-12);
    EXPECT_NEAR(s.x_m, 0, 1e-9);
  }
  EXPECT_NEAR(stations.back().height_m, 200, 1e-9);
}

// Far away, whatever the opening was: z = (3 F / (2 beta^2 U^3))^(1/3) x^(2/3), with beta = 0.6
// Briggs' 1.6 F^(1/3) x^(2/3) / U.
TEST(PlumeRise, TwoThirdsLawInWind) {
  const PlumeExit exit{1.2, 25, 650};
  for (const double wind : {3.0, 10.0}) {
    const PlumeAir air{wind, 288.15, 101325};
    const double f = buoyancy_flux_m4_s3(exit, air);
    const auto stations = plume(exit, air, 30000);
    double slope = 0;
    for (std::size_t i = 1; i < stations.size(); ++i)
      if (stations[i].x_m > 10000 && slope == 0)
        slope = std::log(stations.back().height_m / stations[i].height_m) /
                std::log(stations.back().x_m / stations[i].x_m);
    EXPECT_NEAR(slope, 2.0 / 3, 0.01) << wind;
    const PlumeStation& end = stations.back();
    const double law = 1.6 * std::cbrt(f) * std::pow(end.x_m, 2.0 / 3) / wind;
    EXPECT_NEAR(end.height_m / law, 1, 0.03) << wind;
    EXPECT_NEAR(end.radius_m / (kEntrainmentAcross * end.height_m), 1, 0.03) << wind;
    EXPECT_NEAR(end.velocity_m_s / wind, 1, 1e-3);
  }
}

TEST(PlumeRise, FluxesAndStepsOfTheModel) {
  const PlumeExit exit{1.2, 25, 650};
  const PlumeAir air{8, 290, 101000};
  const auto coarse = plume(exit, air, 100), fine = plume(exit, air, 100, 0.01);
  EXPECT_NEAR(coarse.back().height_m, fine.back().height_m, 1e-6 * fine.back().height_m);
  EXPECT_NEAR(coarse.back().share, fine.back().share, 1e-6 * fine.back().share);
  const double mass = density_kg_m3(air, 650) * 25 * 0.36;
  double before = 0;
  for (const PlumeStation& s : coarse) {
    const double t = 290 + s.share * (650 - 290), rho = density_kg_m3(air, t);
    const double m = rho * s.velocity_m_s * s.radius_m * s.radius_m;
    EXPECT_NEAR(m * s.share, mass, 1e-9 * mass);
    // Buoyancy: g (rho_a - rho) / rho_a u R^2.
    EXPECT_NEAR(kG * (1 - rho / density_kg_m3(air, 290)) * s.velocity_m_s * s.radius_m * s.radius_m,
                buoyancy_flux_m4_s3(exit, air), 1e-9 * buoyancy_flux_m4_s3(exit, air));
    // Momentum across the wind grows by what buoyancy gives, along it by what is entrained.
    EXPECT_GE(m * s.velocity_m_s * std::sin(s.angle_rad), before);
    before = m * s.velocity_m_s * std::sin(s.angle_rad);
    EXPECT_NEAR(m * s.velocity_m_s * std::cos(s.angle_rad), 8 * (m - mass), 1e-6 * 8 * m);
  }
}

// CH1.85 with 20.95 % oxygen: at just enough air 1 CO2, 0.925 H2O and 5.5174 N2 of 6.9809 air.
TEST(PlumeRise, ExhaustByBalanceOfAtoms) {
  const ExhaustGas just = *exhaust_gas({1.85, 0, 0, 0}, 650, 101325);
  EXPECT_NEAR(just.co2, 1 / (1 + 0.925 + 1.4625 * 0.7905 / 0.2095), 1e-12);
  EXPECT_NEAR(just.h2o / just.co2, 0.925, 1e-12);
  const ExhaustGas lean = *exhaust_gas({1.85, 1.2, 0.01, 1}, 650, 101325);
  // 2.2 times 6.9809 of air, of which 1.4625 - 0.005 - 0.0012 oxygen is used.
  EXPECT_NEAR(lean.co2, 0.98884 / (2.2 * 6.9809 - 1.4563 + 1.925 - 0.00116), 1e-5);
  EXPECT_NEAR(lean.co / (lean.co2 + lean.co), 0.01, 2e-5);
  // 1 g of soot per 13.876 g of CH1.85 a mole: f_v in m3 of soot to m3 of gas.
  const double gas_m3 = 1 / lean.h2o * 0.925 * 8.31446261815324 * 650 / 101325;
  EXPECT_NEAR(lean.soot, 1e-3 * 13.8758e-3 / 1800 / gas_m3, 1e-4 * lean.soot);
  EXPECT_FALSE(exhaust_gas({5, 0, 0, 0}, 650, 101325).ok());
  EXPECT_FALSE(exhaust_gas({1.85, -0.1, 0, 0}, 650, 101325).ok());
  EXPECT_FALSE(exhaust_gas({1.85, 0, 1.01, 0}, 650, 101325).ok());
}

// The profile has the flux and the second moment of the uniform section, whatever its shape.
TEST(PlumeRise, ProfilesKeepFluxAndWidth) {
  const PlumeExit exit{1.2, 25, 650};
  const PlumeAir air{5, 288.15, 101325};
  double last_m = 1e9;
  for (const PlumeStation& s : plume(exit, air, 60)) {
    const PlumeProfile p = plume_profile(s, exit, air.temperature_k);
    EXPECT_LE(p.f0, 1);
    EXPECT_LE(p.m, last_m + 1e-9);
    last_m = p.m;
    double flux = 0, second = 0;
    const int n = 20000;
    for (int i = 0; i < n; ++i) {
      const double r = p.cut_m * (i + 0.5) / n, f = p.at(r);
      const double q = density_kg_m3(air, air.temperature_k + f * 361.85) * f * r * p.cut_m / n;
      flux += 2 * q;
      second += 2 * q * r * r;
    }
    const double mass = density_kg_m3(air, 650) * 25 * 0.36;
    EXPECT_NEAR(flux * s.velocity_m_s, mass, 1e-3 * mass) << s.s_m;
    EXPECT_NEAR(second / flux, s.radius_m * s.radius_m / 2, 2e-3 * s.radius_m * s.radius_m);
  }
  EXPECT_EQ(last_m, 2);
}

FunnelPlume frigate_funnel() {
  FunnelPlume out;
  out.exit = {1.2, 25, 650};
  out.wind_m_s = 5;
  out.wind_from_deg = 90;
  out.ship_speed_m_s = 4;
  out.length_m = 40;
  out.voxel_m = 0.25;
  return out;
}

// Flux of CO2 through the plane across the axis at a station, by rays in it, [mol/s].
double through_plane(const PlumeField& field, const GeneratedPlume& made, const PlumeStation& s) {
  const Vec<Body> down = made.downwind, up{0, 0, -1}, side = cross(up, down);
  const Vec<Body> at = s.x_m * down + s.height_m * up;
  const Vec<Body> across = std::cos(s.angle_rad) * up + -std::sin(s.angle_rad) * down;
  const double reach = 3 * s.radius_m, step = 0.1 * s.radius_m;
  double co2 = 0;
  for (double u = -reach + step / 2; u < reach; u += step)
    for (const GasSegment& g :
         march(field, {at + u * across - reach * side, side, 0, 2 * reach}, {}))
      co2 += step * g.amount[0];
  return co2 * s.velocity_m_s;
}

// Heat in voxels less that of air, against what the exhaust in them brought: of adiabatic mixing,
// rho c_p (T - T_a) = share rho c_p (T_0 - T_a), summed over all voxels.
double heat_by_exhaust(const VoxelVolume& volume, double exhaust_co2, double exit_k, double air_k) {
  double heat = 0, brought = 0;
  for (std::size_t i = 0; i < volume.value.size(); i += volume.channel.size()) {
    const double t = static_cast<double>(volume.value[i]);
    if (t == 0) continue;
    heat += 1 - air_k / t;
    brought += static_cast<double>(volume.value[i + 1]) / exhaust_co2 * (exit_k - air_k) / t;
  }
  return heat / brought;
}

TEST(PlumeRise, VoxelsCarryTheExhaustDownstream) {
  const FunnelPlume funnel = frigate_funnel();
  const auto made = generate_funnel_plume(funnel);
  ASSERT_TRUE(made.ok()) << made.status();
  // Blown aft and to port: the relative wind is (-4, -5) m/s.
  EXPECT_NEAR(made->downwind.x, -4 / std::sqrt(41.0), 1e-12);
  EXPECT_NEAR(made->downwind.y, -5 / std::sqrt(41.0), 1e-12);
  const auto field = plume_of(made->volume, made->grids);
  ASSERT_TRUE(field.ok()) << field.status();
  const ExhaustGas gas = *exhaust_gas(funnel.exhaust, 650, 101325);
  const double emitted =
      std::numbers::pi * 0.36 * 25 * gas.co2 * 101325 / (8.31446261815324 * 650);  // mol/s
  EXPECT_LT((*field)->report().most_k, 650.001);
  EXPECT_GT((*field)->report().most_k, 640);
  int planes = 0;
  for (const PlumeStation& s : made->axis) {
    if (s.s_m < 1 + 3 * planes || s.s_m > 37) continue;
    ++planes;
    EXPECT_NEAR(through_plane(**field, *made, s) / emitted, 1, 0.01) << s.s_m;
  }
  EXPECT_GE(planes, 12);
  EXPECT_NEAR(heat_by_exhaust(made->volume, gas.co2, 650, 288.15), 1, 0.01);
}

TEST(PlumeRise, WhatIsNoFunnel) {
  const auto refusal = [](const std::function<void(FunnelPlume&)>& change) {
    FunnelPlume funnel = frigate_funnel();
    change(funnel);
    const auto made = generate_funnel_plume(funnel);
    EXPECT_EQ(made.status().code(), absl::StatusCode::kInvalidArgument);
    return std::string(made.status().message());
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal([](FunnelPlume& f) { f.exit.temperature_k = 280; }),
              HasSubstr("exit temperature 280"));
  EXPECT_THAT(refusal([](FunnelPlume& f) { f.exit.velocity_m_s = 0; }),
              HasSubstr("exit velocity 0"));
  EXPECT_THAT(refusal([](FunnelPlume& f) { f.exit.diameter_m = -1; }), HasSubstr("voxel_m"));
  EXPECT_THAT(refusal([](FunnelPlume& f) { f.voxel_m = 2; }), HasSubstr("voxel_m 2"));
  EXPECT_THAT(refusal([](FunnelPlume& f) { f.voxel_m = 0.01; }),
              HasSubstr("more than 100000 blocks"));
  EXPECT_THAT(refusal([](FunnelPlume& f) { f.length_m = 0; }), HasSubstr("length 0"));
  EXPECT_THAT(refusal([](FunnelPlume& f) { f.wind_m_s = kNan; }), HasSubstr("not finite"));
  EXPECT_THAT(refusal([](FunnelPlume& f) { f.wind_m_s = -1; }), HasSubstr("wind -1"));
  EXPECT_THAT(refusal([](FunnelPlume& f) { f.air_temperature_k = kNan; }),
              HasSubstr("air temperature"));
  EXPECT_THAT(refusal([](FunnelPlume& f) { f.exhaust.excess_air = -1; }),
              HasSubstr("excess air -1"));
}

// Bodies of known volume: the amounts in their voxels.
TEST(PlumeRise, UniformBodiesHoldTheirVolume) {
  UniformPlume body{"slab", 2, 3, 4, 0.9, 900, 101325, 0.1, 0.05, 0.001, 1e-8, 0.1};
  const double mol_m3 = 0.1 * 101325 / (8.31446261815324 * 900);
  const std::pair<const char*, double> volumes[] = {{"slab", 24},
                                                    {"cylinder", std::numbers::pi * 0.81 * 2},
                                                    {"sphere", 4 * std::numbers::pi / 3 * 0.729}};
  for (const auto& [kind, volume_m3] : volumes) {
    body.kind = kind;
    const auto made = generate_uniform_plume(body);
    ASSERT_TRUE(made.ok()) << made.status();
    const auto field = plume_of(made->volume, made->grids);
    ASSERT_TRUE(field.ok()) << field.status();
    const auto& amount = (*field)->report().amount;
    EXPECT_NEAR(amount[0] / (mol_m3 * volume_m3), 1, 2e-3) << kind;
    EXPECT_NEAR(amount[1] / amount[0], 0.5, 1e-6);
    EXPECT_NEAR(amount[kSoot] / (1e-8 * volume_m3), 1, 2e-3);
  }
  body.kind = "cone";
  EXPECT_THAT(std::string(generate_uniform_plume(body).status().message()),
              HasSubstr("plume \"cone\""));
  body.kind = "sphere";
  body.co2 = 1.1;
  EXPECT_FALSE(generate_uniform_plume(body).ok());
  body.co2 = 0.1;
  body.temperature_k = 90;
  EXPECT_THAT(std::string(generate_uniform_plume(body).status().message()),
              HasSubstr("constant 90 K"));
}

}  // namespace
}  // namespace irsig
