#include <algorithm>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "jobs/resolve.h"
#include "jobs/resolve_plume.h"

namespace irsig {
namespace {

std::vector<double> heights_m(const schema::Sweep& sweep) {
  std::vector<double> out;
  for (const schema::Season& season : sweep.season()) out.push_back(above_surface_m(sweep, season));
  if (out.empty()) out.push_back(sweep.place().above_surface_m());
  return out;
}

}  // namespace

double lowest_above_surface_m(const schema::Sweep& sweep) {
  const std::vector<double> all = heights_m(sweep);
  return *std::min_element(all.begin(), all.end());
}

void check_heights(const schema::Sweep& sweep, Findings& findings) {
  const std::vector<double> all = heights_m(sweep);
  const auto [least, most] = std::minmax_element(all.begin(), all.end());
  if (!(*most > 0)) return;
  if (sweep.has_heat())
    findings.add("heat", absl::StrCat("[heat] computes temperatures from the weather at the "
                                      "surface, but above_surface_m = ",
                                      *most,
                                      " puts the target above it; state temperature_k of each "
                                      "[[part]] instead"));
  if (has_funnel_plume(sweep))
    findings.add("plume.kind",
                 absl::StrCat("plume.kind = \"funnel\" rises in the weather at the surface, but "
                              "above_surface_m = ",
                              *most, " puts the target above it; use \"cylinder\" or \"file\""));
  if (*least == *most) return;
  if (*least == 0) {
    const auto s = least - all.begin();
    const std::string path = absl::StrCat("season[", s, "]");
    findings.add(path, absl::StrCat(path,
                                    ".above_surface_m is missing, but other conditions have "
                                    "it; set it in each condition, or in [place] for all"));
  }
  if (sweep.profile_size() > 0)
    findings.add("profile[0]",
                 "[[profile]] needs one above_surface_m for all conditions, because its points see "
                 "one horizon; use a sweep for each height");
}

}  // namespace irsig
