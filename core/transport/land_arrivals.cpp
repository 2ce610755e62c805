// Effects of land on paths: it hides the target from the sensor and from suns, rays end on it, and
// it stands behind the target.

#include <algorithm>

#include "core/sources/background_land.h"
#include "core/transport/path_work.h"
#include "core/transport/target_shadow.h"

namespace irsig {
namespace {

Vec<Body> to_double(Float3 v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

}  // namespace

bool PathTracer::seen_past_land(Float3 p) const {
  if (land_ == nullptr) return true;
  const Vec<Body> at = to_double(p), sensor = view_.frame.sensor;
  return !land_->hides_from(sensor, at, std::min(1.0, clear_of_sensor_m_ / length(sensor - at)));
}

bool PathTracer::shaded_by_land(RayBatch& batch, std::uint32_t ray, double clear_m) const {
  if (land_ == nullptr || clear_m == 0) return false;
  const RayPacket& packet = batch.packet_of(ray);
  const std::uint32_t lane = RayBatch::lane_of(ray);
  return land_->hides(to_double({packet.org_x[lane], packet.org_y[lane], packet.org_z[lane]}),
                      to_double({packet.dir_x[lane], packet.dir_y[lane], packet.dir_z[lane]}),
                      clear_m);
}

bool PathTracer::below_land(Float3 p) const {
  return land_ != nullptr && land_->covers(to_double(p));
}

template <bool kSpectral>
bool PathTracer::end_on_land(Work& work, std::uint32_t order, const PathState& path, Float3 from,
                             Float3 direction, const float* spectrum) const {
  const std::optional<LandPoint> land =
      land_->meet(to_double(from), to_double(direction), work.land_mix);
  if (!land) return false;
  const Land::RangeShare range = Land::around(land->distance);
  const float open = Land::sky_fraction(*land);
  const LandMix& mix = work.land_mix;
  const auto add_kind = [&](std::uint32_t kind, float share) {
    if (!(share > 0)) return;
    for (std::uint32_t k = 0; k < 2; ++k)
      add<kSpectral>(work, path, order, layout_.land(kind, range.node + k),
                     path.weight * share * range.weight(k), spectrum);
  };
  for (const KindShare& part : mix.kind) add_kind(part.kind, part.share * open);
  for (std::uint32_t m = 0; m < mix.fraction.size(); ++m)
    add_kind(layout_.land_kinds() + m, mix.fraction[m] * (1 - open));
  const auto t = static_cast<float>(land->distance);
  const auto offset_m = static_cast<float>(target_.offset_m());
  const Float3 place{from.x + t * direction.x, from.y + t * direction.y,
                     from.z + t * direction.z - offset_m};
  for (std::uint32_t j = 0; j < sources_.sun.size(); ++j) {
    const double cosine = land_->sun_cosine(*land, sources_.sun[j].direction);
    if (cosine <= 0) continue;
    PathState s = path;
    s.weight *= static_cast<float>(cosine);
    const std::uint32_t ray = work.land_shadow.push(place, work.sun[j].direction, s);
    work.land_sun[ray] = j;
    work.land_range[ray] = range;
    std::copy(mix.fraction.begin(), mix.fraction.end(),
              work.land_fractions.begin() + static_cast<std::ptrdiff_t>(ray * mix.fraction.size()));
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
  const std::uint32_t materials = land_->materials();
  for (std::uint32_t i = 0; i < batch.size; ++i) {
    if (batch.packet_of(i).tfar[RayBatch::lane_of(i)] < 0) continue;
    const PathState& s = batch.state[i];
    const Land::RangeShare& range = work.land_range[i];
    const float* spectrum =
        batch.spectrum.data() + static_cast<std::size_t>(i) * (kSpectral ? nodes_ : 0);
    for (std::uint32_t m = 0; m < materials; ++m) {
      const float fraction = work.land_fractions[i * std::size_t{materials} + m];
      if (!(fraction > 0)) continue;
      for (std::uint32_t k = 0; k < 2; ++k)
        add<kSpectral>(work, s, order, layout_.land_sun(work.land_sun[i], m, range.node + k),
                       s.weight * fraction * range.weight(k), spectrum);
    }
  }
  batch.size = 0;
}

// visit(source, weight): what a ray meets that goes on behind the target. Pictures show the shadow
// of the target on land. The background of rows has none: the target would not be there.
template <typename Visit>
void PathTracer::for_each_behind_target(Vec<Body> from, Vec<Body> direction, LandMix& mix,
                                        Visit&& visit) const {
  const auto lift_m = static_cast<double>(target_.offset_m());
  if (layout_.behind_ranges() > 0)
    if (const auto land = land_->meet_in_sight(view_.frame.sensor, from, direction, mix)) {
      const double range_m = length(from - view_.frame.sensor) + land->distance;
      const auto shaded = [&](std::uint32_t j) {
        if (settings_.pixel_samples == 0) return false;
        TargetShadow shadow(target_);
        return shadow.falls_on(from + land->distance * direction - Vec<Body>{0, 0, lift_m},
                               sources_.sun[j].direction);
      };
      for_each_behind(*land_, layout_, sources_.sun, *land, range_m, mix, shaded, visit);
      return;
    }
  BackgroundDirections::Share share[2];
  const int count = sources_.behind->shares(static_cast<float>(direction.z), share);
  for (int k = 0; k < count; ++k) visit(layout_.behind(share[k].node), share[k].weight);
}

// Finds the mean of rays through the target's rectangle, from behind its centre on.
void PathTracer::find_mean_behind() {
  constexpr int kRays = 16;  // along each side
  const ViewFrame& frame = view_.frame;
  LandMix mix;
  std::vector<float> sum(layout_.behind().size(), 0.0f);
  int rays = 0;
  for (int i = 0; i < kRays; ++i)
    for (int k = 0; k < kRays; ++k) {
      const double x_m = frame.x0_m + (i + 0.5) / kRays * frame.width_m,
                   y_m = frame.y0_m + (k + 0.5) / kRays * frame.height_m;
      const Vec<Body> direction =
          normalized(frame.plane_m * frame.forward + x_m * frame.right + y_m * frame.up);
      const Vec<Body> from = frame.sensor + length(frame.sensor) * direction;
      if (land_->covers_in_sight(frame.sensor, from)) continue;
      ++rays;
      for_each_behind_target(from, direction, mix, [&](SourceId source, float weight) {
        sum[index_of(source) - layout_.behind().first] += weight;
      });
    }
  // Any mean will do whose weights without sunlight add up to 1: rays that meet something else
  // correct it.
  for (const SourceId source : layout_.behind())
    if (const float w = sum[index_of(source) - layout_.behind().first]; w > 0)
      mean_behind_.emplace_back(source, w / static_cast<float>(rays));
}

// The silhouette, by what stands behind it. Where there are no pictures, all rays have the mean of
// what is there, and the first samples of each replicate, which are spread as all are, what they
// meet instead.
void PathTracer::add_land_behind(Work& work, const PathState& path, Float3 from,
                                 Float3 direction) const {
  float scale = 1;
  if (!mean_behind_.empty()) {
    double& mean = work.mean_behind[path.replicate * parts_ + path.first];
    mean += static_cast<double>(path.weight);
    if (path.sample >= work.behind_samples) return;
    scale = work.behind_scale;
    mean -= static_cast<double>(scale * path.weight);
  }
  for_each_behind_target(
      to_double(from), to_double(direction), work.land_mix,
      [&](SourceId source, float weight) { add_behind_to(work, path, source, scale * weight); });
}

void PathTracer::add_mean_behind(Work& work) const {
  for (std::uint32_t r = 0; r < settings_.replicates; ++r)
    for (std::uint32_t part = 0; part < parts_; ++part) {
      const double mean = work.mean_behind[std::size_t{r} * parts_ + part];
      if (mean == 0) continue;
      for (const auto& [source, weight] : mean_behind_) {
        double* out = work.weight[r * work.orders].row(part, source);
        for (std::size_t i = 0; i < nodes_; ++i) out[i] += mean * static_cast<double>(weight);
      }
    }
}

template bool PathTracer::end_on_land<false>(Work&, std::uint32_t, const PathState&, Float3, Float3,
                                             const float*) const;
template bool PathTracer::end_on_land<true>(Work&, std::uint32_t, const PathState&, Float3, Float3,
                                            const float*) const;
template void PathTracer::trace_land_suns<false>(Work&, std::uint32_t) const;
template void PathTracer::trace_land_suns<true>(Work&, std::uint32_t) const;

}  // namespace irsig
