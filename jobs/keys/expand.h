#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "schema/job.pb.h"

namespace irsig {

// Returns the canonical text of a message. Equal messages have equal texts, whatever program wrote
// them; protobuf's bytes do not guarantee that. There is one line for each field that is present,
// in the order of field numbers:
//
//   <path> <type> <value>
//
//   path   field numbers, "1.7[2].4"; [i]: the i-th element; {"name"}: the entry of a map, sorted
//          by name
//   type   message (no value) | string | double | uint | bool
//   value  "..." with \xNN for all but printable ASCII, quotes and backslashes; %a hexadecimal, no
//          negative zero; decimal; true | false
//
// The SHA-256 of a resolved sweep's canonical encoding is its sweep_sha256. The asset stored and
// sent under that name is the serialized ResolvedSweep; a receiver checks it by parsing and
// encoding it again.
[[nodiscard]] std::string canonical_encoding(const schema::ResolvedSweep& sweep);

// Returns the SHA-256 in hex.
[[nodiscard]] std::string sha256_hex(std::string_view bytes);

// Returns the jobs of a sweep: first one for each heat run, in the order of the runs; then one for
// each viewpoint of the sweep (of the shard, if it is one), in order, which needs all heat jobs. A
// viewpoint is cut along time, then season, then band, where its estimated cost exceeds
// transport.job_size_vertices, or where the images ([image]) of its rows exceed kMostImageBytes
// (schema/image_size.h). Cutting is a pure function of the sweep.
//
// Cost is counted in path vertices. Tracing = paths x (1 + min(3, max_reflections)), because
// roulette ends nearly every path before its third reflection. Each condition adds 0.01 tracing for
// every 122 stored wavelengths, and 0.25 tracing if it has a sun. Paths are target_paths, or
// replicates x samples_per_replicate. For a relative error e they are 2200 (0.01 / e)^(1 / 0.77),
// at most replicates x max_samples_per_replicate; e = 0.01 for a time budget that no pilot has
// converted to samples. Profiles add their paths. Every piece traces again, so a piece may always
// carry as much shading as its tracing costs.
//
// The job_key of a view is the SHA-256 of everything that determines its result: physics_version,
// the canonical encoding of the sweep, the viewpoint, the job's condition and band indices, and the
// keys of the jobs that it needs. The encoding omits fields without influence: names, other
// viewpoints, the shard, how conditions were written, job size, the closed-form model and published
// numbers. The key covers ALL conditions and bands, because together they decide sample counts and
// hot parts.
//
// The job_key of a heat run is the SHA-256 of physics_version and the canonical encoding of the
// sweep without fields that do not affect temperatures. The encoding omits the fields above, and
// viewpoints, conditions, bands, accuracy, effects, output, profiles, other heat runs, the season's
// name and the parts called hot. Two equal runs would share a key; a resolved sweep therefore has
// each run once.
[[nodiscard]] std::vector<schema::JobSpec> expand_jobs(const schema::ResolvedSweep& sweep,
                                                       int physics_version);

// Returns the number of those jobs.
[[nodiscard]] double job_count(const schema::ResolvedSweep& sweep);

}  // namespace irsig
