-- The queue (schema/store/queue.cpp). States and outcomes: tables job_state and attempt_outcome.

-- The next job comes from the first sweep, by priority, that has a waiting job.
-- name: next_waiting_job
SELECT job_id FROM job
WHERE state = 0 AND unmet_needs = 0 AND sweep_id = (
  SELECT w.sweep_id FROM sweep w
  WHERE EXISTS (SELECT 1 FROM job j WHERE j.sweep_id = w.sweep_id AND j.state = 0 AND j.unmet_needs = 0)
  ORDER BY w.priority DESC, w.sweep_id LIMIT 1)
ORDER BY failures, job_index LIMIT 1;

-- name: set_physics_version
UPDATE sweep SET physics_version = ?2 WHERE sweep_sha256 = ?1;

-- name: physics_version
SELECT coalesce(physics_version, 0) FROM sweep WHERE sweep_sha256 = ?1;

-- name: set_priority
UPDATE sweep SET priority = ?2 WHERE sweep_sha256 = ?1;

-- name: insert_attempt
INSERT INTO attempt (job_id, worker_id, leased_unix_s) VALUES (?1, ?2, ?3) RETURNING fencing_token;

-- name: set_job_state
UPDATE job SET state = ?2 WHERE job_id = ?1;

-- name: queued_job
SELECT w.sweep_sha256, j.job_key, j.kind, h.heat_index, v.viewpoint_index, j.condition_index, j.band_index, j.state,
       (SELECT count(DISTINCT a.worker_name) FROM attempt a
        WHERE a.job_id = j.job_id AND a.outcome = 3 AND a.fencing_token > j.failures_after_token)
FROM job j
JOIN sweep w USING (sweep_id)
LEFT JOIN viewpoint v USING (viewpoint_id)
LEFT JOIN heat_job h USING (job_id)
WHERE j.job_id = ?1;

-- name: needs_of_job
SELECT j.job_key, coalesce(h.output_sha256, '')
FROM job_need n
JOIN job j ON j.job_id = n.needs_job_id
LEFT JOIN heat_job h ON h.job_id = j.job_id
WHERE n.job_id = ?1
ORDER BY j.job_index;

-- name: leased_job
SELECT j.job_id, j.sweep_id, j.job_key, j.kind, h.heat_index, j.viewpoint_id, j.condition_index, j.band_index
FROM attempt a
JOIN job j USING (job_id)
LEFT JOIN heat_job h USING (job_id)
WHERE a.fencing_token = ?1 AND a.outcome = 0;

-- name: end_attempt
UPDATE attempt SET outcome = ?2, message = ?3, worker_name = ?4 WHERE fencing_token = ?1;

-- name: running_tokens
SELECT fencing_token FROM attempt WHERE outcome = 0;

-- name: release_all_jobs
UPDATE job SET state = 0 WHERE state = 1;

-- name: release_all_attempts
UPDATE attempt SET outcome = 2, message = 'the coordinator ended' WHERE outcome = 0;

-- After a job was done.
-- name: recount_needs_of_dependents
UPDATE job
SET unmet_needs = (SELECT count(*) FROM job_need n JOIN job needed ON needed.job_id = n.needs_job_id
                   WHERE n.job_id = job.job_id AND needed.state <> 2)
WHERE job_id IN (SELECT job_id FROM job_need WHERE needs_job_id = ?1);

-- Quarantines the waiting jobs that need a failed job ?1, directly or through other jobs: they cannot be computed
-- either.
-- name: quarantine_dependents
UPDATE job SET state = 3
WHERE state = 0 AND job_id IN (
  WITH RECURSIVE dependent (job_id) AS (
    SELECT job_id FROM job_need WHERE needs_job_id = ?1
    UNION SELECT n.job_id FROM job_need n JOIN dependent d ON n.needs_job_id = d.job_id)
  SELECT job_id FROM dependent);

-- A job of the sweep ?1 as it stands.
-- name: known_job
SELECT j.job_id, coalesce((SELECT a.fencing_token FROM attempt a WHERE a.job_id = j.job_id AND a.outcome = 0), 0),
       coalesce(p.content_sha256, ''), coalesce(p.worker_name, '')
FROM job j LEFT JOIN provenance p USING (job_id)
WHERE j.sweep_id = ?1 AND j.job_key = ?2 AND j.superseded = 0;

-- Waiting or quarantined: a result that comes without a lease is taken.
-- name: job_open_to_a_result
SELECT job_id FROM job WHERE sweep_id = ?1 AND job_key = ?2 AND superseded = 0 AND state IN (0, 3);

-- Returns to the queue the jobs that were quarantined because of ?1 alone, directly or through other jobs.
-- name: revive_dependents
UPDATE job SET state = 0
WHERE state = 3 AND failures = 0 AND job_id IN (
  WITH RECURSIVE dependent (job_id) AS (
    SELECT job_id FROM job_need WHERE needs_job_id = ?1
    UNION SELECT n.job_id FROM job_need n JOIN dependent d ON n.needs_job_id = d.job_id)
  SELECT job_id FROM dependent)
  AND NOT EXISTS (SELECT 1 FROM job_need n JOIN job needed ON needed.job_id = n.needs_job_id
                  WHERE n.job_id = job.job_id AND needed.state = 3 AND needed.failures > 0);

-- A done job (?1 sweep_sha256, ?2 job_key) is to be stored again.
-- name: reopen_job
UPDATE job SET state = 0
WHERE state = 2 AND superseded = 0 AND job_key = ?2
  AND sweep_id = (SELECT sweep_id FROM sweep WHERE sweep_sha256 = ?1);

-- Reopens the jobs that worker ?1 computed, and the jobs that need them.
-- name: reopen_jobs_of_worker
UPDATE job SET state = 0
WHERE state = 2 AND superseded = 0 AND job_id IN (
  WITH RECURSIVE suspect (job_id) AS (
    SELECT job_id FROM provenance WHERE worker_name = ?1
    UNION SELECT n.job_id FROM job_need n JOIN suspect s ON n.needs_job_id = s.job_id)
  SELECT job_id FROM suspect);

-- name: recount_all_needs
UPDATE job
SET unmet_needs = (SELECT count(*) FROM job_need n JOIN job needed ON needed.job_id = n.needs_job_id
                   WHERE n.job_id = job.job_id AND needed.state <> 2)
WHERE job_id IN (SELECT job_id FROM job_need);

-- name: insert_result_aside
INSERT OR IGNORE INTO result_aside (job_id, worker_name, received_unix_s, content_sha256, result)
SELECT j.job_id, ?3, ?4, ?5, ?6 FROM job j JOIN sweep w USING (sweep_id)
WHERE w.sweep_sha256 = ?1 AND j.job_key = ?2 AND j.superseded = 0;

-- name: count_results_aside
SELECT count(*) FROM result_aside;

-- name: count_failure
UPDATE job SET failures = failures + 1 WHERE job_id = ?1 RETURNING failures;

-- name: count_failed_workers
SELECT count(DISTINCT worker_name) FROM attempt JOIN job USING (job_id)
WHERE job_id = ?1 AND outcome = 3 AND fencing_token > failures_after_token;

-- name: revoke_leases
UPDATE attempt SET outcome = 4, message = 'the sweep was cancelled'
WHERE outcome = 0 AND job_id IN (SELECT job_id FROM job WHERE sweep_id = ?1);

-- name: revoke_lease_of_job
UPDATE attempt SET outcome = 4, message = 'the sweep was changed' WHERE outcome = 0 AND job_id = ?1;

-- name: sweep_id_by_sha256
SELECT sweep_id FROM sweep WHERE sweep_sha256 = ?1;

-- name: cancel_jobs
UPDATE job SET state = 4 WHERE sweep_id = ?1 AND state IN (0, 1);

-- Counts of sweep_view, for the sweep ?1 or (NULL) for all.
-- name: progress
SELECT w.name, w.sweep_sha256,
       count(j.job_id),
       count(*) FILTER (WHERE j.state = 0),
       count(*) FILTER (WHERE j.state = 1),
       count(*) FILTER (WHERE j.state = 2),
       count(*) FILTER (WHERE j.state = 3),
       count(*) FILTER (WHERE j.state = 4),
       coalesce(sum(p.rays) FILTER (WHERE j.state = 2), 0),
       coalesce(max(p.worst_relative_error) FILTER (WHERE j.state = 2), 0.0),
       w.sweep_id,
       count(*) FILTER (WHERE j.kind = 2),
       count(*) FILTER (WHERE j.kind = 2 AND j.state = 2),
       coalesce(w.determinism_class, ''),
       w.priority
FROM sweep w
LEFT JOIN job j ON j.sweep_id = w.sweep_id AND j.superseded = 0
LEFT JOIN provenance p ON p.job_id = j.job_id
WHERE ?1 IS NULL OR w.sweep_id = ?1
GROUP BY w.sweep_id
ORDER BY w.sweep_id;

-- The messages of quarantined jobs: the last failure of each of the first ?2; and of those that were given up because of a job that
-- they need, how many, the first and the last, by the first such job.
-- name: failures_of_sweep
SELECT job_index, last_index, jobs, season, worker_name, message, needed_index
FROM (SELECT * FROM (
        SELECT j.job_index, j.job_index AS last_index, 1 AS jobs, coalesce(h.season, '') AS season, a.worker_name,
               a.message, NULL AS needed_index
        FROM job j LEFT JOIN heat_job h USING (job_id)
        JOIN attempt a ON a.fencing_token = (SELECT max(b.fencing_token) FROM attempt b
                                             WHERE b.job_id = j.job_id AND b.outcome = 3)
        WHERE j.sweep_id = ?1 AND j.superseded = 0 AND j.state = 3 AND j.unmet_needs = 0
        ORDER BY j.job_index LIMIT ?2)
      UNION ALL
      SELECT min(job_index), max(job_index), count(*), '', '', '', needed_index
      FROM (SELECT j.job_index, min(needed.job_index) AS needed_index
            FROM job j JOIN job_need n USING (job_id) JOIN job needed ON needed.job_id = n.needs_job_id
            WHERE j.sweep_id = ?1 AND j.superseded = 0 AND j.state = 3 AND j.unmet_needs > 0 AND needed.state = 3
            GROUP BY j.job_id)
      GROUP BY needed_index)
ORDER BY job_index;

-- name: bind_determinism_class
UPDATE sweep SET determinism_class = ?1
WHERE determinism_class IS NULL
  AND EXISTS (SELECT 1 FROM job j WHERE j.sweep_id = sweep.sweep_id AND j.superseded = 0 AND j.state IN (0, 1));
