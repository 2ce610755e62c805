#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/image/apart/picture_subprocess.h"
#include "view/query/query.h"

namespace irsig {

// Callback: returns the answers to all tasks, in their order. Programs that can read EXR provide
// it.
using ReadPictures =
    std::function<absl::StatusOr<std::vector<PictureAnswer>>(const std::vector<PictureTask>&)>;

// Returns the longest side [px] that an image of a sweep may have: the size that the sweep
// requests. If an older irsig did not store the request: the largest size that any sweep may
// request.
[[nodiscard]] std::uint32_t most_px_of(const schema::Sweep& sweep);
// Returns the limit for a row; for a row of an earlier version of its sweep, the limit of any
// sweep.
[[nodiscard]] absl::StatusOr<std::uint32_t> most_px_of(StoreReader& reader,
                                                       const StoredSignature& row);

// Returns the stored image of the only row. INVALID_ARGUMENT: there is no row, an interpolated row,
// or several (the message lists them). NOT_FOUND: the row has no image.
[[nodiscard]] absl::StatusOr<schema::Thumbnail> stored_thumbnail(StoreReader& reader,
                                                                 const std::vector<QueryRow>& rows);

// Returns a further image of a row. NOT_FOUND: the row has no such layer; the message lists its
// layers.
[[nodiscard]] absl::StatusOr<schema::ImageLayer> stored_layer(StoreReader& reader,
                                                              const StoredSignature& row,
                                                              const std::string& name);

// Writes the stored image of the only row to a file whose ending, .png or .exr, selects the format.
// INVALID_ARGUMENT: another ending. DATA_LOSS: the image is damaged. Other errors: those of
// stored_thumbnail.
//   scale  of a .png: "" (the image as stored: 0 to its own hottest pixel), "common" (0 to the
//          hottest pixel of all images of its sweep and band) or "BLACK,WHITE" in W/(m2 sr); needs
//          `read`
[[nodiscard]] absl::Status write_thumbnail(StoreReader& reader, const std::vector<QueryRow>& rows,
                                           const std::string& path, const std::string& scale = "",
                                           const ReadPictures& read = {});

}  // namespace irsig
