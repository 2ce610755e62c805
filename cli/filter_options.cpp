#include "cli/filter_options.h"

#include <fmt/format.h>

#include <set>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "cli/positive_number.h"
#include "core/base/status_macros.h"
#include "jobs/text/number_bounds.h"

namespace irsig {
namespace {

constexpr const char* kGroup = "Choose signatures (all that match every option given)";

absl::StatusOr<SignatureFilter::Direction> parse_aspect(const std::string& text) {
  const std::vector<std::string> numbers = absl::StrSplit(text, ',');
  SignatureFilter::Direction out{};
  if (numbers.size() != 2 || !absl::SimpleAtod(numbers[0], &out.aspect_azimuth_deg) ||
      !absl::SimpleAtod(numbers[1], &out.aspect_elevation_deg)) {
    return absl::InvalidArgumentError(
        fmt::format("--aspect {}: expected AZ,EL in degrees, e.g. 45,10", text));
  }
  for (const auto& [key, angle_deg] : {std::pair{"Aspect.azimuth_deg", out.aspect_azimuth_deg},
                                       std::pair{"Aspect.elevation_deg", out.aspect_elevation_deg}})
    RETURN_IF_ERROR(check_number(key, "--aspect", angle_deg));
  return out;
}

std::string shell_quoted(const std::string& value) {
  const bool plain = value.find_first_of(" '\"") == std::string::npos;
  return plain ? value : "'" + value + '\'';
}

}  // namespace

CLI::Option* add_seasons(CLI::App& command, std::vector<std::string>& season) {
  return command
      .add_option("--season", season, "Name of the season; may be repeated: any of these seasons")
      ->type_name("NAME")
      ->allow_extra_args(false);
}

FilterOptions::FilterOptions(CLI::App& command) : command_(&command) {
  command.add_option("DB", database_, "Signature database (.sigdb)")->required();
  const auto add = [&](const char* name, auto& value, const std::string& what) {
    return command.add_option(name, value, what)->group(kGroup);
  };
  add("--sweep", query_.sweep, "Name of the sweep")->type_name("NAME");
  add_seasons(command, season_)->group(kGroup);
  add("--time", query_.time, "Time, RFC 3339 with any offset: 2025-12-21T10:30:00+09:00")
      ->type_name("TIME");
  add("--band", query_.band, "Name of the band")->type_name("NAME");
  add("--at-range-m", query_.at_range_m, "Only viewpoints at this range, of several")
      ->type_name("R");
  row_option_ = add("--row", row_, "The one signature with this row number")
                    ->type_name("K")
                    ->check(positive_number());
  aspect_option_ = add("--aspect", aspect_,
                       "Direction from the target to the sensor: azimuth clockwise from the bow, "
                       "elevation above "
                       "the horizontal [deg]; with one of the next three")
                       ->type_name("AZ,EL");
  nearest_option_ = add("--nearest", query_.nearest, "  the N viewpoints nearest to the aspect")
                        ->type_name("N")
                        ->check(positive_number());
  within_option_ = add("--within", within_deg_, "  the viewpoints within DEG degrees of the aspect")
                       ->type_name("DEG");
  command
      .add_flag("--interpolate", query_.interpolate,
                "  interpolated between the viewpoints; the error includes the interpolation's")
      ->group(kGroup);
  error_option_ = add("--max-relative-error", max_relative_error_,
                      "Only where numerical error / value of the quantity is at most X")
                      ->type_name("X");
  add("--quantity", quantity_,
      "What is asked about (the errors, people's tables and plots go by it): " +
          absl::StrJoin(quantity_names(), ", "))
      ->type_name("QUANTITY")
      ->check(CLI::IsMember(quantity_names()))
      ->capture_default_str();
}

void FilterOptions::add_ranges(CLI::App& command) {
  command
      .add_option("--range-m", query_.range_m,
                  "As seen from each of these ranges on the same aspect, without tracing: apparent "
                  "intensity, contrast, background and the path anew, their errors with what that "
                  "adds; 20 target lengths or more")
      ->type_name("R,...")
      ->delimiter(',');
}

std::string FilterOptions::text() const {
  std::string out;
  for (const CLI::Option* option : command_->get_options()) {
    if (option->get_group() != kGroup || option->count() == 0) continue;
    const bool flag = option->get_expected_max() == 0;
    const bool repeated = option->get_name() == "--season";
    for (const std::string& value :
         repeated ? option->results()
                  : std::vector<std::string>{absl::StrJoin(option->results(), ",")}) {
      if (!out.empty()) out += ' ';
      out += option->get_name();
      if (!flag) out += ' ' + shell_quoted(value);
    }
  }
  return out;
}

absl::StatusOr<Query> FilterOptions::query() const {
  Query out = query_;
  out.season = NameSet(season_);
  ASSIGN_OR_RETURN(const auto quantity, quantity_named(quantity_));
  out.quantity = quantity;
  if (*aspect_option_) {
    ASSIGN_OR_RETURN(auto aspect, parse_aspect(aspect_));
    out.aspect = aspect;
  }
  if (*within_option_) {
    if (!(within_deg_ >= 0 && within_deg_ <= 180))
      return absl::InvalidArgumentError(
          fmt::format("--within {}: expected an angle from 0 to 180 degrees", within_deg_));
    out.within_deg = within_deg_;
  }
  std::set<double> ranges;
  for (const double range : out.range_m) {
    RETURN_IF_ERROR(check_number("Viewpoints.range_m", "--range-m", range));
    if (!ranges.insert(range).second)
      return absl::InvalidArgumentError(fmt::format("--range-m: {:g} comes twice", range));
  }
  if (*row_option_) out.row = row_;
  if (*error_option_) {
    if (!(max_relative_error_ >= 0))
      return absl::InvalidArgumentError(fmt::format(
          "--max-relative-error {}: expected a number, 0 or more", max_relative_error_));
    out.max_relative_error = max_relative_error_;
  }
  return out;
}

}  // namespace irsig
