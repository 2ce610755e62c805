#include "core/accuracy/spectral_modes.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"

namespace irsig {
namespace {

constexpr std::size_t kStoredBytes = 8192, kSpectra = 3, kBytes = sizeof(std::int16_t);
// Fraction of a bin's variance that rounding of up to 4096 modes may add.
constexpr double kRounding = 1e-3;

std::int16_t number_at(std::string_view encoded, std::size_t at) {
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint16_t>(static_cast<unsigned char>(encoded[kBytes * at + i]));
  };
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(byte(0) | (byte(1) << 8)));
}

}  // namespace

SpectralSet deviations(const SpectralSet& replicate) {
  if (replicate.size() < 2) return {};
  const auto n = static_cast<double>(replicate.size());
  SpectralSet out = replicate;
  const double scale = 1 / std::sqrt(n * (n - 1));
  for (std::size_t i = 0; i < out.front().size(); ++i) {
    double mean = 0;
    for (const auto& spectrum : replicate) mean += spectrum[i] / n;
    for (auto& spectrum : out) spectrum[i] = (spectrum[i] - mean) * scale;
  }
  return out;
}

SpectralSet leading_modes(const SpectralSet& deviation, std::size_t at_most) {
  SpectralSet modes;
  if (deviation.empty()) return modes;
  const std::size_t bins = deviation.front().size();
  std::vector<double> variance(bins, 0.0);
  for (const auto& d : deviation)
    for (std::size_t i = 0; i < bins; ++i) variance[i] += d[i] * d[i];
  std::vector<double> rest = variance;
  while (modes.size() < at_most) {
    std::size_t pivot = 0;
    double most = kModesRest;
    for (std::size_t i = 0; i < bins; ++i)
      if (rest[i] > most * variance[i]) {
        most = rest[i] / variance[i];
        pivot = i;
      }
    if (!(most > kModesRest)) break;
    std::vector<double> mode(bins, 0.0);
    for (const auto& d : deviation)
      for (std::size_t i = 0; i < bins; ++i) mode[i] += d[pivot] * d[i];
    for (const auto& earlier : modes)
      for (std::size_t i = 0; i < bins; ++i) mode[i] -= earlier[pivot] * earlier[i];
    const double scale = 1 / std::sqrt(rest[pivot]);
    for (std::size_t i = 0; i < bins; ++i) {
      mode[i] *= scale;
      rest[i] = std::max(0.0, rest[i] - mode[i] * mode[i]);
    }
    rest[pivot] = 0;
    modes.push_back(std::move(mode));
  }
  return modes;
}

std::size_t stored_modes(std::size_t bins) {
  return bins == 0 ? 0 : kStoredBytes / (kSpectra * kBytes * bins);
}

std::string encoded_modes(const SpectralSet& modes, std::span<const double> stderr_) {
  // The modes of a bin carry at most all of its variance. Where the variance is rounding alone, or
  // too small to be squared, the two sums need not agree.
  std::vector<double> unit(stderr_.size(), 0.0);
  for (std::size_t i = 0; i < unit.size(); ++i) {
    double length = 0;
    for (const auto& mode : modes) length = std::hypot(length, mode[i]);
    if (stderr_[i] > 0) unit[i] = std::max(stderr_[i], length);
  }
  std::string out;
  for (const auto& mode : modes)
    for (std::size_t i = 0; i < mode.size(); ++i) {
      const double share = unit[i] > 0 ? std::clamp(mode[i] / unit[i], -1.0, 1.0) : 0;
      const auto number =
          static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lround(share / kModeUnit)));
      out += static_cast<char>(number & 0xff);
      out += static_cast<char>(number >> 8);
    }
  return out;
}

std::string wrong_modes(std::string_view encoded, std::size_t bins) {
  if (encoded.empty()) return "";
  if (bins == 0 || encoded.size() % (kBytes * bins) != 0)
    return absl::StrCat("has ", encoded.size(), " bytes, expected a multiple of ", kBytes * bins);
  const std::size_t modes = encoded.size() / (kBytes * bins);
  if (modes > stored_modes(bins))
    return absl::StrCat("has ", modes, " modes, expected at most ", stored_modes(bins));
  for (std::size_t i = 0; i < bins; ++i) {
    double sum = 0;
    for (std::size_t k = 0; k < modes; ++k) {
      const double share = kModeUnit * number_at(encoded, k * bins + i);
      sum += share * share;
    }
    if (sum > 1 + kRounding)
      return absl::StrCat("has ", sum, " times the variance of bin ", i, ", expected at most 1");
  }
  return "";
}

absl::StatusOr<SumErrors> SumErrors::make(std::span<const float> stderr_,
                                          std::string_view encoded) {
  if (const std::string wrong = wrong_modes(encoded, stderr_.size()); !wrong.empty())
    return absl::InvalidArgumentError(absl::StrCat("stored modes: ", wrong));
  SumErrors out;
  const std::size_t bins = stderr_.size();
  out.rest_.assign(bins, 1.0);
  for (std::size_t k = 0; bins > 0 && k < encoded.size() / (kBytes * bins); ++k) {
    auto& mode = out.modes_.emplace_back(bins);
    for (std::size_t i = 0; i < bins; ++i) {
      const double share = kModeUnit * number_at(encoded, k * bins + i);
      mode[i] = share * static_cast<double>(stderr_[i]);
      out.rest_[i] -= share * share;
    }
  }
  for (std::size_t i = 0; i < bins; ++i)
    out.rest_[i] = static_cast<double>(stderr_[i]) * std::sqrt(std::max(0.0, out.rest_[i]));
  return out;
}

double SumErrors::of(std::span<const double> weight) const {
  double sum = 0, rest = 0;
  for (const auto& mode : modes_) {
    double of_mode = 0;
    for (std::size_t i = 0; i < weight.size(); ++i) of_mode += weight[i] * mode[i];
    sum += of_mode * of_mode;
  }
  for (std::size_t i = 0; i < weight.size(); ++i) rest += std::abs(weight[i]) * rest_[i];
  return std::sqrt(sum + rest * rest);
}

}  // namespace irsig
