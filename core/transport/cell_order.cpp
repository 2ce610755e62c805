#include "core/transport/cell_order.h"

namespace irsig {

CellOrder::CellOrder(std::uint64_t samples, std::span<const SeedPair> seed_of_replicate)
    : samples_(static_cast<std::uint32_t>(samples)) {
  while ((std::uint64_t{1} << (2 * bits_)) < samples) ++bits_;
  const std::uint32_t cells = side(), mask = cells - 1;
  const auto cell_of = [&](std::uint32_t reversed) {
    return bits_ == 0 ? 0 : reverse_bits(reversed) >> (32 - bits_);
  };
  inverse_x_.resize(seed_of_replicate.size() * cells);
  inverse_y_.resize(inverse_x_.size());
  for (std::size_t r = 0; r < seed_of_replicate.size(); ++r)
    for (std::uint32_t low = 0; low < cells; ++low) {
      inverse_x_[r * cells + cell_of(scramble_reversed(low, seed_of_replicate[r].x) & mask)] = low;
      inverse_y_[r * cells + cell_of(scramble_reversed(low, seed_of_replicate[r].y) & mask)] = low;
    }
  high_of_.resize(cells);
  for (std::uint32_t high = 0; high < cells; ++high)
    high_of_[second_coordinate_reversed(high << bits_) & mask] = high;
}

}  // namespace irsig
