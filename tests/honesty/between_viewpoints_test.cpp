// Rationale: no interpolated value may lie beyond what its stated error explains, even if sides and
// viewpoints have common factors, or a plate is seen edge-on exactly at a viewpoint; and the error
// must not be so wide that it is of no use. Expected: in each family of bodies and viewpoints, no
// value beyond 5 stated errors and a root mean square of 0.2 to 1.3 (of smooth fields less).
// Source: closed forms of black bodies (convex_bodies.h), convex ones and some that hide parts of
// themselves, sampled with the standard errors that are stated of them; the rows pass through the
// code of `irsig query --interpolate`.
//
// IRSIG_BETWEEN_SCENES: scenes of each family (20). docs/evidence/stability.md has the table of
// 200.
#include <gmock/gmock.h>

#include <cstdlib>
#include <functional>
#include <numeric>
#include <string>

#include "convex_bodies.h"
#include "view/query/interpolate_rows.h"

namespace irsig {
namespace {

struct Aspect {
  double azimuth_deg, elevation_deg;
};

struct Scene {
  std::vector<Viewpoint> viewpoint;
  std::vector<Aspect> asked;
  ConvexBody body;
  // Instead of a convex body: its intensity less that of the background it hides.  [W/sr]
  std::function<double(Vec<Body>, double background_w_m2_sr)> other = {};
  std::vector<double> relative_noise = {0, 1e-3, 1e-3, 5e-3};
  double noisy_fraction = 0;  // of the viewpoints, with a standard error of 30 %
};

constexpr int kAspects = 5;

Aspect aspect_of(Vec<Body> d) {
  constexpr double kDeg = 180 / std::numbers::pi;
  return {std::atan2(d.y, d.x) * kDeg, std::asin(std::clamp(-d.z, -1.0, 1.0)) * kDeg};
}

// Rings of equal steps, and aspects that lie half way between two of their viewpoints, a quarter,
// or anywhere.
struct Rings {
  double step_deg;
  std::vector<double> elevation_deg;

  [[nodiscard]] std::vector<Viewpoint> viewpoints() const {
    return ring_viewpoints(static_cast<std::uint32_t>(std::lround(360 / step_deg)), elevation_deg,
                           5000);
  }
  [[nodiscard]] std::vector<Aspect> between(SceneRandom& random) const {
    std::vector<Aspect> out;
    for (int i = 0; i < kAspects; ++i) {
      double elevation = any_of(random, elevation_deg);
      if (std::abs(elevation) == 90) elevation *= 5.0 / 6;
      if (happens(random, 0.3)) elevation += uniform(random, -5, 5);
      const double step = std::floor(uniform(random, 0, 360 / step_deg));
      const double of_step = any_of<double>(random, {0.5, 0.5, 0.25, 0.1, uniform(random, 0, 1)});
      out.push_back({(step + of_step) * step_deg, elevation});
    }
    return out;
  }
};

Rings any_rings(SceneRandom& random) {
  return {any_of<double>(random, {5, 10, 15, 20, 30, 45}),
          any_of<std::vector<double>>(random, {{0, 10, 20},
                                               {0},
                                               {-20, -10, 0, 10, 20},
                                               {5, 25, 45},
                                               {0, 30, 60, 90},
                                               {-90, -60, -30, 0, 30, 60, 90}})};
}
Rings grid(SceneRandom& random, double azimuth_step_deg, double elevation_step_deg) {
  Rings out{azimuth_step_deg, {}};
  for (double e = happens(random, 0.5) ? -90 : 0; e <= 90; e += elevation_step_deg)
    out.elevation_deg.push_back(e);
  return out;
}
std::vector<Viewpoint> any_fibonacci(SceneRandom& random) {
  const auto count = any_of<std::uint32_t>(random, {24, 48, 96, 191, 400});
  return happens(random, 0.5) ? fibonacci_viewpoints(count, 5000, 0, 90)
                              : fibonacci_viewpoints(std::min(2 * count, 400U), 5000, -90, 90);
}
std::vector<Viewpoint> with_cluster(SceneRandom& random) {
  std::vector<Viewpoint> out = any_fibonacci(random);
  const double azimuth = uniform(random, 0, 360), elevation = uniform(random, 0, 70);
  for (int i = 0; i < 40; ++i)
    out.push_back({std::fmod(azimuth + uniform(random, -15, 15) + 720, 360),
                   elevation + uniform(random, -10, 10), 5000});
  return out;
}
std::vector<Aspect> anywhere(SceneRandom& random) {
  std::vector<Aspect> out;
  for (int i = 0; i < kAspects; ++i) out.push_back(aspect_of(any_direction(random)));
  return out;
}

int any_sides(SceneRandom& random) {
  return any_of<int>(random, {2, 2, 3, 4, 5, 6, 8, 9, 10, 12, 15, 16, 18, 20, 24});
}
double any_height(SceneRandom& random) { return 6 * std::exp(uniform(random, -1, 1.5)); }
ConvexBody any_box(SceneRandom& random, double azimuth_deg) {
  return upright_box(uniform(random, 2, 100), uniform(random, 2, 20), uniform(random, 2, 20),
                     azimuth_deg);
}
ConvexBody tilted_at_times(ConvexBody body, SceneRandom& random, double probability) {
  return happens(random, probability) ? tilted(std::move(body), random) : body;
}
ConvexBody any_body(SceneRandom& random) {
  const double azimuth = 15 * std::floor(uniform(random, 0, 24)) +
                         any_of<double>(random, {0, 7.5, uniform(random, 0, 15)});
  const double kind = uniform(random, 0, 3);
  return tilted_at_times(kind < 1   ? upright_prism(any_sides(random), azimuth, any_height(random))
                         : kind < 2 ? upright_cylinder(any_height(random))
                                    : any_box(random, azimuth),
                         random, 0.4);
}
// Makes a ship of many bodies that do not hide each other.
ConvexBody any_ship(SceneRandom& random) {
  ConvexBody out;
  for (int left = static_cast<int>(uniform(random, 4, 12)); left > 0; --left) {
    const ConvexBody part =
        happens(random, 0.6) ? upright_box(uniform(random, 5, 60), uniform(random, 5, 20),
                                           uniform(random, 2, 10), uniform(random, -5, 5))
        : happens(random, 0.5)
            ? upright_cylinder(any_height(random))
            : tilted(upright_prism(any_sides(random), 0, any_height(random)), random);
    out.facet.insert(out.facet.end(), part.facet.begin(), part.facet.end());
    out.cylinder.insert(out.cylinder.end(), part.cylinder.begin(), part.cylinder.end());
  }
  return out;
}
// Two black spheres of 1 m, of which one hides a part of the other: the union of two disks.
using NotConvex = std::function<double(Vec<Body>, double)>;
NotConvex two_spheres(SceneRandom& random) {
  const double apart = uniform(random, 0.5, 3);
  const Vec<Body> axis = any_direction(random);
  return [=](Vec<Body> d, double background) {
    const double along = dot(axis, d), r = apart * std::sqrt(std::max(0.0, 1 - along * along));
    return (kBodyRadiance - background) * (2 * std::numbers::pi - lens_m2(r));
  };
}
// A box on another one, of which each hides a part of the other: an L, a T, a ship with a
// deckhouse. Its parts may be as warm as each other or not.
NotConvex two_boxes(SceneRandom& random, double azimuth_deg) {
  const double length = uniform(random, 2, 60), width = uniform(random, 2, 15),
               height = uniform(random, 2, 15), share = uniform(random, 0.1, 0.9),
               above = uniform(random, 2, 30);
  const double turn = azimuth_deg * std::numbers::pi / 180;
  Frame frame{{std::cos(turn), std::sin(turn), 0}, {-std::sin(turn), std::cos(turn), 0}, {0, 0, 1}};
  if (happens(random, 0.5)) frame = any_frame(random);
  const double across = happens(random, 0.5) ? 1 : uniform(random, 0.2, 1);
  const double at = happens(random, 0.5) ? 0.5 * (1 - share) * length : 0;  // an L or a T
  const SolidBox low{{0, 0, 0.5 * height}, {0.5 * length, 0.5 * width, 0.5 * height}},
      high{{at, 0, -0.5 * above}, {0.5 * share * length, 0.5 * across * width, 0.5 * above}};
  const double low_radiance = kBodyRadiance * any_of<double>(random, {1, 1, 0.5, 3}),
               high_radiance = kBodyRadiance * any_of<double>(random, {1, 1, 0.5, 3});
  return [=](Vec<Body> d, double background) {
    const std::vector<PlanePoint> below = outline(low, frame, d), over = outline(high, frame, d);
    const double hidden = area_m2(common(below, over));
    const bool high_in_front = dot(frame.z, d) < 0;
    return (low_radiance - background) * (area_m2(below) - (high_in_front ? hidden : 0)) +
           (high_radiance - background) * (area_m2(over) - (high_in_front ? 0 : hidden));
  };
}
// A cylinder with a round hole in one end, whose floor is hot: a funnel, an exhaust. Its light
// leaves one way.
NotConvex hot_floor(SceneRandom& random, double narrowest) {
  const Vec<Body> axis = happens(random, 0.3) ? Vec<Body>{0, 0, -1} : any_direction(random);
  const double radius = uniform(random, 0.3, 2.5), height = any_height(random),
               deep = radius * std::exp(uniform(random, std::log(0.2), std::log(narrowest)));
  const double wall = kBodyRadiance * uniform(random, 0.8, 1.5),
               floor = kBodyRadiance * std::exp(uniform(random, 0, 3));
  return [=](Vec<Body> d, double background) {
    const double along = dot(axis, d), square = std::max(0.0, 1 - along * along);
    double sum = (kBodyRadiance - background) *
                 (6 * height * std::sqrt(square) + 9 * std::numbers::pi * std::abs(along));
    if (along <= 0) return sum;
    const double seen =
        radius * radius * lens_m2(deep / radius * std::sqrt(square) / along) * along;
    return sum + (wall - kBodyRadiance) * std::numbers::pi * radius * radius * along +
           (floor - wall) * seen;
  };
}
// Plates that shine on one side and are 0 K on the other: many rows are 0.
ConvexBody one_sided(SceneRandom& random) {
  ConvexBody out;
  for (int left = static_cast<int>(uniform(random, 1, 4)); left > 0; --left)
    out.facet.push_back({happens(random, 0.5)
                             ? body_from_aspect(7.5 * std::floor(uniform(random, 0, 48)),
                                                any_of<double>(random, {0, 0, 30, 90, -90}))
                             : any_direction(random),
                         uniform(random, 1, 50), kBodyRadiance});
  return out;
}
// A wide, flat body, level or nearly so: dark in its own plane, bright beside it.
ConvexBody raft(SceneRandom& random) {
  ConvexBody out =
      upright_box(uniform(random, 10, 60), uniform(random, 10, 60),
                  std::exp(uniform(random, std::log(0.01), 0)), uniform(random, 0, 90));
  const double tilt = any_of<double>(random, {0, uniform(random, 0, 10), uniform(random, 0, 10)}) *
                      std::numbers::pi / 180;
  const Frame frame{
      {1, 0, 0}, {0, std::cos(tilt), std::sin(tilt)}, {0, -std::sin(tilt), std::cos(tilt)}};
  for (auto& f : out.facet) f.normal = frame.turned(f.normal);
  return out;
}
std::vector<Viewpoint> at_random(SceneRandom& random, int count) {
  std::vector<Viewpoint> out;
  for (int i = 0; i < count; ++i) {
    const Aspect a = aspect_of(any_direction(random));
    out.push_back({std::fmod(a.azimuth_deg + 360, 360), a.elevation_deg, 5000});
  }
  return out;
}
std::vector<Aspect> near_a_pole(SceneRandom& random, double within_deg) {
  std::vector<Aspect> out;
  for (int i = 0; i < kAspects; ++i)
    out.push_back({any_of<double>(random, {0, 90, 7.5, uniform(random, 0, 360)}),
                   90 - any_of<double>(random, {0, uniform(random, 0, within_deg)})});
  return out;
}

struct Family {
  const char* name;
  std::function<Scene(SceneRandom&)> scene;
  double least_rms = 0.2;  // stated errors of less use are wider
};

Scene on_rings(ConvexBody body, const Rings& rings, SceneRandom& random) {
  return {rings.viewpoints(), rings.between(random), std::move(body)};
}

const std::vector<Family>& families() {
  static const std::vector<Family> all = {
      {"prisms on rings, factors in common",
       [](SceneRandom& r) {
         const Rings rings = any_rings(r);
         const int count = static_cast<int>(std::lround(360 / rings.step_deg));
         int sides = any_sides(r);
         while (std::gcd(sides, count) == 1) sides = any_sides(r);
         const double phase = any_of<double>(r, {0, 0.25, 0.5}) * rings.step_deg;
         return on_rings(
             upright_prism(sides, phase + (happens(r, 0.5) ? 180.0 / sides : 0), any_height(r)),
             rings, r);
       }},
      {"prisms on rings, any phase",
       [](SceneRandom& r) {
         const Rings rings = any_rings(r);
         return on_rings(upright_prism(any_sides(r), uniform(r, 0, 360), any_height(r)), rings, r);
       }},
      {"prisms on rings, tilted",
       [](SceneRandom& r) {
         const Rings rings = any_rings(r);
         return on_rings(tilted(upright_prism(any_sides(r), 0, any_height(r)), r), rings, r);
       }},
      {"plates on rings, edge-on at or between viewpoints",
       [](SceneRandom& r) {
         const Rings rings = any_rings(r);
         const double step =
             std::floor(uniform(r, 0, 360 / rings.step_deg)) + any_of<double>(r, {0, 0, 0.5});
         return on_rings(upright_prism(2, 90 + step * rings.step_deg, any_height(r)), rings, r);
       }},
      {"cylinders on rings",
       [](SceneRandom& r) {
         const Rings rings = any_rings(r);
         return on_rings(tilted_at_times(upright_cylinder(any_height(r)), r, 0.7), rings, r);
       }},
      {"boxes on rings",
       [](SceneRandom& r) {
         const Rings rings = any_rings(r);
         const double azimuth = any_of<double>(r, {0, 0.5 * rings.step_deg, uniform(r, 0, 90)});
         return on_rings(tilted_at_times(any_box(r, azimuth), r, 0.3), rings, r);
       }},
      {"any body, one ring above the horizon",
       [](SceneRandom& r) {
         const Rings rings{any_of<double>(r, {5, 10, 15, 20, 30, 45}),
                           {any_of<double>(r, {5, 10, 20, 40, 60})}};
         return on_rings(any_body(r), rings, r);
       }},
      {"any body on grids",
       [](SceneRandom& r) {
         const Rings rings =
             grid(r, any_of<double>(r, {5, 10, 15, 30}), any_of<double>(r, {10, 15, 30}));
         return on_rings(any_body(r), rings, r);
       }},
      {"plates on grids of 15 deg",
       [](SceneRandom& r) {
         const double azimuth = 7.5 * std::floor(uniform(r, 0, 24));
         return on_rings(tilted_at_times(upright_prism(2, azimuth, any_height(r)), r, 0.5),
                         grid(r, 15, 15), r);
       }},
      {"prisms, Fibonacci sets",
       [](SceneRandom& r) {
         return Scene{any_fibonacci(r), anywhere(r),
                      tilted_at_times(
                          upright_prism(any_sides(r), uniform(r, 0, 360), any_height(r)), r, 0.5)};
       }},
      {"plates, Fibonacci sets",
       [](SceneRandom& r) {
         return Scene{any_fibonacci(r), anywhere(r),
                      tilted_at_times(upright_prism(2, uniform(r, 0, 360), any_height(r)), r, 0.5)};
       }},
      {"cylinders, Fibonacci sets",
       [](SceneRandom& r) {
         return Scene{any_fibonacci(r), anywhere(r),
                      tilted_at_times(upright_cylinder(any_height(r)), r, 0.6)};
       }},
      {"boxes, Fibonacci sets",
       [](SceneRandom& r) {
         return Scene{any_fibonacci(r), anywhere(r),
                      tilted_at_times(any_box(r, uniform(r, 0, 360)), r, 0.3)};
       }},
      {"ships, Fibonacci sets",
       [](SceneRandom& r) {
         return Scene{any_fibonacci(r), anywhere(r), any_ship(r)};
       }},
      {"any body, sets with clusters",
       [](SceneRandom& r) {
         return Scene{with_cluster(r), anywhere(r), any_body(r)};
       }},
      {"two spheres, Fibonacci sets (not convex)",
       [](SceneRandom& r) {
         return Scene{any_fibonacci(r), anywhere(r), {}, two_spheres(r)};
       }},
      {"two spheres on rings (not convex)",
       [](SceneRandom& r) {
         const Rings rings = any_rings(r);
         return Scene{rings.viewpoints(), rings.between(r), {}, two_spheres(r)};
       }},
      {"hot spots, Fibonacci sets (not convex)",
       [](SceneRandom& r) {
         const Vec<Body> towards = any_direction(r);
         const double narrow = uniform(r, 1, 8), height = uniform(r, 0.1, 4);
         return Scene{any_fibonacci(r), anywhere(r), {}, [=](Vec<Body> d, double) {
                        return 1 + height * std::exp(-narrow * (1 - dot(towards, d)));
                      }};
       },
       // Smooth: what facets could hide, but none does, is stated all the same.
       0.08},
      {"two boxes on rings (not convex)",
       [](SceneRandom& r) {
         const Rings rings = any_rings(r);
         const double azimuth = any_of<double>(r, {0, 0.5 * rings.step_deg, uniform(r, 0, 90)});
         return Scene{rings.viewpoints(), rings.between(r), {}, two_boxes(r, azimuth)};
       }},
      {"two boxes, Fibonacci sets (not convex)",
       [](SceneRandom& r) {
         return Scene{any_fibonacci(r), anywhere(r), {}, two_boxes(r, uniform(r, 0, 360))};
       }},
      {"hot floors of holes on rings (not convex)",
       [](SceneRandom& r) {
         const Rings rings = any_rings(r);
         return Scene{rings.viewpoints(), rings.between(r), {}, hot_floor(r, 8)};
       }},
      {"hot floors of holes, Fibonacci sets (not convex)",
       [](SceneRandom& r) {
         return Scene{any_fibonacci(r), anywhere(r), {}, hot_floor(r, 8)};
       }},
      {"any body, viewpoints at random",
       [](SceneRandom& r) {
         const int count = static_cast<int>(20 * std::exp(uniform(r, 0, 3)));
         return Scene{at_random(r, count), anywhere(r), any_body(r)};
       }},
      {"any body, poles of grids",
       [](SceneRandom& r) {
         const Rings rings =
             grid(r, any_of<double>(r, {5, 10, 15, 30}), any_of<double>(r, {10, 15, 30}));
         return Scene{rings.viewpoints(), near_a_pole(r, 15), any_body(r)};
       }},
      {"plates that shine on one side, rings",
       [](SceneRandom& r) {
         const Rings rings = any_rings(r);
         return on_rings(one_sided(r), rings, r);
       }},
      {"plates that shine on one side, Fibonacci sets",
       [](SceneRandom& r) {
         return Scene{any_fibonacci(r), anywhere(r), one_sided(r)};
       }},
      {"rafts on rings",
       [](SceneRandom& r) {
         Rings rings = any_rings(r);
         if (happens(r, 0.4)) rings.elevation_deg = {happens(r, 0.5) ? 0.0 : -1.0, 0.5};
         return on_rings(raft(r), rings, r);
       }},
      {"rafts, one ring above the horizon",
       [](SceneRandom& r) {
         const Rings rings{any_of<double>(r, {5, 10, 15, 20, 30, 45}),
                           {any_of<double>(r, {1, 3, 5, 10, 20, 40, 60})}};
         return on_rings(raft(r), rings, r);
       }},
      {"rafts, Fibonacci sets",
       [](SceneRandom& r) {
         return Scene{any_fibonacci(r), anywhere(r), raft(r)};
       }},
      {"any body, large standard errors, rings",
       [](SceneRandom& r) {
         const Rings rings = any_rings(r);
         Scene out = on_rings(any_body(r), rings, r);
         out.relative_noise = {0.02, 0.05, 0.2, 0.5};
         return out;
       }},
      {"any body, large standard errors, Fibonacci sets",
       [](SceneRandom& r) {
         Scene out{any_fibonacci(r), anywhere(r), any_body(r)};
         out.relative_noise = {0.02, 0.05, 0.2, 0.5};
         return out;
       }},
      {"any body, one viewpoint in five of a large standard error",
       [](SceneRandom& r) {
         Scene out{any_fibonacci(r), anywhere(r), any_body(r)};
         out.noisy_fraction = 0.2;
         return out;
       }},
  };
  return all;
}

// Distances from the truth, in stated errors.
struct Distances {
  std::vector<double> z, relative_error;

  [[nodiscard]] double rms() const {
    double sum = 0;
    for (const double x : z) sum += x * x;
    return std::sqrt(sum / static_cast<double>(z.size()));
  }
  [[nodiscard]] double largest() const { return *std::max_element(z.begin(), z.end()); }
  [[nodiscard]] std::size_t beyond_five() const {
    return static_cast<std::size_t>(
        std::count_if(z.begin(), z.end(), [](double x) { return x > 5; }));
  }
  [[nodiscard]] double median_error() const {
    std::vector<double> e = relative_error;
    std::nth_element(e.begin(), e.begin() + static_cast<std::ptrdiff_t>(e.size() / 2), e.end());
    return e[e.size() / 2];
  }
};

class Between : public testing::TestWithParam<std::size_t> {};

TEST_P(Between, NoValueBeyondFiveErrorsAndErrorsOfUse) {
  const Family& family = families()[GetParam()];
  const char* asked = std::getenv("IRSIG_BETWEEN_SCENES");
  const char* printed = std::getenv("IRSIG_BETWEEN_ROWS");
  const int scenes = asked ? std::atoi(asked) : 20;
  Distances intensity, contrast;
  for (int n = 0; n < scenes; ++n) {
    SceneRandom random(1000 * (GetParam() + 1) + static_cast<std::uint64_t>(n));
    Scene scene = family.scene(random);
    const double noise = any_of(random, scene.relative_noise);
    const double background = kBodyRadiance * uniform(random, 0.3, 1.7);
    if (happens(random, 0.5)) {  // a body of many temperatures
      for (auto& f : scene.body.facet) f.radiance_w_m2_sr *= uniform(random, 0.5, 1.5);
      for (auto& c : scene.body.cylinder) c.radiance_w_m2_sr *= uniform(random, 0.5, 1.5);
    }
    const auto truth = [&](Vec<Body> d, bool is_contrast) {
      return scene.other ? scene.other(d, is_contrast ? background : 0)
                         : scene.body.contrast_w_sr(d, is_contrast ? background : 0);
    };
    std::normal_distribution<double> normal;
    std::vector<StoredSignature> rows;
    for (const Viewpoint& v : scene.viewpoint) {
      StoredSignature s{};
      const Vec<Body> d = body_from_aspect(v.aspect_azimuth_deg, v.aspect_elevation_deg);
      s.row = rows.size() + 1;
      s.range_m = v.range_m;
      s.aspect_azimuth_deg = v.aspect_azimuth_deg;
      s.aspect_elevation_deg = v.aspect_elevation_deg;
      std::tie(s.unit_x, s.unit_y, s.unit_z) = std::tuple(d.x, d.y, d.z);
      // The samples of an emitter's contrast are those of its intensity.
      const bool is_noisy = scene.noisy_fraction > 0 && happens(random, scene.noisy_fraction);
      const double sigma = (is_noisy ? 0.3 : noise) * truth(d, false), off = sigma * normal(random);
      s.intensity_w_sr = truth(d, false) + off;
      s.contrast_intensity_w_sr = truth(d, true) + off;
      for (auto field :
           {&StoredSignature::intensity_stderr_w_sr, &StoredSignature::numerical_error_w_sr,
            &StoredSignature::contrast_intensity_stderr_w_sr,
            &StoredSignature::contrast_numerical_error_w_sr})
        s.*field = sigma;
      rows.push_back(s);
    }
    for (const Aspect& a : scene.asked) {
      const Vec<Body> d = body_from_aspect(a.azimuth_deg, a.elevation_deg);
      const auto got = interpolate_rows(rows, {a.azimuth_deg, a.elevation_deg});
      if (absl::IsOutOfRange(got.status())) continue;  // not between viewpoints
      ASSERT_TRUE(got.ok()) << got.status();
      const StoredSignature& s = got->front().signature;
      const auto add = [&](Distances& to, double value, double error, bool is_contrast) {
        const double off = std::abs(value - truth(d, is_contrast));
        const double scale = 1e-9 * std::abs(truth(d, false)) + 1e-12;  // rounding
        to.z.push_back(off / std::hypot(error, scale));
        to.relative_error.push_back(error / std::max(scale, std::abs(truth(d, false))));
        EXPECT_LE(to.z.back(), 5) << (is_contrast ? "contrast, scene " : "scene ") << n
                                  << ", aspect " << a.azimuth_deg << "," << a.elevation_deg << ", "
                                  << rows.size() << " viewpoints: " << value << " +- " << error
                                  << ", closed form " << truth(d, is_contrast);
        if (!printed) return;
        const SphereFit& fit = got->front().interpolation->fit;
        std::vector<double> v, e;
        for (const StoredSignature& from : got->front().interpolation->from) {
          v.push_back(is_contrast ? from.contrast_intensity_w_sr : from.intensity_w_sr);
          e.push_back(from.intensity_stderr_w_sr);
        }
        const SphereEstimate x =
            estimate_of(is_contrast ? FieldKind::kSignedFacets : FieldKind::kFacets, fit, v, e);
        std::printf("ROW|%s%s|%d|%zu|%g|%g|%.9g|%.9g|%.9g|%.9g|%.9g\n", family.name,
                    is_contrast ? ", contrast" : "", n, rows.size(), a.azimuth_deg, a.elevation_deg,
                    value, x.value_stderr, x.rough_error, x.hidden_error, truth(d, is_contrast));
      };
      add(intensity, s.intensity_w_sr, s.numerical_error_w_sr, false);
      add(contrast, s.contrast_intensity_w_sr, s.contrast_numerical_error_w_sr, true);
    }
  }
  for (const Distances* of : {&intensity, &contrast}) {
    if (of->z.empty()) continue;
    std::printf("| %s%s | %zu | %.2f | %.1f | %zu | %.2g %% |\n", family.name,
                of == &contrast ? ", contrast" : "", of->z.size(), of->rms(), of->largest(),
                of->beyond_five(), 100 * of->median_error());
    EXPECT_GE(of->z.size(), 2 * static_cast<std::size_t>(scenes));
    EXPECT_LE(of->rms(), 1.3);
    EXPECT_GE(of->rms(), family.least_rms);
  }
}

INSTANTIATE_TEST_SUITE_P(Families, Between, testing::Range<std::size_t>(0, families().size()));

}  // namespace
}  // namespace irsig
