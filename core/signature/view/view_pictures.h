#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/signature/view/request.h"
#include "core/signature/view/shading.h"
#include "core/sources/condition_sources.h"
#include "core/sources/source_layout.h"
#include "core/transport/path_tracer.h"

namespace irsig {

// Position and size of a view's pictures, the same for all of its rows.
struct PictureFrame {
  PlaneRectangle rectangle;                   // on the image plane of the target's view
  double plane_m = 0;                         // how far that plane is from the sensor
  std::uint32_t width_px = 0, height_px = 0;  // 0: there are none
};

// Pixels are squares. Of request.image the frame is what its camera sees, or the target's rectangle
// with a margin, in the middle of its pixels. Else the long side has request.thumbnail_px pixels,
// and the rectangle is the target's own, and less than a pixel beside it.
// With hot gas the target's rectangle is the smallest one that holds that and, of each field of the
// request's conditions, 99 % of what the voxels would send at 4.3 and at 10 um if they were thin,
// but no further from the target's than makes its long side eight times as long: of a small target
// are left 16 of 128 pixels. It depends on no selection and on no random numbers. INVALID_ARGUMENT:
// a camera that looks at a point beside or behind the sensor.
[[nodiscard]] absl::StatusOr<PictureFrame> picture_frame(const Target& target,
                                                         const ViewFrame& frame,
                                                         const ViewRequest& request);

// Samples of each pixel, powers of two: more in pictures of few pixels, so that all pixels together
// have kLeastPictureSamples; fewer, but kLeastPixelSamples, above kMostPictureSamples in all.
inline constexpr std::uint32_t kPixelSamples = 8, kLeastPixelSamples = 4;
inline constexpr std::uint64_t kLeastPictureSamples = std::uint64_t{1} << 14,
                               kMostPictureSamples = std::uint64_t{1} << 19;

// Returns a run's settings changed to those of its pictures: one replicate, and so many samples of
// each pixel (0: as above). A pixel has few samples, so every path goes on, in several directions.
// Noise of the frigate's median inner pixel in 8-12 um, and CPU time of the images of 24 views
// (which take 1.6 s without them, at 1 %), by split and roulette_survival_scale:
//     1, 1            1, 8            2, 8            4, 8
//     7 %, 0.3 s      1.3 %, 0.5 s    0.9 %, 0.7 s    0.6 %, 1.0 s
[[nodiscard]] PathSettings picture_settings(PathSettings settings, const ImagePlan& plan,
                                            std::uint32_t pixel_samples = 0);

// Pictures of that frame that show nothing yet, for rays that start on the plane of `view`.
//   firsts  tables of sources: one, or one for each class of gas before them
[[nodiscard]] ImagePlan blank_pictures(const PictureFrame& frame, const ViewFrame& view,
                                       std::size_t images, std::size_t firsts,
                                       const SourceLayout& paths, const SpectralBasis* basis);

// Plans picture `image` to show the light of a condition with a radiance (SourceTable::source or
// apparent of `table`), behind gas of class `first`. Paths end on emitters, which are made up of
// lights. The background behind the target is not shown.
void show_sources(const SourceTable& table, const std::vector<double>& radiance,
                  const ConditionSources& light, const SourceLayout& paths,
                  const SpectralBasis* basis, std::size_t image, std::size_t first,
                  ImagePlan& plan);

// Shows in picture `image` the background behind the target, with the table's `apparent` radiance,
// behind gas of class `first`.
void show_background(const SourceTable& table, const ConditionSources& light,
                     const SourceLayout& paths, const SpectralBasis* basis, std::size_t image,
                     std::size_t first, ImagePlan& plan);

// Takes off picture `image` what the target hides of the light behind it.
void hide_background(const SourceTable& table, const ConditionSources& light,
                     const SourceLayout& paths, const SpectralBasis* basis, std::size_t image,
                     ImagePlan& plan);

}  // namespace irsig
