#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "schema/store/reader.h"

namespace irsig {

struct SliceAsked {
  SignatureFilter filter;
  std::string filter_text = {};  // of the options that it was made from, for people
  bool source_digest = false;    // also compute the source's digest, which reads all of it
};

struct Sliced {
  std::uint64_t rows, source_rows;
  std::string digest;         // StoreReader::digest of the slice
  std::string source_digest;  // empty: not requested
};

// Callback: given the number of rows copied and the total, returns OK to continue; another status
// ends the slice and removes the file.
using SliceProgress = std::function<absl::Status(std::uint64_t rows, std::uint64_t of)>;

// Makes a database of the rows that a filter selects, with everything that belongs to them. Rows of
// an earlier version of a sweep are not copied. Sweeps keep their names and have the viewpoints,
// conditions and bands of those rows, so that rows get new numbers; all jobs are done.
// ResolvedSweep.slice records the source. Slicing all of a finished database gives the same digest,
// and two slices in sequence equal one slice by both filters.
//
// The file appears when it is complete and is readable by its owner alone. The source may be
// written to meanwhile: the slice shows one moment. NOT_FOUND: no row matches. INVALID_ARGUMENT:
// `to` exists, or cannot be made.
[[nodiscard]] absl::StatusOr<Sliced> slice_database(const std::string& from,
                                                    const SliceAsked& asked, const std::string& to,
                                                    const SliceProgress& progress = {});

}  // namespace irsig
