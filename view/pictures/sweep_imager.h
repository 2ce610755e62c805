#pragma once

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "core/imager/imager.h"
#include "schema/store/reader.h"
#include "schema/sweep.pb.h"
#include "view/pictures/thumbnail.h"

namespace irsig {

// The camera that [imager] of a stored sweep states.
struct SweepImager {
  std::string name;      // the sweep's name for it, or "[imager] of SWEEP"
  std::string identity;  // all keys that the sweep states
  Imager imager;
};

// Returns the imager of a sweep. nullopt: the sweep has no [imager]. INVALID_ARGUMENT: a damaged
// database states one that no camera can be.
[[nodiscard]] absl::StatusOr<std::optional<SweepImager>> imager_of_sweep(
    const schema::Sweep& sweep);

// Returns the camera that all sweeps of the database have, or the sweep of that name.
// INVALID_ARGUMENT: the cameras of several sweeps differ.
[[nodiscard]] absl::StatusOr<std::optional<SweepImager>> common_imager(StoreReader& reader,
                                                                       const std::string& sweep);

// The stored image of a row as recorded by a camera, as far as it is known without its pixels.
struct CountsFrame {
  DetectorGrid grid;
  ImagerInBand figures;
};
// Computes the camera's counts of an image. Errors: those of record_image (recorded_image.h).
// FAILED_PRECONDITION: an earlier version of the sweep had another band. INVALID_ARGUMENT: gas
// transmits a part of the background.
[[nodiscard]] absl::StatusOr<CountsFrame> counts_frame(StoreReader& reader,
                                                       const SweepImager& imager,
                                                       const StoredSignature& row,
                                                       const schema::Thumbnail& image);

// The stored image of a row as a camera records it.
struct CountsOfRow {
  CountsImage counts;
  ImagerInBand figures;
  StoredSilhouette silhouette;  // mean fractions of the camera's pixels
};
// Returns counts as the pixels of an EXR file, which holds each whole number exactly.
[[nodiscard]] absl::StatusOr<std::string> counts_exr(const CountsImage& counts);
// Computes the camera's counts of a row. Errors: those of record_image (recorded_image.h) and of
// shown_image (shown_image.h). NOT_FOUND: the row has no image.
[[nodiscard]] absl::StatusOr<CountsOfRow> counts_of_row(StoreReader& reader,
                                                        const SweepImager& imager,
                                                        const StoredSignature& row,
                                                        const ReadPictures& read);

}  // namespace irsig
