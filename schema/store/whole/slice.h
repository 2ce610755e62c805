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
  bool source_digest = false;    // say the source's digest, too: all of it is read for that
};

struct Sliced {
  std::uint64_t rows, source_rows;
  std::string digest;         // StoreReader::digest of the slice
  std::string source_digest;  // empty: not asked for
};

// Callback: given the numbers of rows copied and in all, returns OK to continue; another status
// ends the slice, and leaves nothing.
using SliceProgress = std::function<absl::Status(std::uint64_t rows, std::uint64_t of)>;

// Makes a database of the rows that a filter selects, with all that belongs to them and nothing
// else; rows of an earlier version of a sweep stay behind. Its sweeps keep their names, and have
// the viewpoints, conditions and bands of those rows, so that rows have new numbers; all jobs are
// done. ResolvedSweep.slice says where it comes from. Slicing all of a finished database gives one
// of the same digest, and so do two slices one after the other and one of both filters.
//
// The file appears when it is complete, readable by its owner alone. The source may be written to
// meanwhile: the slice is of one moment. NOT_FOUND: no row matches. INVALID_ARGUMENT: `to` exists,
// or cannot be made.
[[nodiscard]] absl::StatusOr<Sliced> slice_database(const std::string& from,
                                                    const SliceAsked& asked, const std::string& to,
                                                    const SliceProgress& progress = {});

}  // namespace irsig
