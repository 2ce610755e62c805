#include "core/thermal/conduction_grid.h"

#include <algorithm>
#include <cmath>

namespace irsig {
namespace {

// With these, and the steps of heat_solver.cpp, depth and time have about equal parts in the error
// of walls of 1 mm to 0.5 m in hourly weather (tests/benchmark/heat_bench.cpp).
constexpr double kSurfaceCell = 0.4, kGrowth = 0.15;
// Smallest cell as a fraction of the wall: a smaller one is lost in rounding.
constexpr double kSmallestCell = 1e-9;

// Returns the time that heat takes through a layer, as the root of seconds. It is 0 if nothing is
// stored there, or if nothing moves: then one cell is exact.
double diffusion_depth(const Layer& layer) {
  if (layer.conductivity_w_m_k == 0) return 0;
  return layer.thickness_m *
         std::sqrt(layer.density_kg_m3 * layer.specific_heat_j_kg_k / layer.conductivity_w_m_k);
}

// Shares of the layer's thickness, which lies between `from` and `to` of `whole`.
std::vector<double> cut(double from, double to, double whole, double surface_cell) {
  if (to <= from) return {1.0};
  // Cells of equal depth in the integral of 1 / (largest cell allowed there).
  const auto cells_to = [&](double s) {
    const auto side = [&](double d) { return std::log1p(kGrowth * d / surface_cell) / kGrowth; };
    return s <= 0.5 * whole ? side(s) : 2 * side(0.5 * whole) - side(whole - s);
  };
  const auto depth_of = [&](double cells) {
    const auto side = [&](double n) { return surface_cell * std::expm1(kGrowth * n) / kGrowth; };
    const double half = cells_to(0.5 * whole);
    return cells <= half ? side(cells) : whole - side(2 * half - cells);
  };
  const double first = cells_to(from), last = cells_to(to);
  const double count = std::max(1.0, std::ceil(last - first));
  std::vector<double> share;
  double begin = from;
  for (double i = 1; i <= count; ++i) {
    const double end = i == count ? to : depth_of(first + (last - first) * i / count);
    share.push_back((end - begin) / (to - from));
    begin = end;
  }
  return share;
}

}  // namespace

ConductionGrid make_grid(std::span<const Layer> layers, double shortest_step_s, int level) {
  constexpr double kLeftAtBoundary = 1e-9;
  double whole = 0;
  for (const Layer& layer : layers) whole += diffusion_depth(layer);
  const double surface_cell =
      std::max(kSurfaceCell * std::sqrt(shortest_step_s), kSmallestCell * whole);
  ConductionGrid grid{{0.0}, {}, {0}, {}};
  const std::size_t pieces = std::size_t{1} << level;
  double from = 0;
  for (const Layer& layer : layers) {
    const bool insulation = layer.conductivity_w_m_k == 0;
    const double to = from + diffusion_depth(layer);
    const std::vector<double> share =
        insulation ? std::vector<double>{0.5, 0.5} : cut(from, to, whole, surface_cell);
    const std::size_t first = grid.last();
    const double before_j_m2_k = grid.capacity_j_m2_k.back();
    for (const double of_layer : share) {
      const double cell_m = layer.thickness_m * of_layer / static_cast<double>(pieces);
      const double half_j_m2_k = 0.5 * cell_m * layer.density_kg_m3 * layer.specific_heat_j_kg_k;
      for (std::size_t i = 0; i < pieces; ++i) {
        grid.capacity_j_m2_k.back() += half_j_m2_k;
        grid.capacity_j_m2_k.push_back(half_j_m2_k);
        grid.conductance_w_m2_k.push_back(layer.conductivity_w_m_k / cell_m);
      }
    }
    if (insulation) {
      const std::size_t last = grid.last();
      const double moved = (1 - kLeftAtBoundary) * grid.capacity_j_m2_k[last];
      grid.capacity_j_m2_k[first] -= moved;
      grid.capacity_j_m2_k[first + 1] += moved;
      grid.capacity_j_m2_k[last - 1] += moved;
      grid.capacity_j_m2_k[last] -= moved;
    }
    if (first > 0) {
      const double all = grid.capacity_j_m2_k[first];
      grid.share_of_next.push_back(all > 0 ? 1 - before_j_m2_k / all : 0.5);
    }
    grid.boundary_node.push_back(grid.last());
    from = to;
  }
  return grid;
}

}  // namespace irsig
