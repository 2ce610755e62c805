#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/geo/frames.h"
#include "core/land/land_scene.h"
#include "core/land/objects/land_objects.h"

namespace irsig {

// Where a ray meets land.
struct LandPoint {
  double distance = 0;  // in lengths of the ray's direction
  Vec<Enu> normal, departure_m;
};

// Land around the target, with the objects that stand on it. It hides and shades the target, and
// rays end on it; what does not meet its map ends as above Ground. Points and directions are
// relative to the target's centre.
class Land {
 public:
  //   surface_z_m     body z of the land below the target, relative to the target's centre
  //   centre          of the target, relative to its reference point
  //   behind_range_m  SensorLine::land_range_m
  Land(std::shared_ptr<const LandScene> scene, double surface_z_m, Vec<Body> centre,
       std::vector<double> behind_range_m);

  [[nodiscard]] std::uint32_t materials() const { return scene_->cover.materials(); }

  // Returns the point where a ray meets land. Sets the fractions of the materials there.
  //   fraction  [materials()]
  [[nodiscard]] std::optional<LandPoint> meet(Vec<Body> from, Vec<Body> direction,
                                              std::span<float> fraction) const;
  // Returns true if land covers the segment from + t direction, 0 <= t <= most.
  [[nodiscard]] bool hides(Vec<Body> from, Vec<Body> direction, double most) const;
  // Returns a distance along a direction, a unit vector, beyond which no land comes near rays that
  // leave a sphere of that radius around the target's centre at most so far (a slope) from that
  // direction. 0: no land hides anything in that direction.
  [[nodiscard]] double clear_beyond_m(Vec<Body> direction, double radius_m, double spread) const;
  // Returns true if the point lies below land or inside an object.
  [[nodiscard]] bool covers(Vec<Body> point) const;
  // Returns the object that encloses a point.
  [[nodiscard]] std::optional<ObjectName> object_around(Vec<Body> point) const;
  // Returns the cosine of a sun's incidence on land; 0 in the shadow of land.
  [[nodiscard]] double sun_cosine(const LandPoint& at, Vec<Body> towards_sun) const;
  // Returns the fraction of a slope's hemisphere that is sky, as if land around it were level.
  [[nodiscard]] static float sky_fraction(const LandPoint& at);

  // Nodes of a range between which what arrives is linear: of land around the target, from there;
  // and of land behind it, from the sensor.
  struct RangeShare {
    std::uint32_t node = 0;  // and the next one
    float weight_of_next = 0;
    [[nodiscard]] float weight(std::uint32_t k) const {
      return k == 0 ? 1 - weight_of_next : weight_of_next;
    }
  };
  [[nodiscard]] static RangeShare around(double range_m);
  [[nodiscard]] RangeShare behind(double range_m) const;
  [[nodiscard]] std::uint32_t behind_ranges() const {
    return static_cast<std::uint32_t>(behind_range_m_.size());
  }

 private:
  [[nodiscard]] Vec<Enu> place(Vec<Body> p) const;
  [[nodiscard]] Vec<Enu> direction(Vec<Body> d) const;
  [[nodiscard]] bool hidden(Vec<Enu> origin, Vec<Enu> towards, double most) const;
  [[nodiscard]] double highest_m(double west_m, double east_m, double south_m,
                                 double north_m) const;
  [[nodiscard]] const HeightField& field() const { return *scene_->field; }

  std::shared_ptr<const LandScene> scene_;
  double surface_z_m_, cos_heading_, sin_heading_;
  Vec<Body> centre_;
  std::vector<double> behind_range_m_;
};

}  // namespace irsig
