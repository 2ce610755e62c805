#include "runner/profile_rows.h"

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/signature/profile.h"
#include "messages/results/profile_messages.h"
#include "runner/check_numbers.h"

namespace irsig {
absl::Status add_profile_rows(const schema::ResolvedSweep& sweep, const Simulator& simulator,
                              const ViewRequest& request, schema::JobResult& result) {
  for (int i = 0; i < sweep.sweep().profile_size(); ++i) {
    const schema::Profile& asked = sweep.sweep().profile(i);
    const ProfileSpec spec = profile_from_message(asked);
    const auto measured = simulate_profile(simulator.scene(), request, spec);
    if (!measured.ok())
      return at_key(absl::StrCat("profile[", i, "]"), measured.status());
    RETURN_IF_ERROR(check_numbers(absl::StrCat("profile[", i, "]"), *measured));
    for (const ProfileRow& row : measured->row)
      for (schema::SignatureRow& signature : *result.mutable_view()->mutable_row()) {
        if (signature.condition_index() != row.condition || signature.band_index() != row.band)
          continue;
        schema::ProfileRow& out = *signature.add_profile();
        out.set_profile_index(static_cast<std::uint32_t>(i));
        out.set_name(asked.name());
        profile_row_to_proto(row, spec, measured->samples[row.point], out);
      }
    const PathCounts& counts = measured->counts;
    result.set_rays(result.rays() + counts.rays);
    result.set_guarded_backface_hits(result.guarded_backface_hits() + counts.guarded_backface_hits);
    result.set_truncated_paths(result.truncated_paths() + counts.truncated_paths);
  }
  return absl::OkStatus();
}

}  // namespace irsig
