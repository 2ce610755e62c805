#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/generate/generate_mesh.h"
#include "core/signature/simulator.h"
#include "core/sources/source_geometry.h"

namespace irsig::fixture {

inline MaterialSpec grey(double emissivity) { return {"grey", Lambert{{{0, emissivity}}}}; }
inline Band lwir() { return {"LWIR", 8, 12, 0.5, {}}; }
inline Band mwir() { return {"MWIR", 3, 5, 0.25, {}}; }

// One generated body of one material.
inline SceneSpec scene_of(const Mesh& mesh, MaterialSpec material, Band band) {
  SceneSpec scene;
  scene.mesh = mesh;
  scene.material = {std::move(material)};
  scene.part = {{"body", {"*"}, 0, false, false}};
  scene.band = {std::move(band)};
  return scene;
}

inline Mesh generated(const std::string& kind, std::uint64_t triangles, double radius_m = 0,
                      double length_m = 0, double width_m = 0, double height_m = 0) {
  auto mesh = generate_mesh({kind, triangles, radius_m, length_m, width_m, height_m});
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  return *std::move(mesh);
}

// Appends b to a, its groups prefixed.
inline Mesh joined(Mesh a, const Mesh& b, const std::string& prefix) {
  const auto base = static_cast<std::uint32_t>(a.vertex.size());
  const auto groups = static_cast<std::uint32_t>(a.group.size());
  a.vertex.insert(a.vertex.end(), b.vertex.begin(), b.vertex.end());
  for (const auto& t : b.triangle) a.triangle.push_back({base + t[0], base + t[1], base + t[2]});
  for (const auto g : b.triangle_group) a.triangle_group.push_back(groups + g);
  for (const auto& g : b.group) a.group.push_back(prefix + g);
  return a;
}

inline Mesh moved(Mesh mesh, Vec<Body> by, Vec<Body> scale = {1, 1, 1}) {
  for (auto& v : mesh.vertex) v = Vec<Body>{v.x * scale.x, v.y * scale.y, v.z * scale.z} + by;
  return mesh;
}

// A dark world without sun, air or reflections.
inline ViewRequest request(const Simulator& simulator, double azimuth_deg, double elevation_deg,
                           double range_m, std::vector<double> part_temperature_k) {
  ViewRequest r;
  r.viewpoint = {azimuth_deg, elevation_deg, range_m};
  ConditionSpec condition;
  condition.part_temperature_k = std::move(part_temperature_k);
  r.condition = {condition};
  r.selected_condition = {0};
  for (std::uint32_t b = 0; b < simulator.band_grids().size(); ++b) r.selected_band.push_back(b);
  r.accuracy.samples_per_replicate = 1u << 14;
  r.max_reflections = 0;
  return r;
}

// A frigate of the hull's paint with hot funnels, in both bands.
inline SceneSpec painted_frigate() {
  SceneSpec scene;
  scene.mesh = generated("frigate", 2000);
  scene.material = {*builtin_material("hull")};
  scene.part = {{"hot", {"funnel*"}, 0, false, true}, {"ship", {}, 0, false, false, true}};
  scene.band = {mwir(), lwir()};
  return scene;
}

// The sun over the ship's starboard bow, sky and sea.
inline void make_day(ConditionSpec& condition) {
  condition.surroundings = {SurroundingsKind::kSea, 240, 0, 290, 0.96, 0};
  condition.sun = true;
  condition.sun_direction = normalized(Vec<Body>{0.3, 0.5, -0.8});
  condition.sun_cos_zenith = 0.8 / std::sqrt(0.98);
  condition.sun_angular_radius_deg = 0.266;
  condition.sun_scale = 0.6;
}

inline std::unique_ptr<Simulator> simulator_of(const SceneSpec& scene) {
  auto simulator = Simulator::create(scene);
  EXPECT_TRUE(simulator.ok()) << simulator.status();
  return *std::move(simulator);
}

// Nothing around the target but these suns.
inline SourceGeometry lit_by(std::vector<SunDirection> suns) {
  SourceGeometry out;
  out.sun = std::move(suns);
  return out;
}

inline SignatureResult only_row(const Simulator& simulator, const ViewRequest& r) {
  const auto view = simulator.simulate(r);
  EXPECT_TRUE(view.ok()) << view.status();
  return view->row.front();
}

// |t| within the bound for `rows` rows, at a standard error of at most max_relative_stderr.
inline void expect_within_t(const Estimate& e, double expected, std::uint64_t rows,
                            const std::string& what, double max_relative_stderr = 1e-3,
                            double model_error = 0) {
  const double t = (std::abs(e.value - expected) - std::abs(model_error)) / e.stderr_;
  EXPECT_LT(t, student_t_bound(31, rows))
      << what << ": " << e.value << " +- " << e.stderr_ << ", expected " << expected;
  EXPECT_LE(e.stderr_, max_relative_stderr * std::abs(expected)) << what;
  std::printf("%-44s %16.9g +- %9.3g  expected %16.9g  t %6.2f\n", what.c_str(), e.value, e.stderr_,
              expected, (e.value - expected) / e.stderr_);
}

}  // namespace irsig::fixture
