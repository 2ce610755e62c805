// Rationale: "no cell is out of bound" says something only if the scenes are what their names say,
// if a difference that is not covered is found, and if bounds hold where the program would not have
// trusted them: with an effect left out although it matters.
// Expected: 192 different combinations; closed bodies with the volumes of their sides; of_allowed
// by hand; reflections left out of a cold mirror change it by most of its intensity, inside the
// stored bound; the program's own choice inside its bound, and within 5 numerical errors of a
// reference.
// Source: closed forms below.
#include "core/study/effects_matrix.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "core/scene/check/mesh_lint.h"
#include "core/scene/mesh_measure.h"
#include "core/study/matrix_bodies.h"

namespace irsig {
namespace {

double no_clock() { return 0; }

TEST(EffectsMatrix, HasEveryCombinationOnce) {
  const auto cells = factorial_cells();
  ASSERT_TRUE(cells.ok()) << cells.status();
  EXPECT_EQ(cells->size(), 192u);
  std::set<std::vector<std::string>> levels;
  for (const MatrixCell& cell : *cells) {
    EXPECT_EQ(cell.level.size(), kMatrixFactors.size());
    EXPECT_EQ(cell.viewpoint.size(), 4u);
    levels.insert(cell.level);
  }
  EXPECT_EQ(levels.size(), 192u);
  // The small matrix sees every level of every factor.
  const auto small = matrix_cells(true);
  ASSERT_TRUE(small.ok()) << small.status();
  for (std::size_t f = 0; f < kMatrixFactors.size(); ++f) {
    std::set<std::string> all, some;
    for (const MatrixCell& cell : *cells) all.insert(cell.level[f]);
    for (const MatrixCell& cell : *small)
      if (!cell.level.empty()) some.insert(cell.level[f]);
    EXPECT_EQ(all, some) << kMatrixFactors[f];
  }
}

void expect_closed(const Mesh& mesh, double volume_m3, const char* what) {
  const LintReport report = lint(mesh);
  EXPECT_FALSE(report.has_errors()) << what;
  EXPECT_EQ(report.closed_shells, report.shells) << what;
  EXPECT_NEAR(measure(mesh).volume_m3, volume_m3, 1e-9 * volume_m3) << what;
}

TEST(EffectsMatrix, BodiesAreClosedAndTurnedOutwards) {
  const HalfSize half{5, 2, 1.5};
  expect_closed(block(half), 120, "block");
  expect_closed(block_with_spot(half, 0.064), 120, "spot");
  expect_closed(tilted(block_with_mirror(half), 25), 120, "mirror");
  // Less the bay and the hole in its wall, 0.2 m thick.
  expect_closed(bay({8, 3, 3}, {6, 2, 2}, {6, 0, 2}), 576 - 192 - 9.6, "bay");
  expect_closed(bay({8, 3, 3}, {6, 2, 2}, {0.6, 0, 0.6}), 576 - 192 - 0.288, "deep bay");
  const Mesh round = drum(3, 16);
  expect_closed(round, M_PI * 9 * 16, "drum");
  const MeshMeasure spot = measure(block_with_spot(half, 0.064));
  ASSERT_EQ(spot.group_area_m2.size(), 2u);
  EXPECT_NEAR(spot.group_area_m2[1] / spot.area_m2, 1e-4, 1e-6);
}

TEST(EffectsCheck, WhatIsAllowedByHand) {
  CheckedView view;
  CheckedRow& row = view.row.emplace_back();
  ComparedValue& v = row.value[0];
  v.difference_w_sr = -3;
  v.omitted_bound_w_sr = 2;
  v.paired_stderr_w_sr = 0.5;
  EXPECT_DOUBLE_EQ(v.of_allowed(), 0.75);
  EXPECT_EQ(summary_of({&view, 1}).out_of_bound, 0u);
  v.paired_stderr_w_sr = 0.2;
  EXPECT_GT(v.of_allowed(), 1);
  EXPECT_EQ(summary_of({&view, 1}).out_of_bound, 1u);
  // Equal without any error is inside; a number that is none is not.
  v = {};
  EXPECT_EQ(v.of_allowed(), 0);
  row.value[2].difference_w_sr = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(summary_of({&view, 1}).out_of_bound, 1u);
  row.value[2] = {};
  // 3-4-5: a numerical error of 3, a reference known to 4, 12.5 away.
  view.referenced = true;
  v.chosen_w_sr = 112.5;
  v.reference_w_sr = 100;
  v.numerical_error_w_sr = 3;
  v.reference_stderr_w_sr = 4;
  EXPECT_DOUBLE_EQ(v.of_numerical_error(), 2.5);
  const EffectsSummary s = summary_of({&view, 1});
  EXPECT_EQ(s.referenced, kCompared);
  EXPECT_EQ(s.beyond_2, 1u);
  EXPECT_EQ(s.beyond_5, 0u);
}

// The matrix's cell of that name.
MatrixCell cell_named(const std::string& name) {
  const auto cells = matrix_cells(false);
  EXPECT_TRUE(cells.ok()) << cells.status();
  for (const MatrixCell& cell : *cells)
    if (cell.name == name) return cell;
  ADD_FAILURE() << "no cell " << name;
  return {};
}

MatrixCell seen_first_only(MatrixCell cell) {
  cell.viewpoint.resize(1);
  return cell;
}

TEST(EffectsCheck, WhatMattersIsSeenToMatterAndBounded) {
  const struct {
    const char* cell;
    Effect without;
    double least;  // of the intensity with all effects that goes with it
  } cases[] = {{"night lwir mirror convex cold sea 0.5 km", Effect::kSkyReflected, 0.1},
               {"night lwir mirror convex cold sea 0.5 km", Effect::kLowerReflected, 0.1},
               {"day mwir matt convex cold land 0.5 km", Effect::kDirectSun, 0.05},
               {"deep cavity", Effect::kInterReflection, 0.1},
               {"glint", Effect::kDirectSun, 0.5}};
  for (const auto& c : cases) {
    MatrixOptions options;
    options.reference_paths = 0;
    options.without = c.without;
    const auto checked = check_cell(seen_first_only(cell_named(c.cell)), options, no_clock);
    ASSERT_TRUE(checked.ok()) << c.cell << checked.status();
    const CheckedRow& row = checked->view[0].row[0];
    const ComparedValue& source = row.value[static_cast<std::size_t>(Compared::kSource)];
    EXPECT_TRUE(row.is_off(c.without)) << c.cell;
    EXPECT_LT(source.difference_w_sr, -c.least * source.all_w_sr) << c.cell;
    for (const ComparedValue& v : row.value)
      EXPECT_LE(v.of_allowed(), 1)
          << c.cell << ": " << v.difference_w_sr << ", bound " << v.omitted_bound_w_sr;
    // Stored as part of the numerical error (as a bias bound: a third of its square).
    EXPECT_GE(source.numerical_error_w_sr, 0.577 * source.omitted_bound_w_sr) << c.cell;
  }
}

// Light that reaches the sensor by way of the target is not only the target's own.
TEST(EffectsCheck, SunByWayOfTheTargetIsInTheBoundOfInterReflection) {
  auto cells = hard_cells();
  ASSERT_TRUE(cells.ok()) << cells.status();
  for (MatrixCell& cell : *cells) {
    if (cell.name != "two mirrors") continue;
    cell.viewpoint.resize(1);
    MatrixOptions options;
    options.reference_paths = 0;
    options.without = Effect::kInterReflection;
    const auto checked = check_cell(cell, options, no_clock);
    ASSERT_TRUE(checked.ok()) << checked.status();
    EXPECT_GT(checked->summary.values, 0u);
    EXPECT_EQ(checked->summary.out_of_bound, 0u);
    return;
  }
  FAIL() << "there is no such cell";
}

TEST(EffectsCheck, AutomaticIsInsideItsBoundsAndNearTheReference) {
  for (const char* name :
       {"night lwir matt convex hot sea 0.5 km", "day mwir mirror cavity cold land 5 km",
        "hot spot in a mirror", "thermal crossover"}) {
    MatrixOptions options;
    options.reference_paths = 10;
    const auto checked = check_cell(seen_first_only(cell_named(name)), options, no_clock);
    ASSERT_TRUE(checked.ok()) << name << checked.status();
    EXPECT_EQ(checked->summary.values, kCompared);
    EXPECT_EQ(checked->summary.referenced, kCompared);
    EXPECT_LE(checked->summary.largest_of_allowed, 1) << name;
    EXPECT_LE(checked->summary.largest_of_numerical_error, 5) << name;
  }
}

// Hot gas: what each of its effects changes is inside the bound of leaving it out, and much of it.
TEST(EffectsCheck, WhatHotGasDoesIsBounded) {
  const struct {
    const char* cell;
    Effect without;
    Compared of;
    double least;  // of what is allowed
  } cases[] = {
      {"plume 700 K mwir matt 5 km", Effect::kPlume, Compared::kApparent, 0.5},
      {"plume 1200 K mwir mirror 0.1 km", Effect::kPlumeOnHull, Compared::kSource, 0.5},
      {"plume 700 K lwir mirror 0.1 km", Effect::kPlumeOnHull, Compared::kSource, 0.3},
      {"plume 1200 K mwir matt 5 km", Effect::kHotLineCorrelation, Compared::kApparent, 0.5}};
  for (const auto& c : cases) {
    MatrixOptions options;
    options.reference_paths = 0;
    options.without = c.without;
    const auto checked = check_cell(seen_first_only(cell_named(c.cell)), options, no_clock);
    ASSERT_TRUE(checked.ok()) << c.cell << checked.status();
    const CheckedRow& row = checked->view[0].row[0];
    EXPECT_TRUE(row.is_off(c.without)) << c.cell;
    for (const ComparedValue& v : row.value) EXPECT_LE(v.of_allowed(), 1) << c.cell;
    EXPECT_GE(row.value[static_cast<std::size_t>(c.of)].of_allowed(), c.least) << c.cell;
  }
}

// Nothing is left out where nothing was asked: the same run twice, to the last bit.
TEST(EffectsCheck, AllAgainstAllIsZero) {
  const MatrixCell cell = seen_first_only(cell_named("day mwir mirror cavity cold sea 5 km"));
  const auto simulator = Simulator::create(cell.scene);
  ASSERT_TRUE(simulator.ok()) << simulator.status();
  ViewRequest request;
  request.viewpoint = cell.viewpoint[0];
  request.condition = {cell.condition};
  request.selected_condition = request.selected_band = {0};
  request.max_reflections = 4;
  request.accuracy.samples_per_replicate = 64;
  const auto view = check_effects(**simulator, request, {}, no_clock);
  ASSERT_TRUE(view.ok()) << view.status();
  for (const ComparedValue& v : view->row[0].value) {
    EXPECT_EQ(v.difference_w_sr, 0);
    EXPECT_EQ(v.paired_stderr_w_sr, 0);
    EXPECT_EQ(v.omitted_bound_w_sr, 0);
  }
}

}  // namespace
}  // namespace irsig
