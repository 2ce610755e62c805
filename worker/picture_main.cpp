// irsig-picture: looks at stored images of radiances (EXR), paints them as PNG or hands out their
// pixels, for a process that must not crash with OpenEXR and need not load OpenImageIO.
//
// usage: irsig-picture BYTES < tasks > answers     (core/image/apart/picture_subprocess.h starts
// it)
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/base/answer_subprocess.h"
#include "core/base/status_macros.h"
#include "core/image/apart/picture_subprocess.h"
#include "core/image/image.h"
#include "core/image/reader/exr_reader.h"

#if defined(__SANITIZE_ADDRESS__)
// In the place of a limit of addresses. What OpenImageIO leaks at its errors is the kernel's to
// take back.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "detect_leaks=0:max_allocation_size_mb=1024:hard_rss_limit_mb=4096";
}
#endif

namespace {

irsig::PictureAnswer answer_to(const irsig::PictureTask& task) {
  irsig::PictureAnswer out;
  const auto damaged = [&](const absl::Status& why) {
    out.damage = std::string(why.message());
    return out;
  };
  auto image = irsig::decode_exr(task.exr, task.most_px);
  if (!image.ok()) return damaged(image.status());
  const irsig::ImageContent content = irsig::content_of(*image);
  out.hottest_w_m2_sr = content.hottest_w_m2_sr;
  out.shown_px = content.shown_px;
  out.left_px = content.left_px;
  out.top_px = content.top_px;
  out.box_width_px = content.width_px;
  out.box_height_px = content.height_px;
  out.width_px = image->width_px;
  out.height_px = image->height_px;
  if (task.seen) {
    image = irsig::seen_from(*image, {task.seen->gain, task.seen->path_radiance_w_m2_sr,
                                      task.seen->background_radiance_w_m2_sr, task.seen->filled});
    if (!image.ok()) return damaged(image.status());
    out.hottest_w_m2_sr =
        *std::max_element(image->radiance_w_m2_sr.begin(), image->radiance_w_m2_sr.end());
  }
  if (task.paint) {
    auto png = irsig::encode_png(*image, {task.black_w_m2_sr, task.white_w_m2_sr}, task.bits);
    if (!png.ok()) return damaged(png.status());
    out.png = *std::move(png);
  }
  if (task.pixels) out.pixel = std::move(image->radiance_w_m2_sr);
  return out;
}

absl::StatusOr<std::vector<irsig::PictureAnswer>> answers_to(std::string bytes) {
  ASSIGN_OR_RETURN(const auto tasks, irsig::decode_tasks(bytes));
  bytes.clear();
  std::vector<irsig::PictureAnswer> out;
  for (const irsig::PictureTask& task : tasks) out.push_back(answer_to(task));
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t bytes = 0;
  const std::string_view count = argc == 2 ? argv[1] : "";
  if (std::from_chars(count.data(), count.data() + count.size(), bytes).ec != std::errc()) {
    std::fputs("irsig-picture: started by irsig, not by hand\n", stderr);
    return 2;
  }
  irsig::answer_subprocess(
      bytes, [](std::string tasks) { return irsig::encode_answers(answers_to(std::move(tasks))); },
      [](const absl::Status& why) { return irsig::encode_answers(why); });
}
