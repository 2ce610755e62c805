#include "core/hot_gas/column_spectra.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/spectral/planck.h"

namespace irsig {
namespace {

std::vector<GasLayer> layers_of(const GasColumn& column) {
  std::vector<GasLayer> out;
  for (const GasSegment& s : column) {
    GasLayer& layer = out.emplace_back();
    layer.state.temperature_k = s.temperature_k;
    layer.state.pressure_pa = s.pressure_pa;
    layer.state.co2 = s.mole_fraction(0);
    layer.state.h2o = s.mole_fraction(1);
    layer.state.co = s.mole_fraction(2);
    layer.state.soot = s.amount[kSoot] / s.length_m();
    layer.length_m = s.length_m();
    layer.temperature_spread_k = s.temperature_spread_k;
  }
  return out;
}

double emission_temperature_k(const GasColumn& column) {
  double sum = 0, weight = 0;
  for (const GasSegment& s : column) {
    const double w = s.weight * std::pow(s.temperature_k, 4);
    sum += w * s.temperature_k;
    weight += w;
  }
  return sum / weight;
}

}  // namespace

absl::StatusOr<GasWavelengths> GasWavelengths::make(std::vector<double> um) {
  GasWavelengths out;
  out.um_ = std::move(um);
  std::vector<std::size_t> used;
  for (const double lambda_um : out.um_) {
    const absl::StatusOr<std::size_t> band = gas_band(lambda_um);
    if (!band.ok()) return band.status();
    out.band_.push_back(*band);
    used.push_back(*band);
  }
  std::sort(used.begin(), used.end());
  for (const std::size_t band : used) {
    if (out.ranges_.empty() || band > out.ranges_.back().last)
      out.ranges_.push_back({band, band + 1});
    else
      out.ranges_.back().last = std::max(out.ranges_.back().last, band + 1);
  }
  return out;
}

namespace {

// Of the gas's bands.
struct BandLight {
  std::vector<double> emitted, absorbed, error;
};
absl::StatusOr<BandLight> band_light(const GasColumn& column, const GasWavelengths& wavelengths,
                                     const AbsorberAmounts* air) {
  const std::vector<GasLayer> layers = layers_of(column);
  BandLight out{std::vector<double>(kGasBandCount), std::vector<double>(kGasBandCount),
                std::vector<double>(kGasBandCount)};
  for (const GasBands& range : wavelengths.ranges()) {
    const auto put = [&](std::vector<double>& to, const std::vector<double>& values) {
      std::copy(values.begin(), values.end(),
                to.begin() + static_cast<std::ptrdiff_t>(range.first));
    };
    if (air == nullptr) {
      auto spectrum = gas_spectrum(layers, range);
      if (!spectrum.ok()) return spectrum.status();
      put(out.emitted, spectrum->radiance_w_m2_sr_um);
      put(out.absorbed, spectrum->absorptance);
      continue;
    }
    auto through = gas_through_air(layers, *air, range);
    if (!through.ok()) return through.status();
    put(out.emitted, through->spectrum.radiance_w_m2_sr_um);
    put(out.error, through->water_correlation_error_w_m2_sr_um);
    for (std::size_t i = 0; i < range.size(); ++i) {
      const double clear = through->air_transmittance[i];
      out.absorbed[range.first + i] = clear > 0 ? through->spectrum.absorptance[i] / clear : 0;
    }
  }
  return out;
}

}  // namespace

absl::StatusOr<ColumnLight> column_light(const GasColumn& column, const GasWavelengths& wavelengths,
                                         const AbsorberAmounts* air) {
  const absl::StatusOr<BandLight> fine = band_light(column, wavelengths, air);
  if (!fine.ok()) return fine.status();
  BandLight coarse;
  if (column.size() > 1) {
    GasColumn steps;
    for (const CoarseStep& step : coarser(column)) steps.push_back(step.segment);
    absl::StatusOr<BandLight> made = band_light(steps, wavelengths, air);
    if (!made.ok()) return made.status();
    coarse = *std::move(made);
  }
  const double temperature_k = emission_temperature_k(column);
  ColumnLight out;
  for (std::size_t i = 0; i < wavelengths.um().size(); ++i) {
    const std::size_t band = wavelengths.band(i);
    const double shape = planck_radiance_w_m2_sr_um(wavelengths.um()[i], temperature_k) /
                         planck_radiance_w_m2_sr_um(gas_band_lambda_um(band), temperature_k);
    const double step = coarse.emitted.empty() ? 0 : fine->emitted[band] - coarse.emitted[band];
    out.emitted_w_m2_sr_um.push_back(shape * (fine->emitted[band] + step));
    out.step_w_m2_sr_um.push_back(shape * step);
    out.absorbed.push_back(fine->absorbed[band]);
    out.model_error_w_m2_sr_um.push_back(shape * fine->error[band]);
  }
  return out;
}

}  // namespace irsig
