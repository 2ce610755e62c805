// Every number of a sweep file and of a goniometer's has limits, they hold, and the pages say them.
#include "jobs/text/number_bounds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "schema/detector.pb.h"
#include "schema/goniometer.pb.h"
#include "schema/imager.pb.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using ::testing::HasSubstr;

bool is_number(const FieldDescriptor& field) {
  return field.cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE &&
         field.cpp_type() != FieldDescriptor::CPPTYPE_STRING &&
         field.cpp_type() != FieldDescriptor::CPPTYPE_BOOL;
}

// The tables of a file in which each numeric key stands, by "Message.field".
using Tables = std::map<std::string, std::vector<std::string>>;
void collect(const Descriptor& message, const std::string& path, Tables& out) {
  for (int i = 0; i < message.field_count(); ++i) {
    const FieldDescriptor& field = *message.field(i);
    const FieldDescriptor& value = field.is_map() ? *field.message_type()->map_value() : field;
    if (is_number(value)) {
      out[absl::StrCat(message.name(), ".", field.name())].push_back(path);
    } else if (!field.is_map() && field.message_type() != nullptr) {
      collect(*field.message_type(),
              path.empty() ? field.name() : absl::StrCat(path, ".", field.name()), out);
    }
  }
}

TEST(NumberBounds, EveryNumberHasARowAndEveryRowANumber) {
  Tables expected;
  collect(*schema::Sweep::descriptor(), "", expected);
  collect(*schema::Goniometer::descriptor(), "", expected);
  collect(*schema::DetectorFile::descriptor(), "", expected);
  collect(*schema::ImagerFile::descriptor(), "", expected);
  collect(*schema::ResolvedSweep::descriptor(), "", expected);
  std::set<std::string> rows;
  for (const NumberBounds& row : number_bounds()) {
    EXPECT_TRUE(rows.insert(std::string(row.key)).second) << row.key << " twice";
    EXPECT_TRUE(expected.contains(std::string(row.key))) << row.key << " is no number of a file";
    EXPECT_TRUE(std::isfinite(row.least) && row.least < row.most) << row.key;
    EXPECT_GT(row.reason.size(), 5U) << row.key;
  }
  for (const auto& [key, tables] : expected)
    EXPECT_TRUE(rows.contains(key)) << key << " has no row in jobs/text/number_bounds.cpp";
}

// A message with this one number, wherever it can stand: as a value, in a list, in a map.
void set_number(google::protobuf::Message& message, const FieldDescriptor& field, double value) {
  const google::protobuf::Reflection& r = *message.GetReflection();
  if (field.is_map()) {
    google::protobuf::Message* entry = r.AddMessage(&message, &field);
    entry->GetReflection()->SetString(entry, field.message_type()->map_key(), "x");
    return set_number(*entry, *field.message_type()->map_value(), value);
  }
  const bool list = field.is_repeated();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return list ? r.AddDouble(&message, &field, value) : r.SetDouble(&message, &field, value);
    case FieldDescriptor::CPPTYPE_UINT32: {
      const auto whole = static_cast<std::uint32_t>(value);
      return list ? r.AddUInt32(&message, &field, whole) : r.SetUInt32(&message, &field, whole);
    }
    default: {
      const auto whole = value >= 18446744073709551615.0 ? std::numeric_limits<std::uint64_t>::max()
                                                         : static_cast<std::uint64_t>(value);
      return list ? r.AddUInt64(&message, &field, whole) : r.SetUInt64(&message, &field, whole);
    }
  }
}

void for_each_number(const std::function<void(const Descriptor&, const FieldDescriptor&)>& what) {
  for (const NumberBounds& row : number_bounds()) {
    const std::string key(row.key);
    const Descriptor* message =
        schema::Sweep::descriptor()->file()->FindMessageTypeByName(key.substr(0, key.find('.')));
    if (message == nullptr)
      message = schema::Goniometer::descriptor()->file()->FindMessageTypeByName(
          key.substr(0, key.find('.')));
    if (message == nullptr)
      message = schema::DetectorFile::descriptor()->file()->FindMessageTypeByName(
          key.substr(0, key.find('.')));
    if (message == nullptr)
      message = schema::ImagerFile::descriptor()->file()->FindMessageTypeByName(
          key.substr(0, key.find('.')));
    if (message == nullptr)
      message = schema::ResolvedSweep::descriptor()->file()->FindMessageTypeByName(
          key.substr(0, key.find('.')));
    ASSERT_NE(message, nullptr) << key;
    what(*message, *message->FindFieldByName(key.substr(key.find('.') + 1)));
  }
}

// The findings of a message of this type with this one number.
std::string found(const Descriptor& type, const FieldDescriptor& field, double value) {
  const auto* prototype =
      google::protobuf::MessageFactory::generated_factory()->GetPrototype(&type);
  const std::unique_ptr<google::protobuf::Message> message(prototype->New());
  // The others that are always there.
  for (int i = 0; i < type.field_count(); ++i)
    if (const FieldDescriptor& other = *type.field(i);
        is_number(other) && !other.is_repeated() && !other.has_presence())
      set_number(*message, other, bounds_of(absl::StrCat(type.name(), ".", other.name())).least);
  set_number(*message, field, value);
  SweepFile file;
  file.file_name = "s.toml";
  Findings findings(file);
  check_numbers(*message, "here", findings);
  return std::string(findings.status().message());
}

TEST(NumberBounds, LimitsAreIncludedAndWhatIsBeyondThemIsRefused) {
  for_each_number([](const Descriptor& type, const FieldDescriptor& field) {
    const std::string key = absl::StrCat(type.name(), ".", field.name());
    const NumberBounds& row = bounds_of(key);
    EXPECT_EQ(found(type, field, row.least), "") << key;
    EXPECT_EQ(found(type, field, row.most), "") << key;
    const FieldDescriptor& value = field.is_map() ? *field.message_type()->map_value() : field;
    const bool whole = value.cpp_type() != FieldDescriptor::CPPTYPE_DOUBLE;
    constexpr double kFar = std::numeric_limits<double>::infinity();
    const auto refused = [&](double beyond) {
      EXPECT_THAT(found(type, field, beyond), HasSubstr(text_of(row))) << key << " " << beyond;
    };
    if (!whole) {
      refused(std::nextafter(row.least, -kFar));
      refused(std::nextafter(row.most, kFar));
      refused(std::nan(""));
    } else {
      if (row.least > 0) refused(row.least - 1);
      if (row.most < 1e19) refused(row.most + 1);
    }
  });
}

TEST(NumberBounds, ARefusalSaysWhereAndWhy) {
  const auto refused = [](const std::string& text) {
    const auto sweep = resolved_text(text);
    return std::string(sweep.status().message());
  };
  const std::string page =
      text_of(std::filesystem::path(IRSIG_SOURCE_DIR) / "docs/reference/sweep-file.md");
  const std::size_t first = page.find("```toml\n") + 8;
  const std::string smallest = page.substr(first, page.find("```\n", first) - first);
  ASSERT_TRUE(resolved_text(smallest).ok());
  for (const char* range : {"1e10", "1e18", "1e20", "1e154", "1e308", "0", "-1", "1e-154"}) {
    const std::string text =
        absl::StrReplaceAll(smallest, {{"range_m = 1000", absl::StrCat("range_m = ", range)}});
    EXPECT_THAT(refused(text), HasSubstr("s.toml:30:1: viewpoints.range_m = ")) << range;
    EXPECT_THAT(refused(text), HasSubstr(text_of(bounds_of("Viewpoints.range_m")))) << range;
  }
  // The number stands in a map, in a list and in a list of tables.
  EXPECT_THAT(refused("[[season]]\nname = \"a\"\npart_temperature_k = { hull = 1e30 }\n"),
              HasSubstr("s.toml:3:24: season[0].part_temperature_k.hull = 1e+30, expected a "
                        "number from 0 to 20000 (Planck's law is verified there)"));
  EXPECT_THAT(refused("[viewpoints]\nazimuth_deg = [0, 400]\n"),
              HasSubstr("s.toml:2:19: viewpoints.azimuth_deg[1] = 400, expected"));
  EXPECT_THAT(refused("[[viewpoints.aspect]]\nrange_m = 1e10\n"),
              HasSubstr("s.toml:2:1: viewpoints.aspect[0].range_m = 1e+10, expected"));
}

// The lines of a page's table of limits: "| [viewpoints] `range_m` | 0.001 | 1e+09 | why |". What a
// goniometer's file shares with a sweep is on the sweep's page.
std::string limits_of(const Descriptor& root) {
  Tables tables;
  collect(root, "", tables);
  std::string lines;
  for (const NumberBounds& row : number_bounds()) {
    const std::string key(row.key);
    const std::string message = key.substr(0, key.find('.'));
    if (!tables.contains(key) || root.file()->FindMessageTypeByName(message) == nullptr) continue;
    std::string where;
    for (const std::string& table : tables[key])
      absl::StrAppend(&where, where.empty() ? "" : ", ",
                      table.empty() ? "top level" : absl::StrCat("[", table, "]"));
    absl::StrAppend(&lines, "| ", where, " `", key.substr(message.size() + 1), "` | ",
                    number_text(row.least), " | ", number_text(row.most), " | ",
                    std::string(row.reason), " |\n");
  }
  return lines;
}

std::string limits_on(const char* page_name) {
  const std::string page = text_of(std::filesystem::path(IRSIG_SOURCE_DIR) / page_name);
  const std::string header = "| Key | Least | Most | Reason |\n|---|---|---|---|\n";
  const std::size_t first = page.find(header);
  if (first == std::string::npos) return "no table of limits";
  const std::string rest = page.substr(first + header.size());
  return rest.substr(0, rest.find("|\n\n") + 2);
}

TEST(NumberBounds, ArePrintedInTheDocumentation) {
  EXPECT_EQ(limits_on("docs/reference/goniometer.md"),
            limits_of(*schema::Goniometer::descriptor()));
  EXPECT_EQ(limits_on("docs/reference/bands.md"), limits_of(*schema::DetectorFile::descriptor()));
  EXPECT_EQ(limits_on("docs/reference/imager.md"), limits_of(*schema::ImagerFile::descriptor()));
}

}  // namespace
}  // namespace irsig
