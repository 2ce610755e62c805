#include "core/atmosphere/imported/imported_path.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/atmosphere/imported/imported_samples.h"

namespace irsig {
namespace {

constexpr double kUnstated = std::numeric_limits<double>::quiet_NaN();

// Mean over each band of the straight lines between samples; NaN where they do not reach from one
// end of the band to the other.
AirSpectrum band_means(const std::vector<double>& wavenumber_cm1,
                       const std::vector<double>& value) {
  AirSpectrum mean(kAirBandCount, kUnstated);
  const std::size_t n = wavenumber_cm1.size();
  for (std::size_t band = 0; band < kAirBandCount; ++band) {
    const double low = air_band_centre_cm1(band) - 0.5 * kAirBandWidthCm1,
                 high = low + kAirBandWidthCm1;
    if (n < 2 || wavenumber_cm1.front() > low || wavenumber_cm1.back() < high) continue;
    auto i = static_cast<std::size_t>(
        std::upper_bound(wavenumber_cm1.begin(), wavenumber_cm1.end(), low) -
        wavenumber_cm1.begin());
    double integral = 0;
    for (; i < n && wavenumber_cm1[i - 1] < high; ++i) {
      const double x0 = wavenumber_cm1[i - 1], x1 = wavenumber_cm1[i];
      const double from = std::max(x0, low), to = std::min(x1, high);
      const double middle = (0.5 * (from + to) - x0) / (x1 - x0);
      integral += (to - from) * ((1 - middle) * value[i - 1] + middle * value[i]);
    }
    mean[band] = integral / kAirBandWidthCm1;
  }
  return mean;
}

ImportedPath with_spectra(SampledRun run) {
  if (run.wavenumber_cm1.size() > 1 && run.wavenumber_cm1[0] > run.wavenumber_cm1[1]) {
    for (auto* samples :
         {&run.wavenumber_cm1, &run.transmittance, &run.radiance_w_m2_sr_um, &run.sun_w_m2_um}) {
      std::reverse(samples->begin(), samples->end());
    }
  }
  ImportedPath path = std::move(run.path);
  path.transmittance = band_means(run.wavenumber_cm1, run.transmittance);
  if (!run.radiance_w_m2_sr_um.empty()) {
    path.radiance_w_m2_sr_um = band_means(run.wavenumber_cm1, run.radiance_w_m2_sr_um);
  }
  if (!run.sun_w_m2_um.empty()) {
    path.sun_w_m2_um = band_means(run.wavenumber_cm1, run.sun_w_m2_um);
  }
  return path;
}

bool reaches_a_band(const ImportedPath& path) {
  return std::any_of(path.transmittance.begin(), path.transmittance.end(),
                     [](double t) { return !std::isnan(t); });
}

std::string describe(const ImportedPath& path) {
  if (std::isinf(path.range_m))
    return absl::StrFormat("%g m to space (line %d)", path.observer_height_m, path.line);
  return absl::StrFormat("%g m to %g m over %g m (line %d)", path.observer_height_m,
                         path.target_height_m, path.range_m, path.line);
}

// Within 2 % or 1 m; a path to space has infinite range and height.
bool same_length(double a, double b) {
  if (std::isinf(a) || std::isinf(b)) return a == b;
  return std::abs(a - b) <= std::max(1.0, 0.02 * std::max(std::abs(a), std::abs(b)));
}

// A level path stands for lines whose ends are a little higher or lower: water vapour, which
// changes fastest, loses 1.5 % of its density in kLevelHeightM.
bool stands_for(const ImportedPath& path, double observer_height_m, double target_height_m) {
  const double level_m = path.observer_height_m;
  return path.target_height_m == level_m &&
         std::abs(observer_height_m - level_m) <= kLevelHeightM &&
         std::abs(target_height_m - level_m) <= kLevelHeightM;
}

// One quantity that a path and the condition may both state.
struct Claim {
  const char* name;
  const char* unit;
  double imported, condition, tolerance;
  double period;  // 0: not periodic

  [[nodiscard]] bool contradicts() const {
    if (std::isnan(imported) || std::isnan(condition)) return false;
    const double difference =
        period > 0 ? std::remainder(imported - condition, period) : imported - condition;
    return std::abs(difference) > tolerance;
  }
};

double day_or_nan(int day_of_year) {
  return day_of_year == 0 ? kUnstated : static_cast<double>(day_of_year);
}

}  // namespace

// ---- imported_samples.h

ImportedPath unstated_path() {
  ImportedPath path{};
  path.observer_height_m = path.target_height_m = path.range_m = path.zenith_deg = kUnstated;
  path.sun_zenith_deg = path.latitude_deg = path.longitude_deg = kUnstated;
  path.ground_temperature_k = kUnstated;
  return path;
}

bool parse_fortran_number(std::string_view text, double& value) {
  if (text.starts_with('+')) text.remove_prefix(1);
  std::string plain;
  for (const char c : text) {
    const bool sign = c == '+' || c == '-';
    // Fortran drops the E of an exponent with three digits.
    if (sign && !plain.empty() && plain.back() != 'E') plain.push_back('E');
    plain.push_back(c == 'D' || c == 'd' || c == 'e' ? 'E' : c);
  }
  const char* end = plain.data() + plain.size();
  const auto [stop, code] = std::from_chars(plain.data(), end, value);
  if (code == std::errc::result_out_of_range && stop == end) {  // less than the smallest double
    value = 0;
    return plain.find("E-") != std::string::npos;
  }
  // Single precision is what the codes print; what is larger overflows when its unit is changed.
  return code == std::errc() && stop == end && std::abs(value) < 1e38;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string_view> split_lines(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    lines.push_back(line);
  }
  return lines;
}

std::string extend_axis(std::vector<double>& wavenumber_cm1, double next) {
  std::string wrong;
  if (!(next > 0 && std::isfinite(next))) {
    wrong = absl::StrFormat("%g cm-1: expected more than 0", next);
  } else if (!wavenumber_cm1.empty()) {
    const double last = wavenumber_cm1.back(), step = next - last;
    const double trend =
        wavenumber_cm1.size() > 1 ? last - wavenumber_cm1[wavenumber_cm1.size() - 2] : step;
    // Rows outside the air's bands are not used, and may be as coarse as they like.
    const bool used = std::max(last, next) > kAirFirstCm1 && std::min(last, next) < kAirLastCm1;
    if (!(step * trend > 0)) {
      wrong = absl::StrFormat("%g after %g cm-1: expected an axis that goes one way", next, last);
    } else if (used && std::abs(step) > 2 * kAirBandWidthCm1) {
      wrong = absl::StrFormat("%g after %g cm-1: a gap of more than %g cm-1", next, last,
                              2 * kAirBandWidthCm1);
    }
  }
  if (!wrong.empty()) wavenumber_cm1.clear();
  wavenumber_cm1.push_back(next);
  return wrong;
}

// ---- imported_path.h

absl::StatusOr<ImportedPaths> parse_imported_paths(std::string_view text, std::string_view file) {
  FileErrors errors(file);
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
    errors.add(1, 1, "this is text in UTF-16, expected UTF-8: save it as UTF-8");
    return errors.status();
  }
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  std::string_view first;
  for (const std::string_view line : split_lines(text)) {
    if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
    first = line;
    break;
  }
  if (first.empty()) {
    errors.add(1, 1, "the file is empty");
    return errors.status();
  }
  const bool csv = first.front() == '#' || first.find(',') != std::string_view::npos;
  std::vector<SampledRun> runs = csv ? read_path_csv(text, errors) : read_tape7(text, errors);
  ImportedPaths paths{std::string(file), {}};
  for (SampledRun& run : runs) {
    if (errors.any()) break;  // columns may differ in length
    paths.path.push_back(with_spectra(std::move(run)));
    if (!reaches_a_band(paths.path.back())) {
      errors.add(paths.path.back().line, 1,
                 absl::StrFormat("covers none of the air's bands of %g cm-1 between %g and %g cm-1",
                                 kAirBandWidthCm1, kAirFirstCm1, kAirLastCm1));
    }
  }
  if (errors.any()) return errors.status();
  return paths;
}

absl::Status check_conditions(const ImportedPaths& paths, const ConditionFacts& facts) {
  std::vector<std::string> wrong;
  for (const ImportedPath& path : paths.path) {
    const Claim claims[] = {
        {"sun zenith", "deg", path.sun_zenith_deg, facts.sun_zenith_deg, 0.5, 0},
        {"latitude", "deg", path.latitude_deg, facts.latitude_deg, 0.1, 0},
        {"longitude", "deg", path.longitude_deg, facts.longitude_deg, 0.1, 360},
        {"ground temperature", "K", path.ground_temperature_k, facts.ground_temperature_k, 1, 0},
        {"day of the year", "", day_or_nan(path.day_of_year), day_or_nan(facts.day_of_year), 3,
         365.25}};
    for (const Claim& c : claims) {
      if (!c.contradicts()) continue;
      wrong.push_back(absl::StrFormat(
          "%s:%d:1: %s %.6g%s%s, but the sweep has %.6g (may differ by %g)", paths.file, path.line,
          c.name, c.imported, *c.unit == '\0' ? "" : " ", c.unit, c.condition, c.tolerance));
    }
  }
  if (wrong.empty()) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrJoin(wrong, "\n"));
}

absl::StatusOr<const ImportedPath*> find_path(const ImportedPaths& paths, double observer_height_m,
                                              double target_height_m, double range_m) {
  for (const ImportedPath& path : paths.path) {
    if (same_length(path.observer_height_m, observer_height_m) &&
        same_length(path.target_height_m, target_height_m) && same_length(path.range_m, range_m)) {
      return &path;
    }
  }
  for (const ImportedPath& path : paths.path) {
    if (stands_for(path, observer_height_m, target_height_m) && same_length(path.range_m, range_m))
      return &path;
  }
  std::vector<std::string> covered;
  for (const ImportedPath& path : paths.path) covered.push_back(describe(path));
  return absl::NotFoundError(
      absl::StrFormat("%s: no line of sight from %g m to %g m over %g m; it covers %s", paths.file,
                      observer_height_m, target_height_m, range_m, absl::StrJoin(covered, ", ")));
}

}  // namespace irsig
