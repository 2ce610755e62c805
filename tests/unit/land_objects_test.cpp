// Rationale: objects on land decide what a sensor sees of the target and its surroundings, at any
// distance from the target. Expected: hits of a box by its closed form; lit walls without spots of
// shadow; the nearest of many objects. Source: slabs in double, brute force.
#include "core/land/objects/land_objects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/base/constants.h"
#include "core/land/objects/object_places.h"
#include "core/land/objects/read_places.h"
#include "core/scene/generate/generate_mesh.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

HeightField plain(double half_m = 50'000, double slope = 0) {
  HeightGrid grid{-half_m, -half_m, half_m / 10, 20, 20, {}};
  for (int row = 0; row <= 20; ++row)
    for (int column = 0; column <= 20; ++column)
      grid.z_m.push_back(static_cast<float>(slope * (grid.west_m + column * grid.spacing_m)));
  auto field = HeightField::create(std::move(grid));
  EXPECT_TRUE(field.ok()) << field.status();
  return *std::move(field);
}

Mesh body(const std::string& kind, std::uint64_t triangles) {
  auto mesh = generate_mesh({kind, triangles, kind == "box" ? 0.0 : 3.0, kind == "box" ? 8.0 : 0.0,
                             kind == "box" ? 6.0 : 0.0, kind == "box" ? 5.0 : 0.0});
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  return *std::move(mesh);
}

ObjectModel model_of(Mesh mesh, std::vector<ObjectPlace> place) {
  ObjectModel out;
  out.key = "land.object[0]";
  out.mesh = std::move(mesh);
  out.material.assign(out.mesh.group.size(), 3);
  out.place = std::move(place);
  return out;
}

LandObjects objects_of(std::vector<ObjectModel> models, const HeightField& field) {
  auto out = LandObjects::create(std::move(models), field);
  EXPECT_TRUE(out.ok()) << out.status();
  return *std::move(out);
}

// The first crossing of a ray with a box of 8 m x 6 m x 5 m on the plane z = 0, turned by a
// heading; margin: how far the ray passes from its edges, at least.
struct BoxCrossing {
  std::optional<double> distance;
  double margin_m = 1e9;
};
BoxCrossing cross_box(const ObjectPlace& place, Vec<Enu> origin, Vec<Enu> direction) {
  const double c = std::cos(place.heading_deg * kRadPerDeg),
               s = std::sin(place.heading_deg * kRadPerDeg);
  const double x = origin.x - place.x_m, y = origin.y - place.y_m;
  const double o[] = {x * s + y * c, x * c - y * s, origin.z - 2.5 * place.scale};
  const double d[] = {direction.x * s + direction.y * c, direction.x * c - direction.y * s,
                      direction.z};
  const double half[] = {4 * place.scale, 3 * place.scale, 2.5 * place.scale};
  double from = 0, to = 1e9;
  for (int k = 0; k < 3; ++k) {
    const double a = (-half[k] - o[k]) / d[k], b = (half[k] - o[k]) / d[k];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  BoxCrossing out;
  out.margin_m = std::abs(to - from);
  if (from < to) out.distance = from;
  return out;
}

TEST(LandObjects, ABoxIsMetByItsClosedFormAtAnyDistance) {
  const HeightField field = plain();
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const double away_m : {20.0, 1000.0, 10'000.0, 40'000.0}) {
    const ObjectPlace place{0.6 * away_m, -0.8 * away_m, 37, 1.5, 0};
    const LandObjects objects = objects_of({model_of(body("box", 12), {place})}, field);
    int met = 0;
    double worst_m = 0;
    for (int i = 0; i < 20'000; ++i) {
      // Rays begin in the target's surroundings and close by.
      const Vec<Enu> goal{place.x_m + 9 * uniform(random), place.y_m + 9 * uniform(random),
                          5 + 5 * uniform(random)};
      const Vec<Enu> origin =
          i % 2 == 0 ? Vec<Enu>{5 * uniform(random), 5 * uniform(random), 8 + uniform(random)}
                     : goal + Vec<Enu>{60 * uniform(random), 60 * uniform(random), 30};
      const Vec<Enu> direction = (0.2 + 0.1 * uniform(random)) * (goal - origin);
      const BoxCrossing expected = cross_box(place, origin, direction);
      const double margin_m = expected.margin_m * length(direction);
      const auto hit = objects.first_hit(origin, direction, 1e9);
      if (margin_m > 1e-4) {
        ASSERT_EQ(hit.has_value(), expected.distance.has_value()) << away_m << " " << i;
        EXPECT_EQ(objects.hidden(origin, direction, 1e9), hit.has_value());
      }
      if (!hit || !expected.distance) continue;
      ++met;
      const double cosine = std::abs(dot(hit->normal, direction)) / length(direction);
      worst_m = std::max(worst_m,
                         std::abs(hit->distance - *expected.distance) * length(direction) * cosine);
      EXPECT_EQ(hit->material, 3u);
      EXPECT_LT(dot(hit->normal, direction), 0);
      // A ray that ends before the object does not meet it.
      EXPECT_FALSE(objects.first_hit(origin, direction, 0.999 * hit->distance).has_value());
      EXPECT_FALSE(objects.hidden(origin, direction, 0.999 * hit->distance));
    }
    EXPECT_GT(met, 3000);
    // 2^-20 of a radius of 8.4 m.
    EXPECT_LT(worst_m, 8e-6) << away_m;
    std::printf("%.0f m away: %d hits, distance from the plane of a face at most %.2g m\n", away_m,
                met, worst_m);
  }
}

// A place in the light has no shadow of its own object, however far away that stands.
TEST(LandObjects, LitWallsHaveNoSpotsOfShadow) {
  const HeightField field = plain();
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Vec<Enu> sun = normalized(Vec<Enu>{0.5, -0.4, 0.7});
  for (const char* kind : {"box", "sphere"})
    for (const double away_m : {10.0, 10'000.0, 40'000.0}) {
      const ObjectPlace place{-0.8 * away_m, 0.6 * away_m, 20, 1, 0};
      const LandObjects objects = objects_of({model_of(body(kind, 2000), {place})}, field);
      int lit = 0, spots = 0, dark = 0, leaks = 0;
      for (int i = 0; i < 20'000; ++i) {
        const Vec<Enu> goal =
            objects.middle_m(0) + 2.0 * Vec<Enu>{uniform(random), uniform(random), uniform(random)};
        const Vec<Enu> origin =
            goal + 300.0 * normalized(Vec<Enu>{uniform(random), uniform(random), 1.1});
        const auto hit = objects.first_hit(origin, goal - origin, 1e9);
        if (!hit) continue;
        const bool hidden = objects.hidden(hit->departure_m, sun, 1e9);
        if (dot(hit->normal, sun) > 1e-3) {
          ++lit;
          spots += hidden ? 1 : 0;
        } else if (dot(hit->normal, sun) < -1e-3) {
          // Beside the terminator a departure sees past the edge of its own facet.
          ++dark;
          leaks += hidden ? 0 : 1;
        }
      }
      EXPECT_GT(lit, 5000);
      EXPECT_EQ(spots, 0) << kind << away_m;
      EXPECT_GT(dark, 500);
      EXPECT_LT(leaks, 0.02 * dark) << kind << away_m;
    }
}

// Two meshes at 400 places, against each object alone.
TEST(LandObjects, TheNearestOfManyIsMet) {
  const HeightField field = plain(5000);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<ObjectModel> models{model_of(body("box", 12), {}), model_of(body("cone", 40), {})};
  std::vector<LandObjects> alone;
  for (ObjectModel& model : models)
    for (int i = 0; i < 200; ++i) {
      model.place.push_back({200 * uniform(random), 200 * uniform(random), 180 * uniform(random),
                             1 + 0.5 * uniform(random), 0});
      ObjectModel one = model;
      one.place = {model.place.back()};
      alone.push_back(objects_of({one}, field));
    }
  const LandObjects all = objects_of(models, field);
  EXPECT_EQ(all.count(), 400u);
  int met = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec<Enu> origin{300 * uniform(random), 300 * uniform(random),
                          5 * std::abs(uniform(random))};
    const Vec<Enu> direction{uniform(random), uniform(random), 0.01 * uniform(random)};
    double nearest = 1e9;
    for (const LandObjects& one : alone)
      if (const auto hit = one.first_hit(origin, direction, 1e9))
        nearest = std::min(nearest, hit->distance);
    const auto hit = all.first_hit(origin, direction, 1e9);
    ASSERT_EQ(hit.has_value(), nearest < 1e9);
    EXPECT_EQ(all.hidden(origin, direction, 1e9), hit.has_value());
    if (!hit) continue;
    ++met;
    EXPECT_EQ(hit->distance, nearest);
  }
  EXPECT_GT(met, 100);
}

// A bent ray is straight above objects that are raised by the bend where they stand.
TEST(LandObjects, BentRaysMeetRaisedObjects) {
  const HeightField field = plain();
  constexpr double kBendPerM = 1e-8;
  std::vector<ObjectPlace> place;
  for (int i = 0; i < 200; ++i)
    place.push_back({150.0 * i, 90 * std::sin(1.7 * i), 20.0 * i, 1, 0});
  const LandObjects objects = objects_of({model_of(body("box", 12), place)}, field);
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int met = 0, differ = 0;
  for (int i = 0; i < 5000; ++i) {
    const auto& at = place[static_cast<std::size_t>(i) % place.size()];
    const double raised_m = kBendPerM * (at.x_m * at.x_m + at.y_m * at.y_m);
    const Vec<Enu> goal{at.x_m + 6 * uniform(random), at.y_m + 6 * uniform(random),
                        raised_m + 2.5 + 4 * uniform(random)};
    const Vec<Enu> direction{uniform(random), uniform(random), -0.5};
    const Vec<Enu> origin = goal - 30.0 * direction;
    const Vec<Enu> lower{origin.x, origin.y, origin.z - raised_m};
    const auto bent = objects.first_hit(origin, direction, 1e9, kBendPerM),
               straight = objects.first_hit(lower, direction, 1e9);
    // A ray past an edge may differ: across an object the bend is not its middle's.
    if (bent.has_value() != straight.has_value()) {
      ++differ;
      continue;
    }
    EXPECT_EQ(objects.hidden(origin, direction, 1e9, kBendPerM), bent.has_value());
    if (!bent) continue;
    ++met;
    EXPECT_NEAR(bent->distance, straight->distance, 1e-3);
    EXPECT_NEAR(bent->departure_m.z, straight->departure_m.z + raised_m, 1e-3);
  }
  EXPECT_GT(met, 2000);
  EXPECT_LT(differ, 20);
}

TEST(LandObjects, StandOnTheLowestLandBelowTheirBase) {
  const HeightField field = plain(5000, 0.1);
  ObjectModel model = model_of(body("box", 12), {{100, 50, 90, 1, 0}, {-200, 0, 0, 2, 0}});
  model.sink_m = 0.25;
  const LandObjects objects = objects_of({std::move(model)}, field);
  // Forward is east: the western edge is 4 m, of the second object 2 x 3 m to the west.
  EXPECT_NEAR(objects.middle_m(0).z, 0.1 * (100 - 4) - 0.25 + 2.5, 1e-5);
  EXPECT_NEAR(objects.middle_m(1).z, 0.1 * (-200 - 6) - 0.25 + 5, 1e-5);
  EXPECT_NEAR(objects.highest_m(90, 110, 40, 60), 0.1 * 96 - 0.25 + 5, 1e-3);
  EXPECT_EQ(objects.highest_m(200, 210, 40, 60), -INFINITY);
  // A crown wider than its trunk does not lower it: the base is the trunk.
  Mesh tree = body("box", 12);
  for (Vec<Body>& v : tree.vertex)
    if (v.z > 0) v = {0.1 * v.x, 0.1 * v.y, v.z};
  EXPECT_NEAR(base_of(tree).front_m, 0.4, 1e-9);
  EXPECT_NEAR(base_of(tree).starboard_m, 0.3, 1e-9);
}

TEST(LandObjects, KnowWhatTheyEnclose) {
  const HeightField field = plain();
  ObjectModel inside = model_of(body("box", 300), {{0, 0, 0, 1, 0}, {40'000, 0, 45, 1, 0}});
  ObjectModel listed = model_of(body("sphere", 300), {{100, 0, 0, 1, 17}});
  listed.key = "land.object[1]";
  listed.from = PlacesFrom::kFile;
  listed.place_file = "trees.csv";
  const LandObjects objects = objects_of({std::move(inside), std::move(listed)}, field);
  EXPECT_EQ(objects.around({0, 0, 2})->key, "land.object[0].place[0]");
  EXPECT_EQ(objects.around({40'002, 1, 4.9})->key, "land.object[0].place[1]");
  EXPECT_EQ(objects.around({100, 0, 3})->key, "land.object[1].places_file");
  EXPECT_EQ(objects.around({100, 0, 3})->text, "trees.csv:17:1: ");
  EXPECT_FALSE(objects.around({0, 0, 5.1}).has_value());
  EXPECT_FALSE(objects.around({0, 0, -1}).has_value());
  EXPECT_FALSE(objects.around({102.5, 0, 5.5}).has_value());  // in the box of the sphere
}

TEST(LandObjects, RefuseWhatCannotStand) {
  const HeightField field = plain(1000);
  const auto refused = [&](std::vector<ObjectPlace> place, std::uint32_t from_file = 0) {
    ObjectModel model = model_of(body("box", 12), std::move(place));
    if (from_file > 0) {
      model.from = PlacesFrom::kFile;
      model.place_file = "houses.csv";
    }
    return std::string(LandObjects::create({std::move(model)}, field).status().message());
  };
  EXPECT_THAT(refused({{0, 0, 0, 1, 0}, {999, 0, 0, 1, 0}}),
              HasSubstr("land.object[0].place[1]: the object at east_m = 999, north_m = 0 stands "
                        "beyond the map of heights; move it, or use a larger map"));
  EXPECT_THAT(refused({{0, -2000, 0, 1, 5}}, 1),
              HasSubstr("land.object[0].places_file: houses.csv:5:1: the object at"));
  EXPECT_THAT(refused({{0, 0, 0, 0, 0}}),
              HasSubstr("land.object[0].place[0]: scale = 0, expected a number above 0"));
  EXPECT_THAT(refused(std::vector<ObjectPlace>(kMostLandObjects + 1)),
              HasSubstr("land.object[0]: there are more than 1000000 objects"));
}

TEST(LandObjects, PlacesAreReadFromAFile) {
  const auto places = read_places(
      "# east of the river\nnorth_m, heading_deg,east_m\n10,90,-20.5\n\n-3e3,0,4\n", "p.csv", 1.5);
  ASSERT_TRUE(places.ok()) << places.status();
  ASSERT_EQ(places->size(), 2u);
  EXPECT_EQ(places->at(0).x_m, -20.5);
  EXPECT_EQ(places->at(0).y_m, 10);
  EXPECT_EQ(places->at(0).heading_deg, 90);
  EXPECT_EQ(places->at(0).scale, 1.5);
  EXPECT_EQ(places->at(0).line, 3u);
  EXPECT_EQ(places->at(1).y_m, -3000);
  EXPECT_EQ(places->at(1).line, 5u);
  const std::pair<const char*, const char*> wrong[] = {
      {"", "p.csv:1:1: the file is empty, expected a line east_m,north_m and a line for each"},
      {"east_m,north_m\n", "p.csv:2:1: the file has no places"},
      {"east_m,heading\n1,2\n",
       "p.csv:1:8: column \"heading\" is unknown, expected east_m, north_m, heading_deg or scale"},
      {"east_m,scale\n1,2\n", "p.csv:1:1: column north_m is missing"},
      {"east_m,north_m,east_m\n1,2,3\n", "p.csv:1:16: column east_m stands twice"},
      {"east_m,north_m\n1,2,3\n", "p.csv:2:1: the line has 3 cells, expected 2"},
      {"east_m,north_m\n1,2\n1,x\n", "p.csv:3:3: north_m = \"x\", expected a number from -4"},
      {"east_m,north_m,scale\n1,2,0\n", "p.csv:2:5: scale = \"0\", expected a number from 0.001"},
      {"east_m,north_m,heading_deg\n1,2,400\n", "p.csv:2:5: heading_deg = \"400\", expected"},
      {"east_m,north_m\n1e6,2\n", "p.csv:2:1: east_m = \"1e6\", expected a number from"}};
  for (const auto& [text, expected] : wrong)
    EXPECT_THAT(std::string(read_places(text, "p.csv", 1).status().message()), HasSubstr(expected));
}

TEST(LandObjects, AreScatteredOverTheirMaterial) {
  const HeightField field = plain(1000);
  // A forest in the east, with a fraction of 0.5 in the northeast.
  HeightRaster forest{LocalMetres{}, -1000, -1000, 20, 20, 101, 101, {}};
  for (int row = 0; row < 101; ++row)
    for (int column = 0; column < 101; ++column)
      forest.height_m.push_back(column <= 50 ? 0.0f : row > 50 ? 0.5f : 1.0f);
  const auto cover = LandCover::create(
      std::vector<CoverLayer>{{"bark", std::nullopt, true}, {"grass"}, {"forest", forest}}, field,
      {});
  ASSERT_TRUE(cover.ok()) << cover.status();
  ASSERT_EQ(cover->materials(), 3u);
  std::vector<float> fraction(3);
  cover->at(500, -500, fraction);
  EXPECT_THAT(fraction, ::testing::ElementsAre(0, 0, 1));
  cover->at(-500, -500, fraction);
  EXPECT_THAT(fraction, ::testing::ElementsAre(0, 1, 0));
  const Mesh tree = body("cone", 40);
  ObjectScatter how{4000, 7, 100, 800, 2, 1.2};
  const auto places = scatter_objects(how, base_of(tree), field, *cover);
  ASSERT_TRUE(places.ok()) << places.status();
  ASSERT_EQ(places->size(), 4000u);
  int north = 0;
  for (const ObjectPlace& place : *places) {
    EXPECT_GT(place.x_m, 9);
    EXPECT_GT(std::hypot(place.x_m, place.y_m), 99.9);
    EXPECT_LT(std::hypot(place.x_m, place.y_m), 800.1);
    EXPECT_EQ(place.scale, 1.2);
    north += place.y_m > 10 ? 1 : 0;
  }
  EXPECT_NEAR(north, 4000 / 3.0, 4 * std::sqrt(4000 * 2 / 9.0));
  const auto again = scatter_objects(how, base_of(tree), field, *cover);
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(again->back().x_m, places->back().x_m);
  how.seed = 8;
  EXPECT_NE(scatter_objects(how, base_of(tree), field, *cover)->back().x_m, places->back().x_m);
  how.material = 0;
  EXPECT_THAT(
      std::string(scatter_objects(how, base_of(tree), field, *cover).status().message()),
      HasSubstr("only 0 of 4000 places were found in 4000000 tries: little or nothing of the map"));
}

}  // namespace
}  // namespace irsig
