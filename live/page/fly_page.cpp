#include "live/page/fly_page.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <optional>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/spectral/band.h"
#include "core/spectral/planck.h"
#include "live/recorded_frame.h"
#include "messages/imager/imager_from_message.h"
#include "serve/guarded_page.h"
#include "serve/json_text.h"
#include "serve/www_files.h"

namespace irsig {

// The files of live/page/www.
[[nodiscard]] const std::vector<WwwFile>& fly_www_files();

namespace {

using Steady = std::chrono::steady_clock;

// A viewer that has asked for nothing for so long has left.
constexpr std::chrono::seconds kViewerStays{6};
// Before a refused request is answered: a client that only sends wrong ones gets no processor.
constexpr std::uint32_t kRefusedPauseMs = 100;
constexpr int kMostMinutes = 24 * 60;

absl::Status unknown(const std::string& name, const std::string& value, const std::string& wanted) {
  return absl::InvalidArgumentError(
      absl::StrCat(name, " is \"", value.substr(0, 40), "\", expected ", wanted));
}

PageReply json_page(std::string body) {
  return {.type = "application/json", .body = std::move(body), .keep_alive = true};
}

// The parameters of a request, each at most once, all of them known.
class Asked {
 public:
  explicit Asked(const Parameters& parameters) : parameters_(parameters) {}

  [[nodiscard]] absl::StatusOr<std::optional<double>> number(const std::string& name) {
    const auto found = take(name);
    if (!found) return std::optional<double>();
    double out = 0;
    if (!absl::SimpleAtod(*found, &out) || !std::isfinite(out))
      return unknown(name, *found, "a finite number");
    return std::optional(out);
  }
  [[nodiscard]] absl::StatusOr<std::optional<std::uint32_t>> count(const std::string& name,
                                                                   std::uint32_t below) {
    const auto found = take(name);
    if (!found) return std::optional<std::uint32_t>();
    std::uint32_t out = 0;
    if (!absl::SimpleAtoi(*found, &out) || out >= below)
      return unknown(name, *found, absl::StrCat("0 to ", below - 1));
    return std::optional(out);
  }
  [[nodiscard]] std::optional<std::string> take(const std::string& name) {
    const auto found = parameters_.find(name);
    if (found == parameters_.end()) return std::nullopt;
    std::string out = found->second;
    parameters_.erase(found);
    return out;
  }
  // INVALID_ARGUMENT: something is left.
  [[nodiscard]] absl::Status end() const {
    if (parameters_.empty()) return absl::OkStatus();
    return absl::InvalidArgumentError(absl::StrCat("\"", parameters_.begin()->first.substr(0, 40),
                                                   "\" is no parameter here, or is given twice"));
  }

 private:
  Parameters parameters_;
};

class FlyPage {
 public:
  FlyPage(LiveSession& session, const FlyOptions& options) : session_(session), options_(options) {}

  [[nodiscard]] PageReply reply_to(const RequestTarget& target) {
    auto reply = find(target);
    if (reply.ok()) return *std::move(reply);
    const absl::Status& status = reply.status();
    const int code = absl::IsNotFound(status) ? 404 : absl::IsInvalidArgument(status) ? 400 : 409;
    PageReply out = error_reply(code, std::string(status.message()));
    out.pause_ms = kRefusedPauseMs;
    return out;
  }

 private:
  absl::StatusOr<PageReply> find(const RequestTarget& target) {
    if (target.path == "/") return file("index.html");
    if (target.path.starts_with("/www/")) return file(target.path.substr(5));
    Asked asked(target.parameters);
    if (target.path == "/api/scene") return scene(asked);
    if (!target.path.starts_with("/api/")) return absl::NotFoundError("there is no such page here");
    RETURN_IF_ERROR(check_viewer(asked));
    if (target.path == "/api/leave") {
      const std::lock_guard lock(mutex_);
      viewer_.clear();
      return json_page("{}");
    }
    if (target.path == "/api/pick") {
      ASSIGN_OR_RETURN(const auto x, asked.count("x", kMostLiveSide));
      ASSIGN_OR_RETURN(const auto y, asked.count("y", kMostLiveSide));
      (void)asked.take("imager");
      ASSIGN_OR_RETURN(const auto ask, parse(asked));
      return pick(ask, x.value_or(0), y.value_or(0));
    }
    ASSIGN_OR_RETURN(const auto recorded, asked.count("imager", 2));
    ASSIGN_OR_RETURN(const auto ask, parse(asked));
    if (target.path == "/api/frame") {
      ASSIGN_OR_RETURN(auto picture, session_.picture(ask));
      if (recorded == 1u) {
        ASSIGN_OR_RETURN(picture.frame, record(ask, picture.frame));
      }
      return PageReply{
          .type = "application/octet-stream", .body = encode_picture(picture), .keep_alive = true};
    }
    if (target.path == "/api/sweep") {
      ASSIGN_OR_RETURN(auto text, options_.sweep_text(ask));
      return PageReply{
          .type = "text/plain; charset=utf-8", .body = std::move(text), .file_name = "view.toml"};
    }
    if (target.path == "/api/keep") {
      const std::lock_guard lock(keeping_);
      ASSIGN_OR_RETURN(const auto words, options_.keep(ask));
      JsonObject out;
      out.text("kept", words);
      return json_page(out.finish());
    }
    return absl::NotFoundError("there is no such page here");
  }

  // The camera of [imager] of the sweep.
  absl::StatusOr<LiveFrame> record(const LiveAsk& ask, const LiveFrame& frame) {
    const LiveSweep& sweep = session_.sweep();
    if (!sweep.resolved().sweep().has_imager())
      return absl::InvalidArgumentError("imager: the sweep has no [imager]: add it to the file");
    ASSIGN_OR_RETURN(const auto imager, imager_from_message(sweep.resolved().sweep().imager()));
    ASSIGN_OR_RETURN(const auto figures,
                     imager_in_band(imager, sweep.simulator().bands()[ask.band]));
    return recorded_frame(imager, figures, frame, ask.camera.pixel_rad(), ++recorded_);
  }

  static absl::StatusOr<PageReply> file(std::string_view name) {
    for (const WwwFile& f : fly_www_files()) {
      if (f.name != name) continue;
      const char* type = name.ends_with(".html")  ? "text/html; charset=utf-8"
                         : name.ends_with(".css") ? "text/css; charset=utf-8"
                         : name.ends_with(".svg") ? "image/svg+xml"
                                                  : "text/javascript; charset=utf-8";
      return PageReply{.type = type, .body = std::string(f.bytes), .keep_alive = true};
    }
    return absl::NotFoundError("there is no such file here");
  }

  // One viewer at a time: it has the seat as long as it asks.
  [[nodiscard]] absl::Status check_viewer(Asked& asked) {
    const std::string viewer = asked.take("viewer").value_or("");
    const std::lock_guard lock(mutex_);
    if (viewer.empty() || viewer != viewer_)
      return absl::FailedPreconditionError(
          viewer_.empty() ? "this page has no viewer now: load it again"
                          : "somebody else is flying: irsig fly has one viewer at a time; close "
                            "the other page, or start another irsig fly");
    seen_ = Steady::now();
    return absl::OkStatus();
  }

  absl::StatusOr<PageReply> scene(Asked& asked) {
    RETURN_IF_ERROR(asked.end());
    JsonObject out;
    {
      const std::lock_guard lock(mutex_);
      if (!viewer_.empty() && Steady::now() - seen_ < kViewerStays)
        return absl::FailedPreconditionError(
            "somebody else is flying: irsig fly has one viewer at a time; close the other page, or "
            "start another irsig fly");
      viewer_ = absl::StrCat("v", ++viewers_);
      seen_ = Steady::now();
      out.text("viewer", viewer_);
    }
    const LiveCamera& c = options_.first.camera;
    const Target& target = session_.sweep().simulator().target();
    out.text("title", options_.title);
    out.texts("conditions", options_.condition);
    out.texts("bands", options_.band);
    out.flag("keeps_hours", options_.keeps_hours);
    out.flag("has_air", session_.sweep().environment() != nullptr);
    out.numbers("camera", {c.azimuth_deg, c.elevation_deg, c.range_m, c.field_of_view_deg});
    out.numbers("target", {target.centre.x, target.centre.y, target.centre.z, target.radius_m});
    const schema::Sweep& sweep = session_.sweep().resolved().sweep();
    out.text("imager", !sweep.has_imager()         ? ""
                       : sweep.imager().has_name() ? sweep.imager().name()
                                                   : "[imager] of the sweep");
    out.count("condition", options_.first.condition);
    out.count("band", options_.first.band);
    std::vector<std::string> tables;
    for (const BandGrid& grid : session_.sweep().simulator().band_grids()) {
      std::vector<double> radiance;
      for (double kelvin = kFirstKelvin; kelvin < kLastKelvin; kelvin *= kKelvinStep) {
        double sum = 0;
        for (std::size_t i = 0; i < grid.node_um.size(); ++i)
          sum += grid.band_weight[i] * planck_radiance_w_m2_sr_um(grid.node_um[i], kelvin);
        radiance.push_back(sum);
      }
      JsonObject table;
      table.numbers("radiance", radiance);
      tables.push_back(table.finish());
    }
    out.numbers("kelvin", {kFirstKelvin, kKelvinStep});
    out.objects("blackbody", tables);
    return json_page(out.finish());
  }

  absl::StatusOr<PageReply> pick(const LiveAsk& ask, std::uint32_t x, std::uint32_t y) {
    ASSIGN_OR_RETURN(const auto found, session_.pick(ask, x, y));
    JsonObject out;
    out.text("what", found.what);
    out.number("range_m", found.range_m);
    out.number("temperature_k", found.temperature_k);
    out.flag("in_sun", found.in_sun);
    for (std::size_t k = 0; k < kLiveLights.size(); ++k) out.number(kLiveLights[k], found.light[k]);
    return json_page(out.finish());
  }

  // Every parameter has a default: the view with which the page begins.
  [[nodiscard]] absl::StatusOr<LiveAsk> parse(Asked& asked) const {
    LiveAsk out = options_.first;
    LiveCamera& c = out.camera;
    for (const auto& [name, to] : {std::pair{"azimuth_deg", &c.azimuth_deg},
                                   {"elevation_deg", &c.elevation_deg},
                                   {"range_m", &c.range_m},
                                   {"field_of_view_deg", &c.field_of_view_deg},
                                   {"look_x_m", &c.look_at_m.x},
                                   {"look_y_m", &c.look_at_m.y},
                                   {"look_z_m", &c.look_at_m.z}}) {
      ASSIGN_OR_RETURN(const auto value, asked.number(name));
      if (value) *to = *value;
    }
    for (const auto& [name, to, below] :
         {std::tuple{"width_px", &c.width_px, kMostLiveSide + 1},
          {"height_px", &c.height_px, kMostLiveSide + 1},
          {"condition", &out.condition, static_cast<std::uint32_t>(options_.condition.size())},
          {"band", &out.band, static_cast<std::uint32_t>(options_.band.size())},
          {"samples", &out.samples, 5u}}) {
      ASSIGN_OR_RETURN(const auto value, asked.count(name, below));
      if (value) *to = *value;
    }
    ASSIGN_OR_RETURN(out.minute, asked.count("minute_utc", kMostMinutes));
    if (out.minute && options_.keeps_hours)
      return absl::InvalidArgumentError(
          "minute_utc: the temperatures of this sweep are computed for "
          "its own times; choose one of its conditions");
    ASSIGN_OR_RETURN(out.visibility_m, asked.number("visibility_m"));
    constexpr double kLeastM = 100, kMostM = 300e3;
    if (out.visibility_m && !(*out.visibility_m >= kLeastM && *out.visibility_m <= kMostM))
      return absl::InvalidArgumentError(absl::StrCat("visibility_m is ", *out.visibility_m,
                                                     ", expected ", kLeastM, " to ", kMostM));
    for (const auto& [name, to] : {std::pair{"sun", &out.effects.sun},
                                   {"sky", &out.effects.sky},
                                   {"parts", &out.effects.parts}}) {
      ASSIGN_OR_RETURN(const auto value, asked.count(name, 2));
      if (value) *to = *value == 1;
    }
    if (const auto light = asked.take("light")) {
      const auto found = std::find(kLiveLights.begin(), kLiveLights.end(), *light);
      if (found == kLiveLights.end())
        return unknown("light", *light, "total, emitted, sun, reflected or air");
      out.light = static_cast<LiveLight>(found - kLiveLights.begin());
    }
    RETURN_IF_ERROR(asked.end());
    RETURN_IF_ERROR(check_camera(c));
    return out;
  }

  static constexpr double kFirstKelvin = 100, kLastKelvin = 3000, kKelvinStep = 1.01;

  LiveSession& session_;
  const FlyOptions& options_;
  std::mutex mutex_, keeping_;
  std::string viewer_;
  Steady::time_point seen_;
  std::uint64_t viewers_ = 0;
  std::atomic<std::uint64_t> recorded_{0};  // frames, each with noise of its own
};

}  // namespace

absl::Status serve_flight(LiveSession& session, const FlyOptions& options) {
  FlyPage page(session, options);
  return serve_guarded(
      {.command = "irsig fly",
       .address = options.address,
       .port = options.port,
       .loopback_only = true,
       .answer = [&](const RequestTarget& target) { return page.reply_to(target); },
       .on_ready = [&](const std::string& url, const ListenAddress&) { options.on_ready(url); }});
}

}  // namespace irsig
