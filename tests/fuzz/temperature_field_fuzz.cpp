// Mutated files of temperatures, the same ones in every run: the reader must refuse them by the
// file's name or return temperatures that a facet can have, whatever stands in the file. Run it
// with IRSIG_SANITIZE=address,undefined to see more.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/fields/temperature_field.h"
#include "tests/fuzz/mutator.h"
#include "tests/fuzz/turns.h"

namespace irsig {
namespace {

constexpr const char* kWords[] = {
    "nan",     "1e999",    "-1",   ",",     "4294967295", "\r\n",   "#", "inf",  "2\n",   "end",
    "element", "property", "list", "float", "uchar",      "vertex", "x", "time", "error", "1e-300"};

const FieldMesh& square() {
  static const FieldMesh mesh{
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, 1};
  return mesh;
}

bool accepted(const std::string& bytes, const std::string& name, FieldMatch match) {
  const auto field =
      read_temperature_field(bytes, {name, TemperatureUnit::kKelvin, match, 0.3, 1.0}, square());
  if (!field.ok()) {
    EXPECT_EQ(field.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_EQ(std::string(field.status().message()).substr(0, name.size()), name) << field.status();
    return false;
  }
  EXPECT_EQ(field->unix_s.size(), field->at.size());
  for (std::size_t t = 0; t < field->at.size(); ++t) {
    const FacetTemperatures& at = field->at[t];
    EXPECT_EQ(at.kelvin.size(), square().triangle.size());
    for (std::size_t f = 0; f < at.kelvin.size(); ++f) {
      EXPECT_EQ(std::isnan(at.kelvin[f]), std::isnan(at.error_k[f]));
      if (std::isnan(at.kelvin[f])) continue;
      EXPECT_GE(at.kelvin[f], kColdestFieldK * 0.999F);
      EXPECT_LE(at.kelvin[f], kHottestFieldK * 1.001F);
      EXPECT_GE(at.error_k[f], 0);
    }
    EXPECT_TRUE(at_time(*field, field->unix_s[t]).ok());
  }
  return true;
}

void mutate_many(const std::string& text, const std::string& name, std::uint64_t seed,
                 double share = 1) {
  fuzz::Mutator mutator(seed, kWords, 200);
  int sound = 0;
  fuzz::Turns turn(4000, share);
  while (turn.next())
    sound += accepted(mutator.mutate(text), name,
                      turn.index() % 2 == 0 ? FieldMatch::kIndex : FieldMatch::kCentroid)
                 ? 1
                 : 0;
  EXPECT_GT(sound, turn.done() / 100) << name;
  EXPECT_LT(sound, turn.done()) << name;
}

TEST(TemperatureFieldFuzz, Csv) {
  mutate_many(
      "# of a camera\nfacet,x,y,z,temperature,error,time\n"
      "0,0.67,0.33,0,300,0.5,2025-06-21T12:00:00Z\n1,0.33,0.67,0,301.5,1,2025-06-21T12:00:00Z\n"
      "0,0.67,0.33,0,302,0.5,2025-06-21T13:00:00Z\n1,0.33,0.67,0,303.5,1,2025-06-21T13:00:00Z\n",
      "t.csv", 5);
}

TEST(TemperatureFieldFuzz, Ply) {
  const std::string header =
      " 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "property float temperature\nelement face 2\nproperty list uchar int vertex_indices\n"
      "end_header\n";
  mutate_many("ply\nformat ascii" + header +
                  "0 0 0 300\n1 0 0 310\n1 1 0 305\n0 1 0 300\n3 0 1 2\n3 0 2 3\n",
              "t.ply", 6, 0.5);
  std::string binary = "ply\nformat binary_little_endian" + header;
  const auto put = [&](auto value) {
    binary.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const float x :
       {0.F, 0.F, 0.F, 300.F, 1.F, 0.F, 0.F, 310.F, 1.F, 1.F, 0.F, 305.F, 0.F, 1.F, 0.F, 300.F})
    put(x);
  for (const int corner : {0, 0}) {
    put(static_cast<unsigned char>(3));
    for (const int c : {0, 1 + corner, 2 + corner}) put(c);
  }
  mutate_many(binary, "t.ply", 7, 0.5);
}

}  // namespace
}  // namespace irsig
