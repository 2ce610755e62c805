#include "core/atmosphere/imported/imported_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <string>

#include "absl/strings/str_format.h"
#include "core/atmosphere/atmosphere.h"
#include "core/atmosphere/imported/imported_samples.h"

// The layouts are those of MODTRAN 4 and 5 and LOWTRAN 7, to the column; the numbers are straight
// lines, so that every band mean is known.
namespace irsig {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// Cards of MODTRAN 4: mid-latitude summer, Navy aerosol.
std::string cards(int type, int emission, const std::string& card3, const std::string& limits,
                  const std::string& sun1 = "  -99  -99  -99  -99",
                  const std::string& sun2 =
                      " -99.00000 -99.00000 -99.00000 -99.00000 -99.00000"
                      " -99.00000 -99.00000 -99.00000",
                  double boundary_k = 0) {
  return absl::StrFormat(
      "T   2%5d%5d    0    2    2    2    2    2    2    1    0    0%8.3f0.00   \n"
      "    3    1    1    3    0    0  66.33180   2.00000   4.10000   0.00000   0.00000\n"
      " -99.000 -99.000 -99.000 -99\n"
      " -99.00000 -99.00000 -99.00000\n"
      "   36MIDLATITUDE SUMMER  \n%s\n%s\n%s\n%s\n"
      "    0   0    0.000  0    0.000  0    1.000\n",
      type, emission, boundary_k, card3, sun1, sun2, limits);
}

constexpr const char* kLevel = "   5.00000   0.02700 100.00000   5.00000   0.000006371.22998    0";
constexpr const char* kRadianceLabels =
    "    FREQ  TOT TRANS  PTH THRML  THRML SCT  SURF EMIS   SOL SCAT  SING SCAT  GRND RFLT  DRCT "
    "RFLT"
    "  TOTAL RAD  REF SOL  SOL@OBS   DEPTH\n";

double line_transmittance(double nu) { return (nu - 2000) / 1000; }
double line_radiance(double nu) { return 1e-7 + 1e-10 * (nu - 2000); }

// A row without sunlight: its columns are blank.
std::string thermal_row(double nu) {
  return absl::StrFormat(
      "%8.2f %.4E %.4E 0.0000E+00 1.0000E-06                       3.0000E-06            %.4E"
      "                     1.256\n",
      nu, line_transmittance(nu), line_radiance(nu), line_radiance(nu) + 4e-6);
}

std::string table(double from, double to, double step,
                  const std::function<std::string(double)>& row) {
  std::string out;
  for (double nu = from; step > 0 ? nu <= to : nu >= to; nu += step) out += row(nu);
  return out;
}

std::size_t band_of(double centre_cm1) {
  return static_cast<std::size_t>((centre_cm1 - kAirFirstCm1) / kAirBandWidthCm1);
}

const std::string kThermalRun = cards(1, 1, kLevel, "      2000      2100         1         1") +
                                kRadianceLabels + table(2000, 2100, 1, thermal_row);

TEST(ImportedPath, ThermalRadianceOfALevelPath) {
  const auto paths = parse_imported_paths(kThermalRun, "a.tape7");
  ASSERT_TRUE(paths.ok()) << paths.status();
  ASSERT_EQ(paths->path.size(), 1u);
  const ImportedPath& p = paths->path[0];
  EXPECT_EQ(p.line, 1u);
  EXPECT_EQ(p.observer_height_m, 5000);
  EXPECT_EQ(p.target_height_m, 5000) << "a level path has one height, whatever H2 and ANGLE say";
  EXPECT_EQ(p.range_m, 5000);
  EXPECT_EQ(p.zenith_deg, 90);
  for (const double none :
       {p.sun_zenith_deg, p.latitude_deg, p.longitude_deg, p.ground_temperature_k}) {
    EXPECT_TRUE(std::isnan(none));
  }
  EXPECT_EQ(p.day_of_year, 0);
  EXPECT_NEAR(p.transmittance[band_of(2045)], line_transmittance(2045), 1e-5);
  // The path's own radiance alone: no surface, no ground. W cm-2 sr-1 / cm-1 times nu^2.
  EXPECT_NEAR(p.radiance_w_m2_sr_um[band_of(2045)], 2045.0 * 2045 * line_radiance(2045), 2e-5);
  EXPECT_TRUE(p.sun_w_m2_um.empty());
  EXPECT_TRUE(std::isnan(p.transmittance[band_of(1995)]));
  EXPECT_TRUE(std::isnan(p.transmittance[band_of(2105)]));
  EXPECT_FALSE(std::isnan(p.transmittance[band_of(2005)]));
  EXPECT_FALSE(std::isnan(p.transmittance[band_of(2095)]));
}

TEST(ImportedPath, BandMeansAreIntegralsOfTheLinesBetweenSamples) {
  // Steps of 7 cm-1 from 2003: no sample stands on an edge; decreasing.
  const std::string text = cards(1, 1, kLevel, "      2003      2101         7        14") +
                           kRadianceLabels + table(2101, 2003, -7, thermal_row);
  const auto paths = parse_imported_paths(text, "a");
  ASSERT_TRUE(paths.ok()) << paths.status();
  const ImportedPath& p = paths->path[0];
  EXPECT_TRUE(std::isnan(p.transmittance[band_of(2005)])) << "2000-2003 is not covered";
  for (double centre = 2015; centre < 2100; centre += 10) {
    EXPECT_NEAR(p.transmittance[band_of(centre)], line_transmittance(centre), 1e-5) << centre;
  }
}

TEST(ImportedPath, TransmittanceWithUnitsInASecondLineOfLabels) {
  const std::string text =
      "T F 1    1    0    0    1    1    1    1    1    1    1    0    0   0.000   0.00\n"
      "    1    1    1    0    0    0  23.00000   0.00000   0.00000   0.00000   0.00000\n"
      " -99.000 -99.000 -99.000\n"
      " -99.00000 -99.00000 -99.00000  4.114728  0.000594 ! H2O & O3 COLUMNS [GM/CM2]\n"
      "   36TROPICAL MODEL      \n"
      "   0.00000  10.00000  30.00000   5.00000   0.00000   0.00000    0        0.00000\n"
      "  -99  -99  -99  -99\n"
      " -99.00000 -99.00000 -99.00000 -99.00000 -99.00000 -99.00000 -99.00000 -99.00000\n"
      "     657.0   50000.0       5.0      10.0NW              \n"
      "    0   0    0.000  0    0.000  0    1.000\n"
      "    FREQ COMBIN    H2O   UMIX     O3  TRACE     N2    H2O MOLEC AER+CLD  HNO3\n"
      "    CM-1  TRANS  TRANS  TRANS  TRANS  TRANS   CONT   CONT   SCAT  TRANS  TRANS\n" +
      table(657, 717, 5,
            [](double nu) {
              return absl::StrFormat(
                  "%8.2f %6.4f 0.2187 0.0000 0.9989 1.0000 1.0000 0.0003 1.0000 0.9413 1.0000\n",
                  nu, (nu - 600) / 1000);
            }) +
      " -9999.\n";
  const auto paths = parse_imported_paths(text, "a");
  ASSERT_TRUE(paths.ok()) << paths.status();
  const ImportedPath& p = paths->path[0];
  EXPECT_EQ(p.observer_height_m, 0);
  EXPECT_EQ(p.target_height_m, 0);
  EXPECT_TRUE(p.radiance_w_m2_sr_um.empty());
  EXPECT_NEAR(p.transmittance[band_of(685)], 0.085, 1e-6);
}

// MODTRAN 5 writes a path to space by day like this, 12 h UT of 1 January at 0 N 0 E.
TEST(ImportedPath, SunlightScatteredIntoAPathToSpace) {
  const std::string text =
      cards(3, 2,
            "   0.00000 100.00000   0.00000 100.00000   0.00000   0.00000    0        0.00000",
            "     833.0     900.0       1.0       2.0NW", "    1    2    1    0",
            "   0.00000   0.00000 -23.07000 359.19250  12.00000   0.00000   0.00000   0.00000",
            301.5) +
      "    FREQ  TOT_TRANS  PTH_THRML  THRML_SCT  SURF_EMIS   SOL_SCAT  SING_SCAT  GRND_RFLT  "
      "DRCT_RFLT  TOTAL_RAD  REF_SOL  SOL@OBS   DEPTH DIR_EM    TOA_SUN BBODY_T[K]\n" +
      table(833, 900, 1, [](double nu) {
        return absl::StrFormat(
            "%8.2f 0.43711221 6.0000E-06 3.4601E-08 0.0000E+00 2.0000E-06 2.4625E-10 1.0000E-06 "
            "0.0000E+00 9.0000E-06 7.81E-08 7.28E-08   0.828 1.0000 1.7785E-07    257.650\n",
            nu);
      });
  const auto paths = parse_imported_paths(text, "a");
  ASSERT_TRUE(paths.ok()) << paths.status();
  const ImportedPath& p = paths->path[0];
  EXPECT_TRUE(std::isinf(p.range_m) && std::isinf(p.target_height_m));
  EXPECT_EQ(p.latitude_deg, 0);
  EXPECT_EQ(p.longitude_deg, 0);
  EXPECT_EQ(p.day_of_year, 1);
  EXPECT_EQ(p.ground_temperature_k, 301.5);
  EXPECT_NEAR(p.sun_zenith_deg, 23.08, 0.01);
  EXPECT_NEAR(p.radiance_w_m2_sr_um[band_of(855)], 8e-6 * 855 * 855, 1e-4)
      << "thermal and all scattered sunlight, nothing from the ground";
  EXPECT_TRUE(find_path(*paths, 0, std::numeric_limits<double>::infinity(),
                        std::numeric_limits<double>::infinity())
                  .ok());
  EXPECT_FALSE(find_path(*paths, 0, 1e5, 1e5).ok());
}

TEST(ImportedPath, SunFromDayAndHourAlone) {
  const std::string text =
      cards(1, 1, kLevel, "      2000      2100         1         1", "    1    2  172    0",
            "  45.00000 230.00000   0.00000   0.00000   3.33333   0.00000   0.00000   0.00000") +
      kRadianceLabels + table(2000, 2100, 1, thermal_row);
  const auto paths = parse_imported_paths(text, "a");
  ASSERT_TRUE(paths.ok()) << paths.status();
  // 130 E, 03:20 UT: 12:00 local time at the solstice.
  EXPECT_NEAR(paths->path[0].longitude_deg, 130, 1e-9);
  EXPECT_NEAR(paths->path[0].sun_zenith_deg, 45 - 23.44, 0.1);
}

TEST(ImportedPath, DirectSunAtTheGround) {
  const std::string text =
      cards(3, 3, "   0.00000 100.00000  45.00000  172      0.00000    0   0.00000",
            "      2000      2100         5        20") +
      "  FREQ   TRANS     SOL TR  SOLAR\n" + table(2000, 2100, 5, [](double nu) {
        return absl::StrFormat("%7.0f%8.4f  2.00E-06 3.00E-06\n", nu, line_transmittance(nu));
      });
  const auto paths = parse_imported_paths(text, "a");
  ASSERT_TRUE(paths.ok()) << paths.status();
  const ImportedPath& p = paths->path[0];
  EXPECT_EQ(p.sun_zenith_deg, 45);
  EXPECT_EQ(p.day_of_year, 172);
  EXPECT_NEAR(p.sun_w_m2_um[band_of(2045)], 2e-6 * 2045 * 2045, 1e-3);
  EXPECT_TRUE(p.radiance_w_m2_sr_um.empty());
}

TEST(ImportedPath, WavelengthsInMicrometresAndNanometres) {
  for (const bool nanometres : {false, true}) {
    const std::string text =
        cards(1, 2, kLevel, "       8.0       9.0      0.01      0.01") +
        absl::StrFormat(
            " WAVLEN %s  TRANS  PTH THRML  THRML SCT  SURF EMIS   SOL SCAT  SING SCAT"
            "  GRND RFLT  DRCT RFLT  TOTAL RAD  REF SOL  SOL@OBS   DEPTH\n",
            nanometres ? "NM  " : "MCRN") +
        table(8, 9, 0.01, [&](double um) {
          // 8 W/(m2 sr um)
          return absl::StrFormat(
              "%12.6f %6.4f %.4E            0.0000E+00 1.0000E-15 4.9229E-03 0.0000E+00 0.0000E+00 "
              "1.0970E-02 6.22E-02 7.25E-02\n",
              nanometres ? 1e3 * um : um, (um - 8) / 2, nanometres ? 8.0 / 10 : 8.0 / 1e4);
        });
    const auto paths = parse_imported_paths(text, "a");
    ASSERT_TRUE(paths.ok()) << paths.status();
    EXPECT_NEAR(paths->path[0].radiance_w_m2_sr_um[band_of(1195)], 8, 1e-3);
    EXPECT_NEAR(paths->path[0].transmittance[band_of(1195)], (1e4 / 1195 - 8) / 2, 1e-3);
  }
}

TEST(ImportedPath, SlantPathsAreCompletedFromWhatTheirCardStates) {
  const auto path_of = [](const std::string& card3) {
    const auto paths =
        parse_imported_paths(cards(2, 1, card3, "      2000      2100         1         1") +
                                 kRadianceLabels + table(2000, 2100, 1, thermal_row),
                             "a");
    EXPECT_TRUE(paths.ok()) << paths.status();
    return paths->path[0];
  };
  // 1 km to 3 km at 60 deg: 3997 m on a sphere; the same by range, and by both heights.
  const ImportedPath by_angle =
      path_of("   1.00000   3.00000  60.00000   0.00000   0.000006371.22998    0");
  EXPECT_NEAR(by_angle.range_m, 3997.2, 1);
  const ImportedPath by_range = path_of(absl::StrFormat(
      "   1.00000   0.00000  60.00000%10.6f   0.000006371.22998    0", by_angle.range_m / 1e3));
  EXPECT_NEAR(by_range.target_height_m, 3000, 0.01);
  const ImportedPath by_heights = path_of(absl::StrFormat(
      "   1.00000   3.00000   0.00000%10.6f   0.000006371.22998    0", by_angle.range_m / 1e3));
  EXPECT_NEAR(by_heights.zenith_deg, 60, 1e-4);
  // Down: 10 km to the sea at 120 deg.
  const ImportedPath down =
      path_of("  10.00000   0.00000 120.00000   0.00000   0.000006371.22998    0");
  EXPECT_NEAR(down.range_m, 20047.3, 1);
  EXPECT_EQ(down.target_height_m, 0);
}

TEST(ImportedPath, SeveralRunsInAFile) {
  const std::string second =
      cards(1, 1, "   1.00000   0.00000   0.00000   2.00000   0.00000   0.00000    0",
            "      2000      2100         1         1") +
      kRadianceLabels + table(2000, 2100, 1, thermal_row);
  const auto paths = parse_imported_paths(kThermalRun + " -9999.\n" + second + " -9999.\n", "a");
  ASSERT_TRUE(paths.ok()) << paths.status();
  ASSERT_EQ(paths->path.size(), 2u);
  EXPECT_EQ(paths->path[1].line, 114u);
  EXPECT_EQ(*find_path(*paths, 1010, 990, 2030), &paths->path[1]);
  EXPECT_EQ(*find_path(*paths, 5000, 5000, 5000), &paths->path[0]);
  const auto none = find_path(*paths, 5000, 5000, 5200);
  ASSERT_EQ(none.status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(none.status().message()),
              HasSubstr("it covers 5000 m to 5000 m over 5000 m (line 1), 1000 m to 1000 m over"));
}

// Rationale: codes are run for level paths at the surface; ships are some metres high.
TEST(ImportedPath, ALevelPathStandsForLinesNearIt) {
  const auto paths = parse_imported_paths(
      "# observer_height_m: 0\n# target_height_m: 0\n# range_m: 5000\nlambda_um,transmittance\n"
      "4,0.5\n4.01,0.5\n4.02,0.5\n# observer_height_m: 10\n# target_height_m: "
      "space\nlambda_um,transmittance\n"
      "4,0.4\n4.01,0.4\n4.02,0.4\n",
      "a.csv");
  ASSERT_TRUE(paths.ok()) << paths.status();
  const auto found = find_path(*paths, 2.5, 6.4, 5010);
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(*found, &paths->path[0]);
  EXPECT_FALSE(find_path(*paths, 2.5, 40, 5000).ok());
  EXPECT_FALSE(find_path(*paths, 2.5, 6.4, 5200).ok());
  EXPECT_TRUE(std::isinf(paths->path[1].range_m) && std::isinf(paths->path[1].target_height_m));
  EXPECT_THAT(std::string(find_path(*paths, 500, 0, 5000).status().message()),
              HasSubstr("10 m to space (line 8)"));
}

TEST(ImportedPath, ErrorsNameLineAndColumn) {
  const auto message = [](std::string text) {
    const auto paths = parse_imported_paths(text, "x.tp7");
    EXPECT_FALSE(paths.ok());
    EXPECT_EQ(paths.status().code(), absl::StatusCode::kInvalidArgument);
    return std::string(paths.status().message());
  };
  const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  EXPECT_EQ(message(""), "x.tp7:1:1: the file is empty");
  EXPECT_THAT(message("T   2    1\n"), HasSubstr("x.tp7:1:1: no table follows"));
  EXPECT_THAT(message(kRadianceLabels + table(2000, 2020, 1, thermal_row)),
              HasSubstr("x.tp7:1:1: the cards of the run are not echoed"));
  // Rows: line 12 is 2000 cm-1. All errors are reported.
  std::string broken = replaced(kThermalRun, "2001.00 1.0000E-03", "2001.00 *.****E-**");
  broken = replaced(broken, "2003.00 3.0000E-03", "2003.00 1.3000E+00");
  broken = replaced(broken, " 2005.00", " 2002.00");
  EXPECT_EQ(message(broken),
            "x.tp7:13:10: \"*.****E-**\" is not a number\n"
            "x.tp7:15:10: transmittance 1.3: expected 0 to 1\n"
            "x.tp7:17:2: 2002 after 2004 cm-1: expected an axis that goes one way");
  EXPECT_THAT(message(replaced(kThermalRun, "T   2    1    1", "T   2    4    1")),
              HasSubstr("x.tp7:1:6: ITYPE 4: expected 1, 2 or 3"));
  EXPECT_THAT(message(replaced(kThermalRun, "   5.00000   0.02700 100.00000   5.00000",
                               "   5.00000   0.02700 100.00000   x.00000")),
              HasSubstr("x.tp7:6:31: \"x.00000\" is not a number"));
  EXPECT_THAT(message(replaced(kThermalRun, "TOT TRANS", "TOP TRINS")),
              HasSubstr("x.tp7:11:1: no column of transmittance"));
  EXPECT_THAT(
      message(
          cards(1, 1, kLevel, "      4000      4100         1         1") + kRadianceLabels +
          table(4000, 4100, 1,
                [](double nu) { return absl::StrFormat("%8.2f 1.0000E+00 0.0000E+00\n", nu); })),
      HasSubstr("x.tp7:1:1: covers none of the air's bands"));
}

TEST(ImportedPath, FortranNumbers) {
  double x = 0;
  EXPECT_TRUE(parse_fortran_number("1.25D-02", x) && x == 0.0125);
  EXPECT_TRUE(parse_fortran_number("1.25-102", x) && x == 1.25e-102);
  EXPECT_TRUE(parse_fortran_number("+3", x) && x == 3);
  EXPECT_TRUE(parse_fortran_number("7.8E-999", x) && x == 0);
  EXPECT_TRUE(parse_fortran_number("-9999.", x) && x == -9999);
  for (const char* bad : {"", "1.2.3", "NaN", "inf", "1e999", "1e38", "-1e300", "12 3", "0x10"}) {
    EXPECT_FALSE(parse_fortran_number(bad, x)) << bad;
  }
}

// A file as MODTRAN 4 writes it; its numbers are irsig's own.
TEST(ImportedPath, AFileOfASlantPathByDay) {
  const std::string name = IRSIG_SOURCE_DIR "/tests/unit/imported_paths/sea-5km.tape7";
  std::ifstream stream(name);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const auto paths = parse_imported_paths(text, name);
  ASSERT_TRUE(paths.ok()) << paths.status();
  const auto found = find_path(*paths, 20, 10, 5000);
  ASSERT_TRUE(found.ok()) << found.status();
  const ImportedPath& p = **found;
  EXPECT_NEAR(p.zenith_deg, 90.137, 1e-3);
  EXPECT_EQ(p.sun_zenith_deg, 50);
  EXPECT_EQ(p.day_of_year, 172);
  AtmosphereSpec spec{afgl_profile(AfglProfile::kMidlatitudeSummer), {}};
  spec.aerosol.kind = AerosolKind::kRural;
  spec.aerosol.visibility_m = 23e3;
  const Atmosphere air = *Atmosphere::make(spec);
  PathLight light;
  light.sun = SunPlace{50, 30};
  const PathRadiance ours = air.radiance(*look_between(air.profile(), 20, 10, 5000), light);
  double transmittance = 0, radiance = 0, of_radiance = 0;
  int count = 0;
  for (std::size_t b = band_of(845); b <= band_of(1245); ++b) {
    ++count;
    transmittance += p.transmittance[b] - ours.transmittance[b];
    radiance += p.radiance_w_m2_sr_um[b] - ours.total_w_m2_sr_um[b];
    of_radiance += ours.total_w_m2_sr_um[b];
  }
  // One sample a band: straight lines between them take each band's neighbours in.
  EXPECT_NEAR(transmittance / count, 0, 0.002);
  EXPECT_NEAR(radiance / of_radiance, 0, 0.002);
}

// ---- CSV

const std::string kCsv =
    "# Made by another code: a level path over the sea\n"
    "# observer_height_m: 20\n"
    "# target_height_m: 10\n"
    "# range_m: 5000\n"
    "# sun_zenith_deg: 60\n"
    "# latitude_deg: 25\n"
    "# longitude_deg: 130\n"
    "# day_of_year: 355\n"
    "# ground_temperature_k: 293\n"
    "lambda_um,transmittance,radiance_w_m2_sr_um\n"
    "9.00,0.50,4\n"
    "9.10,0.51,4\n"
    "9.20,0.52,4\n"
    "9.30,0.53,4\n";

TEST(ImportedPath, Csv) {
  const auto paths = parse_imported_paths(kCsv, "a.csv");
  ASSERT_TRUE(paths.ok()) << paths.status();
  const ImportedPath& p = paths->path[0];
  EXPECT_EQ(p.observer_height_m, 20);
  EXPECT_EQ(p.target_height_m, 10);
  EXPECT_EQ(p.range_m, 5000);
  EXPECT_EQ(p.day_of_year, 355);
  EXPECT_NEAR(p.transmittance[band_of(1095)], 0.5 + (1e4 / 1095 - 9) / 10, 1e-4);
  EXPECT_NEAR(p.radiance_w_m2_sr_um[band_of(1095)], 4, 1e-12);
  EXPECT_EQ(paths->path[0].line, 2u);
}

// Editors save text like this: fixed columns begin behind a byte order mark.
TEST(ImportedPath, MarksOfAnEncoding) {
  for (const std::string& text : {kThermalRun, std::string(kCsv)}) {
    const auto plain = parse_imported_paths(text, "a"),
               marked = parse_imported_paths("\xef\xbb\xbf" + text, "a");
    ASSERT_TRUE(plain.ok()) << plain.status();
    ASSERT_TRUE(marked.ok()) << marked.status();
    EXPECT_THAT(
        marked->path[0].transmittance,  // NaN where no band is covered
        ::testing::Pointwise(::testing::NanSensitiveDoubleEq(), plain->path[0].transmittance));
  }
  EXPECT_THAT(std::string(parse_imported_paths("\xff\xfe ", "a.tp7").status().message()),
              HasSubstr("a.tp7:1:1: this is text in UTF-16, expected UTF-8: save it as UTF-8"));
}

TEST(ImportedPath, CsvWithSeveralPathsPerWavenumber) {
  const std::string text =
      "# observer_height_m: 20\n# target_height_m: 10\n# range_m: 5000\n"
      "wavenumber_cm1, transmittance, radiance_w_cm2_sr_cm1\n1000, 0.5, 1e-6\n1020, 0.5, 1e-6\n"
      "# observer_height_m: 20\n# target_height_m: 10\n# range_m: 9000\n"
      "wavenumber_cm1, transmittance\n1000, 0.25\n1020, 0.25\n";
  const auto paths = parse_imported_paths(text, "a.csv");
  ASSERT_TRUE(paths.ok()) << paths.status();
  ASSERT_EQ(paths->path.size(), 2u);
  EXPECT_NEAR(paths->path[0].radiance_w_m2_sr_um[band_of(1005)], 1e-6 * 1005 * 1005, 2e-4);
  EXPECT_TRUE(paths->path[1].radiance_w_m2_sr_um.empty());
  EXPECT_EQ(paths->path[1].transmittance[band_of(1015)], 0.25);
}

TEST(ImportedPath, CsvErrors) {
  const auto replaced = [](const std::string& from, const std::string& to) {
    std::string text = kCsv;
    text.replace(text.find(from), from.size(), to);
    const auto paths = parse_imported_paths(text, "a.csv");
    return paths.ok() ? "" : std::string(paths.status().message());
  };
  EXPECT_EQ(replaced("# range_m: 5000\n", ""),
            "a.csv:9:1: no line \"# range_m: ...\" before the table: nothing says which line of "
            "sight it is");
  EXPECT_EQ(replaced("range_m: 5000", "range_m: far"),
            "a.csv:4:12: range_m: \"far\" is not a number\n"
            "a.csv:10:1: no line \"# range_m: ...\" before the table: nothing says which line of "
            "sight it is");
  EXPECT_EQ(replaced("latitude_deg: 25", "latitude_deg: 95"),
            "a.csv:6:17: latitude_deg 95: expected -90 to 90");
  EXPECT_EQ(replaced("latitude_deg", "lattitude_deg"), "a.csv:6:3: unknown key \"lattitude_deg\"");
  EXPECT_EQ(replaced("9.10,0.51,4", "9.10,1.51,4"), "a.csv:12:6: 1.51: expected 0 to 1");
  EXPECT_EQ(replaced("9.10,0.51,4", "9.10,0.51"), "a.csv:12:1: 2 fields, expected 3 as in line 10");
  EXPECT_EQ(replaced("9.10,0.51,4", "8.90,0.51,4"),
            "a.csv:13:1: 1086.96 after 1123.6 cm-1: expected an axis that goes one way");
  EXPECT_THAT(replaced("transmittance", "tau"), HasSubstr("a.csv:10:11: unknown column \"tau\""));
}

// ---- conditions

TEST(ImportedPath, ContradictionsNameBothValues) {
  const auto paths = parse_imported_paths(kCsv, "a.csv");
  ASSERT_TRUE(paths.ok());
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(check_conditions(*paths, {60.4, 25.05, -230.05, 293.9, 358}).ok());
  EXPECT_TRUE(check_conditions(*paths, {kNan, kNan, kNan, kNan, 0}).ok());
  const absl::Status wrong = check_conditions(*paths, {61, 25.2, 131, 295, 172});
  ASSERT_EQ(wrong.code(), absl::StatusCode::kFailedPrecondition);
  const std::string text(wrong.message());
  EXPECT_THAT(text,
              HasSubstr("a.csv:2:1: sun zenith 60 deg, but the sweep has 61 (may differ by 0.5)"));
  EXPECT_THAT(text, HasSubstr("latitude 25 deg, but the sweep has 25.2"));
  EXPECT_THAT(text, HasSubstr("longitude 130 deg, but the sweep has 131"));
  EXPECT_THAT(text, HasSubstr("ground temperature 293 K, but the sweep has 295"));
  EXPECT_THAT(text, HasSubstr("day of the year 355, but the sweep has 172"));
  EXPECT_THAT(std::string(check_conditions(*paths, {60, 25, 130, 293, 172}).message()),
              Not(HasSubstr("latitude")));
}

}  // namespace
}  // namespace irsig
