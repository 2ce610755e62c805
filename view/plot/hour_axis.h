#pragma once

#include <optional>
#include <string>

#include "view/draw/axis.h"

namespace irsig {

// Returns an axis of 24 hours or more that covers [first_h, last_h], with a tick every 3 h that
// shows the hour of its day.
[[nodiscard]] Axis hour_axis(double first_h, double last_h);

// Returns the title of that axis.
//   solar_offset_h  local mean solar time minus UTC; nullopt: hours are of UTC
[[nodiscard]] std::string hour_label(const std::optional<double>& solar_offset_h);

}  // namespace irsig
