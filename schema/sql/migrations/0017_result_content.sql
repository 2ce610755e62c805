-- Version 17: what the content of a result was, so that one that comes twice is known again, and results that differ
-- from what is stored, which are kept beside it. No part of digests.

ALTER TABLE provenance ADD COLUMN content_sha256 TEXT;  -- of the result without who, where and how long; NULL: older

CREATE TABLE result_aside (
  aside_id INTEGER PRIMARY KEY,
  job_id INTEGER NOT NULL REFERENCES job ON DELETE CASCADE,
  worker_name TEXT NOT NULL,
  received_unix_s REAL NOT NULL,
  content_sha256 TEXT NOT NULL,
  result BLOB NOT NULL,           -- irsig.schema.JobResult, serialized
  UNIQUE (job_id, content_sha256)
) STRICT;
