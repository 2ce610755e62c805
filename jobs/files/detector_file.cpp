#include "jobs/files/detector_file.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/base/user_file.h"
#include "jobs/files/response_file.h"
#include "jobs/text/number_bounds.h"
#include "schema/detector.pb.h"

namespace irsig {
namespace {

struct NoiseKind {
  SectionCheck::Names keys;  // all of them, beside the kind
  const char* column;        // of the response file
  bool needs_file;
};
const std::map<std::string, NoiseKind>& kinds() {
  static const std::map<std::string, NoiseKind> all = {
      {"nei", {{"nei_w_m2"}, "response", false}},
      {"netd",
       {{"netd_k", "scene_temperature_k", "stated_f_number", "f_number", "ifov_rad"},
        "response",
        true}},
      {"d_star",
       {{"detector_area_m2", "bandwidth_hz", "aperture_m", "transmittance"},
        "d_star_cm_hz05_w",
        true}},
      {"background",
       {{"aperture_m", "transmittance", "f_number", "pixel_m", "integration_s", "well_electrons",
         "read_electrons"},
        "quantum_efficiency",
        true}}};
  return all;
}

std::variant<ConstantNoise, PhotonNoise> noise_of(const schema::DetectorNoise& n,
                                                  std::vector<SpectralPoint>& response) {
  if (n.kind() == "background")
    return PhotonNoise{n.aperture_m(),    n.transmittance(),  n.f_number(),      n.pixel_m(),
                       n.integration_s(), n.well_electrons(), n.read_electrons()};
  if (n.kind() == "netd")
    return ConstantNoise{nei_of_netd_w_m2(response, n.netd_k(), n.scene_temperature_k(),
                                          n.stated_f_number(), n.f_number(),
                                          n.ifov_rad() * n.ifov_rad())};
  if (n.kind() == "d_star") {
    double peak = 0;
    for (const SpectralPoint& p : response) peak = std::max(peak, p.value);
    for (SpectralPoint& p : response) p.value /= peak;
    constexpr double kMetre = 0.01;  // of a centimetre
    return ConstantNoise{nei_of_d_star_w_m2(kMetre * peak, n.detector_area_m2(), n.bandwidth_hz(),
                                            n.aperture_m(), n.transmittance())};
  }
  return ConstantNoise{n.nei_w_m2()};
}

}  // namespace

absl::StatusOr<DetectorOfFile> read_detector(const std::string& path) {
  const auto text = read_user_file(path, kMostSpecBytes);
  if (!text.ok()) return placed_problem(path + ":1:1", text.status().message());
  if (path.ends_with(".csv"))
    return placed_problem(path + ":1:1",
                          "this is a table, expected a detector file (.toml) that names it with "
                          "response_file");
  SweepFile file;
  file.file_name = path;
  schema::DetectorFile spec;
  RETURN_IF_ERROR(fill_from_toml(*text, file, spec));
  Findings findings(file);
  check_numbers(spec, "", findings);
  if (!spec.has_noise())
    findings.add("noise",
                 "[noise] is missing, expected what the detector's noise is: a kind "
                 "(nei, netd, d_star, background) and its figures");
  if (!findings.empty()) return findings.status();
  const SectionCheck check(spec.noise(), "noise", findings);
  check.require({"kind"}, "expected nei, netd, d_star or background");
  if (!check.one_of("kind", {"nei", "netd", "d_star", "background"})) return findings.status();
  const NoiseKind& kind = kinds().at(spec.noise().kind());
  SectionCheck::Names all = kind.keys;
  all.push_back("kind");
  check.only(all, absl::StrCat("to noise of the kind ", spec.noise().kind()));
  check.require(kind.keys, absl::StrCat("expected for noise of the kind ", spec.noise().kind()));
  if (kind.needs_file && !spec.has_response_file())
    findings.add("response_file",
                 absl::StrCat("response_file is missing, expected a CSV file with lambda_um,",
                              kind.column, " for noise of the kind ", spec.noise().kind()));
  if (!findings.empty()) return findings.status();
  DetectorOfFile out;
  out.name = spec.has_name() ? spec.name() : path;
  if (spec.has_response_file()) {
    ASSIGN_OR_RETURN(
        auto response,
        read_response((std::filesystem::path(path).parent_path() / spec.response_file()).string(),
                      kind.column));
    out.detector.response = std::move(response);
    if (spec.noise().kind() == "background")
      for (const SpectralPoint& p : out.detector.response)
        if (p.value > 1)
          findings.add("response_file",
                       absl::StrCat("response_file: quantum_efficiency ", p.value, " at ",
                                    p.lambda_um, " um, expected at most 1"));
    if (!findings.empty()) return findings.status();
  }
  out.detector.noise = noise_of(spec.noise(), out.detector.response);
  return out;
}

}  // namespace irsig
