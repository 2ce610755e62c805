-- Storing a result (schema/store/ingest.cpp).

-- name: wants_thumbnail
SELECT thumbnail_px > 0 FROM sweep WHERE sweep_id = ?1 AND thumbnail_px IS NOT NULL;

-- name: wanted_profile_rows
SELECT profile_rows FROM sweep WHERE sweep_id = ?1;

-- name: image_layers
SELECT image_layers FROM sweep WHERE sweep_id = ?1;

-- name: uncertain_inputs
SELECT uncertain_inputs FROM sweep WHERE sweep_id = ?1;

-- name: part_ids
SELECT part_id FROM part WHERE sweep_id = ?1 AND superseded = 0 ORDER BY part_index;

-- name: current_condition
SELECT condition_id FROM condition WHERE sweep_id = ?1 AND condition_index = ?2 AND superseded = 0;

-- name: current_band
SELECT band_id, lambda_min_um, lambda_max_um, lambda_um FROM band
WHERE sweep_id = ?1 AND band_index = ?2 AND superseded = 0;

-- name: set_band_wavelengths
UPDATE band SET lambda_um = ?2 WHERE band_id = ?1;

-- name: count_signatures_of_viewpoint
SELECT count(*) FROM (SELECT 1 FROM signature WHERE viewpoint_id = ?1 LIMIT 1);

-- With its first signature: a nearest query looks at no viewpoint that has none.
-- name: viewpoint_without_direction
SELECT aspect_azimuth_deg, aspect_elevation_deg FROM viewpoint
WHERE viewpoint_id = ?1 AND NOT EXISTS (SELECT 1 FROM viewpoint_direction d WHERE d.viewpoint_id = ?1);

-- name: insert_viewpoint_direction
INSERT INTO viewpoint_direction (viewpoint_id, min_x, max_x, min_y, max_y, min_z, max_z, unit_x, unit_y, unit_z)
VALUES (?1, ?2, ?2, ?3, ?3, ?4, ?4, ?2, ?3, ?4);

-- Whatever lies at one place of the sweep: an earlier result of the job, or one of a superseded job.
-- name: delete_signature_at_place
DELETE FROM signature
WHERE viewpoint_id = ?2
  AND condition_id IN (SELECT condition_id FROM condition WHERE sweep_id = ?1 AND condition_index = ?3)
  AND band_id IN (SELECT band_id FROM band WHERE sweep_id = ?1 AND band_index = ?4);

-- name: insert_provenance
INSERT OR REPLACE INTO provenance (
  job_id, seed_hex, physics_version, determinism_class, build_id, worker_name, samples, replicates, target_paths,
  rays, seconds, guarded_backface_hits, guarded_nonfinite, truncated_paths, worst_relative_error,
  guarded_negative, content_sha256)
VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17);

-- The columns of the catalogue of quantities (core/accuracy/quantities.h), and as many parameters, are put in by
-- name where QUANTITIES and PARAMETERS stand.
-- name: insert_signature
INSERT INTO signature (
  job_id, viewpoint_id, condition_id, band_id, sun_azimuth_deg, sun_zenith_deg, stop_reason, limiting_bound, energy_gain,
  reflections, QUANTITIES)
VALUES (?, ?, ?, ?, ?, ?, ?, nullif(?, ''), ?, ?, PARAMETERS);

-- name: insert_clutter
INSERT INTO clutter (signature_id, patch_sigma_w_m2_sr_um, modes) VALUES (?1, ?2, ?3);

-- name: insert_clutter_material
INSERT INTO clutter_material (signature_id, material_index, fraction) VALUES (?1, ?2, ?3);

-- name: insert_spectral_modes
INSERT INTO spectral_modes (signature_id, spectral_intensity_modes, apparent_spectral_intensity_modes,
                            contrast_spectral_intensity_modes)
VALUES (?1, ?2, ?3, ?4);

-- name: insert_spectrum
INSERT INTO spectrum (
  signature_id, spectral_intensity_w_sr_um, spectral_intensity_stderr_w_sr_um, emitted_w_sr_um, emitted_stderr_w_sr_um,
  sun_reflected_w_sr_um, sun_reflected_stderr_w_sr_um, sky_reflected_w_sr_um, sky_reflected_stderr_w_sr_um,
  surface_reflected_w_sr_um, surface_reflected_stderr_w_sr_um, interreflected_w_sr_um, interreflected_stderr_w_sr_um,
  apparent_spectral_intensity_w_sr_um, apparent_spectral_intensity_stderr_w_sr_um,
  contrast_spectral_intensity_w_sr_um, contrast_spectral_intensity_stderr_w_sr_um, background_radiance_w_m2_sr_um,
  background_radiance_stderr_w_m2_sr_um, path_transmittance, path_radiance_w_m2_sr_um,
  plume_w_sr_um, plume_stderr_w_sr_um, apparent_plume_w_sr_um, apparent_plume_stderr_w_sr_um, contrast_plume_w_sr_um,
  contrast_plume_stderr_w_sr_um)
VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18, ?19, ?20, ?21,
        nullif(?22, x''), nullif(?23, x''), nullif(?24, x''), nullif(?25, x''), nullif(?26, x''), nullif(?27, x''));

-- name: insert_part_intensity
INSERT INTO part_intensity (signature_id, part_id, intensity_w_sr, intensity_stderr_w_sr) VALUES (?1, ?2, ?3, ?4);

-- name: known_effects
SELECT name, effect FROM effect;

-- name: effects_without_own_bound
SELECT name, bounded_with FROM effect WHERE bounded_with IS NOT NULL;

-- name: effects_of_hot_gas
SELECT name, effect FROM effect WHERE of_hot_gas = 1;

-- name: effects_of_cloud
SELECT name, effect FROM effect WHERE of_cloud = 1;

-- name: known_effect_reasons
SELECT name, reason FROM effect_reason;

-- name: insert_ledger_entry
INSERT INTO ledger (
  signature_id, effect, state, reason, bound_w_sr, apparent_bound_w_sr, contrast_bound_w_sr, fraction_w_sr, time_s)
VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9);

-- name: insert_input_contribution
INSERT INTO input_contribution (
  signature_id, input_index, input, contribution_w_sr, contribution_stderr_w_sr, apparent_contribution_w_sr,
  apparent_contribution_stderr_w_sr, contrast_contribution_w_sr, contrast_contribution_stderr_w_sr, curvature_w_sr,
  apparent_curvature_w_sr, contrast_curvature_w_sr)
VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12);

-- name: insert_energy
INSERT INTO energy (
  signature_id, absorbed, absorbed_stderr, escaped_to_sky, escaped_to_sky_stderr, escaped_to_surface,
  escaped_to_surface_stderr, cut_off, cut_off_stderr, balance, balance_stderr)
VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11);

-- name: insert_thumbnail
INSERT INTO thumbnail (signature_id, width_px, height_px, pixel_rad, error_relative, error_k, png, exr,
  stderr_exr)
VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9);

-- name: insert_image_layer
INSERT INTO image_layer (signature_id, name, exr, stderr_exr) VALUES (?1, ?2, ?3, ?4);

-- name: delete_silhouette
DELETE FROM silhouette WHERE job_id = ?1;

-- name: insert_silhouette
INSERT INTO silhouette (job_id, width_px, height_px, pixel_samples) VALUES (?1, ?2, ?3, ?4);

-- name: part_name
SELECT name FROM part WHERE part_id = ?1;

-- name: insert_part_set
INSERT INTO part_set (job_id, parts, outside_px, samples) VALUES (?1, ?2, ?3, ?4);

-- name: insert_part_pixels
INSERT INTO part_pixels (job_id, part_id, left_px, top_px, width_px, height_px, samples)
VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7);

-- name: insert_profile_row
INSERT INTO profile (
  signature_id, profile_index, point_index, reflections, name, x_m, y_m, z_m, footprint_width_m, footprint_height_m,
  radiance_w_m2_sr, radiance_stderr_w_m2_sr, apparent_radiance_w_m2_sr, apparent_radiance_stderr_w_m2_sr,
  truncation_bound_w_m2_sr, quadrature_bound_w_m2_sr, source_radiance_temperature_k, source_radiance_temperature_stderr_k,
  target_fraction, samples)
VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18, ?19, ?20);
