// Files that are no files: what a user names may be anything that a path leads to.
#include "core/base/user_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "tests/unit/test_folder.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

class UserFile : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& bytes) {
    const std::string path = folder_.file(name);
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  static std::string refusal(const std::string& path, std::uint64_t most_bytes = 1000) {
    const auto read = read_user_file(path, most_bytes);
    EXPECT_EQ(read.status().code(), absl::StatusCode::kInvalidArgument) << path;
    return std::string(read.status().message());
  }
  TestFolder folder_;
};

TEST_F(UserFile, RegularFilesAndLinksToThemAreRead) {
  const std::string bytes("a\0b\n\xff", 5), path = write("a", bytes);
  std::filesystem::create_symlink(path, folder_.file("link"));
  EXPECT_EQ(*read_user_file(path, 1000), bytes);
  EXPECT_EQ(*read_user_file(folder_.file("link"), 1000), bytes);
  EXPECT_EQ(*read_user_file(write("empty", ""), 1000), "");
  EXPECT_EQ(*front_of_user_file(path, 3), bytes.substr(0, 3));
  EXPECT_EQ(*front_of_user_file(path, 16), bytes);
}

TEST_F(UserFile, WhatIsNoRegularFileIsRefusedAtOnce) {
  const std::string fifo = folder_.file("fifo");
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  std::filesystem::create_symlink(fifo, folder_.file("link"));
  std::filesystem::create_symlink("/dev/zero", folder_.file("zero"));
  EXPECT_EQ(refusal(fifo), "is a FIFO, expected a regular file");
  EXPECT_EQ(refusal(folder_.file("link")), "is a FIFO, expected a regular file");
  EXPECT_EQ(refusal("/dev/zero"), "is a device, expected a regular file");
  EXPECT_EQ(refusal(folder_.file("zero")), "is a device, expected a regular file");
  EXPECT_EQ(refusal(folder_.path().string()), "is a folder, expected a regular file");
  EXPECT_THAT(refusal(folder_.file("missing")), HasSubstr("No such file"));
  EXPECT_THAT(refusal(""), HasSubstr("No such file"));
  EXPECT_FALSE(front_of_user_file(fifo, 16).ok());
  EXPECT_FALSE(front_of_user_file("/dev/zero", 16).ok());
}

TEST_F(UserFile, WhatAFileNamesLiesBesideIt) {
  const std::string sweep = write("sweep.toml", ""), model = write("ship.obj", "v 0 0 0");
  EXPECT_EQ(*read_file_beside(sweep, "ship.obj", 1000), "v 0 0 0");
  EXPECT_EQ(*read_file_beside("elsewhere/sweep.toml", model, 1000), "v 0 0 0");
  EXPECT_EQ(read_file_beside(sweep, "shp.obj", 1000).status().message(),
            "No such file or directory (looked for beside " + sweep + ")");
  for (const std::string& naming : {std::string("sweep.toml"), sweep})
    EXPECT_EQ(read_file_beside(naming, folder_.file("shp.obj"), 1000).status().message(),
              "No such file or directory");
}

TEST_F(UserFile, SizeIsLimited) {
  const std::string path = write("a", std::string(1000, 'a'));
  EXPECT_EQ(read_user_file(path, 1000)->size(), 1000U);
  EXPECT_EQ(refusal(path, 999), "has 1000 bytes, expected at most 999");
  // A file with a hole of 1 TB takes no room on the disk, and none in memory.
  std::filesystem::resize_file(path, std::uintmax_t{1} << 40);
  EXPECT_THAT(refusal(path, kMostModelBytes), HasSubstr("expected at most 1000000000"));
  EXPECT_EQ(front_of_user_file(path, 16)->size(), 16U);
}

// The size that the kernel states for them is 0: they are read to their end, or to the limit.
TEST_F(UserFile, FilesOfTheKernelHaveNoSizeBeforehand) {
  EXPECT_THAT(*read_user_file("/proc/self/status", 100000), HasSubstr("Name:"));
  EXPECT_EQ(refusal("/proc/self/status", 10), "has more than 10 bytes, expected at most so many");
}

}  // namespace
}  // namespace irsig
