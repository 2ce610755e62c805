#include "core/signature/view/shading.h"

#include <algorithm>
#include <array>

#include "core/base/clones.h"
#include "core/base/ordered_dot.h"
#include "core/base/work_counts.h"

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

// a += factor x b: each element by itself, the same bits however many at once.
IRSIG_CLONES void add_scaled(double factor, const double* b, std::size_t n, double* a) {
  for (std::size_t i = 0; i < n; ++i) a[i] += factor * b[i];
}

// One source's spectrum as weights that paths carry want it: a mean over each bin, of every column.
class BinRows {
 public:
  BinRows(const SpectralBasis* basis, const BandOnAxis& band)
      : basis_(basis), band_(band), bins_(band.grid.lambda_um.size()) {
    by_node_ = basis != nullptr && basis->identity();
    columns_ = basis == nullptr ? 1 : by_node_ ? 0 : basis->columns();
    value_.resize(by_node_ ? band.nodes() : columns_ * bins_);
  }

  void set(std::span<const double> radiance) {
    const double* of_band = radiance.data() + band_.first_node;
    const std::vector<double>& weight = band_.grid.bin_weight;
    if (by_node_) {
      for (std::size_t i = 0; i < value_.size(); ++i) value_[i] = weight[i] * of_band[i];
      return;
    }
    std::fill(value_.begin(), value_.end(), 0.0);
    for (std::size_t bin = 0; bin < bins_; ++bin)
      for (std::size_t i = band_.grid.bin_first[bin]; i < band_.grid.bin_first[bin + 1]; ++i) {
        const double mean = weight[i] * of_band[i];
        if (basis_ == nullptr) {
          value_[bin] += mean;
          continue;
        }
        const double* expand = basis_->expand.data() + (band_.first_node + i) * columns_;
        for (std::size_t k = 0; k < columns_; ++k) value_[k * bins_ + bin] += mean * expand[k];
      }
  }

  // weight: of the source.
  void add_to(const double* weight, double* spectrum) const {
    if (!by_node_) {
      for (std::size_t k = 0; k < columns_; ++k)
        if (weight[k] != 0) add_scaled(weight[k], value_.data() + k * bins_, bins_, spectrum);
      return;
    }
    for (std::size_t bin = 0; bin < bins_; ++bin)
      for (std::size_t i = band_.grid.bin_first[bin]; i < band_.grid.bin_first[bin + 1]; ++i)
        spectrum[bin] += weight[band_.first_node + i] * value_[i];
  }

 private:
  const SpectralBasis* basis_;
  const BandOnAxis& band_;
  std::size_t bins_, columns_ = 1;
  bool by_node_ = false;
  std::vector<double> value_;  // [column][bin], or [node]
};

// Adds the light from above or below around the target: all directions are added up in the air's
// bands before any spectrum is made of them.
//   source, apparent  where the spectra of a replicate are
template <typename Source, typename Apparent>
void add_around(const ConditionSources& light, const LitWeights& weights,
                const SpectralBasis* basis, const BandOnAxis& band, bool sky, const Source& source,
                const Apparent& apparent) {
  const IncidentRadiance& around = light.around();
  const SourceId first = light.layout().first_sky();
  if (basis != nullptr && basis->identity()) {
    // Every wavelength has weights of its own.
    BinRows here(basis, band), seen(basis, band);
    const SourceRange side = sky ? light.layout().sky() : light.layout().lower();
    for (const SourceId id : side) {
      here.set(around.radiance(index_of(id) - index_of(first)));
      seen.set(around.apparent(index_of(id) - index_of(first)));
      for (std::size_t r = 0; r < weights.replicates(); ++r) {
        here.add_to(weights.sum(r).row(id), source(r));
        seen.add_to(weights.sum(r).row(id), apparent(r));
      }
    }
    return;
  }
  const std::size_t columns = basis == nullptr ? 1 : basis->columns();
  const BandGrid& grid = band.grid;
  std::vector<IncidentRadiance::Weights> of_replicate;
  for (std::size_t k = 0; k < columns; ++k) {
    of_replicate.clear();
    for (std::size_t r = 0; r < weights.replicates(); ++r)
      of_replicate.push_back({weights.sum(r).row(first) + k, columns});
    const auto sums = around.sums(sky, of_replicate, band.first_node, band.nodes());
    for (std::size_t r = 0; r < weights.replicates(); ++r)
      for (std::size_t bin = 0; bin < grid.lambda_um.size(); ++bin)
        for (std::size_t i = grid.bin_first[bin]; i < grid.bin_first[bin + 1]; ++i) {
          const double share =
              basis == nullptr
                  ? grid.bin_weight[i]
                  : grid.bin_weight[i] * basis->expand[(band.first_node + i) * columns + k];
          source(r)[bin] += share * sums[r].radiance[i];
          apparent(r)[bin] += share * sums[r].apparent[i];
        }
  }
}

// Total, causes, apparent, contrast and background on the stored wavelengths, source by source:
// each spectrum is gone through once for all replicates.
void add_spectra(const ConditionSources& light, const LitWeights& weights,
                 const SpectralBasis* basis, const BandOnAxis& band, std::vector<RowTally>& tally) {
  const BandGrid& grid = band.grid;
  const std::size_t bins = grid.lambda_um.size();
  BinRows source(basis, band), apparent(basis, band);
  const auto causes = light.causes();
  const SourceLayout& layout = light.layout();
  for (std::size_t c = 0; c < kCauses; ++c)
    for (const SourceRange& piece : causes[c]) {
      if (layout.around().contains(SourceId{piece.first})) {
        add_around(
            light, weights, basis, band, piece.first == layout.sky().first,
            [&](std::size_t r) { return tally[r].cause_spectrum[c].data(); },
            [&](std::size_t r) { return tally[r].apparent_spectrum.data(); });
        continue;
      }
      for (const SourceId id : piece) {
        source.set(light.radiance(id));
        apparent.set(light.apparent(id));
        for (std::size_t r = 0; r < weights.replicates(); ++r) {
          source.add_to(weights.sum(r).row(id), tally[r].cause_spectrum[c].data());
          apparent.add_to(weights.sum(r).row(id), tally[r].apparent_spectrum.data());
        }
      }
    }
  for (const SourceId id : layout.behind()) {
    apparent.set(light.apparent(id));
    for (std::size_t r = 0; r < weights.replicates(); ++r)
      apparent.add_to(weights.sum(r).row(id), tally[r].background_spectrum.data());
  }
  for (std::size_t bin = 0; bin < bins; ++bin) {
    double path = 0;
    for (std::size_t i = grid.bin_first[bin]; i < grid.bin_first[bin + 1]; ++i)
      path += grid.bin_weight[i] * light.environment().path_radiance[band.first_node + i];
    for (std::size_t r = 0; r < weights.replicates(); ++r) {
      RowTally& of = tally[r];
      const double area = weights.area_m2(r), seen = of.apparent_spectrum[bin],
                   instead = of.background_spectrum[bin];
      for (std::size_t c = 0; c < kCauses; ++c) of.total_spectrum[bin] += of.cause_spectrum[c][bin];
      of.apparent_spectrum[bin] = seen + area * path;
      of.contrast_spectrum[bin] = seen - instead;
      of.background_spectrum[bin] = area > 0 ? instead / area + path : path;
    }
  }
}

}  // namespace

namespace {

// The table's rows of what is around the target.
void put_around(const ConditionSources& light, const SpectralBasis* basis, std::size_t first_node,
                std::span<const double> weight, SourceTable& table) {
  const IncidentRadiance& around = light.around();
  const SourceRange range = light.layout().around();
  const std::size_t columns = table.columns, at = range.first * columns;
  const auto from = [&](std::vector<double>& v) {
    return v.begin() + static_cast<std::ptrdiff_t>(at);
  };
  if (basis != nullptr && basis->identity()) {
    table.interpolation.resize(range.size() * columns);
    for (std::uint32_t node = 0; node < range.size(); ++node) {
      const auto put = [&](const std::vector<double>& spectrum, double* to) {
        for (std::size_t i = 0; i < columns; ++i)
          to[node * columns + i] = weight[i] * spectrum[first_node + i];
      };
      put(around.radiance(node), table.source.data() + at);
      put(around.apparent(node), table.apparent.data() + at);
      put(around.interpolation(node), table.interpolation.data());
    }
    return;
  }
  IncidentRadiance::Integrals in = around.integrals(
      first_node, weight, basis == nullptr ? nullptr : basis->expand.data() + first_node * columns,
      columns);
  std::copy(in.source.begin(), in.source.end(), from(table.source));
  std::copy(in.apparent.begin(), in.apparent.end(), from(table.apparent));
  table.interpolation = std::move(in.interpolation);
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
  const SourceRange all = light.layout().all(), around = light.layout().around();
  out.source.assign(all.size() * columns, 0.0);
  out.apparent.assign(all.size() * columns, 0.0);
  put_around(light, basis, first_node, weight, out);
  for (const SourceId id : all) {
    if (around.contains(id)) continue;
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
  return {sum(layout.all_emitted()), sum(layout.sky()), sum(layout.lower()) + sum(layout.land())};
}

LitWeights::LitWeights(const ConditionSources& light, std::span<const PathWeights> weights,
                       std::size_t parts) {
  own_.reserve(weights.size());
  for (const PathWeights& w : weights) {
    weight_.push_back(light.converts() ? &own_.emplace_back(light.lit(w.weight)) : &w.weight);
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
  if (!light.converts()) return summed(weights, light.layout(), parts);
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

void tally_row(const ConditionSources& light, std::size_t parts, const LitWeights& weights,
               const SpectralBasis* basis, const BandOnAxis& band, const SourceTable& whole,
               bool spectra, std::vector<RowTally>& tally) {
  const BandGrid& grid = band.grid;
  const std::vector<double>& path_radiance = light.environment().path_radiance;
  const SourceLayout& layout = light.layout();
  tally.resize(weights.replicates());
  const auto causes = light.causes();
  double path = 0;
  for (std::size_t i = 0; i < band.nodes(); ++i)
    path += grid.band_weight[i] * path_radiance[band.first_node + i];
  count_work(Work::kShadedWeights, weights.replicates() * whole.source.size());
  for (std::size_t r = 0; r < weights.replicates(); ++r) {
    const SummedWeights& sum = weights.sum(r);
    RowTally& out = tally[r];
    out.reset(parts, spectra ? grid.lambda_um.size() : 0);
    double seen = 0;
    for (std::size_t c = 0; c < kCauses; ++c) {
      for (const SourceRange& piece : causes[c]) {
        out.cause[c] += over(piece, whole.source, whole, sum);
        seen += over(piece, whole.apparent, whole, sum);
      }
      out.total += out.cause[c];
    }
    const double instead = over(layout.behind(), whole.apparent, whole, sum);
    const double area = weights.area_m2(r);
    out.apparent = seen + area * path;
    out.projected_area_m2 = area;
    out.contrast = seen - instead;
    out.background = area > 0 ? instead / area + path : path;
    for (std::uint32_t p = 0; spectra && p < parts; ++p) {
      if (whole.columns == weights.weight(r).columns()) {
        out.part[p] = weights.weight(r).dot(p, layout.of_intensity(), whole.source.data());
        continue;
      }
      weights.weight(r).for_each(p, layout.of_intensity(), [&](SourceId id, const double* w) {
        out.part[p] += ordered_dot(whole.row(id), w + whole.first_column, whole.columns);
      });
    }
  }
  if (spectra) add_spectra(light, weights, basis, band, tally);
}

double interpolation_w_sr(const SourceTable& table, SourceRange nodes, const SourceLayout& layout,
                          const SummedWeights& sums) {
  const std::size_t n = table.columns;
  double sum = 0;
  for (const SourceId id : nodes)
    sum += ordered_dot(table.interpolation.data() + (index_of(id) - layout.around().first) * n,
                       sums.row(id) + table.first_column, n);
  return sum;
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
  const SourceLayout& layout = light.layout();
  const std::vector<double> around =
      light.around().integrals(band.first_node, band.grid.band_weight, nullptr, 1).source;
  double sum = 0;
  for (const SourceId id : layout.of_intensity())
    if (const double weight = largest[index_of(id)]; weight > 0)
      sum += weight * (layout.around().contains(id) ? around[index_of(id) - layout.around().first]
                                                    : in_band(light.radiance(id), band));
  return sum;
}

}  // namespace irsig
