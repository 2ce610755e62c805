#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/spectral/band.h"
#include "view/pictures/export_journal.h"
#include "view/query/query.h"

namespace irsig {

// The sweeps whose images are exported: their parts, bands and limits, and the names of files.
class ExportedSweeps {
 public:
  // Reads all sweeps of the database, or the one of that name.
  [[nodiscard]] static absl::StatusOr<ExportedSweeps> read(StoreReader& reader,
                                                           const std::string& sweep);

  // In the order of sweeps and of their lists.
  [[nodiscard]] const std::vector<std::string>& parts() const { return parts_; }
  // The longest side that any image may have.
  [[nodiscard]] std::uint32_t most_px() const;
  // The longest side that the image of a row may have.
  [[nodiscard]] std::uint32_t most_px(const StoredSignature& s) const;
  // The largest number of bands of a sweep.
  [[nodiscard]] std::size_t most_bands() const { return most_bands_; }
  // Returns null for a row of an earlier version of its sweep, with another band.
  [[nodiscard]] const Band* band_of(const StoredSignature& s) const;

  // "images/0000012", or "images/2-0000012" where there are several sweeps: without an ending.
  [[nodiscard]] std::string name_of(const StoredSignature& s) const;
  [[nodiscard]] std::string mask_of(const StoredSignature& s) const;

  // DATA_LOSS that names the row; the export ends for good (export_journal.h).
  [[nodiscard]] absl::Status damaged(const StoredSignature& s, const std::string& how) const;

 private:
  std::vector<std::string> parts_;
  std::map<std::string, std::size_t> place_;      // of sweeps
  std::map<std::string, std::uint32_t> most_px_;  // of their images
  std::map<SweepBand, Band> band_;
  std::size_t most_bands_ = 0;
};

}  // namespace irsig
