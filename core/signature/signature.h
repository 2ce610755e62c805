#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/accuracy/replicates.h"
#include "core/effects/effect_set.h"
#include "core/effects/plan.h"
#include "core/environment/air.h"
#include "core/environment/environment.h"
#include "core/environment/surroundings.h"
#include "core/geo/viewpoint.h"
#include "core/materials/material.h"
#include "core/scene/target.h"
#include "core/spectral/band.h"
#include "core/transport/spectral_basis.h"

namespace irsig {

// Version of the numbers that the core makes: raised whenever a result changes in any bit for the
// same request.
inline constexpr int kPhysicsVersion = 4;

// What does not change during a sweep.
struct SceneSpec {
  Mesh mesh;
  std::vector<PartSpec> part;
  std::vector<MaterialSpec> material;
  std::vector<Band> band;
  // Where the air's spectrum jumps (air_band_edges_um); empty: nowhere.
  std::vector<double> spectral_breaks_um;
  TracerIsa isa = widest_isa();
  TracerOptions tracer;
};

// One season at one time.
struct ConditionSpec {
  std::vector<double> part_temperature_k;  // in the order of SceneSpec::part
  Surroundings surroundings;
  bool sun = false;         // whether direct sun is part of this condition
  Vec<Body> sun_direction;  // unit vector towards the sun
  double sun_cos_zenith = 0;
  double sun_angular_radius_deg = 0;
  double sun_scale = 0;     // irradiance at the target = sun_scale x E490 (1 AU, in vacuum)
  double sea_wind_m_s = 0;  // > 0: the sea mirrors the sun, as rough as this wind makes it
  double air_temperature_k = 0;
};

struct AccuracySpec {
  // Exactly one is positive.
  double relative_error = 0;  // of the in-band intensity of every row of the sweep
  // With it: an error of projected area x dL/dT x this, at the temperature around the target, is
  // small enough. 0: none.
  double absolute_error_k = 0;
  double target_paths = 0;  // primary rays that meet the target, all replicates
  std::uint64_t samples_per_replicate = 0;
  std::uint32_t replicates = 32;
  std::uint64_t max_samples_per_replicate = 1u << 22;
};

// One viewpoint. All conditions and bands of the sweep are stated, because the pilot that fixes the
// number of samples looks at all of them; only the selected rows are computed, and their bits do
// not depend on the selection.
struct ViewRequest {
  Viewpoint viewpoint;
  std::vector<ConditionSpec> condition;
  Air air;
  // The embedded atmosphere, for the same conditions in the same order: takes the place of `air`
  // and of the conditions' surroundings but for their kind, and of sun_scale. Null: none.
  std::shared_ptr<const Environment> environment;
  std::vector<std::uint32_t> selected_condition, selected_band;
  AccuracySpec accuracy;
  EffectChoice effects;
  std::uint32_t max_reflections = 3;
  std::uint64_t seed = 1;
  std::uint32_t thumbnail_px = 0;
};

// Spectra on the band's stored wavelengths; [W/(sr um)].
struct SpectralEstimate {
  std::vector<double> value, stderr_;
};

enum class Cause { kEmitted, kSunReflected, kSkyReflected, kSeaReflected, kPartsReflected };
inline constexpr std::size_t kCauses = 5;

enum class StopReason { kTargetReached, kTargetMissed, kSampleLimit, kFixedSamples };

// Where light that the sensor would send out ends, in-band mean: by reciprocity the shares of what
// it sees. balance: their sum, 1 within its error. cut_off: after the last reflection; of spectral
// materials at least that.
struct EnergyLedger {
  Estimate absorbed, escaped_to_sky, escaped_to_lower, cut_off, balance;
};

struct SignatureResult {
  std::uint32_t condition = 0, band = 0;
  Estimate intensity_w_sr;  // source: no air
  // Bias bounds; all are part of the numerical error. quadrature: over wavelength, basis_bound
  // included. unseen: rare bright events (sunlight on facets with narrow lobes, hot parts) that
  // were met too seldom to show in the standard error.
  double truncation_bound_w_sr = 0, quadrature_bound_w_sr = 0, unseen_bound_w_sr = 0;
  double basis_bound_w_sr = 0;  // of the nodes between those that paths carry
  double sky_bound_w_sr = 0;    // of sky and sea between the directions at which they are known
  // Of effects that were left out, reflections after fewer than the request allows included.
  double omitted_bound_w_sr = 0, apparent_omitted_bound_w_sr = 0, contrast_omitted_bound_w_sr = 0;
  double numerical_error_w_sr = 0;
  Estimate apparent_intensity_w_sr;
  double apparent_numerical_error_w_sr = 0;
  // At the aperture: the target less what would be seen in its place, ray by ray.
  Estimate contrast_intensity_w_sr;
  double contrast_numerical_error_w_sr = 0;
  // At the aperture, mean over the silhouette: what would be seen in the target's place.
  Estimate background_radiance_w_m2_sr;
  // One sigma of the models of air, sky and sea. Never part of the numerical error.
  double model_error_w_sr = 0, apparent_model_error_w_sr = 0;
  double path_transmittance = 1;     // in-band mean, of a grey source
  double path_radiance_w_m2_sr = 0;  // in-band
  Estimate projected_area_m2;
  // Of intensity / projected area; NaN if no blackbody has that radiance (core/spectral/band.h).
  double apparent_temperature_k = 0;
  Estimate cause_w_sr[kCauses];
  std::vector<Estimate> part_w_sr;  // by the part that the sensor sees
  SpectralEstimate spectral, spectral_cause[kCauses], apparent_spectral, contrast_spectral,
      background_spectral;  // the last: radiance
  // Between target and sensor, on the stored wavelengths: no sampling error.
  std::vector<double> path_transmittance_spectral, path_radiance_spectral;
  std::vector<float> image_w_m2_sr;  // row by row from the top; empty: none
  StopReason stop_reason = StopReason::kFixedSamples;
  double absolute_floor_w_sr = 0;  // what AccuracySpec::absolute_error_k is worth
  std::uint32_t reflections = 0;   // the most that paths were given
  EnergyLedger energy;
  std::vector<LedgerEntry> effect;  // [kEffects], in the table's order
  // Of each replicate: for differences between runs that share their paths. [W/sr]
  std::vector<double> replicate_w_sr, replicate_apparent_w_sr, replicate_contrast_w_sr;
};

struct PreparedView;

// What is fixed before a view is measured: by pilots over every row of the sweep.
struct ViewPlan {
  std::uint64_t samples_per_replicate = 0;
  bool limited = false;  // more would have been needed than the request allows
  std::uint64_t pilot_rays = 0;
  EffectSet effects;
  // All that follows: [condition x band of the simulator].
  std::vector<double> absolute_floor_w_m2_sr;    // what AccuracySpec::absolute_error_k is worth
  std::vector<RowBounds::Bound> omitted;         // reflections after max_reflections are not in it
  std::vector<std::vector<LedgerEntry>> ledger;  // [..][kEffects]
  // What the pilots saw, all conditions; null: measure() makes it.
  std::shared_ptr<const PreparedView> prepared;
};

struct ViewResult {
  std::vector<SignatureResult> row;  // selected conditions x selected bands
  std::uint32_t image_width_px = 0, image_height_px = 0;
  double pixel_rad = 0;
  std::uint64_t samples = 0, target_paths = 0, rays = 0;
  std::uint32_t replicates = 0;
  std::uint64_t samples_per_replicate = 0;
  // Guarded events: numbers that should not occur, left out of the result. Not so
  // guarded_path_limit, whose name is that of the stored column: ordinary paths that were still
  // alive after the last reflection.
  std::uint64_t guarded_backface_hits = 0, guarded_nonfinite = 0, guarded_negative = 0;
  std::uint64_t guarded_path_limit = 0;
  std::uint64_t seed =
      0;  // of the job, as derived from geometry, materials, viewpoint and the user's seed
};

// A scene ready for any number of viewpoints. Immutable: simulate() may run on several threads.
class Simulator {
 public:
  static absl::StatusOr<std::unique_ptr<Simulator>> create(const SceneSpec& spec);

  // plan() and measure().
  [[nodiscard]] absl::StatusOr<ViewResult> simulate(const ViewRequest& request) const;
  // The same request with another plan's number of samples has the same paths as far as both follow
  // them.
  [[nodiscard]] absl::StatusOr<ViewPlan> plan(const ViewRequest& request) const;
  [[nodiscard]] absl::StatusOr<ViewResult> measure(const ViewRequest& request,
                                                   const ViewPlan& plan) const;

  [[nodiscard]] const Target& target() const { return target_; }
  // Prepared at every node of the bands, one band after the other.
  [[nodiscard]] const std::vector<Material>& materials() const { return material_; }
  // Prepared at the nodes that paths carry: all of basis().carried.
  [[nodiscard]] const std::vector<Material>& carried_materials() const {
    return basis_.identity() ? material_ : carried_;
  }
  [[nodiscard]] const SpectralBasis& basis() const { return basis_; }
  [[nodiscard]] const std::vector<Band>& bands() const { return band_; }
  [[nodiscard]] const std::vector<BandGrid>& band_grids() const { return grid_; }
  // Some part's material creates energy.
  [[nodiscard]] bool energy_gain() const { return energy_gain_; }
  // Of geometry, materials and strata: what the seeds of random numbers are made from.
  [[nodiscard]] std::uint64_t scene_hash() const { return scene_hash_; }

 private:
  Simulator() = default;
  Target target_;
  std::vector<Band> band_;
  std::vector<BandGrid> grid_;
  std::vector<double> node_um_;           // the nodes of all bands, one after the other
  std::vector<std::size_t> band_offset_;  // where each band's nodes begin
  std::vector<Material> material_, carried_;
  SpectralBasis basis_;
  bool energy_gain_ = false;
  std::uint64_t scene_hash_ = 0;  // of geometry, materials, strata
};

}  // namespace irsig
