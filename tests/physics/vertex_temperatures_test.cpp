// Rationale: finite-element programs write temperatures of vertices, linear between them. A facet
// has the mean of its corners, so that a row is wrong where what hides it, or the curve of Planck's
// law, does not weigh all of the facet alike; temperature_bound_w_sr is to say by how much at most.
// Expected: the row of a coarse mesh lies within its bound of that of a mesh so fine that nothing
// is left, and the bound is not many times what is found where it can be much: strips that hide the
// warm half of every facet's square.
// Source: the same field on 32 x 32 squares instead of 2 x 2.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/fields/temperature_field.h"
#include "scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

constexpr double kHalf = 2;  // of the plate's side, m

double kelvin_at(double y) { return 300 + 6 * y; }

// A square in the plane x, seen from the bow, of cells x cells squares cut in two.
Mesh plate(const std::string& name, double x, double low_y, double high_y, int cells) {
  Mesh out;
  out.group = {name};
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= cells; ++j)
      out.vertex.push_back(
          {x, low_y + (high_y - low_y) * i / cells, -kHalf + 2 * kHalf * j / cells});
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (cells + 1) + j); };
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      out.triangle.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      out.triangle.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  out.triangle_group.assign(out.triangle.size(), 0);
  return out;
}

// Hidden: what of the warm (or the cold) half of each of two squares stands behind a strip.
enum class Hidden { kNothing, kWarmHalves, kColdHalves };

SignatureResult seen(int cells, Hidden hidden) {
  Mesh mesh = plate("plate", 0, -kHalf, kHalf, cells);
  const std::size_t of_plate = mesh.vertex.size();
  if (hidden != Hidden::kNothing)
    for (const double from : {-kHalf, 0.0}) {
      const double low = from + (hidden == Hidden::kWarmHalves ? 0.5 * kHalf : 0);
      mesh = joined(mesh, plate("strip", 0.5, low, low + 0.5 * kHalf, 1), from < 0 ? "a_" : "b_");
    }
  SceneSpec scene = scene_of(mesh, grey(1), mwir());
  scene.part = {{"plate", {"plate"}, 0, false, false}};
  if (hidden != Hidden::kNothing) scene.part.push_back({"strips", {"?_strip"}, 0, false, false});
  const auto simulator = simulator_of(scene);
  const Target& target = simulator->target();

  std::string csv = "vertex,temperature\n";
  for (std::size_t v = 0; v < of_plate; ++v)
    csv += std::to_string(v) + "," + std::to_string(kelvin_at(mesh.vertex[v].y)) + "\n";
  FieldMesh where;
  for (const auto& v : mesh.vertex) where.vertex.push_back({v.x, v.y, v.z});
  for (const auto& t : mesh.triangle) where.triangle.push_back({t[0], t[1], t[2]});
  const auto field = read_temperature_field(
      csv, {"t.csv", TemperatureUnit::kKelvin, FieldMatch::kIndex, 0, 0.0}, where);
  EXPECT_TRUE(field.ok()) << field.status();
  std::vector<std::uint32_t> part_of_facet;
  for (const Target::Facet& f : target.facet) part_of_facet.push_back(f.part);
  const ElementEmission emission =
      make_element_emission(part_of_facet, target.part.size(), {&field->at.front(), 1});

  ViewRequest r = request(*simulator, 0, 0, 1e6, std::vector<double>(target.part.size(), 250));
  r.emitters = std::make_shared<const Emitters>(emission.emitters);
  r.condition[0].emitter = std::make_shared<const EmitterTemperatures>(emission.condition[0]);
  return only_row(*simulator, r);
}

TEST(VertexTemperatures, ACoarseMeshIsWithinItsBoundOfAFineOne) {
  for (const Hidden hidden : {Hidden::kNothing, Hidden::kWarmHalves, Hidden::kColdHalves}) {
    const SignatureResult coarse = seen(2, hidden), fine = seen(32, hidden);
    const double value = fine.intensity_w_sr.value,
                 off = std::abs(coarse.intensity_w_sr.value - value),
                 noise = 4 * std::hypot(coarse.intensity_w_sr.stderr_, fine.intensity_w_sr.stderr_);
    std::printf("off %.4f %% noise %.4f %% bound %.4f %%, of the fine mesh %.4f %%\n",
                100 * off / value, 100 * noise / value, 100 * coarse.temperature_bound_w_sr / value,
                100 * fine.temperature_bound_w_sr / value);
    EXPECT_LE(off, coarse.temperature_bound_w_sr);
    // Facets are a sixteenth as large, and so is what their corners differ by.
    EXPECT_NEAR(fine.temperature_bound_w_sr / coarse.temperature_bound_w_sr, 1.0 / 16, 0.02);
    if (hidden == Hidden::kNothing) {
      EXPECT_LT(off, 0.1 * coarse.temperature_bound_w_sr) << "means of whole facets";
    } else {
      EXPECT_GT(off, 10 * noise);
      EXPECT_GT(off, 0.15 * coarse.temperature_bound_w_sr) << "the bound is no multiple of it";
    }
  }
}

}  // namespace
}  // namespace irsig
