// Rationale: closed forms are linear or lumped; weather, shadows, natural convection, five layers
// and two open faces together have none. Expected: faces of 50 random walls over 48 h within 10 mK
// of CVODE on two grids, at the default accuracy; stated errors cover the true ones in 95 % of the
// hours and are not, in the median, 50 times too wide. Source: SUNDIALS' CVODE on an independent
// discretisation (cvode_wall.h), extrapolated from two grids whose difference is part of the bound.
#include <algorithm>
#include <cstdio>
#include <random>

#include "tests/physics/cvode_wall.h"
#include "tests/physics/wall_run.h"

namespace irsig {
namespace {

using namespace wall;
constexpr std::size_t kHours = 48;

struct RandomWall {
  std::vector<Layer> layers;
  InnerSide side;
  FaceProperties outer, inner;
  std::vector<std::array<Weather, 4>> hour;  // outer begin, end; inner begin, end
};

RandomWall random_wall(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(random);
  };
  const auto spread = [&](double low, double high) {
    return low * std::pow(high / low, uniform(0, 1));
  };
  RandomWall w;
  constexpr InnerSide kSides[] = {InnerSide::kAdiabatic, InnerSide::kHeatFlux, InnerSide::kAir,
                                  InnerSide::kFixedTemperature, InnerSide::kOpen};
  w.side = kSides[seed % 5];
  const bool sheet = seed % 10 == 4;  // thin, two open faces
  const std::size_t count = sheet ? 1 + seed % 3 : 1 + random() % 5;
  for (std::size_t i = 0; i < count; ++i) {
    w.layers.push_back({sheet ? spread(2e-5, 1e-3) : spread(1e-4, 0.2), spread(0.03, 200),
                        spread(30, 8000), uniform(400, 2000)});
  }
  const auto convection = [&] {
    const std::uint64_t kind = random() % 3;
    return kind == 0 ? kMowitt : kind == 1 ? tarp_natural(uniform(-1, 1)) : kForcedOnly;
  };
  w.outer = {uniform(0.05, 0.97), convection()};
  w.inner = {uniform(0.05, 0.97), convection()};
  const double sun = uniform(0, 900), inside_k = uniform(280, 320), machine = uniform(-20, 100);
  std::vector<Weather> knot, back;
  for (std::size_t i = 0; i <= kHours; ++i) {
    const double hour = static_cast<double>(i);
    const double high = std::sin((hour - 6) * 0.2617993877991494);
    Weather a{sun * std::max(0.0, high) * uniform(0.3, 1), uniform(220, 400),
              288 + 6 * high + uniform(-1, 1), spread(0.5, 30)};
    knot.push_back(a);
    Weather b{machine + uniform(-5, 5), uniform(350, 450), inside_k + uniform(-1, 1),
              spread(1, 10)};
    back.push_back(w.side == InnerSide::kOpen ? a : b);
    if (w.side == InnerSide::kOpen) back.back().absorbed_w_m2 *= 0.2;
  }
  for (std::size_t i = 0; i < kHours; ++i) {
    std::array<Weather, 4> h{knot[i], knot[i + 1], back[i], back[i + 1]};
    if (uniform(0, 1) < 0.2) {  // a shadow, with edges
      for (std::size_t end = 0; end < 2; ++end) h[end].absorbed_w_m2 *= 0.2;
    }
    if (uniform(0, 1) < 0.1) h[1] = h[0];  // a record that is a mean
    w.hour.push_back(h);
  }
  return w;
}

TEST(Heat, AgreesWithCvode) {
  double largest_k = 0;
  std::vector<double> too_wide;
  std::size_t covered = 0, all = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const RandomWall w = random_wall(seed);
    std::vector<double> knot_s;
    for (std::size_t i = 0; i <= kHours; ++i) knot_s.push_back(3600 * static_cast<double>(i));
    HeatRequest request = request_of(w.layers, w.side, 290, knot_s, {});
    request.outer = {w.outer};
    if (w.side == InnerSide::kOpen) request.inner = {w.inner};
    request.output_boundary = {0, w.layers.size()};
    const HeatResult r = solved(
        request, [&](std::size_t interval, std::span<const std::uint32_t>, const Exposure& out) {
          set(out.outer_begin, 0, w.hour[interval][0]);
          set(out.outer_end, 0, w.hour[interval][1]);
          set(out.inner_begin, 0, w.hour[interval][2]);
          set(out.inner_end, 0, w.hour[interval][3]);
        });

    // CVODE does not get exposures of an inner side that takes none.
    FaceProperties inner{0, kForcedOnly};
    if (w.side == InnerSide::kOpen) inner = w.inner;
    const auto seen = [&](Weather b) {
      if (w.side == InnerSide::kAdiabatic || w.side == InnerSide::kHeatFlux) b.forced_h_w_m2_k = 0;
      if (w.side == InnerSide::kAdiabatic || w.side == InnerSide::kAir) b.absorbed_w_m2 = 0;
      return b;
    };
    const bool fixed = w.side == InnerSide::kFixedTemperature;
    CvodeWall coarse(w.layers, 24, fixed, 290), fine(w.layers, 48, fixed, 290);
    for (std::size_t i = 0; i < kHours; ++i) {
      const CvodeWall::Face outer{w.outer, w.hour[i][0], w.hour[i][1]};
      const CvodeWall::Face behind{inner, seen(w.hour[i][2]), seen(w.hour[i][3])};
      const auto by_coarse = coarse.advance(outer, behind, 3600);
      const auto by_fine = fine.advance(outer, behind, 3600);
      for (std::size_t side = 0; side < 2; ++side) {
        const double reference = (4 * by_fine[side] - by_coarse[side]) / 3;
        const double doubt = 0.1 * std::abs(by_fine[side] - by_coarse[side]) / 3 + 2e-5;
        const std::size_t at = r.at(i + 1, side, 0);
        const double error = std::abs(r.temperature_k[at] - reference);
        EXPECT_LE(error, 0.010 + doubt) << "seed " << seed << " hour " << i + 1 << " side " << side;
        largest_k = std::max(largest_k, error);
        ++all;
        covered += error <= r.error_k[at] + doubt;
        too_wide.push_back(r.error_k[at] / std::max(error, doubt));
      }
    }
    EXPECT_LE(r.closure_w_m2[0], 1e-6 * 300) << "seed " << seed;
  }
  std::ranges::nth_element(too_wide, too_wide.begin() + static_cast<std::ptrdiff_t>(all / 2));
  EXPECT_GE(static_cast<double>(covered), 0.95 * static_cast<double>(all));
  EXPECT_LE(too_wide[all / 2], 50);
  std::printf("largest error %.2f mK, covered %.2f %%, stated over true in the median %.1f\n",
              1e3 * largest_k, 100.0 * static_cast<double>(covered) / static_cast<double>(all),
              too_wide[all / 2]);
}

}  // namespace
}  // namespace irsig
