// The most that a material's brdf x cos_i can be, against numerical maximisation.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/materials/material.h"
#include "tests/physics/brdf_roster.h"

namespace irsig {
namespace {

constexpr double kRad = std::numbers::pi / 180;

struct Direction {
  double x, y, z;
};

Direction at(double zenith_deg, double azimuth_deg) {
  const double s = std::sin(zenith_deg * kRad);
  return {s * std::cos(azimuth_deg * kRad), s * std::sin(azimuth_deg * kRad),
          std::cos(zenith_deg * kRad)};
}

Reflection reflection_at_limit(const Direction& i, const Direction& o) {
  const Direction h{i.x + o.x, i.y + o.y, i.z + o.z};
  const double h2 = h.x * h.x + h.y * h.y + h.z * h.z;
  return {static_cast<float>(i.z), static_cast<float>(o.z), static_cast<float>(h.z / std::sqrt(h2)),
          static_cast<float>((h.x * h.x + h.y * h.y) / h2),
          static_cast<float>(std::min(1.0, 0.5 * std::sqrt(h2)))};
}

double cos_brdf(const Material& m, const Reflection& r, std::vector<float>& row) {
  if (m.grey()) return static_cast<double>(m.brdf_per_sr(r) * r.cos_i);
  m.spectral_brdf_per_sr(r, row.data());
  return static_cast<double>(*std::max_element(row.begin(), row.end()) * r.cos_i);
}

// Zenith and azimuth angles that are dense about the mirror direction, at the lobe's own scale.
std::vector<double> about(double centre, double scale_deg, double low, double high) {
  std::vector<double> out;
  for (double x = low; x <= high; x += (high - low) / 24) out.push_back(x);
  for (double f = 0; f < 4; f += 0.1)
    for (const double sign : {-1.0, 1.0}) {
      const double x = centre + sign * f * scale_deg;
      if (x >= low && x <= high) out.push_back(x);
    }
  return out;
}

// Limits hold for two known directions, for one who looks at light from anywhere, and for light
// from one side whoever looks.
TEST(BrdfLimit, HoldsAndIsNotFarAway) {
  for (const RosterEntry& entry : material_roster()) {
    const auto material = Material::prepare(entry.spec, roster_wavelengths(), 3, 12);
    ASSERT_TRUE(material.ok()) << entry.spec.name << material.status();
    std::vector<float> row(material->nodes());
    const double slope = std::min(1.0, static_cast<double>(material->narrowest_slope()));
    const double scale_deg = 2 * std::atan(slope) / kRad;
    for (const double theta_o : {0.0, 20.0, 45.0, 70.0, 80.0, 85.0, 88.0, 89.0, 89.9}) {
      const Direction o = at(theta_o, 0);
      const double any_light = material->limit_seen_per_sr(o.z * (1 - 1e-6), o.z);
      double largest = 0;
      for (const double theta_i : about(theta_o, scale_deg, 0, 89.99))
        for (const double azimuth : about(180, scale_deg, 0, 180)) {
          const Direction i = at(theta_i, azimuth);
          const Reflection r = reflection_at_limit(i, o);
          const double value = cos_brdf(*material, r, row);
          largest = std::max(largest, value);
          const double tan2 = static_cast<double>(r.sin2_h / (r.cos_h * r.cos_h));
          // float32 of the geometry: relative 2e-7 of the slope, which a lobe of slope m amplifies.
          const ReflectionRange exact{i.z * (1 - 1e-5), o.z * (1 - 1e-5),
                                      std::max(0.0, tan2 * (1 - 1e-4) - 1e-6 * slope * slope), i.z,
                                      o.z};
          const double limit = material->cos_brdf_limit_per_sr(exact);
          ASSERT_LE(value, limit * 1.001 + 1e-9 * any_light)
              << entry.spec.name << " at " << theta_o << ", " << theta_i << ", " << azimuth;
          // A wider range has no smaller limit.
          ASSERT_LE(limit, material->cos_brdf_limit_per_sr({0.5 * i.z, 0.5 * o.z, 0.5 * tan2}) *
                               (1 + 1e-12));
        }
      for (const double theta_i : {0.0, 30.0, theta_o, 89.9})
        for (const double azimuth : {0.0, 90.0, 150.0, 179.0, 180.0}) {
          const Direction looks = at(theta_i, azimuth);
          ASSERT_LE(cos_brdf(*material, reflection_at_limit(o, looks), row),
                    1.001 * material->limit_of_light_per_sr(o.z * (1 - 1e-6), o.z))
              << entry.spec.name << ", light from " << theta_o << ", to " << theta_i << ", "
              << azimuth;
        }
      EXPECT_LE(largest, any_light * 1.001) << entry.spec.name << " at " << theta_o;
      // A limit that is far above what there is would switch nothing off. The models that create
      // energy at grazing have none that is near.
      if (entry.bounded && theta_o <= 80 && entry.family.find("Tabulated") == std::string::npos) {
        EXPECT_LE(any_light, 12 * largest) << entry.spec.name << " at " << theta_o;
      }
    }
  }
}

}  // namespace
}  // namespace irsig
