#include "bridge/sweep_temperatures.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "bridge/environment/named.h"
#include "bridge/model_mesh.h"
#include "core/fields/temperature_field.h"
#include "core/geo/sun.h"

namespace irsig {
namespace {

absl::StatusOr<FieldImport> import_of(const schema::ConditionField& from) {
  const schema::TemperatureField& field = from.field();
  FieldImport how;
  how.file_name = from.file_name();
  const auto unit = named<TemperatureUnit>("temperature_field.unit", field.unit(),
                                           {{"K", TemperatureUnit::kKelvin},
                                            {"degC", TemperatureUnit::kCelsius},
                                            {"degF", TemperatureUnit::kFahrenheit}});
  if (!unit.ok()) return unit.status();
  const auto match =
      named<FieldMatch>("temperature_field.match", field.match(),
                        {{"index", FieldMatch::kIndex}, {"centroid", FieldMatch::kCentroid}});
  if (!match.ok()) return match.status();
  how.unit = *unit;
  how.match = *match;
  how.max_distance_m = field.max_distance_m();
  if (field.has_error_k()) how.error_k = field.error_k();
  return how;
}

// The model in its file's own coordinates; of a generated one, in those of the OBJ that `irsig
// model` writes: x forward, y to port, z up.
absl::StatusOr<FieldMesh> mesh_of_file(const schema::ResolvedSweep& sweep, const Assets& assets) {
  schema::ResolvedSweep plain = sweep;
  schema::Model& model = *plain.mutable_sweep()->mutable_model();
  FieldMesh out;
  if (!model.has_generate()) {
    out.unit_m = model.unit_m();
    model.set_unit_m(1);
    model.set_forward_axis("+x");
    model.set_up_axis("+z");
    model.set_reference("origin");
  }
  model.clear_draft_m();
  model.clear_offset_m();
  const auto mesh = model_mesh(plain, assets);
  if (!mesh.ok()) return mesh.status();
  for (const Vec<Body>& v : mesh->vertex) out.vertex.push_back({v.x, -v.y, -v.z});
  out.triangle = mesh->triangle;
  return out;
}

// The key that named the file, before each line of what is wrong in it.
absl::Status wrong(const schema::ResolvedSweep& sweep, const schema::Condition& condition,
                   std::string_view lines) {
  const std::string& name = condition.temperature_field().field().name();
  int index = 0;
  while (index < sweep.sweep().temperature_field_size() &&
         sweep.sweep().temperature_field(index).name() != name)
    ++index;
  const std::string key = absl::StrCat("temperature_field[", index, "].file: ");
  return absl::InvalidArgumentError(absl::StrCat(
      key, absl::StrReplaceAll(std::string(lines), {{"\n", absl::StrCat("\n", key)}})));
}

}  // namespace

absl::StatusOr<std::vector<FacetTemperatures>> facet_temperatures(
    const schema::ResolvedSweep& sweep, const Assets& assets, const Mesh& mesh,
    const std::vector<std::uint32_t>& part_of_facet) {
  std::vector<FacetTemperatures> out;
  if (std::none_of(sweep.condition().begin(), sweep.condition().end(),
                   [](const schema::Condition& c) { return c.has_temperature_field(); }))
    return out;
  FieldMesh of_file;
  bool by_place = false;
  for (const schema::Condition& c : sweep.condition())
    by_place |= c.temperature_field().field().match() == "centroid";
  if (by_place) {
    auto made = mesh_of_file(sweep, assets);
    if (!made.ok()) return made.status();
    of_file = *std::move(made);
  } else {
    of_file.vertex.resize(mesh.vertex.size());
    of_file.triangle = mesh.triangle;
  }
  std::map<std::string, TemperatureField> known;  // by name
  const std::size_t facets = mesh.triangle.size();
  for (const schema::Condition& c : sweep.condition()) {
    FacetTemperatures& at = out.emplace_back();
    at.kelvin.assign(facets, NAN);
    at.error_k.assign(facets, NAN);
    if (!c.has_temperature_field()) continue;
    const schema::ConditionField& from = c.temperature_field();
    const std::string& name = from.field().name();
    if (!known.contains(name)) {
      const auto how = import_of(from);
      if (!how.ok()) return how.status();
      auto field = read_temperature_field(asset(assets, from.sha256()), *how, of_file);
      if (!field.ok()) return wrong(sweep, c, std::string(field.status().message()));
      known[name] = *std::move(field);
    }
    const auto time = parse_rfc3339(c.time_utc());
    if (!time.ok()) return time.status();
    const TemperatureField& field = known[name];
    const auto all = at_time(field, unix_seconds(*time));
    if (!all.ok())
      return wrong(sweep, c,
                   absl::StrCat(from.file_name(), ": there are no temperatures at ", c.time_utc(),
                                ", which is before the first time or after the last"));
    std::vector<bool> by_field(static_cast<std::size_t>(sweep.sweep().part_size()), false);
    for (const std::uint32_t part : from.part()) by_field[part] = true;
    std::size_t lacking = 0, first = 0;
    for (std::size_t f = 0; f < facets; ++f) {
      if (!by_field[part_of_facet[f]]) continue;
      at.kelvin[f] = all->kelvin[f];
      at.error_k[f] = all->error_k[f];
      if (std::isnan(all->kelvin[f]) && lacking++ == 0) first = f;
      // What the corners of a facet differ by, or two times, may be more than it has.
      const double kelvin = static_cast<double>(all->kelvin[f]),
                   error_k = static_cast<double>(all->error_k[f]);
      if (kelvin - error_k < 1 || kelvin + error_k > kMostEmitterK)
        return wrong(sweep, c,
                     absl::StrCat(from.file_name(), ": facet ", f, " is ", kelvin, " K +- ",
                                  error_k, " K at ", c.time_utc(),
                                  ", which says nothing: expected a smaller error, values of "
                                  "facets instead of vertices, or more times"));
    }
    if (lacking > 0)
      return wrong(
          sweep, c,
          absl::StrCat(from.file_name(), ": ", lacking, " of ", facets,
                       " facets have no temperature (the first: facet ", first, " of part \"",
                       sweep.sweep().part(static_cast<int>(part_of_facet[first])).name(), "\"), ",
                       from.field().match() == "centroid"
                           ? absl::StrCat("expected a value within ", from.field().max_distance_m(),
                                          " m of each centroid")
                           : "expected a value for each",
                       ", or a stated temperature of the part"));
  }
  return out;
}

absl::StatusOr<SweepTemperatures> temperatures_from_sweep(const schema::ResolvedSweep& sweep,
                                                          const Assets& assets, const Mesh& mesh,
                                                          const std::vector<PartSpec>& parts) {
  SweepTemperatures out;
  const auto of_groups = part_of_groups(mesh, parts);
  if (!of_groups.ok()) return of_groups.status();
  std::vector<std::uint32_t> part_of_facet;
  for (const std::uint32_t group : mesh.triangle_group)
    part_of_facet.push_back((*of_groups)[group]);
  const auto facets = facet_temperatures(sweep, assets, mesh, part_of_facet);
  if (!facets.ok()) return facets.status();
  if (facets->empty()) return out;
  ElementEmission emission = make_element_emission(part_of_facet, parts.size(), *facets);
  out.emitters = std::make_shared<const Emitters>(std::move(emission.emitters));
  for (EmitterTemperatures& of_condition : emission.condition) {
    std::vector<double>& hottest_k = out.part_k.emplace_back(parts.size(), 0.0);
    std::vector<double>& mean_k = out.part_mean_k.emplace_back(parts.size(), 0.0);
    std::vector<double> count(parts.size(), 0.0);
    for (const std::uint32_t e : out.emitters->of_facet) {
      if (std::isnan(of_condition.kelvin[e])) continue;
      mean_k[out.emitters->part[e]] += static_cast<double>(of_condition.kelvin[e]);
      ++count[out.emitters->part[e]];
    }
    for (std::size_t p = 0; p < parts.size(); ++p)
      if (count[p] > 0) mean_k[p] /= count[p];
    for (std::size_t e = 0; e < of_condition.kelvin.size(); ++e) {
      if (std::isnan(of_condition.kelvin[e])) continue;
      double& of_part = hottest_k[out.emitters->part[e]];
      of_part = std::max(of_part, static_cast<double>(of_condition.kelvin[e]) +
                                      static_cast<double>(of_condition.error_k[e]));
    }
    out.condition.push_back(std::make_shared<const EmitterTemperatures>(std::move(of_condition)));
  }
  return out;
}

bool is_hot(const schema::ResolvedSweep& sweep, const SweepTemperatures& temperatures,
            std::size_t part) {
  constexpr double kHotterK = 30;
  for (std::size_t c = 0; c < temperatures.condition.size(); ++c) {
    const auto& stated = sweep.condition(static_cast<int>(c)).part_temperature_k();
    const auto part_k = [&](std::size_t p) {
      const double mean_k = temperatures.part_mean_k[c][p];
      return mean_k > 0 ? mean_k : stated[static_cast<int>(p)];
    };
    double coldest_k = INFINITY;
    for (std::size_t p = 0; p < temperatures.part_mean_k[c].size(); ++p)
      coldest_k = std::min(coldest_k, part_k(p));
    if (part_k(part) >= coldest_k + kHotterK) return true;
  }
  return false;
}

}  // namespace irsig
