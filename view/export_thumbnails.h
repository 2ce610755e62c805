#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "view/query.h"

namespace irsig {

// An image to be painted, or only looked at.
struct PictureAsked {
  std::string exr;
  std::string png;  // the file; empty: only look
  double black_w_m2_sr = 0, white_w_m2_sr = 0;
  // As the sensor has it (core/image/image.h: SeenFrom); nullopt: as it is stored.
  struct Seen {
    double gain, path_radiance_w_m2_sr, background_radiance_w_m2_sr, target_area_px;
  };
  std::optional<Seen> seen = {};
};
struct PictureFacts {
  double hottest_w_m2_sr;                                        // of what is painted
  std::uint32_t shown_px, left_px, top_px, width_px, height_px;  // of the target
  std::string damage = {};  // why it cannot be read; empty: it can, and else nothing is known of it
};
// Of each; given by who has a program that reads EXR.
using PaintPictures =
    std::function<absl::StatusOr<std::vector<PictureFacts>>(const std::vector<PictureAsked>&)>;

struct ThumbnailsAsked {
  Query query;
  // "common": from 0 to the hottest pixel of all of them in the same sweep and band; "own": each
  // to its own; or "BLACK,WHITE" [W/(m2 sr)].
  std::string scale = "common";
  bool exr = false;         // beside each picture, as stored
  bool background = false;  // pictures as the sensor has them, before the row's background
  std::string said;         // the question, for who resumes
};

// A folder of the stored images of all rows that a query selects: labels.csv, one line for each
// (the columns are in docs/export.md), and images/ with its pictures. The folder appears when it is
// complete. Until then it is FOLDER.partial, which the same call goes on with after an end of any
// kind; INVALID_ARGUMENT if that one is of another question, or the folder is there. Rows without
// an image are left out. NOT_FOUND: none has one. What going on cannot mend leaves no folder:
// DATA_LOSS, an image is damaged; INVALID_ARGUMENT and FAILED_PRECONDITION, rows that cannot be put
// before a background. The number of images.
[[nodiscard]] absl::StatusOr<std::uint64_t> export_thumbnails(StoreReader& reader,
                                                              const ThumbnailsAsked& asked,
                                                              const std::string& folder,
                                                              const PaintPictures& paint);

}  // namespace irsig
