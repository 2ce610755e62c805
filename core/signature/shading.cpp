#include "core/signature/shading.h"

#include <algorithm>
#include <numbers>

#include "core/spectral/planck.h"
#include "core/spectral/solar.h"

namespace irsig {

namespace {
double in_band(const std::vector<double>& radiance, const BandGrid& grid, std::size_t node_offset) {
  double sum = 0;
  for (std::size_t i = 0; i < grid.node_um.size(); ++i)
    sum += grid.band_weight[i] * radiance[node_offset + i];
  return sum;
}
}  // namespace

std::size_t quantities(std::size_t parts, const BandGrid& grid) {
  return 1 + kCauses + 2 + parts + (2 + kCauses) * grid.lambda_um.size();
}

ConditionShading::ConditionShading(const ConditionSpec& condition, const Air& air, double range_m,
                                   const SourceClasses& classes, int sun_index,
                                   const std::vector<double>& node_um)
    : classes_(classes),
      sun_index_(sun_index),
      nodes_(node_um.size()),
      none_(node_um.size(), 0.0),
      air_(air_path(air, condition.air_temperature_k, range_m, node_um)) {
  for (const double t : condition.part_temperature_k) {
    std::vector<double>& radiance = part_.emplace_back(nodes_);
    for (std::size_t i = 0; i < nodes_; ++i)
      radiance[i] = planck_radiance_w_m2_sr_um(node_um[i], t);
  }
  sun_.emplace_back(nodes_, 0.0);
  sky_.resize(nodes_);
  lower_.resize(nodes_);
  for (std::size_t i = 0; i < nodes_; ++i) {
    if (sun_index >= 0) sun_[0][i] = condition.sun_scale * solar_irradiance_w_m2_um(node_um[i]);
    sky_[i] = sky_radiance_w_m2_sr_um(condition.surroundings, node_um[i]);
    lower_[i] = lower_radiance_w_m2_sr_um(condition.surroundings, node_um[i], sun_[0][i],
                                          condition.sun_cos_zenith);
  }
}

const std::vector<double>& ConditionShading::source(std::uint32_t first,
                                                    std::uint32_t source_class) const {
  if (source_class == classes_.own()) return part_[first];
  if (source_class < classes_.sky()) return part_[source_class - classes_.part(0)];
  if (source_class == classes_.sky()) return sky_;
  if (source_class == classes_.lower()) return lower_;
  return static_cast<int>(source_class - classes_.sun(0)) == sun_index_ ? sun_[0] : none_;
}

WeightSpectra weight_spectra(const PathWeights& weights, const SourceClasses& classes,
                             const SpectralBasis& basis) {
  const std::size_t columns = basis.columns();
  WeightSpectra out{basis.nodes, {}};
  out.value.assign((classes.parts + classes.count() - 1) * basis.nodes, 0.0);
  std::vector<double> sum(columns);
  const auto put = [&](std::size_t row) {
    basis.to_nodes(sum.data(), 0, {out.value.data() + row * basis.nodes, basis.nodes});
  };
  const auto from = [&](std::uint32_t f, std::uint32_t c) {
    return weights.weight.data() + (static_cast<std::size_t>(f) * classes.count() + c) * columns;
  };
  for (std::uint32_t f = 0; f < classes.parts; ++f) {
    std::copy_n(from(f, classes.own()), columns, sum.data());
    put(f);
  }
  for (std::uint32_t c = 1; c < classes.count(); ++c) {
    std::fill(sum.begin(), sum.end(), 0.0);
    for (std::uint32_t f = 0; f < classes.parts; ++f)
      for (std::size_t k = 0; k < columns; ++k) sum[k] += from(f, c)[k];
    put(classes.parts + c - 1);
  }
  return out;
}

std::vector<double> ConditionShading::fold(const SpectralBasis& basis, const BandGrid& grid,
                                           std::size_t node_offset) const {
  std::vector<double> out, values(grid.node_um.size());
  const auto add = [&](const std::vector<double>& radiance) {
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = grid.band_weight[i] * radiance[node_offset + i];
    const std::vector<double> row = basis.fold(node_offset, values);
    out.insert(out.end(), row.begin(), row.end());
  };
  for (std::uint32_t f = 0; f < classes_.parts; ++f) add(source(f, classes_.own()));
  for (std::uint32_t c = 1; c < classes_.count(); ++c) add(source(0, c));
  return out;
}

double ConditionShading::in_band_w_sr(const std::vector<double>& weight, std::size_t columns,
                                      const std::vector<double>& folded, const BandGrid& grid,
                                      std::size_t node_offset) const {
  double sum = 0;
  for (std::uint32_t f = 0; f < classes_.parts; ++f)
    for (std::uint32_t c = 0; c < classes_.count(); ++c) {
      const double* w =
          weight.data() + (static_cast<std::size_t>(f) * classes_.count() + c) * columns;
      if (folded.empty()) {
        if (*w != 0) sum += *w * in_band(source(f, c), grid, node_offset);
        continue;
      }
      const double* s =
          folded.data() + (c == classes_.own() ? f : classes_.parts + c - 1) * columns;
      for (std::size_t k = 0; k < columns; ++k) sum += w[k] * s[k];
    }
  return sum;
}

void ConditionShading::evaluate(const PathWeights& weights, const WeightSpectra& spectra,
                                const std::vector<double>& folded, const BandGrid& grid,
                                std::size_t node_offset, std::vector<double>& out) const {
  const std::size_t n = grid.node_um.size(), bins = grid.lambda_um.size(), parts = classes_.parts;
  out.assign(quantities(parts, grid), 0.0);
  double* part_in_band = out.data() + 1 + kCauses + 2;
  std::vector<double> cause(kCauses * n, 0.0);

  const auto bin = [&](std::uint32_t first, std::uint32_t source_class) {
    return static_cast<std::size_t>(first) * classes_.count() + source_class;
  };
  const auto cause_of = [&](std::uint32_t c) {
    if (c == classes_.own()) return Cause::kEmitted;
    if (c < classes_.sky()) return Cause::kPartsReflected;
    if (c == classes_.sky()) return Cause::kSkyReflected;
    return c == classes_.lower() ? Cause::kSeaReflected : Cause::kSunReflected;
  };
  const bool spectral = !folded.empty();
  const std::size_t columns = spectral ? folded.size() / (parts + classes_.count() - 1) : 1;
  const std::uint32_t classes = sun_index_ >= 0 ? classes_.count() : classes_.sun(0);
  for (std::uint32_t c = 0; c < classes; ++c) {
    if (c >= classes_.sun(0) && c != classes_.sun(static_cast<std::uint32_t>(sun_index_))) continue;
    double* sum = cause.data() + static_cast<std::size_t>(cause_of(c)) * n;
    const bool own = c == classes_.own();
    if (spectral) {
      for (std::uint32_t f = 0; f < parts; ++f) {
        const std::size_t row = own ? f : parts + c - 1;
        const double* w = weights.weight.data() + bin(f, c) * columns;
        for (std::size_t k = 0; k < columns; ++k)
          part_in_band[f] += w[k] * folded[row * columns + k];
        if (!own && f > 0) continue;
        const double* radiance = source(f, c).data() + node_offset;
        const double* on_node = spectra.value.data() + row * spectra.nodes + node_offset;
        for (std::size_t i = 0; i < n; ++i) sum[i] += on_node[i] * radiance[i];
      }
      continue;
    }
    // Grey: the radiance is the same behind every first part, but for its own emission.
    const double shared = own ? 0 : in_band(source(0, c), grid, node_offset);
    double shared_weight = 0;
    for (std::uint32_t f = 0; f < parts; ++f) {
      const double w = weights.weight[bin(f, c)];
      part_in_band[f] += w * (own ? in_band(source(f, c), grid, node_offset) : shared);
      shared_weight += w;
      if (!own) continue;
      const double* radiance = source(f, c).data() + node_offset;
      for (std::size_t i = 0; i < n; ++i) sum[i] += w * radiance[i];
    }
    if (own || shared_weight == 0) continue;
    const double* radiance = source(0, c).data() + node_offset;
    for (std::size_t i = 0; i < n; ++i) sum[i] += shared_weight * radiance[i];
  }

  const double area = weights.projected_area_m2;
  double* stored = part_in_band + parts;
  double* apparent_spectrum = stored + (1 + kCauses) * bins;
  for (std::size_t i = 0; i < n; ++i) {
    double total = 0;
    for (std::size_t c = 0; c < kCauses; ++c) {
      const double value = cause[c * n + i];
      total += value;
      out[1 + c] += grid.band_weight[i] * value;
      stored[(1 + c) * bins + i / 4] += grid.bin_weight[i] * value;
    }
    const double apparent = total * air_.transmittance[node_offset + i] +
                            area * air_.path_radiance_w_m2_sr_um[node_offset + i];
    out[0] += grid.band_weight[i] * total;
    out[1 + kCauses] += grid.band_weight[i] * apparent;
    stored[i / 4] += grid.bin_weight[i] * total;
    apparent_spectrum[i / 4] += grid.bin_weight[i] * apparent;
  }
  out[2 + kCauses] = area;
}

double ConditionShading::largest_in_band_w_sr(const WeightSpectra& spectra, const BandGrid& grid,
                                              std::size_t node_offset) const {
  double sum = 0;
  for (std::size_t row = 0; row * spectra.nodes < spectra.value.size(); ++row) {
    const double* w = spectra.value.data() + row * spectra.nodes;
    const double largest = *std::max_element(w, w + spectra.nodes);
    if (!(largest > 0)) continue;
    const bool own = row < classes_.parts;
    sum += largest * in_band(source(own ? static_cast<std::uint32_t>(row) : 0,
                                    own ? classes_.own()
                                        : static_cast<std::uint32_t>(row - classes_.parts + 1)),
                             grid, node_offset);
  }
  return sum;
}

double ConditionShading::sun_w_m2(const BandGrid& grid, std::size_t node_offset) const {
  return in_band(sun_[0], grid, node_offset);
}

double ConditionShading::part_w_m2_sr(std::uint32_t part, const BandGrid& grid,
                                      std::size_t node_offset) const {
  return in_band(part_[part], grid, node_offset);
}

double ConditionShading::brightest_thermal_w_m2_sr(const BandGrid& grid,
                                                   std::size_t node_offset) const {
  double thermal = std::max(in_band(sky_, grid, node_offset), in_band(lower_, grid, node_offset));
  for (const auto& p : part_) thermal = std::max(thermal, in_band(p, grid, node_offset));
  return thermal;
}

double ConditionShading::brightest_w_m2_sr(const BandGrid& grid, std::size_t node_offset) const {
  return brightest_thermal_w_m2_sr(grid, node_offset) +
         sun_w_m2(grid, node_offset) / std::numbers::pi;
}

}  // namespace irsig
