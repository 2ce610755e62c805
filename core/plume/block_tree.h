#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace irsig {

// The set of existing blocks of 8^3 cells in an endless lattice, in two levels of nodes above the
// blocks: 16^3 blocks, and 32^3 of such nodes (the sizes of OpenVDB's tree). A node is a bit for
// each child and the index of the first, so that an empty node costs nothing and a block far from
// all others 6 kB.
class BlockTree {
 public:
  using Cell = std::array<std::int32_t, 3>;

  // Orders blocks by their place in the tree; both are origins, multiples of 8.
  [[nodiscard]] static bool before(const Cell& a, const Cell& b);

  BlockTree() = default;
  // Builds the tree. origins: sorted by before(), none twice.
  explicit BlockTree(const std::vector<Cell>& origins);

  // Content of a cell: the block in which it lies (its place in `origins`), or the size of the
  // aligned empty cube around the cell: 8, 128 or 4096 cells.
  struct Found {
    std::int64_t block;  // -1: none
    std::int32_t size;   // 8 where there is a block
  };
  // Keeps the nodes of the last cell, for neighbours.
  struct Cursor {
    std::int64_t root = -1, node = -1;
    Cell node_origin{};
  };
  [[nodiscard]] Found find(const Cell& cell, Cursor& cursor) const;

  // The highest nodes, 4096^3 cells: the box of cells of the blocks in each, last cell included.
  struct Root {
    Cell origin, low, high;
  };
  [[nodiscard]] const std::vector<Root>& roots() const { return roots_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  template <std::size_t kWords>
  struct Children {
    std::array<std::uint64_t, kWords> bits{};
    std::array<std::uint16_t, kWords> before{};  // bits in the words before
    std::int64_t first = 0;
    void add(unsigned child);
    void count();
    [[nodiscard]] std::int64_t find(unsigned child) const;  // -1: none
  };
  std::vector<Root> roots_;
  std::vector<Children<512>> root_nodes_;  // of roots_
  std::vector<Children<64>> nodes_;
};

}  // namespace irsig
