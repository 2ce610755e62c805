#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <string>

#include "absl/status/statusor.h"

namespace irsig {

// A private folder (mode 0700) below TMPDIR or /tmp, removed with this object. Each process holds a
// lock on its folder, which the kernel releases however the process ends. The next process that
// makes a folder removes those of killed processes.
class ScratchFolder {
 public:
  // Creates the folder in TMPDIR. longest_path: if the path of TMPDIR is longer, the folder is
  // created in /tmp (the path of a Unix socket must be short).
  static absl::StatusOr<std::unique_ptr<ScratchFolder>> make(
      std::size_t longest_path = std::numeric_limits<std::size_t>::max());
  // Creates the folder in a folder of the user.
  static absl::StatusOr<std::unique_ptr<ScratchFolder>> make_in(const std::string& place);
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder();

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }

 private:
  ScratchFolder(std::string path, int lock) : path_(std::move(path)), lock_(lock) {}
  std::string path_;
  int lock_;
};

}  // namespace irsig
