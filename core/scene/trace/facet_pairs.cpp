#include "core/scene/trace/facet_pairs.h"

#include <limits>

#include "absl/container/flat_hash_map.h"

namespace irsig {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

std::uint64_t directed(std::uint32_t from, std::uint32_t to) {
  return std::uint64_t{from} << 32 | to;
}

}  // namespace

FacetPairs::FacetPairs(const std::vector<float>& vertex,
                       const std::vector<std::uint32_t>& triangle) {
  const auto facets = static_cast<std::uint32_t>(triangle.size() / 3);
  const auto at = [&](std::uint32_t f, std::size_t k) {
    return triangle[3 * std::size_t{f} + k % 3];
  };
  const auto length2 = [&](std::uint32_t f, std::size_t k) {
    float sum = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      const float d =
          vertex[3 * std::size_t{at(f, k)} + j] - vertex[3 * std::size_t{at(f, k + 1)} + j];
      sum += d * d;
    }
    return sum;
  };
  // Facets are joined across the longest edge of one of them: of a quadrangle cut in two that is
  // most often its diagonal.
  absl::flat_hash_map<std::uint64_t, std::uint32_t> waiting;  // longest edge -> facet
  std::vector<std::uint32_t> partner(facets, kNone);
  waiting.reserve(facets);
  for (std::uint32_t f = 0; f < facets; ++f) {
    std::size_t k = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if (length2(f, i) > length2(f, k)) k = i;
    const auto other = waiting.find(directed(at(f, k + 1), at(f, k)));
    if (other != waiting.end() && partner[other->second] == kNone) {
      partner[f] = other->second;
      partner[other->second] = f;
    } else {
      waiting[directed(at(f, k), at(f, k + 1))] = f;
    }
  }
  // Pair the remaining facets across any edge.
  absl::flat_hash_map<std::uint64_t, std::uint32_t> edge;
  for (std::uint32_t f = 0; f < facets; ++f) {
    if (partner[f] != kNone) continue;
    for (std::size_t k = 0; k < 3 && partner[f] == kNone; ++k) {
      const auto other = edge.find(directed(at(f, k + 1), at(f, k)));
      if (other == edge.end() || partner[other->second] != kNone) continue;
      partner[f] = other->second;
      partner[other->second] = f;
    }
    if (partner[f] == kNone)
      for (std::size_t k = 0; k < 3; ++k) edge[directed(at(f, k), at(f, k + 1))] = f;
  }
  for (std::uint32_t f = 0; f < facets; ++f) {
    const std::uint32_t g = partner[f];
    if (g != kNone && g < f) continue;
    if (g == kNone) {
      corner_.push_back({at(f, 0), at(f, 1), at(f, 2), at(f, 2)});
      facet_.push_back({f, f});
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = at(f, k), b = at(f, k + 1);
      std::size_t i = 0;
      while (i < 3 && (at(g, i) != b || at(g, i + 1) != a)) ++i;
      if (i == 3) continue;
      corner_.push_back({at(f, k + 2), a, at(g, i + 2), b});
      facet_.push_back({f, g});
      break;
    }
  }
}

}  // namespace irsig
