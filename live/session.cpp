#include "live/session.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "core/base/status_macros.h"

namespace irsig {
namespace {

// Of pixels, relative, before anything was measured of their class; least that is stated: rounding
// of the float16 that is shown, and differences that so few pixels do not show.
constexpr double kUnknownError = 0.08, kLeastError = 0.002;
// Errors of other views over those of the view in which they were measured: 1 covered 85 % of a
// ship's pixels from another side (tests/system/fly_test.py).
constexpr double kOtherViews = 1.6;
// Errors are learnt from a picture of so many pixels and rays.
constexpr std::uint32_t kTrialWidth = 80, kTrialSamples = 32;
constexpr std::uint32_t kRestingSamples = 8;
constexpr std::size_t kMostStages = 6;
constexpr auto kRestBegins = std::chrono::milliseconds(150);

bool same_light(const LiveAsk& a, const LiveAsk& b) {
  return a.condition == b.condition && a.minute == b.minute && a.visibility_m == b.visibility_m;
}
bool same_stage(const LiveAsk& a, const LiveAsk& b) {
  return same_light(a, b) && a.band == b.band && a.effects == b.effects;
}

}  // namespace

bool operator==(const LiveAsk& a, const LiveAsk& b) {
  return same_stage(a, b) && a.camera == b.camera && a.light == b.light;
}

// One choice of condition, band and effects, with its tables.
struct LiveSession::Stage {
  LiveAsk ask;
  std::shared_ptr<const LiveSweep> sweep;
  std::unique_ptr<const PlaceLights> lights;
  std::unique_ptr<PlaceGrid> grid;
  std::unique_ptr<FrameTracer> tracer;
  std::unique_ptr<PlaceAhead> ahead;
  std::mutex learning;
  std::vector<double> error;  // [LiveClass] relative, of nine pixels in ten
  std::vector<bool> learnt;   // [LiveClass] whether it was measured

  // States the error of each pixel: what was measured of its class, and the scatter of its samples.
  void state_errors(LiveFrame& frame) {
    const std::lock_guard lock(learning);
    frame.error.resize(frame.radiance_w_m2_sr.size());
    for (std::size_t i = 0; i < frame.error.size(); ++i) {
      const auto of_class = static_cast<float>(error[frame.met[i]]);
      frame.error[i] = std::hypot(of_class * frame.radiance_w_m2_sr[i], frame.spread[i]);
    }
  }
};

absl::StatusOr<std::shared_ptr<const LiveSweep>> LiveSession::sweep_of(const LiveAsk& ask) {
  for (const auto& stage : stage_)
    if (same_light(stage->ask, ask)) return stage->sweep;
  ASSIGN_OR_RETURN(auto input, make_(ask));
  if (base_ == nullptr || input.resolved.heat_size() > 0)
    return LiveSweep::make(std::move(input.resolved), input.assets, input.heat);
  return base_->with_conditions(std::move(input.resolved), input.assets, input.heat);
}

absl::StatusOr<std::shared_ptr<LiveSession::Stage>> LiveSession::stage_of(const LiveAsk& ask) {
  const auto known = std::find_if(stage_.begin(), stage_.end(),
                                  [&](const auto& s) { return same_stage(s->ask, ask); });
  if (known != stage_.end()) {
    stage_.splice(stage_.begin(), stage_, known);
    return stage_.front();
  }
  RETURN_IF_ERROR(check_camera(ask.camera));
  auto out = std::make_shared<Stage>();
  out->ask = ask;
  ASSIGN_OR_RETURN(out->sweep, sweep_of(ask));
  const auto bands = static_cast<std::uint32_t>(out->sweep->simulator().bands().size());
  if (ask.band >= bands) return absl::InvalidArgumentError("band is beyond those of the sweep");
  if (base_ == nullptr) base_ = out->sweep;
  ASSIGN_OR_RETURN(out->lights, PlaceLights::make(out->sweep, nullptr, {0, ask.band, ask.effects},
                                                  ask.camera.viewpoint()));
  if (out->sweep->land() != nullptr && land_ == nullptr) {
    ASSIGN_OR_RETURN(land_, LandRays::make(*base_->land(),
                                           out->lights->land_bend_per_m(ask.camera.viewpoint())));
  }
  out->grid = std::make_unique<PlaceGrid>(*out->lights);
  out->tracer =
      std::make_unique<FrameTracer>(*out->sweep, land_.get(), *out->lights, *out->grid, *threads_);
  out->ahead = std::make_unique<PlaceAhead>(*out->grid);
  out->error.assign(out->tracer->classes(), kUnknownError);
  out->learnt.assign(out->tracer->classes(), false);
  stage_.push_front(out);
  if (stage_.size() > kMostStages) stage_.pop_back();
  return out;
}

absl::StatusOr<std::unique_ptr<LiveSession>> LiveSession::open(MakeLiveInput make,
                                                               const LiveAsk& first,
                                                               std::uint32_t threads) {
  std::unique_ptr<LiveSession> out(new LiveSession);
  out->make_ = std::move(make);
  out->threads_ = std::make_unique<TileThreads>(threads);
  ASSIGN_OR_RETURN(const auto stage, out->stage_of(first));
  LiveAsk trial = first;
  trial.camera.height_px =
      std::max(kLeastLivePixels, kTrialWidth * first.camera.height_px / first.camera.width_px);
  trial.camera.width_px = kTrialWidth;
  ASSIGN_OR_RETURN(const auto truth, out->measure(trial, kTrialSamples));
  out->learn(*stage, trial, truth);
  out->rester_ = std::thread([raw = out.get()] { raw->rest(); });
  return out;
}

LiveSession::~LiveSession() {
  {
    const std::lock_guard lock(resting_);
    stopped_ = true;
  }
  wake_.notify_all();
  if (rester_.joinable()) rester_.join();
}

absl::StatusOr<LivePicture> LiveSession::picture(const LiveAsk& ask) {
  {
    const std::lock_guard lock(resting_);
    if (!wanted_ || !(*wanted_ == ask)) {
      wanted_ = ask;
      ++moved_;
      wake_.notify_all();
    }
    if (ask.light == LiveLight::kTotal && rested_ && *rested_ == ask) return rest_;
  }
  const std::lock_guard lock(drawing_);
  ASSIGN_OR_RETURN(const auto stage, stage_of(ask));
  stage->ahead->moved(ask.camera.viewpoint());
  LivePicture out;
  ASSIGN_OR_RETURN(out.frame, stage->tracer->draw(ask.camera, ask.samples, ask.light));
  stage->state_errors(out.frame);
  return out;
}

absl::StatusOr<LivePick> LiveSession::pick(const LiveAsk& ask, std::uint32_t x, std::uint32_t y) {
  const std::lock_guard lock(drawing_);
  ASSIGN_OR_RETURN(const auto stage, stage_of(ask));
  return stage->tracer->pick(ask.camera, x, y);
}

absl::StatusOr<LiveFrame> LiveSession::measure(const LiveAsk& ask, std::uint32_t samples) {
  std::shared_ptr<const LiveSweep> sweep;
  {
    const std::lock_guard lock(drawing_);
    ASSIGN_OR_RETURN(sweep, sweep_of(ask));
  }
  ASSIGN_OR_RETURN(auto request, sweep->request(0, ask.band, ask.camera));
  // Rays of images are chosen for all bands of a job.
  request.selected_band.clear();
  for (std::uint32_t b = 0; b < sweep->simulator().bands().size(); ++b)
    request.selected_band.push_back(b);
  request.effects = live_effects(ask.effects, request.effects);
  if (samples > 0) {
    request.image->samples = samples;
    request.selected_band = {ask.band};
  } else {
    request.image->relative_error = kStoredPixelErrorPercent / 100;
  }
  ASSIGN_OR_RETURN(auto planned, sweep->simulator().prepare(request));
  // The rays of images are their own: the row beside them needs few here.
  planned.plan.samples_per_replicate =
      std::min<std::uint64_t>(planned.plan.samples_per_replicate, 64);
  ASSIGN_OR_RETURN(const auto view, sweep->simulator().measure(request, planned));
  const auto row = std::find_if(view.row.begin(), view.row.end(),
                                [&](const auto& r) { return r.band == ask.band; });
  const LayerImage& layer = row->layer.front();
  LiveFrame out;
  out.width_px = ask.camera.width_px;
  out.height_px = ask.camera.height_px;
  out.radiance_w_m2_sr = layer.value;
  for (const float e : layer.stderr_) out.error.push_back(1.645f * e);
  out.edge.assign(layer.value.size(), 0);
  return out;
}

void LiveSession::learn(Stage& stage, const LiveAsk& ask, const LiveFrame& truth) {
  LiveFrame frame;
  {
    const std::lock_guard lock(drawing_);
    auto drawn = stage.tracer->draw(ask.camera, ask.samples, LiveLight::kTotal);
    if (!drawn.ok()) return;
    frame = *std::move(drawn);
  }
  std::vector<std::vector<double>> difference(stage.error.size());
  for (std::size_t i = 0; i < frame.met.size(); ++i) {
    const auto is = static_cast<double>(truth.radiance_w_m2_sr[i]);
    if (frame.edge[i] != 0 || !(is > 0)) continue;
    // What the scatter of samples states already is not stated twice.
    const double off = std::abs(static_cast<double>(frame.radiance_w_m2_sr[i]) - is),
                 scatter = static_cast<double>(frame.spread[i]);
    difference[frame.met[i]].push_back(std::sqrt(std::max(0.0, off * off - scatter * scatter)) /
                                       is);
  }
  const std::lock_guard lock(stage.learning);
  constexpr std::size_t kEnough = 20;  // pixels
  for (std::size_t c = 0; c < difference.size(); ++c) {
    std::vector<double>& of = difference[c];
    if (of.size() < kEnough) continue;
    const auto at =
        of.begin() + static_cast<std::ptrdiff_t>(0.93 * static_cast<double>(of.size() - 1));
    std::nth_element(of.begin(), at, of.end());
    const double here = std::max(kLeastError, kOtherViews * *at);
    stage.error[c] = stage.learnt[c] ? std::max(stage.error[c], here) : here;
    stage.learnt[c] = true;
  }
}

// Measures what is asked for once it has been the same for a while, first with few rays.
void LiveSession::rest() {
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 19);  // frames come first
  std::unique_lock lock(resting_);
  std::uint64_t done = 0;
  while (!stopped_) {
    wake_.wait(lock, [&] { return stopped_ || (wanted_ && moved_ != done); });
    if (stopped_) return;
    const std::uint64_t begun = moved_;
    if (wake_.wait_for(lock, kRestBegins, [&] { return stopped_ || moved_ != begun; })) continue;
    const LiveAsk ask = *wanted_;
    for (const LiveState state : {LiveState::kResting, LiveState::kStored}) {
      lock.unlock();
      const auto measured = measure(ask, state == LiveState::kResting ? kRestingSamples : 0);
      if (measured.ok() && state == LiveState::kStored) {
        std::shared_ptr<Stage> stage;
        {
          const std::lock_guard drawing(drawing_);
          auto known = stage_of(ask);
          if (known.ok()) stage = *std::move(known);
        }
        if (stage != nullptr) learn(*stage, ask, *measured);
      }
      lock.lock();
      if (measured.ok() && wanted_ == ask) {
        rested_ = ask;
        rest_ = {*measured, state};
      }
      if (!measured.ok() || stopped_ || moved_ != begun) break;
    }
    done = begun;
  }
}

}  // namespace irsig
