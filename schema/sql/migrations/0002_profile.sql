-- Version 2: radiance profiles, and numbers that others have published for them.

-- Rows that each signature of the sweep must bring: points x numbers of reflections, all profiles.
ALTER TABLE sweep ADD COLUMN profile_rows INTEGER NOT NULL DEFAULT 0 CHECK (profile_rows >= 0);

-- Mean in-band radiance over a footprint, with at most `reflections` reflections. A row lives and dies with the
-- signature of its viewpoint, condition and band; its provenance is that of the same job.
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
  apparent_temperature_k REAL NOT NULL CHECK (apparent_temperature_k >= 0),
  apparent_temperature_stderr_k REAL NOT NULL CHECK (apparent_temperature_stderr_k >= 0),
  target_fraction REAL NOT NULL,
  samples INTEGER NOT NULL CHECK (samples >= 0),
  PRIMARY KEY (signature_id, profile_index, point_index, reflections)
) STRICT, WITHOUT ROWID;

-- What the sweep file states under [[published]].
CREATE TABLE published (
  sweep_id INTEGER NOT NULL REFERENCES sweep ON DELETE CASCADE,
  published_index INTEGER NOT NULL CHECK (published_index >= 0),
  profile TEXT NOT NULL,
  point_index INTEGER NOT NULL CHECK (point_index >= 0),
  reflections INTEGER NOT NULL CHECK (reflections >= 0),
  apparent_temperature_k REAL NOT NULL CHECK (apparent_temperature_k >= 0),
  relation TEXT NOT NULL CHECK (relation IN ('equal', 'below', 'above')),
  source TEXT NOT NULL,
  remark TEXT NOT NULL,
  PRIMARY KEY (sweep_id, published_index)
) STRICT, WITHOUT ROWID;

-- One line for each row of a profile: names instead of numbers.
CREATE VIEW profile_view AS
SELECT s.sweep, s.season, s.time_utc, s.band, s.lambda_min_um, s.lambda_max_um,
       s.aspect_azimuth_deg, s.aspect_elevation_deg, s.range_m, s.row,
       f.name AS profile, f.profile_index, f.point_index, f.x_m, f.y_m, f.z_m, f.footprint_width_m,
       f.footprint_height_m, f.reflections, f.radiance_w_m2_sr, f.radiance_stderr_w_m2_sr, f.apparent_radiance_w_m2_sr,
       f.apparent_radiance_stderr_w_m2_sr, f.truncation_bound_w_m2_sr, f.quadrature_bound_w_m2_sr,
       f.apparent_temperature_k, f.apparent_temperature_stderr_k, f.target_fraction, f.samples,
       s.replicates, s.energy_gain, s.seed_hex, s.physics_version, s.determinism_class, s.build_id, s.job_key
FROM profile f
JOIN signature_view s USING (signature_id);
