#pragma once

#include <ostream>
#include <string_view>

#include "absl/status/status.h"
#include "schema/store/reader.h"

namespace irsig {

// The temperatures that jobs have computed, by season, time and part: of the part's facets, by
// area, the mean, the coldest and the hottest, and the mean of their errors. In a format of
// table.h. NOT_FOUND: none passes the filter.
[[nodiscard]] absl::Status write_temperatures(StoreReader& reader, const TemperatureFilter& filter,
                                              std::string_view format, std::ostream& out);

}  // namespace irsig
