#include "core/signature/profile.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/accuracy/pilot_samples.h"
#include "core/base/sobol.h"
#include "core/base/status_macros.h"
#include "core/signature/view/prepared_view.h"
#include "core/signature/view_seed.h"
#include "core/sources/view_sources.h"

namespace irsig {
namespace {

std::uint64_t hash_of(std::uint64_t state, std::initializer_list<double> values) {
  for (const double v : values) state = mix64(state ^ std::bit_cast<std::uint64_t>(v));
  return state;
}

// Radiance of a unit weight of each source in one band: [source] grey, [source][node] else.
struct PointTable {
  std::vector<double> source, apparent;
  double path_w_m2_sr = 0;  // what the air adds to a footprint
  double brightest_w_m2_sr = 0;
  double most_transmittance = 1;  // of the air, at any node of the band
};

SourceRequest without_contrast(SourceRequest request) {
  request.contrast = false;
  return request;
}

// Conditions x bands as seen along one line of sight.
class LineShading {
 public:
  LineShading(const PreparedScene& scene, const ViewRequest& request,
              std::shared_ptr<const ViewEnvironments> environments,
              const std::vector<std::uint32_t>& conditions, const std::vector<std::uint32_t>& bands)
      : sources_(without_contrast(source_request(scene, request, conditions)),
                 EffectSet::everything(request.condition.size(), 1), std::move(environments),
                 scene.axis.node_um()),
        spectral_(std::any_of(scene.material.begin(), scene.material.end(),
                              [](const Material& m) { return !m.grey(); })),
        columns_(spectral_ ? scene.axis.nodes() : 1),
        bands_(bands.size()) {
    for (std::size_t i = 0; i < conditions.size(); ++i)
      for (const std::uint32_t b : bands)
        table_.push_back(table_of(sources_.wanted(i), scene.axis.band(b)));
  }

  [[nodiscard]] const ViewSources& sources() const { return sources_; }
  // Returns the number of a table's columns for one source.
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] const ConditionSources& light(std::size_t row) const {
    return sources_.wanted(row / bands_);
  }
  // Conditions x bands.
  [[nodiscard]] const std::vector<PointTable>& tables() const { return table_; }

 private:
  [[nodiscard]] PointTable table_of(const ConditionSources& light, const BandOnAxis& band) const {
    PointTable table;
    const SourceRange all = sources_.layout().all();
    table.source.assign(all.size() * columns_, 0.0);
    table.apparent.assign(all.size() * columns_, 0.0);
    const SourceRange around = sources_.layout().around();
    std::vector<double> here, arrives;
    for (const SourceId id : all) {
      std::span<const double> spectrum, apparent_spectrum;
      if (around.contains(id)) {
        here = light.around().radiance(index_of(id) - around.first);
        arrives = light.around().apparent(index_of(id) - around.first);
        spectrum = here;
        apparent_spectrum = arrives;
      } else {
        spectrum = light.radiance(id);
        apparent_spectrum = light.apparent(id);
      }
      const double* radiance = spectrum.data() + band.first_node;
      const double* seen = apparent_spectrum.data() + band.first_node;
      double* source = table.source.data() + index_of(id) * columns_;
      double* apparent = table.apparent.data() + index_of(id) * columns_;
      for (std::size_t i = 0; i < band.nodes(); ++i) {
        const std::size_t at = spectral_ ? band.first_node + i : 0;
        source[at] += band.grid.band_weight[i] * radiance[i];
        apparent[at] += band.grid.band_weight[i] * seen[i];
      }
    }
    const std::vector<double>& transmittance = light.environment().transmittance;
    if (band.nodes() > 0) table.most_transmittance = 0;
    for (std::size_t i = 0; i < band.nodes(); ++i) {
      table.path_w_m2_sr +=
          band.grid.band_weight[i] * light.environment().path_radiance[band.first_node + i];
      table.most_transmittance =
          std::max(table.most_transmittance, transmittance[band.first_node + i]);
    }
    table.brightest_w_m2_sr = light.brightest_w_m2_sr(band);
    return table;
  }

  ViewSources sources_;
  bool spectral_;
  std::size_t columns_, bands_;
  std::vector<PointTable> table_;
};

// One point, measured: statistics of (conditions x bands x numbers of reflections) x {radiance,
// apparent radiance}, then the footprint's share that the target covers.
struct MeasuredPoint {
  ReplicateStatistics statistics;
  std::vector<double> beyond;  // throughput left after each number of reflections
  PathCounts counts;
};

class PointMeasurement {
 public:
  PointMeasurement(const PreparedScene& scene, const ViewRequest& request,
                   const ProfileSpec& profile, Vec<Body> at)
      : scene_(scene), request_(request), profile_(profile) {
    const Viewpoint& v = request.viewpoint;
    const Vec<Body> sensor =
        v.range_m * body_from_aspect(v.aspect_azimuth_deg, v.aspect_elevation_deg);
    view_ = make_footprint_view(scene.target, sensor, at, profile.width_m, profile.height_m);
    seed_ = hash_of(scene.hash ^ mix64(request.seed),
                    {v.aspect_azimuth_deg, v.aspect_elevation_deg, v.range_m, at.x, at.y, at.z,
                     profile.width_m, profile.height_m});
  }

  [[nodiscard]] double range_m() const { return view_.view.range_m; }

  [[nodiscard]] MeasuredPoint run(const LineShading& shading, std::uint64_t samples,
                                  std::uint64_t stage) const {
    PathSettings settings;
    settings.max_reflections = profile_.reflections.back();
    settings.seed = mix64(seed_ + stage);
    settings.samples = samples;
    settings.replicates = request_.accuracy.replicates;
    // One ray leaves each vertex: on the diffuse box of tests/physics/box_cavity_test.cpp CPU time
    // x error^2 is 2.4, 5.5, 8, 16 s mK^2 for a split of 1, 8, 16, 32.
    settings.split = 1;
    settings.by_order = true;
    settings.background = true;
    const PathTracer tracer(scene_.target, scene_.material, view_.view,
                            shading.sources().geometry(), settings);
    MeasuredPoint out;
    out.beyond.assign(profile_.reflections.size(), 0.0);
    const std::size_t orders = profile_.reflections.size(), rows = shading.tables().size();
    out.statistics = ReplicateStatistics(2 * rows * orders + 1);
    std::vector<double> values(2 * rows * orders + 1);
    for (const PathWeights& weights : tracer.trace(out.counts)) {
      for (std::size_t row = 0; row < rows; ++row)
        shade(weights, shading, row, values.data() + 2 * row * orders);
      values.back() = weights.projected_area_m2 / view_.footprint_m2;
      out.statistics.add(values);
      add_beyond(weights, tracer, out.beyond);
    }
    return out;
  }

 private:
  // Adds up the orders 0 .. N of each number of reflections N asked for.
  void shade(const PathWeights& weights, const LineShading& shading, std::size_t row,
             double* out) const {
    const PointTable& table = shading.tables()[row];
    const std::size_t columns = shading.columns();
    const std::uint32_t parts = static_cast<std::uint32_t>(scene_.target.part.size());
    double source = 0, apparent = 0;
    const auto add = [&](SourceId id, const double* w) {
      const double* at_target = table.source.data() + index_of(id) * columns;
      const double* at_sensor = table.apparent.data() + index_of(id) * columns;
      for (std::size_t i = 0; i < columns; ++i) {
        source += w[i] * at_target[i];
        apparent += w[i] * at_sensor[i];
      }
    };
    std::size_t next = 0;
    for (std::uint32_t order = 0; order <= profile_.reflections.back(); ++order) {
      const SourceWeights& of_paths = weights.of_order[order];
      const ConditionSources& light = shading.light(row);
      SourceWeights lit;
      if (light.converts()) lit = light.lit(of_paths);
      const SourceWeights& of_order = light.converts() ? lit : of_paths;
      for (std::uint32_t first = 0; first < parts; ++first)
        of_order.for_each(first, shading.sources().layout().all(), add);
      // Behind the target nothing is reflected: the sky or the lower hemisphere itself.
      of_order.for_each(parts, shading.sources().layout().around(), add);
      if (order != profile_.reflections[next]) continue;
      out[2 * next] = source / view_.footprint_m2;
      out[2 * next + 1] = apparent / view_.footprint_m2 + table.path_w_m2_sr;
      ++next;
    }
  }

  // Adds the light that is still on its way after N reflections, and has not been emitted or met
  // the sky before: with emissivity + DHR = 1, all that later orders bring, and the rest after the
  // last.
  void add_beyond(const PathWeights& weights, const PathTracer& tracer,
                  std::vector<double>& beyond) const {
    const std::size_t nodes = tracer.nodes();
    std::vector<double> later(nodes, weights.truncated_m2);
    std::size_t next = profile_.reflections.size();
    for (std::uint32_t order = profile_.reflections.back() + 1; order-- > 0;) {
      if (next > 0 && order == profile_.reflections[next - 1]) {
        --next;
        beyond[next] += *std::max_element(later.begin(), later.end()) /
                        (view_.footprint_m2 * request_.accuracy.replicates);
      }
      for (std::uint32_t first = 0; first < tracer.firsts(); ++first)
        weights.of_order[order].for_each(first, tracer.layout().without_sun(),
                                         [&](SourceId /*id*/, const double* w) {
                                           for (std::size_t i = 0; i < nodes; ++i) later[i] += w[i];
                                         });
    }
  }

  const PreparedScene& scene_;
  const ViewRequest& request_;
  const ProfileSpec& profile_;
  FootprintView view_;
  std::uint64_t seed_ = 0;
};

// Returns the error by light that no sample of a footprint may have met: as if two of all samples
// had met the brightest there is, or nothing, in place of the mean. Scatter alone is 0 where all
// samples fall on one side of an edge that cuts the footprint's rim.
double undersampling_stderr(const PointTable& table, double radiance, double samples) {
  return 2 / samples * std::max(table.brightest_w_m2_sr - radiance, radiance);
}
Estimate with_unseen(const Estimate& estimate, double unseen) {
  return {estimate.value, std::hypot(estimate.stderr_, unseen)};
}

// The blackbody's temperature with this in-band radiance, and what the radiance's standard error is
// in kelvin there. NaN, both, where no blackbody has that radiance.
Estimate temperature_of(const Band& band, const BandGrid& grid, const Estimate& radiance) {
  Estimate t{radiance_temperature_k(band, grid, radiance.value), 0};
  if (std::isnan(t.value)) return {t.value, t.value};
  if (t.value == 0 || radiance.stderr_ <= 0) return t;
  // A difference over a ten thousandth of the radiance: the curve is smooth, its value exact to
  // 1e-12.
  const double step = 1e-4 * radiance.value;
  const double slope = (radiance_temperature_k(band, grid, radiance.value + step) -
                        radiance_temperature_k(band, grid, radiance.value - step)) /
                       (2 * step);
  t.stderr_ = slope * radiance.stderr_;
  return t;
}

absl::Status check(const ViewRequest& request, const ProfileSpec& profile) {
  if (profile.point.empty()) return absl::InvalidArgumentError("a profile has no points");
  if (!(profile.width_m > 0 && profile.height_m > 0))
    return absl::InvalidArgumentError("a profile's footprint is empty");
  if (profile.reflections.empty() ||
      std::adjacent_find(profile.reflections.begin(), profile.reflections.end(),
                         std::greater_equal<>()) != profile.reflections.end())
    return absl::InvalidArgumentError("a profile's numbers of reflections must increase");
  if ((profile.samples > 0) == (profile.source_radiance_temperature_stderr_k > 0))
    return absl::InvalidArgumentError(
        "a profile has either a number of samples or a standard error that is wanted");
  for (const Vec<Body>& at : profile.point)
    if (!(length(at) < request.viewpoint.range_m))
      return absl::InvalidArgumentError(
          absl::StrCat("the sensor, at ", request.viewpoint.range_m,
                       " m, is nearer to the target than a point of the profile"));
  return absl::OkStatus();
}

// Samples of a replicate for the standard error that is wanted under every condition and in every
// band, at the largest number of reflections.
std::uint64_t pilot_samples(const PreparedScene& scene, const ViewRequest& request,
                            std::shared_ptr<const ViewEnvironments> environments,
                            const ProfileSpec& profile, const PointMeasurement& point,
                            std::uint64_t& rays) {
  std::vector<std::uint32_t> conditions(request.condition.size()), bands(scene.axis.bands());
  for (std::uint32_t i = 0; i < conditions.size(); ++i) conditions[i] = i;
  for (std::uint32_t i = 0; i < bands.size(); ++i) bands[i] = i;
  const LineShading shading(scene, request, std::move(environments), conditions, bands);
  const MeasuredPoint first = point.run(shading, kFirstProfileSamples, kFirstPilotStage);
  const MeasuredPoint second = point.run(shading, kSecondProfileSamples, kSecondPilotStage);
  rays += first.counts.rays + second.counts.rays;
  const std::uint64_t most =
      std::min<std::uint64_t>(request.accuracy.max_samples_per_replicate, kMostSamples);
  std::uint64_t samples = 16;
  const std::size_t orders = profile.reflections.size();
  for (std::size_t row = 0; row < shading.tables().size(); ++row)
    for (std::size_t n = 0; n < orders; ++n) {
      const std::uint32_t b = bands[row % bands.size()];
      const std::size_t q = 2 * (row * orders + n);
      const Estimate sampled = second.statistics.estimate(q);
      const double unseen = undersampling_stderr(shading.tables()[row], sampled.value,
                                                 static_cast<double>(second.counts.samples));
      const Estimate e = with_unseen(sampled, unseen);
      const Estimate t = temperature_of(scene.band[b], scene.axis.grids()[b], e);
      if (!(t.stderr_ > 0 && std::isfinite(t.stderr_))) continue;  // the stored run will tell
      const double wanted = e.stderr_ * profile.source_radiance_temperature_stderr_k / t.stderr_;
      samples = std::max(
          samples,
          samples_needed_with_unseen(kFirstProfileSamples, first.statistics.estimate(q).stderr_,
                                     kSecondProfileSamples, sampled.stderr_, unseen, wanted, most));
    }
  return std::min(samples, most);
}

double quadrature_bound(const PreparedScene& scene, const ConditionSpec& condition,
                        std::uint32_t band, double value, double brightest) {
  double coldest = 1e9, hottest = 1;
  for (const double t : condition.part_temperature_k) {
    coldest = std::min(coldest, t);
    hottest = std::max(hottest, t);
  }
  if (condition.emitter && condition.emitter->hottest_k > 0)
    coldest = std::min(coldest, condition.emitter->coldest_k);
  if (condition.surroundings.sky_temperature_k > 0)
    coldest = std::min(coldest, condition.surroundings.sky_temperature_k);
  const double thermal =
      scene.quadrature_relative(band, std::clamp(coldest, 1.0, hottest), hottest);
  // All of it may be sunlight.
  const double sun = sun_shines(condition) ? scene.sun_quadrature[band].of_white : 0;
  return std::abs(value) * std::max(thermal, sun) + 4 * scene.corners_left_out[band] * brightest;
}

}  // namespace

absl::StatusOr<ProfileResult> simulate_profile(const PreparedScene& scene,
                                               const ViewRequest& request,
                                               const ProfileSpec& profile) {
  RETURN_IF_ERROR(check(request, profile));
  const std::size_t orders = profile.reflections.size();
  std::vector<std::uint32_t> conditions(request.condition.size());
  std::iota(conditions.begin(), conditions.end(), 0u);
  ProfileResult out;
  for (std::uint32_t p = 0; p < profile.point.size(); ++p) {
    const PointMeasurement point(scene, request, profile, profile.point[p]);
    ASSIGN_OR_RETURN(auto seen, view_environments(request, scene.target, point.range_m(),
                                                  conditions, scene.axis.node_um()));
    const auto environments = std::make_shared<const ViewEnvironments>(std::move(seen));
    std::uint64_t samples;
    if (profile.samples > 0) {
      const double wanted = std::ceil(profile.samples / request.accuracy.replicates / 16) * 16;
      samples = static_cast<std::uint64_t>(std::min(wanted, static_cast<double>(kMostSamples)));
    } else {
      samples = pilot_samples(scene, request, environments, profile, point, out.counts.rays);
    }
    const LineShading shading(scene, request, environments, request.selected_condition,
                              request.selected_band);
    const MeasuredPoint measured = point.run(shading, samples, kStoredStage);
    const ReplicateStatistics& s = measured.statistics;
    for (std::size_t row = 0; row < shading.tables().size(); ++row)
      for (std::size_t n = 0; n < orders; ++n) {
        ProfileRow& r = out.row.emplace_back();
        r.point = p;
        r.condition = request.selected_condition[row / request.selected_band.size()];
        r.band = request.selected_band[row % request.selected_band.size()];
        r.reflections = profile.reflections[n];
        const PointTable& table = shading.tables()[row];
        const Estimate source = s.estimate(2 * (row * orders + n));
        const double unseen =
            undersampling_stderr(table, source.value, static_cast<double>(measured.counts.samples));
        r.radiance_w_m2_sr = with_unseen(source, unseen);
        r.apparent_radiance_w_m2_sr =
            with_unseen(s.estimate(2 * (row * orders + n) + 1), table.most_transmittance * unseen);
        r.truncation_bound_w_m2_sr = measured.beyond[n] * table.brightest_w_m2_sr;
        r.quadrature_bound_w_m2_sr =
            quadrature_bound(scene, request.condition[r.condition], r.band,
                             r.radiance_w_m2_sr.value, table.brightest_w_m2_sr);
        r.source_radiance_temperature_k =
            temperature_of(scene.band[r.band], scene.axis.grids()[r.band], r.radiance_w_m2_sr);
        r.target_fraction = s.estimate(2 * shading.tables().size() * orders).value;
      }
    out.samples.push_back(measured.counts.samples);
    out.counts.samples += measured.counts.samples;
    out.counts.target_paths += measured.counts.target_paths;
    out.counts.rays += measured.counts.rays;
    out.counts.guarded_backface_hits += measured.counts.guarded_backface_hits;
    out.counts.guarded_nonfinite += measured.counts.guarded_nonfinite;
    out.counts.guarded_negative += measured.counts.guarded_negative;
    out.counts.truncated_paths += measured.counts.truncated_paths;
  }
  return out;
}

}  // namespace irsig
