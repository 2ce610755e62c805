-- Files that sweeps need and outputs of heat jobs, by their SHA-256 (schema/store/tables/stored_asset.cpp).

-- name: asset_bytes
SELECT bytes FROM asset WHERE sha256 = ?1;

-- name: insert_asset
INSERT INTO asset (sha256, bytes) VALUES (?1, ?2);

-- name: replace_asset
UPDATE asset SET bytes = ?2 WHERE sha256 = ?1;

-- As many zeros, to be written over piece by piece.
-- name: insert_empty_asset
INSERT INTO asset (sha256, bytes) VALUES (?1, zeroblob(?2)) RETURNING rowid;

-- name: empty_asset
UPDATE asset SET bytes = zeroblob(?2) WHERE sha256 = ?1 RETURNING rowid;

-- Who needs an asset: a sweep, and the season of its heat job if one has computed it.
-- name: asset_use
SELECT w.name, h.season FROM heat_job h JOIN job j USING (job_id) JOIN sweep w USING (sweep_id) WHERE h.output_sha256 = ?1
UNION ALL
SELECT w.name, NULL FROM sweep_asset a JOIN sweep w USING (sweep_id) WHERE a.sha256 = ?1
LIMIT 1;

-- name: heat_output_of_job
SELECT output_sha256 FROM heat_job WHERE job_id = ?1 AND output_sha256 IS NOT NULL;

-- name: heat_outputs
SELECT DISTINCT h.output_sha256 FROM heat_job h JOIN job j USING (job_id)
WHERE j.superseded = 0 AND j.state = 2 AND h.output_sha256 IS NOT NULL;

-- The jobs that have computed it.
-- name: reopen_heat_jobs
UPDATE job SET state = 0
WHERE state = 2 AND superseded = 0 AND job_id IN (SELECT job_id FROM heat_job WHERE output_sha256 = ?1);
