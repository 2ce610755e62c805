#pragma once

#include <cstdint>

#include "core/signature/profile.h"
#include "schema/result.pb.h"
#include "schema/sweep.pb.h"

namespace irsig {

[[nodiscard]] ProfileSpec profile_from_message(const schema::Profile& profile);

// Converts the values of a profile; the caller sets the profile's name and numbers.
void profile_row_to_proto(const ProfileRow& row, const ProfileSpec& spec, std::uint64_t samples,
                          schema::ProfileRow& out);

}  // namespace irsig
