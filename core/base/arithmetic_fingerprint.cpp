#include "core/base/arithmetic_fingerprint.h"

#include <bit>
#include <cmath>
#include <complex>
#include <initializer_list>

#include "core/base/sobol.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace irsig {
namespace {

class Hash {
 public:
  void add(double x) { state_ = mix64(state_ ^ std::bit_cast<std::uint64_t>(x)); }
  void add(float x) { state_ = mix64(state_ ^ std::bit_cast<std::uint32_t>(x)); }
  [[nodiscard]] std::uint32_t value() const { return static_cast<std::uint32_t>(state_ >> 32); }

 private:
  std::uint64_t state_ = 0;
};

// Everything of <cmath> and <complex> that is not exactly rounded and that results depend on, and
// nothing else: the test architecture.libm compares with what the libraries call. x in (0, 1).
void add_library(Hash& hash, double x) {
  const double y = 1 - x, wide = 40 * x - 20;
  for (const double value : {std::exp(wide),
                             std::exp2(wide),
                             std::expm1(-x),
                             std::log(x),
                             std::log2(x),
                             std::log1p(-x),
                             std::log10(x),
                             ::j0(wide),
                             ::j1(wide),
                             std::pow(x, 7 * y),
                             std::sin(wide),
                             std::cos(wide),
                             std::tan(x),
                             std::asin(x),
                             std::acos(x),
                             std::atan(wide),
                             std::atan2(wide, x),
                             std::hypot(wide, x),
                             std::cbrt(wide),
                             std::erf(x),
                             std::erfc(3 * x),
                             std::lgamma(20 * x),
                             std::sinh(x),
                             std::asinh(wide),
                             std::sqrt(std::complex<double>(wide, x)).real()})
    hash.add(value);
}
void add_library(Hash& hash, float x) {
  const float y = 1 - x, wide = 40 * x - 20;
  for (const float value :
       {std::exp(wide), std::log(x), std::sin(wide), std::cos(wide), std::atan2(wide, y)})
    hash.add(value);
}

#if defined(__x86_64__)
__attribute__((target("avx512f"))) void add_wide_reciprocals(Hash& hash, float x) {
  const __m512 v = _mm512_set1_ps(x);
  hash.add(_mm512_cvtss_f32(_mm512_maskz_rcp14_ps(0xffff, v)));
  hash.add(_mm512_cvtss_f32(_mm512_maskz_rsqrt14_ps(0xffff, v)));
}
#endif

void add_reciprocals([[maybe_unused]] Hash& hash, [[maybe_unused]] float x,
                     [[maybe_unused]] bool avx512) {
#if defined(__x86_64__)
  hash.add(_mm_cvtss_f32(_mm_rcp_ss(_mm_set_ss(x))));
  hash.add(_mm_cvtss_f32(_mm_rsqrt_ss(_mm_set_ss(x))));
  if (avx512 && __builtin_cpu_supports("avx512f")) add_wide_reciprocals(hash, x);
#endif
}

}  // namespace

std::uint32_t arithmetic_fingerprint(bool avx512) {
  Hash hash;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    // Read at run time: the compiler's own arithmetic is not what is asked for.
    const volatile double at = (static_cast<double>(mix64(i) >> 12) + 0.5) * 0x1p-52;
    const volatile float at_float = (static_cast<float>(mix64(~i) >> 42) + 0.5f) * 0x1p-22f;
    add_library(hash, at);
    add_library(hash, at_float);
    add_reciprocals(hash, 1.0f + at_float, avx512);
  }
  return hash.value();
}

}  // namespace irsig
