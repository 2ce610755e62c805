#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "schema/result.pb.h"
#include "schema/store/tables/filters.h"
#include "schema/store/tables/rows.h"

namespace irsig {

class Database;

// The reading side of a signature database. There may be any number of readers, also while the
// coordinator writes. Not thread-safe: one thread owns an object.
class StoreReader {
 public:
  static absl::StatusOr<std::unique_ptr<StoreReader>> open(const std::string& path);
  // Reads a file whose journal is missing (schema/store/whole_file.h), for the examination before
  // the file is accepted.
  static absl::StatusOr<std::unique_ptr<StoreReader>> open_as_it_is(const std::string& path);
  // Takes a connection that has the tables of schema/sql/create.sql.
  explicit StoreReader(std::unique_ptr<Database> database);
  ~StoreReader();
  StoreReader(const StoreReader&) = delete;
  StoreReader& operator=(const StoreReader&) = delete;

  // Returns signatures in row order; with a direction: nearest first.
  absl::StatusOr<std::vector<StoredSignature>> find(const SignatureFilter& filter);
  // Returns the signature_ids of find(), in its order, for streaming large results.
  absl::StatusOr<std::vector<std::int64_t>> find_ids(const SignatureFilter& filter);
  // Returns signatures in the order of the ids. NOT_FOUND: one has been replaced or removed since.
  absl::StatusOr<std::vector<StoredSignature>> read(std::span<const std::int64_t> ids);
  // Returns the contents in the order in which sweeps were added.
  absl::StatusOr<std::vector<SweepContents>> contents();
  // Returns values in row order; of a row and its superseded predecessor the newer one.
  absl::StatusOr<std::vector<StoredValue>> values(const ValueFilter& filter);
  // Returns the spectra of a signature; arrays that were not computed are empty.
  absl::StatusOr<schema::Spectrum> spectrum(std::int64_t signature_id);
  // Returns a stored sweep. NOT_FOUND: no sweep of that name. DATA_LOSS: the bytes of a file differ
  // from its SHA-256.
  absl::StatusOr<StoredSweep> sweep(const std::string& name, SweepFiles files = SweepFiles::kAll);
  absl::StatusOr<std::vector<StoredPart>> parts(std::int64_t signature_id);
  // Returns the spectra of the background around the target; nullopt: it was not measured.
  // DATA_LOSS: they do not fit the band.
  absl::StatusOr<std::optional<schema::Clutter>> clutter(std::int64_t signature_id);
  absl::StatusOr<StoredLedger> ledger(std::int64_t signature_id);
  // Returns inputs in the order of the grammar; none of a sweep without [uncertainty].
  absl::StatusOr<std::vector<StoredInput>> inputs(std::int64_t signature_id);
  absl::StatusOr<std::optional<schema::Thumbnail>> thumbnail(std::int64_t signature_id);
  // Returns the further images of a row, by name; nullopt: it has none of that name.
  absl::StatusOr<std::vector<schema::ImageLayer>> image_layers(std::int64_t signature_id);
  absl::StatusOr<std::optional<schema::ImageLayer>> image_layer(std::int64_t signature_id,
                                                                const std::string& name);
  // Returns the parts that the images of the signature's job show. DATA_LOSS: they are damaged.
  absl::StatusOr<std::optional<StoredSilhouette>> silhouette(std::int64_t signature_id);
  // Returns rows in the order of sweeps, rows, profiles, points and numbers of reflections.
  absl::StatusOr<std::vector<StoredProfileRow>> profiles(const ProfileFilter& filter);
  absl::StatusOr<std::vector<StoredPublished>> published(const std::string& sweep);
  absl::StatusOr<std::vector<SweepProgress>> progress();
  // Returns the prediction of a sweep; nullopt if none was stored.
  absl::StatusOr<std::optional<StoredPrediction>> prediction(const std::string& sweep_sha256);
  // Returns the costs of the sweep's done jobs, in the order of its jobs.
  absl::StatusOr<std::vector<StoredJobCost>> job_costs(const std::string& sweep);
  // Returns temperatures in the order of sweeps, heat runs, times and parts.
  absl::StatusOr<std::vector<StoredTemperature>> computed_temperatures(
      const TemperatureFilter& filter);
  // Returns the heat jobs in the order of the sweep's heat runs.
  absl::StatusOr<std::vector<StoredHeatJob>> heat_jobs(const std::string& sweep);
  // Counts the stored rows of a sweep, without superseded ones.
  absl::StatusOr<StoredOutcome> outcome(const std::string& sweep);
  // Calls visit(row) for each stored row of a sweep, in the order of rows, superseded ones
  // included. The row has what decides the error of its source intensity (source_of in view/rows),
  // its stop reason, limiting bound and whether it is superseded; all else is empty or
  // kNotComputed.
  absl::Status visit_errors(const std::string& sweep,
                            const std::function<void(const StoredSignature&)>& visit);
  // Returns the number of stored rows by job key, superseded jobs included.
  absl::StatusOr<std::map<std::string, std::uint64_t>> rows_of_jobs(const std::string& sweep);
  // Returns the size of the database as one plain file.
  absl::StatusOr<std::uint64_t> bytes();
  // Returns the SHA-256 over all stored content that does not depend on time, place, worker and
  // order of the computation, in key order (schema/README.md).
  absl::StatusOr<std::string> digest();

 private:
  absl::StatusOr<StoredSweep> stored_sweep(const std::string& name, SweepFiles files);
  absl::Status check_exists(std::int64_t signature_id);

  std::unique_ptr<Database> database_;
};

}  // namespace irsig
