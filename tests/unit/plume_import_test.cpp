// VDB files of others: what is wrong with them is said with the grid's name, and nothing takes the
// reading process with it.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "core/plume/march.h"
#include "core/plume/plume_field.h"
#include "core/plume/vdb_subprocess.h"
#include "tests/unit/vdb_files.h"

namespace irsig {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

PlumeGrids two_grids() {
  PlumeGrids out;
  out.temperature = {"temperature", std::nullopt, "K"};
  out.pressure = {"", 101325.0, "Pa"};
  out.co2 = {"co2", std::nullopt, "1"};
  out.h2o = {"", 0.05, "1"};
  out.co = {"", 0.0, "1"};
  out.soot = {"", 0.0, "1"};
  return out;
}
VdbGrid warm() { return {.name = "temperature", .value = 650}; }
VdbGrid co2() { return {.name = "co2", .value = 0.1}; }

std::string refusal(const std::string& file, const PlumeGrids& grids = two_grids()) {
  const auto field = import_plume(file, "a.vdb", grids);
  EXPECT_EQ(field.status().code(), absl::StatusCode::kInvalidArgument) << field.status();
  return std::string(field.status().message());
}
std::string refusal(const VdbGrid& a, const VdbGrid& b) { return refusal(vdb_file({a, b})); }
VdbGrid changed(VdbGrid grid, const std::function<void(VdbGrid&)>& change) {
  change(grid);
  return grid;
}

double centre_amount(const PlumeField& field) {
  double sum = 0;
  for (const GasSegment& s : march(field, {{-10, -0.75, -0.75}, {1, 0, 0}, 0, 100}, {}))
    sum += s.amount[0];
  return sum;
}

TEST(PlumeImport, AsItIsMeant) {
  for (const bool stream : {false, true}) {
    const auto field =
        import_plume(vdb_file({co2(), warm(), {.name = "other", .type = "vector"}}, stream),
                     "a.vdb", two_grids());
    ASSERT_TRUE(field.ok()) << field.status();
    EXPECT_EQ((*field)->report().gas_voxels, 64U);
    EXPECT_NEAR((*field)->report().most_k, 650, 1e-4);
    // 2 m of 0.1 at 650 K: x p / (R T).
    const double expected = 2 * 0.1 * 101325 / (8.31446261815324 * 650);
    EXPECT_NEAR(centre_amount(**field), expected, 1e-6 * expected);
    EXPECT_NEAR((*field)->report().amount[0], expected * 4, 1e-5 * expected);
    EXPECT_NEAR((*field)->report().amount[1], expected * 2, 1e-5 * expected);
  }
}

TEST(PlumeImport, UnitsAxesAndPlace) {
  PlumeGrids grids = two_grids();
  grids.temperature.unit = "degC";
  grids.co2.unit = "percent";
  grids.pressure = {"", 1.0, "atm"};
  grids.unit_m = 0.1;
  grids.forward_axis = "-y";
  grids.position_m = {100, 0, -5};
  const auto file = vdb_file({changed(warm(), [](VdbGrid& g) { g.value = 376.85; }),
                              changed(co2(), [](VdbGrid& g) { g.value = 10; })});
  const auto field = import_plume(file, "a.vdb", grids);
  ASSERT_TRUE(field.ok()) << field.status();
  EXPECT_NEAR((*field)->report().most_k, 650, 1e-3);
  // File y is backwards, so that file x is port; up is up.
  const Vec<Body> at = (*field)->body_from_index({2, 3, 1});
  EXPECT_NEAR(at.x, 100 - 0.15, 1e-12);
  EXPECT_NEAR(at.y, -0.1, 1e-12);
  EXPECT_NEAR(at.z, -5.05, 1e-12);
}

// OpenVDB reads it, and prints a warning where the answer is expected.
TEST(PlumeImport, AFileOfANewerVersion) {
  std::string file = vdb_file({warm(), co2()});
  ASSERT_EQ(file[8], '\xe0') << "version 224";
  file[8] = '\xe1';
  const auto field = import_plume(file, "a.vdb", two_grids());
  ASSERT_TRUE(field.ok()) << field.status();
  EXPECT_EQ((*field)->report().gas_voxels, 64U);
}

TEST(PlumeImport, GridsThatAreNone) {
  EXPECT_THAT(refusal(vdb_file({warm()})),
              AllOf(HasSubstr("a.vdb: no grid \"co2\""), HasSubstr("\"temperature\" (float)")));
  EXPECT_THAT(refusal(vdb_file({warm(), changed(co2(), [](VdbGrid& g) { g.name = ""; })})),
              AllOf(HasSubstr("no grid \"co2\""), HasSubstr("(without a name) (float)")));
  EXPECT_THAT(refusal(vdb_file({warm(), co2(), co2()})),
              HasSubstr("grid \"co2\" is there 2 times"));
  for (const char* type : {"double", "vector", "bool"})
    EXPECT_THAT(refusal(warm(), changed(co2(), [&](VdbGrid& g) { g.type = type; })),
                AllOf(HasSubstr("grid \"co2\" is of "), HasSubstr("expected float")))
        << type;
  for (const char* kind : {"level set", "staggered"})
    EXPECT_THAT(refusal(changed(warm(), [&](VdbGrid& g) { g.kind = kind; }), co2()),
                HasSubstr("grid \"temperature\" is a "))
        << kind;
  EXPECT_THAT(refusal(warm(), changed(co2(), [](VdbGrid& g) { g.size = 0; })),
              HasSubstr("grid \"co2\" is empty"));
  EXPECT_THAT(refusal(vdb_file({})), HasSubstr("the file has no grids"));
  EXPECT_THAT(refusal(""), HasSubstr("a.vdb: "));
  EXPECT_THAT(refusal("solid no volume at all"), HasSubstr("no VDB file that can be read"));
}

TEST(PlumeImport, Transforms) {
  const auto both = [](const char* transform) {
    const auto change = [&](VdbGrid& g) { g.transform = transform; };
    return vdb_file({changed(warm(), change), changed(co2(), change)});
  };
  EXPECT_THAT(refusal(both("frustum")),
              AllOf(HasSubstr("grid \"temperature\": its transform is a NonlinearFrustumMap"),
                    HasSubstr("expected an affine")));
  for (const char* transform : {"turned", "sheared"}) {
    const auto field = import_plume(both(transform), "a.vdb", two_grids());
    ASSERT_TRUE(field.ok()) << field.status();
    EXPECT_NEAR((*field)->voxel_volume_m3(), 0.125, 1e-9);
  }
  EXPECT_THAT(refusal(warm(), changed(co2(), [](VdbGrid& g) { g.transform = "finer"; })),
              AllOf(HasSubstr("\"temperature\" and \"co2\" lie on different lattices"),
                    HasSubstr("[0.4 0 0;")));
}

TEST(PlumeImport, ValuesThatAreNone) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto odd = [](VdbGrid grid, double value, bool active = true) {
    grid.odd_at = {1, 2, 3};
    grid.odd = value;
    grid.has_odd = true;
    grid.odd_active = active;
    return grid;
  };
  for (const double value : {kNan, kInfinity, -kInfinity}) {
    EXPECT_THAT(refusal(odd(warm(), value), co2()),
                HasSubstr("grid \"temperature\": not finite (1 voxel, the first at (1, 2, 3)"));
    EXPECT_THAT(refusal(warm(), odd(co2(), value)), HasSubstr("grid \"co2\": not finite"));
  }
  EXPECT_THAT(refusal(changed(warm(), [](VdbGrid& g) { g.value = 0.93; }), co2()),
              AllOf(HasSubstr("grid \"temperature\" (temperature): the hottest gas has 0.93"),
                    HasSubstr("expected K or degC")));
  EXPECT_THAT(refusal(odd(warm(), 99.9), co2()),
              HasSubstr("gas colder than 100 K (1 voxel, the first at (1, 2, 3): 99.9 K)"));
  EXPECT_THAT(refusal(odd(warm(), 5001), co2()), HasSubstr("gas hotter than 5000 K"));
  EXPECT_THAT(refusal(warm(), odd(co2(), 1.01)), HasSubstr("grid \"co2\" (co2): outside 0 to 1"));
  EXPECT_THAT(refusal(warm(), odd(co2(), -1e-6)), HasSubstr("outside 0 to 1"));
  EXPECT_THAT(refusal(warm(), odd(co2(), 0.96)), HasSubstr("add up to more than 1"));
  EXPECT_THAT(refusal(odd(warm(), 650, false), co2()),
              HasSubstr("gas without a temperature, where the grid is not active (1 voxel"));
  EXPECT_THAT(
      refusal(warm(), odd(changed(co2(), [](VdbGrid& g) { g.background = 0.04; }), 0, false)),
      HasSubstr("not active where the gas is, and its background is 0.04"));
  // Without any constant species there is no gas in it.
  PlumeGrids dry = two_grids();
  dry.h2o.constant = 0;
  EXPECT_THAT(refusal(vdb_file({warm(), changed(co2(), [](VdbGrid& g) { g.value = 0; })}), dry),
              HasSubstr("no gas: in the 64 active voxels"));
  // Where there is no gas, the temperature may be anything.
  const auto field = import_plume(vdb_file({odd(warm(), 0), odd(co2(), 0)}), "a.vdb", dry);
  ASSERT_TRUE(field.ok()) << field.status();
  EXPECT_EQ((*field)->report().gas_voxels, 63U);
  EXPECT_EQ((*field)->report().warm_without_gas, 1U);
}

TEST(PlumeImport, HalfFloatsAndTiles) {
  const auto half =
      import_plume(vdb_file({changed(warm(), [](VdbGrid& g) { g.type = "half"; }), co2()}), "a.vdb",
                   two_grids());
  ASSERT_TRUE(half.ok()) << half.status();
  EXPECT_NEAR((*half)->report().most_k, 650, 0.5);
  const auto tiles = [](int level) {
    const auto change = [&](VdbGrid& g) { g.tile = level; };
    return vdb_file({changed(warm(), change), changed(co2(), change)});
  };
  for (const int level : {1, 2}) {
    const auto field = import_plume(tiles(level), "a.vdb", two_grids());
    ASSERT_TRUE(field.ok()) << field.status();
    EXPECT_EQ((*field)->report().gas_voxels, level == 1 ? 512U : 128U * 128 * 128);
  }
  EXPECT_THAT(refusal(tiles(3)),
              AllOf(HasSubstr("holds 134217728 blocks"), HasSubstr("is a background active?")));
  // A tile of one, voxels of the other.
  const auto mixed = import_plume(
      vdb_file({changed(warm(), [](VdbGrid& g) { g.tile = 1; }), co2()}), "a.vdb", two_grids());
  ASSERT_TRUE(mixed.ok()) << mixed.status();
  EXPECT_EQ((*mixed)->report().gas_voxels, 512U);  // h2o is a constant of 0.05
}

TEST(PlumeImport, SpecificationsThatAreWrong) {
  const auto wrong = [](const std::function<void(PlumeGrids&)>& change) {
    PlumeGrids grids = two_grids();
    change(grids);
    return refusal("not even opened", grids);
  };
  EXPECT_THAT(wrong([](PlumeGrids& g) {
                g.co = {"", std::nullopt, "1"};
              }),
              HasSubstr("co: neither a grid nor a constant; for none of it, constant 0"));
  EXPECT_THAT(wrong([](PlumeGrids& g) { g.co2.constant = 0.1; }), HasSubstr("co2: both"));
  EXPECT_THAT(wrong([](PlumeGrids& g) { g.co2.unit = "K"; }),
              HasSubstr("co2: unit \"K\", expected 1, percent or ppm"));
  EXPECT_THAT(wrong([](PlumeGrids& g) { g.co2.grid = "temperature"; }),
              HasSubstr("grid \"temperature\" is another quantity already"));
  EXPECT_THAT(wrong([](PlumeGrids& g) { g.h2o.constant = 1.5; }), HasSubstr("h2o: constant 1.5"));
  EXPECT_THAT(wrong([](PlumeGrids& g) { g.pressure.constant = 1; }),
              HasSubstr("pressure: constant 1"));
  EXPECT_THAT(wrong([](PlumeGrids& g) { g.up_axis = "+x"; }), HasSubstr("perpendicular"));
  EXPECT_THAT(wrong([](PlumeGrids& g) { g.unit_m = 0; }), HasSubstr("unit_m = 0"));
  EXPECT_THAT(wrong([](PlumeGrids& g) {
                g.co2 = {"", 0.0, "1"};
                g.h2o = {"", 0.0, "1"};
              }),
              HasSubstr("no gas"));
  EXPECT_THAT(wrong([](PlumeGrids& g) {
                g.temperature = {"", 900.0, "K"};
                g.co2 = {"", 0.1, "1"};
              }),
              HasSubstr("no grid: temperature and all species are constants, so that nothing says "
                        "where the gas is"));
}

// Every byte of a file may be wrong: an error or a field, never an end of this process; and the
// other one is never told to be at fault for what a file did.
TEST(PlumeImport, DamagedFiles) {
  const std::string file = vdb_file({warm(), co2()});
  int refused = 0;
  for (std::size_t n = 0; n < 60; ++n) {
    std::string damaged = file;
    if (n < 20) {
      damaged.resize(file.size() * n / 20);
    } else {
      for (std::size_t i = 0; i < 4; ++i)
        damaged[(n * 2654435761U + i * 40503U) % damaged.size()] ^= static_cast<char>(1 << (n % 8));
    }
    const auto field = import_plume(damaged, "a.vdb", two_grids());
    if (!field.ok()) {
      EXPECT_EQ(field.status().code(), absl::StatusCode::kInvalidArgument) << field.status();
      ++refused;
    }
  }
  EXPECT_GT(refused, 20);
}

TEST(PlumeImport, WrittenAndReadAgain) {
  VoxelVolume volume;
  volume.world_from_index = {0.5, 0.1, 0, 3, 0, 0.25, 0, -2, 0, 0, 1, 7};
  volume.channel = {"temperature", "co2"};
  volume.background = {0, 0};
  VolumeWriter writer(volume);
  writer.add_uniform({-8, 16, 1024}, {700, 0.1F});
  std::vector<float> value(1024);
  VoxelMask some{}, all{};
  for (unsigned v = 0; v < 512; ++v) {
    value[2 * v] = 400.0F + static_cast<float>(v);
    value[2 * v + 1] = 0.05F;
    all[v >> 6] |= std::uint64_t{1} << (v & 63);
    if (v % 7 == 0) some[v >> 6] |= std::uint64_t{1} << (v & 63);
  }
  writer.add({0, 0, 0}, {all, some}, value);
  writer.add({0, 8, 0}, {some, some}, value);
  const auto file = write_vdb_apart(volume);
  ASSERT_TRUE(file.ok()) << file.status();
  const auto read = read_vdb_apart(*file, volume.channel);
  ASSERT_TRUE(read.ok()) << read.status();
  for (std::size_t i = 0; i < 12; ++i)
    EXPECT_NEAR(read->world_from_index[i], volume.world_from_index[i], 1e-12);
  ASSERT_EQ(read->block.size(), 3U);
  EXPECT_EQ(read->value.size(), volume.value.size());
  for (std::size_t b = 0; b < 3; ++b)
    EXPECT_EQ(read->block[b].origin[1], b == 0 ? 16 : b == 1 ? 0 : 8);
  EXPECT_EQ(read->block[0].form, VoxelBlock::Form::kUniform);
  // Blocks come back in their order in space: the first two swapped places with none.
  EXPECT_EQ(read->mask, volume.mask);
  EXPECT_EQ(read->value, volume.value);
}

TEST(PlumeImport, WhatComesBackIsNotTrusted) {
  VoxelVolume volume;
  volume.channel = {"t"};
  volume.background = {0};
  VolumeWriter(volume).add_uniform({0, 0, 0}, {700});
  const std::string good = encode_volume(volume);
  ASSERT_TRUE(decode_volume(good).ok());
  for (std::size_t n = 0; n < good.size(); ++n)
    EXPECT_FALSE(decode_volume(good.substr(0, n)).ok()) << n;
  volume.block[0].origin = {4, 0, 0};
  EXPECT_TRUE(absl::IsDataLoss(decode_volume(encode_volume(volume)).status()));
  volume.block[0].origin = {8, 0, 0};
  volume.value.push_back(1);
  EXPECT_TRUE(absl::IsDataLoss(decode_volume(encode_volume(volume)).status()));
}

}  // namespace
}  // namespace irsig
