#pragma once

#include <concepts>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/status_macros.h"

struct sqlite3;
struct sqlite3_stmt;

namespace irsig {

// Bytes for a BLOB column; the caller keeps them alive until the statement has run.
struct Blob {
  std::string_view bytes;
};

// A running statement. It returns to its database's cache when it is destroyed, so that one
// statement text runs at most once at a time. Move-only.
class Rows {
 public:
  explicit Rows(sqlite3_stmt* statement) : statement_(statement) {}
  Rows(Rows&& other) noexcept;
  Rows& operator=(Rows&&) = delete;
  ~Rows();

  // Steps to the next row; returns false if there is none.
  absl::StatusOr<bool> next();

  // Columns of the current row, from left to right: every call reads the next one.
  std::int64_t integer();
  std::uint64_t count() { return static_cast<std::uint64_t>(integer()); }
  double real();
  std::string text();
  // Reads the bytes of the current column; the view is valid until the next step.
  std::string_view blob();
  // Type of the column that would be read next.
  enum class Type { kInteger, kReal, kText, kBlob, kNull };
  Type type() const;
  bool is_null() const { return type() == Type::kNull; }
  bool at_end() const;  // every column of the row was read
  // Returns the index of a column by its name, for read_at(). -1: there is no such column.
  int place_of(std::string_view name) const;
  void read_at(int place) { column_ = place; }

 private:
  sqlite3_stmt* statement_;
  int column_ = 0;
};

// One SQLite connection: the only place of the project that calls SQLite. Not thread-safe.
class Database {
 public:
  enum class Mode {
    kReadWriteCreate,
    kReadOnly,
    kImmutable,  // read-only, without writers: no lock, no journal
  };
  // Opens a database. attaches: if true, another database may be attached for writing, whatever the
  // mode of this one.
  static absl::StatusOr<std::unique_ptr<Database>> open(const std::string& path, Mode mode,
                                                        bool attaches = false);
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;
  ~Database();

  // Runs a script of statements without parameters.
  absl::Status script(const std::string& text);

  // Attaches an existing database for writing, under the schema name in `sql` ("ATTACH ?1 AS
  // name").
  absl::Status attach(const char* sql, const std::string& path);

  // Starts a statement with its parameters bound in order (integers, doubles, strings, Blob,
  // std::nullopt for NULL). `sql` must be a literal: its address is the key of the statement cache.
  template <typename... Values>
  absl::StatusOr<Rows> query(const char* sql, const Values&... values) {
    ASSIGN_OR_RETURN(sqlite3_stmt * statement, prepared(sql));
    int parameter = 0;
    const bool bound = (bind(statement, ++parameter, values) && ...);
    Rows rows(statement);
    if (!bound) return error(sql);
    return rows;
  }

  // Like query(), for a statement that returns no rows.
  template <typename... Values>
  absl::Status run(const char* sql, const Values&... values) {
    ASSIGN_OR_RETURN(Rows rows, query(sql, values...));
    return rows.next().status();
  }

  // Returns the first column of the first row as an integer. NOT_FOUND: there is no row.
  template <typename... Values>
  absl::StatusOr<std::int64_t> integer(const char* sql, const Values&... values) {
    ASSIGN_OR_RETURN(Rows rows, query(sql, values...));
    ASSIGN_OR_RETURN(bool found, rows.next());
    if (!found) return absl::NotFoundError("no such row");
    return rows.integer();
  }

  // Overwrites a part of an existing value that is long enough.
  absl::Status write_blob(const char* table, const char* column, std::int64_t row,
                          std::uint64_t offset, std::string_view bytes);

  // Sets the time that statements wait for a lock of another connection (as opened: 5 s).
  void wait_for_locks_ms(int milliseconds);

  // Keeps the journal when the last connection closes; SQLite would otherwise fold the journal into
  // the database file and remove it.
  absl::Status keep_journal_on_close();

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::int64_t last_insert_rowid() const;
  [[nodiscard]] std::uint64_t changes() const;  // rows changed by the last statement
  [[nodiscard]] bool in_transaction() const;

 private:
  Database(sqlite3* handle, std::string path) : handle_(handle), path_(std::move(path)) {}
  absl::StatusOr<sqlite3_stmt*> prepared(const char* sql);
  absl::Status error(const std::string& doing) const;

  static bool bind(sqlite3_stmt* statement, int parameter, std::int64_t value);
  static bool bind(sqlite3_stmt* statement, int parameter, double value);
  static bool bind(sqlite3_stmt* statement, int parameter, std::string_view value);
  static bool bind(sqlite3_stmt* statement, int parameter, Blob value);
  static bool bind(sqlite3_stmt* statement, int parameter, std::nullopt_t);
  template <std::integral Integer>
  static bool bind(sqlite3_stmt* statement, int parameter, Integer value) {
    return bind(statement, parameter, static_cast<std::int64_t>(value));
  }
  static bool bind(sqlite3_stmt* statement, int parameter, const char* value) {
    return bind(statement, parameter, std::string_view(value));
  }
  static bool bind(sqlite3_stmt* statement, int parameter, const std::string& value) {
    return bind(statement, parameter, std::string_view(value));
  }
  template <typename Value>
  static bool bind(sqlite3_stmt* statement, int parameter, const std::optional<Value>& value) {
    return value ? bind(statement, parameter, *value) : bind(statement, parameter, std::nullopt);
  }

  sqlite3* handle_;
  std::string path_;
  std::unordered_map<const char*, sqlite3_stmt*> statements_;
};

// A savepoint inside a transaction: later changes are undone unless keep() succeeds.
class Savepoint {
 public:
  static absl::StatusOr<std::unique_ptr<Savepoint>> open(Database& database);
  ~Savepoint();
  absl::Status keep();

 private:
  explicit Savepoint(Database& database) : database_(database) {}
  Database& database_;
  bool open_ = true;
};

// Returns the status for an error number of a file that a user has named. used: "read" or
// "written". NOT_FOUND and INVALID_ARGUMENT where another name or permission corrects it,
// RESOURCE_EXHAUSTED for a full disk, UNAVAILABLE otherwise.
[[nodiscard]] absl::Status unusable_file(const std::string& path, std::string_view used, int error);

// Facts from the first 100 bytes of a file, read through SQLite's own file layer. POSIX locks are
// per process: a plain open and close of the file would drop the locks that this process holds on
// it through another connection.
struct FileHeader {
  bool empty;
  bool is_sqlite;
  bool write_ahead_log;
  std::uint32_t application_id;
  std::uint32_t user_version;
};
[[nodiscard]] absl::StatusOr<FileHeader> read_file_header(const std::string& path);

}  // namespace irsig

// Returns from the enclosing function when `expression` (an absl::Status) is not OK.
#define IRSIG_STORE_TRY(expression)                                                        \
  do {                                                                                     \
    if (absl::Status irsig_status = (expression); !irsig_status.ok()) return irsig_status; \
  } while (false)
