#include "messages/results/result_to_proto.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "absl/strings/str_format.h"
#include "core/base/check.h"
#include "core/base/status_macros.h"
#include "messages/environment/condition_sun.h"

namespace irsig {
namespace {

void set(schema::Estimate* out, const Estimate& e) {
  out->set_value(e.value);
  out->set_stderr(e.stderr_);
}

void copy(const std::vector<double>& values, google::protobuf::RepeatedField<float>* out) {
  out->Reserve(static_cast<int>(values.size()));
  for (const double v : values) out->AddAlreadyReserved(static_cast<float>(v));
}

schema::StopReason reason(StopReason r) {
  switch (r) {
    case StopReason::kTargetReached:
      return schema::STOP_REASON_ACCURACY_REACHED;
    case StopReason::kTargetMissed:
      return schema::STOP_REASON_ACCURACY_NOT_REACHED;
    case StopReason::kSampleLimit:
      return schema::STOP_REASON_SAMPLE_LIMIT;
    case StopReason::kFixedSamples:
      return schema::STOP_REASON_FIXED_SAMPLES;
    case StopReason::kFloorReached:
      return schema::STOP_REASON_FLOOR_REACHED;
  }
  return schema::STOP_REASON_UNSPECIFIED;
}

schema::EffectState state(EffectState s) {
  switch (s) {
    case EffectState::kOn:
      return schema::EFFECT_STATE_ON;
    case EffectState::kOff:
      return schema::EFFECT_STATE_OFF;
    case EffectState::kAbsent:
      return schema::EFFECT_STATE_ABSENT;
  }
  return schema::EFFECT_STATE_UNSPECIFIED;
}

// NaN stands for "not known": the field stays absent.
void set_ledger(schema::SignatureRow* row, const SignatureResult& r) {
  const auto known = [](double value, auto set) {
    if (!std::isnan(value)) set(value);
  };
  for (const LedgerEntry& e : r.effect) {
    schema::EffectEntry* out = row->add_effect();
    out->set_effect(std::string(info_of(e.effect).name));
    out->set_state(state(e.state));
    out->set_reason(std::string(name_of(e.reason)));
    known(e.bound_w_sr, [&](double v) { out->set_bound_w_sr(v); });
    known(e.apparent_bound_w_sr, [&](double v) { out->set_apparent_bound_w_sr(v); });
    known(e.contrast_bound_w_sr, [&](double v) { out->set_contrast_bound_w_sr(v); });
    known(e.fraction_w_sr, [&](double v) { out->set_fraction_w_sr(v); });
    known(e.time_s, [&](double v) { out->set_time_s(v); });
  }
  // A row without anything to be seen has no ledger of light.
  if (std::isnan(r.energy.balance.value)) return;
  schema::EnergyLedger* energy = row->mutable_energy();
  set(energy->mutable_absorbed(), r.energy.absorbed);
  set(energy->mutable_escaped_to_sky(), r.energy.escaped_to_sky);
  set(energy->mutable_escaped_to_surface(), r.energy.escaped_to_surface);
  set(energy->mutable_cut_off(), r.energy.cut_off);
  set(energy->mutable_balance(), r.energy.balance);
}

void set_spectrum(schema::Spectrum* out, const SignatureResult& r, const BandGrid& grid) {
  for (const double lambda : grid.lambda_um) out->add_lambda_um(lambda);
  copy(r.spectral.value, out->mutable_spectral_intensity_w_sr_um());
  copy(r.spectral.stderr_, out->mutable_spectral_intensity_stderr_w_sr_um());
  const auto cause = [&](Cause c) -> const SpectralEstimate& {
    return r.spectral_cause[static_cast<std::size_t>(c)];
  };
  copy(cause(Cause::kEmitted).value, out->mutable_emitted_w_sr_um());
  copy(cause(Cause::kEmitted).stderr_, out->mutable_emitted_stderr_w_sr_um());
  copy(cause(Cause::kSunReflected).value, out->mutable_sun_reflected_w_sr_um());
  copy(cause(Cause::kSunReflected).stderr_, out->mutable_sun_reflected_stderr_w_sr_um());
  copy(cause(Cause::kSkyReflected).value, out->mutable_sky_reflected_w_sr_um());
  copy(cause(Cause::kSkyReflected).stderr_, out->mutable_sky_reflected_stderr_w_sr_um());
  copy(cause(Cause::kSeaReflected).value, out->mutable_surface_reflected_w_sr_um());
  copy(cause(Cause::kSeaReflected).stderr_, out->mutable_surface_reflected_stderr_w_sr_um());
  copy(cause(Cause::kPartsReflected).value, out->mutable_interreflected_w_sr_um());
  copy(cause(Cause::kPartsReflected).stderr_, out->mutable_interreflected_stderr_w_sr_um());
  copy(r.apparent_spectral.value, out->mutable_apparent_spectral_intensity_w_sr_um());
  copy(r.apparent_spectral.stderr_, out->mutable_apparent_spectral_intensity_stderr_w_sr_um());
  copy(r.contrast_spectral.value, out->mutable_contrast_spectral_intensity_w_sr_um());
  copy(r.contrast_spectral.stderr_, out->mutable_contrast_spectral_intensity_stderr_w_sr_um());
  copy(r.background_spectral.value, out->mutable_background_radiance_w_m2_sr_um());
  copy(r.background_spectral.stderr_, out->mutable_background_radiance_stderr_w_m2_sr_um());
  copy(r.path_transmittance_spectral, out->mutable_path_transmittance());
  copy(r.path_radiance_spectral, out->mutable_path_radiance_w_m2_sr_um());
  const auto modes = [](const SpectralEstimate& e) { return encoded_modes(e.modes, e.stderr_); };
  out->set_spectral_intensity_modes(modes(r.spectral));
  out->set_apparent_spectral_intensity_modes(modes(r.apparent_spectral));
  out->set_contrast_spectral_intensity_modes(modes(r.contrast_spectral));
  if (!r.has_plume) return;
  copy(r.plume_spectral.value, out->mutable_plume_w_sr_um());
  copy(r.plume_spectral.stderr_, out->mutable_plume_stderr_w_sr_um());
  copy(r.apparent_plume_spectral.value, out->mutable_apparent_plume_w_sr_um());
  copy(r.apparent_plume_spectral.stderr_, out->mutable_apparent_plume_stderr_w_sr_um());
  copy(r.contrast_plume_spectral.value, out->mutable_contrast_plume_w_sr_um());
  copy(r.contrast_plume_spectral.stderr_, out->mutable_contrast_plume_stderr_w_sr_um());
}

absl::Status set_thumbnail(schema::Thumbnail* out, const SignatureResult& r, const ViewResult& view,
                           const ThumbnailEncoder* encoder) {
  if (encoder == nullptr)
    return absl::FailedPreconditionError(
        "the job has thumbnails, and there is no encoder for them");
  ASSIGN_OR_RETURN(auto png,
                   encoder->png(view.image_width_px, view.image_height_px, r.image_w_m2_sr));
  ASSIGN_OR_RETURN(auto exr,
                   encoder->exr(view.image_width_px, view.image_height_px, r.image_w_m2_sr));
  ASSIGN_OR_RETURN(auto stderr_exr, encoder->stderr_exr(view.image_width_px, view.image_height_px,
                                                        r.image_stderr_w_m2_sr));
  out->set_width_px(view.image_width_px);
  out->set_height_px(view.image_height_px);
  out->set_pixel_rad(view.pixel_rad);
  out->set_stderr_exr(std::move(stderr_exr));
  out->set_png(std::move(png));
  out->set_exr(std::move(exr));
  out->set_error_relative(r.image_error_relative);
  out->set_error_k(r.image_error_k);
  return absl::OkStatus();
}

absl::Status add_layers(schema::SignatureRow* row, const SignatureResult& r, const ViewResult& view,
                        const ThumbnailEncoder& encoder) {
  for (const LayerImage& image : r.layer) {
    schema::ImageLayer* out = row->add_image_layer();
    out->set_name(name_of(image.layer));
    ASSIGN_OR_RETURN(*out->mutable_exr(),
                     encoder.exr(view.image_width_px, view.image_height_px, image.value));
    if (image.stderr_.empty()) continue;
    ASSIGN_OR_RETURN(*out->mutable_stderr_exr(),
                     encoder.stderr_exr(view.image_width_px, view.image_height_px, image.stderr_));
  }
  return absl::OkStatus();
}

std::string packed(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  IRSIG_CHECK(compress(reinterpret_cast<Bytef*>(out.data()), &size,
                       reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()) == Z_OK);
  out.resize(size);
  return out;
}

// Little-endian bytes of a number.
template <typename Number>
void append(Number number, std::string& bytes) {
  for (std::size_t i = 0; i < sizeof(Number); ++i)
    bytes.push_back(static_cast<char>(number >> (8 * i) & 255U));
}

// zlib's bytes of little-endian numbers.
std::string packed(const std::vector<std::uint16_t>& samples) {
  std::string bytes;
  bytes.reserve(2 * samples.size());
  for (const std::uint16_t s : samples) append(s, bytes);
  return packed(bytes);
}

void add_part_set(const ViewResult::PartSet& set, schema::Silhouette& out) {
  schema::PartSetPixels* there = out.add_part_set();
  there->mutable_part_index()->Assign(set.part.begin(), set.part.end());
  there->set_outside_px(set.outside_px);
  std::string bytes;
  std::uint32_t next = 0;
  for (const TracedPictures::Met& met : set.pixel) {
    append(met.pixel - next, bytes);
    next = met.pixel + 1;
  }
  for (const TracedPictures::Met& met : set.pixel)
    append(static_cast<std::uint16_t>(met.samples), bytes);
  there->set_samples(packed(bytes));
}

schema::Silhouette silhouette_of(const ViewResult& view) {
  schema::Silhouette out;
  out.set_width_px(view.image_width_px);
  out.set_height_px(view.image_height_px);
  out.set_pixel_samples(view.pixel_samples);
  std::map<std::uint32_t, std::vector<TracedPictures::Met>> of_part;
  for (const TracedPictures::Met& met : view.seen) of_part[met.part].push_back(met);
  for (const auto& [part, pixels] : of_part) {
    std::uint32_t left = view.image_width_px, right = 0;
    for (const TracedPictures::Met& met : pixels) {
      left = std::min(left, met.pixel % view.image_width_px);
      right = std::max(right, met.pixel % view.image_width_px);
    }
    // In the order of pixels.
    const std::uint32_t top = pixels.front().pixel / view.image_width_px,
                        bottom = pixels.back().pixel / view.image_width_px,
                        width = right - left + 1;
    std::vector<std::uint16_t> samples(std::size_t{width} * (bottom - top + 1), 0);
    for (const TracedPictures::Met& met : pixels)
      samples[std::size_t{met.pixel / view.image_width_px - top} * width +
              met.pixel % view.image_width_px - left] = static_cast<std::uint16_t>(met.samples);
    schema::PartPixels* box = out.add_part();
    box->set_part_index(part);
    box->set_left_px(left);
    box->set_top_px(top);
    box->set_width_px(width);
    box->set_height_px(bottom - top + 1);
    box->set_samples(packed(samples));
  }
  for (const ViewResult::PartSet& set : view.part_set) add_part_set(set, out);
  return out;
}

}  // namespace

void set_clutter(schema::SignatureRow* row, const BackgroundClutter& c) {
#define IRSIG_SET_VALUE(name, stderr_name, unit, what) set(row->mutable_##name(), c.name);
#define IRSIG_SET_NUMBER(name, kind, unit, what) row->set_##name(c.name);
  IRSIG_CLUTTER_QUANTITIES(IRSIG_SET_VALUE, IRSIG_SET_NUMBER)
#undef IRSIG_SET_VALUE
#undef IRSIG_SET_NUMBER
  schema::Clutter* out = row->mutable_clutter();
  copy(c.patch_sigma, out->mutable_patch_sigma_w_m2_sr_um());
  // As many as may be stored: the first carry most.
  SpectralSet modes = c.modes;
  modes.resize(std::min(modes.size(), stored_modes(c.patch_sigma.size())));
  out->set_modes(encoded_modes(modes, c.patch_sigma));
  for (const double fraction : c.material_fraction) out->add_material_fraction(fraction);
}

absl::StatusOr<schema::JobResult> result_to_proto(const ViewResult& view,
                                                  const Simulator& simulator,
                                                  const schema::ResolvedSweep& sweep,
                                                  const ThumbnailEncoder* encoder) {
  schema::JobResult result;
  for (const SignatureResult& r : view.row) {
    schema::SignatureRow* row = result.mutable_view()->add_row();
    row->set_condition_index(r.condition);
    row->set_band_index(r.band);
    // The catalogue's quantities: the message has a field of each name, causes are in the enum's
    // order.
    std::size_t cause = 0;
#define IRSIG_SET_VALUE(name, stderr_name, unit, what) set(row->mutable_##name(), r.name);
#define IRSIG_SET_CAUSE(name, stderr_name, unit, what) \
  set(row->mutable_##name(), r.cause_w_sr[cause++]);
#define IRSIG_SET_NUMBER(name, kind, unit, what) row->set_##name(r.name);
    IRSIG_SOURCE_QUANTITIES(IRSIG_SET_VALUE, IRSIG_SET_NUMBER)
    IRSIG_CAUSE_QUANTITIES(IRSIG_SET_CAUSE)
    IRSIG_SENSOR_QUANTITIES(IRSIG_SET_VALUE, IRSIG_SET_NUMBER)
    IRSIG_BOUND_QUANTITIES(IRSIG_SET_NUMBER)
    if (r.has_plume) {
      IRSIG_PLUME_QUANTITIES(IRSIG_SET_VALUE, IRSIG_SET_NUMBER)
    }
#undef IRSIG_SET_VALUE
#undef IRSIG_SET_CAUSE
#undef IRSIG_SET_NUMBER
    if (r.clutter) set_clutter(row, *r.clutter);
    row->set_reflections(r.reflections);
    set_ledger(row, r);
    for (std::uint32_t p = 0; p < r.part_w_sr.size(); ++p) {
      schema::PartIntensity* part = row->add_part();
      part->set_part_index(p);
      set(part->mutable_intensity_w_sr(), r.part_w_sr[p]);
    }
    set_spectrum(row->mutable_spectrum(), r, simulator.band_grids()[r.band]);
    if (!r.image_w_m2_sr.empty()) {
      RETURN_IF_ERROR(set_thumbnail(row->mutable_thumbnail(), r, view, encoder));
      RETURN_IF_ERROR(add_layers(row, r, view, *encoder));
    }
    row->set_stop_reason(reason(r.stop_reason));
    row->set_energy_gain(simulator.energy_gain());
    if (sweep.sweep().place().has_latitude_deg()) {
      ASSIGN_OR_RETURN(const auto sun,
                       sun_angles(sweep, sweep.condition(static_cast<int>(r.condition))));
      row->set_sun_azimuth_deg(sun.azimuth_deg);
      row->set_sun_zenith_deg(sun.zenith_deg);
    }
  }
  if (view.image_width_px > 0) *result.mutable_view()->mutable_silhouette() = silhouette_of(view);
  result.set_samples(view.samples);
  result.set_replicates(view.replicates);
  result.set_target_paths(view.target_paths);
  result.set_rays(view.rays);
  result.set_guarded_backface_hits(view.guarded_backface_hits);
  result.set_guarded_nonfinite(view.guarded_nonfinite);
  result.set_truncated_paths(view.truncated_paths);
  result.set_guarded_negative(view.guarded_negative);
  result.set_seed_hex(absl::StrFormat("%016x", view.seed));
  return result;
}

}  // namespace irsig
