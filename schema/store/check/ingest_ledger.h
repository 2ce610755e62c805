#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "schema/result.pb.h"
#include "schema/store/tables/database.h"

namespace irsig {

// The numbers under which names of effects and of reasons are stored.
struct LedgerNames {
  std::map<std::string, std::int64_t> effect, reason;
  std::map<std::string, std::int64_t> bounded_with;  // effects whose bound is in that of another
  std::map<std::string, std::int64_t> of_hot_gas;    // effects of rows that have some
  std::map<std::string, std::int64_t> of_cloud;      // effects that rows under a cloud may have
};
[[nodiscard]] absl::StatusOr<LedgerNames> ledger_names(Database& database);

// Checks the ledger of a row. Every effect known to this version occurs once (effects of hot gas
// only where the row has some, those of a cloud or none), with a known state and reason. An omitted effect has its bounds,
// unless another effect has them or the user forced the omission. Energy is missing only where
// nothing of the target is visible. INVALID_ARGUMENT otherwise; the message names the field.
[[nodiscard]] absl::Status check_ledger(const schema::SignatureRow& row, const LedgerNames& names,
                                        const std::string& path);

// Inserts the ledger of a row that was checked.
[[nodiscard]] absl::Status insert_ledger(Database& database, const LedgerNames& names,
                                         std::int64_t signature_id,
                                         const schema::SignatureRow& row);

}  // namespace irsig
