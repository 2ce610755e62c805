#include "jobs/text/edit_sweep.h"

#include <toml++/toml.h>

#include <sstream>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace irsig {
namespace {

toml::table& table_at(toml::table& of, std::string_view key) {
  if (!of[key].is_table()) of.insert_or_assign(key, toml::table{});
  return *of[key].as_table();
}

// Leaves one element of an array of tables.
void keep_one(toml::table& of, std::string_view key, std::uint32_t index) {
  toml::array* all = of[key].as_array();
  if (all == nullptr || index >= all->size()) return;
  toml::array kept;
  kept.push_back(*all->get(index)->as_table());
  of.insert_or_assign(key, std::move(kept));
}

void set_time(toml::table& sweep, const SweepEdit& edit) {
  if (toml::array* conditions = sweep["condition"].as_array(); conditions != nullptr) {
    keep_one(sweep, "condition", edit.condition);
    if (!edit.time_of_day.empty())
      sweep["condition"].as_array()->get(0)->as_table()->insert_or_assign("time", edit.time_of_day);
    return;
  }
  keep_one(sweep, "season", edit.season);
  toml::array* times = sweep["time"].as_array();
  if (times == nullptr || edit.time >= times->size()) return;
  toml::array kept;
  if (edit.time_of_day.empty())
    times->get(edit.time)->visit([&](auto&& value) { kept.push_back(value); });
  else
    kept.push_back(edit.time_of_day);
  sweep.insert_or_assign("time", std::move(kept));
}

void set_camera(toml::table& sweep, const SweepEdit::Camera& c) {
  sweep.insert_or_assign(
      "viewpoints",
      toml::table{{"kind", "list"},
                  {"range_m", c.range_m},
                  {"aspect", toml::array{toml::table{{"azimuth_deg", c.azimuth_deg},
                                                     {"elevation_deg", c.elevation_deg}}}}});
  sweep.insert_or_assign(
      "image",
      toml::table{{"kind", "camera"},
                  {"pixels", toml::array{static_cast<std::int64_t>(c.width_px),
                                         static_cast<std::int64_t>(c.height_px)}},
                  {"field_of_view_deg", c.field_of_view_deg},
                  {"look_at_m", toml::array{c.look_at_m[0], c.look_at_m[1], c.look_at_m[2]}},
                  {"pixel_error_percent", c.pixel_error_percent},
                  {"layers", toml::array{"at_sensor"}}});
  if (toml::table* output = sweep["output"].as_table()) output->erase("thumbnail_px");
  sweep.erase("profile");
}

}  // namespace

absl::StatusOr<std::string> edit_sweep(std::string_view text, std::string_view file_name,
                                       const SweepEdit& edit) {
  toml::table sweep;
  try {
    sweep = toml::parse(text, file_name);
  } catch (const toml::parse_error& error) {
    return absl::InvalidArgumentError(
        absl::StrCat(std::string(file_name), ":", error.source().begin.line, ":",
                     error.source().begin.column, ": ", std::string(error.description())));
  }
  for (const char* key : {"condition_file", "vary"})
    if (const toml::node* node = sweep.get(key))
      return absl::InvalidArgumentError(
          absl::StrCat(std::string(file_name), ":", node->source().begin.line, ":",
                       node->source().begin.column, ": ", key,
                       " makes the conditions of this sweep, and one of them cannot be "
                       "taken out of it; write them as [[condition]] to look at single ones"));
  sweep.insert_or_assign("name", edit.name);
  set_time(sweep, edit);
  if (edit.visibility_m)
    table_at(sweep, "air").insert_or_assign("visibility_m", *edit.visibility_m);
  if (edit.choose_effects) {
    toml::array only;
    for (const std::string& effect : edit.only) only.push_back(effect);
    sweep.insert_or_assign("effects", toml::table{{"mode", "only"}, {"only", std::move(only)}});
  }
  if (edit.camera) set_camera(sweep, *edit.camera);
  std::ostringstream out;
  if (edit.without_imager && sweep.erase("imager") > 0)
    out << "# [imager] is left out: its pixels are narrower than two of this image's\n";
  out << toml::toml_formatter(sweep) << "\n";
  return out.str();
}

}  // namespace irsig
