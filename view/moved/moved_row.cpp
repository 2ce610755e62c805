#include "view/moved/moved_row.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/accuracy/spectral_modes.h"
#include "core/base/status_macros.h"
#include "view/rows/measured_row.h"

namespace irsig {
namespace {

constexpr std::size_t kCauses = SightLine::kCauses;

using S = StoredSignature;
using Sp = schema::Spectrum;
using Integrals = SightLine::Integrals;
using Values = google::protobuf::RepeatedField<float>;

struct CauseColumns {
  const Values& (Sp::*value)() const;
  const Values& (Sp::*value_stderr)() const;
  double S::*in_band;
  double S::*in_band_stderr;
};
// In the order of SightLine.
constexpr CauseColumns kCauseColumns[kCauses] = {
    {&Sp::emitted_w_sr_um, &Sp::emitted_stderr_w_sr_um, &S::emitted_w_sr, &S::emitted_stderr_w_sr},
    {&Sp::sun_reflected_w_sr_um, &Sp::sun_reflected_stderr_w_sr_um, &S::sun_reflected_w_sr,
     &S::sun_reflected_stderr_w_sr},
    {&Sp::sky_reflected_w_sr_um, &Sp::sky_reflected_stderr_w_sr_um, &S::sky_reflected_w_sr,
     &S::sky_reflected_stderr_w_sr},
    {&Sp::surface_reflected_w_sr_um, &Sp::surface_reflected_stderr_w_sr_um,
     &S::surface_reflected_w_sr, &S::surface_reflected_stderr_w_sr},
    {&Sp::interreflected_w_sr_um, &Sp::interreflected_stderr_w_sr_um, &S::interreflected_w_sr,
     &S::interreflected_stderr_w_sr}};

struct Number {
  double value, stderr_;
};

// Stored values of a row at one wavelength, or over the whole band.
struct Held {
  Number apparent, contrast, background, area_m2;
  std::array<double, kCauses> cause_stderr;
};

// Light of one channel as it arrives from one range.
struct Seen {
  double transmittance = 0, path = 0, behind = 0, target = 0;
  double fraction_bound = 0, between_bound = 0;  // of behind
  std::array<double, kCauses> share{};           // of each cause
};

struct Moved {
  Number apparent, contrast, background;
  double apparent_bound, contrast_bound;  // of bias, perspective left out
};

double cause_at(const Sp& spectrum, std::size_t cause, std::size_t k) {
  return (spectrum.*kCauseColumns[cause].value)().Get(static_cast<int>(k));
}

// Bins first .. last - 1 together.
Seen seen(const Integrals& at, const Sp& spectrum, std::size_t first, std::size_t last) {
  const auto of = [](const SightLine::Values& bound, std::size_t k) {
    return bound.empty() ? 0.0 : bound[k];
  };
  Seen out;
  double width = 0;
  std::array<double, kCauses> weight{}, arriving{};
  for (std::size_t k = first; k < last; ++k) {
    width += at.width[k];
    out.transmittance += at.transmittance[k];
    out.path += at.path_radiance[k];
    out.behind += at.behind[k];
    out.fraction_bound += of(at.background_fraction_bound, k);
    out.between_bound += of(at.background_between_bound, k);
    for (std::size_t c = 0; c < kCauses; ++c) {
      const double value = cause_at(spectrum, c, k);
      out.target += value * at.arriving[c][k];
      out.share[c] += std::abs(value) * at.arriving[c][k];
      weight[c] += std::abs(value) * at.width[k];
      arriving[c] += at.arriving[c][k];
    }
  }
  out.transmittance /= width;
  for (std::size_t c = 0; c < kCauses; ++c)
    out.share[c] = weight[c] > 0 ? out.share[c] / weight[c] : arriving[c] / width;
  return out;
}

// Returns the fraction of the light arriving from range `from` that also arrives from range `to`.
double kept(const Seen& from, const Seen& to) {
  return from.transmittance > 0 ? to.transmittance / from.transmittance : 0;
}

Moved moved(const Held& held, const Seen& from, const Seen& to, double spread,
            const ShapeChange& shape) {
  const double area = held.area_m2.value;
  const double keep = kept(from, to), light = shape.target_ratio;
  const double target = to.target - keep * from.target;
  const double path = shape.area_ratio * to.path - light * keep * from.path;
  const double behind = shape.area_ratio * to.behind - light * keep * from.behind;
  double noise = 0;
  for (std::size_t c = 0; c < kCauses; ++c)
    noise += held.cause_stderr[c] * std::abs(to.share[c] - keep * from.share[c]);
  // The error that the fractions alone leave at the stored range.
  const double off = std::abs(keep - 1);
  const double target_bound =
      light * (off * std::abs(held.apparent.value - area * from.path - from.target) + spread);
  // Relative error by interpolation between directions and by silhouettes of a million cells: up to
  // 5e-5 over the scenes of tests/system/moved_rows_test.py.
  constexpr double kBehind = 5e-5;
  const double background_bound = to.fraction_bound + to.between_bound +
                                  keep * from.fraction_bound +
                                  kBehind * (std::abs(to.behind) + keep * std::abs(from.behind));
  const double silhouette_bound =
      light * off * area * std::abs(held.background.value - from.path - from.behind) +
      area * (shape.area_ratio * (to.fraction_bound + to.between_bound) +
              light * keep * from.fraction_bound);
  return {
      {light * (keep * held.apparent.value + target) + area * path,
       light * (keep * held.apparent.stderr_ + noise) + held.area_m2.stderr_ * std::abs(path)},
      {light * (keep * held.contrast.value + target) - area * behind,
       light * (keep * held.contrast.stderr_ + noise) + held.area_m2.stderr_ * std::abs(behind)},
      {keep * (held.background.value - from.path - from.behind) + to.behind + to.path,
       std::hypot(keep * held.background.stderr_, background_bound / std::sqrt(3.0))},
      target_bound,
      target_bound + silhouette_bound};
}

// The modes of a spectrum's errors after each bin's have been multiplied and others added, which
// may go with them: these are part of what the modes leave over.
absl::StatusOr<std::string> moved_modes(const Values& before, std::string_view modes,
                                        const std::vector<double>& keep, const Values& after) {
  ASSIGN_OR_RETURN(
      const auto errors,
      SumErrors::make({before.data(), static_cast<std::size_t>(before.size())}, modes));
  SpectralSet out = errors.modes();
  for (std::vector<double>& mode : out)
    for (std::size_t k = 0; k < mode.size(); ++k) mode[k] *= keep[k];
  const std::vector<double> stderrs(after.begin(), after.end());
  return encoded_modes(out, stderrs);
}

// Returns the model error of the apparent intensity, as seen along this line of sight.
double apparent_model_error(const S& row, const Sp& spectrum, const SightLine& to,
                            double apparent_w_sr) {
  double surface_w_sr = 0;
  const Integrals& at = to.band;
  for (std::size_t k = 0; k < at.model_error_transmittance.size(); ++k)
    surface_w_sr +=
        spectrum.spectral_intensity_w_sr_um(static_cast<int>(k)) * at.model_error_transmittance[k] -
        row.projected_area_m2 * at.model_error_path_radiance[k];
  const double arrives =
      row.intensity_w_sr != 0 ? std::min(1.0, std::abs(apparent_w_sr / row.intensity_w_sr)) : 0;
  return std::hypot(arrives * row.model_error_w_sr, surface_w_sr);
}

// One sigma of which of both skies of a broken cloud the line of sight crosses.
struct ChoiceOfSky {
  double apparent_w_sr = 0, contrast_w_sr = 0;
};
ChoiceOfSky choice_of_sky(const S& row, const Sp& spectrum, const SightLine& to) {
  const Integrals& at = to.band;
  double apparent_w_sr = 0, contrast_w_sr = 0;
  for (std::size_t k = 0; k < at.choice_transmittance.size(); ++k) {
    const double surface_w_sr =
        spectrum.spectral_intensity_w_sr_um(static_cast<int>(k)) * at.choice_transmittance[k];
    apparent_w_sr += surface_w_sr + row.projected_area_m2 * at.choice_path_radiance[k];
    contrast_w_sr += surface_w_sr - row.projected_area_m2 * at.choice_behind[k];
  }
  return {std::abs(apparent_w_sr), std::abs(contrast_w_sr)};
}

// The light that leaves the target, by cause, and the area that it is seen on.
void change_source(const ShapeChange& shape, S& s, Sp& spectrum) {
  std::vector<double S::*> number = {&S::intensity_w_sr, &S::intensity_stderr_w_sr,
                                     &S::model_error_w_sr};
  for (const CauseColumns& cause : kCauseColumns) {
    number.push_back(cause.in_band);
    number.push_back(cause.in_band_stderr);
  }
  for (double S::*of : number) s.*of *= shape.target_ratio;
  s.projected_area_m2 *= shape.area_ratio;
  s.projected_area_stderr_m2 *= shape.area_ratio;
  const auto scale = [&](google::protobuf::RepeatedField<float>* values) {
    for (float& v : *values) v = static_cast<float>(shape.target_ratio * static_cast<double>(v));
  };
  for (auto values :
       {&Sp::mutable_spectral_intensity_w_sr_um, &Sp::mutable_spectral_intensity_stderr_w_sr_um,
        &Sp::mutable_emitted_w_sr_um, &Sp::mutable_emitted_stderr_w_sr_um,
        &Sp::mutable_sun_reflected_w_sr_um, &Sp::mutable_sun_reflected_stderr_w_sr_um,
        &Sp::mutable_sky_reflected_w_sr_um, &Sp::mutable_sky_reflected_stderr_w_sr_um,
        &Sp::mutable_surface_reflected_w_sr_um, &Sp::mutable_surface_reflected_stderr_w_sr_um,
        &Sp::mutable_interreflected_w_sr_um, &Sp::mutable_interreflected_stderr_w_sr_um})
    scale((spectrum.*values)());
}

}  // namespace

absl::StatusOr<MovedRow> moved_row(const S& row, const Sp& spectrum, const SightLine& from,
                                   const SightLine& to, const ReflectedSpread& spread_of_unit,
                                   const ShapeChange& shape) {
  const std::size_t bins = from.bin.width.size();
  if (!std::isnan(row.plume_w_sr))
    return absl::InvalidArgumentError(fmt::format(
        "row {}: hot gas is known at the range of {:g} m alone: the air takes the lines "
        "that it sends, and band means do not multiply; run the sweep with the other "
        "range in viewpoints.ranges_m",
        row.row, row.range_m));
  if (spectrum.lambda_um_size() != static_cast<int>(bins))
    return absl::InternalError(fmt::format("row {}: {} wavelengths are stored, its band has {}",
                                           row.row, spectrum.lambda_um_size(), bins));

  MovedRow out{row, spectrum, 0};
  double spread = 0;
  std::vector<double> keep;
  for (std::size_t k = 0; k < bins; ++k) {
    const int i = static_cast<int>(k);
    Held held{{spectrum.apparent_spectral_intensity_w_sr_um(i),
               spectrum.apparent_spectral_intensity_stderr_w_sr_um(i)},
              {spectrum.contrast_spectral_intensity_w_sr_um(i),
               spectrum.contrast_spectral_intensity_stderr_w_sr_um(i)},
              {spectrum.background_radiance_w_m2_sr_um(i),
               spectrum.background_radiance_stderr_w_m2_sr_um(i)},
              {row.projected_area_m2, row.projected_area_stderr_m2},
              {}};
    for (std::size_t c = 0; c < kCauses; ++c)
      held.cause_stderr[c] = (spectrum.*kCauseColumns[c].value_stderr)().Get(i);
    double of_bin = 0;
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}})
      of_bin +=
          std::abs(cause_at(spectrum, SightLine::kReflected[side], k)) * spread_of_unit[side][k];
    spread += of_bin * from.band.width[k];
    const Seen here = seen(from.bin, spectrum, k, k + 1), there = seen(to.bin, spectrum, k, k + 1);
    keep.push_back(shape.target_ratio * kept(here, there));
    const Moved m = moved(held, here, there, of_bin, shape);
    const auto f = [](double v) { return static_cast<float>(v); };
    out.spectrum.set_apparent_spectral_intensity_w_sr_um(i, f(m.apparent.value));
    out.spectrum.set_apparent_spectral_intensity_stderr_w_sr_um(i, f(m.apparent.stderr_));
    out.spectrum.set_contrast_spectral_intensity_w_sr_um(i, f(m.contrast.value));
    out.spectrum.set_contrast_spectral_intensity_stderr_w_sr_um(i, f(m.contrast.stderr_));
    out.spectrum.set_background_radiance_w_m2_sr_um(i, f(m.background.value));
    out.spectrum.set_background_radiance_stderr_w_m2_sr_um(i, f(m.background.stderr_));
    out.spectrum.set_path_transmittance(i, f(to.bin.transmittance[k]));
    out.spectrum.set_path_radiance_w_m2_sr_um(i, f(to.bin.path_radiance[k]));
  }
  auto apparent_modes = moved_modes(spectrum.apparent_spectral_intensity_stderr_w_sr_um(),
                                    spectrum.apparent_spectral_intensity_modes(), keep,
                                    out.spectrum.apparent_spectral_intensity_stderr_w_sr_um());
  auto contrast_modes = moved_modes(spectrum.contrast_spectral_intensity_stderr_w_sr_um(),
                                    spectrum.contrast_spectral_intensity_modes(), keep,
                                    out.spectrum.contrast_spectral_intensity_stderr_w_sr_um());
  if (!apparent_modes.ok()) return apparent_modes.status();
  if (!contrast_modes.ok()) return contrast_modes.status();
  out.spectrum.set_apparent_spectral_intensity_modes(*std::move(apparent_modes));
  out.spectrum.set_contrast_spectral_intensity_modes(*std::move(contrast_modes));

  Held held{{row.apparent_intensity_w_sr, row.apparent_intensity_stderr_w_sr},
            {row.contrast_intensity_w_sr, row.contrast_intensity_stderr_w_sr},
            {row.background_radiance_w_m2_sr, row.background_radiance_stderr_w_m2_sr},
            {row.projected_area_m2, row.projected_area_stderr_m2},
            {}};
  for (std::size_t c = 0; c < kCauses; ++c)
    held.cause_stderr[c] = row.*kCauseColumns[c].in_band_stderr;
  const Seen before = seen(from.band, spectrum, 0, bins), after = seen(to.band, spectrum, 0, bins);
  const Moved m = moved(held, before, after, spread, shape);

  S& s = out.signature;
  remove_clutter(s);
  change_source(shape, s, out.spectrum);
  const double area_m2 = shape.area_ratio * row.projected_area_m2;
  const double path_w_sr = area_m2 * after.path;  // of the air in front of it
  const double target_w_sr = std::abs(m.apparent.value - path_w_sr);
  const double background_w_sr = area_m2 * std::abs(after.behind);
  out.range_bound_w_sr =
      m.apparent_bound + shape.target_bound * target_w_sr + shape.area_bound * std::abs(path_w_sr);
  const double contrast_bound =
      m.contrast_bound + shape.target_bound * target_w_sr + shape.area_bound * background_w_sr;
  // The bias that the row had: as much of it arrives as of the target.
  const double grown = before.transmittance > 0
                           ? std::max(after.transmittance / before.transmittance,
                                      before.target > 0 ? after.target / before.target : 0.0)
                           : 1.0;
  const double growth = shape.target_ratio * grown;
  const auto error = [](const Measured& here, double factor, double new_stderr, double added) {
    Measured there = scaled(here, factor);
    there.stderr_ = new_stderr;
    there.of(BoundOf::kMoved) += added;
    return there.numerical_error();
  };
  s.numerical_error_w_sr =
      error(source_of(row), shape.target_ratio, shape.target_ratio * row.intensity_stderr_w_sr,
            shape.target_bound * std::abs(s.intensity_w_sr));
  s.apparent_intensity_w_sr = m.apparent.value;
  s.apparent_intensity_stderr_w_sr = m.apparent.stderr_;
  s.apparent_numerical_error_w_sr =
      error(apparent_of(row), growth, m.apparent.stderr_, out.range_bound_w_sr);
  s.apparent_temperature_k = kNotComputed;
  s.contrast_intensity_w_sr = m.contrast.value;
  s.contrast_intensity_stderr_w_sr = m.contrast.stderr_;
  s.contrast_numerical_error_w_sr =
      error(contrast_of(row), growth, m.contrast.stderr_, contrast_bound);
  // These bounds are part of the errors; their own values are known for the stored range only.
  s.apparent_omitted_bound_w_sr = s.contrast_omitted_bound_w_sr = s.target_depth_bound_w_sr =
      s.background_bound_w_sr = s.apparent_temperature_bound_w_sr = kNotComputed;
  s.background_radiance_w_m2_sr = m.background.value;
  s.background_radiance_stderr_w_m2_sr = m.background.stderr_;
  s.apparent_model_error_w_sr = apparent_model_error(row, spectrum, to, m.apparent.value);
  // The model error of the contrast, and the uncertainty by inputs, are stored without their
  // causes. They are assumed to grow as the model error of the apparent intensity, or as the
  // arriving light where that grows more.
  const double model_here = apparent_model_error(row, spectrum, from, row.apparent_intensity_w_sr);
  const double model_growth =
      model_here > 0 ? std::max(growth, s.apparent_model_error_w_sr / model_here) : growth;
  for (double S::*of : {&S::contrast_model_error_w_sr, &S::apparent_input_uncertainty_w_sr,
                        &S::contrast_input_uncertainty_w_sr, &S::apparent_heat_model_error_w_sr,
                        &S::contrast_heat_model_error_w_sr})
    s.*of *= model_growth;
  // The contrast's stored error contains the choice along the stored line of sight.
  const ChoiceOfSky choice = choice_of_sky(row, spectrum, to),
                    choice_here = choice_of_sky(row, spectrum, from);
  s.apparent_model_error_w_sr = std::hypot(s.apparent_model_error_w_sr, choice.apparent_w_sr);
  const double has_w_sr = model_growth * choice_here.contrast_w_sr;
  if (choice.contrast_w_sr > has_w_sr) {
    s.contrast_model_error_w_sr =
        std::hypot(s.contrast_model_error_w_sr,
                   std::sqrt(choice.contrast_w_sr * choice.contrast_w_sr - has_w_sr * has_w_sr));
  }
  s.path_transmittance = after.transmittance;
  s.path_radiance_w_m2_sr = after.path;
  return out;
}

}  // namespace irsig
