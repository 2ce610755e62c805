// Records of a worker's spool that something else wrote: each is taken over as a record or removed,
// also where its length and its hash are right.
#include <gtest/gtest.h>

#include <fstream>

#include "jobs/keys/expand.h"  // sha256_hex
#include "tests/fuzz/mutator.h"
#include "tests/fuzz/turns.h"
#include "tests/unit/test_folder.h"
#include "worker/spool.h"

namespace irsig {
namespace {

constexpr std::size_t kHead = 16;  // the magic word and the length
constexpr const char* kWords[] = {"irsigsp1", "\xff\xff\xff\xff\x0f", "\x0a\x7f", "\x12\x00"};

std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string file_of(const std::string& record) {
  std::string out = "irsigsp1";
  for (int byte = 0; byte < 8; ++byte) out += static_cast<char>(record.size() >> (8 * byte) & 0xff);
  out += record;
  return out + sha256_hex(out);
}

TEST(SpoolFuzz, EveryFileIsTakenOverOrRemoved) {
  const TestFolder folder;
  const std::string place = folder.file("spool");
  const auto take = [&] {
    const auto spool = Spool::open(place);
    EXPECT_TRUE(spool.ok()) << spool.status();
    return (*spool)->take_over([](const schema::SpooledResult&) { return true; });
  };
  schema::SpooledResult record;
  record.set_sweep_sha256("a sweep");
  record.set_job_key("x");
  record.set_determinism_class("c");
  record.set_physics_version(1);
  record.set_result(std::string(300, 'r'));
  std::string name;
  {
    const auto spool = Spool::open(place);
    ASSERT_TRUE(spool.ok()) << spool.status();
    const auto kept = (*spool)->keep(record);
    ASSERT_TRUE(kept.ok()) << kept.status();
    name = *kept;
  }
  const std::string path = place + "/" + name, whole = read_file(path);
  const std::string bytes = record.SerializeAsString();
  ASSERT_EQ(whole, file_of(bytes));
  ASSERT_EQ(whole.substr(kHead, bytes.size()), bytes);
  fuzz::Mutator of_files(1, kWords), of_records(2, kWords);
  int taken = 0;
  fuzz::Turns turn(2000);
  while (turn.next()) {
    const std::string mutant =
        turn.index() % 2 == 0 ? of_files.mutate(whole) : file_of(of_records.mutate(bytes));
    std::ofstream(path, std::ios::binary | std::ios::trunc) << mutant;
    const auto found = take();
    ASSERT_LE(found.size(), 1U);
    ASSERT_EQ(std::filesystem::exists(path), found.size() == 1);
    taken += static_cast<int>(found.size());
    if (turn.index() % 2 == 0 && mutant != whole) {
      ASSERT_TRUE(found.empty()) << "its hash is not its own";
    }
  }
  EXPECT_GT(taken, turn.done() / 20);
  EXPECT_LT(taken, turn.done() / 2 + turn.done() / 100);
}

}  // namespace
}  // namespace irsig
