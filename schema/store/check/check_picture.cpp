#include "schema/store/check/check_picture.h"

#include <zlib.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <string_view>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/accuracy/image_layers.h"
#include "schema/store/tables/database.h"

namespace irsig {
namespace {

absl::Status wrong_picture(const std::string& path, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("result: ", path, " ", what));
}

std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t out = 0;
  for (std::size_t i = 0; i < 4; ++i) out = out << 8U | static_cast<unsigned char>(bytes[i]);
  return out;
}

std::uint32_t little_endian(std::string_view bytes) {
  std::uint32_t out = 0;
  for (std::size_t i = 4; i-- > 0;) out = out << 8U | static_cast<unsigned char>(bytes[i]);
  return out;
}

// Inflates what it is given and counts; keeps nothing.
class Inflater {
 public:
  Inflater() { ready_ = inflateInit(&stream_) == Z_OK; }
  ~Inflater() {
    if (ready_) inflateEnd(&stream_);
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  // False: damaged, or more than `most` bytes in all.
  bool add(std::string_view bytes, std::uint64_t most) {
    if (!ready_) return false;
    // zlib does not write there.
    stream_.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(bytes.data()));
    stream_.avail_in = static_cast<uInt>(bytes.size());
    while (stream_.avail_in > 0 && !ended_) {
      stream_.next_out = buffer_.data();
      stream_.avail_out = static_cast<uInt>(buffer_.size());
      const int code = inflate(&stream_, Z_NO_FLUSH);
      count_ += buffer_.size() - stream_.avail_out;
      ended_ = code == Z_STREAM_END;
      if ((code != Z_OK && !ended_) || count_ > most) return false;
    }
    return stream_.avail_in == 0;
  }
  [[nodiscard]] bool ended_with(std::uint64_t bytes) const { return ended_ && count_ == bytes; }

 private:
  z_stream stream_{};
  std::array<Bytef, 16384> buffer_;
  std::uint64_t count_ = 0;
  bool ready_ = false, ended_ = false;
};

// The layout: https://www.w3.org/TR/png/, 5 and 11.2.
absl::Status check_png(std::string_view png, std::uint32_t width_px, std::uint32_t height_px,
                       const std::string& path) {
  constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
  constexpr std::size_t kFrame = 12;  // length, name and checksum of a chunk
  if (!png.starts_with(kSignature)) return wrong_picture(path, "is no PNG file");
  const std::uint64_t pixels = (std::uint64_t{width_px} + 1) * height_px;  // a filter byte a row
  Inflater inflater;
  bool first = true;
  for (std::string_view rest = png.substr(kSignature.size());; first = false) {
    if (rest.size() < kFrame) return wrong_picture(path, "is cut off");
    const std::uint32_t length = big_endian(rest);
    if (length > rest.size() - kFrame) return wrong_picture(path, "is cut off");
    const std::string_view name = rest.substr(4, 4), body = rest.substr(8, length);
    const std::uint32_t stated = big_endian(rest.substr(8 + length));
    const uLong computed = crc32(0, reinterpret_cast<const Bytef*>(name.data()), 4 + length);
    if (computed != stated) return wrong_picture(path, "is damaged: a checksum does not match");
    rest.remove_prefix(kFrame + length);
    if (first) {
      if (name != "IHDR" || length != 13) return wrong_picture(path, "has no header");
      if (big_endian(body) != width_px || big_endian(body.substr(4)) != height_px)
        return wrong_picture(
            path, absl::StrCat("is ", big_endian(body), " x ", big_endian(body.substr(4)),
                               " pixels, its thumbnail ", width_px, " x ", height_px));
      if (body.substr(8) != std::string_view("\x08\0\0\0\0", 5))
        return wrong_picture(path, "is not 8 bit grey");
    } else if (name == "IDAT") {
      if (!inflater.add(body, pixels))
        return wrong_picture(path, "has damaged pixels, or too many");
    } else if (name == "IEND") {
      if (!rest.empty()) return wrong_picture(path, "goes on after its end");
      if (!inflater.ended_with(pixels)) return wrong_picture(path, "has not all its pixels");
      return absl::OkStatus();
    }
  }
}

// Up to the next zero byte, and past it.
std::string_view take_text(std::string_view& rest) {
  const std::size_t end = rest.find('\0');
  if (end == std::string_view::npos) return {};
  const std::string_view text = rest.substr(0, end);
  rest.remove_prefix(end + 1);
  return text;
}

// Scan lines in a block, by the method of compression; 0: none that there is.
std::uint32_t lines_of_block(unsigned char compression) {
  constexpr std::array<std::uint32_t, 10> kLines = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
  return compression < kLines.size() ? kLines[compression] : 0;
}

// Behind the header: where each block is, then the blocks, each after its line and its size.
bool blocks_are_whole(std::string_view exr, std::string_view rest, std::uint64_t blocks) {
  if (rest.size() < 8 * blocks) return false;
  for (std::uint64_t i = 0; i < blocks; ++i) {
    const std::string_view place = rest.substr(8 * i);
    const std::uint64_t at = little_endian(place) | std::uint64_t{little_endian(place.substr(4))}
                                                        << 32U;
    if (exr.size() < 8 || at > exr.size() - 8) return false;
    if (little_endian(exr.substr(at + 4)) > exr.size() - 8 - at) return false;
  }
  return true;
}

absl::Status check_exr(std::string_view exr, std::uint32_t width_px, std::uint32_t height_px,
                       const std::string& path) {
  const std::string defect = exr_defect(exr, width_px, height_px);
  return defect.empty() ? absl::OkStatus() : wrong_picture(path, defect);
}

}  // namespace

// The layout: https://openexr.com/en/latest/OpenEXRFileLayout.html.
std::string exr_defect(std::string_view exr, std::uint32_t width_px, std::uint32_t height_px) {
  constexpr std::uint32_t kMagic = 20000630, kPlainScanLines = 2;
  if (exr.size() < 8 || little_endian(exr) != kMagic) return "is no OpenEXR file";
  if (little_endian(exr.substr(4)) != kPlainScanLines) return "is not one part of scan lines";
  // Each row as it is, its place and size, and a header.
  const std::uint64_t most = std::uint64_t{height_px} * (4 * std::uint64_t{width_px} + 16) + 4096;
  if (exr.size() > most) return absl::StrCat("has ", exr.size(), " bytes, its pixels take ", most);
  bool sized = false, channel = false;
  std::uint32_t lines = 1;
  std::string_view rest = exr.substr(8);
  for (;;) {
    if (rest.starts_with('\0')) break;
    const std::string_view name = take_text(rest), type = take_text(rest);
    if (name.empty() || type.empty() || rest.size() < 4) return "has a damaged header";
    const std::uint32_t size = little_endian(rest);
    rest.remove_prefix(4);
    if (size >= rest.size()) return "has a damaged header";
    std::string_view value = rest.substr(0, size);
    rest.remove_prefix(size);
    if (name == "dataWindow") {
      sized = type == "box2i" && size == 16 && little_endian(value) == 0 &&
              little_endian(value.substr(4)) == 0 &&
              little_endian(value.substr(8)) == width_px - 1 &&
              little_endian(value.substr(12)) == height_px - 1;
      if (!sized) return "is of another size than its thumbnail";
    } else if (name == "compression") {
      lines = type == "compression" && size == 1
                  ? lines_of_block(static_cast<unsigned char>(value.front()))
                  : 0;
      if (lines == 0) return "is compressed in no known way";
    } else if (name == "channels") {
      // One, of float32: its name, 16 bytes, and the end of the list.
      const std::string_view of = take_text(value);
      channel = !of.empty() && value.size() == 17 && little_endian(value) == 2;
      if (!channel) return "has other channels than one of float32";
    }
  }
  if (!sized || !channel) return "has a damaged header";
  rest.remove_prefix(1);
  const std::uint64_t blocks = (std::uint64_t{height_px} + lines - 1) / lines;
  return blocks_are_whole(exr, rest, blocks) ? "" : "is cut off";
}

absl::Status check_thumbnail(const schema::Thumbnail& thumbnail, const std::string& path) {
  const std::uint32_t width_px = thumbnail.width_px(), height_px = thumbnail.height_px();
  if (width_px < 1 || height_px < 1 || width_px > kMostPixels || height_px > kMostPixels)
    return wrong_picture(path, absl::StrCat("is ", width_px, " x ", height_px,
                                            " pixels, expected 1 to ", kMostPixels));
  IRSIG_STORE_TRY(check_png(thumbnail.png(), width_px, height_px, path + ".png"));
  IRSIG_STORE_TRY(check_exr(thumbnail.exr(), width_px, height_px, path + ".exr"));
  return check_exr(thumbnail.stderr_exr(), width_px, height_px, path + ".stderr_exr");
}

absl::Status check_image_layer(const schema::ImageLayer& layer, std::uint32_t width_px,
                               std::uint32_t height_px, const std::string& path) {
  const auto known = image_layer_of(layer.name());
  if (!known) return wrong_picture(path + ".name", "is none that there is");
  IRSIG_STORE_TRY(check_exr(layer.exr(), width_px, height_px, path + ".exr"));
  if (has_standard_error(*known) == layer.stderr_exr().empty())
    return wrong_picture(path + ".stderr_exr", "is there or not, unlike that of other rows");
  return layer.stderr_exr().empty()
             ? absl::OkStatus()
             : check_exr(layer.stderr_exr(), width_px, height_px, path + ".stderr_exr");
}

namespace {

// Return the limits of a silhouette's pixels: entries in memory, and bytes after inflation.
std::uint64_t most_entries(const schema::Silhouette& of) {
  return 4 * std::uint64_t{of.width_px()} * of.height_px() + (1U << 22U);
}
std::uint64_t most_inflated(const schema::Silhouette& of) {
  return 16 * std::uint64_t{of.width_px()} * of.height_px() + (1U << 26U);
}

absl::Status check_frame(const schema::Silhouette& silhouette) {
  const std::uint32_t width_px = silhouette.width_px(), height_px = silhouette.height_px();
  if (width_px < 1 || height_px < 1 || width_px > kMostPixels || height_px > kMostPixels)
    return absl::DataLossError(
        absl::StrCat("is ", width_px, " x ", height_px, " pixels, expected 1 to ", kMostPixels));
  if (silhouette.pixel_samples() < 1 || silhouette.pixel_samples() > kMostPixelSamples)
    return absl::DataLossError(absl::StrCat("states ", silhouette.pixel_samples(),
                                            " samples of a pixel, expected 1 to ",
                                            kMostPixelSamples));
  return absl::OkStatus();
}

// Boxes are in the frame, of different parts, and together no larger than any worker's.
absl::Status check_boxes(const schema::Silhouette& silhouette) {
  const auto within = [](std::uint32_t first, std::uint32_t count, std::uint32_t all) {
    return count > 0 && count <= all && first <= all - count;
  };
  std::set<std::uint32_t> parts;
  std::uint64_t area_px = 0;
  for (const schema::PartPixels& part : silhouette.part()) {
    if (!parts.insert(part.part_index()).second)
      return absl::DataLossError(absl::StrCat("names part ", part.part_index(), " twice"));
    if (!within(part.left_px(), part.width_px(), silhouette.width_px()) ||
        !within(part.top_px(), part.height_px(), silhouette.height_px()))
      return absl::DataLossError("has a part outside the picture");
    area_px += std::uint64_t{part.width_px()} * part.height_px();
    if (area_px > most_inflated(silhouette))
      return absl::DataLossError(absl::StrCat("has parts in boxes of more than ",
                                              most_inflated(silhouette), " pixels together"));
  }
  return absl::OkStatus();
}

// Counts the rays of each pixel that are accounted for, and all entries.
class RayCounts {
 public:
  explicit RayCounts(const schema::Silhouette& of)
      : samples_(of.pixel_samples()),
        most_(most_entries(of)),
        all_(std::size_t{of.width_px()} * of.height_px(), 0) {}

  absl::Status add(std::uint32_t pixel, std::uint16_t count) {
    if (count > samples_ - all_[pixel])
      return absl::DataLossError(absl::StrCat("has a pixel of more than ", samples_, " samples"));
    all_[pixel] = static_cast<std::uint16_t>(all_[pixel] + count);
    if (++entries_ > most_)
      return absl::DataLossError(
          absl::StrCat("has more than ", most_, " numbers of pixels and parts"));
    return absl::OkStatus();
  }

 private:
  std::uint32_t samples_;
  std::uint64_t most_, entries_ = 0;
  std::vector<std::uint16_t> all_;
};

bool inflate_into(const std::string& packed, std::vector<unsigned char>& bytes, uLongf& size) {
  size = bytes.size();
  return uncompress(bytes.data(), &size, reinterpret_cast<const Bytef*>(packed.data()),
                    packed.size()) == Z_OK;
}

}  // namespace

absl::Status visit_silhouette(const schema::Silhouette& silhouette,
                              const std::function<void(int, std::uint32_t, std::uint16_t)>& visit) {
  IRSIG_STORE_TRY(check_frame(silhouette));
  IRSIG_STORE_TRY(check_boxes(silhouette));
  RayCounts rays(silhouette);
  std::vector<unsigned char> bytes;
  for (int p = 0; p < silhouette.part_size(); ++p) {
    const schema::PartPixels& part = silhouette.part(p);
    bytes.resize(2 * std::size_t{part.width_px()} * part.height_px());
    uLongf size = 0;
    if (!inflate_into(part.samples(), bytes, size) || size != bytes.size())
      return absl::DataLossError("has a part with damaged samples");
    bool any = false;
    for (std::size_t i = 0; 2 * i < bytes.size(); ++i) {
      const auto count = static_cast<std::uint16_t>(bytes[2 * i] | bytes[2 * i + 1] << 8U);
      if (count == 0) continue;
      const auto row = static_cast<std::uint32_t>(i / part.width_px()),
                 column = static_cast<std::uint32_t>(i % part.width_px());
      const std::uint32_t pixel =
          (part.top_px() + row) * silhouette.width_px() + part.left_px() + column;
      IRSIG_STORE_TRY(rays.add(pixel, count));
      any = true;
      visit(p, pixel, count);
    }
    if (!any) return absl::DataLossError("has a part that no sample sees");
  }
  return absl::OkStatus();
}

absl::Status visit_part_sets(const schema::Silhouette& silhouette,
                             const std::function<void(int, std::uint32_t, std::uint16_t)>& visit) {
  if (silhouette.part_set().empty()) return absl::OkStatus();
  IRSIG_STORE_TRY(check_frame(silhouette));
  // Each pixel of a part set has a count of skipped pixels and a count of rays.
  constexpr std::size_t kSkipBytes = 4, kCountBytes = 2, kBytes = kSkipBytes + kCountBytes;
  const std::uint32_t pixels = silhouette.width_px() * silhouette.height_px();
  RayCounts rays(silhouette);
  std::vector<unsigned char> bytes;
  for (int s = 0; s < silhouette.part_set_size(); ++s) {
    const schema::PartSetPixels& set = silhouette.part_set(s);
    if (!(set.outside_px() >= 0) || !std::isfinite(set.outside_px()))
      return absl::DataLossError("has a set of parts with no area outside the frame");
    bytes.resize(std::size_t{kBytes} * pixels);
    uLongf size = 0;
    if (!inflate_into(set.samples(), bytes, size) || size % kBytes != 0)
      return absl::DataLossError("has a set of parts with damaged samples");
    const std::size_t count = size / kBytes;
    if (count == 0 && set.outside_px() == 0)
      return absl::DataLossError("has a set of parts that no sample meets");
    std::uint64_t next = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const unsigned char *skip = bytes.data() + kSkipBytes * i,
                          *of = bytes.data() + kSkipBytes * count + kCountBytes * i;
      next += std::uint64_t{skip[0]} | std::uint64_t{skip[1]} << 8U |
              std::uint64_t{skip[2]} << 16U | std::uint64_t{skip[3]} << 24U;
      const auto number = static_cast<std::uint16_t>(of[0] | of[1] << 8U);
      if (next >= pixels || number == 0)
        return absl::DataLossError("has a set of parts with damaged samples");
      const auto pixel = static_cast<std::uint32_t>(next++);
      IRSIG_STORE_TRY(rays.add(pixel, number));
      visit(s, pixel, number);
    }
  }
  return absl::OkStatus();
}

absl::Status check_silhouette(const schema::Silhouette& silhouette, const std::string& path) {
  for (const auto& visited : {visit_silhouette, visit_part_sets}) {
    const absl::Status whole = visited(silhouette, [](int, std::uint32_t, std::uint16_t) {});
    if (!whole.ok()) return wrong_picture(path, std::string(whole.message()));
  }
  return absl::OkStatus();
}

}  // namespace irsig
