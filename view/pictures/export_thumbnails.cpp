#include "view/pictures/export_thumbnails.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <sstream>
#include <utility>

#include "absl/strings/str_join.h"
#include "core/accuracy/image_layers.h"
#include "core/base/printable.h"
#include "core/base/sobol.h"
#include "core/base/status_macros.h"
#include "core/image/image.h"
#include "schema/store/check_picture.h"
#include "view/base/atomic_file.h"
#include "view/base/progress.h"
#include "view/base/table.h"
#include "view/pictures/export_journal.h"
#include "view/pictures/image_labels.h"
#include "view/pictures/masks.h"
#include "view/pictures/picture_scale.h"
#include "view/pictures/recorded_image.h"
#include "view/pictures/shown_image.h"

namespace irsig {
namespace {

namespace fs = std::filesystem;

// Images between two entries of the journal: what is written again after an end in between. Images
// of 128 pixels: 1000 of 40 kB, with silhouettes 70 MB, and as many that are read meanwhile. Of
// larger ones fewer.
constexpr std::size_t kAtOnce = 1000;
constexpr std::size_t kPixelsAtOnce = kAtOnce * 128 * 128;

constexpr std::uint64_t kFnvBasis = 14695981039346656037u;

std::uint64_t fnv1a(std::string_view bytes, std::uint64_t hash = kFnvBasis) {
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211u;
  return hash;
}

double hottest_of(const RadianceImage& image) {
  return static_cast<double>(
      *std::max_element(image.radiance_w_m2_sr.begin(), image.radiance_w_m2_sr.end()));
}

std::string json_number(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

class ThumbnailFolder {
 public:
  ThumbnailFolder(StoreReader& reader, const ThumbnailsAsked& asked, PictureScale scale,
                  std::string folder, const ReadPictures& read)
      : reader_(reader),
        asked_(asked),
        scale_(scale),
        folder_(std::move(folder)),
        partial_(folder_ + ".partial"),
        read_(read),
        shown_{asked.layer, asked.background} {}

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
    return std::clamp<std::size_t>(kPixelsAtOnce / (longest * longest), 1, kAtOnce);
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
  //   silhouettes  whether they are read, too
  absl::StatusOr<std::vector<RowImage>> images(std::size_t from, std::size_t to, bool silhouettes) {
    ASSIGN_OR_RETURN(auto rows, reader_.read({ids_.data() + from, to - from}));
    const std::string wanted = shown_.wanted_layer();
    std::vector<RowImage> out;
    for (StoredSignature& s : rows) {
      ASSIGN_OR_RETURN(auto thumbnail, reader_.thumbnail(s.signature_id));
      if (!thumbnail.has_value()) continue;
      RowImage& image = out.emplace_back();
      image.thumbnail = *std::move(thumbnail);
      if (silhouettes) {
        auto silhouette = reader_.silhouette(s.signature_id);
        if (silhouette.ok() && !silhouette->has_value())
          silhouette = absl::DataLossError("it has no silhouette");
        if (!silhouette.ok()) {
          if (!absl::IsDataLoss(silhouette.status())) return silhouette.status();
          return damaged(s, std::string(silhouette.status().message()));
        }
        image.silhouette = **std::move(silhouette);
      }
      if (asked_.exr) {
        ASSIGN_OR_RETURN(image.layers, reader_.image_layers(s.signature_id));
      } else if (!wanted.empty()) {
        ASSIGN_OR_RETURN(auto layer, reader_.image_layer(s.signature_id, wanted));
        if (layer) image.layers.push_back(*std::move(layer));
      }
      image.signature = std::move(s);
    }
    return out;
  }

  [[nodiscard]] std::uint32_t most_px(const StoredSignature& s) const {
    const auto of_sweep = most_px_.find(s.sweep);
    return s.superseded || of_sweep == most_px_.end() ? kMostPixels : of_sweep->second;
  }

  // What the pictures of the images show.
  absl::StatusOr<std::vector<ShownImage>> shown(const std::vector<RowImage>& some) {
    std::vector<ShownImage> out;
    for (const RowImage& image : some) {
      auto one = shown_image(image, shown_, most_px(image.signature));
      if (!one.ok()) return never(one.status());
      out.push_back(*std::move(one));
    }
    return out;
  }

  absl::Status damaged(const StoredSignature& s, const std::string& how) {
    return never(absl::DataLossError(
        fmt::format("the stored image of row {}{} ({}.png) is damaged: {}", s.row,
                    place_.size() > 1 ? " of sweep " + s.sweep : "", name_of(s), how)));
  }
  absl::Status damaged(const StoredSignature& s, const absl::Status& why) {
    return damaged(s, std::string(why.message()));
  }

  // Calls work(images, the first row behind them) for all rows from `begin` on. While it works, the
  // next images are read: it must not use the reader before it has called the function that it is
  // given, which waits for them.
  using Wait = std::function<void()>;
  absl::Status visit_rows(
      std::size_t begin, bool silhouettes,
      const std::function<absl::Status(std::vector<RowImage>&, std::size_t, const Wait&)>& work) {
    const auto end_of = [&](std::size_t from) { return std::min(ids_.size(), from + at_once()); };
    const auto read_from = [&](std::size_t from) {
      return std::async(std::launch::async,
                        [=, this] { return images(from, end_of(from), silhouettes); });
    };
    auto next = read_from(begin);
    for (std::size_t from = begin; from < ids_.size(); from = end_of(from)) {
      ASSIGN_OR_RETURN(auto some, next.get());
      next = read_from(end_of(from));
      RETURN_IF_ERROR(work(some, end_of(from), [&] { next.wait(); }));
    }
    return absl::OkStatus();
  }

  // Of all rows, before the first is painted.
  absl::Status find_scale() {
    if (asked_.imager || scale_.kind != PictureScale::Kind::kCommon) return absl::OkStatus();
    LoopProgress progress("images compared", ids_.size());
    progress.step(journal_.seen);
    return visit_rows(
        journal_.seen, asked_.background,
        [&](std::vector<RowImage>& some, std::size_t to, const Wait&) -> absl::Status {
          ASSIGN_OR_RETURN(const auto pictures, shown(some));
          std::vector<double> hottest(some.size());
          RETURN_IF_ERROR(
              visit_images(pictures, read_,
                           [&](std::size_t i, absl::StatusOr<RadianceImage> image) -> absl::Status {
                             if (!image.ok()) return damaged(some[i].signature, image.status());
                             hottest[i] = hottest_of(*image);
                             return absl::OkStatus();
                           }));
          for (std::size_t i = 0; i < some.size(); ++i) {
            double& all = journal_.hottest[{some[i].signature.sweep, some[i].signature.band}];
            all = std::max(all, hottest[i]);
          }
          progress.step(to - journal_.seen);
          journal_.seen = to;
          return replace_file(journal_path(), journal_.text());
        });
  }

  [[nodiscard]] std::string name_of(const StoredSignature& s) const {
    return place_.size() > 1 ? fmt::format("images/{}-{:07}", place_.at(s.sweep) + 1, s.row)
                             : fmt::format("images/{:07}", s.row);
  }

  absl::Status paint_all() {
    LoopProgress progress("images written", ids_.size());
    progress.step(journal_.painted);
    return visit_rows(
        journal_.painted, true,
        [&](std::vector<RowImage>& some, std::size_t to, const Wait& wait) -> absl::Status {
          RETURN_IF_ERROR(paint_some(some, wait));
          progress.step(to - journal_.painted);
          journal_.painted = to;
          journal_.images += some.size();
          return replace_file(journal_path(), journal_.text());
        });
  }

  // What is known of a picture besides its row and its silhouette.
  struct Facts {
    double black_w_m2_sr = 0, white_w_m2_sr = 0;
    ImagerInBand figures{};
    std::uint64_t saturated_px = 0;
    ImageContent target{};  // pixels that show any of it
  };

  absl::Status paint_some(std::vector<RowImage>& some, const Wait& wait) {
    ASSIGN_OR_RETURN(const auto pictures, shown(some));
    std::vector<Facts> facts(some.size());
    RETURN_IF_ERROR(asked_.imager ? find_figures(some, facts) : find_ends(some, facts));
    RETURN_IF_ERROR(
        visit_images(pictures, read_, [&](std::size_t i, absl::StatusOr<RadianceImage> image) {
          return image.ok() ? write_picture(some[i], *std::move(image), facts[i])
                            : damaged(some[i].signature, image.status());
        }));
    if (asked_.coco) RETURN_IF_ERROR(write_objects(some));
    wait();
    std::ostringstream lines;
    RETURN_IF_ERROR(write_labels(some, facts, lines));
    // Every table has its heading; the file has the first's.
    const std::string table = lines.str();
    return append(kLabels,
                  journal_.bytes[kLabels] == 0 ? table : table.substr(table.find('\n') + 1));
  }

  // Black and white of each picture, as far as other pictures state them.
  absl::Status find_ends(const std::vector<RowImage>& some, std::vector<Facts>& facts) {
    for (std::size_t i = 0; i < some.size(); ++i) {
      const StoredSignature& s = some[i].signature;
      const double white = scale_.kind == PictureScale::Kind::kCommon
                               ? journal_.hottest[{s.sweep, s.band}]
                               : scale_.white_w_m2_sr;
      // As float32, in which the picture is painted.
      facts[i].black_w_m2_sr = static_cast<double>(static_cast<float>(scale_.black_w_m2_sr));
      facts[i].white_w_m2_sr = static_cast<double>(static_cast<float>(white));
    }
    return absl::OkStatus();
  }

  // The files of one image. Several threads call it, each for an image of its own.
  absl::Status write_picture(RowImage& image, RadianceImage radiance, Facts& facts) {
    const StoredSignature& s = image.signature;
    if (radiance.width_px != image.silhouette.width_px ||
        radiance.height_px != image.silhouette.height_px)
      return damaged(s, "its silhouette is of another size");
    const std::string name = partial_ + "/" + name_of(s);
    if (asked_.exr) {
      RETURN_IF_ERROR(plain_file(name + ".exr", image.thumbnail.exr()));
      RETURN_IF_ERROR(plain_file(name + ".stderr.exr", image.thumbnail.stderr_exr()));
      if (!image.layers.empty()) RETURN_IF_ERROR(write_layers(image));
    }
    if (asked_.imager) {
      RETURN_IF_ERROR(write_counts(image, std::move(radiance), facts));
    } else {
      if (scale_.kind == PictureScale::Kind::kOwn) facts.white_w_m2_sr = hottest_of(radiance);
      const auto png = encode_png(
          radiance,
          {static_cast<float>(facts.black_w_m2_sr), static_cast<float>(facts.white_w_m2_sr)},
          asked_.bits);
      if (!png.ok()) return damaged(s, png.status());
      RETURN_IF_ERROR(plain_file(name + ".png", *png));
    }
    facts.target = covered_pixels(image.silhouette);
    return asked_.masks ? write_mask(image) : absl::OkStatus();
  }

  // All layers of an image in one file, and the standard errors of at_sensor.
  absl::Status write_layers(const RowImage& image) {
    const StoredSignature& s = image.signature;
    std::map<std::string, std::vector<float>> layers;
    const auto add = [&](const std::string& name, const std::string& exr) -> absl::Status {
      const ShownImage layer{exr, most_px(s)};
      return visit_images({&layer, 1}, read_,
                          [&](std::size_t, absl::StatusOr<RadianceImage> read) -> absl::Status {
                            if (!read.ok()) return damaged(s, read.status());
                            layers[name] = std::move(read->radiance_w_m2_sr);
                            return absl::OkStatus();
                          });
    };
    for (const schema::ImageLayer& layer : image.layers) {
      if (!image_layer_of(layer.name())) return damaged(s, "a layer has no known name");
      RETURN_IF_ERROR(add(layer.name(), layer.exr()));
      if (!layer.stderr_exr().empty())
        RETURN_IF_ERROR(add(layer.name() + "_stderr", layer.stderr_exr()));
    }
    const auto exr =
        encode_layers_exr(image.thumbnail.width_px(), image.thumbnail.height_px(), layers);
    if (!exr.ok()) return damaged(s, exr.status());
    return plain_file(partial_ + "/" + name_of(s) + ".layers.exr", *exr);
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

  // Figures of the imager for each image.
  absl::Status find_figures(const std::vector<RowImage>& some, std::vector<Facts>& facts) {
    for (std::size_t i = 0; i < some.size(); ++i) {
      ASSIGN_OR_RETURN(facts[i].figures, figures_of(some[i].signature));
    }
    // The image that needs the most stored pixels is checked first: its remedy serves all.
    const auto needed = [](const RowImage& image) {
      const schema::Thumbnail& t = image.thumbnail;
      return t.pixel_rad() * std::max(t.width_px(), t.height_px());
    };
    const auto coarsest = std::max_element(
        some.begin(), some.end(),
        [&](const RowImage& x, const RowImage& y) { return needed(x) < needed(y); });
    if (coarsest == some.end()) return absl::OkStatus();
    const schema::Thumbnail& t = coarsest->thumbnail;
    const auto grid = detector_grid(*asked_.imager, t.width_px(), t.height_px(), t.pixel_rad());
    return grid.ok() ? absl::OkStatus() : never(not_recorded(coarsest->signature, grid.status()));
  }

  // The picture as the imager records it: the silhouette becomes that of its pixels.
  absl::Status write_counts(RowImage& image, RadianceImage seen, Facts& facts) {
    const StoredSignature& s = image.signature;
    auto one = record_image(*asked_.imager, facts.figures, s, std::move(seen),
                            image.thumbnail.pixel_rad(), image.silhouette,
                            image.layer(irsig::name_of(ImageLayer::kAtSensor)) != nullptr);
    if (absl::IsInvalidArgument(one.status())) return never(not_recorded(s, one.status()));
    if (!one.ok()) return not_recorded(s, one.status());
    facts.saturated_px = one->saturated_px;
    image.silhouette = std::move(one->silhouette);
    image.thumbnail.set_width_px(image.silhouette.width_px);
    image.thumbnail.set_height_px(image.silhouette.height_px);
    image.thumbnail.set_pixel_rad(asked_.imager->ifov_rad());
    const std::string name = partial_ + "/" + name_of(s);
    RETURN_IF_ERROR(plain_file(name + ".png", one->png));
    return asked_.exr ? plain_file(name + ".noiseless.exr", one->noiseless_exr) : absl::OkStatus();
  }

  absl::Status write_mask(const RowImage& image) {
    const std::vector<std::uint16_t> mask = part_mask(image.silhouette, parts_);
    if (*std::max_element(mask.begin(), mask.end()) > parts_.size())
      return never(absl::FailedPreconditionError(
          fmt::format("row {} is of an earlier version of its sweep, with other parts: run the "
                      "sweep again",
                      image.signature.row)));
    ASSIGN_OR_RETURN(
        const auto png,
        encode_grey_png(image.silhouette.width_px, image.silhouette.height_px, mask, mask_bits()));
    return plain_file(partial_ + "/" + mask_of(image.signature), png);
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

  absl::Status write_objects(const std::vector<RowImage>& some) {
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
        const auto object = seen_object(
            some[i].silhouette, [&](const std::string& part) { return classes[c].has(part); });
        if (!object) continue;
        lines[validation ? kValidationObjects : kTrainObjects] +=
            coco_entry(++journal_.annotations, image, c + 1, *object) + "\n";
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

  absl::Status write_labels(const std::vector<RowImage>& some, const std::vector<Facts>& facts,
                            std::ostream& out) {
    std::vector<ImageLabel> labels;
    for (std::size_t i = 0; i < some.size(); ++i) {
      const StoredSignature& s = some[i].signature;
      ImageLabel& label = labels.emplace_back(
          ImageLabel{name_of(s) + ".png", mask_of(s), is_for_validation(s) ? "validation" : "train",
                     s, facts[i].target, some[i].thumbnail.width_px(),
                     some[i].thumbnail.height_px(), some[i].thumbnail.pixel_rad()});
      if (asked_.imager) {
        const ImagerInBand& figures = facts[i].figures;
        label.counts = {asked_.imager_name, figures.counts_per_w_m2_sr, figures.offset_counts,
                        figures.noise_w_m2_sr, facts[i].saturated_px};
      } else {
        label.scale = {facts[i].black_w_m2_sr, facts[i].white_w_m2_sr};
      }
    }
    return irsig::write_labels(
        reader_, {asked_.masks, asked_.validation > 0, asked_.imager.has_value(), parts_}, labels,
        out);
  }

  StoreReader& reader_;
  const ThumbnailsAsked& asked_;
  const PictureScale scale_;
  const std::string folder_, partial_;
  const ReadPictures& read_;
  const ShownAsked shown_;
  std::vector<std::int64_t> ids_;
  std::vector<std::string> parts_;
  std::map<std::string, std::size_t> place_;      // of sweeps
  std::map<std::string, std::uint32_t> most_px_;  // of their images
  std::map<SweepBand, Band> band_;
  Journal journal_;
  std::atomic<bool> never_ = false;  // whether going on would end where this call does
};

}  // namespace

absl::StatusOr<std::uint64_t> export_thumbnails(StoreReader& reader, const ThumbnailsAsked& asked,
                                                const std::string& folder,
                                                const ReadPictures& read) {
  if (asked.query.interpolate)
    return absl::InvalidArgumentError("thumbnails: images are not interpolated, use nearest");
  if (!asked.query.range_m.empty())
    return absl::InvalidArgumentError("thumbnails: images are of the stored range alone");
  ASSIGN_OR_RETURN(const auto scale, parse_picture_scale(asked.scale));
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
