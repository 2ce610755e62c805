#include "jobs/files/imager_file.h"

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/base/user_file.h"
#include "jobs/text/number_bounds.h"
#include "schema/imager.pb.h"

namespace irsig {
namespace {

void check_counts(const schema::ImagerCounts& counts, Findings& findings) {
  const SectionCheck check(counts, "counts", findings);
  check.require({"bits"}, "expected 8, 14 or 16");
  if (counts.has_bits() && counts.bits() != 8 && counts.bits() != 14 && counts.bits() != 16 &&
      !findings.any_at("counts.bits"))
    check.error("bits", absl::StrCat("= ", counts.bits(), ", expected 8, 14 or 16"));
  const bool temperatures = counts.has_black_k() || counts.has_white_k();
  const bool radiance = counts.has_counts_per_w_m2_sr() || counts.has_offset_counts();
  if (temperatures == radiance) {
    findings.add("counts",
                 absl::StrCat(temperatures ? "counts states two gains" : "counts states no gain",
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

Imager imager_of(const schema::ImagerFile& spec) {
  const schema::ImagerDetector& d = spec.detector();
  const schema::ImagerCounts& c = spec.counts();
  Imager out;
  out.aperture_m = spec.optics().aperture_m();
  out.f_number = spec.optics().f_number();
  out.jitter_rad = spec.optics().jitter_rad();
  out.pitch_m = d.pitch_m();
  out.netd_k = d.netd_k();
  out.fixed_pattern_k = d.fixed_pattern_k();
  if (d.has_fill_factor()) out.fill_factor = d.fill_factor();
  if (d.has_scene_temperature_k()) out.scene_temperature_k = d.scene_temperature_k();
  if (d.has_margin_px()) out.margin_px = d.margin_px();
  if (d.has_seed()) out.seed = d.seed();
  out.bits = c.bits();
  if (c.has_black_k())
    out.gain = CountsOfTemperatures{c.black_k(), c.white_k()};
  else
    out.gain = CountsOfRadiance{c.counts_per_w_m2_sr(), c.offset_counts()};
  return out;
}

}  // namespace

absl::StatusOr<ImagerOfFile> read_imager(const std::string& path) {
  const auto text = read_user_file(path, kMostSpecBytes);
  if (!text.ok()) return placed_problem(path + ":1:1", text.status().message());
  SweepFile file;
  file.file_name = path;
  schema::ImagerFile spec;
  RETURN_IF_ERROR(fill_from_toml(*text, file, spec));
  Findings findings(file);
  check_numbers(spec, "", findings);
  SectionCheck(spec, "", findings)
      .require({"optics", "detector", "counts"}, "expected the three tables of an imager");
  if (spec.has_optics())
    SectionCheck(spec.optics(), "optics", findings)
        .require({"aperture_m", "f_number"},
                 "expected the diameter of the aperture and the f-number");
  if (spec.has_detector())
    SectionCheck(spec.detector(), "detector", findings)
        .require({"pitch_m", "netd_k"}, "expected the pitch of the pixels and their noise");
  if (spec.has_counts()) check_counts(spec.counts(), findings);
  if (!findings.empty()) return findings.status();
  return ImagerOfFile{spec.has_name() ? spec.name() : path, spec.SerializeAsString(),
                      imager_of(spec)};
}

}  // namespace irsig
