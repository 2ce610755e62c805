// Computed temperatures of land, from a heat job to the view that takes them, and what a damaged
// output may not do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "core/land/generate_terrain.h"
#include "jobs/keys/expand.h"
#include "jobs/resolve_land.h"
#include "jobs/resolve_sweep.h"
#include "messages/scene/land_heat_messages.h"
#include "runner/heat_field.h"
#include "runner/heat_outputs.h"
#include "runner/job_runner.h"
#include "runner/land_temperatures.h"
#include "runner/spec_to_request.h"
#include "tests/unit/heated_land.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

struct HeatedLand {
  schema::ResolvedSweep sweep;
  Assets assets;
};
absl::StatusOr<HeatedLand> heated_land_of(const std::string& text = kHeatedLand) {
  auto file = parse_sweep(text, "s.toml");
  if (!file.ok()) return file.status();
  const absl::Status read =
      read_land_files(*file, [&](const std::string& name) -> absl::StatusOr<std::string> {
        const auto layer = generate_terrain({.seed = 1, .width_m = 1000, .spacing_m = 20},
                                            name.substr(0, name.find('.')));
        if (!layer.ok()) return layer.status();
        return write_asc(*layer);
      });
  if (!read.ok()) return read;
  auto sweep = resolve_sweep(*file, "");
  if (!sweep.ok()) return sweep.status();
  HeatedLand out{*std::move(sweep), {}};
  for (const auto& [key, bytes] : land_bytes(*file))
    out.assets[sha256_hex(bytes)] = std::string(bytes);
  return out;
}

// Few samples: the numbers of the rows are not looked at here.
std::string quick(const std::string& text) {
  return absl::StrCat(absl::StrReplaceAll(text, {{"triangles = 64", "triangles = 12"}}),
                      "[accuracy]\nsamples_per_replicate = 64\n[output]\nthumbnail_px = 0\n");
}

TEST(LandHeat, AHeatJobComputesWhatViewsTake) {
  const auto land = heated_land_of(quick(kHeatedLand));
  ASSERT_TRUE(land.ok()) << land.status();
  const schema::ResolvedSweep& sweep = land->sweep;
  const auto jobs = expand_jobs(sweep, physics_version());
  ASSERT_EQ(jobs.size(), 3U);
  const auto first = JobRunner::create(sweep, land->assets, {});
  ASSERT_TRUE(first.ok()) << first.status();
  const absl::Status too_early = (*first)->run(jobs[2]).status();
  EXPECT_TRUE(absl::IsFailedPrecondition(too_early)) << too_early;
  HeatOutputs outputs;
  for (int run = 0; run < 2; ++run) {
    const auto result = (*first)->run(jobs[static_cast<std::size_t>(run)]);
    ASSERT_TRUE(result.ok()) << result.status();
    EXPECT_EQ(result->heat().part_size(), 0);
    outputs.push_back(result->heat().field());
  }
  const auto same = heat_outputs(sweep, land->assets);
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_EQ(*same, outputs) << "the land of the runner, and land read for this";
  std::size_t bytes = 0;
  for (const std::string& output : outputs) bytes += output.size();
  EXPECT_GE((*first)->heat_bytes() + 100000, bytes);

  const auto scene = scene_from_sweep(sweep, land->assets, outputs);
  ASSERT_TRUE(scene.ok()) << scene.status();
  ASSERT_NE(scene->land->kinds, nullptr);
  const LandKinds& kinds = *scene->land->kinds;
  const LandTemperatures& warm = scene->temperatures.land;
  ASSERT_EQ(warm.kelvin.size(), 4U);
  for (std::size_t c = 0; c < 4; ++c) {
    ASSERT_EQ(warm.kelvin[c].size(), kinds.kind.size());
    for (std::size_t k = 0; k < kinds.kind.size(); ++k) {
      const bool stated = c >= 2 && kinds.kind[k].material == 0;
      if (stated) {
        EXPECT_EQ(warm.kelvin[c][k], 274) << c << " " << k;
        EXPECT_EQ(warm.error_k[c][k], 0);
      } else {
        EXPECT_GT(warm.kelvin[c][k], 240);
        EXPECT_LT(warm.kelvin[c][k], 350);
        EXPECT_GT(warm.error_k[c][k], 0);
      }
    }
  }
  EXPECT_NE(warm.error_k[0], warm.error_k[1]) << "each time has errors of its own";
  // Level land at noon of a summer's day: asphalt is warmer than grass, and both than at 6 h.
  EXPECT_TRUE(kinds.kind.front().normal.z == 1 && !kinds.kind.front().object);
  std::size_t grass = 0;
  while (kinds.kind[grass].material == 0) ++grass;
  EXPECT_GT(warm.kelvin[1][0], warm.kelvin[1][grass] + 3);
  EXPECT_GT(warm.kelvin[1][grass], warm.kelvin[0][grass] + 1);

  const auto second = JobRunner::create(sweep, land->assets, outputs);
  ASSERT_TRUE(second.ok()) << second.status();
  const auto view = (*second)->run(jobs[2]);
  ASSERT_TRUE(view.ok()) << view.status();
  EXPECT_EQ(view->view().row_size(), 4);
}

TEST(LandHeat, PartsAndLandMayBeComputedTogether) {
  const auto land = heated_land_of(quick(absl::StrCat(
      absl::StrReplaceAll(kHeatedLand, {{"\ntemperature_k = 300\n", "\nbuild_up = \"plate\"\n"}}),
      "[[build_up]]\nname = \"plate\"\ninside = \"adiabatic\"\n"
      "layer = [{ solid = \"steel\", thickness_m = 0.01 }]\n")));
  ASSERT_TRUE(land.ok()) << land.status();
  const auto together = compute_heat(land->sweep, land->assets, 0);
  ASSERT_TRUE(together.ok()) << together.status();
  EXPECT_EQ(together->part_size(), 2);
  schema::HeatField field;
  ASSERT_TRUE(field.ParseFromString(together->field()));
  EXPECT_TRUE(field.has_land());

  // Land does not depend on the target.
  const auto alone = heated_land_of(quick(kHeatedLand));
  ASSERT_TRUE(alone.ok()) << alone.status();
  const auto without = compute_heat(alone->sweep, alone->assets, 0);
  ASSERT_TRUE(without.ok()) << without.status();
  schema::HeatField of_land;
  ASSERT_TRUE(of_land.ParseFromString(without->field()));
  EXPECT_EQ(of_land.land().SerializeAsString(), field.land().SerializeAsString());
}

// The wind that a moving target feels is its own.
TEST(LandHeat, TheLandIsAtRest) {
  const auto kelvin_of = [](const std::string& text) {
    const auto land = heated_land_of(text);
    EXPECT_TRUE(land.ok()) << land.status();
    const auto heat = compute_heat(land->sweep, land->assets, 0);
    EXPECT_TRUE(heat.ok()) << heat.status();
    schema::HeatField field;
    EXPECT_TRUE(field.ParseFromString(heat->field()));
    return field.land().kelvin();
  };
  EXPECT_EQ(kelvin_of(kHeatedLand),
            kelvin_of(absl::StrReplaceAll(
                kHeatedLand, {{"heading_deg = 90\n", "heading_deg = 90\nspeed_m_s = 10\n"}})));
}

// Rationale: the target turns, the land does not. Expected: the same temperatures, to rounding.
TEST(LandHeat, TheLandDoesNotTurnWithTheTarget) {
  const auto kelvin_of = [](const std::string& text) {
    std::vector<float> out;
    const auto land = heated_land_of(text);
    EXPECT_TRUE(land.ok()) << land.status();
    const auto heat = compute_heat(land->sweep, land->assets, 0);
    EXPECT_TRUE(heat.ok()) << heat.status();
    schema::HeatField field;
    EXPECT_TRUE(field.ParseFromString(heat->field()));
    out.resize(field.land().kelvin().size() / sizeof(float));
    std::memcpy(out.data(), field.land().kelvin().data(), out.size() * sizeof(float));
    return out;
  };
  const std::vector<float> east = kelvin_of(kHeatedLand),
                           south = kelvin_of(absl::StrReplaceAll(
                               kHeatedLand, {{"heading_deg = 90\n", "heading_deg = 180\n"}}));
  ASSERT_EQ(east.size(), south.size());
  for (std::size_t i = 0; i < east.size(); ++i) EXPECT_NEAR(east[i], south[i], 0.005) << i;
}

// Kinds as a heat job might make them, of the sweep above.
LandKinds some_kinds(const schema::Sweep& sweep) {
  LandKinds out;
  out.materials = 2;
  out.computed = land_computed(sweep);
  out.on_objects = land_on_objects(sweep);
  out.horizon.resize(3);
  out.horizon[1].elevation_rad[5] = 0.25F;
  out.horizon[2].lid_low_rad[3] = 0.5F;
  out.horizon[2].lid_high_rad[3] = 0.75F;
  out.stand_in = {0, 1, 1, 0, 0, 2};
  out.square.push_back({10, 2, {0, 1, 2, 0}});
  out.square.push_back({20, 3, {0, 1, 2, 0, 1, 2, 0, 1, 2}});
  out.index_kinds();
  return out;
}

LandHeatResult some_temperatures(const LandKinds& kinds) {
  LandHeatResult out;
  for (int t = 0; t < 2; ++t) {
    out.kelvin.emplace_back(kinds.kind.size(), 280.5F + static_cast<float>(t));
    out.error_k.emplace_back(kinds.kind.size(), 0.25F + 0.25F * static_cast<float>(t));
    out.interpolation_k.push_back({0.125F, std::numeric_limits<float>::quiet_NaN()});
  }
  return out;
}

TEST(LandHeat, OutputsAreReadAsTheyWereWritten) {
  const auto land = heated_land_of();
  ASSERT_TRUE(land.ok()) << land.status();
  const schema::Sweep& sweep = land->sweep.sweep();
  const LandKinds kinds = some_kinds(sweep);
  const auto read =
      land_heat_from_message(land_heat_to_message(kinds, some_temperatures(kinds)), sweep, 2);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->kinds.materials, 2U);
  EXPECT_EQ(read->kinds.computed, kinds.computed);
  EXPECT_EQ(read->kinds.on_objects, kinds.on_objects);
  ASSERT_EQ(read->kinds.horizon.size(), 3U);
  for (std::size_t h = 0; h < 3; ++h)
    for (const auto array :
         {&LandHorizon::elevation_rad, &LandHorizon::lid_low_rad, &LandHorizon::lid_high_rad})
      EXPECT_EQ(read->kinds.horizon[h].*array, kinds.horizon[h].*array);
  EXPECT_EQ(read->kinds.stand_in, kinds.stand_in);
  ASSERT_EQ(read->kinds.square.size(), 2U);
  EXPECT_EQ(read->kinds.square[1].cell_m, 20);
  EXPECT_EQ(read->kinds.square[1].cells, 3U);
  EXPECT_EQ(read->kinds.square[1].horizon, kinds.square[1].horizon);
  EXPECT_EQ(read->kinds.kind.size(), kinds.kind.size());
  EXPECT_EQ(read->by_time.kelvin, some_temperatures(kinds).kelvin);
  EXPECT_EQ(read->by_time.error_k, some_temperatures(kinds).error_k);
  EXPECT_EQ(read->by_time.interpolation_k[1][0], 0.125F);
  EXPECT_TRUE(std::isnan(read->by_time.interpolation_k[1][1]));
}

TEST(LandHeat, DamagedOutputsAreRefused) {
  const auto land = heated_land_of();
  ASSERT_TRUE(land.ok()) << land.status();
  const schema::Sweep& sweep = land->sweep.sweep();
  const LandKinds kinds = some_kinds(sweep);
  const schema::LandHeat good = land_heat_to_message(kinds, some_temperatures(kinds));
  const auto put = [](std::string& bytes, std::size_t at, float value) {
    std::memcpy(bytes.data() + sizeof value * at, &value, sizeof value);
  };
  using Damage = std::function<void(schema::LandHeat&)>;
  const std::pair<const char*, Damage> damages[] = {
      {"other materials", [](auto& h) { h.mutable_kinds()->set_materials(1); }},
      {"other materials", [](auto& h) { h.mutable_kinds()->set_materials(0xFFFFFFFFU); }},
      {"other materials", [](auto& h) { h.mutable_kinds()->mutable_computed()->RemoveLast(); }},
      {"other materials", [](auto& h) { h.mutable_kinds()->set_computed(1, false); }},
      {"other materials", [](auto& h) { h.mutable_kinds()->add_on_objects(true); }},
      {"other materials", [](auto& h) { h.mutable_kinds()->set_on_objects(0, true); }},
      {"horizons have 0 bytes", [](auto& h) { h.mutable_kinds()->clear_horizon_rad(); }},
      {"horizons have 1151 bytes",
       [](auto& h) { h.mutable_kinds()->mutable_horizon_rad()->pop_back(); }},
      {"horizons have 98688 bytes",
       [](auto& h) { h.mutable_kinds()->mutable_horizon_rad()->assign(257UL * 384, '\0'); }},
      {"a horizon is at nan rad",
       [&](auto& h) { put(*h.mutable_kinds()->mutable_horizon_rad(), 7, NAN); }},
      {"a horizon is at 2 rad",
       [&](auto& h) { put(*h.mutable_kinds()->mutable_horizon_rad(), 95, 2); }},
      {"a horizon is at -2 rad",
       [&](auto& h) { put(*h.mutable_kinds()->mutable_horizon_rad(), 287, -2); }},
      {"stand-ins have 5 bytes",
       [](auto& h) { h.mutable_kinds()->mutable_stand_in()->pop_back(); }},
      {"stand-in has no kinds",
       [](auto& h) { h.mutable_kinds()->mutable_stand_in()->front() = 3; }},
      {"stand-in has no kinds",  // 2 stands for 0, and 1 for 2
       [](auto& h) { h.mutable_kinds()->mutable_stand_in()->front() = 2; }},
      {"a square of 0 cells",
       [](auto& h) {
         h.mutable_kinds()->mutable_square(0)->set_cells(0);
         h.mutable_kinds()->mutable_square(0)->clear_horizon();
       }},
      {"a square of 65536 cells",  // whose square is 0 in 32 bits
       [](auto& h) {
         h.mutable_kinds()->mutable_square(0)->set_cells(65536);
         h.mutable_kinds()->mutable_square(0)->clear_horizon();
       }},
      {"a square of 3 cells", [](auto& h) { h.mutable_kinds()->mutable_square(0)->set_cells(3); }},
      {"of 0 m", [](auto& h) { h.mutable_kinds()->mutable_square(1)->set_cell_m(0); }},
      {"of nan m", [](auto& h) { h.mutable_kinds()->mutable_square(1)->set_cell_m(NAN); }},
      {"of inf m", [](auto& h) { h.mutable_kinds()->mutable_square(1)->set_cell_m(INFINITY); }},
      {"a cell has a horizon of more than 3",
       [](auto& h) { h.mutable_kinds()->mutable_square(1)->mutable_horizon()->back() = 3; }},
      {"a cell has a horizon of more than 3",
       [](auto& h) { h.mutable_kinds()->mutable_square(0)->mutable_horizon()->front() = '\xff'; }},
      {"there are 65 squares",
       [](auto& h) {
         while (h.kinds().square_size() < 65)
           *h.mutable_kinds()->add_square() = schema::LandSquare(h.kinds().square(0));
       }},
      {"kelvin has", [](auto& h) { h.mutable_kelvin()->pop_back(); }},
      {"kelvin has", [](auto& h) { h.clear_kelvin(); }},
      {"error_k has", [](auto& h) { h.mutable_error_k()->append("1234"); }},
      {"interpolation_k has", [](auto& h) { h.clear_interpolation_k(); }},
      {"kelvin has the value nan", [&](auto& h) { put(*h.mutable_kelvin(), 3, NAN); }},
      {"kelvin has the value 0", [&](auto& h) { put(*h.mutable_kelvin(), 3, 0); }},
      {"kelvin has the value inf", [&](auto& h) { put(*h.mutable_kelvin(), 3, INFINITY); }},
      {"error_k has the value -1", [&](auto& h) { put(*h.mutable_error_k(), 0, -1); }},
      {"error_k has the value nan", [&](auto& h) { put(*h.mutable_error_k(), 0, NAN); }},
      {"interpolation_k has the value -1",
       [&](auto& h) { put(*h.mutable_interpolation_k(), 0, -1); }},
  };
  ASSERT_TRUE(land_heat_from_message(good, sweep, 2).ok());
  for (const auto& [why, damage] : damages) {
    schema::LandHeat bad = good;
    damage(bad);
    const absl::Status status = land_heat_from_message(bad, sweep, 2).status();
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status << ", expected " << why;
    EXPECT_THAT(std::string(status.message()), HasSubstr(why));
  }
  EXPECT_FALSE(land_heat_from_message(good, sweep, 3).ok());
}

TEST(LandHeat, RunsOfASweepHaveTheSameKinds) {
  const auto land = heated_land_of();
  ASSERT_TRUE(land.ok()) << land.status();
  const schema::ResolvedSweep& sweep = land->sweep;
  const auto output = [&](int run, const LandKinds& kinds) {
    schema::HeatField field;
    for (const std::string& time : sweep.heat(run).time_utc())
      field.add_unix_s(unix_seconds(*parse_rfc3339(time)));
    *field.mutable_land() = land_heat_to_message(kinds, some_temperatures(kinds));
    return field.SerializeAsString();
  };
  const LandKinds kinds = some_kinds(sweep.sweep());
  const auto good = land_temperatures_from_sweep(sweep, {output(0, kinds), output(1, kinds)});
  ASSERT_TRUE(good.ok()) << good.status();
  EXPECT_EQ(good->kelvin[3].front(), 281.5);
  EXPECT_EQ(good->error_k[1].front(), 0.5);
  // A condition that states temperatures has them by material.
  schema::ResolvedSweep stated = sweep;
  schema::Condition& c = *stated.mutable_condition(3);
  c.clear_land_heat();
  c.clear_land_temperature_k();
  for (std::uint32_t m = 0; m < kinds.materials; ++m) c.add_land_temperature_k(281 + m);
  const auto mixed = land_temperatures_from_sweep(stated, {output(0, kinds), output(1, kinds)});
  ASSERT_TRUE(mixed.ok()) << mixed.status();
  for (std::size_t k = 0; k < kinds.kind.size(); ++k) {
    EXPECT_EQ(mixed->kelvin[3][k], 281 + kinds.kind[k].material);
    EXPECT_EQ(mixed->error_k[3][k], 0);
  }
  LandKinds other = kinds;
  other.square[0].horizon[3] = 1;
  const absl::Status status =
      land_temperatures_from_sweep(sweep, {output(0, kinds), output(1, other)}).status();
  EXPECT_TRUE(absl::IsInternal(status)) << status;
  const absl::Status early =
      land_temperatures_from_sweep(sweep, {output(1, kinds), output(1, kinds)}).status();
  EXPECT_THAT(std::string(early.message()), HasSubstr("there are none at 2025-06-21T06:00:00Z"));
  EXPECT_FALSE(land_temperatures_from_sweep(sweep, {output(0, kinds), ""}).ok());
  EXPECT_EQ(land_temperatures_from_sweep(sweep, {}).value().kinds, nullptr);
}

}  // namespace
}  // namespace irsig
