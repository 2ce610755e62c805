#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/accuracy/image_layers.h"
#include "core/signature/measured_view.h"
#include "core/signature/view/pixel_errors.h"
#include "core/signature/view/view_pictures.h"

namespace irsig {

enum class PictureOf : std::uint8_t { kTarget, kAtSensor };

// LightComponent is light of a view that is measured by paths of its own, beside the light that the
// target sends and reflects (MeasuredView). Its random numbers are independent of all others, so
// that values add up, and standard errors in squares. Rows are those of MeasuredView::row.
class LightComponent {
 public:
  virtual ~LightComponent() = default;

  // Adds the component's values, errors and bounds to a row's intensities.
  virtual void add_to(std::size_t row, MeasuredIntensities& to) const = 0;
  // Adds what else a row stores of the component: spectra, causes, model errors, ledger,
  // replicates.
  virtual void add_to(std::size_t row, SignatureResult& to) const = 0;
  // Adds the component's picture of a row to that of the other light: of the target, or of all that
  // arrives at the sensor.
  virtual void add_picture(std::size_t row, PictureOf of, PixelSums& to) const = 0;
  // Adds the component's own light of one layer.
  virtual void add_layer(std::size_t row, PictureOf of, ImageLayer layer, PixelSums& to) const = 0;
  // Rays that a row's component took, pilots included.
  [[nodiscard]] virtual std::uint64_t rays(std::size_t row) const = 0;
};
using LightComponents = std::vector<std::unique_ptr<const LightComponent>>;

// Measures every component that the selected conditions of a request have. A new component is a
// line here.
//   view  with the light of the selected conditions
[[nodiscard]] absl::StatusOr<LightComponents> measure_components(
    const PreparedScene& scene, const ViewRequest& request, const ViewPlan& plan,
    const std::shared_ptr<const PreparedView>& view, const PictureFrame& pictures);

}  // namespace irsig
