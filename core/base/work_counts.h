#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace irsig {

// Counts say what computations have done. They are the same on every machine and in every run, so
// that a test can hold them where it cannot hold time (tests/cost). Each thread counts its own
// work, once a call and never inside a loop over rays.
enum class Work : std::uint8_t {
  kPatches,          // facets, or what stands for some of them, whose light may not have been met
  kThrowersTried,    // pairs of a facet and one that may throw sunlight onto it
  kPlacesTried,      // vertices and corners that may lie above a facet
  kFacetsProjected,  // onto the image plane, to find where facets can be seen past others
  kLineTerms,        // exponentials of the air's lines
  kShadedWeights,    // weights of sources that were multiplied by their light
  kGasSegments,      // pieces of rays in hot gas
  kGasSpectra        // spectra of columns of hot gas
};
inline constexpr std::array<const char*, 8> kWorkNames = {
    "patches",    "throwers_tried", "places_tried", "facets_projected",
    "line_terms", "shaded_weights", "gas_segments", "gas_spectra"};

using WorkCounts = std::array<std::uint64_t, kWorkNames.size()>;

// Returns the counts since this thread began. The caller may reset them to 0.
[[nodiscard]] inline WorkCounts& work_counts() {
  thread_local WorkCounts counts{};
  return counts;
}

inline void count_work(Work work, std::size_t times) {
  work_counts()[static_cast<std::size_t>(work)] += times;
}

}  // namespace irsig
