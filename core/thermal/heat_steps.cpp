#include "core/thermal/heat_steps.h"

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/base/clones.h"

namespace irsig {
namespace {

// TR-BDF2 with gamma = 2 - sqrt(2), as a Runge-Kutta scheme [hosea1996]: both stages have the same
// matrix.
constexpr double kGamma = 0.58578643762690495;
constexpr double kImplicit = kGamma / 2;                   // of f at a stage's own end
constexpr double kExplicit = 0.35355339059327376;          // of f at the begin and the middle
constexpr double kFromMiddle = kExplicit / kImplicit;      // of the temperatures, second stage
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
    const double natural_share = n * (n + mixed) / (3 * (h > 0 ? h : 1.0));
    const double cube = (t[j] < 0 ? -t[j] : t[j]) * t[j] * t[j];
    heat.w_m2[j] = at.gain_w_m2[j] - face.emission_w_m2_k4[j] * cube * t[j] - h * above;
    heat.w_m2_k[j] = -4 * face.emission_w_m2_k4[j] * cube - h - natural_share;
  }
}

// Solves one stage. In: its right side, with the heat of the faces still to come, and a guess of the
// two faces in t. Out: t, and the heat into the faces.
[[gnu::always_inline]] inline void solve_stage(const ConductionGrid& grid, const HeatStep& step,
                                               const HeatLanes& lanes, double share,
                                               std::vector<HeatLane>& right,
                                               std::vector<HeatLane>& t, HeatLane& outer_w_m2,
                                               HeatLane& inner_w_m2) {
  const std::size_t last = grid.last();
  HeatLane outer_right = right[0], inner_right = right[last];
  HeatLane s{};
  for (std::size_t i = last - 1; i > 0; --i) {
    const double at_last = step.at_last[i], conduction = step.conduction[i];
    const double inverse_pivot = step.inverse_pivot[i];
    HeatLane& row = right[i];
#pragma GCC ivdep
    for (std::size_t j = 0; j < kHeatLanes; ++j) {
      inner_right[j] += at_last * row[j];
      s[j] = inverse_pivot * row[j] + conduction * s[j];
      row[j] = s[j];
    }
  }
  const double next = step.implicit_s * grid.conductance_w_m2_k[0];
#pragma GCC ivdep
  for (std::size_t j = 0; j < kHeatLanes; ++j) outer_right[j] += next * s[j];

  FaceAt outer, inner;
  set_time(lanes.outer, share, outer);
  set_time(lanes.inner, share, inner);
  HeatLane t0 = t[0], t1 = t[last], live;
  live.fill(1);
  FaceHeat f0, f1;
  for (int k = 0; k < kMaxNewtonSteps; ++k) {
    face_heat(lanes.outer, outer, t0, f0);
    if (!lanes.inner_fixed) face_heat(lanes.inner, inner, t1, f1);
    const double across = step.across;
#pragma GCC ivdep
    for (std::size_t j = 0; j < kHeatLanes; ++j) {
      const double own0 = step.outer - step.implicit_s * f0.w_m2_k[j];
      const double rest0 = step.outer * t0[j] + across * (t0[j] - t1[j]) - outer_right[j] -
                           step.implicit_s * f0.w_m2[j];
      double d0, d1;
      if (lanes.inner_fixed) {
        d1 = inner.fluid_k[j] - t1[j];
        d0 = (across * d1 - rest0) / (own0 + across);
      } else {
        const double own1 = step.inner - step.implicit_s * f1.w_m2_k[j];
        const double rest1 = step.inner * t1[j] + across * (t1[j] - t0[j]) - inner_right[j] -
                             step.implicit_s * f1.w_m2[j];
        const double determinant = own0 * own1 + across * (own0 + own1);
        d0 = -((own1 + across) * rest0 + across * rest1) / determinant;
        d1 = -((own0 + across) * rest1 + across * rest0) / determinant;
        inner_w_m2[j] = live[j] > 0 ? f1.w_m2[j] + f1.w_m2_k[j] * d1 : inner_w_m2[j];
      }
      outer_w_m2[j] = live[j] > 0 ? f0.w_m2[j] + f0.w_m2_k[j] * d0 : outer_w_m2[j];
      t0[j] = live[j] > 0 ? t0[j] + d0 : t0[j];
      t1[j] = live[j] > 0 ? t1[j] + d1 : t1[j];
      const double size = d0 * d0 + d1 * d1;
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
      t[i][j] = near * t[i - 1][j] + far * t1[j] + right[i][j];
    }
  }
  if (lanes.inner_fixed) {  // what the fixed node takes from the wall
    const double g = grid.conductance_w_m2_k[last - 1];
#pragma GCC ivdep
    for (std::size_t j = 0; j < kHeatLanes; ++j) inner_w_m2[j] = g * (t1[j] - t[last - 1][j]);
  }
}

[[gnu::always_inline]] inline void take_step(const ConductionGrid& grid, const HeatStep& step,
                                             HeatLanes& lanes, HeatLane& outer_w_m2,
                                             HeatLane& inner_w_m2) {
  const std::size_t last = grid.last();
  const double dt = step.implicit_s;
  std::vector<HeatLane>&t = lanes.t, &middle = lanes.t_middle, &right = lanes.right;

  // Trapezoidal rule to the middle.
  HeatLane from_before = outer_w_m2;
  for (std::size_t i = 0; i < last; ++i) {
    const double c = grid.capacity_j_m2_k[i], g = grid.conductance_w_m2_k[i];
#pragma GCC ivdep
    for (std::size_t j = 0; j < kHeatLanes; ++j) {
      const double to_next = g * (t[i][j] - t[i + 1][j]);
      right[i][j] = c * t[i][j] + dt * (from_before[j] - to_next);
      from_before[j] = to_next;
    }
  }
  const double last_capacity = lanes.inner_fixed ? 0.0 : grid.capacity_j_m2_k[last];
#pragma GCC ivdep
  for (std::size_t j = 0; j < kHeatLanes; ++j) {
    right[last][j] = last_capacity * t[last][j] + dt * (from_before[j] + inner_w_m2[j]);
    middle[0][j] = t[0][j];
    middle[last][j] = t[last][j];
  }
  HeatLane outer_sum = outer_w_m2, inner_sum = inner_w_m2;
  solve_stage(grid, step, lanes, step.middle, right, middle, outer_w_m2, inner_w_m2);
#pragma GCC ivdep
  for (std::size_t j = 0; j < kHeatLanes; ++j) {
    outer_sum[j] += outer_w_m2[j];
    inner_sum[j] += inner_w_m2[j];
  }

  // Second-order backward differences to the end; `middle` then holds the begin.
  for (std::size_t i = 0; i <= last; ++i) {
    const double c = i == last ? last_capacity : grid.capacity_j_m2_k[i];
#pragma GCC ivdep
    for (std::size_t j = 0; j < kHeatLanes; ++j) {
      right[i][j] = c * (t[i][j] + kFromMiddle * (middle[i][j] - t[i][j]));
    }
  }
  for (const std::size_t i : {std::size_t{0}, last}) {
#pragma GCC ivdep
    for (std::size_t j = 0; j < kHeatLanes; ++j) {
      const double guess = t[i][j] + (middle[i][j] - t[i][j]) / kGamma;
      middle[i][j] = t[i][j];
      t[i][j] = guess;
    }
  }
  HeatLane stored{};
  for (std::size_t i = 1; i < last; ++i) middle[i] = t[i];
  solve_stage(grid, step, lanes, step.end, right, t, outer_w_m2, inner_w_m2);
  for (std::size_t i = 0; i <= last; ++i) {
    const double c = i == last ? last_capacity : grid.capacity_j_m2_k[i];
#pragma GCC ivdep
    for (std::size_t j = 0; j < kHeatLanes; ++j) stored[j] += c * (t[i][j] - middle[i][j]);
  }
#pragma GCC ivdep
  for (std::size_t j = 0; j < kHeatLanes; ++j) {
    const double came_in = kExplicit * (outer_sum[j] + inner_sum[j]) +
                           kImplicit * (outer_w_m2[j] + inner_w_m2[j]);
    const double open = std::abs(stored[j] / step.length_s - came_in);
    lanes.closure_w_m2[j] = open > lanes.closure_w_m2[j] ? open : lanes.closure_w_m2[j];
  }
}

}  // namespace

HeatStep::HeatStep(const ConductionGrid& grid, double length, double begin_share,
                   double middle_share, double end_share)
    : length_s(length),
      implicit_s(kImplicit * length),
      begin(begin_share),
      middle(middle_share),
      end(end_share) {
  const std::size_t last = grid.last();
  const auto link = [&](std::size_t i) { return implicit_s * grid.conductance_w_m2_k[i]; };
  near.assign(last + 1, 0);
  far = conduction = inverse_pivot = at_last = near;
  // From the inner face outwards. What the elimination of the nodes behind adds to a node: its
  // capacity and theirs, as far as it feels them; never a difference of large numbers.
  double behind_near = 0, behind_far = link(last - 1);  // of node i's own temperature, of T_last
  for (std::size_t i = last - 1; i > 0; --i) {
    const double pivot = grid.capacity_j_m2_k[i] + behind_near + behind_far + link(i - 1);
    near[i] = link(i - 1) / pivot;
    far[i] = behind_far / pivot;
    inverse_pivot[i] = 1 / pivot;
    conduction[i] = i + 1 < last ? link(i) / pivot : 0;
    behind_near = link(i - 1) * (grid.capacity_j_m2_k[i] + behind_near) / pivot;
    behind_far = link(i - 1) * far[i];
  }
  outer = grid.capacity_j_m2_k[0] + behind_near;
  across = behind_far;
  for (std::size_t i = 1; i < last; ++i) at_last[i] = near[i] * at_last[i - 1] + far[i];
  inner = grid.capacity_j_m2_k[last];
  for (std::size_t i = 1; i < last; ++i) inner += at_last[i] * grid.capacity_j_m2_k[i];
}

IRSIG_CLONES void advance(const ConductionGrid& grid, const std::vector<HeatStep>& steps,
                          HeatLanes& lanes) {
  const std::size_t last = grid.last();
  FaceAt at;
  FaceHeat heat;
  set_time(lanes.outer, 0, at);
  face_heat(lanes.outer, at, lanes.t[0], heat);
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
  for (const HeatStep& step : steps) take_step(grid, step, lanes, outer_w_m2, inner_w_m2);
}

}  // namespace irsig
