// Rationale: small bright sources - the sun in a near-mirror, a lamp, a hot part - are found by
// aiming, by drawn directions, or by both; whichever finds them, the sum has a closed form.
// Expected: |t| within the bound of docs/explanation/methods.md for the number of rows of this
// file. Source: closed forms, stated with each test.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/spectral/planck.h"
#include "core/spectral/solar.h"
#include "core/transport/path_tracer.h"
#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;
constexpr double kPi = std::numbers::pi;
constexpr std::uint64_t kRows = 30;

MaterialSpec mirror(double roughness) {
  CookTorrance lobe;
  lobe.constants = {{0, 1.2, 5.0}};
  lobe.roughness = roughness;
  return {"mirror", lobe};
}
// Fresnel reflectance of 1.2 + 5.0i at normal incidence: |(n - 1)/(n + 1)|^2.
constexpr double kNormalReflectance = (0.2 * 0.2 + 25) / (2.2 * 2.2 + 25);

// A tracer's replicates, summed up by whatever `value` makes of them.
template <typename Value>
Estimate traced(const PathTracer& tracer, PathCounts& counts, const Value& value) {
  ReplicateStatistics statistics(1);
  for (const PathWeights& w : tracer.trace(counts)) {
    const double v = value(w);
    statistics.add({&v, 1});
  }
  EXPECT_EQ(counts.guarded_nonfinite + counts.guarded_negative, 0u);
  return statistics.estimate(0);
}
double weight(const PathTracer& tracer, const PathWeights& w, SourceId source) {
  double sum = 0;
  for (std::uint32_t f = 0; f < tracer.firsts(); ++f) sum += w.weight.value(f, source);
  return sum;
}

PathSettings settings(std::uint32_t max_reflections, std::uint64_t samples) {
  PathSettings s;
  s.max_reflections = max_reflections;
  s.samples = samples;
  s.seed = 4711;
  return s;
}

// Returns the part that a Beckmann facet seen along its normal sends back of a disk of unit
// radiance and reflectance: integral over the disk of D(theta/2) / 4 over solid angle (cos_o = 1,
// so that brdf cos_i = D G F / 4; G = 1 for theta < 60 deg). The disk's middle is d away from the
// normal, its radius R: at a zenith angle theta the azimuths on it are those with cos R < cos theta
// cos d + sin theta sin d cos phi. Exact but for the midpoint rule (20000 steps).
double seen_of_disk(double m, double d, double radius) {
  const double first = std::max(0.0, d - radius), last = std::min(d + radius, 2 * std::atan(7 * m));
  const int steps = 20000;
  double sum = 0;
  for (int i = 0; i < steps && last > first; ++i) {
    const double theta = first + (last - first) * (i + 0.5) / steps;
    double phi = kPi;  // half the range of azimuths
    if (theta + d > radius)
      phi = std::acos(std::clamp(
          (std::cos(radius) - std::cos(theta) * std::cos(d)) / (std::sin(theta) * std::sin(d)),
          -1.0, 1.0));
    const double c = std::cos(theta / 2), t = std::tan(theta / 2);
    const double distribution = std::exp(-t * t / (m * m)) / (kPi * m * m * c * c * c * c);
    sum += distribution / 4 * 2 * phi * std::sin(theta) * (last - first) / steps;
  }
  return sum;
}

// A flat near-mirror seen along its normal, the sun's disk about it: what is seen is the disk's
// radiance, E / (pi tan^2 r), times reflectance and what the lobe takes of the disk. At 1e-3 the
// lobe is all on the disk, on its edge, and off; at 1e-2 it is as wide as the disk.
TEST(NearMirror, FlatPlateShowsTheSunsDisk) {
  const Mesh plate = generated("disk", 400, std::sqrt(1 / kPi));
  const double radius = 0.266 * kPi / 180;
  for (const double m : {1e-4, 1e-3, 1e-2, 0.05})
    for (const double offset : {0.0, 1.0, 1.6}) {
      const double d = offset * radius;
      const double seen = seen_of_disk(m, d, radius);
      if (seen < 1e-6) continue;
      const auto simulator = simulator_of(scene_of(plate, mirror(m), mwir()));
      const AimedView view = make_aimed_view(simulator->target(), {0, 0, 1e6});
      const PathTracer tracer(simulator->target(), simulator->materials(), view,
                              lit_by({{{std::cos(d), std::sin(d), 0}, radius}}),
                              settings(1, 1u << 14));
      PathCounts counts;
      const Estimate e = traced(tracer, counts, [&](const PathWeights& w) {
        return weight(tracer, w, tracer.layout().sun(0)) / w.projected_area_m2;
      });
      const double expected = kNormalReflectance * seen / (kPi * std::pow(std::tan(radius), 2));
      // Allowed: 2.2e-5, the squared tangent of the disk's radius (points of the disk are uniform
      // on a plane, not in solid angle), and 2e-5 of the Fresnel tables (docs/explanation/methods).
      expect_within_t(e, expected, kRows,
                      "plate, m " + std::to_string(m) + ", off by " + std::to_string(offset),
                      1.5e-2, 4.2e-5 * expected);
    }
}

// A convex mirror in parallel light: I = E R^2 / 4 x reflectance, in every direction; seen from
// the sun's side the reflection is normal. A lobe of rms slope m: E R^2 / 2 x integral of D F sin
// over the hemisphere, by quadrature here.
TEST(NearMirror, SphereInTheSun) {
  const double radius_rad = 0.266 * kPi / 180;
  const Mesh ball = generated("sphere", 1000000);
  for (const double m : {0.008, 0.02, 0.1}) {
    const auto simulator = simulator_of(scene_of(ball, mirror(m), mwir()));
    const AimedView view = make_aimed_view(simulator->target(), {0, 0, 1e6});
    const PathTracer tracer(simulator->target(), simulator->materials(), view,
                            lit_by({{{1, 0, 0}, radius_rad}}),
                            settings(1, m < 0.05 ? 1u << 18 : 1u << 17));
    PathCounts counts;
    const Estimate e = traced(tracer, counts, [&](const PathWeights& w) {
      return weight(tracer, w, tracer.layout().sun(0));
    });
    double expected = 0;
    const int steps = 100000;
    for (int i = 0; i < steps; ++i) {
      const double theta = (i + 0.5) / steps * kPi / 2, c = std::cos(theta), t = std::tan(theta);
      const double d = std::exp(-t * t / (m * m)) / (kPi * m * m * c * c * c * c);
      // wi = wo: cos_d = 1, and the V-groove's min(1, 2 cos^2).
      expected += kPi / 2 / steps * 2 * kPi * std::sin(theta) * d * kNormalReflectance *
                  std::min(1.0, 2 * c * c) / 4;
    }
    expect_within_t(e, expected, kRows, "sphere in the sun, m " + std::to_string(m), 3e-2,
                    2e-3 * expected);
  }
}

// Aimed rays alone and both ways together agree where both work.
TEST(NearMirror, BothWaysOfFindingTheSunAgree) {
  const auto simulator =
      simulator_of(scene_of(generated("sphere", 1000000), mirror(0.008), mwir()));
  const AimedView view = make_aimed_view(simulator->target(), {30, 0, 1e6});
  Estimate e[2];
  for (const bool by_chance : {false, true}) {
    PathSettings s = settings(1, 1u << 18);
    s.sun_disk_by_chance = by_chance;
    const PathTracer tracer(simulator->target(), simulator->materials(), view,
                            lit_by({{normalized(Vec<Body>{1, 0, -0.3}), 0.266 * kPi / 180}}), s);
    PathCounts counts;
    e[by_chance ? 1 : 0] = traced(tracer, counts, [&](const PathWeights& w) {
      return weight(tracer, w, tracer.layout().sun(0));
    });
  }
  const double sigma = std::hypot(e[0].stderr_, e[1].stderr_);
  EXPECT_LT(std::abs(e[0].value - e[1].value), student_t_bound(31, kRows) * sigma);
  EXPECT_LT(sigma, 0.05 * e[0].value);
}

// A lamp 1 m from the middle of a Lambert disk of radius 0.2 m: E cos_i (1 m / d)^2 at each point,
// the lamp of the same intensity in all directions.
TEST(Lamp, FiniteDistance) {
  const double rho = 0.6, size = 0.2, angle = 50 * kPi / 180;
  const auto simulator =
      simulator_of(scene_of(generated("disk", 20000, size), grey(1 - rho), mwir()));
  const AimedView view = make_aimed_view(simulator->target(), {20, 0, 1e5});
  const PathTracer tracer(simulator->target(), simulator->materials(), view,
                          lit_by({{{std::cos(angle), 0, std::sin(angle)}, 1e-3, 1.0}}),
                          settings(1, 1u << 14));
  PathCounts counts;
  const Estimate e = traced(tracer, counts, [&](const PathWeights& w) {
    return weight(tracer, w, tracer.layout().sun(0));
  });
  double expected = 0;  // over the disk
  const int rings = 400, sectors = 400;
  for (int i = 0; i < rings; ++i)
    for (int k = 0; k < sectors; ++k) {
      const double r = size * std::sqrt((i + 0.5) / rings), phi = 2 * kPi * (k + 0.5) / sectors;
      const Vec<Body> to_lamp{std::cos(angle), -r * std::cos(phi),
                              std::sin(angle) - r * std::sin(phi)};
      const double d = length(to_lamp);
      expected += kPi * size * size / (rings * sectors) * rho / kPi * std::cos(20 * kPi / 180) *
                  to_lamp.x / (d * d * d);
    }
  expect_within_t(e, expected, kRows, "lamp at 1 m", 1e-3, 3e-5 * expected);
}

// A near-mirror in front of a lamp: the image of the lamp stands as far behind the mirror, and
// fills its solid angle there: intensity towards a far sensor = reflectance x radiance x the part
// of the mirror through which the image is seen.
TEST(Lamp, SeenInANearMirror) {
  const auto simulator = simulator_of(scene_of(generated("disk", 2000, 0.5), mirror(1e-4), mwir()));
  const AimedView view = make_aimed_view(simulator->target(), {0, 0, 1e6});
  const double radius_rad = 0.05;  // 0.1 m at 2 m
  const PathTracer tracer(simulator->target(), simulator->materials(), view,
                          lit_by({{{1, 0, 0}, radius_rad, 2.0}}), settings(1, 1u << 14));
  PathCounts counts;
  const Estimate e = traced(tracer, counts, [&](const PathWeights& w) {
    return weight(tracer, w, tracer.layout().sun(0));
  });
  // Parallel light from the lamp's disk, radius 2 m x tan: the same area of the mirror; radiance =
  // intensity / area = E d^2 / area.
  const double area = kPi * std::pow(2 * std::tan(radius_rad), 2);
  expect_within_t(e, kNormalReflectance * (4 / area) * area, kRows, "lamp in a mirror", 1e-2,
                  1e-3 * 4 * kNormalReflectance);
}

// Weights by number of reflections add up to the whole; the background fills what the target does
// not.
TEST(PathSettings, OrdersAddUpAndTheBackgroundFillsTheRest) {
  SceneSpec scene = scene_of(generated("frigate", 5000), *builtin_material("hull_index"), mwir());
  scene.part = {
      {"ship", {"hull", "deck", "superstructure", "funnel", "mast", "turret"}, 0, false, false},
      {"hot", {"*_*"}, 0, false, true}};
  const auto simulator = simulator_of(scene);
  const Target& target = simulator->target();
  const Vec<Body> sensor = 3000.0 * normalized(Vec<Body>{1, 1, -0.5});
  const FootprintView footprint = make_footprint_view(target, sensor, {0, 0, -5}, 100, 30);
  PathSettings s = settings(6, 1024);
  s.background = true;
  const SourceGeometry suns = lit_by({{normalized(Vec<Body>{0, 1, -1}), 0.005}});
  const PathTracer whole(target, simulator->materials(), footprint.view, suns, s);
  s.by_order = true;
  const PathTracer orders(target, simulator->materials(), footprint.view, suns, s);
  PathCounts counts[2];
  const auto a = whole.trace(counts[0]);
  const auto b = orders.trace(counts[1]);
  EXPECT_EQ(counts[0].rays, counts[1].rays);
  double largest_order = 0, background = 0;
  for (std::size_t r = 0; r < a.size(); ++r) {
    ASSERT_EQ(b[r].of_order.size(), 7u);
    double behind = 0;
    for (std::uint32_t f = 0; f < whole.firsts(); ++f)
      for (const SourceId id : whole.layout().all())
        for (std::size_t k = 0; k < whole.nodes(); ++k) {
          double sum = 0;
          for (const SourceWeights& of_order : b[r].of_order) sum += of_order.value(f, id, k);
          const double value = a[r].weight.value(f, id, k);
          const double of_last = b[r].of_order[6].value(f, id, k);
          EXPECT_NEAR(sum, value, 1e-9 * value);
          largest_order = std::max(largest_order, of_last);
          EXPECT_EQ(a[r].last.value(f, id, k), of_last);
          if (f == target.part.size()) behind += value;
        }
    EXPECT_NEAR(behind + a[r].projected_area_m2, footprint.footprint_m2,
                2e-3 * footprint.footprint_m2);
    background += behind;
  }
  EXPECT_GT(largest_order, 0);
  EXPECT_GT(background, 0);
}

// Two coaxial disks, radii a and b at a distance h, facing each other; the second is hot. Seen
// from far, cos_o from the normal of the first: what that reflects is rho cos_o x the flux / pi =
// rho cos_o A2 F21 eps B, F21 from the closed form.
struct HotDisk {
  double a, b, h;
  [[nodiscard]] double area_f() const {
    const double x = 1 + (h * h + b * b) / (a * a);
    return kPi * a * a * 0.5 * (x - std::sqrt(x * x - 4 * (b / a) * (b / a)));
  }
  [[nodiscard]] Mesh mesh() const {
    // The generated disk faces +x.
    Mesh hot = generated("disk", 400, b);
    for (auto& v : hot.vertex) v = {h - v.x, v.y, -v.z};
    return joined(generated("disk", 20000, a), hot, "hot_");
  }
};

TEST(HotParts, AimedAtWhatADiskReceives) {
  const HotDisk disks{1, 0.06, 1};  // a tenth of a per cent of the hemisphere
  for (const bool two_sided : {false, true})
    for (const bool hot_lights : {false, true}) {
      SceneSpec scene = scene_of(disks.mesh(), grey(0.4), mwir());
      scene.material.push_back({"hot", Lambert{{{0, 0.9}}}});
      scene.part = {{"plate", {"disk"}, 0, false, false}, {"hot", {"hot_*"}, 1, two_sided, true}};
      const auto simulator = simulator_of(scene);
      // From the side: the small disk hides nothing of the plate.
      const double elevation_deg = 60;
      const AimedView view = make_aimed_view(simulator->target(), {0, elevation_deg, 1e6});
      PathSettings s = settings(3, hot_lights ? 1u << 16 : 1u << 14);
      s.hot_lights = hot_lights;
      const PathTracer tracer(simulator->target(), simulator->materials(), view, {}, s);
      PathCounts counts;
      const Estimate e = traced(tracer, counts, [&](const PathWeights& w) {
        return w.weight.value(0, tracer.layout().reflected(1));  // first seen: the plate
      });
      // Light that goes to and fro between the disks: F12 F21 rho1 rho2 = 1e-6, beyond.
      const double expected =
          0.6 * std::cos(elevation_deg * kPi / 180) * 0.9 * disks.area_f() / kPi * kPi;
      expect_within_t(e, expected, kRows,
                      std::string("hot disk ") + (two_sided ? "two-sided" : "one-sided") +
                          (hot_lights ? ", aimed at" : ", by chance"),
                      hot_lights ? 2e-3 : 5e-2, 3e-4 * expected);
    }
}

// Directional emission and a lobe that is not diffuse: aiming and chance agree.
TEST(HotParts, BothWaysAgreeOnTheFrigate) {
  for (const char* const kind : {"hull", "hull_index"}) {
    SceneSpec scene = scene_of(generated("frigate", 5000), *builtin_material(kind), mwir());
    scene.part = {
        {"ship", {"hull", "deck", "superstructure", "funnel", "mast", "turret"}, 0, false, false},
        {"hot", {"*_*"}, 0, true, true}};
    const auto simulator = simulator_of(scene);
    const AimedView view = make_aimed_view(simulator->target(), {40, 30, 5000});
    Estimate e[2];
    for (const bool hot_lights : {false, true}) {
      PathSettings s = settings(5, 1u << 16);
      s.hot_lights = hot_lights;
      SourceGeometry sources;
      sources.boundary = Sea{{-simulator->target().centre.z, 0}};
      const PathTracer tracer(simulator->target(), simulator->materials(), view, sources, s);
      PathCounts counts;
      e[hot_lights ? 1 : 0] = traced(tracer, counts, [&](const PathWeights& w) {
        return weight(tracer, w, tracer.layout().reflected(1));
      });
    }
    std::printf("%s: hot parts by chance %.5g +- %.2g, aimed at %.5g +- %.2g m2\n", kind,
                e[0].value, e[0].stderr_, e[1].value, e[1].stderr_);
    const double sigma = std::hypot(e[0].stderr_, e[1].stderr_);
    EXPECT_LT(std::abs(e[0].value - e[1].value), student_t_bound(31, kRows) * sigma) << kind;
    EXPECT_LT(e[1].stderr_, e[0].stderr_) << kind;
  }
}

// A concave scene of two materials, one diffuse and one a narrow lobe, in an isothermal world: what
// comes out is black whatever the order of reflections.
TEST(WhiteFurnace, TwoMaterialsInACorner) {
  Mesh corner;
  corner.group = {"floor", "wall"};
  corner.vertex = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 1, -1}};
  corner.triangle = {{0, 2, 1}, {0, 3, 2}, {0, 4, 5}, {0, 5, 3}};
  corner.triangle_group = {0, 0, 1, 1};
  for (const double m : {1e-4, 0.01, 0.3}) {
    SceneSpec scene = scene_of(corner, grey(0.3), lwir());
    scene.material.push_back(mirror(m));
    scene.part = {{"floor", {"floor"}, 0, true, false}, {"wall", {"wall"}, 1, true, false}};
    const auto simulator = simulator_of(scene);
    ViewRequest r = request(*simulator, 20, 30, 1e5, {300, 300});
    r.condition[0].surroundings = {SurroundingsKind::kSea, 300, 0, 300, 1, 0};
    r.max_reflections = 60;
    const auto view = simulator->simulate(r);
    ASSERT_TRUE(view.ok()) << view.status();
    const SignatureResult& s = view->row[0];
    const double expected = planck_band_radiance_w_m2_sr(8, 12, 300) * s.projected_area_m2.value;
    expect_within_t(s.intensity_w_sr, expected, kRows, "corner, m " + std::to_string(m), 5e-3,
                    2e-4 * expected);
  }
}

}  // namespace
}  // namespace irsig
