#include <exception>
#include <string>

#include "bridge/job_runner.h"
#include "cli/commands.h"
#include "core/base/printable.h"
#include "view/print.h"

namespace {

constexpr const char* kAbout =
    "irsig - infrared signature databases.\n"
    "\n"
    "  irsig init --model FILE        a sweep file to begin with, for a model of your own\n"
    "  irsig run SWEEP --db FILE      compute every season, time, band and viewpoint of a sweep "
    "file\n"
    "  irsig plan SWEEP               what that will take, for every accuracy\n"
    "  irsig query FILE               the signatures: W/sr with standard error, area, temperature\n"
    "  irsig plot FILE --kind polar --out FILE.svg\n"
    "\n"
    "Exit code: 0 done, 2 the input is wrong, 1 anything else failed.";

std::string version() {
  return "irsig " IRSIG_VERSION " (build " + irsig::build_id() + ", physics version " +
         std::to_string(irsig::physics_version()) + ")";
}

}  // namespace

int main(int argc, char** argv) {
  int exit_code = 0;
  CLI::App app(kAbout, "irsig");
  app.set_version_flag("--version", version);
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.require_subcommand(1);
  app.failure_message([](const CLI::App*, const CLI::Error& error) {
    return "irsig: " + irsig::printable(error.what()) + " (--help lists what there is)\n";
  });
  irsig::add_init(app, exit_code);
  irsig::add_run(app, exit_code);
  irsig::add_plan(app, exit_code);
  irsig::add_report(app, exit_code);
  irsig::add_query(app, exit_code);
  irsig::add_explain(app, exit_code);
  irsig::add_plot(app, exit_code);
  irsig::add_profile(app, exit_code);
  irsig::add_export(app, exit_code);
  irsig::add_digest(app, exit_code);
  irsig::add_show(app, exit_code);
  irsig::add_model(app, exit_code);
  irsig::add_material(app, exit_code);
  irsig::add_goniometer(app, exit_code);
  irsig::add_submit(app, exit_code);
  irsig::add_status(app, exit_code);
  irsig::add_cancel(app, exit_code);
  irsig::add_accuracy(app, exit_code);
  irsig::add_verify_effects(app, exit_code);
  irsig::add_selftest(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;  // --help and --version are 0
  } catch (const std::exception& error) {
    // The libraries below throw nothing on purpose: out of memory, mostly.
    irsig::print_note("irsig: {}\n", error.what());
    return 1;
  }
  return exit_code;
}
