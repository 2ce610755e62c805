#pragma once

#include "core/gas/narrow_band.h"

namespace irsig::plain {

[[nodiscard]] NarrowBand co2_band(double wavenumber_cm1, double temperature_k);

}  // namespace irsig::plain
