#include "messages/results/profile_messages.h"

namespace irsig {
namespace {

Vec<Body> point_of(const google::protobuf::RepeatedField<double>& xyz) {
  return {xyz[0], xyz[1], xyz[2]};
}

void set_profile_estimate(schema::Estimate* out, const Estimate& e) {
  out->set_value(e.value);
  out->set_stderr(e.stderr_);
}

}  // namespace

ProfileSpec profile_from_message(const schema::Profile& p) {
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
  spec.source_radiance_temperature_stderr_k = p.source_radiance_temperature_stderr_k();
  return spec;
}

void profile_row_to_proto(const ProfileRow& row, const ProfileSpec& spec, std::uint64_t samples,
                          schema::ProfileRow& out) {
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
  set_profile_estimate(out.mutable_source_radiance_temperature_k(),
                       row.source_radiance_temperature_k);
  out.set_target_fraction(row.target_fraction);
  out.set_samples(samples);
}

}  // namespace irsig
