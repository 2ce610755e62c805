// Rationale: many reflections with Russian roulette must be unbiased at every order: the effective
// emissivity of diffuse isothermal cavities is known for any number of reflections.
// Expected: |t| within the bound of docs/explanation/methods.md for the number of rows of this
// file, at a standard error <= 1.6e-4 in effective emissivity (long form: 16 times the samples, <=
// 4e-5); the truncation bound covers what was cut off.
// Source: tests/physics/values/spherical_cavity.csv (closed form) and cylindrical_cavity.csv
// (integral equation).
// Geometry: facets of 2 pi / 1024 rad. Regular polygons are widened to the circle's area; what is
// left of form factors is of the order of (pi / 1024)^2 = 1e-5, allowed for by 1e-5 below.
#include <fstream>
#include <numbers>
#include <sstream>

#include "core/transport/path_tracer.h"
#include "tests/long_form.h"
#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;
constexpr double kPi = std::numbers::pi;
constexpr std::uint64_t kRows = 48;
constexpr double kFacets = 1e-5;
constexpr int kSectors = 1024;

// A surface of revolution about x, seen from the axis: rings of radius r at x.
struct Ring {
  double x, r;
};
Mesh revolved(const std::vector<Ring>& rings) {
  Mesh mesh;
  mesh.group = {"wall"};
  const double widen = std::sqrt((2 * kPi / kSectors) / std::sin(2 * kPi / kSectors));
  for (const Ring& ring : rings)
    for (int s = 0; s < kSectors; ++s) {
      const double phi = 2 * kPi * s / kSectors;
      mesh.vertex.push_back(
          {ring.x, widen * ring.r * std::cos(phi), widen * ring.r * std::sin(phi)});
    }
  for (std::uint32_t ring = 0; ring + 1 < rings.size(); ++ring)
    for (std::uint32_t s = 0; s < kSectors; ++s) {
      const std::uint32_t a = ring * kSectors + s, b = ring * kSectors + (s + 1) % kSectors,
                          c = a + kSectors, d = b + kSectors;
      if (rings[ring].r > 0) mesh.triangle.push_back({a, b, c});  // facing inwards
      if (rings[ring + 1].r > 0) mesh.triangle.push_back({b, d, c});
    }
  mesh.triangle_group.assign(mesh.triangle.size(), 0);
  return mesh;
}

// Effective emissivity after 0 .. max_reflections reflections of the wall that is seen along the
// axis from afar, in each replicate, and the throughput that is left.
struct Orders {
  std::vector<Estimate> effective;
  double truncated = 0;
};
Orders trace(const Simulator& simulator, std::uint32_t max_reflections, std::uint64_t samples,
             double field_m) {
  const Target& target = simulator.target();
  const Vec<Body> sensor{1e5, 0, 0};
  const FootprintView footprint = make_footprint_view(target, sensor, {0, 0, 0}, field_m, field_m);
  PathSettings settings;
  settings.max_reflections = max_reflections;
  settings.samples = long_form() ? 16 * samples : samples;
  settings.seed = 20261;
  settings.by_order = true;
  // Following paths for longer costs 2.5 times the rays and takes 55 times the variance away
  // (sphere, emissivity 0.5).
  settings.roulette_survival_scale = 30;
  const AimedView whole = make_aimed_view(target, {0, 0, 1e5});
  const PathTracer tracer(target, simulator.materials(), field_m > 0 ? footprint.view : whole, {},
                          settings);
  PathCounts counts;
  ReplicateStatistics statistics(max_reflections + 1);
  Orders out;
  for (const PathWeights& w : tracer.trace(counts)) {
    std::vector<double> sum(max_reflections + 1, 0.0);
    double running = 0;
    for (std::uint32_t n = 0; n <= max_reflections; ++n) {
      const SourceWeights& table = w.of_order[n];
      running +=
          table.value(0, tracer.layout().seen(0)) + table.value(0, tracer.layout().reflected(0));
      sum[n] = running / w.projected_area_m2;
    }
    statistics.add(sum);
    out.truncated += w.truncated_m2 / w.projected_area_m2 / settings.replicates;
  }
  for (std::uint32_t n = 0; n <= max_reflections; ++n)
    out.effective.push_back(statistics.estimate(n));
  EXPECT_EQ(counts.guarded_nonfinite + counts.guarded_negative, 0u);
  return out;
}

std::string v1(double x) {
  char text[16];
  std::snprintf(text, sizeof(text), "%g", x);
  return text;
}

void expect_row(const Estimate& e, double expected, const std::string& what) {
  EXPECT_LE(e.stderr_, long_form() ? 4e-5 : 2.6e-4) << what;
  // After no reflection there is no scatter, only rounding.
  const double allowed =
      student_t_bound(31, kRows) * e.stderr_ + kFacets + (e.stderr_ < 1e-9 ? 1e-6 : 0);
  EXPECT_NEAR(e.value, expected, allowed) << what;
  std::printf("%-40s %.7f +- %.1e  expected %.7f  t %6.2f\n", what.c_str(), e.value, e.stderr_,
              expected, (e.value - expected) / std::max(e.stderr_, 1e-7));
}

std::vector<std::vector<double>> table(const std::string& name) {
  std::ifstream file(IRSIG_TEST_VALUES "/" + name);
  EXPECT_TRUE(file) << name;
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(file, line);) {
    if (line[0] == '#' || line.find_first_of("0123456789") != 0) continue;
    std::istringstream text(line);
    rows.emplace_back();
    for (std::string field; std::getline(text, field, ',');)
      rows.back().push_back(std::stod(field));
  }
  return rows;
}

// The table's row of these parameters.
std::vector<double> row_of(const std::string& name, double first, double second) {
  for (const auto& v : table(name))
    if (v[0] == first && v[1] == second) return v;
  ADD_FAILURE() << name << " has no row " << first << ", " << second;
  return std::vector<double>(12, 0.0);
}

void expect_sphere(double emissivity, double half_angle_deg, std::uint64_t samples) {
  const auto v = row_of("spherical_cavity.csv", emissivity, half_angle_deg);
  std::vector<Ring> rings;
  const double begin = half_angle_deg * kPi / 180;
  const int count = 1 + static_cast<int>((kPi - begin) / kPi * kSectors / 2);
  for (int k = 0; k <= count; ++k) {
    const double theta = begin + (kPi - begin) * k / count;
    rings.push_back({std::cos(theta), k == count ? 0.0 : std::sin(theta)});
  }
  const auto simulator = simulator_of(scene_of(revolved(rings), grey(emissivity), lwir()));
  const Orders orders = trace(*simulator, 50, samples, 0.4);
  const std::uint32_t reflections[] = {0, 1, 2, 5, 10, 50};
  for (std::size_t k = 0; k < 6; ++k)
    expect_row(orders.effective[reflections[k]], v[3 + k],
               "sphere eps " + v1(emissivity) + " opening " + v1(half_angle_deg) + " N " +
                   std::to_string(reflections[k]));
}

TEST(DeepCavity, SphereOfEmissivity01) { expect_sphere(0.1, 60, 1u << 15); }
TEST(DeepCavity, SphereOfEmissivity03) { expect_sphere(0.3, 60, 1u << 15); }
TEST(DeepCavity, SphereOfEmissivity05) { expect_sphere(0.5, 30, 1u << 13); }
TEST(DeepCavity, SphereOfEmissivity09) { expect_sphere(0.9, 30, 1u << 9); }

void expect_cylinder(double length, double emissivity, std::uint64_t samples) {
  const auto v = row_of("cylindrical_cavity.csv", length, emissivity);
  const auto simulator =
      simulator_of(scene_of(revolved({{length, 1}, {0, 1}, {0, 0}}), grey(emissivity), lwir()));
  const Orders orders = trace(*simulator, 60, samples, 0);
  const std::uint32_t reflections[] = {0, 1, 2, 3, 5, 10, 20, 60};
  for (std::size_t k = 0; k < 8; ++k)  // what 60 reflections leave is below 1e-6: the limit
    expect_row(orders.effective[reflections[k]], k == 7 ? v[2] : v[3 + k],
               "cylinder L/R " + v1(length) + " eps " + v1(emissivity) + " N " +
                   std::to_string(reflections[k]));
  EXPECT_LT(orders.truncated, 1e-6);
}

TEST(DeepCavity, CylinderOfLength1) { expect_cylinder(1, 0.5, 1u << 15); }
TEST(DeepCavity, CylinderOfLength4) { expect_cylinder(4, 0.3, 1u << 14); }
TEST(DeepCavity, CylinderOfLength8) { expect_cylinder(8, 0.9, 1u << 10); }

}  // namespace
}  // namespace irsig
