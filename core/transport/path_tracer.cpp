#include "core/transport/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/transport/path_work.h"

namespace irsig {
namespace {

// Pairs of later orders are made when they are needed.
constexpr std::uint32_t kSeedOrders = 33;

}  // namespace

SourceClasses source_classes(std::size_t parts, std::span<const SunDirection> suns,
                             bool lower_is_sea, const DirectionNodes& directions,
                             const DirectionNodes* behind) {
  SourceClasses out;
  out.parts = static_cast<std::uint32_t>(parts);
  out.suns = static_cast<std::uint32_t>(suns.size());
  out.sky_nodes = directions.sky();
  out.lower_nodes = directions.lower();
  out.behind_nodes = behind != nullptr ? behind->count() : 0;
  for (const SunDirection& s : suns)
    if (lower_is_sea && s.sea_wind_m_s > 0 && s.direction.z < 0)
      out.glint_nodes = static_cast<std::uint32_t>(kGlintCosines.size());
  return out;
}

PathTracer::PathTracer(const Target& target, std::span<const Material> materials,
                       const AimedView& view, std::vector<SunDirection> suns, PathSettings settings)
    : target_(target),
      materials_(materials),
      suns_(std::move(suns)),
      settings_(settings),
      view_(view),
      hot_(settings.hot_lights ? HotLights(target) : HotLights()) {
  classes_ = source_classes(target.part.size(), suns_, settings_.lower_is_sea, settings_.directions,
                            settings_.behind ? &*settings_.behind : nullptr);
  any_glint_ = classes_.glint_nodes > 0;
  for (const Material& m : materials_) spectral_ |= !m.grey();
  if (spectral_) nodes_ = materials_.front().nodes();
  float widest_radius = 0;
  if (settings_.sun_disk_by_chance)
    for (const SunDirection& s : suns_)
      widest_radius = std::max(widest_radius, static_cast<float>(std::tan(s.angular_radius_rad)));
  for (const Material& m : materials_) {
    any_narrow_ |= m.narrowest_slope() < kNarrowRadii * widest_radius;
    any_bright_ |= m.narrowest_slope() < kBrightSlope;
  }
}

std::vector<PathWeights> PathTracer::trace(const ImagePlan& plan, std::vector<double>& image,
                                           PathCounts& counts) const {
  Work work;
  work.plan = &plan;
  work.image = image.data();
  work.counts = &counts;
  work.bins = bins() * (settings_.by_order ? settings_.max_reflections + 1 : 1);
  for (const SunDirection& s : suns_) {
    const double tangent = std::tan(s.angular_radius_rad);
    Sun sun{to_float(s.direction),
            {},
            {},
            static_cast<float>(std::sin(s.angular_radius_rad)) + 1e-6f,
            static_cast<float>(tangent * tangent),
            s.distance_m > 0 ? static_cast<float>(1 / s.distance_m) : 0.0f,
            static_cast<float>(1 / (std::numbers::pi * tangent * tangent)),
            settings_.sun_disk_by_chance ? kNarrowRadii * static_cast<float>(tangent) : 0.0f};
    orthonormal_basis(sun.direction, sun.tangent1, sun.tangent2);
    const auto r = static_cast<float>(tangent);
    for (Float3* t : {&sun.tangent1, &sun.tangent2}) *t = {r * t->x, r * t->y, r * t->z};
    work.sun.push_back(sun);
  }
  counts.sun_met_first.resize(suns_.size());
  counts.sun_met_later.resize(suns_.size());
  // Large enough to fill packets, small enough to stay in the second-level cache.
  const std::uint32_t capacity = spectral_ ? 256 : 1024;
  const std::size_t row = spectral_ ? nodes_ : 0;
  const std::uint32_t most = capacity * settings_.split;  // after splitting
  work.capacity = capacity;
  work.most = most;
  const std::size_t drawn = hot_.count() > 0 ? 1 + hot_.count() : 0;
  work.batch.resize(most, row, drawn);
  work.next.resize(most, row, drawn);
  work.shadow.resize(suns_.size());
  for (RayBatch& b : work.shadow) b.resize(any_narrow_ ? 2 * most : most, row);
  work.sun_keep.resize(suns_.size() * most);
  if (hot_.count() > 0) {
    work.hot_shadow.resize(most, row);
    work.hot_rate.resize(hot_.count() * most);
    work.hot_class.resize(most);
    work.hot_light.resize(most);
    for (auto* v : {&work.hot_total, &work.hot_pick}) v->resize(most);
  }
  if (any_glint_) {
    const auto rays = static_cast<std::uint32_t>(most * suns_.size());
    work.glint_shadow.resize(rays, row);
    work.glint_sun.resize(rays);
    work.glint_at.resize(rays);
  }
  work.row.resize(nodes_);
  work.list.resize(most);
  work.replicate_of_list.resize(capacity);
  for (auto* v : {&work.x_m, &work.y_m, &work.ray_weight, &work.inverse_length, &work.roulette_x,
                  &work.roulette_y, &work.lobe})
    v->resize(most);
  work.child_sample.resize(most);
  work.ones.assign(nodes_, 1.0f);
  work.vertex.resize(most);
  work.chosen.resize(most + 1);

  std::vector<PathWeights> out(settings_.replicates);
  const bool keep_last = settings_.max_reflections >= 2;
  const std::size_t last_bins = keep_last ? bins() : 0;
  const std::size_t orders = settings_.max_reflections + 1;
  for (PathWeights& w : out) {
    w.weight.assign(work.bins, 0.0);
    w.last.assign(last_bins, 0.0);
    w.beyond_order_m2.assign(orders, 0.0);
  }
  for (std::uint32_t s = 0; s < view_.stratum.size(); ++s) {
    if (view_.stratum[s].empty()) continue;
    work.stratum = s;
    work.weight.assign(settings_.replicates * work.bins, 0.0);
    work.last.assign(settings_.replicates * last_bins, 0.0);
    work.area.assign(settings_.replicates, 0.0);
    work.beyond.assign(settings_.replicates * orders, 0.0);
    if (spectral_)
      trace_stratum<true>(work, s);
    else
      trace_stratum<false>(work, s);
    const double normalise =
        view_.stratum[s].area_m2() / static_cast<double>(stratum_samples(s, settings_.samples));
    for (std::uint32_t r = 0; r < settings_.replicates; ++r) {
      for (std::size_t i = 0; i < work.bins; ++i)
        out[r].weight[i] += normalise * work.weight[r * work.bins + i];
      for (std::size_t i = 0; i < last_bins; ++i)
        out[r].last[i] += normalise * work.last[r * last_bins + i];
      out[r].projected_area_m2 += normalise * work.area[r];
      for (std::size_t k = 0; k < orders; ++k)
        out[r].beyond_order_m2[k] += normalise * work.beyond[r * orders + k];
    }
  }
  const std::size_t spacing = beyond_spacing(settings_.max_reflections);
  for (PathWeights& w : out) {
    for (std::size_t k = 0; k < 3; ++k)
      if ((2 - k) * spacing < orders)
        w.beyond_m2[k] = w.beyond_order_m2[settings_.max_reflections - (2 - k) * spacing];
    w.truncated_m2 = w.beyond_m2[2];
  }
  return out;
}

std::uint64_t stratum_samples(std::uint32_t stratum, std::uint64_t samples) {
  return stratum == 0 ? samples : std::max<std::uint64_t>(64, samples / 8);
}

namespace {

// The seeds of one order's pairs: [replicate][pair].
void add_seeds(const std::vector<std::uint64_t>& replicate_seed, std::uint32_t order,
               std::vector<SeedPair>& out) {
  for (const std::uint64_t seed : replicate_seed)
    for (std::uint32_t pair = 0; pair < kPairsPerVertex; ++pair)
      out.push_back(seed_pair(seed, 1 + kPairsPerVertex * order + pair));
}

}  // namespace

const SeedPair* PathTracer::seeds_of(Work& work, std::uint32_t order) const {
  if (order < kSeedOrders)
    return work.seeds.data() +
           static_cast<std::size_t>(order) * settings_.replicates * kPairsPerVertex;
  work.late_seeds.clear();
  add_seeds(work.stratum_seed, order, work.late_seeds);
  return work.late_seeds.data();
}

template <bool kSpectral>
void PathTracer::trace_stratum(Work& work, std::uint32_t stratum) const {
  const CoverageMask& mask = view_.stratum[stratum];
  const std::uint64_t samples = stratum_samples(stratum, settings_.samples);
  work.area_per_sample = static_cast<float>(mask.area_m2() / static_cast<double>(samples));
  work.stratum_seed.clear();
  std::vector<SeedPair> aim;
  for (std::uint32_t r = 0; r < settings_.replicates; ++r) {
    const std::uint64_t seed = mix64(mix64(settings_.seed ^ mix64(r)) + stratum);
    work.stratum_seed.push_back(seed);
    aim.push_back(seed_pair(seed, 0));
  }
  work.seeds.clear();
  for (std::uint32_t order = 0; order < std::min(kSeedOrders, settings_.max_reflections + 1);
       ++order)
    add_seeds(work.stratum_seed, order, work.seeds);
  const CellOrder order(samples, aim);

  SampleList& list = work.list;
  list.size = 0;
  const std::uint64_t cells = static_cast<std::uint64_t>(order.side()) * order.side();
  for (std::uint64_t cell = 0; cell < cells; ++cell) {
    const std::uint32_t x = compact_even_bits(cell), y = compact_even_bits(cell >> 1);
    for (std::uint32_t r = 0; r < settings_.replicates; ++r) {
      const std::uint32_t index = order.sample(r, x, y);
      if (index == CellOrder::kNone) continue;
      const std::uint32_t i = list.size++;
      list.index[i] = index;
      list.seed_x[i] = aim[r].x;
      list.seed_y[i] = aim[r].y;
      work.replicate_of_list[i] = r;
      if (list.size == work.capacity) {
        aim_batch(work, mask);
        trace_batch<kSpectral>(work);
        list.size = 0;
      }
    }
  }
  aim_batch(work, mask);
  trace_batch<kSpectral>(work);
}

// Turns the listed samples into primary rays.
void PathTracer::aim_batch(Work& work, const CoverageMask& mask) const {
  SampleList& list = work.list;
  settings_.pseudo_random ? draw_pairs_random(list) : draw_pairs(list);
  for (std::uint32_t i = 0; i < list.size; ++i) {
    const CoverageMask::Point p = mask.map({list.x[i], list.y[i]});
    work.x_m[i] = p.x_m;
    work.y_m[i] = p.y_m;
  }
  ImagePlane plane{to_float(view_.frame.sensor + view_.frame.plane_m * view_.frame.forward),
                   to_float(view_.frame.right),
                   to_float(view_.frame.up),
                   to_float(view_.frame.forward),
                   static_cast<float>(1 / view_.frame.plane_m),
                   static_cast<float>(view_.range_m * view_.range_m /
                                      (view_.frame.plane_m * view_.frame.plane_m))};
  aim(plane, work.x_m.data(), work.y_m.data(), list.size, work.batch.packet.data(),
      work.ray_weight.data(), work.inverse_length.data());
  const ImagePlan& plan = *work.plan;
  const auto pixels_x = static_cast<float>(plan.width_px / view_.frame.width_m),
             pixels_y = static_cast<float>(plan.height_px / view_.frame.height_m);
  const auto x0 = static_cast<float>(view_.frame.x0_m), y0 = static_cast<float>(view_.frame.y0_m);
  const bool pictures = !plan.empty();
  for (std::uint32_t i = 0; i < list.size; ++i) {
    std::uint32_t pixel = 0;
    if (pictures) {
      const auto px =
          std::min(static_cast<std::uint32_t>(std::max((work.x_m[i] - x0) * pixels_x, 0.0f)),
                   plan.width_px - 1);
      const auto py =
          std::min(static_cast<std::uint32_t>(std::max((work.y_m[i] - y0) * pixels_y, 0.0f)),
                   plan.height_px - 1);
      pixel = (plan.height_px - 1 - py) * plan.width_px + px;
    }
    work.batch.state[i] = {work.replicate_of_list[i], list.index[i], pixel, 0,
                           work.ray_weight[i],        1.0f,          1.0f,  work.inverse_length[i]};
  }
  work.batch.size = list.size;
}

// Follows the primary rays of work.batch to their ends and leaves it empty.
template <bool kSpectral>
void PathTracer::trace_batch(Work& work) const {
  work.counts->samples += work.batch.size;
  for (std::uint32_t order = 0; order <= settings_.max_reflections && work.batch.size > 0;
       ++order) {
    work.batch.prepare_packets(true);
    if (order == 0 || !settings_.no_second_hit) {
      work.batch.for_each_packet([&](RayPacket& packet, int count) {
        target_.tracer->intersect(packet, count, order == 0);
      });
      work.counts->rays += work.batch.size;
    }
    if (order > 0) work.counts->reflected_rays += work.batch.size;
    work.next.size = 0;
    arrive<kSpectral>(work, order);
    if (any_glint_) trace_glint<kSpectral>(work, order);
    if (order < settings_.max_reflections) {
      depart<kSpectral>(work, order);
      trace_shadows<kSpectral>(work, order);
    }
    std::swap(work.batch, work.next);
  }
  work.batch.size = 0;
}

// What each ray met: terminal radiance is added, vertices at which a path may go on are listed.
template <bool kSpectral>
void PathTracer::arrive(Work& work, std::uint32_t order) const {
  RayBatch& batch = work.batch;
  VertexList& vertex = work.vertex;
  vertex.size = 0;
  const auto sea_z = static_cast<float>(settings_.sea_z_m);
  const auto offset = static_cast<float>(target_.offset_m());
  const auto persistence = static_cast<float>(settings_.persistence);
  const bool behind_horizon =
      order == 0 && settings_.earth_radius_m > 0 && view_.frame.sensor.z > settings_.sea_z_m;
  // A ray that meets no target; a primary one counts where the background is asked for.
  const bool uniform = settings_.directions.uniform();
  const auto end_beyond = [&](PathState& s, bool above, Float3 from, Float3 d,
                              const float* spectrum) {
    if (order == 0 && !settings_.background) return;
    if (order > 0 && any_glint_ && !above) meet_sea(work, s, from, d, spectrum);
    if (order == 0) {
      s.first = classes_.parts;
      spectrum = work.ones.data();
    }
    if (uniform) {
      add<kSpectral>(work, s, order, above ? classes_.sky() : classes_.lower(), s.weight, spectrum);
      return;
    }
    const float z = d.z * s.inverse_length;
    DirectionNodes::Share share[4];
    const int count = settings_.directions.shares(d.x, d.y, above ? z : std::max(z, 0.0f), share);
    for (int k = 0; k < count; ++k)
      add<kSpectral>(work, s, order, classes_.sky(share[k].node), s.weight * share[k].weight,
                     spectrum);
  };
  for (std::uint32_t i = 0; i < batch.size; ++i) {
    RayPacket& packet = batch.packet_of(i);
    const std::uint32_t lane = RayBatch::lane_of(i);
    PathState& s = batch.state[i];
    const float* spectrum =
        batch.spectrum.data() + static_cast<std::size_t>(i) * (kSpectral ? nodes_ : 0);
    const Float3 d{packet.dir_x[lane], packet.dir_y[lane], packet.dir_z[lane]};
    const Float3 from{packet.org_x[lane], packet.org_y[lane], packet.org_z[lane]};
    if (packet.triangle[lane] == RayPacket::kMiss) {
      end_beyond(s, d.z < 0, from, d, spectrum);
      continue;
    }
    const auto from_behind = [&] {
      const Target::Facet& met = target_.facet[packet.triangle[lane]];
      return !target_.part[met.part].two_sided && dot({met.nx, met.ny, met.nz}, d) >= 0;
    };
    if (from_behind()) target_.tracer->look_for_front(packet, static_cast<int>(lane), offset);
    const std::uint32_t triangle = packet.triangle[lane];
    const float t = packet.tfar[lane];
    const Float3 p{packet.org_x[lane] + t * d.x, packet.org_y[lane] + t * d.y,
                   packet.org_z[lane] + t * d.z};
    const Target::Facet& facet = target_.facet[triangle];
    if (order == 0 && view_.stratum_of_part[facet.part] != work.stratum) continue;
    if (settings_.lower_is_sea &&
        p.z > sea_z + offset) {  // under water: the path ended on the sea above it
      end_beyond(s, false, from, d, spectrum);
      continue;
    }
    Float3 n{facet.nx, facet.ny, facet.nz};
    float cos_o = -dot(n, d) * s.inverse_length;
    const PartSpec& part = target_.part[facet.part];
    if (cos_o <= 0 && part.two_sided) {
      n = {-n.x, -n.y, -n.z};
      cos_o = -cos_o;
    }
    if (cos_o <= 0) {
      ++work.counts->guarded_backface_hits;
      continue;
    }
    cos_o = std::min(cos_o, 1.0f);
    if (order == 0) {
      if (behind_horizon && hidden_by_sea(p, d, s.inverse_length)) {
        end_beyond(s, false, from, d, spectrum);
        continue;
      }
      s.first = facet.part;
      ++work.counts->target_paths;
      work.area[s.replicate] += static_cast<double>(s.weight);
      if (settings_.behind)
        add_behind(work, s,
                   {d.x * s.inverse_length, d.y * s.inverse_length, d.z * s.inverse_length});
    }
    const Material& material = materials_[part.material];
    const Material::EmissivityAndDhr e = material.emissivity_and_dhr(cos_o);
    const std::uint32_t emitted = order == 0 ? classes_.own() : classes_.part(facet.part);
    // A hot part that the last vertex may have aimed at as well.
    float weight = s.weight;
    if (order > 0 && hot_.count() > 0) {
      const std::uint32_t light = hot_.light_of(triangle);
      const float* drawn = batch.drawn.data() + static_cast<std::size_t>(i) * (1 + hot_.count());
      if (light != HotLights::kNone && drawn[1 + light] > 0) {
        const float aimed =
            drawn[1 + light] *
            hot_.density_per_sr(triangle,
                                {packet.org_x[lane], packet.org_y[lane], packet.org_z[lane]}, t * t,
                                cos_o);
        weight *= drawn[0] / (drawn[0] + aimed);
      }
    }
    if constexpr (kSpectral) {
      material.spectral_emissivity(cos_o, work.row.data());
      if (order > 0)
        for (std::size_t k = 0; k < nodes_; ++k) work.row[k] *= spectrum[k];
      add<kSpectral>(work, s, order, emitted, weight, work.row.data());
    } else {
      add<kSpectral>(work, s, order, emitted, weight * e.emissivity, nullptr);
    }
    if (any_bright_ && order > 0 && material.narrowest_slope() < kBrightSlope &&
        materials_[target_.part[s.first].material].narrowest_slope() < kBrightSlope)
      ++work.counts->bright_to_bright;
    if (e.dhr_max <= 0) continue;
    work.beyond[s.replicate * (settings_.max_reflections + 1) + order] +=
        static_cast<double>(s.weight * s.spectral_max * e.dhr_max);
    if (order == settings_.max_reflections) {
      ++work.counts->truncated_paths;
      continue;
    }
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
    vertex.cos_o[v] = cos_o;
    vertex.roughness2[v] = material.roulette_slope2();
    // Reflections cost more rays than primary hits and scatter more: the first vertex may send out
    // several.
    vertex.survival[v] = (order == 0 ? static_cast<float>(settings_.split) : 1.0f) *
                         std::min(1.0f, persistence * s.throughput * s.spectral_max * e.dhr_max);
    vertex.path[v] = i;
    vertex.material[v] = part.material;
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
  const float height = static_cast<float>(settings_.sea_z_m - target_.offset_m()) - from.z;
  const float t = std::max(height, 0.0f) / direction.z;
  const Float3 place{from.x + t * direction.x, from.y + t * direction.y, from.z + t * direction.z};
  for (std::uint32_t j = 0; j < suns_.size(); ++j) {
    if (!(suns_[j].sea_wind_m_s > 0)) continue;
    const SeaGlint glint = sea_glint(to_observer, suns_[j].direction, suns_[j].sea_wind_m_s);
    // Less than 1e-6 of a diffuse white sea.
    if (!(glint.per_sr > 3e-7f)) continue;
    PathState s = path;
    s.weight *= glint.per_sr;
    const std::uint32_t ray = work.glint_shadow.push(place, work.sun[j].direction, s);
    work.glint_sun[ray] = j;
    work.glint_at[ray] = glint_share(glint.cos_incidence);
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
  // From the sea, which is not on the target: its shadow falls there even if it is convex.
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
    const std::uint32_t first =
        classes_.glint(work.glint_sun[i], static_cast<std::uint32_t>(at.node));
    add<kSpectral>(work, s, order, first, s.weight * (1 - at.weight_of_next), spectrum);
    add<kSpectral>(work, s, order, first + 1, s.weight * at.weight_of_next, spectrum);
  }
  batch.size = 0;
}

// The silhouette, by what stands behind it. Where the sea begins, at an elevation of 0, is the
// horizon here as it is for reflections.
void PathTracer::add_behind(Work& work, const PathState& path, Float3 direction) const {
  DirectionNodes::Share share[4];
  const int count = settings_.behind->shares(direction.x, direction.y, direction.z, share);
  for (int k = 0; k < count; ++k) {
    const std::size_t bin =
        static_cast<std::size_t>(path.first) * classes_.count() + classes_.behind(share[k].node);
    double* out = work.weight.data() + path.replicate * work.bins + bin * nodes_;
    const auto weight = static_cast<double>(path.weight * share[k].weight);
    for (std::size_t i = 0; i < nodes_; ++i) out[i] += weight;
  }
}

// The segment to the sensor against the sphere of the Earth, from the point's height above the
// waterline.
bool PathTracer::hidden_by_sea(Float3 p, Float3 d, float inverse_length) const {
  const double h = settings_.sea_z_m - static_cast<double>(p.z), radius = settings_.earth_radius_m;
  const double slant = inverse_length, ex = -d.x * slant, ey = -d.y * slant, up = d.z * slant;
  const double b = p.x * ex + p.y * ey + (radius + h) * up;
  const double c =
      static_cast<double>(p.x) * p.x + static_cast<double>(p.y) * p.y + 2 * radius * h + h * h;
  return b < 0 && b * b > c;
}

}  // namespace irsig
