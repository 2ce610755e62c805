#include "schema/store/open_database.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>
#include <vector>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "schema/store/check_schema.h"
#include "schema/store/statements.h"

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

// What can be told from the bytes alone, before SQLite gets to touch the file.
absl::Status check_header(const std::string& path, const FileHeader& header) {
  if (!header.is_sqlite)
    return absl::InvalidArgumentError(absl::StrCat(path, ": is not a signature database"));
  return refuse(path, header.application_id, header.user_version);
}

absl::Status check_pragmas(const std::string& path, Database& database) {
  const absl::StatusOr<std::int64_t> id = database.integer("PRAGMA application_id");
  if (!id.ok()) return id.status();
  const absl::StatusOr<std::int64_t> version = database.integer("PRAGMA user_version");
  if (!version.ok()) return version.status();
  return refuse(path, static_cast<std::uint32_t>(*id), *version);
}

absl::Status no_lock_file(const std::string& path) {
  return absl::InvalidArgumentError(
      absl::StrCat(path,
                   ": is no regular file, but irsig locks the database by a file of this "
                   "name: remove it"));
}

bool exists(const std::string& path) {
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

absl::Status write_ahead(const std::string& path, Database& database) {
  absl::StatusOr<Rows> rows = database.query("PRAGMA journal_mode = WAL");
  if (!rows.ok()) return rows.status();
  const absl::StatusOr<bool> changed = rows->next();
  if (!changed.ok()) return changed.status();
  if (*changed && rows->text() == "wal") return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(
      path, ": its file system cannot share memory between processes: use a local disk"));
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
    const absl::StatusOr<std::int64_t> lost =
        database.integer("SELECT count(*) FROM pragma_foreign_key_check()");
    if (!lost.ok()) return lost.status();
    if (*lost > 0)
      return absl::DataLossError(absl::StrCat(*lost, " rows name rows that do not exist"));
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
  const int code = errno;
  const std::string message = absl::StrCat(path, ": cannot be written: ", std::strerror(code));
  return code == ENOSPC ? absl::ResourceExhaustedError(message)
                        : absl::PermissionDeniedError(message);
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

std::string real_path(const std::string& path) {
  std::error_code error, absent;
  fs::path real = fs::weakly_canonical(path, error);
  // A link to what does not exist yet: where SQLite will make it.
  for (int links = 0; !error && links < 40 && fs::is_symlink(fs::symlink_status(real, absent));
       ++links) {
    const fs::path target = fs::read_symlink(real, error);
    if (!error) real = fs::weakly_canonical(real.parent_path() / target, error);
  }
  return error || real.empty() ? path : real.string();
}

void remove_database(const std::string& path) {
  for (const char* suffix : {"", "-journal", "-wal", "-shm"}) ::unlink((path + suffix).c_str());
}

absl::StatusOr<std::unique_ptr<WriterLock>> WriterLock::acquire(const std::string& database_path) {
  const std::string path = real_path(database_path) + "-lock";
  // The file may be removed by its last holder between open and flock; then the lock is on a file
  // without a name, and the next round opens the new one.
  for (;;) {
    // Through no link: what it names might be somebody else's. O_NONBLOCK: a FIFO does not wait.
    const int descriptor =
        ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0600);
    if (descriptor < 0) {
      const int code = errno;
      if (code == ELOOP || code == ENXIO || code == EISDIR) return no_lock_file(path);
      const std::string message =
          absl::StrCat(database_path, ": cannot be written: ", std::strerror(code));
      if (code == ENOENT || code == ENOTDIR) return absl::NotFoundError(message);
      if (code == ENOSPC) return absl::ResourceExhaustedError(message);
      return absl::PermissionDeniedError(message);
    }
    std::unique_ptr<WriterLock> lock(new WriterLock(descriptor, path));
    struct stat opened {};
    if (::fstat(descriptor, &opened) != 0 || !S_ISREG(opened.st_mode)) {
      lock->path_.clear();
      return no_lock_file(path);
    }
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
      lock->path_.clear();  // the holder's to remove
      return absl::FailedPreconditionError(absl::StrCat(
          database_path, ": another irsig is writing this database (one writer at a time)"));
    }
    if (lock->holds()) return lock;
    lock->path_.clear();
  }
}

bool WriterLock::holds() const {
  struct stat ours {};
  struct stat named {};
  return ::fstat(descriptor_, &ours) == 0 && ::lstat(path_.c_str(), &named) == 0 &&
         ours.st_ino == named.st_ino && ours.st_dev == named.st_dev;
}

WriterLock::~WriterLock() {
  if (!path_.empty() && holds()) ::unlink(path_.c_str());
  ::close(descriptor_);
}

absl::Status migrate(Database& database, std::span<const MigrationStep> steps,
                     const std::function<absl::Status()>& check) {
  const absl::StatusOr<std::int64_t> from = database.integer("PRAGMA user_version");
  if (!from.ok()) return from.status();
  const int newest = steps.empty() ? 0 : steps.back().version;
  if (*from > newest) {
    return absl::InvalidArgumentError(absl::StrCat("the database has format version ", *from,
                                                   "; known are versions up to ", newest));
  }
  if (*from == newest) return absl::OkStatus();
  return change_format(database, [&]() -> absl::Status {
    IRSIG_STORE_TRY(run_steps(database, *from, steps));
    return check ? check() : absl::OkStatus();
  });
}

absl::StatusOr<WritableDatabase> open_for_writing(const std::string& path) {
  IRSIG_STORE_TRY(check_regular(path));
  WritableDatabase out;
  out.path = real_path(path);
  absl::StatusOr<std::unique_ptr<WriterLock>> lock = WriterLock::acquire(path);
  if (!lock.ok()) return lock.status();
  out.lock = *std::move(lock);

  const bool existed = exists(path);
  bool is_new = !existed;
  // With a hot rollback journal (a creation or migration that was killed) the bytes mean nothing
  // before SQLite has rolled it back; the pragmas are checked below.
  if (existed && !exists(path + "-journal")) {
    const absl::StatusOr<FileHeader> header = read_file_header(path);
    if (!header.ok()) return header.status();
    is_new = header->empty;
    if (!is_new) IRSIG_STORE_TRY(check_header(path, *header));
  }
  bool keep_file = existed;
  const absl::Cleanup remove_new_file = [&out, &keep_file] {
    if (keep_file) return;
    out.database.reset();
    remove_database(out.path);
  };

  if (!existed) IRSIG_STORE_TRY(make_private_file(out.path));
  absl::StatusOr<std::unique_ptr<Database>> database =
      Database::open(path, Database::Mode::kReadWriteCreate);
  if (!database.ok()) return database.status();
  out.database = *std::move(database);
  Database& opened = *out.database;
  if (existed &&
      !is_new) {  // after a creation that was killed, nothing is left: that is a new file, too
    const absl::StatusOr<std::int64_t> tables =
        opened.integer("SELECT count(*) FROM sqlite_schema");
    if (!tables.ok()) return tables.status();
    const absl::StatusOr<std::int64_t> id = opened.integer("PRAGMA application_id");
    if (!id.ok()) return id.status();
    is_new = *tables == 0 && *id == 0;
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
  IRSIG_STORE_TRY(name_the_reader(path, write_ahead(path, opened)));
  // What a commit writes fits into the cache [kB]: otherwise pages go to the disk and come back.
  IRSIG_STORE_TRY(opened.script("PRAGMA synchronous = FULL; PRAGMA cache_size = -16384"));
  keep_file = true;
  out.created = !existed;
  return out;
}

absl::StatusOr<std::unique_ptr<Database>> open_for_reading(const std::string& path, bool attaches) {
  IRSIG_STORE_TRY(check_regular(path));
  if (!exists(path)) return absl::NotFoundError(absl::StrCat(path, ": no such file"));
  const absl::StatusOr<FileHeader> header = read_file_header(path);
  if (!header.ok()) return header.status();
  IRSIG_STORE_TRY(check_header(path, *header));
  // A file in write-ahead mode without its journal and without a writer is complete as it is
  // (somebody copied it); opened in the ordinary way SQLite would create an empty journal beside
  // it.
  const bool alone = header->write_ahead_log && !exists(path + "-wal") && !exists(path + "-lock");
  absl::StatusOr<std::unique_ptr<Database>> database = Database::open(
      path, alone ? Database::Mode::kImmutable : Database::Mode::kReadOnly, attaches);
  if (!database.ok()) return database.status();
  IRSIG_STORE_TRY(check_pragmas(path, **database));
  const absl::StatusOr<std::int64_t> version = (*database)->integer("PRAGMA user_version");
  if (!version.ok()) return version.status();
  if (*version < kVersion) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": has the older format version ", *version,
                     "; open it once for writing (irsig run --resume) to bring it to ", kVersion));
  }
  IRSIG_STORE_TRY(check_schema(path, **database));
  return database;
}

}  // namespace irsig
