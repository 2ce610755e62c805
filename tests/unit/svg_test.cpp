// The drawing primitives: what they write is well-formed, and round numbers are round.
#include "view/draw/svg.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "view/draw/axis.h"
#include "view/draw/contour.h"

namespace irsig {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Svg, EscapesText) {
  Svg svg(100, 50, "a < b & \"c\"");
  svg.text({1, 2}, "3\u20135 \u00b5m <b>\x01", {});
  // C1, a byte that is not UTF-8 and a tab: what XML 1.0 or a viewer may stumble over.
  svg.text({1, 2}, "x\xC2\x9bz\xffz\t", {});
  const std::string out = svg.finish();
  EXPECT_THAT(out, HasSubstr("<title>a &lt; b &amp; &quot;c&quot;</title>"));
  EXPECT_THAT(out, HasSubstr("3\u20135 \u00b5m &lt;b&gt;?</text>"));
  EXPECT_THAT(out, HasSubstr("x?z?z?</text>"));
  EXPECT_THAT(out, Not(HasSubstr("\x01")));
}

TEST(Svg, WritesNoNegativeZero) {
  Svg svg(10, 10, "");
  svg.line({-0.001, 0.001}, {1.005, -2}, {});
  EXPECT_THAT(svg.finish(), HasSubstr("x1=\"0.00\" y1=\"0.00\""));
}

TEST(Axis, TicksAreRoundAndCoverTheValues) {
  const Axis axis = round_axis(0, 187, 5);
  EXPECT_THAT(axis.label, ElementsAre("0", "50", "100", "150", "200"));
  EXPECT_DOUBLE_EQ(axis.fraction(50), 0.25);
  EXPECT_THAT(round_axis(0.013, 0.05, 4).label,
              ElementsAre("0.01", "0.02", "0.03", "0.04", "0.05"));
  EXPECT_THAT(round_axis(0, 2.4e5, 3, 1e-3).label, ElementsAre("0", "100", "200", "300"));
  EXPECT_THAT(tight_axis(2.7, 5.2, 4).label, ElementsAre("3", "4", "5"));
  const Axis constant = round_axis(7, 7, 4);
  EXPECT_LT(constant.low, 7);
  EXPECT_GT(constant.high, 7);
}

TEST(Axis, DisplayUnitKeepsLabelsShort) {
  EXPECT_EQ(display_unit(2.4e5, "W/sr").name, "kW/sr");
  EXPECT_EQ(display_unit(2400, "W/sr").name, "W/sr");
  EXPECT_EQ(display_unit(3e7, "W/sr").factor, 1e-6);
}

double area(const std::vector<Point>& loop) {
  double twice = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Point a = loop[i], b = loop[(i + 1) % loop.size()];
    twice += a.x * b.y - b.x * a.y;
  }
  return std::abs(twice) / 2;
}

ValueGrid svg_samples(std::size_t n, double (*value)(double, double)) {
  ValueGrid grid{n, n, {0, 0}, 1.0 / static_cast<double>(n - 1), {}};
  for (std::size_t y = 0; y < n; ++y) {
    for (std::size_t x = 0; x < n; ++x) {
      grid.value.push_back(
          value(static_cast<double>(x) * grid.step, static_cast<double>(y) * grid.step));
    }
  }
  return grid;
}

// Expected: the area of a disk of radius 0.3; linear interpolation on a grid of step h errs by
// O(h^2).
TEST(Contour, OutlineOfADisk) {
  const ValueGrid grid =
      svg_samples(101, [](double x, double y) { return -std::hypot(x - 0.5, y - 0.5); });
  const auto loops = outlines(grid, -0.3);
  ASSERT_EQ(loops.size(), 1U);
  EXPECT_NEAR(area(loops[0]), std::numbers::pi * 0.09, 1e-4);
}

TEST(Contour, RegionsAreClosedByTheEdge) {
  const ValueGrid everywhere = svg_samples(11, [](double, double) { return 1.0; });
  ASSERT_EQ(outlines(everywhere, 0.5).size(), 1U);
  EXPECT_NEAR(area(outlines(everywhere, 0.5)[0]), 1, 0.01);  // corners are cut
  EXPECT_TRUE(outlines(everywhere, 2).empty());
  const ValueGrid ramp = svg_samples(11, [](double x, double) { return x; });
  EXPECT_NEAR(area(outlines(ramp, 0.25)[0]), 0.75, 0.01);
}

TEST(Contour, HolesAndSaddles) {
  const ValueGrid ring = svg_samples(
      101, [](double x, double y) { return -std::abs(std::hypot(x - 0.5, y - 0.5) - 0.3); });
  const auto loops = outlines(ring, -0.1);
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_NEAR(std::abs(area(loops[0]) - area(loops[1])), std::numbers::pi * (0.16 - 0.04), 1e-3);
  ValueGrid saddle{2, 2, {0, 0}, 1, {1, 0, 0, 1}};
  EXPECT_EQ(outlines(saddle, 0.5).size(), 2U);
}

TEST(Colors, MapIsMonotonicInLightness) {
  double last = -1;
  for (int i = 0; i <= 64; ++i) {
    const std::string c = map_color(i / 64.0);
    const double luminance = 0.2126 * std::stoi(c.substr(1, 2), nullptr, 16) +
                             0.7152 * std::stoi(c.substr(3, 2), nullptr, 16) +
                             0.0722 * std::stoi(c.substr(5, 2), nullptr, 16);
    EXPECT_GE(luminance, last);
    last = luminance;
  }
}

}  // namespace
}  // namespace irsig
