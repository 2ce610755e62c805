#include "core/land/objects/box_tree.h"

#include <cmath>
#include <limits>
#include <numeric>

namespace irsig {
namespace {

constexpr std::uint32_t kLeaf = 4;  // boxes

LandBox around_both(const LandBox& a, const LandBox& b) {
  return {
      {std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y), std::min(a.low.z, b.low.z)},
      {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y), std::max(a.high.z, b.high.z)}};
}

}  // namespace

// Halves the boxes at the median of their middles along the longer side of what they cover on the
// map, until few are left. The depth is the logarithm of their number.
class BoxTree::Builder {
 public:
  Builder(std::span<const LandBox> box, BoxTree& out) : box_(box), out_(out) {}

  void build() {
    out_.box_.resize(box_.size());
    std::iota(out_.box_.begin(), out_.box_.end(), 0u);
    out_.node_.resize(1);
    divide(0, 0, static_cast<std::uint32_t>(box_.size()));
  }

 private:
  void divide(std::uint32_t at, std::uint32_t first, std::uint32_t last) {
    LandBox around = box_[out_.box_[first]];
    for (std::uint32_t i = first + 1; i < last; ++i)
      around = around_both(around, box_[out_.box_[i]]);
    out_.node_[at].around = around;
    if (last - first <= kLeaf) {
      out_.node_[at].first = first;
      out_.node_[at].count = last - first;
      return;
    }
    const bool along_x = around.high.x - around.low.x > around.high.y - around.low.y;
    const auto middle = [&](std::uint32_t i) {
      const LandBox& b = box_[i];
      return along_x ? b.low.x + b.high.x : b.low.y + b.high.y;
    };
    const std::uint32_t half = first + (last - first) / 2;
    const auto begin = out_.box_.begin();
    std::nth_element(begin + first, begin + half, begin + last,
                     [&](std::uint32_t a, std::uint32_t b) {
                       return std::pair(middle(a), a) < std::pair(middle(b), b);
                     });
    const auto halves = static_cast<std::uint32_t>(out_.node_.size());
    out_.node_[at].first = halves;
    out_.node_.resize(halves + 2);
    divide(halves, first, half);
    divide(halves + 1, half, last);
  }

  std::span<const LandBox> box_;
  BoxTree& out_;
};

BoxTree::BoxTree(std::span<const LandBox> box) {
  if (!box.empty()) Builder(box, *this).build();
}

double BoxTree::highest_m(double west_m, double east_m, double south_m, double north_m) const {
  double out = -std::numeric_limits<double>::infinity();
  if (node_.empty()) return out;
  std::array<std::uint32_t, kDepth> waiting;
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const Node& node = node_[waiting[--count]];
    const LandBox& b = node.around;
    if (b.high.z <= out || b.high.x < west_m || b.low.x > east_m || b.high.y < south_m ||
        b.low.y > north_m)
      continue;
    if (node.count > 0) {
      out = b.high.z;
      continue;
    }
    waiting[count++] = node.first;
    waiting[count++] = node.first + 1;
  }
  return out;
}

}  // namespace irsig
