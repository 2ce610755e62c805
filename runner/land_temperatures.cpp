#include "runner/land_temperatures.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/geo/sun.h"
#include "messages/scene/land_heat_messages.h"
#include "schema/result.pb.h"

namespace irsig {
namespace {

struct RunOutput {
  std::vector<double> unix_s;
  LandHeat land;
};

absl::StatusOr<RunOutput> output_of(const schema::ResolvedSweep& sweep, const std::string& bytes) {
  schema::HeatField field;
  if (!field.ParseFromString(bytes) || !field.has_land())
    return absl::InvalidArgumentError("computed temperatures of land cannot be read");
  RunOutput out;
  out.unix_s.assign(field.unix_s().begin(), field.unix_s().end());
  ASSIGN_OR_RETURN(out.land,
                   land_heat_from_message(field.land(), sweep.sweep(), out.unix_s.size()));
  return out;
}

bool same(const LandKinds& a, const LandKinds& b) {
  return land_heat_to_message(a, {}).SerializeAsString() ==
         land_heat_to_message(b, {}).SerializeAsString();
}

absl::Status add_computed(const schema::Condition& c, const RunOutput& run, LandTemperatures& out) {
  ASSIGN_OR_RETURN(const auto time, parse_rfc3339(c.time_utc()));
  const auto at = std::find(run.unix_s.begin(), run.unix_s.end(), unix_seconds(time));
  if (at == run.unix_s.end())
    return absl::InvalidArgumentError(absl::StrCat("computed temperatures of land of season \"",
                                                   c.season(), "\": there are none at ",
                                                   c.time_utc()));
  const auto row = static_cast<std::size_t>(at - run.unix_s.begin());
  const std::vector<float>&kelvin = run.land.by_time.kelvin[row],
        &error_k = run.land.by_time.error_k[row];
  out.kelvin.emplace_back(kelvin.begin(), kelvin.end());
  out.error_k.emplace_back(error_k.begin(), error_k.end());
  return absl::OkStatus();
}

void add_stated(const schema::Condition& c, LandTemperatures& out) {
  std::vector<double>& kelvin = out.kelvin.emplace_back();
  for (const LandKind& kind : out.kinds->kind)
    kelvin.push_back(c.land_temperature_k(static_cast<int>(kind.material)));
  out.error_k.emplace_back(kelvin.size(), 0.0);
}

}  // namespace

absl::StatusOr<LandTemperatures> land_temperatures_from_sweep(const schema::ResolvedSweep& sweep,
                                                              const HeatOutputs& heat) {
  LandTemperatures out;
  if (heat.size() != static_cast<std::size_t>(sweep.heat_size())) return out;
  std::map<std::uint32_t, RunOutput> run;
  for (const schema::Condition& c : sweep.condition()) {
    if (!c.has_land_heat() || run.contains(c.land_heat())) continue;
    if (c.land_heat() >= heat.size())
      return absl::InvalidArgumentError(absl::StrCat("a condition has the land of heat run ",
                                                     c.land_heat(), " of ", heat.size()));
    ASSIGN_OR_RETURN(auto output, output_of(sweep, heat[c.land_heat()]));
    const RunOutput& of = run[c.land_heat()] = std::move(output);
    if (out.kinds == nullptr)
      out.kinds = std::make_shared<const LandKinds>(of.land.kinds);
    else if (!same(*out.kinds, of.land.kinds))
      return absl::InternalError("two heat jobs of the sweep have left different kinds of land");
  }
  if (out.kinds == nullptr) return out;
  for (const schema::Condition& c : sweep.condition()) {
    if (c.has_land_heat()) {
      RETURN_IF_ERROR(add_computed(c, run.at(c.land_heat()), out));
    } else {
      add_stated(c, out);
    }
  }
  return out;
}

}  // namespace irsig
