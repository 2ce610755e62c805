#pragma once

#include <optional>
#include <string_view>

#include "core/materials/material_spec.h"
#include "core/materials/optical/text_table.h"

namespace irsig {

// Reads spectra as the public libraries write them: header lines of text, then rows of numbers.
//   ECOSTRESS and ASTER  lines "Key: value", of which "X Units" (wavelength in micrometers or
//                        nanometers, wave number), "Y Units" (reflectance or emissivity, in percent
//                        or not) and "Measurement" are used
//   USGS splib04 to 06   wavelength [um], reflectance, standard deviation; -1.23e34: no value
// Wavelengths may rise or fall; of equal ones the mean is taken. What noise leaves at most 1 % of
// the scale below 0 or above 1 becomes 0 or 1. An emissivity that is asked for is 1 - reflectance
// where the header says that this is hemispherical: so it is for what lets no light through.
// Returns nothing where the text is none of these; problems with one that is go to `errors`.
[[nodiscard]] std::optional<Spectrum> read_library_spectrum(std::string_view text,
                                                            std::string_view quantity,
                                                            TableErrors& errors);

}  // namespace irsig
