#include "core/thermal/heat_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/thermal/conduction_grid.h"
#include "core/thermal/heat_request_check.h"
#include "core/thermal/periodic_day.h"
#include "core/thermal/wall_walk.h"

namespace irsig {
namespace {

// Elements that are computed together: their temperatures stay in the processor's cache, and the
// elimination of a step, which is common to them, costs little of each.
constexpr std::size_t kGroup = 512;
// Error of rounding and of Newton's method (kLastStepK). [K]
constexpr double kArithmeticErrorK = 1e-6;

bool is_smooth(const HeatRequest& request, std::size_t knot) {
  return !request.smooth.empty() && request.smooth[knot];
}

double shortest_step_s(const HeatRequest& request) {
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < request.knot_s.size(); ++i)
    shortest = std::min(
        shortest, first_step_s(request.knot_s[i + 1] - request.knot_s[i], is_smooth(request, i)));
  return shortest;
}

// Temperatures of some elements at one level. [node x elements + element]
struct Field {
  std::vector<double> t;
  std::size_t elements;

  [[nodiscard]] std::size_t nodes() const { return t.size() / elements; }
};

// Returns the temperatures on a grid with a node between every two.
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
        shortest_s_(shortest_s),
        level_(level),
        grid_(make_grid(request.layers, shortest_s, level)) {}

  [[nodiscard]] const ConductionGrid& grid() const { return grid_; }

  // Returns the temperatures of the nodes from those of the layers; a node between two layers has
  // their mean by the heat capacity next to it.
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

  // Walks from knot `first` to knot `last` and calls at_knot(knot, walk) at every knot on the way,
  // the first included. Adds to closure_w_m2, [element].
  template <typename AtKnot>
  absl::Status advance(std::span<const std::uint32_t> element, std::size_t first, std::size_t last,
                       Field& field, std::vector<double>& closure_w_m2, const AtKnot& at_knot) {
    const std::size_t n = element.size(), nodes = field.nodes();
    std::vector<FaceProperties> outer, inner;
    for (const std::uint32_t e : element) {
      outer.push_back(request_.outer[e]);
      if (!request_.inner.empty()) inner.push_back(request_.inner[e]);
    }
    WallWalk walk(request_.layers, request_.inner_side, shortest_s_, level_,
                  {element.begin(), element.end()}, outer, inner);
    for (std::size_t i = 0; i < nodes; ++i)
      for (std::size_t e = 0; e < n; ++e) walk.kelvin(i, e) = field.t[i * n + e];
    at_knot(first, walk);
    for (std::size_t k = first; k < last; ++k) {
      exposure_of_(k, element, walk.exposure());
      RETURN_IF_ERROR(
          walk.advance(k, request_.knot_s[k + 1] - request_.knot_s[k], is_smooth(request_, k)));
      at_knot(k + 1, walk);
    }
    for (std::size_t i = 0; i < nodes; ++i)
      for (std::size_t e = 0; e < n; ++e) field.t[i * n + e] = walk.kelvin(i, e);
    for (std::size_t e = 0; e < n; ++e)
      closure_w_m2[e] = std::max(closure_w_m2[e], walk.closure_w_m2(e));
    return absl::OkStatus();
  }

 private:
  const HeatRequest& request_;
  const ExposureOf& exposure_of_;
  double shortest_s_;
  int level_;
  ConductionGrid grid_;
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
    RETURN_IF_ERROR(run.advance(part_element, 0, start.intervals, part, closure,
                                [](std::size_t, const WallWalk&) {}));
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
    RETURN_IF_ERROR(pass(0, element, day_begin, coarse));
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
      RETURN_IF_ERROR(pass(0, element, unused, other, stated->uncertainty_k));
      for (std::size_t i = 0; i < start_left.size(); ++i) {
        start_left[i] = std::abs(other.output[i] - coarse.output[i]);
      }
    }
    // Change of the level before, [output knot x elements + element].
    std::vector<double> change_before(request_.output_knot.size() * element.size(), 0);
    for (int level = 1; level <= request_.accuracy.max_level && !element.empty(); ++level) {
      if (!day_begin.t.empty()) day_begin = refined(day_begin);
      Pass fine;
      RETURN_IF_ERROR(pass(level, element, day_begin, fine));
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

  // Returns the guess of a periodic start's begin, if there is one.
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
      RETURN_IF_ERROR(repeat_day(run, *periodic, element, day_begin, out.day_left_k));
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
    const auto note = [&](std::size_t knot, const WallWalk& at) {
      if (next == request_.output_knot.size() || request_.output_knot[next] != knot) return;
      ++next;
      for (std::size_t i = 0; i < nodes(); ++i)
        for (std::size_t e = 0; e < n; ++e) out.output.push_back(at.kelvin(i << level, e));
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
  RETURN_IF_ERROR(check_request(request));
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
    RETURN_IF_ERROR(solver.solve(std::move(element)));
  }
  return result;
}

}  // namespace irsig
