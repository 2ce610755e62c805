#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/scene/mesh.h"

namespace irsig {

// Fills the strip between two rows of vertices with a.size() - 1 + b.size() - 1 triangles; the rows
// may have different numbers of vertices, each evenly spaced, one vertex being a point. Fronts face
// the viewer who sees `a` run to the right and `b` above it. A closed ring repeats its first
// vertex.
void add_strip(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b,
               std::uint32_t group, Mesh& mesh);

}  // namespace irsig
