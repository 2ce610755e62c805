#include "view/report/heat_effects.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/effects/effects.h"
#include "core/geo/sun.h"
#include "schema/result.pb.h"

namespace irsig {
namespace {

double number_at(const std::string& little_endian, std::size_t index) {
  static_assert(std::endian::native == std::endian::little);
  float value = 0;
  std::memcpy(&value, little_endian.data() + index * sizeof(float), sizeof(float));
  return static_cast<double>(value);
}

// Returns the index of the time among computed temperatures.
absl::StatusOr<std::size_t> time_index(const schema::HeatField& field,
                                       const std::string& time_utc) {
  ASSIGN_OR_RETURN(const auto time, parse_rfc3339(time_utc));
  const auto found = std::find(field.unix_s().begin(), field.unix_s().end(), unix_seconds(time));
  if (found == field.unix_s().end())
    return absl::InvalidArgumentError(
        absl::StrCat("computed temperatures: there are none at ", time_utc));
  return static_cast<std::size_t>(found - field.unix_s().begin());
}

}  // namespace

absl::StatusOr<HeatEffects> HeatEffects::make(const StoredSweep& sweep) {
  HeatEffects out;
  if (sweep.heat.empty()) return out;
  for (const schema::Condition& c : sweep.resolved.condition()) {
    if (!c.temperature_field().has_heat()) continue;
    OfCondition& of = out.condition_.emplace_back();
    of.season = c.season();
    of.time_utc = c.time_utc();
    if (sweep.resolved.sweep().effects().without().empty()) continue;
    const std::uint32_t run = c.temperature_field().heat();
    schema::HeatField field;
    if (run >= sweep.heat.size() || !field.ParseFromString(sweep.heat[run]))
      return absl::InvalidArgumentError("computed temperatures cannot be read");
    ASSIGN_OR_RETURN(const auto time, time_index(field, c.time_utc()));
    const std::size_t facets = field.facets();
    if (field.error_k().size() < sizeof(float) * facets * (time + 1))
      return absl::InvalidArgumentError("computed temperatures: errors are missing");
    for (const schema::HeatEffect& effect : field.effect()) {
      if (effect.bound_k().size() != sizeof(float) * facets)
        return absl::InvalidArgumentError(absl::StrCat("computed temperatures: the bound of ",
                                                       effect.effect(), " is of other facets"));
      double largest_k = 0, of_error = 0;
      for (std::size_t f = 0; f < facets; ++f) {
        const double bound_k = number_at(effect.bound_k(), f),
                     error_k = number_at(field.error_k(), time * facets + f);
        if (std::isnan(bound_k)) continue;
        largest_k = std::max(largest_k, bound_k);
        if (bound_k > 0) of_error = std::max(of_error, bound_k / error_k);
      }
      of.effect.push_back({effect.effect(), effect.off(), largest_k});
      of.of_error.push_back(of_error);
    }
  }
  return out;
}

const HeatEffects::OfCondition* HeatEffects::find(const StoredSignature& row) const {
  if (row.superseded) return nullptr;
  const auto found = std::find_if(condition_.begin(), condition_.end(), [&](const OfCondition& c) {
    return c.season == row.season && c.time_utc == row.time_utc;
  });
  return found == condition_.end() ? nullptr : &*found;
}

std::vector<StoredEffect> HeatEffects::of(const StoredSignature& row) const {
  std::vector<StoredEffect> out;
  const OfCondition* condition = find(row);
  if (condition == nullptr) return out;
  for (const EffectInfo& info : heat_effect_table()) {
    StoredEffect& e = out.emplace_back();
    e.effect = std::string(info.name);
    e.state = "on";
    e.reason = "not_asked";
    e.bound_w_sr = e.apparent_bound_w_sr = e.contrast_bound_w_sr = kNotComputed;
    e.fraction_w_sr = e.time_s = kNotComputed;
    for (std::size_t i = 0; i < condition->effect.size(); ++i) {
      if (condition->effect[i].effect != info.name || !condition->effect[i].off) continue;
      const double share = condition->of_error[i];
      e.state = "off";
      e.reason = "forced";
      e.bound_w_sr = share * row.temperature_bound_w_sr;
      e.apparent_bound_w_sr = e.contrast_bound_w_sr = share * row.apparent_temperature_bound_w_sr;
    }
  }
  return out;
}

std::vector<HeatEffects::Kelvin> HeatEffects::kelvin_of(const StoredSignature& row) const {
  const OfCondition* condition = find(row);
  return condition == nullptr ? std::vector<Kelvin>{} : condition->effect;
}

}  // namespace irsig
