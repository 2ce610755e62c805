#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace irsig {

// The effects that are simulated in a view. This one value serves the code that makes light
// (core/environment), holds it (core/sources) and follows it (core/transport, core/signature).
// Light that is left out is dark.
struct EffectSet {
  std::uint32_t max_reflections = 0;
  bool skip_self_intersection = false;          // of a convex target: no reflected ray is traced
  bool sky = true, lower = true, parts = true;  // whether reflections see them
  bool joined_lines = true;
  struct Sun {  // of one condition
    bool direct = true, diffuse = true, mirrored = true, path = true, background = true;
    bool operator==(const Sun&) const = default;
  };
  std::vector<Sun> sun;     // [condition]
  std::vector<bool> cloud;  // [condition] false: its sky is clear; empty: none is cleared

  // Returns the set with nothing left out.
  [[nodiscard]] static EffectSet everything(std::size_t conditions, std::uint32_t reflections) {
    EffectSet out;
    out.max_reflections = reflections;
    out.sun.resize(conditions);
    return out;
  }

  [[nodiscard]] bool reflections() const { return max_reflections > 0; }
  // Returns true if the target reflects anything around it.
  [[nodiscard]] bool surroundings() const { return reflections() && (sky || lower); }
  // Returns true if rays go to a condition's sun, or to its image in the sea.
  [[nodiscard]] bool follows_sun(std::size_t condition) const {
    return reflections() && (sun[condition].direct || sun[condition].mirrored);
  }
  // Returns true if sunlight that sky and surface scatter is reflected.
  [[nodiscard]] bool scattered_sun(std::size_t condition) const {
    return surroundings() && sun[condition].diffuse;
  }

  // Returns true unless a condition's cloud is left out.
  [[nodiscard]] bool has_cloud(std::size_t condition) const {
    return cloud.empty() || cloud[condition];
  }

  // Returns true if the other set needs the same light of air, sky and surface. The number of
  // reflections, and reflection by other parts, do not change this light.
  [[nodiscard]] bool same_light(const EffectSet& other) const {
    return reflections() == other.reflections() && sky == other.sky && lower == other.lower &&
           joined_lines == other.joined_lines && sun == other.sun && cloud == other.cloud;
  }

  bool operator==(const EffectSet&) const = default;
};

}  // namespace irsig
