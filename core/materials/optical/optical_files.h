#pragma once

#include <string_view>

#include "absl/status/statusor.h"
#include "core/materials/material_spec.h"

namespace irsig {

// Readers of measured optical properties: the text of a file in, a table out. Errors
// (INVALID_ARGUMENT) come as file:line:column: what is wrong, what was expected, several a file.
// Nothing is made up: no extrapolation, no missing k.

// Reads optical constants, by the file's ending:
//   .yml .yaml  the refractiveindex.info database's form: "tabulated nk", or "tabulated n" with
//               "tabulated k" (joined where both are known, linear between their points); a
//               dispersion formula is refused by its name
//   .csv        columns lambda_um (or lambda_nm), n, k
// n > 0, k >= 0, wavelengths above 0 and increasing.
[[nodiscard]] absl::StatusOr<OpticalConstants> read_optical_constants(std::string_view text,
                                                                      std::string_view file_name);

// Reads a property from 0 to 1 by wavelength, from CSV with two columns: lambda_um or lambda_nm
// (wavelength_um ... are understood), then `quantity` ("emissivity", "reflectance") or "value";
// with "_percent" behind it the file is in percent. The header alone states the quantity. Also
// reads a spectrum of the ECOSTRESS or USGS library (library_spectrum.h).
[[nodiscard]] absl::StatusOr<Spectrum> read_spectrum(std::string_view text,
                                                     std::string_view file_name,
                                                     std::string_view quantity);

// Reads a BRDF from CSV with the columns lambda_um (or lambda_nm), theta_i_deg, theta_r_deg,
// phi_deg, brdf_per_sr in any order (other columns are ignored), rows in any order, one for each
// point of a full grid. Zenith angles lie in [0, 90), azimuths in [0, 360]; those above 180 are the
// mirror images of those below (the surface has no grain) and are averaged with them.
[[nodiscard]] absl::StatusOr<TabulatedBrdf> read_brdf(std::string_view text,
                                                      std::string_view file_name);

}  // namespace irsig
