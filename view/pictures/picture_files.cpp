#include "view/pictures/picture_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <map>
#include <numeric>
#include <utility>

#include "core/accuracy/image_layers.h"
#include "core/base/status_macros.h"
#include "view/base/atomic_file.h"
#include "view/pictures/envi_cube.h"
#include "view/pictures/export_journal.h"
#include "view/pictures/masks.h"
#include "view/pictures/recorded_image.h"
#include "view/pictures/tiff.h"

namespace irsig {
namespace {

absl::Status not_recorded(const StoredSignature& s, const absl::Status& why) {
  return {why.code(), fmt::format("the image of row {}: {}", s.row, std::string(why.message()))};
}

}  // namespace

double hottest_of(const RadianceImage& image) {
  return static_cast<double>(
      *std::max_element(image.radiance_w_m2_sr.begin(), image.radiance_w_m2_sr.end()));
}

absl::Status PictureFiles::damaged(const RowImage& image, const absl::Status& why) const {
  return sweeps_.damaged(image.signature, std::string(why.message()));
}

absl::Status PictureFiles::plain_file(const std::string& path, const std::string& bytes) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file << bytes;
  file.close();
  return file ? absl::OkStatus() : write_failure(path);
}

absl::Status PictureFiles::find_figures(const std::vector<RowImage>& images,
                                        std::vector<PictureFacts>& facts) const {
  for (std::size_t i = 0; i < images.size(); ++i) {
    const Band* band = sweeps_.band_of(images[i].signature);
    if (!band)
      return final_end(absl::FailedPreconditionError(
          fmt::format("row {} is of an earlier version of its sweep, with another band: run the "
                      "sweep again",
                      images[i].signature.row)));
    const auto figures = imager_in_band(*asked_.imager, *band);
    if (!figures.ok()) return final_end(figures.status());
    facts[i].figures = *figures;
  }
  // The image that needs the most stored pixels is checked first: its remedy serves all.
  const auto needed = [](const RowImage& image) {
    const schema::Thumbnail& t = image.thumbnail;
    return t.pixel_rad() * std::max(t.width_px(), t.height_px());
  };
  const auto coarsest =
      std::max_element(images.begin(), images.end(),
                       [&](const RowImage& x, const RowImage& y) { return needed(x) < needed(y); });
  if (coarsest == images.end()) return absl::OkStatus();
  const schema::Thumbnail& t = coarsest->thumbnail;
  const auto grid = detector_grid(*asked_.imager, t.width_px(), t.height_px(), t.pixel_rad());
  return grid.ok() ? absl::OkStatus() : final_end(not_recorded(coarsest->signature, grid.status()));
}

absl::Status PictureFiles::write(RowImage& image, RadianceImage radiance,
                                 PictureFacts& facts) const {
  const StoredSignature& s = image.signature;
  if (radiance.width_px != image.silhouette.width_px ||
      radiance.height_px != image.silhouette.height_px)
    return sweeps_.damaged(s, "its silhouette is of another size");
  if (asked_.exr) {
    const std::string name = folder_ + "/" + sweeps_.name_of(s);
    RETURN_IF_ERROR(plain_file(name + ".exr", image.thumbnail.exr()));
    RETURN_IF_ERROR(plain_file(name + ".stderr.exr", image.thumbnail.stderr_exr()));
    if (!image.layers.empty()) RETURN_IF_ERROR(write_layers(image));
  }
  RETURN_IF_ERROR(asked_.imager ? write_counts(image, std::move(radiance), facts)
                                : write_picture(image, radiance, facts));
  facts.target = covered_pixels(image.silhouette);
  const std::vector<float> filled = filled_fractions(image.silhouette);
  facts.target_in_frame_px = std::accumulate(filled.begin(), filled.end(), 0.0);
  return asked_.masks ? write_mask(image) : absl::OkStatus();
}

absl::Status PictureFiles::write_picture(const RowImage& image, const RadianceImage& radiance,
                                         PictureFacts& facts) const {
  const std::string path = folder_ + "/" + facts.name + ending_of(asked_.format);
  if (asked_.format == PictureFormat::kEnvi) return write_envi_band(path, facts.band, radiance);
  if (scale_.kind == PictureScale::Kind::kOwn) facts.white_w_m2_sr = hottest_of(radiance);
  const GreyScale scale{static_cast<float>(facts.black_w_m2_sr),
                        static_cast<float>(facts.white_w_m2_sr)};
  const auto bytes = asked_.format == PictureFormat::kTiff
                         ? encode_tiff(radiance, scale, asked_.bits)
                         : encode_png(radiance, scale, asked_.bits, PngPacking::kFast);
  return bytes.ok() ? plain_file(path, *bytes) : damaged(image, bytes.status());
}

// All layers of an image in one file, and the standard errors of at_sensor.
absl::Status PictureFiles::write_layers(const RowImage& image) const {
  const StoredSignature& s = image.signature;
  std::map<std::string, std::vector<float>> layers;
  const auto add = [&](const std::string& name, const std::string& exr) -> absl::Status {
    const ShownImage layer{exr, sweeps_.most_px(s)};
    return visit_images({&layer, 1}, read_,
                        [&](std::size_t, absl::StatusOr<RadianceImage> read) -> absl::Status {
                          if (!read.ok()) return damaged(image, read.status());
                          layers[name] = std::move(read->radiance_w_m2_sr);
                          return absl::OkStatus();
                        });
  };
  for (const schema::ImageLayer& layer : image.layers) {
    if (!image_layer_of(layer.name())) return sweeps_.damaged(s, "a layer has no known name");
    RETURN_IF_ERROR(add(layer.name(), layer.exr()));
    if (!layer.stderr_exr().empty())
      RETURN_IF_ERROR(add(layer.name() + "_stderr", layer.stderr_exr()));
  }
  const auto exr =
      encode_layers_exr(image.thumbnail.width_px(), image.thumbnail.height_px(), layers);
  if (!exr.ok()) return damaged(image, exr.status());
  return plain_file(folder_ + "/" + sweeps_.name_of(s) + ".layers.exr", *exr);
}

// The picture as the imager records it: the silhouette becomes that of its pixels.
absl::Status PictureFiles::write_counts(RowImage& image, RadianceImage seen,
                                        PictureFacts& facts) const {
  const StoredSignature& s = image.signature;
  auto one = record_image(*asked_.imager, facts.figures, s, seen, image.thumbnail.pixel_rad(),
                          image.silhouette, image.layer(name_of(ImageLayer::kAtSensor)) != nullptr);
  if (absl::IsInvalidArgument(one.status())) return final_end(not_recorded(s, one.status()));
  if (!one.ok()) return not_recorded(s, one.status());
  facts.saturated_px = one->saturated_px;
  image.silhouette = std::move(one->silhouette);
  image.thumbnail.set_width_px(image.silhouette.width_px);
  image.thumbnail.set_height_px(image.silhouette.height_px);
  image.thumbnail.set_pixel_rad(asked_.imager->ifov_rad());
  const std::string name = folder_ + "/" + facts.name;
  RETURN_IF_ERROR(plain_file(name + ".png", one->png));
  return asked_.exr ? plain_file(name + ".noiseless.exr", one->noiseless_exr) : absl::OkStatus();
}

absl::Status PictureFiles::write_mask(const RowImage& image) const {
  const std::size_t parts = sweeps_.parts().size();
  const std::vector<std::uint16_t> mask = part_mask(image.silhouette, sweeps_.parts());
  if (*std::max_element(mask.begin(), mask.end()) > parts)
    return final_end(absl::FailedPreconditionError(
        fmt::format("row {} is of an earlier version of its sweep, with other parts: run the "
                    "sweep again",
                    image.signature.row)));
  ASSIGN_OR_RETURN(const auto png,
                   encode_grey_png(image.silhouette.width_px, image.silhouette.height_px, mask,
                                   parts < 256 ? 8 : 16, PngPacking::kFast));
  return plain_file(folder_ + "/" + sweeps_.mask_of(image.signature), png);
}

absl::Status PictureFiles::write_headers(const std::vector<RowImage>& images,
                                         const std::vector<PictureFacts>& facts) const {
  for (std::size_t first = 0, end = 0; first < images.size(); first = end) {
    const StoredSignature& s = images[first].signature;
    EnviCube cube{images[first].thumbnail.width_px(), images[first].thumbnail.height_px(), {}, {}};
    for (; end < images.size() && facts[end].name == facts[first].name; ++end) {
      const StoredSignature& of = images[end].signature;
      cube.band.push_back({of.band, of.lambda_min_um, of.lambda_max_um});
      if (images[end].thumbnail.width_px() != cube.width_px ||
          images[end].thumbnail.height_px() != cube.height_px)
        return final_end(absl::InvalidArgumentError(
            fmt::format("the images of rows {} and {} differ in size, expected one --band: the "
                        "bands of a cube have one size",
                        s.row, of.row)));
    }
    cube.description = fmt::format(
        "in-band radiance {} of {}; {}; {}; aspect azimuth {:g} elevation {:g} deg; range {:g} m",
        !asked_.layer.empty() ? "of the layer " + asked_.layer
        : asked_.background   ? "at the sensor"
                              : "at the target",
        s.sweep, s.season, s.time_utc, s.aspect_azimuth_deg, s.aspect_elevation_deg, s.range_m);
    RETURN_IF_ERROR(plain_file(folder_ + "/" + facts[first].name + ".hdr", envi_header(cube)));
  }
  return absl::OkStatus();
}

}  // namespace irsig
