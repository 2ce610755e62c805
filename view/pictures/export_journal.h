#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "absl/status/statusor.h"

namespace irsig {

// State of an export of images, by which a later call continues it, and the lock that excludes a
// second process.

// The name of a sweep and of a band.
using SweepBand = std::pair<std::string, std::string>;

// Files to which every step adds lines. The files of COCO's entries become one file at the end.
enum Growing : std::size_t {
  kLabels,
  kTrainImages,
  kTrainObjects,
  kValidationImages,
  kValidationObjects
};
constexpr std::array<const char*, 5> kGrowing = {"labels.csv", "train.images", "train.objects",
                                                 "validation.images", "validation.objects"};

// Progress of an earlier call: a text of lines.
struct Journal {
  std::string asked;                  // of the question and of the rows
  std::size_t seen = 0, painted = 0;  // rows
  std::uint64_t images = 0, annotations = 0;
  std::array<std::uint64_t, kGrowing.size()> bytes{};  // of the files that grow
  std::map<SweepBand, double> hottest;                 // of the rows seen

  [[nodiscard]] std::string text() const;
  // Reads a journal. nullopt: the file does not exist or is not a journal.
  static std::optional<Journal> read(const std::string& path);
  // Cuts the growing files in `folder` back to the stated lengths. INVALID_ARGUMENT: a file is
  // shorter.
  [[nodiscard]] absl::Status cut_back(const std::string& folder) const;
};

// Marks a failure that a repeated call would meet again; no folder is left to continue.
[[nodiscard]] absl::Status final_end(absl::Status why);
[[nodiscard]] bool is_final(const absl::Status& why);

// Returns the error for a file that cannot be made. RESOURCE_EXHAUSTED: the disk is full; otherwise
// INVALID_ARGUMENT.
[[nodiscard]] absl::Status cannot_make(const std::string& path, const std::error_code& error);

// One call at a time works in a folder.
class FolderLock {
 public:
  // Locks a folder. FAILED_PRECONDITION: another process holds the lock.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<FolderLock>> take(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  explicit FolderLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;
};

}  // namespace irsig
