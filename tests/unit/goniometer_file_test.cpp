// The goniometer's file: what it means, and that every mistake in it has a place.
#include "jobs/goniometer_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "jobs/files/material_files.h"

namespace irsig {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const char* const kGood = R"(name = "test"
[particles]
width_m = 0.02
coverage = [0.5]
size = [{diameter_m = 0.001}]
[[material]]
name = "soil"
kind = "lambert"
emissivity = 0.6
[[part]]
name = "soil"
match = ["grain_*"]
material = "soil"
[[part]]
name = "plate"
material = "soil"
[[band]]
name = "green"
center_um = 0.55
fwhm_um = 0.04
[source]
zenith_deg = [0, 30]
[sensor]
field_width_m = 0.01
[view]
zenith_max_deg = 80
zenith_step_deg = 40
azimuth_step_deg = 90
[accuracy]
samples_per_replicate = 64
)";

absl::StatusOr<ResolvedGoniometer> resolved(const std::string& text) {
  auto file = parse_goniometer(text, "g.toml");
  if (!file.ok()) return file.status();
  return resolve_goniometer(*file, "");
}

std::string with(const std::string& from, const std::string& to) {
  std::string text = kGood;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(GoniometerFile, DefaultsAndAnglesAreWrittenOut) {
  const auto r = resolved(kGood);
  ASSERT_TRUE(r.ok()) << r.status();
  EXPECT_THAT(r->spec.view().zenith_deg(), ElementsAre(0, 40, 80));
  EXPECT_THAT(r->spec.view().azimuth_deg(), ElementsAre(0, 90, 180, 270));
  EXPECT_EQ(r->spec.sensor().field(), "on_plate");
  EXPECT_EQ(r->spec.sensor().field_height_m(), 0.01);
  EXPECT_EQ(r->spec.accuracy().replicates(), 32u);
  EXPECT_EQ(r->spec.accuracy().max_reflections(), 16u);
  EXPECT_EQ(r->spec.particles().tiles(), 1u);
  EXPECT_EQ(r->scene.sweep().band_size(), 1);
}

// Rationale: a band's shape is data; "FWHM" must be the full width, not sigma or the half width.
// Expected: 1 at the centre, 1/2 at half the width to either side, exactly on the table's points.
// Source: definition of the full width at half maximum.
TEST(GoniometerFile, AGaussianBandHasItsFullWidthAtHalfMaximum) {
  const auto r = resolved(kGood);
  ASSERT_TRUE(r.ok()) << r.status();
  const schema::Band& band = r->scene.sweep().band(0);
  EXPECT_NEAR(band.lambda_min_um(), 0.49, 1e-12);
  EXPECT_NEAR(band.lambda_max_um(), 0.61, 1e-12);
  int found = 0;
  for (const schema::SpectralPoint& p : band.response())
    for (const auto& [lambda_um, value] :
         {std::pair{0.55, 1.0}, std::pair{0.53, 0.5}, std::pair{0.57, 0.5}})
      if (std::abs(p.lambda_um() - lambda_um) < 1e-9) {
        EXPECT_NEAR(p.value(), value, 1e-9);
        ++found;
      }
  EXPECT_EQ(found, 3);
}

TEST(GoniometerFile, MistakesHaveTheirPlace) {
  const auto wrong = [](const std::string& from, const std::string& to, const std::string& error) {
    const auto r = resolved(with(from, to));
    ASSERT_FALSE(r.ok()) << to;
    EXPECT_THAT(std::string(r.status().message()), HasSubstr(error)) << to;
  };
  wrong("width_m = 0.02\n", "widht_m = 0.02\n", "g.toml:3:1: unknown key \"widht_m\" in particles");
  wrong("zenith_deg = [0, 30]", "zenith_deg = [0, 95]", "g.toml:22:18: source.zenith_deg[1] = 95");
  wrong("coverage = [0.5]", "coverage = [1.5]", "g.toml:4:13: particles.coverage[0] = 1.5");
  wrong("coverage = [0.5]", "coverage = [0.5]\nlayers = 2", "expected only one of them");
  wrong("fwhm_um = 0.04", "fwhm_um = 0", "g.toml:20:1: band[0].fwhm_um");
  wrong("emissivity = 0.6", "emissivity = 1.6", "g.toml:9:1: material[0].emissivity");
  wrong("material = \"soil\"\n[[band]]", "material = \"sol\"\n[[band]]", "part[1].material");
  wrong("[particles]", "[model]\nfile = \"a.obj\"\n[particles]", "only one of them");
  wrong("match = [\"grain_*\"]", "match = [\"grain_*\"]\ntemperature_k = 300",
        "part[0].temperature_k does not apply to a goniometer");
  wrong("field_width_m = 0.01", "field_width_m = \"wide\"", "g.toml:24:");
  wrong("samples_per_replicate = 64\n", "", "accuracy.samples_per_replicate is missing");
}

// Everything that is wrong is said at once.
TEST(GoniometerFile, AllMistakesAtOnce) {
  const auto r = resolved("[particles]\n[sensor]\n[view]\n");
  ASSERT_FALSE(r.ok());
  for (const char* part : {"name is missing", "particles.size", "particles.width_m", "[[band]]",
                           "source.zenith_deg", "sensor.field_width_m", "view.zenith_max_deg",
                           "view.azimuth_step_deg", "accuracy.samples_per_replicate"})
    EXPECT_THAT(std::string(r.status().message()), HasSubstr(part));
}

void collect_keys(const google::protobuf::Descriptor& table, std::vector<std::string>& keys) {
  for (int i = 0; i < table.field_count(); ++i) {
    const google::protobuf::FieldDescriptor& field = *table.field(i);
    keys.push_back(field.name());
    // The pages of the sweep file explain keys that it has, too.
    if (field.message_type() != nullptr && field.message_type()->file() == table.file())
      collect_keys(*field.message_type(), keys);
  }
}

TEST(GoniometerFile, EveryKeyIsExplained) {
  std::ifstream in(IRSIG_SOURCE_DIR "/docs/reference/goniometer.md");
  const std::string page{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  std::vector<std::string> keys;
  collect_keys(*schema::Goniometer::descriptor(), keys);
  EXPECT_GT(keys.size(), 40u);
  for (const std::string& key : keys) EXPECT_THAT(page, HasSubstr(key));
}

TEST(GoniometerFile, TheExamplesResolve) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(IRSIG_SOURCE_DIR "/jobs/examples")) {
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() != ".toml" || !stem.starts_with("goniometer_")) continue;
    std::ifstream in(entry.path());
    const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    auto file = parse_goniometer(text, stem);
    ASSERT_TRUE(file.ok()) << file.status();
    const auto r = resolve_goniometer(*file, "");
    ASSERT_TRUE(r.ok()) << r.status();
    EXPECT_EQ(r->spec.name(), stem);
    ++count;
  }
  EXPECT_EQ(count, 2);
}

}  // namespace
}  // namespace irsig
