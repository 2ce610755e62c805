#include "schema/store/tables/database.h"

#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"

namespace irsig {
namespace {

// How long a statement waits for a lock that another connection holds for a moment (a checkpoint, a
// reader that is just recovering the journal after a kill).
constexpr int kBusyTimeoutMs = 5000;

absl::Status status_of(int code, std::string message) {
  switch (code & 0xff) {
    case SQLITE_FULL:
      return absl::ResourceExhaustedError(std::move(message));
    case SQLITE_NOMEM:
      return absl::ResourceExhaustedError(std::move(message));
    // The written row breaks a rule of its table: the request is wrong, not the database.
    case SQLITE_CONSTRAINT:
    case SQLITE_TOOBIG:
    case SQLITE_MISMATCH:
      return absl::InvalidArgumentError(std::move(message));
    case SQLITE_IOERR:
      return absl::DataLossError(std::move(message));
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return absl::UnavailableError(std::move(message));
    case SQLITE_NOTADB:
      return absl::InvalidArgumentError(std::move(message));
    case SQLITE_CORRUPT:
      return absl::DataLossError(std::move(message));
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
    case SQLITE_READONLY:
      return absl::PermissionDeniedError(std::move(message));
    default:
      return absl::InternalError(std::move(message));
  }
}

// SQLite says "disk I/O error" of every write that fails, unless the disk is full.
std::string message_of(sqlite3* handle) {
  const bool write = sqlite3_extended_errcode(handle) == SQLITE_IOERR_WRITE;
  return absl::StrCat(sqlite3_errmsg(handle),
                      write ? ": a file could not be written; its size limit (ulimit -f) or a "
                              "quota may be reached"
                            : "");
}

std::string percent_encoded(std::string_view path) {
  std::string out;
  for (const char c : path) {
    if (c == '%' || c == '?' || c == '#') {
      absl::StrAppend(&out, "%", absl::Hex(static_cast<unsigned char>(c), absl::kZeroPad2));
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace

Rows::Rows(Rows&& other) noexcept
    : statement_(std::exchange(other.statement_, nullptr)), column_(other.column_) {}

Rows::~Rows() {
  if (statement_ == nullptr) return;
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
}

absl::StatusOr<bool> Rows::next() {
  column_ = 0;
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  sqlite3* handle = sqlite3_db_handle(statement_);
  const char* file = sqlite3_db_filename(handle, "main");
  return status_of(code, absl::StrCat(file == nullptr ? "" : file, ": ", message_of(handle)));
}

std::int64_t Rows::integer() { return sqlite3_column_int64(statement_, column_++); }

double Rows::real() { return sqlite3_column_double(statement_, column_++); }

std::string Rows::text() { return std::string(blob()); }

std::string_view Rows::blob() {
  const int column = column_++;
  const void* bytes = sqlite3_column_blob(statement_, column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
  return {static_cast<const char*>(bytes), bytes == nullptr ? 0 : size};
}

Rows::Type Rows::type() const {
  switch (sqlite3_column_type(statement_, column_)) {
    case SQLITE_INTEGER:
      return Type::kInteger;
    case SQLITE_FLOAT:
      return Type::kReal;
    case SQLITE_TEXT:
      return Type::kText;
    case SQLITE_BLOB:
      return Type::kBlob;
    default:
      return Type::kNull;
  }
}

int Rows::place_of(std::string_view name) const {
  for (int i = 0; i < sqlite3_column_count(statement_); ++i)
    if (name == sqlite3_column_name(statement_, i)) return i;
  return -1;
}

bool Rows::at_end() const { return column_ >= sqlite3_data_count(statement_); }

absl::StatusOr<std::unique_ptr<Database>> Database::open(const std::string& path, Mode mode,
                                                         bool attaches) {
  const bool writes = mode == Mode::kReadWriteCreate;
  std::string uri = absl::StrCat("file:", percent_encoded(path), "?mode=", writes ? "rwc" : "ro");
  if (mode == Mode::kImmutable) uri += "&immutable=1";
  // The flags are those of attached databases, too; the address may only take from them.
  const int flags = writes     ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE
                    : attaches ? SQLITE_OPEN_READWRITE
                               : SQLITE_OPEN_READONLY;
  sqlite3* handle = nullptr;
  const int code =
      sqlite3_open_v2(uri.c_str(), &handle, flags | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr);
  // The handle exists even when opening failed; the destructor closes it.
  std::unique_ptr<Database> database(new Database(handle, path));
  if (code != SQLITE_OK) return database->error("open");
  sqlite3_extended_result_codes(handle, 1);
  sqlite3_busy_timeout(handle, kBusyTimeoutMs);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  IRSIG_STORE_TRY(database->script("PRAGMA foreign_keys = ON"));
  return database;
}

Database::~Database() {
  for (const auto& [sql, statement] : statements_) sqlite3_finalize(statement);
  sqlite3_close_v2(handle_);
}

absl::Status Database::script(const std::string& text) {
  if (sqlite3_exec(handle_, text.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) {
    return error(text.size() < 80 ? text : "a script");
  }
  return absl::OkStatus();
}

absl::Status Database::attach(const char* sql, const std::string& path) {
  return run(sql, absl::StrCat("file:", percent_encoded(path), "?mode=rw"));
}

absl::StatusOr<sqlite3_stmt*> Database::prepared(const char* sql) {
  const auto [place, is_new] = statements_.try_emplace(sql, nullptr);
  if (!is_new) return place->second;
  if (sqlite3_prepare_v3(handle_, sql, -1, SQLITE_PREPARE_PERSISTENT, &place->second, nullptr) !=
      SQLITE_OK) {
    statements_.erase(place);
    return error(sql);
  }
  return place->second;
}

absl::Status Database::error(const std::string& doing) const {
  const int code = sqlite3_extended_errcode(handle_);
  return status_of(code, absl::StrCat(path_, ": ", message_of(handle_), " (", doing, ")"));
}

bool Database::bind(sqlite3_stmt* statement, int parameter, std::int64_t value) {
  return sqlite3_bind_int64(statement, parameter, value) == SQLITE_OK;
}

bool Database::bind(sqlite3_stmt* statement, int parameter, double value) {
  return sqlite3_bind_double(statement, parameter, value) == SQLITE_OK;
}

// Copied: a bound string is often a temporary, and short.
bool Database::bind(sqlite3_stmt* statement, int parameter, std::string_view value) {
  return sqlite3_bind_text64(statement, parameter, value.data() == nullptr ? "" : value.data(),
                             value.size(), SQLITE_TRANSIENT, SQLITE_UTF8) == SQLITE_OK;
}

bool Database::bind(sqlite3_stmt* statement, int parameter, Blob value) {
  return sqlite3_bind_blob64(statement, parameter,
                             value.bytes.data() == nullptr ? "" : value.bytes.data(),
                             value.bytes.size(), SQLITE_STATIC) == SQLITE_OK;
}

bool Database::bind(sqlite3_stmt* statement, int parameter, std::nullopt_t) {
  return sqlite3_bind_null(statement, parameter) == SQLITE_OK;
}

absl::Status Database::write_blob(const char* table, const char* column, std::int64_t row,
                                  std::uint64_t offset, std::string_view bytes) {
  sqlite3_blob* blob = nullptr;
  int code = sqlite3_blob_open(handle_, "main", table, column, row, 1, &blob);
  if (code == SQLITE_OK)
    code = sqlite3_blob_write(blob, bytes.data(), static_cast<int>(bytes.size()),
                              static_cast<int>(offset));
  const absl::Status status = code == SQLITE_OK ? absl::OkStatus() : error("write a blob");
  sqlite3_blob_close(blob);
  return status;
}

void Database::wait_for_locks_ms(int milliseconds) { sqlite3_busy_timeout(handle_, milliseconds); }

absl::Status Database::keep_journal_on_close() {
  return sqlite3_db_config(handle_, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr) == SQLITE_OK
             ? absl::OkStatus()
             : error("keep the journal");
}

std::int64_t Database::last_insert_rowid() const { return sqlite3_last_insert_rowid(handle_); }

std::uint64_t Database::changes() const {
  return static_cast<std::uint64_t>(sqlite3_changes64(handle_));
}

bool Database::in_transaction() const { return sqlite3_get_autocommit(handle_) == 0; }

absl::StatusOr<std::unique_ptr<Savepoint>> Savepoint::open(Database& database) {
  IRSIG_STORE_TRY(database.run("SAVEPOINT step"));
  return std::unique_ptr<Savepoint>(new Savepoint(database));
}

Savepoint::~Savepoint() {
  // After a full disk SQLite may already have rolled the whole transaction back; then there is
  // nothing to undo.
  if (!open_ || !database_.in_transaction()) return;
  static_cast<void>(database_.run("ROLLBACK TO step"));
  static_cast<void>(database_.run("RELEASE step"));
}

absl::Status Savepoint::keep() {
  IRSIG_STORE_TRY(database_.run("RELEASE step"));
  open_ = false;
  return absl::OkStatus();
}

absl::Status unusable_file(const std::string& path, std::string_view used, int error) {
  const std::string message =
      absl::StrCat(path, ": cannot be ", std::string(used), ": ", std::strerror(error));
  switch (error) {
    case ENOENT:
    case ENOTDIR:
      return absl::NotFoundError(message);
    case EACCES:
    case EPERM:
    case EROFS:
    case ELOOP:
    case ENAMETOOLONG:
    case EISDIR:
      return absl::InvalidArgumentError(message);
    case ENOSPC:
    case EDQUOT:
      return absl::ResourceExhaustedError(message);
    default:
      return absl::UnavailableError(message);
  }
}

absl::StatusOr<FileHeader> read_file_header(const std::string& path) {
  constexpr std::size_t kHeaderBytes = 100;
  sqlite3_vfs* vfs = sqlite3_vfs_find(nullptr);
  std::vector<char> full_path(static_cast<std::size_t>(vfs->mxPathname) + 1);
  if (vfs->xFullPathname(vfs, path.c_str(), vfs->mxPathname, full_path.data()) >= SQLITE_ERROR &&
      full_path[0] == '\0') {
    return absl::InvalidArgumentError(absl::StrCat(path, ": not a usable path"));
  }
  // SQLite expects a main database's name to be followed by its (here absent) URI parameters.
  std::string name(full_path.data());
  name.append(4, '\0');
  std::vector<std::max_align_t> storage(
      static_cast<std::size_t>(vfs->szOsFile) / sizeof(std::max_align_t) + 1);
  auto* file = reinterpret_cast<sqlite3_file*>(storage.data());
  std::memset(static_cast<void*>(file), 0, static_cast<std::size_t>(vfs->szOsFile));
  const int opened =
      vfs->xOpen(vfs, name.c_str(), file, SQLITE_OPEN_READONLY | SQLITE_OPEN_MAIN_DB, nullptr);
  if (opened != SQLITE_OK) {
    if (file->pMethods != nullptr) file->pMethods->xClose(file);
    // SQLite does not say why.
    const int file_or_error = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (file_or_error >= 0) ::close(file_or_error);
    return unusable_file(path, "read", file_or_error < 0 ? errno : EIO);
  }
  sqlite3_int64 size = 0;
  unsigned char bytes[kHeaderBytes] = {};
  const int sized = file->pMethods->xFileSize(file, &size);
  const int read = size >= static_cast<sqlite3_int64>(kHeaderBytes)
                       ? file->pMethods->xRead(file, bytes, static_cast<int>(kHeaderBytes), 0)
                       : SQLITE_OK;
  file->pMethods->xClose(file);
  if (sized != SQLITE_OK || read != SQLITE_OK)
    return absl::DataLossError(absl::StrCat(path, ": cannot be read (a failing disk?)"));
  // Offsets: https://www.sqlite.org/fileformat.html, section 1.3.
  const auto big_endian = [&bytes](std::size_t at) {
    return static_cast<std::uint32_t>(bytes[at] << 24 | bytes[at + 1] << 16 | bytes[at + 2] << 8 |
                                      bytes[at + 3]);
  };
  return FileHeader{.empty = size == 0,
                    .is_sqlite = std::memcmp(bytes, "SQLite format 3", 16) == 0,
                    .write_ahead_log = bytes[18] == 2,
                    .application_id = big_endian(68),
                    .user_version = big_endian(60)};
}

}  // namespace irsig
