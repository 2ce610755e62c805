// Rationale: a sampler whose density is not the one that it divides by is biased; the ship's hull
// and Lambert paints are what most sweeps use.
// Expected: the mean weight of sampled directions equal to the DHR; weights from the closed forms
// of D, G and the density; the hull's three readings. Source: [cook1982; heitz2014; born_wolf1999],
// computed here; DHR tables: brdf_dhr_test.cpp.
#include "core/materials/material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/sobol.h"
#include "core/materials/fresnel.h"

namespace irsig {
namespace {

Material prepared(const MaterialSpec& spec, std::vector<double> nodes = {10.0}) {
  auto m = Material::prepare(spec, nodes, nodes.front(), nodes.back());
  EXPECT_TRUE(m.ok()) << m.status();
  return *std::move(m);
}

MaterialSpec cook_torrance(double m, double n, double k, Fresnel fresnel = Fresnel::kExact) {
  CookTorrance lobe;
  lobe.constants = {{0, n, k}};
  lobe.roughness = m;
  lobe.fresnel = fresnel;
  return {"lobe", lobe};
}

TEST(CookTorrance, SamplingIntegratesToDhr) {
  for (const auto masking : {Masking::kVGroove, Masking::kSmith})
    for (const double theta_deg : {0.0, 45.0, 75.0, 87.0}) {
      MaterialSpec spec = cook_torrance(0.3, 1.2, 5.0);
      std::get<CookTorrance>(spec.model).masking = masking;
      const Material material = prepared(spec);
      const auto cos_o = static_cast<float>(std::cos(theta_deg * std::numbers::pi / 180));
      constexpr std::uint32_t kN = 1 << 18;
      double sum = 0;
      for (std::uint32_t i = 0; i < kN; ++i) {
        const SamplePair u = sobol_pair(i, seed_pair(7, 0));
        const Material::Sampled s =
            material.sample(cos_o, 0.5f, u.x, std::cos(2 * std::numbers::pi_v<float> * u.y),
                            std::sin(2 * std::numbers::pi_v<float> * u.y));
        sum += s.weight > 0 ? static_cast<double>(s.weight) : 0.0;
        if (s.weight > 0) {
          EXPECT_NEAR(s.x * s.x + s.y * s.y + s.z * s.z, 1.0f, 1e-5f);
          if (masking == Masking::kVGroove) {
            EXPECT_LE(s.weight, 2.0f + 1e-5f);
          }
        }
      }
      EXPECT_NEAR(sum / kN, material.dhr_max(cos_o), 1e-4) << theta_deg;
    }
}

// The weight of a sampled direction is brdf cos_i / density, with the density of Beckmann's slopes.
TEST(CookTorrance, ShapeAgreesWithSampledWeight) {
  for (const auto masking : {Masking::kVGroove, Masking::kSmith}) {
    MaterialSpec spec = cook_torrance(0.3, 1.2, 5.0);
    std::get<CookTorrance>(spec.model).masking = masking;
    const Material material = prepared(spec);
    for (std::uint32_t i = 0; i < 1000; ++i) {
      const SamplePair u = sobol_pair(i, seed_pair(3, 0));
      const float cos_o = std::cos(1.4f * sobol_pair(i, seed_pair(3, 1)).x),
                  sin_o = std::sqrt(1 - cos_o * cos_o);
      const auto s =
          material.sample(cos_o, 0.5f, u.x, std::cos(2 * std::numbers::pi_v<float> * u.y),
                          std::sin(2 * std::numbers::pi_v<float> * u.y));
      if (s.weight <= 0) continue;
      const double hx = s.x + sin_o, hy = s.y, hz = s.z + cos_o,
                   h = std::sqrt(hx * hx + hy * hy + hz * hz);
      const double cos_h = hz / h, cos_d = (hx * sin_o + hz * cos_o) / h;
      const double d = std::exp((1 - 1 / (cos_h * cos_h)) / 0.09) /
                       (std::numbers::pi * 0.09 * std::pow(cos_h, 4));
      const double density = d * cos_h / (4 * cos_d);
      const Reflection at{s.z, cos_o, static_cast<float>(cos_h),
                          static_cast<float>(1 - cos_h * cos_h), static_cast<float>(cos_d)};
      EXPECT_NEAR(at.sin2_h, s.at.sin2_h, 1e-5);
      EXPECT_NEAR(material.density_per_sr(at), density, 2e-4 * density);
      const double brdf = material.brdf_per_sr(at);
      EXPECT_NEAR(brdf * s.z / density, s.weight, 2e-4 * (1 + s.weight));
      // Reciprocity.
      const Reflection reversed{cos_o, s.z, at.cos_h, at.sin2_h, at.cos_d};
      EXPECT_NEAR(brdf, material.brdf_per_sr(reversed), 1e-5 * brdf);
    }
  }
}

TEST(Hull, ThreeReadingsOfTheShipsTable) {
  const Material hull = prepared(*builtin_material("hull"));
  const Material index = prepared(*builtin_material("hull_index"));
  const Material paper = prepared(*builtin_material("hull_paper"));
  EXPECT_NEAR(hull.emissivity(1), 0.8, 1e-5);
  // docs/explanation/methods.md: emissivity 0.165
  EXPECT_NEAR(index.emissivity(1), 1 - 0.8353, 5e-5);
  EXPECT_EQ(paper.emissivity(1), 0.8f);
  EXPECT_FALSE(hull.creates_energy());
  EXPECT_FALSE(index.creates_energy());
  EXPECT_TRUE(paper.creates_energy());
  EXPECT_FALSE(builtin_material("hulk").ok());
}

TEST(Lambert, SpectralTableIsInterpolatedAndMustCoverTheBand) {
  const MaterialSpec spec{"paint", Lambert{{{3, 0.5}, {5, 0.9}}}};
  const Material m = prepared(spec, {3, 4, 5});
  EXPECT_FALSE(m.grey());
  float e[3], r[3];
  m.spectral_emissivity(0.5f, e);
  m.spectral_brdf_per_sr({0.5f, 0.5f, 1, 0, 0.5f}, r);
  EXPECT_NEAR(e[1], 0.7f, 1e-6f);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(e[i] + std::numbers::pi_v<float> * r[i], 1, 1e-6);
  EXPECT_NEAR(m.dhr_max(1), 0.5f, 1e-6f);
  const auto missing = Material::prepare(spec, {6.0}, 6, 6);
  ASSERT_FALSE(missing.ok());
  EXPECT_NE(missing.status().message().find("covers 3 to 5"), std::string::npos);
}

TEST(Fresnel, ShipHullAtNormalIncidence) {
  // |(0.2 + 5i)/(2.2 + 5i)|^2 = 25.04/29.84; [zhou2026] with the square and the complex index that
  // its eq. 24 lacks.
  EXPECT_NEAR(fresnel_exact(1, 1.2, 5), 25.04 / 29.84, 1e-14);
  EXPECT_NEAR(fresnel_schlick(1, 1.2, 5), 25.04 / 29.84, 1e-14);
  EXPECT_NEAR(fresnel_exact(0, 1.2, 5), 1, 1e-14);
}

}  // namespace
}  // namespace irsig
