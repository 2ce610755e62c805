-- Jobs that compute temperatures, which views need: what such a job leaves is an asset (a serialized HeatField of
-- schema/result.proto), and what that comes to for each part is a table for people.

INSERT INTO job_kind VALUES (2, 'heat');

CREATE TABLE heat_job (
  job_id INTEGER PRIMARY KEY REFERENCES job ON DELETE CASCADE,
  heat_index INTEGER NOT NULL CHECK (heat_index >= 0),  -- its place in ResolvedSweep.heat
  season TEXT NOT NULL,                                 -- the first of those that share it
  output_sha256 TEXT REFERENCES asset (sha256),         -- NULL: not done
  warning TEXT NOT NULL DEFAULT ''                      -- one line each
) STRICT;
CREATE INDEX heat_job_by_output ON heat_job (output_sha256);

-- Of the facets of a part, by area.
CREATE TABLE computed_temperature (
  job_id INTEGER NOT NULL REFERENCES heat_job ON DELETE CASCADE,
  time_index INTEGER NOT NULL CHECK (time_index >= 0),  -- in the heat run
  time_utc TEXT NOT NULL,
  part_id INTEGER NOT NULL REFERENCES part,
  mean_k REAL NOT NULL CHECK (mean_k > 0),
  coldest_k REAL NOT NULL CHECK (coldest_k > 0),
  hottest_k REAL NOT NULL CHECK (hottest_k >= coldest_k),
  error_k REAL NOT NULL CHECK (error_k >= 0),           -- mean of the facets' errors
  PRIMARY KEY (job_id, time_index, part_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX computed_temperature_by_part ON computed_temperature (part_id);

-- Where the temperatures of a condition stand that a job computes: several seasons may share a heat run.
ALTER TABLE condition ADD COLUMN heat_index INTEGER CHECK (heat_index >= 0);
ALTER TABLE condition ADD COLUMN heat_time_index INTEGER CHECK (heat_time_index >= 0);

CREATE VIEW computed_temperature_view AS
SELECT w.name AS sweep, coalesce(c.season, h.season) AS season, coalesce(c.time_utc, t.time_utc) AS time_utc,
       p.name AS part, t.mean_k, t.coldest_k, t.hottest_k, t.error_k, j.superseded, j.job_key, c.condition_index,
       h.heat_index, t.time_index, p.part_index
FROM computed_temperature t
JOIN heat_job h USING (job_id)
JOIN job j USING (job_id)
JOIN sweep w USING (sweep_id)
JOIN part p USING (part_id)
LEFT JOIN condition c ON c.sweep_id = j.sweep_id AND c.superseded = 0 AND j.superseded = 0
                     AND c.heat_index = h.heat_index AND c.heat_time_index = t.time_index;

DROP VIEW sweep_view;
CREATE VIEW sweep_view AS
SELECT w.name AS sweep, w.sweep_sha256, w.viewpoints, w.conditions, w.bands, w.determinism_class,
       count(j.job_id) AS jobs,
       count(*) FILTER (WHERE j.state = 0) AS waiting,
       count(*) FILTER (WHERE j.state = 1) AS leased,
       count(*) FILTER (WHERE j.state = 2) AS done,
       count(*) FILTER (WHERE j.state = 3) AS quarantined,
       count(*) FILTER (WHERE j.state = 4) AS cancelled,
       coalesce(sum(p.rays) FILTER (WHERE j.state = 2), 0) AS rays,
       coalesce(max(p.worst_relative_error) FILTER (WHERE j.state = 2), 0.0) AS worst_relative_error,
       w.sweep_id,
       count(*) FILTER (WHERE j.kind = 2) AS heat_jobs,
       count(*) FILTER (WHERE j.kind = 2 AND j.state = 2) AS heat_done
FROM sweep w
LEFT JOIN job j ON j.sweep_id = w.sweep_id AND j.superseded = 0
LEFT JOIN provenance p ON p.job_id = j.job_id
GROUP BY w.sweep_id;
