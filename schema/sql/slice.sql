-- A slice (schema/store/whole/slice.cpp): some rows of this database, `main`, into a new and empty one, `slice`. Ids stay;
-- places (viewpoint_index and so on) are counted anew.

-- name: slice_tables
CREATE TEMP TABLE kept (signature_id INTEGER PRIMARY KEY) STRICT;
CREATE TEMP TABLE kept_viewpoint (viewpoint_id INTEGER PRIMARY KEY, sweep_id INTEGER, old INTEGER, place INTEGER) STRICT;
CREATE TEMP TABLE kept_condition (condition_id INTEGER PRIMARY KEY, sweep_id INTEGER, old INTEGER, place INTEGER) STRICT;
CREATE TEMP TABLE kept_band (band_id INTEGER PRIMARY KEY, sweep_id INTEGER, old INTEGER, place INTEGER) STRICT;
CREATE TEMP TABLE kept_job (job_id INTEGER PRIMARY KEY) STRICT;
CREATE TEMP TABLE kept_heat (job_id INTEGER PRIMARY KEY, sweep_id INTEGER, old INTEGER, place INTEGER) STRICT;

-- Rows of an earlier version of a sweep stay behind.
-- name: slice_keep
INSERT INTO temp.kept
SELECT s.signature_id
FROM signature s
JOIN job j USING (job_id) JOIN condition c USING (condition_id) JOIN band b USING (band_id)
WHERE s.signature_id = ?1 AND j.superseded = 0 AND c.superseded = 0 AND b.superseded = 0;

-- name: slice_count
SELECT count(*) FROM temp.kept;

-- name: slice_last_after
SELECT max(signature_id) FROM (SELECT signature_id FROM temp.kept WHERE signature_id > ?1 ORDER BY signature_id LIMIT ?2);

-- name: slice_places
INSERT INTO temp.kept_viewpoint
SELECT viewpoint_id, sweep_id, viewpoint_index, row_number() OVER (PARTITION BY sweep_id ORDER BY viewpoint_index) - 1
FROM viewpoint WHERE viewpoint_id IN (SELECT s.viewpoint_id FROM temp.kept JOIN signature s USING (signature_id));
INSERT INTO temp.kept_condition
SELECT condition_id, sweep_id, condition_index, row_number() OVER (PARTITION BY sweep_id ORDER BY condition_index) - 1
FROM condition WHERE condition_id IN (SELECT s.condition_id FROM temp.kept JOIN signature s USING (signature_id));
INSERT INTO temp.kept_band
SELECT band_id, sweep_id, band_index, row_number() OVER (PARTITION BY sweep_id ORDER BY band_index) - 1
FROM band WHERE band_id IN (SELECT s.band_id FROM temp.kept JOIN signature s USING (signature_id));
INSERT INTO temp.kept_job SELECT DISTINCT s.job_id FROM temp.kept JOIN signature s USING (signature_id);

-- name: slice_sweeps
SELECT w.sweep_id, w.sweep_sha256, w.resolved_sweep,
       (SELECT count(*) FROM condition c CROSS JOIN signature s ON s.condition_id = c.condition_id
        WHERE c.sweep_id = w.sweep_id),
       (SELECT count(*) FROM temp.kept k CROSS JOIN signature s ON s.signature_id = k.signature_id
        CROSS JOIN temp.kept_viewpoint v ON v.viewpoint_id = s.viewpoint_id WHERE v.sweep_id = w.sweep_id)
FROM sweep w WHERE w.sweep_id IN (SELECT sweep_id FROM temp.kept_viewpoint) ORDER BY w.sweep_id;

-- name: slice_viewpoints
SELECT old FROM temp.kept_viewpoint WHERE sweep_id = ?1 ORDER BY old;

-- name: slice_conditions
SELECT old FROM temp.kept_condition WHERE sweep_id = ?1 ORDER BY old;

-- name: slice_bands
SELECT old FROM temp.kept_band WHERE sweep_id = ?1 ORDER BY old;

-- ?1 sweep, ?2 heat run there, ?3 its place in the slice.
-- name: slice_keep_heat
INSERT INTO temp.kept_heat
SELECT j.job_id, j.sweep_id, ?2, ?3 FROM job j JOIN heat_job h USING (job_id)
WHERE j.sweep_id = ?1 AND h.heat_index = ?2 AND j.superseded = 0;

-- name: slice_sweep
INSERT INTO slice.sweep SELECT * FROM main.sweep WHERE sweep_id = ?1;

-- name: slice_change_sweep
UPDATE slice.sweep SET sweep_sha256 = ?2, viewpoints = ?3, conditions = ?4, bands = ?5, resolved_sweep = ?6
WHERE sweep_id = ?1;

-- name: slice_asset
INSERT INTO slice.asset SELECT * FROM main.asset WHERE sha256 = ?1 ON CONFLICT DO NOTHING;

-- name: slice_sweep_asset
INSERT INTO slice.sweep_asset SELECT * FROM main.sweep_asset WHERE sweep_id = ?1 AND sha256 = ?2;

-- name: slice_heat_outputs
SELECT DISTINCT output_sha256 FROM main.heat_job
WHERE output_sha256 IS NOT NULL AND job_id IN (SELECT job_id FROM temp.kept_heat);

-- Everything but what belongs to single signatures; order: what is referred to comes first.
-- name: slice_definitions
INSERT INTO temp.kept_job SELECT job_id FROM temp.kept_heat;
INSERT INTO slice.viewpoint SELECT * FROM main.viewpoint WHERE viewpoint_id IN (SELECT viewpoint_id FROM temp.kept_viewpoint);
INSERT INTO slice.viewpoint_direction
  SELECT d.* FROM temp.kept_viewpoint k CROSS JOIN main.viewpoint_direction d ON d.viewpoint_id = k.viewpoint_id;
INSERT INTO slice.condition SELECT * FROM main.condition WHERE condition_id IN (SELECT condition_id FROM temp.kept_condition);
INSERT INTO slice.band SELECT * FROM main.band WHERE band_id IN (SELECT band_id FROM temp.kept_band);
INSERT INTO slice.band_response SELECT * FROM main.band_response WHERE band_id IN (SELECT band_id FROM temp.kept_band);
INSERT INTO slice.part SELECT * FROM main.part WHERE superseded = 0 AND sweep_id IN (SELECT sweep_id FROM slice.sweep);
INSERT INTO slice.part_temperature
  SELECT * FROM main.part_temperature
  WHERE condition_id IN (SELECT condition_id FROM temp.kept_condition) AND part_id IN (SELECT part_id FROM slice.part);
INSERT INTO slice.published SELECT * FROM main.published WHERE sweep_id IN (SELECT sweep_id FROM slice.sweep);
INSERT INTO slice.job SELECT * FROM main.job WHERE job_id IN (SELECT job_id FROM temp.kept_job);
INSERT INTO slice.attempt SELECT * FROM main.attempt WHERE outcome = 1 AND job_id IN (SELECT job_id FROM temp.kept_job);
INSERT INTO slice.job_need
  SELECT * FROM main.job_need
  WHERE job_id IN (SELECT job_id FROM temp.kept_job) AND needs_job_id IN (SELECT job_id FROM temp.kept_job);
INSERT INTO slice.provenance SELECT * FROM main.provenance WHERE job_id IN (SELECT job_id FROM temp.kept_job);
INSERT INTO slice.silhouette SELECT * FROM main.silhouette WHERE job_id IN (SELECT job_id FROM temp.kept_job);
INSERT INTO slice.part_pixels SELECT * FROM main.part_pixels WHERE job_id IN (SELECT job_id FROM temp.kept_job);
INSERT INTO slice.part_set SELECT * FROM main.part_set WHERE job_id IN (SELECT job_id FROM temp.kept_job);
INSERT INTO slice.asset
  SELECT * FROM main.asset
  WHERE sha256 IN (SELECT output_sha256 FROM main.heat_job WHERE job_id IN (SELECT job_id FROM temp.kept_heat))
  ON CONFLICT DO NOTHING;
INSERT INTO slice.heat_job SELECT * FROM main.heat_job WHERE job_id IN (SELECT job_id FROM temp.kept_heat);
INSERT INTO slice.computed_temperature SELECT * FROM main.computed_temperature WHERE job_id IN (SELECT job_id FROM temp.kept_heat);

-- Signatures ?1 < signature_id <= ?2, and what belongs to each: one statement for each table.
-- name: slice_signature
INSERT INTO slice.signature
  SELECT t.* FROM temp.kept k CROSS JOIN main.signature t ON t.signature_id = k.signature_id
  WHERE k.signature_id > ?1 AND k.signature_id <= ?2;
-- name: slice_spectrum
INSERT INTO slice.spectrum
  SELECT t.* FROM temp.kept k CROSS JOIN main.spectrum t ON t.signature_id = k.signature_id
  WHERE k.signature_id > ?1 AND k.signature_id <= ?2;
-- name: slice_clutter
INSERT INTO slice.clutter
  SELECT t.* FROM temp.kept k CROSS JOIN main.clutter t ON t.signature_id = k.signature_id
  WHERE k.signature_id > ?1 AND k.signature_id <= ?2;
-- name: slice_clutter_material
INSERT INTO slice.clutter_material
  SELECT t.* FROM temp.kept k CROSS JOIN main.clutter_material t ON t.signature_id = k.signature_id
  WHERE k.signature_id > ?1 AND k.signature_id <= ?2;
-- name: slice_spectral_modes
INSERT INTO slice.spectral_modes
  SELECT t.* FROM temp.kept k CROSS JOIN main.spectral_modes t ON t.signature_id = k.signature_id
  WHERE k.signature_id > ?1 AND k.signature_id <= ?2;
-- name: slice_part_intensity
INSERT INTO slice.part_intensity
  SELECT t.* FROM temp.kept k CROSS JOIN main.part_intensity t ON t.signature_id = k.signature_id
  WHERE k.signature_id > ?1 AND k.signature_id <= ?2;
-- name: slice_thumbnail
INSERT INTO slice.thumbnail
  SELECT t.* FROM temp.kept k CROSS JOIN main.thumbnail t ON t.signature_id = k.signature_id
  WHERE k.signature_id > ?1 AND k.signature_id <= ?2;
-- name: slice_image_layer
INSERT INTO slice.image_layer
  SELECT t.* FROM temp.kept k CROSS JOIN main.image_layer t ON t.signature_id = k.signature_id
  WHERE k.signature_id > ?1 AND k.signature_id <= ?2;
-- name: slice_ledger
INSERT INTO slice.ledger
  SELECT t.* FROM temp.kept k CROSS JOIN main.ledger t ON t.signature_id = k.signature_id
  WHERE k.signature_id > ?1 AND k.signature_id <= ?2;
-- name: slice_energy
INSERT INTO slice.energy
  SELECT t.* FROM temp.kept k CROSS JOIN main.energy t ON t.signature_id = k.signature_id
  WHERE k.signature_id > ?1 AND k.signature_id <= ?2;
-- name: slice_input_contribution
INSERT INTO slice.input_contribution
  SELECT t.* FROM temp.kept k CROSS JOIN main.input_contribution t ON t.signature_id = k.signature_id
  WHERE k.signature_id > ?1 AND k.signature_id <= ?2;
-- name: slice_profile
INSERT INTO slice.profile
  SELECT t.* FROM temp.kept k CROSS JOIN main.profile t ON t.signature_id = k.signature_id
  WHERE k.signature_id > ?1 AND k.signature_id <= ?2;

-- The places of the new lists. Two steps where a place may be taken for a moment.
-- name: slice_renumber
UPDATE slice.viewpoint SET viewpoint_index = viewpoint_index + 1099511627776;
UPDATE slice.viewpoint
SET viewpoint_index = (SELECT place FROM temp.kept_viewpoint k WHERE k.viewpoint_id = viewpoint.viewpoint_id);
UPDATE slice.condition SET condition_index = condition_index + 1099511627776;
UPDATE slice.condition
SET condition_index = (SELECT place FROM temp.kept_condition k WHERE k.condition_id = condition.condition_id),
    heat_index = (SELECT place FROM temp.kept_heat h WHERE h.sweep_id = condition.sweep_id AND h.old = condition.heat_index);
UPDATE slice.band SET band_index = band_index + 1099511627776;
UPDATE slice.band SET band_index = (SELECT place FROM temp.kept_band k WHERE k.band_id = band.band_id);
UPDATE slice.heat_job SET heat_index = (SELECT place FROM temp.kept_heat k WHERE k.job_id = heat_job.job_id);
UPDATE slice.job
SET state = 2, unmet_needs = 0, failures = 0, failures_after_token = 0, job_index = p.place
FROM (SELECT job_id, row_number() OVER (PARTITION BY sweep_id ORDER BY job_index) - 1 AS place FROM slice.job) p
WHERE p.job_id = job.job_id;
UPDATE slice.job
SET condition_index =
      (SELECT json_group_array(place) FROM (
         SELECT DISTINCT c.condition_index AS place FROM slice.signature s JOIN slice.condition c USING (condition_id)
         WHERE s.job_id = job.job_id ORDER BY place)),
    band_index =
      (SELECT json_group_array(place) FROM (
         SELECT DISTINCT b.band_index AS place FROM slice.signature s JOIN slice.band b USING (band_id)
         WHERE s.job_id = job.job_id ORDER BY place))
WHERE kind = 1;

-- name: slice_attach
ATTACH ?1 AS slice;
