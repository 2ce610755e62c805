// Handles the ends of rays: on the target, beyond it, or on the sea that mirrors a sun.

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/transport/path_work.h"

// The stages are one loop, cut up for the reader: all are inlined into it.
#define IRSIG_STAGE [[gnu::always_inline]] inline

namespace irsig {

// Values that all arrivals of a batch share.
struct PathTracer::Arrivals {
  std::uint32_t order;
  float offset_m, roulette_survival_scale;
  float surface_z_m;  // of sea or ground, with the offset; infinite: there is none
  bool horizon;       // whether the Earth may hide what these rays met
  float horizon_z;    // rays that fall more steeply end below the horizon
  bool uniform;       // sky and sea are

  Arrivals(const PathTracer& tracer, std::uint32_t of_order)
      : order(of_order),
        offset_m(static_cast<float>(tracer.target_.offset_m())),
        roulette_survival_scale(static_cast<float>(tracer.settings_.roulette_survival_scale)),
        surface_z_m(tracer.plane_ ? static_cast<float>(tracer.plane_->z_m) + offset_m
                                  : std::numeric_limits<float>::infinity()),
        horizon(order == 0 && tracer.plane_ && tracer.plane_->earth_radius_m > 0 &&
                tracer.view_.frame.sensor.z > tracer.plane_->z_m),
        horizon_z(static_cast<float>(order == 0 ? tracer.sources_.horizon_z
                                                : tracer.sources_.around_horizon_z)),
        uniform(tracer.sources_.directions.uniform()) {}
};

// A ray of a batch, as it left its last vertex.
struct PathTracer::Ray {
  std::uint32_t index;  // in the batch
  RayPacket& packet;
  std::uint32_t lane;
  PathState& state;
  const float* spectrum;  // of its path
  Float3 from, direction;

  Ray(RayBatch& batch, std::uint32_t i, std::size_t spectrum_columns)
      : index(i),
        packet(batch.packet_of(i)),
        lane(RayBatch::lane_of(i)),
        state(batch.state[i]),
        spectrum(batch.spectrum.data() + i * spectrum_columns),
        from{packet.org_x[lane], packet.org_y[lane], packet.org_z[lane]},
        direction{packet.dir_x[lane], packet.dir_y[lane], packet.dir_z[lane]} {}
};

// Place at which a ray meets the target.
struct PathTracer::Hit {
  std::uint32_t facet;
  std::uint32_t part;
  Float3 at, normal;  // normal: on the side of the ray
  float along;        // in units of the ray's direction
  float cos_o;
  std::uint32_t material;
  Material::EmissivityAndDhr surface;
};

// Kind of a ray's end. kNothing: it does not count (another stratum has it, or it met a back).
IRSIG_STAGE PathTracer::Met PathTracer::find_hit(const Arrivals& all, Work& work, const Ray& ray,
                                                 Hit& hit) const {
  RayPacket& packet = ray.packet;
  const std::uint32_t lane = ray.lane;
  const Float3 d = ray.direction;
  if (packet.triangle[lane] == RayPacket::kMiss)
    return d.z * ray.state.inverse_length < all.horizon_z ? Met::kAbove : Met::kBelow;
  const auto from_behind = [&] {
    const Target::Facet& met = target_.facet[packet.triangle[lane]];
    return !target_.part[met.part].two_sided && dot({met.nx, met.ny, met.nz}, d) >= 0;
  };
  if (from_behind()) target_.tracer->look_for_front(packet, static_cast<int>(lane), all.offset_m);
  hit.facet = packet.triangle[lane];
  hit.along = packet.tfar[lane];
  hit.at = {ray.from.x + hit.along * d.x, ray.from.y + hit.along * d.y,
            ray.from.z + hit.along * d.z};
  const Target::Facet& facet = target_.facet[hit.facet];
  hit.part = facet.part;
  if (all.order == 0 && view_.stratum_of(hit.facet, facet.part) != work.stratum)
    return Met::kNothing;
  // Under water (or ground): the path ended on the surface above.
  if (hit.at.z > all.surface_z_m) return Met::kBelow;
  if (land_ != nullptr && all.order > 0 && below_land(hit.at)) return Met::kBelow;
  hit.normal = {facet.nx, facet.ny, facet.nz};
  // Rays through gas begin before it, far from a small target: as far as their own rounding goes, a
  // vertex must not lie behind its facet.
  if (all.order == 0 && gas_ != nullptr) {
    const float* corner =
        target_.vertex.data() + 3 * static_cast<std::size_t>(target_.triangle[3 * hit.facet]);
    const float off =
        dot(hit.normal, {hit.at.x - corner[0], hit.at.y - corner[1], hit.at.z - corner[2]});
    hit.at = {hit.at.x - off * facet.nx, hit.at.y - off * facet.ny, hit.at.z - off * facet.nz};
  }
  hit.cos_o = -dot(hit.normal, d) * ray.state.inverse_length;
  const PartSpec& part = target_.part[facet.part];
  hit.material = part.material;
  if (hit.cos_o <= 0 && part.two_sided) {
    hit.normal = {-hit.normal.x, -hit.normal.y, -hit.normal.z};
    hit.cos_o = -hit.cos_o;
  }
  const auto hidden = [&] {
    if (all.horizon && hidden_by_sea(hit.at, d, ray.state.inverse_length)) return true;
    if (land_ == nullptr || all.order > 0) return false;
    return !seen_past_land({hit.at.x + all.offset_m * hit.normal.x,
                            hit.at.y + all.offset_m * hit.normal.y,
                            hit.at.z + all.offset_m * hit.normal.z});
  };
  if (hit.cos_o <= 0) {
    ++work.counts->guarded_backface_hits;
    if (all.order == 0 && !hidden()) {
      ++work.counts->silhouette_backface_hits;
      work.background_area[ray.state.replicate] += static_cast<double>(ray.state.weight);
    }
    return Met::kNothing;
  }
  hit.cos_o = std::min(hit.cos_o, 1.0f);
  if (!hidden()) return Met::kTarget;
  if (all.order == 0)
    work.hidden_area[ray.state.replicate] += static_cast<double>(ray.state.weight);
  return Met::kBelow;
}

// A ray that meets no target; a primary one counts where the background is asked for.
template <bool kSpectral>
IRSIG_STAGE void PathTracer::end_beyond(const Arrivals& all, Work& work, const Ray& ray,
                                        bool above) const {
  const std::uint32_t order = all.order;
  PathState& s = ray.state;
  const Float3 d = ray.direction;
  if (order == 0 && gas_ != nullptr) {
    s.first |= 1;
    if (sources_.behind)
      add_behind(work, s, ray.from,
                 {d.x * s.inverse_length, d.y * s.inverse_length, d.z * s.inverse_length});
    return;
  }
  if (order == 0 && !settings_.background) return;
  const float* spectrum = ray.spectrum;
  if (land_ != nullptr && order > 0 &&
      end_on_land<kSpectral>(work, order, s, ray.from, d, spectrum))
    return;
  if (order > 0 && any_glint_ && !above) meet_sea(work, s, ray.from, d, spectrum);
  if (order == 0) {
    s.first = parts_;
    spectrum = work.ones.data();
  }
  if (all.uniform) {
    add<kSpectral>(work, s, order, above ? layout_.first_sky() : layout_.first_lower(), s.weight,
                   spectrum);
    return;
  }
  // Between the horizontal and the horizon: the sky at the horizontal, unless nodes lie there.
  const float z = sources_.directions.has_limb() ? d.z * s.inverse_length
                  : above                        ? std::min(d.z * s.inverse_length, -1e-30f)
                                                 : std::max(d.z * s.inverse_length, 0.0f);
  DirectionNodes::Share share[4];
  const int count = sources_.directions.shares(d.x, d.y, z, share);
  for (int k = 0; k < count; ++k)
    add<kSpectral>(work, s, order, layout_.node(share[k].node), s.weight * share[k].weight,
                   spectrum);
}

// The first facet of a path: what it is counted under, and what stands behind it.
IRSIG_STAGE void PathTracer::begin_path(Work& work, const Ray& ray, const Hit& hit) const {
  PathState& s = ray.state;
  if (gas_ == nullptr) s.first = hit.part;
  ++work.counts->target_paths;
  work.area[s.replicate] += static_cast<double>(s.weight);
  if (settings_.pixel_samples > 0 && gas_ == nullptr)
    work.met.push_back({pixel_of(work, s), hit.part, 1});
  if (work.plan->first_hits) add_first_hit(work, s, hit);
  if (!sources_.behind) return;
  const Float3 d = ray.direction;
  add_behind(work, s, hit.at,
             {d.x * s.inverse_length, d.y * s.inverse_length, d.z * s.inverse_length});
}

// Stores the distance at which a pixel's rays meet the target, and values of the hit.
// light_first_hits finds for the whole batch whether the hits are in the sun.
void PathTracer::add_first_hit(Work& work, const PathState& path, const Hit& hit) const {
  const ImagePlan& plan = *work.plan;
  const std::size_t pixel = stored_pixel(plan, pixel_of(work, path));
  double* sum = work.pictures->first_sum.data() + pixel * plan.first_numbers();
  *sum++ += length(Vec<Body>{hit.at.x, hit.at.y, hit.at.z} - view_.frame.sensor);
  const std::size_t emitter = sources_.emitters.of(hit.facet, hit.part);
  for (std::size_t k = 0; k < plan.values; ++k)
    *sum++ += static_cast<double>(plan.of_emitter[emitter * plan.values + k]);
  const Float3 p = hit.at, n = hit.normal;
  if (plan.normals)
    for (const float along : {n.x, n.y, n.z}) *sum++ += static_cast<double>(along);
  if (plan.towards_sun.empty()) return;
  const auto offset = static_cast<float>(target_.offset_m());
  work.first_hit.push_back(
      {pixel, {p.x + offset * n.x, p.y + offset * n.y, p.z + offset * n.z}, n});
}

// A path's weight where the last vertex may have aimed at this hot part as well: its share by the
// balance heuristic.
IRSIG_STAGE float PathTracer::unaimed_weight(const Work& work, const Ray& ray,
                                             const Hit& hit) const {
  const float weight = ray.state.weight;
  const std::uint32_t light = hot_.light_of(hit.facet);
  const float* drawn =
      work.batch.drawn.data() + static_cast<std::size_t>(ray.index) * (1 + hot_.count());
  if (light == HotLights::kNone || !(drawn[1 + light] > 0)) return weight;
  const float aimed =
      drawn[1 + light] * hot_.density_per_sr(hit.facet, ray.from, hit.along * hit.along, hit.cos_o);
  return weight * (drawn[0] / (drawn[0] + aimed));
}

template <bool kSpectral>
IRSIG_STAGE void PathTracer::add_emission(const Arrivals& all, Work& work, const Ray& ray,
                                          const Hit& hit) const {
  const std::uint32_t order = all.order;
  const std::uint32_t emitter = sources_.emitters.of(hit.facet, hit.part);
  const SourceId source = order == 0 ? layout_.seen(emitter) : layout_.reflected(emitter);
  const float weight =
      order > 0 && hot_.count() > 0 ? unaimed_weight(work, ray, hit) : ray.state.weight;
  if constexpr (kSpectral) {
    materials_[hit.material].spectral_emissivity(hit.cos_o, work.row.data());
    if (order > 0)
      for (std::size_t k = 0; k < nodes_; ++k) work.row[k] *= ray.spectrum[k];
    add<kSpectral>(work, ray.state, order, source, weight, work.row.data());
  } else {
    add<kSpectral>(work, ray.state, order, source, weight * hit.surface.emissivity, nullptr);
  }
}

// A vertex at which a path may go on, if any reflection is left to it.
IRSIG_STAGE void PathTracer::list_vertex(const Arrivals& all, Work& work, const Ray& ray,
                                         const Hit& hit) const {
  const std::uint32_t order = all.order;
  const PathState& s = ray.state;
  const float dhr_max = hit.surface.dhr_max;
  work.beyond[s.replicate * (settings_.max_reflections + 1) + order] +=
      static_cast<double>(s.weight * s.spectral_max * dhr_max);
  if (order == settings_.max_reflections) {
    ++work.counts->truncated_paths;
    return;
  }
  const float offset = all.offset_m;
  const Float3 d = ray.direction, p = hit.at, n = hit.normal;
  VertexList& vertex = work.vertex;
  const std::uint32_t v = vertex.size++;
  vertex.px[v] = p.x + offset * n.x;
  vertex.py[v] = p.y + offset * n.y;
  vertex.pz[v] = p.z + offset * n.z;
  vertex.nx[v] = n.x;
  vertex.ny[v] = n.y;
  vertex.nz[v] = n.z;
  vertex.ox[v] = -d.x * s.inverse_length;
  vertex.oy[v] = -d.y * s.inverse_length;
  vertex.oz[v] = -d.z * s.inverse_length;
  vertex.cos_o[v] = hit.cos_o;
  vertex.roughness2[v] = materials_[hit.material].roulette_slope2();
  // Reflections cost more rays than primary hits and scatter more: the first vertex may send out
  // several.
  vertex.survival[v] =
      (order == 0 ? static_cast<float>(settings_.split) : 1.0f) *
      std::min(1.0f, all.roulette_survival_scale * s.throughput * s.spectral_max * dhr_max);
  vertex.path[v] = ray.index;
  vertex.material[v] = hit.material;
}

// Handles the hit of each ray: adds terminal radiance, and lists the vertices at which a path may
// go on.
template <bool kSpectral>
void PathTracer::arrive(Work& work, std::uint32_t order) const {
  const Arrivals all(*this, order);
  work.vertex.size = 0;
  for (std::uint32_t i = 0; i < work.batch.size; ++i) {
    const Ray ray(work.batch, i, kSpectral ? nodes_ : 0);
    Hit hit;
    const Met met = find_hit(all, work, ray, hit);
    if (met == Met::kNothing) continue;
    if (met != Met::kTarget) {
      end_beyond<kSpectral>(all, work, ray, met == Met::kAbove);
      continue;
    }
    if (order == 0) begin_path(work, ray, hit);
    const Material& material = materials_[hit.material];
    hit.surface = material.emissivity_and_dhr(hit.cos_o);
    add_emission<kSpectral>(all, work, ray, hit);
    if (hit.surface.dhr_max <= 0) continue;
    list_vertex(all, work, ray, hit);
  }
}

// A reflected ray that ends on the sea: what of each sun the sea mirrors into it, if nothing shades
// that place. `direction` is of unit length.
void PathTracer::meet_sea(Work& work, const PathState& path, Float3 from, Float3 direction,
                          const float* spectrum) const {
  if (direction.z <= 0) return;
  const Vec<Body> to_observer{-static_cast<double>(direction.x), -static_cast<double>(direction.y),
                              -static_cast<double>(direction.z)};
  // The plane of the water, and a start offset above it: the part below has facets too.
  const float height = static_cast<float>(plane_->z_m - target_.offset_m()) - from.z;
  const float t = std::max(height, 0.0f) / direction.z;
  const Float3 place{from.x + t * direction.x, from.y + t * direction.y, from.z + t * direction.z};
  for (std::uint32_t j = 0; j < sources_.sun.size(); ++j) {
    if (!(sources_.sun[j].sea_wind_m_s > 0)) continue;
    if (static_cast<double>(direction.z) < sources_.sun[j].sea_begins_z) continue;
    const SeaGlint glint =
        sea_glint(to_observer, sources_.sun[j].direction, sources_.sun[j].sea_wind_m_s);
    // Less than 1e-6 of a diffuse white sea.
    if (!(glint.per_sr > 3e-7f)) continue;
    PathState s = path;
    s.weight *= glint.per_sr;
    const std::uint32_t ray = work.glint_shadow.push(place, work.sun[j].direction, s);
    work.glint_sun[ray] = j;
    work.glint_at[ray] = glint_fraction(glint.cos_incidence);
    if (spectral_)
      std::copy_n(spectrum, nodes_,
                  work.glint_shadow.spectrum.data() + static_cast<std::size_t>(ray) * nodes_);
  }
}

template <bool kSpectral>
void PathTracer::trace_glint(Work& work, std::uint32_t order) const {
  RayBatch& batch = work.glint_shadow;
  if (batch.size == 0) return;
  batch.prepare_packets(false);
  // The ray comes from the sea, which is not on the target: the target's shadow falls there even if
  // it is convex.
  batch.for_each_packet(
      [&](RayPacket& packet, int count) { target_.tracer->occluded(packet, count, true); });
  work.counts->rays += batch.size;
  work.counts->glint_rays += batch.size;
  for (std::uint32_t i = 0; i < batch.size; ++i) {
    if (batch.packet_of(i).tfar[RayBatch::lane_of(i)] < 0) continue;
    const PathState& s = batch.state[i];
    const GlintShare& at = work.glint_at[i];
    const float* spectrum =
        batch.spectrum.data() + static_cast<std::size_t>(i) * (kSpectral ? nodes_ : 0);
    const auto node = static_cast<std::uint32_t>(at.node);
    const SourceId first = layout_.glint(work.glint_sun[i], node),
                   next = layout_.glint(work.glint_sun[i], node + 1);
    add<kSpectral>(work, s, order, first, s.weight * (1 - at.weight_of_next), spectrum);
    add<kSpectral>(work, s, order, next, s.weight * at.weight_of_next, spectrum);
  }
  batch.size = 0;
}

// The silhouette, by what stands behind it.
void PathTracer::add_behind(Work& work, const PathState& path, Float3 from,
                            Float3 direction) const {
  if (land_ != nullptr) return add_land_behind(work, path, from, direction);
  BackgroundDirections::Share share[2];
  const int count = sources_.behind->shares(direction.z, share);
  for (int k = 0; k < count; ++k)
    add_behind_to(work, path, layout_.behind(share[k].node), share[k].weight);
}

void PathTracer::add_behind_to(Work& work, const PathState& path, SourceId source,
                               float fraction) const {
  for_each_first(work, path, [&](std::uint32_t first, float part) {
    double* out = work.weight[path.replicate * work.orders].row(first, source);
    const auto weight = static_cast<double>(part * path.weight * fraction);
    for (std::size_t i = 0; i < nodes_; ++i) out[i] += weight;
    if (!work.plan->behind) return;
    add_behind_to_image(work, path, first, source,
                        work.area_per_sample * part * path.weight * fraction);
  });
}

void PathTracer::add_behind_to_image(Work& work, const PathState& path, std::uint32_t first,
                                     SourceId source, float weight) const {
  const ImagePlan& plan = *work.plan;
  double* image = image_of(work, path, source);
  const std::size_t place =
      index_of(source) + (gas_ != nullptr ? static_cast<std::size_t>(first) * layout_.count() : 0);
  const float* shown =
      plan.source.data() + place * (spectral_ ? plan.images * nodes_ : plan.padded);
  for (std::uint32_t k = 0; k < plan.images; ++k) {
    float sum = 0;
    for (std::size_t i = 0; i < (spectral_ ? nodes_ : 1); ++i) sum += *shown++;
    image[k] += static_cast<double>(weight * sum);
  }
}

// The segment to the sensor against the sphere of the Earth, from the point's height above the
// waterline; both are those that refraction makes straight.
bool PathTracer::hidden_by_sea(Float3 p, Float3 d, float inverse_length) const {
  const double h = plane_->z_m - static_cast<double>(p.z), radius = plane_->earth_radius_m;
  const double slant = inverse_length, ex = -d.x * slant, ey = -d.y * slant,
               up = d.z * slant + plane_->lift_rad;
  const double b = p.x * ex + p.y * ey + (radius + h) * up;
  const double c =
      static_cast<double>(p.x) * p.x + static_cast<double>(p.y) * p.y + 2 * radius * h + h * h;
  if (!(b < 0 && b * b > c)) return false;
  // Distance at which the line enters the sphere; it may lie behind the sensor.
  const Vec<Body>& sensor = view_.frame.sensor;
  const double entry_m = c / (-b + std::sqrt(b * b - c));
  return entry_m < length(sensor - Vec<Body>{static_cast<double>(p.x), static_cast<double>(p.y),
                                             static_cast<double>(p.z)});
}

#undef IRSIG_STAGE

template void PathTracer::arrive<false>(Work&, std::uint32_t) const;
template void PathTracer::arrive<true>(Work&, std::uint32_t) const;
template void PathTracer::trace_glint<false>(Work&, std::uint32_t) const;
template void PathTracer::trace_glint<true>(Work&, std::uint32_t) const;

}  // namespace irsig
