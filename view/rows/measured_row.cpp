#include "view/rows/measured_row.h"

#include <cmath>
#include <optional>

namespace irsig {
namespace {

using S = StoredSignature;

constexpr double kRounding = 1e-9;

Measured measured(const S& row, IntensityOf intensity, double value, double stderr_,
                  double numerical_error) {
  Measured out{value, stderr_, {}, 0};
  if (const double unseen = stored_undersampling_stderr(row, intensity); !std::isnan(unseen))
    out.undersampling_stderr = unseen;
  std::optional<BoundOf> lacking;
  for (std::size_t i = 0; i < kBounds; ++i) {
    const auto which = static_cast<BoundOf>(i);
    const double bound = stored_bound(row, intensity, which);
    if (!std::isnan(bound))
      out.of(which) = bound;
    else if (!lacking)
      lacking = which;
  }
  if (lacking) return with_rest(out, numerical_error, *lacking);
  // The error that a row states is never taken for less than it is.
  const bool told = numerical_error <= (1 + kRounding) * out.numerical_error();
  const BoundOf rest = intensity == IntensityOf::kSource ? BoundOf::kUnseen : BoundOf::kDepth;
  return told || std::isnan(numerical_error) ? out : with_rest(out, numerical_error, rest);
}

}  // namespace

double stored_bound(const S& row, IntensityOf intensity, BoundOf which) {
  const bool source = intensity == IntensityOf::kSource;
  switch (which) {
    case BoundOf::kTruncation:
      return row.truncation_bound_w_sr;
    case BoundOf::kQuadrature:  // stored with the basis in it
      return std::isnan(row.spectral_basis_bound_w_sr)
                 ? row.quadrature_bound_w_sr
                 : row.quadrature_bound_w_sr - row.spectral_basis_bound_w_sr;
    case BoundOf::kBasis:
      return row.spectral_basis_bound_w_sr;
    case BoundOf::kUnseen:
      return row.undersampling_bound_w_sr;
    case BoundOf::kSky:
      return row.direction_interpolation_bound_w_sr;
    case BoundOf::kOmitted:
      return source                                ? row.omitted_bound_w_sr
             : intensity == IntensityOf::kApparent ? row.apparent_omitted_bound_w_sr
                                                   : row.contrast_omitted_bound_w_sr;
    case BoundOf::kDepth:
      return source ? 0 : row.target_depth_bound_w_sr;
    case BoundOf::kBackground:
      return intensity == IntensityOf::kContrast ? row.background_bound_w_sr : 0;
    case BoundOf::kTemperature: {  // older rows had stated ones alone
      const double bound =
          source ? row.temperature_bound_w_sr : row.apparent_temperature_bound_w_sr;
      return std::isnan(bound) ? 0 : bound;
    }
    case BoundOf::kPlume: {  // rows without hot gas have none
      const double bound = source                                ? row.plume_bound_w_sr
                           : intensity == IntensityOf::kApparent ? row.apparent_plume_bound_w_sr
                                                                 : row.contrast_plume_bound_w_sr;
      return std::isnan(bound) ? 0 : bound;
    }
    case BoundOf::kMoved:
      return 0;
  }
  return kNotComputed;
}

double stored_undersampling_stderr(const S& row, IntensityOf intensity) {
  switch (intensity) {
    case IntensityOf::kSource:
      return row.undersampling_stderr_w_sr;
    case IntensityOf::kApparent:
      return row.apparent_undersampling_stderr_w_sr;
    case IntensityOf::kContrast:
      return row.contrast_undersampling_stderr_w_sr;
  }
  return kNotComputed;
}

Measured source_of(const S& row) {
  return measured(row, IntensityOf::kSource, row.intensity_w_sr, row.intensity_stderr_w_sr,
                  row.numerical_error_w_sr);
}

Measured apparent_of(const S& row) {
  return measured(row, IntensityOf::kApparent, row.apparent_intensity_w_sr,
                  row.apparent_intensity_stderr_w_sr, row.apparent_numerical_error_w_sr);
}

Measured contrast_of(const S& row) {
  return measured(row, IntensityOf::kContrast, row.contrast_intensity_w_sr,
                  row.contrast_intensity_stderr_w_sr, row.contrast_numerical_error_w_sr);
}

}  // namespace irsig
