#include "core/scene/generate/frigate_loft.h"

#include <algorithm>
#include <cmath>

#include "core/scene/generate/generate_rows.h"

namespace irsig {
namespace {

double mix(double a, double b, double part) { return a + (b - a) * part; }

Section mix(const Section& a, const Section& b, double part) {
  return {mix(a.x_low, b.x_low, part),
          mix(a.x_high, b.x_high, part),
          mix(a.y_low, b.y_low, part),
          mix(a.y_high, b.y_high, part),
          mix(a.h_low, b.h_low, part),
          mix(a.h_high, b.h_high, part),
          mix(a.y_inner_low, b.y_inner_low, part),
          mix(a.y_inner_high, b.y_inner_high, part)};
}

std::uint64_t divisions(double length_m, double edge_m) {
  return static_cast<std::uint64_t>(std::max(1.0, std::floor(length_m / edge_m + 0.5)));
}

bool is_paired(const Section& s) { return s.y_inner_low > 0 || s.y_inner_high > 0; }

// The point of a section at `across` (0 inner, 1 outer edge) and `up` (0 low, 1 high).
Vec<Body> point_of(const Section& s, double across, double up, double flare) {
  const double spread = mix(up, up * up, flare);
  const double inner = mix(s.y_inner_low, s.y_inner_high, up);
  const double outer = mix(s.y_low, s.y_high, spread);
  return {mix(s.x_low, s.x_high, up), mix(inner, outer, across), -mix(s.h_low, s.h_high, up)};
}

std::uint32_t group_number(const std::string& name, Mesh& mesh) {
  const auto at = std::find(mesh.group.begin(), mesh.group.end(), name);
  if (at != mesh.group.end()) return static_cast<std::uint32_t>(at - mesh.group.begin());
  mesh.group.push_back(name);
  return static_cast<std::uint32_t>(mesh.group.size() - 1);
}

using Row = std::vector<std::uint32_t>;

}  // namespace

LoftGrid divide(const Loft& loft, double edge_m) {
  LoftGrid grid;
  double height_m = 0;
  for (std::size_t i = 0; i + 1 < loft.section.size(); ++i) {
    const Section &a = loft.section[i], &b = loft.section[i + 1];
    // The longest of the four edges: sides that are oblique need their divisions too.
    const double low_m = std::hypot(b.x_low - a.x_low, b.y_low - a.y_low, b.h_low - a.h_low);
    const double high_m = std::hypot(b.x_high - a.x_high, b.y_high - a.y_high, b.h_high - a.h_high);
    const std::uint64_t steps =
        loft.stations_given ? 1 : divisions(std::max(low_m, high_m), edge_m);
    for (std::uint64_t step = 0; step < steps; ++step)
      grid.section.push_back(mix(a, b, static_cast<double>(step) / static_cast<double>(steps)));
  }
  grid.section.push_back(loft.section.back());
  for (const Section& s : loft.section) {
    height_m =
        std::max(height_m, std::hypot(s.x_high - s.x_low, s.y_high - s.y_low, s.h_high - s.h_low));
  }
  grid.upward = divisions(height_m, edge_m);
  for (const Section& s : grid.section) {
    grid.across.push_back(
        divisions(std::max(s.y_low - s.y_inner_low, s.y_high - s.y_inner_high), edge_m));
  }

  const std::uint64_t walls = is_paired(loft.section[0]) ? 2 : 1;
  std::uint64_t half = 2 * grid.upward * (grid.section.size() - 1) * walls +
                       2 * grid.upward * (grid.across.front() + grid.across.back());
  for (std::size_t i = 0; i + 1 < grid.across.size(); ++i)
    half += 2 * (grid.across[i] + grid.across[i + 1]);
  grid.triangles = 2 * half;
  return grid;
}

void add_starboard_half(const Loft& loft, const LoftGrid& grid, Mesh& mesh) {
  const std::uint32_t side = group_number(loft.side_group, mesh),
                      top = group_number(loft.top_group, mesh);
  const std::size_t stations = grid.section.size();
  const std::uint64_t upward = grid.upward;
  const bool paired = is_paired(loft.section[0]);
  const auto vertex = [&](std::size_t station, double across, std::uint64_t step) {
    const double up = static_cast<double>(step) / static_cast<double>(upward);
    mesh.vertex.push_back(point_of(grid.section[station], across, up, loft.flare));
    return static_cast<std::uint32_t>(mesh.vertex.size() - 1);
  };

  // Rows of vertices: low and high run outwards, inner and outer upwards; corners are shared.
  std::vector<Row> low(stations), high(stations), inner(stations), outer(stations);
  for (std::size_t i = 0; i < stations; ++i) {
    const std::uint64_t across = grid.across[i];
    for (std::uint64_t j = 0; j <= across; ++j) {
      const double part = static_cast<double>(j) / static_cast<double>(across);
      low[i].push_back(vertex(i, part, 0));
      high[i].push_back(vertex(i, part, upward));
    }
    const bool has_inner = paired || i == 0 || i + 1 == stations;  // else the solid is open there
    for (std::uint64_t k = 0; k <= upward; ++k) {
      const bool first = k == 0, last = k == upward;
      outer[i].push_back(first ? low[i].back() : last ? high[i].back() : vertex(i, 1, k));
      if (has_inner)
        inner[i].push_back(first ? low[i].front() : last ? high[i].front() : vertex(i, 0, k));
    }
  }

  // Seen from outside, with the body's z downwards: which row lies above which.
  for (std::size_t i = 0; i + 1 < stations; ++i) {
    add_strip(outer[i + 1], outer[i], side, mesh);
    if (paired) add_strip(inner[i], inner[i + 1], side, mesh);
    add_strip(low[i + 1], low[i], side, mesh);
    add_strip(high[i], high[i + 1], top, mesh);
  }
  for (const std::size_t end : {std::size_t{0}, stations - 1}) {
    const std::uint64_t across = grid.across[end];
    Row below = low[end], above;
    for (std::uint64_t k = 1; k <= upward; ++k) {
      above.clear();
      if (k == upward) {
        above = high[end];
      } else {
        for (std::uint64_t j = 0; j <= across; ++j) {
          const double part = static_cast<double>(j) / static_cast<double>(across);
          above.push_back(j == 0        ? inner[end][k]
                          : j == across ? outer[end][k]
                                        : vertex(end, part, k));
        }
      }
      if (end == 0) {
        add_strip(below, above, side, mesh);
      } else {
        add_strip(above, below, side, mesh);
      }
      below.swap(above);
    }
  }
}

Mesh with_port_half(const Mesh& starboard) {
  Mesh mesh;
  mesh.group = starboard.group;
  mesh.vertex = starboard.vertex;
  std::vector<std::uint32_t> port(starboard.vertex.size());
  for (std::size_t i = 0; i < starboard.vertex.size(); ++i) {
    const Vec<Body>& v = starboard.vertex[i];
    port[i] = static_cast<std::uint32_t>(i);
    if (v.y == 0) continue;  // on the centre plane: shared
    port[i] = static_cast<std::uint32_t>(mesh.vertex.size());
    mesh.vertex.push_back({v.x, -v.y, v.z});
  }
  mesh.triangle.reserve(2 * starboard.triangle.size());
  mesh.triangle_group.reserve(2 * starboard.triangle.size());
  for (std::uint32_t group = 0; group < starboard.group.size(); ++group) {
    for (const bool to_port : {false, true}) {
      for (std::size_t i = 0; i < starboard.triangle.size(); ++i) {
        if (starboard.triangle_group[i] != group) continue;
        const auto& t = starboard.triangle[i];
        mesh.triangle.push_back(to_port ? std::array{port[t[0]], port[t[2]], port[t[1]]} : t);
        mesh.triangle_group.push_back(group);
      }
    }
  }
  return mesh;
}

}  // namespace irsig
