#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/output_options.h"
#include "core/thermal/solids.h"
#include "view/base/table.h"

namespace irsig {
namespace {

absl::Status write_solids(std::string_view format, std::ostream& out) {
  auto writer = make_table_writer(format,
                                  {{"solid"},
                                   {"conductivity_w_m_k"},
                                   {"density_kg_m3"},
                                   {"specific_heat_j_kg_k"},
                                   {"description"},
                                   {"source"}},
                                  out);
  if (!writer.ok()) return writer.status();
  for (const Solid& s : solids())
    (*writer)->row({std::string(s.name), s.conductivity_w_m_k, s.density_kg_m3,
                    s.specific_heat_j_kg_k, std::string(s.description), std::string(s.source)});
  return (*writer)->finish();
}

}  // namespace

void add_show_solids(CLI::App& show, int& exit_code) {
  auto* command = show.add_subcommand(
      "solids", "What layers of a [[build_up]] are made of: conductivity, density, specific heat");
  const auto output =
      std::make_shared<OutputOptions>(*command, std::vector<std::string>{"text", "csv", "json"});
  command->callback([output, &exit_code] { exit_code = report(output->write(write_solids)); });
}

}  // namespace irsig
