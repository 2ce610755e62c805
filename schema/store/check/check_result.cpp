#include "schema/store/check/check_result.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <tuple>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/accuracy/quantities.h"
#include "core/accuracy/spectral_modes.h"
#include "google/protobuf/reflection.h"
#include "schema/store/check/ingest_inputs.h"
#include "schema/store/tables/database.h"

namespace irsig {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

absl::Status wrong(const std::string& path, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("result: ", path, " ", what));
}

// Where in a result something stands; spelled out only when it is wrong.
struct Place {
  const Place* above = nullptr;  // null: the result itself
  const FieldDescriptor* field = nullptr;
  int index = -1;  // of a repeated field

  [[nodiscard]] std::string text() const {
    if (above == nullptr) return "";
    const std::string path = above->text();
    const std::string name = absl::StrCat(path, path.empty() ? "" : ".", field->name());
    return index < 0 ? name : absl::StrCat(name, "[", index, "]");
  }
};

// Names that stand for something that cannot be negative (GLOSSARY of docs: suffix grammar).
bool never_negative(const FieldDescriptor* field) {
  thread_local absl::flat_hash_map<const FieldDescriptor*, bool> known;
  const auto [at, added] = known.try_emplace(field, false);
  if (added)
    for (const char* word :
         {"stderr", "error", "bound", "area", "temperature", "seconds", "pixel_rad", "floor",
          "time_s", "uncertainty", "sigma", "clutter_window", "clutter_pixel",
          "clutter_correlation", "clutter_cells", "clutter_patch", "modes_fraction",
          "visible_fraction", "material_fraction"})
      at->second = at->second || absl::StrContains(field->name(), word);
  return at->second;
}

absl::Status check_number(double value, bool may_be_negative, const Place& place) {
  if (!std::isfinite(value)) return wrong(place.text(), "is not a finite number");
  if (value < 0 && !may_be_negative)
    return wrong(place.text(), absl::StrCat("is negative: ", value));
  return absl::OkStatus();
}

template <typename Number>
absl::Status check_array(const Message& message, bool may_be_negative, const Place& place) {
  const auto values = message.GetReflection()->GetRepeatedFieldRef<Number>(message, place.field);
  for (int i = 0; i < values.size(); ++i) {
    const auto value = static_cast<double>(values.Get(i));
    if (std::isfinite(value) && (may_be_negative || value >= 0)) continue;
    return check_number(value, may_be_negative, {place.above, place.field, i});
  }
  return absl::OkStatus();
}

// Every number of a message: finite, not negative where its name forbids it, and small enough for a
// signed column. `non_negative`: the name of the enclosing field already forbids it
// (projected_area_m2.value).
absl::Status check_numbers(const Message& message, const Place& above, bool non_negative) {
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  const google::protobuf::Descriptor& type = *message.GetDescriptor();
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor* field = type.field(i);
    const Place place{&above, field};
    const bool signed_field = !non_negative && !never_negative(field);
    absl::Status status;
    switch (field->cpp_type()) {
      case FieldDescriptor::CPPTYPE_DOUBLE:
        status = field->is_repeated()
                     ? check_array<double>(message, signed_field, place)
                     : check_number(reflection.GetDouble(message, field), signed_field, place);
        break;
      case FieldDescriptor::CPPTYPE_FLOAT:
        status = check_array<float>(message, signed_field, place);
        break;
      case FieldDescriptor::CPPTYPE_UINT64:
        if (reflection.GetUInt64(message, field) >
            static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
          status = wrong(place.text(), "does not fit into 63 bits");
        }
        break;
      case FieldDescriptor::CPPTYPE_MESSAGE:
        if (field->is_repeated()) {
          for (int k = 0; k < reflection.FieldSize(message, field) && status.ok(); ++k)
            status = check_numbers(reflection.GetRepeatedMessage(message, field, k),
                                   {&above, field, k}, false);
        } else if (reflection.HasField(message, field)) {
          status = check_numbers(reflection.GetMessage(message, field), place, !signed_field);
        }
        break;
      default:
        break;
    }
    IRSIG_STORE_TRY(status);
  }
  return absl::OkStatus();
}

// plume: whether the row has hot gas.
absl::Status check_spectrum(const schema::Spectrum& spectrum, bool plume, const std::string& path) {
  const auto& lambda_um = spectrum.lambda_um();
  if (lambda_um.empty()) return wrong(path, "has no wavelengths");
  if (std::adjacent_find(lambda_um.begin(), lambda_um.end(), std::greater_equal<>()) !=
      lambda_um.end()) {
    return wrong(path, ".lambda_um does not increase");
  }
  const google::protobuf::Descriptor& type = *spectrum.GetDescriptor();
  for (int i = 0; i < type.field_count(); ++i) {
    if (!type.field(i)->is_repeated()) continue;
    const int size = spectrum.GetReflection()->FieldSize(spectrum, type.field(i));
    const bool of_plume = absl::StrContains(type.field(i)->name(), "plume");
    if (size != (of_plume && !plume ? 0 : lambda_um.size())) {
      return wrong(absl::StrCat(path, ".", type.field(i)->name()),
                   absl::StrCat("has ", size, " values for ", lambda_um.size(), " wavelengths"));
    }
  }
#define IRSIG_CHECK_MODES(field)                                                     \
  if (const std::string what =                                                       \
          wrong_modes(spectrum.field(), static_cast<std::size_t>(lambda_um.size())); \
      !what.empty())                                                                 \
    return wrong(absl::StrCat(path, ".", #field), what);
  IRSIG_CHECK_MODES(spectral_intensity_modes)
  IRSIG_CHECK_MODES(apparent_spectral_intensity_modes)
  IRSIG_CHECK_MODES(contrast_spectral_intensity_modes)
#undef IRSIG_CHECK_MODES
  return absl::OkStatus();
}

// All of a measured background, or nothing; spectra on the row's wavelengths.
absl::Status check_clutter(const schema::SignatureRow& row, const std::string& path) {
#define IRSIG_SAME_PRESENCE(name, ...)                       \
  if (row.has_##name() != row.has_clutter_window_m())        \
    return wrong(absl::StrCat(path, ".", #name),             \
                 "is there without the other quantities of " \
                 "the background, or they without it");
  IRSIG_CLUTTER_QUANTITIES(IRSIG_SAME_PRESENCE, IRSIG_SAME_PRESENCE)
  IRSIG_SAME_PRESENCE(clutter)
#undef IRSIG_SAME_PRESENCE
  if (!row.has_clutter()) return absl::OkStatus();
  if (!(row.clutter_window_m() > 0 && row.clutter_pixel_m() > 0 && row.clutter_patch_m() > 0))
    return wrong(path + ".clutter", "has a window, pixel or square of no size");
  if (row.clutter_cells() < 1)
    return wrong(path + ".clutter_cells", absl::StrCat("is less than 1: ", row.clutter_cells()));
  const int bins = row.spectrum().lambda_um_size();
  if (row.clutter().patch_sigma_w_m2_sr_um_size() != bins)
    return wrong(path + ".clutter.patch_sigma_w_m2_sr_um",
                 absl::StrCat("has ", row.clutter().patch_sigma_w_m2_sr_um_size(), " values for ",
                              bins, " wavelengths"));
  if (const std::string what = wrong_modes(row.clutter().modes(), static_cast<std::size_t>(bins));
      !what.empty())
    return wrong(path + ".clutter.modes", what);
  return absl::OkStatus();
}

absl::Status check_layers(const schema::SignatureRow& row, const ExpectedResult& expected,
                          const std::string& path) {
  const std::size_t layers = row.has_thumbnail() ? expected.image_layers.size() : 0;
  bool as_asked = static_cast<std::size_t>(row.image_layer_size()) == layers;
  for (std::size_t i = 0; as_asked && i < layers; ++i)
    as_asked = row.image_layer(static_cast<int>(i)).name() == expected.image_layers[i];
  return as_asked ? absl::OkStatus()
                  : wrong(path + ".image_layer", "has other layers than the sweep asks for");
}

absl::Status check_row_but_spectrum(const schema::SignatureRow& row, const ExpectedResult& expected,
                                    const std::string& path) {
  const google::protobuf::Descriptor& type = *row.GetDescriptor();
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor* field = type.field(i);
    // Every estimate and the spectrum; a thumbnail is absent when none was asked for, energy is
    // looked at with the ledger.
    if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE && !field->is_repeated() &&
        field->name() != "thumbnail" && field->name() != "energy" &&
        (row.has_plume_w_sr() || !absl::StrContains(field->name(), "plume")) &&
        (row.has_clutter_window_m() || !absl::StrContains(field->name(), "clutter")) &&
        !row.GetReflection()->HasField(row, field)) {
      return wrong(absl::StrCat(path, ".", field->name()), "is missing");
    }
  }
  if (row.stop_reason() < schema::STOP_REASON_ACCURACY_REACHED ||
      row.stop_reason() > schema::STOP_REASON_FLOOR_REACHED) {
    return wrong(path + ".stop_reason", "is not stated");
  }
#define IRSIG_SAME_PRESENCE(name, ...)                              \
  if (row.has_##name() != row.has_plume_w_sr())                     \
    return wrong(absl::StrCat(path, ".", #name),                    \
                 "is there without the others of hot gas, or they " \
                 "without it");
  IRSIG_PLUME_QUANTITIES(IRSIG_SAME_PRESENCE, IRSIG_SAME_PRESENCE)
#undef IRSIG_SAME_PRESENCE
  IRSIG_STORE_TRY(check_ledger(row, expected.ledger, path));
  IRSIG_STORE_TRY(check_inputs(row, expected.inputs, path));
  std::set<std::uint32_t> seen;
  for (const schema::PartIntensity& part : row.part()) {
    if (part.part_index() >= expected.parts || !seen.insert(part.part_index()).second) {
      return wrong(path + ".part",
                   absl::StrCat("names part ", part.part_index(), " twice, or it does not exist"));
    }
    if (!part.has_intensity_w_sr()) return wrong(path + ".part", "has no intensity");
  }
  if (seen.size() != expected.parts) {
    return wrong(path + ".part",
                 absl::StrCat("has ", seen.size(), " of the sweep's ", expected.parts, " parts"));
  }
  std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>> points;
  for (const schema::ProfileRow& p : row.profile()) {
    if (!points.emplace(p.profile_index(), p.point_index(), p.reflections()).second)
      return wrong(path + ".profile", "has a row twice");
    if (!p.has_radiance_w_m2_sr() || !p.has_apparent_radiance_w_m2_sr() ||
        !p.has_source_radiance_temperature_k())
      return wrong(path + ".profile", "has a row without radiance or temperature");
  }
  if (points.size() != expected.profile_rows) {
    return wrong(path + ".profile", absl::StrCat("has ", points.size(), " of the sweep's ",
                                                 expected.profile_rows, " rows"));
  }
  if (expected.thumbnail && *expected.thumbnail != row.has_thumbnail()) {
    return wrong(path + ".thumbnail", row.has_thumbnail() ? "was not asked for" : "is missing");
  }
  if (row.has_thumbnail()) {
    const schema::Thumbnail& thumbnail = row.thumbnail();
    if (thumbnail.width_px() == 0 || thumbnail.height_px() == 0 || !(thumbnail.pixel_rad() > 0) ||
        thumbnail.png().empty() || thumbnail.exr().empty() || thumbnail.stderr_exr().empty()) {
      return wrong(path + ".thumbnail", "is incomplete");
    }
  }
  return check_layers(row, expected, path);
}

absl::Status check_row(const schema::SignatureRow& row, const ExpectedResult& expected,
                       const std::string& path) {
  IRSIG_STORE_TRY(check_row_but_spectrum(row, expected, path));
  IRSIG_STORE_TRY(check_clutter(row, path));
  return check_spectrum(row.spectrum(), row.has_plume_w_sr(), path + ".spectrum");
}

// That it is there where images are, of their size, and names each part once.
absl::Status check_silhouette_of(const schema::ViewJobResult& view,
                                 const ExpectedResult& expected) {
  const std::string path = "silhouette";
  const bool images = view.row_size() > 0 && view.row(0).has_thumbnail();
  if (images != view.has_silhouette())
    return wrong(path, images ? "is missing" : "is there without images");
  if (!images) return absl::OkStatus();
  for (const schema::SignatureRow& row : view.row())
    if (row.thumbnail().width_px() != view.silhouette().width_px() ||
        row.thumbnail().height_px() != view.silhouette().height_px())
      return wrong(path, "is of another size than a thumbnail");
  std::set<std::uint32_t> seen;
  for (const schema::PartPixels& part : view.silhouette().part())
    if (part.part_index() >= expected.parts || !seen.insert(part.part_index()).second)
      return wrong(path,
                   absl::StrCat("names part ", part.part_index(), " twice, or it does not exist"));
  std::set<std::vector<std::uint32_t>> sets;
  for (const schema::PartSetPixels& set : view.silhouette().part_set()) {
    const std::vector<std::uint32_t> parts(set.part_index().begin(), set.part_index().end());
    const bool increasing =
        std::adjacent_find(parts.begin(), parts.end(), std::greater_equal<>()) == parts.end();
    if (parts.empty() || !increasing || parts.back() >= expected.parts ||
        !sets.insert(parts).second)
      return wrong(path, "has a set of parts twice, in no order, or of parts that do not exist");
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status check_result(const schema::JobResult& result, const ExpectedResult& expected) {
  IRSIG_STORE_TRY(check_job_key(result, expected.job_key));
  IRSIG_STORE_TRY(check_seed(result));
  std::set<std::pair<std::uint32_t, std::uint32_t>> missing;
  for (const std::uint32_t condition : expected.condition_index) {
    for (const std::uint32_t band : expected.band_index) missing.emplace(condition, band);
  }
  if (result.kind_case() != schema::JobResult::kView)
    return wrong("kind", "is not the job's: a view");
  for (int i = 0; i < result.view().row_size(); ++i) {
    const schema::SignatureRow& row = result.view().row(i);
    const std::string path = absl::StrCat("row[", i, "]");
    if (missing.erase({row.condition_index(), row.band_index()}) == 0) {
      return wrong(path,
                   absl::StrCat("(condition ", row.condition_index(), ", band ", row.band_index(),
                                ") does not belong to the job, or comes twice"));
    }
    IRSIG_STORE_TRY(check_row(row, expected, path));
  }
  IRSIG_STORE_TRY(check_silhouette_of(result.view(), expected));
  if (!missing.empty()) {
    return wrong("row", absl::StrCat("is missing for condition ", missing.begin()->first, ", band ",
                                     missing.begin()->second));
  }
  return check_every_number(result);
}

absl::Status check_job_key(const schema::JobResult& result, const std::string& job_key) {
  if (result.job_key() == job_key) return absl::OkStatus();
  return wrong("job_key", absl::StrCat("is ", result.job_key(), ", the leased job's is ", job_key));
}

absl::Status check_seed(const schema::JobResult& result) {
  const std::string& seed = result.seed_hex();
  if (seed.size() == 16 && seed.find_first_not_of("0123456789abcdef") == std::string::npos)
    return absl::OkStatus();
  return wrong("seed_hex", "is not of 16 hexadecimal digits (0-9, a-f)");
}

absl::Status check_every_number(const schema::JobResult& result) {
  return check_numbers(result, {}, false);
}

}  // namespace irsig
