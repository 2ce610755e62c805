#include "jobs/files/library_material.h"

#include "absl/strings/str_cat.h"
#include "core/materials/optical/material_library.h"

namespace irsig {
namespace {

// Writes a model's properties into the fields of the message that have their keys' names.
class WriteProperty {
 public:
  explicit WriteProperty(schema::Material& out) : out_(out), fields_(*out.GetReflection()) {}

  void operator()(MaterialKey key, double value) {
    if (key.optional && value < 0) return;
    fields_.SetDouble(&out_, field(key.name), value);
  }
  void operator()(MaterialKey key, bool value) { fields_.SetBool(&out_, field(key.name), value); }
  void operator()(MaterialKey key, Fresnel value) {
    fields_.SetString(&out_, field(key.name), value == Fresnel::kSchlick ? "schlick" : "exact");
  }
  void operator()(MaterialKey key, Masking value) {
    fields_.SetString(&out_, field(key.name), value == Masking::kSmith ? "smith" : "v_groove");
  }
  void operator()(MaterialKey /*key*/, WardForm /*part of the kind*/) {}
  // A spectrum of one point is a number; a longer one is a table.
  void operator()(MaterialKey key, const Spectrum& spectrum) {
    if (spectrum.size() == 1) return (*this)(MaterialKey{key.name}, spectrum.front().value);
    const auto* table = field(absl::StrCat(key.name, "_table"));
    for (const SpectralPoint& at : spectrum) {
      auto& point = static_cast<schema::SpectralPoint&>(*fields_.AddMessage(&out_, table));
      point.set_lambda_um(at.lambda_um);
      point.set_value(at.value);
    }
  }
  void operator()(MaterialKey /*key*/, const OpticalConstants& table) {
    if (table.size() == 1) {
      out_.set_n(table.front().n);
      out_.set_k(table.front().k);
      return;
    }
    for (const OpticalConstant& at : table) {
      schema::OpticalConstant& point = *out_.add_optical_constants();
      point.set_lambda_um(at.lambda_um);
      point.set_n(at.n);
      point.set_k(at.k);
    }
  }
  void operator()(MaterialKey /*key*/, const TabulatedBrdf& m) {
    schema::BrdfTable& brdf = *out_.mutable_brdf();
    brdf.mutable_lambda_um()->Add(m.lambda_um.begin(), m.lambda_um.end());
    brdf.mutable_theta_i_deg()->Add(m.theta_i_deg.begin(), m.theta_i_deg.end());
    brdf.mutable_theta_r_deg()->Add(m.theta_r_deg.begin(), m.theta_r_deg.end());
    brdf.mutable_phi_deg()->Add(m.phi_deg.begin(), m.phi_deg.end());
    for (const float v : m.brdf_per_sr) brdf.add_brdf_per_sr(static_cast<double>(v));
  }

 private:
  [[nodiscard]] const google::protobuf::FieldDescriptor* field(const std::string& name) const {
    return out_.GetDescriptor()->FindFieldByName(name);
  }

  schema::Material& out_;
  const google::protobuf::Reflection& fields_;
};

}  // namespace

absl::StatusOr<schema::Material> message_of(const MaterialSpec& spec) {
  if (const auto* lobe = std::get_if<CookTorrance>(&spec.model);
      lobe != nullptr && (lobe->masking == Masking::kNone || lobe->forced_emissivity >= 0))
    return absl::InvalidArgumentError(
        absl::StrCat("no [[material]] means the same as \"", spec.name, "\""));
  schema::Material out;
  out.set_name(spec.name);
  out.set_kind(model_kind(spec));
  for_each_property(spec.model, WriteProperty(out));
  return out;
}

}  // namespace irsig
