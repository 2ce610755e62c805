#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/signature/view/prepared_scene.h"
#include "core/signature/view/request.h"
#include "core/signature/view/row.h"
#include "core/signature/view/view_pictures.h"
#include "core/sources/view_sources.h"

namespace irsig {

// LandBackground is what a sensor sees of land, and of sky and ground beyond it, in the pixels of a
// picture without the target. Rays are traced once; their weights by source give the radiance under
// each condition.
class LandBackground {
 public:
  // Computes the land behind a view. INVALID_ARGUMENT as in Environment::view().
  //   rays    along each side of a pixel, even
  //   shadow  true: land has the shadow of the target
  [[nodiscard]] static absl::StatusOr<LandBackground> make(
      const PreparedScene& scene, const ViewRequest& request, const EffectSet& effects,
      const ViewFrame& frame, const PictureFrame& pictures, std::uint32_t rays, bool shadow);

  // Means over pixels under one of the selected conditions, [pixel]: in-band radiance without that
  // of the air between target and sensor, and its error: the difference of a pixel's two halves of
  // rays, and that of temperatures. [W/(m2 sr)]
  struct Radiance {
    std::vector<double> w_m2_sr, error_w_m2_sr;
  };
  [[nodiscard]] Radiance of(std::uint32_t condition, const BandOnAxis& band) const;
  // Means over pixels under one of the selected conditions, [pixel]: ConditionSources::LandParts,
  // where all that is no land counts as seen without air; and the part of a pixel that is no land.
  struct Parts {
    std::vector<double> without_air, emitted, sky, sun;
    std::vector<double> beyond;
  };
  [[nodiscard]] Parts parts_of(std::uint32_t condition, const BandOnAxis& band) const;
  // Returns the mean temperature of the land in each pixel, [pixel]. 0: there is none. [K]
  //   kelvin  [kind] under a condition
  [[nodiscard]] std::vector<double> temperature_k(std::span<const double> kelvin) const;

  // Sources of paths that pixels are made of, and the weights of each pixel, [pixel][source].
  [[nodiscard]] const std::vector<SourceId>& sources() const { return source_; }
  [[nodiscard]] std::vector<float> weights() const;
  [[nodiscard]] const SourceLayout& layout() const { return paths_; }
  [[nodiscard]] const Land& land() const { return std::get<Land>(light_->geometry().boundary); }
  // Returns the light of one of the request's selected conditions.
  [[nodiscard]] const ConditionSources& light(std::uint32_t condition) const;

 private:
  LandBackground() = default;

  struct Weight {
    std::uint32_t source;  // of source_
    std::uint32_t order;   // among the pixel's weights of all groups: sums go through them in it
    float value;
    std::uint8_t half;  // of the pixel's rays
  };
  // Weights of sources that shine together. A condition passes over those of other suns.
  struct Group {
    std::vector<std::size_t> first;  // [pixel], and one behind the last
    std::vector<Weight> weight;      // of a pixel side by side, in their order
  };
  // Returns the groups with any source that shines.
  //   shines  [source]
  [[nodiscard]] std::vector<const Group*> shining(const std::vector<unsigned char>& shines) const;
  // Calls visit(weight) for all weights of a pixel in some groups, in their order.
  template <typename Visit>
  static void for_each_weight(std::span<const Group* const> groups, std::size_t pixel,
                              Visit&& visit);
  [[nodiscard]] std::size_t pixels() const { return group_.front().first.size() - 1; }

  std::vector<std::uint32_t> condition_;  // selected
  std::shared_ptr<const ViewEnvironments> environments_;
  std::unique_ptr<const ViewSources> light_;
  SourceLayout paths_;
  std::vector<SourceId> source_;          // of paths
  std::vector<std::uint32_t> of_source_;  // [source] its group
  std::vector<Group> group_;              // what shines without sun, then land lit by each sun
};

}  // namespace irsig
