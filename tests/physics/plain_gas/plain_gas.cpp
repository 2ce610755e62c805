#include "tests/physics/plain_gas/plain_gas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/atmosphere/gas_terms.h"
#include "core/base/check.h"
#include "core/gas/hot_lines.h"
#include "core/gas/narrow_band.h"
#include "core/gas/narrow_band_tables.h"
#include "core/gas/soot.h"
#include "core/spectral/planck.h"
#include "tests/physics/plain_gas/co2_band.h"
#include "tests/physics/plain_gas/curve_of_growth.h"
#include "tests/physics/plain_gas/line_path.h"
#include "tests/physics/plain_gas/water_through_air.h"

namespace irsig::plain {
namespace {

constexpr double kGasConstantJMolK = 8.31446261815324;  // exact        [codata2018]
constexpr std::array<HotGas, 3> kGases = {HotGas::kH2o, HotGas::kCo2, HotGas::kCo};

constexpr std::array<Gas, 3> kSameInAir = {Gas::kH2o, Gas::kCo2, Gas::kCo};

double mole_fraction(HotGas gas, const GasState& s) {
  return gas == HotGas::kH2o ? s.h2o : gas == HotGas::kCo2 ? s.co2 : s.co;
}

// Column of a gas along a segment.                                                [mol/m2]
double amount_mol_m2(HotGas gas, const GasLayer& segment) {
  const GasState& s = segment.state;
  return mole_fraction(gas, s) * s.pressure_pa / (kGasConstantJMolK * s.temperature_k) *
         segment.length_m;
}

// Absorption at the band's points.                                               [m2/mol]
std::vector<double> hot_line_absorption_m2_mol(HotGas gas, std::size_t band, double temperature_k,
                                               double pressure_pa) {
  const HotLineKnots& table = hot_line_knots();
  const HotLineBand* of = hot_line_band(gas, band);
  IRSIG_CHECK(of != nullptr);
  // Four knots around the temperature, at the table's ends those next to them.
  const std::vector<double>&t = table.ln_temperature, &p = table.ln_pressure_atm;
  const double x = std::log(temperature_k);
  std::size_t i = 0;
  while (i + 4 < t.size() && x > t[i + 2]) ++i;
  std::array<double, 4> knot{};
  for (std::size_t a = 0; a < 4; ++a) {
    knot[a] = 1;
    for (std::size_t b = 0; b < 4; ++b) {
      if (b != a) knot[a] *= (x - t[i + b]) / (t[i + a] - t[i + b]);
    }
  }
  const double y = std::log(pressure_pa / 101325);
  std::size_t j = 0;
  while (j + 2 < p.size() && y > p[j + 1]) ++j;
  const double v = (y - p[j]) / (p[j + 1] - p[j]);
  const std::size_t points = of->weight.size();
  std::vector<double> out(points);
  for (std::size_t n = 0; n < points; ++n) {
    double ln = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      const auto at = [&](std::size_t pressure) {
        return of->thousandth_ln[(pressure * t.size() + i + a) * points + n];
      };
      ln += knot[a] * ((1 - v) * at(j) + v * at(j + 1));
    }
    out[n] = std::exp(1e-3 * ln);
  }
  return out;
}

NarrowBand h2o_band(double wavenumber_cm1, double temperature_k) {
  const double strength = h2o_strengths().at(wavenumber_cm1, temperature_k);
  if (!(strength > 0)) return {};
  // Density of lines: a fit over all bands of the gas.
  const double t = std::clamp(temperature_k, 300.0, 2500.0);
  const double growth = -2.294 + 0.3004e-2 * t - 0.366e-6 * t * t;
  return {strength, std::exp(0.7941 * std::sin(0.0036 * wavenumber_cm1 - 8.043) + growth)};
}
NarrowBand narrow_band(HotGas gas, double wavenumber_cm1, double temperature_k) {
  if (gas == HotGas::kH2o) return h2o_band(wavenumber_cm1, temperature_k);
  return gas == HotGas::kCo2 ? plain::co2_band(wavenumber_cm1, temperature_k)
                             : co_band(wavenumber_cm1, temperature_k);
}

double product(const GasTerms& terms) {
  if (terms.depth.empty()) return 1;
  double sum = 0;
  for (std::size_t i = 0; i < terms.depth.size(); ++i) {
    sum += terms.weight[i] * std::exp(-terms.depth[i]);
  }
  return sum;
}

// One band's transmittance from the eye to the end of what was added, behind air or without.
class BandPath {
 public:
  BandPath(std::size_t band, const AbsorberAmounts* air)
      : band_(band), centre_cm1_(gas_band_centre_cm1(band)) {
    for (std::size_t g = 0; g < kGases.size(); ++g) {
      const HotLineBand* lines = hot_line_band(kGases[g], band);
      GasTerms cold;
      if (air != nullptr) cold = gas_terms(*air, kSameInAir[g], band - kAirGasBands.first);
      if (lines != nullptr) {
        std::vector<double> depth(lines->weight.size(), 0.0);
        if (lines->joint && air != nullptr) {
          IRSIG_CHECK(cold.depth.size() == lines->term_weight.size());
          for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = cold.depth[lines->term_of[i]];
        } else if (kGases[g] != HotGas::kH2o) {
          others_ *= product(cold);
        }
        lines_[g].emplace(lines->weight, std::move(depth));
        through_[g] = lines_[g]->transmittance();
      } else if (kGases[g] != HotGas::kH2o) {
        others_ *= product(cold);
      }
      if (kGases[g] == HotGas::kH2o && air != nullptr) {
        water_.emplace(cold);
        through_[g] = product(cold);
      }
    }
    if (air == nullptr) return;
    const std::size_t air_band = band - kAirGasBands.first;
    for (const Gas gas : {Gas::kO3, Gas::kN2o, Gas::kCh4, Gas::kCfc11, Gas::kCfc12}) {
      others_ *= product(gas_terms(*air, gas, air_band));
    }
    double grey = 0;
    for (const AirSpectrum& depth : air->optical_depth) grey += depth[air_band];
    others_ *= std::exp(-grey);
  }

  [[nodiscard]] double transmittance() const {
    return others_ * through_[0] * through_[1] * through_[2] * std::exp(-soot_);
  }

  struct Taken {
    Step transmittance;
    double water_spread = 0;  // one sigma of what is taken
  };
  Taken add(const GasLayer& segment) {
    const GasState& s = segment.state;
    const double soot = soot_absorption_per_m(centre_cm1_) * s.soot * segment.length_m;
    Step all = others_ * exp_minus({soot_, soot});
    soot_ += soot;
    Taken out;
    double water_spread = 0, rest = 1;
    for (std::size_t g = 0; g < kGases.size(); ++g) {
      const Step step = add(g, segment, water_spread);
      all = all * step;
      if (kGases[g] != HotGas::kH2o) rest *= step.from;
    }
    return {all, water_spread * rest * others_};
  }

 private:
  Step add(std::size_t g, const GasLayer& segment, double& water_spread) {
    const HotGas gas = kGases[g];
    Step step{through_[g], 0};
    if (!(mole_fraction(gas, segment.state) > 0) || !(segment.length_m > 0)) return step;
    const double t = segment.state.temperature_k;
    const NarrowBand band = narrow_band(gas, centre_cm1_, t);
    const double lorentz = lorentz_width_cm1(gas, segment.state) * band.lines_per_cm1;
    double weak = band.strength_per_cm_atm * amount_cm_atm(gas, segment);
    if (lines_[g]) {
      const std::vector<double> absorption =
          hot_line_absorption_m2_mol(gas, band_, t, line_pressure_pa(gas, segment.state));
      const HotLineBand* lines = hot_line_band(gas, band_);
      step = lines_[g]->add(absorption, amount_mol_m2(gas, segment));
      weak =
          amount_mol_m2(gas, segment) *
          mean_absorption_m2_mol(*lines, hot_line_place(t, line_pressure_pa(gas, segment.state)));
    } else {
      if (!(weak > 0)) return step;
      step = exp_minus(growth_[g].add(weak, lorentz,
                                      doppler_width_cm1(gas, centre_cm1_, t) * band.lines_per_cm1));
    }
    if (gas == HotGas::kH2o && water_) {
      const WaterThroughAir::Share share = water_->add(weak, lorentz);
      const double w = water_independence(t);
      water_spread = std::abs(step.by * (share.product - share.ranked)) *
                     water_independence_spread(t, share.product);
      step = {through_[g], step.by * ((1 - w) * share.ranked + w * share.product)};
    }
    through_[g] = step.to();
    return step;
  }

  std::size_t band_;
  double centre_cm1_, others_ = 1, soot_ = 0;
  std::array<CurveOfGrowth, kGases.size()> growth_;
  std::array<std::optional<LinePath>, kGases.size()> lines_;
  std::array<double, kGases.size()> through_ = {1, 1, 1};
  std::optional<WaterThroughAir> water_;
};

absl::Status check(std::span<const GasLayer> path, GasBands bands, GasBands within) {
  if (bands.first >= bands.last || bands.first < within.first || bands.last > within.last) {
    return absl::InvalidArgumentError(absl::StrFormat("gas bands %d to %d: expected %d to %d",
                                                      bands.first, bands.last, within.first,
                                                      within.last));
  }
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (const absl::Status status = check_gas(path[i]); !status.ok()) {
      return absl::Status(status.code(),
                          absl::StrFormat("segment %d: %s", i + 1, status.message()));
    }
  }
  return absl::OkStatus();
}

double emission_w_m2_sr_um(double lambda_um, const GasLayer& layer) {
  const double t = layer.state.temperature_k, spread = layer.temperature_spread_k;
  if (spread == 0) return planck_radiance_w_m2_sr_um(lambda_um, t);
  return 0.5 * (planck_radiance_w_m2_sr_um(lambda_um, t - spread) +
                planck_radiance_w_m2_sr_um(lambda_um, t + spread));
}

GasThroughAir through(std::span<const GasLayer> path, const AbsorberAmounts* air, GasBands bands) {
  GasThroughAir out{{bands, {}, {}, {}}, {}, {}};
  for (std::size_t band = bands.first; band < bands.last; ++band) {
    BandPath along(band, air);
    out.air_transmittance.push_back(along.transmittance());
    double absorptance = 0, radiance = 0, error = 0;
    for (const GasLayer& segment : path) {
      const BandPath::Taken taken = along.add(segment);
      const double b = emission_w_m2_sr_um(gas_band_lambda_um(band), segment);
      absorptance -= taken.transmittance.by;
      radiance -= taken.transmittance.by * b;
      error += taken.water_spread * b;
    }
    out.spectrum.transmittance.push_back(along.transmittance());
    out.spectrum.absorptance.push_back(absorptance);
    out.spectrum.radiance_w_m2_sr_um.push_back(radiance);
    out.water_correlation_error_w_m2_sr_um.push_back(error);
  }
  return out;
}

}  // namespace

absl::StatusOr<GasSpectrum> gas_spectrum(std::span<const GasLayer> path, GasBands bands) {
  if (absl::Status status = check(path, bands, {}); !status.ok()) return status;
  return through(path, nullptr, bands).spectrum;
}

absl::StatusOr<GasThroughAir> gas_through_air(std::span<const GasLayer> path,
                                              const AbsorberAmounts& air, GasBands bands) {
  if (absl::Status status = check(path, bands, kAirGasBands); !status.ok()) return status;
  return through(path, &air, bands);
}

}  // namespace irsig::plain
