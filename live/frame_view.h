#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/plume/plume_field.h"
#include "core/signature/view/prepared_view.h"
#include "core/signature/view/view_pictures.h"
#include "core/sources/land.h"
#include "core/transport/ray_batch.h"
#include "live/background_table.h"
#include "live/frame.h"
#include "live/gas_rays.h"

namespace irsig {

// Pixels of a tile along a side, and of a tile.
inline constexpr std::uint32_t kTileSide = 8, kTilePixels = kTileSide * kTileSide;

// Packets and sums that a thread needs for itself.
struct FrameWorker {
  RayPacket packet[kTilePixels / RayPacket::kSize];  // to the target
  RayPacket land[kTilePixels / RayPacket::kSize];
  RayPacket to_sun;
  LandMix mix;
  float sun_of[kTilePixels] = {};  // sunlight of land where nothing shades it
  std::vector<float> brdf;
};

// One camera's frame, ready to be drawn: the hits of a tile's rays, and the light that comes from
// there. Any number of threads may trace tiles, each with its own worker.
class FrameView {
 public:
  // The sweep, the land and the lights outlive this.
  FrameView(const LiveSweep& sweep, const LandRays* land, const PlaceLights& lights,
            const ViewRequest& request, PlaceGrid::Seen seen, const ViewFrame& frame,
            const PictureFrame& pictures);

  [[nodiscard]] std::uint32_t columns() const {
    return (pictures_.width_px + kTileSide - 1) / kTileSide;
  }
  [[nodiscard]] std::uint32_t rows() const {
    return (pictures_.height_px + kTileSide - 1) / kTileSide;
  }

  using Light = std::array<float, kLiveLights.size()>;  // [LiveLight]
  struct Sample {
    Light light{};
    LiveClass met = 0;
    std::uint32_t thing = 0;  // of one surface: part and facet's side, or land's
    double range_m = 0, temperature_k = 0;
    float gas_error = 0;  // error of the hot gas: half the range of nine pixels in ten [W/(m2 sr)]
  };

  // Traces the samples of one tile, [pixel of the tile], for one place within pixels.
  //   before  the tile's samples at another place, or null: land beside them is in the sun as there
  void trace_tile(std::uint32_t tile_x, std::uint32_t tile_y, float sx, float sy,
                  FrameWorker& worker, const Sample* before, Sample* out) const;

  struct Place {
    std::uint32_t x, y;
  };
  // Returns the place of a pixel in its tile: packets are blocks of 4 x 4 pixels.
  [[nodiscard]] static Place place(std::uint32_t i) {
    const std::uint32_t block = i / 16, in = i % 16;
    return {(block % 2) * 4 + in % 4, (block / 2) * 4 + in / 4};
  }

  // Marches the rays of hot gas, before any tile is traced.
  void trace_gas(TileThreads& threads);
  // Returns true if the condition has hot gas, and the tables have none of its light.
  [[nodiscard]] bool lacks_gas() const { return gas_ != nullptr && gas_rays_ == nullptr; }
  // Flags pixels of hot gas that no ray meets, or all that may show some if tables have none of its
  // light.
  void flag_gas(std::vector<std::uint8_t>& edge) const;

  [[nodiscard]] std::string name_of(LiveClass met, const schema::Sweep& sweep) const;

 private:
  static Light total_of(float emitted, float sun, float reflected, float air) {
    return {emitted + sun + reflected + air, emitted, sun, reflected, air};
  }
  static void add_sun_to(float sun, Sample& sample) {
    sample.light[0] += sun;
    sample.light[static_cast<std::size_t>(LiveLight::kSun)] += sun;
    ++sample.met;
  }
  // Adds hot gas to a sample at a place of the picture: its emission, less the light from behind
  // that it absorbs. Light of the air in front stays.
  void add_gas(double x_px, double y_px, Sample& sample) const;
  // Returns the light of air and background in the middle of the picture.
  [[nodiscard]] float light_ahead() const;
  [[nodiscard]] Vec<Body> direction_at(double x_px, double y_px) const;
  void find_target_rectangle();
  [[nodiscard]] bool overlaps_target(std::uint32_t tile_x, std::uint32_t tile_y) const;

  // Traces rays against the target (view_target.cpp).
  void trace_target(const Vec<Body>* direction, FrameWorker& worker) const;
  // Returns false if the ray passes the target, or its hit is hidden.
  bool shade_target(Vec<Body> d, FrameWorker& worker, std::uint32_t i, Sample& out) const;
  // Returns the radiance that a material of that table reflects of one part of the target, as if
  // the part were all around it.
  [[nodiscard]] float own_part(std::uint32_t emitter, const float* table, float cos_o) const;
  // Adds the sun to the samples of a tile that met the target and face it.
  void add_sun(FrameWorker& worker, Sample* out) const;
  // Keeps the lanes whose point is not shaded by land; returns their number.
  int past_land(const RayPacket& packet, std::uint32_t* lane_of, int count, RayPacket& ray) const;
  [[nodiscard]] Float3 facing(const RayPacket& packet, std::uint32_t lane) const;
  [[nodiscard]] float reflected_sun(const RayPacket& packet, std::uint32_t lane,
                                    FrameWorker& worker) const;

  // Converts directions and positions to the land's local frame (view_land.cpp): turned() a
  // direction of the body frame, place_of() a position relative to the target's centre.
  [[nodiscard]] Vec<Enu> turned(Vec<Body> d) const;
  [[nodiscard]] Vec<Enu> place_of(Vec<Body> p) const;
  // Returns the direction in which a line of sight leaves the sensor: higher than a straight line
  // to the same point (Land).
  [[nodiscard]] Vec<Enu> in_sight(Vec<Body> d) const;
  void trace_land(const Vec<Body>* direction, FrameWorker& worker) const;
  // Returns false if the ray meets no land.
  bool shade_land(Vec<Body> d, FrameWorker& worker, std::uint32_t i, Sample& out) const;
  // Adds the sun to the samples of a tile that met land in the sun.
  void add_sun_on_land(FrameWorker& worker, const Vec<Body>* direction, const Sample* before,
                       Sample* out) const;
  // Adds the sun to samples of land that no land shades, unless the target does.
  void add_sun_past_target(FrameWorker& worker, const Vec<Body>* direction, const std::uint32_t* of,
                           int count, Sample* out) const;

  const PreparedScene& scene_;
  const Target& target_;
  const OwnParts& own_;
  bool parts_;
  const LightFrame& of_;
  PlaceGrid::Seen seen_;
  BackgroundTable background_;
  ViewFrame frame_;
  PictureFrame pictures_;
  double pixel_m_;
  std::shared_ptr<const PlumeField> gas_;  // null: the condition has none
  std::unique_ptr<GasRays> gas_rays_;      // null: no gas, or none that a table has
  const LandRays* rays_ = nullptr;
  std::optional<Land> land_;
  // The target's heading and height, and the lines of sight, in the land's local frame.
  struct LandFrame {
    double cos_heading = 1, sin_heading = 0, surface_m = 0;
    Vec<Enu> sensor, slope, sun;
  };
  LandFrame land_frame_;
  const Emitters* emitters_ = nullptr;
  std::optional<Plane> plane_;
  Float3 sun_{0, 0, 0};
  struct Pixels {  // a rectangle
    double x0 = 0, x1 = 0, y0 = 0, y1 = 0;
  };
  Pixels target_px_;
};

}  // namespace irsig
