#include "schema/store/examine.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/accuracy/quantities.h"
#include "core/accuracy/spectral_modes.h"
#include "google/protobuf/reflection.h"
#include "schema/shard.h"
#include "schema/store/check_picture.h"
#include "schema/store/find_signatures.h"
#include "schema/store/open_database.h"
#include "schema/store/sha256.h"
#include "schema/store/statements.h"
#include "schema/store/store.h"

namespace irsig {
namespace {

constexpr std::size_t kMostNamed = 5;

// How many signatures have an infinite number in a column. (SQLite stores what is not a number as
// NULL, which the columns that must be there refuse.)
#define IRSIG_COUNT_VALUE(name, stderr_name, unit, since, what)                   \
  "SELECT count(*) FROM signature WHERE abs(" #name ") > 1.7976931348623157e308", \
      "SELECT count(*) FROM signature WHERE abs(" #stderr_name ") > 1.7976931348623157e308",
#define IRSIG_COUNT_NUMBER(name, kind, unit, since, what) \
  "SELECT count(*) FROM signature WHERE abs(" #name ") > 1.7976931348623157e308",
constexpr const char* kCountInfinite[] = {IRSIG_QUANTITIES(IRSIG_COUNT_VALUE, IRSIG_COUNT_NUMBER)};
#undef IRSIG_COUNT_VALUE
#undef IRSIG_COUNT_NUMBER
static_assert(std::size(kCountInfinite) == kQuantities.size());

// Findings of one kind of damage, of which the first few are named.
class Named {
 public:
  Named(std::vector<StoreFinding>& findings, std::string what)
      : findings_(findings), what_(std::move(what)) {}
  void add(const std::string& which) {
    if (++count_ <= kMostNamed) absl::StrAppend(&which_, which_.empty() ? "" : ", ", which);
  }
  ~Named() {
    if (count_ == 0) return;
    const std::string more =
        count_ > kMostNamed ? absl::StrCat(" and ", count_ - kMostNamed, " more") : "";
    findings_.push_back({StoreFinding::Kind::kDamaged, absl::StrCat(what_, ": ", which_, more)});
  }
  Named(const Named&) = delete;
  Named& operator=(const Named&) = delete;

 private:
  std::vector<StoreFinding>& findings_;
  std::string what_, which_;
  std::size_t count_ = 0;
};

// Calls read(row) for each row of a statement without parameters.
template <typename Read>
absl::Status for_each(Database& database, const char* sql, const Read& read) {
  absl::StatusOr<Rows> row = database.query(sql);
  if (!row.ok()) return row.status();
  for (;;) {
    const absl::StatusOr<bool> found = row->next();
    if (!found.ok()) return found.status();
    if (!*found) return absl::OkStatus();
    read(*row);
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
  Examination(Database& database, StoreReader& reader) : database_(database), reader_(reader) {}

  absl::Status run(int physics_version) {
    IRSIG_STORE_TRY(structure());
    IRSIG_STORE_TRY(assets());
    IRSIG_STORE_TRY(numbers());
    IRSIG_STORE_TRY(contents());
    IRSIG_STORE_TRY(coverage());
    return age(physics_version);
  }
  [[nodiscard]] std::vector<StoreFinding> take() { return std::move(findings_); }

 private:
  void found(StoreFinding::Kind kind, std::string what) {
    findings_.push_back({kind, std::move(what)});
  }

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
    const auto undirected = database_.integer(sql::count_viewpoints_without_direction);
    if (!undirected.ok()) return undirected.status();
    if (*undirected > 0)
      found(StoreFinding::Kind::kDamaged,
            absl::StrCat("table viewpoint_direction: ", *undirected,
                         " viewpoints with signatures have no direction: no nearest finds them"));
    return absl::OkStatus();
  }

  absl::Status assets() {
    Named damaged(findings_, "assets that are not those of their SHA-256");
    return for_each(database_, sql::assets, [&](Rows& row) {
      const std::string sha256 = row.text();
      if (sha256_of(row.blob()) != sha256) damaged.add(sha256);
    });
  }

  absl::Status numbers() {
    for (std::size_t q = 0; q < kQuantities.size(); ++q) {
      const auto count = database_.integer(kCountInfinite[q]);
      if (!count.ok()) return count.status();
      if (*count > 0)
        found(StoreFinding::Kind::kDamaged,
              absl::StrCat(std::string(kQuantities[q].name), ": ", *count,
                           " signatures have no finite number"));
    }
    const auto sums = database_.integer(sql::count_sums_of_causes);
    if (!sums.ok()) return sums.status();
    if (*sums > 0)
      found(
          StoreFinding::Kind::kDamaged,
          absl::StrCat("intensity_w_sr: ", *sums, " signatures whose causes do not add up to it"));
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
      const auto thumbnail = reader_.thumbnail(s.id);
      if (!thumbnail.ok()) return thumbnail.status();
      if (*thumbnail && !check_thumbnail(**thumbnail, s.name).ok()) images.add(s.name);
    }
    return absl::OkStatus();
  }

  absl::Status coverage() {
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
      const auto say = [&](StoreFinding::Kind kind, std::int64_t count, const char* what) {
        if (count > 0)
          found(kind, absl::StrCat("sweep ", sweep, ": ", count, " of ", jobs, " jobs ", what));
      };
      using Kind = StoreFinding::Kind;
      say(Kind::kMissing, open, "are not done: the same `irsig run` with --resume goes on");
      say(Kind::kMissing, given_up,
          "were given up: the same `irsig run` with --resume tries again");
      say(Kind::kMissing, cancelled, "were cancelled: submit the sweep again");
      say(Kind::kOld, replaced, "are of an earlier version of the sweep, until they are replaced");
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

}  // namespace

absl::StatusOr<std::vector<StoreFinding>> examine(const std::string& path, int physics_version) {
  const auto database = open_for_reading(path);
  if (!database.ok()) return database.status();
  const auto reader = StoreReader::open(path);
  if (!reader.ok()) return reader.status();
  Examination examination(**database, **reader);
  // A file so broken that a statement fails is damaged, too; what was found before stays.
  const absl::Status status = examination.run(physics_version);
  std::vector<StoreFinding> findings = examination.take();
  if (!status.ok())
    findings.push_back({StoreFinding::Kind::kDamaged,
                        absl::StrCat("it cannot be read to its end: ", status.message())});
  return findings;
}

}  // namespace irsig
