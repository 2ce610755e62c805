-- The digest (schema/store/tables/digest.cpp, schema/README.md): what does not depend on when, where, by whom and in which
-- pieces it was computed, in key order. Column order is part of the digest's definition.

-- name: digest_sweeps
SELECT sweep_id, name, model_sha256, viewpoints, conditions, bands FROM sweep ORDER BY name;

-- name: digest_viewpoints
SELECT viewpoint_index, aspect_azimuth_deg, aspect_elevation_deg, range_m
FROM viewpoint WHERE sweep_id = ?1 ORDER BY viewpoint_index;

-- name: digest_conditions
SELECT condition_id, condition_index, superseded, season, time_utc, sun_irradiance_w_m2, air_temperature_k,
       surroundings, sky_temperature_k, sky_radiance_w_m2_sr_um, sea_temperature_k, sea_emissivity,
       lower_radiance_w_m2_sr_um, sea_model, ground_temperature_k, ground_emissivity, weather, warning
FROM condition WHERE sweep_id = ?1 ORDER BY condition_index, superseded, definition_sha256;

-- name: digest_part_temperatures
SELECT name, temperature FROM (
  SELECT p.part_index AS place, p.name, t.temperature_k AS temperature
  FROM part_temperature t JOIN part p USING (part_id)
  WHERE t.condition_id = ?1
  UNION ALL
  SELECT 1000000000, 'temperature field', temperature_field
  FROM condition WHERE condition_id = ?1 AND temperature_field IS NOT NULL)
ORDER BY place, name;

-- Only sweeps with done heat jobs are hashed here: the digests of all others stay as they were before heat jobs
-- existed.
-- name: digest_heat_jobs
SELECT j.job_id, h.heat_index, j.superseded, h.season, h.output_sha256, h.warning, p.seed_hex, p.physics_version
FROM heat_job h JOIN job j USING (job_id) JOIN provenance p USING (job_id)
WHERE j.sweep_id = ?1 AND h.output_sha256 IS NOT NULL
ORDER BY h.heat_index, j.superseded, h.season, h.output_sha256;

-- name: digest_computed_temperatures
SELECT t.time_index, t.time_utc, p.name, t.mean_k, t.coldest_k, t.hottest_k, t.error_k
FROM computed_temperature t JOIN part p USING (part_id)
WHERE t.job_id = ?1 ORDER BY t.time_index, p.part_index, p.name;

-- name: has_heat_output
SELECT EXISTS (SELECT 1 FROM heat_job JOIN job USING (job_id) WHERE sweep_id = ?1 AND output_sha256 IS NOT NULL);

-- name: digest_bands
SELECT band_id, band_index, superseded, name, lambda_min_um, lambda_max_um, lambda_um
FROM band WHERE sweep_id = ?1 ORDER BY band_index, superseded, definition_sha256;

-- name: digest_band_response
SELECT lambda_um, response FROM band_response WHERE band_id = ?1 ORDER BY lambda_um;

-- name: digest_parts
SELECT part_index, superseded, name, material
FROM part WHERE sweep_id = ?1 ORDER BY part_index, superseded, name;

-- name: digest_signatures
SELECT s.signature_id,
       (v.viewpoint_index * w.conditions + c.condition_index) * w.bands + b.band_index + 1 AS row,
       j.superseded, s.sun_azimuth_deg, s.sun_zenith_deg, s.intensity_w_sr, s.intensity_stderr_w_sr,
       s.numerical_error_w_sr, s.truncation_bound_w_sr, s.quadrature_bound_w_sr, s.apparent_intensity_w_sr,
       s.apparent_intensity_stderr_w_sr, s.apparent_numerical_error_w_sr, s.apparent_temperature_k, s.projected_area_m2,
       s.projected_area_stderr_m2, s.source_radiance_temperature_k, s.emitted_w_sr, s.emitted_stderr_w_sr,
       s.sun_reflected_w_sr, s.sun_reflected_stderr_w_sr, s.sky_reflected_w_sr, s.sky_reflected_stderr_w_sr,
       s.surface_reflected_w_sr, s.surface_reflected_stderr_w_sr, s.interreflected_w_sr, s.interreflected_stderr_w_sr,
       s.undersampling_bound_w_sr, s.spectral_basis_bound_w_sr, s.direction_interpolation_bound_w_sr, s.contrast_intensity_w_sr,
       s.contrast_intensity_stderr_w_sr, s.contrast_numerical_error_w_sr, s.background_radiance_w_m2_sr,
       s.background_radiance_stderr_w_m2_sr, s.model_error_w_sr, s.apparent_model_error_w_sr, s.path_transmittance,
       s.path_radiance_w_m2_sr, s.omitted_bound_w_sr, s.apparent_omitted_bound_w_sr, s.contrast_omitted_bound_w_sr,
       s.absolute_floor_w_sr, s.reflections,
       s.stop_reason, s.energy_gain, p.seed_hex, p.physics_version, p.samples, p.replicates, p.target_paths
FROM viewpoint v
CROSS JOIN sweep w ON w.sweep_id = v.sweep_id
CROSS JOIN signature s ON s.viewpoint_id = v.viewpoint_id
JOIN condition c USING (condition_id)
JOIN band b USING (band_id)
JOIN job j USING (job_id)
JOIN provenance p USING (job_id)
WHERE v.sweep_id = ?1
ORDER BY v.viewpoint_index, c.condition_index, b.band_index;

-- name: digest_spectrum
SELECT spectral_intensity_w_sr_um, spectral_intensity_stderr_w_sr_um, emitted_w_sr_um, emitted_stderr_w_sr_um,
       sun_reflected_w_sr_um, sun_reflected_stderr_w_sr_um, sky_reflected_w_sr_um, sky_reflected_stderr_w_sr_um,
       surface_reflected_w_sr_um, surface_reflected_stderr_w_sr_um, interreflected_w_sr_um, interreflected_stderr_w_sr_um,
       apparent_spectral_intensity_w_sr_um, apparent_spectral_intensity_stderr_w_sr_um,
       contrast_spectral_intensity_w_sr_um, contrast_spectral_intensity_stderr_w_sr_um,
       background_radiance_w_m2_sr_um, background_radiance_stderr_w_m2_sr_um, path_transmittance,
       path_radiance_w_m2_sr_um
FROM spectrum WHERE signature_id = ?1;

-- name: digest_part_intensities
SELECT p.name, i.intensity_w_sr, i.intensity_stderr_w_sr
FROM part_intensity i JOIN part p USING (part_id)
WHERE i.signature_id = ?1 ORDER BY p.part_index, p.name;

-- All but time_s.
-- name: digest_ledger
SELECT e.name, l.state, r.name, l.bound_w_sr, l.apparent_bound_w_sr, l.contrast_bound_w_sr, l.fraction_w_sr
FROM ledger l JOIN effect e USING (effect) JOIN effect_reason r USING (reason)
WHERE l.signature_id = ?1 ORDER BY l.effect;

-- name: digest_energy
SELECT absorbed, absorbed_stderr, escaped_to_sky, escaped_to_sky_stderr, escaped_to_surface, escaped_to_surface_stderr,
       cut_off, cut_off_stderr, balance, balance_stderr
FROM energy WHERE signature_id = ?1;

-- Only signatures with hot gas are hashed here: the digests of all others stay as they were before hot gas existed.
-- name: has_plume
SELECT plume_w_sr IS NOT NULL FROM signature WHERE signature_id = ?1;

-- name: digest_plume
SELECT s.plume_w_sr, s.plume_stderr_w_sr, s.apparent_plume_w_sr, s.apparent_plume_stderr_w_sr, s.contrast_plume_w_sr,
       s.contrast_plume_stderr_w_sr, s.plume_emitted_w_sr, s.apparent_plume_emitted_w_sr, s.plume_bound_w_sr,
       s.apparent_plume_bound_w_sr, s.contrast_plume_bound_w_sr, s.plume_model_error_w_sr, p.plume_w_sr_um,
       p.plume_stderr_w_sr_um, p.apparent_plume_w_sr_um, p.apparent_plume_stderr_w_sr_um, p.contrast_plume_w_sr_um,
       p.contrast_plume_stderr_w_sr_um
FROM signature s JOIN spectrum p USING (signature_id) WHERE s.signature_id = ?1;

-- Only signatures with these columns are hashed here: the digests of older ones stay as they were.
-- name: has_plume_details
SELECT plume_area_m2 IS NOT NULL FROM signature WHERE signature_id = ?1;

-- name: digest_plume_details
SELECT plume_reflected_w_sr, plume_reflected_stderr_w_sr, apparent_plume_reflected_w_sr, apparent_plume_reflected_stderr_w_sr,
       plume_area_m2, plume_area_stderr_m2, plume_voxel_error_w_sr
FROM signature WHERE signature_id = ?1;

-- Only signatures with a measured background are hashed here: the digests of all others stay as they were before it
-- existed.
-- name: has_clutter
SELECT clutter_window_m IS NOT NULL FROM signature WHERE signature_id = ?1;

-- name: digest_clutter
SELECT s.clutter_window_m, s.clutter_pixel_m, s.clutter_mean_w_m2_sr, s.clutter_mean_stderr_w_m2_sr,
       s.clutter_sigma_w_m2_sr, s.clutter_sigma_stderr_w_m2_sr, s.clutter_skewness, s.clutter_skewness_stderr,
       s.clutter_correlation_m, s.clutter_correlation_stderr_m, s.clutter_cells, s.clutter_patch_m,
       s.clutter_patch_sigma_w_m2_sr, s.clutter_patch_sigma_stderr_w_m2_sr, s.clutter_modes_fraction,
       s.visible_fraction, c.patch_sigma_w_m2_sr_um, c.modes
FROM signature s JOIN clutter c USING (signature_id) WHERE s.signature_id = ?1;

-- name: digest_clutter_materials
SELECT material_index, fraction FROM clutter_material WHERE signature_id = ?1 ORDER BY material_index;

-- Only signatures with uncertain inputs are hashed here: the digests of all others stay as they were before they
-- existed.
-- name: has_input_contributions
SELECT EXISTS (SELECT 1 FROM input_contribution WHERE signature_id = ?1);

-- name: digest_input_contributions
SELECT input, contribution_w_sr, contribution_stderr_w_sr, apparent_contribution_w_sr,
       apparent_contribution_stderr_w_sr, contrast_contribution_w_sr, contrast_contribution_stderr_w_sr,
       curvature_w_sr, apparent_curvature_w_sr, contrast_curvature_w_sr
FROM input_contribution WHERE signature_id = ?1 ORDER BY input_index;

-- name: digest_thumbnail
SELECT width_px, height_px, pixel_rad, error_relative, error_k, png, exr, stderr_exr FROM thumbnail WHERE signature_id = ?1;

-- name: digest_image_layers
SELECT name, exr, stderr_exr FROM image_layer WHERE signature_id = ?1 ORDER BY name;

-- name: digest_silhouette
SELECT t.width_px, t.height_px, t.pixel_samples
FROM signature s JOIN silhouette t USING (job_id) WHERE s.signature_id = ?1;

-- name: digest_part_pixels
SELECT p.name, x.left_px, x.top_px, x.width_px, x.height_px, x.samples
FROM signature s JOIN part_pixels x USING (job_id) JOIN part p USING (part_id)
WHERE s.signature_id = ?1 ORDER BY p.part_index, p.name;

-- Only rows whose images have whole parts are hashed here: the digests of all others stay as they were before they
-- existed.
-- name: has_part_sets
SELECT EXISTS (SELECT 1 FROM signature s JOIN part_set x USING (job_id) WHERE s.signature_id = ?1);

-- name: digest_part_sets
SELECT x.parts, x.outside_px, x.samples
FROM signature s JOIN part_set x USING (job_id) WHERE s.signature_id = ?1 ORDER BY x.parts;

-- name: digest_profile
SELECT profile_index, point_index, reflections, name, x_m, y_m, z_m, footprint_width_m, footprint_height_m,
       radiance_w_m2_sr, radiance_stderr_w_m2_sr, apparent_radiance_w_m2_sr, apparent_radiance_stderr_w_m2_sr,
       truncation_bound_w_m2_sr, quadrature_bound_w_m2_sr, source_radiance_temperature_k, source_radiance_temperature_stderr_k,
       target_fraction, samples
FROM profile WHERE signature_id = ?1 ORDER BY profile_index, point_index, reflections;

-- name: digest_published
SELECT published_index, profile, point_index, reflections, source_radiance_temperature_k, relation, source, remark
FROM published WHERE sweep_id = ?1 ORDER BY published_index;
