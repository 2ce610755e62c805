#pragma once

#include <array>
#include <cmath>

namespace irsig {

struct Body {};  // x forward, y starboard, z down; origin at the target's reference point
struct Enu {};   // x east, y north, z up, at a point on WGS 84

// A vector whose frame is part of its type: vectors of different frames do not mix.
template <typename Frame>
struct Vec {
  double x = 0, y = 0, z = 0;
  friend Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec operator*(double s, Vec a) { return {s * a.x, s * a.y, s * a.z}; }
  friend bool operator==(const Vec&, const Vec&) = default;
};
template <typename Frame>
double dot(Vec<Frame> a, Vec<Frame> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename Frame>
Vec<Frame> cross(Vec<Frame> a, Vec<Frame> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename Frame>
double length(Vec<Frame> a) {
  return std::sqrt(dot(a, a));
}
template <typename Frame>
Vec<Frame> normalized(Vec<Frame> a) {
  return (1.0 / length(a)) * a;
}

// Converts east-north-up to the frame of a level body (no pitch or roll) with its bow at
// heading_deg clockwise from true north.
[[nodiscard]] Vec<Body> body_from_enu(Vec<Enu> v, double heading_deg);
[[nodiscard]] Vec<Enu> enu_from_body(Vec<Body> v, double heading_deg);

// Returns the unit vector from the target towards an aspect: 0 bow-on, 90 from starboard, + when
// above.
[[nodiscard]] Vec<Body> body_from_aspect(double aspect_azimuth_deg, double aspect_elevation_deg);

}  // namespace irsig
