#include "messages/environment/inside_schedule.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/geo/sun.h"
#include "messages/environment/named.h"

namespace irsig {

absl::StatusOr<std::optional<DaySchedule>> inside_schedule(const schema::BuildUp& build_up) {
  if (build_up.inside_schedule().empty()) return std::nullopt;
  DaySchedule out;
  for (const schema::InsideAt& at : build_up.inside_schedule()) {
    ASSIGN_OR_RETURN(const auto time, parse_rfc3339(absl::StrCat("1970-01-01T", at.time())));
    out.at.push_back({unix_seconds(time),
                      build_up.inside() == "heat_flux" ? at.heat_flux_w_m2() : at.temperature_k()});
  }
  if (out.at.size() > 1) {
    const auto steps = named<bool>("inside_between", build_up.inside_between(),
                                   {{"linear", false}, {"steps", true}});
    if (!steps.ok()) return steps.status();
    out.steps = *steps;
  }
  RETURN_IF_ERROR(check_schedule(out));
  return out;
}

}  // namespace irsig
