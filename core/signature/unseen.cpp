#include "core/signature/unseen.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace irsig {
namespace {

constexpr double kPi = std::numbers::pi;

double largest_brdf_per_sr(const Material& material, const Reflection& at,
                           std::vector<float>& row) {
  if (material.grey()) return material.brdf_per_sr(at);
  row.resize(material.nodes());
  material.spectral_brdf_per_sr(at, row.data());
  return *std::max_element(row.begin(), row.end());
}

// The direction within `radius_rad` of `centre` that lies closest to `wanted`.
Vec<Body> nearest_in_cone(Vec<Body> centre, double radius_rad, Vec<Body> wanted) {
  const double cosine = std::clamp(dot(centre, wanted), -1.0, 1.0);
  if (std::acos(cosine) <= radius_rad) return wanted;
  const Vec<Body> across = wanted - cosine * centre;
  const double sine = length(across);
  if (sine < 1e-12) return centre;
  return std::cos(radius_rad) * centre + (std::sin(radius_rad) / sine) * across;
}

}  // namespace

bool is_bright(const Material& material, const SunDirection& sun) {
  return material.narrowest_slope() < std::max(static_cast<double>(kBrightSlope),
                                               kNarrowRadii * std::tan(sun.angular_radius_rad));
}

std::vector<UnseenSun> unseen_sun(const Target& target, const std::vector<Material>& materials,
                                  const ViewFrame& frame, double range_m,
                                  const std::vector<SunDirection>& suns) {
  std::vector<UnseenSun> out(suns.size());
  // The largest reflectance of each material over angles.
  std::vector<double> dhr(materials.size(), 0.0);
  for (std::size_t m = 0; m < materials.size(); ++m)
    for (int k = 1; k <= 64; ++k)
      dhr[m] =
          std::max(dhr[m], static_cast<double>(materials[m].dhr_max(static_cast<float>(k) / 64)));
  std::vector<bool> used(materials.size(), false);
  for (const PartSpec& p : target.part) used[p.material] = true;
  std::vector<float> row;
  for (std::size_t j = 0; j < suns.size(); ++j) {
    const SunDirection& sun = suns[j];
    bool any = false;
    double receiver = 0;
    for (std::size_t m = 0; m < materials.size(); ++m) {
      if (!used[m]) continue;
      any |= is_bright(materials[m], sun);
      if (is_bright(materials[m], sun)) continue;
      const double slope = materials[m].narrowest_slope();
      receiver = std::max(receiver, dhr[m] / kPi * std::max(1.0, 1 / (4 * slope * slope)));
    }
    const double disk_per_sr = 1 / (kPi * std::pow(std::tan(sun.angular_radius_rad), 2));
    out[j].brightest_per_sr = any ? disk_per_sr : receiver;
    if (!any) continue;
    out[j].chain_per_sr = disk_per_sr;
    double thrown = 0;
    for (std::size_t t = 0; t < target.facet.size(); ++t) {
      const Target::Facet& facet = target.facet[t];
      const PartSpec& part = target.part[facet.part];
      const Material& material = materials[part.material];
      if (!is_bright(material, sun)) continue;
      Vec<Body> corner[3], middle{};
      for (int k = 0; k < 3; ++k) {
        const float* v =
            target.vertex.data() +
            3 * static_cast<std::size_t>(target.triangle[3 * t + static_cast<std::size_t>(k)]);
        corner[k] = {v[0], v[1], v[2]};
        middle = middle + (1.0 / 3) * corner[k];
      }
      const double area = 0.5 * length(cross(corner[1] - corner[0], corner[2] - corner[0]));
      if (!(area > 0)) continue;
      Vec<Body> to_sun = sun.direction, to_sensor = frame.sensor - middle;
      double irradiance = 1;
      if (sun.distance_m > 0) {
        to_sun = sun.direction - (1 / sun.distance_m) * middle;
        irradiance = 1 / dot(to_sun, to_sun);
        to_sun = normalized(to_sun);
      }
      // Nearest and farthest corner see the sensor (and a lamp) under directions that differ.
      const double size = std::sqrt(2 * area);
      const double radius = sun.angular_radius_rad + size / range_m +
                            (sun.distance_m > 0 ? size / sun.distance_m : 0);
      to_sensor = normalized(to_sensor);
      Vec<Body> n{facet.nx, facet.ny, facet.nz};
      double cos_o = dot(n, to_sensor);
      const double lit = dot(n, to_sun);
      thrown +=
          area * irradiance * dhr[part.material] *
          (part.two_sided ? std::abs(lit) : std::max(0.0, lit + std::sin(sun.angular_radius_rad)));
      if (cos_o < 0 && part.two_sided) {
        n = -1.0 * n;
        cos_o = -cos_o;
      }
      if (cos_o <= 0) continue;
      const Vec<Body> wi = nearest_in_cone(to_sun, radius, (2 * cos_o) * n - to_sensor);
      const double cos_i = dot(n, wi);
      if (cos_i <= 0) continue;
      const Vec<Body> h = normalized(wi + to_sensor);
      const double cos_h = dot(n, h);
      const Vec<Body> tangential = h - cos_h * n;
      const Reflection at{static_cast<float>(std::min(cos_i, 1.0)),
                          static_cast<float>(std::min(cos_o, 1.0)), static_cast<float>(cos_h),
                          static_cast<float>(dot(tangential, tangential)),
                          static_cast<float>(std::min(dot(h, wi), 1.0))};
      const double reflected = std::min(largest_brdf_per_sr(material, at, row) * cos_i,
                                        dhr[part.material] * disk_per_sr);
      out[j].glint += area * cos_o * irradiance * reflected;
    }
    out[j].caustic = thrown * receiver;
  }
  return out;
}

}  // namespace irsig
