// Rationale: the sea is most of what a ship's hull mirrors, and the background of most lines of
// sight from above. Expected: emissivities of the facet model as an independent, much finer
// integral over slopes gives them; the known figures at 85 deg; the projected area's closed form;
// glint that carries the energy of the sunlight it mirrors. Source: Cox and Munk's slopes; Fresnel;
// Hale and Querry's constants of water; Masuda, Takashima and Takayama (1988) for the mean over
// facets with hidden ones left out.
#include <gtest/gtest.h>

#include <cmath>

#include "core/environment/sea/sea_surface.h"

namespace irsig {
namespace {

Vec<Body> observer(double zenith_deg, double azimuth_deg = 0) {
  const double z = zenith_deg * M_PI / 180, a = azimuth_deg * M_PI / 180;
  return {std::sin(z) * std::cos(a), std::sin(z) * std::sin(a), -std::cos(z)};
}

double emissivity(const std::vector<SeaFacet>& facets, double lambda_um) {
  double e = 0;
  for (const SeaFacet& f : facets) {
    e += f.share * (1 - water_reflectance(sea_water_index(lambda_um), f.cos_incidence));
  }
  return e;
}

// Cartesian slopes to five standard deviations, 200 x 200.
struct Fine {
  double emissivity, area;
};
Fine fine(double zenith_deg, double wind_m_s, double lambda_um) {
  const double variance = sea_slope_variance(wind_m_s), most = 5 * std::sqrt(variance / 2);
  const std::complex<double> index = sea_water_index(lambda_um);
  const double s = std::sin(zenith_deg * M_PI / 180), c = std::cos(zenith_deg * M_PI / 180);
  constexpr int kN = 200;
  double sum = 0, weight = 0, probability = 0;
  for (int i = 0; i < kN; ++i) {
    for (int j = 0; j < kN; ++j) {
      const double x = most * (2 * (i + 0.5) / kN - 1), y = most * (2 * (j + 0.5) / kN - 1);
      const double p = std::exp(-(x * x + y * y) / variance);
      probability += p;
      const double towards = c + s * x;  // n.v / n_z
      if (towards <= 0) continue;
      const double cosine = towards / std::sqrt(1 + x * x + y * y);
      weight += p * towards;
      sum += p * towards * (1 - water_reflectance(index, cosine));
    }
  }
  return {sum / weight, weight / probability};
}

TEST(EnvironmentSea, FlatAndRoughAt85Deg) {
  EXPECT_NEAR(emissivity(flat_sea(observer(85)), 10), 0.45, 0.01);
  EXPECT_NEAR(emissivity(sea_facets(observer(85), 5), 10), 0.68, 0.01);
}

TEST(EnvironmentSea, EmissivityIsTheIntegralOverSlopes) {
  for (const double wind : {0.0, 5.0, 15.0}) {
    for (const double zenith_deg : {0.0, 40.0, 60.0, 75.0, 85.0, 89.0}) {
      for (const double lambda_um : {4.0, 10.0}) {
        EXPECT_NEAR(emissivity(sea_facets(observer(zenith_deg, 33), wind), lambda_um),
                    fine(zenith_deg, wind, lambda_um).emissivity, 2e-3)
            << wind << " " << zenith_deg << " " << lambda_um;
      }
    }
  }
}

TEST(EnvironmentSea, SharesAddUpAndMirror) {
  for (const double zenith_deg : {0.0, 50.0, 88.0}) {
    const Vec<Body> v = observer(zenith_deg, -70);
    double sum = 0;
    for (const SeaFacet& f : sea_facets(v, 8)) {
      sum += f.share;
      EXPECT_GT(f.share, 0);
      EXPECT_NEAR(length(f.mirrored), 1, 1e-12);
      // Incidence is half the angle between the two directions.
      EXPECT_NEAR(dot(f.mirrored, v), 2 * f.cos_incidence * f.cos_incidence - 1, 1e-12);
    }
    EXPECT_NEAR(sum, 1, 1e-12);
  }
  const std::vector<SeaFacet> flat = flat_sea(observer(60, 30));
  ASSERT_EQ(flat.size(), 1u);
  EXPECT_NEAR(length(flat[0].mirrored - observer(60, 210)), 0, 1e-12);
}

TEST(EnvironmentSea, ProjectedAreaIsTheIntegralOverSlopes) {
  for (const double wind : {1.0, 10.0}) {
    for (const double zenith_deg : {0.0, 60.0, 85.0, 90.0}) {
      EXPECT_NEAR(sea_projected_area(std::cos(zenith_deg * M_PI / 180), wind) /
                      fine(zenith_deg, wind, 10).area,
                  1, 2e-3)
          << wind << " " << zenith_deg;
    }
  }
  EXPECT_NEAR(sea_projected_area(0.9, 5), 0.9, 1e-9);  // nothing faces away
}

TEST(EnvironmentSea, GlintCarriesTheSunsEnergy) {
  // From a perfect mirror the flux that meets a square metre leaves it, as long as no facet is
  // hidden or mirrors downwards.
  for (const double wind : {1.0, 8.0}) {
    for (const double sun_deg : {0.0, 35.0}) {
      const Vec<Body> sun = observer(sun_deg, 20);
      double flux = 0;
      constexpr int kSines = 400, kAzimuths = 720;
      for (int i = 0; i < kSines; ++i) {
        const double up = (i + 0.5) / kSines, level = std::sqrt(1 - up * up);
        for (int j = 0; j < kAzimuths; ++j) {
          const double a = 2 * M_PI * j / kAzimuths;
          flux += up * glint_per_sr({level * std::cos(a), level * std::sin(a), -up}, sun, wind);
        }
      }
      flux *= 2 * M_PI / (kSines * kAzimuths);
      EXPECT_NEAR(flux / std::cos(sun_deg * M_PI / 180), 1, 5e-3) << wind << " " << sun_deg;
    }
  }
}

TEST(EnvironmentSea, GlintIsWhatFacetsMirror) {
  // The radiance is also a share of facets: a uniform patch of sky of radiance 1 around the sun,
  // seen through facets, against the integral of glint over the patch.
  const Vec<Body> v = observer(60), sun = observer(50, 180);
  constexpr double kRadius = 0.15;
  double by_facets = 0;
  for (const SeaFacet& f : sea_facets(v, 12)) {
    if (dot(f.mirrored, sun) > std::cos(kRadius)) by_facets += f.share;
  }
  double by_glint = 0;
  const Vec<Body> e1 = normalized(cross(sun, Vec<Body>{0, 1, 0})), e2 = cross(sun, e1);
  constexpr int kN = 60;
  for (int i = 0; i < kN; ++i) {
    for (int j = 0; j < kN; ++j) {
      const double r = kRadius * (i + 0.5) / kN, a = 2 * M_PI * (j + 0.5) / kN;
      const Vec<Body> d = std::cos(r) * sun + std::sin(r) * (std::cos(a) * e1 + std::sin(a) * e2);
      by_glint += glint_per_sr(v, d, 12) * std::sin(r) * (kRadius / kN) * (2 * M_PI / kN);
    }
  }
  EXPECT_NEAR(by_facets / by_glint, 1, 0.1);  // a few dozen facets
}

}  // namespace
}  // namespace irsig
