#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/thermal/scene/scene_heat.h"
#include "schema/job.pb.h"

namespace irsig {

// The weather of a HeatRun at the knots of its computation.
struct HeatKnots {
  std::vector<double> knot_s;  // an odd count: SceneHeatRequest
  std::vector<HeatWeather> at;
  std::size_t day_knots = 0;
  std::vector<std::size_t> output_of_time;  // [HeatRun.time_utc] index into output_knot
  std::vector<std::size_t> output_knot;     // increasing
  GroundBoundary beneath;
  std::vector<std::string> warning;
};

// Knots: the times wanted, those of what changes inside walls, sunrise and sunset, records where
// they jump (means over hours) or bend (instants under broken cloud), the end of the first day;
// between them at most heat.step_minutes. Times within a minute of a wanted one are taken as that.
[[nodiscard]] absl::StatusOr<HeatKnots> heat_weather(const schema::Sweep& sweep,
                                                     const schema::HeatRun& heat);

}  // namespace irsig
