#include "verify/cases/hard_case.h"

#include "verify/cases/groups.h"

namespace irsig {

std::vector<HardCase> hard_cases() {
  std::vector<HardCase> out;
  for (const auto& group :
       {planck_cases(), geometry_cases(), material_cases(), transport_cases(),
        sun_and_frame_cases(), atmosphere_cases(), cloud_cases(), land_cases(), heat_cases(),
        plume_cases(), honesty_cases(), sum_cases(), image_cases(), determinism_cases()})
    out.insert(out.end(), group.begin(), group.end());
  return out;
}

}  // namespace irsig
