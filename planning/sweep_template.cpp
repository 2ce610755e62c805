#include "planning/sweep_template.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "core/base/formula.h"
#include "core/base/printable.h"
#include "core/scene/check/mesh_lint.h"

namespace irsig {
namespace {

// More are not typed one by one.
constexpr std::size_t kMostParts = 12, kMostListed = 80;

// Mid-latitude weather of the sea in the middle of a season, rounded.
struct SeasonWeather {
  std::string_view name, date, date_south;
  double air_k, humidity_percent, sea_k, ground_k;
};
constexpr std::array<SeasonWeather, 4> kSeasons = {{
    {"winter", "2025-01-15", "2025-07-15", 280, 80, 284, 278},
    {"spring", "2025-04-15", "2025-10-15", 285, 75, 285, 288},
    {"summer", "2025-07-15", "2025-01-15", 292, 70, 291, 298},
    {"autumn", "2025-10-15", "2025-04-15", 287, 75, 289, 288},
}};

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

struct Group {
  std::string name;
  std::size_t facets = 0;
  bool open = false;
};

std::vector<Group> groups_of(const Mesh& mesh) {
  std::vector<Group> all;
  for (const std::string& name : mesh.group) all.push_back({name, 0, false});
  for (const std::uint32_t g : mesh.triangle_group) ++all[g].facets;
  for (const OpenGroup& open : open_groups(mesh))
    for (Group& g : all)
      if (g.name == open.group) g.open = true;
  std::erase_if(all, [](const Group& g) { return g.facets == 0; });
  return all;
}

// Temperatures of parts: assumed, or computed by a wall of the template.
struct Heat {
  double temperature_k;
  bool computed;
};
// A guess for uptakes and engines; their owner knows better.
constexpr double kHotK = 400;

std::string part(const std::string& name, const std::string& match, bool rest, bool open,
                 const Heat& heat) {
  const bool hot = !rest && sounds_hot(match.empty() ? name : match);
  std::string out = absl::StrCat("\n[[part]]\nname = ", quoted(name), "\n");
  if (!match.empty()) absl::StrAppend(&out, "match = [", quoted(match), "]\n");
  if (rest) out += "rest = true                  # every group that no other part takes\n";
  absl::StrAppend(&out, "material = \"generic_grey_paint\"   # irsig material list\n");
  if (hot)
    absl::StrAppend(&out, "temperature_k = ", kHotK,
                    "          # hot by its name: a guess, check it\n");
  else if (heat.computed)
    out += "build_up = \"plate\"\n";
  else
    absl::StrAppend(&out, "temperature_k = ", heat.temperature_k, "\n");
  if (open)
    out +=
        "two_sided = true             # open shells: sheets, or a body with holes (irsig model "
        "check)\n";
  return out;
}

// A pattern that takes the group: its name, with "?" for what a sweep file cannot hold.
std::string pattern_of(const std::string& name) {
  std::string out = name;
  if (!is_one_line(name))
    for (char& c : out)
      if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f) c = '?';
  return out;
}

// Groups whose pattern takes others as well: "Cabin" takes "Wheel/Cabin" too.
std::vector<bool> takes_others(const std::vector<Group>& groups) {
  std::vector<bool> out;
  for (const Group& group : groups) {
    const std::string pattern = pattern_of(group.name);
    out.push_back(std::ranges::count_if(groups, [&](const Group& other) {
                    return group_matches(other.name, pattern);
                  }) > 1);
  }
  return out;
}

std::string parts(const std::vector<Group>& groups, const Heat& heat) {
  std::string out;
  if (groups.size() > kMostParts) {
    absl::StrAppend(
        &out, "\n# The model has ", groups.size(),
        " groups. Give those that are hot, or of another material, parts of their own "
        "before this one:\n# match = [\"name\", \"eng*\"] takes groups by their names.\n");
    for (std::size_t i = 0; i < std::min(groups.size(), kMostListed); ++i)
      absl::StrAppend(&out, "#   ", printable(groups[i].name), " (", groups[i].facets, " facets",
                      groups[i].open ? ", open" : "",
                      sounds_hot(groups[i].name) ? ", hot by its name" : "", ")\n");
    if (groups.size() > kMostListed)
      absl::StrAppend(&out, "#   and ", groups.size() - kMostListed, " more\n");
    const bool open =
        std::any_of(groups.begin(), groups.end(), [](const Group& g) { return g.open; });
    return out + part("target", "", true, open, heat);
  }
  out +=
      "\n# One part for each group of the model. What a name says of heat is a guess: check "
      "each.\n";
  const std::vector<bool> shared = takes_others(groups);
  bool rest_open = false;
  std::size_t first_rest = groups.size(), rests = 0;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (!shared[i]) continue;
    rest_open = rest_open || groups[i].open;
    first_rest = std::min(first_rest, i);
    ++rests;
  }
  if (rests > 1) {
    out += "# These have names that other groups have in theirs, and are one part:\n";
    for (std::size_t i = 0; i < groups.size(); ++i)
      if (shared[i]) absl::StrAppend(&out, "#   ", one_line(groups[i].name), "\n");
  }
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const std::string& group = groups[i].name;
    const bool plain = !group.empty() && is_one_line(group) && !is_formula(group) &&
                       group.front() != ' ' && group.back() != ' ' &&
                       group.find_first_of("*?") == std::string::npos;
    const std::string name = plain ? group : absl::StrCat("part ", i + 1);
    if (!shared[i]) {
      out += part(name, plain ? "" : pattern_of(group), false, groups[i].open, heat);
    } else if (i == first_rest) {
      out += part(rests == 1 ? name : "others", "", true, rest_open, heat);
    }
  }
  return out;
}

// Returns the smallest of 1, 2, 5, 10, ... that is not below x.
double round_up(double x) {
  const double decade = std::pow(10, std::floor(std::log10(x)));
  for (const double f : {1.0, 2.0, 5.0})
    if (f * decade >= x) return f * decade;
  return 10 * decade;
}

constexpr std::array<std::string_view, 12> kMonths = {
    "january", "february", "march",     "april",   "may",      "june",
    "july",    "august",   "september", "october", "november", "december"};

// "+01:00", "-03:30".
std::string offset_text(double hours) {
  const int minutes = static_cast<int>(std::lround(60 * hours));
  return absl::StrFormat("%c%02d:%02d", minutes < 0 ? '-' : '+', std::abs(minutes) / 60,
                         std::abs(minutes) % 60);
}

std::string times(const std::vector<int>& hours, double offset_h) {
  std::string out = "time = [";
  for (std::size_t i = 0; i < hours.size(); ++i)
    absl::StrAppend(&out, i == 0 ? "" : ", ",
                    absl::StrFormat("\"%02d:00%s\"", hours[i], offset_text(offset_h)));
  return out + "]";
}

// A season on the 15th of each month, and what its weather makes of the parts.
std::string weather_seasons(const TemplateAsked& asked) {
  std::string out =
      "\n# The wall of all parts but the hot ones, from the outer face inwards: assumed. Walls of "
      "their own:\n# docs/reference/keys/build_up.md.\n"
      "[[build_up]]\nname = \"plate\"\n"
      "layer = [{ solid = \"epoxy\", thickness_m = 0.0003 }, { solid = \"steel\", thickness_m = "
      "0.008 }]\ninside = \"adiabatic\"\n\n"
      "[heat]                       # temperatures are computed from the weather\n";
  std::vector<int> months = asked.months;
  for (int m = 1; asked.months.empty() && m <= 12; ++m) months.push_back(m);
  for (const int m : months)
    absl::StrAppend(&out, "\n[[season]]\nname = \"",
                    std::string(kMonths.at(static_cast<std::size_t>(m - 1))), "\"\ndate = 2025-",
                    absl::StrFormat("%02d", m),
                    "-15            # of this day, in whatever year the file has it\n");
  return out + "\n[weather]\nweather_file = " + quoted(asked.weather_file) + "\n";
}

}  // namespace

bool sounds_hot(std::string_view group) {
  const std::string name = absl::AsciiStrToLower(std::string(group));
  constexpr std::string_view kWords[] = {"funnel",  "exhaust", "stack",   "chimney",
                                         "uptake",  "engine",  "motor",   "nozzle",
                                         "muffler", "turbine", "radiator"};
  return std::ranges::any_of(kWords,
                             [&](std::string_view word) { return name.find(word) != name.npos; });
}

absl::StatusOr<std::vector<int>> numbers_of_list(std::string_view text, int least, int most) {
  const auto wrong = [&](std::string_view what) {
    return absl::InvalidArgumentError(
        absl::StrCat(one_line(std::string(text)), ": ", std::string(what), "expected numbers from ",
                     least, " to ", most, ", with commas and ranges between: ", least, "-", most,
                     " or ", least, ",", (least + most) / 2));
  };
  std::vector<int> out;
  const std::vector<std::string> pieces = absl::StrSplit(std::string(text), ',');
  for (const std::string& piece : pieces) {
    const std::vector<std::string> ends = absl::StrSplit(piece, '-');
    int first = 0, last = 0;
    if (ends.size() > 2 || !absl::SimpleAtoi(ends.front(), &first) ||
        !absl::SimpleAtoi(ends.back(), &last) || first < least || last > most || first > last)
      return wrong("");
    for (int n = first; n <= last; ++n) {
      if (std::ranges::find(out, n) != out.end())
        return wrong(absl::StrCat(n, " is there twice, "));
      out.push_back(n);
    }
  }
  return out;
}

absl::StatusOr<std::string> sweep_template(const TemplateAsked& asked, const Mesh& mesh) {
  const auto* weather = std::find_if(kSeasons.begin(), kSeasons.end(), [&](const SeasonWeather& s) {
    return s.name == (asked.season == "fall" ? "autumn" : asked.season);
  });
  if (weather == kSeasons.end())
    return absl::InvalidArgumentError(absl::StrCat("--season ", one_line(asked.season),
                                                   ": expected winter, spring, summer or autumn"));
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Vec<Body> low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
  for (const Vec<Body>& v : mesh.vertex) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  const Vec<Body> size = high - low;
  const double longest = std::max({size.x, size.y, size.z});
  const bool sea = asked.surroundings == "sea";
  const bool computed = !asked.weather_file.empty();
  const double offset_h =
      computed ? asked.utc_offset_h : static_cast<double>(std::lround(asked.longitude_deg / 15));
  const std::vector<int> hours = asked.hours.empty() ? std::vector<int>{12} : asked.hours;
  std::string out = absl::StrCat(
      "# A sweep to begin with:\n#\n#   irsig plan ", asked.name, ".toml\n#   irsig run ",
      asked.name, ".toml --db ", asked.name,
      ".sigdb\n#\n# Every key: docs/reference/sweep-file.md.\nname = ", quoted(asked.name), "\n",
      times(hours, offset_h), "      # of the day, with the offset from UTC\n");
  absl::StrAppend(
      &out, "\n# ", mesh.triangle.size(), " facets, ",
      absl::StrFormat("%.6g m long, %.6g m wide, %.6g m high; from %.6g m to %.6g m above the "
                      "waterline z = 0.\n",
                      size.x, size.y, size.z, -high.z + 0.0, -low.z + 0.0),
      "[model]\nfile = ", quoted(asked.model_file), "\nunit_m = ", asked.how.unit_m,
      "                   # metres in one unit of the file: ", one_line(asked.from.unit_m),
      "\nforward_axis = ", quoted(asked.how.forward_axis),
      "          # the file's axis that points to the bow: ", one_line(asked.from.forward_axis),
      "\nup_axis = ", quoted(asked.how.up_axis),
      "               # the file's axis that points up: ", one_line(asked.from.up_axis),
      "\nreference = ", quoted(asked.how.reference), "\n");
  if (sea)
    out +=
        "# draft_m = 5                # how deep it floats, if the file does not say: its lowest "
        "point below the water\n";
  absl::StrAppend(&out, "\n[place]",
                  asked.place_given ? ""
                  : computed        ? "                      # of the weather file"
                                    : "                      # assumed",
                  "\nlatitude_deg = ", asked.latitude_deg,
                  "\nlongitude_deg = ", asked.longitude_deg, "\n");
  if (asked.height_m != 0) absl::StrAppend(&out, "height_m = ", asked.height_m, "\n");
  out += "heading_deg = 0              # where the bow points, clockwise from north\n";
  if (computed)
    out +=
        "\n# Sunlight that the paint absorbs: assumed, it decides how warm sunlit walls become.\n"
        "[[material]]\nname = \"generic_grey_paint\"\nkind = \"library\"\nsolar_absorptance = "
        "0.65\n";
  out += parts(groups_of(mesh), {weather->air_k + 5, computed});
  if (computed)
    out += weather_seasons(asked);
  else
    absl::StrAppend(
        &out, "\n[[season]]\nname = \"", std::string(weather->name),
        "\"\ndate = ", std::string(asked.latitude_deg < 0 ? weather->date_south : weather->date),
        "\n\n# Assumed, for all seasons; hours of their own: [[condition]] or condition_file.\n"
        "[weather]\nair_temperature_k = ",
        weather->air_k, "\nrelative_humidity_percent = ", weather->humidity_percent,
        "\npressure_pa = 101300\n", sea ? "wind_speed_m_s = 5\n" : "");
  absl::StrAppend(&out, "\n[surroundings]\nkind = \"", sea ? "sea" : "ground", "\"\n",
                  sea ? absl::StrCat("sea_temperature_k = ", weather->sea_k, "\n")
                      : absl::StrCat("ground_temperature_k = ", weather->ground_k,
                                     "\nground_emissivity = 0.95\n",
                                     computed ? "solar_albedo = 0.25          # assumed\n" : ""),
                  "\n[air]\nmodel = \"atmosphere\"\naerosol = \"", sea ? "maritime" : "rural",
                  "\"\nvisibility_m = 23000\n\n[transport]\nsun = true\n");
  absl::StrAppend(
      &out,
      "\n[[band]]\nname = \"mwir\"\nlambda_min_um = 3\nlambda_max_um = 5\nstep_um = 0.1\n\n"
      "[[band]]\nname = \"lwir\"\nlambda_min_um = 8\nlambda_max_um = 12\nstep_um = 0.1\n\n"
      "# All around, near the horizon and from above; ranges_m = [1000, 5000] has several ranges.\n"
      "[viewpoints]\nkind = \"ring\"\ncount = 12\nelevation_deg = [5, 30]\nrange_m = ",
      round_up(std::max(1000.0, 20 * longest)),
      "\n\n[accuracy]\nrelative_error = 0.01        # of every in-band intensity\n");
  return out;
}

}  // namespace irsig
