#pragma once

#include "schema/sweep.pb.h"

namespace irsig {

// Returns true if the surroundings state the radiance of the sky, in one of the two ways.
[[nodiscard]] bool states_sky(const schema::Surroundings& surroundings);

// The sweep's own surroundings with what the season says in their place, field by field.
[[nodiscard]] schema::Surroundings overridden(schema::Surroundings base,
                                              const schema::Surroundings& season);

}  // namespace irsig
