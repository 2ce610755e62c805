-- Submitting a sweep, for the first time or again (schema/store/sweep_table.cpp).

-- name: sweep_id_by_name
SELECT sweep_id FROM sweep WHERE name = ?1;

-- name: sweep_name_by_sha256
SELECT name FROM sweep WHERE sweep_sha256 = ?1;

-- name: resolved_sweep_by_sha256
SELECT resolved_sweep FROM sweep WHERE sweep_sha256 = ?1;

-- name: insert_sweep
INSERT INTO sweep (name, sweep_sha256, viewpoints, conditions, bands, model_sha256, thumbnail_px, resolved_sweep,
                   longitude_deg)
VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9);

-- name: update_sweep
UPDATE sweep
SET sweep_sha256 = ?2, viewpoints = ?3, conditions = ?4, bands = ?5, model_sha256 = ?6, thumbnail_px = ?7,
    resolved_sweep = ?8, longitude_deg = ?9
WHERE sweep_id = ?1;

-- name: set_profile_rows
UPDATE sweep SET profile_rows = ?2 WHERE sweep_id = ?1;

-- name: set_uncertain_inputs
UPDATE sweep SET uncertain_inputs = ?2 WHERE sweep_id = ?1;

-- name: set_image_layers
UPDATE sweep SET image_layers = ?2 WHERE sweep_id = ?1;

-- name: clear_published
DELETE FROM published WHERE sweep_id = ?1;

-- name: insert_published
INSERT INTO published (sweep_id, published_index, profile, point_index, reflections, source_radiance_temperature_k, relation,
  source, remark)
VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9);

-- A sweep is bound to a determinism class by its first stored result; without results there is nothing to match.
-- name: unbind_sweep_without_results
UPDATE sweep SET determinism_class = NULL
WHERE sweep_id = ?1
  AND NOT EXISTS (SELECT 1 FROM job WHERE job.sweep_id = ?1 AND superseded = 0 AND state IN (1, 2));

-- name: clear_sweep_assets
DELETE FROM sweep_asset WHERE sweep_id = ?1;

-- name: insert_sweep_asset
INSERT INTO sweep_asset (sweep_id, sha256) VALUES (?1, ?2) ON CONFLICT DO NOTHING;

-- name: delete_unused_assets
DELETE FROM asset
WHERE sha256 NOT IN (SELECT sha256 FROM sweep_asset)
  AND sha256 NOT IN (SELECT output_sha256 FROM heat_job WHERE output_sha256 IS NOT NULL);

-- Parts, conditions, bands: everything is superseded first; what the new version defines alike comes back.

-- name: supersede_parts
UPDATE part SET superseded = 1 WHERE sweep_id = ?1;

-- name: revive_part
UPDATE part SET superseded = 0, part_index = ?4
WHERE sweep_id = ?1 AND name = ?2 AND material = ?3
RETURNING part_id;

-- name: insert_part
INSERT INTO part (sweep_id, name, material, part_index) VALUES (?1, ?2, ?3, ?4) RETURNING part_id;

-- name: supersede_conditions
UPDATE condition SET superseded = 1 WHERE sweep_id = ?1;

-- name: revive_condition
UPDATE condition SET superseded = 0, condition_index = ?3, warning = ?4, heat_index = ?5, heat_time_index = ?6
WHERE sweep_id = ?1 AND definition_sha256 = ?2
RETURNING condition_id;

-- name: insert_condition
INSERT INTO condition (sweep_id, definition_sha256, condition_index, season, time_utc, sun_irradiance_w_m2,
                       air_temperature_k, surroundings, sky_temperature_k, sky_radiance_w_m2_sr_um,
                       sea_temperature_k, sea_emissivity, lower_radiance_w_m2_sr_um, sea_model,
                       ground_temperature_k, ground_emissivity, weather, warning, temperature_field,
                       heat_index, heat_time_index)
VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18, ?19, ?20, ?21)
RETURNING condition_id;

-- name: insert_part_temperature
INSERT INTO part_temperature (condition_id, part_id, temperature_k) VALUES (?1, ?2, ?3);

-- name: supersede_bands
UPDATE band SET superseded = 1 WHERE sweep_id = ?1;

-- name: revive_band
UPDATE band SET superseded = 0, band_index = ?3
WHERE sweep_id = ?1 AND definition_sha256 = ?2
RETURNING band_id;

-- name: insert_band
INSERT INTO band (sweep_id, definition_sha256, band_index, name, lambda_min_um, lambda_max_um)
VALUES (?1, ?2, ?3, ?4, ?5, ?6)
RETURNING band_id;

-- name: insert_band_response
INSERT INTO band_response (band_id, lambda_um, response) VALUES (?1, ?2, ?3);

-- Viewpoints move out of the way of the new indices, then come back one by one; who stays behind is gone.

-- name: shift_viewpoints
UPDATE viewpoint SET viewpoint_index = viewpoint_index + 1099511627776 WHERE sweep_id = ?1;

-- name: revive_viewpoint
UPDATE viewpoint SET viewpoint_index = ?5
WHERE sweep_id = ?1 AND aspect_azimuth_deg = ?2 AND aspect_elevation_deg = ?3 AND range_m = ?4
RETURNING viewpoint_id;

-- name: insert_viewpoint
INSERT INTO viewpoint (sweep_id, aspect_azimuth_deg, aspect_elevation_deg, range_m, viewpoint_index)
VALUES (?1, ?2, ?3, ?4, ?5)
RETURNING viewpoint_id;

-- name: delete_signatures_of_gone_viewpoints
DELETE FROM signature WHERE viewpoint_id IN
  (SELECT viewpoint_id FROM viewpoint WHERE sweep_id = ?1 AND viewpoint_index >= 1099511627776);

-- A changed list has brought them to another place.
-- name: delete_signatures_of_other_shards
DELETE FROM signature WHERE viewpoint_id IN
  (SELECT viewpoint_id FROM viewpoint WHERE sweep_id = ?1 AND viewpoint_index % ?3 <> ?2);

-- name: delete_jobs_of_gone_viewpoints
DELETE FROM job WHERE viewpoint_id IN
  (SELECT viewpoint_id FROM viewpoint WHERE sweep_id = ?1 AND viewpoint_index >= 1099511627776);

-- name: delete_directions_of_gone_viewpoints
DELETE FROM viewpoint_direction WHERE viewpoint_id IN
  (SELECT viewpoint_id FROM viewpoint WHERE sweep_id = ?1 AND viewpoint_index >= 1099511627776);

-- name: delete_gone_viewpoints
DELETE FROM viewpoint WHERE sweep_id = ?1 AND viewpoint_index >= 1099511627776;

-- Signatures of a season, time or band that the sweep no longer has, by name, have no place left and go now.

-- name: delete_signatures_of_gone_conditions
DELETE FROM signature WHERE condition_id IN (
  SELECT old.condition_id FROM condition old
  WHERE old.sweep_id = ?1 AND old.superseded = 1 AND NOT EXISTS (
    SELECT 1 FROM condition new WHERE new.sweep_id = ?1 AND new.superseded = 0
      AND new.season = old.season AND new.time_utc = old.time_utc));

-- name: delete_signatures_of_gone_bands
DELETE FROM signature WHERE band_id IN (
  SELECT old.band_id FROM band old
  WHERE old.sweep_id = ?1 AND old.superseded = 1 AND NOT EXISTS (
    SELECT 1 FROM band new WHERE new.sweep_id = ?1 AND new.superseded = 0 AND new.name = old.name));

-- The others keep their place in the sweep: that of the new definition of the same name.

-- name: place_superseded_conditions
UPDATE condition SET condition_index = new.condition_index
FROM condition new
WHERE condition.sweep_id = ?1 AND condition.superseded = 1 AND new.sweep_id = ?1 AND new.superseded = 0
  AND new.season = condition.season AND new.time_utc = condition.time_utc;

-- name: place_superseded_bands
UPDATE band SET band_index = new.band_index
FROM band new
WHERE band.sweep_id = ?1 AND band.superseded = 1 AND new.sweep_id = ?1 AND new.superseded = 0
  AND new.name = band.name;

-- Jobs

-- name: supersede_jobs
UPDATE job SET superseded = 1 WHERE sweep_id = ?1;

-- name: job_by_key
SELECT job_id, state, kind, viewpoint_id, condition_index, band_index FROM job WHERE sweep_id = ?1 AND job_key = ?2;

-- Signatures of the job that were computed with the definitions that hold now.
-- name: count_current_signatures
SELECT count(*)
FROM signature
JOIN condition USING (condition_id)
JOIN band USING (band_id)
WHERE job_id = ?1 AND condition.superseded = 0 AND band.superseded = 0;

-- name: insert_view_job
INSERT INTO job (sweep_id, job_key, job_index, viewpoint_id, condition_index, band_index, kind, state)
VALUES (?1, ?2, ?3, ?4, ?5, ?6, 1, 0);

-- name: clear_needs
DELETE FROM job_need WHERE job_id IN (SELECT job_id FROM job WHERE sweep_id = ?1);

-- name: insert_need
INSERT INTO job_need (job_id, needs_job_id)
SELECT j.job_id, needed.job_id FROM job j JOIN job needed USING (sweep_id)
WHERE j.sweep_id = ?1 AND j.job_key = ?2 AND needed.job_key = ?3;

-- name: count_needs
UPDATE job
SET unmet_needs = (SELECT count(*) FROM job_need n JOIN job needed ON needed.job_id = n.needs_job_id
                   WHERE n.job_id = job.job_id AND needed.state <> 2)
WHERE sweep_id = ?1;

-- name: revive_job
UPDATE job
SET superseded = 0, job_index = ?2, state = ?3,
    failures_after_token = iif(?3 = state, failures_after_token,
                               (SELECT coalesce(max(fencing_token), 0) FROM attempt WHERE attempt.job_id = ?1)),
    failures = iif(?3 = state, failures, 0)
WHERE job_id = ?1;

-- name: revive_view_job
UPDATE job
SET superseded = 0, job_index = ?2, viewpoint_id = ?3, condition_index = ?4, band_index = ?5, state = ?6,
    failures_after_token = iif(?6 = state, failures_after_token,
                               (SELECT coalesce(max(fencing_token), 0) FROM attempt WHERE attempt.job_id = ?1)),
    failures = iif(?6 = state, failures, 0)
WHERE job_id = ?1;

-- A job that the sweep no longer has ends here; only a done one whose signatures or temperatures wait for their
-- replacement stays.

-- name: revoke_superseded_leases
UPDATE attempt SET outcome = 4, message = 'the sweep no longer has this job'
WHERE outcome = 0 AND job_id IN (SELECT job_id FROM job WHERE sweep_id = ?1 AND superseded = 1);

-- name: settle_superseded_jobs
UPDATE job SET state = 2 WHERE sweep_id = ?1 AND superseded = 1;

-- name: delete_superseded_jobs
DELETE FROM job
WHERE sweep_id = ?1 AND superseded = 1
  AND NOT EXISTS (SELECT 1 FROM signature WHERE signature.job_id = job.job_id)
  AND NOT EXISTS (SELECT 1 FROM computed_temperature t WHERE t.job_id = job.job_id);

-- name: delete_superseded_jobs_of_viewpoint
DELETE FROM job
WHERE viewpoint_id = ?1 AND superseded = 1
  AND NOT EXISTS (SELECT 1 FROM signature WHERE signature.job_id = job.job_id);

-- name: delete_superseded_conditions
DELETE FROM condition
WHERE sweep_id = ?1 AND superseded = 1
  AND NOT EXISTS (SELECT 1 FROM signature WHERE signature.condition_id = condition.condition_id);

-- name: delete_superseded_bands
DELETE FROM band
WHERE sweep_id = ?1 AND superseded = 1
  AND NOT EXISTS (SELECT 1 FROM signature WHERE signature.band_id = band.band_id);

-- name: delete_superseded_parts
DELETE FROM part
WHERE sweep_id = ?1 AND superseded = 1
  AND NOT EXISTS (SELECT 1 FROM part_temperature t WHERE t.part_id = part.part_id)
  AND NOT EXISTS (SELECT 1 FROM computed_temperature t WHERE t.part_id = part.part_id)
  AND NOT EXISTS (
    SELECT 1 FROM signature s JOIN viewpoint v USING (viewpoint_id) JOIN part_intensity i USING (signature_id)
    WHERE v.sweep_id = ?1 AND i.part_id = part.part_id);

-- name: has_superseded_jobs
SELECT EXISTS (SELECT 1 FROM job WHERE sweep_id = ?1 AND superseded = 1);

-- name: count_jobs_to_compute
SELECT count(*) FROM job WHERE sweep_id = ?1 AND superseded = 0 AND state IN (0, 1);

-- Number of sweeps and predictions; 0: the database was created and never used.
-- name: content_count
SELECT (SELECT count(*) FROM sweep) + (SELECT count(*) FROM prediction);
