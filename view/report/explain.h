#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "schema/store/reader.h"

namespace irsig {

// Everything that is stored of one row but its spectrum: what it is, its values with every error,
// the ledger of effects, where the light ends, the split by cause and by part, the
// temperatures that a job has computed.
//   sweep   name; empty: the only one that has the row
//   format  "text" (for people) or "json" (an object of arrays of objects, every number)
// NOT_FOUND: no such row or sweep. INVALID_ARGUMENT: several sweeps have it; the format.
[[nodiscard]] absl::Status explain_row(StoreReader& reader, const std::string& sweep,
                                       std::uint64_t row, std::string_view format,
                                       std::ostream& out);

}  // namespace irsig
