#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "absl/status/status.h"
#include "core/thermal/heat_request.h"
#include "core/thermal/heat_steps.h"

namespace irsig {

// A table, filled with NaN, of the four numbers of a face at both ends of an interval, and the same
// of the inner face; then the outer face's three numbers of water, where it has some.
class ExposureTable {
 public:
  ExposureTable(std::size_t elements, InnerSide inner, bool wet);

  // Returns the table filled with NaN.
  [[nodiscard]] Exposure empty();
  // Checks an interval. INVALID_ARGUMENT names the interval, the element (by `name`) and the wrong
  // number.
  [[nodiscard]] absl::Status check(std::size_t interval, std::span<const std::uint32_t> name) const;
  // Loads a face. face 0: outer, 1: inner. Absent elements of the last lanes are the last element's
  // copies.
  void load(std::size_t face, std::size_t first, std::span<const double> emissivity,
            HeatFace& out) const;
  // Loads the water on the outer face likewise.
  void load_water(std::size_t first, HeatWater& out) const;

 private:
  [[nodiscard]] std::span<double> column(std::size_t k) {
    return std::span(value_).subspan(k * elements_, elements_);
  }
  [[nodiscard]] bool uses(std::size_t column) const;

  std::size_t elements_;
  InnerSide inner_;
  bool wet_;
  std::vector<double> value_;
};

// Returns the length of the first step in an interval at level 0. A grid is made for the shortest
// of them. [s]
[[nodiscard]] double first_step_s(double interval_s, bool smooth);

// Walls of one build-up on their way from knot to knot at one level of cells and steps, all side by
// side. For whoever needs all of them at a knot before they go on, because what they send to each
// other depends on it; solve_heat goes so too.
class WallWalk {
 public:
  //   shortest_s    first_step_s() of the shortest interval
  //   name          of each element, in messages
  //   outer, inner  as HeatRequest has them, of these elements
  WallWalk(std::span<const Layer> layers, InnerSide inner_side, double shortest_s, int level,
           std::vector<std::uint32_t> name, std::span<const FaceProperties> outer,
           std::span<const FaceProperties> inner);

  [[nodiscard]] std::size_t elements() const { return name_.size(); }
  [[nodiscard]] std::size_t nodes() const { return grid_.last() + 1; }
  [[nodiscard]] const ConductionGrid& grid() const { return grid_; }
  // Returns the temperature of a node, counted from the outer face inwards: node 0 is the outer
  // face, the last one the inner face.
  [[nodiscard]] double& kelvin(std::size_t node, std::size_t element) {
    return t_[element / kHeatLanes * nodes() + node][element % kHeatLanes];
  }
  [[nodiscard]] double kelvin(std::size_t node, std::size_t element) const {
    return t_[element / kHeatLanes * nodes() + node][element % kHeatLanes];
  }
  // Returns the largest value so far of a step: |heat stored - heat that came in| / its length.
  [[nodiscard]] double closure_w_m2(std::size_t element) const { return closure_w_m2_[element]; }

  // Returns the exposure to be filled before each interval.
  [[nodiscard]] Exposure exposure() { return table_.empty(); }
  // Computes an interval; `interval` is for messages.
  [[nodiscard]] absl::Status advance(std::size_t interval, double length_s, bool smooth);

 private:
  ConductionGrid grid_;
  int level_;
  std::vector<std::uint32_t> name_;
  std::vector<double> outer_emissivity_, inner_emissivity_;  // [element]
  struct Faces {
    HeatFace outer, inner;
  };
  std::vector<Faces> faces_;          // [block of kHeatLanes elements]
  std::vector<HeatWater> water_;      // [block]; empty: no element has any
  std::vector<HeatLane> t_;           // [block x nodes + node]
  std::vector<double> closure_w_m2_;  // [element], in whole blocks
  ExposureTable table_;
  HeatLanes lanes_;
  double interval_s_ = 0;
  bool interval_smooth_ = false;
  HeatInterval interval_;
};

}  // namespace irsig
