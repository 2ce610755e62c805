#include "runner/land_temperatures.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <map>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/hottest.h"
#include "core/base/status_macros.h"
#include "core/geo/sun.h"
#include "messages/inputs/moved_sweep.h"
#include "messages/scene/land_heat_messages.h"
#include "schema/heat_run.h"
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

int input_index(const schema::HeatRun& run, const std::string& input, double move) {
  for (int i = 0; i < run.input_size(); ++i)
    if (run.input(i).name() == input && run.input(i).move() == move) return i;
  return -1;
}

// [kind]
absl::StatusOr<std::vector<float>> change_at(const schema::HeatField& field, int input,
                                             const std::string& time_utc, std::size_t kinds) {
  ASSIGN_OR_RETURN(const auto time, parse_rfc3339(time_utc));
  const auto at = std::find(field.unix_s().begin(), field.unix_s().end(), unix_seconds(time));
  const std::size_t row_bytes = sizeof(float) * kinds;
  if (at == field.unix_s().end() || input >= field.land_change_k_size() ||
      field.land_change_k(input).size() !=
          row_bytes * static_cast<std::size_t>(field.unix_s_size()))
    return absl::InvalidArgumentError(
        absl::StrCat("there are no changes of the temperatures of land at ", time_utc,
                     " (damaged, or of another irsig: run the sweep again)"));
  std::vector<float> out(kinds);
  std::memcpy(out.data(),
              field.land_change_k(input).data() +
                  static_cast<std::size_t>(at - field.unix_s().begin()) * row_bytes,
              row_bytes);
  return out;
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

absl::StatusOr<LandTemperatures> moved_land_temperatures(const LandTemperatures& nominal,
                                                         const schema::ResolvedSweep& moved,
                                                         const HeatOutputs& heat,
                                                         const std::string& input, double move) {
  LandTemperatures out = nominal;
  if (out.kinds == nullptr) return out;
  std::map<int, schema::HeatField> field;
  for (int c = 0; c < moved.condition_size(); ++c) {
    const schema::Condition& condition = moved.condition(c);
    std::vector<double>& kelvin = out.kelvin[static_cast<std::size_t>(c)];
    for (std::size_t k = 0; k < kelvin.size(); ++k)
      if (const double stated_k =
              condition.land_temperature_k(static_cast<int>(out.kinds->kind[k].material));
          stated_k > 0)
        kelvin[k] = stated_k;
    if (!condition.has_land_heat()) continue;
    const int run = changes_of_run(moved, static_cast<int>(condition.land_heat()));
    const int which = run < 0 ? -1 : input_index(moved.heat(run), input, move);
    if (which < 0 || !changes_land(moved.heat(run))) continue;
    if (!field.contains(run) && !field[run].ParseFromString(heat[static_cast<std::size_t>(run)]))
      return absl::InvalidArgumentError("changes of temperatures of land cannot be read");
    ASSIGN_OR_RETURN(const std::vector<float> change,
                     change_at(field[run], which, condition.time_utc(), kelvin.size()));
    for (std::size_t k = 0; k < kelvin.size(); ++k)
      kelvin[k] = std::clamp(kelvin[k] + static_cast<double>(change[k]), 1.0, kHottestK);
  }
  return out;
}

}  // namespace irsig
