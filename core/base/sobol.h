#pragma once

#include <cstdint>

namespace irsig {

// Owen-scrambled Sobol points in two dimensions, padded to any number of dimension pairs by
// shuffling the index of each pair. [burley2020]
//
// All functions are stateless: a point depends on (index, seed) alone.
//
// Scrambling: nested uniform scrambling by a hash of the bit-reversed coordinate (Laine-Karras
// construction, constants of [burley2020]). The two coordinates are the radical inverse and the
// Sobol sequence of the polynomial x + 1; bit-reversed they are the index itself and the index with
// x replaced by x + 1 over GF(2), so that no table is needed.
//
// The points with index = c modulo 2^(2k) lie in one square of side 2^-k: enumerating an index in
// strides of a power of two gives rays that are close to each other.

// Mixes the bits of a seed by SplitMix64's finaliser.
[[nodiscard]] constexpr std::uint64_t mix64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

[[nodiscard]] constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = (x >> 16) | (x << 16);
  x = ((x & 0xff00ff00u) >> 8) | ((x & 0x00ff00ffu) << 8);
  x = ((x & 0xf0f0f0f0u) >> 4) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x & 0xccccccccu) >> 2) | ((x & 0x33333333u) << 2);
  return ((x & 0xaaaaaaaau) >> 1) | ((x & 0x55555555u) << 1);
}

// Scrambles a bit-reversed coordinate by nested uniform scrambling; the result is bit-reversed too.
[[nodiscard]] constexpr std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed) {
  x += seed;
  x ^= x * 0x6c50b47cu;
  x ^= x * 0xb82f1e52u;
  x ^= x * 0xc7afe638u;
  x ^= x * 0x8d22f6e6u;
  return x;
}

// Returns the bit-reversed second Sobol coordinate of a bit-reversed index: p(x) -> p(x + 1).
[[nodiscard]] constexpr std::uint32_t second_coordinate_reversed(std::uint32_t index) {
  std::uint32_t r = index;
  r ^= (r & 0xaaaaaaaau) >> 1;
  r ^= (r & 0xccccccccu) >> 2;
  r ^= (r & 0xf0f0f0f0u) >> 4;
  r ^= (r & 0xff00ff00u) >> 8;
  r ^= (r & 0xffff0000u) >> 16;
  return r;
}

// Returns the upper 23 bits as a float in (0, 1): one bit fewer than a float holds, so that the
// largest is below 1.
[[nodiscard]] constexpr float unit_float(std::uint32_t bits) {
  return (static_cast<float>(bits >> 9) + 0.5f) * 0x1p-23f;
}

struct SeedPair {
  std::uint32_t x, y, shuffle;
};

// Returns the seeds of dimension pair `pair` in one replicate.
[[nodiscard]] constexpr SeedPair seed_pair(std::uint64_t replicate_seed, std::uint32_t pair) {
  const std::uint64_t a = mix64(replicate_seed ^ mix64(2 * static_cast<std::uint64_t>(pair) + 1));
  const std::uint64_t b = mix64(a);
  return {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(a >> 32),
          static_cast<std::uint32_t>(b)};
}

struct SamplePair {
  float x, y;
};

// Returns point `index` of an unshuffled pair (the first one: primary rays).
[[nodiscard]] constexpr SamplePair sobol_pair(std::uint32_t index, SeedPair seed) {
  return {unit_float(reverse_bits(scramble_reversed(index, seed.x))),
          unit_float(reverse_bits(scramble_reversed(second_coordinate_reversed(index), seed.y)))};
}

// Returns point `index` of a padded pair.
[[nodiscard]] constexpr SamplePair sobol_pair_shuffled(std::uint32_t index, SeedPair seed) {
  return sobol_pair(reverse_bits(scramble_reversed(reverse_bits(index), seed.shuffle)), seed);
}

}  // namespace irsig
