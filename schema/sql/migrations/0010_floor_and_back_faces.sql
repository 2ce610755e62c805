-- A row whose error is above the relative one that was asked for, and not above the floor (accuracy.absolute_error_k),
-- has a reason of its own to stop: floor_reached. Older rows keep what they say: target_reached.
--
-- backface_share: of the silhouette, one-sided facets that were seen from behind. They send nothing: signature_view
-- warns of them, with the remedy.

INSERT INTO stop_reason VALUES (5, 'floor_reached');

-- Made anew, because SQLite cannot change a column's CHECK (0007_job_kinds.sql says how): which reasons there are the
-- table of their names knows. All columns in their order: that a column is missing here is an error, not a loss.
CREATE TABLE earlier_signature AS SELECT * FROM signature;
DROP TABLE signature;
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
  stop_reason INTEGER NOT NULL REFERENCES stop_reason,
  energy_gain INTEGER NOT NULL CHECK (energy_gain IN (0, 1)),
  -- NULL from here on: of a row whose format did not have it.
  unseen_bound_w_sr REAL CHECK (unseen_bound_w_sr >= 0),
  basis_bound_w_sr REAL CHECK (basis_bound_w_sr >= 0),
  sky_bound_w_sr REAL CHECK (sky_bound_w_sr >= 0),
  contrast_intensity_w_sr REAL,
  contrast_intensity_stderr_w_sr REAL CHECK (contrast_intensity_stderr_w_sr >= 0),
  contrast_numerical_error_w_sr REAL CHECK (contrast_numerical_error_w_sr >= 0),
  background_radiance_w_m2_sr REAL,
  background_radiance_stderr_w_m2_sr REAL CHECK (background_radiance_stderr_w_m2_sr >= 0),
  model_error_w_sr REAL CHECK (model_error_w_sr >= 0),
  apparent_model_error_w_sr REAL CHECK (apparent_model_error_w_sr >= 0),
  path_transmittance REAL CHECK (path_transmittance >= 0),
  path_radiance_w_m2_sr REAL,
  omitted_bound_w_sr REAL CHECK (omitted_bound_w_sr >= 0),
  apparent_omitted_bound_w_sr REAL CHECK (apparent_omitted_bound_w_sr >= 0),
  contrast_omitted_bound_w_sr REAL CHECK (contrast_omitted_bound_w_sr >= 0),
  absolute_floor_w_sr REAL CHECK (absolute_floor_w_sr >= 0),
  reflections INTEGER CHECK (reflections >= 0),
  depth_bound_w_sr REAL CHECK (depth_bound_w_sr >= 0),
  unseen_stderr_w_sr REAL CHECK (unseen_stderr_w_sr >= 0),
  apparent_unseen_stderr_w_sr REAL CHECK (apparent_unseen_stderr_w_sr >= 0),
  contrast_unseen_stderr_w_sr REAL CHECK (contrast_unseen_stderr_w_sr >= 0),
  contrast_model_error_w_sr REAL CHECK (contrast_model_error_w_sr >= 0),
  background_bound_w_sr REAL CHECK (background_bound_w_sr >= 0),
  backface_share REAL CHECK (backface_share >= 0),
  UNIQUE (condition_id, band_id, viewpoint_id)
) STRICT;
INSERT INTO signature SELECT *, NULL FROM earlier_signature;
DROP TABLE earlier_signature;

CREATE INDEX signature_by_viewpoint ON signature (viewpoint_id);
CREATE INDEX signature_by_job ON signature (job_id);
CREATE INDEX signature_by_band ON signature (band_id);

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
       s.model_error_w_sr, s.apparent_model_error_w_sr, s.contrast_model_error_w_sr,
       s.path_transmittance, s.path_radiance_w_m2_sr,
       s.omitted_bound_w_sr, s.apparent_omitted_bound_w_sr, s.contrast_omitted_bound_w_sr, s.absolute_floor_w_sr,
       s.depth_bound_w_sr, s.unseen_stderr_w_sr, s.apparent_unseen_stderr_w_sr, s.contrast_unseen_stderr_w_sr,
       s.background_bound_w_sr, s.backface_share, s.reflections,
       r.name AS stop_reason, s.energy_gain,
       CASE WHEN s.backface_share > 0
            THEN coalesce(nullif(c.warning, '') || char(10), '') ||
                 'back faces: one-sided facets of the silhouette are seen from behind and send nothing: ' ||
                 'two_sided = true for parts that are sheets, `irsig model check --repair` for facets inside out'
            ELSE c.warning END AS warning,
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
