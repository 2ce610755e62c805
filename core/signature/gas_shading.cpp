// Rows of hot gas: its rays under one condition's light and air.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/ordered_dot.h"
#include "core/base/status_macros.h"
#include "core/signature/gas_measurement.h"

namespace irsig {
namespace {

using Change = GasRow::Change;

// Fraction of the extrapolation that may be left after steps were extrapolated.
constexpr double kOfSteps = 0.25;

}  // namespace

absl::StatusOr<GasMeasurement::Sensor> GasMeasurement::behind_air(std::size_t which) const {
  const ConditionSources& light = given_.sources.wanted(condition_[which]);
  const ViewEnvironment& environment = light.environment();
  if (environment.air == nullptr && given_.request.environment != nullptr)
    return absl::InvalidArgumentError(
        "hot gas behind imported air: its lines are not known, and band means do not multiply");
  std::optional<AirBeforeColumns> air, overcast;
  if (environment.air != nullptr) {
    ASSIGN_OR_RETURN(air, AirBeforeColumns::make(*environment.air, given_.wavelengths));
  }
  if (environment.overcast_air != nullptr) {
    ASSIGN_OR_RETURN(overcast,
                     AirBeforeColumns::make(*environment.overcast_air, given_.wavelengths));
  }
  const auto at_sensor = [&](const std::vector<HotColumn>& columns,
                             const std::vector<ColumnLight>& here) {
    std::vector<ColumnLight> out;
    for (std::size_t m = 0; m < columns.size(); ++m) {
      if (air) {
        out.push_back(columns[m].behind(*air));
        if (overcast)
          out.back() =
              mixed(out.back(), columns[m].behind(*overcast), environment.overcast_fraction);
        continue;
      }
      out.push_back(here[m]);  // no air, or a grey one
      for (std::vector<double>* of :
           {&out.back().emitted_w_m2_sr_um, &out.back().model_error_w_m2_sr_um})
        for (std::size_t i = 0; i < environment.transmittance.size(); ++i)
          (*of)[i] *= environment.transmittance[i];
    }
    return out;
  };
  Sensor sensor{{at_sensor(columns_.nodes[0].column, columns_.nodes[0].here),
                 at_sensor(columns_.nodes[1].column, columns_.nodes[1].here)},
                {columns_.nodes[0].here, columns_.nodes[1].here},
                at_sensor(columns_.class_column, columns_.class_here)};
  for (std::vector<ColumnLight>& columns : sensor.product)
    for (ColumnLight& column : columns)
      for (std::size_t i = 0; i < environment.transmittance.size(); ++i)
        column.emitted_w_m2_sr_um[i] *= environment.transmittance[i];
  return sensor;
}

absl::StatusOr<std::vector<GasRow>> GasMeasurement::rows(std::size_t which) const {
  const ConditionSources& light = given_.sources.wanted(condition_[which]);
  ASSIGN_OR_RETURN(const Sensor sensor, behind_air(which));
  const LitWeights of_classes(light, traced_.mean, 1), of_replicates(light, traced_.each, 1);
  std::vector<GasRow> out;
  for (const std::uint32_t b : given_.request.selected_band)
    out.push_back(row_of(light, sensor, of_classes, of_replicates, b));
  if (images_.traced.sum.empty()) return out;
  for (std::size_t b = 0; b < out.size(); ++b) {
    const std::size_t image = which * out.size() + b;
    const std::uint32_t band = given_.request.selected_band[b];
    out[b].picture = picture_of(image, band);
    if (at_sensor()) out[b].apparent_picture = picture_of(source_images() + image, band);
  }
  return out;
}

double GasMeasurement::mean_of(const std::vector<double>& spectrum, const BandOnAxis& band) {
  double mean = 0;
  for (std::size_t i = 0; i < band.nodes(); ++i)
    mean += spectrum[band.first_node + i] / static_cast<double>(band.nodes());
  return mean;
}

double GasMeasurement::weighted(const std::vector<double>& weight,
                                const std::vector<double>& spectrum, const BandOnAxis& band) {
  double sum = 0;
  for (std::size_t i = 0; i < band.nodes(); ++i)
    sum += band.grid.band_weight[i] * weight[band.first_node + i] * spectrum[band.first_node + i];
  return sum;
}

GasMeasurement::Sent GasMeasurement::sent_by(
    const std::array<const std::vector<ColumnLight>*, 2>& light, const BandOnAxis& band) const {
  const BandGrid& grid = band.grid;
  Sent out;
  out.by_bin.assign(grid.lambda_um.size(), 0.0);
  std::array<double, 2> of_set{};
  for (std::size_t set = 0; set < columns_.nodes.size(); ++set)
    for (std::size_t m = 0; m < columns_.nodes[set].column.size(); ++m) {
      const std::vector<double>& spectrum = (*light[set])[m].emitted_w_m2_sr_um;
      const std::vector<double>& w = columns_.nodes[set].weight[m];
      of_set[set] += weighted(w, spectrum, band);
      out.steps += 0.5 * kOfSteps * std::abs(weighted(w, (*light[set])[m].step_w_m2_sr_um, band));
      for (std::size_t bin = 0; bin < out.by_bin.size(); ++bin)
        for (std::size_t i = grid.bin_first[bin]; i < grid.bin_first[bin + 1]; ++i)
          out.by_bin[bin] +=
              0.5 * w[band.first_node + i] * grid.bin_weight[i] * spectrum[band.first_node + i];
    }
  out.in_band = 0.5 * (of_set[0] + of_set[1]);
  out.sets = std::abs(of_set[0] - of_set[1]);
  return out;
}

double GasMeasurement::misfit_relative(std::size_t which_band) const {
  const std::vector<double>& tests = columns_.band_tests[which_band];
  const std::vector<double> sums = sum_of(traced_.weights);
  double missed = 0;
  for (const Nodes& nodes : columns_.nodes)
    missed += 0.5 * ordered_dot(tests.data(), nodes.misfit.data(), tests.size());
  const double all = ordered_dot(tests.data(), sums.data(), tests.size());
  return all > 0 ? missed / all : 0;
}

GasMeasurement::Taken GasMeasurement::taken_by(
    const std::vector<ColumnLight>& gas, const std::vector<RowTally>& stored, std::size_t first,
    std::vector<double> RowTally::*spectrum, double RowTally::*quantity, double sign,
    const std::vector<double>& shape, const BandOnAxis& band) const {
  const BandGrid& grid = band.grid;
  const std::size_t bins = grid.lambda_um.size();
  Taken out{std::vector<double>(bins, 0.0), {}, 0};
  for (std::size_t k = 0; k < gas.size(); ++k) {
    const RowTally& values = stored[first + k];
    const std::vector<double>& behind = values.*spectrum;
    const double* absorbed = gas[k].absorbed.data() + band.first_node;
    double lost = 0, all = 0;
    for (std::size_t bin = 0; bin < bins; ++bin) {
      double of_bin = 0, shape_of_bin = 0, of_band = 0, shape_of_band = 0;
      for (std::size_t i = grid.bin_first[bin]; i < grid.bin_first[bin + 1]; ++i) {
        const double s = shape[band.first_node + i];
        of_bin += grid.bin_weight[i] * s * absorbed[i];
        shape_of_bin += grid.bin_weight[i] * s;
        of_band += grid.band_weight[i] * s * absorbed[i];
        shape_of_band += grid.band_weight[i] * s;
      }
      if (!(shape_of_bin > 0)) continue;
      const double per_shape = sign * behind[bin] / shape_of_bin;
      out.by_bin[bin] += per_shape * of_bin;
      lost += per_shape * of_band;
      all += per_shape * shape_of_band;
    }
    out.share.push_back(all != 0 ? lost / all : 0);
    out.in_band += out.share.back() * sign * values.*quantity;
  }
  return out;
}

GasRow GasMeasurement::row_of(const ConditionSources& light, const Sensor& sensor,
                              const LitWeights& of_classes, const LitWeights& of_replicates,
                              std::uint32_t which_band) const {
  const BandOnAxis band = given_.scene.axis.band(which_band);
  const std::size_t classes = columns_.class_column.size(), bins = band.grid.lambda_um.size(),
                    replicates = traced_.weights.size();
  const SourceTable whole =
      source_table(light, given_.scene.path_basis(), band.first_node, band.grid.band_weight);
  std::vector<RowTally> stored, in_bands;
  tally_row(light, 1, of_classes, given_.scene.path_basis(), band, whole, true, stored);
  tally_row(light, 1, of_replicates, given_.scene.path_basis(), band, whole, false, in_bands);

  const Sent here = sent_by({&columns_.nodes[0].here, &columns_.nodes[1].here}, band),
             joined = sent_by({sensor.nodes.data(), sensor.nodes.data() + 1}, band),
             product = sent_by({sensor.product.data(), sensor.product.data() + 1}, band);
  // Two sets of columns that agree may both miss what the rays' tests add up to.
  const auto [misfit, luck] = errors_.columns[which_band];
  const bool without_lines = given_.request.effects.without(Effect::kHotLineCorrelation);
  const Sent& seen = without_lines ? product : joined;
  // At the sensor light is as the air lets it through.
  const std::vector<double> smooth(given_.scene.axis.nodes(), 1.0);
  const std::vector<double>& through = light.environment().transmittance;
  const Taken source = taken_by(columns_.class_here, stored, 0, &RowTally::total_spectrum,
                                &RowTally::total, 1, smooth, band),
              apparent = taken_by(sensor.classes, stored, 0, &RowTally::apparent_spectrum,
                                  &RowTally::apparent, 1, through, band);
  const std::vector<double> scatter = sent_by_replicates(traced_.weights, which_band);
  double mean = 0;
  for (const double s : scatter) mean += s / static_cast<double>(replicates);
  struct Loss {
    const Taken& taken;
    std::size_t first;
    double RowTally::*quantity;
    double sign;
  };
  const auto change = [&](const Sent& sent, std::initializer_list<Loss> losses) {
    Change c;
    ReplicateStatistics s(1 + bins);
    SpectralSet spectra;
    double lost_w_sr = 0;
    for (std::size_t r = 0; r < replicates; ++r) {
      const double share = mean > 0 ? scatter[r] / mean : 0;
      std::vector<double> value(1 + bins);
      value[0] = share * sent.in_band;
      for (std::size_t bin = 0; bin < bins; ++bin) value[1 + bin] = share * sent.by_bin[bin];
      for (const Loss& loss : losses) {
        double lost = 0;
        for (std::size_t k = 0; k < classes; ++k)
          lost += loss.taken.share[k] * loss.sign *
                  in_bands[r * class_tables() + loss.first + k].*loss.quantity;
        value[0] -= lost;
        // The spectrum of the mean, as much of it as this replicate has.
        const double part = loss.taken.in_band != 0 ? lost / loss.taken.in_band : 0;
        for (std::size_t bin = 0; bin < bins; ++bin)
          value[1 + bin] -= part * loss.taken.by_bin[bin];
        lost_w_sr += std::abs(lost) / static_cast<double>(replicates);
      }
      s.add(value);
      c.replicate.push_back(value[0]);
      spectra.emplace_back(value.begin() + 1, value.end());
    }
    c.in_band = s.estimate(0);
    for (std::size_t bin = 0; bin < bins; ++bin) {
      c.spectral.value.push_back(s.estimate(1 + bin).value);
      c.spectral.stderr_.push_back(s.estimate(1 + bin).stderr_);
    }
    c.spectral.modes = leading_modes(deviations(spectra), stored_modes(bins));
    c.bound_w_sr = sent.steps + std::max(sent.sets, luck * std::abs(sent.in_band)) +
                   misfit * std::abs(sent.in_band) + errors_.classes[which_band] * lost_w_sr;
    return c;
  };
  GasRow out;
  out.rays = traced_.rays;
  out.source = change(here, {{source, 0, &RowTally::total, 1}});
  out.apparent = change(seen, {{apparent, 0, &RowTally::apparent, 1}});
  if (on_hull_) {
    out.contrast = out.apparent;
  } else {
    // Beyond the target the contrast has all of this light, with the negative sign.
    const Taken beyond = taken_by(sensor.classes, stored, classes, &RowTally::contrast_spectrum,
                                  &RowTally::contrast, -1, through, band);
    out.contrast = change(
        seen, {{apparent, 0, &RowTally::apparent, 1}, {beyond, classes, &RowTally::contrast, -1}});
  }
  out.emitted_w_sr = here.in_band;
  out.apparent_emitted_w_sr = seen.in_band;
  if (on_hull_) {
    out.on_hull = out.source.in_band;
    out.apparent_on_hull = out.apparent.in_band;
  }
  out.lines_w_sr = std::abs(joined.in_band - product.in_band);
  if (!on_hull_) {
    out.voxel_error_w_sr = errors_.voxels[which_band] * here.in_band;
    out.apparent_voxel_error_w_sr = errors_.voxels[which_band] * seen.in_band;
    ReplicateStatistics area(1);
    for (const PathWeights& w : traced_.weights)
      // Rays of a pilot, of gas that is left out, do not say where it is thick.
      area.add(
          std::array{traced_.is_measurement ? w.gas_m2[ColumnTests::kCount + which_band] : 0.0});
    out.area_m2 = area.estimate(0);
  }
  // One model errs one way everywhere: its errors add up over columns and wavelengths.
  for (std::size_t set = 0; set < columns_.nodes.size(); ++set)
    for (std::size_t m = 0; m < columns_.nodes[set].column.size(); ++m) {
      const std::vector<double>& weight = columns_.nodes[set].weight[m];
      out.source_model_error_w_sr +=
          0.5 * weighted(weight, columns_.nodes[set].here[m].model_error_w_m2_sr_um, band);
      out.model_error_w_sr +=
          0.5 * weighted(weight, sensor.nodes[set][m].model_error_w_m2_sr_um, band);
    }
  return out;
}

}  // namespace irsig
