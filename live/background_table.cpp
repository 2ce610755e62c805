#include "live/background_table.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace irsig {

float BackgroundTable::mean(float upper_z, float lower_z) const {
  if (upper_z > lower_z) std::swap(upper_z, lower_z);
  if (lower_z <= horizon_ || upper_z >= horizon_ || lower_z - upper_z < 1e-9f)
    return at(0.5f * (upper_z + lower_z), lower_z <= horizon_);
  const float above = (horizon_ - upper_z) / (lower_z - upper_z);
  return above * at(0.5f * (upper_z + horizon_), true) +
         (1 - above) * at(0.5f * (lower_z + horizon_), false);
}

float BackgroundTable::at(float z, bool above) const {
  const float width = above ? 1 + horizon_ : 1 - horizon_,
              from = above ? horizon_ - z : z - horizon_,
              f = width > 0 ? std::sqrt(std::clamp(from / width, 0.0f, 1.0f)) : 0;
  const float position = f * (kSideNodes - 1);
  const auto low = std::min(static_cast<std::uint32_t>(position), kSideNodes - 2);
  // Linear in z between nodes, as the nodes' errors are stated for.
  const auto square = [](float x) { return x * x; };
  const float n0 = static_cast<float>(low) / (kSideNodes - 1),
              n1 = static_cast<float>(low + 1) / (kSideNodes - 1),
              t = (square(f) - square(n0)) / (square(n1) - square(n0));
  const float* row = table_.data() + (above ? 0 : kSideNodes) + low;
  return row[0] + t * (row[1] - row[0]);
}

}  // namespace irsig
