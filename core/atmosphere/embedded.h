#pragma once

#include <string_view>
#include <vector>

namespace irsig {

// Return the data files of this module, as they stand in data/.
[[nodiscard]] std::string_view embedded_gas_table();
[[nodiscard]] std::string_view embedded_afgl_profiles();
[[nodiscard]] std::string_view embedded_aerosol_optics();
[[nodiscard]] std::string_view embedded_aerosol_heights();
[[nodiscard]] std::string_view embedded_aerosol_navy();
[[nodiscard]] std::string_view embedded_cloud_optics();

// Rows of comma-separated fields after the comments and the header line. For embedded files only: a
// wrong number is a failed check.
[[nodiscard]] std::vector<std::vector<std::string_view>> csv_rows(std::string_view text);
[[nodiscard]] double number(std::string_view field);

// Takes the next space-separated word off the front of `text`; empty at its end.
std::string_view take_word(std::string_view& text);

}  // namespace irsig
