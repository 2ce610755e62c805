#include "worker/check_numbers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace irsig {
namespace {

using ::testing::HasSubstr;

// A view of one row whose numbers can be trusted.
ViewResult good() {
  ViewResult view;
  SignatureResult& r = view.row.emplace_back();
  r.intensity_w_sr = {10, 0.1};
  r.numerical_error_w_sr = 0.1;
  r.apparent_intensity_w_sr = {9, 0.1};
  r.apparent_numerical_error_w_sr = 0.1;
  r.projected_area_m2 = {1, 1e-3};
  r.apparent_temperature_k = 300;
  r.part_w_sr = {{10, 0.1}};
  for (SpectralEstimate* s : {&r.spectral, &r.apparent_spectral}) *s = {{1, 2}, {0.1, 0.1}};
  for (SpectralEstimate& s : r.spectral_cause) s = {{1, 2}, {0.1, 0.1}};
  r.image_w_m2_sr = {0, 1, 2};
  return view;
}

std::string reason(const ViewResult& view) {
  const absl::Status status = check_numbers(view);
  EXPECT_EQ(status.code(), absl::StatusCode::kInternal) << status;
  return std::string(status.message());
}

TEST(CheckNumbers, LetsGoodOnesPass) { EXPECT_TRUE(check_numbers(good()).ok()); }

TEST(CheckNumbers, FailsWhereWeightsWereDropped) {
  ViewResult view = good();
  view.guarded_nonfinite = 3;
  EXPECT_THAT(reason(view), HasSubstr("3 path weights were not finite"));
  view = good();
  view.guarded_negative = 2;
  EXPECT_THAT(reason(view), HasSubstr("2 path weights were negative"));
}

TEST(CheckNumbers, FacetsFromBehindAndCutPathsAreOrdinary) {
  ViewResult view = good();
  view.guarded_backface_hits = 1000;
  view.guarded_path_limit = 1000;
  EXPECT_TRUE(check_numbers(view).ok());
}

TEST(CheckNumbers, NamesWhatIsNotFinite) {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  ViewResult view = good();
  view.row[0].intensity_w_sr.value = nan;
  EXPECT_THAT(reason(view), HasSubstr("condition 0, band 0: intensity_w_sr is not a finite"));
  view = good();
  view.row[0].projected_area_m2.stderr_ = infinite;
  EXPECT_THAT(reason(view), HasSubstr("projected_area_m2's standard error"));
  view = good();
  view.row[0].spectral.value[1] = nan;
  EXPECT_THAT(reason(view), HasSubstr("spectral_intensity_w_sr_um[1]"));
  view = good();
  view.row[0].spectral_cause[2].value[0] = infinite;
  EXPECT_THAT(reason(view), HasSubstr("spectrum of cause 2[0]"));
  view = good();
  view.row[0].image_w_m2_sr[2] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(reason(view), HasSubstr("image_w_m2_sr[2]"));
  view = good();
  view.row[0].apparent_temperature_k = nan;
  EXPECT_THAT(reason(view), HasSubstr("apparent_temperature_k"));
}

TEST(CheckNumbers, NegativeOnlyWithinTheError) {
  ViewResult view = good();
  view.row[0].intensity_w_sr.value = -0.05;
  EXPECT_TRUE(check_numbers(view).ok());
  view.row[0].intensity_w_sr.value = -0.2;
  EXPECT_THAT(reason(view), HasSubstr("intensity_w_sr is negative: -0.2"));
  view = good();
  view.row[0].part_w_sr[0].value = -5;
  EXPECT_THAT(reason(view), HasSubstr("part 0 is negative"));
  view = good();
  view.row[0].projected_area_m2.value = -1e-9;
  EXPECT_THAT(reason(view), HasSubstr("projected_area_m2 is negative"));
  view = good();
  view.row[0].intensity_w_sr.stderr_ = -1;
  EXPECT_THAT(reason(view), HasSubstr("intensity_w_sr's standard error is negative"));
}

TEST(CheckNumbers, TellsEveryReason) {
  ViewResult view = good();
  view.guarded_nonfinite = 1;
  view.row[0].intensity_w_sr.value = std::nan("");
  EXPECT_THAT(reason(view), testing::AllOf(HasSubstr("guarded_nonfinite"), HasSubstr("; "),
                                           HasSubstr("intensity_w_sr")));
}

}  // namespace
}  // namespace irsig
