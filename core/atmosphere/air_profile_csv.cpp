#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/atmosphere/air_profile.h"
#include "core/base/problems.h"

namespace irsig {
namespace {

constexpr double kWaterToAirMass = 18.0153 / 28.9647;

enum class Quantity { kHeight, kPressure, kTemperature, kHumidity };
enum class Unit {
  kMetre,
  kKilometre,
  kPascal,
  kHectopascal,
  kKelvin,
  kCelsius,
  kPpmv,
  kGramPerKilogram,
  kPercent,
  kDewPointKelvin,
  kDewPointCelsius
};
struct LevelColumn {
  Quantity quantity;
  Unit unit;
};

const std::map<std::string_view, LevelColumn>& columns() {
  static const std::map<std::string_view, LevelColumn> known = {
      {"height_m", {Quantity::kHeight, Unit::kMetre}},
      {"height_km", {Quantity::kHeight, Unit::kKilometre}},
      {"pressure_pa", {Quantity::kPressure, Unit::kPascal}},
      {"pressure_hpa", {Quantity::kPressure, Unit::kHectopascal}},
      {"temperature_k", {Quantity::kTemperature, Unit::kKelvin}},
      {"temperature_c", {Quantity::kTemperature, Unit::kCelsius}},
      {"h2o_ppmv", {Quantity::kHumidity, Unit::kPpmv}},
      {"h2o_g_kg", {Quantity::kHumidity, Unit::kGramPerKilogram}},
      {"relative_humidity_percent", {Quantity::kHumidity, Unit::kPercent}},
      {"dew_point_k", {Quantity::kHumidity, Unit::kDewPointKelvin}},
      {"dew_point_c", {Quantity::kHumidity, Unit::kDewPointCelsius}}};
  return known;
}

struct LevelField {
  std::string_view text;
  int line, column;  // from 1
};

class ProfileReader {
 public:
  ProfileReader(std::string_view text, std::string_view file, const AirProfile& base,
                double place_m)
      : text_(text), file_(file), base_(base), place_m_(place_m) {}

  absl::StatusOr<AirProfile> read() {
    bool header = true;
    int line_number = 0;
    while (!text_.empty()) {
      const std::size_t end = text_.find('\n');
      std::string_view line = text_.substr(0, end);
      text_.remove_prefix(end == std::string_view::npos ? text_.size() : end + 1);
      ++line_number;
      if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      if (line.find_first_not_of(" \t") == std::string_view::npos || line.front() == '#') continue;
      const std::vector<LevelField> fields = split(line, line_number);
      if (header) {
        read_header(fields);
        if (!errors_.empty()) break;
        header = false;
      } else {
        read_level(fields);
      }
    }
    if (header && errors_.empty()) {
      error(line_number + 1, 1, "no header line, expected columns such as height_m");
    }
    if (errors_.empty() && profile_.level.size() < 2) {
      error(line_number + 1, 1, "expected at least two levels");
    }
    if (errors_.empty() && place_m_ > 0 && profile_.level.back().height_m <= place_m_) {
      error(line_number, 1,
            absl::StrFormat("the highest level, %g m, is not above the place at %g m: heights are "
                            "above mean sea level",
                            profile_.level.back().height_m, place_m_));
    }
    if (!errors_.empty()) return problem_status(errors_);
    return join_base();
  }

 private:
  void error(int line, int column, std::string_view what) {
    errors_.push_back({absl::StrFormat("%s:%d:%d", file_, line, column), "", std::string(what)});
  }

  static std::vector<LevelField> split(std::string_view line, int line_number) {
    std::vector<LevelField> fields;
    for (std::size_t start = 0;;) {
      const std::size_t comma = std::min(line.find(',', start), line.size());
      std::size_t first = start, last = comma;
      while (first < last && (line[first] == ' ' || line[first] == '\t')) ++first;
      while (last > first && (line[last - 1] == ' ' || line[last - 1] == '\t')) --last;
      fields.push_back(
          {line.substr(first, last - first), line_number, static_cast<int>(first) + 1});
      if (comma == line.size()) return fields;
      start = comma + 1;
    }
  }

  void read_header(const std::vector<LevelField>& fields) {
    std::optional<Unit> found[4];
    for (const LevelField& field : fields) {
      const auto known = columns().find(field.text);
      if (known == columns().end()) {
        error(field.line, field.column,
              absl::StrFormat("unknown column \"%s\", expected one of %s", field.text,
                              absl::StrJoin(columns(), ", ", [](std::string* out, const auto& c) {
                                out->append(c.first);
                              })));
        header_.push_back({Quantity::kHeight, Unit::kMetre});
        continue;
      }
      auto& slot = found[static_cast<int>(known->second.quantity)];
      if (slot.has_value()) {
        error(field.line, field.column,
              absl::StrFormat("column \"%s\" states the same quantity again", field.text));
      }
      slot = known->second.unit;
      header_.push_back(known->second);
    }
    constexpr std::string_view kWanted[] = {"height", "pressure", "temperature", "humidity"};
    for (int q = 0; q < 4; ++q) {
      if (!found[q].has_value()) {
        error(fields[0].line, 1, absl::StrFormat("no column for the %s", kWanted[q]));
      }
    }
  }

  void read_level(const std::vector<LevelField>& fields) {
    if (fields.size() != header_.size()) {
      error(fields[0].line, 1,
            absl::StrFormat("%d fields, expected %d as in the header", fields.size(),
                            header_.size()));
      return;
    }
    double value[4] = {};
    const LevelField* at[4] = {};
    Unit humidity_unit = Unit::kPpmv;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      double x = 0;
      const std::string_view text = fields[i].text;
      const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), x);
      if (code != std::errc() || end != text.data() + text.size() || !std::isfinite(x)) {
        error(fields[i].line, fields[i].column, absl::StrFormat("\"%s\" is not a number", text));
        return;
      }
      switch (header_[i].unit) {
        case Unit::kKilometre:
          x *= 1e3;
          break;
        case Unit::kHectopascal:
          x *= 100;
          break;
        case Unit::kCelsius:
        case Unit::kDewPointCelsius:
          x += 273.15;
          break;
        default:
          break;
      }
      const auto q = static_cast<std::size_t>(header_[i].quantity);
      value[q] = x;
      at[q] = &fields[i];
      if (header_[i].quantity == Quantity::kHumidity) humidity_unit = header_[i].unit;
    }
    add_level(value, at, humidity_unit);
  }

  void add_level(const double (&value)[4], const LevelField* const (&at)[4], Unit humidity_unit) {
    const std::size_t errors_before = errors_.size();
    const auto expect = [&](bool good, Quantity q, std::string_view what) {
      if (!good) {
        const LevelField& field = *at[static_cast<std::size_t>(q)];
        error(field.line, field.column, absl::StrFormat("%s: %s", field.text, what));
      }
    };
    const double height_m = value[0], pressure_pa = value[1], temperature_k = value[2];
    const AirLevel* below = profile_.level.empty() ? nullptr : &profile_.level.back();
    expect(height_m >= 0 && height_m <= 1.2e5, Quantity::kHeight, "expected 0 to 120 km");
    constexpr double kMostAboveM = 100;
    expect(below != nullptr || height_m <= place_m_ + kMostAboveM, Quantity::kHeight,
           absl::StrFormat("the lowest level is above %g m: the air below it is not stated",
                           place_m_ + kMostAboveM));
    expect(below == nullptr || height_m > below->height_m, Quantity::kHeight,
           "expected heights that increase");
    expect(pressure_pa > 0 && pressure_pa <= 1.1e5, Quantity::kPressure,
           "expected more than 0 and at most 1100 hPa");
    expect(below == nullptr || pressure_pa < below->pressure_pa, Quantity::kPressure,
           "expected pressures that decrease");
    expect(temperature_k >= 150 && temperature_k <= 340, Quantity::kTemperature,
           "expected 150 to 340 K");
    if (errors_.size() > errors_before) return;

    double ppmv = value[3];
    const double saturated_ppmv = 1e6 * saturation_pressure_pa(temperature_k) / pressure_pa;
    switch (humidity_unit) {
      case Unit::kGramPerKilogram:  // r = (18.0153 / 28.9647) x / (1 - x)
        ppmv = 1e6 * (1e-3 * value[3]) / (1e-3 * value[3] + kWaterToAirMass);
        break;
      case Unit::kPercent:
        ppmv = 1e-2 * value[3] * saturated_ppmv;
        break;
      case Unit::kDewPointKelvin:
      case Unit::kDewPointCelsius:
        expect(value[3] > 0 && value[3] <= temperature_k + 0.15, Quantity::kHumidity,
               "expected a dew point not above the air's temperature");
        ppmv = 1e6 * saturation_pressure_pa(value[3]) / pressure_pa;
        break;
      default:
        break;
    }
    // Above 20 km saturation is no limit, but there is no more than water.
    expect(ppmv >= 0 && ppmv <= 1e6, Quantity::kHumidity, "expected a humidity from 0 to 1e6 ppmv");
    expect(height_m > 20e3 || ppmv <= 1.01 * saturated_ppmv, Quantity::kHumidity,
           "more water vapour than saturates the air");
    if (errors_.size() > errors_before) return;
    AirLevel level = air_at(base_, height_m);
    level.height_m = height_m;
    level.pressure_pa = pressure_pa;
    level.temperature_k = temperature_k;
    level.gas.h2o_ppmv = ppmv;
    profile_.level.push_back(level);
  }

  AirProfile join_base() {
    if (profile_.level.front().height_m > place_m_) {
      AirLevel surface = profile_.level.front();
      surface.pressure_pa *= std::exp(9.80665 * 28.9647e-3 * (surface.height_m - place_m_) /
                                      (8.31446261815324 * surface.temperature_k));
      surface.height_m = place_m_;
      profile_.level.insert(profile_.level.begin(), surface);
    }
    const AirLevel top = profile_.level.back();
    const double ratio = top.pressure_pa / air_at(base_, top.height_m).pressure_pa;
    for (AirLevel level : base_.level) {
      level.pressure_pa *= ratio;
      // At least 1 km over which the two profiles merge.
      if (level.height_m >= top.height_m + 1000) profile_.level.push_back(level);
    }
    return std::move(profile_);
  }

  std::string_view text_, file_;
  const AirProfile& base_;
  double place_m_;
  std::vector<LevelColumn> header_;
  std::vector<Problem> errors_;
  AirProfile profile_;
};

}  // namespace

absl::StatusOr<AirProfile> parse_profile_csv(std::string_view text, std::string_view file,
                                             const AirProfile& base, double place_m) {
  return ProfileReader(text, file, base, place_m).read();
}

}  // namespace irsig
