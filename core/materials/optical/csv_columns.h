#pragma once

#include <optional>
#include <string_view>

#include "core/materials/optical/text_table.h"

namespace irsig {

// How many micrometres one unit of a wavelength column is; none if its name is no wavelength's.
[[nodiscard]] std::optional<double> micrometres_in(std::string_view column);

// The same for a column that has to be one: otherwise reported.
[[nodiscard]] std::optional<double> wavelength_unit(const NumberTable::Name& column,
                                                    TableErrors& errors);

}  // namespace irsig
