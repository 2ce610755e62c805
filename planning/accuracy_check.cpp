#include "planning/accuracy_check.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/accuracy/cost_model.h"
#include "core/base/status_macros.h"
#include "core/study/effects_check.h"
#include "core/study/stated_errors.h"
#include "fmt/format.h"
#include "runner/spec_to_request.h"

namespace irsig {
namespace {

struct ViewRows {
  std::uint32_t viewpoint = 0;
  std::vector<StatedRow> row;
};

absl::StatusOr<StatedRow> stated_row(StoreReader& reader, const StoredSignature& s,
                                     std::uint64_t in_view, std::uint64_t bands) {
  if (s.physics_version != kPhysicsVersion || !s.reflections)
    return absl::FailedPreconditionError(
        absl::StrCat("row ", s.row, " was computed with physics version ", s.physics_version,
                     "; this program has ", kPhysicsVersion, ": run the sweep again first"));
  StatedRow out;
  out.condition = static_cast<std::uint32_t>(in_view / bands);
  out.band = static_cast<std::uint32_t>(in_view % bands);
  out.reflections = static_cast<std::uint32_t>(*s.reflections);
  const auto set = [&](Stated what, double value, double stderr_, double scale) -> StatedValue& {
    StatedValue& v = out.in_band[static_cast<std::size_t>(what)];
    v.value = value;
    v.stderr_ = stderr_;
    v.rounding = kRoundingRelative * std::abs(scale);
    return v;
  };
  const double background_w_sr = s.apparent_intensity_w_sr - s.contrast_intensity_w_sr;
  set(Stated::kIntensity, s.intensity_w_sr, s.intensity_stderr_w_sr, s.intensity_w_sr)
      .numerical_error = s.numerical_error_w_sr;
  set(Stated::kApparent, s.apparent_intensity_w_sr, s.apparent_intensity_stderr_w_sr,
      s.apparent_intensity_w_sr)
      .numerical_error = s.apparent_numerical_error_w_sr;
  set(Stated::kContrast, s.contrast_intensity_w_sr, s.contrast_intensity_stderr_w_sr,
      std::max(std::abs(s.apparent_intensity_w_sr), std::abs(background_w_sr)))
      .numerical_error = s.contrast_numerical_error_w_sr;
  set(Stated::kArea, s.projected_area_m2, s.projected_area_stderr_m2, s.projected_area_m2);
  ASSIGN_OR_RETURN(const auto spectrum, reader.spectrum(s.signature_id));
  for (int k = 0; k < spectrum.spectral_intensity_w_sr_um_size(); ++k) {
    StatedValue& v = out.spectrum.emplace_back();
    v.value = static_cast<double>(spectrum.spectral_intensity_w_sr_um(k));
    v.stderr_ = static_cast<double>(spectrum.spectral_intensity_stderr_w_sr_um(k));
    v.rounding = kRoundingRelative * std::abs(v.value);
  }
  return out;
}

// The rows of the current version of the sweep, view by view; `count` of the views, spread evenly.
absl::StatusOr<std::vector<ViewRows>> stored_views(StoreReader& reader,
                                                   const schema::ResolvedSweep& sweep,
                                                   std::uint64_t count) {
  SignatureFilter filter;
  filter.sweep = sweep.sweep().name();
  ASSIGN_OR_RETURN(const auto rows, reader.find(filter));
  const auto bands = static_cast<std::uint64_t>(sweep.sweep().band_size()),
             of_view = bands * static_cast<std::uint64_t>(sweep.condition_size());
  std::map<std::uint64_t, std::vector<const StoredSignature*>> views;
  for (const StoredSignature& s : rows)
    if (!s.superseded) views[(s.row - 1) / of_view].push_back(&s);
  if (views.empty())
    return absl::InvalidArgumentError(
        absl::StrCat("the sweep ", sweep.sweep().name(), " has no rows yet"));
  std::vector<std::uint64_t> chosen = spread_views(views.size(), count == 0 ? views.size() : count);
  std::sort(chosen.begin(), chosen.end());
  std::vector<ViewRows> out;
  for (const std::uint64_t i : chosen) {
    const auto& [view, stored] = *std::next(views.begin(), static_cast<std::ptrdiff_t>(i));
    ViewRows& v = out.emplace_back();
    v.viewpoint = static_cast<std::uint32_t>(view);
    for (const StoredSignature* s : stored) {
      ASSIGN_OR_RETURN(auto row, stated_row(reader, *s, (s->row - 1) % of_view, bands));
      v.row.push_back(std::move(row));
    }
  }
  return out;
}

class Checker {
 public:
  Checker(const schema::ResolvedSweep& sweep, const Simulator& simulator,
          std::shared_ptr<const Environment> environment, SweepTemperatures temperatures,
          std::shared_ptr<const LandScene> land, SweepPlumes plumes, std::vector<ViewRows> views,
          double times, const std::function<void(const CheckedViewpoint&)>& seen)
      : sweep_(sweep),
        simulator_(simulator),
        environment_(std::move(environment)),
        temperatures_(std::move(temperatures)),
        land_(std::move(land)),
        plumes_(std::move(plumes)),
        views_(std::move(views)),
        times_(times),
        seen_(seen),
        least_times_(times) {}

  absl::Status run(std::uint32_t workers) {
    std::vector<std::thread> threads;
    for (std::uint32_t i = 0; i < workers; ++i) threads.emplace_back([this] { work(); });
    for (std::thread& thread : threads) thread.join();
    return status_;
  }

  [[nodiscard]] std::vector<StatedRow> rows() const {
    std::vector<StatedRow> out;
    for (const ViewRows& view : views_) out.insert(out.end(), view.row.begin(), view.row.end());
    return out;
  }
  [[nodiscard]] double least_times() const { return least_times_; }
  [[nodiscard]] std::size_t views() const { return views_.size(); }

 private:
  void work() {
    for (;;) {
      const std::size_t i = next_++;
      if (i >= views_.size()) return;
      auto checked = check(views_[i]);
      const std::lock_guard lock(mutex_);
      if (!status_.ok()) return;
      if (!checked.ok()) {
        status_ = {checked.status().code(), absl::StrCat("viewpoint ", views_[i].viewpoint, ": ",
                                                         checked.status().message())};
        return;
      }
      least_times_ = std::min(least_times_, checked->times);
      seen_({++done_, views_.size(), views_[i].viewpoint, static_cast<double>(checked->samples),
             summary_of(checked->row, Stated::kIntensity)});
      views_[i].row = std::move(checked->row);
    }
  }

  [[nodiscard]] absl::StatusOr<CheckedErrors> check(const ViewRows& view) const {
    schema::ViewJob job;
    job.set_viewpoint_index(view.viewpoint);
    ASSIGN_OR_RETURN(auto request,
                     request_from_job(sweep_, job, environment_, temperatures_, land_, plumes_));
    LongerRun longer;
    longer.times = times_;
    // As the worker has it (runner/job_runner.cpp).
    const schema::Accuracy& accuracy = sweep_.sweep().accuracy();
    if (accuracy.has_relative_error() && accuracy.has_samples_per_replicate())
      longer.row_samples = accuracy.samples_per_replicate();
    return check_stated_errors(simulator_, std::move(request), view.row, longer);
  }

  const schema::ResolvedSweep& sweep_;
  const Simulator& simulator_;
  std::shared_ptr<const Environment> environment_;
  SweepTemperatures temperatures_;
  std::shared_ptr<const LandScene> land_;
  SweepPlumes plumes_;
  std::vector<ViewRows> views_;
  double times_;
  const std::function<void(const CheckedViewpoint&)>& seen_;
  std::atomic<std::size_t> next_ = 0;
  std::mutex mutex_;  // of what follows, and of each view's rows
  double least_times_;
  std::size_t done_ = 0;
  absl::Status status_;
};

}  // namespace

absl::StatusOr<CheckedDatabase> check_database_errors(
    AccuracySource& source, const ErrorCheckAsked& asked,
    const std::function<void(const CheckedViewpoint&)>& seen) {
  const schema::ResolvedSweep& sweep = source.loaded.resolved;
  ASSIGN_OR_RETURN(auto views, stored_views(*source.database, sweep, asked.views));
  RETURN_IF_ERROR(have_temperatures(source.loaded));
  ASSIGN_OR_RETURN(const auto scene,
                   scene_from_sweep(sweep, source.loaded.assets, source.loaded.heat));
  ASSIGN_OR_RETURN(const auto simulator, Simulator::create(scene));
  ASSIGN_OR_RETURN(const auto environment, environment_from_sweep(sweep, simulator->band_grids()));
  ASSIGN_OR_RETURN(auto plumes, plumes_from_sweep(sweep, source.loaded.assets));
  Checker checker(sweep, *simulator, environment, scene.temperatures, scene.land, std::move(plumes),
                  std::move(views), asked.times, seen);
  const std::uint32_t workers =
      asked.workers > 0 ? asked.workers : std::max(std::thread::hardware_concurrency(), 1u);
  RETURN_IF_ERROR(checker.run(workers));
  return CheckedDatabase{checker.rows(), checker.views(), checker.least_times()};
}

}  // namespace irsig
