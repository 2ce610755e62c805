#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "schema/store/tables/database.h"
#include "schema/store/tables/filters.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// Implements StoreReader::profiles and StoreReader::published.
[[nodiscard]] absl::StatusOr<std::vector<StoredProfileRow>> find_profile_rows(
    Database& database, const ProfileFilter& filter);
[[nodiscard]] absl::StatusOr<std::vector<StoredPublished>> find_published(Database& database,
                                                                          const std::string& sweep);

}  // namespace irsig
