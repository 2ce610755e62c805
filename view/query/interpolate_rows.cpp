#include "view/query/interpolate_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "core/base/status_macros.h"

namespace irsig {
namespace {

// Directions closer than this are one viewpoint: 1e-7 rad is 0.5 mm at 5 km.
constexpr double kSameDirection = 1e-7;

Vec<Body> direction_of(const StoredSignature& s) { return {s.unit_x, s.unit_y, s.unit_z}; }

using Getter = double StoredSignature::*;

std::pair<std::vector<double>, std::vector<double>> picked(const std::vector<StoredSignature>& from,
                                                           Getter value, Getter value_stderr) {
  std::pair<std::vector<double>, std::vector<double>> out;
  for (const auto& s : from) {
    out.first.push_back(s.*value);
    out.second.push_back(value_stderr ? s.*value_stderr : 0.0);
  }
  return out;
}

// Its own error, that of the interpolation, and the bounds of what it is made from.
double interpolated_error(const SphereEstimate& estimate, const QuantityColumns& quantity,
                          const SphereFit& fit, const std::vector<StoredSignature>& from) {
  std::vector<Measured> measured;
  for (const StoredSignature& s : from) measured.push_back(quantity.measured(s));
  Measured made = weighted_sum(fit.weight(), measured);
  made.stderr_ = std::hypot(estimate.value_stderr, estimate.interpolation_error);
  return made.numerical_error();
}

// The models err alike at all viewpoints.
double propagated_model_error(const SphereFit& fit, const std::vector<StoredSignature>& from,
                              Getter error) {
  double sum = 0;
  for (std::size_t i = 0; i < from.size(); ++i) sum += std::abs(fit.weight()[i]) * from[i].*error;
  return sum;
}

// A temperature is 0 where the target shows no area: between such viewpoints and others there is
// none.
double interpolated_temperature_k(const SphereFit& fit, const std::vector<StoredSignature>& from,
                                  Getter temperature_k) {
  double sum = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (from[i].*temperature_k == 0) {
      if (std::abs(fit.weight()[i]) > 1e-3) return 0;
      continue;
    }
    sum += fit.weight()[i] * from[i].*temperature_k;
  }
  return sum;
}

absl::StatusOr<QueryRow> interpolate_field(const SignatureField& field,
                                           SignatureFilter::Direction aspect) {
  const Vec<Body> where = body_from_aspect(aspect.aspect_azimuth_deg, aspect.aspect_elevation_deg);
  ASSIGN_OR_RETURN(auto fit, SphereFit::at(field.samples, where));
  Interpolation made{std::move(fit), {}, 0};
  for (std::size_t i : made.fit.used()) made.from.push_back(field.signature[i]);

  const auto at = [&](Getter value, Getter value_stderr, FieldKind kind = FieldKind::kFacets) {
    const auto [values, stderrs] = picked(made.from, value, value_stderr);
    return estimate_of(kind, made.fit, values, stderrs);
  };
  using S = StoredSignature;
  S out = made.from.front();
  out.signature_id = 0;
  out.row = 0;
  out.dominant_inputs.clear();
  remove_clutter(out);
  out.aspect_azimuth_deg = std::fmod(aspect.aspect_azimuth_deg + 720, 360);
  out.aspect_elevation_deg = aspect.aspect_elevation_deg;
  std::tie(out.unit_x, out.unit_y, out.unit_z) = std::tuple(where.x, where.y, where.z);

  const SphereEstimate source = at(&S::intensity_w_sr, &S::intensity_stderr_w_sr);
  made.interpolation_error_w_sr = source.interpolation_error;
  out.intensity_w_sr = source.value;
  out.intensity_stderr_w_sr = source.value_stderr;
  out.numerical_error_w_sr =
      interpolated_error(source, columns_of(SignatureQuantity::kIntensity), made.fit, made.from);
  for (const auto quantity :
       {SignatureQuantity::kApparentIntensity, SignatureQuantity::kContrastIntensity}) {
    const QuantityColumns& q = columns_of(quantity);
    const SphereEstimate e = at(q.value, q.value_stderr, kind_of(quantity));
    out.*q.value = e.value;
    out.*q.value_stderr = e.value_stderr;
    out.*q.numerical_error = interpolated_error(e, q, made.fit, made.from);
  }
  for (const Getter error :
       {&S::model_error_w_sr, &S::apparent_model_error_w_sr, &S::contrast_model_error_w_sr,
        &S::input_uncertainty_w_sr, &S::apparent_input_uncertainty_w_sr,
        &S::contrast_input_uncertainty_w_sr, &S::heat_model_error_w_sr,
        &S::apparent_heat_model_error_w_sr, &S::contrast_heat_model_error_w_sr})
    out.*error = propagated_model_error(made.fit, made.from, error);
  for (const Getter value : {&S::path_transmittance, &S::path_radiance_w_m2_sr})
    out.*value = at(value, nullptr, FieldKind::kSmooth).value;

  const auto set = [&](Getter value, Getter value_stderr) {
    const SphereEstimate e = at(value, value_stderr);
    out.*value = e.value;
    out.*value_stderr = e.value_stderr;
  };
  set(&S::background_radiance_w_m2_sr, &S::background_radiance_stderr_w_m2_sr);
  set(&S::projected_area_m2, &S::projected_area_stderr_m2);
  set(&S::emitted_w_sr, &S::emitted_stderr_w_sr);
  set(&S::sun_reflected_w_sr, &S::sun_reflected_stderr_w_sr);
  set(&S::sky_reflected_w_sr, &S::sky_reflected_stderr_w_sr);
  set(&S::surface_reflected_w_sr, &S::surface_reflected_stderr_w_sr);
  set(&S::interreflected_w_sr, &S::interreflected_stderr_w_sr);
  for (const Getter of : {&S::source_radiance_temperature_k, &S::apparent_temperature_k})
    out.*of = interpolated_temperature_k(made.fit, made.from, of);
  return QueryRow{std::move(out), std::move(made)};
}

}  // namespace

FieldKind kind_of(SignatureQuantity quantity) {
  switch (quantity) {
    case SignatureQuantity::kIntensity:
    case SignatureQuantity::kApparentIntensity:
      return FieldKind::kFacets;
    case SignatureQuantity::kContrastIntensity:
      return FieldKind::kSignedFacets;
    case SignatureQuantity::kBackgroundRadiance:
      break;
  }
  return FieldKind::kSmooth;
}

SphereEstimate estimate_of(FieldKind kind, const SphereFit& fit, const std::vector<double>& value,
                           const std::vector<double>& value_stderr) {
  SphereEstimate out = fit.estimate(value, value_stderr, kind);
  if (kind == FieldKind::kSignedFacets) return out;
  const bool samples_negative =
      std::any_of(value.begin(), value.end(), [](double v) { return v < 0; });
  if (out.value < 0 && !samples_negative) {
    out.interpolation_error = std::hypot(out.interpolation_error, out.value);
    out.value = 0;
  }
  return out;
}

std::vector<SignatureField> fields_of(const std::vector<StoredSignature>& signatures,
                                      SignatureQuantity quantity) {
  const QuantityColumns& q = columns_of(quantity);
  std::map<std::tuple<std::string, std::string, std::string, std::string, double>, std::size_t>
      index;
  std::vector<SignatureField> fields;
  for (const StoredSignature& s : signatures) {
    const auto [at, fresh] =
        index.try_emplace({s.sweep, s.season, s.time_utc, s.band, s.range_m}, fields.size());
    if (fresh) fields.emplace_back();
    SignatureField& field = fields[at->second];
    auto& [direction, value, value_stderr] = field.samples;
    const Vec<Body> d = direction_of(s);
    const bool seen = std::any_of(direction.begin(), direction.end(), [&](Vec<Body> other) {
      return length(d - other) < kSameDirection;
    });
    if (seen) continue;
    field.signature.push_back(s);
    direction.push_back(d);
    value.push_back(s.*q.value);
    value_stderr.push_back(s.*q.value_stderr);
  }
  return fields;
}

absl::StatusOr<std::vector<QueryRow>> interpolate_rows(
    const std::vector<StoredSignature>& signatures, SignatureFilter::Direction aspect) {
  std::vector<QueryRow> rows;
  for (const SignatureField& field : fields_of(signatures)) {
    auto row = interpolate_field(field, aspect);
    if (!row.ok()) {
      const StoredSignature& s = field.signature.front();
      return absl::Status(
          row.status().code(),
          fmt::format("cannot interpolate at aspect {:g},{:g} deg (sweep {}, range {:g} m): {}",
                      aspect.aspect_azimuth_deg, aspect.aspect_elevation_deg, s.sweep, s.range_m,
                      std::string(row.status().message())));
    }
    rows.push_back(std::move(*row));
  }
  return rows;
}

}  // namespace irsig
