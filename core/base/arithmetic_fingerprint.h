#pragma once

#include <cstdint>

namespace irsig {

// A hash of what the C library's functions (exp, sin, pow, ... in double and float) and the
// processor's approximate reciprocals, which the ray tracer starts from, return for a few thousand
// fixed arguments on this machine, now. avx512: with the wide approximate reciprocals, which
// are used where AVX-512 is; where there is none it changes nothing.
//
// Libraries choose their code by the processor (glibc has variants with and without fused
// multiply-add), and the last bit differs between them; approximate reciprocals differ by maker and
// generation. Two machines with the same fingerprint agree where they could be told apart by it.
[[nodiscard]] std::uint32_t arithmetic_fingerprint(bool avx512);

}  // namespace irsig
