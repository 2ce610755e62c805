#include "core/spectral/solar.h"

#include "core/base/table.h"

namespace irsig {
namespace {
#include "astm_e490_00a.inc"
}

double solar_irradiance_w_m2_um(double lambda_um) {
  return interpolate_or(kAbscissa, kOrdinate, lambda_um, 0.0);
}

}  // namespace irsig
