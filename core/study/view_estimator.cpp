#include "core/study/view_estimator.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <utility>

#include "core/base/constants.h"
#include "core/base/sobol.h"
#include "core/transport/path_tracer.h"

namespace irsig {
namespace {

// The in-band sum over what the parts seen first emit themselves.
double own_w_sr(const RowWeights& weights, const SourceTable& table, std::uint32_t parts) {
  double sum = 0;
  for (std::uint32_t f = 0; f < parts; ++f)
    for (std::size_t k = 0; k < table.columns; ++k)
      sum += table.source[f * table.columns + k] *
             weights.value[f * weights.columns + table.first_column + k];
  return sum;
}

}  // namespace

EstimatorKnobs plain_monte_carlo(std::uint32_t max_reflections) {
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
  for (const BandGrid& grid : simulator.band_grids()) {
    band_offset_.push_back(node_um_.size());
    node_um_.insert(node_um_.end(), grid.node_um.begin(), grid.node_um.end());
  }
}

absl::StatusOr<std::unique_ptr<ViewEstimator>> ViewEstimator::create(
    const Simulator& simulator, const ViewRequest& request, std::vector<std::uint32_t> conditions) {
  auto out = std::unique_ptr<ViewEstimator>(new ViewEstimator(simulator, request));
  auto environments = view_environments(request, simulator.target(), request.viewpoint.range_m,
                                        conditions, out->node_um_);
  if (!environments.ok()) return environments.status();
  out->environments_ = *std::move(environments);
  return out;
}

ViewEstimator::Suns ViewEstimator::suns_of(std::span<const ViewRow> rows) const {
  Suns out;
  for (const ViewRow& row : rows) {
    const ConditionSpec& c = request_.condition[row.condition];
    if (!sun_shines(c)) {
      out.of_row.push_back(-1);
      continue;
    }
    const auto same = std::find_if(out.sun.begin(), out.sun.end(), [&](const SunDirection& s) {
      return s.direction == c.sun_direction && s.sea_wind_m_s == c.sea_wind_m_s;
    });
    out.of_row.push_back(static_cast<int>(same - out.sun.begin()));
    if (same == out.sun.end())
      out.sun.push_back(
          {c.sun_direction, c.sun_angular_radius_deg * std::numbers::pi / 180, 0, c.sea_wind_m_s});
  }
  return out;
}

PathSettings ViewEstimator::settings(const EstimatorKnobs& knobs) const {
  PathSettings out;
  out.max_reflections = knobs.max_reflections;
  out.lower_is_sea = over_sea(request_);
  out.sea_z_m = -simulator_.target().centre.z;
  out.earth_radius_m = out.lower_is_sea ? kEarthRadiusM : 0;
  out.replicates = knobs.replicates;
  out.split = knobs.wide_roulette ? 2 : 1;  // as core/signature/pass.cpp has it
  out.persistence = knobs.wide_roulette ? 2 : 1;
  out.directions = environments_.directions;
  out.hot_lights = out.sun_disk_by_chance = knobs.hot_parts;
  out.pseudo_random = knobs.pseudo_random;
  return out;
}

ViewValue ViewEstimator::estimate(const EstimatorKnobs& knobs, std::span<const ViewRow> rows,
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
    settings.behind = environments_.behind;
    trace_together(rows, settings, target, view, out);
    return out;
  }
  for (const ViewRow& row : rows) trace_each_wavelength(row, settings, target, view, out);
  return out;
}

void ViewEstimator::trace_together(std::span<const ViewRow> rows, const PathSettings& settings,
                                   const Target& target, const AimedView& view,
                                   ViewValue& out) const {
  Suns suns = suns_of(rows);
  const PathTracer tracer(target, simulator_.carried_materials(), view, suns.sun, settings);
  std::vector<double> no_image;
  PathCounts counts;
  const std::vector<PathWeights> weights = tracer.trace({}, no_image, counts);
  std::vector<RowWeights> summed;
  for (const PathWeights& w : weights)
    summed.push_back(row_weights(w.weight, tracer.classes(), tracer.nodes()));
  const SpectralBasis* basis = tracer.spectral() ? &simulator_.basis() : nullptr;
  const std::size_t parts = target.part.size();
  std::vector<std::vector<double>> values;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ViewRow& row = rows[i];
    const ConditionShading shading(request_.condition[row.condition],
                                   environments_.condition[row.condition], tracer.classes(),
                                   suns.of_row[i], node_um_);
    const BandGrid& grid = simulator_.band_grids()[row.band];
    shading.evaluate(weights, summed, basis, grid, band_offset_[row.band], true, values);
    ReplicateStatistics s(values.front().size());
    for (const auto& of_replicate : values) s.add(of_replicate);
    // The order of ConditionShading::evaluate.
    const std::size_t area = 2 + kCauses, spectrum = area + 1 + parts + 2;
    out.intensity_w_sr.push_back(s.estimate(0));
    out.emitted_w_sr.push_back(s.estimate(1 + static_cast<std::size_t>(Cause::kEmitted)));
    out.projected_area_m2.push_back(s.estimate(area));
    out.apparent_intensity_w_sr.push_back(s.estimate(area - 1));
    RowValue value{out.intensity_w_sr.back().value,
                   out.emitted_w_sr.back().value,
                   out.projected_area_m2.back().value,
                   {}};
    std::vector<double>& spectral_stderr = out.spectral_stderr_w_sr_um.emplace_back();
    for (std::size_t k = 0; k < grid.lambda_um.size(); ++k) {
      value.spectral_w_sr_um.push_back(s.estimate(spectrum + k).value);
      spectral_stderr.push_back(s.estimate(spectrum + k).stderr_);
    }
    out.row.push_back(std::move(value));
  }
  out.samples += counts.samples;
  out.rays += counts.rays;
}

void ViewEstimator::trace_each_wavelength(const ViewRow& row, PathSettings settings,
                                          const Target& target, const AimedView& view,
                                          ViewValue& out) const {
  const std::array<ViewRow, 1> only{row};
  Suns suns = suns_of(only);
  const BandGrid& grid = simulator_.band_grids()[row.band];
  const auto parts = static_cast<std::uint32_t>(target.part.size());
  RowValue value;
  std::vector<double> no_image;
  std::optional<ConditionShading> shading;
  for (std::size_t k = 0; k < grid.lambda_um.size(); ++k) {
    settings.seed = mix64(settings.seed + row.condition * 4096 + row.band * 64 + 1);
    const PathTracer tracer(target, simulator_.carried_materials(), view, suns.sun, settings);
    const SpectralBasis* basis = tracer.spectral() ? &simulator_.basis() : nullptr;
    if (!shading)
      shading.emplace(request_.condition[row.condition], environments_.condition[row.condition],
                      tracer.classes(), suns.of_row.front(), node_um_);
    PathCounts counts;
    const std::vector<PathWeights> weights = tracer.trace({}, no_image, counts);
    const std::size_t first = grid.bin_first[k], nodes = grid.bin_first[k + 1] - first,
                      node = band_offset_[row.band] + first;
    const SourceTable of_bin = shading->table(basis, node, {&grid.bin_weight[first], nodes}),
                      in_band = shading->table(basis, node, {&grid.band_weight[first], nodes});
    double bin = 0;
    for (const PathWeights& w : weights) {
      const RowWeights summed = row_weights(w.weight, tracer.classes(), tracer.nodes());
      const double share = 1.0 / static_cast<double>(weights.size());
      bin += share * shading->in_band_w_sr(summed, of_bin);
      value.intensity_w_sr += share * shading->in_band_w_sr(summed, in_band);
      value.emitted_w_sr += share * own_w_sr(summed, in_band, parts);
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
