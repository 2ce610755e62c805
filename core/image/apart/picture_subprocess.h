#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// A stored image (EXR) and what is asked of it.
struct PictureTask {
  std::string exr;
  // The longest side that is decoded: what the image's sweep asked for. An image whose header
  // states more pixels is refused before any of them is read.
  std::uint32_t most_px = 0;
  bool paint = false;     // as PNG, from black to white [W/(m2 sr)]
  std::int32_t bits = 8;  // of its grey, 8 or 16
  bool pixels = false;    // as they are
  float black_w_m2_sr = 0, white_w_m2_sr = 0;
  // Conditions at the sensor (core/image/image.h: SeenFrom); nullopt: the picture as it is stored.
  struct Seen {
    double gain = 1, path_radiance_w_m2_sr = 0, background_radiance_w_m2_sr = 0;
    std::vector<float> filled;  // [pixel]
  };
  std::optional<Seen> seen = std::nullopt;
};

struct PictureAnswer {
  std::string damage;  // why the image cannot be read; empty: it can, and else nothing is known
  std::uint32_t width_px = 0, height_px = 0;  // of the image
  float hottest_w_m2_sr = 0;                  // of what is painted
  // The target: its pixels, and their box.
  std::uint32_t shown_px = 0, left_px = 0, top_px = 0, box_width_px = 0, box_height_px = 0;
  std::string png;           // if asked for
  std::vector<float> pixel;  // row by row from the top left, if asked for [W/(m2 sr)]
};

// Returns the path of the answering program beside this executable.
[[nodiscard]] std::string picture_program();

// Asks the program. Each image that ends it, or meets a limit of the process, is the damage of its
// own answer; the others are answered. INTERNAL: the program could not be run. May be called from
// several threads at once.
[[nodiscard]] absl::StatusOr<std::vector<PictureAnswer>> read_pictures_subprocess(
    const std::string& program, std::span<const PictureTask> tasks);

// Encodes both sides of the exchange, for the program and for tests. DATA_LOSS from the decoders:
// the bytes differ from those of the encoder.
[[nodiscard]] std::string encode_tasks(std::span<const PictureTask> tasks);
[[nodiscard]] absl::StatusOr<std::vector<PictureTask>> decode_tasks(std::string_view bytes);
[[nodiscard]] std::string encode_answers(const absl::StatusOr<std::vector<PictureAnswer>>& answers);
// Decodes the answers. INVALID_ARGUMENT: the error that encode_answers was given instead of
// answers.
[[nodiscard]] absl::StatusOr<std::vector<PictureAnswer>> decode_answers(std::string_view bytes);

}  // namespace irsig
