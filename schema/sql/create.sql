-- The tables and views of a signature database, format 29. schema/README.md explains every table to its users.
--
-- A name that ends in a unit is a number in that unit. The same name stands for the same quantity in the messages
-- (schema/*.proto), in exports and on plot axes; core/accuracy/quantities.h explains every quantity of a row. Values
-- without a prefix are at the target; `apparent`, `contrast`, `background` and `path` values are at the sensor's
-- aperture. A column `x_stderr` is the standard error of `x`, one sigma.
--
-- No database is changed from one format to another before the first release (docs/decisions/0051): whoever changes
-- this file raises the number below, and kFormat in schema/store/open_database.h with it.

-- name: create
PRAGMA application_id = 0x49525347;  -- "IRSG": tells a signature database from every other SQLite file
PRAGMA user_version = 29;

-- Names of stored numbers ---------------------------------------------------------------------------------------------
-- Numbers are never reused. The tables let a person read a database without the program.

CREATE TABLE job_kind (
  kind INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE
) STRICT;
INSERT INTO job_kind VALUES (1, 'view'), (2, 'heat');

CREATE TABLE job_state (
  state INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE
) STRICT;
INSERT INTO job_state VALUES (0, 'waiting'), (1, 'leased'), (2, 'done'), (3, 'quarantined'), (4, 'cancelled');

CREATE TABLE attempt_outcome (
  outcome INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE
) STRICT;
INSERT INTO attempt_outcome VALUES (0, 'running'), (1, 'done'), (2, 'released'), (3, 'failed'), (4, 'revoked');

-- Why a row has no more samples. floor_reached: its error is above the requested relative error, and not above the
-- floor (accuracy.absolute_error_k).
CREATE TABLE stop_reason (
  stop_reason INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE
) STRICT;
INSERT INTO stop_reason VALUES
  (1, 'accuracy_reached'), (2, 'accuracy_not_reached'), (3, 'sample_limit'), (4, 'fixed_samples'), (5, 'floor_reached');

-- The effects of core/effects/effects.h, in the order in which people see them.
CREATE TABLE effect (
  effect INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE,
  bounded_with INTEGER REFERENCES effect,  -- the effect whose bound contains this one's; NULL: it has its own bound
  of_hot_gas INTEGER NOT NULL DEFAULT 0 CHECK (of_hot_gas IN (0, 1)),  -- 1: only rows with hot gas have it
  of_cloud INTEGER NOT NULL DEFAULT 0 CHECK (of_cloud IN (0, 1))       -- 1: only rows under a cloud may have it
) STRICT;
INSERT INTO effect (effect, name) VALUES
  (1, 'self_emission'), (2, 'direct_sun'), (3, 'diffuse_sun'), (4, 'mirrored_sun'), (5, 'sky_reflected'),
  (6, 'lower_reflected'), (7, 'inter_reflection'), (8, 'hot_parts_reflected'), (9, 'transmission'),
  (10, 'path_radiance'), (11, 'path_sun'), (12, 'background_sun'), (13, 'joined_lines'), (14, 'air_to_horizon'),
  (15, 'sun_disk'), (16, 'directional_emissivity'), (17, 'spectral_variation'), (18, 'perspective'),
  (19, 'refraction');
INSERT INTO effect (effect, name, of_hot_gas) VALUES
  (20, 'plume', 1), (21, 'plume_reflected', 1), (22, 'hot_line_correlation', 1);
INSERT INTO effect (effect, name, of_cloud) VALUES (23, 'cloud', 1);
UPDATE effect SET bounded_with = 7 WHERE name = 'hot_parts_reflected';

CREATE TABLE effect_state (
  state INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE
) STRICT;
INSERT INTO effect_state VALUES (1, 'on'), (2, 'off'), (3, 'absent');

-- Why an effect is on, off or absent: EffectReason in core/effects/effects.h.
CREATE TABLE effect_reason (
  reason INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE
) STRICT;
INSERT INTO effect_reason VALUES
  (1, 'always'), (2, 'not_in_scene'), (3, 'within_fraction'), (4, 'above_fraction'), (5, 'other_row'), (6, 'no_goal'),
  (7, 'not_worth'), (8, 'unbounded'), (9, 'forced'), (10, 'not_asked');

-- Sweeps: what a user asked for ---------------------------------------------------------------------------------------

CREATE TABLE sweep (
  sweep_id INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE CHECK (name <> ''),
  sweep_sha256 TEXT NOT NULL UNIQUE CHECK (sweep_sha256 <> ''),  -- of its encoding (jobs/keys/expand.h)
  viewpoints INTEGER NOT NULL CHECK (viewpoints > 0),            -- number of them, as of conditions and bands
  conditions INTEGER NOT NULL CHECK (conditions > 0),
  bands INTEGER NOT NULL CHECK (bands > 0),
  model_sha256 TEXT NOT NULL,
  longitude_deg REAL CHECK (abs(longitude_deg) <= 360),          -- of the target's place; NULL: not stated
  thumbnail_px INTEGER CHECK (thumbnail_px >= 0),                -- long side of the images; 0: none; NULL: not stated
  profile_rows INTEGER NOT NULL DEFAULT 0 CHECK (profile_rows >= 0),  -- of each signature: points x reflection counts
  image_layers TEXT NOT NULL DEFAULT '',                         -- names of [image] layers, separated by commas
  uncertain_inputs TEXT NOT NULL DEFAULT '',                     -- keys of [uncertainty], separated by commas
  priority INTEGER NOT NULL DEFAULT 0 CHECK (priority BETWEEN -1000 AND 1000),  -- the highest gives the next job
  physics_version INTEGER CHECK (physics_version > 0),           -- that the job keys were made with; NULL: not known
  determinism_class TEXT CHECK (determinism_class <> ''),        -- NULL: no worker has been bound yet
  resolved_sweep BLOB NOT NULL                                   -- irsig.schema.ResolvedSweep, serialized
) STRICT;
CREATE INDEX sweep_by_priority ON sweep (priority DESC, sweep_id);

-- Files that sweeps need, and outputs of heat jobs.
CREATE TABLE asset (
  sha256 TEXT PRIMARY KEY,  -- of the bytes, hex
  bytes BLOB NOT NULL
) STRICT;

CREATE TABLE sweep_asset (
  sweep_id INTEGER NOT NULL REFERENCES sweep ON DELETE CASCADE,
  sha256 TEXT NOT NULL REFERENCES asset,
  PRIMARY KEY (sweep_id, sha256)
) STRICT, WITHOUT ROWID;
CREATE INDEX sweep_asset_by_sha256 ON sweep_asset (sha256);

CREATE TABLE viewpoint (
  viewpoint_id INTEGER PRIMARY KEY,
  sweep_id INTEGER NOT NULL REFERENCES sweep ON DELETE CASCADE,
  viewpoint_index INTEGER NOT NULL CHECK (viewpoint_index >= 0),
  aspect_azimuth_deg REAL NOT NULL,
  aspect_elevation_deg REAL NOT NULL CHECK (aspect_elevation_deg BETWEEN -90 AND 90),
  range_m REAL NOT NULL CHECK (range_m > 0),
  UNIQUE (sweep_id, viewpoint_index),
  UNIQUE (sweep_id, aspect_azimuth_deg, aspect_elevation_deg, range_m)
) STRICT;

-- The unit vector from target to sensor in the body frame (x forward, y starboard, z down), of viewpoints that have or
-- had signatures, so that a query for the nearest passes no empty viewpoint. The tree keeps float32 boxes; the
-- auxiliary columns keep the vector itself, for the exact second step of such a query.
CREATE VIRTUAL TABLE viewpoint_direction USING rtree (
  viewpoint_id, min_x, max_x, min_y, max_y, min_z, max_z, +unit_x, +unit_y, +unit_z
);

-- A condition, band or part that a new version of its sweep defines differently stays, superseded, until all signatures
-- computed with it have been replaced.
--
-- A condition is one season at one time.
CREATE TABLE condition (
  condition_id INTEGER PRIMARY KEY,
  sweep_id INTEGER NOT NULL REFERENCES sweep ON DELETE CASCADE,
  condition_index INTEGER NOT NULL CHECK (condition_index >= 0),
  superseded INTEGER NOT NULL DEFAULT 0 CHECK (superseded IN (0, 1)),
  season TEXT NOT NULL,
  time_utc TEXT NOT NULL,
  sun_irradiance_w_m2 REAL NOT NULL,  -- 0: no sun
  air_temperature_k REAL NOT NULL,    -- 0 in vacuum
  surroundings TEXT NOT NULL,         -- 'sea', 'none', ...; a column of other surroundings is NULL
  sky_temperature_k REAL,
  sky_radiance_w_m2_sr_um REAL,
  sea_temperature_k REAL,
  sea_emissivity REAL,
  sea_model TEXT,                     -- 'cox_munk', 'flat', 'grey'
  ground_temperature_k REAL,
  ground_emissivity REAL,
  lower_radiance_w_m2_sr_um REAL,     -- of the lower hemisphere, surroundings = 'none'
  weather TEXT,                       -- irsig.schema.Weather as JSON, texts of files replaced by their SHA-256;
                                      -- NULL: no embedded atmosphere
  temperature_field TEXT,             -- source of the temperatures of parts without a row in part_temperature:
                                      -- 'computed' (by a heat job), or that of a file; NULL: all parts have a row
  heat_index INTEGER CHECK (heat_index >= 0),            -- heat run of computed temperatures: several seasons may
  heat_time_index INTEGER CHECK (heat_time_index >= 0),  -- share one; and the time in it
  warning TEXT NOT NULL,              -- oddities of the condition, one line each; '': none
  definition_sha256 TEXT NOT NULL     -- of the definition with its part temperatures: shows a change
) STRICT;
CREATE INDEX condition_by_sweep ON condition (sweep_id);
CREATE UNIQUE INDEX condition_by_index ON condition (sweep_id, condition_index) WHERE superseded = 0;

CREATE TABLE band (
  band_id INTEGER PRIMARY KEY,
  sweep_id INTEGER NOT NULL REFERENCES sweep ON DELETE CASCADE,
  band_index INTEGER NOT NULL CHECK (band_index >= 0),
  superseded INTEGER NOT NULL DEFAULT 0 CHECK (superseded IN (0, 1)),
  name TEXT NOT NULL,
  lambda_min_um REAL NOT NULL CHECK (lambda_min_um > 0),
  lambda_max_um REAL NOT NULL CHECK (lambda_max_um > lambda_min_um),
  lambda_um BLOB,                     -- wavelengths of its spectra, float64; NULL before the first result
  definition_sha256 TEXT NOT NULL
) STRICT;
CREATE INDEX band_by_sweep ON band (sweep_id);
CREATE UNIQUE INDEX band_by_index ON band (sweep_id, band_index) WHERE superseded = 0;

-- Relative response, linear between its points; no rows: 1 inside the band.
CREATE TABLE band_response (
  band_id INTEGER NOT NULL REFERENCES band ON DELETE CASCADE,
  lambda_um REAL NOT NULL,
  response REAL NOT NULL,
  PRIMARY KEY (band_id, lambda_um)
) STRICT, WITHOUT ROWID;

CREATE TABLE part (
  part_id INTEGER PRIMARY KEY,
  sweep_id INTEGER NOT NULL REFERENCES sweep ON DELETE CASCADE,
  part_index INTEGER NOT NULL CHECK (part_index >= 0),
  superseded INTEGER NOT NULL DEFAULT 0 CHECK (superseded IN (0, 1)),
  name TEXT NOT NULL,
  material TEXT NOT NULL
) STRICT;
CREATE INDEX part_by_sweep ON part (sweep_id);
CREATE UNIQUE INDEX part_by_index ON part (sweep_id, part_index) WHERE superseded = 0;

-- Stated temperatures. A part whose facets have temperatures of their own has no row.
CREATE TABLE part_temperature (
  condition_id INTEGER NOT NULL REFERENCES condition ON DELETE CASCADE,
  part_id INTEGER NOT NULL REFERENCES part ON DELETE CASCADE,
  temperature_k REAL NOT NULL CHECK (temperature_k >= 0),
  PRIMARY KEY (condition_id, part_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX part_temperature_by_part ON part_temperature (part_id);

-- Values of the sweep file's [[published]] tables.
CREATE TABLE published (
  sweep_id INTEGER NOT NULL REFERENCES sweep ON DELETE CASCADE,
  published_index INTEGER NOT NULL CHECK (published_index >= 0),
  profile TEXT NOT NULL,
  point_index INTEGER NOT NULL CHECK (point_index >= 0),
  reflections INTEGER NOT NULL CHECK (reflections >= 0),
  source_radiance_temperature_k REAL NOT NULL CHECK (source_radiance_temperature_k >= 0),
  relation TEXT NOT NULL CHECK (relation IN ('equal', 'below', 'above')),
  source TEXT NOT NULL,
  remark TEXT NOT NULL,
  PRIMARY KEY (sweep_id, published_index)
) STRICT, WITHOUT ROWID;

-- Time and size that a pilot predicted for a sweep. The key is the sweep's hash and no id: a prediction may be stored
-- before its sweep is submitted.
CREATE TABLE prediction (
  sweep_sha256 TEXT PRIMARY KEY CHECK (sweep_sha256 <> ''),
  made_unix_s REAL NOT NULL,
  determinism_class TEXT NOT NULL,                                   -- of the machine that the pilot ran on
  workers INTEGER NOT NULL CHECK (workers > 0),
  pilot_viewpoints INTEGER NOT NULL CHECK (pilot_viewpoints > 0),
  pilot_cpu_s REAL NOT NULL CHECK (pilot_cpu_s >= 0),
  jobs INTEGER NOT NULL CHECK (jobs > 0),
  cpu_s REAL NOT NULL CHECK (cpu_s >= 0),                            -- of all jobs together
  wall_s REAL NOT NULL CHECK (wall_s >= 0),
  job_cpu_quartile1_s REAL NOT NULL CHECK (job_cpu_quartile1_s >= 0),
  job_cpu_median_s REAL NOT NULL CHECK (job_cpu_median_s >= job_cpu_quartile1_s),
  job_cpu_quartile3_s REAL NOT NULL CHECK (job_cpu_quartile3_s >= job_cpu_median_s),
  database_bytes INTEGER NOT NULL CHECK (database_bytes > 0)
) STRICT, WITHOUT ROWID;

-- The queue -----------------------------------------------------------------------------------------------------------

-- Only a view has a viewpoint, conditions and bands: in jobs of any other kind these are NULL.
CREATE TABLE job (
  job_id INTEGER PRIMARY KEY,
  sweep_id INTEGER NOT NULL REFERENCES sweep ON DELETE CASCADE,
  job_index INTEGER NOT NULL CHECK (job_index >= 0),          -- its place in the sweep's list of jobs
  superseded INTEGER NOT NULL DEFAULT 0 CHECK (superseded IN (0, 1)),  -- done, and no longer part of the sweep
  job_key TEXT NOT NULL CHECK (job_key <> ''),                -- SHA-256 of all that determines the result
  kind INTEGER NOT NULL REFERENCES job_kind,
  viewpoint_id INTEGER REFERENCES viewpoint,
  condition_index TEXT CHECK (condition_index GLOB '[[]*]'),  -- JSON array
  band_index TEXT CHECK (band_index GLOB '[[]*]'),            -- JSON array
  state INTEGER NOT NULL REFERENCES job_state CHECK (state BETWEEN 0 AND 4),
  unmet_needs INTEGER NOT NULL DEFAULT 0 CHECK (unmet_needs >= 0),  -- number of jobs in job_need that are not done
  failures INTEGER NOT NULL DEFAULT 0 CHECK (failures >= 0),  -- failed attempts since the job was last submitted
  failures_after_token INTEGER NOT NULL DEFAULT 0,            -- attempts up to this fencing token no longer count
  UNIQUE (sweep_id, job_key),
  CHECK ((kind = 1) = (viewpoint_id IS NOT NULL AND condition_index IS NOT NULL AND band_index IS NOT NULL))
) STRICT;
CREATE INDEX job_by_viewpoint ON job (viewpoint_id);
CREATE INDEX job_superseded ON job (sweep_id) WHERE superseded = 1;
-- First tries in sweep order; a job that failed goes to the back of its sweep, so that another worker tries it.
CREATE INDEX job_waiting ON job (sweep_id, failures, job_index) WHERE state = 0 AND unmet_needs = 0;
-- A status names the first quarantined job of a sweep.
CREATE INDEX job_given_up ON job (sweep_id, unmet_needs, job_index) WHERE state = 3 AND superseded = 0;

-- Jobs of a sweep that must be done before another job of it is leased.
CREATE TABLE job_need (
  job_id INTEGER NOT NULL REFERENCES job ON DELETE CASCADE,
  needs_job_id INTEGER NOT NULL REFERENCES job (job_id) ON DELETE CASCADE CHECK (needs_job_id <> job_id),
  PRIMARY KEY (job_id, needs_job_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX job_need_by_needed ON job_need (needs_job_id);

-- One lease of one job. AUTOINCREMENT: a fencing token is never given twice, not even after rows were removed.
CREATE TABLE attempt (
  fencing_token INTEGER PRIMARY KEY AUTOINCREMENT,
  job_id INTEGER NOT NULL REFERENCES job ON DELETE CASCADE,
  worker_id TEXT NOT NULL,
  worker_name TEXT NOT NULL DEFAULT '',  -- as reported when the lease ended
  leased_unix_s REAL NOT NULL,
  outcome INTEGER NOT NULL DEFAULT 0 REFERENCES attempt_outcome CHECK (outcome BETWEEN 0 AND 4),
  message TEXT NOT NULL DEFAULT ''
) STRICT;
CREATE INDEX attempt_by_job ON attempt (job_id);
CREATE UNIQUE INDEX attempt_running ON attempt (job_id) WHERE outcome = 0;

-- Results -------------------------------------------------------------------------------------------------------------

-- Who computed a done job, with which program, and at what cost.
CREATE TABLE provenance (
  job_id INTEGER PRIMARY KEY REFERENCES job ON DELETE CASCADE,
  seed_hex TEXT NOT NULL,
  physics_version INTEGER NOT NULL CHECK (physics_version >= 0),
  determinism_class TEXT NOT NULL,
  build_id TEXT NOT NULL,
  worker_name TEXT NOT NULL,
  samples INTEGER NOT NULL CHECK (samples >= 0),  -- primary rays, all replicates
  replicates INTEGER NOT NULL CHECK (replicates >= 0),
  target_paths INTEGER NOT NULL CHECK (target_paths >= 0),
  rays INTEGER NOT NULL CHECK (rays >= 0),
  seconds REAL NOT NULL CHECK (seconds >= 0),     -- CPU time
  guarded_backface_hits INTEGER NOT NULL CHECK (guarded_backface_hits >= 0),
  guarded_nonfinite INTEGER NOT NULL CHECK (guarded_nonfinite >= 0),
  truncated_paths INTEGER NOT NULL CHECK (truncated_paths >= 0),  -- still alive after the last allowed reflection
  guarded_negative INTEGER NOT NULL CHECK (guarded_negative >= 0),
  worst_relative_error REAL NOT NULL CHECK (worst_relative_error >= 0),
  content_sha256 TEXT NOT NULL                    -- of the result without who, where and how long; not in the digest
) STRICT;

-- Results that differ from the stored one of their job, for a person to judge. Not in the digest.
CREATE TABLE result_aside (
  aside_id INTEGER PRIMARY KEY,
  job_id INTEGER NOT NULL REFERENCES job ON DELETE CASCADE,
  worker_name TEXT NOT NULL,
  received_unix_s REAL NOT NULL,
  content_sha256 TEXT NOT NULL,
  result BLOB NOT NULL,  -- irsig.schema.JobResult, serialized
  UNIQUE (job_id, content_sha256)
) STRICT;

-- The scalars of one viewpoint, condition and band.
CREATE TABLE signature (
  signature_id INTEGER PRIMARY KEY,
  job_id INTEGER NOT NULL REFERENCES job,
  viewpoint_id INTEGER NOT NULL REFERENCES viewpoint,
  condition_id INTEGER NOT NULL REFERENCES condition,
  band_id INTEGER NOT NULL REFERENCES band,
  sun_azimuth_deg REAL NOT NULL,
  sun_zenith_deg REAL NOT NULL,
  stop_reason INTEGER NOT NULL REFERENCES stop_reason,
  -- The largest part of numerical_error_w_sr, where that misses the requested accuracy (stop_reason
  -- accuracy_not_reached or sample_limit): the error of the samples or one of the bounds below. NULL: reached.
  limiting_bound TEXT CHECK (limiting_bound IN (
    'sampling', 'undersampling', 'truncation', 'quadrature', 'spectral_basis', 'direction_interpolation', 'omitted',
    'temperature', 'plume')),
  energy_gain INTEGER NOT NULL CHECK (energy_gain IN (0, 1)),  -- 1: a material that creates energy took part
  reflections INTEGER NOT NULL CHECK (reflections >= 0),       -- the most that a path was given

  -- In-band intensity at the target, and the causes that add up to it.
  intensity_w_sr REAL NOT NULL,
  intensity_stderr_w_sr REAL NOT NULL CHECK (intensity_stderr_w_sr >= 0),
  numerical_error_w_sr REAL NOT NULL CHECK (numerical_error_w_sr >= 0),  -- of intensity_w_sr, bounds included
  projected_area_m2 REAL NOT NULL CHECK (projected_area_m2 >= 0),
  projected_area_stderr_m2 REAL NOT NULL CHECK (projected_area_stderr_m2 >= 0),
  source_radiance_temperature_k REAL NOT NULL CHECK (source_radiance_temperature_k >= 0),
  emitted_w_sr REAL NOT NULL,
  emitted_stderr_w_sr REAL NOT NULL CHECK (emitted_stderr_w_sr >= 0),
  sun_reflected_w_sr REAL NOT NULL,
  sun_reflected_stderr_w_sr REAL NOT NULL CHECK (sun_reflected_stderr_w_sr >= 0),
  sky_reflected_w_sr REAL NOT NULL,
  sky_reflected_stderr_w_sr REAL NOT NULL CHECK (sky_reflected_stderr_w_sr >= 0),
  surface_reflected_w_sr REAL NOT NULL,  -- of sea, ground or lower hemisphere
  surface_reflected_stderr_w_sr REAL NOT NULL CHECK (surface_reflected_stderr_w_sr >= 0),
  interreflected_w_sr REAL NOT NULL,     -- emitted by parts of the target, reflected by others
  interreflected_stderr_w_sr REAL NOT NULL CHECK (interreflected_stderr_w_sr >= 0),

  -- At the sensor: behind the air, against the background.
  apparent_intensity_w_sr REAL NOT NULL,
  apparent_intensity_stderr_w_sr REAL NOT NULL CHECK (apparent_intensity_stderr_w_sr >= 0),
  apparent_numerical_error_w_sr REAL NOT NULL CHECK (apparent_numerical_error_w_sr >= 0),
  apparent_temperature_k REAL NOT NULL CHECK (apparent_temperature_k >= 0),
  contrast_intensity_w_sr REAL NOT NULL,  -- the target less the background in its place
  contrast_intensity_stderr_w_sr REAL NOT NULL CHECK (contrast_intensity_stderr_w_sr >= 0),
  contrast_numerical_error_w_sr REAL NOT NULL CHECK (contrast_numerical_error_w_sr >= 0),
  background_radiance_w_m2_sr REAL NOT NULL,
  background_radiance_stderr_w_m2_sr REAL NOT NULL CHECK (background_radiance_stderr_w_m2_sr >= 0),
  path_transmittance REAL NOT NULL CHECK (path_transmittance >= 0),  -- in-band mean, of a grey source
  path_radiance_w_m2_sr REAL NOT NULL,

  -- One sigma of the models of air, sky and sea; no part of a numerical error.
  model_error_w_sr REAL NOT NULL CHECK (model_error_w_sr >= 0),
  apparent_model_error_w_sr REAL NOT NULL CHECK (apparent_model_error_w_sr >= 0),
  contrast_model_error_w_sr REAL NOT NULL CHECK (contrast_model_error_w_sr >= 0),

  -- Parts of the numerical errors beside the standard errors.
  truncation_bound_w_sr REAL NOT NULL CHECK (truncation_bound_w_sr >= 0),  -- of reflections after the last one
  quadrature_bound_w_sr REAL NOT NULL CHECK (quadrature_bound_w_sr >= 0),  -- over wavelength
  spectral_basis_bound_w_sr REAL NOT NULL CHECK (spectral_basis_bound_w_sr >= 0),  -- contained in quadrature_bound_w_sr
  undersampling_bound_w_sr REAL NOT NULL CHECK (undersampling_bound_w_sr >= 0),
  undersampling_stderr_w_sr REAL NOT NULL CHECK (undersampling_stderr_w_sr >= 0),
  apparent_undersampling_stderr_w_sr REAL NOT NULL CHECK (apparent_undersampling_stderr_w_sr >= 0),
  contrast_undersampling_stderr_w_sr REAL NOT NULL CHECK (contrast_undersampling_stderr_w_sr >= 0),
  direction_interpolation_bound_w_sr REAL NOT NULL CHECK (direction_interpolation_bound_w_sr >= 0),  -- of sky and sea
  omitted_bound_w_sr REAL NOT NULL CHECK (omitted_bound_w_sr >= 0),  -- of effects that are off (ledger)
  apparent_omitted_bound_w_sr REAL NOT NULL CHECK (apparent_omitted_bound_w_sr >= 0),
  contrast_omitted_bound_w_sr REAL NOT NULL CHECK (contrast_omitted_bound_w_sr >= 0),
  target_depth_bound_w_sr REAL NOT NULL CHECK (target_depth_bound_w_sr >= 0),  -- of apparent and contrast intensity
  background_bound_w_sr REAL NOT NULL CHECK (background_bound_w_sr >= 0),      -- of contrast intensity
  temperature_bound_w_sr REAL NOT NULL CHECK (temperature_bound_w_sr >= 0),    -- of measured or computed temperatures
  apparent_temperature_bound_w_sr REAL NOT NULL CHECK (apparent_temperature_bound_w_sr >= 0),
  absolute_floor_w_sr REAL NOT NULL CHECK (absolute_floor_w_sr >= 0),          -- accuracy.absolute_error_k in W/sr
  backface_fraction REAL NOT NULL CHECK (backface_fraction >= 0),  -- of the silhouette: facets seen from behind

  -- Hot gas: what it sends less what it takes of the light behind it, part of the intensities above. NULL: the row's
  -- condition has no hot gas.
  plume_w_sr REAL,
  plume_stderr_w_sr REAL CHECK (plume_stderr_w_sr >= 0),
  apparent_plume_w_sr REAL,
  apparent_plume_stderr_w_sr REAL CHECK (apparent_plume_stderr_w_sr >= 0),
  contrast_plume_w_sr REAL,
  contrast_plume_stderr_w_sr REAL CHECK (contrast_plume_stderr_w_sr >= 0),
  plume_emitted_w_sr REAL,
  apparent_plume_emitted_w_sr REAL,
  plume_bound_w_sr REAL CHECK (plume_bound_w_sr >= 0),
  apparent_plume_bound_w_sr REAL CHECK (apparent_plume_bound_w_sr >= 0),
  contrast_plume_bound_w_sr REAL CHECK (contrast_plume_bound_w_sr >= 0),
  plume_model_error_w_sr REAL CHECK (plume_model_error_w_sr >= 0),
  plume_reflected_w_sr REAL,           -- by the target, net of the light that the gas absorbs; part of plume_w_sr
  plume_reflected_stderr_w_sr REAL CHECK (plume_reflected_stderr_w_sr >= 0),
  apparent_plume_reflected_w_sr REAL,
  apparent_plume_reflected_stderr_w_sr REAL CHECK (apparent_plume_reflected_stderr_w_sr >= 0),
  plume_area_m2 REAL,                  -- projected, where the in-band optical depth is plume.area_optical_depth
  plume_area_stderr_m2 REAL CHECK (plume_area_stderr_m2 >= 0),
  plume_voxel_error_w_sr REAL CHECK (plume_voxel_error_w_sr >= 0),  -- change with voxels of half the resolution

  -- The background around the target, at the sensor, in-band (core/clutter). NULL: it was not measured.
  clutter_window_m REAL CHECK (clutter_window_m > 0),  -- its width at the target's range
  clutter_pixel_m REAL CHECK (clutter_pixel_m > 0),
  clutter_mean_w_m2_sr REAL,
  clutter_mean_stderr_w_m2_sr REAL CHECK (clutter_mean_stderr_w_m2_sr >= 0),
  clutter_sigma_w_m2_sr REAL CHECK (clutter_sigma_w_m2_sr >= 0),  -- of pixels
  clutter_sigma_stderr_w_m2_sr REAL CHECK (clutter_sigma_stderr_w_m2_sr >= 0),
  clutter_skewness REAL,
  clutter_skewness_stderr REAL CHECK (clutter_skewness_stderr >= 0),
  clutter_correlation_m REAL CHECK (clutter_correlation_m >= 0),
  clutter_correlation_stderr_m REAL CHECK (clutter_correlation_stderr_m >= 0),
  clutter_cells REAL CHECK (clutter_cells >= 1),                  -- independent values in the window
  clutter_patch_m REAL CHECK (clutter_patch_m > 0),               -- side of squares of the target's projected area
  clutter_patch_sigma_w_m2_sr REAL CHECK (clutter_patch_sigma_w_m2_sr >= 0),  -- of means over these squares
  clutter_patch_sigma_stderr_w_m2_sr REAL CHECK (clutter_patch_sigma_stderr_w_m2_sr >= 0),
  clutter_modes_fraction REAL CHECK (clutter_modes_fraction >= 0),  -- of their variance: carried by clutter.modes
  visible_fraction REAL CHECK (visible_fraction >= 0),            -- of the silhouette: not hidden by the land

  -- One sigma of all uncertain inputs together, no part of any error. NULL: the sweep states no [uncertainty].
  input_uncertainty_w_sr REAL CHECK (input_uncertainty_w_sr >= 0),
  apparent_input_uncertainty_w_sr REAL CHECK (apparent_input_uncertainty_w_sr >= 0),
  contrast_input_uncertainty_w_sr REAL CHECK (contrast_input_uncertainty_w_sr >= 0),
  -- One sigma of the model of computed temperatures, part of no other error. NULL: not asked for.
  heat_model_error_w_sr REAL CHECK (heat_model_error_w_sr >= 0),
  apparent_heat_model_error_w_sr REAL CHECK (apparent_heat_model_error_w_sr >= 0),
  contrast_heat_model_error_w_sr REAL CHECK (contrast_heat_model_error_w_sr >= 0),

  UNIQUE (condition_id, band_id, viewpoint_id)
) STRICT;
CREATE INDEX signature_by_viewpoint ON signature (viewpoint_id);
CREATE INDEX signature_by_job ON signature (job_id);
CREATE INDEX signature_by_band ON signature (band_id);

-- Each blob: float32, little-endian, one value for each wavelength of band.lambda_um. Spectra are apart from the
-- scalars so that queries stay fast.
CREATE TABLE spectrum (
  signature_id INTEGER PRIMARY KEY REFERENCES signature ON DELETE CASCADE,
  spectral_intensity_w_sr_um BLOB NOT NULL,
  spectral_intensity_stderr_w_sr_um BLOB NOT NULL,
  emitted_w_sr_um BLOB NOT NULL,
  emitted_stderr_w_sr_um BLOB NOT NULL,
  sun_reflected_w_sr_um BLOB NOT NULL,
  sun_reflected_stderr_w_sr_um BLOB NOT NULL,
  sky_reflected_w_sr_um BLOB NOT NULL,
  sky_reflected_stderr_w_sr_um BLOB NOT NULL,
  surface_reflected_w_sr_um BLOB NOT NULL,
  surface_reflected_stderr_w_sr_um BLOB NOT NULL,
  interreflected_w_sr_um BLOB NOT NULL,
  interreflected_stderr_w_sr_um BLOB NOT NULL,
  apparent_spectral_intensity_w_sr_um BLOB NOT NULL,
  apparent_spectral_intensity_stderr_w_sr_um BLOB NOT NULL,
  contrast_spectral_intensity_w_sr_um BLOB NOT NULL,
  contrast_spectral_intensity_stderr_w_sr_um BLOB NOT NULL,
  background_radiance_w_m2_sr_um BLOB NOT NULL,
  background_radiance_stderr_w_m2_sr_um BLOB NOT NULL,
  path_transmittance BLOB NOT NULL,
  path_radiance_w_m2_sr_um BLOB NOT NULL,
  plume_w_sr_um BLOB,  -- NULL from here on: no hot gas
  plume_stderr_w_sr_um BLOB,
  apparent_plume_w_sr_um BLOB,
  apparent_plume_stderr_w_sr_um BLOB,
  contrast_plume_w_sr_um BLOB,
  contrast_plume_stderr_w_sr_um BLOB
) STRICT;

-- Correlation of the errors of a spectrum's wavelengths (core/accuracy/spectral_modes.h): [mode][wavelength], int16,
-- little-endian, in units of the standard error at the wavelength / 32767. No row: nothing is known.
CREATE TABLE spectral_modes (
  signature_id INTEGER PRIMARY KEY REFERENCES signature ON DELETE CASCADE,
  spectral_intensity_modes BLOB NOT NULL,
  apparent_spectral_intensity_modes BLOB NOT NULL,
  contrast_spectral_intensity_modes BLOB NOT NULL
) STRICT;

-- Spectra of the background around the target. No row: it was not measured.
CREATE TABLE clutter (
  signature_id INTEGER PRIMARY KEY REFERENCES signature ON DELETE CASCADE,
  patch_sigma_w_m2_sr_um BLOB NOT NULL,  -- float32, as in spectrum: of means over squares of clutter_patch_m
  modes BLOB NOT NULL                    -- of their covariance, as in spectral_modes, in units of patch_sigma / 32767
) STRICT;

-- The materials of the land in that background. No row: it has no land.
CREATE TABLE clutter_material (
  signature_id INTEGER NOT NULL REFERENCES clutter ON DELETE CASCADE,
  material_index INTEGER NOT NULL CHECK (material_index >= 0),  -- in the order of the sweep's land
  fraction REAL NOT NULL CHECK (fraction >= 0),
  PRIMARY KEY (signature_id, material_index)
) STRICT, WITHOUT ROWID;

CREATE TABLE part_intensity (
  signature_id INTEGER NOT NULL REFERENCES signature ON DELETE CASCADE,
  part_id INTEGER NOT NULL REFERENCES part,
  intensity_w_sr REAL NOT NULL,
  intensity_stderr_w_sr REAL NOT NULL CHECK (intensity_stderr_w_sr >= 0),
  PRIMARY KEY (signature_id, part_id)
) STRICT, WITHOUT ROWID;

CREATE TABLE thumbnail (
  signature_id INTEGER PRIMARY KEY REFERENCES signature ON DELETE CASCADE,
  width_px INTEGER NOT NULL CHECK (width_px > 0),
  height_px INTEGER NOT NULL CHECK (height_px > 0),
  pixel_rad REAL NOT NULL CHECK (pixel_rad > 0),  -- angle of a pixel at the sensor
  -- Standard error of a pixel, root mean square over those that the target fills; of none, that of their sum.
  error_relative REAL NOT NULL CHECK (error_relative >= 0),
  error_k REAL NOT NULL CHECK (error_k >= 0),     -- at the mean radiance of these pixels
  png BLOB NOT NULL,                              -- 8 bit, black to white over [0, maximum]
  exr BLOB NOT NULL,                              -- float32 in-band radiance [W/(m2 sr)]
  stderr_exr BLOB NOT NULL                        -- its standard error, likewise
) STRICT;

-- Further images of a row, of the thumbnail's size (docs/reference/keys/image.md).
CREATE TABLE image_layer (
  signature_id INTEGER NOT NULL REFERENCES thumbnail ON DELETE CASCADE,
  name TEXT NOT NULL,
  exr BLOB NOT NULL,        -- float32
  stderr_exr BLOB NOT NULL,  -- its standard error; empty: none is stored
  PRIMARY KEY (signature_id, name)
) STRICT, WITHOUT ROWID;

-- The images of a job's rows show the same parts in the same pixels.
CREATE TABLE silhouette (
  job_id INTEGER PRIMARY KEY REFERENCES job ON DELETE CASCADE,
  width_px INTEGER NOT NULL CHECK (width_px > 0),
  height_px INTEGER NOT NULL CHECK (height_px > 0),
  pixel_samples INTEGER NOT NULL CHECK (pixel_samples > 0)  -- rays of each pixel
) STRICT;

-- Pixels that show a part, in a box around them; no row: none does.
CREATE TABLE part_pixels (
  job_id INTEGER NOT NULL REFERENCES silhouette ON DELETE CASCADE,
  part_id INTEGER NOT NULL REFERENCES part,
  left_px INTEGER NOT NULL CHECK (left_px >= 0),
  top_px INTEGER NOT NULL CHECK (top_px >= 0),
  width_px INTEGER NOT NULL CHECK (width_px > 0),
  height_px INTEGER NOT NULL CHECK (height_px > 0),
  samples BLOB NOT NULL,  -- zlib of [row][column] uint16, little-endian: rays of a pixel that meet the part first
  PRIMARY KEY (job_id, part_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX part_pixels_by_part ON part_pixels (part_id);

-- Rays that meet exactly these parts, one behind the other; no row: the sweep did not ask for whole parts.
CREATE TABLE part_set (
  job_id INTEGER NOT NULL REFERENCES silhouette ON DELETE CASCADE,
  parts TEXT NOT NULL CHECK (parts <> ''),  -- their names, one in a line, in the sweep's order
  outside_px REAL NOT NULL CHECK (outside_px >= 0),  -- what such rays cover outside the frame, in areas of a pixel
  samples BLOB NOT NULL,  -- zlib, little-endian: pixels skipped before each (uint32), then rays of each (uint16)
  PRIMARY KEY (job_id, parts)
) STRICT, WITHOUT ROWID;

-- Mean in-band radiance over a footprint, with at most `reflections` reflections. A row is replaced and removed with
-- its signature and has the same provenance.
CREATE TABLE profile (
  signature_id INTEGER NOT NULL REFERENCES signature ON DELETE CASCADE,
  profile_index INTEGER NOT NULL CHECK (profile_index >= 0),
  point_index INTEGER NOT NULL CHECK (point_index >= 0),
  reflections INTEGER NOT NULL CHECK (reflections >= 0),
  name TEXT NOT NULL CHECK (name <> ''),
  x_m REAL NOT NULL,
  y_m REAL NOT NULL,
  z_m REAL NOT NULL,
  footprint_width_m REAL NOT NULL CHECK (footprint_width_m > 0),
  footprint_height_m REAL NOT NULL CHECK (footprint_height_m > 0),
  radiance_w_m2_sr REAL NOT NULL,
  radiance_stderr_w_m2_sr REAL NOT NULL CHECK (radiance_stderr_w_m2_sr >= 0),
  apparent_radiance_w_m2_sr REAL NOT NULL,
  apparent_radiance_stderr_w_m2_sr REAL NOT NULL CHECK (apparent_radiance_stderr_w_m2_sr >= 0),
  truncation_bound_w_m2_sr REAL NOT NULL CHECK (truncation_bound_w_m2_sr >= 0),
  quadrature_bound_w_m2_sr REAL NOT NULL CHECK (quadrature_bound_w_m2_sr >= 0),
  source_radiance_temperature_k REAL NOT NULL CHECK (source_radiance_temperature_k >= 0),
  source_radiance_temperature_stderr_k REAL NOT NULL CHECK (source_radiance_temperature_stderr_k >= 0),
  target_fraction REAL NOT NULL,  -- of the footprint: the target fills it
  samples INTEGER NOT NULL CHECK (samples >= 0),  -- primary rays, all replicates
  PRIMARY KEY (signature_id, profile_index, point_index, reflections)
) STRICT, WITHOUT ROWID;

-- Each effect of a signature.
CREATE TABLE ledger (
  signature_id INTEGER NOT NULL REFERENCES signature ON DELETE CASCADE,
  effect INTEGER NOT NULL REFERENCES effect,
  state INTEGER NOT NULL REFERENCES effect_state CHECK (state BETWEEN 1 AND 3),
  reason INTEGER NOT NULL REFERENCES effect_reason,
  bound_w_sr REAL CHECK (bound_w_sr >= 0),                    -- upper bound on the change of the intensity if the
  apparent_bound_w_sr REAL CHECK (apparent_bound_w_sr >= 0),  -- effect is left out; NULL: not known
  contrast_bound_w_sr REAL CHECK (contrast_bound_w_sr >= 0),
  fraction_w_sr REAL,              -- measured contribution to the intensity; NULL: not known
  time_s REAL CHECK (time_s >= 0), -- of the whole view, estimated from counts: spent (on) or saved (off)
  PRIMARY KEY (signature_id, effect)
) STRICT, WITHOUT ROWID;

-- Ends of the light that the sensor would send out, in-band means of fractions. No row: the sensor sees nothing of the
-- target.
CREATE TABLE energy (
  signature_id INTEGER PRIMARY KEY REFERENCES signature ON DELETE CASCADE,
  absorbed REAL NOT NULL,            -- by the target
  absorbed_stderr REAL NOT NULL CHECK (absorbed_stderr >= 0),
  escaped_to_sky REAL NOT NULL,
  escaped_to_sky_stderr REAL NOT NULL CHECK (escaped_to_sky_stderr >= 0),
  escaped_to_surface REAL NOT NULL,  -- sea, ground or lower hemisphere
  escaped_to_surface_stderr REAL NOT NULL CHECK (escaped_to_surface_stderr >= 0),
  cut_off REAL NOT NULL,             -- after the last reflection
  cut_off_stderr REAL NOT NULL CHECK (cut_off_stderr >= 0),
  balance REAL NOT NULL,             -- sum of the four, 1 within its error
  balance_stderr REAL NOT NULL CHECK (balance_stderr >= 0)
) STRICT;

-- Change of a signature if an uncertain input is one sigma higher. stderr: standard error of this difference, on paths
-- that both sides share. curvature: half the sum of both sides' changes; NULL: one side only.
CREATE TABLE input_contribution (
  signature_id INTEGER NOT NULL REFERENCES signature ON DELETE CASCADE,
  input_index INTEGER NOT NULL CHECK (input_index >= 0),  -- in the order of the grammar
  input TEXT NOT NULL,                                    -- a key of [uncertainty]
  contribution_w_sr REAL NOT NULL,
  contribution_stderr_w_sr REAL NOT NULL CHECK (contribution_stderr_w_sr >= 0),
  apparent_contribution_w_sr REAL NOT NULL,
  apparent_contribution_stderr_w_sr REAL NOT NULL CHECK (apparent_contribution_stderr_w_sr >= 0),
  contrast_contribution_w_sr REAL NOT NULL,
  contrast_contribution_stderr_w_sr REAL NOT NULL CHECK (contrast_contribution_stderr_w_sr >= 0),
  curvature_w_sr REAL,
  apparent_curvature_w_sr REAL,
  contrast_curvature_w_sr REAL,
  PRIMARY KEY (signature_id, input_index)
) STRICT, WITHOUT ROWID;

-- Jobs that compute temperatures. The output of such a job is an asset (irsig.schema.HeatField, serialized).
CREATE TABLE heat_job (
  job_id INTEGER PRIMARY KEY REFERENCES job ON DELETE CASCADE,
  heat_index INTEGER NOT NULL CHECK (heat_index >= 0),  -- its place in ResolvedSweep.heat
  season TEXT NOT NULL,                                 -- the first of the seasons that share it
  output_sha256 TEXT REFERENCES asset (sha256),         -- NULL: not done
  warning TEXT NOT NULL DEFAULT ''                      -- one line each
) STRICT;
CREATE INDEX heat_job_by_output ON heat_job (output_sha256);

-- Summary of an output for people: temperatures of a part's facets, weighted by area.
CREATE TABLE computed_temperature (
  job_id INTEGER NOT NULL REFERENCES heat_job ON DELETE CASCADE,
  time_index INTEGER NOT NULL CHECK (time_index >= 0),  -- in the heat run
  time_utc TEXT NOT NULL,
  part_id INTEGER NOT NULL REFERENCES part,
  mean_k REAL NOT NULL CHECK (mean_k > 0),
  coldest_k REAL NOT NULL CHECK (coldest_k > 0),
  hottest_k REAL NOT NULL CHECK (hottest_k >= coldest_k),
  error_k REAL NOT NULL CHECK (error_k >= 0),           -- mean of the facets' errors
  PRIMARY KEY (job_id, time_index, part_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX computed_temperature_by_part ON computed_temperature (part_id);

-- Views, for people: names instead of numbers -------------------------------------------------------------------------

-- One line for each stored signature; `row` is its place in the sweep, counted from 1.
CREATE VIEW signature_view AS
SELECT s.signature_id,
       (v.viewpoint_index * w.conditions + c.condition_index) * w.bands + b.band_index + 1 AS row,
       w.name AS sweep, c.season, c.time_utc,
       strftime('%H:%M', c.time_utc, printf('%+.3f minutes', 4 * w.longitude_deg)) AS mean_solar_time,
       b.name AS band, b.lambda_min_um, b.lambda_max_um,
       v.aspect_azimuth_deg, v.aspect_elevation_deg, v.range_m, s.sun_azimuth_deg, s.sun_zenith_deg,
       s.intensity_w_sr, s.intensity_stderr_w_sr, s.numerical_error_w_sr,
       CASE WHEN s.numerical_error_w_sr = 0 THEN 0.0
            ELSE s.numerical_error_w_sr / abs(s.intensity_w_sr) END AS relative_error,
       s.truncation_bound_w_sr, s.quadrature_bound_w_sr,
       s.apparent_intensity_w_sr, s.apparent_intensity_stderr_w_sr, s.apparent_numerical_error_w_sr,
       s.apparent_temperature_k,
       s.projected_area_m2, s.projected_area_stderr_m2, s.source_radiance_temperature_k,
       s.emitted_w_sr, s.emitted_stderr_w_sr, s.sun_reflected_w_sr, s.sun_reflected_stderr_w_sr,
       s.sky_reflected_w_sr, s.sky_reflected_stderr_w_sr, s.surface_reflected_w_sr, s.surface_reflected_stderr_w_sr,
       s.interreflected_w_sr, s.interreflected_stderr_w_sr,
       s.undersampling_bound_w_sr, s.spectral_basis_bound_w_sr, s.direction_interpolation_bound_w_sr,
       s.contrast_intensity_w_sr, s.contrast_intensity_stderr_w_sr, s.contrast_numerical_error_w_sr,
       s.background_radiance_w_m2_sr, s.background_radiance_stderr_w_m2_sr,
       s.model_error_w_sr, s.apparent_model_error_w_sr, s.contrast_model_error_w_sr,
       s.path_transmittance, s.path_radiance_w_m2_sr,
       s.omitted_bound_w_sr, s.apparent_omitted_bound_w_sr, s.contrast_omitted_bound_w_sr, s.absolute_floor_w_sr,
       s.target_depth_bound_w_sr, s.undersampling_stderr_w_sr, s.apparent_undersampling_stderr_w_sr,
       s.contrast_undersampling_stderr_w_sr,
       s.background_bound_w_sr, s.backface_fraction, s.temperature_bound_w_sr, s.apparent_temperature_bound_w_sr,
       s.plume_w_sr, s.plume_stderr_w_sr, s.apparent_plume_w_sr, s.apparent_plume_stderr_w_sr,
       s.contrast_plume_w_sr, s.contrast_plume_stderr_w_sr, s.plume_emitted_w_sr, s.apparent_plume_emitted_w_sr,
       s.plume_bound_w_sr, s.apparent_plume_bound_w_sr, s.contrast_plume_bound_w_sr, s.plume_model_error_w_sr,
       s.plume_reflected_w_sr, s.plume_reflected_stderr_w_sr, s.apparent_plume_reflected_w_sr,
       s.apparent_plume_reflected_stderr_w_sr, s.plume_area_m2, s.plume_area_stderr_m2, s.plume_voxel_error_w_sr,
       s.clutter_window_m, s.clutter_pixel_m, s.clutter_mean_w_m2_sr, s.clutter_mean_stderr_w_m2_sr,
       s.clutter_sigma_w_m2_sr, s.clutter_sigma_stderr_w_m2_sr, s.clutter_skewness, s.clutter_skewness_stderr,
       s.clutter_correlation_m, s.clutter_correlation_stderr_m, s.clutter_cells, s.clutter_patch_m,
       s.clutter_patch_sigma_w_m2_sr, s.clutter_patch_sigma_stderr_w_m2_sr, s.clutter_modes_fraction,
       s.visible_fraction,
       s.input_uncertainty_w_sr, s.apparent_input_uncertainty_w_sr, s.contrast_input_uncertainty_w_sr,
       s.heat_model_error_w_sr, s.apparent_heat_model_error_w_sr, s.contrast_heat_model_error_w_sr,
       (SELECT group_concat(printf('%s=%+.4g', input, contribution_w_sr), ', ')
        FROM (SELECT i.input, i.contribution_w_sr FROM input_contribution i
              WHERE i.signature_id = s.signature_id AND abs(i.contribution_w_sr) > 2 * i.contribution_stderr_w_sr
              ORDER BY abs(i.contribution_w_sr) DESC, i.input_index LIMIT 3)) AS dominant_inputs,
       s.reflections,
       r.name AS stop_reason, s.limiting_bound, s.energy_gain,
       CASE WHEN s.backface_fraction > 0
            THEN coalesce(nullif(c.warning, '') || char(10), '') ||
                 'back faces: one-sided facets of the silhouette are seen from behind and send nothing: ' ||
                 'two_sided = true for parts that are sheets, `irsig model check --repair` for facets inside out'
            ELSE c.warning END AS warning,
       p.samples, p.replicates, p.target_paths, p.rays, p.seconds,
       p.guarded_backface_hits, p.guarded_nonfinite, p.truncated_paths, p.guarded_negative,
       j.job_key, (j.superseded OR c.superseded OR b.superseded) AS superseded, p.seed_hex, p.physics_version,
       p.determinism_class, p.build_id, p.worker_name
FROM signature s
JOIN viewpoint v USING (viewpoint_id)
JOIN sweep w ON w.sweep_id = v.sweep_id
JOIN condition c USING (condition_id)
JOIN band b USING (band_id)
JOIN stop_reason r USING (stop_reason)
JOIN job j USING (job_id)
JOIN provenance p USING (job_id);

-- One line for each row of a profile.
CREATE VIEW profile_view AS
SELECT s.sweep, s.season, s.time_utc, s.band, s.lambda_min_um, s.lambda_max_um,
       s.aspect_azimuth_deg, s.aspect_elevation_deg, s.range_m, s.row,
       f.name AS profile, f.profile_index, f.point_index, f.x_m, f.y_m, f.z_m, f.footprint_width_m,
       f.footprint_height_m, f.reflections, f.radiance_w_m2_sr, f.radiance_stderr_w_m2_sr, f.apparent_radiance_w_m2_sr,
       f.apparent_radiance_stderr_w_m2_sr, f.truncation_bound_w_m2_sr, f.quadrature_bound_w_m2_sr,
       f.source_radiance_temperature_k, f.source_radiance_temperature_stderr_k, f.target_fraction, f.samples,
       s.replicates, s.energy_gain, s.seed_hex, s.physics_version, s.determinism_class, s.build_id, s.job_key
FROM profile f
JOIN signature_view s USING (signature_id);

-- One line for each effect of a signature.
CREATE VIEW ledger_view AS
SELECT l.signature_id, e.name AS effect, s.name AS state, r.name AS reason, l.bound_w_sr, l.apparent_bound_w_sr,
       l.contrast_bound_w_sr, l.fraction_w_sr, l.time_s
FROM ledger l
JOIN effect e USING (effect)
JOIN effect_state s USING (state)
JOIN effect_reason r USING (reason);

CREATE VIEW part_intensity_view AS
SELECT i.signature_id, p.name AS part, p.material, i.intensity_w_sr, i.intensity_stderr_w_sr
FROM part_intensity i JOIN part p USING (part_id);

CREATE VIEW part_temperature_view AS
SELECT w.name AS sweep, c.season, c.time_utc, p.name AS part, t.temperature_k
FROM part_temperature t
JOIN condition c USING (condition_id)
JOIN part p USING (part_id)
JOIN sweep w ON w.sweep_id = c.sweep_id;

-- One line for each part at a time of a season whose temperatures a job has computed.
CREATE VIEW computed_temperature_view AS
SELECT w.name AS sweep, coalesce(c.season, h.season) AS season, coalesce(c.time_utc, t.time_utc) AS time_utc,
       p.name AS part, t.mean_k, t.coldest_k, t.hottest_k, t.error_k, j.superseded, j.job_key, c.condition_index,
       h.heat_index, t.time_index, p.part_index
FROM computed_temperature t
JOIN heat_job h USING (job_id)
JOIN job j USING (job_id)
JOIN sweep w USING (sweep_id)
JOIN part p USING (part_id)
LEFT JOIN condition c ON c.sweep_id = j.sweep_id AND c.superseded = 0 AND j.superseded = 0
                     AND c.heat_index = h.heat_index AND c.heat_time_index = t.time_index;

-- Progress of each sweep.
CREATE VIEW sweep_view AS
SELECT w.name AS sweep, w.sweep_sha256, w.viewpoints, w.conditions, w.bands, w.determinism_class,
       count(j.job_id) AS jobs,
       count(*) FILTER (WHERE j.state = 0) AS waiting,
       count(*) FILTER (WHERE j.state = 1) AS leased,
       count(*) FILTER (WHERE j.state = 2) AS done,
       count(*) FILTER (WHERE j.state = 3) AS quarantined,
       count(*) FILTER (WHERE j.state = 4) AS cancelled,
       coalesce(sum(p.rays) FILTER (WHERE j.state = 2), 0) AS rays,
       coalesce(max(p.worst_relative_error) FILTER (WHERE j.state = 2), 0.0) AS worst_relative_error,
       w.sweep_id,
       count(*) FILTER (WHERE j.kind = 2) AS heat_jobs,
       count(*) FILTER (WHERE j.kind = 2 AND j.state = 2) AS heat_done,
       w.priority
FROM sweep w
LEFT JOIN job j ON j.sweep_id = w.sweep_id AND j.superseded = 0
LEFT JOIN provenance p ON p.job_id = j.job_id
GROUP BY w.sweep_id;

CREATE VIEW job_view AS
SELECT w.name AS sweep, j.job_index, k.name AS kind, s.name AS state, j.superseded, j.failures, j.unmet_needs,
       j.job_key, v.viewpoint_index, v.aspect_azimuth_deg, v.aspect_elevation_deg, v.range_m, j.condition_index,
       j.band_index,
       (SELECT fencing_token FROM attempt a WHERE a.job_id = j.job_id AND outcome = 0) AS fencing_token,
       (SELECT worker_id FROM attempt a WHERE a.job_id = j.job_id AND outcome = 0) AS leased_to,
       p.worker_name AS done_by, p.seconds, p.rays, p.worst_relative_error
FROM job j
JOIN sweep w USING (sweep_id)
JOIN job_kind k USING (kind)
JOIN job_state s USING (state)
LEFT JOIN viewpoint v USING (viewpoint_id)
LEFT JOIN provenance p USING (job_id);

CREATE VIEW attempt_view AS
SELECT a.fencing_token, w.name AS sweep, j.job_index, j.job_key, a.worker_id, a.worker_name,
       datetime(a.leased_unix_s, 'unixepoch') AS leased_utc, o.name AS outcome, a.message
FROM attempt a
JOIN job j USING (job_id)
JOIN sweep w USING (sweep_id)
JOIN attempt_outcome o USING (outcome);
