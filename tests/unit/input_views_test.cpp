// Rationale: what an uncertain input leaves of a row is a difference of two rows on the same paths;
// it must be that of the physics, and nothing of it may leak into the row itself. Expected: closed
// forms of a grey plate in a vacuum; sweeps whose inputs were changed by hand; walls whose balance
// is known. Source: planck_integrals (tests/physics/planck_test.cpp), arithmetic here.
#include "runner/input_views.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "core/spectral/planck_quadrature.h"
#include "jobs/keys/expand.h"
#include "runner/heat_outputs.h"
#include "runner/job_runner.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

constexpr const char* kPlate = R"(
time = ["12:00Z"]
[model]
generate = "disk"
triangles = 64
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.8
[[part]]
name = "disk"
material = "paint"
temperature_k = 300
[[season]]
name = "any"
date = 2025-06-21
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.1
[viewpoints]
kind = "list"
range_m = 1000
aspect = [{ azimuth_deg = 0, elevation_deg = 0 }]
[surroundings]
kind = "none"
sky_temperature_k = 250
lower_radiance_w_m2_sr_um = 0
[air]
model = "vacuum"
[transport]
sun = false
[accuracy]
samples_per_replicate = 512
[output]
thumbnail_px = 0
)";

schema::ResolvedSweep resolved(const std::string& text) {
  auto sweep = resolved_text(text);
  EXPECT_TRUE(sweep.ok()) << sweep.status();
  return sweep.ok() ? *std::move(sweep) : schema::ResolvedSweep();
}

schema::ViewJobResult view_of(const schema::ResolvedSweep& sweep) {
  const auto heat = heat_outputs(sweep, {});
  EXPECT_TRUE(heat.ok()) << heat.status();
  const auto runner = JobRunner::create(sweep, {}, *heat);
  EXPECT_TRUE(runner.ok()) << runner.status();
  if (!runner.ok()) return {};
  const auto result = (*runner)->run(expand_jobs(sweep, physics_version()).back());
  EXPECT_TRUE(result.ok()) << result.status();
  return result.ok() ? result->view() : schema::ViewJobResult();
}

const schema::InputContribution& input(const schema::SignatureRow& row, const std::string& name) {
  for (const schema::InputContribution& i : row.input())
    if (i.input() == name) return i;
  ADD_FAILURE() << "no input " << name;
  static const schema::InputContribution none;
  return none;
}

double gain(const schema::SignatureRow& row, const std::string& name) {
  return input(row, name).contribution_w_sr().value();
}

double plate_w_m2_sr(double kelvin) {
  const PlanckIntegrals b = planck_integrals(8, 12, kelvin);
  return b.radiance_w_m2_sr * std::exp(-b.exponent);
}

// With a sky of 0 K a plate's intensity is A eps B(T): what a sigma more is worth, relative to it,
// needs no area.
TEST(InputViews, OfAGreyPlateAreClosedForms) {
  const std::string dark =
      absl::StrReplaceAll(kPlate, {{"sky_temperature_k = 250", "sky_radiance_w_m2_sr_um = 0"}});
  const auto row = view_of(resolved(dark + "[uncertainty]\npart_temperature_k = 0.5\n"
                                           "emissivity = 0.02\n"))
                       .row(0);
  const double i = row.intensity_w_sr().value();
  EXPECT_NEAR(gain(row, "part_temperature_k") / i, plate_w_m2_sr(300.5) / plate_w_m2_sr(300) - 1,
              1e-6);
  EXPECT_NEAR(gain(row, "emissivity") / i, 0.02 / 0.8, 1e-6);
  EXPECT_NEAR(row.input_uncertainty_w_sr(),
              std::hypot(gain(row, "part_temperature_k"), gain(row, "emissivity")), 1e-9 * i);

  // Both sides give slope and curvature: of B, by differences that are central, too.
  const auto both = view_of(resolved(dark + "[uncertainty]\npart_temperature_k = 5\n"
                                            "sides = \"both\"\n"))
                        .row(0);
  const double up = plate_w_m2_sr(305) / plate_w_m2_sr(300) - 1,
               down = plate_w_m2_sr(295) / plate_w_m2_sr(300) - 1;
  const auto& t = input(both, "part_temperature_k");
  EXPECT_NEAR(t.contribution_w_sr().value() / i, 0.5 * (up - down), 1e-6);
  EXPECT_NEAR(t.curvature_w_sr() / i, 0.5 * (up + down), 1e-6);
  EXPECT_NEAR(both.input_uncertainty_w_sr() / i,
              std::sqrt(0.25 * std::pow(up - down, 2) + 0.5 * std::pow(up + down, 2)), 1e-6);
  EXPECT_NEAR(planck_integrals(8, 12, 300).derivative_w_m2_sr_k *
                  std::exp(-planck_integrals(8, 12, 300).exponent) * 5 / plate_w_m2_sr(300),
              t.contribution_w_sr().value() / i, 1e-3 * t.contribution_w_sr().value() / i);
}

// A plate that reflects half a sky: three independent inputs, noise of the sampled reflection
// alone.
TEST(InputViews, OfThreeInputsAddInSquares) {
  const std::string stated =
      "[uncertainty]\npart_temperature_k = 0.5\nemissivity = 0.02\nsky_temperature_k = 4\n";
  const auto row = view_of(resolved(std::string(kPlate) + stated)).row(0);
  const double area_m2 = row.projected_area_m2().value();
  const auto& sky = input(row, "sky_temperature_k").contribution_w_sr();
  EXPECT_GT(sky.stderr(), 0);
  EXPECT_LT(sky.stderr(), 0.03 * sky.value());
  EXPECT_NEAR(sky.value(), area_m2 * 0.2 * 0.5 * (plate_w_m2_sr(254) - plate_w_m2_sr(250)),
              4 * sky.stderr() + 1e-6 * sky.value());
  // Paint that emits more reflects as much less.
  const auto& paint = input(row, "emissivity").contribution_w_sr();
  EXPECT_NEAR(paint.value(), area_m2 * 0.02 * (plate_w_m2_sr(300) - 0.5 * plate_w_m2_sr(250)),
              4 * paint.stderr() + 1e-6 * paint.value());
  double squares = 0;
  for (const schema::InputContribution& i : row.input())
    squares += std::pow(i.contribution_w_sr().value(), 2);
  EXPECT_EQ(row.input_size(), 3);
  EXPECT_NEAR(row.input_uncertainty_w_sr(), std::sqrt(squares), 1e-12);
  EXPECT_NEAR(row.apparent_input_uncertainty_w_sr(), row.input_uncertainty_w_sr(),
              1e-9 * row.input_uncertainty_w_sr())
      << "no air";

  // The row is that of a sweep which says nothing of its inputs, to the last bit.
  auto plain = view_of(resolved(kPlate));
  auto same = view_of(resolved(std::string(kPlate) + stated));
  EXPECT_FALSE(plain.row(0).has_input_uncertainty_w_sr());
  same.mutable_row(0)->clear_input();
  same.mutable_row(0)->clear_input_uncertainty_w_sr();
  same.mutable_row(0)->clear_apparent_input_uncertainty_w_sr();
  same.mutable_row(0)->clear_contrast_input_uncertainty_w_sr();
  for (auto* view : {&plain, &same})
    for (auto& effect : *view->mutable_row(0)->mutable_effect()) effect.clear_time_s();
  EXPECT_EQ(same.SerializeAsString(), plain.SerializeAsString());

  // Returns the view computed by hand, with the same seed.
  const auto by_hand = [&](const char* from, const char* to) {
    return view_of(resolved(absl::StrReplaceAll(kPlate, {{from, to}})))
               .row(0)
               .intensity_w_sr()
               .value() -
           plain.row(0).intensity_w_sr().value();
  };
  const double i = plain.row(0).intensity_w_sr().value();
  EXPECT_NEAR(by_hand("temperature_k = 300", "temperature_k = 300.5"),
              gain(row, "part_temperature_k"), 1e-9 * i);
  EXPECT_NEAR(by_hand("sky_temperature_k = 250", "sky_temperature_k = 254"), sky.value(), 1e-9 * i);
}

// Emissivity ends at 1: the other side is looked at, and the sign is still that of more of it.
TEST(InputViews, OfAnInputAtItsLimitIsThatOfItsOtherSide) {
  const std::string text =
      absl::StrReplaceAll(kPlate, {{"emissivity = 0.8", "emissivity = 0.99"},
                                   {"sky_temperature_k = 250", "sky_radiance_w_m2_sr_um = 0"}});
  const auto row = view_of(resolved(text + "[uncertainty]\nemissivity = 0.02\n")).row(0);
  EXPECT_NEAR(gain(row, "emissivity") / row.intensity_w_sr().value(), 0.02 / 0.99, 1e-6);
}

// A box in the weather of a day: what each input changes of it.
constexpr const char* kBox = R"(
time = ["12:00Z"]
[model]
generate = "box"
triangles = 12
length_m = 4
width_m = 2
height_m = 2
draft_m = 0
offset_m = [0, 0, 3]
[place]
latitude_deg = 45
longitude_deg = 0
heading_deg = 0
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.9
solar_absorptance = 0.6
[[build_up]]
name = "tank"
layer = [{ solid = "steel", thickness_m = 0.002 }]
inside = "temperature"
inside_temperature_k = 320
[[part]]
name = "box"
rest = true
material = "paint"
build_up = "tank"
[heat]
step_minutes = 60
[weather]
pressure_pa = 101300
wind_speed_m_s = 4
wind_from_deg = 270
[[season]]
name = "June"
date = 2025-06-21
day = { air_temperature_min_k = 288, air_temperature_max_k = 296, dew_point_k = 284 }
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.5
[viewpoints]
kind = "list"
range_m = 2000
aspect = [{ azimuth_deg = 40, elevation_deg = 10 }]
[surroundings]
kind = "ground"
ground_temperature_k = 292
ground_emissivity = 0.95
solar_albedo = 0.2
[air]
model = "atmosphere"
aerosol = "rural"
visibility_m = 23000
[transport]
sun = true
[accuracy]
samples_per_replicate = 256
[output]
thumbnail_px = 0
)";

// The changes of one input's temperatures: mean over facets of the first time.
double mean_change_k(const schema::HeatField& field, int which) {
  double sum = 0;
  for (std::uint32_t f = 0; f < field.facets(); ++f) {
    float k = 0;
    std::memcpy(&k, field.change_k(which).data() + f * sizeof(float), sizeof(float));
    sum += static_cast<double>(k);
  }
  return sum / field.facets();
}
double mean_k(const schema::HeatField& field) {
  double sum = 0;
  for (std::uint32_t f = 0; f < field.facets(); ++f) {
    float k = 0;
    std::memcpy(&k, field.kelvin().data() + f * sizeof(float), sizeof(float));
    sum += static_cast<double>(k);
  }
  return sum / field.facets();
}
schema::HeatField field_of(const std::string& bytes) {
  schema::HeatField field;
  EXPECT_TRUE(field.ParseFromString(bytes));
  return field;
}

TEST(InputViews, OfWallsThatHoldATemperatureAreThatTemperatures) {
  const auto sweep = resolved(std::string(kBox) +
                              "[uncertainty]\ninside_temperature_k = 3\nair_temperature_k = 1\n");
  ASSERT_EQ(sweep.heat_size(), 2) << "one run of temperatures, one of what changes them";
  ASSERT_EQ(sweep.heat(1).input_size(), 2);
  EXPECT_EQ(sweep.heat(1).input(0).name(), "air_temperature_k");
  const auto heat = heat_outputs(sweep, {});
  ASSERT_TRUE(heat.ok()) << heat.status();
  const schema::HeatField field = field_of((*heat)[1]);
  ASSERT_EQ(field.change_k_size(), 2);
  // 2 mm of steel conduct 23 kW/(m2 K), air and sky take some 25 W/(m2 K).
  EXPECT_NEAR(mean_change_k(field, 1), 3, 0.01);
  EXPECT_GT(mean_change_k(field, 0), 0);
  EXPECT_LT(mean_change_k(field, 0), 0.002);

  const auto row = view_of(sweep).row(0);
  // Nearly all of what it sends out of itself: eps A (B(T + 3) - B(T)).
  EXPECT_NEAR(gain(row, "inside_temperature_k") / row.emitted_w_sr().value(),
              plate_w_m2_sr(323) / plate_w_m2_sr(320) - 1, 2e-3);
  // A warmer air is a warmer sky, and of the path in front of the sensor a warmer veil.
  EXPECT_GT(gain(row, "air_temperature_k"), 0);
  EXPECT_GT(input(row, "air_temperature_k").apparent_contribution_w_sr().value(),
            gain(row, "air_temperature_k"));
}

// A sheet that keeps no heat: what changes it is what a run with changed inputs says.
TEST(InputViews, OfWallsAreWhatOtherRunsSay) {
  const std::string sheet = absl::StrReplaceAll(
      kBox, {{"inside = \"temperature\"\ninside_temperature_k = 320", "inside = \"adiabatic\""}});
  const auto sweep =
      resolved(sheet +
               "[uncertainty]\nair_temperature_k = 1\nwind_speed_relative = 0.25\n"
               "solar_absorptance = 0.05\nemissivity = 0.05\nground_temperature_k = 2\n");
  const auto heat = heat_outputs(sweep, {});
  ASSERT_TRUE(heat.ok()) << heat.status();
  const schema::HeatField nominal = field_of((*heat)[0]), changes = field_of((*heat)[1]);
  ASSERT_EQ(changes.change_k_size(), 5);
  const std::pair<const char*, const char*> by_hand[] = {
      {"air_temperature_min_k = 288, air_temperature_max_k = 296",
       "air_temperature_min_k = 289, air_temperature_max_k = 297"},
      {"wind_speed_m_s = 4", "wind_speed_m_s = 5"},
      {"solar_absorptance = 0.6", "solar_absorptance = 0.65"},
      {"emissivity = 0.9\n", "emissivity = 0.95\n"},
      {"ground_temperature_k = 292", "ground_temperature_k = 294"}};
  for (int i = 0; i < 5; ++i) {
    const auto changed =
        resolved(absl::StrReplaceAll(sheet, {{by_hand[i].first, by_hand[i].second}}));
    const auto run = heat_outputs(changed, {});
    ASSERT_TRUE(run.ok()) << run.status();
    const double expected_k = mean_k(field_of((*run)[0])) - mean_k(nominal);
    EXPECT_NEAR(mean_change_k(changes, i), expected_k, 0.03 * std::abs(expected_k) + 0.005)
        << sweep.heat(1).input(i).name();
  }

  // The row is the same: by hand, other emissivities apart, on the same paths.
  const auto row = view_of(sweep).row(0);
  const auto plain = view_of(resolved(sheet)).row(0);
  EXPECT_EQ(plain.intensity_w_sr().value(), row.intensity_w_sr().value());
  for (const int i : {0, 1, 4}) {
    const std::string name = sweep.sweep().has_uncertainty() ? sweep.heat(1).input(i).name() : "";
    const auto changed =
        view_of(resolved(absl::StrReplaceAll(sheet, {{by_hand[i].first, by_hand[i].second}})))
            .row(0);
    const auto near = [&](double here, double there, double stated) {
      EXPECT_NEAR(stated, there - here, 0.03 * std::abs(there - here) + 1e-5 * here) << name;
    };
    near(row.intensity_w_sr().value(), changed.intensity_w_sr().value(), gain(row, name));
    near(row.apparent_intensity_w_sr().value(), changed.apparent_intensity_w_sr().value(),
         input(row, name).apparent_contribution_w_sr().value());
  }
}

}  // namespace
}  // namespace irsig
