#include "view/pictures/sky_picture.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "core/base/status_macros.h"
#include "core/geo/sun.h"
#include "messages/environment/sweep_environment.h"
#include "view/pictures/band_quadrature.h"

namespace irsig {
namespace {

// Radius of the sky, as a fraction of half of the picture's side: labels stand around it.
constexpr double kSkyRadius = 0.9;
constexpr double kDegPerRad = 180 / std::numbers::pi;

// Lambert azimuthal equal-area projection of the upper hemisphere.  [snyder1987, eq. 24-1]
class SkyDisk {
 public:
  explicit SkyDisk(std::uint32_t side_px) : center_(0.5 * side_px), radius_(kSkyRadius * center_) {}

  struct Place {
    double x_px, y_px;
  };
  [[nodiscard]] Place at(double azimuth_rad, double zenith_rad) const {
    const double r = radius_ * std::sin(zenith_rad / 2) * std::numbers::sqrt2;
    return {center_ + r * std::sin(azimuth_rad), center_ - r * std::cos(azimuth_rad)};
  }
  [[nodiscard]] Place at(Vec<Body> v) const {
    return at(std::atan2(v.y, v.x), std::acos(std::clamp(-v.z, -1.0, 1.0)));
  }
  // The direction at the middle of a pixel; nullopt outside the disk.
  [[nodiscard]] std::optional<Vec<Body>> direction(std::uint32_t column, std::uint32_t row) const {
    const double x = column + 0.5 - center_, y = center_ - row - 0.5;
    const double r = std::hypot(x, y) / radius_;
    if (r > 1) return std::nullopt;
    const double up = 1 - r * r, level = std::sqrt(std::max(0.0, 1 - up * up));
    const double azimuth = std::atan2(x, y);
    return Vec<Body>{level * std::cos(azimuth), level * std::sin(azimuth), -up};
  }

 private:
  double center_, radius_;
};

std::string title_of(const schema::Condition& c) { return c.season() + " " + c.time_utc(); }

std::string cloud_of(const schema::Weather& weather) {
  if (weather.cloud_cover() <= 0) return "no cloud";
  const std::string& type = weather.cloud().type();
  return fmt::format("{} cover {:g}", type.empty() ? "cloud" : type, weather.cloud_cover());
}

void add_labels(FalseColorPicture& picture, const SkyDisk& disk, double heading_deg,
                const SunSeen* sun) {
  // A label begins at its place: half of a letter's size moves its first letter there.
  const double half_px = 0.007 * picture.width_px;
  const auto add = [&](SkyDisk::Place at, const char* text) {
    picture.label.push_back({at.x_px - half_px, at.y_px + half_px, text});
  };
  constexpr double kOutside = 1.64;  // zenith angle [rad] of labels around the horizon
  add(disk.at(0, kOutside), "bow");
  const char* const wind[] = {"N", "E", "S", "W"};
  for (int i = 0; i < 4; ++i) {
    const double azimuth_deg = 90 * i - heading_deg;
    // The bow has its own label.
    if (std::abs(std::remainder(azimuth_deg, 360)) < 8) continue;
    add(disk.at(azimuth_deg / kDegPerRad, kOutside), wind[i]);
  }
  if (sun) add(disk.at(sun->middle), "+ sun");
}

// Condition and band of a query.
struct ChosenSky {
  std::string sweep, season, time_utc, band;
};

absl::StatusOr<ChosenSky> of_row(StoreReader& reader, const Query& query) {
  ASSIGN_OR_RETURN(const auto rows, run_query(reader, query));
  if (rows.size() != 1)
    return absl::InvalidArgumentError("--row: several sweeps have it, choose one with --sweep");
  const StoredSignature& s = rows.front().signature;
  return ChosenSky{s.sweep, s.season, s.time_utc, s.band};
}

absl::StatusOr<std::string> only_one(const std::vector<std::string>& names, const char* what,
                                     const char* option) {
  if (names.size() == 1) return names.front();
  std::vector<std::string> some(names.begin(),
                                names.begin() + std::min<std::ptrdiff_t>(12, std::ssize(names)));
  return absl::InvalidArgumentError(
      fmt::format("a picture of the sky is of one {}, choose it with {}: {}{}", what, option,
                  fmt::join(some, ", "), some.size() < names.size() ? ", ..." : ""));
}

absl::StatusOr<ChosenSky> choose_sky(StoreReader& reader, const Query& query) {
  if (query.aspect || query.nearest > 0 || query.within_deg || query.interpolate ||
      query.max_relative_error || query.at_range_m)
    return absl::InvalidArgumentError(
        "the sky is of a condition, not of a signature: expected --sweep, --season, --time and "
        "--band, or --row, and no other filter");
  if (query.row) return of_row(reader, query);
  RETURN_IF_ERROR(check_seasons(reader, query.season));
  std::string time_utc;
  if (!query.time.empty()) {
    ASSIGN_OR_RETURN(const auto parsed, parse_rfc3339(query.time));
    time_utc = format_rfc3339_utc(parsed);
  }
  ASSIGN_OR_RETURN(const auto contents, reader.contents());
  ChosenSky out{query.sweep, "", "", query.band};
  if (out.sweep.empty()) {
    std::vector<std::string> names;
    for (const SweepContents& s : contents) names.push_back(s.name);
    ASSIGN_OR_RETURN(out.sweep, only_one(names, "sweep", "--sweep"));
  }
  const auto sweep = std::find_if(contents.begin(), contents.end(),
                                  [&](const SweepContents& s) { return s.name == out.sweep; });
  if (sweep == contents.end())
    return absl::NotFoundError(fmt::format("no sweep \"{}\" in this database", out.sweep));
  std::vector<std::string> conditions, bands, known;
  for (const auto& c : sweep->condition) {
    known.push_back(c.season + " " + c.time_utc);
    if (!query.season.admits(c.season) || (!time_utc.empty() && c.time_utc != time_utc)) continue;
    conditions.push_back(known.back());
    out.season = c.season;
    out.time_utc = c.time_utc;
  }
  if (conditions.empty())
    return absl::NotFoundError(fmt::format("no condition has this season and time; there are: {}",
                                           fmt::join(known, ", ")));
  RETURN_IF_ERROR(only_one(conditions, "condition", "--season and --time").status());
  if (out.band.empty()) {
    for (const auto& b : sweep->band) bands.push_back(b.name);
    ASSIGN_OR_RETURN(out.band, only_one(bands, "band", "--band"));
  }
  return out;
}

}  // namespace

absl::StatusOr<FalseColorPicture> draw_sky(const schema::ResolvedSweep& sweep, int condition,
                                           const schema::Band& band, std::uint32_t side_px) {
  if (!has_atmosphere(sweep))
    return absl::FailedPreconditionError(
        fmt::format("air.model \"{}\" has the same sky in all directions: a picture of it needs a "
                    "sweep with air.model = \"atmosphere\"",
                    sweep.sweep().air().model()));
  schema::ResolvedSweep one = sweep;
  one.clear_condition();
  schema::Condition& c = *one.add_condition();
  c = sweep.condition(condition);
  c.mutable_weather()->clear_modtran_text();  // of lines of sight alone
  ASSIGN_OR_RETURN(const auto quadrature, band_quadrature(band, spectral_breaks_um(sweep)));
  ASSIGN_OR_RETURN(const auto environment, environment_of(one, quadrature.grid.node_um));
  // Any short line of sight has the same sky around the target.
  constexpr Viewpoint kNear = {0, 45, 10};
  const std::uint32_t first = 0;
  ASSIGN_OR_RETURN(const auto views, environment->view(environment->line(kNear), {&first, 1}));
  const DirectionNodes& nodes = environment->nodes();
  const std::vector<double> radiance =
      views.front().around.integrals(0, quadrature.grid.band_weight, nullptr, 1).source;

  const SkyDisk disk(side_px);
  FalseColorPicture out;
  out.title = fmt::format("Sky of {}, {}, {} ({:g} to {:g} \u00b5m)", sweep.sweep().name(),
                          title_of(c), band.name(), band.lambda_min_um(), band.lambda_max_um());
  out.width_px = out.height_px = side_px;
  for (std::uint32_t y = 0; y < side_px; ++y) {
    for (std::uint32_t x = 0; x < side_px; ++x) {
      double sum = std::numeric_limits<double>::quiet_NaN();
      if (const std::optional<Vec<Body>> d = disk.direction(x, y)) {
        DirectionNodes::Share share[4];
        const int n = nodes.shares(static_cast<float>(d->x), static_cast<float>(d->y),
                                   static_cast<float>(std::min(d->z, -1e-6)), share);
        sum = 0;
        for (int i = 0; i < n; ++i)
          sum += static_cast<double>(share[i].weight) * radiance[share[i].node];
      }
      out.value.push_back(static_cast<float>(sum));
    }
  }
  const SunSeen& seen = environment->sun_seen(0);
  const bool sun = sweep.sweep().transport().sun() && seen.lights_air;
  out.subtitle =
      fmt::format("Seen from above, equal area, {}, {}", cloud_of(c.weather()),
                  sun ? fmt::format("sun {:.1f}\u00b0 from the zenith, without its disk",
                                    std::acos(std::clamp(-seen.middle.z, -1.0, 1.0)) * kDegPerRad)
                      : "no sun");
  add_labels(out, disk, sweep.sweep().place().heading_deg(), sun ? &seen : nullptr);
  ASSIGN_OR_RETURN(out.range, range_of(out.value));
  out.axis = bar_axis("In-band radiance in W/(m\u00b2 sr)", out.range);
  out.other = temperature_axis(quadrature, out.range);
  return out;
}

absl::StatusOr<FalseColorPicture> sky_picture(StoreReader& reader, const Query& query,
                                              const std::optional<ColorRange>& range,
                                              std::uint32_t side_px) {
  ASSIGN_OR_RETURN(const auto chosen, choose_sky(reader, query));
  ASSIGN_OR_RETURN(const auto stored, reader.sweep(chosen.sweep, SweepFiles::kNone));
  const schema::ResolvedSweep& sweep = stored.resolved;
  const auto& bands = sweep.sweep().band();
  const auto band = std::find_if(bands.begin(), bands.end(),
                                 [&](const schema::Band& b) { return b.name() == chosen.band; });
  if (band == bands.end())
    return absl::NotFoundError(
        fmt::format("no band \"{}\" in sweep \"{}\"", chosen.band, chosen.sweep));
  for (int i = 0; i < sweep.condition_size(); ++i) {
    const schema::Condition& c = sweep.condition(i);
    if (c.season() != chosen.season || c.time_utc() != chosen.time_utc) continue;
    auto picture = draw_sky(sweep, i, *band, side_px);
    if (!picture.ok() || !range) return picture;
    ASSIGN_OR_RETURN(const auto quadrature, band_quadrature(*band));
    picture->range = *range;
    picture->axis = bar_axis(picture->axis.title, *range);
    picture->other = temperature_axis(quadrature, *range);
    return picture;
  }
  return absl::FailedPreconditionError(
      "the row is of an earlier version of the sweep, whose conditions are no longer stored");
}

}  // namespace irsig
