// A database that somebody damaged, by accident or on purpose: its pages, and field by field, where
// the file stays a right one. Whatever is asked of it is answered, or refused with words; what
// `irsig doctor` says of it is not tested here.
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cmath>
#include <fstream>
#include <random>
#include <sstream>

#include "absl/strings/str_cat.h"
#include "coordinator/farm.h"
#include "jobs/check_resolved.h"
#include "schema/store/reader.h"
#include "schema/store/whole/examine.h"
#include "schema/store/whole/slice.h"
#include "schema/store/writer.h"
#include "serve/answers.h"
#include "tests/fault/synthetic_farm.h"
#include "tests/fuzz/message_mutator.h"
#include "tests/fuzz/mutator.h"
#include "tests/fuzz/turns.h"
#include "tests/unit/test_folder.h"
#include "view/export/export.h"

namespace irsig {
namespace {

constexpr const char* kWords[] = {"SQLite format 3", "\xff\xff\xff\xff", "CREATE VIEW", "nan"};

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream bytes;
  bytes << in.rdbuf();
  return bytes.str();
}

class DatabaseFile : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TestFolder;
    const std::string path = folder_->file("whole.sigdb");
    auto store = StoreWriter::open(path);
    ASSERT_TRUE(store.ok()) << store.status();
    schema::ResolvedSweep sweep = heated_frigate_sweep(24);
    schema::Image& image = *sweep.mutable_sweep()->mutable_image();
    image.set_kind("framed");
    for (const std::uint32_t pixels : {128, 40}) image.add_pixels(pixels);
    for (const char* layer : {"sun", "at_sensor"}) image.add_layers(layer);
    const auto made = make_submission(check_resolved, sweep, 1, {});
    ASSERT_TRUE(made.ok()) << made.status();
    ASSERT_TRUE((*store)->begin().ok());
    ASSERT_TRUE((*store)->add_sweep(made->sweep, made->sweep_sha256, made->jobs, {}).ok());
    for (;;) {
      const auto job = (*store)->lease_next("w", 0);
      ASSERT_TRUE(job.ok()) << job.status();
      if (!job->has_value()) break;
      const auto status =
          (*store)->complete((*job)->fencing_token, synthetic_result(sweep, (*job)->spec), "w");
      ASSERT_TRUE(status.ok()) << status;
    }
    ASSERT_TRUE((*store)->commit().ok());
    ASSERT_TRUE((*store)->finish().ok());
    whole_ = new std::string(bytes_of(path));
  }
  static void TearDownTestSuite() {
    delete folder_;
    delete whole_;
  }

  void heard(const absl::Status& status, const std::string& asked) {
    ASSERT_TRUE(status.ok() || !status.message().empty()) << asked;
    ASSERT_NE(status.code(), absl::StatusCode::kUnknown) << asked << ": " << status;
    ++(status.ok() ? answered_ : refused_);
  }

  // Everything that may be asked of it, as the page and the command line do.
  void ask_everything(const std::string& path) {
    PageSources sources{{path}, {}, [](const StoredSweep&) { return TargetExtent{100, 70}; }};
    const auto get = [&](const char* what, Parameters parameters) {
      const PageReply reply = answer(sources, what, parameters);
      const bool refused = reply.status != 200;
      ASSERT_TRUE(!refused || reply.body.find("{\"error\":\"") != std::string::npos) << reply.body;
      ASSERT_TRUE(reply.status == 200 || (reply.status >= 400 && reply.status <= 503)) << what;
      ++(refused ? refused_ : answered_);
    };
    const Parameters selection{{"sweep", "frigate"},
                               {"season", season_},
                               {"time", time_},
                               {"band", "lwir"},
                               {"at_range_m", "5000"}};
    const auto with = [](Parameters some, const Parameters& more) {
      some.insert(more.begin(), more.end());
      return some;
    };
    get("/api/contents", {});
    get("/api/progress", {});
    get("/api/map", selection);
    get("/api/cut", with(selection, {{"elevation_deg", "45"}}));
    get("/api/bands", with(selection, {{"nei_w_m2", "1e-9"}}));
    get("/api/compare", with(selection, {{"b_sweep", "frigate"},
                                         {"b_season", season_},
                                         {"b_time", time_},
                                         {"b_band", "lwir"},
                                         {"b_at_range_m", "5000"}}));
    for (const char* file : {"rows.csv", "map.svg", "cut.svg", "bands.svg"})
      get(absl::StrCat("/file/", file).c_str(), selection);
    const Parameters row{{"sweep", "frigate"}, {"row", "2"}};
    for (const char* path_of_row :
         {"/api/row", "/api/spectrum", "/api/thumbnail.png", "/api/image.json", "/api/image.exr",
          "/api/silhouette.json", "/file/row.csv", "/file/spectrum.svg"})
      get(path_of_row, row);
    get("/api/image.exr", with(row, {{"layer", "at_sensor"}, {"stderr", "1"}}));
    get("/api/row", with(row, {{"range_m", "12000"}}));
    if (auto reader = StoreReader::open(path); reader.ok()) {
      heard((*reader)->digest().status(), "digest");
      heard((*reader)->sweep("frigate").status(), "sweep");
      heard((*reader)->profiles({}).status(), "profiles");
      heard((*reader)->computed_temperatures({}).status(), "temperatures");
      heard((*reader)->heat_jobs("frigate").status(), "heat jobs");
      heard((*reader)->job_costs("frigate").status(), "costs");
      heard((*reader)->outcome("frigate").status(), "outcome");
      for (const char* format : {"csv", "netcdf", "envi"})
        heard(export_file(**reader, {.query = {.band = "lwir"}}, format, folder_->file("out.sli")),
              format);
    } else {
      heard(reader.status(), "open");
    }
    heard(examine(path, 1).status(), "examine");
    const std::string slice = folder_->file("slice.sigdb");
    SliceAsked asked{};
    asked.filter.band = "mwir";
    heard(slice_database(path, asked, slice).status(), "slice");
    std::filesystem::remove(slice);
  }

  std::string damaged(const std::string& bytes) {
    const std::string path = folder_->file("damaged.sigdb");
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }

  static inline TestFolder* folder_ = nullptr;
  static inline std::string* whole_ = nullptr;
  std::string season_ = "winter", time_;
  int answered_ = 0, refused_ = 0;
};

// A connection that believes what it is told: rows that no irsig would have stored.
class Vandal {
 public:
  explicit Vandal(const std::string& path) {
    sqlite3_open_v2(path.c_str(), &handle_, SQLITE_OPEN_READWRITE, nullptr);
    run("PRAGMA ignore_check_constraints = ON");
    run("PRAGMA foreign_keys = OFF");
    run("PRAGMA synchronous = OFF");
  }
  ~Vandal() { sqlite3_close(handle_); }
  Vandal(const Vandal&) = delete;
  Vandal& operator=(const Vandal&) = delete;

  bool run(const std::string& statement, const std::string& bytes = {}) {
    sqlite3_stmt* prepared = nullptr;
    if (sqlite3_prepare_v2(handle_, statement.c_str(), -1, &prepared, nullptr) != SQLITE_OK)
      return false;
    if (sqlite3_bind_parameter_count(prepared) > 0)
      sqlite3_bind_blob64(prepared, 1, bytes.data(), bytes.size(), SQLITE_TRANSIENT);
    const int result = sqlite3_step(prepared);
    sqlite3_finalize(prepared);
    return (result == SQLITE_DONE || result == SQLITE_ROW) &&
           (result == SQLITE_ROW || sqlite3_changes(handle_) > 0);
  }
  std::vector<std::vector<std::string>> table(const std::string& query) {
    std::vector<std::vector<std::string>> out;
    sqlite3_stmt* prepared = nullptr;
    sqlite3_prepare_v2(handle_, query.c_str(), -1, &prepared, nullptr);
    while (prepared != nullptr && sqlite3_step(prepared) == SQLITE_ROW) {
      auto& row = out.emplace_back();
      for (int i = 0; i < sqlite3_column_count(prepared); ++i) {
        const auto* bytes = static_cast<const char*>(sqlite3_column_blob(prepared, i));
        row.emplace_back(bytes == nullptr ? "" : bytes,
                         static_cast<std::size_t>(sqlite3_column_bytes(prepared, i)));
      }
    }
    sqlite3_finalize(prepared);
    return out;
  }

 private:
  sqlite3* handle_ = nullptr;
};

TEST_F(DatabaseFile, WholeItAnswersEverything) {
  const std::string path = damaged(*whole_);
  const auto condition = Vandal(path).table("SELECT season, time_utc FROM condition LIMIT 1");
  ASSERT_EQ(condition.size(), 1U);
  season_ = condition[0][0], time_ = condition[0][1];
  ask_everything(path);
  EXPECT_EQ(refused_, 0);
  EXPECT_GT(answered_, 25);
}

TEST_F(DatabaseFile, WithDamagedPages) {
  time_ = Vandal(damaged(*whole_)).table("SELECT time_utc FROM condition LIMIT 1")[0][0];
  std::mt19937_64 random(1);
  const std::size_t page = 4096;
  fuzz::Turns turn(20);
  while (turn.next()) {
    std::string bytes = *whole_;
    fuzz::Mutator mutator(static_cast<std::uint64_t>(turn.index()), kWords, 100);
    if (turn.index() % 4 == 0) {  // anywhere; lengths change, too
      bytes = mutator.mutate(bytes);
    } else {  // the headers of some pages, where the structure is
      for (std::size_t n = 1 + random() % 4; n > 0; --n) {
        const std::size_t at = random() % (bytes.size() / page) * page + random() % 64;
        bytes[at] = static_cast<char>(random());
      }
    }
    SCOPED_TRACE(turn.index());
    ask_everything(damaged(bytes));
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(refused_, turn.done());
  EXPECT_GT(answered_, turn.done());
}

TEST_F(DatabaseFile, WithFieldsThatNoProgramWrote) {
  constexpr const char* kNumbers[] = {
      "-1",    "0",     "1",    "2147483648", "9223372036854775807",
      "9e999", "1e308", "-0.5", "NULL",       "-9223372036854775808"};
  std::vector<std::array<std::string, 3>> columns;  // table, column, type
  {
    Vandal of(damaged(*whole_));
    time_ = of.table("SELECT time_utc FROM condition LIMIT 1")[0][0];
    for (const auto& column : of.table(
             "SELECT m.name, c.name, c.type FROM sqlite_schema m JOIN pragma_table_info(m.name) c "
             "WHERE m.type = 'table' AND m.name NOT LIKE 'sqlite%'"))
      columns.push_back({column[0], column[1], column[2]});
  }
  ASSERT_GT(columns.size(), 100U);
  std::mt19937_64 random(2);
  int changed = 0;
  fuzz::Turns turn(40);
  while (turn.next()) {
    const std::string path = damaged(*whole_);
    std::string done;
    {
      Vandal vandal(path);
      for (std::size_t n = 1 + random() % 3; n > 0; --n) {
        // Every second time one of those whose bytes are read for what they mean.
        auto place = columns[random() % columns.size()];
        while (random() % 2 == 0 && place[2] != "BLOB") place = columns[random() % columns.size()];
        const auto& [table, column, type] = place;
        const auto rows = vandal.table(absl::StrCat(
            "SELECT rowid, ", column, " FROM ", table, " ORDER BY rowid LIMIT 1 OFFSET ",
            random() % 1000000, " % (SELECT max(count(*), 1) FROM ", table, ")"));
        if (rows.empty()) continue;
        const bool all = random() % 4 == 0;
        const std::string where = all ? "" : absl::StrCat(" WHERE rowid = ", rows[0][0]);
        fuzz::Mutator mutator(random(), kWords, 60);
        const std::string set = absl::StrCat("UPDATE ", table, " SET ", column, " = ");
        const bool did =
            type == "BLOB"   ? vandal.run(absl::StrCat(set, "?1", where),
                                        random() % 8 == 0 ? "" : mutator.mutate(rows[0][1]))
              : type == "TEXT" ? vandal.run(absl::StrCat(set, "CAST(?1 AS TEXT)", where),
                                            mutator.mutate(rows[0][1]))
                             : vandal.run(absl::StrCat(set, kNumbers[random() % 10], where));
        if (did) absl::StrAppend(&done, table, ".", column, all ? " everywhere; " : "; ");
      }
    }
    if (done.empty()) continue;
    ++changed;
    SCOPED_TRACE(absl::StrCat(turn.index(), ": ", done));
    ask_everything(path);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(changed, turn.done() / 2);
  EXPECT_GT(refused_, changed / 4);
  EXPECT_GT(answered_, changed);
}

TEST_F(DatabaseFile, WithASweepThatNoFileStates) {
  schema::ResolvedSweep whole;
  {
    Vandal of(damaged(*whole_));
    time_ = of.table("SELECT time_utc FROM condition LIMIT 1")[0][0];
    ASSERT_TRUE(whole.ParseFromString(of.table("SELECT resolved_sweep FROM sweep")[0][0]));
  }
  fuzz::MessageMutator fields(11);
  fuzz::Turns turn(20);
  while (turn.next()) {
    schema::ResolvedSweep sweep = whole;
    fields.mutate(sweep);
    const std::string path = damaged(*whole_);
    ASSERT_TRUE(
        Vandal(path).run("UPDATE sweep SET resolved_sweep = ?1", sweep.SerializeAsString()));
    SCOPED_TRACE(turn.index());
    ask_everything(path);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(refused_, turn.done() / 4);
  EXPECT_GT(answered_, turn.done());
}

}  // namespace
}  // namespace irsig
