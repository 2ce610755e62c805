#pragma once

#include <cstdint>

namespace irsig {

// Returns a hash of the results of the C library's functions (exp, sin, pow, ... in double and
// float) and of the processor's approximate reciprocals, from which the ray tracer starts, for a
// few thousand fixed arguments on this machine.
//   avx512  includes the wide approximate reciprocals of AVX-512; without AVX-512 it changes
//           nothing
//
// Libraries choose their code by the processor (glibc has variants with and without fused
// multiply-add), and the last bit differs between them; approximate reciprocals differ by maker and
// generation. Two machines with the same fingerprint agree where they could be told apart by it.
[[nodiscard]] std::uint32_t arithmetic_fingerprint(bool avx512);

}  // namespace irsig
