#include "schema/store/find_ledger.h"

#include "core/base/status_macros.h"
#include "schema/store/tables/statements.h"

namespace irsig {

absl::StatusOr<StoredLedger> find_ledger(Database& database, std::int64_t signature_id) {
  StoredLedger ledger;
  {
    ASSIGN_OR_RETURN(Rows row, database.query(sql::ledger_of_signature, signature_id));
    for (;;) {
      ASSIGN_OR_RETURN(const bool found, row.next());
      if (!found) break;
      StoredEffect& e = ledger.effect.emplace_back();
      for (std::string* text : {&e.effect, &e.state, &e.reason}) *text = row.text();
      for (double* number : {&e.bound_w_sr, &e.apparent_bound_w_sr, &e.contrast_bound_w_sr,
                             &e.fraction_w_sr, &e.time_s}) {
        const bool known = !row.is_null();
        *number = row.real();
        if (!known) *number = kNotComputed;
      }
    }
  }
  ASSIGN_OR_RETURN(Rows row, database.query(sql::energy_of_signature, signature_id));
  ASSIGN_OR_RETURN(const bool found, row.next());
  if (!found) return ledger;
  StoredEnergy& e = ledger.energy.emplace();
  for (double* number :
       {&e.absorbed, &e.absorbed_stderr, &e.escaped_to_sky, &e.escaped_to_sky_stderr,
        &e.escaped_to_surface, &e.escaped_to_surface_stderr, &e.cut_off, &e.cut_off_stderr,
        &e.balance, &e.balance_stderr}) {
    *number = row.real();
  }
  return ledger;
}

}  // namespace irsig
