#include "cli/air_options.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "core/base/status_macros.h"
#include "core/base/user_file.h"
#include "core/scene/import/model_file.h"
#include "jobs/resolve_cloud.h"
#include "jobs/resolve_sweep.h"
#include "jobs/text/number_bounds.h"
#include "jobs/text/sweep_file.h"
#include "messages/environment/weather_from_message.h"
#include "planning/load_sweep.h"

namespace irsig {
namespace {

constexpr AfglProfile kProfiles[] = {
    AfglProfile::kTropical,        AfglProfile::kMidlatitudeSummer, AfglProfile::kMidlatitudeWinter,
    AfglProfile::kSubarcticSummer, AfglProfile::kSubarcticWinter,   AfglProfile::kUsStandard1976};

struct Stated {
  const char *key, *name;  // of the sweep file, and of the option
  std::optional<double> value;
};

std::string comma_list(const auto& names) {
  std::string out;
  for (const auto& name : names) absl::StrAppend(&out, out.empty() ? "" : " | ", name);
  return out;
}

std::string profile_names() {
  std::vector<std::string> names;
  for (const AfglProfile p : kProfiles) names.emplace_back(name_of(p));
  return comma_list(names);
}

std::string aerosol_list() { return comma_list(aerosol_names()); }

// A key of [[season.cloud]] as an option.
struct CloudOption {
  const char *key, *name, *about;
};
constexpr std::array<CloudOption, 7> kCloudOptions = {
    {{"type", "--cloud-type",
      "stratus | stratocumulus | cumulus | altostratus | nimbostratus | cirrus: needed unless all "
      "of the layer is stated"},
     {"cover", "--cloud-cover", "Fraction of the sky that a layer of cloud covers: 0 to 1"},
     {"base_m", "--cloud-base-m", "Above the surface; default: the type's"},
     {"top_m", "--cloud-top-m", "Default: the base and the type's thickness"},
     {"water_path_g_m2", "--cloud-water-path-g-m2", "Vertical, liquid or ice; default: the type's"},
     {"effective_radius_um", "--cloud-effective-radius-um",
      "Of the particles; default: the type's"},
     {"phase", "--cloud-phase", "water | ice; default: the type's"}}};

// "stratus cover 0.5": of a drawing.
std::string cloud_title(const WeatherSpec& weather, const std::string& type) {
  if (weather.cloud_cover <= 0) return "";
  return absl::StrFormat(", %s cover %g", type.empty() ? "cloud" : type, weather.cloud_cover);
}

}  // namespace

AirOptions::AirOptions(CLI::App& command, Use use) : group_(command.add_option_group("The air")) {
  group_
      ->add_option("--sweep-file", sweep_,
                   "Sweep file with air.model = \"atmosphere\", whose air is taken instead of all "
                   "that follows")
      ->type_name("FILE");
  group_->add_option("--season", season_, "Name of the season; needed if the sweep has several")
      ->type_name("NAME");
  group_->add_option("--profile", profile_, profile_names())->type_name("NAME");
  group_
      ->add_option(
          "--profile-file", profile_file_,
          "A radiosonde in CSV (docs/explanation/methods/atmosphere.md); --profile is then "
          "what lies above it and its other gases")
      ->type_name("FILE");
  group_->add_option("--aerosol", aerosol_, aerosol_list())->type_name("NAME");
  group_->add_option("--visibility-m", visibility_m_, "Meteorological range: 100 to 100000");
  group_->add_option(
      "--air-temperature-k", air_temperature_k_,
      "Temperature of the air at the surface, to which the lowest 2 km are bent, with humidity and "
      "pressure: all three or none");
  group_->add_option("--relative-humidity-percent,--humidity-percent,--humidity",
                     relative_humidity_percent_, "0 to 100, over water");
  group_->add_option("--pressure-pa", pressure_pa_, "Pressure at the surface: 50000 to 110000");
  group_->add_option("--wind-speed-m-s", wind_speed_m_s_, "Navy aerosol: now");
  group_->add_option("--wind-speed-24h-m-s", wind_speed_24h_m_s_,
                     "Navy aerosol: mean of the last 24 h; default: now");
  group_->add_option("--air-mass", air_mass_,
                     "Navy aerosol: 1 open ocean to 10 continental; default 3");
  group_->add_flag("--winter-troposphere", winter_troposphere_,
                   "Aerosol amounts above 2 km of autumn and winter");
  group_->add_option("--co2-ppmv", co2_ppmv_, "Default 425");
  group_->add_flag("--no-refraction", straight_, "Straight rays");
  if (use == Use::kLight) add_cloud_options();
}

void AirOptions::add_cloud_options() {
  for (const CloudOption& option : kCloudOptions) {
    const google::protobuf::FieldDescriptor* field =
        cloud_.GetDescriptor()->FindFieldByName(option.key);
    if (field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_STRING) {
      group_
          ->add_option_function<std::string>(
              option.name,
              [this, field](const std::string& value) {
                cloud_.GetReflection()->SetString(&cloud_, field, value);
              },
              option.about)
          ->type_name("NAME");
    } else {
      group_->add_option_function<double>(
          option.name,
          [this, field](double value) { cloud_.GetReflection()->SetDouble(&cloud_, field, value); },
          option.about);
    }
  }
}

absl::Status AirOptions::set_cloud(WeatherSpec& weather) const {
  if (cloud_.ByteSizeLong() == 0) return absl::OkStatus();
  const auto layer = stated_cloud_layer(cloud_);
  if (!layer.ok()) {
    // The options have the names of the keys.
    std::vector<std::pair<std::string, std::string>> names;
    for (const CloudOption& option : kCloudOptions) {
      const std::string key = option.key;
      names.emplace_back(absl::StrCat("cloud.", key), option.name);
      if (key.ends_with("_m")) names.emplace_back(key, option.name);
    }
    names.emplace_back(" (or cover_oktas, 0 to 8)", "");
    return absl::Status(layer.status().code(),
                        absl::StrReplaceAll(layer.status().message(), names));
  }
  ASSIGN_OR_RETURN(weather.cloud, cloud_from_message(*layer));
  weather.cloud_cover = cloud_.cover();
  return absl::OkStatus();
}

bool AirOptions::given() const {
  for (const CLI::Option* option : group_->get_options()) {
    if (option->count() > 0) return true;
  }
  return false;
}

absl::StatusOr<AirProfile> AirOptions::profile() const {
  if (profile_.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat("--profile is missing (or --sweep-file), expected one of ", profile_names()));
  }
  const auto base = afgl_profile_named(profile_);
  if (!base.ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat("--profile ", profile_, ": expected one of ", profile_names()));
  }
  AirProfile out = afgl_profile(*base);
  if (!profile_file_.empty()) {
    const auto text = read_user_file(profile_file_, kMostTableBytes);
    if (!text.ok()) {
      return absl::NotFoundError(absl::StrCat(profile_file_, ": ", text.status().message()));
    }
    auto sounding = parse_profile_csv(*text, profile_file_, out);
    if (!sounding.ok()) return sounding;
    out = *std::move(sounding);
  }
  const int stated = air_temperature_k_.has_value() + relative_humidity_percent_.has_value() +
                     pressure_pa_.has_value();
  if (stated == 0) return out;
  if (stated != 3) {
    return absl::InvalidArgumentError(
        "the weather at the surface is --air-temperature-k, --relative-humidity-percent and "
        "--pressure-pa together");
  }
  return bend_to_surface(out, {*air_temperature_k_, *relative_humidity_percent_, *pressure_pa_});
}

absl::StatusOr<AerosolSpec> AirOptions::aerosol() const {
  const auto kind = aerosol_named(aerosol_);
  if (!kind.ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat(aerosol_.empty() ? "--aerosol is missing, " : "--aerosol " + aerosol_ + ": ",
                     "expected one of ", aerosol_list()));
  }
  AerosolSpec out;
  out.kind = *kind;
  out.summer_troposphere = !winter_troposphere_;
  const bool navy = out.kind == AerosolKind::kNavyMaritime;
  if (!navy && (wind_speed_m_s_ || wind_speed_24h_m_s_ || air_mass_)) {
    return absl::InvalidArgumentError(
        "--wind-speed-m-s, --wind-speed-24h-m-s and --air-mass belong to --aerosol navy_maritime");
  }
  if (navy && !wind_speed_m_s_) {
    return absl::InvalidArgumentError("--aerosol navy_maritime needs --wind-speed-m-s");
  }
  if (out.kind == AerosolKind::kNone && visibility_m_) {
    return absl::InvalidArgumentError("--visibility-m belongs to an aerosol, not to none");
  }
  if (out.kind != AerosolKind::kNone && !navy && !visibility_m_) {
    return absl::InvalidArgumentError(
        absl::StrCat("--aerosol ", aerosol_, " needs --visibility-m"));
  }
  out.visibility_m = visibility_m_.value_or(0);
  out.wind_speed_m_s = wind_speed_m_s_.value_or(0);
  out.wind_speed_24h_m_s = wind_speed_24h_m_s_.value_or(out.wind_speed_m_s);
  out.air_mass = air_mass_.value_or(out.air_mass);
  return out;
}

absl::StatusOr<ChosenAir> AirOptions::of_sweep() const {
  for (const CLI::Option* option : group_->get_options()) {
    const std::string name = option->get_name();
    if (option->count() > 0 && name != "--sweep-file" && name != "--season") {
      return absl::InvalidArgumentError(
          absl::StrCat(name, " contradicts --sweep-file, which has it"));
    }
  }
  ASSIGN_OR_RETURN(auto file, load_sweep_file(sweep_));
  std::string model_bytes;
  if (file.sweep.model().has_file()) {
    const auto model =
        (std::filesystem::path(sweep_).parent_path() / file.sweep.model().file()).string();
    auto bytes = read_model_file(model, kMostModelBytes);
    if (!bytes.ok()) {
      return absl::InvalidArgumentError(absl::StrCat(model, ": ", bytes.status().message()));
    }
    model_bytes = *std::move(bytes);
  }
  ASSIGN_OR_RETURN(const auto sweep, resolve_sweep(file, model_bytes));
  if (!has_atmosphere(sweep)) {
    return absl::InvalidArgumentError(absl::StrCat(
        sweep_, ": air.model is \"", sweep.sweep().air().model(), "\", expected \"atmosphere\""));
  }
  std::vector<std::string> seasons;
  const schema::Condition* chosen = nullptr;
  for (const schema::Condition& c : sweep.condition()) {
    if (std::find(seasons.begin(), seasons.end(), c.season()) == seasons.end()) {
      seasons.push_back(c.season());
    }
    if (chosen == nullptr && (season_.empty() || c.season() == season_)) chosen = &c;
  }
  if (chosen == nullptr || (season_.empty() && seasons.size() > 1)) {
    return absl::InvalidArgumentError(
        absl::StrCat(season_.empty() ? "--season is missing, " : "--season " + season_ + ": ",
                     "expected one of ", comma_list(seasons)));
  }
  ASSIGN_OR_RETURN(const auto weather,
                   weather_from_message(chosen->weather(), chosen->surroundings()));
  ASSIGN_OR_RETURN(auto atmosphere, Atmosphere::make(weather.air));
  const schema::Place& place = sweep.sweep().place();
  return ChosenAir{
      std::move(atmosphere), weather,
      absl::StrCat(std::filesystem::path(sweep_).filename().string(), ", ", chosen->season(),
                   cloud_title(weather, chosen->weather().cloud().type())),
      ChosenAir::Place{place.latitude_deg(), place.longitude_deg(), place.height_m(),
                       chosen->time_utc()}};
}

absl::StatusOr<ChosenAir> AirOptions::choose() const {
  if (!sweep_.empty()) return of_sweep();
  if (!season_.empty()) return absl::InvalidArgumentError("--season belongs to --sweep-file");
  for (const auto& [key, name, value] :
       {Stated{"Season.visibility_m", "--visibility-m", visibility_m_},
        {"Season.air_temperature_k", "--air-temperature-k", air_temperature_k_},
        {"Season.relative_humidity_percent", "--relative-humidity-percent",
         relative_humidity_percent_},
        {"Season.pressure_pa", "--pressure-pa", pressure_pa_},
        {"Season.wind_speed_m_s", "--wind-speed-m-s", wind_speed_m_s_},
        {"Season.wind_speed_24h_m_s", "--wind-speed-24h-m-s", wind_speed_24h_m_s_},
        {"Air.air_mass", "--air-mass", air_mass_},
        {"Air.co2_ppmv", "--co2-ppmv", co2_ppmv_}}) {
    if (!value) continue;
    RETURN_IF_ERROR(check_number(key, name, *value));
  }
  WeatherSpec weather;
  ASSIGN_OR_RETURN(weather.air.profile, profile());
  ASSIGN_OR_RETURN(weather.air.aerosol, aerosol());
  weather.air.co2_ppmv = co2_ppmv_.value_or(weather.air.co2_ppmv);
  weather.refraction = !straight_;
  RETURN_IF_ERROR(set_cloud(weather));
  std::string title =
      absl::StrCat(profile_file_.empty() ? profile_ : profile_file_, ", aerosol ", aerosol_);
  if (visibility_m_) absl::StrAppendFormat(&title, " %g km", *visibility_m_ / 1000);
  if (air_temperature_k_) {
    absl::StrAppendFormat(&title, ", %g K, %g %% humidity", *air_temperature_k_,
                          *relative_humidity_percent_);
  }
  title += cloud_title(weather, cloud_.type());
  ASSIGN_OR_RETURN(auto atmosphere, Atmosphere::make(weather.air));
  weather.lower = {.kind = SurfaceBoundary::Kind::kGround,
                   .temperature_k = atmosphere.profile().level.front().temperature_k};
  return ChosenAir{std::move(atmosphere), std::move(weather), std::move(title), std::nullopt};
}

}  // namespace irsig
