#include "verify/cases/selftest.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "core/scene/mesh.h"

namespace irsig {
namespace {

std::string quoted(const std::string& text) {
  return absl::StrCat("\"", absl::StrReplaceAll(text, {{"\"", "\"\""}, {"\n", " "}}), "\"");
}

}  // namespace

std::vector<HardCase> matching(std::vector<HardCase> cases, const std::string& glob) {
  std::erase_if(cases, [&](const HardCase& c) { return !group_matches(c.id(), glob); });
  return cases;
}

std::string table_header() {
  return absl::StrFormat("%-36s %-10s %-10s %-4s %7s  %s", "case", "worst", "bound", "pass", "s",
                         "what is checked");
}

std::string table_row(const CaseResult& r) {
  const std::string worst = r.finding.ok() ? absl::StrFormat("%.3g", r.finding->worst_error) : "-";
  const std::string bound = r.finding.ok() ? absl::StrFormat("%.3g", r.finding->bound) : "-";
  std::string out = absl::StrFormat("%-36s %-10s %-10s %-4s %7.2f  %s", r.hard_case.id(), worst,
                                    bound, r.passed() ? "yes" : "NO", r.seconds, r.hard_case.what);
  if (!r.finding.ok())
    absl::StrAppend(&out, "\n    could not be made: ", r.finding.status().message());
  else if (r.finding->checks == 0)
    absl::StrAppend(&out, "\n    nothing was checked");
  else if (!r.passed())
    absl::StrAppend(&out, "\n    ", r.finding->where, "\n    the bound: ", r.hard_case.reason);
  return out;
}

std::string csv_header() { return "case,what,worst_error,bound,pass,checks,seconds,where,reason"; }

std::string csv_row(const CaseResult& r) {
  const bool ok = r.finding.ok();
  return absl::StrCat(r.hard_case.id(), ",", quoted(r.hard_case.what), ",",
                      ok ? absl::StrFormat("%.17g", r.finding->worst_error) : "", ",",
                      ok ? absl::StrFormat("%.17g", r.finding->bound) : "", ",",
                      r.passed() ? "yes" : "no", ",", ok ? r.finding->checks : 0, ",",
                      absl::StrFormat("%.3f", r.seconds), ",",
                      quoted(ok ? r.finding->where : std::string(r.finding.status().message())),
                      ",", quoted(r.hard_case.reason));
}

}  // namespace irsig
