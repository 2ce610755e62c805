// irsig-import: reads one glTF file, for a process that must not run out of memory with it.
//
// usage: irsig-import NAME BYTES < file > reply     (core/scene/import/import_subprocess.h starts it)
#include <charconv>
#include <cstdio>
#include <string>
#include <system_error>

#include "core/base/answer_subprocess.h"
#include "core/scene/import/import_formats.h"
#include "core/scene/import/import_reply.h"

#if defined(__SANITIZE_ADDRESS__)
// AddressSanitizer's options stand in place of a limit of addresses.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "detect_leaks=0:max_allocation_size_mb=1024:hard_rss_limit_mb=4096";
}
#endif

int main(int argc, char** argv) {
  std::uint64_t bytes = 0;
  const std::string name = argc == 3 ? argv[1] : "", count = argc == 3 ? argv[2] : "";
  if (std::from_chars(count.data(), count.data() + count.size(), bytes).ec != std::errc()) {
    std::fputs("irsig-import: started by irsig and irsig-worker, not by hand\n", stderr);
    return 2;
  }
  irsig::answer_subprocess(
      bytes,
      [&](const std::string& file) { return irsig::encode_reply(irsig::read_gltf(file, name)); },
      [](const absl::Status& why) { return irsig::encode_reply(why); });
}
