#pragma once

#include <cstdint>

#include "core/signature/view/prepared_scene.h"
#include "core/signature/view/request.h"

namespace irsig {

// Returns the seed of a view's random numbers, from the job and the traced scene.
[[nodiscard]] std::uint64_t view_seed(const PreparedScene& scene, const ViewRequest& request);
inline constexpr std::uint64_t kFirstPilotStage = 1, kSecondPilotStage = 2, kStoredStage = 4,
                               kEmissionStage = 5, kPictureStage = 0x91c;

}  // namespace irsig
