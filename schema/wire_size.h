#pragma once

#include <cstdint>
#include <string_view>

#include "absl/status/status.h"
#include "google/protobuf/descriptor.h"

namespace irsig {

// Checks the memory that a serialized message would need before any of it is allocated: two bytes
// on the wire may stand for an empty message of 600 bytes.
//
// RESOURCE_EXHAUSTED: more than `most_bytes`. INVALID_ARGUMENT: the bytes are not a message of this
// type, or have fields that this version does not know. The estimate agrees with protobuf's
// allocation to within a factor of two (tests/unit/wire_size_test.cpp).
[[nodiscard]] absl::Status check_wire_size(std::string_view bytes,
                                           const google::protobuf::Descriptor& type,
                                           std::uint64_t most_bytes);

}  // namespace irsig
