#pragma once

#include <cstdint>

namespace irsig {

// Samples per replicate of the pilots that decide on a stored run's number: those of a view and
// those of a point of a profile. The second of a profile must have seen what is rare: 32 replicates
// of 4096 see a path of probability 1e-4 a dozen times.
inline constexpr std::uint64_t kFirstPilotSamples = 128, kSecondPilotSamples = 1024;
inline constexpr std::uint64_t kFirstProfileSamples = 512, kSecondProfileSamples = 4096;

// The most of a replicate: the sampler's coordinates have 23 bits.
inline constexpr std::uint64_t kMostSamples = 1u << 23;

}  // namespace irsig
