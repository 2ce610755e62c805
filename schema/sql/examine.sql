-- Queries for damaged, missing or outdated content of a database (schema/store/whole/examine.cpp).

-- name: integrity_check
PRAGMA integrity_check(10);

-- name: foreign_key_check
SELECT "table", count(*) FROM pragma_foreign_key_check GROUP BY "table";

-- name: count_sweeps
SELECT count(*) FROM sweep;

-- name: count_signatures
SELECT count(*) FROM signature;

-- name: assets
SELECT sha256, bytes FROM asset;

-- Causes of an intensity add up to it: they were summed in another order.
-- name: count_sums_of_causes
SELECT count(*) FROM signature
WHERE abs(emitted_w_sr + sun_reflected_w_sr + sky_reflected_w_sr + surface_reflected_w_sr + interreflected_w_sr + ifnull(plume_w_sr, 0)
          - intensity_w_sr)
      > 1e-9 * (abs(emitted_w_sr) + abs(sun_reflected_w_sr) + abs(sky_reflected_w_sr) + abs(surface_reflected_w_sr)
                + abs(interreflected_w_sr) + abs(ifnull(plume_w_sr, 0)) + abs(intensity_w_sr));

-- name: count_viewpoints_without_direction
SELECT count(DISTINCT viewpoint_id) FROM signature
WHERE viewpoint_id NOT IN (SELECT viewpoint_id FROM viewpoint_direction);

-- name: signature_rows
SELECT signature_id, f.sweep, f.row FROM signature_view f WHERE superseded = 0 ORDER BY signature_id;

-- A sweep's jobs, and rows that its lists ask for and that are stored.
-- name: coverage
SELECT w.name, v.jobs, v.waiting + v.leased, v.quarantined, v.cancelled, w.viewpoints * w.conditions * w.bands,
       (SELECT count(*) FROM signature s JOIN job j USING (job_id) JOIN condition c USING (condition_id) JOIN band b USING (band_id)
        WHERE j.sweep_id = w.sweep_id AND j.superseded = 0 AND c.superseded = 0 AND b.superseded = 0),
       (SELECT count(*) FROM job j WHERE j.sweep_id = w.sweep_id AND j.superseded = 1), w.resolved_sweep
FROM sweep w JOIN sweep_view v USING (sweep_id) ORDER BY w.name;

-- Jobs without rows, or without temperatures, by their state (a leased one is a waiting one); of done ones views only.
-- name: jobs_without_rows
SELECT w.name, iif(j.state = 1, 0, j.state), j.job_index
FROM job j JOIN sweep w USING (sweep_id)
WHERE j.superseded = 0
  AND (j.state <> 2 OR (j.kind = 1 AND NOT EXISTS (SELECT 1 FROM signature s WHERE s.job_id = j.job_id)))
ORDER BY w.name, j.job_index;

-- name: physics_versions
SELECT w.name, p.physics_version, count(*)
FROM provenance p JOIN job j USING (job_id) JOIN sweep w USING (sweep_id)
WHERE j.superseded = 0 GROUP BY w.name, p.physics_version ORDER BY w.name, p.physics_version;
