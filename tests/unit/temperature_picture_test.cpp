// Rationale: a picture of temperatures is a claim about where on the target which temperature is.
// Expected: seen from a side, the pixels have the temperature of the part that faces it, in the
// proportions of the target's outline. Source: a disk and its normal.
#include "planning/temperature_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <memory>

#include "coordinator/client/scratch_folder.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

// A plate of 4 x 2 m (two facets at the bow, looking ahead; x = 1) before one of 4 x 4 m (x = 0).
constexpr const char* kPlates =
    "o front\nv 1 -2 -1\nv 1 2 -1\nv 1 2 1\nv 1 -2 1\nf 1 2 3\nf 1 3 4\n"
    "o back\nv 0 -2 -2\nv 0 2 -2\nv 0 2 2\nv 0 -2 2\nf 5 6 7\nf 5 7 8\n";
constexpr const char* kSweep = R"(
name = "plates"
time = ["10:00Z", "14:00Z"]
[model]
file = "plates.obj"
unit_m = 1
forward_axis = "+x"
up_axis = "+z"
[[part]]
name = "front"
material = "hull"
two_sided = true
[[part]]
name = "back"
material = "hull"
temperature_k = 280
two_sided = true
[[temperature_field]]
name = "camera"
file = "front.csv"
unit = "K"
match = "index"
error_k = 0.5
[[season]]
name = "day"
date = 2025-06-21
temperature_field = "camera"
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.5
[viewpoints]
kind = "list"
range_m = 1000
aspect = [{ azimuth_deg = 0, elevation_deg = 0 }]
[surroundings]
kind = "none"
sky_radiance_w_m2_sr_um = 0
lower_radiance_w_m2_sr_um = 0
[air]
model = "vacuum"
[transport]
sun = false
[accuracy]
samples_per_replicate = 16
)";

class TemperaturePicture : public ::testing::Test {
 protected:
  void SetUp() override {
    auto folder = ScratchFolder::make();
    ASSERT_TRUE(folder.ok()) << folder.status();
    folder_ = *std::move(folder);
    write("plates.obj", kPlates);
    write("front.csv", "facet,temperature\n0,310\n1,330\n");
    write("sweep.toml", kSweep);
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_->file(name)) << text;
  }
  [[nodiscard]] std::string sweep() const { return folder_->file("sweep.toml"); }
  std::unique_ptr<ScratchFolder> folder_;
};

TEST_F(TemperaturePicture, ShowsWhatFacesTheSensor) {
  const auto facets = SweepFacets::load(sweep(), "");
  ASSERT_TRUE(facets.ok()) << facets.status();
  const auto ahead = draw_temperatures(*facets, 0, {0, 0}, 64);
  ASSERT_TRUE(ahead.ok()) << ahead.status();
  ASSERT_EQ(ahead->width_px, 64U);
  ASSERT_EQ(ahead->height_px, 64U);
  double front = 0, back = 0, none = 0;
  for (const float v : ahead->value) {
    if (std::isnan(v))
      ++none;
    else
      ++(v == 280 ? back : front);
  }
  EXPECT_EQ(none, 0);
  EXPECT_EQ(front, 64 * 32) << "the middle half";
  EXPECT_EQ(back, 64 * 32);
  EXPECT_EQ(ahead->range.low, 280);
  EXPECT_EQ(ahead->range.high, 330);
  // The field's first facet is at the bottom, to port (+y of the file): seen from ahead, port is to
  // the right.
  const auto at = [&](std::size_t x, std::size_t y) { return ahead->value[y * 64 + x]; };
  EXPECT_EQ(at(60, 5), 280);
  EXPECT_EQ(at(60, 46), 310);
  EXPECT_EQ(at(3, 17), 330);
  const auto astern = draw_temperatures(*facets, 0, {180, 0}, 32);
  ASSERT_TRUE(astern.ok()) << astern.status();
  EXPECT_EQ(astern->value[32 * 16 + 16], 280) << "the other plate hides it";
}

TEST_F(TemperaturePicture, HasTheProportionsOfTheOutline) {
  const auto facets = SweepFacets::load(sweep(), "");
  ASSERT_TRUE(facets.ok()) << facets.status();
  // The view is from 60 deg above ahead: heights are halved, and a place 1 m behind is 0.87 m
  // higher up.
  const auto above = draw_temperatures(*facets, 0, {0, 60}, 100);
  ASSERT_TRUE(above.ok()) << above.status();
  EXPECT_EQ(above->width_px, 100U);
  // Top: the back plate's upper edge; bottom: the front plate's or the back's lower edge.
  const double top = 2 * std::cos(std::acos(-1.0) / 3) + 0;
  const double bottom = std::min(-1 * 0.5 - std::sqrt(0.75), -2 * 0.5);
  EXPECT_NEAR(above->height_px, (top - bottom) / 4 * 100, 1);
}

TEST_F(TemperaturePicture, IsOfOneConditionAndAnAspect) {
  Query query{.time = "2025-06-21T10:00:00Z", .aspect = SignatureFilter::Direction{0, 0}};
  EXPECT_TRUE(temperature_picture(sweep(), query, {}, 16).ok());
  const auto scaled = temperature_picture(sweep(), query, ColorRange{250, 350}, 16);
  ASSERT_TRUE(scaled.ok());
  EXPECT_EQ(scaled->range.low, 250);
  query.time = "";
  const auto two = temperature_picture(sweep(), query, {}, 16);
  EXPECT_EQ(two.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(two.status().message()), HasSubstr("day 2025-06-21T14:00:00Z"));
  query.season = "night";
  EXPECT_EQ(temperature_picture(sweep(), query, {}, 16).status().code(),
            absl::StatusCode::kNotFound);
  query = {.time = "2025-06-21T10:00:00Z"};
  EXPECT_THAT(std::string(temperature_picture(sweep(), query, {}, 16).status().message()),
              HasSubstr("needs --aspect"));
  query.aspect = {0, 0};
  query.band = "lwir";
  EXPECT_THAT(std::string(temperature_picture(sweep(), query, {}, 16).status().message()),
              HasSubstr("no other filter"));
}

}  // namespace
}  // namespace irsig
