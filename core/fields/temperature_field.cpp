#include "core/fields/temperature_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <nanoflann.hpp>
#include <set>
#include <utility>

#include "absl/strings/match.h"
#include "core/base/file_errors.h"
#include "core/base/status_macros.h"
#include "core/fields/field_rows.h"
#include "fmt/format.h"

namespace irsig {
namespace {

using Row = FieldRows::Row;

double kelvin_of(double value, TemperatureUnit unit) {
  switch (unit) {
    case TemperatureUnit::kKelvin:
      return value;
    case TemperatureUnit::kCelsius:
      return value + 273.15;
    case TemperatureUnit::kFahrenheit:
      return (value + 459.67) / 1.8;
  }
  return NAN;
}

bool is_plausible(double kelvin) { return kelvin >= kColdestFieldK && kelvin <= kHottestFieldK; }

// Returns the unit in which a value beyond all temperatures would be one; empty if there is none.
std::string perhaps(double value, TemperatureUnit unit) {
  for (const auto& [other, name] : {std::pair{TemperatureUnit::kKelvin, "K"},
                                    {TemperatureUnit::kCelsius, "degC"},
                                    {TemperatureUnit::kFahrenheit, "degF"}})
    if (other != unit && is_plausible(kelvin_of(value, other)))
      return fmt::format(": is it in {}?", name);
  return "";
}

// Places, for a tree of them.
struct Cloud {
  std::vector<std::array<double, 3>> at;
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return at.size(); }
  [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t axis) const { return at[i][axis]; }
  template <typename Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
};
using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3>;

class FieldReader {
 public:
  FieldReader(FieldRows rows, const FieldImport& how, const FieldMesh& mesh)
      : rows_(std::move(rows)), how_(how), mesh_(mesh), errors_(how.file_name) {}

  absl::StatusOr<TemperatureField> read() {
    check();
    if (errors_.any()) return errors_.status();
    std::map<double, std::vector<const Row*>> at_time;
    for (const Row& row : rows_.row)
      at_time[std::isnan(row.unix_s) ? 0 : row.unix_s].push_back(&row);
    TemperatureField out;
    out.at_all_times = std::isnan(rows_.row.front().unix_s);
    for (const auto& [unix_s, rows] : at_time) {
      out.unix_s.push_back(unix_s);
      out.at.push_back(how_.match == FieldMatch::kIndex ? by_index(rows) : by_place(rows));
      if (errors_.any()) return errors_.status();
    }
    return out;
  }

 private:
  [[nodiscard]] bool of_vertices() const { return rows_.of == FieldRows::Of::kVertex; }
  [[nodiscard]] std::size_t places() const {
    return of_vertices() ? mesh_.vertex.size() : mesh_.triangle.size();
  }

  void add(const Row& row, const std::string& what) {
    if (errors_.full()) return;
    if (row.line > 0)
      errors_.add(row.line, 1, what);
    else
      errors_.add(1, 1, fmt::format("value {}: {}", row.index, what));
  }

  void check() {
    if (how_.match == FieldMatch::kIndex && !rows_.has_index)
      errors_.add(1, 1, "matched by index, but there is no column facet or vertex");
    if (how_.match == FieldMatch::kCentroid && !rows_.has_place)
      errors_.add(1, 1, "matched by centroid, but there are no columns x, y, z");
    for (const Row& row : rows_.row) {
      if (errors_.full()) return;
      const double kelvin = kelvin_of(row.temperature, how_.unit);
      if (!is_plausible(kelvin))
        add(row, fmt::format("temperature = {:g} is {:g} K, expected {:g} to {:g} K{}",
                             row.temperature, kelvin, kColdestFieldK, kHottestFieldK,
                             perhaps(row.temperature, how_.unit)));
      else if (!(kelvin - error_k(row) >= 1))
        add(row, fmt::format("an error of {:g} K leaves nothing of {:g} K", error_k(row), kelvin));
      if (std::isnan(row.error) && !how_.error_k) {
        add(row,
            "no error is stated, expected a column (or property) error, or error_k of the field");
        return;
      }
    }
  }

  [[nodiscard]] double error_k(const Row& row) const {
    if (std::isnan(row.error)) return how_.error_k.value_or(NAN);
    return how_.unit == TemperatureUnit::kFahrenheit ? row.error / 1.8 : row.error;
  }

  // [place]: which row; null: none
  FacetTemperatures of_places(const std::vector<const Row*>& at) const {
    FacetTemperatures out;
    for (std::size_t f = 0; f < mesh_.triangle.size(); ++f) {
      double mean = 0, error = 0;
      if (!of_vertices()) {
        mean = at[f] == nullptr ? NAN : kelvin_of(at[f]->temperature, how_.unit);
        error = at[f] == nullptr ? NAN : error_k(*at[f]);
      } else {
        std::array<double, 3> corner{};
        for (std::size_t k = 0; k < 3; ++k) {
          const Row* row = at[mesh_.triangle[f][k]];
          corner[k] = row == nullptr ? NAN : kelvin_of(row->temperature, how_.unit);
          mean += corner[k] / 3;
          error = std::max(error, row == nullptr ? 0 : error_k(*row));
        }
        double differs = 0;
        for (const double c : corner) differs = std::max(differs, std::abs(c - mean));
        error = std::isnan(mean) ? NAN : error + differs;
      }
      out.kelvin.push_back(static_cast<float>(mean));
      out.error_k.push_back(static_cast<float>(error));
    }
    return out;
  }

  FacetTemperatures by_index(const std::vector<const Row*>& rows) {
    std::vector<const Row*> at(places(), nullptr);
    const char* what = of_vertices() ? "vertex" : "facet";
    for (const Row* row : rows) {
      if (row->index >= static_cast<std::int64_t>(at.size())) {
        add(*row,
            fmt::format("{} {}: the model has {}, counted from 0", what, row->index, at.size()));
      } else if (const Row*& here = at[static_cast<std::size_t>(row->index)]; here != nullptr) {
        add(*row, fmt::format("{} {} has two temperatures at one time", what, row->index));
      } else {
        here = row;
      }
    }
    if (errors_.any()) return {};
    return of_places(at);
  }

  FacetTemperatures by_place(const std::vector<const Row*>& rows) {
    Cloud cloud;
    std::set<std::array<double, 3>> seen;
    for (const Row* row : rows) {
      if (!seen.insert(row->place).second) add(*row, "a place has two temperatures at one time");
      cloud.at.push_back(row->place);
    }
    if (errors_.any()) return {};
    const Tree tree(3, cloud);
    std::vector<const Row*> at(places(), nullptr);
    for (std::size_t p = 0; p < at.size(); ++p) {
      const std::array<double, 3> here = of_vertices() ? mesh_.vertex[p] : mesh_.centroid(p);
      std::uint32_t nearest = 0;
      double distance2 = 0;
      tree.knnSearch(here.data(), 1, &nearest, &distance2);
      const double distance_m = std::sqrt(distance2) * mesh_.unit_m;
      // Facets of parts with a stated temperature may well have none near.
      if (distance_m <= how_.max_distance_m) at[p] = rows[nearest];
    }
    return of_places(at);
  }

  FieldRows rows_;
  const FieldImport& how_;
  const FieldMesh& mesh_;
  FileErrors errors_;
};

}  // namespace

std::array<double, 3> FieldMesh::centroid(std::size_t facet) const {
  std::array<double, 3> out{};
  for (const std::uint32_t c : triangle[facet])
    for (std::size_t axis = 0; axis < 3; ++axis) out[axis] += vertex[c][axis] / 3;
  return out;
}

absl::StatusOr<TemperatureField> read_temperature_field(std::string_view bytes,
                                                        const FieldImport& how,
                                                        const FieldMesh& mesh) {
  const bool csv = absl::EndsWithIgnoreCase(how.file_name, ".csv"),
             ply = absl::EndsWithIgnoreCase(how.file_name, ".ply");
  if (!csv && !ply)
    return absl::InvalidArgumentError(
        fmt::format("{}: temperatures are read from .csv and .ply", how.file_name));
  ASSIGN_OR_RETURN(
      auto rows, csv ? read_field_csv(bytes, how.file_name) : read_field_ply(bytes, how.file_name));
  return FieldReader(std::move(rows), how, mesh).read();
}

absl::StatusOr<FacetTemperatures> at_time(const TemperatureField& field, double unix_s) {
  if (field.at_all_times) return field.at.front();
  const auto after = std::lower_bound(field.unix_s.begin(), field.unix_s.end(), unix_s);
  if (after == field.unix_s.end() || (after == field.unix_s.begin() && *after > unix_s))
    return absl::OutOfRangeError("the field has no temperatures then");
  const auto i = static_cast<std::size_t>(after - field.unix_s.begin());
  if (*after == unix_s) return field.at[i];
  const FacetTemperatures &a = field.at[i - 1], &b = field.at[i];
  const double share = (unix_s - field.unix_s[i - 1]) / (*after - field.unix_s[i - 1]);
  FacetTemperatures out;
  for (std::size_t f = 0; f < a.kelvin.size(); ++f) {
    const auto from = static_cast<double>(a.kelvin[f]), to = static_cast<double>(b.kelvin[f]);
    out.kelvin.push_back(static_cast<float>(from + share * (to - from)));
    out.error_k.push_back(static_cast<float>(
        std::max(static_cast<double>(a.error_k[f]), static_cast<double>(b.error_k[f])) +
        share * (1 - share) * std::abs(to - from)));
  }
  return out;
}

}  // namespace irsig
