#include "serve/serve.h"

#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "cli/commands.h"
#include "cli/target_extent.h"
#include "coordinator/client/address.h"
#include "coordinator/client/farm_client.h"
#include "coordinator/client/progress_text.h"
#include "core/base/status_macros.h"
#include "core/base/user_file.h"
#include "jobs/files/detector_file.h"
#include "view/base/print.h"

namespace irsig {
namespace {

PageFarm page_farm(const schema::StatusReply& status) {
  PageFarm out;
  out.workers = status.workers();
  for (const auto& w : status.worker()) {
    const bool computes = w.state() == schema::WorkerStatus::STATE_COMPUTING;
    out.worker.push_back({w.name(), std::string(state_name(w.state())),
                          computes ? std::optional(w.job_s()) : std::nullopt, w.job_key(),
                          w.determinism_class(), w.reason(), w.memory_bytes()});
  }
  out.warning.assign(status.warning().begin(), status.warning().end());
  return out;
}

struct ServeCommand {
  ServeOptions options;
  std::vector<std::string> detectors;
  std::string coordinator, accuracy;
  NetworkOptions network;

  [[nodiscard]] absl::Status run() {
    for (const std::string& file : detectors) {
      ASSIGN_OR_RETURN(auto read, read_detector(file));
      options.detector.push_back({file, read.name, std::move(read.detector)});
    }
    if (!accuracy.empty()) {
      auto page = read_user_file(accuracy, kMostTableBytes);
      if (!page.ok())
        return absl::InvalidArgumentError(absl::StrCat(accuracy, ": ", page.status().message()));
      options.accuracy_page = *std::move(page);
    }
    if (!coordinator.empty()) {
      const auto address = parse_address(coordinator, network);
      if (!address.ok()) return address.status();
      options.farm = [address = *address]() -> absl::StatusOr<PageFarm> {
        ASSIGN_OR_RETURN(const auto status, farm_status(address, kPatience_s));
        return page_farm(status);
      };
    }
    options.extent_of = stored_target_extent;
    options.on_ready = [](const std::string& url, const std::string& warning) {
      if (!warning.empty()) print_note("irsig: warning: {}\n", warning);
      print_text("{}\n", url);
      std::fflush(stdout);
      print_note("irsig: open this address in a browser; Ctrl-C ends it\n");
    };
    return serve(options);
  }

 private:
  static constexpr double kPatience_s = 2;  // a page waits for it
};

}  // namespace

void add_serve(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "serve",
      "Show signature databases in a web browser: maps over all aspects, cuts, spectra, images, "
      "errors; two conditions side by side. Only reads, also while a sweep runs");
  const auto asked = std::make_shared<ServeCommand>();
  ServeOptions& options = asked->options;
  command->add_option("DB", options.database, "The databases, written by irsig")->required();
  command
      ->add_option("--detector", asked->detectors,
                   "A detector to choose bands for, as of irsig bands; may be repeated")
      ->type_name("FILE");
  command
      ->add_option("--coordinator", asked->coordinator,
                   "unix:PATH or HOST:PORT of a coordinator: the page shows its workers")
      ->type_name("ADDRESS");
  add_network_options(*command, asked->network);
  command
      ->add_option("--accuracy", asked->accuracy,
                   "The accuracy.html of irsig accuracy, to be shown beside the database")
      ->type_name("FILE");
  command
      ->add_option(
          "--address", options.address,
          "IP address to listen at; with another than a loopback address the secret in the "
          "printed address crosses the network unencrypted (default: " +
              options.address + ")")
      ->type_name("IP");
  command
      ->add_option(
          "--port", options.port,
          "Port to listen at; 0: one that is free (default: " + std::to_string(options.port) + ")")
      ->type_name("PORT");
  command->callback([asked, &exit_code] { exit_code = report(asked->run()); });
}

}  // namespace irsig
