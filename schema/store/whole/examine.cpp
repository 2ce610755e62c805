#include "schema/store/whole/examine.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "absl/strings/str_cat.h"
#include "core/accuracy/quantities.h"
#include "core/accuracy/spectral_modes.h"
#include "core/base/status_macros.h"
#include "google/protobuf/reflection.h"
#include "schema/shard.h"
#include "schema/store/check/check_picture.h"
#include "schema/store/find_signatures.h"
#include "schema/store/open_database.h"
#include "schema/store/reader.h"
#include "schema/store/tables/sha256.h"
#include "schema/store/tables/statements.h"
#include "schema/store/tables/stored_asset.h"
#include "schema/store/whole_file.h"

namespace irsig {
namespace {

constexpr std::size_t kMostNamed = 5;

// How many signatures have an infinite number in a column. (SQLite stores what is not a number as
// NULL, which the columns that must be there refuse.)
#define IRSIG_COUNT_VALUE(name, stderr_name, unit, what)                          \
  "SELECT count(*) FROM signature WHERE abs(" #name ") > 1.7976931348623157e308", \
      "SELECT count(*) FROM signature WHERE abs(" #stderr_name ") > 1.7976931348623157e308",
#define IRSIG_COUNT_NUMBER(name, kind, unit, what) \
  "SELECT count(*) FROM signature WHERE abs(" #name ") > 1.7976931348623157e308",
constexpr const char* kCountInfinite[] = {IRSIG_QUANTITIES(IRSIG_COUNT_VALUE, IRSIG_COUNT_NUMBER)};
#undef IRSIG_COUNT_VALUE
#undef IRSIG_COUNT_NUMBER
static_assert(std::size(kCountInfinite) == kQuantities.size());

// Findings of one kind of damage, of which the first few are named.
class Named {
 public:
  Named(std::vector<StoreFinding>& findings, std::string what, std::string remedy = "")
      : findings_(findings), what_(std::move(what)), remedy_(std::move(remedy)) {}
  void add(const std::string& which) {
    if (++count_ <= kMostNamed) absl::StrAppend(&which_, which_.empty() ? "" : ", ", which);
  }
  ~Named() {
    if (count_ == 0) return;
    const std::string more =
        count_ > kMostNamed ? absl::StrCat(" and ", count_ - kMostNamed, " more") : "";
    findings_.push_back(
        {StoreFinding::Kind::kDamaged,
         absl::StrCat(what_, ": ", which_, more, remedy_.empty() ? "" : "; ", remedy_)});
  }
  Named(const Named&) = delete;
  Named& operator=(const Named&) = delete;

 private:
  std::vector<StoreFinding>& findings_;
  std::string what_, remedy_, which_;
  std::size_t count_ = 0;
};

// Places in a list, in increasing order, as text: "0, 7 to 23".
class ListPlaces {
 public:
  void add(std::int64_t place) {
    if (!ranges_.empty() && ranges_.back().last + 1 == place) {
      ranges_.back().last = place;
    } else if (ranges_.size() < kMostRanges) {
      ranges_.push_back({place, place});
    } else {
      ++more_;
    }
  }
  [[nodiscard]] std::string text() const {
    std::string out;
    for (const auto& [first, last] : ranges_) {
      absl::StrAppend(&out, out.empty() ? "" : ", ", first);
      if (last > first) absl::StrAppend(&out, last == first + 1 ? ", " : " to ", last);
    }
    return more_ > 0 ? absl::StrCat(out, " and ", more_, " more") : out;
  }

 private:
  static constexpr std::size_t kMostRanges = 20;
  struct Range {
    std::int64_t first, last;
  };
  std::vector<Range> ranges_;
  std::size_t more_ = 0;
};

// Calls read(row) for each row of a statement without parameters.
template <typename Read>
absl::Status for_each(Database& database, const char* sql, const Read& read) {
  ASSIGN_OR_RETURN(Rows row, database.query(sql));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return absl::OkStatus();
    read(row);
  }
}

// How errors go together can be read, of each spectrum that has modes.
bool modes_fit(const schema::Spectrum& s) {
  for (const auto& [errors, modes] :
       {std::pair{&s.spectral_intensity_stderr_w_sr_um(), &s.spectral_intensity_modes()},
        {&s.apparent_spectral_intensity_stderr_w_sr_um(), &s.apparent_spectral_intensity_modes()},
        {&s.contrast_spectral_intensity_stderr_w_sr_um(), &s.contrast_spectral_intensity_modes()}})
    if (!SumErrors::make({errors->data(), static_cast<std::size_t>(errors->size())}, *modes).ok())
      return false;
  return true;
}

class Examination {
 public:
  // reader: of the same file.
  Examination(Database& database, StoreReader& reader) : database_(database), reader_(reader) {}

  absl::Status run(int physics_version) {
    IRSIG_STORE_TRY(structure());
    IRSIG_STORE_TRY(directions());
    IRSIG_STORE_TRY(assets());
    IRSIG_STORE_TRY(numbers());
    IRSIG_STORE_TRY(contents());
    IRSIG_STORE_TRY(coverage());
    return age(physics_version);
  }
  [[nodiscard]] std::vector<StoreFinding> take() { return std::move(findings_); }

 private:
  using Kind = StoreFinding::Kind;

  void found(Kind kind, std::string what) { findings_.push_back({kind, std::move(what)}); }

  absl::Status structure() {
    IRSIG_STORE_TRY(for_each(database_, sql::integrity_check, [&](Rows& row) {
      if (std::string said = row.text(); said != "ok")
        found(StoreFinding::Kind::kDamaged, absl::StrCat("the file: ", said));
    }));
    IRSIG_STORE_TRY(for_each(database_, sql::foreign_key_check, [&](Rows& row) {
      const std::string table = row.text();
      found(StoreFinding::Kind::kDamaged,
            absl::StrCat("table ", table, ": ", row.integer(), " rows refer to what is not there"));
    }));
    return absl::OkStatus();
  }

  absl::Status directions() {
    ASSIGN_OR_RETURN(const auto undirected,
                     database_.integer(sql::count_viewpoints_without_direction));
    if (undirected > 0)
      found(StoreFinding::Kind::kDamaged,
            absl::StrCat("table viewpoint_direction: ", undirected,
                         " viewpoints with signatures have no direction: no nearest finds them"));
    return absl::OkStatus();
  }

  absl::Status assets() {
    std::vector<std::string> damaged;
    IRSIG_STORE_TRY(for_each(database_, sql::assets, [&](Rows& row) {
      const std::string sha256 = row.text();
      if (sha256_of(row.blob()) != sha256) damaged.push_back(sha256);
    }));
    Named named(findings_, "assets that are not those of their SHA-256",
                how_to_replace_asset(database_.path()));
    for (const std::string& sha256 : damaged) {
      const absl::StatusOr<std::string> what = describe_asset(database_, sha256);
      named.add(what.ok() ? *what : sha256);
    }
    return absl::OkStatus();
  }

  absl::Status numbers() {
    for (std::size_t q = 0; q < kQuantities.size(); ++q) {
      ASSIGN_OR_RETURN(const auto count, database_.integer(kCountInfinite[q]));
      if (count > 0)
        found(StoreFinding::Kind::kDamaged,
              absl::StrCat(std::string(kQuantities[q].name), ": ", count,
                           " signatures have no finite number"));
    }
    ASSIGN_OR_RETURN(const auto sums, database_.integer(sql::count_sums_of_causes));
    if (sums > 0)
      found(StoreFinding::Kind::kDamaged,
            absl::StrCat("intensity_w_sr: ", sums, " signatures whose causes do not add up to it"));
    return absl::OkStatus();
  }

  // Spectra and images, of each signature.
  absl::Status contents() {
    struct Signature {
      std::int64_t id;
      std::string name;
    };
    std::vector<Signature> signatures;
    IRSIG_STORE_TRY(for_each(database_, sql::signature_rows, [&](Rows& row) {
      const std::int64_t id = row.integer();
      const std::string sweep = row.text();
      signatures.push_back({id, absl::StrCat(sweep, " row ", row.integer())});
    }));
    Named spectra(findings_, "spectra that cannot be read, or with what is no finite number"),
        modes(findings_, "modes of errors that do not fit their spectra"),
        clutter(findings_, "spectra of backgrounds that are missing or cannot be read"),
        images(findings_, "images that are damaged");
    for (const Signature& s : signatures) {
      const auto spectrum = reader_.spectrum(s.id);
      if (absl::IsNotFound(spectrum.status()) || absl::IsDataLoss(spectrum.status())) {
        spectra.add(s.name);
      } else if (!spectrum.ok()) {
        return spectrum.status();
      } else if (!modes_fit(*spectrum)) {
        modes.add(s.name);
      }
      ASSIGN_OR_RETURN(const auto measured, database_.integer(sql::has_clutter, s.id));
      const auto of_clutter = reader_.clutter(s.id);
      if (!of_clutter.ok() && !absl::IsDataLoss(of_clutter.status())) return of_clutter.status();
      if (!of_clutter.ok() || of_clutter->has_value() != (measured != 0)) clutter.add(s.name);
      ASSIGN_OR_RETURN(const auto thumbnail, reader_.thumbnail(s.id));
      if (thumbnail && (!check_thumbnail(*thumbnail, s.name).ok() || !shows_parts(s.id) ||
                        !layers_are_whole(s.id, *thumbnail)))
        images.add(s.name);
    }
    return absl::OkStatus();
  }

  bool layers_are_whole(std::int64_t signature_id, const schema::Thumbnail& thumbnail) {
    const auto layers = reader_.image_layers(signature_id);
    return layers.ok() && std::all_of(layers->begin(), layers->end(), [&](const auto& layer) {
             return check_image_layer(layer, thumbnail.width_px(), thumbnail.height_px(), "").ok();
           });
  }

  // Returns true if the silhouette of a row with an image is present and undamaged.
  bool shows_parts(std::int64_t signature_id) {
    const auto silhouette = reader_.silhouette(signature_id);
    return silhouette.ok() && silhouette->has_value();
  }

  absl::Status coverage() {
    std::map<std::pair<std::string, JobState>, ListPlaces> without;
    IRSIG_STORE_TRY(for_each(database_, sql::jobs_without_rows, [&](Rows& row) {
      const std::string sweep = row.text();
      const auto state = static_cast<JobState>(row.integer());
      without[{sweep, state}].add(row.integer());
    }));
    for (const auto& [of, jobs] : without)
      if (of.second == JobState::kDone)
        found(StoreFinding::Kind::kDamaged,
              absl::StrCat("sweep ", of.first,
                           ": jobs that are done, but have no rows: ", jobs.text()));
    return for_each(database_, sql::coverage, [&](Rows& row) {
      const std::string sweep = row.text();
      const std::int64_t jobs = row.integer(), open = row.integer(), given_up = row.integer(),
                         cancelled = row.integer(), lists = row.integer(), stored = row.integer(),
                         replaced = row.integer();
      schema::ResolvedSweep resolved;
      if (!resolved.ParseFromString(row.text()))
        found(StoreFinding::Kind::kDamaged,
              absl::StrCat("sweep ", sweep, ": its definition cannot be read"));
      // Not every place of a slice's lists was chosen; a shard has some viewpoints.
      const std::int64_t wanted =
          resolved.slice_size() > 0 ? static_cast<std::int64_t>(resolved.slice().rbegin()->rows())
          : resolved.has_shard()    ? static_cast<std::int64_t>(shard_size(resolved)) *
                                       resolved.condition_size() * resolved.sweep().band_size()
                                 : lists;
      const auto say = [&](std::int64_t count, const char* what, JobState state) {
        if (count > 0)
          found(Kind::kMissing, absl::StrCat("sweep ", sweep, ": ", count, " of ", jobs, " jobs ",
                                             what, " (jobs ", without[{sweep, state}].text(), ")"));
      };
      say(open, "are not done: the same `irsig run` with --resume goes on", JobState::kWaiting);
      say(given_up, "were given up: the same `irsig run` with --resume tries again",
          JobState::kQuarantined);
      say(cancelled, "were cancelled: submit the sweep again", JobState::kCancelled);
      if (replaced > 0)
        found(Kind::kOld,
              absl::StrCat("sweep ", sweep, ": ", replaced, " of ", jobs,
                           " jobs are of an earlier version of the sweep, until they are "
                           "replaced"));
      if (open + given_up + cancelled == 0 && stored != wanted)
        found(Kind::kDamaged, absl::StrCat("sweep ", sweep, ": ", stored, " signatures for ",
                                           wanted, " rows, though all jobs are done"));
    });
  }

  absl::Status age(int physics_version) {
    return for_each(database_, sql::physics_versions, [&](Rows& row) {
      const std::string sweep = row.text();
      const std::int64_t version = row.integer(), jobs = row.integer();
      if (version != physics_version)
        found(StoreFinding::Kind::kOld,
              absl::StrCat("sweep ", sweep, ": ", jobs, " jobs of physics version ", version,
                           ", this program has ", physics_version));
    });
  }

  Database& database_;
  StoreReader& reader_;
  std::vector<StoreFinding> findings_;
};

// database, reader: two connections to one file.
std::vector<StoreFinding> look_at(Database& database, StoreReader& reader, int physics_version) {
  Examination examination(database, reader);
  // A file so broken that a statement fails is damaged, too; what was found before stays.
  const absl::Status status = examination.run(physics_version);
  std::vector<StoreFinding> findings = examination.take();
  if (!status.ok())
    findings.push_back({StoreFinding::Kind::kDamaged,
                        absl::StrCat("it cannot be read to its end: ", status.message())});
  return findings;
}

// By itself, whatever its header says of a journal.
absl::StatusOr<std::vector<StoreFinding>> examine_as_it_is(const std::string& path,
                                                           int physics_version) {
  ASSIGN_OR_RETURN(const auto database, open_as_it_is(path));
  ASSIGN_OR_RETURN(const auto reader, StoreReader::open_as_it_is(path));
  return look_at(*database, *reader, physics_version);
}

bool is_damaged(const std::vector<StoreFinding>& findings) {
  return std::any_of(findings.begin(), findings.end(),
                     [](const StoreFinding& f) { return f.kind == StoreFinding::Kind::kDamaged; });
}

}  // namespace

absl::StatusOr<std::vector<StoreFinding>> examine(const std::string& path, int physics_version) {
  ASSIGN_OR_RETURN(const auto database, open_for_reading(path));
  ASSIGN_OR_RETURN(const auto reader, StoreReader::open(path));
  return look_at(*database, *reader, physics_version);
}

absl::StatusOr<AcceptedFile> accept_file(const std::string& path, int physics_version) {
  AcceptedFile out;
  const std::string real = real_path(path);
  if (const absl::StatusOr<FileHeader> header = read_file_header(real);
      !header.ok() || !header->write_ahead_log) {
    ASSIGN_OR_RETURN(auto findings, examine(path, physics_version));
    out.findings = std::move(findings);
    out.damaged = is_damaged(out.findings);
    return out;
  }
  WritableDatabase opened;
  opened.path = real;
  ASSIGN_OR_RETURN(auto lock, WriterLock::acquire(real, path));
  opened.lock = std::move(lock);
  IRSIG_STORE_TRY(check_has_one_name(path, real));
  ASSIGN_OR_RETURN(auto findings, has_journal(real) ? examine(path, physics_version)
                                                    : examine_as_it_is(path, physics_version));
  out.findings = std::move(findings);
  out.damaged = is_damaged(out.findings);
  if (out.damaged) return out;
  ASSIGN_OR_RETURN(auto database, Database::open(real, Database::Mode::kReadWriteCreate));
  opened.database = std::move(database);
  IRSIG_STORE_TRY(end_write_ahead(opened));
  out.made_plain = true;
  for (const auto& [count, sql] :
       {std::pair{&out.sweeps, sql::count_sweeps}, {&out.rows, sql::count_signatures}}) {
    ASSIGN_OR_RETURN(const std::int64_t there, opened.database->integer(sql));
    *count = static_cast<std::uint64_t>(there);
  }
  return out;
}

}  // namespace irsig
