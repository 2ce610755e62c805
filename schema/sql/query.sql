-- Reading (schema/store/find_signatures.cpp, schema/store/reader.cpp).

-- Which signatures: their ids. Conditions and bands are few: they are filtered by name and then drive the index of
-- signature (condition_id, band_id, viewpoint_id); CROSS JOIN keeps that order. ?1 sweep, ?2 seasons (an array
-- in JSON), ?3 time_utc, ?4 band ('': any), ?5 greatest relative error (NULL: any) of quantity ?7 (SignatureQuantity), ?6 row (NULL: any),
-- ?8 range (to 1e-9 of it; NULL: any).
-- name: find_signatures
SELECT s.signature_id
FROM sweep w
CROSS JOIN condition c ON c.sweep_id = w.sweep_id
CROSS JOIN band b ON b.sweep_id = w.sweep_id
CROSS JOIN signature s ON s.condition_id = c.condition_id AND s.band_id = b.band_id
CROSS JOIN viewpoint v ON v.viewpoint_id = s.viewpoint_id
WHERE (?1 = '' OR w.name = ?1) AND (?2 = '' OR c.season IN (SELECT value FROM json_each(?2))) AND (?3 = '' OR c.time_utc = ?3)
  AND (?4 = '' OR b.name = ?4)
  AND (?5 IS NULL OR CASE ?7
       WHEN 0 THEN s.numerical_error_w_sr <= ?5 * abs(s.intensity_w_sr)
       WHEN 1 THEN s.apparent_numerical_error_w_sr <= ?5 * abs(s.apparent_intensity_w_sr)
       WHEN 2 THEN s.contrast_numerical_error_w_sr <= ?5 * abs(s.contrast_intensity_w_sr)
       WHEN 3 THEN s.background_radiance_stderr_w_m2_sr <= ?5 * abs(s.background_radiance_w_m2_sr) END)
  AND (?6 IS NULL OR (v.viewpoint_index * w.conditions + c.condition_index) * w.bands + b.band_index + 1 = ?6)
  AND (?8 IS NULL OR abs(v.range_m - ?8) <= 1e-9 * ?8)
ORDER BY w.name, v.viewpoint_index, c.condition_index, b.band_index;

-- As find_signatures, for one viewpoint ?9.
-- name: find_signatures_of_viewpoint
SELECT s.signature_id
FROM viewpoint v
CROSS JOIN sweep w ON w.sweep_id = v.sweep_id
CROSS JOIN condition c ON c.sweep_id = w.sweep_id
CROSS JOIN band b ON b.sweep_id = w.sweep_id
CROSS JOIN signature s
  ON s.condition_id = c.condition_id AND s.band_id = b.band_id AND s.viewpoint_id = v.viewpoint_id
WHERE v.viewpoint_id = ?9
  AND (?1 = '' OR w.name = ?1) AND (?2 = '' OR c.season IN (SELECT value FROM json_each(?2))) AND (?3 = '' OR c.time_utc = ?3)
  AND (?4 = '' OR b.name = ?4)
  AND (?5 IS NULL OR CASE ?7
       WHEN 0 THEN s.numerical_error_w_sr <= ?5 * abs(s.intensity_w_sr)
       WHEN 1 THEN s.apparent_numerical_error_w_sr <= ?5 * abs(s.apparent_intensity_w_sr)
       WHEN 2 THEN s.contrast_numerical_error_w_sr <= ?5 * abs(s.contrast_intensity_w_sr)
       WHEN 3 THEN s.background_radiance_stderr_w_m2_sr <= ?5 * abs(s.background_radiance_w_m2_sr) END)
  AND (?6 IS NULL OR (v.viewpoint_index * w.conditions + c.condition_index) * w.bands + b.band_index + 1 = ?6)
  AND (?8 IS NULL OR abs(v.range_m - ?8) <= 1e-9 * ?8)
ORDER BY c.condition_index, b.band_index;

-- name: signature_by_id
SELECT * FROM signature_view WHERE signature_id = ?1;

-- One quantity (?6: SignatureQuantity) of one condition and band from one range (?5, to 1e-9 of it): the columns that a
-- picture of all aspects needs, and no others, since they are asked for with every step of a slider.
-- name: values_of_signatures
SELECT (v.viewpoint_index * w.conditions + c.condition_index) * w.bands + b.band_index + 1 AS row,
       v.aspect_azimuth_deg, v.aspect_elevation_deg,
       CASE ?6 WHEN 0 THEN s.intensity_w_sr WHEN 1 THEN s.apparent_intensity_w_sr
               WHEN 2 THEN s.contrast_intensity_w_sr ELSE s.background_radiance_w_m2_sr END,
       CASE ?6 WHEN 0 THEN s.intensity_stderr_w_sr WHEN 1 THEN s.apparent_intensity_stderr_w_sr
               WHEN 2 THEN s.contrast_intensity_stderr_w_sr ELSE s.background_radiance_stderr_w_m2_sr END,
       CASE ?6 WHEN 0 THEN s.numerical_error_w_sr WHEN 1 THEN s.apparent_numerical_error_w_sr
               WHEN 2 THEN s.contrast_numerical_error_w_sr ELSE s.background_radiance_stderr_w_m2_sr END
FROM sweep w
CROSS JOIN condition c ON c.sweep_id = w.sweep_id
CROSS JOIN band b ON b.sweep_id = w.sweep_id
CROSS JOIN signature s ON s.condition_id = c.condition_id AND s.band_id = b.band_id
CROSS JOIN viewpoint v ON v.viewpoint_id = s.viewpoint_id
WHERE w.name = ?1 AND c.season = ?2 AND c.time_utc = ?3 AND b.name = ?4 AND abs(v.range_m - ?5) <= 1e-9 * ?5
ORDER BY row, s.signature_id DESC;

-- Contents that a user can choose from (StoreReader::contents).
-- name: contents_of_sweeps
SELECT w.sweep_id, w.name, w.viewpoints, w.viewpoints * w.conditions * w.bands,
       (SELECT count(*) FROM condition c CROSS JOIN signature s ON s.condition_id = c.condition_id
        WHERE c.sweep_id = w.sweep_id),
       coalesce(w.thumbnail_px, 1) > 0,  -- not stated: there may be some
       EXISTS (SELECT 1 FROM clutter WHERE signature_id =
         (SELECT s.signature_id FROM condition c CROSS JOIN signature s ON s.condition_id = c.condition_id
          WHERE c.sweep_id = w.sweep_id LIMIT 1))
FROM sweep w ORDER BY w.sweep_id;

-- name: conditions_of_sweep
SELECT season, time_utc FROM condition WHERE sweep_id = ?1 GROUP BY season, time_utc ORDER BY min(condition_index);

-- name: bands_of_sweep
SELECT name, lambda_min_um, lambda_max_um FROM band b WHERE sweep_id = ?1
  AND NOT EXISTS (SELECT 1 FROM band n WHERE n.sweep_id = b.sweep_id AND n.name = b.name AND n.band_id > b.band_id)
ORDER BY band_index;

-- name: ranges_of_sweep
SELECT DISTINCT range_m FROM viewpoint WHERE sweep_id = ?1 ORDER BY range_m;

-- Step one of a nearest query: the viewpoints whose box meets a box around the direction.
-- name: viewpoints_in_box
SELECT d.viewpoint_id, v.viewpoint_index, w.name, d.unit_x, d.unit_y, d.unit_z
FROM viewpoint_direction d
CROSS JOIN viewpoint v USING (viewpoint_id)
CROSS JOIN sweep w USING (sweep_id)
WHERE d.max_x >= ?1 AND d.min_x <= ?2 AND d.max_y >= ?3 AND d.min_y <= ?4 AND d.max_z >= ?5 AND d.min_z <= ?6
  AND (?7 = '' OR w.name = ?7);

-- At least as many viewpoints as there are: enough to choose the first box, and without counting them.
-- name: viewpoints_at_most
SELECT max(viewpoint_id) FROM viewpoint;

-- The viewpoints that hold row ?2, one in each sweep that has so many.
-- name: viewpoints_at_row
SELECT v.viewpoint_id
FROM sweep w
CROSS JOIN viewpoint v ON v.sweep_id = w.sweep_id AND v.viewpoint_index = (?2 - 1) / (w.conditions * w.bands)
WHERE (?1 = '' OR w.name = ?1) AND ?2 >= 1
ORDER BY w.name;

-- name: spectrum_of_signature
SELECT b.lambda_um, spectral_intensity_w_sr_um, spectral_intensity_stderr_w_sr_um, emitted_w_sr_um,
       emitted_stderr_w_sr_um, sun_reflected_w_sr_um, sun_reflected_stderr_w_sr_um, sky_reflected_w_sr_um,
       sky_reflected_stderr_w_sr_um, surface_reflected_w_sr_um, surface_reflected_stderr_w_sr_um, interreflected_w_sr_um,
       interreflected_stderr_w_sr_um, apparent_spectral_intensity_w_sr_um, apparent_spectral_intensity_stderr_w_sr_um,
       contrast_spectral_intensity_w_sr_um, contrast_spectral_intensity_stderr_w_sr_um,
       background_radiance_w_m2_sr_um, background_radiance_stderr_w_m2_sr_um, spectrum.path_transmittance,
       path_radiance_w_m2_sr_um, plume_w_sr_um, plume_stderr_w_sr_um, apparent_plume_w_sr_um,
       apparent_plume_stderr_w_sr_um, contrast_plume_w_sr_um, contrast_plume_stderr_w_sr_um,
       spectral_intensity_modes, apparent_spectral_intensity_modes, contrast_spectral_intensity_modes
FROM spectrum
JOIN signature USING (signature_id)
JOIN band b USING (band_id)
LEFT JOIN spectral_modes USING (signature_id)
WHERE signature_id = ?1;

-- name: sweep_by_name
SELECT resolved_sweep FROM sweep WHERE name = ?1;

-- name: clutter_of_signature
SELECT b.lambda_um, c.patch_sigma_w_m2_sr_um, c.modes
FROM clutter c JOIN signature USING (signature_id) JOIN band b USING (band_id) WHERE signature_id = ?1;

-- name: clutter_materials_of_signature
SELECT material_index, fraction FROM clutter_material WHERE signature_id = ?1 ORDER BY material_index;

-- name: parts_of_signature
SELECT p.name, i.intensity_w_sr, i.intensity_stderr_w_sr
FROM part_intensity i
JOIN part p USING (part_id)
WHERE i.signature_id = ?1
ORDER BY p.part_index;

-- name: ledger_of_signature
SELECT e.name, s.name, r.name, l.bound_w_sr, l.apparent_bound_w_sr, l.contrast_bound_w_sr, l.fraction_w_sr, l.time_s
FROM ledger l JOIN effect e USING (effect) JOIN effect_state s USING (state) JOIN effect_reason r USING (reason)
WHERE l.signature_id = ?1
ORDER BY l.effect;

-- name: inputs_of_signature
SELECT input, contribution_w_sr, contribution_stderr_w_sr, apparent_contribution_w_sr,
       apparent_contribution_stderr_w_sr, contrast_contribution_w_sr, contrast_contribution_stderr_w_sr,
       curvature_w_sr, apparent_curvature_w_sr, contrast_curvature_w_sr
FROM input_contribution WHERE signature_id = ?1 ORDER BY input_index;

-- name: energy_of_signature
SELECT absorbed, absorbed_stderr, escaped_to_sky, escaped_to_sky_stderr, escaped_to_surface, escaped_to_surface_stderr,
       cut_off, cut_off_stderr, balance, balance_stderr
FROM energy WHERE signature_id = ?1;

-- name: thumbnail_of_signature
SELECT width_px, height_px, pixel_rad, error_relative, error_k, png, exr, stderr_exr FROM thumbnail WHERE signature_id = ?1;

-- name: image_layers_of_signature
SELECT name, exr, stderr_exr FROM image_layer WHERE signature_id = ?1 ORDER BY name;

-- name: image_layer_of_signature
SELECT exr, stderr_exr FROM image_layer WHERE signature_id = ?1 AND name = ?2;

-- name: silhouette_of_signature
SELECT t.job_id, t.width_px, t.height_px, t.pixel_samples
FROM signature s JOIN silhouette t USING (job_id) WHERE s.signature_id = ?1;

-- name: part_pixels_of_job
SELECT p.name, x.left_px, x.top_px, x.width_px, x.height_px, x.samples
FROM part_pixels x JOIN part p USING (part_id) WHERE x.job_id = ?1 ORDER BY p.part_index, p.name;

-- name: part_sets_of_job
SELECT parts, outside_px, samples FROM part_set WHERE job_id = ?1 ORDER BY parts;

-- name: signature_exists
SELECT count(*) FROM signature WHERE signature_id = ?1;

-- ?1 sweep, ?2 seasons (an array in JSON), ?3 band, ?4 profile ('': any).
-- name: find_profile_rows
SELECT f.* FROM profile_view f
WHERE (?1 = '' OR f.sweep = ?1) AND (?2 = '' OR f.season IN (SELECT value FROM json_each(?2))) AND (?3 = '' OR f.band = ?3)
  AND (?4 = '' OR f.profile = ?4)
ORDER BY f.sweep, f.row, f.profile_index, f.point_index, f.reflections;

-- name: find_published
SELECT w.name, p.profile, p.point_index, p.reflections, p.source_radiance_temperature_k, p.relation, p.source, p.remark
FROM published p JOIN sweep w USING (sweep_id)
WHERE ?1 = '' OR w.name = ?1
ORDER BY w.name, p.published_index;
