// [imager]
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/imager/imager.h"
#include "jobs/files/imager_file.h"
#include "jobs/resolve.h"
#include "messages/imager/imager_from_message.h"

namespace irsig {
namespace {

void check_imager_name(const SectionCheck& check, const std::string& name) {
  if (!check.has("name")) return;
  if (name.empty() || !is_one_line(name))
    check.error("name", "is empty, has control characters or is not UTF-8, expected a plain name");
  else if (is_formula(name))
    check.error("name", absl::StrCat("= \"", name, "\": ", kFormulaName));
}

void check_imager_bands(const schema::Sweep& sweep, const Imager& imager, Findings& findings) {
  for (const schema::Band& stated : sweep.band()) {
    Band band{stated.name(), stated.lambda_min_um(), stated.lambda_max_um(), stated.step_um(), {}};
    for (const schema::SpectralPoint& p : stated.response())
      band.response.push_back({p.lambda_um(), p.value()});
    if (const auto figures = imager_in_band(imager, band); !figures.ok())
      findings.add("imager.counts",
                   absl::StrCat("imager.counts: ", figures.status().message(),
                                ": state other temperatures, or counts_per_w_m2_sr"));
  }
}

// Checks the detector's pixels against a camera's. Frames around the target are checked by an
// export, because their pixel depends on the viewpoint.
void check_imager_pixels(const schema::Image& image, const Imager& imager, Findings& findings) {
  if (image.kind() != "camera" || image.pixels_size() != 2) return;
  const double width = 2 * std::tan(0.5 * image.field_of_view_deg() * std::numbers::pi / 180);
  const auto grid =
      detector_grid(imager, image.pixels(0), image.pixels(1), width / image.pixels(0));
  if (!grid.ok())
    findings.add("imager.detector.pitch_m",
                 absl::StrCat("imager.detector.pitch_m and the image of [image]: ",
                              grid.status().message()));
}

}  // namespace

void check_imager_has_images(const schema::Sweep& sweep, Findings& findings) {
  if (sweep.has_imager() && sweep.output().thumbnail_px() == 0)
    findings.add("imager",
                 "imager has no image to record: set [output] thumbnail_px to 1 or more, add "
                 "[image], or leave [imager] out");
}

void check_sweep_imager(const schema::Sweep& sweep, Findings& findings) {
  if (!sweep.has_imager()) return;
  check_imager(sweep.imager(), "imager", findings);
  check_imager_name(SectionCheck(sweep.imager(), "imager", findings), sweep.imager().name());
  if (sweep.has_plume())
    findings.add("imager",
                 "imager does not apply with [plume], whose image cannot be put before a "
                 "background: leave one of them out");
  if (!findings.empty()) return;
  const auto imager = imager_from_message(sweep.imager());
  if (!imager.ok()) {
    for (const Problem& problem : problems_of(imager.status()))
      findings.add(problem.key, problem.text);
    return;
  }
  check_imager_bands(sweep, *imager, findings);
  check_imager_pixels(sweep.image(), *imager, findings);
}

}  // namespace irsig
