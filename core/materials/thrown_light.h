#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace irsig {

class Material;

// ThrownLight says how bright the light is that a surface reflects: of light from one direction the
// shares of the reflected flux by radiance. Most of what a glossy surface reflects is as bright as
// its lobe. At grazing angles it may be far brighter, but next to nothing leaves there.
class ThrownLight {
 public:
  // per_sr: the largest radiance of the class per irradiance across the light, brdf x cos_i. [1/sr]
  // share: of the reflected flux.
  struct Class {
    double per_sr, share;
  };
  // Classes are made from directions: the share that none of these may have met (95 %).
  [[nodiscard]] static double not_met();

  ThrownLight() = default;
  explicit ThrownLight(const Material& material);

  // Classes from bright to dark. Their shares add up to 1, or there is no class.
  [[nodiscard]] std::span<const Class> of(double cos_i) const;

 private:
  static constexpr std::size_t kCells = 32;  // of sqrt(cos_i)
  std::vector<std::vector<Class>> of_cell_;
};

}  // namespace irsig
