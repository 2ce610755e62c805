#include "cli/help.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"

namespace irsig {
namespace {

constexpr std::size_t kColumns = 100, kTextColumn = 28;

struct CommandLine {
  std::string_view name, group, summary;
};
// The list of commands, in its order.
constexpr auto kCommands = std::to_array<CommandLine>({
    {"init", "Start", "write a sweep file for a model of your own, which runs as it is"},
    {"plan", "Start", "predict jobs, rows, size and time of a sweep, for every accuracy"},
    {"run", "Start", "compute a sweep on this machine, or on a Slurm cluster, into a database"},
    {"report", "Start", "compare what a run took with the prediction; errors, bounds, warnings"},
    {"help", "Start", "print this help, or that of a command: irsig help query"},
    {"query", "Look", "print signatures: W/sr with errors, area, temperature"},
    {"explain", "Look", "account for one row: every error, effect, cause and part"},
    {"plot", "Look", "draw signatures, images, temperatures, sky or land as SVG"},
    {"serve", "Look", "show databases in a web browser"},
    {"fly", "Look", "look at a sweep's scene live in a web browser, before it is computed"},
    {"compare", "Look", "print the signatures of two databases or conditions side by side"},
    {"profile", "Look", "print radiance profiles beside published values"},
    {"bands", "Use", "find the part of a band in which a detector sees the target best"},
    {"export", "Use", "write CSV, netCDF, ENVI, STK files, pictures or temperatures"},
    {"slice", "Use", "write chosen signatures into a database of their own"},
    {"merge", "Use", "unite databases: shards, unfinished runs, different sweeps"},
    {"submit", "Farm", "hand a sweep to a running coordinator"},
    {"status", "Farm", "show the progress of a coordinator's sweeps and workers"},
    {"cancel", "Farm", "take the open jobs of a sweep off a coordinator's queue"},
    {"prioritize", "Farm", "choose which sweep workers continue with first"},
    {"ca", "Farm", "make the certificates of a farm: who may submit, work and read"},
    {"digest", "Check", "print the SHA-256 of a database's content"},
    {"doctor", "Check", "read all of a database; report what is damaged, missing or old"},
    {"accuracy", "Check", "measure what accuracy costs in time, and what a mesh is worth"},
    {"verify-effects", "Check", "compare the chosen effects with all effects on the same paths"},
    {"selftest", "Check", "run the cases on which radiometric codes break, or look for new ones"},
    {"show", "Reference",
     "print blackbodies, air, sky, sun, effects, hot gas, solids, temperatures"},
    {"model", "Reference", "make, check and repair meshes, plumes and terrain"},
    {"material", "Reference", "list, show, plot and check the materials of surfaces"},
    {"goniometer", "Reference", "measure BRDF and emissivity of a scene of grains on a plate"},
    {"completion", "Reference", "print a script that completes commands in bash or zsh"},
    {"manual", "Reference", "write man pages, or the tables of the reference"},
});

const CommandLine* line_of(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  if (parent == nullptr || parent->get_parent() != nullptr)
    return nullptr;  // not of `irsig` itself
  const auto* const found = std::ranges::find(kCommands, command.get_name(), &CommandLine::name);
  return found == kCommands.end() ? nullptr : found;
}

// CLI11 describes the values of an option after its type: "FORMAT:{text,csv}", "N:INT in [1 - 9]".
struct Values {
  std::string type;               // "FORMAT", "N"
  std::vector<std::string> list;  // that it may have; empty: others
  std::string range;              // "1 to 9", "above 0"; empty: none is stated
};

Values values_in(const std::string& type_name) {
  Values out;
  const std::size_t colon = type_name.find(':');
  out.type = type_name.substr(0, colon);
  if (colon == std::string::npos) return out;
  const std::string rest = type_name.substr(colon + 1);
  const std::size_t open = rest.find('{'), close = rest.find('}');
  if (open != std::string::npos && close != std::string::npos) {
    out.list = absl::StrSplit(rest.substr(open + 1, close - open - 1), ',');
    // Another name of "text".
    if (out.list.size() > 1 && std::ranges::find(out.list, "text") != out.list.end())
      std::erase(out.list, "table");
    return out;
  }
  const std::size_t from = rest.find(" in ["), to = rest.find(" - ", from);
  if (from != std::string::npos && to != std::string::npos) {
    const std::size_t end = rest.find(']', to);
    out.range = rest.substr(from + 5, to - from - 5) + " to " + rest.substr(to + 3, end - to - 3);
  } else if (rest.starts_with("POSITIVE")) {
    out.range = "above 0";
  } else if (rest.starts_with("NONNEGATIVE")) {
    out.range = "0 or more";
  }
  return out;
}

// The unit of a number whose option names it: M of --length-m.
std::string unit_word(const std::string& option) {
  for (const std::string_view unit : {"-m", "-k", "-um", "-deg", "-pa"})
    if (option.ends_with(unit)) return absl::AsciiStrToUpper(std::string(unit.substr(1)));
  return "NUMBER";
}

// A word for the value of an option whose command names none.
std::string argument_word(const std::string& type, const std::string& option) {
  if (type == "FLOAT") return unit_word(option);
  if (type == "INT" || type == "UINT") return "N";
  if (type != "TEXT") return type;
  for (const std::string_view file : {"--db", "--tls-cert", "--tls-key", "--tls-ca", "--record"})
    if (option == file) return "FILE";
  for (const std::string_view time : {"--time", "--time-limit", "--b-time"})
    if (option == time) return "TIME";
  return option == "--coordinator" ? "ADDRESS" : "NAME";
}

bool mentions_all(const std::string& text, const std::vector<std::string>& words) {
  const std::string lower = absl::AsciiStrToLower(text);
  return std::ranges::all_of(words, [&](const std::string& word) {
    return lower.find(absl::AsciiStrToLower(word)) != std::string::npos;
  });
}

std::string option_names(const std::set<CLI::Option*>& options) {
  std::vector<std::string> out;
  for (const CLI::Option* option : options) out.push_back(option->get_name());
  std::ranges::sort(out);
  return absl::StrJoin(out, ", ");
}

std::string capitalised(std::string text) {
  absl::StripAsciiWhitespace(&text);
  // A first word that is a name or a unit ("slurm: ...", "csv") keeps its letter.
  if (!text.empty() && std::islower(static_cast<unsigned char>(text.front())) != 0) {
    const std::size_t end = text.find_first_of(" ,.;:");
    const std::string first = text.substr(0, end);
    const bool name = (end != std::string::npos && (text[end] == ':' || text[end] == ',')) ||
                      first.find_first_of("_/-=") != std::string::npos || first == "csv";
    if (!name)
      text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  }
  return text;
}

class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool) const override {
    const OptionHelp help = help_of(*option);
    return entry(help.names + (help.argument.empty() ? "" : " " + help.argument), help.text);
  }
  std::string make_group(std::string group, bool positional,
                         std::vector<const CLI::Option*> options) const override {
    std::string out = "\n" + (positional ? std::string("Arguments") : std::move(group)) + ":\n";
    for (const CLI::Option* option : options) out += make_option(option, positional);
    return out;
  }
  std::string make_subcommand(const CLI::App* command) const override {
    return entry(command->get_name(), summary_of(*command));
  }
  std::string make_description(const CLI::App* command) const override {
    if (command->get_parent() == nullptr) return command->get_description() + "\n";
    return wrapped(description_of(*command), 0, kColumns) + "\n";
  }
  // A group of options that belong together.
  std::string make_expanded(const CLI::App* group) const override {
    std::string out = "\n" + group->get_group() + ":\n";
    if (!group->get_description().empty())
      out += wrapped(group->get_description(), 2, kColumns) + "\n";
    if (group->get_require_option_min() == 1)
      out += group->get_require_option_max() == 1 ? "  exactly one of these is required\n"
                                                  : "  at least one of these is required\n";
    for (const CLI::Option* option : group->get_options()) out += make_option(option, false);
    return out;
  }
  std::string make_usage(const CLI::App* command, std::string) const override {
    return "Usage: " + usage_of(*command) + "\n";
  }

 private:
  static std::string entry(const std::string& head, const std::string& text) {
    std::string lines = wrapped(text, kTextColumn, kColumns);
    if (head.size() + 4 <= kTextColumn && !lines.empty())
      return "  " + head + lines.substr(2 + head.size()) + "\n";
    return "  " + head + "\n" + lines + (lines.empty() ? "" : "\n");
  }
};

}  // namespace

std::string wrapped(const std::string& text, std::size_t indent, std::size_t columns) {
  std::string out, line(indent, ' ');
  bool empty = true;
  for (const absl::string_view word :
       absl::StrSplit(text, absl::ByAnyChar(" \n"), absl::SkipEmpty())) {
    if (!empty && line.size() + 1 + word.size() > columns) {
      out += line + "\n";
      line.assign(indent, ' ');
      empty = true;
    }
    if (!empty) line += ' ';
    line.append(word.data(), word.size());
    empty = false;
  }
  return empty ? out : out + line;
}

OptionHelp help_of(const CLI::Option& option) {
  OptionHelp out;
  const bool positional = option.get_positional();
  out.names = option.get_name(positional, !positional);
  const Values values = values_in(option.get_type_name());
  if (!positional && option.get_type_size() != 0)
    out.argument = argument_word(values.type, option.get_name());
  const bool several = option.get_expected_max() == CLI::detail::expected_max_vector_size;
  if (several) out.argument += positional ? "..." : " ...";
  out.text = capitalised(option.get_description());
  std::vector<std::string> notes;
  if (option.get_required()) notes.emplace_back("required");
  if (!values.list.empty() && !mentions_all(out.text, values.list))
    notes.push_back("one of " + absl::StrJoin(values.list, ", "));
  if (!values.range.empty()) notes.push_back(values.range);
  if (!option.get_default_str().empty() && out.text.find("default") == std::string::npos)
    notes.push_back("default " + option.get_default_str());
  if (!option.get_needs().empty()) notes.push_back("only with " + option_names(option.get_needs()));
  std::set<CLI::Option*> others = option.get_excludes();
  // Names of formats exclude each other.
  std::erase_if(others, [&](const CLI::Option* other) {
    return other->get_group() == "Output" && option.get_group() == "Output";
  });
  if (!others.empty()) notes.push_back("not with " + option_names(others));
  if (!notes.empty())
    out.text += (out.text.empty() ? "(" : " (") + absl::StrJoin(notes, "; ") + ")";
  return out;
}

std::vector<OptionGroupHelp> option_groups(const CLI::App& command) {
  std::vector<OptionGroupHelp> out;
  const auto add = [&](const std::string& title, const CLI::Option& option) {
    const auto same = std::ranges::find(out, title, &OptionGroupHelp::title);
    OptionGroupHelp& group =
        same == out.end() ? out.emplace_back(OptionGroupHelp{title, {}}) : *same;
    group.option.push_back(help_of(option));
  };
  for (const CLI::Option* option : command.get_options())
    if (option->get_positional() && !option->get_group().empty()) add("Arguments", *option);
  for (const CLI::Option* option : command.get_options())
    if (option->nonpositional() && !option->get_group().empty()) add(option->get_group(), *option);
  for (const CLI::App* group : command.get_subcommands([](const CLI::App*) { return true; }))
    if (group->get_name().empty())
      for (const CLI::Option* option : group->get_options()) add(group->get_group(), *option);
  return out;
}

std::string description_of(const CLI::App& command) {
  return capitalised(command.get_description());
}

std::string summary_of(const CLI::App& command) {
  if (const CommandLine* line = line_of(command)) return std::string(line->summary);
  const std::string text = command.get_description();
  return text.substr(0, text.find_first_of(":;"));
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  std::vector<const CLI::App*> out = app.get_subcommands([](const CLI::App*) { return true; });
  std::erase_if(out, [](const CLI::App* command) { return command->get_name().empty(); });
  return out;
}

std::string usage_of(const CLI::App& command) {
  std::string path;
  for (const CLI::App* at = &command; at != nullptr; at = at->get_parent())
    path = at->get_name() + (path.empty() ? "" : " " + path);
  path += " [OPTIONS]";
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_positional()) continue;
    const OptionHelp help = help_of(*option);
    const std::string word = help.names + help.argument;
    path += option->get_required() ? " " + word : " [" + word + "]";
  }
  if (!commands_of(command).empty())
    path += command.get_require_subcommand_min() == 0 ? " [COMMAND]" : " COMMAND";
  return path;
}

std::shared_ptr<CLI::FormatterBase> help_formatter() { return std::make_shared<HelpFormatter>(); }

void group_commands(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; }))
    if (const CommandLine* line = line_of(*command)) command->group(std::string(line->group));
}

}  // namespace irsig
