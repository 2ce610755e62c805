// [[profile]] and [[published]].
#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "jobs/resolve.h"
#include "jobs/text/nearest_name.h"

namespace irsig {
namespace {

using Numbers = google::protobuf::RepeatedField<double>;

bool check_point(const SectionCheck& check, const char* name, const Numbers& point,
                 double nearest_sensor_m) {
  if (point.empty()) return false;
  if (point.size() != 3) {
    check.error(name, absl::StrCat("has ", point.size(),
                                   " numbers, expected three: x forward, y starboard, z down"));
    return false;
  }
  if (!(std::hypot(point[0], point[1], point[2]) < nearest_sensor_m)) {
    check.error(name, absl::StrCat("is as far from the reference point as a sensor, expected "
                                   "less than the range of ",
                                   nearest_sensor_m, " m"));
    return false;
  }
  return true;
}

void check_place(const schema::Profile& profile, const SectionCheck& check,
                 double nearest_sensor_m) {
  const bool at = check_point(check, "at_m", profile.at_m(), nearest_sensor_m);
  if (profile.at_m_size() > 0) {
    for (const char* name : {"from_m", "to_m", "points"}) {
      if (check.has(name)) check.error(name, "does not apply to a profile at one point, at_m");
    }
    if (at)
      check.require({"footprint_width_m", "footprint_height_m"},
                    "expected the size of the rectangle that radiance is averaged over");
    return;
  }
  if (profile.from_m_size() == 0 || profile.to_m_size() == 0) {
    check.error("at_m",
                "is missing, expected a point at_m, or a line with from_m, to_m and points");
    return;
  }
  const bool from = check_point(check, "from_m", profile.from_m(), nearest_sensor_m);
  const bool to = check_point(check, "to_m", profile.to_m(), nearest_sensor_m);
  check.require({"points"}, "expected the number of points of the line, its ends included");
  if (from && to &&
      std::equal(profile.from_m().begin(), profile.from_m().end(), profile.to_m().begin()))
    check.error("to_m", "is the same point as from_m, expected another (or at_m alone)");
}

void check_reflections(const schema::Profile& profile, const SectionCheck& check) {
  for (int i = 0; i < profile.reflections_size(); ++i) {
    if (i > 0 && profile.reflections(i) <= profile.reflections(i - 1)) {
      check.error("reflections", "does not increase, expected each number once, in order");
      return;
    }
  }
}

void check_published(const schema::Sweep& sweep, const std::vector<std::string>& profiles,
                     Findings& findings) {
  for (int i = 0; i < sweep.published_size(); ++i) {
    const schema::Published& published = sweep.published(i);
    const SectionCheck check(published, absl::StrCat("published[", i, "]"), findings);
    check.require({"profile", "reflections", "source_radiance_temperature_k", "source"},
                  "expected which row of which profile, the number and where it is published");
    if (published.has_relation()) (void)check.one_of("relation", {"equal", "below", "above"});
    if (!published.has_profile()) continue;
    const auto found = std::find(profiles.begin(), profiles.end(), published.profile());
    if (found == profiles.end()) {
      check.error("profile", absl::StrCat("= \"", published.profile(),
                                          "\": no profile has that "
                                          "name, ",
                                          suggestion(published.profile(), profiles)));
      continue;
    }
    const schema::Profile& profile = sweep.profile(static_cast<int>(found - profiles.begin()));
    const auto& asked = profile.reflections();
    if (asked.empty())
      check.error("profile", absl::StrCat("= \"", published.profile(),
                                          "\" does not state its reflections, expected it to"));
    if (published.has_reflections() && !asked.empty() &&
        std::find(asked.begin(), asked.end(), published.reflections()) == asked.end())
      check.error("reflections", absl::StrCat("= ", published.reflections(),
                                              " is not among the profile's reflections"));
    if (published.point_index() >= std::max(1u, profile.points()))
      check.error("point_index", absl::StrCat("= ", published.point_index(),
                                              " is not a point of the profile, counted from 0"));
  }
}

}  // namespace

void check_profiles(const schema::ResolvedSweep& resolved, Findings& findings) {
  const schema::Sweep& sweep = resolved.sweep();
  double nearest_sensor_m = HUGE_VAL;
  for (const schema::Viewpoint& v : resolved.viewpoint())
    nearest_sensor_m = std::min(nearest_sensor_m, v.range_m());
  const std::vector<std::string> names = check_names(sweep.profile(), "profile", findings);
  for (int i = 0; i < sweep.profile_size(); ++i) {
    const schema::Profile& profile = sweep.profile(i);
    const SectionCheck check(profile, absl::StrCat("profile[", i, "]"), findings);
    check_place(profile, check, nearest_sensor_m);
    check_reflections(profile, check);
    (void)check.at_most_one({"source_radiance_temperature_stderr_k", "samples"});
  }
  check_published(sweep, names, findings);
}

void write_profile_defaults(schema::Sweep& sweep) {
  for (schema::Profile& profile : *sweep.mutable_profile()) {
    if (profile.at_m_size() == 0) {
      const double step =
          std::hypot(profile.to_m(0) - profile.from_m(0), profile.to_m(1) - profile.from_m(1),
                     profile.to_m(2) - profile.from_m(2)) /
          (profile.points() - 1);
      if (!profile.has_footprint_width_m()) profile.set_footprint_width_m(step);
      if (!profile.has_footprint_height_m())
        profile.set_footprint_height_m(profile.footprint_width_m());
    }
    if (profile.reflections_size() == 0)
      profile.add_reflections(sweep.transport().max_reflections());
    if (!profile.has_source_radiance_temperature_stderr_k() && !profile.has_samples())
      profile.set_source_radiance_temperature_stderr_k(0.05);
  }
  for (schema::Published& published : *sweep.mutable_published()) {
    if (!published.has_point_index()) published.set_point_index(0);
    if (!published.has_relation()) published.set_relation("equal");
    if (!published.has_remark()) published.set_remark("");
  }
}

}  // namespace irsig
