#include "live/frame.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/base/status_macros.h"
#include "live/frame_view.h"

namespace irsig {
namespace {

constexpr std::uint32_t kMostSamples = 4;
// Places of the samples in a pixel: each row and each column of a pixel has one.
constexpr float kSampleX[3][4] = {{0.5f}, {0.25f, 0.75f}, {0.375f, 0.875f, 0.125f, 0.625f}},
                kSampleY[3][4] = {{0.5f}, {0.75f, 0.25f}, {0.125f, 0.375f, 0.625f, 0.875f}};

// Flags pixels of the target, and beside it, next to which another part is met, or the same one in
// other light: rays between those of both samples may meet either.
void flag_beside(const std::vector<std::uint32_t>& thing, LiveFrame& frame) {
  constexpr std::uint32_t kLand = 1u << 16;
  const std::uint32_t width = frame.width_px;
  const auto compare = [&](std::size_t a, std::size_t b) {
    const bool target = (thing[a] > 0 && thing[a] < kLand) || (thing[b] > 0 && thing[b] < kLand);
    if (target && (thing[a] != thing[b] || frame.met[a] != frame.met[b]))
      frame.edge[a] = frame.edge[b] = 1;
  };
  for (std::uint32_t y = 0; y < frame.height_px; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::size_t at = std::size_t{y} * width + x;
      if (x + 1 < width) compare(at, at + 1);
      if (y + 1 < frame.height_px) compare(at, at + width);
    }
}

}  // namespace

FrameTracer::FrameTracer(const LiveSweep& sweep, const LandRays* land, const PlaceLights& lights,
                         PlaceGrid& grid, TileThreads& threads)
    : sweep_(sweep), land_(land), lights_(lights), grid_(grid), threads_(threads) {
  for (std::uint32_t t = 0; t < threads.threads(); ++t)
    worker_.push_back(std::make_unique<FrameWorker>());
}
FrameTracer::~FrameTracer() = default;

std::uint32_t FrameTracer::classes() const {
  return 1 + 2 * (lights_.frame().materials + lights_.frame().land_materials);
}

absl::StatusOr<std::unique_ptr<FrameView>> FrameTracer::view(const LiveCamera& camera) {
  RETURN_IF_ERROR(check_camera(camera));
  const LiveChoice& choice = lights_.choice();
  ASSIGN_OR_RETURN(const auto request, sweep_.request(choice.condition, choice.band, camera));
  const Target& target = sweep_.simulator().target();
  RETURN_IF_ERROR(check_outside(target, request.viewpoint));
  const ViewFrame frame = make_view_frame(target, request.viewpoint);
  ASSIGN_OR_RETURN(const auto pictures, picture_frame(target, frame, request));
  ASSIGN_OR_RETURN(auto seen, grid_.at(request.viewpoint));
  auto out = std::make_unique<FrameView>(sweep_, land_, lights_, request, std::move(seen), frame,
                                         pictures);
  out->trace_gas(threads_);
  return out;
}

absl::StatusOr<LiveFrame> FrameTracer::draw(const LiveCamera& camera, std::uint32_t samples,
                                            LiveLight light) {
  const auto begin = std::chrono::steady_clock::now();
  ASSIGN_OR_RETURN(const auto made, view(camera));
  const FrameView& view = *made;
  LiveFrame out;
  out.width_px = camera.width_px;
  out.height_px = camera.height_px;
  const std::size_t pixels = std::size_t{camera.width_px} * camera.height_px;
  out.radiance_w_m2_sr.resize(pixels);
  out.spread.resize(pixels);
  out.gas_error.resize(pixels);
  out.met.resize(pixels);
  out.edge.resize(pixels);
  std::vector<std::uint32_t> things(pixels);
  samples = std::clamp(samples, 1u, kMostSamples);
  const std::uint32_t set = samples == 1 ? 0 : samples == 2 ? 1 : 2;
  const auto shown = static_cast<std::size_t>(light);
  const std::uint32_t columns = view.columns();
  threads_.run(columns * view.rows(), [&](std::uint32_t tile, std::uint32_t thread) {
    const std::uint32_t tile_x = tile % columns, tile_y = tile / columns;
    FrameView::Sample sample[kTilePixels], first[kTilePixels];
    float sum[kTilePixels] = {}, gas_error[kTilePixels] = {}, low[kTilePixels], high[kTilePixels];
    std::uint32_t thing[kTilePixels];
    bool edge[kTilePixels] = {};
    LiveClass met[kTilePixels];
    for (std::uint32_t s = 0; s < samples; ++s) {
      view.trace_tile(tile_x, tile_y, kSampleX[set][s], kSampleY[set][s], *worker_[thread],
                      s == 0 ? nullptr : first, sample);
      if (s == 0) std::copy(sample, sample + kTilePixels, first);
      for (std::uint32_t i = 0; i < kTilePixels; ++i) {
        const float value = sample[i].light[shown];
        sum[i] += value;
        gas_error[i] = std::max(gas_error[i], sample[i].gas_error);
        if (s == 0) {
          low[i] = high[i] = value;
          thing[i] = sample[i].thing;
          met[i] = sample[i].met;
          continue;
        }
        low[i] = std::min(low[i], value);
        high[i] = std::max(high[i], value);
        edge[i] |= thing[i] != sample[i].thing || met[i] != sample[i].met;
      }
    }
    for (std::uint32_t i = 0; i < kTilePixels; ++i) {
      const FrameView::Place p = FrameView::place(i);
      const std::uint32_t x = tile_x * kTileSide + p.x, y = tile_y * kTileSide + p.y;
      if (x >= camera.width_px || y >= camera.height_px) continue;
      const std::size_t at = std::size_t{y} * camera.width_px + x;
      out.radiance_w_m2_sr[at] = sum[i] / static_cast<float>(samples);
      out.spread[at] = std::hypot(0.5f * (high[i] - low[i]), gas_error[i]);
      out.gas_error[at] = gas_error[i];
      out.met[at] = met[i];
      out.edge[at] = edge[i] ? 1 : 0;
      things[at] = thing[i];
    }
  });
  flag_beside(things, out);
  view.flag_gas(out.edge);
  out.lacks_gas = view.lacks_gas();
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

absl::StatusOr<LivePick> FrameTracer::pick(const LiveCamera& camera, std::uint32_t x,
                                           std::uint32_t y) {
  if (x >= camera.width_px || y >= camera.height_px)
    return absl::InvalidArgumentError("the point lies beside the picture");
  ASSIGN_OR_RETURN(const auto made, view(camera));
  FrameView::Sample sample[kTilePixels];
  made->trace_tile(x / kTileSide, y / kTileSide, 0.5f, 0.5f, *worker_[0], nullptr, sample);
  LivePick out;
  for (std::uint32_t i = 0; i < kTilePixels; ++i) {
    const FrameView::Place p = FrameView::place(i);
    if (p.x != x % kTileSide || p.y != y % kTileSide) continue;
    const FrameView::Sample& s = sample[i];
    out.what = made->name_of(s.met, sweep_.resolved().sweep());
    if (s.thing > 0 && s.thing < (1u << 16))
      out.what = sweep_.simulator().target().part[s.thing - 1].name + ": " + out.what;
    out.range_m = s.range_m;
    out.temperature_k = s.temperature_k;
    out.in_sun = s.met > 0 && s.met % 2 == 0;
    for (std::size_t k = 0; k < out.light.size(); ++k)
      out.light[k] = static_cast<double>(s.light[k]);
  }
  return out;
}

}  // namespace irsig
