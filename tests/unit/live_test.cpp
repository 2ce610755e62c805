#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "core/base/check.h"
#include "core/hot_gas/column_tests.h"
#include "core/scene/generate/generate_mesh.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "live/camera.h"
#include "live/film.h"
#include "live/joined_frames.h"
#include "live/own_parts.h"
#include "live/page/fly_page.h"
#include "live/recorded_frame.h"
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

// Rationale: a camera may look at a point behind the target, which no sweep file may state.
// Expected: the line of sight stays, its point is nearer than the sensor; a camera that looks away
// is refused.
TEST(LiveCamera, LooksAlongTheSameLineInASweepFile) {
  LiveCamera camera;
  camera.azimuth_deg = 30;
  camera.range_m = 100;
  camera.look_at_m = {1, -2, 3};
  EXPECT_EQ(*look_at_of_sweep(camera), camera.look_at_m);
  const Vec<Body> sensor = 100.0 * body_from_aspect(30, 10);
  camera.look_at_m = {-300, -100, 40};
  const auto nearer = look_at_of_sweep(camera);
  ASSERT_TRUE(nearer.ok()) << nearer.status();
  EXPECT_LT(length(*nearer), camera.range_m);
  EXPECT_GT(dot(normalized(*nearer - sensor), normalized(camera.look_at_m - sensor)), 1 - 1e-12);
  camera.look_at_m = 3.0 * sensor;
  EXPECT_FALSE(look_at_of_sweep(camera).ok());
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

// A floor 4 m wide beside a wall 2 m high, in the sun that shines onto the wall.
TEST(OwnParts, SunlightOfAWallReachesTheFloorByItsViewFactor) {
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
  quad({-10, -1, 0}, {-10, 3, 0}, {10, 3, 0}, {10, -1, 0});
  quad({-10, -1, 0}, {10, -1, 0}, {10, -1, -2}, {-10, -1, -2});
  const auto target = make_target(mesh, {{"body", {"*"}, 0, true, false}}, widest_isa());
  ASSERT_TRUE(target.ok()) << target.status();
  const OwnParts own = OwnParts::make(*target, nullptr);
  constexpr double kReflectance = 0.4;
  const auto reflects = [&](std::uint32_t, float cosine) {
    EXPECT_GT(cosine, 0);
    return static_cast<float>(kReflectance);
  };
  const Vec<Body> sun{0, std::sin(0.5), -std::cos(0.5)};
  const std::vector<float> seen = own.sunlight(*target, sun, reflects);
  ASSERT_EQ(seen.size(), 4u);
  const double of_wall = kReflectance * std::sin(0.5) / std::numbers::pi,
               of_floor = kReflectance * std::cos(0.5) / std::numbers::pi;
  for (std::size_t f = 0; f < 4; ++f) {
    EXPECT_GT(own.facet[f].hidden, 0.05f) << f;
    EXPECT_NEAR(seen[f], static_cast<double>(own.facet[f].hidden) * (f < 2 ? of_wall : of_floor),
                1e-6)
        << f;
  }
  // Where the sun stands behind the wall, the floor is in its shade.
  const std::vector<float> behind =
      own.sunlight(*target, {0, -std::sin(1.4), -std::cos(1.4)}, reflects);
  EXPECT_EQ(behind[0], 0) << "the wall's other side is in the sun";
  EXPECT_EQ(behind[2], 0);
  EXPECT_EQ(behind[3], 0);
}

// Rationale: frames need few of the test gases, and compute these alone.
// Expected: the same numbers as among all. Source: ColumnTests::test of all gases.
TEST(ColumnTests, AFewGasesHaveTheTestsThatTheyHaveAmongAll) {
  GasSegment hot, cool;
  hot.amount = {0.4, 0.3, 0, 2e-9};
  hot.temperature_k = 700;
  hot.temperature_spread_k = 30;
  cool.amount = {0.2, 0.5, 0, 1e-9};
  cool.temperature_k = 400;
  const GasColumn column = {cool, hot};
  const ColumnTests tests({0.6, 0.8, 0, 3e-9}, 750);
  std::vector<double> all(ColumnTests::kCount);
  tests.test(column, all);
  constexpr std::size_t kOfGas = ColumnTests::kLambdas + 1;
  const std::vector<std::uint32_t> gases = {0, 7, 17, 18, 35, 40, 71};
  std::vector<double> few(gases.size() * kOfGas);
  tests.test(column, gases, few);
  for (std::size_t g = 0; g < gases.size(); ++g)
    for (std::size_t k = 0; k < kOfGas; ++k)
      EXPECT_NEAR(few[g * kOfGas + k], all[gases[g] * kOfGas + k],
                  1e-12 * all[gases[g] * kOfGas + k])
          << gases[g];
}

LiveFrame flat_frame(std::uint32_t width, std::uint32_t height, float radiance, float error) {
  LiveFrame out;
  out.width_px = width;
  out.height_px = height;
  out.radiance_w_m2_sr.assign(std::size_t{width} * height, radiance);
  out.error.assign(out.radiance_w_m2_sr.size(), error);
  out.edge.assign(out.radiance_w_m2_sr.size(), 0);
  out.met.assign(out.radiance_w_m2_sr.size(), 1);
  return out;
}

TEST(JoinedFrames, AreTheMeanByRaysWithItsError) {
  JoinedFrames joined;
  joined.add(flat_frame(2, 1, 10, 0.8f), 8);
  joined.add(flat_frame(2, 1, 13, 0.4f), 24);
  const LiveFrame mean = joined.mean();
  EXPECT_FLOAT_EQ(mean.radiance_w_m2_sr[1], 12.25f);
  EXPECT_FLOAT_EQ(mean.error[1], std::hypot(8 * 0.8f, 24 * 0.4f) / 32);
  const PictureErrors errors = errors_of(mean);
  EXPECT_NEAR(errors.rms, static_cast<double>(mean.error[0]) / 1.645 / 12.25, 1e-7);
  EXPECT_NEAR(errors.percentile_99, errors.rms, 1e-12);
}

TEST(JoinedFrames, OnlyPixelsOfTheTargetCount) {
  LiveFrame frame = flat_frame(200, 1, 1, 1.645f);
  frame.met.assign(200, 0);
  EXPECT_EQ(errors_of(frame).rms, 0);
  frame.met[0] = frame.met[1] = 1;
  frame.error[0] = 1.645f * 0.03f;
  frame.error[1] = 1.645f * 0.04f;
  EXPECT_NEAR(errors_of(frame).rms, 0.05 / std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(errors_of(frame).percentile_99, 0.03, 1e-6);
}

TEST(JoinedFrames, APixelIsTheTargetsIfAnyPictureMetItThere) {
  JoinedFrames joined;
  LiveFrame first = flat_frame(2, 1, 1, 0.1f), second = first;
  first.met = {0, 0};
  second.met = {0, 1};
  joined.add(first, 8);
  joined.add(second, 8);
  EXPECT_EQ(joined.mean().met, (std::vector<LiveClass>{0, 1}));
}

Imager test_camera() {
  Imager out;
  out.aperture_m = 0.05;
  out.f_number = 2;
  out.pitch_m = 40e-6;
  out.netd_k = 0.05;
  out.gain = CountsOfTemperatures{220, 420};
  return out;
}

TEST(RecordedFrame, KeepsAUniformSceneAndAddsTheNoiseItStates) {
  const Imager camera = test_camera();
  const auto figures = imager_in_band(camera, {"lwir", 8, 12, 0.1, {}});
  ASSERT_TRUE(figures.ok());
  const LiveFrame scene = flat_frame(320, 256, 40, 0.5f);
  const auto frame = recorded_frame(camera, *figures, scene, 160e-6, 1);
  ASSERT_TRUE(frame.ok()) << frame.status();
  EXPECT_EQ(frame->width_px, 128u);
  EXPECT_EQ(frame->height_px, 103u);
  double sum = 0, squares = 0;
  for (const float r : frame->radiance_w_m2_sr) {
    sum += static_cast<double>(r);
    squares += std::pow(static_cast<double>(r) - 40, 2);
  }
  const auto pixels = static_cast<double>(frame->radiance_w_m2_sr.size());
  const double step = 1 / figures->counts_per_w_m2_sr / std::sqrt(12.0),
               noise = std::hypot(figures->noise_w_m2_sr, step);
  EXPECT_NEAR(sum / pixels, 40, 4 * noise / std::sqrt(pixels));
  EXPECT_NEAR(std::sqrt(squares / pixels) / noise, 1, 4 / std::sqrt(2 * pixels));
  EXPECT_NEAR(frame->error[77], std::hypot(0.5, 1.645 * noise), 1e-5);
  EXPECT_EQ(frame->edge[77], 0);
  // Every radiance is one of a whole number of counts.
  const double counts =
      figures->counts_per_w_m2_sr * static_cast<double>(frame->radiance_w_m2_sr[5]) +
      figures->offset_counts;
  EXPECT_NEAR(counts, std::round(counts), 0.01);
  const auto other = recorded_frame(camera, *figures, scene, 160e-6, 2);
  EXPECT_NE(other->radiance_w_m2_sr, frame->radiance_w_m2_sr);
}

TEST(RecordedFrame, FlagsWhatEdgesFillAndRefusesCoarsePixels) {
  const Imager camera = test_camera();
  const auto figures = imager_in_band(camera, {"lwir", 8, 12, 0.1, {}});
  LiveFrame scene = flat_frame(64, 64, 40, 0.5f);
  for (std::size_t y = 0; y < 64; ++y)
    for (std::size_t x = 0; x < 32; ++x) scene.edge[64 * y + x] = 1;
  const auto frame = recorded_frame(camera, *figures, scene, 200e-6, 1);
  ASSERT_TRUE(frame.ok()) << frame.status();
  EXPECT_EQ(frame->edge[32 * 10 + 3], 1);
  EXPECT_EQ(frame->edge[32 * 10 + 28], 0);
  const auto coarse = recorded_frame(camera, *figures, scene, 201e-6, 1);
  EXPECT_TRUE(absl::IsInvalidArgument(coarse.status()));
  // 2 atan(0.25 x 400e-6 x 64)
  EXPECT_NE(coarse.status().message().find("at most 0.733"), std::string::npos) << coarse.status();
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
