#pragma once

#include "schema/sweep.pb.h"

namespace irsig {

// Returns true if the surroundings state the radiance of the sky, in one of the two ways.
[[nodiscard]] bool states_sky(const schema::Surroundings& surroundings);

// Returns the sweep's surroundings, with each field that the season states replaced by the
// season's.
[[nodiscard]] schema::Surroundings overridden(schema::Surroundings base,
                                              const schema::Surroundings& season);

}  // namespace irsig
