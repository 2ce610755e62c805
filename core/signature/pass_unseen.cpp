// What of a view samples may not have met, met or not: of a whole view, and of strata that are
// aimed at what is bright.

#include <algorithm>
#include <cmath>

#include "core/accuracy/replicates.h"
#include "core/signature/pass.h"

namespace irsig {
namespace {

// Of the error that is wanted: light that is bounded by less is not worth rays of its own.
constexpr double kBoundedOfFacets = 0.1;

}  // namespace

// The sea where it mirrors the sun most.
Pass::InBandLight::Radiance Pass::find_glitter_w_m2_sr(std::size_t row, const LitSun& sun) const {
  const ConditionSources& light = this->light(row);
  std::array<InBandLight::Radiance, kGlintCosines.size()> of_node{};
  for (std::uint32_t k = 0; !glitter_[sun.index].empty() && k < of_node.size(); ++k) {
    const SourceId id = sources_.layout().glint(sun.index, k);
    of_node[k] = {in_band(light.radiance(id), axis_band(row)),
                  in_band(light.apparent(id), axis_band(row))};
  }
  InBandLight::Radiance most;
  for (const SeaGlint& glint : glitter_[sun.index]) {
    const std::size_t node = glint_fraction(glint.cos_incidence).node;
    const auto per_sr = static_cast<double>(glint.per_sr);
    for (const std::size_t k : {node, node + 1})
      most = {std::max(most.here, per_sr * of_node[k].here),
              std::max(most.seen, per_sr * of_node[k].seen)};
  }
  return most;
}

double Pass::glitter_w_m2_sr(std::size_t row, const LitSun& sun, bool apparent) const {
  const auto which = static_cast<std::size_t>(&sun - light(row).suns().data());
  const InBandLight::Radiance& most = glitter_w_m2_sr_[row][which];
  return apparent ? most.seen : most.here;
}

double Pass::unseen_error(std::size_t row, std::uint64_t samples) const {
  const Unseen of = unseen(row, samples);
  return numerical_error(0, of.source, of.bound);
}

double Pass::unseen_error(std::size_t row, std::uint32_t stratum, std::uint64_t samples) const {
  const UnseenInStratum in = unseen_in(row, stratum, samples);
  return numerical_error(in.emitted.source, in.reflected.source, in.reflected.bound);
}

// What one sample of a stratum stands for.
double Pass::sample_m2(std::uint32_t stratum, std::uint64_t samples) const {
  const AimedView& view = *view_->aimed;
  if (view.stratum[stratum].empty()) return 0;
  return view.stratum[stratum].area_m2() * std::pow(view.range_m / view.frame.plane_m, 2) /
         (static_cast<double>(samples) * accuracy_.replicates);
}

Pass::InBandLight Pass::in_band_light(std::size_t row) const {
  const ConditionSources& light = this->light(row);
  const BandOnAxis band = axis_band(row);
  const SourceLayout& layout = sources_.layout();
  // Of grey materials the table has these very numbers.
  const SourceTable& table = in_band_[row];
  const bool known = scene_.path_basis() == nullptr;
  IncidentRadiance::Integrals around;
  if (!known) around = light.around().integrals(band.first_node, band.grid.band_weight, nullptr, 1);
  const auto of = [&](SourceId id) {
    if (known)
      return InBandLight::Radiance{table.source[index_of(id)], table.apparent[index_of(id)]};
    if (layout.around().contains(id)) {
      const std::size_t node = index_of(id) - layout.around().first;
      return InBandLight::Radiance{around.source[node], around.apparent[node]};
    }
    return InBandLight::Radiance{in_band(light.radiance(id), band),
                                 in_band(light.apparent(id), band)};
  };
  const auto raise = [](InBandLight::Radiance& most, const InBandLight::Radiance& one) {
    most = {std::max(most.here, one.here), std::max(most.seen, one.seen)};
  };
  InBandLight out;
  for (const SourceId id : layout.behind()) out.behind = std::max(out.behind, of(id).seen);
  for (std::uint32_t p = 0; p < scene_.target.part.size(); ++p) {
    out.each.push_back(of(layout.seen(p)));
    raise(out.part, out.each.back());
  }
  for (const SourceRange range : {layout.sky(), layout.lower()})
    for (const SourceId id : range) raise(out.around, of(id));
  return out;
}

// What the scatter of samples cannot know, met or not. (docs/explanation/methods.md)
Pass::Unseen Pass::unseen(std::size_t row, std::uint64_t samples) const {
  if (!view_->aimed->bright.none()) {
    Unseen out, emitted;
    for (std::uint32_t s = 0; s < unseen_of_.size(); ++s) {
      const UnseenInStratum in = unseen_in(row, s, view_->aimed->samples(s, samples));
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
  const ConditionSources& light = this->light(row);
  const BandOnAxis band = axis_band(row);
  const InBandLight& known = in_band_light_[row];
  double source = 0, apparent = 0, contrast = 0;  // variances
  Unseen out;
  const auto square = [](double x) { return x * x; };
  // What the sensor sees of the parts themselves, and of what stands behind them.
  double most_m2 = 0, emitted = 0, emitted_seen = 0, emitted_contrast = 0;
  for (std::size_t p = 0; p < known.each.size(); ++p) {
    const std::uint32_t s = view_->aimed->stratum_of_part[p];
    const double m2 = sample_m2(s, view_->aimed->samples(s, samples));
    const InBandLight::Radiance& one = known.each[p];
    most_m2 = std::max(most_m2, m2);
    emitted = std::max(emitted, m2 * one.here);
    emitted_seen = std::max(emitted_seen, m2 * one.seen);
    emitted_contrast = std::max(emitted_contrast, m2 * std::max(one.seen, known.behind));
  }
  source += square(2 * emitted);
  apparent += square(2 * emitted_seen);
  contrast += square(2 * emitted_contrast);
  if (plan_.effects.max_reflections > 0) {
    // Whatever may be reflected: parts, sky, sea, glitter. Then suns.
    const bool parts = plan_.effects.parts && !plan_.effects.skip_self_intersection;
    const double around = std::max(parts ? known.part.here : 0, known.around.here),
                 around_seen = std::max(parts ? known.part.seen : 0, known.around.seen);
    const auto add = [&](const SmallBrightSources& rare, bool estimate, double radiance,
                         double radiance_seen) {
      SmallBrightSources::Allowance a = rare.allowance(most_m2);
      if (estimate) {
        a.stderr_ = numerical_error(0, a.stderr_, a.bound);
        a.bound = 0;
      }
      out.bound += a.bound * radiance;
      source += square(a.stderr_ * radiance);
      apparent += square(a.stderr_ * radiance_seen);
      contrast += square(a.stderr_ * radiance_seen);
    };
    add(unseen_->reflected(), false, around, around_seen);
    for (const LitSun& sun : light.suns()) {
      const UndersampledSources::Sun& rare = unseen_->of(sources_.geometry().sun[sun.index]);
      add(unseen_->reflected(), false, glitter_w_m2_sr(row, sun, false),
          glitter_w_m2_sr(row, sun, true));
      if (!sun.direct) continue;
      const double irradiance = in_band(sun.irradiance, band),
                   arrives = in_band(sun.apparent, band);
      add(rare.first, false, irradiance, arrives);
      if (plan_.effects.max_reflections > 1) add(rare.later, true, irradiance, arrives);
    }
  }
  out.source = std::sqrt(source);
  out.apparent = std::sqrt(apparent);
  out.contrast = std::sqrt(contrast);
  return out;
}

Pass::UnseenInStratum Pass::unseen_in(std::size_t row, std::uint32_t stratum,
                                      std::uint64_t samples) const {
  const ConditionSources& light = this->light(row);
  const InBandLight& known = in_band_light_[row];
  const std::size_t parts = known.each.size();
  const double m2 = sample_m2(stratum, samples);
  const UndersampledSources::Stratum& of = unseen_of_[stratum];
  UnseenInStratum out;
  for (std::size_t p = 0; p < parts; ++p) {
    if (!parts_of_[stratum][p]) continue;
    const InBandLight::Radiance& one = known.each[p];
    out.emitted = {0, std::max(out.emitted.source, 2 * m2 * one.here),
                   std::max(out.emitted.apparent, 2 * m2 * one.seen),
                   std::max(out.emitted.contrast, 2 * m2 * std::max(one.seen, known.behind))};
  }
  if (plan_.effects.max_reflections == 0) return out;
  const auto add = [&](const SmallBrightSources& rare, bool estimate, double radiance,
                       double radiance_seen) {
    SmallBrightSources::Allowance a = rare.allowance(m2);
    if (estimate) {
      a.stderr_ = numerical_error(0, a.stderr_, a.bound);
      a.bound = 0;
    }
    Unseen& sum = out.reflected;
    sum = {sum.bound + a.bound * radiance, std::hypot(sum.source, a.stderr_ * radiance),
           std::hypot(sum.apparent, a.stderr_ * radiance_seen),
           std::hypot(sum.contrast, a.stderr_ * radiance_seen)};
  };
  add(of.reflected, false, known.around.here, known.around.seen);
  if (plan_.effects.parts && !plan_.effects.skip_self_intersection) {
    const std::vector<InBandLight::Radiance>& sent = sent_[row];
    for (const UndersampledSources::Stratum::Parts& group : of.parts) {
      InBandLight::Radiance brightest;
      for (std::size_t p = 0; p < parts; ++p)
        if (group.seen[p])
          brightest = {std::max(brightest.here, sent[p].here),
                       std::max(brightest.seen, sent[p].seen)};
      add(group.reflected, false, brightest.here, brightest.seen);
    }
  }
  for (const LitSun& sun : light.suns()) {
    add(of.reflected, false, glitter_w_m2_sr(row, sun, false), glitter_w_m2_sr(row, sun, true));
    if (!sun.direct) continue;
    const double irradiance = in_band(sun.irradiance, axis_band(row)),
                 arrives = in_band(sun.apparent, axis_band(row));
    add(of.first[sun.index], false, irradiance, arrives);
    if (plan_.effects.max_reflections > 1) add(of.later[sun.index], true, irradiance, arrives);
  }
  return out;
}

// With what each part reflects of all others.
std::vector<Pass::InBandLight::Radiance> Pass::sent_by_parts(std::size_t row) const {
  const std::vector<InBandLight::Radiance>& each = in_band_light_[row].each;
  std::vector<double> here, seen;
  for (const InBandLight::Radiance& one : each) {
    here.push_back(one.here);
    seen.push_back(one.seen);
  }
  here = unseen_->with_reflected(here);
  seen = unseen_->with_reflected(seen);
  std::vector<InBandLight::Radiance> out;
  for (std::size_t p = 0; p < each.size(); ++p) out.push_back({here[p], seen[p]});
  return out;
}

std::vector<Pass::Brightness> Pass::brightness() const {
  if (plan_.effects.max_reflections == 0) return {};
  const AimedView& view = *view_->aimed;
  const std::size_t suns = sources_.geometry().sun.size();
  // Of each sun and each set of parts: the most of any row, per error that is wanted.
  std::vector<double> of_sun(suns, 0.0), of_parts(unseen_->parts_above().size(), 0.0);
  const bool by_parts = plan_.effects.parts && !plan_.effects.skip_self_intersection;
  for (std::size_t row = 0; row < rows(); ++row) {
    const double wanted = error_wanted(row);
    if (!(wanted > 0)) continue;
    for (const LitSun& sun : light(row).suns())
      if (sun.direct)
        of_sun[sun.index] =
            std::max(of_sun[sun.index], in_band(sun.irradiance, axis_band(row)) / wanted);
    if (!by_parts) continue;
    const std::vector<InBandLight::Radiance> sent = sent_by_parts(row);
    for (std::size_t k = 0; k < of_parts.size(); ++k)
      for (std::size_t p = 0; p < sent.size(); ++p)
        if (unseen_->parts_above()[k][p])
          of_parts[k] = std::max(of_parts[k], sent[p].here / wanted);
  }
  std::vector<Brightness> out;
  const auto see = [&](const SunDirection* sun, double scale) {
    // Light that matters less than this is bounded anyway.
    const std::vector<UndersampledSources::Facet> facets =
        unseen_->facets(sun, scale > 0 ? kBoundedOfFacets / scale : 0);
    if (out.empty())
      for (const UndersampledSources::Facet& f : facets) out.push_back({f.facet, f.seen_m2, 0});
    for (std::size_t i = 0; i < facets.size(); ++i) {
      const UndersampledSources::Facet& f = facets[i];
      out[i].per_m2 = std::max({out[i].per_m2, scale * f.first,
                                plan_.effects.max_reflections > 1 ? scale * f.later : 0,
                                f.reflected * of_parts[f.parts]});
    }
  };
  see(nullptr, 0);
  for (std::size_t j = 0; j < suns; ++j)
    if (of_sun[j] > 0) see(&sources_.geometry().sun[j], of_sun[j]);
  std::erase_if(out, [&](const Brightness& b) {
    return view.stratum_of(b.facet, scene_.target.facet[b.facet].part) != 0;
  });
  return out;
}

}  // namespace irsig
