// The pictures and the page of an accuracy study.
#include "view/study_tables/work_precision_plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace irsig {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST(WorkPrecisionPlot, LeavesOutWhatALogarithmDoesNotHave) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const WorkPanel panel{
      "a < b", "CPU time [s]",
      "error", {{"curve", {0.01, 0.1, 1, 10, 100}, {0.1, 0.01, 0, nan, 0.001}, true}},
      1e-4,    {0.01}};
  const std::string svg = plot_work_precision("title", "subtitle", {panel}, 1);
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
  EXPECT_EQ(count(svg, "<circle"), 4u) << "three points and the legend";
  EXPECT_THAT(svg, HasSubstr("error of the reference"));
  EXPECT_THAT(svg, HasSubstr("a &lt; b"));
}

TEST(WorkPrecisionPlot, AnEmptyPanelIsAFrame) {
  EXPECT_THAT(plot_work_precision("t", "", {{"nothing", "x", "y", {}, 0, {}}}, 1),
              HasSubstr("nothing"));
}

TEST(WorkPrecisionPlot, ThePageIsSelfContained) {
  const std::string svg = plot_work_precision("t", "", {{"p", "x", "y", {}, 0, {}}}, 1);
  const std::string page =
      html_page("a & b", {{"section", {"a paragraph"}, svg, {{"caption", {"h"}, {{"<1 %"}}}}}});
  EXPECT_THAT(page, HasSubstr("<title>a &amp; b</title>"));
  EXPECT_THAT(page, HasSubstr("<td>&lt;1 %</td>"));
  EXPECT_THAT(page, HasSubstr("<svg"));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, Not(HasSubstr("src=")));
  EXPECT_THAT(page, Not(HasSubstr("<?xml"))) << "a declaration belongs to the top of a document";
}

TEST(WorkPrecisionPlot, TablesInMarkdown) {
  EXPECT_EQ(markdown_tables({{"times", {"a", "b"}, {{"1", "2"}}}}),
            "times\n\n| a | b |\n| --- | --- |\n| 1 | 2 |\n\n");
}

}  // namespace
}  // namespace irsig
