#include "jobs/library_material.h"

#include "absl/strings/str_cat.h"
#include "core/materials/optical/material_library.h"

namespace irsig {
namespace {

// A spectrum of one point is a number; a longer one is a table.
template <typename SetValue, typename AddPoint>
void put(const Spectrum& spectrum, SetValue set_value, AddPoint add_point) {
  if (spectrum.size() == 1) return set_value(spectrum.front().value);
  for (const SpectralPoint& at : spectrum) {
    schema::SpectralPoint& point = *add_point();
    point.set_lambda_um(at.lambda_um);
    point.set_value(at.value);
  }
}

class Writer {
 public:
  explicit Writer(schema::Material& out) : out_(out) {}

  void operator()(const Lambert& m) { emissivity(m.emissivity); }
  void operator()(const CookTorrance& m) {
    constants(m.constants);
    out_.set_roughness(m.roughness);
    out_.set_fresnel(m.fresnel == Fresnel::kSchlick ? "schlick" : "exact");
    out_.set_masking(m.masking == Masking::kSmith ? "smith" : "v_groove");
    if (m.normal_emissivity >= 0) out_.set_normal_emissivity(m.normal_emissivity);
  }
  void operator()(const Ward& m) {
    diffuse(m.diffuse);
    put(
        m.specular, [&](double v) { out_.set_specular_reflectance(v); },
        [&] { return out_.add_specular_reflectance_table(); });
    out_.set_roughness(m.roughness);
  }
  void operator()(const SandfordRobertson& m) {
    emissivity(m.emissivity);
    diffuse(m.diffuse);
    out_.set_grazing(m.grazing);
    out_.set_lobe_width(m.lobe_width);
  }
  void operator()(const PriestGermer& m) {
    constants(m.constants);
    out_.set_roughness(m.roughness);
    out_.set_published(m.published);
  }
  void operator()(const BeardMaxwell& m) {
    constants(m.constants);
    diffuse(m.diffuse);
    put(
        m.volume, [&](double v) { out_.set_volume_reflectance(v); },
        [&] { return out_.add_volume_reflectance_table(); });
    out_.set_bias(m.bias);
    out_.set_width(m.width);
    out_.set_tau_deg(m.tau_deg);
    out_.set_omega_deg(m.omega_deg);
    out_.set_published(m.published);
  }
  void operator()(const Prisse& m) {
    put(
        m.reflectance, [&](double v) { out_.set_reflectance(v); },
        [&] { return out_.add_reflectance_table(); });
    out_.set_gamma_um(m.gamma_um);
    out_.set_lambda0_um(m.lambda0_um);
    out_.set_printed(m.printed);
  }
  void operator()(const TabulatedBrdf& m) {
    schema::BrdfTable& brdf = *out_.mutable_brdf();
    brdf.mutable_lambda_um()->Add(m.lambda_um.begin(), m.lambda_um.end());
    brdf.mutable_theta_i_deg()->Add(m.theta_i_deg.begin(), m.theta_i_deg.end());
    brdf.mutable_theta_r_deg()->Add(m.theta_r_deg.begin(), m.theta_r_deg.end());
    brdf.mutable_phi_deg()->Add(m.phi_deg.begin(), m.phi_deg.end());
    for (const float v : m.brdf_per_sr) brdf.add_brdf_per_sr(static_cast<double>(v));
  }

 private:
  void emissivity(const Spectrum& spectrum) {
    put(
        spectrum, [&](double v) { out_.set_emissivity(v); },
        [&] { return out_.add_emissivity_table(); });
  }
  void diffuse(const Spectrum& spectrum) {
    put(
        spectrum, [&](double v) { out_.set_diffuse_reflectance(v); },
        [&] { return out_.add_diffuse_reflectance_table(); });
  }
  void constants(const OpticalConstants& table) {
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

  schema::Material& out_;
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
  std::visit(Writer(out), spec.model);
  return out;
}

}  // namespace irsig
