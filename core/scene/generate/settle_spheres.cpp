#include "core/scene/generate/settle_spheres.h"

#include <algorithm>
#include <cmath>

namespace irsig {
namespace {

// Moves out of overlaps are repeated until nothing overlaps by more than this, of the radius.
constexpr double kTouching = 1e-3;
constexpr int kMovesOut = 24;
constexpr double kFirstStep = 0.15, kLastStep = 0.002;  // down, of the radius
constexpr int kMostSteps = 5000;

double wrapped(double x, double cell) { return x - cell * std::floor(x / cell); }

}  // namespace

SettlingBed::SettlingBed(double cell_m, double largest_radius_m)
    : cell_m_(cell_m), largest_radius_m_(largest_radius_m) {
  columns_ = static_cast<std::size_t>(std::max(3.0, std::floor(cell_m / (2 * largest_radius_m))));
  in_column_.resize(columns_ * columns_);
}

std::size_t SettlingBed::column(double x_m, double y_m) const {
  const auto place = [&](double v) {
    return std::min(static_cast<std::size_t>(v / cell_m_ * static_cast<double>(columns_)),
                    columns_ - 1);
  };
  return place(x_m) * columns_ + place(y_m);
}

void SettlingBed::gather(double x_m, double y_m, double reach_m) {
  near_.clear();
  const double width = cell_m_ / static_cast<double>(columns_);
  const auto first = [&](double v) { return static_cast<long>(std::floor((v - reach_m) / width)); };
  const auto last = [&](double v) { return static_cast<long>(std::floor((v + reach_m) / width)); };
  const auto n = static_cast<long>(columns_);
  // Never the same column twice.
  const long x_last = std::min(last(x_m), first(x_m) + n - 1);
  const long y_last = std::min(last(y_m), first(y_m) + n - 1);
  for (long i = first(x_m); i <= x_last; ++i)
    for (long j = first(y_m); j <= y_last; ++j) {
      const auto at = static_cast<std::size_t>(((i % n) + n) % n * n + ((j % n) + n) % n);
      for (const std::uint32_t k : in_column_[at]) {
        SettledSphere s = sphere_[k];
        s.x_m = x_m + std::remainder(s.x_m - x_m, cell_m_);
        s.y_m = y_m + std::remainder(s.y_m - y_m, cell_m_);
        const double reach = reach_m - largest_radius_m_ + s.radius_m;
        if (std::hypot(s.x_m - x_m, s.y_m - y_m) < reach) near_.push_back(s);
      }
    }
}

bool SettlingBed::push_out(SettledSphere& s) const {
  for (int move = 0; move < kMovesOut; ++move) {
    double deepest = 0;
    for (const SettledSphere& o : near_) {
      const double dx = s.x_m - o.x_m, dy = s.y_m - o.y_m, dz = s.z_m - o.z_m;
      const double apart = o.radius_m + s.radius_m;
      const double d2 = dx * dx + dy * dy + dz * dz;
      if (d2 >= apart * apart) continue;
      const double d = std::sqrt(d2);
      const double overlap = apart - d;
      deepest = std::max(deepest, overlap);
      // Straight up out of a sphere at the very same place, which nothing but chance can bring
      // about.
      if (d < 1e-9 * apart) {
        s.z_m += overlap;
        continue;
      }
      s.x_m += overlap / d * dx;
      s.y_m += overlap / d * dy;
      s.z_m += overlap / d * dz;
    }
    s.z_m = std::max(s.z_m, s.radius_m);
    if (deepest < kTouching * s.radius_m) return true;
  }
  return false;
}

void SettlingBed::roll(SettledSphere& s) {
  const double slack = s.radius_m;  // how far it may go before its surroundings are looked up again
  double gathered_x = s.x_m, gathered_y = s.y_m;
  const double reach = s.radius_m + largest_radius_m_ + slack;
  gather(s.x_m, s.y_m, reach);
  double step = kFirstStep * s.radius_m;
  for (int i = 0; i < kMostSteps && step > kLastStep * s.radius_m && s.z_m > s.radius_m; ++i) {
    if (std::hypot(s.x_m - gathered_x, s.y_m - gathered_y) > 0.5 * slack) {
      gathered_x = s.x_m;
      gathered_y = s.y_m;
      gather(s.x_m, s.y_m, reach);
    }
    SettledSphere lower = s;
    lower.z_m = std::max(s.z_m - step, s.radius_m);
    const bool fits = push_out(lower);
    // On top of another sphere it hardly sinks at first: moving sideways counts too, unless it goes
    // up.
    const double moved = std::hypot(lower.x_m - s.x_m, lower.y_m - s.y_m);
    const double sunk = s.z_m - lower.z_m;
    if (fits && sunk > 0 && (sunk > 0.02 * step || moved > 0.02 * step))
      s = lower;
    else
      step *= 0.5;
  }
}

SettledSphere SettlingBed::drop(double x_m, double y_m, double radius_m) {
  SettledSphere s{x_m, y_m, radius_m, radius_m};
  gather(x_m, y_m, radius_m + largest_radius_m_);
  for (const SettledSphere& o : near_) {
    const double apart = o.radius_m + radius_m;
    const double across2 = (o.x_m - x_m) * (o.x_m - x_m) + (o.y_m - y_m) * (o.y_m - y_m);
    if (across2 < apart * apart)
      s.z_m = std::max(s.z_m, o.z_m + std::sqrt(apart * apart - across2));
  }
  roll(s);
  for (const SettledSphere& o : near_) {
    const double d = std::hypot(s.x_m - o.x_m, s.y_m - o.y_m, s.z_m - o.z_m);
    largest_overlap_ =
        std::max(largest_overlap_, (o.radius_m + radius_m - d) / std::min(o.radius_m, radius_m));
  }
  s.x_m = wrapped(s.x_m, cell_m_);
  s.y_m = wrapped(s.y_m, cell_m_);
  in_column_[column(s.x_m, s.y_m)].push_back(static_cast<std::uint32_t>(sphere_.size()));
  sphere_.push_back(s);
  return s;
}

}  // namespace irsig
