#include "core/scene/trace/target_facets.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "absl/container/flat_hash_map.h"
#include "core/base/work_counts.h"
#include "core/scene/trace/part_places.h"

namespace irsig {
namespace {

double area_m2(const std::array<Vec<Body>, 3>& corner) {
  return 0.5 * length(cross(corner[1] - corner[0], corner[2] - corner[0]));
}

PartsAbove parts_above_of(const Target& target) {
  const PartPlaces places(target);
  const std::size_t parts = target.part.size();
  // Facets and rays are rounded by less; reflected rays start 2e-6 of the radius above.
  const double rounding = 1e-6 * target.radius_m;
  PartsAbove out;
  out.set.emplace_back(parts, false);
  out.of_part.assign(parts, std::vector<bool>(parts, false));
  std::map<std::vector<bool>, std::uint32_t> known{{out.set.front(), 0}};
  std::size_t tried = 0;
  for (std::size_t t = 0; t < target.facet.size(); ++t) {
    const Target::Facet& facet = target.facet[t];
    std::array<std::uint32_t, 2>& sets = out.of_facet.emplace_back();
    const std::array<Vec<Body>, 3> corner = target.corners(t);
    if (!(area_m2(corner) > 0)) continue;
    const Vec<Body> middle = (1.0 / 3) * (corner[0] + corner[1] + corner[2]);
    for (const std::size_t side : {0u, 1u}) {
      if (side == 1 && !target.part[facet.part].two_sided) break;
      const Vec<Body> normal = (side == 0 ? 1.0 : -1.0) * Vec<Body>{facet.nx, facet.ny, facet.nz};
      std::vector<bool> set(parts, false);
      for (std::size_t q = 0; q < parts; ++q) {
        if (!places.any_above(q, normal, dot(normal, middle) + rounding, tried)) continue;
        set[q] = out.of_part[facet.part][q] = true;
      }
      const auto [at, fresh] = known.emplace(set, static_cast<std::uint32_t>(out.set.size()));
      if (fresh) out.set.push_back(std::move(set));
      sets[side] = at->second;
    }
  }
  count_work(Work::kPlacesTried, tried);
  return out;
}

std::vector<Facing> facings_of(const Target& target) {
  absl::flat_hash_map<std::array<std::int32_t, 4>, std::uint32_t> known;
  std::vector<Facing> out;
  std::vector<std::uint32_t> place(target.facet.size());
  for (std::size_t t = 0; t < target.facet.size(); ++t) {
    const double area = area_m2(target.corners(t));
    if (!(area > 0)) continue;
    const Target::Facet& facet = target.facet[t];
    const PartSpec& part = target.part[facet.part];
    const auto cell = [](float x) {
      return static_cast<std::int32_t>(std::lround(static_cast<double>(x) / kFacingCell));
    };
    const std::array<std::int32_t, 4> key{
        cell(facet.nx), cell(facet.ny), cell(facet.nz),
        static_cast<std::int32_t>(2 * part.material + (part.two_sided ? 1 : 0))};
    const auto [at, fresh] = known.try_emplace(key, static_cast<std::uint32_t>(out.size()));
    if (fresh) out.push_back({{0, 0, 0}, 0, 0, part.material, part.two_sided});
    place[t] = at->second;
    out[at->second].area_m2 += area;
    out[at->second].normal = out[at->second].normal + Vec<Body>{facet.nx, facet.ny, facet.nz};
  }
  for (Facing& f : out) f.normal = normalized(f.normal);
  for (std::size_t t = 0; t < target.facet.size(); ++t) {
    if (!(area_m2(target.corners(t)) > 0)) continue;
    const Target::Facet& facet = target.facet[t];
    Facing& f = out[place[t]];
    f.bent = std::max(f.bent, angle_between({facet.nx, facet.ny, facet.nz}, f.normal));
  }
  return out;
}

}  // namespace

const PartsAbove& TargetFacets::parts_above(const Target& target) const {
  std::call_once(above_made_, [&] { above_ = parts_above_of(target); });
  return above_;
}

const std::vector<Facing>& TargetFacets::facings(const Target& target) const {
  std::call_once(facings_made_, [&] { facing_ = facings_of(target); });
  return facing_;
}

double angle_between(Vec<Body> a, Vec<Body> b) {
  return 2 * std::asin(std::min(1.0, 0.5 * length(a - b)));
}

}  // namespace irsig
