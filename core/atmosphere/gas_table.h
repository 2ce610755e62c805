#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/atmosphere/absorber_amounts.h"
#include "core/atmosphere/air_profile.h"
#include "core/base/constants.h"

namespace irsig {

// data/gas_table.txt in memory. Entries (one gas in one band) lie by gas, then by band, in groups
// of kLanes that share gas and reference; groups are filled up with entries of no band.
struct GasTable {
  static constexpr std::size_t kLanes = 8;
  // The reference state about which entries are scaled.
  struct Reference {
    double pressure_pa, doppler_pa, temperature_k;
  };
  // amounts: ((p + doppler) / (p0 + doppler))^a (1 + b (T/T0 - 1) + c (T/T0 - 1)^2), the scaled and
  // the plain one with a, b, c of their own; depth of a term = k_scaled scaled + k_plain plain
  struct Group {
    std::uint16_t gas, reference;
  };
  struct Entry {
    std::uint16_t band;  // kAirBandCount: none
    std::uint32_t first_term, terms;
  };
  // A continuum, per band: scale = ((p + doppler) / (p0 + doppler))^a (1 + b (T/T0 - 1) + c (T/T0 -
  // 1)^2)
  struct Continuum {
    AirSpectrum ln_pressure_pa, temperature_k, a, b, c, k_m5_kg_mol;
  };

  std::vector<Reference> reference;
  std::vector<Group> group;
  std::vector<Entry> entry;  // [kLanes group + lane]
  struct Scaling {
    std::vector<double> exponent, linear, quadratic;  // per entry: a, b, c
  };
  Scaling scaled, plain;
  std::vector<double> k_scaled_m2_kg, k_plain_m2_kg, weight;  // per term
  double molar_mass_kg_mol[kGasCount] = {};
  std::size_t gas_begin[kGasCount + 1] = {};  // groups of a gas
  Continuum self, foreign;
  AirSpectrum nitrogen_m5_mol2, oxygen_m5_mol2, carbon_dioxide_m5_mol2;  // induced by collisions
  AirSpectrum molecular_per_m;          // scattering by air at 0 C and 1013.25 hPa
  AirSpectrum lambda_um, planck_scale;  // of the bands: centres, c1L / lambda^5
};

[[nodiscard]] const GasTable& gas_table();

// The terms of some entries, bundled so that entries with about as many terms lie side by side;
// gases in their order.
struct LineTerms {
  static constexpr std::size_t kLanes = GasTable::kLanes;
  struct Bundle {
    std::uint32_t first_term = 0, terms = 0;  // even; those of lane j at first_term + kLanes i + j
    std::array<std::uint32_t, kLanes> entry{};
    std::array<std::uint16_t, kLanes> band{};  // kAirBandCount: a lane of weight 0
  };
  std::vector<Bundle> bundle;
  std::vector<double> k_scaled_m2_kg, k_plain_m2_kg, weight;
};
[[nodiscard]] LineTerms line_terms(std::vector<std::uint32_t> entries);

inline constexpr double kMolarMassAirKgMol = 28.9647e-3;
inline constexpr double kMolarMassWaterKgMol = 18.0153e-3;

// Adds to `out` what a stretch of `length_m` between two states of the air holds. Densities are
// taken as exponential in between.
void add_gases(AbsorberAmounts& out, const AirLevel& from, const AirLevel& to, double length_m,
               double cfc11_ppmv, double cfc12_ppmv, const BandChoice& bands);

}  // namespace irsig
