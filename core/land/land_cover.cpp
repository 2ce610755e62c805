#include "core/land/land_cover.h"

namespace irsig {

void LandCover::at(double, double, std::span<float> fraction) const { fraction[0] = 1; }

}  // namespace irsig
