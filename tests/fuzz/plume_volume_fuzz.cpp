// Damaged VDB files, and damaged answers of the process that reads them: refused by the file's
// name, or a plume whose numbers are some, whatever stands there.
#include <gtest/gtest.h>

#include <cmath>

#include "core/plume/plume_field.h"
#include "core/plume/voxel_volume.h"
#include "tests/fuzz/mutator.h"
#include "tests/fuzz/turns.h"
#include "tests/unit/vdb_files.h"

namespace irsig {
namespace {

constexpr const char* kWords[] = {"\xff\xff\xff\xff", "Tree_float_5_4_3", "UniformScaleMap",
                                  "\x7f\x80\x00\x00", "co2"};

// Each of these starts a process: 60 ms. OpenVDB crashes with some of them.
TEST(PlumeVolumeFuzz, VdbFiles) {
  PlumeGrids grids;
  grids.temperature = {"temperature", std::nullopt, "K"};
  grids.pressure = {"", 101325.0, "Pa"};
  grids.co2 = {"co2", std::nullopt, "1"};
  grids.h2o = grids.co = grids.soot = {"", 0.0, "1"};
  const std::string whole =
      vdb_file({{.name = "temperature", .value = 650}, {.name = "co2", .value = 0.1}});
  ASSERT_TRUE(import_plume(whole, "a.vdb", grids).ok());
  fuzz::Mutator mutator(1, kWords);
  int accepted = 0;
  fuzz::Turns turn(50);
  while (turn.next()) {
    const auto field = import_plume(mutator.mutate(whole), "a.vdb", grids);
    if (!field.ok()) {
      ASSERT_EQ(field.status().code(), absl::StatusCode::kInvalidArgument) << field.status();
      ASSERT_EQ(field.status().message().find("a.vdb: "), 0U) << field.status();
      continue;
    }
    ++accepted;
    const PlumeReport& report = (*field)->report();
    ASSERT_TRUE(report.least_k > 0 && report.least_k <= report.most_k);
    for (const double amount : report.amount) ASSERT_TRUE(std::isfinite(amount) && amount >= 0);
  }
  EXPECT_GT(accepted, 0);
  EXPECT_LT(accepted, turn.done());
}

TEST(PlumeVolumeFuzz, AnswersOfTheOtherProcess) {
  VoxelVolume volume;
  volume.world_from_index = {0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0};
  volume.channel = {"temperature", "co2"};
  volume.background = {0, 0};
  VolumeWriter writer(volume);
  VoxelMask some{};
  some[0] = 0b1011;
  writer.add({0, 0, 0}, {some, some}, std::vector<float>(1024, 300));
  writer.add_uniform({8, 0, 0}, {650, 0.1F});
  const std::string whole = encode_volume(volume);
  ASSERT_TRUE(decode_volume(whole).ok());
  fuzz::Mutator mutator(2, kWords);
  int accepted = 0;
  fuzz::Turns turn(20000);
  while (turn.next()) {
    const auto read = decode_volume(mutator.mutate(whole));
    if (!read.ok()) continue;
    ++accepted;
    const std::size_t channels = read->channel.size(), blocks = read->block.size();
    ASSERT_EQ(read->background.size(), channels);
    ASSERT_EQ(read->mask.size(), blocks * channels);
    std::size_t values = 0;
    for (std::size_t b = 0; b < blocks; ++b)
      values += channels * stored_voxels(read->block[b].form, held_by_any(*read, b));
    ASSERT_EQ(read->value.size(), values);
  }
  EXPECT_GT(accepted, turn.done() / 50);
  EXPECT_LT(accepted, turn.done());
}

}  // namespace
}  // namespace irsig
