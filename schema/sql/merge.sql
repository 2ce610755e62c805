-- Merging (schema/store/whole/merge.cpp): the done jobs of this database, `main`, into `merged`, in which all sweeps have
-- been submitted. Tables temp.of_...: what is called `theirs` here is called `ours` there; `known` is what `merged`
-- has already. ?1: the sweep here, ?2: the sweep there.

-- name: merge_attach
ATTACH ?1 AS merged;

-- Sweeps to be merged, with two counts of rows: rows of done jobs of the current sweep, and all rows.
-- name: merge_sweeps
SELECT w.sweep_id, w.name, w.sweep_sha256, w.resolved_sweep, coalesce(min(p.physics_version), 0),
       coalesce(max(p.physics_version), 0), coalesce(min(p.determinism_class), ''),
       coalesce(max(p.determinism_class), ''),
       (SELECT count(*) FROM job j CROSS JOIN signature s ON s.job_id = j.job_id
        WHERE j.sweep_id = w.sweep_id AND j.superseded = 0 AND j.state = 2),
       (SELECT count(*) FROM condition c CROSS JOIN signature s ON s.condition_id = c.condition_id
        WHERE c.sweep_id = w.sweep_id)
FROM sweep w
LEFT JOIN job j ON j.sweep_id = w.sweep_id AND j.superseded = 0 AND j.state = 2
LEFT JOIN provenance p ON p.job_id = j.job_id
GROUP BY w.sweep_id ORDER BY w.sweep_id;

-- name: merge_sweep_id
SELECT sweep_id FROM merged.sweep WHERE name = ?1;

-- name: merge_tables
CREATE TEMP TABLE of_job (theirs INTEGER PRIMARY KEY, ours INTEGER, known INTEGER NOT NULL) STRICT;
CREATE TEMP TABLE of_viewpoint (theirs INTEGER PRIMARY KEY, ours INTEGER NOT NULL) STRICT;
CREATE TEMP TABLE of_condition (theirs INTEGER PRIMARY KEY, ours INTEGER NOT NULL) STRICT;
CREATE TEMP TABLE of_band (theirs INTEGER PRIMARY KEY, ours INTEGER NOT NULL) STRICT;
CREATE TEMP TABLE of_part (theirs INTEGER PRIMARY KEY, ours INTEGER NOT NULL) STRICT;
CREATE TEMP TABLE of_signature (theirs INTEGER PRIMARY KEY, ours INTEGER, known INTEGER NOT NULL) STRICT;

-- name: merge_clear
DELETE FROM temp.of_job;
DELETE FROM temp.of_viewpoint;
DELETE FROM temp.of_condition;
DELETE FROM temp.of_band;
DELETE FROM temp.of_part;
DELETE FROM temp.of_signature;

-- name: merge_jobs
INSERT INTO temp.of_job
SELECT j.job_id, o.job_id, coalesce(o.state = 2, 0)
FROM main.job j LEFT JOIN merged.job o ON o.sweep_id = ?2 AND o.job_key = j.job_key AND o.kind = j.kind
WHERE j.sweep_id = ?1 AND j.superseded = 0 AND j.state = 2;

-- name: merge_foreign_job
SELECT j.job_key FROM temp.of_job m JOIN main.job j ON j.job_id = m.theirs WHERE m.ours IS NULL
ORDER BY j.job_index LIMIT 1;

-- name: merge_viewpoints
INSERT INTO temp.of_viewpoint
SELECT v.viewpoint_id, o.viewpoint_id
FROM main.viewpoint v JOIN merged.viewpoint o ON o.sweep_id = ?2 AND o.viewpoint_index = v.viewpoint_index
WHERE v.sweep_id = ?1;

-- name: merge_directions
INSERT INTO merged.viewpoint_direction
SELECT o.ours, d.min_x, d.max_x, d.min_y, d.max_y, d.min_z, d.max_z, d.unit_x, d.unit_y, d.unit_z
FROM temp.of_viewpoint o JOIN main.viewpoint_direction d ON d.viewpoint_id = o.theirs
WHERE NOT EXISTS (SELECT 1 FROM merged.viewpoint_direction e WHERE e.viewpoint_id = o.ours);

-- name: merge_conditions
INSERT INTO temp.of_condition
SELECT c.condition_id, o.condition_id
FROM main.condition c JOIN merged.condition o ON o.sweep_id = ?2 AND o.condition_index = c.condition_index
WHERE c.sweep_id = ?1 AND c.superseded = 0;

-- name: merge_bands
INSERT INTO temp.of_band
SELECT b.band_id, o.band_id
FROM main.band b JOIN merged.band o ON o.sweep_id = ?2 AND o.band_index = b.band_index
WHERE b.sweep_id = ?1 AND b.superseded = 0;

-- name: merge_parts
INSERT INTO temp.of_part
SELECT p.part_id, o.part_id
FROM main.part p JOIN merged.part o ON o.sweep_id = ?2 AND o.part_index = p.part_index
WHERE p.sweep_id = ?1 AND p.superseded = 0;

-- ?1: what is added to the ids of rows that are new.
-- name: merge_signatures
INSERT INTO temp.of_signature
SELECT s.signature_id,
       iif(m.known, (SELECT o.signature_id FROM merged.signature o
                     WHERE o.condition_id = c.ours AND o.band_id = b.ours AND o.viewpoint_id = v.ours),
           s.signature_id + ?1),
       m.known
FROM temp.of_job m
CROSS JOIN main.signature s ON s.job_id = m.theirs
CROSS JOIN merged.job o ON o.job_id = m.ours
JOIN temp.of_viewpoint v ON v.theirs = s.viewpoint_id AND v.ours = o.viewpoint_id
JOIN temp.of_condition c ON c.theirs = s.condition_id
JOIN temp.of_band b ON b.theirs = s.band_id;

-- A done view of which a row is missing, or is another view's.
-- name: merge_broken_job
SELECT o.job_key FROM temp.of_job m CROSS JOIN merged.job o ON o.job_id = m.ours
WHERE o.kind = 1
  AND json_array_length(o.condition_index) * json_array_length(o.band_index)
      <> (SELECT count(t.theirs) FROM main.signature s LEFT JOIN temp.of_signature t ON t.theirs = s.signature_id
          WHERE s.job_id = m.theirs)
ORDER BY o.job_index LIMIT 1;

-- name: merge_last_signature
SELECT coalesce(max(signature_id), 0) FROM merged.signature;

-- name: merge_count
SELECT count(*) FROM temp.of_signature;

-- name: merge_last_after
SELECT max(theirs) FROM (SELECT theirs FROM temp.of_signature WHERE theirs > ?1 ORDER BY theirs LIMIT ?2);

-- The lines of one table that belong to signatures or jobs ?1 < theirs <= ?2. Put in by name: TABLE; OWNER, the column
-- by which its lines belong to them, and OWNERS, the table above of these; COLUMNS; VALUES, the same with ids as they
-- are in `merged`, JOINS, the tables above that these need; ONLY, which lines.
-- name: merge_copy
INSERT INTO merged.TABLE (COLUMNS)
SELECT VALUES FROM temp.OWNERS o CROSS JOIN main.TABLE t ON t.OWNER = o.theirs JOINS
WHERE o.known = 0 AND o.theirs > ?1 AND o.theirs <= ?2 AND ONLY;

-- A line that is here and not there; and one that is there and not here.
-- name: merge_only_here
SELECT VALUES FROM temp.OWNERS o CROSS JOIN main.TABLE t ON t.OWNER = o.theirs JOINS
WHERE o.known = 1 AND o.theirs > ?1 AND o.theirs <= ?2
EXCEPT
SELECT COLUMNS FROM merged.TABLE
WHERE OWNER IN (SELECT ours FROM temp.OWNERS WHERE known = 1 AND theirs > ?1 AND theirs <= ?2)
LIMIT 1;

-- name: merge_only_there
SELECT COLUMNS FROM merged.TABLE
WHERE OWNER IN (SELECT ours FROM temp.OWNERS WHERE known = 1 AND theirs > ?1 AND theirs <= ?2)
EXCEPT
SELECT VALUES FROM temp.OWNERS o CROSS JOIN main.TABLE t ON t.OWNER = o.theirs JOINS
WHERE o.known = 1 AND o.theirs > ?1 AND o.theirs <= ?2
LIMIT 1;

-- name: merge_columns
SELECT name FROM pragma_table_info(?1, 'main') ORDER BY cid;

-- Wavelengths of bands whose rows both have.
-- name: merge_other_wavelengths
SELECT a.name FROM temp.of_band m JOIN main.band a ON a.band_id = m.theirs JOIN merged.band b ON b.band_id = m.ours
WHERE a.lambda_um <> b.lambda_um LIMIT 1;

-- name: merge_wavelengths
UPDATE merged.band
SET lambda_um = (SELECT a.lambda_um FROM temp.of_band m JOIN main.band a ON a.band_id = m.theirs
                 WHERE m.ours = band.band_id)
WHERE lambda_um IS NULL AND band_id IN (SELECT ours FROM temp.of_band);

-- name: merge_other_temperatures
SELECT m.ours FROM temp.of_job m
JOIN main.heat_job a ON a.job_id = m.theirs JOIN merged.heat_job b ON b.job_id = m.ours
WHERE m.known = 1 AND (a.output_sha256 IS NOT b.output_sha256 OR a.warning <> b.warning) LIMIT 1;

-- name: merge_heat_outputs
SELECT DISTINCT a.output_sha256 FROM temp.of_job m JOIN main.heat_job a ON a.job_id = m.theirs
WHERE m.known = 0 AND a.output_sha256 IS NOT NULL;

-- name: merge_temperatures
INSERT INTO merged.asset
  SELECT * FROM main.asset
  WHERE sha256 IN (SELECT a.output_sha256 FROM temp.of_job m JOIN main.heat_job a ON a.job_id = m.theirs WHERE m.known = 0)
  ON CONFLICT DO NOTHING;
UPDATE merged.heat_job
SET (output_sha256, warning) = (SELECT a.output_sha256, a.warning FROM temp.of_job m JOIN main.heat_job a ON a.job_id = m.theirs
                                WHERE m.ours = heat_job.job_id)
WHERE job_id IN (SELECT ours FROM temp.of_job WHERE known = 0);

-- name: merge_new_jobs
SELECT ours FROM temp.of_job WHERE known = 0;

-- name: merge_job_key
SELECT job_key FROM merged.job WHERE job_id = ?1;

-- The job and the row of a signature of `merged`.
-- name: merge_place
SELECT s.job_id, (v.viewpoint_index * w.conditions + c.condition_index) * w.bands + b.band_index + 1
FROM merged.signature s
JOIN merged.viewpoint v USING (viewpoint_id) JOIN merged.sweep w USING (sweep_id)
JOIN merged.condition c USING (condition_id) JOIN merged.band b USING (band_id)
WHERE s.signature_id = ?1;

-- name: merge_set_done
UPDATE merged.job SET state = 2 WHERE job_id IN (SELECT ours FROM temp.of_job);

-- name: merge_count_needs
UPDATE merged.job
SET unmet_needs = (SELECT count(*) FROM merged.job_need n JOIN merged.job needed ON needed.job_id = n.needs_job_id
                   WHERE n.job_id = job.job_id AND needed.state <> 2)
WHERE sweep_id = ?1 AND job_id IN (SELECT job_id FROM merged.job_need);

-- name: merge_bind
UPDATE merged.sweep SET determinism_class = ?2 WHERE sweep_id = ?1;

-- name: merge_prediction
INSERT INTO merged.prediction SELECT * FROM main.prediction WHERE sweep_sha256 = ?1 ON CONFLICT DO NOTHING;

-- Sweeps of the merged database that can be continued.
-- name: merge_open_sweeps
SELECT name, determinism_class FROM sweep w
WHERE determinism_class IS NOT NULL
  AND EXISTS (SELECT 1 FROM job j WHERE j.sweep_id = w.sweep_id AND j.superseded = 0 AND j.state = 0)
ORDER BY sweep_id;
