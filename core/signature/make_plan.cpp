#include "core/signature/make_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/accuracy/pilot_samples.h"
#include "core/base/constants.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/signature/aim_at_bright.h"
#include "core/signature/effect_bounds.h"
#include "core/signature/measured_view.h"
#include "core/signature/row_bounds/row_bounds.h"
#include "core/signature/view/in_sight.h"
#include "core/signature/view_seed.h"

namespace irsig {
namespace {

// Fraction of the room for omissions that later reflections may take: little, since they cost
// little.
constexpr double kOfLaterReflections = 0.25;

// Samples per replicate of the pilot of the emission alone. What none of them may have met is to be
// small against what may be left out, and the pilot against the run: loose goals make short runs.
std::uint64_t emission_samples(double relative_error) {
  return relative_error >= 0.01 ? 32 : relative_error >= 0.003 ? 64 : 256;
}

std::vector<std::uint32_t> all_of(std::size_t n) {
  std::vector<std::uint32_t> out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<std::uint32_t>(i);
  return out;
}

// Where the user allows no reflections they are off by his word, and their bound is the
// truncation's.
void take_out_reflections(std::vector<RowBounds>& rows) {
  for (RowBounds& row : rows) {
    row.reflected = {};
    for (const Effect e : kReflectionEffects) {
      RowBounds::Bound& bound = row.effect[static_cast<std::size_t>(e)];
      bound = {bound.absent, 0, 0, 0};
    }
  }
}
void without_allowed_reflections(std::vector<std::vector<LedgerEntry>>& ledger) {
  for (auto& row : ledger)
    for (LedgerEntry& e : row)
      for (const Effect of :
           {Effect::kDirectSun, Effect::kDiffuseSun, Effect::kMirroredSun, Effect::kSkyReflected,
            Effect::kLowerReflected, Effect::kInterReflection, Effect::kHotPartsReflected,
            Effect::kJoinedLines})
        if (e.effect == of && e.state != EffectState::kAbsent) {
          e.state = EffectState::kOff;
          e.reason = EffectReason::kForced;
        }
}

// Writes what was decided into the plan.
void carry_out(const EffectPlanner& planner, const ViewRequest& request, const Target& target,
               bool trust_convexity, ViewPlan& plan) {
  EffectSet& effects = plan.effects;
  effects.max_reflections = planner.reflections() ? request.max_reflections : 0;
  effects.sky = planner.on_anywhere(Effect::kSkyReflected);
  effects.lower = planner.on_anywhere(Effect::kLowerReflected);
  effects.parts = planner.on_anywhere(Effect::kInterReflection);
  effects.joined_lines = planner.on_anywhere(Effect::kJoinedLines);
  if (!effects.parts || (trust_convexity && target.convex))
    effects.max_reflections = std::min(effects.max_reflections, 1u);
  effects.skip_self_intersection = trust_convexity && target.convex;
  effects.sun.resize(request.condition.size());
  for (std::size_t c = 0; c < effects.sun.size(); ++c)
    effects.sun[c] = {planner.on(Effect::kDirectSun, c), planner.on(Effect::kDiffuseSun, c),
                      planner.on(Effect::kMirroredSun, c), planner.on(Effect::kPathSun, c),
                      planner.on(Effect::kBackgroundSun, c)};
  effects.cloud.clear();
  for (std::size_t c = 0; c < effects.sun.size(); ++c)
    if (!planner.on(Effect::kCloud, c)) {
      effects.cloud.resize(effects.sun.size(), true);
      effects.cloud[c] = false;
    }
  plan.omitted = planner.omitted();
  plan.ledger = planner.ledger();
  if (request.max_reflections == 0) without_allowed_reflections(plan.ledger);
}

// Returns the fraction of the silhouette that is surely seen from behind.
double backface_fraction_at_least(const MeasuredView& pilot) {
  const double share = backface_fraction(pilot);
  const PathCounts& counts = pilot.totals.counts;
  const auto hits = static_cast<double>(counts.silhouette_backface_hits + counts.target_paths);
  return hits > 0 ? std::max(0.0, share - 4 * std::sqrt(share * (1 - share) / hits)) : 0;
}

// The samples that all rows of a pilot ask for, from its last two stages or, with n_before = 0,
// from one alone: the error then falls as n^-0.5 at least.
std::uint64_t samples_of_rows(const MeasuredView& pilot, std::uint64_t n_before,
                              const std::vector<double>& before, std::uint64_t n) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 40;
  constexpr int kLooks = 6;
  constexpr double kNearEnough = 1.02;
  std::uint64_t samples = 16;
  for (std::size_t k = 0; k < pilot.row.size(); ++k) {
    const Row& row = pilot.row[k];
    const double wanted = stderr_wanted_w_sr(pilot, row);
    const auto needed = [&](double unseen) {
      return samples_needed_with_unseen(n_before, n_before > 0 ? before[k] : 0, n,
                                        row.estimate.total.stderr_, unseen, wanted, kMost);
    };
    double unseen = undersampling_error_w_sr(pilot.setup, row, n);
    std::uint64_t of_row = needed(unseen);
    // It falls more slowly than 1 / n, since more samples divide what is bounded from what is met
    // elsewhere: so it is asked for where the run will be.
    for (int look = 0; look < kLooks && of_row > n && of_row < kMost; ++look) {
      const double there = undersampling_error_w_sr(pilot.setup, row, of_row) *
                           static_cast<double>(of_row) / static_cast<double>(n);
      if (there <= kNearEnough * unseen) break;
      unseen = there;
      of_row = needed(unseen);
    }
    samples = std::max(samples, of_row);
  }
  return samples;
}

std::vector<double> errors_of(const MeasuredView& pilot) {
  std::vector<double> out;
  for (const Row& row : pilot.row) out.push_back(row.estimate.total.stderr_);
  return out;
}

// Returns true if the light that a pilot cannot have met is small against the errors that are
// wanted: a scatter of 0 proves nothing where all that shines is a hot spot round the corner.
bool saw_enough(const MeasuredView& pilot, std::uint64_t n) {
  for (const Row& row : pilot.row)
    if (undersampling_error_w_sr(pilot.setup, row, n) > goal_w_sr(pilot, row)) return false;
  return true;
}

// Samples per replicate from which on it is worth while to look for what may be rare and bright:
// the frigate at 0.2 % takes 1024 to 2816, a plate of 16 m2 with a mirror of 5 cm 150 000 at 1 %.
// The first pilot overrates the need, and so has to ask for more.
constexpr std::uint64_t kRareSamples = 4096, kRareFromFirst = 16384;
// And what is found is aimed at if a pilot then asks for so many times fewer rays.
constexpr double kWorthAiming = 4;

// Told how many samples a pilot of n asks for; whether the view is to be begun anew.
using Rare = std::function<bool(std::uint64_t n, std::uint64_t asked)>;

// The number of samples for the asked error, after a first pilot of n_first samples. A larger one
// follows unless little more is asked for, and a third where the second still asks for much more:
// rare bright paths are then seen often enough to be judged. `rare`, if there is one, is told
// before that how many the second asks for, if they are many; true: the view is begun anew.
std::optional<std::uint64_t> samples_for_goal(MeasuredView& pilot, std::uint64_t n_first,
                                              std::uint64_t most, std::uint64_t& pilot_rays,
                                              const Rare& rare) {
  std::uint64_t samples = samples_of_rows(pilot, 0, {}, n_first);
  if (samples <= kSecondPilotSamples && saw_enough(pilot, n_first)) return samples;
  bool asked = rare == nullptr;
  if (!asked && samples > kRareFromFirst) {
    asked = true;
    if (rare(n_first, samples)) return std::nullopt;
  }
  std::uint64_t n_before = n_first, n = kSecondPilotSamples;
  for (std::uint64_t stage = kSecondPilotStage;; ++stage) {
    const std::vector<double> before = errors_of(pilot);
    run_view(pilot, n, stage, RunKind::kPilot);
    pilot_rays += pilot.totals.counts.rays;
    samples = std::min(samples_of_rows(pilot, n_before, before, n), most + 1);
    if (!asked && samples > kRareSamples && rare(n, samples)) return std::nullopt;
    asked = true;
    if (stage != kSecondPilotStage || samples < 32 * n) return samples;
    n_before = n;
    n = samples / 16;
  }
}

// The number of samples for the asked error after a first pilot of n_first samples; and where what
// is rare and bright is aimed at, the view that does so.
struct ForGoal {
  std::uint64_t samples = 0;
  std::shared_ptr<const AimedView> aimed;  // null: as the pilot is
};

// A view that aims at what is bright and rare; none: nothing is, or it would not pay. pilot: one
// without, of n samples, whose environments and plan it shares; asked: the samples that it asks
// for.
std::optional<ForGoal> aim_at_bright(const PreparedScene& scene, const ViewRequest& request,
                                     const ViewPlan& plan, const PreparedView& view,
                                     const MeasuredView& pilot, const RowKeys& rows,
                                     std::uint64_t n, std::uint64_t asked,
                                     std::uint64_t& pilot_rays) {
  const BrightFacets bright = choose_bright(scene.target, *view.aimed, facet_brightness(pilot));
  if (bright.none()) return std::nullopt;
  AimedView aimed = make_aimed_view(scene.target, request.viewpoint, bright);
  PreparedView at_bright = view;
  at_bright.aimed = std::make_shared<const AimedView>(aimed);
  MeasuredView alone(scene, request, plan,
                     std::make_shared<const PreparedView>(std::move(at_bright)), rows,
                     view_seed(scene, request));
  const SharedOut shared = share_out(alone, pilot_rays);
  const double rays = static_cast<double>(pilot.totals.counts.rays) * static_cast<double>(asked) /
                      static_cast<double>(n);
  if (kWorthAiming * shared.rays > rays) return std::nullopt;
  aimed.bright.share = shared.share;
  return ForGoal{shared.samples, std::make_shared<const AimedView>(std::move(aimed))};
}

ForGoal for_goal(const PreparedScene& scene, const ViewRequest& request, const ViewPlan& pilot_plan,
                 const PreparedView& view, MeasuredView& pilot, const RowKeys& rows,
                 std::uint64_t n_first, std::uint64_t& pilot_rays) {
  std::optional<ForGoal> aimed;
  const auto samples = samples_for_goal(pilot, n_first, request.accuracy.max_samples_per_replicate,
                                        pilot_rays, [&](std::uint64_t n, std::uint64_t asked) {
                                          aimed = aim_at_bright(scene, request, pilot_plan, view,
                                                                pilot, rows, n, asked, pilot_rays);
                                          return aimed.has_value();
                                        });
  return samples ? ForGoal{*samples, nullptr} : *aimed;
}

// Hits are counted with the strata in the proportion that the stored run has.
absl::Status count_target_paths(MeasuredView& pilot, const AccuracySpec& accuracy, ViewPlan& plan) {
  run_view(pilot, kSecondPilotSamples, kFirstPilotStage, RunKind::kPilot);
  plan.pilot_rays += pilot.totals.counts.rays;
  const double per_sample = static_cast<double>(pilot.totals.counts.target_paths) /
                            static_cast<double>(kSecondPilotSamples);
  if (per_sample == 0)
    return absl::FailedPreconditionError("target_paths: no ray of the pilot met the target");
  const double wanted = std::ceil(accuracy.target_paths / per_sample / 16) * 16;
  const auto most = static_cast<double>(accuracy.max_samples_per_replicate);
  plan.samples_per_replicate = static_cast<std::uint64_t>(std::min(wanted, most));
  plan.limited = wanted > most;
  return absl::OkStatus();
}

// Returns the largest change of each row by reading the air's lines at fewer rings: `relative` of
// the reflected light of sky and sea, with the sun in them.
template <typename Relative>
std::vector<RowBounds::Bound> fewer_lines_bounds(const std::vector<RowBounds>& rows,
                                                 std::size_t bands, const Relative& relative) {
  std::vector<RowBounds::Bound> out;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const auto source = [&](Effect e) {
      const RowBounds::Bound& b = rows[row].effect[static_cast<std::size_t>(e)];
      return b.absent ? 0 : b.source;
    };
    const double share = relative(row / bands);
    const double bound =
        share == 0 ? 0 : share * (source(Effect::kSkyReflected) + source(Effect::kDiffuseSun));
    out.push_back({false, 0, bound, bound});
  }
  return out;
}

// 3 % is about the least that comes of it.
bool fewer_lines_may_fit(const std::vector<RowBounds>& rows, std::size_t bands,
                         EffectPlanner planner) {
  return planner.take_room(fewer_lines_bounds(rows, bands, [](std::size_t) { return 0.03; }));
}

// Returns true if anything that costs much could be left out if the pilot of the emission came out
// at its best.
bool worth_a_pilot(const std::vector<RowBounds>& best_case, std::size_t bands,
                   const ViewRequest& request) {
  EffectPlanner planner(best_case, bands, request.effects);
  planner.decide();
  if (!planner.reflections()) return true;
  for (const Effect e :
       {Effect::kSkyReflected, Effect::kDirectSun, Effect::kDiffuseSun, Effect::kCloud})
    for (std::size_t c = 0; c < request.condition.size(); ++c)
      if (!planner.on(e, c)) return true;
  return request.environment != nullptr && fewer_lines_may_fit(best_case, bands, planner);
}

// Sky, sea and air as the plan wants them. The air's lines at fewer rings of sky and sea, if that
// is near enough: what it errs by is known from the rings themselves, which have to be seen first.
absl::StatusOr<ViewEnvironments> see_planned(const ViewRequest& request,
                                             const std::vector<RowBounds>& rows, std::size_t bands,
                                             ViewSurroundings& surroundings, EffectPlanner& planner,
                                             ViewPlan& plan) {
  const std::vector<std::uint32_t> conditions = all_of(request.condition.size());
  if (request.environment == nullptr || plan.effects.max_reflections == 0 ||
      !(plan.effects.sky || plan.effects.lower))
    return surroundings.evaluate(conditions, plan.effects);
  const bool forced_off = !plan.effects.joined_lines;
  if (!forced_off && !fewer_lines_may_fit(rows, bands, planner))
    return surroundings.evaluate(conditions, plan.effects);
  plan.effects.joined_lines = false;
  ASSIGN_OR_RETURN(auto seen, surroundings.evaluate(conditions, plan.effects));
  const bool left_out =
      planner.leave_out(Effect::kJoinedLines, fewer_lines_bounds(rows, bands, [&](std::size_t c) {
                          return seen.condition[c].joined_lines_bound;
                        }));
  plan.omitted = planner.omitted();
  plan.ledger = planner.ledger();
  if (left_out || forced_off) return seen;
  plan.effects.joined_lines = true;
  return surroundings.evaluate(conditions, plan.effects);
}

// The user may leave out what he likes, but not without an error that can be stated.
absl::Status check_forced(const std::vector<RowBounds>& rows, const EffectPlanner& planner,
                          std::size_t bands) {
  for (const EffectInfo& e : effect_table()) {
    if (!e.switchable || e.effect == Effect::kJoinedLines) continue;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const RowBounds::Bound& b = rows[row].effect[static_cast<std::size_t>(e.effect)];
      if (!b.absent && !planner.on(e.effect, row / bands) &&
          !std::isfinite(b.source + b.apparent + b.contrast))
        return absl::FailedPreconditionError(
            absl::StrCat("effects.only: without ", std::string(e.name),
                         " no error can be stated, because no finite bound of it is known for "
                         "this target"));
    }
  }
  return absl::OkStatus();
}

// After the first number of reflections at which what is still under way hardly matters.
void leave_out_late_reflections(MeasuredView& pilot, EffectPlanner& planner, ViewPlan& plan) {
  for (std::uint32_t n = 1; n < plan.effects.max_reflections; ++n) {
    std::vector<RowBounds::Bound> bounds;
    for (const Row& row : pilot.row) {
      const double bound = beyond_limit_m2(pilot, n) * row.brightest_w_m2_sr / kOfLaterReflections;
      bounds.push_back({false, bound, bound, bound});
    }
    EffectPlanner trial = planner;
    if (!trial.take_room(bounds)) continue;
    planner = std::move(trial);
    plan.effects.max_reflections = n;
    pilot.cut_reflections(n);
    return;
  }
}

// Land goes on as the ground, at one height, and is in no gas.
absl::Status check_land(const PreparedScene& scene, const ViewRequest& request) {
  const std::uint32_t materials = request.land->cover.materials();
  const std::size_t kinds = request.land->kinds ? request.land->kinds->kind.size() : materials;
  if (scene.land_emissivity.size() != materials)
    return absl::InvalidArgumentError(absl::StrCat("land of ", materials, " materials, and ",
                                                   scene.land_emissivity.size(),
                                                   " of them in the scene"));
  if (request.condition.front().surroundings.kind != SurroundingsKind::kGround)
    return keyed_problem("land",
                         "land needs [surroundings] kind = \"ground\", which lies beyond "
                         "its map");
  for (const ConditionSpec& c : request.condition) {
    if (c.land_temperature_k.size() != kinds ||
        (!c.land_temperature_error_k.empty() && c.land_temperature_error_k.size() != kinds))
      return absl::InvalidArgumentError(
          "a condition does not state one temperature for each kind of the land");
    if (c.gas != nullptr)
      return keyed_problem("plume",
                           "hot gas before land is not modelled; leave out [plume] or "
                           "[land]");
    if (c.above_surface_m != request.condition.front().above_surface_m)
      return keyed_problem("above_surface_m",
                           "on land all conditions of a sweep need the same above_surface_m; put "
                           "other heights into sweeps of their own");
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status check_request(const PreparedScene& scene, const ViewRequest& request) {
  const Viewpoint& viewpoint = request.viewpoint;
  RETURN_IF_ERROR(check_outside(scene.target, viewpoint));
  for (const ConditionSpec& c : request.condition)
    if (c.part_temperature_k.size() != scene.target.part.size())
      return absl::InvalidArgumentError("a condition does not state one temperature for each part");
  for (const ConditionSpec& c : request.condition)
    if (c.surroundings.kind != request.condition.front().surroundings.kind)
      return keyed_problem("surroundings.kind",
                           "all conditions of a sweep need the same kind, since paths are traced "
                           "once for all");
  if (request.accuracy.max_samples_per_replicate > kMostSamples ||
      request.accuracy.samples_per_replicate > kMostSamples)
    return keyed_problem("accuracy", absl::StrCat("more than ", kMostSamples,
                                                  " samples in a replicate; use more replicates"));
  if (request.condition.empty() || scene.band.empty())
    return absl::InvalidArgumentError("a sweep needs a condition and a band");
  if (request.condition.front().surroundings.kind != SurroundingsKind::kNone) {
    const double el = viewpoint.aspect_elevation_deg * std::numbers::pi / 180;
    const double along = viewpoint.range_m * std::cos(el);
    double height = viewpoint.range_m * std::sin(el) + along * along / (2 * kEarthRadiusM);
    const auto lowest = std::min_element(request.condition.begin(), request.condition.end(),
                                         [](const ConditionSpec& a, const ConditionSpec& b) {
                                           return a.above_surface_m < b.above_surface_m;
                                         });
    height += lowest->above_surface_m;
    if (height < 0)
      return keyed_problem(
          "viewpoints",
          absl::StrCat("a sensor at ", viewpoint.range_m, " m range and ",
                       viewpoint.aspect_elevation_deg, " deg elevation is under the sea"));
  }
  if (request.land != nullptr) RETURN_IF_ERROR(check_land(scene, request));
  return check_in_sight(scene.target, request.condition, request.environment.get(),
                        request.land.get(), viewpoint);
}

absl::StatusOr<MadePlan> make_plan(const PreparedScene& scene, const ViewRequest& request) {
  RETURN_IF_ERROR(check_request(scene, request));
  const AccuracySpec& accuracy = request.accuracy;
  const bool goal = accuracy.relative_error > 0;
  const bool automatic = request.effects.mode == EffectChoice::Mode::kAuto && goal;
  const bool forced_off = request.effects.mode == EffectChoice::Mode::kOnly;
  const std::size_t bands = scene.axis.bands();
  const RowKeys all{all_of(request.condition.size()), all_of(bands)};
  std::shared_ptr<const AimedView> aimed;
  if (goal || accuracy.target_paths > 0 || forced_off)
    aimed = std::make_shared<const AimedView>(make_aimed_view(scene.target, request.viewpoint));
  std::shared_ptr<const UndersampledSources> unseen;
  if (aimed != nullptr)
    unseen = std::make_shared<const UndersampledSources>(scene.target, scene.facets,
                                                         scene.carried_material(), aimed->frame);
  const std::uint64_t seed = view_seed(scene, request);
  ASSIGN_OR_RETURN(auto surroundings,
                   ViewSurroundings::make(request, scene.target, request.viewpoint.range_m,
                                          scene.axis.node_um()));

  ViewPlan plan = plan_with_everything(request);
  plan.samples_per_replicate = accuracy.samples_per_replicate;
  if (goal) plan.absolute_floor_w_m2_sr = absolute_floors(scene, request, surroundings);

  // A pilot of the emission alone decides what is left out, unless nothing could be.
  const std::uint64_t emission_size = emission_samples(accuracy.relative_error);
  std::optional<MeasuredView> emission;
  std::shared_ptr<const PreparedView> emission_view;
  EffectSet without_reflections = plan.effects;
  without_reflections.max_reflections = 0;
  std::vector<RowBounds> rows = effects_without_bounds(scene, request);
  const bool decided =
      forced_off ||
      (automatic && worth_a_pilot(effect_bounds(scene, request,
                                                best_case(scene, request, plan, surroundings,
                                                          emission_size * accuracy.replicates),
                                                nullptr, surroundings),
                                  bands, request));
  if (decided) {
    ViewPlan emission_plan = plan;
    emission_plan.effects = without_reflections;
    emission_view = std::make_shared<const PreparedView>(
        PreparedView{aimed, surroundings.without_light(), without_reflections, unseen});
    emission.emplace(scene, request, emission_plan, emission_view, all, seed);
    run_view(*emission, emission_size, kEmissionStage, RunKind::kPilot);
    plan.pilot_rays += emission->totals.counts.rays;
    rows = effect_bounds(scene, request, limits_of(*emission), unseen.get(), surroundings);
  }
  if (request.max_reflections == 0) take_out_reflections(rows);
  EffectPlanner planner(rows, bands, request.effects);
  if (decided) planner.decide();
  carry_out(planner, request, scene.target, automatic, plan);
  if (forced_off) RETURN_IF_ERROR(check_forced(rows, planner, bands));

  const auto prepared = [&](ViewEnvironments environments) {
    return std::make_shared<const PreparedView>(
        PreparedView{aimed, std::move(environments), plan.effects, unseen});
  };
  if (!goal && accuracy.target_paths <= 0) {
    if (!forced_off) return MadePlan{std::move(plan), nullptr};
    // With it the bound of the lines, if they are left out.
    ASSIGN_OR_RETURN(auto seen, see_planned(request, rows, bands, surroundings, planner, plan));
    auto view = prepared(std::move(seen));
    return MadePlan{std::move(plan), std::move(view)};
  }
  std::shared_ptr<const PreparedView> view;
  ForGoal wanted;
  if (emission && automatic && plan.effects.max_reflections == 0 && request.max_reflections > 0) {
    // The pilot of the emission was the pilot of all there is.
    emission->leave_out(plan.omitted);
    ASSIGN_OR_RETURN(auto seen, surroundings.evaluate(all.condition, plan.effects));
    view = prepared(std::move(seen));
    if (backface_fraction_at_least(*emission) > request.accepted_backface_fraction) {
      plan.samples_per_replicate = emission_size;
      return MadePlan{std::move(plan), std::move(view)};
    }
    ViewPlan emission_plan = plan;
    emission_plan.effects = without_reflections;
    wanted = for_goal(scene, request, emission_plan, *emission_view, *emission, all, emission_size,
                      plan.pilot_rays);
  } else {
    ASSIGN_OR_RETURN(auto seen, decided
                                    ? see_planned(request, rows, bands, surroundings, planner, plan)
                                    : surroundings.evaluate(all.condition, plan.effects));
    view = prepared(std::move(seen));
    MeasuredView pilot(scene, request, plan, view, all, seed);
    if (!goal) {
      RETURN_IF_ERROR(count_target_paths(pilot, accuracy, plan));
      return MadePlan{std::move(plan), std::move(view)};
    }
    run_view(pilot, kFirstPilotSamples, kFirstPilotStage, RunKind::kPilot);
    plan.pilot_rays += pilot.totals.counts.rays;
    if (automatic && !decided) {
      // The bounds are for the ledger, and for what late reflections may take.
      rows = effect_bounds(scene, request, limits_of(pilot), unseen.get(), surroundings);
      planner = EffectPlanner(rows, bands, request.effects);
      plan.ledger = planner.ledger();
    }
    if (backface_fraction_at_least(pilot) > request.accepted_backface_fraction) {
      plan.samples_per_replicate = kFirstPilotSamples;
      return MadePlan{std::move(plan), std::move(view)};
    }
    if (automatic && plan.effects.parts && !request.effects.keeps(Effect::kInterReflection))
      leave_out_late_reflections(pilot, planner, plan);
    wanted = for_goal(scene, request, plan, *view, pilot, all, kFirstPilotSamples, plan.pilot_rays);
  }
  if (automatic) plan.room = planner.room();
  plan.samples_per_replicate = wanted.samples;
  if (wanted.aimed != nullptr) {
    plan.bright = wanted.aimed->bright;
    PreparedView aimed_view = *view;
    aimed_view.aimed = wanted.aimed;
    view = std::make_shared<const PreparedView>(std::move(aimed_view));
  }
  plan.limited = plan.samples_per_replicate > accuracy.max_samples_per_replicate;
  plan.samples_per_replicate =
      std::min(plan.samples_per_replicate, accuracy.max_samples_per_replicate);
  return MadePlan{std::move(plan), std::move(view)};
}

}  // namespace irsig
