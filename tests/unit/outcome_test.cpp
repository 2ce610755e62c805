// What a sweep asked for and did not get, in words.
#include "view/report/outcome.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/fake_database.h"

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
