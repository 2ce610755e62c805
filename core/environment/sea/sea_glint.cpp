#include "core/environment/sea/sea_glint.h"

#include <algorithm>

#include "core/environment/sea/sea_surface.h"

namespace irsig {

SeaGlint sea_glint(Vec<Body> to_observer, Vec<Body> to_sun, double wind_speed_m_s) {
  if (!(to_observer.z < 0 && to_sun.z < 0)) return {0, 1};
  const Vec<Body> facet = normalized(to_observer + to_sun);
  return {static_cast<float>(glint_per_sr(to_observer, to_sun, wind_speed_m_s)),
          static_cast<float>(std::min(1.0, dot(to_observer, facet)))};
}

GlintShare glint_fraction(float cos_incidence) {
  const auto above =
      std::upper_bound(kGlintCosines.begin() + 1, kGlintCosines.end() - 1, cos_incidence);
  const auto node = static_cast<std::size_t>(above - kGlintCosines.begin()) - 1;
  const auto cube = [](float cosine) {
    const float u = 1 - cosine;
    return u * u * u;
  };
  const float here = cube(kGlintCosines[node]), next = cube(kGlintCosines[node + 1]);
  const float weight = (here - cube(cos_incidence)) / (here - next);
  return {node, std::clamp(weight, 0.0f, 1.0f)};
}

}  // namespace irsig
