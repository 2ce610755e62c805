#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/thermal/scene/day_response.h"
#include "core/thermal/scene/scene_exposure.h"
#include "core/thermal/wall_walk.h"

namespace irsig {

// All walls of a computation, which go from knot to knot together: at each what faces send to each
// other is that of their temperatures there. The next knot's is foreseen: that of the pass before,
// more what this pass differs by now. So one pass over the knots brings a day nearer to the one
// that it follows and the exchange nearer to what the temperatures are, both at once.
// Private to core/thermal/scene.
class SceneWalls {
 public:
  // Both are kept by the caller.
  //   shortest_s  first_step_s() of the shortest interval that its cells are made for
  SceneWalls(SceneExposure& exposure, const SceneHeatRequest& request, double shortest_s);

  // Checks the build-ups. INVALID_ARGUMENT names the fault and the build-up.
  [[nodiscard]] absl::Status check() const;
  // Passes until another one would change nothing by more than half of exchange_tolerance_k and
  // the day begins where it ends.
  [[nodiscard]] absl::Status settle();
  // Continues with cells and steps half as long.
  void refine();
  // Starts from the result of walls of the same level with every second knot.
  void start_from(const SceneWalls& coarse);
  // Starts from the result of walls of the same level, knots and build-ups in a nearly equal world;
  // walls that are cut otherwise begin anew.
  void start_near(const SceneWalls& other);
  // Walls whose conduction is not known to tolerance_k once more, among the others as they are,
  // with cells and steps that are halved until it is.
  //   off_k  [face] what the last halving has changed at any knot
  [[nodiscard]] absl::Status sharpen(std::vector<float> off_k);

  [[nodiscard]] float kelvin(std::size_t k, std::uint32_t face) const {
    return kelvin_[k * faces_.size() + face];
  }
  // [knot x faces + face]
  [[nodiscard]] const std::vector<float>& kelvin() const { return kelvin_; }
  // Likewise: long-wave irradiance, of the mean of both sides where the sky jumps.
  [[nodiscard]] const std::vector<float>& incoming() const { return incoming_; }
  // Returns the error at any knot from conduction, and from the begin of the day.
  [[nodiscard]] double error_k(std::uint32_t face) const { return error_k_[face]; }
  [[nodiscard]] int passes() const { return passes_; }
  // Returns an upper bound of the change by another pass.
  [[nodiscard]] double left_k() const { return left_k_; }
  [[nodiscard]] double closure_w_m2() const { return closure_w_m2_; }

 private:
  struct Wall {
    std::uint32_t build_up;
    std::vector<std::uint32_t> face, back;  // [element]; back: kNone where there is none
    std::vector<FaceProperties> outer, inner;
    std::vector<double> begin_k;  // [element x nodes + node] of the day
    // [element x nodes + node] Of the day before: its begin, and how far that was from the one that
    // repeats.
    std::vector<double> before_k, step_k;
    std::optional<DayResponse> response;
    std::vector<double> day_left_k;  // [element]
  };

  [[nodiscard]] const WallBuildUp& build_up_of(const Wall& wall) const {
    return request_.build_up[wall.build_up];
  }
  // Returns some of a wall's elements, with cells half as long.
  [[nodiscard]] static Wall refined(const Wall& wall, std::span<const std::size_t> element);
  [[nodiscard]] absl::Status named(const Wall& wall, const absl::Status& status) const;
  [[nodiscard]] std::vector<WallWalk> walks_at_begin(std::span<const Wall> walls, int level) const;
  void note_kelvin(std::size_t k, std::span<const Wall> walls, const std::vector<WallWalk>& walks);
  // Choice of the irradiance between two knots.
  enum class Incoming {
    kForeseen,  // at the second: from the temperatures at the first alone
    kKnown,     // as in the pass before, more what this one differs by
    kFixed,     // at both: as it was
  };
  // Walks once from knot to knot.
  [[nodiscard]] absl::Status pass(std::size_t first, std::size_t last, Incoming incoming,
                                  std::span<const Wall> walls, std::vector<WallWalk>& walks,
                                  std::span<std::optional<WallWalk>> probes);
  // Walks once over the day and computes its next begin; returns the distance of the next begin
  // from this one.
  [[nodiscard]] absl::StatusOr<double> day(Incoming incoming, int level, std::span<Wall> walls,
                                           std::vector<WallWalk>& walks);
  // Passes from knot to knot until they are settled; `walks` at the first come out at the last.
  [[nodiscard]] absl::Status settle(std::size_t first, std::size_t last, bool repeats,
                                    std::vector<WallWalk>& walks);
  // Returns a typical element of a wall, and others like it that begin warmer at one node each.
  [[nodiscard]] WallWalk probes(const Wall& wall, int level) const;
  double next_begin(const WallWalk& walk, Wall& wall) const;
  [[nodiscard]] double largest_change_k(const std::vector<float>& before, std::size_t first,
                                        std::size_t last) const;
  // Computes the exposure of an inner face without its long-wave irradiance.
  void inside(const Wall& wall, std::size_t k, SceneExposure::Side side,
              const FaceExposure& to) const;
  void note_closure(const std::vector<WallWalk>& walks);

  SceneExposure& exposure_;
  const SceneHeatRequest& request_;
  const ThermalFaces& faces_;
  double shortest_s_, mean_k_;
  int level_ = 0;
  std::vector<Wall> wall_;
  std::vector<float> incoming_, kelvin_;  // [knot x faces + face]
  bool incoming_known_ = false;           // from a coarser computation
  std::vector<double> error_k_;           // [face]
  std::optional<double> falls_;           // the change from a pass to the next, by this factor
  int passes_ = 0;
  double left_k_ = 0, closure_w_m2_ = 0;
};

}  // namespace irsig
