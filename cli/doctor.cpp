#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/output_options.h"
#include "core/base/status_macros.h"
#include "runner/job_runner.h"
#include "schema/store/whole/examine.h"
#include "view/base/print.h"
#include "view/base/table.h"

namespace irsig {
namespace {

const char* name_of(StoreFinding::Kind kind) {
  switch (kind) {
    case StoreFinding::Kind::kDamaged:
      return "damaged";
    case StoreFinding::Kind::kMissing:
      return "missing";
    case StoreFinding::Kind::kOld:
      return "old";
  }
  return "";
}

struct DoctorCommand {
  explicit DoctorCommand(CLI::App& command) : output(command, {"text", "csv", "json"}) {
    command.add_option("DB", database, "the database")->required();
    command.add_flag("--accept", accept,
                     "make one plain file of a database whose header asks for a journal "
                     "(DB-wal), if nothing in it is damaged: what it holds is the database then, "
                     "also where the journal is missing");
  }
  OutputOptions output;
  std::string database;
  bool accept = false;

  [[nodiscard]] absl::StatusOr<std::vector<StoreFinding>> findings_of() const {
    if (!accept) return examine(database, physics_version());
    ASSIGN_OR_RETURN(auto accepted, accept_file(database, physics_version()));
    if (accepted.made_plain) {
      print_note(
          "irsig: {}: is one plain file now; what it holds is the database: {} sweep{}, {} "
          "rows\n",
          database, accepted.sweeps, accepted.sweeps == 1 ? "" : "s", accepted.rows);
    } else if (!accepted.damaged) {
      print_note("irsig: {}: is one plain file already: nothing to accept\n", database);
    }
    return std::move(accepted.findings);
  }

  [[nodiscard]] absl::Status run() const {
    ASSIGN_OR_RETURN(const auto findings, findings_of());
    const absl::Status written = output.write([&](std::string_view format, std::ostream& out) {
      if (format == "text" && findings.empty()) {
        out << database << ": nothing is damaged, missing or old\n";
        return absl::OkStatus();
      }
      auto writer = make_table_writer(format, {{"kind"}, {"finding"}}, out);
      if (!writer.ok()) return writer.status();
      for (const StoreFinding& f : findings) (*writer)->row({std::string(name_of(f.kind)), f.what});
      return (*writer)->finish();
    });
    if (!written.ok()) return written;
    for (const StoreFinding& f : findings)
      if (f.kind == StoreFinding::Kind::kDamaged)
        return absl::DataLossError(database +
                                   (accept ? " is damaged, and stays as it is" : " is damaged"));
    return absl::OkStatus();
  }
};

}  // namespace

void add_doctor(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "doctor",
      "Read all of a database and report what is damaged, missing or old: the file, "
      "references, hashes, numbers, spectra, images, jobs. Exit code 1: damaged. With "
      "--accept, a database whose journal is missing becomes one plain file.");
  const auto options = std::make_shared<DoctorCommand>(*command);
  command->callback([options, &exit_code] { exit_code = report(options->run()); });
}

}  // namespace irsig
