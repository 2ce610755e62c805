// The question a user asks and the table it is answered with.
#include "view/query/query.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "fake_database.h"
#include "view/base/quantity.h"
#include "view/query/query_table.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> out;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) out.push_back(cell);
  return out;
}

std::string printed(StoreReader& db, const Query& query, const QueryContent& content,
                    std::string_view format) {
  auto rows = run_query(db, query);
  EXPECT_TRUE(rows.ok()) << rows.status();
  std::ostringstream out;
  const absl::Status status = write_rows(db, *rows, content, format, out);
  EXPECT_TRUE(status.ok()) << status;
  return out.str();
}

// Scripts rely on these names and this order.
constexpr const char* kFixedColumns =
    "row,sweep,season,time_utc,band,aspect_azimuth_deg,aspect_elevation_deg,range_m,intensity_w_sr,"
    "intensity_stderr_w_sr,numerical_error_w_sr,projected_area_m2,projected_area_stderr_m2,"
    "source_radiance_temperature_k";

TEST(Query, FiltersBySeasonBandAndTimeOfAnyOffset) {
  FakeDatabase db = fake_database();
  auto rows = run_query(db, {.season = "summer", .band = "lwir"});
  ASSERT_TRUE(rows.ok());
  EXPECT_EQ(rows->size(), 191U);
  auto same = run_query(db, {.band = "lwir", .time = "2025-06-21T10:30:00+09:00"});
  ASSERT_TRUE(same.ok()) << same.status();
  ASSERT_EQ(same->size(), 191U);
  EXPECT_EQ((*same)[7].signature.row, (*rows)[7].signature.row);
}

TEST(Query, SeveralSeasonsGiveTheRowsOfEach) {
  FakeDatabase db = fake_database();
  const auto rows_of = [&](NameSet season) {
    const auto rows = run_query(db, {.season = std::move(season), .band = "lwir"});
    EXPECT_TRUE(rows.ok()) << rows.status();
    std::set<std::uint64_t> out;
    for (const QueryRow& row : *rows) out.insert(row.signature.row);
    EXPECT_EQ(out.size(), rows->size());
    return out;
  };
  const auto several = [](std::vector<std::string> names) { return NameSet(std::move(names)); };
  std::set<std::uint64_t> each = rows_of("summer");
  const std::set<std::uint64_t> winter = rows_of("winter");
  each.insert(winter.begin(), winter.end());
  EXPECT_EQ(each.size(), 382U);
  EXPECT_EQ(rows_of(several({"summer", "winter"})), each);
  EXPECT_EQ(rows_of(several({"winter", "summer", "winter"})), each);
  EXPECT_EQ(rows_of(several({"winter"})), winter);
  EXPECT_EQ(rows_of(several({})).size(), 573U);
  // The second statement, which finds rows by their viewpoint.
  const auto near = run_query(db, {.season = several({"summer", "winter"}),
                                   .band = "lwir",
                                   .aspect = SignatureFilter::Direction{90, 20},
                                   .nearest = 1});
  ASSERT_TRUE(near.ok()) << near.status();
  ASSERT_EQ(near->size(), 2U);
  EXPECT_EQ((*near)[0].signature.season, "winter");  // in the order of the sweep
  EXPECT_EQ((*near)[1].signature.season, "summer");
}

TEST(Query, EachOfSeveralSeasonsMustExist) {
  FakeDatabase db = fake_database();
  const NameSet season(std::vector<std::string>{"summer", "wintr"});
  for (const Query& query : {Query{.season = season}, Query{.season = season,
                                                      .band = "lwir",
                                                      .aspect = SignatureFilter::Direction{90, 20},
                                                      .interpolate = true}}) {
    const absl::Status said = run_query(db, query).status();
    EXPECT_EQ(said.code(), absl::StatusCode::kNotFound);
    EXPECT_THAT(
        std::string(said.message()),
        HasSubstr("no season \"wintr\" in this database; there is: spring, summer, winter"));
  }
  // A name is compared, not read as a part of the list.
  for (const char* name : {"summer\", \"winter", "summer,winter", "%", "[]", "\xff"})
    EXPECT_TRUE(absl::IsNotFound(run_query(db, {.season = name}).status())) << name;
}

TEST(Query, ANameInOtherLettersIsTold) {
  FakeDatabase db = fake_database();
  EXPECT_THAT(std::string(run_query(db, {.season = "Summer"}).status().message()),
              HasSubstr("did you mean \"summer\"?"));
  EXPECT_THAT(std::string(run_query(db, {.band = "LWIR"}).status().message()),
              HasSubstr("did you mean \"lwir\"?"));
  EXPECT_THAT(std::string(run_query(db, {.season = "somer"}).status().message()),
              testing::Not(HasSubstr("did you mean")));
}

TEST(Query, SomeOfItsRowsAreSpreadOverAll) {
  FakeDatabase db = fake_database();
  const Query query{.season = "summer", .band = "lwir"};
  const auto all = run_query(db, query);
  ASSERT_TRUE(all.ok());
  const auto rows_of = [&](std::size_t at_most) {
    const auto some = run_query_of_some(db, query, at_most);
    EXPECT_TRUE(some.ok()) << some.status();
    EXPECT_EQ(some->matching, 191U);
    std::vector<std::uint64_t> out;
    for (const QueryRow& row : some->rows) out.push_back(row.signature.row);
    return out;
  };
  EXPECT_EQ(rows_of(191).size(), 191U);
  EXPECT_EQ(rows_of(5000).size(), 191U);
  const std::vector<std::uint64_t> some = rows_of(60);
  ASSERT_EQ(some.size(), 60U);
  EXPECT_EQ(rows_of(60), some);
  EXPECT_TRUE(std::is_sorted(some.begin(), some.end()));
  // Both halves give as many rows, but for chance.
  const auto first = std::count_if(
      some.begin(), some.end(), [&](std::uint64_t row) { return row < (*all)[95].signature.row; });
  EXPECT_NEAR(static_cast<double>(first), 30, 12);
  EXPECT_TRUE(absl::IsNotFound(run_query_of_some(db, {.season = "autumn"}, 60).status()));
}

TEST(Query, NearestAndWithin) {
  FakeDatabase db = fake_database();
  Query query{.season = "winter", .band = "mwir", .aspect = SignatureFilter::Direction{90, 20}};
  query.nearest = 3;
  auto nearest = run_query(db, query);
  ASSERT_TRUE(nearest.ok());
  EXPECT_EQ(nearest->size(), 3U);
  query.nearest = 0;
  query.within_deg = 30;
  auto within = run_query(db, query);
  ASSERT_TRUE(within.ok());
  EXPECT_GT(within->size(), 15U);
  EXPECT_EQ(within->front().signature.row, nearest->front().signature.row);
}

TEST(Query, UnknownNamesListTheKnownOnes) {
  FakeDatabase db = fake_database();
  auto season = run_query(db, {.season = "autumn"});
  EXPECT_EQ(season.status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(season.status().message()),
              HasSubstr("no season \"autumn\" in this database; there is: spring, summer, winter"));
  auto band = run_query(db, {.season = "winter", .band = "swir"});
  EXPECT_THAT(std::string(band.status().message()), HasSubstr("there is: lwir, mwir"));
  auto time = run_query(db, {.time = "2025-06-21T10:30:00Z"});
  EXPECT_THAT(std::string(time.status().message()), HasSubstr("2025-06-21T01:30:00Z"));
  auto row = run_query(db, {.row = 5000});
  EXPECT_THAT(std::string(row.status().message()), HasSubstr("the last one is 1146"));
}

TEST(Query, RefusesWhatMakesNoSense) {
  FakeDatabase db = fake_database();
  const SignatureFilter::Direction bow{0, 10};
  for (const Query& query :
       {Query{.aspect = bow}, Query{.nearest = 2}, Query{.interpolate = true},
        Query{.aspect = bow, .nearest = 2, .interpolate = true},
        Query{.aspect = SignatureFilter::Direction{0, 95}, .nearest = 1},
        Query{.time = "2025-06-21T10:30:00"}, Query{.aspect = bow, .within_deg = 0},
        Query{.max_relative_error = 0}, Query{.aspect = bow, .interpolate = true, .row = 3}}) {
    EXPECT_EQ(run_query(db, query).status().code(), absl::StatusCode::kInvalidArgument);
  }
}

TEST(Query, NoMatchIsNoErrorAndPrintsTheHeaderOnly) {
  FakeDatabase db = fake_database();
  const std::string csv = printed(db, {.max_relative_error = 1e-9}, {}, "csv");
  ASSERT_EQ(lines(csv).size(), 1U);
  EXPECT_THAT(csv, StartsWith(kFixedColumns));
  EXPECT_EQ(printed(db, {.max_relative_error = 1e-9}, {}, "json"), "[]\n");
  FakeDatabase empty;
  EXPECT_TRUE(run_query(empty, {.season = "winter"}).ok());
}

TEST(Query, CsvGivesBackTheSameDoubles) {
  FakeDatabase db = fake_database();
  const auto csv = lines(printed(db, {.row = 700}, {}, "csv"));
  ASSERT_EQ(csv.size(), 2U);
  EXPECT_THAT(csv[0], StartsWith(kFixedColumns));
  const auto head = cells(csv[0]), row = cells(csv[1]);
  EXPECT_EQ(row[0], "700");
  for (std::size_t i = 0; i < head.size(); ++i) {
    if (head[i] == "intensity_w_sr") {
      EXPECT_EQ(std::stod(row[i]), db.signatures[699].intensity_w_sr);
    }
    if (head[i] == "aspect_azimuth_deg") {
      EXPECT_EQ(std::stod(row[i]), db.signatures[699].aspect_azimuth_deg);
    }
  }
}

TEST(Query, NamesWithCommasAndQuotesAreEscaped) {
  FakeDatabase db = fake_database();
  for (auto& s : db.signatures) s.sweep = "ship \"A\", grey\n";
  EXPECT_THAT(printed(db, {.row = 1}, {}, "csv"), HasSubstr("1,\"ship \"\"A\"\", grey\n\",winter"));
  EXPECT_THAT(printed(db, {.row = 1}, {}, "json"),
              HasSubstr("\"sweep\": \"ship \\\"A\\\", grey\\u000a\""));
}

TEST(Query, SpectrumHasOneLinePerWavelength) {
  FakeDatabase db = fake_database();
  const auto csv = lines(printed(db, {.row = 2}, {.spectrum = true}, "csv"));
  ASSERT_EQ(csv.size(), 1U + 9);
  EXPECT_THAT(
      csv[0],
      StartsWith(std::string(kFixedColumns) +
                 ",lambda_um,spectral_intensity_w_sr_um,spectral_intensity_stderr_w_sr_um"));
  EXPECT_EQ(cells(csv[1])[14], "8");
  EXPECT_EQ(std::stof(cells(csv[9])[15]),
            db.spectra.at(db.signatures[1].signature_id).spectral_intensity_w_sr_um(8));
  const auto causes = lines(printed(db, {.row = 2}, {.spectrum = true, .causes = true}, "csv"));
  EXPECT_THAT(causes[0], HasSubstr("spectral_sun_reflected_w_sr_um"));
}

TEST(Query, PartsAddUp) {
  FakeDatabase db = fake_database();
  const auto csv = lines(printed(db, {.row = 2}, {.parts = true}, "csv"));
  ASSERT_EQ(csv.size(), 3U);
  EXPECT_NEAR(std::stod(cells(csv[1])[15]) + std::stod(cells(csv[2])[15]),
              db.signatures[1].intensity_w_sr, 1e-9 * db.signatures[1].intensity_w_sr);
}

TEST(Query, NoProjectedAreaHasNoTemperature) {
  FakeDatabase db = fake_database();
  db.signatures[0].source_radiance_temperature_k = 0;
  const auto csv = lines(printed(db, {.row = 1}, {}, "csv"));
  EXPECT_EQ(cells(csv[1])[13], "");
  EXPECT_THAT(printed(db, {.row = 1}, {}, "json"),
              HasSubstr("\"source_radiance_temperature_k\": null"));
}

TEST(Query, InterpolatesEverySeasonAndBand) {
  FakeDatabase db = fake_database();
  Query query{.aspect = SignatureFilter::Direction{-60, 25}, .interpolate = true};
  auto rows = run_query(db, query);
  ASSERT_TRUE(rows.ok()) << rows.status();
  ASSERT_EQ(rows->size(), 6U);
  const double truth = box_ship_w_sr(body_from_aspect(-60, 25));
  for (const QueryRow& r : *rows) {
    const StoredSignature& s = r.signature;
    EXPECT_EQ(s.aspect_azimuth_deg, 300);
    const double season = s.season == "winter" ? 1 : s.season == "spring" ? 1.2 : 1.45;
    const double expected = truth * season * (s.band == "lwir" ? 1 : 0.25);
    EXPECT_NEAR(s.intensity_w_sr, expected, 3 * s.numerical_error_w_sr);
    EXPECT_GE(s.numerical_error_w_sr, r.interpolation->interpolation_error_w_sr);
    EXPECT_LT(s.numerical_error_w_sr, 0.05 * expected);
    EXPECT_NEAR(s.emitted_w_sr + s.sun_reflected_w_sr, s.intensity_w_sr, 1e-6 * s.intensity_w_sr);
    // Parts and spectrum have the row's own weights: they add up to it.
    auto parts = parts_of(db, r);
    ASSERT_TRUE(parts.ok());
    ASSERT_EQ(parts->size(), 2U);
    EXPECT_NEAR((*parts)[0].part.intensity_w_sr + (*parts)[1].part.intensity_w_sr, s.intensity_w_sr,
                1e-9 * s.intensity_w_sr);
    auto spectrum = spectrum_of(db, r);
    ASSERT_TRUE(spectrum.ok());
    const auto& values = spectrum->spectrum.spectral_intensity_w_sr_um();
    double integral = 0;
    for (int k = 0; k + 1 < values.size(); ++k) integral += 0.25 * (values[k] + values[k + 1]);
    EXPECT_NEAR(integral, s.intensity_w_sr, 1e-5 * s.intensity_w_sr);
    EXPECT_EQ(spectrum->spectral_interpolation_error_w_sr_um.size(),
              static_cast<std::size_t>(values.size()));
    EXPECT_GT(spectrum->spectral_interpolation_error_w_sr_um[0], 0);
  }
  const auto csv = lines(printed(db, query, {}, "csv"));
  ASSERT_EQ(csv.size(), 7U);
  EXPECT_THAT(csv[1], StartsWith(",box ship,winter"));
  EXPECT_THAT(csv[0], HasSubstr("interpolation_error_w_sr,viewpoints_used"));
}

TEST(Query, RefusesToExtrapolate) {
  FakeDatabase db = fake_database();
  auto rows = run_query(db, {.aspect = SignatureFilter::Direction{30, -20}, .interpolate = true});
  EXPECT_EQ(rows.status().code(), absl::StatusCode::kOutOfRange);
  EXPECT_THAT(std::string(rows.status().message()),
              HasSubstr("cannot interpolate at aspect 30,-20 deg"));
}

TEST(Query, InterpolationNeverMixesRanges) {
  FakeDatabase db = fake_database();
  FakeDatabase far = fake_database();
  for (auto& s : far.signatures) {
    s.range_m = 20000;
    s.intensity_w_sr *= 2;
    db.signatures.push_back(s);
  }
  Query query{.season = "winter",
              .band = "lwir",
              .aspect = SignatureFilter::Direction{60, 25},
              .interpolate = true};
  auto rows = run_query(db, query);
  ASSERT_TRUE(rows.ok());
  ASSERT_EQ(rows->size(), 2U);
  EXPECT_NEAR((*rows)[1].signature.intensity_w_sr, 2 * (*rows)[0].signature.intensity_w_sr,
              0.01 * (*rows)[1].signature.intensity_w_sr);
}

TEST(Table, TextHasUnitsAndAlignedColumns) {
  FakeDatabase db = fake_database();
  const auto text = lines(printed(db, {.season = "winter"}, {}, "text"));
  ASSERT_EQ(text.size(), 4U + 191 * 2);
  EXPECT_THAT(text[2], HasSubstr("[W/sr]"));
  EXPECT_THAT(text[2], HasSubstr("[K]"));
  for (const auto& line : text) EXPECT_LE(line.size(), text[3].size());
}

TEST(Quantity, UnitsComeFromTheSuffix) {
  EXPECT_EQ(quantity_of("spectral_intensity_stderr_w_sr_um").noun, "spectral intensity stderr");
  EXPECT_EQ(quantity_of("spectral_intensity_stderr_w_sr_um").cf_unit, "W sr-1 um-1");
  EXPECT_EQ(quantity_of("conductivity_w_m_k").unit, "W/(m K)");
  EXPECT_EQ(quantity_of("density_kg_m3").unit, "kg/m3");
  EXPECT_EQ(quantity_of("specific_heat_j_kg_k").cf_unit, "J kg-1 K-1");
  EXPECT_EQ(quantity_of("background_radiance_w_m2_sr").unit, "W/(m2 sr)");
  EXPECT_EQ(quantity_of("projected_area_m2").unit, "m2");
  EXPECT_EQ(quantity_of("range_m").unit, "m");
  EXPECT_EQ(quantity_of("samples").unit, "");
  EXPECT_EQ(quantity_of("samples").cf_unit, "1");
  EXPECT_EQ(quantity_of("lambda_um").noun, "lambda");
}

TEST(Query, OfOneRangeAmongSeveral) {
  FakeDatabase db = fake_database();
  for (std::size_t i = 0; i < db.signatures.size(); i += 2) db.signatures[i].range_m = 3000;
  const auto found = run_query(db, {.at_range_m = 3000});
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->size(), (db.signatures.size() + 1) / 2);
  for (const QueryRow& row : *found) EXPECT_EQ(row.signature.range_m, 3000);
  EXPECT_THAT(std::string(run_query(db, {.at_range_m = 4000}).status().message()),
              HasSubstr("no viewpoint at 4000 m in this database; there is: 3000, "));
}

TEST(Query, TheErrorIsThatOfTheQuantityAskedFor) {
  FakeDatabase db = fake_database();
  const auto all = run_query(db, {.season = "winter", .band = "lwir"});
  const auto contrast = run_query(db, {.season = "winter",
                                       .band = "lwir",
                                       .quantity = SignatureQuantity::kContrastIntensity,
                                       .max_relative_error = 0.01});
  ASSERT_TRUE(contrast.ok()) << contrast.status();
  EXPECT_LT(contrast->size(), all->size());
  EXPECT_GT(contrast->size(), 50U);
  for (const QueryRow& r : *contrast)
    EXPECT_LE(r.signature.contrast_numerical_error_w_sr,
              0.01 * std::abs(r.signature.contrast_intensity_w_sr));
}

TEST(Query, SortsByAnyColumn) {
  FakeDatabase db = fake_database();
  db.signatures[3].contrast_intensity_w_sr = kNotComputed;
  auto rows = run_query(db, {.season = "winter", .band = "lwir"});
  ASSERT_TRUE(rows.ok());
  ASSERT_TRUE(sort_rows(*rows, "contrast_intensity_w_sr", false).ok());
  EXPECT_LT(rows->front().signature.contrast_intensity_w_sr, 0);
  for (std::size_t i = 1; i < rows->size(); ++i)
    EXPECT_LE((*rows)[i - 1].signature.contrast_intensity_w_sr,
              (*rows)[i].signature.contrast_intensity_w_sr);
  rows = run_query(db, {.row = 4});
  const auto more = run_query(db, {.row = 2});
  rows->push_back((*more)[0]);
  for (const bool descending : {false, true}) {
    ASSERT_TRUE(sort_rows(*rows, "contrast_intensity_w_sr", descending).ok());
    EXPECT_EQ(rows->back().signature.row, 4U) << "a row without the value comes last";
  }
  ASSERT_TRUE(sort_rows(*rows, "row", true).ok());
  EXPECT_EQ(rows->front().signature.row, 4U);
  EXPECT_THAT(std::string(sort_rows(*rows, "beauty", false).message()), HasSubstr("background_"));
}

TEST(Query, WhatWasNotComputedIsNoNumber) {
  FakeDatabase db = fake_database();
  db.signatures[0].contrast_intensity_w_sr = kNotComputed;
  db.signatures[0].guarded_negative.reset();
  db.signatures[1].guarded_negative = 0;
  db.signatures[0].warning = "the sea is warmer than the air\nand so on";
  const std::string json = printed(db, {.row = 1}, {}, "json");
  EXPECT_THAT(json, HasSubstr("\"contrast_intensity_w_sr\": null"));
  EXPECT_THAT(json, HasSubstr("\"guarded_negative\": null"));
  EXPECT_THAT(printed(db, {.row = 2}, {}, "json"), HasSubstr("\"guarded_negative\": 0"));
  const auto notes = notes_on(*run_query(db, {.season = "winter"}));
  ASSERT_EQ(notes.size(), 3U);
  EXPECT_THAT(notes[0], HasSubstr("winter 2025-12-21T01:30:00Z: the sea is warmer"));
  EXPECT_THAT(notes[2], HasSubstr("1 of 382 rows were stored by an older irsig"));
}

TEST(Query, ATableForPeopleShowsTheQuantityAskedFor) {
  FakeDatabase db = fake_database();
  const std::string source = printed(db, {.row = 1}, {}, "text");
  EXPECT_EQ(source.find("contrast"), std::string::npos);
  QueryContent content;
  content.quantity = SignatureQuantity::kContrastIntensity;
  const std::string contrast = printed(db, {.row = 1}, content, "text");
  EXPECT_THAT(contrast, HasSubstr("contrast"));
  content.spectrum = true;
  EXPECT_THAT(printed(db, {.row = 1}, content, "text"), HasSubstr("contrast spectral"));
}

TEST(Query, InterpolatesASignedContrast) {
  FakeDatabase db = fake_database();
  const auto at = [&](double azimuth_deg) {
    auto rows = run_query(db, {.season = "winter",
                               .band = "lwir",
                               .aspect = SignatureFilter::Direction{azimuth_deg, 20},
                               .interpolate = true});
    EXPECT_TRUE(rows.ok()) << rows.status();
    return rows->front();
  };
  EXPECT_LT(at(10).signature.contrast_intensity_w_sr, 0);
  EXPECT_GT(at(170).signature.contrast_intensity_w_sr, 0);
  const QueryRow row = at(91);
  const Vec<Body> d = body_from_aspect(91, 20);
  EXPECT_NEAR(row.signature.contrast_intensity_w_sr, -0.2 * d.x * box_ship_w_sr(d),
              3 * row.signature.contrast_numerical_error_w_sr);
  const auto spectrum = spectrum_of(db, row);
  ASSERT_TRUE(spectrum.ok());
  EXPECT_EQ(spectrum->spectrum.contrast_spectral_intensity_w_sr_um_size(), 9);
  EXPECT_NEAR(spectrum->spectrum.path_transmittance(3), 0.8, 1e-6);
}

}  // namespace
}  // namespace irsig
