#include "planning/sweep_pilot.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/accuracy/replicates.h"
#include "core/base/status_macros.h"
#include "jobs/keys/expand.h"
#include "planning/pilot_farm.h"
#include "planning/time_budget.h"
#include "schema/shard.h"
#include "schema/store/rows.h"
#include "view/rows/measured_row.h"

namespace irsig {
namespace {

constexpr std::uint64_t kViewsAtFirst = 5, kViewsMore = 5, kViewsAtMost = 15;
constexpr double kScatter = 0.1;
// Of more than one and a half times so many conditions the pilot does these, and a few of them once
// more: the difference is what a condition costs.
constexpr int kConditions = 24, kFewConditions = 6;

// So many conditions, in their order: those with the most and the least light and the highest and
// lowest temperatures, and others in the middles of the widest gaps between.
std::vector<int> chosen_conditions(const schema::ResolvedSweep& sweep) {
  const int all = sweep.condition_size();
  std::set<int> chosen;
  const auto extremes = [&](const auto& value) {
    int least = 0, most = 0;
    for (int c = 1; c < all; ++c) {
      if (value(sweep.condition(c)) < value(sweep.condition(least))) least = c;
      if (value(sweep.condition(c)) > value(sweep.condition(most))) most = c;
    }
    chosen.insert({least, most});
  };
  extremes([](const schema::Condition& c) { return c.sun_irradiance_w_m2(); });
  extremes([](const schema::Condition& c) { return c.air_temperature_k(); });
  extremes([](const schema::Condition& c) {
    return std::accumulate(c.part_temperature_k().begin(), c.part_temperature_k().end(), 0.0);
  });
  while (chosen.size() < kConditions) {
    int widest = 0, begin = 0;
    for (auto at = chosen.begin(); at != chosen.end(); ++at) {
      const auto next = std::next(at);  // after the last comes the first
      const int gap = (next == chosen.end() ? all + *chosen.begin() : *next) - *at;
      if (gap <= widest) continue;
      widest = gap;
      begin = *at;
    }
    chosen.insert((begin + widest / 2) % all);
  }
  return {chosen.begin(), chosen.end()};
}

// These alone, each a season of its own: conditions are seasons x times.
void keep_conditions(schema::ResolvedSweep& sweep, const std::vector<int>& kept) {
  schema::ResolvedSweep out = sweep;
  out.clear_condition();
  out.mutable_sweep()->clear_season();
  out.mutable_sweep()->clear_time();
  out.mutable_sweep()->add_time(sweep.sweep().time(0));
  for (const int c : kept) {
    schema::Condition& condition = *out.add_condition();
    condition = sweep.condition(c);
    *out.mutable_sweep()->add_season() =
        sweep.sweep().season(static_cast<int>(condition.season_index()));
    condition.set_season_index(static_cast<std::uint32_t>(out.condition_size() - 1));
    condition.set_time_index(0);
  }
  sweep = std::move(out);
}

std::uint64_t jobs_per_view(schema::ResolvedSweep sweep) {
  sweep.clear_shard();
  while (sweep.viewpoint_size() > 1) sweep.mutable_viewpoint()->RemoveLast();
  const std::vector<schema::JobSpec> jobs = expand_jobs(sweep, physics_version());
  return static_cast<std::uint64_t>(
      std::count_if(jobs.begin(), jobs.end(), [](const auto& job) { return job.has_view(); }));
}

// The job size at which a sweep's views are cut into so many jobs: what is cut depends on the
// accuracy, and the pilot's is another.
void cut_into(schema::ResolvedSweep& sweep, std::uint64_t pieces) {
  double low = 0, high = 18;  // powers of ten, as sweeps may have them
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    sweep.mutable_sweep()->mutable_transport()->set_job_size_vertices(std::pow(10, middle));
    const std::uint64_t cut = jobs_per_view(sweep);
    if (cut == pieces) return;
    (cut > pieces ? low : high) = middle;
  }
}

class Planner {
 public:
  Planner(const LoadedSweep& loaded, PilotFarm& farm) : loaded_(loaded), farm_(farm) {
    const auto& accuracy = loaded.resolved.sweep().accuracy();
    pilot_.rule = {.relative_error = accuracy.relative_error(),
                   .target_paths = accuracy.target_paths(),
                   .samples_per_replicate = accuracy.samples_per_replicate(),
                   .max_samples_per_replicate = accuracy.max_samples_per_replicate()};
    pilot_.views = shard_size(loaded.resolved);
    pilot_.jobs_per_view = jobs_per_view(loaded.resolved);
    int conditions = loaded.resolved.condition_size();
    if (2 * conditions > 3 * kConditions) {
      condition_ = chosen_conditions(loaded.resolved);
      left_out_ = std::exchange(conditions, kConditions) - kConditions;
    }
    rows_ = static_cast<std::size_t>(conditions) *
            static_cast<std::size_t>(loaded.resolved.sweep().band_size());
  }

  absl::StatusOr<SweepPilot> run() {
    ASSIGN_OR_RETURN(const auto before, farm_.bytes());
    const auto model = static_cast<double>(bytes_of(loaded_.assets));
    pilot_.database_fixed_bytes = before + model + stored_sweep_bytes(loaded_.resolved);
    std::uint64_t wanted = kViewsAtFirst;
    do {
      RETURN_IF_ERROR(add_views(wanted));
      wanted += kViewsMore;
    } while (wanted <= kViewsAtMost &&
             relative_scatter(view_costs(pilot_, pilot_.rule), pilot_.views) > kScatter);
    ASSIGN_OR_RETURN(const auto after, farm_.bytes());
    pilot_.database_bytes_per_view = (1 + static_cast<double>(left_out_) / kConditions) *
                                     (after - before - model - sweep_bytes_ - few_bytes_) /
                                     static_cast<double>(computed_views_);
    add_left_out();
    if (loaded_.resolved.sweep().profile_size() > 0) {
      RETURN_IF_ERROR(add_profiles(after));
    }
    pilot_.cpu_s = farm_.cpu_s();
    return pilot_;
  }

 private:
  static double stored_sweep_bytes(const schema::ResolvedSweep& sweep) {
    return static_cast<double>(sweep.ByteSizeLong());
  }

  // The sweep with these views, so many samples and no profiles.
  schema::ResolvedSweep with_count(const std::vector<std::uint64_t>& views, std::uint64_t samples) {
    schema::ResolvedSweep sweep = loaded_.resolved;
    sweep.clear_viewpoint();
    for (const std::uint64_t view : views)
      *sweep.add_viewpoint() =
          loaded_.resolved.viewpoint(static_cast<int>(shard_viewpoint(loaded_.resolved, view)));
    sweep.clear_shard();
    sweep.mutable_sweep()->clear_profile();
    sweep.mutable_sweep()->clear_published();
    if (pilot_.rule.relative_error > 0) {
      // With the effects that the error calls for, and so many samples.
      auto* accuracy = sweep.mutable_sweep()->mutable_accuracy();
      accuracy->set_samples_per_replicate(samples);
      accuracy->set_max_samples_per_replicate(samples);
    } else {
      sweep = with_samples(std::move(sweep), samples);
    }
    if (condition_.empty()) {
      cut_into(sweep, pilot_.jobs_per_view);
    } else {
      keep_conditions(sweep, condition_);
      cut_into(sweep, 1);
    }
    sweep_bytes_ += stored_sweep_bytes(sweep);
    computed_views_ += views.size();
    return sweep;
  }

  // The same views and samples with a few of the chosen conditions.
  absl::Status run_few(const std::vector<std::uint64_t>& views, std::uint64_t samples,
                       bool warm_up) {
    ASSIGN_OR_RETURN(const auto before, farm_.bytes());
    const double sweep_bytes = sweep_bytes_;
    const std::uint64_t computed = computed_views_;
    schema::ResolvedSweep few = with_count(views, samples);
    sweep_bytes_ = sweep_bytes;
    computed_views_ = computed;
    std::vector<int> kept;
    for (int i = 0; i < kFewConditions; ++i) kept.push_back(i * kConditions / kFewConditions);
    keep_conditions(few, kept);
    cut_into(few, 1);
    ASSIGN_OR_RETURN(auto done, farm_.run({std::move(few)}));
    for (std::size_t at = warm_up ? 1 : 0; at < views.size(); ++at)
      few_cpu_s_.push_back(done.front().cpu_s(at));
    ASSIGN_OR_RETURN(const auto after, farm_.bytes());
    few_bytes_ += after - before;
    return absl::OkStatus();
  }

  // What the conditions cost that were left out; and each of the jobs that a view is cut into
  // traces all paths.
  void add_left_out() {
    for (std::size_t v = 0; v < few_cpu_s_.size(); ++v) {
      ViewPilot& view = pilot_.view[v];
      const double each =
          std::max(0.0, view.cpu_s[1] - few_cpu_s_[v]) / (kConditions - kFewConditions);
      for (double& cpu_s : view.cpu_s)
        cpu_s += left_out_ * each + static_cast<double>(pilot_.jobs_per_view - 1) *
                                        std::max(0.0, cpu_s - kConditions * each);
    }
    if (few_cpu_s_.empty()) return;
    const double exponent = time_exponent(pilot_.view);
    for (ViewPilot& view : pilot_.view) view.time_exponent = exponent;
  }

  // The next views, at all stages; the first that each worker computes pays for cold caches, and is
  // left out where there are enough.
  absl::Status add_views(std::uint64_t wanted) {
    const auto chosen = spread_views(pilot_.views, wanted);
    std::vector<std::uint64_t> views(
        chosen.begin() + static_cast<std::ptrdiff_t>(pilot_.view.size()), chosen.end());
    if (views.empty()) return absl::OkStatus();
    const bool warm_up = pilot_.views > wanted;
    if (warm_up) views.insert(views.begin(), spread_views(pilot_.views, wanted + 1).back());
    const std::size_t first = pilot_.view.size();
    pilot_.view.resize(chosen.size());
    std::vector<std::uint64_t> counts = {kFirstPilotSamples, kSecondPilotSamples};
    for (std::uint64_t& n : counts) n = std::min(n, pilot_.rule.max_samples_per_replicate);
    if (further_ > 0) counts.push_back(further_);
    RETURN_IF_ERROR(run_stages(views, counts, first, warm_up));
    if (!condition_.empty()) RETURN_IF_ERROR(run_few(views, counts[1], warm_up));
    if (first > 0) return absl::OkStatus();
    // Far beyond the second pilot, another stage: where the job's own third pilot will be, or a
    // quarter of what is needed.
    std::vector<double> needed;
    for (const ViewCost& cost : view_costs(pilot_, pilot_.rule))
      needed.push_back(static_cast<double>(cost.samples));
    const auto n = static_cast<std::uint64_t>(quantile(needed, 0.5));
    if (n <= 4 * kSecondPilotSamples) return absl::OkStatus();
    further_ = std::bit_floor(n >= 32 * kSecondPilotSamples ? n / 16 : n / 4);
    return run_stages(views, {further_}, first, warm_up);
  }

  absl::Status run_stages(const std::vector<std::uint64_t>& views,
                          const std::vector<std::uint64_t>& counts, std::size_t first,
                          bool warm_up) {
    // Without a view to warm up with, each stage has a worker of its own: all are equally cold, as
    // the run's own first job is.
    std::vector<std::vector<schema::ResolvedSweep>> runs(warm_up ? 1 : counts.size());
    for (std::size_t s = 0; s < counts.size(); ++s)
      runs[warm_up ? 0 : s].push_back(with_count(views, counts[s]));
    std::vector<PilotStage> stages;
    for (auto& sweeps : runs) {
      const double cpu_before = farm_.cpu_s();
      const auto count = static_cast<double>(sweeps.size());
      ASSIGN_OR_RETURN(auto done, farm_.run(std::move(sweeps)));
      if (pilot_.start_s == 0)
        pilot_.start_s = std::max(0.0, farm_.wall_s() - (farm_.cpu_s() - cpu_before)) / count;
      for (PilotStage& stage : done) stages.push_back(std::move(stage));
    }
    for (std::size_t s = 0; s < counts.size(); ++s) {
      const PilotStage& stage = stages[s];
      for (std::size_t at = warm_up ? 1 : 0; at < views.size(); ++at) {
        ViewPilot& view = pilot_.view[first + at - (warm_up ? 1 : 0)];
        view.samples.push_back(counts[s]);
        view.cpu_s.push_back(stage.cpu_s(at));
        view.row.resize(rows_);
      }
      for (const StoredSignature& row : stage.rows) {
        const std::size_t at = (row.row - 1) / rows_;
        if (warm_up && at == 0) continue;
        RowPilot& out = pilot_.view[first + at - (warm_up ? 1 : 0)].row[(row.row - 1) % rows_];
        out.stderr_w_sr.push_back(row.intensity_stderr_w_sr);
        out.value_w_sr = std::abs(row.intensity_w_sr);
        // Samples mend what was not seen, and none of the other bounds.
        Measured lasting = source_of(row);
        out.unseen_w_sr = numerical_error(0, lasting.undersampling_stderr,
                                          std::exchange(lasting.of(BoundOf::kUnseen), 0));
        out.bias_w_sr = lasting.bias_bound();
        out.largest_bound =
            static_cast<BoundOf>(std::ranges::max_element(lasting.bound) - lasting.bound.begin());
        out.floor_w_sr = row.absolute_floor_w_sr;
      }
      if (s + 1 == counts.size()) keep_ledgers(stage, warm_up);
      double paths = 0, jobs = 0;
      for (const StoredJobCost& job : stage.jobs) {
        paths += static_cast<double>(job.target_paths);
        ++jobs;
      }
      pilot_.target_paths_per_sample = paths / jobs / static_cast<double>(counts[s]);
    }
    const double exponent = time_exponent(pilot_.view);
    for (ViewPilot& view : pilot_.view) view.time_exponent = exponent;
    return absl::OkStatus();
  }

  void keep_ledgers(const PilotStage& stage, bool warm_up) {
    for (std::size_t i = 0; i < stage.rows.size(); ++i) {
      const StoredSignature& row = stage.rows[i];
      if (warm_up && (row.row - 1) / rows_ == 0) continue;
      // A later stage of the same views takes their place.
      const auto same =
          std::find_if(pilot_.ledger.begin(), pilot_.ledger.end(), [&](const LedgerRow& known) {
            const StoredSignature& s = known.signature;
            return s.season == row.season && s.time_utc == row.time_utc && s.band == row.band &&
                   s.aspect_azimuth_deg == row.aspect_azimuth_deg &&
                   s.aspect_elevation_deg == row.aspect_elevation_deg && s.range_m == row.range_m;
          });
      LedgerRow kept{row, stage.ledgers[i]};
      kept.signature.sweep = loaded_.resolved.sweep().name();
      if (same == pilot_.ledger.end())
        pilot_.ledger.push_back(std::move(kept));
      else
        *same = std::move(kept);
    }
  }

  // Profiles of the same views at two sample counts, and at an eighth of what these say.
  absl::Status add_profiles(double bytes_before) {
    const auto views = spread_views(pilot_.views, pilot_.view.size());
    const auto& asked = loaded_.resolved.sweep();
    const double replicates = asked.accuracy().replicates();
    const double sweep_bytes_before = sweep_bytes_;
    const std::uint64_t computed_before = computed_views_;
    const auto with_profiles = [&](const std::vector<double>& samples) {
      schema::ResolvedSweep sweep =
          with_count(views, std::min(kFirstPilotSamples, pilot_.rule.max_samples_per_replicate));
      for (int p = 0; p < asked.profile_size(); ++p) {
        schema::Profile& profile = *sweep.mutable_sweep()->add_profile();
        profile = asked.profile(p);
        profile.clear_apparent_temperature_stderr_k();
        profile.set_samples(samples[static_cast<std::size_t>(p)] * replicates);
      }
      cut_into(sweep, condition_.empty() ? pilot_.jobs_per_view : 1);
      return sweep;
    };
    std::vector<std::uint64_t> points;
    double all_points = 0;
    for (const schema::Profile& profile : asked.profile()) {
      points.push_back(profile.at_m_size() > 0 ? 1 : profile.points());
      all_points += static_cast<double>(points.back());
    }
    const auto first_samples = static_cast<double>(kFirstProfileSamples),
               second_samples = static_cast<double>(kSecondProfileSamples);
    ASSIGN_OR_RETURN(
        auto stages,
        farm_.run({with_profiles(std::vector<double>(points.size(), first_samples)),
                   with_profiles(std::vector<double>(points.size(), second_samples))}));
    for (std::size_t v = 0; v < views.size(); ++v) set_points(v, points, replicates, stages);
    // Rows of different profiles take different times: the last stage has them in proportion.
    std::vector<double> share(points.size(), second_samples);
    double largest = all_points * second_samples;
    for (std::size_t p = 0, at = 0; p < points.size(); at += points[p++]) {
      double needed = 0;
      for (const ViewPilot& view : pilot_.view)
        for (std::size_t i = 0; i < points[p]; ++i)
          needed += static_cast<double>(
              profile_samples(view.point[at + i], pilot_.rule.max_samples_per_replicate));
      needed /= static_cast<double>(points[p] * pilot_.view.size());
      share[p] = std::max(16.0, std::floor(needed / 8 / 16) * 16);
    }
    double proportional = 0;
    for (std::size_t p = 0; p < points.size(); ++p)
      proportional += share[p] * static_cast<double>(points[p]);
    if (proportional > 2 * all_points * first_samples) {
      ASSIGN_OR_RETURN(auto last, farm_.run({with_profiles(share)}));
      stages.push_back(last.front());
      largest = proportional;
    }
    const double fewest = all_points * first_samples;
    for (std::size_t v = 0; v < views.size(); ++v) {
      ViewPilot& view = pilot_.view[v];
      const double fast = stages.front().cpu_s(v), slow = stages.back().cpu_s(v);
      view.profile_cpu_s_per_sample = std::max(0.0, (slow - fast) / (largest - fewest));
      view.profile_cpu_s =
          std::max(0.0, fast - view.cpu_s.front() - view.profile_cpu_s_per_sample * fewest);
    }
    ASSIGN_OR_RETURN(const auto after, farm_.bytes());
    pilot_.database_bytes_per_view = (after - bytes_before - (sweep_bytes_ - sweep_bytes_before)) /
                                     static_cast<double>(computed_views_ - computed_before);
    return absl::OkStatus();
  }

  void set_points(std::size_t v, const std::vector<std::uint64_t>& points, double replicates,
                  const std::vector<PilotStage>& stages) {
    std::vector<ProfilePointPilot>& out = pilot_.view[v].point;
    std::vector<std::size_t> first;
    const auto& asked = loaded_.resolved.sweep();
    for (std::size_t p = 0; p < points.size(); ++p) {
      first.push_back(out.size());
      ProfilePointPilot point;
      const schema::Profile& profile = asked.profile(static_cast<int>(p));
      if (profile.samples() > 0)
        point.fixed_samples =
            static_cast<std::uint64_t>(std::ceil(profile.samples() / replicates / 16) * 16);
      else
        point.stderr_wanted_k = profile.apparent_temperature_stderr_k();
      out.insert(out.end(), points[p], point);
    }
    // Both stages list the same rows in the same order.
    for (std::size_t i = 0; i < stages[0].profile.size(); ++i) {
      const StoredProfileRow &few = stages[0].profile[i], &many = stages[1].profile[i];
      if ((few.row - 1) / rows_ != v) continue;
      ProfilePointPilot& point = out[first[few.profile_index] + few.point_index];
      if (point.fixed_samples == 0)
        point.stderr_k.push_back(
            {few.apparent_temperature_stderr_k, many.apparent_temperature_stderr_k});
    }
  }

  const LoadedSweep& loaded_;
  PilotFarm& farm_;
  SweepPilot pilot_;
  std::size_t rows_ = 0;
  std::vector<int> condition_;     // that the pilot does; empty: all
  int left_out_ = 0;               // conditions
  std::vector<double> few_cpu_s_;  // [view] with a few conditions and the second count of samples
  double few_bytes_ = 0;           // that the database keeps of these
  std::uint64_t further_ = 0;      // a third stage; 0: none
  double sweep_bytes_ = 0;         // what the database keeps of the pilot's sweeps themselves
  std::uint64_t computed_views_ = 0;
};

}  // namespace

absl::StatusOr<SweepPilot> pilot_sweep(const LoadedSweep& loaded, PilotFarm& farm) {
  return Planner(loaded, farm).run();
}

absl::StatusOr<SweepPilot> pilot_sweep(const LoadedSweep& loaded) {
  if (has_time_budget(loaded.resolved))
    return absl::FailedPreconditionError("a time budget has yet to be turned into samples");
  ASSIGN_OR_RETURN(auto farm, start_pilot_farm(loaded.assets));
  return pilot_sweep(loaded, *farm);
}

std::vector<ViewCost> view_costs(const SweepPilot& pilot, const CountRule& rule) {
  std::vector<ViewCost> costs;
  for (const ViewPilot& view : pilot.view)
    costs.push_back(view_cost(view, rule, pilot.target_paths_per_sample));
  return costs;
}

}  // namespace irsig
