-- Version 19: sweeps have a priority. Of all that have a job to give, one of the highest gives the next. And they know the
-- physics version that their keys were made with: without it a coordinator that is started again would have to make all
-- keys anew to find out; NULL: it does. No part of digests.

ALTER TABLE sweep ADD COLUMN priority INTEGER NOT NULL DEFAULT 0 CHECK (priority BETWEEN -1000 AND 1000);
ALTER TABLE sweep ADD COLUMN physics_version INTEGER CHECK (physics_version > 0);
CREATE INDEX sweep_by_priority ON sweep (priority DESC, sweep_id);

DROP INDEX job_waiting;
-- First tries in sweep order; a job that failed goes to the back of its sweep, so that another worker gets to try it.
CREATE INDEX job_waiting ON job (sweep_id, failures, job_index) WHERE state = 0 AND unmet_needs = 0;
-- A status names the first of them.
CREATE INDEX job_given_up ON job (sweep_id, unmet_needs, job_index) WHERE state = 3 AND superseded = 0;

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
       count(*) FILTER (WHERE j.kind = 2 AND j.state = 2) AS heat_done,
       w.priority
FROM sweep w
LEFT JOIN job j ON j.sweep_id = w.sweep_id AND j.superseded = 0
LEFT JOIN provenance p ON p.job_id = j.job_id
GROUP BY w.sweep_id;
