#include "core/land/kinds/make_land_kinds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "core/land/objects/land_objects.h"

namespace irsig {
namespace {

constexpr double kTurn = 2 * std::numbers::pi, kDeg = kTurn / 360;
constexpr std::uint32_t kCells = 64;  // along each side of a square
constexpr double kObjectCellM = 2;    // of the narrowest square, if objects stand on the land
// Horizons that differ by less, in the root mean square over azimuths and cells, are one.
constexpr double kAlike = 0.7 * kDeg;
// Elevations between which a horizon is sought: below them is none, above them is the zenith.
constexpr double kLowest = 1 * kDeg, kHighest = 89 * kDeg, kResolution = 0.4 * kDeg;
constexpr double kAboveM = 1e-3;  // the eye, above the land
constexpr double kFarM = 1e9;
constexpr double kLidReachM = 40;  // of objects under whose crowns sunlight passes

// Points that fill a unit square evenly, [roberts2018].
std::array<double, 2> even_point(std::uint32_t i) {
  constexpr double kRatio = 1.32471795724474602596;
  const double a = (i + 0.5) / kRatio, b = (i + 0.5) / (kRatio * kRatio);
  return {a - std::floor(a), b - std::floor(b)};
}

class KindMaker {
 public:
  KindMaker(const LandScene& land, LandKinds& out) : land_(land), out_(out) {}

  void add_squares() {
    const HeightGrid& map = land_.field->outer();
    const HeightGrid* inset = land_.field->inset();
    double cell_m = inset != nullptr ? inset->spacing_m : map.spacing_m;
    if (land_.objects != nullptr && land_.objects->count() > 0)
      cell_m = std::min(cell_m, kObjectCellM);
    const double reach_m =
        std::max({-map.west_m, -map.south_m, map.west_m + map.columns * map.spacing_m,
                  map.south_m + map.rows * map.spacing_m});
    for (;; cell_m *= 2) {
      out_.square.push_back({cell_m, kCells, std::vector<std::uint8_t>(kCells * kCells, 0)});
      if (0.5 * kCells * cell_m >= reach_m) return;
    }
  }

  // Finds the horizons seen from the middles of the cells, and groups those that are alike.
  void find_horizons() {
    for (std::size_t s = 0; s < out_.square.size(); ++s)
      for (std::uint32_t i = 0; i < kCells * kCells; ++i) {
        const auto [x_m, y_m] = middle_of(out_.square[s], i);
        // The next square within has these cells.
        if (s > 0 &&
            std::max(std::abs(x_m), std::abs(y_m)) < 0.5 * kCells * out_.square[s - 1].cell_m)
          continue;
        if (const auto seen = horizon_from(x_m, y_m)) {
          cell_.push_back({s, i});
          seen_.push_back(*seen);
        }
      }
    group();
  }

  // Horizons that a material has at the middle of some cell; a material that covers no ground has
  // the free one.
  void find_stand_ins() {
    const std::size_t horizons = out_.horizon.size();
    std::vector<bool> has(out_.materials * horizons, false);
    std::vector<float> fraction(out_.materials);
    for (const Cell& cell : cell_) {
      const LandKinds::Square& square = out_.square[cell.square];
      const auto [x_m, y_m] = middle_of(square, cell.index);
      land_.cover.at(x_m, y_m, fraction);
      for (std::uint32_t m = 0; m < out_.materials; ++m)
        if (fraction[m] > 0) has[m * horizons + square.horizon[cell.index]] = true;
    }
    for (std::size_t m = 0; m < out_.materials; ++m) {
      const auto first = has.begin() + static_cast<std::ptrdiff_t>(m * horizons);
      if (std::find(first, first + static_cast<std::ptrdiff_t>(horizons), true) ==
          first + static_cast<std::ptrdiff_t>(horizons))
        *first = true;
      for (std::size_t h = 0; h < horizons; ++h) {
        std::size_t best = h;
        for (std::size_t other = 0; !has[m * horizons + h] && other < horizons; ++other)
          if (has[m * horizons + other] &&
              (best == h || off2(out_.horizon[h], out_.horizon[other]) <
                                off2(out_.horizon[h], out_.horizon[best])))
            best = other;
        out_.stand_in.push_back(static_cast<std::uint8_t>(best));
      }
    }
  }

  // Places of each computed material, evenly over all squares; and faces of objects.
  void hold_out(std::uint32_t places) {
    const std::uint32_t tries = 64 * places;
    std::vector<std::uint32_t> have(out_.materials, 0);
    std::vector<float> fraction(out_.materials);
    for (std::uint32_t i = 0; i < tries; ++i) {
      const LandKinds::Square& square = out_.square[i % out_.square.size()];
      const auto [u, v] = even_point(i);
      const double wide_m = square.cells * square.cell_m, x_m = (u - 0.5) * wide_m,
                   y_m = (v - 0.5) * wide_m;
      const auto surface_m = land_.field->z_m(x_m, y_m);
      if (!surface_m) continue;
      const auto hit = land_.field->first_hit({x_m, y_m, *surface_m + 1}, {0, 0, -1}, 2);
      if (!hit || hit->at_edge) continue;
      land_.cover.at(x_m, y_m, fraction);
      for (std::uint32_t m = 0; m < out_.materials; ++m) {
        if (!out_.computed[m] || have[m] >= places || !(fraction[m] > 0)) continue;
        const auto seen = horizon_from(x_m, y_m);
        if (!seen) continue;
        ++have[m];
        HeldOutPlace& place = out_.held_out.emplace_back();
        place.material = m;
        place.normal = hit->normal;
        place.horizon = *seen;
        out_.at(m, out_.horizon_at(x_m, y_m), place.normal, false, 1, place.mix);
      }
    }
    for (std::uint32_t m = 0; m < out_.materials; ++m)
      for (std::uint32_t i = 0; out_.computed[m] && out_.on_objects[m] && i < places / 2; ++i) {
        const auto [u, v] = even_point(i);
        const double azimuth = kTurn * u, sine = i % 2 == 0 ? 1 : v;  // a wall, or any tilt
        HeldOutPlace& place = out_.held_out.emplace_back();
        place.material = m;
        place.object = true;
        place.normal = {sine * std::sin(azimuth), sine * std::cos(azimuth),
                        std::sqrt(1 - sine * sine)};
        out_.at(m, 0, place.normal, true, 1, place.mix);
      }
  }

 private:
  struct Cell {
    std::size_t square;
    std::uint32_t index;
  };

  static std::array<double, 2> middle_of(const LandKinds::Square& square, std::uint32_t i) {
    const double half_m = 0.5 * square.cells * square.cell_m;
    return {(i % square.cells + 0.5) * square.cell_m - half_m,
            (i / square.cells + 0.5) * square.cell_m - half_m};
  }

  [[nodiscard]] bool hidden(Vec<Enu> from, Vec<Enu> towards) const {
    return land_.field->hidden(from, towards, kFarM) ||
           (land_.objects != nullptr && land_.objects->hidden(from, towards, kFarM));
  }

  // No land is there.
  [[nodiscard]] std::optional<LandHorizon> horizon_from(double x_m, double y_m) const {
    const auto surface_m = land_.field->z_m(x_m, y_m);
    if (!surface_m) return std::nullopt;
    const Vec<Enu> eye{x_m, y_m, *surface_m + kAboveM};
    LandHorizon out;
    const bool lids = objects_near(x_m, y_m);
    double near = kLowest;  // the horizon at the azimuth before
    for (std::uint32_t i = 0; i < kHorizonAzimuths; ++i) {
      const double azimuth = kTurn * i / kHorizonAzimuths;
      const auto covered = [&](double elevation) {
        const double along = std::cos(elevation);
        return hidden(eye,
                      {along * std::sin(azimuth), along * std::cos(azimuth), std::sin(elevation)});
      };
      double low = kLowest, high = kHighest;
      if (!covered(low)) {
        near = kLowest;
        if (lids) add_lid(i, 0, covered, out);
        continue;
      }
      for (double step = 2 * kResolution; high - low > kResolution; step *= 4) {
        const double up = near + step, down = near - step;
        double middle = 0.5 * (low + high);
        if (up > low && up < middle)
          middle = up;
        else if (down < high && down > middle)
          middle = down;
        (covered(middle) ? low : high) = middle;
      }
      near = 0.5 * (low + high);
      out.elevation_rad[i] = static_cast<float>(near);
      if (lids) add_lid(i, near, covered, out);
    }
    return out;
  }

  // Objects near enough that their crowns are seen well above the level.
  [[nodiscard]] bool objects_near(double x_m, double y_m) const {
    return land_.objects != nullptr &&
           land_.objects->highest_m(x_m - kLidReachM, x_m + kLidReachM, y_m - kLidReachM,
                                    y_m + kLidReachM) > -kFarM;
  }

  // The lowest of what hangs above the horizon, found at a few elevations.
  template <typename Covered>
  static void add_lid(std::uint32_t i, double horizon, const Covered& covered, LandHorizon& out) {
    constexpr double kStep = 8 * kDeg;
    const auto edge = [&](double free, double hidden) {
      while (std::abs(hidden - free) > kResolution)
        (covered(0.5 * (free + hidden)) ? hidden : free) = 0.5 * (free + hidden);
      return static_cast<float>(0.5 * (free + hidden));
    };
    double free = horizon + kResolution, at = horizon + kStep;
    while (at < kHighest && !covered(at)) {
      free = at;
      at += kStep;
    }
    if (at >= kHighest) return;
    out.lid_low_rad[i] = edge(free, at);
    double hidden = at;
    while (at < kHighest && covered(at)) {
      hidden = at;
      at += kStep;
    }
    out.lid_high_rad[i] = at < kHighest ? edge(at, hidden) : static_cast<float>(kTurn / 4);
  }

  // Returns the mean square over azimuths of the elevations that only one of the two horizons
  // hides.
  static double off2(const LandHorizon& a, const LandHorizon& b) {
    double sum = 0;
    for (std::uint32_t i = 0; i < kHorizonAzimuths; ++i) {
      const auto horizon = std::abs(a.elevation_rad[i] - b.elevation_rad[i]);
      const float both = std::max(0.0f, std::min(a.lid_high_rad[i], b.lid_high_rad[i]) -
                                            std::max(a.lid_low_rad[i], b.lid_low_rad[i])),
                  lids = a.lid_high_rad[i] - a.lid_low_rad[i] + b.lid_high_rad[i] -
                         b.lid_low_rad[i] - 2 * both;
      const auto d = static_cast<double>(horizon + lids);
      sum += d * d;
    }
    return sum / kHorizonAzimuths;
  }

  // Each further horizon begins as the one that is least like all before it; then all become the
  // means of what is nearest to them. The first one stays free.
  void group() {
    out_.horizon.assign(1, LandHorizon{});
    std::vector<double> off(seen_.size());
    std::vector<std::uint8_t> of(seen_.size(), 0);
    for (std::size_t c = 0; c < seen_.size(); ++c) off[c] = off2(seen_[c], out_.horizon[0]);
    const auto nearest = [&] {
      for (std::size_t c = 0; c < seen_.size(); ++c) {
        off[c] = off2(seen_[c], out_.horizon[of[c]]);
        for (std::size_t h = 0; h < out_.horizon.size(); ++h)
          if (const double d = off2(seen_[c], out_.horizon[h]); d < off[c]) {
            off[c] = d;
            of[c] = static_cast<std::uint8_t>(h);
          }
      }
    };
    while (out_.horizon.size() < kMostLandHorizons) {
      double sum = 0;
      for (const double d : off) sum += d;
      if (!(sum > kAlike * kAlike * static_cast<double>(seen_.size()))) break;
      const auto farthest = std::max_element(off.begin(), off.end()) - off.begin();
      out_.horizon.push_back(seen_[static_cast<std::size_t>(farthest)]);
      for (int pass = 0; pass < 4; ++pass) {
        nearest();
        move_to_means(of);
      }
      nearest();
    }
    for (std::size_t c = 0; c < cell_.size(); ++c)
      out_.square[cell_[c].square].horizon[cell_[c].index] = of[c];
  }

  void move_to_means(const std::vector<std::uint8_t>& of) {
    struct Sums {
      double elevation = 0, lid_low = 0, lid_high = 0, lids = 0;
    };
    std::vector<std::array<Sums, kHorizonAzimuths>> sum(out_.horizon.size());
    std::vector<double> count(out_.horizon.size(), 0);
    for (std::size_t c = 0; c < seen_.size(); ++c) {
      ++count[of[c]];
      for (std::uint32_t i = 0; i < kHorizonAzimuths; ++i) {
        Sums& s = sum[of[c]][i];
        s.elevation += static_cast<double>(seen_[c].elevation_rad[i]);
        if (seen_[c].lid_high_rad[i] <= seen_[c].lid_low_rad[i]) continue;
        s.lid_low += static_cast<double>(seen_[c].lid_low_rad[i]);
        s.lid_high += static_cast<double>(seen_[c].lid_high_rad[i]);
        ++s.lids;
      }
    }
    for (std::size_t h = 1; h < sum.size(); ++h)
      for (std::uint32_t i = 0; count[h] > 0 && i < kHorizonAzimuths; ++i) {
        const Sums& s = sum[h][i];
        LandHorizon& to = out_.horizon[h];
        to.elevation_rad[i] = static_cast<float>(s.elevation / count[h]);
        // A lid that hangs over most of the group's cells hangs over all.
        const double lids = 2 * s.lids > count[h] ? s.lids : 0;
        to.lid_low_rad[i] = lids > 0 ? static_cast<float>(s.lid_low / lids) : 0;
        to.lid_high_rad[i] = lids > 0 ? static_cast<float>(s.lid_high / lids) : 0;
      }
  }

  const LandScene& land_;
  LandKinds& out_;
  std::vector<Cell> cell_;
  std::vector<LandHorizon> seen_;  // [cell_]
};

}  // namespace

LandKinds make_land_kinds(const LandScene& land, std::vector<bool> computed,
                          std::vector<bool> on_objects, std::uint32_t held_out) {
  LandKinds out;
  out.materials = land.cover.materials();
  out.computed = std::move(computed);
  out.on_objects = std::move(on_objects);
  KindMaker maker(land, out);
  maker.add_squares();
  maker.find_horizons();
  maker.find_stand_ins();
  out.index_kinds();
  maker.hold_out(held_out);
  return out;
}

}  // namespace irsig
