#include "jobs/resolve_plume.h"

#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/gas/gas_spectrum.h"
#include "core/gas/gas_state.h"
#include "core/plume/exhaust_gas.h"
#include "jobs/keys/expand.h"
#include "jobs/resolve.h"
#include "messages/environment/gas_from_message.h"
#include "messages/environment/weather_from_message.h"

namespace irsig {
namespace {

constexpr const char* kPath = "plume.file";
// A tenth of the light behind is taken: bands with a few strong lines never lose most of theirs.
constexpr double kAreaOpticalDepth = 0.1;

using Names = SectionCheck::Names;

Names joined(Names a, const Names& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const Names kSpecies = {"co2", "h2o", "co", "soot"};

// The keys of a kind: those that it needs, and those that it may have beside them.
struct Keys {
  Names needed, optional;
};
Keys plume_keys(const std::string& kind) {
  const Names of_body = {"temperature_k", "voxel_m"};
  if (kind == "funnel")
    return {{"temperature_k", "diameter_m", "velocity_m_s", "excess_air", "length_m", "voxel_m"},
            {"hydrogen_per_carbon", "carbon_as_co", "soot_g_per_kg"}};
  if (kind == "file")
    return {
        joined({"file", "unit_m", "forward_axis", "up_axis", "temperature", "pressure"}, kSpecies),
        {"interpolation"}};
  const Names size = kind == "slab"       ? Names{"length_m", "width_m", "height_m"}
                     : kind == "cylinder" ? Names{"length_m", "radius_m"}
                                          : Names{"radius_m"};
  return {joined(of_body, size), joined({"pressure_pa"}, kSpecies)};
}

const char* what_is(const std::string& key) {
  static const std::map<std::string, const char*> meanings = {
      {"temperature_k", "the gas's temperature (of a funnel: at its opening)"},
      {"voxel_m", "the edge of a voxel"},
      {"diameter_m", "the diameter of the opening"},
      {"velocity_m_s", "how fast the gas leaves the opening"},
      {"excess_air", "how much more air than the fuel needs (a diesel engine at load: 1.2)"},
      {"length_m", "a length (of a funnel: of the plume's axis)"},
      {"width_m", "the size across"},
      {"height_m", "the height"},
      {"radius_m", "the radius"},
      {"file", "a .vdb file"},
      {"unit_m", "the length of one unit of the file in metres"},
      {"forward_axis", "the file's axis that points to the bow: \"+x\", \"-x\", \"+y\" ..."},
      {"up_axis", "the file's axis that points up: \"+z\", \"+y\" ..."},
      {"temperature", "{ grid = \"...\", unit = \"K\" }, or a constant"},
      {"pressure", "{ constant = 101325, unit = \"Pa\" }, or a grid"},
  };
  const auto known = meanings.find(key);
  return known != meanings.end() ? known->second
                                 : "{ grid = \"...\", unit = \"1\" }, or 0 where there is none";
}

const schema::GasQuantity& quantity(const schema::Plume& plume, const std::string& name) {
  const auto& field = *schema::Plume::descriptor()->FindFieldByName(name);
  return static_cast<const schema::GasQuantity&>(plume.GetReflection()->GetMessage(plume, &field));
}

// The composition of a body: numbers, and some gas.
void check_body(const schema::Plume& plume, const SectionCheck& check) {
  bool all_good = true;
  double gases = 0, soot = 0;
  for (const char* name : kSpecies) {
    if (!check.has(name)) continue;
    const schema::GasQuantity& q = quantity(plume, name);
    if (q.has_grid() || !q.has_constant() || (q.has_unit() && q.unit() != "1")) {
      check.error(name,
                  absl::StrCat("is no number, expected one: a ", plume.kind(), " has no grids"));
      all_good = false;
      continue;
    }
    const bool is_soot = std::string_view(name) == "soot";
    const double most = is_soot ? kGasSootMax : 1;
    if (!(q.constant() >= 0 && q.constant() <= most)) {
      check.error(name, absl::StrCat("= ", q.constant(), ", expected a ",
                                     is_soot ? "volume" : "mole", " fraction from 0 to ", most));
      all_good = false;
    }
    (is_soot ? soot : gases) += q.constant();
  }
  if (!all_good) return;
  if (gases > 1)
    check.error("co2", absl::StrCat("and h2o and co are mole fractions of ", gases,
                                    " in all, expected at most 1"));
  if (gases + soot == 0)
    check.error("kind", absl::StrCat("= \"", plume.kind(),
                                     "\" without any of co2, h2o, co and soot, expected one"));
}

// Checks the meaning of a file's grids as its reader does, and constants against the tables of hot
// gas.
void check_file(const schema::Plume& plume, const SectionCheck& check, Findings& findings) {
  if (!absl::EndsWithIgnoreCase(plume.file(), ".vdb"))
    check.error("file",
                absl::StrCat("= \"", one_line(plume.file()), "\", expected a file ending in .vdb"));
  const bool interpolation =
      !plume.has_interpolation() || check.one_of("interpolation", {"linear", "constant"});
  const auto grids = grids_from_message(plume);
  if (!interpolation || !grids.ok()) return;
  const absl::StatusOr<PlumeReading> reading = check_plume_grids(*grids);
  if (!reading.ok()) {
    for (const Problem& problem : problems_of(reading.status()))
      findings.add(problem.key.empty() ? "plume" : absl::StrCat("plume.", problem.key),
                   absl::StrCat(problem.key.empty() ? "plume: " : "plume.", problem.text));
    return;
  }
  const auto within = [&](const char* name, const PlumeQuantity& q, double least, double most,
                          const char* unit) {
    if (q.channel < 0 && !(q.constant >= least && q.constant <= most))
      check.error(name, absl::StrCat("is ", q.constant, " ", unit, ", expected ", least, " to ",
                                     most, ": the tables of hot gas end there"));
  };
  within("temperature", reading->temperature, kGasTemperatureMinK, kGasTemperatureMaxK, "K");
  within("pressure", reading->pressure, kGasPressureMinPa, kGasPressureMaxPa, "Pa");
  within("soot", reading->species[kSoot], 0, kGasSootMax, "of the volume");
}

void check_funnel(const schema::Sweep& sweep, const SectionCheck& check, Findings& findings) {
  const schema::Plume& plume = sweep.plume();
  if (plume.has_voxel_m() && plume.has_diameter_m() && plume.voxel_m() > plume.diameter_m())
    check.error("voxel_m", absl::StrCat("= ", plume.voxel_m(),
                                        ", expected at most the diameter of the opening, ",
                                        plume.diameter_m()));
  if (plume.has_length_m() && plume.length_m() < plume.diameter_m())
    check.error("length_m", absl::StrCat("= ", plume.length_m(),
                                         ", expected at least the diameter of the opening, ",
                                         plume.diameter_m()));
  if (sweep.air().model() == "vacuum")
    check.error("kind",
                "= \"funnel\", but air.model = \"vacuum\", expected \"atmosphere\" or "
                "\"homogeneous\": a funnel's gas rises in air, and the wind bends it");
  if (!has_position(sweep))
    findings.add("plume",
                 "plume.kind = \"funnel\" needs [place], expected latitude_deg, longitude_deg and "
                 "heading_deg: the wind that bends the plume is relative to the bow");
}

// Bands that the gas's tables have; stored spectra are means over step_um.
void check_bands(const schema::Sweep& sweep, Findings& findings) {
  const double least_um = 1e4 / (kGasFirstCm1 + kGasBandWidthCm1 * kGasBandCount),
               most_um = 1e4 / kGasFirstCm1;
  for (int b = 0; b < sweep.band_size(); ++b) {
    const schema::Band& band = sweep.band(b);
    if (!band.has_lambda_min_um() || !band.has_lambda_max_um()) continue;
    const double half_um = 0.5 * band.step_um();
    const bool short_wave = band.lambda_min_um() - half_um < least_um;
    if (!short_wave && band.lambda_max_um() + half_um <= most_um) continue;
    const std::string path =
        absl::StrCat("band[", b, short_wave ? "].lambda_min_um" : "].lambda_max_um");
    findings.add(path, absl::StrCat(path, " and half a step reach beyond the tables of hot gas, ",
                                    "expected wavelengths from ", absl::SixDigits(least_um), " to ",
                                    absl::SixDigits(most_um), " um with [plume]"));
  }
}

double turned_deg(double deg) {
  const double turn = std::fmod(deg, 360);
  return turn < 0 ? turn + 360 : turn;
}

// Returns the reason why the gas cannot be in the condition's air; empty if it can.
std::string wrong_air(const schema::ConditionPlume& p) {
  if (!(p.air_temperature_k() >= kGasTemperatureMinK))
    return absl::StrCat("rises in air of ", p.air_temperature_k(),
                        " K, which it becomes: the tables of hot gas begin at ",
                        kGasTemperatureMinK, " K");
  if (!(p.plume().temperature_k() >= p.air_temperature_k() + 1))
    return absl::StrCat(".temperature_k = ", p.plume().temperature_k(), " is not above the air's ",
                        absl::SixDigits(p.air_temperature_k()),
                        " K, expected gas that is hotter by 1 K or more");
  if (!(p.air_pressure_pa() >= kGasPressureMinPa && p.air_pressure_pa() <= kGasPressureMaxPa))
    return absl::StrCat("rises in air of ", p.air_pressure_pa(),
                        " Pa: the tables of hot gas hold from ", kGasPressureMinPa, " to ",
                        kGasPressureMaxPa, " Pa");
  const auto gas =
      exhaust_gas(exhaust_from_message(p.plume()), p.plume().temperature_k(), p.air_pressure_pa());
  if (!gas.ok()) return absl::StrCat(": ", std::string(gas.status().message()));
  return "";
}

void add(const std::string& path, const std::string& what, Findings& findings) {
  findings.add(path, absl::StrCat(path, what[0] == '.' || what[0] == ':' ? "" : " ", what));
}

}  // namespace

bool has_funnel_plume(const schema::Sweep& sweep) {
  return sweep.has_plume() && sweep.plume().kind() == "funnel";
}

absl::Status read_plume_file(SweepFile& file, const FileReader& read) {
  const std::string& name = file.sweep.plume().file();
  if (name.empty()) return absl::OkStatus();  // reported with what else is missing
  auto bytes = read(name);
  if (bytes.ok() && !bytes->empty()) {
    file.content[kPath] = *std::move(bytes);
    return absl::OkStatus();
  }
  return placed_problem(
      file.location(kPath),
      absl::StrCat(kPath, " = \"", one_line(name),
                   "\": ", bytes.ok() ? "is empty" : std::string(bytes.status().message())));
}

std::string_view plume_bytes(const SweepFile& file) {
  const auto at = file.content.find(kPath);
  return at == file.content.end() ? std::string_view() : std::string_view(at->second);
}

void check_plume(const schema::Sweep& sweep, Findings& findings) {
  if (!sweep.has_plume()) return;
  const schema::Plume& plume = sweep.plume();
  const SectionCheck check(plume, "plume", findings);
  check.require({"kind"}, "expected \"funnel\", \"slab\", \"cylinder\", \"sphere\" or \"file\"");
  if (!check.one_of("kind", {"funnel", "slab", "cylinder", "sphere", "file"})) return;
  const Keys keys = plume_keys(plume.kind());
  for (const char* key : keys.needed) check.require({key}, absl::StrCat("expected ", what_is(key)));
  check.require({"position_m"}, "expected where it is: [forward, to starboard, up] in metres");
  if (check.has("position_m") && plume.position_m_size() != 3)
    check.error("position_m", absl::StrCat("has ", plume.position_m_size(),
                                           " numbers, expected three: forward, to starboard, up"));
  check.only(
      joined(joined({"kind", "position_m", "area_optical_depth"}, keys.needed), keys.optional),
      absl::StrCat("to a plume of kind \"", plume.kind(), "\""));
  if (plume.kind() == "funnel") {
    check_funnel(sweep, check, findings);
  } else if (plume.kind() == "file") {
    bool complete = true;
    for (const char* key : keys.needed) complete = complete && check.has(key);
    if (complete) check_file(plume, check, findings);
  } else {
    check_body(plume, check);
  }
  check_bands(sweep, findings);
  if (sweep.has_uncertainty())
    findings.add("uncertainty",
                 "[uncertainty] and [plume] are both there, expected one of them: what uncertain "
                 "inputs mean for hot gas is not known");
  if (sweep.heat().model_error())
    findings.add(
        "heat.model_error",
        "heat.model_error and [plume] are both there, expected one of them: what the model "
        "of heat is worth beside hot gas is not known");
  if (sweep.profile_size() > 0)
    findings.add("profile[0]",
                 "profile[0] and [plume] are both there, expected one of them: profiles do not see "
                 "hot gas");
  for (int s = 0; s < sweep.season_size(); ++s)
    if (sweep.season(s).has_modtran_file()) {
      const std::string path = absl::StrCat("season[", s, "].modtran_file");
      findings.add(path, absl::StrCat(path,
                                      " and [plume] are both there, expected one of them: "
                                      "of imported air no lines are known, and band means "
                                      "of air and hot gas do not multiply"));
    }
}

void write_plume_defaults(schema::Sweep& sweep) {
  if (!sweep.has_plume()) return;
  schema::Plume& plume = *sweep.mutable_plume();
  if (!plume.has_area_optical_depth()) plume.set_area_optical_depth(kAreaOpticalDepth);
  if (plume.kind() == "funnel") {
    if (!plume.has_hydrogen_per_carbon()) plume.set_hydrogen_per_carbon(1.85);
    if (!plume.has_carbon_as_co()) plume.set_carbon_as_co(0);
    if (!plume.has_soot_g_per_kg()) plume.set_soot_g_per_kg(0);
    if (!sweep.place().has_speed_m_s()) sweep.mutable_place()->set_speed_m_s(0);
    return;
  }
  for (schema::GasQuantity* q :
       {plume.mutable_co2(), plume.mutable_h2o(), plume.mutable_co(), plume.mutable_soot()}) {
    if (!q->has_grid() && !q->has_constant()) q->set_constant(0);
    if (!q->has_unit()) q->set_unit("1");
  }
  if (plume.kind() == "file") {
    if (!plume.has_interpolation()) plume.set_interpolation("linear");
  } else if (!plume.has_pressure_pa()) {
    plume.set_pressure_pa(101325);
  }
}

void resolve_plumes(const SweepFile& file, const std::vector<PlumeWeather>& weather,
                    schema::ResolvedSweep& resolved, Findings& findings) {
  if (!resolved.sweep().has_plume() || !findings.empty()) return;
  schema::Sweep complete = resolved.sweep();
  write_plume_defaults(complete);
  schema::ConditionPlume common;
  *common.mutable_plume() = complete.plume();
  common.mutable_plume()->clear_file();
  if (complete.plume().kind() == "file") common.set_sha256(sha256_hex(plume_bytes(file)));
  std::map<std::string, std::uint32_t> known;
  for (int c = 0; c < resolved.condition_size(); ++c) {
    schema::Condition& condition = *resolved.mutable_condition(c);
    schema::ConditionPlume p = common;
    if (has_funnel_plume(complete)) {
      const PlumeWeather& here = weather[static_cast<std::size_t>(c)];
      p.set_wind_speed_m_s(here.wind_speed_m_s);
      if (here.wind_speed_m_s > 0)
        p.set_wind_from_deg(turned_deg(here.wind_from_deg - complete.place().heading_deg()));
      p.set_ship_speed_m_s(complete.place().speed_m_s());
      p.set_air_temperature_k(condition.air_temperature_k());
      p.set_air_pressure_pa(condition.has_weather() ? condition.weather().pressure_pa()
                                                    : complete.air().pressure_pa());
      if (const std::string wrong = wrong_air(p); !wrong.empty())
        return add("plume", absl::StrCat(wrong, " (season \"", condition.season(), "\")"),
                   findings);
    }
    const auto [at, is_new] =
        known.try_emplace(p.SerializeAsString(), static_cast<std::uint32_t>(resolved.plume_size()));
    if (is_new) *resolved.add_plume() = std::move(p);
    condition.set_plume(at->second);
  }
  if (resolved.plume_size() > kMostPlumes)
    findings.add("plume", absl::StrCat("plume: its conditions have ", resolved.plume_size(),
                                       " different winds and airs, expected at most ", kMostPlumes,
                                       ": split the sweep"));
}

void check_resolved_plumes(const schema::ResolvedSweep& resolved, Findings& findings) {
  const schema::Sweep& sweep = resolved.sweep();
  const auto count = static_cast<std::uint32_t>(resolved.plume_size());
  for (int c = 0; c < resolved.condition_size(); ++c) {
    const schema::Condition& condition = resolved.condition(c);
    const std::string path = absl::StrCat("condition[", c, "].plume");
    if (condition.has_plume() != sweep.has_plume())
      findings.add(path, absl::StrCat(path, sweep.has_plume() ? " is missing" : " does not apply",
                                      sweep.has_plume() ? " with [plume]" : " without [plume]"));
    else if (condition.has_plume() && condition.plume() >= count)
      findings.add(path, absl::StrCat(path, " = ", condition.plume(), ": there is no such plume"));
    if (sweep.has_plume() && !condition.weather().modtran_text().empty())
      findings.add(path, absl::StrCat(path, " and weather.modtran_text are both there"));
  }
  schema::Plume stated = sweep.plume();
  stated.clear_file();
  for (int i = 0; i < resolved.plume_size(); ++i) {
    const schema::ConditionPlume& p = resolved.plume(i);
    const std::string path = absl::StrCat("plume[", i, "]");
    if (!sweep.has_plume() || p.plume().SerializeAsString() != stated.SerializeAsString()) {
      findings.add(path, absl::StrCat(path, ".plume is not that of the sweep"));
      continue;
    }
    const bool of_file = stated.kind() == "file";
    if (of_file != (p.sha256().size() == 64) ||
        p.sha256().find_first_not_of("0123456789abcdef") != std::string::npos)
      findings.add(path, absl::StrCat(path, ".sha256 = \"", p.sha256(), "\", expected ",
                                      of_file ? "a SHA-256 in hex" : "none"));
    if (stated.kind() != "funnel") continue;
    if (const std::string wrong = wrong_air(p); !wrong.empty()) add(path, wrong, findings);
  }
}

}  // namespace irsig
