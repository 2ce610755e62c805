#include "schema/store/find_inputs.h"

#include "core/base/status_macros.h"
#include "schema/store/tables/statements.h"

namespace irsig {

absl::StatusOr<std::vector<StoredInput>> find_inputs(Database& database,
                                                     std::int64_t signature_id) {
  std::vector<StoredInput> out;
  ASSIGN_OR_RETURN(Rows row, database.query(sql::inputs_of_signature, signature_id));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return out;
    StoredInput& input = out.emplace_back();
    input.input = row.text();
    for (StoredInput::Gain* gain : {&input.source, &input.apparent, &input.contrast}) {
      gain->contribution_w_sr = row.real();
      gain->stderr_w_sr = row.real();
    }
    for (StoredInput::Gain* gain : {&input.source, &input.apparent, &input.contrast}) {
      const bool known = !row.is_null();
      gain->curvature_w_sr = row.real();
      if (!known) gain->curvature_w_sr = kNotComputed;
    }
  }
}

}  // namespace irsig
