#include "core/scene/cut_edges.h"

#include <algorithm>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"

namespace irsig {

absl::StatusOr<Mesh> cut_long_edges(const Mesh& mesh, double longest_m, std::uint64_t most_facets) {
  Mesh out = mesh;
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  // Each round halves the edges that are too long: of equal vertices the middle is the same
  // whichever facet asks, also where a file has a vertex twice.
  while (true) {
    absl::flat_hash_map<Edge, std::uint32_t> middle_of;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) -> std::int64_t {
      const Vec<Body> from = out.vertex[a], to = out.vertex[b];
      if (length(to - from) <= longest_m) return -1;
      const auto [at, is_new] = middle_of.try_emplace(
          Edge{std::min(a, b), std::max(a, b)}, static_cast<std::uint32_t>(out.vertex.size()));
      if (is_new) out.vertex.push_back(0.5 * (from + to));
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> triangle;
    std::vector<std::uint32_t> group;
    for (std::size_t f = 0; f < out.triangle.size(); ++f) {
      std::array<std::uint32_t, 3> c = out.triangle[f];
      std::array<std::int64_t, 3> m{};  // of the edge from corner i to the next
      for (std::size_t i = 0; i < 3; ++i) m[i] = middle(c[i], c[(i + 1) % 3]);
      const auto add = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
        triangle.push_back({x, y, z});
        group.push_back(out.triangle_group[f]);
      };
      const auto cut = std::count_if(m.begin(), m.end(), [](std::int64_t x) { return x >= 0; });
      if (cut == 0) {
        add(c[0], c[1], c[2]);
        continue;
      }
      // One cut: the first edge; two: all but the last.
      const auto turned = [&] { return cut == 1 ? m[0] >= 0 : cut == 2 ? m[2] < 0 : true; };
      while (!turned()) {
        std::rotate(c.begin(), c.begin() + 1, c.end());
        std::rotate(m.begin(), m.begin() + 1, m.end());
      }
      const auto at = [&](std::size_t i) { return static_cast<std::uint32_t>(m[i]); };
      if (cut == 1) {
        add(c[0], at(0), c[2]);
        add(at(0), c[1], c[2]);
      } else if (cut == 2) {
        add(at(0), c[1], at(1));
        add(c[0], at(0), at(1));
        add(c[0], at(1), c[2]);
      } else {
        add(c[0], at(0), at(2));
        add(at(0), c[1], at(1));
        add(at(2), at(1), c[2]);
        add(at(0), at(1), at(2));
      }
      if (triangle.size() > most_facets)
        return absl::InvalidArgumentError(absl::StrCat("edges of at most ", longest_m,
                                                       " m make more than ", most_facets,
                                                       " facets, expected a larger size"));
    }
    if (middle_of.empty()) return out;
    out.triangle = std::move(triangle);
    out.triangle_group = std::move(group);
  }
}

}  // namespace irsig
