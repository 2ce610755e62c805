#include "schema/store/check/check_sweep.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/printable.h"
#include "schema/heat_run.h"
#include "schema/shard.h"
#include "schema/store/tables/database.h"
#include "schema/store/tables/heat_time.h"

namespace irsig {
namespace {

absl::Status wrong_sweep(const schema::ResolvedSweep& sweep, const std::string& what) {
  return absl::InvalidArgumentError(
      one_line(absl::StrCat("sweep \"", sweep.sweep().name(), "\": ", what)));
}

absl::Status check_sweep_text(const schema::ResolvedSweep& sweep) {
  const auto plain = [&](const char* what, const std::string& text) {
    return is_one_line(text)
               ? absl::OkStatus()
               : wrong_sweep(sweep, absl::StrCat("the ", what, " \"", text,
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
    if (!usable) return wrong_sweep(sweep, absl::StrCat("the ", name, " is out of range"));
    if (!seen.insert(place).second)
      return wrong_sweep(sweep, absl::StrCat("the ", name, " comes twice"));
  }
  return absl::OkStatus();
}

absl::Status check_names(const schema::ResolvedSweep& sweep) {
  std::set<std::pair<std::string, std::string>> conditions;
  for (const schema::Condition& condition : sweep.condition()) {
    if (!conditions.emplace(condition.season(), condition.time_utc()).second) {
      return wrong_sweep(sweep, absl::StrCat("season \"", condition.season(), "\" at ",
                                             condition.time_utc(), " comes twice"));
    }
    if (condition.part_temperature_k_size() != sweep.sweep().part_size()) {
      return wrong_sweep(sweep,
                         absl::StrCat("season \"", condition.season(), "\" has ",
                                      condition.part_temperature_k_size(), " temperatures for ",
                                      sweep.sweep().part_size(), " parts"));
    }
  }
  std::set<std::string> bands;
  for (const schema::Band& band : sweep.sweep().band()) {
    if (!bands.insert(band.name()).second)
      return wrong_sweep(sweep, absl::StrCat("band \"", band.name(), "\" comes twice"));
    if (!(band.lambda_min_um() > 0 && band.lambda_max_um() > band.lambda_min_um())) {
      return wrong_sweep(
          sweep, absl::StrCat("band \"", band.name(), "\" has no limits, or reversed ones"));
    }
  }
  std::set<std::string> parts;
  for (const schema::Part& part : sweep.sweep().part()) {
    if (!parts.insert(part.name()).second)
      return wrong_sweep(sweep, absl::StrCat("part \"", part.name(), "\" comes twice"));
  }
  return absl::OkStatus();
}

// Checks that each row of the sweep is computed by exactly one view.
class ViewRule {
 public:
  explicit ViewRule(const schema::ResolvedSweep& sweep)
      : sweep_(sweep),
        viewpoints_(static_cast<std::size_t>(sweep.viewpoint_size())),
        conditions_(static_cast<std::size_t>(sweep.condition_size())),
        bands_(static_cast<std::size_t>(sweep.sweep().band_size())),
        covered_(viewpoints_ * conditions_ * bands_) {}

  absl::Status add(const schema::ViewJob& job) {
    if (job.viewpoint_index() >= viewpoints_ || !in_shard(sweep_, job.viewpoint_index()))
      return wrong_sweep(sweep_, "a job names a viewpoint that does not exist");
    for (const std::uint32_t condition : job.condition_index()) {
      for (const std::uint32_t band : job.band_index()) {
        if (condition >= conditions_ || band >= bands_) {
          return wrong_sweep(sweep_, "a job names a condition or band that does not exist");
        }
        auto place = covered_[(job.viewpoint_index() * conditions_ + condition) * bands_ + band];
        if (place) return wrong_sweep(sweep_, "two jobs compute the same row");
        place = true;
        ++places_;
      }
    }
    return absl::OkStatus();
  }

  absl::Status finish() const {
    const std::size_t rows = shard_size(sweep_) * conditions_ * bands_;
    if (places_ == rows) return absl::OkStatus();
    return wrong_sweep(sweep_, absl::StrCat("its jobs compute ", places_, " of ", rows, " rows"));
  }

 private:
  const schema::ResolvedSweep& sweep_;
  std::size_t viewpoints_, conditions_, bands_;
  std::vector<bool> covered_;
  std::size_t places_ = 0;
};

// Each heat run is computed by one job, in their order, before any view; and each view needs them
// all, in this order.
class HeatRule {
 public:
  explicit HeatRule(const schema::ResolvedSweep& sweep) : sweep_(sweep) {}

  absl::Status add(const schema::JobSpec& job) {
    if (job.heat().heat() != keys_.size() || job.heat().heat() >= runs() || job.needs_size() > 0)
      return wrong_sweep(sweep_, absl::StrCat("the job \"", job.job_key(), "\" computes heat run ",
                                              job.heat().heat(), " of ", runs(),
                                              " out of order, or needs another job"));
    keys_.push_back(job.job_key());
    return absl::OkStatus();
  }

  absl::Status check_view(const schema::JobSpec& job) const {
    if (runs() == 0) return absl::OkStatus();
    if (keys_.size() == runs() &&
        std::equal(keys_.begin(), keys_.end(), job.needs().begin(), job.needs().end()))
      return absl::OkStatus();
    return wrong_sweep(sweep_, absl::StrCat("the view \"", job.job_key(),
                                            "\" does not need the sweep's ", runs(), " heat jobs"));
  }

 private:
  [[nodiscard]] std::size_t runs() const { return static_cast<std::size_t>(sweep_.heat_size()); }

  const schema::ResolvedSweep& sweep_;
  std::vector<std::string> keys_;
};

// Runs are complete, and conditions name those that there are.
absl::Status check_heat(const schema::ResolvedSweep& sweep) {
  const int parts = sweep.sweep().part_size();
  for (const schema::HeatRun& run : sweep.heat()) {
    const std::string name = absl::StrCat("the heat run of \"", run.season(), "\" ");
    if (!is_one_line(run.season()))
      return wrong_sweep(sweep, name + "has control characters or is not UTF-8");
    if (run.time_utc().empty()) return wrong_sweep(sweep, name + "has no times");
    for (const std::string& time : run.time_utc())
      if (!is_one_line(time) || !unix_s_of(time))
        return wrong_sweep(sweep, absl::StrCat(name, "has \"", time, "\", which is no time"));
    if (run.part_temperature_k_size() != parts)
      return wrong_sweep(sweep, absl::StrCat(name, "has ", run.part_temperature_k_size(),
                                             " temperatures for ", parts, " parts"));
    if (run.land_temperature_k_size() > 0 &&
        run.land_temperature_k_size() != sweep.sweep().land().material_size())
      return wrong_sweep(
          sweep, absl::StrCat(name, "has ", run.land_temperature_k_size(), " temperatures for ",
                              sweep.sweep().land().material_size(), " materials of the land"));
    if (!computes_parts(run) && !computes_land(run) && !changes_land(run))
      return wrong_sweep(sweep, name + "has nothing to compute");
  }
  for (const schema::Condition& c : sweep.condition()) {
    const std::string name = absl::StrCat("season \"", c.season(), "\" at ", c.time_utc());
    if (c.has_land_heat()) {
      if (c.land_heat() >= static_cast<std::uint32_t>(sweep.heat_size()))
        return wrong_sweep(sweep, absl::StrCat(name, " has the land of heat run ", c.land_heat(),
                                               " of ", sweep.heat_size()));
      const schema::HeatRun& run = sweep.heat(static_cast<int>(c.land_heat()));
      if (!computes_land(run) || !time_index_of(run, c.time_utc()))
        return wrong_sweep(sweep, name + " is no time of the heat run of its land");
    }
    const schema::ConditionField& from = c.temperature_field();
    if (!from.has_heat()) continue;
    if (from.heat() >= static_cast<std::uint32_t>(sweep.heat_size()))
      return wrong_sweep(sweep, absl::StrCat(name, " has the temperatures of heat run ",
                                             from.heat(), " of ", sweep.heat_size()));
    const schema::HeatRun& run = sweep.heat(static_cast<int>(from.heat()));
    if (!time_index_of(run, c.time_utc()))
      return wrong_sweep(sweep, name + " is no time of its heat run");
    for (const std::uint32_t part : from.part())
      if (part >= static_cast<std::uint32_t>(parts) ||
          run.part_temperature_k(static_cast<int>(part)) != 0)
        return wrong_sweep(sweep, absl::StrCat(name, " has the temperatures of part ", part,
                                               ", which its heat run does not compute"));
  }
  return absl::OkStatus();
}

absl::Status check_jobs(const schema::ResolvedSweep& sweep,
                        const std::vector<schema::JobSpec>& jobs) {
  ViewRule views(sweep);
  HeatRule heat(sweep);
  std::set<std::string_view> keys;
  for (const schema::JobSpec& job : jobs) {
    // That what is needed comes first keeps circles out, too.
    std::set<std::string_view> needed;
    for (const std::string& key : job.needs()) {
      if (!keys.contains(key) || !needed.insert(key).second)
        return wrong_sweep(sweep, absl::StrCat("a job needs \"", key,
                                               "\", which is no job before it, or needs it twice"));
    }
    if (job.job_key().empty() || !keys.insert(job.job_key()).second) {
      return wrong_sweep(
          sweep, absl::StrCat("the job key \"", job.job_key(), "\" is empty or comes twice"));
    }
    switch (job.kind_case()) {
      case schema::JobSpec::kView:
        IRSIG_STORE_TRY(heat.check_view(job));
        IRSIG_STORE_TRY(views.add(job.view()));
        break;
      case schema::JobSpec::kHeat:
        IRSIG_STORE_TRY(heat.add(job));
        break;
      case schema::JobSpec::KIND_NOT_SET:
        return wrong_sweep(sweep,
                           absl::StrCat("the job \"", job.job_key(), "\" is of no known kind"));
    }
  }
  return views.finish();
}

}  // namespace

absl::Status check_sweep(const schema::ResolvedSweep& sweep, const std::string& sweep_sha256,
                         const std::vector<schema::JobSpec>& jobs) {
  if (sweep.sweep().name().empty()) return wrong_sweep(sweep, "it has no name");
  if (sweep_sha256.empty()) return wrong_sweep(sweep, "it has no hash");
  if (sweep.viewpoint().empty()) return wrong_sweep(sweep, "it has no viewpoints");
  if (sweep.condition().empty()) return wrong_sweep(sweep, "it has no conditions (season x time)");
  if (sweep.sweep().band().empty()) return wrong_sweep(sweep, "it has no bands");
  IRSIG_STORE_TRY(check_sweep_text(sweep));
  IRSIG_STORE_TRY(check_viewpoints(sweep));
  IRSIG_STORE_TRY(check_names(sweep));
  IRSIG_STORE_TRY(check_heat(sweep));
  return check_jobs(sweep, jobs);
}

}  // namespace irsig
