#include "core/thermal/scene/part_temperatures.h"

#include <algorithm>
#include <cmath>

namespace irsig {
namespace {

bool is_degenerate(const Target::Facet& f) { return f.nx == 0 && f.ny == 0 && f.nz == 0; }

}  // namespace

std::vector<double> facet_areas_m2(const Mesh& mesh) {
  std::vector<double> area_m2;
  for (std::size_t f = 0; f < mesh.triangle.size(); ++f) {
    const auto& c = mesh.triangle[f];
    area_m2.push_back(0.5 * length(cross(mesh.vertex[c[1]] - mesh.vertex[c[0]],
                                         mesh.vertex[c[2]] - mesh.vertex[c[0]])));
  }
  return area_m2;
}

std::vector<PartTemperature> part_temperatures(const Target& target,
                                               const std::vector<double>& area_m2,
                                               const SceneHeatResult& heat) {
  std::vector<PartTemperature> out;
  for (std::uint32_t p = 0; p < target.part.size(); ++p)
    for (std::size_t t = 0; t < heat.kelvin.size(); ++t) {
      double area = 0, mean = 0, error = 0, coldest = INFINITY, hottest = 0;
      for (std::size_t f = 0; f < target.facet.size(); ++f) {
        const auto kelvin = static_cast<double>(heat.kelvin[t][f]);
        if (target.facet[f].part != p || std::isnan(kelvin)) continue;
        area += area_m2[f];
        mean += area_m2[f] * kelvin;
        error += area_m2[f] * static_cast<double>(heat.error_k[t][f]);
        coldest = std::min(coldest, kelvin);
        hottest = std::max(hottest, kelvin);
      }
      if (area <= 0) continue;
      out.push_back({p, t, mean / area, error / area, coldest, hottest});
    }
  return out;
}

void fill_degenerate(const Target& target, const std::vector<HeatPart>& part,
                     const std::vector<PartTemperature>& means, SceneHeatResult& heat) {
  for (const PartTemperature& mean : means)
    for (std::size_t f = 0; f < target.facet.size(); ++f) {
      if (target.facet[f].part != mean.part || !part[mean.part].build_up ||
          !is_degenerate(target.facet[f]))
        continue;
      float& kelvin = heat.kelvin[mean.output][f];
      if (!std::isnan(kelvin)) continue;
      kelvin = static_cast<float>(mean.mean_k);
      heat.error_k[mean.output][f] = static_cast<float>(mean.error_k);
    }
}

void fill_degenerate(const Target& target, const std::vector<HeatPart>& part,
                     std::vector<float>& change_k) {
  std::vector<double> sum(part.size(), 0.0), count(part.size(), 0.0);
  for (std::size_t f = 0; f < change_k.size(); ++f) {
    if (std::isnan(change_k[f])) continue;
    sum[target.facet[f].part] += static_cast<double>(change_k[f]);
    ++count[target.facet[f].part];
  }
  for (std::size_t f = 0; f < change_k.size(); ++f) {
    const std::uint32_t p = target.facet[f].part;
    if (part[p].build_up && std::isnan(change_k[f]))
      change_k[f] = static_cast<float>(count[p] > 0 ? sum[p] / count[p] : 0);
  }
}

SurfaceCrossing surface_crossing(const Target& target, const std::vector<HeatPart>& part,
                                 double surface_z_m) {
  SurfaceCrossing out;
  for (std::size_t f = 0; f < target.facet.size(); ++f) {
    if (!part[target.facet[f].part].build_up) continue;
    double sum_m = 0, top_m = -1e300, bottom_m = 1e300;  // above the surface
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t v = target.triangle[3 * f + k];
      const double above_m =
          surface_z_m - (target.centre.z + static_cast<double>(target.vertex[3 * v + 2]));
      sum_m += above_m;
      top_m = std::max(top_m, above_m);
      bottom_m = std::min(bottom_m, above_m);
    }
    if (sum_m >= 0 || top_m <= 0.01 * (top_m - bottom_m)) continue;
    ++out.count;
    out.highest_m = std::max(out.highest_m, top_m);
  }
  return out;
}

UnreachedFacets unreached_facets(const Target& target, const std::vector<HeatPart>& part,
                                 const SceneHeatResult& heat) {
  UnreachedFacets out;
  for (std::size_t f = target.facet.size(); f-- > 0;) {
    const Target::Facet& facet = target.facet[f];
    if (!part[facet.part].build_up || is_degenerate(facet) || !std::isnan(heat.kelvin.front()[f]))
      continue;
    ++out.count;
    out.first = f;
  }
  return out;
}

}  // namespace irsig
