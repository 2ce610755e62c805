#include "view/pictures/sweep_imager.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "core/accuracy/image_layers.h"
#include "core/base/status_macros.h"
#include "messages/imager/imager_from_message.h"
#include "view/pictures/band_quadrature.h"
#include "view/pictures/recorded_image.h"
#include "view/pictures/shown_image.h"

namespace irsig {
namespace {

absl::StatusOr<Band> band_of_row(const schema::Sweep& sweep, const StoredSignature& row) {
  for (const schema::Band& b : sweep.band())
    if (b.name() == row.band && b.lambda_min_um() == row.lambda_min_um &&
        b.lambda_max_um() == row.lambda_max_um) {
      ASSIGN_OR_RETURN(auto found, band_quadrature(b));
      return std::move(found.band);
    }
  return absl::FailedPreconditionError(fmt::format(
      "row {} is of an earlier version of its sweep, with another band: run the sweep again",
      row.row));
}

absl::StatusOr<RowImage> stored_image(StoreReader& reader, const StoredSignature& row) {
  RowImage out;
  out.signature = row;
  ASSIGN_OR_RETURN(auto thumbnail, reader.thumbnail(row.signature_id));
  if (!thumbnail)
    return absl::NotFoundError(fmt::format("row {} was computed without an image", row.row));
  out.thumbnail = *std::move(thumbnail);
  auto silhouette = reader.silhouette(row.signature_id);
  if (silhouette.ok() && !silhouette->has_value())
    silhouette = absl::DataLossError("it has no silhouette");
  if (!silhouette.ok()) return silhouette.status();
  out.silhouette = **std::move(silhouette);
  ASSIGN_OR_RETURN(auto layer,
                   reader.image_layer(row.signature_id, name_of(ImageLayer::kAtSensor)));
  if (layer) out.layers.push_back(*std::move(layer));
  return out;
}

}  // namespace

absl::StatusOr<std::optional<SweepImager>> imager_of_sweep(const schema::Sweep& sweep) {
  if (!sweep.has_imager()) return std::nullopt;
  ASSIGN_OR_RETURN(auto imager, imager_from_message(sweep.imager()));
  return SweepImager{
      sweep.imager().has_name() ? sweep.imager().name() : "[imager] of " + sweep.name(),
      sweep.imager().SerializeAsString(), std::move(imager)};
}

absl::StatusOr<std::optional<SweepImager>> common_imager(StoreReader& reader,
                                                         const std::string& sweep) {
  std::optional<SweepImager> out;
  bool first = true;
  ASSIGN_OR_RETURN(const auto progress, reader.progress());
  for (const SweepProgress& of : progress) {
    if (!sweep.empty() && of.name != sweep) continue;
    ASSIGN_OR_RETURN(const auto stored, reader.sweep(of.name, SweepFiles::kNone));
    ASSIGN_OR_RETURN(auto imager, imager_of_sweep(stored.resolved.sweep()));
    const std::string identity = imager ? imager->identity : "";
    if (!first && identity != (out ? out->identity : ""))
      return absl::InvalidArgumentError(
          "the [imager] of the database's sweeps differ: choose one sweep with --sweep, or state "
          "--no-imager for stored radiance");
    if (first) out = std::move(imager);
    first = false;
  }
  return out;
}

absl::StatusOr<CountsFrame> counts_frame(StoreReader& reader, const SweepImager& imager,
                                         const StoredSignature& row,
                                         const schema::Thumbnail& image) {
  ASSIGN_OR_RETURN(const auto stored, reader.sweep(row.sweep, SweepFiles::kNone));
  ASSIGN_OR_RETURN(const auto band, band_of_row(stored.resolved.sweep(), row));
  if (!std::isnan(row.plume_w_sr))
    return absl::InvalidArgumentError(
        fmt::format("row {} has hot gas, which lets part of the background through", row.row));
  CountsFrame out;
  ASSIGN_OR_RETURN(out.figures, imager_in_band(imager.imager, band));
  ASSIGN_OR_RETURN(const auto layer,
                   reader.image_layer(row.signature_id, name_of(ImageLayer::kAtSensor)));
  ASSIGN_OR_RETURN(out.grid, recorded_grid(imager.imager, image.width_px(), image.height_px(),
                                           image.pixel_rad(), layer.has_value()));
  return out;
}

absl::StatusOr<std::string> counts_exr(const CountsImage& counts) {
  RadianceImage out{counts.width_px, counts.height_px, {}};
  out.radiance_w_m2_sr.assign(counts.counts.begin(), counts.counts.end());
  return encode_exr(out);
}

absl::StatusOr<CountsOfRow> counts_of_row(StoreReader& reader, const SweepImager& imager,
                                          const StoredSignature& row, const ReadPictures& read) {
  ASSIGN_OR_RETURN(const auto stored, reader.sweep(row.sweep, SweepFiles::kNone));
  const schema::Sweep& sweep = stored.resolved.sweep();
  CountsOfRow out;
  ASSIGN_OR_RETURN(const auto band, band_of_row(sweep, row));
  ASSIGN_OR_RETURN(out.figures, imager_in_band(imager.imager, band));
  ASSIGN_OR_RETURN(const auto image, stored_image(reader, row));
  ASSIGN_OR_RETURN(const auto shown,
                   shown_image(image, {.layer = "", .background = true}, most_px_of(sweep)));
  const bool surroundings = image.layer(name_of(ImageLayer::kAtSensor)) != nullptr;
  RETURN_IF_ERROR(visit_images(
      {&shown, 1}, read, [&](std::size_t, absl::StatusOr<RadianceImage> seen) -> absl::Status {
        if (!seen.ok())
          return absl::DataLossError(fmt::format("the stored image of row {} is damaged: {}",
                                                 row.row, std::string(seen.status().message())));
        if (seen->width_px != image.silhouette.width_px ||
            seen->height_px != image.silhouette.height_px)
          return absl::DataLossError(
              fmt::format("the silhouette of row {} is of another size than its image", row.row));
        ASSIGN_OR_RETURN(auto recorded, record_counts(imager.imager, out.figures, row, *seen,
                                                      image.thumbnail.pixel_rad(), surroundings));
        out.counts = std::move(recorded.counts);
        out.silhouette = on_detector(image.silhouette, recorded.grid);
        return absl::OkStatus();
      }));
  return out;
}

}  // namespace irsig
