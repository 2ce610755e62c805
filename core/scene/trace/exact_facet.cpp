#include "core/scene/trace/exact_facet.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/base/check.h"

namespace irsig {
namespace {

// A sum of doubles without any rounding: components of growing size that do not overlap.
// [shewchuk1997, GROW-EXPANSION with zero elimination]
class ExactSum {
 public:
  void add(double value) {
    double carry = value;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double sum = carry + part_[i];
      const double virtual_part = sum - carry;
      const double rest = (carry - (sum - virtual_part)) + (part_[i] - virtual_part);
      if (rest != 0) part_[kept++] = rest;
      carry = sum;
    }
    if (carry != 0) {
      IRSIG_CHECK(kept < part_.size());
      part_[kept++] = carry;
    }
    size_ = kept;
  }
  [[nodiscard]] int sign() const { return size_ == 0 ? 0 : part_[size_ - 1] > 0 ? 1 : -1; }

 private:
  std::array<double, 128> part_;
  std::size_t size_ = 0;
};

struct Pair {  // high + low, exactly
  double high, low;
};

Pair difference(double a, double b) {
  const double high = a - b;
  const double virtual_b = a - high;
  return {high, (a - (high + virtual_b)) + (virtual_b - b)};
}

Pair product(double a, double b) {
  const double high = a * b;
  return {high, std::fma(a, b, -high)};
}

void add_product(double a, double b, ExactSum& sum) {
  if (a == 0 || b == 0) return;
  const Pair p = product(a, b);
  sum.add(p.low);
  sum.add(p.high);
}

void add_product(double a, double b, double c, ExactSum& sum) {
  if (a == 0 || b == 0 || c == 0) return;
  const Pair p = product(a, b);
  add_product(p.low, c, sum);
  add_product(p.high, c, sum);
}

struct ExactVector {
  Pair part[3];
};
ExactVector exact_difference(const Point3& a, const Point3& b) {
  return {{difference(a[0], b[0]), difference(a[1], b[1]), difference(a[2], b[2])}};
}

int exact_determinant_sign(const ExactVector& a, const ExactVector& b, const Point3& d) {
  ExactSum sum;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    for (const double x : {a.part[i].high, a.part[i].low}) {
      for (const double y : {b.part[j].high, b.part[j].low}) add_product(x, y, d[k], sum);
      for (const double y : {b.part[k].high, b.part[k].low}) add_product(x, -y, d[j], sum);
    }
  }
  return sum.sign();
}

// dE/do = (a - b) x d: the first component that does not vanish decides.
int moved_side(const Point3& a, const Point3& b, const Point3& d) {
  const ExactVector edge = exact_difference(a, b);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    ExactSum sum;
    for (const double x : {edge.part[j].high, edge.part[j].low}) add_product(x, d[k], sum);
    for (const double x : {edge.part[k].high, edge.part[k].low}) add_product(-x, d[j], sum);
    if (const int sign = sum.sign(); sign != 0) return sign;
  }
  return 0;  // the edge is parallel to the ray: so is its facet
}

double largest(const Point3& v) {
  return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
}

double determinant(const Point3& a, const Point3& b, const Point3& d) {
  return (a[1] * b[2] - a[2] * b[1]) * d[0] + (a[2] * b[0] - a[0] * b[2]) * d[1] +
         (a[0] * b[1] - a[1] * b[0]) * d[2];
}

double dot3(const Point3& a, const Point3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace

FacetHit exact_facet_hit(const Point3& origin, const Point3& direction, const Point3& a,
                         const Point3& b, const Point3& c) {
  const Point3* corner[3] = {&a, &b, &c};
  Point3 from_origin[3];
  double size[3];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) from_origin[i][j] = (*corner[i])[j] - origin[j];
    size[i] = largest(from_origin[i]);
  }
  const double bound = 0x1p-47 * largest(direction);
  double edge[3];
  int side[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    edge[i] = determinant(from_origin[i], from_origin[j], direction);
    side[i] = std::abs(edge[i]) > bound * size[i] * size[j] ? (edge[i] > 0 ? 1 : -1) : 0;
  }
  // Most facets end here: two certain sides that disagree.
  const int most = std::max({side[0], side[1], side[2]}),
            least = std::min({side[0], side[1], side[2]});
  if (most * least < 0) return {};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (side[i] != 0) continue;
    side[i] = exact_determinant_sign(exact_difference(*corner[i], origin),
                                     exact_difference(*corner[j], origin), direction);
    if (side[i] == 0) side[i] = moved_side(*corner[i], *corner[j], direction);
    if (side[i] == 0) return {};
  }
  if (side[0] != side[1] || side[1] != side[2]) return {};

  // The point as a mean of the corners, whose weights cannot leave the facet.
  double weight[3], sum = 0, along = 0;
  for (std::size_t i = 0; i < 3; ++i) sum += weight[i] = std::max(side[0] * edge[(i + 1) % 3], 0.0);
  if (sum == 0) {
    for (double& w : weight) w = 1;
    sum = 3;
  }
  for (std::size_t i = 0; i < 3; ++i) along += weight[i] * dot3(from_origin[i], direction);
  // E > 0 all round: the ray runs along the normal (b - a) x (c - a).
  return {true, side[0] < 0, along / (sum * dot3(direction, direction)), weight[1] / sum,
          weight[2] / sum};
}

}  // namespace irsig
