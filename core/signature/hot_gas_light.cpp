#include "core/signature/hot_gas_light.h"

#include <cmath>
#include <optional>
#include <utility>

#include "core/base/status_macros.h"
#include "core/signature/add_estimates.h"
#include "core/signature/gas_rows.h"

namespace irsig {
namespace {

void add_gas_change(const GasRow::Change& change, double omitted_w_sr, Measured& to) {
  to.value += change.in_band.value;
  to.stderr_ = std::hypot(to.stderr_, change.in_band.stderr_);
  to.of(BoundOf::kPlume) += change.bound_w_sr;
  to.of(BoundOf::kOmitted) += omitted_w_sr;
}

void add_pixels(const PixelSums& more, PixelSums& to) {
  for (std::size_t i = 0; i < more.w_sr.size(); ++i) {
    to.w_sr[i] += more.w_sr[i];
    to.variance[i] += more.variance[i];
  }
}

// Adds the variance of an error that is a fraction of each pixel's light.
void add_relative(const PixelSums& light, double relative, PixelSums& to) {
  for (std::size_t i = 0; i < light.w_sr.size(); ++i)
    to.variance[i] += std::pow(relative * light.w_sr[i], 2);
}

class HotGasLight final : public LightComponent {
 public:
  explicit HotGasLight(std::vector<std::optional<GasRow>> row) : row_(std::move(row)) {}

  void add_to(std::size_t row, MeasuredIntensities& to) const override {
    if (!row_[row]) return;
    const GasRow& gas = *row_[row];
    add_gas_change(gas.source, gas.omitted.source, to.source);
    add_gas_change(gas.apparent, gas.omitted.apparent, to.apparent);
    add_gas_change(gas.contrast, gas.omitted.contrast, to.contrast);
  }

  void add_to(std::size_t row, SignatureResult& r) const override {
    if (!row_[row]) return;
    const GasRow& gas = *row_[row];
    r.has_plume = true;
    r.plume_w_sr = gas.source.in_band;
    r.apparent_plume_w_sr = gas.apparent.in_band;
    r.contrast_plume_w_sr = gas.contrast.in_band;
    r.plume_emitted_w_sr = gas.emitted_w_sr;
    r.apparent_plume_emitted_w_sr = gas.apparent_emitted_w_sr;
    r.plume_bound_w_sr = gas.source.bound_w_sr;
    r.apparent_plume_bound_w_sr = gas.apparent.bound_w_sr;
    r.contrast_plume_bound_w_sr = gas.contrast.bound_w_sr;
    r.plume_model_error_w_sr = gas.model_error_w_sr;
    r.plume_reflected_w_sr = gas.on_hull;
    r.apparent_plume_reflected_w_sr = gas.apparent_on_hull;
    r.effect.insert(r.effect.end(), gas.ledger.begin(), gas.ledger.end());
    r.plume_voxel_error_w_sr = gas.voxel_error_w_sr;
    r.plume_area_m2 = gas.area_m2;
    r.plume_spectral = gas.source.spectral;
    r.apparent_plume_spectral = gas.apparent.spectral;
    r.contrast_plume_spectral = gas.contrast.spectral;
    add(gas.source.in_band, r.intensity_w_sr);
    add(gas.apparent.in_band, r.apparent_intensity_w_sr);
    add(gas.contrast.in_band, r.contrast_intensity_w_sr);
    add(gas.source.spectral, r.spectral);
    add(gas.apparent.spectral, r.apparent_spectral);
    add(gas.contrast.spectral, r.contrast_spectral);
    r.model_error_w_sr =
        std::hypot(r.model_error_w_sr, gas.source_model_error_w_sr, gas.voxel_error_w_sr);
    for (double* model : {&r.apparent_model_error_w_sr, &r.contrast_model_error_w_sr})
      *model = std::hypot(*model, gas.model_error_w_sr, gas.apparent_voxel_error_w_sr);
    for (std::size_t k = 0; k < r.replicate_w_sr.size(); ++k) {
      r.replicate_w_sr[k] += gas.source.replicate[k];
      r.replicate_apparent_w_sr[k] += gas.apparent.replicate[k];
      r.replicate_contrast_w_sr[k] += gas.contrast.replicate[k];
    }
  }

  void add_picture(std::size_t row, PictureOf of, PixelSums& to) const override {
    if (!row_[row]) return;
    const GasPicture& own = picture(row, of);
    add_pixels(own.change, to);
    add_relative(own.emitted, own.emitted_relative, to);
    add_relative(own.absorbed, own.absorbed_relative, to);
  }

  void add_layer(std::size_t row, PictureOf of, ImageLayer layer, PixelSums& to) const override {
    if (!row_[row] || !is_of_gas(layer)) return;
    const GasPicture& own = picture(row, of);
    const bool emitted = layer == ImageLayer::kGasEmitted;
    const PixelSums& light = emitted ? own.emitted : own.absorbed;
    add_pixels(light, to);
    add_relative(light, emitted ? own.emitted_relative : own.absorbed_relative, to);
  }

  [[nodiscard]] std::uint64_t rays(std::size_t row) const override {
    return row_[row] ? row_[row]->rays : 0;
  }

 private:
  [[nodiscard]] const GasPicture& picture(std::size_t row, PictureOf of) const {
    return of == PictureOf::kTarget ? row_[row]->picture : row_[row]->apparent_picture;
  }

  std::vector<std::optional<GasRow>> row_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<const LightComponent>> measure_hot_gas(
    const PreparedScene& scene, const ViewRequest& request, const ViewPlan& plan,
    const std::shared_ptr<const PreparedView>& view, const PictureFrame& pictures) {
  ASSIGN_OR_RETURN(auto rows, gas_rows(scene, request, plan, view, pictures));
  if (rows.empty()) return nullptr;
  return std::make_unique<const HotGasLight>(std::move(rows));
}

}  // namespace irsig
