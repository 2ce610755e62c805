#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/image/apart/picture_subprocess.h"

namespace irsig {

// A ReadPictures (view/pictures/thumbnail.h): what needs OpenImageIO is done by irsig-picture, by as many
// processes as the machine has cores where there are many images.
[[nodiscard]] absl::StatusOr<std::vector<PictureAnswer>> read_pictures(
    const std::vector<PictureTask>& tasks);

}  // namespace irsig
