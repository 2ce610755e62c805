// The size of a message is known from its bytes, before it is parsed.
#include "schema/wire_size.h"

#include <gtest/gtest.h>

#include "schema/job.pb.h"
#include "schema/result.pb.h"

namespace irsig {
namespace {

template <class Message>
bool fits(const Message& message, double of_what_it_takes) {
  const std::string bytes = message.SerializeAsString();
  Message there;
  EXPECT_TRUE(there.ParseFromString(bytes));
  const auto most =
      static_cast<std::uint64_t>(static_cast<double>(there.SpaceUsedLong()) * of_what_it_takes);
  return check_wire_size(bytes, *Message::descriptor(), most).ok();
}

TEST(WireSize, IsWhatProtobufTakesToAFactorOfTwo) {
  schema::ResolvedSweep sweep;
  for (int i = 0; i < 10000; ++i) sweep.mutable_sweep()->add_material();
  EXPECT_TRUE(fits(sweep, 2));
  EXPECT_FALSE(fits(sweep, 0.5));
  for (int i = 0; i < 10000; ++i) {
    schema::Viewpoint& v = *sweep.add_viewpoint();
    v.set_range_m(i);
    sweep.mutable_sweep()->add_season()->set_name("a name that is longer than sixteen bytes");
    (*sweep.mutable_sweep()->mutable_season(i)->mutable_part_temperature_k())["hull"] = 300;
    sweep.mutable_sweep()->mutable_viewpoints()->add_azimuth_deg(i);
  }
  EXPECT_TRUE(fits(sweep, 2));
  EXPECT_FALSE(fits(sweep, 0.5));
  schema::JobResult result;
  for (int i = 0; i < 1000; ++i) {
    schema::SignatureRow& row = *result.mutable_view()->add_row();
    row.mutable_intensity_w_sr()->set_value(1);
    for (int k = 0; k < 500; ++k) row.mutable_spectrum()->add_emitted_w_sr_um(1);
  }
  EXPECT_TRUE(fits(result, 2));
  EXPECT_FALSE(fits(result, 0.5));
}

TEST(WireSize, EmptyMessagesAreNotFree) {
  std::string rows;
  for (int i = 0; i < 1000000; ++i) rows += std::string("\x0a\0", 2);
  EXPECT_TRUE(absl::IsResourceExhausted(
      check_wire_size(rows, *schema::ViewJobResult::descriptor(), 256 << 20)));
  EXPECT_TRUE(
      check_wire_size(rows.substr(0, 20000), *schema::ViewJobResult::descriptor(), 256 << 20).ok());
}

TEST(WireSize, WhatIsNoMessageOfTheTypeIsRefused) {
  const auto& type = *schema::ResolvedSweep::descriptor();
  for (const std::string& bytes :
       {std::string("hello"), std::string("\xff\xff\xff\xff\xff"), std::string("\x0a\x7f"),
        std::string("\x0a\x05\x0a\x64xyz"), std::string("\0", 1), std::string("\x0b\x0c"),
        std::string("\xfa\x3f\x01x")})
    EXPECT_TRUE(absl::IsInvalidArgument(check_wire_size(bytes, type, 1 << 20)))
        << check_wire_size(bytes, type, 1 << 20);
  EXPECT_TRUE(check_wire_size("", type, 1 << 20).ok());
}

}  // namespace
}  // namespace irsig
