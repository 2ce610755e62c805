#include "core/signature/scene_hash.h"

#include <variant>

namespace irsig {
namespace {

// Every number of a material's model.
struct AddModel {
  Hash& hash;

  void number(double x) const { hash.add(x); }
  void choice(std::uint64_t x) const { hash.add(x); }
  void spectrum(const Spectrum& s) const {
    for (const SpectralPoint& p : s) {
      number(p.lambda_um);
      number(p.value);
    }
  }
  void constants(const OpticalConstants& table) const {
    for (const OpticalConstant& c : table) {
      number(c.lambda_um);
      number(c.n);
      number(c.k);
    }
  }

  void operator()(const Lambert& m) const { spectrum(m.emissivity); }
  void operator()(const CookTorrance& m) const {
    constants(m.constants);
    number(m.roughness);
    choice(static_cast<std::uint64_t>(m.fresnel));
    choice(static_cast<std::uint64_t>(m.masking));
    number(m.normal_emissivity);
    number(m.forced_emissivity);
  }
  void operator()(const Ward& m) const {
    spectrum(m.diffuse);
    spectrum(m.specular);
    number(m.roughness);
    choice(static_cast<std::uint64_t>(m.form));
  }
  void operator()(const SandfordRobertson& m) const {
    spectrum(m.emissivity);
    spectrum(m.diffuse);
    number(m.grazing);
    number(m.lobe_width);
  }
  void operator()(const PriestGermer& m) const {
    constants(m.constants);
    number(m.roughness);
    choice(m.published);
  }
  void operator()(const BeardMaxwell& m) const {
    constants(m.constants);
    number(m.bias);
    number(m.width);
    spectrum(m.diffuse);
    spectrum(m.volume);
    number(m.tau_deg);
    number(m.omega_deg);
    choice(m.published);
  }
  void operator()(const Prisse& m) const {
    number(m.gamma_um);
    number(m.lambda0_um);
    spectrum(m.reflectance);
    choice(m.printed);
  }
  void operator()(const TabulatedBrdf& m) const {
    for (const auto* list : {&m.lambda_um, &m.theta_i_deg, &m.theta_r_deg, &m.phi_deg})
      for (const double x : *list) number(x);
    hash.add(m.brdf_per_sr);
  }
};

}  // namespace

void Hash::add(const MaterialSpec& spec) {
  add(static_cast<std::uint64_t>(spec.model.index()));
  std::visit(AddModel{*this}, spec.model);
}

}  // namespace irsig
