#include "view/pictures/shown_image.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "core/accuracy/image_layers.h"
#include "core/base/status_macros.h"
#include "view/base/on_all_cores.h"
#include "view/pictures/masks.h"
#include "view/pictures/stored_exr.h"

namespace irsig {
namespace {

// Images that irsig-picture decodes in one call: it answers with all their pixels.
constexpr std::size_t kReadAtOnce = 200;

absl::StatusOr<RadianceImage> with_conditions(RadianceImage image, const ShownImage& shown) {
  if (!shown.seen) return image;
  return seen_from(image, *shown.seen);
}

}  // namespace

const schema::ImageLayer* RowImage::layer(std::string_view name) const {
  for (const schema::ImageLayer& one : layers)
    if (one.name() == name) return &one;
  return nullptr;
}

std::string ShownAsked::wanted_layer() const {
  if (!layer.empty()) return layer;
  return background ? std::string(irsig::name_of(ImageLayer::kAtSensor)) : std::string();
}

absl::StatusOr<ShownImage> shown_image(const RowImage& image, const ShownAsked& asked,
                                       std::uint32_t most_px) {
  const StoredSignature& s = image.signature;
  // The layer at_sensor has the horizon and what lies behind edges.
  if (const schema::ImageLayer* layer = image.layer(asked.wanted_layer()))
    return ShownImage{layer->exr(), most_px};
  ShownImage out{image.thumbnail.exr(), most_px};
  if (!asked.layer.empty())
    return absl::NotFoundError(fmt::format(
        "the image of row {} has no layer {}: its sweep asks for none with [image] layers", s.row,
        asked.layer));
  if (!asked.background) return out;
  if (std::isnan(s.background_radiance_w_m2_sr) || std::isnan(s.path_radiance_w_m2_sr))
    return absl::FailedPreconditionError(fmt::format(
        "row {} was computed without contrast, background and path: run the sweep again", s.row));
  if (!std::isnan(s.plume_w_sr))
    return absl::InvalidArgumentError(
        fmt::format("row {} has hot gas, which lets part of the background through: its picture "
                    "cannot be put before it",
                    s.row));
  // So that the target's pixels add up to its apparent intensity.
  const double arrives_w_sr =
      s.apparent_intensity_w_sr - s.projected_area_m2 * s.path_radiance_w_m2_sr;
  out.seen = SeenFrom{
      s.intensity_w_sr != 0 ? arrives_w_sr / s.intensity_w_sr : s.path_transmittance,
      s.path_radiance_w_m2_sr, s.background_radiance_w_m2_sr, filled_fractions(image.silhouette)};
  return out;
}

absl::Status visit_images(
    std::span<const ShownImage> images, const ReadPictures& read,
    const std::function<absl::Status(std::size_t, absl::StatusOr<RadianceImage>)>& visit) {
  std::vector<char> decoded(images.size(), 0);
  RETURN_IF_ERROR(on_all_cores(images.size(), [&](std::size_t i) -> absl::Status {
    auto image = read_stored_exr(images[i].exr, images[i].most_px);
    decoded[i] = image.has_value();
    if (!image) return absl::OkStatus();
    return visit(i, with_conditions(*std::move(image), images[i]));
  }));
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < images.size(); ++i)
    if (!decoded[i]) others.push_back(i);
  for (std::size_t from = 0; from < others.size(); from += kReadAtOnce) {
    const auto some = std::span(others).subspan(from, std::min(kReadAtOnce, others.size() - from));
    std::vector<PictureTask> tasks;
    for (const std::size_t i : some)
      tasks.push_back(
          {.exr = std::string(images[i].exr), .most_px = images[i].most_px, .pixels = true});
    ASSIGN_OR_RETURN(auto answers, read(tasks));
    if (answers.size() != tasks.size())
      return absl::InternalError(
          fmt::format("{} of {} images were read", answers.size(), tasks.size()));
    RETURN_IF_ERROR(on_all_cores(some.size(), [&](std::size_t k) {
      PictureAnswer& a = answers[k];
      if (!a.damage.empty()) return visit(some[k], absl::InvalidArgumentError(a.damage));
      return visit(some[k],
                   with_conditions({a.width_px, a.height_px, std::move(a.pixel)}, images[some[k]]));
    }));
  }
  return absl::OkStatus();
}

}  // namespace irsig
