// Panels of curves: where a value lands on the page, and that gaps stay gaps.
#include "view/plot/plot_curves.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <regex>

namespace irsig {
namespace {

using ::testing::HasSubstr;

std::vector<std::string> polylines(const std::string& svg) {
  std::vector<std::string> out;
  const std::regex line("<polyline points=\"([^\"]*)\"");
  for (std::sregex_iterator at(svg.begin(), svg.end(), line), end; at != end; ++at)
    out.push_back((*at)[1]);
  return out;
}

CurvePanel panel(std::vector<double> y) {
  return {"Emissivity", "x", "y", {{"10 \u00b5m", {0, 50, 100}, std::move(y)}}, 0, 1};
}

TEST(PlotCurves, PutsTheCornersOfTheRangeIntoTheCornersOfTheFrame) {
  const std::string svg = plot_curves("a <b>", "c", {panel({0, 0.5, 1})}, 1);
  EXPECT_THAT(svg, HasSubstr("a &lt;b&gt;"));
  EXPECT_THAT(svg, HasSubstr("10 \u00b5m"));
  const std::regex frame(
      "<rect x=\"([0-9.]+)\" y=\"([0-9.]+)\" width=\"([0-9.]+)\" height=\"([0-9.]+)\" "
      "fill=\"none\"");
  std::smatch f;
  ASSERT_TRUE(std::regex_search(svg, f, frame));
  const double x = std::stod(f[1]), y = std::stod(f[2]), w = std::stod(f[3]), h = std::stod(f[4]);
  const auto lines = polylines(svg);
  ASSERT_EQ(lines.size(), 1U);
  double px[6];
  ASSERT_EQ(std::sscanf(lines[0].c_str(), "%lf,%lf %lf,%lf %lf,%lf", px, px + 1, px + 2, px + 3,
                        px + 4, px + 5),
            6);
  const double expected[] = {x, y + h, x + w / 2, y + h / 2, x + w, y};
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(px[i], expected[i], 0.02) << i;
}

TEST(PlotCurves, AValueThatIsMissingInterruptsItsCurve) {
  CurvePanel gap = panel({0, 0, 0});
  gap.curve[0].x = {0, 1, 2, 3, 4};
  gap.curve[0].y = {0, 1, std::numeric_limits<double>::quiet_NaN(), 1, 0};
  EXPECT_EQ(polylines(plot_curves("t", "s", {gap}, 1)).size(), 2U);
}

TEST(PlotCurves, SetsPanelsInRows) {
  const std::string svg =
      plot_curves("t", "s", {panel({0, 0, 1}), panel({0, 0, 1}), panel({0, 0, 1})}, 2);
  EXPECT_THAT(svg, HasSubstr("width=\"1120\" height=\"874\""));
  EXPECT_EQ(polylines(svg).size(), 3U);
}

TEST(PlotCurves, FindsARangeOfItsOwn) {
  CurvePanel free = panel({3, 4, 5});
  free.y_high = 0;
  const std::string svg = plot_curves("t", "s", {free}, 1);
  EXPECT_THAT(svg, HasSubstr(">3.0</text>"));
  EXPECT_THAT(svg, HasSubstr(">5.0</text>"));
  CurvePanel empty{"nothing", "x", "y", {}};
  EXPECT_THAT(plot_curves("t", "s", {empty}, 1), HasSubstr("</svg>"));
}

TEST(PlotCurves, ABandSurroundsItsCurve) {
  CurvePanel banded = panel({1, 2, 3});
  banded.y_high = 0;
  banded.curve[0].low = {0, 1, 2};
  banded.curve[0].high = {2, 3, 8};
  banded.curve[0].marks = true;
  const std::string svg = plot_curves("t", "s", {banded}, 1);
  EXPECT_THAT(svg, HasSubstr(">8</text>")) << "the axis covers it";
  EXPECT_THAT(svg, HasSubstr("fill-opacity=\"0.1\""));
  EXPECT_THAT(svg, HasSubstr("<circle"));
}

TEST(PlotCurves, ALongLegendTakesMoreLines) {
  CurvePanel many = panel({0, 0, 1});
  for (int i = 0; i < 7; ++i) {
    many.curve.push_back(many.curve[0]);
    many.curve.back().name = "superstructure";
  }
  EXPECT_THAT(plot_curves("t", "s", {many}, 1), HasSubstr("width=\"560\" height=\"540\""));
}

}  // namespace
}  // namespace irsig
