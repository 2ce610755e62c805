#include <algorithm>
#include <cmath>
#include <limits>

#include "core/scene/import/import_formats.h"
#include "fmt/format.h"

namespace irsig {

void Float32Guard::add(const Vec<FileFrame>& a, const Vec<FileFrame>& b, const Vec<FileFrame>& c,
                       double area_scale) {
  double farthest = 0;
  for (const Vec<FileFrame>* v : {&a, &b, &c})
    farthest = std::max({farthest, std::abs(v->x), std::abs(v->y), std::abs(v->z)});
  const float at = static_cast<float>(farthest);
  const double spacing =
      static_cast<double>(std::nextafter(at, std::numeric_limits<float>::infinity()) - at);
  const double longest = std::max({length(b - a), length(c - b), length(a - c), spacing});
  area_ += 0.5 * area_scale * length(cross(b - a, c - a));
  unsure_area_ += 0.5 * area_scale * spacing * longest;
  coarsest_ = std::max(coarsest_, spacing);
}

std::optional<std::string> Float32Guard::problem() const {
  if (unsure_area_ <= 0.01 * area_) return std::nullopt;
  return fmt::format(
      "float32 coordinates are up to {:.3g} apart here (in the file's unit), which leaves {} of "
      "the model's area unsure, more than 1 %: move the model to its origin in the program that "
      "wrote it, or export OBJ, ASCII PLY or ASCII STL",
      coarsest_,
      area_ > 0 && unsure_area_ < area_ ? fmt::format("{:.3g} %", 100 * unsure_area_ / area_)
                                        : std::string("all"));
}

}  // namespace irsig
