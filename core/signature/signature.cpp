#include "core/signature/signature.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/signature/pass.h"
#include "core/signature/scene_hash.h"

namespace irsig {
namespace {

// The sampler's coordinates have 23 bits.
constexpr std::uint64_t kMostSamples = 1u << 23;

std::vector<std::uint32_t> all_of(std::size_t n) {
  std::vector<std::uint32_t> out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<std::uint32_t>(i);
  return out;
}

// What is stored of the air between target and sensor, and the models' errors.
void add_path(const ViewEnvironment& e, const BandGrid& grid, std::size_t offset,
              SignatureResult& r) {
  double width_um = 0;
  r.path_transmittance = r.path_radiance_w_m2_sr = 0;
  for (std::size_t i = 0; i < grid.node_um.size(); ++i) {
    width_um += grid.band_weight[i];
    r.path_transmittance += grid.band_weight[i] * e.transmittance[offset + i];
    r.path_radiance_w_m2_sr += grid.band_weight[i] * e.path_radiance[offset + i];
  }
  r.path_transmittance /= width_um;
  // Surface emission is multiplied by the mean transmittance, whose error is taken bin by bin; the
  // errors of one model go the same way everywhere, and add up.
  double emission_lost_w_sr = 0, path_w_sr = 0;
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
    r.path_transmittance_spectral.push_back(transmittance);
    r.path_radiance_spectral.push_back(radiance);
  }
  const auto cause = [&](Cause which) {
    return r.cause_w_sr[static_cast<std::size_t>(which)].value;
  };
  r.model_error_w_sr = std::hypot(e.sky_model_relative * cause(Cause::kSkyReflected),
                                  e.lower_model_relative * cause(Cause::kSeaReflected),
                                  e.sun_model_relative * cause(Cause::kSunReflected));
  const double seen = r.intensity_w_sr.value != 0
                          ? std::abs(r.apparent_intensity_w_sr.value / r.intensity_w_sr.value)
                          : 0;
  r.apparent_model_error_w_sr =
      std::hypot(std::min(seen, 1.0) * r.model_error_w_sr, emission_lost_w_sr - path_w_sr);
}

// The air is taken at the range of the reference point. Over the target's own depth, at most
// `depth` of the range to either side, the apparent radiance changes by (L - L_air) dT: L_air is
// the path's radiance / (1 - T), and |dT| at most T (-ln T) x depth, as in grey air; where lines
// are saturated it is less. [W/sr]
double depth_bound_w_sr(const SignatureResult& r, const BandGrid& grid, double depth) {
  double sum = 0;
  for (std::size_t k = 0; k < grid.lambda_um.size(); ++k) {
    const double t = r.path_transmittance_spectral[k];
    if (!(t > 0 && t < 1)) continue;
    const double air_w_sr_um = r.projected_area_m2.value * r.path_radiance_spectral[k] / (1 - t);
    double width_um = 0;
    for (std::size_t i = grid.bin_first[k]; i < grid.bin_first[k + 1]; ++i)
      width_um += grid.band_weight[i];
    sum += width_um * std::abs(r.spectral.value[k] - air_w_sr_um) * t * -std::log(t) * depth;
  }
  return sum;
}

}  // namespace

absl::StatusOr<std::unique_ptr<Simulator>> Simulator::create(const SceneSpec& spec) {
  auto simulator = std::unique_ptr<Simulator>(new Simulator);
  simulator->band_ = spec.band;
  for (const Band& band : spec.band) {
    auto grid = make_band_grid(band, spec.spectral_breaks_um);
    if (!grid.ok()) return grid.status();
    simulator->band_offset_.push_back(simulator->node_um_.size());
    simulator->node_um_.insert(simulator->node_um_.end(), grid->node_um.begin(),
                               grid->node_um.end());
    simulator->grid_.push_back(*std::move(grid));
  }
  Hash hash;
  std::vector<double> sorted = simulator->node_um_;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 0; i < spec.material.size(); ++i) {
    const MaterialSpec& m = spec.material[i];
    auto prepared = Material::prepare(m, simulator->node_um_, sorted.front(), sorted.back());
    if (!prepared.ok())
      return absl::Status(prepared.status().code(),
                          absl::StrCat("material[", i, "]: ", prepared.status().message()));
    simulator->material_.push_back(*std::move(prepared));
    hash.add(m);
  }
  simulator->basis_ = make_spectral_basis(simulator->material_);
  if (!simulator->basis_.identity()) {
    std::vector<double> carried_um;
    for (const std::uint32_t i : simulator->basis_.carried)
      carried_um.push_back(simulator->node_um_[i]);
    for (const MaterialSpec& m : spec.material) {
      auto prepared = Material::prepare(m, carried_um, sorted.front(), sorted.back());
      if (!prepared.ok()) return prepared.status();
      simulator->carried_.push_back(*std::move(prepared));
    }
  }
  auto target = make_target(spec.mesh, spec.part, spec.isa, spec.tracer);
  if (!target.ok()) return target.status();
  simulator->target_ = *std::move(target);
  hash.add(simulator->target_.vertex);
  for (const std::uint32_t corner : simulator->target_.triangle)
    hash.add(static_cast<std::uint64_t>(corner));
  for (const PartSpec& part : simulator->target_.part) {
    hash.add(static_cast<std::uint64_t>(part.material * 4 + part.two_sided * 2 + part.hot));
    simulator->energy_gain_ |= simulator->material_[part.material].creates_energy();
  }
  simulator->scene_hash_ = hash.value();
  return simulator;
}

absl::StatusOr<ViewResult> Simulator::simulate(const ViewRequest& request) const {
  const Viewpoint& viewpoint = request.viewpoint;
  const double reach = length(target_.centre) + target_.radius_m;
  if (!(viewpoint.range_m > reach))
    return absl::InvalidArgumentError(absl::StrCat(
        "viewpoints.range_m: a sensor at ", viewpoint.range_m,
        " m is inside the target, which reaches ", reach, " m from its reference point"));
  for (const ConditionSpec& c : request.condition)
    if (c.part_temperature_k.size() != target_.part.size())
      return absl::InvalidArgumentError("a condition does not state one temperature for each part");
  for (const ConditionSpec& c : request.condition)
    if (c.surroundings.kind != request.condition.front().surroundings.kind)
      return absl::InvalidArgumentError(
          "surroundings.kind: all conditions of a sweep need the same kind, since paths are traced "
          "once for all");
  if (request.accuracy.max_samples_per_replicate > kMostSamples ||
      request.accuracy.samples_per_replicate > kMostSamples)
    return absl::InvalidArgumentError(absl::StrCat("accuracy: more than ", kMostSamples,
                                                   " samples in a replicate; use more replicates"));
  if (request.condition.empty() || band_.empty())
    return absl::InvalidArgumentError("a sweep needs a condition and a band");
  if (request.condition.front().surroundings.kind == SurroundingsKind::kSea) {
    const double el = viewpoint.aspect_elevation_deg * std::numbers::pi / 180;
    const double along = viewpoint.range_m * std::cos(el);
    const double height = viewpoint.range_m * std::sin(el) + along * along / (2 * kEarthRadiusM);
    if (height < 0)
      return absl::InvalidArgumentError(
          absl::StrCat("viewpoints: a sensor at ", viewpoint.range_m, " m range and ",
                       viewpoint.aspect_elevation_deg, " deg elevation is under the sea"));
  }

  Hash hash;
  hash.add(scene_hash_);
  hash.add(viewpoint.aspect_azimuth_deg);
  hash.add(viewpoint.aspect_elevation_deg);
  hash.add(viewpoint.range_m);
  hash.add(request.seed);
  const std::uint64_t seed = hash.value();
  constexpr std::uint64_t kFirstPilot = 1, kSecondPilot = 2, kStored = 4;

  const AimedView view = make_aimed_view(target_, viewpoint);
  const bool pilots = request.accuracy.relative_error > 0 || request.accuracy.target_paths > 0;
  const auto environments = view_environments(
      request, target_, viewpoint.range_m,
      pilots ? all_of(request.condition.size()) : request.selected_condition, node_um_);
  if (!environments.ok()) return environments.status();

  // The number of samples, from a pilot over every row of the sweep. Nothing of the pilot is
  // stored.
  const AccuracySpec& accuracy = request.accuracy;
  std::uint64_t samples = accuracy.samples_per_replicate;
  bool limited = false;
  std::uint64_t pilot_rays = 0;
  if (pilots) {
    Pass pilot(*this, request, view, *environments, all_of(request.condition.size()),
               all_of(band_.size()), node_um_, band_offset_, seed);
    constexpr std::uint64_t kFirst = 128, kSecond = 1024;
    if (accuracy.target_paths > 0) {
      // Hits are counted with the strata in the proportion that the stored run has.
      pilot.run(kSecond, kFirstPilot, Pass::Kind::kPilot);
      pilot_rays += pilot.counts().rays;
      const double per_sample =
          static_cast<double>(pilot.counts().target_paths) / static_cast<double>(kSecond);
      if (per_sample == 0)
        return absl::FailedPreconditionError("target_paths: no ray of the pilot met the target");
      const double wanted = std::ceil(accuracy.target_paths / per_sample / 16) * 16;
      samples = static_cast<std::uint64_t>(
          std::min(wanted, static_cast<double>(accuracy.max_samples_per_replicate)));
      limited = wanted > static_cast<double>(accuracy.max_samples_per_replicate);
    } else {
      pilot.run(kFirst, kFirstPilot, Pass::Kind::kPilot);
      pilot_rays += pilot.counts().rays;
      const std::size_t rows = pilot.rows();
      std::vector<double> before;
      for (std::size_t row = 0; row < rows; ++row)
        before.push_back(pilot.statistics(row).estimate(0).stderr_);
      // A larger pilot follows where the first estimate asks for much more: rare bright paths are
      // then seen often enough to be judged.
      std::uint64_t n_before = kFirst, n = kSecond;
      for (std::uint64_t stage = kSecondPilot;; ++stage) {
        pilot.run(n, stage, Pass::Kind::kPilot);
        pilot_rays += pilot.counts().rays;
        samples = 16;
        for (std::size_t row = 0; row < rows; ++row) {
          const Estimate e = pilot.statistics(row).estimate(0);
          if (e.stderr_ > 0)
            samples =
                std::max(samples, samples_needed(n_before, before[row], n, e.stderr_,
                                                 pilot.stderr_wanted(row, accuracy.relative_error),
                                                 std::uint64_t{1} << 40));
          before[row] = e.stderr_;
        }
        samples = std::min(samples, accuracy.max_samples_per_replicate + 1);
        if (stage != kSecondPilot || samples < 32 * n) break;
        n_before = n;
        n = samples / 16;
      }
      limited = samples > accuracy.max_samples_per_replicate;
      samples = std::min(samples, accuracy.max_samples_per_replicate);
    }
  }

  Pass pass(*this, request, view, *environments, request.selected_condition, request.selected_band,
            node_um_, band_offset_, seed);
  pass.run(samples, kStored,
           request.thumbnail_px > 0 ? Pass::Kind::kStoredWithPictures : Pass::Kind::kStored);

  ViewResult out;
  out.samples = pass.counts().samples;
  out.target_paths = pass.counts().target_paths;
  out.rays = pass.counts().rays + pilot_rays;
  out.replicates = accuracy.replicates;
  out.samples_per_replicate = samples;
  out.guarded_backface_hits = pass.counts().guarded_backface_hits;
  out.guarded_nonfinite = pass.counts().guarded_nonfinite;
  out.guarded_negative = pass.counts().guarded_negative;
  out.guarded_path_limit = pass.counts().truncated_paths;
  out.seed = seed;
  const ImagePlan& plan = pass.plan();
  out.image_width_px = plan.width_px;
  out.image_height_px = plan.height_px;
  // Solid angle of a pixel times range^2, on the image plane's axis; the paths' own Jacobian is in
  // their weights.
  const double pixel_m = plan.width_px > 0 ? pass.frame().width_m / plan.width_px : 0;
  const double pixel_area_m2 =
      plan.width_px > 0 ? pixel_m * pass.frame().height_m / plan.height_px : 0;
  out.pixel_rad = pixel_m / pass.frame().plane_m;
  const double plane_scale = std::pow(viewpoint.range_m / pass.frame().plane_m, 2);

  for (std::size_t row = 0; row < pass.rows(); ++row) {
    SignatureResult& r = out.row.emplace_back();
    r.condition = pass.conditions()[row / pass.bands().size()];
    r.band = pass.bands()[row % pass.bands().size()];
    const BandGrid& grid = grid_[r.band];
    const std::size_t bins = grid.lambda_um.size(), parts = target_.part.size();
    const ReplicateStatistics& s = pass.statistics(row);
    std::size_t q = 0;
    r.intensity_w_sr = s.estimate(q++);
    for (Estimate& cause : r.cause_w_sr) cause = s.estimate(q++);
    r.apparent_intensity_w_sr = s.estimate(q++);
    r.projected_area_m2 = s.estimate(q++);
    for (std::size_t p = 0; p < parts; ++p) r.part_w_sr.push_back(s.estimate(q++));
    r.contrast_intensity_w_sr = s.estimate(q++);
    r.background_radiance_w_m2_sr = s.estimate(q++);
    const auto spectrum = [&](SpectralEstimate& e) {
      for (std::size_t k = 0; k < bins; ++k, ++q) {
        e.value.push_back(s.estimate(q).value);
        e.stderr_.push_back(s.estimate(q).stderr_);
      }
    };
    spectrum(r.spectral);
    for (SpectralEstimate& cause : r.spectral_cause) spectrum(cause);
    spectrum(r.apparent_spectral);
    spectrum(r.contrast_spectral);
    spectrum(r.background_spectral);
    add_path(pass.shading(row).environment(), grid, band_offset_[r.band], r);

    const auto bounds = pass.bounds(row);
    r.truncation_bound_w_sr = bounds.truncation;
    r.quadrature_bound_w_sr = bounds.quadrature + bounds.basis;
    r.basis_bound_w_sr = bounds.basis;
    r.unseen_bound_w_sr = bounds.unseen;
    r.numerical_error_w_sr = numerical_error(r.intensity_w_sr.stderr_, bounds.sum());
    const double aperture_bounds =
        bounds.sum() + depth_bound_w_sr(r, grid, reach / viewpoint.range_m);
    r.apparent_numerical_error_w_sr =
        numerical_error(r.apparent_intensity_w_sr.stderr_, aperture_bounds);
    r.contrast_numerical_error_w_sr =
        numerical_error(r.contrast_intensity_w_sr.stderr_, aperture_bounds);
    r.sky_bound_w_sr = bounds.sky;
    if (r.projected_area_m2.value > 0)
      r.apparent_temperature_k = apparent_temperature_k(
          band_[r.band], grid, r.intensity_w_sr.value / r.projected_area_m2.value);
    if (accuracy.relative_error <= 0)
      r.stop_reason = StopReason::kFixedSamples;
    else if (r.numerical_error_w_sr <= accuracy.relative_error * std::abs(r.intensity_w_sr.value))
      r.stop_reason = StopReason::kTargetReached;
    else
      r.stop_reason = limited ? StopReason::kSampleLimit : StopReason::kTargetMissed;
    if (!plan.empty()) {
      const double scale = 1.0 / (accuracy.replicates * pixel_area_m2 * plane_scale);
      const std::size_t pixels = static_cast<std::size_t>(plan.width_px) * plan.height_px;
      for (std::size_t i = 0; i < pixels; ++i)
        r.image_w_m2_sr.push_back(static_cast<float>(scale * pass.image()[i * plan.padded + row]));
    }
  }
  return out;
}

}  // namespace irsig
