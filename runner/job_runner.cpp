#include "runner/job_runner.h"

#include <gnu/libc-version.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <ctime>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/arithmetic_fingerprint.h"
#include "core/base/status_macros.h"
#include "core/scene/check/mesh_lint.h"
#include "core/signature/simulator.h"
#include "core/signature/view/in_sight.h"
#include "messages/environment/weather_from_message.h"
#include "messages/results/result_to_proto.h"
#include "runner/check_numbers.h"
#include "runner/heat_field.h"
#include "runner/heat_land.h"
#include "runner/input_views.h"
#include "runner/model_warnings.h"
#include "runner/profile_rows.h"
#include "runner/spec_to_request.h"
#include "schema/heat_run.h"

namespace irsig {

// Everything that jobs of a sweep share but its name, accuracy, viewpoints and profiles.
struct RunnerScene {
  std::unique_ptr<Simulator> simulator;
  std::shared_ptr<const Environment> environment;  // null: the air is not the atmosphere
  SweepTemperatures temperatures;
  std::shared_ptr<const LandScene> land;  // null: none
  SweepPlumes plumes;
  std::optional<InputViews> inputs;          // of a sweep with uncertain ones
  std::vector<Problem> warnings;             // of the sweep that built it
  mutable std::atomic<bool> failed = false;  // a job did: whatever it was, it is built anew
};

std::shared_ptr<const RunnerScene> KeptScene::of(const std::string& key) {
  const std::lock_guard lock(mutex_);
  if (scene_ != nullptr && key_ == key && !scene_->failed) return scene_;
  scene_.reset();
  return nullptr;
}

void KeptScene::keep(const std::string& key, std::shared_ptr<const RunnerScene> scene) {
  const std::lock_guard lock(mutex_);
  key_ = key;
  scene_ = std::move(scene);
  ++scenes_;
}

int KeptScene::scenes() {
  const std::lock_guard lock(mutex_);
  return scenes_;
}

namespace {

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Returns the bytes of heat results: a temperature and its error for each facet and each kind of
// land, at each time.
std::size_t bytes_left_by_heat(const schema::ResolvedSweep& sweep, std::size_t facets) {
  std::size_t numbers = 0;
  for (const schema::HeatRun& run : sweep.heat())
    numbers += static_cast<std::size_t>(run.time_utc_size()) *
               (facets + (computes_land(run) ? most_land_kinds(sweep.sweep()) : 0));
  return 2 * sizeof(float) * numbers;
}

class CoreJobRunner final : public JobRunner {
 public:
  CoreJobRunner(schema::ResolvedSweep sweep, std::shared_ptr<const RunnerScene> scene,
                Assets assets, std::size_t field_bytes, std::optional<ThumbnailEncoder> encoder,
                std::optional<InputViews> inputs)
      : sweep_(std::move(sweep)),
        scene_(std::move(scene)),
        simulator_(scene_->simulator.get()),
        assets_(std::move(assets)),
        field_bytes_(field_bytes),
        encoder_(std::move(encoder)),
        inputs_(std::move(inputs)) {}

  absl::StatusOr<schema::JobResult> run(const schema::JobSpec& job) const override {
    const double start_s = cpu_seconds();
    auto computed = compute_or_mark(job);
    if (!computed.ok()) return computed.status();
    schema::JobResult result = *std::move(computed);
    result.set_job_key(job.job_key());
    result.set_seconds(cpu_seconds() - start_s);
    result.set_physics_version(static_cast<std::uint32_t>(physics_version()));
    result.set_determinism_class(determinism_class());
    result.set_build_id(build_id());
    return result;
  }

  [[nodiscard]] std::vector<Problem> warnings() const override { return scene_->warnings; }

  [[nodiscard]] JobMemory memory() const override {
    const SweepTemperatures& temperatures = scene_->temperatures;
    return job_memory(
        sweep_, *simulator_, scene_->environment.get(),
        temperatures.emitters ? temperatures.emitters->part.size() : temperatures.awaited_emitters,
        field_bytes_, bytes_of(scene_->plumes), bytes_of(scene_->land.get()));
  }

  [[nodiscard]] std::size_t heat_bytes() const override {
    return bytes_left_by_heat(sweep_, simulator_->target().facet.size());
  }

 private:
  absl::StatusOr<schema::JobResult> compute_or_mark(const schema::JobSpec& job) const {
    try {
      auto result = compute(job);
      if (!result.ok()) scene_->failed = true;
      return result;
    } catch (...) {
      scene_->failed = true;
      throw;
    }
  }

  absl::StatusOr<schema::JobResult> compute(const schema::JobSpec& job) const {
    switch (job.kind_case()) {
      case schema::JobSpec::kView:
        return compute_view(job.view());
      case schema::JobSpec::kHeat:
        return compute_heat_job(job.heat());
      case schema::JobSpec::KIND_NOT_SET:
        break;
    }
    return absl::InvalidArgumentError("the job is of a kind that this worker does not know");
  }

  absl::StatusOr<schema::JobResult> compute_heat_job(const schema::HeatJob& job) const {
    if (job.heat() >= static_cast<std::uint32_t>(sweep_.heat_size()))
      return absl::InvalidArgumentError(
          absl::StrCat("a job asks for heat run ", job.heat(), " of ", sweep_.heat_size()));
    ASSIGN_OR_RETURN(auto computed, compute_heat(sweep_, assets_, job.heat(), scene_->land.get()));
    schema::JobResult result;
    *result.mutable_heat() = std::move(computed);
    result.set_seed_hex(absl::StrFormat("%016x", sweep_.sweep().seed()));
    return result;
  }

  absl::StatusOr<schema::JobResult> compute_view(const schema::ViewJob& job) const {
    ASSIGN_OR_RETURN(auto request,
                     request_from_job(sweep_, job, scene_->environment, scene_->temperatures,
                                      scene_->land, scene_->plumes));
    for (const auto& [what, asked] :
         {std::pair{"condition", &request.selected_condition}, {"band", &request.selected_band}})
      if (asked->empty())
        return absl::InvalidArgumentError(absl::StrCat("a job asks for no ", what));
    request.accepted_backface_fraction = accepted_backface_fraction();
    if (request.thumbnail_px > 0 && !encoder_)
      return absl::FailedPreconditionError(
          "output.thumbnail_px asks for thumbnails, and this program has no encoder for them");
    if (inputs_) request.effects.kept = inputs_->moved_effects();
    ASSIGN_OR_RETURN(auto planned, simulator_->prepare(request));
    const schema::Accuracy& accuracy = sweep_.sweep().accuracy();
    if (accuracy.has_relative_error() && accuracy.has_samples_per_replicate())
      planned.plan.samples_per_replicate = accuracy.samples_per_replicate();
    std::vector<MovedView> moved;
    if (inputs_) {
      ASSIGN_OR_RETURN(moved, inputs_->views(job));
    }
    ASSIGN_OR_RETURN(const auto measured, simulator_->measure(request, planned, moved));
    const ViewResult& view = measured.view;
    RETURN_IF_ERROR(check_temperatures_seen(view));
    RETURN_IF_ERROR(check_numbers(view));
    RETURN_IF_ERROR(check_back_faces(view));
    ASSIGN_OR_RETURN(auto result,
                     result_to_proto(view, *simulator_, sweep_, encoder_ ? &*encoder_ : nullptr));
    if (inputs_) inputs_->write(measured.change, *result.mutable_view());
    RETURN_IF_ERROR(add_profile_rows(sweep_, *simulator_, request, result));
    return result;
  }

  // A facet without a temperature matters to views that see it, and to no other.
  [[nodiscard]] absl::Status check_temperatures_seen(const ViewResult& view) const {
    if (!view.unknown_seen) return absl::OkStatus();
    const std::vector<std::uint32_t>& emitter = scene_->temperatures.emitters->of_facet;
    const std::size_t facet = static_cast<std::size_t>(
        std::find(emitter.begin(), emitter.end(), view.unknown_seen->emitter) - emitter.begin());
    return unknown_temperature(sweep_, simulator_->target(), facet,
                               sweep_.condition(static_cast<int>(view.unknown_seen->condition)),
                               scene_->temperatures.unknown);
  }

  [[nodiscard]] double accepted_backface_fraction() const {
    const schema::Model& model = sweep_.sweep().model();
    return model.has_accepted_backface_fraction() ? model.accepted_backface_fraction()
                                                  : kAcceptedBackfaceShare;
  }

  // A target that is seen from behind is mostly a mesh inside out, or a sheet that was meant to
  // have two sides: its intensity would be what is left of it.
  [[nodiscard]] absl::Status check_back_faces(const ViewResult& view) const {
    const double accepted = accepted_backface_fraction();
    const double share = view.row.front().backface_fraction;
    if (share <= accepted) return absl::OkStatus();
    return absl::FailedPreconditionError(absl::StrCat(
        absl::SixDigits(100 * share),
        " % of the silhouette are one-sided facets seen from behind, which send nothing (",
        view.silhouette_backface_hits, " of ", view.silhouette_backface_hits + view.target_paths,
        " primary hits); expected at most ", absl::SixDigits(100 * accepted),
        " %: set two_sided = true for parts that are sheets, mend facets that are inside out with "
        "`irsig model check FILE --repair OUT.obj`, or accept it with "
        "model.accepted_backface_fraction"));
  }

  schema::ResolvedSweep sweep_;
  std::shared_ptr<const RunnerScene> scene_;
  const Simulator* simulator_;  // of the scene
  Assets assets_;               // of a sweep with heat runs
  std::size_t field_bytes_;     // of the files of temperatures
  std::optional<ThumbnailEncoder> encoder_;
  std::optional<InputViews> inputs_;  // of a sweep with uncertain ones
};

// There the sensor's place is rounded to 1e-7 of the target; at 1e12 the intensity of a disk was
// 2e-4 too small, at 1e15 2 to 6 % (tests/physics/far_view_test.cpp).
constexpr double kMostRangeInSizes = 1e9;

// Before any view is computed: every viewpoint sees something of the target.
absl::Status check_in_sight(const schema::ResolvedSweep& sweep, const Target& target,
                            const Environment* environment, const LandScene* land) {
  std::vector<ConditionSpec> conditions;
  for (const schema::Condition& c : sweep.condition()) {
    const std::string& kind = c.surroundings().kind();
    ConditionSpec& condition = conditions.emplace_back();
    condition.surroundings.kind = kind == "sea"      ? SurroundingsKind::kSea
                                  : kind == "ground" ? SurroundingsKind::kGround
                                                     : SurroundingsKind::kNone;
    condition.above_surface_m = above_surface_m(sweep, c);
  }
  if (land != nullptr && land->objects != nullptr && !conditions.empty()) {
    RETURN_IF_ERROR(check_outside_objects(target, *land, conditions.front().above_surface_m));
  }
  for (const schema::Viewpoint& v : sweep.viewpoint())
    if (const absl::Status status =
            check_in_sight(target, conditions, environment, land,
                           {v.aspect_azimuth_deg(), v.aspect_elevation_deg(), v.range_m()});
        !status.ok())
      return absl::InvalidArgumentError(absl::StrCat("viewpoints: ", status.message()));
  return absl::OkStatus();
}

// Returns all that a scene is made from. What jobs alone are asked is left out, but the shortest
// range, by which the place of a model is judged; and what conditions and heat runs have written
// out: with it, every map, whose order in a message is open.
std::string scene_key(const schema::ResolvedSweep& resolved, const HeatOutputs& heat) {
  schema::ResolvedSweep sweep = resolved;
  double least_m = INFINITY;
  for (const schema::Viewpoint& v : sweep.viewpoint()) least_m = std::min(least_m, v.range_m());
  sweep.clear_viewpoint();
  sweep.clear_shard();
  schema::Sweep& asked = *sweep.mutable_sweep();
  asked.clear_name();
  asked.clear_accuracy();
  asked.clear_viewpoints();
  asked.clear_profile();
  asked.clear_published();
  asked.clear_precompute();
  asked.clear_season();
  asked.mutable_transport()->clear_job_size_vertices();
  std::string out = absl::StrCat(least_m, "\n", sweep.SerializeAsString());
  for (const std::string& field : heat) absl::StrAppend(&out, "\n", field.size(), "\n", field);
  return out;
}

// With the checks that do not depend on viewpoints but for the shortest range.
absl::StatusOr<std::shared_ptr<const RunnerScene>> build_scene(const schema::ResolvedSweep& sweep,
                                                               const Assets& assets,
                                                               const HeatOutputs& heat) {
  auto out = std::make_shared<RunnerScene>();
  ASSIGN_OR_RETURN(auto scene, scene_from_sweep(sweep, assets, heat));
  RETURN_IF_ERROR(check_above_surface(sweep, scene.mesh));
  RETURN_IF_ERROR(check_offset(sweep, scene.mesh));
  ASSIGN_OR_RETURN(out->simulator, Simulator::create(scene));
  RETURN_IF_ERROR(check_energy(sweep.sweep(), out->simulator->materials()));
  auto environment = environment_from_sweep(sweep, out->simulator->band_grids());
  if (absl::IsOutOfRange(environment.status()))
    return problem_status(problems_of(environment.status()));
  if (!environment.ok()) return environment.status();
  out->environment = *std::move(environment);
  ASSIGN_OR_RETURN(out->plumes, plumes_from_sweep(sweep, assets));
  if (sweep.sweep().has_uncertainty() && !scene.temperatures.awaited) {
    ASSIGN_OR_RETURN(out->inputs, InputViews::make(sweep, scene, *out->simulator, out->environment,
                                                   scene.temperatures, scene.land, heat));
  }
  out->warnings = model_warnings(sweep, scene);
  for (Problem& warning : land_warnings(sweep, scene.land.get()))
    out->warnings.push_back(std::move(warning));
  out->temperatures = std::move(scene.temperatures);
  out->land = std::move(scene.land);
  return out;
}

absl::Status check_viewpoints(const schema::ResolvedSweep& sweep, const RunnerScene& scene) {
  const Target& target = scene.simulator->target();
  for (const schema::Viewpoint& v : sweep.viewpoint()) {
    RETURN_IF_ERROR(check_outside(target, {.aspect_azimuth_deg = v.aspect_azimuth_deg(),
                                           .aspect_elevation_deg = v.aspect_elevation_deg(),
                                           .range_m = v.range_m()}));
    if (v.range_m() > kMostRangeInSizes * target.radius_m)
      return keyed_problem(
          "viewpoints.range_m",
          absl::StrCat("a sensor at ", v.range_m(), " m is more than ", kMostRangeInSizes,
                       " times as far away as the target's radius, ", target.radius_m,
                       " m: double precision no longer tells its sides apart"));
  }
  RETURN_IF_ERROR(check_in_sight(sweep, target, scene.environment.get(), scene.land.get()));
  return check_land_edge(sweep, target, scene.environment.get(), scene.land.get());
}

std::string cpu_vendor() {
  if (__builtin_cpu_is("amd")) return "amd";
  if (__builtin_cpu_is("intel")) return "intel";
  return "other";
}

}  // namespace

absl::StatusOr<std::unique_ptr<JobRunner>> JobRunner::create(
    const schema::ResolvedSweep& sweep, const Assets& assets, const HeatOutputs& heat,
    std::optional<ThumbnailEncoder> encoder, KeptScene* kept) {
  if (!heat.empty() && awaits_temperatures(sweep, heat))
    return absl::InternalError(absl::StrCat("the results of ", heat.size(), " heat jobs for the ",
                                            sweep.heat_size(), " that the sweep has"));
  std::string key;
  std::shared_ptr<const RunnerScene> scene;
  if (kept != nullptr) {
    key = scene_key(sweep, heat);
    scene = kept->of(key);
  }
  if (scene == nullptr) {
    ASSIGN_OR_RETURN(scene, build_scene(sweep, assets, heat));
    if (kept != nullptr) kept->keep(key, scene);
  }
  RETURN_IF_ERROR(check_viewpoints(sweep, *scene));
  std::optional<InputViews> inputs = scene->inputs;
  if (inputs) inputs->look_as(sweep);
  return std::make_unique<CoreJobRunner>(
      sweep, scene, sweep.heat_size() > 0 ? assets : Assets(),
      bytes_of(assets) - asset(assets, sweep.model_sha256()).size() +
          bytes_left_by_heat(sweep, scene->simulator->target().facet.size()),
      std::move(encoder), std::move(inputs));
}

std::string build_id() { return IRSIG_BUILD_ID; }

std::string determinism_class() {
  static const std::uint32_t narrow = arithmetic_fingerprint(false),
                             wide = arithmetic_fingerprint(true);
  const TracerIsa isa = widest_isa();
  return absl::StrCat(build_id(), "/", cpu_vendor(), "/", isa_name(isa), "/glibc-",
                      gnu_get_libc_version(), "/arithmetic-",
                      absl::Hex(isa == TracerIsa::kAvx512 ? wide : narrow, absl::kZeroPad8));
}

int physics_version() { return kPhysicsVersion; }

}  // namespace irsig
