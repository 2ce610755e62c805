#include "core/scene/part_places.h"

#include <algorithm>
#include <array>

namespace irsig {
namespace {

constexpr std::uint32_t kMostInLeaf = 16;

double along(Vec<Body> v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

// The largest dot(normal, q) of any q in a box.
double support(Vec<Body> low, Vec<Body> high, Vec<Body> normal) {
  return normal.x * (normal.x > 0 ? high.x : low.x) + normal.y * (normal.y > 0 ? high.y : low.y) +
         normal.z * (normal.z > 0 ? high.z : low.z);
}

}  // namespace

PartPlaces::PartPlaces(const Target& target) {
  std::vector<std::vector<std::uint32_t>> index(target.part.size());
  for (std::size_t t = 0; t < target.facet.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      index[target.facet[t].part].push_back(target.triangle[3 * t + k]);
  for (std::vector<std::uint32_t>& of_part : index) {
    std::sort(of_part.begin(), of_part.end());
    of_part.erase(std::unique(of_part.begin(), of_part.end()), of_part.end());
    const auto first = static_cast<std::uint32_t>(place_.size());
    for (const std::uint32_t v : of_part) {
      const float* q = target.vertex.data() + 3 * static_cast<std::size_t>(v);
      place_.push_back({q[0], q[1], q[2]});
    }
    root_.push_back(of_part.empty() ? kNone : static_cast<std::uint32_t>(box_.size()));
    if (!of_part.empty()) add_boxes(first, static_cast<std::uint32_t>(place_.size()));
  }
}

void PartPlaces::add_boxes(std::uint32_t first, std::uint32_t last) {
  Vec<Body> low = place_[first], high = low;
  for (std::uint32_t i = first; i < last; ++i) {
    const Vec<Body> q = place_[i];
    low = {std::min(low.x, q.x), std::min(low.y, q.y), std::min(low.z, q.z)};
    high = {std::max(high.x, q.x), std::max(high.y, q.y), std::max(high.z, q.z)};
  }
  const std::size_t here = box_.size();
  box_.push_back({low, high, first, last, 0});
  if (last - first <= kMostInLeaf) return;
  const Vec<Body> size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(place_.begin() + first, place_.begin() + middle, place_.begin() + last,
                   [axis](Vec<Body> a, Vec<Body> b) { return along(a, axis) < along(b, axis); });
  add_boxes(first, middle);
  box_[here].right = static_cast<std::uint32_t>(box_.size());
  add_boxes(middle, last);
}

bool PartPlaces::any_above(std::size_t part, Vec<Body> normal, double level,
                           std::size_t& tried) const {
  if (root_[part] == kNone) return false;
  // Halves of halves: never more than one waits at each depth.
  std::array<std::uint32_t, 64> waiting{};
  std::size_t count = 0;
  waiting[count++] = root_[part];
  while (count > 0) {
    const std::uint32_t at = waiting[--count];
    const Box& box = box_[at];
    ++tried;
    if (!(support(box.low, box.high, normal) > level)) continue;
    if (box.right == 0) {
      for (std::uint32_t i = box.first; i < box.last; ++i, ++tried)
        if (dot(normal, place_[i]) > level) return true;
      continue;
    }
    waiting[count++] = box.right;
    waiting[count++] = at + 1;
  }
  return false;
}

}  // namespace irsig
