#pragma once

#include <functional>
#include <string>

#include "core/effects/effects.h"
#include "schema/result.pb.h"

namespace irsig {

// A complete ledger with numbers from `next` (none negative): every state, and numbers that are not
// known.
inline void add_synthetic_ledger(schema::SignatureRow& row, const std::function<double()>& next) {
  int i = 0;
  for (const EffectInfo& info : effect_table()) {
    schema::EffectEntry& e = *row.add_effect();
    e.set_effect(std::string(info.name));
    const bool off = info.switchable && i % 3 == 1, absent = info.switchable && i % 3 == 2;
    e.set_state(off      ? schema::EFFECT_STATE_OFF
                : absent ? schema::EFFECT_STATE_ABSENT
                         : schema::EFFECT_STATE_ON);
    e.set_reason(off ? "within_fraction" : absent ? "not_in_scene" : "always");
    if (off) {
      e.set_bound_w_sr(next());
      e.set_apparent_bound_w_sr(next());
      e.set_contrast_bound_w_sr(next());
    }
    if (!off && !absent && i % 2 == 0) e.set_fraction_w_sr(next());
    if (info.switchable && !absent) e.set_time_s(next());
    ++i;
  }
  schema::EnergyLedger& energy = *row.mutable_energy();
  for (schema::Estimate* share :
       {energy.mutable_absorbed(), energy.mutable_escaped_to_sky(),
        energy.mutable_escaped_to_surface(), energy.mutable_cut_off(), energy.mutable_balance()}) {
    share->set_value(next());
    share->set_stderr(next());
  }
  row.set_omitted_bound_w_sr(next());
  row.set_apparent_omitted_bound_w_sr(next());
  row.set_contrast_omitted_bound_w_sr(next());
  row.set_absolute_floor_w_sr(next());
  row.set_reflections(3);
}

}  // namespace irsig
