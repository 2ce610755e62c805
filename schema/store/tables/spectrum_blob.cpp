#include "schema/store/tables/spectrum_blob.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>

namespace irsig {
namespace {

using Floats = google::protobuf::RepeatedField<float>;

struct Array {
  const Floats& (schema::Spectrum::*get)() const;
  Floats* (schema::Spectrum::*mutable_get)();
};

// In the order of the fields in schema/result.proto and of the columns of table `spectrum`.
#define ARRAY(name) \
  { &schema::Spectrum::name, &schema::Spectrum::mutable_##name }
constexpr Array kArrays[] = {ARRAY(spectral_intensity_w_sr_um),
                             ARRAY(spectral_intensity_stderr_w_sr_um),
                             ARRAY(emitted_w_sr_um),
                             ARRAY(emitted_stderr_w_sr_um),
                             ARRAY(sun_reflected_w_sr_um),
                             ARRAY(sun_reflected_stderr_w_sr_um),
                             ARRAY(sky_reflected_w_sr_um),
                             ARRAY(sky_reflected_stderr_w_sr_um),
                             ARRAY(surface_reflected_w_sr_um),
                             ARRAY(surface_reflected_stderr_w_sr_um),
                             ARRAY(interreflected_w_sr_um),
                             ARRAY(interreflected_stderr_w_sr_um),
                             ARRAY(apparent_spectral_intensity_w_sr_um),
                             ARRAY(apparent_spectral_intensity_stderr_w_sr_um),
                             ARRAY(contrast_spectral_intensity_w_sr_um),
                             ARRAY(contrast_spectral_intensity_stderr_w_sr_um),
                             ARRAY(background_radiance_w_m2_sr_um),
                             ARRAY(background_radiance_stderr_w_m2_sr_um),
                             ARRAY(path_transmittance),
                             ARRAY(path_radiance_w_m2_sr_um),
                             ARRAY(plume_w_sr_um),
                             ARRAY(plume_stderr_w_sr_um),
                             ARRAY(apparent_plume_w_sr_um),
                             ARRAY(apparent_plume_stderr_w_sr_um),
                             ARRAY(contrast_plume_w_sr_um),
                             ARRAY(contrast_plume_stderr_w_sr_um)};
#undef ARRAY
static_assert(std::size(kArrays) == kSpectrumArrays);

template <typename Number>
void reverse_each(std::string& bytes) {
  for (std::size_t at = 0; at + sizeof(Number) <= bytes.size(); at += sizeof(Number)) {
    std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                 bytes.begin() + static_cast<std::ptrdiff_t>(at + sizeof(Number)));
  }
}

constexpr bool kLittleEndian = std::endian::native == std::endian::little;

template <typename Number>
bool numbers_from(std::string_view blob, google::protobuf::RepeatedField<Number>& out) {
  if (blob.size() % sizeof(Number) != 0) return false;
  std::string bytes(blob);
  if (!kLittleEndian) reverse_each<Number>(bytes);
  out.Resize(static_cast<int>(bytes.size() / sizeof(Number)), Number{});
  if (!bytes.empty()) std::memcpy(out.mutable_data(), bytes.data(), bytes.size());
  return true;
}

}  // namespace

SpectrumBlobs::SpectrumBlobs(const schema::Spectrum& spectrum) {
  for (std::size_t array = 0; array < kSpectrumArrays; ++array) {
    const Floats& values = (spectrum.*kArrays[array].get)();
    bytes_[array] = {reinterpret_cast<const char*>(values.data()),
                     static_cast<std::size_t>(values.size()) * sizeof(float)};
    if (kLittleEndian) continue;
    swapped_[array] = bytes_[array];
    reverse_each<float>(swapped_[array]);
    bytes_[array] = swapped_[array];
  }
}

absl::StatusOr<schema::Spectrum> spectrum_from_blobs(
    std::string_view lambda_um, const std::array<std::string, kSpectrumArrays>& arrays) {
  schema::Spectrum spectrum;
  // Each stored spectrum has a wavelength: whoever reads it takes the first and the last.
  bool fits = !lambda_um.empty() && numbers_from(lambda_um, *spectrum.mutable_lambda_um());
  for (std::size_t array = 0; array < kSpectrumArrays; ++array) {
    Floats& values = *(spectrum.*kArrays[array].mutable_get)();
    if (array >= kRequiredSpectrumArrays && arrays[array].empty()) continue;
    fits =
        fits && numbers_from(arrays[array], values) && values.size() == spectrum.lambda_um_size();
  }
  if (!fits)
    return absl::DataLossError("a stored spectrum does not fit the wavelengths of its band");
  const auto finite = [](const auto& values) {
    return std::all_of(values.begin(), values.end(), [](auto v) { return std::isfinite(v); });
  };
  if (!finite(spectrum.lambda_um()) ||
      !std::all_of(std::begin(kArrays), std::end(kArrays),
                   [&](const auto& array) { return finite((spectrum.*array.get)()); }))
    return absl::DataLossError("a stored spectrum has what is no finite number");
  return spectrum;
}

std::string float_blob(const Floats& values) {
  std::string bytes(reinterpret_cast<const char*>(values.data()),
                    static_cast<std::size_t>(values.size()) * sizeof(float));
  if (!kLittleEndian) reverse_each<float>(bytes);
  return bytes;
}

absl::StatusOr<Floats> floats_from_blob(std::string_view blob, int count) {
  Floats out;
  if (!numbers_from(blob, out) || out.size() != count)
    return absl::DataLossError("a stored spectrum does not fit the wavelengths of its band");
  if (!std::all_of(out.begin(), out.end(), [](float v) { return std::isfinite(v); }))
    return absl::DataLossError("a stored spectrum has what is no finite number");
  return out;
}

std::string wavelength_blob(const schema::Spectrum& spectrum) {
  std::string bytes(reinterpret_cast<const char*>(spectrum.lambda_um().data()),
                    static_cast<std::size_t>(spectrum.lambda_um_size()) * sizeof(double));
  if (!kLittleEndian) reverse_each<double>(bytes);
  return bytes;
}

}  // namespace irsig
