#include "core/signature/row_pictures.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/status_macros.h"
#include "core/signature/view/picture_window.h"
#include "core/signature/view/pixel_background.h"
#include "core/signature/view/pixel_errors.h"
#include "core/signature/view_seed.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

// Rays of each of 64 x 64 pixels of a part of the target beside the frame.
constexpr std::uint32_t kStripSamples = 4;
constexpr std::uint8_t kHiddenKind = kCauses;  // light behind the target, taken off

struct ViewPictures {
  ImagePlan plan;
  std::uint32_t pixel_samples = 0;
  TracedPictures traced;
  PathCounts counts;
};

// Only the window is traced: beside it is no target. Picture k is row k at the target; with
// at_sensor, picture rows + k is the same at the sensor, less what it hides.
class RowPictures {
 public:
  RowPictures(const MeasuredView& view, const ViewRequest& request, const PictureFrame& frame,
              const LightComponents& components)
      : view_(view),
        request_(request),
        frame_(frame),
        components_(components),
        pixels_(std::size_t{frame.width_px} * frame.height_px),
        rows_(view.row.size()),
        window_(view.setup.aimed().frame, frame, request.image ? request.image->samples : 0) {
    const double pixel_m = frame.rectangle.width_m / frame.width_px;
    const double range_m2 = std::pow(request.viewpoint.range_m / frame.plane_m * pixel_m, 2);
    for (std::uint32_t row = 0; row < frame.height_px; ++row)
      for (std::uint32_t column = 0; column < frame.width_px; ++column) {
        const double x_m = frame.rectangle.x0_m + (column + 0.5) * pixel_m,
                     y_m = frame.rectangle.y0_m + (frame.height_px - row - 0.5) * pixel_m;
        per_w_sr_.push_back(
            std::pow(1 + (x_m * x_m + y_m * y_m) / (frame.plane_m * frame.plane_m), 1.5) /
            range_m2);
      }
  }

  absl::Status write(ViewResult& out) {
    trace();
    out.image_width_px = frame_.width_px;
    out.image_height_px = frame_.height_px;
    out.pixel_rad = frame_.rectangle.width_m / frame_.width_px / frame_.plane_m;
    std::optional<PixelBackground> background;
    if (at_sensor() || has_land_layer()) {
      ASSIGN_OR_RETURN(background,
                       PixelBackground::make(view_.setup.scene, request_, view_.setup.plan.effects,
                                             view_.setup.aimed().frame, frame_));
    }
    const PixelErrors errors = pixel_errors();
    for (std::size_t row = 0; row < rows_; ++row) {
      SignatureResult& r = out.row[row];
      PixelSums sum = sums(row);
      const PixelSums own = sum;
      for (const auto& component : components_)
        component->add_picture(row, PictureOf::kTarget, sum);
      const std::vector<double> stderr_w_sr = errors.of(sum);
      r.image_w_m2_sr.reserve(pixels_);
      r.image_stderr_w_m2_sr.reserve(pixels_);
      for (std::size_t i = 0; i < pixels_; ++i) {
        r.image_w_m2_sr.push_back(static_cast<float>(per_w_sr_[i] * sum.w_sr[i]));
        r.image_stderr_w_m2_sr.push_back(static_cast<float>(per_w_sr_[i] * stderr_w_sr[i]));
      }
      // Accuracy is asked of the target's own paths: others have a number of their own.
      const bool asked = request_.image && request_.image->asks_for_error();
      const TypicalError typical = asked ? typical_error(row, own.w_sr, errors.of(own))
                                         : typical_error(row, sum.w_sr, stderr_w_sr);
      r.image_error_relative = typical.relative;
      r.image_error_k = typical.kelvin;
      add_layers(row, errors, background ? &*background : nullptr, r);
    }
    out.rays += pictures_.counts.rays;
    // Numbers that should not occur are reported wherever they occur.
    out.guarded_nonfinite += pictures_.counts.guarded_nonfinite;
    out.guarded_negative += pictures_.counts.guarded_negative;
    out.pixel_samples = pictures_.pixel_samples;
    out.seen = std::move(met_);
    if (request_.image && request_.image->whole_parts) add_part_sets(out);
    return absl::OkStatus();
  }

 private:
  [[nodiscard]] bool has(ImageLayer layer) const {
    return request_.image && request_.image->has(layer);
  }
  [[nodiscard]] bool has_land_layer() const {
    return request_.image && std::ranges::any_of(request_.image->layer, is_of_land);
  }
  [[nodiscard]] bool at_sensor() const { return has(ImageLayer::kAtSensor); }

  [[nodiscard]] ImagePlan plan() const {
    const ViewSetup& setup = view_.setup;
    const SourceLayout paths(setup.parts(), setup.sources.geometry());
    const SpectralBasis* basis = setup.scene.path_basis();
    ImagePlan plan = blank_pictures(window_.traced(), setup.aimed().frame,
                                    at_sensor() ? 2 * rows_ : rows_, 1, paths, basis);
    if (plan.empty()) return plan;
    for (std::size_t k = 0; k < rows_; ++k) {
      const Row& row = view_.row[k];
      const SourceTable& table = row.in_band;
      show_sources(table, table.source, *row.light, paths, basis, k, 0, plan);
      if (!at_sensor()) continue;
      show_sources(table, table.apparent, *row.light, paths, basis, rows_ + k, 0, plan);
      hide_background(table, *row.light, paths, basis, rows_ + k, plan);
    }
    if (!request_.image) return plan;
    plan.whole_parts = request_.image->whole_parts;
    if (std::any_of(request_.image->layer.begin(), request_.image->layer.end(), [](ImageLayer l) {
          return l <= ImageLayer::kParts || l == ImageLayer::kHidden ||
                 l == ImageLayer::kWithoutAir;
        }))
      keep_causes_apart(paths, plan);
    plan.first_hits =
        std::any_of(request_.image->layer.begin(), request_.image->layer.end(), is_mean_of_target);
    if (has(ImageLayer::kTemperature)) show_temperatures(paths.emitters(), plan);
    plan.normals =
        has(ImageLayer::kNormalX) || has(ImageLayer::kNormalY) || has(ImageLayer::kNormalZ);
    if (has(ImageLayer::kSunlit))
      for (const std::uint32_t c : view_.setup.keys.condition)
        if (const auto sun = towards_sun(request_.condition[c]);
            sun && place_of(*sun, plan) == plan.towards_sun.size())
          plan.towards_sun.push_back(*sun);
    return plan;
  }

  // Towards the middle of the sun's disk; absent while that is below the horizon, and without a
  // sun.
  static std::optional<Vec<Body>> towards_sun(const ConditionSpec& condition) {
    const bool up = sun_shines(condition) && condition.sun_direction.z < condition.sun_horizon_z;
    return up ? std::optional(condition.sun_direction) : std::nullopt;
  }
  static std::size_t place_of(const Vec<Body>& sun, const ImagePlan& plan) {
    return static_cast<std::size_t>(
        std::find(plan.towards_sun.begin(), plan.towards_sun.end(), sun) -
        plan.towards_sun.begin());
  }

  void keep_causes_apart(const SourceLayout& paths, ImagePlan& plan) const {
    plan.kinds = kCauses + 1;
    plan.kind.assign(paths.count(), kHiddenKind);
    std::vector<std::uint32_t> suns(paths.suns());
    for (std::uint32_t j = 0; j < suns.size(); ++j) suns[j] = j;
    const auto causes = paths.causes(suns);
    for (std::uint8_t c = 0; c < kCauses; ++c)
      for (const SourceRange& piece : causes[c])
        for (const SourceId id : piece) plan.kind[index_of(id)] = c;
  }

  void show_temperatures(std::uint32_t emitters, ImagePlan& plan) const {
    const std::vector<std::uint32_t>& conditions = view_.setup.keys.condition;
    plan.values = conditions.size();
    for (std::uint32_t e = 0; e < emitters; ++e)
      for (const std::uint32_t c : conditions) {
        const ConditionSpec& condition = request_.condition[c];
        float kelvin = condition.emitter != nullptr ? condition.emitter->kelvin[e] : NAN;
        if (std::isnan(kelvin))
          kelvin = static_cast<float>(
              condition.part_temperature_k[view_.setup.sources.geometry().emitters.part_of(e)]);
        plan.of_emitter.push_back(kelvin);
      }
  }

  void trace() {
    pictures_.plan = plan();
    pictures_.pixel_samples = kPixelSamples;
    if (pictures_.plan.empty()) return;
    const ViewSetup& setup = view_.setup;
    const PathSettings of_view =
        path_settings(setup.accuracy, setup.plan.effects, setup.seed + kPictureStage, 1);
    std::uint32_t samples = 0;
    if (request_.image)
      samples = request_.image->samples > 0 ? request_.image->samples : kPixelSamples;
    for (;;) {
      const PathSettings settings = picture_settings(of_view, pictures_.plan, samples);
      TracedView traced = trace_view(setup.scene, whole_view(setup.aimed()),
                                     setup.sources.geometry(), settings, pictures_.plan);
      samples = pictures_.pixel_samples = settings.pixel_samples;
      pictures_.traced =
          window_.joined(std::move(traced.pictures), pictures_.plan, pictures_.pixel_samples);
      met_ = std::move(pictures_.traced.met);
      for (TracedPictures::Met& met : met_) met.pixel = window_.whole_of(met.pixel);
      pictures_.counts.rays += traced.counts.rays;
      pictures_.counts.guarded_nonfinite += traced.counts.guarded_nonfinite;
      pictures_.counts.guarded_negative += traced.counts.guarded_negative;
      if (!request_.image || !request_.image->asks_for_error()) return;
      const double over = error_over_goal();
      const std::uint32_t most = request_.image->most_samples;
      if (!(over > 1) || std::uint64_t{samples} * window_.squares() >= most) return;
      // The count grows by no more than what costs a third again if it is still too few: errors of
      // few samples are themselves uncertain, and fall faster on edges.
      const double wanted = std::min(
          {samples * over * over, 4.0 * samples, static_cast<double>(most) / window_.squares()});
      while (samples < wanted) samples *= 2;
    }
  }

  [[nodiscard]] PixelErrors pixel_errors() const {
    return PixelErrors(frame_.width_px, frame_.height_px, pictures_.pixel_samples, met_);
  }

  [[nodiscard]] PixelSums nothing() const {
    return {std::vector<double>(pixels_, 0.0), std::vector<double>(pixels_, 0.0)};
  }

  [[nodiscard]] PixelSums sums(std::size_t picture) const {
    PixelSums out = nothing();
    for (std::size_t t = 0; t < window_.pixels(); ++t) {
      const std::size_t at = t * pictures_.plan.images + picture, i = window_.whole_of(t);
      out.w_sr[i] = pictures_.traced.sum[at];
      out.variance[i] = std::pow(static_cast<double>(pictures_.traced.stderr_[at]), 2);
    }
    return out;
  }

  // Standard errors of one kind of light in a picture, [pixel]. [W/(m2 sr)]
  [[nodiscard]] std::vector<float> kind_errors(std::size_t picture, std::size_t kind,
                                               const PixelErrors& errors) const {
    PixelSums sum = nothing();
    for (std::size_t t = 0; t < window_.pixels(); ++t) {
      const std::size_t at = (t * pictures_.plan.images + picture) * pictures_.plan.kinds + kind,
                        i = window_.whole_of(t);
      sum.w_sr[i] = static_cast<double>(pictures_.traced.kind_sum[at]);
      sum.variance[i] = std::pow(static_cast<double>(pictures_.traced.kind_stderr[at]), 2);
    }
    const std::vector<double> stderr_w_sr = errors.of(sum);
    std::vector<float> out;
    for (std::size_t i = 0; i < pixels_; ++i)
      out.push_back(static_cast<float>(per_w_sr_[i] * stderr_w_sr[i]));
    return out;
  }

  // The largest of all rows' errors, in units of what is asked for.
  [[nodiscard]] double error_over_goal() const {
    const PixelErrors errors = pixel_errors();
    const ImageSpec& image = *request_.image;
    double most = 0;
    for (std::size_t row = 0; row < rows_; ++row) {
      const PixelSums sum = sums(row);
      const TypicalError error = typical_error(row, sum.w_sr, errors.of(sum));
      if (image.relative_error > 0) most = std::max(most, error.relative / image.relative_error);
      if (image.error_k > 0) most = std::max(most, error.kelvin / image.error_k);
    }
    return most;
  }

  // Root mean squares over the pixels that the target fills; without such pixels, of their sum.
  struct TypicalError {
    double relative = 0, kelvin = 0;
  };
  [[nodiscard]] TypicalError typical_error(std::size_t row, const std::vector<double>& w_sr,
                                           const std::vector<double>& stderr_w_sr) const {
    std::vector<std::uint32_t> met(pixels_, 0);
    for (const TracedPictures::Met& m : met_) met[m.pixel] += m.samples;
    double filled = 0, squares = 0, relative = 0, radiance = 0, all_w_sr = 0, all_squares = 0,
           shown = 0;
    for (std::size_t i = 0; i < pixels_; ++i) {
      shown += static_cast<double>(met[i]) / pictures_.pixel_samples;
      all_w_sr += w_sr[i];
      all_squares += stderr_w_sr[i] * stderr_w_sr[i];
      if (met[i] < pictures_.pixel_samples || !(w_sr[i] > 0)) continue;
      ++filled;
      radiance += per_w_sr_[i] * w_sr[i];
      squares += std::pow(per_w_sr_[i] * stderr_w_sr[i], 2);
      relative += std::pow(stderr_w_sr[i] / w_sr[i], 2);
    }
    if (!(all_w_sr > 0)) return {};
    TypicalError out;
    double error = 0;
    if (filled > 0) {
      out.relative = std::sqrt(relative / filled);
      error = std::sqrt(squares / filled);
      radiance /= filled;
    } else {
      out.relative = std::sqrt(all_squares) / all_w_sr;
      radiance = shown > 0 ? per_w_sr_.front() * all_w_sr / shown : 0;
      error = out.relative * radiance;
    }
    const double per_k = change_per_k(row, radiance);
    if (per_k > 0) out.kelvin = error / per_k;
    return out;
  }

  // Returns the change of the in-band radiance of a blackbody that is as bright. [W/(m2 sr K)]
  [[nodiscard]] double change_per_k(std::size_t row, double radiance_w_m2_sr) const {
    const Row& of = view_.row[row];
    const BandGrid& grid = of.on_axis.grid;
    const double kelvin =
        radiance_temperature_k(view_.setup.scene.band[of.band], grid, radiance_w_m2_sr);
    if (!(kelvin > 1)) return 0;
    constexpr double kHalf = 0.05;
    double change = 0;
    for (std::size_t i = 0; i < grid.node_um.size(); ++i)
      change += grid.band_weight[i] * (planck_radiance_w_m2_sr_um(grid.node_um[i], kelvin + kHalf) -
                                       planck_radiance_w_m2_sr_um(grid.node_um[i], kelvin - kHalf));
    return change / (2 * kHalf);
  }

  // Those of the frame, and what its border cuts off.
  void add_part_sets(ViewResult& out) {
    std::map<std::vector<std::uint32_t>, ViewResult::PartSet> of;
    const TracedPictures& traced = pictures_.traced;
    for (const TracedPictures::Met& met : traced.met_set)
      of[traced.part_set[met.part]].pixel.push_back({window_.whole_of(met.pixel), 0, met.samples});
    const double pixel_m = frame_.rectangle.width_m / frame_.width_px;
    std::uint64_t strips = 0;
    for (const PlaneRectangle& strip : outside(view_.setup.aimed().frame, frame_.rectangle)) {
      constexpr std::uint32_t kSide = 64;
      const PictureFrame there{strip, frame_.plane_m, kSide, kSide};
      const TracedPictures cut_off = traced_parts(there, ++strips, out.rays);
      const double ray_px = strip.width_m * strip.height_m /
                            (std::uint64_t{kSide} * kSide * kStripSamples) / (pixel_m * pixel_m);
      for (const TracedPictures::Met& met : cut_off.met_set)
        of[cut_off.part_set[met.part]].outside_px += met.samples * ray_px;
    }
    for (auto& [parts, set] : of) {
      set.part = parts;
      out.part_set.push_back(std::move(set));
    }
  }

  // Returns the part of a rectangle beside another, as rectangles.
  static std::vector<PlaneRectangle> outside(const PlaneRectangle& of,
                                             const PlaneRectangle& frame) {
    std::vector<PlaneRectangle> out;
    // Less is rounding.
    const double least_m = 1e-9 * std::max(of.width_m, of.height_m);
    const auto add = [&](double x0_m, double x1_m, double y0_m, double y1_m) {
      if (x1_m - x0_m > least_m && y1_m - y0_m > least_m)
        out.push_back({x0_m, y0_m, x1_m - x0_m, y1_m - y0_m});
    };
    const double x1_m = of.x0_m + of.width_m, y1_m = of.y0_m + of.height_m,
                 right_m = frame.x0_m + frame.width_m, top_m = frame.y0_m + frame.height_m;
    const double from_m = std::max(of.x0_m, frame.x0_m), to_m = std::min(x1_m, right_m);
    add(of.x0_m, std::min(x1_m, frame.x0_m), of.y0_m, y1_m);
    add(std::max(of.x0_m, right_m), x1_m, of.y0_m, y1_m);
    add(from_m, to_m, of.y0_m, std::min(y1_m, frame.y0_m));
    add(from_m, to_m, std::max(of.y0_m, top_m), y1_m);
    return out;
  }

  // The parts that rays meet in a frame, without light.
  TracedPictures traced_parts(const PictureFrame& frame, std::uint64_t seed, std::uint64_t& rays) {
    const ViewSetup& setup = view_.setup;
    const SourceLayout paths(setup.parts(), setup.sources.geometry());
    ImagePlan plan =
        blank_pictures(frame, setup.aimed().frame, 1, 1, paths, setup.scene.path_basis());
    plan.whole_parts = true;
    PathSettings settings =
        picture_settings(path_settings(setup.accuracy, setup.plan.effects,
                                       setup.seed + kPictureStage + (seed << 32), 1),
                         plan, kStripSamples);
    settings.max_reflections = 0;
    TracedView traced = trace_view(setup.scene, whole_view(setup.aimed()), setup.sources.geometry(),
                                   settings, plan);
    rays += traced.counts.rays;
    return std::move(traced.pictures);
  }

  void add_layers(std::size_t row, const PixelErrors& errors, const PixelBackground* background,
                  SignatureResult& r) const {
    if (!request_.image) return;
    const Row& of = view_.row[row];
    const std::size_t picture = at_sensor() ? rows_ + row : row;
    const double path = in_band(of.light->environment().path_radiance, of.on_axis);
    PixelBackground::Radiance beside;
    if (at_sensor()) beside = background->of(of);
    std::vector<std::uint32_t> met(pixels_, 0);
    for (const TracedPictures::Met& m : met_) met[m.pixel] += m.samples;
    const auto kind_in = [&](std::size_t shown, std::size_t pixel, std::size_t which) {
      const auto traced = window_.pixel_of(pixel);
      if (!traced) return 0.0;
      const std::size_t at = *traced * pictures_.plan.images + shown;
      return per_w_sr_[pixel] *
             static_cast<double>(pictures_.traced.kind_sum[at * pictures_.plan.kinds + which]);
    };
    const auto kind = [&](std::size_t pixel, std::size_t which) {
      return kind_in(picture, pixel, which);
    };
    LandBackground::Parts land;
    if (std::ranges::any_of(request_.image->layer,
                            [](ImageLayer l) { return is_of_land(l) && is_radiance(l); }))
      land = background->land_parts_of(of);
    const auto beside_target = [&](std::size_t i) {
      return 1 - static_cast<double>(met[i]) / pictures_.pixel_samples;
    };
    const auto first = [&](std::size_t pixel, std::size_t which) {
      if (met[pixel] == 0) return 0.0;
      const std::size_t at = *window_.pixel_of(pixel) * pictures_.plan.first_numbers() + which;
      return pictures_.traced.first_sum[at] / met[pixel];
    };
    const std::size_t condition = row / view_.setup.keys.band.size();
    for (const ImageLayer layer : request_.image->layer) {
      LayerImage& image = r.layer.emplace_back();
      image.layer = layer;
      image.value.reserve(pixels_);
      const auto fill = [&](const auto& value) {
        for (std::size_t i = 0; i < pixels_; ++i)
          image.value.push_back(static_cast<float>(value(i)));
      };
      switch (layer) {
        case ImageLayer::kEmitted:
        case ImageLayer::kSun:
        case ImageLayer::kSky:
        case ImageLayer::kSurface:
        case ImageLayer::kParts:
          fill([&](std::size_t i) { return kind(i, static_cast<std::size_t>(layer)); });
          image.stderr_ = kind_errors(picture, static_cast<std::size_t>(layer), errors);
          break;
        case ImageLayer::kPath:
          fill([&](std::size_t) { return path; });
          break;
        case ImageLayer::kBackground:
          fill([&](std::size_t i) { return beside.w_m2_sr[i]; });
          break;
        case ImageLayer::kHidden:
          fill([&](std::size_t i) { return -kind(i, kHiddenKind); });
          image.stderr_ = kind_errors(picture, kHiddenKind, errors);
          break;
        case ImageLayer::kGasEmitted:
        case ImageLayer::kGasAbsorbed: {
          PixelSums sum = nothing();
          for (const auto& component : components_)
            component->add_layer(row, at_sensor() ? PictureOf::kAtSensor : PictureOf::kTarget,
                                 layer, sum);
          fill([&](std::size_t i) { return per_w_sr_[i] * sum.w_sr[i]; });
          const std::vector<double> stderr_w_sr = errors.of(sum);
          for (std::size_t i = 0; i < pixels_; ++i)
            image.stderr_.push_back(static_cast<float>(per_w_sr_[i] * stderr_w_sr[i]));
          break;
        }
        case ImageLayer::kAtSensor: {
          PixelSums sum = sums(picture);
          for (const auto& component : components_)
            component->add_picture(row, PictureOf::kAtSensor, sum);
          const std::vector<double> stderr_w_sr = errors.of(sum);
          fill(
              [&](std::size_t i) { return path + beside.w_m2_sr[i] + per_w_sr_[i] * sum.w_sr[i]; });
          // Sums of float32 numbers, of which much cancels; and the number that is stored.
          constexpr double kRounding = 5e-7, kStored = 6e-8;
          for (std::size_t i = 0; i < pixels_; ++i) {
            const double filled = static_cast<double>(met[i]) / pictures_.pixel_samples,
                         rounding = std::hypot(kRounding * filled, kStored) *
                                    static_cast<double>(image.value[i]);
            image.stderr_.push_back(static_cast<float>(
                std::hypot(per_w_sr_[i] * stderr_w_sr[i], beside.bound_w_m2_sr[i], rounding)));
          }
          break;
        }
        case ImageLayer::kLandEmitted:
          fill([&](std::size_t i) { return beside_target(i) * land.emitted[i]; });
          break;
        case ImageLayer::kLandSky:
          fill([&](std::size_t i) { return beside_target(i) * land.sky[i]; });
          break;
        case ImageLayer::kLandSun:
          fill([&](std::size_t i) { return beside_target(i) * land.sun[i]; });
          break;
        case ImageLayer::kWithoutAir:
          // Sky is seen through the air to the target.
          fill([&](std::size_t i) {
            return kind_in(row, i, static_cast<std::size_t>(ImageLayer::kEmitted)) +
                   beside_target(i) * (land.without_air[i] + land.beyond[i] * path);
          });
          break;
        case ImageLayer::kTemperature:
          fill([&](std::size_t i) { return first(i, 1 + condition); });
          break;
        case ImageLayer::kLandTemperature: {
          const std::vector<double> kelvin =
              background->land_temperature_k(request_.condition[of.condition].land_temperature_k);
          fill([&](std::size_t i) { return kelvin[i]; });
          break;
        }
        case ImageLayer::kRange:
          fill([&](std::size_t i) { return first(i, 0); });
          break;
        case ImageLayer::kNormalX:
        case ImageLayer::kNormalY:
        case ImageLayer::kNormalZ: {
          const auto axis =
              static_cast<std::size_t>(layer) - static_cast<std::size_t>(ImageLayer::kNormalX);
          fill([&](std::size_t i) { return first(i, 1 + pictures_.plan.values + axis); });
          break;
        }
        case ImageLayer::kSunlit: {
          const auto sun = towards_sun(request_.condition[of.condition]);
          const std::size_t suns = pictures_.plan.towards_sun.size(),
                            first_sun = pictures_.plan.first_numbers() - suns;
          fill([&](std::size_t i) {
            return sun ? first(i, first_sun + place_of(*sun, pictures_.plan)) : 0.0;
          });
          break;
        }
      }
    }
  }

  const MeasuredView& view_;
  const ViewRequest& request_;
  const PictureFrame& frame_;
  const LightComponents& components_;
  std::size_t pixels_, rows_;
  PictureWindow window_;
  // [pixel] Radiance for each W/sr that it sends: the inverse of its solid angle times range^2.
  std::vector<double> per_w_sr_;
  ViewPictures pictures_;
  std::vector<TracedPictures::Met> met_;  // by pixel of the whole picture
};

}  // namespace

absl::Status add_pictures(const MeasuredView& view, const ViewRequest& request,
                          const PictureFrame& frame, const LightComponents& components,
                          ViewResult& out) {
  if (frame.width_px == 0) return absl::OkStatus();
  return RowPictures(view, request, frame, components).write(out);
}

}  // namespace irsig
