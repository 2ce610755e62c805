#include "jobs/files/imager_file.h"

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/base/user_file.h"
#include "jobs/text/number_bounds.h"
#include "messages/imager/imager_from_message.h"

namespace irsig {
namespace {

void check_counts(const schema::ImagerCounts& counts, const std::string& path, Findings& findings) {
  const SectionCheck check(counts, path, findings);
  check.require({"bits"}, "expected 8, 14 or 16");
  if (counts.has_bits() && counts.bits() != 8 && counts.bits() != 14 && counts.bits() != 16 &&
      !findings.any_at(check.path("bits")))
    check.error("bits", absl::StrCat("= ", counts.bits(), ", expected 8, 14 or 16"));
  const bool temperatures = counts.has_black_k() || counts.has_white_k();
  const bool radiance = counts.has_counts_per_w_m2_sr() || counts.has_offset_counts();
  if (temperatures == radiance) {
    findings.add(path, absl::StrCat(path, temperatures ? " states two gains" : " states no gain",
                                    ", expected black_k and white_k, or counts_per_w_m2_sr "
                                    "and offset_counts"));
  } else if (temperatures) {
    check.require({"black_k", "white_k"},
                  "expected the temperatures of blackbodies that give 0 and full scale");
    if (counts.has_black_k() && counts.has_white_k() && !(counts.black_k() < counts.white_k()))
      check.error("white_k", absl::StrCat("= ", counts.white_k(),
                                          ", expected more than black_k = ", counts.black_k()));
  } else {
    check.require({"counts_per_w_m2_sr", "offset_counts"},
                  "expected the gain and the counts of radiance 0");
  }
}

}  // namespace

void check_imager(const schema::ImagerFile& stated, const std::string& path, Findings& findings) {
  const SectionCheck whole(stated, path, findings);
  whole.require({"optics", "detector", "counts"}, "expected the three tables of an imager");
  if (stated.has_optics())
    SectionCheck(stated.optics(), whole.path("optics"), findings)
        .require({"aperture_m", "f_number"},
                 "expected the diameter of the aperture and the f-number");
  if (stated.has_detector())
    SectionCheck(stated.detector(), whole.path("detector"), findings)
        .require({"pitch_m", "netd_k"}, "expected the pitch of the pixels and their noise");
  if (stated.has_counts()) check_counts(stated.counts(), whole.path("counts"), findings);
}

absl::StatusOr<ImagerOfFile> read_imager(const std::string& path) {
  const auto text = read_user_file(path, kMostSpecBytes);
  if (!text.ok()) return placed_problem(path + ":1:1", text.status().message());
  SweepFile file;
  file.file_name = path;
  schema::ImagerFile spec;
  RETURN_IF_ERROR(fill_from_toml(*text, file, spec));
  Findings findings(file);
  check_numbers(spec, "", findings);
  check_imager(spec, "", findings);
  if (!findings.empty()) return findings.status();
  auto imager = imager_from_message(spec);
  if (!imager.ok()) return located(file, imager.status());
  return ImagerOfFile{spec.has_name() ? spec.name() : path, spec.SerializeAsString(),
                      *std::move(imager)};
}

}  // namespace irsig
