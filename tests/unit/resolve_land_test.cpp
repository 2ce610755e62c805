// [land]: what its keys become in a resolved sweep, and what a submitted sweep may not have of it.
// Its errors in sweep files: bad_sweeps/land*.toml.
#include "jobs/resolve_land.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "jobs/check_resolved.h"
#include "jobs/keys/expand.h"
#include "jobs/resolve_sweep.h"
#include "schema/assets.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kLand = R"(time = ["12:00Z"]
[model]
generate = "box"
triangles = 100
[place]
latitude_deg = 48
longitude_deg = 11
heading_deg = 90
[[part]]
name = "box"
material = "grass"
temperature_k = 300
[[season]]
name = "summer"
date = 2025-06-21
land_temperature_k = { asphalt = 310 }
[[season]]
name = "winter"
date = 2025-12-21
land_temperature_k = { asphalt = 275, grass = 272 }
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.5
[viewpoints]
kind = "list"
range_m = 1000
aspect = [ { azimuth_deg = 0, elevation_deg = 20 } ]
[surroundings]
kind = "ground"
ground_temperature_k = 290
ground_emissivity = 0.95
[air]
model = "atmosphere"
aerosol = "none"
[transport]
sun = false
[land]
heights = "maps/h.asc"
epsg = 32632
inset = "maps/N48E011.hgt"
[[land.material]]
material = "asphalt"
fraction_file = "maps/road.TIF"
[[land.material]]
material = "grass"
temperature_k = 288
)";

absl::StatusOr<schema::ResolvedSweep> resolved_land(const std::string& text) {
  auto file = parse_sweep(text, "s.toml");
  if (!file.ok()) return file.status();
  const auto read = [](const std::string& name) -> absl::StatusOr<std::string> {
    return "bytes of " + name;
  };
  if (const absl::Status status = read_land_files(*file, read); !status.ok()) return status;
  EXPECT_EQ(land_bytes(*file).at("land.heights"), "bytes of maps/h.asc");
  return resolve_sweep(*file, "");
}

TEST(ResolveLand, FilesBecomeAssetsAndTemperaturesGoToConditions) {
  const auto sweep = resolved_land(kLand);
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  EXPECT_THAT(sweep->ShortDebugString(), ::testing::Not(HasSubstr("maps/")));
  EXPECT_EQ(sweep->land().heights().sha256(), sha256_hex("bytes of maps/h.asc"));
  EXPECT_EQ(sweep->land().heights().file_name(), "h.asc");
  EXPECT_EQ(sweep->land().inset().file_name(), "N48E011.hgt");
  ASSERT_EQ(sweep->land().fraction_size(), 2);
  EXPECT_EQ(sweep->land().fraction(0).sha256(), sha256_hex("bytes of maps/road.TIF"));
  EXPECT_EQ(sweep->land().fraction(1).sha256(), "");
  EXPECT_EQ(sweep->sweep().land().geoid_m(), 0);
  EXPECT_EQ(sweep->sweep().land().epsg(), 32632U);
  // The part's grass serves the land, too; the library's asphalt is added.
  ASSERT_EQ(sweep->sweep().material_size(), 2);
  EXPECT_EQ(sweep->sweep().material(0).name(), "grass");
  EXPECT_EQ(sweep->sweep().material(1).name(), "asphalt");
  EXPECT_THAT(sweep->condition(0).land_temperature_k(), ElementsAre(310, 288));
  EXPECT_THAT(sweep->condition(1).land_temperature_k(), ElementsAre(275, 272));
  EXPECT_TRUE(check_resolved(*sweep).ok()) << check_resolved(*sweep);
}

TEST(ResolveLand, ColumnsOfAConditionFileStateTemperatures) {
  const std::string text =
      absl::StrReplaceAll(kLand, {{"time = [\"12:00Z\"]\n", "condition_file = \"hours.csv\"\n"},
                                  {"land_temperature_k = { asphalt = 275, grass = 272 }\n", ""}});
  auto file = parse_sweep(text, "s.toml");
  ASSERT_TRUE(file.ok()) << file.status();
  file->content["condition_file"] =
      "season,time,land_temperature_k.asphalt,land_temperature_k.grass\n"
      "summer,06:00Z,,285\nwinter,12:00Z,280,\n";
  const auto sweep = resolve_sweep(*file, "");
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  EXPECT_THAT(sweep->condition(0).land_temperature_k(), ElementsAre(310, 285));
  EXPECT_THAT(sweep->condition(1).land_temperature_k(), ElementsAre(280, 288));
  file->content["condition_file"] = "season,time,land_temperature_k.gras\nwinter,12:00Z,280\n";
  EXPECT_THAT(std::string(resolve_sweep(*file, "").status().message()),
              HasSubstr("hours.csv:2:15: condition[0].land_temperature_k.gras: the land has no "
                        "material \"gras\", did you mean \"grass\"?"));
}

TEST(ResolveLand, FilesThatCannotBeReadAreReportedAtTheirKeys) {
  auto file = parse_sweep(kLand, "s.toml");
  ASSERT_TRUE(file.ok()) << file.status();
  const absl::Status status =
      read_land_files(*file, [](const std::string& name) -> absl::StatusOr<std::string> {
        if (name == "maps/h.asc") return "";
        return absl::NotFoundError("does not exist");
      });
  EXPECT_EQ(std::string(status.message()),
            "s.toml:40:1: land.heights = \"maps/h.asc\": is empty\n"
            "s.toml:42:1: land.inset = \"maps/N48E011.hgt\": does not exist\n"
            "s.toml:45:1: land.material[0].fraction_file = \"maps/road.TIF\": does not exist");
}

constexpr const char* kObjects = R"([[land.material]]
material = "leaves"
objects_only = true
temperature_k = 289
[[land.object]]
model = "models/tree.obj"
unit_m = 1
forward_axis = "+x"
up_axis = "+z"
material = "leaves"
places_file = "maps/trees.csv"
[[land.object]]
model = "models/house.glb"
material = "asphalt"
scale = 2
place = [{ east_m = 50, north_m = -20 }, { east_m = 80, north_m = 0, heading_deg = 45, scale = 3 }]
[[land.object]]
model = "models/tree.obj"
unit_m = 1
forward_axis = "+x"
up_axis = "+z"
material = "leaves"
part = [{ match = "trunk", material = "asphalt" }]
count = 100
within = "grass"
inner_radius_m = 50
radius_m = 500
)";

TEST(ResolveLand, ObjectsAndTheirFilesAreWrittenOut) {
  const auto sweep = resolved_land(absl::StrCat(kLand, kObjects));
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  EXPECT_THAT(sweep->ShortDebugString(), ::testing::Not(HasSubstr("maps/")));
  EXPECT_THAT(sweep->ShortDebugString(), ::testing::Not(HasSubstr("models/")));
  ASSERT_EQ(sweep->land().object_size(), 3);
  EXPECT_EQ(sweep->land().object(0).model().sha256(), sha256_hex("bytes of models/tree.obj"));
  EXPECT_EQ(sweep->land().object(0).places().sha256(), sha256_hex("bytes of maps/trees.csv"));
  EXPECT_EQ(sweep->land().object(0).places().file_name(), "trees.csv");
  EXPECT_FALSE(sweep->land().object(1).has_places());
  const schema::Land& land = sweep->sweep().land();
  EXPECT_EQ(land.object(0).reference(), "bbox_bottom_center");
  EXPECT_EQ(land.object(0).scale(), 1);
  EXPECT_FALSE(land.object(0).has_seed());
  EXPECT_EQ(land.object(1).forward_axis(), "+z");
  EXPECT_EQ(land.object(1).place(0).scale(), 2);
  EXPECT_EQ(land.object(1).place(0).heading_deg(), 0);
  EXPECT_EQ(land.object(1).place(1).scale(), 3);
  EXPECT_EQ(land.object(2).seed(), 1U);
  EXPECT_THAT(sweep->condition(0).land_temperature_k(), ElementsAre(310, 288, 289));
  EXPECT_TRUE(check_resolved(*sweep).ok()) << check_resolved(*sweep);
  // Workers fetch heights, inset, road, tree, places and house.
  EXPECT_EQ(needed_assets(*sweep).size(), 6U);
}

// Rationale: a job's result depends on bytes and temperatures, not on where a map lies.
TEST(ResolveLand, KeysOfJobsFollowWhatDeterminesResults) {
  const auto key_of = [](const std::string& text,
                         const std::function<void(schema::ResolvedSweep&)>& change) {
    auto sweep = resolved_land(text);
    EXPECT_TRUE(sweep.ok()) << sweep.status();
    change(*sweep);
    return expand_jobs(*sweep, 1).at(0).job_key();
  };
  const auto nothing = [](schema::ResolvedSweep&) {};
  const std::string key = key_of(kLand, nothing);
  const auto renamed = [](schema::ResolvedSweep& s) {
    s.mutable_land()->mutable_heights()->set_file_name("other.ASC");
  };
  EXPECT_EQ(key, key_of(kLand, renamed));
  // An equal temperature is stated elsewhere.
  EXPECT_EQ(key, key_of(absl::StrReplaceAll(
                            kLand, {{"{ asphalt = 310 }", "{ asphalt = 310, grass = 288 }"}}),
                        nothing));
  EXPECT_NE(key, key_of(absl::StrReplaceAll(kLand, {{"310", "311"}}), nothing));
  EXPECT_NE(key, key_of(absl::StrReplaceAll(kLand, {{"epsg = 32632", "epsg = 32633"}}), nothing));
  EXPECT_NE(key, key_of(kLand, [](schema::ResolvedSweep& s) {
              s.mutable_land()->mutable_inset()->set_file_name("N47E011.hgt");
            }));
  EXPECT_NE(key, key_of(kLand, [](schema::ResolvedSweep& s) {
              s.mutable_land()->mutable_fraction(0)->set_sha256(sha256_hex("other bytes"));
            }));
  const std::string built = absl::StrCat(kLand, kObjects), built_key = key_of(built, nothing);
  EXPECT_NE(key, built_key);
  EXPECT_EQ(built_key, key_of(built, [](schema::ResolvedSweep& s) {
              s.mutable_land()->mutable_object(0)->mutable_model()->set_file_name("other.OBJ");
              s.mutable_land()->mutable_object(0)->mutable_places()->set_file_name("other.csv");
            }));
  EXPECT_NE(built_key, key_of(built, [](schema::ResolvedSweep& s) {
              s.mutable_land()->mutable_object(0)->mutable_places()->set_sha256(
                  sha256_hex("other bytes"));
            }));
  for (const auto& [from, to] : {std::pair{"north_m = -20", "north_m = -21"},
                                 {"count = 100", "count = 101"},
                                 {"scale = 3", "scale = 4"}})
    EXPECT_NE(built_key, key_of(absl::StrReplaceAll(built, {{from, to}}), nothing)) << to;
}

TEST(ResolveLand, SubmittedSweepsAreChecked) {
  const auto good = resolved_land(kLand);
  ASSERT_TRUE(good.ok()) << good.status();
  const std::pair<const char*, std::function<void(schema::ResolvedSweep&)>> changes[] = {
      {"land is missing with sweep.land", [](auto& s) { s.clear_land(); }},
      {"land does not apply without sweep.land", [](auto& s) { s.mutable_sweep()->clear_land(); }},
      {"condition[1].land_temperature_k has 3 elements for 2 materials",
       [](auto& s) { s.mutable_condition(1)->add_land_temperature_k(300); }},
      {"condition[0].land_temperature_k[0] = nan",
       [](auto& s) { s.mutable_condition(0)->set_land_temperature_k(0, NAN); }},
      {"land.heights.sha256 = \"../x\", expected a SHA-256 in hex",
       [](auto& s) { s.mutable_land()->mutable_heights()->set_sha256("../x"); }},
      {"land.inset.file_name = \"a/b.hgt\", expected a name without folders",
       [](auto& s) { s.mutable_land()->mutable_inset()->set_file_name("a/b.hgt"); }},
      {"land.fraction has 3 elements for 2 materials",
       [](auto& s) { s.mutable_land()->add_fraction(); }},
      {"surroundings.kind = \"sea\" does not go with [land]",
       [](auto& s) { s.mutable_sweep()->mutable_surroundings()->set_kind("sea"); }},
      {"land.material[0].material = \"lava\" is no known material",
       [](auto& s) {
         s.mutable_sweep()->mutable_land()->mutable_material(0)->set_material("lava");
       }},
      {"land.object has files of 1 objects for 0 tables",
       [](auto& s) { s.mutable_land()->add_object(); }},
      {"land.object[0].model.sha256 = \"\", expected a SHA-256 in hex",
       [](auto& s) {
         s.mutable_land()->add_object();
         s.mutable_sweep()->mutable_land()->add_object();
       }},
      {"land.object[0].material = \"lava\" is no [[land.material]]",
       [](auto& s) {
         s.mutable_land()->add_object();
         s.mutable_sweep()->mutable_land()->add_object()->set_material("lava");
       }},
  };
  for (const auto& [named, change] : changes) {
    schema::ResolvedSweep sweep = *good;
    change(sweep);
    EXPECT_THAT(std::string(check_resolved(sweep).message()), HasSubstr(named));
  }
}

}  // namespace
}  // namespace irsig
