#include "schema/store/open_database.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>
#include <vector>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "schema/store/check_schema.h"
#include "schema/store/statements.h"
#include "schema/store/whole_file.h"

namespace irsig {
namespace {

namespace fs = std::filesystem;

constexpr int kVersion = static_cast<int>(std::size(sql::kMigrations));

std::vector<MigrationStep> all_steps() {
  std::vector<MigrationStep> steps;
  for (const sql::Migration& migration : sql::kMigrations)
    steps.push_back({migration.version, migration.script});
  return steps;
}

absl::Status refuse(const std::string& path, std::uint32_t application_id, std::int64_t version) {
  if (application_id != kApplicationId) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": is an SQLite file, but not a signature database"));
  }
  if (version > kVersion) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": has format version ", version,
                                                   "; this irsig knows up to ", kVersion,
                                                   " (update irsig)"));
  }
  return absl::OkStatus();
}

// SQLite reads a journal with the help of a file beside it, which it has to make if there is none.
absl::Status cannot_share(const std::string& path, const FileHeader& header,
                          const absl::Status& status) {
  if (!absl::IsPermissionDenied(status) || !header.write_ahead_log) return status;
  return absl::PermissionDeniedError(
      absl::StrCat(status.message(),
                   ": it has a journal (a run writes it, or was killed), which cannot be read "
                   "where nothing can be written: copy ",
                   path, " and ", path, "-wal together into a folder that you may write to"));
}

// What can be told from the bytes alone, before SQLite gets to touch the file.
absl::Status check_header(const std::string& path, const FileHeader& header) {
  if (!header.is_sqlite)
    return absl::InvalidArgumentError(absl::StrCat(path, ": is not a signature database"));
  return refuse(path, header.application_id, header.user_version);
}

absl::Status check_pragmas(const std::string& path, Database& database) {
  ASSIGN_OR_RETURN(const std::int64_t id, database.integer("PRAGMA application_id"));
  ASSIGN_OR_RETURN(const std::int64_t version, database.integer("PRAGMA user_version"));
  return refuse(path, static_cast<std::uint32_t>(id), version);
}

bool path_exists(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

absl::Status check_regular(const std::string& path) {
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  if (fs::is_directory(status))
    return absl::InvalidArgumentError(absl::StrCat(path, ": is a directory"));
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": is not a regular file"));
  }
  return absl::OkStatus();
}

// Nobody else writes: who keeps the writer waiting is a reader.
absl::Status name_the_reader(const std::string& path, const absl::Status& status) {
  if (!absl::IsUnavailable(status)) return status;
  return absl::UnavailableError(absl::StrCat(
      path,
      ": another program is reading it (a query, a viewer, a copy): try again when it is done"));
}

absl::StatusOr<std::string> journal_mode(Database& database, const char* pragma) {
  ASSIGN_OR_RETURN(Rows rows, database.query(pragma));
  ASSIGN_OR_RETURN(const bool told, rows.next());
  return told ? rows.text() : std::string();
}

// Puts a commit into the journal that changes nothing: from then on the header does not ask for a
// journal that is empty.
absl::Status begin_journal(Database& database) {
  return database.script(absl::StrCat("PRAGMA user_version = ", kVersion));
}

// After a change of the journal's mode that failed: the lock file keeps what it says as long as the
// header asks for a journal that is not there.
void say_no_more_than_needed(WritableDatabase& out) {
  const absl::StatusOr<FileHeader> header = read_file_header(out.path);
  if (!header.ok() || path_exists(out.path + "-journal")) return;
  if (!header->write_ahead_log || has_journal(out.path)) out.lock->say_nothing();
}

absl::Status write_ahead(const std::string& path, WritableDatabase& out) {
  Database& database = *out.database;
  const auto change = [&]() -> absl::Status {
    ASSIGN_OR_RETURN(const auto mode, journal_mode(database, "PRAGMA journal_mode = WAL"));
    if (mode != "wal")
      return absl::FailedPreconditionError(absl::StrCat(
          path, ": its file system cannot share memory between processes: use a local disk"));
    // A close without end_write_ahead() leaves the journal as it is.
    IRSIG_STORE_TRY(database.keep_journal_on_close());
    const absl::Status begun = begin_journal(database);
    if (!begun.ok())
      static_cast<void>(journal_mode(database, "PRAGMA journal_mode = DELETE").status());
    return begun;
  };
  ASSIGN_OR_RETURN(const auto before, journal_mode(database, "PRAGMA journal_mode"));
  if (before != "wal") out.lock->say_whole_without_journal();
  const absl::Status changed = change();
  say_no_more_than_needed(out);
  return changed;
}

absl::Status run_steps(Database& database, std::int64_t from,
                       std::span<const MigrationStep> steps) {
  for (const MigrationStep& step : steps) {
    if (step.version <= from) continue;
    IRSIG_STORE_TRY(database.script(step.script));
    IRSIG_STORE_TRY(database.script(absl::StrCat("PRAGMA user_version = ", step.version)));
  }
  return absl::OkStatus();
}

// One transaction in which tables may be made anew: foreign keys are checked once, at its end.
absl::Status change_format(Database& database, const std::function<absl::Status()>& change) {
  const auto run = [&]() -> absl::Status {
    IRSIG_STORE_TRY(database.script("BEGIN EXCLUSIVE"));
    IRSIG_STORE_TRY(change());
    ASSIGN_OR_RETURN(const std::int64_t lost,
                     database.integer("SELECT count(*) FROM pragma_foreign_key_check()"));
    if (lost > 0)
      return absl::DataLossError(absl::StrCat(lost, " rows name rows that do not exist"));
    return database.script("COMMIT");
  };
  IRSIG_STORE_TRY(database.script("PRAGMA foreign_keys = OFF"));
  const absl::Status status = run();
  if (database.in_transaction()) static_cast<void>(database.script("ROLLBACK"));
  const absl::Status restored = database.script("PRAGMA foreign_keys = ON");
  return status.ok() ? restored : status;
}

// For its owner alone: whoever lets others read it says so with chmod. SQLite would make it with
// 0644; its journals take the file's own mode.
absl::Status make_private_file(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0600);
  if (descriptor >= 0) {
    ::close(descriptor);
    return absl::OkStatus();
  }
  return unusable_file(path, "written", errno);
}

absl::Status create(Database& database) {
  // 16 kB pages: a spectrum (2-5 kB) lies in one page, an image of 20 kB in two. CPU seconds of
  // 2000 completions (tests/benchmark/store_bench.cpp) with pages of 4, 8, 16, 32 kB: 1.09, 0.96,
  // 0.88, 1.02; with 32 kB the file is a quarter larger.
  IRSIG_STORE_TRY(database.script("PRAGMA page_size = 16384"));
  return change_format(database, [&]() -> absl::Status {
    IRSIG_STORE_TRY(database.script(absl::StrCat("PRAGMA application_id = ", kApplicationId)));
    return run_steps(database, 0, all_steps());
  });
}

}  // namespace

void remove_database(const std::string& path) {
  for (const char* suffix : {"", "-journal", "-wal", "-shm"}) ::unlink((path + suffix).c_str());
}

absl::Status migrate(Database& database, std::span<const MigrationStep> steps,
                     const std::function<absl::Status()>& check) {
  ASSIGN_OR_RETURN(const std::int64_t from, database.integer("PRAGMA user_version"));
  const int newest = steps.empty() ? 0 : steps.back().version;
  if (from > newest) {
    return absl::InvalidArgumentError(absl::StrCat("the database has format version ", from,
                                                   "; known are versions up to ", newest));
  }
  if (from == newest) return absl::OkStatus();
  return change_format(database, [&]() -> absl::Status {
    IRSIG_STORE_TRY(run_steps(database, from, steps));
    return check ? check() : absl::OkStatus();
  });
}

absl::StatusOr<WritableDatabase> open_for_writing(const std::string& path) {
  IRSIG_STORE_TRY(check_regular(path));
  WritableDatabase out;
  out.path = real_path(path);
  ASSIGN_OR_RETURN(std::unique_ptr<WriterLock> lock, WriterLock::acquire(out.path, path));
  out.lock = std::move(lock);

  const bool existed = path_exists(out.path);
  bool is_new = !existed;
  // With a hot rollback journal (a creation or migration that was killed) the bytes mean nothing
  // before SQLite has rolled it back; the pragmas are checked below.
  if (existed && !path_exists(out.path + "-journal")) {
    ASSIGN_OR_RETURN(const FileHeader header, read_file_header(out.path));
    is_new = header.empty;
    if (!is_new) IRSIG_STORE_TRY(check_header(path, header));
    if (!is_new) IRSIG_STORE_TRY(check_has_its_journal(path, out.path, true));
  }
  IRSIG_STORE_TRY(check_has_one_name(path, out.path));
  bool keep_file = existed;
  const absl::Cleanup remove_new_file = [&out, &keep_file] {
    if (keep_file) return;
    out.database.reset();
    remove_database(out.path);
  };

  if (!existed) IRSIG_STORE_TRY(make_private_file(out.path));
  ASSIGN_OR_RETURN(std::unique_ptr<Database> database,
                   Database::open(out.path, Database::Mode::kReadWriteCreate));
  out.database = std::move(database);
  Database& opened = *out.database;
  if (existed &&
      !is_new) {  // after a creation that was killed, nothing is left: that is a new file, too
    ASSIGN_OR_RETURN(const std::int64_t tables,
                     opened.integer("SELECT count(*) FROM sqlite_schema"));
    ASSIGN_OR_RETURN(const std::int64_t id, opened.integer("PRAGMA application_id"));
    is_new = tables == 0 && id == 0;
  }
  if (is_new) {
    IRSIG_STORE_TRY(create(opened));
  } else {
    IRSIG_STORE_TRY(check_pragmas(path, opened));
    IRSIG_STORE_TRY(check_old_schema(path, opened));
    const auto check = [&] { return check_schema(path, opened); };
    IRSIG_STORE_TRY(name_the_reader(path, migrate(opened, all_steps(), check)));
    IRSIG_STORE_TRY(check());
  }
  IRSIG_STORE_TRY(name_the_reader(path, write_ahead(path, out)));
  // What a commit writes fits into the cache [kB]: otherwise pages go to the disk and come back.
  IRSIG_STORE_TRY(opened.script("PRAGMA synchronous = FULL; PRAGMA cache_size = -16384"));
  keep_file = true;
  out.created = !existed;
  return out;
}

absl::Status end_write_ahead(WritableDatabase& written) {
  Database& database = *written.database;
  {
    // All that is committed is in the file before anything says so.
    ASSIGN_OR_RETURN(Rows row, database.query("PRAGMA wal_checkpoint(FULL)"));
    RETURN_IF_ERROR(row.next().status());
    const bool busy = row.integer() != 0;
    const std::int64_t frames = row.integer();
    if (busy || row.integer() != frames)
      return absl::UnavailableError(absl::StrCat(written.path, ": is being read"));
  }
  written.lock->say_whole_without_journal();
  absl::Status ended = journal_mode(database, "PRAGMA journal_mode = DELETE").status();
  // The journal may be empty: another program may have folded it in.
  if (!ended.ok() && !has_journal(written.path)) static_cast<void>(begin_journal(database));
  say_no_more_than_needed(written);
  return ended;
}

void leave_journal(WritableDatabase& written) {
  const absl::StatusOr<FileHeader> header = read_file_header(written.path);
  if (header.ok() && header->write_ahead_log && !has_journal(written.path))
    static_cast<void>(begin_journal(*written.database));
}

namespace {

// Up to what a file's own bytes and PRAGMAs say: a signature database, and not a newer one's.
absl::StatusOr<std::unique_ptr<Database>> open_known(const std::string& path, bool as_it_is,
                                                     bool attaches) {
  IRSIG_STORE_TRY(check_regular(path));
  struct stat there {};
  if (::stat(path.c_str(), &there) != 0)
    return errno == ENOENT ? absl::NotFoundError(absl::StrCat(path, ": no such file"))
                           : unusable_file(path, "read", errno);
  const std::string real = real_path(path);
  ASSIGN_OR_RETURN(const FileHeader header, read_file_header(real));
  IRSIG_STORE_TRY(check_header(path, header));
  if (!as_it_is) IRSIG_STORE_TRY(check_has_its_journal(path, real));
  ASSIGN_OR_RETURN(
      std::unique_ptr<Database> database,
      Database::open(real, as_it_is ? Database::Mode::kImmutable : Database::Mode::kReadOnly,
                     attaches));
  if (const absl::Status checked = check_pragmas(path, *database); !checked.ok())
    return cannot_share(path, header, checked);
  return database;
}

}  // namespace

absl::StatusOr<std::unique_ptr<Database>> open_for_reading(const std::string& path, bool attaches) {
  ASSIGN_OR_RETURN(std::unique_ptr<Database> database, open_known(path, false, attaches));
  ASSIGN_OR_RETURN(const std::int64_t version, database->integer("PRAGMA user_version"));
  if (version < kVersion) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": has the older format version ", version,
                     "; open it once for writing (irsig run --resume) to bring it to ", kVersion));
  }
  IRSIG_STORE_TRY(check_schema(path, *database));
  return database;
}

absl::StatusOr<AsItIs> open_as_it_is(const std::string& path) {
  ASSIGN_OR_RETURN(std::unique_ptr<Database> database, open_known(path, true, false));
  ASSIGN_OR_RETURN(const std::int64_t version, database->integer("PRAGMA user_version"));
  AsItIs out{std::move(database), version < kVersion};
  IRSIG_STORE_TRY(out.is_older ? check_old_schema(path, *out.database)
                               : check_schema(path, *out.database));
  return out;
}

}  // namespace irsig
