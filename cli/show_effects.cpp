#include <fmt/format.h>

#include <iostream>
#include <string>

#include "cli/commands.h"
#include "core/effects/effects.h"
#include "view/print.h"
#include "view/table.h"

namespace irsig {
namespace {

std::string text(std::string_view view) { return std::string(view); }

void print_for_people() {
  print_text(
      "Effects: what a signature is made of. Those marked * can be left out ([effects] of a sweep\n"
      "file, --effects): by themselves where the accuracy asked for has room for their bound.\n");
  for (const EffectInfo& e : effect_table()) {
    print_text("\n{}{}: {}\n", text(e.name), e.switchable ? " *" : "", text(e.what));
    print_text("  matters  {}\n", text(e.when));
    if (e.switchable) print_text("  bound    {}\n", text(e.bound));
    print_text("  costs    {}\n", text(e.cost));
  }
}

absl::Status print_effects(const std::string& format) {
  if (format == "text") {
    print_for_people();
    return absl::OkStatus();
  }
  auto writer = make_table_writer(
      format, {{"effect"}, {"what"}, {"matters"}, {"bound"}, {"cost"}, {"switchable"}},
      data_output());
  if (!writer.ok()) return writer.status();
  for (const EffectInfo& e : effect_table())
    (*writer)->row(
        {text(e.name), text(e.what), text(e.when), text(e.bound), text(e.cost), e.switchable});
  return (*writer)->finish();
}

}  // namespace

void add_show_effects(CLI::App& show, int& exit_code) {
  auto* command = show.add_subcommand(
      "effects",
      "Every effect: what it is, when it matters, how its bound is found, what it costs");
  auto format = std::make_shared<std::string>("text");
  command->add_option("--format", *format, "text (for people), csv or json")
      ->type_name("FORMAT")
      ->check(CLI::IsMember({"text", "csv", "json"}))
      ->capture_default_str();
  command->callback([=, &exit_code] { exit_code = report(print_effects(*format)); });
}

}  // namespace irsig
