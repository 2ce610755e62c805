#pragma once

#include "absl/status/status.h"
#include "core/signature/light_component.h"
#include "core/signature/measured_view.h"
#include "core/signature/view/request.h"
#include "core/signature/view/result.h"
#include "core/signature/view/view_pictures.h"

namespace irsig {

// Traces the pictures of all rows, by paths of their own: the same number of samples in every
// pixel, so that no pixel inside the silhouette is empty. Writes them into the rows of `out`,
// which are those of the view; adds what else the components show, and the rays.
//   frame  without pixels: there are no pictures
[[nodiscard]] absl::Status add_pictures(const MeasuredView& view, const ViewRequest& request,
                                        const PictureFrame& frame,
                                        const LightComponents& components, ViewResult& out);

}  // namespace irsig
