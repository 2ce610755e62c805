-- Version 3: contrast and background, the path between target and sensor, further bounds and model errors, weather
-- and warnings of a condition. In rows that an older version stored the new columns are NULL: not computed.

ALTER TABLE condition ADD COLUMN sea_model TEXT;             -- 'cox_munk', 'flat', 'grey'; NULL: does not apply
ALTER TABLE condition ADD COLUMN ground_temperature_k REAL;
ALTER TABLE condition ADD COLUMN ground_emissivity REAL;
-- irsig.schema.Weather as JSON, the texts of files replaced by their SHA-256; NULL: no embedded atmosphere.
ALTER TABLE condition ADD COLUMN weather TEXT;
ALTER TABLE condition ADD COLUMN warning TEXT;               -- what is odd about it, one line each; '': nothing

ALTER TABLE provenance ADD COLUMN guarded_negative INTEGER CHECK (guarded_negative >= 0);

ALTER TABLE signature ADD COLUMN unseen_bound_w_sr REAL CHECK (unseen_bound_w_sr >= 0);
ALTER TABLE signature ADD COLUMN basis_bound_w_sr REAL CHECK (basis_bound_w_sr >= 0);
ALTER TABLE signature ADD COLUMN sky_bound_w_sr REAL CHECK (sky_bound_w_sr >= 0);
ALTER TABLE signature ADD COLUMN contrast_intensity_w_sr REAL;
ALTER TABLE signature ADD COLUMN contrast_intensity_stderr_w_sr REAL CHECK (contrast_intensity_stderr_w_sr >= 0);
ALTER TABLE signature ADD COLUMN contrast_numerical_error_w_sr REAL CHECK (contrast_numerical_error_w_sr >= 0);
ALTER TABLE signature ADD COLUMN background_radiance_w_m2_sr REAL;
ALTER TABLE signature ADD COLUMN background_radiance_stderr_w_m2_sr REAL
  CHECK (background_radiance_stderr_w_m2_sr >= 0);
ALTER TABLE signature ADD COLUMN model_error_w_sr REAL CHECK (model_error_w_sr >= 0);
ALTER TABLE signature ADD COLUMN apparent_model_error_w_sr REAL CHECK (apparent_model_error_w_sr >= 0);
ALTER TABLE signature ADD COLUMN path_transmittance REAL CHECK (path_transmittance >= 0);
ALTER TABLE signature ADD COLUMN path_radiance_w_m2_sr REAL;

ALTER TABLE spectrum ADD COLUMN contrast_spectral_intensity_w_sr_um BLOB;
ALTER TABLE spectrum ADD COLUMN contrast_spectral_intensity_stderr_w_sr_um BLOB;
ALTER TABLE spectrum ADD COLUMN background_radiance_w_m2_sr_um BLOB;
ALTER TABLE spectrum ADD COLUMN background_radiance_stderr_w_m2_sr_um BLOB;
ALTER TABLE spectrum ADD COLUMN path_transmittance BLOB;
ALTER TABLE spectrum ADD COLUMN path_radiance_w_m2_sr_um BLOB;

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
