#include "core/accuracy/measured.h"

#include <algorithm>
#include <cmath>

#include "core/accuracy/replicates.h"

namespace irsig {
namespace {

#define IRSIG_BOUND_INFO(enumerator, name, shared, what) BoundInfo{name, shared, what},
constexpr std::array<BoundInfo, kBounds> kInfo = {IRSIG_BOUNDS(IRSIG_BOUND_INFO)};
#undef IRSIG_BOUND_INFO

}  // namespace

const BoundInfo& info_of(BoundOf bound) { return kInfo[static_cast<std::size_t>(bound)]; }

double Measured::bias_bound() const {
  double sum = 0;
  for (const double b : bound) sum += b;
  return sum;
}

double Measured::numerical_error() const {
  return irsig::numerical_error(stderr_, undersampling_stderr, bias_bound());
}

double Measured::share(BoundOf which) const {
  const double error = numerical_error();
  return error > 0 ? of(which) * bias_bound() / 3 / (error * error) : 0;
}

double Measured::sampled_fraction() const {
  const double error = numerical_error();
  return error > 0 ? stderr_ * stderr_ / (error * error) : 0;
}

double Measured::unseen_fraction() const {
  const double error = numerical_error();
  return error > 0 ? undersampling_stderr * undersampling_stderr / (error * error) : 0;
}

std::string_view limiting_part(const Measured& measured) {
  const BoundInfo& undersampling = info_of(BoundOf::kUnseen);
  std::string_view name;
  double most = 0;
  const auto see = [&](double fraction, std::string_view part) {
    if (!(fraction > most)) return;
    most = fraction;
    name = part;
  };
  see(measured.sampled_fraction(), kLimitedBySampling);
  see(measured.unseen_fraction() + measured.share(BoundOf::kUnseen), undersampling.name);
  for (std::size_t i = 0; i < kBounds; ++i) {
    const auto which = static_cast<BoundOf>(i);
    if (which != BoundOf::kUnseen) see(measured.share(which), info_of(which).name);
  }
  return name;
}

Measured scaled(const Measured& measured, double factor) {
  Measured out = measured;
  out.value *= factor;
  out.stderr_ *= std::abs(factor);
  out.undersampling_stderr *= std::abs(factor);
  for (double& b : out.bound) b *= std::abs(factor);
  return out;
}

Measured sum(const Measured& a, const Measured& b) {
  const std::array weight{1.0, 1.0};
  const std::array both{a, b};
  return weighted_sum(weight, both);
}

Measured difference(const Measured& a, const Measured& b, double samples_stderr) {
  Measured out = sum(a, scaled(b, -1));
  out.stderr_ = samples_stderr;
  return out;
}

Measured weighted_sum(std::span<const double> weight, std::span<const Measured> measured) {
  Measured out;
  double variance = 0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const Measured m = scaled(measured[i], weight[i]);
    out.value += m.value;
    variance += m.stderr_ * m.stderr_;
    out.undersampling_stderr += m.undersampling_stderr;
    for (std::size_t b = 0; b < kBounds; ++b) out.bound[b] += m.bound[b];
  }
  out.stderr_ = std::sqrt(variance);
  return out;
}

Measured with_rest(Measured known, double numerical_error, BoundOf rest) {
  const double square = numerical_error * numerical_error - known.stderr_ * known.stderr_ -
                        known.undersampling_stderr * known.undersampling_stderr;
  // std::max would lose an error that was not computed (NaN).
  const double bias = square < 0 ? 0.0 : std::sqrt(3 * square);
  known.of(rest) = 0;
  const double missing = bias - known.bias_bound();
  known.of(rest) = missing < 0 ? 0.0 : missing;
  return known;
}

}  // namespace irsig
