#include "core/signature/pass.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "core/accuracy/replicates.h"
#include "core/base/ordered_dot.h"
#include "core/base/sobol.h"
#include "core/spectral/solar.h"

namespace irsig {

namespace {

// From this slope on lobes are as wide as those over which the environment took the mean of its
// interpolation errors (SunLight::Sky::interpolation).
constexpr double kWideLobeSlope = 0.15;

// Returns the corners of a mean place: {near, high} each.
std::array<std::array<double, 2>, 4> place_corners(const MeanPlace& place) {
  return {{{place.near.low, place.high.low},
           {place.near.low, place.high.high},
           {place.near.high, place.high.low},
           {place.near.high, place.high.high}}};
}

// Returns what the air changes at the corners of a mean place.
//   end  [3] of target_ends()
std::vector<IncidentRadiance::AirChange> changes_at(
    std::span<const IncidentRadiance::AirChange> end, const MeanPlace& place) {
  std::vector<IncidentRadiance::AirChange> out;
  for (const auto& [near, high] : place_corners(place)) {
    const auto between = [&](std::vector<double> IncidentRadiance::AirChange::*of) {
      const std::vector<double>&top = end[0].*of, &below = end[1].*of, &far = end[2].*of;
      std::vector<double> sum(far);
      for (std::size_t i = 0; i < sum.size(); ++i)
        sum[i] += near * (below[i] - far[i]) + high * (top[i] - below[i]);
      return sum;
    };
    out.push_back({between(&IncidentRadiance::AirChange::transmittance),
                   between(&IncidentRadiance::AirChange::path_thermal),
                   between(&IncidentRadiance::AirChange::path_solar)});
  }
  return out;
}

}  // namespace

Pass::Pass(const PreparedScene& scene, const ViewRequest& request, const ViewPlan& plan,
           std::shared_ptr<const PreparedView> view, Rows rows, std::uint64_t seed)
    : scene_(scene),
      accuracy_(request.accuracy),
      allowed_reflections_(request.max_reflections),
      plan_(plan),
      view_(std::move(view)),
      rows_(std::move(rows)),
      seed_(seed),
      sources_({.condition = request.condition,
                .wanted = rows_.condition,
                .parts = scene.target.part.size(),
                .surface_z_m = scene.surface_z_m(),
                .emitters = request.emitters},
               plan.effects, {view_, &view_->environments}, scene.axis.node_um()) {
  unseen_ = view_->unseen;
  if (unseen_ == nullptr)
    unseen_ = std::make_shared<const UndersampledSources>(
        scene.target, scene.places, scene.carried_material(), view_->aimed->frame);
  const AimedView& aimed = *view_->aimed;
  turned_ = turned_areas(scene.target, -1.0 * aimed.frame.forward);
  if (!aimed.bright.none()) {
    unseen_of_ = unseen_->by_stratum(aimed, sources_.geometry().sun);
    parts_of_.assign(aimed.stratum.size(), std::vector<bool>(scene.target.part.size(), false));
    for (std::uint32_t f = 0; f < scene.target.facet.size(); ++f) {
      const std::uint32_t part = scene.target.facet[f].part;
      parts_of_[aimed.stratum_of(f, part)][part] = true;
    }
  }
  for (const SunDirection& sun : sources_.geometry().sun)
    glitter_.push_back(brightest_glitter(sun));
  std::map<std::array<double, 3>, double> quadrature;  // conditions often share temperatures
  for (std::size_t row = 0; row < this->rows(); ++row) {
    const BandOnAxis band = axis_band(row);
    const double coldest_k = light(row).coldest_k(), hottest_k = light(row).hottest_k();
    const auto [known, fresh] =
        quadrature.try_emplace({static_cast<double>(band_of(row)), coldest_k, hottest_k}, 0.0);
    if (fresh)
      known->second =
          quadrature_relative_bound(scene_.band[band_of(row)], band.grid, coldest_k, hottest_k);
    quadrature_relative_.push_back(known->second);
    in_band_.push_back(
        source_table(light(row), scene_.path_basis(), band.first_node, band.grid.band_weight));
    std::vector<InBandLight::Radiance>& of_suns = glitter_w_m2_sr_.emplace_back();
    for (const LitSun& sun : light(row).suns()) of_suns.push_back(find_glitter_w_m2_sr(row, sun));
    brightest_thermal_.push_back(light(row).brightest_thermal_w_m2_sr(band));
    brightest_.push_back(find_brightest_w_m2_sr(row, request));
    in_band_light_.push_back(in_band_light(row));
    if (!unseen_of_.empty()) sent_.push_back(sent_by_parts(row));
  }
}

PathSettings Pass::settings(std::uint64_t samples, std::uint64_t stage) const {
  return path_settings(accuracy_, plan_.effects, seed_ + stage, samples);
}

PathSettings path_settings(const AccuracySpec& accuracy, const EffectSet& effects,
                           std::uint64_t seed, std::uint64_t samples) {
  PathSettings settings;
  settings.max_reflections = effects.max_reflections;
  settings.skip_self_intersection = effects.skip_self_intersection;
  settings.hot_lights = !effects.skip_self_intersection;
  settings.seed = mix64(seed);
  settings.samples = samples;
  settings.replicates = accuracy.replicates;
  // Where the error is to be small, reflections set it. Variance x CPU time of the mid-wave row of
  // a sunlit frigate with hot parts, relative to a roulette_survival_scale and a split of 1:
  //     roulette_survival_scale, split    1, 2    2, 2    4, 2    4, 1   16, 1
  //     hull                  0.71    0.49    0.46    0.51    0.45
  //     diffuse, rho = 0.8    0.91    0.66    0.53    0.96    0.96
  //     hull_paper            0.87    0.61    0.63    0.80    0.80
  // (4, 2) gains nothing more where the pilots are most of the work. Where the number of paths is
  // asked for, each stays one path.
  const bool asked = accuracy.relative_error > 0;
  settings.roulette_survival_scale = asked ? 2 : 1;
  settings.split = asked ? 2 : 1;
  return settings;
}

void Pass::run(std::uint64_t samples, std::uint64_t stage, Kind kind, const PictureFrame& pictures,
               std::vector<PathWeights>* kept) {
  const PathTracer tracer(scene_.target, scene_.carried_material(), *view_->aimed,
                          sources_.geometry(), settings(samples, stage));
  image_plan_ = plan_images(pictures, tracer.layout());
  image_.assign(image_plan_.size(), 0.0);
  counts_ = {};
  samples_ = samples;
  std::vector<PathWeights> weights = tracer.trace(image_plan_, image_, counts_);
  collect(weights, kind);
  if (kept != nullptr) *kept = std::move(weights);
}

void Pass::run_stratum(std::uint32_t stratum, std::uint64_t samples, std::uint64_t stage) {
  PathSettings settings = this->settings(samples, stage);
  settings.only_stratum = stratum;
  const PathTracer tracer(scene_.target, scene_.carried_material(), *view_->aimed,
                          sources_.geometry(), settings);
  counts_ = {};
  samples_ = samples;
  std::vector<double> none;
  collect(tracer.trace({}, none, counts_), Kind::kPilot);
}

// What is kept of a run's weights.
void Pass::collect(std::span<const PathWeights> weights, Kind kind) {
  const std::size_t parts = scene_.target.part.size();
  beyond_m2_ = {};
  front_area_m2_ = background_area_m2_ = 0;
  statistics_.clear();
  last_ = ReplicateStatistics(rows());
  beyond_ = ReplicateStatistics(plan_.effects.max_reflections + 1);
  const double inverse_replicates = 1.0 / accuracy_.replicates;
  std::vector<double> last(rows());
  for (const PathWeights& w : weights) {
    for (std::size_t k = 0; k < 3; ++k) beyond_m2_[k] += inverse_replicates * w.beyond_m2[k];
    beyond_.add(w.beyond_order_m2);
    front_area_m2_ += inverse_replicates * w.projected_area_m2;
    background_area_m2_ += inverse_replicates * w.background_area_m2;
    if (!w.last.empty()) {
      SummedWeights of_last;
      for (std::size_t row = 0; row < rows(); ++row) {
        if (row == 0 || (light(row).by_element() && row % rows_.band.size() == 0))
          of_last = summed_light(light(row), w.last, parts);
        last[row] = in_band_w_sr(light(row), of_last, in_band_[row]);
      }
    }
    last_.add(last);
  }
  replicate_.assign(rows(), {});
  modes_.clear();
  for (auto* list : {&basis_w_sr_, &sky_w_sr_, &depth_w_sr_, &background_bound_w_sr_,
                     &background_model_w_sr_, &temperature_w_sr_, &temperature_apparent_w_sr_})
    list->assign(rows(), 0.0);
  const SpectralBasis* basis = scene_.path_basis();
  std::vector<std::vector<double>> values;
  std::optional<LitWeights> lit;  // of a condition; without temperatures by element: of all
  SummedWeights mean;
  std::vector<double> largest;
  std::optional<SeenPlaces> places;
  for (std::size_t row = 0; row < rows(); ++row) {
    if (!lit || (light(row).by_element() && row % rows_.band.size() == 0)) {
      lit.emplace(light(row), weights, parts);
      mean = lit->mean();
      if (basis != nullptr && !basis->identity()) largest = largest_on_nodes(mean, *basis);
    }
    evaluate(light(row), parts, *lit, basis, axis_band(row), in_band_[row], kind != Kind::kPilot,
             values);
    ReplicateStatistics& s = statistics_.emplace_back(values.front().size());
    for (const std::vector<double>& of_replicate : values) {
      s.add(of_replicate);
      replicate_[row][0].push_back(of_replicate[0]);
      replicate_[row][1].push_back(of_replicate[kApparentQuantity]);
      replicate_[row][2].push_back(of_replicate[contrast_quantity(parts)]);
    }
    if (kind != Kind::kPilot) modes_.push_back(modes_of(row, values));
    basis_w_sr_[row] = basis_error(row, largest);
    sky_w_sr_[row] = sky_error(row, mean);
    if (row % rows_.band.size() == 0) find_temperature_errors(row / rows_.band.size(), weights);
    if (kind == Kind::kPilot) continue;
    if (row == 0) find_energy(weights, lit->sums());
    find_background_errors(row, lit->sums());
    if (light(row).environment().end.empty()) continue;
    if (!places)
      places.emplace(scene_.target, scene_.carried_material(), *view_->aimed,
                     sources_.geometry().emitters, plane_of(sources_.geometry().boundary));
    depth_w_sr_[row] = depth_error(row, mean, *places);
  }
}

std::array<SpectralSet, 3> Pass::modes_of(std::size_t row,
                                          const std::vector<std::vector<double>>& values) const {
  const std::size_t bins = axis_band(row).grid.lambda_um.size();
  constexpr std::array<std::size_t, 3> kSpectrum = {0, 1 + kCauses, 2 + kCauses};
  std::array<SpectralSet, 3> out;
  for (std::size_t what = 0; what < out.size(); ++what) {
    SpectralSet replicate;
    for (const std::vector<double>& of_replicate : values) {
      const auto first = of_replicate.begin() +
                         static_cast<std::ptrdiff_t>(spectrum_quantity(scene_.target.part.size()) +
                                                     kSpectrum[what] * bins);
      replicate.emplace_back(first, first + static_cast<std::ptrdiff_t>(bins));
    }
    out[what] = leading_modes(deviations(replicate), stored_modes(bins));
  }
  return out;
}

// Of the nodes between those that paths carry, and of temperatures between blackbodies.
double Pass::basis_error(std::size_t row, const std::vector<double>& largest) const {
  const ConditionSources& light = this->light(row);
  double out = 0;
  if (!largest.empty())
    out =
        scene_.path_basis()->relative_error * largest_in_band_w_sr(light, largest, axis_band(row));
  if (!light.by_element()) return out;
  const ReplicateStatistics& s = statistics_[row];
  const auto cause = [&](Cause which) {
    return std::abs(s.estimate(1 + static_cast<std::size_t>(which)).value);
  };
  const double shortest_um = scene_.axis.node_um()[axis_band(row).first_node];
  return out + light.emission_error(shortest_um) *
                   (cause(Cause::kEmitted) + cause(Cause::kPartsReflected));
}

// By how much more the target would emit if all its temperatures were as much higher as they may
// be wrong.
void Pass::find_temperature_errors(std::size_t condition, std::span<const PathWeights> weights) {
  const std::size_t first_row = condition * rows_.band.size();
  const ConditionSources& light = this->light(first_row);
  if (!light.has_temperature_errors()) return;
  for (const PathWeights& w : weights) {
    if (const auto e = light.unknown_emitter(w.weight, scene_.target.part.size());
        e && !unknown_seen_)
      unknown_seen_ = {rows_.condition[condition], *e};
    const SummedWeights change = light.temperature_errors(w.weight, scene_.target.part.size());
    for (std::size_t row = first_row; row < first_row + rows_.band.size(); ++row) {
      const SourceTable& table = in_band_[row];
      for (const SourceId id : light.layout().all_emitted())
        for (std::size_t k = 0; k < table.columns; ++k) {
          const double share = change.row(id)[table.first_column + k] / accuracy_.replicates;
          temperature_w_sr_[row] += share * table.row(id)[k];
          temperature_apparent_w_sr_[row] +=
              share * table.apparent[index_of(id) * table.columns + k];
        }
    }
  }
}

// Of sky and sea between their nodes: where paths went to, whatever reflected them there. Lobes
// that are wide see the mean over many cells, whose errors partly cancel.
double Pass::sky_error(std::size_t row, const SummedWeights& mean) const {
  const bool wide = std::all_of(
      scene_.material.begin(), scene_.material.end(),
      [](const Material& m) { return static_cast<double>(m.narrowest_slope()) >= kWideLobeSlope; });
  const SourceLayout& layout = sources_.layout();
  const ConditionSources& light = this->light(row);
  const ViewEnvironment& environment = light.environment();
  const auto of_side = [&](SourceRange nodes, double relative, Cause cause) {
    const double each = interpolation_w_sr(in_band_[row], nodes, layout, mean);
    const double lobes =
        relative * std::abs(statistics_[row].estimate(1 + static_cast<std::size_t>(cause)).value);
    return wide ? std::min(each, lobes) : each;
  };
  return of_side(layout.sky(), environment.sky_interpolation, Cause::kSkyReflected) +
         of_side(layout.lower(), environment.lower_interpolation, Cause::kSeaReflected);
}

// The air is that in front of one place of the target. In front of another all that is added up to
// the apparent radiance, sum_s w_s R_s T + P with sum_s w_s = 1 but for the sun, changes by
//   | sum_s w_s (R_s dT + dP) |  <=  sum_s w_s |R_s dT + dP|,
// where dT and dP are linear between those of the target's ends, and the light of a source leaves
// the target in mean at a known place between them. (docs/explanation/methods.md)
double Pass::depth_error(std::size_t row, const SummedWeights& mean,
                         const SeenPlaces& places) const {
  const SourceLayout& layout = sources_.layout();
  const std::size_t n = scene_.axis.node_um().size();
  const ConditionSources& light = this->light(row);
  const ViewEnvironment& e = light.environment();
  const BandOnAxis band = axis_band(row);
  const SpectralBasis* basis = scene_.path_basis();
  std::vector<double> most(n);
  const std::size_t columns = mean.columns;
  const double* of_nodes = mean.row(layout.first_sky());
  const IncidentRadiance& around = light.around();
  const std::vector<IncidentRadiance::AirChange> of_reflected =
      changes_at(e.end_change, places.reflected());
  double sum = basis == nullptr
                   ? around.changed(of_reflected, band.first_node, band.grid.band_weight,
                                    {of_nodes, around.count()})
                   : around.changed(of_reflected, band.first_node, band.grid.band_weight,
                                    [&](std::uint32_t node, std::span<double> w) {
                                      const double* of_node = of_nodes + node * columns;
                                      if (std::all_of(of_node, of_node + columns,
                                                      [](double x) { return x == 0; }))
                                        return false;
                                      basis->to_nodes(of_node, band.first_node, w);
                                      return true;
                                    });
  const auto add = [&](SourceId id, const MeanPlace& place, bool radiance) {
    const std::span<const double> of_source = light.radiance(id);
    const auto corner = place_corners(place);
    for (std::size_t i = band.first_node; i < band.first_node + band.nodes(); ++i) {
      const auto change = [&](const AirPath& end) {
        return of_source[i] * (end.transmittance[i] - e.transmittance[i]) +
               (radiance ? end.path_radiance_w_m2_sr_um[i] - e.path_radiance[i] : 0);
      };
      const double top = change(e.end[0]), below = change(e.end[1]), far = change(e.end[2]);
      most[i] = 0;
      for (const auto& [near, high] : corner)
        most[i] = std::max(most[i], std::abs(far + near * (below - far) + high * (top - below)));
    }
    sum += nodes_w_sr(most, scene_.path_basis(), band, mean.row(id));
  };
  for (const SourceId id : layout.emitted())
    add(id, light.by_element() ? places.any_emitted() : places.emitted(index_of(id)), true);
  for (const SourceId id : layout.all_emitted())
    if (!layout.emitted().contains(id)) add(id, places.reflected(), true);
  for (const auto& of_cause : light.causes())
    for (const SourceRange range : of_cause)
      for (const SourceId id : range)
        if (!layout.without_sun().contains(id)) add(id, places.reflected(), false);
  // Of the silhouette from which nothing is known to come.
  const BandGrid& grid = band.grid;
  double weighed = 0, width_um = 0, lost = 0;
  const SourceTable unit = unit_table(basis, band.first_node, grid.band_weight);
  for (const double w : grid.band_weight) width_um += w;
  for (const SourceId id : layout.without_sun())
    weighed +=
        width_um * ordered_dot(unit.source.data(), mean.row(id) + unit.first_column, unit.columns);
  for (std::size_t i = 0; i < band.nodes(); ++i) {
    double change = 0;
    for (const AirPath& end : e.end)
      change = std::max(change, std::abs(end.path_radiance_w_m2_sr_um[band.first_node + i] -
                                         e.path_radiance[band.first_node + i]));
    lost += grid.band_weight[i] * change;
  }
  if (width_um > 0) sum += std::abs(front_area_m2_ - weighed / width_um) * lost;
  return sum;
}

// What stands behind the silhouette, in the directions in which it does.
void Pass::find_background_errors(std::size_t row, std::span<const SummedWeights> sums) {
  const ViewEnvironment& e = light(row).environment();
  if (e.background_interpolation.empty()) return;
  std::size_t node = 0;
  for (const SourceId id : sources_.layout().behind()) {
    // Nothing of the target's materials is in these weights: they are the same at each node.
    double area_m2 = 0;
    for (const SummedWeights& s : sums) area_m2 += s.row(id)[0];
    area_m2 /= accuracy_.replicates;
    background_bound_w_sr_[row] +=
        area_m2 * in_band(e.background_interpolation[node], axis_band(row));
    background_model_w_sr_[row] +=
        area_m2 * in_band(e.background_model_error[node], axis_band(row));
    ++node;
  }
}

// By reciprocity: what of the light that the sensor would send out ends where.
void Pass::find_energy(std::span<const PathWeights> weights, std::span<const SummedWeights> sums) {
  energy_.clear();
  for (const std::uint32_t b : rows_.band) {
    const BandOnAxis band = scene_.axis.band(b);
    const SourceTable unit =
        unit_table(scene_.path_basis(), band.first_node, band.grid.band_weight);
    ReplicateStatistics s(5);
    for (std::size_t r = 0; r < weights.size(); ++r) {
      const double area = weights[r].projected_area_m2;
      if (!(area > 0)) continue;
      const Shares share = shares(sums[r], sources_.layout(), unit);
      const double cut = weights[r].truncated_m2;
      s.add(std::array{share.absorbed / area, share.sky / area, share.lower / area, cut / area,
                       (share.absorbed + share.sky + share.lower + cut) / area});
    }
    energy_.push_back({s.estimate(0), s.estimate(1), s.estimate(2), s.estimate(3), s.estimate(4)});
  }
}

double Pass::sun_quadrature_w_sr(std::size_t row) const {
  const ReplicateStatistics& s = statistics_[row];
  const SolarQuadrature& error = scene_.sun_quadrature[band_of(row)];
  constexpr auto kSun = static_cast<std::size_t>(Cause::kSunReflected);
  // Pilots have no spectra.
  if (modes_.empty()) return error.of_white * std::abs(s.estimate(1 + kSun).value);
  const BandGrid& grid = axis_band(row).grid;
  const std::size_t bins = grid.lambda_um.size(),
                    first = spectrum_quantity(scene_.target.part.size()) + (1 + kSun) * bins;
  double sum = 0;
  for (std::size_t k = 0; k < bins; ++k) {
    double width_um = 0;
    for (std::size_t i = grid.bin_first[k]; i < grid.bin_first[k + 1]; ++i)
      width_um += grid.band_weight[i];
    sum += error.of_bin[k] * width_um * std::abs(s.estimate(first + k).value);
  }
  return sum;
}

Pass::MeasuredRow Pass::measured(std::size_t row) const {
  const ConditionSources& light = this->light(row);
  const ReplicateStatistics& s = statistics_[row];
  Measured all;  // what the three have in common
  const double apparent_w_sr = s.estimate(kApparentQuantity).value,
               background_w_sr =
                   apparent_w_sr - s.estimate(contrast_quantity(scene_.target.part.size())).value;
  all.of(BoundOf::kQuadrature) =
      quadrature_relative_[row] *
      std::max(std::abs(s.estimate(0).value), std::abs(apparent_w_sr) + std::abs(background_w_sr));
  // Of outlines, and of what is behind them.
  double outline_m2 = 0;
  for (std::size_t part = 0; part < turned_.size(); ++part) {
    const auto [m2, rounding_m2] = turned_[part];
    outline_m2 += rounding_m2;
    if (m2 > 0)
      all.of(BoundOf::kQuadrature) +=
          rounding_m2 / m2 * std::abs(s.estimate(part_quantity(part)).value);
  }
  if (const double seen_m2 = s.estimate(kAreaQuantity).value; seen_m2 > 0)
    all.of(BoundOf::kQuadrature) += outline_m2 / seen_m2 * std::abs(background_w_sr);
  // Of materials' tables between the corners that cut the quadrature: emission and reflection may
  // change by twice what is left out, reflectances of optical constants by four times.
  all.of(BoundOf::kQuadrature) +=
      4 * scene_.corners_left_out[band_of(row)] * s.estimate(kAreaQuantity).value *
          light.brightest_w_m2_sr(axis_band(row), brightest_thermal_[row]) +
      sun_quadrature_w_sr(row);
  all.of(BoundOf::kBasis) = basis_w_sr_[row];
  const Unseen unseen = this->unseen(row, samples_);
  all.of(BoundOf::kUnseen) = unseen.bound;
  all.of(BoundOf::kSky) = sky_w_sr_[row];
  all.of(BoundOf::kTemperature) = temperature_w_sr_[row];
  RowBounds::Bound omitted;
  if (!plan_.omitted.empty()) omitted = plan_.omitted[planned_row(row)];
  const bool left_out = plan_.effects.max_reflections < allowed_reflections_;
  // Without any reflection the plan's bounds say it all; without other parts they say the rest.
  if (!left_out || (plan_.effects.max_reflections > 0 && plan_.effects.parts)) {
    const double rest =
        truncation_bound(beyond_m2_, beyond_spacing(plan_.effects.max_reflections),
                         last_.estimate(row), beyond_m2_[2] * brightest_w_m2_sr(row));
    if (left_out) {
      omitted.source += rest;
      omitted.apparent += rest;
      omitted.contrast += rest;
    } else {
      all.of(BoundOf::kTruncation) = rest;
    }
  }
  const auto with = [&](std::size_t quantity, double omitted_w_sr, double undersampling_stderr) {
    Measured out = all;
    out.undersampling_stderr = undersampling_stderr;
    out.value = s.estimate(quantity).value;
    out.stderr_ = s.estimate(quantity).stderr_;
    out.of(BoundOf::kOmitted) = omitted_w_sr;
    return out;
  };
  Measured contrast =
      with(contrast_quantity(scene_.target.part.size()), omitted.contrast, unseen.contrast);
  if (!background_bound_w_sr_.empty())
    contrast.of(BoundOf::kBackground) = background_bound_w_sr_[row];
  Measured apparent = with(kApparentQuantity, omitted.apparent, unseen.apparent);
  if (!depth_w_sr_.empty())
    apparent.of(BoundOf::kDepth) = contrast.of(BoundOf::kDepth) = depth_w_sr_[row];
  apparent.of(BoundOf::kTemperature) = contrast.of(BoundOf::kTemperature) =
      temperature_apparent_w_sr_[row];
  return {with(0, omitted.source, unseen.source), apparent, contrast};
}

double Pass::find_brightest_w_m2_sr(std::size_t row, const ViewRequest& request) const {
  const ConditionSources& light = this->light(row);
  // What leaves a convex body does not meet it again.
  double sum = scene_.target.convex ? light.brightest_around_w_m2_sr(axis_band(row))
                                    : brightest_thermal_[row];
  for (const LitSun& sun : light.suns())
    sum += in_band(sun.irradiance, axis_band(row)) *
               unseen_->of(sources_.geometry().sun[sun.index]).brightest_per_sr +
           glitter_w_m2_sr(row, sun, false);
  // Without any reflection no sun is followed, and none is known but outside the air.
  const ConditionSpec& condition = request.condition[condition_of(row)];
  if (plan_.effects.max_reflections == 0 && allowed_reflections_ == 0 && sun_shines(condition)) {
    std::vector<double> irradiance;
    for (const double um : scene_.axis.node_um())
      irradiance.push_back(solar_irradiance_w_m2_um(um) *
                           std::max(condition.sun_scale, kNearestSun));
    sum += in_band(irradiance, axis_band(row)) *
           unseen_
               ->of({condition.sun_direction,
                     condition.sun_angular_radius_deg * std::numbers::pi / 180, 0, 0})
               .brightest_per_sr;
  }
  return sum;
}

Estimate Pass::beyond_m2(std::uint32_t reflections) const { return beyond_.estimate(reflections); }

double Pass::beyond_limit_m2(std::uint32_t reflections) const {
  const Estimate e = beyond_m2(reflections);
  double none_seen_m2 = 0;
  for (std::uint32_t s = 0; s < view_->aimed->stratum.size(); ++s)
    if (!view_->aimed->stratum[s].empty())
      none_seen_m2 +=
          kNoneSeen * view_->aimed->stratum[s].area_m2() /
          (static_cast<double>(view_->aimed->samples(s, samples_)) * accuracy_.replicates);
  return e.value + 4 * e.stderr_ + none_seen_m2;
}

double Pass::absolute_floor_w_sr(std::size_t row) const {
  if (plan_.absolute_floor_w_m2_sr.empty()) return 0;
  return plan_.absolute_floor_w_m2_sr[planned_row(row)] *
         statistics_[row].estimate(kAreaQuantity).value;
}

double Pass::relative_goal_w_sr(std::size_t row) const {
  return accuracy_.relative_error * std::abs(statistics_[row].estimate(0).value);
}

double Pass::goal_w_sr(std::size_t row) const {
  // Nothing is an answer, too: of a plate seen edge on, against what it would send broadside.
  constexpr double kNothing = 1e-9;
  const double of_nothing = statistics_[row].estimate(0).value == 0
                                ? kNothing * std::numbers::pi * scene_.target.radius_m *
                                      scene_.target.radius_m * brightest_thermal_[row]
                                : 0;
  return std::max({relative_goal_w_sr(row), absolute_floor_w_sr(row), of_nothing});
}

double Pass::backface_fraction() const {
  return background_area_m2_ > 0 ? background_area_m2_ / (front_area_m2_ + background_area_m2_) : 0;
}

double Pass::error_wanted(std::size_t row) const {
  const Measured source = measured(row).source;
  return irsig::stderr_wanted(goal_w_sr(row), source.bias_bound() - source.of(BoundOf::kUnseen));
}

ImagePlan Pass::plan_images(const PictureFrame& pictures, const SourceLayout& paths) const {
  ImagePlan plan =
      blank_pictures(pictures, view_->aimed->frame, rows(), 1, paths, scene_.path_basis());
  for (std::uint32_t k = 0; k < plan.images; ++k)
    show_sources(in_band_[k], light(k), paths, scene_.path_basis(), k, 0, plan);
  return plan;
}

}  // namespace irsig
