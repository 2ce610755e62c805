#include "core/land/height_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "tests/long_form.h"

namespace irsig {
namespace {

using Surface = std::function<double(double, double)>;

HeightGrid grid_of(const Surface& z, double west_m, double south_m, double spacing_m,
                   std::uint32_t columns, std::uint32_t rows) {
  HeightGrid out{west_m, south_m, spacing_m, columns, rows, {}};
  out.z_m.reserve((columns + std::size_t{1}) * (rows + 1));
  for (std::uint32_t row = 0; row <= rows; ++row)
    for (std::uint32_t column = 0; column <= columns; ++column)
      out.z_m.push_back(
          static_cast<float>(z(west_m + column * spacing_m, south_m + row * spacing_m)));
  return out;
}

HeightField field_of(HeightGrid outer, std::optional<HeightGrid> inset = std::nullopt) {
  auto field = HeightField::create(std::move(outer), std::move(inset));
  EXPECT_TRUE(field.ok()) << field.status();
  return *std::move(field);
}

float& z_at(HeightGrid& grid, std::uint32_t column, std::uint32_t row) {
  return grid.z_m[row * (grid.columns + 1) + column];
}

// Rough land: each vertex at random, some cells level.
HeightGrid rough(std::uint64_t seed, double west_m, double south_m, double spacing_m,
                 std::uint32_t columns, std::uint32_t rows) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> height(-20, 20);
  return grid_of(
      [&](double x, double) { return std::fmod(std::abs(x), 64) < 16 ? 3 : height(random); },
      west_m, south_m, spacing_m, columns, rows);
}

// A walker of another kind, as the judge: all crossings of a ray with grid lines and diagonals, in
// their order, and the side of the surface at each, in long double. Nothing is skipped.
class Judge {
 public:
  explicit Judge(HeightGrid outer, std::optional<HeightGrid> inset = {}, double bend_per_m = 0)
      : outer_(std::move(outer)), inset_(std::move(inset)), bend_per_m_(bend_per_m) {}

  struct Verdict {
    long double t = -1;  // of the hit; negative: none
    // The smallest distance from the surface along z at a crossing, before the hit and after it: a
    // ray with a small one is decided by rounding.
    long double margin_m = 1e9L;
  };
  [[nodiscard]] Verdict first_hit(Vec<Enu> o, Vec<Enu> d, long double most) const {
    std::vector<long double> t{0, most};
    lines(outer_, o, d, t);
    if (inset_) lines(*inset_, o, d, t);
    std::sort(t.begin(), t.end());
    t.erase(
        std::remove_if(t.begin(), t.end(), [&](long double v) { return !(v >= 0 && v <= most); }),
        t.end());
    Verdict out;
    const bool below = clearance(o, d, 0) < 0;
    long double before = clearance(o, d, 0), t_before = 0;
    for (const long double at : t) {
      const long double here = clearance(o, d, at);
      if (at > 0) out.margin_m = std::min(out.margin_m, std::abs(here));
      if ((here < 0) != below) {
        out.t = before == here ? at : t_before + (at - t_before) * before / (before - here);
        return out;
      }
      before = here;
      t_before = at;
    }
    return out;
  }
  // The distance along z of a point of the ray from the surface.
  [[nodiscard]] double off_surface_m(Vec<Enu> o, Vec<Enu> d, double t) const {
    return std::abs(double(clearance(o, d, t)));
  }
  [[nodiscard]] long double z_m(long double x, long double y) const {
    const bool finer = inset_ && x >= inset_->west_m && y >= inset_->south_m &&
                       x <= inset_->west_m + inset_->columns * inset_->spacing_m &&
                       y <= inset_->south_m + inset_->rows * inset_->spacing_m;
    const HeightGrid& grid = finer ? *inset_ : outer_;
    const long double u = (x - grid.west_m) / grid.spacing_m,
                      v = (y - grid.south_m) / grid.spacing_m;
    const auto column = std::clamp<std::int64_t>(std::int64_t(std::floor(u)), 0, grid.columns - 1);
    const auto row = std::clamp<std::int64_t>(std::int64_t(std::floor(v)), 0, grid.rows - 1);
    const long double a = u - column, b = v - row;
    const auto z = [&](int i, int j) -> long double {
      return grid.z_m[std::size_t(row + j) * (grid.columns + 1) + std::size_t(column + i)];
    };
    return a >= b ? (1 - a) * z(0, 0) + (a - b) * z(1, 0) + b * z(1, 1)
                  : (1 - b) * z(0, 0) + (b - a) * z(0, 1) + a * z(1, 1);
  }

 private:
  static void lines(const HeightGrid& grid, Vec<Enu> o, Vec<Enu> d, std::vector<long double>& t) {
    const auto family = [&](long double at, long double step, int from, int to) {
      if (step == 0) return;
      for (int line = from; line <= to; ++line) t.push_back((line - at) / step);
    };
    const long double x = ((long double)(o.x) - grid.west_m) / grid.spacing_m;
    const long double y = ((long double)(o.y) - grid.south_m) / grid.spacing_m;
    const long double dx = (long double)(d.x) / grid.spacing_m,
                      dy = (long double)(d.y) / grid.spacing_m;
    const int columns = int(grid.columns), rows = int(grid.rows);
    family(x, dx, 0, columns);
    family(y, dy, 0, rows);
    family(x - y, dx - dy, -rows, columns);
  }
  [[nodiscard]] long double clearance(Vec<Enu> o, Vec<Enu> d, long double t) const {
    const long double x = o.x + t * d.x, y = o.y + t * d.y;
    return o.z + t * d.z - bend_per_m_ * (x * x + y * y) - z_m(x, y);
  }
  HeightGrid outer_;
  std::optional<HeightGrid> inset_;
  long double bend_per_m_;
};

struct Land {
  HeightField field;
  Judge judge;
};

// 64 x 48 cells with an inset of cells a fifth as wide. The judge has the inset as it was joined.
Land rough_land(std::uint64_t seed, bool with_inset) {
  HeightGrid outer = rough(seed, -500, 250, 15, 64, 48);
  std::optional<HeightGrid> inset;
  if (with_inset) inset = rough(seed + 1, -500 + 15 * 20, 250 + 15 * 10, 3, 100, 75);
  HeightField field = field_of(outer, inset);
  Judge judge(field.outer(),
              field.inset() ? std::optional<HeightGrid>(*field.inset()) : std::nullopt);
  return {std::move(field), std::move(judge)};
}

// Rays whose whole segment lies over the map: from anywhere between `lowest` and `highest` above
// the land to a point `aim` returns.
struct RayKind {
  const char* name;
  double lowest_m, highest_m;
  std::function<Vec<Enu>(std::mt19937_64&, const Land&, Vec<Enu> origin)> aim;
};

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Vec<Enu> anywhere(std::mt19937_64& random) {
  return {uniform(random, -500, 460), uniform(random, 250, 970), 0};
}

Vec<Enu> vertex(std::mt19937_64& random, const HeightGrid& grid) {
  const auto column = std::uniform_int_distribution<std::uint32_t>(0, grid.columns)(random);
  const auto row = std::uniform_int_distribution<std::uint32_t>(0, grid.rows)(random);
  return {grid.west_m + column * grid.spacing_m, grid.south_m + row * grid.spacing_m,
          grid.z_m[row * (grid.columns + 1) + column]};
}

double ulp(std::mt19937_64& random, double value) {
  const int step = std::uniform_int_distribution<int>(-1, 1)(random);
  return step == 0 ? value : std::nextafter(value, step * 1e9);
}

Vec<Enu> within_map(Vec<Enu> at) {
  return {std::clamp(at.x, -500.0, 460.0), std::clamp(at.y, 250.0, 970.0), at.z};
}

std::vector<RayKind> ray_kinds() {
  const auto to_height = [](double low, double high) {
    return [=](std::mt19937_64& random, const Land&, Vec<Enu>) {
      Vec<Enu> to = anywhere(random);
      to.z = uniform(random, low, high);
      return to;
    };
  };
  const auto to_vertex = [](bool inset) {
    return [=](std::mt19937_64& random, const Land& land, Vec<Enu>) {
      const HeightGrid* finer = land.field.inset();
      const Vec<Enu> at = vertex(random, inset && finer ? *finer : land.field.outer());
      return Vec<Enu>{ulp(random, at.x), ulp(random, at.y), ulp(random, at.z)};
    };
  };
  const auto to_edge = [](std::mt19937_64& random, const Land& land, Vec<Enu>) {
    Vec<Enu> at = anywhere(random);
    const double cells = std::floor((at.x + 500) / 15);
    switch (std::uniform_int_distribution<int>(0, 2)(random)) {
      case 0:
        at.x = -500 + 15 * cells;
        break;
      case 1:
        at.y = 250 + 15 * std::floor((at.y - 250) / 15);
        break;
      default:
        at.y = 250 + 15 * std::floor((at.y - 250) / 15) + (at.x + 500 - 15 * cells);
    }
    at = within_map({ulp(random, at.x), ulp(random, at.y), 0});
    at.z = *land.field.z_m(at.x, at.y);
    return at;
  };
  const auto along_x = [](std::mt19937_64& random, const Land&, Vec<Enu> origin) {
    return Vec<Enu>{uniform(random, -500, 460), origin.y, uniform(random, -20, 20)};
  };
  const auto along_diagonal = [](std::mt19937_64& random, const Land&, Vec<Enu> origin) {
    const double most = std::min(460 - origin.x, 970 - origin.y), step = uniform(random, 0, most);
    return Vec<Enu>{origin.x + step, origin.y + step, uniform(random, -20, 20)};
  };
  const auto vertical = [](std::mt19937_64& random, const Land&, Vec<Enu> origin) {
    return Vec<Enu>{origin.x, origin.y, uniform(random, -30, 30)};
  };
  const auto level = [](std::mt19937_64& random, const Land&, Vec<Enu> origin) {
    Vec<Enu> to = anywhere(random);
    to.z = origin.z;
    return to;
  };
  return {{"far above", 1000, 30000, to_height(-30, 30)},
          {"near", 0.1, 50, to_height(-30, 30)},
          {"grazing", 0.01, 5, to_height(17, 20)},
          {"from below", -40, -1e-6, to_height(-60, 60)},
          {"to vertices", 0.1, 500, to_vertex(false)},
          {"to vertices of the inset", 0.1, 500, to_vertex(true)},
          {"to vertices from below", -40, -0.1, to_vertex(true)},
          {"to edges", 0.1, 500, to_edge},
          {"along x", 0.1, 30, along_x},
          {"along diagonals", 0.1, 30, along_diagonal},
          {"vertical", -30, 30, vertical},
          {"level", -30, 30, level}};
}

// Origins on grid lines are as likely as others: a ray along x or a diagonal then runs along edges.
Vec<Enu> origin_of(std::mt19937_64& random, const Land& land, const RayKind& kind) {
  Vec<Enu> at = anywhere(random);
  if (random() % 2 == 0) at = vertex(random, land.field.outer());
  at.z = double(land.judge.z_m(at.x, at.y)) + uniform(random, kind.lowest_m, kind.highest_m);
  return at;
}

// Rationale: pyramid, cells and seam must neither lose nor invent a hit. Expected: the judge's
// hits; a ray that passes the surface within 1e-9 m at a crossing may be decided either way, and
// its number is bounded. Source: independent arithmetic.
TEST(HeightField, HitsAreThoseOfTheJudge) {
  for (const bool with_inset : {false, true}) {
    const Land land = rough_land(7, with_inset);
    const double rounding_m = with_inset ? 2e-6 : 1e-9;
    for (const RayKind& kind : ray_kinds()) {
      std::mt19937_64 random(11);
      int hits = 0, doubtful = 0;
      const int rays = long_form() ? 400000 : 5000;
      for (int ray = 0; ray < rays; ++ray) {
        const Vec<Enu> from = origin_of(random, land, kind);
        const Vec<Enu> way = within_map(kind.aim(random, land, from)) - from;
        const auto hit = land.field.first_hit(from, way, 1);
        const Judge::Verdict judged = land.judge.first_hit(from, way, 1);
        hits += hit.has_value();
        const bool same =
            hit.has_value() == (judged.t >= 0) &&
            (!hit || (std::abs(double(judged.t) - hit->distance) * length(way) < 1e-3 &&
                      land.judge.off_surface_m(from, way, hit->distance) < 2 * rounding_m));
        if (same) continue;
        ++doubtful;
        EXPECT_LT(double(judged.margin_m), rounding_m)
            << kind.name << " ray " << ray << ": " << (hit ? hit->distance : -1) << " against "
            << double(judged.t);
      }
      EXPECT_GT(hits, rays / 20) << kind.name;
      const bool aimed = std::string_view(kind.name).find("to ") == 0;
      EXPECT_LE(doubtful, aimed ? rays : rays / 100) << kind.name;
    }
  }
}

// Rationale: air bends rays up or down. Expected: the judge's hits, of rays that are bent by 30 m
// over the map. Between the lines of the grid either takes them as straight. Source: independent
// arithmetic.
TEST(HeightField, BentRaysMeetWhatTheJudgeSays) {
  for (const double bend_per_m : {3e-5, -3e-5}) {
    Land land = rough_land(7, false);
    land.judge = Judge(land.field.outer(), {}, bend_per_m);
    for (const RayKind& kind : ray_kinds()) {
      std::mt19937_64 random(11);
      int hits = 0;
      const int rays = long_form() ? 400000 : 5000;
      for (int ray = 0; ray < rays; ++ray) {
        const double raised_m = bend_per_m * 8e5;
        Vec<Enu> from = origin_of(random, land, kind);
        from.z += raised_m;
        Vec<Enu> way = within_map(kind.aim(random, land, from)) - from;
        way.z += raised_m;
        const auto hit = land.field.first_hit(from, way, 1, bend_per_m);
        const Judge::Verdict judged = land.judge.first_hit(from, way, 1);
        hits += hit.has_value();
        if (hit) {
          EXPECT_TRUE(land.field.hidden(from, way, 1, bend_per_m));
        }
        if (double(judged.margin_m) < 1e-8) continue;
        ASSERT_EQ(hit.has_value(), judged.t >= 0) << kind.name << " ray " << ray;
        if (hit) {
          EXPECT_LT(land.judge.off_surface_m(from, way, hit->distance), 3e-5 * 15 * 15 / 2 + 1e-8)
              << kind.name << " ray " << ray;
        }
      }
      EXPECT_GT(hits, rays / 20) << kind.name;
    }
  }
}

// Rationale: a ray that climbs more steeply than the land is told free without a look at heights.
// Expected: what the judge says, of rays that leave gentle land with a steep ridge and steep peaks
// in an inset, straight and bent. Source: independent arithmetic.
TEST(HeightField, RaysThatOutclimbTheLandMeetWhatTheJudgeSays) {
  const auto gentle = [](double x, double y) { return 3 * std::sin(x / 40) * std::cos(y / 55); };
  HeightGrid grid =
      grid_of([&](double x, double y) { return gentle(x, y) + (std::abs(x - 900) < 40 ? 60 : 0); },
              0, 0, 10, 128, 128);
  HeightGrid finer = grid_of(
      [&](double x, double y) {
        return gentle(x, y) + 25 * std::exp(-std::hypot(x - 330, y - 640) / 6);
      },
      280, 600, 2.5, 40, 40);
  for (const double bend_per_m : {0.0, 2e-5, -2e-5}) {
    const HeightField field = bend_per_m == 0 ? field_of(grid, finer) : field_of(grid);
    const Judge judge(field.outer(), bend_per_m == 0 ? std::optional(*field.inset()) : std::nullopt,
                      bend_per_m);
    std::mt19937_64 random(3);
    int met = 0, free = 0;
    for (int ray = 0; ray < 4000; ++ray) {
      Vec<Enu> from{uniform(random, 1, 1279), uniform(random, 1, 1279), 0};
      if (ray % 2 == 0) from = {uniform(random, 250, 400), uniform(random, 570, 720), 0};
      from.z = *field.z_m(from.x, from.y) + uniform(random, 1e-3, 1) +
               bend_per_m * (from.x * from.x + from.y * from.y);
      const double turn = uniform(random, 0, 6.2831853);
      Vec<Enu> way{std::cos(turn), std::sin(turn), uniform(random, 0.02, 3)};
      way.z += 2 * bend_per_m * (from.x * way.x + from.y * way.y);
      // As far as the map reaches.
      double most = 1e4;
      for (const auto& [at, step] : {std::pair{from.x, way.x}, std::pair{from.y, way.y}})
        if (step != 0) most = std::min(most, ((step > 0 ? 1280 : 0) - at) / step);
      most *= 1 - 1e-9;
      const Judge::Verdict judged = judge.first_hit(from, way, most);
      if (double(judged.margin_m) < 1e-4) continue;
      const auto hit = field.first_hit(from, way, most, bend_per_m);
      ASSERT_EQ(hit.has_value(), judged.t >= 0) << bend_per_m << " ray " << ray;
      (hit ? met : free) += 1;
    }
    EXPECT_GT(met, 50) << bend_per_m;
    EXPECT_GT(free, 1000) << bend_per_m;
  }
}

// Rationale: what is told free without a look must not be told so too early. Expected, in closed
// form, on a slope of 1/2: a ray that rises by 0.45 meets it, one by 0.52 does not unless it is
// bent down, and one from beyond the map meets the wall at its edge, however steep it is.
TEST(HeightField, RaysThatDoNotOutclimbTheLandMeetIt) {
  const HeightField slope =
      field_of(grid_of([](double x, double) { return 0.5 * x; }, 0, -500, 10, 100, 100));
  const auto meets = [&](Vec<Enu> from, double rise, double bend_per_m) {
    return slope.first_hit(from, {1, 0, rise}, 900, bend_per_m);
  };
  const Vec<Enu> above{0.5, 3, 1.25};
  const auto straight = meets(above, 0.45, 0);
  ASSERT_TRUE(straight.has_value());
  EXPECT_NEAR(straight->distance, 20, 1e-4);
  EXPECT_FALSE(meets(above, 0.52, 0).has_value());
  // 1 + 0.02 t = 2e-4 ((t + 0.5)^2 + 9), but for the cells' chords.
  const auto bent = meets(above, 0.52, 2e-4);
  ASSERT_TRUE(bent.has_value());
  EXPECT_NEAR(bent->distance, 136, 1.5);
  const auto wall = meets({-20, 3, -12}, 0.55, 0);
  ASSERT_TRUE(wall.has_value());
  EXPECT_TRUE(wall->at_edge);
  EXPECT_NEAR(wall->distance, 20, 1e-9);
}

// Rationale: a ray that begins above the land and ends below it must have a hit, wherever it
// passes; so must one the other way round. Expected: no exception, at vertices, edges and the seam
// too.
TEST(HeightField, NoRayIsLostBetweenAboveAndBelow) {
  const Land land = rough_land(21, true);
  std::mt19937_64 random(5);
  int lost = 0, escaped = 0;
  for (int ray = 0, rays = long_form() ? 50000000 : 300000; ray < rays; ++ray) {
    const HeightGrid& grid = ray % 3 == 0 ? land.field.outer() : *land.field.inset();
    Vec<Enu> through = vertex(random, grid);
    const Vec<Enu> other = vertex(random, grid);
    if (ray % 2 == 0) through = 0.5 * (through + other);
    through = {ulp(random, through.x), ulp(random, through.y), ulp(random, through.z)};
    Vec<Enu> from = anywhere(random);
    from.z = *land.field.z_m(from.x, from.y) + uniform(random, 0.01, 300);
    Vec<Enu> way = through - from;
    Vec<Enu> to = from + 1.01 * way;
    to = within_map(to);
    to.z = std::min(to.z, *land.field.z_m(to.x, to.y) - 0.001);
    lost += !land.field.first_hit(from, to - from, 1).has_value();
    const auto out = land.field.first_hit(to, from - to, 1);
    escaped += !out.has_value() || !out->from_below;
  }
  EXPECT_EQ(lost, 0);
  EXPECT_EQ(escaped, 0);
}

// Rationale: what a hit states must be one point. Expected: barycentric weights, height and normal
// of the stated triangle. Source: the vertices.
TEST(HeightField, HitsDescribeTheirTriangle) {
  const Land land = rough_land(3, true);
  std::mt19937_64 random(9);
  int seen = 0;
  for (int ray = 0; ray < 20000; ++ray) {
    const Vec<Enu> from{uniform(random, -500, 460), uniform(random, 250, 970), 100};
    Vec<Enu> to = anywhere(random);
    to.z = -30;
    const auto hit = land.field.first_hit(from, to - from, 1);
    ASSERT_TRUE(hit.has_value());
    ++seen;
    const HeightGrid& grid = hit->inset ? *land.field.inset() : land.field.outer();
    const auto corner = [&](std::uint32_t i, std::uint32_t j) {
      return Vec<Enu>{grid.west_m + (hit->column + i) * grid.spacing_m,
                      grid.south_m + (hit->row + j) * grid.spacing_m,
                      grid.z_m[(hit->row + j) * (grid.columns + 1) + hit->column + i]};
    };
    const bool southeast = hit->triangle == LandTriangle::kSoutheast;
    const Vec<Enu> a = corner(0, 0), b = southeast ? corner(1, 0) : corner(0, 1), c = corner(1, 1);
    const Vec<Enu> stated =
        hit->barycentric[0] * a + hit->barycentric[1] * b + hit->barycentric[2] * c;
    EXPECT_LT(length(stated - (from + hit->distance * (to - from))), 1e-9);
    const Vec<Enu> normal = normalized((southeast ? 1.0 : -1.0) * cross(b - a, c - a));
    EXPECT_LT(length(hit->normal - normal), 1e-12);
    EXPECT_FALSE(hit->from_below);
  }
  EXPECT_EQ(seen, 20000);
}

// Rationale: a ray that leaves the surface must not meet it where it begins. Expected: upwards
// along the normal of a plane nothing is met; downwards the surface is met within 3 um.
TEST(HeightField, DeparturesLieAboveTheSurface) {
  const HeightField plane = field_of(
      grid_of([](double x, double y) { return 0.3 * x - 0.2 * y; }, -5e4, -5e4, 1000, 100, 100));
  std::mt19937_64 random(2);
  int met = 0, far = 0;
  for (int ray = 0; ray < 20000; ++ray) {
    const Vec<Enu> from{uniform(random, -4e4, 4e4), uniform(random, -4e4, 4e4), 3e4};
    Vec<Enu> to{uniform(random, -4e4, 4e4), uniform(random, -4e4, 4e4), -3e4};
    const auto hit = plane.first_hit(from, to - from, 1);
    ASSERT_TRUE(hit.has_value());
    const Vec<Enu> at = plane.departure_m(from, to - from, *hit);
    met += plane.hidden(at, hit->normal, 1e5);
    // Within its own facet, a ray along it meets nothing.
    const double azimuth = uniform(random, 0, 2 * std::numbers::pi);
    const Vec<Enu> flat{std::cos(azimuth), std::sin(azimuth), 0};
    const Vec<Enu> along{flat.x, flat.y, -dot(hit->normal, flat) / hit->normal.z};
    met += plane.hidden(at, along, 0.01);
    EXPECT_NEAR(at.z - *plane.z_m(at.x, at.y), 1e-6, 1e-10);
    const auto down = plane.first_hit(at, -1.0 * hit->normal, 1e5);
    far += !down || down->distance > 3e-6;
  }
  EXPECT_EQ(met, 0);
  EXPECT_EQ(far, 0);
}

TEST(HeightField, WallsCloseTheLandAtItsEdges) {
  const HeightField land = field_of(grid_of([](double, double) { return 10; }, 0, 0, 5, 20, 20));
  const auto into = land.first_hit({-50, 50, 5}, {1, 0, 0}, 1000);
  ASSERT_TRUE(into.has_value());
  EXPECT_TRUE(into->at_edge);
  EXPECT_EQ(into->distance, 50);
  EXPECT_FALSE(land.first_hit({-50, 50, 10.5}, {1, 0, 0}, 1000).has_value());
  EXPECT_FALSE(land.first_hit({-50, 50, 5}, {1, 0, 0}, 49).has_value());
  const auto out_of = land.first_hit({50, 50, 5}, {0, 1, 0}, 1000);
  ASSERT_TRUE(out_of.has_value());
  EXPECT_TRUE(out_of->at_edge);
  EXPECT_TRUE(out_of->from_below);
  EXPECT_EQ(out_of->distance, 50);
  // It ends below the land, and is hidden there.
  EXPECT_FALSE(land.first_hit({50, 50, 5}, {0, 1, 0}, 20).has_value());
  EXPECT_TRUE(land.hidden({50, 50, 5}, {0, 1, 0}, 20));
  EXPECT_FALSE(land.hidden({50, 50, 10}, {0, 1, 0}, 1000));  // along the surface
}

TEST(HeightField, HeightsBetweenVerticesFollowTheDiagonal) {
  HeightGrid grid = grid_of([](double, double) { return 0; }, 0, 0, 10, 1, 1);
  z_at(grid, 1, 0) = 6;
  const HeightField land = field_of(grid);
  EXPECT_EQ(land.z_m(10, 0), 6);
  EXPECT_EQ(land.z_m(5, 5), 0);
  EXPECT_EQ(land.z_m(5, 0), 3);
  EXPECT_EQ(land.z_m(2, 8), 0);
  EXPECT_FALSE(land.z_m(10.001, 0).has_value());
  EXPECT_FALSE(land.z_m(0, -1e-9).has_value());
}

// Expected: the plane's own intersection to 1e-8 m, at 50 km.
TEST(HeightField, PlaneHasItsClosedForm) {
  const HeightField land = field_of(
      grid_of([](double x, double y) { return x / 64 + y / 128; }, -51200, -51200, 64, 1600, 1600));
  std::mt19937_64 random(4);
  for (int ray = 0; ray < 20000; ++ray) {
    const Vec<Enu> from{uniform(random, -5e4, 5e4), uniform(random, -5e4, 5e4),
                        uniform(random, 1300, 3e4)};
    const Vec<Enu> to{uniform(random, -5e4, 5e4), uniform(random, -5e4, 5e4), -1300};
    const Vec<Enu> way = normalized(to - from);
    const double expected =
        (from.z - from.x / 64 - from.y / 128) / (way.x / 64 + way.y / 128 - way.z);
    const auto hit = land.first_hit(from, way, 2e5);
    ASSERT_TRUE(hit.has_value());
    EXPECT_NEAR(hit->distance, expected, 1e-8 * (1 + 1e-2 / std::abs(way.z)));
  }
}

// Expected: facets of a cone deviate from it by at most s^2 / (8 r) along z, r the distance from
// its axis, so that a level ray meets its side within that over the slope. Source: chord of a
// circle.
TEST(HeightField, ConeHasItsSilhouette) {
  const double slope = 0.5, top_m = 500, spacing_m = 2;
  const HeightField land =
      field_of(grid_of([&](double x, double y) { return top_m - slope * std::hypot(x, y); }, -1000,
                       -1000, spacing_m, 1000, 1000));
  std::mt19937_64 random(6);
  for (int ray = 0; ray < 5000; ++ray) {
    const double z = uniform(random, 20, 480), radius = (top_m - z) / slope;
    const double off = uniform(random, -2, 2) * radius,
                 angle = uniform(random, 0, 2 * std::numbers::pi);
    const Vec<Enu> way{std::cos(angle), std::sin(angle), 0};
    const Vec<Enu> from = -990.0 * way + off * Vec<Enu>{-way.y, way.x, 0} + Vec<Enu>{0, 0, z};
    const auto hit = land.first_hit(from, way, 3000);
    // The diagonal of a cell is the longest chord.
    const double near = std::min(radius, std::abs(off));
    const double error_m = spacing_m * spacing_m * 2 / (8 * std::max(near, radius / 2)) + 1e-4;
    if (std::abs(off) > radius + error_m) {
      EXPECT_TRUE(!hit || hit->at_edge) << ray;
    } else if (std::abs(off) < radius - error_m && std::abs(off) + 990 < 1300) {
      ASSERT_TRUE(hit.has_value()) << ray;
      if (hit->at_edge) continue;
      const Vec<Enu> at = from + hit->distance * way;
      EXPECT_NEAR(std::hypot(at.x, at.y), radius, 1.5 * error_m) << ray;
    }
  }
}

// Expected: between crests of a sinusoid the lowest clear ray is tangent to the near crest; facets
// lower crests by at most A (k s)^2 / 8.
TEST(HeightField, SinusoidHidesBehindItsCrests) {
  const double amplitude_m = 40, wave_m = 800, spacing_m = 5;
  const double k = 2 * std::numbers::pi / wave_m;
  const HeightField land =
      field_of(grid_of([&](double x, double) { return amplitude_m * std::cos(k * x); }, -4000, -50,
                       spacing_m, 1600, 20));
  const double sag_m = amplitude_m * k * k * spacing_m * spacing_m / 8 + 1e-5;
  std::mt19937_64 random(8);
  int hidden = 0, clear = 0;
  for (int ray = 0; ray < 20000; ++ray) {
    const Vec<Enu> from{uniform(random, -3900, 3900), uniform(random, -49, 49),
                        uniform(random, 41, 300)};
    const Vec<Enu> to{uniform(random, -3900, 3900), uniform(random, -49, 49),
                      uniform(random, 41, 300)};
    // Crests are at 40 m: a ray between two points above them is clear.
    EXPECT_FALSE(land.hidden(from, to - from, 1));
    ++clear;
    const Vec<Enu> low{to.x, to.y, amplitude_m - sag_m - uniform(random, 0.1, 20)};
    const Vec<Enu> way = low - from;
    // Crests between the two: the ray is hidden if it passes one below its lowered height.
    bool expected = low.z < amplitude_m * std::cos(k * low.x) - sag_m;
    for (int crest = -4; crest <= 4; ++crest) {
      const double t = (crest * wave_m - from.x) / way.x;
      expected = expected || (t > 0 && t < 1 && from.z + t * way.z < amplitude_m - sag_m);
    }
    if (!expected) continue;
    ++hidden;
    EXPECT_TRUE(land.hidden(from, way, 1)) << ray;
  }
  EXPECT_GT(hidden, 5000);
}

// Rationale: curvature is part of the heights. Expected: the horizon of a sphere without
// refraction, cos dip = R / (R + h), within 2e-5 rad. Source: closed form.
TEST(HeightField, HorizonOfASphere) {
  constexpr double kRadius = 6371000;
  struct Case {
    double height_m, spacing_m, half_m;
  };
  for (const Case& c : {Case{2, 25, 12000}, Case{10, 25, 20000}, Case{200, 125, 80000},
                        Case{3000, 500, 300000}, Case{30000, 1000, 750000}}) {
    const auto cells = static_cast<std::uint32_t>(2 * c.half_m / c.spacing_m);
    const HeightField land = field_of(grid_of(
        [&](double x, double y) { return std::sqrt(kRadius * kRadius - x * x - y * y) - kRadius; },
        -c.half_m, -c.half_m, c.spacing_m, cells, cells));
    const double dip = std::acos(kRadius / (kRadius + c.height_m));
    for (int azimuth = 0; azimuth < 24; ++azimuth) {
      const double a = azimuth * std::numbers::pi / 12 + 0.01;
      const auto met = [&](double below) {
        const Vec<Enu> way{std::cos(below) * std::cos(a), std::cos(below) * std::sin(a),
                           -std::sin(below)};
        return land.hidden({0.5, 0.25, c.height_m}, way, 2e6);
      };
      EXPECT_FALSE(met(dip - 2e-5)) << c.height_m << " m, azimuth " << a;
      EXPECT_TRUE(met(dip + 2e-5)) << c.height_m << " m, azimuth " << a;
    }
  }
}

TEST(HeightField, RefusesGridsThatAreNone) {
  const HeightGrid good = grid_of([](double, double) { return 1; }, 0, 0, 10, 4, 3);
  const auto refused = [](HeightGrid grid, std::optional<HeightGrid> inset = std::nullopt) {
    return std::string(HeightField::create(std::move(grid), std::move(inset)).status().message());
  };
  EXPECT_EQ(refused(good), "");
  HeightGrid bad = good;
  bad.columns = 0;
  EXPECT_NE(refused(bad), "");
  bad = good;
  bad.columns = bad.rows = 0xffffffffU;
  EXPECT_NE(refused(bad).find("limit"), std::string::npos);
  bad = good;
  bad.z_m.pop_back();
  EXPECT_EQ(refused(bad), "19 heights for 20 vertices");
  for (const float z : {std::nanf(""), HUGE_VALF, -HUGE_VALF}) {
    bad = good;
    z_at(bad, 2, 2) = z;
    EXPECT_NE(refused(bad).find("a height of"), std::string::npos);
  }
  for (const double spacing : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    bad = good;
    bad.spacing_m = spacing;
    EXPECT_NE(refused(bad).find("spacing"), std::string::npos);
  }
  const auto inset = [](double west, double spacing, std::uint32_t columns) {
    return grid_of([](double, double) { return 1; }, west, 10, spacing, columns, 2 * columns);
  };
  EXPECT_EQ(refused(good, inset(20, 5, 2)), "");
  EXPECT_NE(refused(good, inset(21, 5, 2)).find("multiples of 10 m"), std::string::npos);
  EXPECT_NE(refused(good, inset(20, 4, 2)).find("multiple of the inset's"), std::string::npos);
  EXPECT_NE(refused(good, inset(20, 5, 3)).find("between vertices"), std::string::npos);
  EXPECT_NE(refused(good, inset(30, 5, 4)).find("beyond the map"), std::string::npos);
  EXPECT_NE(refused(good, inset(-1e7, 5, 2)).find("beyond the map"), std::string::npos);
}

TEST(HeightField, StatesItsMemory) {
  const HeightField land =
      field_of(grid_of([](double, double) { return 1; }, 0, 0, 10, 1000, 1000));
  EXPECT_LT(double(land.memory_bytes()), 4.9e6);
  EXPECT_GT(double(land.memory_bytes()), 4.7e6);
}

}  // namespace
}  // namespace irsig
