#include "cli/accuracy_study.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <memory>

#include "absl/strings/str_cat.h"
#include "core/geo/sun.h"
#include "core/study/precompute.h"
#include "core/study/work_precision.h"
#include "fmt/format.h"
#include "worker/spec_to_request.h"

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
  auto scene = scene_from_sweep(resolved, loaded.model_bytes);
  if (!scene.ok()) return scene.status();
  scene->tracer = change.tracer;
  auto simulator = Simulator::create(*scene);
  if (!simulator.ok()) return simulator.status();
  out->simulator = *std::move(simulator);
  auto environment = environment_from_sweep(resolved, out->simulator->band_grids());
  if (!environment.ok()) return environment.status();
  const double built_s = process_cpu_s();
  auto request = request_from_job(resolved, {}, *std::move(environment));
  if (!request.ok()) return request.status();
  out->request = *std::move(request);
  out->request.viewpoint = place.viewpoint;
  auto estimator = ViewEstimator::create(*out->simulator, out->request, place.condition);
  if (!estimator.ok()) return estimator.status();
  out->estimator = *std::move(estimator);
  out->scene_cpu_s = built_s - start_s;
  out->view_cpu_s = process_cpu_s() - built_s;
  return out;
}

WorkMethod method(std::string name, const ViewEstimator& estimator, const EstimatorKnobs& knobs,
                  ViewRow row, std::uint64_t first_samples = 8) {
  return {std::move(name),
          [&estimator, knobs, row](std::uint64_t samples, std::uint64_t seed) {
            ViewValue v = estimator.estimate(knobs, {&row, 1}, samples, seed);
            return EstimateRun{std::move(v.row.front()), static_cast<double>(v.samples)};
          },
          first_samples};
}

struct Measurement {
  std::string group, name;
  std::vector<WorkPoint> point;
};

std::string number(double value) { return fmt::format("{:.2g}", value); }
std::string seconds(double s) {
  return s < 0.1 ? fmt::format("{:.3g} ms", 1e3 * s) : fmt::format("{:.3g} s", s);
}
std::string percent(double fraction) { return fmt::format("{:.2g} %", 100 * fraction); }

std::string time_cell(const std::optional<WorkToTarget>& work) {
  if (!work) return "never";
  return (work->extrapolated ? "~" : "") + seconds(work->work);
}
std::string ratio_cell(const std::optional<WorkToTarget>& plain,
                       const std::optional<WorkToTarget>& ours, double setup_s) {
  if (!plain || !ours) return "-";
  return fmt::format("{}{:.3g}", plain->extrapolated || ours->extrapolated ? "~" : "",
                     (plain->work + setup_s) / (ours->work + setup_s));
}

constexpr double kOnePercent = 0.01, kOnePerMille = 0.001;

// One row of the sweep.
class RowStudy {
 public:
  RowStudy(const LoadedSweep& loaded, const BuiltScene& scene, const Place& place, ViewRow row,
           double budget_s)
      : loaded_(loaded), scene_(scene), place_(place), row_(row), budget_s_(budget_s) {
    shipped_.max_reflections = scene.request.max_reflections;
  }

  absl::StatusOr<StudiedRow> run() {
    reference_ = reference_value(*scene_.estimator, shipped_, row_, 1u << 14, 0.2 * budget_s_,
                                 process_cpu_s);
    const std::uint32_t most = shipped_.max_reflections;
    EstimatorKnobs pseudo = shipped_;
    pseudo.pseudo_random = true;
    add("methods", method(kPlain, *scene_.estimator, plain_monte_carlo(most), row_, 32), 0.28,
        1u << 22);
    add("methods", method(kPseudo, *scene_.estimator, pseudo, row_), 0.1);
    add("methods", method(kQuasi, *scene_.estimator, shipped_, row_), 0.1);
    for (const std::uint32_t n : {0u, 1u, 2u, 3u, 4u}) {
      EstimatorKnobs knobs = shipped_;
      knobs.max_reflections = n;
      add("reflections",
          method(fmt::format("{} reflection{}", n, n == 1 ? "" : "s"), *scene_.estimator, knobs,
                 row_),
          0.03);
    }
    trace_once();
    if (auto status = tracers(); !status.ok()) return status;
    if (auto status = steps(); !status.ok()) return status;
    if (auto status = precompute(); !status.ok()) return status;
    return finish();
  }

 private:
  static constexpr const char* kPlain = "plain Monte Carlo, each wavelength";
  static constexpr const char* kPseudo = "ours, pseudo-random";
  static constexpr const char* kQuasi = "ours, quasi-Monte Carlo";

  void add(const std::string& group, const WorkMethod& method, double share,
           std::uint64_t most_samples = 1u << 18) {
    WorkBudget budget;
    budget.cpu_s = share * budget_s_;
    budget.most_samples_per_replicate = most_samples;
    measured_.push_back(
        {group, method.name, work_curve(method, reference_, budget, process_cpu_s)});
  }

  // All rows of the sweep at this viewpoint, in the time of this row's estimate.
  void trace_once() {
    std::vector<ViewRow> rows;
    for (std::uint32_t c = 0; c < scene_.request.condition.size(); ++c)
      for (std::uint32_t b = 0; b < scene_.simulator->bands().size(); ++b) rows.push_back({c, b});
    rows_ = rows.size();
    const auto is_this = [this](const ViewRow& r) {
      return r.condition == row_.condition && r.band == row_.band;
    };
    const auto this_row =
        static_cast<std::size_t>(std::find_if(rows.begin(), rows.end(), is_this) - rows.begin());
    const ViewEstimator& estimator = *scene_.estimator;
    add("sharing",
        {fmt::format("traced once for {} rows", rows_),
         [this, rows, this_row, &estimator](std::uint64_t samples, std::uint64_t seed) {
           const ViewValue v = estimator.estimate(shipped_, rows, samples, seed);
           return EstimateRun{v.row[this_row], static_cast<double>(v.samples)};
         }},
        0.04);
    add("sharing",
        {fmt::format("{} rows, each traced", rows_),
         [this, rows, this_row, &estimator](std::uint64_t samples, std::uint64_t seed) {
           EstimateRun out;
           for (std::size_t i = 0; i < rows.size(); ++i) {
             ViewValue v = estimator.estimate(shipped_, {&rows[i], 1}, samples, seed);
             out.samples += static_cast<double>(v.samples);
             if (i == this_row) out.value = std::move(v.row.front());
           }
           return out;
         }},
        0.06);
  }

  absl::Status tracers() {
    add("tracing", method("robust, guarded (as shipped)", *scene_.estimator, shipped_, row_), 0.03);
    for (const auto& [name, options] :
         {std::pair{"robust, no guard", TracerOptions{true, TracerGuard::kNone}},
          std::pair{"fast, no guard", TracerOptions{false, TracerGuard::kNone}}}) {
      const auto scene = build(loaded_, place_, {options, std::nullopt});
      if (!scene.ok()) return scene.status();
      add("tracing", method(name, *(*scene)->estimator, shipped_, row_), 0.03);
    }
    return absl::OkStatus();
  }

  // The same paths at every step: what differs is the quadrature.
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
      step_.push_back({step_um, cpu_s, error(value.intensity_w_sr),
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
      return absl::InvalidArgumentError(
          absl::StrCat(loaded_.file.location("precompute"),
                       ": precompute has no temperatures for the season \"", season, "\""));
    const PrecomputeCase target{
        p.hot_area_m2(), p.hot_temperature_k(),          p.ambient_area_m2(),  wall->second,
        p.emissivity(),  p.reflected_exitance_w_m2_um(), p.absorption_m2_kg(), p.range_m(),
        p.pressure_pa(), p.gas_constant_j_kg_k(),        air->second};
    const Band& band = scene_.simulator->bands()[row_.band];
    constexpr int kRuns = 100;  // one takes microseconds
    double in_band_w_sr = 0;
    const double start_s = process_cpu_s();
    for (int run = 0; run < kRuns; ++run) {
      const auto spectrum =
          precompute_spectrum(target, band.lambda_min_um, band.lambda_max_um, p.step_um());
      if (!spectrum.ok()) return spectrum.status();
      in_band_w_sr = 0;
      for (std::size_t k = 1; k < spectrum->size(); ++k)
        in_band_w_sr += ((*spectrum)[k].lambda_um - (*spectrum)[k - 1].lambda_um) *
                        ((*spectrum)[k].value + (*spectrum)[k - 1].value) / 2;
    }
    WorkPoint point;
    point.cpu_s = (process_cpu_s() - start_s) / kRuns;
    point.seeds = 1;
    point.relative_error[static_cast<std::size_t>(Measured::kIntensity)] =
        std::abs(in_band_w_sr / reference_.apparent_intensity_w_sr - 1);
    measured_.push_back({"precomputation", "precomputation model (Eq. 12): a bias", {point}});
    return absl::OkStatus();
  }

  [[nodiscard]] double floor(Measured what) const {
    return 3 * reference_.relative_stderr[static_cast<std::size_t>(what)];
  }
  [[nodiscard]] const Measurement& of(const std::string& name) const {
    return *std::find_if(measured_.begin(), measured_.end(),
                         [&](const Measurement& m) { return m.name == name; });
  }
  [[nodiscard]] std::optional<WorkToTarget> time_to(const Measurement& m, Measured what,
                                                    double target) const {
    return work_to_target(against_time(m.point, what), target, floor(what));
  }

  [[nodiscard]] WorkPanel panel(const std::string& title, const std::vector<std::string>& groups,
                                Measured what) const {
    WorkPanel out{title,
                  "CPU time [s]",
                  "relative error (rms over seeds)",
                  {},
                  0,
                  {kOnePercent, kOnePerMille}};
    out.reference_error = reference_.relative_stderr[static_cast<std::size_t>(what)];
    for (const std::string& group : groups)
      for (const Measurement& m : measured_) {
        if (m.group != group) continue;
        WorkSeries s{m.name, {}, {}, true};
        for (const WorkError& p : against_time(m.point, what)) {
          s.x.push_back(p.work);
          s.y.push_back(p.error);
        }
        out.series.push_back(std::move(s));
      }
    return out;
  }

  [[nodiscard]] WorkPanel convergence() const {
    WorkPanel out{"Convergence: error against primary rays",
                  "primary rays, all replicates",
                  "relative error (rms over seeds)",
                  {},
                  0,
                  {kOnePerMille}};
    out.reference_error = reference_.relative_stderr[static_cast<std::size_t>(Measured::kArea)];
    for (const char* name : {kPseudo, kQuasi})
      for (const auto& [what, of_what] : {std::pair{Measured::kArea, "projected area"},
                                          std::pair{Measured::kEmitted, "emission"}}) {
        WorkSeries s{
            fmt::format("{}: {}", name == kQuasi ? "quasi" : "pseudo", of_what), {}, {}, true};
        for (const WorkError& p : against_samples(of(name).point, what)) {
          s.x.push_back(p.work);
          s.y.push_back(p.error);
        }
        out.series.push_back(std::move(s));
      }
    return out;
  }

  [[nodiscard]] WorkPanel step_panel() const {
    WorkPanel out{"Spectral step: error of the quadrature alone",
                  "step [um]",
                  "relative error",
                  {},
                  0,
                  {kOnePercent, kOnePerMille}};
    out.series = {{"ours (Gauss nodes in each bin)", {}, {}, true},
                  {"trapezoid over stored values", {}, {}, true},
                  {"rectangles, both ends (the paper's)", {}, {}, true}};
    for (const Step& s : step_) {
      const double errors[] = {s.ours, s.trapezoid, s.rectangles};
      for (std::size_t k = 0; k < 3; ++k) {
        out.series[k].x.push_back(s.step_um);
        out.series[k].y.push_back(errors[k]);
      }
    }
    return out;
  }

  [[nodiscard]] PageTable targets() const {
    PageTable t{
        "CPU time to a target (\"~\": extrapolated along the fitted line). Ratio: plain / this; "
        "with set-up: " +
            seconds(scene_.scene_cpu_s) + " for the scene (once a sweep) and " +
            seconds(scene_.view_cpu_s) + " for air, sky and sea of the view added to both.",
        {"method", "in-band 1 %", "ratio", "with set-up", "in-band 0.1 %", "ratio", "with set-up",
         "spectrum 1 %", "ratio", "spectrum 0.1 %", "ratio"},
        {}};
    const double setup_s = scene_.scene_cpu_s + scene_.view_cpu_s;
    for (const Measurement& m : measured_) {
      if (m.group != "methods") continue;
      std::vector<std::string> cells{m.name};
      for (const Measured what : {Measured::kIntensity, Measured::kSpectrum})
        for (const double target : {kOnePercent, kOnePerMille}) {
          const auto plain = time_to(of(kPlain), what, target), here = time_to(m, what, target);
          cells.push_back(time_cell(here));
          cells.push_back(ratio_cell(plain, here, 0));
          if (what == Measured::kIntensity) cells.push_back(ratio_cell(plain, here, setup_s));
        }
      t.row.push_back(std::move(cells));
    }
    return t;
  }

  [[nodiscard]] PageTable equal_times() const {
    PageTable t{"Error after equal CPU times (in-band / stored spectrum; \"-\": outside the curve)",
                {"method"},
                {}};
    constexpr double kTimes_s[] = {0.003, 0.01, 0.03, 0.1, 0.3};
    for (const double s : kTimes_s) t.header.push_back(seconds(s));
    for (const Measurement& m : measured_) {
      if (m.point.size() < 2 || m.group == "sharing") continue;
      std::vector<std::string> cells{m.name};
      for (const double s : kTimes_s) {
        const auto in_band = error_at_work(against_time(m.point, Measured::kIntensity), s),
                   spectrum = error_at_work(against_time(m.point, Measured::kSpectrum), s);
        cells.push_back((in_band ? percent(*in_band) : "-") + " / " +
                        (spectrum ? percent(*spectrum) : "-"));
      }
      t.row.push_back(std::move(cells));
    }
    return t;
  }

  [[nodiscard]] PageTable slopes() const {
    PageTable t{"Slope of the error against primary rays, and the rays (all replicates) to 0.1 %",
                {"method", "projected area", "emission", "intensity", "rays to 0.1 % of area",
                 "of emission", "of intensity"},
                {}};
    for (const Measurement& m : measured_) {
      if (m.group != "methods") continue;
      std::vector<std::string> cells{m.name};
      const Measured all[] = {Measured::kArea, Measured::kEmitted, Measured::kIntensity};
      for (const Measured what : all) {
        const auto slope = error_slope(against_samples(m.point, what), floor(what));
        cells.push_back(slope ? fmt::format("{:.2f}", *slope) : "-");
      }
      for (const Measured what : all) {
        const auto rays = work_to_target(against_samples(m.point, what), kOnePerMille, floor(what));
        cells.push_back(rays ? (rays->extrapolated ? "~" : "") + number(rays->work) : "never");
      }
      t.row.push_back(std::move(cells));
    }
    return t;
  }

  [[nodiscard]] PageTable others() const {
    PageTable t{"Reflections, sharing and ray tracing: in-band intensity",
                {"method", "least error reached", "after", "time to 1 %", "time to 0.1 %"},
                {}};
    for (const Measurement& m : measured_) {
      if (m.group == "methods") continue;
      const WorkPoint& end = m.point.back();
      t.row.push_back({m.name,
                       percent(end.relative_error[static_cast<std::size_t>(Measured::kIntensity)]),
                       seconds(end.cpu_s), time_cell(time_to(m, Measured::kIntensity, kOnePercent)),
                       time_cell(time_to(m, Measured::kIntensity, kOnePerMille))});
    }
    return t;
  }

  [[nodiscard]] PageTable step_table() const {
    PageTable t{
        "Spectral step: relative error of the in-band integral on the same paths, against a step "
        "of 0.0125 um",
        {"step [um]", "ours", "trapezoid", "rectangles, both ends", "CPU time"},
        {}};
    for (const Step& s : step_)
      t.row.push_back({number(s.step_um), number(s.ours), number(s.trapezoid), number(s.rectangles),
                       seconds(s.cpu_s)});
    return t;
  }

  [[nodiscard]] StudiedRow finish() const {
    const schema::Condition& c = loaded_.resolved.condition(static_cast<int>(row_.condition));
    StudiedRow out;
    out.season = c.season();
    out.time_utc = c.time_utc();
    out.band = scene_.simulator->bands()[row_.band].name;
    out.aspect_azimuth_deg = place_.viewpoint.aspect_azimuth_deg;
    out.aspect_elevation_deg = place_.viewpoint.aspect_elevation_deg;
    out.range_m = place_.viewpoint.range_m;
    const RowValue& v = reference_.value;
    out.paragraph.push_back(fmt::format(
        "Reference: {:.7g} W/sr in the band, relative standard error {:.2g}; emitted {:.7g} W/sr, "
        "projected "
        "area {:.7g} m2 ({:.2g}). Up to {} reflections.",
        v.intensity_w_sr, reference_.relative_stderr[0], v.emitted_w_sr, v.projected_area_m2,
        reference_.relative_stderr[static_cast<std::size_t>(Measured::kArea)],
        shipped_.max_reflections));
    WorkPanel in_band =
        panel("In-band intensity", {"methods", "precomputation"}, Measured::kIntensity);
    out.panel = {
        std::move(in_band),
        panel("Stored spectrum (rms over wavelengths)", {"methods"}, Measured::kSpectrum),
        convergence(),
        panel("Number of reflections (in-band)", {"reflections"}, Measured::kIntensity),
        panel("Sharing paths; ray tracing (in-band)", {"sharing", "tracing"}, Measured::kIntensity),
        step_panel()};
    out.table = {targets(), equal_times(), slopes(), others(), step_table()};
    for (const Measurement& m : measured_)
      for (const WorkPoint& p : m.point)
        absl::StrAppend(
            &out.csv,
            fmt::format("{},{},{},{:.10g},{:.10g},{:.10g},{},\"{}\",{},{:.10g},{:.6g},{},{:.6g},"
                        "{:.6g},{:.6g},{:.6g}\n",
                        out.season, out.time_utc, out.band, out.aspect_azimuth_deg,
                        out.aspect_elevation_deg, out.range_m, m.group, m.name,
                        p.samples_per_replicate, p.samples, p.cpu_s, p.seeds, p.relative_error[0],
                        p.relative_error[1], p.relative_error[2], p.relative_error[3]));
    return out;
  }

  struct Step {
    double step_um, cpu_s, ours, trapezoid, rectangles;
  };
  const LoadedSweep& loaded_;
  const BuiltScene& scene_;
  const Place& place_;
  ViewRow row_;
  double budget_s_;
  EstimatorKnobs shipped_;
  ReferenceValue reference_;
  std::vector<Measurement> measured_;
  std::vector<Step> step_;
  std::size_t rows_ = 0;
};

absl::StatusOr<std::uint32_t> condition_of(const schema::ResolvedSweep& sweep,
                                           const AccuracyRows& rows) {
  std::string time;
  if (rows.time) {
    const auto parsed = parse_rfc3339(*rows.time);
    if (!parsed.ok())
      return absl::InvalidArgumentError(absl::StrCat("--time: ", parsed.status().message()));
    time = format_rfc3339_utc(*parsed);
  }
  for (int i = 0; i < sweep.condition_size(); ++i)
    if ((!rows.season || sweep.condition(i).season() == *rows.season) &&
        (!rows.time || sweep.condition(i).time_utc() == time))
      return static_cast<std::uint32_t>(i);
  return absl::InvalidArgumentError("accuracy: the sweep has no such --season and --time");
}

}  // namespace

std::string accuracy_csv_header() {
  return "season,time_utc,band,aspect_azimuth_deg,aspect_elevation_deg,range_m,group,method,"
         "samples_per_replicate,samples,cpu_s,seeds,relative_error_intensity,relative_error_"
         "spectrum,"
         "relative_error_emitted,relative_error_projected_area\n";
}

absl::StatusOr<std::vector<StudiedRow>> study_accuracy(const LoadedSweep& loaded,
                                                       const AccuracyRows& rows) {
  const schema::ResolvedSweep& sweep = loaded.resolved;
  const auto condition = condition_of(sweep, rows);
  if (!condition.ok()) return condition.status();
  std::vector<std::uint32_t> bands;
  for (int b = 0; b < sweep.sweep().band_size(); ++b)
    if (!rows.band || sweep.sweep().band(b).name() == *rows.band)
      bands.push_back(static_cast<std::uint32_t>(b));
  if (bands.empty()) return absl::InvalidArgumentError("accuracy: the sweep has no such --band");
  Place place;
  const schema::Viewpoint& middle = sweep.viewpoint(sweep.viewpoint_size() / 2);
  place.viewpoint = {middle.aspect_azimuth_deg(), middle.aspect_elevation_deg(), middle.range_m()};
  if (rows.aspect_deg) {
    place.viewpoint.aspect_azimuth_deg = (*rows.aspect_deg)[0];
    place.viewpoint.aspect_elevation_deg = (*rows.aspect_deg)[1];
  }
  Place everything = place;
  place.condition = {*condition};
  for (int i = 0; i < sweep.condition_size(); ++i)
    everything.condition.push_back(static_cast<std::uint32_t>(i));
  const auto scene = build(loaded, everything, {});
  if (!scene.ok()) return scene.status();
  std::vector<StudiedRow> out;
  for (const std::uint32_t band : bands) {
    auto row = RowStudy(loaded, **scene, place, {*condition, band},
                        rows.seconds / static_cast<double>(bands.size()))
                   .run();
    if (!row.ok()) return row.status();
    out.push_back(*std::move(row));
  }
  return out;
}

}  // namespace irsig
