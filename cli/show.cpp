#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "cli/commands.h"
#include "cli/output_options.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/base/user_file.h"
#include "core/spectral/planck.h"
#include "core/study/precompute.h"
#include "jobs/text/sweep_file.h"
#include "view/base/table.h"

namespace irsig {
namespace {

// A table of one row: what was asked for, by name.
using Columns = std::vector<std::pair<std::string, double>>;

absl::Status write(const Columns& columns, std::string_view format, std::ostream& out) {
  std::vector<Column> heads;
  std::vector<Cell> cells;
  for (const auto& [name, value] : columns) {
    heads.push_back({name});
    cells.emplace_back(value);
  }
  ASSIGN_OR_RETURN(auto writer, make_table_writer(format, heads, out));
  writer->row(cells);
  return writer->finish();
}

// ---- show planck

struct PlanckOptions {
  std::optional<double> temperature_k, lambda_um, lambda_min_um, lambda_max_um, radiance_w_m2_sr,
      spectral_radiance_w_m2_sr_um;
};

constexpr double kAny = std::numeric_limits<double>::max();

absl::Status in_range(const char* option, std::optional<double> value, double min, double max) {
  if (!value || (*value >= min && *value <= max)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      max == kAny ? absl::StrCat(option, " ", *value, ": expected at least ", min)
                  : absl::StrCat(option, " ", *value, ": expected ", min, " to ", max));
}

absl::Status check_combination(const PlanckOptions& given) {
  const bool band = given.lambda_min_um && given.lambda_max_um;
  const char* missing = nullptr;
  if (given.lambda_min_um.has_value() != given.lambda_max_um.has_value()) {
    missing = "--lambda-min-um and --lambda-max-um belong together";
  } else if (!given.temperature_k && !given.radiance_w_m2_sr &&
             !given.spectral_radiance_w_m2_sr_um) {
    missing = "expected --temperature-k, --radiance-w-m2-sr or --spectral-radiance-w-m2-sr-um";
  } else if (given.temperature_k &&
             (given.radiance_w_m2_sr || given.spectral_radiance_w_m2_sr_um)) {
    missing = "expected either --temperature-k or a radiance, not both";
  } else if (given.radiance_w_m2_sr && given.spectral_radiance_w_m2_sr_um) {
    missing = "expected either --radiance-w-m2-sr or --spectral-radiance-w-m2-sr-um, not both";
  } else if (given.temperature_k && !band && !given.lambda_um) {
    missing = "--temperature-k needs --lambda-um, or --lambda-min-um and --lambda-max-um";
  } else if (given.radiance_w_m2_sr && (!band || given.lambda_um)) {
    missing = "--radiance-w-m2-sr needs --lambda-min-um and --lambda-max-um (and no --lambda-um)";
  } else if (given.spectral_radiance_w_m2_sr_um && (band || !given.lambda_um)) {
    missing = "--spectral-radiance-w-m2-sr-um needs --lambda-um (and no band)";
  } else if (band && !(*given.lambda_min_um < *given.lambda_max_um)) {
    return absl::InvalidArgumentError(
        absl::StrCat("show planck: --lambda-min-um ", *given.lambda_min_um,
                     " is not below --lambda-max-um ", *given.lambda_max_um));
  }
  if (missing == nullptr) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("show planck: ", missing));
}

absl::StatusOr<Columns> planck(const PlanckOptions& given) {
  for (const absl::Status& status :
       {in_range("--temperature-k", given.temperature_k, 0, kPlanckTemperatureMaxK),
        in_range("--lambda-um", given.lambda_um, kPlanckLambdaMinUm, kPlanckLambdaMaxUm),
        in_range("--lambda-min-um", given.lambda_min_um, kPlanckLambdaMinUm, kPlanckLambdaMaxUm),
        in_range("--lambda-max-um", given.lambda_max_um, kPlanckLambdaMinUm, kPlanckLambdaMaxUm),
        in_range("--radiance-w-m2-sr", given.radiance_w_m2_sr, 0, kAny),
        in_range("--spectral-radiance-w-m2-sr-um", given.spectral_radiance_w_m2_sr_um, 0, kAny),
        check_combination(given)}) {
    if (!status.ok()) return status;
  }
  Columns out;
  if (given.temperature_k && given.lambda_min_um) {
    out.emplace_back("radiance_w_m2_sr",
                     planck_band_radiance_w_m2_sr(*given.lambda_min_um, *given.lambda_max_um,
                                                  *given.temperature_k));
  }
  if (given.temperature_k && given.lambda_um) {
    out.emplace_back("spectral_radiance_w_m2_sr_um",
                     planck_radiance_w_m2_sr_um(*given.lambda_um, *given.temperature_k));
  }
  if (given.spectral_radiance_w_m2_sr_um) {
    const double most = planck_radiance_w_m2_sr_um(*given.lambda_um, kPlanckTemperatureMaxK);
    RETURN_IF_ERROR(
        in_range("--spectral-radiance-w-m2-sr-um", given.spectral_radiance_w_m2_sr_um, 0, most));
    out.emplace_back(
        "radiance_temperature_k",
        monochromatic_temperature_k(*given.lambda_um, *given.spectral_radiance_w_m2_sr_um));
  }
  if (given.radiance_w_m2_sr) {
    const double most = planck_band_radiance_w_m2_sr(*given.lambda_min_um, *given.lambda_max_um,
                                                     kPlanckTemperatureMaxK);
    RETURN_IF_ERROR(in_range("--radiance-w-m2-sr", given.radiance_w_m2_sr, 0, most));
    out.emplace_back("radiance_temperature_k",
                     radiance_temperature_k(*given.lambda_min_um, *given.lambda_max_um,
                                            *given.radiance_w_m2_sr));
  }
  return out;
}

// ---- show precompute

// Reads the values of a [precompute] table, all of which are required.
class PrecomputeTable {
 public:
  explicit PrecomputeTable(const SweepFile& file) : file_(file), table_(file.sweep.precompute()) {}

  double number(const char* key) {
    const auto* field = table_.GetDescriptor()->FindFieldByName(key);
    if (!table_.GetReflection()->HasField(table_, field))
      refuse(absl::StrCat("precompute.", key), "is missing");
    return table_.GetReflection()->GetDouble(table_, field);
  }

  double of_season(const char* key, const google::protobuf::Map<std::string, double>& by_season,
                   const std::string& season) {
    const auto found = by_season.find(season);
    if (found != by_season.end()) return found->second;
    refuse(absl::StrCat("precompute.", key),
           absl::StrCat("has no value for the season \"", season, "\""));
    return 0;
  }

  void refuse(const std::string& path, const std::string& why) {
    wrong_.add({file_.location(path), path, absl::StrCat(path, " ", why)});
  }

  [[nodiscard]] absl::Status status() const { return wrong_.status(); }

 private:
  const SweepFile& file_;
  const schema::Precompute& table_;
  Problems wrong_;
};

// The sweep's seasons in their order; without any, those of the table in alphabetical order.
std::vector<std::string> seasons_of(const schema::Sweep& sweep, PrecomputeTable& table) {
  std::vector<std::string> out;
  for (const schema::Season& season : sweep.season()) out.push_back(season.name());
  const std::set<std::string> declared(out.begin(), out.end());
  std::set<std::string> mentioned;
  for (const auto& [name, value] : sweep.precompute().ambient_temperature_k())
    mentioned.insert(name);
  for (const auto& [name, value] : sweep.precompute().air_temperature_k()) mentioned.insert(name);
  if (declared.empty()) return {mentioned.begin(), mentioned.end()};
  for (const std::string& name : mentioned) {
    if (!declared.contains(name)) {
      table.refuse("precompute",
                   absl::StrCat("names \"", name, "\", which is no season of this sweep"));
    }
  }
  return out;
}

absl::Status precompute(const std::string& file_name, std::string_view format, std::ostream& out) {
  const absl::StatusOr<std::string> text = read_user_file(file_name, kMostSpecBytes);
  if (!text.ok())
    return absl::InvalidArgumentError(absl::StrCat(file_name, ": ", text.status().message()));
  ASSIGN_OR_RETURN(const SweepFile file, parse_sweep(*text, file_name));
  if (!file.sweep.has_precompute()) {
    return absl::InvalidArgumentError(absl::StrCat(file_name, ": it has no [precompute] table"));
  }

  PrecomputeTable table(file);
  const schema::Precompute& given = file.sweep.precompute();
  const std::vector<std::string> seasons = seasons_of(file.sweep, table);
  if (seasons.empty()) table.refuse("precompute", "gives no temperature for any season");
  PrecomputeCase target{};
  target.hot_area_m2 = table.number("hot_area_m2");
  target.hot_temperature_k = table.number("hot_temperature_k");
  target.ambient_area_m2 = table.number("ambient_area_m2");
  target.emissivity = table.number("emissivity");
  target.reflected_exitance_w_m2_um = table.number("reflected_exitance_w_m2_um");
  target.absorption_m2_kg = table.number("absorption_m2_kg");
  target.range_m = table.number("range_m");
  target.pressure_pa = table.number("pressure_pa");
  target.gas_constant_j_kg_k = table.number("gas_constant_j_kg_k");
  const double lambda_min_um = table.number("lambda_min_um");
  const double lambda_max_um = table.number("lambda_max_um");
  const double step_um = table.number("step_um");
  std::vector<PrecomputeCase> targets;
  for (const std::string& season : seasons) {
    target.ambient_temperature_k =
        table.of_season("ambient_temperature_k", given.ambient_temperature_k(), season);
    target.air_temperature_k =
        table.of_season("air_temperature_k", given.air_temperature_k(), season);
    targets.push_back(target);
  }
  RETURN_IF_ERROR(table.status());

  std::vector<std::vector<SpectralPoint>> spectra;
  for (std::size_t i = 0; i < seasons.size(); ++i) {
    auto spectrum = precompute_spectrum(targets[i], lambda_min_um, lambda_max_um, step_um);
    if (!spectrum.ok()) {
      std::vector<Problem> problems = problems_of(spectrum.status());
      for (Problem& problem : problems)
        problem = {file.location("precompute"), "precompute",
                   absl::StrCat("season \"", seasons[i], "\": ", problem.text)};
      return problem_status(problems);
    }
    spectra.push_back(*std::move(spectrum));
  }
  auto writer =
      make_table_writer(format, {{"season"}, {"lambda_um"}, {"spectral_intensity_w_sr_um"}}, out);
  if (!writer.ok()) return writer.status();
  for (std::size_t i = 0; i < seasons.size(); ++i) {
    for (const SpectralPoint& point : spectra[i])
      (*writer)->row({seasons[i], point.lambda_um, point.value});
  }
  return (*writer)->finish();
}

// For scripts first.
const std::vector<std::string> kFormats = {"csv", "json", "text"};

}  // namespace

void add_show(CLI::App& app, int& exit_code) {
  CLI::App* show = app.add_subcommand(
      "show", "Blackbody radiation, the air, the sky, the sun, effects, the precomputation model");
  show->require_subcommand(1);

  const auto planck_given = std::make_shared<PlanckOptions>();
  CLI::App* planck_command =
      show->add_subcommand("planck", "Blackbody radiance, or the temperature that has it");
  planck_command->add_option("--temperature-k", planck_given->temperature_k,
                             "Temperature of the blackbody");
  planck_command->add_option("--lambda-um", planck_given->lambda_um, "One wavelength");
  planck_command->add_option("--lambda-min-um", planck_given->lambda_min_um,
                             "Shortest wavelength of a band");
  planck_command->add_option("--lambda-max-um", planck_given->lambda_max_um,
                             "Longest wavelength of a band");
  planck_command->add_option("--radiance-w-m2-sr", planck_given->radiance_w_m2_sr,
                             "In-band radiance, to be turned into a radiance temperature");
  planck_command->add_option("--spectral-radiance-w-m2-sr-um",
                             planck_given->spectral_radiance_w_m2_sr_um,
                             "The same at one wavelength");
  const auto planck_output = std::make_shared<OutputOptions>(*planck_command, kFormats);
  planck_command->callback([=, &exit_code] {
    const auto columns = planck(*planck_given);
    exit_code = report(!columns.ok()
                           ? columns.status()
                           : planck_output->write([&](std::string_view format, std::ostream& out) {
                               return write(*columns, format, out);
                             }));
  });

  add_show_atmosphere(*show, exit_code);
  add_show_effects(*show, exit_code);
  add_show_gas(*show, exit_code);
  add_show_solids(*show, exit_code);
  add_show_temperatures(*show, exit_code);

  const auto sweep_file = std::make_shared<std::string>();
  CLI::App* precompute_command = show->add_subcommand(
      "precompute", "The ship paper's closed-form model (Eq. 12) of a sweep's [precompute] table");
  precompute_command->add_option("SWEEP", *sweep_file, "Sweep file")->required();
  const auto precompute_output = std::make_shared<OutputOptions>(*precompute_command, kFormats);
  precompute_command->callback([=, &exit_code] {
    exit_code = report(precompute_output->write([&](std::string_view format, std::ostream& out) {
      return precompute(*sweep_file, format, out);
    }));
  });
}

}  // namespace irsig
