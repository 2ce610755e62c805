#include "schema/store/check/check_plausible.h"

#include <google/protobuf/reflection.h>

#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/accuracy/image_layers.h"
#include "core/base/printable.h"
#include "schema/store/check/check_picture.h"
#include "schema/store/check/check_result.h"
#include "schema/store/tables/database.h"

namespace irsig {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

absl::Status implausible(const std::string& path, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("result: ", path, " ", what));
}

struct Range {
  double least, most;
};

// By the last words of a field's name; the first row that fits. The most that the bounds of sweep
// files (jobs/text/number_bounds.cpp) leave room for: radiances of 1e12 W/(m2 sr um) in a band of
// 1000 um, from a target of 1e6 m; the temperature of a black body that sends as much.
struct RangeOfName {
  std::string_view ending;
  Range range;
};
constexpr auto kRanges = std::to_array<RangeOfName>({
    {"_stderr_w_sr_um", {0, 1e27}},
    {"_stderr_w_m2_sr_um", {0, 1e15}},
    {"path_transmittance", {0, 1 + 1e-6}},
    // Sums of many equal weights, some of them of float32.
    {"backface_fraction", {0, 1 + 1e-6}},
    {"target_fraction", {0, 1 + 1e-6}},
    {"visible_fraction", {0, 1 + 1e-6}},
    {"modes_fraction", {0, 1 + 1e-6}},
    {"material_fraction", {0, 1 + 1e-6}},
    {"sun_azimuth_deg", {-360, 360}},
    {"sun_zenith_deg", {0, 180}},
    // Shares of light, with the scatter of their estimate.
    {"absorbed", {0, 10}},
    {"escaped_to_sky", {0, 10}},
    {"escaped_to_surface", {0, 10}},
    {"cut_off", {0, 10}},
    {"balance", {0, 10}},
    {"error_relative", {0, 1e300}},
    {"_w_sr", {-1e27, 1e27}},
    {"_w_sr_um", {-1e27, 1e27}},
    {"_w_m2_sr", {-1e18, 1e18}},
    {"_w_m2_sr_um", {-1e15, 1e15}},
    {"_m2", {0, 1e13}},
    {"_k", {0, 1e13}},
    {"_rad", {0, 4}},
    {"_um", {0, 1e4}},
    {"_m", {-1e10, 1e10}},
    {"_s", {-1e12, 1e12}},
    {"seconds", {0, 1e9}},
});

Range make_range(const std::string& name) {
  for (const RangeOfName& row : kRanges)
    if (name.ends_with(row.ending)) return row.range;
  return {-HUGE_VAL, HUGE_VAL};
}

// Looked up once for each field.
Range range_of(const FieldDescriptor& field) {
  thread_local std::unordered_map<const FieldDescriptor*, Range> known;
  const auto [at, is_new] = known.try_emplace(&field);
  if (is_new) at->second = make_range(field.name());
  return at->second;
}

bool inside(double value, const Range& range) {
  return value >= range.least && value <= range.most;
}

std::string outside(double value, const Range& range) {
  return absl::StrCat("= ", value, ", expected ", range.least, " to ", range.most);
}

// An estimate has the range of its field's name; a standard error that of its size.
absl::Status check_estimate(const schema::Estimate& estimate, const Range& range,
                            const std::string& name, const std::string& path) {
  if (!inside(estimate.value(), range))
    return implausible(absl::StrCat(path, ".", name, ".value"), outside(estimate.value(), range));
  const Range error = {0, std::max(range.most, -range.least)};
  if (!inside(estimate.stderr(), error))
    return implausible(absl::StrCat(path, ".", name, ".stderr"), outside(estimate.stderr(), error));
  return absl::OkStatus();
}

template <typename Number>
absl::Status check_list(const google::protobuf::RepeatedField<Number>& values, const Range& range,
                        const std::string& name, const std::string& path) {
  for (int i = 0; i < values.size(); ++i)
    if (const auto value = static_cast<double>(values[i]); !inside(value, range))
      return implausible(absl::StrCat(path, ".", name, "[", i, "]"), outside(value, range));
  return absl::OkStatus();
}

// `path` is made by whoever calls it, once for a message.
absl::Status check_ranges(const Message& message, const std::string& path) {
  const google::protobuf::Reflection& r = *message.GetReflection();
  const google::protobuf::Descriptor& type = *message.GetDescriptor();
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor& field = *type.field(i);
    const std::string& name = field.name();
    switch (field.cpp_type()) {
      case FieldDescriptor::CPPTYPE_DOUBLE:
        if (field.is_repeated()) break;  // of spectra, below
        if (const double value = r.GetDouble(message, &field); !inside(value, range_of(field)))
          return implausible(absl::StrCat(path, ".", name), outside(value, range_of(field)));
        break;
      case FieldDescriptor::CPPTYPE_MESSAGE:
        if (field.is_repeated() || !r.HasField(message, &field)) break;
        if (field.message_type() == schema::Estimate::descriptor())
          IRSIG_STORE_TRY(
              check_estimate(static_cast<const schema::Estimate&>(r.GetMessage(message, &field)),
                             range_of(field), name, path));
        break;
      default:
        break;
    }
  }
  return absl::OkStatus();
}

absl::Status check_sum(double sum, double magnitude, double whole, double relative,
                       const std::string& path, const char* parts) {
  // Not above: what is not a number is refused, too.
  if (std::abs(sum - whole) <= relative * (magnitude + std::abs(whole))) return absl::OkStatus();
  return implausible(path, absl::StrCat("= ", whole, ", but its ", parts, " sum to ", sum));
}

constexpr double kRounding = 1e-9;       // of sums of doubles: 1e-15 is met
constexpr double kFloatRounding = 1e-5;  // of float32 spectra: 1.1e-7 is met

absl::Status check_sums(const schema::SignatureRow& row, const std::string& path) {
  double sum = 0, magnitude = 0;
  const auto add = [&](double value) {
    sum += value;
    magnitude += std::abs(value);
  };
  for (const schema::Estimate* cause :
       {&row.emitted_w_sr(), &row.sun_reflected_w_sr(), &row.sky_reflected_w_sr(),
        &row.surface_reflected_w_sr(), &row.interreflected_w_sr(), &row.plume_w_sr()})
    add(cause->value());
  const std::string intensity = path + ".intensity_w_sr";
  IRSIG_STORE_TRY(
      check_sum(sum, magnitude, row.intensity_w_sr().value(), kRounding, intensity, "causes"));
  sum = magnitude = 0;
  add(row.plume_w_sr().value());  // 0 without hot gas
  for (const schema::PartIntensity& part : row.part()) add(part.intensity_w_sr().value());
  IRSIG_STORE_TRY(
      check_sum(sum, magnitude, row.intensity_w_sr().value(), kRounding, intensity, "parts"));
  if (!row.has_energy()) return absl::OkStatus();
  const schema::EnergyLedger& energy = row.energy();
  sum = magnitude = 0;
  for (const schema::Estimate* share : {&energy.absorbed(), &energy.escaped_to_sky(),
                                        &energy.escaped_to_surface(), &energy.cut_off()})
    add(share->value());
  return check_sum(sum, magnitude, energy.balance().value(), kRounding, path + ".energy.balance",
                   "shares");
}

// Not by reflection: these are nearly all the numbers of a result.
struct SpectrumList {
  const char* name;
  const google::protobuf::RepeatedField<float>& (schema::Spectrum::*values)() const;
  Range range;
};
const std::array kSpectrumLists = {
#define IRSIG_LIST(field) \
  SpectrumList { #field, &schema::Spectrum::field, make_range(#field) }
    IRSIG_LIST(spectral_intensity_w_sr_um),
    IRSIG_LIST(spectral_intensity_stderr_w_sr_um),
    IRSIG_LIST(emitted_w_sr_um),
    IRSIG_LIST(emitted_stderr_w_sr_um),
    IRSIG_LIST(sun_reflected_w_sr_um),
    IRSIG_LIST(sun_reflected_stderr_w_sr_um),
    IRSIG_LIST(sky_reflected_w_sr_um),
    IRSIG_LIST(sky_reflected_stderr_w_sr_um),
    IRSIG_LIST(surface_reflected_w_sr_um),
    IRSIG_LIST(surface_reflected_stderr_w_sr_um),
    IRSIG_LIST(interreflected_w_sr_um),
    IRSIG_LIST(interreflected_stderr_w_sr_um),
    IRSIG_LIST(apparent_spectral_intensity_w_sr_um),
    IRSIG_LIST(apparent_spectral_intensity_stderr_w_sr_um),
    IRSIG_LIST(contrast_spectral_intensity_w_sr_um),
    IRSIG_LIST(contrast_spectral_intensity_stderr_w_sr_um),
    IRSIG_LIST(background_radiance_w_m2_sr_um),
    IRSIG_LIST(background_radiance_stderr_w_m2_sr_um),
    IRSIG_LIST(path_transmittance),
    IRSIG_LIST(path_radiance_w_m2_sr_um),
    IRSIG_LIST(plume_w_sr_um),
    IRSIG_LIST(plume_stderr_w_sr_um),
    IRSIG_LIST(apparent_plume_w_sr_um),
    IRSIG_LIST(apparent_plume_stderr_w_sr_um),
    IRSIG_LIST(contrast_plume_w_sr_um),
    IRSIG_LIST(contrast_plume_stderr_w_sr_um),
#undef IRSIG_LIST
};

absl::Status check_plausible_spectrum(const schema::Spectrum& spectrum, const std::string& path) {
  IRSIG_STORE_TRY(check_list(spectrum.lambda_um(), make_range("lambda_um"), "lambda_um", path));
  for (const SpectrumList& list : kSpectrumLists)
    IRSIG_STORE_TRY(check_list((spectrum.*list.values)(), list.range, list.name, path));
  std::vector causes = {&spectrum.emitted_w_sr_um(), &spectrum.sun_reflected_w_sr_um(),
                        &spectrum.sky_reflected_w_sr_um(), &spectrum.surface_reflected_w_sr_um(),
                        &spectrum.interreflected_w_sr_um()};
  if (!spectrum.plume_w_sr_um().empty()) causes.push_back(&spectrum.plume_w_sr_um());
  const auto& whole = spectrum.spectral_intensity_w_sr_um();
  for (const auto* cause : causes)
    if (cause->size() != whole.size()) return implausible(path, "has causes of another length");
  for (int i = 0; i < whole.size(); ++i) {
    double sum = 0, magnitude = 0;
    for (const auto* cause : causes) {
      sum += static_cast<double>((*cause)[i]);
      magnitude += std::abs(static_cast<double>((*cause)[i]));
    }
    const auto value = static_cast<double>(whole[i]);
    if (std::abs(sum - value) <= kFloatRounding * (magnitude + std::abs(value))) continue;
    return check_sum(sum, magnitude, value, kFloatRounding,
                     absl::StrCat(path, ".spectral_intensity_w_sr_um[", i, "]"), "causes");
  }
  return absl::OkStatus();
}

absl::Status check_text(const std::string& text, std::size_t most, const std::string& path) {
  if (text.size() > most)
    return implausible(path, absl::StrCat("has ", text.size(), " bytes, expected at most ", most));
  if (!is_one_line(text)) return implausible(path, "has control characters or is not UTF-8");
  return absl::OkStatus();
}

absl::Status check_plausible_row(const schema::SignatureRow& row, const std::string& path) {
  IRSIG_STORE_TRY(check_ranges(row, path));
  IRSIG_STORE_TRY(check_ranges(row.energy(), path + ".energy"));
  IRSIG_STORE_TRY(check_plausible_spectrum(row.spectrum(), path + ".spectrum"));
  for (const schema::PartIntensity& part : row.part())
    IRSIG_STORE_TRY(check_ranges(part, path + ".part"));
  for (const schema::EffectEntry& effect : row.effect())
    IRSIG_STORE_TRY(check_ranges(effect, path + ".effect"));
  for (const schema::InputContribution& input : row.input())
    IRSIG_STORE_TRY(check_ranges(input, path + ".input"));
  for (const schema::ProfileRow& profile : row.profile()) {
    IRSIG_STORE_TRY(check_ranges(profile, path + ".profile"));
    IRSIG_STORE_TRY(check_text(profile.name(), 1000, path + ".profile.name"));
  }
  IRSIG_STORE_TRY(check_sums(row, path));
  if (!row.has_thumbnail())
    return row.image_layer().empty() ? absl::OkStatus()
                                     : implausible(path + ".image_layer", "is of no image");
  IRSIG_STORE_TRY(check_ranges(row.thumbnail(), path + ".thumbnail"));
  IRSIG_STORE_TRY(check_thumbnail(row.thumbnail(), path + ".thumbnail"));
  if (static_cast<std::size_t>(row.image_layer_size()) > kImageLayers.size())
    return implausible(path + ".image_layer", "has more elements than there are layers");
  for (const schema::ImageLayer& layer : row.image_layer())
    IRSIG_STORE_TRY(check_image_layer(layer, row.thumbnail().width_px(),
                                      row.thumbnail().height_px(), path + ".image_layer"));
  return absl::OkStatus();
}

}  // namespace

absl::Status check_plausible(const schema::JobResult& result) {
  IRSIG_STORE_TRY(check_text(result.job_key(), 200, "job_key"));
  IRSIG_STORE_TRY(check_seed(result));
  IRSIG_STORE_TRY(check_text(result.determinism_class(), 1000, "determinism_class"));
  IRSIG_STORE_TRY(check_text(result.build_id(), 1000, "build_id"));
  IRSIG_STORE_TRY(check_ranges(result, "job"));
  for (int i = 0; i < result.view().row_size(); ++i)
    IRSIG_STORE_TRY(check_plausible_row(result.view().row(i), absl::StrCat("row[", i, "]")));
  if (result.view().has_silhouette()) {
    const schema::Silhouette& silhouette = result.view().silhouette();
    if (result.view().row_size() == 0 || silhouette.part_size() > result.view().row(0).part_size())
      return implausible("silhouette", "has more parts than the rows");
    IRSIG_STORE_TRY(check_silhouette(silhouette, "silhouette"));
  }
  if (result.heat().warning_size() > 1000)
    return implausible("heat.warning", "has more than 1000 elements");
  for (const std::string& warning : result.heat().warning())
    IRSIG_STORE_TRY(check_text(warning, 10000, "heat.warning"));
  for (const schema::PartTemperature& part : result.heat().part())
    IRSIG_STORE_TRY(check_ranges(part, "heat.part"));
  return absl::OkStatus();
}

}  // namespace irsig
