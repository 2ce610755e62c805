#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/accuracy/image_layers.h"
#include "core/base/status_macros.h"
#include "schema/store/check/check_picture.h"
#include "serve/answer_parts.h"
#include "serve/command_line.h"
#include "serve/json_text.h"
#include "view/pictures/recorded_image.h"
#include "view/pictures/sweep_imager.h"
#include "view/pictures/thumbnail.h"

namespace irsig {
namespace {

absl::Status damaged(const StoredSignature& row, std::string_view what) {
  return absl::FailedPreconditionError(
      fmt::format("the stored image of row {} is damaged: {}", row.row, what));
}

// A row with its stored image, which is of the stored range.
struct RowImage {
  StoredSignature row;
  schema::Thumbnail image;
};

absl::StatusOr<RowImage> image_of(const PageSources& sources, StoreReader& reader,
                                  const Question& q) {
  Question stored = q;
  stored.range_m.reset();
  ASSIGN_OR_RETURN(const auto rows, one_row(sources, reader, stored));
  ASSIGN_OR_RETURN(auto image, stored_thumbnail(reader, rows));
  RowImage out{rows.front().signature, std::move(image)};
  const std::uint32_t width_px = out.image.width_px(), height_px = out.image.height_px();
  if (width_px < 1 || height_px < 1 || width_px > kMostPixels || height_px > kMostPixels)
    return damaged(out.row, fmt::format("its size is {} x {} pixels, expected 1 to {}", width_px,
                                        height_px, kMostPixels));
  return out;
}

// The limits of the row's band; empty: the band has a response, or the sweep no longer has it.
absl::StatusOr<std::vector<double>> plain_band_um(StoreReader& reader, const StoredSignature& row) {
  if (row.superseded) return std::vector<double>();
  ASSIGN_OR_RETURN(const auto sweep, reader.sweep(row.sweep, SweepFiles::kNone));
  for (const schema::Band& band : sweep.resolved.sweep().band())
    if (band.name() == row.band && band.response().empty())
      return std::vector<double>{row.lambda_min_um, row.lambda_max_um};
  return std::vector<double>();
}

std::string describe_layer(const ImageLayerInfo& info, const schema::ImageLayer& layer,
                           const std::string& command) {
  JsonObject out;
  out.text("name", info.name);
  out.text("unit", info.unit);
  out.text("what", info.what);
  out.flag("stderr", !layer.stderr_exr().empty());
  out.text("command", command);
  return out.finish();
}

// Images above take more than about a second to record.
constexpr std::uint32_t kMostRecordedPx = 1024;

struct PageImager {
  SweepImager imager;
  CountsFrame frame;
};

// The camera of the row's sweep before its image; nothing: the sweep has none. Errors state why it
// cannot record the image.
absl::StatusOr<std::optional<PageImager>> page_imager(StoreReader& reader, const RowImage& of) {
  if (of.row.superseded) return std::nullopt;
  ASSIGN_OR_RETURN(const auto sweep, reader.sweep(of.row.sweep, SweepFiles::kNone));
  ASSIGN_OR_RETURN(auto imager, imager_of_sweep(sweep.resolved.sweep()));
  if (!imager) return std::nullopt;
  if (std::max(of.image.width_px(), of.image.height_px()) > kMostRecordedPx)
    return absl::FailedPreconditionError(
        fmt::format("the page records images of at most {} pixels along a side; irsig plot "
                    "--kind picture records larger ones",
                    kMostRecordedPx));
  ASSIGN_OR_RETURN(const auto frame, counts_frame(reader, *imager, of.row, of.image));
  return PageImager{*std::move(imager), frame};
}

absl::StatusOr<PageImager> needed_imager(StoreReader& reader, const RowImage& of) {
  ASSIGN_OR_RETURN(auto imager, page_imager(reader, of));
  if (!imager)
    return absl::NotFoundError(
        fmt::format("row {} has no counts: its sweep has no [imager]", of.row.row));
  return *std::move(imager);
}

std::string describe_counts(const PageImager& of, const std::string& command) {
  JsonObject out;
  out.text("name", of.imager.name);
  out.count("width_px", of.frame.grid.width_px);
  out.count("height_px", of.frame.grid.height_px);
  out.number("pixel_rad", of.imager.imager.ifov_rad());
  out.count("bits", of.imager.imager.bits);
  out.number("counts_per_w_m2_sr", of.frame.figures.counts_per_w_m2_sr);
  out.number("offset_counts", of.frame.figures.offset_counts);
  out.number("noise_w_m2_sr", of.frame.figures.noise_w_m2_sr);
  out.text("command", command);
  return out.finish();
}

// A stored image in another layout than irsig's is not decoded in this process.
absl::StatusOr<std::vector<PictureAnswer>> refuse_other_layouts(const std::vector<PictureTask>&) {
  return absl::FailedPreconditionError(
      "the stored image has not the layout of irsig, so that the page records no counts of it");
}

}  // namespace

absl::StatusOr<PageReply> answer_image(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto reader, open_database(sources, q.a.database));
  ASSIGN_OR_RETURN(const auto of, image_of(sources, *reader, q));
  ASSIGN_OR_RETURN(const auto layers, reader->image_layers(of.row.signature_id));
  ASSIGN_OR_RETURN(const auto band_um, plain_band_um(*reader, of.row));
  const std::string& database = sources.database[q.a.database];
  std::vector<std::string> described;
  for (const ImageLayerInfo& info : kImageLayers)
    for (const schema::ImageLayer& layer : layers)
      if (layer.name() == info.name)
        described.push_back(describe_layer(info, layer, layer_command(database, q, info.name)));
  JsonObject out;
  out.text("command", image_command(database, q));
  out.count("width_px", of.image.width_px());
  out.count("height_px", of.image.height_px());
  out.number("pixel_rad", of.image.pixel_rad());
  out.number("error_relative", of.image.error_relative());
  out.flag("stderr", !of.image.stderr_exr().empty());
  out.flag("gas", !std::isnan(of.row.plume_w_sr));
  out.numbers("plain_band_um", band_um);
  out.objects("layer", described);
  const auto imager = page_imager(*reader, of);
  std::vector<std::string> counts;
  if (imager.ok() && *imager)
    counts.push_back(describe_counts(**imager, counts_command(database, q)));
  out.objects("counts", counts);
  out.text("no_counts", imager.ok() ? "" : std::string(imager.status().message()));
  return json_reply(out.finish());
}

absl::StatusOr<PageReply> answer_image_exr(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto reader, open_database(sources, q.a.database));
  ASSIGN_OR_RETURN(auto of, image_of(sources, *reader, q));
  std::string exr, what = "the image";
  if (q.counts) {
    if (q.stderr_of_image)
      return absl::NotFoundError("counts have no standard errors: their noise is in them");
    ASSIGN_OR_RETURN(const auto imager, needed_imager(*reader, of));
    ASSIGN_OR_RETURN(const auto recorded,
                     counts_of_row(*reader, imager.imager, of.row, refuse_other_layouts));
    ASSIGN_OR_RETURN(exr, counts_exr(recorded.counts));
    return PageReply{200, "image/x-exr", std::move(exr), ""};
  }
  if (q.layer) {
    what = fmt::format("layer {}", name_of(*q.layer));
    ASSIGN_OR_RETURN(auto layer, stored_layer(*reader, of.row, name_of(*q.layer)));
    exr = std::move(*(q.stderr_of_image ? layer.mutable_stderr_exr() : layer.mutable_exr()));
  } else {
    exr = std::move(*(q.stderr_of_image ? of.image.mutable_stderr_exr() : of.image.mutable_exr()));
  }
  if (q.stderr_of_image && exr.empty())
    return absl::NotFoundError(
        fmt::format("row {} has no standard errors of {}", of.row.row, what));
  if (const std::string wrong = exr_defect(exr, of.image.width_px(), of.image.height_px());
      !wrong.empty())
    return damaged(of.row,
                   fmt::format("the file of {}{} {}",
                               q.stderr_of_image ? "the standard errors of " : "", what, wrong));
  return PageReply{200, "image/x-exr", std::move(exr), ""};
}

// Counts of each part as runs of pixels, row by row from the top left: how many pixels after the
// run before show nothing of the part, how long the run is, and how many samples of each of its
// pixels meet the part.
absl::StatusOr<PageReply> answer_silhouette(const PageSources& sources, const Question& q) {
  if (q.stderr_of_image || q.layer)
    return absl::InvalidArgumentError(fmt::format(
        "parameter {}: there is no such parameter here but layer = counts, for the pixels of the "
        "sweep's imager",
        q.layer ? "layer" : "stderr"));
  ASSIGN_OR_RETURN(const auto reader, open_database(sources, q.a.database));
  ASSIGN_OR_RETURN(const auto of, image_of(sources, *reader, q));
  const auto silhouette = reader->silhouette(of.row.signature_id);
  if (absl::IsDataLoss(silhouette.status()))
    return damaged(of.row, "the silhouette " + std::string(silhouette.status().message()));
  if (!silhouette.ok()) return silhouette.status();
  if (!silhouette->has_value())
    return absl::NotFoundError(fmt::format("row {} has no silhouette", of.row.row));
  StoredSilhouette seen = **silhouette;
  if (seen.width_px != of.image.width_px() || seen.height_px != of.image.height_px())
    return damaged(of.row, "the silhouette is of another size than the image");
  if (q.counts) {
    ASSIGN_OR_RETURN(const auto imager, needed_imager(*reader, of));
    seen = on_detector(seen, imager.frame.grid);
  }
  std::vector<std::string> parts;
  for (const StoredSilhouette::Part& part : seen.part) {
    std::vector<std::uint64_t> runs;
    std::uint32_t next = 0;  // the pixel behind the last run
    for (const StoredSilhouette::Pixel& pixel : part.pixel) {
      if (!runs.empty() && pixel.at == next && pixel.samples == runs.back())
        ++runs[runs.size() - 2];
      else
        runs.insert(runs.end(), {pixel.at - next, 1, pixel.samples});
      next = pixel.at + 1;
    }
    JsonObject out;
    out.text("name", part.name);
    out.counts("run", runs);
    parts.push_back(out.finish());
  }
  JsonObject out;
  out.count("width_px", seen.width_px);
  out.count("height_px", seen.height_px);
  out.count("pixel_samples", seen.pixel_samples);
  out.objects("part", parts);
  return json_reply(out.finish());
}

}  // namespace irsig
