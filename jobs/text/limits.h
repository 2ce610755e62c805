#pragma once

namespace irsig {

// The wavelengths that a sweep file may use: from 0.3 um, where optical constants and the sun are
// well known, to 1000 um, the end of the range over which Planck's law is measured.
inline constexpr double kShortestUm = 0.3;
inline constexpr double kLongestUm = 1000.0;

// Larger sweeps are refused before they fill the memory; split them.
inline constexpr int kMostViewpoints = 1000000;
inline constexpr int kMostConditions = 100000;
inline constexpr int kMostPlumes = 1000;  // every worker keeps each of them
inline constexpr int kMostWavelengths = 100000;

}  // namespace irsig
