#include "jobs/resolve_cloud.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/atmosphere/cloud.h"
#include "core/base/status_macros.h"
#include "core/thermal/condensation.h"
#include "jobs/text/number_bounds.h"

namespace irsig {
namespace {

// A type of cloud: the values of LOWTRAN7's clouds, whose water is that of its layers.
struct CloudType {
  const char* name;
  const char* phase;
  double base_m, thickness_m, water_path_g_m2, effective_radius_um;
};
constexpr std::array<CloudType, 6> kTypes = {{{"stratus", "water", 330, 670, 200, 7.9},
                                              {"stratocumulus", "water", 660, 1340, 215, 6.3},
                                              {"cumulus", "water", 660, 2040, 1660, 11.5},
                                              {"altostratus", "water", 2400, 600, 345, 6.8},
                                              {"nimbostratus", "water", 160, 500, 345, 11.3},
                                              {"cirrus", "ice", 10000, 1000, 6.7, 64}}};
constexpr const CloudType& kDefaultType = kTypes[0];

const CloudType* type_named(const std::string& name) {
  for (const CloudType& type : kTypes)
    if (name == type.name) return &type;
  return nullptr;
}

SectionCheck::Names type_names() {
  SectionCheck::Names out;
  for (const CloudType& type : kTypes) out.push_back(type.name);
  return out;
}

// The layer as one table has it, wherever its keys are.
schema::Cloud written_cloud(const schema::Season& season) {
  if (season.cloud_size() > 0) return season.cloud(0);
  schema::Cloud out;
  if (season.has_cloud_cover()) out.set_cover(season.cloud_cover());
  if (season.has_cloud_type()) out.set_type(season.cloud_type());
  if (season.has_cloud_base_m()) out.set_base_m(season.cloud_base_m());
  if (season.has_cloud_water_path_g_m2()) out.set_water_path_g_m2(season.cloud_water_path_g_m2());
  return out;
}

// Where the keys of a layer stand: in its table, or beside the season's other keys.
struct LayerKeys {
  std::string all, base, top, radius;
};

LayerKeys keys_of_table(const schema::Cloud& cloud, const std::string& path) {
  const auto key = [&](bool has, const char* name) { return has ? path + "." + name : path; };
  return {path, key(cloud.has_base_m(), "base_m"), key(cloud.has_top_m(), "top_m"),
          key(cloud.has_effective_radius_um(), "effective_radius_um")};
}

// Without a type all of the layer has to be stated.
void check_without_type(const std::string& path, const SectionCheck& check, Findings& findings) {
  std::vector<std::string> missing;
  for (const char* key : {"base_m", "top_m", "water_path_g_m2", "effective_radius_um", "phase"})
    if (!check.has(key)) missing.push_back(path + "." + key);
  if (missing.empty()) return;
  findings.add(path,
               absl::StrFormat("%s.type is missing, expected a type (\"stratus\", \"cumulus\", "
                               "\"cirrus\" ...), or all of the layer: also %s",
                               path, absl::StrJoin(missing, ", ")));
}

// One table by itself.
//   cover_elsewhere  a weather file may have it
void check_layer_table(const schema::Cloud& cloud, const std::string& path, bool cover_elsewhere,
                       Findings& findings) {
  const SectionCheck check(cloud, path, findings);
  if (cloud.has_cover() && cloud.has_cover_oktas())
    check.error("cover_oktas",
                absl::StrFormat("= %g and cover = %g both state how much of the sky is covered: "
                                "expected only one of them",
                                cloud.cover_oktas(), cloud.cover()));
  if (!cloud.has_cover() && !cloud.has_cover_oktas() && !cover_elsewhere)
    check.require({"cover"},
                  "expected the covered fraction of the sky, 0 to 1 (or cover_oktas, 0 to 8)");
  if (!cloud.has_type()) check_without_type(path, check, findings);
  (void)check.one_of("type", type_names());
  (void)check.one_of("phase", {"water", "ice"});
  // A type's radius is that of droplets or of crystals.
  const CloudType* type = type_named(cloud.type());
  if (type != nullptr && cloud.has_phase() && !cloud.has_effective_radius_um() &&
      (cloud.phase() == "water" || cloud.phase() == "ice") && cloud.phase() != type->phase)
    check.error("phase",
                absl::StrFormat("= \"%s\" contradicts type \"%s\", whose %s have an "
                                "effective radius of %g um: expected effective_radius_um "
                                "beside it, or phase = \"%s\"",
                                cloud.phase(), type->name,
                                type->phase == std::string_view("water") ? "droplets" : "crystals",
                                type->effective_radius_um, type->phase));
}

void check_beside_table(const schema::Season& season, const std::string& of, Findings& findings) {
  const SectionCheck of_season(season, of, findings);
  for (const char* key : {"cloud_cover", "cloud_type", "cloud_base_m", "cloud_water_path_g_m2"})
    if (of_season.has(key))
      of_season.error(key,
                      "does not apply beside [[season.cloud]], which states the same layer: "
                      "expected only one of them");
}

// The base or top of a layer, and what states it.
std::string height_text(double height_m, bool stated, const schema::CloudLayer& layer) {
  return absl::StrFormat("%g m%s", height_m,
                         stated ? "" : absl::StrFormat(" (of type \"%s\")", layer.type()));
}

void check_layer(const schema::CloudLayer& layer, const schema::Cloud& cloud, const LayerKeys& keys,
                 Findings& findings) {
  if (findings.any_at(keys.all) || findings.any_at(keys.base)) return;
  const bool water = layer.phase() == "water";
  const double low = water ? kSmallestDropUm : kSmallestCrystalUm,
               high = water ? kLargestDropUm : kLargestCrystalUm;
  if (!(layer.top_m() >= layer.base_m() + kThinnestCloudM)) {
    findings.add(keys.top, absl::StrFormat(
                               "%s: the layer's top, %s, is below its base, %s; expected top_m of "
                               "at least %g m, or a lower base_m",
                               keys.top, height_text(layer.top_m(), cloud.has_top_m(), layer),
                               height_text(layer.base_m(), cloud.has_base_m(), layer),
                               layer.base_m() + kThinnestCloudM));
  } else if (layer.top_m() > kHighestCloudM) {
    findings.add(keys.base,
                 absl::StrFormat("%s: the layer's top, %g m (base %g m, and the %g m of type "
                                 "\"%s\"), is above %g m, where the model of clouds ends; expected "
                                 "a lower base_m, or top_m",
                                 keys.base, layer.top_m(), layer.base_m(),
                                 layer.top_m() - layer.base_m(), layer.type(), kHighestCloudM));
  }
  const double radius_um = layer.effective_radius_um();
  if (!(radius_um >= low && radius_um <= high))
    findings.add(
        keys.radius,
        absl::StrFormat("%s = %g um is outside the table of %s, expected %g to %g um, or phase = "
                        "\"%s\"",
                        keys.radius, radius_um, water ? "droplets" : "ice crystals", low, high,
                        water ? "ice" : "water"));
}

LayerKeys keys_of_season(const schema::Season& season, int season_index) {
  const std::string of = absl::StrCat("season[", season_index, "].");
  if (season.cloud_size() > 0) return keys_of_table(season.cloud(0), of + "cloud[0]");
  const std::string all = of + (season.has_cloud_cover()             ? "cloud_cover"
                                : season.has_cloud_type()            ? "cloud_type"
                                : season.has_cloud_base_m()          ? "cloud_base_m"
                                : season.has_cloud_water_path_g_m2() ? "cloud_water_path_g_m2"
                                : season.has_weather_file()          ? "weather_file"
                                                                     : "day");
  return {all, season.has_cloud_base_m() ? of + "cloud_base_m" : all, all, all};
}

}  // namespace

std::optional<double> stated_cloud_cover(const schema::Season& season) {
  const schema::Cloud cloud = written_cloud(season);
  constexpr double kOktas = 8;
  if (cloud.has_cover_oktas()) return cloud.cover_oktas() / kOktas;
  if (cloud.has_cover()) return cloud.cover();
  return std::nullopt;
}

void check_cloud_of_season(const schema::Season& season, int season_index, Findings& findings) {
  const std::string of = absl::StrCat("season[", season_index, "]");
  const SectionCheck check(season, of, findings);
  if (season.cloud_size() > 1)
    findings.add(of + ".cloud[1]",
                 of + ".cloud[1] is a second layer of cloud, expected one: the lower one hides the "
                      "others from below");
  if (season.cloud_size() > 0) {
    check_layer_table(season.cloud(0), of + ".cloud[0]", season.has_weather_file(), findings);
    check_beside_table(season, of, findings);
  } else {
    (void)check.one_of("cloud_type", type_names());
    if (!season.has_cloud_cover() && !season.has_weather_file())
      for (const char* key : {"cloud_type", "cloud_base_m", "cloud_water_path_g_m2"})
        if (check.has(key))
          check.error(key,
                      "does not apply without a cover, expected cloud_cover = 0 to 1 beside it");
  }
}

schema::CloudLayer cloud_layer(const schema::Season& season, const schema::Weather& weather) {
  const schema::Cloud cloud = written_cloud(season);
  const CloudType* stated = type_named(cloud.type());
  const CloudType& type = stated ? *stated : kDefaultType;
  schema::CloudLayer out;
  out.set_type(stated || !cloud.has_phase() ? type.name : "");
  out.set_phase(cloud.has_phase() ? cloud.phase() : type.phase);
  double base_m = type.base_m;
  if (cloud.has_base_m()) {
    base_m = cloud.base_m();
  } else if (!stated) {
    out.set_base_from_weather(true);
    base_m = condensed_base_m(weather.air_temperature_k(), weather.relative_humidity_percent());
  }
  out.set_base_m(base_m);
  out.set_top_m(cloud.has_top_m() ? cloud.top_m() : base_m + type.thickness_m);
  out.set_water_path_stated(cloud.has_water_path_g_m2());
  out.set_water_path_g_m2(cloud.has_water_path_g_m2() ? cloud.water_path_g_m2()
                                                      : type.water_path_g_m2);
  out.set_effective_radius_um(cloud.has_effective_radius_um() ? cloud.effective_radius_um()
                                                              : type.effective_radius_um);
  return out;
}

void resolve_cloud(const schema::Season& season, int season_index, bool always,
                   schema::Weather& weather, schema::Condition& condition, Findings& findings) {
  if (weather.cloud_cover() <= 0 && !always) return;
  *weather.mutable_cloud() = cloud_layer(season, weather);
  const schema::CloudLayer& layer = weather.cloud();
  const LayerKeys keys = keys_of_season(season, season_index);
  const std::string& key = keys.all;
  check_layer(layer, written_cloud(season), keys, findings);
  if (layer.base_from_weather()) {
    condition.add_warning(findings.odd(
        key,
        absl::StrFormat("%s: a cloud of unknown type is taken as %s, %.0f m thick, based at twice "
                        "the level of condensation (%.0f to %.0f m); set cloud_type or "
                        "[[season.cloud]]",
                        key, layer.type(), layer.top_m() - layer.base_m(), kLowestCondensationM,
                        kHighestCondensationM)));
  }
  if (season.cloud_size() > 0 && season.has_weather_file() && stated_cloud_cover(season))
    condition.add_warning(
        findings.odd(key, absl::StrCat(key, ": its cover is used in place of the weather file's")));
}

absl::StatusOr<schema::CloudLayer> stated_cloud_layer(const schema::Cloud& cloud) {
  const std::string path = "cloud";
  const SweepFile none;
  Findings findings(none);
  check_numbers(cloud, path, findings);
  check_layer_table(cloud, path, false, findings);
  RETURN_IF_ERROR(findings.status());
  schema::Season season;
  *season.add_cloud() = cloud;
  schema::CloudLayer layer = cloud_layer(season, schema::Weather());
  check_layer(layer, cloud, keys_of_table(cloud, path), findings);
  RETURN_IF_ERROR(findings.status());
  return layer;
}

}  // namespace irsig
