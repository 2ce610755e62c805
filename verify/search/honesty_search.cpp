#include "verify/search/honesty_search.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/accuracy/replicates.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/scene/mesh.h"
#include "jobs/keys/expand.h"
#include "jobs/resolve_land.h"
#include "jobs/resolve_sweep.h"
#include "jobs/text/sweep_file.h"
#include "runner/heat_outputs.h"
#include "runner/job_runner.h"
#include "runner/spec_to_request.h"
#include "verify/reference/reference_view.h"

namespace irsig {
namespace {

// Relative error that rounding (float32 rays, %.10g coordinates) may leave in a sum of light.
constexpr double kRounding = 3e-7;
constexpr double kWantedShare = 0.2;     // of the stated error, for the reference's standard error
constexpr double kUndecidedShare = 0.3;  // the estimate of a standard error scatters
constexpr std::uint64_t kPilotSamples = 256;
constexpr std::uint64_t kMostSamples = 1 << 17;
// Rows of a scene, times total, apparent and contrast.
constexpr double kValuesPerScene = 4.5;
constexpr double kBeyond = 5;

struct Computed {
  SceneSweep scene;
  HeatOutputs heat;
  schema::ViewJob job;
  std::vector<schema::SignatureRow> row;
  std::uint64_t rays = 0;
};

// The sweep of a scene, its temperatures and its view, before any row.
absl::StatusOr<Computed> resolved_scene(const RandomScene& scene) {
  Computed out;
  ASSIGN_OR_RETURN(out.scene, sweep_of(scene));
  ASSIGN_OR_RETURN(auto heat, heat_outputs(out.scene.sweep, out.scene.assets));
  out.heat = std::move(heat);
  for (const schema::JobSpec& job : expand_jobs(out.scene.sweep, physics_version()))
    if (job.has_view()) out.job = job.view();
  return out;
}

absl::Status compute_rows(Computed& program) {
  ASSIGN_OR_RETURN(const auto runner,
                   JobRunner::create(program.scene.sweep, program.scene.assets, program.heat));
  for (const schema::JobSpec& job : expand_jobs(program.scene.sweep, physics_version())) {
    if (!job.has_view()) continue;  // its temperatures are known
    ASSIGN_OR_RETURN(const auto result, runner->run(job));
    program.rays += result.rays();
    program.row.insert(program.row.end(), result.view().row().begin(), result.view().row().end());
  }
  return absl::OkStatus();
}

absl::StatusOr<Computed> compute(const RandomScene& scene) {
  auto program = resolved_scene(scene);
  if (!program.ok()) return program;
  RETURN_IF_ERROR(compute_rows(*program));
  return program;
}

struct Named {
  const char* name;
  double value, stderr_, error, bounds;
};
std::array<Named, 3> quantities(const schema::SignatureRow& r) {
  const double bounds = r.undersampling_bound_w_sr() + r.truncation_bound_w_sr() +
                        r.quadrature_bound_w_sr() + r.direction_interpolation_bound_w_sr() +
                        r.omitted_bound_w_sr();
  return {Named{"total", r.intensity_w_sr().value(), r.intensity_w_sr().stderr(),
                r.numerical_error_w_sr(), bounds},
          Named{"apparent", r.apparent_intensity_w_sr().value(),
                r.apparent_intensity_w_sr().stderr(), r.apparent_numerical_error_w_sr(), bounds},
          Named{"contrast", r.contrast_intensity_w_sr().value(),
                r.contrast_intensity_w_sr().stderr(), r.contrast_numerical_error_w_sr(), bounds}};
}

JudgedValue judged(const schema::SignatureRow& row, const Named& q, const std::string& prefix) {
  JudgedValue out;
  out.what = absl::StrCat(prefix, q.name, ", band ", row.band_index());
  out.value = q.value;
  out.error = q.error;
  out.accuracy_reached = row.stop_reason() == schema::STOP_REASON_ACCURACY_REACHED;
  out.statistical = q.stderr_ > 0.9 * q.error && q.bounds < 0.1 * q.error;
  return out;
}

absl::StatusOr<ReferenceView> reference_of(const Computed& program) {
  ASSIGN_OR_RETURN(const auto scene,
                   scene_from_sweep(program.scene.sweep, program.scene.assets, program.heat));
  ASSIGN_OR_RETURN(const auto request, request_from_job(program.scene.sweep, program.job, nullptr,
                                                        scene.temperatures, nullptr, {}));
  return ReferenceView::make(scene, request, 0);
}

// Returns true if the reference sees nothing of the target either: then it is right that no row is
// computed.
bool sees_nothing(const Computed& program, std::uint64_t seed, SceneVerdict& verdict) {
  const auto reference = reference_of(program);
  if (!reference.ok()) return false;
  const ReferenceView::Result truth = reference->run(8 * kPilotSamples, 3 * seed);
  verdict.reference_rays += truth.rays;
  return std::all_of(truth.row.begin(), truth.row.end(), [](const ReferenceView::Row& row) {
    return row.projected_area_m2.value == 0;
  });
}

absl::Status by_reference(const Computed& program, const SearchOptions& options, std::uint64_t seed,
                          SceneVerdict& verdict) {
  ASSIGN_OR_RETURN(const auto reference, reference_of(program));
  const auto estimates = [](const ReferenceView::Row& row) {
    return std::array{row.total, row.apparent, row.contrast};
  };
  // The count is fixed by pilots with numbers of their own.
  double samples = 0;
  for (const std::uint64_t pilot_samples : {kPilotSamples, 8 * kPilotSamples}) {
    const ReferenceView::Result pilot = reference.run(pilot_samples, 3 * seed + pilot_samples);
    verdict.reference_rays += pilot.rays;
    double ratio = 0;
    for (const schema::SignatureRow& row : program.row) {
      const auto stated = quantities(row);
      const ReferenceView::Row& of_band = pilot.row[row.band_index()];
      const auto found = estimates(of_band);
      for (std::size_t i = 0; i < 3; ++i)
        if (found[i].stderr_ > 0)
          ratio = std::max(ratio, found[i].stderr_ / std::max(kWantedShare * stated[i].error,
                                                              kRounding * of_band.gross_w_sr));
    }
    const double count = static_cast<double>(pilot_samples);
    const double most = std::min(
        static_cast<double>(kMostSamples),
        static_cast<double>(options.most_reference_rays) * count / static_cast<double>(pilot.rays));
    samples =
        std::clamp(std::max(samples, 1.3 * ratio * ratio * count), count, std::max(most, count));
  }
  const ReferenceView::Result truth =
      reference.run(static_cast<std::uint64_t>(samples), 3 * seed + 1);
  verdict.reference_rays += truth.rays;
  for (const schema::SignatureRow& row : program.row) {
    const auto stated = quantities(row);
    const ReferenceView::Row& of_band = truth.row[row.band_index()];
    const auto found = estimates(of_band);
    for (std::size_t i = 0; i < 3; ++i) {
      JudgedValue& v = verdict.value.emplace_back(judged(row, stated[i], ""));
      v.truth = found[i].value;
      const double gross =
          of_band.gross_w_sr + std::abs(of_band.apparent.value - of_band.contrast.value);
      v.truth_error = std::hypot(found[i].stderr_, kRounding * gross);
      verdict.undecided |= v.truth_error > kUndecidedShare * v.error;
    }
  }
  return absl::OkStatus();
}

absl::Status by_invariance(const RandomScene& scene, const Computed& program, Invariance by,
                           SceneVerdict& verdict) {
  ASSIGN_OR_RETURN(const auto other, compute(changed(scene, by)));
  verdict.program_rays += other.rays;
  const std::string prefix = absl::StrCat(name_of(by), ": ");
  for (const schema::SignatureRow& row : program.row) {
    const auto here = quantities(row);
    for (std::size_t i = 0; i < 3; ++i) {
      JudgedValue v = judged(row, here[i], prefix);
      v.by_reference = false;
      double error2 = 0;
      for (const schema::SignatureRow& there : other.row) {
        const std::uint32_t band =
            by == Invariance::kSplitBand ? there.band_index() / 2 : there.band_index();
        if (band != row.band_index()) continue;
        const Named q = quantities(there)[i];
        v.truth += q.value;
        error2 += q.error * q.error;
      }
      v.truth_error = std::hypot(std::sqrt(error2), kRounding * std::abs(v.value));
      verdict.value.push_back(v);
    }
  }
  return absl::OkStatus();
}

// Rows under broken cloud against the mean of those under a clear and an overcast sky.
absl::Status by_mixture(const RandomScene& scene, const Computed& program, SceneVerdict& verdict) {
  RandomScene sky = scene;
  sky.cloud.cover = 0;
  ASSIGN_OR_RETURN(const Computed clear, compute(sky));
  sky.cloud.cover = 1;
  ASSIGN_OR_RETURN(const Computed overcast, compute(sky));
  verdict.program_rays += clear.rays + overcast.rays;
  const double cover = scene.cloud.cover;
  for (std::size_t k = 0; k < program.row.size(); ++k) {
    const auto here = quantities(program.row[k]), none = quantities(clear.row[k]),
               all = quantities(overcast.row[k]);
    for (std::size_t i = 0; i < 3; ++i) {
      JudgedValue v = judged(program.row[k], here[i], "mixture: ");
      v.by_reference = false;
      v.truth = (1 - cover) * none[i].value + cover * all[i].value;
      v.truth_error = std::hypot((1 - cover) * none[i].error, cover * all[i].error,
                                 kRounding * std::abs(v.value));
      verdict.value.push_back(v);
    }
  }
  return absl::OkStatus();
}

bool fails(const SceneVerdict& verdict, double bound) {
  if (!verdict.status.ok()) return true;
  const JudgedValue* worst = verdict.worst();
  // Not a number: worst() has it.
  return worst != nullptr && !(std::abs(worst->deviation()) <= bound);
}

absl::StatusOr<std::string> write_scene(const RandomScene& scene, const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const std::string name = absl::StrCat("seed_", scene.seed);
  const std::filesystem::path base = std::filesystem::path(folder) / name;
  std::ofstream(base.string() + ".obj") << model_obj(scene);
  if (scene.land.amplitude_m > 0) {
    std::ofstream(base.parent_path() / heights_name(name + ".obj")) << heights_asc(scene);
    std::ofstream(base.parent_path() / fractions_name(name + ".obj")) << fractions_asc(scene);
  }
  std::ofstream toml(base.string() + ".toml");
  toml << sweep_toml(scene, name + ".obj");
  toml.flush();
  if (!toml) return absl::UnavailableError(absl::StrCat(base.string(), ".toml cannot be written"));
  return base.string() + ".toml";
}

}  // namespace

const char* name_of(Invariance invariance) {
  switch (invariance) {
    case Invariance::kTurned:
      return "turned";
    case Invariance::kRaised:
      return "raised";
    case Invariance::kSplitBand:
      return "split_band";
    case Invariance::kSubdivided:
      return "subdivided";
    case Invariance::kSplitParts:
      return "split_parts";
    case Invariance::kMirrored:
      return "mirrored";
    case Invariance::kAllEffects:
      return "all_effects";
    case Invariance::kOtherSeed:
      return "other_seed";
  }
  return "";
}

absl::StatusOr<SceneSweep> sweep_of(const RandomScene& scene) {
  const std::string name = "model.obj", model = model_obj(scene);
  ASSIGN_OR_RETURN(auto file, parse_sweep(sweep_toml(scene, name), "scene.toml"));
  RETURN_IF_ERROR(read_land_files(file, [&](const std::string& map) -> absl::StatusOr<std::string> {
    return map == heights_name(name) ? heights_asc(scene) : fractions_asc(scene);
  }));
  SceneSweep out;
  ASSIGN_OR_RETURN(out.sweep, resolve_sweep(file, model));
  out.assets = model_alone(out.sweep, model);
  for (const auto& [key, bytes] : land_bytes(file))
    out.assets[sha256_hex(bytes)] = std::string(bytes);
  return out;
}

RandomScene changed(const RandomScene& scene, Invariance by) {
  RandomScene out = scene;
  switch (by) {
    case Invariance::kTurned: {
      constexpr double kTurnDeg = 37.5;
      // Clockwise seen from above; y is port.
      const double c = std::cos(kTurnDeg * kRadPerDeg), s = std::sin(kTurnDeg * kRadPerDeg);
      const auto turn = [&](std::array<double, 3>& v) {
        v = {c * v[0] + s * v[1], -s * v[0] + c * v[1], v[2]};
      };
      for (RandomBody& b : out.body) {
        turn(b.centre_m);
        for (auto& axis : b.axes) turn(axis);
      }
      out.azimuth_deg += kTurnDeg;
      out.heading_deg -= kTurnDeg;
      break;
    }
    case Invariance::kRaised:
      out.elevation_deg += 1e-3 / out.range_m / kRadPerDeg;
      break;
    case Invariance::kSplitBand:
      out.band.clear();
      for (const RandomBand& b : scene.band) {
        const double middle = b.lambda_min_um + 0.5 * (b.lambda_max_um - b.lambda_min_um);
        out.band.push_back({b.lambda_min_um, middle, 0.5 * b.step_um});
        out.band.push_back({middle, b.lambda_max_um, 0.5 * b.step_um});
      }
      break;
    case Invariance::kSubdivided:
      ++out.subdivisions;
      break;
    case Invariance::kSplitParts:
      for (RandomBody& b : out.body) b.split = true;
      out.prefix = "piece";
      break;
    case Invariance::kMirrored:
      out.mirrored = !out.mirrored;
      break;
    case Invariance::kAllEffects:
      out.all_effects = true;
      break;
    case Invariance::kOtherSeed:
      ++out.sampler_seed;
      break;
  }
  return out;
}

double JudgedValue::deviation() const {
  const double both = std::hypot(error, truth_error);
  return value == truth ? 0 : (value - truth) / both;
}

const JudgedValue* SceneVerdict::worst() const {
  const JudgedValue* out = nullptr;
  for (const JudgedValue& v : value) {
    if (std::isnan(v.deviation())) return &v;
    if (out == nullptr || std::abs(v.deviation()) > std::abs(out->deviation())) out = &v;
  }
  return out;
}

SceneVerdict judge(const RandomScene& scene, const SearchOptions& options) {
  SceneVerdict verdict;
  verdict.seed = scene.seed;
  verdict.family = scene.family;
  auto program = resolved_scene(scene);
  if (!program.ok()) {
    verdict.status = program.status();
    return verdict;
  }
  if (const absl::Status status = compute_rows(*program); !status.ok()) {
    const bool right = absl::IsInvalidArgument(status) && !scene.atmosphere &&
                       sees_nothing(*program, scene.seed, verdict);
    if (!right) verdict.status = status;
    return verdict;
  }
  verdict.program_rays = program->rays;
  // Nothing else here knows the sky of the embedded atmosphere: more of what must not change it.
  const int invariances =
      scene.atmosphere ? std::min(2 + options.invariances, kInvariances) : options.invariances;
  if (!scene.atmosphere) verdict.status = by_reference(*program, options, scene.seed, verdict);
  for (int k = 0; k < invariances && verdict.status.ok(); ++k) {
    const auto by = static_cast<Invariance>(
        (scene.seed * static_cast<std::uint64_t>(invariances) + static_cast<std::uint64_t>(k)) %
        kInvariances);
    // The cells of a map are no mirror image of themselves.
    if (by == Invariance::kMirrored && scene.land.amplitude_m > 0) continue;
    verdict.status = by_invariance(scene, *program, by, verdict);
  }
  if (verdict.status.ok() && scene.cloud.cover > 0 && scene.cloud.cover < 1)
    verdict.status = by_mixture(scene, *program, verdict);
  if (fails(verdict, failure_bound(options))) verdict.undecided = false;
  return verdict;
}

std::vector<std::uint64_t> seeds_of(const SearchOptions& options) {
  std::vector<std::uint64_t> out;
  for (std::uint64_t seed = options.first; seed <= options.last; ++seed)
    if (options.family == "*" ||
        group_matches(name_of(random_scene(seed, options.grammar).family), options.family))
      out.push_back(seed);
  return out;
}

double failure_bound(const SearchOptions& options) {
  const double scenes = static_cast<double>(options.last - options.first + 1);
  return student_t_bound(31, static_cast<std::uint64_t>(std::ceil(scenes * kValuesPerScene)));
}

RandomScene shrunk(const RandomScene& scene, const std::function<bool(const RandomScene&)>& fails,
                   int most_trials) {
  RandomScene best = scene;
  int trials = 0;
  const auto attempt = [&](const RandomScene& smaller) {
    if (trials >= most_trials) return false;
    ++trials;
    if (!fails(smaller)) return false;
    best = smaller;
    return true;
  };
  for (bool again = true; again && trials < most_trials;) {
    again = false;
    for (std::size_t i = 0; best.body.size() > 1 && i < best.body.size();) {
      RandomScene smaller = best;
      smaller.body.erase(smaller.body.begin() + static_cast<std::ptrdiff_t>(i));
      if (attempt(smaller))
        again = true;
      else
        ++i;
    }
    for (std::size_t b = 0; best.band.size() > 1 && b < best.band.size();) {
      RandomScene smaller = best;
      smaller.band.erase(smaller.band.begin() + static_cast<std::ptrdiff_t>(b));
      if (attempt(smaller))
        again = true;
      else
        ++b;
    }
    const auto without = [&](auto&& is_simple, auto&& simplify) {
      if (is_simple(best)) return;
      RandomScene smaller = best;
      simplify(smaller);
      again |= attempt(smaller);
    };
    without([](const RandomScene& s) { return !s.homogeneous_air; },
            [](RandomScene& s) { s.homogeneous_air = false; });
    without([](const RandomScene& s) { return !s.sun; }, [](RandomScene& s) { s.sun = false; });
    without([](const RandomScene& s) { return s.cloud.cover <= 0; },
            [](RandomScene& s) { s.cloud.cover = 0; });
    without([](const RandomScene& s) { return s.land.amplitude_m <= 0; },
            [](RandomScene& s) { s.land.amplitude_m = 0; });
    without([](const RandomScene& s) { return !s.sea; }, [](RandomScene& s) { s.sea = false; });
    without([](const RandomScene& s) { return s.all_effects; },
            [](RandomScene& s) { s.all_effects = true; });
    for (std::size_t i = 0; i < best.body.size(); ++i) {
      without([&](const RandomScene& s) { return s.body[i].patch <= 0; },
              [&](RandomScene& s) { s.body[i].patch = 0; });
    }
    for (std::size_t m = 0; m < best.material.size(); ++m) {
      const std::string grey =
          absl::StrCat("kind = \"lambert\"\nemissivity = ", best.material[m].mean_emissivity, "\n");
      without([&](const RandomScene& s) { return s.material[m].toml == grey; },
              [&](RandomScene& s) { s.material[m].toml = grey; });
    }
  }
  return best;
}

std::vector<const SceneVerdict*> SearchSummary::failed() const {
  std::vector<const SceneVerdict*> out;
  for (const SceneVerdict& s : scene)
    if (fails(s, bound)) out.push_back(&s);
  return out;
}

std::size_t SearchSummary::undecided() const {
  return static_cast<std::size_t>(
      std::count_if(scene.begin(), scene.end(), [](const SceneVerdict& s) { return s.undecided; }));
}

SearchSummary::Spread SearchSummary::spread() const {
  Spread out;
  double sum = 0;
  for (const SceneVerdict& s : scene) {
    // Scenes that fail are counted elsewhere.
    if (fails(s, bound)) continue;
    bool any = false;
    for (const JudgedValue& v : s.value) {
      if (!v.by_reference || !v.statistical) continue;
      any = true;
      ++out.values;
      out.beyond_2 += std::abs(v.deviation()) > 2 ? 1 : 0;
      sum += v.deviation() * v.deviation();
    }
    out.scenes += any ? 1 : 0;
  }
  if (out.scenes == 0) return out;
  out.rms = std::sqrt(sum / static_cast<double>(out.values));
  out.most = std::sqrt(31.0 / 29) * (1 + 3.5 / std::sqrt(2.0 * static_cast<double>(out.scenes)));
  return out;
}

SearchSummary search(const SearchOptions& options,
                     const std::function<void(const SceneVerdict&, double bound)>& done) {
  SearchSummary out;
  out.bound = failure_bound(options);
  const std::vector<std::uint64_t> seeds = seeds_of(options);
  out.scene.resize(seeds.size());
  std::atomic<std::size_t> next = 0;
  std::mutex one_at_a_time;
  const auto work = [&] {
    for (std::size_t i = next++; i < seeds.size(); i = next++) {
      const RandomScene scene = random_scene(seeds[i], options.grammar);
      SceneVerdict verdict = judge(scene, options);
      std::string written;
      if (!options.failures.empty() && fails(verdict, out.bound)) {
        const auto still_fails = [&](const RandomScene& s) {
          const SceneVerdict again = judge(s, options);
          return again.status.ok() == verdict.status.ok() && fails(again, out.bound);
        };
        const auto file =
            write_scene(shrunk(scene, still_fails, options.shrink_trials), options.failures);
        written = file.ok() ? *file : std::string(file.status().message());
      }
      const std::lock_guard lock(one_at_a_time);
      if (!written.empty()) out.written.push_back(written);
      if (done) done(verdict, out.bound);
      out.scene[i] = std::move(verdict);
    }
  };
  std::vector<std::jthread> threads;
  for (std::size_t i = 1; i < options.threads; ++i) threads.emplace_back(work);
  work();
  threads.clear();
  std::sort(out.written.begin(), out.written.end());
  return out;
}

std::string verdict_line(const SceneVerdict& verdict, double bound) {
  const JudgedValue* worst = verdict.worst();
  std::string out = absl::StrFormat("seed %6d  %-14s %-9s", verdict.seed, name_of(verdict.family),
                                    fails(verdict, bound) ? "FAILED"
                                    : verdict.undecided   ? "undecided"
                                                          : "holds");
  if (!verdict.status.ok()) return absl::StrCat(out, "  ", verdict.status.message());
  if (worst != nullptr)
    absl::StrAppend(&out, absl::StrFormat("  worst %6.2f  %s: %.6g +- %.2g, expected %.6g +- %.2g",
                                          worst->deviation(), worst->what, worst->value,
                                          worst->error, worst->truth, worst->truth_error));
  absl::StrAppend(&out,
                  absl::StrFormat("  (%.2g + %.2g rays)", static_cast<double>(verdict.program_rays),
                                  static_cast<double>(verdict.reference_rays)));
  return out;
}

namespace {

// Edges of the histogram, in units of |deviation|.
constexpr std::array kEdges{0.5, 1.0, 2.0, 3.0, 5.0};
using Histogram = std::array<std::size_t, kEdges.size() + 1>;

Histogram histogram(const SearchSummary& summary, bool by_reference) {
  Histogram count{};
  for (const SceneVerdict& s : summary.scene)
    for (const JudgedValue& v : s.value)
      if (v.by_reference == by_reference)
        ++count[static_cast<std::size_t>(
            std::upper_bound(kEdges.begin(), kEdges.end(), std::abs(v.deviation())) -
            kEdges.begin())];
  return count;
}

}  // namespace

std::string record_header() {
  return "physics_version,grammar,families,first_seed,last_seed,scenes,undecided,failed,"
         "reference_0_0.5,reference_0.5_1,reference_1_2,reference_2_3,reference_3_5,reference_5,"
         "invariance_0_0.5,invariance_0.5_1,invariance_1_2,invariance_2_3,invariance_3_5,"
         "invariance_5\n";
}

std::string record_line(const SearchSummary& summary, const SearchOptions& options) {
  std::string out = absl::StrCat(physics_version(), ",", options.grammar.best_relative_error,
                                 " to ", options.grammar.worst_relative_error, ",", options.family,
                                 ",", options.first, ",", options.last, ",", summary.scene.size(),
                                 ",", summary.undecided(), ",", summary.failed().size());
  for (const bool by_reference : {true, false})
    for (const std::size_t n : histogram(summary, by_reference)) absl::StrAppend(&out, ",", n);
  return out + "\n";
}

std::string summary_text(const SearchSummary& summary) {
  const Histogram count = histogram(summary, true), count_invariance = histogram(summary, false);
  std::size_t values = 0;
  std::string beyond;
  std::map<std::string, std::array<std::size_t, 3>> family;
  for (const SceneVerdict& s : summary.scene) {
    auto& of = family[name_of(s.family)];
    ++of[0];
    of[1] += fails(s, summary.bound) ? 1 : 0;
    of[2] += s.undecided ? 1 : 0;
    for (const JudgedValue& v : s.value) {
      values += v.by_reference ? 1 : 0;
      if (!(std::abs(v.deviation()) <= kBeyond))
        absl::StrAppend(&beyond, absl::StrFormat("  seed %d (%s) %s: %.4g errors%s\n", s.seed,
                                                 name_of(s.family), v.what, v.deviation(),
                                                 v.accuracy_reached ? ", accuracy_reached" : ""));
    }
  }
  std::string out =
      absl::StrFormat("\n|error| / errors    <0.5   0.5-1     1-2     2-3     3-5      >5\n");
  for (const auto& [name, row] :
       {std::pair{"by the reference", count}, {"by invariances", count_invariance}}) {
    absl::StrAppend(&out, absl::StrFormat("%-16s", name));
    for (const std::size_t n : row) absl::StrAppend(&out, absl::StrFormat(" %7d", n));
    absl::StrAppend(&out, "\n");
  }
  const SearchSummary::Spread spread = summary.spread();
  absl::StrAppend(
      &out,
      absl::StrFormat("mostly statistical: %d values of %d scenes, %d beyond 2 (5.4 %% expected); "
                      "rms %.2f, at most %.2f: %s\n",
                      spread.values, spread.scenes, spread.beyond_2, spread.rms, spread.most,
                      spread.holds() ? "holds" : "FAILED"));
  for (const auto& [name, of] : family)
    absl::StrAppend(&out, absl::StrFormat("%-16s %5d scenes, %d failed, %d undecided\n", name,
                                          of[0], of[1], of[2]));
  if (!beyond.empty()) absl::StrAppend(&out, "beyond 5 errors:\n", beyond);
  for (const std::string& file : summary.written) absl::StrAppend(&out, "written: ", file, "\n");
  absl::StrAppend(
      &out, absl::StrFormat("%d scenes, %d values, bound %.2f: %d failed, %d undecided\n",
                            summary.scene.size(), values, summary.bound, summary.failed().size(),
                            summary.undecided()));
  return out;
}

}  // namespace irsig
