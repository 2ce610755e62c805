#pragma once

#include <algorithm>
#include <cstdint>

#include "core/signature/simulator.h"
#include "schema/job.pb.h"

namespace irsig {

// The memory that the workers of one process hold while they compute a sweep, from counts alone.
// All conditions of a view are in memory at once, and the sun's effect on each condition's sky is
// kept from view to view.
struct JobMemory {
  double fixed_bytes = 0;          // program, scene, weights of paths
  double shared_bytes = 0;         // part of it that all workers of a process share
  double bytes_per_condition = 0;  // season x time
  double heat_bytes = 0;           // of a job that computes temperatures: before there are views

  // Returns the resident memory [bytes] with one worker, or with so many worker threads.
  [[nodiscard]] double bytes(std::uint64_t conditions) const {
    return fixed_bytes +
           std::max(heat_bytes, bytes_per_condition * static_cast<double>(conditions));
  }
  [[nodiscard]] double bytes(std::uint64_t conditions, std::uint32_t workers) const {
    return shared_bytes + workers * (bytes(conditions) - shared_bytes);
  }
  // Returns the number of conditions for which this number of workers has memory; 0: not even one.
  [[nodiscard]] std::uint64_t conditions_in(double bytes, std::uint32_t workers) const;
};

// Estimates the memory of a job.
//   environment  null without an atmosphere
//   emitters     number of emitters with temperatures of their own
//   field_bytes  size of the files and of the results of heat jobs that state temperatures
//   plume_bytes, land_bytes  size of hot gas and of the land in memory
// Accuracy: the largest resident size of a worker was 0.86 to 1.07 of the estimate in eight sweeps
// (vacuum and real air, 2 to 72 conditions, steps of 0.1 to 0.01 um, 5000 to 200 000 triangles).
// Workers then also loaded 118 MB of libraries; without them the ratio was 0.88, 0.86 and 0.82 in
// three sweeps. Heat jobs with 4000 and 20 000 facets, and two and a half days in steps of 10
// minutes, used 213 and 488 MB with these libraries; the estimates were 227 and 498 MB.
[[nodiscard]] JobMemory job_memory(const schema::ResolvedSweep& sweep, const Simulator& simulator,
                                   const Environment* environment, std::size_t emitters,
                                   std::size_t field_bytes, std::size_t plume_bytes,
                                   std::size_t land_bytes);

}  // namespace irsig
