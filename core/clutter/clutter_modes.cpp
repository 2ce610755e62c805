#include "core/clutter/clutter_modes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/check.h"
#include "core/clutter/patch_means.h"
#include "core/clutter/symmetric_eigen.h"

namespace irsig {
namespace {

using Matrix = std::vector<std::vector<double>>;

// Eigenvalues below these parts of the largest one, or of the trace, are rounding.
constexpr double kRoundingOfWeights = 1e-13, kRoundingOfSpectra = 1e-12;

Matrix square(std::size_t n) { return Matrix(n, std::vector<double>(n, 0.0)); }

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

// Products of each row with each other row.
Matrix gram(const Matrix& rows) {
  Matrix out = square(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j) out[i][j] = out[j][i] = dot(rows[i], rows[j]);
  return out;
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

SpectralSet weight_factor(const ClutterField& field, double target_area_m2) {
  const double side_px = patch_px(field, target_area_m2);
  // Deviations of each source's weight, in units of their standard deviation: sources of small
  // weight, such as the sun, keep their digits.
  Matrix deviation;
  std::vector<double> sigma;
  std::vector<std::size_t> varies;
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
    sigma.push_back(length / std::sqrt(static_cast<double>(patch.value.size())));
    varies.push_back(s);
    deviation.push_back(std::move(patch.value));
  }
  SpectralSet out;
  if (deviation.empty()) return out;
  for (const auto& row : cholesky_rows(gram(deviation))) {
    auto& factor = out.emplace_back(field.sources, 0.0);
    for (std::size_t i = 0; i < varies.size(); ++i) factor[varies[i]] = row[i] * sigma[i];
  }
  return out;
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
