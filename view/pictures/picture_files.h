#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/imager/imager.h"
#include "view/pictures/export_thumbnails.h"
#include "view/pictures/exported_sweeps.h"
#include "view/pictures/picture_scale.h"
#include "view/pictures/shown_image.h"

namespace irsig {

// Facts of an exported picture that its row and its silhouette do not have.
struct PictureFacts {
  std::string name;                             // of its file, without the ending
  std::size_t band = 0;                         // its place in a cube
  double black_w_m2_sr = 0, white_w_m2_sr = 0;  // of grey
  ImagerInBand figures{};                       // of counts
  std::uint64_t saturated_px = 0;               // of counts
  ImageContent target{};                        // pixels that show any of it
  double target_in_frame_px = 0;                // area that the image shows, by rays
};

// The files of images in the folder of an export.
class PictureFiles {
 public:
  // All arguments outlive the object.
  PictureFiles(const ThumbnailsAsked& asked, const PictureScale& scale,
               const ExportedSweeps& sweeps, const std::string& folder, const ReadPictures& read)
      : asked_(asked), scale_(scale), sweeps_(sweeps), folder_(folder), read_(read) {}

  // Finds the figures of an imager for each image. FAILED_PRECONDITION and INVALID_ARGUMENT: it
  // cannot record one of them.
  [[nodiscard]] absl::Status find_figures(const std::vector<RowImage>& images,
                                          std::vector<PictureFacts>& facts) const;

  // Writes the files of one image, which shows `radiance`. With an imager the silhouette and the
  // size of `image` become those of the recorded picture. Several threads may call this, each for
  // its own image.
  [[nodiscard]] absl::Status write(RowImage& image, RadianceImage radiance,
                                   PictureFacts& facts) const;

  // Writes the headers of the cubes that have these images as their bands.
  [[nodiscard]] absl::Status write_headers(const std::vector<RowImage>& images,
                                           const std::vector<PictureFacts>& facts) const;

  // Writes bytes to a file of the folder that no process reads yet, without synchronizing the disk.
  [[nodiscard]] static absl::Status plain_file(const std::string& path, const std::string& bytes);

 private:
  [[nodiscard]] absl::Status write_picture(const RowImage& image, const RadianceImage& radiance,
                                           PictureFacts& facts) const;
  [[nodiscard]] absl::Status write_layers(const RowImage& image) const;
  [[nodiscard]] absl::Status write_counts(RowImage& image, RadianceImage seen,
                                          PictureFacts& facts) const;
  [[nodiscard]] absl::Status write_mask(const RowImage& image) const;
  [[nodiscard]] absl::Status damaged(const RowImage& image, const absl::Status& why) const;

  const ThumbnailsAsked& asked_;
  const PictureScale& scale_;
  const ExportedSweeps& sweeps_;
  const std::string& folder_;
  const ReadPictures& read_;
};

// Returns the radiance of the hottest pixel [W/(m2 sr)].
[[nodiscard]] double hottest_of(const RadianceImage& image);

}  // namespace irsig
