#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/scene/trace/tracer.h"

namespace irsig {

// A regular grid of vertices as two triangles a cell. `vertex` is x y z of vertex (column, row) at
// 3 (row (columns + 1) + column). Blocks of cells may be left out.
struct PacketGrid {
  std::uint32_t columns = 0, rows = 0;  // of cells
  std::vector<float> vertex;
  // Cells from `left`, `low` on that are not there; no columns: none.
  std::uint32_t hole_left = 0, hole_low = 0, hole_columns = 0, hole_rows = 0;
};
struct PacketMesh {
  std::span<const float> vertex;            // x y z, kept by the caller until make() returns
  std::span<const std::uint32_t> triangle;  // three indices each
};
// world = rotation mesh + shift, row by row.
struct PacketInstance {
  std::uint32_t mesh = 0;
  std::array<float, 9> rotation{};
  std::array<float, 3> shift{};
};

// Grids and instances of meshes for packets of coherent rays, in float32, by Embree with ROBUST
// traversal. For pictures whose errors are measured: unlike Tracer, no answer near an edge or a
// vertex is decided by exact arithmetic. Immutable; any number of threads may trace.
class PacketScene {
 public:
  // Builds the scene. INTERNAL: Embree refuses it (out of memory).
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<const PacketScene>> make(
      std::vector<PacketGrid> grid, std::span<const PacketMesh> mesh,
      std::vector<PacketInstance> instance, TracerIsa isa = widest_isa());
  virtual ~PacketScene() = default;

  static constexpr std::uint32_t kGround = 0xffffffffu;
  // Finds the nearest hit of the first `count` rays of a packet. instance: index of the instance,
  // kGround for a grid; triangle: the mesh's triangle, or kMiss. The normal is in the frame of the
  // world and not normalised.
  virtual void intersect(RayPacket& packet, int count) const = 0;
  // Marks the rays that meet anything between tnear and tfar.
  virtual void occluded(RayPacket& packet, int count) const = 0;
};

}  // namespace irsig
