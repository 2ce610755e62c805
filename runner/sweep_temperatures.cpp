#include "runner/sweep_temperatures.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/fields/temperature_field.h"
#include "core/geo/sun.h"
#include "messages/environment/named.h"
#include "messages/results/read_heat_field.h"
#include "runner/model_mesh.h"

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

// Returns an error of a temperature file at the key that names the file.
absl::Status wrong(const schema::ResolvedSweep& sweep, const schema::Condition& condition,
                   const absl::Status& in_file) {
  const std::string& name = condition.temperature_field().field().name();
  int index = 0;
  while (index < sweep.sweep().temperature_field_size() &&
         sweep.sweep().temperature_field(index).name() != name)
    ++index;
  return problem_status(
      problems_of(at_key(absl::StrCat("temperature_field[", index, "].file"), in_file)));
}
absl::Status wrong(const schema::ResolvedSweep& sweep, const schema::Condition& condition,
                   const std::string& what) {
  return wrong(sweep, condition, absl::InvalidArgumentError(what));
}

// Returns for each part of the sweep whether its temperatures come from the field.
std::vector<bool> parts_of(const schema::ResolvedSweep& sweep, const schema::ConditionField& from) {
  std::vector<bool> out(static_cast<std::size_t>(sweep.sweep().part_size()), false);
  for (const std::uint32_t part : from.part()) out[part] = true;
  return out;
}

// Temperature of a part without any known facet, where no air temperature is stated.
constexpr double kStandInK = 290;

// Returns true if a computed temperature and its error are usable; the limits are those of
// temperatures from a file.
bool says_something(double kelvin, double error_k) {
  return kelvin - error_k >= 1 && kelvin + error_k <= kMostEmitterK;
}

// Reads the facet temperatures of one sweep, one condition after the other.
class FacetReader {
 public:
  FacetReader(const schema::ResolvedSweep& sweep, const Assets& assets, const HeatOutputs& heat,
              FieldMesh of_file, const std::vector<std::uint32_t>& part_of_facet)
      : sweep_(sweep),
        assets_(assets),
        heat_(heat),
        of_file_(std::move(of_file)),
        part_of_facet_(part_of_facet) {}

  //   unknown  of facets without a usable temperature: what there is of it
  absl::Status read(const schema::Condition& c, FacetTemperatures& at,
                    std::map<std::size_t, std::string>& unknown) {
    if (!c.has_temperature_field()) return absl::OkStatus();
    return c.temperature_field().has_heat() ? read_computed(c, at, unknown) : read_file(c, at);
  }

 private:
  absl::Status read_computed(const schema::Condition& c, FacetTemperatures& at,
                             std::map<std::size_t, std::string>& unknown) {
    const schema::ConditionField& from = c.temperature_field();
    const std::size_t run = from.heat(), facets = part_of_facet_.size();
    if (run >= heat_.size())
      return absl::FailedPreconditionError(
          absl::StrCat("the temperatures of season \"", c.season(),
                       "\" are computed by a job whose result is not "
                       "known yet"));
    const auto named = [&](const std::string& what) {
      return absl::InvalidArgumentError(
          absl::StrCat("computed temperatures of season \"", c.season(), "\": ", what));
    };
    if (!computed_.contains(run)) {
      auto field = read_heat_field(heat_[run], facets);
      if (!field.ok()) return named(std::string(field.status().message()));
      computed_[run] = *std::move(field);
    }
    const schema::HeatField& field = computed_[run];
    ASSIGN_OR_RETURN(const auto time, parse_rfc3339(c.time_utc()));
    const auto found = std::find(field.unix_s().begin(), field.unix_s().end(), unix_seconds(time));
    if (found == field.unix_s().end()) return named("there are none at " + c.time_utc());
    const auto row = static_cast<std::size_t>(found - field.unix_s().begin());
    std::vector<float> kelvin(facets), error_k(facets);
    const std::size_t bytes = facets * sizeof(float);
    std::memcpy(kelvin.data(), field.kelvin().data() + row * bytes, bytes);
    std::memcpy(error_k.data(), field.error_k().data() + row * bytes, bytes);
    const std::vector<bool> by_field = parts_of(sweep_, from);
    std::vector<double> sum_k(by_field.size(), 0.0), count(by_field.size(), 0.0);
    std::vector<double> coldest_k(by_field.size(), INFINITY), hottest_k(by_field.size(), 0.0);
    for (std::size_t f = 0; f < facets; ++f) {
      const std::uint32_t part = part_of_facet_[f];
      if (!by_field[part]) continue;
      if (!says_something(static_cast<double>(kelvin[f]), static_cast<double>(error_k[f]))) {
        unknown[f] =
            std::isnan(kelvin[f]) ? "" : absl::StrCat(kelvin[f], " K +- ", error_k[f], " K");
        continue;
      }
      at.kelvin[f] = kelvin[f];
      at.error_k[f] = error_k[f];
      const auto here_k = static_cast<double>(kelvin[f]), off_k = static_cast<double>(error_k[f]);
      sum_k[part] += here_k;
      ++count[part];
      coldest_k[part] = std::min(coldest_k[part], here_k - off_k);
      hottest_k[part] = std::max(hottest_k[part], here_k + off_k);
    }
    const double air_k = c.air_temperature_k() > 0 ? c.air_temperature_k() : kStandInK;
    // A view may see a sliver of a facet inside other bodies. The facet takes the mean temperature
    // of its part, with an error that covers the part's range.
    std::erase_if(unknown, [&](const auto& of) {
      const auto& [f, text] = of;
      const std::uint32_t part = part_of_facet_[f];
      const double mean_k = count[part] > 0 ? sum_k[part] / count[part] : air_k;
      const bool known = text.empty() && count[part] > 0;
      at.kelvin[f] = static_cast<float>(mean_k);
      at.error_k[f] =
          known ? static_cast<float>(std::max(hottest_k[part] - mean_k, mean_k - coldest_k[part]))
                : std::numeric_limits<float>::infinity();
      return known;
    });
    return absl::OkStatus();
  }

  absl::Status read_file(const schema::Condition& c, FacetTemperatures& at) {
    const schema::ConditionField& from = c.temperature_field();
    const std::string& name = from.field().name();
    const std::size_t facets = part_of_facet_.size();
    if (!known_.contains(name)) {
      ASSIGN_OR_RETURN(const auto how, import_of(from));
      auto field = read_temperature_field(asset(assets_, from.sha256()), how, of_file_);
      if (!field.ok()) return wrong(sweep_, c, field.status());
      known_[name] = *std::move(field);
    }
    ASSIGN_OR_RETURN(const auto time, parse_rfc3339(c.time_utc()));
    const TemperatureField& field = known_[name];
    const auto all = at_time(field, unix_seconds(time));
    if (!all.ok())
      return wrong(sweep_, c,
                   absl::StrCat(from.file_name(), ": there are no temperatures at ", c.time_utc(),
                                ", which is before the first time or after the last"));
    const std::vector<bool> by_field = parts_of(sweep_, from);
    std::size_t lacking = 0, first = 0;
    for (std::size_t f = 0; f < facets; ++f) {
      if (!by_field[part_of_facet_[f]]) continue;
      at.kelvin[f] = all->kelvin[f];
      at.error_k[f] = all->error_k[f];
      if (std::isnan(all->kelvin[f])) {
        if (lacking++ == 0) first = f;
        continue;
      }
      // The differences between a facet's corners, or between two times, may exceed the facet's
      // temperature.
      const double kelvin = static_cast<double>(all->kelvin[f]),
                   error_k = static_cast<double>(all->error_k[f]);
      if (!says_something(kelvin, error_k))
        return wrong(sweep_, c,
                     absl::StrCat(from.file_name(), ": facet ", f, " is ", kelvin, " K +- ",
                                  error_k, " K at ", c.time_utc(),
                                  ", which says nothing: expected a smaller error, values of "
                                  "facets instead of vertices, or more times"));
    }
    if (lacking > 0)
      return wrong(
          sweep_, c,
          absl::StrCat(from.file_name(), ": ", lacking, " of ", facets,
                       " facets have no temperature (the first: facet ", first, " of part \"",
                       sweep_.sweep().part(static_cast<int>(part_of_facet_[first])).name(), "\"), ",
                       from.field().match() == "centroid"
                           ? absl::StrCat("expected a value within ", from.field().max_distance_m(),
                                          " m of each centroid")
                           : "expected a value for each",
                       ", or a stated temperature of the part"));
    return absl::OkStatus();
  }

  const schema::ResolvedSweep& sweep_;
  const Assets& assets_;
  const HeatOutputs& heat_;
  FieldMesh of_file_;
  const std::vector<std::uint32_t>& part_of_facet_;
  std::map<std::string, TemperatureField> known_;      // by name
  std::map<std::size_t, schema::HeatField> computed_;  // by heat run
};

// The most emitters that computed temperatures make beside whole parts: each facet its own.
std::size_t facets_of_computed_parts(const schema::ResolvedSweep& sweep,
                                     const std::vector<std::uint32_t>& part_of_facet) {
  std::vector<bool> computed(static_cast<std::size_t>(sweep.sweep().part_size()), false);
  for (const schema::Condition& c : sweep.condition())
    for (const std::uint32_t part : c.temperature_field().part()) computed[part] = true;
  return static_cast<std::size_t>(std::count_if(part_of_facet.begin(), part_of_facet.end(),
                                                [&](std::uint32_t p) { return computed[p]; }));
}

}  // namespace

absl::StatusOr<FieldMesh> field_mesh(const schema::ResolvedSweep& sweep, const Assets& assets) {
  FieldMesh out;
  if (const schema::Model& model = sweep.sweep().model(); !model.has_generate())
    out.unit_m = model.unit_m();
  ASSIGN_OR_RETURN(const auto mesh, model_mesh_of_file(sweep, assets));
  for (const Vec<Body>& v : mesh.vertex) out.vertex.push_back({v.x, -v.y, -v.z});
  out.triangle = mesh.triangle;
  return out;
}

bool awaits_temperatures(const schema::ResolvedSweep& sweep, const HeatOutputs& heat) {
  return heat.size() != static_cast<std::size_t>(sweep.heat_size());
}

absl::StatusOr<std::vector<FacetTemperatures>> facet_temperatures(
    const schema::ResolvedSweep& sweep, const Assets& assets, const HeatOutputs& heat,
    const Mesh& mesh, const std::vector<std::uint32_t>& part_of_facet,
    std::vector<std::map<std::size_t, std::string>>* unknown) {
  std::vector<FacetTemperatures> out;
  if (std::none_of(sweep.condition().begin(), sweep.condition().end(),
                   [](const schema::Condition& c) { return c.has_temperature_field(); }))
    return out;
  FieldMesh of_file;
  bool by_place = false;
  for (const schema::Condition& c : sweep.condition())
    by_place |= c.temperature_field().field().match() == "centroid";
  if (by_place) {
    ASSIGN_OR_RETURN(of_file, field_mesh(sweep, assets));
  } else {
    of_file.vertex.resize(mesh.vertex.size());
    of_file.triangle = mesh.triangle;
  }
  FacetReader reader(sweep, assets, heat, std::move(of_file), part_of_facet);
  for (const schema::Condition& c : sweep.condition()) {
    FacetTemperatures& at = out.emplace_back();
    at.kelvin.assign(mesh.triangle.size(), NAN);
    at.error_k.assign(mesh.triangle.size(), NAN);
    std::map<std::size_t, std::string> unknown_here;
    RETURN_IF_ERROR(reader.read(c, at, unknown_here));
    if (unknown != nullptr) unknown->push_back(std::move(unknown_here));
  }
  return out;
}

absl::StatusOr<SweepTemperatures> temperatures_from_sweep(const schema::ResolvedSweep& sweep,
                                                          const Assets& assets,
                                                          const HeatOutputs& heat, const Mesh& mesh,
                                                          const std::vector<PartSpec>& parts) {
  SweepTemperatures out;
  if (sweep.condition().empty())
    return out;  // a goniometer's: what is measured may not be made yet
  ASSIGN_OR_RETURN(const auto of_groups, part_of_groups(mesh, parts));
  std::vector<std::uint32_t> part_of_facet;
  for (const std::uint32_t group : mesh.triangle_group) part_of_facet.push_back(of_groups[group]);
  if (awaits_temperatures(sweep, heat)) {
    out.awaited = true;
    if (std::any_of(sweep.condition().begin(), sweep.condition().end(),
                    [](const schema::Condition& c) { return c.has_temperature_field(); }))
      out.awaited_emitters = parts.size() + facets_of_computed_parts(sweep, part_of_facet);
    schema::ResolvedSweep of_files = sweep;  // what is wrong with those is said now
    for (schema::Condition& c : *of_files.mutable_condition())
      if (c.temperature_field().has_heat()) c.clear_temperature_field();
    if (const auto read = facet_temperatures(of_files, assets, heat, mesh, part_of_facet);
        !read.ok())
      return read.status();
    return out;
  }
  ASSIGN_OR_RETURN(const auto facets,
                   facet_temperatures(sweep, assets, heat, mesh, part_of_facet, &out.unknown));
  ASSIGN_OR_RETURN(out.land, land_temperatures_from_sweep(sweep, heat));
  if (facets.empty()) return out;
  ElementEmission emission = make_element_emission(part_of_facet, parts.size(), facets);
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
      const double error_k = static_cast<double>(of_condition.error_k[e]);
      of_part = std::max(of_part, static_cast<double>(of_condition.kelvin[e]) +
                                      (std::isinf(error_k) ? 0 : error_k));
    }
    out.condition.push_back(std::make_shared<const EmitterTemperatures>(std::move(of_condition)));
  }
  return out;
}

absl::Status unknown_temperature(const schema::ResolvedSweep& sweep, const Target& target,
                                 std::size_t facet, const schema::Condition& condition,
                                 const std::vector<std::map<std::size_t, std::string>>& unknown) {
  Vec<Body> middle = target.centre;
  for (std::size_t c = 0; c < 3; ++c) {
    const float* at =
        target.vertex.data() + 3 * static_cast<std::size_t>(target.triangle[3 * facet + c]);
    middle = middle + (1.0 / 3) * Vec<Body>{static_cast<double>(at[0]), static_cast<double>(at[1]),
                                            static_cast<double>(at[2])};
  }
  int c = 0;
  while (c + 1 < sweep.condition_size() && (sweep.condition(c).season() != condition.season() ||
                                            sweep.condition(c).time_utc() != condition.time_utc()))
    ++c;
  std::string computed;
  if (static_cast<std::size_t>(c) < unknown.size())
    if (const auto found = unknown[static_cast<std::size_t>(c)].find(facet);
        found != unknown[static_cast<std::size_t>(c)].end())
      computed = found->second;
  const auto rounded = [](double m) { return absl::SixDigits(std::round(100 * m) / 100 + 0.0); };
  return absl::InvalidArgumentError(absl::StrCat(
      "computed temperatures of season \"", condition.season(), "\" at ", condition.time_utc(),
      ": the view sees facet ", facet, " of part \"",
      sweep.sweep().part(static_cast<int>(target.facet[facet].part)).name(), "\" at ",
      rounded(middle.x), " m forward, ", rounded(-middle.y), " m to port, ", rounded(-middle.z),
      " m up, whose temperature is not known (",
      computed.empty() ? "fewer than 1 of 32 rays leave the body that the facet stands in"
                       : absl::StrCat(computed, ": the error leaves nothing of it"),
      "); expected facets that do not stand inside other bodies: state temperature_k for the part, "
      "cut it with a smaller heat.element_size_m, or mend the model"));
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
