-- Version 5: what was left out of a signature, and why. A row that an older version stored has no line in `ledger` and
-- in `energy`, and NULL in the new columns: it is not known what would have been on, which is not "absent".

-- Names of the stored numbers, in the order in which people are shown them. Numbers are never reused.
CREATE TABLE effect (
  effect INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE,
  bounded_with INTEGER REFERENCES effect  -- the effect whose bound has this one in it; NULL: it has its own
) STRICT;
INSERT INTO effect (effect, name) VALUES
  (1, 'self_emission'), (2, 'direct_sun'), (3, 'diffuse_sun'), (4, 'mirrored_sun'), (5, 'sky_reflected'),
  (6, 'lower_reflected'), (7, 'inter_reflection'), (8, 'hot_parts_reflected'), (9, 'transmission'),
  (10, 'path_radiance'), (11, 'path_sun'), (12, 'background_sun'), (13, 'joined_lines'), (14, 'air_to_horizon'),
  (15, 'sun_disk'), (16, 'directional_emissivity'), (17, 'spectral_variation'), (18, 'perspective'),
  (19, 'refraction');
UPDATE effect SET bounded_with = 7 WHERE name = 'hot_parts_reflected';

CREATE TABLE effect_state (
  state INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE
) STRICT;
INSERT INTO effect_state VALUES (1, 'on'), (2, 'off'), (3, 'absent');

CREATE TABLE effect_reason (
  reason INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE
) STRICT;
INSERT INTO effect_reason VALUES
  (1, 'always'), (2, 'not_in_scene'), (3, 'within_share'), (4, 'above_share'), (5, 'other_row'), (6, 'no_goal'),
  (7, 'not_worth'), (8, 'unbounded'), (9, 'forced');

ALTER TABLE signature ADD COLUMN omitted_bound_w_sr REAL CHECK (omitted_bound_w_sr >= 0);
ALTER TABLE signature ADD COLUMN apparent_omitted_bound_w_sr REAL CHECK (apparent_omitted_bound_w_sr >= 0);
ALTER TABLE signature ADD COLUMN contrast_omitted_bound_w_sr REAL CHECK (contrast_omitted_bound_w_sr >= 0);
ALTER TABLE signature ADD COLUMN absolute_floor_w_sr REAL CHECK (absolute_floor_w_sr >= 0);
ALTER TABLE signature ADD COLUMN reflections INTEGER CHECK (reflections >= 0);

-- One line for each effect of a signature. NULL: not known. time_s: of the whole view, estimated from counts; spent
-- (on) or saved (off).
CREATE TABLE ledger (
  signature_id INTEGER NOT NULL REFERENCES signature ON DELETE CASCADE,
  effect INTEGER NOT NULL REFERENCES effect,
  state INTEGER NOT NULL REFERENCES effect_state CHECK (state BETWEEN 1 AND 3),
  reason INTEGER NOT NULL REFERENCES effect_reason,
  bound_w_sr REAL CHECK (bound_w_sr >= 0),
  apparent_bound_w_sr REAL CHECK (apparent_bound_w_sr >= 0),
  contrast_bound_w_sr REAL CHECK (contrast_bound_w_sr >= 0),
  share_w_sr REAL,
  time_s REAL CHECK (time_s >= 0),
  PRIMARY KEY (signature_id, effect)
) STRICT, WITHOUT ROWID;

-- Where light that the sensor would send out ends, in-band mean; no line: nothing of the target is seen.
CREATE TABLE energy (
  signature_id INTEGER PRIMARY KEY REFERENCES signature ON DELETE CASCADE,
  absorbed REAL NOT NULL,
  absorbed_stderr REAL NOT NULL CHECK (absorbed_stderr >= 0),
  escaped_to_sky REAL NOT NULL,
  escaped_to_sky_stderr REAL NOT NULL CHECK (escaped_to_sky_stderr >= 0),
  escaped_to_lower REAL NOT NULL,
  escaped_to_lower_stderr REAL NOT NULL CHECK (escaped_to_lower_stderr >= 0),
  cut_off REAL NOT NULL,
  cut_off_stderr REAL NOT NULL CHECK (cut_off_stderr >= 0),
  balance REAL NOT NULL,
  balance_stderr REAL NOT NULL CHECK (balance_stderr >= 0)
) STRICT;

-- One line for each effect of a signature: names instead of numbers.
CREATE VIEW ledger_view AS
SELECT l.signature_id, e.name AS effect, s.name AS state, r.name AS reason, l.bound_w_sr, l.apparent_bound_w_sr,
       l.contrast_bound_w_sr, l.share_w_sr, l.time_s
FROM ledger l
JOIN effect e USING (effect)
JOIN effect_state s USING (state)
JOIN effect_reason r USING (reason);

DROP VIEW signature_view;
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
       s.unseen_bound_w_sr, s.basis_bound_w_sr, s.sky_bound_w_sr,
       s.contrast_intensity_w_sr, s.contrast_intensity_stderr_w_sr, s.contrast_numerical_error_w_sr,
       s.background_radiance_w_m2_sr, s.background_radiance_stderr_w_m2_sr,
       s.model_error_w_sr, s.apparent_model_error_w_sr, s.path_transmittance, s.path_radiance_w_m2_sr,
       s.omitted_bound_w_sr, s.apparent_omitted_bound_w_sr, s.contrast_omitted_bound_w_sr, s.absolute_floor_w_sr,
       s.reflections,
       r.name AS stop_reason, s.energy_gain, c.warning,
       p.samples, p.replicates, p.target_paths, p.rays, p.seconds,
       p.guarded_backface_hits, p.guarded_nonfinite, p.guarded_path_limit, p.guarded_negative,
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
