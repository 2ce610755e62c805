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
  // Returns the longest side [px] that any image may have.
  [[nodiscard]] std::uint32_t most_px() const;
  // Returns the longest side [px] that the image of a row may have.
  [[nodiscard]] std::uint32_t most_px(const StoredSignature& s) const;
  // Returns the largest number of bands of a sweep.
  [[nodiscard]] std::size_t most_bands() const { return most_bands_; }
  // Returns null for a row of an earlier version of its sweep, with another band.
  [[nodiscard]] const Band* band_of(const StoredSignature& s) const;

  // Returns a file name without ending: "images/0000012", or "images/2-0000012" if there are
  // several sweeps.
  [[nodiscard]] std::string name_of(const StoredSignature& s) const;
  [[nodiscard]] std::string mask_of(const StoredSignature& s) const;

  // Returns a DATA_LOSS error that names the row; such an export cannot be continued
  // (export_journal.h).
  [[nodiscard]] absl::Status damaged(const StoredSignature& s, const std::string& how) const;

 private:
  std::vector<std::string> parts_;
  std::map<std::string, std::size_t> place_;      // of sweeps
  std::map<std::string, std::uint32_t> most_px_;  // of their images
  std::map<SweepBand, Band> band_;
  std::size_t most_bands_ = 0;
};

}  // namespace irsig
