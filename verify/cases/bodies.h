#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/scene/mesh.h"
#include "core/signature/simulator.h"

namespace irsig {

// Bodies, worlds and requests of the hard cases. Every random number is a function of a seed in the
// case.

// Returns a prism over a regular polygon of `sides` corners on the circle of radius_m, about the x
// axis. Two fans close the prism. With many sides its walls are needles, and all facets of a fan
// share one vertex.
[[nodiscard]] Mesh needle_drum(std::uint32_t sides, double radius_m, double length_m);

// Returns a flat box of length x 1 x 1 m. Its upper face (z = -0.5, facing -z: up) is cut into
// `needles` strips along x, each of two triangles.
[[nodiscard]] Mesh needle_slab(std::uint32_t needles, double length_m, double width_m);

// Returns a sphere of radius 1 seen from inside, without the cap of the half angle [deg] about +x.
// Rings keep the area of the circle.
[[nodiscard]] Mesh spherical_cavity(double half_angle_deg, std::uint32_t rings,
                                    std::uint32_t sectors);

// Returns a one-sided rectangle of width x height in the plane x = 0, centred, facing +x. It
// consists of cells x cells squares of two triangles.
[[nodiscard]] Mesh plate(double width_m, double height_m, std::uint32_t cells = 1);

// Returns a rectangle of 2 u x 2 v about `at`, whose front faces along u x v. square() returns a
// square of half side half_m that faces along `normal`.
[[nodiscard]] Mesh rectangle(Vec<Body> at, Vec<Body> u, Vec<Body> v, const std::string& group);
[[nodiscard]] Mesh square(Vec<Body> at, Vec<Body> normal, double half_m, const std::string& group);

// Turns a mesh so that its +x side faces up (-z).
[[nodiscard]] Mesh lying(Mesh mesh);
[[nodiscard]] Mesh moved(Mesh mesh, Vec<Body> by);
// Returns both meshes as one. The groups of b follow the groups of a, with a prefix.
[[nodiscard]] Mesh joined(Mesh a, const Mesh& b, const std::string& prefix);
// Rotates v about an axis that is parallel to no edge of a body above, so that no coordinate is
// round.
[[nodiscard]] Vec<Body> askew(Vec<Body> v);
// Returns the mesh with every facet reversed.
[[nodiscard]] Mesh inside_out(Mesh mesh);

[[nodiscard]] MaterialSpec grey_paint(double emissivity);
[[nodiscard]] Band long_wave();  // 8-12 um
[[nodiscard]] SceneSpec one_body(Mesh mesh, MaterialSpec material);

// Returns a request of one condition and all bands, without reflections and sun, in surroundings of
// 0 K.
[[nodiscard]] ViewRequest dark_view(const Simulator& simulator, double azimuth_deg,
                                    double elevation_deg, double range_m,
                                    std::vector<double> part_temperature_k);

void put_sun(ConditionSpec& condition, Vec<Body> towards);

// Returns the in-band radiance of a blackbody by the simulator's quadrature.  [W m^-2 sr^-1]
[[nodiscard]] double black_radiance_w_m2_sr(const Simulator& simulator, std::size_t band,
                                            double temperature_k);

// Returns |value - expected| in standard errors, after subtraction of the part that a stated bias
// explains. A standard error below rounding (1e-7 of the expected value, from floats) counts as the
// rounding.
[[nodiscard]] double t_of(const Estimate& e, double expected, double bias = 0);

// Relative error of the area of a plate that fills its bounding rectangle: every ray meets it, and
// the standard error is 0. The remaining error is the rounding of rays
// (core/transport/primary_rays.cpp: 1e-7), and perspective: at 1e5 m a plate of 1 m turned by 20
// deg is a trapezoid whose rim, 1.7e-6 of the rectangle, is met by no sample.
inline constexpr double kMaskMargin = 2e-6;

// Numbers for tests: uniform in [0, 1), a function of seed and index.
[[nodiscard]] double uniform(std::uint64_t seed, std::uint64_t index);
// Returns a uniformly distributed unit vector; uses two numbers of the sequence.
[[nodiscard]] Vec<Body> uniform_direction(std::uint64_t seed, std::uint64_t index);

}  // namespace irsig
