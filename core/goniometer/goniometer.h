#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/accuracy/replicates.h"
#include "core/materials/material_spec.h"
#include "core/scene/trace/target.h"
#include "core/spectral/band.h"

namespace irsig {

// A band of the instrument; `spectral`: the BRDF at each of the band's wavelengths (means over bins
// of step_um) instead of one mean weighted with the response.
struct GoniometerBand {
  Band band;
  bool spectral = false;
};

// The sample under the goniometer: heights are -z of the body frame, the plate is horizontal.
struct GoniometerScene {
  Mesh mesh;
  std::vector<PartSpec> part;
  std::vector<MaterialSpec> material;
  // Materials that may create energy, by index; others that do are refused. Empty: none may.
  std::vector<bool> allow_energy_gain;
  std::vector<GoniometerBand> band;
  TracerIsa isa = widest_isa();
};

enum class FieldOfView {
  kOnPlate,     // field_width x field_height of the reference plane, at every view zenith
  kAcrossView,  // ... across the line of sight: the field on the plate grows as 1 / cos(zenith)
};

// Zeniths are from the plate's normal; azimuths from the source's: 0 backscatter, 180 mirror side.
// The source's azimuth is the body's x axis.
struct GoniometerSpec {
  std::vector<double> view_zenith_deg, view_azimuth_deg, source_zenith_deg;
  double source_distance_m = 0;  // of the lamp from the middle of the field; 0: at infinity
  double source_angular_radius_deg = 0;
  double sensor_range_m = 0;  // 0: far field
  FieldOfView field = FieldOfView::kOnPlate;
  double field_width_m = 0, field_height_m = 0;
  double reference_height_m = 0;  // of the reference plane
  std::uint64_t samples_per_replicate = 0;
  std::uint32_t replicates = 32;
  std::uint32_t max_reflections = 16;
  std::uint64_t seed = 0;
  std::uint32_t threads = 1;
};

// One column of results: a band, or one wavelength of a band.
struct GoniometerChannel {
  std::string band;
  double lambda_um = 0;  // spectral: the bin's middle, else the mean weighted with the response
  bool spectral = false;
};

// BRDF: mean radiance reflected into the field of view / irradiance of the reference plane at the
// middle of the field. [1/sr] Directional emissivity twice over: emitted by all parts at one
// temperature in a cold world, and 1 - DHR, which by reciprocity is the part of a uniform sky's
// radiance that the field of view shows. Both are measured with the same primary rays;
// their sum with the DHR is 1 but for noise and truncation.
struct GoniometerResult {
  GoniometerSpec spec;
  std::vector<GoniometerChannel> channel;
  std::vector<Estimate> brdf_per_sr;  // [channel][source][view zenith][view azimuth]
  std::vector<Estimate> emissivity, dhr, emissivity_plus_dhr;  // [channel][zenith][azimuth]

  // The largest of all views and channels.
  // Of an isothermal world's radiance: what arrives after exactly max_reflections reflections. What
  // more of them would add is about as much or less.
  double last_reflection = 0;
  double leaked = 0;        // of the reflected light: past the border of the plate and down
  double missed_field = 0;  // of the field of view: rays that met nothing
  // Distance of the nearest border of the mesh from the fields of view, and the distance at which
  // neither a shadow nor a grain between sensor and field can be missing there: height x
  // tan(largest zenith).
  double border_m = 0, wanted_border_m = 0;
  bool creates_energy = false;          // some material does
  std::uint64_t rays = 0, guarded = 0;  // guarded: back faces met, numbers that were not finite

  [[nodiscard]] std::size_t views() const {
    return spec.view_zenith_deg.size() * spec.view_azimuth_deg.size();
  }
  [[nodiscard]] std::size_t view(std::size_t zenith, std::size_t azimuth) const {
    return zenith * spec.view_azimuth_deg.size() + azimuth;
  }
  [[nodiscard]] const Estimate& brdf(std::size_t ch, std::size_t source, std::size_t zenith,
                                     std::size_t azimuth) const {
    return brdf_per_sr[(ch * spec.source_zenith_deg.size() + source) * views() +
                       view(zenith, azimuth)];
  }
};

// Traces all views on `threads` threads; the same bits for any number of them. A view at zenith 0
// has no azimuth: it is traced once. INVALID_ARGUMENT: angles out of range (zeniths [0, 89.9]), a
// field of view that reaches beyond the mesh, materials that do not cover the bands.
[[nodiscard]] absl::StatusOr<GoniometerResult> run_goniometer(const GoniometerScene& scene,
                                                              const GoniometerSpec& spec);

}  // namespace irsig
