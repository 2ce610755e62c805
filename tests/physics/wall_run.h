#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <utility>
#include <vector>

#include "core/thermal/heat_solver.h"

namespace irsig::wall {

// Exposure of one element at a time; equal at both ends of an interval if not linear there.
struct Weather {
  double absorbed_w_m2 = 0, incoming_w_m2 = 0, fluid_k = 300, forced_h_w_m2_k = 0;
};
using WeatherAt = std::function<Weather(std::size_t element, double time_s)>;

inline void set(const FaceExposure& face, std::size_t i, const Weather& weather) {
  face.absorbed_w_m2[i] = weather.absorbed_w_m2;
  face.incoming_w_m2[i] = weather.incoming_w_m2;
  face.fluid_k[i] = weather.fluid_k;
  face.forced_h_w_m2_k[i] = weather.forced_h_w_m2_k;
}

// Continuous weather of both faces.
inline ExposureOf continuous(const std::vector<double>& knot_s, WeatherAt outer, WeatherAt inner) {
  return [knot_s, outer = std::move(outer), inner = std::move(inner)](
             std::size_t interval, std::span<const std::uint32_t> element, const Exposure& out) {
    for (std::size_t i = 0; i < element.size(); ++i) {
      set(out.outer_begin, i, outer(element[i], knot_s[interval]));
      set(out.outer_end, i, outer(element[i], knot_s[interval + 1]));
      set(out.inner_begin, i, inner(element[i], knot_s[interval]));
      set(out.inner_end, i, inner(element[i], knot_s[interval + 1]));
    }
  };
}

inline WeatherAt constant(Weather weather) {
  return [weather](std::size_t, double) { return weather; };
}

inline HeatResult solved(const HeatRequest& request, const ExposureOf& exposure_of) {
  auto result = solve_heat(request, exposure_of);
  EXPECT_TRUE(result.ok()) << result.status();
  return *std::move(result);
}

// One element whose faces take what is given and emit nothing.
inline HeatRequest request_of(std::vector<Layer> layers, InnerSide inner, double start_k,
                              std::vector<double> knot_s, HeatAccuracy accuracy) {
  HeatRequest request{};
  request.layers = std::move(layers);
  request.inner_side = inner;
  request.knot_s = std::move(knot_s);
  request.outer = {{0, kForcedOnly}};
  if (inner == InnerSide::kOpen) request.inner = request.outer;
  request.start = StatedStart{{start_k}, 0};
  for (std::size_t i = 0; i < request.knot_s.size(); ++i) request.output_knot.push_back(i);
  for (std::size_t i = 0; i <= request.layers.size(); ++i) request.output_boundary.push_back(i);
  request.accuracy = accuracy;
  return request;
}

}  // namespace irsig::wall
