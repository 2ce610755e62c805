// Rationale: an emitter may be an element of a mesh instead of a part. What elements of one
// temperature send out is what their part sends out, seen straight or by reflection; ten thousand
// of them must not take more memory than the pairs that paths join.
// Expected: on the same paths the weights of a part's elements add up to the part's, and a part of
// equal elements has the same light; weights of all else are equal to the bit.
// Source: the same paths traced with the parts as emitters.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/signature/view/shading.h"
#include "core/sources/view_sources.h"
#include "core/spectral/planck.h"
#include "scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

// Ten thousand emitters: facets that follow each other in the mesh, of one part each.
Emitters cut_into(const Target& target, std::size_t wanted) {
  Emitters out;
  const std::size_t size = std::max<std::size_t>(1, target.facet.size() / wanted);
  std::size_t in_emitter = size;
  for (const Target::Facet& facet : target.facet) {
    if (in_emitter >= size || facet.part != out.part.back()) {
      out.part.push_back(facet.part);
      in_emitter = 0;
    }
    out.of_facet.push_back(static_cast<std::uint32_t>(out.part.size() - 1));
    ++in_emitter;
  }
  return out;
}

std::size_t bytes_of(const std::vector<PathWeights>& weights) {
  std::size_t most = 0;
  for (const PathWeights& w : weights) most = std::max(most, w.weight.bytes() + w.last.bytes());
  return most;
}

TEST(Emitters, ElementsOfAPartAddUpToIt) {
  // A paint that is not grey: weights have several columns.
  SceneSpec scene = scene_of(
      generated("frigate", 50000),
      {"paint", Lambert{{{2.9, 0.9}, {3.4, 0.5}, {3.9, 0.8}, {4.3, 0.3}, {5.1, 0.6}}}}, mwir());
  scene.part = {
      {"ship", {"hull", "deck", "superstructure", "funnel", "mast", "turret"}, 0, false, false},
      {"hot", {"*_*"}, 0, false, true}};
  const auto simulator = simulator_of(scene);
  const Target& target = simulator->target();
  const AimedView view = make_aimed_view(target, {40, 30, 5000});
  PathSettings settings;
  settings.samples = 4096;
  settings.seed = 11;
  SourceGeometry by_part = lit_by({{normalized(Vec<Body>{0, 1, -1}), 0.005}});
  by_part.boundary = Sea{{-target.centre.z, 0}};
  SourceGeometry by_element = by_part;
  by_element.emitters = cut_into(target, 10000);
  const std::uint32_t elements = by_element.emitters.count(2);
  ASSERT_GT(elements, 9000u);

  PathCounts counts[2];
  const PathTracer few(target, simulator->carried_materials(), view, by_part, settings);
  const PathTracer many(target, simulator->carried_materials(), view, by_element, settings);
  const auto a = few.trace(counts[0]);
  const auto b = many.trace(counts[1]);
  ASSERT_EQ(counts[0].rays, counts[1].rays);
  double reflected = 0;
  for (std::size_t r = 0; r < a.size(); ++r)
    for (std::uint32_t first = 0; first < 2; ++first)
      for (std::size_t k = 0; k < few.nodes(); ++k) {
        double seen_sum[2] = {}, reflected_sum[2] = {};
        for (std::uint32_t e = 0; e < elements; ++e) {
          const std::uint32_t part = by_element.emitters.part_of(e);
          seen_sum[part] += b[r].weight.value(first, many.layout().seen(e), k);
          reflected_sum[part] += b[r].weight.value(first, many.layout().reflected(e), k);
        }
        for (std::uint32_t p = 0; p < 2; ++p) {
          const double seen = a[r].weight.value(first, few.layout().seen(p), k),
                       of_part = a[r].weight.value(first, few.layout().reflected(p), k);
          EXPECT_NEAR(seen_sum[p], seen, 1e-12 * seen);
          EXPECT_NEAR(reflected_sum[p], of_part, 1e-12 * of_part);
          reflected += of_part;
        }
        EXPECT_EQ(b[r].weight.value(first, many.layout().sun(0), k),
                  a[r].weight.value(first, few.layout().sun(0), k));
        EXPECT_EQ(b[r].weight.value(first, many.layout().first_sky(), k),
                  a[r].weight.value(first, few.layout().first_sky(), k));
      }
  EXPECT_GT(reflected, 0);

  // Fewer pairs than paths' vertices, and no table of all pairs.
  const std::size_t bytes = bytes_of(b);
  const std::size_t page_bytes = SourceWeights::kPage * many.nodes() * sizeof(double);
  const double vertices = static_cast<double>(counts[1].target_paths + counts[1].reflected_rays +
                                              counts[1].hot_rays + counts[1].sun_rays) /
                          settings.replicates;
  const std::size_t list_bytes =
      2 * (many.layout().count() / SourceWeights::kPage + 1) * sizeof(std::uint32_t);
  EXPECT_LE(static_cast<double>(bytes),
            2 * (2 * vertices * static_cast<double>(page_bytes) + static_cast<double>(list_bytes)));
  const double all_pages = 2.0 * (many.layout().count() / SourceWeights::kPage + 1);
  EXPECT_LE(static_cast<double>(bytes), 2 * (2 * all_pages * static_cast<double>(page_bytes) +
                                             static_cast<double>(list_bytes)));
  std::printf("%u emitters, %zu columns, %.0f vertices: %.2f MB a replicate, by part %.3f MB\n",
              elements, many.nodes(), vertices, 1e-6 * static_cast<double>(bytes),
              1e-6 * static_cast<double>(bytes_of(a)));

  // The light of both is equal.
  ConditionSpec condition;
  condition.part_temperature_k = {300, 420};
  condition.sun = true;
  condition.sun_scale = 1;
  condition.sun_direction = by_part.sun.front().direction;
  condition.sun_cos_zenith = -condition.sun_direction.z;
  condition.sun_angular_radius_deg = 0.27;
  const SpectralAxis& axis = simulator->scene().axis;
  auto environments = std::make_shared<ViewEnvironments>();
  const std::vector<double> one(axis.nodes(), 1.0), sky(axis.nodes(), 0.1);
  ViewEnvironment& e = environments->condition.emplace_back();
  e.transmittance = std::vector<double>(axis.nodes(), 0.5);
  e.path_radiance = std::vector<double>(axis.nodes(), 0.0);
  e.sun = e.sun_apparent = one;
  e.background_apparent = {sky, sky};
  e.around = IncidentRadiance::of_spectra(e.background_apparent, e.background_apparent);
  const std::vector<std::uint32_t> wanted{0};
  const auto values_of = [&](const SourceGeometry& around,
                             const std::vector<PathWeights>& weights) {
    const ViewSources sources({.condition = {&condition, 1},
                               .wanted = wanted,
                               .parts = 2,
                               .contrast = false,
                               .emitters = std::make_shared<const Emitters>(around.emitters)},
                              EffectSet::everything(1, 3), environments, axis.node_um());
    const LitWeights lit(sources.wanted(0), weights, 2);
    std::vector<RowTally> tally;
    const SpectralBasis* basis = simulator->scene().path_basis();
    const BandOnAxis band = axis.band(0);
    tally_row(sources.wanted(0), 2, lit, basis, band,
              source_table(sources.wanted(0), basis, band.first_node, band.grid.band_weight), true,
              tally);
    std::vector<std::vector<double>> values;
    for (const RowTally& of_replicate : tally) {
      values.emplace_back();
      of_replicate.for_each([&](double x) { values.back().push_back(x); });
    }
    return values;
  };
  const auto of_parts = values_of(by_part, a), of_elements = values_of(by_element, b);
  ASSERT_EQ(of_parts.size(), of_elements.size());
  for (std::size_t r = 0; r < of_parts.size(); ++r) {
    ASSERT_EQ(of_parts[r].size(), of_elements[r].size());
    for (std::size_t q = 0; q < of_parts[r].size(); ++q)
      EXPECT_NEAR(of_elements[r][q], of_parts[r][q], 1e-11 * std::abs(of_parts[r][0])) << q;
  }
}

ElementEmission emission_of(const Target& target, std::span<const FacetTemperatures> condition) {
  std::vector<std::uint32_t> part;
  for (const Target::Facet& f : target.facet) part.push_back(f.part);
  return make_element_emission(part, target.part.size(), condition);
}

// A blackbody's radiance from four of the nodes, over the range of temperatures and wavelengths.
TEST(Emitters, NodesGiveEveryBlackbody) {
  const BlackbodyNodes nodes(150, 3000);
  EXPECT_LT(nodes.count(), 330u);
  for (const double um : {1.0, 2.0, 3.0, 4.5, 10.0, 14.0}) {
    double worst = 0;
    for (double t = 150; t <= 3000; t *= 1.0007) {
      const BlackbodyNodes::Share share = nodes.share(t);
      double sum = 0;
      for (std::uint32_t k = 0; k < 4; ++k)
        sum += share.weight[k] * planck_radiance_w_m2_sr_um(um, nodes.kelvin(share.first + k));
      worst = std::max(worst, std::abs(sum / planck_radiance_w_m2_sr_um(um, t) - 1));
    }
    EXPECT_LE(worst, nodes.relative_error(um)) << um;
    EXPECT_GE(worst, 0.1 * nodes.relative_error(um)) << um;
  }
  EXPECT_LT(BlackbodyNodes(250, 330).relative_error(3), 4e-6);
  EXPECT_LT(BlackbodyNodes(250, 330).relative_error(8), 1e-6);
}

// Compares temperatures stated by part and by facet on equal paths. The bound of the temperatures'
// errors is the gain of the view when all are as much higher.
TEST(Emitters, TemperaturesOfTheirOwn) {
  for (const bool is_grey : {true, false}) {
    SceneSpec scene = scene_of(
        generated("frigate", 8000),
        is_grey
            ? grey(0.7)
            : MaterialSpec{"paint",
                           Lambert{{{2.9, 0.9}, {3.4, 0.5}, {3.9, 0.8}, {4.3, 0.3}, {5.1, 0.6}}}},
        mwir());
    scene.part = {{"ship", {"hull", "deck", "superstructure"}, 0, false, false},
                  {"mast", {"mast", "turret"}, 0, false, false},
                  {"funnel", {"funnel", "*_*"}, 0, false, false}};
    const auto simulator = simulator_of(scene);
    const Target& target = simulator->target();
    const auto simulate = [&](std::vector<double> kelvin, double error_k, bool by_facet) {
      ViewRequest r = request(*simulator, 40, 20, 5000, kelvin);
      r.accuracy.samples_per_replicate = 1024;
      r.max_reflections = 3;
      r.thumbnail_px = 40;
      if (by_facet) {
        // The ship's temperature stays stated.
        FacetTemperatures facets;
        for (const Target::Facet& f : target.facet) {
          facets.kelvin.push_back(f.part == 0 ? NAN : static_cast<float>(kelvin[f.part]));
          facets.error_k.push_back(f.part == 0 ? NAN : static_cast<float>(error_k));
        }
        const ElementEmission emission = emission_of(target, {&facets, 1});
        r.emitters = std::make_shared<const Emitters>(emission.emitters);
        r.condition[0].emitter = std::make_shared<const EmitterTemperatures>(emission.condition[0]);
      }
      auto result = simulator->simulate(r);
      EXPECT_TRUE(result.ok()) << result.status();
      return *std::move(result);
    };
    const ViewResult stated = simulate({290, 330, 420}, 0, false),
                     facets = simulate({290, 330, 420}, 0, true);
    const SignatureResult &a = stated.row[0], &b = facets.row[0];
    const double within = 4e-6 * a.intensity_w_sr.value;
    EXPECT_NEAR(b.intensity_w_sr.value, a.intensity_w_sr.value, within);
    EXPECT_NEAR(b.intensity_w_sr.stderr_, a.intensity_w_sr.stderr_, within);
    EXPECT_NEAR(b.apparent_intensity_w_sr.value, a.apparent_intensity_w_sr.value, within);
    EXPECT_NEAR(b.contrast_intensity_w_sr.value, a.contrast_intensity_w_sr.value, within);
    for (std::size_t c = 0; c < kCauses; ++c)
      EXPECT_NEAR(b.cause_w_sr[c].value, a.cause_w_sr[c].value, within) << c;
    EXPECT_GT(a.cause_w_sr[static_cast<std::size_t>(Cause::kPartsReflected)].value, 100 * within);
    for (std::size_t p = 0; p < a.part_w_sr.size(); ++p)
      EXPECT_NEAR(b.part_w_sr[p].value, a.part_w_sr[p].value, within) << p;
    for (std::size_t k = 0; k < a.spectral.value.size(); ++k)
      EXPECT_NEAR(b.spectral.value[k], a.spectral.value[k], 1e-5 * a.spectral.value[k]) << k;
    ASSERT_EQ(b.image_w_m2_sr.size(), a.image_w_m2_sr.size());
    for (std::size_t i = 0; i < a.image_w_m2_sr.size(); ++i)
      EXPECT_NEAR(b.image_w_m2_sr[i], a.image_w_m2_sr[i], 1e-5F * a.image_w_m2_sr[i]) << i;
    EXPECT_GT(b.spectral_basis_bound_w_sr, a.spectral_basis_bound_w_sr);
    EXPECT_LT(b.spectral_basis_bound_w_sr, a.spectral_basis_bound_w_sr + within);
    EXPECT_EQ(b.temperature_bound_w_sr, 0);

    const ViewResult uncertain = simulate({290, 330, 420}, 2, true),
                     warmer = simulate({290, 332, 422}, 0, true);
    const double more = warmer.row[0].intensity_w_sr.value - b.intensity_w_sr.value;
    EXPECT_EQ(uncertain.row[0].intensity_w_sr.value, b.intensity_w_sr.value);
    EXPECT_NEAR(uncertain.row[0].temperature_bound_w_sr, more, 1e-3 * more);
    // Bounds add up before they join the rest of an error.
    const double bound = more / std::sqrt(3.0);
    EXPECT_LE(uncertain.row[0].numerical_error_w_sr, 1.001 * (b.numerical_error_w_sr + bound));
    EXPECT_GE(uncertain.row[0].numerical_error_w_sr,
              0.999 * std::hypot(b.numerical_error_w_sr, bound));
    EXPECT_GT(more, 100 * within);
  }
}

// Which blackbodies stand for the temperatures follows from all conditions of a request.
TEST(Emitters, NoBitDependsOnWhichConditionsAreAskedFor) {
  SceneSpec scene = scene_of(generated("frigate", 4000), grey(0.7), mwir());
  const auto simulator = simulator_of(scene);
  const Target& target = simulator->target();
  std::vector<FacetTemperatures> facets(3);
  for (std::size_t c = 0; c < facets.size(); ++c)
    for (std::size_t f = 0; f < target.facet.size(); ++f) {
      facets[c].kelvin.push_back(static_cast<float>(250 + 40 * c + f % 17));
      facets[c].error_k.push_back(0.1F);
    }
  const ElementEmission emission = emission_of(target, facets);
  ViewRequest r = request(*simulator, 40, 20, 5000, {400});
  r.accuracy.samples_per_replicate = 256;
  r.max_reflections = 2;
  r.emitters = std::make_shared<const Emitters>(emission.emitters);
  r.condition.assign(3, r.condition.front());
  for (std::size_t c = 0; c < 3; ++c)
    r.condition[c].emitter = std::make_shared<const EmitterTemperatures>(emission.condition[c]);
  r.selected_condition = {0, 1, 2};
  const auto all = simulator->simulate(r);
  ASSERT_TRUE(all.ok()) << all.status();
  for (const std::uint32_t c : {0u, 1u, 2u}) {
    r.selected_condition = {c};
    const auto alone = simulator->simulate(r);
    ASSERT_TRUE(alone.ok()) << alone.status();
    EXPECT_EQ(alone->row[0].intensity_w_sr.value, all->row[c].intensity_w_sr.value);
    EXPECT_EQ(alone->row[0].numerical_error_w_sr, all->row[c].numerical_error_w_sr);
    EXPECT_EQ(alone->row[0].spectral.value, all->row[c].spectral.value);
    EXPECT_GT(alone->row[0].temperature_bound_w_sr, 0);
  }
}

}  // namespace
}  // namespace irsig
