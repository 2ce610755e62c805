#include "core/thermal/scene/scene_walls.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "core/base/check.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

constexpr int kMostPasses = 60;
constexpr double kSlowest = 0.999;  // changes may fall by, from pass to pass
constexpr int kMostLevels = 4;      // of walls alone: one more takes four times as long
// Of what faces send to each other; a wall is warmer by less than a tenth of it in kelvin.
constexpr double kExchangeWM2 = 1e-3;
// Error of rounding and of Newton's method (heat_steps.h). [K]
constexpr double kArithmeticErrorK = 1e-6;

using Side = SceneExposure::Side;

FaceProperties mean_of(const std::vector<FaceProperties>& faces) {
  FaceProperties out{0, {0, 0, 0}, {}};
  for (const FaceProperties& f : faces) {
    const double share = 1 / static_cast<double>(faces.size());
    out.emissivity += share * f.emissivity;
    out.convection.natural_warm += share * f.convection.natural_warm;
    out.convection.natural_cold += share * f.convection.natural_cold;
    out.convection.mixing += share * f.convection.mixing;
    out.evaporation.on |= f.evaporation.on;
    out.evaporation.bare += share * f.evaporation.bare;
    out.evaporation.cover += share * f.evaporation.cover;
  }
  return out;
}

// A value that is filled in for nobody stays NaN.
void fill_with_means(const Exposure& of, const Exposure& to) {
  const auto face = [](const FaceExposure& from, const FaceExposure& at) {
    const auto number = [](std::span<const double> values, std::span<double> out) {
      double sum = 0;
      for (const double v : values) sum += v;
      std::ranges::fill(out, sum / static_cast<double>(values.size()));
    };
    number(from.absorbed_w_m2, at.absorbed_w_m2);
    number(from.incoming_w_m2, at.incoming_w_m2);
    number(from.fluid_k, at.fluid_k);
    number(from.forced_h_w_m2_k, at.forced_h_w_m2_k);
    if (from.vapour_pa.empty()) return;
    number(from.vapour_pa, at.vapour_pa);
    number(from.inverse_gamma_k_pa, at.inverse_gamma_k_pa);
    number(from.stomatal_w_m2_k, at.stomatal_w_m2_k);
  };
  face(of.outer_begin, to.outer_begin);
  face(of.outer_end, to.outer_end);
  face(of.inner_begin, to.inner_begin);
  face(of.inner_end, to.inner_end);
}

}  // namespace

SceneWalls::SceneWalls(SceneExposure& exposure, const SceneHeatRequest& request, double shortest_s)
    : exposure_(exposure),
      request_(request),
      faces_(exposure.faces()),
      shortest_s_(shortest_s),
      mean_k_(0),
      incoming_(exposure.knots() * faces_.size()),
      kelvin_(incoming_.size()),
      error_k_(faces_.size()) {
  for (std::size_t k = 0; k < exposure_.knots(); ++k) {
    const double air_k = exposure_.weather(k).air_k;
    mean_k_ += air_k / static_cast<double>(exposure_.knots());
    for (std::uint32_t i = 0; i < faces_.size(); ++i) {
      const HeatPart& part = exposure_.part_of(i);
      kelvin_[k * faces_.size() + i] = static_cast<float>(part.build_up ? air_k : part.stated_k);
    }
  }
  for (std::uint32_t b = 0; b < request_.build_up.size(); ++b) {
    Wall wall;
    wall.build_up = b;
    const bool open = request_.build_up[b].inner_side == InnerSide::kOpen;
    for (std::uint32_t i = 0; i < faces_.fronts; ++i) {
      if (exposure_.part_of(i).build_up != b || faces_.area_m2[i] <= 0 || exposure_.dark(i))
        continue;
      wall.face.push_back(i);
      wall.back.push_back(faces_.back_of_facet[i]);
      wall.outer.push_back(exposure_.properties(i));
      if (open && wall.back.back() != ThermalFaces::kNone)
        wall.inner.push_back(exposure_.properties(wall.back.back()));
    }
    if (wall.face.empty()) continue;
    wall.day_left_k.resize(wall.face.size());
    wall_.push_back(std::move(wall));
  }
}

absl::Status SceneWalls::named(const Wall& wall, const absl::Status& status) const {
  return absl::Status(
      status.code(), absl::StrCat("build_up \"", build_up_of(wall).name, "\": ", status.message()));
}

absl::Status SceneWalls::check() const {
  for (const Wall& wall : wall_) {
    const WallBuildUp& build_up = build_up_of(wall);
    if (absl::Status s = check_layers(build_up.layers); !s.ok()) return named(wall, s);
    if (build_up.inner_side == InnerSide::kOpen && wall.inner.size() != wall.face.size())
      return named(wall, absl::InvalidArgumentError(
                             "its inside is open, and a part made of it is not two_sided"));
  }
  return absl::OkStatus();
}

std::vector<WallWalk> SceneWalls::walks_at_begin(std::span<const Wall> walls, int level) const {
  std::vector<WallWalk> out;
  for (const Wall& wall : walls) {
    const WallBuildUp& build_up = build_up_of(wall);
    WallWalk& walk = out.emplace_back(build_up.layers, build_up.inner_side, shortest_s_, level,
                                      wall.face, wall.outer, wall.inner);
    for (std::size_t e = 0; e < wall.face.size(); ++e)
      for (std::size_t i = 0; i < walk.nodes(); ++i)
        walk.kelvin(i, e) = wall.begin_k.empty() ? mean_k_ : wall.begin_k[e * walk.nodes() + i];
  }
  return out;
}

void SceneWalls::note_kelvin(std::size_t k, std::span<const Wall> walls,
                             const std::vector<WallWalk>& walks) {
  float* kelvin = kelvin_.data() + k * faces_.size();
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const Wall& wall = walls[w];
    const bool open = build_up_of(wall).inner_side == InnerSide::kOpen;
    for (std::size_t e = 0; e < wall.face.size(); ++e) {
      kelvin[wall.face[e]] = static_cast<float>(walks[w].kelvin(0, e));
      // A closed plate of which one side is modelled has the back's temperature of its front.
      if (wall.back[e] != ThermalFaces::kNone)
        kelvin[wall.back[e]] = open ? static_cast<float>(walks[w].kelvin(walks[w].nodes() - 1, e))
                                    : kelvin[wall.face[e]];
    }
  }
}

void SceneWalls::inside(const Wall& wall, std::size_t k, Side side, const FaceExposure& to) const {
  const WallBuildUp& build_up = build_up_of(wall);
  const auto now = [&](double constant) {
    if (build_up.inner_at.empty()) return constant;
    const ScheduleAtKnot& at = build_up.inner_at[exposure_.of_request(k)];
    return side == Side::kAfter ? at.after : at.before;
  };
  switch (build_up.inner_side) {
    case InnerSide::kAdiabatic:
      return;
    case InnerSide::kHeatFlux:
      std::ranges::fill(to.absorbed_w_m2, now(build_up.inner_flux_w_m2));
      return;
    case InnerSide::kAir:
      std::ranges::fill(to.forced_h_w_m2_k, build_up.inner_h_w_m2_k);
      std::ranges::fill(to.fluid_k, now(build_up.inner_k));
      return;
    case InnerSide::kFixedTemperature:
      std::ranges::fill(to.fluid_k, now(build_up.inner_k));
      return;
    case InnerSide::kOpen:
      exposure_.expose(k, side, wall.back, to);
      return;
  }
}

absl::Status SceneWalls::pass(std::size_t first, std::size_t last, Incoming incoming,
                              std::span<const Wall> walls, std::vector<WallWalk>& walks,
                              std::span<std::optional<WallWalk>> probes) {
  const std::size_t n = faces_.size();
  std::vector<double> now(n), next(n);
  for (std::size_t k = first;; ++k) {
    note_kelvin(k, walls, walks);
    const std::span<const float> kelvin(kelvin_.data() + k * n, n);
    float* stored = incoming_.data() + k * n;
    if (k > first)
      now = next;
    else if (incoming != Incoming::kForeseen)
      now.assign(stored, stored + n);
    if (k == last && incoming == Incoming::kFixed) break;
    if (incoming != Incoming::kFixed) exposure_.long_wave(k, kelvin, kExchangeWM2, now);
    if (k < last) {
      if (incoming == Incoming::kForeseen) {
        next = now;
        exposure_.long_wave(k + 1, kelvin, kExchangeWM2, next);
      } else {
        for (std::size_t i = 0; i < n; ++i)
          next[i] = std::max(
              0.0, static_cast<double>(stored[n + i]) + now[i] - static_cast<double>(stored[i]));
      }
    }
    for (std::size_t i = 0; i < n; ++i) stored[i] = static_cast<float>(now[i]);
    if (k == last) break;
    for (std::size_t w = 0; w < walls.size(); ++w) {
      const Wall& wall = walls[w];
      const Exposure to = walks[w].exposure();
      const auto both = [&](std::span<const std::uint32_t> face, const FaceExposure& begin,
                            const FaceExposure& end) {
        for (std::size_t at = 0; at < face.size(); ++at) {
          const std::uint32_t f = face[at];
          begin.incoming_w_m2[at] = std::max(0.0, now[f] + exposure_.sky_jump_w_m2(k, f));
          end.incoming_w_m2[at] = std::max(0.0, next[f] - exposure_.sky_jump_w_m2(k + 1, f));
        }
      };
      exposure_.expose(k, Side::kAfter, wall.face, to.outer_begin);
      exposure_.expose(k + 1, Side::kBefore, wall.face, to.outer_end);
      both(wall.face, to.outer_begin, to.outer_end);
      inside(wall, k, Side::kAfter, to.inner_begin);
      inside(wall, k + 1, Side::kBefore, to.inner_end);
      if (!wall.inner.empty()) both(wall.back, to.inner_begin, to.inner_end);
      const double length_s = exposure_.knot_s(k + 1) - exposure_.knot_s(k);
      const bool smooth =
          exposure_.is_smooth(k) && !build_up_of(wall).jumps_at(exposure_.of_request(k));
      if (!probes.empty() && probes[w]) {
        fill_with_means(to, probes[w]->exposure());
        if (absl::Status s = probes[w]->advance(k, length_s, smooth); !s.ok())
          return named(wall, s);
      }
      if (absl::Status s = walks[w].advance(k, length_s, smooth); !s.ok()) return named(wall, s);
    }
  }
  return absl::OkStatus();
}

WallWalk SceneWalls::probes(const Wall& wall, int level) const {
  const WallBuildUp& build_up = build_up_of(wall);
  const ConductionGrid grid = make_grid(build_up.layers, shortest_s_, level);
  const std::size_t nodes = grid.last() + 1;
  const std::vector<FaceProperties> outer(nodes + 1, mean_of(wall.outer)),
      inner(wall.inner.empty() ? 0 : nodes + 1, mean_of(wall.inner));
  WallWalk out(build_up.layers, build_up.inner_side, shortest_s_, level,
               std::vector<std::uint32_t>(nodes + 1, wall.face.front()), outer, inner);
  const auto elements = static_cast<double>(wall.face.size());
  for (std::size_t i = 0; i < nodes; ++i) {
    double mean = wall.begin_k.empty() ? mean_k_ : 0;
    for (std::size_t at = i; at < wall.begin_k.size(); at += nodes)
      mean += wall.begin_k[at] / elements;
    for (std::size_t e = 0; e <= nodes; ++e)
      out.kelvin(i, e) = mean + (e == i + 1 ? DayResponse::kProbeK : 0);
  }
  return out;
}

absl::StatusOr<double> SceneWalls::day(Incoming incoming, int level, std::span<Wall> walls,
                                       std::vector<WallWalk>& walks) {
  walks = walks_at_begin(walls, level);
  std::vector<std::optional<WallWalk>> probe(walls.size());
  for (std::size_t w = 0; w < walls.size(); ++w)
    if (!walls[w].response) probe[w] = probes(walls[w], level);
  RETURN_IF_ERROR(pass(0, exposure_.day_intervals(), incoming, walls, walks, probe));
  double left_k = 0;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    if (probe[w]) {
      std::vector<double> end;
      for (std::size_t e = 0; e < probe[w]->elements(); ++e)
        for (std::size_t i = 0; i < probe[w]->nodes(); ++i) end.push_back(probe[w]->kelvin(i, e));
      walls[w].response.emplace(end, probe[w]->nodes());
    }
    left_k = std::max(left_k, next_begin(walks[w], walls[w]));
  }
  return left_k;
}

double SceneWalls::next_begin(const WallWalk& walk, Wall& wall) const {
  // If the step has not become half as long, the typical element is not like this one. Two steps
  // then give the correction (Anderson's method of depth 1 [walker2011]).
  constexpr double kFallsWell = 0.5;
  const std::size_t nodes = walk.nodes(), elements = wall.face.size();
  if (wall.begin_k.empty()) wall.begin_k.assign(nodes * elements, mean_k_);
  const bool first = wall.step_k.empty();
  wall.before_k.resize(nodes * elements);
  wall.step_k.resize(nodes * elements);
  std::vector<double> step(nodes), next(nodes);
  double largest_k = 0;
  for (std::size_t e = 0; e < elements; ++e) {
    double *begin = wall.begin_k.data() + e * nodes, *before = wall.before_k.data() + e * nodes,
           *step_before = wall.step_k.data() + e * nodes;
    for (std::size_t i = 0; i < nodes; ++i) step[i] = walk.kelvin(i, e) - begin[i];
    wall.response->go_on(step);
    double size = 0, size_before = 0, turn = 0, along = 0, left_k = 0;
    for (std::size_t i = 0; i < nodes; ++i) {
      const double change = step[i] - step_before[i];
      size += step[i] * step[i];
      size_before += step_before[i] * step_before[i];
      turn += change * change;
      along += change * step[i];
      next[i] = begin[i] + step[i];
    }
    if (!first && size > kFallsWell * kFallsWell * size_before && turn > 1e-12 * size_before)
      for (std::size_t i = 0; i < nodes; ++i)
        next[i] -= along / turn * (next[i] - before[i] - step_before[i]);
    // Far from the solution a day's change is not linear. How warm the wall itself is says what is
    // far: one that glows is no longer compared with the air.
    double coldest_k = begin[0], hottest_k = begin[0];
    for (std::size_t i = 0; i < nodes; ++i) {
      coldest_k = std::min({coldest_k, begin[i], walk.kelvin(i, e)});
      hottest_k = std::max({hottest_k, begin[i], walk.kelvin(i, e)});
    }
    const auto [low, high] = std::ranges::minmax(next);
    const bool near = low > 0.5 * coldest_k && high < 2 * hottest_k;
    for (std::size_t i = 0; i < nodes; ++i) {
      if (!near) next[i] = walk.kelvin(i, e);
      left_k = std::max(left_k, std::abs(near ? next[i] - begin[i] : hottest_k));
      before[i] = begin[i];
      step_before[i] = step[i];
      begin[i] = next[i];
    }
    wall.day_left_k[e] = left_k;
    largest_k = std::max(largest_k, left_k);
  }
  return largest_k;
}

double SceneWalls::largest_change_k(const std::vector<float>& before, std::size_t first,
                                    std::size_t last) const {
  float out = 0;
  for (std::size_t i = first * faces_.size(); i < (last + 1) * faces_.size(); ++i)
    out = std::max(out, std::abs(kelvin_[i] - before[i]));
  return static_cast<double>(out);
}

absl::Status SceneWalls::settle(std::size_t first, std::size_t last, bool repeats,
                                std::vector<WallWalk>& walks) {
  const std::vector<WallWalk> at_first = walks;
  double before_k = std::numeric_limits<double>::infinity();
  for (int n = 1; n <= kMostPasses; ++n) {
    const std::vector<float> before = kelvin_;
    const Incoming incoming = exposure_.exchanges() && (n > 1 || incoming_known_)
                                  ? Incoming::kKnown
                                  : Incoming::kForeseen;
    double day_left_k = 0;
    if (repeats) {
      ASSIGN_OR_RETURN(day_left_k, day(incoming, level_, wall_, walks));
    } else {
      walks = at_first;
      RETURN_IF_ERROR(pass(first, last, incoming, wall_, walks, {}));
    }
    ++passes_;
    // The first says nothing; the second nothing of how fast changes fall.
    double left_k = exposure_.exchanges() ? std::numeric_limits<double>::infinity() : 0;
    if (n > 1 && exposure_.exchanges()) {
      const double change_k = largest_change_k(before, first, last);
      if (n > 2) falls_ = std::min(change_k / before_k, kSlowest);
      if (falls_) left_k = change_k * *falls_ / (1 - *falls_);
      before_k = change_k;
    }
    const bool settled =
        left_k <= 0.5 * request_.exchange_tolerance_k && day_left_k <= request_.tolerance_k;
    if (settled || n == kMostPasses) left_k_ = std::max(left_k_, left_k);
    if (settled) break;
  }
  return absl::OkStatus();
}

absl::Status SceneWalls::settle() {
  left_k_ = 0;
  const std::size_t day_end = exposure_.day_intervals(), last = exposure_.knots() - 1;
  std::vector<WallWalk> walks;
  RETURN_IF_ERROR(settle(0, day_end, true, walks));
  if (day_end < last) RETURN_IF_ERROR(settle(day_end, last, false, walks));
  incoming_known_ = true;
  closure_w_m2_ = 0;
  note_closure(walks);
  return absl::OkStatus();
}

void SceneWalls::note_closure(const std::vector<WallWalk>& walks) {
  for (const WallWalk& walk : walks)
    for (std::size_t e = 0; e < walk.elements(); ++e)
      closure_w_m2_ = std::max(closure_w_m2_, walk.closure_w_m2(e));
}

SceneWalls::Wall SceneWalls::refined(const Wall& wall, std::span<const std::size_t> element) {
  const std::size_t nodes = wall.begin_k.size() / wall.face.size();
  Wall out;
  out.build_up = wall.build_up;
  for (const std::size_t e : element) {
    out.face.push_back(wall.face[e]);
    out.back.push_back(wall.back[e]);
    out.outer.push_back(wall.outer[e]);
    if (!wall.inner.empty()) out.inner.push_back(wall.inner[e]);
    out.day_left_k.push_back(wall.day_left_k[e]);
    const double* t = wall.begin_k.data() + e * nodes;
    for (std::size_t i = 0; i + 1 < nodes; ++i) {
      out.begin_k.push_back(t[i]);
      out.begin_k.push_back(0.5 * (t[i] + t[i + 1]));
    }
    out.begin_k.push_back(t[nodes - 1]);
  }
  return out;
}

void SceneWalls::refine() {
  ++level_;
  for (Wall& wall : wall_) {
    std::vector<std::size_t> all(wall.face.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    wall = refined(wall, all);
  }
}

void SceneWalls::start_from(const SceneWalls& coarse) {
  level_ = coarse.level_;
  falls_ = coarse.falls_;
  IRSIG_CHECK(wall_.size() == coarse.wall_.size());
  for (std::size_t w = 0; w < wall_.size(); ++w) {
    IRSIG_CHECK(wall_[w].face == coarse.wall_[w].face);  // SceneExposure::fraction_dark()
    wall_[w].begin_k = coarse.wall_[w].begin_k;
    wall_[w].response = coarse.wall_[w].response;
  }
  const std::size_t n = faces_.size();
  for (std::size_t k = 0; k < exposure_.knots(); ++k) {
    const float *low = coarse.incoming_.data() + k / 2 * n,
                *high = coarse.incoming_.data() + (k + 1) / 2 * n;
    for (std::size_t i = 0; i < n; ++i) incoming_[k * n + i] = 0.5f * (low[i] + high[i]);
  }
  incoming_known_ = true;
}

void SceneWalls::start_near(const SceneWalls& other) {
  level_ = other.level_;
  for (std::size_t w = 0; w < wall_.size(); ++w) {
    const Wall& from = other.wall_[w];
    const ConductionGrid grid = make_grid(build_up_of(wall_[w]).layers, shortest_s_, level_);
    if (from.begin_k.size() == (grid.last() + 1) * wall_[w].face.size())
      wall_[w].begin_k = from.begin_k;
  }
  incoming_ = other.incoming_;
  incoming_known_ = true;
}

absl::Status SceneWalls::sharpen(std::vector<float> off_k) {
  const std::vector<float> at_begin = kelvin_;
  const std::size_t day_end = exposure_.day_intervals(), last = exposure_.knots() - 1;
  // A sheet's conduction is known as well as the worse of its faces says.
  const auto of_element = [&](const Wall& wall, std::size_t e) {
    const float front = off_k[wall.face[e]];
    return wall.back[e] == ThermalFaces::kNone ? front : std::max(front, off_k[wall.back[e]]);
  };
  const auto note_error = [&](const Wall& wall, std::size_t e) {
    const double error_k =
        static_cast<double>(of_element(wall, e)) + wall.day_left_k[e] + kArithmeticErrorK;
    error_k_[wall.face[e]] = error_k;
    if (wall.back[e] != ThermalFaces::kNone) error_k_[wall.back[e]] = error_k;
  };
  const auto still_open = [&](const std::vector<Wall>& walls) {
    std::vector<Wall> out;
    for (const Wall& wall : walls) {
      std::vector<std::size_t> open;
      for (std::size_t e = 0; e < wall.face.size(); ++e) {
        note_error(wall, e);
        // A day whose begin is not found better than that says no more when it is cut finer.
        if (!(static_cast<double>(of_element(wall, e)) <=
              std::max(request_.tolerance_k, wall.day_left_k[e])))
          open.push_back(e);
      }
      if (!open.empty()) out.push_back(refined(wall, open));
    }
    return out;
  };
  std::vector<Wall> open = still_open(wall_);
  for (int level = level_ + 1; level <= kMostLevels && !open.empty(); ++level) {
    const std::vector<float> before = kelvin_;
    std::vector<WallWalk> walks;
    for (int n = 1; n <= kMostPasses; ++n) {
      ASSIGN_OR_RETURN(const auto left, day(Incoming::kFixed, level, open, walks));
      if (left <= request_.tolerance_k) break;
    }
    if (day_end < last) RETURN_IF_ERROR(pass(day_end, last, Incoming::kFixed, open, walks, {}));
    note_closure(walks);
    std::ranges::fill(off_k, 0.0f);
    for (std::size_t i = 0; i < kelvin_.size(); ++i) {
      float& off = off_k[i % faces_.size()];
      off = std::max(off, std::abs(kelvin_[i] - before[i]));
    }
    open = still_open(open);
  }
  // Changes by finer steps go round, too.
  if (exposure_.exchanges() && falls_)
    left_k_ = std::max(left_k_, largest_change_k(at_begin, 0, last) * *falls_ / (1 - *falls_));
  return absl::OkStatus();
}

}  // namespace irsig
