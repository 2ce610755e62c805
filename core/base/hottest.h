#pragma once

namespace irsig {

// The most that anything may be said, moved or computed to be at: Planck's law is measured to there
// (core/spectral/planck.h).                                                                  [K]
inline constexpr double kHottestK = 20000;

}  // namespace irsig
