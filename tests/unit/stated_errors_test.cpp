// Are stated errors true: the arithmetic of the comparison, and that it finds errors which are not.
#include "core/study/stated_errors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

StatedRow row_off_by(double errors) {
  StatedRow row;
  for (StatedValue& v : row.in_band) v = {100 + errors, 1, 2, 0, 100, 0.1};
  row.spectrum = {{10 + errors, 1, std::nan(""), 0, 10, 0.1}, {10, 1, std::nan(""), 0, 10, 0.1}};
  return row;
}

TEST(StatedErrors, RatiosAreCountedInBothKindsOfErrors) {
  std::vector<StatedRow> rows;
  for (int i = 1; i <= 20; ++i) rows.push_back(row_off_by(i % 2 == 0 ? i : -i));
  const StatedErrorSummary s = summary_of(rows, Stated::kApparent);
  EXPECT_EQ(s.values, 20u);
  EXPECT_DOUBLE_EQ(s.median, 10);
  EXPECT_DOUBLE_EQ(s.percentile_95, 19);
  EXPECT_DOUBLE_EQ(s.largest, 20);
  EXPECT_EQ(s.with_numerical_error, 20u);
  EXPECT_EQ(s.beyond_2, 16u) << "of 2 each: 5 to 20";
  EXPECT_EQ(s.beyond_5, 10u) << "11 to 20";
  EXPECT_DOUBLE_EQ(s.largest_of_numerical_error, 10);
  const StatedErrorSummary spectrum = summary_of(rows, Stated::kSpectrum);
  EXPECT_EQ(spectrum.values, 40u);
  EXPECT_EQ(spectrum.with_numerical_error, 0u) << "none is stated";
  EXPECT_EQ(spectrum.beyond_5, 0u);
  EXPECT_EQ(summary_of({}, Stated::kIntensity).values, 0u);
}

TEST(StatedErrors, AnErrorOfZeroIsTrueOnlyOfAValueThatIsExact) {
  StatedValue v{100.00001, 0, 0, 1e-4, 100, 0};
  EXPECT_EQ(v.of_stderr(), 0) << "rounding";
  v.rounding = 0;
  EXPECT_TRUE(std::isinf(v.of_stderr()));
  EXPECT_TRUE(std::isinf(v.of_numerical_error()));
}

// A box in the dark, its run of few samples as it would be stored.
class BoxErrors : public testing::Test {
 protected:
  BoxErrors()
      : simulator_(fixture::simulator_of(fixture::scene_of(
            fixture::generated("box", 1200, 0, 10, 4, 3), fixture::grey(0.8), fixture::lwir()))) {
    request_ = fixture::request(*simulator_, 30, 20, 5000, {320});
    request_.accuracy.samples_per_replicate = 32;
  }

  // Rows of several views, whose stated standard errors are the true ones times `honesty`.
  std::vector<StatedRow> checked(double honesty) {
    std::vector<StatedRow> out;
    for (int view = 0; view < 24; ++view) {
      request_.viewpoint.aspect_azimuth_deg = 15 * view + 1;
      const SignatureResult r = fixture::only_row(*simulator_, request_);
      StatedRow row;
      const auto state = [&](Stated what, const Estimate& e) {
        row.in_band[static_cast<std::size_t>(what)] = {
            e.value, honesty * e.stderr_, e.stderr_, 1e-7 * e.value, 0, 0};
      };
      state(Stated::kIntensity, r.intensity_w_sr);
      state(Stated::kApparent, r.apparent_intensity_w_sr);
      state(Stated::kContrast, r.contrast_intensity_w_sr);
      state(Stated::kArea, r.projected_area_m2);
      for (std::size_t k = 0; k < r.spectral.value.size(); ++k)
        row.spectrum.push_back({r.spectral.value[k], honesty * r.spectral.stderr_[k], std::nan(""),
                                1e-7 * r.spectral.value[k], 0, 0});
      row.reflections = r.reflections;
      const auto result = check_stated_errors(*simulator_, request_, {row}, {.times = 64});
      EXPECT_TRUE(result.ok()) << result.status();
      EXPECT_EQ(result->times, 64);
      out.push_back(result->row.front());
    }
    return out;
  }

  std::unique_ptr<Simulator> simulator_;
  ViewRequest request_;
};

// 24 views: of a true error 2 % lie beyond a ratio of 2.4 (Student's t of 31), so that 3 or more of
// them, which the 95th percentile of 24 would need, have a probability of 1 %; the seeds are fixed.
TEST_F(BoxErrors, TrueOnesPass) {
  const std::vector<StatedRow> rows = checked(1);
  const StatedErrorSummary s = summary_of(rows, Stated::kIntensity);
  EXPECT_EQ(s.values, 24u);
  EXPECT_GT(s.median, 0.3);
  EXPECT_LT(s.median, 1.3);
  EXPECT_LT(s.percentile_95, 2.8);
  EXPECT_EQ(s.beyond_5, 0u);
  EXPECT_EQ(summary_of(rows, Stated::kSpectrum).values, 24 * rows.front().spectrum.size());
  const StatedValue& v = rows.front().in_band[static_cast<std::size_t>(Stated::kIntensity)];
  EXPECT_LT(v.reference_stderr, 0.3 * v.stderr_) << "64 times as many samples";
  EXPECT_NE(v.reference, v.value) << "other random numbers";
}

TEST_F(BoxErrors, OnesThatAreStatedTooSmallAreFound) {
  const StatedErrorSummary s = summary_of(checked(0.1), Stated::kIntensity);
  EXPECT_GT(s.median, 3);
  EXPECT_GT(s.percentile_95, 10);
}

TEST_F(BoxErrors, RowsOfAnotherPlanAreRefused) {
  StatedRow row;
  row.reflections = 3;
  row.spectrum.resize(simulator_->band_grids().front().lambda_um.size());
  EXPECT_EQ(check_stated_errors(*simulator_, request_, {row}, {}).status().code(),
            absl::StatusCode::kFailedPrecondition);
  row.reflections = 0;
  row.spectrum.pop_back();
  EXPECT_EQ(check_stated_errors(*simulator_, request_, {row}, {}).status().code(),
            absl::StatusCode::kFailedPrecondition);
}

}  // namespace
}  // namespace irsig
