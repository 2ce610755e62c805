#include "live/frame_view.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/constants.h"

namespace irsig {
namespace {

// Returns the place of a tile's pixel in the picture.
FrameView::Place pixel_of(std::uint32_t tile_x, std::uint32_t tile_y, std::uint32_t i) {
  const FrameView::Place in = FrameView::place(i);
  return {tile_x * kTileSide + in.x, tile_y * kTileSide + in.y};
}

}  // namespace

FrameView::FrameView(const LiveSweep& sweep, const LandRays* land, const PlaceLights& lights,
                     const ViewRequest& request, PlaceGrid::Seen seen, const ViewFrame& frame,
                     const PictureFrame& pictures)
    : scene_(sweep.simulator().scene()),
      target_(scene_.target),
      own_(sweep.own_parts()),
      parts_(lights.choice().effects.parts),
      of_(lights.frame()),
      seen_(std::move(seen)),
      background_(seen_.light.background, seen_.horizon_z),
      frame_(frame),
      pictures_(pictures),
      pixel_m_(pictures.rectangle.width_m / pictures.width_px) {
  const ConditionSpec& condition = request.condition[lights.choice().condition];
  gas_ = condition.gas;
  if (land != nullptr) {
    rays_ = land;
    land_.emplace(request.land, condition.above_surface_m - target_.centre.z, target_.centre,
                  of_.land_range_m, land->bend_per_m());
    land_frame_.cos_heading = std::cos(request.land->heading_deg * kRadPerDeg);
    land_frame_.sin_heading = std::sin(request.land->heading_deg * kRadPerDeg);
    land_frame_.surface_m = request.land->surface_m + condition.above_surface_m - target_.centre.z;
    land_frame_.sensor = place_of(frame_.sensor);
    land_frame_.slope = {land->bend_per_m() * land_frame_.sensor.x,
                         land->bend_per_m() * land_frame_.sensor.y, 0};
    land_frame_.sensor.z += dot(land_frame_.slope, land_frame_.sensor);
    land_frame_.sun = turned(of_.sun);
  }
  emitters_ = request.emitters.get();
  plane_ = request.land != nullptr ? std::nullopt
                                   : plane_of(boundary_of(condition, scene_.surface_z_m()));
  sun_ = {static_cast<float>(of_.sun.x), static_cast<float>(of_.sun.y),
          static_cast<float>(of_.sun.z)};
  find_target_rectangle();
  if (gas_ != nullptr && lights.gas() != nullptr)
    gas_rays_ = std::make_unique<GasRays>(*lights.gas(), seen_.light.gas, target_.centre, frame_,
                                          pictures_, light_ahead());
}

float FrameView::light_ahead() const {
  const auto z = static_cast<float>(frame_.forward.z);
  return seen_.light.path + background_.mean(z, z);
}

void FrameView::trace_gas(TileThreads& threads) {
  if (gas_rays_ == nullptr) return;
  for (std::uint32_t pitch = GasRays::kPitch; pitch > 0; pitch /= 2)
    threads.run(gas_rays_->choose(pitch),
                [this](std::uint32_t group, std::uint32_t) { gas_rays_->trace_group(group); });
}

void FrameView::add_gas(double x_px, double y_px, Sample& sample) const {
  GasRays::Seen gas;
  if (!gas_rays_->at(x_px, y_px, sample.range_m, gas)) return;
  float error = gas.error.emitted_w_m2_sr;
  const auto absorb = [&](LiveLight from, BehindGas kind) {
    float& light = sample.light[static_cast<std::size_t>(from)];
    const auto k = static_cast<std::size_t>(kind);
    error = std::hypot(error, gas.error.absorbed[k] * light);
    light *= 1 - gas.light.absorbed[k];
  };
  absorb(LiveLight::kEmitted, BehindGas::kEmitted);
  absorb(LiveLight::kSun, BehindGas::kSun);
  absorb(LiveLight::kReflected, sample.met == 0 ? BehindGas::kBackground : BehindGas::kEmitted);
  sample.light[static_cast<std::size_t>(LiveLight::kEmitted)] += gas.light.emitted_w_m2_sr;
  sample.light[0] = 0;
  for (std::size_t k = 1; k < sample.light.size(); ++k) sample.light[0] += sample.light[k];
  sample.gas_error = error;
}

void FrameView::flag_gas(std::vector<std::uint8_t>& edge) const {
  if (gas_rays_ != nullptr) gas_rays_->flag_missed(edge);
  if (!lacks_gas()) return;
  const double width = pictures_.width_px, height = pictures_.height_px;
  for (const PlumePoint& point : gas_->points()) {
    const Vec<Body> q = point.at - target_.centre - frame_.sensor;
    const double depth_m = dot(q, frame_.forward);
    if (!(depth_m > 0)) continue;
    const double per_m = pictures_.plane_m / depth_m / pixel_m_,
                 reach = per_m * static_cast<double>(point.reach_m),
                 x = per_m * dot(q, frame_.right) - pictures_.rectangle.x0_m / pixel_m_,
                 y = height - per_m * dot(q, frame_.up) + pictures_.rectangle.y0_m / pixel_m_;
    const auto pixel = [](double at, double end) {
      return static_cast<std::uint32_t>(std::clamp(at, 0.0, end));
    };
    const std::uint32_t right = pixel(x + reach + 1, width), bottom = pixel(y + reach + 1, height);
    for (std::uint32_t row = pixel(y - reach, height); row < bottom; ++row)
      for (std::uint32_t column = pixel(x - reach, width); column < right; ++column)
        edge[std::size_t{row} * pictures_.width_px + column] = 1;
  }
}

void FrameView::trace_tile(std::uint32_t tile_x, std::uint32_t tile_y, float sx, float sy,
                           FrameWorker& worker, const Sample* before, Sample* out) const {
  Vec<Body> direction[kTilePixels];
  float z0[kTilePixels], z1[kTilePixels];
  const bool target = overlaps_target(tile_x, tile_y);
  for (std::uint32_t i = 0; i < kTilePixels; ++i) {
    const Place c = pixel_of(tile_x, tile_y, i);
    direction[i] = direction_at(c.x + static_cast<double>(sx), c.y + static_cast<double>(sy));
  }
  if (!land_)
    for (std::uint32_t i = 0; i < kTilePixels; ++i) {
      const Place c = pixel_of(tile_x, tile_y, i);
      z0[i] = static_cast<float>(direction_at(c.x + 0.5, c.y).z);
      z1[i] = static_cast<float>(direction_at(c.x + 0.5, c.y + 1).z);
    }
  if (target) trace_target(direction, worker);
  if (rays_ != nullptr) trace_land(direction, worker);
  for (std::uint32_t i = 0; i < kTilePixels; ++i) {
    out[i] = {};
    if (target && shade_target(direction[i], worker, i, out[i])) continue;
    if (rays_ != nullptr && shade_land(direction[i], worker, i, out[i])) continue;
    const float z = static_cast<float>(direction[i].z);
    out[i].light = land_ ? total_of(0, 0, background_.mean(z, z), seen_.light.path)
                         : total_of(0, 0, background_.mean(z0[i], z1[i]), seen_.light.path);
    out[i].met = 0;
  }
  if (target && of_.sun_shines) add_sun(worker, out);
  if (rays_ != nullptr && of_.sun_shines) add_sun_on_land(worker, direction, before, out);
  if (gas_rays_ == nullptr) return;
  for (std::uint32_t i = 0; i < kTilePixels; ++i) {
    const Place c = pixel_of(tile_x, tile_y, i);
    if (c.x < pictures_.width_px && c.y < pictures_.height_px)
      add_gas(c.x + static_cast<double>(sx), c.y + static_cast<double>(sy), out[i]);
  }
}

Vec<Body> FrameView::direction_at(double x_px, double y_px) const {
  const PlaneRectangle& r = pictures_.rectangle;
  const double x_m = r.x0_m + x_px * pixel_m_,
               y_m = r.y0_m + (pictures_.height_px - y_px) * pixel_m_;
  return normalized(pictures_.plane_m * frame_.forward + x_m * frame_.right + y_m * frame_.up);
}

void FrameView::find_target_rectangle() {
  const double depth_m =
      std::max(-dot(frame_.sensor, frame_.forward) - target_.radius_m, 1e-3 * target_.radius_m);
  double x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY;
  const auto add = [&](double x_m, double y_m) {
    x0 = std::min(x0, x_m), x1 = std::max(x1, x_m), y0 = std::min(y0, y_m), y1 = std::max(y1, y_m);
  };
  const double across = dot(-1.0 * frame_.sensor, frame_.right),
               up = dot(-1.0 * frame_.sensor, frame_.up), r = target_.radius_m;
  for (const double sx : {-r, r})
    for (const double sy : {-r, r})
      for (const double d : {depth_m, depth_m + 2 * r})
        add((across + sx) * pictures_.plane_m / d, (up + sy) * pictures_.plane_m / d);
  const PlaneRectangle& rect = pictures_.rectangle;
  target_px_.x0 = (x0 - rect.x0_m) / pixel_m_;
  target_px_.x1 = (x1 - rect.x0_m) / pixel_m_;
  target_px_.y0 = pictures_.height_px - (y1 - rect.y0_m) / pixel_m_;
  target_px_.y1 = pictures_.height_px - (y0 - rect.y0_m) / pixel_m_;
}

bool FrameView::overlaps_target(std::uint32_t tile_x, std::uint32_t tile_y) const {
  const double x = tile_x * kTileSide, y = tile_y * kTileSide;
  return x <= target_px_.x1 && x + kTileSide >= target_px_.x0 && y <= target_px_.y1 &&
         y + kTileSide >= target_px_.y0;
}

std::string FrameView::name_of(LiveClass met, const schema::Sweep& sweep) const {
  if (met == 0) return "background";
  const std::uint32_t material = (met - 1u) / 2;
  if (material < of_.materials) return sweep.material(static_cast<int>(material)).name();
  const auto land = static_cast<int>(material - of_.materials);
  return land < sweep.land().material_size() ? sweep.land().material(land).material() : "land";
}

}  // namespace irsig
