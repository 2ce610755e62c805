#include "core/atmosphere/imported/tape7_cards.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/base/constants.h"
#include "core/geo/sun.h"

namespace irsig {
namespace {

double radians(double degrees) { return degrees * kRadPerDeg; }

// The cards in front of a table, those that say which line of sight it is.
class Cards {
 public:
  Cards(std::vector<std::string_view> lines, std::size_t first_line, FileErrors& errors)
      : lines_(std::move(lines)), first_line_(first_line), errors_(errors) {}

  std::optional<Tape7Cards> read() {
    ImportedPath path = unstated_path();
    path.line = first_line_;
    // Card 4 (limits of the spectrum) is the last, or the last but one.
    std::size_t card4 = lines_.size();
    for (std::size_t back = 1; back <= 2 && back <= lines_.size(); ++back) {
      if (card4 == lines_.size() && is_card4(lines_.size() - back)) card4 = lines_.size() - back;
    }
    if (card4 == lines_.size() || card4 < 4) {
      errors_.add(first_line_ + lines_.size(), 1,
                  "the cards of the run are not echoed before its table: nothing says which line "
                  "of sight it is");
      return std::nullopt;
    }
    card4_ = card4;
    const int type = whole(0, 6, 5);
    emission_ = whole(0, 11, 5);
    const double boundary_k = number(0, 66, 8);
    if (boundary_k > 0) path.ground_temperature_k = boundary_k;
    if (emission_ < 0 || emission_ > 3) {
      error(0, 11, absl::StrFormat("IEMSCT %d: expected 0 to 3", emission_));
    } else if (emission_ == 3) {
      towards_the_sun(path);
    } else if (type == 1) {
      level(path);
    } else if (type == 2) {
      between_heights(path);
    } else if (type == 3) {
      to_space(path);
    } else {
      error(0, 6, absl::StrFormat("ITYPE %d: expected 1, 2 or 3", type));
    }
    if (emission_ != 3) sun(path);
    if (failed_) return std::nullopt;
    return Tape7Cards{path, axis_flag()};
  }

 private:
  // The unit that card 4 asks for where the table's label does not say it.
  [[nodiscard]] char axis_flag() const {
    const std::string_view line = lines_[card4_];
    return line.size() > 50 ? line[50] : ' ';
  }

  void error(std::size_t card, std::size_t column, std::string_view what) {
    errors_.add(first_line_ + card, column, what);
    failed_ = true;
  }

  [[nodiscard]] std::string_view field(std::size_t card, std::size_t column,
                                       std::size_t width) const {
    const std::string_view line = lines_[card];
    if (column > line.size()) return "";
    return trimmed(line.substr(column - 1, width));
  }

  // A blank field is 0, as Fortran reads it.
  double number(std::size_t card, std::size_t column, std::size_t width) {
    const std::string_view text = field(card, column, width);
    double value = 0;
    if (!text.empty() && !parse_fortran_number(text, value)) {
      error(card, column, absl::StrFormat("\"%s\" is not a number", text));
    }
    return value;
  }

  int whole(std::size_t card, std::size_t column, std::size_t width) {
    const double value = number(card, column, width);
    if (value >= -99999 && value <= 99999) return static_cast<int>(value);
    error(card, column, "expected a whole number");
    return 0;
  }

  [[nodiscard]] bool is_card4(std::size_t card) const {
    double first = 0, last = 0, step = 0;
    return parse_fortran_number(field(card, 1, 10), first) &&
           parse_fortran_number(field(card, 11, 10), last) &&
           parse_fortran_number(field(card, 21, 10), step) && first > 0 && last > first && step > 0;
  }

  [[nodiscard]] std::size_t card3() const { return card4_ - 3; }
  double card3_number(std::size_t index) { return number(card3(), 1 + 10 * index, 10); }

  double earth_radius_m() {
    const double given_km = card3_number(5);
    return given_km > 0 ? 1e3 * given_km : kDefaultEarthRadiusM;
  }

  void level(ImportedPath& path) {
    // The other code gives a path of this kind its first height all along, whatever ANGLE says.
    path.observer_height_m = path.target_height_m = 1e3 * card3_number(0);
    path.range_m = 1e3 * card3_number(3);
    path.zenith_deg = 90;
    if (!(path.range_m > 0)) error(card3(), 31, "RANGE of a horizontal path: expected more than 0");
  }

  // The code takes three of H1, H2, ANGLE, RANGE and BETA, in this order of precedence; the rest
  // follows along the straight line.
  void between_heights(ImportedPath& path) {
    const double r1 = earth_radius_m() + 1e3 * card3_number(0);
    double r2 = earth_radius_m() + 1e3 * card3_number(1);
    double angle_deg = card3_number(2), range_m = 1e3 * card3_number(3);
    const double beta_deg = card3_number(4);
    if (range_m > 0 && angle_deg > 0) {
      r2 = std::sqrt(r1 * r1 + range_m * range_m + 2 * r1 * range_m * std::cos(radians(angle_deg)));
    } else if (range_m > 0 || beta_deg > 0) {
      if (!(range_m > 0)) {
        range_m = std::sqrt(
            std::max(0.0, (r1 - r2) * (r1 - r2) + 2 * r1 * r2 * (1 - std::cos(radians(beta_deg)))));
      }
      const double cosine = (r2 * r2 - r1 * r1 - range_m * range_m) / (2 * r1 * range_m);
      if (!(std::abs(cosine) <= 1 + 1e-9)) {
        return error(card3(), 31, "RANGE is less than the difference of the heights");
      }
      angle_deg = std::acos(std::clamp(cosine, -1.0, 1.0)) / kRadPerDeg;
    } else {
      const bool beyond_the_tangent = number(card3(), 61, 5) > 0;
      const double along = -r1 * std::cos(radians(angle_deg)),
                   across = r1 * std::sin(radians(angle_deg));
      if (across > r2) {
        return error(card3(), 21, "a ray of this ANGLE from H1 does not reach H2");
      }
      const double half = std::sqrt(r2 * r2 - across * across);
      const bool near = angle_deg > 90 && r2 < r1 && !beyond_the_tangent;
      range_m = along + (near ? -half : half);
    }
    path.observer_height_m = r1 - earth_radius_m();
    path.target_height_m = r2 - earth_radius_m();
    path.range_m = range_m;
    path.zenith_deg = angle_deg;
    if (!(range_m > 0)) error(card3(), 31, "the path has no length");
  }

  void to_space(ImportedPath& path) {
    const double earth_m = earth_radius_m(), ground_m = earth_m + 1e3 * number(1, 71, 10);
    const double r1 = earth_m + 1e3 * card3_number(0), tangent_km = card3_number(1);
    double angle_deg = card3_number(2);
    if (angle_deg == 0 && tangent_km > 0 && earth_m + 1e3 * tangent_km < r1) {
      angle_deg = 180 - std::asin((earth_m + 1e3 * tangent_km) / r1) / kRadPerDeg;
    }
    path.observer_height_m = r1 - earth_m;
    path.zenith_deg = angle_deg;
    const double across = r1 * std::sin(radians(angle_deg));
    if (angle_deg > 90 && across < ground_m) {
      path.target_height_m = ground_m - earth_m;
      path.range_m =
          -r1 * std::cos(radians(angle_deg)) - std::sqrt(ground_m * ground_m - across * across);
    } else {
      path.target_height_m = path.range_m = std::numeric_limits<double>::infinity();
    }
  }

  // IEMSCT 3 has a card 3 of its own: H1, H2, ANGLE, IDAY.
  void towards_the_sun(ImportedPath& path) {
    path.observer_height_m = 1e3 * card3_number(0);
    path.target_height_m = path.range_m = std::numeric_limits<double>::infinity();
    path.zenith_deg = path.sun_zenith_deg = card3_number(2);
    day(path, number(card3(), 31, 5));
  }

  static void day(ImportedPath& path, double given) {
    if (given >= 1 && given <= 366) path.day_of_year = static_cast<int>(given);
  }

  // Cards 3A1 and 3A2; -99 stands where the run had none. Longitudes are west of Greenwich.
  void sun(ImportedPath& path) {
    const std::size_t card = card4_ - 2;
    const int kind = whole(card, 1, 5);
    if (kind < 0) return;
    day(path, number(card, 11, 5));
    const double first = number(card + 1, 1, 10), second = number(card + 1, 11, 10);
    const int geometry = kind % 10;  // 10 and more: the same, at H2
    if (geometry == 2) {
      path.sun_zenith_deg = second;
      return;
    }
    path.latitude_deg = first;
    path.longitude_deg = std::remainder(-second, 360.0);
    const double below_latitude_deg = number(card + 1, 21, 10),
                 below_west_deg = number(card + 1, 31, 10);
    if (below_latitude_deg != 0 || below_west_deg != 0) {  // the point that has the sun overhead
      const double a = radians(first), b = radians(below_latitude_deg),
                   turn = radians(second - below_west_deg);
      path.sun_zenith_deg =
          std::acos(std::clamp(
              std::sin(a) * std::sin(b) + std::cos(a) * std::cos(b) * std::cos(turn), -1.0, 1.0)) /
          kRadPerDeg;
    } else if (path.day_of_year > 0) {
      sun_from_time(path, number(card + 1, 41, 10));
    }
  }

  // The file has no year; between years the sun's place at a day and hour varies by 0.2 deg.
  static void sun_from_time(ImportedPath& path, double hour) {
    if (!(hour >= 0 && hour < 24)) return;
    static constexpr std::array kDays = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    int day = path.day_of_year, month = 1;
    for (const int length : kDays) {
      if (day <= length || month == 12) break;
      day -= length;
      ++month;
    }
    const double minute = 60 * (hour - std::floor(hour));
    const UtcTime time{2001,
                       month,
                       std::min(day, 31),
                       static_cast<int>(hour),
                       static_cast<int>(minute),
                       60 * (minute - std::floor(minute))};
    const auto position = sun_position(time, path.latitude_deg, path.longitude_deg, 0);
    if (position.ok()) path.sun_zenith_deg = position->zenith_deg;
  }

  static constexpr double kDefaultEarthRadiusM = 6371.23e3;

  std::vector<std::string_view> lines_;
  std::size_t first_line_;  // of the file
  FileErrors& errors_;
  std::size_t card4_ = 0;
  int emission_ = 0;
  bool failed_ = false;
};

}  // namespace

std::optional<Tape7Cards> read_tape7_cards(std::vector<std::string_view> lines,
                                           std::size_t first_line, FileErrors& errors) {
  return Cards(std::move(lines), first_line, errors).read();
}

}  // namespace irsig
