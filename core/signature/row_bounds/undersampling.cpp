// Bounds light of a view that samples may not have met: of a whole view, and of strata that are
// aimed at bright facets.

#include <algorithm>
#include <cmath>

#include "core/accuracy/replicates.h"
#include "core/signature/row_bounds/row_bounds.h"

namespace irsig {
namespace {

// Returns what light of small bright sources may bring that samples of this size miss.
//   estimate  the allowance's bound is an estimate: it counts as a standard error
SmallBrightSources::Allowance allowance(const SmallBrightSources& small, double sample_m2,
                                        bool estimate) {
  SmallBrightSources::Allowance a = small.allowance(sample_m2);
  if (!estimate) return a;
  a.stderr_ = numerical_error(0, a.stderr_, a.bound);
  a.bound = 0;
  return a;
}

// The two halves of a stratum's undersampling: all of its emission is one error, of the brightest
// part.
struct OfStratum {
  Undersampling reflected, emitted;
};

OfStratum undersampling_in(const ViewSetup& setup, const Row& row, std::uint32_t stratum,
                           std::uint64_t samples) {
  const BrightestLight& known = row.brightest;
  const std::size_t parts = known.part.size();
  const double m2 = setup.sample_m2(stratum, samples);
  const UndersampledSources::Stratum& of = setup.strata[stratum];
  OfStratum out;
  for (std::size_t p = 0; p < parts; ++p) {
    if (!setup.part_in_stratum[stratum][p]) continue;
    const InBandRadiance& one = known.part[p];
    out.emitted = {
        0, std::max(out.emitted.source, 2 * m2 * one.at_target),
        std::max(out.emitted.apparent, 2 * m2 * one.at_sensor),
        std::max(out.emitted.contrast, 2 * m2 * std::max(one.at_sensor, known.behind_at_sensor))};
  }
  if (setup.plan.effects.max_reflections == 0) return out;
  const auto add = [&](const SmallBrightSources& small, bool estimate,
                       const InBandRadiance& radiance) {
    const SmallBrightSources::Allowance a = allowance(small, m2, estimate);
    Undersampling& sum = out.reflected;
    sum = {sum.bound + a.bound * radiance.at_target,
           std::hypot(sum.source, a.stderr_ * radiance.at_target),
           std::hypot(sum.apparent, a.stderr_ * radiance.at_sensor),
           std::hypot(sum.contrast, a.stderr_ * radiance.at_sensor)};
  };
  add(of.reflected, false, known.around);
  if (setup.parts_reflected()) {
    for (const UndersampledSources::Stratum::Parts& group : of.parts) {
      InBandRadiance brightest;
      for (std::size_t p = 0; p < parts; ++p)
        if (group.seen[p])
          brightest = {std::max(brightest.at_target, row.sent_by_parts[p].at_target),
                       std::max(brightest.at_sensor, row.sent_by_parts[p].at_sensor)};
      add(group.reflected, false, brightest);
    }
  }
  for (std::size_t k = 0; k < row.light->suns().size(); ++k) {
    const LitSun& sun = row.light->suns()[k];
    add(of.reflected, false, row.glitter[k]);
    if (!sun.direct) continue;
    const InBandRadiance irradiance{in_band(sun.irradiance, row.on_axis),
                                    in_band(sun.apparent, row.on_axis)};
    add(of.first[sun.index], false, irradiance);
    if (setup.plan.effects.max_reflections > 1) add(of.later[sun.index], true, irradiance);
  }
  return out;
}

Undersampling undersampling_of_strata(const ViewSetup& setup, const Row& row,
                                      std::uint64_t samples) {
  Undersampling out, emitted;
  for (std::uint32_t s = 0; s < setup.strata.size(); ++s) {
    const OfStratum in = undersampling_in(setup, row, s, setup.aimed().samples(s, samples));
    out = {out.bound + in.reflected.bound, std::hypot(out.source, in.reflected.source),
           std::hypot(out.apparent, in.reflected.apparent),
           std::hypot(out.contrast, in.reflected.contrast)};
    emitted = {0, std::max(emitted.source, in.emitted.source),
               std::max(emitted.apparent, in.emitted.apparent),
               std::max(emitted.contrast, in.emitted.contrast)};
  }
  return {out.bound, std::hypot(out.source, emitted.source),
          std::hypot(out.apparent, emitted.apparent), std::hypot(out.contrast, emitted.contrast)};
}

}  // namespace

Undersampling undersampling(const ViewSetup& setup, const Row& row, std::uint64_t samples) {
  if (!setup.strata.empty()) return undersampling_of_strata(setup, row, samples);
  const BrightestLight& known = row.brightest;
  double source = 0, apparent = 0, contrast = 0;  // variances
  Undersampling out;
  const auto square = [](double x) { return x * x; };
  // The sensor sees the parts themselves, and what stands behind them.
  double most_m2 = 0, emitted = 0, emitted_seen = 0, emitted_contrast = 0;
  for (std::size_t p = 0; p < known.part.size(); ++p) {
    const std::uint32_t s = setup.aimed().stratum_of_part[p];
    const double m2 = setup.sample_m2(s, setup.aimed().samples(s, samples));
    const InBandRadiance& one = known.part[p];
    most_m2 = std::max(most_m2, m2);
    emitted = std::max(emitted, m2 * one.at_target);
    emitted_seen = std::max(emitted_seen, m2 * one.at_sensor);
    emitted_contrast =
        std::max(emitted_contrast, m2 * std::max(one.at_sensor, known.behind_at_sensor));
  }
  source += square(2 * emitted);
  apparent += square(2 * emitted_seen);
  contrast += square(2 * emitted_contrast);
  if (setup.plan.effects.max_reflections > 0) {
    // Whatever may be reflected: parts, sky, sea, glitter. Then suns.
    const bool parts = setup.parts_reflected();
    const InBandRadiance around{
        std::max(parts ? known.any_part.at_target : 0, known.around.at_target),
        std::max(parts ? known.any_part.at_sensor : 0, known.around.at_sensor)};
    const auto add = [&](const SmallBrightSources& small, bool estimate,
                         const InBandRadiance& radiance) {
      const SmallBrightSources::Allowance a = allowance(small, most_m2, estimate);
      out.bound += a.bound * radiance.at_target;
      source += square(a.stderr_ * radiance.at_target);
      apparent += square(a.stderr_ * radiance.at_sensor);
      contrast += square(a.stderr_ * radiance.at_sensor);
    };
    add(setup.undersampled->reflected(), false, around);
    for (std::size_t k = 0; k < row.light->suns().size(); ++k) {
      const LitSun& sun = row.light->suns()[k];
      const UndersampledSources::Sun& of =
          setup.undersampled->of(setup.sources.geometry().sun[sun.index]);
      add(setup.undersampled->reflected(), false, row.glitter[k]);
      if (!sun.direct) continue;
      const InBandRadiance irradiance{in_band(sun.irradiance, row.on_axis),
                                      in_band(sun.apparent, row.on_axis)};
      add(of.first, false, irradiance);
      if (setup.plan.effects.max_reflections > 1) add(of.later, true, irradiance);
    }
  }
  out.source = std::sqrt(source);
  out.apparent = std::sqrt(apparent);
  out.contrast = std::sqrt(contrast);
  return out;
}

double undersampling_error_w_sr(const ViewSetup& setup, const Row& row, std::uint64_t samples) {
  const Undersampling of = undersampling(setup, row, samples);
  return numerical_error(0, of.source, of.bound);
}

double undersampling_error_w_sr(const ViewSetup& setup, const Row& row, std::uint32_t stratum,
                                std::uint64_t samples) {
  const OfStratum in = undersampling_in(setup, row, stratum, samples);
  return numerical_error(in.emitted.source, in.reflected.source, in.reflected.bound);
}

}  // namespace irsig
