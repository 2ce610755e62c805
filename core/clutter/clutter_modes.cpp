#include "core/clutter/clutter_modes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/check.h"
#include "core/base/clones.h"
#include "core/clutter/patch_means.h"
#include "core/clutter/symmetric_eigen.h"

namespace irsig {
namespace {

using Matrix = std::vector<std::vector<double>>;

// Eigenvalues below these parts of the largest one, or of the trace, are rounding.
constexpr double kRoundingOfWeights = 1e-13, kRoundingOfSpectra = 1e-12;

// Rows whose products with another one are summed side by side.
constexpr std::size_t kGramLanes = 32;

Matrix square(std::size_t n) { return Matrix(n, std::vector<double>(n, 0.0)); }

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

// Adds row[p] x columns[p][lane] to the lanes' sums, in the order of p.
IRSIG_CLONES void add_products(const double* row, const double* columns, std::size_t length,
                               double* sum) {
  double part[kGramLanes];
  for (std::size_t k = 0; k < kGramLanes; ++k) part[k] = sum[k];
  for (std::size_t p = 0; p < length; ++p)
    for (std::size_t k = 0; k < kGramLanes; ++k) part[k] += row[p] * columns[p * kGramLanes + k];
  for (std::size_t k = 0; k < kGramLanes; ++k) sum[k] = part[k];
}

// Products of each row with each other row. Each sum goes through its products in their order.
Matrix gram(std::span<const std::vector<double>* const> rows) {
  constexpr std::size_t kAtOnce = 256;  // products: what is read again stays in the cache
  const std::size_t n = rows.size();
  Matrix out = square(n);
  if (n == 0) return out;
  const std::size_t length = rows.front()->size();
  std::vector<double> side_by_side(kGramLanes * kAtOnce, 0.0), sum;
  for (std::size_t first = 0; first < n; first += kGramLanes) {
    const std::size_t lanes = std::min(kGramLanes, n - first);
    sum.assign(kGramLanes * (n - first), 0.0);
    for (std::size_t begin = 0; begin < length; begin += kAtOnce) {
      const std::size_t count = std::min(kAtOnce, length - begin);
      for (std::size_t k = 0; k < lanes; ++k)
        for (std::size_t p = 0; p < count; ++p)
          side_by_side[p * kGramLanes + k] = (*rows[first + k])[begin + p];
      for (std::size_t i = first; i < n; ++i)
        add_products(rows[i]->data() + begin, side_by_side.data(), count,
                     &sum[(i - first) * kGramLanes]);
    }
    for (std::size_t i = first; i < n; ++i)
      for (std::size_t k = 0; k < lanes && first + k <= i; ++k)
        out[i][first + k] = out[first + k][i] = sum[(i - first) * kGramLanes + k];
  }
  return out;
}

Matrix gram(const Matrix& rows) {
  std::vector<const std::vector<double>*> row;
  for (const std::vector<double>& r : rows) row.push_back(&r);
  return gram(row);
}

// Rows l_k with sum_k l_k^T l_k = a matrix of diagonal 1 without negative eigenvalues: Cholesky's
// factorisation, the largest diagonal that is left first, until only rounding is left.
Matrix cholesky_rows(const Matrix& of) {
  const std::size_t n = of.size();
  std::vector<double> left(n, 1.0);
  Matrix out;
  while (out.size() < n) {
    const auto pivot =
        static_cast<std::size_t>(std::max_element(left.begin(), left.end()) - left.begin());
    if (!(left[pivot] > kRoundingOfWeights)) break;
    std::vector<double> row = of[pivot];
    for (const std::vector<double>& known : out)
      for (std::size_t i = 0; i < n; ++i) row[i] -= known[pivot] * known[i];
    const double root = std::sqrt(left[pivot]);
    for (std::size_t i = 0; i < n; ++i) {
      row[i] = left[i] > 0 ? row[i] / root : 0;
      left[i] -= row[i] * row[i];
    }
    left[pivot] = 0;
    out.push_back(std::move(row));
  }
  return out;
}

// Sources whose weights lie side by side in a cache line.
constexpr std::size_t kSourcesAtOnce = 16;

Matrix weights_of(const ClutterField& field, std::size_t first, std::size_t count) {
  Matrix out(count, std::vector<double>(field.pixels()));
  for (std::size_t p = 0; p < field.pixels(); ++p)
    for (std::size_t s = 0; s < count; ++s)
      out[s][p] = static_cast<double>(field.weight[p * field.sources + first + s]);
  return out;
}

Matrix by_column(const Matrix& rows) {
  Matrix out(rows.front().size(), std::vector<double>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < out.size(); ++j) out[j][i] = rows[i][j];
  return out;
}

}  // namespace

WeightDeviations::WeightDeviations(const ClutterField& field, double target_area_m2)
    : deviation_(field.sources), sigma_(field.sources, 0.0) {
  const double side_px = patch_px(field, target_area_m2);
  // In units of their standard deviation, sources of small weight, such as the sun, keep their
  // digits.
  std::vector<std::vector<double>> by_source;  // [pixel] of some sources
  for (std::size_t s = 0; s < field.sources; ++s) {
    if (s % kSourcesAtOnce == 0)
      by_source = weights_of(field, s, std::min(kSourcesAtOnce, field.sources - s));
    PixelGrid grid{field.columns, field.rows, std::move(by_source[s % kSourcesAtOnce])};
    const double first = grid.value.front();
    for (double& v : grid.value) v -= first;
    PixelGrid patch = patch_means(grid, side_px);
    double mean = 0, unit = 0;
    for (const double v : patch.value) mean += v;
    mean /= static_cast<double>(patch.value.size());
    for (double& v : patch.value) unit = std::max(unit, std::abs(v -= mean));
    if (!(unit > 0)) continue;
    double length = 0;
    for (double& v : patch.value) length += (v / unit) * (v / unit);
    length = unit * std::sqrt(length);
    for (double& v : patch.value) v /= length;
    sigma_[s] = length / std::sqrt(static_cast<double>(patch.value.size()));
    deviation_[s] = std::move(patch.value);
  }
}

SpectralSet WeightDeviations::factor(std::span<const std::size_t> sources) const {
  std::vector<std::size_t> varies;  // places in sources
  std::vector<const std::vector<double>*> row;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (deviation_[sources[i]].empty()) continue;
    varies.push_back(i);
    row.push_back(&deviation_[sources[i]]);
  }
  SpectralSet out;
  for (const auto& of_row : cholesky_rows(gram(row))) {
    auto& factor = out.emplace_back(sources.size(), 0.0);
    for (std::size_t i = 0; i < varies.size(); ++i)
      factor[varies[i]] = of_row[i] * sigma_[sources[varies[i]]];
  }
  return out;
}

SpectralSet weight_factor(const ClutterField& field, double target_area_m2) {
  std::vector<std::size_t> all(field.sources);
  std::iota(all.begin(), all.end(), std::size_t{0});
  return WeightDeviations(field, target_area_m2).factor(all);
}

ClutterModes clutter_modes(const SpectralSet& weight_factor,
                           std::span<const SpectralSet> radiance) {
  ClutterModes out;
  out.band.resize(radiance.size());
  out.fraction.assign(radiance.size(), 1.0);
  // Spectra of the factors, all bands one after another, each divided by its unit.
  Matrix spectrum(weight_factor.size());
  std::vector<double> unit;
  for (const SpectralSet& band : radiance) {
    double trace = 0;
    Matrix of_band;
    for (const auto& factor : weight_factor) {
      IRSIG_CHECK(band.size() == factor.size());
      auto& sum = of_band.emplace_back(band.empty() ? 0 : band.front().size(), 0.0);
      for (std::size_t s = 0; s < factor.size(); ++s)
        if (factor[s] != 0)
          for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += factor[s] * band[s][i];
      trace += dot(sum, sum);
    }
    auto& sigma = out.sigma.emplace_back(band.empty() ? 0 : band.front().size(), 0.0);
    for (const auto& factor : of_band)
      for (std::size_t i = 0; i < sigma.size(); ++i) sigma[i] = std::hypot(sigma[i], factor[i]);
    unit.push_back(trace > 0 ? std::sqrt(trace) : 1);
    for (std::size_t k = 0; k < of_band.size(); ++k)
      for (const double v : of_band[k]) spectrum[k].push_back(v / unit.back());
  }
  if (spectrum.empty()) return out;
  // Modes are sqrt(eigenvalue) x eigenvector of spectrum^T spectrum; or the rows of U^T spectrum,
  // if the columns of U are the eigenvectors of spectrum spectrum^T. Of both the smaller one.
  const bool few_bins = spectrum.front().size() < spectrum.size();
  const SymmetricEigen eigen =
      symmetric_eigen(gram(few_bins ? by_column(spectrum) : spectrum), kRoundingOfSpectra);
  std::vector<double> carried(radiance.size(), 0.0), all(radiance.size(), 0.0);
  const auto add_variance = [&](const std::vector<double>& row, std::vector<double>& sum) {
    std::size_t at = 0;
    for (std::size_t b = 0; b < radiance.size(); ++b)
      for (std::size_t i = 0; i < radiance[b].front().size(); ++i, ++at)
        sum[b] += row[at] * row[at];
  };
  for (const auto& row : spectrum) add_variance(row, all);
  for (std::size_t k = 0; k < eigen.value.size() && k < kMostClutterModes; ++k) {
    bool enough = true;
    for (std::size_t b = 0; b < radiance.size(); ++b)
      enough &= carried[b] >= kClutterFraction * all[b];
    if (enough || !(eigen.value[k] > kRoundingOfSpectra * eigen.value.front())) break;
    std::vector<double> mode(spectrum.front().size(), 0.0);
    for (std::size_t i = 0; !few_bins && i < spectrum.size(); ++i)
      for (std::size_t j = 0; j < mode.size(); ++j) mode[j] += eigen.vector[k][i] * spectrum[i][j];
    for (std::size_t j = 0; few_bins && j < mode.size(); ++j)
      mode[j] = std::sqrt(eigen.value[k]) * eigen.vector[k][j];
    add_variance(mode, carried);
    std::size_t at = 0;
    for (std::size_t b = 0; b < radiance.size(); ++b) {
      auto& of_band = out.band[b].emplace_back();
      for (std::size_t i = 0; i < radiance[b].front().size(); ++i, ++at)
        of_band.push_back(unit[b] * mode[at]);
    }
  }
  for (std::size_t b = 0; b < radiance.size(); ++b)
    if (all[b] > 0) out.fraction[b] = std::min(1.0, carried[b] / all[b]);
  return out;
}

}  // namespace irsig
