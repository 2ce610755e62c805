#include "view/pictures/coco.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>

#include <algorithm>
#include <cerrno>
#include <fstream>

#include "absl/strings/str_split.h"
#include "core/base/printable.h"
#include "view/base/atomic_file.h"

namespace irsig {
namespace {

// The lines of a file as the elements of a list.
bool copy_lines(const std::string& path, std::ostream& out) {
  std::ifstream in(path, std::ios::binary);
  std::string line;
  for (bool first = true; std::getline(in, line); first = false)
    out << (first ? "\n" : ",\n") << line;
  return in.eof();
}

}  // namespace

bool CocoCategory::has(const std::string& part) const {
  if (pattern.empty()) return part == name;
  return std::any_of(pattern.begin(), pattern.end(), [&](const std::string& p) {
    return ::fnmatch(p.c_str(), part.c_str(), 0) == 0;
  });
}

absl::StatusOr<CocoCategory> parse_category(const std::string& text) {
  const std::size_t equals = text.find('=');
  CocoCategory out{text.substr(0, equals), {}};
  if (equals != std::string::npos) out.pattern = absl::StrSplit(text.substr(equals + 1), ',');
  const bool whole =
      !out.pattern.empty() && std::none_of(out.pattern.begin(), out.pattern.end(),
                                           [](const std::string& p) { return p.empty(); });
  if (whole && !out.name.empty()) return out;
  return absl::InvalidArgumentError(
      fmt::format("--category {}: expected NAME=PATTERN,PATTERN with patterns of parts, as "
                  "funnel=funnel*,mast_hot",
                  text));
}

std::string coco_entry(const CocoImage& image, const std::string& more) {
  return fmt::format(R"({{"id": {}, "file_name": {}, "width": {}, "height": {}{}{}}})", image.id,
                     json_string(image.file_name), image.width_px, image.height_px,
                     more.empty() ? "" : ", ", more);
}

namespace {

// Area, box, rectangle and mask of an object, as fields of JSON.
std::string mask_fields(const CocoImage& image, const SeenObject& object) {
  return fmt::format(R"("area": {:.6g}, "bbox": [{}, {}, {}, {}], "rectangle": [{:.6g}], )"
                     R"("segmentation": {{"size": [{}, {}], "counts": [{}]}})",
                     object.area_px, object.left_px, object.top_px, object.width_px,
                     object.height_px, fmt::join(object.rectangle_px, ", "), image.height_px,
                     image.width_px, fmt::join(object.runs, ", "));
}

}  // namespace

std::string coco_entry(std::uint64_t id, const CocoImage& image, std::size_t category_id,
                       const SeenObject& object, const std::optional<WholeObject>& whole) {
  std::string of_whole;
  if (whole)
    of_whole = fmt::format(R"(, "occlusion": {:.6g}, "truncation": {:.6g}, "whole": {{{}}})",
                           whole->occlusion, whole->truncation, mask_fields(image, whole->mask));
  return fmt::format(R"({{"id": {}, "image_id": {}, "category_id": {}, "iscrowd": 0, {}{}}})", id,
                     image.id, category_id, mask_fields(image, object), of_whole);
}

absl::Status write_coco(const std::string& images_path, const std::string& annotations_path,
                        const std::vector<CocoCategory>& categories, const std::string& path) {
  errno = 0;
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out << "{\n\"info\": {\"description\": \"made by irsig\"},\n\"categories\": [";
  for (std::size_t i = 0; i < categories.size(); ++i)
    out << (i > 0 ? "," : "")
        << fmt::format("\n{{\"id\": {}, \"name\": {}}}", i + 1, json_string(categories[i].name));
  out << "\n],\n\"images\": [";
  const bool read = copy_lines(images_path, out);
  out << "\n],\n\"annotations\": [";
  const bool all = copy_lines(annotations_path, out) && read;
  out << "\n]\n}\n";
  out.close();
  return out && all ? absl::OkStatus() : write_failure(path);
}

}  // namespace irsig
