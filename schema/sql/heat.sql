-- Jobs that compute temperatures (schema/store/ingest_heat.cpp, schema/store/sweep_table.cpp, schema/store/reader.cpp).

-- name: insert_heat_job
INSERT INTO job (sweep_id, job_key, job_index, kind, state) VALUES (?1, ?2, ?3, 2, 0) RETURNING job_id;

-- name: insert_heat_run
INSERT INTO heat_job (job_id, heat_index, season) VALUES (?1, ?2, ?3);

-- name: place_heat_run
UPDATE heat_job SET heat_index = ?2 WHERE job_id = ?1;

-- name: count_computed_temperatures
SELECT count(*) FROM computed_temperature WHERE job_id = ?1;

-- Temperatures of an earlier version of the sweep stay until those that replace them are stored; where nothing will,
-- they go now, as do those of a time that the sweep no longer has.

-- name: delete_temperatures_of_gone_runs
DELETE FROM computed_temperature WHERE job_id IN (
  SELECT old.job_id FROM job old JOIN heat_job h USING (job_id)
  WHERE old.sweep_id = ?1 AND old.superseded = 1 AND NOT EXISTS (
    SELECT 1 FROM job new JOIN heat_job g USING (job_id)
    WHERE new.sweep_id = ?1 AND new.superseded = 0 AND new.state <> 2 AND g.season = h.season));

-- name: delete_temperatures_of_gone_times
DELETE FROM computed_temperature AS t
WHERE EXISTS (SELECT 1 FROM job old WHERE old.job_id = t.job_id AND old.sweep_id = ?1 AND old.superseded = 1)
  AND NOT EXISTS (
    SELECT 1 FROM condition c
    WHERE c.sweep_id = ?1 AND c.superseded = 0 AND c.heat_index IS NOT NULL AND c.time_utc = t.time_utc);

-- name: delete_superseded_heat_jobs_of_season
DELETE FROM job
WHERE sweep_id = ?1 AND superseded = 1 AND job_id IN (SELECT job_id FROM heat_job WHERE season = ?2);

-- Deletes superseded jobs of changed inputs only, which have no temperatures of their own. Other superseded jobs stay
-- until their successors are stored.
-- name: delete_superseded_changes_of_season
DELETE FROM job
WHERE sweep_id = ?1 AND superseded = 1 AND job_id IN (SELECT job_id FROM heat_job WHERE season = ?2)
  AND NOT EXISTS (SELECT 1 FROM computed_temperature t WHERE t.job_id = job.job_id);

-- Storing a result.

-- name: resolved_sweep_by_id
SELECT resolved_sweep FROM sweep WHERE sweep_id = ?1;

-- name: set_heat_output
UPDATE heat_job SET output_sha256 = ?2, warning = ?3 WHERE job_id = ?1;

-- name: delete_computed_temperatures
DELETE FROM computed_temperature WHERE job_id = ?1;

-- name: insert_computed_temperature
INSERT INTO computed_temperature (job_id, time_index, time_utc, part_id, mean_k, coldest_k, hottest_k, error_k)
VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8);

-- A done job of another sweep with the same key (?2), computed in the same determinism class (?3), of which all ?4
-- temperatures are still there.
-- name: done_twin
SELECT twin.job_id, h.output_sha256 FROM job twin JOIN heat_job h USING (job_id) JOIN provenance p USING (job_id)
WHERE twin.job_id <> ?1 AND twin.job_key = ?2 AND p.determinism_class = ?3 AND twin.state = 2
  AND h.output_sha256 IS NOT NULL AND (SELECT count(*) FROM computed_temperature t WHERE t.job_id = twin.job_id) = ?4
ORDER BY twin.job_id LIMIT 1;

-- Copies the output of job ?2 to job ?1 of sweep ?3, for which no time is counted.
-- name: copy_heat_output
UPDATE heat_job SET output_sha256 = twin.output_sha256, warning = twin.warning
FROM heat_job twin WHERE heat_job.job_id = ?1 AND twin.job_id = ?2;

-- name: copy_computed_temperatures
INSERT INTO computed_temperature (job_id, time_index, time_utc, part_id, mean_k, coldest_k, hottest_k, error_k)
SELECT ?1, t.time_index, t.time_utc, own.part_id, t.mean_k, t.coldest_k, t.hottest_k, t.error_k
FROM computed_temperature t
JOIN part p USING (part_id)
JOIN part own ON own.sweep_id = ?3 AND own.superseded = 0 AND own.name = p.name
WHERE t.job_id = ?2;

-- name: copy_provenance
INSERT OR REPLACE INTO provenance (
  job_id, seed_hex, physics_version, determinism_class, build_id, worker_name, samples, replicates, target_paths,
  rays, seconds, guarded_backface_hits, guarded_nonfinite, truncated_paths, worst_relative_error,
  guarded_negative, content_sha256)
SELECT ?1, seed_hex, physics_version, determinism_class, build_id, worker_name, samples, replicates, target_paths,
       0, 0.0, guarded_backface_hits, guarded_nonfinite, truncated_paths, worst_relative_error, guarded_negative,
       content_sha256
FROM provenance WHERE job_id = ?2;

-- Reading.

-- Outputs of the done heat jobs of a sweep, in the order of its heat runs.
-- name: heat_outputs_of_sweep
SELECT h.output_sha256
FROM sweep w
JOIN job j ON j.sweep_id = w.sweep_id AND j.superseded = 0 AND j.state = 2
JOIN heat_job h USING (job_id)
WHERE w.name = ?1 AND h.output_sha256 IS NOT NULL
ORDER BY h.heat_index;

-- ?1 sweep, ?2 seasons (an array in JSON), ?3 time_utc ('': any).
-- name: find_computed_temperatures
SELECT sweep, season, time_utc, part, mean_k, coldest_k, hottest_k, error_k, superseded, job_key
FROM computed_temperature_view
WHERE (?1 = '' OR sweep = ?1) AND (?2 = '' OR season IN (SELECT value FROM json_each(?2))) AND (?3 = '' OR time_utc = ?3)
ORDER BY sweep, superseded, condition_index, heat_index, time_index, part_index, part;

-- name: heat_jobs_of_sweep
SELECT h.season, j.state = 2, coalesce(p.seconds, 0.0), h.warning
FROM sweep w
JOIN job j ON j.sweep_id = w.sweep_id AND j.superseded = 0
JOIN heat_job h USING (job_id)
LEFT JOIN provenance p USING (job_id)
WHERE w.name = ?1
ORDER BY h.heat_index;
