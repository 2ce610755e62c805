// Pictures of hot gas: what a ray's gas emits and absorbs, in each pixel.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/ordered_dot.h"
#include "core/base/status_macros.h"
#include "core/signature/gas_measurement.h"

namespace irsig {
namespace {

// Kinds of light in the pictures of images with layers.
constexpr std::uint8_t kAbsorbedKind = 0, kEmittedKind = 1;

}  // namespace

absl::StatusOr<ImagePlan> GasMeasurement::plan_images(const std::vector<double>& sums) {
  const std::size_t bands = given_.request.selected_band.size(),
                    classes = columns_.class_here.size(),
                    images = source_images() * (at_sensor() ? 2 : 1);
  // At the sensor classes have two tables: of what is behind them of the target, and of the rest.
  ImagePlan plan =
      blank_pictures(given_.pictures, aimed_->frame, images, at_sensor() ? 2 * classes : classes,
                     layout_, given_.scene.path_basis());
  if (plan.empty()) return plan;
  plan.behind = at_sensor();
  plan.gas.assign(plan.images * gas_->measures(), 0.0);
  images_.emitted_relative.assign(images, 0.0);
  if (given_.request.image && !given_.request.image->layer.empty()) {
    plan.kinds = 2;
    plan.kind.assign(layout_.count(), kAbsorbedKind);
    plan.gas_kind = kEmittedKind;
  }
  using TwoSets = std::array<const std::vector<ColumnLight>*, 2>;
  const TwoSets here = {&columns_.nodes[0].here, &columns_.nodes[1].here};
  for (std::size_t c = 0; c < condition_.size(); ++c) {
    const ConditionSources& light = given_.sources.wanted(condition_[c]);
    std::optional<Sensor> sensor;
    if (at_sensor()) {
      ASSIGN_OR_RETURN(sensor, behind_air(c));
    }
    for (std::size_t b = 0; b < bands; ++b) {
      const std::uint32_t which = given_.request.selected_band[b];
      const BandOnAxis band = given_.scene.axis.band(which);
      const std::size_t image = c * bands + b, apparent = source_images() + image;
      show_emission(columns_.band_tests[which], sums, here, band, image, plan);
      for (std::size_t k = 0; k < classes; ++k)
        show_absorption(light, columns_.class_here[k], false, band, image, k, plan);
      if (!sensor) continue;
      const auto& lines = given_.request.effects.without(Effect::kHotLineCorrelation)
                              ? sensor->product
                              : sensor->nodes;
      const TwoSets behind = {&lines[0], &lines[1]};
      show_emission(tests_of(behind, which), sums, behind, band, apparent, plan);
      for (std::size_t k = 0; k < classes; ++k)
        show_absorption(light, sensor->classes[k], true, band, apparent, k, plan);
    }
  }
  return plan;
}

void GasMeasurement::show_emission(std::vector<double> tests, const std::vector<double>& sums,
                                   const std::array<const std::vector<ColumnLight>*, 2>& nodes,
                                   const BandOnAxis& band, std::size_t image, ImagePlan& plan) {
  if (const double all = ordered_dot(tests.data(), sums.data(), tests.size()); all > 0) {
    const double scale = sent_by(nodes, band).in_band / all;
    for (double& t : tests) t *= scale;
  }
  std::copy(tests.begin(), tests.end(),
            plan.gas.begin() + static_cast<std::ptrdiff_t>(image * gas_->measures()));
  // Error of single rays: the test gases' sums against the nodes' columns, which are real rays of
  // the view.
  double squares = 0, off = 0;
  for (std::size_t set = 0; set < columns_.nodes.size(); ++set)
    for (std::size_t m = 0; m < columns_.nodes[set].column.size(); ++m) {
      const double sent = in_band((*nodes[set])[m].emitted_w_m2_sr_um, band),
                   weight = mean_of(columns_.nodes[set].weight[m], band),
                   said =
                       ordered_dot(tests.data(), columns_.nodes[set].tests[m].data(), tests.size());
      squares += weight * sent * sent;
      off += weight * (said - sent) * (said - sent);
    }
  images_.emitted_relative[image] = squares > 0 ? std::sqrt(off / squares) : 0;
}

void GasMeasurement::show_absorption(const ConditionSources& light, const ColumnLight& gas,
                                     bool at_sensor, const BandOnAxis& band, std::size_t image,
                                     std::size_t of_class, ImagePlan& plan) const {
  std::vector<double> taken(band.grid.band_weight.size());
  for (std::size_t i = 0; i < taken.size(); ++i)
    taken[i] = -band.grid.band_weight[i] * gas.absorbed[band.first_node + i];
  const SpectralBasis* basis = given_.scene.path_basis();
  const SourceTable table = source_table(light, basis, band.first_node, taken);
  show_sources(table, at_sensor ? table.apparent : table.source, light, layout_, basis, image,
               of_class, plan);
  if (at_sensor)
    show_background(table, light, layout_, basis, image, columns_.class_here.size() + of_class,
                    plan);
}

GasPicture GasMeasurement::picture_of(std::size_t image, std::uint32_t band) const {
  const std::size_t pixels = images_.plan.pixels(), kinds = images_.plan.kinds;
  GasPicture out;
  const auto add = [](double w_sr, float stderr_w_sr, PixelSums& to) {
    to.w_sr.push_back(w_sr);
    to.variance.push_back(std::pow(static_cast<double>(stderr_w_sr), 2));
  };
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::size_t at = i * images_.plan.images + image;
    add(images_.traced.sum[at], images_.traced.stderr_[at], out.change);
    if (kinds == 1) continue;
    const std::size_t emitted = at * kinds + kEmittedKind, absorbed = at * kinds + kAbsorbedKind;
    add(static_cast<double>(images_.traced.kind_sum[emitted]), images_.traced.kind_stderr[emitted],
        out.emitted);
    add(-static_cast<double>(images_.traced.kind_sum[absorbed]),
        images_.traced.kind_stderr[absorbed], out.absorbed);
  }
  for (PixelSums* part : {&out.change, &out.emitted, &out.absorbed})
    if (!part->w_sr.empty())
      add_unmet(images_.plan.width_px, images_.plan.height_px, images_.pixel_samples, *part);
  out.emitted_relative = images_.emitted_relative[image];
  out.absorbed_relative = errors_.classes[band];
  return out;
}

}  // namespace irsig
