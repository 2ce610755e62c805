#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace irsig {

// Why a value can be off by more than its samples show. Disjoint: each reason is in one bound only.
//
//   BOUND(enumerator, name, shared between bands, what)   see BoundInfo
#define IRSIG_BOUNDS(BOUND)                                                                        \
  BOUND(kTruncation, "truncation", true, "of reflections after the last one allowed")              \
  BOUND(kQuadrature, "quadrature", false, "over wavelength") /* without the basis */               \
  BOUND(kBasis, "spectral_basis", false, "of spectra carried at a few nodes")                      \
  BOUND(kUnseen, "undersampling", true, "of rare bright paths")                                    \
  BOUND(kSky, "direction_interpolation", true, "between the sky's directions")                     \
  BOUND(kOmitted, "omitted", true, "of effects that are off")                                      \
  BOUND(kDepth, "target_depth", true, "of one range for all of the target")                        \
  BOUND(kBackground, "background", true, "of directions, and of computed land, behind the target") \
  BOUND(kTemperature, "temperature", true, "of the temperatures of facets")                        \
  BOUND(kPlume, "plume", true, "of hot gas: steps along rays, spectra of a few columns")           \
  BOUND(kMoved, "moved", true, "of bringing the row to another range")

#define IRSIG_BOUND_ENUMERATOR(enumerator, name, shared, what) enumerator,
enum class BoundOf : std::uint8_t { IRSIG_BOUNDS(IRSIG_BOUND_ENUMERATOR) };
#undef IRSIG_BOUND_ENUMERATOR

#define IRSIG_COUNT_BOUND(enumerator, name, shared, what) +1
inline constexpr std::size_t kBounds = 0 IRSIG_BOUNDS(IRSIG_COUNT_BOUND);
#undef IRSIG_COUNT_BOUND

struct BoundInfo {
  std::string_view name;
  // True if the bound has one sign in all bands of a view that share their paths, so that it does
  // not average out over bands or wavelengths.
  bool shared_between_bands;
  std::string_view what;
};
[[nodiscard]] const BoundInfo& info_of(BoundOf bound);

// A number with what is known of its error: the standard error of its samples, and bounds on what
// they cannot show. Bounds are never negative.
struct Measured {
  double value = 0, stderr_ = 0;
  std::array<double, kBounds> bound{};
  // Undersampling error: a standard error for the brightest light that one sample could have
  // brought, whether or not any has. One sign in all bands of a view, as bounds may have.
  double undersampling_stderr = 0;

  [[nodiscard]] double& of(BoundOf which) { return bound[static_cast<std::size_t>(which)]; }
  [[nodiscard]] double of(BoundOf which) const { return bound[static_cast<std::size_t>(which)]; }
  // Returns the sum of the bounds, in the order of BoundOf.
  [[nodiscard]] double bias_bound() const;
  // Returns sqrt(stderr^2 + undersampling_stderr^2 + bias_bound^2 / 3): a bias known only to lie
  // within a bound of 0 counts as uniformly distributed there.
  [[nodiscard]] double numerical_error() const;
  // Returns the part of a bound, or of the standard error, in the square of the numerical error; 0
  // to 1.
  [[nodiscard]] double share(BoundOf which) const;
  [[nodiscard]] double sampled_fraction() const;
  [[nodiscard]] double unseen_fraction() const;
};

// Returns the name of what makes the largest part of the square of the numerical error: "sampling"
// (the standard error), "undersampling" (its estimate or its bound) or the name of another bound.
// Empty: the error is 0 or was not computed. The text lives as long as the program.
[[nodiscard]] std::string_view limiting_part(const Measured& measured);
inline constexpr std::string_view kLimitedBySampling = "sampling";

// Returns the value and all of its error, multiplied.
[[nodiscard]] Measured scaled(const Measured& measured, double factor);

// Returns the sum of both: independent samples, bounds that may have one sign.
[[nodiscard]] Measured sum(const Measured& a, const Measured& b);

// Returns a - b of two values on the same paths. samples_stderr is that of the paths' differences.
// Bounds do not cancel.
[[nodiscard]] Measured difference(const Measured& a, const Measured& b, double samples_stderr);

// Returns the sum of weight x value: independent samples, bounds that may have one sign everywhere.
[[nodiscard]] Measured weighted_sum(std::span<const double> weight,
                                    std::span<const Measured> measured);

// Completes a value whose numerical error is stated, but not (or not all of) its bounds: one bound
// gets the missing part of the error.
//   known  with the bounds that are stated
[[nodiscard]] Measured with_rest(Measured known, double numerical_error, BoundOf rest);

}  // namespace irsig
