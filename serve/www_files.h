#pragma once

#include <string_view>
#include <vector>

namespace irsig {

struct WwwFile {
  std::string_view name, bytes;
};

// Returns the files of serve/www.
[[nodiscard]] const std::vector<WwwFile>& www_files();

}  // namespace irsig
