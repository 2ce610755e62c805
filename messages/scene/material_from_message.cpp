#include "messages/scene/material_from_message.h"

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/materials/material.h"
#include "core/materials/optical/material_library.h"
#include "google/protobuf/reflection.h"
#include "messages/environment/named.h"

namespace irsig {
namespace {

// The table if there is one, else the number, which holds at every wavelength.
template <typename Points>
Spectrum spectrum(double value, const Points& table) {
  if (table.empty()) return {{0, value}};
  Spectrum out;
  for (const schema::SpectralPoint& p : table) out.push_back({p.lambda_um(), p.value()});
  return out;
}

// Reads a model's properties from the fields of the message that have their keys' names.
class ReadProperty {
 public:
  explicit ReadProperty(const schema::Material& from)
      : from_(from), fields_(*from.GetReflection()) {}

  [[nodiscard]] const absl::Status& status() const { return status_; }

  void operator()(MaterialKey key, double& value) {
    if (*key.name == 0) return;
    if (!key.optional || fields_.HasField(from_, field(key.name)))
      value = fields_.GetDouble(from_, field(key.name));
  }
  void operator()(MaterialKey key, bool& value) { value = fields_.GetBool(from_, field(key.name)); }
  void operator()(MaterialKey key, Fresnel& value) {
    choose<Fresnel>(key, {{"exact", Fresnel::kExact}, {"schlick", Fresnel::kSchlick}}, value);
  }
  void operator()(MaterialKey key, Masking& value) {
    choose<Masking>(key, {{"v_groove", Masking::kVGroove}, {"smith", Masking::kSmith}}, value);
  }
  void operator()(MaterialKey /*key*/, WardForm& /*part of the kind*/) {}
  void operator()(MaterialKey key, Spectrum& out) {
    out = spectrum(fields_.GetDouble(from_, field(key.name)),
                   fields_.GetRepeatedFieldRef<schema::SpectralPoint>(
                       from_, field(absl::StrCat(key.name, "_table"))));
  }
  void operator()(MaterialKey /*key*/, OpticalConstants& out) {
    if (from_.optical_constants().empty()) out = {{0, from_.n(), from_.k()}};
    for (const schema::OpticalConstant& c : from_.optical_constants())
      out.push_back({c.lambda_um(), c.n(), c.k()});
  }
  void operator()(MaterialKey /*key*/, TabulatedBrdf& out) {
    const schema::BrdfTable& b = from_.brdf();
    out.lambda_um.assign(b.lambda_um().begin(), b.lambda_um().end());
    out.theta_i_deg.assign(b.theta_i_deg().begin(), b.theta_i_deg().end());
    out.theta_r_deg.assign(b.theta_r_deg().begin(), b.theta_r_deg().end());
    out.phi_deg.assign(b.phi_deg().begin(), b.phi_deg().end());
    for (const double v : b.brdf_per_sr()) out.brdf_per_sr.push_back(static_cast<float>(v));
  }

 private:
  template <typename Value>
  void choose(MaterialKey key, std::initializer_list<std::pair<std::string_view, Value>> known,
              Value& value) {
    if (!fields_.HasField(from_, field(key.name))) return;
    const auto found = named<Value>(key.name, fields_.GetString(from_, field(key.name)), known);
    if (found.ok())
      value = *found;
    else
      status_.Update(found.status());
  }
  [[nodiscard]] const google::protobuf::FieldDescriptor* field(const std::string& name) const {
    return from_.GetDescriptor()->FindFieldByName(name);
  }

  const schema::Material& from_;
  const google::protobuf::Reflection& fields_;
  absl::Status status_;
};

// A sweep file may state what a Lambert surface reflects instead of what it emits.
Lambert lambert_of_reflectance(const schema::Material& m) {
  Spectrum emissivity = spectrum(m.reflectance(), m.reflectance_table());
  for (SpectralPoint& p : emissivity) p.value = 1 - p.value;
  return {emissivity};
}

}  // namespace

absl::StatusOr<MaterialSpec> material_from_message(const schema::Material& m) {
  if (m.kind() == "lambert" && (m.has_reflectance() || !m.reflectance_table().empty()))
    return MaterialSpec{m.name(), lambert_of_reflectance(m)};
  for (const MaterialModel& of_kind : material_models()) {
    if (model_kind(of_kind) != m.kind()) continue;
    MaterialSpec out{m.name(), of_kind};
    ReadProperty read(m);
    for_each_property(out.model, read);
    RETURN_IF_ERROR(read.status());
    return out;
  }
  auto spec = builtin_material(m.kind());
  if (!spec.ok())
    return absl::InvalidArgumentError(absl::StrCat("kind \"", m.kind(), "\" is not known"));
  spec->name = m.name();
  return spec;
}

}  // namespace irsig
