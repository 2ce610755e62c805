#pragma once

#include <cstddef>
#include <vector>

#include "absl/status/statusor.h"
#include "core/atmosphere/absorber_amounts.h"
#include "core/gas/gas_path.h"
#include "core/hot_gas/column_tests.h"

namespace irsig {

// A sweep's wavelengths among the bands of hot gas.
class GasWavelengths {
 public:
  // Prepares wavelengths. OUT_OF_RANGE: the gas's tables do not have one.
  [[nodiscard]] static absl::StatusOr<GasWavelengths> make(std::vector<double> um);

  [[nodiscard]] const std::vector<double>& um() const { return um_; }
  [[nodiscard]] std::size_t band(std::size_t wavelength) const { return band_[wavelength]; }
  // Gas bands in which any wavelength lies, neighbours together.
  [[nodiscard]] const std::vector<GasBands>& ranges() const { return ranges_; }

 private:
  std::vector<double> um_;
  std::vector<std::size_t> band_;
  std::vector<GasBands> ranges_;
};

// Emission and absorption of a column of hot gas, on a sweep's wavelengths: at its near end, or
// behind air.
struct ColumnLight {
  std::vector<double> emitted_w_m2_sr_um;
  // Absorbed fraction of light from behind that would arrive without the gas.
  std::vector<double> absorbed;
  // Extrapolated part of the emission: from the column's steps, and steps twice as large, to
  // infinitely small ones.
  std::vector<double> step_w_m2_sr_um;
  // One sigma of the emission: of the bands (gas_model_error.h), and since lines of water are not
  // known where hot and cold gas share them.
  std::vector<double> model_error_w_m2_sr_um;
  std::vector<double> air_transmittance;  // before the column; empty at its near end
};

// Returns a column behind two airs, of which the second counts by `fraction`: a broken sky's. What
// is absorbed is that of light that is the same behind both; sqrt(fraction (1 - fraction)) times
// the difference of the emissions is added to the model error.
[[nodiscard]] ColumnLight mixed(const ColumnLight& a, const ColumnLight& b, double fraction);

// Air between columns and sensor, on a sweep's wavelengths: made once, for all columns.
class AirBeforeColumns {
 public:
  // Prepares the air. INVALID_ARGUMENT: the air's tables do not have a wavelength.
  [[nodiscard]] static absl::StatusOr<AirBeforeColumns> make(const AbsorberAmounts& air,
                                                             const GasWavelengths& wavelengths);

 private:
  friend class HotColumn;
  std::vector<ForegroundAir> range_;
};

// A column of gas, of which all is computed that does not depend on the air before it.
//
// Steps that are isothermal show thick lines the mean of a step and not its front: an error in
// proportion to the steps, which is extrapolated away (beside 3 % of 3.2-5 um without air at the
// steps of view_steps(), 0.3 % are left: tests/physics/plume_view_test.cpp).
// Bands are 10 cm-1 wide; inside a band emission follows Planck's function at the column's
// temperature, weighted with amounts and T^4.
class HotColumn {
 public:
  // Prepares a column. Errors: those of core/gas (temperature, pressure and amounts outside its
  // tables).
  //   wavelengths  of all columns and airs that meet; must outlive the column
  [[nodiscard]] static absl::StatusOr<HotColumn> make(const GasColumn& column,
                                                      const GasWavelengths& wavelengths);

  [[nodiscard]] ColumnLight at_near_end() const;
  // Returns the column's light behind air of the same wavelengths.
  [[nodiscard]] ColumnLight behind(const AirBeforeColumns& air) const;

 private:
  // Light in the gas's bands.
  struct BandLight {
    std::vector<double> emitted, absorbed, error, air_transmittance;
  };
  [[nodiscard]] static BandLight light(const std::vector<GasPath>& path,
                                       const AirBeforeColumns* air);
  [[nodiscard]] ColumnLight light(const AirBeforeColumns* air) const;

  const GasWavelengths* wavelengths_ = nullptr;
  std::vector<GasPath> fine_, coarse_;  // [range of wavelengths]; none: a column of one step
  std::vector<double> shape_;           // [wavelength] of emission inside its band
  std::vector<double> relative_error_;  // [band] one sigma of what it absorbs and sends
};

}  // namespace irsig
