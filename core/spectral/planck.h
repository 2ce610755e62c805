#pragma once

namespace irsig {

// Largest arguments of all functions below; others fail a check. One exception is a radiance whose
// temperature is asked for: the radiance is the outcome of a calculation, and must not end a
// process that computes many of them. The temperature is then NaN.
inline constexpr double kPlanckLambdaMinUm = 1e-6;
inline constexpr double kPlanckLambdaMaxUm = 1e9;
inline constexpr double kPlanckTemperatureMaxK = 1e12;

// Returns the blackbody spectral radiance L_b(lambda, T) in vacuum. [W m^-2 sr^-1 um^-1]
//
//   L_b = c1L / (lambda^5 (exp(c2 / (lambda T)) - 1))      [cie_s_017, 17-24-005]
//
//   lambda_um      vacuum wavelength, > 0                  [um]
//   temperature_k  thermodynamic temperature, >= 0         [K]
//
// Accuracy, measured against 40-digit arithmetic for lambda_um in [0.4, 1000], temperature_k in
// [2.7, 5772] and results down to the smallest normal double (tests/physics/planck_test.cpp):
// largest relative error 4.6e-14, at the smallest results, where the exponent magnifies the
// rounding of c2 / (lambda T) by up to 740; 1e-15 elsewhere. Limits: 0 at temperature_k = 0, and
// wherever the result underflows.
[[nodiscard]] double planck_radiance_w_m2_sr_um(double lambda_um, double temperature_k);

// Returns d L_b / d T. [W m^-2 sr^-1 um^-1 K^-1]
// Accuracy and limits: as above, largest relative error 4.6e-14.
[[nodiscard]] double planck_radiance_derivative_w_m2_sr_um_k(double lambda_um,
                                                             double temperature_k);

// Returns the integral of L_b over [lambda_min_um, lambda_max_um], min <= max. [W m^-2 sr^-1]
//
// Accuracy: largest relative error 8e-14 against 60-digit arithmetic (3-5 um at 50 K, 3.5e-22, and
// bands as narrow as 8.5-9 um included); 4e-15 where the exponent is small. Panels of
// Gauss-Legendre quadrature in c2 / (lambda T) from the long-wave edge: no difference of two
// integrals, hence no cancellation in narrow bands. Limits: 0 at temperature_k = 0, for an empty
// band, and wherever the result underflows.
[[nodiscard]] double planck_band_radiance_w_m2_sr(double lambda_min_um, double lambda_max_um,
                                                  double temperature_k);

// Its derivative with respect to temperature.              [W m^-2 sr^-1 K^-1]
// Accuracy and limits: as above, largest relative error 7.8e-14.
[[nodiscard]] double planck_band_radiance_derivative_w_m2_sr_k(double lambda_min_um,
                                                               double lambda_max_um,
                                                               double temperature_k);

// Returns the temperature of the blackbody with the given band radiance; 0 for radiance 0. [K]
//
// NaN where there is none: a radiance that is negative, not finite, or above that of a blackbody at
// kPlanckTemperatureMaxK.
//
// Accuracy: largest relative error 6.7e-16 against 60-digit arithmetic, 7e-15 in round trips from 1
// to 1e9 K.
[[nodiscard]] double radiance_temperature_k(double lambda_min_um, double lambda_max_um,
                                            double radiance_w_m2_sr);

// Returns the temperature of the blackbody with the given spectral radiance; 0 for radiance 0. [K]
// NaN and accuracy: as above.
[[nodiscard]] double monochromatic_temperature_k(double lambda_um,
                                                 double spectral_radiance_w_m2_sr_um);

}  // namespace irsig
