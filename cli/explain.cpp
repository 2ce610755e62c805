#include "view/report/explain.h"

#include <cstdint>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/output_options.h"
#include "cli/positive_number.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

struct ExplainAsked {
  explicit ExplainAsked(CLI::App& command) : output(command, {"text", "json"}) {}
  OutputOptions output;
  std::string db_path, sweep;
  std::uint64_t row = 0;
};

absl::Status explain(const ExplainAsked& asked) {
  ASSIGN_OR_RETURN(auto reader, StoreReader::open(asked.db_path));
  return asked.output.write([&](std::string_view format, std::ostream& out) {
    return explain_row(*reader, asked.sweep, asked.row, format, out);
  });
}

}  // namespace

void add_explain(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand(
      "explain",
      "Account for one row: its values with every error, the effects that were simulated "
      "and why others were not. Then where the light ends, and the split by cause and by "
      "part.");
  auto asked = std::make_shared<ExplainAsked>(*command);
  command->add_option("DB", asked->db_path, "the database")->required();
  command
      ->add_option("--row", asked->row,
                   "The signature with this row number, as `irsig query` prints it")
      ->check(positive_number())
      ->required()
      ->type_name("K");
  command->add_option("--sweep", asked->sweep, "Name of the sweep, where several have the row")
      ->type_name("NAME");
  command->callback([=, &exit_code] { exit_code = report(explain(*asked)); });
}

}  // namespace irsig
