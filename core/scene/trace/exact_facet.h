#pragma once

#include <array>

namespace irsig {

// Decides by exact arithmetic if a ray meets a triangle: coordinates are the real numbers that
// their doubles stand for, and every sign that matters is the true one.
//
// The side of the edge from a to b on which the ray o + t d passes is the sign of
//     E(a, b) = det(a - o, b - o, d)
// and the facet (a, b, c) is met when E(a, b), E(b, c), E(c, a) have one sign. Where E is exactly 0
// (the ray goes through an edge or a vertex) the origin is taken to be moved by an infinitesimal
// (e, e^2, e^3): each ray then passes each edge on one side, so that of the facets around an inner
// edge or vertex of a closed surface exactly one is entered and none is left out, whatever their
// shape.  [edelsbrunner1990]
//
// Signs come from double arithmetic where its error bound allows (the difference of two doubles is
// rounded once, a product of three thrice: |error| < 64 * 2^-53 |a-o| |b-o| |d|, largest
// components) and from expansions of doubles elsewhere [shewchuk1997]. Coordinates must be 0 or
// between 1e-90 and 1e90.
using Point3 = std::array<double, 3>;

struct FacetHit {
  bool met = false;
  bool front = false;   // the ray comes from the side from which a, b, c run counter-clockwise
  double t = 0;         // where it meets the plane, to about 1e-15 of the distances
  double u = 0, v = 0;  // the point is (1 - u - v) a + u b + v c
};
// Computes where the whole line, also behind the origin, meets a facet. The caller compares t with
// the ray's ends.
[[nodiscard]] FacetHit exact_facet_hit(const Point3& origin, const Point3& direction,
                                       const Point3& a, const Point3& b, const Point3& c);

}  // namespace irsig
