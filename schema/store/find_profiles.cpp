#include "schema/store/find_profiles.h"

#include "core/base/status_macros.h"
#include "schema/store/tables/statements.h"

namespace irsig {

// Columns in the order of profile_view.
absl::StatusOr<std::vector<StoredProfileRow>> find_profile_rows(Database& database,
                                                                const ProfileFilter& filter) {
  std::vector<StoredProfileRow> out;
  ASSIGN_OR_RETURN(Rows row, database.query(sql::find_profile_rows, filter.sweep,
                                            filter.season.json(), filter.band, filter.profile));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return out;
    StoredProfileRow& p = out.emplace_back();
    for (std::string* text : {&p.sweep, &p.season, &p.time_utc, &p.band}) *text = row.text();
    for (double* number : {&p.lambda_min_um, &p.lambda_max_um, &p.aspect_azimuth_deg,
                           &p.aspect_elevation_deg, &p.range_m})
      *number = row.real();
    p.row = row.count();
    p.profile = row.text();
    p.profile_index = row.count();
    p.point_index = row.count();
    for (double* number : {&p.x_m, &p.y_m, &p.z_m, &p.footprint_width_m, &p.footprint_height_m})
      *number = row.real();
    p.reflections = row.count();
    for (double* number :
         {&p.radiance_w_m2_sr, &p.radiance_stderr_w_m2_sr, &p.apparent_radiance_w_m2_sr,
          &p.apparent_radiance_stderr_w_m2_sr, &p.truncation_bound_w_m2_sr,
          &p.quadrature_bound_w_m2_sr, &p.source_radiance_temperature_k,
          &p.source_radiance_temperature_stderr_k, &p.target_fraction})
      *number = row.real();
    p.samples = row.count();
    p.replicates = row.count();
    p.energy_gain = row.integer() != 0;
    p.seed_hex = row.text();
    p.physics_version = row.count();
    p.determinism_class = row.text();
    p.build_id = row.text();
    p.job_key = row.text();
  }
}

absl::StatusOr<std::vector<StoredPublished>> find_published(Database& database,
                                                            const std::string& sweep) {
  std::vector<StoredPublished> out;
  ASSIGN_OR_RETURN(Rows row, database.query(sql::find_published, sweep));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return out;
    StoredPublished& p = out.emplace_back();
    p.sweep = row.text();
    p.profile = row.text();
    p.point_index = row.count();
    p.reflections = row.count();
    p.source_radiance_temperature_k = row.real();
    p.relation = row.text();
    p.source = row.text();
    p.remark = row.text();
  }
}

}  // namespace irsig
