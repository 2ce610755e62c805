#include "schema/store/open_database.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"
#include "schema/store/tables/check_schema.h"
#include "schema/store/tables/statements.h"
#include "schema/store/whole_file.h"

namespace irsig {
namespace {

namespace fs = std::filesystem;

absl::Status refuse(const std::string& path, std::uint32_t application_id, std::int64_t version) {
  if (application_id != kApplicationId) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": is an SQLite file, but not a signature database"));
  }
  if (version > kFormat) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": has format version ", version,
                                                   "; this irsig knows up to ", kFormat,
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

// Checks the file's first bytes, before SQLite touches the file.
absl::Status check_header(const std::string& path, const FileHeader& header) {
  if (!header.is_sqlite)
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": is not a signature database",
                     path.ends_with(".toml")
                         ? absl::StrCat(": `irsig run ", path, " --db NAME.sigdb` computes one")
                         : ""));
  return refuse(path, header.application_id, header.user_version);
}

// The program that wrote a file of an older format: " (build ...)", or empty. Nobody has checked
// the file's definitions: a view in the place of the table is not run.
std::string writer_of(Database& database) {
  absl::StatusOr<Rows> row = database.query(
      "SELECT (SELECT substr(build_id, 1, 100) FROM provenance LIMIT 1) FROM sqlite_schema "
      "WHERE type = 'table' AND name = 'provenance'");
  if (!row.ok() || !row->next().value_or(false) || row->is_null()) return "";
  return absl::StrCat(" (build ", row->text(), ")");
}

absl::Status check_pragmas(const std::string& path, Database& database) {
  ASSIGN_OR_RETURN(const std::int64_t id, database.integer("PRAGMA application_id"));
  ASSIGN_OR_RETURN(const std::int64_t version, database.integer("PRAGMA user_version"));
  IRSIG_STORE_TRY(refuse(path, static_cast<std::uint32_t>(id), version));
  if (version == kFormat) return absl::OkStatus();
  return absl::InvalidArgumentError(one_line(absl::StrCat(
      path, ": has format version ", version,
      ", of an irsig before the first release; this irsig reads version ", kFormat,
      ": run the sweep again into a new file, or read this one with the irsig that wrote it",
      writer_of(database))));
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
  return database.script(absl::StrCat("PRAGMA user_version = ", kFormat));
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
  return database.script(absl::StrCat("BEGIN EXCLUSIVE; ", sql::create, "COMMIT"));
}

}  // namespace

void remove_database(const std::string& path) {
  for (const char* suffix : {"", "-journal", "-wal", "-shm"}) ::unlink((path + suffix).c_str());
}

absl::StatusOr<WritableDatabase> open_for_writing(const std::string& path) {
  IRSIG_STORE_TRY(check_regular(path));
  WritableDatabase out;
  out.path = real_path(path);
  ASSIGN_OR_RETURN(std::unique_ptr<WriterLock> lock, WriterLock::acquire(out.path, path));
  out.lock = std::move(lock);

  const bool existed = path_exists(out.path);
  bool is_new = !existed;
  // With a hot rollback journal (a creation that was killed) the bytes mean nothing before SQLite
  // has rolled it back; the pragmas are checked below.
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
  // A close without end_write_ahead() leaves the journal as it is, also that of a file that is
  // refused below.
  IRSIG_STORE_TRY(opened.keep_journal_on_close());
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
    IRSIG_STORE_TRY(check_schema(path, opened));
  }
  IRSIG_STORE_TRY(name_the_reader(path, write_ahead(path, out)));
  // The cache [kB] holds all pages of a commit: otherwise pages are written to disk and read back.
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
  IRSIG_STORE_TRY(check_schema(path, *database));
  return database;
}

}  // namespace

absl::StatusOr<std::unique_ptr<Database>> open_for_reading(const std::string& path, bool attaches) {
  return open_known(path, false, attaches);
}

absl::StatusOr<std::unique_ptr<Database>> open_as_it_is(const std::string& path) {
  return open_known(path, true, false);
}

}  // namespace irsig
