#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "cli/commands.h"
#include "cli/flight.h"
#include "core/base/status_macros.h"
#include "live/page/fly_page.h"
#include "planning/machine.h"
#include "schema/store/reader.h"
#include "view/base/print.h"

namespace irsig {
namespace {

struct FlyCommand {
  std::string sweep_path, keep_path, film_path;
  std::string address = "127.0.0.1";
  int port = 8018;
  std::uint32_t threads = 0;

  [[nodiscard]] absl::Status run() {
    RETURN_IF_ERROR(check_names());
    ASSIGN_OR_RETURN(auto flight, Flight::load(sweep_path));
    if (threads == 0) threads = usable_cores();
    if (!film_path.empty()) return write_film(flight, threads, film_path);
    ASSIGN_OR_RETURN(const auto session,
                     LiveSession::open([&](const LiveAsk& ask) { return flight.input(ask); },
                                       flight.first(), threads));
    std::uint32_t kept = 0;  // the page keeps one image after the other
    const absl::Status served = serve_flight(
        *session, {.title = flight.loaded().resolved.sweep().name(),
                   .condition = flight.conditions(),
                   .band = flight.bands(),
                   .keeps_hours = flight.loaded().resolved.heat_size() > 0,
                   .first = flight.first(),
                   .address = address,
                   .port = port,
                   .sweep_text = [&](const LiveAsk& ask) { return flight.view_text(ask, "view"); },
                   .keep = [&](const LiveAsk& ask) { return keep(flight, ask, ++kept); },
                   .on_ready =
                       [&](const std::string& url) {
                         print_text("{}\n", url);
                         std::fflush(stdout);
                         print_note("irsig: open this address in a browser; Ctrl-C ends it\n");
                       }});
    if (served.ok()) end_at_once();
    return served;
  }

 private:
  // Ends the program without waiting for the picture at rest, of which a round over land takes a
  // minute. What is measured there is stored nowhere; images that are kept are written by then.
  [[noreturn]] static void end_at_once() {
    std::fflush(nullptr);
    std::_Exit(0);
  }

  // Both files are written long after the start: a name that cannot be right is refused before.
  [[nodiscard]] absl::Status check_names() const {
    if (!film_path.empty() && !absl::EndsWithIgnoreCase(film_path, ".png") &&
        !absl::EndsWithIgnoreCase(film_path, ".apng"))
      return absl::InvalidArgumentError(absl::StrCat(
          "--film ", film_path,
          ": the film is an animated PNG, expected a name that ends in .png or .apng"));
    std::error_code none;
    if (keep_path.empty() || !std::filesystem::exists(keep_path, none)) return absl::OkStatus();
    return StoreReader::open(keep_path).status();
  }

  // The sweep of the view is written beside the sweep file, whose files it names, and run.
  [[nodiscard]] absl::StatusOr<std::string> keep(const Flight& flight, const LiveAsk& ask,
                                                 std::uint32_t number) const {
    if (keep_path.empty())
      return absl::FailedPreconditionError(
          "start irsig fly with --keep DB to keep images in that database");
    return keep_view(flight, ask, number, keep_path);
  }
};

}  // namespace

void add_fly(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "fly",
      "Look at a sweep's scene live in a web browser on this machine, with an error in "
      "every pixel. Orbit the target or fly over land, change hour, band and visibility, "
      "and keep images.");
  const auto asked = std::make_shared<FlyCommand>();
  command->add_option("SWEEP", asked->sweep_path, "The sweep file")->required();
  command
      ->add_option("--keep", asked->keep_path,
                   "Database for the images that are kept on the page; made if there is none")
      ->type_name("DB");
  command
      ->add_option("--film", asked->film_path,
                   "Write an animated PNG of 24 hours, one frame each half an hour, and end")
      ->type_name("FILE");
  command
      ->add_option("--threads", asked->threads,
                   "Threads that draw frames (default: as many as there are cores)")
      ->check(CLI::Range(1, 256));
  command
      ->add_option("--address", asked->address,
                   "Loopback address to listen at (default: 127.0.0.1)")
      ->type_name("IP");
  command
      ->add_option("--port", asked->port, "Port to listen at; 0: one that is free (default: 8018)")
      ->type_name("PORT");
  command->callback([asked, &exit_code] { exit_code = report(asked->run()); });
}

}  // namespace irsig
