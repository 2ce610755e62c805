#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geo/frames.h"
#include "core/land/height_field.h"
#include "core/land/objects/box_tree.h"
#include "core/scene/mesh.h"
#include "core/scene/trace/tracer.h"

namespace irsig {

// Most objects on a land, and most facets of all their meshes together.
inline constexpr std::uint64_t kMostLandObjects = 1'000'000;
inline constexpr std::uint64_t kMostObjectFacets = 5'000'000;

// A place where a mesh stands.
struct ObjectPlace {
  double x_m = 0, y_m = 0;  // in the local frame of the land: east, north
  double heading_deg = 0;   // of the mesh's forward axis, clockwise from north
  double scale = 1;         // of the mesh, > 0
  std::uint32_t line = 0;   // of the file that states it; 0: none
};

// Where places are stated, for errors.
enum class PlacesFrom { kTable, kFile, kScatter };

// One mesh and the places where it stands.
struct ObjectModel {
  std::string key;  // of the sweep file, for errors: "land.object[2]"
  PlacesFrom from = PlacesFrom::kTable;
  std::string place_file;  // its name, for errors; empty: places have no file
  Mesh mesh;
  std::vector<std::uint32_t> material;  // of the land, [mesh.group]
  std::vector<ObjectPlace> place;
  double sink_m = 0;  // how far the lowest point of the mesh is below the land
};

// An object, for errors.
struct ObjectName {
  std::string key;   // of the sweep file: "land.object[2].place[5]"
  std::string text;  // "trees.csv:17:1: " of a place in a file; else empty
};

struct ObjectHit {
  double distance = 0;         // in lengths of the ray's direction
  Vec<Enu> normal{};           // of length 1, turned towards the ray
  Vec<Enu> departure_m{};      // in front of the surface, where another ray may begin
  std::uint32_t material = 0;  // of the land
};

// Meshes that stand on land: houses, trees. Each is opaque, and met from both sides.
//
// An object stands upright in the land's local frame. Its lowest point is sink_m below the lowest
// land under its base, which is what its mesh has within 5 % of its height from the ground.
//
// Accuracy: a ray is followed in double to the box around an object, and in float32 from there, in
// the frame of the object's mesh. Distances along it are within 2^-20 of the mesh's radius,
// wherever the object stands; departures are 2^-16 of that radius in front of the surface
// (tests/unit/land_objects_test.cpp). Memory: 100 bytes an object, 400 a facet of each mesh.
// Immutable; may be used by several threads at once.
class LandObjects {
 public:
  // Places objects on land. INVALID_ARGUMENT with the key of the model or place: a place beyond the
  // map of `field`, a scale that is not above 0, more than kMostLandObjects or kMostObjectFacets, a
  // mesh without facets.
  [[nodiscard]] static absl::StatusOr<LandObjects> create(std::vector<ObjectModel> model,
                                                          const HeightField& field,
                                                          TracerIsa isa = widest_isa());
  LandObjects(LandObjects&&) noexcept;
  LandObjects& operator=(LandObjects&&) noexcept;
  ~LandObjects();

  // Returns the first point of the ray origin + distance direction, 0 <= distance <= most, on an
  // object. Finite numbers, |direction| > 0.
  //   bend_per_m  as HeightField::first_hit has it: an object is raised by the bend at its middle.
  //               Across an object of s m at a distance r the bend differs by bend_per_m r s (3 mm
  //               for 10 m at 30 km). The departure is that of the straight ray.
  [[nodiscard]] std::optional<ObjectHit> first_hit(Vec<Enu> origin_m, Vec<Enu> direction,
                                                   double most, double bend_per_m = 0) const;
  [[nodiscard]] bool hidden(Vec<Enu> origin_m, Vec<Enu> direction, double most,
                            double bend_per_m = 0) const;

  // Returns the object that encloses a point: rays from the point upwards and to four sides meet
  // the object from behind.
  [[nodiscard]] std::optional<ObjectName> around(Vec<Enu> point_m) const;

  // Returns an upper bound of z of the objects within a rectangle; -infinity: there is none.
  [[nodiscard]] double highest_m(double west_m, double east_m, double south_m,
                                 double north_m) const {
    return tree_.highest_m(west_m, east_m, south_m, north_m);
  }

  [[nodiscard]] std::size_t count() const { return object_.size(); }
  // Returns the middle of the box around an object, relative to the land's origin.
  [[nodiscard]] Vec<Enu> middle_m(std::size_t object) const { return object_[object].middle_m; }
  [[nodiscard]] std::size_t memory_bytes() const;

  // The meshes and where they stand, for other ray tracers.
  struct ShapeMesh {
    std::span<const float> vertex;            // x y z around the middle of the mesh's box
    std::span<const std::uint32_t> triangle;  // three indices each
  };
  [[nodiscard]] std::size_t shapes() const;
  [[nodiscard]] ShapeMesh mesh(std::size_t shape) const;
  [[nodiscard]] std::uint32_t material(std::size_t shape, std::uint32_t facet) const;
  struct Stand {
    std::uint32_t shape;
    Vec<Enu> middle_m;  // of the mesh's box, without a bend
    double cos_heading, sin_heading, scale;
  };
  // Returns the stand of an object: (x, y, z) of its mesh stands at middle_m + scale (x s + y c, x
  // c - y s, -z).
  [[nodiscard]] Stand stand(std::size_t object) const {
    const Object& o = object_[object];
    return {o.shape, o.middle_m, o.cos_heading, o.sin_heading, o.scale};
  }

 private:
  struct Shape;
  struct Object {
    Vec<Enu> middle_m;  // of the mesh's box
    double cos_heading, sin_heading, scale;
    std::uint32_t shape, place;
  };
  struct LocalRay;
  LandObjects();
  [[nodiscard]] std::optional<LocalRay> enter(const Object& object, Vec<Enu> origin_m,
                                              Vec<Enu> direction, double most_m,
                                              double bend_per_m) const;

  std::vector<Shape> shape_;
  std::vector<Object> object_;
  BoxTree tree_;
};

}  // namespace irsig
