#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// The air's own spectral grid: means over bands of 10 cm-1 from 650 to 3400 cm-1 (2.94-15.4 um), in
// order of increasing wavenumber. Below and above there is no table, and air_band says so.
inline constexpr double kAirFirstCm1 = 650;
inline constexpr double kAirLastCm1 = 3400;
inline constexpr double kAirBandWidthCm1 = 10;
inline constexpr std::size_t kAirBandCount = 275;

using AirSpectrum = std::vector<double>;  // kAirBandCount band means

[[nodiscard]] double air_band_centre_cm1(std::size_t band);
[[nodiscard]] double air_band_lambda_um(std::size_t band);  // 1e4 / centre

// Returns the band of a wavelength. OUT_OF_RANGE outside [1e4 / 3400, 1e4 / 650] um.
[[nodiscard]] absl::StatusOr<std::size_t> air_band(double lambda_um);

// Gases with line structure, in the order of the table.
enum class Gas { kH2o, kCo2, kO3, kN2o, kCh4, kCfc11, kCfc12, kCo };
inline constexpr std::size_t kGasCount = 8;

// Absorbers without structure inside a band: Beer's law holds for the band mean.
enum class GreyAbsorber {
  kWaterContinuum,
  kNitrogen,    // collision-induced, 4.3 um
  kOxygen,      // collision-induced, 6.4 um
  kCo2FarWing,  // 3.9-4.2 um
  kAerosolAbsorption,
  kAerosolScattering,
  kMolecularScattering
};
inline constexpr std::size_t kGreyAbsorberCount = 7;

// The absorbers in a stretch of air, per band. ADD the amounts of two stretches to get the amounts
// of both, whatever lies between the stretches.
//
// Inside a band the air's lines make the transmittance a sum over exponentials, for each gas
//   T_g = sum over terms i of w_i exp(-k_i u_g - k'_i u'_g),   T = product over g of T_g x
//   exp(-grey depths)
// with u_g the gas's amount scaled for pressure and temperature (absorption in the wings of lines),
// u'_g the amount scaled for temperature only (the lines' centres; weak absorption), the same for
// all terms of a band. So u and u' add along a path while T of two stretches does NOT multiply.
// Light that carries the air's own lines therefore needs a transmittance of SUMMED amounts:
//   reflected sunlight  E0 T(u_sun + u_sensor), not T(u_sun) T(u_sensor);
//   sky, background or far air seen through near air  sum over layers of B (T(u_near + u_l) -
//   T(u_near + u_(l+1))).
// Only emission of surfaces and grey light are multiplied by T itself.
struct AbsorberAmounts {
  AbsorberAmounts();  // nothing: transmittance 1

  // Per gas and band that has lines, in the table's order and with its gaps.
  std::vector<double> gas_scaled_kg_m2, gas_plain_kg_m2;
  std::array<AirSpectrum, kGreyAbsorberCount> optical_depth;

  AbsorberAmounts& operator+=(const AbsorberAmounts& other);
  [[nodiscard]] const AirSpectrum& grey(GreyAbsorber which) const {
    return optical_depth[static_cast<std::size_t>(which)];
  }
};
[[nodiscard]] AbsorberAmounts operator+(AbsorberAmounts a, const AbsorberAmounts& b);

// Computes band means of the transmittance, in [0, 1]; exactly 1 for no amounts.
//
// Accuracy, against MODTRAN: docs/evidence/validation.md, "Atmosphere". Numerics: relative 1e-13 of
// the sum of exponentials for optical depths up to 700, 0 beyond.
[[nodiscard]] AirSpectrum transmittance(const AbsorberAmounts& amounts);

struct LineTerms;

// Bands that are wanted: to leave some out saves their time. Cheap to copy.
class BandChoice {
 public:
  BandChoice();  // all
  // Chooses some bands.
  //   wanted  [band]: not 0
  explicit BandChoice(const std::vector<unsigned char>& wanted);

  [[nodiscard]] bool operator[](std::size_t band) const { return sets_->wanted[band] != 0; }

  // A range of neighbouring bands.
  struct Range {
    std::size_t first, last;  // one beyond
    [[nodiscard]] std::size_t size() const { return last - first; }
  };
  [[nodiscard]] const std::vector<Range>& ranges() const { return sets_->ranges; }
  // The gas table's groups that have a wanted band, and the lines in these groups; for
  // core/atmosphere alone.
  [[nodiscard]] const std::vector<std::uint16_t>& line_groups() const { return sets_->line_groups; }
  [[nodiscard]] const LineTerms& line_terms() const { return *sets_->line_terms; }

 private:
  struct Sets {
    std::vector<unsigned char> wanted;
    std::vector<Range> ranges;
    std::vector<std::uint16_t> line_groups;
    std::shared_ptr<const LineTerms> line_terms;
  };
  static Sets sets_of(std::vector<unsigned char> wanted);
  std::shared_ptr<const Sets> sets_;
};
[[nodiscard]] inline bool chosen(const BandChoice& bands, std::size_t band) { return bands[band]; }

// Packs a spectrum's wanted bands, in order, behind the content of `to`; unpack() reverses it,
// leaves other bands as they were, and returns the pointer behind the numbers that it read.
void pack(std::vector<double>& to, const AirSpectrum& of, const BandChoice& bands);
const double* unpack(AirSpectrum& to, const double* from, const BandChoice& bands);

// Like transmittance(amounts), but 0 in bands that are not wanted.
[[nodiscard]] AirSpectrum transmittance(const AbsorberAmounts& amounts, const BandChoice& bands);

// Sets sum = a + b, which may be the sum itself, in those bands. Others are left.
void set_sum(AbsorberAmounts& sum, const AbsorberAmounts& a, const AbsorberAmounts& b,
             const BandChoice& bands);

// Amounts in some bands alone, for whoever keeps many: half the memory where half of the bands are
// wanted. The bands are those that it was made with, here and below.
class PackedAmounts {
 public:
  PackedAmounts(const AbsorberAmounts& amounts, const BandChoice& bands);
  // Returns the packed amounts, with nothing in other bands.
  [[nodiscard]] AbsorberAmounts unpacked(const BandChoice& bands) const;

 private:
  friend void set_sum(AbsorberAmounts& sum, const PackedAmounts& a, const AbsorberAmounts& b,
                      const BandChoice& bands);
  std::vector<double> value_;
};
// Sets sum = a + b, as above.
void set_sum(AbsorberAmounts& sum, const PackedAmounts& a, const AbsorberAmounts& b,
             const BandChoice& bands);

// Adds to a sum the amounts at a fraction of the way from low to high, at least 0, in those bands.
void add_between(AbsorberAmounts& sum, const AbsorberAmounts& low, const AbsorberAmounts& high,
                 double fraction, const BandChoice& bands);

// Returns one gas's factor of the transmittance alone.
[[nodiscard]] AirSpectrum transmittance(const AbsorberAmounts& amounts, Gas gas);

// Returns the sum of the two scattering depths.
[[nodiscard]] AirSpectrum scattering_optical_depth(const AbsorberAmounts& amounts);

}  // namespace irsig
