#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/thermal/scene/radiosity.h"
#include "core/thermal/scene/scene_heat_request.h"
#include "core/thermal/scene/thermal_faces.h"

namespace irsig {

// The request's knots that a computation has, and its numbers of rays.
struct SceneKnots {
  std::vector<std::size_t> of_request;
  std::size_t day_intervals;
  std::uint32_t rays, sun_points;
  std::uint64_t seed;
  bool keep_hits = false;  // for rays_k()
};

// Exposure of all faces at all knots of a computation. Private to core/thermal/scene.
class SceneExposure {
 public:
  // All of them are kept by the caller. Traces what exchange and sunlight need.
  //   near  of the same faces and knots, whose exchange factors are this one's too; null: none
  SceneExposure(const Target& target, const ThermalFaces& faces, const SceneHeatRequest& request,
                SceneKnots knots, const SceneExposure* near = nullptr);

  [[nodiscard]] const ThermalFaces& faces() const { return faces_; }
  [[nodiscard]] std::size_t knots() const { return knots_.of_request.size(); }
  [[nodiscard]] std::size_t day_intervals() const { return knots_.day_intervals; }
  // Returns the index of this computation's knot among the request's knots.
  [[nodiscard]] std::size_t of_request(std::size_t k) const { return knots_.of_request[k]; }
  [[nodiscard]] double knot_s(std::size_t k) const { return request_.knot_s[of_request(k)]; }
  [[nodiscard]] const HeatWeather& weather(std::size_t k) const {
    return request_.weather[of_request(k)];
  }
  // Returns true if the radiation after a knot continues that before the knot.
  [[nodiscard]] bool is_smooth(std::size_t k) const;
  [[nodiscard]] const HeatPart& part_of(std::uint32_t face) const {
    return request_.part[target_.facet[faces_.facet[face]].part];
  }
  [[nodiscard]] FaceProperties properties(std::uint32_t face) const;
  // Returns true if nothing from outside reaches a facet on either side: the facet stands inside
  // other bodies, is invisible, and is left out.
  [[nodiscard]] bool dark(std::uint32_t facet) const { return dark_[facet]; }
  // Leaves out what either of two computations with rays of their own finds dark, so that both have
  // the same walls.
  static void fraction_dark(SceneExposure& a, SceneExposure& b);
  // Returns true if faces send anything to each other.
  [[nodiscard]] bool exchanges() const { return request_.exchange && can_exchange(); }
  [[nodiscard]] bool can_exchange() const { return !factors_->to.empty(); }

  // Computes the long-wave irradiance of every face at a knot, for faces of these temperatures;
  // `incoming_w_m2` comes with a guess. Where the sky jumps, the result is the mean of both sides,
  // and sky_jump_w_m2() is the difference of either side from it. All [face].
  void long_wave(std::size_t k, std::span<const float> kelvin, double tolerance_w_m2,
                 std::span<double> incoming_w_m2);
  // Like long_wave(), with the other faces black and as warm as the air, whatever is asked.
  void long_wave_of_air(std::size_t k, std::span<double> incoming_w_m2);
  // Excess of a face's irradiance over the mean of both sides at a knot, on the later side; on the
  // earlier side it is as much less.
  [[nodiscard]] double sky_jump_w_m2(std::size_t k, std::uint32_t face) const {
    return half_jump_w_m2(k) * static_cast<double>(of_sky_[face]);
  }
  // Returns the difference of that jump between a world with exchange and one without.
  [[nodiscard]] double exchanged_jump_w_m2(std::size_t k, std::uint32_t face) const {
    return half_jump_w_m2(k) *
           std::abs(static_cast<double>(of_sky_exchanged_[face] - of_sky_alone_[face]));
  }
  // Like long_wave(), with the radiation of the other faces, whatever is asked.
  void long_wave_of_faces(std::size_t k, std::span<const float> kelvin, double tolerance_w_m2,
                          std::span<double> incoming_w_m2);
  // Computes the irradiance if faces emit so much and nothing else does; `incoming_w_m2` comes with
  // a guess.
  void arriving(std::span<const double> emitted_w_m2, double tolerance_w_m2,
                std::span<double> incoming_w_m2);
  // Returns the absorbed diffuse sunlight of the sky at a knot, also where the request leaves it
  // out, on its brighter side.
  [[nodiscard]] double absorbed_diffuse_w_m2(std::size_t k, std::uint32_t face) const {
    return std::max(weather(k).before.diffuse_horizontal_w_m2,
                    weather(k).after.diffuse_horizontal_w_m2) *
           static_cast<double>(diffuse_[face]);
  }

  // Side of a knot: the begin of the interval after it, or the end of the one before.
  enum class Side { kAfter, kBefore };
  // Writes the exposure of some faces, but for their long-wave irradiance; of water where there is
  // room for it. [face of the list]
  void expose(std::size_t k, Side side, std::span<const std::uint32_t> face,
              const FaceExposure& to) const;

  // Estimates from above the root mean square deviation of places of a facet from its temperature
  // because the sun does not reach all of them, at every knot. The difference of their sunlight
  // warms as much of the wall as an hour reaches, or as a day does, whichever gives more, against
  // convection and radiation of the face alone. [knot]
  //   kelvin  [knot] of the facet's front
  [[nodiscard]] std::vector<double> uneven_k(std::uint32_t facet,
                                             std::span<const float> kelvin) const;
  // Returns the error of a facet's temperature at a knot because few rays sample the radiation of
  // their aims: balanced by the same losses, for as long as it takes.
  [[nodiscard]] double aimed_k(std::size_t k, std::uint32_t facet, double kelvin) const;
  // Returns the error from all other rays, at every knot: from the differences between blocks of
  // rays, and the loss of a single ray. An estimate from above, since blocks are spread less evenly
  // than all rays. Needs SceneKnots::keep_hits. [knot]
  //   kelvin       [knot x faces + face]
  //   incoming     likewise, long-wave irradiance
  //   front_kelvin [knot] of the facet's front
  [[nodiscard]] std::vector<double> by_rays_k(std::uint32_t facet, std::span<const float> kelvin,
                                              std::span<const float> incoming,
                                              std::span<const float> front_kelvin) const;

 private:
  // Writes what the air does with the water on a face that is not covered.
  void expose_water(std::size_t k, const HeatRadiation& light, std::uint32_t face, std::size_t at,
                    const FaceExposure& to) const;
  // Returns half of the difference in the sky's radiation after and before a knot.
  [[nodiscard]] double half_jump_w_m2(std::size_t k) const {
    return 0.5 * (weather(k).after.sky_w_m2 - weather(k).before.sky_w_m2);
  }
  // Returns the warming by a flux into a facet, known at all knots: of as much of the wall as an
  // hour reaches, or as a day does, whichever gives more, against convection and radiation. [knot]
  [[nodiscard]] std::vector<double> warms_k(std::uint32_t facet, std::span<const double> heat_w_m2,
                                            std::span<const float> front_kelvin) const;
  // Returns the standard error of the absorbed radiation of a face, by its rays.
  [[nodiscard]] double ray_stderr_w_m2(std::size_t k, std::uint32_t face,
                                       std::span<const float> kelvin,
                                       std::span<const float> incoming) const;
  // Returns a lower bound of the additional loss of a face that is a kelvin warmer.
  [[nodiscard]] double loss_w_m2_k(std::size_t k, std::uint32_t face, double kelvin) const;
  // Coordinates are known to a part of the target's size.
  [[nodiscard]] double touching_m() const;
  [[nodiscard]] double surface_z_m() const;
  void light();
  void respond_to_sky();
  // Adds the radiation of the sky and of the surface below to own_.
  void send_around(std::size_t k);

  const Target& target_;
  const ThermalFaces& faces_;
  const SceneHeatRequest& request_;
  SceneKnots knots_;
  std::vector<double> windward_w_m2_k_, leeward_w_m2_k_;  // [knot]
  double in_water_w_m2_k_ = 0;
  std::vector<bool> covered_;       // [face] under water or ground
  std::vector<bool> dark_;          // [facet]
  std::vector<double> emissivity_;  // [face]
  std::shared_ptr<const ExchangeFactors> factors_;
  Radiosity long_wave_;
  std::vector<double> own_, emitted_;    // [face], scratch
  std::vector<float> direct_, diffuse_;  // [knot x faces + face], [face]
  // [face] What arrives for each W/m2 that the sky sends: as asked, and with and without exchange.
  std::vector<float> of_sky_, of_sky_exchanged_, of_sky_alone_;
  // [knot x faces + face] Of direct_: the root mean square over the face of what a place differs
  // by.
  std::vector<float> uneven_;
};

}  // namespace irsig
