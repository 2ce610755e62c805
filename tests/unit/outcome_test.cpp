// Tests the words for requests of a sweep that were not met.
#include "view/report/outcome.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <string>

#include "core/accuracy/measured.h"
#include "tests/unit/fake_database.h"
#include "view/rows/measured_row.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

schema::Accuracy asked() {
  schema::Accuracy accuracy;
  accuracy.set_relative_error(0.002);
  accuracy.set_absolute_error_k(0.05);
  return accuracy;
}

TEST(Outcome, SaysHowManyRowsStoppedAtTheFloor) {
  StoredOutcome outcome;
  outcome.stop = {{"accuracy_reached", 1037}, {"accuracy_not_reached", 14}, {"floor_reached", 95}};
  EXPECT_EQ(stopped_text(outcome, asked()),
            "1037 of 1146 rows reach 0.2 %, 14 do not (accuracy_not_reached), 95 only the floor of "
            "0.05 K "
            "(floor_reached)");
  outcome.stop = {{"floor_reached", 6}};
  EXPECT_EQ(stopped_text(outcome, asked()),
            "0 of 6 rows reach 0.2 %, 6 only the floor of 0.05 K (floor_reached)");
}

TEST(Outcome, SaysNothingWhereAllWasReachedOrNothingAsked) {
  StoredOutcome outcome;
  outcome.stop = {{"accuracy_reached", 6}};
  EXPECT_THAT(stopped_text(outcome, asked()), IsEmpty());
  outcome.stop = {{"fixed_samples", 6}};
  EXPECT_THAT(stopped_text(outcome, schema::Accuracy()), IsEmpty());
  EXPECT_THAT(backface_text(outcome), IsEmpty());
}

TEST(Outcome, SaysByHowMuchImagesFallShort) {
  StoredOutcome outcome;
  outcome.image_error_relative = 0.0083;
  outcome.image_error_k = 0.25;
  schema::Image image;
  EXPECT_THAT(image_text(outcome, image), IsEmpty());
  image.set_pixel_error_percent(0.84);
  EXPECT_THAT(image_text(outcome, image), IsEmpty());
  image.set_pixel_error_percent(0.5);
  EXPECT_EQ(image_text(outcome, image),
            "pixels are known to 0.83 % in the worst case, 0.5 % was asked for; raise [image] "
            "max_samples");
  image.clear_pixel_error_percent();
  image.set_pixel_error_k(0.1);
  EXPECT_EQ(image_text(outcome, image),
            "pixels are known to 0.25 K in the worst case, 0.1 K was asked for; raise [image] "
            "max_samples");
}

StoredSignature missed(BoundOf which, double bound_w_sr) {
  FakeDatabase db = fake_database();
  StoredSignature row = db.signatures[0];
  row.stop_reason = "accuracy_not_reached";
  row.intensity_stderr_w_sr = 1;
  row.undersampling_stderr_w_sr = row.undersampling_bound_w_sr = row.quadrature_bound_w_sr =
      row.spectral_basis_bound_w_sr = row.direction_interpolation_bound_w_sr =
          row.omitted_bound_w_sr = row.truncation_bound_w_sr = row.temperature_bound_w_sr = 0;
  if (which == BoundOf::kTruncation) row.truncation_bound_w_sr = bound_w_sr;
  if (which == BoundOf::kTemperature) row.temperature_bound_w_sr = bound_w_sr;
  row.numerical_error_w_sr = std::hypot(1, bound_w_sr / std::sqrt(3));
  row.limiting_bound = limiting_part(source_of(row));
  return row;
}

TEST(Outcome, NamesWhatDecidesTheErrorOfRowsThatFallShort) {
  const StoredSignature cut = missed(BoundOf::kTruncation, 9),
                        warm = missed(BoundOf::kTemperature, 9),
                        noisy = missed(BoundOf::kTemperature, 1);
  StoredSignature reached = cut, old = cut;
  reached.stop_reason = "accuracy_reached";
  reached.limiting_bound.clear();
  old.superseded = true;
  EXPECT_THAT(limit_notes({reached, old}), IsEmpty());
  const auto notes = limit_notes({cut, warm, reached, warm, warm, noisy, noisy});
  ASSERT_EQ(notes.size(), 3U);
  EXPECT_THAT(notes[0], HasSubstr("3 rows do not reach the accuracy: temperatures of large facets "
                                  "(temperature); set [heat] element_size_m smaller"));
  EXPECT_THAT(notes[1],
              HasSubstr("2 rows do not reach the accuracy: scatter of the samples (sampling)"));
  EXPECT_THAT(notes[2], HasSubstr("1 row does not reach the accuracy: reflections after the last "
                                  "one (truncation); raise "
                                  "[transport] max_reflections"));
}

TEST(Outcome, CountsTheRowsOfOneSweepInADatabase) {
  FakeDatabase db = fake_database();
  std::map<std::string, int> rows;
  for (StoredSignature& row : db.signatures) {
    row.stop_reason = "sample_limit";
    row.limiting_bound = "sampling";
    ++rows[row.sweep];
  }
  ASSERT_FALSE(rows.empty());
  for (const auto& [sweep, count] : rows) {
    int counted = 0;
    const auto notes = limit_notes(db, sweep);
    ASSERT_TRUE(notes.ok()) << notes.status();
    for (const std::string& note : *notes) counted += std::stoi(note);
    EXPECT_EQ(counted, count) << sweep;
  }
}

// The few columns that are read of all rows have the whole rows' errors, in their order.
TEST(Outcome, ErrorsAreThoseOfWholeRows) {
  FakeDatabase db = fake_database();
  int n = 0;
  for (StoredSignature& row : db.signatures) {
    row.limiting_bound = ++n % 2 == 0 ? "" : "truncation";
    row.truncation_bound_w_sr = n;
    row.plume_bound_w_sr = n % 3 == 0 ? n : kNotComputed;
    row.temperature_bound_w_sr = 0.5 * n;
  }
  std::set<std::string> sweeps;
  for (const StoredSignature& row : db.signatures) sweeps.insert(row.sweep);
  StoreReader& reader = db;
  for (const std::string& sweep : sweeps) {
    SignatureFilter filter;
    filter.sweep = sweep;
    const auto rows = reader.find(filter);
    ASSERT_TRUE(rows.ok()) << rows.status();
    std::size_t next = 0;
    const absl::Status visited = reader.visit_errors(sweep, [&](const StoredSignature& few) {
      ASSERT_LT(next, rows->size());
      const StoredSignature& whole = (*rows)[next++];
      EXPECT_EQ(few.stop_reason, whole.stop_reason);
      EXPECT_EQ(few.limiting_bound, whole.limiting_bound);
      EXPECT_EQ(few.superseded, whole.superseded);
      EXPECT_EQ(few.intensity_w_sr, whole.intensity_w_sr);
      EXPECT_EQ(few.numerical_error_w_sr, whole.numerical_error_w_sr);
      const Measured of_few = source_of(few), of_whole = source_of(whole);
      EXPECT_EQ(of_few.sampled_fraction(), of_whole.sampled_fraction());
      EXPECT_EQ(of_few.unseen_fraction(), of_whole.unseen_fraction());
      for (std::size_t i = 0; i < kBounds; ++i)
        EXPECT_EQ(of_few.share(static_cast<BoundOf>(i)), of_whole.share(static_cast<BoundOf>(i)));
    });
    ASSERT_TRUE(visited.ok()) << visited;
    EXPECT_EQ(next, rows->size());
  }
}

// Whatever may limit a stored row has a meaning and a remedy of its own.
TEST(Outcome, EveryPartOfASourcesErrorHasARemedy) {
  std::set<std::string> texts;
  for (std::size_t i = 0; i < kBounds; ++i) {
    const auto which = static_cast<BoundOf>(i);
    if (which == BoundOf::kDepth || which == BoundOf::kBackground || which == BoundOf::kMoved)
      continue;  // no part of the intensity at the target
    const std::string text = limit_text(info_of(which).name, false);
    EXPECT_THAT(text, HasSubstr(" (" + std::string(info_of(which).name) + "); "));
    EXPECT_TRUE(texts.insert(text).second) << text;
  }
  EXPECT_THAT(limit_text(kLimitedBySampling, false), HasSubstr("relative_error"));
  EXPECT_THAT(limit_text(kLimitedBySampling, true), HasSubstr("max_samples_per_replicate"));
}

// More samples lower scatter, and no bound.
TEST(Outcome, RaisesTheLimitOfSamplesWhereSamplesDecide) {
  StoredSignature noisy = missed(BoundOf::kTemperature, 1), cut = missed(BoundOf::kTruncation, 9);
  const StoredSignature planned = noisy;
  noisy.stop_reason = cut.stop_reason = "sample_limit";
  const auto notes = limit_notes({noisy, noisy, noisy, planned, planned, cut});
  ASSERT_EQ(notes.size(), 3U);
  EXPECT_THAT(notes[0],
              HasSubstr("3 rows do not reach the accuracy: scatter of the samples (sampling); "
                        "raise [accuracy] max_samples_per_replicate"));
  EXPECT_THAT(notes[1],
              HasSubstr("2 rows do not reach the accuracy: scatter of the samples (sampling); "
                        "ask for a smaller relative_error"));
  EXPECT_THAT(notes[2], HasSubstr("(truncation); raise [transport] max_reflections"));
}

TEST(Outcome, WarnsOfBackFacesWithTheRemedy) {
  StoredOutcome outcome;
  outcome.backface_views = 3;
  outcome.largest_backface_fraction = 0.66;
  const std::string text = backface_text(outcome);
  for (const char* what : {"3 viewpoints", "66 %", "two_sided = true", "--repair"})
    EXPECT_THAT(text, HasSubstr(what));
}

TEST(Outcome, NotesOfAQueryNameTheFloor) {
  FakeDatabase db = fake_database();
  for (StoredSignature& s : db.signatures) s.stop_reason = "accuracy_reached";
  const auto rows = [&] { return *run_query(db, {.row = 1}); };
  EXPECT_THAT(*floor_notes(db, rows()), IsEmpty());
  for (StoredSignature& s : db.signatures)
    if (s.row == 1) s.stop_reason = "floor_reached";
  *db.sweeps[rows()[0].signature.sweep].resolved.mutable_sweep()->mutable_accuracy() = asked();
  const auto notes = *floor_notes(db, rows());
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_THAT(notes[0], HasSubstr("1 of 1 rows stopped at the floor of 0.05 K"));
  EXPECT_THAT(notes[0], HasSubstr("0.2 %"));
}

TEST(Outcome, NotesOfAQueryCountBackFacesOnce) {
  FakeDatabase db = fake_database();
  double share = 0.1;
  for (StoredSignature& s : db.signatures) {
    s.backface_fraction = 0;
    if (s.row > 4) continue;
    s.backface_fraction = share += 0.1;
    s.warning = "a warm sea";  // the back faces are said beside it
  }
  const auto notes = notes_on(*run_query(db, {}));
  std::size_t counted = 0;
  for (const std::string& note : notes)
    if (note.find("back faces") != std::string::npos) {
      ++counted;
      EXPECT_THAT(note, HasSubstr("4 of "));
      EXPECT_THAT(note, HasSubstr("up to 50 %"));
    }
  EXPECT_EQ(counted, 1U);
}

}  // namespace
}  // namespace irsig
