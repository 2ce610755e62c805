// A mechanical-draft counter-flow cooling tower: a rectangular casing, a deck with a fan stack on
// it (the throat is its narrowest place), the fan's hub in the throat, the plenum under the deck,
// and the fill's surface that closes it. What is not there: fan blades and their shaft, louvres,
// pipes.
//
// The shell is one closed surface, as a thick-walled cup is; rings of the same number of points run
// along it, from the middle of its base up the outside, over the stack's rim and down the inside to
// the middle of the fill.
#include <cmath>
#include <numbers>
#include <vector>

#include "core/scene/generate/generate_kinds.h"

namespace irsig {
namespace {

using std::numbers::pi;
using TowerRing = std::vector<std::uint32_t>;

// In throat radii: heights from the deck to the throat and from there to the exit; the hyperboloid
// r = R sqrt(1 + (h / waist)^2) then has 1.07 R at the deck and 1.10 R at the exit.
constexpr double kDeckToThroat = 0.36, kThroatToExit = 0.44, kWaist = 0.96;
constexpr double kShell = 0.02, kHub = 0.25, kHubThickness = 0.1;
// Height of the plenum, from the deck down to the fill, as a fraction of the casing's height.
constexpr double kPlenum = 0.3;

// Fronts face the viewer who sees `a` run to the left and `b` above it: outside, with angles that
// run from the bow over starboard, and rings that go up outside and down inside.
class TowerMesh {
 public:
  explicit TowerMesh(std::uint32_t around) : around_(around) {}

  void group(const char* name) {
    group_ = static_cast<std::uint32_t>(mesh.group.size());
    mesh.group.emplace_back(name);
  }

  TowerRing centre(double z_m) { return {vertex({0, 0, z_m})}; }

  // A regular polygon with the area of the circle.
  TowerRing circle(double radius_m, double z_m) {
    const double step = 2 * pi / around_;
    const double corner_m = radius_m * std::sqrt(step / std::sin(step));
    TowerRing ring;
    for (std::uint32_t i = 0; i < around_; ++i) {
      const double angle = pi / 4 + step * i;
      ring.push_back(vertex({corner_m * std::cos(angle), corner_m * std::sin(angle), z_m}));
    }
    return ring;
  }

  // around / 4 points on each side; the first lies on the corner towards bow and starboard.
  TowerRing rectangle(double length_m, double width_m, double z_m) {
    const double x = length_m / 2, y = width_m / 2;
    const Vec<Body> corner[] = {{x, y, z_m}, {-x, y, z_m}, {-x, -y, z_m}, {x, -y, z_m}};
    TowerRing ring;
    const std::uint32_t side = around_ / 4;
    for (std::uint32_t k = 0; k < 4; ++k)
      for (std::uint32_t i = 0; i < side; ++i) {
        const double t = static_cast<double>(i) / side;
        ring.push_back(vertex((1 - t) * corner[k] + t * corner[(k + 1) % 4]));
      }
    return ring;
  }

  void strip(const TowerRing& a, const TowerRing& b) {
    for (std::uint32_t i = 0; i < around_; ++i) {
      const std::uint32_t j = (i + 1) % around_;
      if (a.size() > 1) facet(a[j], a[i], b[i % b.size()]);
      if (b.size() > 1) facet(a[j % a.size()], b[i], b[j]);
    }
  }

  Mesh mesh;

 private:
  std::uint32_t vertex(Vec<Body> at) {
    mesh.vertex.push_back(at);
    return static_cast<std::uint32_t>(mesh.vertex.size() - 1);
  }
  void facet(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.triangle.push_back({a, b, c});
    mesh.triangle_group.push_back(group_);
  }

  std::uint32_t around_, group_ = 0;
};

// The stack has this many rows of facets on either side; of the flat strips, five have two
// triangles around and two that end in a middle have one; the hub has four and the ground two.
std::uint32_t stack_rows(std::uint32_t around) { return around / 8; }
std::uint64_t tower_triangles(std::uint32_t around) {
  return static_cast<std::uint64_t>(around) * (18 + 4 * stack_rows(around));
}

}  // namespace

double cooling_tower_reach(double radius_m) {
  return 2 * radius_m * (std::sqrt(1 + std::pow(kDeckToThroat / kWaist, 2)) + kShell);
}

Mesh make_cooling_tower(double radius_m, double length_m, double width_m, double height_m,
                        std::uint64_t triangles) {
  std::uint32_t around = 16;
  while (tower_triangles(around + 8) <= triangles) around += 8;
  TowerMesh tower(around);
  const double shell_m = kShell * radius_m, deck_z = kDeckToThroat * radius_m,
               exit_z = -kThroatToExit * radius_m, ground_z = deck_z + height_m,
               fill_z = deck_z + kPlenum * height_m;
  const auto stack_radius_m = [&](double z) {
    return radius_m * std::sqrt(1 + std::pow(z / (kWaist * radius_m), 2));
  };
  const std::uint32_t rows = stack_rows(around);

  tower.group("casing");
  TowerRing last = tower.centre(ground_z);
  const auto on_to = [&](TowerRing next) {
    tower.strip(last, next);
    last = std::move(next);
  };
  const TowerRing foot = tower.rectangle(length_m, width_m, ground_z);
  on_to(foot);
  on_to(tower.rectangle(length_m, width_m, deck_z));
  tower.group("deck");
  on_to(tower.circle(stack_radius_m(deck_z) + shell_m, deck_z));
  tower.group("stack_outside");
  for (std::uint32_t i = 1; i <= rows; ++i) {
    const double z = deck_z + (exit_z - deck_z) * i / rows;
    on_to(tower.circle(stack_radius_m(z) + shell_m, z));
  }
  tower.group("stack_rim");
  on_to(tower.circle(stack_radius_m(exit_z), exit_z));
  tower.group("stack_inside");
  for (std::uint32_t i = 1; i <= rows; ++i) {
    const double z = exit_z + (deck_z + shell_m - exit_z) * i / rows;
    on_to(tower.circle(stack_radius_m(z), z));
  }
  tower.group("plenum");
  on_to(tower.rectangle(length_m - 2 * shell_m, width_m - 2 * shell_m, deck_z + shell_m));
  on_to(tower.rectangle(length_m - 2 * shell_m, width_m - 2 * shell_m, fill_z));
  tower.group("fill");
  on_to(tower.centre(fill_z));

  tower.group("hub");
  const double hub_m = kHub * radius_m, half_m = kHubThickness * radius_m / 2;
  last = tower.centre(half_m);
  on_to(tower.circle(hub_m, half_m));
  on_to(tower.circle(hub_m, -half_m));
  on_to(tower.centre(-half_m));

  tower.group("ground");
  tower.strip(tower.circle(std::hypot(length_m, width_m), ground_z), foot);
  return std::move(tower.mesh);
}

}  // namespace irsig
