#include "core/thermal/scene/heat_bounds.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>

#include "core/base/constants.h"

namespace irsig {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kMostK = 1000;  // a bound that is larger says nothing
// What arrives is solved to so much, from below.
constexpr double kArrivesWM2 = 1e-3;
// Bounds by face from the one that holds for all, so often: each costs what arrives at all knots.
constexpr int kRounds = 3;

double fourth_power(double t) { return t * t * t * t; }

// sigma ((T + m)^4 - T^4), and what emission falls by if T falls by m.
double rises_w_m2(double t, double m) {
  return kStefanBoltzmannWM2K4 * (fourth_power(t + m) - fourth_power(t));
}
double falls_w_m2(double t, double m) {
  return kStefanBoltzmannWM2K4 * (fourth_power(t) - fourth_power(std::max(0.0, t - m)));
}

class Bounds {
 public:
  Bounds(const SceneHeatRequest& request, SceneExposure& exposure, const SceneWalls& walls)
      : exposure_(exposure),
        walls_(walls),
        faces_(exposure.faces()),
        n_(faces_.size()),
        is_wall_(n_, false),
        known_to_k_(n_, 0.0),
        forced_w_m2_k_(exposure.knots() * n_) {
    for (std::uint32_t f = 0; f < faces_.fronts; ++f) {
      const auto& build_up = exposure_.part_of(f).build_up;
      if (!build_up || faces_.area_m2[f] <= 0 || exposure_.dark(f)) continue;
      is_wall_[f] = true;
      // The other side of a closed plate is as warm as the front and has no balance of its own.
      const std::uint32_t back = faces_.back_of_facet[f];
      if (back != ThermalFaces::kNone && request.build_up[*build_up].inner_side == InnerSide::kOpen)
        is_wall_[back] = true;
    }
    std::vector<std::uint32_t> all(n_);
    for (std::uint32_t i = 0; i < n_; ++i) {
      all[i] = i;
      property_.push_back(exposure_.properties(i));
    }
    std::vector<double> absorbed(n_), fluid(n_), forced(n_);
    for (std::size_t k = 0; k < exposure_.knots(); ++k) {
      exposure_.expose(k, SceneExposure::Side::kAfter, all, {absorbed, {}, fluid, forced});
      for (std::size_t i = 0; i < n_; ++i)
        forced_w_m2_k_[k * n_ + i] = static_cast<float>(forced[i]);
    }
  }

  // Temperatures of the side that the next bounds are made from may be so much off. [face]
  void widen(const std::vector<double>& by_k) { known_to_k_ = by_k; }

  // Returns the largest change of faces that absorb a flux that is other by so much. [face]
  //   flux_w_m2  [knot x faces + face]
  //   coupled    whether faces answer to each other
  [[nodiscard]] std::vector<double> by_flux(const std::vector<float>& flux_w_m2, bool coupled) {
    std::vector<double> out(n_, 0.0);
    if (!coupled) {
      for_walls([&](std::size_t k, std::size_t i) {
        out[i] = std::max(out[i], alone_k(k, i, flux_w_m2[k * n_ + i]));
        return true;
      });
      both_sides(out);
      return out;
    }
    const double most_k = barrier_k(flux_w_m2);
    for (std::size_t i = 0; i < n_; ++i) out[i] = moves(i) ? most_k : 0;
    for (int round = 0; round < kRounds && std::isfinite(most_k); ++round) {
      std::vector<double> next(n_, 0.0), emitted(n_), arrives(n_, 0.0);
      for (std::size_t k = 0; k < exposure_.knots(); ++k) {
        for (std::size_t i = 0; i < n_; ++i)
          emitted[i] = property_[i].emissivity * rises_w_m2(high_k(k, i), out[i]);
        exposure_.arriving(emitted, kArrivesWM2, arrives);
        for (std::size_t i = 0; i < n_; ++i) {
          if (!is_wall_[i]) continue;
          const double flux = static_cast<double>(flux_w_m2[k * n_ + i]) +
                              property_[i].emissivity * (arrives[i] + kArrivesWM2);
          next[i] = std::max(next[i], alone_k(k, i, flux));
        }
      }
      both_sides(next);
      for (std::size_t i = 0; i < n_; ++i) out[i] = std::min(out[i], next[i]);
    }
    return out;
  }

  [[nodiscard]] std::vector<float> flux(
      const std::function<void(std::size_t k, std::span<double> flux_w_m2)>& at) {
    std::vector<float> out(exposure_.knots() * n_);
    std::vector<double> of_knot(n_);
    for (std::size_t k = 0; k < exposure_.knots(); ++k) {
      at(k, of_knot);
      for (std::size_t i = 0; i < n_; ++i) out[k * n_ + i] = static_cast<float>(of_knot[i]);
    }
    return out;
  }

  [[nodiscard]] double emissivity(std::size_t face) const { return property_[face].emissivity; }

 private:
  [[nodiscard]] bool moves(std::size_t face) const {
    return exposure_.part_of(static_cast<std::uint32_t>(face)).build_up.has_value();
  }
  [[nodiscard]] double kelvin(std::size_t k, std::size_t face) const {
    return static_cast<double>(walls_.kelvin(k, static_cast<std::uint32_t>(face)));
  }
  [[nodiscard]] double high_k(std::size_t k, std::size_t face) const {
    return kelvin(k, face) + known_to_k_[face];
  }
  [[nodiscard]] double low_k(std::size_t k, std::size_t face) const {
    return std::max(0.0, kelvin(k, face) - known_to_k_[face]);
  }

  // Heat that a face loses at least if it is warmer by so much, or gains if it is colder.
  [[nodiscard]] double answer_w_m2(std::size_t k, std::size_t i, double m) const {
    const FaceProperties& p = property_[i];
    const double natural = std::min(p.convection.natural_warm, p.convection.natural_cold) *
                           std::cbrt(m / 2),
                 forced = static_cast<double>(forced_w_m2_k_[k * n_ + i]);
    return std::hypot(natural, forced) * m + p.emissivity * falls_w_m2(low_k(k, i), m);
  }

  // Returns the m at which the answer is as much as a flux: the answer grows with m.
  [[nodiscard]] double alone_k(std::size_t k, std::size_t i, double flux_w_m2) const {
    if (flux_w_m2 <= 0) return 0;
    double low = 0, high = kMostK;
    if (!(answer_w_m2(k, i, high) >= flux_w_m2)) return kInfinite;
    while (high - low > 1e-6 + 1e-4 * high) {
      const double middle = 0.5 * (low + high);
      (answer_w_m2(k, i, middle) >= flux_w_m2 ? high : low) = middle;
    }
    return high;
  }

  // A difference that no face of any wall can reach at any knot if none has passed it: so none
  // does, for a flux that is raised from nothing.
  [[nodiscard]] double barrier_k(const std::vector<float>& flux_w_m2) {
    // Radiation that arrives if all other faces are warmer by 1 K. For larger changes it is more,
    // by the powers of m / T.
    std::vector<float> gathered(exposure_.knots() * n_);
    std::vector<double> emitted(n_), arrives(n_, 0.0);
    double coldest_k = kInfinite;
    for (std::size_t k = 0; k < exposure_.knots(); ++k) {
      for (std::size_t i = 0; i < n_; ++i) {
        const double t = high_k(k, i);
        emitted[i] = moves(i) ? property_[i].emissivity * 4 * kStefanBoltzmannWM2K4 * t * t * t : 0;
        if (moves(i)) coldest_k = std::min(coldest_k, t);
      }
      exposure_.arriving(emitted, kArrivesWM2, arrives);
      for (std::size_t i = 0; i < n_; ++i)
        gathered[k * n_ + i] =
            static_cast<float>(property_[i].emissivity * (arrives[i] + kArrivesWM2));
    }
    for (double m = 1e-3; m < kMostK; m *= 1.05) {
      const double x = m / coldest_k, more = m * (1 + x * (1.5 + x * (1 + 0.25 * x)));
      if (for_walls([&](std::size_t k, std::size_t i) {
            return answer_w_m2(k, i, m) > static_cast<double>(flux_w_m2[k * n_ + i]) +
                                              static_cast<double>(gathered[k * n_ + i]) * more;
          }))
        return m;
    }
    return kInfinite;
  }

  // Until one says no.
  bool for_walls(const std::function<bool(std::size_t k, std::size_t face)>& of) const {
    for (std::size_t k = 0; k < exposure_.knots(); ++k)
      for (std::size_t i = 0; i < n_; ++i)
        if (is_wall_[i] && !of(k, i)) return false;
    return true;
  }

  // Nowhere in a wall is the difference larger than at the one of its faces where it is largest.
  void both_sides(std::vector<double>& bound_k) const {
    for (std::uint32_t f = 0; f < faces_.fronts; ++f)
      if (const std::uint32_t back = faces_.back_of_facet[f]; back != ThermalFaces::kNone)
        bound_k[f] = bound_k[back] = std::max(bound_k[f], bound_k[back]);
  }

  SceneExposure& exposure_;
  const SceneWalls& walls_;
  const ThermalFaces& faces_;
  std::size_t n_;
  std::vector<bool> is_wall_;  // [face] whether it has a balance
  std::vector<double> known_to_k_;
  std::vector<FaceProperties> property_;
  std::vector<float> forced_w_m2_k_;  // [knot x faces + face]
};

}  // namespace

HeatBounds heat_bounds(const SceneHeatRequest& request, SceneExposure& exposure,
                       const SceneWalls& walls) {
  const std::size_t n = exposure.faces().size();
  Bounds bounds(request, exposure, walls);
  std::vector<double> others(n, 0.0), air(n);
  const std::vector<double> exchange =
      bounds.by_flux(bounds.flux([&](std::size_t k, std::span<double> flux_w_m2) {
        exposure.long_wave_of_faces(k, {walls.kelvin().data() + k * n, n}, kArrivesWM2, others);
        exposure.long_wave_of_air(k, air);
        for (std::size_t i = 0; i < n; ++i)
          flux_w_m2[i] = bounds.emissivity(i) *
                         (std::abs(others[i] - air[i]) + (others[i] == air[i] ? 0 : kArrivesWM2) +
                          std::abs(exposure.exchanged_jump_w_m2(k, static_cast<std::uint32_t>(i))));
      }),
                     // On the side without exchange no face answers to another.
                     !request.exchange && exposure.can_exchange());
  if (!request.exchange) bounds.widen(exchange);
  const std::vector<double> diffuse_sun =
      bounds.by_flux(bounds.flux([&](std::size_t k, std::span<double> flux_w_m2) {
        for (std::uint32_t i = 0; i < n; ++i) flux_w_m2[i] = exposure.absorbed_diffuse_w_m2(k, i);
      }),
                     exposure.can_exchange());
  const auto of_facets = [&](const std::vector<double>& of_face) {
    return std::vector<double>(
        of_face.begin(), of_face.begin() + static_cast<std::ptrdiff_t>(exposure.faces().fronts));
  };
  return {of_facets(exchange), of_facets(diffuse_sun)};
}

}  // namespace irsig
