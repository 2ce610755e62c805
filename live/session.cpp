#include "live/session.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <utility>

#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "live/joined_frames.h"

namespace irsig {
namespace {

// Relative error of pixels before anything was measured of their class, and the least that is
// stated: rounding of the float16 that is shown, and differences that so few pixels do not show.
constexpr double kUnknownError = 0.08, kLeastError = 0.002;
// Errors of other views over those of the view in which they were measured: 1 covered 85 % of a
// ship's pixels from another side (tests/system/fly_test.py).
constexpr double kOtherViews = 1.6;
// Errors are learnt from a picture of so many pixels and rays.
constexpr std::uint32_t kTrialWidth = 80, kTrialSamples = 32;
constexpr double kTrialInView = 2.6;  // of the target's radius, on both sides together
// A second picture is seen from the other side, from above or level: a view of a hull's sides has
// no sunlit decks, whose errors were four times as large.
constexpr double kOtherAzimuthDeg = 130, kOtherElevationDeg = 45;
// Rays of a pixel in the first and in the last round of a picture at rest, by each thread.
constexpr std::uint32_t kRestingSamples = 8, kMostRestingSamples = 256;
// Pictures that are measured side by side: each takes the memory of a job.
constexpr std::uint32_t kMostSideBySide = 4;
// Samples of each replicate of the row that is measured beside an image.
constexpr std::uint64_t kRowSamples = 64;
constexpr std::size_t kMostStages = 6;
constexpr auto kRestBegins = std::chrono::milliseconds(150);

// Lowers the priority of the calling thread.
void let_frames_first() { setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 19); }

// Returns the layer "at_sensor" of the asked band. Pixels in which rays met the target are of class
// 1, all others of 0.
LiveFrame at_sensor(const ViewResult& view, const LiveAsk& ask) {
  const auto row = std::find_if(view.row.begin(), view.row.end(),
                                [&](const auto& r) { return r.band == ask.band; });
  const LayerImage& layer = row->layer.front();
  LiveFrame out;
  out.width_px = ask.camera.width_px;
  out.height_px = ask.camera.height_px;
  out.radiance_w_m2_sr = layer.value;
  for (const float e : layer.stderr_) out.error.push_back(1.645f * e);
  out.edge.assign(layer.value.size(), 0);
  out.met.assign(layer.value.size(), 0);
  for (const TracedPictures::Met& met : view.seen) out.met[met.pixel] = 1;
  return out;
}

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
  bool tried = false;         // whether a small picture was measured for it

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
  RETURN_IF_ERROR(out->try_small(*stage, first));
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
  // A viewer that rests asks again and again: the processors belong to the estimator then.
  if (!drawn_ || !(drawn_->ask == ask && drawn_->ask.samples == ask.samples)) {
    stage->ahead->moved(ask.camera.viewpoint());
    ASSIGN_OR_RETURN(auto frame, stage->tracer->draw(ask.camera, ask.samples, ask.light));
    drawn_ = Drawn{ask, {std::move(frame), LiveState::kMoving}};
  }
  stage->state_errors(drawn_->picture.frame);
  return drawn_->picture;
}

absl::StatusOr<LivePick> LiveSession::pick(const LiveAsk& ask, std::uint32_t x, std::uint32_t y) {
  const std::lock_guard lock(drawing_);
  ASSIGN_OR_RETURN(const auto stage, stage_of(ask));
  return stage->tracer->pick(ask.camera, x, y);
}

absl::StatusOr<LiveFrame> LiveSession::measure(const LiveAsk& ask) {
  ASSIGN_OR_RETURN(auto of, request_of(ask));
  // Rays of images are chosen for all bands of a job.
  of.request.selected_band.clear();
  for (std::uint32_t b = 0; b < of.sweep->simulator().bands().size(); ++b)
    of.request.selected_band.push_back(b);
  of.request.image->relative_error = kStoredPixelErrorPercent / 100;
  ASSIGN_OR_RETURN(auto planned, of.sweep->simulator().prepare(of.request));
  // The rays of images are their own: the row beside them needs few here.
  planned.plan.samples_per_replicate =
      std::min<std::uint64_t>(planned.plan.samples_per_replicate, kRowSamples);
  ASSIGN_OR_RETURN(const auto view, of.sweep->simulator().measure(of.request, planned));
  return at_sensor(view, ask);
}

absl::StatusOr<LiveFrame> LiveSession::measure_quickly(const LiveAsk& ask, std::uint32_t samples,
                                                       std::uint64_t seed) {
  ASSIGN_OR_RETURN(auto of, request_of(ask));
  of.request.selected_band = {ask.band};
  of.request.image->samples = samples;
  of.request.seed += seed;
  AccuracySpec few;
  few.replicates = of.request.accuracy.replicates;
  few.samples_per_replicate = kRowSamples;
  of.request.accuracy = few;
  ASSIGN_OR_RETURN(const auto view, of.sweep->simulator().simulate(of.request));
  return at_sensor(view, ask);
}

absl::StatusOr<LiveSession::Asked> LiveSession::request_of(const LiveAsk& ask) {
  Asked out;
  {
    const std::lock_guard lock(drawing_);
    ASSIGN_OR_RETURN(out.sweep, sweep_of(ask));
  }
  ASSIGN_OR_RETURN(out.request, out.sweep->request(0, ask.band, ask.camera));
  out.request.effects = live_effects(ask.effects, out.request.effects);
  return out;
}

std::vector<absl::StatusOr<LiveFrame>> LiveSession::measure_side_by_side(const LiveAsk& ask,
                                                                         std::uint32_t samples,
                                                                         std::uint64_t seed) {
  const std::uint32_t count = std::min(threads_->threads(), kMostSideBySide);
  std::vector<std::future<absl::StatusOr<LiveFrame>>> others;
  for (std::uint32_t k = 1; k < count; ++k)
    others.push_back(std::async(std::launch::async, [this, &ask, samples, seed, k] {
      let_frames_first();
      return measure_quickly(ask, samples, seed + k);
    }));
  std::vector<absl::StatusOr<LiveFrame>> out;
  out.push_back(measure_quickly(ask, samples, seed));
  for (auto& other : others) out.push_back(other.get());
  return out;
}

absl::Status LiveSession::try_small(Stage& stage, const LiveAsk& ask) {
  {
    const std::lock_guard lock(stage.learning);
    if (std::exchange(stage.tried, true)) return absl::OkStatus();
  }
  RETURN_IF_ERROR(try_view(stage, ask));
  if (stage.sweep->land() != nullptr) return absl::OkStatus();
  LiveAsk other = ask;
  LiveCamera& c = other.camera;
  c.azimuth_deg = std::fmod(c.azimuth_deg + kOtherAzimuthDeg, 360.0);
  c.elevation_deg = c.elevation_deg < kOtherElevationDeg / 2 ? kOtherElevationDeg : 0;
  // Where no sensor can be, no view has other errors.
  (void)try_view(stage, other);
  return absl::OkStatus();
}

absl::Status LiveSession::try_view(Stage& stage, const LiveAsk& ask) {
  LiveAsk trial = ask;
  LiveCamera& c = trial.camera;
  c.height_px = std::max(kLeastLivePixels, kTrialWidth * c.height_px / c.width_px);
  c.width_px = kTrialWidth;
  trial.light = LiveLight::kTotal;
  const Target& target = stage.sweep->simulator().target();
  if (stage.sweep->land() == nullptr) {  // the target fills it, so that few pixels show all of it
    c.look_at_m = target.centre;
    c.field_of_view_deg =
        std::clamp(kTrialInView * std::atan(target.radius_m / c.range_m) / kRadPerDeg, 0.01, 120.0);
  }
  ASSIGN_OR_RETURN(const auto truth, measure_quickly(trial, kTrialSamples, 0));
  learn(stage, trial, truth);
  return absl::OkStatus();
}

std::shared_ptr<LiveSession::Stage> LiveSession::known_stage(const LiveAsk& ask) {
  const std::lock_guard drawing(drawing_);
  auto known = stage_of(ask);
  return known.ok() ? *std::move(known) : nullptr;
}

void LiveSession::learn(const LiveAsk& ask, const LiveFrame& truth) {
  if (const auto stage = known_stage(ask); stage != nullptr) learn(*stage, ask, truth);
}

void LiveSession::learn(Stage& stage, const LiveAsk& ask, const LiveFrame& truth) {
  // Errors of moving frames have the interpolation between nodes in them.
  while (stage.grid->make_one(ask.camera.viewpoint())) {
  }
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
    // The stated error does not repeat what the scatter of samples states.
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

bool LiveSession::refine(const LiveAsk& ask, std::uint64_t begun,
                         std::unique_lock<std::mutex>& lock) {
  JoinedFrames joined;
  std::uint64_t seed = 0;
  for (std::uint32_t samples = kRestingSamples; samples <= kMostRestingSamples; samples *= 2) {
    lock.unlock();
    const auto measured = measure_side_by_side(ask, samples, seed);
    seed += measured.size();
    bool ok = true;
    for (const auto& one : measured) {
      ok = ok && one.ok();
      if (one.ok()) joined.add(*one, samples);
    }
    LiveFrame frame;
    if (ok) frame = joined.mean();
    const PictureErrors errors = errors_of(frame);
    lock.lock();
    if (!ok || stopped_ || moved_ != begun) return false;
    rested_ = ask;
    rest_ = {std::move(frame), LiveState::kResting};
    if (100 * errors.rms <= kRestingRmsPercent &&
        100 * errors.percentile_99 <= kRestingPercentile99Percent)
      break;
  }
  return true;
}

// Measures what is asked for once it has been the same for a while, first with few rays.
void LiveSession::rest() {
  let_frames_first();
  std::unique_lock lock(resting_);
  std::uint64_t done = 0;
  while (!stopped_) {
    wake_.wait(lock, [&] { return stopped_ || (wanted_ && moved_ != done); });
    if (stopped_) return;
    {
      // Errors of a new choice are measured at once, by a small picture, while the camera moves.
      const LiveAsk seen = *wanted_;
      lock.unlock();
      if (const auto stage = known_stage(seen); stage != nullptr)
        (void)try_small(*stage, seen);  // else they stay as wide as those of an unknown class
      lock.lock();
      if (stopped_) return;
    }
    const std::uint64_t begun = moved_;
    if (wake_.wait_for(lock, kRestBegins, [&] { return stopped_ || moved_ != begun; })) continue;
    const LiveAsk ask = *wanted_;
    if (refine(ask, begun, lock)) {
      lock.unlock();
      const auto measured = measure(ask);
      if (measured.ok()) learn(ask, *measured);
      lock.lock();
      if (measured.ok() && wanted_ == ask) {
        rested_ = ask;
        rest_ = {*measured, LiveState::kStored};
      }
    }
    done = begun;
  }
}

}  // namespace irsig
