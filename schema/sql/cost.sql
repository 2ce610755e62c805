-- Costs of computing, and the predicted costs (schema/store/tables/cost.cpp).

-- name: store_prediction
INSERT OR REPLACE INTO prediction (
  sweep_sha256, made_unix_s, determinism_class, workers, pilot_viewpoints, pilot_cpu_s, jobs, cpu_s, wall_s,
  job_cpu_quartile1_s, job_cpu_median_s, job_cpu_quartile3_s, database_bytes)
VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13);

-- name: prediction_of_sweep
SELECT sweep_sha256, made_unix_s, determinism_class, workers, pilot_viewpoints, pilot_cpu_s, jobs, cpu_s, wall_s,
       job_cpu_quartile1_s, job_cpu_median_s, job_cpu_quartile3_s, database_bytes
FROM prediction WHERE sweep_sha256 = ?1;

-- The done views of a sweep, with the lease under which each was done.
-- name: done_jobs
SELECT j.job_index, v.viewpoint_index, p.seconds, p.samples, p.replicates, p.target_paths, p.rays,
       p.guarded_backface_hits, p.guarded_nonfinite, p.truncated_paths, p.guarded_negative, p.worker_name,
       coalesce((SELECT max(a.leased_unix_s) FROM attempt a WHERE a.job_id = j.job_id AND a.outcome = 1), 0.0),
       p.determinism_class
FROM job j
JOIN sweep w USING (sweep_id)
JOIN viewpoint v USING (viewpoint_id)
JOIN provenance p USING (job_id)
WHERE w.name = ?1 AND j.superseded = 0 AND j.state = 2
ORDER BY j.job_index;

-- Why the rows of a sweep stopped.
-- name: stops_of_sweep
SELECT r.name, count(*)
FROM sweep w
CROSS JOIN condition c ON c.sweep_id = w.sweep_id AND c.superseded = 0
CROSS JOIN band b ON b.sweep_id = w.sweep_id AND b.superseded = 0
CROSS JOIN signature s ON s.condition_id = c.condition_id AND s.band_id = b.band_id
JOIN job j ON j.job_id = s.job_id AND j.superseded = 0
JOIN stop_reason r ON r.stop_reason = s.stop_reason
WHERE w.name = ?1
GROUP BY r.stop_reason ORDER BY r.stop_reason;

-- How many rows each job of a sweep has stored, superseded ones included.
-- name: rows_of_jobs
SELECT j.job_key, count(*)
FROM sweep w
JOIN job j USING (sweep_id)
JOIN signature s USING (job_id)
WHERE w.name = ?1
GROUP BY j.job_id;

-- Number of a sweep's viewpoints with facets seen from behind, and the largest fraction of a silhouette.
-- name: back_faces_of_sweep
SELECT count(DISTINCT s.viewpoint_id), coalesce(max(s.backface_fraction), 0.0)
FROM sweep w
JOIN job j ON j.sweep_id = w.sweep_id AND j.superseded = 0
JOIN signature s ON s.job_id = j.job_id
WHERE w.name = ?1 AND s.backface_fraction > 0;

-- name: image_errors_of_sweep
SELECT coalesce(max(t.error_relative), 0.0), coalesce(max(t.error_k), 0.0)
FROM sweep w JOIN job j ON j.sweep_id = w.sweep_id AND j.superseded = 0
     JOIN signature s ON s.job_id = j.job_id JOIN thumbnail t ON t.signature_id = s.signature_id
WHERE w.name = ?1;

-- What decides the error of each row of a sweep, in the order of rows: few columns, since a report reads all rows.
-- name: errors_of_sweep
SELECT r.name, coalesce(s.limiting_bound, ''), j.superseded OR c.superseded OR b.superseded,
       s.intensity_w_sr, s.intensity_stderr_w_sr, s.numerical_error_w_sr, s.undersampling_stderr_w_sr,
       s.truncation_bound_w_sr, s.quadrature_bound_w_sr, s.spectral_basis_bound_w_sr, s.undersampling_bound_w_sr,
       s.direction_interpolation_bound_w_sr, s.omitted_bound_w_sr, s.temperature_bound_w_sr, s.plume_bound_w_sr
FROM sweep w
CROSS JOIN viewpoint v ON v.sweep_id = w.sweep_id
CROSS JOIN condition c ON c.sweep_id = w.sweep_id
CROSS JOIN band b ON b.sweep_id = w.sweep_id
CROSS JOIN signature s
  ON s.condition_id = c.condition_id AND s.band_id = b.band_id AND s.viewpoint_id = v.viewpoint_id
CROSS JOIN job j ON j.job_id = s.job_id
CROSS JOIN stop_reason r ON r.stop_reason = s.stop_reason
WHERE w.name = ?1
ORDER BY v.viewpoint_index, c.condition_index, b.band_index;

-- name: database_bytes
SELECT page_count * page_size FROM pragma_page_count(), pragma_page_size();
