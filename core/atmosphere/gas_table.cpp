#include "core/atmosphere/gas_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "core/atmosphere/embedded.h"
#include "core/atmosphere/vector_exp.h"
#include "core/base/check.h"

namespace irsig {
namespace {

constexpr std::array<std::string_view, kGasCount> kGasNames = {"H2O", "CO2",   "O3",    "N2O",
                                                               "CH4", "CFC11", "CFC12", "CO"};

// The scaling is a fit over 180-310 K; its parabola must not run on.
constexpr double kTemperatureMinK = 170, kTemperatureMaxK = 330;

class TableReader {
 public:
  explicit TableReader(std::string_view text) : text_(text) {}

  GasTable read() {
    for (std::string_view line; next_line(line);) {
      std::string_view words = line.substr(0, line.find('#'));
      std::string_view rest = words;
      const std::string_view first = take_word(rest);
      if (first.empty()) continue;
      if (first == "bands") {
        IRSIG_CHECK(number(take_word(rest)) == double{kAirBandCount});
        IRSIG_CHECK(number(take_word(rest)) == kAirFirstCm1);
        IRSIG_CHECK(number(take_word(rest)) == kAirBandWidthCm1);
      } else if (first == "gas") {
        const std::string_view name = take_word(rest);
        begin_gas(name, number(take_word(rest)));
      } else if (first == "continuum") {
        continuum_ = take_word(rest) == "self" ? &table_.self : &table_.foreign;
        gas_ = kGasCount;
      } else if (first == "collision") {
        const std::string_view name = take_word(rest);
        collision_ = name == "N2"   ? &table_.nitrogen
                     : name == "O2" ? &table_.oxygen
                                    : &table_.carbon_dioxide;
        continuum_ = nullptr;
      } else if (gas_ < kGasCount) {
        add_entry(words);
      } else if (continuum_ != nullptr) {
        add_continuum(words);
      } else {
        collision_->push_back({band_of(number(first)), number(take_word(rest))});
      }
    }
    table_.gas_begin[kGasCount] = table_.entry.size();
    IRSIG_CHECK(!table_.carbon_dioxide.empty());
    return std::move(table_);
  }

 private:
  bool next_line(std::string_view& line) {
    if (text_.empty()) return false;
    const std::size_t end = text_.find('\n');
    line = text_.substr(0, end);
    text_.remove_prefix(end == std::string_view::npos ? text_.size() : end + 1);
    return true;
  }

  static std::size_t band_of(double low_cm1) {
    const double band = (low_cm1 - kAirFirstCm1) / kAirBandWidthCm1;
    IRSIG_CHECK(band >= 0);
    IRSIG_CHECK(band < double{kAirBandCount});
    return static_cast<std::size_t>(band);
  }

  void begin_gas(std::string_view name, double molar_mass_kg_mol) {
    gas_ = static_cast<std::size_t>(std::ranges::find(kGasNames, name) - kGasNames.begin());
    IRSIG_CHECK(gas_ < kGasCount);
    table_.gas_begin[gas_] = table_.entry.size();
    table_.molar_mass_kg_mol[gas_] = molar_mass_kg_mol;
  }

  std::uint16_t reference_of(double pressure_pa, double doppler_pa) {
    for (std::size_t i = 0; i < table_.reference.size(); ++i) {
      if (table_.reference[i].pressure_pa == pressure_pa &&
          table_.reference[i].doppler_pa == doppler_pa) {
        return static_cast<std::uint16_t>(i);
      }
    }
    table_.reference.push_back({pressure_pa, doppler_pa});
    return static_cast<std::uint16_t>(table_.reference.size() - 1);
  }

  void add_entry(std::string_view words) {
    GasTable::Entry entry{};
    entry.band = static_cast<std::uint16_t>(band_of(number(take_word(words))));
    entry.gas = static_cast<std::uint16_t>(gas_);
    const double pressure_pa = number(take_word(words));
    table_.temperature_k.push_back(number(take_word(words)));
    entry.reference = reference_of(pressure_pa, number(take_word(words)));
    table_.exponent.push_back(number(take_word(words)));
    table_.linear.push_back(number(take_word(words)));
    table_.quadratic.push_back(number(take_word(words)));
    const auto terms = static_cast<std::uint32_t>(number(take_word(words)));
    entry.first_pair = static_cast<std::uint32_t>(table_.weight.size() / 2);
    entry.pairs = (terms + 1) / 2;
    const std::size_t first = table_.weight.size();
    double sum = 0;
    for (std::uint32_t i = 0; i < terms; ++i) {
      table_.k_scaled_m2_kg.push_back(number(take_word(words)));
      table_.k_plain_m2_kg.push_back(number(take_word(words)));
      sum += table_.weight.emplace_back(number(take_word(words)));
    }
    // As exact a 1 as doubles allow: transmittance is 1 at zero range.
    for (std::size_t i = first; i < table_.weight.size(); ++i) table_.weight[i] /= sum;
    if (terms % 2 == 1) {
      table_.k_scaled_m2_kg.push_back(0);
      table_.k_plain_m2_kg.push_back(0);
      table_.weight.push_back(0);
    }
    IRSIG_CHECK(take_word(words).empty());
    table_.entry.push_back(entry);
  }

  void add_continuum(std::string_view words) {
    GasTable::Continuum c{};
    c.band = band_of(number(take_word(words)));
    c.ln_pressure_pa = std::log(number(take_word(words)));
    for (double* field : {&c.temperature_k, &c.a, &c.b, &c.c, &c.k_m5_kg_mol}) {
      *field = number(take_word(words));
    }
    continuum_->push_back(c);
  }

  std::string_view text_;
  GasTable table_;
  std::size_t gas_ = kGasCount;
  std::vector<GasTable::Continuum>* continuum_ = nullptr;
  std::vector<GasTable::Collision>* collision_ = nullptr;
};

// Mean of a density that is exponential between a and b.
double logarithmic_mean(double a, double b) {
  if (a <= 0 || b <= 0) return 0.5 * (a + b);
  const double x = std::log(b / a);
  return std::abs(x) < 1e-4 ? a * (1 + x / 2 + x * x / 6) : (b - a) / x;
}

double air_mol_m3(const AirLevel& level) {
  return level.pressure_pa / (kGasConstantJMolK * level.temperature_k);
}

struct WaterDensities {
  double mol_m3, kg_m3, per_kg, air_kg_m3;
};

WaterDensities water_of(const AirLevel& level) {
  const double n = air_mol_m3(level), x = level.gas.h2o_ppmv * 1e-6;
  const double air = n * (kMolarMassAirKgMol * (1 - x) + kMolarMassWaterKgMol * x);
  const double water = n * x * kMolarMassWaterKgMol;
  return {n * x, water, water / air, air};
}

void add_continuum(AirSpectrum& depth, const std::vector<GasTable::Continuum>& terms,
                   double pressure_pa, double temperature_k, double density, double length_m) {
  const double ln_pressure = std::log(pressure_pa);
  for (const auto& term : terms) {
    const double x = temperature_k / term.temperature_k - 1;
    const double scale = term.a == 0 ? 1.0 : std::exp(term.a * (ln_pressure - term.ln_pressure_pa));
    depth[term.band] += term.k_m5_kg_mol * scale * std::max(0.0, 1 + term.b * x + term.c * x * x) *
                        density * length_m;
  }
}

}  // namespace

const GasTable& gas_table() {
  static const GasTable table = TableReader(embedded_gas_table()).read();
  return table;
}

void add_gases(AbsorberAmounts& out, const AirLevel& from, const AirLevel& to, double length_m,
               double cfc11_ppmv, double cfc12_ppmv) {
  const GasTable& table = gas_table();
  const double pressure_pa = 0.5 * (from.pressure_pa + to.pressure_pa);
  const double temperature_k =
      std::clamp(0.5 * (from.temperature_k + to.temperature_k), kTemperatureMinK, kTemperatureMaxK);
  const double n_from = air_mol_m3(from), n_to = air_mol_m3(to);
  const double n_air = logarithmic_mean(n_from, n_to);

  const auto column = [&](double from_ppmv, double to_ppmv) {
    return logarithmic_mean(n_from * from_ppmv, n_to * to_ppmv) * 1e-6 * length_m;
  };
  const double mol_m2[kGasCount] = {column(from.gas.h2o_ppmv, to.gas.h2o_ppmv),
                                    column(from.gas.co2_ppmv, to.gas.co2_ppmv),
                                    column(from.gas.o3_ppmv, to.gas.o3_ppmv),
                                    column(from.gas.n2o_ppmv, to.gas.n2o_ppmv),
                                    column(from.gas.ch4_ppmv, to.gas.ch4_ppmv),
                                    column(cfc11_ppmv, cfc11_ppmv),
                                    column(cfc12_ppmv, cfc12_ppmv),
                                    column(from.gas.co_ppmv, to.gas.co_ppmv)};

  std::vector<double> ln_pressure;
  for (const auto& r : table.reference) {
    ln_pressure.push_back(std::log((pressure_pa + r.doppler_pa) / (r.pressure_pa + r.doppler_pa)));
  }
  std::array<double, 2> power{};
  for (std::size_t i = 0; i < table.entry.size(); i += 2) {
    const std::size_t count = std::min<std::size_t>(2, table.entry.size() - i);
    for (std::size_t j = 0; j < count; ++j) {
      power[j] = ln_pressure[table.entry[i + j].reference] * table.exponent[i + j];
    }
    const Pair scale = exp_pair(Pair{power[0], power[1]});
    for (std::size_t j = 0; j < count; ++j) {
      const std::size_t gas = table.entry[i + j].gas;
      const double x = temperature_k / table.temperature_k[i + j] - 1;
      const double warm = 1 + table.linear[i + j] * x + table.quadratic[i + j] * x * x;
      const double plain = mol_m2[gas] * table.molar_mass_kg_mol[gas] * std::max(0.0, warm);
      out.gas_plain_kg_m2[i + j] += plain;
      out.gas_scaled_kg_m2[i + j] += plain * scale[j];
    }
  }

  const auto depth = [&](GreyAbsorber which) -> AirSpectrum& {
    return out.optical_depth[static_cast<std::size_t>(which)];
  };
  const WaterDensities a = water_of(from), b = water_of(to);
  AirSpectrum& continuum = depth(GreyAbsorber::kWaterContinuum);
  add_continuum(continuum, table.self, pressure_pa, temperature_k,
                logarithmic_mean(a.mol_m3 * a.kg_m3, b.mol_m3 * b.kg_m3), length_m);
  add_continuum(continuum, table.foreign, pressure_pa, temperature_k,
                logarithmic_mean(n_from * a.per_kg * (1 - a.per_kg) * a.air_kg_m3,
                                 n_to * b.per_kg * (1 - b.per_kg) * b.air_kg_m3),
                length_m);
  const double n_squared_m = logarithmic_mean(n_from * n_from, n_to * n_to) * length_m;
  for (const auto& c : table.nitrogen) {
    depth(GreyAbsorber::kNitrogen)[c.band] += c.k_m5_mol2 * 0.781 * n_squared_m;
  }
  for (const auto& c : table.oxygen) {
    depth(GreyAbsorber::kOxygen)[c.band] += c.k_m5_mol2 * 0.2095 * n_squared_m;
  }
  const double co2_mol_m3 = 0.5e-6 * (from.gas.co2_ppmv + to.gas.co2_ppmv);
  for (const auto& c : table.carbon_dioxide) {
    depth(GreyAbsorber::kCo2FarWing)[c.band] += c.k_m5_mol2 * co2_mol_m3 * n_squared_m;
  }
  // Rayleigh scattering of standard air, LOWTRAN7's formula (nu in cm-1).        [kneizys1988]
  AirSpectrum& molecular = depth(GreyAbsorber::kMolecularScattering);
  const double standard_air_m = n_air / 44.615 * length_m;  // mol/m3 at 0 C and 1013.25 hPa
  for (std::size_t band = 0; band < kAirBandCount; ++band) {
    const double nu2 = air_band_centre_cm1(band) * air_band_centre_cm1(band);
    molecular[band] += 1e-3 * nu2 * nu2 / (9.38076e18 - 1.08426e9 * nu2) * standard_air_m;
  }
}

}  // namespace irsig
