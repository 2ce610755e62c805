#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace irsig {

// The loops over bands in which the air's time goes, for the widest vectors of the processor. The
// same bits whatever their width. Arrays are per band and of one range of neighbouring bands, `n`
// long, unless said otherwise. Private to core/atmosphere.

// depth += k exp(a (ln p - ln p0)) (1 + b x + c x^2) density x length
struct ContinuumBands {
  const double *ln_pressure_pa, *temperature_k, *a, *b, *c, *k;
};
void add_to_continuum(std::size_t n, const ContinuumBands& of, double ln_pressure,
                      double temperature_k, double density, double length_m, double* depth);

// Computes exp(-(sum of the depths)).
void grey_transmittance(std::size_t n, std::span<const double* const> depth, double* t);

// Computes Planck's function; scale: c1L / lambda^5.
void planck_bands(std::size_t n, const double* lambda_um, const double* scale, double temperature_k,
                  double* out);

// Interpolates some quantities of two levels: a (b / a)^fraction, or linearly where one of the two
// is 0.
inline constexpr std::size_t kLevelQuantities = 8;
using LevelQuantities = std::array<double, kLevelQuantities>;
[[nodiscard]] LevelQuantities between_levels(const LevelQuantities& a, const LevelQuantities& b,
                                             double fraction);

// Computes exp of the value at a fraction of the way from one curve to the next.
void blended_exp(std::size_t n, const double* from, const double* to, double fraction, double* out);

// Depths of a step for add_emission_bands(), which adds what add_emission
// (core/atmosphere/path_sums.h) adds.
struct StepBands {
  const double *aerosol_depth, *molecular_depth, *grey_depth;
};
void add_emission_bands(std::size_t n, const StepBands& step, const double* t_near,
                        const double* t_far, const double* planck_near, const double* planck_far,
                        double* out);
// Computes mean_of_decay (core/atmosphere/path_layers.h) of all bands.
void mean_of_decay_bands(std::size_t n, const double* a, const double* b, const double* grey_depth,
                         double* out);

}  // namespace irsig
