#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/imager/imager.h"
#include "view/pictures/coco.h"
#include "view/pictures/thumbnail.h"
#include "view/query/query.h"

namespace irsig {

enum class PictureFormat {
  kPng,   // grey of 8 or 16 bits
  kTiff,  // likewise, or float32 with 32 bits
  kEnvi   // float32: a cube for each viewpoint and condition, with the requested bands
};
// ".png", ".tif", ".bsq".
[[nodiscard]] const char* ending_of(PictureFormat format);

struct ThumbnailsAsked {
  Query query;
  // "common": from 0 to the hottest pixel of all of them in the same sweep and band; "own": each
  // to its own; or "BLACK,WHITE" [W/(m2 sr)].
  std::string scale = "common";
  PictureFormat format = PictureFormat::kPng;
  int bits = 8;        // of a picture's grey: 8 or 16; 32: float32, of kTiff alone
  bool exr = false;    // beside each picture, as stored, and its standard errors
  bool masks = false;  // beside each picture, which part a pixel shows
  bool coco = false;   // labels of objects as COCO's JSON, too
  std::vector<CocoCategory> categories;  // of these objects; none: "target", of all parts
  bool each_part = false;                // or each part is a category
  // Fraction of the viewpoints whose pictures are for validation, chosen by their directions and a
  // seed alone: 0 to 1. 0: the pictures are not divided.
  double validation = 0;
  std::uint64_t split_seed = 1;
  std::string layer;        // pictures of this further image; empty: of the radiance at the target
  bool background = false;  // pictures at the sensor, before the row's background
  // Pictures of counts of this imager, in place of `scale` and `bits`; needs `background`.
  std::optional<Imager> imager = std::nullopt;
  std::string imager_name;      // for labels
  std::string imager_identity;  // differs between different imagers
  std::string said;             // text of the question, for a resumed export
};

// Exports the stored images of all rows that a query selects, and returns their number. The folder
// has labels.csv with one line for each image (columns: docs/reference/export.md), images/ with the
// pictures, and the other requested files (docs/reference/export.md). Rows without an image are
// left out.
// The folder appears when it is complete. Until then it is FOLDER.partial, and an identical call
// after an interruption continues it. INVALID_ARGUMENT: FOLDER.partial belongs to another question,
// or the folder exists. NOT_FOUND: no row has an image. Some errors cannot be resolved by
// continuing, and leave no folder: DATA_LOSS (an image is damaged), INVALID_ARGUMENT and
// FAILED_PRECONDITION (rows that cannot be put before a background).
[[nodiscard]] absl::StatusOr<std::uint64_t> export_thumbnails(StoreReader& reader,
                                                              const ThumbnailsAsked& asked,
                                                              const std::string& folder,
                                                              const ReadPictures& read);

}  // namespace irsig
