#include "messages/environment/sweep_environment.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/gas/gas_spectrum.h"
#include "core/geo/sun.h"

namespace irsig {

SweepWeathers weathers_of(const schema::ResolvedSweep& sweep) {
  SweepWeathers out;
  std::map<std::string, std::uint32_t> known;
  for (const schema::Condition& c : sweep.condition()) {
    schema::Condition weather;
    *weather.mutable_weather() = c.weather();
    *weather.mutable_surroundings() = c.surroundings();
    const auto [at, is_new] = known.try_emplace(weather.SerializeAsString(), out.count);
    if (is_new) ++out.count;
    out.of_condition.push_back(at->second);
  }
  return out;
}

absl::StatusOr<std::unique_ptr<const Environment>> environment_of(
    const schema::ResolvedSweep& resolved, std::span<const double> node_um) {
  const schema::Sweep& sweep = resolved.sweep();
  const SweepWeathers of = weathers_of(resolved);
  std::vector<WeatherSpec> weathers;
  std::vector<ConditionEnvironment> conditions;
  for (const schema::Condition& c : resolved.condition()) {
    if (!c.has_weather()) {
      return absl::InvalidArgumentError("a condition has no weather: the sweep is not resolved");
    }
    const std::uint32_t number = of.of_condition[conditions.size()];
    if (number == weathers.size()) {
      auto weather = weather_from_message(c.weather(), c.surroundings());
      if (!weather.ok())
        return at_key(absl::StrCat("season[", c.season_index(), "]"), weather.status());
      weathers.push_back(*std::move(weather));
    }
    ConditionEnvironment& condition = conditions.emplace_back();
    condition.weather = number;
    if (!sweep.transport().sun()) continue;
    ASSIGN_OR_RETURN(const auto time, parse_rfc3339(c.time_utc()));
    const schema::Place& place = sweep.place();
    ASSIGN_OR_RETURN(const auto sun,
                     sun_position(time, place.latitude_deg(), place.longitude_deg(),
                                  place.height_m() + c.weather().above_surface_m()));
    condition.sun = true;
    condition.sun_direction = body_from_enu(sun.direction, place.heading_deg());
    condition.sun_distance_au = sun.distance_au;
  }
  return Environment::make(std::move(weathers), std::move(conditions), target_height_m(resolved),
                           {node_um.begin(), node_um.end()});
}

std::vector<double> spectral_breaks_um(const schema::ResolvedSweep& sweep) {
  std::vector<double> breaks_um;
  // The air's bands are bands of hot gas, too.
  if (!has_atmosphere(sweep) && !sweep.sweep().has_plume()) return breaks_um;
  for (const schema::Band& band : sweep.sweep().band()) {
    const double from_um = band.lambda_min_um() - band.step_um(),
                 to_um = band.lambda_max_um() + band.step_um();
    const auto edges = has_atmosphere(sweep) ? air_band_edges_um(from_um, to_um)
                                             : gas_band_edges_um(from_um, to_um);
    breaks_um.insert(breaks_um.end(), edges.begin(), edges.end());
  }
  std::sort(breaks_um.begin(), breaks_um.end());
  breaks_um.erase(std::unique(breaks_um.begin(), breaks_um.end()), breaks_um.end());
  return breaks_um;
}

}  // namespace irsig
