#include "core/signature/view/view_setup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "core/spectral/solar.h"

namespace irsig {
namespace {

// Returns the light of the sea where it mirrors a sun most.
InBandRadiance brightest_glitter_of(const ViewSetup& setup, const Row& row, const LitSun& sun) {
  const std::vector<SeaGlint>& glints = setup.glitter[sun.index];
  std::array<InBandRadiance, kGlintCosines.size()> of_node{};
  for (std::uint32_t k = 0; !glints.empty() && k < of_node.size(); ++k) {
    const SourceId id = setup.sources.layout().glint(sun.index, k);
    of_node[k] = {in_band(row.light->radiance(id), row.on_axis),
                  in_band(row.light->apparent(id), row.on_axis)};
  }
  InBandRadiance most;
  for (const SeaGlint& glint : glints) {
    const std::size_t node = glint_fraction(glint.cos_incidence).node;
    const auto per_sr = static_cast<double>(glint.per_sr);
    for (const std::size_t k : {node, node + 1})
      most = {std::max(most.at_target, per_sr * of_node[k].at_target),
              std::max(most.at_sensor, per_sr * of_node[k].at_sensor)};
  }
  return most;
}

double brightest_w_m2_sr(const ViewSetup& setup, const Row& row, const ViewRequest& request) {
  // Light that leaves a convex body does not meet it again.
  double sum = setup.scene.target.convex ? row.light->brightest_around_w_m2_sr(row.on_axis)
                                         : row.brightest_thermal_w_m2_sr;
  for (std::size_t k = 0; k < row.light->suns().size(); ++k) {
    const LitSun& sun = row.light->suns()[k];
    sum += in_band(sun.irradiance, row.on_axis) *
               setup.undersampled->of(setup.sources.geometry().sun[sun.index]).brightest_per_sr +
           row.glitter[k].at_target;
  }
  // Without any reflection no sun is followed, and none is known but outside the air.
  const ConditionSpec& condition = request.condition[row.condition];
  if (setup.plan.effects.max_reflections == 0 && setup.allowed_reflections == 0 &&
      sun_shines(condition)) {
    std::vector<double> irradiance;
    for (const double um : setup.scene.axis.node_um())
      irradiance.push_back(solar_irradiance_w_m2_um(um) *
                           std::max(condition.sun_scale, kNearestSun));
    sum += in_band(irradiance, row.on_axis) *
           setup.undersampled
               ->of({condition.sun_direction,
                     condition.sun_angular_radius_deg * std::numbers::pi / 180, 0, 0})
               .brightest_per_sr;
  }
  return sum;
}

BrightestLight brightest_light(const ViewSetup& setup, const Row& row) {
  const ConditionSources& light = *row.light;
  const SourceLayout& layout = setup.sources.layout();
  // For grey materials the table has these very numbers.
  const SourceTable& table = row.in_band;
  const bool known = setup.scene.path_basis() == nullptr;
  IncidentRadiance::Integrals around;
  if (!known)
    around =
        light.around().integrals(row.on_axis.first_node, row.on_axis.grid.band_weight, nullptr, 1);
  const auto of = [&](SourceId id) {
    if (known) return InBandRadiance{table.source[index_of(id)], table.apparent[index_of(id)]};
    if (layout.around().contains(id)) {
      const std::size_t node = index_of(id) - layout.around().first;
      return InBandRadiance{around.source[node], around.apparent[node]};
    }
    return InBandRadiance{in_band(light.radiance(id), row.on_axis),
                          in_band(light.apparent(id), row.on_axis)};
  };
  const auto raise = [](InBandRadiance& most, const InBandRadiance& one) {
    most = {std::max(most.at_target, one.at_target), std::max(most.at_sensor, one.at_sensor)};
  };
  BrightestLight out;
  for (const SourceId id : layout.behind())
    out.behind_at_sensor = std::max(out.behind_at_sensor, of(id).at_sensor);
  for (std::uint32_t p = 0; p < setup.parts(); ++p) {
    out.part.push_back(of(layout.seen(p)));
    raise(out.any_part, out.part.back());
  }
  for (const SourceRange range : {layout.sky(), layout.lower(), layout.land(), layout.land_suns()})
    for (const SourceId id : range) raise(out.around, of(id));
  return out;
}

}  // namespace

ViewSetup::ViewSetup(const PreparedScene& the_scene, const ViewRequest& request,
                     const ViewPlan& the_plan, std::shared_ptr<const PreparedView> the_view,
                     RowKeys the_keys, std::uint64_t the_seed)
    : scene(the_scene),
      accuracy(request.accuracy),
      allowed_reflections(request.max_reflections),
      plan(the_plan),
      view(std::move(the_view)),
      keys(std::move(the_keys)),
      seed(the_seed),
      sources(source_request(scene, request, keys.condition), plan.effects,
              {view, &view->environments}, scene.axis.node_um()),
      undersampled(view->unseen) {
  if (undersampled == nullptr)
    undersampled = std::make_shared<const UndersampledSources>(
        scene.target, scene.facets, scene.carried_material(), aimed().frame);
  turned = turned_areas(scene.target, -1.0 * aimed().frame.forward);
  if (!aimed().bright.none()) {
    strata = undersampled->by_stratum(aimed(), sources.geometry().sun);
    part_in_stratum.assign(aimed().stratum.size(), std::vector<bool>(parts(), false));
    for (std::uint32_t f = 0; f < scene.target.facet.size(); ++f) {
      const std::uint32_t part = scene.target.facet[f].part;
      part_in_stratum[aimed().stratum_of(f, part)][part] = true;
    }
  }
  for (const SunDirection& sun : sources.geometry().sun) glitter.push_back(brightest_glitter(sun));
}

double ViewSetup::sample_m2(std::uint32_t stratum, std::uint64_t samples) const {
  const AimedView& view_of = aimed();
  if (view_of.stratum[stratum].empty()) return 0;
  return view_of.stratum[stratum].area_m2() * std::pow(view_of.range_m / view_of.frame.plane_m, 2) /
         (static_cast<double>(samples) * accuracy.replicates);
}

std::vector<InBandRadiance> sent_by_parts(const UndersampledSources& sources,
                                          const std::vector<InBandRadiance>& part) {
  std::vector<double> at_target, at_sensor;
  for (const InBandRadiance& one : part) {
    at_target.push_back(one.at_target);
    at_sensor.push_back(one.at_sensor);
  }
  at_target = sources.with_reflected(at_target);
  at_sensor = sources.with_reflected(at_sensor);
  std::vector<InBandRadiance> out;
  for (std::size_t p = 0; p < part.size(); ++p) out.push_back({at_target[p], at_sensor[p]});
  return out;
}

std::vector<Row> rows_of(const ViewSetup& setup, const ViewRequest& request) {
  std::vector<Row> out;
  out.reserve(setup.keys.condition.size() * setup.keys.band.size());
  std::map<std::array<double, 3>, double> quadrature;  // conditions often share temperatures
  for (std::size_t c = 0; c < setup.keys.condition.size(); ++c)
    for (const std::uint32_t band : setup.keys.band) {
      Row& row = out.emplace_back(setup.keys.condition[c], band, setup.sources.wanted(c),
                                  setup.sources.wanted_under_one_sky(c),
                                  setup.scene.axis.band(band));
      row.planned = row.condition * setup.scene.axis.bands() + band;
      const double coldest_k = row.light->coldest_k(), hottest_k = row.light->hottest_k();
      const auto [known, fresh] =
          quadrature.try_emplace({static_cast<double>(band), coldest_k, hottest_k}, 0.0);
      if (fresh) known->second = setup.scene.quadrature_relative(band, coldest_k, hottest_k);
      row.quadrature_relative = known->second;
      row.in_band = source_table(*row.light, setup.scene.path_basis(), row.on_axis.first_node,
                                 row.on_axis.grid.band_weight);
      for (const LitSun& sun : row.light->suns())
        row.glitter.push_back(brightest_glitter_of(setup, row, sun));
      row.brightest_thermal_w_m2_sr = row.light->brightest_thermal_w_m2_sr(row.on_axis);
      row.brightest_w_m2_sr = brightest_w_m2_sr(setup, row, request);
      row.brightest = brightest_light(setup, row);
      if (!setup.strata.empty())
        row.sent_by_parts = sent_by_parts(*setup.undersampled, row.brightest.part);
    }
  return out;
}

}  // namespace irsig
