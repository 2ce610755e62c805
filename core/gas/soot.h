#pragma once

namespace irsig {

// Returns the absorption coefficient of soot per volume fraction, for particles much smaller than
// the wavelength. Scattering, less than absorption by the cube of size over wavelength, is left
// out. [1/m]
//
//   36 pi n k / (lambda ((n^2 - k^2 + 2)^2 + (2 n k)^2)), n and k of flame soot    [chang1990]
//
//   wavenumber_cm1  300 to 25000; the index was measured at 0.4 to 30 um
[[nodiscard]] double soot_absorption_per_m(double wavenumber_cm1);

}  // namespace irsig
