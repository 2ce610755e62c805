#include "schema/store/whole/merge.h"

#include <algorithm>
#include <limits>
#include <set>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "core/base/status_macros.h"
#include "schema/store/open_database.h"
#include "schema/store/tables/statements.h"
#include "schema/store/tables/stored_asset.h"
#include "schema/store/whole/new_database.h"
#include "schema/store/whole_file.h"
#include "schema/store/writer.h"

namespace irsig {
namespace {

// Rows that are copied, or compared, at once.
constexpr std::int64_t kRowsAtOnce = 1000;
constexpr std::int64_t kAll = std::numeric_limits<std::int64_t>::max();

// A table whose lines belong to signatures or jobs.
struct Owned {
  const char* table;
  const char* owner;                              // the column by which they do
  std::vector<std::string_view> own = {};         // columns that are given anew, or are not copied
  std::vector<std::string_view> incidental = {};  // who, when and how long: may differ
  const char* only = "1";
};

const Owned kOfSignatures[] = {{"signature", "signature_id"},
                               {"spectrum", "signature_id"},
                               {"spectral_modes", "signature_id"},
                               {"clutter", "signature_id"},
                               {"clutter_material", "signature_id"},
                               {"part_intensity", "signature_id"},
                               {"thumbnail", "signature_id"},
                               {"image_layer", "signature_id"},
                               {"ledger", "signature_id", {}, {"time_s"}},
                               {"energy", "signature_id"},
                               {"profile", "signature_id"},
                               {"input_contribution", "signature_id"}};

const Owned kProvenance = {
    "provenance",
    "job_id",
    {},
    // A job taken over has no count of rays; a hash of messages belongs to one version of irsig.
    {"build_id", "worker_name", "rays", "seconds", "content_sha256"}};
const Owned kTemperature = {"computed_temperature", "job_id"};
const Owned kSilhouette = {"silhouette", "job_id"};
const Owned kPartPixels = {"part_pixels", "job_id"};
const Owned kPartSet = {"part_set", "job_id"};
const Owned kAttempt = {"attempt", "job_id", {"fencing_token"}, {}, "t.outcome = 1"};
const Owned kAside = {"result_aside", "job_id", {"aside_id"}};

// Ids, and what they are called in the merged database: temp.of_<...>.
constexpr std::pair<std::string_view, std::string_view> kIds[] = {
    {"job_id", "of_job"},   {"viewpoint_id", "of_viewpoint"}, {"condition_id", "of_condition"},
    {"band_id", "of_band"}, {"part_id", "of_part"},           {"signature_id", "of_signature"}};

// The statements for one table. Their addresses are their names in the connection's cache.
struct Statements {
  std::string copy, only_here, only_there;
};

bool contains(const std::vector<std::string_view>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

// sql/merge.sql.
std::string statement(const char* text, const Owned& owned,
                      const std::vector<std::string>& columns) {
  const std::string owner = owned.owner;
  std::vector<std::string> values;
  std::string joins;
  for (const std::string& name : columns) {
    const auto id = std::find_if(std::begin(kIds), std::end(kIds),
                                 [&](const auto& known) { return known.first == name; });
    if (name == owner) {
      values.emplace_back("o.ours");
    } else if (id == std::end(kIds)) {
      values.push_back("t." + name);
    } else {
      const std::string map(id->second);
      values.push_back(map + ".ours");
      absl::StrAppend(&joins, "LEFT JOIN temp.", map, " ON ", map, ".theirs = t.", name, " ");
    }
  }
  return absl::StrReplaceAll(text, {{"TABLE", owned.table},
                                    {"OWNERS", owner == "job_id" ? "of_job" : "of_signature"},
                                    {"OWNER", owner},
                                    {"COLUMNS", absl::StrJoin(columns, ", ")},
                                    {"VALUES", absl::StrJoin(values, ", ")},
                                    {"JOINS", joins},
                                    {"ONLY", owned.only}});
}

// A sweep as one of the sources has it.
struct SweepThere {
  std::int64_t sweep_id = 0;
  std::string name, sha256, whole_sha256;
  schema::ResolvedSweep resolved;
  std::int64_t first_physics = 0, last_physics = 0;  // of what is done; 0: nothing is
  std::string first_class, last_class;
  std::uint64_t rows = 0, all_rows = 0;
};

// The sweep that one name stands for in all sources.
struct SweepHere {
  std::string name, whole_sha256;
  schema::ResolvedSweep whole;
  std::string from;  // the source that said so
  std::int64_t physics = 0;
  std::string determinism_class, bound_by;  // and the source that said this
  std::uint64_t left_behind = 0;
};

absl::StatusOr<std::vector<SweepThere>> sweeps_of(const std::string& path, Database& database) {
  std::vector<SweepThere> sweeps;
  ASSIGN_OR_RETURN(Rows row, database.query(sql::merge_sweeps));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return sweeps;
    SweepThere& sweep = sweeps.emplace_back();
    sweep.sweep_id = row.integer();
    sweep.name = row.text();
    sweep.sha256 = row.text();
    if (!sweep.resolved.ParseFromString(row.text()))
      return absl::DataLossError(
          absl::StrCat(path, ": the sweep \"", sweep.name, "\" cannot be read"));
    sweep.first_physics = row.integer();
    sweep.last_physics = row.integer();
    sweep.first_class = row.text();
    sweep.last_class = row.text();
    sweep.rows = row.count();
    sweep.all_rows = row.count();
    sweep.whole_sha256 =
        sweep.resolved.has_shard() ? sweep.resolved.shard().sweep_sha256() : sweep.sha256;
  }
}

absl::Status differ(const std::string& sweep, const std::string& what, const std::string& here,
                    const std::string& from, const std::string& there, const std::string& path) {
  return absl::InvalidArgumentError(absl::StrCat("the sweep \"", sweep, "\" has ", what, " ", here,
                                                 " in ", from, " and ", there, " in ", path,
                                                 ": expected the same in both"));
}

// The union of the sources, sweep by sweep.
class Union {
 public:
  absl::Status add(const std::string& path, const SweepThere& there) {
    if (there.resolved.slice_size() > 0)
      return absl::InvalidArgumentError(
          absl::StrCat(path, ": holds a slice of the sweep \"", there.name,
                       "\", whose rows have lost their places: expected the database that it was "
                       "sliced from, or run the sweep on the slice first (irsig run --resume)"));
    if (there.first_physics != there.last_physics)
      return differ(there.name, "rows of physics version", absl::StrCat(there.first_physics), path,
                    absl::StrCat(there.last_physics), path);
    if (there.first_class != there.last_class)
      return differ(there.name, "rows of determinism class", there.first_class, path,
                    there.last_class, path);
    SweepHere& here = find(path, there);
    if (here.whole_sha256 != there.whole_sha256)
      return differ(there.name, "the definition", here.whole_sha256, here.from, there.whole_sha256,
                    path);
    here.left_behind += there.all_rows - there.rows;
    rows_ += there.rows;
    if (there.first_class.empty()) return absl::OkStatus();  // nothing is done
    if (here.bound_by.empty()) {
      here.bound_by = path;
      here.physics = there.first_physics;
      here.determinism_class = there.first_class;
    }
    if (here.physics != there.first_physics)
      return differ(there.name, "rows of physics version", absl::StrCat(here.physics),
                    here.bound_by, absl::StrCat(there.first_physics), path);
    if (here.determinism_class != there.first_class)
      return differ(there.name, "rows of determinism class", here.determinism_class, here.bound_by,
                    there.first_class, path);
    return absl::OkStatus();
  }

  [[nodiscard]] const std::vector<SweepHere>& sweeps() const { return sweeps_; }
  [[nodiscard]] std::uint64_t rows() const { return rows_; }

 private:
  SweepHere& find(const std::string& path, const SweepThere& there) {
    for (SweepHere& here : sweeps_)
      if (here.name == there.name) return here;
    SweepHere& here = sweeps_.emplace_back();
    here.name = there.name;
    here.whole_sha256 = there.whole_sha256;
    here.whole = there.resolved;
    here.whole.clear_shard();
    here.from = path;
    return here;
  }

  std::vector<SweepHere> sweeps_;
  std::uint64_t rows_ = 0;
};

// The jobs that one source has done, into the merged database.
class Taking {
 public:
  // job_from: of each job there, which of the sources it has come from; 0: none yet.
  Taking(Database& database, const MergeAsked& asked, std::size_t source,
         std::vector<std::uint32_t>& job_from, std::uint64_t& rows_read, std::uint64_t all_rows,
         const MergeProgress& progress)
      : database_(database),
        asked_(asked),
        source_(source),
        job_from_(job_from),
        rows_read_(rows_read),
        all_rows_(all_rows),
        progress_(progress) {}

  absl::Status run(const std::vector<SweepHere>& known) {
    IRSIG_STORE_TRY(database_.script(sql::merge_tables));
    IRSIG_STORE_TRY(prepare());
    ASSIGN_OR_RETURN(const auto there, sweeps_of(path(), database_));
    for (const SweepThere& sweep : there) {
      const auto here = std::find_if(known.begin(), known.end(), [&](const SweepHere& h) {
        return h.name == sweep.name && h.whole_sha256 == sweep.whole_sha256 &&
               (sweep.first_class.empty() ||
                (sweep.first_class == h.determinism_class && sweep.first_physics == h.physics));
      });
      if (here == known.end())
        return absl::AbortedError(absl::StrCat(
            path(), ": was given another sweep, or its first rows, meanwhile: try again"));
      IRSIG_STORE_TRY(take(sweep, *here));
    }
    return absl::OkStatus();
  }

 private:
  [[nodiscard]] const std::string& path() const { return asked_.from[source_]; }

  absl::Status prepare() {
    for (const Owned& owned : kOfSignatures) {
      ASSIGN_OR_RETURN(auto made, statements(owned));
      of_signatures_.push_back(std::move(made));
    }
    for (const auto& [owned, out] :
         {std::pair{&kProvenance, &provenance_}, std::pair{&kTemperature, &temperature_},
          std::pair{&kSilhouette, &silhouette_}, std::pair{&kPartPixels, &part_pixels_},
          std::pair{&kPartSet, &part_set_}, std::pair{&kAttempt, &attempt_},
          std::pair{&kAside, &aside_}}) {
      ASSIGN_OR_RETURN(*out, statements(*owned));
    }
    return absl::OkStatus();
  }

  absl::StatusOr<Statements> statements(const Owned& owned) {
    std::vector<std::string> columns = {owned.owner};
    ASSIGN_OR_RETURN(Rows row, database_.query(sql::merge_columns, owned.table));
    for (;;) {
      ASSIGN_OR_RETURN(const bool found, row.next());
      if (!found) break;
      const std::string name = row.text();
      if (name != owned.owner && !contains(owned.own, name)) columns.push_back(name);
    }
    Statements out;
    out.copy = statement(sql::merge_copy, owned, columns);
    std::erase_if(columns,
                  [&](const std::string& name) { return contains(owned.incidental, name); });
    out.only_here = statement(sql::merge_only_here, owned, columns);
    out.only_there = statement(sql::merge_only_there, owned, columns);
    return out;
  }

  absl::Status take(const SweepThere& there, const SweepHere& here) {
    ASSIGN_OR_RETURN(const auto ours, database_.integer(sql::merge_sweep_id, here.name));
    sweep_ = here.name;
    IRSIG_STORE_TRY(database_.script(sql::merge_clear));
    for (const char* map : {sql::merge_jobs, sql::merge_viewpoints, sql::merge_conditions,
                            sql::merge_bands, sql::merge_parts})
      IRSIG_STORE_TRY(database_.run(map, there.sweep_id, ours));
    ASSIGN_OR_RETURN(const auto foreign, text(sql::merge_foreign_job));
    if (!foreign.empty())
      return absl::InvalidArgumentError(
          absl::StrCat(path(), ": the sweep \"", sweep_, "\" has a job ", foreign,
                       ", which it has not by this irsig: merge it with the one that made it"));
    ASSIGN_OR_RETURN(const auto offset, database_.integer(sql::merge_last_signature));
    IRSIG_STORE_TRY(database_.run(sql::merge_signatures, offset));
    ASSIGN_OR_RETURN(const auto broken, text(sql::merge_broken_job));
    if (!broken.empty())
      return absl::DataLossError(absl::StrCat(path(), ": the sweep \"", sweep_, "\", job ", broken,
                                              ": it is done, but rows are missing"));
    IRSIG_STORE_TRY(take_bands());
    IRSIG_STORE_TRY(take_jobs());
    IRSIG_STORE_TRY(take_signatures());
    IRSIG_STORE_TRY(database_.run(sql::merge_directions));
    IRSIG_STORE_TRY(database_.run(sql::merge_set_done));
    IRSIG_STORE_TRY(database_.run(sql::merge_count_needs, ours));
    if (!here.determinism_class.empty())
      IRSIG_STORE_TRY(database_.run(sql::merge_bind, ours, here.determinism_class));
    return database_.run(sql::merge_prediction, here.whole_sha256);
  }

  // Returns the text of the first row; empty if there is none.
  absl::StatusOr<std::string> text(const char* sql) {
    ASSIGN_OR_RETURN(Rows row, database_.query(sql));
    ASSIGN_OR_RETURN(const bool found, row.next());
    return found ? row.text() : std::string();
  }

  absl::Status take_bands() {
    ASSIGN_OR_RETURN(const auto other, text(sql::merge_other_wavelengths));
    if (!other.empty())
      return absl::InvalidArgumentError(absl::StrCat(path(), ": the sweep \"", sweep_,
                                                     "\", band \"", other,
                                                     "\" has other wavelengths than in the files "
                                                     "before it"));
    return database_.run(sql::merge_wavelengths);
  }

  absl::Status take_jobs() {
    IRSIG_STORE_TRY(compare_jobs(sql::merge_other_temperatures, "heat_job"));
    for (const auto& [compared, table] :
         {std::pair{&provenance_, kProvenance.table}, std::pair{&temperature_, kTemperature.table},
          std::pair{&silhouette_, kSilhouette.table}, std::pair{&part_pixels_, kPartPixels.table},
          std::pair{&part_set_, kPartSet.table}}) {
      IRSIG_STORE_TRY(compare_jobs(compared->only_here.c_str(), table, 0, kAll));
      IRSIG_STORE_TRY(compare_jobs(compared->only_there.c_str(), table, 0, kAll));
    }
    IRSIG_STORE_TRY(check_assets(database_, sql::merge_heat_outputs));
    IRSIG_STORE_TRY(database_.script(sql::merge_temperatures));
    for (const Statements* copied :
         {&provenance_, &temperature_, &silhouette_, &part_pixels_, &part_set_, &attempt_, &aside_})
      IRSIG_STORE_TRY(database_.run(copied->copy.c_str(), 0, kAll));
    ASSIGN_OR_RETURN(Rows row, database_.query(sql::merge_new_jobs));
    for (;;) {
      ASSIGN_OR_RETURN(const bool found, row.next());
      if (!found) return absl::OkStatus();
      const std::size_t job = row.count();
      if (job_from_.size() <= job) job_from_.resize(job + 1);
      job_from_[job] = static_cast<std::uint32_t>(source_ + 1);
    }
  }

  template <typename... Range>
  absl::Status compare_jobs(const char* sql, const char* table, Range... range) {
    const auto job = database_.integer(sql, range...);
    if (absl::IsNotFound(job.status())) return absl::OkStatus();
    return job.ok() ? conflict(*job, "", table) : job.status();
  }

  absl::Status take_signatures() {
    ASSIGN_OR_RETURN(const auto count, database_.integer(sql::merge_count));
    std::int64_t after = 0;
    for (std::int64_t done = 0; done < count;) {
      ASSIGN_OR_RETURN(const auto last,
                       database_.integer(sql::merge_last_after, after, kRowsAtOnce));
      for (std::size_t i = 0; i < of_signatures_.size(); ++i) {
        const Statements& table = of_signatures_[i];
        for (const std::string* compared : {&table.only_here, &table.only_there}) {
          const auto differs = database_.integer(compared->c_str(), after, last);
          if (differs.ok()) return row_conflict(*differs, kOfSignatures[i].table);
          if (!absl::IsNotFound(differs.status())) return differs.status();
        }
        IRSIG_STORE_TRY(database_.run(table.copy.c_str(), after, last));
      }
      const std::int64_t now = std::min(count, done + kRowsAtOnce);
      rows_read_ += static_cast<std::uint64_t>(now - done);
      after = last;
      done = now;
      if (progress_) IRSIG_STORE_TRY(progress_(rows_read_, all_rows_));
    }
    return absl::OkStatus();
  }

  absl::Status row_conflict(std::int64_t signature_id, const char* table) {
    std::int64_t job = 0, place = 0;
    {
      ASSIGN_OR_RETURN(Rows row, database_.query(sql::merge_place, signature_id));
      ASSIGN_OR_RETURN(const bool found, row.next());
      if (!found) return absl::DataLossError(absl::StrCat(path(), ": a row has no place"));
      job = row.integer();
      place = row.integer();
    }
    return conflict(job, absl::StrCat(" row ", place, ","), table);
  }

  absl::Status conflict(std::int64_t job, const std::string& place, const char* table) {
    ASSIGN_OR_RETURN(Rows row, database_.query(sql::merge_job_key, job));
    ASSIGN_OR_RETURN(const bool found, row.next());
    const std::string key = found ? row.text() : std::string();
    const auto at = static_cast<std::size_t>(job);
    const std::string& before =
        asked_.from[at < job_from_.size() && job_from_[at] > 0 ? job_from_[at] - 1 : source_];
    return absl::InvalidArgumentError(absl::StrCat(
        "the sweep \"", sweep_, "\",", place, " job ", key, ": `", table, "` is not the same in ",
        before, " and in ", path(), ", though equal jobs have equal results: one is damaged"));
  }

  Database& database_;
  const MergeAsked& asked_;
  std::size_t source_;
  std::vector<std::uint32_t>& job_from_;
  std::uint64_t& rows_read_;
  std::uint64_t all_rows_;
  const MergeProgress& progress_;
  std::string sweep_;
  std::vector<Statements> of_signatures_;
  Statements provenance_, temperature_, silhouette_, part_pixels_, part_set_, attempt_, aside_;
};

// Each file once, whatever it is called.
std::vector<std::string> different_files(const std::vector<std::string>& paths) {
  std::vector<std::string> out;
  std::set<std::string> seen;
  for (const std::string& path : paths)
    if (seen.insert(real_path(path)).second) out.push_back(path);
  return out;
}

// All sweeps, submitted: nothing of them is done.
absl::Status submit_all(const std::vector<SweepHere>& sweeps, const MergeAsked& asked,
                        const std::string& path) {
  ASSIGN_OR_RETURN(auto writer, StoreWriter::open(path));
  IRSIG_STORE_TRY(writer->begin());
  for (const SweepHere& sweep : sweeps) {
    const auto jobs =
        asked.jobs(sweep.whole, sweep.bound_by.empty() ? asked.physics_version
                                                       : static_cast<int>(sweep.physics));
    if (!jobs.ok())
      return absl::Status(
          jobs.status().code(),
          absl::StrCat(sweep.from, ": the sweep \"", sweep.name, "\": ", jobs.status().message()));
    if (jobs->empty() || jobs->front().sweep_sha256() != sweep.whole_sha256)
      return absl::InvalidArgumentError(absl::StrCat(
          sweep.from, ": the sweep \"", sweep.name,
          "\" has another hash by this irsig: ", "merge it with the one that made it"));
    ASSIGN_OR_RETURN(const auto source, StoreReader::open(sweep.from));
    ASSIGN_OR_RETURN(const auto stored, source->sweep(sweep.name));
    std::vector<Asset> assets;
    for (const auto& [sha256, bytes] : stored.assets) assets.push_back({sha256, bytes});
    IRSIG_STORE_TRY(writer->add_sweep(sweep.whole, sweep.whole_sha256, *jobs, assets).status());
  }
  IRSIG_STORE_TRY(writer->commit());
  return writer->finish();
}

// A coordinator binds all unfinished sweeps of its database to one class.
absl::Status check_open_classes(Database& database) {
  std::string first, its_class;
  ASSIGN_OR_RETURN(Rows row, database.query(sql::merge_open_sweeps));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return absl::OkStatus();
    const std::string name = row.text(), determinism_class = row.text();
    if (first.empty()) {
      first = name;
      its_class = determinism_class;
    }
    if (its_class != determinism_class)
      return absl::InvalidArgumentError(absl::StrCat(
          "the sweeps \"", first, "\" (", its_class, ") and \"", name, "\" (", determinism_class,
          ") are both unfinished, and one database cannot go on with two determinism classes: "
          "finish one of them first"));
  }
}

absl::StatusOr<Merged> merge(const MergeAsked& asked, const std::string& beside,
                             const MergeProgress& progress) {
  Union sweeps;
  for (const std::string& path : asked.from) {
    ASSIGN_OR_RETURN(const auto source, open_for_reading(path));
    ASSIGN_OR_RETURN(const auto there, sweeps_of(path, *source));
    for (const SweepThere& sweep : there) IRSIG_STORE_TRY(sweeps.add(path, sweep));
  }
  if (sweeps.sweeps().empty())
    return absl::InvalidArgumentError("nothing to merge: the databases hold no sweep");
  IRSIG_STORE_TRY(submit_all(sweeps.sweeps(), asked, beside));
  std::vector<std::uint32_t> job_from;
  std::uint64_t rows_read = 0;
  for (std::size_t i = 0; i < asked.from.size(); ++i) {
    ASSIGN_OR_RETURN(const auto source, open_for_reading(asked.from[i], true));
    IRSIG_STORE_TRY(source->attach(sql::merge_attach, beside));
    // As of slice.cpp; but of a file that is not empty a journal may be larger than memory.
    IRSIG_STORE_TRY(
        source->script("PRAGMA merged.synchronous = OFF;"
                       "PRAGMA merged.cache_size = -65536; PRAGMA main.cache_size = -65536;"
                       "PRAGMA temp_store = MEMORY; BEGIN"));
    IRSIG_STORE_TRY(Taking(*source, asked, i, job_from, rows_read, sweeps.rows(), progress)
                        .run(sweeps.sweeps()));
    IRSIG_STORE_TRY(source->script("COMMIT"));
  }
  ASSIGN_OR_RETURN(const auto made, open_for_reading(beside));
  IRSIG_STORE_TRY(check_open_classes(*made));
  ASSIGN_OR_RETURN(const auto reader, StoreReader::open(beside));
  ASSIGN_OR_RETURN(const auto counted, reader->progress());
  ASSIGN_OR_RETURN(const auto contents, reader->contents());
  Merged out;
  for (std::size_t i = 0; i < sweeps.sweeps().size(); ++i)  // all in the order of their submission
    out.sweep.push_back({counted[i].name, contents[i].rows, counted[i].jobs, counted[i].done,
                         sweeps.sweeps()[i].left_behind});
  ASSIGN_OR_RETURN(auto digest, reader->digest());
  out.digest = std::move(digest);
  return out;
}

}  // namespace

absl::StatusOr<Merged> merge_databases(const MergeAsked& asked, const std::string& to,
                                       const MergeProgress& progress) {
  MergeAsked once = asked;
  once.from = different_files(asked.from);
  Merged out;
  const absl::Status made = make_new_database(to, [&](const std::string& beside) -> absl::Status {
    ASSIGN_OR_RETURN(out, merge(once, beside, progress));
    return absl::OkStatus();
  });
  if (!made.ok()) return made;
  return out;
}

}  // namespace irsig
