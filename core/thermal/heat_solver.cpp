#include "core/thermal/heat_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/thermal/conduction_grid.h"
#include "core/thermal/heat_request_check.h"
#include "core/thermal/heat_steps.h"
#include "core/thermal/periodic_day.h"

namespace irsig {
namespace {

// Elements that are computed together: their temperatures stay in the processor's cache, and the
// elimination of a step, which is common to them, costs little of each.
constexpr std::size_t kGroup = 512;
// Steps of an interval at level 0: its length in units of this, the square root of it many, and the
// first halved until it is no longer than the unit: what changes at a knot at once fades like the
// square root of time.
constexpr double kFirstStepS = 60;
// Of rounding and of Newton's method, see kLastStepK.
constexpr double kArithmeticErrorK = 1e-6;

// Where nothing jumps, steps are equal and at most this.
constexpr double kSmoothStepS = 300;

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

bool is_smooth(const HeatRequest& request, std::size_t knot) {
  return !request.smooth.empty() && request.smooth[knot];
}

double shortest_step_s(const HeatRequest& request) {
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < request.knot_s.size(); ++i) {
    shortest = std::min(shortest, interval_steps(request.knot_s[i + 1] - request.knot_s[i],
                                                 is_smooth(request, i), 0)
                                      .front());
  }
  return shortest;
}

// An exposure's arrays, and what must stand in them.
class ExposureTable {
 public:
  ExposureTable(std::size_t elements, InnerSide inner)
      : elements_(elements), inner_(inner), value_(kColumns * elements) {}

  absl::Status fill(std::size_t interval, std::span<const std::uint32_t> element,
                    const ExposureOf& exposure_of) {
    std::ranges::fill(value_, std::numeric_limits<double>::quiet_NaN());
    const auto face = [&](std::size_t k) {
      return FaceExposure{column(k), column(k + 1), column(k + 2), column(k + 3)};
    };
    exposure_of(interval, element, {face(0), face(4), face(8), face(12)});
    for (std::size_t k = 0; k < kColumns; ++k) {
      if (k >= 8 && !uses(k % 4)) continue;
      const auto& [name, low, high] = kRange[k % 4];
      for (std::size_t e = 0; e < elements_; ++e) {
        const double value = column(k)[e];
        if (!(value >= low && value <= high)) {
          return wrong_number(
              absl::StrCat("interval ", interval, ", element ", element[e], ", ",
                           k < 8 ? "outer " : "inner ", k / 4 % 2 == 0 ? "begin: " : "end: ", name),
              value, absl::StrCat(low, " to ", high));
        }
      }
    }
    return absl::OkStatus();
  }

  // face 0: outer, 1: inner. Absent elements of the last lanes are the last element's copies.
  void load(std::size_t face, std::size_t first, std::span<const double> emissivity,
            HeatFace& out) {
    for (std::size_t j = 0; j < kHeatLanes; ++j) {
      const std::size_t e = std::min(first + j, elements_ - 1);
      const auto at = [&](std::size_t end, std::size_t k) {
        return face == 0 || uses(k) ? value_[(8 * face + 4 * end + k) * elements_ + e] : 0.0;
      };
      const auto vary = [&](HeatFace::Varying& varying, double begin, double end) {
        varying.begin[j] = begin;
        varying.change[j] = end - begin;
      };
      vary(out.gain_w_m2, at(0, 0) + emissivity[e] * at(0, 1), at(1, 0) + emissivity[e] * at(1, 1));
      vary(out.fluid_k, at(0, 2), at(1, 2));
      vary(out.forced_w_m2_k, at(0, 3), at(1, 3));
    }
  }

 private:
  struct Range {
    const char* name;
    double low, high;
  };
  static constexpr std::array<Range, 4> kRange{{{"absorbed_w_m2", -1e9, 1e9},
                                                {"incoming_w_m2", 0, 1e9},
                                                {"fluid_k", 1e-9, 1e5},
                                                {"forced_h_w_m2_k", 0, 1e9}}};
  static constexpr std::size_t kColumns = 16;

  [[nodiscard]] std::span<double> column(std::size_t k) {
    return std::span(value_).subspan(k * elements_, elements_);
  }
  [[nodiscard]] bool uses(std::size_t k) const {  // by the inner face
    switch (inner_) {
      case InnerSide::kAdiabatic:
        return false;
      case InnerSide::kHeatFlux:
        return k == 0;
      case InnerSide::kAir:
        return k >= 2;
      case InnerSide::kFixedTemperature:
        return k == 2;
      case InnerSide::kOpen:
        return true;
    }
    return true;
  }

  std::size_t elements_;
  InnerSide inner_;
  std::vector<double> value_;
};

// Temperatures of some elements at one level. [node x elements + element]
struct Field {
  std::vector<double> t;
  std::size_t elements;

  [[nodiscard]] std::size_t nodes() const { return t.size() / elements; }
};

// The same temperatures on a grid with a node between every two.
Field refined(const Field& coarse) {
  const std::size_t n = coarse.elements, rows = 2 * coarse.nodes() - 1;
  Field fine{std::vector<double>(rows * n), n};
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t e = 0; e < n; ++e) {
      fine.t[i * n + e] = 0.5 * (coarse.t[i / 2 * n + e] + coarse.t[(i + 1) / 2 * n + e]);
    }
  }
  return fine;
}

Field selected(const Field& field, std::span<const std::size_t> which) {
  Field out{{}, which.size()};
  for (std::size_t i = 0; i < field.nodes(); ++i) {
    for (const std::size_t e : which) out.t.push_back(field.t[i * field.elements + e]);
  }
  return out;
}

template <typename T>
std::vector<T> selected(const std::vector<T>& values, std::span<const std::size_t> which) {
  std::vector<T> out;
  for (const std::size_t e : which) out.push_back(values[e]);
  return out;
}

// Some elements of a request at one level.
class LevelRun {
 public:
  LevelRun(const HeatRequest& request, const ExposureOf& exposure_of, double shortest_s, int level)
      : request_(request),
        exposure_of_(exposure_of),
        level_(level),
        grid_(make_grid(request.layers, shortest_s, level)) {}

  [[nodiscard]] const ConductionGrid& grid() const { return grid_; }

  // Of the nodes, from those of the layers; between two layers the mean by heat capacity next to
  // it.
  [[nodiscard]] std::vector<double> start_k(const std::vector<double>& layer_k) const {
    std::vector<double> node_k(grid_.last() + 1);
    for (std::size_t layer = 0; layer < request_.layers.size(); ++layer) {
      const double t = layer_k[std::min(layer, layer_k.size() - 1)];
      const std::size_t begin = grid_.boundary_node[layer], end = grid_.boundary_node[layer + 1];
      const double share = layer == 0 ? 1 : grid_.share_of_next[layer - 1];
      node_k[begin] += share * (t - node_k[begin]);
      std::fill(node_k.begin() + static_cast<std::ptrdiff_t>(begin) + 1,
                node_k.begin() + static_cast<std::ptrdiff_t>(end) + 1, t);
    }
    return node_k;
  }

  // From knot `first` to knot `last`; at every knot on the way, the first included, at_knot(knot,
  // field). Adds to closure_w_m2, [element].
  template <typename AtKnot>
  absl::Status advance(std::span<const std::uint32_t> element, std::size_t first, std::size_t last,
                       Field& field, std::vector<double>& closure_w_m2, const AtKnot& at_knot) {
    const std::size_t n = element.size();
    ExposureTable table(n, request_.inner_side);
    std::vector<double> outer_emissivity, inner_emissivity;
    for (const std::uint32_t e : element) {
      outer_emissivity.push_back(request_.outer[e].emissivity);
      inner_emissivity.push_back(request_.inner.empty() ? 0 : request_.inner[e].emissivity);
    }
    HeatLanes lanes;
    lanes.inner_fixed = request_.inner_side == InnerSide::kFixedTemperature;
    lanes.t.resize(grid_.last() + 1);
    lanes.t_other = lanes.inside = lanes.t;
    at_knot(first, field);
    for (std::size_t k = first; k < last; ++k) {
      if (absl::Status s = table.fill(k, element, exposure_of_); !s.ok()) return s;
      const double length_s = request_.knot_s[k + 1] - request_.knot_s[k];
      const bool smooth = is_smooth(request_, k);
      if (length_s != interval_s_ || smooth != interval_smooth_) {
        interval_ = heat_interval(grid_, length_s, smooth, level_);
        interval_s_ = length_s;
        interval_smooth_ = smooth;
      }
      for (std::size_t e = 0; e < n; e += kHeatLanes) {
        const std::size_t count = std::min(kHeatLanes, n - e);
        table.load(0, e, outer_emissivity, lanes.outer);
        table.load(1, e, inner_emissivity, lanes.inner);
        for (std::size_t j = 0; j < kHeatLanes; ++j) {
          const std::size_t from = std::min(e + j, n - 1);
          load_properties(request_.outer[element[from]], j, lanes.outer);
          load_properties(request_.inner.empty() ? FaceProperties{} : request_.inner[element[from]],
                          j, lanes.inner);
          for (std::size_t i = 0; i < lanes.t.size(); ++i) lanes.t[i][j] = field.t[i * n + from];
          lanes.closure_w_m2[j] = closure_w_m2[from];
        }
        irsig::advance(grid_, interval_, lanes);
        for (std::size_t j = 0; j < count; ++j) {
          for (std::size_t i = 0; i < lanes.t.size(); ++i) field.t[i * n + e + j] = lanes.t[i][j];
          closure_w_m2[e + j] = lanes.closure_w_m2[j];
        }
      }
      at_knot(k + 1, field);
    }
    return absl::OkStatus();
  }

 private:
  static void load_properties(const FaceProperties& face, std::size_t j, HeatFace& out) {
    out.emission_w_m2_k4[j] = face.emissivity * kStefanBoltzmannWM2K4;
    out.natural_warm[j] = face.convection.natural_warm;
    out.natural_cold[j] = face.convection.natural_cold;
    out.mixing[j] = face.convection.mixing;
  }

  const HeatRequest& request_;
  const ExposureOf& exposure_of_;
  int level_;
  ConductionGrid grid_;
  double interval_s_ = 0;
  bool interval_smooth_ = false;
  HeatInterval interval_;
};

// Repeats the first day from `field` until it returns to where it began, for each element by
// itself. Out: the temperatures it begins with, and what is left, [element].
absl::Status repeat_day(LevelRun& run, const PeriodicStart& start,
                        std::span<const std::uint32_t> element, Field& field,
                        std::vector<double>& left_k) {
  const std::size_t n = element.size(), nodes = field.nodes();
  std::vector<PeriodicDay> day(n);
  std::vector<std::size_t> open(n);
  std::iota(open.begin(), open.end(), std::size_t{0});
  std::vector<double> begin(nodes), end(nodes);
  left_k.assign(n, 0);
  for (int d = 0; d < start.max_days && !open.empty(); ++d) {
    Field part = selected(field, open);
    std::vector<std::uint32_t> part_element;
    for (const std::size_t e : open) part_element.push_back(element[e]);
    std::vector<double> closure(open.size(), 0);
    if (absl::Status s = run.advance(part_element, 0, start.intervals, part, closure,
                                     [](std::size_t, const Field&) {});
        !s.ok()) {
      return s;
    }
    std::vector<std::size_t> still;
    for (std::size_t k = 0; k < open.size(); ++k) {
      const std::size_t e = open[k];
      for (std::size_t i = 0; i < nodes; ++i) {
        begin[i] = field.t[i * n + e];
        end[i] = part.t[i * open.size() + k];
      }
      const PeriodicDay::Next next = day[e].next(begin, end);
      for (std::size_t i = 0; i < nodes; ++i) field.t[i * n + e] = next.begin_k[i];
      left_k[e] = next.left_k;
      if (!(next.left_k <= start.tolerance_k)) still.push_back(e);
    }
    open = std::move(still);
  }
  return absl::OkStatus();
}

class GroupSolver {
 public:
  GroupSolver(const HeatRequest& request, const ExposureOf& exposure_of, HeatResult& result)
      : request_(request),
        exposure_of_(exposure_of),
        shortest_s_(shortest_step_s(request)),
        coarse_(make_grid(request.layers, shortest_s_, 0)),
        result_(result) {}

  [[nodiscard]] std::size_t nodes() const { return coarse_.last() + 1; }

  absl::Status solve(std::vector<std::uint32_t> element) {
    Pass coarse;
    Field day_begin = stated_begin(element);
    if (absl::Status s = pass(0, element, day_begin, coarse); !s.ok()) return s;
    note_begin(0, element, day_begin);
    if (request_.accuracy.max_level == 0) {
      note_once(element, coarse);
      return absl::OkStatus();
    }
    std::vector<double> start_left(coarse.output.size(), 0);
    if (const auto* stated = std::get_if<StatedStart>(&request_.start);
        stated != nullptr && stated->uncertainty_k > 0) {
      Pass other;
      Field unused;
      if (absl::Status s = pass(0, element, unused, other, stated->uncertainty_k); !s.ok())
        return s;
      for (std::size_t i = 0; i < start_left.size(); ++i) {
        start_left[i] = std::abs(other.output[i] - coarse.output[i]);
      }
    }
    // Of the level before, [output knot x elements + element].
    std::vector<double> change_before(request_.output_knot.size() * element.size(), 0);
    for (int level = 1; level <= request_.accuracy.max_level && !element.empty(); ++level) {
      if (!day_begin.t.empty()) day_begin = refined(day_begin);
      Pass fine;
      if (absl::Status s = pass(level, element, day_begin, fine); !s.ok()) return s;
      note_begin(level, element, day_begin);
      const std::size_t n = element.size();
      std::vector<std::size_t> open;
      for (std::size_t e = 0; e < n; ++e) {
        const std::size_t to = element[e];
        double largest = 0;
        for (std::size_t k = 0; k < request_.output_knot.size(); ++k) {
          const auto row = [&](std::size_t node) { return (k * nodes() + node) * n + e; };
          // At one place the difference of two levels passes through zero; not everywhere at once,
          // and not for two levels in turn, whose differences are as 4 to 1.
          double change = change_before[k * n + e] / 4;
          for (std::size_t i = 0; i < nodes(); ++i) {
            change = std::max(change, std::abs(fine.output[row(i)] - coarse.output[row(i)]));
          }
          change_before[k * n + e] = change;
          largest = std::max(largest, change);
          for (std::size_t b = 0; b < result_.boundaries; ++b) {
            const std::size_t at = result_.at(k, b, to);
            const std::size_t from = row(coarse_.boundary_node[request_.output_boundary[b]]);
            result_.temperature_k[at] = fine.output[from];
            result_.error_k[at] =
                change + start_left[from] + fine.day_left_k[e] + kArithmeticErrorK;
          }
        }
        result_.level[to] = level;
        result_.closure_w_m2[to] = fine.closure_w_m2[e];
        // A day whose begin is not found better than that says no more when it is cut finer.
        if (!(largest <= std::max(request_.accuracy.tolerance_k, fine.day_left_k[e])))
          open.push_back(e);
      }
      coarse.output = rows_of(fine.output, n, open);
      change_before = rows_of(change_before, n, open);
      start_left = rows_of(start_left, n, open);
      if (!day_begin.t.empty()) day_begin = selected(day_begin, open);
      element = selected(element, open);
    }
    return absl::OkStatus();
  }

 private:
  struct Pass {
    std::vector<double> output;  // [(output knot x nodes of level 0 + node) x elements + element]
    std::vector<double> day_left_k;  // [element]
    std::vector<double> closure_w_m2;
  };

  // Of a periodic start: the guess of its begin, if there is one.
  [[nodiscard]] Field stated_begin(std::span<const std::uint32_t> element) const {
    const auto* periodic = std::get_if<PeriodicStart>(&request_.start);
    if (periodic == nullptr || periodic->begin_k.empty()) return {};
    Field out{{}, element.size()};
    for (std::size_t i = 0; i < nodes(); ++i)
      for (const std::uint32_t e : element)
        out.t.push_back(periodic->begin_k[i * result_.elements + e]);
    return out;
  }
  void note_begin(int level, std::span<const std::uint32_t> element, const Field& day_begin) {
    if (day_begin.t.empty()) return;
    result_.begin_k.resize(nodes() * result_.elements);
    for (std::size_t i = 0; i < nodes(); ++i)
      for (std::size_t e = 0; e < element.size(); ++e)
        result_.begin_k[i * result_.elements + element[e]] =
            day_begin.t[(i << level) * element.size() + e];
  }
  // The only level.
  void note_once(std::span<const std::uint32_t> element, const Pass& pass) {
    const std::size_t n = element.size();
    for (std::size_t e = 0; e < n; ++e) {
      for (std::size_t k = 0; k < request_.output_knot.size(); ++k)
        for (std::size_t b = 0; b < result_.boundaries; ++b) {
          const std::size_t node = coarse_.boundary_node[request_.output_boundary[b]],
                            at = result_.at(k, b, element[e]);
          result_.temperature_k[at] = pass.output[(k * nodes() + node) * n + e];
          result_.error_k[at] = std::numeric_limits<double>::infinity();
        }
      result_.level[element[e]] = 0;
      result_.closure_w_m2[element[e]] = pass.closure_w_m2[e];
    }
  }

  static std::vector<double> rows_of(const std::vector<double>& table, std::size_t n,
                                     std::span<const std::size_t> which) {
    std::vector<double> out;
    for (std::size_t row = 0; row < table.size(); row += n) {
      for (const std::size_t e : which) out.push_back(table[row + e]);
    }
    return out;
  }

  // day_begin: of a periodic start, a guess or empty; then what was found.
  absl::Status pass(int level, std::span<const std::uint32_t> element, Field& day_begin, Pass& out,
                    double warmer_k = 0) {
    LevelRun run(request_, exposure_of_, shortest_s_, level);
    const std::size_t n = element.size();
    out.day_left_k.assign(n, 0);
    Field field;
    if (const auto* periodic = std::get_if<PeriodicStart>(&request_.start)) {
      if (day_begin.t.empty()) {
        day_begin = {std::vector<double>((run.grid().last() + 1) * n, periodic->guess_k), n};
      }
      if (absl::Status s = repeat_day(run, *periodic, element, day_begin, out.day_left_k);
          !s.ok()) {
        return s;
      }
      field = day_begin;
    } else {
      field.elements = n;
      for (const double t : run.start_k(std::get<StatedStart>(request_.start).temperature_k)) {
        field.t.insert(field.t.end(), n, t + warmer_k);
      }
    }
    out.closure_w_m2.assign(n, 0);
    out.output.reserve(request_.output_knot.size() * nodes() * n);
    std::size_t next = 0;
    const auto note = [&](std::size_t knot, const Field& at) {
      if (next == request_.output_knot.size() || request_.output_knot[next] != knot) return;
      ++next;
      for (std::size_t i = 0; i < nodes(); ++i) {
        const auto row = at.t.begin() + static_cast<std::ptrdiff_t>((i << level) * n);
        out.output.insert(out.output.end(), row, row + static_cast<std::ptrdiff_t>(n));
      }
    };
    const std::size_t last = request_.output_knot.empty() ? 0 : request_.output_knot.back();
    return run.advance(element, 0, last, field, out.closure_w_m2, note);
  }

  const HeatRequest& request_;
  const ExposureOf& exposure_of_;
  double shortest_s_;
  ConductionGrid coarse_;  // level 0
  HeatResult& result_;
};

}  // namespace

absl::StatusOr<HeatResult> solve_heat(const HeatRequest& request, const ExposureOf& exposure_of) {
  if (absl::Status status = check_request(request); !status.ok()) return status;
  HeatResult result;
  result.boundaries = request.output_boundary.size();
  result.elements = request.outer.size();
  result.temperature_k.resize(request.output_knot.size() * result.boundaries * result.elements);
  result.error_k = result.temperature_k;
  result.level.resize(result.elements);
  result.closure_w_m2.resize(result.elements);
  GroupSolver solver(request, exposure_of, result);
  if (const auto* periodic = std::get_if<PeriodicStart>(&request.start);
      periodic != nullptr && !periodic->begin_k.empty() &&
      periodic->begin_k.size() != solver.nodes() * result.elements)
    return wrong_number("start: number of begin_k", static_cast<double>(periodic->begin_k.size()),
                        absl::StrCat(solver.nodes() * result.elements));
  for (std::size_t first = 0; first < result.elements; first += kGroup) {
    std::vector<std::uint32_t> element(std::min(kGroup, result.elements - first));
    std::iota(element.begin(), element.end(), static_cast<std::uint32_t>(first));
    if (absl::Status status = solver.solve(std::move(element)); !status.ok()) return status;
  }
  return result;
}

}  // namespace irsig
