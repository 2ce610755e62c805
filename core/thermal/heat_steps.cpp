#include "core/thermal/heat_steps.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/base/clones.h"

namespace irsig {
namespace {

// TR-BDF2 as a Runge-Kutta scheme [hosea1996]: both stages have the same matrix.
constexpr double kImplicit = kMiddleOfStep / 2;        // of f at a stage's own end
constexpr double kExplicit = 0.35355339059327376;      // of f at the begin and the middle
constexpr double kFromMiddle = kExplicit / kImplicit;  // of the temperatures, second stage
// A face whose Newton step was smaller is solved: the error left is the square of it over some
// kelvin.
constexpr double kLastStepK = 1e-5;
constexpr int kMaxNewtonSteps = 60;

// x^(1/3) for x >= 1e-30, relative error below 1e-12: no branch, no call, the same bits in every
// lane. First guess within 5 %, by a third of the exponent; two steps of Halley.
[[gnu::always_inline]] inline double cube_root(double x) {
  const std::uint64_t high = std::bit_cast<std::uint64_t>(x) >> 32;
  const std::uint64_t third = (high * 0x55555556u >> 32) + 715094163u;
  double y = std::bit_cast<double>(third << 32);
  for (int i = 0; i < 2; ++i) {
    const double cube = y * y * y;
    y = y * (cube + 2 * x) / (2 * cube + x);
  }
  return y;
}

// e^x for x in [-700, 700], relative error below 1e-14, likewise: powers of two by the exponent,
// the rest, within ln(2) / 2, by its series.
[[gnu::always_inline]] inline double exponential(double x) {
  constexpr double kShift = 0x1.8p52;  // its sum with a small number rounds that to an integer
  const double shifted = x * 1.4426950408889634 + kShift;
  const double r = x - (shifted - kShift) * 0.69314718055994531;
  double sum = 1;
  for (int k = 13; k > 0; --k) sum = 1 + sum * r * (1.0 / k);
  return sum * std::bit_cast<double>((std::bit_cast<std::uint64_t>(shifted) + 1023) << 52);
}

struct FaceAt {
  HeatLane gain_w_m2, fluid_k, forced_w_m2_k;
};

[[gnu::always_inline]] inline void set_time(const HeatFace& face, double share, FaceAt& at) {
#pragma GCC ivdep
  for (std::size_t j = 0; j < kHeatLanes; ++j) {
    at.gain_w_m2[j] = face.gain_w_m2.begin[j] + share * face.gain_w_m2.change[j];
    at.fluid_k[j] = face.fluid_k.begin[j] + share * face.fluid_k.change[j];
    at.forced_w_m2_k[j] = face.forced_w_m2_k.begin[j] + share * face.forced_w_m2_k.change[j];
  }
}

// Heat into the face and its derivative, which is <= 0: emission goes on as an odd function below
// 0 K, where no solution lies but a Newton step may.
struct FaceHeat {
  HeatLane w_m2, w_m2_k;
};

[[gnu::always_inline]] inline void face_heat(const HeatFace& face, const FaceAt& at,
                                             const HeatLane& t, FaceHeat& heat) {
#pragma GCC ivdep
  for (std::size_t j = 0; j < kHeatLanes; ++j) {
    const double above = t[j] - at.fluid_k[j];
    const double size = above < 0 ? -above : above;
    const double n = (above > 0 ? face.natural_warm[j] : face.natural_cold[j]) *
                     cube_root(size > 1e-30 ? size : 1e-30);
    const double forced = at.forced_w_m2_k[j], mixed = face.mixing[j] * forced;
    const double h = std::sqrt(n * n + forced * forced + 2 * mixed * n);
    const double natural_fraction = n * (n + mixed) / (3 * (h > 0 ? h : 1.0));
    const double cube = (t[j] < 0 ? -t[j] : t[j]) * t[j] * t[j];
    heat.w_m2[j] = at.gain_w_m2[j] - face.emission_w_m2_k4[j] * cube * t[j] - h * above;
    heat.w_m2_k[j] = -4 * face.emission_w_m2_k4[j] * cube - h - natural_fraction;
  }
}

// Saturation pressure over water and its derivative [sonntag1990], as vapour_pressure_pa(); outside
// of 173 to 373 K along the tangent there.
[[gnu::always_inline]] inline void saturate(double kelvin, double& pa, double& pa_k) {
  constexpr double kColdest = -100, kHottest = 100;
  const double c = kelvin - 273.15, low = c > kColdest ? c : kColdest,
               within = low < kHottest ? low : kHottest;
  const double inverse = 1 / (243.12 + within);
  const double at = 611.2 * exponential(17.62 * within * inverse);
  pa_k = at * (17.62 * 243.12) * inverse * inverse;
  pa = at + pa_k * (c - within);
}

// Adds latent heat to that of a face: `evaporates` and `condenses` times the difference of vapour
// pressures, which grows with the face's temperature.
struct WaterAt {
  HeatLane vapour_pa, evaporates_w_m2_pa, condenses_w_m2_pa;
};

// Coefficients at a time of a stage, with the natural convection of the temperatures `begin` of the
// step's begin: where a face passes the air's temperature that part has a vertical tangent, which
// the balance of vapour, whose difference does not vanish there, would get.
[[gnu::always_inline]] inline void set_water(const HeatWater& water, const HeatFace& face,
                                             const FaceAt& at, double share, const HeatLane& begin,
                                             WaterAt& out) {
  constexpr double kLewis = 1.1144;  // 0.85^(-2/3)
#pragma GCC ivdep
  for (std::size_t j = 0; j < kHeatLanes; ++j) {
    const double above = begin[j] - at.fluid_k[j];
    const double size = above < 0 ? -above : above;
    const double n = (above > 0 ? face.natural_warm[j] : face.natural_cold[j]) *
                     cube_root(size > 1e-30 ? size : 1e-30);
    const double forced = at.forced_w_m2_k[j];
    const double h = kLewis * std::sqrt(n * n + forced * forced + 2 * face.mixing[j] * forced * n);
    const double g = water.stomatal_w_m2_k.begin[j] + share * water.stomatal_w_m2_k.change[j];
    const double both = h + g;
    const double inverse_gamma =
        water.inverse_gamma_k_pa.begin[j] + share * water.inverse_gamma_k_pa.change[j];
    const double leaves = water.cover[j] * (h * g / (both > 0 ? both : 1.0));
    out.vapour_pa[j] = water.vapour_pa.begin[j] + share * water.vapour_pa.change[j];
    out.evaporates_w_m2_pa[j] = inverse_gamma * (water.bare[j] * h + leaves);
    out.condenses_w_m2_pa[j] = inverse_gamma * (water.on[j] * h);
  }
}

[[gnu::always_inline]] inline void add_latent_heat(const WaterAt& at, const HeatLane& t,
                                                   FaceHeat& heat) {
#pragma GCC ivdep
  for (std::size_t j = 0; j < kHeatLanes; ++j) {
    double pa, pa_k;
    saturate(t[j], pa, pa_k);
    const double over = pa - at.vapour_pa[j];
    const double c = over > 0 ? at.evaporates_w_m2_pa[j] : at.condenses_w_m2_pa[j];
    heat.w_m2[j] -= c * over;
    heat.w_m2_k[j] -= c * pa_k;
  }
}

// Solves one stage. In: right(i, j), its right side of node i and lane j without the stage's own
// heat of the faces, and guesses t0, t1 of the faces. Out: t, and the heat into the faces.
template <bool kWet, typename RightSide>
[[gnu::always_inline]] inline void solve_stage(const ConductionGrid& grid, const Elimination& step,
                                               HeatLanes& lanes, double share,
                                               const RightSide& right, HeatLane t0, HeatLane t1,
                                               std::vector<HeatLane>& t, HeatLane& outer_w_m2,
                                               HeatLane& inner_w_m2) {
  const std::size_t last = grid.last();
  HeatLane outer_right, inner_right, s{};
#pragma GCC ivdep
  for (std::size_t j = 0; j < kHeatLanes; ++j) {
    outer_right[j] = right(0, j);
    inner_right[j] = right(last, j);
  }
  for (std::size_t i = last - 1; i > 0; --i) {
    const double at_last = step.at_last[i], conduction = step.conduction[i];
    const double inverse_pivot = step.inverse_pivot[i];
    HeatLane& inside = lanes.inside[i];
#pragma GCC ivdep
    for (std::size_t j = 0; j < kHeatLanes; ++j) {
      const double r = right(i, j);
      inner_right[j] += at_last * r;
      s[j] = inverse_pivot * r + conduction * s[j];
      inside[j] = s[j];
    }
  }
  const double next = step.implicit_s * grid.conductance_w_m2_k[0];
#pragma GCC ivdep
  for (std::size_t j = 0; j < kHeatLanes; ++j) outer_right[j] += next * s[j];

  FaceAt outer, inner;
  set_time(lanes.outer, share, outer);
  set_time(lanes.inner, share, inner);
  WaterAt water;
  if constexpr (kWet) set_water(lanes.water, lanes.outer, outer, share, lanes.t[0], water);
  HeatLane live, own0, rest0;
  live.fill(1);
  FaceHeat f0, f1;
  for (int k = 0; k < kMaxNewtonSteps; ++k) {
    face_heat(lanes.outer, outer, t0, f0);
    if constexpr (kWet) add_latent_heat(water, t0, f0);
    if (!lanes.inner_fixed) face_heat(lanes.inner, inner, t1, f1);
    const double across = step.across, dt = step.implicit_s;
    HeatLane d0, d1;
#pragma GCC ivdep
    for (std::size_t j = 0; j < kHeatLanes; ++j) {
      own0[j] = step.outer - dt * f0.w_m2_k[j];
      rest0[j] = step.outer * t0[j] + across * (t0[j] - t1[j]) - outer_right[j] - dt * f0.w_m2[j];
    }
    if (lanes.inner_fixed) {
#pragma GCC ivdep
      for (std::size_t j = 0; j < kHeatLanes; ++j) {
        d1[j] = inner.fluid_k[j] - t1[j];
        d0[j] = (across * d1[j] - rest0[j]) / (own0[j] + across);
      }
    } else {
#pragma GCC ivdep
      for (std::size_t j = 0; j < kHeatLanes; ++j) {
        const double own1 = step.inner - dt * f1.w_m2_k[j];
        const double rest1 =
            step.inner * t1[j] + across * (t1[j] - t0[j]) - inner_right[j] - dt * f1.w_m2[j];
        const double inverse = -1 / (own0[j] * own1 + across * (own0[j] + own1));
        d0[j] = ((own1 + across) * rest0[j] + across * rest1) * inverse;
        d1[j] = ((own0[j] + across) * rest1 + across * rest0[j]) * inverse;
        inner_w_m2[j] = live[j] > 0 ? f1.w_m2[j] + f1.w_m2_k[j] * d1[j] : inner_w_m2[j];
      }
    }
#pragma GCC ivdep
    for (std::size_t j = 0; j < kHeatLanes; ++j) {
      outer_w_m2[j] = live[j] > 0 ? f0.w_m2[j] + f0.w_m2_k[j] * d0[j] : outer_w_m2[j];
      t0[j] = live[j] > 0 ? t0[j] + d0[j] : t0[j];
      t1[j] = live[j] > 0 ? t1[j] + d1[j] : t1[j];
      const double size = d0[j] * d0[j] + d1[j] * d1[j];
      live[j] = size > kLastStepK * kLastStepK ? live[j] : 0.0;
    }
    double unsolved = 0;
    for (const double lane : live) unsolved += lane;
    if (unsolved == 0) break;
  }

  t[0] = t0;
  t[last] = t1;
  for (std::size_t i = 1; i < last; ++i) {
    const double near = step.near[i], far = step.far[i];
#pragma GCC ivdep
    for (std::size_t j = 0; j < kHeatLanes; ++j) {
      t[i][j] = near * t[i - 1][j] + far * t1[j] + lanes.inside[i][j];
    }
  }
  if (lanes.inner_fixed) {  // what the fixed node takes from the wall
    const double g = grid.conductance_w_m2_k[last - 1];
#pragma GCC ivdep
    for (std::size_t j = 0; j < kHeatLanes; ++j) inner_w_m2[j] = g * (t1[j] - t[last - 1][j]);
  }
}

template <bool kWet>
[[gnu::always_inline]] inline void take_step(const ConductionGrid& grid, const Elimination& step,
                                             const HeatStep& times, HeatLanes& lanes,
                                             HeatLane& outer_w_m2, HeatLane& inner_w_m2) {
  const std::size_t last = grid.last();
  const double dt = step.implicit_s;
  const double last_capacity = lanes.inner_fixed ? 0.0 : grid.capacity_j_m2_k[last];
  const auto capacity = [&](std::size_t i) {
    return i == last ? last_capacity : grid.capacity_j_m2_k[i];
  };
  std::vector<HeatLane>&t = lanes.t, &other = lanes.t_other;
  HeatLane outer_sum = outer_w_m2, inner_sum = inner_w_m2;

  // Trapezoidal rule to the middle: t -> other.
  const auto conducted = [&](std::size_t i, std::size_t j) {  // from node i to the next
    return grid.conductance_w_m2_k[i] * (t[i][j] - t[i + 1][j]);
  };
  const auto first_right = [&](std::size_t i, std::size_t j) {
    const double from_before = i == 0 ? outer_sum[j] : conducted(i - 1, j);
    const double to_next = i == last ? -inner_sum[j] : conducted(i, j);
    return capacity(i) * t[i][j] + dt * (from_before - to_next);
  };
  solve_stage<kWet>(grid, step, lanes, times.middle, first_right, t[0], t[last], other, outer_w_m2,
                    inner_w_m2);
#pragma GCC ivdep
  for (std::size_t j = 0; j < kHeatLanes; ++j) {
    outer_sum[j] += outer_w_m2[j];
    inner_sum[j] += inner_w_m2[j];
  }

  // Second-order backward differences to the end: t, other -> other.
  const auto second_right = [&](std::size_t i, std::size_t j) {
    return capacity(i) * (t[i][j] + kFromMiddle * (other[i][j] - t[i][j]));
  };
  HeatLane outer_guess, inner_guess, stored{};
#pragma GCC ivdep
  for (std::size_t j = 0; j < kHeatLanes; ++j) {
    outer_guess[j] = t[0][j] + (other[0][j] - t[0][j]) / kMiddleOfStep;
    inner_guess[j] = t[last][j] + (other[last][j] - t[last][j]) / kMiddleOfStep;
  }
  solve_stage<kWet>(grid, step, lanes, times.end, second_right, outer_guess, inner_guess, other,
                    outer_w_m2, inner_w_m2);
  for (std::size_t i = 0; i <= last; ++i) {
    const double c = capacity(i);
#pragma GCC ivdep
    for (std::size_t j = 0; j < kHeatLanes; ++j) stored[j] += c * (other[i][j] - t[i][j]);
  }
  std::swap(t, other);
#pragma GCC ivdep
  for (std::size_t j = 0; j < kHeatLanes; ++j) {
    const double came_in =
        kExplicit * (outer_sum[j] + inner_sum[j]) + kImplicit * (outer_w_m2[j] + inner_w_m2[j]);
    const double open = std::abs(stored[j] / step.length_s - came_in);
    lanes.closure_w_m2[j] = open > lanes.closure_w_m2[j] ? open : lanes.closure_w_m2[j];
  }
}

// Makes all steps of one interval.
template <bool kWet>
[[gnu::always_inline]] inline void take_steps(const ConductionGrid& grid,
                                              const HeatInterval& interval, HeatLanes& lanes) {
  const std::size_t last = grid.last();
  FaceAt at;
  FaceHeat heat;
  set_time(lanes.outer, 0, at);
  face_heat(lanes.outer, at, lanes.t[0], heat);
  if constexpr (kWet) {
    WaterAt water;
    set_water(lanes.water, lanes.outer, at, 0, lanes.t[0], water);
    add_latent_heat(water, lanes.t[0], heat);
  }
  HeatLane outer_w_m2 = heat.w_m2, inner_w_m2{};
  set_time(lanes.inner, 0, at);
  if (lanes.inner_fixed) {
    lanes.t[last] = at.fluid_k;
    const double g = grid.conductance_w_m2_k[last - 1];
#pragma GCC ivdep
    for (std::size_t j = 0; j < kHeatLanes; ++j) {
      inner_w_m2[j] = g * (at.fluid_k[j] - lanes.t[last - 1][j]);
    }
  } else {
    face_heat(lanes.inner, at, lanes.t[last], heat);
    inner_w_m2 = heat.w_m2;
  }
  for (const HeatStep& step : interval.step) {
    take_step<kWet>(grid, interval.elimination[step.elimination], step, lanes, outer_w_m2,
                    inner_w_m2);
  }
}

}  // namespace

Elimination::Elimination(const ConductionGrid& grid, double length)
    : length_s(length), implicit_s(kImplicit * length) {
  const std::size_t last = grid.last();
  const auto link = [&](std::size_t i) { return implicit_s * grid.conductance_w_m2_k[i]; };
  near.assign(last + 1, 0);
  far = conduction = inverse_pivot = at_last = near;
  // Eliminates from the inner face outwards. The nodes behind add to a node its capacity and
  // theirs, as far as it feels them; never a difference of large numbers.
  double background_near = 0,
         background_far = link(last - 1);  // of node i's own temperature, of T_last
  for (std::size_t i = last - 1; i > 0; --i) {
    const double pivot = grid.capacity_j_m2_k[i] + background_near + background_far + link(i - 1);
    near[i] = link(i - 1) / pivot;
    far[i] = background_far / pivot;
    inverse_pivot[i] = 1 / pivot;
    conduction[i] = i + 1 < last ? link(i) / pivot : 0;
    background_near = link(i - 1) * (grid.capacity_j_m2_k[i] + background_near) / pivot;
    background_far = link(i - 1) * far[i];
  }
  outer = grid.capacity_j_m2_k[0] + background_near;
  across = background_far;
  for (std::size_t i = 1; i < last; ++i) at_last[i] = near[i] * at_last[i - 1] + far[i];
  inner = grid.capacity_j_m2_k[last];
  for (std::size_t i = 1; i < last; ++i) inner += at_last[i] * grid.capacity_j_m2_k[i];
}

IRSIG_CLONES void advance(const ConductionGrid& grid, const HeatInterval& interval,
                          HeatLanes& lanes) {
  if (lanes.wet)
    take_steps<true>(grid, interval, lanes);
  else
    take_steps<false>(grid, interval, lanes);
}

}  // namespace irsig
