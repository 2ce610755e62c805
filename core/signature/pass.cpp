#include "core/signature/pass.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/constants.h"
#include "core/base/sobol.h"

namespace irsig {

Pass::Pass(const Simulator& simulator, const ViewRequest& request, const ViewPlan& plan,
           const AimedView& view, const ViewEnvironments& environments,
           std::span<const std::uint32_t> conditions, std::span<const std::uint32_t> bands,
           const std::vector<double>& node_um, const std::vector<std::size_t>& band_offset,
           std::uint64_t seed)
    : simulator_(simulator),
      request_(request),
      plan_(plan),
      conditions_(conditions.begin(), conditions.end()),
      bands_(bands.begin(), bands.end()),
      band_offset_(band_offset),
      seed_(seed),
      environments_(environments),
      view_(view) {
  std::vector<int> sun_of_condition;
  for (const std::uint32_t c : conditions_) {
    const ConditionSpec& condition = request.condition[c];
    int index = -1;
    if (sun_shines(condition) && plan.effects.follows_sun(c)) {
      const SunDirection sun{condition.sun_direction,
                             condition.sun_angular_radius_deg * std::numbers::pi / 180, 0,
                             plan.effects.sun[c].mirrored ? condition.sea_wind_m_s : 0};
      const auto same = std::find_if(suns_.begin(), suns_.end(), [&](const SunDirection& s) {
        return s.direction == sun.direction && s.angular_radius_rad == sun.angular_radius_rad &&
               s.sea_wind_m_s == sun.sea_wind_m_s;
      });
      index = static_cast<int>(same - suns_.begin());
      if (same == suns_.end()) suns_.push_back(sun);
    }
    sun_of_condition.push_back(index);
  }
  classes_ = source_classes(simulator.target().part.size(), suns_, over_sea(request),
                            environments.directions, &environments.behind);
  for (std::size_t i = 0; i < conditions_.size(); ++i)
    shading_.emplace_back(request.condition[conditions_[i]], environments.condition[conditions_[i]],
                          classes_, sun_of_condition[i], node_um, plan.effects,
                          plan.effects.sun[conditions_[i]]);
  unseen_sun_ = unseen_sun(simulator.target(), simulator.carried_materials(), view.frame,
                           view.range_m, suns_);
  for (std::size_t row = 0; row < rows(); ++row) brightest_.push_back(find_brightest_w_m2_sr(row));
}

void Pass::run(std::uint64_t samples, std::uint64_t stage, Kind kind) {
  const auto& grids = simulator_.band_grids();
  PathSettings settings;
  settings.max_reflections = plan_.effects.max_reflections;
  settings.no_second_hit = plan_.effects.no_second_hit;
  settings.hot_lights = !plan_.effects.no_second_hit;
  settings.lower_is_sea = over_sea(request_);
  settings.sea_z_m = -simulator_.target().centre.z;
  settings.earth_radius_m = settings.lower_is_sea ? kEarthRadiusM : 0;
  settings.seed = mix64(seed_ + stage);
  settings.samples = samples;
  settings.replicates = request_.accuracy.replicates;
  // Where the error is to be small, reflections set it. Variance x CPU time of the mid-wave row of
  // a sunlit frigate with hot parts, relative to a persistence and a split of 1:
  //     persistence, split    1, 2    2, 2    4, 2    4, 1   16, 1
  //     hull                  0.71    0.49    0.46    0.51    0.45
  //     diffuse, rho = 0.8    0.91    0.66    0.53    0.96    0.96
  //     hull_paper            0.87    0.61    0.63    0.80    0.80
  // (4, 2) gains nothing more where the pilots are most of the work. Where the number of paths is
  // asked for, each stays one path.
  const bool asked = request_.accuracy.relative_error > 0;
  settings.persistence = asked ? 2 : 1;
  settings.split = asked ? 2 : 1;
  settings.directions = environments_.directions;
  settings.behind = environments_.behind;
  const PathTracer tracer(simulator_.target(), simulator_.carried_materials(), view_, suns_,
                          settings);
  const SpectralBasis* basis = tracer.spectral() ? &simulator_.basis() : nullptr;
  if (in_band_.empty())
    for (const ConditionShading& shading : shading_)
      for (const std::uint32_t b : bands_)
        in_band_.push_back(shading.table(basis, band_offset_[b], grids[b].band_weight));
  image_plan_ = kind == Kind::kStoredWithPictures ? plan_images(tracer) : ImagePlan{};
  image_.assign(
      static_cast<std::size_t>(image_plan_.width_px) * image_plan_.height_px * image_plan_.padded,
      0.0);
  counts_ = {};
  beyond_m2_ = {};
  basis_w_sr_.assign(rows(), 0.0);
  samples_ = samples;
  statistics_.clear();
  last_ = ReplicateStatistics(rows());
  beyond_ = ReplicateStatistics(plan_.effects.max_reflections + 1);

  const std::vector<PathWeights> weights = tracer.trace(image_plan_, image_, counts_);
  const double inverse_replicates = 1.0 / request_.accuracy.replicates;
  std::vector<RowWeights> summed;
  std::vector<double> last(rows());
  for (const PathWeights& w : weights) {
    for (std::size_t k = 0; k < 3; ++k) beyond_m2_[k] += inverse_replicates * w.beyond_m2[k];
    beyond_.add(w.beyond_order_m2);
    summed.push_back(row_weights(w.weight, classes_, tracer.nodes()));
    if (!w.last.empty()) {
      const RowWeights of_last = row_weights(w.last, classes_, tracer.nodes());
      for (std::size_t row = 0; row < rows(); ++row)
        last[row] = shading(row).in_band_w_sr(of_last, in_band_[row]);
    }
    last_.add(last);
  }
  if (kind != Kind::kPilot) find_energy(weights, summed, basis);
  replicate_.assign(rows(), {});
  std::vector<std::vector<double>> values;
  for (std::size_t row = 0; row < rows(); ++row) {
    const std::uint32_t b = bands_[row % bands_.size()];
    shading(row).evaluate(weights, summed, basis, grids[b], band_offset_[b], kind != Kind::kPilot,
                          values);
    ReplicateStatistics& s = statistics_.emplace_back(values.front().size());
    for (const std::vector<double>& of_replicate : values) {
      s.add(of_replicate);
      replicate_[row][0].push_back(of_replicate[0]);
      replicate_[row][1].push_back(of_replicate[kApparentQuantity]);
      replicate_[row][2].push_back(of_replicate[contrast_quantity(classes_.parts)]);
    }
  }
  if (basis == nullptr || basis->identity()) return;
  RowWeights mean = summed.front();
  for (std::size_t r = 1; r < summed.size(); ++r)
    for (std::size_t k = 0; k < mean.value.size(); ++k) mean.value[k] += summed[r].value[k];
  for (double& w : mean.value) w *= inverse_replicates;
  const std::vector<double> row_on_node = on_nodes(mean, *basis);
  for (std::size_t row = 0; row < rows(); ++row) {
    const std::uint32_t b = bands_[row % bands_.size()];
    basis_w_sr_[row] = basis->relative_error *
                       shading(row).largest_in_band_w_sr(row_on_node, grids[b], band_offset_[b]);
  }
}

// By reciprocity: what of the light that the sensor would send out ends where.
void Pass::find_energy(std::span<const PathWeights> weights, std::span<const RowWeights> summed,
                       const SpectralBasis* basis) {
  energy_.clear();
  for (const std::uint32_t b : bands_) {
    const SourceTable unit =
        unit_table(basis, band_offset_[b], simulator_.band_grids()[b].band_weight);
    ReplicateStatistics s(5);
    for (std::size_t r = 0; r < weights.size(); ++r) {
      const double area = weights[r].projected_area_m2;
      if (!(area > 0)) continue;
      const auto share = ConditionShading::shares(summed[r], classes_, unit);
      const double cut = weights[r].truncated_m2;
      s.add(std::array{share.absorbed / area, share.sky / area, share.lower / area, cut / area,
                       (share.absorbed + share.sky + share.lower + cut) / area});
    }
    energy_.push_back({s.estimate(0), s.estimate(1), s.estimate(2), s.estimate(3), s.estimate(4)});
  }
}

Pass::Bounds Pass::bounds(std::size_t row) const {
  const std::size_t c = row / bands_.size();
  const std::uint32_t b = bands_[row % bands_.size()];
  const BandGrid& grid = simulator_.band_grids()[b];
  const std::size_t offset = band_offset_[b];
  const ConditionShading& shading = shading_[c];
  double coldest = 1e9, hottest = 1;
  for (const double t : request_.condition[conditions_[c]].part_temperature_k) {
    coldest = std::min(coldest, t);
    hottest = std::max(hottest, t);
  }
  const ViewEnvironment& environment = shading.environment();
  const auto cause = [&](Cause which) {
    return std::abs(statistics_[row].estimate(1 + static_cast<std::size_t>(which)).value);
  };
  Bounds out{0,
             std::abs(statistics_[row].estimate(0).value) *
                 quadrature_relative_bound(simulator_.bands()[b], grid,
                                           std::clamp(coldest, 1.0, hottest), hottest),
             basis_w_sr_[row],
             unseen_w_sr(shading, grid, offset) + unseen_rim_w_sr(row),
             environment.sky_interpolation * cause(Cause::kSkyReflected) +
                 environment.lower_interpolation * cause(Cause::kSeaReflected),
             {}};
  if (!plan_.omitted.empty())
    out.omitted = plan_.omitted[conditions_[c] * simulator_.bands().size() + b];
  const bool left_out = plan_.effects.max_reflections < request_.max_reflections;
  // Without any reflection the plan's bounds say it all; without other parts they say the rest.
  if (left_out && (plan_.effects.max_reflections == 0 || !plan_.effects.parts)) return out;
  const double truncation =
      truncation_bound(beyond_m2_, beyond_spacing(plan_.effects.max_reflections),
                       last_.estimate(row), beyond_m2_[2] * brightest_w_m2_sr(row));
  if (!left_out) {
    out.truncation = truncation;
    return out;
  }
  out.omitted.source += truncation;
  out.omitted.apparent += truncation;
  out.omitted.contrast += truncation;
  return out;
}

double Pass::find_brightest_w_m2_sr(std::size_t row) const {
  const ConditionShading& shading = this->shading(row);
  const std::uint32_t b = bands_[row % bands_.size()];
  const BandGrid& grid = simulator_.band_grids()[b];
  const double thermal = shading.brightest_thermal_w_m2_sr(grid, band_offset_[b]);
  const int j = shading.sun_index();
  return j < 0 ? thermal
               : thermal + shading.sun_w_m2(grid, band_offset_[b]) *
                               unseen_sun_[static_cast<std::size_t>(j)].brightest_per_sr;
}

Estimate Pass::beyond_m2(std::uint32_t reflections) const { return beyond_.estimate(reflections); }

double Pass::beyond_limit_m2(std::uint32_t reflections) const {
  const Estimate e = beyond_m2(reflections);
  double none_seen_m2 = 0;
  for (std::uint32_t s = 0; s < view_.stratum.size(); ++s)
    if (!view_.stratum[s].empty())
      none_seen_m2 +=
          kNoneSeen * view_.stratum[s].area_m2() /
          (static_cast<double>(stratum_samples(s, samples_)) * request_.accuracy.replicates);
  return e.value + 4 * e.stderr_ + none_seen_m2;
}

double Pass::absolute_floor_w_sr(std::size_t row) const {
  if (plan_.absolute_floor_w_m2_sr.empty()) return 0;
  return plan_.absolute_floor_w_m2_sr[conditions_[row / bands_.size()] * simulator_.bands().size() +
                                      bands_[row % bands_.size()]] *
         statistics_[row].estimate(kAreaQuantity).value;
}

double Pass::goal_w_sr(std::size_t row) const {
  return std::max(request_.accuracy.relative_error * std::abs(statistics_[row].estimate(0).value),
                  absolute_floor_w_sr(row));
}

double Pass::stderr_wanted(std::size_t row) const {
  const Bounds b = bounds(row);
  return irsig::stderr_wanted(goal_w_sr(row), b.source() - b.unseen);
}

// Of each stratum a rim of its mask that no sample met: less than 3 / samples of it, 19 times
// in 20. Where the silhouette fills its mask but for such a rim, the replicates do not differ.
double Pass::unseen_rim_w_sr(std::size_t row) const {
  double sum = 0;
  for (std::uint32_t p = 0; p < classes_.parts; ++p) {
    const auto samples = static_cast<double>(stratum_samples(view_.stratum_of_part[p], samples_));
    sum += kNoneSeen / (samples * request_.accuracy.replicates) *
           std::abs(statistics_[row].estimate(kAreaQuantity + 1 + p).value);
  }
  return sum;
}

// Rare bright events that were met too seldom for the standard error to know them.
// (docs/methods.md)
double Pass::unseen_w_sr(const ConditionShading& shading, const BandGrid& grid,
                         std::size_t offset) const {
  if (plan_.effects.max_reflections == 0) return 0;
  const double n = static_cast<double>(samples_) * request_.accuracy.replicates;
  // What one event among all primary samples would be worth, per unit radiance. [m2]
  const double none_seen_m2 =
      view_.stratum.front().empty() ? 0 : kNoneSeen / n * view_.stratum.front().area_m2();
  double sum = 0;
  // A hot part: roulette makes an aimed ray stand for up to 1 / kFaintHot others.
  for (std::uint32_t p = 0; p < classes_.parts; ++p)
    if (simulator_.target().part[p].hot && plan_.effects.parts && !plan_.effects.no_second_hit)
      sum = std::max(sum, kFaintHot * none_seen_m2 * shading.part_w_m2_sr(p, grid, offset));
  if (shading.sun_index() < 0) return sum;
  const auto j = static_cast<std::size_t>(shading.sun_index());
  const UnseenSun& unseen = unseen_sun_[j];
  double per_irradiance = 0;
  if (counts_.sun_met_first[j] < kSeenOften) per_irradiance += unseen.glint;
  if (plan_.effects.max_reflections >= 2 && counts_.sun_met_later[j] < kSeenOften) {
    per_irradiance += unseen.caustic;
    if (counts_.bright_to_bright > 0) per_irradiance += none_seen_m2 * unseen.chain_per_sr;
  }
  return sum + per_irradiance * shading.sun_w_m2(grid, offset);
}

ImagePlan Pass::plan_images(const PathTracer& tracer) const {
  ImagePlan plan;
  const double longest = std::max(view_.frame.width_m, view_.frame.height_m);
  const auto side = [&](double s) {
    return std::max<std::uint32_t>(
        1, static_cast<std::uint32_t>(std::lround(s / longest * request_.thumbnail_px)));
  };
  plan.width_px = side(view_.frame.width_m);
  plan.height_px = side(view_.frame.height_m);
  plan.images = static_cast<std::uint32_t>(rows());
  plan.padded = (plan.images + 7) / 8 * 8;
  const std::size_t bins = static_cast<std::size_t>(classes_.parts) * classes_.count();
  const std::size_t nodes = tracer.nodes();
  plan.source.assign(bins * (tracer.spectral() ? plan.images * nodes : plan.padded), 0.0f);
  for (std::uint32_t f = 0; f < classes_.parts; ++f)
    for (std::uint32_t c = 0; c < classes_.count(); ++c)
      for (std::uint32_t k = 0; k < plan.images; ++k) {
        const std::size_t bin = static_cast<std::size_t>(f) * classes_.count() + c;
        const SourceTable& table = in_band_[k];
        const double* of_row = table.source.data() +
                               (c == classes_.own() ? f : classes_.parts + c - 1) * table.columns;
        if (tracer.spectral())
          std::copy_n(of_row, table.columns,
                      plan.source.data() + (bin * plan.images + k) * nodes + table.first_column);
        else
          plan.source[bin * plan.padded + k] = static_cast<float>(*of_row);
      }
  return plan;
}

}  // namespace irsig
