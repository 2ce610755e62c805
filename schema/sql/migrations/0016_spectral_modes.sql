-- How the errors of a spectrum's wavelengths go together (core/accuracy/spectral_modes.h): [mode][wavelength], int16,
-- little-endian, in units of the standard error there / 32767. No line: the row is older, and nothing is known.

CREATE TABLE spectral_modes (
  signature_id INTEGER PRIMARY KEY REFERENCES signature ON DELETE CASCADE,
  spectral_intensity_modes BLOB NOT NULL,
  apparent_spectral_intensity_modes BLOB NOT NULL,
  contrast_spectral_intensity_modes BLOB NOT NULL
) STRICT;
