#pragma once

#include <memory>
#include <ostream>
#include <span>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "view/base/table.h"
#include "view/query/band_sum.h"
#include "view/query/query.h"

namespace irsig {

struct QueryContent {
  bool spectrum = false;  // one line per wavelength
  bool wide = false;      // one column per wavelength of the quantity's spectrum; not with these
  bool parts = false;     // one line per part; not together with spectrum
  bool causes = false;    // columns by cause: emitted, sun, sky, sea, other parts
  SignatureQuantity quantity = SignatureQuantity::kIntensity;  // shown in tables for people
};

// Values of a spectrum and their name in the csv format.
struct SpectralColumn {
  const char* name;
  const google::protobuf::RepeatedField<float>& (schema::Spectrum::*values)() const;
};
// Returns the columns of the source intensity by cause, each followed by its standard error.
[[nodiscard]] std::span<const SpectralColumn> spectral_causes();

// Sorts rows by the values of a column; rows without a value come last. INVALID_ARGUMENT: there is
// no such column.
[[nodiscard]] absl::Status sort_rows(std::vector<QueryRow>& rows, std::string_view column,
                                     bool descending);

// Writes rows to a table; there may be many.
class RowTable {
 public:
  // Creates a table. first: some of the rows, which determine the columns. INVALID_ARGUMENT: the
  // contents cannot be combined.
  [[nodiscard]] static absl::StatusOr<RowTable> make(StoreReader& reader,
                                                     const std::vector<QueryRow>& first,
                                                     const QueryContent& content,
                                                     std::string_view format, std::ostream& out);
  RowTable(RowTable&&) noexcept;
  RowTable& operator=(RowTable&&) noexcept;
  ~RowTable();
  [[nodiscard]] absl::Status write(const QueryRow& row);
  [[nodiscard]] absl::Status finish();

 private:
  struct Parts;
  explicit RowTable(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

// Writes rows in a format of table.h. The first columns are those that scripts rely on (docs:
// `irsig query --help`).
[[nodiscard]] absl::Status write_rows(StoreReader& reader, const std::vector<QueryRow>& rows,
                                      const QueryContent& content, std::string_view format,
                                      std::ostream& out);

// Writes rows under a user's response, one line each. sum: [row]
[[nodiscard]] absl::Status write_in_band(const std::vector<QueryRow>& rows,
                                         const std::vector<InBand>& sum, SignatureQuantity quantity,
                                         std::string_view format, std::ostream& out);

}  // namespace irsig
