#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/signature/view/request.h"
#include "core/spectral/band.h"

namespace irsig {

// In-band integrals and wavelengths of a scene's bands for ReferenceView. Private to
// verify/reference.

// Integrates response x f over the band, by `points` midpoints in each interval between the
// response's corners and `breaks_um`.
[[nodiscard]] double integral_in_band(const Band& band, const std::function<double(double)>& f,
                                      std::span<const double> breaks_um = {}, int points = 4000);

// Wavelengths drawn for one path: `strata` in a band, with density in proportion to a mean of the
// spectra that occur, so that the sum of weight x f estimates the integral of response x f.
class WavelengthDraw {
 public:
  WavelengthDraw(const Band& band, const std::vector<std::function<double(double)>>& spectra,
                 int strata);
  // Draws the wavelengths [um] and weights of a path. u: place in every stratum, in [0, 1).
  void draw(double u, double* lambda_um, double* weight) const;
  [[nodiscard]] int strata() const { return strata_; }

 private:
  Band band_;
  int strata_;
  std::vector<double> sum_;  // of the density, running, at the cells' ends
};

// Spectral radiances of the surroundings of a target in plain air, and of its sun.
struct PlainLight {
  const ConditionSpec* condition;
  bool sun;  // shines
  [[nodiscard]] double sky(double lambda_um) const;
  [[nodiscard]] double lower(double lambda_um) const;
  // Returns the spectral irradiance normal to the beam.
  [[nodiscard]] double sunlight(double lambda_um) const;
};

}  // namespace irsig
