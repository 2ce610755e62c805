// Plots show what was asked for, and refuse what one picture cannot show.
#include "view/plot/plot.h"

#include <gmock/gmock.h>

#include "absl/strings/str_cat.h"
#include "fake_database.h"

namespace irsig {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST(PlotPolar, DrawsOneCurvePerSeasonAndOnePanelPerBand) {
  FakeDatabase db = fake_database();
  auto svg = plot_polar(db, {}, std::nullopt);
  ASSERT_TRUE(svg.ok()) << svg.status();
  EXPECT_THAT(*svg,
              AllOf(HasSubstr("box ship, elevation 1\u00b0, range 5 km"), HasSubstr(">winter<"),
                    HasSubstr(">summer<"), HasSubstr("mwir (3\u20135 \u00b5m), in kW/sr"),
                    HasSubstr("lwir (8\u201312 \u00b5m), in kW/sr"), HasSubstr("180\u00b0 stern")));
  EXPECT_EQ(count(*svg, "<polyline"), 6U);
  auto one = plot_polar(db, {.season = "summer", .band = "lwir"}, 30);
  ASSERT_TRUE(one.ok());
  EXPECT_EQ(count(*one, "<polyline"), 1U);
}

TEST(PlotPolar, RingOfViewpointsIsDrawnAsItIs) {
  FakeSweep sweep;
  sweep.viewpoint = ring_viewpoints(36, {10, 40}, 800);
  FakeDatabase db = fake_database(sweep);
  auto svg = plot_polar(db, {.season = "summer", .band = "lwir"}, std::nullopt);
  ASSERT_TRUE(svg.ok()) << svg.status();
  EXPECT_THAT(*svg,
              AllOf(HasSubstr("elevation 10\u00b0, range 800 m"), Not(HasSubstr("interpolated"))));
  EXPECT_EQ(count(*svg, "r=\"3.20\""), 36U);
}

TEST(PlotPolar, RefusesAnUncoveredElevationAndAnAspect) {
  FakeDatabase db = fake_database();
  EXPECT_EQ(plot_polar(db, {}, -30).status().code(), absl::StatusCode::kOutOfRange);
  EXPECT_EQ(plot_polar(db, {.aspect = SignatureFilter::Direction{0, 0}, .nearest = 1}, {})
                .status()
                .code(),
            absl::StatusCode::kInvalidArgument);
}

TEST(PlotPolar, SeveralTimesHaveTheirOwnCurves) {
  FakeSweep sweep;
  sweep.season = {{"winter", "2025-12-21T01:30:00Z", 1}, {"winter", "2025-12-21T05:00:00Z", 1.1}};
  FakeDatabase db = fake_database(sweep);
  auto svg = plot_polar(db, {.band = "lwir"}, 10);
  ASSERT_TRUE(svg.ok());
  EXPECT_THAT(*svg, AllOf(HasSubstr("winter 01:30Z"), HasSubstr("winter 05:00Z")));
}

// 12 hours of winter and 3 of summer: 8, 4 and 3 curves, each with a panel and a legend.
TEST(PlotPolar, MoreThanEightCurvesHaveSeveralPanels) {
  FakeSweep sweep;
  sweep.season.clear();
  for (int hour = 10; hour < 22; ++hour)
    sweep.season.push_back({"winter", absl::StrCat("2025-12-21T", hour, ":00:00Z"), 1});
  for (int hour = 10; hour < 13; ++hour)
    sweep.season.push_back({"summer", absl::StrCat("2025-06-21T", hour, ":00:00Z"), 1.1});
  FakeDatabase db = fake_database(sweep);
  const auto svg = plot_polar(db, {.band = "lwir"}, 10);
  ASSERT_TRUE(svg.ok()) << svg.status();
  EXPECT_EQ(count(*svg, "In-band intensity"), 3U);
  EXPECT_EQ(count(*svg, "winter 10:00Z"), 1U);
  EXPECT_EQ(count(*svg, "summer 12:00Z"), 1U);
  const auto eight = plot_polar(db, {.season = "summer", .band = "lwir"}, 10);
  EXPECT_EQ(count(*eight, "In-band intensity"), 1U);
  const auto spectra = plot_spectrum(db, {.aspect = SignatureFilter::Direction{45, 10}});
  EXPECT_THAT(std::string(spectra.status().message()),
              HasSubstr("15 conditions match, and a spectrum plot shows at most 8"));
}

TEST(PlotSpectrum, NeedsOneViewpoint) {
  FakeDatabase db = fake_database();
  auto all = plot_spectrum(db, {});
  EXPECT_EQ(all.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(all.status().message()), HasSubstr("one viewpoint"));
  auto svg = plot_spectrum(db, {.aspect = SignatureFilter::Direction{45, 10}});
  ASSERT_TRUE(svg.ok()) << svg.status();
  EXPECT_EQ(count(*svg, "<polyline"), 6U);
  EXPECT_THAT(*svg, AllOf(HasSubstr("Wavelength in \u00b5m"),
                          HasSubstr("Spectral intensity in kW/(sr \u00b5m)")));
  auto row = plot_spectrum(db, {.row = 10});
  ASSERT_TRUE(row.ok());
  EXPECT_EQ(count(*row, "<polyline"), 1U);
  auto between =
      plot_spectrum(db, {.aspect = SignatureFilter::Direction{45, 10}, .interpolate = true});
  ASSERT_TRUE(between.ok());
  EXPECT_THAT(*between, HasSubstr("interpolated"));
}

TEST(PlotMap, DrawsAPanelPerSeasonAndBand) {
  FakeDatabase db = fake_database();
  auto svg = plot_map(db, {});
  ASSERT_TRUE(svg.ok()) << svg.status();
  EXPECT_EQ(count(*svg, "<clipPath"), 6U);
  EXPECT_EQ(count(*svg, "stroke=\"#000000\""), 6U * 191);  // viewpoints
  EXPECT_THAT(*svg, Not(HasSubstr("nan")));
}

TEST(Plot, EverythingZeroIsStillAPicture) {
  FakeDatabase db = fake_database();
  for (auto& s : db.signatures) {
    s.intensity_w_sr = s.intensity_stderr_w_sr = s.numerical_error_w_sr = 0;
  }
  for (auto svg : {plot_polar(db, {}, 20), plot_map(db, {})}) {
    ASSERT_TRUE(svg.ok()) << svg.status();
    EXPECT_THAT(*svg, AllOf(Not(HasSubstr("nan")), Not(HasSubstr("inf"))));
  }
}

TEST(Plot, NothingToPlotSaysSo) {
  FakeDatabase db = fake_database();
  auto none = plot_map(db, {.max_relative_error = 1e-9});
  EXPECT_EQ(none.status().code(), absl::StatusCode::kNotFound);
  FakeDatabase two = fake_database();
  for (std::size_t i = 0; i < 6; ++i) two.signatures[i].sweep = "other";
  EXPECT_THAT(std::string(plot_map(two, {}).status().message()),
              HasSubstr("choose one with --sweep: box ship, other"));
}

TEST(PlotQuantity, PolarPlotOfANegativeContrastHasACircleOfZero) {
  FakeDatabase db = fake_database();
  Query query{.season = "winter", .band = "lwir"};
  EXPECT_THAT(*plot_polar(db, query, 10), Not(HasSubstr("stroke-dasharray=\"5 3\"")));
  query.quantity = SignatureQuantity::kContrastIntensity;
  auto svg = plot_polar(db, query, 10);
  ASSERT_TRUE(svg.ok()) << svg.status();
  EXPECT_THAT(*svg, AllOf(HasSubstr("In-band contrast intensity, lwir"), HasSubstr(">-"),
                          HasSubstr("stroke-dasharray=\"5 3\"")));
}

TEST(PlotQuantity, SpectraAndMapsShowWhatWasAskedFor) {
  FakeDatabase db = fake_database();
  Query query{.row = 2, .quantity = SignatureQuantity::kContrastIntensity};
  auto svg = plot_spectrum(db, query);
  ASSERT_TRUE(svg.ok()) << svg.status();
  EXPECT_THAT(*svg, HasSubstr("Contrast spectral intensity in"));
  query.quantity = SignatureQuantity::kApparentIntensity;
  EXPECT_THAT(*plot_spectrum(db, query), HasSubstr("Apparent spectral intensity in"));
  query = {.season = "winter", .quantity = SignatureQuantity::kBackgroundRadiance};
  EXPECT_THAT(*plot_map(db, query), HasSubstr("In-band background radiance, mwir"));
  db.signatures[5].background_radiance_w_m2_sr = kNotComputed;
  query.season = "summer";
  const auto old = plot_map(db, query);
  EXPECT_EQ(old.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(old.status().message()),
              HasSubstr("row 6 has no background_radiance_w_m2_sr"));
}

}  // namespace
}  // namespace irsig
