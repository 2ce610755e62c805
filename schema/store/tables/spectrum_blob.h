#pragma once

#include <array>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "schema/result.pb.h"

namespace irsig {

inline constexpr std::size_t kSpectrumArrays = 26;
// The first arrays have a value at each wavelength; each later one may be empty (hot gas).
inline constexpr std::size_t kRequiredSpectrumArrays = 14;

// The bytes of a spectrum's arrays in the order of schema/result.proto (fields 2 to 27): float32,
// little-endian. Views into the message where the machine is little-endian, so the message must
// live as long.
class SpectrumBlobs {
 public:
  explicit SpectrumBlobs(const schema::Spectrum& spectrum);
  [[nodiscard]] std::string_view operator[](std::size_t array) const { return bytes_[array]; }

 private:
  std::array<std::string, kSpectrumArrays> swapped_;
  std::array<std::string_view, kSpectrumArrays> bytes_;
};

// Reads a spectrum from the bytes of its arrays. An array that was not computed (NULL, allowed only
// for the optional arrays) stays empty. DATA_LOSS: a size does not fit the wavelengths, or a value
// is not finite.
[[nodiscard]] absl::StatusOr<schema::Spectrum> spectrum_from_blobs(
    std::string_view lambda_um, const std::array<std::string, kSpectrumArrays>& arrays);

// Encodes an array as float32, little-endian; floats_from_blob() decodes it. DATA_LOSS: the number
// of values is not `count`, or a value is not finite.
[[nodiscard]] std::string float_blob(const google::protobuf::RepeatedField<float>& values);
[[nodiscard]] absl::StatusOr<google::protobuf::RepeatedField<float>> floats_from_blob(
    std::string_view blob, int count);

// Encodes the wavelengths as float64, little-endian.
[[nodiscard]] std::string wavelength_blob(const schema::Spectrum& spectrum);

}  // namespace irsig
