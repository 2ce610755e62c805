#pragma once

#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/accuracy/replicates.h"
#include "core/effects/plan.h"
#include "core/signature/view/pixel_errors.h"
#include "core/signature/view/prepared_scene.h"
#include "core/signature/view/prepared_view.h"
#include "core/signature/view/request.h"
#include "core/signature/view/result.h"
#include "core/signature/view/view_pictures.h"

namespace irsig {

// Pictures of one row's hot gas, [pixel of the frame], of radiance at the target or at the sensor.
// Empty: no pictures, or no gas in sight.
struct GasPicture {
  PixelSums change;             // emitted less absorbed
  PixelSums emitted, absorbed;  // empty unless images have layers
  // Errors of single pixels beside their scatter, as fractions of what is emitted and absorbed: of
  // test gases that stand for a ray's spectrum, and of classes that stand for its absorption.
  double emitted_relative = 0, absorbed_relative = 0;
};

// Change of one row by hot gas: its emission less its absorption of the light from behind.
struct GasRow {
  struct Change {
    Estimate in_band;  // [W/sr]
    double bound_w_sr = 0;
    SpectralEstimate spectral;      // on the band's stored wavelengths [W/(sr um)]
    std::vector<double> replicate;  // [W/sr]
  };
  // Changes at the target; at the sensor: of the target behind the gas, and of the background
  // behind both.
  Change source, apparent, contrast;
  double emitted_w_sr = 0, apparent_emitted_w_sr = 0;  // sent alone
  // The part reflected by the target, net of the light that the gas absorbs.
  Estimate on_hull, apparent_on_hull;  // [W/sr]
  // Error of `apparent` if cold and hot lines were taken as independent. [W/sr]
  double lines_w_sr = 0;
  // Effects of hot gas (core/effects), and what of them is left out.
  std::vector<LedgerEntry> ledger;
  RowBounds::Bound omitted;
  double source_model_error_w_sr = 0;  // one sigma, of `source`
  double model_error_w_sr = 0;         // of `apparent` and `contrast`
  // One sigma of what the gas's lattice cannot say: of the source; at the sensor.
  double voxel_error_w_sr = 0, apparent_voxel_error_w_sr = 0;
  Estimate area_m2;  // where it is thick (ViewRequest::plume_area_optical_depth)
  std::uint64_t rays = 0;
  // At the target, of what the target sends; at the sensor (images with the layer kAtSensor), of
  // the target and of what stands behind both.
  GasPicture picture, apparent_picture;
};

// Rows of the request's selected conditions x bands, as MeasuredView has them; nullopt: no hot gas
// under that condition. Empty: under none.
//
// Rays of their own are aimed at the gas, and their paths go on to what is behind it; others are
// reflected by the target before they meet it. Independent of those of the target's own light, so
// that all add up with their errors. How many follows from how test gases scatter (core/hot_gas),
// not from what is selected. What the target reflects of the gas is left out where it fits into the
// room that the plan has for that. (docs/explanation/methods/plume.md)
//   view      with the light of the selected conditions
//   pictures  of the view; what the target reflects of the gas is not in them
// INVALID_ARGUMENT: gas at the sensor; gas that its tables have not; air whose amounts are not
// known (imported), since gas behind it is not a product of band means.
[[nodiscard]] absl::StatusOr<std::vector<std::optional<GasRow>>> gas_rows(
    const PreparedScene& scene, const ViewRequest& request, const ViewPlan& plan,
    std::shared_ptr<const PreparedView> view, const PictureFrame& pictures);

}  // namespace irsig
