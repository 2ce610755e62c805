-- Of hot gas: what the target reflects of it, less what it takes of other light that the target reflects (part of
-- plume_w_sr); its projected area where its in-band optical depth is that of the sweep; what half the resolution of its
-- voxels changes. NULL: the row has no hot gas, or is older. Effects of hot gas: in ledgers of rows that have some.

ALTER TABLE signature ADD COLUMN plume_on_hull_w_sr REAL;
ALTER TABLE signature ADD COLUMN plume_on_hull_stderr_w_sr REAL CHECK (plume_on_hull_stderr_w_sr >= 0);
ALTER TABLE signature ADD COLUMN apparent_plume_on_hull_w_sr REAL;
ALTER TABLE signature ADD COLUMN apparent_plume_on_hull_stderr_w_sr REAL CHECK (apparent_plume_on_hull_stderr_w_sr >= 0);
ALTER TABLE signature ADD COLUMN plume_area_m2 REAL;
ALTER TABLE signature ADD COLUMN plume_area_stderr_m2 REAL CHECK (plume_area_stderr_m2 >= 0);
ALTER TABLE signature ADD COLUMN plume_voxel_error_w_sr REAL CHECK (plume_voxel_error_w_sr >= 0);

-- Those that a row has with hot gas only.
ALTER TABLE effect ADD COLUMN of_hot_gas INTEGER NOT NULL DEFAULT 0 CHECK (of_hot_gas IN (0, 1));
INSERT INTO effect (effect, name, of_hot_gas) VALUES
  (20, 'plume', 1), (21, 'plume_on_hull', 1), (22, 'hot_line_correlation', 1);
INSERT INTO effect_reason VALUES (10, 'not_asked');

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
       s.background_bound_w_sr, s.backface_share, s.temperature_bound_w_sr, s.apparent_temperature_bound_w_sr,
       s.plume_w_sr, s.plume_stderr_w_sr, s.apparent_plume_w_sr, s.apparent_plume_stderr_w_sr,
       s.contrast_plume_w_sr, s.contrast_plume_stderr_w_sr, s.plume_emitted_w_sr, s.apparent_plume_emitted_w_sr,
       s.plume_bound_w_sr, s.apparent_plume_bound_w_sr, s.contrast_plume_bound_w_sr, s.plume_model_error_w_sr,
       s.plume_on_hull_w_sr, s.plume_on_hull_stderr_w_sr, s.apparent_plume_on_hull_w_sr,
       s.apparent_plume_on_hull_stderr_w_sr, s.plume_area_m2, s.plume_area_stderr_m2, s.plume_voxel_error_w_sr,
       s.input_uncertainty_w_sr, s.apparent_input_uncertainty_w_sr, s.contrast_input_uncertainty_w_sr,
       (SELECT group_concat(printf('%s=%+.4g', input, contribution_w_sr), ', ')
        FROM (SELECT i.input, i.contribution_w_sr FROM input_contribution i
              WHERE i.signature_id = s.signature_id AND abs(i.contribution_w_sr) > 2 * i.contribution_stderr_w_sr
              ORDER BY abs(i.contribution_w_sr) DESC, i.input_index LIMIT 3)) AS dominant_inputs,
       s.reflections,
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
