#include "messages/environment/condition_sun.h"

#include "core/base/status_macros.h"
#include "messages/environment/weather_from_message.h"

namespace irsig {

absl::StatusOr<SunPosition> condition_sun(const schema::ResolvedSweep& sweep,
                                          const schema::Condition& condition) {
  ASSIGN_OR_RETURN(const auto time, parse_rfc3339(condition.time_utc()));
  const schema::Place& place = sweep.sweep().place();
  return sun_position(time, place.latitude_deg(), place.longitude_deg(),
                      place.height_m() + above_surface_m(sweep, condition));
}

absl::StatusOr<SunAngles> sun_angles(const schema::ResolvedSweep& sweep,
                                     const schema::Condition& condition) {
  ASSIGN_OR_RETURN(const auto sun, condition_sun(sweep, condition));
  return SunAngles{sun.azimuth_deg, sun.zenith_deg};
}

}  // namespace irsig
