#include "runner/heat_model_error.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/accuracy/quantities.h"
#include "core/base/status_macros.h"
#include "core/geo/sun.h"
#include "messages/inputs/moved_sweep.h"
#include "messages/results/read_heat_field.h"

namespace irsig {
namespace {

// Changes of one facet by one input, moved to either side; NaN: it was not moved there.
struct Sides {
  double up = NAN, down = NAN;

  // Variance of the temperature, that of a normal input (input_views.cpp).
  [[nodiscard]] double square() const {
    if (std::isnan(down)) return up * up;
    if (std::isnan(up)) return down * down;
    const double slope = 0.5 * (up - down), curvature = 0.5 * (up + down);
    return slope * slope + 2 * curvature * curvature;
  }
};

}  // namespace

absl::StatusOr<std::vector<double>> heat_model_error_k(const schema::ResolvedSweep& sweep,
                                                       const HeatOutputs& heat,
                                                       const schema::Condition& condition,
                                                       std::size_t facets) {
  std::vector<double> out;
  if (!condition.temperature_field().has_heat()) return out;
  const int run = changes_of_run(sweep, static_cast<int>(condition.temperature_field().heat()));
  if (run < 0) return out;
  const schema::HeatRun& asked = sweep.heat(run);
  if (!std::ranges::any_of(asked.input(), [](const schema::InputMove& input) {
        return is_of_heat_model(input.name());
      }))
    return out;
  ASSIGN_OR_RETURN(const auto field, read_heat_field(heat[static_cast<std::size_t>(run)], facets));
  ASSIGN_OR_RETURN(const auto time, parse_rfc3339(condition.time_utc()));
  const auto at = std::find(field.unix_s().begin(), field.unix_s().end(), unix_seconds(time));
  if (at == field.unix_s().end() || field.change_k_size() != asked.input_size())
    return absl::InvalidArgumentError(
        absl::StrCat("there are no changes of temperatures at ", condition.time_utc()));
  const auto row = static_cast<std::size_t>(at - field.unix_s().begin());
  std::map<std::string, std::vector<Sides>> change;
  std::vector<float> of_input(facets);
  for (int i = 0; i < asked.input_size(); ++i) {
    if (!is_of_heat_model(asked.input(i).name())) continue;
    std::memcpy(of_input.data(), field.change_k(i).data() + row * facets * sizeof(float),
                facets * sizeof(float));
    std::vector<Sides>& sides = change[asked.input(i).name()];
    sides.resize(facets);
    for (std::size_t f = 0; f < facets; ++f)
      (asked.input(i).move() > 0 ? sides[f].up : sides[f].down) = static_cast<double>(of_input[f]);
  }
  out.assign(facets, 0);
  for (const auto& [name, sides] : change)
    for (std::size_t f = 0; f < facets; ++f) out[f] += sides[f].square();
  for (double& kelvin : out) kelvin = std::sqrt(kelvin);
  return out;
}

}  // namespace irsig
