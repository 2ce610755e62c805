#include "core/thermal/wall_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/thermal/heat_request_check.h"

namespace irsig {
namespace {

// Steps of an interval at level 0: its length in units of this, the square root of it many, and the
// first halved until it is no longer than the unit: what changes at a knot at once fades like the
// square root of time.
constexpr double kFirstStepS = 60;
// Longest of the equal steps where nothing jumps.
constexpr double kSmoothStepS = 600;

std::vector<double> interval_steps(double length_s, bool smooth, int level) {
  const double count =
      std::ceil(smooth ? length_s / kSmoothStepS : std::sqrt(length_s / kFirstStepS));
  std::vector<double> step(static_cast<std::size_t>(count), length_s / count);
  while (!smooth && step.front() > kFirstStepS) {
    step.front() /= 2;
    step.insert(step.begin(), step.front());
  }
  for (int i = 0; i < level; ++i) {
    std::vector<double> half;
    for (const double s : step) half.insert(half.end(), 2, s / 2);
    // The very first is cut further: what begins at once is not smooth there.
    for (int k = 0; k < 2 && !smooth; ++k) {
      half.front() /= 2;
      half.insert(half.begin(), half.front());
    }
    step = std::move(half);
  }
  return step;
}

HeatInterval heat_interval(const ConductionGrid& grid, double length_s, bool smooth, int level) {
  HeatInterval out;
  double time_s = 0, last_s = 0;
  for (const double step_s : interval_steps(length_s, smooth, level)) {
    // Steps only grow, by factors of two: few lengths are different.
    if (step_s != last_s) out.elimination.emplace_back(grid, step_s);
    last_s = step_s;
    const double end_s = time_s + step_s;
    out.step.push_back({out.elimination.size() - 1, time_s / length_s,
                        (time_s + kMiddleOfStep * step_s) / length_s, end_s / length_s});
    time_s = end_s;
  }
  return out;
}

// Columns: outer at begin, at end, inner at begin, at end, with four numbers each; then water of
// the outer face at begin, at end, with three.
constexpr std::size_t kDryColumns = 16, kWetColumns = 22;
struct Range {
  const char* name;
  double low, high;
};
constexpr std::array<Range, 4> kRange{{{"absorbed_w_m2", -1e9, 1e9},
                                       {"incoming_w_m2", 0, 1e9},
                                       {"fluid_k", 1e-9, 1e5},
                                       {"forced_h_w_m2_k", 0, 1e9}}};
constexpr std::array<Range, 3> kRangeOfWater{
    {{"vapour_pa", 0, 1e6}, {"inverse_gamma_k_pa", 0, 1}, {"stomatal_w_m2_k", 0, 1e9}}};

void set_properties(const FaceProperties& face, std::size_t j, HeatFace& out) {
  out.emission_w_m2_k4[j] = face.emissivity * kStefanBoltzmannWM2K4;
  out.natural_warm[j] = face.convection.natural_warm;
  out.natural_cold[j] = face.convection.natural_cold;
  out.mixing[j] = face.convection.mixing;
}

void set_properties(const Evaporation& evaporation, std::size_t j, HeatWater& out) {
  out.on[j] = evaporation.on ? 1 : 0;
  out.bare[j] = evaporation.on ? evaporation.bare : 0;
  out.cover[j] = evaporation.on ? evaporation.cover : 0;
}

bool any_wet(std::span<const FaceProperties> outer) {
  return std::ranges::any_of(outer, [](const FaceProperties& f) { return f.evaporation.on; });
}

}  // namespace

double first_step_s(double interval_s, bool smooth) {
  return interval_steps(interval_s, smooth, 0).front();
}

ExposureTable::ExposureTable(std::size_t elements, InnerSide inner, bool wet)
    : elements_(elements),
      inner_(inner),
      wet_(wet),
      value_((wet ? kWetColumns : kDryColumns) * elements) {}

Exposure ExposureTable::empty() {
  std::ranges::fill(value_, std::numeric_limits<double>::quiet_NaN());
  const auto face = [&](std::size_t k) {
    return FaceExposure{column(k), column(k + 1), column(k + 2), column(k + 3)};
  };
  Exposure out{face(0), face(4), face(8), face(12)};
  if (wet_) {
    std::size_t next = kDryColumns;
    for (FaceExposure* outer : {&out.outer_begin, &out.outer_end}) {
      outer->vapour_pa = column(next++);
      outer->inverse_gamma_k_pa = column(next++);
      outer->stomatal_w_m2_k = column(next++);
    }
  }
  return out;
}

bool ExposureTable::uses(std::size_t column) const {
  if (column < 8 || column >= kDryColumns) return true;
  switch (inner_) {
    case InnerSide::kAdiabatic:
      return false;
    case InnerSide::kHeatFlux:
      return column % 4 == 0;
    case InnerSide::kAir:
      return column % 4 >= 2;
    case InnerSide::kFixedTemperature:
      return column % 4 == 2;
    case InnerSide::kOpen:
      return true;
  }
  return true;
}

absl::Status ExposureTable::check(std::size_t interval, std::span<const std::uint32_t> name) const {
  for (std::size_t k = 0; k < (wet_ ? kWetColumns : kDryColumns); ++k) {
    if (!uses(k)) continue;
    const bool of_water = k >= kDryColumns, outer = k < 8 || of_water;
    const bool begin = of_water ? k < kDryColumns + 3 : k / 4 % 2 == 0;
    const auto& [number, low, high] =
        of_water ? kRangeOfWater[(k - kDryColumns) % 3] : kRange[k % 4];
    const double* value = value_.data() + k * elements_;
    bool fine = true;
    for (std::size_t e = 0; e < elements_; ++e) fine &= value[e] >= low && value[e] <= high;
    if (fine) continue;
    for (std::size_t e = 0; e < elements_; ++e)
      if (!(value[e] >= low && value[e] <= high))
        return wrong_number(
            absl::StrCat("interval ", interval, ", element ", name[e], ", ",
                         outer ? "outer " : "inner ", begin ? "begin: " : "end: ", number),
            value[e], absl::StrCat(low, " to ", high));
  }
  return absl::OkStatus();
}

void ExposureTable::load(std::size_t face, std::size_t first, std::span<const double> emissivity,
                         HeatFace& out) const {
  const auto value = [&](std::size_t end, std::size_t k, std::size_t j) {
    const std::size_t column = 8 * face + 4 * end + k;
    return uses(column) ? value_[column * elements_ + std::min(first + j, elements_ - 1)] : 0.0;
  };
  for (std::size_t j = 0; j < kHeatLanes; ++j) {
    const double of_incoming = emissivity[std::min(first + j, elements_ - 1)];
    const auto vary = [&](HeatFace::Varying& varying, double begin, double end) {
      varying.begin[j] = begin;
      varying.change[j] = end - begin;
    };
    vary(out.gain_w_m2, value(0, 0, j) + of_incoming * value(0, 1, j),
         value(1, 0, j) + of_incoming * value(1, 1, j));
    vary(out.fluid_k, value(0, 2, j), value(1, 2, j));
    vary(out.forced_w_m2_k, value(0, 3, j), value(1, 3, j));
  }
}

void ExposureTable::load_water(std::size_t first, HeatWater& out) const {
  const auto vary = [&](std::size_t k, HeatFace::Varying& varying) {
    const double *begin = value_.data() + (kDryColumns + k) * elements_,
                 *end = begin + 3 * elements_;
    for (std::size_t j = 0; j < kHeatLanes; ++j) {
      const std::size_t e = std::min(first + j, elements_ - 1);
      varying.begin[j] = begin[e];
      varying.change[j] = end[e] - begin[e];
    }
  };
  vary(0, out.vapour_pa);
  vary(1, out.inverse_gamma_k_pa);
  vary(2, out.stomatal_w_m2_k);
}

WallWalk::WallWalk(std::span<const Layer> layers, InnerSide inner_side, double shortest_s,
                   int level, std::vector<std::uint32_t> name,
                   std::span<const FaceProperties> outer, std::span<const FaceProperties> inner)
    : grid_(make_grid(layers, shortest_s, level)),
      level_(level),
      name_(std::move(name)),
      table_(name_.size(), inner_side, any_wet(outer)) {
  const std::size_t n = name_.size(), blocks = (n + kHeatLanes - 1) / kHeatLanes;
  for (std::size_t e = 0; e < n; ++e) {
    outer_emissivity_.push_back(outer[e].emissivity);
    inner_emissivity_.push_back(inner.empty() ? 0 : inner[e].emissivity);
  }
  faces_.resize(blocks);
  if (any_wet(outer)) water_.resize(blocks);
  t_.resize(blocks * nodes());
  closure_w_m2_.assign(blocks * kHeatLanes, 0);
  for (std::size_t i = 0; i < blocks * kHeatLanes; ++i) {
    const std::size_t e = std::min(i, n - 1), j = i % kHeatLanes;
    set_properties(outer[e], j, faces_[i / kHeatLanes].outer);
    if (!water_.empty()) set_properties(outer[e].evaporation, j, water_[i / kHeatLanes]);
    set_properties(inner.empty() ? FaceProperties{} : inner[e], j, faces_[i / kHeatLanes].inner);
  }
  lanes_.wet = !water_.empty();
  lanes_.inner_fixed = inner_side == InnerSide::kFixedTemperature;
  lanes_.t.resize(nodes());
  lanes_.t_other = lanes_.inside = lanes_.t;
}

absl::Status WallWalk::advance(std::size_t interval, double length_s, bool smooth) {
  RETURN_IF_ERROR(table_.check(interval, name_));
  if (length_s != interval_s_ || smooth != interval_smooth_) {
    interval_ = heat_interval(grid_, length_s, smooth, level_);
    interval_s_ = length_s;
    interval_smooth_ = smooth;
  }
  const std::size_t n = name_.size(), past = n % kHeatLanes;
  for (std::size_t b = 0; b < faces_.size(); ++b) {
    HeatLane* t = t_.data() + b * nodes();
    if (past != 0 && b + 1 == faces_.size())
      for (std::size_t i = 0; i < nodes(); ++i)
        std::fill(t[i].begin() + past, t[i].end(), t[i][past - 1]);
    lanes_.outer = faces_[b].outer;
    lanes_.inner = faces_[b].inner;
    table_.load(0, b * kHeatLanes, outer_emissivity_, lanes_.outer);
    table_.load(1, b * kHeatLanes, inner_emissivity_, lanes_.inner);
    if (lanes_.wet) {
      lanes_.water = water_[b];
      table_.load_water(b * kHeatLanes, lanes_.water);
    }
    std::copy_n(t, nodes(), lanes_.t.begin());
    double* closure = closure_w_m2_.data() + b * kHeatLanes;
    std::copy_n(closure, kHeatLanes, lanes_.closure_w_m2.begin());
    irsig::advance(grid_, interval_, lanes_);
    std::copy_n(lanes_.t.begin(), nodes(), t);
    std::copy_n(lanes_.closure_w_m2.begin(), kHeatLanes, closure);
  }
  return absl::OkStatus();
}

}  // namespace irsig
