#include "core/scene/trace/same_corners.h"

#include <algorithm>
#include <array>
#include <bit>

#include "absl/container/flat_hash_map.h"
#include "core/base/sobol.h"

namespace irsig {
namespace {

using Corner = std::array<std::uint32_t, 3>;

// The corners in ascending order, and whether an odd permutation brings them there.
struct Ordered {
  std::array<Corner, 3> corner;
  bool odd = false;
};

Ordered ordered(std::span<const float> vertex, std::span<const std::uint32_t> triangle,
                std::size_t facet) {
  Ordered out;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t j = 0; j < 3; ++j)
      out.corner[k][j] =
          std::bit_cast<std::uint32_t>(vertex[3 * std::size_t{triangle[3 * facet + k]} + j] + 0.0f);
  for (const std::size_t k : {0u, 1u, 0u}) {
    if (!(out.corner[k + 1] < out.corner[k])) continue;
    std::swap(out.corner[k], out.corner[k + 1]);
    out.odd = !out.odd;
  }
  return out;
}

}  // namespace

SameCorners::SameCorners(std::span<const float> vertex, std::span<const std::uint32_t> triangle) {
  const std::size_t facets = triangle.size() / 3;
  // Facets with equal sums of their corners' hashes are compared.
  absl::flat_hash_map<std::uint64_t, std::uint32_t> first_with;
  first_with.reserve(facets);
  std::vector<std::uint64_t> hash(vertex.size() / 3);
  for (std::size_t i = 0; i < hash.size(); ++i) {
    std::uint64_t h = 0;
    for (std::size_t j = 0; j < 3; ++j)
      h = mix64(h ^ std::bit_cast<std::uint32_t>(vertex[3 * i + j] + 0.0f));
    hash[i] = h;
  }
  std::vector<bool> listed(facets, false);
  for (std::size_t f = 0; f < facets; ++f) {
    const std::uint64_t sum =
        hash[triangle[3 * f]] + hash[triangle[3 * f + 1]] + hash[triangle[3 * f + 2]];
    const auto [entry, added] = first_with.try_emplace(sum, static_cast<std::uint32_t>(f));
    if (added) continue;
    const std::uint32_t first = entry->second;
    const Ordered a = ordered(vertex, triangle, first), b = ordered(vertex, triangle, f);
    if (a.corner != b.corner) continue;
    if (!listed[first]) same_.push_back({first, first, false});
    listed[first] = true;
    same_.push_back({static_cast<std::uint32_t>(f), first, a.odd != b.odd});
  }
  std::sort(same_.begin(), same_.end(), [](const Facet& a, const Facet& b) {
    return a.first != b.first ? a.first < b.first : a.number < b.number;
  });
}

std::vector<std::uint32_t> SameCorners::first_of_each(
    const std::vector<std::uint32_t>& triangle) const {
  std::vector<std::uint32_t> out = triangle;
  for (const Facet& f : same_)
    if (f.number != f.first)
      for (std::size_t k = 1; k < 3; ++k)
        out[3 * std::size_t{f.number} + k] = out[3 * std::size_t{f.number}];
  return out;
}

SameCorners::Choice SameCorners::choose(std::uint32_t facet, bool front) const {
  if (front) return {facet, false};
  for (auto f =
           std::lower_bound(same_.begin(), same_.end(), facet,
                            [](const Facet&a, std::uint32_t first) { return a.first < first; });
       f != same_.end() && f->first == facet; ++f)
    if (f->turned) return {f->number, true};
  return {facet, false};
}

}  // namespace irsig
