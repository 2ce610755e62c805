#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "schema/job.pb.h"

namespace irsig {

// Numbers of stored objects of a sweep, from its counts alone.
struct SweepSize {
  std::uint64_t viewpoints = 0, conditions = 0, bands = 0;
  std::uint64_t all_viewpoints = 0;  // more than viewpoints: of a shard
  std::uint64_t wavelengths = 0;     // of all bands together
  std::uint64_t profile_rows = 0;
  // Estimate: 0.8 to 1.3 of the file's size in sweeps of 100 rows and more.
  double database_bytes = 0;

  [[nodiscard]] std::uint64_t rows() const { return viewpoints * conditions * bands; }
};

// Computes the size of a sweep. asset_bytes: size of the files stored in the database (model,
// temperature fields).
[[nodiscard]] SweepSize size_of(const schema::ResolvedSweep& sweep, std::size_t asset_bytes);

// Describes the rows: "191 viewpoints x 3 conditions x 2 bands = 1146 rows"; for a shard: "64 of
// 191 viewpoints ...".
[[nodiscard]] std::string rows_text(const SweepSize& size);
// Describes the size: "191 viewpoints x 3 conditions x 2 bands = 1146 rows, 122 wavelengths,
// database about 45 MB".
[[nodiscard]] std::string size_text(const SweepSize& size);

// Limits of a sweep without --yes.
inline constexpr double kMostBytesUnasked = 5e9;
inline constexpr std::uint64_t kMostRowsUnasked = 1'000'000, kMostWavelengthsUnasked = 10'000;

// Checks these limits. INVALID_ARGUMENT: one is exceeded; the message names it.
[[nodiscard]] absl::Status check_size(const SweepSize& size);

}  // namespace irsig
