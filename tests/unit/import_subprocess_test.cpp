// glTF is read in a process of its own: whatever that does, this one goes on.
#include "core/scene/import/import_mesh.h"
#include "core/scene/import/import_subprocess.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <thread>

#include "core/scene/import/import_reply.h"
#include "core/scene/mesh.h"
#include "tests/unit/float32_files.h"
#include "tests/unit/test_folder.h"

namespace irsig {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

absl::StatusOr<Mesh> read_apart(const std::string& name, const std::string& bytes) {
  return import_mesh(bytes, {name, 1, "+x", "+z", "origin"});
}

std::string mesh_with(std::string json, const std::string& from, const std::string& to) {
  const std::size_t at = json.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return json.replace(at, from.size(), to);
}

std::string refusal_apart(const std::string& name, const std::string& bytes) {
  const absl::StatusOr<Mesh> mesh = read_apart(name, bytes);
  EXPECT_EQ(mesh.status().code(), absl::StatusCode::kInvalidArgument) << mesh.status();
  return std::string(mesh.status().message());
}

// The undamaged scene of the fuzz tests: each kind of node and primitive is there.
TEST(ImportApart, GltfAndGlbGiveTheSameMesh) {
  const Mesh gltf = *read_apart("a.gltf", gltf_scene(true).json);
  const GltfScene scene = gltf_scene(false);
  const Mesh glb = *read_apart("a.glb", glb_file(scene.json, scene.buffer));
  EXPECT_EQ(gltf.triangle.size(), 20U);
  EXPECT_EQ(gltf.vertex, glb.vertex);
  EXPECT_EQ(gltf.triangle, glb.triangle);
  EXPECT_EQ(gltf.triangle_group, glb.triangle_group);
  EXPECT_EQ(gltf.group, glb.group);
  EXPECT_THAT(gltf.group, ElementsAre("ship/hull-0/steel", "ship/hull-1/paint", "mast/pole/paint",
                                      "crane/hook", "boat/hull-0/steel", "boat/hull-1/paint"));
}

TEST(ImportApart, ASparseAccessorWithoutIndicesIsRefused) {
  const std::string gltf = mesh_with(gltf_scene(true).json, R"("sparse":{"count":1,"indices")",
                                     R"("sparse":{"count":1,"x")");
  EXPECT_THAT(refusal_apart("a.gltf", gltf),
              HasSubstr("a.gltf: accessors[3].sparse: has no indices"));
  const GltfScene scene = gltf_scene(false);
  const std::string glb = glb_file(
      mesh_with(scene.json, R"("sparse":{"count":1,"indices")", R"("sparse":{"count":1,"x")"),
      scene.buffer);
  EXPECT_THAT(refusal_apart("a.glb", glb), HasSubstr("accessors[3].sparse: has no indices"));
}

// An accessor without a buffer is zeros, as many as it says: 7 GB from 1 kB.
TEST(ImportApart, AFileThatAsksForGigabytesIsRefused) {
#if defined(IRSIG_SANITIZE_THREAD)
  GTEST_SKIP() << "built with the thread sanitizer, the importer has no limit of memory";
#endif
  const std::string message = refusal_apart(
      "a.gltf", mesh_with(gltf_scene(true).json,
                          R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min")",
                          R"({"componentType":5126,"count":300000000,"type":"VEC3","min")"));
  EXPECT_THAT(message, HasSubstr("the file is damaged, or made to do harm"));
#if !defined(__SANITIZE_ADDRESS__)  // which ends the process itself
  EXPECT_THAT(message, HasSubstr("MB of memory"));
#endif
}

// Each node is twice the child of the one before: 2^39 of them from 1.2 kB.
TEST(ImportApart, NodesAreTrees) {
  std::string nodes;
  for (int i = 1; i < 40; ++i)
    nodes += R"({"children":[)" + std::to_string(i) + "," + std::to_string(i) + "]},";
  const std::string gltf = mesh_with(gltf_scene(true).json, R"("nodes":[0,3])", R"("nodes":[0])");
  const std::size_t begin = gltf.find(R"("nodes":[{)"), end = gltf.find(R"("materials")");
  EXPECT_THAT(refusal_apart("a.gltf", gltf.substr(0, begin) + R"("nodes":[)" + nodes +
                                          R"({"mesh":0}],)" + gltf.substr(end)),
              HasSubstr("a.gltf: nodes[1]: is the child of nodes[0] and of nodes[0]"));
}

TEST(ImportApart, BrokenJsonHasAPlace) {
  const std::string gltf = mesh_with(gltf_scene(true).json, R"("componentType":5123,"count":12)",
                                     R"("componentType":512":12)");
  EXPECT_THAT(refusal_apart("a.gltf", gltf),
              ::testing::ContainsRegex("a.gltf:1:[0-9]+: this is no"));
}

TEST(ImportApart, LimitsGrowWithTheFile) {
  EXPECT_EQ(apart_limits(888).memory_bytes, (1U << 30) + 64U * 888U);
  EXPECT_EQ(apart_limits(888).cpu_s, 30U);
  EXPECT_EQ(apart_limits(100'000'000).cpu_s, 1030U);
  EXPECT_EQ(apart_limits(100'000'000).wall_s, 10300U);
}

// Any other program in the importer's place, as if the library had turned it into that.
class ImportByAnother : public ::testing::Test {
 protected:
  absl::Status import_by(const std::string& script) {
    const std::string path = folder_.file("importer");
    std::ofstream(path) << "#!/bin/sh\n" << script << "\n";
    ::chmod(path.c_str(), 0700);
    return import_subprocess(path, std::string(1000000, 'a'), "stl").status();
  }
  TestFolder folder_;
};

TEST_F(ImportByAnother, EveryEndIsAnError) {
  const auto expect = [&](const std::string& script, absl::StatusCode code,
                          const std::string& text) {
    const absl::Status status = import_by(script);
    EXPECT_EQ(status.code(), code) << script << ": " << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(text)) << script;
  };
  using enum absl::StatusCode;
  // These read nothing: the sender must survive that.
  expect("exit 0", kInternal, "said nothing");
  expect("exit 3", kInvalidArgument, "exit code 3");
  expect("kill -SEGV $$", kInvalidArgument, "crashed on it (signal 11)");
  expect("kill -ABRT $$", kInvalidArgument, "crashed on it (signal 6)");
  expect("kill -XCPU $$", kInvalidArgument, "more than 40 s of the processor");
  expect("kill -ALRM $$", kInvalidArgument, "longer than 400 s");
  expect("kill -KILL $$", kInternal, "killed by signal 9");
  // The answer is no mesh.
  expect("exec cat", kInternal, "said nothing");
  expect("exec cat >/dev/null", kInternal, "said nothing");
  expect("printf 'irsig mesh 1\\n'", kInternal, "said nothing");
  expect("printf 'irsig none 1\\nno'; exit 1", kInvalidArgument, "exit code 1");
  expect("cat >/dev/null; printf 'irsig none 1\\nno facets'", kInvalidArgument, "no facets");
  EXPECT_THAT(std::string(import_subprocess(folder_.file("none"), "a", "stl").status().message()),
              HasSubstr("it belongs beside the irsig executable"));
}

// A worker's threads, each with its own importer, do not inherit each other's connections.
TEST(ImportApart, SeveralAtOnce) {
  const GltfScene scene = gltf_scene(false);
  const std::string bytes = glb_file(scene.json, scene.buffer);
  std::vector<std::thread> threads;
  std::vector<std::size_t> triangles(8, 0);
  for (std::size_t& count : triangles)
    threads.emplace_back([&count, &bytes] {
      for (int i = 0; i < 5; ++i) {
        const auto mesh = read_apart("a.glb", bytes);
        count += mesh.ok() ? mesh->triangle.size() : 0;
      }
    });
  for (std::thread& thread : threads) thread.join();
  for (const std::size_t count : triangles) EXPECT_EQ(count, 100U);
}

TEST(ImportReply, ComesBackBitForBit) {
  FileMesh mesh;
  mesh.vertex = {{0, -0.0, 1e-310}, {1e308, std::nextafter(1.0, 2.0), 0.1}, {3, 4, 5}};
  mesh.triangle = {{0, 1, 2}, {2, 1, 0}};
  mesh.triangle_group = {1, 0};
  mesh.group = {"a/b", std::string("\0\xff\n", 3)};
  const FileMesh back = *decode_reply(encode_reply(mesh));
  EXPECT_EQ(back.vertex, mesh.vertex);
  EXPECT_TRUE(std::signbit(back.vertex[0].y));
  EXPECT_EQ(back.triangle, mesh.triangle);
  EXPECT_EQ(back.triangle_group, mesh.triangle_group);
  EXPECT_EQ(back.group, mesh.group);
  EXPECT_EQ(decode_reply(encode_reply(absl::InvalidArgumentError("no facets"))).status(),
            absl::InvalidArgumentError("no facets"));
}

TEST(ImportReply, WhatIsNotSoundIsRefused) {
  FileMesh good;
  good.vertex = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  good.triangle = {{0, 1, 2}};
  good.triangle_group = {0};
  good.group = {"a"};
  const std::string reply = encode_reply(good);
  for (std::size_t length = 0; length < reply.size(); ++length)
    EXPECT_TRUE(absl::IsDataLoss(decode_reply(reply.substr(0, length)).status())) << length;
  EXPECT_TRUE(absl::IsDataLoss(decode_reply(reply + "a").status()));
  FileMesh bad = good;
  bad.triangle[0][1] = 3;
  EXPECT_TRUE(absl::IsDataLoss(decode_reply(encode_reply(bad)).status()));
  bad = good;
  bad.triangle_group[0] = 1;
  EXPECT_TRUE(absl::IsDataLoss(decode_reply(encode_reply(bad)).status()));
  bad = good;
  bad.triangle_group.push_back(0);
  EXPECT_TRUE(absl::IsDataLoss(decode_reply(encode_reply(bad)).status()));
  bad = good;
  bad.vertex[2].z = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(absl::IsDataLoss(decode_reply(encode_reply(bad)).status()));
}

}  // namespace
}  // namespace irsig
