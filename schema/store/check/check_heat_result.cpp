#include "schema/store/check/check_heat_result.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/hottest.h"
#include "core/base/printable.h"
#include "schema/heat_run.h"
#include "schema/store/check/check_result.h"
#include "schema/store/tables/database.h"
#include "schema/store/tables/heat_time.h"
#include "schema/wire_size.h"

namespace irsig {
namespace {

constexpr auto kHottest_k = static_cast<float>(kHottestK);
// A field takes what its bytes take, and little more.
constexpr std::uint64_t kMostFieldBytes = 1 << 30;
constexpr double kSameTime_s = 1e-3;  // times are written with milliseconds at most
// A mean of float32 values may lie outside of them by its rounding.
constexpr double kRounding_k = 1e-3;

absl::Status wrong_heat(const std::string& path, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("result: heat.", path, " ", what));
}

float number_at(std::string_view little_endian, std::size_t index) {
  static_assert(std::endian::native == std::endian::little);
  float value = 0;
  std::memcpy(&value, little_endian.data() + index * sizeof(float), sizeof(float));
  return value;
}

absl::Status check_times(const schema::HeatField& field, const schema::HeatRun& run) {
  if (field.unix_s_size() != run.time_utc_size())
    return wrong_heat("field.unix_s", absl::StrCat("has ", field.unix_s_size(), " of the ",
                                                   run.time_utc_size(), " times asked for"));
  for (int i = 0; i < field.unix_s_size(); ++i) {
    const std::optional<double> asked_s = unix_s_of(run.time_utc(i));
    if (!asked_s)
      return wrong_heat("time_utc", absl::StrCat("\"", run.time_utc(i), "\" is no time"));
    if (!(std::abs(field.unix_s(i) - *asked_s) <= kSameTime_s))
      return wrong_heat(absl::StrCat("field.unix_s[", i, "]"),
                        absl::StrCat("is not the time asked for, ", run.time_utc(i)));
    if (i > 0 && !(field.unix_s(i) > field.unix_s(i - 1)))
      return wrong_heat("field.unix_s", "does not increase");
  }
  return absl::OkStatus();
}

absl::Status check_heat_numbers(const schema::HeatField& field) {
  const std::uint64_t numbers =
      std::uint64_t{field.facets()} * static_cast<std::uint64_t>(field.unix_s_size());
  for (const auto& [name, bytes] :
       {std::pair<const char*, const std::string&>{"field.kelvin", field.kelvin()},
        {"field.error_k", field.error_k()}}) {
    if (bytes.size() != sizeof(float) * numbers)
      return wrong_heat(name, absl::StrCat("has ", bytes.size(), " bytes for ", field.unix_s_size(),
                                           " times and ", field.facets(), " facets"));
  }
  for (int e = 0; e < field.effect_size(); ++e) {
    const std::string path = absl::StrCat("field.effect[", e, "].bound_k");
    const std::string& bytes = field.effect(e).bound_k();
    if (bytes.size() != sizeof(float) * field.facets())
      return wrong_heat(
          path, absl::StrCat("has ", bytes.size(), " bytes for ", field.facets(), " facets"));
    for (std::size_t f = 0; f < field.facets(); ++f) {
      const float bound_k = number_at(bytes, f);
      // Not known is allowed of what is not left out.
      if (!std::isnan(bound_k) &&
          (!(bound_k >= 0) || (field.effect(e).off() && !std::isfinite(bound_k))))
        return wrong_heat(absl::StrCat(path, "[", f, "]"), absl::StrCat("is ", bound_k));
    }
  }
  for (std::size_t i = 0; i < numbers; ++i) {
    const float kelvin = number_at(field.kelvin(), i), error_k = number_at(field.error_k(), i);
    if (std::isnan(kelvin) && std::isnan(error_k)) continue;
    if (!(kelvin > 0 && kelvin <= kHottest_k))
      return wrong_heat(absl::StrCat("field.kelvin[", i, "]"), absl::StrCat("is ", kelvin));
    if (!(error_k >= 0 && error_k <= kHottest_k))
      return wrong_heat(absl::StrCat("field.error_k[", i, "]"), absl::StrCat("is ", error_k));
  }
  return absl::OkStatus();
}

// Numbers of the land, as many as there are times: how many kinds they are of is found where they
// are read (messages/scene/land_heat_messages.h).
absl::Status check_land(const schema::HeatField& field, const schema::HeatRun& run) {
  if (field.has_land() != computes_land(run))
    return wrong_heat("field.land", field.has_land() ? "was not asked for" : "is missing");
  if (!field.has_land()) return absl::OkStatus();
  const schema::LandHeat& land = field.land();
  const std::size_t times = static_cast<std::size_t>(field.unix_s_size());
  if (land.kelvin().empty() || land.kelvin().size() % (sizeof(float) * times) != 0 ||
      land.error_k().size() != land.kelvin().size())
    return wrong_heat("field.land.kelvin",
                      absl::StrCat("and error_k have ", land.kelvin().size(), " and ",
                                   land.error_k().size(), " bytes for ", times, " times"));
  if (land.interpolation_k().size() !=
      sizeof(float) * times * static_cast<std::size_t>(run.land_temperature_k_size()))
    return wrong_heat("field.land.interpolation_k",
                      absl::StrCat("has ", land.interpolation_k().size(), " bytes for ", times,
                                   " times and ", run.land_temperature_k_size(), " materials"));
  for (std::size_t i = 0; i < land.kelvin().size() / sizeof(float); ++i) {
    const float kelvin = number_at(land.kelvin(), i), error_k = number_at(land.error_k(), i);
    if (!(kelvin > 0 && kelvin <= kHottest_k))
      return wrong_heat(absl::StrCat("field.land.kelvin[", i, "]"), absl::StrCat("is ", kelvin));
    if (!(error_k >= 0 && error_k <= kHottest_k))
      return wrong_heat(absl::StrCat("field.land.error_k[", i, "]"), absl::StrCat("is ", error_k));
  }
  return absl::OkStatus();
}

// Changes of the land's temperatures: how many kinds they are of is found where they are read.
absl::Status check_land_changes(const schema::HeatField& field, const schema::HeatRun& run) {
  const int wanted = changes_land(run) ? run.input_size() : 0;
  if (field.land_change_k_size() != wanted)
    return wrong_heat("field.land_change_k", absl::StrCat("has ", field.land_change_k_size(),
                                                          " changes for ", wanted, " inputs"));
  const std::size_t each = sizeof(float) * static_cast<std::size_t>(field.unix_s_size());
  for (int i = 0; i < field.land_change_k_size(); ++i) {
    const std::string name = absl::StrCat("field.land_change_k[", i, "]");
    const std::string& bytes = field.land_change_k(i);
    if (bytes.empty() || bytes.size() % each != 0 || bytes.size() != field.land_change_k(0).size())
      return wrong_heat(
          name, absl::StrCat("has ", bytes.size(), " bytes for ", field.unix_s_size(), " times"));
    for (std::size_t k = 0; k < bytes.size() / sizeof(float); ++k)
      if (const float kelvin = number_at(bytes, k); !std::isfinite(kelvin))
        return wrong_heat(absl::StrCat(name, "[", k, "]"), absl::StrCat("is ", kelvin));
  }
  return absl::OkStatus();
}

absl::Status check_changes(const schema::HeatField& field, const schema::HeatRun& run) {
  if (field.change_k_size() != run.input_size() || !field.kelvin().empty() ||
      !field.error_k().empty())
    return wrong_heat("field.change_k", absl::StrCat("has ", field.change_k_size(), " changes for ",
                                                     run.input_size(), " inputs, or temperatures"));
  const std::size_t numbers =
      std::size_t{field.facets()} * static_cast<std::size_t>(field.unix_s_size());
  for (int i = 0; i < field.change_k_size(); ++i) {
    const std::string name = absl::StrCat("field.change_k[", i, "]");
    if (field.change_k(i).size() != sizeof(float) * numbers)
      return wrong_heat(
          name, absl::StrCat("has ", field.change_k(i).size(), " bytes for ", field.unix_s_size(),
                             " times and ", field.facets(), " facets"));
    for (std::size_t k = 0; k < numbers; ++k)
      if (const float kelvin = number_at(field.change_k(i), k); std::isinf(kelvin))
        return wrong_heat(absl::StrCat(name, "[", k, "]"), absl::StrCat("is ", kelvin));
  }
  return check_land_changes(field, run);
}

absl::Status check_parts(const schema::HeatJobResult& result, const schema::HeatRun& run) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> missing;
  for (int part = 0; part < run.part_temperature_k_size() && run.input_size() == 0; ++part)
    for (int time = 0; time < run.time_utc_size() && run.part_temperature_k(part) == 0; ++time)
      missing.emplace(part, time);
  for (int i = 0; i < result.part_size(); ++i) {
    const schema::PartTemperature& part = result.part(i);
    const std::string path = absl::StrCat("part[", i, "]");
    if (missing.erase({part.part_index(), part.time_index()}) == 0)
      return wrong_heat(path,
                        absl::StrCat("(part ", part.part_index(), ", time ", part.time_index(),
                                     ") was not asked for, or comes twice"));
    if (!(part.coldest_k() > 0 && part.coldest_k() <= part.mean_k() + kRounding_k &&
          part.mean_k() <= part.hottest_k() + kRounding_k && part.coldest_k() <= part.hottest_k() &&
          std::isfinite(part.hottest_k())))
      return wrong_heat(
          path, absl::StrCat("has a coldest, mean and hottest temperature of ", part.coldest_k(),
                             ", ", part.mean_k(), " and ", part.hottest_k(), " K"));
  }
  if (missing.empty()) return absl::OkStatus();
  return wrong_heat("part", absl::StrCat("is missing for part ", missing.begin()->first, ", time ",
                                         missing.begin()->second));
}

}  // namespace

absl::Status check_heat_result(const schema::JobResult& result, const std::string& job_key,
                               const schema::HeatRun& run, std::uint64_t seed) {
  IRSIG_STORE_TRY(check_job_key(result, job_key));
  IRSIG_STORE_TRY(check_seed(result));
  if (const std::string expected = absl::StrCat(absl::Hex(seed, absl::kZeroPad16));
      result.seed_hex() != expected)
    return absl::InvalidArgumentError(absl::StrCat("result: seed_hex is ", result.seed_hex(),
                                                   ", expected that of the sweep, ", expected));
  if (result.kind_case() != schema::JobResult::kHeat)
    return absl::InvalidArgumentError("result: kind is not the job's: temperatures");
  schema::HeatField field;
  if (const absl::Status size =
          check_wire_size(result.heat().field(), *schema::HeatField::descriptor(), kMostFieldBytes);
      !size.ok())
    return wrong_heat("field", absl::StrCat("cannot be read: ", size.message()));
  if (!field.ParseFromString(result.heat().field())) return wrong_heat("field", "cannot be read");
  IRSIG_STORE_TRY(check_times(field, run));
  IRSIG_STORE_TRY(run.input_size() > 0 ? check_changes(field, run) : check_heat_numbers(field));
  IRSIG_STORE_TRY(check_land(field, run));
  IRSIG_STORE_TRY(check_parts(result.heat(), run));
  for (const std::string& warning : result.heat().warning())
    if (!is_one_line(warning))
      return wrong_heat("warning", "has control characters or is not UTF-8");
  return check_every_number(result);
}

}  // namespace irsig
