#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace irsig {

// The catalogue of the numbers of a database row, which belongs to a viewpoint, a condition and a
// band. The core's result, the message, the stored row, its SQL and the lists of views are made
// from this catalogue. Whoever adds a quantity adds a line here, a field of the message
// (schema/result.proto) and a column (schema/sql/create.sql), and computes it.
//
//   VALUE(name, stderr_name, unit, what)   with a sampling error of its own
//   NUMBER(name, kind, unit, what)
//
// The order is that of tables. Names are those of columns, fields and members; "at the sensor" is
// behind the air between it and the target.

// Parts of the source intensity.
#define IRSIG_CAUSE_QUANTITIES(VALUE)                                                   \
  VALUE(emitted_w_sr, emitted_stderr_w_sr, "W/sr", "emitted by what the sensor sees")   \
  VALUE(sun_reflected_w_sr, sun_reflected_stderr_w_sr, "W/sr", "direct sun, reflected") \
  VALUE(sky_reflected_w_sr, sky_reflected_stderr_w_sr, "W/sr", "sky, reflected")        \
  VALUE(surface_reflected_w_sr, surface_reflected_stderr_w_sr, "W/sr",                  \
        "what lies below the horizon, reflected")                                       \
  VALUE(interreflected_w_sr, interreflected_stderr_w_sr, "W/sr",                        \
        "emitted by parts of the target, reflected by others")

#define IRSIG_SOURCE_QUANTITIES(VALUE, NUMBER)                                                  \
  VALUE(intensity_w_sr, intensity_stderr_w_sr, "W/sr", "in-band intensity at the target")       \
  NUMBER(numerical_error_w_sr, kError, "W/sr", "of intensity_w_sr: one sigma, bounds included") \
  VALUE(projected_area_m2, projected_area_stderr_m2, "m2", "of the silhouette")                 \
  NUMBER(                                                                                       \
      source_radiance_temperature_k, kDerived, "K",                                             \
      "of a blackbody with the same in-band source radiance over the projected area; 0: no area")

#define IRSIG_SENSOR_QUANTITIES(VALUE, NUMBER)                                         \
  VALUE(apparent_intensity_w_sr, apparent_intensity_stderr_w_sr, "W/sr",               \
        "in-band intensity at the sensor")                                             \
  NUMBER(apparent_numerical_error_w_sr, kError, "W/sr", "of apparent_intensity_w_sr")  \
  NUMBER(apparent_temperature_k, kDerived, "K",                                        \
         "of a blackbody with the same in-band radiance at the sensor; 0: no area")    \
  VALUE(contrast_intensity_w_sr, contrast_intensity_stderr_w_sr, "W/sr",               \
        "at the sensor: the target less what would be seen in its place")              \
  NUMBER(contrast_numerical_error_w_sr, kError, "W/sr", "of contrast_intensity_w_sr")  \
  VALUE(background_radiance_w_m2_sr, background_radiance_stderr_w_m2_sr, "W/(m2 sr)",  \
        "at the sensor, mean over the silhouette: what would be seen in its place")    \
  NUMBER(model_error_w_sr, kModelError, "W/sr",                                        \
         "of intensity_w_sr: one sigma of the models of sky and sea")                  \
  NUMBER(apparent_model_error_w_sr, kModelError, "W/sr",                               \
         "of apparent_intensity_w_sr: one sigma of the models of air, sky and sea")    \
  NUMBER(contrast_model_error_w_sr, kModelError, "W/sr",                               \
         "of contrast_intensity_w_sr: the same, glitter behind the target among them") \
  NUMBER(path_transmittance, kExact, "1", "in-band mean, of a grey source")            \
  NUMBER(path_radiance_w_m2_sr, kExact, "W/(m2 sr)", "in-band, of the air in front")

#define IRSIG_BOUND_QUANTITIES(NUMBER)                                                           \
  NUMBER(truncation_bound_w_sr, kBound, "W/sr", "of reflections after the last one allowed")     \
  NUMBER(quadrature_bound_w_sr, kBound, "W/sr",                                                  \
         "over wavelength; spectral_basis_bound_w_sr is contained in it")                        \
  NUMBER(undersampling_bound_w_sr, kBound, "W/sr",                                               \
         "of small places that may shine and that samples may have missed")                      \
  NUMBER(spectral_basis_bound_w_sr, kBound, "W/sr", "of spectra carried at a few nodes")         \
  NUMBER(direction_interpolation_bound_w_sr, kBound, "W/sr",                                     \
         "of sky and sea between the directions at which they are known")                        \
  NUMBER(omitted_bound_w_sr, kBound, "W/sr", "of effects left out: of intensity_w_sr")           \
  NUMBER(apparent_omitted_bound_w_sr, kBound, "W/sr", "the same of apparent_intensity_w_sr")     \
  NUMBER(contrast_omitted_bound_w_sr, kBound, "W/sr", "the same of contrast_intensity_w_sr")     \
  NUMBER(absolute_floor_w_sr, kGoal, "W/sr", "what accuracy.absolute_error_k is worth here")     \
  NUMBER(target_depth_bound_w_sr, kBound, "W/sr",                                                \
         "at the sensor: of one range for the target's whole depth")                             \
  NUMBER(undersampling_stderr_w_sr, kStderr, "W/sr",                                             \
         "estimate: what samples that met nothing brighter may have missed, of intensity_w_sr")  \
  NUMBER(apparent_undersampling_stderr_w_sr, kStderr, "W/sr",                                    \
         "the same of apparent_intensity_w_sr")                                                  \
  NUMBER(contrast_undersampling_stderr_w_sr, kStderr, "W/sr",                                    \
         "the same of contrast_intensity_w_sr")                                                  \
  NUMBER(background_bound_w_sr, kBound, "W/sr",                                                  \
         "of contrast_intensity_w_sr: of what is behind, between the directions at which it is " \
         "known")                                                                                \
  NUMBER(backface_fraction, kGuard, "1",                                                         \
         "of the silhouette: one-sided facets seen from behind, which send nothing")             \
  NUMBER(temperature_bound_w_sr, kBound, "W/sr",                                                 \
         "of intensity_w_sr: of temperatures that are not stated, but measured or computed")     \
  NUMBER(apparent_temperature_bound_w_sr, kBound, "W/sr",                                        \
         "the same of apparent_intensity_w_sr and of contrast_intensity_w_sr")

// Quantities of rows of conditions with hot gas; others have none. "Plume": emission of the gas
// less its absorption of the light behind it, which the totals above include.
#define IRSIG_PLUME_QUANTITIES(VALUE, NUMBER)                                                \
  VALUE(plume_w_sr, plume_stderr_w_sr, "W/sr", "hot gas, of intensity_w_sr")                 \
  VALUE(apparent_plume_w_sr, apparent_plume_stderr_w_sr, "W/sr",                             \
        "the same of apparent_intensity_w_sr")                                               \
  VALUE(contrast_plume_w_sr, contrast_plume_stderr_w_sr, "W/sr",                             \
        "the same of contrast_intensity_w_sr, less what is behind it beyond the target")     \
  NUMBER(plume_emitted_w_sr, kDerived, "W/sr", "sent by hot gas, at the target")             \
  NUMBER(apparent_plume_emitted_w_sr, kDerived, "W/sr", "the same at the sensor")            \
  NUMBER(plume_bound_w_sr, kBound, "W/sr",                                                   \
         "of intensity_w_sr: of steps along rays, and of spectra computed of a few columns") \
  NUMBER(apparent_plume_bound_w_sr, kBound, "W/sr", "the same of apparent_intensity_w_sr")   \
  NUMBER(contrast_plume_bound_w_sr, kBound, "W/sr", "the same of contrast_intensity_w_sr")   \
  NUMBER(plume_model_error_w_sr, kModelError, "W/sr",                                        \
         "one sigma of hot water behind the air's, part of apparent_model_error_w_sr")       \
  VALUE(plume_reflected_w_sr, plume_reflected_stderr_w_sr, "W/sr",                           \
        "of plume_w_sr: hot gas that the target reflects, less what gas takes of its light") \
  VALUE(apparent_plume_reflected_w_sr, apparent_plume_reflected_stderr_w_sr, "W/sr",         \
        "the same of apparent_plume_w_sr and contrast_plume_w_sr")                           \
  VALUE(plume_area_m2, plume_area_stderr_m2, "m2",                                           \
        "projected, where hot gas has plume.area_optical_depth in band")                     \
  NUMBER(plume_voxel_error_w_sr, kModelError, "W/sr",                                        \
         "one sigma of hot gas between its voxels, part of model_error_w_sr")

// Quantities of rows whose view measured the background around the target (core/clutter); others
// have none. All at the sensor, in-band.
#define IRSIG_CLUTTER_QUANTITIES(VALUE, NUMBER)                                                   \
  NUMBER(clutter_window_m, kExact, "m", "width of the measured background at the target's range") \
  NUMBER(clutter_pixel_m, kExact, "m", "side of its pixels")                                      \
  VALUE(clutter_mean_w_m2_sr, clutter_mean_stderr_w_m2_sr, "W/(m2 sr)",                           \
        "mean radiance of the background around the target")                                      \
  VALUE(clutter_sigma_w_m2_sr, clutter_sigma_stderr_w_m2_sr, "W/(m2 sr)",                         \
        "standard deviation of its pixels")                                                       \
  VALUE(clutter_skewness, clutter_skewness_stderr, "1", "skewness of its pixels")                 \
  VALUE(clutter_correlation_m, clutter_correlation_stderr_m, "m",                                 \
        "correlation length: sqrt(integral of the autocorrelation / pi)")                         \
  NUMBER(clutter_cells, kDerived, "1", "independent values in the window")                        \
  NUMBER(clutter_patch_m, kExact, "m", "side of squares of the target's projected area")          \
  VALUE(clutter_patch_sigma_w_m2_sr, clutter_patch_sigma_stderr_w_m2_sr, "W/(m2 sr)",             \
        "standard deviation of means over these squares: what a target is told from")             \
  NUMBER(clutter_modes_fraction, kDerived, "1",                                                   \
         "of the variance of these means: what the stored modes of their spectra carry")          \
  NUMBER(visible_fraction, kDerived, "1", "of the target's silhouette: not hidden by the land")

// Quantities of rows whose sweep states the uncertainty of its inputs, or asks for that of the
// model of heat; others have none.
#define IRSIG_INPUT_QUANTITIES(NUMBER)                                                           \
  NUMBER(input_uncertainty_w_sr, kInputSigma, "W/sr",                                            \
         "of intensity_w_sr: one sigma that uncertain inputs leave; no part of any error")       \
  NUMBER(apparent_input_uncertainty_w_sr, kInputSigma, "W/sr",                                   \
         "the same of apparent_intensity_w_sr")                                                  \
  NUMBER(contrast_input_uncertainty_w_sr, kInputSigma, "W/sr",                                   \
         "the same of contrast_intensity_w_sr")                                                  \
  NUMBER(heat_model_error_w_sr, kModelError, "W/sr",                                             \
         "of intensity_w_sr: one sigma of the model of computed temperatures, part of no other " \
         "error")                                                                                \
  NUMBER(apparent_heat_model_error_w_sr, kModelError, "W/sr",                                    \
         "the same of apparent_intensity_w_sr")                                                  \
  NUMBER(contrast_heat_model_error_w_sr, kModelError, "W/sr", "the same of contrast_intensity_w_sr")

#define IRSIG_COMPUTED_QUANTITIES(VALUE, NUMBER) \
  IRSIG_SOURCE_QUANTITIES(VALUE, NUMBER)         \
  IRSIG_CAUSE_QUANTITIES(VALUE)                  \
  IRSIG_SENSOR_QUANTITIES(VALUE, NUMBER)         \
  IRSIG_BOUND_QUANTITIES(NUMBER)

#define IRSIG_QUANTITIES(VALUE, NUMBER)    \
  IRSIG_COMPUTED_QUANTITIES(VALUE, NUMBER) \
  IRSIG_PLUME_QUANTITIES(VALUE, NUMBER)    \
  IRSIG_CLUTTER_QUANTITIES(VALUE, NUMBER)  \
  IRSIG_INPUT_QUANTITIES(NUMBER)

// Returns true if a key of [uncertainty] is of the model of heat and not of an input: what it
// leaves of a row is part of heat_model_error_w_sr instead of input_uncertainty_w_sr.
[[nodiscard]] constexpr bool is_of_heat_model(std::string_view input) {
  return input == "convection_relative" || input == "sky_emissivity_relative" ||
         input == "surface_moisture" || input == "stomatal_resistance_relative";
}

enum class QuantityKind : std::uint8_t {
  kSampled,     // a mean over paths
  kStderr,      // one sigma: of that mean, or of what no sample may have met
  kError,       // numerical error: standard error and bounds (measured.h)
  kModelError,  // one sigma of a model; never part of a numerical error
  kBound,       // the most by which a value can be off, for one reason
  kExact,       // without a sampling error
  kDerived,     // from other quantities of the row
  kGoal,        // an error that was asked for
  kGuard,       // what should be 0
  kInputSigma   // one sigma of uncertain inputs; never part of any error
};

struct QuantityInfo {
  std::string_view name;
  QuantityKind kind;
  std::string_view unit;
  std::string_view what;
};

#define IRSIG_VALUE_INFO(name, stderr_name, unit, what)    \
  QuantityInfo{#name, QuantityKind::kSampled, unit, what}, \
      QuantityInfo{#stderr_name, QuantityKind::kStderr, unit, what},
#define IRSIG_NUMBER_INFO(name, kind, unit, what) \
  QuantityInfo{#name, QuantityKind::kind, unit, what},
inline constexpr auto kQuantities =
    std::to_array<QuantityInfo>({IRSIG_QUANTITIES(IRSIG_VALUE_INFO, IRSIG_NUMBER_INFO)});
#undef IRSIG_VALUE_INFO
#undef IRSIG_NUMBER_INFO

}  // namespace irsig
