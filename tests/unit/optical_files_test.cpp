// Readers of optical constants, spectra and BRDFs: what good files mean, and where bad ones are
// wrong.
#include "core/materials/optical/optical_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace irsig {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

template <typename T>
std::string error_of(const absl::StatusOr<T>& result) {
  EXPECT_EQ(result.status().code(), absl::StatusCode::kInvalidArgument);
  return std::string(result.status().message());
}

// The refractiveindex.info database writes its files like this.
constexpr const char* kTabulatedNk = R"(# this file is part of refractiveindex.info database

REFERENCES: |
    G. M. Hale and M. R. Querry. <a href="https://doi.org/x">Appl. Opt. <b>12</b></a>
DATA:
  - type: tabulated nk
    data: |
        0.200 1.396 1.10E-7
        0.225 1.373 4.90E-8
        46 1.541 0.462
CONDITIONS:
    temperature: 298
)";

TEST(OpticalConstantsFile, ReadsTabulatedNk) {
  const auto table = read_optical_constants(kTabulatedNk, "water.yml");
  ASSERT_TRUE(table.ok()) << table.status();
  ASSERT_EQ(table->size(), 3U);
  EXPECT_EQ((*table)[0].lambda_um, 0.2);
  EXPECT_EQ((*table)[0].n, 1.396);
  EXPECT_EQ((*table)[0].k, 1.1e-7);
  EXPECT_EQ((*table)[2].lambda_um, 46);
}

TEST(OpticalConstantsFile, ReadsWindowsLineEnds) {
  std::string text = kTabulatedNk;
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2)
    text.replace(at, 1, "\r\n");
  const auto table = read_optical_constants(text, "water.YAML");
  ASSERT_TRUE(table.ok()) << table.status();
  EXPECT_EQ(table->size(), 3U);
}

TEST(OpticalConstantsFile, JoinsTabulatedNAndKWhereBothAreKnown) {
  const auto table = read_optical_constants(
      "DATA:\n"
      "  - type: tabulated n\n"
      "    data: |\n"
      "        1 1.5\n"
      "        3 1.7\n"
      "        5 1.9\n"
      "  - type: tabulated k\n"
      "    data: |\n"
      "        2 0.1\n"
      "        4 0.3\n"
      "        6 0.5\n",
      "a.yml");
  ASSERT_TRUE(table.ok()) << table.status();
  ASSERT_EQ(table->size(), 4U);
  const double expected[][3] = {{2, 1.6, 0.1}, {3, 1.7, 0.2}, {4, 1.8, 0.3}, {5, 1.9, 0.4}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_DOUBLE_EQ((*table)[i].lambda_um, expected[i][0]);
    EXPECT_DOUBLE_EQ((*table)[i].n, expected[i][1]);
    EXPECT_DOUBLE_EQ((*table)[i].k, expected[i][2]);
  }
}

// Found by mutated files: a table of one row has no points between which to be linear.
TEST(OpticalConstantsFile, JoinsNoTableOfOneRow) {
  EXPECT_EQ(error_of(read_optical_constants("DATA:\n"
                                            "  - type: tabulated n\n"
                                            "    data: |\n"
                                            "        1 1.5\n"
                                            "        3 1.7\n"
                                            "  - type: tabulated k\n"
                                            "    data: |\n"
                                            "        2 0.1\n",
                                            "a.yml")),
            "a.yml:8:9: one row, expected two or more");
}

TEST(OpticalConstantsFile, ReadsCsvInNanometres) {
  const auto table = read_optical_constants(
      "# measured by us\nWavelength (nm),n,k\n3000,1.5,0\n5000,1.4,0.1\n", "a.csv");
  ASSERT_TRUE(table.ok()) << table.status();
  EXPECT_DOUBLE_EQ((*table)[1].lambda_um, 5);
  EXPECT_EQ((*table)[1].k, 0.1);
}

// refractiveindex.info hands its tables out like this: wavelengths in micrometres.
TEST(OpticalConstantsFile, ReadsCsvOfRefractiveindexInfo) {
  for (const char* text : {"wl,n,k\n8,1.1,2\n10,1.2,3\n",
                           "wl,n\r\n8,1.1\r\n10,1.2\r\n\r\nwl,k\r\n8,2\r\n10,3\r\n"}) {
    const auto table = read_optical_constants(text, "Al.csv");
    ASSERT_TRUE(table.ok()) << table.status();
    ASSERT_EQ(table->size(), 2U);
    EXPECT_EQ((*table)[1].lambda_um, 10);
    EXPECT_EQ((*table)[1].n, 1.2);
    EXPECT_EQ((*table)[1].k, 3);
  }
  EXPECT_THAT(error_of(read_optical_constants("wl,n\n8,1.1\n10,1.2\n", "Al.csv")),
              HasSubstr("Al.csv:1:1: n and k are both needed"));
  EXPECT_THAT(error_of(read_optical_constants("wl,n\n8,1.1\n9,1.1\nwl,n\n8,1\n", "Al.csv")),
              HasSubstr("Al.csv:4:1: expected the columns wl,n,k"));
  EXPECT_THAT(error_of(read_optical_constants("wl,n,k\n", "Al.csv")),
              HasSubstr("Al.csv:1:1: a block has no rows"));
}

TEST(OpticalConstantsFile, NamesTheFormulaThatItRefuses) {
  EXPECT_EQ(error_of(read_optical_constants("DATA:\n"
                                            "  - type: formula 1\n"
                                            "    wavelength_range: 0.2 5\n"
                                            "    coefficients: 0 1.43 0.07\n",
                                            "sapphire.yml")),
            "sapphire.yml:2:11: type \"formula 1\" is not read, expected \"tabulated nk\", or "
            "\"tabulated n\" and \"tabulated k\" (tabulate a formula yourself)");
}

TEST(OpticalConstantsFile, QuotesTextOfSeveralLinesInOne) {
  EXPECT_EQ(
      error_of(read_optical_constants("DATA:\n  - type: |\n      1 1.5\n      0.3\n", "a.yml")),
      "a.yml:2:11: type \"1 1.5?0.3?\" is not read, expected \"tabulated nk\", or "
      "\"tabulated n\" and \"tabulated k\" (tabulate a formula yourself)");
}

TEST(OpticalConstantsFile, HasNoDefaultForK) {
  EXPECT_EQ(error_of(read_optical_constants(
                "DATA:\n  - type: tabulated n\n    data: |\n      1 1.5\n      2 1.6\n", "a.yml")),
            "a.yml:1:1: no table of k, expected one beside the table of n (0 where it is known to "
            "be)");
}

TEST(OpticalConstantsFile, SaysWhereAYamlFileIsWrong) {
  std::string text = kTabulatedNk;
  text.replace(text.find("0.225 1.373"), 11, "0.199 -1.37");
  text.replace(text.find("0.462"), 5, "-0.46");
  EXPECT_EQ(error_of(read_optical_constants(text, "w.yml")),
            "w.yml:9:9: wavelength 0.199 is not above the one before it, 0.2, expected increasing "
            "wavelengths\n"
            "w.yml:9:15: n = -1.37, expected a number above 0\n"
            "w.yml:10:18: k = -0.46, expected 0 or more");
  text = kTabulatedNk;
  text.replace(text.find("1.373"), 5, "1,373");
  text.replace(text.find("46 1.541 0.462"), 14, "46 1.541");
  EXPECT_EQ(error_of(read_optical_constants(text, "w.yml")),
            "w.yml:9:15: \"1,373\", expected a finite number with a decimal point\n"
            "w.yml:10:9: a row of 2, expected 3 numbers");
}

TEST(OpticalConstantsFile, RefusesWhatIsNoSuchFile) {
  EXPECT_THAT(error_of(read_optical_constants("a: [1, 2\n", "a.yml")), HasSubstr("a.yml:2:1: "));
  EXPECT_EQ(error_of(read_optical_constants("- 1\n", "a.yml")),
            "a.yml:1:1: no list DATA, expected a file of the refractiveindex.info database");
  EXPECT_EQ(error_of(read_optical_constants("", "a.yml")),
            "a.yml:1:1: no list DATA, expected a file of the refractiveindex.info database");
  EXPECT_EQ(error_of(read_optical_constants("1 2 3\n", "a.txt")),
            "a.txt:1:1: a file with an unknown ending, expected .yml, .yaml or .csv");
  EXPECT_EQ(error_of(read_optical_constants("DATA:\n  - type: tabulated nk\n    data: \"1 2 3\"\n",
                                            "a.yml")),
            "a.yml:3:11: a table that is no literal block, expected \"|\" and one row a line");
  EXPECT_EQ(error_of(read_optical_constants("DATA:\n  - type: tabulated nk\n", "a.yml")),
            "a.yml:2:5: no table, expected \"data: |\" and its rows");
}

TEST(OpticalConstantsFile, RefusesWhatIsTooDeepOrTooLarge) {
  const auto message = [](const std::string& text) {
    return std::string(read_optical_constants(text, "a.yml").status().message());
  };
  std::string dashes;
  for (int i = 0; i < 100000; ++i) dashes += "- ";
  for (const std::string& text : {std::string(100000, '['), std::string(100000, '{'), dashes}) {
    EXPECT_THAT(message(text), ::testing::StartsWith("a.yml:1:"));
    EXPECT_THAT(message(text), ::testing::HasSubstr("more than 500 lists or tables in each other"));
  }
  EXPECT_EQ(message("DATA: [" + std::string(4000000, '1') + "]"),
            "a.yml:1:1: the file has 4000008 bytes, expected at most 4000000");
}

TEST(SpectrumFile, ReadsWhatItsHeaderSays) {
  const auto plain =
      read_spectrum("# paint 7\nlambda_um,emissivity\n3,0.9\n5,0.95\n", "a.csv", "emissivity");
  ASSERT_TRUE(plain.ok()) << plain.status();
  EXPECT_EQ((*plain)[1].lambda_um, 5);
  EXPECT_EQ((*plain)[1].value, 0.95);
  const auto percent = read_spectrum("\xEF\xBB\xBFWavelength [nm],Reflectance (%)\r\n3000, 25\r\n",
                                     "a.csv", "reflectance");
  ASSERT_TRUE(percent.ok()) << percent.status();
  EXPECT_DOUBLE_EQ((*percent)[0].lambda_um, 3);
  EXPECT_DOUBLE_EQ((*percent)[0].value, 0.25);
  const auto micro = read_spectrum("Wavelength (\u00b5m),value\n3,1\n", "a.csv", "reflectance");
  ASSERT_TRUE(micro.ok()) << micro.status();
}

// The ECOSTRESS library writes its files like this: falling wavelengths, per cent, noise beyond the
// scale.
const std::string kEcostress =
    "Name: Aluminum Metal\r\nType: manmade\r\nSample No.: 0598UUUALM\r\n"
    "Measurement: Directional (10 Degree) Hemispherical Reflectance\r\n"
    "First Column: X\r\nSecond Column: Y\r\nX Units: Wavelength (micrometers)\r\n"
    "Y Units: Reflectance (percent)\r\nNumber of X Values: 4\r\n"
    "Additional Information: none\r\n\r\n"
    "12.000\t100.4\r\n10.000\t90.0\r\n10.000\t92.0\r\n8.000\t60.0\r\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  text.replace(text.find(from), from.size(), to);
  return text;
}

TEST(SpectrumFile, ReadsLibrariesByTheirHeaders) {
  const auto same = [](const absl::StatusOr<Spectrum>& read,
                       const std::vector<std::pair<double, double>>& expected) {
    ASSERT_TRUE(read.ok()) << read.status();
    ASSERT_EQ(read->size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_NEAR((*read)[i].lambda_um, expected[i].first, 1e-12);
      EXPECT_NEAR((*read)[i].value, expected[i].second, 1e-12);
    }
  };
  same(read_spectrum(kEcostress, "a.txt", "reflectance"), {{8, 0.6}, {10, 0.91}, {12, 1}});
  same(read_spectrum(kEcostress, "a.txt", "emissivity"), {{8, 0.4}, {10, 0.09}, {12, 0}});
  const std::string wave_number = replaced(
      replaced(kEcostress, "Wavelength (micrometers)", "Wave number (cm-1)"), "12.000", "500.0");
  same(read_spectrum(wave_number, "a.txt", "reflectance"), {{20, 1}, {1000, 0.91}, {1250, 0.6}});
  const std::string usgs =
      "USGS Digital Spectral Library splib06a\nline 17 to end:  3-columns of data:\n"
      "------------------------------------\nPaint_Grey   W1R1Ba AREF\ncopy of splib05a r 1\n"
      "       0.205   0.034   0.000\n       0.250  -1.23e34   0.000\n       0.300   0.044   0.001\n";
  same(read_spectrum(usgs, "u.asc", "reflectance"), {{0.205, 0.034}, {0.3, 0.044}});
  EXPECT_THAT(error_of(read_spectrum(usgs, "u.asc", "emissivity")),
              HasSubstr("u.asc:1:1: this file has the reflectance of a sample, and does not say"));
  EXPECT_THAT(error_of(read_spectrum(replaced(kEcostress, "Hemispherical", "Specular"), "a.txt",
                                     "emissivity")),
              HasSubstr("expected its emissivity"));
  EXPECT_THAT(error_of(read_spectrum(replaced(kEcostress, "60.0", "160.0"), "a.txt", "reflectance")),
              HasSubstr("a.txt:15:7: 160, expected a number from 0 to 100"));
  EXPECT_THAT(error_of(read_spectrum(replaced(kEcostress, "10.000", "13.000"), "a.txt", "reflectance")),
              HasSubstr("expected wavelengths that rise or fall"));
  EXPECT_THAT(error_of(read_spectrum(replaced(kEcostress, "micrometers", "furlongs"), "a.txt",
                                     "reflectance")),
              HasSubstr("a.txt:7:1: X Units: wavelength (furlongs), expected"));
}

TEST(SpectrumFile, SaysWhichColumnsAreWanted) {
  for (const char* text : {"8.0 0.9\n9.0 0.9\n",
                           " splib07a Record=13303: Aluminum brush ASDFRa AREF\n 0.83\n 0.84\n"})
    EXPECT_THAT(error_of(read_spectrum(text, "a.txt", "emissivity")),
                HasSubstr("a.txt:1:1: the first line names no columns, expected \"lambda_um,emissivity"))
        << text;
}

// Spreadsheets and other programs write them like this.
TEST(SpectrumFile, SeparatorsQuotesAndLineEnds) {
  for (const char* text :
       {"lambda_um;emissivity\n8;0.9\n9;0.8\n", "lambda_um\temissivity\n8\t0.9\n9\t0.8\n",
        "lambda_um,emissivity,,\n8,0.9,,\n9,0.8,,\n", "lambda_um,emissivity\r8,0.9\r9,0.8\r",
        "\"lambda_um\",\"emissivity\"\n8,0.9\n9,0.8\n"}) {
    const auto read = read_spectrum(text, "a.csv", "emissivity");
    ASSERT_TRUE(read.ok()) << text << read.status();
    ASSERT_EQ(read->size(), 2U) << text;
    EXPECT_EQ((*read)[1].lambda_um, 9) << text;
    EXPECT_EQ((*read)[1].value, 0.8) << text;
  }
  EXPECT_EQ(error_of(read_spectrum("lambda_um;emissivity\n8;0,9\n", "a.csv", "emissivity")),
            "a.csv:2:3: \"0,9\", expected a finite number with a decimal point");
}

TEST(SpectrumFile, NamesWhatItIsThatIsNoTable) {
  const auto said = [](const std::string& text) {
    return error_of(read_spectrum(text, "a.csv", "emissivity"));
  };
  EXPECT_THAT(said(std::string("\xff\xfel\0,\0", 6)),
              HasSubstr("a.csv:1:1: this is text in UTF-16, expected UTF-8: save it as UTF-8"));
  EXPECT_THAT(said(std::string(12, '\0')), HasSubstr("a.csv:1:1: this is a binary file"));
  EXPECT_THAT(said("ENVI\nsamples = 3\nwavelength = {8,10}\n"),
              HasSubstr("ENVI spectral libraries are not read: export the spectrum as CSV with the "
                        "columns lambda_um,emissivity"));
}

TEST(SpectrumFile, GuessesNoUnitAndNoQuantity) {
  EXPECT_EQ(error_of(read_spectrum("wavelength,reflectance\n3,0.5\n", "a.csv", "reflectance")),
            "a.csv:1:1: column \"wavelength\", expected \"lambda_um\" or \"lambda_nm\"");
  EXPECT_EQ(error_of(read_spectrum("lambda_um,reflectance\n3,0.5\n", "a.csv", "emissivity")),
            "a.csv:1:11: column \"reflectance\", expected \"emissivity\" or "
            "\"emissivity_percent\"");
  EXPECT_EQ(error_of(read_spectrum("lambda_um,reflectance\n3,25\n", "a.csv", "reflectance")),
            "a.csv:2:3: 25, expected a number from 0 to 1: if it is in percent, name the column "
            "reflectance_percent");
  EXPECT_EQ(
      error_of(read_spectrum("lambda_um,reflectance_percent\n3,101\n", "a.csv", "reflectance")),
      "a.csv:2:3: 101, expected a number from 0 to 100 (percent)");
}

TEST(SpectrumFile, SaysWhereItIsWrong) {
  EXPECT_EQ(error_of(read_spectrum("# a remark\nlambda_um,emissivity\n\n3,0.9\n3, nan\n4;0.5\n",
                                   "p/a.csv", "emissivity")),
            "p/a.csv:5:4: \"nan\", expected a finite number\n"
            "p/a.csv:6:1: a row of 1, expected 2 numbers");
  EXPECT_EQ(error_of(read_spectrum("lambda_um,emissivity\n3,0.9\n 3,0.8\n", "a.csv", "emissivity")),
            "a.csv:3:2: wavelength 3 is not above the one before it, 3, expected increasing "
            "wavelengths");
  EXPECT_EQ(error_of(read_spectrum("lambda_um,emissivity\n0,0.9\n", "a.csv", "emissivity")),
            "a.csv:2:1: wavelength 0, expected a number above 0");
  EXPECT_EQ(error_of(read_spectrum("# nothing\n", "a.csv", "emissivity")),
            "a.csv:1:1: an empty file, expected a line with the names of the columns and rows");
  EXPECT_EQ(error_of(read_spectrum("lambda_um,emissivity\n", "a.csv", "emissivity")),
            "a.csv:1:1: no rows below the names of the columns");
  EXPECT_EQ(error_of(read_spectrum("lambda_um,a,b\n1,2,3\n", "a.csv", "emissivity")),
            "a.csv:1:1: 3 columns, expected \"lambda_um\" and \"emissivity\"");
}

TEST(SpectrumFile, ReportsTenErrorsAndCountsTheOthers) {
  std::string text = "lambda_um,emissivity\n";
  for (int i = 1; i <= 25; ++i) text += std::to_string(i) + ",2\n";
  const std::string error = error_of(read_spectrum(text, "a.csv", "emissivity"));
  EXPECT_THAT(error, HasSubstr("a.csv:11:4: 2, expected a number from 0 to 1"));
  EXPECT_THAT(error, Not(HasSubstr("a.csv:12:")));
  EXPECT_THAT(error, HasSubstr("a.csv: and 15 more errors"));
}

constexpr const char* kBrdfHeader =
    "# virtual goniometer, 4e6 rays\n"
    "lambda_um,theta_i_deg,theta_r_deg,phi_deg,brdf_per_sr,stderr_per_sr\n";

TEST(BrdfFile, ReadsAFullGridInAnyOrder) {
  const auto table = read_brdf(std::string(kBrdfHeader) +
                                   "10,30,60,180,0.8,0\n"
                                   "10,30,60,0,0.7,0\n"
                                   "10,30,0,180,0.6,0\n"
                                   "10,30,0,0,0.5,0\n"
                                   "4,30,60,180,0.4,0\n"
                                   "4,30,60,0,0.3,0\n"
                                   "4,30,0,180,0.2,0\n"
                                   "4,30,0,0,0.1,0\n",
                               "soil.csv");
  ASSERT_TRUE(table.ok()) << table.status();
  EXPECT_THAT(table->lambda_um, ElementsAre(4, 10));
  EXPECT_THAT(table->theta_i_deg, ElementsAre(30));
  EXPECT_THAT(table->theta_r_deg, ElementsAre(0, 60));
  EXPECT_THAT(table->phi_deg, ElementsAre(0, 180));
  EXPECT_THAT(table->brdf_per_sr, ElementsAre(0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f, 0.7f, 0.8f));
}

TEST(BrdfFile, AveragesTheTwoSidesOfThePlaneOfIncidence) {
  const auto table = read_brdf(std::string(kBrdfHeader) +
                                   "4,30,60,0,1,0\n"
                                   "4,30,60,90.1,2,0\n"
                                   "4,30,60,180,3,0\n"
                                   "4,30,60,269.9,4,0\n"
                                   "4,30,60,360,5,0\n",
                               "soil.csv");
  ASSERT_TRUE(table.ok()) << table.status();
  EXPECT_THAT(table->phi_deg, ElementsAre(0, 90.1, 180));
  EXPECT_THAT(table->brdf_per_sr, ElementsAre(3.0f, 3.0f, 3.0f));
}

TEST(BrdfFile, SaysWhereItIsWrong) {
  EXPECT_EQ(error_of(read_brdf("lambda_um,theta_i_deg,theta_r_deg,phi_deg\n1,2,3,4\n", "b.csv")),
            "b.csv:1:1: no column \"brdf_per_sr\"");
  EXPECT_EQ(error_of(read_brdf(std::string(kBrdfHeader) + "4,90,-1,361,-0.5,0\n", "b.csv")),
            "b.csv:3:3: theta_i_deg = 90, expected 0 or more and below 90\n"
            "b.csv:3:6: theta_r_deg = -1, expected 0 or more and below 90\n"
            "b.csv:3:9: phi_deg = 361, expected a number from 0 to 360\n"
            "b.csv:3:13: brdf_per_sr = -0.5, expected 0 or more");
  EXPECT_EQ(error_of(read_brdf(
                std::string(kBrdfHeader) + "4,0,0,0,1,0\n4,0,30,0,1,0\n4,0,0,90,1,0\n", "b.csv")),
            "b.csv:2:1: 3 rows, expected a full grid: one row for each of 1 wavelengths x 1 "
            "theta_i_deg x 2 theta_r_deg x 2 phi_deg");
  EXPECT_EQ(error_of(read_brdf(std::string(kBrdfHeader) + "4,0,0,0,1,0\n4,0,0,0,1,0\n", "b.csv")),
            "b.csv:2:1: 2 rows, expected a full grid: one row for each of 1 wavelengths x 1 "
            "theta_i_deg x 1 theta_r_deg x 1 phi_deg\n"
            "b.csv:4:1: the same directions and wavelength as in line 3");
}

}  // namespace
}  // namespace irsig
