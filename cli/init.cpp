#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"
#include "cli/commands.h"
#include "core/base/status_macros.h"
#include "core/base/user_file.h"
#include "core/scene/check/mesh_lint.h"
#include "core/scene/import/import_mesh.h"
#include "core/scene/import/model_file.h"
#include "core/thermal/weather_file.h"
#include "fmt/format.h"
#include "planning/load_sweep.h"
#include "planning/sweep_template.h"
#include "view/base/atomic_file.h"
#include "view/base/print.h"

namespace irsig {
namespace {

constexpr std::size_t kMostWeatherBytes = std::size_t{8} << 20;

struct InitCommand {
  TemplateAsked asked;
  AskedFrame frame;
  std::string model, place, weather, months, hours, out;
  bool force = false;

  [[nodiscard]] absl::Status run() {
    namespace fs = std::filesystem;
    const auto bytes = read_model_file(model, kMostModelBytes);
    if (!bytes.ok())
      return absl::InvalidArgumentError(
          fmt::format("--model {}: {}", model, std::string(bytes.status().message())));
    asked.how.file_name = model;
    asked.from = choose_frame(*bytes, frame, asked.how);
    auto mesh = import_mesh(*bytes, asked.how);
    if (!mesh.ok() && asked.how.reference == "origin") {
      // Maps and digital twins stand far from their origin.
      MeshImport around = asked.how;
      around.reference = "bbox_bottom_center";
      if (auto again = import_mesh(*bytes, around); again.ok()) {
        asked.how = around;
        mesh = std::move(again);
      }
    }
    if (!mesh.ok()) return mesh.status();
    if (!place.empty()) {
      const std::vector<std::string> numbers = absl::StrSplit(place, ',');
      if (numbers.size() != 2 || !absl::SimpleAtod(numbers[0], &asked.latitude_deg) ||
          !absl::SimpleAtod(numbers[1], &asked.longitude_deg))
        return absl::InvalidArgumentError(
            fmt::format("--place {}: expected LAT,LON in degrees, e.g. 54.3,10.1", place));
      asked.place_given = true;
    }
    RETURN_IF_ERROR(take_hours());
    const std::string stem = fs::path(model).stem().string();
    const bool to_stdout = out == "-";
    const fs::path file = out.empty() ? fs::path(stem + ".toml") : fs::path(out);
    asked.name = to_stdout ? stem : file.stem().string();
    std::error_code error;
    const fs::path folder =
        to_stdout || !file.has_parent_path() ? fs::path(".") : file.parent_path();
    const fs::path beside = fs::proximate(model, folder, error);
    asked.model_file = error ? fs::absolute(model).string() : beside.generic_string();
    RETURN_IF_ERROR(take_weather(folder));
    ASSIGN_OR_RETURN(auto text, sweep_template(asked, *mesh));
    if (!to_stdout && !force && fs::exists(file, error))
      return absl::InvalidArgumentError(
          fmt::format("--out {}: the file exists, expected a new one or --force", file.string()));
    // A file that `irsig run` refuses is not written.
    auto read = load_sweep_text(text, file.string());
    auto loaded = read.ok() ? try_sweep(*std::move(read), file.string(), {})
                            : absl::StatusOr<LoadedSweep>(read.status());
    if (!loaded.ok()) {
      print_note("irsig: {} is not written, since `irsig run` would refuse it:\n", file.string());
      return loaded.status();
    }
    if (to_stdout) {
      print_plain(stdout, text);
      return absl::OkStatus();
    }
    RETURN_IF_ERROR(replace_file(file.string(), text));
    // Warnings about the model are printed before the summary.
    for (const std::string& line : loaded->warnings) print_note("{}\n", line);
    LintOptions sheets;
    sheets.open_surfaces = true;  // two sides are proposed for them
    if (lint(*mesh, sheets).has_errors())
      print_note("irsig: note: the model has faults, which `irsig model check {}` lists\n", model);
    print_text(
        "{}: {} facets, {} part{}, {} viewpoints\n\n  irsig plan {}\n  irsig run {} --db {}\n",
        file.string(), mesh->triangle.size(), loaded->resolved.sweep().part_size(),
        loaded->resolved.sweep().part_size() == 1 ? "" : "s", loaded->resolved.viewpoint_size(),
        file.string(), file.string(), asked.name + ".sigdb");
    return absl::OkStatus();
  }

 private:
  [[nodiscard]] absl::Status take_hours() {
    if (!months.empty() && weather.empty())
      return absl::InvalidArgumentError(
          "--months: expected --weather FILE beside it, which has the weather of each month");
    if (!months.empty()) {
      const auto list = numbers_of_list(months, 1, 12);
      if (!list.ok())
        return absl::InvalidArgumentError(
            fmt::format("--months {}", std::string(list.status().message())));
      asked.months = *list;
    }
    if (hours.empty()) return absl::OkStatus();
    const auto list = numbers_of_list(hours, 0, 23);
    if (!list.ok())
      return absl::InvalidArgumentError(
          fmt::format("--hours {}", std::string(list.status().message())));
    asked.hours = *list;
    return absl::OkStatus();
  }

  // The place and the local standard time of a weather file of a typical year.
  [[nodiscard]] absl::Status take_weather(const std::filesystem::path& folder) {
    if (weather.empty()) return absl::OkStatus();
    const auto text = read_user_file(weather, kMostWeatherBytes);
    if (!text.ok())
      return absl::InvalidArgumentError(
          fmt::format("--weather {}: {}", weather, std::string(text.status().message())));
    ASSIGN_OR_RETURN(const WeatherFile file, read_weather_file(*text, weather));
    if (!file.any_year || !file.place)
      return absl::InvalidArgumentError(fmt::format(
          "--weather {}: expected EPW or TMY3, which state their place and have hours of any year; "
          "a CSV file is named by weather_file of a [[season]]",
          weather));
    if (!asked.place_given) {
      asked.latitude_deg = file.place->latitude_deg;
      asked.longitude_deg = file.place->longitude_deg;
    }
    asked.height_m = file.place->height_m;
    asked.utc_offset_h = file.utc_offset_h;
    std::error_code error;
    const std::filesystem::path beside = std::filesystem::proximate(weather, folder, error);
    asked.weather_file =
        error ? std::filesystem::absolute(weather).string() : beside.generic_string();
    return absl::OkStatus();
  }
};

}  // namespace

void add_init(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "init", "Write a commented sweep file for a model of your own, which runs as it is");
  const auto given = std::make_shared<InitCommand>();
  command->add_option("--model", given->model, "OBJ, PLY, STL, glTF or GLB")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--unit-m", given->frame.unit_m,
                   "Metres in the file's unit (what the file states, or 1)")
      ->type_name("M");
  command
      ->add_option("--forward-axis", given->frame.forward_axis,
                   "The file's axis that points to the bow: +x, -x, ... -z (glTF: +z, others: +x)")
      ->type_name("AXIS");
  command
      ->add_option("--up-axis", given->frame.up_axis,
                   "The file's axis that points up (glTF: +y, others: +z)")
      ->type_name("AXIS");
  command->add_option("--place", given->place, "Latitude and longitude [deg], e.g. 54.3,10.1")
      ->type_name("LAT,LON");
  command
      ->add_option("--season", given->asked.season,
                   "Name of the season: winter, spring, summer (default) or autumn")
      ->type_name("NAME");
  command
      ->add_option("--weather", given->weather,
                   "Compute temperatures from this weather file of a typical year (EPW or TMY3), "
                   "instead of assumed ones; the place is the file's")
      ->type_name("FILE");
  command
      ->add_option("--months", given->months,
                   "With --weather: a season on the 15th of each, such as 1-12 (default) or 1,7")
      ->type_name("LIST");
  command
      ->add_option("--hours", given->hours,
                   "Hours of the day, such as 0,6,12,18 (default: 12), in local standard time")
      ->type_name("LIST");
  command
      ->add_option("--surroundings", given->asked.surroundings,
                   "What it stands on: sea (default) or ground")
      ->check(CLI::IsMember({"sea", "ground"}))
      ->type_name("KIND");
  command
      ->add_option("-o,--out", given->out,
                   "Sweep file to write (the model's name, .toml, here); - is standard output")
      ->type_name("FILE");
  command->add_flag("--force", given->force, "Replace the file if it exists");
  command->callback([given, &exit_code] { exit_code = report(given->run()); });
}

}  // namespace irsig
