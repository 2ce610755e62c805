#include "core/atmosphere/line_loops.h"

#include <utility>

#include "core/atmosphere/lane_math.h"
#include "core/base/clones.h"

namespace irsig {

IRSIG_CLONES void multiply_lines(const LineTerms& lines, const double* scaled, const double* plain,
                                 double* t) {
  constexpr std::size_t kLanes = LineTerms::kLanes;
  for (const LineTerms::Bundle& bundle : lines.bundle) {
    double u[kLanes], v[kLanes], even[kLanes] = {}, odd[kLanes] = {};
    for (std::size_t j = 0; j < kLanes; ++j) {
      u[j] = scaled[bundle.entry[j]];
      v[j] = plain[bundle.entry[j]];
    }
    const double* k = &lines.k_scaled_m2_kg[bundle.first_term];
    const double* l = &lines.k_plain_m2_kg[bundle.first_term];
    const double* w = &lines.weight[bundle.first_term];
    for (std::size_t i = 0; i < kLanes * bundle.terms; i += 2 * kLanes) {
      for (std::size_t j = 0; j < kLanes; ++j) {
        even[j] += w[i + j] * exp_lane(-(k[i + j] * u[j] + l[i + j] * v[j]));
      }
      for (std::size_t j = 0; j < kLanes; ++j) {
        const std::size_t n = i + kLanes + j;
        odd[j] += w[n] * exp_lane(-(k[n] * u[j] + l[n] * v[j]));
      }
    }
    for (std::size_t j = 0; j < kLanes; ++j) {
      const double sum = even[j] + odd[j];
      even[j] = v[j] > 0 && sum < 1 ? sum : 1.0;
    }
    for (std::size_t j = 0; j < kLanes; ++j) t[bundle.band[j]] *= even[j];
  }
}

IRSIG_CLONES void add_to_lines(const GasTable& table, std::size_t group, double ln_pressure,
                               double warmth, double kg_m2, double* scaled, double* plain) {
  constexpr std::size_t kLanes = GasTable::kLanes;
  const std::size_t first = kLanes * group;
  for (const auto& [scaling, amounts] :
       {std::pair{&table.scaled, scaled}, std::pair{&table.plain, plain}}) {
    const double *a = &scaling->exponent[first], *b = &scaling->linear[first],
                 *c = &scaling->quadratic[first];
    double* u = amounts + first;
#pragma GCC ivdep
    for (std::size_t j = 0; j < kLanes; ++j) {
      const double warm = 1 + b[j] * warmth + c[j] * warmth * warmth;
      u[j] += kg_m2 * (warm > 0 ? warm : 0.0) * exp_lane(ln_pressure * a[j]);
    }
  }
}

}  // namespace irsig
