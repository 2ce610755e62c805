#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/geo/viewpoint.h"
#include "jobs/resolve.h"

namespace irsig {
namespace {

// [0, 360), and no negative zero.
double normalized_azimuth_deg(double azimuth_deg) {
  double turned = std::fmod(azimuth_deg, 360.0);
  if (turned < 0) turned += 360.0;
  return turned >= 360.0 || turned == 0 ? 0.0 : turned;
}

void check_aspects(const schema::Viewpoints& set, Findings& findings) {
  for (int i = 0; i < set.aspect_size(); ++i) {
    const schema::Aspect& aspect = set.aspect(i);
    const SectionCheck check(aspect, absl::StrCat("viewpoints.aspect[", i, "]"), findings);
    check.require({"azimuth_deg"}, "expected degrees: 0 bow-on, 90 from starboard");
    check.require({"elevation_deg"}, "expected degrees above the horizon, -90 to 90");
    if (aspect.has_range_m() && set.ranges_m_size() > 0)
      check.error("range_m", "does not apply, expected ranges_m or a range of each aspect");
    if (!aspect.has_range_m() && !set.has_range_m() && set.ranges_m_size() == 0) {
      check.error("range_m", "is missing, expected it here or in [viewpoints]");
    }
  }
}

// How many viewpoints the set has at one range; its keys are checked on the way.
double checked_count(const schema::Viewpoints& set, const SectionCheck& check, Findings& findings) {
  (void)check.at_most_one({"range_m", "ranges_m"});
  if (set.kind() != "list" && set.ranges_m_size() == 0)
    check.require({"range_m"}, "expected the distance to the target in metres");
  check_aspects(set, findings);
  const double aspects = set.aspect_size();
  if (set.kind() == "fibonacci") {
    check.only({"kind", "range_m", "ranges_m", "count", "elevation_min_deg", "elevation_max_deg",
                "aspect"},
               "to kind \"fibonacci\"");
    check.require({"count"}, "expected how many viewpoints");
    const double least = set.has_elevation_min_deg() ? set.elevation_min_deg() : 0;
    const double most = set.has_elevation_max_deg() ? set.elevation_max_deg() : 90;
    if (!(least < most)) {
      check.error(set.has_elevation_min_deg() ? "elevation_min_deg" : "elevation_max_deg",
                  absl::StrCat("leaves no zone from ", least, " to ", most,
                               ", expected minimum below maximum"));
    }
    return set.count() + aspects;
  }
  if (set.kind() == "ring") {
    check.only({"kind", "range_m", "ranges_m", "count", "elevation_deg", "aspect"},
               "to kind \"ring\"");
    check.require({"count"}, "expected how many viewpoints");
    check.require({"elevation_deg"}, "expected the elevation of each ring");
    return static_cast<double>(set.count()) * set.elevation_deg_size() + aspects;
  }
  if (set.kind() == "grid") {
    check.only({"kind", "range_m", "ranges_m", "azimuth_deg", "elevation_deg", "aspect"},
               "to kind \"grid\"");
    check.require({"azimuth_deg"}, "expected the azimuths of the grid");
    check.require({"elevation_deg"}, "expected the elevations of the grid");
    return static_cast<double>(set.azimuth_deg_size()) * set.elevation_deg_size() + aspects;
  }
  check.only({"kind", "range_m", "ranges_m", "aspect"}, "to kind \"list\"");
  check.require({"aspect"}, "expected one or more [[viewpoints.aspect]]");
  return aspects;
}

std::vector<Viewpoint> spread(const schema::Viewpoints& set) {
  if (set.kind() == "fibonacci") {
    return fibonacci_viewpoints(set.count(), set.range_m(), set.elevation_min_deg(),
                                set.has_elevation_max_deg() ? set.elevation_max_deg() : 90);
  }
  const std::vector<double> azimuths(set.azimuth_deg().begin(), set.azimuth_deg().end());
  const std::vector<double> elevations(set.elevation_deg().begin(), set.elevation_deg().end());
  if (set.kind() == "ring") return ring_viewpoints(set.count(), elevations, set.range_m());
  if (set.kind() == "grid") return grid_viewpoints(azimuths, elevations, set.range_m());
  return {};
}

std::vector<Viewpoint> at_one_range(const schema::Viewpoints& set) {
  std::vector<Viewpoint> out = spread(set);
  for (const schema::Aspect& aspect : set.aspect())
    out.push_back({.aspect_azimuth_deg = aspect.azimuth_deg(),
                   .aspect_elevation_deg = aspect.elevation_deg(),
                   .range_m = aspect.has_range_m() ? aspect.range_m() : set.range_m()});
  return out;
}

// Range by range.
std::vector<Viewpoint> expanded(const schema::Viewpoints& set) {
  if (set.ranges_m_size() == 0) return at_one_range(set);
  std::vector<Viewpoint> all;
  schema::Viewpoints one = set;
  for (const double range_m : set.ranges_m()) {
    one.set_range_m(range_m);
    const std::vector<Viewpoint> here = at_one_range(one);
    all.insert(all.end(), here.begin(), here.end());
  }
  return all;
}

// Returns true if at least one season has surroundings of this kind.
bool anywhere(const schema::Sweep& sweep, const char* kind) {
  if (sweep.surroundings().kind() == kind) return true;
  for (const schema::Season& season : sweep.season()) {
    if (season.surroundings().kind() == kind) return true;
  }
  return false;
}

// Height of the sensor above a spherical sea or ground, of a reference point so high above it.
double height_above_surface_m(const Viewpoint& view, double reference_m) {
  const double up_m = view.range_m * std::sin(view.aspect_elevation_deg * kRadPerDeg);
  const double along_m = view.range_m * std::cos(view.aspect_elevation_deg * kRadPerDeg);
  return std::hypot(kEarthRadiusM + reference_m + up_m, along_m) - kEarthRadiusM;
}

}  // namespace

void resolve_viewpoints(schema::ResolvedSweep& resolved, Findings& findings) {
  const schema::Sweep& sweep = resolved.sweep();
  if (!sweep.has_viewpoints()) {
    findings.add(
        "viewpoints",
        "[viewpoints] is missing, expected kind = \"fibonacci\", \"grid\", \"ring\" or \"list\"");
    return;
  }
  const schema::Viewpoints& set = sweep.viewpoints();
  const SectionCheck check(set, "viewpoints", findings);
  check.require({"kind"}, "expected \"fibonacci\", \"grid\", \"ring\" or \"list\"");
  if (!check.one_of("kind", {"fibonacci", "grid", "ring", "list"})) return;
  const double count = checked_count(set, check, findings) * std::max(1, set.ranges_m_size());
  if (count > kMostViewpoints) {
    findings.add("viewpoints", absl::StrCat("viewpoints has ", count,
                                            " viewpoints, expected at most ", kMostViewpoints));
  }
  if (findings.any_at("viewpoints")) return;

  const bool sea = anywhere(sweep, "sea"), ground = anywhere(sweep, "ground");
  std::map<std::tuple<double, double, double>, std::size_t> seen;
  const std::vector<Viewpoint> views = expanded(set);
  const double reference_m = lowest_above_surface_m(sweep);
  std::size_t below = 0;  // the surface; the first of them
  std::string first_below, text_below;
  for (std::size_t i = 0; i < views.size(); ++i) {
    Viewpoint view = views[i];
    view.aspect_azimuth_deg = normalized_azimuth_deg(view.aspect_azimuth_deg);
    view.aspect_elevation_deg += 0.0;  // no negative zero
    const std::string path = viewpoint_path(set, i, views.size());
    const std::string what =
        absl::StrCat("viewpoint ", i, " (azimuth ", view.aspect_azimuth_deg, ", elevation ",
                     view.aspect_elevation_deg, ", range ", view.range_m, " m)");
    const auto [other, is_new] =
        seen.try_emplace({view.aspect_azimuth_deg, view.aspect_elevation_deg, view.range_m}, i);
    if (!is_new) {
      findings.add(path, absl::StrCat(what, " is the same as viewpoint ", other->second,
                                      ", expected different ones"));
    }
    // A millimetre of tolerance: elevation 0 is at the sea's height at any range.
    if ((sea || ground) && height_above_surface_m(view, reference_m) < -1e-3 && ++below == 1) {
      first_below = path;
      text_below = absl::StrCat(what, sea ? " lies under water" : " lies under the ground");
    }
    schema::Viewpoint& out = *resolved.add_viewpoint();
    out.set_aspect_azimuth_deg(view.aspect_azimuth_deg);
    out.set_aspect_elevation_deg(view.aspect_elevation_deg);
    out.set_range_m(view.range_m);
  }
  if (below == 0) return;
  const bool spread = set.kind() == "fibonacci" && first_below == "viewpoints";
  findings.add(spread && set.has_elevation_min_deg() ? "viewpoints.elevation_min_deg" : first_below,
               absl::StrCat(text_below, below > 1 ? absl::StrCat(", and ", below - 1, " more") : "",
                            ", expected sensors above ", sea ? "the sea" : "it",
                            spread ? ": a larger elevation_min_deg" : ""));
}

}  // namespace irsig
