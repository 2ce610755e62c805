#include "core/study/view_estimator.h"

#include <array>
#include <optional>
#include <utility>

#include "core/base/sobol.h"
#include "core/base/status_macros.h"
#include "core/signature/view/prepared_view.h"
#include "core/signature/view/shading.h"

namespace irsig {

EstimatorOptions plain_monte_carlo(std::uint32_t max_reflections) {
  return {.max_reflections = max_reflections,
          .replicates = 1,
          .pseudo_random = true,
          .each_wavelength = true,
          .hot_parts = false,
          .coverage_mask = false,
          .wide_roulette = false};
}

ViewEstimator::ViewEstimator(const Simulator& simulator, const ViewRequest& request)
    : simulator_(simulator), request_(request), unmarked_(simulator.target()) {
  for (PartSpec& part : unmarked_.part) part.hot = false;
  whole_ = make_aimed_view(unmarked_, request.viewpoint);
  whole_.stratum = {CoverageMask::whole(whole_.frame)};
}

absl::StatusOr<std::unique_ptr<ViewEstimator>> ViewEstimator::create(
    const Simulator& simulator, const ViewRequest& request, std::vector<std::uint32_t> conditions) {
  auto out = std::unique_ptr<ViewEstimator>(new ViewEstimator(simulator, request));
  ASSIGN_OR_RETURN(auto environments,
                   view_environments(request, simulator.target(), request.viewpoint.range_m,
                                     conditions, simulator.scene().axis.node_um()));
  out->environments_ = std::make_shared<const ViewEnvironments>(std::move(environments));
  return out;
}

ViewSources ViewEstimator::sources_of(std::span<const std::uint32_t> conditions,
                                      bool contrast) const {
  const PreparedScene& scene = simulator_.scene();
  SourceRequest sources = source_request(scene, request_, conditions);
  sources.contrast = contrast;
  return {sources, EffectSet::everything(request_.condition.size(), 1), environments_,
          scene.axis.node_um()};
}

PathSettings ViewEstimator::settings(const EstimatorOptions& knobs) const {
  PathSettings out;
  out.max_reflections = knobs.max_reflections;
  out.replicates = knobs.replicates;
  out.split = knobs.wide_roulette ? 2 : 1;  // as core/signature/view/trace_view.cpp has it
  out.roulette_survival_scale = knobs.wide_roulette ? 2 : 1;
  out.hot_lights = out.sun_disk_by_chance = knobs.hot_parts;
  out.pseudo_random = knobs.pseudo_random;
  return out;
}

ViewValue ViewEstimator::estimate(const EstimatorOptions& knobs, std::span<const ViewRow> rows,
                                  std::uint64_t samples_per_replicate, std::uint64_t seed) const {
  const Target& target = knobs.hot_parts ? simulator_.target() : unmarked_;
  std::optional<AimedView> masked;
  if (knobs.coverage_mask) masked = make_aimed_view(target, request_.viewpoint);
  const AimedView& view = masked ? *masked : whole_;
  PathSettings settings = this->settings(knobs);
  settings.samples = samples_per_replicate;
  settings.seed = mix64(simulator_.scene_hash() ^ mix64(seed));
  ViewValue out;
  if (!knobs.each_wavelength) {
    trace_together(rows, settings, target, view, out);
    return out;
  }
  for (const ViewRow& row : rows) trace_each_wavelength(row, settings, target, view, out);
  return out;
}

void ViewEstimator::trace_together(std::span<const ViewRow> rows, const PathSettings& settings,
                                   const Target& target, const AimedView& view,
                                   ViewValue& out) const {
  std::vector<std::uint32_t> conditions;
  for (const ViewRow& row : rows) conditions.push_back(row.condition);
  const ViewSources sources = sources_of(conditions, true);
  const PathTracer tracer(target, simulator_.carried_materials(), view, sources.geometry(),
                          settings);
  PathCounts counts;
  const std::vector<PathWeights> weights = tracer.trace(counts);
  const std::size_t parts = target.part.size();
  const SpectralBasis* basis = simulator_.scene().path_basis();
  std::vector<RowTally> tally;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ViewRow& row = rows[i];
    const BandOnAxis band = simulator_.scene().axis.band(row.band);
    const BandGrid& grid = band.grid;
    const LitWeights lit(sources.wanted(i), weights, parts);
    const SourceTable whole =
        source_table(sources.wanted(i), basis, band.first_node, grid.band_weight);
    tally_row(sources.wanted(i), parts, lit, basis, band, whole, true, tally);
    const RowEstimate e = estimates_of(tally);
    const Estimate emitted = e.cause[static_cast<std::size_t>(Cause::kEmitted)];
    out.intensity_w_sr.push_back(e.total);
    out.emitted_w_sr.push_back(emitted);
    out.projected_area_m2.push_back(e.projected_area_m2);
    out.apparent_intensity_w_sr.push_back(e.apparent);
    RowValue value{e.total.value, emitted.value, e.projected_area_m2.value, {}};
    std::vector<double>& spectral_stderr = out.spectral_stderr_w_sr_um.emplace_back();
    for (const Estimate& of_bin : e.total_spectrum) {
      value.spectral_w_sr_um.push_back(of_bin.value);
      spectral_stderr.push_back(of_bin.stderr_);
    }
    out.row.push_back(std::move(value));
  }
  out.samples += counts.samples;
  out.rays += counts.rays;
}

void ViewEstimator::trace_each_wavelength(const ViewRow& row, PathSettings settings,
                                          const Target& target, const AimedView& view,
                                          ViewValue& out) const {
  const std::array<std::uint32_t, 1> only{row.condition};
  const ViewSources sources = sources_of(only, false);
  const ConditionSources& light = sources.wanted(0);
  const BandOnAxis band = simulator_.scene().axis.band(row.band);
  const BandGrid& grid = band.grid;
  const SpectralBasis* basis = simulator_.scene().path_basis();
  RowValue value;
  for (std::size_t k = 0; k < grid.lambda_um.size(); ++k) {
    settings.seed = mix64(settings.seed + row.condition * 4096 + row.band * 64 + 1);
    const PathTracer tracer(target, simulator_.carried_materials(), view, sources.geometry(),
                            settings);
    PathCounts counts;
    const std::vector<PathWeights> weights = tracer.trace(counts);
    const std::size_t first = grid.bin_first[k], nodes = grid.bin_first[k + 1] - first,
                      node = band.first_node + first;
    const SourceTable of_bin = source_table(light, basis, node, {&grid.bin_weight[first], nodes}),
                      in_band = source_table(light, basis, node, {&grid.band_weight[first], nodes});
    double bin = 0;
    for (const PathWeights& w : weights) {
      const SummedWeights sums = summed_light(light, w.weight, target.part.size());
      const double share = 1.0 / static_cast<double>(weights.size());
      bin += share * in_band_w_sr(light, sums, of_bin);
      value.intensity_w_sr += share * in_band_w_sr(light, sums, in_band);
      value.emitted_w_sr += share * emitted_in_band_w_sr(light.layout(), sums, in_band);
      value.projected_area_m2 +=
          share * w.projected_area_m2 / static_cast<double>(grid.lambda_um.size());
    }
    value.spectral_w_sr_um.push_back(bin);
    out.samples += counts.samples;
    out.rays += counts.rays;
  }
  out.intensity_w_sr.push_back({value.intensity_w_sr, 0});
  out.emitted_w_sr.push_back({value.emitted_w_sr, 0});
  out.projected_area_m2.push_back({value.projected_area_m2, 0});
  out.spectral_stderr_w_sr_um.emplace_back(value.spectral_w_sr_um.size(), 0.0);
  out.row.push_back(std::move(value));
}

}  // namespace irsig
