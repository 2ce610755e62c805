#include "jobs/check_resolved.h"

#include <algorithm>
#include <set>
#include <string>
#include <tuple>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/geo/sun.h"
#include "jobs/keys/expand.h"
#include "jobs/resolve.h"
#include "jobs/resolve_heat.h"
#include "jobs/resolve_land.h"
#include "jobs/resolve_plume.h"
#include "jobs/resolve_uncertainty.h"
#include "jobs/text/number_bounds.h"
#include "jobs/text/size_bounds.h"
#include "messages/environment/weather_from_message.h"

namespace irsig {
namespace {

std::string element(const char* list, int i) { return absl::StrCat(list, "[", i, "]"); }

// Counts that the rest relies upon, and that something is there to be computed.
void check_shape(const schema::ResolvedSweep& resolved, Findings& findings) {
  const schema::Sweep& sweep = resolved.sweep();
  const auto needs_one = [&](int count, const char* what) {
    if (count == 0) findings.add(what, absl::StrCat(what, " is missing, expected one or more"));
  };
  needs_one(sweep.season_size(), "season");
  needs_one(sweep.time_size(), "time");
  needs_one(sweep.band_size(), "band");
  needs_one(sweep.part_size(), "part");
  needs_one(resolved.viewpoint_size(), "viewpoint");
  if (resolved.slice_size() > 0)
    findings.add("slice",
                 "slice is for what `irsig slice` made, expected a sweep as it was written");
  if (resolved.has_shard()) {
    const schema::Shard& shard = resolved.shard();
    const auto viewpoints = static_cast<std::uint32_t>(resolved.viewpoint_size());
    if (shard.of() < 2 || shard.of() > viewpoints || shard.number() < 1 ||
        shard.number() > shard.of())
      findings.add(
          "shard",
          absl::StrCat("shard is ", shard.number(), " of ", shard.of(),
                       ", expected one of 2 or more, at most as many as viewpoints: ", viewpoints));
    schema::ResolvedSweep whole = resolved;
    whole.clear_shard();
    if (shard.sweep_sha256() != sha256_hex(canonical_encoding(whole)))
      findings.add("shard.sweep_sha256",
                   absl::StrCat("shard.sweep_sha256 = \"", shard.sweep_sha256(),
                                "\" is not that of the sweep without its shard"));
  }
  const std::int64_t conditions = std::int64_t{sweep.season_size()} * sweep.time_size();
  if (resolved.condition_size() != conditions)
    findings.add("condition", absl::StrCat("condition has ", resolved.condition_size(),
                                           " elements, expected one for each season at each time: ",
                                           conditions));
}

void check_viewpoints(const schema::ResolvedSweep& resolved, Findings& findings) {
  std::set<std::tuple<double, double, double>> seen;
  for (int i = 0; i < resolved.viewpoint_size(); ++i) {
    const schema::Viewpoint& v = resolved.viewpoint(i);
    if (!seen.emplace(v.aspect_azimuth_deg(), v.aspect_elevation_deg(), v.range_m()).second)
      findings.add("viewpoint", absl::StrCat(element("viewpoint", i),
                                             " is the same as one before it, expected different "
                                             "ones"));
  }
}

bool is_sha256(const std::string& text) {
  if (text.size() != 64) return false;
  for (const char c : text)
    if (!absl::ascii_isdigit(static_cast<unsigned char>(c)) && !(c >= 'a' && c <= 'f'))
      return false;
  return true;
}

void check_sha256(const std::string& text, const std::string& path, Findings& findings) {
  if (!is_sha256(text))
    findings.add(path, absl::StrCat(path, " = \"", text, "\", expected a SHA-256 in hex"));
}

// A file that is kept by its hash; of its name only the ending is used.
void check_plain_name(const std::string& name, const std::string& path, Findings& findings) {
  if (name.empty() || absl::StrContains(name, '/') || !is_one_line(name))
    findings.add(path, absl::StrCat(path, " = \"", name, "\", expected a name without folders"));
}

void check_field(const schema::ResolvedSweep& resolved, const schema::ConditionField& from,
                 const std::string& path, Findings& findings) {
  // Inputs are moved where a job runs.
  if (from.shift_k() != 0)
    findings.add(path, absl::StrCat(path, ".shift_k = ", from.shift_k(), ", expected 0"));
  for (const std::uint32_t part : from.part())
    if (part >= static_cast<std::uint32_t>(resolved.sweep().part_size()))
      findings.add(path, absl::StrCat(path, ".part = ", part, ": there is no such part"));
  if (from.has_heat()) {
    if (from.heat() >= static_cast<std::uint32_t>(resolved.heat_size()))
      findings.add(path, absl::StrCat(path, ".heat = ", from.heat(), ": there is no such run"));
    else if (resolved.heat(static_cast<int>(from.heat())).input_size() > 0)
      findings.add(path, absl::StrCat(path, ".heat = ", from.heat(),
                                      " is a run of changes, expected one of temperatures"));
    return;
  }
  check_sha256(from.sha256(), path + ".sha256", findings);
  check_plain_name(from.file_name(), path + ".file_name", findings);
  const SectionCheck field(from.field(), path + ".field", findings);
  (void)field.one_of("unit", {"K", "degC", "degF"});
  (void)field.one_of("match", {"index", "centroid"});
}

// Checks that the weather and the surroundings of a condition can be made into an environment.
// Equal ones, such as those of all hours of a season, are checked once.
class AirCheck {
 public:
  explicit AirCheck(Findings& findings) : findings_(findings) {}

  void check(const schema::Weather& weather, const schema::Surroundings& surroundings,
             const std::string& path) {
    if (!seen_.insert(weather.SerializeAsString() + surroundings.SerializeAsString()).second)
      return;
    const auto made = weather_from_message(weather, surroundings);
    if (!made.ok()) findings_.add(path, absl::StrCat(path, ".weather: ", made.status().message()));
  }

 private:
  Findings& findings_;
  std::set<std::string> seen_;
};

void check_condition(const schema::ResolvedSweep& resolved, int i, AirCheck& air,
                     Findings& findings) {
  const schema::Sweep& sweep = resolved.sweep();
  const schema::Condition& condition = resolved.condition(i);
  const std::string path = element("condition", i);
  const auto times = static_cast<std::uint32_t>(sweep.time_size());
  const auto index = static_cast<std::uint32_t>(i);
  if (condition.season_index() != index / times || condition.time_index() != index % times) {
    findings.add(path, absl::StrCat(path, " is of season ", condition.season_index(), ", time ",
                                    condition.time_index(), ", expected season ", index / times,
                                    ", time ", index % times));
    return;
  }
  if (condition.part_temperature_k_size() != sweep.part_size())
    findings.add(path,
                 absl::StrCat(path, ".part_temperature_k has ", condition.part_temperature_k_size(),
                              " elements for ", sweep.part_size(), " parts"));
  if (!parse_rfc3339(condition.time_utc()).ok())
    findings.add(path, absl::StrCat(path, ".time_utc = \"", condition.time_utc(),
                                    "\", expected a time: 2025-12-21T01:30:00Z"));
  if (condition.has_temperature_field())
    check_field(resolved, condition.temperature_field(), path + ".temperature_field", findings);
  check_complete_surroundings(sweep, condition.surroundings(), path + ".surroundings", findings);
  if (condition.has_weather() != has_atmosphere(resolved)) {
    findings.add(path, absl::StrCat(path, ".weather ",
                                    condition.has_weather() ? "does not apply" : "is missing",
                                    " with air.model = \"", sweep.air().model(), "\""));
  } else if (condition.has_weather()) {
    air.check(condition.weather(), condition.surroundings(), path);
  } else if (sweep.air().model() == "homogeneous" && !(condition.air_temperature_k() > 0)) {
    findings.add(path, absl::StrCat(path, ".air_temperature_k = ", condition.air_temperature_k(),
                                    ", expected a temperature above 0"));
  }
}

void check_heat_run(const schema::ResolvedSweep& resolved, int i, AirCheck& air,
                    Findings& findings) {
  const schema::HeatRun& run = resolved.heat(i);
  const std::string path = element("heat", i);
  if (run.part_temperature_k_size() != resolved.sweep().part_size())
    findings.add(path, absl::StrCat(path, ".part_temperature_k has ", run.part_temperature_k_size(),
                                    " elements for ", resolved.sweep().part_size(), " parts"));
  if (run.time_utc().empty() || run.course().record().empty())
    findings.add(path, absl::StrCat(path, " has no times or no weather of its course"));
  for (const std::string& time : run.time_utc())
    if (!parse_rfc3339(time).ok())
      findings.add(path, absl::StrCat(path, ".time_utc = \"", time,
                                      "\", expected a time: 2025-12-21T01:30:00Z"));
  for (int k = 1; k < run.course().record_size(); ++k)
    if (!(run.course().record(k).unix_s() > run.course().record(k - 1).unix_s()))
      findings.add(path, absl::StrCat(path, ".course.record[", k, "] is not after the one before"));
  check_complete_surroundings(resolved.sweep(), run.surroundings(), path + ".surroundings",
                              findings);
  if (!run.has_weather()) {
    findings.add(path, absl::StrCat(path, ".weather is missing"));
  } else {
    air.check(run.weather(), run.surroundings(), path);
  }
}

// Checks [uncertainty] and its runs of changed inputs by making these runs again. A pilot's sweep
// may lack these runs.
void check_uncertainty(const schema::ResolvedSweep& as_sent, Findings& findings) {
  const auto of_changes = [](const schema::HeatRun& run) { return run.input_size() > 0; };
  const bool any = std::any_of(as_sent.heat().begin(), as_sent.heat().end(), of_changes);
  if (!findings.empty() ||
      (!any && !as_sent.sweep().has_uncertainty() && !as_sent.sweep().heat().model_error()))
    return;
  schema::ResolvedSweep resolved = as_sent;
  auto& runs = *resolved.mutable_heat();
  runs.erase(std::remove_if(runs.begin(), runs.end(), of_changes), runs.end());
  resolve_uncertainty(resolved, findings);
  const schema::Accuracy& accuracy = as_sent.sweep().accuracy();
  const bool pilot = accuracy.has_relative_error() && accuracy.has_samples_per_replicate();
  if (!findings.empty() || (pilot && !any)) return;
  const auto same = [](const schema::HeatRun& a, const schema::HeatRun& b) {
    return a.SerializeAsString() == b.SerializeAsString();
  };
  if (!std::equal(runs.begin(), runs.end(), as_sent.heat().begin(), as_sent.heat().end(), same))
    findings.add("heat", "heat has other runs of changes than those that follow from uncertainty");
}

// As resolve_sweep found the tables: what it has written into them since, and the rules of tables
// do not take, is taken out again.
schema::Sweep as_written(schema::Sweep sweep) {
  for (schema::Material& material : *sweep.mutable_material()) {
    if (!material.allow_energy_gain()) material.clear_allow_energy_gain();
    if (!material.published()) material.clear_published();
    if (!material.printed()) material.clear_printed();
    // The library's entry stands in the place of its name.
    material.clear_entry();
  }
  for (schema::Part& part : *sweep.mutable_part())
    if (part.rest()) part.clear_match();
  // A pilot's: so many samples, with the effects that the error calls for.
  if (sweep.accuracy().has_relative_error())
    sweep.mutable_accuracy()->clear_samples_per_replicate();
  if (sweep.has_image()) sweep.mutable_output()->clear_thumbnail_px();
  if (!sweep.has_heat() && !has_funnel_plume(sweep) && sweep.has_place())
    sweep.mutable_place()->clear_speed_m_s();
  return sweep;
}

void check_tables(const schema::ResolvedSweep& as_sent, Findings& findings) {
  schema::ResolvedSweep resolved;
  *resolved.mutable_sweep() = as_written(as_sent.sweep());
  schema::Sweep& sweep = *resolved.mutable_sweep();
  if (sweep.has_land()) *sweep.mutable_land() = land_as_written(as_sent);
  if (is_formula(sweep.name()))
    findings.add("name", absl::StrCat("name = \"", sweep.name(), "\": ", kFormulaName));
  if (sweep.name().empty() || !is_one_line(sweep.name()))
    findings.add("name", absl::StrCat("name = \"", sweep.name(),
                                      "\" is empty, has control characters or is not UTF-8"));
  // The bytes came apart from it, and are held against their hash when they are there.
  resolve_target("the model's bytes", resolved, findings);
  if (sweep.model().has_file()) {
    check_sha256(as_sent.model_sha256(), "model_sha256", findings);
    check_plain_name(as_sent.model_file_name(), "model_file_name", findings);
  } else if (!as_sent.model_sha256().empty()) {
    check_sha256(as_sent.model_sha256(), "model_sha256", findings);
  }
  resolve_build_ups(sweep, findings);
  check_run(sweep, findings);
  check_effect_names(sweep.effects(), findings);
  check_heat(sweep, findings);
  check_plume(sweep, findings);
  check_land(sweep, findings);
  check_heights(sweep, findings);
  check_place(sweep, findings);
  check_air(sweep, findings);
  *resolved.mutable_viewpoint() = as_sent.viewpoint();
  check_image(resolved, findings);
  check_sweep_imager(sweep, findings);
  check_profiles(resolved, findings);
}

}  // namespace

absl::Status check_resolved(const schema::ResolvedSweep& sweep) {
  const SweepFile no_file;
  Findings findings(no_file);
  check_sizes(sweep, "", findings);
  if (!findings.empty()) return findings.status();
  check_shape(sweep, findings);
  check_row_count(sweep, findings);
  check_numbers(sweep, "", findings);
  if (!findings.empty()) return findings.status();
  check_tables(sweep, findings);
  check_viewpoints(sweep, findings);
  AirCheck air(findings);
  for (int i = 0; i < sweep.condition_size(); ++i) check_condition(sweep, i, air, findings);
  for (int i = 0; i < sweep.heat_size(); ++i) check_heat_run(sweep, i, air, findings);
  check_resolved_plumes(sweep, findings);
  check_resolved_land(sweep, findings);
  check_uncertainty(sweep, findings);
  if (!findings.empty()) return findings.status();
  const double jobs = job_count(sweep);
  if (jobs > kMostJobs)
    findings.add("transport.job_size_vertices",
                 absl::StrCat("transport.job_size_vertices = ",
                              sweep.sweep().transport().job_size_vertices(), " makes ", jobs,
                              " jobs, expected at most ", kMostJobs));
  return findings.status();
}

}  // namespace irsig
