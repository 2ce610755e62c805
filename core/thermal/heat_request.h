#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <variant>
#include <vector>

#include "core/thermal/convection.h"
#include "core/thermal/evaporation.h"
#include "core/thermal/layers.h"

namespace irsig {

// Boundary condition of the inner face.
enum class InnerSide {
  kAdiabatic,
  kHeatFlux,          // absorbed_w_m2
  kAir,               // fluid_k, forced_h_w_m2_k: air or water, its radiation within h
  kFixedTemperature,  // fluid_k
  kOpen,              // a balance of its own, as the outer face
};

// Heat into a face of temperature T:
//
//   absorbed + emissivity (incoming - sigma T^4) + h (T_fluid - T) - latent            [W m^-2]
//
// The latent heat (evaporation.h) takes h at the face's temperature at the begin of each step: the
// error of that is of first order in the step, and halving the steps shows it.
struct FaceProperties {
  double emissivity;  // hemispherical, total, of long-wave absorption and emission: [0, 1]
  Convection convection;
  Evaporation evaporation = {};  // of outer faces
};

// Exposure of a face at one instant. [element of the call]
struct FaceExposure {
  std::span<double> absorbed_w_m2;    // short-wave, and whatever else reaches the face
  std::span<double> incoming_w_m2;    // long-wave irradiance, >= 0
  std::span<double> fluid_k;          // (0, 1e5]
  std::span<double> forced_h_w_m2_k;  // forced part of h (convection.h), >= 0
  // Only where an element of the request has Evaporation::on, and of outer faces; else empty.
  std::span<double> vapour_pa = {};           // vapour pressure of the air, [0, 1e6]
  std::span<double> inverse_gamma_k_pa = {};  // 0: nothing evaporates or condenses; to 1
  std::span<double> stomatal_w_m2_k = {};     // conductance of the stomata, [0, 1e9]
};

// Exposure at both ends of the time between two knots; linear between them. A quantity that jumps
// at a knot (a shadow's edge; an hour's record that is a mean, the same at begin and end) has one
// value at the end of one interval and another at the begin of the next. Heat is integrated exactly
// along such lines.
struct Exposure {
  FaceExposure outer_begin, outer_end;
  FaceExposure inner_begin, inner_end;  // only what the InnerSide lists; kOpen: all
};

// Fills all spans (they come filled with NaN, and what is then still NaN is an error) for the given
// elements of the request in the interval from knot `interval` to the next. A function of its
// arguments: it is asked several times for the same.
using ExposureOf = std::function<void(std::size_t interval, std::span<const std::uint32_t> element,
                                      const Exposure& exposure)>;

// Temperatures at the first knot: one of all layers, or one of each. A stated uncertainty (of a
// guess that a run-up of earlier days lets fade) goes into the errors as far as it has not faded.
struct StatedStart {
  std::vector<double> temperature_k;
  double uncertainty_k;  // >= 0
};
// The first `intervals` intervals are a day that has repeated for ever. Days are repeated from a
// uniform guess, accelerated (Anderson's method), until the distance that is left is below
// tolerance_k everywhere inside; at most max_days. What is left goes into the errors.
struct PeriodicStart {
  double guess_k;
  std::size_t intervals;
  double tolerance_k;
  int max_days;
  // A better guess: HeatResult::begin_k of a request with the same layers and knots; empty: none.
  std::vector<double> begin_k = {};
};

// Depth and time are cut coarsely (level 0), then cells and steps are halved (level 1, 2, ...)
// until the results of two levels differ by at most tolerance_k, for each element by itself.
struct HeatAccuracy {
  double tolerance_k = 0.01;
  // [0, 10]: one more takes four times as long. 0: computed once, with infinite error_k.
  int max_level = 6;
};

struct HeatRequest {
  std::vector<Layer> layers;
  InnerSide inner_side;
  std::vector<double> knot_s;  // increasing, two or more: steps end at every knot
  // [knot] Exposures have no jump there, so that steps need not begin short; empty: nowhere so.
  std::vector<bool> smooth = {};
  std::vector<FaceProperties> outer;  // [element]
  std::vector<FaceProperties> inner;  // [element]; kOpen only. kAir: h is the forced part
  std::variant<StatedStart, PeriodicStart> start;
  std::vector<std::size_t> output_knot;      // increasing
  std::vector<std::size_t> output_boundary;  // 0: outer face ... layers.size(): inner face
  HeatAccuracy accuracy;
};

struct HeatResult {
  std::size_t boundaries, elements;
  // [(output knot x boundaries + output boundary) x elements + element]
  std::vector<double> temperature_k;
  // Error of each temperature: largest difference to the level before anywhere in the wall, about
  // three times the error of discretisation, and the remainder of the start. Not checked: that
  // layers, exposure and h are right.
  std::vector<double> error_k;
  std::vector<int> level;  // [element]: the one that temperature_k is of
  // [element] Largest of a step: |heat stored - heat that came in| / its length.
  std::vector<double> closure_w_m2;
  // Start of the day, with a periodic start. [node x elements + element]
  std::vector<double> begin_k;

  [[nodiscard]] std::size_t at(std::size_t output, std::size_t boundary,
                               std::size_t element) const {
    return (output * boundaries + boundary) * elements + element;
  }
};

}  // namespace irsig
