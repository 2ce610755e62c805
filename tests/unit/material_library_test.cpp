// The library that comes with the program: every entry can be read, says where it is from, and is
// a material over its whole range.
#include "core/materials/optical/material_library.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/materials/material.h"
#include "core/materials/optical/angular_table.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

std::vector<double> over_range(const MaterialSpec& spec, std::size_t count) {
  const WavelengthRange range = wavelength_range(spec);
  const double first = range.everywhere ? 0.3 : range.min_um;
  const double last = range.everywhere ? 1000 : range.max_um;
  std::vector<double> um;
  for (std::size_t i = 0; i < count; ++i)
    um.push_back(i + 1 == count
                     ? last
                     : first * std::pow(last / first,
                                        static_cast<double>(i) / static_cast<double>(count - 1)));
  um.front() = first;
  return um;
}

TEST(MaterialLibrary, HasTheEntriesThatTheDocumentsName) {
  std::vector<std::string> names;
  for (const LibraryEntry& entry : material_library()) names.push_back(entry.spec.name);
  EXPECT_THAT(names, ::testing::IsSupersetOf({"asphalt",
                                              "bare_soil_dry",
                                              "bare_soil_wet",
                                              "brick",
                                              "concrete",
                                              "grass",
                                              "leaves",
                                              "sand",
                                              "snow",
                                              "wheat",
                                              "aluminium",
                                              "blackbody",
                                              "generic_black_paint",
                                              "generic_grey_paint",
                                              "generic_white_paint",
                                              "haematite",
                                              "iron",
                                              "magnetite",
                                              "oxidised_steel",
                                              "sea_water"}));
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
}

TEST(MaterialLibrary, EveryEntrySaysWhereItIsFrom) {
  for (const LibraryEntry& entry : material_library()) {
    for (const std::string& text :
         {entry.description, entry.source, entry.licence, entry.provenance})
      EXPECT_FALSE(text.empty()) << entry.spec.name;
    if (entry.spec.name.find("paint") != std::string::npos) {
      EXPECT_THAT(entry.provenance, HasSubstr("not a measurement")) << entry.spec.name;
    }
  }
}

TEST(MaterialLibrary, IsLookedUpByName) {
  const auto iron = library_entry("iron");
  ASSERT_TRUE(iron.ok());
  EXPECT_EQ(model_kind(iron->spec), "cook_torrance");
  EXPECT_EQ(library_entry("unobtainium").status().code(), absl::StatusCode::kNotFound);
}

TEST(MaterialLibrary, EveryEntryIsAMaterialOverItsWholeRange) {
  std::vector<double> theta_i_deg;
  for (int i = 0; i <= 90; i += 3) theta_i_deg.push_back(std::min(89.99, 1.0 * i));
  for (const LibraryEntry& entry : material_library()) {
    const auto table = angular_table(entry.spec, over_range(entry.spec, 40), theta_i_deg);
    ASSERT_TRUE(table.ok()) << entry.spec.name << ": " << table.status();
    EXPECT_FALSE(table->creates_energy) << entry.spec.name;
    for (const AngularValue& v : table->value) {
      EXPECT_GE(v.dhr, 0) << entry.spec.name << " " << v.lambda_um << " " << v.theta_i_deg;
      EXPECT_LE(v.dhr, 1) << entry.spec.name << " " << v.lambda_um << " " << v.theta_i_deg;
      EXPECT_NEAR(v.dhr + v.emissivity, 1, 1e-6) << entry.spec.name;
    }
  }
}

TEST(MaterialLibrary, EntriesCoverTheWindows) {
  for (const LibraryEntry& entry : material_library()) {
    const WavelengthRange range = wavelength_range(entry.spec);
    EXPECT_LE(range.min_um, 0.3) << entry.spec.name;
    EXPECT_GE(range.max_um, 12) << entry.spec.name;
  }
}

// Expected: known emissivities at normal incidence. Source: Fresnel at the tabulated index by hand:
// water at 10 um, 1.218 + 0.0508i: R = ((n-1)^2 + k^2) / ((n+1)^2 + k^2) = 0.01018 [hale1973];
// roughness 0.169 changes R at normal incidence by less than 0.001.
TEST(MaterialLibrary, WaterAndMetalsEmitWhatTheirConstantsSay) {
  const auto emissivity = [](const char* name, double um) {
    const auto entry = library_entry(name);
    EXPECT_TRUE(entry.ok());
    const auto table = angular_table(entry->spec, {um}, {0});
    EXPECT_TRUE(table.ok()) << table.status();
    return table->value.at(0).emissivity;
  };
  EXPECT_NEAR(emissivity("sea_water", 10), 1 - 0.01018, 1e-3);
  EXPECT_EQ(emissivity("blackbody", 10), 1);
  EXPECT_LT(emissivity("aluminium", 10), 0.05);
  EXPECT_LT(emissivity("iron", 10), 0.1);
  EXPECT_GT(emissivity("oxidised_steel", 10), 0.75);
  EXPECT_GT(emissivity("generic_white_paint", 0.55), 0.1);
  EXPECT_LT(emissivity("generic_white_paint", 0.55), 0.3);
}

// Expected: means from 8 to 14 um of 0.89 to 0.92 for sand and 0.97 to 0.99 for grass. Source:
// R. A. Sutherland, J. Atmos. Oceanic Technol. 3 (1986) 199. Wet soil absorbs more than dry soil at
// every wavelength, as all wet ground does.
TEST(MaterialLibrary, PaintsAbsorbSunlightAsTheirSpectraDo) {
  const auto absorbed = [](const char* name) {
    return solar_absorptance(library_entry(name)->spec);
  };
  EXPECT_NEAR(absorbed("generic_black_paint").value(), 0.956, 0.005);
  EXPECT_NEAR(absorbed("generic_grey_paint").value(), 0.756, 0.01);
  EXPECT_NEAR(absorbed("generic_white_paint").value(), 0.234, 0.01);
  EXPECT_FALSE(absorbed("iron"));
  MaterialSpec grey{"grey", Lambert{{{0.3, 0.5}, {2.5, 0.5}}}};
  EXPECT_NEAR(solar_absorptance(grey).value(), 0.5, 1e-12);
  std::get<Lambert>(grey.model).emissivity.front().lambda_um = 0.4;
  EXPECT_FALSE(solar_absorptance(grey));
}

TEST(MaterialLibrary, LandEmitsWhatIsKnownOfIt) {
  const auto emissivity = [](const char* name, double um) {
    const auto entry = library_entry(name);
    EXPECT_TRUE(entry.ok()) << name;
    return angular_table(entry->spec, {um}, {0})->value.at(0).emissivity;
  };
  const auto mean = [&](const char* name) {
    double sum = 0;
    for (int i = 0; i < 60; ++i) sum += emissivity(name, 8.05 + 0.1 * i) / 60;
    return sum;
  };
  EXPECT_GE(mean("sand"), 0.89);
  EXPECT_LE(mean("sand"), 0.92);
  EXPECT_GE(mean("grass"), 0.97);
  EXPECT_LE(mean("grass"), 0.99);
  for (double um = 0.3; um < 50; um *= 1.03)
    EXPECT_GT(emissivity("bare_soil_wet", um), emissivity("bare_soil_dry", um)) << um;
}

TEST(LibraryEntryFile, SaysWhereItIsWrong) {
  const auto entry = read_library_entry(
      "name: gold\n"
      "kind: cook_torrance\n"
      "description: d\n"
      "source: s\n"
      "licence: l\n"
      "provenance: p\n"
      "roughness: 2\n"
      "fresnel: exact\n"
      "emissivity: 0.1\n"
      "optical_constants: |\n"
      "  1 0.2 5\n"
      "  1 -0.2 5\n",
      "gold.yml");
  EXPECT_EQ(entry.status().message(),
            "gold.yml:1:1: masking is missing\n"
            "gold.yml:7:12: roughness, expected a number from 0.0001 to 1\n"
            "gold.yml:9:1: a key that this kind of material does not have\n"
            "gold.yml:12:3: wavelength 1 is not above the one before it, 1, expected increasing "
            "wavelengths\n"
            "gold.yml:12:5: n, expected a number above 0");
}

TEST(AngularTable, RefusesAnglesAndWavelengthsThatItHasNot) {
  const auto iron = library_entry("iron");
  ASSERT_TRUE(iron.ok());
  EXPECT_FALSE(angular_table(iron->spec, {10}, {91}).ok());
  EXPECT_FALSE(angular_table(iron->spec, {}, {0}).ok());
  EXPECT_FALSE(angular_table(iron->spec, {0.1}, {0}).ok());
}

TEST(AngularTable, TellsEnergyThatIsCreated) {
  const auto paper = builtin_material("hull_paper");
  ASSERT_TRUE(paper.ok());
  const auto table = angular_table(*paper, {4, 10}, {0, 45});
  ASSERT_TRUE(table.ok()) << table.status();
  EXPECT_TRUE(table->creates_energy);
  for (const AngularValue& v : table->value) {
    EXPECT_NEAR(v.emissivity, 0.8, 1e-6);
    EXPECT_GT(v.dhr, 0.7);
  }
}

}  // namespace
}  // namespace irsig
