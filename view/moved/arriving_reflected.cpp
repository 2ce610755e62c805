#include "view/moved/arriving_reflected.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace irsig {
namespace {

using LineValues = SightLine::Values;

// Sines of the elevations, close to each other where air gets thick: kFirst (exp(k step) - 1), the
// last one 1.
constexpr std::size_t kNodes = 16, kStencil = 4;
constexpr double kFirst = 0.02, kRadPerDeg = std::numbers::pi / 180;

double step() { return std::log1p(1 / kFirst) / (kNodes - 1); }

double elevation_of(std::size_t node) {
  const double sine = kFirst * std::expm1(static_cast<double>(node) * step());
  return std::asin(std::min(1.0, sine)) / kRadPerDeg;
}

// Four nodes around an elevation; `at` and the next one of them are its neighbours.
struct Around {
  std::size_t first, at;
  double fraction;
  std::array<double, kStencil> weight;
};
std::optional<Around> around(double elevation_deg) {
  const double place = std::log1p(std::sin(elevation_deg * kRadPerDeg) / kFirst) / step();
  if (!(place >= 0)) return std::nullopt;
  Around out;
  out.at = std::min(static_cast<std::size_t>(place), kNodes - 2);
  out.fraction = place - static_cast<double>(out.at);
  out.first = std::clamp<std::size_t>(out.at, 1, kNodes - kStencil + 1) - 1;
  for (std::size_t i = 0; i < kStencil; ++i) {
    out.weight[i] = 1;
    for (std::size_t j = 0; j < kStencil; ++j)
      if (j != i)
        out.weight[i] *= (place - static_cast<double>(out.first + j)) /
                         (static_cast<double>(i) - static_cast<double>(j));
  }
  return out;
}

}  // namespace

ReflectedSpread spread_of(const SightLine& from, const SightLine& to) {
  const std::size_t bins = from.bin.width.size();
  ReflectedSpread out;
  for (std::size_t side = 0; side < out.size(); ++side) {
    const std::size_t cause = SightLine::kReflected[side];
    const LineValues &from_side = from.directions[side], &to_side = to.directions[side];
    for (std::size_t k = 0; k < bins; ++k) {
      const double before = from.bin.arriving[cause][k], after = to.bin.arriving[cause][k];
      if (!(before > 0)) {
        out[side].push_back(after);
        continue;
      }
      double farthest = 0;
      for (std::size_t at = k; at < from_side.size(); at += bins)
        if (from_side[at] > 0)
          farthest = std::max(farthest, std::abs(to_side[at] / from_side[at] - after / before));
      out[side].push_back(before * farthest);
    }
  }
  return out;
}

namespace {

ArrivingTable::Node::Values over(const LineValues& values, const LineValues& transmittance) {
  ArrivingTable::Node::Values out;
  for (std::size_t k = 0; k < values.size(); ++k)
    out.push_back(transmittance[k] > 0 ? static_cast<float>(values[k] / transmittance[k]) : 0);
  return out;
}
LineValues times(LineValues values, const LineValues& transmittance) {
  for (std::size_t k = 0; k < values.size(); ++k) values[k] *= transmittance[k];
  return values;
}

ArrivingTable::Node node_of(const SightLine& from, const SightLine& to) {
  const ReflectedSpread spread = spread_of(from, to);
  ArrivingTable::Node out;
  for (std::size_t side = 0; side < out.side.size(); ++side) {
    const std::size_t cause = SightLine::kReflected[side];
    const auto share = [&](const SightLine::Integrals& of) {
      return over(of.arriving[cause], of.transmittance);
    };
    out.side[side] = {share(from.bin), share(from.band), share(to.bin), share(to.band),
                      over(spread[side], to.bin.transmittance)};
  }
  return out;
}

}  // namespace

double ArrivingTable::bytes(std::size_t conditions, std::size_t ranges, std::size_t bins) {
  constexpr std::size_t kValues = 2 * 5;  // of a bin
  return static_cast<double>(conditions * ranges * kNodes) *
         static_cast<double>(kValues * bins * sizeof(float));
}

std::vector<ArrivingTable::Task> ArrivingTable::lacking(
    double elevation_deg, double from_m, const std::vector<double>& to_m,
    const std::vector<std::uint32_t>& conditions) {
  std::vector<Task> out;
  const auto place = around(elevation_deg);
  for (std::size_t i = 0; place && i < kStencil; ++i) {
    const std::size_t node = place->first + i;
    Task task{node, from_m, to_m, {}, {}};
    for (const std::uint32_t c : conditions) {
      if (known_.contains({from_m, to_m.front(), c, node})) continue;
      task.condition.push_back(c);
      for (const double to : to_m) task.out.push_back(&known_[{from_m, to, c, node}]);
    }
    if (!task.condition.empty()) out.push_back(std::move(task));
  }
  return out;
}

void ArrivingTable::compute(const Task& task, const Lines& lines) {
  const double elevation_deg = elevation_of(task.node);
  const auto from = lines(elevation_deg, task.from_m, task.condition);
  if (!from.ok()) return;
  for (std::size_t r = 0; r < task.to_m.size(); ++r) {
    const auto to = lines(elevation_deg, task.to_m[r], task.condition);
    if (!to.ok()) continue;
    for (std::size_t c = 0; c < task.condition.size(); ++c)
      *task.out[c * task.to_m.size() + r] = node_of((*from)[c], (*to)[c]);
  }
}

std::optional<ReflectedSpread> ArrivingTable::complete(double elevation_deg, double from_m,
                                                       double to_m, std::uint32_t condition,
                                                       SightLine& from, SightLine& to) const {
  const auto place = around(elevation_deg);
  if (!place) return std::nullopt;
  std::array<const Node*, kStencil> node{};
  for (std::size_t i = 0; i < kStencil; ++i) {
    const auto found = known_.find({from_m, to_m, condition, place->first + i});
    if (found == known_.end() || !found->second) return std::nullopt;
    node[i] = &*found->second;
  }
  const std::size_t at = place->at - place->first;
  struct Between {
    LineValues cubic, bent;  // bent: by how much that differs from a straight line
  };
  const auto between = [&](Node::Values Node::Side::*values, std::size_t side) {
    const std::size_t bins = (node[at]->side[side].*values).size();
    Between out{LineValues(bins), LineValues(bins)};
    for (std::size_t k = 0; k < bins; ++k) {
      const auto of = [&](std::size_t i) {
        return static_cast<double>((node[i]->side[side].*values)[k]);
      };
      double sum = 0;
      for (std::size_t i = 0; i < kStencil; ++i) sum += place->weight[i] * of(i);
      out.cubic[k] = std::max(0.0, sum);
      out.bent[k] = out.cubic[k] - (of(at) + place->fraction * (of(at + 1) - of(at)));
    }
    return out;
  };
  ReflectedSpread spread;
  for (std::size_t side = 0; side < spread.size(); ++side) {
    const std::size_t cause = SightLine::kReflected[side];
    const auto set = [&](SightLine::Integrals& of, LineValues share) {
      of.arriving[cause] = times(std::move(share), of.transmittance);
    };
    Between before = between(&Node::Side::from_bin, side),
            after = between(&Node::Side::to_bin, side);
    for (std::size_t k = 0; k < after.bent.size(); ++k)
      spread[side].push_back(static_cast<double>(std::max(node[at]->side[side].spread[k],
                                                          node[at + 1]->side[side].spread[k])) +
                             std::abs(after.bent[k] - before.bent[k]));
    spread[side] = times(std::move(spread[side]), to.bin.transmittance);
    set(from.bin, std::move(before.cubic));
    set(to.bin, std::move(after.cubic));
    set(from.band, between(&Node::Side::from_band, side).cubic);
    set(to.band, between(&Node::Side::to_band, side).cubic);
  }
  return spread;
}

}  // namespace irsig
