#include "core/signature/signature.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>

#include "absl/strings/str_cat.h"
#include "core/base/sobol.h"
#include "core/signature/shading.h"
#include "core/transport/path_tracer.h"

namespace irsig {
namespace {

// The sampler's coordinates have 23 bits.
constexpr std::uint64_t kMostSamples = 1u << 23;
constexpr double kEarthRadiusM = 6371008.8;  // mean radius, GRS 80  [moritz2000]

class Hash {
 public:
  void add(std::uint64_t x) { state_ = mix64(state_ ^ x); }
  void add(double x) { add(std::bit_cast<std::uint64_t>(x)); }
  void add(const std::vector<float>& v) {
    add(static_cast<std::uint64_t>(v.size()));
    for (const float x : v) add(static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(x)));
  }
  [[nodiscard]] std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0x6972736967ULL;
};

void hash_material(Hash& hash, const MaterialSpec& spec) {
  if (const auto* lambert = std::get_if<Lambert>(&spec.model)) {
    for (const SpectralPoint& p : lambert->emissivity) {
      hash.add(p.lambda_um);
      hash.add(p.value);
    }
    return;
  }
  const auto& lobe = std::get<CookTorrance>(spec.model);
  for (const OpticalConstant& c : lobe.constants) {
    hash.add(c.lambda_um);
    hash.add(c.n);
    hash.add(c.k);
  }
  hash.add(lobe.roughness);
  hash.add(static_cast<std::uint64_t>(lobe.fresnel));
  hash.add(static_cast<std::uint64_t>(lobe.masking));
  hash.add(lobe.normal_emissivity);
  hash.add(lobe.forced_emissivity);
}

bool sun_is_up(const ConditionSpec& condition) {
  return condition.sun_cos_zenith >
         -std::sin(condition.sun_angular_radius_deg * std::numbers::pi / 180);
}

// One pass over a set of conditions and bands: which suns shine, how the conditions shade, and the
// statistics of what is stored.
class Pass {
 public:
  Pass(const Simulator& simulator, const ViewRequest& request, const AimedView& view,
       std::span<const std::uint32_t> conditions, std::span<const std::uint32_t> bands,
       const std::vector<double>& node_um, const std::vector<std::size_t>& band_offset,
       std::uint64_t seed)
      : simulator_(simulator),
        request_(request),
        conditions_(conditions.begin(), conditions.end()),
        bands_(bands.begin(), bands.end()),
        node_um_(node_um),
        band_offset_(band_offset),
        seed_(seed),
        view_(view) {
    std::vector<int> sun_of_condition;
    for (const std::uint32_t c : conditions_) {
      const ConditionSpec& condition = request.condition[c];
      int index = -1;
      // Some of the disk is above the horizon.
      if (condition.sun && condition.sun_scale > 0 && sun_is_up(condition)) {
        const SunDirection sun{condition.sun_direction,
                               condition.sun_angular_radius_deg * std::numbers::pi / 180};
        const auto same = std::find_if(suns_.begin(), suns_.end(), [&](const SunDirection& s) {
          return s.direction == sun.direction && s.angular_radius_rad == sun.angular_radius_rad;
        });
        index = static_cast<int>(same - suns_.begin());
        if (same == suns_.end()) suns_.push_back(sun);
      }
      sun_of_condition.push_back(index);
    }
    classes_ = {static_cast<std::uint32_t>(simulator.target().part.size()),
                static_cast<std::uint32_t>(suns_.size())};
    for (std::size_t i = 0; i < conditions_.size(); ++i)
      shading_.emplace_back(request.condition[conditions_[i]], request.air,
                            request.viewpoint.range_m, classes_, sun_of_condition[i], node_um_);
  }

  [[nodiscard]] const ConditionShading& shading(std::size_t i) const { return shading_[i]; }
  [[nodiscard]] const std::vector<std::uint32_t>& conditions() const { return conditions_; }
  [[nodiscard]] const std::vector<std::uint32_t>& bands() const { return bands_; }
  [[nodiscard]] const PathCounts& counts() const { return counts_; }
  [[nodiscard]] const ReplicateStatistics& statistics(std::size_t row) const {
    return statistics_[row];
  }
  [[nodiscard]] double truncated_m2() const { return truncated_m2_; }
  [[nodiscard]] const std::vector<float>& image() const { return image_; }
  [[nodiscard]] const ViewFrame& frame() const { return view_.frame; }
  [[nodiscard]] const ImagePlan& plan() const { return plan_; }

  // Traces all replicates afresh and keeps the statistics of every row (conditions x bands).
  void run(std::uint64_t samples, std::uint64_t stage, bool pictures) {
    const auto& grids = simulator_.band_grids();
    const Surroundings& surroundings = request_.condition.front().surroundings;
    PathSettings settings;
    settings.max_reflections = request_.max_reflections;
    settings.lower_is_sea = surroundings.kind == SurroundingsKind::kSea;
    settings.sea_z_m = -simulator_.target().centre.z;
    settings.earth_radius_m = settings.lower_is_sea ? kEarthRadiusM : 0;
    settings.seed = mix64(seed_ + stage);
    settings.samples = samples;
    settings.replicates = request_.accuracy.replicates;
    // Where the error is to be small, reflections set it: on the sunlit frigate (hull_paper, 8192
    // samples x 32) CPU time x error^2 is 0.33, 0.23, 0.25, 0.34, 0.44 s (0.1 %)^2 for a split of
    // 1, 2, 4, 8, 16. Where the number of paths is asked for, each stays one path.
    settings.split = request_.accuracy.relative_error > 0 ? 2 : 1;
    const PathTracer tracer(simulator_.target(), simulator_.materials(), view_, suns_, settings);
    plan_ = pictures ? image_plan(tracer) : ImagePlan{};
    image_.assign(static_cast<std::size_t>(plan_.width_px) * plan_.height_px * plan_.padded, 0.0f);
    counts_ = {};
    truncated_m2_ = 0;
    statistics_.clear();
    for (std::size_t i = 0; i < conditions_.size(); ++i)
      for (const std::uint32_t b : bands_)
        statistics_.emplace_back(quantities(classes_.parts, grids[b]));
    std::vector<double> values;
    for (const PathWeights& weights : tracer.trace(plan_, image_, counts_)) {
      truncated_m2_ += weights.truncated_m2 / request_.accuracy.replicates;
      std::size_t row = 0;
      for (const ConditionShading& shading : shading_)
        for (const std::uint32_t b : bands_) {
          shading.evaluate(weights, tracer.spectral(), grids[b], band_offset_[b], values);
          statistics_[row++].add(values);
        }
    }
  }

  // Sum of the bias bounds of a row. [W/sr]
  struct Bounds {
    double truncation, quadrature;
  };
  [[nodiscard]] Bounds bounds(std::size_t row) const {
    const std::size_t c = row / bands_.size();
    const std::uint32_t b = bands_[row % bands_.size()];
    const BandGrid& grid = simulator_.band_grids()[b];
    double coldest = 1e9, hottest = 1;
    for (const double t : request_.condition[conditions_[c]].part_temperature_k) {
      coldest = std::min(coldest, t);
      hottest = std::max(hottest, t);
    }
    return {truncated_m2_ * shading_[c].brightest_w_m2_sr(grid, band_offset_[b]),
            std::abs(statistics_[row].estimate(0).value) *
                quadrature_relative_bound(simulator_.bands()[b], grid,
                                          std::clamp(coldest, 1.0, hottest), hottest)};
  }

  // The standard error that a row may keep for its numerical error to be relative_error x its
  // value: what the bias bounds leave. Where they take more than 0.8 of that, samples cannot mend
  // it: the standard error is then brought to 0.6 of the goal, and the row will say that the target
  // was missed.
  [[nodiscard]] double stderr_wanted(std::size_t row, double relative_error) const {
    const Bounds b = bounds(row);
    const double bias = (b.truncation + b.quadrature) / std::sqrt(3.0);
    const double goal = relative_error * std::abs(statistics_[row].estimate(0).value);
    return bias < 0.8 * goal ? std::sqrt(goal * goal - bias * bias) : 0.6 * goal;
  }

 private:
  [[nodiscard]] ImagePlan image_plan(const PathTracer& tracer) const {
    ImagePlan plan;
    const double longest = std::max(view_.frame.width_m, view_.frame.height_m);
    const auto side = [&](double s) {
      return std::max<std::uint32_t>(
          1, static_cast<std::uint32_t>(std::lround(s / longest * request_.thumbnail_px)));
    };
    plan.width_px = side(view_.frame.width_m);
    plan.height_px = side(view_.frame.height_m);
    plan.images = static_cast<std::uint32_t>(conditions_.size() * bands_.size());
    plan.padded = (plan.images + 7) / 8 * 8;
    const auto& grids = simulator_.band_grids();
    const std::size_t bins = static_cast<std::size_t>(classes_.parts) * classes_.count();
    const std::size_t nodes = tracer.spectral() ? node_um_.size() : 1;
    plan.source.assign(bins * (tracer.spectral() ? plan.images * nodes : plan.padded), 0.0f);
    for (std::uint32_t f = 0; f < classes_.parts; ++f)
      for (std::uint32_t c = 0; c < classes_.count(); ++c)
        for (std::uint32_t k = 0; k < plan.images; ++k) {
          const std::uint32_t b = bands_[k % bands_.size()];
          const double* radiance =
              shading_[k / bands_.size()].source(f, c).data() + band_offset_[b];
          const std::size_t bin = static_cast<std::size_t>(f) * classes_.count() + c;
          double in_band = 0;
          for (std::size_t i = 0; i < grids[b].node_um.size(); ++i) {
            const double value = grids[b].band_weight[i] * radiance[i];
            in_band += value;
            if (tracer.spectral())
              plan.source[(bin * plan.images + k) * nodes + band_offset_[b] + i] =
                  static_cast<float>(value);
          }
          if (!tracer.spectral()) plan.source[bin * plan.padded + k] = static_cast<float>(in_band);
        }
    return plan;
  }

  const Simulator& simulator_;
  const ViewRequest& request_;
  std::vector<std::uint32_t> conditions_, bands_;
  const std::vector<double>& node_um_;
  const std::vector<std::size_t>& band_offset_;
  std::uint64_t seed_;
  SourceClasses classes_;
  std::vector<SunDirection> suns_;
  std::vector<ConditionShading> shading_;
  std::vector<ReplicateStatistics> statistics_;
  PathCounts counts_;
  double truncated_m2_ = 0;
  ImagePlan plan_;
  std::vector<float> image_;
  const AimedView& view_;
};

std::vector<std::uint32_t> all_of(std::size_t n) {
  std::vector<std::uint32_t> out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<std::uint32_t>(i);
  return out;
}

}  // namespace

absl::StatusOr<std::unique_ptr<Simulator>> Simulator::create(const SceneSpec& spec) {
  auto simulator = std::unique_ptr<Simulator>(new Simulator);
  simulator->band_ = spec.band;
  for (const Band& band : spec.band) {
    auto grid = make_band_grid(band);
    if (!grid.ok()) return grid.status();
    simulator->band_offset_.push_back(simulator->node_um_.size());
    simulator->node_um_.insert(simulator->node_um_.end(), grid->node_um.begin(),
                               grid->node_um.end());
    simulator->grid_.push_back(*std::move(grid));
  }
  Hash hash;
  std::vector<double> sorted = simulator->node_um_;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 0; i < spec.material.size(); ++i) {
    const MaterialSpec& m = spec.material[i];
    auto prepared = Material::prepare(m, simulator->node_um_, sorted.front(), sorted.back());
    if (!prepared.ok())
      return absl::Status(prepared.status().code(),
                          absl::StrCat("material[", i, "]: ", prepared.status().message()));
    simulator->material_.push_back(*std::move(prepared));
    hash_material(hash, m);
  }
  auto target = make_target(spec.mesh, spec.part, spec.isa);
  if (!target.ok()) return target.status();
  simulator->target_ = *std::move(target);
  hash.add(simulator->target_.vertex);
  for (const std::uint32_t corner : simulator->target_.triangle)
    hash.add(static_cast<std::uint64_t>(corner));
  for (const PartSpec& part : simulator->target_.part) {
    hash.add(static_cast<std::uint64_t>(part.material * 4 + part.two_sided * 2 + part.hot));
    simulator->energy_gain_ |= simulator->material_[part.material].creates_energy();
  }
  simulator->scene_hash_ = hash.value();
  return simulator;
}

absl::StatusOr<ViewResult> Simulator::simulate(const ViewRequest& request) const {
  const Viewpoint& viewpoint = request.viewpoint;
  const double reach = length(target_.centre) + target_.radius_m;
  if (!(viewpoint.range_m > reach))
    return absl::InvalidArgumentError(absl::StrCat(
        "viewpoints.range_m: a sensor at ", viewpoint.range_m,
        " m is inside the target, which reaches ", reach, " m from its reference point"));
  for (const ConditionSpec& c : request.condition)
    if (c.part_temperature_k.size() != target_.part.size())
      return absl::InvalidArgumentError("a condition does not state one temperature for each part");
  for (const ConditionSpec& c : request.condition)
    if (c.surroundings.kind != request.condition.front().surroundings.kind)
      return absl::InvalidArgumentError(
          "surroundings.kind: all conditions of a sweep need the same kind, since paths are traced "
          "once for all");
  if (request.accuracy.max_samples_per_replicate > kMostSamples ||
      request.accuracy.samples_per_replicate > kMostSamples)
    return absl::InvalidArgumentError(absl::StrCat("accuracy: more than ", kMostSamples,
                                                   " samples in a replicate; use more replicates"));
  if (request.condition.empty() || band_.empty())
    return absl::InvalidArgumentError("a sweep needs a condition and a band");
  if (request.condition.front().surroundings.kind == SurroundingsKind::kSea) {
    const double el = viewpoint.aspect_elevation_deg * std::numbers::pi / 180;
    const double along = viewpoint.range_m * std::cos(el);
    const double height = viewpoint.range_m * std::sin(el) + along * along / (2 * kEarthRadiusM);
    if (height < 0)
      return absl::InvalidArgumentError(
          absl::StrCat("viewpoints: a sensor at ", viewpoint.range_m, " m range and ",
                       viewpoint.aspect_elevation_deg, " deg elevation is under the sea"));
  }

  Hash hash;
  hash.add(scene_hash_);
  hash.add(viewpoint.aspect_azimuth_deg);
  hash.add(viewpoint.aspect_elevation_deg);
  hash.add(viewpoint.range_m);
  hash.add(request.seed);
  const std::uint64_t seed = hash.value();
  constexpr std::uint64_t kFirstPilot = 1, kSecondPilot = 2, kStored = 4;

  const AimedView view = make_aimed_view(target_, viewpoint);

  // The number of samples, from a pilot over every row of the sweep. Nothing of the pilot is
  // stored.
  const AccuracySpec& accuracy = request.accuracy;
  std::uint64_t samples = accuracy.samples_per_replicate;
  bool limited = false;
  std::uint64_t pilot_rays = 0;
  if (accuracy.relative_error > 0 || accuracy.target_paths > 0) {
    Pass pilot(*this, request, view, all_of(request.condition.size()), all_of(band_.size()),
               node_um_, band_offset_, seed);
    constexpr std::uint64_t kFirst = 128, kSecond = 1024;
    if (accuracy.target_paths > 0) {
      // Hits are counted with the strata in the proportion that the stored run has.
      pilot.run(kSecond, kFirstPilot, false);
      pilot_rays += pilot.counts().rays;
      const double per_sample =
          static_cast<double>(pilot.counts().target_paths) / static_cast<double>(kSecond);
      if (per_sample == 0)
        return absl::FailedPreconditionError("target_paths: no ray of the pilot met the target");
      const double wanted = std::ceil(accuracy.target_paths / per_sample / 16) * 16;
      samples = static_cast<std::uint64_t>(
          std::min(wanted, static_cast<double>(accuracy.max_samples_per_replicate)));
      limited = wanted > static_cast<double>(accuracy.max_samples_per_replicate);
    } else {
      pilot.run(kFirst, kFirstPilot, false);
      pilot_rays += pilot.counts().rays;
      const std::size_t rows = pilot.conditions().size() * pilot.bands().size();
      std::vector<double> before;
      for (std::size_t row = 0; row < rows; ++row)
        before.push_back(pilot.statistics(row).estimate(0).stderr_);
      // A larger pilot follows where the first estimate asks for much more: rare bright paths are
      // then seen often enough to be judged.
      std::uint64_t n_before = kFirst, n = kSecond;
      for (std::uint64_t stage = kSecondPilot;; ++stage) {
        pilot.run(n, stage, false);
        pilot_rays += pilot.counts().rays;
        samples = 16;
        for (std::size_t row = 0; row < rows; ++row) {
          const Estimate e = pilot.statistics(row).estimate(0);
          if (e.stderr_ > 0)
            samples =
                std::max(samples, samples_needed(n_before, before[row], n, e.stderr_,
                                                 pilot.stderr_wanted(row, accuracy.relative_error),
                                                 std::uint64_t{1} << 40));
          before[row] = e.stderr_;
        }
        samples = std::min(samples, accuracy.max_samples_per_replicate + 1);
        if (stage != kSecondPilot || samples < 32 * n) break;
        n_before = n;
        n = samples / 16;
      }
      limited = samples > accuracy.max_samples_per_replicate;
      samples = std::min(samples, accuracy.max_samples_per_replicate);
    }
  }

  Pass pass(*this, request, view, request.selected_condition, request.selected_band, node_um_,
            band_offset_, seed);
  pass.run(samples, kStored, request.thumbnail_px > 0);

  ViewResult out;
  out.samples = pass.counts().samples;
  out.target_paths = pass.counts().target_paths;
  out.rays = pass.counts().rays + pilot_rays;
  out.replicates = accuracy.replicates;
  out.samples_per_replicate = samples;
  out.guarded_backface_hits = pass.counts().guarded_backface_hits;
  out.guarded_nonfinite = pass.counts().guarded_nonfinite;
  out.guarded_path_limit = pass.counts().guarded_path_limit;
  out.seed = seed;
  const ImagePlan& plan = pass.plan();
  out.image_width_px = plan.width_px;
  out.image_height_px = plan.height_px;
  // Solid angle of a pixel times range^2, on the image plane's axis; the paths' own Jacobian is in
  // their weights.
  const double pixel_m = plan.width_px > 0 ? pass.frame().width_m / plan.width_px : 0;
  const double pixel_area_m2 =
      plan.width_px > 0 ? pixel_m * pass.frame().height_m / plan.height_px : 0;
  out.pixel_rad = pixel_m / pass.frame().plane_m;
  const double plane_scale = std::pow(viewpoint.range_m / pass.frame().plane_m, 2);

  for (std::size_t row = 0; row < pass.conditions().size() * pass.bands().size(); ++row) {
    SignatureResult& r = out.row.emplace_back();
    r.condition = pass.conditions()[row / pass.bands().size()];
    r.band = pass.bands()[row % pass.bands().size()];
    const BandGrid& grid = grid_[r.band];
    const std::size_t bins = grid.lambda_um.size(), parts = target_.part.size();
    const ReplicateStatistics& s = pass.statistics(row);
    std::size_t q = 0;
    r.intensity_w_sr = s.estimate(q++);
    for (Estimate& cause : r.cause_w_sr) cause = s.estimate(q++);
    r.apparent_intensity_w_sr = s.estimate(q++);
    r.projected_area_m2 = s.estimate(q++);
    for (std::size_t p = 0; p < parts; ++p) r.part_w_sr.push_back(s.estimate(q++));
    const auto spectrum = [&](SpectralEstimate& e) {
      for (std::size_t k = 0; k < bins; ++k, ++q) {
        e.value.push_back(s.estimate(q).value);
        e.stderr_.push_back(s.estimate(q).stderr_);
      }
    };
    spectrum(r.spectral);
    for (SpectralEstimate& cause : r.spectral_cause) spectrum(cause);
    spectrum(r.apparent_spectral);

    const auto bounds = pass.bounds(row);
    r.truncation_bound_w_sr = bounds.truncation;
    r.quadrature_bound_w_sr = bounds.quadrature;
    r.numerical_error_w_sr =
        numerical_error(r.intensity_w_sr.stderr_, bounds.truncation + bounds.quadrature);
    // The air is taken at the range of the reference point; the target's own depth is the error of
    // that.
    const double depth = std::expm1(
        extinction_per_m(request.air, request.condition[r.condition].air_temperature_k) * reach);
    r.apparent_numerical_error_w_sr = numerical_error(
        r.apparent_intensity_w_sr.stderr_,
        bounds.truncation + bounds.quadrature + depth * std::abs(r.apparent_intensity_w_sr.value));
    if (r.projected_area_m2.value > 0)
      r.apparent_temperature_k = apparent_temperature_k(
          band_[r.band], grid, r.intensity_w_sr.value / r.projected_area_m2.value);
    if (accuracy.relative_error <= 0)
      r.stop_reason = StopReason::kFixedSamples;
    else if (r.numerical_error_w_sr <= accuracy.relative_error * std::abs(r.intensity_w_sr.value))
      r.stop_reason = StopReason::kTargetReached;
    else
      r.stop_reason = limited ? StopReason::kSampleLimit : StopReason::kTargetMissed;
    if (!plan.empty()) {
      const double scale = 1.0 / (accuracy.replicates * pixel_area_m2 * plane_scale);
      const std::size_t pixels = static_cast<std::size_t>(plan.width_px) * plan.height_px;
      for (std::size_t i = 0; i < pixels; ++i)
        r.image_w_m2_sr.push_back(static_cast<float>(scale * pass.image()[i * plan.padded + row]));
    }
  }
  return out;
}

}  // namespace irsig
