#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/statusor.h"
#include "live/frame.h"
#include "live/place_ahead.h"

namespace irsig {

// A viewer's question for a picture.
struct LiveAsk {
  LiveCamera camera;
  std::uint32_t condition = 0, band = 0;  // of the sweep as it is written
  std::optional<std::uint32_t> minute;    // of the day, UTC, instead of the condition's time
  std::optional<double> visibility_m;     // instead of that of [air]
  LiveEffects effects;
  LiveLight light = LiveLight::kTotal;
  std::uint32_t samples = 2;
};

// A sweep with one condition, resolved, with the content of its files.
struct LiveInput {
  schema::ResolvedSweep resolved;
  Assets assets;
  HeatOutputs heat;
};
// Callback: makes the sweep of a request, with the requested condition alone; the camera is
// ignored.
using MakeLiveInput = std::function<absl::StatusOr<LiveInput>(const LiveAsk&)>;

// State of a picture: by the live path, by few paths of the estimator, with the accuracy of a
// stored image.
enum class LiveState : std::uint8_t { kMoving, kResting, kStored };
struct LivePicture {
  LiveFrame frame;
  LiveState state = LiveState::kMoving;
};

// Accuracy of images that are kept: root mean square over the target's pixels. [percent]
inline constexpr double kStoredPixelErrorPercent = 2;
// Accuracy of a resting picture, at which the job's estimator continues to that of a stored image:
// root mean square, and of 99 pixels in 100. [percent]
inline constexpr double kRestingRmsPercent = 2, kRestingPercentile99Percent = 5;

// One viewer's session with a sweep: draws the requested frames, and measures the picture as a job
// does once the camera rests. Thread-safe; frames are drawn one after the other.
class LiveSession {
 public:
  // Makes the scene and the data of a first frame. threads: number for one frame. Errors: those of
  // `make`, of LiveSweep::make and of FrameTracer::draw.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<LiveSession>> open(MakeLiveInput make,
                                                                         const LiveAsk& first,
                                                                         std::uint32_t threads);
  ~LiveSession();

  [[nodiscard]] absl::StatusOr<LivePicture> picture(const LiveAsk& ask);
  [[nodiscard]] absl::StatusOr<LivePick> pick(const LiveAsk& ask, std::uint32_t x, std::uint32_t y);
  // Returns the scene with the first requested condition.
  [[nodiscard]] const LiveSweep& sweep() const { return *base_; }
  // Measures the requested picture as the sweep's job would: the layer "at_sensor", bit for bit,
  // with its errors, at the accuracy kStoredPixelErrorPercent.
  [[nodiscard]] absl::StatusOr<LiveFrame> measure(const LiveAsk& ask);
  // Measures as measure(), but with a number of rays per pixel, in the requested band alone and
  // without a pilot. Different `seed` give independent pictures.
  [[nodiscard]] absl::StatusOr<LiveFrame> measure_quickly(const LiveAsk& ask, std::uint32_t samples,
                                                          std::uint64_t seed);

 private:
  struct Stage;
  LiveSession() = default;
  [[nodiscard]] absl::StatusOr<std::shared_ptr<Stage>> stage_of(const LiveAsk& ask);
  [[nodiscard]] absl::StatusOr<std::shared_ptr<const LiveSweep>> sweep_of(const LiveAsk& ask);
  void rest();
  // Measures in rounds until the picture reaches kRestingRmsPercent and
  // kRestingPercentile99Percent; shows each round. `lock` holds resting_, except while measuring.
  // Returns false if another picture is requested meanwhile, or nothing can be measured.
  [[nodiscard]] bool refine(const LiveAsk& ask, std::uint64_t begun,
                            std::unique_lock<std::mutex>& lock);
  [[nodiscard]] std::vector<absl::StatusOr<LiveFrame>> measure_side_by_side(const LiveAsk& ask,
                                                                            std::uint32_t samples,
                                                                            std::uint64_t seed);
  // Learns the errors of a stage from two small pictures, once.
  [[nodiscard]] absl::Status try_small(Stage& stage, const LiveAsk& ask);
  // Learns from a small picture of the target, in the direction of the camera.
  [[nodiscard]] absl::Status try_view(Stage& stage, const LiveAsk& ask);
  [[nodiscard]] std::shared_ptr<Stage> known_stage(const LiveAsk& ask);
  void learn(const LiveAsk& ask, const LiveFrame& truth);
  void learn(Stage& stage, const LiveAsk& ask, const LiveFrame& truth);
  struct Asked {
    std::shared_ptr<const LiveSweep> sweep;
    ViewRequest request;
  };
  [[nodiscard]] absl::StatusOr<Asked> request_of(const LiveAsk& ask);

  MakeLiveInput make_;
  std::shared_ptr<const LiveSweep> base_;
  std::unique_ptr<const LandRays> land_;
  std::unique_ptr<TileThreads> threads_;
  std::mutex drawing_;  // guards the stages and the threads of frames
  std::list<std::shared_ptr<Stage>> stage_;
  struct Drawn {
    LiveAsk ask;
    LivePicture picture;
  };
  std::optional<Drawn> drawn_;  // last

  std::mutex resting_;  // guards the members below
  std::condition_variable wake_;
  bool stopped_ = false;
  std::uint64_t moved_ = 0;  // number of changes of the request
  std::optional<LiveAsk> wanted_;
  std::optional<LiveAsk> rested_;  // of `rest_`
  LivePicture rest_;
  std::thread rester_;
};

[[nodiscard]] bool operator==(const LiveAsk& a, const LiveAsk& b);

}  // namespace irsig
