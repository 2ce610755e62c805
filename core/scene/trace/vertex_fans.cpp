#include "core/scene/trace/vertex_fans.h"

#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "absl/container/flat_hash_map.h"

namespace irsig {

VertexFans::VertexFans(std::span<const float> vertex, std::span<const std::uint32_t> triangle)
    : vertex_(vertex.begin(), vertex.end()), triangle_(triangle.begin(), triangle.end()) {
  // Only vertices that a facet uses; + 0 turns -0 into 0.
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  absl::flat_hash_map<std::array<std::uint32_t, 3>, std::uint32_t> fan_at;
  fan_at.reserve(vertex_.size() / 3);
  fan_of_.assign(vertex_.size() / 3, kNone);
  for (const std::uint32_t index : triangle_) {
    if (fan_of_[index] != kNone) continue;
    const auto bits = [&](std::size_t j) {
      return std::bit_cast<std::uint32_t>(vertex_[3 * std::size_t{index} + j] + 0.0f);
    };
    const auto [entry, added] =
        fan_at.try_emplace({bits(0), bits(1), bits(2)}, static_cast<std::uint32_t>(centre_.size()));
    if (added) centre_.push_back(index);
    fan_of_[index] = entry->second;
  }
  first_.assign(centre_.size() + 1, 0);
  for (const std::uint32_t index : triangle_) ++first_[fan_of_[index] + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  facet_.resize(triangle_.size());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < triangle_.size(); ++i)
    facet_[next[fan_of_[triangle_[i]]]++] = static_cast<std::uint32_t>(i / 3);
}

Point3 VertexFans::corner(std::uint32_t facet, std::size_t k) const {
  const float* v = &vertex_[3 * std::size_t{triangle_[3 * std::size_t{facet} + k]}];
  return {v[0], v[1], v[2]};
}

void VertexFans::add_fan(std::uint32_t fan, const Point3& origin, const Point3& direction,
                         double t_min, Hit& best) const {
  for (std::uint32_t i = first_[fan]; i < first_[fan + 1]; ++i) {
    const std::uint32_t f = facet_[i];
    const FacetHit hit =
        exact_facet_hit(origin, direction, corner(f, 0), corner(f, 1), corner(f, 2));
    if (!hit.met || hit.t < t_min) continue;
    const bool same = best.met() && std::abs(hit.t - best.at.t) <= 1e-14 * std::abs(best.at.t);
    const bool better = !best.met()                  ? true
                        : !same                      ? hit.t < best.at.t
                        : hit.front != best.at.front ? hit.front
                                                     : f < best.facet;
    if (better) best = {f, hit};
  }
}

VertexFans::Hit VertexFans::nearest(std::uint32_t fan, const Point3& origin,
                                    const Point3& direction, double t_min) const {
  Hit best;
  add_fan(fan, origin, direction, t_min, best);
  return best;
}

VertexFans::Hit VertexFans::nearest_around(std::uint32_t facet, const Point3& origin,
                                           const Point3& direction, double t_min) const {
  Hit best;
  for (std::size_t k = 0; k < 3; ++k)
    add_fan(fan_of_[triangle_[3 * std::size_t{facet} + k]], origin, direction, t_min, best);
  return best;
}

std::vector<float> VertexFans::cap_corners(float reach) const {
  // A regular tetrahedron: alternate corners of a cube in the unit sphere.
  constexpr float h = 0.57735027f;
  constexpr float cap[4][3] = {{h, h, h}, {h, -h, -h}, {-h, h, -h}, {-h, -h, h}};
  std::vector<float> out;
  out.reserve(12 * centre_.size());
  for (const std::uint32_t index : centre_)
    for (const auto& corner : cap)
      for (std::size_t j = 0; j < 3; ++j)
        out.push_back(vertex_[3 * std::size_t{index} + j] + reach * corner[j]);
  return out;
}

}  // namespace irsig
