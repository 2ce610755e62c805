#include "core/thermal/sky_of_air.h"

#include <cmath>

namespace irsig {

double swinbank_sky_k(double air_k) { return 0.0552 * std::pow(air_k, 1.5); }

double sky_of_other_air_w_m2(double sky_w_m2, double from_k, double to_k) {
  return sky_w_m2 * std::pow(to_k / from_k, 4);
}

}  // namespace irsig
