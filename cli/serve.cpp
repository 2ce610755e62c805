#include "serve/serve.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "cli/target_extent.h"
#include "jobs/detector_file.h"
#include "view/print.h"

namespace irsig {

void add_serve(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "serve",
      "Show signature databases in a web browser: maps over all aspects, cuts, spectra, images, "
      "errors; two conditions side by side. Only reads, also while a sweep runs");
  const auto options = std::make_shared<ServeOptions>();
  command->add_option("DB", options->database, "The databases, written by irsig")->required();
  const auto detectors = std::make_shared<std::vector<std::string>>();
  command
      ->add_option("--detector", *detectors,
                   "A detector to choose bands for, as of irsig bands; may be repeated")
      ->type_name("FILE");
  command
      ->add_option("--address", options->address,
                   "IP address to listen at; another than a loopback address lets the network read "
                   "the databases, without a password (default: " +
                       options->address + ")")
      ->type_name("IP");
  command
      ->add_option(
          "--port", options->port,
          "Port to listen at; 0: one that is free (default: " + std::to_string(options->port) + ")")
      ->type_name("PORT");
  command->callback([options, detectors, &exit_code] {
    for (const std::string& file : *detectors) {
      auto read = read_detector(file);
      if (!read.ok()) {
        exit_code = report(read.status());
        return;
      }
      options->detector.push_back({file, read->name, std::move(read->detector)});
    }
    options->extent_of = stored_target_extent;
    options->on_ready = [](const std::string& url, const std::string& warning) {
      if (!warning.empty()) print_note("irsig: warning: {}\n", warning);
      print_text("{}\n", url);
      std::fflush(stdout);
      print_note("irsig: open this address in a browser; Ctrl-C ends it\n");
    };
    exit_code = report(serve(*options));
  });
}

}  // namespace irsig
