// Work at the vertices of paths: aims at light sources, and sends paths on.

#include <algorithm>
#include <cmath>

#include "core/transport/path_work.h"

namespace irsig {
namespace {

// A sun contribution below this fraction of a diffuse reflection is played by roulette before a
// shadow ray is spent on it. On jobs/examples/frigate.toml (hull, three suns, 8192 samples) 0.1
// saves 23 % of all rays and 1 saves 35 %, and the variance of winter mid-wave rows rises by 0.01 %
// and 0.16 %.
constexpr float kFaintSun = 1.0f;

// A weight that may enter the result; others are counted.
bool sound(float weight, PathCounts& counts) {
  if (std::isfinite(weight) && weight >= 0) return true;
  ++(std::isfinite(weight) ? counts.guarded_negative : counts.guarded_nonfinite);
  return false;
}

}  // namespace

// Fills work.list with one pair for each listed vertex.
void PathTracer::draw_vertex_pairs(Work& work, std::uint32_t order, std::uint32_t pair,
                                   std::span<const std::uint32_t> vertices) const {
  const SeedPair* seeds = seeds_of(work, order);
  SampleList& list = work.list;
  list.size = static_cast<std::uint32_t>(vertices.size());
  for (std::uint32_t k = 0; k < list.size; ++k) {
    const PathState& s = work.batch.state[work.vertex.path[vertices[k]]];
    SeedPair seed = seeds[s.replicate * kPairsPerVertex + pair];
    if (settings_.pixel_samples > 0) seed = of_pixel(seed, pixel_of(work, s));
    list.index[k] = s.sample;
    list.seed_x[k] = seed.x;
    list.seed_y[k] = seed.y;
    list.seed_shuffle[k] = seed.shuffle;
  }
  settings_.pseudo_random ? draw_pairs_random(list) : draw_pairs_shuffled(list);
}

// Sends from each listed vertex a shadow ray to each sun and hot light that matters there, and the
// path's next ray if it survives.
template <bool kSpectral>
void PathTracer::depart(Work& work, std::uint32_t order) const {
  const std::uint32_t primary_list_size = work.list.size;
  const std::uint32_t size = work.vertex.size;
  for (std::uint32_t v = 0; v < size; ++v) work.chosen[v] = v;
  draw_vertex_pairs(work, order, kRoulettes, {work.chosen.data(), size});
  std::copy_n(work.list.x.begin(), size, work.roulette_x.begin());
  std::copy_n(work.list.y.begin(), size, work.roulette_y.begin());
  aim_at_suns<kSpectral>(work, order);
  if (hot_.count() > 0) aim_at_hot_lights<kSpectral>(work, order);
  draw_directions<kSpectral>(work, order);
  work.list.size = primary_list_size;
}

template <bool kSpectral>
void PathTracer::aim_at_suns(Work& work, std::uint32_t order) const {
  const RayBatch& batch = work.batch;
  VertexList& vertex = work.vertex;
  SampleList& list = work.list;
  for (std::size_t j = 0; j < work.sun.size(); ++j) {
    const Sun& sun = work.sun[j];
    RayBatch& shadow = work.shadow[j];
    shadow.size = 0;
    float* keep = work.sun_keep.data() + j * work.most;
    sun_probability(vertex, sun.direction, sun.inverse_distance_per_m, sun.sin_radius, kFaintSun,
                    keep);
    std::uint32_t chosen = 0;
    for (std::uint32_t v = 0; v < vertex.size; ++v) {
      work.chosen[chosen] = v;
      chosen += work.roulette_y[v] < keep[v] ? 1 : 0;
    }
    draw_vertex_pairs(work, order, kSunPoint, {work.chosen.data(), chosen});
    turn(list);
    for (std::uint32_t k = 0; k < chosen; ++k) {
      const std::uint32_t v = work.chosen[k], i = vertex.path[v];
      const Float3 n{vertex.nx[v], vertex.ny[v], vertex.nz[v]},
          wo{vertex.ox[v], vertex.oy[v], vertex.oz[v]}, x{vertex.px[v], vertex.py[v], vertex.pz[v]};
      const float r = std::sqrt(list.x[k]);
      const Sun::Light light = sun.towards(x, r * list.cos_y[k], r * list.sin_y[k]);
      const Float3 wi = light.direction;
      const float cos_i = dot(n, wi);
      if (cos_i <= 0 || ((plane_ || land_ != nullptr) && wi.z > sun.horizon_z))
        continue;  // that piece of the disk has set
      const Reflection at = reflection(n, wi, wo, cos_i, vertex.cos_o[v]);
      const Material& material = materials_[vertex.material[v]];
      float f = light.irradiance;
      if constexpr (!kSpectral) f *= material.brdf_per_sr(at);
      f *= cos_i / keep[v];
      if (material.narrowest_slope() < sun.narrow_slope) {
        const float aimed = keep[v] * light.density_per_sr;
        f *= aimed / (aimed + vertex.survival[v] * material.density_per_sr(at));
      }
      PathState s = batch.state[i];
      s.weight *= f;
      if (!sound(s.weight, *work.counts)) continue;
      const std::uint32_t ray = shadow.push(x, wi, s);
      if constexpr (kSpectral) {
        float* row = shadow.spectrum.data() + static_cast<std::size_t>(ray) * nodes_;
        material.spectral_brdf_per_sr(at, row);
        if (order > 0)
          for (std::size_t q = 0; q < nodes_; ++q)
            row[q] *= batch.spectrum[static_cast<std::size_t>(i) * nodes_ + q];
      }
    }
  }
}

template <bool kSpectral>
void PathTracer::aim_at_hot_lights(Work& work, std::uint32_t order) const {
  const RayBatch& batch = work.batch;
  VertexList& vertex = work.vertex;
  SampleList& list = work.list;
  work.hot_shadow.size = 0;
  std::fill_n(work.hot_total.begin(), vertex.size, 0.0f);
  for (std::uint32_t l = 0; l < hot_.count(); ++l) {
    const HotLights::Sphere& sphere = hot_.bounds(l);
    float* rate = work.hot_rate.data() + static_cast<std::size_t>(l) * work.most;
    hot_rate(vertex, sphere.centre, sphere.radius, sphere.area_m2, kFaintHot, rate);
    for (std::uint32_t v = 0; v < vertex.size; ++v) work.hot_total[v] += rate[v];
  }
  // At most one light is aimed at from each vertex.
  for (std::uint32_t l = 0; l < hot_.count(); ++l) {
    float* rate = work.hot_rate.data() + static_cast<std::size_t>(l) * work.most;
    for (std::uint32_t v = 0; v < vertex.size; ++v) rate[v] /= std::max(work.hot_total[v], 1.0f);
  }
  std::uint32_t chosen = 0;
  for (std::uint32_t v = 0; v < vertex.size; ++v) {
    float rest = 1.0f - work.roulette_y[v];  // the suns' number serves them from its other end
    if (rest >= work.hot_total[v]) continue;
    for (std::uint32_t l = 0; l < hot_.count(); ++l) {
      const float rate = work.hot_rate[static_cast<std::size_t>(l) * work.most + v];
      if (rest < rate) {
        work.chosen[chosen] = v;
        work.hot_light[chosen] = l;
        work.hot_total[chosen++] = rest / rate;  // again uniform in (0, 1)
        break;
      }
      rest -= rate;
    }
  }
  draw_vertex_pairs(work, order, kHotTriangle, {work.chosen.data(), chosen});
  std::copy_n(list.x.begin(), chosen, work.hot_pick.begin());
  draw_vertex_pairs(work, order, kHotPoint, {work.chosen.data(), chosen});
  for (std::uint32_t k = 0; k < chosen; ++k) {
    const std::uint32_t v = work.chosen[k], i = vertex.path[v], l = work.hot_light[k];
    const Float3 n{vertex.nx[v], vertex.ny[v], vertex.nz[v]},
        wo{vertex.ox[v], vertex.oy[v], vertex.oz[v]}, x{vertex.px[v], vertex.py[v], vertex.pz[v]};
    const HotLights::Point light =
        hot_.choose(l, x, work.hot_total[k], work.hot_pick[k], list.x[k], list.y[k]);
    const Float3 wi = light.direction;
    if (light.cos_l <= 0) continue;
    const float cos_i = dot(n, wi);
    if (cos_i <= 0) continue;
    if (plane_ && light.at.z > static_cast<float>(plane_->z_m + target_.offset_m()))
      continue;  // under water
    if (below_land(light.at)) continue;
    const Reflection at = reflection(n, wi, wo, cos_i, vertex.cos_o[v]);
    const Material& material = materials_[vertex.material[v]];
    const float rate = work.hot_rate[static_cast<std::size_t>(l) * work.most + v];
    const PartSpec& part = target_.part[target_.facet[light.facet].part];
    const Material& emitter = materials_[part.material];
    // The balance heuristic: brdf cos / (both ways' expected rays per solid angle).
    float f =
        cos_i / (rate * light.density_per_sr + vertex.survival[v] * material.density_per_sr(at));
    if constexpr (!kSpectral) f *= material.brdf_per_sr(at) * emitter.emissivity(light.cos_l);
    PathState s = batch.state[i];
    s.weight *= f;
    if (!sound(s.weight, *work.counts)) continue;
    const Float3 segment{light.at.x - x.x, light.at.y - x.y, light.at.z - x.z};
    const std::uint32_t ray = work.hot_shadow.push(x, segment, s);
    work.hot_source[ray] =
        layout_.reflected(sources_.emitters.of(light.facet, target_.facet[light.facet].part));
    if constexpr (kSpectral) {
      float* row = work.hot_shadow.spectrum.data() + static_cast<std::size_t>(ray) * nodes_;
      material.spectral_brdf_per_sr(at, row);
      emitter.spectral_emissivity(light.cos_l, work.row.data());
      for (std::size_t q = 0; q < nodes_; ++q) row[q] *= work.row[q];
      if (order > 0)
        for (std::size_t q = 0; q < nodes_; ++q)
          row[q] *= batch.spectrum[static_cast<std::size_t>(i) * nodes_ + q];
    }
  }
}

template <bool kSpectral>
void PathTracer::draw_directions(Work& work, std::uint32_t order) const {
  const RayBatch& batch = work.batch;
  VertexList& vertex = work.vertex;
  SampleList& list = work.list;
  const SeedPair* seeds = seeds_of(work, order);
  const auto list_pair = [&](std::uint32_t slot, const PathState& path, std::uint32_t pair) {
    SeedPair seed = seeds[path.replicate * kPairsPerVertex + pair];
    if (settings_.pixel_samples > 0) seed = of_pixel(seed, pixel_of(work, path));
    list.seed_x[slot] = seed.x;
    list.seed_y[slot] = seed.y;
    list.seed_shuffle[slot] = seed.shuffle;
  };
  // Roulette and splitting in one: floor(survival + u) rays go on, each with weight / survival. The
  // children's samples are an aligned block of the sampler, so that their directions are stratified
  // among themselves.
  std::uint32_t alive = 0;
  const std::uint32_t most = order == 0 ? settings_.split : 1;
  for (std::uint32_t v = 0; v < vertex.size; ++v) {
    // The sum of 1 and the largest number below 1 rounds to 2.
    const auto children =
        std::min(static_cast<std::uint32_t>(vertex.survival[v] + work.roulette_x[v]), most);
    for (std::uint32_t child = 0; child < children; ++child) {
      work.chosen[alive] = v;
      const PathState& s = batch.state[vertex.path[v]];
      list.index[alive] = order == 0 ? s.sample * settings_.split + child : s.sample;
      list_pair(alive, s, kLobe);
      ++alive;
    }
  }
  list.size = alive;
  std::copy_n(list.index.begin(), alive, work.child_sample.begin());
  settings_.pseudo_random ? draw_pairs_random(list) : draw_pairs_shuffled(list);
  std::copy_n(list.x.begin(), alive, work.lobe.begin());
  for (std::uint32_t k = 0; k < alive; ++k)
    list_pair(k, batch.state[vertex.path[work.chosen[k]]], kDirection);
  settings_.pseudo_random ? draw_pairs_random(list) : draw_pairs_shuffled(list);
  turn(list);
  for (std::uint32_t k = 0; k < alive; ++k) {
    const std::uint32_t v = work.chosen[k], i = vertex.path[v];
    const Material& material = materials_[vertex.material[v]];
    const float cos_o = vertex.cos_o[v];
    const Material::Sampled local =
        material.sample(cos_o, work.lobe[k], list.x[k], list.cos_y[k], list.sin_y[k]);
    if (local.weight == 0) continue;
    const Float3 n{vertex.nx[v], vertex.ny[v], vertex.nz[v]},
        x{vertex.px[v], vertex.py[v], vertex.pz[v]};
    // The local frame has w_o in its x-z plane.
    Float3 tx{vertex.ox[v] - cos_o * n.x, vertex.oy[v] - cos_o * n.y, vertex.oz[v] - cos_o * n.z},
        ty;
    const float sin2 = dot(tx, tx);
    if (sin2 > 1e-10f) {
      const float inverse = 1.0f / std::sqrt(sin2);
      tx = {inverse * tx.x, inverse * tx.y, inverse * tx.z};
      ty = {n.y * tx.z - n.z * tx.y, n.z * tx.x - n.x * tx.z, n.x * tx.y - n.y * tx.x};
    } else {
      orthonormal_basis(n, tx, ty);
    }
    const Float3 direction{local.x * tx.x + local.y * ty.x + local.z * n.x,
                           local.x * tx.y + local.y * ty.y + local.z * n.y,
                           local.x * tx.z + local.y * ty.z + local.z * n.z};
    PathState s = batch.state[i];
    s.sample = list.index[k];
    const float factor = (kSpectral ? 1.0f : local.weight) / vertex.survival[v];
    s.weight *= factor;
    s.throughput *= factor;
    s.inverse_length = 1.0f;
    if (!sound(s.weight, *work.counts)) continue;
    const std::uint32_t ray = work.next.push(x, direction, s);
    const float* row = nullptr;
    if constexpr (kSpectral) {
      float* out = work.next.spectrum.data() + static_cast<std::size_t>(ray) * nodes_;
      material.spectral_weight(local, out);
      float largest = 0, smallest = 0, sum = 0;
      for (std::size_t q = 0; q < nodes_; ++q) {
        if (order > 0) out[q] *= batch.spectrum[static_cast<std::size_t>(i) * nodes_ + q];
        largest = std::max(largest, out[q]);
        smallest = std::min(smallest, out[q]);
        sum += out[q];
      }
      if (!std::isfinite(sum) || smallest < 0) {
        ++(std::isfinite(sum) ? work.counts->guarded_negative : work.counts->guarded_nonfinite);
        --work.next.size;
        continue;
      }
      work.next.state[ray].spectral_max = largest;
      row = out;
    }
    if (hot_.count() > 0) {
      float* drawn = work.next.drawn.data() + static_cast<std::size_t>(ray) * (1 + hot_.count());
      drawn[0] = vertex.survival[v] * material.density_per_sr(local.at);
      for (std::uint32_t l = 0; l < hot_.count(); ++l)
        drawn[1 + l] = work.hot_rate[static_cast<std::size_t>(l) * work.most + v];
    }
    if (!any_narrow_) continue;
    // Into the disk of a sun: one more shadow ray, so that no ray of the path depends on suns.
    for (std::size_t j = 0; j < work.sun.size(); ++j) {
      const Sun& sun = work.sun[j];
      Sun::Light light{};
      if (material.narrowest_slope() >= sun.narrow_slope || !sun.met_by(x, direction, light) ||
          ((plane_ || land_ != nullptr) && direction.z > sun.horizon_z))
        continue;
      const float aimed = work.sun_keep[j * work.most + v] * light.density_per_sr;
      const float drawn = vertex.survival[v] * material.density_per_sr(local.at);
      PathState lit = s;
      lit.weight *= light.irradiance * light.density_per_sr * (drawn / (aimed + drawn));
      if (!sound(lit.weight, *work.counts)) continue;
      RayBatch& shadow = work.shadow[j];
      const std::uint32_t shadow_ray = shadow.push(x, direction, lit);
      if constexpr (kSpectral)
        std::copy_n(row, nodes_,
                    shadow.spectrum.data() + static_cast<std::size_t>(shadow_ray) * nodes_);
    }
  }
}

// The state of a path as light has it that comes along a ray aimed at it.
//   end  of the ray, in units of its direction
PathState PathTracer::background_gas_around(Work& work, RayBatch& batch, std::uint32_t i,
                                            double end) const {
  PathState s = batch.state[i];
  if (gas_around_ == nullptr || s.first >= parts_) return s;
  const RayPacket& packet = batch.packet_of(i);
  const std::uint32_t lane = RayBatch::lane_of(i);
  (void)meets_gas_around(work, {packet.org_x[lane], packet.org_y[lane], packet.org_z[lane]},
                         {packet.dir_x[lane], packet.dir_y[lane], packet.dir_z[lane]}, end, s);
  return s;
}

template <bool kSpectral>
void PathTracer::trace_shadows(Work& work, std::uint32_t order) const {
  for (std::uint32_t j = 0; j < work.shadow.size(); ++j) {
    RayBatch& batch = work.shadow[j];
    if (batch.size == 0) continue;
    batch.prepare_packets(false);
    if (!settings_.skip_self_intersection) {
      batch.for_each_packet(
          [&](RayPacket& packet, int count) { target_.tracer->occluded(packet, count, true); });
      work.counts->rays += batch.size;
    }
    work.counts->sun_rays += batch.size;
    for (std::uint32_t i = 0; i < batch.size; ++i) {
      if (batch.packet_of(i).tfar[RayBatch::lane_of(i)] < 0 || shaded_by_land(batch, i, land_ == nullptr ? 0 : clear_of_sun_m_[j])) continue;
      const PathState s =
          background_gas_around(work, batch, i, std::numeric_limits<double>::infinity());
      add<kSpectral>(
          work, s, order + 1, layout_.sun(j), s.weight,
          batch.spectrum.data() + static_cast<std::size_t>(i) * (kSpectral ? nodes_ : 0));
    }
  }
  if (hot_.count() == 0 || work.hot_shadow.size == 0) return;
  RayBatch& batch = work.hot_shadow;
  batch.prepare_packets(false, 1.0f);
  batch.for_each_packet(
      [&](RayPacket& packet, int count) { target_.tracer->occluded(packet, count, false); });
  work.counts->rays += batch.size;
  work.counts->hot_rays += batch.size;
  for (std::uint32_t i = 0; i < batch.size; ++i) {
    if (batch.packet_of(i).tfar[RayBatch::lane_of(i)] < 0) continue;
    const PathState s = background_gas_around(work, batch, i, 1);
    add<kSpectral>(work, s, order + 1, work.hot_source[i], s.weight,
                   batch.spectrum.data() + static_cast<std::size_t>(i) * (kSpectral ? nodes_ : 0));
  }
}

template void PathTracer::depart<false>(Work&, std::uint32_t) const;
template void PathTracer::depart<true>(Work&, std::uint32_t) const;
template void PathTracer::trace_shadows<false>(Work&, std::uint32_t) const;
template void PathTracer::trace_shadows<true>(Work&, std::uint32_t) const;

}  // namespace irsig
