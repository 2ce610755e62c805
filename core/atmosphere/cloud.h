#pragma once

#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "core/atmosphere/absorber_amounts.h"
#include "core/atmosphere/air_profile.h"

namespace irsig {

enum class CloudPhase { kWater, kIce };

// A horizontally homogeneous layer of cloud with the same amount of water at all of its heights.
struct CloudSpec {
  CloudPhase phase = CloudPhase::kWater;
  double base_m = 0, top_m = 0;    // above the surface
  double water_path_kg_m2 = 0;     // of liquid water or ice, vertical
  double effective_radius_um = 0;  // 3 volume / (4 projected area)
  // Temperature at the base, where it is not the profile's: all of the layer is shifted by the
  // difference.  [K]
  std::optional<double> base_k = std::nullopt;
};

// Limits of CloudSpec.
inline constexpr double kHighestCloudM = 25e3;
inline constexpr double kThinnestCloudM = 1;
inline constexpr double kLargestWaterPathKgM2 = 1000;
inline constexpr double kColdestBaseK = 120, kWarmestBaseK = 350;
inline constexpr double kSmallestDropUm = 1.5, kLargestDropUm = 50;
inline constexpr double kSmallestCrystalUm = 6.4, kLargestCrystalUm = 153.3;

// Returns INVALID_ARGUMENT for a cloud outside the limits.
[[nodiscard]] absl::Status check_cloud(const CloudSpec& spec);

// How a cloud's forward peak is treated.
//   kBeam     scattered light is lost to the beam: for the sun's disk and for what is seen sharply
//   kDiffuse  the forward peak, asymmetry^2 of what is scattered, stays in the beam (delta scaling
//             [joseph1976]): for light of the sky, of which a peak is a part
enum class ForwardPeak { kBeam, kDiffuse };

// Optical depths of the whole layer straight up, on the air's bands.
struct CloudOptics {
  AirSpectrum absorption, scattering;
  AirSpectrum asymmetry;  // mean cosine of the scattering angle
};
// Mass coefficients are interpolated in the logarithm of the effective radius.
// Source: Met Office SOCRATES, droplets by Mie's theory and aggregates of ice crystals.
[[nodiscard]] CloudOptics cloud_optics(const CloudSpec& spec, ForwardPeak peak);

// Returns the profile with levels at the cloud's boundaries and inside it, where the air is
// saturated: over water, or over ice. The layer is as warm as the profile, unless its base's
// temperature is stated; the air within a metre of its boundaries keeps its own.
[[nodiscard]] AirProfile with_cloud(const AirProfile& profile, const CloudSpec& spec);

// Returns the heights of the levels that with_cloud() adds inside and at the boundaries, as the
// profile counts heights, increasing.  [m]
[[nodiscard]] std::vector<double> cloud_levels_m(const AirProfile& profile, const CloudSpec& spec);

}  // namespace irsig
