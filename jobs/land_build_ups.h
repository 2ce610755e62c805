#pragma once

#include <string>

#include "schema/sweep.pb.h"

namespace irsig {

// Ground below the library's materials of land, and their absorption of sunlight. With [heat], land
// without a stated temperature has a computed one.

// Returns true if an entry of the material library has a build-up by default.
[[nodiscard]] bool has_land_build_up(const std::string& entry);

// Writes solar_absorptance and, where neither [land] nor every season states a temperature, the
// build_up of each [[land.material]] of the library; the build-ups are added to sweep.build_up.
// Stated values stay. Without [heat] nothing is written.
void write_land_build_ups(schema::Sweep& sweep);

}  // namespace irsig
