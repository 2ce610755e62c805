#include "core/scene/trace/part_places.h"

#include <algorithm>
#include <array>

namespace irsig {
namespace {

constexpr std::uint32_t kMostInLeaf = 16;

double along(Vec<Body> v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

// The largest dot(direction, q) of any q in a box.
double support(Vec<Body> low, Vec<Body> high, Vec<Body> d) {
  return d.x * (d.x > 0 ? high.x : low.x) + d.y * (d.y > 0 ? high.y : low.y) +
         d.z * (d.z > 0 ? high.z : low.z);
}

}  // namespace

PartPlaces::PartPlaces(const Target& target) {
  std::vector<std::vector<std::uint32_t>> index(target.part.size());
  std::vector<Vec<Body>> normal(target.vertex.size() / 3, Vec<Body>{0, 0, 0});
  for (std::size_t t = 0; t < target.facet.size(); ++t) {
    const Target::Facet& facet = target.facet[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = target.triangle[3 * t + k];
      index[facet.part].push_back(v);
      normal[v] = normal[v] + Vec<Body>{facet.nx, facet.ny, facet.nz};
    }
  }
  for (std::vector<std::uint32_t>& of_part : index) {
    std::sort(of_part.begin(), of_part.end());
    of_part.erase(std::unique(of_part.begin(), of_part.end()), of_part.end());
    std::vector<Place> places;
    for (const std::uint32_t v : of_part) {
      const float* q = target.vertex.data() + 3 * static_cast<std::size_t>(v);
      places.push_back({{q[0], q[1], q[2]}, normal[v]});
    }
    root_.push_back(places.empty() ? kNone : static_cast<std::uint32_t>(box_.size()));
    if (places.empty()) continue;
    add_boxes(places, 0, static_cast<std::uint32_t>(places.size()));
    // Until here, its boxes count from the part's first place.
    const auto before = static_cast<std::uint32_t>(place_.size());
    for (std::size_t i = root_.back(); i < box_.size(); ++i) {
      box_[i].first += before;
      box_[i].last += before;
    }
    for (const Place& place : places) place_.push_back(place.at);
  }
}

void PartPlaces::add_boxes(std::vector<Place>& places, std::uint32_t first, std::uint32_t last) {
  Box box{places[first].at, places[first].at, {0, 0, 0}, 0, 0, first, last, 0};
  for (std::uint32_t i = first; i < last; ++i) {
    const Vec<Body> q = places[i].at;
    box.low = {std::min(box.low.x, q.x), std::min(box.low.y, q.y), std::min(box.low.z, q.z)};
    box.high = {std::max(box.high.x, q.x), std::max(box.high.y, q.y), std::max(box.high.z, q.z)};
    box.facing = box.facing + places[i].normal;
  }
  const double size = length(box.facing);
  box.facing = size > 0 ? (1 / size) * box.facing : Vec<Body>{0, 0, 0};
  box.bottom = box.top = dot(box.facing, places[first].at);
  for (std::uint32_t i = first; i < last; ++i) {
    const double at = dot(box.facing, places[i].at);
    box.bottom = std::min(box.bottom, at);
    box.top = std::max(box.top, at);
  }
  const std::size_t here = box_.size();
  box_.push_back(box);
  if (last - first <= kMostInLeaf) return;
  const Vec<Body> extent = box.high - box.low;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(
      places.begin() + first, places.begin() + middle, places.begin() + last,
      [axis](const Place& a, const Place& b) { return along(a.at, axis) < along(b.at, axis); });
  add_boxes(places, first, middle);
  box_[here].right = static_cast<std::uint32_t>(box_.size());
  add_boxes(places, middle, last);
}

double PartPlaces::highest(const Box& box, Vec<Body> normal) {
  const double of_box = support(box.low, box.high, normal), c = dot(normal, box.facing);
  const double in_slab = c * (c > 0 ? box.top : box.bottom);
  return std::min(of_box, in_slab + support(box.low, box.high, normal - c * box.facing));
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
    if (!(highest(box, normal) > level)) continue;
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
