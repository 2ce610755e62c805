#include <algorithm>
#include <array>
#include <cctype>
#include <csignal>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "cli/commands.h"
#include "cli/help.h"
#include "cli/renamed_option.h"
#include "core/base/keep_memory.h"
#include "core/base/printable.h"
#include "core/base/standard_output.h"
#include "jobs/text/nearest_name.h"
#include "runner/job_runner.h"
#include "view/base/print.h"

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
    "  irsig serve FILE               the same, and more, in a web browser\n"
    "  irsig help COMMAND             the options of a command\n"
    "\n"
    "Exit code: 0 done, 2 the input is wrong, 1 anything else failed.";

// The names that a command knows: its options, or its subcommands.
std::vector<std::string> names_of(const CLI::App& app, bool options) {
  std::vector<std::string> out;
  if (options) {
    for (const CLI::Option* option : app.get_options())
      for (const std::string& name : option->get_lnames()) out.push_back("--" + name);
  } else {
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
      out.push_back(command->get_name());
  }
  return out;
}

// Returns true for the name of a file of a kind that commands write.
bool is_written(const std::string& word) {
  constexpr std::array kEndings = {".csv", ".json", ".nc", ".png", ".sli", ".svg", ".tsf", ".txt"};
  return !word.starts_with("-") &&
         std::ranges::any_of(kEndings, [&](const char* ending) { return word.ends_with(ending); });
}

// The one name that begins with a word: contrast_intensity of "contrast".
std::optional<std::string> only_with_beginning(const std::string& word,
                                               const std::vector<std::string>& known) {
  std::optional<std::string> out;
  for (const std::string& name : known) {
    if (word.empty() || !name.starts_with(word)) continue;
    if (out) return std::nullopt;
    out = name;
  }
  return out;
}

// Returns the message on a value that is no number, of "--range-m = 5km".
std::string no_number(std::string_view what) {
  constexpr std::string_view kOpening = "Could not convert: ";
  if (what.starts_with(kOpening)) what.remove_prefix(kOpening.size());
  const std::size_t equals = what.find(" = ");
  const std::string_view value = equals == what.npos ? "" : what.substr(equals + 3);
  const bool digit = !value.empty() && std::isdigit(static_cast<unsigned char>(value[0])) != 0;
  const char* expected = value.ends_with('%') ? "a number without a unit (1 % is 0.01)"
                         : !digit             ? "a number"
                         : value.find('-') != value.npos
                             ? "a number, or several with commas between them"
                             : "a number without a unit";
  return irsig::printable(what) + ", expected " + expected;
}

// Returns the message on an option that has too few or too many values.
std::string wrong_count(const std::string& said) {
  const std::string_view what = said;
  const std::size_t few = what.find(": At least "), missing = what.find(" required ");
  const std::size_t twice = what.find(": At Most 1 required but received ");
  if (few != what.npos) {
    const std::string rest(what.substr(few + 11));
    return irsig::printable(what.substr(0, few)) + " needs " + rest.substr(0, rest.find(' ')) +
           " values, " + rest.substr(rest.rfind(' ') + 1) + " given";
  }
  if (twice != what.npos)
    return irsig::printable(what.substr(0, twice)) + " is given more than once, expected one value";
  if (missing != what.npos && what.ends_with(" missing"))
    return irsig::printable(what.substr(0, what.find(':'))) + " needs a value";
  return irsig::printable(what);
}

// "--format: xml not in {text,csv}" and "--workers: Value 0 not in range 1 to 4096", which the
// checks of options write, as sentences: "--format xml: expected one of text, csv".
std::string in_words(const std::string& what) {
  const std::size_t colon = what.find(": ");
  const std::size_t list = what.find(" not in {"), range = what.find(" not in range ");
  if (colon == std::string::npos || (list == std::string::npos && range == std::string::npos))
    return what;
  const std::string option = what.substr(0, colon);
  if (range != std::string::npos) {
    std::string value = what.substr(colon + 2, range - colon - 2);
    if (value.starts_with("Value ")) value.erase(0, 6);
    return option + " " + value + ": expected " + what.substr(range + 14);
  }
  const std::string value = what.substr(colon + 2, list - colon - 2);
  std::string names = what.substr(list + 9);
  names.erase(std::min(names.find('}'), names.size()));
  std::vector<std::string> known = absl::StrSplit(names, ',');
  if (std::ranges::find(known, "text") != known.end())
    std::erase(known, "table");  // another name of "text"
  auto near = irsig::nearest_name(value, known);
  if (!near) near = only_with_beginning(value, known);
  return option + " " + value + ": expected one of " + absl::StrJoin(known, ", ") +
         (near ? "; did you mean " + *near + "?" : "");
}

// "irsig show sky".
std::string command_words(const CLI::App& command) {
  return (command.get_parent() != nullptr ? command_words(*command.get_parent()) + " " : "") +
         command.get_name();
}

// Returns the error message, with the nearest known name for each unknown argument.
std::string failure(const CLI::App* app, const CLI::Error& error) {
  const std::vector<std::string> extras = app->remaining(true);
  while (!app->get_subcommands().empty()) app = app->get_subcommands().front();
  for (const std::string& extra : extras)
    if (const std::string is = irsig::new_spelling(*app, extra); !is.empty())
      return "irsig: " + extra.substr(0, extra.find('=')) + ": this option of `" +
             command_words(*app) + "` is called " + is + "\n";
  const std::vector<std::string> commands = names_of(*app, false);
  const bool bare = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr &&
                    app->get_require_subcommand_min() > 0;
  std::string text =
      "irsig: " + (bare ? "a command is missing, expected one of " + absl::StrJoin(commands, ", ")
                        : irsig::printable(error.what()));
  if (dynamic_cast<const CLI::ConversionError*>(&error) != nullptr)
    text = "irsig: " + no_number(error.what());
  if (dynamic_cast<const CLI::ValidationError*>(&error) != nullptr)
    text = "irsig: " + in_words(irsig::printable(error.what()));
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr)
    text = "irsig: " + wrong_count(error.what());
  const bool required = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr && !bare;
  const bool unexpected = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  if (!extras.empty() && (required || unexpected)) {
    const std::string words = irsig::printable(absl::StrJoin(extras, " "));
    text = required ? text + "; not expected: " + words : "irsig: not expected: " + words;
    for (const std::string& extra : extras) {
      // "-band" is an option of which one dash is missing.
      const bool option = extra.starts_with("--") ||
                          (extra.size() > 2 && extra[0] == '-' && std::isalpha(extra[1]) != 0);
      const std::vector<std::string> known = names_of(*app, option);
      const std::string name = option && !extra.starts_with("--") ? "-" + extra : extra;
      if (!known.empty() && (option || !extra.starts_with("-")))
        text += "\n       " + irsig::printable(extra) + ": " +
                (std::ranges::find(known, name) != known.end() && name != extra
                     ? "did you mean \"" + name + "\"?"
                     : irsig::suggestion(name, known));
      const bool takes_out = app->get_option_no_throw("--out") != nullptr &&
                             app->get_option_no_throw("--out")->count() == 0;
      if (is_written(extra) && takes_out)
        text += "\n       " + irsig::printable(extra) + ": expected --out before a file to write";
    }
  }
  return text + " (--help lists what there is)\n";
}

// The first word that names a command, if it names none.
std::string unknown_command(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* at = &app;
  for (const std::string& word : words) {
    if (word == "-h" || word == "--help") continue;  // of a command that there is
    if (word.starts_with("-")) break;
    const std::vector<std::string> known = names_of(*at, false);
    // `irsig model frigate`: a word of its own.
    const bool takes_words =
        !at->get_options([](const CLI::Option* o) { return o->get_positional(); }).empty();
    if (known.empty() || takes_words) break;
    if (std::find(known.begin(), known.end(), word) == known.end())
      return "unknown command \"" + irsig::printable(word) + "\", " +
             irsig::suggestion(word, known);
    at = at->get_subcommand(word);
  }
  return "";
}

// "help query" as "query --help", and "help" as "--help". `words` are the arguments. Options of the
// command after its name are in its help.
std::vector<std::string> without_help(std::vector<std::string> words) {
  if (words.empty() || words.front() != "help") return words;
  words.erase(words.begin());
  words.erase(std::ranges::find_if(words, [](const auto& word) { return word.starts_with("-"); }),
              words.end());
  words.emplace_back("--help");
  return words;
}

// The option that is asked about without its command: --season of "help --season".
std::string option_without_command(const std::vector<std::string>& words) {
  const bool asked = words.size() > 1 && words[0] == "help" && words[1].starts_with("-");
  return asked && words[1] != "-h" && words[1] != "--help" ? words[1] : "";
}

std::string version() {
  return "irsig " IRSIG_VERSION " (build " + irsig::build_id() + ", physics version " +
         std::to_string(irsig::physics_version()) + ")";
}

}  // namespace

namespace {

int run_program(int argc, char** argv) {
  int exit_code = 0;
  CLI::App app(kAbout, "irsig");
  app.set_version_flag("--version", version);
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.require_subcommand(1);
  app.failure_message(failure);
  app.formatter(irsig::help_formatter());
  irsig::add_init(app, exit_code);
  irsig::add_run(app, exit_code);
  irsig::add_plan(app, exit_code);
  irsig::add_report(app, exit_code);
  irsig::add_query(app, exit_code);
  irsig::add_compare(app, exit_code);
  irsig::add_bands(app, exit_code);
  irsig::add_explain(app, exit_code);
  irsig::add_plot(app, exit_code);
  irsig::add_serve(app, exit_code);
  irsig::add_fly(app, exit_code);
  irsig::add_profile(app, exit_code);
  irsig::add_export(app, exit_code);
  irsig::add_slice(app, exit_code);
  irsig::add_merge(app, exit_code);
  irsig::add_submit(app, exit_code);
  irsig::add_status(app, exit_code);
  irsig::add_cancel(app, exit_code);
  irsig::add_prioritize(app, exit_code);
  irsig::add_ca(app, exit_code);
  irsig::add_digest(app, exit_code);
  irsig::add_doctor(app, exit_code);
  irsig::add_show(app, exit_code);
  irsig::add_model(app, exit_code);
  irsig::add_material(app, exit_code);
  irsig::add_goniometer(app, exit_code);
  irsig::add_accuracy(app, exit_code);
  irsig::add_verify_effects(app, exit_code);
  irsig::add_selftest(app, exit_code);
  irsig::add_completion(app, exit_code);
  irsig::add_manual(app, exit_code);
  app.add_subcommand("help", "This help, or that of a command: irsig help query")->allow_extras();
  irsig::group_commands(app);
  std::vector<std::string> words(argv + 1, argv + argc);
  if (const std::string option = option_without_command(words); !option.empty()) {
    irsig::print_note("irsig: help {}: expected a command before it, as in irsig help query\n",
                      irsig::printable(option));
    return 2;
  }
  words = without_help(std::move(words));
  if (const std::string unknown = unknown_command(app, words); !unknown.empty()) {
    irsig::print_note("irsig: {}\n", unknown);
    return 2;
  }
  try {
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;  // --help and --version are 0
  } catch (const std::exception& error) {
    // The libraries below throw nothing on purpose: out of memory, mostly.
    irsig::print_note("irsig: {}\n", error.what());
    return 1;
  }
  return exit_code;
}

}  // namespace

// One way out of every command: whoever printed something, to a file on a full disk, has failed.
int main(int argc, char** argv) {
  irsig::keep_freed_memory();
  // A file at its limit (ulimit -f) is a full disk, for the programs that this one starts, too.
  std::signal(SIGXFSZ, SIG_IGN);
  const int exit_code = run_program(argc, argv);
  irsig::data_output().flush();
  const absl::Status printed = irsig::end_standard_output();
  return exit_code == 0 ? irsig::report(printed) : exit_code;
}
