#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "core/base/check.h"
#include "core/scene/generate/generate_mesh.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "live/camera.h"
#include "live/film.h"
#include "live/own_parts.h"
#include "live/page/fly_page.h"
#include "live/reflected_sky.h"
#include "live/tile_threads.h"

namespace irsig {
namespace {

float float_of(std::uint16_t half) {
  const int exponent = half >> 10 & 31, fraction = half & 1023;
  const float size = exponent == 0
                         ? std::ldexp(static_cast<float>(fraction), -24)
                         : std::ldexp(1 + static_cast<float>(fraction) / 1024, exponent - 15);
  return (half & 0x8000) != 0 ? -size : size;
}

TEST(HalfOf, IsTheNearestFloat16) {
  for (float value = 1e-8f; value < 6e4f; value *= 1.0007f) {
    const std::uint16_t half = half_of(value);
    const float is = float_of(half), below = half > 0 ? float_of(half - 1) : 0,
                above = float_of(half + 1);
    EXPECT_LE(std::abs(is - value), std::abs(below - value)) << value;
    EXPECT_LE(std::abs(is - value), std::abs(above - value)) << value;
  }
}

TEST(HalfOf, RoundsTiesToEvenAndKeepsInfinity) {
  EXPECT_EQ(half_of(1.0f + 0x1p-11f), half_of(1.0f));
  EXPECT_EQ(half_of(1.0f + 3 * 0x1p-11f), half_of(1.0f + 0x1p-9f));
  EXPECT_EQ(half_of(std::numeric_limits<float>::infinity()), 0x7c00);
  EXPECT_EQ(half_of(1e9f), 0x7c00);
  EXPECT_EQ(half_of(-2.0f), 0xc000);
}

TEST(EncodedError, IsNeverBelowTheErrorAndAtMostFourPercentAbove) {
  for (double error = 1.1e-4; error < 0.99; error *= 1.013) {
    const double is = 1e-4 * std::pow(10, encoded_error(error, false) * 4 / 254.0);
    EXPECT_GE(is, error * (1 - 1e-12));
    EXPECT_LE(is, 1.04 * error);
  }
  EXPECT_EQ(encoded_error(0.01, true), 255);
  EXPECT_EQ(encoded_error(NAN, false), 255);
  EXPECT_EQ(encoded_error(1e9, false), 254);
}

TEST(EncodePicture, ScalesByAPowerOfTwoAndFlagsEdges) {
  LivePicture picture;
  picture.frame.width_px = 2;
  picture.frame.height_px = 1;
  picture.frame.radiance_w_m2_sr = {1.5e-7f, 3e-7f};
  picture.frame.error = {1.5e-9f, 3e-7f};
  picture.frame.edge = {0, 1};
  const std::string bytes = encode_picture(picture);
  ASSERT_EQ(bytes.size(), 64u + 6u);
  float scale = 0;
  std::memcpy(&scale, bytes.data() + 16, 4);
  int exponent = 0;
  EXPECT_EQ(std::frexp(scale, &exponent), 0.5f);
  std::uint16_t half = 0;
  std::memcpy(&half, bytes.data() + 64, 2);
  EXPECT_NEAR(float_of(half) * scale, 1.5e-7f, 1.5e-7f * 0x1p-11f);
  EXPECT_EQ(static_cast<std::uint8_t>(bytes[68]), encoded_error(0.01, false));
  EXPECT_EQ(static_cast<std::uint8_t>(bytes[69]), 255);
}

TEST(CheckCamera, RefusesWhatIsNotFiniteOrTooLarge) {
  const LiveCamera fine;
  EXPECT_TRUE(check_camera(fine).ok());
  for (const double wrong : {std::nan(""), static_cast<double>(INFINITY), 1e308, -1e308}) {
    for (double LiveCamera::*member : {&LiveCamera::azimuth_deg, &LiveCamera::elevation_deg,
                                       &LiveCamera::range_m, &LiveCamera::field_of_view_deg}) {
      LiveCamera camera = fine;
      camera.*member = wrong;
      EXPECT_EQ(check_camera(camera).code(), absl::StatusCode::kInvalidArgument);
    }
    LiveCamera camera = fine;
    camera.look_at_m.y = wrong;
    EXPECT_EQ(check_camera(camera).code(), absl::StatusCode::kInvalidArgument);
  }
  LiveCamera camera = fine;
  camera.width_px = camera.height_px = kMostLiveSide;
  EXPECT_THAT(std::string(check_camera(camera).message()), testing::HasSubstr("pixels"));
}

TEST(TileThreads, TakeEachTileOnce) {
  TileThreads threads(3);
  for (int round = 0; round < 50; ++round) {
    std::vector<std::atomic<int>> taken(97);
    threads.run(97, [&](std::uint32_t tile, std::uint32_t) { ++taken[tile]; });
    for (const auto& t : taken) EXPECT_EQ(t, 1);
  }
}

PreparedScene scene_of(MaterialSpec material) {
  SceneSpec spec;
  auto mesh = generate_mesh({"box", 12, 0, 4, 3, 2});
  IRSIG_CHECK(mesh.ok());
  spec.mesh = *std::move(mesh);
  spec.material = {std::move(material)};
  spec.part = {{"body", {"*"}, 0, false, false}};
  spec.band = {{"LWIR", 8, 12, 0.5, {}}};
  auto scene = PreparedScene::make(spec);
  IRSIG_CHECK(scene.ok());
  return *std::move(scene);
}

// Rationale: under a uniform sphere of radiance 1 a surface reflects its directional-hemispherical
// reflectance. Expected: 1 - emissivity at every tilt and azimuth. Source: Kirchhoff's law.
TEST(ReflectedSky, IsTheReflectanceInAUniformSphere) {
  const PreparedScene scene = scene_of({"grey", Lambert{{{0, 0.7}}}});
  const ReflectedSky sky(scene, DirectionNodes({0.1f, 0.5f, 1.0f}, {0.2f, 1.0f}, 4));
  ASSERT_EQ(sky.rings(), 5u);
  const std::vector<double> ring(sky.rings(), 1.0);
  for (const float entry : sky.of(0, ring, 0, 1)) EXPECT_NEAR(entry, 0.3f, 1e-5f);
}

// Rationale: a level Lambertian plate under a sky of radiance 1 above a black lower half reflects
// all of it, and half of it if it stands upright. Expected: reflectance x (1 + cos(tilt)) / 2.
TEST(ReflectedSky, SeesTheSkyThatItsTiltLeaves) {
  const PreparedScene scene = scene_of({"grey", Lambert{{{0, 0.7}}}});
  const ReflectedSky sky(scene, DirectionNodes({0.0f, 1.0f}, {0.0f, 1.0f}, 1));
  const std::vector<float> table = sky.of(0, std::vector<double>{1, 1, 0, 0}, 0, 1);
  for (const float up : {1.0f, 0.5f, 0.0f, -0.5f, -1.0f})
    EXPECT_NEAR(ReflectedSky::look_up(table.data(), up, 0.5f, 1.0f), 0.3f * (1 + up) / 2, 0.008f)
        << up;
}

TEST(OwnParts, SeeNothingOfAConvexTargetAndMostFromTheBottomOfAWell) {
  const PreparedScene box = scene_of({"grey", Lambert{{{0, 0.7}}}});
  EXPECT_TRUE(OwnParts::make(box.target, nullptr).facet.empty());
  // A floor 2 m wide between two walls 20 m high and 20 m long.
  Mesh mesh;
  const auto quad = [&](Vec<Body> a, Vec<Body> b, Vec<Body> c, Vec<Body> d) {
    const auto n = static_cast<std::uint32_t>(mesh.vertex.size());
    for (const auto& v : {a, b, c, d}) mesh.vertex.push_back(v);
    for (const auto& t : {std::array<std::uint32_t, 3>{n, n + 1, n + 2}, {n, n + 2, n + 3}}) {
      mesh.triangle.push_back(t);
      mesh.triangle_group.push_back(0);
    }
  };
  mesh.group = {"all"};
  quad({-10, -1, 0}, {-10, 1, 0}, {10, 1, 0}, {10, -1, 0});
  quad({-10, 1, 0}, {-10, 1, -20}, {10, 1, -20}, {10, 1, 0});
  quad({-10, -1, 0}, {10, -1, 0}, {10, -1, -20}, {-10, -1, -20});
  const auto target = make_target(mesh, {{"body", {"*"}, 0, true, false}}, widest_isa());
  ASSERT_TRUE(target.ok()) << target.status();
  const OwnParts own = OwnParts::make(*target, nullptr);
  ASSERT_EQ(own.facet.size(), 6u);
  EXPECT_GT(own.facet[0].hidden, 0.7f);
}

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t out = 0;
  for (std::size_t k = 0; k < 4; ++k) out = out << 8 | static_cast<std::uint8_t>(bytes[at + k]);
  return out;
}

// Chunks of a PNG: type and content.
std::vector<std::pair<std::string, std::string>> chunks_of(const std::string& png) {
  std::vector<std::pair<std::string, std::string>> out;
  for (std::size_t at = 8; at + 12 <= png.size(); at += 12 + big_endian(png, at))
    out.emplace_back(png.substr(at + 4, 4), png.substr(at + 8, big_endian(png, at)));
  return out;
}

std::string tiny_png(const std::string& data) {
  std::string out("\x89PNG\r\n\x1a\n", 8);
  const auto chunk = [&](const std::string& type, const std::string& content) {
    for (int k = 3; k >= 0; --k) out.push_back(static_cast<char>(content.size() >> (8 * k)));
    out += type + content + "CRC.";
  };
  chunk("IHDR", std::string("\0\0\0\2\0\0\0\3\x8\0\0\0\0", 13));
  chunk("IDAT", data.substr(0, 2));
  chunk("IDAT", data.substr(2));
  chunk("IEND", "");
  return out;
}

TEST(AnimatedPng, HasTheFramesInOrderWithTheirData) {
  const auto film = animated_png({tiny_png("first"), tiny_png("second"), tiny_png("third")}, 100);
  ASSERT_TRUE(film.ok()) << film.status();
  const auto chunks = chunks_of(*film);
  std::vector<std::string> types;
  for (const auto& [type, content] : chunks) types.push_back(type);
  EXPECT_THAT(types, testing::ElementsAre("IHDR", "acTL", "fcTL", "IDAT", "fcTL", "fdAT", "fcTL",
                                          "fdAT", "IEND"));
  EXPECT_EQ(big_endian(chunks[1].second, 0), 3u);
  EXPECT_EQ(chunks[3].second, "first");
  EXPECT_EQ(chunks[5].second.substr(4), "second");
  EXPECT_EQ(big_endian(chunks[7].second, 0), 4u);  // of all fcTL and fdAT
  // Known CRC of an empty IEND.
  EXPECT_EQ(big_endian(*film, film->size() - 4), 0xae426082u);
}

TEST(AnimatedPng, RefusesWhatIsNoPng) {
  EXPECT_FALSE(animated_png({}, 100).ok());
  EXPECT_FALSE(animated_png({"GIF89a"}, 100).ok());
  EXPECT_FALSE(animated_png({tiny_png("data").substr(0, 40)}, 100).ok());
}

}  // namespace
}  // namespace irsig
