// irsig-heights: reads GeoTIFF files, for processes that must not crash with libtiff.
//
// usage: irsig-heights BYTES < file > raster     (core/land/read_heights.h starts it)
#include <charconv>
#include <cstdio>
#include <string>
#include <string_view>
#include <system_error>

#include "core/base/answer_subprocess.h"
#include "core/land/geotiff/read_geotiff.h"
#include "core/land/read_heights.h"

#if defined(__SANITIZE_ADDRESS__)
// AddressSanitizer's options stand in place of a limit of addresses.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "detect_leaks=0:max_allocation_size_mb=1024:hard_rss_limit_mb=4096";
}
#endif

int main(int argc, char** argv) {
  std::uint64_t bytes = 0;
  const std::string_view count = argc == 2 ? argv[1] : "";
  if (count.empty() ||
      std::from_chars(count.data(), count.data() + count.size(), bytes).ec != std::errc()) {
    std::fputs("irsig-heights: started by irsig and irsig-worker, not by hand\n", stderr);
    return 2;
  }
  irsig::answer_subprocess(
      bytes,
      [](const std::string& file) { return irsig::encode_raster(irsig::read_geotiff(file)); },
      [](const absl::Status& why) { return irsig::encode_raster(why); });
}
