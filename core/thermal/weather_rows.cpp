#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/csv_rows.h"
#include "core/base/file_errors.h"
#include "core/base/printable.h"
#include "core/thermal/weather_file.h"

namespace irsig {
namespace {

using Q = WeatherQuantity;
constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t index_of(Q q) { return static_cast<std::size_t>(q); }

// Factor and offset that make a column's numbers SI, and the limits of the result.
struct Form {
  Q quantity;
  double factor = 1, offset = 0;
  double missing_above = std::numeric_limits<double>::infinity();  // codes, in the file's unit
  double missing_below = -std::numeric_limits<double>::infinity();
};

// 99, 999 and so on to 999999, with or without .9, of either sign.
bool is_code_of_missing(double value) {
  double nines = 99;
  for (int digits = 2; digits <= 6; ++digits, nines = 10 * nines + 9)
    if (std::abs(value) == nines || std::abs(std::abs(value) - (nines + 0.9)) < 1e-9) return true;
  return false;
}

bool is_word_of_missing(std::string_view text) {
  for (const char* word : {"na", "n/a", "nan", "null"})
    if (absl::EqualsIgnoreCase(std::string(text), word)) return true;
  return false;
}

std::string quoted(std::string_view text) {
  return absl::StrCat("\"", one_line(text.substr(0, 40)), text.size() > 40 ? "..." : "", "\"");
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

// Returns the name of a file that is no CSV file of irsig's, and what to do with it.
std::string other_weather_file(std::string_view head, std::string_view whole) {
  const std::string whole_line(whole);
  if (head.starts_with("\xff\xfe") || head.starts_with("\xfe\xff"))
    return "this is text in UTF-16, expected UTF-8: save it as UTF-8";
  if (head.substr(0, 1000).find('\0') != head.npos)
    return "this is a binary file, expected text: save the sheet as CSV";
  if (absl::StartsWithIgnoreCase(whole_line, "LOCATION,"))
    return "this is an EPW file, expected a name that ends in .epw";
  if (absl::StartsWithIgnoreCase(whole_line, "Source,Location ID"))
    return "this is a CSV file of the NSRDB, whose columns are not read: export EPW or TMY3, or "
           "write its columns under irsig's names";
  for (const auto& [separator, name] : {std::pair(';', "semicolons"), std::pair('\t', "tabs")})
    if (whole_line.front() != '#' && whole_line.find(separator) != whole_line.npos &&
        whole_line.find(',') == whole_line.npos)
      return absl::StrCat("the cells are separated by ", name,
                          ", expected commas, and numbers with decimal points");
  return "";
}

class RowReader {
 public:
  RowReader(std::string_view text, const std::string& name) : rows_(text), errors_(name) {
    file_.name = name;
  }

  absl::StatusOr<WeatherFile> epw() {
    file_.any_year = true;
    file_.radiation_interval_s = 3600;
    bool data = false, semicolons = false;
    while (!data && rows_.next_with_remarks()) {
      const auto& cells = rows_.cells();
      semicolons =
          semicolons || absl::StartsWithIgnoreCase(std::string(rows_.whole()), "LOCATION;");
      if (is_word(cells, "LOCATION")) read_place(cells, 6, 7, 8, 9);
      data = is_word(cells, "DATA PERIODS");
      if (data && number(cells, 2, "records in an hour", 1, 60).value_or(1) != 1)
        add(cells[2], "expected one record an hour");
    }
    if (!data && semicolons)
      errors_.add(
          1, 1,
          "the cells are separated by semicolons, expected commas, and numbers with decimal "
          "points");
    else if (!data)
      errors_.add(1, 1, "there is no line DATA PERIODS, expected an EPW file with its header");
    if (!file_.place && !errors_.any())
      errors_.add(1, 1, "there is no line LOCATION, expected an EPW file with its header");
    static const std::vector<std::pair<std::size_t, Form>> columns = {
        {6, {Q::kAir, 1, 273.15, 99.9}},      {7, {Q::kDewPoint, 1, 273.15, 99.9}},
        {8, {Q::kHumidity, 1, 0, 999}},       {9, {Q::kPressure, 1, 0, 999999}},
        {12, {Q::kSky, 1, 0, 9999}},          {13, {Q::kGlobalHorizontal, 1, 0, 9999}},
        {14, {Q::kDirectNormal, 1, 0, 9999}}, {15, {Q::kDiffuseHorizontal, 1, 0, 9999}},
        {20, {Q::kWindFrom, 1, 0, 999}},      {21, {Q::kWind, 1, 0, 999}},
        {23, {Q::kCloudCover, 0.1, 0, 99}}};
    column_ = columns;
    while (!errors_.full() && !errors_blocking_ && data && rows_.next_with_remarks()) {
      const auto& cells = rows_.cells();
      if (!long_enough(cells, 24, false)) continue;
      const auto year = number(cells, 0, "a year", 1800, 2200);
      const auto month = number(cells, 1, "a month", 1, 12);
      const auto day = number(cells, 2, "a day", 1, 31);
      const auto hour = number(cells, 3, "an hour", 1, 24);
      if (year && month && day && hour) hour_row(cells, *year, *month, *day, *hour, cells[1]);
    }
    return done();
  }

  absl::StatusOr<WeatherFile> tmy3() {
    file_.any_year = true;
    file_.radiation_interval_s = 3600;
    (void)rows_.next_with_remarks();
    read_place(rows_.cells(), 4, 5, 3, 6);
    (void)rows_.next_with_remarks();
    static const std::map<std::string, Form, std::less<>> known = {
        {"GHI (W/m^2)", {Q::kGlobalHorizontal, 1, 0, 9900, -9000}},
        {"DNI (W/m^2)", {Q::kDirectNormal, 1, 0, 9900, -9000}},
        {"DHI (W/m^2)", {Q::kDiffuseHorizontal, 1, 0, 9900, -9000}},
        {"OpqCld (tenths)", {Q::kCloudCover, 0.1, 0, 99, -9000}},
        {"Dry-bulb (C)", {Q::kAir, 1, 273.15, 99.9, -9000}},
        {"Dew-point (C)", {Q::kDewPoint, 1, 273.15, 99.9, -9000}},
        {"RHum (%)", {Q::kHumidity, 1, 0, 999, -9000}},
        {"Pressure (mbar)", {Q::kPressure, 100, 0, 9900, -9000}},
        {"Wdir (degrees)", {Q::kWindFrom, 1, 0, 990, -9000}},
        {"Wspd (m/s)", {Q::kWind, 1, 0, 990, -9000}}};
    const auto& header = rows_.cells();
    for (std::size_t i = 0; i < header.size(); ++i)
      if (const auto found = known.find(header[i].text); found != known.end())
        column_.emplace_back(i, found->second);
    for (const auto& [name, form] : known)
      if (std::none_of(column_.begin(), column_.end(),
                       [&](const auto& c) { return c.second.quantity == form.quantity; }))
        errors_.add(rows_.line(), 1, absl::StrCat("there is no column \"", name, "\""));
    const std::size_t width = header.size();
    errors_blocking_ = errors_.any();
    while (!errors_.full() && !errors_blocking_ && rows_.next_with_remarks()) {
      const auto& cells = rows_.cells();
      if (!long_enough(cells, width)) continue;
      const std::string_view date = cells[0].text, time = cells[1].text;
      const auto part = [](std::string_view text, std::size_t from, std::size_t count) {
        return text.size() < from + count ? std::nullopt : finite_number(text.substr(from, count));
      };
      const auto month = part(date, 0, 2), day = part(date, 3, 2), year = part(date, 6, 4);
      const auto hour = part(time, 0, 2);
      if (date.size() != 10 || !month || !day || !year || *month < 1 || *month > 12 || *day < 1 ||
          *day > 31 || *year < 1800 || *year > 2200) {
        add(cells[0], absl::StrCat(quoted(date), ", expected a date: 07/21/1999"));
      } else if (time.size() != 5 || time.substr(2) != ":00" || !hour || *hour < 1 || *hour > 24) {
        add(cells[1], absl::StrCat(quoted(time), ", expected the end of an hour: 01:00 to 24:00"));
      } else {
        hour_row(cells, *year, *month, *day, *hour, cells[0]);
      }
    }
    return done();
  }

  absl::StatusOr<WeatherFile> csv() {
    std::size_t width = 0;
    std::optional<std::size_t> time_at;
    std::optional<double> interval_s;
    while (!errors_.full() && !errors_blocking_ && rows_.next_with_remarks()) {
      if (rows_.whole().front() == '#') {
        read_remark(interval_s);
        continue;
      }
      const auto& cells = rows_.cells();
      if (width == 0) {
        if (const std::string other = other_weather_file("", rows_.whole()); !other.empty()) {
          errors_.add(rows_.line(), 1, other);
          return done();
        }
        width = cells.size();
        time_at = read_header(cells, interval_s.has_value());
        file_.radiation_interval_s = interval_s.value_or(0);
        errors_blocking_ = errors_.any();
        continue;
      }
      if (!long_enough(cells, width)) continue;
      const CsvCell& cell = cells[*time_at];
      const auto time = parse_rfc3339(cell.text);
      if (!time.ok()) {
        add(cell, one_line(std::string(time.status().message())));
        continue;
      }
      WeatherFile::Row row = values(cells);
      row.local_s = unix_seconds(*time);
      if (!file_.row.empty() && !(row.local_s > file_.row.back().local_s))
        add(cell, absl::StrCat(quoted(cell.text),
                               " is not later than the row before it, expected increasing times"));
      file_.row.push_back(row);
    }
    if (width == 0) errors_.add(1, 1, "there is no line with the names of columns");
    return done();
  }

 private:
  static std::string_view word(const std::vector<CsvCell>& cells, std::size_t i) {
    return i < cells.size() ? cells[i].text : std::string_view();
  }
  static bool is_word(const std::vector<CsvCell>& cells, const char* wanted) {
    return absl::EqualsIgnoreCase(std::string(word(cells, 0)), wanted);
  }
  void add(const CsvCell& cell, const std::string& what) {
    errors_.add(cell.line, cell.column, what);
  }

  bool long_enough(const std::vector<CsvCell>& cells, std::size_t count, bool exact = true) {
    if (exact ? cells.size() == count : cells.size() >= count) return true;
    add(cells.back(),
        absl::StrCat(cells.size(), " cells, expected ", count, exact ? "" : " or more"));
    return false;
  }

  std::optional<double> number(const std::vector<CsvCell>& cells, std::size_t i, const char* what,
                               double least, double most) {
    const auto value = i < cells.size() ? finite_number(cells[i].text) : std::nullopt;
    if (value && *value >= least && *value <= most) return value;
    add(i < cells.size() ? cells[i] : cells.back(),
        absl::StrCat(quoted(word(cells, i)), ", expected ", what, " from ", least, " to ", most));
    return std::nullopt;
  }

  void read_place(const std::vector<CsvCell>& cells, std::size_t latitude, std::size_t longitude,
                  std::size_t offset, std::size_t height) {
    const auto north = number(cells, latitude, "a latitude", -90, 90);
    const auto east = number(cells, longitude, "a longitude", -180, 180);
    const auto hours = number(cells, offset, "an offset from UTC in hours", -14, 14);
    const auto metres = number(cells, height, "a height in metres", -500, 9000);
    if (!north || !east || !hours || !metres) return;
    file_.place = WeatherPlace{*north, *east, *metres};
    file_.utc_offset_h = *hours;
  }

  void read_remark(std::optional<double>& interval_s) {
    std::string_view text = rows_.whole().substr(1);
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos || trimmed(text.substr(0, colon)) != "radiation_interval_s")
      return;
    const std::string_view value = trimmed(text.substr(colon + 1));
    if (interval_s) errors_.add(rows_.line(), 1, "radiation_interval_s is said already");
    interval_s = finite_number(value);
    if (!interval_s || *interval_s < 0 || *interval_s > 10800) {
      errors_.add(rows_.line(), colon + 3,
                  absl::StrCat(quoted(value), ", expected seconds from 0 to 10800"));
      interval_s = 0;
    }
  }

  // Returns where the time is.
  std::size_t read_header(const std::vector<CsvCell>& cells, bool interval_stated) {
    static const std::map<std::string, Form, std::less<>> known = {
        {"air_temperature_k", {Q::kAir}},
        {"air_temperature_c", {Q::kAir, 1, 273.15}},
        {"dew_point_k", {Q::kDewPoint}},
        {"dew_point_c", {Q::kDewPoint, 1, 273.15}},
        {"relative_humidity_percent", {Q::kHumidity}},
        {"pressure_pa", {Q::kPressure}},
        {"pressure_hpa", {Q::kPressure, 100}},
        {"wind_speed_m_s", {Q::kWind}},
        {"wind_from_deg", {Q::kWindFrom}},
        {"cloud_cover", {Q::kCloudCover}},
        {"direct_normal_w_m2", {Q::kDirectNormal}},
        {"diffuse_horizontal_w_m2", {Q::kDiffuseHorizontal}},
        {"global_horizontal_w_m2", {Q::kGlobalHorizontal}},
        {"sky_w_m2", {Q::kSky}}};
    std::optional<std::size_t> time_at;
    bool listed = false;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (cells[i].text == "time") {
        if (time_at) add(cells[i], "column \"time\" is there twice");
        time_at = i;
        continue;
      }
      const auto found = known.find(cells[i].text);
      if (found == known.end()) {
        const std::string lower = absl::AsciiStrToLower(std::string(cells[i].text));
        std::string wanted = lower == "time" || known.contains(lower)
                                 ? absl::StrCat(", expected \"", lower, "\" in lower case")
                                 : "";
        if (wanted.empty() && !listed) {  // once is enough
          listed = true;
          wanted = absl::StrCat(", expected time, ",
                                absl::StrJoin(known, ", ", [](std::string* out, const auto& k) {
                                  out->append(k.first);
                                }));
        }
        add(cells[i], absl::StrCat("unknown column ", quoted(cells[i].text), wanted));
        continue;
      }
      for (const auto& [other, form] : column_)
        if (form.quantity == found->second.quantity)
          add(cells[i], absl::StrCat("column ", quoted(cells[i].text), " is there twice"));
      column_.emplace_back(i, found->second);
      if (found->second.quantity >= Q::kDirectNormal && !interval_stated) {
        add(cells[i],
            "radiation without a line \"# radiation_interval_s: 3600\" above, expected the seconds "
            "before each time that it is the mean over (0: it is of the time itself)");
        interval_stated = true;
      }
    }
    const auto has = [&](Q q) {
      return std::any_of(column_.begin(), column_.end(),
                         [&](const auto& c) { return c.second.quantity == q; });
    };
    const auto missing = [&](const char* what) {
      errors_.add(rows_.line(), 1, absl::StrCat("there is no column ", what));
    };
    if (!time_at) missing("time");
    if (!has(Q::kAir)) missing("air_temperature_k or air_temperature_c");
    if (!has(Q::kDewPoint) && !has(Q::kHumidity))
      missing("dew_point_k, dew_point_c or relative_humidity_percent");
    if (!has(Q::kPressure)) missing("pressure_pa or pressure_hpa");
    if (!has(Q::kWind)) missing("wind_speed_m_s");
    if (has(Q::kDirectNormal) + has(Q::kDiffuseHorizontal) + has(Q::kGlobalHorizontal) == 1)
      errors_.add(rows_.line(), 1,
                  "one kind of sunlight alone, expected two of direct_normal_w_m2, "
                  "diffuse_horizontal_w_m2 and global_horizontal_w_m2");
    return time_at.value_or(0);
  }

  WeatherFile::Row values(const std::vector<CsvCell>& cells) {
    WeatherFile::Row row;
    row.line = rows_.line();
    row.value.fill(kMissing);
    row.column.fill(1);
    for (const auto& [i, form] : column_) {
      const CsvCell& cell = cells[i];
      const std::size_t q = index_of(form.quantity);
      row.column[q] = static_cast<std::uint32_t>(cell.column);
      if (cell.text.empty() || is_word_of_missing(cell.text)) continue;
      const auto value = finite_number(cell.text);
      if (!value) {
        add(cell, absl::StrCat(quoted(cell.text), ", expected a number"));
        continue;
      }
      if (*value >= form.missing_above || *value <= form.missing_below) continue;
      const double si = *value * form.factor + form.offset;
      const WeatherLimit& limit = limit_of(form.quantity);
      const bool no_sky = form.quantity == Q::kSky && si == 0;  // of files that do not know it
      row.impossible[q] = !(si >= limit.least && si <= limit.most) && !no_sky;
      if (!row.impossible[q] || !is_code_of_missing(*value))
        row.value[q] = si;
      else
        row.impossible[q] = false;
    }
    return row;
  }

  void hour_row(const std::vector<CsvCell>& cells, double year, double month, double day,
                double hour, const CsvCell& date) {
    WeatherFile::Row row = values(cells);
    const auto whole = [](double x) { return static_cast<int>(x); };
    row.hour_of_year = 10000 * whole(month) + 100 * whole(day) + whole(hour);
    if (!parse_rfc3339(absl::StrCat("2000-", absl::Dec(whole(month), absl::kZeroPad2), "-",
                                    absl::Dec(whole(day), absl::kZeroPad2), "T00:00:00Z"))
             .ok()) {
      add(date, absl::StrCat("month ", month, ", day ", day, ": expected a day of the calendar"));
      return;
    }
    row.local_s = unix_seconds({whole(year), whole(month), whole(day), 0, 0, 0}) + 3600 * hour;
    if (!file_.row.empty() && row.hour_of_year <= file_.row.back().hour_of_year)
      add(date, absl::StrCat("month ", month, ", day ", day, ", hour ", hour,
                             " is not later in the year than the row before it, expected the "
                             "hours in their order, each once"));
    file_.one_year = file_.row.empty() || file_.one_year == whole(year) ? whole(year) : 0;
    file_.row.push_back(row);
  }

  absl::StatusOr<WeatherFile> done() {
    if (!errors_.any() && file_.row.empty()) errors_.add(rows_.line() + 1, 1, "there are no rows");
    if (errors_.any()) return errors_.status();
    for (const auto& [i, form] : column_) {
      file_.has[index_of(form.quantity)] = true;
      file_.factor[index_of(form.quantity)] = form.factor;
      file_.offset[index_of(form.quantity)] = form.offset;
    }
    return std::move(file_);
  }

  CsvRows rows_;
  FileErrors errors_;
  bool errors_blocking_ = false;  // rows make no sense
  std::vector<std::pair<std::size_t, Form>> column_;
  WeatherFile file_;
};

}  // namespace

absl::StatusOr<WeatherFile> read_weather_file(std::string_view text, const std::string& file_name) {
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  if (const std::string other = other_weather_file(text, "#"); !other.empty())
    return placed_problem(absl::StrCat(file_name, ":1:1"), other);
  if (absl::EndsWithIgnoreCase(file_name, ".epw")) return RowReader(text, file_name).epw();
  if (!absl::EndsWithIgnoreCase(file_name, ".csv"))
    return placed_problem(absl::StrCat(file_name, ":1:1"),
                          "expected a weather file that ends in .epw or .csv");
  CsvRows head(text);
  (void)head.next_with_remarks();
  if (head.next_with_remarks() && head.whole().starts_with("Date (MM/DD/YYYY)"))
    return RowReader(text, file_name).tmy3();
  return RowReader(text, file_name).csv();
}

}  // namespace irsig
