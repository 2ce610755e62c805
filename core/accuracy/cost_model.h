#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string_view>
#include <vector>

#include "core/accuracy/measured.h"
#include "core/accuracy/pilot_samples.h"

namespace irsig {

// Predicted cost of a sweep, from pilots of a few of its views: arithmetic alone, nothing is traced
// here.
//
// A view's job takes a + b n^p seconds of CPU time for n samples a replicate (p < 1: the more rays,
// the nearer neighbours they are, and the faster each is traced); between counts that were tried it
// is as measured. The number of samples for a relative error is computed as in the job itself
// (core/signature/make_plan.cpp): by samples_needed from its own pilots of kFirstPilotSamples and,
// where that one asks for more than kSecondPilotSamples, of so many, with a third pilot where much
// more is asked for.

// One row of a view (a condition and a band).
struct RowPilot {
  std::vector<double> stderr_w_sr;  // [stage]
  // Results of the largest stage: |intensity|, the sum of the bias bounds but for undersampling,
  // and the undersampling error that this leaves.
  double value_w_sr = 0, bias_w_sr = 0, unseen_w_sr = 0;
  double floor_w_sr = 0;  // an error that is small enough whatever the value; 0: none
  BoundOf largest_bound = BoundOf::kTruncation;  // of those in bias_w_sr
};

// One point of a profile.
struct ProfilePointPilot {
  double stderr_wanted_k = 0;       // > 0, or
  std::uint64_t fixed_samples = 0;  // of a replicate
  // Standard errors of each row, at kFirstProfileSamples and kSecondProfileSamples; empty if the
  // count is fixed.
  std::vector<std::array<double, 2>> stderr_k;
};

struct ViewPilot {
  // Increasing; the first two are those of the job's own pilots (less: where the sweep allows no
  // more). [stage]
  std::vector<std::uint64_t> samples;
  // CPU time of all the view's jobs, which include the two pilots for a relative error. [stage]
  std::vector<double> cpu_s;
  double time_exponent = 1;  // p
  std::vector<RowPilot> row;
  std::vector<ProfilePointPilot> point;
  // CPU time of the profiles' points together, over samples a replicate of all of them together.
  double profile_cpu_s = 0, profile_cpu_s_per_sample = 0;
};

// Fits p of the views together, in [0.5, 1], from the first, second and last stage; 1 with fewer
// than three stages.
[[nodiscard]] double time_exponent(std::span<const ViewPilot> views);

// Exactly one of the first three is positive.
struct CountRule {
  double relative_error = 0, target_paths = 0;
  std::uint64_t samples_per_replicate = 0;
  std::uint64_t max_samples_per_replicate = 0;
};

struct ViewCost {
  std::uint64_t samples = 0;  // of a replicate, in the stored run
  double cpu_s = 0;           // of all the view's jobs
  // Counts of its rows: the rows that reach the relative error, and the others by reason.
  // at_floor: rows that stop because their error is not above the floor.
  std::uint32_t rows = 0, reached = 0, at_floor = 0, kept_by_bias = 0, kept_by_limit = 0;
  // Counts of the rows that reach neither, by what decides their error (limiting_part).
  std::map<std::string_view, std::uint32_t> limited;
};

// Computes the cost of a view.
//   target_paths_per_sample  of a replicate, all replicates together; for a rule of target paths
[[nodiscard]] ViewCost view_cost(const ViewPilot& pilot, const CountRule& rule,
                                 double target_paths_per_sample);

// Samples a replicate that a point's stored run will have.
[[nodiscard]] std::uint64_t profile_samples(const ProfilePointPilot& point,
                                            std::uint64_t max_samples_per_replicate);

// Returns the standard error at n samples: a power of n between the stages and beyond them, with an
// exponent of -0.5 to -0.7 beyond.
[[nodiscard]] double stderr_at(std::span<const std::uint64_t> samples,
                               std::span<const double> stderr_w_sr, std::uint64_t n);

// Returns the quantile q in [0, 1] of unsorted values, linear between them. Not empty.
[[nodiscard]] double quantile(std::vector<double> values, double q);

struct SweepCost {
  double cpu_s = 0, wall_s = 0;
  double job_cpu_quartile1_s = 0, job_cpu_median_s = 0, job_cpu_quartile3_s = 0;
  double median_samples = 0;
  // Fractions of the rows.
  double reached_fraction = 0, at_floor_fraction = 0, kept_by_bias_fraction = 0,
         kept_by_limit_fraction = 0;
  // Fractions of the rows that reach neither the error nor the floor, by what decides their error
  // (limiting_part).
  std::map<std::string_view, double> limited_fraction;
};

// Computes the cost of a sweep of `views` views of which some were piloted, each made of
// jobs_per_view jobs. Workers take the jobs in turn, after start_s each. The piloted views stand
// for equal numbers of views.
[[nodiscard]] SweepCost sweep_cost(std::span<const ViewCost> piloted, std::uint64_t views,
                                   std::uint64_t jobs_per_view, std::uint64_t workers,
                                   double start_s);

// Returns the standard error of the mean CPU time, relative to it: the scatter of the piloted
// views. 0 if all of the sweep's views were piloted.
[[nodiscard]] double relative_scatter(std::span<const ViewCost> piloted, std::uint64_t views);

// Indices of `count` of `views` views, spread evenly: those for a smaller count are among those for
// a larger one, in the same order. All if count >= views.
[[nodiscard]] std::vector<std::uint64_t> spread_views(std::uint64_t views, std::uint64_t count);

}  // namespace irsig
