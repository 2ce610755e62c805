// A database is a file and the journal beside it: by which names both are found, and what is
// refused because only one of them is there.

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <functional>
#include <sstream>

#include "schema/store/whole/examine.h"
#include "schema/store/whole/merge.h"
#include "schema/store/whole/slice.h"
#include "schema/store/whole_file.h"
#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

namespace fs = std::filesystem;

std::string file_bytes(const std::string& path) {
  std::ostringstream out;
  out << std::ifstream(path, std::ios::binary).rdbuf();
  return out.str();
}

class StoreWholeFile : public ::testing::Test {
 protected:
  // A writer that was killed after two of four jobs: the rows stand in the journal.
  void kill_a_writer() {
    killed([&] {
      auto writer = StoreWriter::open(path_);
      if (writer.ok() && submit(**writer, sweep_, "sweep-a").ok() &&
          complete_jobs(**writer, sweep_, 2).ok())
        die();
    });
    ASSERT_TRUE(fs::exists(path_ + "-wal"));
  }
  // `work` ends with die().
  static void killed(const std::function<void()>& work) {
    const pid_t child = fork();
    if (child == 0) {
      work();
      _exit(1);
    }
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
  }
  static void die() { kill(getpid(), SIGKILL); }
  // A finished database with every job done.
  void write() {
    auto writer = StoreWriter::open(path_);
    ASSERT_OK(writer.status());
    ASSERT_OK(submit(**writer, sweep_, "sweep-a").status());
    ASSERT_OK(complete_jobs(**writer, sweep_).status());
    ASSERT_OK((*writer)->finish());
  }
  static std::size_t rows(const std::string& path) {
    const auto reader = StoreReader::open(path);
    EXPECT_TRUE(reader.ok()) << reader.status();
    return reader.ok() ? (*reader)->find({}).value().size() : 0;
  }
  static std::string digest(const std::string& path) {
    const auto reader = StoreReader::open(path);
    EXPECT_TRUE(reader.ok()) << reader.status();
    return reader.ok() ? (*reader)->digest().value() : "";
  }
  absl::Status slice(const std::string& from) {
    fs::remove(folder_.file("slice.sigdb"));
    const SliceAsked asked{.filter = {}, .filter_text = "", .source_digest = false};
    return slice_database(from, asked, folder_.file("slice.sigdb"), nullptr).status();
  }
  absl::Status merge(const std::string& from) {
    fs::remove(folder_.file("merged.sigdb"));
    return merge_databases({.from = {from},
                            .jobs = [](const schema::ResolvedSweep& sweep,
                                       int) { return make_jobs(sweep, "sweep-a"); },
                            .physics_version = 1},
                           folder_.file("merged.sigdb"), nullptr)
        .status();
  }
  // Everybody refuses it with these words, and it stays as it is.
  // (Its bytes are not read here: that would end the locks of a writer in this process.)
  void refused(const std::string& path, const std::string& words) {
    const auto names = names_but_locks();
    const auto written = fs::last_write_time(path);
    for (const absl::Status& status :
         {StoreReader::open(path).status(), StoreWriter::open(path).status(),
          examine(path, 1).status(), slice(path), merge(path)}) {
      EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
      EXPECT_THAT(std::string(status.message()), HasSubstr(words));
      EXPECT_THAT(std::string(status.message()), HasSubstr(path));
    }
    EXPECT_EQ(fs::last_write_time(path), written);
    EXPECT_EQ(names_but_locks(), names);
  }
  // A refused writer takes with it the lock of one that was killed.
  [[nodiscard]] std::vector<std::string> names_but_locks() const {
    std::vector<std::string> names = folder_.names();
    std::erase_if(names, [](const std::string& name) { return name.ends_with("-lock"); });
    return names;
  }

  TestFolder folder_;
  std::string path_ = folder_.file("a.sigdb");
  schema::ResolvedSweep sweep_ = make_sweep({});
};

TEST_F(StoreWholeFile, AHeaderThatAsksForAJournalWhichIsMissingIsRefused) {
  ASSERT_NO_FATAL_FAILURE(write());
  const std::string before = digest(path_);
  ASSERT_EQ(sqlite_text(path_, "PRAGMA journal_mode = WAL"), "wal");
  ASSERT_EQ(folder_.names(), std::vector<std::string>{"a.sigdb"});
  refused(path_, "a journal belongs to it");
  refused(path_, "`irsig doctor --accept " + path_ + "`");
  // A program that only reads such a file leaves this.
  std::ofstream(path_ + "-wal").close();
  refused(path_, "a journal belongs to it");
  const auto accepted = accept_file(path_, 1);
  ASSERT_OK(accepted.status());
  EXPECT_TRUE(accepted->made_plain);
  EXPECT_TRUE(accepted->findings.empty());
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.sigdb"});
  EXPECT_EQ(sqlite_text(path_, "PRAGMA journal_mode"), "delete");
  EXPECT_EQ(digest(path_), before);
  EXPECT_FALSE(accept_file(path_, 1)->made_plain) << "there is nothing to accept";
}

TEST_F(StoreWholeFile, ACopyWithoutTheJournalIsRefusedAndOneWithItIsComplete) {
  ASSERT_NO_FATAL_FAILURE(kill_a_writer());
  const std::string copy = folder_.file("copy.sigdb");
  fs::copy(path_, copy);
  refused(copy, "a journal belongs to it");
  fs::copy(path_ + "-wal", copy + "-wal");
  EXPECT_EQ(rows(copy), 8U);
  EXPECT_EQ(digest(copy), digest(path_));
}

// SQLite folds the journal in and leaves the header as it is.
TEST_F(StoreWholeFile, AnotherProgramThatClosesItAfterAKillLeavesAFileToBeAccepted) {
  ASSERT_NO_FATAL_FAILURE(kill_a_writer());
  const std::string before = digest(path_);
  ASSERT_EQ(sqlite_text(path_, "SELECT count(*) FROM signature"), "8");
  EXPECT_THAT(folder_.names(), UnorderedElementsAre("a.sigdb", "a.sigdb-lock"));
  refused(path_, "another SQLite program closed it after a kill");
  const auto accepted = accept_file(path_, 1);
  ASSERT_OK(accepted.status());
  EXPECT_TRUE(accepted->made_plain);
  ASSERT_EQ(accepted->findings.size(), 1U);
  EXPECT_EQ(accepted->findings[0].kind, StoreFinding::Kind::kMissing);
  EXPECT_THAT(accepted->findings[0].what, HasSubstr("2 of 4 jobs are not done"));
  EXPECT_THAT(accepted->findings[0].what, HasSubstr("(jobs 2, 3)"));
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.sigdb"});
  EXPECT_EQ(digest(path_), before);
  auto writer = StoreWriter::open(path_).value();
  EXPECT_EQ(complete_jobs(*writer, sweep_).value(), 2);
  ASSERT_OK(writer->finish());
  EXPECT_EQ(rows(path_), 16U);
}

TEST_F(StoreWholeFile, AJournalThatIsThereIsFoldedInWhenItIsAccepted) {
  ASSERT_NO_FATAL_FAILURE(kill_a_writer());
  const std::string before = digest(path_);
  EXPECT_TRUE(accept_file(path_, 1).value().made_plain);
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.sigdb"});
  EXPECT_EQ(digest(path_), before);
}

TEST_F(StoreWholeFile, WhatIsDamagedOrWrittenIsNotAccepted) {
  ASSERT_NO_FATAL_FAILURE(write());
  ASSERT_EQ(sqlite_text(path_,
                        "PRAGMA journal_mode = WAL; DELETE FROM spectrum WHERE signature_id "
                        "= 3; SELECT 'damaged'"),
            "damaged");
  const std::string before = file_bytes(path_);
  const auto accepted = accept_file(path_, 1);
  ASSERT_OK(accepted.status());
  EXPECT_TRUE(accepted->damaged);
  EXPECT_FALSE(accepted->made_plain);
  EXPECT_EQ(file_bytes(path_), before);
  fs::remove(path_);
  auto writer = StoreWriter::open(path_).value();
  EXPECT_TRUE(absl::IsFailedPrecondition(accept_file(path_, 1).status()));
}

// Accepting a file does not make it one of this format.
TEST_F(StoreWholeFile, AnOlderFileIsNotAccepted) {
  ASSERT_NO_FATAL_FAILURE(write());
  ASSERT_EQ(sqlite_text(path_, "PRAGMA user_version = 19; PRAGMA journal_mode = WAL"), "wal");
  EXPECT_THAT(std::string(StoreWriter::open(path_).status().message()), HasSubstr("--accept"));
  const std::string before = file_bytes(path_);
  EXPECT_THAT(std::string(accept_file(path_, 1).status().message()),
              HasSubstr("has format version 19"));
  EXPECT_EQ(file_bytes(path_), before);
}

TEST_F(StoreWholeFile, TheJournalIsFoundThroughLinks) {
  ASSERT_NO_FATAL_FAILURE(kill_a_writer());
  const TestFolder elsewhere;
  fs::create_symlink(path_, elsewhere.file("link.sigdb"));
  fs::create_directory_symlink(folder_.path(), elsewhere.file("folder"));
  fs::create_symlink("link.sigdb", elsewhere.file("second.sigdb"));
  const std::string expected = digest(path_);
  for (const char* name : {"link.sigdb", "second.sigdb", "folder/a.sigdb"}) {
    const std::string link = elsewhere.file(name);
    EXPECT_EQ(rows(link), 8U) << name;
    EXPECT_EQ(digest(link), expected) << name;
    EXPECT_TRUE(has_writer_lock(link)) << name;
    ASSERT_OK(slice(link));
    EXPECT_EQ(rows(folder_.file("slice.sigdb")), 8U) << name;
    ASSERT_OK(merge(link));
    EXPECT_EQ(rows(folder_.file("merged.sigdb")), 8U) << name;
  }
  // It is so while the file is written, too.
  auto writer = StoreWriter::open(elsewhere.file("link.sigdb")).value();
  ASSERT_OK(writer->begin());
  ASSERT_OK(writer->release_all());
  ASSERT_OK(writer->commit());
  EXPECT_EQ(complete_jobs(*writer, sweep_, 1).value(), 1);
  for (const char* name : {"link.sigdb", "second.sigdb", "folder/a.sigdb"})
    EXPECT_EQ(rows(elsewhere.file(name)), 12U) << name;
  EXPECT_EQ(elsewhere.names().size(), 3U) << "nothing lies beside a link";
}

TEST_F(StoreWholeFile, AFileWithSeveralHardLinksIsReadAndNotWritten) {
  ASSERT_NO_FATAL_FAILURE(write());
  const std::string other = folder_.file("b.sigdb");
  fs::create_hard_link(path_, other);
  EXPECT_EQ(digest(path_), digest(other));
  for (const std::string& name : {path_, other}) {
    const absl::Status status = StoreWriter::open(name).status();
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr("has 2 hard links"));
    EXPECT_THAT(std::string(status.message()), HasSubstr("find / -xdev -samefile " + name));
  }
  EXPECT_THAT(folder_.names(), UnorderedElementsAre("a.sigdb", "b.sigdb"));
  // The remedy of the message.
  fs::copy(path_, path_ + ".own");
  fs::rename(path_ + ".own", path_);
  ASSERT_OK(StoreWriter::open(path_).status());
}

// A link that was made while it was written: the journal has the first name.
TEST_F(StoreWholeFile, AHardLinkToAFileThatIsWrittenOrWasKilledIsRefused) {
  ASSERT_NO_FATAL_FAILURE(kill_a_writer());
  const std::string other = folder_.file("b.sigdb");
  fs::create_hard_link(path_, other);
  refused(other, "it has 2 hard links");
  EXPECT_TRUE(absl::IsInvalidArgument(accept_file(other, 1).status()));
  EXPECT_EQ(rows(path_), 8U);
  EXPECT_THAT(std::string(StoreWriter::open(path_).status().message()),
              HasSubstr("has 2 hard links"));
  fs::remove(other);
  auto writer = StoreWriter::open(path_).value();
  fs::create_hard_link(path_, other);
  ASSERT_OK(writer->begin());
  ASSERT_OK(writer->release_all());
  ASSERT_OK(writer->commit());
  EXPECT_EQ(complete_jobs(*writer, sweep_).value(), 2);
  refused(other, "it has 2 hard links");
  ASSERT_OK(writer->finish());
  writer.reset();
  EXPECT_EQ(rows(other), 16U) << "one plain file, by whatever name";
}

// Closing is not finishing: the journal belongs to the file.
TEST_F(StoreWholeFile, AWriterThatEndsWithoutFinishingLeavesItsJournal) {
  {
    auto writer = StoreWriter::open(path_).value();
    ASSERT_OK(submit(*writer, sweep_, "sweep-a").status());
    EXPECT_EQ(complete_jobs(*writer, sweep_, 1).value(), 1);
  }
  EXPECT_TRUE(fs::exists(path_ + "-wal"));
  EXPECT_EQ(rows(path_), 4U);
  ASSERT_OK(StoreWriter::open(path_).value()->finish());
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.sigdb"});
}

// A writer that was just opened has its first commit already; another program may empty the
// journal of one that lives.
TEST_F(StoreWholeFile, AFileOfAWriterThatLivesOrWasKilledAtOnceIsRead) {
  {
    const auto writer = StoreWriter::open(path_).value();
    EXPECT_EQ(rows(path_), 0U);
    ASSERT_EQ(sqlite_text(path_, "PRAGMA wal_checkpoint(TRUNCATE)"), "0");
    EXPECT_EQ(rows(path_), 0U);
  }
  killed([&] {
    const auto writer = StoreWriter::open(path_);
    if (writer.ok()) die();
  });
  EXPECT_EQ(rows(path_), 0U);
  ASSERT_OK(StoreWriter::open(path_).value()->finish());
}

// Killed between the change of the header and that of the journal: the lock file says so, of this
// file and of no other.
TEST_F(StoreWholeFile, WhatTheLockFileSaysIsBelievedOfThisFileAlone) {
  ASSERT_NO_FATAL_FAILURE(write());
  ASSERT_EQ(sqlite_text(path_, "PRAGMA journal_mode = WAL"), "wal");
  struct stat here {};
  ASSERT_EQ(stat(path_.c_str(), &here), 0);
  const auto say = [&](const std::string& path, ino_t inode) {
    std::ofstream(path + "-lock") << "whole " << here.st_dev << " " << inode << "\n";
  };
  say(path_, here.st_ino + 1);
  EXPECT_FALSE(StoreReader::open(path_).ok());
  say(path_, here.st_ino);
  EXPECT_EQ(rows(path_), 16U);
  const std::string copy = folder_.file("copy.sigdb");
  fs::copy(path_, copy);
  say(copy, here.st_ino);
  EXPECT_FALSE(StoreReader::open(copy).ok());
  EXPECT_FALSE(StoreWriter::open(copy).ok());
  fs::remove(copy);
  {
    const auto writer = StoreWriter::open(path_);
    ASSERT_OK(writer.status());
    EXPECT_EQ(file_bytes(path_ + "-lock"), "") << "there is a commit in the journal";
    ASSERT_OK((*writer)->finish());
  }
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.sigdb"});
}

}  // namespace
}  // namespace irsig
