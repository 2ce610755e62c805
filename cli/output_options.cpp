#include "cli/output_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <sstream>

#include "absl/strings/ascii.h"
#include "core/base/status_macros.h"
#include "view/base/atomic_file.h"
#include "view/base/print.h"

namespace irsig {
namespace {

constexpr const char* kOutputGroup = "Output";

struct Ending {
  std::string_view ending, format;
};

// The output format of each file name ending; empty: irsig does not write this format.
constexpr Ending kEndings[] = {
    {".txt", "text"}, {".csv", "csv"}, {".json", "json"}, {".svg", "svg"}, {".nc", "netcdf"},
    {".sli", "envi"}, {".tsf", "tsf"}, {".png", ""},    {".jpg", ""},      {".jpeg", ""},   {".pdf", ""},
    {".gif", ""},     {".tif", ""},    {".tiff", ""},     {".eps", ""},    {".exr", ""},
    {".obj", "obj"},  {".vdb", "vdb"}, {".toml", ""},     {".sigdb", ""},  {".db", ""},
    {".sqlite", ""},  {".stl", ""},    {".ply", ""},      {".gltf", ""},   {".glb", ""},
    {".xlsx", ""},    {".html", ""}};

const Ending* ending_of(const std::string& name) {
  const std::string lower = absl::AsciiStrToLower(name);
  for (const Ending& e : kEndings)
    if (lower.ends_with(e.ending)) return &e;
  return nullptr;
}

// Returns true if the name has an ending that contains a letter. "a.h5" has one; "a", ".hidden",
// "/dev/stdout" and "2.5" have none.
bool has_ending(const std::string& name) {
  const std::string base = name.substr(name.find_last_of('/') + 1);
  const std::size_t dot = base.find_last_of('.');
  return dot != std::string::npos && dot > 0 &&
         std::any_of(base.begin() + static_cast<std::ptrdiff_t>(dot), base.end(),
                     [](unsigned char c) { return std::isalpha(c) != 0; });
}

std::vector<std::string_view> endings_of(const std::vector<std::string>& formats) {
  std::vector<std::string_view> out;
  for (const std::string& format : formats)
    for (const Ending& e : kEndings)
      if (e.format == format) out.push_back(e.ending);
  return out;
}

absl::Status unwritten() {
  return absl::UnavailableError("cannot write the output (disk full or closed pipe?)");
}

bool is_standard_output(const std::string& path) { return path.empty() || path == "-"; }

}  // namespace

OutputOptions::OutputOptions(CLI::App& command, std::vector<std::string> formats)
    : formats_(std::move(formats)) {
  CLI::Option* format = nullptr;
  if (formats_.size() > 1) {
    std::vector<std::string> names = formats_;
    if (std::find(names.begin(), names.end(), "text") != names.end()) names.emplace_back("table");
    format = command
                 .add_option("--format", asked_,
                             fmt::format("{} (default: as the file's name ends, or {})",
                                         fmt::join(formats_, ", "), formats_.front()))
                 ->group(kOutputGroup)
                 ->type_name("FORMAT")
                 ->check(CLI::IsMember(names));
    std::vector<CLI::Option*> flags;
    for (const std::string& name : formats_) {
      CLI::Option* flag = command.add_flag_callback(
          "--" + name, [this, name] { asked_ = name; }, "The same as --format " + name);
      flag->group(kOutputGroup)->excludes(format);
      for (CLI::Option* other : flags) flag->excludes(other);
      flags.push_back(flag);
    }
  }
  out_option_ = command.add_option("-o,--out", out_,
                                   "File to write, replaced when complete; - is standard output");
  out_option_->group(kOutputGroup)->type_name("FILE");
}

absl::StatusOr<std::string> OutputOptions::format() const {
  const std::string asked = asked_ == "table" ? "text" : asked_;
  const Ending* ending = ending_of(out_);
  if (!ending && asked.empty() && formats_.size() > 1 && has_ending(out_))
    return absl::InvalidArgumentError(
        fmt::format("--out {}: no format is known by this ending, expected a name that ends in {}, "
                    "or --format",
                    out_, fmt::join(endings_of(formats_), ", ")));
  if (!ending) return asked.empty() ? formats_.front() : asked;
  const bool known = std::find(formats_.begin(), formats_.end(), ending->format) != formats_.end();
  if (!known)
    return absl::InvalidArgumentError(
        fmt::format("--out {}: this command does not write {} files, expected {}{}", out_,
                    ending->ending, fmt::join(formats_, ", "),
                    formats_.front() == "svg" ? " (rsvg-convert makes a PNG of it)" : ""));
  // A table of its own, which is written as CSV.
  if (asked == "temperatures" && ending->format == "csv") return asked;
  if (!asked.empty() && asked != ending->format)
    return absl::InvalidArgumentError(fmt::format(
        "--out {}: the name ends as {}, but --format is {}", out_, ending->format, asked));
  return std::string(ending->format);
}

absl::Status OutputOptions::write(
    const std::function<absl::Status(std::string_view, std::ostream&)>& write) const {
  ASSIGN_OR_RETURN(const auto chosen, format());
  if (is_standard_output(out_)) {
    if (chosen != "text") return write(chosen, data_output());
    std::ostringstream text;
    const absl::Status status = write(chosen, text);
    print_plain(stdout, text.str());
    if (!status.ok()) return status;
    return std::fflush(stdout) == 0 && std::ferror(stdout) == 0 ? absl::OkStatus() : unwritten();
  }
  return replace_file(out_, [&](const std::string& beside) -> absl::Status {
    std::ofstream file(beside, std::ios::binary | std::ios::trunc);
    RETURN_IF_ERROR(write(chosen, file));
    file.close();
    return file ? absl::OkStatus()
                : absl::UnavailableError(fmt::format("cannot write {} (disk full?)", out_));
  });
}

absl::Status OutputOptions::write(std::string_view bytes) const {
  return write([&](std::string_view, std::ostream& out) {
    out << bytes << std::flush;
    return out ? absl::OkStatus() : unwritten();
  });
}

}  // namespace irsig
