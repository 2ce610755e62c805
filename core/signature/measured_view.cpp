#include "core/signature/measured_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/accuracy/replicates.h"
#include "core/signature/row_bounds/row_bounds.h"
#include "core/signature/view_seed.h"

namespace irsig {
namespace {

// Fraction of the wanted error: light that is bounded by less is not worth rays of its own.
constexpr double kBoundedOfFacets = 0.1;

// Returns the leading modes of the errors of the three intensities' spectra.
std::array<SpectralSet, kIntensities> modes_of(std::span<const RowTally> tally) {
  const std::size_t bins = tally.front().total_spectrum.size();
  std::array<SpectralSet, kIntensities> out;
  constexpr std::array kSpectrum = {&RowTally::total_spectrum, &RowTally::apparent_spectrum,
                                    &RowTally::contrast_spectrum};
  for (std::size_t which = 0; which < out.size(); ++which) {
    SpectralSet replicate;
    for (const RowTally& of_replicate : tally) replicate.push_back(of_replicate.*kSpectrum[which]);
    out[which] = leading_modes(deviations(replicate), stored_modes(bins));
  }
  return out;
}

// Finds for each band where light that the sensor would send out ends, by reciprocity.
std::vector<EnergyLedger> energy_of(const ViewSetup& setup, std::span<const PathWeights> weights,
                                    std::span<const SummedWeights> sums) {
  std::vector<EnergyLedger> out;
  for (const std::uint32_t b : setup.keys.band) {
    const BandOnAxis band = setup.scene.axis.band(b);
    const SourceTable unit =
        unit_table(setup.scene.path_basis(), band.first_node, band.grid.band_weight);
    ReplicateStatistics s(5);
    for (std::size_t r = 0; r < weights.size(); ++r) {
      const double area = weights[r].projected_area_m2;
      if (!(area > 0)) continue;
      const Shares of = shares(sums[r], setup.sources.layout(), unit);
      const double cut = weights[r].truncated_m2;
      s.add(std::array{of.absorbed / area, of.sky / area, of.lower / area, cut / area,
                       (of.absorbed + of.sky + of.lower + cut) / area});
    }
    out.push_back({s.estimate(0), s.estimate(1), s.estimate(2), s.estimate(3), s.estimate(4)});
  }
  return out;
}

// Adds up what the weights of all rows together give, and each row's paths of the last order.
void add_totals(std::span<const PathWeights> weights, MeasuredView& view) {
  const ViewSetup& setup = view.setup;
  const std::size_t bands = setup.keys.band.size();
  RunTotals& totals = view.totals;
  totals.beyond_m2 = {};
  totals.front_area_m2 = totals.back_area_m2 = totals.hidden_area_m2 = 0;
  totals.beyond = ReplicateStatistics(setup.plan.effects.max_reflections + 1);
  ReplicateStatistics last_order(view.row.size());
  const double inverse_replicates = 1.0 / setup.accuracy.replicates;
  std::vector<double> last(view.row.size());
  for (const PathWeights& w : weights) {
    for (std::size_t k = 0; k < 3; ++k) totals.beyond_m2[k] += inverse_replicates * w.beyond_m2[k];
    totals.beyond.add(w.beyond_order_m2);
    totals.front_area_m2 += inverse_replicates * w.projected_area_m2;
    totals.back_area_m2 += inverse_replicates * w.background_area_m2;
    totals.hidden_area_m2 += inverse_replicates * w.hidden_area_m2;
    if (!w.last.empty()) {
      SummedWeights of_last;
      for (std::size_t k = 0; k < view.row.size(); ++k) {
        const Row& row = view.row[k];
        if (k == 0 || (row.light->converts() && k % bands == 0))
          of_last = summed_light(*row.light, w.last, setup.parts());
        last[k] = in_band_w_sr(*row.light, of_last, row.in_band);
      }
    }
    last_order.add(last);
  }
  for (std::size_t k = 0; k < view.row.size(); ++k) view.row[k].last_order = last_order.estimate(k);
}

// Returns how the emission of a condition changes if its temperatures are wrong, by replicate.
std::vector<SummedWeights> temperature_changes(const ViewSetup& setup, const Row& row,
                                               std::span<const PathWeights> weights,
                                               std::optional<UnknownSeen>& unknown) {
  std::vector<SummedWeights> out;
  if (!row.light->has_temperature_errors()) return out;
  for (const PathWeights& w : weights) {
    if (const auto e = row.light->unknown_emitter(w.weight, setup.parts()); e && !unknown)
      unknown = {row.condition, *e};
    out.push_back(row.light->temperature_errors(w.weight, setup.parts()));
  }
  return out;
}

// Fills the rows with what a run's weights give.
void collect(std::span<const PathWeights> weights, RunKind kind, MeasuredView& view) {
  const ViewSetup& setup = view.setup;
  const bool stored = kind == RunKind::kStored;
  const std::size_t bands = setup.keys.band.size();
  add_totals(weights, view);
  const SpectralBasis* basis = setup.scene.path_basis();
  std::vector<RowTally> tally;
  std::optional<LitWeights> lit;  // of a condition; without temperatures by element: of all
  SummedWeights mean;
  std::vector<double> largest;
  std::vector<SummedWeights> changes;
  std::optional<SeenPlaces> places;
  for (std::size_t k = 0; k < view.row.size(); ++k) {
    Row& row = view.row[k];
    const ConditionSources& light = *row.light;
    if (!lit || (light.converts() && k % bands == 0)) {
      lit.emplace(light, weights, setup.parts());
      mean = lit->mean();
      if (basis != nullptr && !basis->identity()) largest = largest_on_nodes(mean, *basis);
    }
    if (k % bands == 0)
      changes = temperature_changes(setup, row, weights, view.totals.unknown_seen);
    tally_row(light, setup.parts(), *lit, basis, row.on_axis, row.in_band, stored, tally);
    row.estimate = estimates_of(tally);
    row.replicate = {};
    for (const RowTally& of_replicate : tally) {
      row.replicate[0].push_back(of_replicate.total);
      row.replicate[1].push_back(of_replicate.apparent);
      row.replicate[2].push_back(of_replicate.contrast);
    }
    row.modes = stored ? modes_of(tally) : std::array<SpectralSet, kIntensities>{};
    if (stored && k == 0) view.totals.energy = energy_of(setup, weights, lit->sums());
    if (stored && !places && !light.environment().end.empty())
      places.emplace(setup.scene.target, setup.scene.carried_material(), setup.aimed(),
                     setup.sources.geometry().emitters,
                     plane_of(setup.sources.geometry().boundary));
    set_bounds_of_weights({setup, row, *lit, mean, largest, changes, places ? &*places : nullptr,
                           view.totals.front_area_m2},
                          stored, row);
  }
}

PathSettings settings_of(const ViewSetup& setup, std::uint64_t samples, std::uint64_t stage) {
  return path_settings(setup.accuracy, setup.plan.effects, setup.seed + stage, samples);
}

// Runs the view with these settings, and returns the weights.
std::vector<PathWeights> run(MeasuredView& view, const PathSettings& settings, RunKind kind) {
  TracedView traced =
      trace_view(view.setup.scene, view.setup.aimed(), view.setup.sources.geometry(), settings);
  view.totals.samples = settings.samples;
  view.totals.counts = traced.counts;
  collect(traced.weights, kind, view);
  return std::move(traced.weights);
}

}  // namespace

void run_view(MeasuredView& view, std::uint64_t samples, std::uint64_t stage, RunKind kind,
              std::vector<PathWeights>* kept) {
  std::vector<PathWeights> weights = run(view, settings_of(view.setup, samples, stage), kind);
  if (kept != nullptr) *kept = std::move(weights);
}

void run_stratum(MeasuredView& view, std::uint32_t stratum, std::uint64_t samples,
                 std::uint64_t stage) {
  PathSettings settings = settings_of(view.setup, samples, stage);
  settings.only_stratum = stratum;
  run(view, settings, RunKind::kPilot);
}

MeasuredIntensities measured(const MeasuredView& view, const Row& row) {
  const ViewSetup& setup = view.setup;
  const ViewPlan& plan = setup.plan;
  const Undersampling missed = undersampling(setup, row, view.totals.samples);
  RowBounds::Bound omitted;
  if (!plan.omitted.empty()) omitted = plan.omitted[row.planned];
  double truncation = 0;
  const bool left_out = plan.effects.max_reflections < setup.allowed_reflections;
  // Without any reflection the plan's bounds say it all; without other parts they say the rest.
  if (!left_out || (plan.effects.max_reflections > 0 && plan.effects.parts)) {
    const double rest =
        truncation_bound(view.totals.beyond_m2, beyond_spacing(plan.effects.max_reflections),
                         row.last_order, view.totals.beyond_m2[2] * row.brightest_w_m2_sr);
    if (left_out) {
      omitted.source += rest;
      omitted.apparent += rest;
      omitted.contrast += rest;
    } else {
      truncation = rest;
    }
  }
  const double quadrature = quadrature_bound_w_sr(setup, row);
  const auto with = [&](const Estimate& value, double ThreeBounds::*which, double omitted_w_sr,
                        double undersampling_stderr) {
    Measured out;
    out.value = value.value;
    out.stderr_ = value.stderr_;
    for (std::size_t b = 0; b < kBounds; ++b) out.bound[b] = row.bound[b].*which;
    out.undersampling_stderr = undersampling_stderr;
    out.of(BoundOf::kQuadrature) = quadrature;
    out.of(BoundOf::kUnseen) = missed.bound;
    out.of(BoundOf::kTruncation) = truncation;
    out.of(BoundOf::kOmitted) = omitted_w_sr;
    return out;
  };
  return {with(row.estimate.total, &ThreeBounds::source, omitted.source, missed.source),
          with(row.estimate.apparent, &ThreeBounds::apparent, omitted.apparent, missed.apparent),
          with(row.estimate.contrast, &ThreeBounds::contrast, omitted.contrast, missed.contrast)};
}

double backface_fraction(const MeasuredView& view) {
  const double back_m2 = view.totals.back_area_m2;
  return back_m2 > 0 ? back_m2 / (view.totals.front_area_m2 + back_m2) : 0;
}

double relative_goal_w_sr(const MeasuredView& view, const Row& row) {
  return view.setup.accuracy.relative_error * std::abs(row.estimate.total.value);
}

double absolute_floor_w_sr(const MeasuredView& view, const Row& row) {
  const std::vector<double>& floor = view.setup.plan.absolute_floor_w_m2_sr;
  return floor.empty() ? 0 : floor[row.planned] * row.estimate.projected_area_m2.value;
}

double goal_w_sr(const MeasuredView& view, const Row& row) {
  // Nothing is an answer, too: of a plate seen edge on, against what it would send broadside.
  constexpr double kNothing = 1e-9;
  const double radius_m = view.setup.scene.target.radius_m;
  const double of_nothing =
      row.estimate.total.value == 0
          ? kNothing * std::numbers::pi * radius_m * radius_m * row.brightest_thermal_w_m2_sr
          : 0;
  return std::max({relative_goal_w_sr(view, row), absolute_floor_w_sr(view, row), of_nothing});
}

double stderr_wanted_w_sr(const MeasuredView& view, const Row& row) {
  const Measured source = measured(view, row).source;
  return stderr_wanted(goal_w_sr(view, row), source.bias_bound() - source.of(BoundOf::kUnseen));
}

double beyond_limit_m2(const MeasuredView& view, std::uint32_t reflections) {
  const Estimate e = view.totals.beyond.estimate(reflections);
  const AimedView& aimed = view.setup.aimed();
  double none_seen_m2 = 0;
  for (std::uint32_t s = 0; s < aimed.stratum.size(); ++s)
    if (!aimed.stratum[s].empty())
      none_seen_m2 += kNoneSeen * aimed.stratum[s].area_m2() /
                      (static_cast<double>(aimed.samples(s, view.totals.samples)) *
                       view.setup.accuracy.replicates);
  return e.value + 4 * e.stderr_ + none_seen_m2;
}

std::vector<FacetBrightness> facet_brightness(const MeasuredView& view) {
  const ViewSetup& setup = view.setup;
  const EffectSet& effects = setup.plan.effects;
  if (effects.max_reflections == 0) return {};
  const UndersampledSources& from = *setup.undersampled;
  const std::vector<SunDirection>& suns = setup.sources.geometry().sun;
  // For each sun and each set of parts, the most of any row, per error that is wanted.
  std::vector<double> of_sun(suns.size(), 0.0), of_parts(from.parts_above().size(), 0.0);
  for (const Row& row : view.row) {
    const double wanted = stderr_wanted_w_sr(view, row);
    if (!(wanted > 0)) continue;
    for (const LitSun& sun : row.light->suns())
      if (sun.direct)
        of_sun[sun.index] =
            std::max(of_sun[sun.index], in_band(sun.irradiance, row.on_axis) / wanted);
    if (!setup.parts_reflected()) continue;
    const std::vector<InBandRadiance> sent = sent_by_parts(from, row.brightest.part);
    for (std::size_t k = 0; k < of_parts.size(); ++k)
      for (std::size_t p = 0; p < sent.size(); ++p)
        if (from.parts_above()[k][p])
          of_parts[k] = std::max(of_parts[k], sent[p].at_target / wanted);
  }
  std::vector<FacetBrightness> out;
  const auto look = [&](const SunDirection* sun, double scale) {
    // Light that matters less than this is bounded anyway.
    const std::vector<UndersampledSources::Facet> facets =
        from.facets(sun, scale > 0 ? kBoundedOfFacets / scale : 0);
    if (out.empty())
      for (const UndersampledSources::Facet& f : facets) out.push_back({f.facet, f.seen_m2, 0});
    for (std::size_t i = 0; i < facets.size(); ++i) {
      const UndersampledSources::Facet& f = facets[i];
      out[i].per_m2 = std::max({out[i].per_m2, scale * f.first,
                                effects.max_reflections > 1 ? scale * f.later : 0,
                                f.reflected * of_parts[f.parts]});
    }
  };
  look(nullptr, 0);
  for (std::size_t j = 0; j < suns.size(); ++j)
    if (of_sun[j] > 0) look(&suns[j], of_sun[j]);
  std::erase_if(out, [&](const FacetBrightness& b) {
    return setup.aimed().stratum_of(b.facet, setup.scene.target.facet[b.facet].part) != 0;
  });
  return out;
}

}  // namespace irsig
