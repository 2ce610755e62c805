#include "core/transport/path_tracer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>

#include "core/base/check.h"
#include "core/base/ordered_dot.h"
#include "core/transport/path_work.h"

namespace irsig {
namespace {

// Pairs of later orders are made when they are needed.
constexpr std::uint32_t kSeedOrders = 33;
// One in so many samples finds the land behind the target; at least so many of a replicate.
constexpr std::uint64_t kBehindEvery = 8, kLeastBehind = 64;

// Returns the standard error of a sum of groups, from their scatter.
float scatter_of(std::span<const double> groups) {
  const auto count = static_cast<double>(groups.size());
  double all = 0, squares = 0;
  for (const double of_group : groups) all += of_group;
  for (const double of_group : groups) {
    const double off = of_group - all / count;
    squares += off * off;
  }
  return static_cast<float>(std::sqrt(squares * count / (count - 1)));
}

}  // namespace

PathTracer::PathTracer(const Target& target, std::span<const Material> materials,
                       const AimedView& view, SourceGeometry sources, PathSettings settings)
    : target_(target),
      materials_(materials),
      sources_(std::move(sources)),
      plane_(plane_of(sources_.boundary)),
      settings_(settings),
      parts_(static_cast<std::uint32_t>(target.part.size())),
      layout_(target.part.size(), sources_),
      view_(view),
      hot_(settings.hot_lights ? HotLights(target) : HotLights()) {
  if (const auto* gas = std::get_if<HotGasMedium>(&sources_.medium)) gas_ = gas->rays.get();
  if (const auto* gas = std::get_if<HotGasAround>(&sources_.medium)) gas_around_ = gas->rays.get();
  land_ = std::get_if<Land>(&sources_.boundary);
  if (land_ != nullptr) {
    clear_of_sensor_m_ = land_->clear_in_sight_m(view.frame.sensor, normalized(view.frame.sensor),
                                                 target.radius_m, 0);
    for (const SunDirection& s : sources_.sun)
      clear_of_sun_m_.push_back(land_->clear_beyond_m(s.direction, target.radius_m,
                                                      1.1 * std::tan(s.angular_radius_rad)));
  }
  if (land_ != nullptr && sources_.behind && settings_.pixel_samples == 0) find_mean_behind();
  any_glint_ = sources_.glitters();
  for (const Material& m : materials_) spectral_ |= !m.grey();
  if (spectral_) nodes_ = materials_.front().nodes();
  float widest_radius = 0;
  if (settings_.sun_disk_by_chance)
    for (const SunDirection& s : sources_.sun)
      widest_radius = std::max(widest_radius, static_cast<float>(std::tan(s.angular_radius_rad)));
  for (const Material& m : materials_)
    any_narrow_ |= m.narrowest_slope() < kNarrowRadii * widest_radius;
}

std::vector<PathWeights> PathTracer::trace(PathCounts& counts) const {
  TracedPictures none;
  return trace({}, none, counts);
}

std::vector<PathWeights> PathTracer::trace(const ImagePlan& plan, TracedPictures& pictures,
                                           PathCounts& counts) const {
  IRSIG_CHECK(plan.empty() == (settings_.pixel_samples == 0));
  pictures = {};
  pictures.sum.assign(plan.size(), 0.0);
  pictures.stderr_.assign(plan.size(), 0.0f);
  if (plan.kinds > 1) {
    pictures.kind_sum.assign(plan.size() * plan.kinds, 0.0f);
    pictures.kind_stderr = pictures.kind_sum;
  }
  if (plan.first_hits) pictures.first_sum.assign(plan.pixels() * plan.first_numbers(), 0.0);
  Work work;
  work.plan = &plan;
  work.pictures = &pictures;
  work.counts = &counts;
  work.orders = settings_.by_order ? settings_.max_reflections + 1 : 1;
  for (const SunDirection& s : sources_.sun) {
    const double tangent = std::tan(s.angular_radius_rad);
    Sun sun{to_float(s.direction),
            {},
            {},
            static_cast<float>(std::sin(s.angular_radius_rad)) + 1e-6f,
            static_cast<float>(tangent * tangent),
            s.distance_m > 0 ? static_cast<float>(1 / s.distance_m) : 0.0f,
            static_cast<float>(1 / (std::numbers::pi * tangent * tangent)),
            settings_.sun_disk_by_chance ? kNarrowRadii * static_cast<float>(tangent) : 0.0f,
            static_cast<float>(s.horizon_z)};
    orthonormal_basis(sun.direction, sun.tangent1, sun.tangent2);
    const auto r = static_cast<float>(tangent);
    for (Float3* t : {&sun.tangent1, &sun.tangent2}) *t = {r * t->x, r * t->y, r * t->z};
    work.sun.push_back(sun);
  }
  // Large enough to fill packets, small enough to stay in the second-level cache.
  const std::uint32_t capacity = spectral_ ? 256 : 1024;
  const std::size_t row = spectral_ ? nodes_ : 0;
  const std::uint32_t most = capacity * settings_.split;  // after splitting
  work.capacity = capacity;
  work.most = most;
  const std::size_t drawn = hot_.count() > 0 ? 1 + hot_.count() : 0;
  work.batch.resize(most, row, drawn);
  work.next.resize(most, row, drawn);
  work.shadow.resize(sources_.sun.size());
  for (RayBatch& b : work.shadow) b.resize(any_narrow_ ? 2 * most : most, row);
  work.sun_keep.resize(sources_.sun.size() * most);
  if (hot_.count() > 0) {
    work.hot_shadow.resize(most, row);
    work.hot_rate.resize(hot_.count() * most);
    work.hot_source.resize(most);
    work.hot_light.resize(most);
    for (auto* v : {&work.hot_total, &work.hot_pick}) v->resize(most);
  }
  if (!plan.towards_sun.empty()) work.first_shadow.resize(capacity, 0);
  if (plan.whole_parts) work.through_batch.resize(capacity, 0);
  if (any_glint_) {
    const auto rays = static_cast<std::uint32_t>(most * sources_.sun.size());
    work.glint_shadow.resize(rays, row);
    work.glint_sun.resize(rays);
    work.glint_at.resize(rays);
  }
  if (land_ != nullptr) {
    const auto rays = static_cast<std::uint32_t>(most * sources_.sun.size());
    const std::uint32_t materials = land_->materials();
    work.land_shadow.resize(rays, row);
    work.land_sun.resize(rays);
    work.land_range.resize(rays);
    work.land_fractions.resize(std::size_t{rays} * materials);
  }
  work.row.resize(nodes_);
  work.list.resize(most);
  work.replicate_of_list.resize(capacity);
  work.pixel_of_list.resize(capacity);
  for (auto* v : {&work.x_m, &work.y_m, &work.ray_weight, &work.density_factor,
                  &work.inverse_length, &work.roulette_x, &work.roulette_y, &work.lobe})
    v->resize(most);
  work.child_sample.resize(most);
  work.ones.assign(nodes_, 1.0f);
  work.vertex.resize(most);
  work.chosen.resize(most + 1);

  std::vector<PathWeights> out(settings_.replicates);
  const bool keep_last = settings_.max_reflections >= 2 || settings_.always_last;
  const std::size_t orders = settings_.max_reflections + 1;
  const SourceWeights none(firsts(), layout_, nodes_);
  for (PathWeights& w : out) {
    if (settings_.by_order)
      w.of_order.assign(orders, none);
    else
      w.weight = none;
    if (keep_last) w.last = none;
    w.beyond_order_m2.assign(orders, 0.0);
    if (gas_ != nullptr) w.gas_m2.assign(gas_->measures(), 0.0);
    if (gas_around_ == nullptr) continue;
    w.gas_m2.assign(static_cast<std::size_t>(parts_) * gas_around_->measures(), 0.0);
    w.gas_nodes_m2.assign(spectral_ ? parts_ * nodes_ : 0, 0.0);
    w.gas_seen_m2.assign(parts_, 0.0);
  }
  work.weight.assign(settings_.replicates * work.orders, none);
  work.last.assign(keep_last ? settings_.replicates : 0, none);
  for (std::uint32_t s = 0; s < view_.stratum.size(); ++s) {
    if (view_.stratum[s].empty() || settings_.only_stratum.value_or(s) != s) continue;
    work.stratum = s;
    for (SourceWeights& w : work.weight) w.clear();
    for (SourceWeights& w : work.last) w.clear();
    work.area.assign(settings_.replicates, 0.0);
    work.background_area.assign(settings_.replicates, 0.0);
    work.hidden_area.assign(settings_.replicates, 0.0);
    if (!mean_behind_.empty()) {
      const std::uint64_t samples = view_.samples(s, settings_.samples);
      work.mean_behind.assign(std::size_t{settings_.replicates} * parts_, 0.0);
      work.behind_samples = static_cast<std::uint32_t>(std::max<std::uint64_t>(
          std::min<std::uint64_t>(samples, kLeastBehind), samples / kBehindEvery));
      work.behind_scale = static_cast<float>(samples) / static_cast<float>(work.behind_samples);
    }
    work.beyond.assign(settings_.replicates * orders, 0.0);
    if (const RayMedium* gas = gas_ != nullptr ? gas_ : gas_around_) {
      work.gas_measure.resize(gas->measures());
      work.gas.assign(settings_.replicates * out.front().gas_m2.size(), 0.0);
      work.gas_nodes.assign(settings_.replicates * out.front().gas_nodes_m2.size(), 0.0);
      work.gas_seen.assign(settings_.replicates * out.front().gas_seen_m2.size(), 0.0);
      work.gas_fraction.resize(static_cast<std::size_t>(work.capacity) * gas->classes());
    }
    const double normalise = sample_m2(plan, s);
    work.area_per_sample = static_cast<float>(normalise);
    if (spectral_)
      trace_stratum<true>(work, s);
    else
      trace_stratum<false>(work, s);
    if (!mean_behind_.empty()) add_mean_behind(work);
    for (std::uint32_t r = 0; r < settings_.replicates; ++r) {
      if (settings_.by_order)
        for (std::size_t k = 0; k < orders; ++k)
          out[r].of_order[k].add(normalise, work.weight[r * orders + k]);
      else
        out[r].weight.add(normalise, work.weight[r]);
      if (keep_last) out[r].last.add(normalise, work.last[r]);
      out[r].projected_area_m2 += normalise * work.area[r];
      out[r].background_area_m2 += normalise * work.background_area[r];
      out[r].hidden_area_m2 += normalise * work.hidden_area[r];
      for (std::size_t k = 0; k < orders; ++k)
        out[r].beyond_order_m2[k] += normalise * work.beyond[r * orders + k];
      const auto add_gas = [&](const std::vector<double>& from, std::vector<double>& to) {
        for (std::size_t m = 0; m < to.size(); ++m) to[m] += normalise * from[r * to.size() + m];
      };
      add_gas(work.gas, out[r].gas_m2);
      add_gas(work.gas_nodes, out[r].gas_nodes_m2);
      add_gas(work.gas_seen, out[r].gas_seen_m2);
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
  if (settings_.pixel_samples > 0) return trace_pixels<kSpectral>(work, aim.front());
  const CellOrder order(view_.samples(stratum, settings_.samples), aim);

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
      if (list.size == work.capacity) trace_listed<kSpectral>(work);
    }
  }
  trace_listed<kSpectral>(work);
}

// Each pixel has a scrambled Sobol sequence of its own, which is stratified over the pixel, and so
// is each of its groups. Pixels are traced row by row from below.
template <bool kSpectral>
void PathTracer::trace_pixels(Work& work, SeedPair aim) const {
  const ImagePlan& plan = *work.plan;
  const std::uint32_t samples = settings_.pixel_samples;
  const std::uint32_t groups = pixel_groups(samples);
  IRSIG_CHECK(settings_.replicates == 1);
  // Powers of two: a batch has whole pixels, or a pixel whole batches.
  IRSIG_CHECK(std::has_single_bit(samples));
  IRSIG_CHECK(std::has_single_bit(work.capacity));
  work.group_sum.assign(
      std::size_t{std::max(work.capacity / samples, 1u)} * groups * plan.kinds * plan.padded, 0.0);
  work.first_pixel = 0;
  SampleList& list = work.list;
  list.size = 0;
  const std::uint32_t pixels = plan.width_px * plan.height_px;
  for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
    const SeedPair seed = of_pixel(aim, pixel);
    for (std::uint32_t k = 0; k < samples; ++k) {
      const std::uint32_t i = list.size++;
      list.index[i] = k;
      work.pixel_of_list[i] = pixel;
      list.seed_x[i] = seed.x;
      list.seed_y[i] = seed.y;
      work.replicate_of_list[i] = 0;
      if (list.size < work.capacity) continue;
      trace_listed<kSpectral>(work);
      close_pixels(work, k + 1 == samples ? pixel + 1 : pixel);
    }
  }
  trace_listed<kSpectral>(work);
  close_pixels(work, pixels);
  join_met(work.pictures->met);
  join_met(work.pictures->met_set);
}

// Takes pixels up to `end`, of which all samples are traced, from the groups' sums into pictures.
void PathTracer::close_pixels(Work& work, std::uint32_t end) const {
  const ImagePlan& plan = *work.plan;
  TracedPictures& out = *work.pictures;
  const std::uint32_t groups = pixel_groups(settings_.pixel_samples);
  const std::size_t of_group = plan.kinds * plan.padded;
  std::vector<double>&sum = work.sum_of_group, &part = work.part_of_group;
  sum.resize(groups);
  part.resize(groups);
  const double* of_pixel = work.group_sum.data();
  for (std::uint32_t p = work.first_pixel; p < end; ++p, of_pixel += groups * of_group) {
    const std::size_t at = stored_pixel(plan, p) * plan.images;
    for (std::size_t k = 0; k < plan.images; ++k) {
      std::fill(sum.begin(), sum.end(), 0.0);
      for (std::uint32_t kind = 0; kind < plan.kinds; ++kind) {
        for (std::uint32_t g = 0; g < groups; ++g)
          part[g] = of_pixel[g * of_group + kind * plan.padded + k];
        for (std::uint32_t g = 0; g < groups; ++g) sum[g] += part[g];
        if (plan.kinds == 1) continue;
        const std::size_t of_kind = (at + k) * plan.kinds + kind;
        for (const double of_part : part) out.kind_sum[of_kind] += static_cast<float>(of_part);
        out.kind_stderr[of_kind] = scatter_of(part);
      }
      out.sum[at + k] = std::accumulate(sum.begin(), sum.end(), 0.0);
      out.stderr_[at + k] = scatter_of(sum);
    }
  }
  for (TracedPictures::Met& met : work.met)
    met.pixel = static_cast<std::uint32_t>(stored_pixel(plan, met.pixel));
  join_met(work.met);
  out.met.insert(out.met.end(), work.met.begin(), work.met.end());
  work.met.clear();
  if (end == work.first_pixel) return;
  std::fill(work.group_sum.begin(), work.group_sum.end(), 0.0);
  work.first_pixel = end;
}

template <bool kSpectral>
void PathTracer::trace_listed(Work& work) const {
  aim_batch(work);
  trace_batch<kSpectral>(work);
  work.list.size = 0;
}

double PathTracer::sample_m2(const ImagePlan& plan, std::uint32_t stratum) const {
  if (settings_.pixel_samples > 0)
    return plan.rectangle.width_m * plan.rectangle.height_m /
           (static_cast<double>(plan.width_px) * plan.height_px * settings_.pixel_samples);
  return view_.stratum[stratum].area_m2() /
         static_cast<double>(view_.samples(stratum, settings_.samples));
}

// Turns the listed samples into primary rays.
void PathTracer::aim_batch(Work& work) const {
  SampleList& list = work.list;
  settings_.pseudo_random ? draw_pairs_random(list) : draw_pairs(list);
  const CoverageMask& mask = view_.stratum[work.stratum];
  const CellDensity* density = work.stratum == 0 && view_.density ? &*view_.density : nullptr;
  for (std::uint32_t i = 0; i < list.size; ++i) {
    const SamplePair at{list.x[i], list.y[i]};
    if (settings_.pixel_samples > 0) {
      const ImagePlan& plan = *work.plan;
      const std::uint32_t pixel = work.pixel_of_list[i];
      const std::uint32_t column = pixel % plan.width_px, row = pixel / plan.width_px;
      const PlaneRectangle& r = plan.rectangle;
      work.x_m[i] = static_cast<float>(
          r.x0_m +
          r.width_m * ((static_cast<double>(column) + static_cast<double>(at.x)) / plan.width_px));
      work.y_m[i] = static_cast<float>(
          r.y0_m +
          r.height_m * ((static_cast<double>(row) + static_cast<double>(at.y)) / plan.height_px));
    } else if (density != nullptr) {
      const CellDensity::Place p = density->map(at);
      work.x_m[i] = p.x_m;
      work.y_m[i] = p.y_m;
      work.density_factor[i] = p.factor;
    } else {
      const CoverageMask::Point p = mask.map(at);
      work.x_m[i] = p.x_m;
      work.y_m[i] = p.y_m;
    }
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
  if (density != nullptr)
    for (std::uint32_t i = 0; i < list.size; ++i) work.ray_weight[i] *= work.density_factor[i];
  for (std::uint32_t i = 0; i < list.size; ++i)
    work.batch.state[i] = {work.replicate_of_list[i], list.index[i], 0,    0,
                           work.ray_weight[i],        1.0f,          1.0f, work.inverse_length[i]};
  if (settings_.pixel_samples > 0) {
    const std::uint32_t groups = pixel_groups(settings_.pixel_samples);
    for (std::uint32_t i = 0; i < list.size; ++i)
      work.batch.state[i].pixel_group = (work.pixel_of_list[i] - work.first_pixel) * groups +
                                        list.index[i] / (settings_.pixel_samples / groups);
  }
  work.batch.size = list.size;
}

// Counts the gas on primary rays that have met what they meet; those without any end here.
void PathTracer::cross_gas(Work& work) const {
  RayBatch& batch = work.batch;
  const std::size_t measures = gas_->measures(), classes = gas_->classes();
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < batch.size; ++i) {
    const RayPacket& packet = batch.packet_of(i);
    const std::uint32_t lane = RayBatch::lane_of(i);
    PathState& s = batch.state[i];
    const double inverse_length = s.inverse_length;
    const Float3 org{packet.org_x[lane], packet.org_y[lane], packet.org_z[lane]},
        d{packet.dir_x[lane], packet.dir_y[lane], packet.dir_z[lane]};
    const Vec<Body> from{org.x, org.y, org.z},
        direction = inverse_length * Vec<Body>{static_cast<double>(d.x), static_cast<double>(d.y),
                                               static_cast<double>(d.z)};
    double end_m = packet.triangle[lane] == RayPacket::kMiss
                       ? std::numeric_limits<double>::infinity()
                       : static_cast<double>(packet.tfar[lane]) / inverse_length;
    if (plane_ && direction.z > 0)
      end_m = std::min(end_m, std::max(0.0, (plane_->z_m - from.z) / direction.z));
    const std::span<float> share{work.gas_fraction.data() + kept * classes, classes};
    const auto at_m = gas_->cross(from, direction, end_m, work.gas_measure, share);
    if (!at_m) continue;
    const auto along = static_cast<float>(*at_m * inverse_length);
    if (plane_ && plane_->earth_radius_m > 0 && view_.frame.sensor.z > plane_->z_m &&
        hidden_by_sea({org.x + along * d.x, org.y + along * d.y, org.z + along * d.z}, d,
                      s.inverse_length))
      continue;
    const auto weight = static_cast<double>(s.weight);
    double* sum = work.gas.data() + s.replicate * measures;
    for (std::size_t m = 0; m < measures; ++m) sum[m] += weight * work.gas_measure[m];
    if (const ImagePlan& plan = *work.plan; !plan.empty()) {
      double* image = image_of(work, s, plan.gas_kind);
      for (std::uint32_t k = 0; k < plan.images; ++k)
        image[k] += static_cast<double>(work.area_per_sample) * weight *
                    ordered_dot(plan.gas.data() + k * measures, work.gas_measure.data(), measures);
    }
    s.first = 2 * kept;
    batch.move(i, kept++);
  }
  batch.size = kept;
}

// The gas that a ray of a path crosses on its way to `end`, in units of its direction; nothing lies
// beyond sea or ground. Its shares are kept, and the path behind it is counted by them.
bool PathTracer::meets_gas_around(Work& work, Float3 from, Float3 direction, double end,
                                  PathState& path) const {
  const Vec<Body> d{direction.x, direction.y, direction.z};
  const double per_unit_m = length(d), z = from.z;
  double end_m = end * per_unit_m;
  if (plane_ && d.z > 0)
    end_m = std::min(end_m, std::max(0.0, (plane_->z_m - z) * per_unit_m / d.z));
  const std::size_t classes = gas_around_->classes();
  const std::size_t entry = work.gas_fractions++;
  work.gas_fraction.resize(std::max(work.gas_fraction.size(), work.gas_fractions * classes));
  if (!gas_around_->cross({from.x, from.y, z}, normalized(d), end_m, work.gas_measure,
                          {work.gas_fraction.data() + entry * classes, classes})) {
    --work.gas_fractions;
    return false;
  }
  path.first = parts_ + static_cast<std::uint32_t>(entry);
  return true;
}

// Counts the gas on reflected rays that have met what they meet.
template <bool kSpectral>
void PathTracer::cross_gas_around(Work& work) const {
  RayBatch& batch = work.batch;
  const std::size_t measures = gas_around_->measures();
  for (std::uint32_t i = 0; i < batch.size; ++i) {
    PathState& s = batch.state[i];
    if (s.first >= parts_) continue;
    const RayPacket& packet = batch.packet_of(i);
    const std::uint32_t lane = RayBatch::lane_of(i);
    const double end = packet.triangle[lane] == RayPacket::kMiss
                           ? std::numeric_limits<double>::infinity()
                           : static_cast<double>(packet.tfar[lane]);
    const std::size_t entry = static_cast<std::size_t>(s.replicate) * parts_ + s.first;
    if (!meets_gas_around(work, {packet.org_x[lane], packet.org_y[lane], packet.org_z[lane]},
                          {packet.dir_x[lane], packet.dir_y[lane], packet.dir_z[lane]}, end, s))
      continue;
    const auto weight = static_cast<double>(s.weight);
    double seen = 0;
    for (std::size_t m = 0; m < measures; ++m) seen += work.gas_measure[m];
    double mean = weight;
    if constexpr (kSpectral) {
      const float* spectrum = batch.spectrum.data() + static_cast<std::size_t>(i) * nodes_;
      double sum = 0;
      for (std::size_t k = 0; k < nodes_; ++k) {
        const double carried = weight * static_cast<double>(spectrum[k]);
        work.gas_nodes[entry * nodes_ + k] += seen * carried;
        sum += carried;
      }
      mean = sum / static_cast<double>(nodes_);
    }
    work.gas_seen[entry] += seen * mean;
    double* sum = work.gas.data() + entry * measures;
    for (std::size_t m = 0; m < measures; ++m) sum[m] += mean * work.gas_measure[m];
  }
}

// Follows the primary rays of work.batch to their ends and leaves it empty.
template <bool kSpectral>
void PathTracer::trace_batch(Work& work) const {
  work.gas_fractions = 0;
  work.counts->samples += work.batch.size;
  for (std::uint32_t order = 0; order <= settings_.max_reflections && work.batch.size > 0;
       ++order) {
    work.batch.prepare_packets(true);
    if (order == 0 || !settings_.skip_self_intersection) {
      work.batch.for_each_packet([&](RayPacket& packet, int count) {
        target_.tracer->intersect(packet, count, order == 0);
      });
      work.counts->rays += work.batch.size;
    }
    if (order > 0) work.counts->reflected_rays += work.batch.size;
    if (order == 0 && gas_ != nullptr) cross_gas(work);
    if (order > 0 && gas_around_ != nullptr) cross_gas_around<kSpectral>(work);
    work.next.size = 0;
    arrive<kSpectral>(work, order);
    if (!work.first_hit.empty()) light_first_hits(work);
    if (order == 0 && work.plan->whole_parts) meet_parts_behind(work);
    if (any_glint_) trace_glint<kSpectral>(work, order);
    if (land_ != nullptr) trace_land_suns<kSpectral>(work, order);
    if (order < settings_.max_reflections) {
      depart<kSpectral>(work, order);
      trace_shadows<kSpectral>(work, order);
    }
    std::swap(work.batch, work.next);
  }
  work.batch.size = 0;
}

}  // namespace irsig
