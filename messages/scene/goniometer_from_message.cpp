#include "messages/scene/goniometer_from_message.h"

#include "messages/environment/named.h"

namespace irsig {

absl::StatusOr<ParticleBed> bed_of(const schema::Goniometer& spec, std::optional<double> coverage) {
  const schema::Particles& p = spec.particles();
  const auto by_mass =
      named<bool>("particles.fractions_by", p.fractions_by(), {{"number", false}, {"mass", true}});
  if (!by_mass.ok()) return by_mass.status();
  const auto shape =
      named<GrainShape>("particles.shape", p.shape(),
                        {{"irregular", GrainShape::kIrregular}, {"sphere", GrainShape::kSphere}});
  if (!shape.ok()) return shape.status();
  ParticleBed bed;
  for (const schema::GrainSize& s : p.size()) bed.size.push_back({s.diameter_m(), s.fraction()});
  bed.fractions_by_mass = *by_mass;
  bed.width_m = p.width_m();
  bed.tiles = p.tiles();
  if (coverage)
    bed.coverage = *coverage;
  else
    bed.layers = p.layers();
  bed.shape = *shape;
  bed.irregularity = p.irregularity();
  bed.subdivisions = p.subdivisions();
  bed.seed = spec.seed();
  return bed;
}

absl::StatusOr<GoniometerSpec> instrument_of(const schema::Goniometer& s, std::uint32_t threads) {
  const auto field = named<FieldOfView>(
      "sensor.field", s.sensor().field(),
      {{"on_plate", FieldOfView::kOnPlate}, {"across_view", FieldOfView::kAcrossView}});
  if (!field.ok()) return field.status();
  GoniometerSpec out;
  out.view_zenith_deg.assign(s.view().zenith_deg().begin(), s.view().zenith_deg().end());
  out.view_azimuth_deg.assign(s.view().azimuth_deg().begin(), s.view().azimuth_deg().end());
  out.source_zenith_deg.assign(s.source().zenith_deg().begin(), s.source().zenith_deg().end());
  out.source_distance_m = s.source().distance_m();
  out.source_angular_radius_deg = s.source().angular_radius_deg();
  out.sensor_range_m = s.sensor().range_m();
  out.field = *field;
  out.field_width_m = s.sensor().field_width_m();
  out.field_height_m = s.sensor().field_height_m();
  out.reference_height_m = s.sensor().reference_height_m();
  out.samples_per_replicate = s.accuracy().samples_per_replicate();
  out.replicates = s.accuracy().replicates();
  out.max_reflections = s.accuracy().max_reflections();
  out.seed = s.seed();
  out.threads = threads;
  return out;
}

}  // namespace irsig
