#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "view/export_thumbnails.h"
#include "view/plot_picture.h"
#include "view/thumbnail.h"

namespace irsig {

// What needs OpenImageIO, which is slow to load: done by irsig-picture, a program of its own.

// A PaintPng (view/thumbnail.h).
[[nodiscard]] absl::StatusOr<std::string> paint_png(const std::string& exr,
                                                    const std::string& scale,
                                                    const NextExr& others);
// A ReadExr (view/plot_picture.h).
[[nodiscard]] absl::StatusOr<StoredPixels> read_exr(const std::string& exr);

// PaintPictures: as many processes at a time as the machine has cores.
[[nodiscard]] absl::StatusOr<std::vector<PictureFacts>> paint_pictures(
    const std::vector<PictureAsked>& pictures);

}  // namespace irsig
