#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "core/environment/background_directions.h"
#include "core/environment/fit/direction_nodes.h"
#include "core/geo/frames.h"
#include "core/sources/land.h"

namespace irsig {

// Sources on which paths can end, as far as rays need them: their positions, without their
// radiances.

// Emitting surfaces of the target, each of one temperature. By default every part is one emitter;
// an element of a mesh may be one too (10^4 to 10^5 of them), and belongs to a part.
struct Emitters {
  std::vector<std::uint32_t> of_facet;  // [facet]; empty: a facet's emitter is its part
  std::vector<std::uint32_t> part;      // [emitter]; empty likewise

  [[nodiscard]] std::uint32_t count(std::size_t parts) const {
    return static_cast<std::uint32_t>(of_facet.empty() ? parts : part.size());
  }
  [[nodiscard]] std::uint32_t of(std::uint32_t facet, std::uint32_t part_of_facet) const {
    return of_facet.empty() ? part_of_facet : of_facet[facet];
  }
  [[nodiscard]] std::uint32_t part_of(std::uint32_t emitter) const {
    return of_facet.empty() ? emitter : part[emitter];
  }
};

// The surface below the horizon, in coordinates relative to the target's centre.
struct Plane {
  double z_m = 0;             // of the surface (body z, down): a point below it is hidden by it
  double earth_radius_m = 0;  // > 0: its curvature hides what lies behind it (primary rays)
  // Refraction: the straight line to the sensor rises by so much more than the geometric one, above
  // a sphere of that radius (Environment::Horizon).
  double lift_rad = 0;
};
struct NoBoundary {};      // nothing to meet: two stated radiances
struct Sea : Plane {};     // mirrors the suns that have a wind
struct Ground : Plane {};  // mirrors nothing; the target stands on it as it floats on the sea
using Boundary = std::variant<NoBoundary, Sea, Ground, Land>;
[[nodiscard]] std::optional<Plane> plane_of(const Boundary& boundary);

// Returns true if the Earth hides a point from a sensor: tests the straight segment between them
// against the sphere of the plane's radius, with the plane's lift. A point below the surface is
// hidden.
[[nodiscard]] bool hidden_by(const Plane& plane, Vec<Body> point, Vec<Body> sensor);

// Hot gas as rays of a view meet it. A ray is traced once and shaded under any condition:
// what it meets is kept in measures, which are added up over rays, and what the gas takes of the
// light behind it as shares of what a few classes of gas take.
class RayMedium {
 public:
  virtual ~RayMedium() = default;
  [[nodiscard]] virtual std::uint32_t measures() const = 0;
  [[nodiscard]] virtual std::uint32_t classes() const = 0;

  // Returns the distance of the gas on a ray that ends at end_m [m]; nullopt: the ray meets none.
  //   from, direction  relative to the target's centre; a unit vector
  //   measure          [measures()]
  //   share            [classes()] weights of either sign. The absorption of the ray's gas is the
  //                    sum of the classes' absorptions times these weights.
  [[nodiscard]] virtual std::optional<double> cross(Vec<Body> from, Vec<Body> direction,
                                                    double end_m, std::span<double> measure,
                                                    std::span<float> share) const = 0;
};

// The medium that rays cross around the target. Clear air there neither absorbs nor emits; the air
// between target and sensor is in ViewEnvironment.
struct ClearMedium {};
// Between target and sensor, or behind the target: of primary rays.
struct HotGasMedium {
  std::shared_ptr<const RayMedium> rays;
};
// Around the target: of reflected rays and those that are aimed at lights.
struct HotGasAround {
  std::shared_ptr<const RayMedium> rays;
};
using Medium = std::variant<ClearMedium, HotGasMedium, HotGasAround>;

struct SunDirection {
  Vec<Body> direction;  // unit vector towards the sun's centre
  double angular_radius_rad;
  // > 0: a lamp this far from the target's centre, of the same intensity in all directions. Its
  // weights are per unit irradiance at the centre.
  double distance_m = 0;
  // > 0: a sea roughened by this wind mirrors it. [m/s]
  double sea_wind_m_s = 0;
  // Directions of the disk with a larger z have set (boundaries only): the sine of the horizon's
  // dip.
  double horizon_z = 0;
  // Rays that leave the target and fall less than this miss the sea that mirrors it.
  double sea_begins_z = 0;

  bool operator==(const SunDirection&) const = default;
};

struct SourceGeometry {
  Emitters emitters;
  Boundary boundary;
  Medium medium;
  std::vector<SunDirection> sun;
  // Directions in which the radiance of sky and surface is known, around the target; and along the
  // lines of sight beyond it (absent: the contrast is not wanted).
  DirectionNodes directions;
  std::optional<BackgroundDirections> behind;
  // Primary rays that fall more steeply than this (z of the unit vector) and meet no target end
  // below the horizon; all others below the horizontal.
  double horizon_z = 0;
  // Horizon of rays that leave the target, where the light below the horizon is uniform: the sine
  // of the horizon's dip for a target in the air.
  double around_horizon_z = 0;

  // Returns true if a sea mirrors one of the suns.
  [[nodiscard]] bool glitters() const;
};

}  // namespace irsig
