#pragma once

#include <optional>
#include <string_view>

#include "core/materials/optical/text_table.h"

namespace irsig {

// Returns the micrometres in one unit of a wavelength column; none if the column's name is not a
// wavelength's.
[[nodiscard]] std::optional<double> micrometres_in(std::string_view column);

// Like micrometres_in(), for a column that has to be a wavelength: another name is reported to
// `errors`.
[[nodiscard]] std::optional<double> wavelength_unit(const NumberTable::Name& column,
                                                    TableErrors& errors);

}  // namespace irsig
