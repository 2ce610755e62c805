#include "view/explain.h"

#include <cstdint>
#include <iostream>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "view/print.h"

namespace irsig {
namespace {

struct ExplainAsked {
  std::string db_path, sweep, format = "text";
  std::uint64_t row = 0;
};

absl::Status explain(const ExplainAsked& asked) {
  auto reader = StoreReader::open(asked.db_path);
  if (!reader.ok()) return reader.status();
  return explain_row(**reader, asked.sweep, asked.row, asked.format, data_output());
}

}  // namespace

void add_explain(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand(
      "explain",
      "one row: its values with every error, which effects were simulated and why the others were "
      "not, where the light ends, the split by cause and by part");
  auto asked = std::make_shared<ExplainAsked>();
  command->add_option("DB", asked->db_path, "the database")->required();
  command->add_option("--row", asked->row, "the row's number, as `irsig query` prints it")
      ->required()
      ->type_name("K");
  command->add_option("--sweep", asked->sweep, "the sweep's name, where several have the row")
      ->type_name("NAME");
  command->add_option("--format", asked->format, "text (for people) or json (every number)")
      ->type_name("FORMAT")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  command->callback([=, &exit_code] { exit_code = report(explain(*asked)); });
}

}  // namespace irsig
