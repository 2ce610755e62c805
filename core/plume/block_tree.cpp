#include "core/plume/block_tree.h"

#include <algorithm>
#include <bit>
#include <tuple>

namespace irsig {
namespace {

using Cell = BlockTree::Cell;

Cell aligned(const Cell& cell, std::int32_t size) {
  return {cell[0] & -size, cell[1] & -size, cell[2] & -size};
}
unsigned node_of(const Cell& cell) {  // in its root: 32^3
  const auto part = [&](std::size_t a) { return static_cast<unsigned>(cell[a] >> 7) & 31; };
  return part(0) << 10 | part(1) << 5 | part(2);
}
unsigned block_of(const Cell& cell) {  // in its node: 16^3
  const auto part = [&](std::size_t a) { return static_cast<unsigned>(cell[a] >> 3) & 15; };
  return part(0) << 8 | part(1) << 4 | part(2);
}

}  // namespace

template <std::size_t kWords>
void BlockTree::Children<kWords>::add(unsigned child) {
  bits[child >> 6] |= std::uint64_t{1} << (child & 63);
}

template <std::size_t kWords>
void BlockTree::Children<kWords>::count() {
  unsigned sum = 0;
  for (std::size_t w = 0; w < kWords; ++w) {
    before[w] = static_cast<std::uint16_t>(sum);
    sum += static_cast<unsigned>(std::popcount(bits[w]));
  }
}

template <std::size_t kWords>
std::int64_t BlockTree::Children<kWords>::find(unsigned child) const {
  const std::uint64_t word = bits[child >> 6], bit = std::uint64_t{1} << (child & 63);
  if ((word & bit) == 0) return -1;
  return first + before[child >> 6] + std::popcount(word & (bit - 1));
}

bool BlockTree::before(const Cell& a, const Cell& b) {
  return std::tuple(aligned(a, 4096), node_of(a), block_of(a)) <
         std::tuple(aligned(b, 4096), node_of(b), block_of(b));
}

BlockTree::BlockTree(const std::vector<Cell>& origins) {
  for (std::size_t i = 0; i < origins.size(); ++i) {
    const Cell& at = origins[i];
    if (i == 0 || aligned(at, 4096) != roots_.back().origin) {
      roots_.push_back({aligned(at, 4096), at, at});
      root_nodes_.emplace_back();
      root_nodes_.back().first = static_cast<std::int64_t>(nodes_.size());
    }
    if (i == 0 || aligned(at, 128) != aligned(origins[i - 1], 128)) {
      root_nodes_.back().add(node_of(at));
      nodes_.emplace_back();
      nodes_.back().first = static_cast<std::int64_t>(i);
    }
    nodes_.back().add(block_of(at));
    for (std::size_t a = 0; a < 3; ++a) {
      roots_.back().low[a] = std::min(roots_.back().low[a], at[a]);
      roots_.back().high[a] = std::max(roots_.back().high[a], at[a] + 7);
    }
  }
  for (auto& root : root_nodes_) root.count();
  for (auto& node : nodes_) node.count();
}

BlockTree::Found BlockTree::find(const Cell& cell, Cursor& cursor) const {
  const Cell root_origin = aligned(cell, 4096), node_origin = aligned(cell, 128);
  if (cursor.root < 0 || roots_[static_cast<std::size_t>(cursor.root)].origin != root_origin) {
    const auto root =
        std::lower_bound(roots_.begin(), roots_.end(), root_origin,
                         [](const Root& r, const Cell& origin) { return r.origin < origin; });
    cursor.root = root == roots_.end() || root->origin != root_origin ? -1 : root - roots_.begin();
    cursor.node = -1;
    if (cursor.root < 0) return {-1, 4096};
  }
  if (cursor.node < 0 || cursor.node_origin != node_origin) {
    cursor.node = root_nodes_[static_cast<std::size_t>(cursor.root)].find(node_of(cell));
    cursor.node_origin = node_origin;
    if (cursor.node < 0) return {-1, 128};
  }
  return {nodes_[static_cast<std::size_t>(cursor.node)].find(block_of(cell)), 8};
}

std::size_t BlockTree::bytes() const {
  return roots_.capacity() * sizeof(Root) + root_nodes_.capacity() * sizeof root_nodes_[0] +
         nodes_.capacity() * sizeof nodes_[0];
}

}  // namespace irsig
