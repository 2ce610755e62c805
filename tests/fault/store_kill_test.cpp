// A writer that is killed in the middle, again and again: nothing that was acknowledged is lost,
// nothing is torn, and the next writer goes on at once.

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <random>
#include <set>
#include <thread>

#include "tests/unit/store_fixture.h"
#include "schema/store/reader.h"

namespace irsig {
namespace {

constexpr int kRounds = 20;

SweepShape shape() {
  SweepShape shape;
  shape.aspects.clear();
  for (int i = 0; i < 20000; ++i) shape.aspects.emplace_back(0.018 * i, 10);
  shape.bands = {"mwir"};
  shape.parts = 3;
  return shape;
}

// The child: completes jobs in groups of five, and writes the viewpoint's index of each to the pipe
// after its commit.
[[noreturn]] void complete_until_killed(const std::string& path, const schema::ResolvedSweep& sweep,
                                        int pipe) {
  auto writer = StoreWriter::open(path);
  if (!writer.ok() || !(*writer)->begin().ok() || !(*writer)->release_all().ok()) {
    std::fprintf(stderr, "%s\n", writer.status().ToString().c_str());
    _exit(2);
  }
  for (;;) {
    std::vector<std::uint32_t> completed;
    for (int i = 0; i < 5; ++i) {
      const auto job = (*writer)->lease_next("child", 0);
      if (!job.ok() || !job->has_value()) _exit(3);
      const auto result = make_result(sweep, (*job)->spec, 41, 4000, 20000);
      if (!(*writer)->complete((*job)->fencing_token, result, "child").ok()) _exit(4);
      completed.push_back((*job)->spec.view().viewpoint_index());
    }
    if (!(*writer)->commit().ok()) _exit(5);
    if (write(pipe, completed.data(), completed.size() * sizeof(std::uint32_t)) < 0) _exit(6);
    if (!(*writer)->begin().ok()) _exit(7);
  }
}

TEST(StoreKill, NothingAcknowledgedIsLost) {
  const TestFolder folder;
  const std::string path = folder.file("a.sigdb");
  const schema::ResolvedSweep sweep = make_sweep(shape());
  {
    auto writer = StoreWriter::open(path);
    ASSERT_OK(writer.status());
    ASSERT_OK(submit(**writer, sweep, "sweep-a").status());
  }
  std::mt19937 random(1);
  std::uniform_int_distribution<int> life_ms(5, 120);
  std::set<std::uint32_t> acknowledged;
  for (int round = 0; round < kRounds; ++round) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t child = fork();
    if (child == 0) {
      close(ends[0]);
      complete_until_killed(path, sweep, ends[1]);
    }
    close(ends[1]);
    // Its life begins with the first acknowledgement: starting up takes as long as the machine is
    // busy.
    std::uint32_t index = 0;
    bool started = false;
    std::jthread killer;
    while (read(ends[0], &index, sizeof index) == static_cast<ssize_t>(sizeof index)) {
      EXPECT_TRUE(acknowledged.insert(index).second)
          << "job " << index << " was acknowledged twice";
      if (started) continue;
      started = true;
      killer = std::jthread([child, ms = life_ms(random)] {
        std::this_thread::sleep_for(std::chrono::milliseconds(ms));
        kill(child, SIGKILL);
      });
    }
    if (killer.joinable()) killer.join();
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the child ended by itself with " << WEXITSTATUS(status);
    close(ends[0]);

    // A reader comes first, while the journal is still as the kill left it.
    auto reader = StoreReader::open(path);
    ASSERT_OK(reader.status());
    const auto found = (*reader)->find({});
    ASSERT_OK(found.status());
    std::map<double, int> rows_of;
    for (const StoredSignature& s : *found) ++rows_of[s.aspect_azimuth_deg];
    for (const std::uint32_t done : acknowledged) {
      ASSERT_EQ(rows_of[sweep.viewpoint(static_cast<int>(done)).aspect_azimuth_deg()], 2) << done;
    }
    // Committed but not yet acknowledged: at most one group, and that one whole.
    EXPECT_EQ(rows_of.size() % 5, 0U);
    const std::size_t unacknowledged = rows_of.size() - acknowledged.size();
    EXPECT_LE(unacknowledged, 5U);
    if (unacknowledged > 0) {
      for (int v = 0; v < sweep.viewpoint_size(); ++v) {
        if (rows_of.contains(sweep.viewpoint(v).aspect_azimuth_deg()))
          acknowledged.insert(static_cast<std::uint32_t>(v));
      }
    }
    reader->reset();
    // Read a copy: another SQLite program that closes the file last takes the journal away.
    const TestFolder elsewhere;
    const std::string copy = elsewhere.file("copy.sigdb");
    std::filesystem::copy_file(path, copy);
    if (std::filesystem::exists(path + "-wal"))
      std::filesystem::copy_file(path + "-wal", copy + "-wal");
    EXPECT_EQ(sqlite_text(copy, "PRAGMA integrity_check"), "ok");
    EXPECT_EQ(sqlite_text(copy, "PRAGMA foreign_key_check"), "(no row)");
  }
  EXPECT_GE(acknowledged.size(), static_cast<std::size_t>(kRounds) * 5);

  // The file holds the results of a run without interruption.
  auto writer = StoreWriter::open(path);
  ASSERT_OK(writer.status());
  EXPECT_EQ((*writer)->progress()->front().done, acknowledged.size());
  ASSERT_OK((*writer)->finish());
  writer->reset();
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.sigdb"});
  auto reader = StoreReader::open(path);
  ASSERT_OK(reader.status());
  const auto jobs = make_jobs(sweep, "sweep-a");
  const auto found = (*reader)->find({});
  ASSERT_OK(found.status());
  for (std::size_t i = 0; i < found->size(); i += 37) {
    const StoredSignature& s = (*found)[i];
    const schema::JobResult expected = make_result(sweep, jobs[(s.row - 1) / 2], 41, 4000, 20000);
    const schema::SignatureRow& row = expected.view().row(static_cast<int>((s.row - 1) % 2));
    EXPECT_EQ(s.intensity_w_sr, row.intensity_w_sr().value());
    EXPECT_EQ((*reader)->thumbnail(s.signature_id).value()->exr(), row.thumbnail().exr());
    EXPECT_EQ((*reader)->spectrum(s.signature_id)->SerializeAsString(),
              row.spectrum().SerializeAsString());
  }
}

// A creation that was killed half-way: the next writer starts anew.
TEST(StoreKill, AKilledCreationDoesNotBlockTheNext) {
  for (int microseconds = 200; microseconds < 60000; microseconds = microseconds * 3 / 2) {
    const TestFolder folder;
    const std::string path = folder.file("a.sigdb");
    const pid_t child = fork();
    if (child == 0) {
      static_cast<void>(StoreWriter::open(path));
      _exit(0);
    }
    usleep(static_cast<useconds_t>(microseconds));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    auto writer = StoreWriter::open(path);
    ASSERT_OK(writer.status());
    ASSERT_OK(submit(**writer, make_sweep({}), "sweep-a").status());
    ASSERT_OK((*writer)->finish());
    EXPECT_EQ(sqlite_text(path, "PRAGMA integrity_check"), "ok");
  }
}

}  // namespace
}  // namespace irsig
