// Rationale: every table of weights and of light is indexed by SourceId, and only SourceLayout
// knows what stands behind one: each source needs a place of its own. Weights are kept where paths
// have been only, so that 10^4 emitters fit.
// Expected: places count up without gaps and give back what was asked for; the sums of a sparse
// table are those of a dense one, to the bit; its memory is that of the pages met, whatever the
// number of additions.
// Source: SourceLayout's and SourceWeights' own contracts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <set>
#include <vector>

#include "core/base/sobol.h"
#include "core/environment/sea/sea_glint.h"
#include "core/sources/source_weights.h"
#include "core/sources/view_sources.h"

namespace irsig {
namespace {

using Kind = SourceLayout::Kind;

SourceGeometry everything_around() {
  SourceGeometry out;
  out.boundary = Sea{{3, 6.4e6}};
  out.sun = {{{0, 0.6, -0.8}, 0.005, 0, 5}, {{0.6, 0, -0.8}, 0.005}};
  out.directions = DirectionNodes({0, 0.5f, 1}, {0, 1}, 4);
  out.behind = BackgroundDirections({0, 0, 0.1f});
  return out;
}

TEST(SourceLayout, EverySourceHasOnePlace) {
  const SourceGeometry around = everything_around();
  const SourceLayout layout(3, around);
  const auto glints = static_cast<std::uint32_t>(kGlintCosines.size());
  EXPECT_EQ(layout.count(), 3u + 3u + 12u + 8u + 2u + 2 * glints + 3u);
  std::set<std::uint32_t> met;
  const auto expect = [&](SourceId id, Kind kind, std::uint32_t index, std::uint32_t glint = 0) {
    const SourceLayout::Place at = layout.place_of(id);
    EXPECT_EQ(at.kind, kind);
    EXPECT_EQ(at.index, index);
    EXPECT_EQ(at.second, glint);
    EXPECT_TRUE(met.insert(index_of(id)).second) << index_of(id);
  };
  for (std::uint32_t e = 0; e < 3; ++e) {
    expect(layout.seen(e), Kind::kSeen, e);
    expect(layout.reflected(e), Kind::kReflected, e);
  }
  for (std::uint32_t k = 0; k < 20; ++k)
    expect(layout.node(k), k < 12 ? Kind::kSky : Kind::kLower, k);
  for (std::uint32_t j = 0; j < 2; ++j) {
    expect(layout.sun(j), Kind::kSun, j);
    for (std::uint32_t k = 0; k < glints; ++k) expect(layout.glint(j, k), Kind::kGlint, j, k);
  }
  for (std::uint32_t k = 0; k < 3; ++k) expect(layout.behind(k), Kind::kBehind, k);
  EXPECT_EQ(met.size(), layout.count());
}

// Every source of the intensity has one cause under its own sun, and none under another's.
TEST(SourceLayout, CausesShareOutTheIntensity) {
  const SourceLayout layout(3, everything_around());
  for (const std::vector<std::uint32_t>& suns : {std::vector<std::uint32_t>{}, {0}, {1}, {0, 1}})
    for (const SourceId id : layout.all()) {
      const SourceLayout::Place at = layout.place_of(id);
      int causes = 0;
      for (const auto& cause : layout.causes(suns))
        for (const SourceRange& piece : cause) causes += piece.contains(id) ? 1 : 0;
      const bool of_sun = at.kind == Kind::kSun || at.kind == Kind::kGlint;
      const bool counts = at.kind != Kind::kBehind &&
                          (!of_sun || std::find(suns.begin(), suns.end(), at.index) != suns.end());
      EXPECT_EQ(causes, counts ? 1 : 0) << index_of(id) << " under " << suns.size() << " suns";
    }
}

// Only a sea mirrors suns; both it and the ground are planes.
TEST(SourceGeometry, Boundaries) {
  SourceGeometry around = everything_around();
  EXPECT_TRUE(around.glitters());
  EXPECT_EQ(plane_of(around.boundary)->z_m, 3);
  around.boundary = Ground{{2, 6.4e6}};
  EXPECT_FALSE(around.glitters());
  EXPECT_EQ(plane_of(around.boundary)->z_m, 2);
  EXPECT_EQ(SourceLayout(3, around).behind().size(), 3u);
  around.boundary = NoBoundary{};
  EXPECT_FALSE(around.glitters());
  EXPECT_FALSE(plane_of(around.boundary).has_value());
}

TEST(SourceGeometry, ConditionsChooseTheBoundary) {
  ConditionSpec c;
  EXPECT_TRUE(std::holds_alternative<NoBoundary>(boundary_of(c, 1)));
  c.surroundings.kind = SurroundingsKind::kSea;
  EXPECT_TRUE(std::holds_alternative<Sea>(boundary_of(c, 1)));
  c.surroundings.kind = SurroundingsKind::kGround;
  EXPECT_TRUE(std::holds_alternative<Ground>(boundary_of(c, 1)));
  EXPECT_EQ(plane_of(boundary_of(c, 1))->z_m, 1);
}

// Conditions whose suns stand at the same place share one; the effects decide who has one at all.
TEST(ViewSources, SunsAreSharedAndLeftOut) {
  ConditionSpec dark;
  dark.part_temperature_k = {300, 350};
  ConditionSpec day = dark;
  day.sun = true;
  day.sun_scale = 1;
  day.sun_direction = {0, 0.6, -0.8};
  day.sun_cos_zenith = 0.8;
  day.sun_angular_radius_deg = 0.27;
  ConditionSpec windy = day;
  windy.sea_wind_m_s = 5;
  const std::vector<ConditionSpec> condition{day, dark, windy, day};
  const std::vector<std::uint32_t> all{0, 1, 2, 3};
  const std::vector<double> node_um{4.0};
  auto environments = std::make_shared<ViewEnvironments>();
  ViewEnvironment e;
  e.transmittance = {0.5};
  e.path_radiance = {0};
  e.sun = e.sun_apparent = {1};
  e.background_apparent = {{0}, {0}};
  e.around = IncidentRadiance::of_spectra(e.background_apparent, e.background_apparent);
  environments->condition.assign(4, e);
  const auto suns_of = [&](const EffectSet& effects) {
    const ViewSources sources({.condition = condition, .wanted = all, .parts = 2}, effects,
                              environments, node_um);
    std::vector<int> out{static_cast<int>(sources.geometry().sun.size())};
    for (std::size_t i = 0; i < 4; ++i) {
      const std::vector<LitSun>& lit = sources.wanted(i).suns();
      out.push_back(lit.empty() ? -1 : static_cast<int>(lit.front().index));
    }
    return out;
  };
  EffectSet effects = EffectSet::everything(4, 3);
  EXPECT_EQ(suns_of(effects), (std::vector<int>{2, 0, -1, 1, 0}));
  effects.sun[2].mirrored = false;  // then it stands where the others do
  EXPECT_EQ(suns_of(effects), (std::vector<int>{1, 0, -1, 0, 0}));
  effects.sun[0].direct = effects.sun[0].mirrored = false;
  EXPECT_EQ(suns_of(effects), (std::vector<int>{1, -1, -1, 0, 0}));
  effects.max_reflections = 0;
  EXPECT_EQ(suns_of(effects), (std::vector<int>{0, -1, -1, -1, -1}));
}

constexpr std::uint32_t kEmitters = 10000, kParts = 8;

SourceGeometry many_emitters() {
  SourceGeometry out = everything_around();
  for (std::uint32_t e = 0; e < kEmitters; ++e) {
    out.emitters.of_facet.push_back(e);
    out.emitters.part.push_back(e % kParts);
  }
  return out;
}

TEST(SourceWeights, AreThoseOfADenseTable) {
  const SourceLayout layout(kParts, many_emitters());
  constexpr std::size_t kColumns = 3;
  SourceWeights sparse(kParts, layout, kColumns);
  std::vector<double> dense(std::size_t{kParts} * layout.count() * kColumns, 0.0);
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const auto first = static_cast<std::uint32_t>(mix64(3 * i) % kParts);
    const SourceId id{static_cast<std::uint32_t>(mix64(3 * i + 1) % layout.count())};
    double* row = sparse.row(first, id);
    for (std::size_t k = 0; k < kColumns; ++k) {
      const double w = static_cast<double>(mix64(3 * i + 2) >> 40) / static_cast<double>(k + 3);
      row[k] += w;
      dense[(std::size_t{first} * layout.count() + index_of(id)) * kColumns + k] += w;
    }
  }
  SourceWeights twice(kParts, layout, kColumns);
  twice.add(1, sparse);
  twice.add(1, sparse);
  const SummedWeights sums = summed(sparse, layout, kParts);
  for (const SourceId id : layout.all())
    for (std::size_t k = 0; k < kColumns; ++k) {
      double sum = 0;
      for (std::uint32_t first = 0; first < kParts; ++first) {
        const double w = dense[(std::size_t{first} * layout.count() + index_of(id)) * kColumns + k];
        ASSERT_EQ(sparse.value(first, id, k), w);
        ASSERT_EQ(twice.value(first, id, k), 2 * w);
        sum += w;
      }
      ASSERT_EQ(sums.row(id)[k], sum);
    }
  std::size_t visited = 0;
  const SourceRange some{5, layout.count() - 3};
  sparse.for_each(2, some, [&](SourceId id, const double* row) {
    ASSERT_TRUE(some.contains(id));
    ASSERT_EQ(row[0], sparse.value(2, id));
    ++visited;
  });
  EXPECT_GT(visited, 0u);
  EXPECT_LE(visited, some.size());
}

// 10^4 emitters, each seen by one part of eight and reflected by two: a replicate's memory, for as
// many additions as one likes. A table of all pairs of emitters would have 10^8 numbers a column.
TEST(SourceWeights, TenThousandEmittersFit) {
  const SourceLayout layout(kParts, many_emitters());
  constexpr std::size_t kColumns = 10;
  SourceWeights weights(kParts, layout, kColumns);
  const auto trace = [&](std::uint64_t paths) {
    for (std::uint64_t i = 0; i < paths; ++i) {
      const auto e = static_cast<std::uint32_t>(mix64(i) % kEmitters);
      // Emitters that lie beside each other belong to the same part.
      const std::uint32_t part = e / (kEmitters / kParts);
      weights.row(part, layout.seen(e))[i % kColumns] += 1;
      weights.row((part + i % 2) % kParts, layout.reflected(e))[i % kColumns] += 1;
    }
    return weights.bytes();
  };
  trace(400000);  // every emitter has been met by all the parts that it can be met by
  const std::size_t bytes = weights.bytes();
  EXPECT_EQ(trace(4000000), bytes) << "memory grows with the number of paths";
  const std::size_t pages = 3 * kEmitters / SourceWeights::kPage + 2 * 3 * kParts;
  const std::size_t page_bytes = SourceWeights::kPage * kColumns * sizeof(double);
  const std::size_t list_bytes =
      kParts * (layout.count() / SourceWeights::kPage + 1) * sizeof(std::uint32_t);
  EXPECT_LE(bytes, 2 * pages * page_bytes + list_bytes);
  std::printf("%u emitters, %zu columns: %.2f MB a replicate\n", kEmitters, kColumns,
              1e-6 * static_cast<double>(bytes));
  // Cleared for the next stratum, nothing is allocated anew.
  weights.clear();
  EXPECT_EQ(weights.bytes(), bytes);
  EXPECT_EQ(weights.value(0, layout.seen(0)), 0);
  trace(400000);
  EXPECT_EQ(weights.bytes(), bytes);
}

}  // namespace
}  // namespace irsig
