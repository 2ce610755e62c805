#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/atmosphere/imported/imported_samples.h"

namespace irsig {
namespace {

enum class Column { kLambda, kWavenumber, kTransmittance, kRadiance, kRadiancePerCm1, kSun };

struct NamedColumn {
  std::string_view name;
  Column column;
  int quantity;  // two names of the same quantity exclude each other
};
constexpr NamedColumn kColumns[] = {{"lambda_um", Column::kLambda, 0},
                                    {"wavenumber_cm1", Column::kWavenumber, 0},
                                    {"transmittance", Column::kTransmittance, 1},
                                    {"radiance_w_m2_sr_um", Column::kRadiance, 2},
                                    {"radiance_w_cm2_sr_cm1", Column::kRadiancePerCm1, 2},
                                    {"sun_w_m2_um", Column::kSun, 3}};

struct Key {
  std::string_view name;
  double ImportedPath::*value;
  double min, max;
};
constexpr Key kKeys[] = {
    {"observer_height_m", &ImportedPath::observer_height_m, 0, 1e8},
    {"target_height_m", &ImportedPath::target_height_m, 0, 1e8},
    {"range_m", &ImportedPath::range_m, 0, 1e8},
    {"zenith_deg", &ImportedPath::zenith_deg, 0, 180},
    {"sun_zenith_deg", &ImportedPath::sun_zenith_deg, 0, 180},
    {"latitude_deg", &ImportedPath::latitude_deg, -90, 90},
    {"longitude_deg", &ImportedPath::longitude_deg, -180, 360},
    {"ground_temperature_k", &ImportedPath::ground_temperature_k, 100, 400},
};

struct Field {
  std::string_view text;
  std::size_t column;  // from 1
};

std::vector<Field> split_fields(std::string_view line) {
  std::vector<Field> fields;
  for (std::size_t start = 0;;) {
    const std::size_t comma = std::min(line.find(',', start), line.size());
    std::size_t first = start;
    while (first < comma && (line[first] == ' ' || line[first] == '\t')) ++first;
    fields.push_back({trimmed(line.substr(first, comma - first)), first + 1});
    if (comma == line.size()) return fields;
    start = comma + 1;
  }
}

class CsvReader {
 public:
  explicit CsvReader(FileErrors& errors) : errors_(errors) {}

  std::vector<SampledRun> read(std::string_view text) {
    for (const std::string_view line : split_lines(text)) {
      ++line_;
      if (trimmed(line).empty()) continue;
      if (line.front() == '#') {
        key(line);
      } else if (!header_.has_value()) {
        header(split_fields(line));
      } else {
        sample(split_fields(line));
      }
      if (errors_.full()) break;
    }
    finish();
    if (runs_.empty() && !errors_.any()) errors_.add(line_ + 1, 1, "no table");
    return std::move(runs_);
  }

 private:
  // "# key: value"; other comments are free. One that follows a table begins the next path.
  void key(std::string_view line) {
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) return;
    const std::string_view name = trimmed(line.substr(1, colon - 1));
    const std::string_view value = trimmed(line.substr(colon + 1));
    const bool day = name == "day_of_year";
    const Key* known = nullptr;
    for (const Key& k : kKeys) {
      if (k.name == name) known = &k;
    }
    if (known == nullptr && !day) {
      // A comment with a colon in it; a misspelt key is one word with underscores.
      if (name.find(' ') == std::string_view::npos && name.find('_') != std::string_view::npos) {
        errors_.add(line_, line.find(name) + 1, absl::StrFormat("unknown key \"%s\"", name));
      }
      return;
    }
    if (header_.has_value()) finish();
    begin();
    const std::size_t column = value.empty() ? line.size() + 1 : line.find(value, colon) + 1;
    double number = 0;
    if (value == "space" && (name == "target_height_m" || name == "range_m")) {
      run_->path.target_height_m = run_->path.range_m = std::numeric_limits<double>::infinity();
      return;
    }
    if (!parse_fortran_number(value, number)) {
      errors_.add(line_, column, absl::StrFormat("%s: \"%s\" is not a number", name, value));
      return;
    }
    const double min = day ? 1 : known->min, max = day ? 366 : known->max;
    if (!(number >= min && number <= max) || (day && number != std::floor(number))) {
      errors_.add(line_, column,
                  absl::StrFormat("%s %s: expected %s%g to %g", name, value,
                                  day ? "a whole number, " : "", min, max));
      return;
    }
    if (day) {
      run_->path.day_of_year = static_cast<int>(number);
    } else {
      run_->path.*(known->value) = number;
    }
  }

  void begin() {
    if (run_.has_value()) return;
    run_.emplace();
    run_->path = unstated_path();
    run_->path.line = line_;
  }

  void header(const std::vector<Field>& fields) {
    begin();
    header_.emplace();
    header_line_ = line_;
    bool found[4] = {};
    for (const Field& field : fields) {
      const NamedColumn* known = nullptr;
      for (const NamedColumn& c : kColumns) {
        if (c.name == field.text) known = &c;
      }
      if (known == nullptr) {
        errors_.add(line_, field.column,
                    absl::StrFormat("unknown column \"%s\", expected lambda_um or wavenumber_cm1, "
                                    "transmittance, radiance_w_m2_sr_um or radiance_w_cm2_sr_cm1, "
                                    "sun_w_m2_um",
                                    field.text));
        continue;
      }
      if (found[known->quantity]) {
        errors_.add(line_, field.column,
                    absl::StrFormat("column \"%s\" states the same quantity again", field.text));
      }
      found[known->quantity] = true;
      header_->push_back(known->column);
    }
    if (!found[0]) errors_.add(line_, 1, "no column lambda_um or wavenumber_cm1");
    if (!found[1]) errors_.add(line_, 1, "no column transmittance");
    for (const auto& [quantity, name] :
         {std::pair{run_->path.observer_height_m, "observer_height_m"},
          std::pair{run_->path.target_height_m, "target_height_m"},
          std::pair{run_->path.range_m, "range_m"}}) {
      if (std::isnan(quantity)) {
        errors_.add(line_, 1,
                    absl::StrFormat("no line \"# %s: ...\" before the table: nothing says which "
                                    "line of sight it is",
                                    name));
      }
    }
    usable_ = !errors_.any();
  }

  void sample(const std::vector<Field>& fields) {
    if (!usable_) return;
    if (fields.size() != header_->size()) {
      errors_.add(line_, 1,
                  absl::StrFormat("%d fields, expected %d as in line %d", fields.size(),
                                  header_->size(), header_line_));
      run_->wavenumber_cm1.clear();  // what follows cannot tell whether there is a gap
      return;
    }
    double wavenumber_cm1 = 0, per_cm1 = -1;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      double x = 0;
      if (!parse_fortran_number(fields[i].text, x)) {
        errors_.add(line_, fields[i].column,
                    absl::StrFormat("\"%s\" is not a number", fields[i].text));
        run_->wavenumber_cm1.clear();
        return;
      }
      const Column column = (*header_)[i];
      const double most = column == Column::kTransmittance ? 1.0001 : 1e30;
      if (!(x >= 0 && x <= most)) {
        errors_.add(
            line_, fields[i].column,
            absl::StrFormat("%s: expected %s", fields[i].text, most < 2 ? "0 to 1" : "0 or more"));
        return;
      }
      switch (column) {
        case Column::kLambda:
        case Column::kWavenumber: {
          wavenumber_cm1 = column == Column::kLambda ? 1e4 / x : x;
          const std::string wrong = extend_axis(run_->wavenumber_cm1, wavenumber_cm1);
          if (!wrong.empty()) errors_.add(line_, fields[i].column, wrong);
          break;
        }
        case Column::kTransmittance:
          run_->transmittance.push_back(std::min(x, 1.0));
          break;
        case Column::kRadiance:
          run_->radiance_w_m2_sr_um.push_back(x);
          break;
        case Column::kRadiancePerCm1:
          per_cm1 = x;
          break;
        case Column::kSun:
          run_->sun_w_m2_um.push_back(x);
          break;
      }
    }
    // W cm-2 / cm-1 -> W m-2 / um: 1e4 nu^2 / 1e4.
    if (per_cm1 >= 0) {
      run_->radiance_w_m2_sr_um.push_back(per_cm1 * wavenumber_cm1 * wavenumber_cm1);
    }
  }

  void finish() {
    if (!run_.has_value()) return;
    if (!header_.has_value()) errors_.add(line_ + 1, 1, "no table follows");
    if (!errors_.any() && run_->wavenumber_cm1.size() < 2) {
      errors_.add(line_, 1, "expected at least two wavelengths");
    }
    runs_.push_back(std::move(*run_));
    run_.reset();
    header_.reset();
    usable_ = false;
  }

  FileErrors& errors_;
  std::size_t line_ = 0, header_line_ = 0;
  bool usable_ = false;
  std::optional<std::vector<Column>> header_;
  std::optional<SampledRun> run_;
  std::vector<SampledRun> runs_;
};

}  // namespace

std::vector<SampledRun> read_path_csv(std::string_view text, FileErrors& errors) {
  return CsvReader(errors).read(text);
}

}  // namespace irsig
