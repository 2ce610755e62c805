#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

namespace irsig {

// Texts on a command for help pages, man pages and the reference, made from its options as the
// program parses them.

struct OptionHelp {
  std::string names;     // "-o,--out", or "SWEEP" of an argument without a name
  std::string argument;  // "FILE"; empty: none
  std::string text;      // description, then values, limits, default and companions
};

struct OptionGroupHelp {
  std::string title;  // "Options", "Output", ...
  std::vector<OptionHelp> option;
};

// Returns the text of an option, in words: "SHARE", "One sigma ... (default 0.05; only with
// --refine)".
[[nodiscard]] OptionHelp help_of(const CLI::Option& option);

// Returns the arguments without names first, then the groups of options in the order of the
// command.
[[nodiscard]] std::vector<OptionGroupHelp> option_groups(const CLI::App& command);

// Returns the description of a command in one line, as in the list of commands.
[[nodiscard]] std::string summary_of(const CLI::App& command);

// Returns the whole description of a command, with a capital letter in front.
[[nodiscard]] std::string description_of(const CLI::App& command);

// Returns "irsig model check [OPTIONS] MODEL".
[[nodiscard]] std::string usage_of(const CLI::App& command);

// Returns the commands of a command that have a name, in their order.
[[nodiscard]] std::vector<const CLI::App*> commands_of(const CLI::App& app);

// Breaks a text into lines of at most `columns` columns, each after `indent` spaces; a longer word
// has its own line.
[[nodiscard]] std::string wrapped(const std::string& text, std::size_t indent, std::size_t columns);

// Formats the help of every command that is added after it was set.
[[nodiscard]] std::shared_ptr<CLI::FormatterBase> help_formatter();

// Puts each command of `app` into its group of the list of commands: Start, Look, Use, Farm, Check
// or Reference.
void group_commands(CLI::App& app);

}  // namespace irsig
