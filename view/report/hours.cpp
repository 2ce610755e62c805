#include "view/report/hours.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "core/base/status_macros.h"
#include "core/geo/sun.h"
#include "messages/environment/inside_schedule.h"
#include "view/base/table.h"
#include "view/rows/signature_quantity.h"

namespace irsig {
namespace {

absl::Status two_times(const Hours& hours) {
  std::vector<HourOfDay> all;
  for (const HourlyValue& v : hours.value) all.push_back(v.at);
  for (const HourlyTemperature& t : hours.temperature) all.push_back(t.at);
  return check_two_times(all);
}

// A schedule between two instants.
absl::Status add_inside(const schema::BuildUp& build_up, const std::string& season,
                        const std::string& day, const Days& days, double first_s, double last_s,
                        std::vector<HourlyInside>& out) {
  ASSIGN_OR_RETURN(const auto schedule, inside_schedule(build_up));
  if (!schedule) return absl::OkStatus();
  std::vector<double> knot = {first_s};
  const std::vector<double> between = times_between(*schedule, first_s, last_s);
  knot.insert(knot.end(), between.begin(), between.end());
  if (last_s > first_s) knot.push_back(last_s);
  const std::vector<ScheduleAtKnot> value = at_knots(*schedule, knot);
  for (std::size_t k = 0; k < knot.size(); ++k) {
    HourOfDay at = days.place(season, knot[k]);
    at.day = day;  // an hour of the day that it is drawn with
    const bool heat_flux = build_up.inside() == "heat_flux";
    out.push_back({at, season, build_up.name(), knot[k], value[k].before, heat_flux});
    if (value[k].after != value[k].before)
      out.push_back({at, season, build_up.name(), knot[k], value[k].after, heat_flux});
  }
  return absl::OkStatus();
}

// Adds the inner sides of walls, for parts with temperatures.
absl::Status add_inside(const schema::Sweep& sweep, const Days& days, Hours& hours) {
  struct Span {
    std::string season;
    double first_s, last_s;
    std::set<std::string> part;
  };
  std::vector<std::string> order;
  std::map<std::string, Span> of_day;
  for (const HourlyTemperature& t : hours.temperature) {
    const double s = unix_seconds(*parse_rfc3339(t.part.time_utc));
    const auto [found, added] = of_day.try_emplace(t.at.day, Span{t.part.season, s, s, {}});
    if (added) order.push_back(t.at.day);
    found->second.first_s = std::min(found->second.first_s, s);
    found->second.last_s = std::max(found->second.last_s, s);
    found->second.part.insert(t.part.part);
  }
  for (const std::string& day : order) {
    const Span& span = of_day.at(day);
    for (const schema::BuildUp& build_up : sweep.build_up()) {
      const bool used = std::any_of(sweep.part().begin(), sweep.part().end(), [&](const auto& p) {
        return p.build_up() == build_up.name() && span.part.contains(p.name());
      });
      if (!used) continue;
      RETURN_IF_ERROR(
          add_inside(build_up, span.season, day, days, span.first_s, span.last_s, hours.inside));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Hours> hours_of(StoreReader& reader, const Query& query) {
  Query asked = query;
  if (asked.aspect && !asked.nearest && !asked.within_deg && !asked.interpolate) asked.nearest = 1;
  ASSIGN_OR_RETURN(auto rows, run_query(reader, asked));
  if (rows.empty()) return absl::NotFoundError("nothing to plot: no signature matches the filters");
  RETURN_IF_ERROR(check_one_viewpoint(rows, "--aspect (the nearest, or --interpolate)"));
  std::vector<StoredSignature> signatures;
  for (const QueryRow& r : rows) signatures.push_back(r.signature);
  RETURN_IF_ERROR(check_computed(signatures, query.quantity));

  Hours out{rows.front().signature.sweep, query.quantity, std::nullopt, {}, {}};
  ASSIGN_OR_RETURN(const auto sweep, reader.sweep(out.sweep, SweepFiles::kNone));
  out.solar_offset_h = solar_offset_h(sweep.resolved.sweep());
  // The temperatures of what is drawn: a day of which no signature is asked for has none.
  std::set<std::pair<std::string, std::string>> conditions;
  Days days(out.solar_offset_h.value_or(0));
  for (const StoredSignature& s : signatures) {
    conditions.emplace(s.season, s.time_utc);
    RETURN_IF_ERROR(days.add(s.season, s.time_utc));
  }
  auto temperatures =
      reader.computed_temperatures({.sweep = out.sweep, .season = {}, .time_utc = {}});
  if (!temperatures.ok()) return temperatures.status();
  // Until it is replaced, one of an earlier version may stand beside its successor.
  std::stable_partition(temperatures->begin(), temperatures->end(),
                        [](const StoredTemperature& t) { return !t.superseded; });
  std::set<std::tuple<std::string, std::string, std::string>> seen;
  for (StoredTemperature& t : *temperatures) {
    if (!conditions.contains({t.season, t.time_utc})) continue;
    if (!seen.emplace(t.season, t.time_utc, t.part).second) continue;
    const HourOfDay at = days.place(t.season, t.time_utc);
    out.temperature.push_back({at, std::move(t)});
  }
  for (QueryRow& r : rows) {
    const HourOfDay at = days.place(r.signature.season, r.signature.time_utc);
    out.value.push_back({at, std::move(r)});
  }
  // Days, bands and parts keep the order of the sweep.
  const auto order = [](std::vector<std::string>& known, const std::string& name) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) known.push_back(name);
    return found - known.begin();
  };
  std::vector<std::string> day, band, part;
  for (const HourlyValue& v : out.value) {
    (void)order(day, v.at.day);
    (void)order(band, v.row.signature.band);
  }
  for (const HourlyTemperature& t : out.temperature) (void)order(part, t.part.part);
  std::stable_sort(out.value.begin(), out.value.end(), [&](const auto& a, const auto& b) {
    return std::tuple(order(day, a.at.day), order(band, a.row.signature.band), a.at.hour) <
           std::tuple(order(day, b.at.day), order(band, b.row.signature.band), b.at.hour);
  });
  std::stable_sort(out.temperature.begin(), out.temperature.end(),
                   [&](const auto& a, const auto& b) {
                     return std::tuple(order(day, a.at.day), order(part, a.part.part), a.at.hour) <
                            std::tuple(order(day, b.at.day), order(part, b.part.part), b.at.hour);
                   });
  RETURN_IF_ERROR(add_inside(sweep.resolved.sweep(), days, out));
  RETURN_IF_ERROR(two_times(out));
  return out;
}

absl::Status write_hours(const Hours& hours, std::string_view format, std::ostream& out) {
  const QuantityColumns& quantity = columns_of(hours.quantity);
  const bool no_bounds = std::string_view(quantity.stderr_name) == quantity.error_name;
  std::vector<Column> columns = {{"sweep"},
                                 {"day"},
                                 {"season"},
                                 {"time_utc"},
                                 {hours.solar_offset_h ? "solar_time_h" : "utc_h"},
                                 {"part"},
                                 {"mean_k"},
                                 {"coldest_k"},
                                 {"hottest_k"},
                                 {"error_k"},
                                 {"band"},
                                 {"aspect_azimuth_deg"},
                                 {"aspect_elevation_deg"},
                                 {"range_m"},
                                 {quantity.value_name},
                                 {quantity.stderr_name}};
  if (!no_bounds) columns.push_back({quantity.error_name});
  if (quantity.input_name != nullptr) columns.push_back({quantity.input_name});
  const std::size_t behind = columns.size();
  if (!hours.inside.empty())
    for (const char* name : {"build_up", "inside_temperature_k", "inside_heat_flux_w_m2"})
      columns.push_back({name});
  ASSIGN_OR_RETURN(const auto table, make_table_writer(format, columns, out));
  const Cell none;
  for (const HourlyTemperature& t : hours.temperature) {
    std::vector<Cell> cells = {t.part.sweep,     t.at.day,      t.part.season, t.part.time_utc,
                               t.at.hour,        t.part.part,   t.part.mean_k, t.part.coldest_k,
                               t.part.hottest_k, t.part.error_k};
    cells.resize(columns.size(), none);
    table->row(cells);
  }
  for (const HourlyInside& i : hours.inside) {
    std::vector<Cell> cells(columns.size(), none);
    cells[0] = hours.sweep;
    cells[1] = i.at.day;
    cells[2] = i.season;
    cells[3] = format_rfc3339_utc(utc_time(i.unix_s));
    cells[4] = i.at.hour;
    cells[behind] = i.build_up;
    cells[behind + (i.heat_flux ? 2 : 1)] = i.value;
    table->row(cells);
  }
  for (const HourlyValue& v : hours.value) {
    const StoredSignature& s = v.row.signature;
    std::vector<Cell> cells = {s.sweep,
                               v.at.day,
                               s.season,
                               s.time_utc,
                               v.at.hour,
                               none,
                               none,
                               none,
                               none,
                               none,
                               s.band,
                               s.aspect_azimuth_deg,
                               s.aspect_elevation_deg,
                               s.range_m,
                               s.*quantity.value,
                               s.*quantity.value_stderr};
    if (!no_bounds) cells.emplace_back(s.*quantity.numerical_error);
    if (quantity.input_name != nullptr) {
      const double input = input_uncertainty_of(quantity, s);
      cells.push_back(std::isnan(input) ? none : Cell(input));
    }
    cells.resize(columns.size(), none);
    table->row(cells);
  }
  return table->finish();
}

}  // namespace irsig
