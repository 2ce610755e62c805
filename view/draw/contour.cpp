#include "view/draw/contour.h"

#include <array>
#include <map>

namespace irsig {
namespace {

// A crossing lies on the grid edge from node `low` to its right (0) or lower (1) neighbour.
struct Edge {
  long low;
  int direction;
  friend auto operator<=>(const Edge&, const Edge&) = default;
};

// The grid with a frame of nodes that lie just below every level, so that all outlines close.
class Framed {
 public:
  Framed(const ValueGrid& grid, double level) : grid_(grid), level_(level) {}
  [[nodiscard]] long columns() const { return static_cast<long>(grid_.columns) + 2; }
  [[nodiscard]] long rows() const { return static_cast<long>(grid_.rows) + 2; }
  [[nodiscard]] bool inside(long node) const { return is_grid(node) && value(node) >= level_; }
  [[nodiscard]] Point crossing(Edge edge) const {
    const long other = edge.low + (edge.direction == 0 ? 1 : columns());
    double t = 0.5;
    if (is_grid(edge.low) && is_grid(other)) {
      t = (level_ - value(edge.low)) / (value(other) - value(edge.low));
    } else {
      t = is_grid(edge.low) ? 0.0 : 1.0;  // on the grid's edge itself
    }
    const Point a = at(edge.low), b = at(other);
    return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
  }

 private:
  [[nodiscard]] bool is_grid(long node) const {
    const long x = node % columns(), y = node / columns();
    return x > 0 && y > 0 && x < columns() - 1 && y < rows() - 1;
  }
  [[nodiscard]] double value(long node) const {
    const auto x = static_cast<std::size_t>(node % columns() - 1);
    const auto y = static_cast<std::size_t>(node / columns() - 1);
    return grid_.value[y * grid_.columns + x];
  }
  [[nodiscard]] Point at(long node) const {
    return {grid_.corner.x + grid_.step * static_cast<double>(node % columns() - 1),
            grid_.corner.y + grid_.step * static_cast<double>(node / columns() - 1)};
  }
  const ValueGrid& grid_;
  double level_;
};

}  // namespace

// Marching squares. Each segment is directed so that the region lies on one side: segments then
// link head to tail. The two ambiguous cases separate the corners inside the region.
std::vector<std::vector<Point>> outlines(const ValueGrid& grid, double level) {
  const Framed framed(grid, level);
  const long w = framed.columns();
  std::map<Edge, Edge> next;
  for (long y = 0; y + 1 < framed.rows(); ++y) {
    for (long x = 0; x + 1 < w; ++x) {
      const long node = y * w + x;
      // Corners clockwise from the upper left, and the edges between a corner and the next one.
      const std::array<long, 4> corner{node, node + 1, node + w + 1, node + w};
      const std::array<Edge, 4> edge{Edge{node, 0}, Edge{node + 1, 1}, Edge{node + w, 0},
                                     Edge{node, 1}};
      for (std::size_t i = 0; i < 4; ++i) {
        // A run of inside corners that starts at corner i: enters by the edge before it, leaves by
        // the edge after its end.
        if (!framed.inside(corner[i]) || framed.inside(corner[(i + 3) % 4])) continue;
        std::size_t end = i;
        while (framed.inside(corner[(end + 1) % 4])) end = (end + 1) % 4;
        next[edge[end]] = edge[(i + 3) % 4];
      }
    }
  }
  std::vector<std::vector<Point>> loops;
  while (!next.empty()) {
    std::vector<Point> loop;
    for (auto at = next.begin(); at != next.end();) {
      loop.push_back(framed.crossing(at->first));
      const Edge following = at->second;
      next.erase(at);
      at = next.find(following);
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace irsig
