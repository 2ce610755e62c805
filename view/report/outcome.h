#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "schema/job.pb.h"
#include "schema/store/reader.h"
#include "view/query/query.h"

namespace irsig {

// Returns the requested accuracy of a sweep and the stop reasons of its rows: "1051 of 1146 rows
// reach 0.2 %, 95 only the floor of 0.05 K (floor_reached)". Empty: every row reaches the relative
// error, or no accuracy was requested.
[[nodiscard]] std::string stopped_text(const StoredOutcome& outcome,
                                       const schema::Accuracy& accuracy);

// Returns a limiting bound in words, with its name and its remedy: "temperatures of large facets
// (temperature); set [heat] element_size_m smaller, or state better temperatures".
//   limiting_bound   as stored in the column of that name (StoredSignature)
//   at_sample_limit  whether more samples would help, and the sweep allows no more
[[nodiscard]] std::string limit_text(std::string_view limiting_bound, bool at_sample_limit);

// LimitNotes counts what decides the errors of rows, one after the other.
class LimitNotes {
 public:
  void add(const StoredSignature& row);
  // Returns the notes of limit_notes().
  [[nodiscard]] std::vector<std::string> text() const;

 private:
  // Rows that did not reach their accuracy, by what decides their error: its name, and whether the
  // samples of a row are at their limit.
  std::map<std::pair<std::string, bool>, std::uint64_t> rows_;
};

// Returns the causes that decide the error of rows that did not reach their accuracy, the most
// frequent first, each with its remedy: "14 rows do not reach the accuracy: effects that are off
// (omitted); run with --effects all". Empty: every row reached it.
[[nodiscard]] std::vector<std::string> limit_notes(const std::vector<StoredSignature>& rows);
// Returns these notes for all rows of a sweep, few of which are in memory at once.
[[nodiscard]] absl::StatusOr<std::vector<std::string>> limit_notes(StoreReader& reader,
                                                                   const std::string& sweep);

// Returns the shortfall of images from the accuracy of [image]: "images are known to 0.8 % in the
// worst case, 0.5 % was asked for; raise [image] max_samples". Empty: no image falls short.
[[nodiscard]] std::string image_text(const StoredOutcome& outcome, const schema::Image& image);

// Returns a warning, with the remedy, if views were partly seen from behind. Empty: none were.
[[nodiscard]] std::string backface_text(const StoredOutcome& outcome);

// Returns the origin of a slice, one line: "sliced from a.sigdb: 12 of 48 rows, --season winter;
// sweep <sha256>".
[[nodiscard]] std::string slice_text(const schema::Slice& slice);

// Returns the number of a query's rows that stopped at their sweep's floor. [K]
[[nodiscard]] absl::StatusOr<std::vector<std::string>> floor_notes(
    StoreReader& reader, const std::vector<QueryRow>& rows);

}  // namespace irsig
