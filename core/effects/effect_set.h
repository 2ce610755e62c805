#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace irsig {

// What of a view is simulated: the one value in which that is written down, for whoever makes light
// (core/environment), holds it (core/sources) or follows it (core/transport, core/signature). What
// it leaves out is dark.
struct EffectSet {
  std::uint32_t max_reflections = 0;
  bool skip_self_intersection = false;          // of a convex target: no reflected ray is traced
  bool sky = true, lower = true, parts = true;  // whether reflections see them
  bool joined_lines = true;
  struct Sun {  // of one condition
    bool direct = true, diffuse = true, mirrored = true, path = true, background = true;
    bool operator==(const Sun&) const = default;
  };
  std::vector<Sun> sun;  // [condition]

  // Nothing is left out.
  [[nodiscard]] static EffectSet everything(std::size_t conditions, std::uint32_t reflections) {
    EffectSet out;
    out.max_reflections = reflections;
    out.sun.resize(conditions);
    return out;
  }

  [[nodiscard]] bool reflections() const { return max_reflections > 0; }
  // Whether anything around the target is reflected by it.
  [[nodiscard]] bool surroundings() const { return reflections() && (sky || lower); }
  // Whether rays go to a condition's sun, or to its image in the sea.
  [[nodiscard]] bool follows_sun(std::size_t condition) const {
    return reflections() && (sun[condition].direct || sun[condition].mirrored);
  }
  // Whether sunlight that sky and surface scatter is reflected.
  [[nodiscard]] bool scattered_sun(std::size_t condition) const {
    return surroundings() && sun[condition].diffuse;
  }

  // Whether the other calls for the same light of air, sky and surface: how often it is reflected
  // and whether by other parts makes no difference to that.
  [[nodiscard]] bool same_light(const EffectSet& other) const {
    return reflections() == other.reflections() && sky == other.sky && lower == other.lower &&
           joined_lines == other.joined_lines && sun == other.sun;
  }

  bool operator==(const EffectSet&) const = default;
};

}  // namespace irsig
