#include "view/report/compare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "core/accuracy/measured.h"
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

}  // namespace irsig
