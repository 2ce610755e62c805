#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "view/base/print.h"

// irsig completion bash | zsh: a script for the shell, written from the commands that there are.
namespace irsig {
namespace {

// One command, or the program itself: what may follow it.
struct Level {
  std::string path;  // "model check"; empty: the program
  std::vector<std::string> command, option;
  struct Choice {
    std::string option;
    std::vector<std::string> value;
  };
  std::vector<Choice> choice;  // options with a list of values
  bool files = false;
};

// CLI11 describes an option's values as "FORMAT:{text,csv,json}".
std::vector<std::string> values_of(const std::string& type) {
  const std::size_t open = type.find('{'), close = type.find('}', open);
  std::vector<std::string> out;
  if (close == std::string::npos) return out;
  std::string word;
  for (const char c : type.substr(open + 1, close - open - 1)) {
    if (c == ',') {
      out.push_back(word);
      word.clear();
    } else {
      word += c;
    }
  }
  out.push_back(word);
  return out;
}

void collect(const CLI::App& app, const std::string& path, std::vector<Level>& out) {
  Level level{path, {}, {}, {}, false};
  const auto add = [&](const CLI::App& of) {
    for (const CLI::Option* option : of.get_options()) {
      if (option->get_positional()) level.files = true;
      for (const std::string& name : option->get_lnames()) {
        level.option.push_back("--" + name);
        if (auto values = values_of(option->get_type_name()); !values.empty())
          level.choice.push_back({"--" + name, std::move(values)});
      }
    }
  };
  add(app);
  std::vector<const CLI::App*> commands;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (sub->get_name().empty()) {
      add(*sub);  // a group of options
    } else {
      level.command.push_back(sub->get_name());
      commands.push_back(sub);
    }
  }
  out.push_back(std::move(level));
  for (const CLI::App* sub : commands)
    collect(*sub, path.empty() ? sub->get_name() : path + " " + sub->get_name(), out);
}

std::string script(const CLI::App& app) {
  std::vector<Level> levels;
  collect(app, "", levels);
  std::string paths, choices, words;
  for (const Level& level : levels) {
    if (!level.path.empty()) paths += fmt::format("{}\"{}\"", paths.empty() ? "" : "|", level.path);
    for (const Level::Choice& c : level.choice)
      choices +=
          fmt::format("    \"{}:{}\") COMPREPLY=($(compgen -W \"{}\" -- \"$cur\")); return ;;\n",
                      level.path, c.option, fmt::join(c.value, " "));
    words += fmt::format("    \"{}\") commands=\"{}\"; options=\"{}\" ;;\n", level.path,
                         fmt::join(level.command, " "), fmt::join(level.option, " "));
  }
  return fmt::format(
      R"(_irsig() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}} path="" next i commands options
  for ((i = 1; i < COMP_CWORD; ++i)); do
    next="${{path:+$path }}${{COMP_WORDS[i]}}"
    case "$next" in
      {}) path=$next ;;
    esac
  done
  case "$path:$prev" in
{}  esac
  case "$path" in
{}  esac
  if [[ $cur == -* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$cur"))
  elif [[ $prev != -* && -n $commands ]]; then
    COMPREPLY=($(compgen -W "$commands" -- "$cur"))
  else
    COMPREPLY=($(compgen -f -- "$cur"))
  fi
}}
complete -o filenames -F _irsig irsig
)",
      paths, choices, words);
}

}  // namespace

void add_completion(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "completion", "A script for bash or zsh that completes commands, options and their values");
  const auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "bash or zsh")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh"}));
  command->footer(
      "bash: irsig completion bash > ~/.local/share/bash-completion/completions/irsig\n"
      "zsh:  source <(irsig completion zsh)   in ~/.zshrc, after compinit");
  command->callback([&app, shell, &exit_code] {
    if (*shell == "zsh") data_output() << "autoload -U +X bashcompinit && bashcompinit\n";
    data_output() << script(app);
    exit_code = 0;
  });
}

}  // namespace irsig
