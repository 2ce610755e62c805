#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/signature/view/view_pictures.h"
#include "core/transport/path_tracer.h"

namespace irsig {

// Where the pictures of a frame are traced: the pixels that may show the target. Where these are
// few, each is divided into squares whose rays are stratified apart, so that a target far smaller
// than a pixel is met by as many rays as a large one.
class PictureWindow {
 public:
  //   target   its rectangle, on the frame's plane
  //   samples  rays of each square; 0: kPixelSamples
  PictureWindow(const PlaneRectangle& target, const PictureFrame& frame, std::uint32_t samples);

  // Returns the frame of the squares that are traced.
  [[nodiscard]] const PictureFrame& traced() const { return traced_; }
  // Squares of a pixel.
  [[nodiscard]] std::uint32_t squares() const { return side_ * side_; }
  [[nodiscard]] std::size_t pixels() const { return std::size_t{width_} * height_; }

  // Adds up squares into pixels of the window, row by row from the top left.
  //   samples  of a square; becomes that of a pixel, of which TracedPictures::met counts
  [[nodiscard]] TracedPictures joined(TracedPictures squares, const ImagePlan& plan,
                                      std::uint32_t& samples) const;

  // Returns the index in the frame of a pixel of the window, and the reverse; pixel_of() is empty
  // for pixels outside the window.
  [[nodiscard]] std::uint32_t whole_of(std::size_t pixel) const {
    return static_cast<std::uint32_t>((top_ + pixel / width_) * frame_width_ + left_ +
                                      pixel % width_);
  }
  [[nodiscard]] std::optional<std::size_t> pixel_of(std::size_t whole) const {
    const std::size_t row = whole / frame_width_, column = whole % frame_width_;
    if (row < top_ || row >= top_ + height_ || column < left_ || column >= left_ + width_)
      return std::nullopt;
    return (row - top_) * width_ + column - left_;
  }

 private:
  std::uint32_t frame_width_;
  std::uint32_t side_ = 1;                                     // squares along the side of a pixel
  std::uint32_t left_ = 0, top_ = 0, width_ = 0, height_ = 0;  // in pixels
  std::uint32_t fine_left_ = 0, fine_top_ = 0;                 // in squares
  PictureFrame traced_;
};

}  // namespace irsig
