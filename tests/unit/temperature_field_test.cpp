// Rationale: temperatures of facets come from files of other programs, in other units, by index or
// by place. A value at the wrong facet, in the wrong unit or at the wrong time is a lie that no
// later check can see. Expected: CSV and PLY (text, both binary orders) give the same temperatures;
// whatever cannot be meant is refused with its line. Source: written out by hand.
#include "core/fields/temperature_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <string>

#include "core/geo/sun.h"

namespace irsig {
namespace {

using testing::HasSubstr;

// Two triangles of a unit square in the plane z = 0, in centimetres.
FieldMesh square() {
  return {{{0, 0, 0}, {100, 0, 0}, {100, 100, 0}, {0, 100, 0}}, {{0, 1, 2}, {0, 2, 3}}, 0.01};
}
FieldImport kelvin(FieldMatch match = FieldMatch::kIndex) {
  return {"t.csv", TemperatureUnit::kKelvin, match, 0.1, 0.5};
}
TemperatureField read(const std::string& text, const FieldImport& how) {
  auto field = read_temperature_field(text, how, square());
  EXPECT_TRUE(field.ok()) << field.status();
  return field.ok() ? *std::move(field) : TemperatureField{};
}
std::string refused(const std::string& text, const FieldImport& how) {
  const auto field = read_temperature_field(text, how, square());
  EXPECT_FALSE(field.ok());
  return std::string(field.status().message());
}

TEST(TemperatureField, ByIndexInEveryUnit) {
  const TemperatureField k = read("facet,temperature\n1,310\n0,290.5\n", kelvin());
  ASSERT_TRUE(k.at_all_times);
  EXPECT_FLOAT_EQ(k.at[0].kelvin[0], 290.5F);
  EXPECT_FLOAT_EQ(k.at[0].kelvin[1], 310);
  EXPECT_FLOAT_EQ(k.at[0].error_k[1], 0.5F);
  FieldImport how = kelvin();
  how.unit = TemperatureUnit::kCelsius;
  EXPECT_FLOAT_EQ(
      read("# of a camera\nfacet,temperature,error\n0,20,1\n1,0,2\n", how).at[0].kelvin[0],
      293.15F);
  how.unit = TemperatureUnit::kFahrenheit;
  const TemperatureField f = read("facet,temperature,error\n0,68,1.8\n1,32,0\n", how);
  EXPECT_FLOAT_EQ(f.at[0].kelvin[0], 293.15F);
  EXPECT_FLOAT_EQ(f.at[0].error_k[0], 1);
  EXPECT_FLOAT_EQ(f.at[0].kelvin[1], 273.15F);
  EXPECT_EQ(f.at[0].error_k[1], 0);
}

TEST(TemperatureField, ByPlace) {
  // Centroids are at (66.7, 33.3) and (33.3, 66.7) cm; 5 cm beside the first.
  const std::string rows = "x,y,z,temperature\n33.3,66.7,0,300\n66.7,38.3,0,280\n";
  const TemperatureField field = read(rows, kelvin(FieldMatch::kCentroid));
  EXPECT_FLOAT_EQ(field.at[0].kelvin[0], 280);
  EXPECT_FLOAT_EQ(field.at[0].kelvin[1], 300);
  FieldImport near = kelvin(FieldMatch::kCentroid);
  near.max_distance_m = 0.04;
  EXPECT_TRUE(std::isnan(read(rows, near).at[0].kelvin[0])) << "too far away";
  EXPECT_FLOAT_EQ(read(rows, near).at[0].kelvin[1], 300);
}

TEST(TemperatureField, AVertexCountsForItsFacets) {
  const TemperatureField field = read("vertex,temperature\n0,290\n1,300\n2,310\n3,290\n", kelvin());
  EXPECT_FLOAT_EQ(field.at[0].kelvin[0], 300);
  EXPECT_NEAR(field.at[0].error_k[0], 10.5, 1e-4) << "what its corners differ from it, and theirs";
  EXPECT_FLOAT_EQ(field.at[0].kelvin[1], 890.0F / 3);
}

TEST(TemperatureField, BetweenTimes) {
  const TemperatureField field = read(
      "facet,time,temperature\n"
      "0,2025-06-21T12:00:00Z,300\n1,2025-06-21T12:00:00Z,300\n"
      "0,2025-06-21T15:00:00+02:00,308\n1,2025-06-21T15:00:00+02:00,300\n",
      kelvin());
  ASSERT_FALSE(field.at_all_times);
  ASSERT_EQ(field.unix_s.size(), 2u);
  EXPECT_EQ(field.unix_s[1] - field.unix_s[0], 3600);
  const auto quarter = at_time(field, field.unix_s[0] + 900);
  ASSERT_TRUE(quarter.ok());
  EXPECT_FLOAT_EQ(quarter->kelvin[0], 302);
  EXPECT_FLOAT_EQ(quarter->error_k[0], 0.5F + 8.0F * 3 / 16);
  EXPECT_FLOAT_EQ(quarter->error_k[1], 0.5F);
  EXPECT_FLOAT_EQ(at_time(field, field.unix_s[1])->kelvin[0], 308);
  EXPECT_FALSE(at_time(field, field.unix_s[0] - 1).ok());
  EXPECT_FALSE(at_time(field, field.unix_s[1] + 1).ok());
}

// Returns the field in PLY: a float property of vertices or faces.
std::string ply(const std::string& format, bool of_faces) {
  const bool big = format == "binary_big_endian";
  std::string out = "ply\nformat " + format +
                    " 1.0\ncomment from elsewhere\nelement vertex 4\nproperty float x\nproperty "
                    "float y\nproperty float z\n" +
                    (of_faces ? "" : "property float temperature\n") +
                    "element face 2\nproperty list uchar int vertex_indices\n" +
                    (of_faces ? "property double temperature\nproperty float error\n" : "") +
                    "end_header\n";
  const auto put = [&](auto value) {
    if (format == "ascii") {
      out += std::to_string(value) + " ";
      return;
    }
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
    if (big) bytes.assign(bytes.rbegin(), bytes.rend());
    out += bytes;
  };
  const float at[4][3] = {{0, 0, 0}, {100, 0, 0}, {100, 100, 0}, {0, 100, 0}};
  const float of_vertex[4] = {290, 300, 310, 290};
  const int corner[2][3] = {{0, 1, 2}, {0, 2, 3}};
  for (int v = 0; v < 4; ++v) {
    for (const float x : at[v]) put(x);
    if (!of_faces) put(of_vertex[v]);
  }
  for (int f = 0; f < 2; ++f) {
    put(static_cast<unsigned char>(3));
    for (const int c : corner[f]) put(c);
    if (of_faces) {
      put(f == 0 ? 281.5 : 299.25);
      put(0.25F);
    }
  }
  return out;
}

TEST(TemperatureField, PlyInItsForms) {
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"})
    for (const FieldMatch match : {FieldMatch::kIndex, FieldMatch::kCentroid}) {
      FieldImport how = kelvin(match);
      how.file_name = "t.ply";
      const TemperatureField faces = read(ply(format, true), how);
      ASSERT_EQ(faces.at.size(), 1u) << format;
      EXPECT_FLOAT_EQ(faces.at[0].kelvin[0], 281.5F);
      EXPECT_FLOAT_EQ(faces.at[0].kelvin[1], 299.25F);
      EXPECT_FLOAT_EQ(faces.at[0].error_k[0], 0.25F);
      const TemperatureField vertices = read(ply(format, false), how);
      ASSERT_EQ(vertices.at.size(), 1u);
      EXPECT_FLOAT_EQ(vertices.at[0].kelvin[0], 300);
    }
  FieldImport how = kelvin();
  how.file_name = "t.ply";
  const std::string whole = ply("binary_little_endian", true);
  EXPECT_THAT(refused(whole.substr(0, whole.size() - 3), how), HasSubstr("cut short"));
}

TEST(TemperatureField, WhatCannotBeMeant) {
  const FieldImport how = kelvin();
  EXPECT_THAT(
      refused("facet,temperature\n0,20\n1,300\n", how),
      HasSubstr("t.csv:2:1: temperature = 20 is 20 K, expected 100 to 5000 K: is it in degC?"));
  FieldImport celsius = how;
  celsius.unit = TemperatureUnit::kCelsius;
  EXPECT_THAT(refused("facet,temperature\n0,-200\n", celsius), HasSubstr("expected 100 to 5000 K"));
  EXPECT_THAT(refused("facet,temperature\n0,300\n0,301\n", how),
              HasSubstr("t.csv:3:1: facet 0 has two temperatures at one time"));
  EXPECT_THAT(refused("facet,temperature\n2,300\n", how),
              HasSubstr("facet 2: the model has 2, counted from 0"));
  EXPECT_THAT(refused("facet,temperature\n-1,300\n", how),
              HasSubstr("expected a whole number from 0"));
  EXPECT_THAT(refused("facet,temperature\n0,nan\n", how),
              HasSubstr("t.csv:2:3: temperature = \"nan\""));
  EXPECT_THAT(refused("facet,temprature\n0,300\n", how), HasSubstr("t.csv:1:7: unknown column"));
  EXPECT_THAT(refused("temperature\n300\n", how), HasSubstr("nothing says where"));
  EXPECT_THAT(refused("x,y,temperature\n0,0,300\n", how), HasSubstr("places need x, y and z"));
  EXPECT_THAT(refused("x,y,z,temperature\n0,0,0,300\n", how),
              HasSubstr("no column facet or vertex"));
  EXPECT_THAT(refused("facet,temperature\n0,300\n", kelvin(FieldMatch::kCentroid)),
              HasSubstr("no columns x, y, z"));
  EXPECT_THAT(refused("facet,temperature\n0,300,1\n", how), HasSubstr("3 cells, expected 2"));
  EXPECT_THAT(refused("facet,temperature,time\n0,300,12:00\n", how), HasSubstr("t.csv:2:7:"));
  EXPECT_THAT(refused("facet,temperature,error\n0,300,-1\n", how), HasSubstr("an error below 0"));
  EXPECT_THAT(refused("facet,temperature,error\n0,300,299.5\n", how), HasSubstr("leaves nothing"));
  EXPECT_THAT(refused("", how), HasSubstr("there is no header"));
  EXPECT_THAT(refused("facet,temperature\n", how), HasSubstr("there are no values"));
  FieldImport without = how;
  without.error_k.reset();
  EXPECT_THAT(refused("facet,temperature\n0,300\n", without), HasSubstr("no error is stated"));
  FieldImport other = how;
  other.file_name = "t.xlsx";
  EXPECT_THAT(refused("", other), HasSubstr("read from .csv and .ply"));
}

TEST(TemperatureField, UnixSeconds) {
  EXPECT_EQ(unix_seconds(*parse_rfc3339("1970-01-01T00:00:00Z")), 0);
  EXPECT_EQ(unix_seconds(*parse_rfc3339("2024-02-29T23:59:59.5+01:00")), 1709247599.5);
  EXPECT_EQ(unix_seconds(*parse_rfc3339("2016-12-31T23:59:60Z")),
            unix_seconds(*parse_rfc3339("2017-01-01T00:00:00Z")));
}

}  // namespace
}  // namespace irsig
