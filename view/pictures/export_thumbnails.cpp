#include "view/pictures/export_thumbnails.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "core/accuracy/image_layers.h"
#include "core/base/printable.h"
#include "core/base/sobol.h"
#include "core/base/status_macros.h"
#include "core/image/image.h"
#include "schema/store/check_picture.h"
#include "view/base/atomic_file.h"
#include "view/base/on_all_cores.h"
#include "view/base/progress.h"
#include "view/base/table.h"
#include "view/pictures/export_journal.h"
#include "view/pictures/image_labels.h"
#include "view/pictures/masks.h"
#include "view/pictures/recorded_image.h"

namespace irsig {
namespace {

namespace fs = std::filesystem;

// As many as one call of the painter gets: what is computed again after an end in between. Images
// of 128 pixels: 2000 of 20 kB, with silhouettes 100 MB. Of larger ones fewer.
constexpr std::size_t kAtOnce = 2000;
constexpr std::size_t kPixelsAtOnce = kAtOnce * 128 * 128;

struct Scale {
  enum class Kind { kCommon, kOwn, kStated } kind = Kind::kCommon;
  double black_w_m2_sr = 0, white_w_m2_sr = 0;
};

absl::StatusOr<Scale> parse_scale(const std::string& text) {
  if (text == "common") return Scale{};
  if (text == "own") return Scale{Scale::Kind::kOwn};
  const std::vector<std::string> ends = absl::StrSplit(text, ',');
  Scale out{Scale::Kind::kStated};
  if (ends.size() == 2 && absl::SimpleAtod(ends[0], &out.black_w_m2_sr) &&
      absl::SimpleAtod(ends[1], &out.white_w_m2_sr) && out.black_w_m2_sr < out.white_w_m2_sr &&
      std::isfinite(out.black_w_m2_sr) && std::isfinite(out.white_w_m2_sr))
    return out;
  return absl::InvalidArgumentError(fmt::format(
      "thumbnail scale {}: expected common, own, or BLACK,WHITE in W/(m2 sr) as 0,12.5", text));
}

struct Image {
  StoredSignature signature;
  schema::Thumbnail thumbnail;
  StoredSilhouette silhouette;
  std::vector<schema::ImageLayer> layers;  // where they are exported

  [[nodiscard]] const schema::ImageLayer* layer(std::string_view name) const {
    for (const schema::ImageLayer& one : layers)
      if (one.name() == name) return &one;
    return nullptr;
  }
};

constexpr std::uint64_t kFnvBasis = 14695981039346656037u;

std::uint64_t fnv1a(std::string_view bytes, std::uint64_t hash = kFnvBasis) {
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211u;
  return hash;
}

std::string json_number(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

class ThumbnailFolder {
 public:
  ThumbnailFolder(StoreReader& reader, const ThumbnailsAsked& asked, Scale scale,
                  std::string folder, const ReadPictures& read)
      : reader_(reader),
        asked_(asked),
        scale_(scale),
        folder_(std::move(folder)),
        partial_(folder_ + ".partial"),
        read_(read) {}

  absl::StatusOr<std::uint64_t> write() {
    ASSIGN_OR_RETURN(const auto filter, filter_of(asked_.query));
    ASSIGN_OR_RETURN(auto ids, reader_.find_ids(filter));
    if (ids.empty()) {
      RETURN_IF_ERROR(explain_nothing(reader_, filter));
      return absl::NotFoundError("nothing to export: no signature matches the filters");
    }
    ids_ = std::move(ids);
    RETURN_IF_ERROR(find_parts());
    ASSIGN_OR_RETURN(const auto lock, begin());
    absl::Status done = find_scale();
    if (done.ok()) done = paint_all();
    if (!done.ok()) {
      if (never_) remove_partial();
      return done;
    }
    std::error_code error;
    if (journal_.images == 0) {
      remove_partial();
      return absl::NotFoundError(
          "none of the signatures was computed with an image (output.thumbnail_px = 0)");
    }
    RETURN_IF_ERROR(finish_labels());
    // An end from here on leaves what the next call makes anew.
    fs::remove(journal_path(), error);
    for (std::size_t file = kTrainImages; file < kGrowing.size(); ++file)
      fs::remove(path_of(static_cast<Growing>(file)), error);
    fs::rename(partial_, folder_, error);
    if (error) return cannot_make(folder_, error);
    return journal_.images;
  }

 private:
  [[nodiscard]] std::string journal_path() const { return partial_ + "/progress"; }
  [[nodiscard]] std::string path_of(Growing file) const { return partial_ + "/" + kGrowing[file]; }

  // Of a row whose picture cannot be: the same call would end there again, and another is refused.
  absl::Status never(absl::Status why) {
    never_ = true;
    return why;
  }

  // What this wrote; a folder that holds more stays.
  void remove_partial() const {
    std::error_code error;
    remove_content();
    for (const std::string& path : {journal_path(), partial_}) fs::remove(path, error);
  }
  void remove_content() const {
    std::error_code error;
    for (const char* folder : {"/images", "/masks"}) fs::remove_all(partial_ + folder, error);
    for (const char* file : kGrowing) fs::remove(partial_ + "/" + file, error);
    for (const char* file : {"/parts.csv", "/annotations.json", "/train.json", "/validation.json"})
      fs::remove(partial_ + file, error);
  }

  [[nodiscard]] std::size_t at_once() const {
    std::size_t longest = 1;
    for (const auto& [sweep, px] : most_px_) longest = std::max<std::size_t>(longest, px);
    // Radiances of all pixels are here at once, for an imager, in place of their PNG.
    const std::size_t fewer = asked_.imager ? 8 : 1;
    return std::clamp<std::size_t>(kPixelsAtOnce / fewer / (longest * longest), 1, kAtOnce / fewer);
  }

  // In the order of sweeps and of their lists.
  absl::Status find_parts() {
    ASSIGN_OR_RETURN(const auto sweeps, reader_.contents());
    for (const SweepContents& of : sweeps) {
      if (!asked_.query.sweep.empty() && of.name != asked_.query.sweep) continue;
      ASSIGN_OR_RETURN(const auto sweep, reader_.sweep(of.name));
      for (const schema::Part& part : sweep.resolved.sweep().part())
        if (std::find(parts_.begin(), parts_.end(), part.name()) == parts_.end())
          parts_.push_back(part.name());
      place_[of.name] = place_.size();
      most_px_[of.name] = most_px_of(sweep.resolved.sweep());
      for (const schema::Band& b : sweep.resolved.sweep().band()) {
        Band& band = band_[{of.name, b.name()}];
        band = {b.name(), b.lambda_min_um(), b.lambda_max_um(), b.step_um(), {}};
        for (const schema::SpectralPoint& point : b.response())
          band.response.push_back({point.lambda_um(), point.value()});
      }
    }
    return absl::OkStatus();
  }

  absl::Status make_folders() const {
    std::error_code error;
    for (const std::string& folder : {partial_ + "/images", partial_ + "/masks"}) {
      if (folder.ends_with("/masks") && !asked_.masks) continue;
      fs::create_directory(folder, error);
      if (error) return cannot_make(folder, error);
    }
    return absl::OkStatus();
  }

  // Anew, or where an earlier call ended.
  absl::StatusOr<std::unique_ptr<FolderLock>> begin() {
    std::error_code error;
    if (fs::exists(fs::symlink_status(folder_, error)))
      return absl::InvalidArgumentError(
          fmt::format("{}: exists already, expected the name of a new folder", folder_));
    fs::create_directory(partial_, error);
    if (error) return cannot_make(partial_, error);
    auto lock = FolderLock::take(partial_);
    if (!lock.ok()) return lock;
    ASSIGN_OR_RETURN(const auto progress, reader_.progress());
    std::uint64_t hash = kFnvBasis;
    for (const std::int64_t id : ids_) hash = fnv1a(std::to_string(id) + " ", hash);
    for (const SweepProgress& p : progress) hash = fnv1a(p.sweep_sha256, hash);
    journal_.asked = fmt::format(
        "{} scale {} of {} bits{}{}{}{}{} validation {} by {}, {} rows {:016x}", asked_.said,
        asked_.scale, asked_.bits, asked_.exr ? " exr" : "", asked_.masks ? " masks" : "",
        asked_.coco ? " coco" : "", asked_.each_part ? " each part" : "",
        asked_.background      ? " background"
        : asked_.layer.empty() ? std::string()
                               : " layer " + asked_.layer,
        asked_.validation, asked_.split_seed, ids_.size(), hash);
    if (asked_.imager)
      journal_.asked += fmt::format(" imager {:016x}", fnv1a(asked_.imager_identity));
    for (const CocoCategory& c : asked_.categories)
      journal_.asked +=
          fmt::format(" {}={}", printable(c.name), printable(absl::StrJoin(c.pattern, ",")));
    if (!fs::exists(journal_path(), error)) {
      remove_content();
      RETURN_IF_ERROR(make_folders());
      RETURN_IF_ERROR(replace_file(journal_path(), journal_.text()));
      return lock;
    }
    auto earlier = Journal::read(journal_path());
    if (!earlier || earlier->asked != journal_.asked)
      return absl::InvalidArgumentError(fmt::format(
          "{} is of another export: expected the same question again, or that it is removed",
          partial_));
    journal_ = *std::move(earlier);
    RETURN_IF_ERROR(journal_.cut_back(partial_));
    return lock;
  }

  // Rows from..to that have an image.
  absl::StatusOr<std::vector<Image>> images(std::size_t from, std::size_t to) {
    ASSIGN_OR_RETURN(auto rows, reader_.read({ids_.data() + from, to - from}));
    std::vector<Image> out;
    for (StoredSignature& s : rows) {
      ASSIGN_OR_RETURN(auto thumbnail, reader_.thumbnail(s.signature_id));
      if (!thumbnail.has_value()) continue;
      auto silhouette = reader_.silhouette(s.signature_id);
      if (silhouette.ok() && !silhouette->has_value())
        silhouette = absl::DataLossError("it has no silhouette");
      if (!silhouette.ok()) {
        if (!absl::IsDataLoss(silhouette.status())) return silhouette.status();
        return damaged(s, std::string(silhouette.status().message()));
      }
      std::vector<schema::ImageLayer> layers;
      if (asked_.exr || asked_.background || !asked_.layer.empty()) {
        ASSIGN_OR_RETURN(layers, reader_.image_layers(s.signature_id));
      }
      out.push_back(
          {std::move(s), *std::move(thumbnail), **std::move(silhouette), std::move(layers)});
    }
    return out;
  }

  absl::StatusOr<PictureTask> picture(const Image& image) {
    const StoredSignature& s = image.signature;
    const auto most_px = most_px_.find(s.sweep);
    PictureTask out{
        .exr = image.thumbnail.exr(),
        .most_px = s.superseded || most_px == most_px_.end() ? kMostPixels : most_px->second};
    // A sensor's own picture has the horizon and what lies behind edges.
    const std::string shown = !asked_.layer.empty() ? asked_.layer
                              : asked_.background
                                  ? std::string(irsig::name_of(ImageLayer::kAtSensor))
                                  : std::string();
    if (const schema::ImageLayer* layer = image.layer(shown)) {
      out.exr = layer->exr();
      return out;
    }
    if (!asked_.layer.empty())
      return never(absl::NotFoundError(fmt::format(
          "the image of row {} has no layer {}: its sweep asks for none with [image] layers", s.row,
          asked_.layer)));
    if (!asked_.background) return out;
    if (std::isnan(s.background_radiance_w_m2_sr) || std::isnan(s.path_radiance_w_m2_sr))
      return never(absl::FailedPreconditionError(fmt::format(
          "row {} was computed without contrast, background and path: run the sweep again",
          s.row)));
    if (!std::isnan(s.plume_w_sr))
      return never(absl::InvalidArgumentError(
          fmt::format("row {} has hot gas, which lets part of the background through: its picture "
                      "cannot be put before it",
                      s.row)));
    // So that the target's pixels add up to its apparent intensity.
    const double arrives_w_sr =
        s.apparent_intensity_w_sr - s.projected_area_m2 * s.path_radiance_w_m2_sr;
    out.seen = PictureTask::Seen{
        s.intensity_w_sr != 0 ? arrives_w_sr / s.intensity_w_sr : s.path_transmittance,
        s.path_radiance_w_m2_sr, s.background_radiance_w_m2_sr, filled_fractions(image.silhouette)};
    return out;
  }

  // Of the images' rows.
  absl::StatusOr<std::vector<PictureAnswer>> painted(const std::vector<Image>& images,
                                                     const std::vector<PictureTask>& pictures) {
    ASSIGN_OR_RETURN(auto facts, read_(pictures));
    if (facts.size() != pictures.size())
      return absl::InternalError(
          fmt::format("{} of {} images were painted", facts.size(), pictures.size()));
    for (std::size_t i = 0; i < images.size(); ++i) {
      if (!facts[i].damage.empty()) return damaged(images[i].signature, facts[i].damage);
      const StoredSilhouette& silhouette = images[i].silhouette;
      if (facts[i].width_px != silhouette.width_px || facts[i].height_px != silhouette.height_px)
        return damaged(images[i].signature, "its silhouette is of another size");
    }
    return facts;
  }

  absl::Status damaged(const StoredSignature& s, const std::string& how) {
    return never(absl::DataLossError(
        fmt::format("the stored image of row {}{} ({}.png) is damaged: {}", s.row,
                    place_.size() > 1 ? " of sweep " + s.sweep : "", name_of(s), how)));
  }

  // Of all rows, before the first is painted.
  absl::Status find_scale() {
    if (asked_.imager || scale_.kind != Scale::Kind::kCommon) return absl::OkStatus();
    LoopProgress progress("images compared", ids_.size());
    progress.step(journal_.seen);
    while (journal_.seen < ids_.size()) {
      const std::size_t to = std::min(ids_.size(), journal_.seen + at_once());
      ASSIGN_OR_RETURN(auto some, images(journal_.seen, to));
      std::vector<PictureTask> pictures;
      for (const Image& image : some) {
        ASSIGN_OR_RETURN(auto one, picture(image));
        pictures.push_back(std::move(one));
      }
      ASSIGN_OR_RETURN(const auto facts, painted(some, pictures));
      for (std::size_t i = 0; i < some.size(); ++i) {
        const StoredSignature& s = some[i].signature;
        double& hottest = journal_.hottest[{s.sweep, s.band}];
        hottest = std::max(hottest, static_cast<double>(facts[i].hottest_w_m2_sr));
      }
      progress.step(to - journal_.seen);
      journal_.seen = to;
      RETURN_IF_ERROR(replace_file(journal_path(), journal_.text()));
    }
    return absl::OkStatus();
  }

  [[nodiscard]] std::string name_of(const StoredSignature& s) const {
    return place_.size() > 1 ? fmt::format("images/{}-{:07}", place_.at(s.sweep) + 1, s.row)
                             : fmt::format("images/{:07}", s.row);
  }

  absl::Status paint_all() {
    LoopProgress progress("images written", ids_.size());
    progress.step(journal_.painted);
    while (journal_.painted < ids_.size()) {
      const std::size_t to = std::min(ids_.size(), journal_.painted + at_once());
      ASSIGN_OR_RETURN(auto some, images(journal_.painted, to));
      RETURN_IF_ERROR(paint_some(some));
      progress.step(to - journal_.painted);
      journal_.painted = to;
      journal_.images += some.size();
      RETURN_IF_ERROR(replace_file(journal_path(), journal_.text()));
    }
    return absl::OkStatus();
  }

  absl::Status paint_some(std::vector<Image>& some) {
    std::vector<PictureTask> pictures;
    for (const Image& image : some) {
      ASSIGN_OR_RETURN(auto one, picture(image));
      const StoredSignature& s = image.signature;
      if (asked_.exr) {
        RETURN_IF_ERROR(plain_file(partial_ + "/" + name_of(s) + ".exr", image.thumbnail.exr()));
        RETURN_IF_ERROR(
            plain_file(partial_ + "/" + name_of(s) + ".stderr.exr", image.thumbnail.stderr_exr()));
      }
      if (asked_.exr && !image.layers.empty()) RETURN_IF_ERROR(write_layers(image, one.most_px));
      one.black_w_m2_sr = static_cast<float>(scale_.black_w_m2_sr);
      one.white_w_m2_sr = static_cast<float>(scale_.kind == Scale::Kind::kCommon
                                                 ? journal_.hottest[{s.sweep, s.band}]
                                                 : scale_.white_w_m2_sr);
      pictures.push_back(std::move(one));
    }
    if (!asked_.imager && scale_.kind == Scale::Kind::kOwn) {
      ASSIGN_OR_RETURN(const auto facts, painted(some, pictures));
      for (std::size_t i = 0; i < pictures.size(); ++i)
        pictures[i].white_w_m2_sr = facts[i].hottest_w_m2_sr;
    }
    for (PictureTask& picture : pictures) {
      picture.paint = !asked_.imager;
      picture.pixels = !picture.paint;
      picture.bits = asked_.bits;
    }
    ASSIGN_OR_RETURN(auto facts, painted(some, pictures));
    std::vector<RecordedImage> recorded;
    if (asked_.imager) {
      ASSIGN_OR_RETURN(recorded, record(some, facts));
    }
    for (std::size_t i = 0; i < some.size(); ++i)
      RETURN_IF_ERROR(
          plain_file(partial_ + "/" + name_of(some[i].signature) + ".png", facts[i].png));
    if (asked_.masks) RETURN_IF_ERROR(write_masks(some));
    if (asked_.coco) RETURN_IF_ERROR(write_objects(some));
    std::ostringstream lines;
    RETURN_IF_ERROR(write_labels(some, pictures, recorded, lines));
    // Every table has its heading; the file has the first's.
    const std::string table = lines.str();
    return append(kLabels,
                  journal_.bytes[kLabels] == 0 ? table : table.substr(table.find('\n') + 1));
  }

  // All layers of an image in one file, and the standard errors of at_sensor.
  absl::Status write_layers(const Image& image, std::uint32_t most_px) {
    std::vector<PictureTask> tasks;
    std::vector<std::string> names;
    const auto add = [&](std::string name, const std::string& exr) {
      names.push_back(std::move(name));
      tasks.push_back({.exr = exr, .most_px = most_px, .pixels = true});
    };
    for (const schema::ImageLayer& layer : image.layers) {
      if (!image_layer_of(layer.name()))
        return damaged(image.signature, "a layer has no known name");
      add(layer.name(), layer.exr());
      if (!layer.stderr_exr().empty()) add(layer.name() + "_stderr", layer.stderr_exr());
    }
    ASSIGN_OR_RETURN(auto answers, read_(tasks));
    std::map<std::string, std::vector<float>> layers;
    for (std::size_t i = 0; i < answers.size(); ++i) {
      if (!answers[i].damage.empty()) return damaged(image.signature, answers[i].damage);
      layers[names[i]] = std::move(answers[i].pixel);
    }
    const auto exr =
        encode_layers_exr(image.thumbnail.width_px(), image.thumbnail.height_px(), layers);
    if (!exr.ok()) return damaged(image.signature, std::string(exr.status().message()));
    return plain_file(partial_ + "/" + name_of(image.signature) + ".layers.exr", *exr);
  }

  // Figures of the imager in the band of a row.
  absl::StatusOr<ImagerInBand> figures_of(const StoredSignature& s) {
    const auto band = band_.find({s.sweep, s.band});
    if (band == band_.end() || band->second.lambda_min_um != s.lambda_min_um ||
        band->second.lambda_max_um != s.lambda_max_um)
      return never(absl::FailedPreconditionError(
          fmt::format("row {} is of an earlier version of its sweep, with another band: run the "
                      "sweep again",
                      s.row)));
    auto figures = imager_in_band(*asked_.imager, band->second);
    if (!figures.ok()) return never(figures.status());
    return *figures;
  }

  static absl::Status not_recorded(const StoredSignature& s, const absl::Status& why) {
    return {why.code(), fmt::format("the image of row {}: {}", s.row, std::string(why.message()))};
  }

  // Images as the imager records them: `some` and `facts` become those of its pixels.
  absl::StatusOr<std::vector<RecordedImage>> record(std::vector<Image>& some,
                                                    std::vector<PictureAnswer>& facts) {
    std::vector<ImagerInBand> figures;
    for (const Image& image : some) {
      ASSIGN_OR_RETURN(const auto one, figures_of(image.signature));
      figures.push_back(one);
    }
    // The image that needs the most stored pixels is checked first: its remedy serves all.
    const auto needed = [](const Image& image) {
      const schema::Thumbnail& t = image.thumbnail;
      return t.pixel_rad() * std::max(t.width_px(), t.height_px());
    };
    const auto coarsest =
        std::max_element(some.begin(), some.end(),
                         [&](const Image& x, const Image& y) { return needed(x) < needed(y); });
    if (coarsest != some.end()) {
      const schema::Thumbnail& t = coarsest->thumbnail;
      const auto grid = detector_grid(*asked_.imager, t.width_px(), t.height_px(), t.pixel_rad());
      if (!grid.ok()) return never(not_recorded(coarsest->signature, grid.status()));
    }
    std::vector<RecordedImage> out(some.size());
    const absl::Status done = on_all_cores(some.size(), [&](std::size_t i) -> absl::Status {
      Image& image = some[i];
      PictureAnswer& f = facts[i];
      const StoredSignature& s = image.signature;
      const RadianceImage seen{f.width_px, f.height_px, std::move(f.pixel)};
      auto one = record_image(*asked_.imager, figures[i], s, seen, image.thumbnail.pixel_rad(),
                              image.silhouette,
                              image.layer(irsig::name_of(ImageLayer::kAtSensor)) != nullptr);
      if (!one.ok()) return not_recorded(s, one.status());
      out[i] = *std::move(one);
      f.png = std::move(out[i].png);
      image.silhouette = std::move(out[i].silhouette);
      image.thumbnail.set_width_px(image.silhouette.width_px);
      image.thumbnail.set_height_px(image.silhouette.height_px);
      image.thumbnail.set_pixel_rad(asked_.imager->ifov_rad());
      return asked_.exr ? plain_file(partial_ + "/" + name_of(s) + ".noiseless.exr",
                                     std::exchange(out[i].noiseless_exr, {}))
                        : absl::OkStatus();
    });
    if (absl::IsInvalidArgument(done)) return never(done);
    if (!done.ok()) return done;
    return out;
  }

  absl::Status write_masks(const std::vector<Image>& some) {
    for (const Image& image : some) {
      const std::vector<std::uint16_t> mask = part_mask(image.silhouette, parts_);
      if (*std::max_element(mask.begin(), mask.end()) > parts_.size())
        return never(absl::FailedPreconditionError(
            fmt::format("row {} is of an earlier version of its sweep, with other parts: run the "
                        "sweep again",
                        image.signature.row)));
      ASSIGN_OR_RETURN(const auto png,
                       encode_grey_png(image.silhouette.width_px, image.silhouette.height_px, mask,
                                       mask_bits()));
      RETURN_IF_ERROR(plain_file(partial_ + "/" + mask_of(image.signature), png));
    }
    return absl::OkStatus();
  }
  [[nodiscard]] int mask_bits() const { return parts_.size() < 256 ? 8 : 16; }
  [[nodiscard]] std::string mask_of(const StoredSignature& s) const {
    return "masks" + name_of(s).substr(std::string_view("images").size()) + ".png";
  }

  [[nodiscard]] std::vector<CocoCategory> categories() const {
    if (!asked_.categories.empty()) return asked_.categories;
    if (!asked_.each_part) return {{"target", {"*"}}};
    std::vector<CocoCategory> out;
    for (const std::string& part : parts_) out.push_back({part, {}});
    return out;
  }

  // By the direction: all pictures from there, of any range, are on one side.
  [[nodiscard]] bool is_for_validation(const StoredSignature& s) const {
    std::uint64_t hash = mix64(asked_.split_seed);
    for (const double place : {s.aspect_azimuth_deg, s.aspect_elevation_deg})
      hash = mix64(hash ^ std::bit_cast<std::uint64_t>(place));
    return std::ldexp(static_cast<double>(hash), -64) < asked_.validation;
  }

  absl::Status write_objects(const std::vector<Image>& some) {
    const std::vector<CocoCategory> classes = categories();
    std::array<std::string, kGrowing.size()> lines;
    for (std::size_t i = 0; i < some.size(); ++i) {
      const StoredSignature& s = some[i].signature;
      const bool validation = is_for_validation(s);
      const CocoImage image{journal_.images + i + 1, name_of(s) + ".png",
                            some[i].thumbnail.width_px(), some[i].thumbnail.height_px()};
      const std::string more =
          fmt::format(R"("sweep": {}, "row": {}, "season": {}, "time_utc": {}, "band": {}, )"
                      R"("aspect_azimuth_deg": {}, "aspect_elevation_deg": {}, "range_m": {})",
                      json_string(s.sweep), s.row, json_string(s.season), json_string(s.time_utc),
                      json_string(s.band), json_number(s.aspect_azimuth_deg),
                      json_number(s.aspect_elevation_deg), json_number(s.range_m));
      lines[validation ? kValidationImages : kTrainImages] += coco_entry(image, more) + "\n";
      for (std::size_t c = 0; c < classes.size(); ++c) {
        const auto has = [&](const std::string& part) { return classes[c].has(part); };
        const auto object = seen_object(some[i].silhouette, has);
        if (!object) continue;
        lines[validation ? kValidationObjects : kTrainObjects] +=
            coco_entry(++journal_.annotations, image, c + 1, *object,
                       whole_object(some[i].silhouette, *object, has)) +
            "\n";
      }
    }
    for (std::size_t file = kTrainImages; file < kGrowing.size(); ++file)
      RETURN_IF_ERROR(append(static_cast<Growing>(file), lines[file]));
    return absl::OkStatus();
  }

  // What stands beside the pictures, once they are all there.
  absl::Status finish_labels() {
    if (asked_.masks) {
      std::ostringstream text;
      ASSIGN_OR_RETURN(auto table, make_table_writer("csv", {{"value"}, {"part"}}, text));
      for (std::size_t p = 0; p < parts_.size(); ++p) table->row({std::uint64_t{p + 1}, parts_[p]});
      RETURN_IF_ERROR(table->finish());
      RETURN_IF_ERROR(plain_file(partial_ + "/parts.csv", text.str()));
    }
    if (!asked_.coco) return absl::OkStatus();
    const bool divided = asked_.validation > 0;
    RETURN_IF_ERROR(write_coco(path_of(kTrainImages), path_of(kTrainObjects), categories(),
                               partial_ + (divided ? "/train.json" : "/annotations.json")));
    if (divided)
      RETURN_IF_ERROR(write_coco(path_of(kValidationImages), path_of(kValidationObjects),
                                 categories(), partial_ + "/validation.json"));
    return absl::OkStatus();
  }

  // In the folder that nobody reads yet.
  static absl::Status plain_file(const std::string& path, const std::string& bytes) {
    errno = 0;
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file << bytes;
    file.close();
    return file ? absl::OkStatus() : write_failure(path);
  }

  absl::Status append(Growing to, const std::string& lines) {
    errno = 0;
    std::ofstream file(path_of(to), std::ios::binary | std::ios::app);
    file << lines;
    file.close();
    if (!file) return write_failure(path_of(to));
    journal_.bytes[to] += lines.size();
    return absl::OkStatus();
  }

  absl::Status write_labels(const std::vector<Image>& some,
                            const std::vector<PictureTask>& pictures,
                            const std::vector<RecordedImage>& recorded, std::ostream& out) {
    std::vector<ImageLabel> labels;
    for (std::size_t i = 0; i < some.size(); ++i) {
      const StoredSignature& s = some[i].signature;
      ImageLabel& label = labels.emplace_back(
          ImageLabel{name_of(s) + ".png", mask_of(s), is_for_validation(s) ? "validation" : "train",
                     s, some[i].silhouette, some[i].thumbnail.pixel_rad()});
      if (asked_.imager) {
        const ImagerInBand& figures = recorded[i].figures;
        label.counts = {asked_.imager_name, figures.counts_per_w_m2_sr, figures.offset_counts,
                        figures.noise_w_m2_sr, recorded[i].saturated_px};
      } else {
        label.scale = {static_cast<double>(pictures[i].black_w_m2_sr),
                       static_cast<double>(pictures[i].white_w_m2_sr)};
      }
    }
    return irsig::write_labels(
        reader_, {asked_.masks, asked_.validation > 0, asked_.imager.has_value(), parts_}, labels,
        out);
  }

  StoreReader& reader_;
  const ThumbnailsAsked& asked_;
  const Scale scale_;
  const std::string folder_, partial_;
  const ReadPictures& read_;
  std::vector<std::int64_t> ids_;
  std::vector<std::string> parts_;
  std::map<std::string, std::size_t> place_;      // of sweeps
  std::map<std::string, std::uint32_t> most_px_;  // of their images
  std::map<SweepBand, Band> band_;
  Journal journal_;
  bool never_ = false;  // whether going on would end where this call does
};

}  // namespace

absl::StatusOr<std::uint64_t> export_thumbnails(StoreReader& reader, const ThumbnailsAsked& asked,
                                                const std::string& folder,
                                                const ReadPictures& read) {
  if (asked.query.interpolate)
    return absl::InvalidArgumentError("thumbnails: images are not interpolated, use nearest");
  if (!asked.query.range_m.empty())
    return absl::InvalidArgumentError("thumbnails: images are of the stored range alone");
  ASSIGN_OR_RETURN(const auto scale, parse_scale(asked.scale));
  if (asked.imager && !asked.background)
    return absl::InvalidArgumentError(
        "--imager: an imager records the radiance at the sensor, add --background");
  if (!(asked.validation >= 0 && asked.validation < 1))
    return absl::InvalidArgumentError("--validation: expected a fraction of at least 0, below 1");
  std::string path = folder;
  while (path.size() > 1 && path.ends_with('/')) path.pop_back();
  return ThumbnailFolder(reader, asked, scale, path, read).write();
}

}  // namespace irsig
