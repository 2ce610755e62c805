#pragma once

#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "view/query.h"

namespace irsig {

// The next image as EXR; empty: there is none.
using NextExr = std::function<absl::StatusOr<std::string>()>;
// Paints an EXR as PNG on a scale, "common" (0 to the hottest pixel of it and of all others) or
// "BLACK,WHITE". Given by who has a program that reads EXR. DATA_LOSS: the first cannot be read.
using PaintPng = std::function<absl::StatusOr<std::string>(
    const std::string& exr, const std::string& scale, const NextExr& others)>;

// The stored image of the only row. INVALID_ARGUMENT: no row, an interpolated one, or several (they
// are listed); NOT_FOUND: stored without image.
[[nodiscard]] absl::StatusOr<schema::Thumbnail> stored_thumbnail(StoreReader& reader,
                                                                 const std::vector<QueryRow>& rows);

// Writes the stored image of the only row to a file; its ending (.png or .exr) says which.
// INVALID_ARGUMENT: another ending; those of stored_thumbnail. DATA_LOSS: the image is damaged.
//   scale  of a .png: "" (the image as stored: 0 to its own hottest pixel), "common" (0 to the
//          hottest pixel of all images of its sweep and band) or "BLACK,WHITE" in W/(m2 sr); needs
//          `paint`
[[nodiscard]] absl::Status write_thumbnail(StoreReader& reader, const std::vector<QueryRow>& rows,
                                           const std::string& path, const std::string& scale = "",
                                           const PaintPng& paint = {});

}  // namespace irsig
