#include "schema/store/tables/check_schema.h"

#include <map>
#include <memory>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"
#include "schema/store/tables/statements.h"

namespace irsig {
namespace {

// "view signature_view" -> its statement, without comments and with single spaces.
using Definitions = std::map<std::string, std::string>;

// Removes comments and blanks from a table definition: SQLite keeps the text that created the
// table, and equal definitions may differ in these.
std::string without_layout(const std::string& sql) {
  std::string out;
  bool space = false;
  for (std::size_t i = 0; i < sql.size();) {
    const char c = sql[i];
    if (sql.compare(i, 2, "--") == 0) {
      i = std::min(sql.find('\n', i), sql.size());
      space = true;
    } else if (sql.compare(i, 2, "/*") == 0) {
      const std::size_t end = sql.find("*/", i + 2);
      i = end == std::string::npos ? sql.size() : end + 2;
      space = true;
    } else if (absl::ascii_isspace(static_cast<unsigned char>(c))) {
      ++i;
      space = true;
    } else {
      const bool tight = out.empty() || c == ')' || c == ',' || out.back() == '(';
      if (space && !tight) out += ' ';
      space = false;
      if (c == '\'' || c == '"') {  // a text, as it is
        const std::size_t end = std::min(sql.find(c, i + 1), sql.size() - 1);
        out.append(sql, i, end + 1 - i);
        i = end + 1;
      } else {
        out += c;
        ++i;
      }
    }
  }
  return out;
}

absl::StatusOr<Definitions> definitions_of(Database& database) {
  Definitions out;
  ASSIGN_OR_RETURN(Rows row,
                   database.query("SELECT type, name, coalesce(sql, '') FROM sqlite_schema"));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return out;
    const std::string type = row.text(), name = row.text();
    if (absl::StartsWith(name, "sqlite_stat")) continue;
    out[absl::StrCat(type, " ", name)] = without_layout(row.text());
  }
}

absl::StatusOr<Definitions> make_built_in() {
  ASSIGN_OR_RETURN(std::unique_ptr<Database> memory,
                   Database::open(":memory:", Database::Mode::kReadWriteCreate));
  IRSIG_STORE_TRY(memory->script(sql::create));
  return definitions_of(*memory);
}

// Made once for a process.
const absl::StatusOr<Definitions>& built_in() {
  static const absl::StatusOr<Definitions> made = make_built_in();
  return made;
}

absl::Status foreign(const std::string& path, const std::string& what) {
  return absl::InvalidArgumentError(one_line(
      absl::StrCat(path, ": ", what, ": another program has changed it, and it is not trusted")));
}

}  // namespace

absl::Status check_schema(const std::string& path, Database& database) {
  const absl::StatusOr<Definitions>& expected = built_in();
  if (!expected.ok()) return expected.status();
  ASSIGN_OR_RETURN(const Definitions there, definitions_of(database));
  for (const auto& [name, sql] : there) {
    const auto known = expected->find(name);
    if (known == expected->end())
      return foreign(path, absl::StrCat("has the ", name, ", which is none of the format's"));
    if (known->second != sql)
      return foreign(path, absl::StrCat("its ", name, " is not defined as the format has it"));
  }
  for (const auto& [name, sql] : *expected)
    if (!there.contains(name)) return foreign(path, absl::StrCat("lacks the ", name));
  return absl::OkStatus();
}

}  // namespace irsig
