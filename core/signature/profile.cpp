#include "core/signature/profile.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "absl/strings/str_cat.h"
#include "core/accuracy/pilot_samples.h"
#include "core/base/sobol.h"
#include "core/signature/pass.h"
#include "core/signature/shading.h"
#include "core/signature/view_plan.h"

namespace irsig {
namespace {

std::uint64_t hash_of(std::uint64_t state, std::initializer_list<double> values) {
  for (const double v : values) state = mix64(state ^ std::bit_cast<std::uint64_t>(v));
  return state;
}

// What a unit weight of each (first part, class) is worth in one band: [w] grey, [w][node] else.
struct PointTable {
  std::vector<double> source, apparent;
  double path_w_m2_sr = 0;  // what the air adds to a footprint
  double brightest_w_m2_sr = 0;
};

// Conditions x bands as seen along one line of sight.
class LineShading {
 public:
  LineShading(const Simulator& simulator, const ViewRequest& request,
              const ViewEnvironments& environments, std::span<const std::uint32_t> conditions,
              std::span<const std::uint32_t> bands)
      : bands_(bands.begin(), bands.end()), directions_(environments.directions) {
    const auto& grids = simulator.band_grids();
    for (const BandGrid& grid : grids) {
      band_offset_.push_back(node_um_.size());
      node_um_.insert(node_um_.end(), grid.node_um.begin(), grid.node_um.end());
    }
    for (const std::uint32_t c : conditions) {
      const int sun = sun_of(request.condition[c]);
      sun_of_condition_.push_back(sun);
    }
    classes_ = source_classes(simulator.target().part.size(), suns_, over_sea(request), directions_,
                              nullptr);
    bool spectral = false;
    for (const Material& m : simulator.materials()) spectral |= !m.grey();
    const std::size_t nodes = spectral ? node_um_.size() : 1;
    for (std::size_t i = 0; i < conditions.size(); ++i) {
      const ConditionShading shading(request.condition[conditions[i]],
                                     environments.condition[conditions[i]], classes_,
                                     sun_of_condition_[i], node_um_);
      for (const std::uint32_t b : bands_)
        table_.push_back(table_of(shading, grids[b], band_offset_[b], spectral, nodes));
    }
  }

  [[nodiscard]] const std::vector<SunDirection>& suns() const { return suns_; }
  [[nodiscard]] const SourceClasses& classes() const { return classes_; }
  [[nodiscard]] const DirectionNodes& directions() const { return directions_; }
  // Conditions x bands.
  [[nodiscard]] const std::vector<PointTable>& tables() const { return table_; }

 private:
  // The index of a condition's sun among those that shine; -1: none does.
  int sun_of(const ConditionSpec& condition) {
    if (!sun_shines(condition)) return -1;
    const double radius = condition.sun_angular_radius_deg * std::numbers::pi / 180;
    const auto same = std::find_if(suns_.begin(), suns_.end(), [&](const SunDirection& s) {
      return s.direction == condition.sun_direction && s.angular_radius_rad == radius &&
             s.sea_wind_m_s == condition.sea_wind_m_s;
    });
    if (same != suns_.end()) return static_cast<int>(same - suns_.begin());
    suns_.push_back({condition.sun_direction, radius, 0, condition.sea_wind_m_s});
    return static_cast<int>(suns_.size()) - 1;
  }

  [[nodiscard]] PointTable table_of(const ConditionShading& shading, const BandGrid& grid,
                                    std::size_t offset, bool spectral, std::size_t nodes) const {
    const std::size_t n = grid.node_um.size();
    PointTable table;
    const std::size_t bins = static_cast<std::size_t>(classes_.parts + 1) * classes_.count();
    table.source.assign(bins * nodes, 0.0);
    table.apparent.assign(bins * nodes, 0.0);
    for (std::uint32_t f = 0; f <= classes_.parts; ++f)
      for (std::uint32_t c = 0; c < classes_.count(); ++c) {
        // Behind the target nothing is reflected: the sky or the lower hemisphere itself.
        if (f == classes_.parts && (c < classes_.sky() || c >= classes_.sun(0))) continue;
        const double* radiance = shading.source(f, c).data() + offset;
        const double* seen = shading.apparent(f, c).data() + offset;
        double* source = table.source.data() + (f * classes_.count() + c) * nodes;
        double* apparent = table.apparent.data() + (f * classes_.count() + c) * nodes;
        for (std::size_t i = 0; i < n; ++i) {
          const std::size_t at = spectral ? offset + i : 0;
          source[at] += grid.band_weight[i] * radiance[i];
          apparent[at] += grid.band_weight[i] * seen[i];
        }
      }
    for (std::size_t i = 0; i < n; ++i)
      table.path_w_m2_sr += grid.band_weight[i] * shading.environment().path_radiance[offset + i];
    table.brightest_w_m2_sr = shading.brightest_w_m2_sr(grid, offset);
    return table;
  }

  std::vector<std::uint32_t> bands_;
  DirectionNodes directions_;
  std::vector<double> node_um_;
  std::vector<std::size_t> band_offset_;
  std::vector<SunDirection> suns_;
  std::vector<int> sun_of_condition_;
  SourceClasses classes_;
  std::vector<PointTable> table_;
};

// One point, measured: statistics of (conditions x bands x numbers of reflections) x {radiance,
// apparent radiance}, then the footprint's share that the target covers.
struct Measured {
  ReplicateStatistics statistics;
  std::vector<double> beyond;  // throughput left after each number of reflections
  PathCounts counts;
};

class PointMeasurement {
 public:
  PointMeasurement(const Simulator& simulator, const ViewRequest& request,
                   const ProfileSpec& profile, Vec<Body> at)
      : simulator_(simulator), request_(request), profile_(profile) {
    const Viewpoint& v = request.viewpoint;
    const Vec<Body> sensor =
        v.range_m * body_from_aspect(v.aspect_azimuth_deg, v.aspect_elevation_deg);
    view_ = make_footprint_view(simulator.target(), sensor, at, profile.width_m, profile.height_m);
    seed_ = hash_of(simulator.scene_hash() ^ mix64(request.seed),
                    {v.aspect_azimuth_deg, v.aspect_elevation_deg, v.range_m, at.x, at.y, at.z,
                     profile.width_m, profile.height_m});
  }

  [[nodiscard]] double range_m() const { return view_.view.range_m; }

  [[nodiscard]] Measured run(const LineShading& shading, std::uint64_t samples,
                             std::uint64_t stage) const {
    PathSettings settings;
    settings.max_reflections = profile_.reflections.back();
    settings.lower_is_sea = over_sea(request_);
    settings.sea_z_m = -simulator_.target().centre.z;
    settings.earth_radius_m = settings.lower_is_sea ? kEarthRadiusM : 0;
    settings.seed = mix64(seed_ + stage);
    settings.samples = samples;
    settings.replicates = request_.accuracy.replicates;
    // One ray leaves each vertex: on the diffuse box of tests/physics/box_cavity_test.cpp CPU time
    // x error^2 is 2.4, 5.5, 8, 16 s mK^2 for a split of 1, 8, 16, 32.
    settings.split = 1;
    settings.by_order = true;
    settings.background = true;
    settings.directions = shading.directions();
    const PathTracer tracer(simulator_.target(), simulator_.materials(), view_.view, shading.suns(),
                            settings);
    Measured out;
    out.beyond.assign(profile_.reflections.size(), 0.0);
    const std::size_t orders = profile_.reflections.size(), rows = shading.tables().size();
    out.statistics = ReplicateStatistics(2 * rows * orders + 1);
    std::vector<double> no_image;
    std::vector<double> values(2 * rows * orders + 1);
    for (const PathWeights& weights : tracer.trace(ImagePlan{}, no_image, out.counts)) {
      for (std::size_t row = 0; row < rows; ++row)
        shade(weights, tracer, shading.tables()[row], values.data() + 2 * row * orders);
      values.back() = weights.projected_area_m2 / view_.footprint_m2;
      out.statistics.add(values);
      add_beyond(weights, tracer, out.beyond);
    }
    return out;
  }

 private:
  // Adds up the orders 0 .. N of each number of reflections N asked for.
  void shade(const PathWeights& weights, const PathTracer& tracer, const PointTable& table,
             double* out) const {
    const std::size_t bins = tracer.bins();
    double source = 0, apparent = 0;
    std::size_t next = 0;
    for (std::uint32_t order = 0; order <= profile_.reflections.back(); ++order) {
      const double* w = weights.weight.data() + order * bins;
      for (std::size_t i = 0; i < bins; ++i) {
        source += w[i] * table.source[i];
        apparent += w[i] * table.apparent[i];
      }
      if (order != profile_.reflections[next]) continue;
      out[2 * next] = source / view_.footprint_m2;
      out[2 * next + 1] = apparent / view_.footprint_m2 + table.path_w_m2_sr;
      ++next;
    }
  }

  // What is still on its way after N reflections has not been emitted or met the sky before: with
  // emissivity + DHR = 1, all that later orders bring, and what is left after the last.
  void add_beyond(const PathWeights& weights, const PathTracer& tracer,
                  std::vector<double>& beyond) const {
    const std::size_t nodes = tracer.nodes();
    const SourceClasses& classes = tracer.classes();
    std::vector<double> later(nodes, weights.truncated_m2);
    std::size_t next = profile_.reflections.size();
    for (std::uint32_t order = profile_.reflections.back() + 1; order-- > 0;) {
      if (next > 0 && order == profile_.reflections[next - 1]) {
        --next;
        beyond[next] += *std::max_element(later.begin(), later.end()) /
                        (view_.footprint_m2 * request_.accuracy.replicates);
      }
      const double* w = weights.weight.data() + order * tracer.bins();
      for (std::uint32_t f = 0; f < tracer.firsts(); ++f)
        for (std::uint32_t c = 0; c < classes.sun(0); ++c)
          for (std::size_t i = 0; i < nodes; ++i)
            later[i] += w[(f * classes.count() + c) * nodes + i];
    }
  }

  const Simulator& simulator_;
  const ViewRequest& request_;
  const ProfileSpec& profile_;
  FootprintView view_;
  std::uint64_t seed_ = 0;
};

// The blackbody's temperature with this in-band radiance, and what the radiance's standard error is
// in kelvin there. NaN, both, where no blackbody has that radiance.
Estimate temperature_of(const Band& band, const BandGrid& grid, const Estimate& radiance) {
  Estimate t{apparent_temperature_k(band, grid, radiance.value), 0};
  if (std::isnan(t.value)) return {t.value, t.value};
  if (t.value == 0 || radiance.stderr_ <= 0) return t;
  // A difference over a ten thousandth of the radiance: the curve is smooth, its value exact to
  // 1e-12.
  const double step = 1e-4 * radiance.value;
  const double slope = (apparent_temperature_k(band, grid, radiance.value + step) -
                        apparent_temperature_k(band, grid, radiance.value - step)) /
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
  if ((profile.samples > 0) == (profile.apparent_temperature_stderr_k > 0))
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
std::uint64_t pilot_samples(const Simulator& simulator, const ViewRequest& request,
                            const ViewEnvironments& environments, const ProfileSpec& profile,
                            const PointMeasurement& point, std::uint64_t& rays) {
  std::vector<std::uint32_t> conditions(request.condition.size()), bands(simulator.bands().size());
  for (std::uint32_t i = 0; i < conditions.size(); ++i) conditions[i] = i;
  for (std::uint32_t i = 0; i < bands.size(); ++i) bands[i] = i;
  const LineShading shading(simulator, request, environments, conditions, bands);
  const Measured first = point.run(shading, kFirstProfileSamples, kFirstPilotStage);
  const Measured second = point.run(shading, kSecondProfileSamples, kSecondPilotStage);
  rays += first.counts.rays + second.counts.rays;
  const std::uint64_t most =
      std::min<std::uint64_t>(request.accuracy.max_samples_per_replicate, kMostSamples);
  std::uint64_t samples = 16;
  const std::size_t orders = profile.reflections.size();
  for (std::size_t row = 0; row < shading.tables().size(); ++row)
    for (std::size_t n = 0; n < orders; ++n) {
      const std::uint32_t b = bands[row % bands.size()];
      const std::size_t q = 2 * (row * orders + n);
      const Estimate e = second.statistics.estimate(q);
      const Estimate t = temperature_of(simulator.bands()[b], simulator.band_grids()[b], e);
      if (!(t.stderr_ > 0 && std::isfinite(t.stderr_))) continue;  // the stored run will tell
      const double wanted = e.stderr_ * profile.apparent_temperature_stderr_k / t.stderr_;
      samples = std::max(samples,
                         samples_needed(kFirstProfileSamples, first.statistics.estimate(q).stderr_,
                                        kSecondProfileSamples, e.stderr_, wanted, most));
    }
  return std::min(samples, most);
}

double quadrature_bound(const Simulator& simulator, const ConditionSpec& condition,
                        std::uint32_t band, double value) {
  double coldest = 1e9, hottest = 1;
  for (const double t : condition.part_temperature_k) {
    coldest = std::min(coldest, t);
    hottest = std::max(hottest, t);
  }
  if (condition.surroundings.sky_temperature_k > 0)
    coldest = std::min(coldest, condition.surroundings.sky_temperature_k);
  return std::abs(value) * quadrature_relative_bound(simulator.bands()[band],
                                                     simulator.band_grids()[band],
                                                     std::clamp(coldest, 1.0, hottest), hottest);
}

}  // namespace

absl::StatusOr<ProfileResult> simulate_profile(const Simulator& simulator,
                                               const ViewRequest& request,
                                               const ProfileSpec& profile) {
  if (absl::Status status = check(request, profile); !status.ok()) return status;
  const std::size_t orders = profile.reflections.size();
  std::vector<std::uint32_t> conditions(request.condition.size());
  std::iota(conditions.begin(), conditions.end(), 0u);
  std::vector<double> simulator_nodes;
  for (const BandGrid& grid : simulator.band_grids())
    simulator_nodes.insert(simulator_nodes.end(), grid.node_um.begin(), grid.node_um.end());
  ProfileResult out;
  for (std::uint32_t p = 0; p < profile.point.size(); ++p) {
    const PointMeasurement point(simulator, request, profile, profile.point[p]);
    const auto environments = view_environments(request, simulator.target(), point.range_m(),
                                                conditions, simulator_nodes);
    if (!environments.ok()) return environments.status();
    std::uint64_t samples;
    if (profile.samples > 0) {
      const double wanted = std::ceil(profile.samples / request.accuracy.replicates / 16) * 16;
      samples = static_cast<std::uint64_t>(std::min(wanted, static_cast<double>(kMostSamples)));
    } else {
      samples = pilot_samples(simulator, request, *environments, profile, point, out.counts.rays);
    }
    const LineShading shading(simulator, request, *environments, request.selected_condition,
                              request.selected_band);
    const Measured measured = point.run(shading, samples, kStoredStage);
    const ReplicateStatistics& s = measured.statistics;
    for (std::size_t row = 0; row < shading.tables().size(); ++row)
      for (std::size_t n = 0; n < orders; ++n) {
        ProfileRow& r = out.row.emplace_back();
        r.point = p;
        r.condition = request.selected_condition[row / request.selected_band.size()];
        r.band = request.selected_band[row % request.selected_band.size()];
        r.reflections = profile.reflections[n];
        r.radiance_w_m2_sr = s.estimate(2 * (row * orders + n));
        r.apparent_radiance_w_m2_sr = s.estimate(2 * (row * orders + n) + 1);
        r.truncation_bound_w_m2_sr = measured.beyond[n] * shading.tables()[row].brightest_w_m2_sr;
        r.quadrature_bound_w_m2_sr = quadrature_bound(simulator, request.condition[r.condition],
                                                      r.band, r.radiance_w_m2_sr.value);
        r.apparent_temperature_k = temperature_of(
            simulator.bands()[r.band], simulator.band_grids()[r.band], r.radiance_w_m2_sr);
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
