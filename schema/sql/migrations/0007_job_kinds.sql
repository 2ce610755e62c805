-- Jobs have a kind, and may need other jobs of their sweep to be done first. What only a view has (its viewpoint,
-- conditions and bands) is NULL in jobs of any other kind, which add columns or tables of their own.

CREATE TABLE job_kind (
  kind INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE
) STRICT;
INSERT INTO job_kind VALUES (1, 'view');

-- Made anew, because SQLite cannot take NOT NULL from a column; foreign keys are off meanwhile and checked after it
-- (schema/store/open_database.cpp). Not by renaming: views that name the table stand in the way of that.
CREATE TABLE earlier_job AS SELECT * FROM job;
DROP TABLE job;
CREATE TABLE job (
  job_id INTEGER PRIMARY KEY,
  sweep_id INTEGER NOT NULL REFERENCES sweep ON DELETE CASCADE,
  job_index INTEGER NOT NULL CHECK (job_index >= 0),          -- its place in the sweep's list of jobs
  superseded INTEGER NOT NULL DEFAULT 0 CHECK (superseded IN (0, 1)),  -- done, and no longer part of the sweep
  job_key TEXT NOT NULL CHECK (job_key <> ''),
  kind INTEGER NOT NULL REFERENCES job_kind,
  viewpoint_id INTEGER REFERENCES viewpoint,
  condition_index TEXT CHECK (condition_index GLOB '[[]*]'), -- JSON array
  band_index TEXT CHECK (band_index GLOB '[[]*]'),
  state INTEGER NOT NULL REFERENCES job_state CHECK (state BETWEEN 0 AND 4),
  unmet_needs INTEGER NOT NULL DEFAULT 0 CHECK (unmet_needs >= 0),  -- jobs that it needs and that are not done
  failures INTEGER NOT NULL DEFAULT 0 CHECK (failures >= 0),  -- failed attempts since it was last submitted
  failures_after_token INTEGER NOT NULL DEFAULT 0,            -- attempts up to this one no longer count
  UNIQUE (sweep_id, job_key),
  CHECK ((kind = 1) = (viewpoint_id IS NOT NULL AND condition_index IS NOT NULL AND band_index IS NOT NULL))
) STRICT;
INSERT INTO job (job_id, sweep_id, job_index, superseded, job_key, kind, viewpoint_id, condition_index, band_index,
                 state, failures, failures_after_token)
SELECT job_id, sweep_id, job_index, superseded, job_key, 1, viewpoint_id, condition_index, band_index, state, failures,
       failures_after_token
FROM earlier_job;
DROP TABLE earlier_job;

CREATE INDEX job_by_viewpoint ON job (viewpoint_id);
CREATE INDEX job_superseded ON job (sweep_id) WHERE superseded = 1;
-- First tries in sweep order; a job that failed goes to the back, so that another worker gets to try it.
CREATE INDEX job_waiting ON job (failures, sweep_id, job_index) WHERE state = 0 AND unmet_needs = 0;

CREATE TABLE job_need (
  job_id INTEGER NOT NULL REFERENCES job ON DELETE CASCADE,
  needs_job_id INTEGER NOT NULL REFERENCES job (job_id) ON DELETE CASCADE CHECK (needs_job_id <> job_id),
  PRIMARY KEY (job_id, needs_job_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX job_need_by_needed ON job_need (needs_job_id);

DROP VIEW job_view;
CREATE VIEW job_view AS
SELECT w.name AS sweep, j.job_index, k.name AS kind, s.name AS state, j.superseded, j.failures, j.unmet_needs, j.job_key,
       v.viewpoint_index, v.aspect_azimuth_deg, v.aspect_elevation_deg, v.range_m, j.condition_index, j.band_index,
       (SELECT fencing_token FROM attempt a WHERE a.job_id = j.job_id AND outcome = 0) AS fencing_token,
       (SELECT worker_id FROM attempt a WHERE a.job_id = j.job_id AND outcome = 0) AS leased_to,
       p.worker_name AS done_by, p.seconds, p.rays, p.worst_relative_error
FROM job j
JOIN sweep w USING (sweep_id)
JOIN job_kind k USING (kind)
JOIN job_state s USING (state)
LEFT JOIN viewpoint v USING (viewpoint_id)
LEFT JOIN provenance p USING (job_id);
