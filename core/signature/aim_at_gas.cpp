#include "core/signature/aim_at_gas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace irsig {
namespace {

constexpr std::size_t kBulks = 24;
constexpr std::uint32_t kCells = 128;  // along the longer side of the target's rectangle
// A facet over more cells than this is asked at each of them.
constexpr int kSmall = 4;

// A part of the gas that sends from its middle to all sides. Its reach is the root mean square
// distance of what it sends from there.
struct Bulk {
  Vec<Body> at;
  double reach_m = 0, sends = 0;
};

// Cuts the gas into bulks of equal length along the axis of the body frame along which it is
// longest. Both wavelengths of the points count alike.
std::vector<Bulk> bulks_of(const PlumeField& field, Vec<Body> centre) {
  const std::vector<PlumePoint>& points = field.points();
  const auto along = [](Vec<Body> v, std::size_t axis) { return std::array{v.x, v.y, v.z}[axis]; };
  std::array<double, 2> all{};
  std::array<double, 3> low, high;
  low.fill(1e300);
  high.fill(-1e300);
  for (const PlumePoint& p : points) {
    for (std::size_t m = 0; m < all.size(); ++m) all[m] += static_cast<double>(p.thin_w[m]);
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], along(p.at, a));
      high[a] = std::max(high[a], along(p.at, a));
    }
  }
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (high[a] - low[a] > high[axis] - low[axis]) axis = a;
  const double step_m = std::max((high[axis] - low[axis]) / static_cast<double>(kBulks), 1e-9);
  struct Sums {
    double sends = 0, square = 0, reach = 0;
    Vec<Body> first{0, 0, 0};
  };
  std::array<Sums, kBulks> sums;
  for (const PlumePoint& p : points) {
    double sends = 0;
    for (std::size_t m = 0; m < all.size(); ++m)
      if (all[m] > 0) sends += static_cast<double>(p.thin_w[m]) / all[m];
    const double place = (along(p.at, axis) - low[axis]) / step_m;
    Sums& s = sums[std::min(static_cast<std::size_t>(place), kBulks - 1)];
    const Vec<Body> at = p.at - centre;
    s.sends += sends;
    s.first = s.first + sends * at;
    s.square += sends * dot(at, at);
    s.reach += sends * static_cast<double>(p.reach_m);
  }
  std::vector<Bulk> out;
  for (const Sums& s : sums) {
    if (!(s.sends > 0)) continue;
    const Vec<Body> at = (1 / s.sends) * s.first;
    const double spread = std::max(0.0, s.square / s.sends - dot(at, at));
    out.push_back({at, std::sqrt(spread) + s.reach / s.sends, s.sends});
  }
  return out;
}

// Returns the irradiance at a place with that normal, in arbitrary units.
double irradiance(const std::vector<Bulk>& bulks, Vec<Body> at, Vec<Body> normal) {
  double sum = 0;
  for (const Bulk& bulk : bulks) {
    const Vec<Body> to = bulk.at - at;
    const double square = dot(to, to) + bulk.reach_m * bulk.reach_m, distance = std::sqrt(square),
                 cosine = (dot(to, normal) + bulk.reach_m) / distance;
    if (cosine > 0) sum += bulk.sends * std::min(1.0, cosine) / square;
  }
  return sum;
}

class GasWeights {
 public:
  GasWeights(const Target& target, const ViewFrame& frame, const std::vector<Bulk>& bulks)
      : target_(target), frame_(frame), bulks_(bulks) {
    const std::size_t vertices = target.vertex.size() / 3;
    x_m_.resize(vertices);
    y_m_.resize(vertices);
    for (std::size_t i = 0; i < vertices; ++i) {
      const Vec<Body> q = vertex(static_cast<std::uint32_t>(i)) - frame.sensor;
      const double scale = frame.plane_m / dot(q, frame.forward);
      x_m_[i] = scale * dot(q, frame.right);
      y_m_[i] = scale * dot(q, frame.up);
    }
    std::vector<std::uint32_t> facets(target.facet.size());
    std::iota(facets.begin(), facets.end(), 0u);
    grid_ = touched_cells(target, frame, x_m_, y_m_, facets, kCells);
    weight_.assign(grid_.hit.size(), 0.0);
    for (const std::uint32_t f : facets) add(f);
  }

  [[nodiscard]] const CellGrid& grid() const { return grid_; }

  // Returns the density of rays that the cells are to have.
  [[nodiscard]] std::vector<double> density() const {
    double sum = 0, hit = 0;
    for (std::size_t i = 0; i < weight_.size(); ++i) {
      if (grid_.hit[i] == 0) continue;
      sum += weight_[i];
      ++hit;
    }
    std::vector<double> out(weight_.size(), 0.0);
    for (std::size_t i = 0; i < out.size(); ++i)
      if (grid_.hit[i] != 0)
        out[i] = kEvenAtGas / hit + (sum > 0 ? (1 - kEvenAtGas) * weight_[i] / sum : 0);
    return out;
  }

 private:
  [[nodiscard]] Vec<Body> vertex(std::uint32_t i) const {
    const float* v = target_.vertex.data() + 3 * static_cast<std::size_t>(i);
    return {v[0], v[1], v[2]};
  }

  // Raises the weights of the cells that a facet touches to its irradiance there.
  void add(std::uint32_t f) {
    const Target::Facet& facet = target_.facet[f];
    Vec<Body> normal{facet.nx, facet.ny, facet.nz};
    const std::uint32_t* corner = target_.triangle.data() + 3 * static_cast<std::size_t>(f);
    const Vec<Body> middle =
        (1.0 / 3) * (vertex(corner[0]) + vertex(corner[1]) + vertex(corner[2]));
    const double towards = dot(frame_.sensor - middle, normal);
    if (towards < 0) {
      if (!target_.part[facet.part].two_sided) return;
      normal = -1.0 * normal;
    }
    const auto [x_low, x_high] = std::minmax({x_m_[corner[0]], x_m_[corner[1]], x_m_[corner[2]]});
    const auto [y_low, y_high] = std::minmax({y_m_[corner[0]], y_m_[corner[1]], y_m_[corner[2]]});
    const auto cell = [](double x, double size, int count) {
      return std::clamp(static_cast<int>(std::floor(x / size)), 0, count - 1);
    };
    const int first = cell(x_low - grid_.x0_m, grid_.cell_x_m, grid_.columns),
              last = cell(x_high - grid_.x0_m, grid_.cell_x_m, grid_.columns),
              bottom = cell(y_low - grid_.y0_m, grid_.cell_y_m, grid_.rows),
              top = cell(y_high - grid_.y0_m, grid_.cell_y_m, grid_.rows);
    const bool small = (last - first + 1) * (top - bottom + 1) <= kSmall;
    const double own = small ? irradiance(bulks_, middle, normal) : 0;
    for (int column = first; column <= last; ++column)
      for (int row = bottom; row <= top; ++row) {
        const std::size_t i =
            static_cast<std::size_t>(column) * static_cast<std::size_t>(grid_.rows) +
            static_cast<std::size_t>(row);
        if (grid_.hit[i] == 0) continue;
        weight_[i] =
            std::max(weight_[i],
                     small ? own : irradiance(bulks_, seen(middle, normal, column, row), normal));
      }
  }

  // Returns where a facet's plane lies in the middle of a cell, or the facet's own middle where the
  // plane is seen edge-on.
  [[nodiscard]] Vec<Body> seen(Vec<Body> middle, Vec<Body> normal, int column, int row) const {
    const double x = grid_.x0_m + (column + 0.5) * grid_.cell_x_m,
                 y = grid_.y0_m + (row + 0.5) * grid_.cell_y_m;
    const Vec<Body> d = frame_.plane_m * frame_.forward + x * frame_.right + y * frame_.up;
    const double along = dot(d, normal), t = dot(middle - frame_.sensor, normal) / along;
    if (!(std::abs(along) > 1e-6 * length(d)) || !std::isfinite(t)) return middle;
    const Vec<Body> at = frame_.sensor + t * d;
    return length(at - middle) < 2 * target_.radius_m ? at : middle;
  }

  const Target& target_;
  const ViewFrame& frame_;
  const std::vector<Bulk>& bulks_;
  std::vector<double> x_m_, y_m_;  // [vertex] on the image plane
  CellGrid grid_;
  std::vector<double> weight_;  // [cell]
};

}  // namespace

AimedView aim_at_gas(const Target& target, const AimedView& view, const PlumeField& field) {
  const std::vector<Bulk> bulks = bulks_of(field, target.centre);
  const GasWeights weights(target, view.frame, bulks);
  AimedView out;
  out.range_m = view.range_m;
  out.frame = view.frame;
  out.stratum_of_part.assign(target.part.size(), 0);
  out.stratum.emplace_back(weights.grid());
  out.density.emplace(weights.grid(), weights.density());
  return out;
}

}  // namespace irsig
