#include "schema/store/check_sweep.h"

#include <cmath>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/printable.h"
#include "schema/store/database.h"

namespace irsig {
namespace {

absl::Status wrong(const schema::ResolvedSweep& sweep, const std::string& what) {
  return absl::InvalidArgumentError(
      one_line(absl::StrCat("sweep \"", sweep.sweep().name(), "\": ", what)));
}

absl::Status check_text(const schema::ResolvedSweep& sweep) {
  const auto plain = [&](const char* what, const std::string& text) {
    return is_one_line(text)
               ? absl::OkStatus()
               : wrong(sweep, absl::StrCat("the ", what, " \"", text,
                                           "\" has control characters or is not UTF-8"));
  };
  IRSIG_STORE_TRY(plain("name", sweep.sweep().name()));
  for (const schema::Part& part : sweep.sweep().part()) IRSIG_STORE_TRY(plain("part", part.name()));
  for (const schema::Material& material : sweep.sweep().material())
    IRSIG_STORE_TRY(plain("material", material.name()));
  for (const schema::Band& band : sweep.sweep().band()) IRSIG_STORE_TRY(plain("band", band.name()));
  for (const schema::Profile& profile : sweep.sweep().profile())
    IRSIG_STORE_TRY(plain("profile", profile.name()));
  for (const schema::Condition& condition : sweep.condition()) {
    IRSIG_STORE_TRY(plain("season", condition.season()));
    IRSIG_STORE_TRY(plain("time", condition.time_utc()));
    for (const std::string& warning : condition.warning())
      IRSIG_STORE_TRY(plain("warning", warning));
  }
  return absl::OkStatus();
}

absl::Status check_viewpoints(const schema::ResolvedSweep& sweep) {
  std::set<std::tuple<double, double, double>> seen;
  for (const schema::Viewpoint& viewpoint : sweep.viewpoint()) {
    const std::tuple place(viewpoint.aspect_azimuth_deg(), viewpoint.aspect_elevation_deg(),
                           viewpoint.range_m());
    const bool usable = std::isfinite(viewpoint.aspect_azimuth_deg()) &&
                        std::abs(viewpoint.aspect_elevation_deg()) <= 90 &&
                        viewpoint.range_m() > 0 && std::isfinite(viewpoint.range_m());
    const std::string name =
        absl::StrCat("viewpoint (azimuth ", viewpoint.aspect_azimuth_deg(), " deg, elevation ",
                     viewpoint.aspect_elevation_deg(), " deg, range ", viewpoint.range_m(), " m)");
    if (!usable) return wrong(sweep, absl::StrCat("the ", name, " is out of range"));
    if (!seen.insert(place).second) return wrong(sweep, absl::StrCat("the ", name, " comes twice"));
  }
  return absl::OkStatus();
}

absl::Status check_names(const schema::ResolvedSweep& sweep) {
  std::set<std::pair<std::string, std::string>> conditions;
  for (const schema::Condition& condition : sweep.condition()) {
    if (!conditions.emplace(condition.season(), condition.time_utc()).second) {
      return wrong(sweep, absl::StrCat("season \"", condition.season(), "\" at ",
                                       condition.time_utc(), " comes twice"));
    }
    if (condition.part_temperature_k_size() != sweep.sweep().part_size()) {
      return wrong(sweep, absl::StrCat("season \"", condition.season(), "\" has ",
                                       condition.part_temperature_k_size(), " temperatures for ",
                                       sweep.sweep().part_size(), " parts"));
    }
  }
  std::set<std::string> bands;
  for (const schema::Band& band : sweep.sweep().band()) {
    if (!bands.insert(band.name()).second)
      return wrong(sweep, absl::StrCat("band \"", band.name(), "\" comes twice"));
    if (!(band.lambda_min_um() > 0 && band.lambda_max_um() > band.lambda_min_um())) {
      return wrong(sweep,
                   absl::StrCat("band \"", band.name(), "\" has no limits, or reversed ones"));
    }
  }
  std::set<std::string> parts;
  for (const schema::Part& part : sweep.sweep().part()) {
    if (!parts.insert(part.name()).second)
      return wrong(sweep, absl::StrCat("part \"", part.name(), "\" comes twice"));
  }
  return absl::OkStatus();
}

absl::Status check_jobs(const schema::ResolvedSweep& sweep,
                        const std::vector<schema::JobSpec>& jobs) {
  const auto viewpoints = static_cast<std::size_t>(sweep.viewpoint_size());
  const auto conditions = static_cast<std::size_t>(sweep.condition_size());
  const auto bands = static_cast<std::size_t>(sweep.sweep().band_size());
  std::vector<bool> covered(viewpoints * conditions * bands);
  std::set<std::string_view> keys;
  std::size_t places = 0;
  for (const schema::JobSpec& job : jobs) {
    if (job.job_key().empty() || !keys.insert(job.job_key()).second) {
      return wrong(sweep,
                   absl::StrCat("the job key \"", job.job_key(), "\" is empty or comes twice"));
    }
    if (job.viewpoint_index() >= viewpoints)
      return wrong(sweep, "a job names a viewpoint that does not exist");
    for (const std::uint32_t condition : job.condition_index()) {
      for (const std::uint32_t band : job.band_index()) {
        if (condition >= conditions || band >= bands) {
          return wrong(sweep, "a job names a condition or band that does not exist");
        }
        auto place = covered[(job.viewpoint_index() * conditions + condition) * bands + band];
        if (place) return wrong(sweep, "two jobs compute the same row");
        place = true;
        ++places;
      }
    }
  }
  if (places != covered.size()) {
    return wrong(sweep, absl::StrCat("its jobs compute ", places, " of ", covered.size(), " rows"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status check_sweep(const schema::ResolvedSweep& sweep, const std::string& sweep_sha256,
                         const std::vector<schema::JobSpec>& jobs) {
  if (sweep.sweep().name().empty()) return wrong(sweep, "it has no name");
  if (sweep_sha256.empty()) return wrong(sweep, "it has no hash");
  if (sweep.viewpoint().empty()) return wrong(sweep, "it has no viewpoints");
  if (sweep.condition().empty()) return wrong(sweep, "it has no conditions (season x time)");
  if (sweep.sweep().band().empty()) return wrong(sweep, "it has no bands");
  IRSIG_STORE_TRY(check_text(sweep));
  IRSIG_STORE_TRY(check_viewpoints(sweep));
  IRSIG_STORE_TRY(check_names(sweep));
  return check_jobs(sweep, jobs);
}

}  // namespace irsig
