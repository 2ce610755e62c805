#pragma once

#include <cstdint>
#include <vector>

namespace irsig {

struct Viewpoint {
  double aspect_azimuth_deg;    // [0, 360)
  double aspect_elevation_deg;  // [-90, 90]
  double range_m;
};

// The order of each set is part of a sweep's identity: rings from the lowest elevation given to the
// last, azimuth fastest. Azimuths are wrapped into [0, 360). Elevations outside [-90, 90] are the
// caller's error (checked).

// Returns `count` points spread evenly over the zone of elevations [min, max] on the sphere:
// elevation of equal-area rings' mid points (sin elevation equidistant), azimuth by the golden
// angle. [gonzalez2010]
[[nodiscard]] std::vector<Viewpoint> fibonacci_viewpoints(std::uint32_t count, double range_m,
                                                          double elevation_min_deg,
                                                          double elevation_max_deg);
[[nodiscard]] std::vector<Viewpoint> grid_viewpoints(const std::vector<double>& azimuth_deg,
                                                     const std::vector<double>& elevation_deg,
                                                     double range_m);
// Returns `count` equally spaced azimuths from 0 at each elevation.
[[nodiscard]] std::vector<Viewpoint> ring_viewpoints(std::uint32_t count,
                                                     const std::vector<double>& elevation_deg,
                                                     double range_m);

}  // namespace irsig
