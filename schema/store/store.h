#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/accuracy/quantities.h"
#include "schema/assets.h"
#include "schema/job.pb.h"
#include "schema/result.pb.h"
#include "schema/store/spooled_file.h"

namespace irsig {

// The states of a job, as stored (numbers are never reused).
enum class JobState : int {
  kWaiting = 0,
  kLeased = 1,
  kDone = 2,
  kQuarantined = 3,
  kCancelled = 4
};

struct Asset {
  std::string sha256;  // hex
  std::string bytes;
  std::shared_ptr<SpooledFile> file = nullptr;  // instead of bytes
};

struct QueuedJob {
  schema::JobSpec spec;
  JobState state;
  std::uint32_t failures;       // distinct workers that failed on it
  std::uint64_t fencing_token;  // of the current lease, 0 if none
  // [spec.needs] The asset that each has left, by its SHA-256; empty: its kind leaves none.
  std::vector<std::string> output = {};
};

// A job as it stands, and of a done one what its result was (content.h) and who computed it. Empty:
// an older version of the format stored it, and did not say.
struct KnownJob {
  QueuedJob job;
  std::string content_sha256, worker_name;
};

struct SweepProgress {
  std::string name;
  std::string sweep_sha256;
  std::uint64_t jobs, waiting, leased, done, quarantined, cancelled, rays;
  double worst_relative_error;
  std::vector<std::string> failures;
  std::uint64_t heat_jobs = 0, heat_done = 0;  // of the jobs: those that compute temperatures
  int priority = 0;
};
// Limit of a sweep's priority: -kMostPriority to kMostPriority.
inline constexpr int kMostPriority = 1000;
[[nodiscard]] absl::Status check_priority(int priority);

// A pilot's prediction, made before the run, of a sweep's cost. CPU times are those of the jobs;
// wall time is that of so many workers, their start included.
struct StoredPrediction {
  std::string sweep_sha256;
  double made_unix_s = 0;
  std::string determinism_class;  // of the machine that the pilot ran on
  std::uint64_t workers = 0, pilot_viewpoints = 0;
  double pilot_cpu_s = 0;
  std::uint64_t jobs = 0;
  double cpu_s = 0, wall_s = 0;
  double job_cpu_quartile1_s = 0, job_cpu_median_s = 0, job_cpu_quartile3_s = 0;
  std::uint64_t database_bytes = 0;
};

// Cost of one done job.
struct StoredJobCost {
  std::uint64_t job_index = 0, viewpoint_index = 0;
  double cpu_s = 0;
  std::uint64_t samples = 0, replicates = 0, target_paths = 0, rays = 0;
  std::uint64_t guarded_backface_hits = 0, guarded_nonfinite = 0, truncated_paths = 0;
  std::optional<std::uint64_t> guarded_negative;  // nullopt: was not counted
  std::string worker_name;
  double leased_unix_s = 0;
  std::string determinism_class;
};

// Computed temperatures of a part's facets, by area.
struct StoredTemperature {
  std::string sweep, season, time_utc, part;
  double mean_k, coldest_k, hottest_k, error_k;
  bool superseded;  // of an earlier version of its sweep, until its replacement is stored
  std::string job_key;
};

// An empty string means "any".
struct TemperatureFilter {
  std::string sweep, season, time_utc;
};

// A job that computes temperatures.
struct StoredHeatJob {
  std::string season;
  bool done;
  double cpu_s;
  std::string warning;  // one line each
};

// Outcomes of the rows of a sweep.
struct StoredOutcome {
  std::vector<std::pair<std::string, std::uint64_t>> stop;  // by reason, in the table's order
  std::uint64_t backface_views = 0;                         // with a backface_fraction above 0
  double largest_backface_fraction = 0;
};

// The writing side of a signature database: the coordinator is its only user. Not thread-safe: one
// thread owns it. Every mutation happens inside begin() ... commit(); commit() returns after the
// data is on disk (synchronous = FULL), so that many results can share one commit (group commit).
class StoreWriter {
 public:
  // Creates the file if it does not exist; migrates an older one; refuses one from a newer version,
  // a file that is no signature database, and a database that another writer holds.
  static absl::StatusOr<std::unique_ptr<StoreWriter>> open(const std::string& path);
  virtual ~StoreWriter() = default;

  virtual absl::Status begin() = 0;
  // Like begin(), but commit() returns before the disk has the transaction: if the machine dies
  // (not the process), the transaction may be lost, and with it all later ones, or none.
  virtual absl::Status begin_unsynced() = 0;
  virtual absl::Status commit() = 0;
  virtual void rollback() = 0;

  // One request among those that share a transaction: begun, then either kept or undone, so that a
  // statement that fails takes the others along no more. FAILED_PRECONDITION from undo_request():
  // the whole transaction is gone (the disk is full).
  virtual absl::Status begin_request() = 0;
  virtual absl::Status keep_request() = 0;
  virtual absl::Status undo_request() = 0;

  struct Added {
    std::uint64_t jobs;
    std::uint64_t to_compute;  // missing or stale ones
  };
  // Adds a sweep, its viewpoints, conditions, bands, parts, assets and jobs, or updates the one
  // with the same name: jobs whose key is already done keep their rows; rows of jobs that the sweep
  // no longer has are removed when their replacement is stored (rows whose viewpoint, season, time
  // or band is gone: now). Quarantined and cancelled jobs wait again. INVALID_ARGUMENT: the jobs do
  // not cover viewpoints x conditions x bands exactly once, something comes twice, an asset's bytes
  // are not those of its hash, or the model file is missing; then nothing was changed.
  virtual absl::StatusOr<Added> add_sweep(const schema::ResolvedSweep& sweep,
                                          const std::string& sweep_sha256,
                                          const std::vector<schema::JobSpec>& jobs,
                                          const std::vector<Asset>& assets) = 0;

  // The bytes of an asset, also of one that a job has left; under a sweep_sha256: the serialized
  // ResolvedSweep. DATA_LOSS: an asset's bytes are not those of its hash.
  virtual absl::StatusOr<std::string> asset(const std::string& sha256) = 0;

  // Replaces an earlier prediction of the same sweep, which need not have been added yet.
  virtual absl::Status store_prediction(const StoredPrediction& prediction) = 0;

  // Takes the next waiting job (of the first sweep of the highest priority that has one, in the
  // sweep's order; those that failed before come last) and leases it under a new fencing token;
  // nullopt: none is waiting.
  virtual absl::StatusOr<std::optional<QueuedJob>> lease_next(const std::string& worker_id,
                                                              double now_s) = 0;
  // Back to waiting, unless the token is no longer the job's (FAILED_PRECONDITION).
  virtual absl::Status release(std::uint64_t fencing_token, const std::string& reason) = 0;
  // NOT_FOUND: no sweep has this hash. nullopt: it does not have this job (any more).
  virtual absl::StatusOr<std::optional<KnownJob>> find_job(const std::string& sweep_sha256,
                                                           const std::string& job_key) = 0;
  // Leases this job to who has its result already; its token. FAILED_PRECONDITION unless the job
  // is waiting or quarantined; of the latter, what was given up because of it alone waits again.
  virtual absl::StatusOr<std::uint64_t> lease_job(const std::string& sweep_sha256,
                                                  const std::string& job_key,
                                                  const std::string& worker_id, double now_s) = 0;
  // Keeps a result that differs from what is stored of its job; of equal ones the first. False:
  // there are kMostAside already.
  static constexpr std::int64_t kMostAside = 1000;
  virtual absl::StatusOr<bool> store_conflicting_result(const std::string& sweep_sha256,
                                                        const schema::JobResult& result,
                                                        const std::string& content_sha256,
                                                        const std::string& worker_name,
                                                        double now_s) = 0;
  virtual absl::StatusOr<std::uint64_t> results_aside() = 0;
  // A done job waits again: another result than the stored one turned out to be right.
  virtual absl::Status reopen(const std::string& sweep_sha256, const std::string& job_key) = 0;
  // Reopens every job that this worker has computed, and the jobs that need one of them; returns
  // their number. Their stored results stay until they are replaced.
  virtual absl::StatusOr<std::uint64_t> reopen_all_of(const std::string& worker_name) = 0;
  // The tokens of all current leases.
  virtual absl::StatusOr<std::vector<std::uint64_t>> running_tokens() = 0;
  // Every lease of an earlier coordinator goes back to waiting: called once after open.
  virtual absl::Status release_all() = 0;
  // Counts a failure on this worker; after failures on 3 distinct workers, or 6 in all, the job is
  // quarantined; for_good: at once.
  virtual absl::Status fail(std::uint64_t fencing_token, const std::string& worker_name,
                            const std::string& message, bool for_good = false) = 0;
  // Stores the result and marks the job done, replacing the rows of earlier jobs for the same
  // viewpoint and conditions. FAILED_PRECONDITION: the token is not the current one.
  // INVALID_ARGUMENT: the result does not match its job. content_sha256: of the result, if it is
  // known already.
  virtual absl::Status complete(std::uint64_t fencing_token, const schema::JobResult& result,
                                const std::string& worker_name,
                                const std::string& content_sha256 = {}) = 0;
  // Done heat jobs whose output is damaged wait again; how many. Reads all of these outputs.
  virtual absl::StatusOr<std::uint64_t> reopen_damaged() = 0;
  // Marks the job done with what a job of the same key has left in another sweep of the database,
  // computed in this determinism class; false: there is none, and the lease goes on. Views are
  // never taken over: their rows are of their own sweep's places.
  virtual absl::StatusOr<bool> take_over(std::uint64_t fencing_token,
                                         const std::string& determinism_class) = 0;
  virtual absl::StatusOr<std::uint64_t> cancel(const std::string& sweep_sha256) = 0;
  // Sets the physics version with which the keys of a sweep were made; 0: not known (an older
  // database).
  virtual absl::Status set_physics_version(const std::string& sweep_sha256,
                                           std::uint32_t version) = 0;
  virtual absl::StatusOr<std::uint32_t> physics_version(const std::string& sweep_sha256) = 0;
  // Sets the priority of this sweep's jobs against those of others, from the next lease on; new
  // sweeps have 0. NOT_FOUND: no sweep has this hash. INVALID_ARGUMENT: beyond +-kMostPriority.
  virtual absl::Status set_priority(const std::string& sweep_sha256, int priority) = 0;
  virtual absl::StatusOr<std::vector<SweepProgress>> progress() = 0;
  // The determinism class that this database's unfinished sweeps are bound to; empty: not bound
  // yet.
  virtual absl::StatusOr<std::string> determinism_class() = 0;
  virtual absl::Status bind_determinism_class(const std::string& determinism_class) = 0;
  // Checkpoints the journal, so that one plain file remains. UNAVAILABLE: a reader has the file
  // open; everything is stored, the journal stays beside the file, and finish() may be called
  // again.
  virtual absl::Status finish() = 0;
  // Removes the file again if this writer made it and nothing was committed to it; true if it did,
  // and then this object is good for nothing but its destructor.
  virtual absl::StatusOr<bool> remove_if_unused() = 0;
};

// A number that the version which stored the row did not compute. It is NaN: test with std::isnan.
inline constexpr double kNotComputed = std::numeric_limits<double>::quiet_NaN();

// One stored signature without its spectrum and images.
struct StoredSignature {
  std::int64_t signature_id;
  std::uint64_t
      row;  // 1-based place in its sweep: ((viewpoint * conditions) + condition) * bands + band + 1
  std::string sweep, season, time_utc, band;
  double lambda_min_um, lambda_max_um;
  double aspect_azimuth_deg, aspect_elevation_deg, range_m;
  double unit_x, unit_y, unit_z;  // unit vector target -> sensor, body frame
  double sun_azimuth_deg, sun_zenith_deg;
  // The catalogue's quantities, each by its name; kNotComputed in rows of a format that did not
  // have it, and where not every row has it.
#define IRSIG_VALUE_MEMBERS(name, stderr_name, unit, since, what) double name, stderr_name;
#define IRSIG_NUMBER_MEMBER(name, kind, unit, since, what) double name;
  IRSIG_COMPUTED_QUANTITIES(IRSIG_VALUE_MEMBERS, IRSIG_NUMBER_MEMBER)
#undef IRSIG_VALUE_MEMBERS
#undef IRSIG_NUMBER_MEMBER
#define IRSIG_VALUE_MEMBERS(name, stderr_name, unit, since, what) \
  double name = kNotComputed, stderr_name = kNotComputed;
#define IRSIG_NUMBER_MEMBER(name, kind, unit, since, what) double name = kNotComputed;
  IRSIG_PLUME_QUANTITIES(IRSIG_VALUE_MEMBERS, IRSIG_NUMBER_MEMBER)
  IRSIG_INPUT_QUANTITIES(IRSIG_NUMBER_MEMBER)
#undef IRSIG_VALUE_MEMBERS
#undef IRSIG_NUMBER_MEMBER
  // The three inputs that contribute most to input_uncertainty_w_sr, beyond the noise of their
  // difference: "name=+gain, ..." [W/sr]. Empty: none is known.
  std::string dominant_inputs;
  std::optional<std::uint64_t> reflections;  // nullopt: of format version 4 or older
  std::string stop_reason;
  bool energy_gain;
  std::string warning;  // of the condition, one line each
  std::uint64_t samples, target_paths, rays;
  std::uint32_t replicates;
  double seconds;
  std::uint64_t guarded_backface_hits, guarded_nonfinite, truncated_paths;
  std::optional<std::uint64_t> guarded_negative;  // nullopt: was not counted
  std::string job_key, seed_hex, determinism_class, build_id;
  bool superseded;  // of an earlier version of its sweep, until its replacement is stored
  std::uint32_t physics_version;
};

// Member of a signature for each of kQuantities.
#define IRSIG_VALUE_PLACES(name, stderr_name, unit, since, what) \
  &StoredSignature::name, &StoredSignature::stderr_name,
#define IRSIG_NUMBER_PLACE(name, kind, unit, since, what) &StoredSignature::name,
inline constexpr std::array<double StoredSignature::*, kQuantities.size()> kQuantityMember = {
    IRSIG_QUANTITIES(IRSIG_VALUE_PLACES, IRSIG_NUMBER_PLACE)};
#undef IRSIG_VALUE_PLACES
#undef IRSIG_NUMBER_PLACE

struct StoredPart {
  std::string part;
  double intensity_w_sr, intensity_stderr_w_sr;
};

// One effect of a signature. kNotComputed: not known.
struct StoredEffect {
  std::string effect;
  std::string
      state;  // on, off (its bound is part of the numerical error), absent (nothing causes it)
  std::string reason;  // always, not_in_scene, within_fraction, above_fraction, other_row, no_goal,
                       // unbounded, forced, not_worth
  double bound_w_sr, apparent_bound_w_sr, contrast_bound_w_sr;
  double fraction_w_sr;
  double time_s;  // of the whole view, an estimate: spent (on) or saved (off)
};

// Change of a signature if an uncertain input is one sigma higher.
struct StoredInput {
  std::string input;  // a key of [uncertainty]
  struct Gain {
    double contribution_w_sr, stderr_w_sr;
    double curvature_w_sr;  // half the sum of both sides' gains; kNotComputed: one side only
  };
  Gain source, apparent, contrast;
};

// End of the light that the sensor would send out, by destination.
struct StoredEnergy {
  double absorbed, absorbed_stderr, escaped_to_sky, escaped_to_sky_stderr, escaped_to_surface,
      escaped_to_surface_stderr, cut_off, cut_off_stderr, balance, balance_stderr;
};

struct StoredLedger {
  std::vector<StoredEffect> effect;    // empty: of a row of format version 4 or older
  std::optional<StoredEnergy> energy;  // nullopt: the same, or nothing of the target is seen
};

// One row of a profile: mean in-band radiance over a footprint, with at most `reflections`
// reflections.
struct StoredProfileRow {
  std::string sweep, season, time_utc, band;
  double lambda_min_um, lambda_max_um;
  double aspect_azimuth_deg, aspect_elevation_deg, range_m;
  std::uint64_t row;  // of the signature that it belongs to
  std::string profile;
  std::uint64_t profile_index, point_index;
  double x_m, y_m, z_m, footprint_width_m, footprint_height_m;
  std::uint64_t reflections;
  double radiance_w_m2_sr, radiance_stderr_w_m2_sr;
  double apparent_radiance_w_m2_sr, apparent_radiance_stderr_w_m2_sr;
  double truncation_bound_w_m2_sr, quadrature_bound_w_m2_sr;
  double apparent_temperature_k, apparent_temperature_stderr_k;  // 0: no radiance
  double target_fraction;
  std::uint64_t samples, replicates;
  bool energy_gain;
  std::string seed_hex;
  std::uint64_t physics_version;
  std::string determinism_class, build_id, job_key;
};

// A number that the sweep file states beside a profile's own.
struct StoredPublished {
  std::string sweep, profile;
  std::uint64_t point_index, reflections;
  double apparent_temperature_k;
  std::string relation;  // equal, below, above
  std::string source, remark;
};

// An empty string means "any".
struct ProfileFilter {
  std::string sweep, season, band, profile;
};

// Selects a quantity of a signature (numbers are part of sql/query.sql).
enum class SignatureQuantity : int {
  kIntensity = 0,  // of the source
  kApparentIntensity = 1,
  kContrastIntensity = 2,
  kBackgroundRadiance = 3
};

// Filters of a query; an empty string or vector means "any".
struct SignatureFilter {
  std::string sweep, season, time_utc, band;
  // Numerical error / |value| of this quantity (of the background radiance: its standard error).
  std::optional<double> max_relative_error;
  SignatureQuantity error_of = SignatureQuantity::kIntensity;
  // Aspect filters: at most one. nearest: the signatures of the `nearest` closest viewpoints that
  // have one passing the other filters; within: inside a cap, its edge (to 1e-9 deg) included. A
  // direction alone only orders.
  struct Direction {
    double aspect_azimuth_deg, aspect_elevation_deg;
  };
  std::optional<Direction> direction;
  std::uint32_t nearest = 0;
  std::optional<double> within_deg;
  std::optional<std::uint64_t> row;
  std::optional<double> range_m;  // of the viewpoint, to 1e-9 of it
};

// The choices that a database offers, without its values.
struct SweepContents {
  std::string name;
  std::uint64_t viewpoints = 0, rows = 0;  // stored rows
  std::uint64_t whole_rows = 0;            // viewpoints x conditions x bands
  struct Condition {
    std::string season, time_utc;
  };
  std::vector<Condition> condition;  // in the sweep's order, none twice
  struct Band {
    std::string name;
    double lambda_min_um, lambda_max_um;
  };
  std::vector<Band> band;
  std::vector<double> range_m;  // of its viewpoints, increasing
  bool thumbnails = false;      // asked for
};

// One quantity of many signatures: what a picture of all aspects needs. kNotComputed as in
// StoredSignature.
struct StoredValue {
  std::uint64_t row;
  double aspect_azimuth_deg, aspect_elevation_deg;
  double value, value_stderr, numerical_error;
  double input_uncertainty = kNotComputed;  // known where it was taken from a signature
};
// All must be given: it is one condition and band from one range.
struct ValueFilter {
  std::string sweep, season, time_utc, band;
  double range_m = 0;
  SignatureQuantity quantity = SignatureQuantity::kIntensity;
};

// A sweep as it was submitted, and its files.
struct StoredSweep {
  schema::ResolvedSweep resolved;
  Assets assets;
  HeatOutputs heat;  // empty unless all its heat jobs are done
};
// Selects the files to read. A damaged file is an error only if it is selected.
enum class SweepFiles { kNone, kTemperatures, kAll };

// The reading side: any number of readers, also while the coordinator writes. One object belongs to
// one thread.
class StoreReader {
 public:
  static absl::StatusOr<std::unique_ptr<StoreReader>> open(const std::string& path);
  // Opens a file whose journal is missing (schema/store/whole_file.h), with its own content: for
  // the examination before it is accepted.
  static absl::StatusOr<std::unique_ptr<StoreReader>> open_as_it_is(const std::string& path);
  virtual ~StoreReader() = default;

  // Returns signatures in row order; with a direction: nearest first.
  virtual absl::StatusOr<std::vector<StoredSignature>> find(const SignatureFilter& filter) = 0;
  // Signature ids only, for streaming large results: those of find(), in its order.
  virtual absl::StatusOr<std::vector<std::int64_t>> find_ids(const SignatureFilter& filter) = 0;
  // Returns signatures in the order of the ids. NOT_FOUND: one has been replaced or removed since.
  virtual absl::StatusOr<std::vector<StoredSignature>> read(std::span<const std::int64_t> ids) = 0;
  // Returns the contents in the order in which sweeps were added.
  virtual absl::StatusOr<std::vector<SweepContents>> contents() = 0;
  // Returns values in row order; of a row and its superseded predecessor the newer one.
  virtual absl::StatusOr<std::vector<StoredValue>> values(const ValueFilter& filter) = 0;
  // Arrays that were not computed are empty.
  virtual absl::StatusOr<schema::Spectrum> spectrum(std::int64_t signature_id) = 0;
  // NOT_FOUND: no sweep of that name. DATA_LOSS: one of the files has other bytes than its SHA-256
  // says.
  virtual absl::StatusOr<StoredSweep> sweep(const std::string& name,
                                            SweepFiles files = SweepFiles::kAll) = 0;
  virtual absl::StatusOr<std::vector<StoredPart>> parts(std::int64_t signature_id) = 0;
  virtual absl::StatusOr<StoredLedger> ledger(std::int64_t signature_id) = 0;
  // Returns inputs in the order of the grammar; none of a sweep without [uncertainty].
  virtual absl::StatusOr<std::vector<StoredInput>> inputs(std::int64_t signature_id) = 0;
  virtual absl::StatusOr<std::optional<schema::Thumbnail>> thumbnail(std::int64_t signature_id) = 0;
  // Returns rows in the order of sweeps, rows, profiles, points and numbers of reflections.
  virtual absl::StatusOr<std::vector<StoredProfileRow>> profiles(const ProfileFilter& filter) = 0;
  virtual absl::StatusOr<std::vector<StoredPublished>> published(const std::string& sweep) = 0;
  virtual absl::StatusOr<std::vector<SweepProgress>> progress() = 0;
  // nullopt: none was stored.
  virtual absl::StatusOr<std::optional<StoredPrediction>> prediction(
      const std::string& sweep_sha256) = 0;
  // Returns the costs of the sweep's done jobs, in the order of its jobs.
  virtual absl::StatusOr<std::vector<StoredJobCost>> job_costs(const std::string& sweep) = 0;
  // Returns temperatures in the order of sweeps, heat runs, times and parts.
  virtual absl::StatusOr<std::vector<StoredTemperature>> computed_temperatures(
      const TemperatureFilter& filter) = 0;
  // Returns the heat jobs in the order of the sweep's heat runs.
  virtual absl::StatusOr<std::vector<StoredHeatJob>> heat_jobs(const std::string& sweep) = 0;
  // Returns the outcomes of its stored rows except superseded ones.
  virtual absl::StatusOr<StoredOutcome> outcome(const std::string& sweep) = 0;
  // Returns the number of rows that each job of a sweep has stored, by its key; superseded jobs
  // included.
  virtual absl::StatusOr<std::map<std::string, std::uint64_t>> rows_of_jobs(
      const std::string& sweep) = 0;
  // Size of the database as one plain file.
  virtual absl::StatusOr<std::uint64_t> bytes() = 0;
  // SHA-256 over everything that does not depend on when, where, by whom and in which pieces it was
  // computed, in key order: schema/README.md.
  virtual absl::StatusOr<std::string> digest() = 0;
};

// Returns true if a writer's lock lies beside the database, links followed. The lock of a writer
// that was killed stays there until the next writer ends.
[[nodiscard]] bool has_writer_lock(const std::string& path);

}  // namespace irsig
