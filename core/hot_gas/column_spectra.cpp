#include "core/hot_gas/column_spectra.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/status_macros.h"
#include "core/base/work_counts.h"
#include "core/hot_gas/gas_model_error.h"
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

// Two layers in the place of a segment whose temperature changes.
std::vector<GasSegment> split(const GasSegment& s) {
  const TemperatureCourse course = course_of(s);
  if (course.is_flat) return {s};
  const double first = course.first, step_k = course.half_step_k,
               left_k = std::sqrt(std::max(0.0, s.temperature_spread_k * s.temperature_spread_k -
                                                    first * (1 - first) * step_k * step_k)),
               middle_m = s.start_m + first * s.length_m();
  const auto part = [&](double share, double temperature_k, double from_m, double to_m) {
    GasSegment out = s;
    out.start_m = from_m;
    out.end_m = to_m;
    out.weight *= share;
    for (double& amount : out.amount) amount *= share;
    out.temperature_k = temperature_k;
    out.temperature_change_k = 0;
    out.temperature_spread_k = left_k;
    return out;
  };
  return {part(first, s.temperature_k - (1 - first) * step_k, s.start_m, middle_m),
          part(1 - first, s.temperature_k + first * step_k, middle_m, s.end_m)};
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
    ASSIGN_OR_RETURN(const std::size_t band, gas_band(lambda_um));
    out.band_.push_back(band);
    used.push_back(band);
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

absl::StatusOr<std::vector<GasPath>> paths_of(const GasColumn& column,
                                              const GasWavelengths& wavelengths) {
  const std::vector<GasLayer> layers = layers_of(column);
  std::vector<GasPath> out;
  for (const GasBands& range : wavelengths.ranges()) {
    ASSIGN_OR_RETURN(GasPath path, GasPath::make(layers, range));
    out.push_back(std::move(path));
  }
  return out;
}

}  // namespace

absl::StatusOr<AirBeforeColumns> AirBeforeColumns::make(const AbsorberAmounts& air,
                                                        const GasWavelengths& wavelengths) {
  AirBeforeColumns out;
  for (const GasBands& range : wavelengths.ranges()) {
    ASSIGN_OR_RETURN(ForegroundAir made, ForegroundAir::make(air, range));
    out.range_.push_back(std::move(made));
  }
  return out;
}

absl::StatusOr<HotColumn> HotColumn::make(const GasColumn& column,
                                          const GasWavelengths& wavelengths) {
  HotColumn out;
  out.wavelengths_ = &wavelengths;
  // Steps of two sizes: a segment against two merged, or against its own parts where it is alone.
  GasColumn small, large;
  auto next = column.begin();
  for (const CoarseStep& step : coarser(column)) {
    if (step.count == 1) {
      const std::vector<GasSegment> parts = split(*next);
      small.insert(small.end(), parts.begin(), parts.end());
      large.push_back(*next);
    } else {
      small.insert(small.end(), next, next + static_cast<std::ptrdiff_t>(step.count));
      large.push_back(step.segment);
    }
    next += static_cast<std::ptrdiff_t>(step.count);
  }
  ASSIGN_OR_RETURN(out.fine_, paths_of(small, wavelengths));
  if (large.size() < small.size()) {
    ASSIGN_OR_RETURN(out.coarse_, paths_of(large, wavelengths));
  }
  const double temperature_k = emission_temperature_k(column);
  const BandLight alone = light(out.fine_, nullptr);
  out.relative_error_.assign(kGasBandCount, 0.0);
  for (const GasBands& range : wavelengths.ranges())
    for (std::size_t b = range.first; b < range.last; ++b)
      if (alone.absorbed[b] > 0)
        out.relative_error_[b] =
            absorptance_error(alone.absorbed[b], gas_band_centre_cm1(b), column, temperature_k) /
            alone.absorbed[b];
  for (std::size_t i = 0; i < wavelengths.um().size(); ++i)
    out.shape_.push_back(
        planck_radiance_w_m2_sr_um(wavelengths.um()[i], temperature_k) /
        planck_radiance_w_m2_sr_um(gas_band_lambda_um(wavelengths.band(i)), temperature_k));
  return out;
}

HotColumn::BandLight HotColumn::light(const std::vector<GasPath>& path,
                                      const AirBeforeColumns* air) {
  BandLight out;
  if (path.empty()) return out;
  count_work(Work::kGasSpectra, 1);
  for (auto* v : {&out.emitted, &out.absorbed, &out.error}) v->assign(kGasBandCount, 0.0);
  if (air != nullptr) out.air_transmittance.assign(kGasBandCount, 0.0);
  for (std::size_t r = 0; r < path.size(); ++r) {
    const auto put = [&](std::vector<double>& to, const std::vector<double>& values) {
      std::copy(values.begin(), values.end(),
                to.begin() + static_cast<std::ptrdiff_t>(path[r].alone().bands.first));
    };
    if (air == nullptr) {
      put(out.emitted, path[r].alone().radiance_w_m2_sr_um);
      put(out.absorbed, path[r].alone().absorptance);
      continue;
    }
    const GasThroughAir through = path[r].through(air->range_[r]);
    put(out.emitted, through.spectrum.radiance_w_m2_sr_um);
    put(out.error, through.water_correlation_error_w_m2_sr_um);
    put(out.air_transmittance, through.air_transmittance);
    const GasBands range = through.spectrum.bands;
    for (std::size_t i = 0; i < range.size(); ++i) {
      const double clear = through.air_transmittance[i];
      out.absorbed[range.first + i] = clear > 0 ? through.spectrum.absorptance[i] / clear : 0;
    }
  }
  return out;
}

ColumnLight HotColumn::light(const AirBeforeColumns* air) const {
  const BandLight fine = light(fine_, air), coarse = light(coarse_, air);
  ColumnLight out;
  for (std::size_t i = 0; i < shape_.size(); ++i) {
    const std::size_t band = wavelengths_->band(i);
    const double shape = shape_[i];
    const double step = coarse.emitted.empty() ? 0 : fine.emitted[band] - coarse.emitted[band];
    out.emitted_w_m2_sr_um.push_back(shape * (fine.emitted[band] + step));
    out.step_w_m2_sr_um.push_back(shape * step);
    out.absorbed.push_back(fine.absorbed[band]);
    if (air != nullptr) out.air_transmittance.push_back(fine.air_transmittance[band]);
    out.model_error_w_m2_sr_um.push_back(
        shape * std::hypot(fine.error[band], relative_error_[band] * fine.emitted[band]));
  }
  return out;
}

ColumnLight mixed(const ColumnLight& a, const ColumnLight& b, double fraction) {
  ColumnLight out = a;
  const double one = 1 - fraction, spread = std::sqrt(fraction * one);
  for (std::size_t i = 0; i < out.absorbed.size(); ++i) {
    const double clear = one * a.air_transmittance[i], cloudy = fraction * b.air_transmittance[i];
    out.emitted_w_m2_sr_um[i] = one * a.emitted_w_m2_sr_um[i] + fraction * b.emitted_w_m2_sr_um[i];
    out.step_w_m2_sr_um[i] = one * a.step_w_m2_sr_um[i] + fraction * b.step_w_m2_sr_um[i];
    out.air_transmittance[i] = clear + cloudy;
    out.absorbed[i] = clear + cloudy > 0
                          ? (clear * a.absorbed[i] + cloudy * b.absorbed[i]) / (clear + cloudy)
                          : a.absorbed[i];
    out.model_error_w_m2_sr_um[i] =
        std::hypot(one * a.model_error_w_m2_sr_um[i] + fraction * b.model_error_w_m2_sr_um[i],
                   spread * (a.emitted_w_m2_sr_um[i] - b.emitted_w_m2_sr_um[i]));
  }
  return out;
}

ColumnLight HotColumn::at_near_end() const { return light(nullptr); }
ColumnLight HotColumn::behind(const AirBeforeColumns& air) const { return light(&air); }

}  // namespace irsig
