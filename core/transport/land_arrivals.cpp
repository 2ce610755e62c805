// What land does to paths: it hides the target from the sensor and from suns, rays end on it, and
// it stands behind the target.

#include <algorithm>
#include <array>
#include <limits>

#include "core/transport/path_work.h"

namespace irsig {
namespace {

constexpr double kFarM = 1e9;

Vec<Body> to_double(Float3 v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

}  // namespace

bool PathTracer::hidden_by_land(Float3 p, Vec<Body> direction, double most) const {
  return land_ != nullptr &&
         land_->field().hidden(land_->place(to_double(p)), land_->direction(direction), most);
}

bool PathTracer::shaded_by_land(RayBatch& batch, std::uint32_t ray) const {
  if (land_ == nullptr) return false;
  const RayPacket& packet = batch.packet_of(ray);
  const std::uint32_t lane = RayBatch::lane_of(ray);
  return hidden_by_land({packet.org_x[lane], packet.org_y[lane], packet.org_z[lane]},
                        to_double({packet.dir_x[lane], packet.dir_y[lane], packet.dir_z[lane]}),
                        kFarM);
}

bool PathTracer::below_land(Float3 p) const {
  if (land_ == nullptr) return false;
  const Vec<Enu> at = land_->place(to_double(p));
  const std::optional<double> surface_m = land_->field().z_m(at.x, at.y);
  return surface_m && at.z < *surface_m;
}

std::optional<PathTracer::LandPoint> PathTracer::meet_land(Work& work, Float3 from,
                                                           Float3 direction) const {
  const HeightField& field = land_->field();
  const Vec<Enu> origin = land_->place(to_double(from)),
                 along = land_->direction(to_double(direction));
  const std::optional<LandHit> hit = field.first_hit(origin, along, kFarM);
  if (!hit || hit->at_edge) return std::nullopt;
  LandPoint out;
  out.distance = hit->distance;
  out.normal = hit->normal;
  out.departure_m = field.departure_m(origin, along, *hit);
  land_->cover().at(out.departure_m.x, out.departure_m.y, work.land_fraction);
  return out;
}

// Returns the share of a slope's hemisphere that is sky, as if land around it were level.
float PathTracer::sky_view(const LandPoint& land) {
  return static_cast<float>(std::min(1.0, 0.5 * (1 + land.normal.z)));
}

// Returns the cosine of a sun's incidence on land, 0 in the shadow of land.
double PathTracer::sun_on_land(const LandPoint& land, std::uint32_t j) const {
  const Vec<Enu> towards = land_->direction(sources_.sun[j].direction);
  const double cosine = dot(land.normal, towards);
  if (cosine <= 0 || land_->field().hidden(land.departure_m, towards, kFarM)) return 0;
  return cosine;
}

template <bool kSpectral>
bool PathTracer::end_on_land(Work& work, std::uint32_t order, const PathState& path, Float3 from,
                             Float3 direction, const float* spectrum) const {
  const std::optional<LandPoint> land = meet_land(work, from, direction);
  if (!land) return false;
  const Land::RangeShare range = land_->around(land->distance);
  const std::array<float, 2> share{1 - range.weight_of_next, range.weight_of_next};
  const auto materials = static_cast<std::uint32_t>(work.land_fraction.size());
  const float open = sky_view(*land);
  for (std::uint32_t m = 0; m < 2 * materials; ++m) {
    const float fraction = m < materials ? work.land_fraction[m] * open
                                         : work.land_fraction[m - materials] * (1 - open);
    if (!(fraction > 0)) continue;
    for (std::uint32_t k = 0; k < 2; ++k)
      add<kSpectral>(work, path, order, layout_.land(m, range.node + k),
                     path.weight * fraction * share[k], spectrum);
  }
  const auto t = static_cast<float>(land->distance);
  const auto offset_m = static_cast<float>(target_.offset_m());
  const Float3 place{from.x + t * direction.x, from.y + t * direction.y,
                     from.z + t * direction.z - offset_m};
  for (std::uint32_t j = 0; j < sources_.sun.size(); ++j) {
    const double cosine = sun_on_land(*land, j);
    if (cosine <= 0) continue;
    PathState s = path;
    s.weight *= static_cast<float>(cosine);
    const std::uint32_t ray = work.land_shadow.push(place, work.sun[j].direction, s);
    work.land_sun[ray] = j;
    work.land_range[ray] = range;
    std::copy(
        work.land_fraction.begin(), work.land_fraction.end(),
        work.land_fractions.begin() + static_cast<std::ptrdiff_t>(ray * std::size_t{materials}));
    if (spectral_)
      std::copy_n(spectrum, nodes_,
                  work.land_shadow.spectrum.data() + static_cast<std::size_t>(ray) * nodes_);
  }
  return true;
}

// Adds the sunlight of land that the target does not shade.
template <bool kSpectral>
void PathTracer::trace_land_suns(Work& work, std::uint32_t order) const {
  RayBatch& batch = work.land_shadow;
  if (batch.size == 0) return;
  batch.prepare_packets(false);
  batch.for_each_packet(
      [&](RayPacket& packet, int count) { target_.tracer->occluded(packet, count, true); });
  work.counts->rays += batch.size;
  work.counts->glint_rays += batch.size;
  const auto materials = static_cast<std::uint32_t>(work.land_fraction.size());
  for (std::uint32_t i = 0; i < batch.size; ++i) {
    if (batch.packet_of(i).tfar[RayBatch::lane_of(i)] < 0) continue;
    const PathState& s = batch.state[i];
    const Land::RangeShare& range = work.land_range[i];
    const std::array<float, 2> share{1 - range.weight_of_next, range.weight_of_next};
    const float* spectrum =
        batch.spectrum.data() + static_cast<std::size_t>(i) * (kSpectral ? nodes_ : 0);
    for (std::uint32_t m = 0; m < materials; ++m) {
      const float fraction = work.land_fractions[i * std::size_t{materials} + m];
      if (!(fraction > 0)) continue;
      for (std::uint32_t k = 0; k < 2; ++k)
        add<kSpectral>(work, s, order, layout_.land_sun(work.land_sun[i], m, range.node + k),
                       s.weight * fraction * share[k], spectrum);
    }
  }
  batch.size = 0;
}

// The silhouette, before land: without the shadow of the target, which would not be there.
bool PathTracer::add_land_behind(Work& work, const PathState& path, Float3 from,
                                 Float3 direction) const {
  if (layout_.behind_ranges() == 0) return false;
  const std::optional<LandPoint> land = meet_land(work, from, direction);
  if (!land) return false;
  const double range_m = length(to_double(from) - view_.frame.sensor) + land->distance;
  const Land::RangeShare range = land_->behind(range_m);
  const std::array<float, 2> share{1 - range.weight_of_next, range.weight_of_next};
  const auto each = [&](float factor, const auto& source) {
    for (std::uint32_t m = 0; m < work.land_fraction.size(); ++m)
      for (std::uint32_t k = 0; k < 2; ++k)
        if (const float w = factor * work.land_fraction[m] * share[k]; w > 0)
          add_behind_to(work, path, source(m, range.node + k), w);
  };
  const float open = sky_view(*land);
  each(open, [&](std::uint32_t m, std::uint32_t node) { return layout_.behind_land(m, node); });
  each(1 - open, [&](std::uint32_t m, std::uint32_t node) {
    return layout_.behind_land(layout_.land_materials() + m, node);
  });
  for (std::uint32_t j = 0; j < sources_.sun.size(); ++j)
    if (const double cosine = sun_on_land(*land, j); cosine > 0)
      each(static_cast<float>(cosine), [&](std::uint32_t m, std::uint32_t node) {
        return layout_.behind_land_sun(j, m, node);
      });
  return true;
}

template bool PathTracer::end_on_land<false>(Work&, std::uint32_t, const PathState&, Float3, Float3,
                                             const float*) const;
template bool PathTracer::end_on_land<true>(Work&, std::uint32_t, const PathState&, Float3, Float3,
                                            const float*) const;
template void PathTracer::trace_land_suns<false>(Work&, std::uint32_t) const;
template void PathTracer::trace_land_suns<true>(Work&, std::uint32_t) const;

}  // namespace irsig
