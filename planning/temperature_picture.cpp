#include "planning/temperature_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/status_macros.h"
#include "core/geo/sun.h"
#include "core/scene/trace/target.h"

namespace irsig {
namespace {

// An image plane across a direction of view.
struct PicturePlane {
  Vec<Body> to_sensor, right, up;        // unit vectors; up is the direction of growing elevation
  double x0_m, y0_m, width_m, height_m;  // the target's bounding rectangle about its centre
};

PicturePlane plane_of(const Target& target, const SignatureFilter::Direction& aspect) {
  PicturePlane out{};
  const double az = aspect.aspect_azimuth_deg * std::numbers::pi / 180;
  const double el = aspect.aspect_elevation_deg * std::numbers::pi / 180;
  out.to_sensor = body_from_aspect(aspect.aspect_azimuth_deg, aspect.aspect_elevation_deg);
  out.up = {-std::sin(el) * std::cos(az), -std::sin(el) * std::sin(az), -std::cos(el)};
  out.right = cross(-1.0 * out.to_sensor, out.up);
  double x_low = 1e300, x_high = -1e300, y_low = 1e300, y_high = -1e300;
  for (std::size_t i = 0; i + 2 < target.vertex.size(); i += 3) {
    const Vec<Body> at{target.vertex[i], target.vertex[i + 1], target.vertex[i + 2]};
    const double x = dot(at, out.right), y = dot(at, out.up);
    x_low = std::min(x_low, x);
    x_high = std::max(x_high, x);
    y_low = std::min(y_low, y);
    y_high = std::max(y_high, y);
  }
  // A target seen edge-on still gets a rectangle of positive area.
  const double least = 1e-5 * target.radius_m;
  out.x0_m = x_low;
  out.y0_m = y_low;
  out.width_m = std::max(x_high - x_low, least);
  out.height_m = std::max(y_high - y_low, least);
  return out;
}

// [pixel] The facet that it shows, RayPacket::kMiss: none.
std::vector<std::uint32_t> facets_seen(const Target& target, const PicturePlane& plane,
                                       std::uint32_t width_px, std::uint32_t height_px) {
  const std::size_t pixels = static_cast<std::size_t>(width_px) * height_px;
  std::vector<std::uint32_t> out(pixels, RayPacket::kMiss);
  const double begin_m = 1.01 * target.radius_m;
  for (std::size_t first = 0; first < pixels; first += RayPacket::kSize) {
    RayPacket packet{};
    const auto count = static_cast<int>(std::min<std::size_t>(RayPacket::kSize, pixels - first));
    for (int lane = 0; lane < RayPacket::kSize; ++lane) {
      const std::size_t pixel = first + static_cast<std::size_t>(lane);
      const double x =
          plane.x0_m + (static_cast<double>(pixel % width_px) + 0.5) / width_px * plane.width_m;
      const double y = plane.y0_m + plane.height_m -
                       (static_cast<double>(pixel / width_px) + 0.5) / height_px * plane.height_m;
      const Vec<Body> at = begin_m * plane.to_sensor + x * plane.right + y * plane.up;
      packet.org_x[lane] = static_cast<float>(at.x);
      packet.org_y[lane] = static_cast<float>(at.y);
      packet.org_z[lane] = static_cast<float>(at.z);
      packet.dir_x[lane] = static_cast<float>(-plane.to_sensor.x);
      packet.dir_y[lane] = static_cast<float>(-plane.to_sensor.y);
      packet.dir_z[lane] = static_cast<float>(-plane.to_sensor.z);
      packet.tfar[lane] = lane < count ? std::numeric_limits<float>::infinity() : -1.0f;
      packet.mask[lane] = ~0U;
      packet.geometry[lane] = packet.triangle[lane] = packet.instance[lane] = RayPacket::kMiss;
    }
    target.tracer->intersect(packet, count, true);
    for (int lane = 0; lane < count; ++lane)
      if (packet.geometry[lane] != RayPacket::kMiss)
        out[first + static_cast<std::size_t>(lane)] = packet.triangle[lane];
  }
  return out;
}

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kListed = 12;
  const std::size_t shown = std::min(names.size(), kListed);
  std::string out;
  for (std::size_t i = 0; i < shown; ++i) out += "\n  " + names[i];
  if (shown < names.size()) out += fmt::format("\n  and {} more", names.size() - shown);
  return out;
}

std::string condition_name(const schema::Condition& c) { return c.season() + " " + c.time_utc(); }

// The only condition of a season and a time, where these are given.
absl::StatusOr<int> choose_condition(const schema::ResolvedSweep& sweep, const NameSet& season,
                                     const std::string& time) {
  std::string time_utc;
  if (!time.empty()) {
    ASSIGN_OR_RETURN(const auto parsed, parse_rfc3339(time));
    time_utc = format_rfc3339_utc(parsed);
  }
  std::vector<int> found;
  std::vector<std::string> names, all;
  for (int c = 0; c < sweep.condition_size(); ++c) {
    const schema::Condition& condition = sweep.condition(c);
    all.push_back(condition_name(condition));
    if (!season.admits(condition.season())) continue;
    if (!time_utc.empty() && condition.time_utc() != time_utc) continue;
    found.push_back(c);
    names.push_back(all.back());
  }
  if (found.size() == 1) return found.front();
  if (found.empty())
    return absl::NotFoundError("no condition has this season and time; there are:" + listed(all));
  return absl::InvalidArgumentError(
      "a picture of temperatures shows one condition, choose it with --season and --time:" +
      listed(names));
}

absl::Status check_filters(const Query& query) {
  if (query.row) {
    if (!query.season.empty() || !query.time.empty() || query.aspect)
      return absl::InvalidArgumentError(
          "a picture of temperatures is of a row, or of --season, --time and --aspect");
  } else if (!query.aspect) {
    return absl::InvalidArgumentError(
        "a picture of temperatures needs --aspect AZ,EL, or the --row of a signature");
  }
  if (!query.band.empty() || query.nearest > 0 || query.within_deg || query.interpolate ||
      query.max_relative_error || query.at_range_m ||
      query.quantity != SignatureQuantity::kIntensity)
    return absl::InvalidArgumentError(
        "temperatures are of facets, not of signatures: expected --sweep, --season, --time and "
        "--aspect, or --row, and no other filter");
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<FalseColorPicture> draw_temperatures(const SweepFacets& facets, int condition,
                                                    const SignatureFilter::Direction& aspect,
                                                    std::uint32_t long_side_px) {
  ASSIGN_OR_RETURN(const auto target,
                   make_target(facets.scene().mesh, facets.scene().part, widest_isa()));
  const PicturePlane plane = plane_of(target, aspect);
  const double pixel_m = std::max(plane.width_m, plane.height_m) / long_side_px;
  const auto side = [&](double side_m) {
    return std::max<std::uint32_t>(1, static_cast<std::uint32_t>(std::lround(side_m / pixel_m)));
  };
  FalseColorPicture out;
  const schema::ResolvedSweep& sweep = facets.sweep();
  out.title = fmt::format("{}, {}, azimuth {:.1f}\u00b0, elevation {:.1f}\u00b0",
                          sweep.sweep().name(), condition_name(sweep.condition(condition)),
                          aspect.aspect_azimuth_deg, aspect.aspect_elevation_deg);
  out.subtitle = "Temperatures of facets, parallel projection";
  out.width_px = side(plane.width_m);
  out.height_px = side(plane.height_m);
  for (const std::uint32_t facet : facets_seen(target, plane, out.width_px, out.height_px))
    out.value.push_back(facet == RayPacket::kMiss
                            ? std::numeric_limits<float>::quiet_NaN()
                            : static_cast<float>(facets.temperature(condition, facet).kelvin));
  ASSIGN_OR_RETURN(const auto range, range_of(out.value));
  out.range = range;
  out.axis = bar_axis("Temperature in K", out.range);
  return out;
}

absl::StatusOr<FalseColorPicture> temperature_picture(const std::string& database,
                                                      const Query& query,
                                                      const std::optional<ColorRange>& range,
                                                      std::uint32_t long_side_px) {
  RETURN_IF_ERROR(check_filters(query));
  Query asked = query;
  if (query.row) {
    ASSIGN_OR_RETURN(auto reader, StoreReader::open(database));
    ASSIGN_OR_RETURN(const auto rows, run_query(*reader, query));
    if (rows.size() != 1)
      return absl::InvalidArgumentError("--row: several sweeps have it, choose one with --sweep");
    const StoredSignature& s = rows.front().signature;
    asked.sweep = s.sweep;
    asked.season = s.season;
    asked.time = s.time_utc;
    asked.aspect = {s.aspect_azimuth_deg, s.aspect_elevation_deg};
  }
  ASSIGN_OR_RETURN(const auto facets, SweepFacets::load(database, asked.sweep));
  RETURN_IF_ERROR(facets.check_seasons(asked.season));
  ASSIGN_OR_RETURN(const auto condition,
                   choose_condition(facets.sweep(), asked.season, asked.time));
  auto picture = draw_temperatures(facets, condition, *asked.aspect, long_side_px);
  if (!picture.ok() || !range) return picture;
  picture->range = *range;
  picture->axis = bar_axis(picture->axis.title, *range);
  return picture;
}

}  // namespace irsig
