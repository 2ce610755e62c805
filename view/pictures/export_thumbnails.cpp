#include "view/pictures/export_thumbnails.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
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
#include <tuple>
#include <utility>

#include "absl/strings/str_join.h"
#include "core/base/printable.h"
#include "core/base/sobol.h"
#include "core/base/status_macros.h"
#include "view/base/atomic_file.h"
#include "view/base/on_all_cores.h"
#include "view/base/progress.h"
#include "view/base/table.h"
#include "view/pictures/export_journal.h"
#include "view/pictures/exported_sweeps.h"
#include "view/pictures/image_labels.h"
#include "view/pictures/masks.h"
#include "view/pictures/picture_files.h"
#include "view/pictures/picture_scale.h"
#include "view/pictures/shown_image.h"

namespace irsig {
namespace {

namespace fs = std::filesystem;

// Images between two entries of the journal: what is written again after an end in between. Images
// of 128 pixels: 128 of 40 kB, with silhouettes 9 MB, and as many that are read meanwhile. Of
// larger ones fewer.
constexpr std::size_t kAtOnce = 128;
constexpr std::size_t kPixelsAtOnce = kAtOnce * 128 * 128;

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
    ASSIGN_OR_RETURN(sweeps_, ExportedSweeps::read(reader_, asked_.query.sweep));
    ASSIGN_OR_RETURN(const auto lock, begin());
    absl::Status done = find_scale();
    if (done.ok()) done = paint_all();
    if (!done.ok()) {
      if (is_final(done)) remove_partial();
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

  // Removes the files that this export wrote; a folder that holds more stays.
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

  // At least the bands of a cube and one image more.
  [[nodiscard]] std::size_t at_once() const {
    const std::size_t longest = sweeps_.most_px();
    const std::size_t least = asked_.format == PictureFormat::kEnvi ? sweeps_.most_bands() + 1 : 1;
    return std::max(least, std::min(kAtOnce, kPixelsAtOnce / (longest * longest)));
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
    remove_left_beside(journal_path());
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
    if (asked_.format != PictureFormat::kPng)
      journal_.asked += fmt::format(" as {}", ending_of(asked_.format));
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

  // The images of some rows, and the first row behind them.
  struct Some {
    std::vector<RowImage> images;
    std::size_t end = 0;
  };

  // The bands of a cube are one after the other.
  static bool of_one_cube(const StoredSignature& a, const StoredSignature& b) {
    const auto view = [](const StoredSignature& s) {
      return std::tie(s.sweep, s.season, s.time_utc, s.aspect_azimuth_deg, s.aspect_elevation_deg,
                      s.range_m);
    };
    return view(a) == view(b);
  }

  // Returns rows from `from` on that have an image; no cube is cut.
  //   silhouettes  whether they are read, too
  absl::StatusOr<Some> images(std::size_t from, bool silhouettes) {
    std::size_t to = std::min(ids_.size(), from + at_once());
    ASSIGN_OR_RETURN(auto rows, reader_.read({ids_.data() + from, to - from}));
    if (asked_.format == PictureFormat::kEnvi && to < ids_.size()) {
      const StoredSignature last = rows.back();
      while (rows.size() > 1 && of_one_cube(rows.back(), last)) rows.pop_back();
      to = from + rows.size();
    }
    const std::string wanted = shown_.wanted_layer();
    Some out{{}, to};
    for (StoredSignature& s : rows) {
      ASSIGN_OR_RETURN(auto thumbnail, reader_.thumbnail(s.signature_id));
      if (!thumbnail.has_value()) continue;
      RowImage& image = out.images.emplace_back();
      image.thumbnail = *std::move(thumbnail);
      if (silhouettes) {
        auto silhouette = reader_.silhouette(s.signature_id);
        if (silhouette.ok() && !silhouette->has_value())
          silhouette = absl::DataLossError("it has no silhouette");
        if (!silhouette.ok()) {
          if (!absl::IsDataLoss(silhouette.status())) return silhouette.status();
          return sweeps_.damaged(s, std::string(silhouette.status().message()));
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

  // The radiance that the picture of each image shows.
  absl::StatusOr<std::vector<ShownImage>> shown(const std::vector<RowImage>& some) {
    std::vector<ShownImage> out;
    for (const RowImage& image : some) {
      auto one = shown_image(image, shown_, sweeps_.most_px(image.signature));
      if (!one.ok()) return final_end(one.status());
      out.push_back(*std::move(one));
    }
    return out;
  }

  // Calls work(images, the first row behind them) for all rows from `begin` on. While it works, the
  // next images are read: it must not use the reader before it has called the function that it is
  // given, which waits for them.
  using Wait = std::function<void()>;
  absl::Status visit_rows(
      std::size_t begin, bool silhouettes,
      const std::function<absl::Status(std::vector<RowImage>&, std::size_t, const Wait&)>& work) {
    const auto read_from = [&](std::size_t from) {
      return std::async(std::launch::async, [=, this] { return images(from, silhouettes); });
    };
    auto next = read_from(begin);
    for (std::size_t from = begin; from < ids_.size();) {
      ASSIGN_OR_RETURN(auto some, next.get());
      from = some.end;
      next = read_from(from);
      RETURN_IF_ERROR(work(some.images, from, [&] { next.wait(); }));
    }
    return absl::OkStatus();
  }

  // Finds the scale of all rows, before the first is painted.
  absl::Status find_scale() {
    if (!has_grey_scale() || scale_.kind != PictureScale::Kind::kCommon) return absl::OkStatus();
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
                             if (!image.ok()) return damaged(some[i], image.status());
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

  [[nodiscard]] absl::Status damaged(const RowImage& image, const absl::Status& why) const {
    return sweeps_.damaged(image.signature, std::string(why.message()));
  }
  // Returns true if pictures are grey from black to white.
  [[nodiscard]] bool has_grey_scale() const {
    return !asked_.imager && asked_.format != PictureFormat::kEnvi && asked_.bits != 32;
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

  absl::Status paint_some(std::vector<RowImage>& some, const Wait& wait) {
    ASSIGN_OR_RETURN(const auto pictures, shown(some));
    std::vector<PictureFacts> facts(some.size());
    find_names(some, facts);
    find_ends(some, facts);
    if (asked_.imager) RETURN_IF_ERROR(files_.find_figures(some, facts));
    RETURN_IF_ERROR(
        visit_images(pictures, read_, [&](std::size_t i, absl::StatusOr<RadianceImage> image) {
          return image.ok() ? files_.write(some[i], *std::move(image), facts[i])
                            : damaged(some[i], image.status());
        }));
    if (asked_.format == PictureFormat::kEnvi) RETURN_IF_ERROR(files_.write_headers(some, facts));
    if (asked_.coco) RETURN_IF_ERROR(write_objects(some));
    wait();
    std::ostringstream lines;
    RETURN_IF_ERROR(write_labels(some, facts, lines));
    // Every table has its heading; the file has the first's.
    const std::string table = lines.str();
    return append(kLabels,
                  journal_.bytes[kLabels] == 0 ? table : table.substr(table.find('\n') + 1));
  }

  // A cube has the name of its first row.
  void find_names(const std::vector<RowImage>& some, std::vector<PictureFacts>& facts) const {
    for (std::size_t i = 0; i < some.size(); ++i) {
      const bool goes_on = asked_.format == PictureFormat::kEnvi && i > 0 &&
                           of_one_cube(some[i - 1].signature, some[i].signature);
      facts[i].name = goes_on ? facts[i - 1].name : sweeps_.name_of(some[i].signature);
      facts[i].band = goes_on ? facts[i - 1].band + 1 : 0;
    }
  }

  // Black and white of each picture, as far as other pictures state them.
  void find_ends(const std::vector<RowImage>& some, std::vector<PictureFacts>& facts) {
    for (std::size_t i = 0; i < some.size(); ++i) {
      const StoredSignature& s = some[i].signature;
      const double white = scale_.kind == PictureScale::Kind::kCommon
                               ? journal_.hottest[{s.sweep, s.band}]
                               : scale_.white_w_m2_sr;
      // As float32, in which the picture is painted.
      facts[i].black_w_m2_sr = static_cast<double>(static_cast<float>(scale_.black_w_m2_sr));
      facts[i].white_w_m2_sr = static_cast<double>(static_cast<float>(white));
    }
  }

  [[nodiscard]] std::vector<CocoCategory> categories() const {
    if (!asked_.categories.empty()) return asked_.categories;
    if (!asked_.each_part) return {{"target", {"*"}}};
    std::vector<CocoCategory> out;
    for (const std::string& part : sweeps_.parts()) out.push_back({part, {}});
    return out;
  }

  // By the direction: all pictures from there, of any range, are on one side.
  [[nodiscard]] bool is_for_validation(const StoredSignature& s) const {
    std::uint64_t hash = mix64(asked_.split_seed);
    for (const double place : {s.aspect_azimuth_deg, s.aspect_elevation_deg})
      hash = mix64(hash ^ std::bit_cast<std::uint64_t>(place));
    return std::ldexp(static_cast<double>(hash), -64) < asked_.validation;
  }

  // An object of a class in an image: what is seen of it, and the whole.
  struct FoundObject {
    std::size_t category;
    SeenObject seen;
    std::optional<WholeObject> whole;
  };

  static std::vector<FoundObject> find_objects(const StoredSilhouette& silhouette,
                                               const std::vector<CocoCategory>& classes) {
    std::vector<FoundObject> out;
    for (std::size_t c = 0; c < classes.size(); ++c) {
      const auto has = [&](const std::string& part) { return classes[c].has(part); };
      auto seen = seen_object(silhouette, has);
      if (!seen) continue;
      auto whole = whole_object(silhouette, *seen, has);
      out.push_back({c + 1, *std::move(seen), std::move(whole)});
    }
    return out;
  }

  absl::Status write_objects(const std::vector<RowImage>& some) {
    const std::vector<CocoCategory> classes = categories();
    std::vector<std::vector<FoundObject>> found(some.size());
    RETURN_IF_ERROR(on_all_cores(some.size(), [&](std::size_t i) {
      found[i] = find_objects(some[i].silhouette, classes);
      return absl::OkStatus();
    }));
    std::array<std::string, kGrowing.size()> lines;
    for (std::size_t i = 0; i < some.size(); ++i) {
      const StoredSignature& s = some[i].signature;
      const bool validation = is_for_validation(s);
      const CocoImage image{journal_.images + i + 1, sweeps_.name_of(s) + ending_of(asked_.format),
                            some[i].thumbnail.width_px(), some[i].thumbnail.height_px()};
      const std::string more =
          fmt::format(R"("sweep": {}, "row": {}, "season": {}, "time_utc": {}, "band": {}, )"
                      R"("aspect_azimuth_deg": {}, "aspect_elevation_deg": {}, "range_m": {})",
                      json_string(s.sweep), s.row, json_string(s.season), json_string(s.time_utc),
                      json_string(s.band), json_number(s.aspect_azimuth_deg),
                      json_number(s.aspect_elevation_deg), json_number(s.range_m));
      lines[validation ? kValidationImages : kTrainImages] += coco_entry(image, more) + "\n";
      for (const FoundObject& object : found[i])
        lines[validation ? kValidationObjects : kTrainObjects] +=
            coco_entry(++journal_.annotations, image, object.category, object.seen, object.whole) +
            "\n";
    }
    for (std::size_t file = kTrainImages; file < kGrowing.size(); ++file)
      RETURN_IF_ERROR(append(static_cast<Growing>(file), lines[file]));
    return absl::OkStatus();
  }

  // Writes the files beside the pictures, once these are all there.
  absl::Status finish_labels() {
    if (asked_.masks) {
      std::ostringstream text;
      ASSIGN_OR_RETURN(auto table, make_table_writer("csv", {{"value"}, {"part"}}, text));
      for (std::size_t p = 0; p < sweeps_.parts().size(); ++p)
        table->row({std::uint64_t{p + 1}, sweeps_.parts()[p]});
      RETURN_IF_ERROR(table->finish());
      RETURN_IF_ERROR(PictureFiles::plain_file(partial_ + "/parts.csv", text.str()));
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

  absl::Status append(Growing to, const std::string& lines) {
    errno = 0;
    std::ofstream file(path_of(to), std::ios::binary | std::ios::app);
    file << lines;
    file.close();
    if (!file) return write_failure(path_of(to));
    journal_.bytes[to] += lines.size();
    return absl::OkStatus();
  }

  absl::Status write_labels(const std::vector<RowImage>& some,
                            const std::vector<PictureFacts>& facts, std::ostream& out) {
    std::vector<ImageLabel> labels;
    for (std::size_t i = 0; i < some.size(); ++i) {
      const StoredSignature& s = some[i].signature;
      const schema::Thumbnail& t = some[i].thumbnail;
      ImageLabel& label = labels.emplace_back(
          ImageLabel{facts[i].name + ending_of(asked_.format), sweeps_.mask_of(s),
                     is_for_validation(s) ? "validation" : "train", s, facts[i].target,
                     facts[i].target_in_frame_px, t.width_px(), t.height_px(), t.pixel_rad()});
      if (asked_.imager) {
        const ImagerInBand& figures = facts[i].figures;
        label.counts = {asked_.imager_name, figures.counts_per_w_m2_sr, figures.offset_counts,
                        figures.noise_w_m2_sr, facts[i].saturated_px};
      }
      if (has_grey_scale()) label.scale = {facts[i].black_w_m2_sr, facts[i].white_w_m2_sr};
      if (asked_.format == PictureFormat::kEnvi) label.band = facts[i].band + 1;
    }
    const LabelColumns columns{.mask = asked_.masks,
                               .split = asked_.validation > 0,
                               .imager = asked_.imager.has_value(),
                               .band = asked_.format == PictureFormat::kEnvi,
                               .scale = has_grey_scale(),
                               .part = sweeps_.parts()};
    return irsig::write_labels(reader_, columns, labels, out);
  }

  StoreReader& reader_;
  const ThumbnailsAsked& asked_;
  const PictureScale scale_;
  const std::string folder_, partial_;
  const ReadPictures& read_;
  const ShownAsked shown_;
  std::vector<std::int64_t> ids_;
  ExportedSweeps sweeps_;
  const PictureFiles files_{asked_, scale_, sweeps_, partial_, read_};
  Journal journal_;
};

}  // namespace

const char* ending_of(PictureFormat format) {
  return format == PictureFormat::kEnvi ? ".bsq" : format == PictureFormat::kTiff ? ".tif" : ".png";
}

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
  if (asked.imager && asked.format != PictureFormat::kPng)
    return absl::InvalidArgumentError("--imager: counts are written as --image-format png alone");
  if (asked.coco && asked.format == PictureFormat::kEnvi)
    return absl::InvalidArgumentError(
        "--coco: its images have one band each, expected --image-format png or tiff");
  if (asked.bits == 32 && asked.format != PictureFormat::kTiff)
    return absl::InvalidArgumentError("--bits 32: float32 belongs to --image-format tiff");
  if (!(asked.validation >= 0 && asked.validation < 1))
    return absl::InvalidArgumentError("--validation: expected a fraction of at least 0, below 1");
  std::string path = folder;
  while (path.size() > 1 && path.ends_with('/')) path.pop_back();
  return ThumbnailFolder(reader, asked, scale, path, read).write();
}

}  // namespace irsig
