#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/scene/mesh.h"
#include "core/scene/trace/tracer.h"

namespace irsig {

// A part of the target as the user names it: which mesh groups belong to it, what it is made of.
struct PartSpec {
  std::string name;
  std::vector<std::string> match;  // patterns of group_matches(); empty: the part's own name
  std::uint32_t material = 0;      // index into the scene's materials
  bool two_sided = false;
  bool hot = false;   // its primary rays form a stratum of their own
  bool rest = false;  // instead of `match`: all groups that no other part takes; one part at most
};

// The target, ready to be traced: float coordinates relative to the centre of its bounding sphere,
// so that neither the mesh's own offset nor the sensor's distance costs precision.
struct Target {
  struct Facet {
    float nx, ny, nz;  // unit outward normal; zero for a degenerate triangle
    std::uint32_t part;
  };
  std::vector<PartSpec> part;
  std::vector<Facet> facet;
  std::vector<float> vertex;            // x y z relative to centre [m]
  std::vector<float> rounded_m;         // by so much less than the mesh's
  std::vector<std::uint32_t> triangle;  // three indices each
  std::vector<double> part_area_m2;
  Vec<Body> centre;                    // in the body frame
  double radius_m = 0;                 // of the bounding sphere about centre
  std::array<double, 2> z_extent_m{};  // smallest and largest body z (down)
  // Proven: no ray that leaves a facet meets the target again. False also where a proof would take
  // too long (facets x vertices above 2e8).
  bool convex = false;
  // Returns the corners of a facet, relative to `centre`. [m]
  [[nodiscard]] std::array<Vec<Body>, 3> corners(std::size_t of_facet) const {
    std::array<Vec<Body>, 3> out;
    for (std::size_t k = 0; k < 3; ++k) {
      const float* v = vertex.data() + 3 * std::size_t{triangle[3 * of_facet + k]};
      out[k] = {v[0], v[1], v[2]};
    }
    return out;
  }
  // Returns the distance from a facet at which secondary rays start: about 8 units in the last
  // place of a coordinate at the rim. [m]
  [[nodiscard]] double offset_m() const { return 0x1p-19 * radius_m; }
  std::shared_ptr<const Tracer> tracer;
};

// The area that the facets of a part turn towards a direction, hidden or not, and by how much the
// rounding of coordinates to 32 bits may have changed it: the sum over vertices of what moving each
// by its own rounding changes. Neighbours in a part take from each other what they lose, so that
// this is of its outline.
struct TurnedArea {
  double m2 = 0, rounding_m2 = 0;
};
// Returns the area of each part turned to a direction. towards: unit vector from the target. [part]
[[nodiscard]] std::vector<TurnedArea> turned_areas(const Target& target, Vec<Body> towards);

// Returns the part to which each group of a mesh belongs. The errors are those of make_target.
// [group]
[[nodiscard]] absl::StatusOr<std::vector<std::uint32_t>> part_of_groups(
    const Mesh& mesh, const std::vector<PartSpec>& parts);

// Errors (INVALID_ARGUMENT) name the part ("part[2].match: ..."): a part that matches no group, a
// group that no part or more than one part matches.
[[nodiscard]] absl::StatusOr<Target> make_target(const Mesh& mesh, std::vector<PartSpec> parts,
                                                 TracerIsa isa, TracerOptions options = {});

}  // namespace irsig
