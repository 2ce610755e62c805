// Rationale: a ray from inside a closed surface must meet it. A ray that slips out between two
//   facets or through a vertex sees the sky instead of the wall: cavities come out too cold or too
//   warm, and the error hides in the noise.
// Expected: of random rays, rays aimed at edges and rays aimed at vertices none is lost and none
//   stopped by what is not there, wherever the file's coordinates lie. An answer counts as right if
//   it is the exact one for the ray, or for the ray moved sideways by at most 2^-20 of the mesh's
//   radius (15 um on a ship's 15 m), about the rounding of float32 coordinates seen from two radii.
// Source: exact arithmetic on the same coordinates (core/scene/trace/exact_facet.h), itself tested
// against
//   whole numbers in tests/unit/exact_facet_test.cpp.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "core/scene/generate/generate_mesh.h"
#include "core/scene/trace/target.h"
#include "verify/watertight/watertight_check.h"

namespace irsig {
namespace {

WatertightCounts check(const Mesh& mesh, const WatertightCheck& what) {
  const absl::StatusOr<WatertightCounts> counts = check_watertight(mesh, what);
  EXPECT_TRUE(counts.ok()) << counts.status();
  return counts.ok() ? *counts : WatertightCounts{};
}

std::vector<TracerIsa> available_isas() {
  std::vector<TracerIsa> out;
  for (const TracerIsa isa : {TracerIsa::kAvx512, TracerIsa::kAvx2, TracerIsa::kSse42})
    if (isa >= widest_isa()) out.push_back(isa);
  return out;
}

class AtOffset : public testing::TestWithParam<double> {};

TEST_P(AtOffset, NoRayIsLostAndNoHitInvented) {
  std::uint64_t rays = 0, decided = 0;
  for (const NamedMesh& hard : hard_closed_meshes(20'000)) {
    const absl::StatusOr<Mesh> mesh = import_from_offset(hard.mesh, GetParam());
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    for (const AimedAt aimed_at : {AimedAt::kRandom, AimedAt::kEdges, AimedAt::kVertices}) {
      WatertightCheck what;
      what.aimed_at = aimed_at;
      what.rays = aimed_at == AimedAt::kRandom ? 200'000 : 20'000;
      const WatertightCounts counts = check(*mesh, what);
      EXPECT_EQ(counts.failures(), 0u) << hard.name << ", " << counts.first_failure;
      EXPECT_LE(counts.within_tolerance, what.rays / 50) << hard.name;
      rays += counts.rays;
      if (aimed_at == AimedAt::kVertices) decided += counts.near_vertices.decided;
    }
  }
  EXPECT_EQ(rays, 1'200'000u);
  EXPECT_GT(decided, 50'000u);  // else the rays were not aimed at vertices
}

INSTANTIATE_TEST_SUITE_P(Watertight, AtOffset, testing::Values(0.0, 1e3, 1e5, 6.4e6));

// A thousand times as large: rays look again (tracer.h), by origins that are rounded anew.
TEST(Watertight, LargeMeshesLoseNoRayEither) {
  for (NamedMesh hard : hard_closed_meshes(5'000)) {
    for (Vec<Body>& v : hard.mesh.vertex) v = 1000.0 * v;
    for (const AimedAt aimed_at : {AimedAt::kRandom, AimedAt::kEdges, AimedAt::kVertices}) {
      WatertightCheck what;
      what.aimed_at = aimed_at;
      what.rays = 40'000;
      const WatertightCounts counts = check(hard.mesh, what);
      EXPECT_EQ(counts.failures(), 0u) << hard.name << ", " << counts.first_failure;
      EXPECT_LE(counts.within_tolerance, what.rays / 50) << hard.name;
    }
  }
}

// The check can fail: without the caps vertices leak, without ROBUST edges do as well.
TEST(Watertight, TheCheckSeesWhatItLooksFor) {
  const Mesh mesh = generate_mesh({"sphere", 2000}).value();
  WatertightCheck what;
  what.rays = 50'000;
  what.aimed_at = AimedAt::kVertices;
  what.options = {true, TracerGuard::kEdges};
  EXPECT_GT(check(mesh, what).lost, 10u);
  what.aimed_at = AimedAt::kEdges;
  what.options = {false, TracerGuard::kNone};
  EXPECT_GT(check(mesh, what).lost, 500u);
  EXPECT_GT(check(mesh, what).shadow_lost, 500u);
}

TEST(Watertight, WithEveryInstructionSetAndBothKindsOfPackets) {
  for (const TracerIsa isa : available_isas()) {
    for (const bool coherent : {false, true}) {
      for (const NamedMesh& hard : hard_closed_meshes(5'000)) {
        for (const AimedAt aimed_at : {AimedAt::kEdges, AimedAt::kVertices}) {
          WatertightCheck what;
          what.aimed_at = aimed_at;
          what.rays = 8'000;
          what.seed = 2;
          what.isa = isa;
          what.coherent = coherent;
          const WatertightCounts counts = check(hard.mesh, what);
          EXPECT_EQ(counts.failures(), 0u)
              << isa_name(isa) << " " << hard.name << ", " << counts.first_failure;
        }
      }
    }
  }
}

struct Soup {
  std::vector<float> vertex;
  std::vector<std::uint32_t> triangle;
};

Soup soup_of(const Mesh& mesh) {
  Soup out;
  for (const Vec<Body>& v : mesh.vertex)
    for (const double x : {v.x, v.y, v.z}) out.vertex.push_back(static_cast<float>(x));
  for (const auto& t : mesh.triangle) out.triangle.insert(out.triangle.end(), t.begin(), t.end());
  return out;
}

std::unique_ptr<Tracer> tracer_of(const Soup& soup, TracerIsa isa = widest_isa()) {
  return Tracer::build(soup.vertex, soup.triangle, isa).value();
}

void aim(RayPacket& p, int lane, const float* origin, const float* to) {
  p.org_x[lane] = origin[0];
  p.org_y[lane] = origin[1];
  p.org_z[lane] = origin[2];
  p.dir_x[lane] = to[0] - origin[0];
  p.dir_y[lane] = to[1] - origin[1];
  p.dir_z[lane] = to[2] - origin[2];
  p.tnear[lane] = p.time[lane] = 0;
  p.tfar[lane] = std::numeric_limits<float>::infinity();
  p.mask[lane] = 0xffffffffu;
  p.id[lane] = p.flags[lane] = 0;
  p.triangle[lane] = p.geometry[lane] = p.instance[lane] = RayPacket::kMiss;
}

// A ray's hit must not depend on the rays that share its packet: jobs may be cut anywhere.
class BitsOfRays : public testing::TestWithParam<float> {};

// Tests a frigate, and one 20 times as long, where rays look again.
TEST_P(BitsOfRays, DoNotDependOnThePacketsOtherRays) {
  const float size = GetParam();
  Soup soup = soup_of(generate_mesh({"frigate", 20'000}).value());
  for (float& x : soup.vertex) x *= size;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  constexpr int kRays = 4'096;
  std::vector<float> origin(3 * kRays), to(3 * kRays);
  for (std::size_t i = 0; i < kRays; ++i) {
    for (std::size_t j = 0; j < 3; ++j) origin[3 * i + j] = 160 * size * (unit(random) - 0.5f);
    // A third at vertices, the others near them.
    const std::size_t v = random() % (soup.vertex.size() / 3);
    for (std::size_t j = 0; j < 3; ++j)
      to[3 * i + j] = soup.vertex[3 * v + j] + (i % 3 == 0 ? 0.0f : size * (unit(random) - 0.5f));
  }
  for (const TracerIsa isa : available_isas()) {
    const auto tracer = tracer_of(soup, isa);
    struct Answer {
      std::uint32_t triangle;
      float tfar;
      bool operator==(const Answer&) const = default;
    };
    for (const bool coherent : {false, true}) {
      const auto trace = [&](const std::vector<std::size_t>& order, std::size_t together) {
        std::vector<Answer> out(kRays);
        for (std::size_t first = 0; first < kRays; first += together) {
          RayPacket p;
          for (std::size_t lane = 0; lane < together; ++lane) {
            const std::size_t i = order[first + lane];
            aim(p, static_cast<int>(lane), &origin[3 * i], &to[3 * i]);
          }
          tracer->intersect(p, static_cast<int>(together), coherent);
          for (std::size_t lane = 0; lane < together; ++lane)
            out[order[first + lane]] = {p.triangle[lane], p.tfar[lane]};
        }
        return out;
      };
      std::vector<std::size_t> order(kRays);
      for (std::size_t i = 0; i < kRays; ++i) order[i] = i;
      const std::vector<Answer> alone = trace(order, 1);
      for (const std::size_t together : {16u, 8u, 16u, 16u}) {
        const std::vector<Answer> shared = trace(order, together);
        int different = 0;
        for (std::size_t i = 0; i < kRays; ++i) different += shared[i] != alone[i];
        EXPECT_EQ(different, 0) << isa_name(isa) << (coherent ? " coherent" : " incoherent");
        std::shuffle(order.begin(), order.end(), random);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Tracer, BitsOfRays, testing::Values(1.0F, 20.0F));

// A sheet drawn twice, once for each side: every ray meets the facet that faces it.
TEST(Tracer, OfTwoFacetsInOnePlaceTheOneThatFacesTheRay) {
  Soup soup;
  soup.vertex = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0};  // the last repeats the third
  soup.triangle = {0, 1, 2, 1, 0, 3, 0, 1, 2};
  const auto tracer = tracer_of(soup);
  const float above[3] = {0.25f, 0.25f, 1}, below[3] = {0.25f, 0.25f, -1}, far_above[3] = {0, 0, 1},
              corner[3] = {0, 0, 0};
  RayPacket p;
  aim(p, 0, above, below);
  aim(p, 1, below, above);
  aim(p, 2, far_above, corner);
  tracer->intersect(p, 3, false);
  EXPECT_EQ(p.triangle[0], 0u);
  EXPECT_EQ(p.triangle[1], 1u);
  for (int lane = 0; lane < 2; ++lane) EXPECT_LT(p.normal_z[lane] * p.dir_z[lane], 0) << lane;
  EXPECT_NE(p.triangle[2], 1u);
}

// A cover 0.1 mm before a plate, sloping, 2 km from the middle: from there distances are known to
// 0.2 mm. Expected: every ray meets the cover, whichever comes first in the file.
TEST(Tracer, CloseLayersOfALongModelAreToldApart) {
  for (const bool cover_first : {true, false}) {
    Soup soup;
    const auto add = [&](float x, float over) {
      const auto base = static_cast<std::uint32_t>(soup.vertex.size() / 3);
      for (const auto& [a, b] : {std::pair{-1.f, -1.f}, {1.f, -1.f}, {1.f, 1.f}, {-1.f, 1.f}})
        for (const float c : {x + a, b, 0.5f * a + over}) soup.vertex.push_back(c);
      for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) soup.triangle.push_back(base + k);
    };
    for (const float x : {2000.f, -2000.f})
      for (const bool cover : {cover_first, !cover_first}) add(x, cover ? 1e-4f : 0.f);
    const auto tracer = tracer_of(soup);
    std::mt19937_64 random(3);
    std::uniform_real_distribution<float> place(-0.9f, 0.9f), side(-1, 1);
    int covers = 0;
    for (int i = 0; i < 2000; ++i) {
      const float x = i % 2 == 0 ? 2000.f : -2000.f, a = place(random);
      const float at[3] = {x + a, place(random), 0.5f * a};
      const float from[3] = {x + 1000 * side(random), 1000 * side(random), 3900};
      RayPacket p;
      aim(p, 0, from, at);
      tracer->intersect(p, 1, i % 4 < 2);
      ASSERT_NE(p.triangle[0], RayPacket::kMiss);
      covers += (p.triangle[0] / 2 % 2 == 0) == cover_first;
      EXPECT_NEAR(p.tfar[0] * std::hypot(p.dir_x[0], p.dir_y[0], p.dir_z[0]),
                  std::hypot(at[0] - from[0], at[1] - from[1], at[2] - from[2]), 2e-3);
    }
    EXPECT_EQ(covers, 2000) << cover_first;
  }
}

// A vertex of an open sheet: what passes outside it is not stopped by its cap.
TEST(Tracer, CapsStopNothingThemselves) {
  Soup soup;
  soup.vertex = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  soup.triangle = {0, 1, 2};
  const auto tracer = tracer_of(soup);
  RayPacket p;
  const float by = 0x1.4p-22f;  // within a cap, outside of the rounding that Embree allows for
  for (int lane = 0; lane < 8; ++lane) {
    const float x = lane % 2 == 0 ? by : -by, y = lane / 2 % 2 == 0 ? by : -by;
    const float from[3] = {x, y, 1}, to[3] = {x, y, 0};
    aim(p, lane, from, to);
  }
  tracer->intersect(p, 8, false);
  for (int lane = 0; lane < 8; ++lane)
    EXPECT_EQ(p.triangle[lane], lane % 4 == 0 ? 0u : RayPacket::kMiss) << lane;
  EXPECT_GE(tracer->vertex_counts().near_vertex, 8u);
  EXPECT_EQ(tracer->vertex_counts().decided, 2u);
}

// Embree 3.13.5 enters an infinite loop with AVX-512, packets of 16, COHERENT, ROBUST and COMPACT
// together. We use all but the last; Tracer::build checks that COMPACT is not set. A tracer that
// hangs is killed here after a minute instead of stopping everything.
void trace_coherent_packets(TracerIsa isa) {
  const Mesh mesh = generate_mesh({"frigate", 200'000}).value();
  const Soup soup = soup_of(mesh);
  const auto tracer = tracer_of(soup, isa);
  for (int row = 0; row < 200; ++row) {
    for (int column = 0; column < 200; ++column) {
      RayPacket p;
      for (int lane = 0; lane < 16; ++lane) {
        const float from[3] = {
            -90 + 0.9f * (static_cast<float>(column) + 0.06f * static_cast<float>(lane)), -150,
            -45 + 0.25f * static_cast<float>(row)};
        const float to[3] = {from[0], 0, from[2]};
        aim(p, lane, from, to);
      }
      RayPacket shadow = p;
      tracer->intersect(p, 16, true);
      tracer->occluded(shadow, 16, true);
    }
  }
}

TEST(TracerDeathTest, CoherentPacketsComeToAnEnd) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  for (const TracerIsa isa : available_isas()) {
    EXPECT_EXIT(
        {
          alarm(60);
          trace_coherent_packets(isa);
          _exit(0);
        },
        testing::ExitedWithCode(0), "")
        << isa_name(isa);
  }
}

}  // namespace
}  // namespace irsig
