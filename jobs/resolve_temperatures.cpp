#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "jobs/files/temperature_files.h"
#include "jobs/keys/expand.h"
#include "jobs/resolve.h"
#include "jobs/text/nearest_name.h"

namespace irsig {

bool is_stated(const schema::Season& season, const schema::Part& part) {
  return part.has_temperature_k() || season.part_temperature_k().contains(part.name());
}

void check_temperature_fields(const SweepFile& file, Findings& findings) {
  const schema::Sweep& sweep = file.sweep;
  const std::vector<std::string> names =
      check_names(sweep.temperature_field(), "temperature_field", findings);
  for (int i = 0; i < sweep.temperature_field_size(); ++i) {
    const schema::TemperatureField& field = sweep.temperature_field(i);
    const SectionCheck check(field, absl::StrCat("temperature_field[", i, "]"), findings);
    check.require({"file"}, "expected a CSV or PLY file");
    check.require({"unit"}, "expected K, degC or degF: what the file's temperatures are in");
    check.require({"match"},
                  "expected \"index\" or \"centroid\": how its values find their facets");
    if (field.has_file() && !absl::EndsWithIgnoreCase(field.file(), ".csv") &&
        !absl::EndsWithIgnoreCase(field.file(), ".ply"))
      check.error("file", absl::StrCat("= \"", one_line(field.file()),
                                       "\", expected a file that ends in .csv or .ply"));
    if (field.has_unit()) (void)check.one_of("unit", {"K", "degC", "degF"});
    if (field.has_match() && check.one_of("match", {"index", "centroid"})) {
      if (field.match() == "centroid")
        check.require({"max_distance_m"},
                      "expected how far from a centroid its value may be: match is \"centroid\"");
      else if (field.has_max_distance_m())
        check.error("max_distance_m", "does not apply to match \"index\"");
    }
    const auto uses = [&](const schema::Season& s) {
      return s.temperature_field() == field.name();
    };
    if (field.has_name() && std::none_of(sweep.season().begin(), sweep.season().end(), uses))
      check.error("name", absl::StrCat("= \"", one_line(field.name()),
                                       "\" is named by no season, expected temperature_field = \"",
                                       one_line(field.name()), "\" in one of them"));
  }
  for (int s = 0; s < sweep.season_size(); ++s) {
    const schema::Season& season = sweep.season(s);
    if (!season.has_temperature_field()) continue;
    const SectionCheck check(season, absl::StrCat("season[", s, "]"), findings);
    if (std::find(names.begin(), names.end(), season.temperature_field()) == names.end())
      check.error("temperature_field", absl::StrCat(": there is no [[temperature_field]] \"",
                                                    one_line(season.temperature_field()), "\", ",
                                                    suggestion(season.temperature_field(), names)));
    else if (std::all_of(sweep.part().begin(), sweep.part().end(),
                         [&](const schema::Part& p) { return is_stated(season, p); }))
      check.error("temperature_field",
                  absl::StrCat("= \"", one_line(season.temperature_field()),
                               "\", but the temperatures of all parts are stated, expected a part "
                               "without temperature_k"));
  }
}

std::map<std::string, schema::ConditionField> resolve_temperature_fields(const SweepFile& file) {
  std::map<std::string, schema::ConditionField> out;
  const auto bytes = fields_of(file);
  for (const schema::TemperatureField& field : file.sweep.temperature_field()) {
    schema::ConditionField& from = out[field.name()];
    *from.mutable_field() = field;
    from.mutable_field()->clear_file();
    from.set_file_name(field.file().substr(field.file().find_last_of('/') + 1));
    if (const auto at = bytes.find(field.name()); at != bytes.end())
      from.set_sha256(sha256_hex(at->second));
  }
  return out;
}

void take_temperature_field(const std::map<std::string, schema::ConditionField>& fields,
                            const schema::Sweep& sweep, const schema::Season& season,
                            schema::Condition& condition) {
  if (!season.has_temperature_field()) return;
  schema::ConditionField& from = *condition.mutable_temperature_field();
  from = fields.at(season.temperature_field());
  for (int p = 0; p < sweep.part_size(); ++p)
    if (!is_stated(season, sweep.part(p))) from.add_part(static_cast<std::uint32_t>(p));
}

}  // namespace irsig
