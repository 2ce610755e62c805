#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/atmosphere/atmosphere.h"
#include "core/atmosphere/step_scattering.h"

namespace irsig {

class CloudLight;
class CloudSunlight;
class HazeLight;
class HazeSunlight;
struct HazeSunSource;

// Returns the mean of a quantity that decays exponentially from a to b.
[[nodiscard]] double logarithmic_mean(double a, double b);
// Like logarithmic_mean(), over a stretch of at least grey_depth; b = 0: the decay exceeds the
// range of a double.
[[nodiscard]] double mean_of_decay(double a, double b, double grey_depth);
// Like mean_of_decay(), of sunlight, of which a and b may also be 0 in the Earth's shadow.
[[nodiscard]] double mean_of_sunlight(double a, double b, double grey_depth);
// Like mean_of_sunlight(a, b, grey_depth), for many bands at once.
void mean_of_sunlight(AirSpectrum& out, const AirSpectrum& a, const AirSpectrum& b,
                      const AirSpectrum& grey_depth, const BandChoice& bands);

// Amounts of the sun's path to any height of one vertical, for one zenith angle: computed at a few
// heights and interpolated as if all gases thinned out over the same height. The zenith angle is
// taken to be the same all along a path that is lit, so that a path over 100 km errs by 1 deg of
// sun.
class SunAmounts {
 public:
  // Computes the amounts from `height_m`, and from cloud or fog below it, to the top of the air.
  SunAmounts(const Atmosphere& atmosphere, double height_m, double zenith_deg,
             const BandChoice& bands = BandChoice());

  // Adds what lies between a height and the sun; false: the Earth is in the way.
  [[nodiscard]] bool add_to(AbsorberAmounts& sum, double height_m) const;
  // Returns true if the sun shines on `height_m`; on any air above.
  [[nodiscard]] bool lit() const { return lit_; }
  [[nodiscard]] bool lights_any() const { return !point_.empty() && point_.back().lit; }

 private:
  struct Point {
    double height_m;
    bool lit;
    AbsorberAmounts amounts;
  };
  // Returns the lowest point that the sun lights between two heights, to 1 m.
  [[nodiscard]] Point edge_of_shadow(const Atmosphere& atmosphere, double dark_m, double lit_m,
                                     double zenith_deg) const;

  BandChoice bands_;
  double turbid_base_m_ = 0, turbid_top_m_ = 0;  // equal in clear air
  bool lit_ = false;
  std::vector<Point> point_;
};

// Above, air is hot (380 K at 120 km) and too thin to matter: model errors leave it out.
inline constexpr double kThermosphereM = 90e3;

// Tables of aerosol models describe a given day's particles, and what they scatter, to perhaps a
// third (docs/evidence/validation.md, "Atmosphere").
inline constexpr double kAerosolRelativeError = 0.3;

// One sigma of a path's optical depth by the gas table, as a fraction of the depth: of lines below
// and above 3000 cm-1 (where ten bands share one entry of the source), of the band between, which
// is empty in the finer source, and of continua. The maximum-likelihood values for MODTRAN's paths,
// confirmed with each path left out in turn: tests/physics/atmosphere_model_error_test.cpp.
inline constexpr double kLineDepthError = 0.125;
inline constexpr double kCoarseLineDepthError = 0.38;
inline constexpr double kEmptyBandDepthError = 0.75;
inline constexpr double kEmptyBandCm1 = 2995;
inline constexpr double kContinuumDepthError = 0.0165;
// Error floor of the transmittance of a dark path.
inline constexpr double kDarkError = 1e-5;
// Relative error of the air's emission, 0.03 K: rms of the bands of the same paths that have no
// transmittance.
inline constexpr double kEmissionError = 0.0015;

// Fraction of the error of thermal light scattered more than once that is left where haze's light
// is computed as often as it is scattered (core/atmosphere/haze_light.h).
inline constexpr double kHazeThermalError = 0.15;

// One sigma of the model (docs/explanation/methods/atmosphere.md), not of the numerics, for all
// absorbers in a path. The errors of the depth's parts are added in squares; each is half the
// change of the transmittance from one sigma above to one below.
//   scattered     sunlight and surroundings in the path's radiance
//   surroundings  their mean radiance, if it has a part in it: light that is scattered more than
//                  once lies between it and the air's own, so that the error is their difference
//   haze           haze_fraction() of light that is scattered more than once
struct ModelError {
  AirSpectrum transmittance, radiance_w_m2_sr_um;
};
[[nodiscard]] ModelError model_error(const AbsorberAmounts& amounts,
                                     const AirSpectrum& transmittance, const AirSpectrum& scattered,
                                     double warmest_k, const BandChoice& bands = {},
                                     const AirSpectrum* surroundings = nullptr, double haze = 0);

// Phase functions averaged over directions of sight: Henyey and Greenstein's for the aerosol,
// Rayleigh's for molecules. Their integral over all directions is 1.
class PhaseMean {
 public:
  // Adds a scattering angle with a weight.
  //   cosine  of the angle between the direction of sight, away from the observer, and the sun
  void add(double weight, double cosine);

  [[nodiscard]] double aerosol_per_sr(double asymmetry) const;
  [[nodiscard]] double molecular_per_sr() const { return molecular_ / weight_; }
  // Returns the mean of a power of the cosine, up to the third.
  [[nodiscard]] double cosine_power(std::size_t exponent) const {
    return cosine_power_[exponent] / weight_;
  }

 private:
  // Phase functions at equal steps of -ln(1 - asymmetry), to 0.97: in the forward direction the
  // phase function's logarithm is linear in it.
  static constexpr std::size_t kPoints = 36;
  static constexpr double kStep = 0.1;
  std::array<double, kPoints> aerosol_{};
  double molecular_ = 0, weight_ = 0;
  std::array<double, 4> cosine_power_{};
};

// Asymmetry of the forward peak around the sun, wider than a cloud's particles make it: as narrow
// as nodes of the sky can hold it.
inline constexpr double kPeakAsymmetry = 0.85;

// Light scattered once, without the phase function's dependence on angle, per unit of irradiance
// outside the air: aerosol with its mean asymmetry, molecules.
struct ScatteredSun {
  AirSpectrum aerosol = AirSpectrum(kAirBandCount, 0.0);
  AirSpectrum asymmetry = AirSpectrum(kAirBandCount, 0.0);
  AirSpectrum molecular = AirSpectrum(kAirBandCount, 0.0);
  // Light of cloud and fog, empty without them: scattered once, with its asymmetry; scattered more
  // often, the same in all directions, per sr; and the forward peak around the sun
  // (kPeakAsymmetry), which fog without a cloud has in the light scattered once.
  AirSpectrum cloud, cloud_asymmetry, diffuse_per_sr, peak;
  // Light that haze scatters more than once, empty without it: the peak around the sun with its
  // asymmetry; the rest, per sr, by powers of the scattering angle's cosine; and its mean over
  // azimuths.
  AirSpectrum haze, haze_asymmetry, haze_mean_per_sr;
  std::array<AirSpectrum, 4> haze_per_sr;

  [[nodiscard]] AirSpectrum per_sr(const PhaseMean& phase) const;
  [[nodiscard]] double per_sr(std::size_t band, double cosine) const;
};

// A path taken apart once, so that it can be seen through any near air and under any sun for the
// price of one transmittance a layer (core/atmosphere/atmosphere.h prices it at two a step).
//
// As a whole it is summed over all its steps, whose sums by layers (at most 12) are kept. Near air
// weakens what a layer emits by the ratio of what it absorbs of light from behind it, and what it
// scatters by the ratio of the mean transmittances. Against Atmosphere::radiance of the same path,
// near air and sun: tests/physics/environment_nodes_test.cpp.
class PathLayers {
 public:
  //   cloud  light that cloud and fog scatter; null: the atmosphere has neither
  //   haze   light that haze scatters more than once; null: aerosol scatters the surroundings
  PathLayers(const Atmosphere& atmosphere, const LightPath& path, const BandChoice& bands,
             const CloudLight* cloud = nullptr, const HazeLight* haze = nullptr);

  // L = T L_behind + thermal + share of surroundings x their mean radiance, at the observer. The
  // thermal light is that which the air emits, and which cloud, fog and haze scatter.
  AirSpectrum transmittance, thermal_w_m2_sr_um, surroundings_fraction;
  [[nodiscard]] AbsorberAmounts amounts() const { return node_.back().amounts.unpacked(bands_); }
  // Returns true for a ray that misses the air or has no length.
  [[nodiscard]] bool empty() const { return layer_.empty(); }
  [[nodiscard]] double warmest_k() const { return warmest_k_; }
  // Returns the least height of the ends of its layers.
  [[nodiscard]] double lowest_m() const;

  // A layer of air that a path crosses upwards, or begins in.
  struct Crossing {
    AirSpectrum transmittance;   // of the air in front of the layer
    AirSpectrum inside, beyond;  // thermal radiance from there, at the observer
    double cosine;               // of the zenith angle where the path enters the layer
    double begins_m;             // height there
  };
  // Finds where the path crosses a layer between two heights, which are ends of the path's steps.
  // nullopt: the path falls, or ends below the layer.
  [[nodiscard]] std::optional<Crossing> crossing(double base_m, double top_m) const;

  // The path's emission as seen through near air.
  struct Emission {
    AirSpectrum thermal_w_m2_sr_um, surroundings_fraction;
  };
  struct Behind : Emission {
    AirSpectrum transmittance;  // of near air and path together
  };
  // Computes the path's light behind near air.
  //   through_near  transmittance of the near air
  [[nodiscard]] Behind behind(const AbsorberAmounts& near, const AirSpectrum& through_near) const;

  // Computes the sunlight that the path scatters to the observer, behind near air if any.
  //   cloud  mean radiance of sunlight in the cloud
  //   haze   sunlight that haze scatters more than once; null: none
  [[nodiscard]] ScatteredSun scattered(const SunAmounts& sun, const AbsorberAmounts* near = nullptr,
                                       const CloudSunlight* cloud = nullptr,
                                       const HazeSunlight* haze = nullptr) const;

 private:
  struct Node {
    double height_m;
    double cos_zenith;                  // of the ray, away from the observer
    PackedAmounts amounts;              // from the observer
    std::vector<double> transmittance;  // [band that is wanted]
  };
  // A layer scatters this, and emits this if no near air is in front of it.
  struct Layer {
    StepScattering scattering;
    Emission emission;
    AirSpectrum haze;  // thermal light that haze scatters; empty without it
  };
  // Adds what haze scatters in a step, and takes it from the surroundings' fraction.
  void add_haze(Layer& layer, const HazeLight& haze, const StepScattering& step,
                const AirSpectrum& t_near, const AirSpectrum& t_far, const AirSpectrum& source_near,
                const AirSpectrum& source_far) const;
  // Adds the sunlight of a layer that haze scatters more than once.
  void add_haze(ScatteredSun& out, const HazeSunlight& haze, const StepScattering& step,
                const AirSpectrum& seen_near, const AirSpectrum& seen_far,
                const HazeSunSource& near, const HazeSunSource& far) const;
  [[nodiscard]] AirSpectrum transmittance_to(std::size_t node) const;
  void get(std::size_t layer, Layer& out) const;
  [[nodiscard]] Layer empty_layer() const;

  BandChoice bands_;
  bool cloudy_ = false;      // layers have the spectra of cloud or fog
  bool hazy_ = false;        // layers have the spectrum of haze
  bool keeps_peak_ = false;  // in the light scattered once: core/atmosphere/forward_scattering.h
  ForwardPeak peak_ = ForwardPeak::kBeam;
  std::vector<Node> node_;
  std::vector<std::vector<double>> layer_;  // Layer's spectra one after the other, as Node has them
  double warmest_k_ = 0;
};

}  // namespace irsig
