// Every list of a sweep has a bound, every bound a list; and too much is refused by file and by
// message alike.
#include "jobs/text/size_bounds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "absl/strings/str_cat.h"
#include "schema/job.pb.h"

namespace irsig {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using ::testing::HasSubstr;

void collect_sizes(const Descriptor& message, std::map<std::string, const FieldDescriptor*>& lists,
                   std::set<std::string>& texts) {
  for (int i = 0; i < message.field_count(); ++i) {
    const FieldDescriptor& field = *message.field(i);
    const std::string key = absl::StrCat(message.name(), ".", field.name());
    if (field.is_repeated() && !lists.emplace(key, &field).second) continue;
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_STRING) texts.insert(key);
    if (!field.is_map() && field.message_type() != nullptr)
      collect_sizes(*field.message_type(), lists, texts);
  }
}

TEST(SizeBounds, EveryListHasARowAndEveryRowAListOrAText) {
  std::map<std::string, const FieldDescriptor*> lists;
  std::set<std::string> texts, rows;
  collect_sizes(*schema::ResolvedSweep::descriptor(), lists, texts);
  for (const SizeBound& row : size_bounds()) {
    EXPECT_TRUE(rows.insert(std::string(row.key)).second) << row.key << " twice";
    EXPECT_TRUE(lists.contains(std::string(row.key)) || texts.contains(std::string(row.key)))
        << row.key;
    EXPECT_GT(row.most, 0U) << row.key;
  }
  for (const auto& [key, field] : lists)
    EXPECT_TRUE(rows.contains(key)) << key << " has no row in jobs/text/size_bounds.cpp";
}

// Each list and each text takes as many as the bound, and not one more.
TEST(SizeBounds, TheBoundIsTheLastThatIsTaken) {
  const SweepFile no_file;
  const auto found = [&](const schema::ResolvedSweep& sweep) {
    Findings findings(no_file);
    check_sizes(sweep, "", findings);
    return findings.status();
  };
  schema::ResolvedSweep sweep;
  for (int i = 0; i < 1000; ++i) sweep.mutable_sweep()->add_material();
  EXPECT_TRUE(found(sweep).ok());
  sweep.mutable_sweep()->add_material();
  EXPECT_THAT(std::string(found(sweep).message()),
              HasSubstr("sweep.material has 1001 elements, expected at most 1000"));
  sweep.Clear();
  sweep.mutable_sweep()->add_part()->set_name(std::string(kLongestName, 'x'));
  EXPECT_TRUE(found(sweep).ok());
  sweep.mutable_sweep()->mutable_part(0)->mutable_name()->push_back('x');
  EXPECT_THAT(std::string(found(sweep).message()),
              HasSubstr("sweep.part[0].name has 1001 bytes, expected at most 1000"));
  sweep.Clear();
  sweep.add_condition()->mutable_weather()->set_profile_csv(std::string(2000, 'x'));
  EXPECT_TRUE(found(sweep).ok());
}

TEST(SizeBounds, RowsAreCounted) {
  const SweepFile no_file;
  schema::ResolvedSweep sweep;
  for (int i = 0; i < 1000; ++i) sweep.add_viewpoint();
  for (int i = 0; i < 50000; ++i) sweep.add_condition();
  for (int i = 0; i < 2; ++i) sweep.mutable_sweep()->add_band();
  Findings most(no_file), more(no_file), profiles(no_file);
  check_row_count(sweep, most);
  EXPECT_TRUE(most.empty());
  sweep.add_viewpoint();
  check_row_count(sweep, more);
  EXPECT_THAT(std::string(more.status().message()), HasSubstr("split the sweep"));
  schema::ResolvedSweep line;
  schema::Profile& profile = *line.mutable_sweep()->add_profile();
  profile.set_points(100000);
  for (std::uint32_t i = 0; i < 11; ++i) profile.add_reflections(i);
  check_row_count(line, profiles);
  EXPECT_THAT(std::string(profiles.status().message()), HasSubstr("1.1e+06 rows"));
}

}  // namespace
}  // namespace irsig
