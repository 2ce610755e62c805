#include <fmt/format.h>

#include <iostream>
#include <string>

#include "cli/commands.h"
#include "cli/output_options.h"
#include "core/effects/effects.h"
#include "view/base/table.h"

namespace irsig {
namespace {

std::string text(std::string_view view) { return std::string(view); }

void write_for_people(std::ostream& out) {
  out << "Effects: what a signature is made of. Those marked * can be left out ([effects] of a "
         "sweep\n"
         "file, --effects): by themselves where the accuracy asked for has room for their bound.\n";
  const auto write = [&](const EffectInfo& e) {
    out << fmt::format("\n{}{}: {}\n  matters  {}\n", e.name, e.switchable ? " *" : "", e.what,
                       e.when);
    if (e.switchable) out << fmt::format("  bound    {}\n", e.bound);
    out << fmt::format("  costs    {}\n", e.cost);
  };
  for (const EffectInfo& e : effect_table()) write(e);
  out << "\nOf a layer of cloud ([[season.cloud]]): in ledgers of rows that have one, and left out "
         "by "
         "its\nbound alone.\n";
  for (const EffectInfo& e : cloud_effect_table()) write(e);
  out << "\nOf computed temperatures ([heat]): on unless effects.without of the sweep file names "
         "them; the\nbound, in kelvin, is part of the temperatures' error then.\n";
  for (const EffectInfo& e : heat_effect_table()) write(e);
  out << "\nOf hot gas ([plume]): on unless effects.without names them; plume_reflected is left "
         "out "
         "by "
         "itself,\ntoo, where there is room for it.\n";
  for (const EffectInfo& e : plume_effect_table()) write(e);
}

absl::Status write_effects(std::string_view format, std::ostream& out) {
  if (format == "text") {
    write_for_people(out);
    return absl::OkStatus();
  }
  auto writer = make_table_writer(
      format, {{"effect"}, {"what"}, {"matters"}, {"bound"}, {"cost"}, {"switchable"}}, out);
  if (!writer.ok()) return writer.status();
  const auto row = [&](const EffectInfo& e) {
    (*writer)->row(
        {text(e.name), text(e.what), text(e.when), text(e.bound), text(e.cost), e.switchable});
  };
  for (const EffectInfo& e : effect_table()) row(e);
  for (const EffectInfo& e : cloud_effect_table()) row(e);
  for (const EffectInfo& e : heat_effect_table()) row(e);
  for (const EffectInfo& e : plume_effect_table()) row(e);
  return (*writer)->finish();
}

}  // namespace

void add_show_effects(CLI::App& show, int& exit_code) {
  auto* command = show.add_subcommand(
      "effects",
      "Every effect: what it is, when it matters, how its bound is found, what it costs");
  const auto output =
      std::make_shared<OutputOptions>(*command, std::vector<std::string>{"text", "csv", "json"});
  command->callback([output, &exit_code] { exit_code = report(output->write(write_effects)); });
}

}  // namespace irsig
