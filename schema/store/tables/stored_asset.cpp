#include "schema/store/tables/stored_asset.h"

#include <string_view>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "schema/store/tables/sha256.h"
#include "schema/store/tables/statements.h"

namespace irsig {
namespace {

absl::Status damaged(Database& database, const std::string& sha256) {
  ASSIGN_OR_RETURN(const std::string what, describe_asset(database, sha256));
  return absl::DataLossError(absl::StrCat(database.path(), ": the asset ", what,
                                          " is damaged: its bytes have another SHA-256; ",
                                          how_to_replace_asset(database.path())));
}

// Calls read(bytes), which are valid until it returns, if they are those of the hash.
template <typename Read>
absl::Status with_asset(Database& database, const std::string& sha256, const Read& read) {
  {
    ASSIGN_OR_RETURN(Rows row, database.query(sql::asset_bytes, sha256));
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return absl::NotFoundError(absl::StrCat("no asset ", sha256));
    const std::string_view bytes = row.blob();
    if (sha256_of(bytes) == sha256) {
      read(bytes);
      return absl::OkStatus();
    }
  }
  return damaged(database, sha256);
}

// In pieces: a model may be larger than memory should hold.
absl::Status store_file(Database& database, const Asset& asset, const char* make_room) {
  constexpr std::size_t kPieceBytes = 1 << 20;
  const std::uint64_t size = asset.file->size();
  ASSIGN_OR_RETURN(const std::int64_t row, database.integer(make_room, asset.sha256, size));
  for (std::uint64_t at = 0; at < size; at += kPieceBytes) {
    ASSIGN_OR_RETURN(const std::string piece, asset.file->read(at, kPieceBytes));
    IRSIG_STORE_TRY(database.write_blob("asset", "bytes", row, at, piece));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::string> read_asset(Database& database, const std::string& sha256) {
  std::string out;
  IRSIG_STORE_TRY(
      with_asset(database, sha256, [&](std::string_view bytes) { out = std::string(bytes); }));
  return out;
}

absl::Status check_asset(Database& database, const std::string& sha256) {
  return with_asset(database, sha256, [](std::string_view) {});
}

absl::Status check_heat_output(Database& database, std::int64_t job_id) {
  std::string sha256;
  {
    ASSIGN_OR_RETURN(Rows row, database.query(sql::heat_output_of_job, job_id));
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return absl::NotFoundError(absl::StrCat("no output of the job ", job_id));
    sha256 = row.text();
  }
  return check_asset(database, sha256);
}

absl::Status check_assets(Database& database, const char* listed) {
  std::vector<std::string> hashes;
  {
    ASSIGN_OR_RETURN(Rows row, database.query(listed));
    for (;;) {
      ASSIGN_OR_RETURN(const bool found, row.next());
      if (!found) break;
      hashes.push_back(row.text());
    }
  }
  for (const std::string& sha256 : hashes) IRSIG_STORE_TRY(check_asset(database, sha256));
  return absl::OkStatus();
}

absl::Status store_asset(Database& database, const Asset& asset) {
  if (!asset.file) return store_asset(database, asset.sha256, asset.bytes);
  const absl::Status there = check_asset(database, asset.sha256);
  if (absl::IsNotFound(there)) return store_file(database, asset, sql::insert_empty_asset);
  if (absl::IsDataLoss(there)) return store_file(database, asset, sql::empty_asset);
  return there;
}

absl::Status store_asset(Database& database, const std::string& sha256, std::string_view bytes) {
  const absl::Status there = check_asset(database, sha256);
  if (absl::IsNotFound(there)) return database.run(sql::insert_asset, sha256, Blob{bytes});
  if (absl::IsDataLoss(there)) return database.run(sql::replace_asset, sha256, Blob{bytes});
  return there;
}

absl::StatusOr<std::string> describe_asset(Database& database, const std::string& sha256) {
  ASSIGN_OR_RETURN(Rows row, database.query(sql::asset_use, sha256));
  ASSIGN_OR_RETURN(const bool found, row.next());
  if (!found) return absl::StrCat(sha256, " (of no sweep)");
  const std::string sweep = row.text();
  if (row.is_null()) return absl::StrCat(sha256, " (a file of the sweep \"", sweep, "\")");
  return absl::StrCat(sha256, " (temperatures computed for the season \"", row.text(),
                      "\" of the sweep \"", sweep, "\")");
}

std::string how_to_replace_asset(const std::string& database_path) {
  return absl::StrCat("`irsig run SWEEP --db ", database_path,
                      " --resume` with the sweep file stores its files again and computes damaged "
                      "temperatures again");
}

absl::StatusOr<std::uint64_t> reopen_damaged_heat_jobs(Database& database) {
  std::vector<std::string> outputs;
  {
    ASSIGN_OR_RETURN(Rows row, database.query(sql::heat_outputs));
    for (;;) {
      ASSIGN_OR_RETURN(const bool found, row.next());
      if (!found) break;
      outputs.push_back(row.text());
    }
  }
  std::uint64_t jobs = 0;
  for (const std::string& sha256 : outputs) {
    const absl::Status status = check_asset(database, sha256);
    if (status.ok()) continue;
    // One that is not there at all is as lost as a damaged one.
    if (!absl::IsDataLoss(status) && !absl::IsNotFound(status)) return status;
    IRSIG_STORE_TRY(database.run(sql::reopen_heat_jobs, sha256));
    jobs += database.changes();
  }
  if (jobs > 0) IRSIG_STORE_TRY(database.run(sql::recount_all_needs));
  return jobs;
}

}  // namespace irsig
