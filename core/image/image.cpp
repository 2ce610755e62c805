#include "core/image/image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>

#include "core/base/status_macros.h"

namespace irsig {
namespace {

namespace oiio = OIIO;

// Thumbnails are too small to share among threads, and a worker's threads have other work.
void without_threads() {
  static std::once_flag once;
  std::call_once(once, [] {
    oiio::attribute("threads", 1);
    oiio::attribute("exr_threads", -1);
  });
}

absl::Status check(const RadianceImage& image) {
  constexpr std::uint32_t max_px = 1u << 15;
  if (image.width_px == 0 || image.height_px == 0 || image.width_px > max_px ||
      image.height_px > max_px) {
    return absl::InvalidArgumentError("image: expected 1 to 32768 pixels in width and height");
  }
  if (image.radiance_w_m2_sr.size() != std::size_t{image.width_px} * image.height_px)
    return absl::InvalidArgumentError("image: the pixels do not fill width x height");
  for (const float radiance : image.radiance_w_m2_sr) {
    if (!std::isfinite(radiance))
      return absl::InvalidArgumentError("image: a radiance is not finite");
  }
  return absl::OkStatus();
}

oiio::ImageSpec spec_of(const RadianceImage& image, oiio::TypeDesc type) {
  oiio::ImageSpec spec(static_cast<int>(image.width_px), static_cast<int>(image.height_px), 1,
                       type);
  spec.channelnames = {"Y"};
  return spec;
}

absl::StatusOr<std::string> encode(const char* name, const oiio::ImageSpec& spec,
                                   const void* pixels) {
  without_threads();
  const std::unique_ptr<oiio::ImageOutput> output = oiio::ImageOutput::create(name);
  if (!output) return absl::InternalError("image: " + oiio::geterror());
  oiio::Filesystem::IOVecOutput memory;
  if (!output->set_ioproxy(&memory) || !output->open(name, spec) ||
      !output->write_image(spec.format, pixels) || !output->close()) {
    return absl::InternalError("image: " + output->geterror());
  }
  return std::string(memory.buffer().begin(), memory.buffer().end());
}

}  // namespace

absl::StatusOr<std::string> encode_exr(const RadianceImage& image) {
  RETURN_IF_ERROR(check(image));
  oiio::ImageSpec spec = spec_of(image, oiio::TypeDesc::FLOAT);
  spec.attribute("compression", "rle");
  // The writer would put the present time here.
  spec.attribute("DateTime", "1970:01:01 00:00:00");
  return encode("radiance.exr", spec, image.radiance_w_m2_sr.data());
}

absl::StatusOr<std::string> encode_png(const RadianceImage& image) {
  RETURN_IF_ERROR(check(image));
  return encode_png(
      image, {0, *std::max_element(image.radiance_w_m2_sr.begin(), image.radiance_w_m2_sr.end())});
}

absl::StatusOr<std::string> encode_png(const RadianceImage& image, const GreyScale& scale) {
  RETURN_IF_ERROR(check(image));
  const double black = static_cast<double>(scale.black_w_m2_sr);
  const double range = static_cast<double>(scale.white_w_m2_sr) - black;
  std::vector<unsigned char> grey;
  grey.reserve(image.radiance_w_m2_sr.size());
  for (const float radiance : image.radiance_w_m2_sr) {
    const double part =
        range > 0 ? std::clamp((static_cast<double>(radiance) - black) / range, 0.0, 1.0) : 0;
    grey.push_back(static_cast<unsigned char>(std::lround(255 * part)));
  }
  oiio::ImageSpec spec = spec_of(image, oiio::TypeDesc::UINT8);
  return encode("radiance.png", spec, grey.data());
}

absl::StatusOr<RadianceImage> decode_exr(std::string_view bytes, std::uint32_t most_px) {
  without_threads();
  oiio::Filesystem::IOMemReader memory(bytes.data(), bytes.size());
  const std::unique_ptr<oiio::ImageInput> input =
      oiio::ImageInput::open("radiance.exr", nullptr, &memory);
  if (!input) return absl::InvalidArgumentError("image: " + oiio::geterror());
  const oiio::ImageSpec& spec = input->spec();
  if (spec.nchannels != 1 || spec.width < 1 || spec.height < 1)
    return absl::InvalidArgumentError("image: expected one channel");
  const auto side = static_cast<std::uint32_t>(std::max(spec.width, spec.height));
  if (side > most_px)
    return absl::InvalidArgumentError(
        "image: its header states " + std::to_string(spec.width) + " x " +
        std::to_string(spec.height) + " pixels, expected sides of at most " +
        std::to_string(most_px) + ", as its sweep asked for");
  RadianceImage image{
      static_cast<std::uint32_t>(spec.width), static_cast<std::uint32_t>(spec.height), {}};
  image.radiance_w_m2_sr.resize(std::size_t{image.width_px} * image.height_px);
  if (!input->read_image(0, 0, 0, 1, oiio::TypeDesc::FLOAT, image.radiance_w_m2_sr.data()))
    return absl::InvalidArgumentError("image: " + input->geterror());
  return image;
}

}  // namespace irsig
