#include "runner/heat_weather.h"

#include <string>
#include <utility>

#include "core/base/status_macros.h"
#include "core/geo/sun.h"
#include "messages/environment/inside_schedule.h"
#include "messages/scene/heat_from_message.h"

namespace irsig {

absl::StatusOr<HeatKnots> heat_weather(const schema::Sweep& sweep, const schema::HeatRun& heat) {
  HeatKnotsRequest request;
  request.course = course_from_message(heat.course());
  ASSIGN_OR_RETURN(request.beneath, ground_from_message(sweep, heat.surroundings()));
  ASSIGN_OR_RETURN(request.sky, sky_from_message(heat, request.beneath.solar_albedo));
  const schema::Place& place = sweep.place();
  request.place = {place.latitude_deg(), place.longitude_deg(), place.height_m()};
  request.heading_deg = place.heading_deg();
  request.speed_m_s = place.speed_m_s();
  for (const std::string& time : heat.time_utc()) {
    ASSIGN_OR_RETURN(const auto utc, parse_rfc3339(time));
    request.time_unix_s.push_back(unix_seconds(utc));
  }
  for (const schema::BuildUp& build_up : sweep.build_up()) {
    ASSIGN_OR_RETURN(auto schedule, inside_schedule(build_up));
    if (schedule) request.inside.push_back(*std::move(schedule));
  }
  request.step_s = 60 * sweep.heat().step_minutes();
  return heat_knots(request);
}

}  // namespace irsig
