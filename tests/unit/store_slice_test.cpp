// A slice: some rows of a database, by itself a database like any other.

#include <gmock/gmock.h>

#include <map>
#include <set>

#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "schema/store/whole/examine.h"
#include "schema/store/whole/slice.h"
#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kPhysics = 1;  // of the fixture's results

class StoreSlice : public ::testing::Test {
 protected:
  void SetUp() override {
    write(path_, sweep_);
    ASSERT_FALSE(HasFatalFailure());
  }
  static void complete(StoreWriter& writer, const schema::ResolvedSweep& sweep, int& done) {
    ASSERT_OK(writer.begin());
    for (;; ++done) {
      const auto job = writer.lease_next("w", 100);
      ASSERT_OK(job.status());
      if (!job->has_value()) break;
      const schema::JobSpec& spec = (*job)->spec;
      ASSERT_OK(writer.complete((*job)->fencing_token,
                                spec.has_heat() ? make_heat_result(sweep, spec, heat_k(sweep, spec))
                                                : make_result(sweep, spec),
                                "h"));
    }
    ASSERT_OK(writer.commit());
  }
  // Each run leaves another field.
  static float heat_k(const schema::ResolvedSweep& sweep, const schema::JobSpec& spec) {
    return sweep.heat(static_cast<int>(spec.heat().heat())).season() == "winter" ? 270 : 300;
  }
  // Submits and computes what is missing; how many jobs that was.
  static int write(const std::string& path, const schema::ResolvedSweep& sweep) {
    int done = 0;
    auto writer = StoreWriter::open(path).value();
    const std::string sha256 = "sha of " + sweep.sweep().name();
    EXPECT_TRUE(writer->begin().ok());
    const auto added = writer->add_sweep(sweep, sha256, make_heat_jobs(sweep, sha256), {});
    EXPECT_TRUE(added.ok()) << added.status();
    EXPECT_TRUE(writer->commit().ok());
    complete(*writer, sweep, done);
    EXPECT_TRUE(writer->finish().ok());
    return done;
  }

  std::string slice(const SignatureFilter& filter, const std::string& name,
                    const std::string& from = "") {
    const auto sliced =
        slice_database(from.empty() ? path_ : from, {filter, "--what", false}, folder_.file(name));
    EXPECT_TRUE(sliced.ok()) << sliced.status();
    if (!sliced.ok()) return "";
    last_ = *sliced;
    EXPECT_EQ(digest(folder_.file(name)), sliced->digest);
    EXPECT_THAT(findings(folder_.file(name)), IsEmpty());
    return sliced->digest;
  }
  static std::string digest(const std::string& path) {
    return StoreReader::open(path).value()->digest().value();
  }
  static std::vector<std::string> findings(const std::string& path) {
    std::vector<std::string> out;
    const auto found = examine(path, kPhysics);
    EXPECT_TRUE(found.ok()) << found.status();
    for (const StoreFinding& f : *found)
      // The fixture's numbers are no physics, and its images are none.
      if (f.what.find("causes do not add up") == std::string::npos &&
          f.what.find("no PNG or no EXR") == std::string::npos)
        out.push_back(f.what);
    return out;
  }
  // All that is stored of each row, by what it is of.
  static std::map<std::string, std::string> contents(const std::string& path,
                                                     const SignatureFilter& filter) {
    std::map<std::string, std::string> out;
    const auto reader = StoreReader::open(path).value();
    const auto rows = reader->find(filter).value();
    for (const StoredSignature& s : rows) {
      std::string& text =
          out[absl::StrCat(s.sweep, s.season, s.time_utc, s.band, s.aspect_azimuth_deg)];
      EXPECT_TRUE(text.empty());
      for (const auto member : kQuantityMember) absl::StrAppend(&text, s.*member, " ");
      absl::StrAppend(&text, s.job_key, s.warning, s.seed_hex, s.rays, s.stop_reason);
      text += reader->spectrum(s.signature_id).value().SerializeAsString();
      text += reader->thumbnail(s.signature_id).value()->SerializeAsString();
      const StoredSilhouette seen = reader->silhouette(s.signature_id).value().value();
      absl::StrAppend(&text, seen.width_px, "x", seen.height_px, "/", seen.pixel_samples);
      for (const StoredSilhouette::Part& p : seen.part)
        for (const StoredSilhouette::Pixel& pixel : p.pixel)
          absl::StrAppend(&text, p.name, pixel.at, ":", pixel.samples, ",");
      EXPECT_FALSE(seen.part_set.empty());
      for (const StoredSilhouette::PartSet& set : seen.part_set)
        for (const StoredSilhouette::Pixel& pixel : set.pixel)
          absl::StrAppend(&text, absl::StrJoin(set.part, "+"), set.outside_px, " ", pixel.at, ":",
                          pixel.samples, ",");
      const auto parts = reader->parts(s.signature_id).value();
      for (const StoredPart& p : parts) absl::StrAppend(&text, p.part, p.intensity_w_sr);
      const StoredLedger ledger = reader->ledger(s.signature_id).value();
      for (const StoredEffect& e : ledger.effect)
        absl::StrAppend(&text, e.effect, e.bound_w_sr, e.time_s);
    }
    return out;
  }

  const TestFolder folder_;
  const std::string path_ = folder_.file("all.sigdb");
  const schema::ResolvedSweep sweep_ = with_heat(make_sweep({}));
  Sliced last_{};
};

TEST_F(StoreSlice, OfEverythingHasAllOfIt) {
  EXPECT_EQ(slice({}, "copy.sigdb"), digest(path_));
  EXPECT_EQ(last_.rows, 16);
  EXPECT_EQ(last_.source_rows, 16);
  // Table by table, those that nobody has thought of yet included.
  const std::string names = sqlite_text(path_,
                                        "SELECT group_concat(name) FROM sqlite_schema WHERE type = "
                                        "'table' AND name NOT LIKE 'sqlite_%'");
  EXPECT_THAT(names, HasSubstr("spectral_modes"));
  for (const absl::string_view name : absl::StrSplit(names, ',')) {
    const std::string count = absl::StrCat("SELECT count(*) FROM ", name);
    EXPECT_EQ(sqlite_text(folder_.file("copy.sigdb"), count), sqlite_text(path_, count)) << name;
  }
}

TEST_F(StoreSlice, HoldsWhatBelongsToItsRowsAndNothingElse) {
  SignatureFilter filter;
  filter.season = "summer";
  filter.band = "lwir";
  slice(filter, "s.sigdb");
  const std::string path = folder_.file("s.sigdb");
  EXPECT_EQ(last_.rows, 4);
  EXPECT_EQ(contents(path, {}), contents(path_, filter));
  const auto reader = StoreReader::open(path).value();
  const SweepContents what = reader->contents().value().front();
  EXPECT_EQ(what.whole_rows, 4);
  ASSERT_EQ(what.condition.size(), 1);
  EXPECT_EQ(what.condition.front().season, "summer");
  ASSERT_EQ(what.band.size(), 1);
  EXPECT_EQ(reader->find({}).value().back().row, 4);
  // Its own heat run, at its new place, with its field; the other's is gone.
  const StoredSweep stored = reader->sweep("ship").value();
  ASSERT_EQ(stored.resolved.heat_size(), 1);
  EXPECT_EQ(stored.resolved.heat(0).season(), "summer");
  EXPECT_EQ(stored.resolved.condition(0).temperature_field().heat(), 0);
  EXPECT_EQ(stored.heat.size(), 1);
  EXPECT_EQ(sqlite_text(path, "SELECT count(*) FROM asset"), "1");
  const auto temperatures = reader->computed_temperatures({}).value();
  ASSERT_EQ(temperatures.size(), 1);
  EXPECT_EQ(temperatures.front().season, "summer");
  EXPECT_EQ(temperatures.front().coldest_k, 300);
  EXPECT_EQ(
      sqlite_text(
          path,
          "SELECT group_concat(DISTINCT condition_index || band_index) FROM job WHERE kind = 1"),
      "[0][0]");
  // The slice states its origin.
  ASSERT_EQ(stored.resolved.slice_size(), 1);
  const schema::Slice& said = stored.resolved.slice(0);
  EXPECT_EQ(said.source(), "all.sigdb");
  EXPECT_EQ(said.sweep_sha256(), "sha of ship");
  EXPECT_EQ(said.source_rows(), 16);
  EXPECT_EQ(said.rows(), 4);
  EXPECT_EQ(said.filter(), "--what");
  EXPECT_NE(reader->progress().value().front().sweep_sha256, "sha of ship");
}

TEST_F(StoreSlice, OfASliceIsTheSliceOfBoth) {
  SignatureFilter season, nearest, both;
  season.season = both.season = "winter";
  nearest.direction = both.direction = {80, 0};
  nearest.nearest = both.nearest = 2;
  slice(season, "first.sigdb");
  const std::string twice = slice(nearest, "twice.sigdb", folder_.file("first.sigdb"));
  EXPECT_EQ(twice, slice(both, "both.sigdb"));
  EXPECT_EQ(twice, slice(both, "again.sigdb"));
  const StoredSweep stored =
      StoreReader::open(folder_.file("twice.sigdb")).value()->sweep("ship").value();
  ASSERT_EQ(stored.resolved.slice_size(), 2);
  EXPECT_EQ(stored.resolved.slice(0).source(), "all.sigdb");
  EXPECT_EQ(stored.resolved.slice(1).source(), "first.sigdb");
  EXPECT_EQ(stored.resolved.slice(1).source_rows(), 8);
}

TEST_F(StoreSlice, IsCompletedByItsSweep) {
  const std::string whole = digest(path_);
  SignatureFilter filter;
  filter.direction = {0, 0};
  filter.nearest = 1;
  slice(filter, "one.sigdb");
  // All rows of one of four views: the other three, and no heat job, are computed.
  EXPECT_EQ(write(folder_.file("one.sigdb"), sweep_), 3);
  EXPECT_EQ(digest(folder_.file("one.sigdb")), whole);
  EXPECT_EQ(StoreReader::open(folder_.file("one.sigdb"))
                .value()
                ->sweep("ship")
                .value()
                .resolved.slice_size(),
            0);
  EXPECT_THAT(findings(folder_.file("one.sigdb")), IsEmpty());
  // Half of each view: all views again, and the other season's heat job.
  SignatureFilter season;
  season.season = "summer";
  slice(season, "half.sigdb");
  EXPECT_EQ(write(folder_.file("half.sigdb"), sweep_), 5);
  EXPECT_EQ(digest(folder_.file("half.sigdb")), whole);
}

TEST_F(StoreSlice, MayHaveHolesInItsLists) {
  const auto reader = StoreReader::open(path_).value();
  std::vector<double> errors;
  const auto rows = reader->find({}).value();
  for (const StoredSignature& s : rows)
    errors.push_back(s.numerical_error_w_sr / std::abs(s.intensity_w_sr));
  std::sort(errors.begin(), errors.end());
  SignatureFilter filter;
  filter.max_relative_error = errors[6];
  slice(filter, "holes.sigdb");
  EXPECT_EQ(last_.rows, 7);
  const std::string path = folder_.file("holes.sigdb");
  EXPECT_GT(StoreReader::open(path).value()->contents().value().front().whole_rows, 7);
  EXPECT_EQ(contents(path, {}), contents(path_, filter));
  // A row that is lost later is missed.
  sqlite_text(
      path, "DELETE FROM signature WHERE signature_id = (SELECT min(signature_id) FROM signature)");
  EXPECT_THAT(findings(path), testing::Contains(HasSubstr("6 signatures for 7 rows")));
}

TEST_F(StoreSlice, KeepsSweepsApart) {
  schema::ResolvedSweep other = with_heat(make_sweep({.name = "boat", .aspects = {{10, 3}}}));
  write(path_, other);
  EXPECT_EQ(slice({}, "copy.sigdb"), digest(path_));
  SignatureFilter filter;
  filter.sweep = "boat";
  slice(filter, "boat.sigdb");
  EXPECT_EQ(contents(folder_.file("boat.sigdb"), {}), contents(path_, filter));
  const auto sweeps = StoreReader::open(folder_.file("boat.sigdb")).value()->contents().value();
  ASSERT_EQ(sweeps.size(), 1);
  EXPECT_EQ(sweeps.front().name, "boat");
}

TEST_F(StoreSlice, LeavesRowsThatWaitForTheirReplacementBehind) {
  schema::ResolvedSweep changed = with_heat(make_sweep({.hull_temperature_k = 295}));
  auto writer = StoreWriter::open(path_).value();
  ASSERT_OK(writer->begin());
  ASSERT_OK(writer->add_sweep(changed, "changed", make_heat_jobs(changed, "changed"), {}).status());
  ASSERT_OK(writer->commit());
  // Nothing of the new version is there yet.
  EXPECT_TRUE(absl::IsNotFound(slice_database(path_, {}, folder_.file("none.sigdb")).status()));
  ASSERT_OK(writer->begin());
  for (int i = 0; i < 3; ++i) {  // three of four views; the temperatures stay
    const auto job = writer->lease_next("w", 1).value();
    ASSERT_OK(writer->complete(job->fencing_token,
                               job->spec.has_heat() ? make_heat_result(changed, job->spec)
                                                    : make_result(changed, job->spec),
                               "h"));
  }
  // The slice lacks rows that are not committed; the writer goes on beside it.
  EXPECT_TRUE(absl::IsNotFound(slice_database(path_, {}, folder_.file("none.sigdb")).status()));
  ASSERT_OK(writer->commit());
  slice({}, "new.sigdb");
  EXPECT_EQ(last_.rows, 12);
  EXPECT_EQ(sqlite_text(folder_.file("new.sigdb"),
                        "SELECT min(superseded) || max(superseded) FROM signature_view"),
            "00");
}

TEST_F(StoreSlice, IdsAreThoseOfTheRows) {
  const auto reader = StoreReader::open(path_).value();
  SignatureFilter season, nearest, within, row, range;
  season.season = "summer";
  nearest.direction = within.direction = {80, 0};
  nearest.nearest = 3;
  within.within_deg = 100;
  row.row = 7;
  range.range_m = 5000 * (1 + 5e-10);
  for (const SignatureFilter& filter : {SignatureFilter{}, season, nearest, within, row, range}) {
    const auto rows = reader->find(filter).value();
    const auto ids = reader->find_ids(filter).value();
    const auto read = reader->read(ids).value();
    ASSERT_FALSE(rows.empty());
    ASSERT_EQ(ids.size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      EXPECT_EQ(ids[i], rows[i].signature_id);
      EXPECT_EQ(read[i].row, rows[i].row);
    }
  }
  range.range_m = 5001;
  EXPECT_THAT(reader->find_ids(range).value(), IsEmpty());
  const std::int64_t unknown[] = {1, 999};
  EXPECT_TRUE(absl::IsNotFound(reader->read(unknown).status()));
}

TEST_F(StoreSlice, AppearsWholeOrNotAtAll) {
  SignatureFilter none;
  none.season = "autumn";
  const auto nothing = slice_database(path_, {none, "", false}, folder_.file("none.sigdb"));
  EXPECT_TRUE(absl::IsNotFound(nothing.status())) << nothing.status();
  const auto over = slice_database(path_, {}, path_);
  EXPECT_TRUE(absl::IsInvalidArgument(over.status())) << over.status();
  EXPECT_THAT(over.status().message(), HasSubstr("exists already"));
  EXPECT_FALSE(slice_database(path_, {}, folder_.file("no/such/folder.sigdb")).ok());
  EXPECT_FALSE(slice_database(folder_.file("absent"), {}, folder_.file("none.sigdb")).ok());
  std::uint64_t told = 0;
  const auto ended = slice_database(path_, {}, folder_.file("none.sigdb"),
                                    [&](std::uint64_t rows, std::uint64_t of) {
                                      EXPECT_EQ(of, 16);
                                      told = rows;
                                      return absl::AbortedError("enough");
                                    });
  EXPECT_TRUE(absl::IsAborted(ended.status())) << ended.status();
  EXPECT_EQ(told, 16);
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
    names.insert(entry.path().filename());
  EXPECT_THAT(names, ElementsAre("all.sigdb"));
  EXPECT_EQ(std::filesystem::status(path_).permissions(), std::filesystem::perms(0600));
}

TEST_F(StoreSlice, SaysTheDigestOfItsSourceIfAsked) {
  const auto sliced = slice_database(path_, {{}, "", true}, folder_.file("d.sigdb"));
  ASSERT_OK(sliced.status());
  EXPECT_EQ(sliced->source_digest, digest(path_));
  EXPECT_EQ(StoreReader::open(folder_.file("d.sigdb"))
                .value()
                ->sweep("ship")
                .value()
                .resolved.slice(0)
                .source_digest(),
            digest(path_));
}

TEST_F(StoreSlice, OfDamagedPlacesIsRefused) {
  for (const char* damage : {"UPDATE viewpoint SET viewpoint_index = -1 WHERE viewpoint_index = 1",
                             "UPDATE viewpoint SET viewpoint_index = 99 WHERE viewpoint_index = 1",
                             "UPDATE band SET band_index = -7 WHERE band_index = 0"}) {
    const std::string copy = folder_.file("damaged.sigdb");
    std::filesystem::copy(path_, copy, std::filesystem::copy_options::overwrite_existing);
    ASSERT_EQ(sqlite_text(copy, absl::StrCat("PRAGMA ignore_check_constraints = ON;", damage)),
              "(no row)");
    const auto refused = slice_database(copy, {}, folder_.file("d.sigdb"));
    EXPECT_TRUE(absl::IsDataLoss(refused.status())) << damage << ": " << refused.status();
  }
}

}  // namespace
}  // namespace irsig
