#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/status_macros.h"
#include "view/query/interpolate_rows.h"
#include "view/query/query.h"

namespace irsig {
namespace {

using Values = google::protobuf::RepeatedField<float>;

bool all_have(const std::vector<schema::Spectrum>& from,
              const Values& (schema::Spectrum::*value)() const) {
  return std::all_of(from.begin(), from.end(),
                     [&](const schema::Spectrum& s) { return !(s.*value)().empty(); });
}

// Interpolates one pair of arrays of the spectra; arrays that some spectra do not have stay empty.
void interpolate_array(const SphereFit& fit, const std::vector<schema::Spectrum>& from,
                       const Values& (schema::Spectrum::*value)() const,
                       const Values& (schema::Spectrum::*value_stderr)() const, Values* out,
                       Values* out_stderr, std::vector<double>* error, FieldKind kind) {
  if (!all_have(from, value)) return;
  const int n = (from.front().*value)().size();
  std::vector<double> values(from.size()), stderrs(from.size());
  for (int k = 0; k < n; ++k) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      values[i] = (from[i].*value)().Get(k);
      stderrs[i] = value_stderr ? (from[i].*value_stderr)().Get(k) : 0.0;
    }
    const SphereEstimate e = estimate_of(kind, fit, values, stderrs);
    out->Add(static_cast<float>(e.value));
    if (out_stderr) out_stderr->Add(static_cast<float>(e.value_stderr));
    if (error) error->push_back(e.interpolation_error);
  }
}

bool same_axis(const schema::Spectrum& a, const schema::Spectrum& b) {
  return std::equal(a.lambda_um().begin(), a.lambda_um().end(), b.lambda_um().begin(),
                    b.lambda_um().end());
}

}  // namespace

absl::StatusOr<RowSpectrum> spectrum_of(StoreReader& reader, const QueryRow& row) {
  if (row.range_change) return RowSpectrum{*row.range_change->spectrum, {}};
  if (!row.interpolation) {
    ASSIGN_OR_RETURN(auto stored, reader.spectrum(row.signature.signature_id));
    return RowSpectrum{std::move(stored), {}};
  }
  std::vector<schema::Spectrum> from;
  for (const StoredSignature& s : row.interpolation->from) {
    ASSIGN_OR_RETURN(auto stored, reader.spectrum(s.signature_id));
    if (!from.empty() && !same_axis(stored, from.front())) {
      return absl::InternalError(
          fmt::format("rows {} and {} of one band have different wavelengths", s.row,
                      row.interpolation->from.front().row));
    }
    from.push_back(std::move(stored));
  }
  RowSpectrum out;
  *out.spectrum.mutable_lambda_um() = from.front().lambda_um();
  const SphereFit& fit = row.interpolation->fit;
#define IRSIG_INTERPOLATE(name, error)                            \
  interpolate_array(fit, from, &schema::Spectrum::name##_w_sr_um, \
                    &schema::Spectrum::name##_stderr_w_sr_um,     \
                    out.spectrum.mutable_##name##_w_sr_um(),      \
                    out.spectrum.mutable_##name##_stderr_w_sr_um(), error, FieldKind::kFacets)
  IRSIG_INTERPOLATE(spectral_intensity, &out.spectral_interpolation_error_w_sr_um);
  IRSIG_INTERPOLATE(emitted, nullptr);
  IRSIG_INTERPOLATE(sun_reflected, nullptr);
  IRSIG_INTERPOLATE(sky_reflected, nullptr);
  IRSIG_INTERPOLATE(surface_reflected, nullptr);
  IRSIG_INTERPOLATE(interreflected, nullptr);
  IRSIG_INTERPOLATE(apparent_spectral_intensity, nullptr);
#undef IRSIG_INTERPOLATE
  using Sp = schema::Spectrum;
  Sp& s = out.spectrum;
  interpolate_array(fit, from, &Sp::contrast_spectral_intensity_w_sr_um,
                    &Sp::contrast_spectral_intensity_stderr_w_sr_um,
                    s.mutable_contrast_spectral_intensity_w_sr_um(),
                    s.mutable_contrast_spectral_intensity_stderr_w_sr_um(), nullptr,
                    FieldKind::kSignedFacets);
  interpolate_array(fit, from, &Sp::background_radiance_w_m2_sr_um,
                    &Sp::background_radiance_stderr_w_m2_sr_um,
                    s.mutable_background_radiance_w_m2_sr_um(),
                    s.mutable_background_radiance_stderr_w_m2_sr_um(), nullptr, FieldKind::kSmooth);
  interpolate_array(fit, from, &Sp::path_transmittance, nullptr, s.mutable_path_transmittance(),
                    nullptr, nullptr, FieldKind::kSmooth);
  interpolate_array(fit, from, &Sp::path_radiance_w_m2_sr_um, nullptr,
                    s.mutable_path_radiance_w_m2_sr_um(), nullptr, nullptr, FieldKind::kSmooth);
  return out;
}

absl::StatusOr<std::vector<RowPart>> parts_of(StoreReader& reader, const QueryRow& row) {
  std::vector<RowPart> out;
  if (!row.interpolation) {
    ASSIGN_OR_RETURN(auto stored, reader.parts(row.signature.signature_id));
    for (StoredPart& part : stored) out.push_back({std::move(part), 0});
    return out;
  }
  std::vector<std::vector<StoredPart>> from;
  for (const StoredSignature& s : row.interpolation->from) {
    ASSIGN_OR_RETURN(auto stored, reader.parts(s.signature_id));
    from.push_back(std::move(stored));
  }
  for (const StoredPart& part : from.front()) {
    std::vector<double> values, stderrs;
    for (const auto& parts : from) {
      const auto same = std::find_if(parts.begin(), parts.end(),
                                     [&](const StoredPart& p) { return p.part == part.part; });
      if (same == parts.end()) {
        return absl::InternalError(
            fmt::format("part \"{}\" is not stored with every viewpoint", part.part));
      }
      values.push_back(same->intensity_w_sr);
      stderrs.push_back(same->intensity_stderr_w_sr);
    }
    const SphereEstimate e =
        estimate_of(FieldKind::kFacets, row.interpolation->fit, values, stderrs);
    out.push_back({{part.part, e.value, e.value_stderr}, e.interpolation_error});
  }
  return out;
}

}  // namespace irsig
