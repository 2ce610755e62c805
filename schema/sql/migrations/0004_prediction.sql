-- Version 4: what a pilot predicted of a sweep, to be set against what it really took. Named by the sweep's hash and
-- not by its id: a prediction may be stored before the sweep is submitted.

CREATE TABLE prediction (
  sweep_sha256 TEXT PRIMARY KEY CHECK (sweep_sha256 <> ''),
  made_unix_s REAL NOT NULL,
  determinism_class TEXT NOT NULL,                                   -- of the machine that the pilot ran on
  workers INTEGER NOT NULL CHECK (workers > 0),
  pilot_viewpoints INTEGER NOT NULL CHECK (pilot_viewpoints > 0),
  pilot_cpu_s REAL NOT NULL CHECK (pilot_cpu_s >= 0),
  jobs INTEGER NOT NULL CHECK (jobs > 0),
  cpu_s REAL NOT NULL CHECK (cpu_s >= 0),                            -- of all jobs together
  wall_s REAL NOT NULL CHECK (wall_s >= 0),
  job_cpu_quartile1_s REAL NOT NULL CHECK (job_cpu_quartile1_s >= 0),
  job_cpu_median_s REAL NOT NULL CHECK (job_cpu_median_s >= job_cpu_quartile1_s),
  job_cpu_quartile3_s REAL NOT NULL CHECK (job_cpu_quartile3_s >= job_cpu_median_s),
  database_bytes INTEGER NOT NULL CHECK (database_bytes > 0)
) STRICT, WITHOUT ROWID;
