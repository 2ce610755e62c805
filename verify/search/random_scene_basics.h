#pragma once

#include <array>
#include <cmath>
#include <string>

#include "absl/strings/str_format.h"

// Shared parts of drawing a random scene (random_scene.cpp) and writing its files
// (random_scene_files.cpp).
namespace irsig::random_scene_basics {

inline constexpr const char* kDate = "2025-06-21";
inline constexpr double kLatitudeDeg = 40, kLongitudeDeg = 0;

using V3 = std::array<double, 3>;

inline V3 operator+(V3 a, V3 b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline V3 operator*(double s, V3 a) { return {s * a[0], s * a[1], s * a[2]}; }
inline double dot(V3 a, V3 b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline V3 cross(V3 a, V3 b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline V3 unit(V3 a) { return (1 / std::sqrt(dot(a, a))) * a; }

// Returns a number as files state it.
inline std::string number(double v) { return absl::StrFormat("%.7g", v); }

}  // namespace irsig::random_scene_basics
