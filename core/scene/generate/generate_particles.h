#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/scene/mesh.h"

namespace irsig {

enum class GrainShape { kSphere, kIrregular };

// One grain size of a mix. `fraction` is relative: the mix is divided by the sum.
struct GrainSize {
  double diameter_m = 0;  // of the sphere of the same volume
  double fraction = 1;
};

// A bed of grains of one density on a plate. At most one of coverage and layers is positive; with
// neither the plate is bare.
struct ParticleBed {
  std::vector<GrainSize> size;
  bool fractions_by_mass = false;  // else by number
  double width_m = 0;       // of the square cell that is filled; at least 4 largest diameters
  std::uint32_t tiles = 1;  // copies of the cell in each direction
  double coverage = 0;      // up to 0.99: grains are dropped until they hide this part, as meshed
  double layers = 0;        // ... or until their cross-sections add up to so many plates
  GrainShape shape = GrainShape::kIrregular;
  double irregularity = 0.2;       // [0, 0.4]: radii of an irregular grain vary by about this
  std::uint32_t subdivisions = 1;  // of an icosahedron's facets: 20, 80, 320, 1280 triangles
  bool plate = true;
  std::uint64_t seed = 0;
};

// Statistics of the generated particles. Heights are those of the surface seen from straight above
// (plate included), on a grid of 1024 x 1024 points of the cell; the reference is the plate.
struct ParticleReport {
  std::vector<std::uint64_t> grains_of_size;  // in one cell
  std::uint64_t grains = 0;                   // in one cell
  double coverage = 0;                        // of the plate, by the grains as they are meshed
  double mean_height_m = 0, rms_height_m = 0, top_m = 0;  // rms: about the mean
  // Fraction of the volume that spheres of the grains' volume fill, between 1/4 and 3/4 of the mean
  // height: the bulk value of a bed of several layers.
  double packing_fraction = 0;
  double largest_overlap = 0;  // of two such spheres, of the smaller one's radius
};

struct ParticleModel {
  Mesh mesh;
  ParticleReport report;
};

// Grains dropped one by one at random places of a plate (core/scene/generate/settle_spheres.h);
// sizes follow one another so that after each grain the mix is as close to the stated one as it can
// be. Irregular grains settle as the spheres of their volume and then overlap a little; so does one
// in the plate.
//
// Body frame: the plate's upper face is z = 0, the cell's or tiles' centre is the origin. Groups:
// "plate", and for each size "grain_<diameter in um>um". The plate is one-sided and as wide as the
// bed. The same for the same ParticleBed.
[[nodiscard]] absl::StatusOr<ParticleModel> generate_particles(const ParticleBed& bed);

}  // namespace irsig
