#include "core/image/reader/exr_reader.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <string>

namespace irsig {
namespace {

namespace oiio = OIIO;

// Thumbnails are too small to share among threads.
void without_threads() {
  static std::once_flag once;
  std::call_once(once, [] {
    oiio::attribute("threads", 1);
    oiio::attribute("exr_threads", -1);
  });
}

}  // namespace

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
    return absl::InvalidArgumentError("image: its header states " + std::to_string(spec.width) +
                                      " x " + std::to_string(spec.height) +
                                      " pixels, expected sides of at most " +
                                      std::to_string(most_px) + ", as its sweep asked for");
  RadianceImage image{
      static_cast<std::uint32_t>(spec.width), static_cast<std::uint32_t>(spec.height), {}};
  image.radiance_w_m2_sr.resize(std::size_t{image.width_px} * image.height_px);
  if (!input->read_image(0, 0, 0, 1, oiio::TypeDesc::FLOAT, image.radiance_w_m2_sr.data()))
    return absl::InvalidArgumentError("image: " + input->geterror());
  return image;
}

}  // namespace irsig
