// Tests which files are opened, which are refused, and which stay behind.

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>

#include "schema/store/open_database.h"
#include "schema/store/tables/statements.h"
#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

std::string bytes_of(const std::string& path) {
  std::ostringstream out;
  out << std::ifstream(path, std::ios::binary).rdbuf();
  return out.str();
}

class StoreOpen : public ::testing::Test {
 protected:
  // A finished database with every job done.
  void write() {
    auto writer = StoreWriter::open(path_);
    ASSERT_OK(writer.status());
    ASSERT_OK(submit(**writer, sweep_, "sweep-a").status());
    ASSERT_OK(complete_jobs(**writer, sweep_).status());
    ASSERT_OK((*writer)->finish());
  }

  TestFolder folder_;
  std::string path_ = folder_.file("a.sigdb");
  schema::ResolvedSweep sweep_ = make_sweep({});
};

TEST_F(StoreOpen, OnePlainFileStaysAtTheEnd) {
  ASSERT_NO_FATAL_FAILURE(write());
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.sigdb"});
  EXPECT_EQ(sqlite_text(path_, "PRAGMA journal_mode"), "delete");
  EXPECT_EQ(sqlite_text(path_, "PRAGMA user_version"), absl::StrCat(kFormat));
  EXPECT_EQ(sqlite_text(path_,
                        "SELECT count(*) FROM job_view WHERE kind = 'view' AND state = 'done'"
                        " AND viewpoint_index IS NOT NULL AND unmet_needs = 0"),
            "4");
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM attempt JOIN job USING (job_id)"), "4")
      << "the rows that name a job stay";
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM pragma_foreign_key_check()"), "0");
  EXPECT_EQ(sqlite_text(path_, "PRAGMA application_id"), absl::StrCat(0x49525347));
}

TEST_F(StoreOpen, WriteAheadLoggingWithFullSynchronisationWhileWriting) {
  auto opened = open_for_writing(path_);
  ASSERT_OK(opened.status());
  auto& database = *opened->database;
  EXPECT_EQ(*database.integer("PRAGMA synchronous"), 2);
  EXPECT_EQ(*database.integer("PRAGMA foreign_keys"), 1);
  auto rows = database.query("PRAGMA journal_mode");
  ASSERT_OK(rows.status());
  ASSERT_TRUE(*rows->next());
  EXPECT_EQ(rows->text(), "wal");
}

TEST_F(StoreOpen, ReadingChangesNothing) {
  EXPECT_TRUE(absl::IsNotFound(StoreReader::open(path_).status()));
  EXPECT_TRUE(folder_.names().empty());
  ASSERT_NO_FATAL_FAILURE(write());
  const std::string before = bytes_of(path_);
  {
    auto reader = StoreReader::open(path_);
    ASSERT_OK(reader.status());
    ASSERT_OK((*reader)->find({}).status());
    ASSERT_OK((*reader)->digest().status());
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.sigdb"});
  }
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.sigdb"});
  EXPECT_EQ(bytes_of(path_), before);
}

TEST_F(StoreOpen, ReadersSeeCommitsWhileTheWriterWrites) {
  auto writer = StoreWriter::open(path_);
  ASSERT_OK(writer.status());
  ASSERT_OK(submit(**writer, sweep_, "sweep-a").status());
  auto reader = StoreReader::open(path_);
  ASSERT_OK(reader.status());
  EXPECT_EQ((*reader)->find({})->size(), 0U);
  ASSERT_OK(complete_jobs(**writer, sweep_, 1).status());
  EXPECT_EQ((*reader)->find({})->size(), 4U);
  ASSERT_OK((*writer)->begin());
  EXPECT_EQ((*reader)->progress()->front().done, 1U);
  (*writer)->rollback();
  reader->reset();
  ASSERT_OK((*writer)->finish());
}

TEST_F(StoreOpen, ForeignFilesAreRefusedAndStayAsTheyAre) {
  const std::string text = folder_.file("notes.txt");
  std::ofstream(text) << "not a database, but longer than a header: " << std::string(200, 'x');
  const std::string short_text = folder_.file("short.txt");
  std::ofstream(short_text) << "hello";
  const std::string other = folder_.file("other.db");
  std::ofstream(other).close();
  ASSERT_EQ(sqlite_text(other, "CREATE TABLE t (x); SELECT 'made'"), "made");
  ASSERT_NO_FATAL_FAILURE(write());
  ASSERT_EQ(sqlite_text(path_, "PRAGMA user_version = 99; SELECT 'newer'"), "newer");
  const auto names = folder_.names();
  for (const auto& [path, message] :
       {std::pair{text, "is not a signature database"},
        std::pair{short_text, "is not a signature database"},
        std::pair{other, "is an SQLite file, but not a signature database"},
        std::pair{path_, "has format version 99"}}) {
    const std::string before = bytes_of(path);
    for (const absl::Status& status :
         {StoreWriter::open(path).status(), StoreReader::open(path).status()}) {
      EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
      EXPECT_NE(status.message().find(message), absl::string_view::npos) << status;
      EXPECT_NE(status.message().find(path), absl::string_view::npos) << status;
    }
    EXPECT_EQ(bytes_of(path), before) << path;
  }
  EXPECT_EQ(folder_.names(), names);
  EXPECT_TRUE(absl::IsInvalidArgument(StoreWriter::open(folder_.path()).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(StoreReader::open(folder_.path()).status()));
}

TEST_F(StoreOpen, AnEmptyFileBecomesADatabase) {
  std::ofstream(path_).close();
  EXPECT_TRUE(absl::IsInvalidArgument(StoreReader::open(path_).status()));
  ASSERT_NO_FATAL_FAILURE(write());
}

TEST_F(StoreOpen, AFailedCreationLeavesNothing) {
  EXPECT_TRUE(absl::IsNotFound(StoreWriter::open(folder_.file("missing/a.sigdb")).status()));
  EXPECT_TRUE(folder_.names().empty());
  // A directory stands in the place of the journal: SQLite cannot make it there.
  std::filesystem::create_directory(path_ + "-journal");
  EXPECT_FALSE(StoreWriter::open(path_).ok());
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.sigdb-journal"});
}

TEST_F(StoreOpen, AnUnwritableFolderIsRefused) {
  if (geteuid() == 0) {
    // Root writes everywhere; a child without privileges has to try.
    ASSERT_EQ(chmod(folder_.path().c_str(), 0755), 0);
    const pid_t child = fork();
    if (child == 0) {
      if (setuid(65534) != 0) _exit(3);
      _exit(StoreWriter::open(path_).ok() ? 1 : 0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  } else {
    ASSERT_EQ(chmod(folder_.path().c_str(), 0555), 0);
    EXPECT_FALSE(StoreWriter::open(path_).ok());
    ASSERT_EQ(chmod(folder_.path().c_str(), 0755), 0);
  }
  EXPECT_TRUE(folder_.names().empty());
}

TEST_F(StoreOpen, OneWriterAtATime) {
  auto first = StoreWriter::open(path_);
  ASSERT_OK(first.status());
  const auto second = StoreWriter::open(path_);
  EXPECT_TRUE(absl::IsFailedPrecondition(second.status())) << second.status();
  EXPECT_NE(second.status().message().find("another irsig is writing"), absl::string_view::npos);
  // The refused one must not have broken the lock of the first.
  EXPECT_FALSE(StoreWriter::open(path_).ok());
  std::filesystem::create_symlink(path_, folder_.file("link.sigdb"));
  EXPECT_FALSE(StoreWriter::open(folder_.file("link.sigdb")).ok());
  ASSERT_OK(submit(**first, sweep_, "sweep-a").status());
  first->reset();
  ASSERT_OK(StoreWriter::open(path_).status());
}

// The journal cannot go while somebody reads from it; nothing is lost by that.
TEST_F(StoreOpen, AReaderAtTheEndPostponesThePlainFile) {
  auto writer = StoreWriter::open(path_).value();
  ASSERT_OK(submit(*writer, sweep_, "sweep-a").status());
  ASSERT_OK(complete_jobs(*writer, sweep_).status());
  {
    auto reader = StoreReader::open(path_).value();
    EXPECT_EQ(reader->find({})->size(), 16U);
    EXPECT_TRUE(absl::IsUnavailable(writer->finish()));
    EXPECT_EQ(reader->find({})->size(), 16U);
  }
  ASSERT_OK(writer->finish());
  writer.reset();
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"a.sigdb"});
}

TEST_F(StoreOpen, ChangesNeedATransaction) {
  auto writer = StoreWriter::open(path_);
  ASSERT_OK(writer.status());
  EXPECT_TRUE(absl::IsFailedPrecondition((*writer)->lease_next("worker", 0).status()));
  EXPECT_TRUE(absl::IsFailedPrecondition((*writer)->release_all()));
}

// A file of an older format is not changed into the newer one: the refusal names its format and the
// build that wrote it.
TEST_F(StoreOpen, AnOlderFileIsRefusedAndStaysAsItIs) {
  ASSERT_NO_FATAL_FAILURE(write());
  const auto refused = [&](const std::string& change) {
    EXPECT_EQ(sqlite_text(path_, change + "; PRAGMA user_version = 19; SELECT 'older'"), "older");
    const std::string before = bytes_of(path_);
    const absl::Status status = StoreReader::open(path_).status();
    EXPECT_EQ(StoreWriter::open(path_).status(), status);
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
    EXPECT_EQ(bytes_of(path_), before);
    return std::string(status.message());
  };
  EXPECT_EQ(refused("UPDATE provenance SET build_id = 'v0-12' || char(27)"),
            path_ +
                ": has format version 19, of an irsig before the first release; this irsig "
                "reads version 29: run the sweep again into a new file, or read this one with "
                "the irsig that wrote it (build v0-12?)");
  // Nothing of an unchecked definition is run: this view never ends.
  EXPECT_THAT(refused("DROP VIEW signature_view; DROP TABLE provenance; CREATE VIEW provenance AS "
                      "WITH RECURSIVE n (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) "
                      "SELECT sum(i) AS build_id FROM n"),
              ::testing::EndsWith("the irsig that wrote it"));
  EXPECT_THAT(refused("DROP VIEW provenance"), ::testing::EndsWith("the irsig that wrote it"));
}

// The journal stays after a killed run, too: it belongs to the irsig that wrote it.
TEST_F(StoreOpen, TheJournalOfAnOlderFileStays) {
  ASSERT_NO_FATAL_FAILURE(write());
  {
    auto opened = open_for_writing(path_);
    ASSERT_OK(opened.status());
    ASSERT_OK(opened->database->script("PRAGMA user_version = 19"));
  }
  const std::string journal = bytes_of(path_ + "-wal");
  ASSERT_FALSE(journal.empty());
  EXPECT_THAT(std::string(StoreWriter::open(path_).status().message()),
              ::testing::HasSubstr("has format version 19"));
  EXPECT_EQ(bytes_of(path_ + "-wal"), journal);
}

// A reason that nobody knows is none.
TEST_F(StoreOpen, TheReasonsToStopAreThoseOfTheTable) {
  ASSERT_NO_FATAL_FAILURE(write());
  EXPECT_THAT(sqlite_text(path_, "PRAGMA foreign_keys = ON; UPDATE signature SET stop_reason = 6"),
              ::testing::HasSubstr("FOREIGN KEY"));
  EXPECT_EQ(sqlite_text(path_, "SELECT max(stop_reason) FROM stop_reason"),
            absl::StrCat(static_cast<int>(schema::STOP_REASON_FLOOR_REACHED)));
}

// Part of a target seen from behind is said in the row, beside what its condition warns of.
TEST_F(StoreOpen, BackFacesAreAWarningOfTheRow) {
  ASSERT_NO_FATAL_FAILURE(write());
  ASSERT_EQ(sqlite_text(path_,
                        "UPDATE signature SET backface_fraction = 0; UPDATE signature SET "
                        "backface_fraction = 0.25 WHERE signature_id IN (SELECT signature_id "
                        "FROM signature_view WHERE row IN (1, 2)); SELECT 'set'"),
            "set");
  auto reader = StoreReader::open(path_).value();
  int warned = 0;
  const auto rows = reader->find({}).value();
  for (const StoredSignature& s : rows) {
    const bool behind = s.backface_fraction > 0;
    EXPECT_EQ(behind, s.row <= 2) << s.row;
    EXPECT_EQ(s.warning.find("back faces: ") != std::string::npos, behind) << s.warning;
    warned += behind ? 1 : 0;
  }
  EXPECT_EQ(warned, 2);
  const StoredOutcome outcome = reader->outcome(sweep_.sweep().name()).value();
  EXPECT_EQ(outcome.backface_views, 1U);
  EXPECT_EQ(outcome.largest_backface_fraction, 0.25);
}

// The file's columns, the message's fields and the catalogue are one list.
TEST_F(StoreOpen, EveryQuantityIsAColumnAndAField) {
  ASSERT_NO_FATAL_FAILURE(write());
  const google::protobuf::Descriptor& row = *schema::SignatureRow::descriptor();
  for (const QuantityInfo& quantity : kQuantities) {
    const std::string name(quantity.name);
    for (const char* table : {"signature", "signature_view"})
      EXPECT_EQ(sqlite_text(path_, absl::StrCat("SELECT count(*) FROM pragma_table_info('", table,
                                                "') WHERE name = '", name, "'")),
                "1")
          << table << "." << name;
    if (quantity.kind == QuantityKind::kStderr) continue;
    const auto* field = row.FindFieldByName(name);
    ASSERT_NE(field, nullptr) << name;
    EXPECT_EQ(quantity.kind == QuantityKind::kSampled,
              field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE)
        << name;
  }
  // Every number of a row in the file is in the catalogue.
  const std::string numbers =
      sqlite_text(path_, "SELECT count(*) FROM pragma_table_info('signature') WHERE type = 'REAL'");
  EXPECT_EQ(numbers, std::to_string(kQuantities.size() + 2)) << "and the sun's two angles";
}

// A quantity that is bound by name comes back under its name.
TEST_F(StoreOpen, EveryQuantityComesBackAsItWasStored) {
  ASSERT_NO_FATAL_FAILURE(write());
  std::string script = "UPDATE signature SET ";
  for (std::size_t q = 0; q < kQuantities.size(); ++q)
    absl::StrAppend(&script, q == 0 ? "" : ", ", std::string(kQuantities[q].name), " = ",
                    static_cast<double>(q) + 0.5);
  ASSERT_EQ(sqlite_text(path_, script + "; SELECT 'set'"), "set");
  const auto rows = StoreReader::open(path_).value()->find({}).value();
  for (const StoredSignature& s : rows)
    for (std::size_t q = 0; q < kQuantities.size(); ++q)
      EXPECT_EQ(s.*kQuantityMember[q], static_cast<double>(q) + 0.5) << kQuantities[q].name;
}

// A database is read with the views, and written with the triggers, that are in it: one that
// another program has made or changed might never answer, or do something else as well.
TEST_F(StoreOpen, ADatabaseWithDefinitionsOfSomebodyElseIsRefused) {
  ASSERT_NO_FATAL_FAILURE(write());
  const std::string good = bytes_of(path_);
  const std::pair<const char*, const char*> changes[] = {
      {"DROP VIEW signature_view; CREATE VIEW signature_view AS WITH RECURSIVE n (i) AS "
       "(SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i AS signature_id FROM n",
       "view signature_view"},
      {"CREATE TRIGGER harmless AFTER INSERT ON signature BEGIN DELETE FROM asset; END",
       "trigger harmless"},
      {"CREATE TABLE mine (x)", "table mine"},
      {"CREATE INDEX slow ON signature (intensity_w_sr)", "index slow"},
      {"DROP INDEX signature_by_job", "index signature_by_job"},
      {"ALTER TABLE asset ADD COLUMN remark TEXT", "table asset"}};
  for (const auto& [change, named] : changes) {
    std::ofstream(path_, std::ios::binary) << good;
    ASSERT_EQ(sqlite_text(path_, absl::StrCat(change, "; SELECT 'changed'")), "changed");
    const std::string before = bytes_of(path_);
    for (const absl::Status& status :
         {StoreReader::open(path_).status(), StoreWriter::open(path_).status()}) {
      EXPECT_TRUE(absl::IsInvalidArgument(status)) << change << ": " << status;
      EXPECT_NE(status.message().find(named), absl::string_view::npos) << status;
    }
    EXPECT_EQ(bytes_of(path_), before) << change;
  }
  // Tables that SQLite makes for itself are no definitions.
  std::ofstream(path_, std::ios::binary) << good;
  ASSERT_EQ(sqlite_text(path_, "ANALYZE; SELECT 'analyzed'"), "analyzed");
  EXPECT_TRUE(StoreReader::open(path_).ok());
}

TEST_F(StoreOpen, ANewDatabaseIsItsOwnersAlone) {
  const mode_t before = umask(0);
  const auto writer = StoreWriter::open(path_);
  umask(before);
  ASSERT_OK(writer.status());
  ASSERT_OK(submit(**writer, sweep_, "sweep-a").status());
  for (const std::string& name : folder_.names()) {
    struct stat there {};
    ASSERT_EQ(stat(folder_.file(name).c_str(), &there), 0) << name;
    EXPECT_EQ(there.st_mode & 0777, 0600U) << name;
  }
}

}  // namespace
}  // namespace irsig
