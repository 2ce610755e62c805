// Rationale: what no sample met of the sun is bounded for facets that face nearly one way together.
// Expected: no bound is below the one that each facet has for itself, for the same light; and none
// is much above it, since samples are paid for it. Source: the same bounds facet by facet, as a
// lamp has them: one so far away that its light is the sun's.
#include "core/signature/unseen.h"

#include <cmath>
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
        const UnseenLight unseen(target, simulator->materials(), view.frame);
        for (const double zenith_deg : {20.0, 75.0, 89.5, 90.1})
          for (const double azimuth_deg : {0.0, 80.0, 245.0}) {
            const double z = zenith_deg * std::numbers::pi / 180,
                         a = azimuth_deg * std::numbers::pi / 180;
            SunDirection sun{{std::sin(z) * std::cos(a), std::sin(z) * std::sin(a), -std::cos(z)},
                             0.00465};
            const UnseenLight::Sun& together = unseen.of(sun);
            sun.distance_m = kFar;
            const UnseenLight::Sun& each = unseen.of(sun);
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

}  // namespace
}  // namespace irsig
