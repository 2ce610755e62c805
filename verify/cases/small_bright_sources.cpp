#include "verify/cases/small_bright_sources.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "verify/cases/bodies.h"

namespace irsig {
namespace {

constexpr double kPlateHalfM = 2, kHotK = 1200, kColdK = 290;

Mesh whole_plate() {
  return rectangle({0, 0, 0}, {0, kPlateHalfM, 0}, {0, 0, kPlateHalfM}, "plate");
}

// A plate 2 m in front, of squares; those whose middles lie within a square of side_m are left out.
Mesh fine_wall(double side_m, double square_m) {
  Mesh mesh;
  mesh.group = {"plate"};
  const int count = static_cast<int>(std::lround(2 * kPlateHalfM / square_m));
  const auto corner = [&](int i, int j) { return static_cast<std::uint32_t>(i * (count + 1) + j); };
  const auto at = [&](double i) { return -kPlateHalfM + i * 2 * kPlateHalfM / count; };
  for (int i = 0; i <= count; ++i)
    for (int j = 0; j <= count; ++j) mesh.vertex.push_back({2, at(i), at(j)});
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < count; ++j) {
      if (std::abs(at(i + 0.5)) < 0.5 * side_m && std::abs(at(j + 0.5)) < 0.5 * side_m) continue;
      mesh.triangle.push_back({corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)});
      mesh.triangle.push_back({corner(i, j), corner(i + 1, j + 1), corner(i, j + 1)});
      mesh.triangle_group.insert(mesh.triangle_group.end(), 2, 0);
    }
  return mesh;
}

MaterialSpec mirror(double slope, bool metal) {
  CookTorrance m;
  const double n = metal ? 8 : 1.5, k = metal ? 40 : 0;
  m.constants = {{2, n, k}, {15, n, k}};
  m.roughness = slope;
  m.masking = Masking::kSmith;
  return {"mirror", m};
}

Vec<Body> sun() { return body_from_aspect(20, 45); }
Vec<Body> eye() { return body_from_aspect(0, 5); }

RareLightScene rare_scene_of(std::string name, Mesh mesh, std::vector<MaterialSpec> material,
                             std::vector<PartSpec> part, bool in_the_sun) {
  RareLightScene out;
  out.name = std::move(name);
  out.scene.mesh = std::move(mesh);
  out.scene.material = std::move(material);
  out.scene.band = {{"MWIR", 3.5, 4.1, 0.2, {}}};
  ViewRequest& r = out.request;
  r.viewpoint = {0, 5, 1000};
  ConditionSpec c;
  for (const PartSpec& p : part) c.part_temperature_k.push_back(p.hot ? kHotK : kColdK);
  out.scene.part = std::move(part);
  c.surroundings.sky_temperature_k = 220;
  if (in_the_sun) put_sun(c, sun());
  r.condition = {c};
  r.selected_condition = {0};
  r.selected_band = {0};
  r.max_reflections = 16;
  r.accuracy.relative_error = 0.01;
  return out;
}

}  // namespace

RareLightScene plain_plate(bool in_the_sun, double square_m) {
  const Mesh mesh = square_m > 0 ? fine_wall(0, square_m) : whole_plate();
  return rare_scene_of(
      absl::StrCat("plate", in_the_sun ? " in the sun" : "", square_m > 0 ? " of squares" : ""),
      mesh, {grey_paint(0.9)}, {{"plate", {}, 0, true, false}}, in_the_sun);
}

RareLightScene hot_behind_hole(double side_m) {
  const double inner = 0.5 * side_m, middle = 0.5 * (kPlateHalfM + inner),
               wide = 0.5 * (kPlateHalfM - inner);
  const auto piece = [&](double y, double z, double hy, double hz) {
    return rectangle({2, y, z}, {0, hy, 0}, {0, 0, hz}, "plate");
  };
  Mesh mesh =
      joined(piece(0, -middle, kPlateHalfM, wide), piece(0, middle, kPlateHalfM, wide), "b/");
  mesh = joined(mesh, piece(-middle, 0, wide, inner), "c/");
  mesh = joined(mesh, piece(middle, 0, wide, inner), "d/");
  mesh = joined(mesh, rectangle({1.5, 0, 0}, {0, 1, 0}, {0, 0, 1}, "hot"), "e/");
  return rare_scene_of(
      absl::StrCat("hole of ", 100 * side_m, " cm"), mesh, {grey_paint(0.9)},
      {{"plate", {"plate", "*/plate"}, 0, true, false}, {"hot", {"*/hot"}, 0, true, true}}, false);
}

RareLightScene hot_behind_fine_wall(double side_m, double square_m) {
  const Mesh mesh = joined(fine_wall(side_m, square_m),
                           rectangle({1.5, 0, 0}, {0, 1, 0}, {0, 0, 1}, "hot"), "e/");
  return rare_scene_of(absl::StrCat("hole of ", 100 * side_m, " cm in a wall of ",
                                    mesh.triangle.size() - 2, " triangles"),
                       mesh, {grey_paint(0.9)},
                       {{"plate", {"plate"}, 0, true, false}, {"hot", {"e/hot"}, 0, true, true}},
                       false);
}

RareLightScene small_mirror(double side_m, double slope, bool metal) {
  return rare_scene_of(
      absl::StrCat(metal ? "metal" : "glass", " mirror of ", 100 * side_m, " cm, slope ", slope),
      joined(whole_plate(), square({0.5, 0.3, 0.2}, sun() + eye(), 0.5 * side_m, "mirror"), "m/"),
      {grey_paint(0.9), mirror(slope, metal)},
      {{"plate", {"plate"}, 0, true, false}, {"mirror", {"m/mirror"}, 1, true, false}}, true);
}

RareLightScene mirror_pair(double side_m, double slope, bool metal) {
  const Vec<Body> first{0.6, 0.5, -1.2}, second{0.6, -0.4, 0.3},
      between = normalized(second - first);
  Mesh mesh = joined(whole_plate(), square(first, sun() + between, 0.5 * side_m, "first"), "m/");
  mesh = joined(mesh, square(second, eye() - between, 0.5 * side_m, "second"), "n/");
  return rare_scene_of(absl::StrCat("two ", metal ? "metal" : "glass", " mirrors of ", 100 * side_m,
                                    " cm, slope ", slope),
                       mesh, {grey_paint(0.9), mirror(slope, metal)},
                       {{"plate", {"plate"}, 0, true, false},
                        {"first", {"*first"}, 1, true, false},
                        {"second", {"*second"}, 1, true, false}},
                       true);
}

std::vector<SmallBrightSourcePair> small_bright_source_scenes() {
  const RareLightScene matt = plain_plate(false), sunlit = plain_plate(true);
  return {{hot_behind_hole(0.4), matt},
          {hot_behind_hole(0.06), matt},
          {hot_behind_hole(0.01), matt},
          {hot_behind_fine_wall(0.08, 0.04), plain_plate(false, 0.04)},
          {small_mirror(0.05, 0.003, false), sunlit},
          {small_mirror(0.05, 0.02, true), sunlit},
          {small_mirror(0.005, 0.02, true), sunlit},
          {mirror_pair(0.1, 0.02, false), sunlit},
          {mirror_pair(0.1, 0.02, true), sunlit},
          {mirror_pair(0.4, 0.02, true), sunlit}};
}

}  // namespace irsig
