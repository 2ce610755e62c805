// The picture of a hemisphere of views.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "view/plot/plot_hemisphere.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

HemisphereValues views() {
  HemisphereValues v{{0, 30, 60}, {0, 90, 180, 270}, {}};
  for (int i = 0; i < 12; ++i) v.value.push_back(0.1 + 0.01 * i);
  return v;
}

TEST(HemispherePlot, OneCellForEachViewAndALegend) {
  const std::string svg = plot_hemisphere("soil <wet>", "pi x BRDF", views(), 30);
  EXPECT_EQ(count(svg, "<polygon"), 12u);
  EXPECT_THAT(svg, HasSubstr("soil &lt;wet&gt;"));
  EXPECT_THAT(svg, HasSubstr("pi x BRDF"));
  EXPECT_THAT(svg, HasSubstr("0\u00b0 source"));
  EXPECT_EQ(svg, plot_hemisphere("soil <wet>", "pi x BRDF", views(), 30));
  EXPECT_EQ(count(svg, "nan"), 0u);
}

// The largest value has the map's last colour, the smallest its first; all equal is no division by
// zero.
TEST(HemispherePlot, ColoursFollowTheValues) {
  HemisphereValues v = views();
  const std::string before = plot_hemisphere("t", "q", v, 0);
  std::swap(v.value[3], v.value[9]);
  EXPECT_NE(plot_hemisphere("t", "q", v, 0), before);
  v.value.assign(12, 0.25);
  EXPECT_EQ(count(plot_hemisphere("t", "q", v, 0), "nan"), 0u);
  v.value.assign(12, 0);
  EXPECT_EQ(count(plot_hemisphere("t", "q", v, 0), "nan"), 0u);
  EXPECT_EQ(count(plot_hemisphere("t", "q", {{0}, {0}, {1}}, 80), "<polygon"), 1u);
}

}  // namespace
}  // namespace irsig
