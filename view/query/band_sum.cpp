#include "view/query/band_sum.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/accuracy/spectral_modes.h"
#include "core/base/status_macros.h"
#include "view/rows/measured_row.h"

namespace irsig {
namespace {

// Ends that were given with few digits.
constexpr double kSlackUm = 1e-9;

double at(const ResponseTable& table, double lambda_um, bool from_above) {
  // At a step both values stand at one wavelength.
  for (std::size_t i = 0; i + 1 < table.size(); ++i) {
    const SpectralPoint &a = table[i], &b = table[i + 1];
    const bool inside = from_above ? lambda_um >= a.lambda_um && lambda_um < b.lambda_um
                                   : lambda_um > a.lambda_um && lambda_um <= b.lambda_um;
    if (inside)
      return a.value +
             (b.value - a.value) * (lambda_um - a.lambda_um) / (b.lambda_um - a.lambda_um);
  }
  return 0;
}

struct Neighbours {
  std::size_t below, above;
};
Neighbours beside(std::size_t bin, std::size_t bins) {
  return {bin == 0 ? 0 : bin - 1, std::min(bin + 1, bins - 1)};
}

// From where to where a response is not 0; it is somewhere.
std::pair<double, double> support_um(const ResponseTable& response) {
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (std::size_t i = 0; i + 1 < response.size(); ++i) {
    if (response[i].value == 0 && response[i + 1].value == 0) continue;
    first = std::min(first, response[i].lambda_um);
    last = std::max(last, response[i + 1].lambda_um);
  }
  return {first, last};
}

using Values = google::protobuf::RepeatedField<float>;

absl::StatusOr<Measured> sum_of(const Values& value, const Values& value_stderr,
                                std::string_view modes, const Measured& whole, double share,
                                const BandWeights& weights) {
  const std::vector<double> mean(value.begin(), value.end());
  ASSIGN_OR_RETURN(
      const auto errors,
      SumErrors::make({value_stderr.data(), static_cast<std::size_t>(value_stderr.size())}, modes));
  // Bounds scale as the response does; the samples' error is the sum's own.
  Measured out = scaled(whole, share);
  out.value = 0;
  for (std::size_t k = 0; k < mean.size(); ++k) out.value += weights.weight[k] * mean[k];
  out.stderr_ = errors.of(weights.weight);
  out.of(BoundOf::kQuadrature) += weights.shape_bound(mean);
  return out;
}

}  // namespace

ResponseTable window(double lambda_min_um, double lambda_max_um) {
  return {{lambda_min_um, 1}, {lambda_max_um, 1}};
}

double BandWeights::shape_bound(std::span<const double> bin_mean) const {
  const std::size_t bins = bin_mean.size();
  // Off the straight line between the bins beside, nearly twice: of a step in the middle of a bin
  // these are off by a quarter of it, and what is made of its half by three sixteenths.
  std::vector<double> bent(bins, 0.0);
  for (std::size_t k = 1; k + 1 < bins; ++k)
    bent[k] = 0.9 * std::abs(bin_mean[k - 1] - 2 * bin_mean[k] + bin_mean[k + 1]);
  // The first and the last bin are beside one line alone, and their slope is that to one neighbour.
  if (bins > 2) {
    bent.front() = 1.4 * bent[1];
    bent.back() = 1.4 * bent[bins - 2];
  }
  double sum = 0;
  for (std::size_t k = 0; k < bins; ++k) {
    if (swing[k] == 0) continue;
    const auto [below, above] = beside(k, bins);
    // With two bins only, the whole difference between them may be bent.
    const double most = bins < 3 ? std::abs(bin_mean[above] - bin_mean[below])
                                 : std::max({bent[below], bent[k], bent[above]});
    sum += swing[k] * most;
  }
  return sum;
}

absl::StatusOr<BandWeights> band_weights(std::span<const double> lambda_um,
                                         const ResponseTable& response) {
  const std::size_t bins = lambda_um.size();
  if (bins < 2) return absl::InvalidArgumentError("the band has fewer than two wavelengths");
  const double first = lambda_um.front(), last = lambda_um.back(),
               step = (last - first) / static_cast<double>(bins - 1);
  BandWeights out{std::vector<double>(bins, 0.0), std::vector<double>(bins, 0.0)};
  std::vector<double> moment(bins, 0.0);  // of the response about a bin's middle
  std::vector<double> least(bins, std::numeric_limits<double>::infinity()), most(bins, 0.0),
      covered_um(bins, 0.0);
  double all = 0;
  for (std::size_t i = 0; i + 1 < response.size(); ++i) {
    const SpectralPoint &a = response[i], &b = response[i + 1];
    if (a.value == 0 && b.value == 0) continue;
    if (a.lambda_um < first - kSlackUm || b.lambda_um > last + kSlackUm)
      return absl::InvalidArgumentError(
          fmt::format("{:g} to {:g} um is outside the stored band, {:g} to {:g} um", a.lambda_um,
                      b.lambda_um, first, last));
    const double from = std::max(a.lambda_um, first), to = std::min(b.lambda_um, last);
    if (!(from < to)) continue;
    const auto bin_of = [&](double um) {
      return static_cast<std::size_t>(
          std::clamp(std::floor((um - first) / step + 0.5), 0.0, static_cast<double>(bins - 1)));
    };
    for (std::size_t k = bin_of(from); k <= bin_of(to); ++k) {
      const double low = std::max(from, lambda_um[k] - 0.5 * step),
                   high = std::min(to, lambda_um[k] + 0.5 * step);
      if (!(low < high)) continue;
      const auto value = [&](double um) {
        return a.value + (b.value - a.value) * (um - a.lambda_um) / (b.lambda_um - a.lambda_um);
      };
      // Simpson's rule: exact, since both are polynomials of at most degree two.
      const double middle = 0.5 * (low + high), sixth = (high - low) / 6;
      const double low_value = value(low), middle_value = value(middle), high_value = value(high);
      out.weight[k] += sixth * (low_value + 4 * middle_value + high_value);
      least[k] = std::min({least[k], low_value, high_value});
      most[k] = std::max({most[k], low_value, high_value});
      covered_um[k] += high - low;
      moment[k] +=
          sixth * (low_value * (low - lambda_um[k]) + 4 * middle_value * (middle - lambda_um[k]) +
                   high_value * (high - lambda_um[k]));
    }
    all += (b.lambda_um - a.lambda_um) * (a.value + b.value);
  }
  if (!(all > 0)) return absl::InvalidArgumentError("the response is 0 everywhere");
  for (std::size_t k = 0; k < bins; ++k) {
    if (covered_um[k] < kSlackUm) continue;
    const double mean = out.weight[k] / step;
    if (covered_um[k] < step - kSlackUm) least[k] = 0;
    const double swing = std::max(most[k] - mean, mean - least[k]);
    // Whole bins have none but for rounding.
    if (swing > kSlackUm / step * most[k]) out.swing[k] = swing * step;
  }
  for (std::size_t k = 0; k < bins; ++k) {
    if (std::abs(moment[k]) < 1e-12 * step * step) continue;
    const auto [below, above] = beside(k, bins);
    const double per_mean = moment[k] / (static_cast<double>(above - below) * step);
    out.weight[above] += per_mean;
    out.weight[below] -= per_mean;
  }
  return out;
}

double largest_ratio(const ResponseTable& response, const ResponseTable& own) {
  double most = 0;
  const auto compare = [&](double um, bool above) {
    const double asked = at(response, um, above);
    if (!(asked > 0)) return;
    const double has = own.empty() ? 1.0 : at(own, um, above);
    most = std::max(most, has > 0 ? asked / has : std::numeric_limits<double>::infinity());
  };
  // Between points the ratio of two straight lines has no extremum.
  for (const ResponseTable* table : {&response, &own})
    for (const SpectralPoint& point : *table)
      for (const bool above : {false, true}) compare(point.lambda_um, above);
  return most;
}

absl::StatusOr<ResponseTable> response_of(const StoredSweep& sweep, const std::string& band) {
  ResponseTable out;
  for (const schema::Band& b : sweep.resolved.sweep().band()) {
    if (b.name() != band) continue;
    for (const schema::SpectralPoint& p : b.response()) out.push_back({p.lambda_um(), p.value()});
    return out;
  }
  return absl::FailedPreconditionError(
      fmt::format("band {} is of an earlier version of its sweep: finish the sweep first", band));
}

absl::StatusOr<InBand> in_band(StoreReader& reader, const QueryRow& row,
                               const ResponseTable& response, const ResponseTable& stored) {
  if (row.interpolation)
    return absl::InvalidArgumentError(
        "an interpolated row has no spectrum whose errors are known: ask for viewpoints");
  ASSIGN_OR_RETURN(const auto got, spectrum_of(reader, row));
  const schema::Spectrum& s = got.spectrum;
  if (s.apparent_spectral_intensity_w_sr_um().empty() ||
      s.contrast_spectral_intensity_w_sr_um().empty())
    return absl::FailedPreconditionError(fmt::format(
        "row {} was stored by an older irsig, without apparent and contrast spectra: run the sweep "
        "again",
        row.signature.row));
  const std::vector<double> lambda_um(s.lambda_um().begin(), s.lambda_um().end());
  auto weights = band_weights(lambda_um, response);
  if (!weights.ok())
    return absl::InvalidArgumentError(
        fmt::format("band {}: {}", row.signature.band, std::string(weights.status().message())));
  const double step_um =
      (lambda_um.back() - lambda_um.front()) / static_cast<double>(lambda_um.size() - 1);
  if (const auto [from, to] = support_um(response); to - from < step_um - kSlackUm)
    return absl::InvalidArgumentError(
        fmt::format("band {}: {:g} to {:g} um is narrower than the stored step of {:g} um, means "
                    "over which are all that is stored; ask for step_um = {:g} in the "
                    "[[band]] of the sweep",
                    row.signature.band, from, to, step_um, (to - from) / 2));
  const double share = largest_ratio(response, stored);
  if (std::isinf(share))
    return absl::InvalidArgumentError(
        fmt::format("band {}: its own response is 0 where the other one is not, so that nothing is "
                    "known of errors there",
                    row.signature.band));
  ASSIGN_OR_RETURN(const auto source,
                   sum_of(s.spectral_intensity_w_sr_um(), s.spectral_intensity_stderr_w_sr_um(),
                          s.spectral_intensity_modes(), source_of(row.signature), share, *weights));
  ASSIGN_OR_RETURN(const auto apparent, sum_of(s.apparent_spectral_intensity_w_sr_um(),
                                               s.apparent_spectral_intensity_stderr_w_sr_um(),
                                               s.apparent_spectral_intensity_modes(),
                                               apparent_of(row.signature), share, *weights));
  ASSIGN_OR_RETURN(const auto contrast, sum_of(s.contrast_spectral_intensity_w_sr_um(),
                                               s.contrast_spectral_intensity_stderr_w_sr_um(),
                                               s.contrast_spectral_intensity_modes(),
                                               contrast_of(row.signature), share, *weights));
  return InBand{source, apparent, contrast,
                !s.spectral_intensity_modes().empty() &&
                    !s.apparent_spectral_intensity_modes().empty() &&
                    !s.contrast_spectral_intensity_modes().empty()};
}

absl::StatusOr<std::vector<InBand>> in_band(StoreReader& reader, std::span<const QueryRow> rows,
                                            const ResponseTable& response) {
  std::map<std::pair<std::string, std::string>, ResponseTable> known;
  std::vector<InBand> out;
  for (const QueryRow& row : rows) {
    const auto [own, is_new] = known.try_emplace({row.signature.sweep, row.signature.band});
    if (is_new) {
      ASSIGN_OR_RETURN(const auto sweep, reader.sweep(row.signature.sweep, SweepFiles::kNone));
      ASSIGN_OR_RETURN(own->second, response_of(sweep, row.signature.band));
    }
    ASSIGN_OR_RETURN(auto sum, in_band(reader, row, response, own->second));
    out.push_back(std::move(sum));
  }
  return out;
}

}  // namespace irsig
