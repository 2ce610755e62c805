#include "core/signature/measure_view.h"

#include <algorithm>
#include <cmath>

#include "core/base/status_macros.h"
#include "core/signature/land_clutter.h"
#include "core/signature/light_component.h"
#include "core/signature/make_plan.h"
#include "core/signature/measured_view.h"
#include "core/signature/row_pictures.h"
#include "core/signature/sea_clutter.h"
#include "core/signature/view/view_pictures.h"
#include "core/signature/view_seed.h"

namespace irsig {
namespace {

// Adds the stored values of the air between target and sensor, and the models' errors.
void add_path(const Row& row, SignatureResult& r) {
  const ViewEnvironment& e = row.light->environment();
  const BandGrid& grid = row.on_axis.grid;
  const std::size_t offset = row.on_axis.first_node;
  double width_um = 0, sky = 0, sky_model = 0;
  r.path_transmittance = r.path_radiance_w_m2_sr = 0;
  for (std::size_t i = 0; i < grid.node_um.size(); ++i) {
    width_um += grid.band_weight[i];
    r.path_transmittance += grid.band_weight[i] * e.transmittance[offset + i];
    r.path_radiance_w_m2_sr += grid.band_weight[i] * e.path_radiance[offset + i];
    if (e.sky_mean.empty()) continue;
    sky += grid.band_weight[i] * e.sky_mean[offset + i];
    sky_model += grid.band_weight[i] * e.sky_model_error[offset + i];
  }
  r.path_transmittance /= width_um;
  // Surface emission is multiplied by the mean transmittance, whose error is taken bin by bin; the
  // errors of one model go the same way everywhere, and add up.
  double emission_lost_w_sr = 0, path_w_sr = 0, difference_lost_w_sr = 0;
  for (std::size_t k = 0; k < grid.lambda_um.size(); ++k) {
    double transmittance = 0, radiance = 0;
    for (std::size_t i = grid.bin_first[k]; i < grid.bin_first[k + 1]; ++i) {
      transmittance += grid.bin_weight[i] * e.transmittance[offset + i];
      radiance += grid.bin_weight[i] * e.path_radiance[offset + i];
      if (e.model_error_transmittance.empty()) continue;
      emission_lost_w_sr +=
          grid.band_weight[i] * r.spectral.value[k] * e.model_error_transmittance[offset + i];
      path_w_sr +=
          grid.band_weight[i] * r.projected_area_m2.value * e.model_error_path_radiance[offset + i];
    }
    // Path radiance is common to the target and what stands behind it; what either sends through
    // the air is not. Where next to nothing comes through, nothing of it is known.
    constexpr double kOpaque = 1e-6;
    const double background_w_sr_um =
        transmittance > kOpaque
            ? r.projected_area_m2.value * std::max(0.0, r.background_spectral.value[k] - radiance) /
                  transmittance
            : 0;
    for (std::size_t i = grid.bin_first[k]; i < grid.bin_first[k + 1]; ++i) {
      if (e.model_error_transmittance.empty()) continue;
      difference_lost_w_sr += grid.band_weight[i] * (r.spectral.value[k] - background_w_sr_um) *
                              e.model_error_transmittance[offset + i];
    }
    r.path_transmittance_spectral.push_back(transmittance);
    r.path_radiance_spectral.push_back(radiance);
  }
  const auto cause = [&](Cause which) {
    return r.cause_w_sr[static_cast<std::size_t>(which)].value;
  };
  const double sky_relative = sky > 0 ? sky_model / sky : 0;
  r.model_error_w_sr = std::hypot(sky_relative * cause(Cause::kSkyReflected),
                                  e.lower_model_relative * cause(Cause::kSeaReflected),
                                  e.sun_model_relative * cause(Cause::kSunReflected));
  const double seen = r.intensity_w_sr.value != 0
                          ? std::abs(r.apparent_intensity_w_sr.value / r.intensity_w_sr.value)
                          : 0;
  r.apparent_model_error_w_sr =
      std::hypot(std::min(seen, 1.0) * r.model_error_w_sr, emission_lost_w_sr - path_w_sr);
  r.contrast_model_error_w_sr = std::hypot(std::min(seen, 1.0) * r.model_error_w_sr,
                                           difference_lost_w_sr, row.background_model_w_sr);
  const ThreeBounds& choice = row.choice_of_sky;
  r.model_error_w_sr = std::hypot(r.model_error_w_sr, choice.source);
  r.apparent_model_error_w_sr = std::hypot(r.apparent_model_error_w_sr, choice.apparent);
  r.contrast_model_error_w_sr = std::hypot(r.contrast_model_error_w_sr, choice.contrast);
}

// Adds the measured part of each effect in the intensity, where the causes tell it.
void add_shares(SignatureResult& r) {
  for (LedgerEntry& e : r.effect) {
    if (e.state != EffectState::kOn) continue;
    const auto cause = [&](Cause which) {
      return r.cause_w_sr[static_cast<std::size_t>(which)].value;
    };
    switch (e.effect) {
      case Effect::kSelfEmission:
        e.fraction_w_sr = cause(Cause::kEmitted);
        break;
      case Effect::kDirectSun:
        e.fraction_w_sr = cause(Cause::kSunReflected);
        break;
      case Effect::kSkyReflected:
        e.fraction_w_sr = cause(Cause::kSkyReflected);
        break;
      case Effect::kLowerReflected:
        e.fraction_w_sr = cause(Cause::kSeaReflected);
        break;
      case Effect::kInterReflection:
        e.fraction_w_sr = cause(Cause::kPartsReflected);
        break;
      default:
        break;
    }
  }
}

// Estimates the cost of the whole view from counts of rays and the table's figures for the air.
void estimate_times(const PathCounts& counts, double reflected_fraction, bool atmosphere,
                    std::vector<LedgerEntry>& ledger) {
  const auto number = [](std::uint64_t n) { return static_cast<double>(n); };
  // Rays that reflections send out, where none was allowed to: as many as the first vertex would.
  const bool none = counts.reflected_rays == 0;
  const double reflected =
      none ? 2 * std::min(1.0, 2 * reflected_fraction) * number(counts.target_paths)
           : number(counts.reflected_rays);
  const double vertices = number(counts.target_paths) + reflected;
  for (LedgerEntry& e : ledger) {
    if (e.state == EffectState::kAbsent || !info_of(e.effect).switchable) continue;
    const bool on = e.state == EffectState::kOn;
    double rays = 0;
    switch (e.effect) {
      case Effect::kDirectSun:
        rays = on ? number(counts.sun_rays) : vertices;
        break;
      case Effect::kMirroredSun:
        rays = on ? number(counts.glint_rays) : 0.5 * reflected;
        break;
      case Effect::kSkyReflected:
      case Effect::kLowerReflected:
        rays = 0.5 * reflected;
        break;
      case Effect::kInterReflection:
        rays = on ? number(counts.hot_rays) : 0;
        break;
      default:
        break;
    }
    e.time_s = rays * kRaySeconds + (atmosphere ? info_of(e.effect).view_s : 0);
  }
}

SpectralEstimate spectral(const std::vector<Estimate>& of_bins, const SpectralSet& modes) {
  SpectralEstimate out;
  for (const Estimate& e : of_bins) {
    out.value.push_back(e.value);
    out.stderr_.push_back(e.stderr_);
  }
  out.modes = modes;
  return out;
}

// Returns all of a row but its picture.
SignatureResult row_of(const MeasuredView& view, std::size_t index, const PreparedScene& scene,
                       const ViewRequest& request, const ViewPlan& plan,
                       const LightComponents& components) {
  const Row& row = view.row[index];
  SignatureResult r;
  r.condition = row.condition;
  r.band = row.band;
  const RowEstimate& e = row.estimate;
  r.intensity_w_sr = e.total;
  std::copy(e.cause.begin(), e.cause.end(), r.cause_w_sr);
  r.apparent_intensity_w_sr = e.apparent;
  r.projected_area_m2 = e.projected_area_m2;
  r.part_w_sr = e.part;
  r.contrast_intensity_w_sr = e.contrast;
  r.background_radiance_w_m2_sr = e.background;
  r.spectral = spectral(e.total_spectrum, row.modes_of(Intensity::kSource));
  for (std::size_t c = 0; c < kCauses; ++c) r.spectral_cause[c] = spectral(e.cause_spectrum[c], {});
  r.apparent_spectral = spectral(e.apparent_spectrum, row.modes_of(Intensity::kApparent));
  r.contrast_spectral = spectral(e.contrast_spectrum, row.modes_of(Intensity::kContrast));
  r.background_spectral = spectral(e.background_spectrum, {});
  add_path(row, r);

  MeasuredIntensities intensities = measured(view, row);
  for (const auto& component : components) component->add_to(index, intensities);
  const auto& [source, apparent, contrast] = intensities;
  r.target_depth_bound_w_sr = contrast.of(BoundOf::kDepth);
  r.truncation_bound_w_sr = source.of(BoundOf::kTruncation);
  r.quadrature_bound_w_sr = source.of(BoundOf::kQuadrature) + source.of(BoundOf::kBasis);
  r.spectral_basis_bound_w_sr = source.of(BoundOf::kBasis);
  r.undersampling_bound_w_sr = source.of(BoundOf::kUnseen);
  r.undersampling_stderr_w_sr = source.undersampling_stderr;
  r.apparent_undersampling_stderr_w_sr = apparent.undersampling_stderr;
  r.contrast_undersampling_stderr_w_sr = contrast.undersampling_stderr;
  r.direction_interpolation_bound_w_sr = source.of(BoundOf::kSky);
  r.omitted_bound_w_sr = source.of(BoundOf::kOmitted);
  r.apparent_omitted_bound_w_sr = apparent.of(BoundOf::kOmitted);
  r.contrast_omitted_bound_w_sr = contrast.of(BoundOf::kOmitted);
  r.background_bound_w_sr = contrast.of(BoundOf::kBackground);
  r.temperature_bound_w_sr = source.of(BoundOf::kTemperature);
  r.apparent_temperature_bound_w_sr = apparent.of(BoundOf::kTemperature);
  r.numerical_error_w_sr = source.numerical_error();
  r.apparent_numerical_error_w_sr = apparent.numerical_error();
  r.contrast_numerical_error_w_sr = contrast.numerical_error();
  if (const double area = r.projected_area_m2.value; area > 0) {
    const auto temperature_k = [&](double w_sr) {
      return radiance_temperature_k(scene.band[r.band], row.on_axis.grid, w_sr / area);
    };
    r.source_radiance_temperature_k = temperature_k(r.intensity_w_sr.value);
    r.apparent_temperature_k = temperature_k(r.apparent_intensity_w_sr.value);
  }
  r.backface_fraction = backface_fraction(view);
  if (request.accuracy.relative_error <= 0)
    r.stop_reason = StopReason::kFixedSamples;
  else if (r.numerical_error_w_sr <= request.accuracy.relative_error * std::abs(source.value) ||
           (source.value == 0 && r.numerical_error_w_sr <= goal_w_sr(view, row)))
    r.stop_reason = StopReason::kTargetReached;
  else if (r.numerical_error_w_sr <= goal_w_sr(view, row))
    r.stop_reason = StopReason::kFloorReached;
  else
    r.stop_reason = plan.limited ? StopReason::kSampleLimit : StopReason::kTargetMissed;
  r.absolute_floor_w_sr = absolute_floor_w_sr(view, row);
  r.reflections = plan.effects.max_reflections;
  r.energy = view.totals.energy[index % view.setup.keys.band.size()];
  r.effect = plan.ledger[row.planned];
  add_shares(r);
  estimate_times(view.totals.counts,
                 r.projected_area_m2.value > 0
                     ? view.totals.beyond.estimate(0).value / r.projected_area_m2.value
                     : 0,
                 request.environment != nullptr, r.effect);
  r.replicate_w_sr = row.replicates(Intensity::kSource);
  r.replicate_apparent_w_sr = row.replicates(Intensity::kApparent);
  r.replicate_contrast_w_sr = row.replicates(Intensity::kContrast);
  for (const auto& component : components) component->add_to(index, r);
  return r;
}

}  // namespace

absl::StatusOr<std::shared_ptr<const PreparedView>> prepared_for(
    const PreparedScene& scene, const ViewRequest& request, const ViewPlan& plan,
    std::shared_ptr<const PreparedView> known) {
  if (known != nullptr && known->effects.same_light(plan.effects) &&
      known->aimed->bright == plan.bright)
    return known;
  ASSIGN_OR_RETURN(auto surroundings,
                   ViewSurroundings::make(request, scene.target, request.viewpoint.range_m,
                                          scene.axis.node_um()));
  ASSIGN_OR_RETURN(auto seen, surroundings.evaluate(request.selected_condition, plan.effects));
  return std::make_shared<const PreparedView>(
      PreparedView{std::make_shared<const AimedView>(
                       make_aimed_view(scene.target, request.viewpoint, plan.bright)),
                   std::move(seen), plan.effects});
}

absl::StatusOr<ViewResult> measure_view(const PreparedScene& scene, const ViewRequest& request,
                                        const ViewPlan& plan,
                                        std::shared_ptr<const PreparedView> prepared,
                                        std::vector<PathWeights>* paths) {
  RETURN_IF_ERROR(check_request(scene, request));
  ASSIGN_OR_RETURN(auto view, prepared_for(scene, request, plan, std::move(prepared)));
  ASSIGN_OR_RETURN(const PictureFrame pictures,
                   picture_frame(scene.target, view->aimed->frame, request));
  ASSIGN_OR_RETURN(const auto components, measure_components(scene, request, plan, view, pictures));
  const std::uint64_t seed = view_seed(scene, request);
  MeasuredView measured(scene, request, plan, std::move(view),
                        {request.selected_condition, request.selected_band}, seed);
  run_view(measured, plan.samples_per_replicate, kStoredStage, RunKind::kStored, paths);
  const PathCounts& counts = measured.totals.counts;

  ViewResult out;
  out.samples = counts.samples;
  out.target_paths = counts.target_paths;
  out.rays = counts.rays + plan.pilot_rays;
  out.replicates = request.accuracy.replicates;
  out.samples_per_replicate = plan.samples_per_replicate;
  out.guarded_backface_hits = counts.guarded_backface_hits;
  out.silhouette_backface_hits = counts.silhouette_backface_hits;
  out.guarded_nonfinite = counts.guarded_nonfinite;
  out.guarded_negative = counts.guarded_negative;
  out.unknown_seen = measured.totals.unknown_seen;
  out.truncated_paths = counts.truncated_paths;
  out.seed = seed;
  for (std::size_t row = 0; row < measured.row.size(); ++row) {
    out.row.push_back(row_of(measured, row, scene, request, plan, components));
    std::uint64_t rays = counts.rays + plan.pilot_rays;
    for (const auto& component : components) rays += component->rays(row);
    out.rays = std::max(out.rays, rays);
  }
  if (request.land != nullptr) RETURN_IF_ERROR(add_clutter(measured, request, out));
  RETURN_IF_ERROR(add_sea_clutter(measured, request, out));
  RETURN_IF_ERROR(add_pictures(measured, request, pictures, components, out));
  return out;
}

}  // namespace irsig
