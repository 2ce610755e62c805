#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/status_macros.h"
#include "serve/answer_parts.h"
#include "serve/command_line.h"
#include "serve/json_text.h"
#include "view/report/compare.h"
#include "view/report/polar_cut.h"

namespace irsig {
namespace {

// Writes the quantity of the numbers.
void name_quantity(JsonObject& out, SignatureQuantity quantity) {
  const QuantityColumns& q = columns_of(quantity);
  out.text("quantity", q.name);
  out.text("title", q.title);
  out.text("unit", q.unit);
  out.flag("signed", q.is_signed());
}

// One member of all values, as an array.
template <typename Value, typename Member>
std::vector<double> picked(const std::vector<Value>& values, const Member& member) {
  std::vector<double> out;
  out.reserve(values.size());
  for (const Value& v : values) out.push_back(member(v));
  return out;
}

template <typename Value, typename Member>
std::vector<std::uint64_t> picked_rows(const std::vector<Value>& values, const Member& member) {
  std::vector<std::uint64_t> out;
  out.reserve(values.size());
  for (const Value& v : values) out.push_back(member(v));
  return out;
}

std::string points(const std::vector<PolarPoint>& point) {
  JsonObject out;
  out.numbers("azimuth_deg", picked(point, [](const PolarPoint& p) { return p.azimuth_deg; }));
  out.numbers("value", picked(point, [](const PolarPoint& p) { return p.value; }));
  out.numbers("error", picked(point, [](const PolarPoint& p) { return p.error; }));
  return out.finish();
}

}  // namespace

absl::StatusOr<std::vector<StoredValue>> values_of_selection(StoreReader& reader,
                                                             const Selection& selection,
                                                             SignatureQuantity quantity) {
  ASSIGN_OR_RETURN(auto values, reader.values(value_filter(selection, quantity)));
  if (values.empty()) {
    // Explains a name that there is not.
    ASSIGN_OR_RETURN(const auto rows, run_query(reader, selection_query(selection, quantity)));
    return absl::NotFoundError(
        fmt::format("nothing is stored (yet) of sweep {}, {}, {}, {}, from {:g} m", selection.sweep,
                    selection.season, selection.time, selection.band, selection.at_range_m));
  }
  RETURN_IF_ERROR(check_computed(values, quantity));
  return values;
}

absl::StatusOr<PageReply> answer_map(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto reader, open_database(sources, q.a.database));
  ASSIGN_OR_RETURN(const auto values, values_of_selection(*reader, q.a, q.quantity));
  JsonObject out;
  name_quantity(out, q.quantity);
  out.text("command", selection_command(sources.database[q.a.database], q.a, q.quantity));
  out.counts("row", picked_rows(values, [](const StoredValue& v) { return v.row; }));
  out.numbers("azimuth_deg",
              picked(values, [](const StoredValue& v) { return v.aspect_azimuth_deg; }));
  out.numbers("elevation_deg",
              picked(values, [](const StoredValue& v) { return v.aspect_elevation_deg; }));
  out.numbers("value", picked(values, [](const StoredValue& v) { return v.value; }));
  out.numbers("error", picked(values, [](const StoredValue& v) { return v.numerical_error; }));
  return json_reply(out.finish());
}

absl::StatusOr<PageReply> answer_cut(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto reader, open_database(sources, q.a.database));
  ASSIGN_OR_RETURN(const auto values, values_of_selection(*reader, q.a, q.quantity));
  const auto cut = polar_cut(values, columns_of(q.quantity), q.elevation_deg);
  if (absl::IsOutOfRange(cut.status()) && !q.elevation_deg)
    return absl::OutOfRangeError(
        fmt::format("{}: choose one below", std::string(cut.status().message())));
  if (!cut.ok()) return cut.status();
  JsonObject out;
  name_quantity(out, q.quantity);
  out.text("command", cut_command(sources.database[q.a.database], q, cut->elevation_deg));
  out.number("elevation_deg", cut->elevation_deg);
  out.flag("interpolated", cut->interpolated);
  out.number("near_deg", kNearRingDeg);
  out.json("point", points(cut->point));
  out.json("mark", points(cut->mark));
  return json_reply(out.finish());
}

absl::StatusOr<PageReply> answer_compare(const PageSources& sources, const Question& q) {
  ASSIGN_OR_RETURN(const auto compared, compare_selections(sources, q));
  JsonObject out;
  name_quantity(out, q.quantity);
  out.text("command", selection_command(sources.database[q.a.database], q.a, q.quantity) + "\n" +
                          selection_command(sources.database[q.b->database], *q.b, q.quantity));
  const std::vector<ComparedAspect>& v = compared.value;
  using C = ComparedAspect;
  out.counts("a_row", picked_rows(v, [](const C& c) { return c.a.row; }));
  out.counts("b_row", picked_rows(v, [](const C& c) { return c.b.row; }));
  out.numbers("azimuth_deg", picked(v, [](const C& c) { return c.aspect_azimuth_deg; }));
  out.numbers("elevation_deg", picked(v, [](const C& c) { return c.aspect_elevation_deg; }));
  out.numbers("a", picked(v, [](const C& c) { return c.a.value; }));
  out.numbers("a_error", picked(v, [](const C& c) { return c.a.numerical_error; }));
  out.numbers("b", picked(v, [](const C& c) { return c.b.value; }));
  out.numbers("b_error", picked(v, [](const C& c) { return c.b.numerical_error; }));
  out.numbers("difference", picked(v, [](const C& c) { return c.difference; }));
  out.numbers("difference_error", picked(v, [](const C& c) { return c.difference_error; }));
  out.numbers("sigmas", picked(v, [](const C& c) { return c.sigmas; }));
  out.count("only_in_a", compared.only_in_a);
  out.count("only_in_b", compared.only_in_b);
  return json_reply(out.finish());
}

namespace {

absl::StatusOr<schema::Band> band_of(StoreReader& reader, const Selection& selection) {
  ASSIGN_OR_RETURN(const auto sweep, reader.sweep(selection.sweep, SweepFiles::kNone));
  for (const schema::Band& band : sweep.resolved.sweep().band())
    if (band.name() == selection.band) return band;
  return absl::NotFoundError(
      fmt::format("sweep {} has no band {}", selection.sweep, selection.band));
}

}  // namespace

absl::StatusOr<Comparison> compare_selections(const PageSources& sources, const Question& q) {
  std::vector<StoredValue> values[2];
  schema::Band band[2];
  const Selection* selection[2] = {&q.a, &*q.b};
  for (int i = 0; i < 2; ++i) {
    ASSIGN_OR_RETURN(const auto reader, open_database(sources, selection[i]->database));
    ASSIGN_OR_RETURN(values[i], values_of_selection(*reader, *selection[i], q.quantity));
    ASSIGN_OR_RETURN(band[i], band_of(*reader, *selection[i]));
  }
  RETURN_IF_ERROR(check_same_band(band[0], band[1]));
  Comparison out = compare(values[0], values[1]);
  if (out.value.empty()) return absl::NotFoundError("the two have no aspect in common");
  return out;
}

}  // namespace irsig
