#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace irsig {

// Vibrating and rotating water on the surface of water_surface.h, without a model of its levels:
// the kinetic energy in Radau's coordinates r1, r2 (of the hydrogen nuclei, m1 and m2) and the
// angle t between them, with x along the bisector, z beside it in the plane, hbar = 1,
//   T = -d1^2 / 2 m1 - d2^2 / 2 m2
//       + g [-(dt^2 + cot t dt) + Jy^2 / 4 + Jx^2 / (4 sin^2 t/2) + Jz^2 / (4 cos^2 t/2)]
//       + f [(1/i)(dt + cot t / 2) Jy - (Jx Jz + Jz Jx) / (2 sin t)],
//   g, f = 1 / (2 m1 r1^2) +- 1 / (2 m2 r2^2).
// States of vibration for each |K| = |Jz| are found first; those below a limit are the basis of the
// levels of each J.
enum class WaterKind { kH2o, kHdo };

struct WaterBasisOptions {
  WaterKind kind = WaterKind::kH2o;
  double highest_cm1 = 20000;  // of the basis, above the lowest level
  std::size_t most_j = 36;
};

class WaterBasis {
 public:
  explicit WaterBasis(const WaterBasisOptions& options);

  // States of K and exchange symmetry s, by rising energy above the lowest level. s is 0 (even) or
  // 1 (odd) in H2O; HDO has no such symmetry: its states have s = 0, and "the other s" is the same.
  struct States {
    std::vector<double> energy_cm1;  // with the rotation of J = K
    // [row * count + column] of this and of other states:
    std::vector<double> along;  // (a + b) / 2 within the states: times J (J + 1) - K (K + 1)
    std::vector<double> twist;  // (a - b) / 4 to K + 2, same s; of K = 1 to itself in `twist_one`
    std::vector<double> twist_one;
    std::vector<double> coupling;  // to K + 1, other s
    std::vector<double> dipole_z;  // to K, other s                                    [debye]
    std::vector<double> dipole_x;  // to K + 1, same s
  };
  [[nodiscard]] const States& states(std::size_t k, std::size_t s) const {
    return states_[2 * k + s];
  }
  // Return the number of symmetries, and the other symmetry.
  [[nodiscard]] std::size_t symmetries() const { return options_.kind == WaterKind::kH2o ? 2 : 1; }
  [[nodiscard]] std::size_t other(std::size_t s) const {
    return options_.kind == WaterKind::kH2o ? 1 - s : s;
  }
  [[nodiscard]] double zero_cm1() const { return zero_cm1_; }
  [[nodiscard]] const WaterBasisOptions& options() const { return options_; }

 private:
  WaterBasisOptions options_;
  double zero_cm1_ = 0;
  std::vector<States> states_;
};

// The levels of one J, parity (-1)^(J + p) and symmetry: K even has vibrations of symmetry s, K odd
// those of the other.
struct WaterLevels {
  std::size_t j = 0, p = 0, s = 0;
  double nuclear_weight = 1;       // of H2O 1 or 3; of HDO all have 1
  std::vector<double> energy_cm1;  // above the lowest level
  std::vector<std::size_t> first;  // [K] of the basis; most_j + 2 entries
  std::vector<double> vector;      // [level * size + state]
  [[nodiscard]] std::size_t size() const { return first.back(); }
};
[[nodiscard]] WaterLevels water_levels(const WaterBasis& basis, std::size_t j, std::size_t p,
                                       std::size_t s, double highest_cm1);

// Computes the squared dipole moments between all levels of two groups, [upper * lower count +
// lower] (debye^2, times 2 J + 1, without the nuclear weight). Zero-sized unless the groups have J'
// = J and other p, or J' = J + 1 and the same p, and the other s in both.
[[nodiscard]] std::vector<double> water_moments(const WaterBasis& basis, const WaterLevels& from,
                                                const WaterLevels& to);

}  // namespace irsig
