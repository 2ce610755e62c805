#include "jobs/text/size_bounds.h"

#include <algorithm>
#include <array>
#include <unordered_map>
#include <vector>

#include "absl/strings/str_cat.h"
#include "jobs/text/limits.h"

namespace irsig {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

constexpr std::size_t kTable = 100000;      // points of a table over wavelength
constexpr std::size_t kParts = 10000;       // parts of a target, and what each of them has
constexpr std::size_t kNames = 1000;        // what is written by hand
constexpr std::size_t kLandMaterials = 64;  // a byte of each at every place of the land
constexpr std::size_t kLandObjects = 100;   // meshes; each may stand at many places
constexpr std::size_t kText = 16 << 20;     // bytes of a file that is part of the sweep

constexpr auto kSizes = std::to_array<SizeBound>({
    {"Sweep.description", 100000},
    {"Sweep.material", kNames},
    {"Sweep.part", kParts},
    {"Sweep.season", kMostConditions},
    {"Sweep.time", kParts},  // a year of hours
    {"Sweep.band", kNames},
    {"Sweep.profile", kNames},
    {"Sweep.published", kTable},
    {"Sweep.condition", kMostConditions},
    {"Sweep.temperature_field", kNames},
    {"Sweep.build_up", kNames},
    {"Model.offset_m", 3},
    {"Material.emissivity_table", kTable},
    {"Material.optical_constants", kTable},
    {"Material.reflectance_table", kTable},
    {"Material.diffuse_reflectance_table", kTable},
    {"Material.specular_reflectance_table", kTable},
    {"Material.volume_reflectance_table", kTable},
    {"BrdfTable.lambda_um", kParts},
    {"BrdfTable.theta_i_deg", kParts},
    {"BrdfTable.theta_r_deg", kParts},
    {"BrdfTable.phi_deg", kParts},
    {"BrdfTable.brdf_per_sr", 4000000},
    {"Part.match", kNames},
    {"BuildUp.inside_schedule", kNames},
    {"BuildUp.layer", kNames},
    {"Season.part_temperature_k", kParts},
    {"Season.land_temperature_k", kLandMaterials},
    {"Season.cloud", 10},
    {"Vary.wind_speed_m_s", kNames},
    {"Vary.visibility_m", kNames},
    {"Vary.relative_humidity_percent", kNames},
    {"Vary.air_temperature_k", kNames},
    {"Vary.profile", kNames},
    {"Vary.sea_temperature_k", kNames},
    {"Vary.above_surface_m", kNames},
    {"Vary.cloud_cover", kNames},
    {"Vary.cloud_type", kNames},
    {"Vary.cloud_base_m", kNames},
    {"Vary.cloud_water_path_g_m2", kNames},
    {"Band.response", kTable},
    {"Viewpoints.azimuth_deg", kMostViewpoints},
    {"Viewpoints.elevation_deg", kMostViewpoints},
    {"Viewpoints.aspect", kMostViewpoints},
    {"Viewpoints.ranges_m", kMostViewpoints},
    {"Effects.only", kNames},
    {"Effects.without", kNames},
    {"Plume.position_m", 3},
    {"Land.material", kLandMaterials},
    {"Land.object", kLandObjects},
    {"LandObject.part", kNames},
    {"LandObject.place", kParts},
    {"Precompute.ambient_temperature_k", kMostConditions},
    {"Precompute.air_temperature_k", kMostConditions},
    {"Image.pixels", 2},
    {"Image.look_at_m", 3},
    {"Image.layers", 100},
    {"Profile.from_m", 3},
    {"Profile.to_m", 3},
    {"Profile.at_m", 3},
    {"Profile.reflections", 1001},
    {"Published.source", kTable},
    {"Published.remark", kTable},

    {"ResolvedSweep.viewpoint", kMostViewpoints},
    {"ResolvedSweep.condition", kMostConditions},
    {"ResolvedSweep.heat", kMostConditions},
    {"ResolvedSweep.plume", kMostPlumes},
    {"ResolvedSweep.slice", 64},
    {"Condition.part_temperature_k", kParts},
    {"Condition.land_temperature_k", kLandMaterials},
    {"LandFiles.fraction", kLandMaterials},
    {"LandFiles.object", kLandObjects},
    {"Condition.warning", kNames},
    {"ConditionField.part", kParts},
    {"WeatherCourse.record", 1000000},
    {"HeatRun.time_utc", kMostConditions},
    {"HeatRun.part_temperature_k", kParts},
    {"HeatRun.land_temperature_k", kLandMaterials},
    {"HeatRun.input", kNames},
    {"Weather.profile_csv", kText},
    {"Weather.modtran_text", 3 * kText},
});

const SizeBound* row_of(const FieldDescriptor& field) {
  static const auto& rows = *[] {
    auto* made = new std::unordered_map<std::string_view, const SizeBound*>();
    for (const SizeBound& row : kSizes) made->emplace(row.key, &row);
    return made;
  }();
  const auto found = rows.find(absl::StrCat(field.containing_type()->name(), ".", field.name()));
  return found == rows.end() ? nullptr : found->second;
}

void check_text(const std::string& text, const SizeBound* row, const std::string& path,
                Findings& findings) {
  const std::size_t most = row != nullptr ? row->most : kLongestName;
  if (text.size() > most)
    findings.add(path, absl::StrCat(path, " has ", text.size(), " bytes, expected at most ", most));
}

}  // namespace

std::span<const SizeBound> size_bounds() { return kSizes; }

void check_sizes(const Message& message, const std::string& path, Findings& findings) {
  const Reflection& r = *message.GetReflection();
  std::vector<const FieldDescriptor*> present;
  r.ListFields(message, &present);
  for (const FieldDescriptor* field : present) {
    const bool text = field->cpp_type() == FieldDescriptor::CPPTYPE_STRING;
    const bool of_messages = field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
    if (!field->is_repeated() && !text && !of_messages) continue;
    const std::string at = path.empty() ? field->name() : absl::StrCat(path, ".", field->name());
    const SizeBound* row = row_of(*field);
    if (!field->is_repeated()) {
      if (text) check_text(r.GetString(message, field), row, at, findings);
      if (of_messages) check_sizes(r.GetMessage(message, field), at, findings);
      continue;
    }
    const int count = r.FieldSize(message, field);
    if (row != nullptr && static_cast<std::size_t>(count) > row->most) {
      findings.add(at, absl::StrCat(at, " has ", count, " elements, expected at most ", row->most));
      continue;
    }
    for (int i = 0; i < count && (text || of_messages); ++i) {
      const std::string element = absl::StrCat(at, "[", i, "]");
      if (text) {
        check_text(r.GetRepeatedString(message, field, i), nullptr, element, findings);
      } else {
        check_sizes(r.GetRepeatedMessage(message, field, i), element, findings);
      }
    }
  }
}

void check_row_count(const schema::ResolvedSweep& sweep, Findings& findings) {
  const double rows = 1.0 * sweep.viewpoint_size() * sweep.condition_size() *
                      std::max(1, sweep.sweep().band_size());
  if (rows > kMostRows)
    findings.add(
        "viewpoints",
        absl::StrCat("viewpoints: ", sweep.viewpoint_size(), " of them, ", sweep.condition_size(),
                     " conditions and ", sweep.sweep().band_size(), " bands make ", rows,
                     " rows, expected at most ", kMostRows, ": split the sweep"));
  double profile_rows = 0;
  for (const schema::Profile& profile : sweep.sweep().profile())
    profile_rows += (profile.at_m_size() > 0 ? 1.0 : 1.0 * profile.points()) *
                    std::max(1, profile.reflections_size());
  if (profile_rows > kMostProfileRows)
    findings.add("profile",
                 absl::StrCat("profile: points and reflections make ", profile_rows,
                              " rows under each signature, expected at most ", kMostProfileRows));
}

}  // namespace irsig
