#include "live/gas_rays.h"

#include <algorithm>
#include <cmath>

#include "core/plume/march.h"

namespace irsig {
namespace {

// Blocks get fine rays where the emission of their corners differs by this fraction of the light of
// the frame, the largest differences first.
constexpr float kRefined = 0.05f;
constexpr std::size_t kMostRefined = 64;
// Ends of gas are known to this fraction of its depth along a ray.
constexpr double kBesideEnd = 0.05;

// Adds a weighted ray's light.
void add(float weight, const GasOnRay& light, GasOnRay& to) {
  to.emitted_w_m2_sr += weight * light.emitted_w_m2_sr;
  for (std::size_t k = 0; k < kBehindGas; ++k) to.absorbed[k] += weight * light.absorbed[k];
}

// Scales the emission and the absorptions of a ray.
void scale(float by, GasOnRay& light) {
  light.emitted_w_m2_sr *= by;
  for (float& a : light.absorbed) a *= by;
}

}  // namespace

GasRays::GasRays(const LiveGas& table, const std::vector<float>& weights, Vec<Body> centre,
                 const ViewFrame& frame, const PictureFrame& pictures)
    : table_(table),
      weights_(weights),
      centre_(centre),
      frame_(frame),
      pictures_(pictures),
      pixel_m_(pictures.rectangle.width_m / pictures.width_px),
      across_((pictures.width_px + kPitch - 1) / kPitch + 1),
      down_((pictures.height_px + kPitch - 1) / kPitch + 1),
      block_(std::size_t{across_} * down_),
      ray_(std::size_t{across_} * down_) {
  find_blocks(table.field());
}

void GasRays::find_blocks(const PlumeField& field) {
  const double width = pictures_.width_px, height = pictures_.height_px;
  for (const PlumePoint& point : field.points()) {
    const Vec<Body> q = point.at - centre_ - frame_.sensor;
    const double depth_m = dot(q, frame_.forward);
    if (!(depth_m > 0)) continue;
    const double per_m = pictures_.plane_m / depth_m / pixel_m_,
                 reach = per_m * static_cast<double>(point.reach_m),
                 x = per_m * dot(q, frame_.right) - pictures_.rectangle.x0_m / pixel_m_,
                 y = height - per_m * dot(q, frame_.up) + pictures_.rectangle.y0_m / pixel_m_;
    if (x + reach < 0 || y + reach < 0 || x - reach > width || y - reach > height) continue;
    const auto block = [](double at, double end) {
      return static_cast<std::uint32_t>(std::clamp(at, 0.0, end) / kPitch);
    };
    const std::uint32_t right = block(x + reach, width), bottom = block(y + reach, height);
    for (std::uint32_t row = block(y - reach, height); row <= bottom; ++row)
      for (std::uint32_t column = block(x - reach, width); column <= right; ++column)
        block_[std::size_t{row} * across_ + column] = 1;
  }
}

bool GasRays::is_wanted(std::uint32_t column, std::uint32_t row) const {
  for (std::uint32_t up = 0; up < 2; ++up)
    for (std::uint32_t left = 0; left < 2; ++left)
      if (row >= up && column >= left &&
          block_[std::size_t{row - up} * across_ + column - left] != 0)
        return true;
  return false;
}

void GasRays::trace_row(std::uint32_t row) {
  for (std::uint32_t column = 0; column < across_; ++column)
    if (is_wanted(column, row))
      ray_[std::size_t{row} * across_ + column] = march_ray(column * kPitch, row * kPitch);
}

GasRays::Ray GasRays::march_ray(double x_px, double y_px) const {
  const PlaneRectangle& r = pictures_.rectangle;
  const double x_m = r.x0_m + x_px * pixel_m_,
               y_m = r.y0_m + (pictures_.height_px - y_px) * pixel_m_;
  const Vec<Body> d =
      normalized(pictures_.plane_m * frame_.forward + x_m * frame_.right + y_m * frame_.up);
  const GasColumn column =
      march(table_.field(), {centre_ + frame_.sensor, d, 0, 1e7}, frame_steps());
  if (column.empty()) return {};
  return {table_.light_of(column, weights_), static_cast<float>(column.front().start_m),
          static_cast<float>(column.back().end_m)};
}

std::uint32_t GasRays::refine(float light_w_m2_sr) {
  struct Block {
    float range;
    std::uint32_t at;
  };
  std::vector<Block> wanted;
  for (std::uint32_t row = 0; row + 1 < down_; ++row)
    for (std::uint32_t column = 0; column + 1 < across_; ++column) {
      const std::uint32_t at = row * across_ + column;
      if (block_[at] == 0) continue;
      const auto [least, most] = std::minmax(
          {ray_[at].light.emitted_w_m2_sr, ray_[at + 1].light.emitted_w_m2_sr,
           ray_[at + across_].light.emitted_w_m2_sr, ray_[at + across_ + 1].light.emitted_w_m2_sr});
      if (most - least > kRefined * light_w_m2_sr) wanted.push_back({most - least, at});
    }
  std::sort(wanted.begin(), wanted.end(), [](const Block& a, const Block& b) {
    return a.range != b.range ? a.range > b.range : a.at < b.at;
  });
  if (wanted.size() > kMostRefined) wanted.resize(kMostRefined);
  fine_of_.assign(block_.size(), -1);
  for (const Block& block : wanted) {
    fine_of_[block.at] = static_cast<std::int32_t>(refined_.size());
    refined_.push_back(block.at);
  }
  fine_.resize(refined_.size() * kOfBlock);
  return static_cast<std::uint32_t>(refined_.size());
}

void GasRays::trace_block(std::uint32_t n) {
  const std::uint32_t x = refined_[n] % across_ * kPitch, y = refined_[n] / across_ * kPitch;
  for (std::uint32_t k = 0; k < kOfBlock; ++k)
    fine_[n * kOfBlock + k] = march_ray(x + k % kAlong, y + k / kAlong);
}

GasRays::Corners GasRays::corners_at(double x_px, double y_px) const {
  const double column = std::floor(x_px / kPitch), row = std::floor(y_px / kPitch);
  const std::size_t block =
      static_cast<std::size_t>(row) * across_ + static_cast<std::size_t>(column);
  if (fine_of_[block] < 0)
    return {{&ray_[block], &ray_[block + 1], &ray_[block + across_], &ray_[block + across_ + 1]},
            static_cast<float>(x_px / kPitch - column),
            static_cast<float>(y_px / kPitch - row)};
  const double x = x_px - kPitch * column, y = y_px - kPitch * row, left = std::floor(x),
               top = std::floor(y);
  const Ray* first =
      &fine_[static_cast<std::size_t>(fine_of_[block]) * kOfBlock +
             static_cast<std::size_t>(top) * kAlong + static_cast<std::size_t>(left)];
  return {{first, first + 1, first + kAlong, first + kAlong + 1},
          static_cast<float>(x - left),
          static_cast<float>(y - top)};
}

bool GasRays::at(double x_px, double y_px, double range_m, Seen& out) const {
  const auto column = static_cast<std::size_t>(x_px / kPitch),
             row = static_cast<std::size_t>(y_px / kPitch);
  if (block_[row * across_ + column] == 0) return false;
  const auto [corner, u, v] = corners_at(x_px, y_px);
  const std::array<float, 4> weight = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
  out = {};
  GasOnRay low = corner[0]->light, high = low;
  float gas = 0, near_m = 0, far_m = 0;
  for (std::size_t n = 0; n < corner.size(); ++n) {
    const Ray& ray = *corner[n];
    add(weight[n], ray.light, out.light);
    low.emitted_w_m2_sr = std::min(low.emitted_w_m2_sr, ray.light.emitted_w_m2_sr);
    high.emitted_w_m2_sr = std::max(high.emitted_w_m2_sr, ray.light.emitted_w_m2_sr);
    for (std::size_t k = 0; k < kBehindGas; ++k) {
      low.absorbed[k] = std::min(low.absorbed[k], ray.light.absorbed[k]);
      high.absorbed[k] = std::max(high.absorbed[k], ray.light.absorbed[k]);
    }
    if (!(ray.far_m > ray.near_m)) continue;
    // Weights are not 0 where a pixel lies on the one ray that misses gas.
    const float w = weight[n] + 1e-6f;
    gas += w;
    near_m += w * ray.near_m;
    far_m += w * ray.far_m;
  }
  if (!(gas > 0)) return false;
  const double place = range_m > 0
                           ? (range_m * static_cast<double>(gas) - static_cast<double>(near_m)) /
                                 static_cast<double>(far_m - near_m)
                           : INFINITY;
  const auto before = static_cast<float>(std::clamp(place, 0.0, 1.0));
  // A ray that ends in gas may have all of it in front, or none.
  const bool ends_inside = place > -kBesideEnd && place < 1 + kBesideEnd;
  const float inside = ends_inside ? std::max(before, 1 - before) : 0;
  const auto error = [&](float least, float most, float value, float relative) {
    return std::hypot(0.5f * (most - least) * before, relative * value * before, inside * value);
  };
  out.error.emitted_w_m2_sr = error(low.emitted_w_m2_sr, high.emitted_w_m2_sr,
                                    out.light.emitted_w_m2_sr, table_.emitted_error(weights_));
  for (std::size_t k = 0; k < kBehindGas; ++k)
    out.error.absorbed[k] = error(low.absorbed[k], high.absorbed[k], out.light.absorbed[k],
                                  table_.absorbed_error(weights_));
  scale(before, out.light);
  return true;
}

}  // namespace irsig
