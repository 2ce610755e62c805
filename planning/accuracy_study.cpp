#include "planning/accuracy_study.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <memory>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/geo/sun.h"
#include "core/study/precompute.h"
#include "core/study/work_precision.h"
#include "fmt/format.h"
#include "planning/accuracy_effects.h"
#include "runner/spec_to_request.h"

namespace irsig {
namespace {

double process_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// A scene of the sweep, perhaps changed, with the request for one view of it.
struct BuiltScene {
  std::unique_ptr<Simulator> simulator;
  ViewRequest request;
  std::unique_ptr<ViewEstimator> estimator;
  double scene_cpu_s = 0, view_cpu_s = 0;  // what building them took
};

struct SceneChange {
  TracerOptions tracer;
  // One band alone, in other steps.
  std::optional<std::pair<int, double>> band_and_step_um;
};

struct Place {
  Viewpoint viewpoint;
  std::vector<std::uint32_t> condition;  // those that will be asked for
};

absl::StatusOr<std::unique_ptr<BuiltScene>> build(const LoadedSweep& loaded, const Place& place,
                                                  const SceneChange& change) {
  schema::ResolvedSweep resolved = loaded.resolved;
  schema::Sweep& sweep = *resolved.mutable_sweep();
  sweep.mutable_accuracy()->clear_relative_error();
  sweep.mutable_accuracy()->clear_target_paths();
  sweep.mutable_accuracy()->clear_time_budget_s();
  sweep.mutable_accuracy()->set_samples_per_replicate(1);
  sweep.mutable_output()->set_thumbnail_px(0);
  if (change.band_and_step_um) {
    schema::Band band = sweep.band(change.band_and_step_um->first);
    band.set_step_um(change.band_and_step_um->second);
    sweep.clear_band();
    *sweep.add_band() = band;
  }
  auto out = std::make_unique<BuiltScene>();
  const double start_s = process_cpu_s();
  ASSIGN_OR_RETURN(auto scene, scene_from_sweep(resolved, loaded.assets, loaded.heat));
  scene.tracer = change.tracer;
  ASSIGN_OR_RETURN(auto simulator, Simulator::create(scene));
  out->simulator = std::move(simulator);
  ASSIGN_OR_RETURN(auto environment,
                   environment_from_sweep(resolved, out->simulator->band_grids()));
  // The study covers the target's own light: hot gas has samples of its own.
  ASSIGN_OR_RETURN(auto request, request_from_job(resolved, {}, std::move(environment),
                                                  scene.temperatures, scene.land, {}));
  out->request = std::move(request);
  out->request.viewpoint = place.viewpoint;
  // The first view of a sweep also computes the air and sky that all its views share.
  ASSIGN_OR_RETURN(const auto first,
                   ViewEstimator::create(*out->simulator, out->request, place.condition));
  const double shared_s = process_cpu_s();
  ASSIGN_OR_RETURN(auto estimator,
                   ViewEstimator::create(*out->simulator, out->request, place.condition));
  out->estimator = std::move(estimator);
  out->view_cpu_s = process_cpu_s() - shared_s;
  out->scene_cpu_s = std::max(shared_s - start_s - out->view_cpu_s, 0.0);
  return out;
}

WorkMethod method(std::string name, const ViewEstimator& estimator, const EstimatorOptions& knobs,
                  ViewRow row, std::uint64_t first_samples = 64) {
  return {std::move(name),
          [&estimator, knobs, row](std::uint64_t samples, std::uint64_t seed) {
            return run_of(estimator.estimate(knobs, {&row, 1}, samples, seed), 0);
          },
          first_samples};
}

// One row of the sweep.
class RowStudy {
 public:
  RowStudy(const LoadedSweep& loaded, const BuiltScene& scene, const Place& place, ViewRow row,
           WorkBudget budget)
      : loaded_(loaded), scene_(scene), place_(place), row_(row), budget_(budget) {
    shipped_.max_reflections = out_.max_reflections = scene.request.max_reflections;
    const schema::Condition& c = loaded.resolved.condition(static_cast<int>(row.condition));
    out_.season = c.season();
    out_.time_utc = c.time_utc();
    out_.band = scene.simulator->bands()[row.band].name;
    out_.viewpoint = place.viewpoint;
    out_.scene_cpu_s = scene.scene_cpu_s;
    out_.view_cpu_s = scene.view_cpu_s;
  }

  absl::StatusOr<StudiedRow> run() {
    out_.reference = reference_value(*scene_.estimator, shipped_, row_, 1u << 14, fraction_of(0.2),
                                     process_cpu_s);
    const std::uint32_t most = shipped_.max_reflections;
    EstimatorOptions pseudo = shipped_;
    pseudo.pseudo_random = true;
    add("methods", method(kPlain, *scene_.estimator, plain_monte_carlo(most), row_, 32), 0.28,
        1u << 22);
    EstimatorOptions unmasked = shipped_;
    unmasked.coverage_mask = unmasked.hot_parts = false;
    add("methods", method(kPseudo, *scene_.estimator, pseudo, row_), 0.08);
    add("methods", method(kUnmasked, *scene_.estimator, unmasked, row_), 0.08);
    add("methods", method(kQuasi, *scene_.estimator, shipped_, row_), 0.08);
    for (const std::uint32_t n : {0u, 1u, 2u, 3u, 4u}) {
      EstimatorOptions knobs = shipped_;
      knobs.max_reflections = n;
      add("reflections",
          method(fmt::format("{} reflection{}", n, n == 1 ? "" : "s"), *scene_.estimator, knobs,
                 row_),
          0.03);
    }
    trace_once();
    RETURN_IF_ERROR(effects());
    RETURN_IF_ERROR(tracers());
    RETURN_IF_ERROR(steps());
    RETURN_IF_ERROR(precompute());
    return present(out_);
  }

 private:
  [[nodiscard]] WorkBudget fraction_of(double share) const {
    WorkBudget budget = budget_;
    budget.cpu_s *= share;
    budget.primary_rays *= share;
    return budget;
  }

  void add(const std::string& group, const WorkMethod& method, double share,
           std::uint64_t most_samples = 1u << 18) {
    WorkBudget budget = fraction_of(share);
    budget.most_samples_per_replicate = most_samples;
    out_.work.push_back(
        {group, method.name, work_curve(method, out_.reference, budget, process_cpu_s)});
  }

  // All rows of the sweep at this viewpoint, in the time of this row's estimate.
  void trace_once() {
    std::vector<ViewRow> rows;
    for (std::uint32_t c = 0; c < scene_.request.condition.size(); ++c)
      for (std::uint32_t b = 0; b < scene_.simulator->bands().size(); ++b) rows.push_back({c, b});
    if (rows.size() < 2) return;
    const auto is_this = [this](const ViewRow& r) {
      return r.condition == row_.condition && r.band == row_.band;
    };
    const auto this_row =
        static_cast<std::size_t>(std::find_if(rows.begin(), rows.end(), is_this) - rows.begin());
    const ViewEstimator& estimator = *scene_.estimator;
    add("sharing",
        {fmt::format("traced once for {} rows", rows.size()),
         [this, rows, this_row, &estimator](std::uint64_t samples, std::uint64_t seed) {
           return run_of(estimator.estimate(shipped_, rows, samples, seed), this_row);
         }},
        0.04);
    add("sharing",
        {fmt::format("{} rows, each traced", rows.size()),
         [this, rows, this_row, &estimator](std::uint64_t samples, std::uint64_t seed) {
           EstimateRun out;
           for (std::size_t i = 0; i < rows.size(); ++i) {
             const double samples_before = out.samples;
             const EstimateRun run =
                 run_of(estimator.estimate(shipped_, {&rows[i], 1}, samples, seed), 0);
             if (i == this_row) out = run;
             out.samples = samples_before + run.samples;
           }
           return out;
         }},
        0.06);
  }

  absl::Status effects() {
    ASSIGN_OR_RETURN(auto curves, effects_curves(loaded_.resolved, loaded_.assets, loaded_.heat,
                                                 place_.viewpoint, row_.condition, row_.band,
                                                 out_.reference, fraction_of(0.12), process_cpu_s));
    for (WorkMeasurement& m : curves.work) out_.work.push_back(std::move(m));
    out_.left_out = std::move(curves.left_out);
    return absl::OkStatus();
  }

  absl::Status tracers() {
    add("tracing", method("robust, guarded (as shipped)", *scene_.estimator, shipped_, row_), 0.03);
    for (const auto& [name, options] :
         {std::pair{"robust, no guard", TracerOptions{true, TracerGuard::kNone}},
          std::pair{"fast, no guard", TracerOptions{false, TracerGuard::kNone}}}) {
      ASSIGN_OR_RETURN(const auto scene, build(loaded_, place_, {options, std::nullopt}));
      add("tracing", method(name, *scene->estimator, shipped_, row_), 0.03);
    }
    return absl::OkStatus();
  }

  // Compares spectral steps on the same paths, so that only the quadrature differs.
  absl::Status steps() {
    const schema::Band& band = loaded_.resolved.sweep().band(static_cast<int>(row_.band));
    const double width_um = band.lambda_max_um() - band.lambda_min_um();
    constexpr double kFinest_um = 0.0125;
    constexpr std::uint64_t kSamples = 256, kSeed = 1;
    double exact_w_sr = 0;
    for (const double step_um : {kFinest_um, 0.05, 0.1, 0.2, 0.4}) {
      if (step_um > width_um / 2) continue;
      const auto scene =
          build(loaded_, place_, {{}, std::pair{static_cast<int>(row_.band), step_um}});
      // The outer bins reach half a step beyond the band: too far for the air's table.
      if (absl::IsOutOfRange(scene.status()) && step_um != kFinest_um) {
        absl::StrAppend(&out_.too_wide_steps, out_.too_wide_steps.empty() ? "" : ", ", step_um);
        continue;
      }
      if (!scene.ok()) return scene.status();
      const ViewRow row{row_.condition, 0};
      const double start_s = process_cpu_s();
      const ViewValue v = (*scene)->estimator->estimate(shipped_, {&row, 1}, kSamples, kSeed);
      const double cpu_s = process_cpu_s() - start_s;
      const RowValue& value = v.row.front();
      if (step_um == kFinest_um) {
        exact_w_sr = value.intensity_w_sr;
        continue;
      }
      const std::vector<double>& s = value.spectral_w_sr_um;
      double sum = 0;
      for (const double x : s) sum += x;
      const double step = (*scene)->simulator->band_grids().front().step_um;
      const auto error = [&](double w_sr) { return std::abs(w_sr / exact_w_sr - 1); };
      out_.step.push_back({step_um, cpu_s, error(value.intensity_w_sr),
                           error(step * (sum - (s.front() + s.back()) / 2)), error(step * sum)});
    }
    return absl::OkStatus();
  }

  // Eq. 12 is at the aperture, behind its own air: against our apparent intensity.
  absl::Status precompute() {
    const schema::Sweep& sweep = loaded_.resolved.sweep();
    if (!sweep.has_precompute()) return absl::OkStatus();
    const schema::Precompute& p = sweep.precompute();
    const std::string& season =
        loaded_.resolved.condition(static_cast<int>(row_.condition)).season();
    const auto wall = p.ambient_temperature_k().find(season);
    const auto air = p.air_temperature_k().find(season);
    if (wall == p.ambient_temperature_k().end() || air == p.air_temperature_k().end())
      return placed_problem(
          loaded_.file.location("precompute"),
          absl::StrCat("precompute has no temperatures for the season \"", season, "\""));
    const PrecomputeCase target{
        p.hot_area_m2(), p.hot_temperature_k(),          p.ambient_area_m2(),  wall->second,
        p.emissivity(),  p.reflected_exitance_w_m2_um(), p.absorption_m2_kg(), p.range_m(),
        p.pressure_pa(), p.gas_constant_j_kg_k(),        air->second};
    const Band& band = scene_.simulator->bands()[row_.band];
    constexpr int kRuns = 100;  // one takes microseconds
    double in_band_w_sr = 0;
    const double start_s = process_cpu_s();
    for (int run = 0; run < kRuns; ++run) {
      ASSIGN_OR_RETURN(const auto spectrum, precompute_spectrum(target, band.lambda_min_um,
                                                                band.lambda_max_um, p.step_um()));
      in_band_w_sr = 0;
      for (std::size_t k = 1; k < spectrum.size(); ++k)
        in_band_w_sr += (spectrum[k].lambda_um - spectrum[k - 1].lambda_um) *
                        (spectrum[k].value + spectrum[k - 1].value) / 2;
    }
    WorkPoint point;
    point.cpu_s = (process_cpu_s() - start_s) / kRuns;
    point.seeds = 1;
    point.relative_error[static_cast<std::size_t>(StudiedQuantity::kIntensity)] =
        std::abs(in_band_w_sr / out_.reference.apparent_intensity_w_sr - 1);
    out_.work.push_back({"precomputation", "precomputation model (Eq. 12): a bias", {point}});
    return absl::OkStatus();
  }

  const LoadedSweep& loaded_;
  const BuiltScene& scene_;
  const Place& place_;
  ViewRow row_;
  WorkBudget budget_;
  EstimatorOptions shipped_;
  RowMeasurements out_;
};

}  // namespace

absl::StatusOr<ChosenRows> choose_rows(const schema::ResolvedSweep& sweep,
                                       const AccuracyRows& rows) {
  std::string time;
  if (rows.time) {
    const auto parsed = parse_rfc3339(*rows.time);
    if (!parsed.ok())
      return absl::InvalidArgumentError(absl::StrCat("--time: ", parsed.status().message()));
    time = format_rfc3339_utc(*parsed);
  }
  ChosenRows out;
  const auto is_this = [&](const schema::Condition& c) {
    return (!rows.season || c.season() == *rows.season) && (!rows.time || c.time_utc() == time);
  };
  const auto condition = std::find_if(sweep.condition().begin(), sweep.condition().end(), is_this);
  if (condition == sweep.condition().end())
    return absl::InvalidArgumentError("accuracy: the sweep has no such --season and --time");
  out.condition = static_cast<std::uint32_t>(condition - sweep.condition().begin());
  for (int b = 0; b < sweep.sweep().band_size(); ++b)
    if (!rows.band || sweep.sweep().band(b).name() == *rows.band)
      out.band.push_back(static_cast<std::uint32_t>(b));
  if (out.band.empty()) return absl::InvalidArgumentError("accuracy: the sweep has no such --band");
  return out;
}

absl::StatusOr<std::vector<StudiedRow>> study_accuracy(const LoadedSweep& loaded,
                                                       const AccuracyRows& rows) {
  const schema::ResolvedSweep& sweep = loaded.resolved;
  ASSIGN_OR_RETURN(const auto chosen, choose_rows(sweep, rows));
  Place place;
  const schema::Viewpoint& middle = sweep.viewpoint(sweep.viewpoint_size() / 2);
  place.viewpoint = {middle.aspect_azimuth_deg(), middle.aspect_elevation_deg(), middle.range_m()};
  if (rows.aspect_deg) {
    place.viewpoint.aspect_azimuth_deg = (*rows.aspect_deg)[0];
    place.viewpoint.aspect_elevation_deg = (*rows.aspect_deg)[1];
  }
  Place everything = place;
  place.condition = {chosen.condition};
  for (int i = 0; i < sweep.condition_size(); ++i)
    everything.condition.push_back(static_cast<std::uint32_t>(i));
  ASSIGN_OR_RETURN(const auto scene, build(loaded, everything, {}));
  WorkBudget budget;
  budget.cpu_s = rows.seconds / static_cast<double>(chosen.band.size());
  budget.primary_rays = rows.primary_rays / static_cast<double>(chosen.band.size());
  std::vector<StudiedRow> out;
  for (const std::uint32_t band : chosen.band) {
    ASSIGN_OR_RETURN(auto row,
                     RowStudy(loaded, *scene, place, {chosen.condition, band}, budget).run());
    out.push_back(std::move(row));
  }
  return out;
}

}  // namespace irsig
