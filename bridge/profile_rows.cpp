#include "bridge/profile_rows.h"

#include "absl/strings/str_cat.h"
#include "bridge/check_numbers.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/signature/profile.h"

namespace irsig {
namespace {

Vec<Body> point_of(const google::protobuf::RepeatedField<double>& xyz) {
  return {xyz[0], xyz[1], xyz[2]};
}

ProfileSpec spec_of(const schema::Profile& p) {
  ProfileSpec spec;
  if (p.at_m_size() > 0) {
    spec.point.push_back(point_of(p.at_m()));
  } else {
    const Vec<Body> from = point_of(p.from_m()), to = point_of(p.to_m());
    for (std::uint32_t i = 0; i < p.points(); ++i) {
      const double t = static_cast<double>(i) / (p.points() - 1);
      spec.point.push_back((1 - t) * from + t * to);
    }
  }
  spec.width_m = p.footprint_width_m();
  spec.height_m = p.footprint_height_m();
  spec.reflections.assign(p.reflections().begin(), p.reflections().end());
  spec.samples = p.samples();
  spec.apparent_temperature_stderr_k = p.apparent_temperature_stderr_k();
  return spec;
}

void set_profile_estimate(schema::Estimate* out, const Estimate& e) {
  out->set_value(e.value);
  out->set_stderr(e.stderr_);
}

void fill(schema::ProfileRow& out, const ProfileRow& row, const ProfileSpec& spec,
          std::uint64_t samples) {
  out.set_point_index(row.point);
  out.set_reflections(row.reflections);
  const Vec<Body>& at = spec.point[row.point];
  out.set_x_m(at.x);
  out.set_y_m(at.y);
  out.set_z_m(at.z);
  out.set_footprint_width_m(spec.width_m);
  out.set_footprint_height_m(spec.height_m);
  set_profile_estimate(out.mutable_radiance_w_m2_sr(), row.radiance_w_m2_sr);
  set_profile_estimate(out.mutable_apparent_radiance_w_m2_sr(), row.apparent_radiance_w_m2_sr);
  out.set_truncation_bound_w_m2_sr(row.truncation_bound_w_m2_sr);
  out.set_quadrature_bound_w_m2_sr(row.quadrature_bound_w_m2_sr);
  set_profile_estimate(out.mutable_apparent_temperature_k(), row.apparent_temperature_k);
  out.set_target_fraction(row.target_fraction);
  out.set_samples(samples);
}

}  // namespace

absl::Status add_profile_rows(const schema::ResolvedSweep& sweep, const Simulator& simulator,
                              const ViewRequest& request, schema::JobResult& result) {
  for (int i = 0; i < sweep.sweep().profile_size(); ++i) {
    const schema::Profile& asked = sweep.sweep().profile(i);
    const ProfileSpec spec = spec_of(asked);
    const auto measured = simulate_profile(simulator.scene(), request, spec);
    if (!measured.ok())
      return at_key(absl::StrCat("profile[", i, "]"), measured.status());
    RETURN_IF_ERROR(check_numbers(absl::StrCat("profile[", i, "]"), *measured));
    for (const ProfileRow& row : measured->row)
      for (schema::SignatureRow& signature : *result.mutable_view()->mutable_row()) {
        if (signature.condition_index() != row.condition || signature.band_index() != row.band)
          continue;
        schema::ProfileRow& out = *signature.add_profile();
        out.set_profile_index(static_cast<std::uint32_t>(i));
        out.set_name(asked.name());
        fill(out, row, spec, measured->samples[row.point]);
      }
    const PathCounts& counts = measured->counts;
    result.set_rays(result.rays() + counts.rays);
    result.set_guarded_backface_hits(result.guarded_backface_hits() + counts.guarded_backface_hits);
    result.set_truncated_paths(result.truncated_paths() + counts.truncated_paths);
  }
  return absl::OkStatus();
}

}  // namespace irsig
