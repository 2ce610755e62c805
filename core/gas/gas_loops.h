#pragma once

#include <cstddef>
#include <cstdint>

#include "core/gas/hot_lines.h"

namespace irsig {

// The loops over bands and points in which the time of hot gas goes, for the widest vectors of the
// processor. The same bits whatever their width. Private to core/gas.

inline constexpr std::size_t kGasLanes = 8;

// A quantity before a segment of gas, and what the segment adds to it, of many bands: digits of the
// change are its own however small it is beside the quantity.
struct Steps {
  double *from, *by;
};

// Bands of lines at random, one gas, along a path: optical depth of a Goody distribution, Lorentz
// and Doppler widths joined, mean widths by Curtis and Godson.           [ludwig1973, 5-25 to 5-27]
//
//   X = sum of S/d u;  a_c = sum of (S/d u gamma_c / d) / X, a_d likewise
//   X_c = X / sqrt(1 + X / (4 a_c)),  X_d = 1.7 a_d sqrt(ln(1 + (X / (1.7 a_d))^2))
//   depth = X sqrt(1 - Y^(-1/2)),  Y = (1 - (X_c/X)^2)^-2 + (1 - (X_d/X)^2)^-2 - 1
//
// One formula from 1e-280 (less is nothing) to 1e280: depth is X where it is thin, and what a
// segment adds to it has a relative error of 1e-13 times (1 + ln of the depths' ratio) whatever
// lies before.
struct GrowthSums {
  double *weak, *lorentz, *doppler;  // sums of X, a_c X, a_d X
  double* depth;
};
//   weak              S/d u of the segment, >= 0
//   lorentz, doppler  half widths times 1/d, > 0
//   through           transmittance
void grow(std::size_t bands, const GrowthSums& sums, const double* weak, const double* lorentz,
          const double* doppler, const Steps& through);

// Computes exp(-d) and exp(-d) - 1 of a segment as one number: the second where it is above -1/2
// (and not positive), else the first. For kGasLanes k points.
void line_decay(std::size_t points, const std::int32_t* thousandth_ln, const HotLinePlace& place,
                double amount_mol_m2, double* decay);
struct LineStep {
  double from, by;
};
// Takes light through the lines of a segment.
//   left  weight exp(-depth) of each point; becomes the one behind the segment
[[nodiscard]] LineStep through_lines(std::size_t points, const double* decay, double* left);

// Multiplies a step by a factor.
void multiply(std::size_t bands, const Steps& step, const Steps& factor);
// Multiplies by the factor of soot; `depth` becomes the one behind the segment.
void soot_step(std::size_t bands, double volume_fraction_m, const double* per_m, double* depth,
               const Steps& through);

// Computes Planck's function as the mean of two temperatures; scale: c1L / lambda^5.
void planck_mean(std::size_t bands, const double* lambda_um, const double* scale, double t1,
                 double t2, double* out);

// Weighted mean of what cold air lets through of what a segment of hot water takes.
struct WaterPoints {
  // Each point's end: an index into the fractions of the Lorenz curves, and the position on the way
  // to the next.
  const std::int32_t* place;
  const double* on;
  const double *inverse_weight, *air;
};
struct WaterTaken {
  double through, all;
};
//   points       kGasLanes k, at most kMostWaterPoints
//   low, high    Lorenz curves of two shapes; weight_high: how far the segment's is from low to
//   high left         as for lines
inline constexpr std::size_t kMostWaterPoints = 256;
[[nodiscard]] WaterTaken through_water(std::size_t points, const WaterPoints& point,
                                       const double* low, const double* high, double weight_high,
                                       double weak_depth, double* left);

// Sums over hot bands of carbon dioxide, kGasLanes wavenumbers at a time: bands (v, v3) to v3 + 1
// of levels below, each a P and an R branch of smeared-out lines.
struct HotLevels {
  static constexpr std::size_t kV = 20, kV3 = 10;
  double centre_cm1[kV][kV3];
  double filled[kV][kV3];  // (v3 + 1) states bend exp(-E / kT) / (centre (1 - exp(-c2 centre / T)))
};
struct HotBandSums {
  double weak[kGasLanes] = {}, strong[kGasLanes] = {};
};
// Adds the sums over hot bands at kGasLanes wavenumbers.
//   scale  of each wavenumber
void add_hot_bands(const HotLevels& levels, double temperature_k, const double* wavenumber_cm1,
                   const double* scale, HotBandSums& sums);
void exp_of(std::size_t n, const double* x, double* out);

}  // namespace irsig
