// Mutated files of optical properties, the same ones in every run: a reader must refuse them with
// file:line:column or return a table that is sound, whatever stands in the file. Run it with
// IRSIG_SANITIZE=address,undefined to see more.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/materials/optical/material_library.h"
#include "core/materials/optical/optical_files.h"
#include "tests/fuzz/mutator.h"
#include "tests/fuzz/turns.h"

namespace irsig {
namespace {

constexpr const char* kYaml =
    "REFERENCES: |\n    a <b>c</b>\nDATA:\n  - type: tabulated nk\n    data: |\n"
    "        0.2 1.396 1.1E-7\n        0.3 1.373 4.9E-8\n        46 1.541 0.462\n";
constexpr const char* kTwoTables =
    "DATA:\n  - type: tabulated n\n    data: |\n      1 1.5\n      3 1.7\n"
    "  - type: tabulated k\n    data: |\n      2 0.1\n      4 0.3\n";
constexpr const char* kCsv = "# x\nlambda_um,reflectance_percent\n3,50\n5,25\n8,12.5\n";
constexpr const char* kBrdf =
    "lambda_um,theta_i_deg,theta_r_deg,phi_deg,brdf_per_sr\n"
    "4,0,0,0,0.125\n4,0,0,180,0.25\n4,0,60,0,0.5\n4,0,60,180,0.75\n";
constexpr const char* kEntry =
    "name: a\nkind: lambert\ndescription: b\nsource: c\nlicence: d\nprovenance: >-\n  e\n"
    "emissivity: |\n  3 0.5\n  5 0.6\n";

constexpr const char* kWords[] = {"nan", "1e999", "-",  ",",  ": ", "|",    "- ", "{",
                                  "[",   "&a ",   "*a", "\r", "\t", "\n\n", "\"", "#"};

template <typename T>
bool refused(const absl::StatusOr<T>& result) {
  if (result.ok()) return false;
  EXPECT_EQ(result.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(result.status().message().find("f."), 0U) << result.status();
  return true;
}

void expect_sound(const OpticalConstants& table) {
  ASSERT_FALSE(table.empty());
  for (std::size_t i = 0; i < table.size(); ++i) {
    ASSERT_TRUE(table[i].lambda_um > (i == 0 ? 0 : table[i - 1].lambda_um));
    ASSERT_TRUE(table[i].n > 0 && table[i].k >= 0);
    ASSERT_TRUE(std::isfinite(table[i].n + table[i].k + table[i].lambda_um));
  }
}

void expect_sound(const Spectrum& table) {
  ASSERT_FALSE(table.empty());
  for (const SpectralPoint& p : table) ASSERT_TRUE(p.value >= 0 && p.value <= 1);
}

void expect_sound(const TabulatedBrdf& t) {
  ASSERT_EQ(t.brdf_per_sr.size(),
            t.lambda_um.size() * t.theta_i_deg.size() * t.theta_r_deg.size() * t.phi_deg.size());
  ASSERT_FALSE(t.brdf_per_sr.empty());
  for (const float f : t.brdf_per_sr) ASSERT_TRUE(f >= 0);
  ASSERT_LE(t.phi_deg.back(), 180);
}

TEST(MaterialFilesFuzz, EveryReaderRefusesOrReturnsASoundTable) {
  fuzz::Mutator mutator(20261121, kWords);
  int accepted = 0;
  fuzz::Turns turn(4000);
  while (turn.next()) {
    for (const char* text : {kYaml, kTwoTables}) {
      const auto table = read_optical_constants(mutator.mutate(text), "f.yml");
      if (refused(table)) continue;
      ++accepted;
      expect_sound(*table);
    }
    if (const auto table = read_spectrum(mutator.mutate(kCsv), "f.csv", "reflectance");
        !refused(table)) {
      ++accepted;
      expect_sound(*table);
    }
    if (const auto table = read_brdf(mutator.mutate(kBrdf), "f.csv"); !refused(table)) {
      ++accepted;
      expect_sound(*table);
    }
    const auto entry = read_library_entry(mutator.mutate(kEntry), "f.yml");
    if (!refused(entry)) ++accepted;
  }
  EXPECT_GT(accepted, turn.done() / 4) << "most files are refused at once: nothing is tested";
}

}  // namespace
}  // namespace irsig
