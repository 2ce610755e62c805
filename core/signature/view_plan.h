#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "core/signature/signature.h"

namespace irsig {

// Random numbers: of the job, and of what is traced for it.
[[nodiscard]] std::uint64_t view_seed(const Simulator& simulator, const ViewRequest& request);
inline constexpr std::uint64_t kFirstPilotStage = 1, kSecondPilotStage = 2, kStoredStage = 4,
                               kEmissionStage = 5;

// What makes no sense for this scene.
[[nodiscard]] absl::Status check_request(const Simulator& simulator, const ViewRequest& request);

}  // namespace irsig
