#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "schema/job.pb.h"

namespace irsig {

// The text that names a message: the same for equal messages whatever wrote them, unlike protobuf's
// bytes. One line for each field that is present, in the order of field numbers,
//
//   <path> <type> <value>
//
//   path   field numbers, "1.7[2].4"; [i]: the i-th element; {"name"}: the entry of a map, sorted
//   by
//          name
//   type   message (no value) | string | double | uint | bool
//   value  "..." with \xNN for all but printable ASCII, quotes and backslashes; %a hexadecimal, no
//          negative zero; decimal; true | false
//
// The SHA-256 of a resolved sweep's canonical encoding is its sweep_sha256. The asset stored and
// sent under that name is the serialized ResolvedSweep: whoever fetched it parses and encodes it to
// check it.
[[nodiscard]] std::string canonical_encoding(const schema::ResolvedSweep& sweep);

// SHA-256 in hex.
[[nodiscard]] std::string sha256_hex(std::string_view bytes);

// The jobs of a sweep: one for each heat run, in their order; then one for each viewpoint (of its
// shard, if it is one), in order, which needs all of those, cut along time, then season, then band
// where its estimated cost exceeds transport.job_size_vertices, or the images of [image] of its
// rows kMostImageBytes (schema/image_size.h). Cutting is a pure function of the sweep.
//
// Cost in path vertices: tracing = paths x (1 + the smaller of 3 and max_reflections),
// since roulette ends nearly every path before its third reflection; each condition adds 0.01
// tracing for every 122 stored wavelengths, and 0.25 tracing if it has a sun. Paths are
// target_paths, or replicates x samples_per_replicate, or for a relative error e (for a time budget
// that no pilot has turned into samples yet, e = 0.01) 2200 (0.01 / e)^(1 / 0.77), at most
// replicates x max_samples_per_replicate; profiles add theirs. Every piece traces again, so a piece
// may always carry as much shading as its tracing costs.
//
// job_key of a view = SHA-256 of what determines its result: physics_version, the canonical
// encoding of the sweep without what does not (names, viewpoints other than the job's, the shard,
// how conditions were written, job size, the closed-form model, published numbers), the viewpoint,
// and the job's condition and band indices, the keys of what it needs. It covers ALL conditions and
// bands: they decide sample counts and hot parts together.
//
// job_key of a heat run = SHA-256 of physics_version and the canonical encoding of the sweep
// without what temperatures do not depend on: the above, and viewpoints, conditions, bands,
// accuracy, effects, output, profiles, other heat runs, what the season is called, parts called
// hot. Two equal runs would share a key: a resolved sweep has each once.
[[nodiscard]] std::vector<schema::JobSpec> expand_jobs(const schema::ResolvedSweep& sweep,
                                                       int physics_version);

// Returns the number of those jobs.
[[nodiscard]] double job_count(const schema::ResolvedSweep& sweep);

}  // namespace irsig
