// irsig-volume: reads VDB files and makes them, for processes that must not crash with OpenVDB and
// need not load it.
//
// usage: irsig-volume read BYTES GRID... < file > volume     (core/plume/vdb_subprocess.h starts
// it)
//        irsig-volume write BYTES < volume > file
#include <charconv>
#include <cstdio>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "core/base/answer_subprocess.h"
#include "core/plume/vdb_subprocess.h"
#include "core/plume/volume/vdb_volume.h"

#if defined(__SANITIZE_ADDRESS__)
// AddressSanitizer's options stand in place of a limit of addresses. The kernel takes back what
// OpenVDB leaks at its errors.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "detect_leaks=0:max_allocation_size_mb=1024:hard_rss_limit_mb=4096";
}
#endif

int main(int argc, char** argv) {
  std::uint64_t bytes = 0;
  const std::string what = argc >= 3 ? argv[1] : "";
  const std::string_view count = argc >= 3 ? argv[2] : "";
  if ((what != "read" && what != "write") ||
      std::from_chars(count.data(), count.data() + count.size(), bytes).ec != std::errc()) {
    std::fputs("irsig-volume: started by irsig and irsig-worker, not by hand\n", stderr);
    return 2;
  }
  const std::vector<std::string> names(argv + 3, argv + argc);
  if (what == "read")
    irsig::answer_subprocess(
        bytes,
        [&](std::string file) { return encode_volume(irsig::read_vdb(std::move(file), names)); },
        [](const absl::Status& why) { return irsig::encode_volume(why); });
  const auto as_file = [](const absl::StatusOr<std::string>& file) {
    return irsig::encode_vdb(file);
  };
  irsig::answer_subprocess(
      bytes,
      [&](const std::string& volume) {
        const absl::StatusOr<irsig::VoxelVolume> read = irsig::decode_volume(volume);
        return as_file(read.ok() ? irsig::write_vdb(*read) : read.status());
      },
      as_file);
}
