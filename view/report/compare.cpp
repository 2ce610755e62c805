#include "view/report/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "core/accuracy/measured.h"
#include "core/base/status_macros.h"
#include "view/base/table.h"

namespace irsig {
namespace {

constexpr double kSameDeg = 1e-6;

AspectKey aspect_key(const StoredValue& v) {
  // All azimuths of the zenith are one direction.
  const double azimuth_deg =
      std::abs(v.aspect_elevation_deg) == 90 ? 0 : std::fmod(v.aspect_azimuth_deg + 360, 360);
  const auto turn = static_cast<std::int64_t>(std::llround(360 / kSameDeg));
  return {std::llround(azimuth_deg / kSameDeg) % turn,
          std::llround(v.aspect_elevation_deg / kSameDeg)};
}

Measured measured_value(const StoredValue& v) {
  return with_rest({v.value, v.value_stderr, {}, 0}, v.numerical_error, BoundOf::kUnseen);
}

ComparedAspect compared(const StoredValue& a, const StoredValue& b) {
  const Measured d =
      difference(measured_value(b), measured_value(a), std::hypot(a.value_stderr, b.value_stderr));
  const double error = d.numerical_error();
  const double sigmas = error > 0 ? d.value / error
                        : d.value == 0
                            ? 0
                            : std::copysign(std::numeric_limits<double>::infinity(), d.value);
  return {a.aspect_azimuth_deg, a.aspect_elevation_deg, a, b, d.value, error, sigmas};
}

}  // namespace

std::vector<AspectKey> aspect_keys(std::span<const StoredValue> values) {
  std::vector<AspectKey> out;
  for (const StoredValue& v : values) out.push_back(aspect_key(v));
  std::sort(out.begin(), out.end());
  return out;
}

Comparison compare(std::span<const StoredValue> a, std::span<const StoredValue> b) {
  std::map<AspectKey, const StoredValue*> of_b;
  for (const StoredValue& v : b)
    if (!std::isnan(v.value)) of_b.emplace(aspect_key(v), &v);
  Comparison out;
  std::size_t met = 0;
  for (const StoredValue& v : a) {
    if (std::isnan(v.value)) continue;
    const auto other = of_b.find(aspect_key(v));
    if (other == of_b.end()) {
      ++out.only_in_a;
      continue;
    }
    if (other->second == nullptr) continue;  // a second viewpoint of the same direction
    out.value.push_back(compared(v, *other->second));
    other->second = nullptr;
    ++met;
  }
  out.only_in_b = of_b.size() - met;
  return out;
}

absl::Status write_comparison(const Comparison& comparison, const QuantityColumns& quantity,
                              std::string_view format, std::ostream& out) {
  const std::string value = quantity.value_name, error = quantity.error_name;
  auto writer = make_table_writer(format,
                                  {{"aspect_azimuth_deg"},
                                   {"aspect_elevation_deg"},
                                   {"a_row"},
                                   {"a_" + value},
                                   {"a_" + error},
                                   {"b_row"},
                                   {"b_" + value},
                                   {"b_" + error},
                                   {"difference_" + value},
                                   {"difference_" + error},
                                   {"difference_sigmas"}},
                                  out);
  if (!writer.ok()) return writer.status();
  for (const ComparedAspect& v : comparison.value)
    (*writer)->row({v.aspect_azimuth_deg, v.aspect_elevation_deg, v.a.row, v.a.value,
                    v.a.numerical_error, v.b.row, v.b.value, v.b.numerical_error, v.difference,
                    v.difference_error, v.sigmas});
  return (*writer)->finish();
}

absl::Status check_same_band(const schema::Band& a, const schema::Band& b) {
  const bool same =
      a.lambda_min_um() == b.lambda_min_um() && a.lambda_max_um() == b.lambda_max_um() &&
      std::equal(a.response().begin(), a.response().end(), b.response().begin(), b.response().end(),
                 [](const schema::SpectralPoint& p, const schema::SpectralPoint& q) {
                   return p.lambda_um() == q.lambda_um() && p.value() == q.value();
                 });
  if (same) return absl::OkStatus();
  return absl::FailedPreconditionError(fmt::format(
      "{} ({:g} to {:g} um) and {} ({:g} to {:g} um) are bands of different limits or responses, "
      "whose values are no difference of one quantity: choose the same band for both",
      a.name(), a.lambda_min_um(), a.lambda_max_um(), b.name(), b.lambda_min_um(),
      b.lambda_max_um()));
}

namespace {

using RowKey = std::tuple<std::string, std::string, std::string, AspectKey, std::int64_t>;

StoredValue value_of_row(const StoredSignature& s, const QuantityColumns& columns) {
  return {s.row,
          s.aspect_azimuth_deg,
          s.aspect_elevation_deg,
          s.*columns.value,
          s.*columns.value_stderr,
          s.*columns.numerical_error};
}

RowKey row_key(const StoredSignature& s, const FreeNames& free) {
  constexpr std::size_t kDate = 11;  // "2025-12-21T"
  std::string time = free.time ? "" : s.time_utc;
  if (free.season && time.size() > kDate) time.erase(0, kDate);
  return {free.season ? "" : s.season, std::move(time), free.band ? "" : s.band,
          aspect_key({0, s.aspect_azimuth_deg, s.aspect_elevation_deg, 0, 0, 0}),
          std::llround(1e3 * s.range_m)};
}

absl::StatusOr<std::map<RowKey, const StoredSignature*>> rows_by_key(
    const std::vector<QueryRow>& rows, const FreeNames& free, const char* side) {
  std::map<RowKey, const StoredSignature*> out;
  for (const QueryRow& row : rows) {
    const auto [at, added] = out.emplace(row_key(row.signature, free), &row.signature);
    if (!added)
      return absl::InvalidArgumentError(fmt::format(
          "rows {} and {} of {} would have the same partner: choose one of them with --sweep, "
          "--season, --time or --band (of B: --b-sweep, --b-season, --b-time or --b-band)",
          at->second->row, row.signature.row, side));
  }
  return out;
}

}  // namespace

absl::StatusOr<RowComparison> compare_rows(const std::vector<QueryRow>& a,
                                           const std::vector<QueryRow>& b, const FreeNames& free,
                                           SignatureQuantity quantity) {
  const QuantityColumns& columns = columns_of(quantity);
  for (const auto* side : {&a, &b}) {
    std::vector<StoredSignature> signatures;
    for (const QueryRow& row : *side) signatures.push_back(row.signature);
    RETURN_IF_ERROR(check_computed(signatures, quantity));
  }
  ASSIGN_OR_RETURN(const auto of_a, rows_by_key(a, free, "A"));
  ASSIGN_OR_RETURN(const auto of_b, rows_by_key(b, free, "B"));
  RowComparison out;
  for (const QueryRow& row : a) {
    const auto other = of_b.find(row_key(row.signature, free));
    if (other == of_b.end())
      ++out.only_in_a;
    else
      out.row.push_back(
          {row.signature, *other->second,
           compared(value_of_row(row.signature, columns), value_of_row(*other->second, columns))});
  }
  out.only_in_b = of_b.size() - out.row.size();
  if (out.row.empty())
    return absl::NotFoundError(
        "no row of A has a partner in B: they have no season, time, band, aspect and range in "
        "common (--b-season, --b-time and --b-band compare rows that differ in these)");
  return out;
}

absl::Status write_compared_rows(const RowComparison& comparison, const QuantityColumns& quantity,
                                 std::string_view format, std::ostream& out) {
  const std::string value = quantity.value_name, error = quantity.error_name;
  ASSIGN_OR_RETURN(const auto writer, make_table_writer(format,
                                                        {{"a_season"},
                                                         {"a_time_utc"},
                                                         {"a_band"},
                                                         {"b_season", false},
                                                         {"b_time_utc", false},
                                                         {"b_band", false},
                                                         {"aspect_azimuth_deg"},
                                                         {"aspect_elevation_deg"},
                                                         {"range_m"},
                                                         {"a_row", false},
                                                         {"a_" + value},
                                                         {"a_" + error},
                                                         {"b_row", false},
                                                         {"b_" + value},
                                                         {"b_" + error},
                                                         {"ratio"},
                                                         {"difference_" + value},
                                                         {"difference_" + error},
                                                         {"difference_sigmas", false},
                                                         {"exceeds_error"}},
                                                        out));
  for (const ComparedRow& row : comparison.row) {
    const ComparedAspect& v = row.value;
    const Cell ratio = v.a.value == 0 ? Cell() : Cell(v.b.value / v.a.value);
    writer->row({row.a.season,
                 row.a.time_utc,
                 row.a.band,
                 row.b.season,
                 row.b.time_utc,
                 row.b.band,
                 v.aspect_azimuth_deg,
                 v.aspect_elevation_deg,
                 row.a.range_m,
                 v.a.row,
                 v.a.value,
                 v.a.numerical_error,
                 v.b.row,
                 v.b.value,
                 v.b.numerical_error,
                 ratio,
                 v.difference,
                 v.difference_error,
                 v.sigmas,
                 std::abs(v.difference) > v.difference_error});
  }
  return writer->finish();
}

}  // namespace irsig
