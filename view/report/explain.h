#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "schema/store/reader.h"

namespace irsig {

// Writes everything that is stored of one row except its spectrum: identity, values with every
// error, ledger of effects, path endings, split by cause and by part, and computed temperatures.
//   sweep   name; empty: the only one that has the row
//   format  "text" (for people) or "json" (an object of arrays of objects, every number)
// NOT_FOUND: there is no such row or sweep. INVALID_ARGUMENT: several sweeps have the row, or the
// format is unknown.
[[nodiscard]] absl::Status explain_row(StoreReader& reader, const std::string& sweep,
                                       std::uint64_t row, std::string_view format,
                                       std::ostream& out);

}  // namespace irsig
