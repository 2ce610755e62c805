#include "schema/store/whole/slice.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/status_macros.h"
#include "schema/assets.h"
#include "schema/store/find_signatures.h"
#include "schema/store/open_database.h"
#include "schema/store/tables/digest.h"
#include "schema/store/tables/sha256.h"
#include "schema/store/tables/statements.h"
#include "schema/store/tables/stored_asset.h"
#include "schema/store/whole/new_database.h"

namespace irsig {
namespace {

// Rows between two reports of progress.
constexpr std::int64_t kCopiedAtOnce = 1000;

constexpr const char* kCopiedOfSignatures[] = {
    sql::slice_signature,      sql::slice_spectrum,    sql::slice_spectral_modes,
    sql::slice_part_intensity, sql::slice_clutter,     sql::slice_clutter_material,
    sql::slice_thumbnail,      sql::slice_image_layer, sql::slice_ledger,
    sql::slice_energy,         sql::slice_profile,     sql::slice_input_contribution};

using Places = std::vector<int>;

// The elements at some places of a list, in their order.
template <typename Field>
void keep(Field& field, const Places& places) {
  Field kept;
  for (const int place : places) kept.Add()->Swap(field.Mutable(place));
  field.Swap(&kept);
}

class Slicing {
 public:
  Slicing(Database& database, const SliceAsked& asked, const std::string& source,
          const SliceProgress& progress)
      : database_(database), asked_(asked), source_(source), progress_(progress) {}

  absl::StatusOr<Sliced> run() {
    IRSIG_STORE_TRY(database_.script(sql::slice_tables));
    IRSIG_STORE_TRY(choose());
    IRSIG_STORE_TRY(database_.script(sql::slice_places));
    if (asked_.source_digest) {
      ASSIGN_OR_RETURN(out_.source_digest, content_digest(database_));
    }
    IRSIG_STORE_TRY(copy_sweeps());
    IRSIG_STORE_TRY(check_assets(database_, sql::slice_heat_outputs));
    IRSIG_STORE_TRY(database_.script(sql::slice_definitions));
    IRSIG_STORE_TRY(copy_signatures());
    IRSIG_STORE_TRY(database_.script(sql::slice_renumber));
    return out_;
  }

 private:
  absl::Status choose() {
    ASSIGN_OR_RETURN(const auto ids, find_signature_ids(database_, asked_.filter));
    for (const std::int64_t id : ids) IRSIG_STORE_TRY(database_.run(sql::slice_keep, id));
    ASSIGN_OR_RETURN(const auto rows, database_.integer(sql::slice_count));
    if (rows == 0) return absl::NotFoundError("nothing to slice: no signature matches the filters");
    out_.rows = static_cast<std::uint64_t>(rows);
    return absl::OkStatus();
  }

  struct Sweep {
    std::int64_t id;
    std::string sha256, resolved;
    std::uint64_t source_rows, rows;
  };

  absl::Status copy_sweeps() {
    std::vector<Sweep> sweeps;
    {
      ASSIGN_OR_RETURN(Rows row, database_.query(sql::slice_sweeps));
      for (;;) {
        ASSIGN_OR_RETURN(const bool found, row.next());
        if (!found) break;
        Sweep& sweep = sweeps.emplace_back();
        sweep.id = row.integer();
        sweep.sha256 = row.text();
        sweep.resolved = row.text();
        sweep.source_rows = row.count();
        sweep.rows = row.count();
      }
    }
    for (const Sweep& sweep : sweeps) {
      IRSIG_STORE_TRY(copy_sweep(sweep));
      out_.source_rows += sweep.source_rows;
    }
    return absl::OkStatus();
  }

  absl::Status copy_sweep(const Sweep& sweep) {
    schema::ResolvedSweep resolved;
    if (!resolved.ParseFromString(sweep.resolved))
      return absl::DataLossError(absl::StrCat("the sweep ", sweep.sha256, " cannot be read"));
    ASSIGN_OR_RETURN(const auto viewpoints,
                     places(sql::slice_viewpoints, sweep.id, resolved.viewpoint_size()));
    ASSIGN_OR_RETURN(const auto conditions,
                     places(sql::slice_conditions, sweep.id, resolved.condition_size()));
    ASSIGN_OR_RETURN(const auto bands,
                     places(sql::slice_bands, sweep.id, resolved.sweep().band_size()));
    keep(*resolved.mutable_viewpoint(), viewpoints);
    keep(*resolved.mutable_condition(), conditions);
    keep(*resolved.mutable_sweep()->mutable_band(), bands);
    IRSIG_STORE_TRY(keep_heat(resolved, sweep.id));
    IRSIG_STORE_TRY(keep_plumes(resolved));
    resolved.clear_shard();  // its viewpoints have other places now
    schema::Slice& slice = *resolved.add_slice();
    slice.set_source(source_);
    slice.set_sweep_sha256(sweep.sha256);
    slice.set_source_rows(sweep.source_rows);
    slice.set_source_digest(out_.source_digest);
    slice.set_filter(asked_.filter_text);
    slice.set_rows(sweep.rows);
    // Never that of a sweep that somebody submits: its lists are others.
    const std::string sha256 = sha256_of(absl::StrCat(
        "irsig slice\n", sweep.sha256, "\nviewpoints ", absl::StrJoin(viewpoints, ","),
        "\nconditions ", absl::StrJoin(conditions, ","), "\nbands ", absl::StrJoin(bands, ",")));
    IRSIG_STORE_TRY(database_.run(sql::slice_sweep, sweep.id));
    IRSIG_STORE_TRY(database_.run(sql::slice_change_sweep, sweep.id, sha256, viewpoints.size(),
                                  conditions.size(), bands.size(),
                                  Blob{resolved.SerializeAsString()}));
    for (const std::string& asset : needed_assets(resolved)) {
      IRSIG_STORE_TRY(check_asset(database_, asset));
      IRSIG_STORE_TRY(database_.run(sql::slice_asset, asset));
      IRSIG_STORE_TRY(database_.run(sql::slice_sweep_asset, sweep.id, asset));
    }
    return absl::OkStatus();
  }

  absl::StatusOr<Places> places(const char* sql, std::int64_t sweep_id, int size) {
    Places out;
    ASSIGN_OR_RETURN(Rows row, database_.query(sql, sweep_id));
    for (;;) {
      ASSIGN_OR_RETURN(const bool found, row.next());
      if (!found) break;
      out.push_back(static_cast<int>(row.integer()));
    }
    IRSIG_STORE_TRY(within(out, size));
    return out;
  }

  // The runs of the conditions, and what uncertain inputs change of these.
  absl::Status keep_heat(schema::ResolvedSweep& resolved, std::int64_t sweep_id) {
    std::set<int> used;
    for (const schema::Condition& c : resolved.condition()) {
      if (c.temperature_field().has_heat())
        used.insert(static_cast<int>(c.temperature_field().heat()));
      if (c.has_land_heat()) used.insert(static_cast<int>(c.land_heat()));
    }
    for (int h = 0; h < resolved.heat_size(); ++h)
      if (resolved.heat(h).input_size() > 0 &&
          used.contains(static_cast<int>(resolved.heat(h).base())))
        used.insert(h);
    const Places runs(used.begin(), used.end());
    IRSIG_STORE_TRY(within(runs, resolved.heat_size()));
    const auto place_of = [&](std::uint32_t run) {
      return static_cast<std::uint32_t>(
          std::lower_bound(runs.begin(), runs.end(), static_cast<int>(run)) - runs.begin());
    };
    for (std::size_t i = 0; i < runs.size(); ++i)
      IRSIG_STORE_TRY(database_.run(sql::slice_keep_heat, sweep_id, runs[i], i));
    keep(*resolved.mutable_heat(), runs);
    for (schema::HeatRun& run : *resolved.mutable_heat())
      if (run.input_size() > 0) run.set_base(place_of(run.base()));
    for (schema::Condition& c : *resolved.mutable_condition()) {
      if (c.temperature_field().has_heat())
        c.mutable_temperature_field()->set_heat(place_of(c.temperature_field().heat()));
      if (c.has_land_heat()) c.set_land_heat(place_of(c.land_heat()));
    }
    return absl::OkStatus();
  }

  static absl::Status keep_plumes(schema::ResolvedSweep& resolved) {
    std::set<int> used;
    for (const schema::Condition& c : resolved.condition())
      if (c.has_plume()) used.insert(static_cast<int>(c.plume()));
    const Places plumes(used.begin(), used.end());
    IRSIG_STORE_TRY(within(plumes, resolved.plume_size()));
    keep(*resolved.mutable_plume(), plumes);
    for (schema::Condition& c : *resolved.mutable_condition())
      if (c.has_plume())
        c.set_plume(static_cast<std::uint32_t>(
            std::lower_bound(plumes.begin(), plumes.end(), static_cast<int>(c.plume())) -
            plumes.begin()));
    return absl::OkStatus();
  }

  // Checks that increasing places lie within a list of `size` entries.
  static absl::Status within(const Places& places, int size) {
    if (places.empty() || (places.front() >= 0 && places.back() < size)) return absl::OkStatus();
    return absl::DataLossError("a sweep refers to a place that its lists do not have");
  }

  absl::Status copy_signatures() {
    std::int64_t after = 0;
    for (std::uint64_t done = 0; done < out_.rows;) {
      ASSIGN_OR_RETURN(const auto last,
                       database_.integer(sql::slice_last_after, after, kCopiedAtOnce));
      for (const char* table : kCopiedOfSignatures)
        IRSIG_STORE_TRY(database_.run(table, after, last));
      after = last;
      done = std::min(out_.rows, done + kCopiedAtOnce);
      if (progress_) IRSIG_STORE_TRY(progress_(done, out_.rows));
    }
    return absl::OkStatus();
  }

  Database& database_;
  const SliceAsked& asked_;
  const std::string& source_;
  const SliceProgress& progress_;
  Sliced out_{};
};

absl::StatusOr<Sliced> copy(const std::string& from, const SliceAsked& asked,
                            const std::string& beside, const SliceProgress& progress) {
  ASSIGN_OR_RETURN(const auto database, open_for_reading(from, true));
  IRSIG_STORE_TRY(database->attach(sql::slice_attach, beside));
  // Nobody knows of the file before it is complete. Its pages and the source's: 64 MB each.
  IRSIG_STORE_TRY(
      database->script("PRAGMA slice.synchronous = OFF; PRAGMA slice.journal_mode = MEMORY;"
                       "PRAGMA slice.cache_size = -65536; PRAGMA main.cache_size = -65536;"
                       "PRAGMA temp_store = MEMORY; BEGIN"));
  const std::string name = std::filesystem::path(from).filename().string();
  absl::StatusOr<Sliced> sliced = Slicing(*database, asked, name, progress).run();
  if (!sliced.ok()) return sliced;
  IRSIG_STORE_TRY(database->script("COMMIT"));
  return sliced;
}

}  // namespace

absl::StatusOr<Sliced> slice_database(const std::string& from, const SliceAsked& asked,
                                      const std::string& to, const SliceProgress& progress) {
  Sliced out{};
  const absl::Status made = make_new_database(to, [&](const std::string& beside) -> absl::Status {
    // Errors of the source are reported first.
    if (const auto source = open_for_reading(from); !source.ok()) return source.status();
    IRSIG_STORE_TRY(make_empty_database(beside));
    ASSIGN_OR_RETURN(Sliced sliced, copy(from, asked, beside, progress));
    ASSIGN_OR_RETURN(const auto reader, StoreReader::open(beside));
    ASSIGN_OR_RETURN(auto digest, reader->digest());
    out = std::move(sliced);
    out.digest = std::move(digest);
    return absl::OkStatus();
  });
  if (!made.ok()) return made;
  return out;
}

}  // namespace irsig
