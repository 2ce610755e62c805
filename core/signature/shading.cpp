#include "core/signature/shading.h"

#include <algorithm>
#include <array>

#include "core/base/ordered_dot.h"

namespace irsig {
namespace {

// Sum over a range of a table's entries times the weights.
double over(SourceRange range, const std::vector<double>& entry, const SourceTable& table,
            const SummedWeights& sums) {
  const std::size_t n = table.columns;
  if (n == sums.columns)
    return ordered_dot(entry.data() + range.first * n, sums.value.data() + range.first * n,
                       range.size() * n);
  double sum = 0;
  for (const SourceId id : range)
    sum += ordered_dot(entry.data() + index_of(id) * n, sums.row(id) + table.first_column, n);
  return sum;
}

std::size_t quantities(std::size_t parts, const BandGrid& grid, bool spectra) {
  return spectrum_quantity(parts) + (spectra ? (4 + kCauses) * grid.lambda_um.size() : 0);
}

}  // namespace

SourceTable source_table(const ConditionSources& light, const SpectralBasis* basis,
                         std::size_t first_node, std::span<const double> weight) {
  const std::size_t n = weight.size();
  SourceTable out;
  if (basis != nullptr && basis->identity()) {
    out.first_column = first_node;
    out.columns = n;
  } else if (basis != nullptr) {
    out.columns = basis->columns();
  }
  const std::size_t columns = out.columns;
  const SourceRange all = light.layout().all();
  out.source.assign(all.size() * columns, 0.0);
  out.apparent.assign(all.size() * columns, 0.0);
  for (const SourceId id : all) {
    const double* radiance = light.radiance(id).data() + first_node;
    const double* seen = light.apparent(id).data() + first_node;
    double* s = out.source.data() + index_of(id) * columns;
    double* a = out.apparent.data() + index_of(id) * columns;
    if (basis == nullptr) {
      *s = ordered_dot(weight.data(), radiance, n);
      *a = ordered_dot(weight.data(), seen, n);
      continue;
    }
    for (std::size_t i = 0; i < n; ++i) {
      const double at_target = weight[i] * radiance[i], at_sensor = weight[i] * seen[i];
      if (basis->identity()) {
        s[i] = at_target;
        a[i] = at_sensor;
        continue;
      }
      const double* expand = basis->expand.data() + (first_node + i) * columns;
      for (std::size_t k = 0; k < columns; ++k) {
        s[k] += at_target * expand[k];
        a[k] += at_sensor * expand[k];
      }
    }
  }
  return out;
}

SourceTable unit_table(const SpectralBasis* basis, std::size_t first_node,
                       std::span<const double> weight) {
  double whole = 0;
  for (const double w : weight) whole += w;
  SourceTable out;
  if (basis != nullptr && basis->identity()) {
    out.first_column = first_node;
    out.columns = weight.size();
    for (const double w : weight) out.source.push_back(w / whole);
    return out;
  }
  if (basis == nullptr) {
    out.source.push_back(1);
    return out;
  }
  out.columns = basis->columns();
  out.source.assign(out.columns, 0.0);
  for (std::size_t i = 0; i < weight.size(); ++i)
    for (std::size_t k = 0; k < out.columns; ++k)
      out.source[k] += weight[i] / whole * basis->expand[(first_node + i) * out.columns + k];
  return out;
}

Shares shares(const SummedWeights& sums, const SourceLayout& layout, const SourceTable& unit) {
  const auto sum = [&](SourceRange range) {
    double total = 0;
    for (const SourceId id : range)
      total += ordered_dot(unit.source.data(), sums.row(id) + unit.first_column, unit.columns);
    return total;
  };
  return {sum(layout.all_emitted()), sum(layout.sky()), sum(layout.lower())};
}

LitWeights::LitWeights(const ConditionSources& light, std::span<const PathWeights> weights,
                       std::size_t parts) {
  own_.reserve(weights.size());
  for (const PathWeights& w : weights) {
    weight_.push_back(light.by_element() ? &own_.emplace_back(light.lit(w.weight)) : &w.weight);
    sum_.push_back(summed(*weight_.back(), light.layout(), parts));
    area_m2_.push_back(w.projected_area_m2);
  }
}

SummedWeights LitWeights::mean() const {
  const double share = 1.0 / static_cast<double>(sum_.size());
  SummedWeights mean = sum_.front();
  for (std::size_t r = 1; r < sum_.size(); ++r)
    for (std::size_t k = 0; k < mean.value.size(); ++k) mean.value[k] += sum_[r].value[k];
  for (double& w : mean.value) w *= share;
  return mean;
}

SummedWeights summed_light(const ConditionSources& light, const SourceWeights& weights,
                           std::size_t parts) {
  if (!light.by_element()) return summed(weights, light.layout(), parts);
  return summed(light.lit(weights), light.layout(), parts);
}

double in_band_w_sr(const ConditionSources& light, const SummedWeights& sums,
                    const SourceTable& in_band) {
  double sum = 0;
  for (const auto& of_cause : light.causes())
    for (const SourceRange& piece : of_cause) sum += over(piece, in_band.source, in_band, sums);
  return sum;
}

double emitted_in_band_w_sr(const SourceLayout& layout, const SummedWeights& sums,
                            const SourceTable& in_band) {
  double sum = 0;
  for (const SourceId id : layout.emitted())
    for (std::size_t k = 0; k < in_band.columns; ++k)
      sum += in_band.row(id)[k] * sums.row(id)[in_band.first_column + k];
  return sum;
}

void evaluate(const ConditionSources& light, std::size_t parts, const LitWeights& weights,
              const SpectralBasis* basis, const BandOnAxis& band, bool spectra,
              std::vector<std::vector<double>>& values) {
  const BandGrid& grid = band.grid;
  const std::vector<double>& path_radiance = light.environment().path_radiance;
  const SourceLayout& layout = light.layout();
  const std::size_t bins = grid.lambda_um.size();
  values.assign(weights.replicates(), std::vector<double>(quantities(parts, grid, spectra), 0.0));

  const auto causes = light.causes();
  // One integral over wavelength: what of each replicate goes where.
  struct Out {
    std::size_t total, cause, cause_stride, apparent, contrast, background;
  };
  const auto integrate = [&](const SourceTable& table, double path, const Out& to) {
    for (std::size_t r = 0; r < weights.replicates(); ++r) {
      const SummedWeights& sum = weights.sum(r);
      double* out = values[r].data();
      double total = 0, seen = 0;
      for (std::size_t c = 0; c < kCauses; ++c) {
        double value = 0;
        for (const SourceRange& piece : causes[c]) {
          value += over(piece, table.source, table, sum);
          seen += over(piece, table.apparent, table, sum);
        }
        out[to.cause + c * to.cause_stride] = value;
        total += value;
      }
      const double instead = over(layout.behind(), table.apparent, table, sum);
      const double area = weights.area_m2(r);
      out[to.total] = total;
      out[to.apparent] = seen + area * path;
      out[to.contrast] = seen - instead;
      out[to.background] = area > 0 ? instead / area + path : path;
    }
  };

  const std::size_t at_contrast = contrast_quantity(parts);
  const SourceTable whole = source_table(light, basis, band.first_node, grid.band_weight);
  double path = 0;
  for (std::size_t i = 0; i < band.nodes(); ++i)
    path += grid.band_weight[i] * path_radiance[band.first_node + i];
  integrate(whole, path, {0, 1, 1, kApparentQuantity, at_contrast, at_contrast + 1});
  for (std::size_t r = 0; r < weights.replicates(); ++r) {
    values[r][kAreaQuantity] = weights.area_m2(r);
    for (std::uint32_t p = 0; p < parts; ++p) {
      double sum = 0;
      weights.weight(r).for_each(p, layout.of_intensity(), [&](SourceId id, const double* w) {
        sum += ordered_dot(whole.row(id), w + whole.first_column, whole.columns);
      });
      values[r][part_quantity(p)] = sum;
    }
  }
  if (!spectra) return;
  const std::size_t at_spectra = spectrum_quantity(parts);
  for (std::size_t k = 0; k < bins; ++k) {
    const std::size_t first = grid.bin_first[k], count = grid.bin_first[k + 1] - first;
    const std::span<const double> weight(grid.bin_weight.data() + first, count);
    double path_in_bin = 0;
    for (std::size_t i = 0; i < count; ++i)
      path_in_bin += weight[i] * path_radiance[band.first_node + first + i];
    const auto at = [&](std::size_t spectrum) { return at_spectra + spectrum * bins + k; };
    integrate(source_table(light, basis, band.first_node + first, weight), path_in_bin,
              {at(0), at(1), bins, at(1 + kCauses), at(2 + kCauses), at(3 + kCauses)});
  }
}

double nodes_w_sr(std::span<const double> spectrum, const SpectralBasis* basis,
                  const BandOnAxis& band, const double* weight) {
  if (basis == nullptr) return *weight == 0 ? 0 : in_band(spectrum, band) * *weight;
  double sum = 0;
  for (std::size_t i = 0; i < band.nodes(); ++i) {
    const std::size_t node = band.first_node + i;
    const double here =
        basis->identity()
            ? weight[node]
            : ordered_dot(basis->expand.data() + node * basis->columns(), weight, basis->columns());
    sum += band.grid.band_weight[i] * spectrum[node] * here;
  }
  return sum;
}

std::vector<double> largest_on_nodes(const SummedWeights& sums, const SpectralBasis& basis) {
  std::vector<double> out, on_nodes(basis.nodes);
  for (std::uint32_t i = 0; i < sums.sources; ++i) {
    basis.to_nodes(sums.row(SourceId{i}), 0, on_nodes);
    out.push_back(*std::max_element(on_nodes.begin(), on_nodes.end()));
  }
  return out;
}

double largest_in_band_w_sr(const ConditionSources& light, const std::vector<double>& largest,
                            const BandOnAxis& band) {
  double sum = 0;
  for (const SourceId id : light.layout().of_intensity())
    if (largest[index_of(id)] > 0) sum += largest[index_of(id)] * in_band(light.radiance(id), band);
  return sum;
}

}  // namespace irsig
