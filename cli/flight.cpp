#include "cli/flight.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "cli/output_options.h"
#include "core/base/constants.h"
#include "core/base/run_subprocess.h"
#include "core/base/status_macros.h"
#include "core/base/user_file.h"
#include "core/image/image.h"
#include "jobs/resolve_sweep.h"
#include "jobs/text/edit_sweep.h"
#include "live/film.h"
#include "messages/imager/imager_from_message.h"

namespace irsig {

absl::StatusOr<Flight> Flight::load(const std::string& path) {
  Flight out;
  out.path_ = path;
  ASSIGN_OR_RETURN(out.loaded_, load_sweep(path, {}));
  RETURN_IF_ERROR(have_temperatures(out.loaded_));
  const auto text = read_user_file(path, kMostSpecBytes);
  if (!text.ok()) return text.status();
  out.text_ = *text;
  const schema::Viewpoint& v = out.loaded_.resolved.viewpoint(0);
  LiveCamera& camera = out.first_.camera;
  camera.azimuth_deg = v.aspect_azimuth_deg();
  camera.elevation_deg = std::clamp(v.aspect_elevation_deg(), -89.0, 89.0);
  camera.range_m = v.range_m();
  // The scene is built once more by the session; here only how large the target is.
  ASSIGN_OR_RETURN(const auto scene,
                   scene_from_sweep(out.loaded_.resolved, out.loaded_.assets, out.loaded_.heat));
  ASSIGN_OR_RETURN(const auto target, make_target(scene.mesh, scene.part, scene.isa));
  camera.look_at_m = target.centre;
  constexpr double kInView = 2.6;  // of the target's radius, on both sides together
  camera.field_of_view_deg =
      std::clamp(kInView * std::atan(target.radius_m / camera.range_m) / kRadPerDeg, 0.05, 60.0);
  return out;
}

std::vector<std::string> Flight::conditions() const {
  std::vector<std::string> out;
  for (const schema::Condition& c : loaded_.resolved.condition())
    out.push_back(absl::StrCat(c.season(), " ", c.time_utc()));
  return out;
}

std::vector<std::string> Flight::bands() const {
  std::vector<std::string> out;
  for (const schema::Band& band : loaded_.resolved.sweep().band()) out.push_back(band.name());
  return out;
}

absl::StatusOr<std::string> Flight::edited(const LiveAsk& ask, const std::string& name,
                                           bool camera) const {
  if (ask.condition >= static_cast<std::uint32_t>(loaded_.resolved.condition_size()))
    return absl::InvalidArgumentError("condition is beyond those of the sweep");
  const schema::Condition& condition = loaded_.resolved.condition(static_cast<int>(ask.condition));
  SweepEdit edit;
  edit.name = name;
  edit.condition = ask.condition;
  edit.season = condition.season_index();
  edit.time = condition.time_index();
  if (ask.minute)
    edit.time_of_day = absl::StrCat(absl::Dec(*ask.minute / 60, absl::kZeroPad2), ":",
                                    absl::Dec(*ask.minute % 60, absl::kZeroPad2), "Z");
  edit.visibility_m = ask.visibility_m;
  if (!(ask.effects == LiveEffects{})) {
    edit.choose_effects = true;
    edit.only = names_of(ask.effects);
  }
  if (camera) {
    const LiveCamera& c = ask.camera;
    ASSIGN_OR_RETURN(const Vec<Body> look_at_m, look_at_of_sweep(c));
    edit.camera = SweepEdit::Camera{c.azimuth_deg,
                                    c.elevation_deg,
                                    c.range_m,
                                    c.field_of_view_deg,
                                    {look_at_m.x, look_at_m.y, look_at_m.z},
                                    c.width_px,
                                    c.height_px,
                                    kStoredPixelErrorPercent};
    if (const schema::Sweep& sweep = loaded_.resolved.sweep(); sweep.has_imager()) {
      ASSIGN_OR_RETURN(const auto imager, imager_from_message(sweep.imager()));
      edit.without_imager = imager.ifov_rad() < 2 * c.pixel_rad();
    }
  }
  return edit_sweep(text_, path_, edit);
}

absl::StatusOr<LiveInput> Flight::input(const LiveAsk& ask) const {
  ASSIGN_OR_RETURN(const auto text, edited(ask, "live", false));
  ASSIGN_OR_RETURN(auto file, load_sweep_text(text, path_));
  std::string model;
  if (const auto found = loaded_.assets.find(loaded_.resolved.model_sha256());
      found != loaded_.assets.end())
    model = found->second;
  ASSIGN_OR_RETURN(auto resolved, resolve_sweep(file, model));
  LiveInput out{std::move(resolved), loaded_.assets, {}};
  if (awaits_temperatures(out.resolved, out.heat)) {
    LoadedSweep one;
    one.file = std::move(file);
    one.resolved = out.resolved;
    one.assets = out.assets;
    RETURN_IF_ERROR(have_temperatures(one));
    out.heat = std::move(one.heat);
  }
  return out;
}

absl::StatusOr<std::string> Flight::view_text(const LiveAsk& ask, const std::string& name) const {
  return edited(ask, name, true);
}

absl::StatusOr<std::string> keep_view(const Flight& flight, const LiveAsk& ask,
                                      std::uint32_t number, const std::string& db) {
  const std::filesystem::path sweep(flight.path());
  std::string name;
  std::filesystem::path file;
  do {  // a sweep that is there already is not replaced
    name = absl::StrCat(flight.loaded().resolved.sweep().name(), "_view", number++);
    file = sweep.parent_path() / (name + ".toml");
  } while (std::filesystem::exists(file));
  ASSIGN_OR_RETURN(const auto text, flight.view_text(ask, name));
  std::ofstream to(file, std::ios::binary);
  to << text;
  to.close();
  if (!to)
    return absl::UnavailableError(
        absl::StrCat(file.string(), ": the sweep of this view cannot be written there"));
  constexpr ApartLimits kLimits{std::uint64_t{1} << 36, 3600, 3600};
  ASSIGN_OR_RETURN(
      const auto said,
      run_subprocess(program_beside("irsig"), {"run", file.string(), "--db", db, "--workers", "1"},
                     "", kLimits));
  return absl::StrCat("kept as the sweep \"", name, "\" in ", db, "; its file is ", file.string());
}

absl::Status write_film(const Flight& flight, std::uint32_t threads, const std::string& path) {
  LiveAsk ask = flight.first();
  constexpr std::uint32_t kStep = 30, kDay = 24 * 60;
  constexpr std::uint16_t kPauseMs = 100;
  ask.minute = 0;
  ask.samples = 4;
  ASSIGN_OR_RETURN(
      const auto session,
      LiveSession::open([&](const LiveAsk& of) { return flight.input(of); }, ask, threads));
  std::vector<LiveFrame> frame;
  std::vector<float> all;
  for (std::uint32_t minute = 0; minute < kDay; minute += kStep) {
    ask.minute = minute;
    ASSIGN_OR_RETURN(auto picture, session->picture(ask));
    if (picture.frame.lacks_gas)
      return absl::UnimplementedError(
          "the hot gas of this sweep is in no moving frame, as its light cannot be tabulated "
          "(imported air): take [plume] out of a copy of the sweep file, or compute its images "
          "with "
          "irsig run");
    all.insert(all.end(), picture.frame.radiance_w_m2_sr.begin(),
               picture.frame.radiance_w_m2_sr.end());
    frame.push_back(std::move(picture.frame));
  }
  // One scale for all: the middle 99.5 % of the day.
  const auto place = [&](double f) {
    const auto at =
        all.begin() + static_cast<std::ptrdiff_t>(f * static_cast<double>(all.size() - 1));
    std::nth_element(all.begin(), at, all.end());
    return static_cast<double>(*at);
  };
  const double low = place(0.0025), high = std::max(place(0.9975), low * (1 + 1e-6) + 1e-30);
  std::vector<std::string> still;
  for (const LiveFrame& f : frame) {
    std::vector<std::uint16_t> grey;
    for (const float radiance : f.radiance_w_m2_sr)
      grey.push_back(static_cast<std::uint16_t>(
          std::clamp(255 * (static_cast<double>(radiance) - low) / (high - low), 0.0, 255.0)));
    ASSIGN_OR_RETURN(auto png, encode_grey_png(f.width_px, f.height_px, grey, 8));
    still.push_back(std::move(png));
  }
  ASSIGN_OR_RETURN(const auto film, animated_png(still, kPauseMs));
  std::ofstream to(path, std::ios::binary);
  to << film;
  to.close();
  if (!to) return absl::UnavailableError(absl::StrCat(path, ": cannot be written"));
  return absl::OkStatus();
}

}  // namespace irsig
