#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/base/clones.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/plume/generate_plume.h"
#include "core/plume/generated_volume.h"
#include "fmt/format.h"

namespace irsig {
namespace {

// A place of the file: x forward, y port, z up.
struct Place {
  double x, y, z;
  friend Place operator-(Place a, Place b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Place operator+(Place a, Place b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Place operator*(double f, Place a) { return {f * a.x, f * a.y, f * a.z}; }
};
double dot(Place a, Place b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// Squares of the distances of a place from straight pieces from `at` to `at + along`, whose
// lengths' squares are known: many at once, the same bits whatever the vectors' width.
struct Pieces {
  const double *x, *y, *z, *dx, *dy, *dz, *square;
};
IRSIG_CLONES void distances2(std::size_t n, const Pieces& of, Place p, double* out) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const double t =
        ((p.x - of.x[i]) * of.dx[i] + (p.y - of.y[i]) * of.dy[i] + (p.z - of.z[i]) * of.dz[i]) /
        of.square[i];
    const double above = t < 0 ? 0.0 : t, u = above > 1 ? 1.0 : above;
    const double x = p.x - (of.x[i] + u * of.dx[i]), y = p.y - (of.y[i] + u * of.dy[i]),
                 z = p.z - (of.z[i] + u * of.dz[i]);
    out[i] = x * x + y * y + z * z;
  }
}

// The axis as a line of straight pieces, with the profile at each of its corners.
class AxisOfPlume {
 public:
  AxisOfPlume(const std::vector<PlumeStation>& stations, Vec<Body> downwind, const PlumeExit& exit,
              double air_k, double spacing_m) {
    double last = -1;
    for (const PlumeStation& s : stations) {
      if (last >= 0 && s.s_m < last + spacing_m && &s != &stations.back()) continue;
      last = s.s_m;
      at_.push_back({s.x_m * downwind.x, -s.x_m * downwind.y, s.height_m});
      profile_.push_back(plume_profile(s, exit, air_k));
    }
    for (std::size_t i = 0; i < pieces(); ++i) {
      const Place a = at_[i], d = at_[i + 1] - a;
      const double values[] = {a.x, a.y, a.z, d.x, d.y, d.z, dot(d, d)};
      for (std::size_t k = 0; k < std::size(values); ++k) of_piece_[k].push_back(values[k]);
    }
    distance2_.resize(pieces());
  }

  [[nodiscard]] std::size_t pieces() const { return at_.size() - 1; }
  [[nodiscard]] Place corner(std::size_t i) const { return at_[i]; }
  [[nodiscard]] double reach(std::size_t i) const {
    return std::max(profile_[i].cut_m, profile_[i + 1].cut_m);
  }

  // The piece nearest to a place, among those from first to last.
  [[nodiscard]] std::size_t nearest(Place p, std::size_t first, std::size_t last) {
    distances2(last + 1 - first, from(first), p, distance2_.data() + first);
    std::size_t best = first;
    double least = 1e300;
    for (std::size_t i = first; i <= last; ++i)
      if (distance2_[i] < least) {
        least = distance2_[i];
        best = i;
      }
    return best;
  }

  // Share of exhaust gas at a place whose nearest piece is known. 0 below the opening, beyond the
  // end.
  [[nodiscard]] double share(Place p, std::size_t piece) const {
    const Place d = at_[piece + 1] - at_[piece];
    const double t = dot(p - at_[piece], d) / of_piece_[6][piece];
    if ((piece == 0 && t < 0) || (piece + 1 == pieces() && t > 1)) return 0;
    const double u = std::clamp(t, 0.0, 1.0);
    const Place off = p - (at_[piece] + u * d);
    const double r = std::sqrt(dot(off, off));
    return (1 - u) * profile_[piece].at(r) + u * profile_[piece + 1].at(r);
  }

 private:
  [[nodiscard]] Pieces from(std::size_t first) const {
    const auto at = [&](std::size_t k) { return of_piece_[k].data() + first; };
    return {at(0), at(1), at(2), at(3), at(4), at(5), at(6)};
  }

  std::vector<Place> at_;
  std::vector<PlumeProfile> profile_;
  std::array<std::vector<double>, 7> of_piece_;  // Pieces
  std::vector<double> distance2_;
};

// Blocks that the plume reaches, with the first and last piece of the axis that may be nearest.
struct Reached {
  std::size_t first, last;
};
using Blocks = std::map<std::array<std::int32_t, 3>, Reached>;

absl::StatusOr<Blocks> reached_blocks(const AxisOfPlume& axis, double voxel_m) {
  Blocks out;
  const double block_m = 8 * voxel_m;
  const double half_diagonal = 0.5 * std::sqrt(3.0) * block_m;
  for (std::size_t i = 0; i < axis.pieces(); ++i) {
    const Place a = axis.corner(i), b = axis.corner(i + 1);
    const double reach = axis.reach(i);
    const auto low = [&](double x, double y) {
      return static_cast<std::int32_t>(std::floor((std::min(x, y) - reach) / block_m));
    };
    const auto high = [&](double x, double y) {
      return static_cast<std::int32_t>(std::floor((std::max(x, y) + reach) / block_m));
    };
    for (std::int32_t x = low(a.x, b.x); x <= high(a.x, b.x); ++x)
      for (std::int32_t y = low(a.y, b.y); y <= high(a.y, b.y); ++y)
        for (std::int32_t z = low(a.z, b.z); z <= high(a.z, b.z); ++z) {
          const Place centre{(x + 0.5) * block_m, (y + 0.5) * block_m, (z + 0.5) * block_m};
          const Place d = b - a;
          const double t = std::clamp(dot(centre - a, d) / dot(d, d), 0.0, 1.0);
          const Place off = centre - (a + t * d);
          if (dot(off, off) > (reach + half_diagonal) * (reach + half_diagonal)) continue;
          const auto [at, is_new] = out.try_emplace({8 * x, 8 * y, 8 * z}, Reached{i, i});
          at->second.last = i;
          if (out.size() > kMostGeneratedBlocks)
            return absl::InvalidArgumentError(fmt::format(
                "voxel_m {:g} makes more than {} blocks of 8^3 voxels: expected larger voxels or a "
                "shorter plume",
                voxel_m, kMostGeneratedBlocks));
        }
  }
  return out;
}

// Sums over the points of a voxel: share, and share / temperature.
struct VoxelSums {
  double share = 0, over_temperature = 0;
};

}  // namespace

Vec<Body> relative_wind(double wind_m_s, double wind_from_deg, double ship_speed_m_s) {
  const double from = wind_from_deg * kRadPerDeg;
  return {-wind_m_s * std::cos(from) - ship_speed_m_s, -wind_m_s * std::sin(from), 0};
}

absl::StatusOr<GeneratedPlume> generate_funnel_plume(const FunnelPlume& plume) {
  for (const double x : {plume.wind_m_s, plume.wind_from_deg, plume.ship_speed_m_s})
    if (!std::isfinite(x)) return absl::InvalidArgumentError("wind or ship speed is not finite");
  if (!(plume.wind_m_s >= 0))
    return absl::InvalidArgumentError(
        fmt::format("wind {:g} m/s, expected 0 or more", plume.wind_m_s));
  if (!(plume.voxel_m > 0) || plume.voxel_m > plume.exit.diameter_m)
    return absl::InvalidArgumentError(fmt::format(
        "voxel_m {:g}, expected more than 0 and at most the diameter of the opening, {:g}",
        plume.voxel_m, plume.exit.diameter_m));
  const Vec<Body> wind = relative_wind(plume.wind_m_s, plume.wind_from_deg, plume.ship_speed_m_s);
  const PlumeAir air{length(wind), plume.air_temperature_k, plume.air_pressure_pa};
  ASSIGN_OR_RETURN(std::vector<PlumeStation> stations, bent_plume(plume.exit, air, plume.length_m));
  ASSIGN_OR_RETURN(const ExhaustGas gas,
                   exhaust_gas(plume.exhaust, plume.exit.temperature_k, plume.air_pressure_pa));

  GeneratedPlume out;
  out.downwind = air.wind_m_s > 0 ? normalized(wind) : Vec<Body>{1, 0, 0};
  AxisOfPlume axis(stations, out.downwind, plume.exit, plume.air_temperature_k,
                   0.5 * plume.voxel_m);
  ASSIGN_OR_RETURN(const Blocks blocks, reached_blocks(axis, plume.voxel_m));
  GeneratedVolume volume(plume.voxel_m, plume.air_pressure_pa,
                         {gas.co2, gas.h2o, gas.co, gas.soot});
  const double h = plume.voxel_m, hotter = plume.exit.temperature_k - plume.air_temperature_k;
  // Two points an axis, of Gauss and Legendre.
  const double points[] = {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)};
  for (const auto& [origin, reached] : blocks) {
    for (unsigned v = 0; v < 512; ++v) {
      const Place low{(origin[0] + static_cast<int>(v >> 6)) * h,
                      (origin[1] + static_cast<int>(v >> 3 & 7)) * h,
                      (origin[2] + static_cast<int>(v & 7)) * h};
      const std::size_t near =
          axis.nearest(low + Place{0.5 * h, 0.5 * h, 0.5 * h}, reached.first, reached.last);
      const std::size_t first = std::max(near, reached.first + 2) - 2;
      const std::size_t last = std::min(near + 2, reached.last);
      VoxelSums sums;
      for (unsigned n = 0; n < 8; ++n) {
        const Place p = low + Place{points[n >> 2] * h, points[n >> 1 & 1] * h, points[n & 1] * h};
        const double f = axis.share(p, axis.nearest(p, first, last));
        sums.share += f / 8;
        sums.over_temperature += f / 8 / (plume.air_temperature_k + f * hotter);
      }
      if (!(sums.share > 0)) continue;
      // Amounts are x p / (R T): their mean, and the temperature that they have in the mean.
      volume.set(v, sums.share / sums.over_temperature, sums.share,
                 plume.exit.temperature_k * sums.over_temperature);
    }
    volume.add_block(origin);
  }
  out.axis = std::move(stations);
  volume.finish(out);
  return out;
}

}  // namespace irsig
