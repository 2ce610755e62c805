#include "core/atmosphere/gas_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string_view>
#include <tuple>
#include <utility>

#include "core/atmosphere/band_loops.h"
#include "core/atmosphere/embedded.h"
#include "core/atmosphere/line_loops.h"
#include "core/base/check.h"
#include "core/base/constants.h"

namespace irsig {
namespace {

constexpr std::array<std::string_view, kGasCount> kGasNames = {"H2O", "CO2",   "O3",    "N2O",
                                                               "CH4", "CFC11", "CFC12", "CO"};

// The scaling is a fit over 180-310 K; its parabola must not run on.
constexpr double kTemperatureMinK = 170, kTemperatureMaxK = 330;

class TableReader {
 public:
  explicit TableReader(std::string_view text) : text_(text) {
    const AirSpectrum none(kAirBandCount, 0.0), one(kAirBandCount, 1.0);
    for (GasTable::Continuum* c : {&table_.self, &table_.foreign}) {
      c->ln_pressure_pa = c->a = c->b = c->c = c->k_m5_kg_mol = none;
      c->temperature_k = one;
    }
    table_.nitrogen_m5_mol2 = table_.oxygen_m5_mol2 = table_.carbon_dioxide_m5_mol2 = none;
    for (std::size_t band = 0; band < kAirBandCount; ++band) {
      // Rayleigh scattering of standard air, LOWTRAN7's formula (nu in cm-1).    [kneizys1988]
      const double nu2 = air_band_centre_cm1(band) * air_band_centre_cm1(band);
      table_.molecular_per_m.push_back(1e-3 * nu2 * nu2 / (9.38076e18 - 1.08426e9 * nu2));
      const double um = air_band_lambda_um(band);
      table_.lambda_um.push_back(um);
      table_.planck_scale.push_back(kC1LWUm4M2Sr / (um * um * um * um * um));
    }
  }

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
        finish_group();
        begin_gas(name, number(take_word(rest)));
      } else if (first == "continuum") {
        finish_group();
        continuum_ = take_word(rest) == "self" ? &table_.self : &table_.foreign;
        gas_ = kGasCount;
      } else if (first == "collision") {
        const std::string_view name = take_word(rest);
        collision_ = name == "N2"   ? &table_.nitrogen_m5_mol2
                     : name == "O2" ? &table_.oxygen_m5_mol2
                                    : &table_.carbon_dioxide_m5_mol2;
        continuum_ = nullptr;
      } else if (gas_ < kGasCount) {
        add_entry(words);
      } else if (continuum_ != nullptr) {
        add_continuum(words);
      } else {
        (*collision_)[band_of(number(first))] = number(take_word(rest));
      }
    }
    table_.gas_begin[kGasCount] = table_.group.size();
    IRSIG_CHECK(collision_ == &table_.carbon_dioxide_m5_mol2);
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
    table_.gas_begin[gas_] = table_.group.size();
    table_.molar_mass_kg_mol[gas_] = molar_mass_kg_mol;
  }

  std::uint16_t reference_of(const GasTable::Reference& r) {
    for (std::size_t i = 0; i < table_.reference.size(); ++i) {
      const GasTable::Reference& known = table_.reference[i];
      if (known.pressure_pa == r.pressure_pa && known.doppler_pa == r.doppler_pa &&
          known.temperature_k == r.temperature_k) {
        return static_cast<std::uint16_t>(i);
      }
    }
    table_.reference.push_back(r);
    return static_cast<std::uint16_t>(table_.reference.size() - 1);
  }

  void add_entry(std::string_view words) {
    Line line;
    line.band = static_cast<std::uint16_t>(band_of(number(take_word(words))));
    GasTable::Reference reference{};
    reference.pressure_pa = number(take_word(words));
    reference.temperature_k = number(take_word(words));
    reference.doppler_pa = number(take_word(words));
    for (double& x : line.scaled) x = number(take_word(words));
    const auto terms = static_cast<std::size_t>(number(take_word(words)));
    double sum = 0;
    for (std::size_t i = 0; i < terms; ++i) {
      line.k_scaled.push_back(number(take_word(words)));
      line.k_plain.push_back(number(take_word(words)));
      sum += line.weight.emplace_back(number(take_word(words)));
    }
    // The weights add up to 1 as exactly as doubles allow: transmittance is 1 at zero range.
    for (double& w : line.weight) w /= sum;
    // The plain amount's own scaling, where it has one.
    line.plain = {0, line.scaled[1], line.scaled[2]};
    if (std::string_view word = take_word(words); !word.empty()) {
      for (double& x : line.plain) {
        x = number(word);
        word = take_word(words);
      }
      IRSIG_CHECK(word.empty());
    }
    const std::uint16_t index = reference_of(reference);
    if (line_.size() == GasTable::kLanes || (!line_.empty() && index != reference_)) finish_group();
    reference_ = index;
    line_.push_back(std::move(line));
  }

  void finish_group() {
    if (line_.empty()) return;
    table_.group.push_back({static_cast<std::uint16_t>(gas_), reference_});
    for (std::size_t j = 0; j < GasTable::kLanes; ++j) {
      const Line none{static_cast<std::uint16_t>(kAirBandCount), {}, {}, {}, {}, {}};
      const Line& l = j < line_.size() ? line_[j] : none;
      table_.entry.push_back({l.band, static_cast<std::uint32_t>(table_.weight.size()),
                              static_cast<std::uint32_t>(l.weight.size())});
      for (const auto& [to, from] :
           {std::pair{&table_.scaled, &l.scaled}, std::pair{&table_.plain, &l.plain}}) {
        to->exponent.push_back((*from)[0]);
        to->linear.push_back((*from)[1]);
        to->quadratic.push_back((*from)[2]);
      }
      for (std::size_t i = 0; i < l.weight.size(); ++i) {
        table_.k_scaled_m2_kg.push_back(l.k_scaled[i]);
        table_.k_plain_m2_kg.push_back(l.k_plain[i]);
        table_.weight.push_back(l.weight[i]);
      }
    }
    line_.clear();
  }

  void add_continuum(std::string_view words) {
    const std::size_t band = band_of(number(take_word(words)));
    continuum_->ln_pressure_pa[band] = std::log(number(take_word(words)));
    for (AirSpectrum* field : {&continuum_->temperature_k, &continuum_->a, &continuum_->b,
                               &continuum_->c, &continuum_->k_m5_kg_mol}) {
      (*field)[band] = number(take_word(words));
    }
  }

  // An entry of the group that is being read.
  struct Line {
    std::uint16_t band = 0;
    std::array<double, 3> scaled{}, plain{};
    std::vector<double> k_scaled, k_plain, weight;
  };

  std::string_view text_;
  GasTable table_;
  std::size_t gas_ = kGasCount;
  std::vector<Line> line_;
  std::uint16_t reference_ = 0;
  GasTable::Continuum* continuum_ = nullptr;
  AirSpectrum* collision_ = nullptr;
};

// Mean of a density that is exponential between a and b.
double mean_density(double a, double b) {
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

void add_continuum(AirSpectrum& depth, const GasTable::Continuum& of, double pressure_pa,
                   double temperature_k, double density, double length_m, const BandChoice& bands) {
  const double ln_pressure = std::log(pressure_pa);
  for (const BandChoice::Range& r : bands.ranges()) {
    add_to_continuum(r.size(),
                     {&of.ln_pressure_pa[r.first], &of.temperature_k[r.first], &of.a[r.first],
                      &of.b[r.first], &of.c[r.first], &of.k_m5_kg_mol[r.first]},
                     ln_pressure, temperature_k, density, length_m, &depth[r.first]);
  }
}

}  // namespace

const GasTable& gas_table() {
  static const GasTable table = TableReader(embedded_gas_table()).read();
  return table;
}

LineTerms line_terms(std::vector<std::uint32_t> entries) {
  constexpr std::size_t kLanes = LineTerms::kLanes;
  const GasTable& table = gas_table();
  std::ranges::sort(entries, std::less<>{}, [&](std::uint32_t e) {
    return std::tuple(table.group[e / kLanes].gas, table.entry[e].terms, e);
  });
  LineTerms out;
  for (std::size_t first = 0; first < entries.size(); first += kLanes) {
    LineTerms::Bundle bundle;
    bundle.band.fill(static_cast<std::uint16_t>(kAirBandCount));
    bundle.first_term = static_cast<std::uint32_t>(out.weight.size());
    const std::size_t lanes = std::min(kLanes, entries.size() - first);
    for (std::size_t j = 0; j < lanes; ++j) {
      const std::uint32_t terms = table.entry[entries[first + j]].terms;
      bundle.terms = std::max(bundle.terms, (terms + 1) / 2 * 2);
    }
    for (auto* of_term : {&out.k_scaled_m2_kg, &out.k_plain_m2_kg, &out.weight}) {
      of_term->resize(bundle.first_term + kLanes * bundle.terms, 0.0);
    }
    for (std::size_t j = 0; j < lanes; ++j) {
      const GasTable::Entry& entry = table.entry[entries[first + j]];
      bundle.entry[j] = entries[first + j];
      bundle.band[j] = entry.band;
      for (std::size_t i = 0; i < entry.terms; ++i) {
        const std::size_t to = bundle.first_term + kLanes * i + j, from = entry.first_term + i;
        out.k_scaled_m2_kg[to] = table.k_scaled_m2_kg[from];
        out.k_plain_m2_kg[to] = table.k_plain_m2_kg[from];
        out.weight[to] = table.weight[from];
      }
    }
    out.bundle.push_back(bundle);
  }
  return out;
}

void add_gases(AbsorberAmounts& out, const AirLevel& from, const AirLevel& to, double length_m,
               double cfc11_ppmv, double cfc12_ppmv, const BandChoice& bands) {
  const GasTable& table = gas_table();
  const double pressure_pa = 0.5 * (from.pressure_pa + to.pressure_pa);
  const double temperature_k =
      std::clamp(0.5 * (from.temperature_k + to.temperature_k), kTemperatureMinK, kTemperatureMaxK);
  const double n_from = air_mol_m3(from), n_to = air_mol_m3(to);
  const double n_air = mean_density(n_from, n_to);

  const auto column = [&](double from_ppmv, double to_ppmv) {
    return mean_density(n_from * from_ppmv, n_to * to_ppmv) * 1e-6 * length_m;
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
  for (const std::uint16_t g : bands.line_groups()) {
    const GasTable::Group& group = table.group[g];
    add_to_lines(table, g, ln_pressure[group.reference],
                 temperature_k / table.reference[group.reference].temperature_k - 1,
                 mol_m2[group.gas] * table.molar_mass_kg_mol[group.gas],
                 out.gas_scaled_kg_m2.data(), out.gas_plain_kg_m2.data());
  }

  const auto depth = [&](GreyAbsorber which) -> AirSpectrum& {
    return out.optical_depth[static_cast<std::size_t>(which)];
  };
  const WaterDensities a = water_of(from), b = water_of(to);
  AirSpectrum& continuum = depth(GreyAbsorber::kWaterContinuum);
  add_continuum(continuum, table.self, pressure_pa, temperature_k,
                mean_density(a.mol_m3 * a.kg_m3, b.mol_m3 * b.kg_m3), length_m, bands);
  add_continuum(continuum, table.foreign, pressure_pa, temperature_k,
                mean_density(n_from * a.per_kg * (1 - a.per_kg) * a.air_kg_m3,
                             n_to * b.per_kg * (1 - b.per_kg) * b.air_kg_m3),
                length_m, bands);
  const double n_squared_m = mean_density(n_from * n_from, n_to * n_to) * length_m;
  const double co2_mol_m3 = 0.5e-6 * (from.gas.co2_ppmv + to.gas.co2_ppmv);
  const double standard_air_m = n_air / 44.615 * length_m;  // mol/m3 at 0 C and 1013.25 hPa
  AirSpectrum &nitrogen = depth(GreyAbsorber::kNitrogen), &oxygen = depth(GreyAbsorber::kOxygen),
              &carbon_dioxide = depth(GreyAbsorber::kCo2FarWing),
              &molecular = depth(GreyAbsorber::kMolecularScattering);
  for (const BandChoice::Range& r : bands.ranges()) {
    for (std::size_t band = r.first; band < r.last; ++band) {
      nitrogen[band] += table.nitrogen_m5_mol2[band] * 0.781 * n_squared_m;
      oxygen[band] += table.oxygen_m5_mol2[band] * 0.2095 * n_squared_m;
      carbon_dioxide[band] += table.carbon_dioxide_m5_mol2[band] * co2_mol_m3 * n_squared_m;
      molecular[band] += table.molecular_per_m[band] * standard_air_m;
    }
  }
}

}  // namespace irsig
