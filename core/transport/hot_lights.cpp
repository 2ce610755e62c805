#include "core/transport/hot_lights.h"

#include <algorithm>
#include <cmath>

namespace irsig {
namespace {

Float3 operator+(Float3 a, Float3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Float3 operator-(Float3 a, Float3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Float3 operator*(float s, Float3 a) { return {s * a.x, s * a.y, s * a.z}; }
float length(Float3 a) { return std::sqrt(dot(a, a)); }
Float3 cross(Float3 a, Float3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// A list of facets with the box that holds their keys, for halving along the longest side.
template <int kKeys>
struct Cell {
  std::vector<std::uint32_t> facet;
  float extent = 0;
  int longest = 0;
};

template <int kKeys, typename Key>
Cell<kKeys> make_cell(std::vector<std::uint32_t> facets, const Key& key) {
  Cell<kKeys> cell{std::move(facets), 0, 0};
  for (int k = 0; k < kKeys; ++k) {
    float low = key(cell.facet.front(), k), high = low;
    for (const std::uint32_t f : cell.facet) {
      low = std::min(low, key(f, k));
      high = std::max(high, key(f, k));
    }
    if (high - low > cell.extent) {
      cell.extent = high - low;
      cell.longest = k;
    }
  }
  return cell;
}

// Halves the cell with the largest extent at the middle of its longest side until there are `most`
// or every extent is at most `fine`.
template <int kKeys, typename Key>
std::vector<std::vector<std::uint32_t>> divide(std::vector<std::vector<std::uint32_t>> start,
                                               std::size_t most, float fine, const Key& key) {
  std::vector<Cell<kKeys>> cells;
  for (auto& facets : start) cells.push_back(make_cell<kKeys>(std::move(facets), key));
  while (cells.size() < most) {
    const auto widest = std::max_element(
        cells.begin(), cells.end(),
        [](const Cell<kKeys>& a, const Cell<kKeys>& b) { return a.extent < b.extent; });
    if (widest->extent <= fine) break;
    const int k = widest->longest;
    float low = key(widest->facet.front(), k), high = low;
    for (const std::uint32_t f : widest->facet) {
      low = std::min(low, key(f, k));
      high = std::max(high, key(f, k));
    }
    const float middle = 0.5f * (low + high);
    std::vector<std::uint32_t> below, above;
    for (const std::uint32_t f : widest->facet) (key(f, k) < middle ? below : above).push_back(f);
    if (below.empty() || above.empty()) {
      widest->extent = 0;  // cannot be halved: coordinates that differ by rounding
      continue;
    }
    *widest = make_cell<kKeys>(std::move(below), key);
    cells.push_back(make_cell<kKeys>(std::move(above), key));
  }
  std::vector<std::vector<std::uint32_t>> out;
  for (auto& cell : cells) out.push_back(std::move(cell.facet));
  return out;
}

}  // namespace

HotLights::HotLights(const Target& target) : target_(&target) {
  std::vector<std::vector<std::uint32_t>> part(target.part.size());
  bool any = false;
  for (const PartSpec& p : target.part) any |= p.hot;
  if (!any) return;
  for (std::uint32_t f = 0; f < target.facet.size(); ++f)
    if (target.part[target.facet[f].part].hot && area_m2(f) > 0)
      part[target.facet[f].part].push_back(f);
  std::erase_if(part, [](const auto& facets) { return facets.empty(); });
  if (part.empty()) return;
  std::uint32_t last_facet = 0;
  first_facet_ = kNone;
  for (const auto& facets : part) {
    first_facet_ = std::min(first_facet_, facets.front());
    last_facet = std::max(last_facet, facets.back());
  }
  cluster_of_.assign(last_facet - first_facet_ + 1, kNone);

  // Parts longer than a tenth of the target's radius are cut: the bound on a compact piece is
  // closer to what it really is.
  const auto place = [this](std::uint32_t f, int k) {
    const Float3 c = centroid(f);
    return k == 0 ? c.x : (k == 1 ? c.y : c.z);
  };
  if (part.size() > kMostLights) {  // parts share lights
    std::vector<std::uint32_t> all;
    for (const auto& facets : part) all.insert(all.end(), facets.begin(), facets.end());
    part.assign(1, std::move(all));
  }
  const auto fine = static_cast<float>(0.1 * target.radius_m);
  for (auto& facets : divide<3>(std::move(part), kMostLights, fine, place))
    add_light(std::move(facets));
}

void HotLights::add_light(std::vector<std::uint32_t> facets) {
  Light light{{}, static_cast<std::uint32_t>(cluster_.size()), 0};
  float extent = 0;
  {
    Float3 low = corner(facets.front(), 0), high = low;
    for (const std::uint32_t f : facets)
      for (int k = 0; k < 3; ++k) {
        const Float3 p = corner(f, k);
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
      }
    light.sphere.centre = 0.5f * (low + high);
    for (const std::uint32_t f : facets)
      for (int k = 0; k < 3; ++k)
        light.sphere.radius =
            std::max(light.sphere.radius, length(corner(f, k) - light.sphere.centre));
    extent = 2 * light.sphere.radius;
  }
  // Normals differ by at most 2, places by at most 1 in units of the light's size: facing counts
  // for more. One- and two-sided parts are kept apart.
  const auto key = [&](std::uint32_t f, int k) {
    const Target::Facet& facet = target_->facet[f];
    if (k == 0) return facet.nx;
    if (k == 1) return facet.ny;
    if (k == 2) return facet.nz;
    const Float3 c = centroid(f);
    return (k == 3 ? c.x : (k == 4 ? c.y : c.z)) / extent;
  };
  std::vector<std::vector<std::uint32_t>> sides(2);
  for (const std::uint32_t f : facets)
    sides[target_->part[target_->facet[f].part].two_sided ? 1 : 0].push_back(f);
  std::erase_if(sides, [](const auto& side) { return side.empty(); });
  for (const auto& cluster_facets : divide<6>(std::move(sides), kMostClusters, 0.25f, key)) {
    Cluster cluster = make_cluster(cluster_facets);
    cluster.light = count();
    light.sphere.area_m2 += cluster.two_sided ? 2 * cluster.area_m2 : cluster.area_m2;
    for (const std::uint32_t f : cluster_facets)
      cluster_of_[f - first_facet_] = static_cast<std::uint32_t>(cluster_.size());
    cluster_.push_back(cluster);
  }
  light.last = static_cast<std::uint32_t>(cluster_.size());
  light_.push_back(light);
}

HotLights::Cluster HotLights::make_cluster(const std::vector<std::uint32_t>& facets) {
  Cluster cluster{};
  cluster.first = static_cast<std::uint32_t>(triangle_.size());
  cluster.two_sided = target_->part[target_->facet[facets.front()].part].two_sided;
  double area = 0;
  Float3 low = corner(facets.front(), 0), high = low, mean{0, 0, 0};
  for (const std::uint32_t f : facets) {
    area += area_m2(f);
    triangle_.push_back(f);
    area_up_to_.push_back(static_cast<float>(area));
    mean = mean +
           area_m2(f) * Float3{target_->facet[f].nx, target_->facet[f].ny, target_->facet[f].nz};
    for (int k = 0; k < 3; ++k) {
      const Float3 p = corner(f, k);
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  cluster.last = static_cast<std::uint32_t>(triangle_.size());
  cluster.area_m2 = static_cast<float>(area);
  for (std::uint32_t t = cluster.first; t < cluster.last; ++t)
    area_up_to_[t] /= static_cast<float>(area);
  area_up_to_[cluster.last - 1] = 1;
  cluster.centre = 0.5f * (low + high);
  cluster.cos_half = -1;
  const float along = length(mean);
  if (along > 1e-3f * cluster.area_m2) {
    cluster.axis = (1 / along) * mean;
    float smallest = 1;
    for (const std::uint32_t f : facets)
      smallest = std::min(smallest, dot(cluster.axis, {target_->facet[f].nx, target_->facet[f].ny,
                                                       target_->facet[f].nz}));
    smallest = std::clamp(smallest - 1e-3f, -1.0f, 1.0f);
    cluster.cos_half = smallest;
    cluster.sin_half = std::sqrt(1 - smallest * smallest);
  }
  for (const std::uint32_t f : facets)
    for (int k = 0; k < 3; ++k)
      cluster.radius = std::max(cluster.radius, length(corner(f, k) - cluster.centre));
  return cluster;
}

Float3 HotLights::corner(std::uint32_t facet, int k) const {
  const float* v =
      target_->vertex.data() +
      3 * static_cast<std::size_t>(
              target_->triangle[3 * static_cast<std::size_t>(facet) + static_cast<std::size_t>(k)]);
  return {v[0], v[1], v[2]};
}

Float3 HotLights::centroid(std::uint32_t facet) const {
  return (1.0f / 3) * (corner(facet, 0) + corner(facet, 1) + corner(facet, 2));
}

float HotLights::area_m2(std::uint32_t facet) const {
  const Float3 a = corner(facet, 0);
  return 0.5f * length(cross(corner(facet, 1) - a, corner(facet, 2) - a));
}

// Returns the weight by which a cluster is chosen: area x an upper bound of the cosine / distance^2
// (to the sphere's middle, at least its radius).
float HotLights::share(const Cluster& cluster, Float3 x) const {
  const Float3 d = x - cluster.centre;
  const float distance2 = dot(d, d), radius2 = cluster.radius * cluster.radius;
  float cosine = 1;
  if (!cluster.two_sided && distance2 > radius2 && cluster.cos_half > 0) {
    // The largest cosine: of the angle to the axis, less the normals' cone and the sphere's half
    // angle.
    const float inverse = 1 / std::sqrt(distance2);
    const float c = dot(d, cluster.axis) * inverse;
    const float sin_sphere = cluster.radius * inverse;
    const float cos_sphere = std::sqrt(1 - sin_sphere * sin_sphere);
    const float wide_cos = cluster.cos_half * cos_sphere - cluster.sin_half * sin_sphere;
    const float wide_sin = cluster.sin_half * cos_sphere + cluster.cos_half * sin_sphere;
    if (c < wide_cos) cosine = c * wide_cos + std::sqrt(std::max(0.0f, 1 - c * c)) * wide_sin;
    if (cosine < -1e-5f) return 0;
    cosine = std::max(cosine, 1e-3f);
  }
  return cluster.area_m2 * cosine / std::max(distance2, radius2);
}

HotLights::Point HotLights::choose(std::uint32_t light, Float3 x, float u_cluster, float u_triangle,
                                   float u, float v) const {
  Point out;
  const Light& of = light_[light];
  float fraction_of[kMostClusters + 2];
  float sum = 0;
  for (std::uint32_t c = of.first; c < of.last; ++c)
    sum += fraction_of[c - of.first] = share(cluster_[c], x);
  if (sum <= 0) return out;  // every cluster faces away
  float rest = u_cluster * sum;
  std::uint32_t chosen = of.first;
  while (chosen + 1 < of.last && rest >= fraction_of[chosen - of.first])
    rest -= fraction_of[chosen++ - of.first];
  const Cluster& cluster = cluster_[chosen];
  const auto begin = area_up_to_.begin() + cluster.first, end = area_up_to_.begin() + cluster.last;
  const auto t = std::min(
      static_cast<std::uint32_t>(std::upper_bound(begin, end, u_triangle) - area_up_to_.begin()),
      cluster.last - 1);
  out.facet = triangle_[t];
  const float r = std::sqrt(u);
  const Float3 a = corner(out.facet, 0), b = corner(out.facet, 1), c = corner(out.facet, 2);
  const Float3 p = (1 - r) * a + (r * (1 - v)) * b + (r * v) * c;
  const Target::Facet& facet = target_->facet[out.facet];
  Float3 n{facet.nx, facet.ny, facet.nz};
  const Float3 d = p - x;
  float towards = -dot(n, d);
  if (towards < 0 && cluster.two_sided) {
    towards = -towards;
    n = -1.0f * n;
  }
  const float distance2 = dot(d, d);
  if (!(towards > 0) || !(distance2 > 0)) return out;
  const float inverse = 1 / std::sqrt(distance2);
  out.cos_l = std::min(towards * inverse, 1.0f);
  out.at = p + static_cast<float>(target_->offset_m()) * n;
  out.direction = inverse * d;
  out.density_per_sr =
      fraction_of[chosen - of.first] / (sum * cluster.area_m2) * distance2 / out.cos_l;
  return out;
}

float HotLights::density_per_sr(std::uint32_t facet, Float3 x, float distance2, float cos_l) const {
  const Cluster& cluster = cluster_[cluster_of_[facet - first_facet_]];
  const Light& of = light_[cluster.light];
  float sum = 0;
  for (std::uint32_t c = of.first; c < of.last; ++c) sum += share(cluster_[c], x);
  if (sum <= 0) return 0;
  return share(cluster, x) / (sum * cluster.area_m2) * distance2 / cos_l;
}

}  // namespace irsig
