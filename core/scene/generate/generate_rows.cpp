#include "core/scene/generate/generate_rows.h"

namespace irsig {

void add_strip(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b,
               std::uint32_t group, Mesh& mesh) {
  const std::size_t na = a.size() - 1, nb = b.size() - 1;
  std::size_t i = 0, j = 0;
  while (i < na || j < nb) {
    // The row whose next step has its middle further left goes first: compares
    // (i + 1/2) / na with (j + 1/2) / nb without rounding.
    const bool step_a = j == nb || (i < na && (2 * i + 1) * nb <= (2 * j + 1) * na);
    if (step_a) {
      mesh.triangle.push_back({a[i], a[i + 1], b[j]});
      ++i;
    } else {
      mesh.triangle.push_back({a[i], b[j + 1], b[j]});
      ++j;
    }
    mesh.triangle_group.push_back(group);
  }
}

}  // namespace irsig
