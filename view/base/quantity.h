#pragma once

#include <string>
#include <string_view>

namespace irsig {

// The parts of an identifier of the glossary: "intensity_stderr_w_sr" is "intensity stderr" in
// "W/sr".
struct Quantity {
  std::string noun;     // words with spaces
  std::string unit;     // for people: "W/sr", "deg"; empty: dimensionless
  std::string cf_unit;  // for netCDF (UDUNITS): "W sr-1", "degree"; "1": dimensionless
};

[[nodiscard]] Quantity quantity_of(std::string_view identifier);

}  // namespace irsig
