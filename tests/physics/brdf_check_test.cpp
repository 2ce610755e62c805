// Rationale: `irsig material check` is what a user relies on before a sweep; a check that cannot
// fail is worth nothing. A tabulated BRDF comes from outside and is not reciprocal to begin with.
// Expected: every bounded material passes every row; a DHR above 1 fails "energy", and, since no
// emissivity makes up for it, the closure where it is met at the angles examined; a stated
// emissivity that is not 1 - DHR fails the closure alone; tables are reproduced at their points,
// made reciprocal with the residual stated; what is no material is refused with a reason.
// Source: thermodynamics; definitions.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "core/materials/direction_check.h"
#include "core/materials/material.h"
#include "core/materials/material_check.h"
#include "core/materials/tabulated_brdf.h"
#include "tests/physics/brdf_roster.h"

namespace irsig {
namespace {

std::set<std::string> failures(const MaterialSpec& spec) {
  const auto rows = check_material(spec, roster_wavelengths());
  EXPECT_TRUE(rows.ok()) << spec.name << ": " << rows.status();
  std::set<std::string> out;
  for (const MaterialCheckRow& row : *rows) {
    EXPECT_EQ(row.passed, row.worst <= row.bound) << row.check;
    EXPECT_FALSE(row.where.empty()) << row.check;
    if (!row.passed) out.insert(row.check);
  }
  return out;
}

TEST(MaterialCheck, TheRosterPassesOrSaysThatItCreatesEnergy) {
  for (const RosterEntry& entry : material_roster()) {
    auto failed = failures(entry.spec);
    if (entry.bounded) {
      EXPECT_TRUE(failed.empty()) << entry.spec.name << ": " << *failed.begin();
    } else if (!failed.empty()) {  // mirrors of 1e-4 do not reach their pole
      // "energy" looks at every angle, the closure at a few.
      EXPECT_TRUE(failed.contains("energy")) << entry.spec.name;
      failed.erase("energy");
      failed.erase("emissivity + DHR = 1");
      EXPECT_TRUE(failed.empty()) << entry.spec.name << ": " << *failed.begin();
    }
  }
  const std::set<std::string> clamped = {"emissivity + DHR = 1", "energy"};
  EXPECT_EQ(failures({"facets", PriestGermer{{{0, 1.5, 0.2}}, 0.3, true}}), clamped);
  EXPECT_EQ(failures({"lobe", Ward{roster_grey(0), roster_grey(1), 0.2, WardForm::kDuer}}),
            clamped);
}

TEST(MaterialCheck, AForcedEmissivityBreaksTheClosure) {
  EXPECT_TRUE(failures(*builtin_material("hull")).empty());
  EXPECT_EQ(failures(*builtin_material("hull_paper")),
            std::set<std::string>{"emissivity + DHR = 1"});
}

TEST(MaterialCheck, RefusesWhatIsNoMaterial) {
  const auto error = [](const MaterialSpec& spec) {
    const auto rows = check_material(spec, {10.0});
    return rows.ok() ? "" : std::string(rows.status().message());
  };
  Ward ward{roster_grey(0.1), roster_grey(0.1), 5e-5, WardForm::kDuer};
  EXPECT_NE(error({"a", ward}).find("roughness"), std::string::npos);
  ward.roughness = 0.1;
  ward.specular = {{8, 0.2}, {9, 0.3}};
  EXPECT_NE(error({"b", ward}).find("covers 8 to 9"), std::string::npos);
  ward.specular = roster_grey(1.5);
  EXPECT_NE(error({"c", ward}).find("specular reflectance 1.5"), std::string::npos);
  EXPECT_NE(error({"d", SandfordRobertson{roster_grey(0.9), roster_grey(0.1), 0.3, 0.1}})
                .find("less than nothing for the lobe"),
            std::string::npos);
  TabulatedBrdf table = roster_table({10});
  table.brdf_per_sr.pop_back();
  EXPECT_NE(error({"e", table}).find("BRDF values for a grid"), std::string::npos);
  table = roster_table({10});
  table.brdf_per_sr[7] = -1;
  EXPECT_NE(error({"f", table}).find("a BRDF of -1"), std::string::npos);
  table = roster_table({10});
  std::swap(table.phi_deg[1], table.phi_deg[2]);
  EXPECT_NE(error({"g", table}).find("azimuth"), std::string::npos);
  EXPECT_NE(error({"h", Prisse{1e-9, 4, roster_grey(0.1), false}}).find("gamma"),
            std::string::npos);
  EXPECT_FALSE(check_material({"i", Lambert{roster_grey(0.5)}}, {}).ok());
}

Reflection reflection(double in_deg, double out_deg, double phi_deg) {
  const double i = in_deg * std::numbers::pi / 180, o = out_deg * std::numbers::pi / 180,
               p = phi_deg * std::numbers::pi / 180;
  const double hx = std::sin(i) * std::cos(p) + std::sin(o), hy = std::sin(i) * std::sin(p),
               hz = std::cos(i) + std::cos(o), h2 = hx * hx + hy * hy + hz * hz;
  return {static_cast<float>(std::cos(i)), static_cast<float>(std::cos(o)),
          static_cast<float>(hz / std::sqrt(h2)), static_cast<float>((hx * hx + hy * hy) / h2),
          static_cast<float>(std::sqrt(h2) / 2)};
}

TEST(TabulatedBrdf, ReproducesItsPointsAndIsLinearBetweenThem) {
  const TabulatedBrdf table = roster_table({10});  // reciprocal where both grids have the angle
  const auto material = Material::prepare({"table", table}, {10}, 10, 10);
  ASSERT_TRUE(material.ok()) << material.status();
  const auto stated = [&](std::size_t i, std::size_t o, std::size_t p) {
    return static_cast<double>(
        table.brdf_per_sr[(i * table.theta_r_deg.size() + o) * table.phi_deg.size() + p]);
  };
  for (std::size_t i = 1; i < table.theta_i_deg.size(); ++i)
    for (std::size_t o = 2; o < table.theta_r_deg.size(); o += 2)  // those in both grids
      for (std::size_t p = 0; p + 1 < table.phi_deg.size(); ++p) {
        const double in = table.theta_i_deg[i], out = table.theta_r_deg[o],
                     azimuth = table.phi_deg[p];
        EXPECT_NEAR(material->brdf_per_sr(reflection(in, out, azimuth)), stated(i, o, p), 2e-5);
        EXPECT_NEAR(material->brdf_per_sr(reflection(in, out, azimuth + 5)),
                    (stated(i, o, p) + stated(i, o, p + 1)) / 2, 2e-5);
      }
  // Constant beyond the last zenith angle.
  EXPECT_NEAR(material->brdf_per_sr(reflection(80, 88, 90)),
              material->brdf_per_sr(reflection(80, 80, 90)), 1e-5);
  const auto findings = examine(table);
  ASSERT_TRUE(findings.ok());
  EXPECT_EQ(findings->last_zenith_deg, 80);
  EXPECT_NEAR(findings->clamped_fraction, std::pow(std::cos(80 * std::numbers::pi / 180), 2),
              1e-12);
}

TEST(TabulatedBrdf, IsMadeReciprocalAndSaysByHowMuchItWasNot) {
  TabulatedBrdf table;
  table.lambda_um = {10};
  table.theta_i_deg = table.theta_r_deg = {0, 30, 60};
  table.phi_deg = {0, 180};
  for (int i = 0; i < 3; ++i)
    for (int o = 0; o < 3; ++o)
      for (int p = 0; p < 2; ++p) table.brdf_per_sr.push_back(0.1f);
  const auto at = [&](std::size_t i, std::size_t o) -> float& {
    return table.brdf_per_sr[(i * 3 + o) * 2];
  };
  at(1, 2) = 0.2f;  // from 30 to 60 deg, but not back
  const auto findings = examine(table);
  ASSERT_TRUE(findings.ok());
  EXPECT_NEAR(findings->reciprocity_residual, 0.5, 1e-6);
  const auto material = Material::prepare({"table", table}, {10}, 10, 10);
  ASSERT_TRUE(material.ok());
  EXPECT_NEAR(material->brdf_per_sr(reflection(30, 60, 0)), 0.15, 1e-5);
  EXPECT_NEAR(material->brdf_per_sr(reflection(60, 30, 0)), 0.15, 1e-5);
  // A constant table is Lambertian.
  for (float& f : table.brdf_per_sr) f = 0.1f;
  const auto flat = Material::prepare({"flat", table}, {10}, 10, 10);
  ASSERT_TRUE(flat.ok());
  for (const float cos_o : {1.0f, 0.7f, 0.2f, 1e-3f})
    EXPECT_NEAR(flat->emissivity(cos_o), 1 - 0.1 * std::numbers::pi, 1e-6);
}

TEST(ChiSquare, MeetsClosedForms) {
  // 2 degrees of freedom: exp(-x/2); 4: (1 + x/2) exp(-x/2); 1: erfc(sqrt(x/2)).
  for (const double x : {0.01, 0.5, 2.0, 7.0, 30.0, 200.0}) {
    EXPECT_NEAR(chi_square_p_value(x, 2) / std::exp(-x / 2), 1, 1e-12) << x;
    EXPECT_NEAR(chi_square_p_value(x, 4) / ((1 + x / 2) * std::exp(-x / 2)), 1, 1e-12) << x;
    EXPECT_NEAR(chi_square_p_value(x, 1) / std::erfc(std::sqrt(x / 2)), 1, 1e-12) << x;
  }
  EXPECT_NEAR(chi_square_p_value(100, 100), 0.4811916845, 1e-9);
}

}  // namespace
}  // namespace irsig
