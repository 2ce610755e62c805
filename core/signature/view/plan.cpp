#include "core/signature/view/plan.h"

#include "absl/strings/str_format.h"

namespace irsig {
namespace {

const char* word(bool on) { return on ? "on" : "off"; }

}  // namespace

std::string to_string(const ViewPlan& plan) {
  const EffectSet& e = plan.effects;
  std::string out = absl::StrFormat(
      "samples_per_replicate %d%s\npilot_rays %d\nmax_reflections %d%s\nreflected: sky %s, lower "
      "%s, "
      "parts %s\njoined_lines %s\n",
      plan.samples_per_replicate, plan.limited ? " (limited)" : "", plan.pilot_rays,
      e.max_reflections, e.skip_self_intersection ? ", none meets the target again" : "",
      word(e.sky), word(e.lower), word(e.parts), word(e.joined_lines));
  if (!plan.bright.none()) {
    absl::StrAppendFormat(&out, "aimed at what is bright, past others %s; shares of strata:",
                          word(plan.bright.past_others));
    for (const double share : plan.bright.share) absl::StrAppendFormat(&out, " %g", share);
    out += "\n";
    for (const std::vector<std::uint32_t>& group : plan.bright.group) {
      out += "bright facets:";
      for (const std::uint32_t facet : group) absl::StrAppendFormat(&out, " %d", facet);
      out += "\n";
    }
  }
  for (std::size_t c = 0; c < e.sun.size(); ++c)
    if (!e.has_cloud(c)) absl::StrAppendFormat(&out, "cloud %d: off\n", c);
  for (std::size_t c = 0; c < e.sun.size(); ++c)
    absl::StrAppendFormat(&out,
                          "sun %d: direct %s, diffuse %s, mirrored %s, path %s, background %s\n", c,
                          word(e.sun[c].direct), word(e.sun[c].diffuse), word(e.sun[c].mirrored),
                          word(e.sun[c].path), word(e.sun[c].background));
  for (std::size_t row = 0; row < plan.absolute_floor_w_m2_sr.size(); ++row)
    absl::StrAppendFormat(&out, "row %d: absolute_floor_w_m2_sr %.17g\n", row,
                          plan.absolute_floor_w_m2_sr[row]);
  for (std::size_t row = 0; row < plan.omitted.size(); ++row)
    absl::StrAppendFormat(&out, "row %d: omitted %.17g, apparent %.17g, contrast %.17g W/sr\n", row,
                          plan.omitted[row].source, plan.omitted[row].apparent,
                          plan.omitted[row].contrast);
  for (std::size_t row = 0; row < plan.room.size(); ++row)
    absl::StrAppendFormat(&out, "row %d: room for omissions %.17g, at the sensor %.17g W/sr\n", row,
                          plan.room[row].source, plan.room[row].aperture);
  for (std::size_t row = 0; row < plan.ledger.size(); ++row)
    for (const LedgerEntry& entry : plan.ledger[row])
      absl::StrAppendFormat(&out, "row %d: %s %s (%s), bounds %.17g, %.17g, %.17g W/sr\n", row,
                            info_of(entry.effect).name, name_of(entry.state), name_of(entry.reason),
                            entry.bound_w_sr, entry.apparent_bound_w_sr, entry.contrast_bound_w_sr);
  return out;
}

}  // namespace irsig
