#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/image/apart/picture_subprocess.h"

namespace irsig {

// Reads pictures with irsig-picture, as a ReadPictures (view/pictures/thumbnail.h); only that
// program uses OpenImageIO. For many images it runs as many processes as the machine has cores.
[[nodiscard]] absl::StatusOr<std::vector<PictureAnswer>> read_pictures(
    const std::vector<PictureTask>& tasks);

}  // namespace irsig
