#include "live/gas_rays.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/plume/march.h"

namespace irsig {
namespace {

// Cells are halved where the emission of their rays differs by this fraction of the light of the
// frame, the largest differences first.
constexpr float kRefined = 0.05f;
// Most cells that are halved at one pitch: each adds at most five rays.
constexpr std::size_t kMostHalved = 256;
// Points of the field that send this fraction of what the brightest one sends are bright. Few
// pixels show them, between which the light changes most.
constexpr float kBrightFraction = 0.02f;
constexpr std::uint8_t kFaint = 1, kBright = 2;
// Rays that one thread takes at a time.
constexpr std::size_t kGroup = 8;
// Ends of gas are known to this fraction of its depth along a ray.
constexpr double kBesideEnd = 0.05;
// Rays end beyond any field, which is at most 1e6 m large.
constexpr double kRayEndM = 1e7;

// Interpolation between the rays of a cell.
struct Between {
  GasOnRay light, low, high;
  float gas = 0, near_m = 0, far_m = 0;  // sums of weights, and of these times the ends of gas

  // Adds a ray of the given weight.
  void add(float weight, const GasOnRay& of, float ray_near_m, float ray_far_m) {
    light.emitted_w_m2_sr += weight * of.emitted_w_m2_sr;
    low.emitted_w_m2_sr = std::min(low.emitted_w_m2_sr, of.emitted_w_m2_sr);
    high.emitted_w_m2_sr = std::max(high.emitted_w_m2_sr, of.emitted_w_m2_sr);
    for (std::size_t k = 0; k < kBehindGas; ++k) {
      light.absorbed[k] += weight * of.absorbed[k];
      low.absorbed[k] = std::min(low.absorbed[k], of.absorbed[k]);
      high.absorbed[k] = std::max(high.absorbed[k], of.absorbed[k]);
    }
    if (!(ray_far_m > ray_near_m)) return;
    // Weights are not 0 where a pixel lies on the one ray that misses gas.
    const float w = weight + 1e-6f;
    gas += w;
    near_m += w * ray_near_m;
    far_m += w * ray_far_m;
  }

  // Returns the place of a surface between the ends of the gas, 0 to 1; below 0: in front of it.
  [[nodiscard]] double place_of(double range_m) const {
    if (!(range_m > 0)) return INFINITY;
    return (range_m * static_cast<double>(gas) - static_cast<double>(near_m)) /
           static_cast<double>(far_m - near_m);
  }
};

}  // namespace

GasRays::GasRays(const LiveGas& table, const std::vector<float>& weights, Vec<Body> centre,
                 const ViewFrame& frame, const PictureFrame& pictures, float light_w_m2_sr)
    : table_(table),
      weights_(weights),
      centre_(centre),
      frame_(frame),
      pictures_(pictures),
      pixel_m_(pictures.rectangle.width_m / pictures.width_px),
      refined_w_m2_sr_(kRefined * light_w_m2_sr),
      width_((pictures.width_px + kPitch - 1) / kPitch * kPitch),
      height_((pictures.height_px + kPitch - 1) / kPitch * kPitch),
      pitch_(std::size_t{width_} * height_),
      point_(std::size_t{width_} * height_),
      ray_at_(std::size_t{width_ + 1} * (height_ + 1), -1) {
  find_cells();
}

void GasRays::find_cells() {
  const double width = pictures_.width_px, height = pictures_.height_px;
  const auto first_of = [](double at) {
    return static_cast<std::uint32_t>(std::max(at, 0.0)) / kPitch * kPitch;
  };
  const auto end_of = [&](double at, std::uint32_t end) {
    return std::min(end, first_of(std::min(at, static_cast<double>(end))) + kPitch);
  };
  const auto sends = [](const PlumePoint& point) { return point.thin_w[0]; };
  float bright_w = 0;
  for (const PlumePoint& point : table_.field().points())
    bright_w = std::max(bright_w, kBrightFraction * sends(point));
  for (const PlumePoint& point : table_.field().points()) {
    const Vec<Body> q = point.at - centre_ - frame_.sensor;
    const double depth_m = dot(q, frame_.forward);
    if (!(depth_m > 0)) continue;
    const double per_m = pictures_.plane_m / depth_m / pixel_m_,
                 reach = per_m * static_cast<double>(point.reach_m),
                 x = per_m * dot(q, frame_.right) - pictures_.rectangle.x0_m / pixel_m_,
                 y = height - per_m * dot(q, frame_.up) + pictures_.rectangle.y0_m / pixel_m_;
    if (x + reach < 0 || y + reach < 0 || x - reach > width || y - reach > height) continue;
    if (x >= 0 && y >= 0 && x < width && y < height) {
      std::uint8_t& there =
          point_[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x)];
      there = std::max(there, sends(point) > bright_w ? kBright : kFaint);
    }
    const std::uint32_t x1 = end_of(x + reach, width_), y1 = end_of(y + reach, height_);
    for (std::uint32_t row = first_of(y - reach); row < y1; row += kPitch)
      for (std::uint32_t column = first_of(x - reach); column < x1; column += kPitch)
        pitch_[std::size_t{row} * width_ + column] = kPitch;
  }
}

std::array<const GasRays::Ray*, 4> GasRays::rays_of(std::uint32_t x, std::uint32_t y,
                                                    std::uint32_t side) const {
  const auto at = [&](std::uint32_t column, std::uint32_t row) {
    return &ray_[static_cast<std::size_t>(ray_at_[std::size_t{row} * (width_ + 1) + column])];
  };
  return {at(x, y), at(x + side, y), at(x, y + side), at(x + side, y + side)};
}

bool GasRays::holds(std::uint32_t x, std::uint32_t y, std::uint32_t side,
                    std::uint8_t least) const {
  for (std::uint32_t row = y; row < y + side; ++row) {
    const auto first = point_.begin() + static_cast<std::ptrdiff_t>(std::size_t{row} * width_ + x);
    if (std::any_of(first, first + side, [&](std::uint8_t point) { return point >= least; }))
      return true;
  }
  return false;
}

bool GasRays::misses_gas(std::uint32_t x, std::uint32_t y, std::uint32_t side) const {
  const auto ray = rays_of(x, y, side);
  return std::none_of(ray.begin(), ray.end(), [](const Ray* r) { return r->far_m > r->near_m; }) &&
         holds(x, y, side, kFaint);
}

void GasRays::flag_missed(std::vector<std::uint8_t>& edge) const {
  for (std::uint32_t y = 0; y < pictures_.height_px; ++y)
    for (std::uint32_t x = 0; x < pictures_.width_px; ++x) {
      if (point_[std::size_t{y} * width_ + x] == 0) continue;
      const std::uint32_t side = side_at(x, y);
      if (side > 0 && misses_gas(x / side * side, y / side * side, side))
        edge[std::size_t{y} * pictures_.width_px + x] = 1;
    }
}

std::vector<GasRays::Cell> GasRays::cells_to_halve(std::uint32_t side) const {
  std::vector<Cell> out;
  for (std::uint32_t y = 0; y < height_; y += side)
    for (std::uint32_t x = 0; x < width_; x += side) {
      if (pitch_[std::size_t{y} * width_ + x] != side) continue;
      const auto ray = rays_of(x, y, side);
      const auto [low, high] =
          std::minmax({ray[0]->light.emitted_w_m2_sr, ray[1]->light.emitted_w_m2_sr,
                       ray[2]->light.emitted_w_m2_sr, ray[3]->light.emitted_w_m2_sr});
      if (high - low > refined_w_m2_sr_)
        out.push_back({high - low, x, y});
      else if (misses_gas(x, y, side) || (side == kPitch && holds(x, y, side, kBright)))
        out.push_back({INFINITY, x, y});
    }
  std::sort(out.begin(), out.end(), [](const Cell& a, const Cell& b) {
    return std::tuple(-a.range_w_m2_sr, a.y, a.x) < std::tuple(-b.range_w_m2_sr, b.y, b.x);
  });
  if (out.size() > kMostHalved) out.resize(kMostHalved);
  return out;
}

void GasRays::add_cell(std::uint32_t x, std::uint32_t y, std::uint32_t side, std::uint32_t pitch) {
  for (std::uint32_t row = y; row < y + side; row += pitch)
    for (std::uint32_t column = x; column < x + side; column += pitch)
      pitch_[std::size_t{row} * width_ + column] = static_cast<std::uint8_t>(pitch);
  for (std::uint32_t row = y; row <= y + side; row += pitch)
    for (std::uint32_t column = x; column <= x + side; column += pitch) {
      std::int32_t& at = ray_at_[std::size_t{row} * (width_ + 1) + column];
      if (at >= 0) continue;
      at = static_cast<std::int32_t>(place_.size());
      place_.push_back({column, row});
    }
}

std::uint32_t GasRays::choose(std::uint32_t pitch) {
  traced_ = place_.size();
  if (pitch < kPitch) {
    for (const Cell& cell : cells_to_halve(2 * pitch)) add_cell(cell.x, cell.y, 2 * pitch, pitch);
  } else {
    for (std::uint32_t y = 0; y < height_; y += pitch)
      for (std::uint32_t x = 0; x < width_; x += pitch)
        if (pitch_[std::size_t{y} * width_ + x] != 0) add_cell(x, y, pitch, pitch);
  }
  ray_.resize(place_.size());
  return static_cast<std::uint32_t>((place_.size() - traced_ + kGroup - 1) / kGroup);
}

void GasRays::trace_group(std::uint32_t group) {
  const std::size_t first = traced_ + group * kGroup;
  for (std::size_t i = first; i < std::min(first + kGroup, place_.size()); ++i)
    ray_[i] = march_ray(place_[i].x, place_[i].y);
}

GasRays::Ray GasRays::march_ray(double x_px, double y_px) const {
  const PlaneRectangle& r = pictures_.rectangle;
  const double x_m = r.x0_m + x_px * pixel_m_,
               y_m = r.y0_m + (pictures_.height_px - y_px) * pixel_m_;
  const Vec<Body> d =
      normalized(pictures_.plane_m * frame_.forward + x_m * frame_.right + y_m * frame_.up);
  const GasColumn column =
      march(table_.field(), {centre_ + frame_.sensor, d, 0, kRayEndM}, frame_steps());
  if (column.empty()) return {};
  return {table_.light_of(column, weights_), static_cast<float>(column.front().start_m),
          static_cast<float>(column.back().end_m)};
}

// Returns the side of the smallest cell around a place; 0: there is no gas.
std::uint32_t GasRays::side_at(std::uint32_t x, std::uint32_t y) const {
  for (std::uint32_t side = kPitch; side > 0; side /= 2)
    if (const std::uint32_t is = pitch_[std::size_t{y / side * side} * width_ + x / side * side];
        is == side || is == 0)
      return is;
  return 0;
}

bool GasRays::at(double x_px, double y_px, double range_m, Seen& out) const {
  const auto column = static_cast<std::uint32_t>(x_px), row = static_cast<std::uint32_t>(y_px);
  const std::uint32_t side = side_at(column, row);
  if (side == 0) return false;
  const std::uint32_t x = column / side * side, y = row / side * side;
  const auto u = static_cast<float>((x_px - x) / side), v = static_cast<float>((y_px - y) / side);
  const std::array<float, 4> weight = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
  const auto ray = rays_of(x, y, side);
  Between sum{{}, ray[0]->light, ray[0]->light};
  for (std::size_t n = 0; n < ray.size(); ++n)
    sum.add(weight[n], ray[n]->light, ray[n]->near_m, ray[n]->far_m);
  if (!(sum.gas > 0)) return false;
  const double place = sum.place_of(range_m);
  const auto before = static_cast<float>(std::clamp(place, 0.0, 1.0));
  // A ray that ends in gas may have all of it in front, or none.
  const bool ends_inside = place > -kBesideEnd && place < 1 + kBesideEnd;
  const float inside = ends_inside ? std::max(before, 1 - before) : 0;
  const auto error = [&](float low, float high, float value, float relative) {
    return std::hypot(0.5f * (high - low) * before, relative * value * before, inside * value);
  };
  out.light.emitted_w_m2_sr = before * sum.light.emitted_w_m2_sr;
  out.error.emitted_w_m2_sr = error(sum.low.emitted_w_m2_sr, sum.high.emitted_w_m2_sr,
                                    sum.light.emitted_w_m2_sr, table_.emitted_error(weights_));
  for (std::size_t k = 0; k < kBehindGas; ++k) {
    out.light.absorbed[k] = before * sum.light.absorbed[k];
    out.error.absorbed[k] = error(sum.low.absorbed[k], sum.high.absorbed[k], sum.light.absorbed[k],
                                  table_.absorbed_error(weights_));
  }
  return true;
}

}  // namespace irsig
