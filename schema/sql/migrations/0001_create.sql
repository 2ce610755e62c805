-- Version 1 of the signature database. schema/README.md explains every table; a change of this file after a release
-- is a new migration (0002_...), never an edit.
--
-- Identifiers are those of schema/result.proto and schema/job.proto: every number ends in its unit.

-- Names of the stored numbers, so that a person never has to look them up. Numbers are never reused.
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

CREATE TABLE stop_reason (
  stop_reason INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE
) STRICT;
INSERT INTO stop_reason VALUES
  (1, 'target_reached'), (2, 'target_missed'), (3, 'sample_limit'), (4, 'fixed_samples');

-- What was asked for -------------------------------------------------------------------------------------------------

CREATE TABLE sweep (
  sweep_id INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE CHECK (name <> ''),
  sweep_sha256 TEXT NOT NULL UNIQUE CHECK (sweep_sha256 <> ''),
  viewpoints INTEGER NOT NULL CHECK (viewpoints > 0),
  conditions INTEGER NOT NULL CHECK (conditions > 0),
  bands INTEGER NOT NULL CHECK (bands > 0),
  model_sha256 TEXT NOT NULL,
  thumbnail_px INTEGER CHECK (thumbnail_px >= 0),          -- long side of the images; 0: none; NULL: not stated
  determinism_class TEXT CHECK (determinism_class <> ''),  -- NULL: no worker has been bound yet
  resolved_sweep BLOB NOT NULL                             -- irsig.schema.ResolvedSweep, serialized
) STRICT;

CREATE TABLE asset (
  sha256 TEXT PRIMARY KEY,
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

-- The unit vector from target to sensor in the body frame (x forward, y starboard, z down). The tree keeps float32
-- boxes; the auxiliary columns keep the vector itself, for the exact second step of a nearest query.
CREATE VIRTUAL TABLE viewpoint_direction USING rtree (
  viewpoint_id, min_x, max_x, min_y, max_y, min_z, max_z, +unit_x, +unit_y, +unit_z
);

-- A condition, band or part that a new version of its sweep defines differently stays, superseded, for as long as
-- signatures computed with it have not been replaced.
CREATE TABLE condition (
  condition_id INTEGER PRIMARY KEY,
  sweep_id INTEGER NOT NULL REFERENCES sweep ON DELETE CASCADE,
  condition_index INTEGER NOT NULL CHECK (condition_index >= 0),
  superseded INTEGER NOT NULL DEFAULT 0 CHECK (superseded IN (0, 1)),
  season TEXT NOT NULL,
  time_utc TEXT NOT NULL,
  sun_irradiance_w_m2 REAL NOT NULL,  -- 0: no sun asked for
  air_temperature_k REAL NOT NULL,    -- 0 in vacuum
  surroundings TEXT NOT NULL,         -- 'sea', 'none', ...; what does not apply is NULL
  sky_temperature_k REAL,
  sky_radiance_w_m2_sr_um REAL,
  sea_temperature_k REAL,
  sea_emissivity REAL,
  lower_radiance_w_m2_sr_um REAL,
  definition_sha256 TEXT NOT NULL     -- of everything above and the part temperatures: tells whether it changed
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

CREATE TABLE part_temperature (
  condition_id INTEGER NOT NULL REFERENCES condition ON DELETE CASCADE,
  part_id INTEGER NOT NULL REFERENCES part ON DELETE CASCADE,
  temperature_k REAL NOT NULL CHECK (temperature_k >= 0),
  PRIMARY KEY (condition_id, part_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX part_temperature_by_part ON part_temperature (part_id);

-- The queue -----------------------------------------------------------------------------------------------------------

CREATE TABLE job (
  job_id INTEGER PRIMARY KEY,
  sweep_id INTEGER NOT NULL REFERENCES sweep ON DELETE CASCADE,
  job_index INTEGER NOT NULL CHECK (job_index >= 0),          -- its place in the sweep's list of jobs
  superseded INTEGER NOT NULL DEFAULT 0 CHECK (superseded IN (0, 1)),  -- done, and no longer part of the sweep
  job_key TEXT NOT NULL CHECK (job_key <> ''),
  viewpoint_id INTEGER NOT NULL REFERENCES viewpoint,
  condition_index TEXT NOT NULL CHECK (condition_index GLOB '[[]*]'), -- JSON array
  band_index TEXT NOT NULL CHECK (band_index GLOB '[[]*]'),
  state INTEGER NOT NULL REFERENCES job_state CHECK (state BETWEEN 0 AND 4),
  failures INTEGER NOT NULL DEFAULT 0 CHECK (failures >= 0),  -- failed attempts since it was last submitted
  failures_after_token INTEGER NOT NULL DEFAULT 0,            -- attempts up to this one no longer count
  UNIQUE (sweep_id, job_key)
) STRICT;
CREATE INDEX job_by_viewpoint ON job (viewpoint_id);
CREATE INDEX job_superseded ON job (sweep_id) WHERE superseded = 1;
-- First tries in sweep order; a job that failed goes to the back, so that another worker gets to try it.
CREATE INDEX job_waiting ON job (failures, sweep_id, job_index) WHERE state = 0;

-- One lease of one job. AUTOINCREMENT: a fencing token is never given twice, not even after rows were removed.
CREATE TABLE attempt (
  fencing_token INTEGER PRIMARY KEY AUTOINCREMENT,
  job_id INTEGER NOT NULL REFERENCES job ON DELETE CASCADE,
  worker_id TEXT NOT NULL,
  worker_name TEXT NOT NULL DEFAULT '',  -- as reported when it ended
  leased_unix_s REAL NOT NULL,
  outcome INTEGER NOT NULL DEFAULT 0 REFERENCES attempt_outcome CHECK (outcome BETWEEN 0 AND 4),
  message TEXT NOT NULL DEFAULT ''
) STRICT;
CREATE INDEX attempt_by_job ON attempt (job_id);
CREATE UNIQUE INDEX attempt_running ON attempt (job_id) WHERE outcome = 0;

-- What came back ------------------------------------------------------------------------------------------------------

CREATE TABLE provenance (
  job_id INTEGER PRIMARY KEY REFERENCES job ON DELETE CASCADE,
  seed_hex TEXT NOT NULL,
  physics_version INTEGER NOT NULL CHECK (physics_version >= 0),
  determinism_class TEXT NOT NULL,
  build_id TEXT NOT NULL,
  worker_name TEXT NOT NULL,
  samples INTEGER NOT NULL CHECK (samples >= 0),
  replicates INTEGER NOT NULL CHECK (replicates >= 0),
  target_paths INTEGER NOT NULL CHECK (target_paths >= 0),
  rays INTEGER NOT NULL CHECK (rays >= 0),
  seconds REAL NOT NULL CHECK (seconds >= 0),
  guarded_backface_hits INTEGER NOT NULL CHECK (guarded_backface_hits >= 0),
  guarded_nonfinite INTEGER NOT NULL CHECK (guarded_nonfinite >= 0),
  guarded_path_limit INTEGER NOT NULL CHECK (guarded_path_limit >= 0),
  worst_relative_error REAL NOT NULL CHECK (worst_relative_error >= 0)
) STRICT;

CREATE TABLE signature (
  signature_id INTEGER PRIMARY KEY,
  job_id INTEGER NOT NULL REFERENCES job,
  viewpoint_id INTEGER NOT NULL REFERENCES viewpoint,
  condition_id INTEGER NOT NULL REFERENCES condition,
  band_id INTEGER NOT NULL REFERENCES band,
  sun_azimuth_deg REAL NOT NULL,
  sun_zenith_deg REAL NOT NULL,
  intensity_w_sr REAL NOT NULL,
  intensity_stderr_w_sr REAL NOT NULL CHECK (intensity_stderr_w_sr >= 0),
  numerical_error_w_sr REAL NOT NULL CHECK (numerical_error_w_sr >= 0),
  truncation_bound_w_sr REAL NOT NULL CHECK (truncation_bound_w_sr >= 0),
  quadrature_bound_w_sr REAL NOT NULL CHECK (quadrature_bound_w_sr >= 0),
  apparent_intensity_w_sr REAL NOT NULL,
  apparent_intensity_stderr_w_sr REAL NOT NULL CHECK (apparent_intensity_stderr_w_sr >= 0),
  apparent_numerical_error_w_sr REAL NOT NULL CHECK (apparent_numerical_error_w_sr >= 0),
  projected_area_m2 REAL NOT NULL CHECK (projected_area_m2 >= 0),
  projected_area_stderr_m2 REAL NOT NULL CHECK (projected_area_stderr_m2 >= 0),
  apparent_temperature_k REAL NOT NULL CHECK (apparent_temperature_k >= 0),
  emitted_w_sr REAL NOT NULL,
  emitted_stderr_w_sr REAL NOT NULL CHECK (emitted_stderr_w_sr >= 0),
  sun_reflected_w_sr REAL NOT NULL,
  sun_reflected_stderr_w_sr REAL NOT NULL CHECK (sun_reflected_stderr_w_sr >= 0),
  sky_reflected_w_sr REAL NOT NULL,
  sky_reflected_stderr_w_sr REAL NOT NULL CHECK (sky_reflected_stderr_w_sr >= 0),
  sea_reflected_w_sr REAL NOT NULL,
  sea_reflected_stderr_w_sr REAL NOT NULL CHECK (sea_reflected_stderr_w_sr >= 0),
  parts_reflected_w_sr REAL NOT NULL,
  parts_reflected_stderr_w_sr REAL NOT NULL CHECK (parts_reflected_stderr_w_sr >= 0),
  stop_reason INTEGER NOT NULL REFERENCES stop_reason CHECK (stop_reason BETWEEN 1 AND 4),
  energy_gain INTEGER NOT NULL CHECK (energy_gain IN (0, 1)),
  UNIQUE (condition_id, band_id, viewpoint_id)
) STRICT;
CREATE INDEX signature_by_viewpoint ON signature (viewpoint_id);
CREATE INDEX signature_by_job ON signature (job_id);
CREATE INDEX signature_by_band ON signature (band_id);

-- Each blob: float32, little-endian, one value for each wavelength of band.lambda_um.
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
  sea_reflected_w_sr_um BLOB NOT NULL,
  sea_reflected_stderr_w_sr_um BLOB NOT NULL,
  parts_reflected_w_sr_um BLOB NOT NULL,
  parts_reflected_stderr_w_sr_um BLOB NOT NULL,
  apparent_spectral_intensity_w_sr_um BLOB NOT NULL,
  apparent_spectral_intensity_stderr_w_sr_um BLOB NOT NULL
) STRICT;

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
  pixel_rad REAL NOT NULL CHECK (pixel_rad > 0),
  png BLOB NOT NULL,
  exr BLOB NOT NULL
) STRICT;

-- For people ----------------------------------------------------------------------------------------------------------

-- One line for each stored signature: names instead of numbers, `row` = its stable place in the sweep.
CREATE VIEW signature_view AS
SELECT s.signature_id,
       (v.viewpoint_index * w.conditions + c.condition_index) * w.bands + b.band_index + 1 AS row,
       w.name AS sweep, c.season, c.time_utc, b.name AS band, b.lambda_min_um, b.lambda_max_um,
       v.aspect_azimuth_deg, v.aspect_elevation_deg, v.range_m, s.sun_azimuth_deg, s.sun_zenith_deg,
       s.intensity_w_sr, s.intensity_stderr_w_sr, s.numerical_error_w_sr,
       CASE WHEN s.numerical_error_w_sr = 0 THEN 0.0
            ELSE s.numerical_error_w_sr / abs(s.intensity_w_sr) END AS relative_error,
       s.truncation_bound_w_sr, s.quadrature_bound_w_sr,
       s.apparent_intensity_w_sr, s.apparent_intensity_stderr_w_sr, s.apparent_numerical_error_w_sr,
       s.projected_area_m2, s.projected_area_stderr_m2, s.apparent_temperature_k,
       s.emitted_w_sr, s.emitted_stderr_w_sr, s.sun_reflected_w_sr, s.sun_reflected_stderr_w_sr,
       s.sky_reflected_w_sr, s.sky_reflected_stderr_w_sr, s.sea_reflected_w_sr, s.sea_reflected_stderr_w_sr,
       s.parts_reflected_w_sr, s.parts_reflected_stderr_w_sr,
       r.name AS stop_reason, s.energy_gain,
       p.samples, p.replicates, p.target_paths, p.rays, p.seconds,
       p.guarded_backface_hits, p.guarded_nonfinite, p.guarded_path_limit,
       j.job_key, j.superseded, p.seed_hex, p.physics_version, p.determinism_class, p.build_id, p.worker_name
FROM signature s
JOIN viewpoint v USING (viewpoint_id)
JOIN sweep w ON w.sweep_id = v.sweep_id
JOIN condition c USING (condition_id)
JOIN band b USING (band_id)
JOIN stop_reason r USING (stop_reason)
JOIN job j USING (job_id)
JOIN provenance p USING (job_id);

CREATE VIEW part_intensity_view AS
SELECT i.signature_id, p.name AS part, p.material, i.intensity_w_sr, i.intensity_stderr_w_sr
FROM part_intensity i JOIN part p USING (part_id);

CREATE VIEW part_temperature_view AS
SELECT w.name AS sweep, c.season, c.time_utc, p.name AS part, t.temperature_k
FROM part_temperature t
JOIN condition c USING (condition_id)
JOIN part p USING (part_id)
JOIN sweep w ON w.sweep_id = c.sweep_id;

CREATE VIEW job_view AS
SELECT w.name AS sweep, j.job_index, s.name AS state, j.superseded, j.failures, j.job_key, v.viewpoint_index,
       v.aspect_azimuth_deg, v.aspect_elevation_deg, v.range_m, j.condition_index, j.band_index,
       (SELECT fencing_token FROM attempt a WHERE a.job_id = j.job_id AND outcome = 0) AS fencing_token,
       (SELECT worker_id FROM attempt a WHERE a.job_id = j.job_id AND outcome = 0) AS leased_to,
       p.worker_name AS done_by, p.seconds, p.rays, p.worst_relative_error
FROM job j
JOIN sweep w USING (sweep_id)
JOIN job_state s USING (state)
JOIN viewpoint v USING (viewpoint_id)
LEFT JOIN provenance p USING (job_id);

CREATE VIEW attempt_view AS
SELECT a.fencing_token, w.name AS sweep, j.job_index, j.job_key, a.worker_id, a.worker_name,
       datetime(a.leased_unix_s, 'unixepoch') AS leased_utc, o.name AS outcome, a.message
FROM attempt a
JOIN job j USING (job_id)
JOIN sweep w USING (sweep_id)
JOIN attempt_outcome o USING (outcome);

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
       w.sweep_id
FROM sweep w
LEFT JOIN job j ON j.sweep_id = w.sweep_id AND j.superseded = 0
LEFT JOIN provenance p ON p.job_id = j.job_id
GROUP BY w.sweep_id;
