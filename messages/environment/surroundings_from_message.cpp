#include "messages/environment/surroundings_from_message.h"

#include "messages/environment/named.h"

namespace irsig {

absl::StatusOr<Surroundings> surroundings_from_message(const schema::Surroundings& s) {
  const auto kind = named<SurroundingsKind>("surroundings.kind", s.kind(),
                                            {{"none", SurroundingsKind::kNone},
                                             {"sea", SurroundingsKind::kSea},
                                             {"ground", SurroundingsKind::kGround}});
  if (!kind.ok()) return kind.status();
  Surroundings out;
  out.kind = *kind;
  out.sky_temperature_k = s.has_sky_temperature_k() ? s.sky_temperature_k() : -1;
  out.sky_radiance_w_m2_sr_um = s.sky_radiance_w_m2_sr_um();
  out.sea_temperature_k = s.sea_temperature_k();
  out.sea_emissivity = s.sea_emissivity();
  out.lower_radiance_w_m2_sr_um = s.lower_radiance_w_m2_sr_um();
  return out;
}

}  // namespace irsig
