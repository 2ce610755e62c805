#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "live/land_rays.h"
#include "live/place_grid.h"
#include "live/tile_threads.h"

namespace irsig {

// Light that a frame shows. All except kTotal are contributions to the total, and add up to it.
enum class LiveLight : std::uint8_t { kTotal, kEmitted, kSun, kReflected, kAir };
inline constexpr std::array<const char*, 5> kLiveLights = {"total", "emitted", "sun", "reflected",
                                                           "air"};

// A class of pixels with similar errors, by the object that a ray meets. 0: neither target nor
// land; from 1 on materials of the target and then of land, each first in shade and then in the
// sun.
using LiveClass = std::uint16_t;

// One picture of the live path.
struct LiveFrame {
  std::uint32_t width_px = 0, height_px = 0;
  // [pixel], row by row from the top left
  std::vector<float> radiance_w_m2_sr;
  // Half the range of the pixel's samples, joined by gas_error. [W/(m2 sr)]
  std::vector<float> spread;
  // Error of the hot gas: half the range of nine pixels in ten. [W/(m2 sr)]
  std::vector<float> gas_error;
  bool lacks_gas = false;      // the condition has hot gas whose light is in no table
  std::vector<LiveClass> met;  // of the first sample
  std::vector<std::uint8_t>
      edge;                  // 1: its samples, or it and a pixel beside it, met different things
  std::vector<float> error;  // stated: half the range that holds 90 % of pixels [W/(m2 sr)]
  double seconds = 0;
  // Gain and offset of a frame that a camera records; 0: the frame has radiances.
  double counts_per_w_m2_sr = 0, offset_counts = 0;
};

// A place under the pointer.
struct LivePick {
  std::string what;          // "hull", "grass", "background"
  double range_m = 0;        // 0: nothing is met
  double temperature_k = 0;  // of the surface; 0: nothing is met
  bool in_sun = false;
  std::array<double, 5> light{};  // [LiveLight] W/(m2 sr)
};

class FrameView;
struct FrameWorker;

// Draws frames of one choice with direct light alone: first hits, tables of emission, sky and air,
// and rays to the sun. Not for several threads.
class FrameTracer {
 public:
  // The arguments outlive it.
  //   land  of the sweep; null: it has none
  FrameTracer(const LiveSweep& sweep, const LandRays* land, const PlaceLights& lights,
              PlaceGrid& grid, TileThreads& threads);
  ~FrameTracer();

  // Draws a frame. samples: rays per pixel, 1 to 4. Errors: those of PlaceGrid::at and
  // picture_frame.
  [[nodiscard]] absl::StatusOr<LiveFrame> draw(const LiveCamera& camera, std::uint32_t samples,
                                               LiveLight light);
  [[nodiscard]] absl::StatusOr<LivePick> pick(const LiveCamera& camera, std::uint32_t x,
                                              std::uint32_t y);
  // Returns how many classes there are.
  [[nodiscard]] std::uint32_t classes() const;

 private:
  [[nodiscard]] absl::StatusOr<std::unique_ptr<FrameView>> view(const LiveCamera& camera);

  const LiveSweep& sweep_;
  const LandRays* land_;
  const PlaceLights& lights_;
  PlaceGrid& grid_;
  TileThreads& threads_;
  std::vector<std::unique_ptr<FrameWorker>> worker_;
};

}  // namespace irsig
