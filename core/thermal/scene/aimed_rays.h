#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/thermal/scene/thermal_faces.h"

namespace irsig {

// Chooses the aims of rays beside those of the cosine: faces whose radiation may differ so much
// from that around them that a missing ray would matter, each in proportion to the warming that it
// might cause. Private to core/thermal/scene.
class AimedRays {
 public:
  // Kept by the caller.
  //   beyond_w_m2  [face] by how much what it sends may differ from what is around it; empty: of
  //                none. Below 20 W/m2 nothing is aimed at.
  //   rays         of each face that has anything to aim at
  AimedRays(const Target& target, const ThermalFaces& faces, std::span<const double> beyond_w_m2,
            std::uint32_t rays);

  [[nodiscard]] std::uint32_t rays(std::uint32_t from) const {
    return !total_w_m2_.empty() && total_w_m2_[from] > kLeastWM2 ? rays_ : 0;
  }
  // Returns true if rays may be aimed at the face.
  [[nodiscard]] bool is_aim(std::uint32_t face) const {
    return !aim_of_face_.empty() && aim_of_face_[face] != kNone;
  }
  // Returns the mean number of the rays of `from` that go to `to`.
  [[nodiscard]] double rays_to(std::uint32_t from, std::uint32_t to) const;
  // Chooses the face at which a ray is aimed. u is uniform in (0, 1); the rays are those of the
  // aiming face last passed to start().
  void start(std::uint32_t from);
  [[nodiscard]] std::uint32_t pick(float u) const;

 private:
  static constexpr std::uint32_t kNone = ThermalFaces::kNone;
  // Smallest warming of a face for which rays are aimed.
  static constexpr double kLeastWM2 = 0.05;
  struct Place {
    FacePoint centre;
    FaceNormal normal;
    float size_m;
  };
  [[nodiscard]] Place place_of(std::uint32_t face) const;
  [[nodiscard]] bool is_in_front(const Place& of, std::uint32_t face) const;
  // Returns the warming of a face by an aim, if nothing stands between.
  [[nodiscard]] double might_w_m2(const Place& from, std::uint32_t from_face,
                                  std::size_t aim) const;

  const Target& target_;
  const ThermalFaces& faces_;
  std::uint32_t rays_;
  std::vector<std::uint32_t> aim_, aim_of_face_;  // faces; [face] which of them
  std::vector<Place> place_;                      // [aim]
  std::vector<double> w_;                         // [aim] what it sends beyond
  std::vector<double> total_w_m2_;                // [face] of all aims
  std::vector<double> until_;                     // [aim] sums, of the face stated last
};

}  // namespace irsig
