#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/accuracy/quantities.h"
#include "schema/assets.h"
#include "schema/job.pb.h"
#include "schema/store/tables/spooled_file.h"
#include "schema/sweep.pb.h"

// The values that a database stores: the writer (writer.h) takes them, the reader (reader.h)
// returns them.

namespace irsig {

// The states of a job, as stored (numbers are never reused).
enum class JobState : int {
  kWaiting = 0,
  kLeased = 1,
  kDone = 2,
  kQuarantined = 3,
  kCancelled = 4
};

// The jobs of a sweep that was added, and those of them that are missing or stale.
struct AddedJobs {
  std::uint64_t jobs;
  std::uint64_t to_compute;
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
  // [spec.needs] SHA-256 of the asset that each needed job has produced; empty: jobs of its kind
  // produce none.
  std::vector<std::string> output = {};
};

// A job with the hash of its result (content.h) and the worker that computed it; both are empty
// unless the job is done.
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
// The cost of a sweep as a pilot predicted it before the run. CPU times are those of the jobs; the
// wall time is for `workers` workers, including their start.
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

// The cost of one done job.
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

// Computed temperatures of a part's facets, weighted by area.
struct StoredTemperature {
  std::string sweep, season, time_utc, part;
  double mean_k, coldest_k, hottest_k, error_k;
  bool superseded;  // of an earlier version of its sweep, until its replacement is stored
  std::string job_key;
};

// A job that computes temperatures.
struct StoredHeatJob {
  std::string season;
  bool done;
  double cpu_s;
  std::string warning;  // one line each
};

// Why the rows of a sweep have no more samples.
struct StoredOutcome {
  std::vector<std::pair<std::string, std::uint64_t>> stop;  // by reason, in the table's order
  std::uint64_t backface_views = 0;                         // with a backface_fraction above 0
  double largest_backface_fraction = 0;
  // The largest of all images (Thumbnail.error_relative and error_k).
  double image_error_relative = 0, image_error_k = 0;
};

// A number that a row does not have, such as hot gas in a condition without it. It is NaN: test
// with std::isnan.
inline constexpr double kNotComputed = std::numeric_limits<double>::quiet_NaN();

// Where a view's images show which part.
struct StoredSilhouette {
  std::uint32_t width_px = 0, height_px = 0, pixel_samples = 0;
  struct Pixel {
    std::uint32_t at;       // row by row from the top left
    std::uint16_t samples;  // of the pixel that meet the part first, or the set; > 0
  };
  struct Part {
    std::string name;
    std::vector<Pixel> pixel;
  };
  std::vector<Part> part;  // those that are seen, in the sweep's order
  // Rays that meet exactly these parts, one behind the other, if the sweep asked for whole parts.
  struct PartSet {
    std::vector<std::string> part;
    double outside_px = 0;  // area of such rays outside the frame [pixels]
    std::vector<Pixel> pixel;
  };
  std::vector<PartSet> part_set = {};
};

// One stored signature without its spectrum and images.
struct StoredSignature {
  std::int64_t signature_id;
  std::uint64_t
      row;  // 1-based place in its sweep: ((viewpoint * conditions) + condition) * bands + band + 1
  std::string sweep, season, time_utc, band;
  // "HH:MM" of the mean sun at the target's longitude; empty: no place is stated.
  std::string mean_solar_time;
  double lambda_min_um, lambda_max_um;
  double aspect_azimuth_deg, aspect_elevation_deg, range_m;
  double unit_x, unit_y, unit_z;  // unit vector target -> sensor, body frame
  double sun_azimuth_deg, sun_zenith_deg;
  // The catalogue's quantities, each by its name; kNotComputed where a row does not have one.
#define IRSIG_VALUE_MEMBERS(name, stderr_name, unit, what) double name, stderr_name;
#define IRSIG_NUMBER_MEMBER(name, kind, unit, what) double name;
  IRSIG_COMPUTED_QUANTITIES(IRSIG_VALUE_MEMBERS, IRSIG_NUMBER_MEMBER)
#undef IRSIG_VALUE_MEMBERS
#undef IRSIG_NUMBER_MEMBER
#define IRSIG_VALUE_MEMBERS(name, stderr_name, unit, what) \
  double name = kNotComputed, stderr_name = kNotComputed;
#define IRSIG_NUMBER_MEMBER(name, kind, unit, what) double name = kNotComputed;
  IRSIG_PLUME_QUANTITIES(IRSIG_VALUE_MEMBERS, IRSIG_NUMBER_MEMBER)
  IRSIG_CLUTTER_QUANTITIES(IRSIG_VALUE_MEMBERS, IRSIG_NUMBER_MEMBER)
  IRSIG_INPUT_QUANTITIES(IRSIG_NUMBER_MEMBER)
#undef IRSIG_VALUE_MEMBERS
#undef IRSIG_NUMBER_MEMBER
  // The three inputs that contribute most to input_uncertainty_w_sr, beyond the noise of their
  // difference: "name=+gain, ..." [W/sr]. Empty: none is known.
  std::string dominant_inputs;
  std::optional<std::uint64_t> reflections;  // the most that a path was given
  std::string stop_reason;
  // The largest part of the numerical error of a row that missed its accuracy: "sampling", or the
  // name of a bound (core/accuracy/measured.h). Empty: the row did not miss it.
  std::string limiting_bound;
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

// The member of a signature for each of kQuantities.
#define IRSIG_VALUE_PLACES(name, stderr_name, unit, what) \
  &StoredSignature::name, &StoredSignature::stderr_name,
#define IRSIG_NUMBER_PLACE(name, kind, unit, what) &StoredSignature::name,
inline constexpr std::array<double StoredSignature::*, kQuantities.size()> kQuantityMember = {
    IRSIG_QUANTITIES(IRSIG_VALUE_PLACES, IRSIG_NUMBER_PLACE)};
#undef IRSIG_VALUE_PLACES
#undef IRSIG_NUMBER_PLACE

// Removes the quantities of the background around the target: a row that was moved or interpolated
// has none.
inline void remove_clutter(StoredSignature& s) {
#define IRSIG_REMOVE_VALUE(name, stderr_name, unit, what) s.name = s.stderr_name = kNotComputed;
#define IRSIG_REMOVE_NUMBER(name, kind, unit, what) s.name = kNotComputed;
  IRSIG_CLUTTER_QUANTITIES(IRSIG_REMOVE_VALUE, IRSIG_REMOVE_NUMBER)
#undef IRSIG_REMOVE_VALUE
#undef IRSIG_REMOVE_NUMBER
}

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

// The gain of a signature if an uncertain input is one sigma higher.
struct StoredInput {
  std::string input;  // a key of [uncertainty]
  struct Gain {
    double contribution_w_sr, stderr_w_sr;
    double curvature_w_sr;  // half the sum of both sides' gains; kNotComputed: one side only
  };
  Gain source, apparent, contrast;
};

// Ends of the light that the sensor would send out, as fractions.
struct StoredEnergy {
  double absorbed, absorbed_stderr, escaped_to_sky, escaped_to_sky_stderr, escaped_to_surface,
      escaped_to_surface_stderr, cut_off, cut_off_stderr, balance, balance_stderr;
};

struct StoredLedger {
  std::vector<StoredEffect> effect;
  std::optional<StoredEnergy> energy;  // nullopt: the sensor sees nothing of the target
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
  double source_radiance_temperature_k, source_radiance_temperature_stderr_k;  // 0: no radiance
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
  double source_radiance_temperature_k;
  std::string relation;  // equal, below, above
  std::string source, remark;
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
  bool thumbnails = false;      // requested
  bool clutter = false;         // a row has some: its target stands before land
};

// One quantity of one signature, for pictures of all aspects. kNotComputed as in StoredSignature.
struct StoredValue {
  std::uint64_t row;
  double aspect_azimuth_deg, aspect_elevation_deg;
  double value, value_stderr, numerical_error;
  double input_uncertainty = kNotComputed;  // known where it was taken from a signature
};
// A sweep as it was submitted, and its files.
struct StoredSweep {
  schema::ResolvedSweep resolved;
  Assets assets;
  HeatOutputs heat;  // empty unless all its heat jobs are done
};

}  // namespace irsig
