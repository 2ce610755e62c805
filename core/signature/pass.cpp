#include "core/signature/pass.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/constants.h"
#include "core/base/sobol.h"

namespace irsig {
namespace {

// Rings of a side on which the background of a target is wanted, from |sin(elevation)| low to high.
// Near the horizon the way through the air changes fastest.
std::vector<float> behind_rings(double low, double high) {
  std::vector<float> out{static_cast<float>(low)};
  const auto last = static_cast<float>(high);
  while (out.back() < last)
    out.push_back(std::min(last, std::max(1.15f * out.back(), out.back() + 0.002f)));
  return out;
}

}  // namespace

bool sun_shines(const ConditionSpec& condition) {
  return condition.sun && condition.sun_scale > 0 &&
         condition.sun_cos_zenith >
             -std::sin(condition.sun_angular_radius_deg * std::numbers::pi / 180);
}

// The same for all conditions: simulate() checks it.
bool over_sea(const ViewRequest& request) {
  return request.condition.front().surroundings.kind == SurroundingsKind::kSea;
}

absl::StatusOr<ViewEnvironments> view_environments(const ViewRequest& request, const Target& target,
                                                   double range_m,
                                                   std::span<const std::uint32_t> conditions,
                                                   const std::vector<double>& node_um) {
  ViewEnvironments out;
  out.condition.resize(request.condition.size());
  if (request.environment == nullptr) {
    for (const std::uint32_t c : conditions)
      out.condition[c] = plain_environment(request.condition[c], request.air, range_m,
                                           sun_shines(request.condition[c]), node_um);
    return out;
  }
  const Viewpoint& v = request.viewpoint;
  const Vec<Body> towards = body_from_aspect(v.aspect_azimuth_deg, v.aspect_elevation_deg);
  // Lines of sight leave the target downwards where the sensor is above it: between the elevations
  // of the target's lowest and highest point, as the sensor sees them.
  const double elevation = v.aspect_elevation_deg * std::numbers::pi / 180,
               reach =
                   std::asin(std::min(1.0, (length(target.centre) + target.radius_m) / range_m)),
               least = elevation - reach, most = std::min(elevation + reach, std::numbers::pi / 2);
  const auto side = [](double from, double to) {
    return to > 0 ? behind_rings(std::sin(std::max(from, 0.0)), std::sin(to))
                  : std::vector<float>{0.0f};
  };
  out.behind = DirectionNodes(side(-most, std::min(-least, std::numbers::pi / 2)),
                              side(least, most), 1, std::atan2(-towards.y, -towards.x));
  out.directions = request.environment->nodes();
  auto views =
      request.environment->view({range_m, v.aspect_elevation_deg, towards, out.behind}, conditions);
  if (!views.ok()) return views.status();
  for (std::size_t i = 0; i < conditions.size(); ++i)
    out.condition[conditions[i]] = std::move((*views)[i]);
  return out;
}

Pass::Pass(const Simulator& simulator, const ViewRequest& request, const AimedView& view,
           const ViewEnvironments& environments, std::span<const std::uint32_t> conditions,
           std::span<const std::uint32_t> bands, const std::vector<double>& node_um,
           const std::vector<std::size_t>& band_offset, std::uint64_t seed)
    : simulator_(simulator),
      request_(request),
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
    if (sun_shines(condition)) {
      const SunDirection sun{condition.sun_direction,
                             condition.sun_angular_radius_deg * std::numbers::pi / 180, 0,
                             condition.sea_wind_m_s};
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
                          classes_, sun_of_condition[i], node_um);
  unseen_sun_ = unseen_sun(simulator.target(), simulator.carried_materials(), view.frame,
                           view.range_m, suns_);
}

void Pass::run(std::uint64_t samples, std::uint64_t stage, Kind kind) {
  const auto& grids = simulator_.band_grids();
  PathSettings settings;
  settings.max_reflections = request_.max_reflections;
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
  plan_ = kind == Kind::kStoredWithPictures ? image_plan(tracer) : ImagePlan{};
  image_.assign(static_cast<std::size_t>(plan_.width_px) * plan_.height_px * plan_.padded, 0.0);
  counts_ = {};
  beyond_m2_ = {};
  basis_w_sr_.assign(rows(), 0.0);
  samples_ = samples;
  statistics_.clear();
  last_ = ReplicateStatistics(rows());

  const std::vector<PathWeights> weights = tracer.trace(plan_, image_, counts_);
  const double inverse_replicates = 1.0 / request_.accuracy.replicates;
  std::vector<RowWeights> summed;
  std::vector<double> last(rows());
  for (const PathWeights& w : weights) {
    for (std::size_t k = 0; k < 3; ++k) beyond_m2_[k] += inverse_replicates * w.beyond_m2[k];
    summed.push_back(row_weights(w.weight, classes_, tracer.nodes()));
    if (!w.last.empty()) {
      const RowWeights of_last = row_weights(w.last, classes_, tracer.nodes());
      for (std::size_t row = 0; row < rows(); ++row)
        last[row] = shading(row).in_band_w_sr(of_last, in_band_[row]);
    }
    last_.add(last);
  }
  std::vector<std::vector<double>> values;
  for (std::size_t row = 0; row < rows(); ++row) {
    const std::uint32_t b = bands_[row % bands_.size()];
    shading(row).evaluate(weights, summed, basis, grids[b], band_offset_[b], kind != Kind::kPilot,
                          values);
    ReplicateStatistics& s = statistics_.emplace_back(values.front().size());
    for (const std::vector<double>& of_replicate : values) s.add(of_replicate);
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
  double brightest = shading.brightest_thermal_w_m2_sr(grid, offset);
  if (const int j = shading.sun_index(); j >= 0)
    brightest +=
        shading.sun_w_m2(grid, offset) * unseen_sun_[static_cast<std::size_t>(j)].brightest_per_sr;
  const ViewEnvironment& environment = shading.environment();
  const auto cause = [&](Cause which) {
    return std::abs(statistics_[row].estimate(1 + static_cast<std::size_t>(which)).value);
  };
  return {truncation_bound(beyond_m2_, beyond_spacing(request_.max_reflections),
                           last_.estimate(row), beyond_m2_[2] * brightest),
          std::abs(statistics_[row].estimate(0).value) *
              quadrature_relative_bound(simulator_.bands()[b], grid,
                                        std::clamp(coldest, 1.0, hottest), hottest),
          basis_w_sr_[row], unseen_w_sr(shading, grid, offset),
          environment.sky_interpolation * cause(Cause::kSkyReflected) +
              environment.lower_interpolation * cause(Cause::kSeaReflected)};
}

double Pass::stderr_wanted(std::size_t row, double relative_error) const {
  const Bounds b = bounds(row);
  // What is unseen is met, or ruled out, by more samples.
  const double bias = (b.sum() - b.unseen) / std::sqrt(3.0);
  const double goal = relative_error * std::abs(statistics_[row].estimate(0).value);
  return bias < 0.8 * goal ? std::sqrt(goal * goal - bias * bias) : 0.6 * goal;
}

// Rare bright events that were met too seldom for the standard error to know them.
// (docs/methods.md)
double Pass::unseen_w_sr(const ConditionShading& shading, const BandGrid& grid,
                         std::size_t offset) const {
  if (request_.max_reflections == 0) return 0;
  const double n = static_cast<double>(samples_) * request_.accuracy.replicates;
  // What one event among all primary samples would be worth, per unit radiance. [m2]
  const double none_seen_m2 =
      view_.stratum.front().empty() ? 0 : kNoneSeen / n * view_.stratum.front().area_m2();
  double sum = 0;
  // A hot part: roulette makes an aimed ray stand for up to 1 / kFaintHot others.
  for (std::uint32_t p = 0; p < classes_.parts; ++p)
    if (simulator_.target().part[p].hot)
      sum = std::max(sum, kFaintHot * none_seen_m2 * shading.part_w_m2_sr(p, grid, offset));
  if (shading.sun_index() < 0) return sum;
  const auto j = static_cast<std::size_t>(shading.sun_index());
  const UnseenSun& unseen = unseen_sun_[j];
  double per_irradiance = 0;
  if (counts_.sun_met_first[j] < kSeenOften) per_irradiance += unseen.glint;
  if (request_.max_reflections >= 2 && counts_.sun_met_later[j] < kSeenOften) {
    per_irradiance += unseen.caustic;
    if (counts_.bright_to_bright > 0) per_irradiance += none_seen_m2 * unseen.chain_per_sr;
  }
  return sum + per_irradiance * shading.sun_w_m2(grid, offset);
}

ImagePlan Pass::image_plan(const PathTracer& tracer) const {
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
