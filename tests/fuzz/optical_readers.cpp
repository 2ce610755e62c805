// Materials.
#include <gtest/gtest.h>

#include <cmath>

#include "core/materials/optical/material_library.h"
#include "core/materials/optical/optical_files.h"
#include "tests/fuzz/readers.h"

namespace irsig::fuzz {
namespace {

bool accepts_constants(const std::string& text) {
  const auto table = read_optical_constants(text, "f.yml");
  if (!table.ok()) return refused(table.status(), "f.yml");
  EXPECT_FALSE(table->empty());
  double before = 0;
  for (const auto& p : *table) {
    EXPECT_GT(p.lambda_um, before);
    EXPECT_TRUE(p.n > 0 && p.k >= 0);
    EXPECT_TRUE(std::isfinite(p.n + p.k + p.lambda_um));
    before = p.lambda_um;
  }
  return true;
}

bool accepts_spectrum(const std::string& text) {
  const auto table = read_spectrum(text, "f.csv", "reflectance");
  if (!table.ok()) return refused(table.status(), "f.csv");
  EXPECT_FALSE(table->empty());
  for (const SpectralPoint& p : *table) EXPECT_TRUE(p.value >= 0 && p.value <= 1);
  return true;
}

bool accepts_brdf(const std::string& text) {
  const auto t = read_brdf(text, "f.csv");
  if (!t.ok()) return refused(t.status(), "f.csv");
  EXPECT_EQ(t->brdf_per_sr.size(), t->lambda_um.size() * t->theta_i_deg.size() *
                                       t->theta_r_deg.size() * t->phi_deg.size());
  EXPECT_FALSE(t->brdf_per_sr.empty());
  for (const float f : t->brdf_per_sr) EXPECT_GE(f, 0);
  EXPECT_LE(t->phi_deg.back(), 180);
  return true;
}

bool accepts_entry(const std::string& text) {
  const auto entry = read_library_entry(text, "f.yml");
  return entry.ok() || refused(entry.status(), "f.yml");
}

}  // namespace

std::vector<Reader> optical_readers() {
  const std::vector<const char*> words = {"nan", "1e999", "-",  ",",  ": ", "|",    "- ", "{",
                                          "[",   "&a ",   "*a", "\r", "\t", "\n\n", "\"", "#"};
  return {{"optical_constants",
           {"REFERENCES: |\n    a <b>c</b>\nDATA:\n  - type: tabulated nk\n    data: |\n"
            "        0.2 1.396 1.1E-7\n        0.3 1.373 4.9E-8\n        46 1.541 0.462\n",
            "DATA:\n  - type: tabulated n\n    data: |\n      1 1.5\n      3 1.7\n"
            "  - type: tabulated k\n    data: |\n      2 0.1\n      4 0.3\n"},
           words,
           accepts_constants,
           8000},
          {"spectrum",
           {"# x\nlambda_um,reflectance_percent\n3,50\n5,25\n8,12.5\n"},
           words,
           accepts_spectrum,
           4000},
          {"brdf",
           {"lambda_um,theta_i_deg,theta_r_deg,phi_deg,brdf_per_sr\n"
            "4,0,0,0,0.125\n4,0,0,180,0.25\n4,0,60,0,0.5\n4,0,60,180,0.75\n"},
           words,
           accepts_brdf,
           4000},
          {"library_entry",
           {"name: a\nkind: lambert\ndescription: b\nsource: c\nlicence: d\nprovenance: >-\n  e\n"
            "emissivity: |\n  3 0.5\n  5 0.6\n"},
           words,
           accepts_entry,
           4000}};
}

}  // namespace irsig::fuzz
