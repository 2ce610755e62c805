#pragma once

#include <ostream>
#include <string_view>

#include "absl/status/status.h"
#include "schema/store/reader.h"

namespace irsig {

// Writes the temperatures computed by jobs, by season, time and part, in a format of table.h. The
// values are the area-weighted mean of the part's facets, the coldest, the hottest, and the mean
// error. NOT_FOUND: none passes the filter.
[[nodiscard]] absl::Status write_temperatures(StoreReader& reader, const TemperatureFilter& filter,
                                              std::string_view format, std::ostream& out);

}  // namespace irsig
