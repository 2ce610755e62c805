#include "planning/sweep_pilot.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/accuracy/replicates.h"
#include "core/base/status_macros.h"
#include "jobs/keys/expand.h"
#include "messages/environment/condition_sun.h"
#include "planning/pilot_farm.h"
#include "planning/time_budget.h"
#include "schema/shard.h"
#include "schema/store/tables/rows.h"
#include "view/rows/measured_row.h"

namespace irsig {
namespace {

constexpr std::uint64_t kViewsAtFirst = 5, kViewsMore = 5, kViewsAtMost = 15;
constexpr double kScatter = 0.1;
// From 1.5 kConditions on, the pilot computes kConditions conditions only. With the fewest samples
// it then computes kFewConditions of them once more, or kMoreConditions of a sweep with more than
// kMany: the difference gives the cost of one condition. The error of this difference counts once
// for each condition left out: with 288 conditions, 12 against 3 were off by a factor of six on a
// busy machine.
constexpr int kConditions = 12, kFewConditions = 3, kMoreConditions = 36, kMany = 60;
constexpr std::size_t kOtherViews = 2;
// Cost of a condition with the sun above the horizon, relative to one at night: its sky varies with
// azimuth, and paths sample its sun.
constexpr double kSunny = 2.5;

// Returns the sine of the sun's elevation; -1: the sweep has no sun.
double sine_of_sun(const schema::ResolvedSweep& sweep, const schema::Condition& c) {
  if (!sweep.sweep().transport().sun()) return -1;
  const auto sun = condition_sun(sweep, c);
  return sun.ok() ? std::cos(sun->zenith_deg * std::numbers::pi / 180) : -1;
}

// Returns the costs of all conditions in the unit of one at night, in their order.
std::vector<double> relative_costs(const schema::ResolvedSweep& sweep) {
  std::vector<double> out;
  for (const schema::Condition& c : sweep.condition())
    out.push_back(sine_of_sun(sweep, c) > 0 ? kSunny : 1);
  return out;
}

// Returns `count` conditions, in their order: those with the highest, the lowest visible and the
// deepest sun, the most and the least light and the highest and lowest temperatures, and others in
// the middles of the widest gaps between.
std::vector<int> chosen_conditions(const schema::ResolvedSweep& sweep, std::size_t count) {
  const int all = sweep.condition_size();
  std::set<int> chosen;
  const auto extremes = [&](const auto& value) {
    int least = 0, most = 0;
    for (int c = 1; c < all; ++c) {
      if (value(c) < value(least)) least = c;
      if (value(c) > value(most)) most = c;
    }
    chosen.insert({least, most});
  };
  std::vector<double> sine;
  for (const schema::Condition& c : sweep.condition()) sine.push_back(sine_of_sun(sweep, c));
  const auto at = [&](int c) -> const schema::Condition& { return sweep.condition(c); };
  extremes([&](int c) { return sine[static_cast<std::size_t>(c)]; });
  extremes([&](int c) {  // just above the horizon, and highest again
    const double s = sine[static_cast<std::size_t>(c)];
    return s > 0 ? s : 2;
  });
  extremes([&](int c) { return at(c).sun_irradiance_w_m2(); });
  extremes([&](int c) { return at(c).air_temperature_k(); });
  extremes([&](int c) {
    return std::accumulate(at(c).part_temperature_k().begin(), at(c).part_temperature_k().end(),
                           0.0);
  });
  while (chosen.size() < count) {
    int widest = 0, begin = 0;
    for (auto it = chosen.begin(); it != chosen.end(); ++it) {
      const auto next = std::next(it);  // after the last comes the first
      const int gap = (next == chosen.end() ? all + *chosen.begin() : *next) - *it;
      if (gap <= widest) continue;
      widest = gap;
      begin = *it;
    }
    chosen.insert((begin + widest / 2) % all);
  }
  return {chosen.begin(), chosen.end()};
}

// Takes out what inputs change of temperatures: it is no part of what a view costs, and takes more
// time than the temperatures themselves. Such runs are the last.
void drop_changes(schema::ResolvedSweep& sweep) {
  auto& runs = *sweep.mutable_heat();
  runs.erase(std::remove_if(runs.begin(), runs.end(),
                            [](const schema::HeatRun& run) { return run.input_size() > 0; }),
             runs.end());
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
      condition_ = chosen_conditions(loaded.resolved, kConditions);
      if (conditions > kMany) {
        other_ = chosen_conditions(loaded.resolved, kMoreConditions);
      } else {
        for (int i = 0; i < kFewConditions; ++i)
          other_.push_back(condition_[static_cast<std::size_t>(i * kConditions / kFewConditions)]);
      }
      const std::vector<double> cost = relative_costs(loaded.resolved);
      for (const int c : condition_) cost_chosen_ += cost[static_cast<std::size_t>(c)];
      for (const int c : other_) cost_other_ += cost[static_cast<std::size_t>(c)];
      cost_left_out_ = std::accumulate(cost.begin(), cost.end(), 0.0) - cost_chosen_;
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
                                     (after - before - model - sweep_bytes_ - other_bytes_) /
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
    return with_count(views, samples, condition_);
  }
  //   conditions  of the sweep; none: all
  schema::ResolvedSweep with_count(const std::vector<std::uint64_t>& views, std::uint64_t samples,
                                   const std::vector<int>& conditions) {
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
      drop_changes(sweep);
    } else {
      sweep = with_samples(std::move(sweep), samples);
    }
    if (conditions.empty()) {
      cut_into(sweep, pilot_.jobs_per_view);
    } else {
      keep_conditions(sweep, conditions);
      cut_into(sweep, 1);
    }
    sweep_bytes_ += stored_sweep_bytes(sweep);
    computed_views_ += views.size();
    return sweep;
  }

  // The first of the views with the other conditions, at the first count of samples.
  //   at  of the first of them, in the pilot's order
  absl::Status run_other(std::vector<std::uint64_t> views, std::uint64_t samples, bool warm_up,
                         std::size_t at) {
    if (warm_up) views.resize(std::min(views.size(), 1 + kOtherViews));
    ASSIGN_OR_RETURN(const auto before, farm_.bytes());
    const double sweep_bytes = sweep_bytes_;
    const std::uint64_t computed = computed_views_;
    schema::ResolvedSweep other = with_count(views, samples, other_);
    sweep_bytes_ = sweep_bytes;
    computed_views_ = computed;
    ASSIGN_OR_RETURN(auto done, farm_.run({std::move(other)}));
    for (std::size_t k = warm_up ? 1 : 0; k < views.size(); ++k, ++at) {
      cost_more_s_ += done.front().cpu_s(k) - pilot_.view[at].cpu_s[0];
      ++other_views_;
    }
    ASSIGN_OR_RETURN(const auto after, farm_.bytes());
    other_bytes_ += after - before;
    return absl::OkStatus();
  }

  // Adds the cost of the conditions that were left out. Each job that a view is divided into traces
  // all paths, so that the cost of the paths counts once for each job.
  void add_left_out() {
    if (other_views_ == 0) return;
    // The cost of a condition at night.
    const double each = std::max(
        0.0, cost_more_s_ / static_cast<double>(other_views_) / (cost_other_ - cost_chosen_));
    for (ViewPilot& view : pilot_.view)
      for (double& cpu_s : view.cpu_s)
        cpu_s += cost_left_out_ * each + static_cast<double>(pilot_.jobs_per_view - 1) *
                                             std::max(0.0, cpu_s - cost_chosen_ * each);
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
    if (!condition_.empty()) RETURN_IF_ERROR(run_other(views, counts[0], warm_up, first));
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
    // A worker has the scene of a stage for the next one, too: the first alone pays for it.
    const std::vector<std::uint64_t> warm(views.begin() + (warm_up ? 1 : 0), views.end());
    for (std::size_t s = 0; s < counts.size(); ++s)
      runs[warm_up ? 0 : s].push_back(with_count(s == 0 ? views : warm, counts[s]));
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
      const std::size_t skipped = warm_up && s == 0 ? 1 : 0;
      for (std::size_t at = skipped; at < skipped + warm.size(); ++at) {
        ViewPilot& view = pilot_.view[first + at - skipped];
        view.samples.push_back(counts[s]);
        view.cpu_s.push_back(stage.cpu_s(at));
        view.row.resize(rows_);
      }
      for (const StoredSignature& row : stage.rows) {
        const std::size_t at = (row.row - 1) / rows_;
        if (at < skipped) continue;
        RowPilot& out = pilot_.view[first + at - skipped].row[(row.row - 1) % rows_];
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
      if (s + 1 == counts.size()) keep_ledgers(stage, skipped);
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

  void keep_ledgers(const PilotStage& stage, std::size_t skipped) {
    for (std::size_t i = 0; i < stage.rows.size(); ++i) {
      const StoredSignature& row = stage.rows[i];
      if ((row.row - 1) / rows_ < skipped) continue;
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
        profile.clear_source_radiance_temperature_stderr_k();
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
        point.stderr_wanted_k = profile.source_radiance_temperature_stderr_k();
      out.insert(out.end(), points[p], point);
    }
    // Both stages list the same rows in the same order.
    for (std::size_t i = 0; i < stages[0].profile.size(); ++i) {
      const StoredProfileRow &few = stages[0].profile[i], &many = stages[1].profile[i];
      if ((few.row - 1) / rows_ != v) continue;
      ProfilePointPilot& point = out[first[few.profile_index] + few.point_index];
      if (point.fixed_samples == 0)
        point.stderr_k.push_back(
            {few.source_radiance_temperature_stderr_k, many.source_radiance_temperature_stderr_k});
    }
  }

  const LoadedSweep& loaded_;
  PilotFarm& farm_;
  SweepPilot pilot_;
  std::size_t rows_ = 0;
  std::vector<int> condition_;  // that the pilot does; empty: all
  int left_out_ = 0;            // conditions
  std::vector<int> other_;      // to be done once more
  // Costs of the chosen conditions, of those computed once more, and of those left out, in the unit
  // of relative_costs.
  double cost_chosen_ = 0, cost_other_ = 0, cost_left_out_ = 0;
  double cost_more_s_ = 0;         // of the others, over that of the chosen: all views together
  std::uint64_t other_views_ = 0;  // of that sum
  double other_bytes_ = 0;         // that the database keeps of the others
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
