// The ledger of effects and the energy of a signature: what goes in comes out, with the names of
// the core, and what is not known stays apart from what is absent.

#include <cmath>

#include "core/effects/effects.h"
#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

class StoreLedger : public ::testing::Test {
 protected:
  void write() {
    auto writer = StoreWriter::open(path_).value();
    ASSERT_OK(submit(*writer, sweep_, "sweep-a").status());
    ASSERT_OK(complete_jobs(*writer, sweep_).status());
    ASSERT_OK(writer->finish());
  }

  TestFolder folder_;
  std::string path_ = folder_.file("a.sigdb");
  schema::ResolvedSweep sweep_ = make_sweep({});
};

void expect_same(bool known, double sent, double stored) {
  if (known)
    EXPECT_EQ(stored, sent);
  else
    EXPECT_TRUE(std::isnan(stored)) << stored;
}

TEST_F(StoreLedger, ComesBackWithWhatIsNotKnown) {
  ASSERT_NO_FATAL_FAILURE(write());
  auto reader = StoreReader::open(path_).value();
  const auto found = reader->find({}).value();
  std::size_t n = 0;
  for (const schema::JobSpec& job : make_jobs(sweep_, "sweep-a")) {
    const schema::JobResult result = make_result(sweep_, job);
    for (const schema::SignatureRow& row : result.view().row()) {
      const auto ledger = reader->ledger(found[n++].signature_id);
      ASSERT_OK(ledger.status());
      ASSERT_EQ(ledger->effect.size(), kEffects);
      for (std::size_t i = 0; i < kEffects; ++i) {
        const schema::EffectEntry& sent = row.effect(static_cast<int>(i));
        const StoredEffect& stored = ledger->effect[i];
        EXPECT_EQ(stored.effect, sent.effect());
        EXPECT_EQ(stored.state, sent.state() == schema::EFFECT_STATE_ON    ? "on"
                                : sent.state() == schema::EFFECT_STATE_OFF ? "off"
                                                                           : "absent");
        EXPECT_EQ(stored.reason, sent.reason());
        expect_same(sent.has_bound_w_sr(), sent.bound_w_sr(), stored.bound_w_sr);
        expect_same(sent.has_apparent_bound_w_sr(), sent.apparent_bound_w_sr(),
                    stored.apparent_bound_w_sr);
        expect_same(sent.has_contrast_bound_w_sr(), sent.contrast_bound_w_sr(),
                    stored.contrast_bound_w_sr);
        expect_same(sent.has_fraction_w_sr(), sent.fraction_w_sr(), stored.fraction_w_sr);
        expect_same(sent.has_time_s(), sent.time_s(), stored.time_s);
      }
      ASSERT_TRUE(ledger->energy.has_value());
      EXPECT_EQ(ledger->energy->absorbed, row.energy().absorbed().value());
      EXPECT_EQ(ledger->energy->escaped_to_sky_stderr, row.energy().escaped_to_sky().stderr());
      EXPECT_EQ(ledger->energy->escaped_to_surface, row.energy().escaped_to_surface().value());
      EXPECT_EQ(ledger->energy->cut_off_stderr, row.energy().cut_off().stderr());
      EXPECT_EQ(ledger->energy->balance, row.energy().balance().value());
      EXPECT_EQ(ledger->energy->balance_stderr, row.energy().balance().stderr());
    }
  }
  EXPECT_EQ(n, 16U);
  EXPECT_TRUE(absl::IsNotFound(reader->ledger(4711).status()));
}

// A new effect or reason of the core needs a line of create.sql: this test notices it.
TEST_F(StoreLedger, KnowsTheNamesOfTheCore) {
  ASSERT_NO_FATAL_FAILURE(write());
  for (std::size_t i = 0; i < kEffects; ++i)
    EXPECT_EQ(sqlite_text(path_, absl::StrCat("SELECT name FROM effect WHERE effect = ", i + 1)),
              effect_table()[i].name);
  for (std::size_t i = 0; i < kPlumeEffects; ++i)
    EXPECT_EQ(sqlite_text(
                  path_, absl::StrCat("SELECT name FROM effect WHERE effect = ", kEffects + i + 1)),
              plume_effect_table()[i].name);
  EXPECT_EQ(sqlite_text(path_, "SELECT name FROM effect WHERE of_cloud = 1"),
            cloud_effect_table()[0].name);
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM effect"),
            absl::StrCat(kEffects + kPlumeEffects + kCloudEffects));
  const auto last = static_cast<int>(EffectReason::kNotAsked);
  for (int reason = 0; reason <= last; ++reason)
    EXPECT_EQ(sqlite_text(path_, absl::StrCat("SELECT name FROM effect_reason WHERE reason = ",
                                              reason + 1)),
              name_of(static_cast<EffectReason>(reason)));
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM effect_reason"), absl::StrCat(last + 1));
  for (int state = 0; state <= static_cast<int>(EffectState::kAbsent); ++state)
    EXPECT_EQ(
        sqlite_text(path_, absl::StrCat("SELECT name FROM effect_state WHERE state = ", state + 1)),
        name_of(static_cast<EffectState>(state)));
}

TEST_F(StoreLedger, IsReadableByPeople) {
  ASSERT_NO_FATAL_FAILURE(write());
  EXPECT_EQ(sqlite_text(path_,
                        "SELECT l.state || ' ' || l.reason FROM ledger_view l"
                        " JOIN signature_view s USING (signature_id)"
                        " WHERE s.row = 7 AND l.effect = 'direct_sun'"),
            "off within_fraction");
  EXPECT_EQ(sqlite_text(path_, "SELECT reflections FROM signature_view WHERE row = 7"), "3");
}

// The user's word needs no bound, nor what is in another's; and where nothing is seen there is no
// energy.
TEST_F(StoreLedger, WhatMayBeMissing) {
  auto writer = StoreWriter::open(path_).value();
  ASSERT_OK(submit(*writer, sweep_, "sweep-a").status());
  ASSERT_OK(writer->begin());
  const QueuedJob job = writer->lease_next("w", 0).value().value();
  schema::JobResult result = make_result(sweep_, job.spec);
  schema::SignatureRow& row = *result.mutable_view()->mutable_row(0);
  row.mutable_effect(1)->set_reason("forced");
  row.mutable_effect(1)->clear_bound_w_sr();
  row.mutable_effect(7)->set_state(schema::EFFECT_STATE_OFF);  // hot parts: with inter_reflection
  row.clear_energy();
  row.mutable_projected_area_m2()->set_value(0);
  ASSERT_OK(writer->complete(job.fencing_token, result, "w"));
  ASSERT_OK(writer->commit());
  ASSERT_OK(writer->finish());
  auto reader = StoreReader::open(path_).value();
  const StoredLedger ledger = reader->ledger(reader->find({})->front().signature_id).value();
  EXPECT_EQ(ledger.effect[1].reason, "forced");
  EXPECT_TRUE(std::isnan(ledger.effect[1].bound_w_sr));
  EXPECT_EQ(ledger.effect[7].effect, "hot_parts_reflected");
  EXPECT_EQ(ledger.effect[7].state, "off");
  EXPECT_TRUE(std::isnan(ledger.effect[7].bound_w_sr));
  EXPECT_FALSE(ledger.energy.has_value());
}

// A row under a cloud has one entry more; it is off with a bound, and not twice there.
TEST_F(StoreLedger, HasACloudWhereARowHasOne) {
  auto writer = StoreWriter::open(path_).value();
  ASSERT_OK(submit(*writer, sweep_, "sweep-a").status());
  ASSERT_OK(writer->begin());
  const QueuedJob job = writer->lease_next("w", 0).value().value();
  const schema::JobResult made = make_result(sweep_, job.spec);
  const auto completed = [&](int entries, bool bounded) {
    schema::JobResult result = made;
    schema::SignatureRow& row = *result.mutable_view()->mutable_row(0);
    for (int i = 0; i < entries; ++i) {
      schema::EffectEntry& cloud = *row.add_effect();
      cloud = row.effect(1);
      cloud.set_effect("cloud");
      cloud.set_state(schema::EFFECT_STATE_OFF);
      cloud.set_reason("within_fraction");
      if (!bounded) cloud.clear_contrast_bound_w_sr();
    }
    return writer->complete(job.fencing_token, result, "w");
  };
  EXPECT_THAT(std::string(completed(1, false).message()),
              testing::HasSubstr("(cloud) is off without a bound"));
  EXPECT_THAT(std::string(completed(2, true).message()),
              testing::HasSubstr("is there twice: cloud"));
  ASSERT_OK(completed(1, true));
  ASSERT_OK(writer->commit());
  ASSERT_OK(writer->finish());
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM ledger_view WHERE effect = 'cloud'"), "1");
}

TEST_F(StoreLedger, GoesWithItsRow) {
  ASSERT_NO_FATAL_FAILURE(write());
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM ledger"), absl::StrCat(16 * kEffects));
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM energy"), "16");
  SweepShape warmer;
  warmer.hull_temperature_k = 300;  // every job is stale
  sweep_ = make_sweep(warmer);
  auto writer = StoreWriter::open(path_).value();
  ASSERT_OK(submit(*writer, sweep_, "sweep-b").status());
  ASSERT_OK(complete_jobs(*writer, sweep_).status());
  ASSERT_OK(writer->finish());
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM ledger"), absl::StrCat(16 * kEffects));
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM energy"), "16");
  EXPECT_EQ(sqlite_text(path_,
                        "SELECT count(*) FROM ledger"
                        " WHERE signature_id NOT IN (SELECT signature_id FROM signature)"),
            "0");
}

}  // namespace
}  // namespace irsig
