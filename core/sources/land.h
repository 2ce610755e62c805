#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/environment/environment.h"
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
//
// Air bends rays. All of them are straight lines above land that is raised by the bend: by
// bend_per_m times the square of the distance from the target. Lines of sight leave the sensor so
// much higher than straight ones that they pass the target where these do. One bend is for all rays
// of a view, and for the mean of its conditions.
class Land {
 public:
  //   surface_z_m     body z of the land below the target, relative to the target's centre
  //   centre          of the target, relative to its reference point
  //   behind_range_m  SensorLine::land_range_m
  //   bend_per_m      bend_of()
  Land(std::shared_ptr<const LandScene> scene, double surface_z_m, Vec<Body> centre,
       std::vector<double> behind_range_m, double bend_per_m = 0);

  // Returns the bend with which the line of sight that touches a smooth Earth passes the target
  // where that of the horizon does.
  //   sensor_m  height of the sensor above the tangent plane of the surface below the target
  //   along_m   distance of the sensor from the target along that plane
  [[nodiscard]] static double bend_of(const Environment::Horizon& horizon, double sensor_m,
                                      double along_m);

  [[nodiscard]] std::uint32_t materials() const { return scene_->cover.materials(); }
  // Kinds of land, each of one material and temperature (LandScene::kinds).
  [[nodiscard]] std::uint32_t kinds() const {
    return scene_->kinds ? static_cast<std::uint32_t>(scene_->kinds->kind.size()) : materials();
  }
  [[nodiscard]] std::uint32_t material_of(std::uint32_t kind) const {
    return scene_->kinds ? scene_->kinds->kind[kind].material : kind;
  }

  // Returns the kind whose temperature slopes of a material face.
  [[nodiscard]] std::uint32_t level_of(std::uint32_t material) const {
    return scene_->kinds ? scene_->kinds->level_of(material) : material;
  }

  // Returns the point where a ray meets land. Sets what land is there.
  [[nodiscard]] std::optional<LandPoint> meet(Vec<Body> from, Vec<Body> direction,
                                              LandMix& mix) const;
  // Returns where a line of sight meets land, from the sensor or from where it has passed the
  // target on.
  [[nodiscard]] std::optional<LandPoint> meet_in_sight(Vec<Body> sensor, Vec<Body> from,
                                                       Vec<Body> direction, LandMix& mix) const;
  // Returns true if land covers the segment from + t direction, 0 <= t <= most.
  [[nodiscard]] bool hides(Vec<Body> from, Vec<Body> direction, double most) const;
  // Returns true if land covers the part t <= most of the line of sight
  // from + t (sensor - from).
  [[nodiscard]] bool hides_from(Vec<Body> sensor, Vec<Body> from, double most) const;
  // Returns a distance along a direction, a unit vector, beyond which no land comes near rays that
  // leave a sphere of that radius around the target's centre at most so far (a slope) from that
  // direction. 0: no land hides anything in that direction.
  [[nodiscard]] double clear_beyond_m(Vec<Body> direction, double radius_m, double spread) const;
  // Returns clear_beyond_m for lines of sight, before or behind the target.
  [[nodiscard]] double clear_in_sight_m(Vec<Body> sensor, Vec<Body> direction, double radius_m,
                                        double spread) const;
  // Returns the distance along a direction, a unit vector, at which a ray leaves the map for the
  // last time; 0: it is never above the map.
  [[nodiscard]] double leaves_map_m(Vec<Body> from, Vec<Body> direction) const;
  // Returns the highest one of the steps at the map's edge that a window around the target has in
  // sight: a part of its wall, or of the edge above it.
  //   half_m  of the window's sides, at the target
  [[nodiscard]] std::optional<EdgeStep> step_in_sight(Vec<Body> sensor, double half_m) const;
  // Returns true if the point lies below land or inside an object.
  [[nodiscard]] bool covers(Vec<Body> point) const;
  // Returns the object that encloses a point.
  [[nodiscard]] std::optional<ObjectName> object_around(Vec<Body> point) const;
  // Returns true if a point of a line of sight behind the target lies below land or
  // inside an object.
  [[nodiscard]] bool covers_in_sight(Vec<Body> sensor, Vec<Body> point) const;
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
  // Returns by how much a line of sight leaves the sensor higher than a straight one, as a slope of
  // z along x and along y.
  [[nodiscard]] Vec<Enu> lift(Vec<Body> sensor) const;
  [[nodiscard]] double raised_m(Vec<Enu> p) const { return bend_per_m_ * (p.x * p.x + p.y * p.y); }
  [[nodiscard]] std::optional<LandPoint> meet(Vec<Enu> origin, Vec<Enu> towards,
                                              LandMix& mix) const;
  void set_kinds(const LandPoint& at, bool object, LandMix& mix) const;
  [[nodiscard]] bool hidden(Vec<Enu> origin, Vec<Enu> towards, double most) const;
  [[nodiscard]] bool sees(const EdgeStep& step, Vec<Enu> sensor, Vec<Enu> higher,
                          double window) const;
  [[nodiscard]] double highest_m(double west_m, double east_m, double south_m,
                                 double north_m) const;
  [[nodiscard]] const HeightField& field() const { return *scene_->field; }

  std::shared_ptr<const LandScene> scene_;
  double surface_z_m_, cos_heading_, sin_heading_;
  Vec<Body> centre_;
  std::vector<double> behind_range_m_;
  double bend_per_m_;
};

}  // namespace irsig
