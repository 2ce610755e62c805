#pragma once

#include <vector>

#include "core/thermal/weather_course.h"

namespace irsig {

// The sine of the elevation of the sun's centre over a time, at a place and at times that
// sun_position() accepts.
class SunSine {
 public:
  explicit SunSine(const WeatherPlace& place) : place_(place) {}

  [[nodiscard]] double of(double unix_s) const;
  // Instants in (from, to) at which sine = level: found between 24 samples, of which only those are
  // computed before which the sine can have come to the level.
  [[nodiscard]] std::vector<double> crossings(double from, double to, double level) const;

  // The time in (from, to) with sine > level, and the integral of sine - level over it. Between
  // crossings the sine is nearly a cosine: five points of Gauss and Legendre leave 1e-12 of 3 h.
  struct Above {
    double length_s = 0, integral_s = 0;
  };
  [[nodiscard]] Above above(double from, double to, double level) const;

 private:
  [[nodiscard]] double root(double a, double b, bool falls, double level) const;

  WeatherPlace place_;
};

}  // namespace irsig
