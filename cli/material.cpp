#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "cli/choose_material.h"
#include "cli/commands.h"
#include "cli/material_plot.h"
#include "cli/output_options.h"
#include "cli/positive_number.h"
#include "core/base/status_macros.h"
#include "core/materials/material_check.h"
#include "core/materials/optical/angular_table.h"
#include "view/base/table.h"

namespace irsig {
namespace {

std::string range_text(const WavelengthRange& range) {
  return range.everywhere ? "any" : fmt::format("{:g} to {:g}", range.min_um, range.max_um);
}

absl::Status list_materials(std::string_view format, std::ostream& out) {
  const auto table = make_table_writer(format,
                                       {{"name"},
                                        {"kind"},
                                        {"lambda_um"},
                                        {"description"},
                                        {"source", false},
                                        {"licence", false},
                                        {"provenance", false}},
                                       out);
  if (!table.ok()) return table.status();
  for (const LibraryEntry& e : material_library())
    (*table)->row({e.spec.name, model_kind(e.spec), range_text(wavelength_range(e.spec)),
                   e.description, e.source, e.licence, e.provenance});
  const std::string paper = "X. Zhou et al., Appl. Sci. 16 (2026) 2318, table of the ship's hull";
  const std::string ours = "that of this project";
  for (const auto& [name, description, provenance] :
       std::initializer_list<std::array<std::string, 3>>{
           {"hull", "the ship paper's hull, emissivity 0.8 at normal incidence",
            "The paper's n + ik = 1.2 + 5.0i and roughness 0.3, scaled to its emissivity of 0.8."},
           {"hull_index", "the ship paper's hull, as its optical constants say",
            "n + ik = 1.2 + 5.0i and roughness 0.3: emissivity 0.165 at normal incidence."},
           {"hull_paper", "the ship paper's hull as printed: creates energy",
            "Emissivity 0.8 and the unscaled lobe at once; needs allow_energy_gain = true."}})
    (*table)->row({name, std::string("cook_torrance"), std::string("any"), description, paper, ours,
                   provenance});
  return (*table)->finish();
}

struct ShowOptions {
  explicit ShowOptions(CLI::App& command) : output(command, {"text", "csv", "json"}) {}
  OutputOptions output;
  std::string name;
  std::vector<double> lambda_um;
  std::vector<double> theta_i_deg = {0, 15, 30, 45, 60, 70, 75, 80, 85, 89};
};

absl::Status write_long(const AngularTable& table, std::string_view format, std::ostream& out) {
  const auto writer =
      make_table_writer(format, {{"lambda_um"}, {"theta_i_deg"}, {"dhr"}, {"emissivity"}}, out);
  if (!writer.ok()) return writer.status();
  for (const AngularValue& v : table.value)
    (*writer)->row({v.lambda_um, v.theta_i_deg, v.dhr, v.emissivity});
  return (*writer)->finish();
}

// For people: one line an angle, two columns a wavelength.
absl::Status write_wide(const AngularTable& table, std::size_t wavelengths, std::size_t angles,
                        std::ostream& out) {
  std::vector<Column> columns = {{"theta_i_deg"}};
  for (std::size_t i = 0; i < wavelengths; ++i) {
    const double um = table.value[i * angles].lambda_um;
    columns.push_back({fmt::format("dhr {:g} um", um)});
    columns.push_back({fmt::format("emissivity {:g} um", um)});
  }
  ASSIGN_OR_RETURN(const auto writer, make_table_writer("text", columns, out));
  for (std::size_t t = 0; t < angles; ++t) {
    std::vector<Cell> cells = {table.value[t].theta_i_deg};
    for (std::size_t i = 0; i < wavelengths; ++i) {
      cells.emplace_back(table.value[i * angles + t].dhr);
      cells.emplace_back(table.value[i * angles + t].emissivity);
    }
    writer->row(cells);
  }
  return writer->finish();
}

absl::Status show(const ShowOptions& asked) {
  ASSIGN_OR_RETURN(const auto material, choose_material(asked.name));
  const auto& lambda_um = asked.lambda_um.empty() ? material.lambda_um : asked.lambda_um;
  const auto table = angular_table(material.spec, lambda_um, asked.theta_i_deg);
  if (!table.ok())
    return absl::InvalidArgumentError(absl::StrCat(asked.name, ": ", table.status().message()));
  return asked.output.write([&](std::string_view format, std::ostream& out) {
    if (format != "text") return write_long(*table, format, out);
    out << fmt::format("{}: {}, known at {} um\n", material.spec.name, model_kind(material.spec),
                       range_text(wavelength_range(material.spec)));
    const LibraryEntry& e = material.entry;
    if (!e.description.empty())
      out << fmt::format("{}\nsource: {}\nlicence: {}\n{}\n", e.description, e.source, e.licence,
                         e.provenance);
    if (table->creates_energy) out << "It creates energy: dhr + emissivity is above 1 somewhere.\n";
    out << "\n";
    return write_wide(*table, lambda_um.size(), asked.theta_i_deg.size(), out);
  });
}

struct PlotOptions {
  explicit PlotOptions(CLI::App& command) : output(command, {"svg"}) {
    output.out_option()->required();
  }
  OutputOptions output;
  std::string name;
  std::vector<double> lambda_um;
  double min_um = 0, max_um = 0;
};

absl::Status plot(const PlotOptions& asked) {
  ASSIGN_OR_RETURN(auto material, choose_material(asked.name));
  if (!asked.lambda_um.empty()) material.lambda_um = asked.lambda_um;
  if (asked.min_um > 0) material.min_um = asked.min_um;
  if (asked.max_um > 0) material.max_um = asked.max_um;
  if (!(material.min_um < material.max_um))
    return absl::InvalidArgumentError(absl::StrCat("wavelengths from ", material.min_um, " to ",
                                                   material.max_um,
                                                   " um, expected an increasing range"));
  const auto svg = plot_material(material);
  if (!svg.ok())
    return absl::InvalidArgumentError(absl::StrCat(asked.name, ": ", svg.status().message()));
  return asked.output.write(*svg);
}

// The ends of where it is known, and the usual wavelengths between them.
std::vector<double> checked_um(const ChosenMaterial& material) {
  if (wavelength_range(material.spec).everywhere) return {10};
  std::vector<double> out = material.lambda_um;
  out.push_back(material.min_um);
  out.push_back(material.max_um);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

struct CheckCount {
  std::size_t rows = 0, failed = 0;
};

absl::Status check(const std::string& name, const std::string& sweep, std::string_view format,
                   std::ostream& to, CheckCount& count) {
  std::vector<ChosenMaterial> materials;
  if (!sweep.empty()) {
    ASSIGN_OR_RETURN(materials, materials_of_sweep(sweep));
    if (materials.empty())
      return absl::InvalidArgumentError(absl::StrCat(sweep, ": it has no material"));
  } else {
    ASSIGN_OR_RETURN(auto one, choose_material(name));
    materials.push_back(std::move(one));
  }
  const auto out = make_table_writer(
      format, {{"material"}, {"check"}, {"worst"}, {"bound"}, {"passed"}, {"where"}}, to);
  if (!out.ok()) return out.status();
  for (const ChosenMaterial& material : materials) {
    const auto found = check_material(material.spec, checked_um(material));
    if (!found.ok())
      return absl::InvalidArgumentError(
          absl::StrCat(material.spec.name, ": ", found.status().message()));
    for (const MaterialCheckRow& row : *found) {
      ++count.rows;
      count.failed += row.passed ? 0 : 1;
      (*out)->row({material.spec.name, row.check, row.worst, row.bound, row.passed, row.where});
    }
  }
  return (*out)->finish();
}

constexpr const char* kNameHelp = "A name that `list` prints, or SWEEP.toml:MATERIAL";

}  // namespace

void add_material(CLI::App& app, int& exit_code) {
  CLI::App* material = app.add_subcommand(
      "material", "The material library, and what any material reflects and emits");
  material->require_subcommand(1);

  CLI::App* list_command =
      material->add_subcommand("list", "Materials that come with irsig, and where they are from");
  const auto listed = std::make_shared<OutputOptions>(
      *list_command, std::vector<std::string>{"text", "csv", "json"});
  list_command->footer("csv and json also have sources, licences and provenance.");
  list_command->callback(
      [listed, &exit_code] { exit_code = report(listed->write(list_materials)); });

  CLI::App* show_command = material->add_subcommand(
      "show", "Reflectance (DHR) and emissivity against angle and wavelength");
  const auto shown = std::make_shared<ShowOptions>(*show_command);
  show_command->add_option("MATERIAL", shown->name, kNameHelp)->required()->type_name("NAME");
  show_command->add_option("--lambda-um", shown->lambda_um, "Wavelengths, separated by commas")
      ->type_name("UM")
      ->delimiter(',')
      ->check(positive_number());
  show_command->add_option("--theta-i-deg", shown->theta_i_deg, "Angles from the normal, 0 to 90")
      ->type_name("DEG")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 90.0));
  show_command->footer("csv and json have one line for each angle and wavelength.");
  show_command->callback([shown, &exit_code] { exit_code = report(show(*shown)); });

  CLI::App* plot_command =
      material->add_subcommand("plot", "Both against angle and against wavelength, as SVG");
  const auto plotted = std::make_shared<PlotOptions>(*plot_command);
  plot_command->add_option("MATERIAL", plotted->name, kNameHelp)->required()->type_name("NAME");
  plot_command
      ->add_option("--lambda-um", plotted->lambda_um, "Wavelengths of the curves over angle")
      ->type_name("UM")
      ->delimiter(',')
      ->check(positive_number());
  plot_command
      ->add_option("--lambda-min-um", plotted->min_um, "Shortest wavelength of the curves over it")
      ->type_name("UM")
      ->check(positive_number());
  plot_command
      ->add_option("--lambda-max-um", plotted->max_um, "Longest wavelength of the curves over it")
      ->type_name("UM")
      ->check(positive_number());
  plot_command->callback([plotted, &exit_code] { exit_code = report(plot(*plotted)); });

  struct CheckOptions {
    explicit CheckOptions(CLI::App& command) : output(command, {"text", "csv", "json"}) {}
    OutputOptions output;
    std::string name, sweep;

    [[nodiscard]] absl::Status run() const {
      if (name.empty() && sweep.empty())
        return absl::InvalidArgumentError("material check: name one, or --sweep-file FILE");
      CheckCount count;
      const absl::Status status = output.write([&](std::string_view format, std::ostream& out) {
        return check(name, sweep, format, out, count);
      });
      if (!status.ok() || count.failed == 0) return status;
      return absl::FailedPreconditionError(
          absl::StrCat(count.failed, " of ", count.rows, " checks failed"));
    }
  };
  CLI::App* check_command = material->add_subcommand(
      "check", "Reciprocity, energy, emissivity + DHR = 1, sampling; exit code 1 if one fails");
  const auto checked = std::make_shared<CheckOptions>(*check_command);
  CLI::Option* name =
      check_command->add_option("MATERIAL", checked->name, kNameHelp)->type_name("NAME");
  CLI::Option* sweep =
      check_command->add_option("--sweep-file", checked->sweep, "Sweep file: each of its materials")
          ->type_name("FILE");
  name->excludes(sweep);
  check_command->callback([checked, &exit_code] { exit_code = report(checked->run()); });
}

}  // namespace irsig
