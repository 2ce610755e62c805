#pragma once

#include "absl/status/statusor.h"
#include "core/signature/simulator.h"
#include "messages/results/thumbnail_encoder.h"
#include "schema/job.pb.h"
#include "schema/result.pb.h"

namespace irsig {

// Converts a result to a message: scalars and spectra unchanged, pictures encoded as PNG and EXR.
// Provenance is left to the caller. FAILED_PRECONDITION: the view has pictures and `encoder` is
// null.
[[nodiscard]] absl::StatusOr<schema::JobResult> result_to_proto(const ViewResult& view,
                                                                const Simulator& simulator,
                                                                const schema::ResolvedSweep& sweep,
                                                                const ThumbnailEncoder* encoder);

// Writes the background around the target into a row that has its wavelengths. The number of modes
// is limited to the number that may be stored (stored_modes of core/accuracy/spectral_modes.h).
void set_clutter(schema::SignatureRow* row, const BackgroundClutter& clutter);

}  // namespace irsig
