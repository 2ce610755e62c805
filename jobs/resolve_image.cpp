// [image]
#include <algorithm>
#include <bit>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/accuracy/image_layers.h"
#include "jobs/resolve.h"
#include "jobs/text/nearest_name.h"
#include "schema/image_size.h"

namespace irsig {
namespace {

void check_pixels(const schema::Image& image, const SectionCheck& check) {
  if (image.pixels_size() != 2)
    check.error("pixels", image.pixels().empty()
                              ? std::string("is missing, expected [width, height]")
                              : absl::StrCat("has ", image.pixels_size(),
                                             " of two numbers, expected [width, height]"));
}

void check_camera(const schema::ResolvedSweep& resolved, const SectionCheck& check) {
  const schema::Image& image = resolved.sweep().image();
  if (image.kind() != "camera") {
    for (const char* name : {"field_of_view_deg", "look_at_m"})
      if (check.has(name))
        check.error(name, "belongs to a camera, expected kind = \"camera\", or delete it");
    return;
  }
  check.require({"field_of_view_deg"}, "expected what the width of the image subtends");
  if (check.has("margin"))
    check.error("margin", "belongs to a framed image, expected kind = \"framed\", or delete it");
  if (image.look_at_m().empty()) return;
  if (image.look_at_m_size() != 3) {
    check.error("look_at_m", absl::StrCat("has ", image.look_at_m_size(),
                                          " numbers, expected three: x forward, y starboard, z "
                                          "down"));
    return;
  }
  const double distance_m = std::hypot(image.look_at_m(0), image.look_at_m(1), image.look_at_m(2));
  for (const schema::Viewpoint& v : resolved.viewpoint())
    if (!(distance_m < v.range_m())) {
      check.error("look_at_m", absl::StrCat("is as far from the reference point as a sensor, "
                                            "expected less than the range of ",
                                            v.range_m(), " m"));
      return;
    }
}

void check_rays(const schema::Sweep& sweep, const SectionCheck& check) {
  const schema::Image& image = sweep.image();
  for (const auto& [name, rays] :
       {std::pair{"samples", image.samples()}, {"max_samples", image.max_samples()}})
    // Larger numbers are beyond their bounds, and 2^32 is no number of 32 bits.
    if (check.has(name) && !std::has_single_bit(rays) && rays < (1U << 31))
      check.error(name, absl::StrCat("= ", rays, ", expected a power of two: ",
                                     std::bit_floor(rays), " or ", std::bit_ceil(rays)));
  (void)check.at_most_one({"pixel_error_percent", "pixel_error_k"});
  const bool error = check.has("pixel_error_percent") || check.has("pixel_error_k");
  if (check.has("samples") && error)
    check.error(
        "samples",
        "does not apply where the error of a pixel is asked for: delete it, or limit the rays "
        "with max_samples");
  if (check.has("max_samples") && !error)
    check.error("max_samples",
                "does not apply without pixel_error_percent or pixel_error_k: samples states them");
}

void check_layers(const schema::Sweep& sweep, const SectionCheck& check) {
  const schema::Image& image = sweep.image();
  std::vector<std::string> known;
  for (const ImageLayerInfo& layer : kImageLayers) known.emplace_back(layer.name);
  const auto& layers = image.layers();
  for (int i = 0; i < layers.size(); ++i) {
    const std::string key = absl::StrCat("layers[", i, "]");
    if (!image_layer_of(layers[i]))
      check.error_at(key, absl::StrCat("= \"", layers[i], "\": there is no such layer, ",
                                       suggestion(layers[i], known)));
    else if (std::find(layers.begin(), layers.begin() + i, layers[i]) != layers.begin() + i)
      check.error_at(key, absl::StrCat("= \"", layers[i], "\" is there twice: delete one"));
  }
  const auto has = [&](ImageLayer layer) {
    return std::find(layers.begin(), layers.end(), name_of(layer)) != layers.end();
  };
  for (const ImageLayer layer : {ImageLayer::kPath, ImageLayer::kBackground, ImageLayer::kHidden})
    if (has(layer) && !has(ImageLayer::kAtSensor))
      check.error("layers", absl::StrCat("has \"", name_of(layer), "\" without \"",
                                         name_of(ImageLayer::kAtSensor),
                                         "\", of which it is a part: add it"));
  if (has(ImageLayer::kSunlit) && !sweep.transport().sun())
    check.error("layers", absl::StrCat("has \"", name_of(ImageLayer::kSunlit),
                                       "\", but the sweep has no sun: set [transport] sun = true"));
  for (std::size_t i = 0; i < kImageLayers.size(); ++i)
    if (const auto layer = static_cast<ImageLayer>(i);
        is_of_land(layer) && has(layer) && !sweep.has_land())
      check.error("layers", absl::StrCat("has \"", name_of(layer),
                                         "\", but the sweep has no [land]: leave it out"));
  for (const ImageLayer layer : {ImageLayer::kGasEmitted, ImageLayer::kGasAbsorbed})
    if (has(layer) && !sweep.has_plume())
      check.error("layers", absl::StrCat("has \"", name_of(layer),
                                         "\", but the sweep has no [plume]: leave it out"));
}

}  // namespace

void check_image(const schema::ResolvedSweep& resolved, Findings& findings) {
  const schema::Sweep& sweep = resolved.sweep();
  if (!sweep.has_image()) return;
  const schema::Image& image = sweep.image();
  const SectionCheck check(image, "image", findings);
  if (sweep.output().has_thumbnail_px())
    findings.add(
        "output.thumbnail_px",
        "output.thumbnail_px is stated beside [image], expected only one of them: [image] has "
        "pixels of its own");
  (void)(!check.has("kind") || check.one_of("kind", {"framed", "camera"}));
  check_pixels(image, check);
  check_camera(resolved, check);
  check_rays(sweep, check);
  check_layers(sweep, check);
  if (image.pixels_size() == 2 && image_bytes_of_row(sweep) > kMostImageBytes)
    check.error(
        "pixels",
        absl::StrCat("= [", image.pixels(0), ", ", image.pixels(1), "] with ", image.layers_size(),
                     " layers may take ", absl::SixDigits(image_bytes_of_row(sweep) / 1e6),
                     " MB for each row, expected at most ", absl::SixDigits(kMostImageBytes / 1e6),
                     " MB: fewer pixels or layers"));
}

void write_image_defaults(schema::Sweep& sweep) {
  if (!sweep.has_image()) {
    if (!sweep.output().has_thumbnail_px()) sweep.mutable_output()->set_thumbnail_px(128);
    return;
  }
  schema::Image& image = *sweep.mutable_image();
  if (!image.has_kind()) image.set_kind("framed");
  if (image.kind() == "framed" && !image.has_margin()) image.set_margin(0.05);
  if ((image.has_pixel_error_percent() || image.has_pixel_error_k()) && !image.has_max_samples())
    image.set_max_samples(4096);
  // The layers are stored in the order of kImageLayers.
  std::vector<std::string> layers;
  for (const ImageLayerInfo& layer : kImageLayers)
    if (std::find(image.layers().begin(), image.layers().end(), layer.name) != image.layers().end())
      layers.emplace_back(layer.name);
  image.mutable_layers()->Assign(layers.begin(), layers.end());
  if (!image.whole_parts()) image.clear_whole_parts();
  // Databases and coordinators read the size of a sweep's images here.
  sweep.mutable_output()->set_thumbnail_px(std::max(image.pixels(0), image.pixels(1)));
}

}  // namespace irsig
