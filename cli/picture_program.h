#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "coordinator/client/scratch_folder.h"
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

// Its paint() is a PaintPictures (view/export_thumbnails.h): by as many processes as the machine
// has cores, which live as long as this. Of the main thread (child_process.h).
class PicturePainters {
 public:
  PicturePainters();
  ~PicturePainters();
  PicturePainters(const PicturePainters&) = delete;
  PicturePainters& operator=(const PicturePainters&) = delete;
  [[nodiscard]] absl::StatusOr<std::vector<PictureFacts>> paint(
      const std::vector<PictureAsked>& pictures);

 private:
  class Painter;
  std::unique_ptr<ScratchFolder> folder_;
  std::vector<std::unique_ptr<Painter>> painter_;
};

}  // namespace irsig
