#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/geo/line_of_sight.h"
#include "core/geo/sun.h"
#include "core/geo/viewpoint.h"
#include "core/scene/generate/generate_mesh.h"
#include "core/spectral/solar.h"
#include "verify/cases/bodies.h"
#include "verify/cases/groups.h"

namespace irsig {
namespace {

double angle_rad(Vec<Enu> a, Vec<Enu> b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

// Mean over the sun's disk of the sine of the elevation of its part above the horizon: the disk is
// cut by a chord at distance h from its centre.
double mean_sine(double elevation_deg, double radius_deg) {
  const double rho = std::tan(radius_deg * kRadPerDeg),
               cosine = std::cos(elevation_deg * kRadPerDeg),
               sine = std::sin(elevation_deg * kRadPerDeg);
  const double h = sine / (rho * cosine);
  if (h >= 1) return sine;
  if (h <= -1) return 0;
  const double root = std::sqrt(1 - h * h);
  return rho * cosine / std::numbers::pi *
         (2.0 / 3 * root * root * root + h * (std::numbers::pi / 2 + h * root + std::asin(h)));
}

// A level white plate under a sun that sets: irradiance of the part of the disk that is up.
absl::StatusOr<Finding> setting_sun(Effort effort) {
  Worst worst(student_t_bound(31, 10));
  ASSIGN_OR_RETURN(const auto simulator,
                   Simulator::create(one_body(lying(plate(1, 1)), grey_paint(0.5))));
  const BandGrid& grid = simulator->band_grids()[0];
  double irradiance = 0;
  for (std::size_t i = 0; i < grid.node_um.size(); ++i)
    irradiance += grid.band_weight[i] * solar_irradiance_w_m2_um(grid.node_um[i]);
  for (const double elevation_deg :
       {90.0, 89.9999, 60.0, 1.0, 0.3, 0.266, 0.1, 0.0, -0.1, -0.2, -0.27, -5.0, -90.0}) {
    ViewRequest r = dark_view(*simulator, 77, 90, 1e5, {300});
    put_sun(r.condition[0], body_from_aspect(33, elevation_deg));
    r.max_reflections = 1;
    r.accuracy.samples_per_replicate = effort == Effort::kFull ? 32768 : 2048;
    ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
    const Estimate& sun = view.row[0].cause_w_sr[static_cast<std::size_t>(Cause::kSunReflected)];
    const double expected = view.row[0].projected_area_m2.value * 0.5 / std::numbers::pi *
                            irradiance * mean_sine(elevation_deg, 0.266);
    const auto where = [&] {
      return absl::StrCat("elevation ", elevation_deg, " deg: ", sun.value, " +- ", sun.stderr_,
                          ", expected ", expected);
    };
    if (elevation_deg < -0.266)
      worst.require(sun.value == 0, where);
    else  // the disk is drawn on its tangent plane: radius^2 / 2
      worst.see(t_of(sun, expected, 3e-5 * expected), where);
    worst.require(view.guarded_nonfinite == 0 && view.guarded_negative == 0, where);
  }
  return worst.finding();
}

// Seen from exactly above and below, whatever the azimuth that goes with it, and from a hair
// beside.
absl::StatusOr<Finding> zenith_view(Effort effort) {
  Worst worst(student_t_bound(31, 12));
  ASSIGN_OR_RETURN(auto box, generate_mesh({"box", 300}));
  ASSIGN_OR_RETURN(const auto simulator,
                   Simulator::create(one_body(std::move(box), grey_paint(0.7))));
  for (const double elevation_deg : {90.0, 90 - 1e-9, 90 - 1e-4, -90.0})
    for (const double azimuth_deg : {0.0, 123.456, 359.999999}) {
      ViewRequest r = dark_view(*simulator, azimuth_deg, elevation_deg, 1e6, {300});
      r.accuracy.samples_per_replicate = effort == Effort::kFull ? 32768 : 2048;
      ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
      const Estimate& e = view.row[0].intensity_w_sr;
      // 2 m x 1 m; at 1e-4 deg the walls add 1e-6, the range of the roof 5e-7. The roof
      // fills the mask.
      const double expected = 2 * 0.7 * black_radiance_w_m2_sr(*simulator, 0, 300);
      worst.see(t_of(e, expected, (kMaskMargin + 2e-6) * expected), [&] {
        return absl::StrCat("azimuth ", azimuth_deg, ", elevation ", elevation_deg,
                            " deg: ", e.value, " +- ", e.stderr_, ", expected ", expected);
      });
    }
  return worst.finding();
}

const UtcTime kTimes[] = {{2025, 3, 20, 9, 1, 30},
                          {2025, 6, 21, 2, 42, 0},
                          {2025, 12, 21, 15, 3, 59.5},
                          {2024, 2, 29, 23, 59, 59},
                          {2016, 12, 31, 23, 59, 60.5}};

// The sun from the poles, across the date line, at its zenith: as unit vectors.
absl::StatusOr<Finding> sun_at_poles(Effort) {
  Worst worst(1e-9);
  for (const UtcTime& time : kTimes) {
    const auto sun = [&](double latitude_deg, double longitude_deg) {
      return sun_position(time, latitude_deg, longitude_deg, 0);
    };
    const auto where = [&](const char* what) {
      return [&time, what] { return absl::StrCat(what, " at ", format_rfc3339_utc(time)); };
    };
    for (const double latitude_deg : {0.0, 25.0, -67.0, 89.9}) {
      ASSIGN_OR_RETURN(const auto west, sun(latitude_deg, -180));
      ASSIGN_OR_RETURN(const auto east, sun(latitude_deg, 180));
      worst.see(angle_rad(west.direction, east.direction), where("date line"));
      ASSIGN_OR_RETURN(const auto before, sun(latitude_deg, 180 - 1e-9));
      ASSIGN_OR_RETURN(const auto after, sun(latitude_deg, -180 + 1e-9));
      worst.see(angle_rad(before.direction, after.direction), where("a hair beside"));
    }
    for (const double pole : {90.0, -90.0}) {
      ASSIGN_OR_RETURN(const auto first, sun(pole, 0));
      for (const double longitude_deg : {-180.0, -77.7, 90.0, 179.0}) {
        ASSIGN_OR_RETURN(const auto other, sun(pole, longitude_deg));
        // Height over the horizon does not depend on a longitude that does not exist ...
        worst.see(std::abs(other.direction.z - first.direction.z), where("pole"));
        // ... and the direction turns with it.
        const double turn = (pole > 0 ? 1 : -1) * longitude_deg * kRadPerDeg;
        // x east, y north: seen from a meridian further east, the sun stands further west.
        const Vec<Enu> d = first.direction;
        const Vec<Enu> turned{std::cos(turn) * d.x + std::sin(turn) * d.y,
                              std::cos(turn) * d.y - std::sin(turn) * d.x, d.z};
        worst.see(angle_rad(other.direction, turned), where("pole's meridian"));
        ASSIGN_OR_RETURN(const auto beside, sun(pole > 0 ? 90 - 1e-9 : -90 + 1e-9, longitude_deg));
        worst.see(angle_rad(beside.direction, other.direction), where("a hair from the pole"));
        const SunPosition& s = other;
        worst.require(std::isfinite(s.azimuth_deg) && s.azimuth_deg >= 0 && s.azimuth_deg < 360 &&
                          std::abs(length(s.direction) - 1) < 1e-12,
                      where("azimuth"));
      }
    }
  }
  return worst.finding();
}

// The place where the sun stands in the zenith, found by walking towards it: azimuth is free there,
// the unit vector is not.
absl::StatusOr<Finding> sun_at_zenith(Effort) {
  Worst worst(1e-9);
  for (const UtcTime& time : kTimes) {
    double latitude_deg = 0, longitude_deg = 0;
    SunPosition s{};
    for (int step = 0; step < 60; ++step) {
      ASSIGN_OR_RETURN(s, sun_position(time, latitude_deg, longitude_deg, 0));
      // Half-way where it is far: the Earth is round.
      const double reach = s.zenith_deg > 10 ? 0.5 : 1;
      const double east = std::atan2(s.direction.x, std::max(s.direction.z, 0.05)),
                   north = std::atan2(s.direction.y, std::max(s.direction.z, 0.05));
      latitude_deg = std::clamp(latitude_deg + reach * north / kRadPerDeg, -89.0, 89.0);
      longitude_deg += reach * east / (kRadPerDeg * std::cos(latitude_deg * kRadPerDeg));
      longitude_deg -= 360 * std::floor((longitude_deg + 180) / 360);
    }
    const auto where = [&] {
      return absl::StrCat(format_rfc3339_utc(time), ": ", latitude_deg, " N ", longitude_deg,
                          " E, zenith ", s.zenith_deg, " deg");
    };
    worst.see(std::hypot(s.direction.x, s.direction.y), where);
    worst.see(std::abs(s.zenith_deg * kRadPerDeg - std::hypot(s.direction.x, s.direction.y)),
              where);
    worst.require(std::isfinite(s.azimuth_deg) && s.azimuth_deg >= 0 && s.azimuth_deg < 360, where);
  }
  return worst.finding();
}

// A line of sight beside and across the date line and the poles gives equal results: on an
// ellipsoid of revolution, longitude is only a name.
absl::StatusOr<Finding> line_of_sight_anywhere(Effort) {
  Worst worst(1e-6);
  for (const double range_m : {10.0, 1e3, 1e5, 1e6})
    for (const double elevation_deg : {-0.3, 0.0, 5.0, 90.0})
      for (const double azimuth_deg : {0.0, 60.0, 90.0, 270.0}) {
        const Viewpoint viewpoint{azimuth_deg, elevation_deg, range_m};
        for (const double latitude_deg : {0.0, 60.0, 89.9999, -90.0, 90.0}) {
          const auto at = [&](double longitude_deg) {
            return line_of_sight({latitude_deg, longitude_deg, 20}, 30, viewpoint);
          };
          const LineOfSight home = at(0);
          for (const double longitude_deg : {-180.0, 180.0, 179.999999, -90.0}) {
            const LineOfSight there = at(longitude_deg);
            const auto where = [&] {
              return absl::StrCat(latitude_deg, " N ", longitude_deg, " E, range ", range_m,
                                  " m, elevation ", elevation_deg, ", azimuth ", azimuth_deg);
            };
            worst.see(std::abs(there.sensor.height_m - home.sensor.height_m), where);
            worst.see(std::abs(there.lowest_height_m - home.lowest_height_m), where);
            worst.see(std::abs(there.sensor.latitude_deg - home.sensor.latitude_deg), where);
            worst.see(std::abs(there.los_zenith_deg - home.los_zenith_deg), where);
            worst.require(there.sensor.longitude_deg >= -180 && there.sensor.longitude_deg <= 180 &&
                              there.sensor.latitude_deg >= -90 && there.sensor.latitude_deg <= 90,
                          where);
            if (std::abs(latitude_deg) > 89) continue;  // meridians meet
            const double turn = there.sensor.longitude_deg - home.sensor.longitude_deg;
            worst.see(std::abs(std::remainder(turn - longitude_deg, 360)), where);
          }
        }
      }
  return worst.finding();
}

// Directions there and back, over all headings, the exact poles of the body's sphere included.
absl::StatusOr<Finding> frames_there_and_back(Effort) {
  Worst worst(4e-16);
  for (int i = 0; i < 10000; ++i) {
    const auto k = static_cast<std::uint64_t>(i);
    const double heading_deg = i % 4 == 0 ? 90.0 * (i / 4 % 5) : 360 * uniform(9, k);
    Vec<Body> v = uniform_direction(10, k);
    if (i % 5 == 0) v = body_from_aspect(360 * uniform(11, k), i % 2 == 0 ? 90 : -90);
    const Vec<Body> back = body_from_enu(enu_from_body(v, heading_deg), heading_deg);
    const auto where = [&] { return absl::StrCat("heading ", heading_deg, ", vector ", i); };
    worst.see(length(back - v), where);
    worst.see(std::abs(length(v) - 1), where);
  }
  return worst.finding();
}

}  // namespace

std::vector<HardCase> sun_and_frame_cases() {
  return {
      {"sun_and_frames", "setting_sun",
       "a level plate, sun from the zenith to the nadir: the part of the disk that is up [t]",
       "Student's t of 10 rows; exactly 0 when the disk has set", setting_sun},
      {"sun_and_frames", "zenith_view", "a box from exactly above and below, any azimuth [t]",
       "Student's t of 12 rows, after rounding, the walls and the range (4e-6)", zenith_view},
      {"sun_and_frames", "sun_at_poles",
       "date line, poles, a hair beside: angles between unit vectors [rad]",
       "a hair is 1e-9 deg = 1.7e-11 rad of rotation; the almanac itself carries 1e-15",
       sun_at_poles},
      {"sun_and_frames", "sun_at_zenith",
       "where it is in the zenith: unit vector, zenith angle [rad]",
       "the walk converges to the rounding of degrees: 180 x 1.1e-16 deg, times 60 steps at worst",
       sun_at_zenith},
      {"sun_and_frames", "line_of_sight",
       "date line, poles, 10 m to 1000 km: heights, directions, longitudes [m, deg]",
       "the ellipsoid is round: only longitude may change; 1e-8 m and 1e-12 deg are claimed for "
       "heights and directions, and latitude near a pole by a circle of 1e-6 deg",
       line_of_sight_anywhere},
      {"sun_and_frames", "frames", "body to local and back, the exact zenith included, absolute",
       "two rotations of unit vectors: four roundings of 1.1e-16", frames_there_and_back},
  };
}

}  // namespace irsig
