-- The queue (schema/store/queue.cpp). States and outcomes: tables job_state and attempt_outcome.

-- name: next_waiting_job
SELECT job_id, failures FROM job WHERE state = 0 ORDER BY failures, sweep_id, job_index LIMIT 1;

-- name: insert_attempt
INSERT INTO attempt (job_id, worker_id, leased_unix_s) VALUES (?1, ?2, ?3) RETURNING fencing_token;

-- name: set_job_state
UPDATE job SET state = ?2 WHERE job_id = ?1;

-- name: queued_job
SELECT w.sweep_sha256, j.job_key, v.viewpoint_index, j.condition_index, j.band_index, j.state,
       (SELECT count(DISTINCT a.worker_name) FROM attempt a
        WHERE a.job_id = j.job_id AND a.outcome = 3 AND a.fencing_token > j.failures_after_token)
FROM job j
JOIN sweep w USING (sweep_id)
JOIN viewpoint v USING (viewpoint_id)
WHERE j.job_id = ?1;

-- name: leased_job
SELECT j.job_id, j.sweep_id, j.job_key, j.viewpoint_id, j.condition_index, j.band_index
FROM attempt a
JOIN job j USING (job_id)
WHERE a.fencing_token = ?1 AND a.outcome = 0;

-- name: end_attempt
UPDATE attempt SET outcome = ?2, message = ?3, worker_name = ?4 WHERE fencing_token = ?1;

-- name: release_all_jobs
UPDATE job SET state = 0 WHERE state = 1;

-- name: release_all_attempts
UPDATE attempt SET outcome = 2, message = 'the coordinator ended' WHERE outcome = 0;

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

-- name: progress
SELECT sweep, sweep_sha256, jobs, waiting, leased, done, quarantined, cancelled, rays, worst_relative_error, sweep_id
FROM sweep_view
ORDER BY sweep_id;

-- The messages of quarantined jobs: the last failure of each.
-- name: failures_of_sweep
SELECT j.job_index, a.worker_name, a.message, max(a.fencing_token)
FROM job j JOIN attempt a USING (job_id)
WHERE j.sweep_id = ?1 AND j.superseded = 0 AND j.state = 3 AND a.outcome = 3
GROUP BY j.job_id
ORDER BY j.job_index;

-- name: determinism_class
SELECT w.determinism_class FROM sweep w
WHERE w.determinism_class IS NOT NULL
  AND EXISTS (SELECT 1 FROM job j WHERE j.sweep_id = w.sweep_id AND j.superseded = 0 AND j.state IN (0, 1))
ORDER BY w.sweep_id
LIMIT 1;

-- name: bind_determinism_class
UPDATE sweep SET determinism_class = ?1
WHERE determinism_class IS NULL
  AND EXISTS (SELECT 1 FROM job j WHERE j.sweep_id = sweep.sweep_id AND j.superseded = 0 AND j.state IN (0, 1));
