#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/store/reader.h"
#include "view/rows/query_row.h"
#include "view/rows/signature_quantity.h"

namespace irsig {

// A user's query of a database; an empty string or set means "any".
struct Query {
  // The initializer {} allows designated initializers that name some of the fields.
  std::string sweep{};
  NameSet season{};  // of which a row has one
  std::string band{};
  std::string time{};                                  // RFC 3339 with any offset
  std::optional<SignatureFilter::Direction> aspect{};  // with exactly one of the next three
  std::uint32_t nearest = 0;
  std::optional<double> within_deg{};
  bool interpolate = false;
  std::optional<std::uint64_t> row{};
  // The quantity of the query: max_relative_error, people's tables and plots refer to it.
  SignatureQuantity quantity = SignatureQuantity::kIntensity;
  std::optional<double> max_relative_error{};  // of the numerical error, interpolation included
  std::optional<double> at_range_m{};          // viewpoints of this range alone
  std::vector<double> range_m{};               // as seen from each of these: range_change.h
};

// Returns the filter of a query that neither interpolates nor moves rows. INVALID_ARGUMENT: as
// below.
[[nodiscard]] absl::StatusOr<SignatureFilter> filter_of(const Query& query);

// Checks the seasons of a filter. NOT_FOUND: the database lacks one of them; the message lists
// those that it has.
[[nodiscard]] absl::Status check_seasons(StoreReader& reader, const NameSet& season);
[[nodiscard]] absl::Status check_seasons(const NameSet& season, const std::set<std::string>& known);

// Returns the reason for which a filter selects nothing. NOT_FOUND: a name, range or row is
// unknown.
[[nodiscard]] absl::Status explain_nothing(StoreReader& reader, const SignatureFilter& filter);

// Returns the rows that a query selects; no rows if nothing matches.
//   extent_of  needed for query.range_m alone; a row at several ranges gives consecutive rows
// INVALID_ARGUMENT: the question is contradictory or malformed. NOT_FOUND: a sweep, band, row or
// one of the seasons does not exist; the message lists the existing ones. OUT_OF_RANGE: the
// viewpoints do not cover the aspect. Other errors: those of at_range.
[[nodiscard]] absl::StatusOr<std::vector<QueryRow>> run_query(StoreReader& reader,
                                                              const Query& query,
                                                              const ExtentOf& extent_of = {});

// A fixed pseudo-random selection of a query's rows, at most at_most of them.
struct SomeRows {
  std::vector<QueryRow> rows;  // each at all of query.range_m
  std::size_t matching;        // stored rows
};
[[nodiscard]] absl::StatusOr<SomeRows> run_query_of_some(StoreReader& reader, const Query& query,
                                                         std::size_t at_most,
                                                         const ExtentOf& extent_of = {});

class RangeChanger;

// The rows of a query in batches, for streaming large results: memory does not grow with the number
// of rows. (Interpolated rows come all at once.) The reader must outlive this object.
class QueryRows {
 public:
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<QueryRows>> open(
      StoreReader& reader, const Query& query, const ExtentOf& extent_of = {});
  virtual ~QueryRows() = default;

  // Returns the number of stored rows to read, times the number of ranges. Rows may be left out
  // because of their error.
  [[nodiscard]] virtual std::size_t count() const = 0;
  // Returns the next rows; empty if there are no more. ABORTED: rows were replaced meanwhile.
  [[nodiscard]] virtual absl::StatusOr<std::vector<QueryRow>> next() = 0;
};

// Returns notes for a person: warnings of the rows' conditions, rows that an older irsig stored
// without contrast and background.
[[nodiscard]] std::vector<std::string> notes_on(const std::vector<QueryRow>& rows);

// Returns a note if the nearest viewpoints are far from the requested aspect, or if the viewpoints
// of an interpolation are all above or all below it; empty: neither.
[[nodiscard]] std::string far_note(const std::vector<QueryRow>& rows, const Query& query);

struct RowSpectrum {
  schema::Spectrum spectrum;
  std::vector<double>
      spectral_interpolation_error_w_sr_um;  // of the source spectrum; empty: not interpolated
};
struct RowPart {
  StoredPart part;
  double interpolation_error_w_sr;  // 0: not interpolated
};

// Returns the spectrum or the parts of a row. For an interpolated row, both use the row's own
// weights, so that they add up to its value.
[[nodiscard]] absl::StatusOr<RowSpectrum> spectrum_of(StoreReader& reader, const QueryRow& row);
[[nodiscard]] absl::StatusOr<std::vector<RowPart>> parts_of(StoreReader& reader,
                                                            const QueryRow& row);

}  // namespace irsig
