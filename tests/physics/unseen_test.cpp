// Rationale: what no sample met of the sun is bounded for facets that face nearly one way together.
// Expected: no bound is below the one that each facet has for itself, for the same light; and none
// is much above it, since samples are paid for it. Source: the same bounds facet by facet, as a
// lamp has them: one so far away that its light is the sun's.
#include "core/signature/unseen.h"

#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

TEST(Unseen, FacetsTogetherAreBoundedAsEachOfThemIs) {
  constexpr double kFar = 1e14;
  const std::vector<MaterialSpec> materials = {*builtin_material("hull"), grey(0.3)};
  double loosest = 1;
  for (const MaterialSpec& material : materials)
    for (const std::string shape : {"frigate", "sphere"}) {
      const auto simulator = simulator_of(
          scene_of(generated(shape, 20000, shape == "sphere" ? 30 : 0), material, mwir()));
      const Target& target = simulator->target();
      for (const Viewpoint& viewpoint :
           {Viewpoint{70, 4, 5000}, Viewpoint{0, 30, 500}, Viewpoint{200, 80, 20000}}) {
        const AimedView view = make_aimed_view(target, viewpoint);
        const UndersampledSources unseen(target, simulator->scene().places, simulator->materials(),
                                         view.frame);
        for (const double zenith_deg : {20.0, 75.0, 89.5, 90.1})
          for (const double azimuth_deg : {0.0, 80.0, 245.0}) {
            const double z = zenith_deg * std::numbers::pi / 180,
                         a = azimuth_deg * std::numbers::pi / 180;
            SunDirection sun{{std::sin(z) * std::cos(a), std::sin(z) * std::sin(a), -std::cos(z)},
                             0.00465};
            const UndersampledSources::Sun& together = unseen.of(sun);
            sun.distance_m = kFar;
            const UndersampledSources::Sun& each = unseen.of(sun);
            const auto expect = [&](double is, double least, const char* what) {
              EXPECT_GE(is, least * (1 - 1e-6)) << what << " " << shape << " " << zenith_deg;
              if (least > 0) loosest = std::max(loosest, is / least);
            };
            expect(together.first.sum(), each.first.sum(), "mirrored, sum");
            expect(together.first.brightest(), each.first.brightest(), "mirrored, brightest");
            expect(together.later.sum(), each.later.sum(), "later, sum");
            expect(together.brightest_per_sr, each.brightest_per_sr, "brightest");
          }
      }
    }
  std::printf("facets together: up to %.3f of what each has\n", loosest);
  EXPECT_LT(loosest, 1.1);
}

// Shares of reflected light add up, from bright to dark, and with their radiances to the radiance
// How much of the light that a surface reflects is how bright, against sums over the hemisphere.
TEST(ThrownLight, SharesAreThoseOfTheHemisphere) {
  constexpr int kAcross = 600;
  constexpr double kPi = std::numbers::pi;
  for (const MaterialSpec& spec :
       {grey(0.3), *builtin_material("hull"), *builtin_material("hull_paper")}) {
    const auto simulator = simulator_of(scene_of(generated("sphere", 20, 1), spec, mwir()));
    const Material& material = simulator->materials()[0];
    for (const int cell : {6, 14, 25, 31}) {
      const double root = (cell + 0.5) / 32, cos_i = root * root,
                   sin_i = std::sqrt(1 - cos_i * cos_i);
      std::map<int, double, std::greater<>> flux;  // by half octaves
      double all = 0;
      for (int a = 0; a < kAcross; ++a)
        for (int b = 0; b < kAcross; ++b) {
          // Equal projected solid angles; too coarse for light below 1 degree.
          const double cos_o = std::sqrt((a + 0.5) / kAcross), sin_o = std::sqrt(1 - cos_o * cos_o),
                       turn = kPi * (b + 0.5) / kAcross;
          const Vec<Body> i{sin_i, 0, cos_i},
              o{sin_o * std::cos(turn), sin_o * std::sin(turn), cos_o}, h = normalized(i + o);
          const double sin2_h = h.x * h.x + h.y * h.y;
          const Reflection at{static_cast<float>(cos_i), static_cast<float>(cos_o),
                              static_cast<float>(h.z), static_cast<float>(sin2_h),
                              static_cast<float>(dot(h, i))};
          const double per_sr =
              material.cos_brdf_limit_per_sr({cos_i, cos_o, sin2_h / (h.z * h.z), cos_i, cos_o});
          const auto sent = static_cast<double>(material.brdf_per_sr(at));
          if (!(per_sr > 0)) continue;
          flux[static_cast<int>(std::floor(2 * std::log2(per_sr)))] += sent;
          all += sent;
        }
      double share = 0, expected = 0;
      auto of = flux.begin();
      for (const ThrownLight::Class& one : material.thrown_light().of(cos_i)) {
        const int key = static_cast<int>(std::floor(2 * std::log2(one.per_sr)));
        share += one.share;
        for (; of != flux.end() && of->first >= key; ++of) expected += of->second / all;
        EXPECT_NEAR(share, expected, 0.03)
            << spec.name << ", cosine " << cos_i << ", " << one.per_sr;
      }
      EXPECT_NEAR(share, 1, 1e-9) << spec.name << ", cosine " << cos_i;
    }
  }
}

}  // namespace
}  // namespace irsig
