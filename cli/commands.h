#pragma once

#include <CLI/CLI.hpp>

#include "absl/status/status.h"

namespace irsig {

// Adds a subcommand of `irsig`. Each one is in the file of its name; its callback sets `exit_code`
// to 0 (success), 2 (wrong input of the user) or 1 (any other failure).
void add_show(CLI::App& app, int& exit_code);
void add_show_atmosphere(CLI::App& show, int& exit_code);  // irsig show atmosphere, sky, sun
void add_show_effects(CLI::App& show, int& exit_code);     // irsig show effects
void add_show_gas(CLI::App& show, int& exit_code);
void add_show_solids(CLI::App& show, int& exit_code);        // irsig show solids
void add_show_temperatures(CLI::App& show, int& exit_code);  // irsig show temperatures
void add_model(CLI::App& app, int& exit_code);
void add_model_particles(CLI::App& model, int& exit_code);  // irsig model particles
void add_model_check(CLI::App& model, int& exit_code);      // irsig model check
void add_model_plume(CLI::App& model, int& exit_code);      // irsig model plume
void add_model_terrain(CLI::App& model, int& exit_code);    // irsig model terrain
void add_material(CLI::App& app, int& exit_code);
void add_goniometer(CLI::App& app, int& exit_code);
void add_init(CLI::App& app, int& exit_code);
void add_run(CLI::App& app, int& exit_code);
void add_plan(CLI::App& app, int& exit_code);
void add_report(CLI::App& app, int& exit_code);
void add_serve(CLI::App& app, int& exit_code);
void add_fly(CLI::App& app, int& exit_code);
void add_submit(CLI::App& app, int& exit_code);
void add_status(CLI::App& app, int& exit_code);
void add_cancel(CLI::App& app, int& exit_code);
void add_prioritize(CLI::App& app, int& exit_code);
void add_digest(CLI::App& app, int& exit_code);
void add_doctor(CLI::App& app, int& exit_code);
void add_ca(CLI::App& app, int& exit_code);
void add_slice(CLI::App& app, int& exit_code);
void add_merge(CLI::App& app, int& exit_code);
void add_query(CLI::App& app, int& exit_code);
void add_compare(CLI::App& app, int& exit_code);
void add_bands(CLI::App& app, int& exit_code);
void add_explain(CLI::App& app, int& exit_code);
void add_export(CLI::App& app, int& exit_code);
void add_plot(CLI::App& app, int& exit_code);
void add_accuracy(CLI::App& app, int& exit_code);
void add_selftest(CLI::App& app, int& exit_code);
void add_verify_effects(CLI::App& app, int& exit_code);
void add_profile(CLI::App& app, int& exit_code);
void add_completion(CLI::App& app, int& exit_code);  // of all commands added before and after
void add_manual(CLI::App& app, int& exit_code);      // generated man pages and reference tables

// Prints the message to standard error, after "irsig: " unless it begins with a place in a file,
// and returns the exit code of the status. It is 0 for OK; 2 for errors of the user's input
// (INVALID_ARGUMENT, NOT_FOUND, OUT_OF_RANGE, PERMISSION_DENIED and UNAUTHENTICATED); 1 otherwise.
[[nodiscard]] int report(const absl::Status& status);

}  // namespace irsig
