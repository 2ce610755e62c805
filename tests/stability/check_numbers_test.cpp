#include "runner/check_numbers.h"

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
  r.intensity_w_sr = {10, 0.09};
  r.numerical_error_w_sr = 0.1;
  r.apparent_intensity_w_sr = {9, 0.09};
  r.apparent_numerical_error_w_sr = 0.1;
  r.projected_area_m2 = {1, 1e-3};
  r.source_radiance_temperature_k = 300;
  r.part_w_sr = {{10, 0.1}};
  for (SpectralEstimate* s : {&r.spectral, &r.apparent_spectral}) *s = {{1, 2}, {0.1, 0.1}};
  for (SpectralEstimate& s : r.spectral_cause) s = {{1, 2}, {0.1, 0.1}};
  r.image_w_m2_sr = {0, 1, 2};
  r.omitted_bound_w_sr = r.apparent_omitted_bound_w_sr = r.contrast_omitted_bound_w_sr = 1e-3;
  r.contrast_numerical_error_w_sr = 0.1;
  const double unknown = std::nan("");
  r.effect = {{Effect::kSelfEmission, EffectState::kOn, EffectReason::kAlways, unknown, unknown,
               unknown, 9, unknown},
              {Effect::kDirectSun, EffectState::kOff, EffectReason::kWithinShare, 1e-3, 1e-3, 1e-3,
               unknown, 0.5}};
  r.energy = {{0.9, 0.01}, {0.05, 0.01}, {0.05, 0.01}, {0, 0}, {1, 1e-9}};
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
  view.truncated_paths = 1000;
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
  view.row[0].source_radiance_temperature_k = nan;
  view.row[0].intensity_w_sr.value = -0.05;  // within its error, yet no blackbody's
  EXPECT_THAT(reason(view),
              HasSubstr("source_radiance_temperature_k is not a finite number: no blackbody "
                        "has a radiance of -0.05 W/(m2 sr)"));
  view = good();
  view.row[0].source_radiance_temperature_k = infinite;
  EXPECT_THAT(reason(view), HasSubstr("source_radiance_temperature_k is not a finite number: inf"));
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

TEST(CheckNumbers, ContrastHasAnySignAndTransmittanceNone) {
  ViewResult view = good();
  view.row[0].contrast_intensity_w_sr = {-500, 0.09};
  view.row[0].contrast_spectral = {{-1, 2}, {0.1, 0.1}};
  view.row[0].path_transmittance = 1 + 1e-12;  // a mean of ones, rounded
  EXPECT_TRUE(check_numbers(view).ok());
  struct Wrong {
    const char* named;
    void (*make)(SignatureResult&);
  };
  for (const Wrong& wrong :
       {Wrong{"contrast_intensity_w_sr is not a finite number",
              [](auto& r) { r.contrast_intensity_w_sr.value = NAN; }},
        {"background_radiance_w_m2_sr is negative",
         [](auto& r) { r.background_radiance_w_m2_sr.value = -1e-3; }},
        {"background_radiance_w_m2_sr_um[1] is",
         [](auto& r) {
           r.background_spectral = {{1, INFINITY}, {0, 0}};
         }},
        {"path_transmittance is above 1", [](auto& r) { r.path_transmittance = 1.001; }},
        {"path_transmittance is negative", [](auto& r) { r.path_transmittance = -0.1; }},
        {"path_transmittance is above 1 at a wavelength",
         [](auto& r) {
           r.path_transmittance_spectral = {0.5, 1.5};
         }},
        {"direction_interpolation_bound_w_sr is not",
         [](auto& r) { r.direction_interpolation_bound_w_sr = NAN; }}}) {
    ViewResult bad = good();
    wrong.make(bad.row[0]);
    EXPECT_THAT(reason(bad), HasSubstr(wrong.named));
  }
}

TEST(CheckNumbers, WhatWasLeftOutIsFiniteAndPartOfTheError) {
  struct Wrong {
    const char* named;
    void (*make)(SignatureResult&);
  };
  for (const Wrong& wrong :
       {Wrong{"omitted_bound_w_sr is not a finite", [](auto& r) { r.omitted_bound_w_sr = NAN; }},
        {"contrast_omitted_bound_w_sr is negative",
         [](auto& r) { r.contrast_omitted_bound_w_sr = -1e-3; }},
        // A bound of 0.2 makes an error of 0.2 / sqrt(3) at least.
        {"band 0: omitted_bound_w_sr or undersampling_stderr_w_sr is no part",
         [](auto& r) { r.omitted_bound_w_sr = 0.2; }},
        {"apparent_omitted_bound_w_sr or apparent_undersampling_stderr_w_sr is no part",
         [](auto& r) { r.apparent_omitted_bound_w_sr = 0.2; }},
        {"contrast_omitted_bound_w_sr or contrast_undersampling_stderr_w_sr is no part",
         [](auto& r) { r.contrast_omitted_bound_w_sr = 0.2; }},
        {"contrast_omitted_bound_w_sr or contrast_undersampling_stderr_w_sr is no part",
         [](auto& r) { r.contrast_undersampling_stderr_w_sr = 0.2; }},
        {"apparent_undersampling_stderr_w_sr is not a finite",
         [](auto& r) { r.apparent_undersampling_stderr_w_sr = NAN; }},
        {"absolute_floor_w_sr is negative", [](auto& r) { r.absolute_floor_w_sr = -1; }},
        {"direct_sun's bound_w_sr is not a finite",
         [](auto& r) { r.effect[1].bound_w_sr = INFINITY; }},
        {"direct_sun's contrast_bound_w_sr is negative",
         [](auto& r) { r.effect[1].contrast_bound_w_sr = -1; }},
        {"self_emission's fraction_w_sr is not a finite",
         [](auto& r) { r.effect[0].fraction_w_sr = -INFINITY; }},
        {"direct_sun's time_s is negative", [](auto& r) { r.effect[1].time_s = -1; }},
        {"energy.absorbed is not a finite", [](auto& r) { r.energy.absorbed.value = NAN; }},
        {"energy.cut_off is negative", [](auto& r) { r.energy.cut_off.value = -1e-3; }},
        {"energy.balance's standard error",
         [](auto& r) { r.energy.balance.stderr_ = INFINITY; }}}) {
    ViewResult bad = good();
    wrong.make(bad.row[0]);
    EXPECT_THAT(reason(bad), HasSubstr(wrong.named));
  }
  // Nothing is to be seen: there is no energy to account for.
  ViewResult nothing = good();
  nothing.row[0].energy = {{NAN, NAN}, {NAN, NAN}, {NAN, NAN}, {NAN, NAN}, {NAN, NAN}};
  EXPECT_TRUE(check_numbers(nothing).ok()) << check_numbers(nothing);
}

TEST(CheckNumbers, TellsEveryReason) {
  ViewResult view = good();
  view.guarded_nonfinite = 1;
  view.row[0].intensity_w_sr.value = std::nan("");
  EXPECT_THAT(reason(view), testing::AllOf(HasSubstr("guarded_nonfinite"), HasSubstr("; "),
                                           HasSubstr("intensity_w_sr")));
}

ProfileResult good_profile() {
  ProfileResult profile;
  ProfileRow& r = profile.row.emplace_back();
  r.point = 3;
  r.reflections = 8;
  r.radiance_w_m2_sr = {10, 0.1};
  r.apparent_radiance_w_m2_sr = {9, 0.1};
  r.source_radiance_temperature_k = {300, 0.1};
  r.target_fraction = 1;
  profile.counts.guarded_backface_hits = profile.counts.truncated_paths = 1000;  // ordinary
  return profile;
}

std::string reason(const ProfileResult& profile) {
  const absl::Status status = check_numbers("profile[2]", profile);
  EXPECT_EQ(status.code(), absl::StatusCode::kInternal) << status;
  return std::string(status.message());
}

TEST(CheckProfile, LetsGoodOnesPass) {
  EXPECT_TRUE(check_numbers("profile[2]", good_profile()).ok());
}

TEST(CheckProfile, FailsWhereWeightsWereDropped) {
  ProfileResult profile = good_profile();
  profile.counts.guarded_nonfinite = 3;
  EXPECT_THAT(reason(profile), HasSubstr("profile[2]: 3 path weights were not finite"));
  profile = good_profile();
  profile.counts.guarded_negative = 2;
  EXPECT_THAT(reason(profile), HasSubstr("profile[2]: 2 path weights were negative"));
}

TEST(CheckProfile, NamesTheFieldAndItsValue) {
  const double nan = std::nan("");
  ProfileResult profile = good_profile();
  profile.row[0].radiance_w_m2_sr.value = nan;
  EXPECT_THAT(reason(profile), HasSubstr("profile[2]: point 3, condition 0, band 0, reflections 8: "
                                         "radiance_w_m2_sr is not a finite number: nan"));
  profile = good_profile();
  profile.row[0].apparent_radiance_w_m2_sr.value = -1;
  EXPECT_THAT(reason(profile), HasSubstr("apparent_radiance_w_m2_sr is negative: -1"));
  profile = good_profile();
  profile.row[0].radiance_w_m2_sr.value = 1e40;
  profile.row[0].source_radiance_temperature_k = {nan, nan};
  EXPECT_THAT(reason(profile), HasSubstr("source_radiance_temperature_k is not a finite number: no "
                                         "blackbody has a radiance of 1e+40 W/(m2 sr)"));
  profile = good_profile();
  profile.row[0].source_radiance_temperature_k.stderr_ = nan;
  EXPECT_THAT(reason(profile), HasSubstr("source_radiance_temperature_k's standard error"));
  profile = good_profile();
  profile.row[0].truncation_bound_w_m2_sr = nan;
  EXPECT_THAT(reason(profile), HasSubstr("truncation_bound_w_m2_sr"));
}

}  // namespace
}  // namespace irsig
