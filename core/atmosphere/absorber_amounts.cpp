#include "core/atmosphere/absorber_amounts.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "core/atmosphere/gas_table.h"
#include "core/atmosphere/vector_exp.h"
#include "core/base/check.h"

namespace irsig {
namespace {

double sum_of_exponentials(const GasTable& table, const GasTable::Entry& entry, double scaled,
                           double plain) {
  const double* k = &table.k_scaled_m2_kg[2 * entry.first_pair];
  const double* l = &table.k_plain_m2_kg[2 * entry.first_pair];
  const double* w = &table.weight[2 * entry.first_pair];
  Pair sum = {0, 0};
  for (std::uint32_t i = 0; i < entry.pairs; ++i) {
    const Pair depth = Pair{k[2 * i], k[2 * i + 1]} * scaled + Pair{l[2 * i], l[2 * i + 1]} * plain;
    sum += Pair{w[2 * i], w[2 * i + 1]} * exp_pair(-depth);
  }
  return std::min(1.0, sum[0] + sum[1]);
}

void multiply_gas(AirSpectrum& t, const AbsorberAmounts& amounts, std::size_t gas,
                  const BandChoice& bands = {}) {
  const GasTable& table = gas_table();
  for (std::size_t i = table.gas_begin[gas]; i < table.gas_begin[gas + 1]; ++i) {
    if (amounts.gas_plain_kg_m2[i] > 0 && chosen(bands, table.entry[i].band)) {
      t[table.entry[i].band] *= sum_of_exponentials(
          table, table.entry[i], amounts.gas_scaled_kg_m2[i], amounts.gas_plain_kg_m2[i]);
    }
  }
}

}  // namespace

double air_band_centre_cm1(std::size_t band) {
  return kAirFirstCm1 + (static_cast<double>(band) + 0.5) * kAirBandWidthCm1;
}

double air_band_lambda_um(std::size_t band) { return 1e4 / air_band_centre_cm1(band); }

absl::StatusOr<std::size_t> air_band(double lambda_um) {
  if (!(lambda_um >= 1e4 / kAirLastCm1 && lambda_um <= 1e4 / kAirFirstCm1)) {
    return absl::OutOfRangeError(absl::StrFormat("the air's table covers %.4g-%.4g um, not %g um",
                                                 1e4 / kAirLastCm1, 1e4 / kAirFirstCm1, lambda_um));
  }
  const double band = (1e4 / lambda_um - kAirFirstCm1) / kAirBandWidthCm1;
  return std::min(static_cast<std::size_t>(std::max(0.0, band)), kAirBandCount - 1);
}

AbsorberAmounts::AbsorberAmounts()
    : gas_scaled_kg_m2(gas_table().entry.size(), 0.0),
      gas_plain_kg_m2(gas_table().entry.size(), 0.0) {
  optical_depth.fill(AirSpectrum(kAirBandCount, 0.0));
}

AbsorberAmounts& AbsorberAmounts::operator+=(const AbsorberAmounts& other) {
  for (std::size_t i = 0; i < gas_plain_kg_m2.size(); ++i) {
    gas_scaled_kg_m2[i] += other.gas_scaled_kg_m2[i];
    gas_plain_kg_m2[i] += other.gas_plain_kg_m2[i];
  }
  for (std::size_t g = 0; g < kGreyAbsorberCount; ++g) {
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      optical_depth[g][b] += other.optical_depth[g][b];
    }
  }
  return *this;
}

AbsorberAmounts operator+(AbsorberAmounts a, const AbsorberAmounts& b) { return a += b; }

AirSpectrum transmittance(const AbsorberAmounts& amounts) {
  return transmittance(amounts, BandChoice());
}

AirSpectrum transmittance(const AbsorberAmounts& amounts, const BandChoice& bands) {
  IRSIG_CHECK(amounts.gas_plain_kg_m2.size() == gas_table().entry.size());
  if (!bands.empty()) IRSIG_CHECK(bands.size() == kAirBandCount);
  AirSpectrum t(kAirBandCount);
  for (std::size_t b = 0; b < kAirBandCount; b += 2) {
    double sum[2] = {0, 0};
    for (std::size_t j = 0; j < 2 && b + j < kAirBandCount; ++j) {
      for (const AirSpectrum& depth : amounts.optical_depth) sum[j] += depth[b + j];
    }
    const Pair grey = exp_pair(Pair{-sum[0], -sum[1]});
    t[b] = grey[0];
    if (b + 1 < kAirBandCount) t[b + 1] = grey[1];
  }
  for (std::size_t gas = 0; gas < kGasCount; ++gas) multiply_gas(t, amounts, gas, bands);
  for (std::size_t b = 0; b < bands.size(); ++b) {
    if (bands[b] == 0) t[b] = 0;
  }
  return t;
}

AirSpectrum transmittance(const AbsorberAmounts& amounts, Gas gas) {
  AirSpectrum t(kAirBandCount, 1.0);
  multiply_gas(t, amounts, static_cast<std::size_t>(gas));
  return t;
}

AirSpectrum scattering_optical_depth(const AbsorberAmounts& amounts) {
  AirSpectrum sum = amounts.grey(GreyAbsorber::kAerosolScattering);
  const AirSpectrum& molecular = amounts.grey(GreyAbsorber::kMolecularScattering);
  for (std::size_t b = 0; b < kAirBandCount; ++b) sum[b] += molecular[b];
  return sum;
}

}  // namespace irsig
