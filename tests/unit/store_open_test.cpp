// Which files are opened, which are refused, and what stays behind.

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <sstream>

#include "schema/store/open_database.h"
#include "schema/store/statements.h"
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
  EXPECT_EQ(sqlite_text(path_, "PRAGMA user_version"), kNewestFormat);
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
  // As a directory of the database's own name: SQLite cannot make its journal there.
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

// What version 2 stored stays, bit for bit; what it did not compute is known to be missing.
TEST_F(StoreOpen, AFileOfVersion2IsMigrated) {
  ASSERT_NO_FATAL_FAILURE(write());
  const auto before = StoreReader::open(path_).value()->find({}).value();
  ASSERT_EQ(back_to_version_2(path_), "older");
  const absl::Status refused = StoreReader::open(path_).status();
  EXPECT_NE(refused.message().find("has the older format version 2"), absl::string_view::npos);
  ASSERT_OK(StoreWriter::open(path_).value()->finish());
  EXPECT_EQ(sqlite_text(path_, "PRAGMA user_version"), kNewestFormat);
  EXPECT_EQ(sqlite_text(path_,
                        "SELECT count(*) FROM job_view WHERE kind = 'view' AND state = 'done'"
                        " AND viewpoint_index IS NOT NULL AND unmet_needs = 0"),
            "4");
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM attempt JOIN job USING (job_id)"), "4")
      << "the rows that name a job stay";
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM pragma_foreign_key_check()"), "0");
  EXPECT_EQ(sqlite_text(path_,
                        "SELECT count(*) FROM signature_view WHERE path_transmittance IS NULL"
                        " AND contrast_intensity_w_sr IS NULL AND warning IS NULL"),
            "16");
  EXPECT_EQ(sqlite_text(path_, "PRAGMA integrity_check"), "ok");
  auto reader = StoreReader::open(path_).value();
  const auto after = reader->find({}).value();
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(after[i].intensity_w_sr, before[i].intensity_w_sr);
    EXPECT_EQ(after[i].quadrature_bound_w_sr, before[i].quadrature_bound_w_sr);
    EXPECT_EQ(after[i].build_id, before[i].build_id);
    EXPECT_TRUE(std::isnan(after[i].contrast_intensity_w_sr));
    EXPECT_TRUE(std::isnan(after[i].path_radiance_w_m2_sr));
    for (std::size_t q = 0; q < kQuantities.size(); ++q) {
      const double now = after[i].*kQuantityMember[q], then = before[i].*kQuantityMember[q];
      EXPECT_TRUE(kQuantities[q].since_format > 2 ? std::isnan(now) : now == then)
          << kQuantities[q].name;
    }
    EXPECT_EQ(after[i].guarded_negative, std::nullopt);
    const auto spectrum = reader->spectrum(after[i].signature_id);
    ASSERT_OK(spectrum.status());
    EXPECT_EQ(spectrum->apparent_spectral_intensity_stderr_w_sr_um_size(), 5);
    EXPECT_EQ(spectrum->contrast_spectral_intensity_w_sr_um_size(), 0);
    EXPECT_EQ(spectrum->path_radiance_w_m2_sr_um_size(), 0);
  }
  // A contrast that is not known has no error either.
  SignatureFilter filter;
  filter.max_relative_error = 1e9;
  filter.error_of = SignatureQuantity::kContrastIntensity;
  EXPECT_TRUE(reader->find(filter)->empty());
  EXPECT_EQ(reader->digest()->size(), 64U);
}

// A file that version 7 made takes a reason to stop that it did not know.
TEST_F(StoreOpen, AFileOfVersion7LearnsThatAFloorWasReached) {
  std::vector<MigrationStep> of_7;
  for (const sql::Migration& m : sql::kMigrations)
    if (m.version <= 7) of_7.push_back({m.version, m.script});
  {
    auto opened = Database::open(path_, Database::Mode::kReadWriteCreate);
    ASSERT_OK(opened.status());
    ASSERT_OK((*opened)->script(absl::StrCat("PRAGMA application_id = ", kApplicationId)));
    ASSERT_OK(migrate(**opened, of_7));
  }
  ASSERT_NO_FATAL_FAILURE(write());
  const auto before = StoreReader::open(path_).value()->find({}).value();
  ASSERT_EQ(before.size(), 16U);
  auto writer = StoreWriter::open(path_).value();
  SweepShape warmer;
  warmer.hull_temperature_k = 300;  // every job is stale
  sweep_ = make_sweep(warmer);
  ASSERT_OK(submit(*writer, sweep_, "sweep-b").status());
  ASSERT_OK(writer->begin());
  const QueuedJob job = writer->lease_next("w", 0).value().value();
  schema::JobResult result = make_result(sweep_, job.spec);
  const int rows = result.view().row_size();
  for (schema::SignatureRow& row : *result.mutable_view()->mutable_row()) {
    row.set_stop_reason(schema::STOP_REASON_FLOOR_REACHED);
    row.set_backface_fraction(0);
  }
  ASSERT_OK(writer->complete(job.fencing_token, result, "w"));
  ASSERT_OK(writer->commit());
  ASSERT_OK(writer->finish());
  EXPECT_EQ(sqlite_text(path_,
                        "SELECT count(*) FROM signature_view WHERE stop_reason = "
                        "'floor_reached' AND warning NOT LIKE '%back faces%'"),
            absl::StrCat(rows));
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM spectrum JOIN signature USING (signature_id)"),
            "16");
  EXPECT_EQ(sqlite_text(path_, "PRAGMA integrity_check"), "ok");
  auto reader = StoreReader::open(path_).value();
  const StoredOutcome outcome = reader->outcome(sweep_.sweep().name()).value();
  ASSERT_EQ(outcome.stop.size(), 1U) << "rows that wait for their replacement are not counted";
  EXPECT_EQ(outcome.stop[0].first, "floor_reached");
  EXPECT_EQ(outcome.stop[0].second, static_cast<std::uint64_t>(rows));
  EXPECT_EQ(outcome.backface_views, 0U);
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
                        "UPDATE signature SET backface_fraction = NULL; UPDATE signature SET "
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
  // And no number of a row is in the file without being in the catalogue.
  const std::string numbers =
      sqlite_text(path_, "SELECT count(*) FROM pragma_table_info('signature') WHERE type = 'REAL'");
  EXPECT_EQ(numbers, std::to_string(kQuantities.size() + 2)) << "and the sun's two angles";
}

// What is bound by name comes back under its name.
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

// The mechanism, on steps made for the test.
TEST_F(StoreOpen, AMigrationThatLosesRowsIsNone) {
  auto opened = Database::open(path_, Database::Mode::kReadWriteCreate);
  ASSERT_OK(opened.status());
  Database& database = **opened;
  const MigrationStep first = {
      1,
      "CREATE TABLE t (x INTEGER PRIMARY KEY) STRICT; INSERT INTO t VALUES (1);"
      "CREATE TABLE u (x INTEGER REFERENCES t) STRICT;"
      "INSERT INTO u VALUES (1)"};
  const MigrationStep losing = {2, "DELETE FROM t"};
  ASSERT_OK(migrate(database, std::vector{first}));
  EXPECT_TRUE(absl::IsDataLoss(migrate(database, std::vector{first, losing})));
  EXPECT_EQ(*database.integer("SELECT count(*) FROM t"), 1);
  EXPECT_EQ(*database.integer("PRAGMA user_version"), 1);
  EXPECT_EQ(*database.integer("PRAGMA foreign_keys"), 1);
}

TEST_F(StoreOpen, MigrationsRunInOrderOnceAndAllOrNothing) {
  auto opened = Database::open(path_, Database::Mode::kReadWriteCreate);
  ASSERT_OK(opened.status());
  Database& database = **opened;
  const MigrationStep first = {1, "CREATE TABLE t (x INTEGER) STRICT; INSERT INTO t VALUES (1)"};
  const MigrationStep second = {2, "ALTER TABLE t ADD COLUMN y INTEGER; UPDATE t SET y = x + 1"};
  const MigrationStep broken = {3, "UPDATE t SET y = 99; UPDATE no_such_table SET z = 1"};
  ASSERT_OK(migrate(database, std::vector{first}));
  ASSERT_OK(migrate(database, std::vector{first}));
  ASSERT_OK(migrate(database, std::vector{first, second}));
  EXPECT_EQ(*database.integer("PRAGMA user_version"), 2);
  EXPECT_EQ(*database.integer("SELECT y FROM t"), 2);
  EXPECT_FALSE(migrate(database, std::vector{first, second, broken}).ok());
  EXPECT_EQ(*database.integer("PRAGMA user_version"), 2);
  EXPECT_EQ(*database.integer("SELECT y FROM t"), 2);
  EXPECT_TRUE(absl::IsInvalidArgument(migrate(database, std::vector{first})));
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
  // What SQLite notes for itself is no definition.
  std::ofstream(path_, std::ios::binary) << good;
  ASSERT_EQ(sqlite_text(path_, "ANALYZE; SELECT 'analyzed'"), "analyzed");
  EXPECT_TRUE(StoreReader::open(path_).ok());
}

// Its triggers would run while it is migrated.
TEST_F(StoreOpen, AnOlderDatabaseWithATriggerIsNotMigrated) {
  ASSERT_NO_FATAL_FAILURE(write());
  ASSERT_EQ(back_to_version_4(path_), "older");
  const std::string older = bytes_of(path_);
  ASSERT_EQ(sqlite_text(path_,
                        "CREATE TRIGGER harmless AFTER INSERT ON job BEGIN DELETE FROM "
                        "asset; END; SELECT 'made'"),
            "made");
  const std::string before = bytes_of(path_);
  const absl::Status status = StoreWriter::open(path_).status();
  EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
  EXPECT_NE(status.message().find("trigger harmless"), absl::string_view::npos) << status;
  EXPECT_EQ(bytes_of(path_), before);
  std::ofstream(path_, std::ios::binary) << older;
  ASSERT_EQ(sqlite_text(path_, "ALTER TABLE provenance ADD COLUMN remark TEXT; SELECT 'made'"),
            "made");
  EXPECT_TRUE(absl::IsInvalidArgument(StoreWriter::open(path_).status()));
  EXPECT_EQ(sqlite_text(path_, "PRAGMA user_version"), "4") << "undone";
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
