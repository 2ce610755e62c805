#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "schema/job.pb.h"
#include "schema/result.pb.h"
#include "worker/lease_loop.h"

namespace irsig {

// The frigate of jobs/examples with another number of viewpoints: a sweep whose results have their
// real size (6 rows of 41 or 81 wavelengths, 8 parts), for tests of the farm that need no physics.
[[nodiscard]] schema::ResolvedSweep frigate_sweep(std::uint32_t viewpoints,
                                                  const std::string& name = "frigate");

// Returns the sweep with a heat run of each season: of its first part, which has no stated
// temperatures.
[[nodiscard]] schema::ResolvedSweep heated_frigate_sweep(std::uint32_t viewpoints,
                                                         const std::string& name = "frigate");

inline constexpr char kSyntheticClass[] = "synthetic";

// A result with made-up numbers, the same for the same job key, wherever it is made; with a PNG of
// 5 kB and an EXR of 20 kB a row; of a heat job, with the temperatures of 5000 facets.
[[nodiscard]] schema::JobResult synthetic_result(const schema::ResolvedSweep& sweep,
                                                 const schema::JobSpec& job);

struct SyntheticWork {
  double seconds = 0;                         // that a job takes
  std::set<std::uint32_t> failing;            // viewpoints whose jobs fail
  std::set<std::uint32_t> crashing;           // viewpoints whose jobs kill the worker
  std::set<std::uint32_t> failing_heat = {};  // heat runs whose jobs fail
  std::set<std::uint32_t> wrong = {};         // viewpoints whose results have another last bit
  std::uint64_t needed_bytes = 0;             // that a view takes
  std::uint64_t memory_bytes = 0;             // that there are
};

// Refuses views without what each job that they need has left.
[[nodiscard]] RunnerFactory synthetic_runner(const SyntheticWork& work);

}  // namespace irsig
