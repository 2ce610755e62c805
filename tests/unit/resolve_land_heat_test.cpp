// Land whose temperatures are computed: what its keys become in a resolved sweep, which jobs depend
// on them, and what a submitted sweep may not have of it. Errors in sweep files:
// bad_sweeps/land_heat*.toml.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "core/materials/optical/material_library.h"
#include "core/spectral/solar.h"
#include "jobs/check_resolved.h"
#include "jobs/keys/expand.h"
#include "jobs/resolve_land.h"
#include "jobs/resolve_sweep.h"
#include "tests/unit/heated_land.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

absl::StatusOr<schema::ResolvedSweep> heated_land(const std::string& text,
                                                  const std::string& bytes = "") {
  auto file = parse_sweep(text, "s.toml");
  if (!file.ok()) return file.status();
  const auto read = [&](const std::string& name) -> absl::StatusOr<std::string> {
    return bytes.empty() ? "bytes of " + name : bytes;
  };
  if (const absl::Status status = read_land_files(*file, read); !status.ok()) return status;
  return resolve_sweep(*file, "");
}

std::string with_text(const std::string& text, const std::string& from, const std::string& to) {
  EXPECT_THAT(text, HasSubstr(from));
  return absl::StrReplaceAll(text, {{from, to}});
}

const schema::BuildUp& ground_of(const schema::Sweep& sweep, int material) {
  for (const schema::BuildUp& b : sweep.build_up())
    if (b.name() == sweep.land().material(material).build_up()) return b;
  ADD_FAILURE() << "no build-up of material " << material;
  return schema::BuildUp::default_instance();
}

TEST(ResolveLandHeat, MaterialsOfTheLibraryHaveGroundByDefault) {
  const auto sweep = heated_land(kHeatedLand);
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  const schema::BuildUp &road = ground_of(sweep->sweep(), 0), &lawn = ground_of(sweep->sweep(), 1);
  EXPECT_EQ(road.name(), "land asphalt");
  EXPECT_EQ(road.inside(), "adiabatic");
  ASSERT_EQ(road.layer_size(), 3);
  EXPECT_EQ(road.layer(0).conductivity_w_m_k(), 0.7);  // solids.h
  EXPECT_FALSE(road.layer(0).has_solid());
  EXPECT_FALSE(road.has_surface_moisture());
  EXPECT_EQ(lawn.canopy().stomatal_resistance_s_m(), 100);
  EXPECT_EQ(lawn.surface_moisture(), 0);
  for (const schema::Material& m : sweep->sweep().material())
    EXPECT_TRUE(m.has_solar_absorptance());

  // Asphalt is stated in winter: each season has a run, and each condition the run of its season.
  ASSERT_EQ(sweep->heat_size(), 2);
  EXPECT_THAT(sweep->heat(0).land_temperature_k(), ElementsAre(0, 0));
  EXPECT_THAT(sweep->heat(1).land_temperature_k(), ElementsAre(274, 0));
  EXPECT_EQ(sweep->heat(0).time_utc_size(), 2);
  for (int c = 0; c < 4; ++c) {
    EXPECT_FALSE(sweep->condition(c).has_temperature_field());
    ASSERT_TRUE(sweep->condition(c).has_land_heat());
    EXPECT_EQ(sweep->condition(c).land_heat(), static_cast<unsigned>(c / 2));
  }
  EXPECT_THAT(sweep->condition(3).land_temperature_k(), ElementsAre(274, 0));
  EXPECT_TRUE(check_resolved(*sweep).ok()) << check_resolved(*sweep);
}

TEST(ResolveLandHeat, WhatTheFileStatesStands) {
  const std::string own = absl::StrCat(kHeatedLand, R"(build_up = "land asphalt"
[[build_up]]
name = "land asphalt"
inside = "adiabatic"
layer = [{ solid = "peat_dry", thickness_m = 1 }]
[[material]]
name = "asphalt"
kind = "library"
solar_absorptance = 0.95
)");
  const auto sweep = heated_land(own);
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  EXPECT_EQ(sweep->sweep().land().material(1).build_up(), "land asphalt");
  EXPECT_EQ(sweep->sweep().land().material(0).build_up(), "land asphalt 2");
  for (const schema::Material& m : sweep->sweep().material()) {
    if (m.name() == "asphalt") {
      EXPECT_EQ(m.solar_absorptance(), 0.95);
    }
  }
  EXPECT_TRUE(check_resolved(*sweep).ok()) << check_resolved(*sweep);

  const auto stated = heated_land(
      with_text(with_text(kHeatedLand, "{ asphalt = 274 }", "{ asphalt = 274, grass = 274 }"),
                "fraction_file = \"asphalt.asc\"\n",
                "fraction_file = \"asphalt.asc\"\ntemperature_k = 300\n"));
  ASSERT_TRUE(stated.ok()) << stated.status();
  EXPECT_FALSE(stated->sweep().land().material(0).has_build_up());
  EXPECT_EQ(stated->heat_size(), 1);
  EXPECT_THAT(stated->condition(0).land_temperature_k(), ElementsAre(300, 0));
  EXPECT_FALSE(stated->condition(2).has_land_heat());
  EXPECT_TRUE(check_resolved(*stated).ok()) << check_resolved(*stated);
}

TEST(ResolveLandHeat, AWallOfObjectsHasNoGroundBehindIt) {
  const auto sweep = heated_land(absl::StrCat(kHeatedLand, R"([[land.material]]
material = "brick"
objects_only = true
[[land.object]]
model = "house.obj"
unit_m = 1
forward_axis = "+x"
up_axis = "+z"
material = "brick"
place = [{ east_m = 50, north_m = -20 }]
)"));
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  EXPECT_EQ(ground_of(sweep->sweep(), 2).layer_size(), 1);
  EXPECT_TRUE(check_resolved(*sweep).ok()) << check_resolved(*sweep);
}

// Expected: the entry's emissivity from 0.3 to 2.5 um under the sun's spectrum, rounded to 0.01.
TEST(ResolveLandHeat, AbsorptancesAreThoseOfTheirSpectra) {
  for (const char* name : {"grass", "wheat", "bare_soil_dry", "bare_soil_wet", "sand", "asphalt",
                           "concrete", "brick"}) {
    const auto sweep =
        heated_land(with_text(kHeatedLand, "\"grass\"", absl::StrCat("\"", name, "\"")));
    if (std::string(name) == "asphalt") continue;  // the other material of the land
    ASSERT_TRUE(sweep.ok()) << sweep.status();
    for (const schema::Material& m : sweep->sweep().material()) {
      if (m.name() == "paint") continue;
      double sun = 0, absorbed = 0;
      constexpr double kStepUm = 0.002;
      for (double um = 0.3 + kStepUm / 2; um < 2.5; um += kStepUm) {
        const auto& table = m.emissivity_table();
        int i = 1;
        while (table[i].lambda_um() < um) ++i;
        const double part =
            (um - table[i - 1].lambda_um()) / (table[i].lambda_um() - table[i - 1].lambda_um());
        const double emissivity = (1 - part) * table[i - 1].value() + part * table[i].value();
        sun += solar_irradiance_w_m2_um(um);
        absorbed += solar_irradiance_w_m2_um(um) * emissivity;
      }
      EXPECT_NEAR(m.solar_absorptance(), absorbed / sun, 0.0051) << m.name();
    }
  }
}

// Temperatures of land depend on heights, fractions and ground, and not on who looks.
TEST(ResolveLandHeat, KeysOfHeatJobsCoverTheLand) {
  const auto key_of = [](const absl::StatusOr<schema::ResolvedSweep>& sweep) {
    EXPECT_TRUE(sweep.ok()) << sweep.status();
    return sweep.ok() ? expand_jobs(*sweep, 1).at(0).job_key() : "";
  };
  const std::string same = key_of(heated_land(kHeatedLand, "bytes"));
  for (const auto& [from, to] : {std::pair{"azimuth_deg = 0", "azimuth_deg = 10"},
                                 {"lambda_max_um = 12", "lambda_max_um = 11"},
                                 {"winter", "cold"},
                                 {"\"heights.asc\"", "\"maps/hills.ASC\""}})
    EXPECT_EQ(same, key_of(heated_land(with_text(kHeatedLand, from, to), "bytes"))) << to;
  EXPECT_NE(same, key_of(heated_land(kHeatedLand, "other bytes")));
  const std::string key = key_of(heated_land(kHeatedLand));
  for (const auto& [from, to] :
       {std::pair{"geoid_m = 0", "geoid_m = 1"},
        {"\"grass\"\n", "\"wheat\"\n"},
        {"\"grass\"\n",
         "\"grass\"\nbuild_up = \"b\"\n[[build_up]]\nname = \"b\"\ninside = "
         "\"adiabatic\"\nlayer = [{ solid = \"peat_dry\", thickness_m = 1 }]\n"},
        {"\"grass\"\n", "\"grass\"\ntemperature_k = 290\n"},
        {"290\nrel", "291\nrel"}})
    EXPECT_NE(key, key_of(heated_land(with_text(kHeatedLand, from, to)))) << to;
}

TEST(ResolveLandHeat, SubmittedSweepsAreChecked) {
  const auto good = heated_land(kHeatedLand);
  ASSERT_TRUE(good.ok()) << good.status();
  const std::pair<const char*, std::function<void(schema::ResolvedSweep&)>> changes[] = {
      {"condition[0].land_temperature_k = 0 without a land_heat that computes it",
       [](auto& s) { s.mutable_condition(0)->clear_land_heat(); }},
      {"condition[0].land_heat = 1 is a run of other land than land_temperature_k",
       [](auto& s) { s.mutable_condition(0)->set_land_heat(1); }},
      {"condition[0].land_heat = 2: there is no such run",
       [](auto& s) { s.mutable_condition(0)->set_land_heat(2); }},
      {"condition[0].land_heat does not apply: all land_temperature_k are stated",
       [](auto& s) {
         for (double& k : *s.mutable_condition(0)->mutable_land_temperature_k()) k = 280;
       }},
      {"heat[0].land_temperature_k has 1 elements for 2 materials of the land",
       [](auto& s) { s.mutable_heat(0)->mutable_land_temperature_k()->RemoveLast(); }},
      {"heat[0] computes land.material[1], which has no build_up",
       [](auto& s) {
         auto& material = *s.mutable_sweep()->mutable_land()->mutable_material(1);
         material.clear_build_up();
         material.set_temperature_k(280);
       }},
  };
  for (const auto& [expected, change] : changes) {
    schema::ResolvedSweep bad = *good;
    change(bad);
    EXPECT_THAT(std::string(check_resolved(bad).message()), HasSubstr(expected));
  }
}

// Uncertain inputs leave land as it is: a run without parts to compute has no run of changes.
TEST(ResolveLandHeat, InputsAreMovedForLandAndParts) {
  const std::string moved = absl::StrCat(kHeatedLand, "[uncertainty]\nair_temperature_k = 1\n");
  const auto land = heated_land(moved);
  ASSERT_TRUE(land.ok()) << land.status();
  // Two runs, and the changes of each.
  ASSERT_EQ(land->heat_size(), 4);
  EXPECT_EQ(land->heat(2).land_temperature_k_size(), 2);
  const auto both = heated_land(
      absl::StrCat(with_text(moved, "\ntemperature_k = 300\n", "\nbuild_up = \"plate\"\n"),
                   "[[build_up]]\nname = \"plate\"\ninside = \"adiabatic\"\n"
                   "layer = [{ solid = \"steel\", thickness_m = 0.01 }]\n"));
  ASSERT_TRUE(both.ok()) << both.status();
  ASSERT_EQ(both->heat_size(), 4);
  EXPECT_EQ(both->heat(0).land_temperature_k_size(), 2);
  EXPECT_EQ(both->heat(2).input_size(), 1);
  EXPECT_EQ(both->heat(2).land_temperature_k_size(), 2);
  EXPECT_TRUE(check_resolved(*both).ok()) << check_resolved(*both);
}

}  // namespace
}  // namespace irsig
