#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/atmosphere/absorber_amounts.h"
#include "core/atmosphere/air_profile.h"

namespace irsig {

// data/gas_table.txt in memory, as arrays over its entries (one gas in one band) and over their
// terms, which are padded to pairs with weight 0.
struct GasTable {
  struct Reference {  // the pressures about which entries are scaled
    double pressure_pa, doppler_pa;
  };
  struct Entry {
    std::uint16_t band;
    std::uint16_t gas;
    std::uint16_t reference;
    std::uint32_t first_pair, pairs;
  };
  // plain = amount (1 + b (T/T0 - 1) + c (T/T0 - 1)^2); scaled = plain ((p + doppler) / (p0 +
  // doppler))^a depth of a term = k_scaled scaled + k_plain plain A continuum: scale = ((p +
  // doppler) / (p0 + doppler))^a (1 + b (T/T0 - 1) + c (T/T0 - 1)^2)
  struct Continuum {
    std::size_t band;
    double ln_pressure_pa, temperature_k, a, b, c, k_m5_kg_mol;
  };
  struct Collision {
    std::size_t band;
    double k_m5_mol2;
  };

  std::vector<Reference> reference;
  std::vector<Entry> entry;                                        // by gas, then by band
  std::vector<double> temperature_k, exponent, linear, quadratic;  // per entry
  std::vector<double> k_scaled_m2_kg, k_plain_m2_kg, weight;       // per term
  double molar_mass_kg_mol[kGasCount] = {};
  std::size_t gas_begin[kGasCount + 1] = {};  // entries of a gas
  std::vector<Continuum> self, foreign;
  std::vector<Collision> nitrogen, oxygen, carbon_dioxide;
};

[[nodiscard]] const GasTable& gas_table();

inline constexpr double kGasConstantJMolK = 8.31446261815324;  // exact        [codata2018]
inline constexpr double kMolarMassAirKgMol = 28.9647e-3;
inline constexpr double kMolarMassWaterKgMol = 18.0153e-3;

// Adds to `out` what a stretch of `length_m` between two states of the air holds. Densities are
// taken as exponential in between.
void add_gases(AbsorberAmounts& out, const AirLevel& from, const AirLevel& to, double length_m,
               double cfc11_ppmv, double cfc12_ppmv);

}  // namespace irsig
