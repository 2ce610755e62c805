#include "jobs/files/condition_table.h"

#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "jobs/files/season_surroundings.h"
#include "jobs/text/nearest_name.h"
#include "jobs/text/section_check.h"

namespace irsig {
namespace {

using google::protobuf::FieldDescriptor;
using schema::Season;

constexpr const char* kFile = "condition_file";

// A season, and where its keys are written: by their path below it ("" for itself).
struct Written {
  Season season;
  std::map<std::string, std::string> where;
  std::string as;  // what messages call it: "condition[3]"
};

// The places of all keys below a path.
std::map<std::string, std::string> below(const SweepFile& file, const std::string& path) {
  std::map<std::string, std::string> out;
  for (auto it = file.where.lower_bound(path);
       it != file.where.end() && absl::StartsWith(it->first, path); ++it) {
    const std::string rest = it->first.substr(path.size());
    if (rest.empty() || rest[0] == '.') out[rest] = it->second;
  }
  return out;
}

// Returns `base` with the values of `over` in place of its own.
Written overlaid(Written base, const Written& over) {
  Season& season = base.season;
  if (over.season.has_profile() || over.season.has_profile_file()) {
    season.clear_profile();
    season.clear_profile_file();
  }
  if (over.season.has_weather_file()) season.clear_day();
  if (over.season.has_day()) season.clear_weather_file();
  if (over.season.cloud_size() > 0) {
    season.clear_cloud();
    season.clear_cloud_cover();
    season.clear_cloud_type();
    season.clear_cloud_base_m();
    season.clear_cloud_water_path_g_m2();
  }
  const schema::Surroundings around = overridden(season.surroundings(), over.season.surroundings());
  const bool stated = season.has_surroundings() || over.season.has_surroundings();
  season.MergeFrom(over.season);
  if (stated) *season.mutable_surroundings() = around;
  // An error of a condition's name is reported at the condition.
  if (const auto own = over.where.find(""); own != over.where.end())
    base.where[".name"] = own->second;
  for (const auto& [path, place] : over.where) base.where[path] = place;
  base.as = over.as;
  return base;
}

// "2025-06-21T06:00:00+02:00" is a date and a time.
void split_time(Season& season) {
  const std::string& time = season.time();
  if (const std::size_t t = time.find('T'); t == 10) {
    const std::string whole = time;
    season.set_date(whole.substr(0, 10));
    season.set_time(whole.substr(11));
  }
}

class CsvConditions {
 public:
  CsvConditions(std::string name, absl::string_view text, const schema::Sweep& sweep,
                Findings& findings)
      : name_(std::move(name)), text_(text), sweep_(sweep), findings_(findings) {
    (void)absl::ConsumePrefix(&text_, "\xef\xbb\xbf");  // a byte order mark
  }

  std::vector<Written> read() {
    std::vector<Written> out;
    int line = 0;
    for (const absl::string_view whole : absl::StrSplit(text_, '\n')) {
      ++line;
      const absl::string_view row = absl::StripSuffix(whole, "\r");
      const absl::string_view bare = absl::StripAsciiWhitespace(row);
      if (bare.empty() || bare[0] == '#') continue;
      const std::vector<Cell> cells = cells_of(row);
      if (column_.empty()) {
        read_header(line, cells);
        if (!known_) return {};
        continue;
      }
      if (cells.size() != column_.size()) {
        add(line, 1,
            absl::StrCat(cells.size(), " columns, expected ", column_.size(),
                         " as in the first line (numbers have a decimal point, and no comma)"));
        continue;
      }
      Written& w = out.emplace_back();
      w.as = absl::StrCat("condition[", out.size() - 1, "]");
      w.where[""] = place(line, 1);
      for (std::size_t i = 0; i < cells.size(); ++i)
        if (!cells[i].text.empty()) set(line, cells[i], column_[i], w);
    }
    if (column_.empty()) add(1, 1, "is empty, expected a line of column names");
    if (!column_.empty() && out.empty() && known_) add(line, 1, "has no conditions");
    return out;
  }

 private:
  struct Cell {
    std::string text;
    std::size_t at;  // column of its first character, from 1
  };
  // A column holds a number or a text of a season or of its surroundings, or a temperature by name.
  struct Column {
    const FieldDescriptor* field = nullptr;
    bool of_surroundings = false;
    std::string part, land, path;
  };

  static std::vector<Cell> cells_of(absl::string_view row) {
    std::vector<Cell> out;
    std::size_t at = 0;
    for (const absl::string_view piece : absl::StrSplit(row, ',')) {
      const absl::string_view text = absl::StripAsciiWhitespace(piece);
      const auto lead = static_cast<std::size_t>(text.empty() ? 0 : text.data() - piece.data());
      // Spreadsheets quote texts; no name of a key has a comma.
      const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
      out.push_back({std::string(quoted ? text.substr(1, text.size() - 2) : text), at + lead + 1});
      at += piece.size() + 1;
    }
    return out;
  }

  [[nodiscard]] std::string place(int line, std::size_t column) const {
    return absl::StrCat(one_line(name_), ":", line, ":", column);
  }
  void add(int line, std::size_t column, const std::string& what) {
    findings_.add_at(place(line, column), absl::StrCat(kFile, ": ", what));
  }

  void read_header(int line, const std::vector<Cell>& cells) {
    std::vector<std::string> names;
    for (const google::protobuf::Descriptor* of :
         {Season::descriptor(), schema::Surroundings::descriptor()})
      for (int i = 0; i < of->field_count(); ++i)
        if (!of->field(i)->is_repeated() &&
            of->field(i)->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE)
          names.push_back(of->field(i)->name());
    for (const schema::Part& part : sweep_.part())
      names.push_back(absl::StrCat("part_temperature_k.", part.name()));
    for (const schema::LandMaterial& material : sweep_.land().material())
      names.push_back(absl::StrCat("land_temperature_k.", material.material()));
    for (const Cell& cell : cells) {
      Column column;
      absl::string_view name = cell.text;
      const bool dotted = absl::ConsumePrefix(&name, "surroundings.");
      if (!dotted) column.field = Season::descriptor()->FindFieldByName(std::string(name));
      if (column.field != nullptr && column.field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE)
        column.field = nullptr;
      if (column.field == nullptr) {
        column.field = schema::Surroundings::descriptor()->FindFieldByName(std::string(name));
        column.of_surroundings = column.field != nullptr;
      }
      column.path = absl::StrCat(column.of_surroundings ? ".surroundings." : ".", name);
      if (absl::ConsumePrefix(&name, "part_temperature_k.")) {
        column.part = std::string(name);
        column.path = absl::StrCat(".part_temperature_k.", name);
      }
      if (absl::ConsumePrefix(&name, "land_temperature_k.")) {
        column.land = std::string(name);
        column.path = absl::StrCat(".land_temperature_k.", name);
      }
      for (const Column& other : column_)
        if (other.path == column.path)
          add(line, cell.at, absl::StrCat("column \"", cell.text, "\" is there twice"));
      if (column.field == nullptr && column.part.empty() && column.land.empty()) {
        add(line, cell.at,
            absl::StrCat("unknown column \"", cell.text, "\", ",
                         cell.text.find_first_of(";\t") != std::string::npos
                             ? std::string("expected columns separated by commas")
                             : suggestion(cell.text, names)));
        known_ = false;
      }
      column_.push_back(std::move(column));
    }
  }

  void set(int line, const Cell& cell, const Column& column, Written& w) {
    w.where[column.path] = place(line, cell.at);
    const bool text =
        column.field != nullptr && column.field->cpp_type() == FieldDescriptor::CPPTYPE_STRING;
    double value = 0;
    if (!text) {
      const char* end = cell.text.data() + cell.text.size();
      const auto [after, error] = std::from_chars(cell.text.data(), end, value);
      if (error != std::errc() || after != end || !std::isfinite(value)) {
        add(line, cell.at,
            absl::StrCat(column.path.substr(1), " = \"", one_line(cell.text),
                         "\", expected a number"));
        return;
      }
    }
    if (!column.part.empty()) {
      (*w.season.mutable_part_temperature_k())[column.part] = value;
      return;
    }
    if (!column.land.empty()) {
      (*w.season.mutable_land_temperature_k())[column.land] = value;
      return;
    }
    google::protobuf::Message& to =
        column.of_surroundings
            ? static_cast<google::protobuf::Message&>(*w.season.mutable_surroundings())
            : w.season;
    if (text)
      to.GetReflection()->SetString(&to, column.field, cell.text);
    else
      to.GetReflection()->SetDouble(&to, column.field, value);
  }

  std::string name_;
  absl::string_view text_;
  const schema::Sweep& sweep_;
  Findings& findings_;
  std::vector<Column> column_;
  bool known_ = true;
};

// One way to vary a season: what is set, where it is written, and what it adds to the name.
struct Variant {
  Season season;
  std::map<std::string, std::string> where;
  std::string name;
};

class Expansion {
 public:
  explicit Expansion(SweepFile& file) : file_(file), sweep_(file.sweep), findings_(file) {}

  absl::Status run() {
    check_seasons();
    if (!findings_.empty()) return findings_.status();
    if (sweep_.condition_size() == 0 && !sweep_.has_condition_file() && !sweep_.has_weather() &&
        !sweep_.has_vary())
      return absl::OkStatus();
    std::vector<Written> all = seasons();
    const bool table = sweep_.condition_size() > 0 || sweep_.has_condition_file();
    if (table) all = conditions(all);
    const std::vector<Variant> variants = this->variants();
    if (!findings_.empty()) return findings_.status();
    write(all, variants);
    return absl::OkStatus();
  }

 private:
  // Conditions, which are written out as seasons, have these keys as well.
  void check_seasons() {
    for (int i = 0; i < sweep_.season_size(); ++i) {
      const std::string path = absl::StrCat("season[", i, "]");
      if (file_.written_as.contains(path)) continue;  // a condition that is written out already
      const SectionCheck check(sweep_.season(i), path, findings_);
      if (check.has("time"))
        check.error("time",
                    "does not apply: all seasons have the times of day of the sweep, expected "
                    "time = [\"06:00+02:00\", ...] at the top of the file, or a [[condition]]");
      if (check.has("season"))
        check.error("season", "does not apply, expected it in [[condition]] alone");
    }
  }

  std::vector<Written> seasons() {
    Written weather;
    if (sweep_.has_weather()) {
      const SectionCheck check(sweep_.weather(), "weather", findings_);
      check.only(
          {"air_temperature_k", "relative_humidity_percent", "pressure_pa", "wind_speed_m_s",
           "wind_speed_24h_m_s", "visibility_m", "profile", "profile_file", "sun_irradiance_w_m2",
           "weather_file", "day", "cloud", "cloud_cover", "cloud_type", "cloud_base_m",
           "cloud_water_path_g_m2", "wind_from_deg", "above_surface_m"},
          "to [weather], which has what all seasons share");
      weather.season = sweep_.weather();
      weather.where = below(file_, "weather");
    }
    std::vector<Written> out;
    for (int i = 0; i < sweep_.season_size(); ++i) {
      const std::string path = absl::StrCat("season[", i, "]");
      out.push_back(overlaid(weather, {sweep_.season(i), below(file_, path), path}));
    }
    if (out.empty()) base_ = weather;
    return out;
  }

  std::vector<Written> conditions(const std::vector<Written>& seasons) {
    if (sweep_.condition_size() > 0 && sweep_.has_condition_file())
      findings_.add(kFile, "condition_file and [[condition]] are both there, expected one of them");
    if (sweep_.time_size() > 0)
      findings_.add("time",
                    "time does not apply: every condition has its own, expected it in "
                    "[[condition]] alone");
    std::vector<Written> rows;
    for (int i = 0; i < sweep_.condition_size(); ++i) {
      const std::string path = absl::StrCat("condition[", i, "]");
      rows.push_back({sweep_.condition(i), below(file_, path), path});
    }
    if (sweep_.has_condition_file()) {
      const auto text = file_.content.find(kFile);
      if (text == file_.content.end()) {
        findings_.add(kFile, "condition_file was not read");
        return {};
      }
      rows = CsvConditions(sweep_.condition_file(), text->second, sweep_, findings_).read();
    }
    std::vector<Written> out;
    for (Written& row : rows) {
      split_time(row.season);
      const std::optional<Written> base = base_of(row, seasons);
      if (!base) continue;
      Written& whole = out.emplace_back(overlaid(*base, row));
      Season& season = whole.season;
      if (!season.has_time())
        add(whole, ".time",
            ".time is missing, expected a time of day with its offset: \"10:30+09:00\"");
      if (!season.has_date())
        add(whole, ".date", ".date is missing, expected a date, here or in its season: 2025-12-21");
      if (!season.has_name()) season.set_name(season.date());
      season.clear_season();
    }
    return out;
  }

  void add(const Written& w, const std::string& key, const std::string& what) {
    const auto at = w.where.find(key);
    const auto table = w.where.find("");
    findings_.add_at(at != w.where.end()      ? at->second
                     : table != w.where.end() ? table->second
                                              : file_.location(""),
                     w.as + what);
  }

  std::optional<Written> base_of(const Written& row, const std::vector<Written>& seasons) {
    if (!row.season.has_season()) {
      if (seasons.empty()) return base_;
      if (seasons.size() == 1) return seasons.front();
      add(row, ".season",
          absl::StrCat(".season is missing, expected one of ", quoted_list(names(seasons))));
      return std::nullopt;
    }
    for (const Written& s : seasons)
      if (s.season.name() == row.season.season()) return s;
    add(row, ".season",
        absl::StrCat(".season = \"", one_line(row.season.season()), "\", ",
                     seasons.empty() ? std::string("but there is no [[season]]; conditions may do "
                                                   "without: leave it out and give each a date")
                                     : suggestion(row.season.season(), names(seasons))));
    return std::nullopt;
  }

  static std::vector<std::string> names(const std::vector<Written>& seasons) {
    std::vector<std::string> out;
    for (const Written& s : seasons) out.push_back(s.season.name());
    return out;
  }

  // Returns for each list of [vary] its values one by one.
  std::vector<std::vector<Variant>> lists() {
    std::vector<std::vector<Variant>> out;
    const schema::Vary& vary = sweep_.vary();
    std::vector<const FieldDescriptor*> present;
    vary.GetReflection()->ListFields(vary, &present);
    for (const FieldDescriptor* field : present) {
      if (!field->is_repeated()) continue;
      const std::string& key = field->name();
      const bool of_surroundings = Season::descriptor()->FindFieldByName(key) == nullptr;
      std::vector<Variant>& list = out.emplace_back();
      for (int i = 0; i < vary.GetReflection()->FieldSize(vary, field); ++i) {
        Variant& v = list.emplace_back();
        google::protobuf::Message& to =
            of_surroundings
                ? static_cast<google::protobuf::Message&>(*v.season.mutable_surroundings())
                : v.season;
        const FieldDescriptor* target = to.GetDescriptor()->FindFieldByName(key);
        std::string value;
        if (field->cpp_type() == FieldDescriptor::CPPTYPE_STRING) {
          value = vary.GetReflection()->GetRepeatedString(vary, field, i);
          to.GetReflection()->SetString(&to, target, value);
        } else {
          const double number = vary.GetReflection()->GetRepeatedDouble(vary, field, i);
          value = absl::StrCat(number);
          to.GetReflection()->SetDouble(&to, target, number);
        }
        v.name = absl::StrCat(", ", key, " = ", value);
        v.where[absl::StrCat(of_surroundings ? ".surroundings." : ".", key)] =
            file_.location(absl::StrCat("vary.", key, "[", i, "]"));
      }
    }
    return out;
  }

  static Variant both(Variant a, const Variant& b) {
    a.season.MergeFrom(b.season);
    a.where.insert(b.where.begin(), b.where.end());
    a.name += b.name;
    return a;
  }

  std::vector<Variant> variants() {
    if (!sweep_.has_vary()) return {Variant{}};
    const SectionCheck check(sweep_.vary(), "vary", findings_);
    const auto lists = this->lists();
    if (lists.empty()) {
      findings_.add("vary", "vary is empty, expected lists: wind_speed_m_s = [ 2, 5, 10 ]");
      return {};
    }
    const bool known = check.one_of("combine", {"cross", "zip"});
    if (lists.size() > 1)
      check.require({"combine"},
                    "expected \"cross\" (every value with every other) or \"zip\" (the first with "
                    "the first, the second with the second ...)");
    if (lists.size() > 1 && !known) return {};
    if (sweep_.vary().combine() == "zip") {
      for (const auto& list : lists)
        if (list.size() != lists[0].size()) {
          check.error("combine", absl::StrCat("= \"zip\" of lists of ", lists[0].size(), " and ",
                                              list.size(), " values, expected as many in each"));
          return {};
        }
      std::vector<Variant> out = lists[0];
      for (std::size_t k = 1; k < lists.size(); ++k)
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = both(out[i], lists[k][i]);
      return out;
    }
    std::vector<Variant> out{Variant{}};
    for (const auto& list : lists) {
      std::vector<Variant> more;
      for (const Variant& v : out)
        for (const Variant& w : list) more.push_back(both(v, w));
      out = std::move(more);
    }
    return out;
  }

  void write(const std::vector<Written>& all, const std::vector<Variant>& variants) {
    std::erase_if(file_.where,
                  [](const auto& entry) { return absl::StartsWith(entry.first, "season["); });
    sweep_.clear_season();
    for (const Written& base : all)
      for (const Variant& v : variants) {
        Written w = overlaid(base, {v.season, v.where, base.as});
        if (!v.name.empty()) w.season.set_name(w.season.name() + v.name);
        const std::string path = absl::StrCat("season[", sweep_.season_size(), "]");
        for (const auto& [rest, place] : w.where) file_.where[path + rest] = place;
        if (path != w.as) file_.written_as[path] = w.as;
        *sweep_.add_season() = std::move(w.season);
      }
    if (sweep_.condition_size() > 0 || sweep_.has_condition_file()) sweep_.add_time("");
    sweep_.clear_condition();
    sweep_.clear_condition_file();
    sweep_.clear_weather();
    sweep_.clear_vary();
  }

  SweepFile& file_;
  schema::Sweep& sweep_;
  Findings findings_;
  Written base_;  // of conditions where there is no season
};

}  // namespace

absl::Status expand_conditions(SweepFile& file) { return Expansion(file).run(); }

}  // namespace irsig
