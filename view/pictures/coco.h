#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "view/pictures/masks.h"

namespace irsig {

// Labels in the JSON format of the COCO data set (cocodataset.org/#format-data): a list of images,
// a list of annotations and a list of categories. Lines are written one by one, so that no list is
// ever in memory.

// A class of objects: the parts whose names match one of the patterns, as the shell matches names of
// files; without patterns, the part of the category's name. An image has one object of each class
// of which something is seen.
struct CocoCategory {
  std::string name;
  std::vector<std::string> pattern;  // none: the part of the category's own name
  [[nodiscard]] bool has(const std::string& part) const;
};

// Returns a category from NAME=PATTERN,PATTERN. INVALID_ARGUMENT: it is not of that form.
[[nodiscard]] absl::StatusOr<CocoCategory> parse_category(const std::string& text);

struct CocoImage {
  std::uint64_t id;
  std::string file_name;
  std::uint32_t width_px, height_px;
};
// Returns the entry of an image; `more`: further fields, as JSON without braces, or nothing.
[[nodiscard]] std::string coco_entry(const CocoImage& image, const std::string& more);
// Returns the entry of an object. `segmentation` is its mask as run lengths that are not packed,
// `bbox` the box around it, `rectangle` the corners of the smallest rectangle of any direction, and
// `area` is that of its fractions of pixels. Places to count from 1 are those of the lists.
// `whole`: likewise with what other parts hide, if it is known.
[[nodiscard]] std::string coco_entry(std::uint64_t id, const CocoImage& image,
                                     std::size_t category_id, const SeenObject& object,
                                     const std::optional<WholeObject>& whole);

// Makes the file of two files with an entry on each line.
[[nodiscard]] absl::Status write_coco(const std::string& images_path,
                                      const std::string& annotations_path,
                                      const std::vector<CocoCategory>& categories,
                                      const std::string& path);

}  // namespace irsig
