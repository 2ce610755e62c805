#include <fmt/format.h>
#include <google/protobuf/descriptor.h>

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "cli/commands.h"
#include "cli/help.h"
#include "core/accuracy/measured.h"
#include "core/accuracy/quantities.h"
#include "core/base/status_macros.h"
#include "jobs/text/number_bounds.h"
#include "schema/detector.pb.h"
#include "schema/goniometer.pb.h"
#include "schema/imager.pb.h"
#include "schema/sweep.pb.h"
#include "view/base/atomic_file.h"
#include "view/base/print.h"
#include "view/report/outcome.h"

// irsig manual: man pages and the tables of docs/reference, from the options as they are parsed,
// the bounds of numbers, the grammar of the files and the catalogue of quantities.
namespace irsig {
namespace {

constexpr std::string_view kExitCodes[][2] = {
    {"0", "done"},
    {"1", "the command failed for another reason than its input: it may succeed later"},
    {"2", "the input is wrong or may not be used: an argument, a file, a permission"}};

// "irsig model check": its words.
std::vector<std::string> words_of(const CLI::App& command) {
  std::vector<std::string> out;
  for (const CLI::App* at = &command; at != nullptr; at = at->get_parent())
    out.insert(out.begin(), at->get_name());
  return out;
}

void collect_commands(const CLI::App& command, std::vector<const CLI::App*>& out) {
  out.push_back(&command);
  for (const CLI::App* below : commands_of(command)) collect_commands(*below, out);
}

// Text as roff has it.
std::string roff(const std::string& text) {
  std::string out = absl::StrReplaceAll(text, {{"\\", "\\e"}, {"-", "\\-"}});
  out = absl::StrReplaceAll(out, {{"\n.", "\n\\&."}, {"\n'", "\n\\&'"}});
  return out.starts_with('.') || out.starts_with('\'') ? "\\&" + out : out;
}

std::string option_head(const OptionHelp& option) {
  return option.names + (option.argument.empty() ? "" : " " + option.argument);
}

std::string man_page(const CLI::App& command) {
  const std::string name = absl::StrJoin(words_of(command), "-");
  const bool whole = command.get_parent() == nullptr;
  std::string out =
      fmt::format(".TH \"{}\" 1 \"\" \"irsig {}\" \"irsig\"\n", roff(name), IRSIG_VERSION);
  const std::string summary = whole ? "infrared signature databases" : summary_of(command);
  out += fmt::format(".SH NAME\n{} \\- {}\n", roff(name), roff(summary));
  out += fmt::format(".SH SYNOPSIS\n{}\n", roff(usage_of(command)));
  out += whole ? fmt::format(".SH DESCRIPTION\n.nf\n{}\n.fi\n", roff(command.get_description()))
               : fmt::format(".SH DESCRIPTION\n{}\n", roff(description_of(command)));
  for (const OptionGroupHelp& group : option_groups(command)) {
    out += fmt::format(".SH \"{}\"\n", roff(group.title));
    for (const OptionHelp& option : group.option)
      out += fmt::format(".TP\n.B {}\n{}\n", roff(option_head(option)), roff(option.text));
  }
  std::map<std::string, std::vector<const CLI::App*>> groups;
  std::vector<std::string> titles;
  for (const CLI::App* below : commands_of(command)) {
    auto& group = groups[below->get_group()];
    if (group.empty()) titles.push_back(below->get_group());
    group.push_back(below);
  }
  for (const std::string& title : titles) {
    out += fmt::format(".SH \"{}\"\n", whole ? "COMMANDS: " + roff(title) : "COMMANDS");
    for (const CLI::App* below : groups[title])
      out += fmt::format(".TP\n.B {}\n{}\n", roff(below->get_name()), roff(summary_of(*below)));
  }
  if (!whole && !command.get_footer().empty())
    out += fmt::format(".SH NOTES\n.nf\n{}\n.fi\n", roff(command.get_footer()));
  out += ".SH \"EXIT STATUS\"\n";
  for (const auto& [code, meaning] : kExitCodes)
    out += fmt::format(".TP\n{}\n{}\n", code, roff(std::string(meaning)));
  const CLI::App* parent = command.get_parent();
  out += ".SH \"SEE ALSO\"\n";
  if (parent != nullptr)
    out += fmt::format(".BR {} (1),\n", roff(absl::StrJoin(words_of(*parent), "-")));
  return out + "/usr/share/doc/irsig/docs/README.md\n";
}

absl::Status write_man_pages(const CLI::App& app, const std::string& folder) {
  if (folder.empty())
    return absl::InvalidArgumentError("--out FOLDER is missing: man pages are files");
  std::vector<const CLI::App*> commands;
  collect_commands(app, commands);
  for (const CLI::App* command : commands) {
    const std::string file = folder + "/" + absl::StrJoin(words_of(*command), "-") + ".1";
    RETURN_IF_ERROR(replace_file(file, man_page(*command)));
  }
  return absl::OkStatus();
}

// A cell of a Markdown table.
std::string cell(std::string_view text) {
  return absl::StrReplaceAll(std::string(text), {{"|", "\\|"}, {"<", "\\<"}, {"\n", " "}});
}

void add_command_page(const CLI::App& command, std::string_view heading, std::string& out) {
  out += fmt::format("{} `{}`\n\n```text\n{}\n```\n\n", heading,
                     absl::StrJoin(words_of(command), " "), usage_of(command));
  out += wrapped(description_of(command), 0, 120);
  out += out.ends_with('.') ? "\n" : ".\n";
  for (const OptionGroupHelp& group : option_groups(command)) {
    out += fmt::format("\n| {} | meaning |\n|---|---|\n", group.title);
    for (const OptionHelp& option : group.option)
      out += fmt::format("| `{}` | {} |\n", option_head(option), cell(option.text));
  }
  if (!command.get_footer().empty())
    out += fmt::format("\n```text\n{}\n```\n", command.get_footer());
  out += "\n";
  for (const CLI::App* below : commands_of(command)) add_command_page(*below, "####", out);
}

std::string commands_page(const CLI::App& app) {
  std::string out =
      "# Commands\n\nEvery command of `irsig` with its arguments and options, as `irsig help "
      "COMMAND` prints them.\n"
      "The package has the same as man pages: `man irsig-run`.\n\n"
      "| exit code | meaning |\n|---|---|\n";
  for (const auto& [code, meaning] : kExitCodes) out += fmt::format("| {} | {} |\n", code, meaning);
  std::string group;
  for (const char* title : {"Start", "Look", "Use", "Farm", "Check", "Reference"}) {
    out += fmt::format("\n## {}\n\n| command | what it does |\n|---|---|\n", title);
    for (const CLI::App* command : commands_of(app))
      if (command->get_group() == title)
        out += fmt::format("| [`{0}`](#irsig-{0}) | {1} |\n", command->get_name(),
                           cell(summary_of(*command)));
    out += "\n";
    for (const CLI::App* command : commands_of(app))
      if (command->get_group() == title) add_command_page(*command, "###", out);
  }
  while (out.ends_with("\n\n")) out.pop_back();
  return out;
}

std::string_view kind_text(QuantityKind kind) {
  switch (kind) {
    case QuantityKind::kSampled:
      return "mean over paths";
    case QuantityKind::kStderr:
      return "standard error";
    case QuantityKind::kError:
      return "numerical error";
    case QuantityKind::kModelError:
      return "model error, one sigma";
    case QuantityKind::kBound:
      return "bound";
    case QuantityKind::kExact:
      return "without sampling error";
    case QuantityKind::kDerived:
      return "derived";
    case QuantityKind::kGoal:
      return "requested error";
    case QuantityKind::kGuard:
      return "should be 0";
    case QuantityKind::kInputSigma:
      return "one sigma of uncertain inputs";
  }
  return "";
}

std::string columns_page() {
  std::string out =
      "# Columns\n\nThe numbers of a row, as `query`, exports, Python and SQL name them. A row "
      "belongs to a viewpoint,\n"
      "a condition and a band. \"At the sensor\" is behind the air between it and the target.\n\n"
      "| column | unit | kind | meaning |\n|---|---|---|---|\n";
  for (const QuantityInfo& q : kQuantities)
    out +=
        fmt::format("| `{}` | {} | {} | {} |\n", q.name, q.unit, kind_text(q.kind), cell(q.what));
  out +=
      "\n## Limiting bound\n\nColumn `limiting_bound` names the largest part of the numerical "
      "error of a row that "
      "missed its\naccuracy (`stop_reason` is `accuracy_not_reached` or `sample_limit`). It is "
      "empty in other rows.\n\n"
      "| `limiting_bound` | meaning, and what lowers it |\n|---|---|\n";
  std::vector<std::string_view> names{kLimitedBySampling};
  for (std::size_t i = 0; i < kBounds; ++i) {
    const auto bound = static_cast<BoundOf>(i);
    // No parts of the intensity at the target.
    if (bound != BoundOf::kDepth && bound != BoundOf::kBackground && bound != BoundOf::kMoved)
      names.push_back(info_of(bound).name);
  }
  for (const std::string_view name : names)
    out += fmt::format(
        "| `{}` | {} |\n", name,
        cell(absl::StrReplaceAll(limit_text(name, false), {{fmt::format(" ({})", name), ""}})));
  return out;
}

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;

std::string type_text(const FieldDescriptor& field) {
  if (field.is_map()) return "values by name";
  std::string one;
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      one = "number";
      break;
    case FieldDescriptor::CPPTYPE_UINT32:
    case FieldDescriptor::CPPTYPE_UINT64:
      one = "whole number";
      break;
    case FieldDescriptor::CPPTYPE_BOOL:
      one = "true or false";
      break;
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return field.is_repeated() ? "tables" : "table";
    default:
      one = "text";
  }
  return field.is_repeated() ? "list of " + one + "s" : one;
}

bool holds_number(const FieldDescriptor& field) {
  const FieldDescriptor& value = field.is_map() ? *field.message_type()->map_value() : field;
  switch (value.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
    case FieldDescriptor::CPPTYPE_UINT32:
    case FieldDescriptor::CPPTYPE_UINT64:
      return true;
    default:
      return false;
  }
}

std::string csv(std::string_view text) {
  return "\"" + absl::StrReplaceAll(std::string(text), {{"\"", "\"\""}}) + "\"";
}

void add_option_lines(const CLI::Option& option, const std::vector<std::string>& words,
                      std::string& out) {
  for (const std::string& name : option.get_lnames())
    out += fmt::format("--{},{},{},{}\n", name, csv(help_of(option).argument),
                       csv(absl::StrJoin(words, " ")),
                       csv(std::string(absl::StripAsciiWhitespace(option.get_description()))));
}

// A line for each key of every table of a file, tables by their path.
void add_keys(const std::string& file, const Descriptor& message, const std::string& table,
              std::string& out) {
  for (int i = 0; i < message.field_count(); ++i) {
    const FieldDescriptor& field = *message.field(i);
    std::string least, most, reason;
    if (holds_number(field)) {
      const NumberBounds& bounds = bounds_of(absl::StrCat(message.name(), ".", field.name()));
      least = number_text(bounds.least);
      most = number_text(bounds.most);
      reason = std::string(bounds.reason);
    }
    out += fmt::format("{},{},{},{},{},{},{}\n", file, csv(table), field.name(),
                       csv(type_text(field)), least, most, csv(reason));
  }
  for (int i = 0; i < message.field_count(); ++i) {
    const FieldDescriptor& field = *message.field(i);
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE && !field.is_map())
      add_keys(file, *field.message_type(),
               table.empty() ? field.name() : table + "." + field.name(), out);
  }
}

// A line for each option of every command. The text is without values, limits and defaults, which
// may differ where the meaning does not.
std::string options_table(const CLI::App& app) {
  std::vector<const CLI::App*> commands;
  collect_commands(app, commands);
  std::string out = "option,value,command,meaning\n";
  for (const CLI::App* command : commands) {
    const std::vector<std::string> words = words_of(*command);
    for (const CLI::Option* option : command->get_options()) add_option_lines(*option, words, out);
    for (const CLI::App* group :
         command->get_subcommands([](const CLI::App* below) { return below->get_name().empty(); }))
      for (const CLI::Option* option : group->get_options()) add_option_lines(*option, words, out);
  }
  return out;
}

std::string keys_table() {
  std::string out = "file,table,key,type,least,most,reason\n";
  add_keys("sweep", *schema::Sweep::descriptor(), "", out);
  add_keys("goniometer", *schema::Goniometer::descriptor(), "", out);
  add_keys("detector", *schema::DetectorFile::descriptor(), "", out);
  add_keys("imager", *schema::ImagerFile::descriptor(), "", out);
  return out;
}

}  // namespace

void add_manual(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "manual",
      "Write man pages into a folder, or print a table of the reference: commands and columns as "
      "Markdown, keys of all files and options of all commands as CSV");
  const auto what = std::make_shared<std::string>(), folder = std::make_shared<std::string>();
  command->add_option("WHAT", *what, "man, commands, columns, keys or options")
      ->required()
      ->check(CLI::IsMember({"man", "commands", "columns", "keys", "options"}));
  command->add_option("-o,--out", *folder, "man: the folder of the pages; it must exist")
      ->type_name("FOLDER");
  command->callback([&app, what, folder, &exit_code] {
    exit_code = 0;
    if (*what == "man")
      exit_code = report(write_man_pages(app, *folder));
    else
      data_output() << (*what == "commands"  ? commands_page(app)
                        : *what == "columns" ? columns_page()
                        : *what == "options" ? options_table(app)
                                             : keys_table());
  });
}

}  // namespace irsig
